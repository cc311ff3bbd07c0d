# SPDX-License-Identifier: Apache-2.0
"""A log in memory, and how it becomes a file that imukit reads."""
import copy
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np


@dataclass
class Column:
    name: str
    unit: str
    values: np.ndarray  # SI units; `scale` is SI units per unit of the file
    scale: float = 1.0


@dataclass
class Record:
    """dt: true interval of the sensor's samples [s]. time: stamps [s] or None, one per row. rate:
    what the user states with --rate [Hz], or None. text: write CSV, not .npy."""
    dt: float
    time: np.ndarray
    columns: list
    rate: float = None
    temperature: np.ndarray = None
    time_unit: float = 1.0
    text: bool = False
    options: list = field(default_factory=list)

    def copy(self):
        return copy.deepcopy(self)

    @property
    def rows(self):
        return len(self.columns[0].values)

    def keep(self, rows):
        """Only these rows (indices or mask); indices may repeat rows."""
        for column in self.columns:
            column.values = column.values[rows]
        if self.time is not None:
            self.time = self.time[rows]
        if self.temperature is not None:
            self.temperature = self.temperature[rows]

    def write(self, folder, name):
        """Write the log.  @return the operands and options for imukit"""
        names, arrays = [], []
        if self.time is not None:
            unit = {1.0: "s", 1e-3: "ms", 1e-6: "us"}[self.time_unit]
            names.append(f"time [{unit}]")
            arrays.append(self.time / self.time_unit)
        for column in self.columns:
            names.append(f"{column.name} [{column.unit}]")
            arrays.append(column.values / column.scale)
        if self.temperature is not None:
            names.append("temperature [degC]")
            arrays.append(self.temperature)
        path = Path(folder) / (name + (".csv" if self.text else ".npy"))
        table = np.column_stack(arrays)
        if self.text:
            np.savetxt(path, table, fmt="%.9g", delimiter=",", header=",".join(names), comments="")
        else:
            np.save(path, table)
            Path(f"{path}.columns").write_text("\n".join(names) + "\n", encoding="ascii")
        rate = [] if self.rate is None else ["--rate", f"{self.rate:.12g}Hz"]
        return [str(path)] + rate + self.options

    @staticmethod
    def remove(path):
        Path(path).unlink(missing_ok=True)
        Path(f"{path}.columns").unlink(missing_ok=True)
