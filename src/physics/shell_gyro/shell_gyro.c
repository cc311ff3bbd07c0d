/* SPDX-License-Identifier: Apache-2.0 */
/* Shell gyro: its design, and its place among the instruments. Equations: shell_gyro.h; steady
 * state and closed forms shell_gyro_balance.c, full dynamics shell_gyro_cycle.c with the
 * electronics of shell_gyro_loops.c, averaged dynamics shell_gyro_slow.c, error model
 * shell_gyro_reduce.c. */
#include "imukit/elementary.h"
#include "physics/design_rows_internal.h"
#include "shell_gyro_internal.h"

#include <math.h>
#include <string.h>

#define DESIGN imk_shell_gyro
static const imk_design_field fields[] = {
    CHOICE("mode", mode, "force_to_rebalance|whole_angle|free",
           "what is done with the pattern: held, read as it turns, or left alone"),
    CHOICE("resonator.shape", resonator.shape, "ring|hemisphere|other", "decides the angular gain"),
    COUNT("resonator.mode_number", resonator.mode_number, 2, 8,
          "n: nodal diameters of the vibration"),
    NUMBER("resonator.angular_gain", resonator.angular_gain, "1", 0.01, 1.0,
           "of shape other: angle of the pattern per angle of the case"),
    NUMBER("resonator.angular_gain_error", resonator.angular_gain_error, "ppm", -0.5, 0.5,
           "relative error of the angular gain the electronics assume"),
    ABOVE("resonator.mass", resonator.mass, "kg", 0.0, 10.0, "modal mass"),
    NUMBER("resonator.frequency", resonator.frequency, "Hz", 10.0, 1e6,
           "of the vibration, at 20 degC"),
    NUMBER("resonator.quality", resonator.quality, "1", 10.0, 1e12, "Q, at 20 degC"),
    NUMBER("resonator.frequency_temperature", resonator.frequency_temperature, "1/K", -1e-2, 1e-2,
           "relative change of the frequency with temperature"),
    NUMBER("resonator.damping_temperature", resonator.damping_temperature, "1/K", -1e-2, 1e-2,
           "relative change of all damping with temperature"),
    NUMBER("anisotropy.damping_difference", anisotropy.damping_difference, "1/s", 0.0, 1e6,
           "D: 1/tau of one principal axis minus that of the other"),
    NUMBER("anisotropy.damping_angle", anisotropy.damping_angle, "deg", -10.0, 10.0,
           "modal angle of the axis of most damping"),
    NUMBER("anisotropy.damping_repeatability", anisotropy.damping_repeatability, "1/s", 0.0, 1e6,
           "1 sigma per run of either component of D"),
    NUMBER("anisotropy.damping_instability", anisotropy.damping_instability, "1/s", 0.0, 1e6,
           "flicker B of either component of D"),
    NUMBER("anisotropy.frequency_split", anisotropy.frequency_split, "Hz", 0.0, 1e4,
           "between the principal axes of stiffness"),
    NUMBER("anisotropy.stiffness_angle", anisotropy.stiffness_angle, "deg", -10.0, 10.0,
           "modal angle of the stiffer axis"),
    ABOVE("pattern.amplitude", pattern.amplitude, "um", 0.0, 1e-2, "of the vibration"),
    NUMBER("pattern.angle", pattern.angle, "deg", -10.0, 10.0,
           "modal angle at which the pattern is held, or starts"),
    NUMBER("pickoff.noise", pickoff.noise, "pm/sqrt(Hz)", 0.0, 1e-6,
           "of each mode's displacement, two-sided density"),
    NUMBER("pickoff.gain_error", pickoff.gain_error, "ppm", -0.5, 0.5, "of both modes, relative"),
    NUMBER("pickoff.gain_mismatch", pickoff.gain_mismatch, "ppm", -0.5, 0.5,
           "gain of x minus gain of y, relative"),
    NUMBER("pickoff.misalignment", pickoff.misalignment, "mrad", -0.5, 0.5,
           "by which the measured axes are closer than a right angle"),
    CHOICE("forcer.drive", forcer.drive, "directional|parametric",
           "how the amplitude is kept up: along the pattern, or at twice the frequency"),
    NUMBER("forcer.gain_error", forcer.gain_error, "ppm", -0.5, 0.5, "relative"),
    NUMBER("forcer.gain_mismatch", forcer.gain_mismatch, "ppm", -0.5, 0.5,
           "gain of x minus gain of y, relative"),
    NUMBER("forcer.misalignment", forcer.misalignment, "mrad", -0.5, 0.5,
           "by which the axes of the forces are closer than a right angle"),
    NUMBER("forcer.gain_temperature", forcer.gain_temperature, "1/K", -5e-3, 5e-3,
           "relative change of the gain with temperature"),
    NUMBER("forcer.limit", forcer.limit, "N", 0.0, 1e3,
           "largest force of the rebalance loop; 0: none"),
    COUNT("control.cycles", control.cycles, 1, 1000, "of the vibration per update of the loops"),
    ABOVE("control.rebalance_bandwidth", control.rebalance_bandwidth, "Hz", 0.0, 1e5,
          "of the loop that holds the pattern"),
    ABOVE("control.support_bandwidth", control.support_bandwidth, "Hz", 0.0, 1e5,
          "of the loops of amplitude, quadrature and phase"),
    NUMBER("control.phase_error", control.phase_error, "deg", -0.5, 0.5, "by which the forces lag"),
    NUMBER("package.misalignment_y", package.misalignment_y, "mrad", -0.5, 0.5,
           "response to the rate about y"),
    NUMBER("package.misalignment_z", package.misalignment_z, "mrad", -0.5, 0.5,
           "response to the rate about z"),
};

