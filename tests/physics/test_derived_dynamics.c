/* SPDX-License-Identifier: Apache-2.0 */
/* Derived quantities against runs of the full dynamics: what a table says of a design is what the
 * instrument does. */
#include "instrument_run.h"

#include "imukit/physics.h"

static const double pi = 3.14159265358979324;

static double derived(const imk_instrument *instrument, const void *design, const char *name)
{
    const imk_derived *row = imk_instrument_derived(instrument, name);
    assert_non_null(row);
    return imk_derived_value(row, design);
}

static imk_physics_settings quiet(double rate)
{
    imk_physics_settings settings = imk_physics_default();
    settings.rate = rate;
    settings.noise = false;
    return settings;
}

static imk_exposure turning(double x)
{
    imk_exposure exposure = imk_exposure_default();
    exposure.angular_rate[0] = x;
    return exposure;
}

static imk_exposure pushed(double x)
{
    imk_exposure exposure = imk_exposure_default();
    exposure.specific_force[0] = x;
    return exposure;
}

/* A signal behind each of `count` samples. */
static void watch(const imk_instrument *instrument, const void *design, double rate,
                  const imk_exposure *exposure, size_t count, int signal, double *values)
{
    const imk_physics_settings settings = quiet(rate);
    double signals[IMK_INSTRUMENT_SIGNALS_MAX];
    void *state = started(instrument, design, &settings);
    for (size_t i = 0; i < count; i++) {
        run(instrument, state, exposure, 1, 0, NULL);
        instrument->observe(state, signals);
        values[i] = signals[signal];
    }
    free(state);
}

/* Mean frequency between the first and the last upward crossing of the mean [Hz]. */
static double frequency_of(double rate, size_t count, const double *values)
{
    double mean = 0.0, first = -1.0, last = 0.0;
    int cycles = -1;
    for (size_t i = 0; i < count; i++)
        mean += values[i] / (double)count;
    for (size_t i = 1; i < count; i++)
        if (values[i - 1] < mean && values[i] >= mean) {
            last = (double)i - (values[i] - mean) / (values[i] - values[i - 1]);
            first = first < 0.0 ? last : first;
            cycles++;
        }
    return cycles > 0 ? cycles * rate / (last - first) : 0.0;
}

enum { SAMPLES = 4000 };
static double values[SAMPLES];

static void nutation_and_precession(void **state)
{
    (void)state;
    const imk_instrument *gyro = &imk_free_gyro_instrument;
    imk_free_gyro d = imk_free_gyro_default();
    d.viscous_friction = d.coulomb_friction = 0.0;
    const imk_exposure rest = imk_exposure_default();
    watch(gyro, &d, 20e3, &rest, SAMPLES, 1, values);
    /* ten steps to a cycle: 0.1 % of the frequency by the integrator */
    CHECK_RELATIVE(frequency_of(20e3, SAMPLES, values), derived(gyro, &d, "nutation frequency"),
                   1e-3);
    d.start_nutation = d.pickoff_resolution = 0.0;
    d.torque_inner = 1e-6;
    const imk_physics_settings settings = quiet(10.0);
    CHECK_RELATIVE(mean_of(gyro, &d, &settings, &rest, 0, 10, 0),
                   1e-6 * derived(gyro, &d, "precession per torque"), 1e-6);
}

/* A gimbal that is released swings, and its angle by a rate is what the table says. */
static void gimbal_swings(void **state)
{
    (void)state;
    const imk_instrument *gyro = &imk_rate_gyro_instrument;
    imk_rate_gyro d = imk_rate_gyro_default();
    d.torque = (imk_error_torque){0};
    const imk_exposure slow = turning(0.01);
    watch(gyro, &d, 1000.0, &slow, SAMPLES, 0, values);
    CHECK_RELATIVE(values[SAMPLES - 1], 0.01 * derived(gyro, &d, "gimbal angle per rate"), 1e-6);
    d.damping = 0.0;
    watch(gyro, &d, 1000.0, &slow, SAMPLES, 0, values);
    CHECK_RELATIVE(frequency_of(1000.0, SAMPLES, values), derived(gyro, &d, "natural frequency"),
                   1e-4);
}

