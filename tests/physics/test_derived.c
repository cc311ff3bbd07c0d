/* SPDX-License-Identifier: Apache-2.0 */
/* The derived quantities of the default designs, each against arithmetic on the numbers that
 * `imukit physics NAME` prints, in SI, or against a number that another program found another way
 * (said there). Every row of every table must be met. */
#include "check.h"

#include "imukit/physics.h"
#include "imukit/units.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979324
static const double deg = PI / 180.0, earth = 7.292115e-5, c = 299792458.0;
static const double k_b = 1.380649e-23, room = 293.15;

typedef struct due_row {
    const char *name;
    double value; /* NaN: this design has none */
} due_row;

static size_t rows_of(const imk_instrument *instrument)
{
    size_t count = 0;
    while (instrument->derived[count].name)
        count++;
    return count;
}

static void check_rows(const imk_instrument *instrument, const void *design, size_t count,
                       const due_row *due)
{
    for (size_t i = 0; i < count; i++) {
        const imk_derived *row = imk_instrument_derived(instrument, due[i].name);
        const double value = row ? imk_derived_value(row, design) : (double)NAN;
        /* six digits: what is printed; a difference of two nearly equal ones has fewer */
        const bool right =
            row && (isnan(due[i].value) ? isnan(value) && row->absent
                                        : fabs(value - due[i].value) <= 2e-6 * fabs(due[i].value));
        if (!right) {
            print_error("%s: %s is %.9g, due %.9g\n", instrument->name, due[i].name, value,
                        due[i].value);
            fail();
        }
    }
}

/* All rows of the default design. */
static void check_all(const imk_instrument *instrument, size_t count, const due_row *due)
{
    void *design = malloc(instrument->design_size);
    assert_non_null(design);
    instrument->set_default(design);
    assert_int_equal(count, rows_of(instrument));
    check_rows(instrument, design, count, due);
    free(design);
}

#define CHECK_ALL(instrument, due) check_all(&(instrument), sizeof(due) / sizeof(due)[0], due)
#define CHECK_ROWS(instrument, design, due)                                                        \
    check_rows(&(instrument), design, sizeof(due) / sizeof(due)[0], due)

/* ---- spinning wheels ------------------------------------------------------------------------- */

static void free_gyro(void **state)
{
    (void)state;
    const double h = 4.2e-5 * 22550.0 * 2.0 * PI / 60.0;
    /* A = 2.6e-5 + 1.5e-5, B = 2.6e-5 + 1.2e-5, C = 1.5e-5, Ao = 2e-5 */
    const double amplitude = 15.0 / 3600.0 * deg, half = sqrt(0.5),
                 j = 2e-5 + 0.5 * (4.1e-5 + 1.5e-5);
    const due_row rows[] = {
        {"angular momentum", h},
        {"precession per torque", 1.0 / h},
        {"nutation frequency", h / (2.0 * PI * sqrt((4.1e-5 + 2e-5) * 3.8e-5))},
        {"gimbal walk at 45 deg, after the start's nutation",
         -amplitude * amplitude * h * half * (2e-5 + 1.5e-5) / (2.0 * j * j)},
        {"mass unbalance drift, force along x", -0.25 * 0.2e-6 / h},
        {"mass unbalance drift, force along z", 0.25 * 0.1e-6 / h},
        {"anisoelastic drift", 0.25 * 0.25 * 6e-9 / h},
        {"drift by bearing friction", 2e-6 / h},
        {"apparent drift at latitude 45 deg", earth * half},
        {"torque to precess it at Earth's rate", earth * h},
    };
    CHECK_ALL(imk_free_gyro_instrument, rows);
}

static void rate_gyro(void **state)
{
    (void)state;
    const double z = 5.94e-4 / (2.0 * sqrt(0.08 * 2.25e-6)), q = 1.0 - 2.0 * z * z;
    const double f = sqrt(0.08 / 2.25e-6) / (2.0 * PI);
    const due_row rows[] = {
        {"angular momentum", 1e-3},
        {"gimbal angle per rate", 1e-3 / 0.08},
        {"rate at the stop", 3.0 * deg * 0.08 / 1e-3},
        {"natural frequency", f},
        {"damping ratio", z},
        {"bandwidth (-3 dB)", f * sqrt(q + sqrt(q * q + 1.0))},
        {"drift per torque", 1e3},
        {"mass unbalance drift, force along x", -0.03 * 50e-9 / 1e-3},
        {"mass unbalance drift, force along z", 0.03 * 30e-9 / 1e-3},
        {"anisoelastic drift", 0.03 * 0.03 * 10e-9 / 1e-3},
        {"anisoinertia error", 0.3e-6 / 1e-3},
        {"output-axis acceleration error", 2.25e-6 / 1e-3},
    };
    CHECK_ALL(imk_rate_gyro_instrument, rows);
}

