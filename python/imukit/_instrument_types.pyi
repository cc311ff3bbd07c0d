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

class _FreeGyro_spin(Group):
    rate: _Number
    error: _Number

class _FreeGyro_rotor(Group):
    polar_inertia: _Number
    transverse_inertia: _Number

class _FreeGyro_inner_gimbal(Group):
    inertia_x: _Number
    inertia_y: _Number
    inertia_z: _Number

class _FreeGyro_outer_gimbal(Group):
    inertia_x: _Number
    inertia_y: _Number
    inertia_z: _Number

class _FreeGyro_suspended(Group):
    mass: _Number

class _FreeGyro_unbalance(Group):
    x: _Number
    y: _Number
    z: _Number

class _FreeGyro_compliance(Group):
    x: _Number
    y: _Number
    z: _Number

class _FreeGyro_friction(Group):
    viscous: _Number
    coulomb: _Number
    rate: _Number

class _FreeGyro_gimbal(Group):
    stop: _Number

class _FreeGyro_torque(Group):
    inner: _Number
    outer: _Number
    temperature: _Number
    repeatability: _Number
    instability: _Number
    noise: _Number

class _FreeGyro_pickoff(Group):
    resolution: _Number
    noise: _Number
    scale_error: _Number

class _FreeGyro_start(Group):
    outer: _Number
    inner: _Number
    nutation: _Number

class FreeGyro(Instrument):
    spin: _FreeGyro_spin
    rotor: _FreeGyro_rotor
    inner_gimbal: _FreeGyro_inner_gimbal
    outer_gimbal: _FreeGyro_outer_gimbal
    suspended: _FreeGyro_suspended
    unbalance: _FreeGyro_unbalance
    compliance: _FreeGyro_compliance
    friction: _FreeGyro_friction
    gimbal: _FreeGyro_gimbal
    torque: _FreeGyro_torque
    pickoff: _FreeGyro_pickoff
    start: _FreeGyro_start
    error: _Number
    polar_inertia: _Number
    transverse_inertia: _Number
    mass: _Number
    viscous: _Number
    coulomb: _Number
    stop: _Number
    temperature: _Number
    repeatability: _Number
    instability: _Number
    resolution: _Number
    scale_error: _Number
    nutation: _Number
    def __init__(self, source_: _Source = ..., /, *, name: str | None = ..., spin: _Values = ...,
                 rotor: _Values = ..., inner_gimbal: _Values = ..., outer_gimbal: _Values = ...,
                 suspended: _Values = ..., unbalance: _Values = ..., compliance: _Values = ...,
                 friction: _Values = ..., gimbal: _Values = ..., torque: _Values = ..., pickoff:
                 _Values = ..., start: _Values = ..., error: _Quantity = ..., polar_inertia:
                 _Quantity = ..., transverse_inertia: _Quantity = ..., mass: _Quantity = ...,
                 viscous: _Quantity = ..., coulomb: _Quantity = ..., stop: _Quantity = ...,
                 temperature: _Quantity = ..., repeatability: _Quantity = ..., instability:
                 _Quantity = ..., resolution: _Quantity = ..., scale_error: _Quantity = ...,
                 nutation: _Quantity = ...) -> None: ...

class _RateGyro_wheel(Group):
    momentum: _Number
    momentum_error: _Number

class _RateGyro_gimbal(Group):
    output_inertia: _Number
    input_inertia: _Number
    spin_inertia: _Number
    damping: _Number
    friction: _Number
    stop: _Number

class _RateGyro_spring(Group):
    stiffness: _Number
    error: _Number
    temperature: _Number

class _RateGyro_balance(Group):
    mass: _Number
    offset_input: _Number
    offset_spin: _Number
    compliance_input: _Number
    compliance_spin: _Number

class _RateGyro_torque(Group):
    fixed: _Number
    temperature: _Number
    repeatability: _Number
    instability: _Number
    noise: _Number

class _RateGyro_pickoff(Group):
    noise: _Number
    resolution: _Number

