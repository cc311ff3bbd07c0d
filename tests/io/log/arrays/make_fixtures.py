#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Make the files of this folder with NumPy, SciPy, h5py and GNU Octave.

    tests/io/log/arrays/make_fixtures.py     needs python3-scipy, python3-h5py, octave

All hold the 20 samples that test_log_arrays.c computes by the same formulas. Every number is a
multiple of 2^-10, which float32 has exactly, so what is read must be equal to the last bit.
"""
import os
import struct
import subprocess
from unittest import mock

import h5py
import numpy as np
import scipy.io

os.chdir(os.path.dirname(os.path.abspath(__file__)))
N = 20
i, k = np.arange(N), np.arange(3)
t = i / 64
gyro = (7 * i[:, None] + 3 * k - 50) / 1024
accel = (5 * i[:, None] - 11 * k) / 512 - 9.75 * (k == 2)
columns = ["time [s]"] + ["gyro_%s [rad/s]" % c for c in "xyz"] + \
    ["accel_%s [m/s^2]" % c for c in "xyz"]
matrix = np.column_stack([t, gyro, accel])
units = {"t": "s", "gyro": "rad/s", "accel": "m/s^2"}
stamps = 1700000000 * 10**9 + (t * 1e9).astype("i8")  # t * 1e9 is whole

np.savez("stored.npz", t=t, gyro=gyro, accel=np.asfortranarray(accel), scale=2.5, title="a log")
np.savez_compressed("deflated.npz", **{
    "imu/time [s]": t.astype(">f8"), "imu/gyro [rad/s]": gyro.T.astype(">f4"),
    "imu/accel [m/s^2]": np.asfortranarray(accel)})
np.savez("stamps.npz", time=stamps.astype("M8[ns]"), gyro=(gyro * 1024).astype("<i2"),
         accel=(accel * 512).astype(">i4"))
np.savez_compressed("matrix.npz", data=matrix, columns=columns)
np.savez("named.npz", data=matrix)
np.savez("lengths.npz", **{"gyro [rad/s]": gyro, "accel [m/s^2]": accel[:15]})
with mock.patch("zipfile.ZIP64_LIMIT", 1), mock.patch("zipfile.ZIP_FILECOUNT_LIMIT", 1):
    np.savez("zip64.npz", **{"t [s]": t, "gyro [rad/s]": gyro, "accel [m/s^2]": accel})
np.savez("unread.npz", t=t, accel=accel, gyro=gyro.astype("f2"), title="a log")
np.savez("half.npz", t=t.astype("f2"), gyro=gyro, accel=accel)
np.savez("duration.npz", t=(t * 1e9).astype("m8[ns]"), gyro=gyro, accel=accel)
np.savez("records.npz", table=np.zeros(4, dtype=[("a", "f8"), ("b", "f8")]))

scipy.io.savemat("plain.mat", dict(t=t, gyro=gyro, accel=accel.T, units=units))
scipy.io.savemat("unread.mat", dict(t=t, accel=accel, wide=np.zeros((2, 2, 2)), gyro=gyro + 0j))
scipy.io.savemat("packed.mat", dict(imu=dict(t=t[:, None], fb=accel, wb=gyro, freq=64.0),
                                    notes="a log"), do_compression=True)
scipy.io.savemat("types.mat", dict(t=np.arange(N, dtype="u2"), gyro=(gyro * 1024).astype("i2"),
                                   accel=accel.astype("f4"), list=np.array([1, "a"], dtype=object),
                                   sparse=scipy.sparse.eye(3)))
scipy.io.savemat("two.mat", dict(left=dict(t=t, gyro=gyro, accel=accel),
                                 right=dict(t=t, gyro=-gyro, accel=-accel)))
scipy.io.savemat("old.mat", dict(t=t, gyro=gyro), format="4")
scipy.io.savemat("octave_in.mat", dict(t=t[:, None], gyro=gyro, accel=accel))
subprocess.run(["octave-cli", "--quiet", "--eval",
                "load octave_in.mat; units.t='s'; units.gyro='rad/s'; units.accel='m/s^2';"
                "save('-v7', 'octave.mat', 't', 'gyro', 'accel', 'units')"], check=True)
os.remove("octave_in.mat")


def element(kind, data):
    return struct.pack("<II", kind, len(data)) + data + b"\0" * (-len(data) % 8)


# A table, which no program but MATLAB writes: an opaque array, as far as its head goes.
opaque = element(6, struct.pack("<II", 17, 0)) + element(1, b"data") + element(1, b"MCOS") + \
    element(1, b"table") + element(14, element(6, struct.pack("<II", 13, 0)) +
                                   element(5, struct.pack("<ii", 1, 1)) + element(1, b"") +
                                   element(6, struct.pack("<I", 1)))
with open("table.mat", "wb") as file:
    file.write(b"MATLAB 5.0 MAT-file".ljust(116) + b"\0" * 8 + b"\0\1IM" + element(14, opaque))


def sized(big, name):  # the same file in the other order of bytes
    order = ">" if big else "<"

    def put(kind, data):
        return struct.pack(order + "II", kind, len(data)) + data + b"\0" * (-len(data) % 8)

    def array(array_name, values):
        values = np.asarray(values, order + "f8")
        return put(14, put(6, struct.pack(order + "II", 6, 0)) +
                   put(5, struct.pack(order + "ii", *values.shape)) + put(1, array_name) +
                   put(9, values.tobytes("F")))
    with open(name, "wb") as out:
        out.write(b"MATLAB 5.0 MAT-file".ljust(116) + b"\0" * 8 +
                  (b"\1\0MI" if big else b"\0\1IM") + array(b"t", t[:, None]) +
                  array(b"gyro", gyro) + array(b"accel", accel))


sized(True, "big_endian.mat")


def hdf5(name, **settings):
    return h5py.File(name, "w", libver="latest", **settings)


def put_all(group, transposed, **settings):
    for name, data in (("t", t), ("gyro", gyro), ("accel", accel)):
        data = data.T if transposed else data
        group.create_dataset(name, data=data, **settings).attrs["units"] = units[name]


with hdf5("chunked.h5") as f:
    put_all(f, False, chunks=True, compression="gzip", shuffle=True)
with hdf5("groups.h5") as f:
    put_all(f.create_group("left/imu"), True)
    g = f.create_group("right")
    for name, data in (("time", stamps), ("gyro", (gyro * 1024).astype(">i2")),
                       ("accel", accel.astype(">f4"))):
        g.create_dataset(name, data=data)
    f["title"] = "a log"
    f["elsewhere"] = h5py.ExternalLink("/etc/passwd", "x")
    f["again"] = h5py.SoftLink("/left")
with hdf5("linked.h5") as f:
    g = f.create_group("imu")
    g["time"], g["gyro"] = t, gyro
    g["accel"] = h5py.SoftLink("/elsewhere")
with hdf5("records.h5") as f:
    table = np.rec.fromarrays([t, gyro, accel.astype("f4")], dtype=[
        ("time", "f8"), ("gyro", "f8", 3), ("accel", "f4", 3)])
    f.create_dataset("table", data=table).attrs["units"] = ["s", "rad/s", "m/s^2"]
with hdf5("matrix.h5") as f:
    f.create_dataset("data", data=matrix, chunks=(7, 3)).attrs["columns"] = columns
with hdf5("unread.h5") as f:
    f["t"], f["accel"], f["title"] = t, accel, "a log"
    f.create_dataset("gyro", data=gyro, compression="lzf")
with hdf5("virtual.h5") as f:
    layout = h5py.VirtualLayout((N,), "f8")
    layout[:] = h5py.VirtualSource("chunked.h5", "t", (N,))
    f.create_virtual_dataset("gyro_x", layout)

# Numbers that stand for values, as netCDF files have them; attributes that are no numbers.
with hdf5("coded.h5") as f:
    def coded(path, data, unit, **attributes):
        dataset = f.create_dataset(path, data=data)
        dataset.attrs["units"] = unit
        for name, value in attributes.items():
            dataset.attrs[name] = value
    coded("scaled/t", i.astype("i4"), "s", scale_factor=1 / 64)
    coded("scaled/gyro", (7 * i[:, None] + 3 * k).astype(">i2"), "rad/s",
          scale_factor=np.array([1 / 1024], "f4"), add_offset=-50 / 1024, _FillValue=np.int16(-1))
    coded("scaled/accel", (accel / 2).T.astype("f4"), "m/s^2", scale_factor=2)
    times, rates, forces = stamps.copy(), gyro.astype("f4"), (accel * 512).astype("i4")
    times[0] = times[5] = -2**63 + 2
    rates[3, 1], rates[4, 0], forces[7, 2], forces[8] = 1e20, -9999, -2**31, 77
    coded("holes/t", times, "nanoseconds since 1970-01-01", _FillValue=np.int64(-2**63 + 2))
    coded("holes/gyro", rates, "rad/s", _FillValue=1e20, missing_value=np.array([-9999, 1e20]))
    coded("holes/accel", forces, "m/s^2", scale_factor=1 / 512, missing_value=77.0,
          _FillValue=np.int32(-2**31))
    coded("text/t", t, "s")
    coded("text/gyro", gyro, "rad/s", _FillValue=np.nan)
    coded("text/accel", accel, "m/s^2", scale_factor="0.5")
    coded("list/t", t, "s")
    coded("list/accel", accel, "m/s^2", missing_value=1 << 60)
    coded("list/gyro", gyro, "rad/s", scale_factor=[1., 2., 3.])
    coded("table", table, ["s", "rad/s", "m/s^2"], add_offset=1.0)
    coded("sign/t", t, "s")
    coded("sign/accel", accel, "m/s^2")
    coded("sign/gyro", gyro.astype("i2"), "rad/s", _Unsigned="true")

# What save -v7.3 of MATLAB makes: a head in front, and what the numbers are in attributes.
with hdf5("matlab.mat", userblock_size=512) as f:
    def put(group, name, data, kind="double"):
        group.create_dataset(name, data=data).attrs["MATLAB_class"] = np.bytes_(kind)
    put(f, "t", t[None, :])
    put(f, "gyro", gyro.T)
    put(f, "accel", accel.T)
    texts = f.create_group("units")
    for name, text in units.items():
        put(texts, name, np.array([[ord(c)] for c in text], "u2"), "char")
    put(f, "title", np.array([[65]], "u2"), "char")
    put(f, "other", np.zeros((1, 6), "u4"), "table")
    f.create_group("#refs#")
with open("matlab.mat", "r+b") as file:
    file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64, HDF5 schema 1.00 .".ljust(116) +
               b"\0" * 8 + b"\0\2IM")