static void rate_integrating_gyro(void **state)
{
    (void)state;
    const due_row rows[] = {
        {"angular momentum", 0.04},
        {"gyro gain", 1.0},
        {"float time constant", 6.4e-5 / 0.04},
        {"input angle at the stop", deg},
        {"drift per torque", 25.0},
        {"elastic restraint drift", 0.0},
        {"time constant of the elastic restraint", (double)NAN},
        {"largest rate of the torquer", 0.0215 / 0.04},
        {"pulse weight", (double)NAN},
        {"torque per float angle of the loop", 2.0 * 2.5 * 2.0 * PI * 4.0 * 0.04},
        /* bisection of |(K1 s + K2)/(I s^3 + C s^2 + K1 s + K2)|^2 = 1/2 in Python */
        {"bandwidth (-3 dB)", 25.523947348},
        {"mass unbalance drift, force along x", -0.3 * 3e-9 / 0.04},
        {"mass unbalance drift, force along z", 0.3 * 2e-9 / 0.04},
        {"anisoelastic drift", 0.09 * 0.5e-9 / 0.04},
        {"anisoinertia error", 8e-6 / 0.04},
        {"output-axis acceleration error", 6.4e-5 / 0.04},
    };
    CHECK_ALL(imk_rate_integrating_gyro_instrument, rows);
    imk_rate_integrating_gyro d = imk_rate_integrating_gyro_default();
    d.rebalance = IMK_REBALANCE_BINARY;
    d.stiffness = 1e-3;
    const due_row pulses[] = {
        {"pulse weight", 0.0215 / (0.04 * 6400.0)},
        {"elastic restraint drift", 1e-3 / 0.04},
        {"time constant of the elastic restraint", 0.04 / 1e-3},
        {"torque per float angle of the loop", (double)NAN},
        {"bandwidth (-3 dB)", (double)NAN},
    };
    CHECK_ROWS(imk_rate_integrating_gyro_instrument, &d, pulses);
    d.rebalance = IMK_REBALANCE_OPEN;
    const due_row open[] = {
        {"largest rate of the torquer", (double)NAN},
        {"bandwidth (-3 dB)", 0.04 / (2.0 * PI * 6.4e-5)},
    };
    CHECK_ROWS(imk_rate_integrating_gyro_instrument, &d, open);
}

/* Momentum, exact tuned speed and residual spring: harmonic balance of the two equations of
 * tuned_gyro.h in Python, a 2 x 2 complex system at the frequency N (a constant tilt in the case),
 * solved for the torque per tilt and per rate; the speed where the first is 0. */