/* Without a loop the float turns by H/C of the case's angle, a time constant late. */
static void float_integrates(void **state)
{
    (void)state;
    const imk_instrument *gyro = &imk_rate_integrating_gyro_instrument;
    imk_rate_integrating_gyro d = imk_rate_integrating_gyro_default();
    d.rebalance = IMK_REBALANCE_OPEN;
    d.torque = (imk_error_torque){0};
    d.damping = 0.02;
    const double w = 1e-4, time = 2.0;
    const imk_exposure slow = turning(w);
    watch(gyro, &d, 1000.0, &slow, 2000, 0, values);
    CHECK_RELATIVE(values[1999],
                   derived(gyro, &d, "gyro gain") * w *
                       (time - derived(gyro, &d, "float time constant")),
                   1e-6);
}

/* Held at an offset of its pickoff, the rotor drifts by the residual spring, and not when the shaft
 * turns at the tuned speed. */
static void tuned_speed_frees_the_rotor(void **state)
{
    (void)state;
    const imk_instrument *gyro = &imk_tuned_gyro_instrument;
    imk_tuned_gyro d = imk_tuned_gyro_default();
    d.torque = (imk_error_torque){0};
    d.hinge_damping = d.pickoff_offset_x = 0.0;
    d.pickoff_offset_y = 1e-3;
    d.stiffness_x *= 1.2; /* another tuned speed than the default's 200 Hz */
    d.loop_frequency = 1.0;
    d.loop_damping = 1.0;
    d.loop_filter = 30.0; /* slow against the motion at 2N */
    const double tuned = derived(gyro, &d, "tuned speed, exact") / (2.0 * pi);
    const imk_exposure rest = imk_exposure_default();
    imk_physics_settings settings = quiet(100.0);
    CHECK_BELOW(0.04, tuned / 200.0 - 1.0);
    d.spin_frequency = tuned * 1.01;
    const double drift = 1e-3 * derived(gyro, &d, "drift per tilt by the residual spring");
    const double away = mean_of(gyro, &d, &settings, &rest, 1000, 200, 0);
    CHECK_RELATIVE(away, drift, 2e-3);
    d.spin_frequency = tuned;
    CHECK_CLOSE(mean_of(gyro, &d, &settings, &rest, 1000, 200, 0), 0.0, 2e-3 * fabs(drift));
}

/* A ball at rest that hangs between two unequal pairs of electrodes. */
static void preloads_turn_the_ball(void **state)
{
    (void)state;
    const imk_instrument *gyro = &imk_suspended_rotor_instrument;
    imk_suspended_rotor d = imk_suspended_rotor_default();
    d.start_tilt = 0.25 * pi;
    d.readout_resolution = 0.0;
    const imk_exposure rest = imk_exposure_default();
    const imk_physics_settings settings = quiet(1.0);
    /* s goes along y; the rate that this looks like is across s and y, half of it about x */
    CHECK_RELATIVE(sqrt(2.0) * fabs(mean_of(gyro, &d, &settings, &rest, 0, 10, 0)),
                   derived(gyro, &d, "drift by unequal preloads, spin axis between x and z"), 1e-4);
}

/* The counters of both optical gyros count what the table says. */
static void light_is_counted(void **state)
{
    (void)state;
    imk_ring_laser ring = imk_ring_laser_default();
    ring.lock_in.rate = ring.dither.rate = 0.0;
    const imk_exposure turn = turning(0.1);
    const imk_physics_settings second = quiet(1.0), tenth = quiet(10.0);
    const imk_instrument *laser = &imk_ring_laser_instrument, *fibre = &imk_fibre_optic_instrument;
    const double counts = 0.1 * derived(laser, &ring, "counts per angle");
    CHECK_CLOSE(mean_of(laser, &ring, &second, &turn, 0, 1, 1), counts, 1.0);
    imk_fibre_optic coil = imk_fibre_optic_default();
    const double resets = 0.1 * derived(fibre, &coil, "resets of the ramp per rate");
    /* whole resets of a tenth of a second */
    CHECK_CLOSE(fabs(mean_of(fibre, &coil, &tenth, &turn, 1, 1, 1)), resets, 10.0);
    /* an open loop cannot tell rates a fringe apart */
    coil.loop = IMK_FIBRE_OPTIC_OPEN;
    const double fringe = derived(fibre, &coil, "rate of a fringe");
    coil.range = 0.2 * fringe;
    const imk_exposure here = turning(0.05), there = turning(0.05 + fringe);
    CHECK_CLOSE(mean_of(fibre, &coil, &tenth, &there, 1, 1, 0),
                mean_of(fibre, &coil, &tenth, &here, 1, 1, 0), 1e-6);
}

