// SPDX-License-Identifier: Apache-2.0
// The samples of samples.py, and messages of them as the reference libraries serialise them.
"use strict";
const { parse } = require("@foxglove/rosmsg");
const { MessageWriter: Ros1Writer } = require("@foxglove/rosmsg-serialization");
const { MessageWriter: Ros2Writer } = require("@foxglove/rosmsg2-serialization");
const { CdrWriter, EncapsulationKind } = require("@foxglove/cdr");

const START = 1700000000n * 1000000000n + 123456789n;
const STEP = 5000001n;
const DELAY = 1500000n;
const BILLION = 1000000000n;

const rule = "=".repeat(80);
const fields = `geometry_msgs/Quaternion orientation
float64[9] orientation_covariance
geometry_msgs/Vector3 angular_velocity
float64[9] angular_velocity_covariance
geometry_msgs/Vector3 linear_acceleration
float64[9] linear_acceleration_covariance
`;
const within = `${rule}
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
${rule}
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
`;
const ros1 = `std_msgs/Header header
${fields}${rule}
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
${within}`;
const ros2 = `std_msgs/Header header
${fields}${rule}
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
${rule}
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
${within}`;

const stamp = (i) => START + BigInt(i) * STEP;
const gyro = (i) => [0, 1, 2].map((axis) => i * 0.001 + axis * 0.1);
const accel = (i) => [0, 1, 2].map((axis) => i * -0.01 + axis * 9.80665);
const vector = (v) => ({ x: v[0], y: v[1], z: v[2] });

function message(i, kind) {
  const at = stamp(i);
  const sec = Number(at / BILLION);
  const nsec = Number(at % BILLION);
  const nine = new Float64Array(9);
  return {
    header: {
      seq: i,
      stamp: kind === "ros1" ? { sec, nsec } : { sec, nanosec: nsec },
      frame_id: "sensor",
    },
    orientation: { x: 0, y: 0, z: 0, w: 1 },
    orientation_covariance: nine,
    angular_velocity: vector(gyro(i)),
    angular_velocity_covariance: nine,
    linear_acceleration: vector(accel(i)),
    linear_acceleration_covariance: nine,
  };
}

const writer1 = new Ros1Writer(parse(ros1));
const writer2 = new Ros2Writer(parse(ros2, { ros2: true }));

// In big-endian CDR, which the message writer does not offer.
function big(m) {
  const w = new CdrWriter({ kind: EncapsulationKind.CDR_BE });
  w.int32(m.header.stamp.sec).uint32(m.header.stamp.nanosec).string(m.header.frame_id);
  const o = m.orientation;
  for (const value of [o.x, o.y, o.z, o.w]) w.float64(value);
  w.float64Array(m.orientation_covariance);
  for (const name of ["angular_velocity", "linear_acceleration"]) {
    for (const axis of ["x", "y", "z"]) w.float64(m[name][axis]);
    w.float64Array(m[`${name}_covariance`]);
  }
  return w.data;
}

function serialise(i, kind) {
  const m = message(i, kind);
  return kind === "ros1" ? writer1.writeMessage(m) : kind === "big" ? big(m) : writer2.writeMessage(m);
}

module.exports = { DELAY, stamp, gyro, accel, serialise, ros1, ros2 };