static void tuned_gyro(void **state)
{
    (void)state;
    const double h = 0.0101527908, n = 2.0 * PI * 200.0, j = 0.4e-7;
    const due_row rows[] = {
        {"angular momentum", h},
        {"tuned speed, first order", sqrt(2.0 * 0.03131956290729738 / j)},
        {"tuned speed, exact", n},
        {"figure of merit", 200.0},
        {"time constant", h / (n * 8e-8)},
        {"drift per tilt by damping", n * 8e-8 / h},
        {"nutation frequency", h / (4.65e-6 * 2.0 * PI)},
        {"twice the spin frequency", 400.0},
        {"drift per torque", 1.0 / h},
        {"mass unbalance drift, force along x", -0.04 * 1e-7 / h},
        {"quadrature unbalance drift, force along y", 0.04 * 0.2e-7 / h},
        {"anisoelastic drift", 0.0016 * 5e-9 / h},
        {"largest rate of the torquer", 0.0177 / h},
        /* bisection of |L/(1 + L)|^2 = 1/2, L with its Butterworth filter, in Python */
        {"loop bandwidth (-3 dB)", 28.453701502},
    };
    imk_tuned_gyro d = imk_tuned_gyro_default();
    CHECK_ROWS(imk_tuned_gyro_instrument, &d, rows);
    const imk_instrument *gyro = &imk_tuned_gyro_instrument;
    assert_int_equal(rows_of(gyro), sizeof rows / sizeof rows[0] + 4); /* below */
    const double mistuning = imk_derived_value(imk_instrument_derived(gyro, "mistuning"), &d);
    CHECK_CLOSE(mistuning, 0.0, 1e-12);
    CHECK_CLOSE(imk_derived_value(imk_instrument_derived(gyro, "residual spring"), &d), 0.0, 1e-15);
    /* the leading term, J N/(8 H), is within 2 % here: its next is J/(2A - C) */
    CHECK_RELATIVE(
        imk_derived_value(imk_instrument_derived(gyro, "drift by angular vibration at 2N"), &d),
        j * n / (8.0 * h), 0.02);
    d.speed_error = 1e-3;
    const due_row fast[] = {
        {"mistuning", 1e-3},
        {"residual spring", -6.267479682e-5},
        {"drift per tilt by the residual spring", -6.267479682e-5 / 0.01016294256},
    };
    CHECK_ROWS(imk_tuned_gyro_instrument, &d, fast);
    d.captured = false;
    d.hinge_damping = 0.0;
    const due_row free_rotor[] = {
        {"time constant", (double)NAN},
        {"largest rate of the torquer", (double)NAN},
        {"loop bandwidth (-3 dB)", (double)NAN},
    };
    CHECK_ROWS(imk_tuned_gyro_instrument, &d, free_rotor);
}

static void suspended_rotor(void **state)
{
    (void)state;
    const double m = PI / 6.0 * 1e-6 * 1848.0, spin = 2500.0 * 2.0 * PI, limit = 25.0 * 9.80665;
    const double inertia = 0.4 * m * 25e-6 * 3.0 * 1.02 / 3.02, h = inertia * spin;
    const due_row rows[] = {
        {"mass", m},
        {"polar moment of inertia", inertia},
        {"angular momentum", h},
        {"rim speed", 0.005 * spin},
        {"free nutation frequency", 2550.0},
        {"drift per torque", 1.0 / h},
        {"mass unbalance drift, force across the spin axis", m * 1e-9 / h},
        {"preload of a pair of electrodes", 0.5 * m * limit},
        {"touch-down force", m * limit},
        {"drift by unequal preloads, spin axis between x and z",
         1.5 * 20e-9 * 0.5 * m * limit * 1e-3 / h},
    };
    CHECK_ALL(imk_suspended_rotor_instrument, rows);
}

/* ---- light ----------------------------------------------------------------------------------- */

static void fibre_optic(void **state)
{
    (void)state;
    const double scale = 2.0 * PI * 1000.0 * 0.32 / (1.55e-6 * c), tau = 1.45 * 1000.0 / c;
    const double reset = 1.55e-6 * 1.45 / 0.32;
    const due_row rows[] = {
        {"number of turns", 1000.0 / (PI * 0.32)},
        {"enclosed area", 1000.0 * 0.32 / 4.0},
        {"Sagnac time delay at 1 deg/s", 320.0 * deg / (c * c)},
        {"Sagnac phase per rate", scale},
        {"rate of a fringe", 2.0 * PI / scale},
        {"unambiguous rate, either way", PI / scale},
        {"transit time", tau},
        {"proper (eigen) frequency", 0.5 / tau},
        {"angle between two resets of the ramp", reset},
        {"resets of the ramp per rate", 1.0 / reset},
        {"angle of a count", reset / 1024.0},
        {"counts per rate", 1024.0 / reset},
        {"power on a bright fringe", 1e-3 * pow(10.0, -1.4)}, /* 13 dB and 1 dB of fibre */
        {"coherence length of the source", 1.55e-6 * 1.55e-6 / 19.35e-9},
        {"Shupe error per rate of temperature", 0.01 * 1.45 * 1e-5 * 1000.0 / (4.0 * 0.32)},
        {"effective loop gain", 0.1},
        {"loop bandwidth (-3 dB)", asin(0.1 / sqrt(4.0 * 0.9)) / (2.0 * PI * tau)},
    };
    CHECK_ALL(imk_fibre_optic_instrument, rows);
    imk_fibre_optic d = imk_fibre_optic_default();
    d.loop = IMK_FIBRE_OPTIC_OPEN;
    d.output_bits = 0;
    const due_row open[] = {
        {"resets of the ramp per rate", (double)NAN},
        {"angle of a count", (double)NAN},
        {"counts per rate", (double)NAN},
        {"effective loop gain", (double)NAN},
        {"loop bandwidth (-3 dB)", (double)NAN},
    };
    CHECK_ROWS(imk_fibre_optic_instrument, &d, open);
}

