/* SPDX-License-Identifier: Apache-2.0 */
/* The mechanisation against motions in closed form: at rest, coning, swinging, driving; anywhere on
 * Earth; and its inverse. */
#include "check.h"

#include "navigate/exact_motion.h"

#include "imukit/random.h"

static const double degree = 0.017453292519943295, pi = 3.14159265358979323846;

static const imk_geodetic places[] = {
    {0.785398163397448279, 0.15, 100.0},         /* 45 deg N */
    {1.57079632679489656, 0.0, 2800.0},          /* a pole */
    {-0.3, 3.14159265358979312, 0.0},            /* 180 deg of longitude */
    {-1.57079632679489656 + 1e-9, -2.5, 3000.0}, /* 6 mm beside the other pole */
    {0.0, -1.57079632679489656, 9000.0},         /* the equator */
};
enum { PLACES = sizeof places / sizeof *places };

static void report(const char *what, exact_error error)
{
    print_message("%s: position %.2e m, velocity %.2e m/s, attitude %.2e rad\n", what,
                  error.position, error.velocity, error.attitude);
}

/* ---- axes ------------------------------------------------------------------------------------ */

static void test_states_in_local_axes(void **state)
{
    (void)state;
    const imk_vector3 velocity = {{12.0, -7.0, 0.5}};
    const imk_matrix3 c_nb = imk_matrix3_from_euler(0.3, -0.4, 2.0);
    for (int i = 0; i < PLACES; i++) {
        const imk_navigation_state s = imk_navigation_state_ned(5.0, places[i], velocity, c_nb);
        imk_geodetic place;
        imk_vector3 v;
        imk_matrix3 c;
        imk_navigation_state_to_ned(&s, &place, &v, &c);
        imk_navigation_state_to_ned(&s, NULL, NULL, NULL);
        CHECK_CLOSE(s.time, 5.0, 0.0);
        CHECK_CLOSE(place.latitude, places[i].latitude, 1e-15);
        CHECK_CLOSE(place.height, places[i].height, 2e-9);
        /* At the pole itself rounding of the position decides about north, and 6 mm beside it a
         * nanometre turns north by 1e-7. */
        const double turned = fabs(fabs(places[i].latitude) - pi / 2) < 1e-6 ? 1e-6 : 1e-14;
        if (i != 1) {
            for (int row = 0; row < 3; row++) {
                CHECK_CLOSE(v.v[row], velocity.v[row], 20.0 * turned);
                for (int column = 0; column < 3; column++)
                    CHECK_CLOSE(c.m[row][column], c_nb.m[row][column], turned);
            }
        }
        CHECK_RELATIVE(imk_vector3_norm(v), imk_vector3_norm(velocity), 1e-15);
    }
}

/* A hundredth of a millimetre up, and the length of 1e-12 rad of latitude: M 1e-12 with M the
 * radius of curvature. Positions in metres have steps of 1e-9 m. */
static void test_small_differences(void **state)
{
    (void)state;
    const imk_geodetic place = {0.8, 1.0, 50.0};
    const imk_matrix3 level = imk_matrix3_identity();
    const imk_vector3 rest = {{0}};
    double meridian, prime_vertical;
    imk_curvature_radii(place.latitude, &meridian, &prime_vertical);
    imk_geodetic moved = place;
    moved.height += 1e-5;
    moved.latitude += 1e-12;
    const imk_navigation_state b = imk_navigation_state_ned(0.0, place, rest, level);
    const imk_navigation_state a = imk_navigation_state_ned(0.0, moved, rest, level);
    const imk_vector3 d = imk_navigation_difference_ned(&a, &b);
    CHECK_CLOSE(d.v[0], meridian * (moved.latitude - place.latitude), 3e-9);
    CHECK_CLOSE(d.v[1], 0.0, 2e-9);
    CHECK_CLOSE(d.v[2], -1e-5, 3e-9);
}

/* ---- one step -------------------------------------------------------------------------------- */

/* A step with constant rate and force is what a thousand shorter ones with the same rate and force
 * are, at turns of small and large angles. What is left is of gravity, which is taken where the
 * velocity at the start would lead: a dt^2/8 away, 3e-6/s^2 (a dt^2/8) dt of velocity, for
 * a = 15 m/s^2 and 0.1 s 6e-9 m/s; and of a fast turn, Coriolis on more than a parabola of way,
 * 2e-8 m. */
