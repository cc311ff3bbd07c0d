# SPDX-License-Identifier: Apache-2.0
"""Navigation by logs."""
from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from typing import Any

from . import _arrays, _core
from ._inputs import Data, is_path, open_record
from ._results import Result, tell
from ._scenes import ModelLike, Numbers, named_model, texts, vector, with_sigmas
from ._units import si

_VERDICTS = ("used", "recovered", "refused", "compared")


@dataclasses.dataclass(frozen=True, slots=True)
class Track(_arrays.Vectors):
    """The track of a unit: vectors of equal length. The sigmas are 1 sigma of what is computed, by
    the model; None without one."""

    time: _arrays.Array
    """on the clock of the log [s]"""
    latitude: _arrays.Array
    """geodetic [rad]"""
    longitude: _arrays.Array
    """[rad]"""
    height: _arrays.Array
    """above the ellipsoid [m]"""
    north: _arrays.Array
    """from the start [m]"""
    east: _arrays.Array
    """[m]"""
    down: _arrays.Array
    """[m]"""
    velocity_north: _arrays.Array
    """relative to the Earth [m/s]"""
    velocity_east: _arrays.Array
    """[m/s]"""
    velocity_down: _arrays.Array
    """[m/s]"""
    roll: _arrays.Array
    """[rad]"""
    pitch: _arrays.Array
    """[rad]"""
    yaw: _arrays.Array
    """from north to east [rad]"""
    acceleration_north: _arrays.Array
    """relative to the Earth, mean since the row before [m/s^2]"""
    acceleration_east: _arrays.Array
    """[m/s^2]"""
    acceleration_down: _arrays.Array
    """[m/s^2]"""
    sigma_north: _arrays.Array | None = None
    """[m]"""
    sigma_east: _arrays.Array | None = None
    """[m]"""
    sigma_down: _arrays.Array | None = None
    """[m]"""
    sigma_velocity_north: _arrays.Array | None = None
    """[m/s]"""
    sigma_velocity_east: _arrays.Array | None = None
    """[m/s]"""
    sigma_velocity_down: _arrays.Array | None = None
    """[m/s]"""
    sigma_attitude_north: _arrays.Array | None = None
    """about north [rad]"""
    sigma_attitude_east: _arrays.Array | None = None
    """about east [rad]"""
    sigma_attitude_down: _arrays.Array | None = None
    """about down: of the heading [rad]"""


@dataclasses.dataclass(frozen=True, slots=True)
class Innovations(_arrays.Vectors):
    """What the readings of one aid were off the estimate, divided by the 1 sigma due: vectors of
    equal length."""

    kind: str
    """'position', 'velocity', 'heading', 'height' or 'odometer'"""
    time: _arrays.Array
    """[s]"""
    axes: tuple[_arrays.Array, ...]
    """three vectors [1]; NaN: this axis is not measured"""
    verdict: tuple[str, ...]
    """'used', 'recovered' (used after the covariance was enlarged), 'refused' or 'compared'"""


class NavigateResult(Result):
    """Attitude, velocity and position of a unit. See navigate()."""

    def __init__(self, core: Any, findings: list[tuple[int, str, str, str]],
                 arrays: tuple[Any, ...]) -> None:
        super().__init__(core, findings)
        self._track, self._filtered, self._aids = arrays

    @property
    def track(self) -> Track:
        """The track; smoothed, if that was asked for."""
        return Track(*map(_arrays.of_bytes, self._track))

    @property
    def filtered(self) -> Track:
        """The track as filtered, without what later readings tell."""
        return Track(*map(_arrays.of_bytes, self._filtered or self._track))

    @property
    def innovations(self) -> tuple[Innovations, ...]:
        """One for each aid."""
        return tuple(Innovations(kind, _arrays.of_bytes(columns[0]),
                                 tuple(map(_arrays.of_bytes, columns[1:])),
                                 tuple(_VERDICTS[v] for v in verdicts))
                     for kind, columns, verdicts in self._aids)


