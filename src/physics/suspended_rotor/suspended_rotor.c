/* SPDX-License-Identifier: Apache-2.0 */
/* The electrostatically suspended gyro as an instrument. Closed forms: suspended_rotor_reduce.c.
 *
 * In inertial space the angular momentum H s turns with the torques, dH s/dt = M, and the axis of
 * figure goes round it at H/A on a cone whose angle dies away: exactly, as a free symmetric body
 * does. Torques are slow against that (the cone that a constant torque makes has the angle
 * M A/H^2, 1e-12 rad), so the axis of figure is carried along with s, and what depends on it
 * is averaged over its turns: harmonic n of the shape is weakened by P_n(cos cone).
 *
 * A step is half of the torque's turn, the turn of the case, the other half. s and the direction n
 * across it, from which the phase of the cone counts, are kept in case axes; every turn is a
 * rotation of both, so nothing but rounding changes |s| = 1. */
#include "base/algebra/vector_internal.h"
#include "imukit/elementary.h"
#include "physics/design_rows_internal.h"
#include "suspended_rotor_internal.h"

#include <math.h>

enum { COOKIE = 0x53524F54 };

#define ARCSECOND (IMKI_DEGREE / 3600.0)
#define STANDARD_GRAVITY 9.80665

typedef struct suspended_rotor_state {
    double axis[3], across[3]; /* s, n */
    double cone, decay;        /* angle of the cone [rad], and its factor per step */
    double turns, turns_per_step;
    imki_suspended_ball ball;
    double sample, step;
    size_t steps;
    imk_level level;
    bool fallen;
    double torque[3], torque_temperature, torque_sigma;
    double resolution, reading_noise;
    double reading[3];
    double drift; /* magnitude of ds/dt by unbalance and shape, at the last step */
    imki_wander error[3];
    imki_draws white[3], readout[3];
} suspended_rotor_state;

imk_suspended_rotor imk_suspended_rotor_default(void)
{
    return (imk_suspended_rotor){
        .cookie = COOKIE,
        .spin_rate = 150000.0 * (IMKI_PI / 30.0),
        .diameter = 0.01,
        .density = 1848.0,
        .inertia_difference = 0.02,
        .unbalance = 1e-9,
        .oblateness = -20e-9,
        .pear = 0.3e-9,
        .limit = 25.0 * STANDARD_GRAVITY,
        .preload_error = {1e-3, -1e-3, 0.0},
        .torque_temperature = 2e-14,
        .torque_repeatability = 1.5e-12,
        .torque_instability = 3.7e-13,
        .torque_noise = 1.3e-11,
        .readout_resolution = ARCSECOND,
        .readout_noise = 2.0 * ARCSECOND,
        .wobble_time = 600.0,
    };
}