static void test_simple_step_is_exact(void **state)
{
    (void)state;
    const imk_vector3 velocity = {{20.0, -30.0, 5.0}}, force = {{3.0, -8.0, 11.0}};
    const imk_vector3 axis = {{0.6, -0.48, 0.64}};
    static const double turns[] = {1e-6, 0.01, 0.2, 0.49, 0.51, 1.5, 3.0};
    for (size_t i = 0; i < sizeof turns / sizeof *turns; i++) {
        const double dt = 0.1;
        const imk_navigation_state start = imk_navigation_state_ned(
            0.0, places[0], velocity, imk_matrix3_from_euler(0.1, 0.7, -2.0));
        imk_strapdown once = imk_strapdown_start(&start), often = once;
        once.samples = often.samples = 1;
        imk_strapdown_step(&once, dt, imk_vector3_scale(axis, turns[i]),
                           imk_vector3_scale(force, dt));
        for (int k = 0; k < 1000; k++)
            imk_strapdown_step(&often, dt / 1000, imk_vector3_scale(axis, turns[i] / 1000),
                               imk_vector3_scale(force, dt / 1000));
        const exact_error error = exact_compare(&once.state, &often.state);
        CHECK_BELOW(error.attitude, 1e-15);
        CHECK_BELOW(error.velocity, 1e-8);
        CHECK_BELOW(error.position, 5e-8);
    }
}

/* The inverse of a step gives back its increments, from any state, for steps up to a second and
 * turns up to 3 rad: to the rounding of attitudes (1e-16) and of velocities of 30 m/s (4e-15). */
static void test_inverse(void **state)
{
    (void)state;
    const imk_random random = imk_random_seeded(20);
    static const double steps[] = {0.001, 0.01, 0.1, 1.0};
    double worst_angle = 0.0, worst_velocity = 0.0;
    for (uint64_t trial = 0; trial < 2000; trial++) {
        double n[16];
        imk_random_normals(random, imk_stream(0, 1, 0, 0), 16 * trial, 16, n);
        const double dt = steps[trial % 4];
        const imk_geodetic place = {asin(sin(n[0])), n[1], 1000.0 * n[2]};
        const imk_navigation_state from =
            imk_navigation_state_ned(100.0, place, (imk_vector3){{10 * n[3], 10 * n[4], n[5]}},
                                     imk_matrix3_from_euler(n[6], n[7], n[8]));
        imk_vector3 turn = {{n[9], n[10], n[11]}};
        const double largest = trial % 3 == 0 ? 3.0 : trial % 3 == 1 ? 0.3 : 1e-5;
        turn = imk_vector3_scale(turn, largest / (1.0 + imk_vector3_norm(turn)));
        const imk_vector3 velocity = {{5 * n[12] * dt, 5 * n[13] * dt, -9.8 * dt}};
        imk_strapdown strapdown = imk_strapdown_start(&from);
        strapdown.samples = 1;
        imk_strapdown_step(&strapdown, dt, turn, velocity);
        strapdown.state.position = (imk_vector3){{0, 0, 0}}; /* is not used */
        imk_vector3 a, u;
        /* Times of 100 s leave steps with 14 digits; the step itself is taken from 0. */
        imk_navigation_state start = from;
        start.time = 0.0;
        strapdown.state.time = dt;
        imk_strapdown_invert(&start, &strapdown.state, &a, &u);
        worst_angle = fmax(worst_angle, imk_vector3_norm(imk_vector3_subtract(a, turn)));
        worst_velocity = fmax(worst_velocity, imk_vector3_norm(imk_vector3_subtract(u, velocity)));
    }
    print_message("inverse: angle %.2e rad, velocity %.2e m/s\n", worst_angle, worst_velocity);
    CHECK_BELOW(worst_angle, 1e-14);
    CHECK_BELOW(worst_velocity, 1e-13);
}

/* ---- the integrals of second order ------------------------------------------------------------
 */

enum { POWERS = 4 };

/* What rate and force are at a time within the step and before: polynomials. */
typedef struct polynomial {
    double of[3][POWERS]; /* coefficients of t^0 ... t^3, by axis */
} polynomial;