class RateGyro(Instrument):
    wheel: _RateGyro_wheel
    gimbal: _RateGyro_gimbal
    spring: _RateGyro_spring
    balance: _RateGyro_balance
    torque: _RateGyro_torque
    pickoff: _RateGyro_pickoff
    momentum: _Number
    momentum_error: _Number
    output_inertia: _Number
    input_inertia: _Number
    spin_inertia: _Number
    damping: _Number
    friction: _Number
    stop: _Number
    stiffness: _Number
    error: _Number
    mass: _Number
    offset_input: _Number
    offset_spin: _Number
    compliance_input: _Number
    compliance_spin: _Number
    fixed: _Number
    repeatability: _Number
    instability: _Number
    resolution: _Number
    def __init__(self, source_: _Source = ..., /, *, name: str | None = ..., wheel: _Values = ...,
                 gimbal: _Values = ..., spring: _Values = ..., balance: _Values = ..., torque:
                 _Values = ..., pickoff: _Values = ..., momentum: _Quantity = ..., momentum_error:
                 _Quantity = ..., output_inertia: _Quantity = ..., input_inertia: _Quantity = ...,
                 spin_inertia: _Quantity = ..., damping: _Quantity = ..., friction: _Quantity =
                 ..., stop: _Quantity = ..., stiffness: _Quantity = ..., error: _Quantity = ...,
                 mass: _Quantity = ..., offset_input: _Quantity = ..., offset_spin: _Quantity =
                 ..., compliance_input: _Quantity = ..., compliance_spin: _Quantity = ..., fixed:
                 _Quantity = ..., repeatability: _Quantity = ..., instability: _Quantity = ...,
                 resolution: _Quantity = ...) -> None: ...

class _RateIntegratingGyro_wheel(Group):
    momentum: _Number
    momentum_error: _Number

class _RateIntegratingGyro_float(Group):
    output_inertia: _Number
    input_inertia: _Number
    spin_inertia: _Number
    damping: _Number
    stiffness: _Number
    stop: _Number

class _RateIntegratingGyro_balance(Group):
    mass: _Number
    offset_input: _Number
    offset_spin: _Number
    compliance_input: _Number
    compliance_spin: _Number

class _RateIntegratingGyro_torque(Group):
    fixed: _Number
    temperature: _Number
    repeatability: _Number
    instability: _Number
    noise: _Number

class _RateIntegratingGyro_pickoff(Group):
    noise: _Number
    resolution: _Number

class _RateIntegratingGyro_torquer(Group):
    limit: _Number
    error: _Number
    temperature: _Number

class _RateIntegratingGyro_pulse(Group):
    frequency: _Number
    lead: _Number

class _RateIntegratingGyro_loop(Group):
    frequency: _Number
    damping: _Number

class RateIntegratingGyro(Instrument):
    wheel: _RateIntegratingGyro_wheel
    float: _RateIntegratingGyro_float
    balance: _RateIntegratingGyro_balance
    torque: _RateIntegratingGyro_torque
    pickoff: _RateIntegratingGyro_pickoff
    torquer: _RateIntegratingGyro_torquer
    pulse: _RateIntegratingGyro_pulse
    loop: _RateIntegratingGyro_loop
    momentum: _Number
    momentum_error: _Number
    output_inertia: _Number
    input_inertia: _Number
    spin_inertia: _Number
    stiffness: _Number
    stop: _Number
    mass: _Number
    offset_input: _Number
    offset_spin: _Number
    compliance_input: _Number
    compliance_spin: _Number
    fixed: _Number
    repeatability: _Number
    instability: _Number
    resolution: _Number
    rebalance: _Choice
    limit: _Number
    error: _Number
    lead: _Number
    def __init__(self, source_: _Source = ..., /, *, name: str | None = ..., wheel: _Values = ...,
                 float: _Values = ..., balance: _Values = ..., torque: _Values = ..., pickoff:
                 _Values = ..., torquer: _Values = ..., pulse: _Values = ..., loop: _Values = ...,
                 momentum: _Quantity = ..., momentum_error: _Quantity = ..., output_inertia:
                 _Quantity = ..., input_inertia: _Quantity = ..., spin_inertia: _Quantity = ...,
                 stiffness: _Quantity = ..., stop: _Quantity = ..., mass: _Quantity = ...,
                 offset_input: _Quantity = ..., offset_spin: _Quantity = ..., compliance_input:
                 _Quantity = ..., compliance_spin: _Quantity = ..., fixed: _Quantity = ...,
                 repeatability: _Quantity = ..., instability: _Quantity = ..., resolution:
                 _Quantity = ..., rebalance: _Choice = ..., limit: _Quantity = ..., error:
                 _Quantity = ..., lead: _Quantity = ...) -> None: ...

class _TunedGyro_wheel(Group):
    spin_frequency: _Number
    speed_error: _Number

class _TunedGyro_rotor(Group):
    axial_inertia: _Number
    transverse_inertia: _Number
    mass: _Number
    axial_offset: _Number
    quadrature_offset: _Number
    axial_compliance: _Number
    radial_compliance: _Number

class _TunedGyro_gimbal(Group):
    inertia_x: _Number
    inertia_y: _Number
    inertia_z: _Number

class _TunedGyro_hinge(Group):
    stiffness_x: _Number
    stiffness_y: _Number
    damping: _Number

