#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Benches with mistakes through imukit calibrate and evaluate. See README.md."""
import argparse
import itertools
import json
import math
import re
import subprocess
import sys
import tempfile
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import noise
import sessions
from records import Column

HERE = Path(__file__).resolve().parent
POSES, FACES, TABLE = "multiposition", "sixposition", "rate-table"


@dataclass
class Bench:
    name: str
    item: str
    procedure: str
    strengths: tuple
    about: str
    session: callable  # (rng, strength): unit, session
    spoil: callable = None  # (record, rng, strength): the mistake; None: sound
    options: callable = None  # (strength): options of imukit
    undecidable: str = ""


# ---- sessions ----------------------------------------------------------------------------------


def by_hand(rng, strength):
    return sessions.draw_unit(rng), sessions.poses(rng, 24)


def uneven_axes(rng, strength):
    unit = sessions.draw_unit(rng)
    unit.accel_white *= np.array([1, 1, strength])
    unit.gyro_white *= np.array([1, 1, strength])
    return unit, sessions.poses(rng, 24)


def few_poses(rng, strength):
    return sessions.draw_unit(rng), sessions.poses(rng, int(strength))


def few_attitudes(rng, strength):
    return sessions.draw_unit(rng), sessions.poses(rng, 24, int(strength))


def six(rng, strength):
    return (sessions.draw_unit(rng, full_frame=True),
            sessions.six_faces(rng, 3, np.radians(strength)))


def few_faces(rng, strength):
    return (sessions.draw_unit(rng, full_frame=True),
            sessions.six_faces(rng, 3, np.radians(0.1), int(strength)))


def six_once(rng, strength):
    return (sessions.draw_unit(rng, full_frame=True),
            sessions.six_faces(rng, 1, np.radians(strength)))


def six_uneven(rng, strength):
    unit, session = six(rng, 0.1)
    unit.accel_white *= np.array([1, 1, strength])
    return unit, session


def table(rng, strength):
    return sessions.draw_unit(rng, g_sensitivity=strength), sessions.rate_table(rng)


# ---- mistakes ----------------------------------------------------------------------------------


def rate_option(record, rng, strength):
    record.time, record.rate = None, strength / record.dt


def scale(first, count):
    def spoil(record, rng, strength):
        for column in record.columns[first:first + count]:
            column.values = column.values * strength
    return spoil


def exchange(*pairs):
    def spoil(record, rng, strength):
        for i, j in pairs:
            a, b = record.columns[i], record.columns[j]
            a.values, b.values = b.values, a.values
    return spoil


def invert(*which):
    def spoil(record, rng, strength):
        for i in which:
            record.columns[i].values = -record.columns[i].values
    return spoil


def nan_rows(record, rng, strength):
    for column in record.columns:
        column.values[rng.random(record.rows) < strength] = np.nan


def add_reference(record, rates):
    """Columns of the true rates, which the table reports."""
    for i, a in enumerate(sessions.AXES):
        record.columns.append(Column(f"reference_rate_{a}", "rad/s", rates[:, i].copy()))


def late_reference(record, rng, strength):
    """The columns of the reference are late by `strength` seconds."""
    shift = int(round(strength / record.dt))
    for column in record.columns[6:]:
        column.values = np.concatenate((np.full(shift, column.values[0]), column.values[:-shift]))


# ---- the list ----------------------------------------------------------------------------------


def _nothing(strength):
    return []