typedef struct polynomial_motion {
    polynomial rate, force;
} polynomial_motion;

/* The integral of a polynomial from 0. */
static imk_vector3 integral_to(const polynomial *p, double t)
{
    imk_vector3 sum = {{0}};
    for (int i = 0; i < 3; i++)
        for (int k = POWERS; k-- > 0;)
            sum.v[i] = (sum.v[i] + p->of[i][k] / (k + 1)) * t;
    return sum;
}

static imk_vector3 value_at(const polynomial *p, double t)
{
    imk_vector3 sum = {{0}};
    for (int i = 0; i < 3; i++)
        for (int k = POWERS; k-- > 0;)
            sum.v[i] = sum.v[i] * t + p->of[i][k];
    return sum;
}

/* One step of dt, after as many samples of other lengths as it looks back on. */
static imk_navigation_state step_of(const polynomial_motion *m, int samples, double sign,
                                    const imk_navigation_state *start, double dt)
{
    static const double before[] = {0.8, 1.3, 0.9};
    imk_strapdown s = imk_strapdown_start(start);
    s.samples = samples;
    double from = 0.0;
    for (int k = 0; k < samples - 1; k++)
        from -= before[k] * dt;
    for (int k = samples - 1; k-- > 0;) {
        const double to = k > 0 ? from + before[k] * dt : 0.0;
        imk_strapdown_step(
            &s, to - from,
            imk_vector3_scale(
                imk_vector3_subtract(integral_to(&m->rate, to), integral_to(&m->rate, from)), sign),
            imk_vector3_subtract(integral_to(&m->force, to), integral_to(&m->force, from)));
        from = to;
    }
    s.state = imk_strapdown_start(start).state;
    s.position_low = (imk_vector3){{0}};
    s.attitude_low = (imk_quaternion){0, 0, 0, 0};
    imk_strapdown_step(&s, dt, imk_vector3_scale(integral_to(&m->rate, dt), sign),
                       integral_to(&m->force, dt));
    return s.state;
}

/* With rate and force that are the polynomials the step takes them for, every integral is exact to
 * second order in the two together: of velocity int a x f and of position int (dt - t) a x f, a the
 * integral of the rate, and half of int a x w of the attitude. Half the difference of two steps
 * with opposite rates leaves that product; what is left are third orders of the rate (1e-7 of it)
 * and the Earth's turn meanwhile (1e-6). The force is as large as rounding of the position demands.
 * The attitude's part is even in the rate: the sum of two. */
static void test_second_order(void **state)
{
    (void)state;
    const double dt = 0.01;
    const imk_navigation_state start =
        imk_navigation_state_ned(0.0, places[0], (imk_vector3){{0}}, imk_matrix3_identity());
    const imk_random random = imk_random_seeded(3);
    for (int samples = 1; samples <= 4; samples++) {
        polynomial_motion m = {{{{0}}}, {{{0}}}};
        double n[24], scale = 1.0;
        imk_random_normals(random, imk_stream(0, 1, 0, 0), 32 * (uint64_t)samples, 24, n);
        for (int k = 0; k < samples; k++, scale *= 5.0 / dt)
            for (int i = 0; i < 3; i++) {
                m.rate.of[i][k] = 1e-5 / dt * scale * n[6 * k + i];
                m.force.of[i][k] = 1e7 / dt * scale * n[6 * k + 3 + i];
            }
        imk_vector3 velocity = {{0}}, way = {{0}}, turn = {{0}};
        enum { POINTS = 2000 }; /* midpoints: to 1e-7 */
        for (int p = 0; p < POINTS; p++) {
            const double t = (p + 0.5) * dt / POINTS, weight = dt / POINTS;
            const imk_vector3 a = integral_to(&m.rate, t);
            const imk_vector3 af = imk_vector3_cross(a, value_at(&m.force, t));
            velocity = imk_vector3_add(velocity, imk_vector3_scale(af, weight));
            way = imk_vector3_add(way, imk_vector3_scale(af, weight * (dt - t)));
            turn = imk_vector3_add(
                turn, imk_vector3_scale(imk_vector3_cross(a, value_at(&m.rate, t)), 0.5 * weight));
        }
        const imk_navigation_state plus = step_of(&m, samples, 1.0, &start, dt),
                                   minus = step_of(&m, samples, -1.0, &start, dt);
        const imk_quaternion back =
            imk_quaternion_conjugate(imk_strapdown_start(&start).state.attitude);
        const imk_vector3 dv = imk_quaternion_rotate(
            back, imk_vector3_scale(imk_vector3_subtract(plus.velocity, minus.velocity), 0.5));
        const imk_vector3 dr = imk_quaternion_rotate(
            back, imk_vector3_scale(imk_vector3_subtract(plus.position, minus.position), 0.5));
        const imk_vector3 up = imk_quaternion_to_rotation_vector(
                              imk_quaternion_multiply(back, plus.attitude)),
                          down = imk_quaternion_to_rotation_vector(
                              imk_quaternion_multiply(back, minus.attitude));
        const imk_vector3 earth =
            imk_quaternion_rotate(back, (imk_vector3){{0.0, 0.0, -IMK_EARTH_RATE * dt}});
        for (int i = 0; i < 3; i++) {
            CHECK_CLOSE(dv.v[i], velocity.v[i], 5e-6 * imk_vector3_norm(velocity));
            CHECK_CLOSE(dr.v[i], way.v[i], 5e-6 * imk_vector3_norm(way));
            CHECK_CLOSE(0.5 * (up.v[i] + down.v[i]) - earth.v[i], turn.v[i],
                        1e-4 * imk_vector3_norm(turn) + 1e-12);
        }
    }
}