static void ring_laser(void **state)
{
    (void)state;
    const double s = 0.16 / (3.0 * sqrt(3.0) * 632.8e-9), k = 2.0 * PI * s, nu = c / 632.8e-9;
    const double gamma = c * 3e-4 / 0.16, lock_in = 152.5 / 3600.0 * deg;
    const double angle = 150.0 * deg / (2.0 * PI * 517.0), random = 0.02 * k * angle;
    const due_row rows[] = {
        {"enclosed area", 0.16 * 0.16 / (12.0 * sqrt(3.0))},
        {"Sagnac time delay at 1 deg/s", 0.16 * 0.16 / (3.0 * sqrt(3.0)) * deg / (c * c)},
        {"scale factor, beat frequency per rate", s},
        {"angle of a fringe", 1.0 / s},
        {"angle of a count", 0.25 / s},
        {"counts per angle", 4.0 * s},
        {"beat frequency at Earth's rate", s * earth},
        {"transit time of a round trip", 0.16 / c},
        {"free spectral range", c / 0.16},
        {"cavity linewidth", gamma / (2.0 * PI)},
        {"photon lifetime", 1.0 / gamma},
        {"finesse", 2.0 * PI / 3e-4},
        {"quality factor of the cavity", 2.0 * PI * nu / gamma},
        {"lock-in frequency", s * lock_in},
        {"dither amplitude", angle},
        {"dither amplitude as phase of the beat", k * angle},
        {"distance of the lock-in bands", 517.0 / s},
        /* J0(246.4051) = 0.0426561833, the mean of cos(x sin t) over 4000 points, in Python */
        {"lock-in dead band that is left, half width",
         lock_in * 0.0426561833 * exp(-0.5 * random * random)},
        {"angle random walk by lock-in",
         lock_in / sqrt(k * 150.0 * deg) * sqrt(1.0 - exp(-random * random))},
        {"angle random walk by quantum noise",
         gamma / k * sqrt(6.62607015e-34 * nu / (3e-4 * 10e-3))},
        {"change of scale by a mode hop", 632.8e-9 / 0.16},
        {"warming to the first mode hop", 1e-6 / (2e-8 * 0.16)},
    };
    CHECK_ALL(imk_ring_laser_instrument, rows);
    imk_ring_laser d = imk_ring_laser_default();
    d.dither.rate = 0.0;
    d.path_length.expansion = 0.0;
    d.cavity.shape = IMK_RING_LASER_SQUARE;
    d.readout.decoding = IMK_RING_LASER_HALVES;
    const due_row still[] = {
        {"enclosed area", 0.04 * 0.04},
        {"angle of a count", 0.5 * 4.0 * 632.8e-9 / 0.16},
        {"dither amplitude", (double)NAN},
        {"dither amplitude as phase of the beat", (double)NAN},
        {"distance of the lock-in bands", (double)NAN},
        {"lock-in dead band that is left, half width", lock_in},
        {"angle random walk by lock-in", (double)NAN},
        {"warming to the first mode hop", (double)NAN},
    };
    CHECK_ROWS(imk_ring_laser_instrument, &d, still);
}

/* ---- vibration ------------------------------------------------------------------------------- */

