/* SPDX-License-Identifier: Apache-2.0 */
/* The tuning fork gyro: the default design, the table of its parameters, and which designs are
 * possible. */
#include "tuning_fork_internal.h"

#include "physics/design_rows_internal.h"

#include <float.h>
#include <math.h>

enum { COOKIE = 0x494D4B28 };

imk_tuning_fork imk_tuning_fork_default(void)
{
    return (imk_tuning_fork){
        .cookie = COOKIE,
        .arrangement = IMK_TUNING_FORK_IN_PLANE,
        .mass = 4e-9,
        .angular_gain = 1.0,
        .drive = {.frequency = 14e3,
                  .q = 45.0,
                  .amplitude = 5.0 * 1e-6,
                  .amplitude_repeatability = 1e-3,
                  .loop_bandwidth = 100.0,
                  .force_limit = 8e-6,
                  .force_angle = 2e-5,
                  .pickoff_noise = 0.5e-12},
        .sense = {.split = 1000.0,
                  .q = 45.0,
                  .loop = IMK_TUNING_FORK_OPEN,
                  .bandwidth = 100.0,
                  /* with the Brownian motion 0.05 deg/s/sqrt(Hz), one-sided */
                  .pickoff_noise = 0.4617 * 1e-12},
        .quadrature = 20.0 * IMKI_DEGREE,
        .damping_coupling = 0.5 * IMKI_DEGREE,
        /* of 20 deg/s: 100 deg/h from run to run, and a floor of 50 deg/h = 0.664 B */
        .phase = {.error = 5e-3, .repeatability = 1.39e-3, .instability = 1.046e-3},
        /* 0.2 deg/s/g */
        .tines = {.asymmetry = 4.14e-3, .common_frequency = 12e3, .gap = 2e-6},
        .temperature = {.frequency = -30.0 * 1e-6,
                        .q = -1.5e-3,
                        .amplitude = 100.0 * 1e-6,
                        .phase = 30e-6},
        .output = {.bandwidth = 40.0, .range = 150.0 * IMKI_DEGREE}};
}

/* ---- the table ------------------------------------------------------------------------------- */