/* ---- motions --------------------------------------------------------------------------------- */

static exact_instant rest_at(double time)
{
    (void)time;
    return (exact_instant){.attitude =
                               imk_quaternion_from_matrix(imk_matrix3_from_euler(0.5, -0.3, 1.0))};
}

/* One hour at rest: rounding alone. A position is known to 1e-9 m, increments to 1e-17 m/s, and the
 * instability of the vertical channel multiplies what they do by up to e^6.3/2 = 270. */
static void test_rest(void **state)
{
    (void)state;
    for (int i = 0; i < PLACES; i++) {
        const exact_motion motion = {places[i], rest_at};
        const imk_navigation_state start = exact_state(&motion, 0.0);
        imk_strapdown strapdown = imk_strapdown_start(&start);
        imk_vector3 angle, velocity;
        exact_increments(&motion, 0.0, 0.01, &angle, &velocity);
        for (int k = 0; k < 360000; k++)
            imk_strapdown_step(&strapdown, 0.01, angle, velocity);
        const exact_error error = exact_compare(&strapdown.state, &start);
        report("rest, 1 h", error);
        CHECK_BELOW(error.position, 3e-6);
        CHECK_BELOW(error.velocity, 1e-8);
        CHECK_BELOW(error.attitude, 1e-14);
    }
}

/* A tenth of a micrometre per second moves by less in each step than a position of 6000 km can
 * tell, and yet arrives. */
static exact_instant creep_at(double time)
{
    exact_instant now = rest_at(time);
    now.velocity.v[0] = 1e-7;
    now.position.v[0] = 1e-7 * time;
    return now;
}

static void test_creep(void **state)
{
    (void)state;
    const exact_motion motion = {places[0], creep_at};
    const imk_strapdown strapdown = exact_run(&motion, 100.0, 1000.0, 0.0);
    const imk_navigation_state start = exact_state(&motion, 0.0);
    const imk_vector3 way = imk_navigation_difference_ned(&strapdown.state, &start);
    CHECK_CLOSE(way.v[0], 1e-5, 3e-9);
}

static const double coning_angle = 0.017453292519943295, coning_rate = 62.83185307179586;

/* The body's x and y axes follow a cone of 1 deg ten times a second. */
static exact_instant coning_at(double time)
{
    const double sine = imk_sin(coning_rate * time), cosine = imk_cos(coning_rate * time);
    const double sb = imk_sin(coning_angle), cb = imk_cos(coning_angle);
    return (exact_instant){
        .attitude = imk_quaternion_from_rotation_vector(
            (imk_vector3){{coning_angle * cosine, coning_angle * sine, 0.0}}),
        .rate = {{-coning_rate * sb * sine, coning_rate * sb * cosine, coning_rate * (cb - 1.0)}}};
}