class _TunedGyro_torque(Group):
    fixed: _Number
    temperature: _Number
    repeatability: _Number
    instability: _Number
    noise: _Number

class _TunedGyro_pickoff(Group):
    noise: _Number
    offset_x: _Number
    offset_y: _Number
    range: _Number

class _TunedGyro_torquer(Group):
    limit: _Number
    error: _Number
    temperature: _Number

class _TunedGyro_loop(Group):
    captured: _Switch
    frequency: _Number
    damping: _Number
    filter: _Number

class TunedGyro(Instrument):
    wheel: _TunedGyro_wheel
    rotor: _TunedGyro_rotor
    gimbal: _TunedGyro_gimbal
    hinge: _TunedGyro_hinge
    torque: _TunedGyro_torque
    pickoff: _TunedGyro_pickoff
    torquer: _TunedGyro_torquer
    loop: _TunedGyro_loop
    spin_frequency: _Number
    speed_error: _Number
    axial_inertia: _Number
    transverse_inertia: _Number
    mass: _Number
    axial_offset: _Number
    quadrature_offset: _Number
    axial_compliance: _Number
    radial_compliance: _Number
    inertia_x: _Number
    inertia_y: _Number
    inertia_z: _Number
    stiffness_x: _Number
    stiffness_y: _Number
    fixed: _Number
    repeatability: _Number
    instability: _Number
    offset_x: _Number
    offset_y: _Number
    range: _Number
    limit: _Number
    error: _Number
    captured: _Switch
    frequency: _Number
    filter: _Number
    def __init__(self, source_: _Source = ..., /, *, name: str | None = ..., wheel: _Values = ...,
                 rotor: _Values = ..., gimbal: _Values = ..., hinge: _Values = ..., torque: _Values
                 = ..., pickoff: _Values = ..., torquer: _Values = ..., loop: _Values = ...,
                 spin_frequency: _Quantity = ..., speed_error: _Quantity = ..., axial_inertia:
                 _Quantity = ..., transverse_inertia: _Quantity = ..., mass: _Quantity = ...,
                 axial_offset: _Quantity = ..., quadrature_offset: _Quantity = ...,
                 axial_compliance: _Quantity = ..., radial_compliance: _Quantity = ..., inertia_x:
                 _Quantity = ..., inertia_y: _Quantity = ..., inertia_z: _Quantity = ...,
                 stiffness_x: _Quantity = ..., stiffness_y: _Quantity = ..., fixed: _Quantity =
                 ..., repeatability: _Quantity = ..., instability: _Quantity = ..., offset_x:
                 _Quantity = ..., offset_y: _Quantity = ..., range: _Quantity = ..., limit:
                 _Quantity = ..., error: _Quantity = ..., captured: _Switch = ..., frequency:
                 _Quantity = ..., filter: _Quantity = ...) -> None: ...

class _SuspendedRotor_spin(Group):
    rate: _Number

class _SuspendedRotor_ball(Group):
    diameter: _Number
    hollow: _Number
    density: _Number
    inertia_difference: _Number
    unbalance: _Number
    oblateness: _Number
    pear: _Number

class _SuspendedRotor_suspension(Group):
    limit: _Number
    gap: _Number
    clearance: _Number
    bandwidth: _Number
    restitution: _Number
    friction: _Number
    preload_error_x: _Number
    preload_error_y: _Number
    preload_error_z: _Number

class _SuspendedRotor_torque(Group):
    x: _Number
    y: _Number
    z: _Number
    temperature: _Number
    repeatability: _Number
    instability: _Number
    noise: _Number

class _SuspendedRotor_readout(Group):
    resolution: _Number
    noise: _Number

class _SuspendedRotor_start(Group):
    tilt: _Number
    azimuth: _Number

class _SuspendedRotor_wobble(Group):
    start: _Number
    time: _Number

