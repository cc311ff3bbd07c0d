# SPDX-License-Identifier: Apache-2.0
"""Models of sensors."""
from __future__ import annotations

import os
from typing import Any

from . import _core


class Model:
    """The errors of a unit of gyros and accelerometers: a model file in memory.

    Model("tactical.yaml") reads a file, Model("ADIS16488") takes an entry of the catalogue
    (`imukit devices` lists them), Model.parse(text) reads a text. Raises imukit.Error with line and
    column for a text that is no model.

    >>> import imukit
    >>> model = imukit.Model("ADIS16488")
    >>> print(model.yaml().splitlines()[0])
    imukit: 1
    """

    def __init__(self, name: str | os.PathLike[str]) -> None:
        self._core: Any = _core.open_model(name)

    @classmethod
    def parse(cls, text: str) -> Model:
        """The model of a text, YAML or JSON."""
        made = cls.__new__(cls)
        made._core = _core.parse_model(text)
        return made

    def yaml(self) -> str:
        """The text of its file: units, order and comments are kept where it was read from one."""
        return self._core.yaml()  # type: ignore[no-any-return]

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the file, complete or not at all; a name that ends in .json makes it JSON."""
        self._core.save(path)

    def __repr__(self) -> str:
        return self.yaml().rstrip("\n")

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Model):
            return NotImplemented
        return self.yaml() == other.yaml()

    def __reduce__(self) -> tuple[Any, ...]:
        return Model.parse, (self.yaml(),)