BENCHES = [
    Bench("poses", "sound", POSES, (0,), "24 poses by hand", by_hand),
    Bench("six_faces", "sound", FACES, (0.02, 0.1), "six faces three times, placement [deg] as "
          "stated", six, options=lambda s: ["--placement", f"{s}deg"]),
    Bench("six_once", "sound", FACES, (0.1,), "six faces once", six_once),
    Bench("table", "sound", TABLE, (0.001,), "three attitudes, rates to 120 deg/s; no "
          "g-sensitivity", table, options=lambda s: ["--without", "nonlinearity,g_sensitivity"]),
    Bench("rate_close", "11", POSES, (1.02,), "a slightly wrong --rate, no time column", by_hand,
          rate_option, undecidable="gyros with this scale factor exist"),
    Bench("rate", "11", POSES, (0.8, 0.5, 2), "wrong --rate, no time column", by_hand, rate_option),
    Bench("gyro_range", "11", POSES, (0.5, 2, 4), "gyros by a wrong range", by_hand, scale(0, 3)),
    Bench("gyro_unit", "11", POSES, (57.29578, 1 / 57.29578), "deg/s for rad/s and the other way",
          by_hand, scale(0, 3)),
    Bench("accel_unit", "11", POSES, (1 / 9.80665, 2, 0.5), "accelerometers by a wrong unit or "
          "range", by_hand, scale(3, 3)),
    Bench("gyros_exchanged", "14", POSES, (1,), "gyro x and y exchanged", by_hand,
          exchange((0, 1))),
    Bench("accels_exchanged", "14", POSES, (1,), "accelerometer x and y exchanged", by_hand,
          exchange((3, 4))),
    Bench("both_exchanged", "14", POSES, (1,), "x and y of both exchanged: left-handed", by_hand,
          exchange((0, 1), (3, 4))),
    Bench("left_handed", "14", POSES, (1,), "z of both inverted: left-handed", by_hand,
          invert(2, 5)),
    Bench("gyros_inverted", "14", POSES, (1,), "all gyros inverted", by_hand, invert(0, 1, 2)),
    Bench("accels_inverted", "14", POSES, (1,), "all accelerometers inverted", by_hand,
          invert(3, 4, 5), undecidable="gravity up instead of down: all axes the other way round"),
    Bench("placement", "12", FACES, (0.2, 0.3, 1), "placement [deg] instead of 0.1 assumed, "
          "three times", six),
    Bench("placement_once", "12", FACES, (0.3, 1), "the same, each face once", six_once),
    Bench("six_uneven", "12", FACES, (10, 100), "noise of one accelerometer times", six_uneven),
    Bench("poses_uneven", "12", POSES, (10, 100), "noise of the z axes times", uneven_axes),
    Bench("g_sensitivity", "15", TABLE, (5, 20, 100), "deg/h/g, not estimated", table,
          options=lambda s: ["--without", "nonlinearity,g_sensitivity"]),
    Bench("table_late", "15", TABLE, (0.05, 0.5, 2), "reference late [s]",
          lambda rng, s: table(rng, 0.001), late_reference,
          lambda s: ["--without", "nonlinearity,g_sensitivity"]),
    Bench("few_poses", "16", POSES, (2, 3, 5), "this many poses", few_poses),
    Bench("few_attitudes", "16", POSES, (2, 3, 4), "24 poses in so many attitudes, to 2 deg",
          few_attitudes),
    Bench("few_faces", "16", FACES, (1, 2, 4), "this many faces, three times", few_faces),
    Bench("nan_rows", "16", POSES, (0.001, 0.01, 0.1), "share of cells that are NaN", by_hand,
          nan_rows),
    Bench("gravity", "16", POSES, (1.003, 1.01, 1.05), "--gravity times", by_hand,
          options=lambda s: ["--gravity", f"{s * sessions.GRAVITY:.6f}m/s^2"]),
]


# ---- running -----------------------------------------------------------------------------------


def _refusal(done):
    """The error that a command printed, without the path of its log."""
    lines = [line for line in done.stderr.splitlines() if "error" in line]
    return re.sub(r"^imukit \w+: error: (\S+\.npy:? )?", "", lines[0]) if lines else "no output"


def _calibrate(settings, operands, procedure, options):
    command = ["nice", settings["imukit"], "calibrate", *operands, "--procedure", procedure,
               "--json", *sessions.POSITION, *options]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    result = {"exit": done.returncode, "refused": None, "doubts": [], "warnings": [],
              "verdict": "", "parameters": []}
    data = json.loads(done.stdout or "{}")
    if "result" not in data:
        result["refused"] = _refusal(done)
        return result
    found = data["result"]
    result["warnings"] = [w["code"] for w in data["findings"] if w["level"] == "warning"]
    result["verdict"] = found["verdict"]
    result["level"] = found["level"]
    result["doubts"] = [s["code"] for s in found["sentences"]
                        if s["level"] in ("warning", "useless", "failure")]
    if found["level"] in ("warning", "useless", "failure"):
        result["doubts"].append(found["level"])
    if found["level"] == "useless" or done.returncode:
        result["refused"] = re.sub(r"\S+\.npy:? ", "", found["verdict"])
    result["parameters"] = found["parameters"]
    return result


def _errors(result, truth):
    """For each parameter (error / sigma, error / half-width of the interval, name)."""
    errors = []
    for p in result["parameters"]:
        true = truth.get(p["name"])
        if true is not None and p["sigma"] and p["upper"] is not None and p["lower"] is not None:
            error, half = p["value"] - true, (p["upper"] - p["lower"]) / 2
            errors.append((error / p["sigma"], error / half, p["name"]))
    return errors


