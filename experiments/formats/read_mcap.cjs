// SPDX-License-Identifier: Apache-2.0
// Prints the messages of /imu in an MCAP file, as @mcap/core reads them: time, rates, forces; by the
// index, and with --stream from the beginning, with all CRCs checked.
"use strict";
const { readFile } = require("fs/promises");
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const { loadDecompressHandlers } = require("@mcap/support");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");

const hex = (value) => {
  const bytes = new DataView(new ArrayBuffer(8));
  bytes.setFloat64(0, value);
  return bytes.getBigUint64(0).toString(16).padStart(16, "0");
};

async function main() {
  const [, , path, mode] = process.argv;
  const decompressHandlers = await loadDecompressHandlers();
  const readers = new Map();
  const print = (schema, channel, message) => {
    if (channel.topic !== "/imu") throw new Error(`topic ${channel.topic}`);
    if (!readers.has(schema.id)) {
      const text = new TextDecoder().decode(schema.data);
      readers.set(schema.id, new MessageReader(parse(text, { ros2: true })));
    }
    const imu = readers.get(schema.id).readMessage(message.data);
    const { sec, nanosec, nsec } = imu.header.stamp;
    const stamp = BigInt(sec) * 1000000000n + BigInt(nanosec ?? nsec);
    if (stamp !== message.logTime) throw new Error("the time of recording is not the stamp");
    const values = [];
    for (const name of ["angular_velocity", "linear_acceleration"])
      if (imu[`${name}_covariance`][0] !== -1)
        for (const axis of ["x", "y", "z"]) values.push(hex(imu[name][axis]));
    console.log(`${stamp} ${values.join(" ")}`);
  };
  if (mode === "--stream") {
    const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true });
    reader.append(await readFile(path));
    const schemas = new Map();
    const channels = new Map();
    for (let record; (record = reader.nextRecord()); ) {
      if (record.type === "Schema") schemas.set(record.id, record);
      if (record.type === "Channel") channels.set(record.id, record);
      if (record.type !== "Message") continue;
      const channel = channels.get(record.channelId);
      print(schemas.get(channel.schemaId), channel, record);
    }
    if (!reader.done()) throw new Error("the file does not end as it should");
  } else {
    const bytes = await readFile(path);
    const readable = {
      size: async () => BigInt(bytes.length),
      read: async (offset, size) => bytes.subarray(Number(offset), Number(offset + size)),
    };
    const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
    for await (const message of reader.readMessages()) {
      const channel = reader.channelsById.get(message.channelId);
      print(reader.schemasById.get(channel.schemaId), channel, message);
    }
    console.error(`# ${reader.statistics.messageCount} messages`);
  }
}

main();
