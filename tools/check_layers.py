#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How the files stand to each other (CONTRIBUTING.md, "Where things go").

Layers: a module includes only headers from layers to its left; within braces nothing includes its
neighbour. The command includes public headers and its own.

    base < model < {noise, motion} < {simulate, identify, compensate}
         < {calibrate, navigate, physics} < jobs < report < io < cli

Rooms: a folder holds at most 35 files.

Loops: where one file uses what another defines, and that one, perhaps through others, what the
first defines, there are at most three of them, of one folder. Who uses what is read from the
compiled objects.
"""
import collections
import os
import pathlib
import re
import subprocess
import sys

LAYERS = [["base"], ["model"], ["noise", "motion"], ["simulate", "identify", "compensate"],
          ["calibrate", "navigate", "physics"], ["jobs"], ["report"], ["io"], ["cli"]]
RANK = {module: rank for rank, modules in enumerate(LAYERS) for module in modules}

# Module of each public header. A new one must be added here, but for those of instruments, and of
# jobs, which are what imukit/jobs.h gathers besides.
PUBLIC = {
    "base": "attitude decimal distributions elementary executor fourier least_squares "
            "linear_algebra names random samples status units utf8",
    "model": "correct device_sensitivity distort model model_join model_parameter model_path "
             "model_unstated technology_map",
    "noise": "filter_noise noise",
    "motion": "earth motion motion_script",
    "simulate": "sensor simulate",
    "identify": "allan allan_fit allan_gaps allan_stream identify identify_joint identify_plan "
                "identify_record noise_map record_screen spectrum",
    "compensate": "compensate firmware",
    "calibrate": "axes_mending calibration calibration_plan evaluate ferraris magnetometer procedure "
                 "reference_alignment repeatability static_detection test_record thermal",
    "navigate": "aiding alignment drift filter_tuning navigate navigation_filter "
                "navigation_smoother standing_start standstill",
    "physics": "instrument laboratory",  # and of each folder of src/physics
    "report": "report result schematic show",
    "io": "campaign design_file figure_file firmware_file io log memory_limit model_file "
          "aid_text motion_file output_file parameter_file thread_pool",
}
MODULE_OF = {name: module for module, names in PUBLIC.items() for name in names.split()}
# Headers that gather others, for users: each public header is in one of them.
GATHERING = {"imukit", "physics", "jobs", "io"}

ROOM = 35
LOOP = 3
TREES = ("src", "cli", "tests")
OBJECTS = ["imukit-objects", "imukit-physics-objects", "imukit-io-objects",
           "imukit-command-objects"]

ROOT = pathlib.Path(__file__).resolve().parent.parent
MODULE_OF |= {folder.name: "physics" for folder in (ROOT / "src/physics").iterdir()
              if folder.is_dir()}
BUILD = ROOT / os.environ.get("BUILD", "build")
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"')


def gather_jobs():
    """Add what imukit/jobs.h gathers to the modules of public headers."""
    for _, target in includes(ROOT / "include/imukit/jobs.h"):
        MODULE_OF.setdefault(pathlib.Path(target).stem, "jobs")


def code_files():
    return [file for tree in ("src", "cli") for file in sorted((ROOT / tree).rglob("*.[ch]"))]


def includes(file):
    """Lines and targets of the #include "…" of a file."""
    lines = file.read_text(encoding="utf-8").splitlines()
    return [(number, match[1]) for number, line in enumerate(lines, 1)
            if (match := INCLUDE.match(line))]


# ---- layers --------------------------------------------------------------------------------------

def module_of(file):
    """The module a file belongs to."""
    parts = file.relative_to(ROOT).parts
    if parts[0] == "include":
        return MODULE_OF.get(file.stem)
    return parts[1] if parts[0] == "src" else parts[0]


def included_file(file, target):
    """Where a header lies: public, beside its includer, or below src (cli, for the command)."""
    own = ROOT / ("cli" if module_of(file) == "cli" else "src")
    places = (ROOT / "include" / target, file.parent / target, own / target)
    return next((place.resolve() for place in places if place.exists()), None)


