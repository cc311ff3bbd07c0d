# SPDX-License-Identifier: Apache-2.0
"""What the command prints as JSON, to compare a result of Python with."""
import json
import pathlib
import subprocess
import unittest

COMMAND = pathlib.Path(__file__).resolve().parents[2] / "build/imukit"


def command_json(*words, cwd=None):
    """The data of `imukit WORDS --json`, without its findings; skips where there is no command."""
    if not COMMAND.exists():
        raise unittest.SkipTest("the command is not built")
    done = subprocess.run([COMMAND, *map(str, words), "--json"], capture_output=True, text=True,
                          cwd=cwd, check=False)
    if done.returncode != 0:
        raise AssertionError(done.stderr)
    data = json.loads(done.stdout)
    data.pop("findings", None)
    return data


def python_json(result):
    """The same of a result."""
    data = result.to_dict()
    data.pop("findings", None)
    return data