#define DESIGN imk_tuning_fork
static const imk_design_field fields[] = {
    CHOICE("arrangement", arrangement, "in-plane|out-of-plane",
           "whether the sense motion stays in the plane of the chip"),
    NUMBER("mass", mass, "microgram", 1e-15, 1.0, "vibrating mass, above 0"),
    NUMBER("angular_gain", angular_gain, "1", 0.01, 1.0,
           "part of the mass that the Coriolis force couples, above 0, at most 1"),
    NUMBER("drive.frequency", drive.frequency, "kHz", 100.0, 1e7,
           "eigenfrequency of the drive mode"),
    ABOVE("drive.q", drive.q, "1", 0.5, 1e13,
          "quality factor of the drive mode, above 1/2: an oscillator is meant"),
    NUMBER("drive.amplitude", drive.amplitude, "um", 1e-10, 1e-2, "drive amplitude, above 0"),
    NUMBER("drive.amplitude_error", drive.amplitude_error, "ppm", -0.5, 0.5,
           "relative error of the amplitude held"),
    NUMBER("drive.amplitude_repeatability", drive.amplitude_repeatability, "ppm", 0.0, 0.5,
           "the same, 1 sigma from run to run"),
    ABOVE("drive.loop_bandwidth", drive.loop_bandwidth, "Hz", 0.0, 1e6,
          "bandwidth of amplitude control and phase lock, above 0"),
    ABOVE("drive.force_limit", drive.force_limit, "uN", 0.0, 1e3,
          "largest amplitude of the drive force, above 0"),
    NUMBER("drive.force_angle", drive.force_angle, "mrad", -0.1, 0.1,
           "angle between drive force and drive axis"),
    NUMBER("drive.pickoff_noise", drive.pickoff_noise, "pm/sqrt(Hz)", 0.0, 1e-6,
           "noise of the drive pickoff, one-sided"),
    NUMBER("sense.split", sense.split, "Hz", -1e7, 1e7,
           "sense less drive eigenfrequency, 0 when matched"),
    ABOVE("sense.q", sense.q, "1", 0.5, 1e13,
          "quality factor of the sense mode, above 1/2: an oscillator is meant"),
    CHOICE("sense.loop", sense.loop, "open|closed",
           "whether the sense motion is measured, or held at rest by a force"),
    ABOVE("sense.bandwidth", sense.bandwidth, "Hz", 0.0, 1e6,
          "bandwidth of a closed loop, above 0"),
    NUMBER("sense.pickoff_noise", sense.pickoff_noise, "pm/sqrt(Hz)", 0.0, 1e-6,
           "noise of the sense pickoff, one-sided"),
    NUMBER("quadrature", quadrature, "deg/s", -1e4, 1e4,
           "coupling of the stiffnesses, as the rate it looks like a quarter cycle off"),
    NUMBER("damping_coupling", damping_coupling, "deg/s", -1e3, 1e3,
           "coupling of the dampings, as the rate it looks like"),
    NUMBER("phase.error", phase.error, "mrad", -1.0, 1.0, "phase error of the demodulation"),
    NUMBER("phase.repeatability", phase.repeatability, "mrad", 0.0, 1.0,
           "the same, 1 sigma from run to run"),
    NUMBER("phase.instability", phase.instability, "mrad", 0.0, 1.0,
           "its flicker noise B within a run"),
    NUMBER("tines.asymmetry", tines.asymmetry, "ppm", -0.5, 0.5,
           "relative difference of the masses of the two tines"),
    NUMBER("tines.common_frequency", tines.common_frequency, "kHz", 1.0, 1e7,
           "frequency of both tines swinging together along the sense axis, above 0"),
    NUMBER("tines.gap", tines.gap, "um", 1e-8, 1e-2, "gap of the drive comb, above 0"),
    NUMBER("temperature.frequency", temperature.frequency, "ppm/K", -1e-2, 1e-2,
           "change of both eigenfrequencies"),
    NUMBER("temperature.split", temperature.split, "Hz/K", -1e5, 1e5,
           "change of the split besides"),
    NUMBER("temperature.q", temperature.q, "ppm/K", -0.1, 0.1, "change of both quality factors"),
    NUMBER("temperature.amplitude", temperature.amplitude, "ppm/K", -0.01, 0.01,
           "change of the amplitude held"),
    NUMBER("temperature.phase", temperature.phase, "mrad/K", -0.01, 0.01,
           "change of the phase error"),
    NUMBER("output.bandwidth", output.bandwidth, "Hz", 0.0, 1e6,
           "-3 dB of the output filter, 0 for none"),
    NUMBER("output.damping", output.damping, "1", 0.0, 50.0,
           "damping ratio of a filter of second order, 0 for first order"),
    NUMBER("output.range", output.range, "deg/s", 0.0, 1e5, "full scale, 0 for none"),
    NUMBER("output.resolution", output.resolution, "deg/s", 0.0, 1e3,
           "step of the output, 0 for none"),
};

/* ---- what is possible ------------------------------------------------------------------------ */