class SuspendedRotor(Instrument):
    spin: _SuspendedRotor_spin
    ball: _SuspendedRotor_ball
    suspension: _SuspendedRotor_suspension
    torque: _SuspendedRotor_torque
    readout: _SuspendedRotor_readout
    start: _SuspendedRotor_start
    wobble: _SuspendedRotor_wobble
    rate: _Number
    diameter: _Number
    hollow: _Number
    density: _Number
    inertia_difference: _Number
    unbalance: _Number
    oblateness: _Number
    pear: _Number
    limit: _Number
    gap: _Number
    clearance: _Number
    bandwidth: _Number
    restitution: _Number
    friction: _Number
    preload_error_x: _Number
    preload_error_y: _Number
    preload_error_z: _Number
    x: _Number
    y: _Number
    z: _Number
    temperature: _Number
    repeatability: _Number
    instability: _Number
    resolution: _Number
    tilt: _Number
    azimuth: _Number
    time: _Number
    def __init__(self, source_: _Source = ..., /, *, name: str | None = ..., spin: _Values = ...,
                 ball: _Values = ..., suspension: _Values = ..., torque: _Values = ..., readout:
                 _Values = ..., start: _Values = ..., wobble: _Values = ..., rate: _Quantity = ...,
                 diameter: _Quantity = ..., hollow: _Quantity = ..., density: _Quantity = ...,
                 inertia_difference: _Quantity = ..., unbalance: _Quantity = ..., oblateness:
                 _Quantity = ..., pear: _Quantity = ..., limit: _Quantity = ..., gap: _Quantity =
                 ..., clearance: _Quantity = ..., bandwidth: _Quantity = ..., restitution:
                 _Quantity = ..., friction: _Quantity = ..., preload_error_x: _Quantity = ...,
                 preload_error_y: _Quantity = ..., preload_error_z: _Quantity = ..., x: _Quantity =
                 ..., y: _Quantity = ..., z: _Quantity = ..., temperature: _Quantity = ...,
                 repeatability: _Quantity = ..., instability: _Quantity = ..., resolution:
                 _Quantity = ..., tilt: _Quantity = ..., azimuth: _Quantity = ..., time: _Quantity
                 = ...) -> None: ...

class _FibreOptic_loop(Group):
    mode: _Choice
    gain: _Number
    crosstalk: _Number
    range: _Number

class _FibreOptic_coil(Group):
    length: _Number
    diameter: _Number
    index: _Number
    attenuation: _Number
    expansion: _Number
    thermo_optic: _Number
    winding_residual: _Number

class _FibreOptic_source(Group):
    power: _Number
    power_error: _Number
    wavelength: _Number
    wavelength_error: _Number
    wavelength_repeatability: _Number
    wavelength_temperature: _Number
    linewidth: _Number
    intensity_noise: _Number

class _FibreOptic_optics(Group):
    loss: _Number
    visibility: _Number

class _FibreOptic_modulator(Group):
    depth: _Number
    depth_error: _Number
    gain_error: _Number
    reset_error: _Number
    bits: _Count

class _FibreOptic_detector(Group):
    responsivity: _Number
    load: _Number
    converter_range: _Number
    converter_bits: _Count
    demodulation_error: _Number

class _FibreOptic_output(Group):
    bits: _Count

class _FibreOptic_phase(Group):
    fixed: _Number
    temperature: _Number
    repeatability: _Number
    instability: _Number

class FibreOptic(Instrument):
    loop: _FibreOptic_loop
    coil: _FibreOptic_coil
    source: _FibreOptic_source
    optics: _FibreOptic_optics
    modulator: _FibreOptic_modulator
    detector: _FibreOptic_detector
    output: _FibreOptic_output
    phase: _FibreOptic_phase
    mode: _Choice
    gain: _Number
    crosstalk: _Number
    range: _Number
    length: _Number
    diameter: _Number
    index: _Number
    attenuation: _Number
    expansion: _Number
    thermo_optic: _Number
    winding_residual: _Number
    power: _Number
    power_error: _Number
    wavelength: _Number
    wavelength_error: _Number
    wavelength_repeatability: _Number
    wavelength_temperature: _Number
    linewidth: _Number
    intensity_noise: _Number
    loss: _Number
    visibility: _Number
    depth: _Number
    depth_error: _Number
    gain_error: _Number
    reset_error: _Number
    responsivity: _Number
    converter_range: _Number
    converter_bits: _Count
    demodulation_error: _Number
    fixed: _Number
    temperature: _Number
    repeatability: _Number
    instability: _Number
    def __init__(self, source_: _Source = ..., /, *, name: str | None = ..., loop: _Values = ...,
                 coil: _Values = ..., source: _Values = ..., optics: _Values = ..., modulator:
                 _Values = ..., detector: _Values = ..., output: _Values = ..., phase: _Values =
                 ..., mode: _Choice = ..., gain: _Quantity = ..., crosstalk: _Quantity = ...,
                 range: _Quantity = ..., length: _Quantity = ..., diameter: _Quantity = ..., index:
                 _Quantity = ..., attenuation: _Quantity = ..., expansion: _Quantity = ...,
                 thermo_optic: _Quantity = ..., winding_residual: _Quantity = ..., power: _Quantity
                 = ..., power_error: _Quantity = ..., wavelength: _Quantity = ...,
                 wavelength_error: _Quantity = ..., wavelength_repeatability: _Quantity = ...,
                 wavelength_temperature: _Quantity = ..., linewidth: _Quantity = ...,
                 intensity_noise: _Quantity = ..., loss: _Quantity = ..., visibility: _Quantity =
                 ..., depth: _Quantity = ..., depth_error: _Quantity = ..., gain_error: _Quantity =
                 ..., reset_error: _Quantity = ..., responsivity: _Quantity = ..., converter_range:
                 _Quantity = ..., converter_bits: _Count = ..., demodulation_error: _Quantity =
                 ..., fixed: _Quantity = ..., temperature: _Quantity = ..., repeatability:
                 _Quantity = ..., instability: _Quantity = ...) -> None: ...