imk_shell_gyro imk_shell_gyro_default(void)
{
    const double pi = IMKI_PI, degree = pi / 180.0;
    return (imk_shell_gyro){
        .cookie = IMKI_SHELL_COOKIE,
        .mode = IMK_SHELL_REBALANCE,
        .resonator = {.shape = IMK_SHELL_RING,
                      .mode_number = 2,
                      .angular_gain = 0.4,
                      .mass = 3.3e-7, /* 0.625 of a silicon ring of 6 mm, 120 x 100 um */
                      .frequency = 14000.0,
                      .quality = 5000.0,
                      .frequency_temperature = -30e-6, /* silicon: half of that of its stiffness */
                      .damping_temperature = 1e-3},
        .anisotropy = {.damping_difference = 0.1,
                       .damping_angle = 10.0 * degree,
                       .damping_repeatability = 1.55e-3,
                       .damping_instability = 3.9e-5,
                       .frequency_split = 0.5,
                       .stiffness_angle = 20.0 * degree},
        .pattern = {.amplitude = 5.0 * 1e-6},
        .pickoff = {.noise = 9e-12,
                    .gain_error = 500e-6,
                    .gain_mismatch = 1e-3,
                    .misalignment = 1e-3},
        .forcer = {.gain_error = -300e-6,
                   .gain_mismatch = 1e-3,
                   .misalignment = 1e-3,
                   .gain_temperature = -100e-6,
                   .limit = 1.25e-6},
        .control = {.cycles = 4,
                    .rebalance_bandwidth = 55.0,
                    .support_bandwidth = 60.0,
                    .phase_error = 0.5 * degree},
        .package = {.misalignment_y = 0.01, .misalignment_z = -0.008}};
}

static imk_status check_loops(const imk_shell_gyro *design, imk_error *error)
{
    const double update = imki_shell_update(design);
    const double decay =
        1.0 / imk_shell_gyro_decay_time(design) + 0.5 * design->anisotropy.damping_difference;
    const double fastest = 0.1 / update;
    const double limit = imki_shell_command_limit(design);
    const imki_shell_balance steady =
        imki_shell_balance_at(design, IMKI_DESIGN_TEMPERATURE, 0.0, design->pattern.angle);
    if (design->mode == IMK_SHELL_FREE)
        return IMK_OK;
    if (!(update * decay <= 0.25))
        return imki_conflict(error, "control.cycles", design->control.cycles,
                             0.25 / (decay * update) * design->control.cycles,
                             "at least four updates of the loops in the decay time");
    if (!(design->control.support_bandwidth <= fastest))
        return imki_conflict(error, "control.support_bandwidth", design->control.support_bandwidth,
                             fastest,
                             "at most a tenth of the update rate: faster loops are not stable");
    if (design->mode == IMK_SHELL_REBALANCE && !(design->control.rebalance_bandwidth <= fastest))
        return imki_conflict(error, "control.rebalance_bandwidth",
                             design->control.rebalance_bandwidth, fastest,
                             "at most a tenth of the update rate: faster loops are not stable");
    if (!(fabs(steady.rebalance) < limit))
        return imki_conflict(error, "forcer.limit", design->forcer.limit,
                             design->forcer.limit * fabs(steady.rebalance) / limit,
                             "a force above the one that holds the pattern at rest");
    return IMK_OK;
}

