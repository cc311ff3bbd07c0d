# SPDX-License-Identifier: Apache-2.0
"""The stub of the twelve instruments says what the table of the library says.

    PYTHONPATH=... python3 test_instrument_types.py --update   writes it into python/imukit
"""
import pathlib
import sys
import textwrap
import unittest

import imukit

NAME = "_instrument_types.pyi"
HEAD = '''\
# SPDX-License-Identifier: Apache-2.0
"""The classes of instruments for type checkers; tests/test_instrument_types.py writes this file."""
import os
from collections.abc import Mapping
from typing import Any

from .physics import Group, Instrument

_Source = str | os.PathLike[str] | Mapping[str, Any] | Instrument | None
_Values = Mapping[str, Any] | None
_Quantity = float | str
_Count = int
_Choice = str
_Switch = bool

class _Number:
    """Read as a number in SI units, set as one or as a text with its unit."""
    def __get__(self, owner: object, kind: type | None = None) -> float: ...
    def __set__(self, owner: object, value: float | str) -> None: ...
'''
# as an attribute, as an argument; by names that no parameter has, as one is called float
KINDS = {"number": ("_Number", "_Quantity"), "count": ("_Count", "_Count"),
         "choice": ("_Choice", "_Choice"), "switch": ("_Switch", "_Switch")}


def groups_of(about):
    """Parameters by their groups; those of no group under ''."""
    found = {}
    for p in about.parameters:
        group, _, word = p.path.rpartition(".")
        found.setdefault(group, []).append((word, p.kind))
    return found


def class_text(kind):
    groups, name = groups_of(kind.about), kind.__name__
    text = ""
    for group, members in groups.items():
        if group:
            text += f"\nclass _{name}_{group}(Group):\n" + "".join(
                f"    {word}: {KINDS[what][0]}\n" for word, what in members)
    text += f"\nclass {name}(Instrument):\n"
    text += "".join(f"    {group}: _{name}_{group}\n" for group in groups if group)
    words = [w for members in groups.values() for w in members]
    once = [(w, what) for w, what in words if [x for x, _ in words].count(w) == 1 and
            w not in groups and not hasattr(imukit.physics.Instrument, w)]
    text += "".join(f"    {word}: {KINDS[what][0]}\n" for word, what in once)
    arguments = [f"{g}: _Values = ..." for g in groups if g] + [
        f"{word}: {KINDS[what][1]} = ..." for word, what in once]
    body = "self, source_: _Source = ..., /, *, name: str | None = ..., " + ", ".join(arguments)
    lines = textwrap.wrap(body, 82, break_on_hyphens=False)
    return text + "    def __init__(" + f"\n{' ' * 17}".join(lines) + ") -> None: ...\n"


def stub():
    return HEAD + "".join(class_text(kind) for kind in imukit.physics.instruments())


class Types(unittest.TestCase):
    def test_stub_is_the_table(self):
        path = pathlib.Path(imukit.__file__).parent / NAME
        self.assertEqual(path.read_text(encoding="utf-8"), stub())

    def test_members_are_there(self):
        for kind in imukit.physics.instruments():
            made = kind()
            for group, members in groups_of(kind.about).items():
                for word, what in members:
                    value = getattr(getattr(made, group) if group else made, word)
                    with self.subTest(f"{kind.__name__}.{group}.{word}"):
                        self.assertIsInstance(value, {"number": float, "count": int, "choice": str,
                                                      "switch": bool}[what])


if __name__ == "__main__":
    if sys.argv[1:] == ["--update"]:
        place = pathlib.Path(__file__).parent.parent / "imukit" / NAME
        place.write_text(stub(), encoding="utf-8")
    else:
        unittest.main()
