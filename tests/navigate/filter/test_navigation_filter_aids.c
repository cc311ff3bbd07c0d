/* SPDX-License-Identifier: Apache-2.0 */
/* Aids of the navigation filter: what it says of the errors against differences of two filters,
 * readings between samples, closed forms of estimates with correlated errors and lever arms, and
 * the way back after long refusals. */
#include "check.h"

#include "car_profile.h"
#include "navigate/filter/navigation_filter_internal.h"

#include <stdlib.h>
#include <string.h>

static const double degree = 0.017453292519943295, no = (double)INFINITY;

typedef struct memory {
    double bytes[20000];
} memory;

static imk_navigation_filter *start_filter(memory *m, const imk_navigation_filter_settings *s,
                                           const imk_navigation_state *start)
{
    imk_navigation_filter *filter;
    imk_error error;
    assert_true(imk_navigation_filter_size(s) <= sizeof *m);
    CHECK_OK(imk_navigation_filter_start(s, start, &filter, m, sizeof *m, &error));
    return filter;
}

/* ---- responses -------------------------------------------------------------------------------
 */

/* A filter that knows nothing well, with all that an aid may have. */
static imk_navigation_filter_settings loose(imk_aid_kind kind)
{
    imk_navigation_filter_settings s;
    imk_navigation_filter_default(&s);
    for (int i = 0; i < 9; i++)
        s.initial_sigma[i] = i < 3 ? 1e4 : i < 6 ? 100.0 : 1.0;
    s.gyro.part_count = s.accel.part_count = 2;
    for (int i = 0; i < 3; i++) {
        s.gyro.part[0].sigma[i] = s.gyro.part[1].sigma[i] = 0.1;
        s.accel.part[0].sigma[i] = s.accel.part[1].sigma[i] = 1.0;
    }
    s.gyro.part[1].correlation_time = s.accel.part[1].correlation_time = 100.0;
    s.aid_count = 1;
    s.aid[0] = imk_aid_default(kind);
    s.aid[0].correlation_time = 50.0;
    for (int i = 0; i < 3; i++) {
        s.aid[0].lever_arm[i] = (double[3]){1.5, -0.7, -2.0}[i];
        s.aid[0].lever_arm_sigma[i] = 1.0;
        s.aid[0].correlated_sigma[i] = 10.0;
        if (imk_aid_axes(kind) == 3)
            s.aid[0].sigma[i] = 1.0;
    }
    return s;
}

static const imk_geodetic place = {0.7, -0.3, 400.0};

/* The situation: a turn at speed. @param x  errors of the estimate: nine (Earth-fixed axes), of the
 * gyros, accelerometers, the aid, the arm */
static imk_navigation_filter *moving(memory *m, const imk_navigation_filter_settings *s,
                                     const double x[21])
{
    imk_navigation_state start = imk_navigation_state_ned(
        0.0, place, (imk_vector3){{20.0, -12.0, 1.5}}, imk_matrix3_from_euler(0.1, -0.2, 2.0));
    imk_vector3 turn;
    for (int i = 0; i < 3; i++) {
        start.position.v[i] += x[i];
        start.velocity.v[i] += x[3 + i];
        turn.v[i] = x[6 + i];
    }
    start.attitude =
        imk_quaternion_multiply(imk_quaternion_from_rotation_vector(turn), start.attitude);
    imk_navigation_filter *f = start_filter(m, s, &start);
    f->attitude = imk_quaternion_to_matrix(f->strapdown.state.attitude);
    for (int i = 0; i < 3; i++) { /* what remains is the part less its estimate */
        f->bias[0][0][i] = f->bias_sum[0].v[i] = -x[9 + i];
        f->bias[1][0][i] = f->bias_sum[1].v[i] = -x[12 + i];
        f->aid_state[i].estimate = -x[15 + i];
        f->aid_state[3 + i].estimate = -x[18 + i];
    }
    const double dt = 0.02;
    imk_navigation_filter_step(f, dt, (imk_vector3){{0.3 * dt, -0.2 * dt, 0.5 * dt}},
                               (imk_vector3){{3.0 * dt, 8.0 * dt, -9.0 * dt}});
    return f;
}

