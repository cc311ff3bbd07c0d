# SPDX-License-Identifier: Apache-2.0
"""Errors of inertial sensors: identified, calibrated, simulated, and what they cost a navigator.

Numbers are in SI units: rad/s, m/s^2, s, K, T. Wherever a number is an argument, a text with a unit
may stand for it: "0.1 deg/s".
"""
from . import allantools, physics
from ._allan import AllanCurve, AllanResult, allan
from ._calibrate import (CalibrateResult, CalibrationPlan, Parameter, PoseResidual, calibrate,
                         plan_calibration)
from ._compensate import CompensatedLog, compensate, convert, write_log
from ._core import Error, FileError, convert_unit, normal_gravity, version as __version__
from ._drift import DriftGrowth, DriftMoments, DriftResult, DriftRuns, DriftShare, drift
from ._estimates import Estimate
from ._evaluate import EvaluateResult, Figure, evaluate
from ._grade import GradeResult, grade
from ._identify import (IdentifyResult, RecordPlan, identify, identify_curve, identify_devices,
                        identify_runs, plan_record)
from ._info import InfoResult, info
from ._log import Log, read_log
from ._model import Device, Model, devices
from ._motion import Motion
from ._navigate import Innovations, NavigateResult, Track, navigate
from ._parameters import ParameterText, parameter_formats
from ._results import DataWarning, Fields, Finding, Result
from ._sensor import Sensor
from ._simulate import Blocks, simulate, simulate_blocks, simulate_runs, simulate_truth
from ._spectrum import SpectrumCurve, SpectrumLine, SpectrumResult, spectrum
from ._tune import FilterAnswer, TuneResult, tune

__all__ = [
    "AllanCurve",
    "AllanResult",
    "Blocks",
    "CalibrateResult",
    "CalibrationPlan",
    "CompensatedLog",
    "DataWarning",
    "Device",
    "DriftGrowth",
    "DriftMoments",
    "DriftResult",
    "DriftRuns",
    "DriftShare",
    "Error",
    "Estimate",
    "EvaluateResult",
    "Fields",
    "Figure",
    "FileError",
    "FilterAnswer",
    "Finding",
    "GradeResult",
    "IdentifyResult",
    "InfoResult",
    "Innovations",
    "Log",
    "Model",
    "Motion",
    "NavigateResult",
    "Parameter",
    "ParameterText",
    "PoseResidual",
    "RecordPlan",
    "Result",
    "Sensor",
    "SpectrumCurve",
    "SpectrumLine",
    "SpectrumResult",
    "Track",
    "TuneResult",
    "allan",
    "allantools",
    "calibrate",
    "compensate",
    "convert",
    "convert_unit",
    "devices",
    "drift",
    "evaluate",
    "grade",
    "identify",
    "identify_curve",
    "identify_devices",
    "identify_runs",
    "info",
    "navigate",
    "normal_gravity",
    "parameter_formats",
    "physics",
    "plan_calibration",
    "plan_record",
    "read_log",
    "simulate",
    "simulate_blocks",
    "simulate_runs",
    "simulate_truth",
    "spectrum",
    "tune",
    "write_log",
]