static double smallest_pattern(const imk_shell_gyro *design)
{
    const double omega = 2.0 * IMKI_PI * design->resonator.frequency;
    const double thermal = IMKI_BOLTZMANN * IMKI_DESIGN_TEMPERATURE / design->resonator.mass;
    const double measured = imki_shell_angle_noise(design) * design->pattern.amplitude;
    return 10.0 * (sqrt(thermal) / omega + measured);
}

static imk_status check(const void *given, imk_error *error)
{
    const imk_shell_gyro *design = given;
    const double damping = 2.0 / imk_shell_gyro_decay_time(design);
    if (design->resonator.shape == IMK_SHELL_HEMISPHERE && design->resonator.mode_number != 2)
        return imki_conflict(error, "resonator.mode_number", design->resonator.mode_number, 2.0,
                             "2 for a hemisphere; for another shape state the angular gain");
    const double drawn =
        6.0 * (design->anisotropy.damping_repeatability + design->anisotropy.damping_instability);
    if (!(drawn < damping))
        return imki_conflict(error, "anisotropy.damping_repeatability", drawn, damping,
                             "a sum with the instability below a sixth of 2/tau, so that damping "
                             "is positive in every run");
    if (!(design->anisotropy.damping_difference < damping))
        return imki_conflict(
            error, "anisotropy.damping_difference", design->anisotropy.damping_difference, damping,
            "a value below 2/tau = 2 pi f/Q, so that damping is positive in every direction");
    if (!(design->anisotropy.frequency_split <= 0.01 * design->resonator.frequency))
        return imki_conflict(
            error, "anisotropy.frequency_split", design->anisotropy.frequency_split,
            0.01 * design->resonator.frequency,
            "at most a hundredth of the frequency: beyond it these are two resonators");
    const double hidden = design->mode == IMK_SHELL_FREE ? 0.0 : smallest_pattern(design);
    if (!(design->pattern.amplitude >= hidden))
        return imki_conflict(
            error, "pattern.amplitude", design->pattern.amplitude, hidden,
            "at least ten times the thermal motion and the pickoff's noise: else the "
            "loops see no pattern");
    return check_loops(design, error);
}

/* ---- interface ------------------------------------------------------------------------------- */

static const imk_signal outputs[] = {
    {"rate", "rad/s", "deg/s", "measured rate"},
    {"pattern_angle", "rad", "deg", "measured angle of the pattern on the shell"},
};

enum {
    X,
    Y,
    AMPLITUDE,
    QUADRATURE,
    MODAL_ANGLE,
    PHASE_ERROR,
    DRIVE_FORCE,
    REBALANCE_FORCE,
    QUADRATURE_FORCE,
    REFERENCE,
    SIGNALS
};

static const imk_signal signals[SIGNALS] = {
    [X] = {"x", "m", "um", "displacement of mode x"},
    [Y] = {"y", "m", "um", "displacement of mode y"},
    [AMPLITUDE] = {"amplitude", "m", "um", "half the long axis of the ellipse"},
    [QUADRATURE] = {"quadrature", "m", "nm", "half the short axis of the ellipse"},
    [MODAL_ANGLE] = {"modal_angle", "rad", "deg", "angle of the long axis in the x-y plane"},
    [PHASE_ERROR] = {"phase_error", "rad", "mrad", "of the reference, as measured"},
    [DRIVE_FORCE] = {"drive_force", "N", "nN", "amplitude of the force that keeps the amplitude"},
    [REBALANCE_FORCE] = {"rebalance_force", "N", "nN",
                         "amplitude of the force that holds the pattern"},
    [QUADRATURE_FORCE] = {"quadrature_force", "N", "nN",
                          "amplitude of the force against the quadrature"},
    [REFERENCE] = {"reference_frequency", "Hz", "Hz", "of the phase loop"},
};

