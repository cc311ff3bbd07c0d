/* SPDX-License-Identifier: Apache-2.0 */
/* Touch-down of the suspended ball: at which force it falls and is lifted, how fast, how it runs
 * down, against closed forms by energy and by the torque of friction; both levels. */
#include "instrument_run.h"

#include "imukit/suspended_rotor.h"

static const double gravity = 9.80665, pi = 3.14159265358979323846;
static const imk_instrument *const gyro = &imk_suspended_rotor_instrument;

/* As the signals stand in its table. */
enum { AXIS_X, AXIS_Y, AXIS_Z, DRIFT, WOBBLE, FALLEN, X, Y, Z, CONTACT, SPIN };

/* Without errors. */
static imk_suspended_rotor ball(void)
{
    imk_suspended_rotor d = imk_suspended_rotor_default();
    d.unbalance = d.oblateness = d.pear = 0.0;
    return d;
}

static void *begun(const imk_suspended_rotor *d, imk_level level, double rate)
{
    imk_physics_settings settings = imk_physics_default();
    settings.level = level;
    settings.rate = rate;
    settings.noise = false;
    return started(gyro, d, &settings);
}

/* `count` samples under a force along x [m/s^2]; the signals at their end. */
static void under(void *state, double force, size_t count, double *signals)
{
    imk_exposure x = imk_exposure_default();
    x.specific_force[0] = force;
    run(gyro, state, &x, count, 0, NULL);
    gyro->observe(state, signals);
}

static bool falls(const imk_suspended_rotor *d, imk_level level, double force)
{
    imk_instrument_event event;
    double signals[IMK_INSTRUMENT_SIGNALS_MAX];
    void *state = begun(d, level, 100.0);
    under(state, force, 5, signals);
    const bool fallen = gyro->happened(state, &event);
    assert_int_equal(fallen, signals[FALLEN] == 1.0);
    free(state);
    return fallen;
}

/* An excess of 1e-9 of the limit grows e-fold in sqrt(gap/(2 limit)) = 0.14 ms, so that 3 ms are
 * enough for it. */
static void falls_beyond_the_limit(void **unused)
{
    (void)unused;
    imk_suspended_rotor d = ball();
    for (int level = 0; level < 2; level++)
        for (int i = 0; i < 3; i++) {
            d.limit = (i == 0 ? 25.0 : i == 1 ? 3.0 : 400.0) * gravity;
            const double force = imk_suspended_rotor_touch_down(&d);
            CHECK_CLOSE(force, d.limit, 0.0);
            assert_false(falls(&d, (imk_level)level, force * (1.0 - 1e-9)));
            assert_true(falls(&d, (imk_level)level, force * (1.0 + 1e-9)));
            assert_true(falls(&d, (imk_level)level, -force * (1.0 + 1e-9)));
        }
}

/* Down it stays until the force is that of the farther electrode, 1/2.25 of the limit; then the
 * control brings it back to the middle, where it stays. */
static void is_lifted(void **unused)
{
    (void)unused;
    imk_suspended_rotor d = ball();
    double signals[IMK_INSTRUMENT_SIGNALS_MAX];
    d.friction = 0.0; /* which would push the ball aside */
    const double force = imk_suspended_rotor_lift_off(&d);
    CHECK_RELATIVE(force, d.limit / 2.25, 1e-15);
    for (int level = 0; level < 2; level++) {
        void *state = begun(&d, (imk_level)level, 100.0);
        under(state, 1.1 * d.limit, 5, signals);
        CHECK_RELATIVE(signals[X], -d.clearance, 1e-12);
        under(state, 1.001 * force, 10, signals);
        CHECK_RELATIVE(signals[X], -d.clearance, 1e-12);
        CHECK_RELATIVE(signals[CONTACT], 0.001 * force * imk_suspended_rotor_mass(&d), 1e-9);
        under(state, 0.999 * force, 10, signals);
        CHECK_CLOSE(signals[X], 0.0, 0.0);
        CHECK_CLOSE(signals[CONTACT], 0.0, 0.0);
        assert_true(signals[FALLEN] == 1.0); /* it has been down */
        under(state, 0.999 * d.limit, 10, signals);
        CHECK_CLOSE(signals[X], 0.0, 0.0);
        free(state);
    }
}

