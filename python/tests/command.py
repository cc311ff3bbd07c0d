# SPDX-License-Identifier: Apache-2.0
"""The command beside the package, where the build has it."""
import json
import math
import os
import pathlib
import subprocess
import unittest

COMMAND = pathlib.Path(__file__).resolve().parents[2] / "build" / "imukit"

# The command is not made for the libraries that a sanitized extension needs from the beginning.
ALONE = {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"}


def run(folder, *words):
    """Run the command in a folder; what it prints."""
    if not COMMAND.exists():
        raise unittest.SkipTest(f"{COMMAND} is not built")
    done = subprocess.run([COMMAND, *map(str, words)], cwd=folder, env=ALONE,
                          capture_output=True, text=True)
    return done.stdout


def told(folder, *words):
    """What it prints as JSON."""
    return json.loads(run(folder, *words, "--json"))


def command_json(*words):
    """What it prints as JSON, without its findings."""
    return _data(told(None, *words))


def python_json(result):
    """The same of a result."""
    return _data(result.to_dict())


def _data(tree):
    return {key: value for key, value in tree.items() if key != "findings"}


def differences(a, b, path=""):
    """Where two trees differ: numbers by more than 1e-9 of their size, or anything else but
    messages, in which arguments stand for options."""
    if isinstance(a, dict) and isinstance(b, dict):
        for key in sorted(a.keys() | b.keys()):
            if key == "message":
                continue
            if key not in a or key not in b:
                yield f"{path}.{key}: only in one"
            else:
                yield from differences(a[key], b[key], f"{path}.{key}")
    elif isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
        for k, (x, y) in enumerate(zip(a, b)):
            yield from differences(x, y, f"{path}[{k}]")
    elif isinstance(a, float) and isinstance(b, float):
        if not math.isclose(a, b, rel_tol=1e-9, abs_tol=1e-300):
            yield f"{path}: {a} and {b}"
    elif isinstance(a, str) and isinstance(b, str) and " --" in a:  # b names an argument there
        if not b.startswith(a.partition(" --")[0]):
            yield f"{path}: {a} and {b}"
    elif a != b:
        yield f"{path}: {a} and {b}"


class SameAsCommand(unittest.TestCase):
    """Results of the package and of the command, run in `folder`."""

    def same(self, result, *words, without=()):
        """The part "result" of both is the same, but for the keys named."""
        due, found = told(self.folder, *words)["result"], result.to_dict()["result"]
        for key in without:
            due.pop(key, None)
            found.pop(key, None)
        self.assertEqual(list(differences(due, found))[:5], [])
