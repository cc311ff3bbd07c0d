/* SPDX-License-Identifier: Apache-2.0 */
/* The free gyro as an instrument: design, start, readings, signals. Motion: free_gyro_dynamics.c
 * and free_gyro_slow.c; closed forms: free_gyro_reduce.c. */
#include "free_gyro_internal.h"

#include "base/algebra/vector_internal.h"
#include "physics/design_rows_internal.h"

#include <math.h>

enum { COOKIE = 0x46524759 };

imk_free_gyro imk_free_gyro_default(void)
{
    return (imk_free_gyro){
        .cookie = COOKIE,
        .spin_rate = 22550.0 * IMKI_PI / 30.0,
        .rotor_polar = 4.2e-5,
        .rotor_transverse = 2.6e-5,
        .inner_inertia = {1.5e-5, 1.2e-5, 1.5e-5},
        .outer_inertia = {2e-5, 4e-5, 3e-5},
        .mass = 0.25,
        .unbalance = {0.1e-6, 0.1e-6, 0.2e-6},
        .compliance = {1e-8, 1e-8, 1.6e-8},
        .viscous_friction = 2e-6,
        .coulomb_friction = 2e-6,
        .friction_rate = 0.5 * IMKI_DEGREE,
        .stop = 85.0 * IMKI_DEGREE,
        .torque_temperature = 5e-8,
        .torque_repeatability = 5e-6,
        .torque_instability = 5e-7,
        .torque_noise = 3e-7,
        .pickoff_resolution = 20.0 * IMKI_DEGREE / 3600.0,
        .pickoff_noise = 12.0 * IMKI_DEGREE / 3600.0,
        .start_nutation = 15.0 * IMKI_DEGREE / 3600.0,
    };
}

#define INERTIA(path, member, help) NUMBER(path, member, "kg*m^2", 0.0, 10.0, help)