/* Time of the fall, the integral of dx/v with v^2 = 2 (f x - limit gap x/(gap + x)); x = u^2 takes
 * the root out of it. */
static double time_of_fall(const imk_suspended_rotor *d, double force)
{
    enum { PARTS = 20000 };
    const double end = sqrt(d->clearance);
    double sum = 0.0;
    for (int i = 0; i < PARTS; i++) {
        const double u = end * (i + 0.5) / PARTS, x = u * u;
        sum += 2.0 * end / PARTS / sqrt(2.0 * (force - d->limit * d->gap / (d->gap + x)));
    }
    return sum;
}

/* The fall is followed in 16 steps and more: 1 %. The message has the axis, force and limit. */
static void meets_the_stop(void **unused)
{
    (void)unused;
    const imk_suspended_rotor d = ball();
    for (int i = 0; i < 3; i++) {
        const double force = (i == 0 ? 26.0 : i == 1 ? 40.0 : 1000.0) * gravity;
        double signals[IMK_INSTRUMENT_SIGNALS_MAX];
        imk_instrument_event event;
        void *state = begun(&d, IMK_LEVEL_FULL, 100.0);
        under(state, -force, 1, signals);
        assert_true(gyro->happened(state, &event));
        assert_string_equal(event.code, "physics:touched");
        assert_string_equal(event.name, "+x");
        CHECK_RELATIVE(event.number[0], time_of_fall(&d, force), 0.01);
        CHECK_CLOSE(event.number[1], force, 0.0);
        CHECK_RELATIVE(event.number[2], force / gravity, 1e-15);
        CHECK_CLOSE(event.number[3], d.limit, 0.0);
        CHECK_RELATIVE(event.number[5], imk_suspended_rotor_impact(&d, force), 0.01);
        free(state);
    }
    CHECK_CLOSE(imk_suspended_rotor_impact(&d, d.limit), 0.0, 0.0);
}

/* Too much for a tenth of a millisecond: the ball is caught before it is down. */
static void is_caught(void **unused)
{
    (void)unused;
    const imk_suspended_rotor d = ball();
    double signals[IMK_INSTRUMENT_SIGNALS_MAX];
    void *state = begun(&d, IMK_LEVEL_FULL, 10000.0);
    under(state, 26.0 * gravity, 1, signals);
    /* x = (f - limit) (cosh(t/T) - 1) T^2, T^2 = gap/(2 limit), as long as x is small */
    const double square = 0.5 * d.gap / d.limit, t = 1e-4 / sqrt(square);
    CHECK_RELATIVE(signals[X], -gravity * square * (cosh(t) - 1.0), 0.01);
    under(state, 20.0 * gravity, 200, signals);
    CHECK_CLOSE(signals[X], 0.0, 0.0);
    assert_true(signals[FALLEN] == 0.0);
    free(state);
}

/* The spin axis across the force: the spin falls in proportion to time, to nothing; friction turns
 * no axis. Full: the bounces at the start and the push aside, which leans the contact by 0.03. */
