# SPDX-License-Identifier: Apache-2.0
"""Errors of inertial sensors: identified, calibrated, simulated, and what they cost a navigator.

Numbers are in SI units: rad/s, m/s^2, s, K, T. Wherever a number is an argument, a text with a unit
may stand for it: "0.1 deg/s".
"""
from ._allan import AllanCurve, AllanResult, allan
from ._core import Error, FileError, convert_unit, normal_gravity
from ._core import version as __version__
from ._identify import IdentifyResult, identify
from ._log import Log, read_log
from ._model import Device, Model, devices
from ._motion import Motion
from ._results import DataWarning, Fields, Finding, Result
from ._simulate import Blocks, simulate, simulate_blocks, simulate_runs, simulate_truth

__all__ = ["AllanCurve", "AllanResult", "Blocks", "DataWarning", "Device", "Error", "Fields",
           "FileError", "Finding", "IdentifyResult", "Log", "Model", "Motion", "Result", "allan",
           "convert_unit", "devices", "identify", "normal_gravity", "read_log", "simulate",
           "simulate_blocks", "simulate_runs", "simulate_truth"]