/* A reading in the middle of the sample that fits the situation without errors roughly. */
static imk_aid_reading reading_of(imk_aid_kind kind, double time)
{
    imk_aid_reading r = {.time = time};
    const double values[IMK_AID_KIND_COUNT][3] = {{0.7, -0.3, 400.0}, {20.0, -12.0, 1.5},
                                                  {2.0, 0.0, 0.0},    {400.0, 0.0, 0.0},
                                                  {-18.0, 0.0, 0.0},  {0.0, 0.0, 0.0}};
    memcpy(r.value, values[kind], sizeof r.value);
    return r;
}

static void innovation_at(const imk_navigation_filter_settings *s, double time, const double x[21],
                          double z[3], double *errors)
{
    static memory m;
    imk_navigation_filter *f = moving(&m, s, x);
    const imk_navigation_state state = imk_navigation_filter_state(f);
    const imk_aid_reading reading = reading_of(s->aid[0].kind, time);
    assert_int_equal(imk_navigation_filter_aid(f, 0, &reading), IMK_AID_USED);
    const imk_innovation i = imk_navigation_filter_innovation(f);
    for (size_t r = 0; r < i.rows; r++)
        z[r] = i.value[r];
    if (!errors)
        return;
    /* The state itself, for differences. */
    memcpy(errors, state.position.v, 3 * sizeof *errors);
    memcpy(errors + 3, state.velocity.v, 3 * sizeof *errors);
    memcpy(errors + 6, &state.attitude, 4 * sizeof *errors);
}

/* Errors at the end of the sample: of nine by the states, of the others as given (they decay by
 * 1e-4 within it). */
static void errors_at_end(const double with[10], const double without[10], const double x[21],
                          size_t states, double *out)
{
    imk_quaternion a, b;
    memcpy(&a, with + 6, sizeof a);
    memcpy(&b, without + 6, sizeof b);
    const imk_vector3 turn =
        imk_quaternion_to_rotation_vector(imk_quaternion_multiply(a, imk_quaternion_conjugate(b)));
    memset(out, 0, states * sizeof *out);
    for (int i = 0; i < 3; i++) {
        out[i] = with[i] - without[i];
        out[3 + i] = with[3 + i] - without[3 + i];
        out[6 + i] = turn.v[i];
        out[9 + i] = x[9 + i];   /* the first part of the gyros */
        out[15 + i] = x[12 + i]; /* of the accelerometers */
        out[21 + i] = x[15 + i];
        out[24 + i] = x[18 + i];
    }
}

/* What is left out of velocities: north at the place turns by 1/R with an error of 1 m, and the
 * velocity with it; between the ends of a sample of 20 ms, 7 ms from its start, a tilt of 1 mrad
 * per second leaves a velocity of 12 m/s^2 times 1e-3/s times 7 ms times 13 ms/2. */
static double left_out(int kind, int k)
{
    if (kind == IMK_AID_POSITION || kind == IMK_AID_HEADING || kind == IMK_AID_HEIGHT)
        return 2e-9;
    return k < 3 ? 23.0 / 6.36e6 : k >= 9 && k < 12 ? 6e-7 : 2e-9;
}

/* z(x) - z(0) is H x: every kind of aid, every error, at the end of the sample and within it. The
 * errors are small enough for their squares to be 1e-6 of them. Within the sample biases act in
 * axes that turn by 12 mrad; decays are 4e-4 of the aid's own error. */