static void runs_down(void **unused)
{
    (void)unused;
    const imk_suspended_rotor d = ball();
    const double force = 26.0 * gravity, whole = imk_suspended_rotor_run_down(&d, force);
    /* friction 0.2, radius 5 mm, mass times (26 - 25/2.25) g */
    CHECK_RELATIVE(whole,
                   imk_suspended_rotor_momentum(&d) / (0.2 * 0.005 * imk_suspended_rotor_mass(&d) *
                                                       (26.0 - 25.0 / 2.25) * gravity),
                   1e-12);
    for (int level = 0; level < 2; level++) {
        const double share = level ? 1e-9 : 0.01;
        double signals[IMK_INSTRUMENT_SIGNALS_MAX], out[IMK_INSTRUMENT_OUTPUTS_MAX];
        void *state = begun(&d, (imk_level)level, 100.0);
        under(state, force, 50, signals);
        CHECK_CLOSE(signals[SPIN] / d.spin_rate, 1.0 - 0.5 / whole, share);
        CHECK_CLOSE(signals[AXIS_Z], 1.0, level ? 1e-15 : 1e-9);
        CHECK_RELATIVE(signals[CONTACT],
                       imk_suspended_rotor_mass(&d) * (force - imk_suspended_rotor_lift_off(&d)),
                       share);
        under(state, force, 70, signals);
        CHECK_CLOSE(signals[SPIN], 0.0, 0.0);
        CHECK_CLOSE(signals[DRIFT], 0.0, 0.0);
        /* it lies in the case, and turns with it: no reading, and no number that is none */
        imk_exposure x = imk_exposure_default();
        x.specific_force[0] = force;
        x.angular_rate[0] = x.angular_rate[1] = 1.0;
        gyro->step(state, &x, out);
        gyro->step(state, &x, out);
        CHECK_CLOSE(out[0], 0.0, 1e-12);
        CHECK_CLOSE(out[1], 0.0, 1e-12);
        free(state);
    }
}

/* What is along the normal is left: the axis turns to it, and the spin to cos(tilt) of its own. */
static void keeps_the_spin_along_the_force(void **unused)
{
    (void)unused;
    imk_suspended_rotor d = ball();
    d.start_tilt = pi / 4.0;
    for (int level = 0; level < 2; level++) {
        const double share = level ? 1e-9 : 0.03;
        double signals[IMK_INSTRUMENT_SIGNALS_MAX];
        void *state = begun(&d, (imk_level)level, 100.0);
        under(state, 26.0 * gravity, 200, signals);
        CHECK_CLOSE(signals[SPIN] / d.spin_rate, cos(pi / 4.0), share);
        CHECK_CLOSE(signals[AXIS_X], 1.0, share);
        CHECK_CLOSE(hypot(hypot(signals[AXIS_X], signals[AXIS_Y]), signals[AXIS_Z]), 1.0, 1e-12);
        free(state);
    }
}

/* Any force and stop: numbers stay numbers, and the ball within its stops. */
static void stays_within_its_stops(void **unused)
{
    (void)unused;
    for (int i = 0; i < 24; i++) {
        imk_suspended_rotor d = imk_suspended_rotor_default();
        d.restitution = i % 2 ? 0.95 : 0.0;
        d.friction = i % 3 ? 2.0 : 0.0;
        d.clearance = i % 4 ? d.clearance : 0.99 * d.gap;
        d.start_wobble = 1e-4;
        void *state = begun(&d, (imk_level)(i % 5 == 0), 1000.0);
        double out[IMK_INSTRUMENT_OUTPUTS_MAX], signals[IMK_INSTRUMENT_SIGNALS_MAX];
        for (int k = 0; k < 40; k++) {
            imk_exposure x = imk_exposure_default();
            const double size = pow(10.0, 1.0 + i % 6);
            for (int a = 0; a < 3; a++) {
                x.specific_force[a] = size * sin(1.7 * k + 2.0 * a + i);
                x.angular_rate[a] = 10.0 * cos(0.3 * k + a);
            }
            gyro->step(state, &x, out);
            gyro->observe(state, signals);
            for (size_t o = 0; o < gyro->output_count; o++)
                assert_true(isfinite(out[o]));
            for (size_t o = 0; o < gyro->signal_count; o++)
                assert_true(isfinite(signals[o]));
            CHECK_BELOW(hypot(hypot(signals[X], signals[Y]), signals[Z]),
                        d.clearance * (1.0 + 1e-12));
            CHECK_BELOW(signals[SPIN], d.spin_rate * (1.0 + 1e-12));
        }
        free(state);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(falls_beyond_the_limit),
        cmocka_unit_test(is_lifted),
        cmocka_unit_test(meets_the_stop),
        cmocka_unit_test(is_caught),
        cmocka_unit_test(runs_down),
        cmocka_unit_test(keeps_the_spin_along_the_force),
        cmocka_unit_test(stays_within_its_stops),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