class _RingLaser_cavity(Group):
    shape: _Choice
    perimeter: _Number
    wavelength: _Number
    loss: _Number
    power: _Number

class _RingLaser_lock_in(Group):
    rate: _Number
    phase: _Number

class _RingLaser_dither(Group):
    frequency: _Number
    rate: _Number
    randomness: _Number

class _RingLaser_null_shift(Group):
    fixed: _Number
    repeatability: _Number
    instability: _Number
    temperature: _Number

class _RingLaser_scale_factor(Group):
    error: _Number
    repeatability: _Number

class _RingLaser_path_length(Group):
    expansion: _Number
    stroke: _Number

class _RingLaser_alignment(Group):
    y: _Number
    z: _Number

class _RingLaser_readout(Group):
    decoding: _Choice
    stripping: _Choice
    pickoff_error: _Number
    range: _Number

class _RingLaser_temperature(Group):
    reference: _Number
    minimum: _Number
    maximum: _Number

class RingLaser(Instrument):
    cavity: _RingLaser_cavity
    lock_in: _RingLaser_lock_in
    dither: _RingLaser_dither
    null_shift: _RingLaser_null_shift
    scale_factor: _RingLaser_scale_factor
    path_length: _RingLaser_path_length
    alignment: _RingLaser_alignment
    readout: _RingLaser_readout
    temperature: _RingLaser_temperature
    shape: _Choice
    perimeter: _Number
    wavelength: _Number
    loss: _Number
    power: _Number
    phase: _Number
    frequency: _Number
    randomness: _Number
    fixed: _Number
    instability: _Number
    error: _Number
    expansion: _Number
    stroke: _Number
    y: _Number
    z: _Number
    decoding: _Choice
    stripping: _Choice
    pickoff_error: _Number
    range: _Number
    reference: _Number
    minimum: _Number
    maximum: _Number
    def __init__(self, source_: _Source = ..., /, *, name: str | None = ..., cavity: _Values = ...,
                 lock_in: _Values = ..., dither: _Values = ..., null_shift: _Values = ...,
                 scale_factor: _Values = ..., path_length: _Values = ..., alignment: _Values = ...,
                 readout: _Values = ..., temperature: _Values = ..., shape: _Choice = ...,
                 perimeter: _Quantity = ..., wavelength: _Quantity = ..., loss: _Quantity = ...,
                 power: _Quantity = ..., phase: _Quantity = ..., frequency: _Quantity = ...,
                 randomness: _Quantity = ..., fixed: _Quantity = ..., instability: _Quantity = ...,
                 error: _Quantity = ..., expansion: _Quantity = ..., stroke: _Quantity = ..., y:
                 _Quantity = ..., z: _Quantity = ..., decoding: _Choice = ..., stripping: _Choice =
                 ..., pickoff_error: _Quantity = ..., range: _Quantity = ..., reference: _Quantity
                 = ..., minimum: _Quantity = ..., maximum: _Quantity = ...) -> None: ...

class _TuningFork_drive(Group):
    frequency: _Number
    q: _Number
    amplitude: _Number
    amplitude_error: _Number
    amplitude_repeatability: _Number
    loop_bandwidth: _Number
    force_limit: _Number
    force_angle: _Number
    pickoff_noise: _Number

class _TuningFork_sense(Group):
    split: _Number
    q: _Number
    loop: _Choice
    bandwidth: _Number
    pickoff_noise: _Number

class _TuningFork_phase(Group):
    error: _Number
    repeatability: _Number
    instability: _Number

class _TuningFork_tines(Group):
    asymmetry: _Number
    common_frequency: _Number
    gap: _Number

class _TuningFork_temperature(Group):
    frequency: _Number
    split: _Number
    q: _Number
    amplitude: _Number
    phase: _Number

class _TuningFork_output(Group):
    bandwidth: _Number
    damping: _Number
    range: _Number
    resolution: _Number