#define DESIGN imk_suspended_rotor
static const imk_design_field fields[] = {
    ABOVE("spin.rate", spin_rate, "rpm", 0.0, 1e6, "speed of the ball"),
    ABOVE("ball.diameter", diameter, "mm", 0.0, 1.0, "diameter of the ball"),
    NUMBER("ball.hollow", hollow, "mm", 0.0, 1.0, "diameter of its hollow, 0 for solid"),
    ABOVE("ball.density", density, "kg/m^3", 0.0, 1e5, "density of its metal"),
    ABOVE("ball.inertia_difference", inertia_difference, "1", 0.0, 1.0,
          "polar less transverse inertia over transverse, above 0"),
    NUMBER("ball.unbalance", unbalance, "nm", -1e-3, 1e-3,
           "centre of mass from the centre, along the spin"),
    NUMBER("ball.oblateness", oblateness, "nm", -1e-3, 1e-3,
           "height of the second harmonic of the spinning shape"),
    NUMBER("ball.pear", pear, "nm", -1e-3, 1e-3, "height of the third harmonic"),
    ABOVE("suspension.limit", limit, "g", 0.0, 1e6,
          "specific force the suspension carries along each axis"),
    NUMBER("suspension.preload_error_x", preload_error[0], "1", -0.9, 9.0,
           "relative error of the preload of the electrodes along x"),
    NUMBER("suspension.preload_error_y", preload_error[1], "1", -0.9, 9.0, "the same along y"),
    NUMBER("suspension.preload_error_z", preload_error[2], "1", -0.9, 9.0, "the same along z"),
    NUMBER("torque.x", torque[0], "N*m", -1.0, 1.0, "constant error torque about case x"),
    NUMBER("torque.y", torque[1], "N*m", -1.0, 1.0, "the same about y"),
    NUMBER("torque.z", torque[2], "N*m", -1.0, 1.0, "the same about z"),
    NUMBER("torque.temperature", torque_temperature, "N*m/K", -1.0, 1.0,
           "change of each component with temperature, from 20 degC"),
    NUMBER("torque.repeatability", torque_repeatability, "N*m", 0.0, 1.0,
           "1 sigma per run of each component of the error torque"),
    NUMBER("torque.instability", torque_instability, "N*m", 0.0, 1.0,
           "flicker (bias instability B) of each component"),
    NUMBER("torque.noise", torque_noise, "N*m/sqrt(Hz)", 0.0, 1.0,
           "white part of each component, two-sided density"),
    NUMBER("readout.resolution", readout_resolution, "arcsec", 0.0, 0.1,
           "step of the direction cosines, 0 for none"),
    NUMBER("readout.noise", readout_noise, "arcsec", 0.0, 0.1, "1 sigma of each direction cosine"),
    NUMBER("start.tilt", start_tilt, "deg", 0.0, IMKI_PI,
           "angle of the spin axis from case z at the start"),
    NUMBER("start.azimuth", start_azimuth, "deg", -2.0 * IMKI_PI, 2.0 * IMKI_PI,
           "direction of that tilt, from x towards y"),
    NUMBER("wobble.start", start_wobble, "arcsec", 0.0, 0.5,
           "angle of the axis of figure from the angular momentum at the start"),
    ABOVE("wobble.time", wobble_time, "s", 0.0, 1e9, "time in which it falls by e"),
};

static const imk_signal outputs[] = {
    {"rate", "rad/s", "deg/s", "rate about case x, less the part along the spin axis"},
    {"rate_y", "rad/s", "deg/s", "rate about case y, less the part along the spin axis"},
    {"cosine_x", "1", "1", "reading: direction cosine of the spin axis along x"},
    {"cosine_y", "1", "1", "the same along y"},
    {"cosine_z", "1", "1", "the same along z"},
};

enum { AXIS_X, AXIS_Y, AXIS_Z, DRIFT, WOBBLE, FALLEN };
static const imk_signal signals[] = {
    [AXIS_X] = {"axis_x", "1", "1", "direction cosine of the angular momentum along x"},
    [AXIS_Y] = {"axis_y", "1", "1", "the same along y"},
    [AXIS_Z] = {"axis_z", "1", "1", "the same along z"},
    [DRIFT] = {"drift", "rad/s", "deg/h", "rate at which the axis drifts by unbalance and shape"},
    [WOBBLE] = {"wobble", "rad", "arcsec", "angle of the axis of figure from it"},
    [FALLEN] = {"fallen", "1", "1", "1 when the force was too much and the ball has touched"},
};

static const imk_view views[] = {
    {.title = "The axis stays, the case turns",
     .caption = "Direction cosines of the spin axis in the case, which turns once",
     .x = -1,
     .curve_count = 3,
     .y = {AXIS_Y, AXIS_Z, AXIS_X},
     .duration = 36.0,
     .rate = 20.0,
     .input = 10.0 * IMKI_DEGREE},
    {.title = "Drift by the shape of the ball",
     .caption = "Unequal preloads turn an oblate ball: not at all where its axis is along or "
                "across their field, most in between",
     .x = AXIS_Y,
     .curve_count = 1,
     .y = {DRIFT},
     .duration = 36.0,
     .rate = 20.0,
     .input = 10.0 * IMKI_DEGREE},
};

