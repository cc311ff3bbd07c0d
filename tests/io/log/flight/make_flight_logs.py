#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Write flight.ulg, flight.bin and old.bin, the small logs that test_ulog and test_dataflash read.

Written after the published formats [ULOG], [DATAFLASH], without any code of imukit. All values are
formulas of the number of the message, which the tests compute again:

    sensor k of axis a:  ((7 k + 31 a) mod 201 - 100) / 1024, exact in float
"""
import pathlib
import struct

HERE = pathlib.Path(__file__).resolve().parent


def whole(k, axis):
    return (7 * k + 31 * axis) % 201 - 100


def value(k, axis):
    return whole(k, axis) / 1024


# --- ULog ---

SYNC = bytes([0x2F, 0x73, 0x13, 0x20, 0x25, 0x0C, 0xBB, 0x12])
FORMATS = [
    "outer:inner[2] a;uint16_t b;",  # 12 bytes; its inner format stands behind it
    "inner:int16_t c;uint8_t[3] d;",
    "sensor_combined:uint64_t timestamp;float[3] gyro_rad;uint32_t gyro_integral_dt;"
    "int32_t accelerometer_timestamp_relative;float[3] accelerometer_m_s2;"
    "uint32_t accelerometer_integral_dt;uint8_t accelerometer_clipping;uint8_t[3] _padding0;",
    "sensor_gyro:uint64_t timestamp;uint64_t timestamp_sample;uint32_t device_id;float x;float y;"
    "float z;float temperature;uint32_t error_count;uint8_t[3] clip_counter;uint8_t[5] _padding0;",
    # doubles behind a nested format and padding, and no timestamp_sample
    "sensor_accel:uint64_t timestamp;outer extra;uint8_t[4] _padding0;double x;double y;double z;"
    "float temperature;",
    "sensor_gyro_fifo:uint64_t timestamp;uint64_t timestamp_sample;uint32_t device_id;float dt;"
    "float scale;int16_t[32] x;int16_t[32] y;int16_t[32] z;uint8_t samples;uint8_t[3] _padding0;",
    "vehicle_imu:uint64_t timestamp;uint64_t timestamp_sample;float[3] delta_angle;"
    "float[3] delta_velocity;uint16_t delta_angle_dt;uint16_t delta_velocity_dt;",
    "sensor_mag:uint64_t timestamp;float x;float y;float z;",
    "cpuload:uint64_t timestamp;float load;",
]
TOPICS = ["sensor_combined", "sensor_gyro", "sensor_gyro", "sensor_accel", "sensor_gyro_fifo",
          "vehicle_imu", "sensor_mag", "cpuload"]
INSTANCES = [0, 0, 1, 0, 0, 0, 0, 0]
COMBINED, GYRO_0, GYRO_1, ACCEL, FIFO, VEHICLE, MAGNETOMETER, LOAD = range(8)


def message(kind, body):
    return struct.pack("<HB", len(body), ord(kind)) + body


def key(text, data):
    return bytes([len(text)]) + text.encode() + data


def add(number):
    return message("A", struct.pack("<BH", INSTANCES[number], number) + TOPICS[number].encode())


def data(number, layout, *values):
    return message("D", struct.pack("<H" + layout, number, *values))


def axes(k, first=0):
    return [value(k, first + axis) for axis in range(3)]


def combined(k):
    relative = 0x7FFFFFFF if k == 5 else -250  # the forces of message 5 are not valid
    return data(COMBINED, "Q3fIi3fIB", 6_000_000 + 4000 * k, *axes(k), 4000, relative, *axes(k, 3),
                3990, 0)


def gyro(number, k):
    stamp = 6_000_000 + 10_000 * k + number
    return data(number, "QQIffffI3B", stamp + 300, 0 if k == 3 else stamp, 77, *axes(k + number),
                25 + k / 8, 0, 1, 2, 3)


def accel(k):
    nested = [1, 2, 3, 4] * 2
    return data(ACCEL, "QhBBBhBBBH4x3df", 6_000_000 + 20_000 * k, *nested, 9, *axes(k),
                float("nan"))


def fifo(k):
    samples = [8, 8, 3, 0, 32][k]
    arrays = [[whole(100 * k + i, axis) if i < samples else 9999 for i in range(32)]
              for axis in range(3)]
    return data(FIFO, "QQIff32h32h32hB", 7_000_000 + 1000 * k + 90, 7_000_000 + 1000 * k, 77, 125.125,
                0.0010652645, *arrays[0], *arrays[1], *arrays[2], samples)


def vehicle(k):
    return data(VEHICLE, "QQ3f3fHH", 6_000_100 + 5000 * k, 6_000_000 + 5000 * k, *axes(k),
                *axes(k, 3), 0 if k == 2 else 4999 + k, 5000 - k)


def ulog():
    begin = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 5_000_000)
    definitions = b"".join(message("F", text.encode()) for text in FORMATS)
    definitions += message("I", key("char[3] sys_name", b"PX4"))
    definitions += message("M", b"\0" + key("char[2] perf", b"ab"))
    definitions += message("P", key("float CAL_GYRO0_XOFF", struct.pack("<f", 0.25)))
    definitions += message("Q", b"\1" + key("int32_t SYS_AUTOSTART", struct.pack("<i", 4001)))
    body = b"".join(add(number) for number in range(8) if number != GYRO_1)
    body += message("L", b"6" + struct.pack("<Q", 5_500_000) + b"ready")
    body += message("C", b"6" + struct.pack("<HQ", 3, 5_500_000) + b"tagged")
    for k in range(40):
        body += combined(k)
        if k % 2 == 0:
            body += gyro(GYRO_0, k // 2)
        if k == 20:
            body += add(GYRO_1)
        if k > 20 and k % 4 == 0:
            body += gyro(GYRO_1, k // 4)
        if k % 5 == 0:
            body += accel(k // 5) + vehicle(k // 5) + data(MAGNETOMETER, "Qfff", 1, 0.2, 0, 0.4)
        if k % 8 == 0:
            body += fifo(k // 8) + data(LOAD, "Qf", 6_000_000 + k, 0.5)
        if k % 10 == 0:
            body += message("S", SYNC) + message("O", struct.pack("<H", 12))
        if k == 30:  # of a later version of the format
            body += message("Z", b"what nobody knows")
    cut = combined(1000)[:30]  # the logging was stopped within a message
    appended = b"".join(combined(k) for k in range(40, 43))
    flags = bytes(8) + b"\1" + bytes(7)
    size = len(begin) + 3 + 40 + len(definitions) + len(body) + len(cut)
    head = begin + message("B", flags + struct.pack("<3Q", size, 0, 0)) + definitions
    return head + body + cut + appended


# --- DataFlash ---

def packet(number, layout, *values):
    return b"\xA3\x95" + bytes([number]) + struct.pack("<" + layout, *values)


LAYOUT = {"Q": "Q", "B": "B", "b": "b", "H": "H", "h": "h", "I": "I", "f": "f", "d": "d", "a": "32h",
          "n": "4s", "N": "16s", "Z": "64s", "c": "h"}


class Kind:
    def __init__(self, number, name, types, labels):
        self.number, self.name, self.types, self.labels = number, name, types, labels
        self.layout = "".join(LAYOUT[letter] for letter in types)

    def fmt(self):
        return packet(128, "BB4s16s64s", self.number, 3 + struct.calcsize("<" + self.layout),
                      self.name.encode(), self.types.encode(), self.labels.encode())

    def __call__(self, *values):
        return packet(self.number, self.layout, *values)


FMT = Kind(128, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns")
UNIT = Kind(10, "UNIT", "QbZ", "TimeUS,Id,Label")
MULT = Kind(11, "MULT", "Qbd", "TimeUS,Id,Mult")
FMTU = Kind(12, "FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds")
PARM = Kind(13, "PARM", "QNff", "TimeUS,Name,Value,Default")
IMU = Kind(20, "IMU", "QBffffffIIfBBHH",
           "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,EG,EA,T,GH,AH,GHz,AHz")
ACC = Kind(21, "ACC", "QBQhhh", "TimeUS,I,SampleUS,AccX,AccY,AccZ")  # hundredths, by MULT
GYR = Kind(22, "GYR", "QBQfff", "TimeUS,I,SampleUS,GyrX,GyrY,GyrZ")  # deg/s, by UNIT
ISBH = Kind(23, "ISBH", "QHBBHHQf", "TimeUS,N,type,instance,mul,smp_cnt,SampleUS,smp_rate")
ISBD = Kind(24, "ISBD", "QHHaaa", "TimeUS,N,seqno,x,y,z")
MAG = Kind(25, "MAG", "QBhhh", "TimeUS,I,MagX,MagY,MagZ")


def batches(number, gyro):
    """64 samples of one sensor: a header and two messages."""
    out = ISBH(9_000_000, number, gyro, 1, 938, 64, 8_000_000 + 100_000 * number, 1600.5)
    for piece in range(2):
        arrays = [[whole(64 * number + 32 * piece + i, axis) for i in range(32)]
                  for axis in range(3)]
        out += ISBD(9_000_001, number, piece, *arrays[0], *arrays[1], *arrays[2])
    return out


def dataflash():
    kinds = [FMT, UNIT, MULT, FMTU, PARM, IMU, ACC, GYR, ISBH, ISBD, MAG]
    out = b"".join(kind.fmt() for kind in kinds)
    out += IMU(6_990_000, 0, *axes(200), *axes(200, 3), 0, 0, 30, 1, 1, 1, 1)  # before the units
    for letter, text in [("s", "s"), ("#", "instance"), ("E", "rad/s"), ("k", "deg/s"),
                         ("o", "m/s/s"), ("O", "degC"), ("z", "Hz"), ("-", ""), ("?", "UNKNOWN")]:
        out += UNIT(1, ord(letter), text.encode())
    for letter, factor in [("-", 0), ("?", 1), ("0", 1), ("B", 0.01), ("F", 1e-6)]:
        out += MULT(1, ord(letter), factor)
    for kind, units, factors in [(IMU, "s#EEEooo--O--zz", "F-000000-----00"),
                                 (ACC, "s#sooo", "F-FBBB"), (GYR, "s#skkk", "F-F000"),
                                 (ISBD, "s--ooo", "F--???")]:
        out += FMTU(1, kind.number, units.encode(), factors.encode())
    out += PARM(1, b"INS_LOG_BAT_OPT", 1, 0)
    for k in range(30):
        for instance in range(2):
            out += IMU(7_000_000 + 2500 * k, instance, *axes(k + 50 * instance),
                       *axes(k + 50 * instance, 3), 0, 0, 20 + k / 8, 1, 1, 1000, 1000)
        out += ACC(7_000_050 + 500 * k, 0, 7_000_000 + 500 * k, *[whole(k, a) for a in range(3)])
        out += GYR(7_000_050 + 500 * k, 2, 0 if k == 4 else 7_000_000 + 500 * k, *axes(k))
        if k % 6 == 0:
            out += batches(k // 6, k // 6 % 2) + MAG(7_000_000, 0, 1, 2, 3)
        if k == 15:
            out += IMU.fmt()  # once more
    return out


def old_dataflash():
    """A log of 2014: milliseconds, a name per instance, hundredths by their type, no units."""
    imu = Kind(20, "IMU", "Iffffffc", "TimeMS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,Temp")
    imu2 = Kind(21, "IMU2", "Iffffff", "TimeMS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ")
    out = FMT.fmt() + imu.fmt() + imu2.fmt()
    for k in range(12):
        out += imu(90_000 + 20 * k, *axes(k), *axes(k, 3), 2500 + k)
        out += imu2(90_000 + 20 * k, *axes(k + 1), *axes(k + 1, 3))
    return out


for name, content in [("flight.ulg", ulog()), ("flight.bin", dataflash()),
                      ("old.bin", old_dataflash())]:
    (HERE / name).write_bytes(content)
    print(name, len(content))