/* With x the phase per sample, the body's turn within a sample exceeds the sum of its increments by
 * sin^2 b (x - sin x)/2, and a_m x a, of the increments m samples apart, is
 * 2 sin^2 b (1 - cos x) sin(m x). The polynomials through two, three and four means (Legendre's
 * coefficients by exact fractions, put into the equations of strapdown.c) make of these
 *
 *     c2 = a_1 x a/12,   c3 = 61/360 a_1 x a - 31/720 a_2 x a
 *     c4 = 971/3780 a_1 x a - 487/3780 a_2 x a + 53/1890 a_3 x a
 *
 * so that of (x - sin x)/2 = x^3/12 - ... all is missed with one sample and the fractions x^2/5,
 * 19/60 x^2 and 37/126 x^4 with more. The rest, to relative b^2, is the drift about the axis of the
 * cone; what the axis itself wobbles more than it should, 1e-5 rad, does not grow. */
static double coning_drift(int samples, double x)
{
    static const double weight[4][3] = {{0.0, 0.0, 0.0},
                                        {1.0 / 12, 0.0, 0.0},
                                        {61.0 / 360, -31.0 / 720, 0.0},
                                        {971.0 / 3780, -487.0 / 3780, 53.0 / 1890}};
    double given = 0.0;
    for (int m = 0; m < 3; m++)
        given += 2 * (1 - imk_cos(x)) * weight[samples - 1][m] * imk_sin((m + 1) * x);
    const double sb = imk_sin(coning_angle);
    return sb * sb * ((x - imk_sin(x)) / 2 - given);
}

static void test_coning(void **state)
{
    (void)state;
    const exact_motion motion = {places[0], coning_at};
    static const double rates[] = {100, 200, 400};
    for (int samples = 1; samples <= 4; samples++)
        for (int i = 0; i < 3; i++) {
            const double seconds = 10.0;
            const imk_strapdown strapdown = exact_run_of(&motion, seconds, rates[i], 0.0, samples);
            const imk_navigation_state truth = exact_state(&motion, seconds);
            const imk_quaternion off = imk_quaternion_multiply(
                strapdown.state.attitude, imk_quaternion_conjugate(truth.attitude));
            const imk_vector3 turn =
                imk_quaternion_rotate(imk_quaternion_conjugate(exact_axes(&motion)),
                                      imk_quaternion_to_rotation_vector(off));
            const double x = coning_rate / rates[i];
            const double expected = -coning_drift(samples, x) * rates[i] * seconds;
            print_message("coning, %d samples at %g Hz: %.4g rad in %g s, expected %.4g\n", samples,
                          rates[i], turn.v[2], seconds, expected);
            CHECK_CLOSE(turn.v[2], expected, 2e-3 * fabs(expected) + 1e-8);
        }
}

static const double rock = 1e-3, sway = 0.01;

/* Rocking about x by 1 mrad and swaying along y by 1 cm, together, ten times a second. */
static exact_instant sculling_at(double time)
{
    double angle[3] = {0}, across[3] = {0};
    exact_wave(rock, 0.0, coning_rate, time, angle);
    exact_wave(sway, 0.0, coning_rate, time, across);
    return (exact_instant){
        .position = {{0.0, across[0], 0.0}},
        .velocity = {{0.0, across[1], 0.0}},
        .acceleration = {{0.0, across[2], 0.0}},
        .attitude = imk_quaternion_from_rotation_vector((imk_vector3){{angle[0], 0.0, 0.0}}),
        .rate = {{angle[1], 0.0, 0.0}}};
}

/* What coning is to angles, sculling is to velocities: the force across, s w^2, times the angle r
 * has a mean, s r w (x - sin x)/2 a sample, of which the same fractions are missed; it is felt
 * upwards. Gravity on the rocking body adds some g r^2/w, 1/4000 of it; 1e-9 m/s is the wobble of
 * the other terms. */
