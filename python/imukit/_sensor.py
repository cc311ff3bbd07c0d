# SPDX-License-Identifier: Apache-2.0
"""Sensors that are stepped."""
from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

from . import _arrays, _core
from ._model import Model, as_model
from ._units import si, whole


class Sensor:
    """A sensor that is stepped, or many of one model, for simulations that know the motion only now.

    model        a Model, the name of a file, or of a part of the catalogue
    rate         of its samples [Hz], or a text such as "200 Hz"
    seed, run    of the random numbers; sensor i of several is that of run + i
    count        sensors side by side
    temperature  True: each step is given one

    The readings are, byte for byte, those of simulate() for this motion as a recorded one. Noise is
    made 512 samples ahead, so one step in 512 takes longer (many sensors take turns). One thread at
    a time may step a sensor.

    Raises imukit.Error: a model that is not valid, or whose timing moves samples (rate_error,
    jitter, skew). Source: include/imukit/sensor.h.

    >>> import imukit
    >>> sensor = imukit.Sensor("navigation", rate=100, seed=1)
    >>> sensor.channels
    ('gyro_x', 'gyro_y', 'gyro_z', 'accel_x', 'accel_y', 'accel_z')
    >>> reading = sensor.step([0, 0, 0.1], [0, 0, -9.81])
    >>> [round(float(x), 2) for x in reading]
    [0.0, 0.0, 0.1, 0.0, 0.0, -9.81]
    """

    def __init__(self, model: Model | str | os.PathLike[str], rate: float | str, *, seed: int = 1,
                 run: int = 0, count: int = 1, temperature: bool = False) -> None:
        self.model = as_model(model)
        self.rate = si("rate", rate, "Hz")
        self.count = count = whole("count", count, 0, 2 ** 32)
        run, seed = whole("run", run, 0, 2 ** 32 - 1), whole("seed", seed, 0, 2 ** 64 - 1)
        self._core = _core.sensor(self.model._core, run, {
            "rate": rate, "seed": seed, "count": count, "temperature": temperature})
        self.channels = self._names()

    def _names(self) -> tuple[str, ...]:
        """gyro_x and so on: by letters for three axes, by numbers for more."""
        names: list[str] = []
        for sensor, axes in zip(("gyro", "accel"), _core.axes(self.model._core)):
            names += [f"{sensor}_{'xyz'[k] if k < 3 else k}" for k in axes]
        return tuple(names)

    def step(self, angular_rate: Any, specific_force: Any = None, angular_acceleration: Any = None, *,
             temperature: Any = None, temperature_rate: Any = None,
             out: Any = None) -> _arrays.Array:
        """The next reading.

        angular_rate          mean over the interval that ends now, in inertial space [rad/s]
        specific_force        mean over it; acceleration less gravity [m/s^2]
        angular_acceleration  [rad/s^2]; None: 0. Only accelerometers with a lever arm need it
        temperature           in the middle of the interval [K]
        temperature_rate      [K/s]; None: 0
        out                   contiguous float64 array to be written; None: a new one

        Vectors are three numbers, in body axes forward, right, down, for all sensors; or an array 3
        x count with a column for each. For one sensor angular_rate may have six: rate and force.
        Temperatures are a number, or a vector of count. Numbers of any real type, in arrays or
        lists, are taken; contiguous float64 is read without a copy.
        Returns a vector of a number for each channel; channels x count where count is above 1. SI
        units, or counts where the model has a sensitivity. A truth that is not finite makes the
        readings that depend on it NaN in this step, and leaves nothing behind.
        Raises ValueError: another shape, or a temperature that is missing or one too many.
        """
        if specific_force is None and self.count == 1 and angular_rate is not None:
            angular_rate, specific_force = self._halves(angular_rate)
        for name, values in (("angular_rate", angular_rate), ("specific_force", specific_force)):
            if values is None:
                raise TypeError(f"{name}: expected three numbers, and there is None")
        if temperature_rate is not None and temperature is None:
            raise ValueError("temperature_rate: there is no temperature")
        shape = (len(self.channels), self.count) if self.count > 1 else (len(self.channels),)
        if out is not None and memoryview(out).shape != shape:
            raise ValueError(f"out: expected an array of the shape {shape}, not "
                             f"{memoryview(out).shape}")
        if out is None:
            out = _arrays.empty(len(self.channels) * self.count)
            if self.count > 1:
                out = _arrays.matrix(out, len(self.channels), self.count)
        try:
            if not (hasattr(angular_rate, "mask") or hasattr(specific_force, "mask") or
                    hasattr(angular_acceleration, "mask") or hasattr(temperature, "mask")):
                return self._core.step(angular_rate, specific_force, angular_acceleration,
                                       temperature, temperature_rate, out)
        except (BufferError, TypeError, ValueError):
            pass
        # What can be converted is, what is masked becomes NaN, and the rest is refused.
        rate, force, acceleration, kelvin, slope = (
            None if values is None else _arrays.of_rows(values, name) for name, values in (
                ("angular_rate", angular_rate), ("specific_force", specific_force),
                ("angular_acceleration", angular_acceleration), ("temperature", temperature),
                ("temperature_rate", temperature_rate)))
        return self._core.step(rate, force, acceleration, kelvin, slope, out)

    @staticmethod
    def _halves(both: Any) -> tuple[Any, Any]:
        """Rate and force of six numbers; of three, no force."""
        both = _arrays.of_rows(both, "angular_rate")
        return (both[:3], both[3:]) if both.shape == (6,) else (both, None)

    def dropped(self, row: int, number: int = 0) -> bool:
        """Is the reading of step `row`, from 0, lost (timing.drops)? number: of the sensor."""
        return self._core.dropped(number, row)

    def __reduce__(self) -> Any:
        raise TypeError("the state of a Sensor cannot be copied; make another of the same seed")

    def __repr__(self) -> str:
        several = f", count={self.count}" if self.count > 1 else ""
        return f"Sensor({self.model.get('name', 'the model')!r}, rate={self.rate:g}{several})"