class TuningFork(Instrument):
    drive: _TuningFork_drive
    sense: _TuningFork_sense
    phase: _TuningFork_phase
    tines: _TuningFork_tines
    temperature: _TuningFork_temperature
    output: _TuningFork_output
    arrangement: _Choice
    mass: _Number
    angular_gain: _Number
    quadrature: _Number
    damping_coupling: _Number
    amplitude_error: _Number
    amplitude_repeatability: _Number
    loop_bandwidth: _Number
    force_limit: _Number
    force_angle: _Number
    loop: _Choice
    error: _Number
    repeatability: _Number
    instability: _Number
    asymmetry: _Number
    common_frequency: _Number
    gap: _Number
    damping: _Number
    range: _Number
    resolution: _Number
    def __init__(self, source_: _Source = ..., /, *, name: str | None = ..., drive: _Values = ...,
                 sense: _Values = ..., phase: _Values = ..., tines: _Values = ..., temperature:
                 _Values = ..., output: _Values = ..., arrangement: _Choice = ..., mass: _Quantity
                 = ..., angular_gain: _Quantity = ..., quadrature: _Quantity = ...,
                 damping_coupling: _Quantity = ..., amplitude_error: _Quantity = ...,
                 amplitude_repeatability: _Quantity = ..., loop_bandwidth: _Quantity = ...,
                 force_limit: _Quantity = ..., force_angle: _Quantity = ..., loop: _Choice = ...,
                 error: _Quantity = ..., repeatability: _Quantity = ..., instability: _Quantity =
                 ..., asymmetry: _Quantity = ..., common_frequency: _Quantity = ..., gap: _Quantity
                 = ..., damping: _Quantity = ..., range: _Quantity = ..., resolution: _Quantity =
                 ...) -> None: ...

class _ShellGyro_resonator(Group):
    shape: _Choice
    mode_number: _Count
    angular_gain: _Number
    angular_gain_error: _Number
    mass: _Number
    frequency: _Number
    quality: _Number
    frequency_temperature: _Number
    damping_temperature: _Number

class _ShellGyro_anisotropy(Group):
    damping_difference: _Number
    damping_angle: _Number
    damping_repeatability: _Number
    damping_instability: _Number
    frequency_split: _Number
    stiffness_angle: _Number

class _ShellGyro_pattern(Group):
    amplitude: _Number
    angle: _Number

class _ShellGyro_pickoff(Group):
    noise: _Number
    gain_error: _Number
    gain_mismatch: _Number
    misalignment: _Number

class _ShellGyro_forcer(Group):
    drive: _Choice
    gain_error: _Number
    gain_mismatch: _Number
    misalignment: _Number
    gain_temperature: _Number
    limit: _Number

class _ShellGyro_control(Group):
    cycles: _Count
    rebalance_bandwidth: _Number
    support_bandwidth: _Number
    phase_error: _Number

class _ShellGyro_package(Group):
    misalignment_y: _Number
    misalignment_z: _Number

class ShellGyro(Instrument):
    resonator: _ShellGyro_resonator
    anisotropy: _ShellGyro_anisotropy
    pattern: _ShellGyro_pattern
    pickoff: _ShellGyro_pickoff
    forcer: _ShellGyro_forcer
    control: _ShellGyro_control
    package: _ShellGyro_package
    mode: _Choice
    shape: _Choice
    mode_number: _Count
    angular_gain: _Number
    angular_gain_error: _Number
    mass: _Number
    frequency: _Number
    quality: _Number
    frequency_temperature: _Number
    damping_temperature: _Number
    damping_difference: _Number
    damping_angle: _Number
    damping_repeatability: _Number
    damping_instability: _Number
    frequency_split: _Number
    stiffness_angle: _Number
    amplitude: _Number
    angle: _Number
    noise: _Number
    drive: _Choice
    gain_temperature: _Number
    limit: _Number
    cycles: _Count
    rebalance_bandwidth: _Number
    support_bandwidth: _Number
    phase_error: _Number
    misalignment_y: _Number
    misalignment_z: _Number
    def __init__(self, source_: _Source = ..., /, *, name: str | None = ..., resonator: _Values =
                 ..., anisotropy: _Values = ..., pattern: _Values = ..., pickoff: _Values = ...,
                 forcer: _Values = ..., control: _Values = ..., package: _Values = ..., mode:
                 _Choice = ..., shape: _Choice = ..., mode_number: _Count = ..., angular_gain:
                 _Quantity = ..., angular_gain_error: _Quantity = ..., mass: _Quantity = ...,
                 frequency: _Quantity = ..., quality: _Quantity = ..., frequency_temperature:
                 _Quantity = ..., damping_temperature: _Quantity = ..., damping_difference:
                 _Quantity = ..., damping_angle: _Quantity = ..., damping_repeatability: _Quantity
                 = ..., damping_instability: _Quantity = ..., frequency_split: _Quantity = ...,
                 stiffness_angle: _Quantity = ..., amplitude: _Quantity = ..., angle: _Quantity =
                 ..., noise: _Quantity = ..., drive: _Choice = ..., gain_temperature: _Quantity =
                 ..., limit: _Quantity = ..., cycles: _Count = ..., rebalance_bandwidth: _Quantity
                 = ..., support_bandwidth: _Quantity = ..., phase_error: _Quantity = ...,
                 misalignment_y: _Quantity = ..., misalignment_z: _Quantity = ...) -> None: ...