/* The straight lines with temperature must not leave what the parameters may be. */
static imk_status check_temperature(const imk_tuning_fork *design, double temperature,
                                    imk_error *error)
{
    const imki_fork_point p = imki_fork_at(design, temperature);
    const double force = design->mass * p.drive * p.drive_damping * p.amplitude;
    const double q_drive = p.drive / p.drive_damping, q_sense = p.sense / p.sense_damping;
    const double q = q_drive < q_sense ? q_drive : q_sense;
    const double coupling = 2.0 * design->angular_gain * fabs(design->damping_coupling);
    const double stiffness =
        4.0 * IMKI_PI * design->angular_gain * design->drive.frequency * fabs(design->quadrature);
    const double passive = sqrt(fabs(p.drive_damping * p.sense_damping));
    if (!(p.sense > 0.0))
        return imki_conflict(error, "sense.split", design->sense.split, -design->drive.frequency,
                             "a split that leaves the sense mode a frequency above 0");
    if (!(p.drive_damping > 0.0 && p.sense_damping > 0.0 && q > 0.5))
        return imki_conflict(error, "temperature.q", design->temperature.q, 0.0,
                             "quality factors above 1/2 from -40 to 125 degC");
    if (!(p.amplitude > 0.0))
        return imki_conflict(error, "temperature.amplitude", design->temperature.amplitude, 0.0,
                             "an amplitude above 0 from -40 to 125 degC");
    /* 5 %: what is left for control */
    if (!(force * 1.05 <= design->drive.force_limit))
        return imki_conflict(error, "drive.force_limit", design->drive.force_limit, force * 1.05,
                             "5 % more than m wd^2 x0/Qd, which holds the amplitude");
    if (!(coupling <= passive))
        return imki_conflict(error, "damping_coupling", design->damping_coupling,
                             passive / (2.0 * design->angular_gain),
                             "a coupling that excites no motion: at most sqrt(wd ws/(Qd Qs))/2k");
    if (!(stiffness < p.drive * p.sense))
        return imki_conflict(error, "quadrature", design->quadrature,
                             p.sense / (2.0 * design->angular_gain),
                             "a coupling that leaves the springs stable: below ws/2k");
    return IMK_OK;
}

/* The loops act once a cycle, one cycle late: at a twentieth of the frequency they keep 60 deg. */
static imk_status check_loops(const imk_tuning_fork *design, imk_error *error)
{
    const double limit = design->drive.frequency / 20.0, widest = design->drive.frequency / 8.0;
    static const char late[] = "at most a twentieth of the drive frequency: the loop acts once a "
                               "cycle and would be unstable";
    if (!(design->drive.loop_bandwidth <= limit))
        return imki_refuse(error, IMK_ERROR_RANGE, "drive.loop_bandwidth",
                           design->drive.loop_bandwidth, limit, late);
    if (design->sense.loop == IMK_TUNING_FORK_CLOSED && !(design->sense.bandwidth <= limit))
        return imki_refuse(error, IMK_ERROR_RANGE, "sense.bandwidth", design->sense.bandwidth,
                           limit, late);
    /* From one action to the next the sense mode turns by the split against the carrier. By
     * experiment at high Q (4000 designs drawn at random): all within this limit are stable, the
     * first that are not were at 1.45 times it. */
    if (design->sense.loop == IMK_TUNING_FORK_CLOSED &&
        !(fabs(design->sense.split) + design->sense.bandwidth <= 2.0 * limit))
        return imki_conflict(error, "sense.split", design->sense.split,
                             2.0 * limit - design->sense.bandwidth,
                             "a closed loop whose split and bandwidth are together at most a "
                             "tenth of the drive frequency: it would be unstable");
    if (!(design->output.bandwidth <= widest))
        return imki_refuse(error, IMK_ERROR_RANGE, "output.bandwidth", design->output.bandwidth,
                           widest, "at most an eighth of the drive frequency");
    if (design->output.damping > 0.0 && !(design->output.damping >= 0.05))
        return imki_refuse(error, IMK_ERROR_RANGE, "output.damping", design->output.damping, 0.05,
                           "0, or at least 0.05");
    return IMK_OK;
}

static imk_status check(const void *given, imk_error *error)
{
    const imk_tuning_fork *design = given;
    imk_status status = check_loops(design, error);
    const double temperatures[] = {IMKI_DESIGN_TEMPERATURE, IMKI_FORK_COLDEST, IMKI_FORK_HOTTEST};
    for (int i = 0; status == IMK_OK && i < 3; i++)
        status = check_temperature(design, temperatures[i], error);
    if (status == IMK_OK)
        status = imki_check_bias(&imk_tuning_fork_instrument, design, "output.range", error);
    return status;
}