/* ---- validation and start -------------------------------------------------------------------- */

/* Heights of the shape's harmonics beyond this part of the radius are not first-order any more. */
#define LARGEST_HEIGHT 1e-3

static imk_status check(const void *given, imk_error *error)
{
    const imk_suspended_rotor *design = given;
    const double most = LARGEST_HEIGHT * 0.5 * design->diameter;
    const struct {
        const char *field;
        double value;
    } heights[] = {{"ball.unbalance", design->unbalance},
                   {"ball.oblateness", design->oblateness},
                   {"ball.pear", design->pear}};
    if (!(design->hollow < design->diameter))
        return imki_conflict(error, "ball.hollow", design->hollow, design->diameter,
                             "a hollow smaller than ball.diameter");
    for (int i = 0; i < 3; i++)
        if (!(fabs(heights[i].value) <= most))
            return imki_conflict(error, heights[i].field, heights[i].value, most,
                                 "at most a thousandth of the ball's radius");
    return IMK_OK;
}

/* The error of a step goes with the square of the turn of the case within it, times the drift. */
#define LONGEST_STEP 0.01
#define STEP_LIMIT 0.1

static double step_length(const void *design, const imk_physics_settings *settings)
{
    const double sample = 1.0 / settings->rate;
    (void)design;
    return sample < LONGEST_STEP ? sample : LONGEST_STEP;
}

/* The readout sees the axis of figure. */
static void read_axis(suspended_rotor_state *state, double reading[3])
{
    const double *s = state->axis, *n = state->across;
    const double sine = imk_sin(state->cone), cosine = imk_cos(state->cone);
    const double phase = 2.0 * IMKI_PI * state->turns;
    const double first = sine * imk_cos(phase), second = sine * imk_sin(phase);
    for (int k = 0; k < 3; k++) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        const double figure = cosine * s[k] + first * n[k] + second * (s[l] * n[m] - s[m] * n[l]);
        const double noise =
            state->reading_noise > 0.0 ? state->reading_noise * imki_draw(&state->readout[k]) : 0.0;
        reading[k] = imki_quantised(figure + noise, state->resolution);
    }
}

/* A direction across s: the case axis that is farthest from s, less its part along s. */
static void choose_across(const double s[3], double n[3])
{
    const int k = fabs(s[0]) <= fabs(s[1]) && fabs(s[0]) <= fabs(s[2]) ? 0
                  : fabs(s[1]) <= fabs(s[2])                           ? 1
                                                                       : 2;
    const double length = sqrt(1.0 - s[k] * s[k]);
    for (int i = 0; i < 3; i++)
        n[i] = ((i == k ? 1.0 : 0.0) - s[k] * s[i]) / length;
}

static void start_random(const imk_suspended_rotor *design, const imk_physics_settings *settings,
                         suspended_rotor_state *state)
{
    for (int k = 0; k < 3; k++) {
        imki_draws_start(&state->white[k], settings, (uint8_t)(IMKI_SUSPENDED_ROTOR_TORQUE + k));
        imki_draws_start(&state->readout[k], settings, (uint8_t)(IMKI_SUSPENDED_ROTOR_READING + k));
        imki_wander_start(&state->error[k], settings, (uint8_t)(IMKI_SUSPENDED_ROTOR_TORQUE + k),
                          design->torque_repeatability, design->torque_instability);
    }
    state->torque_sigma = settings->noise ? design->torque_noise / sqrt(state->step) : 0.0;
    state->reading_noise = settings->noise ? design->readout_noise : 0.0;
}