static void test_sculling(void **state)
{
    (void)state;
    const exact_motion motion = {places[0], sculling_at};
    static const double rates[] = {100, 200, 400};
    const double w = coning_rate, seconds = 5.0, sb = imk_sin(coning_angle);
    for (int samples = 1; samples <= 4; samples++)
        for (int i = 0; i < 3; i++) {
            const imk_strapdown strapdown = exact_run_of(&motion, seconds, rates[i], 0.0, samples);
            const imk_navigation_state truth = exact_state(&motion, seconds);
            const imk_vector3 off = imk_quaternion_rotate(
                imk_quaternion_conjugate(exact_axes(&motion)),
                imk_vector3_subtract(strapdown.state.velocity, truth.velocity));
            const double expected = rock * sway * w / (sb * sb) *
                                    coning_drift(samples, w / rates[i]) * rates[i] * seconds;
            print_message("sculling, %d samples at %g Hz: %.4g m/s in %g s, expected %.4g\n",
                          samples, rates[i], off.v[2], seconds, expected);
            CHECK_CLOSE(off.v[2], expected, 1e-3 * fabs(expected) + 1e-9);
        }
}

/* A pendulum of 2 m that swings by 10 deg at 0.5 Hz: sculling and scrolling, and an axis fixed in
 * the body. */
static exact_instant swing_at(double time)
{
    double theta[3] = {0};
    exact_wave(10.0 * degree, 0.0, pi, time, theta);
    const double length = 2.0, s = imk_sin(theta[0]), c = imk_cos(theta[0]);
    const double across = length * theta[1], bend = length * theta[1] * theta[1];
    return (exact_instant){
        .position = {{length * s, 0.0, length * c}},
        .velocity = {{across * c, 0.0, -across * s}},
        .acceleration = {{length * theta[2] * c - bend * s, 0.0,
                          -length * theta[2] * s - bend * c}},
        .attitude = imk_quaternion_from_rotation_vector((imk_vector3){{0.0, theta[0], 0.0}}),
        .rate = {{0.0, theta[1], 0.0}}};
}

/* A lively drive: 20 m/s over hills and bends, rolling and pitching at 0.7 and 0.9 Hz, wheels that
 * bounce at 1.5 Hz. */
static exact_instant drive_at(double time)
{
    double axis[3][3] = {{0}}, angle[3][3] = {{0}};
    exact_wave(400.0, 0.0, 2 * pi / 140, time, axis[0]);
    exact_wave(0.0, 250.0, 2 * pi / 95, time, axis[1]);
    exact_wave(0.0, -15.0, 2 * pi / 60, time, axis[2]);
    exact_wave(0.01, 0.0, 2 * pi * 1.5, time, axis[2]);
    exact_wave(0.0, 0.03, 2 * pi * 0.7, time, angle[0]);
    exact_wave(0.02, 0.01, 2 * pi * 0.9, time, angle[1]);
    exact_wave(0.0, 1.6, 2 * pi / 30, time, angle[2]);
    exact_wave(0.3, 0.0, 2 * pi / 8, time, angle[2]);
    exact_instant now = {0};
    double euler[3], rate[3];
    for (int i = 0; i < 3; i++) {
        now.position.v[i] = axis[i][0];
        now.velocity.v[i] = axis[i][1];
        now.acceleration.v[i] = axis[i][2];
        euler[i] = angle[i][0];
        rate[i] = angle[i][1];
    }
    now.attitude = imk_quaternion_from_matrix(imk_matrix3_from_euler(euler[0], euler[1], euler[2]));
    now.rate = exact_euler_rate(euler, rate);
    return now;
}

/* A minute of swinging at 100 Hz. What is left of sculling is a force of fourth order in the phase
 * per sample, x = 0.031, some x^4 g/30 of it: 3e-7 m/s^2 at most, and less as it changes its sign.
 */
static void test_swing(void **state)
{
    (void)state;
    const exact_motion motion = {places[0], swing_at};
    const imk_strapdown strapdown = exact_run(&motion, 60.0, 100.0, 0.0);
    const imk_navigation_state truth = exact_state(&motion, 60.0);
    const exact_error error = exact_compare(&strapdown.state, &truth);
    report("swing, 60 s", error);
    CHECK_BELOW(error.position, 1e-4);
    CHECK_BELOW(error.attitude, 1e-11);
}

/* Ten minutes of it, at 45 deg, a pole and across 180 deg of longitude: below a millimetre at
 * 100 Hz, with less than a nanoradian of tilt. */