static void test_responses(void **state)
{
    (void)state;
    static const double sizes[7] = {1.0, 0.1, 1e-4, 1e-3, 1e-2, 1.0, 0.01};
    for (int kind = 0; kind < IMK_AID_KIND_COUNT; kind++)
        for (int within = 0; within < 2; within++)
            for (int k = 0; k < 21; k++) {
                const imk_navigation_filter_settings s = loose((imk_aid_kind)kind);
                const double none[21] = {0}, time = within ? 0.007 : 0.02;
                double x[21] = {0}, z0[3], z1[3], without[10], with[10];
                double errors[IMKI_FILTER_STATES_MAX];
                static memory m;
                x[k] = sizes[k / 3];
                innovation_at(&s, time, none, z0, without);
                innovation_at(&s, time, x, z1, with);
                imk_navigation_filter *f = moving(&m, &s, none);
                const imk_aid_reading reading = reading_of((imk_aid_kind)kind, time);
                imk_navigation_filter_aid(f, 0, &reading);
                const imki_filter_gain gain = imki_navigation_filter_gain(f);
                assert_int_equal(gain.rows, imk_aid_axes((imk_aid_kind)kind));
                errors_at_end(with, without, x, gain.states, errors);
                double unit = 0.0, scale = 0.0;
                for (size_t i = 0; i < gain.states; i++)
                    scale = fmax(scale, fabs(gain.h[i] * errors[i]));
                for (size_t r = 0; r < gain.rows; r++) {
                    double sum = 0.0;
                    for (size_t i = 0; i < gain.states; i++) {
                        sum += gain.h[r * gain.states + i] * errors[i];
                        unit = fmax(unit, fabs(gain.h[r * gain.states + i] * errors[i]));
                    }
                    CHECK_CLOSE(z1[r] - z0[r], sum, 1e-2 * fmax(unit, scale) + left_out(kind, k));
                }
            }
}

/* ---- between samples -------------------------------------------------------------------------
 */

static imk_trajectory_piece *car(imk_trajectory *trajectory)
{
    static imk_motion_step steps[CAR_PROFILE_STEPS];
    imk_motion_script script;
    size_t count;
    car_profile(&script, steps);
    CHECK_OK(imk_motion_script_pieces(&script, &count, NULL));
    imk_trajectory_piece *piece = malloc(count * sizeof *piece);
    assert_non_null(piece);
    CHECK_OK(imk_motion_script_compile(&script, piece, count, trajectory, NULL));
    return piece;
}

/* What an aid without errors reads at a time. */
static imk_aid_reading perfect_reading(const imk_trajectory *trajectory, const imk_aid *aid,
                                       double time)
{
    imk_motion_state m;
    imk_trajectory_state(trajectory, time, &m);
    imk_aid_reading reading = {.time = time};
    const imk_vector3 arm = {{aid->lever_arm[0], aid->lever_arm[1], aid->lever_arm[2]}};
    const imk_matrix3 c = imk_quaternion_to_matrix(m.attitude);
    const imk_geodetic there =
        imk_geodetic_from_ecef(imk_vector3_add(m.position, imk_matrix3_apply(c, arm)));
    const imk_geodetic here = imk_geodetic_from_ecef(m.position);
    const imk_matrix3 ned = imk_matrix3_transpose(imk_ned_axes(here.latitude, here.longitude));
    /* The point's velocity by differences of 2 ms: no formula of the filter. */
    const double step = 1e-3;
    imk_vector3 at[2];
    for (int k = 0; k < 2; k++) {
        imk_motion_state side;
        imk_trajectory_state(trajectory, time + (k ? step : -step), &side);
        at[k] = imk_vector3_add(side.position, imk_quaternion_rotate(side.attitude, arm));
    }
    const imk_vector3 velocity = imk_vector3_scale(imk_vector3_subtract(at[1], at[0]), 0.5 / step);
    double roll, pitch;
    switch (aid->kind) {
    case IMK_AID_POSITION:
        memcpy(reading.value, (double[3]){there.latitude, there.longitude, there.height},
               sizeof reading.value);
        break;
    case IMK_AID_VELOCITY:
        memcpy(reading.value, imk_matrix3_apply(ned, velocity).v, sizeof reading.value);
        break;
    case IMK_AID_HEADING:
        imk_matrix3_to_euler(imk_matrix3_multiply(ned, c), &roll, &pitch, &reading.value[0]);
        break;
    case IMK_AID_HEIGHT:
        reading.value[0] = there.height;
        break;
    default:
        memcpy(reading.value, imk_matrix3_apply(imk_matrix3_transpose(c), velocity).v,
               sizeof reading.value);
    }
    return reading;
}

/* Two minutes of a car with perfect sensors at 100 Hz: all readings, at times that are no samples',
 * are as predicted. The rate is the mean of the sample, off by up to half its change over it, which
 * is 1.2 rad/s^2 here, times the arm of 2.6 m: 16 mm/s. Forces change by 9 m/s^3: a velocity that
 * is linear within the sample is off by dt^2/8 times that, 0.1 mm/s. */
