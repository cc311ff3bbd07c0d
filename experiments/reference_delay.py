#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How often calibrate tells a delay between readings and reference columns: on sound logs, which it
should not, and on logs whose reference comes too early, which it should.

    experiments/reference_delay.py [SEEDS] [IMUKIT]    default 60, build/imukit

A head turns by equal steps (any whole number of steps fits alike) or by steps of different angles
and lengths, from simulate with --truth, whose true force is the reference.
"""
import csv
import pathlib
import subprocess
import sys
import tempfile

START = """imukit_motion: 1
start: {latitude: 48.1 deg, longitude: 11.6 deg, height: 520 m}
steps:
  - hold 3 s
"""
STEPS = [("y", 40, 3), ("x", 75, 4), ("y", 90, 3.5), ("x", -110, 5), ("y", 60, 3), ("z", 90, 3),
         ("x", 50, 4.2), ("y", -120, 3), ("x", 160, 4)]
MOTIONS = {
    "equal": START + "  - repeat: {times: 11, steps: [rotate y 30 deg at 30 deg/s, hold 3 s]}\n"
                     "then: hold\n",
    "unequal": START + "".join(f"  - rotate {axis} {angle} deg at 30 deg/s\n  - hold {time} s\n"
                               for axis, angle, time in STEPS) + "then: hold\n",
}
LENGTH = {"equal": "47s", "unequal": "65s"}
RATE = 100
FIRST_READING, FIRST_FORCE = 1, 14  # columns: of the log, of the truth


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.reader(file))


def says(imukit, folder, preset, motion, seed, delay):
    """Does calibrate tell a delay, and which?"""
    log, truth, table = folder / "log.csv", folder / "truth.csv", folder / "table.csv"
    script = folder / "motion.yaml"
    script.write_text(MOTIONS[motion])
    subprocess.run([imukit, "simulate", preset, "--motion", script, "--rate", f"{RATE}Hz",
                    "--duration", LENGTH[motion], "--seed", str(seed), "-o", log, "--truth", truth],
                   check=True, capture_output=True)
    readings, true = rows_of(log), rows_of(truth)
    shift = round(delay * RATE)
    with open(table, "w", newline="") as file:
        out = csv.writer(file)
        out.writerow(readings[0][:7] + [f"reference_force_{axis} [m/s^2]" for axis in "xyz"])
        for i in range(1, len(readings)):
            if 1 <= i - shift < len(true):
                out.writerow(readings[i][:7] + true[i - shift][FIRST_FORCE:FIRST_FORCE + 3])
    done = subprocess.run([imukit, "calibrate", table, "-p", "tumble", "--position",
                           "48.1 deg, 11.6 deg, 520 m"], capture_output=True, text=True)
    if done.returncode not in (0, 2):
        sys.exit(done.stderr)
    return "readings are" in done.stdout + done.stderr


def main():
    seeds = int(sys.argv[1]) if len(sys.argv) > 1 else 60
    imukit = sys.argv[2] if len(sys.argv) > 2 else "build/imukit"
    print("preset    steps    delay [s]  told")
    with tempfile.TemporaryDirectory() as name:
        for motion in MOTIONS:
            for delay in (0.0, 0.3, 2.0):
                for preset in ("tactical", "AHRS"):
                    if motion == "equal" and delay > 0.0:
                        continue  # several steps fit alike: what is told there is another matter
                    told = sum(says(imukit, pathlib.Path(name), preset, motion, seed, delay)
                               for seed in range(1, seeds + 1))
                    print(f"{preset:9} {motion:8} {delay:9.1f}  {told} of {seeds}", flush=True)


if __name__ == "__main__":
    main()