def _groups(errors):
    """Intervals that hold the truth, and all, of each kind of parameter."""
    groups = {}
    for _, distance, name in errors:
        count = groups.setdefault(".".join(name.split(".")[:2]), [0, 0])
        count[0] += abs(distance) <= 1
        count[1] += 1
    return {name: [int(held), total] for name, (held, total) in groups.items()}


def one(settings, bench, strength, seed):
    # The session is the same at every strength and with every mistake.
    rng = noise.generator("bench", bench.session.__name__, seed)
    unit, session = bench.session(rng, strength)
    record, rates, _ = session.read(rng, unit)
    if bench.procedure == TABLE:
        add_reference(record, rates)
    if bench.spoil:
        bench.spoil(record, rng, strength)
    operands = record.write(settings["folder"], "bench")
    options = bench.options(strength) if bench.options else []
    result = _calibrate(settings, operands, bench.procedure, options)
    record.remove(operands[0])
    errors = _errors(result, unit.truth())
    worst = max(errors, key=lambda e: abs(e[1])) if errors else None
    return {"bench": bench.name, "strength": strength, "seed": seed, "refused": result["refused"],
            "doubted": bool(result["refused"] or result["doubts"] or result["warnings"]),
            "codes": result["doubts"] + ["stderr:" + w for w in result["warnings"]],
            "verdict": result["verdict"], "parameters": len(errors),
            "groups": _groups(errors),
            "z": math.sqrt(np.mean([e[0] ** 2 for e in errors])) if errors else None,
            "worst": worst and {"name": worst[2], "half_widths": worst[1]}}


def _coverage(entries):
    """Share of the intervals that hold the truth, and the kind with the least, as texts."""
    groups = {}
    for e in entries:
        for name, (held, total) in e["groups"].items():
            count = groups.setdefault(name, [0, 0])
            count[0], count[1] = count[0] + held, count[1] + total
    if not groups:
        return "-", ""
    least = min(groups, key=lambda name: groups[name][0] / groups[name][1])
    held, total = (sum(count[k] for count in groups.values()) for k in range(2))
    return (f"{100 * held / total:.1f} %",
            f"{least} {100 * groups[least][0] / groups[least][1]:.0f} %")


def summary(entries):
    """A line of the table for the entries of one bench and strength."""
    rest = [e for e in entries if not e["refused"]]
    wrong = [e for e in rest if e["worst"] and abs(e["worst"]["half_widths"]) > 3]
    clear = [e for e in wrong if not e["doubted"]]
    z = np.median([e["z"] for e in rest if e["z"] is not None]) if wrong or rest else math.nan
    words = []
    if clear:
        worst = max((e["worst"] for e in clear), key=lambda w: abs(w["half_widths"]))
        words.append(f"{worst['name']} {worst['half_widths']:+.3g} half-widths")
    words += [f"{code} {n}" for code, n in Counter(c for e in rest for c in e["codes"])
              .most_common()]
    refusals = Counter(e["refused"][:100] for e in entries if e["refused"])
    words += [f"refused: {text}" for text, _ in refusals.most_common(1)]
    coverage, least = _coverage(rest)
    return (f"{len(entries):4} {len(entries) - len(rest):4} "
            f"{sum(not e['doubted'] for e in rest):5} {len(wrong):5} {len(clear):6} "
            f"{coverage:>7} {least:24} {z:8.3g}  {'; '.join(words)}")


HEAD = (f"{'bench':17} {'strength':>8} runs ref. clear wrong w.cle. {'hold':>7} "
        f"{'least':24} {'rms':>8}  worst all-clear; codes\n")


def run_benches(settings, only, seeds):
    entries = []
    print(HEAD)
    for bench in BENCHES:
        if not re.search(only, bench.name):
            continue
        for strength in bench.strengths:
            group = [one(settings, bench, strength, seed) for seed in range(seeds)]
            entries += group
            mark = "undecidable: " + bench.undecidable if bench.undecidable else ""
            print(f"{bench.name:17} {strength:8.4g} {summary(group)}  {mark}", flush=True)
    return entries


