# SPDX-License-Identifier: Apache-2.0
"""Errors of inertial sensors: identified, calibrated, simulated, and what they cost a navigator.

Numbers are in SI units: rad/s, m/s^2, s, K, T. Wherever a number is an argument, a text with a unit
may stand for it: "0.1 deg/s".
"""
from ._allan import AllanCurve, AllanResult, allan
from ._core import Error, FileError, convert_unit, normal_gravity
from ._core import version as __version__
from ._drift import DriftGrowth, DriftMoments, DriftResult, DriftRuns, DriftShare, drift
from ._grade import GradeResult, grade
from ._identify import IdentifyResult, identify
from ._log import Log, read_log
from ._model import Device, Model, devices
from ._navigate import Innovations, NavigateResult, Track, navigate
from ._results import DataWarning, Fields, Finding, Result

__all__ = ["AllanCurve", "AllanResult", "DataWarning", "Error", "Fields", "FileError", "Finding",
           "IdentifyResult", "Log", "Device", "Model", "Result", "devices", "allan", "convert_unit", "identify",
           "normal_gravity", "read_log", "DriftGrowth", "DriftMoments", "DriftResult", "DriftRuns",
           "DriftShare", "drift", "GradeResult", "grade",
           "Innovations", "NavigateResult", "Track", "navigate"]