static void test_between_samples(void **state)
{
    (void)state;
    static memory m;
    static const imk_aid_kind kinds[] = {IMK_AID_POSITION, IMK_AID_VELOCITY, IMK_AID_HEADING,
                                         IMK_AID_HEIGHT, IMK_AID_ODOMETER};
    static const double limit[] = {5e-5, 1.6e-2, 1e-4, 5e-5, 1.6e-2};
    const double dt = 0.01;
    imk_trajectory trajectory;
    imk_trajectory_piece *piece = car(&trajectory);
    imk_navigation_filter_settings s;
    imk_navigation_filter_default(&s);
    s.initial_sigma[0] = s.initial_sigma[1] = s.initial_sigma[2] = 1e-3;
    s.aid_count = 5;
    for (int k = 0; k < 5; k++) {
        s.aid[k] = imk_aid_default(kinds[k]);
        for (int i = 0; i < 3; i++) {
            s.aid[k].lever_arm[i] = (double[3]){1.5, -0.7, -2.0}[i];
            if (imk_aid_axes(kinds[k]) == 3)
                s.aid[k].sigma[i] = 100.0;
        }
        s.aid[k].sigma[0] = 100.0;
    }
    imk_motion_state begin;
    imk_trajectory_state(&trajectory, 0.0, &begin);
    const imk_navigation_state start = {0.0, begin.position, begin.velocity, begin.attitude};
    imk_navigation_filter *f = start_filter(&m, &s, &start);
    double worst[5] = {0};
    for (int k = 1; k <= 12000; k++) {
        double means[6], boundary[2] = {(k - 1) * dt, k * dt};
        double *channel[6];
        for (int i = 0; i < 6; i++)
            channel[i] = &means[i];
        imk_trajectory_means(&trajectory, imk_random_seeded(0).kernel, 1, boundary, channel, NULL,
                             channel + 3);
        imk_navigation_filter_step(f, dt,
                                   (imk_vector3){{means[0] * dt, means[1] * dt, means[2] * dt}},
                                   (imk_vector3){{means[3] * dt, means[4] * dt, means[5] * dt}});
        if (k % 7 != 0)
            continue;
        for (size_t a = 0; a < 5; a++) {
            const imk_aid_reading reading =
                perfect_reading(&trajectory, &s.aid[a], (k - 0.1 - 0.2 * (double)(k % 5)) * dt);
            assert_int_equal(imk_navigation_filter_aid(f, a, &reading), IMK_AID_USED);
            const imk_innovation i = imk_navigation_filter_innovation(f);
            for (size_t r = 0; r < i.rows; r++)
                worst[a] = fmax(worst[a], fabs(i.value[r]));
        }
    }
    for (int a = 0; a < 5; a++) {
        print_message("%s: off by %.2e %s at most\n", imk_aid_kind_name(kinds[a]), worst[a],
                      imk_aid_unit(kinds[a]));
        CHECK_BELOW(worst[a], limit[a]);
    }
    free(piece);
}

/* ---- closed forms ----------------------------------------------------------------------------
 */

/* One sample at rest, of an hour's start known to p in position and perfectly otherwise. */
static imk_navigation_filter *at_rest(memory *m, imk_navigation_filter_settings *s, double p)
{
    const imk_navigation_state start =
        imk_navigation_state_ned(0.0, place, (imk_vector3){{0}}, imk_matrix3_identity());
    s->initial_sigma[0] = s->initial_sigma[1] = s->initial_sigma[2] = p;
    return start_filter(m, s, &start);
}

static void rest_for(imk_navigation_filter *f, double time)
{
    const imk_vector3 up = {{0.0, 0.0, -imk_normal_gravity(place.latitude, place.height) * time}};
    imk_navigation_filter_step(f, time, imk_vector3_scale(imk_earth_rate(place.latitude), time),
                               up);
}

static double north_variance(imk_navigation_filter *f)
{
    imk_navigation_filter_estimate e;
    imk_navigation_filter_get(f, &e);
    return e.covariance[0][0];
}

static imk_aid_verdict read_place(imk_navigation_filter *f, size_t aid, double height)
{
    const imk_aid_reading reading = {.time = imk_navigation_filter_state(f).time,
                                     .value = {place.latitude, place.longitude, height}};
    return imk_navigation_filter_aid(f, aid, &reading);
}