class _MemsAccelerometer_proof_mass(Group):
    mass: _Number
    frequency: _Number
    quality: _Number
    squeeze_film: _Switch

class _MemsAccelerometer_spring(Group):
    quadratic: _Number
    cubic: _Number
    temperature: _Number
    tilt_y: _Number
    tilt_z: _Number

class _MemsAccelerometer_electrodes(Group):
    plates: _Choice
    area: _Number
    gap: _Number
    offset: _Number
    stop: _Number
    restitution: _Number
    voltage: _Number
    voltage_rate: _Number
    voltage_temperature: _Number

class _MemsAccelerometer_pickoff(Group):
    kind: _Choice
    noise: _Number
    offset: _Number

class _MemsAccelerometer_feedback(Group):
    voltage: _Number

class _MemsAccelerometer_analog(Group):
    bandwidth: _Number
    damping: _Number
    reset: _Number
    amplifier: _Number

class _MemsAccelerometer_sigma_delta(Group):
    clock: _Number
    lead: _Number
    integral: _Number

class _MemsAccelerometer_output(Group):
    bandwidth: _Number
    range: _Number
    resolution: _Number
    gain_repeatability: _Number

class _MemsAccelerometer_bias(Group):
    fixed: _Number
    repeatability: _Number
    instability: _Number
    temperature: _Number

class MemsAccelerometer(Instrument):
    proof_mass: _MemsAccelerometer_proof_mass
    spring: _MemsAccelerometer_spring
    electrodes: _MemsAccelerometer_electrodes
    pickoff: _MemsAccelerometer_pickoff
    feedback: _MemsAccelerometer_feedback
    analog: _MemsAccelerometer_analog
    sigma_delta: _MemsAccelerometer_sigma_delta
    output: _MemsAccelerometer_output
    bias: _MemsAccelerometer_bias
    loop: _Choice
    mass: _Number
    frequency: _Number
    quality: _Number
    squeeze_film: _Switch
    quadratic: _Number
    cubic: _Number
    tilt_y: _Number
    tilt_z: _Number
    plates: _Choice
    area: _Number
    gap: _Number
    stop: _Number
    restitution: _Number
    voltage_rate: _Number
    voltage_temperature: _Number
    kind: _Choice
    noise: _Number
    damping: _Number
    reset: _Number
    amplifier: _Number
    clock: _Number
    lead: _Number
    integral: _Number
    range: _Number
    resolution: _Number
    gain_repeatability: _Number
    fixed: _Number
    repeatability: _Number
    instability: _Number
    def __init__(self, source_: _Source = ..., /, *, name: str | None = ..., proof_mass: _Values =
                 ..., spring: _Values = ..., electrodes: _Values = ..., pickoff: _Values = ...,
                 feedback: _Values = ..., analog: _Values = ..., sigma_delta: _Values = ...,
                 output: _Values = ..., bias: _Values = ..., loop: _Choice = ..., mass: _Quantity =
                 ..., frequency: _Quantity = ..., quality: _Quantity = ..., squeeze_film: _Switch =
                 ..., quadratic: _Quantity = ..., cubic: _Quantity = ..., tilt_y: _Quantity = ...,
                 tilt_z: _Quantity = ..., plates: _Choice = ..., area: _Quantity = ..., gap:
                 _Quantity = ..., stop: _Quantity = ..., restitution: _Quantity = ...,
                 voltage_rate: _Quantity = ..., voltage_temperature: _Quantity = ..., kind: _Choice
                 = ..., noise: _Quantity = ..., damping: _Quantity = ..., reset: _Quantity = ...,
                 amplifier: _Quantity = ..., clock: _Quantity = ..., lead: _Quantity = ...,
                 integral: _Quantity = ..., range: _Quantity = ..., resolution: _Quantity = ...,
                 gain_repeatability: _Quantity = ..., fixed: _Quantity = ..., repeatability:
                 _Quantity = ..., instability: _Quantity = ...) -> None: ...

class _PendulousServo_pendulum(Group):
    pendulosity: _Number
    inertia: _Number
    damping: _Number
    stop: _Number
    misalignment_y: _Number
    misalignment_z: _Number