#define DESIGN imk_free_gyro
static const imk_design_field fields[] = {
    NUMBER("spin.rate", spin_rate, "rpm", 1.0, 1e6, "nominal speed of the wheel"),
    NUMBER("spin.error", spin_error, "1", -0.9, 9.0, "relative error of that speed"),
    NUMBER("rotor.polar_inertia", rotor_polar, "kg*m^2", 1e-12, 10.0,
           "inertia of the wheel about its axis"),
    NUMBER("rotor.transverse_inertia", rotor_transverse, "kg*m^2", 1e-12, 10.0,
           "inertia of the wheel across its axis"),
    INERTIA("inner_gimbal.inertia_x", inner_inertia[0], "inertia of the inner gimbal about its x"),
    INERTIA("inner_gimbal.inertia_y", inner_inertia[1], "the same about y, its bearing axis"),
    INERTIA("inner_gimbal.inertia_z", inner_inertia[2], "the same about z, the spin axis"),
    INERTIA("outer_gimbal.inertia_x", outer_inertia[0],
            "inertia of the outer gimbal about x, its bearing axis"),
    INERTIA("outer_gimbal.inertia_y", outer_inertia[1],
            "the same about y, the inner gimbal's bearing axis"),
    INERTIA("outer_gimbal.inertia_z", outer_inertia[2], "the same about z"),
    NUMBER("suspended.mass", mass, "kg", 0.0, 1e4, "mass of wheel and inner gimbal"),
    NUMBER("unbalance.x", unbalance[0], "um", -1.0, 1.0,
           "centre of that mass along the inner gimbal's x"),
    NUMBER("unbalance.y", unbalance[1], "um", -1.0, 1.0, "the same along y"),
    NUMBER("unbalance.z", unbalance[2], "um", -1.0, 1.0, "the same along the spin axis"),
    NUMBER("compliance.x", compliance[0], "nm/N", 0.0, 1e-4,
           "yielding of the suspension along the inner gimbal's x"),
    NUMBER("compliance.y", compliance[1], "nm/N", 0.0, 1e-4, "the same along y"),
    NUMBER("compliance.z", compliance[2], "nm/N", 0.0, 1e-4, "the same along the spin axis"),
    NUMBER("friction.viscous", viscous_friction, "N*m*s/rad", 0.0, 1.0,
           "viscous friction of each gimbal's bearings"),
    NUMBER("friction.coulomb", coulomb_friction, "N*m", 0.0, 1e-2,
           "dry friction of each gimbal's bearings"),
    NUMBER("friction.rate", friction_rate, "deg/s", 1e-9, 1e6,
           "relative rate over which the dry friction turns over"),
    ABOVE("gimbal.stop", stop, "deg", 0.0, 89.0 * IMKI_DEGREE,
          "travel of the inner gimbal either way, at most 89 deg"),
    NUMBER("torque.inner", torque_inner, "N*m", -1e-2, 1e-2,
           "constant error torque about the inner axis"),
    NUMBER("torque.outer", torque_outer, "N*m", -1e-2, 1e-2, "the same about the outer axis"),
    NUMBER("torque.temperature", torque_temperature, "N*m/K", -1e-4, 1e-4,
           "change of both with temperature, from 20 degC"),
    NUMBER("torque.repeatability", torque_repeatability, "N*m", 0.0, 1e-2,
           "1 sigma per run of the error torque about each axis"),
    NUMBER("torque.instability", torque_instability, "N*m", 0.0, 1e-2,
           "flicker (bias instability B) of those torques"),
    NUMBER("torque.noise", torque_noise, "N*m/sqrt(Hz)", 0.0, 1e-2,
           "white part of those torques, two-sided density"),
    NUMBER("pickoff.resolution", pickoff_resolution, "arcsec", 0.0, 1.0,
           "step of the readings, 0 for none"),
    NUMBER("pickoff.noise", pickoff_noise, "arcsec", 0.0, 1.0, "1 sigma of a reading"),
    NUMBER("pickoff.scale_error", pickoff_scale_error, "ppm", -0.5, 0.5,
           "relative error of the readings"),
    NUMBER("start.outer", start_outer, "deg", -1e3, 1e3, "outer angle at the start"),
    NUMBER("start.inner", start_inner, "deg", -89.0 * IMKI_DEGREE, 89.0 * IMKI_DEGREE,
           "inner angle at the start"),
    NUMBER("start.nutation", start_nutation, "arcsec", 0.0, 89.0 * IMKI_DEGREE,
           "amplitude of the nutation at the start, of the inner angle"),
};

static const imk_signal outputs[] = {
    {"rate", "rad/s", "deg/s", "rate about case x: minus the outer pick-off's difference"},
    {"rate_inner", "rad/s", "deg/s", "rate about the inner axis: minus its pick-off's difference"},
    {"outer_reading", "rad", "deg", "reading of the outer pick-off"},
    {"inner_reading", "rad", "deg", "reading of the inner pick-off"},
};

enum { OUTER, INNER, NUTATION, OUTER_TORQUE, INNER_TORQUE, STOP };
static const imk_signal signals[] = {
    [OUTER] = {"outer_angle", "rad", "deg", "angle of the outer gimbal"},
    [INNER] = {"inner_angle", "rad", "deg", "angle of the inner gimbal"},
    [NUTATION] = {"nutation", "rad", "deg",
                  "amplitude of the nutation, of the inner angle (slow forced motion included)"},
    [OUTER_TORQUE] = {"outer_torque", "N*m", "nN*m", "error torque about the outer axis"},
    [INNER_TORQUE] = {"inner_torque", "N*m", "nN*m", "error torque about the inner axis"},
    [STOP] = {"stop", "1", "1", "1 while the inner gimbal touches its stop"},
};

