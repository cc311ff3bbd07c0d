#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A module includes only headers from layers to its left (CONTRIBUTING.md):

    base < model < {noise, motion} < {simulate, identify, physics, compensate}
         < {calibrate, navigate} < io < report < cli

Within braces nothing includes its neighbour. The command includes public headers only.
"""
import pathlib
import re
import sys

LAYERS = [["base"], ["model"], ["noise", "motion"],
          ["simulate", "identify", "physics", "compensate"], ["calibrate", "navigate"],
          ["io"], ["report"], ["cli"]]
RANK = {module: rank for rank, modules in enumerate(LAYERS) for module in modules}

# Module of each public header. A new one must be added here.
PUBLIC = {
    "base": "attitude decimal distributions elementary executor fourier least_squares "
            "linear_algebra names random samples status units utf8",
    "model": "correct distort model model_parameter",
    "noise": "filter_noise noise",
    "motion": "earth motion motion_script",
    "simulate": "simulate",
    "identify": "allan allan_fit allan_gaps allan_stream identify identify_joint identify_plan "
                "identify_record record_screen spectrum",
    "physics": "fibre_optic free_gyro instrument mems_accelerometer pendulous_servo rate_gyro "
               "rate_integrating_gyro ring_laser shell_gyro spinning_mass suspended_rotor "
               "tuned_gyro tuning_fork vibrating_beam",
    "compensate": "compensate firmware",
    "calibrate": "calibration calibration_plan evaluate ferraris laboratory procedure "
                 "reference_alignment repeatability static_detection test_record thermal",
    "navigate": "alignment drift navigate zero_velocity",
    "io": "campaign design_file firmware_file io log memory_limit model_file motion_file output_file "
          "parameter_file thread_pool",
    "report": "report",
}
# Headers that gather others: imukit.h the core, for users only; io.h what is right of it.
GATHERING = {"imukit", "io"}
MODULE_OF = {name: module for module, names in PUBLIC.items() for name in names.split()}

ROOT = pathlib.Path(__file__).resolve().parent.parent
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"')


def module_included(file, target):
    """Module a header belongs to, or None for one in the includer's own folder."""
    if target.startswith("imukit/"):
        name = target[len("imukit/"):].removesuffix(".h")
        return name if name in GATHERING and name != "io" else MODULE_OF.get(name, "unknown")
    folder = target.split("/")[0] if "/" in target else None
    if folder is None:
        return None if (file.parent / target).exists() else "unknown"
    return folder if folder in RANK else "unknown"


def complaint(module, target, included):
    if included == "unknown":
        return f"{target} belongs to no layer (tools/check_layers.py lists the public headers)"
    if module == "cli" and included is not None and not target.startswith("imukit/"):
        return f"the command includes {target}, which is not public"
    if included is None or included == module:
        return None
    if included in GATHERING - {"io"}:
        return None if module == "cli" else f"{target} includes the whole core"
    if RANK[included] < RANK[module]:
        return None
    return f"{module} includes {target} of {included}, which is not to its left"


def check(file, module):
    found = []
    for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
        match = INCLUDE.match(line)
        if not match:
            continue
        included = module_included(file, match[1])
        text = complaint(module, match[1], included)
        if text:
            found.append(f"{file.relative_to(ROOT)}:{number}: {text}")
    return found


def main():
    files = [(path, path.relative_to(ROOT / "src").parts[0])
             for path in sorted((ROOT / "src").rglob("*.[ch]"))]
    files += [(path, "cli") for path in sorted((ROOT / "cli").rglob("*.[ch]"))]
    files += [(path, MODULE_OF.get(path.stem, "base"))
              for path in sorted((ROOT / "include/imukit").glob("*.h"))
              if path.stem not in GATHERING]
    found = [line for path, module in files for line in check(path, module)]
    found += [f"include/imukit/{path.name}: add it to the list in tools/check_layers.py"
              for path in sorted((ROOT / "include/imukit").glob("*.h"))
              if path.stem not in MODULE_OF and path.stem not in GATHERING]
    # imukit.h gathers the core, io.h the rest: nothing public may be missing from both.
    gathered = {match[1] for name in GATHERING
                for match in re.finditer(r'#include "imukit/(\w+)\.h"',
                                         (ROOT / f"include/imukit/{name}.h").read_text())}
    found += [f"include/imukit/{name}.h is in neither imukit.h nor io.h"
              for name in MODULE_OF
              if (ROOT / f"include/imukit/{name}.h").exists()
              and name not in gathered | GATHERING]
    print("\n".join(found) if found else f"{len(files)} files")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