static imk_status init(const void *given, const imk_physics_settings *settings, void *memory,
                       imk_error *error)
{
    const imk_suspended_rotor *design = given;
    suspended_rotor_state *state = memory;
    size_t steps = 0;
    double step = 0.0;
    imk_status status =
        imki_divide_sample(settings, LONGEST_STEP, STEP_LIMIT,
                           "at most 0.1 s: the case turns between steps", &steps, &step, error);
    if (status != IMK_OK)
        return status;
    const bool full = settings->level == IMK_LEVEL_FULL;
    *state = (suspended_rotor_state){
        .cone = full ? design->start_wobble : 0.0,
        .decay = imk_exp(-step / design->wobble_time),
        .turns_per_step = imk_suspended_rotor_wobble(design) * step,
        .ball = imki_suspended_ball_of(design),
        .sample = 1.0 / settings->rate,
        .step = step,
        .steps = steps,
        .level = settings->level,
        .torque_temperature = design->torque_temperature,
        .resolution = design->readout_resolution,
    };
    for (int k = 0; k < 3; k++)
        state->torque[k] = design->torque[k];
    imki_suspended_start(design, state->axis);
    choose_across(state->axis, state->across);
    start_random(design, settings, state);
    read_axis(state, state->reading);
    return IMK_OK;
}

/* ---- motion ---------------------------------------------------------------------------------- */

/* v turned by the rotation vector angle n (Rodrigues), given sin and 1 - cos of the angle. */
static void turn(double v[3], const double n[3], double sine, double versed)
{
    const double along = imki_dot3(n, v);
    double next[3];
    for (int k = 0; k < 3; k++) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        next[k] = v[k] + sine * (n[l] * v[m] - n[m] * v[l]) - versed * (v[k] - along * n[k]);
    }
    for (int k = 0; k < 3; k++)
        v[k] = next[k];
}

static void turn_both(suspended_rotor_state *state, const double rotation[3])
{
    const double angle = imki_norm3(rotation);
    double n[3];
    if (!(angle > 0.0))
        return;
    for (int k = 0; k < 3; k++)
        n[k] = rotation[k] / angle;
    const double sine = imk_sin(angle), half = imk_sin(0.5 * angle);
    turn(state->axis, n, sine, 2.0 * half * half);
    turn(state->across, n, sine, 2.0 * half * half);
}

/* ds/dt = (s x grad G + M)/H turns s by the rotation vector s x ds/dt h
 *
 *     s x (s x grad G) + s x M = s (s.g) - g + s x M */
static void turn_by_torque(suspended_rotor_state *state, const double force[3],
                           const double torque[3], double h)
{
    const double x = imk_cos(state->cone), *s = state->axis;
    const double weak[3] = {x, 1.5 * x * x - 0.5, x * (2.5 * x * x - 1.5)};
    double g[3], rotation[3];
    imki_suspended_gradient(&state->ball, weak, s, force, g);
    const double along = imki_dot3(s, g);
    for (int k = 0; k < 3; k++) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        rotation[k] =
            h * state->ball.per_h * (s[k] * along - g[k] + (s[l] * torque[m] - s[m] * torque[l]));
    }
    turn_both(state, rotation);
}

/* Rounding grows as a random walk: bring |s| back to 1 and n across it. */
static void straighten(suspended_rotor_state *state)
{
    double *s = state->axis, *n = state->across;
    const double length = imki_norm3(s);
    double along = 0.0, square = 0.0;
    for (int k = 0; k < 3; k++) {
        s[k] /= length;
        along += s[k] * n[k];
    }
    for (int k = 0; k < 3; k++) {
        n[k] -= along * s[k];
        square += n[k] * n[k];
    }
    for (int k = 0; k < 3; k++)
        n[k] /= sqrt(square);
}