static const imk_view views[] = {
    {.title = "Path of the spin axis",
     .caption = "Inner against outer angle while the case turns slowly: the circles are the "
                "nutation, and their centre follows the case",
     .x = OUTER,
     .curve_count = 1,
     .y = {INNER},
     .duration = 0.04,
     .rate = 10000.0,
     .input = 0.5 * IMKI_DEGREE},
    {.title = "The gimbals stay behind",
     .caption = "Angles of both gimbals at rest: the drift by friction, unbalance and error "
                "torques, which takes minutes to show",
     .x = -1,
     .curve_count = 2,
     .y = {OUTER, INNER},
     .duration = 60.0,
     .rate = 2000.0},
    {.title = "Nutation dies away",
     .caption = "Amplitude of the nutation. Friction of the bearings reduces it: dry friction by "
                "equal steps, viscous friction by equal fractions",
     .x = -1,
     .curve_count = 1,
     .y = {NUTATION},
     .duration = 5.0,
     .rate = 200.0},
};

/* ---- validation ------------------------------------------------------------------------------ */

/* No inertia of a body exceeds the sum of the other two. */
static imk_status check_inertia(const double inertia[3], const char *const names[3],
                                imk_error *error)
{
    for (int i = 0; i < 3; i++) {
        const double others = inertia[(i + 1) % 3] + inertia[(i + 2) % 3];
        if (!(inertia[i] <= others * (1.0 + 1e-12)))
            return imki_conflict(error, names[i], inertia[i], others,
                                 "at most the sum of the inertias about the other two axes");
    }
    return IMK_OK;
}

static imk_status check_bodies(const imk_free_gyro *design, imk_error *error)
{
    static const char *const inner[] = {"inner_gimbal.inertia_x", "inner_gimbal.inertia_y",
                                        "inner_gimbal.inertia_z"};
    static const char *const outer[] = {"outer_gimbal.inertia_x", "outer_gimbal.inertia_y",
                                        "outer_gimbal.inertia_z"};
    const double thinnest = 2.0 * design->rotor_transverse * (1.0 + 1e-12);
    const imk_status status = check_inertia(design->inner_inertia, inner, error);
    if (!(design->rotor_polar <= thinnest))
        return imki_conflict(error, "rotor.polar_inertia", design->rotor_polar, thinnest,
                             "at most twice the transverse inertia, which a thin disc has");
    return status == IMK_OK ? check_inertia(design->outer_inertia, outer, error) : status;
}

static imk_status check(const void *given, imk_error *error)
{
    const imk_free_gyro *design = given;
    imk_status status = check_bodies(design, error);
    if (status != IMK_OK)
        return status;
    const double swing = fabs(design->start_inner) + design->start_nutation;
    if (!(swing < design->stop))
        return imki_conflict(error, "start.inner", swing, design->stop,
                             "keep inner angle and nutation together below gimbal.stop");
    /* cos x >= 1 - 2 x/pi in a quarter turn: no function is needed for a bound */
    const double momentum = imk_free_gyro_momentum(design) * (1.0 - 2.0 / IMKI_PI * design->stop);
    const imki_free_gyro_parts parts = imki_free_gyro_parts_of(design);
    if (!(parts.slope <= 0.5 * momentum))
        return imki_conflict(error, "friction.coulomb", parts.slope, 0.5 * momentum,
                             "a friction per relative rate (viscous, plus coulomb over "
                             "friction.rate) below half the momentum of the wheel at the stop");
    /* weight of 10 m/s^2: the steady precession is real while 4 (A - C) M < H^2 */
    const double *m = parts.moment;
    const double weight = 10.0 * imki_norm3(m);
    const double most = parts.h * parts.h / (4.0 * (parts.j_least + fabs(parts.a_c) + parts.b));
    if (!(weight < most))
        return imki_conflict(
            error, "unbalance.z", weight, most,
            "a weight times its arm below H^2/4(A + Ao + B), which the wheel can carry");
    return IMK_OK;
}

/* ---- start ----------------------------------------------------------------------------------- */

/* Stages to a cycle of the nutation at inner angle 0, where it is fastest, and the decay by
 * friction in a step, which its impulses follow to second order. */
#define STEPS_PER_CYCLE 10.0
#define FEWEST_STEPS_PER_CYCLE 6.0
#define FRICTION_PER_STEP 0.05
#define MOST_FRICTION_PER_STEP 0.2
/* The slow level's error grows with the turn of the case within a step: 10 ms for a vehicle. */
#define SLOW_STEP 0.01
#define LONGEST_SLOW_STEP 0.1