def navigate(data: Data, model: ModelLike | None = None, *, position: Numbers,
             rate: float | str | None = None, columns: str | Sequence[str] | None = None,
             align: float | str | None = None, align_method: str | None = None,
             heading: float | str | None = None, attitude: Numbers | None = None,
             attitude_sigma: Numbers = 0.0, velocity: Numbers | None = None,
             velocity_sigma: Numbers = 0.0, position_sigma: Numbers = 0.0,
             zero_velocity: float | str | None = None, stop: float | str | None = None,
             still_velocity: float | str = 0.01, still_rotation: float | str | None = None,
             vertical: str | None = None, coning: int = 3,
             standard_gravity: float | str = 9.80665, interval: float | str = 1.0,
             gaps: str = "refuse", smooth: bool = False, aids: Data | None = None,
             aid_sigma: str | Sequence[str] | None = None, aid_map: str | None = None,
             aid_lever_arm: Numbers = (0.0, 0.0, 0.0), speed_lever_arm: Numbers = (0.0, 0.0, 0.0),
             aid_delay: float | str = 0.0, aid_interval: float | str = 0.0,
             aid_until: float | str | None = None,
             progress: Callable[[str, str, int, int], object] | None = None,
             **log: Any) -> NavigateResult:
    """Attitude, velocity and position of a unit from its log and the place of its start.

    data         path of a log with three gyros and three accelerometers, or its columns as arrays:
                 a dictionary, a Log, a table
    model        errors of the sensors: predicts the error and weighs updates. A Model, the name of
                 a file or of a device
    position     at the start: latitude [rad], longitude [rad], height [m], or a text such as
                 "34.25 deg, 108.91 deg, 380 m"
    rate         sampling rate [Hz]; needed without a column of times
    columns      names of the columns, with units in brackets ("gyro_x [deg/s]"); without, SI
    align        time at rest at the start, in which the unit finds its attitude [s]
    align_method 'means', 'inertial' or 'fine'; default: what the gyros allow
    heading      azimuth of body x at the start, for gyros that cannot find north [rad], or a text
                 such as "30 +- 1 deg"
    attitude     instead of align: roll, pitch, yaw at the start [rad], or "0.5 -1.2 90 +- 0.1 deg"
    attitude_sigma  1 sigma about north, east, down [rad], of attitude; of heading, the last one or
                 a single number
    velocity     at the start with attitude, north, east, down [m/s], or "20 -3 0 +- 0.1 m/s"
    velocity_sigma, position_sigma  1 sigma of these [m/s], [m]: one number, or north, east, down
    zero_velocity  correct the error at stops: 'auto' finds them in the log; a time [s]: there is a
                 stop at the end of each. Needs a model
    stop         length of the stops of such a timetable [s]; default 5
    still_velocity  1 sigma of the velocity of a unit at rest [m/s]
    still_rotation  1 sigma of its mean rate over a stop [rad/s]; default: not used
    vertical     'slaved': the height stays (the default without aids), or 'free'
    coning       samples from which coning and sculling are computed, 1 … 4
    standard_gravity  value of g for columns in g, mg or ug [m/s^2]
    interval     time between rows of the track [s]
    gaps         rows that are missing: 'refuse', 'bridge' or 'longest'
    smooth       correct the track backwards, too. Needs a model
    aids         readings of position, velocity, heading, height or speed, with a column of times on
                 the clock of the log: path of a table, or columns as arrays. It may be the log
                 itself. Needs a model
    aid_sigma    1 sigma of what is used of it, such as "position 1 1 2 m, velocity 0.05 m/s";
                 needed unless there are columns of sigmas
    aid_map      columns by the names that a table in a file has for them
    aid_lever_arm  from the unit to the antenna: forward, right, down [m], or a text such as "0.2
                 -0.5 -1.1 +- 0.02 m"
    speed_lever_arm  from the unit to the wheel whose speed is read [m]
    aid_delay    the readings are older than their times say by this [s]
    aid_interval use at most one reading per this time [s]; 0: all
    aid_until    later readings are only compared; from the start of the log [s]
    progress     called with (stage, unit, done, total); a false value but None ends the work
    log          options for reading a log: see read_log()

    Raises imukit.Error: columns that are missing, a log that is too short for the alignment, an
    estimate that is lost; ValueError: arguments that need or exclude each other. Source:
    include/imukit/navigate_log.h; the fields of the result: docs/json.md.

    >>> import imukit
    >>> level = {"gyro_x": [0.0] * 300, "gyro_y": [0.0] * 300, "gyro_z": [0.0] * 300,
    ...          "accel_x": [0.1] * 300, "accel_y": [0.0] * 300, "accel_z": [-9.80620] * 300}
    >>> track = imukit.navigate(level, rate=100, position="45 deg, 7 deg, 0 m",
    ...                         attitude="0 0 0 deg").track
    >>> [round(x, 2) for x in track.north.tolist()]  # 0.1 m/s^2 t^2/2
    [0.0, 0.05, 0.2, 0.45]
    """
    if align is None and attitude is None:
        raise ValueError("the attitude at the start is missing: give align='300 s' if the unit is "
                         "at rest for that time at the start, or attitude")
    _check_company(align=align, attitude=attitude, heading=heading, velocity=velocity,
                   align_method=align_method, stop=stop, zero_velocity=zero_velocity,
                   still_rotation=still_rotation, aids=aids, aid_sigma=aid_sigma, aid_map=aid_map,
                   model=model)
    angles, angle_sigmas = _attitude(attitude, heading, attitude_sigma)
    speeds, speed_sigmas = _three("velocity", 0.0 if velocity is None else velocity,
                                  velocity_sigma, "m/s")
    arm, arm_sigmas = _three("aid_lever_arm", aid_lever_arm, 0.0, "m")
    vectors = (_place(position), angles, angle_sigmas, speeds, speed_sigmas,
               vector("position_sigma", position_sigma, "m", one=True), arm, arm_sigmas,
               vector("speed_lever_arm", speed_lever_arm, "m"))
    timetable = zero_velocity is not None and zero_velocity != "auto"
    settings = {"align": 0.0 if align is None else align, "align_method": align_method,
                "heading_given": heading is not None, "velocity_given": velocity is not None,
                "stops": "timetable" if timetable else zero_velocity or "none",
                "stop_period": zero_velocity if timetable else None,
                "stop": 5.0 if timetable and stop is None else stop,
                "still_velocity": still_velocity, "still_rotation": still_rotation,
                "vertical": vertical, "coning": coning, "standard_gravity": standard_gravity,
                "interval": interval, "gaps": gaps, "smooth": smooth, "aid_delay": aid_delay,
                "aid_interval": aid_interval, "aid_until": aid_until}
    record = open_record(data, rate, columns, log)
    readings = None
    if aids is not None:
        options = {"any_columns": True, "map": aid_map} if is_path(aids) else None
        readings = open_record(aids, None, None, options, "the aids")
    result = NavigateResult(*_core.navigate(
        record, None if model is None else named_model(model), vectors, settings, readings,
        texts("aid_sigma", aid_sigma), progress))
    tell(result)
    return result