class _PendulousServo_hinge(Group):
    stiffness: _Number
    torque: _Number
    torque_temperature: _Number
    torque_repeatability: _Number
    torque_instability: _Number

class _PendulousServo_controller(Group):
    proportional: _Number
    integral: _Number
    pickoff_noise: _Number

class _PendulousServo_torquer(Group):
    constant: _Number
    error: _Number
    temperature: _Number
    repeatability: _Number
    quadratic: _Number
    largest_current: _Number

class _PendulousServo_readout(Group):
    noise: _Number
    step: _Number

class PendulousServo(Instrument):
    pendulum: _PendulousServo_pendulum
    hinge: _PendulousServo_hinge
    controller: _PendulousServo_controller
    torquer: _PendulousServo_torquer
    readout: _PendulousServo_readout
    pendulosity: _Number
    inertia: _Number
    damping: _Number
    stop: _Number
    misalignment_y: _Number
    misalignment_z: _Number
    stiffness: _Number
    torque: _Number
    torque_temperature: _Number
    torque_repeatability: _Number
    torque_instability: _Number
    proportional: _Number
    integral: _Number
    pickoff_noise: _Number
    constant: _Number
    error: _Number
    repeatability: _Number
    quadratic: _Number
    largest_current: _Number
    noise: _Number
    step: _Number
    def __init__(self, source_: _Source = ..., /, *, name: str | None = ..., pendulum: _Values =
                 ..., hinge: _Values = ..., controller: _Values = ..., torquer: _Values = ...,
                 readout: _Values = ..., pendulosity: _Quantity = ..., inertia: _Quantity = ...,
                 damping: _Quantity = ..., stop: _Quantity = ..., misalignment_y: _Quantity = ...,
                 misalignment_z: _Quantity = ..., stiffness: _Quantity = ..., torque: _Quantity =
                 ..., torque_temperature: _Quantity = ..., torque_repeatability: _Quantity = ...,
                 torque_instability: _Quantity = ..., proportional: _Quantity = ..., integral:
                 _Quantity = ..., pickoff_noise: _Quantity = ..., constant: _Quantity = ..., error:
                 _Quantity = ..., repeatability: _Quantity = ..., quadratic: _Quantity = ...,
                 largest_current: _Quantity = ..., noise: _Quantity = ..., step: _Quantity = ...) -> None: ...

class _VibratingBeam_beam(Group):
    length: _Number
    width: _Number
    thickness: _Number
    modulus: _Number
    density: _Number
    quality: _Number
    amplitude: _Number
    pickoff_noise: _Number
    frequency_mismatch: _Number
    frequency_temperature: _Number
    temperature_mismatch: _Number

class _VibratingBeam_proof_mass(Group):
    mass: _Number
    error: _Number
    frequency: _Number
    damping: _Number
    range: _Number

class _VibratingBeam_mount(Group):
    force: _Number
    force_repeatability: _Number
    force_instability: _Number

class VibratingBeam(Instrument):
    beam: _VibratingBeam_beam
    proof_mass: _VibratingBeam_proof_mass
    mount: _VibratingBeam_mount
    arrangement: _Choice
    readout: _Choice
    clock: _Number
    temperature: _Number
    length: _Number
    width: _Number
    thickness: _Number
    modulus: _Number
    density: _Number
    quality: _Number
    amplitude: _Number
    pickoff_noise: _Number
    frequency_mismatch: _Number
    frequency_temperature: _Number
    temperature_mismatch: _Number
    mass: _Number
    error: _Number
    frequency: _Number
    damping: _Number
    range: _Number
    force: _Number
    force_repeatability: _Number
    force_instability: _Number
    def __init__(self, source_: _Source = ..., /, *, name: str | None = ..., beam: _Values = ...,
                 proof_mass: _Values = ..., mount: _Values = ..., arrangement: _Choice = ...,
                 readout: _Choice = ..., clock: _Quantity = ..., temperature: _Quantity = ...,
                 length: _Quantity = ..., width: _Quantity = ..., thickness: _Quantity = ...,
                 modulus: _Quantity = ..., density: _Quantity = ..., quality: _Quantity = ...,
                 amplitude: _Quantity = ..., pickoff_noise: _Quantity = ..., frequency_mismatch:
                 _Quantity = ..., frequency_temperature: _Quantity = ..., temperature_mismatch:
                 _Quantity = ..., mass: _Quantity = ..., error: _Quantity = ..., frequency:
                 _Quantity = ..., damping: _Quantity = ..., range: _Quantity = ..., force:
                 _Quantity = ..., force_repeatability: _Quantity = ..., force_instability:
                 _Quantity = ...) -> None: ...