/* Readings of a place known to p. White errors r: after k readings 1/(1/p^2 + k/r^2). With an error
 * c of s and T: of two readings h apart the errors have the covariance R = [[r^2 + s^2, s^2 q],
 * [., .]], q = e^{-h/T}, and what remains is 1/(1/p^2 + 1^T R^-1 1), as R's rows have the same sum:
 * 1/(1/p^2 + 2/(r^2 + s^2 + s^2 q)). With a lever arm known to l: 1/(1/p^2 + 1/(l^2 + r^2/k)),
 * whether one aid reads it or two at the same point. Steps of 1 ms leave the position alone. */
static void test_closed_forms(void **state)
{
    (void)state;
    static memory m;
    const double p = 3.0, r = 2.0, c = 1.5, h = 1e-3, correlation_time = 2e-3, l = 0.5;
    imk_navigation_filter_settings s;
    imk_navigation_filter_default(&s);
    s.aid_count = 1;
    s.aid[0] = imk_aid_default(IMK_AID_POSITION);
    for (int i = 0; i < 3; i++)
        s.aid[0].sigma[i] = r;
    imk_navigation_filter *f = at_rest(&m, &s, p);
    for (int k = 1; k <= 3; k++) {
        rest_for(f, h);
        assert_int_equal(read_place(f, 0, place.height), IMK_AID_USED);
        CHECK_RELATIVE(north_variance(f), 1.0 / (1.0 / (p * p) + k / (r * r)), 1e-9);
    }
    s.aid[0].correlation_time = correlation_time;
    for (int i = 0; i < 3; i++)
        s.aid[0].correlated_sigma[i] = c;
    f = at_rest(&m, &s, p);
    for (int k = 0; k < 2; k++) {
        rest_for(f, h);
        read_place(f, 0, place.height);
    }
    const double q = exp(-h / correlation_time);
    CHECK_RELATIVE(north_variance(f), 1.0 / (1.0 / (p * p) + 2.0 / (r * r + c * c * (1.0 + q))),
                   1e-9);
    s.aid[0].correlation_time = 0.0;
    for (int i = 0; i < 3; i++) {
        s.aid[0].correlated_sigma[i] = 0.0;
        s.aid[0].lever_arm[i] = 1.0;
        s.aid[0].lever_arm_sigma[i] = l;
    }
    s.aid[1] = s.aid[0];
    s.aid_count = 2;
    f = at_rest(&m, &s, p);
    assert_int_equal(f->states, 12);
    /* The point is 1 m north, east and below: the reading is not there, but likely enough. */
    for (size_t k = 0; k < 2; k++) {
        rest_for(f, h);
        assert_int_equal(read_place(f, k, place.height), IMK_AID_USED);
    }
    CHECK_RELATIVE(north_variance(f), 1.0 / (1.0 / (p * p) + 1.0 / (l * l + r * r / 2.0)), 1e-9);
    s.aid[1].lever_arm[0] = 1.1; /* another point */
    f = at_rest(&m, &s, p);
    assert_int_equal(f->states, 15);
}

/* ---- refusals --------------------------------------------------------------------------------
 */

/* Readings 500 m off where the filter is sure to 1 m: refused and counted, and after as many as
 * stated the covariance is enlarged: the place is that of the readings, to their sigma. */
static void test_recovery(void **state)
{
    (void)state;
    static memory m;
    imk_navigation_filter_settings s;
    imk_navigation_filter_default(&s);
    s.recover_after = 4;
    s.aid_count = 1;
    s.aid[0] = imk_aid_default(IMK_AID_POSITION);
    for (int never = 0; never < 2; never++) {
        s.recover_after = never ? 0 : 4;
        imk_navigation_filter *f = at_rest(&m, &s, 1.0);
        for (int k = 0; k < 6; k++) {
            rest_for(f, 1e-3);
            assert_int_equal(read_place(f, 0, place.height + 500.0), never || k < 4
                                                                         ? IMK_AID_REFUSED
                                                                     : k == 4 ? IMK_AID_RECOVERED
                                                                              : IMK_AID_USED);
        }
        const imk_navigation_filter_counts c = imk_navigation_filter_aided(f, 0);
        assert_int_equal(c.refused, never ? 6 : 4);
        assert_int_equal(c.recovered, never ? 0 : 1);
        assert_int_equal(c.refused_in_row, never ? 6 : 0);
        CHECK_CLOSE(c.first_refused, 1e-3, 1e-12);
        assert_true(never ? isnan(c.first_recovered) : fabs(c.first_recovered - 5e-3) < 1e-12);
        imk_navigation_filter_estimate e;
        imk_navigation_filter_get(f, &e);
        const double height = imk_geodetic_from_ecef(e.state.position).height;
        CHECK_CLOSE(height, place.height + (never ? 0.0 : 500.0), 0.1);
    }
}