def _place(position: Numbers) -> tuple[float, ...]:
    names = ("latitude", "longitude", "height")
    parts: Any = position.split(",") if isinstance(position, str) else position
    if not hasattr(parts, "__len__") or len(parts) != 3:
        raise ValueError("position: expected latitude, longitude and height, such as "
                         "'34.25 deg, 108.91 deg, 380 m'")
    return tuple(si(f"position, {name}", part, unit)
                 for name, part, unit in zip(names, parts, ("rad", "rad", "m")))


def _three(argument: str, value: Numbers, sigma: Numbers,
           unit: str) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Three numbers, and their 1 sigma: of the text, or stated besides."""
    made, sigmas = with_sigmas(argument, value, unit)
    if len(made) == 1 and made[0] == 0.0:
        made, sigmas = 3 * made, 3 * sigmas
    if len(made) != 3:
        raise ValueError(f"{argument}: expected three numbers, and there are {len(made)}")
    stated = vector(f"{argument}_sigma", sigma, unit, one=True)
    if any(stated) and any(sigmas):
        raise ValueError(f"{argument}_sigma: {argument} states its sigma, too; leave one out")
    return made, stated if any(stated) else sigmas


def _attitude(attitude: Numbers | None, heading: float | str | None,
              sigma: Numbers) -> tuple[tuple[float, ...], tuple[float, ...]]:
    if heading is None:
        return _three("attitude", (0.0, 0.0, 0.0) if attitude is None else attitude, sigma, "rad")
    made, sigmas = with_sigmas("heading", heading, "rad")
    if len(made) != 1:
        raise ValueError(f"heading: expected one number, and there are {len(made)}")
    stated = vector("attitude_sigma", sigma, "rad", one=True)[2]
    if stated and sigmas[0]:
        raise ValueError("attitude_sigma: heading states its sigma, too; leave one out")
    return (0.0, 0.0, made[0]), (0.0, 0.0, stated or sigmas[0])


def _check_company(**o: Any) -> None:
    given = o["attitude"] is not None
    automatic = o["zero_velocity"] == "auto"
    wrong = (
        (given and o["align"] is not None, "align finds the attitude that attitude gives: leave "
                                           "one out"),
        (given and o["heading"] is not None, "heading is part of attitude: leave it out"),
        (given and o["align_method"] is not None, "align_method is for align"),
        (not given and o["velocity"] is not None, "velocity is for a start with attitude: a unit "
                                                  "that aligns itself is at rest"),
        (o["stop"] is not None and (o["zero_velocity"] is None or automatic),
         "stop is for zero_velocity with a time, such as zero_velocity=60"),
        (o["still_rotation"] is not None and o["zero_velocity"] is None,
         "still_rotation is for zero_velocity"),
        (o["aids"] is None and (o["aid_sigma"] is not None or o["aid_map"] is not None),
         "aid_sigma and aid_map are about aids"),
        (o["aid_map"] is not None and not is_path(o["aids"]),
         "aid_map: only for a table in a file"),
        (o["zero_velocity"] is not None and o["model"] is None,
         "zero_velocity needs the errors of the sensors: give a model"),
        (o["aids"] is not None and o["model"] is None,
         "aids need the errors of the sensors: give a model"))
    for is_wrong, message in wrong:
        if is_wrong:
            raise ValueError(message)