static void test_drive(void **state)
{
    (void)state;
    for (int i = 0; i < 3; i++) {
        const exact_motion motion = {places[i], drive_at};
        const imk_strapdown strapdown = exact_run(&motion, 600.0, 100.0, 0.0);
        const imk_navigation_state truth = exact_state(&motion, 600.0);
        const exact_error error = exact_compare(&strapdown.state, &truth);
        report("drive, 600 s", error);
        CHECK_BELOW(error.position, 1e-3);
        CHECK_BELOW(error.velocity, 3e-6);
        CHECK_BELOW(error.attitude, 1e-9);
    }
}

/* With one, two, three and four samples the attitude is of second to fifth order. So is the
 * position, but that with four it keeps the terms of third order in the angle, of fourth in the
 * interval, and only they get ten times smaller. The slopes are between 25 and 50 Hz. Unequal
 * intervals, every other one half as long again, lose no order. */
static void test_orders(void **state)
{
    (void)state;
    const exact_motion motion = {places[0], drive_at};
    const double seconds = 60.0;
    const imk_navigation_state truth = exact_state(&motion, seconds);
    for (int uneven = 0; uneven < 2; uneven++) {
        double parabola = 0.0;
        for (int samples = 1; samples <= 4; samples++) {
            exact_error error[2];
            for (int i = 0; i < 2; i++) {
                const imk_strapdown strapdown =
                    exact_run_of(&motion, seconds, i == 0 ? 25 : 50, uneven ? 0.2 : 0.0, samples);
                error[i] = exact_compare(&strapdown.state, &truth);
                report(uneven ? "uneven" : "even", error[i]);
            }
            const double order = samples + 1.0;
            CHECK_CLOSE(log2(error[0].attitude / error[1].attitude), order, 0.25);
            if (samples < 4)
                CHECK_CLOSE(log2(error[0].position / error[1].position), order, 0.25);
            if (samples == 3)
                parabola = error[1].position;
            if (samples == 4)
                CHECK_BELOW(error[1].position, parabola / 6);
        }
    }
}

/* The slaved vertical: the height and the climb that are asked for, in each step and at the place
 * reached, also at a pole, whatever the accelerometers say; the rest as without. */
static void test_slaved_climb(void **state)
{
    (void)state;
    for (int i = 0; i < PLACES; i++) {
        const imk_navigation_state start = imk_navigation_state_ned(
            0.0, places[i], (imk_vector3){{30.0, -40.0, 0.0}}, imk_matrix3_identity());
        imk_strapdown strapdown = imk_strapdown_start(&start);
        strapdown.hold_height = true;
        CHECK_CLOSE(strapdown.height, places[i].height, 5e-9);
        CHECK_CLOSE(strapdown.climb, 0.0, 0.0);
        for (int k = 1; k <= 1000; k++) {
            strapdown.height = places[i].height + 0.02 * k;
            strapdown.climb = 2.0;
            imk_strapdown_step(&strapdown, 0.01, (imk_vector3){{1e-4, 2e-4, -3e-4}},
                               (imk_vector3){{0.01, -0.02, -0.3}});
            const imk_geodetic place = imk_geodetic_from_ecef(strapdown.state.position);
            const imk_matrix3 axes = imk_ned_axes(place.latitude, place.longitude);
            double down = 0.0;
            for (int row = 0; row < 3; row++)
                down += axes.m[row][2] * strapdown.state.velocity.v[row];
            CHECK_CLOSE(place.height, strapdown.height, 5e-9);
            CHECK_CLOSE(down, -2.0, 1e-13);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_states_in_local_axes),
        cmocka_unit_test(test_small_differences),
        cmocka_unit_test(test_simple_step_is_exact),
        cmocka_unit_test(test_inverse),
        cmocka_unit_test(test_second_order),
        cmocka_unit_test(test_rest),
        cmocka_unit_test(test_creep),
        cmocka_unit_test(test_coning),
        cmocka_unit_test(test_sculling),
        cmocka_unit_test(test_swing),
        cmocka_unit_test(test_drive),
        cmocka_unit_test(test_orders),
        cmocka_unit_test(test_slaved_climb),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