/* What cannot be used, and changes nothing: times before and behind the sample, numbers that are
 * none, an aid that there is not, a heading with body x upwards, a height that is held. */
static void test_not_used(void **state)
{
    (void)state;
    static memory m;
    imk_navigation_filter_settings s;
    imk_navigation_filter_default(&s);
    s.aid_count = 3;
    s.aid[0] = imk_aid_default(IMK_AID_POSITION);
    s.aid[1] = imk_aid_default(IMK_AID_HEADING);
    s.aid[2] = imk_aid_default(IMK_AID_HEIGHT);
    for (int held = 0; held < 2; held++) {
        s.hold_height = held;
        const imk_navigation_state start = imk_navigation_state_ned(
            0.0, place, (imk_vector3){{0}}, imk_matrix3_from_euler(0.0, 90.0 * degree, 0.0));
        imk_navigation_filter *f = start_filter(&m, &s, &start);
        imk_navigation_filter_step(f, 0.1, (imk_vector3){{0}}, (imk_vector3){{0.98, 0, 0}});
        const imk_aid_reading bad[] = {
            {.time = -0.01, .value = {0.7, -0.3, 400.0}},
            {.time = 0.11, .value = {0.7, -0.3, 400.0}},
            {.time = 0.1, .value = {(double)NAN, -0.3, 400.0}},
            {.time = 0.1, .value = {0.7, -0.3, 400.0}, .sigma = {no, no, no}}};
        for (size_t k = 0; k < sizeof bad / sizeof *bad; k++)
            assert_int_equal(imk_navigation_filter_aid(f, 0, &bad[k]), IMK_AID_NOT_USED);
        const imk_aid_reading good = {.time = 0.05, .value = {0.7, -0.3, 400.0}};
        assert_int_equal(imk_navigation_filter_aid(f, 3, &good), IMK_AID_NOT_USED);
        assert_int_equal(imk_navigation_filter_aid(f, 1, &good), IMK_AID_NOT_USED);
        const imk_aid_reading high = {.time = 0.1, .value = {400.0, 0.0, 0.0}};
        assert_int_equal(imk_navigation_filter_aid(f, 2, &high),
                         held ? IMK_AID_NOT_USED : IMK_AID_USED);
        assert_int_equal(imk_navigation_filter_aid(f, 0, &good), IMK_AID_USED);
        assert_int_equal(imk_navigation_filter_innovation(f).rows, held ? 2 : 3);
        assert_int_equal(imk_navigation_filter_aided(f, 0).accepted, 1);
    }
    imk_error error;
    imk_navigation_filter *f;
    s.aid[1].cookie = 0;
    CHECK_STATUS(
        imk_navigation_filter_start(&s, &(imk_navigation_state){0}, &f, &m, sizeof m, &error),
        IMK_ERROR_UNINITIALISED);
    s.aid_count = IMK_AIDS_MAX + 1;
    CHECK_STATUS(
        imk_navigation_filter_start(&s, &(imk_navigation_state){0}, &f, &m, sizeof m, &error),
        IMK_ERROR_RANGE);
    s.aid_count = 0;
    s.recover_after = -1;
    CHECK_STATUS(
        imk_navigation_filter_start(&s, &(imk_navigation_state){0}, &f, &m, sizeof m, &error),
        IMK_ERROR_RANGE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_responses),    cmocka_unit_test(test_between_samples),
        cmocka_unit_test(test_closed_forms), cmocka_unit_test(test_recovery),
        cmocka_unit_test(test_not_used),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
