// SPDX-License-Identifier: Apache-2.0
// Writes MCAP files with @mcap/core, the reference library.
//
//     write_mcap.cjs DIRECTORY [SAMPLES]
"use strict";
const { execFileSync } = require("child_process");
const { writeFileSync } = require("fs");
const { McapWriter } = require("@mcap/core");
const samples = require("./samples.cjs");

class Bytes {
  parts = [];
  at = 0;
  async write(part) {
    this.parts.push(Buffer.from(part));
    this.at += part.byteLength;
  }
  position() {
    return BigInt(this.at);
  }
}

const packers = {
  none: undefined,
  lz4: (data) => ({
    compression: "lz4",
    compressedData: execFileSync("lz4", ["-z", "-c", "-"], { input: data, maxBuffer: 1 << 30 }),
  }),
  zstd: (data) => ({
    compression: "zstd",
    compressedData: execFileSync("zstd", ["-c", "-"], { input: data, maxBuffer: 1 << 30 }),
  }),
};

async function write(path, count, packing, kind, options = {}) {
  const bytes = new Bytes();
  const ros1 = kind === "ros1";
  const writer = new McapWriter({
    writable: bytes,
    chunkSize: count < 1000 ? 2000 : 1 << 20,
    compressChunk: packers[packing],
    ...options,
  });
  await writer.start({ profile: ros1 ? "ros1" : "ros2", library: "test" });
  const text = await writer.registerSchema({
    name: ros1 ? "std_msgs/String" : "std_msgs/msg/String",
    encoding: ros1 ? "ros1msg" : "ros2msg",
    data: new TextEncoder().encode("string data\n"),
  });
  const imu = await writer.registerSchema({
    name: ros1 ? "sensor_msgs/Imu" : "sensor_msgs/msg/Imu",
    encoding: ros1 ? "ros1msg" : "ros2msg",
    data: new TextEncoder().encode(ros1 ? samples.ros1 : samples.ros2),
  });
  const channel = (schemaId, topic) =>
    writer.registerChannel({
      schemaId,
      topic,
      messageEncoding: ros1 ? "ros1" : "cdr",
      metadata: new Map(),
    });
  const chatter = await channel(text, "/chatter");
  const data = await channel(imu, "/imu/data");
  for (let i = 0; i < count; i++) {
    const logTime = samples.stamp(i) + samples.DELAY;
    const add = (channelId, content) =>
      writer.addMessage({ channelId, sequence: i, logTime, publishTime: logTime, data: content });
    if (i % 8 === 0) await add(chatter, new Uint8Array([0, 1, 0, 0, 2, 0, 0, 0, 97, 0]));
    await add(data, samples.serialise(i, kind));
  }
  await writer.end();
  writeFileSync(path, Buffer.concat(bytes.parts));
}

async function main() {
  const directory = process.argv[2];
  const count = Number(process.argv[3] ?? 24);
  for (const packing of ["none", "lz4", "zstd"])
    await write(`${directory}/cdr_${packing}.mcap`, count, packing, "cdr");
  await write(`${directory}/ros1_lz4.mcap`, count, "lz4", "ros1");
  await write(`${directory}/big.mcap`, count, "none", "big");
  await write(`${directory}/unchunked.mcap`, count, "none", "cdr", { useChunks: false });
  await write(`${directory}/no_summary.mcap`, count, "zstd", "cdr", {
    useStatistics: false,
    useSummaryOffsets: false,
    repeatSchemas: false,
    repeatChannels: false,
    useMessageIndex: false,
    useChunkIndex: false,
  });
}

main();