static void advance(suspended_rotor_state *state, const imk_exposure *exposure,
                    const double torque[3])
{
    const double h = state->step;
    for (size_t i = 0; i < state->steps; i++) {
        const double time = ((double)i + 0.5) * h - 0.5 * state->sample;
        double turned[3], acting[3];
        for (int k = 0; k < 3; k++) {
            turned[k] = -h * (exposure->angular_rate[k] + time * exposure->angular_acceleration[k]);
            acting[k] = torque[k];
            if (state->torque_sigma > 0.0)
                acting[k] += state->torque_sigma * imki_draw(&state->white[k]);
        }
        turn_by_torque(state, exposure->specific_force, acting, 0.5 * h);
        turn_both(state, turned);
        turn_by_torque(state, exposure->specific_force, acting, 0.5 * h);
        if (state->level == IMK_LEVEL_FULL) {
            state->cone *= state->decay;
            state->turns += state->turns_per_step;
            state->turns -= floor(state->turns);
        }
    }
    straighten(state);
}

static void find_drift(suspended_rotor_state *state, const double force[3])
{
    static const double whole[3] = {1.0, 1.0, 1.0};
    const double *s = state->axis;
    double g[3], square = 0.0;
    imki_suspended_gradient(&state->ball, whole, s, force, g);
    for (int k = 0; k < 3; k++) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        const double across = s[l] * g[m] - s[m] * g[l];
        square += across * across;
    }
    state->drift = sqrt(square) * state->ball.per_h;
}

/* -(s0 x s1)/|s0 x s1| angle(s0, s1)/dt. The readings need not be of unit length. */
static void rate_of(const double before[3], const double now[3], double dt, double rate[3])
{
    double square = 0.0;
    for (int k = 0; k < 3; k++) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        rate[k] = before[l] * now[m] - before[m] * now[l];
        square += rate[k] * rate[k];
    }
    const double sine = sqrt(square);
    const double cosine = imki_dot3(before, now);
    const double factor = sine > 0.0 ? -imk_atan2(sine, cosine) / (sine * dt) : 0.0;
    for (int k = 0; k < 3; k++)
        rate[k] *= factor;
}

static bool carried(const imki_suspended_ball *ball, const double force[3])
{
    return fabs(force[0]) <= ball->limit && fabs(force[1]) <= ball->limit &&
           fabs(force[2]) <= ball->limit;
}

static void step(void *memory, const imk_exposure *exposure, double *out)
{
    suspended_rotor_state *state = memory;
    const double thermal =
        state->torque_temperature * (exposure->temperature - IMKI_DESIGN_TEMPERATURE);
    double torque[3], reading[3], rate[3];
    for (int k = 0; k < 3; k++)
        torque[k] = state->torque[k] + thermal + imki_wander_next(&state->error[k]);
    state->fallen = state->fallen || !carried(&state->ball, exposure->specific_force);
    if (state->fallen) {
        for (int k = 0; k < 5; k++)
            out[k] = (double)NAN;
        return;
    }
    advance(state, exposure, torque);
    find_drift(state, exposure->specific_force);
    read_axis(state, reading);
    rate_of(state->reading, reading, state->sample, rate);
    out[0] = rate[0];
    out[1] = rate[1];
    for (int k = 0; k < 3; k++)
        out[2 + k] = state->reading[k] = reading[k];
}

static void observe(const void *memory, double *values)
{
    const suspended_rotor_state *state = memory;
    for (int k = 0; k < 3; k++)
        values[AXIS_X + k] = state->axis[k];
    values[DRIFT] = state->drift;
    values[WOBBLE] = state->cone;
    values[FALLEN] = state->fallen ? 1.0 : 0.0;
}

IMKI_DESIGN_FUNCTIONS(suspended_rotor);

const imk_instrument imk_suspended_rotor_instrument = {
    IMKI_DESCRIBED(suspended_rotor),
    .title = "electrostatically suspended gyro",
    .technology = "ESG",
    .source = "Autonetics MICRON (N57A): solid beryllium ball of 10 mm at 2500 rev/s [Lawrence "
              "1998]; shape, torques and readout chosen: suspended_rotor.h",
    .sensor = IMK_GYRO,
    .cookie = COOKIE,
    .state_size = sizeof(suspended_rotor_state),
    .init = init,
    .step = step,
    .observe = observe,
    .step_length = step_length,
};