/* Amplitudes of the sense motion of a fork per rate, and of a free shell after a time constant. */
static void shapes_vibrate(void **state)
{
    (void)state;
    const imk_instrument *fork = &imk_tuning_fork_instrument, *shell = &imk_shell_gyro_instrument;
    imk_tuning_fork d = imk_tuning_fork_default();
    d.quadrature = d.damping_coupling = d.drive.force_angle = 0.0;
    const double gain = derived(fork, &d, "Coriolis gain, sense motion per rate");
    const imk_exposure turn = turning(1.0);
    double largest = 0.0;
    watch(fork, &d, 100e3, &turn, SAMPLES, 1, values); /* 40 ms: the loops have settled by 20 */
    for (size_t i = SAMPLES / 2; i < SAMPLES; i++)
        largest = fmax(largest, fabs(values[i]));
    CHECK_RELATIVE(largest, gain, 5e-3); /* samples of 7 to a cycle: their largest */
    imk_shell_gyro ring = imk_shell_gyro_default();
    ring.mode = IMK_SHELL_FREE;
    ring.pattern.angle = ring.anisotropy.damping_angle;
    ring.anisotropy.frequency_split = 0.0;
    ring.anisotropy.damping_difference = 2.0;
    const double tau = derived(shell, &ring, "decay time along the axis of most damping");
    const imk_exposure rest = imk_exposure_default();
    watch(shell, &ring, 1000.0, &rest, 101, 2, values);
    CHECK_RELATIVE(log(values[0] / values[100]), 0.1 / tau, 1e-4);
}

/* Displacements and slopes per force of the accelerometers. */
static void masses_yield(void **state)
{
    (void)state;
    const double small = 0.01;
    const imk_exposure up = pushed(small), down = pushed(-small);
    const imk_instrument *mems = &imk_mems_accelerometer_instrument;
    imk_mems_accelerometer d = imk_mems_accelerometer_default();
    d.plates = IMK_MEMS_SINGLE; /* at 59 % of pull-in, which draws the mass out of the middle */
    d.voltage = 3.0;
    d.range = 0.0;
    watch(mems, &d, 1000.0, &up, 100, 0, values);
    const double lower = values[99];
    watch(mems, &d, 1000.0, &down, 100, 0, values);
    CHECK_RELATIVE((values[99] - lower) / (2.0 * small),
                   derived(mems, &d, "displacement per specific force"), 1e-5);
    const imk_instrument *servo = &imk_pendulous_servo_instrument;
    imk_pendulous_servo p = imk_pendulous_servo_default();
    p.integral = p.hinge_torque = p.misalignment_y = p.misalignment_z = 0.0;
    watch(servo, &p, 1000.0, &up, 100, 0, values);
    CHECK_RELATIVE(values[99],
                   small * derived(servo, &p, "angle per specific force, before the integral acts"),
                   1e-5);
    const imk_instrument *beams = &imk_vibrating_beam_instrument;
    imk_vibrating_beam b = imk_vibrating_beam_default();
    b.clock = 0.0;
    const imk_physics_settings settings = quiet(100.0);
    const double pulled[2] = {mean_of(beams, &b, &settings, &up, 10, 10, 1),
                              mean_of(beams, &b, &settings, &down, 10, 10, 1)};
    CHECK_RELATIVE((pulled[0] - pulled[1]) / (2.0 * small),
                   derived(beams, &b, "frequency per specific force, first beam"), 1e-4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nutation_and_precession), cmocka_unit_test(gimbal_swings),
        cmocka_unit_test(float_integrates),        cmocka_unit_test(tuned_speed_frees_the_rotor),
        cmocka_unit_test(preloads_turn_the_ball),  cmocka_unit_test(light_is_counted),
        cmocka_unit_test(shapes_vibrate),          cmocka_unit_test(masses_yield),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