/* ---- description ----------------------------------------------------------------------------- */

static const imk_signal outputs[] = {
    {"rate", "rad/s", "deg/s", "measured rate"},
    {"quadrature", "rad/s", "deg/s", "what is measured a quarter cycle off"},
};

enum { DRIVE, SENSE, AMPLITUDE, FREQUENCY, FORCE, LOCK, RATE, QUADRATURE, PHASE, SIGNALS };
static const imk_signal signals[SIGNALS] = {
    [DRIVE] = {"drive_displacement", "m", "um", "motion along the drive axis"},
    [SENSE] = {"sense_displacement", "m", "nm", "motion along the sense axis"},
    [AMPLITUDE] = {"drive_amplitude", "m", "um", "amplitude of the drive motion, as measured"},
    [FREQUENCY] = {"drive_frequency", "Hz", "Hz", "frequency of the phase-locked loop"},
    [FORCE] = {"drive_force", "N", "uN", "amplitude of the drive force"},
    [LOCK] = {"lock_error", "rad", "mrad", "phase of the drive motion less that of the reference"},
    [RATE] = {"demodulated_rate", "rad/s", "deg/s", "rate before the output filter"},
    [QUADRATURE] = {"demodulated_quadrature", "rad/s", "deg/s", "quadrature, likewise"},
    [PHASE] = {"electronics_phase", "rad", "mrad", "phase error of the demodulation"},
};

static const imk_view views[] = {
    {.title = "Drive motion",
     .caption = "Four cycles of the drive motion, held at its amplitude.",
     .x = -1,
     .curve_count = 1,
     .y = {DRIVE},
     .duration = 286e-6,
     .rate = 560e3,
     .settle = 0.05},
    {.title = "Sense motion",
     .caption = "The same four cycles along the sense axis: some hundred picometres, most of them "
                "quadrature.",
     .x = -1,
     .curve_count = 1,
     .y = {SENSE},
     .duration = 286e-6,
     .rate = 560e3,
     .settle = 0.05},
    {.title = "Path of the mass",
     .caption =
         "Sense against drive motion: quadrature tilts the line, a rate opens it to an ellipse.",
     .x = DRIVE,
     .curve_count = 1,
     .y = {SENSE},
     .duration = 286e-6,
     .rate = 560e3,
     .settle = 0.05,
     .input = 100.0 * IMKI_DEGREE},
    {.title = "Start of the drive",
     .caption = "From rest: the amplitude control is a loop of first order, of 100 Hz.",
     .x = -1,
     .curve_count = 1,
     .y = {AMPLITUDE},
     .duration = 20e-3,
     .rate = 7e3},
    {.title = "Force of the amplitude control",
     .caption = "First it accelerates the mass, then it replaces what the damping takes.",
     .x = -1,
     .curve_count = 1,
     .y = {FORCE},
     .duration = 20e-3,
     .rate = 7e3},
    {.title = "Demodulated rate and quadrature",
     .caption = "Both channels from switching on, before the output filter.",
     .x = -1,
     .curve_count = 2,
     .y = {RATE, QUADRATURE},
     .duration = 60e-3,
     .rate = 3.5e3,
     .input = 50.0 * IMKI_DEGREE},
};

IMKI_DESIGN_FUNCTIONS(tuning_fork);

const imk_instrument imk_tuning_fork_instrument = {
    IMKI_DESCRIBED(tuning_fork),
    .title = "tuning fork gyro",
    .technology = "Coriolis",
    .source =
        "ADXRS150 data sheet; J. A. Geen et al., IEEE J. Solid-State Circuits 37 (2002) 1860; "
        "mass, Q, split, quadrature and temperature coefficients chosen",
    .sensor = IMK_GYRO,
    .cookie = COOKIE,
    .state_size = sizeof(imki_fork_state),
    .init = imki_fork_init,
    .step = imki_fork_step,
    .observe = imki_fork_observe,
    .step_length = imki_fork_step_length};