static void tuning_fork(void **state)
{
    (void)state;
    const double wd = 2.0 * PI * 14e3, ws = 2.0 * PI * 15e3, m = 4e-9, x0 = 5e-6;
    const due_row rows[] = {
        {"drive frequency", 14e3},
        {"sense frequency", 15e3},
        {"frequency split", 1e3},
        {"stiffness of the drive mode", m * wd * wd},
        {"stiffness of the sense mode", m * ws * ws},
        {"decay time constant of the drive mode", 90.0 / wd},
        {"decay time constant of the sense mode", 90.0 / ws},
        {"peak speed of the drive motion", x0 * wd},
        {"Coriolis acceleration per rate", 2.0 * x0 * wd},
        {"Coriolis force per rate", 2.0 * m * x0 * wd},
        {"Coriolis gain, sense motion per rate",
         2.0 * x0 * wd / hypot(ws * ws - wd * wd, wd * ws / 45.0)},
        {"force that holds the drive amplitude", m * wd * wd * x0 / 45.0},
        /* bisection of |G|^2 = 2 (it peaks at 9.7) in Python */
        {"bandwidth of the sense mode (3 dB)", 567.8239431},
        {"angle random walk by Brownian motion", sqrt(k_b * room * ws / (m * 45.0)) / (x0 * wd)},
    };
    CHECK_ALL(imk_tuning_fork_instrument, rows);
    imk_tuning_fork d = imk_tuning_fork_default();
    d.sense.loop = IMK_TUNING_FORK_CLOSED;
    const due_row closed[] = {{"bandwidth of the sense mode (3 dB)", (double)NAN}};
    CHECK_ROWS(imk_tuning_fork_instrument, &d, closed);
}

static void shell_gyro(void **state)
{
    (void)state;
    const double w = 2.0 * PI * 14e3, tau = 1e4 / w, m = 3.3e-7, a = 5e-6, k = 0.8;
    const due_row rows[] = {
        {"Bryan's factor (angular gain)", 0.4},
        {"modal angle per angle of the case", k},
        {"angle on the shell between the two modes", 45.0 * deg},
        {"frequency of the stiffer mode", 14000.25},
        {"frequency of the softer mode", 13999.75},
        {"decay time constant", tau},
        {"decay time along the axis of most damping", 1.0 / (1.0 / tau + 0.05)},
        {"decay time along the axis of least damping", 1.0 / (1.0 / tau - 0.05)},
        {"width of the resonance", 14e3 / 5e3},
        {"largest drift by unequal damping", 0.1 / (2.0 * k)},
        {"largest quadrature, as a rate", 2.0 * PI * 0.5 / (2.0 * k)},
        {"peak speed of the vibration", a * w},
        {"rebalance force per rate", 2.0 * m * w * a * k},
        {"force that holds the amplitude", 2.0 * m * w * a / tau},
        /* bisection of |x (z + 1)/(2 z (z - 1) + x (z + 1))|^2 = 1/2 in Python, 3500 updates a
         * second, x = 2 p (1 - p)/(1 + p), p = e^(-2 pi 55/3500) */
        {"bandwidth of the rebalance loop (-3 dB)", 54.88184011},
        {"largest rate of the rebalance loop", 1.25e-6 / (2.0 * m * w * a * k)},
        {"angle random walk by Brownian motion", sqrt(k_b * room / (m * w * 5e3)) / (k * a)},
    };
    CHECK_ALL(imk_shell_gyro_instrument, rows);
    imk_shell_gyro d = imk_shell_gyro_default();
    d.mode = IMK_SHELL_WHOLE_ANGLE;
    d.resonator.shape = IMK_SHELL_HEMISPHERE;
    const due_row whole[] = {
        {"Bryan's factor (angular gain)", 0.277},
        {"bandwidth of the rebalance loop (-3 dB)", (double)NAN},
        {"largest rate of the rebalance loop", (double)NAN},
    };
    CHECK_ROWS(imk_shell_gyro_instrument, &d, whole);
}

/* ---- accelerometers -------------------------------------------------------------------------- */