def wrong_include(file, target):
    """What is wrong with an #include, or None."""
    module, header = module_of(file), included_file(file, target)
    if header is None:
        return "no such header"
    if module == "cli" and header.relative_to(ROOT).parts[0] == "src":
        return "cli includes public headers and its own"
    if header.parent.name == "imukit" and header.stem in GATHERING - {"io"}:
        lists_all = header.stem == "physics" and file.name == "instruments.c"
        return None if module == "cli" or lists_all else "it gathers headers for users"
    included = module_of(header)
    if included is None:
        return "tools/check_layers.py does not list it"
    if included != module and RANK[included] >= RANK[module]:
        return f"{included} does not stand left of {module}"
    return None


def check_layers():
    headers = sorted((ROOT / "include/imukit").glob("*.h"))
    gathered = {pathlib.Path(target).stem for header in headers if header.stem in GATHERING
                for _, target in includes(header)}
    for header in headers:
        if header.stem not in MODULE_OF.keys() | GATHERING:
            yield f"{header.relative_to(ROOT)}: add it to the list in tools/check_layers.py"
        if header.stem not in gathered | GATHERING:
            yield f"{header.relative_to(ROOT)} is in none of {', '.join(sorted(GATHERING))}"
    for file in code_files() + [header for header in headers
                                if header.stem in MODULE_OF.keys() - GATHERING]:
        for number, target in includes(file):
            if wrong := wrong_include(file, target):
                yield f"{file.relative_to(ROOT)}:{number}: includes {target}: {wrong}"


# ---- rooms ---------------------------------------------------------------------------------------

def rooms():
    """How many files each folder holds."""
    return collections.Counter(file.parent.relative_to(ROOT).as_posix() for tree in TREES
                               for file in (ROOT / tree).rglob("*.[ch]"))


def check_rooms():
    for folder, count in sorted(rooms().items()):
        if count > ROOM:
            yield f"{folder} holds {count} files, more than {ROOM}: divide it by topic"


# ---- loops ---------------------------------------------------------------------------------------

def symbols():
    """For each source file: the names its object defines, and those it uses."""
    if subprocess.run([ROOT / "tools/release_build.sh", *OBJECTS], check=False).returncode != 0:
        sys.exit("it does not compile")
    sources = [file.relative_to(ROOT).as_posix() for file in code_files()
               if file.suffix == ".c"]
    objects = {str(path): source for source in sources for target in OBJECTS
               if (path := BUILD / f"CMakeFiles/{target}.dir/{source}.o").exists()}
    defined = {source: set() for source in objects.values()}
    used = {source: set() for source in objects.values()}
    listing = subprocess.run(["nm", "-P", "-A", *objects], capture_output=True, text=True,
                             check=True)
    for line in listing.stdout.splitlines():
        path, symbol = line.split(": ", 1)
        name, kind, *_ = symbol.split()
        if kind in "TDRBV":
            defined[objects[path]].add(name)
        elif kind == "U":
            used[objects[path]].add(name)
    return defined, used


def links(defined, used):
    """For each file, the files it uses with the names that tie it to them."""
    home = {name: file for file, names in defined.items() for name in names}
    found = {file: collections.defaultdict(list) for file in defined}
    for file, names in used.items():
        for name in sorted(names & home.keys()):
            found[file][home[name]].append(name)
    return found


def reachable(graph, start):
    seen, left = set(), [start]
    while left:
        for file in graph[left.pop()]:
            if file not in seen:
                seen.add(file)
                left.append(file)
    return seen


def find_loops(graph):
    """Sets of files each of which leads to all the others."""
    reach = {file: reachable(graph, file) for file in graph}
    loops = {frozenset(other for other in reach[file] if file in reach[other])
             for file in graph if file in reach[file]}
    return sorted(map(sorted, loops))


def is_wrong(loop):
    return len(loop) > LOOP or len({pathlib.PurePath(file).parent for file in loop}) > 1


def describe(loop, graph):
    yield f"a loop of {len(loop)} files (at most {LOOP}, of one folder):"
    for file in loop:
        for other in sorted(graph[file].keys() & set(loop)):
            yield f"    {file} uses {', '.join(graph[file][other])} of {other}"


# ---- all -----------------------------------------------------------------------------------------

def main():
    failed = False
    gather_jobs()
    for line in [*check_layers(), *check_rooms()]:
        print(line, flush=True)
        failed = True
    graph = links(*symbols())
    loops = find_loops(graph)
    for loop in loops:
        if is_wrong(loop):
            print("\n".join(describe(loop, graph)))
            failed = True
    print(f"{len(graph)} files, {len(rooms())} folders, {len(loops)} loops")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