static double step_within(const imk_free_gyro *design, imk_level level, bool limit)
{
    if (level == IMK_LEVEL_SLOW)
        return limit ? LONGEST_SLOW_STEP : SLOW_STEP;
    const imki_free_gyro_parts parts = imki_free_gyro_parts_of(design);
    const double cycle = 1.0 / imk_free_gyro_nutation(design, 0.0);
    const double least = parts.j_least + (parts.a_c < 0.0 ? parts.a_c : 0.0);
    const double inertia = least < parts.b ? least : parts.b;
    const double by_cycle = cycle / (limit ? FEWEST_STEPS_PER_CYCLE : STEPS_PER_CYCLE);
    const double decay = limit ? MOST_FRICTION_PER_STEP : FRICTION_PER_STEP;
    const double by_friction =
        parts.slope * by_cycle > decay * inertia ? decay * inertia / parts.slope : by_cycle;
    return by_friction < by_cycle ? by_friction : by_cycle;
}

static double step_length(const void *design, const imk_physics_settings *settings)
{
    const double longest = step_within(design, settings->level, false);
    const double sample = 1.0 / settings->rate;
    return sample < longest ? sample : longest;
}

static void read_angles(imki_free_gyro_state *state, double reading[2])
{
    const double angle[2] = {state->gimbals.outer, state->gimbals.inner};
    for (int k = 0; k < 2; k++) {
        const double noise =
            state->reading_noise > 0.0 ? state->reading_noise * imki_draw(&state->pickoff[k]) : 0.0;
        reading[k] = imki_quantised(angle[k] * state->scale + noise, state->resolution);
    }
}

static void start_random(const imk_free_gyro *design, const imk_physics_settings *settings,
                         imki_free_gyro_state *state)
{
    imki_draws_start(&state->white[0], settings, IMKI_FREE_GYRO_TORQUE_OUTER);
    imki_draws_start(&state->white[1], settings, IMKI_FREE_GYRO_TORQUE_INNER);
    imki_draws_start(&state->pickoff[0], settings, IMKI_FREE_GYRO_PICKOFF_OUTER);
    imki_draws_start(&state->pickoff[1], settings, IMKI_FREE_GYRO_PICKOFF_INNER);
    state->torque_sigma = settings->noise ? design->torque_noise / sqrt(state->step) : 0.0;
    state->reading_noise = settings->noise ? design->pickoff_noise : 0.0;
    imki_wander_start(&state->error[0], settings, IMKI_FREE_GYRO_ERROR_OUTER,
                      design->torque_repeatability, design->torque_instability);
    imki_wander_start(&state->error[1], settings, IMKI_FREE_GYRO_ERROR_INNER,
                      design->torque_repeatability, design->torque_instability);
}

/* The steps of a run in which the case turns fast, where that is known. */
static imk_status check_turning(const imk_physics_settings *settings, double step, imk_error *error)
{
    const double longest = IMKI_FREE_GYRO_TURN / settings->turning;
    imk_physics_settings turning = *settings;
    size_t steps;
    turning.step = 0.0;
    return settings->level == IMK_LEVEL_FULL && longest < step
               ? imki_divide_sample(&turning, longest, (double)INFINITY,
                                    "at most 0.1 rad of the case's turn to a step", &steps, &step,
                                    error)
               : IMK_OK;
}