static const imk_view views[] = {
    {.title = "Motion of the two modes",
     .caption = "Path of a point of the rim in the two modes. A standing wave is a straight line "
                "at the angle of the pattern, and quadrature opens it to an ellipse.",
     .x = X,
     .curve_count = 1,
     .y = {Y},
     .duration = 1e-3,
     .rate = 400e3,
     .settle = 0.05},
    {.title = "Angle of the pattern",
     .caption = "Where the long axis of the ellipse points. A free or whole-angle "
                "pattern lags behind the turning case; a held one stays.",
     .x = -1,
     .curve_count = 1,
     .y = {MODAL_ANGLE},
     .duration = 2.0,
     .rate = 100.0,
     .input = 10.0 * IMKI_DEGREE},
    {.title = "Forces of the loops",
     .caption = "Forces that keep the amplitude, hold the pattern and cancel the quadrature. The "
                "force that holds the pattern is the reading of a force-to-rebalance gyro.",
     .x = -1,
     .curve_count = 3,
     .y = {DRIVE_FORCE, REBALANCE_FORCE, QUADRATURE_FORCE},
     .duration = 0.5,
     .rate = 1000.0,
     .input = 50.0 * IMKI_DEGREE},
    {.title = "Quadrature",
     .caption = "The short axis of the ellipse, which the quadrature loop keeps near zero.",
     .x = -1,
     .curve_count = 1,
     .y = {QUADRATURE},
     .duration = 0.5,
     .rate = 1000.0},
};

IMKI_DESIGN_FUNCTIONS(shell_gyro);

const imk_instrument imk_shell_gyro_instrument = {
    IMKI_DESCRIBED(shell_gyro),
    .title = "vibrating shell gyro",
    .technology = "Coriolis",
    .source = "Silicon Sensing CRG20 data sheet DCR620000255 (ring, closed loop, 55 Hz, cross axis "
              "2 %); resonator and noise chosen, see shell_gyro.h",
    .sensor = IMK_GYRO,
    .cookie = IMKI_SHELL_COOKIE,
    .state_size = sizeof(imki_shell_state),
    .init = imki_shell_init,
    .step = imki_shell_step,
    .observe = imki_shell_observe,
    .step_length = imki_shell_step_length,
};

/* ---- starting and stepping ------------------------------------------------------------------- */

static imk_status divide(const imk_shell_gyro *design, const imk_physics_settings *settings,
                         size_t *count, double *step, imk_error *error)
{
    const double longest = 1.0 / (IMKI_SHELL_POINTS * design->resonator.frequency);
    if (settings->level == IMK_LEVEL_FULL)
        return imki_divide_sample(settings, longest, longest * (1.0 + 1e-9),
                                  "at least 16 steps to a cycle of the vibration", count, step,
                                  error);
    return imki_divide_sample(settings, 1.0 / settings->rate, (double)INFINITY, "", count, step,
                              error);
}

static imk_status check_level(const imk_shell_gyro *design, const imk_physics_settings *settings,
                              imk_error *error)
{
    const double fastest = 1.0 / imki_shell_update(design);
    if (settings->level == IMK_LEVEL_FULL)
        return IMK_OK;
    if (design->mode == IMK_SHELL_FREE)
        return imki_refuse(error, IMK_ERROR_UNSUPPORTED, "level", (double)settings->level, 0.0,
                           "choose the full level: a free pattern has no slow form");
    if (design->mode == IMK_SHELL_WHOLE_ANGLE && !(settings->rate <= fastest))
        return imki_refuse(error, IMK_ERROR_RANGE, "rate", settings->rate, fastest,
                           "at most one sample per update of the loops");
    return IMK_OK;
}