static void mems_accelerometer(void **state)
{
    (void)state;
    const double m = 1.2e-6, w0 = 2.0 * PI * 1800.0, k = m * w0 * w0, eps = 8.8541878128e-12;
    const double gap = 2e-6, ea = eps * 1.6e-6, soft = 2.0 * ea / (gap * gap * gap);
    const due_row rows[] = {
        {"stiffness of the springs", k},
        {"spring softening, mass in the middle", soft},
        {"softening, share of the stiffness", soft / k},
        /* where w0^2 (z - 10 nm) is the plates' pull, by bisection in Python: z = 10.2362 nm */
        {"natural frequency, softened", 1779.10891089},
        {"damping coefficient", m * w0 / 0.7},
        {"damping ratio", 1.0 / 1.4},
        {"decay time constant", 1.4 / w0},
        {"displacement per specific force", 8.00267524952e-9},
        {"capacitance of a plate, mass in the middle", ea / gap},
        {"change of capacitance per specific force", 5.66902065688e-14},
        {"pull-in voltage", sqrt(k * gap * gap * gap / (2.0 * ea))},
        {"voltage, share of pull-in", 1.0 / sqrt(k * gap * gap * gap / (2.0 * ea))},
        /* w0^2 (z - 10 nm) less the plates' pull at the stop z = 1 um, in Python */
        {"largest specific force", 121.384046196},
        {"Brownian noise, one-sided", sqrt(4.0 * k_b * room * w0 / (m * 0.7))},
        {"acceleration per displacement of the loop", (double)NAN},
        {"limit cycle frequency", (double)NAN},
    };
    CHECK_ALL(imk_mems_accelerometer_instrument, rows);
    imk_mems_accelerometer d = imk_mems_accelerometer_analog();
    const double v = d.voltage, u = d.feedback_voltage; /* of the plates; of the control */
    const double wc = 2.0 * PI * 4000.0;
    const due_row analog[] = {
        {"largest specific force", 2.0 * ea * v * u / (m * gap * gap)},
        {"acceleration per displacement of the loop", wc * wc - (k - soft * v * v) / m},
    };
    CHECK_ROWS(imk_mems_accelerometer_instrument, &d, analog);
    d.voltage = 7.0; /* beyond pull-in at 6.58 V: only the loop holds the mass */
    d.quality = 0.4;
    const due_row held[] = {
        {"natural frequency, softened", (double)NAN},
        {"displacement per specific force", (double)NAN},
        {"change of capacitance per specific force", (double)NAN},
        {"decay time constant", (double)NAN},
    };
    CHECK_ROWS(imk_mems_accelerometer_instrument, &d, held);
    d = imk_mems_accelerometer_default();
    d.plates = IMK_MEMS_SINGLE;
    const due_row single[] = {
        {"spring softening, mass in the middle", 0.5 * soft},
        /* as above, z = 21.7926 nm */
        {"natural frequency, softened", 1789.23757721},
        {"change of capacitance per specific force", 2.86437124044e-14},
        {"pull-in voltage", sqrt(8.0 * k * gap * gap * gap / (27.0 * ea))},
    };
    CHECK_ROWS(imk_mems_accelerometer_instrument, &d, single);
}

static void pendulous_servo(void **state)
{
    (void)state;
    const double p = 3.2e-6, j = 3e-8, kp = 0.7579856180036627, kh = 0.01, ki = 227.3956854010988;
    const double kt = 0.024139446153846153, b = 2.1111502632123407e-4;
    const due_row rows[] = {
        {"scale factor of the current", p / kt},
        {"pendulosity, torque per specific force", p},
        {"centre of percussion from the hinge", j / p},
        {"largest specific force of the torquer", 0.078 * kt / p},
        {"natural frequency without the loop", sqrt(kh / j) / (2.0 * PI)},
        {"natural frequency of the loop", sqrt((kp + kh) / j) / (2.0 * PI)},
        {"damping ratio of the loop", b / (2.0 * sqrt(j * (kp + kh)))},
        /* bisection of |(K_p + K_i/s)/(J s^2 + b s + K_p + K_h + K_i/s)|^2 = 1/2 in Python */
        {"loop bandwidth (-3 dB)", 840.260983721},
        {"static stiffness of the loop", kp + kh},
        {"angle per specific force, before the integral acts", p / (kp + kh)},
        {"time constant of the integral", (kp + kh) / ki},
        {"elastic restraint, bias per angle", kh / p},
        /* half the real part of P over that denominator at s = 2 pi i 100, in Python */
        {"vibropendulous rectification at 100 Hz", 1.9378543375e-6},
    };
    CHECK_ALL(imk_pendulous_servo_instrument, rows);
    imk_pendulous_servo d = imk_pendulous_servo_default();
    d.hinge_stiffness = d.integral = 0.0;
    const due_row simple[] = {
        {"natural frequency without the loop", (double)NAN},
        {"time constant of the integral", (double)NAN},
        {"vibropendulous rectification at 100 Hz",
         /* 1/2 Re 1/(K - J w^2 + j b w) */
         0.5 * p * (kp - j * 4e4 * PI * PI) /
             (pow(kp - j * 4e4 * PI * PI, 2.0) + pow(b * 200.0 * PI, 2.0))},
    };
    CHECK_ROWS(imk_pendulous_servo_instrument, &d, simple);
}

