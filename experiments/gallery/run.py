#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The gallery: sound logs and faulty ones through imukit identify. See README.md."""
import argparse
import json
import multiprocessing
import re
import signal
import sys
import tempfile
import time
from pathlib import Path

import faults
import measure
import sound
import tables

HERE = Path(__file__).resolve().parent
SOUND_SEEDS, MIDDLE_SEEDS, OTHER_SEEDS = 20, 40, 8
TASK_PAIRS = 12  # a clean log is made again for each of so many faulty ones


def _seeds_of(level, cap):
    if level == 1:
        return min(MIDDLE_SEEDS, cap)
    return min(OTHER_SEEDS, max(1, cap // 4))


def plan(only, cap, what):
    """The tasks: (kind, seed, report the sound log?, [(fault, level)])."""
    chosen = re.compile(only)
    tasks = {}
    for kind in sound.KINDS:
        if what != "faults" and chosen.search(kind.name):
            for seed in range(min(SOUND_SEEDS, cap)):
                tasks[kind.name, seed] = [True, []]
    for fault in faults.FAULTS:
        if what != "sound" and chosen.search(fault.name):
            for level in range(3):
                for seed in range(min(fault.most, _seeds_of(level, cap))):
                    task = tasks.setdefault((fault.base, seed), [False, []])
                    task[1].append((fault.name, level))
    split = []
    for (name, seed), (report, pairs) in tasks.items():
        for first in range(0, max(1, len(pairs)), TASK_PAIRS):
            split.append((name, seed, report and first == 0, pairs[first:first + TASK_PAIRS]))
    return sorted(split, key=lambda task: task[1])  # what is there after some minutes is balanced


def _identify(settings, record, name):
    operands = record.write(settings["folder"], name)
    result = measure.identify(settings["imukit"], operands)
    record.remove(operands[0])
    return result


def _doubts(result):
    return {"doubted": measure.doubted(result), "verdict_doubts": measure.verdict_doubts(result),
            "codes": measure.codes(result), "notes": result["notes"],
            "refused": result["refused"], "channels": result["channels"]}


def _sound_entry(kind, seed, clean):
    def truth_of(channel):
        return sound.truth(kind, channel)
    return {"kind": kind.name, "seed": seed, **_doubts(clean),
            "covered": measure.covered(clean, truth_of),
            "claimed": measure.claimed(clean, truth_of)}


def _pair_entry(fault, level, seed, clean, faulty):
    factor = fault.factor(fault.strengths[level]) if fault.factor else 1
    return {"fault": fault.name, "level": level, "seed": seed, **_doubts(faulty),
            "move": measure.move(clean, faulty, factor),
            "new_extras": measure.new_extras(clean, faulty), "clean_codes": measure.codes(clean)}


def work(job):
    settings, (name, seed, report, pairs) = job
    kind = sound.BY_NAME[name]
    record = sound.make(kind, seed)
    label = "-".join(map(str, (name, seed, *(pairs[0] if pairs else ()))))
    clean = _identify(settings, record, label)
    entries = [("sound", _sound_entry(kind, seed, clean))] if report else []
    for fault_name, level in pairs:
        fault = faults.BY_NAME[fault_name]
        faulty = _identify(settings, faults.make(fault, level, record, seed),
                           f"{label}-{fault_name}-{level}")
        entries.append(("pairs", _pair_entry(fault, level, seed, clean, faulty)))
    return entries


def _stop(number, frame):
    raise KeyboardInterrupt


def _collect(pool, todo, minutes, results):
    start = time.time()
    for done, entries in enumerate(pool.imap_unordered(work, todo), 1):
        for which, entry in entries:
            results[which].append(entry)
        if done % 20 == 0 or done == len(todo):
            print(f"{done} of {len(todo)} tasks, {time.time() - start:.0f} s", file=sys.stderr)
        if time.time() - start > 60 * minutes:
            print(f"stopped after {minutes} minutes", file=sys.stderr)
            break


def run(settings, tasks, jobs, minutes):
    """What is there when it is interrupted is kept."""
    results = {"sound": [], "pairs": []}
    todo = [(settings, task) for task in tasks]
    with multiprocessing.Pool(jobs, signal.signal, (signal.SIGINT, signal.SIG_IGN)) as pool:
        signal.signal(signal.SIGTERM, _stop)
        try:
            _collect(pool, todo, minutes, results)
        except KeyboardInterrupt:
            print("interrupted", file=sys.stderr)
    results["sound"].sort(key=lambda e: (e["kind"], e["seed"]))
    results["pairs"].sort(key=lambda e: (e["fault"], e["level"], e["seed"]))
    return results


def arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", nargs="?", choices=("all", "sound", "faults"), default="all")
    parser.add_argument("--only", default="", help="kinds and faults whose name matches REGEX")
    parser.add_argument("--seeds", type=int, default=40,
                        help="at most so many logs of a kind or a fault; default 40")
    parser.add_argument("--imukit", default=str(HERE.parent.parent / "build" / "imukit"))
    parser.add_argument("--jobs", type=int, default=1, help="processes; default 1")
    parser.add_argument("--minutes", type=float, default=1e9,
                        help="stop after this time with what is there, first seeds first")
    parser.add_argument("--scratch", help="folder for the logs; default: a temporary one")
    parser.add_argument("-o", "--output", help="write the results to this JSON file")
    parser.add_argument("--list", action="store_true", help="print kinds and faults only")
    return parser.parse_args()


def main():
    options = arguments()
    if options.list:
        print(tables.catalogue())
        return
    tasks = plan(options.only, options.seeds, options.what)
    if options.scratch:
        Path(options.scratch).mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=options.scratch) as folder:
        settings = {"imukit": options.imukit, "folder": folder}
        results = run(settings, tasks, options.jobs, options.minutes)
    if options.output:
        Path(options.output).write_text(json.dumps(results), encoding="utf-8")
    print(tables.report(results))


if __name__ == "__main__":
    main()