def run_signs(settings, seeds):
    """Every combination of inverted axes, by hand."""
    names = [f"{s}_{a}" for s in ("gyro", "accel") for a in "xyz"]
    entries, clear = [], []
    for size in range(1, 7):
        for which in itertools.combinations(range(6), size):
            label = " ".join(names[i] for i in which)
            bench = Bench("inverted " + label, "14", POSES, (1,), "", by_hand, invert(*which))
            group = [one(settings, bench, 1, seed) for seed in range(seeds)]
            entries += group
            if any(not e["doubted"] for e in group):
                clear.append(label)
            print(f"{label:48} refused {sum(bool(e['refused']) for e in group)}, clear "
                  f"{sum(not e['doubted'] for e in group)} of {len(group)}: "
                  f"{(group[0]['refused'] or group[0]['verdict'])[:80]}", flush=True)
    print(f"inverted axes with an all-clear: {len(clear)} of 63: {'; '.join(clear)}")
    return entries


# ---- evaluate ----------------------------------------------------------------------------------


def _sweep(rng):
    """Steps of a table up and down about z, twice, for evaluate."""
    unit, session = sessions.draw_unit(rng, g_sensitivity=0.001), sessions.Session()
    for _ in range(2):
        session.rest(5)
        for rate in (100, 200, 300, 200, 100, 0, -100, -200, -300, -200, -100):
            session.spin(2, np.radians(rate), 5)
        session.rest(5)
    return session.read(rng, unit)


def evaluate_once(settings, delay, seed):
    rng = noise.generator("evaluate", seed)
    record, rates, _ = _sweep(rng)
    record.columns[3:] = [Column("reference_rate_z", "rad/s", rates[:, 2].copy())]
    shift = int(round(delay / record.dt))
    if shift:
        column = record.columns[3]
        column.values = np.concatenate((np.full(shift, column.values[0]), column.values[:-shift]))
    operands = record.write(settings["folder"], "sweep")
    done = subprocess.run(["nice", settings["imukit"], "evaluate", *operands, "--json"],
                          capture_output=True, text=True, check=False)
    record.remove(operands[0])
    data = json.loads(done.stdout or "{}")
    if "result" not in data:
        return {"refused": _refusal(done), "figures": {}, "warnings": []}
    channel = [c for c in data["result"]["channels"] if c["name"] == "gyro_z"][0]
    return {"refused": None, "figures": channel["figures"],
            "warnings": [w["code"] for w in data["findings"] if w["level"] == "warning"]}


def _moved(clean, late):
    """Figures that move by more than three half-widths of the clean interval."""
    for name, f in clean["figures"].items():
        g = late["figures"].get(name, {})
        ends = (f.get("value"), f.get("lower"), f.get("upper"), g.get("value"))
        if None not in ends and abs(ends[3] - ends[0]) > 1.5 * (ends[2] - ends[1]) > 0:
            yield name


def run_evaluate(settings, seeds):
    print("\nevaluate, a reference that is late [s]: runs, refused, warned, median hysteresis [%],"
          " figures beyond 3 half-widths")
    entries = []
    clean = [evaluate_once(settings, 0, seed) for seed in range(seeds)]
    for delay in (0, 0.05, 0.1, 0.5, 1):
        group = [evaluate_once(settings, delay, seed) for seed in range(seeds)]
        moved = Counter(name for a, b in zip(clean, group) for name in _moved(a, b))
        loop = [e["figures"]["hysteresis"]["value"] for e in group if e["figures"]]
        print(f"{delay:5} {len(group):4} {sum(bool(e['refused']) for e in group):4} "
              f"{sum(bool(e['warnings']) for e in group):4} "
              f"{100 * np.median(loop) if loop else math.nan:9.4g}  "
              + ", ".join(f"{name} {n}" for name, n in moved.most_common())
              + (group[0]["refused"] or ""), flush=True)
        entries += [{"bench": "evaluate_late", "strength": delay, "seed": seed, **e}
                    for seed, e in enumerate(group)]
    return entries


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="", help="benches whose name matches REGEX; also "
                        "\"signs\" and \"evaluate\"")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--imukit", default=str(HERE.parent.parent / "build" / "imukit"))
    parser.add_argument("--scratch", help="folder for the logs; default: a temporary one")
    parser.add_argument("-o", "--output", help="write the results to this JSON file")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(dir=options.scratch) as folder:
        settings = {"imukit": options.imukit, "folder": folder}
        entries = run_benches(settings, options.only, options.seeds)
        if re.search(options.only, "signs"):
            entries += run_signs(settings, min(options.seeds, 3))
        if re.search(options.only, "evaluate"):
            entries += run_evaluate(settings, options.seeds)
    if options.output:
        Path(options.output).write_text(json.dumps(entries), encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