static void vibrating_beam(void **state)
{
    (void)state;
    const double l = 0.004796271894634373, w = 150e-6, t = 165e-6, m = 0.0031597312148026503;
    const double ei = 78e9 * w * t * t * t / 12.0, area = w * t;
    const double root = 4.730040744862704; /* of cos x cosh x = 1 */
    const double f = root * root / (2.0 * PI * l * l) * sqrt(ei / (2650.0 * area));
    const double kappa = 0.02457751863 * f * f * l * l / ei; /* 12.302619/500.563902 */
    const double load = m * 70.0 * 9.80665, euler = 4.0 * PI * PI * ei / (l * l);
    const due_row rows[] = {
        {"frequency of the first beam, unloaded", f},
        {"frequency of the second beam, unloaded", 1.02 * f},
        {"change of the squared frequency per load", kappa},
        {"axial load per specific force", m},
        {"axial load at full scale", load},
        {"buckling load", euler},
        {"load at full scale, share of the buckling load", load / euler},
        {"frequency per specific force, first beam", kappa * m / (2.0 * f)},
        {"differential scale factor", kappa * m / (2.0 * f) * (1.0 + 1.0 / 1.02)},
        {"modal mass of a beam", 0.39647792016 * 2650.0 * area * l},
        {"decay time constant of a beam", 1e4 / (PI * f)},
        {"displacement of the proof mass per specific force",
         1.0 / (4.0 * PI * PI * 1500.0 * 1500.0)},
    };
    CHECK_ALL(imk_vibrating_beam_instrument, rows);
    imk_vibrating_beam d = imk_vibrating_beam_default();
    d.arrangement = IMK_BEAM_SINGLE;
    const due_row single[] = {
        {"frequency of the second beam, unloaded", (double)NAN},
        {"differential scale factor", (double)NAN},
    };
    CHECK_ROWS(imk_vibrating_beam_instrument, &d, single);
}

/* ---- tables ---------------------------------------------------------------------------------- */

/* A unit that exists, and the SI one of the same dimension with the scale 1. */
static bool units_fit(const imk_derived *row)
{
    if (strcmp(row->unit, "1") == 0 && strcmp(row->si, "1") == 0)
        return true;
    const imk_unit shown = imk_unit_of(row->unit);
    const imk_unit si = strcmp(row->si, "1") == 0 ? imk_unit_of("rad/rad") : imk_unit_of(row->si);
    return shown.scale > 0.0 && si.scale == 1.0 && shown.offset == 0.0 &&
           memcmp(&shown.dimension, &si.dimension, sizeof si.dimension) == 0;
}

/* "f_n = …", or "f_n: …" of what has no formula. */
static bool names_its_symbol(const imk_derived *row)
{
    const size_t length = strlen(row->symbol);
    return length > 0 && strncmp(row->equation, row->symbol, length) == 0 &&
           (strncmp(row->equation + length, " = ", 3) == 0 ||
            strncmp(row->equation + length, ": ", 2) == 0);
}

static void tables_are_complete(void **state)
{
    (void)state;
    for (size_t i = 0; i < imk_instrument_count(); i++) {
        const imk_instrument *k = imk_instrument_get(i);
        assert_true(rows_of(k) >= 10);
        assert_null(imk_instrument_derived(k, "colour"));
        assert_null(imk_instrument_derived(k, NULL));
        for (const imk_derived *row = k->derived; row->name; row++) {
            if (!row->name[0] || !units_fit(row) || !names_its_symbol(row) || !row->source[0]) {
                print_error("%s: %s [%s, %s] %s\n", k->name, row->name, row->unit, row->si,
                            row->equation);
                fail();
            }
            assert_ptr_equal(imk_instrument_derived(k, row->name), row);
            assert_ptr_equal(imk_instrument_derived(k, row->symbol), row);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(free_gyro),
        cmocka_unit_test(rate_gyro),
        cmocka_unit_test(rate_integrating_gyro),
        cmocka_unit_test(tuned_gyro),
        cmocka_unit_test(suspended_rotor),
        cmocka_unit_test(fibre_optic),
        cmocka_unit_test(ring_laser),
        cmocka_unit_test(tuning_fork),
        cmocka_unit_test(shell_gyro),
        cmocka_unit_test(mems_accelerometer),
        cmocka_unit_test(pendulous_servo),
        cmocka_unit_test(vibrating_beam),
        cmocka_unit_test(tables_are_complete),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