imk_status imki_shell_init(const void *design_pointer, const imk_physics_settings *settings,
                           void *state_pointer, imk_error *error)
{
    const imk_shell_gyro *design = design_pointer;
    imki_shell_state *state = state_pointer;
    size_t count;
    double step;
    imk_status status = check_level(design, settings, error);
    if (status == IMK_OK)
        status = divide(design, settings, &count, &step, error);
    if (status != IMK_OK)
        return status;
    state->design = *design;
    state->level = settings->level;
    state->sample = 1.0 / settings->rate;
    state->gain = imk_shell_gyro_modal_gain(design);
    state->assumed = imki_shell_assumed_gain(design);
    state->count = count;
    state->pickoff_axes = imki_shell_pickoff(design);
    state->limit = imki_shell_command_limit(design);
    state->lag_cosine = imk_cos(design->control.phase_error);
    state->lag_sine = imk_sin(design->control.phase_error);
    state->decay = 1.0 / imk_shell_gyro_decay_time(design);
    state->omega = 2.0 * IMKI_PI * design->resonator.frequency;
    imki_draws_start(&state->thermal, settings, IMKI_SHELL_THERMAL);
    imki_draws_start(&state->pickoff, settings, IMKI_SHELL_PICKOFF);
    for (int i = 0; i < 2; i++)
        imki_wander_start(&state->wander[i], settings, (uint8_t)(IMKI_SHELL_DAMPING_COSINE + i),
                          design->anisotropy.damping_repeatability,
                          design->anisotropy.damping_instability);
    state->cycle.step = step;
    state->slow.count = count;
    if (settings->level == IMK_LEVEL_FULL)
        imki_shell_cycle_start(state);
    else
        imki_shell_slow_start(state);
    return IMK_OK;
}

void imki_shell_step(void *state_pointer, const imk_exposure *exposure, double *values)
{
    imki_shell_state *state = state_pointer;
    if (state->level == IMK_LEVEL_FULL)
        imki_shell_cycle_step(state, exposure, values);
    else
        imki_shell_slow_step(state, exposure, values);
}

/* The signals of a slow run are those of a pattern without quadrature at the end of a cycle. */
static void observe_slow(const imki_shell_state *state, double *values)
{
    const bool held = state->design.mode == IMK_SHELL_REBALANCE;
    const double angle = held ? state->design.pattern.angle : state->slow.angle;
    const imki_shell_balance balance =
        imki_shell_balance_at(&state->design, state->slow.temperature, 0.0, angle);
    values[AMPLITUDE] = balance.amplitude;
    values[MODAL_ANGLE] = held ? balance.actual : angle;
    values[X] = values[AMPLITUDE] * imk_cos(values[MODAL_ANGLE]);
    values[Y] = values[AMPLITUDE] * imk_sin(values[MODAL_ANGLE]);
    values[QUADRATURE] = values[PHASE_ERROR] = 0.0;
    values[DRIVE_FORCE] = balance.drive;
    values[REBALANCE_FORCE] = held ? state->slow.reading * state->assumed : 0.0;
    values[QUADRATURE_FORCE] = balance.quadrature;
    values[REFERENCE] = balance.frequency / (2.0 * IMKI_PI);
}

static void observe_full(const imki_shell_state *state, double *values)
{
    const double *z = state->cycle.z;
    const imki_shell_ellipse ellipse =
        imki_shell_ellipse_of((imki_shell_pair){z[0], z[2]}, (imki_shell_pair){z[1], z[3]});
    values[X] = z[0];
    values[Y] = z[2];
    values[AMPLITUDE] = ellipse.amplitude;
    values[QUADRATURE] = ellipse.quadrature;
    /* of the directions that an axis has, the one near the measured angle */
    values[MODAL_ANGLE] =
        ellipse.angle + IMKI_PI * floor((state->loops.angle - ellipse.angle) / IMKI_PI + 0.5);
    values[PHASE_ERROR] = state->loops.phase_error;
    values[DRIVE_FORCE] = state->loops.command[0];
    values[REBALANCE_FORCE] = state->loops.command[1];
    values[QUADRATURE_FORCE] = state->loops.command[2];
    values[REFERENCE] = state->loops.reference / (2.0 * IMKI_PI);
}

void imki_shell_observe(const void *state_pointer, double *values)
{
    const imki_shell_state *state = state_pointer;
    const double unit = 2.0 * state->design.resonator.mass * state->omega *
                        state->design.pattern.amplitude; /* force of a rate */
    if (state->level == IMK_LEVEL_FULL)
        observe_full(state, values);
    else
        observe_slow(state, values);
    for (int i = DRIVE_FORCE; i <= QUADRATURE_FORCE; i++)
        values[i] *= unit;
}

double imki_shell_step_length(const void *design, const imk_physics_settings *settings)
{
    size_t count = 1;
    double step = 1.0 / settings->rate;
    imk_physics_settings automatic = *settings;
    automatic.step = 0.0;
    if (divide(design, &automatic, &count, &step, NULL) != IMK_OK)
        return 1.0 / settings->rate;
    return step;
}
