#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes tests/left_out_sanitized.txt: the test cases that the check `sanitize` leaves out, because
the others reach nearly every place of the libraries and of the command that they reach.

    tools/select_sanitized.py    builds in build-check/coverage and runs every case alone

A place is a region of clang's coverage: code between two branches. What reads strangers' bytes is
always run with all there is: the cases of tests/io and the fuzz targets with their saved inputs.
Tests that are programs apart are also run, and what all these reach need not be reached again. Of
the other cases, the one with the most new places for its processor time is taken next, down to
LEAST a second; then those whose places others have by now are dropped, the slowest first. A file of which a
case fails alone is taken as a whole. Cases that are not in the list, such as new ones, are run.
Packages: those of the group `fuzz`. It takes about ten minutes of two processors."""
import concurrent.futures
import heapq
import itertools
import os
import pathlib
import re
import shlex
import signal
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = pathlib.Path(os.environ.get("COVERAGE_BUILD", ROOT / "build-check/coverage"))
HEAD = """# SPDX-License-Identifier: Apache-2.0
# Written by tools/select_sanitized.py: test files and cases that `tools/check sanitize` leaves out.
"""
LIST = ROOT / "tests/left_out_sanitized.txt"
# As in tools/check_sanitize.sh. Logs beside the checkout are not everywhere: nothing relies on them.
ENVIRONMENT = {**os.environ, "IMUKIT_TEST_DRAWS": "1000000", "IMUKIT_TEST_RUNS": "20"}
COUNTING = "-O1 -fprofile-instr-generate -fcoverage-mapping"
# New places for a second of processor time: a third of the time is spent on the last 0.3 % of places.
LEAST = 8
NUMBERS, UNUSED = {}, itertools.count()  # of places
NO_LOGS = '-USHARED_DIRECTORY -DSHARED_DIRECTORY=\\"/absent\\"'


def output(*words):
    quiet = {**os.environ, "LLVM_PROFILE_FILE": "/dev/null"}
    return subprocess.run(words, check=True, capture_output=True, text=True, env=quiet).stdout


def build():
    output("cmake", "-S", ROOT, "-B", BUILD, "-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_C_COMPILER=clang",
           f"-DCMAKE_C_FLAGS={NO_LOGS}", f"-DCMAKE_C_FLAGS_DEBUG={COUNTING}", "-DIMUKIT_SHARED=OFF",
           "-DIMUKIT_TESTS=ON", "-DIMUKIT_MPI=OFF", "-DIMUKIT_EXAMPLES=OFF")
    output("cmake", "--build", BUILD, "-j", str(os.cpu_count()))


def public_functions():
    """Names of what the libraries and the command define."""
    objects = [*BUILD.glob("*.a"), *BUILD.glob("CMakeFiles/imukit-command*.dir/**/*.o")]
    return set(re.findall(r" T (\w+)$", output("nm", *objects), re.MULTILINE))


def sources():
    return {path.name for folder in ["src", "cli"] for path in (ROOT / folder).rglob("*.c")}


def run(words):
    """Whether this succeeds, its processor time [s], and the places reached."""
    with tempfile.TemporaryDirectory() as folder:
        environment = {**ENVIRONMENT, "LLVM_PROFILE_FILE": f"{folder}/%m.profraw"}
        timed = ["bash", "-c", 'TIMEFORMAT="%U %S"; time timeout 600 "$@" >/dev/null 2>&1', "-",
                 *words]
        ran = subprocess.run(timed, env=environment, capture_output=True, text=True)
        profiles = [str(path) for path in pathlib.Path(folder).glob("*.profraw")]
        # What a case ends by a signal leaves no profile, or part of one.
        merge = ["llvm-profdata", "merge", "-sparse", "-text", "-failure-mode=all", "-o", "-"]
        text = subprocess.run([*merge, *profiles], capture_output=True, text=True).stdout
    time = sum(map(float, ran.stderr.split()[-2:]))
    return ran.returncode == 0, time, places(text)


def places(text):
    found = set()
    for block in re.sub(r"^:.*\n", "", text, flags=re.MULTILINE).split("\n\n"):
        lines = [line for line in block.splitlines() if not line.startswith("#")]
        if lines and ours(lines[0]):
            counters = enumerate(lines[3:3 + int(lines[2])])
            found.update(NUMBERS.setdefault((lines[0], i), next(UNUSED))
                         for i, count in counters if count != "0")
    return found


def ours(function):
    file, _, name = function.rpartition(":")
    return pathlib.Path(file).name in SOURCES if file else name in PUBLIC


def programs():
    """The commands of tests that are not cases, and the cases by file."""
    listed = output("ctest", "--test-dir", BUILD, "-N", "-V")
    commands = [shlex.split(line) for line in re.findall(r"Test command: (.*)", listed)]
    apart = [words for words in commands if not words[0].endswith("/imukit-tests")]
    cases = []
    for file in output(BUILD / "imukit-tests").split():
        text = (next(ROOT.glob(f"tests/**/{file}.c"))).read_text(encoding="utf-8")
        names = re.findall(r"cmocka_unit_test\w*\(\s*(\w+)", text)
        cases += [(file, name) for name in dict.fromkeys(names)]
    return apart, cases


def select(cost, reaches, reached):
    """The cases that reach, with what is reached, what all of them do, but for what takes long."""
    reached, chosen = set(reached), []
    queue = [(-len(reaches[case]) / cost[case], case) for case in cost]
    heapq.heapify(queue)
    while queue:
        _, case = heapq.heappop(queue)
        worth = -len(reaches[case] - reached) / cost[case]
        if queue and worth > queue[0][0]:  # others are worth more by now
            heapq.heappush(queue, (worth, case))
        elif -worth >= LEAST:
            chosen.append(case)
            reached |= reaches[case]
    return chosen


def drop_needless(cost, reaches, reached, chosen):
    count = {}
    for case in chosen:
        for place in reaches[case] - reached:
            count[place] = count.get(place, 0) + 1
    kept = set(chosen)
    for case in sorted(chosen, key=lambda case: -cost[case]):
        new = reaches[case] - reached
        if all(count[place] > 1 for place in new):
            kept.remove(case)
            for place in new:
                count[place] -= 1
    return kept


def is_fixed(file):
    return any(ROOT.glob(f"tests/io/**/{file}.c"))


def units(cases, results):
    """What is taken or left at once: a case, or the file of one that fails alone."""
    whole = {case[0] for case, (passed, _, _) in zip(cases, results) if not passed}
    members, cost, reaches = {}, {}, {}
    for case, (_, time, found) in zip(cases, results):
        unit = (case[0], "") if case[0] in whole else case
        members.setdefault(unit, []).append(case)
        cost[unit] = cost.get(unit, 0.005) + time
        reaches[unit] = reaches.get(unit, set()) | found
    return members, cost, reaches


def main():
    global PUBLIC, SOURCES
    for number in [signal.SIGINT, signal.SIGQUIT]:  # a shell's background ignores them; tests do not
        signal.signal(number, signal.SIG_DFL)
    build()
    PUBLIC, SOURCES = public_functions(), sources()
    apart, cases = programs()
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        reached = set().union(*(found for _, _, found in pool.map(run, apart)))
        program = str(BUILD / "imukit-tests")
        results = list(pool.map(lambda case: run([program, *case]), cases))
    write_list(cases, results, reached)


def write_list(cases, results, reached):
    members, cost, reaches = units(cases, results)
    total = sum(cost.values())
    everything = reached.union(*reaches.values())
    for unit in [unit for unit in members if is_fixed(unit[0])]:
        reached = reached | reaches.pop(unit)
        del members[unit], cost[unit]
    kept = drop_needless(cost, reaches, reached, select(cost, reaches, reached))
    missed = everything - reached.union(*(reaches[unit] for unit in kept))
    left = sorted(case for unit in members if unit not in kept for case in members[unit])
    LIST.write_text(HEAD + "".join(f"{file} {case}\n" for file, case in left), encoding="utf-8")
    spared = sum(cost[unit] for unit in members if unit not in kept)
    print(f"{len(left)} of {len(cases)} cases left out, {spared:.0f} of {total:.0f} s; "
          f"the others reach all but {len(missed)} of {len(everything)} places")


if __name__ == "__main__":
    sys.exit(main())