static imk_status init(const void *given, const imk_physics_settings *settings, void *memory,
                       imk_error *error)
{
    const imk_free_gyro *design = given;
    imki_free_gyro_state *state = memory;
    size_t steps = 0;
    double step = 0.0;
    imk_status status = imki_divide_sample(
        settings, step_within(design, settings->level, false),
        step_within(design, settings->level, true),
        settings->level == IMK_LEVEL_FULL ? "at least 6 steps to a cycle of the nutation, and 5 to "
                                            "its decay by friction"
                                          : "at most 0.1 s: the case turns between steps",
        &steps, &step, error);
    if (status == IMK_OK)
        status = check_turning(settings, step, error);
    if (status != IMK_OK)
        return status;
    *state = (imki_free_gyro_state){
        .gimbals = {.outer = design->start_outer, .inner = design->start_inner},
        .parts = imki_free_gyro_parts_of(design),
        .sample = 1.0 / settings->rate,
        .step = step,
        .steps = steps,
        .level = settings->level,
        .caged = true,
        .start_nutation = design->start_nutation,
        .torque = {design->torque_outer, design->torque_inner},
        .torque_temperature = design->torque_temperature,
        .scale = 1.0 + design->pickoff_scale_error,
        .resolution = design->pickoff_resolution,
    };
    imki_free_gyro_trigonometry(&state->gimbals);
    start_random(design, settings, state);
    read_angles(state, state->reading);
    return IMK_OK;
}

/* ---- run ------------------------------------------------------------------------------------- */

static void step(void *memory, const imk_exposure *exposure, double *out)
{
    imki_free_gyro_state *state = memory;
    const double thermal =
        state->torque_temperature * (exposure->temperature - IMKI_DESIGN_TEMPERATURE);
    imki_free_gyro_drive drive;
    double reading[2];
    for (int k = 0; k < 3; k++) {
        drive.rate[k] = exposure->angular_rate[k];
        drive.acceleration[k] = exposure->angular_acceleration[k];
        drive.force[k] = exposure->specific_force[k];
    }
    drive.outer = state->torque[0] + thermal + imki_wander_next(&state->error[0]);
    drive.inner = state->torque[1] + thermal + imki_wander_next(&state->error[1]);
    if (state->level == IMK_LEVEL_FULL) {
        if (state->caged)
            imki_free_gyro_uncage(state, &drive);
        imki_free_gyro_full(state, &drive);
    } else {
        imki_free_gyro_slow(state, &drive);
    }
    read_angles(state, reading);
    for (int k = 0; k < 2; k++) {
        out[k] = (state->reading[k] - reading[k]) / state->sample;
        out[2 + k] = state->reading[k] = reading[k];
    }
}

/* Of a small nutation, the inner rate in inertial space v and the outer one p (less the slow ones)
 * give the amplitude:  a^2 = (v/n)^2 + (J p/(H c))^2,  n the nutation's angular frequency. */
static double nutation_of(const imki_free_gyro_state *state)
{
    const imki_gimbals *g = &state->gimbals;
    const imki_free_gyro_parts *parts = &state->parts;
    if (state->level != IMK_LEVEL_FULL || state->caged)
        return state->caged && state->level == IMK_LEVEL_FULL ? state->start_nutation : 0.0;
    const double j = parts->j_least + parts->a_c * g->ci * g->ci, h = parts->h * g->ci;
    const double p = g->p_outer - parts->h * g->si + state->last_torque[1] * j / h;
    const double v = g->p_inner - state->last_torque[0] * parts->b / h;
    return sqrt(v * v * j * parts->per_b + p * p) / h;
}

static void observe(const void *memory, double *values)
{
    const imki_free_gyro_state *state = memory;
    values[OUTER] = state->gimbals.outer;
    values[INNER] = state->gimbals.inner;
    values[NUTATION] = nutation_of(state);
    values[OUTER_TORQUE] = state->last_torque[0];
    values[INNER_TORQUE] = state->last_torque[1];
    values[STOP] = state->on_stop ? 1.0 : 0.0;
}

IMKI_DESIGN_FUNCTIONS(free_gyro);

const imk_instrument imk_free_gyro_instrument = {
    IMKI_DESCRIBED(free_gyro),
    .title = "free gyro",
    .technology = "wheel",
    .source = "wheel speed and travel of an electric attitude gyro (training notes, "
              "flyingpilots.com p=264); inertias, friction and torques chosen: free_gyro.h",
    .sensor = IMK_GYRO,
    .cookie = COOKIE,
    .state_size = sizeof(imki_free_gyro_state),
    .init = init,
    .step = step,
    .observe = observe,
    .step_length = step_length,
};
