#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What the Python package costs beside the library: a call, and an array against the command.

    PYTHONPATH=build/python-package bench/python_calls.py [ROWS]

Times of a function on an array and of the command on the same numbers in a .npy, in turn, the least
of several, in processor seconds on one thread; the function in a process that has the array already.
The memory is what the function needs beside the array, and what the command needs beside nothing,
as the peak of a process of its own."""
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time
import timeit

import numpy

import imukit

ROOT = pathlib.Path(__file__).resolve().parent.parent
COMMAND = ROOT / os.environ.get("BUILD", "build") / "imukit"
COLUMNS = [f"{sensor}_{axis} [{unit}]" for sensor, unit in (("gyro", "rad/s"), ("accel", "m/s^2"))
           for axis in "xyz"]
FUNCTIONS = {"allan": imukit.allan, "identify": imukit.identify}


def processor():
    return sum(os.times()[:4])


def seconds(function):
    begin = processor()
    function()
    return processor() - begin


def by_command(verb, file):
    subprocess.run([COMMAND, verb, file, "--rate", "200Hz", "--threads", "1"], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def peak(code):
    """Largest memory of a process of its own [MB]."""
    pid = os.fork()
    if pid == 0:
        code()
        os._exit(0)
    return os.wait4(pid, 0)[2].ru_maxrss / 1024


def replaced(*words):
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    os.dup2(1, 2)
    os.execv(words[0], [str(word) for word in words])


def compare(verb, data, file):
    function = FUNCTIONS[verb]

    def call():
        function(data, 200, columns=COLUMNS, threads=1)

    times = [(seconds(call), seconds(lambda: by_command(verb, file))) for _ in range(7)]
    mine, command = (min(column) for column in zip(*times))
    print(f"{verb}, {data.shape[0]} x {data.shape[1]}: {mine:.3f} s, command {command:.3f} s, "
          f"ratio {mine / command:.3f}")
    loaded = ("import numpy, imukit\n"
              f"data = numpy.load({str(file)!r})\n")
    script = (loaded + f"imukit.{verb}(data, 200, columns={COLUMNS!r}, threads=1)\n")
    before = peak(lambda: replaced(sys.executable, "-c", loaded))
    with_call = peak(lambda: replaced(sys.executable, "-c", script))
    alone = peak(lambda: replaced(COMMAND, verb, file, "--rate", "200Hz", "--threads", "1"))
    print(f"{verb}: {with_call - before:.1f} MB beside the array of {data.nbytes / 2**20:.1f} MB, "
          f"command {alone:.1f} MB in all")


def main():
    rows = int(sys.argv[1]) if len(sys.argv) > 1 else 1000000
    for name, code in (("normal_gravity", "imukit.normal_gravity(0.7, 100.0)"),
                       ("convert_unit", "imukit.convert_unit(1.0, 'deg/h', 'rad/s')")):
        best = min(timeit.repeat(code, "import imukit", number=100000, repeat=5)) / 100000
        print(f"{name}: {1e9 * best:.0f} ns a call")
    data = numpy.random.default_rng(1).normal(0, 1e-3, (rows, 6))
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder, "log.npy")
        numpy.save(file, data)
        pathlib.Path(folder, "log.npy.columns").write_text("\n".join(COLUMNS) + "\n")
        for verb in FUNCTIONS:
            compare(verb, data, file)


if __name__ == "__main__":
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    main()
