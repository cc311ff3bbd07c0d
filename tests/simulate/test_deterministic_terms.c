/* SPDX-License-Identifier: Apache-2.0 */
/* Every deterministic term by itself: a log with only that term, less the perfect log of the same
 * motion, is the closed form of the term, written here as the theory prints it. */
#include "check.h"
#include "simulated_log.h"

#include "imukit/distort.h"

#include <string.h>

enum { ROWS = 1300, CHANNELS = 6 };

static const double rate = 100.0;

/* ---- a motion with everything in it ---------------------------------------------------------- */

static double w[3][ROWS], f[3][ROWS], alpha[3][ROWS];

/* Not a possible motion (alpha is not the derivative of w): the terms do not care. */
static imk_recorded_motion lively_motion(void)
{
    imk_recorded_motion motion = {.count = ROWS, .rate = rate};
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < ROWS; k++) {
            double x = 0.013 * k + i;
            w[i][k] = 2.0 * sin(x * (1.0 + 0.3 * i)) + 0.3;
            f[i][k] = 15.0 * cos(1.7 * x + 0.2 * i * i) - 4.0;
            alpha[i][k] = 8.0 * sin(2.9 * x);
        }
        motion.angular_rate[i] = w[i];
        motion.specific_force[i] = f[i];
        motion.angular_acceleration[i] = alpha[i];
    }
    return motion;
}

/* Up at 2 K/s, down at 3 K/s: through the valid range 285 … 300 K and beyond both ends. */
static const double profile_time[] = {0.0, 10.0, 13.0};
static const double profile_temperature[] = {283.0, 303.0, 294.0};
static const imk_temperature_profile profile = {
    .point_count = 3, .time = profile_time, .temperature = profile_temperature};

/* What one sample is exposed to. */
typedef struct sample {
    double w[3], f[3], alpha[3];
    double temperature, temperature_rate, time;
} sample;

/* Row k covers (k - 1)/rate … k/rate; slow things are taken in its middle. */
static sample sample_of(int k)
{
    sample s = {.time = (k - 0.5) / rate};
    for (int i = 0; i < 3; i++) {
        s.w[i] = w[i][k];
        s.f[i] = f[i][k];
        s.alpha[i] = alpha[i][k];
    }
    if (s.time <= 0.0) {
        s.temperature = 283.0;
    } else if (s.time < 10.0) {
        s.temperature = 283.0 + 2.0 * s.time;
        s.temperature_rate = 2.0;
    } else {
        s.temperature = 303.0 - 3.0 * (s.time - 10.0);
        s.temperature_rate = -3.0;
    }
    return s;
}

/* ---- the terms ------------------------------------------------------------------------------- */

/* Parameters: different on each axis, one axis zero in most. */
static const double p[3] = {0.02, -0.03, 0.0};
static const double q[3][3] = {{0.0, 0.01, -0.02}, {0.03, 0.0, 0.0}, {-0.005, 0.007, 0.0}};

static imk_axes axes_p(double factor)
{
    return axes(factor * p[0], factor * p[1], factor * p[2]);
}

static imk_rows rows_q(double factor)
{
    imk_rows rows = {.value = {{0.0}}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            rows.value[i][j] = factor * q[i][j];
    return rows;
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static const double *input_of(const sample *s, int sensor)
{
    return sensor == IMK_GYRO ? s->w : s->f;
}

static void set_bias(imk_model *m)
{
    m->gyro.bias.fixed = m->accel.bias.fixed = axes_p(1.0);
}
static double bias(const sample *s, int sensor, int i)
{
    (void)s, (void)sensor;
    return p[i];
}

static void set_scale(imk_model *m)
{
    m->gyro.scale_factor.fixed = m->accel.scale_factor.fixed = axes_p(1.0);
}
static double scale(const sample *s, int sensor, int i)
{
    return p[i] * input_of(s, sensor)[i];
}

/* 3rd order in T - 290 K, held outside 285 … 300 K */
static imk_temperature_polynomial polynomial(void)
{
    imk_temperature_polynomial t = {
        .order = 3, .reference = 290.0, .minimum = 285.0, .maximum = 300.0};
    t.coefficient[0] = axes_p(0.1);
    t.coefficient[1] = axes_p(-0.01);
    t.coefficient[2] = axes_p(2e-3);
    return t;
}
static double polynomial_value(const sample *s, int i)
{
    double x = fmin(fmax(s->temperature, 285.0), 300.0) - 290.0;
    return p[i] * (0.1 * x - 0.01 * x * x + 2e-3 * x * x * x);
}
static void set_bias_temperature(imk_model *m)
{
    m->gyro.bias.temperature = m->accel.bias.temperature = polynomial();
}
static double bias_temperature(const sample *s, int sensor, int i)
{
    (void)sensor;
    return polynomial_value(s, i);
}
static void set_scale_temperature(imk_model *m)
{
    m->gyro.scale_factor.temperature = m->accel.scale_factor.temperature = polynomial();
}
static double scale_temperature(const sample *s, int sensor, int i)
{
    return polynomial_value(s, i) * input_of(s, sensor)[i];
}

static void set_temperature_rate(imk_model *m)
{
    m->gyro.bias.temperature_rate = m->accel.bias.temperature_rate = axes_p(1.0);
}
static double temperature_rate(const sample *s, int sensor, int i)
{
    (void)sensor;
    return p[i] * s->temperature_rate;
}

static void set_warm_up(imk_model *m)
{
    m->gyro.bias.warm_up_amplitude = m->accel.bias.warm_up_amplitude = axes_p(1.0);
    m->gyro.bias.warm_up_time.value = m->accel.bias.warm_up_time.value = 4.0;
}
static double warm_up(const sample *s, int sensor, int i)
{
    (void)sensor;
    return p[i] * exp(-s->time / 4.0);
}

/* p from 0 towards 1 while warming, towards -1 while cooling, over 15 K/8. */
static void set_hysteresis(imk_model *m)
{
    imk_temperature_polynomial range = {
        .order = 1, .reference = 290.0, .minimum = 285.0, .maximum = 300.0};
    m->gyro.bias.temperature = m->accel.bias.temperature = range;
    m->gyro.bias.hysteresis = m->accel.bias.hysteresis = axes(0.02, 0.03, 0.0);
}
static double hysteresis(const sample *s, int sensor, int i)
{
    static const double width[3] = {0.02, 0.03, 0.0};
    const double span = 15.0 / 8.0, first = 283.0; /* row 0 is before the profile begins */
    double state;
    (void)sensor;
    if (s->time < 10.0) {
        state = 1.0 - exp(-(s->temperature - first) / span);
    } else {
        /* the last sample on the way up is at 9.995 s, so the top seen is 302.99 K */
        double top = 1.0 - exp(-(302.99 - first) / span);
        state = -1.0 + (top + 1.0) * exp(-(302.99 - s->temperature) / span);
    }
    return 0.5 * width[i] * state;
}

static void set_k2(imk_model *m)
{
    m->gyro.nonlinearity.k2 = m->accel.nonlinearity.k2 = axes_p(1.0);
}
static double k2(const sample *s, int sensor, int i)
{
    double u = input_of(s, sensor)[i];
    return p[i] * u * u;
}
static void set_koq(imk_model *m)
{
    m->gyro.nonlinearity.koq = m->accel.nonlinearity.koq = axes_p(1.0);
}
static double koq(const sample *s, int sensor, int i)
{
    double u = input_of(s, sensor)[i];
    return p[i] * u * fabs(u);
}
static void set_k3(imk_model *m)
{
    m->gyro.nonlinearity.k3 = m->accel.nonlinearity.k3 = axes_p(0.01);
}
static double k3(const sample *s, int sensor, int i)
{
    double u = input_of(s, sensor)[i];
    return 0.01 * p[i] * u * u * u;
}
static void set_asymmetry(imk_model *m)
{
    m->gyro.nonlinearity.asymmetry = m->accel.nonlinearity.asymmetry = axes_p(1.0);
}
static double asymmetry(const sample *s, int sensor, int i)
{
    return 0.5 * p[i] * fabs(input_of(s, sensor)[i]);
}

/* Output axis the next body axis, pendulous axis the one after. */
static void set_cross_products(imk_model *m)
{
    m->accel.nonlinearity.cross_products = rows_q(0.1);
}
static double cross_products(const sample *s, int sensor, int i)
{
    double u = s->f[i], o = s->f[(i + 1) % 3], pendulous = s->f[(i + 2) % 3];
    if (sensor == IMK_GYRO)
        return 0.0;
    return 0.1 * (q[i][0] * u * pendulous + q[i][1] * u * o + q[i][2] * pendulous * o);
}

static void set_misalignment(imk_model *m)
{
    m->gyro.misalignment = m->accel.misalignment = rows_q(1.0);
}
static void set_cross_axis(imk_model *m)
{
    m->gyro.cross_axis = m->accel.cross_axis = rows_q(1.0);
}
static double across(const sample *s, int sensor, int i)
{
    return dot(q[i], input_of(s, sensor));
}

static void set_g_sensitivity(imk_model *m)
{
    m->gyro.g_sensitivity = rows_q(0.1);
}
static double g_sensitivity(const sample *s, int sensor, int i)
{
    return sensor == IMK_GYRO ? 0.1 * dot(q[i], s->f) : 0.0;
}

static void set_g2_sensitivity(imk_model *m)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 6; j++)
            m->gyro.g2_sensitivity.value[i][j] = 1e-4 * (i + 1) * (j - 2);
}
static double g2_sensitivity(const sample *s, int sensor, int i)
{
    const double *a = s->f;
    const double product[6] = {a[0] * a[0], a[1] * a[1], a[2] * a[2],
                               a[0] * a[1], a[1] * a[2], a[2] * a[0]};
    double sum = 0.0;
    for (int j = 0; j < 6; j++)
        sum += 1e-4 * (i + 1) * (j - 2) * product[j];
    return sensor == IMK_GYRO ? sum : 0.0;
}

/* alpha x r + w x (w x r), in components, a place of its own for each accelerometer */
static void set_lever_arm(imk_model *m)
{
    m->accel.lever_arm = rows_q(10.0);
}
static double lever_arm(const sample *s, int sensor, int i)
{
    const double *v = s->w, *a = s->alpha;
    const double r[3] = {10.0 * q[i][0], 10.0 * q[i][1], 10.0 * q[i][2]};
    if (sensor == IMK_GYRO)
        return 0.0;
    switch (i) {
    case 0:
        return -(v[1] * v[1] + v[2] * v[2]) * r[0] + (v[0] * v[1] - a[2]) * r[1] +
               (v[0] * v[2] + a[1]) * r[2];
    case 1:
        return (v[0] * v[1] + a[2]) * r[0] - (v[0] * v[0] + v[2] * v[2]) * r[1] +
               (v[1] * v[2] - a[0]) * r[2];
    default:
        return (v[0] * v[2] - a[1]) * r[0] + (v[1] * v[2] + a[0]) * r[1] -
               (v[0] * v[0] + v[1] * v[1]) * r[2];
    }
}

/* ---- the output stage: the whole output as a function of the perfect one ---- */

static void set_dead_band(imk_model *m)
{
    m->gyro.dead_band = axes(0.5, 0.0, 1.0);
    m->accel.dead_band = axes(0.0, 3.0, 5.0);
}
static double dead_band(const sample *s, int sensor, int i)
{
    static const double band[2][3] = {{0.5, 0.0, 1.0}, {0.0, 3.0, 5.0}};
    double u = input_of(s, sensor)[i];
    return fabs(u) < band[sensor][i] ? -u : 0.0;
}

static void set_range(imk_model *m)
{
    m->gyro.range = axes(1.0, 0.0, 2.0);
    m->accel.range = axes(0.0, 10.0, 15.0);
}
static double range(const sample *s, int sensor, int i)
{
    static const double end[2][3] = {{1.0, 1e9, 2.0}, {1e9, 10.0, 15.0}};
    double u = input_of(s, sensor)[i];
    return fmax(-end[sensor][i], fmin(u, end[sensor][i])) - u;
}

static void set_resolution(imk_model *m)
{
    m->gyro.resolution = axes(0.25, 0.0, 0.5);
    m->accel.resolution = axes(0.5, 1.0, 0.0);
}
static double resolution(const sample *s, int sensor, int i)
{
    static const double step[2][3] = {{0.25, 0.0, 0.5}, {0.5, 1.0, 0.0}};
    double u = input_of(s, sensor)[i], lsb = step[sensor][i];
    return lsb > 0.0 ? lsb * rint(u / lsb) - u : 0.0;
}

static void set_counts(imk_model *m)
{
    m->gyro.sensitivity = axes(100.0, 200.0, 300.0);
    m->gyro.zero_offset = axes(32768.0, 0.0, -5.0);
}
static double counts(const sample *s, int sensor, int i)
{
    static const double offset[3] = {32768.0, 0.0, -5.0};
    double u = input_of(s, sensor)[i];
    return sensor == IMK_GYRO ? rint(100.0 * (i + 1) * u + offset[i]) - u : 0.0;
}

static const struct term {
    const char *name;
    void (*set)(imk_model *model);
    double (*effect)(const sample *s, int sensor, int axis);
    double tolerance; /* of the effect: roundings of a sum of some ten products of the signal's
                         size, 15 m/s^2 and its squares and cubes */
} terms[] = {
    {"bias.fixed", set_bias, bias, 1e-14},
    {"bias.temperature", set_bias_temperature, bias_temperature, 1e-14},
    {"bias.temperature_rate", set_temperature_rate, temperature_rate, 1e-14},
    {"bias.warm_up", set_warm_up, warm_up, 1e-14},
    {"bias.hysteresis", set_hysteresis, hysteresis, 1e-13},
    {"scale_factor.fixed", set_scale, scale, 1e-14},
    {"scale_factor.temperature", set_scale_temperature, scale_temperature, 1e-13},
    {"nonlinearity.k2", set_k2, k2, 1e-13},
    {"nonlinearity.koq", set_koq, koq, 1e-13},
    {"nonlinearity.k3", set_k3, k3, 1e-13},
    {"nonlinearity.asymmetry", set_asymmetry, asymmetry, 1e-14},
    {"cross_products", set_cross_products, cross_products, 1e-13},
    {"misalignment", set_misalignment, across, 1e-14},
    {"cross_axis", set_cross_axis, across, 1e-14},
    {"g_sensitivity", set_g_sensitivity, g_sensitivity, 1e-14},
    {"g2_sensitivity", set_g2_sensitivity, g2_sensitivity, 1e-13},
    {"lever_arm", set_lever_arm, lever_arm, 1e-13},
    {"dead_band", set_dead_band, dead_band, 0.0},
    {"range", set_range, range, 1e-14},
    {"resolution", set_resolution, resolution, 1e-14},
    {"sensitivity", set_counts, counts, 1e-11},
};

static void test_term(void **state)
{
    const struct term *term = *state;
    imk_recorded_motion motion = lively_motion();
    imk_simulation simulation = imk_simulation_default();
    simulation.motion.recorded = &motion;
    simulation.temperature = &profile;
    imk_model model;
    imk_model_default(&model);
    double *perfect = simulate_rows(&model, &simulation, ROWS);
    term->set(&model);
    CHECK_OK(imk_model_validate(&model, NULL));
    double *log = simulate_rows(&model, &simulation, ROWS);
    double largest = 0.0;
    for (int c = 0; c < CHANNELS; c++)
        for (int k = 0; k < ROWS; k++) {
            sample s = sample_of(k);
            /* The perfect log is the motion itself, to the bit. */
            CHECK_CLOSE(perfect[c * ROWS + k], input_of(&s, c / 3)[c % 3], 0.0);
            double expected = term->effect(&s, c / 3, c % 3);
            CHECK_CLOSE(log[c * ROWS + k] - perfect[c * ROWS + k], expected, term->tolerance);
            largest = fmax(largest, fabs(expected));
        }
    assert_true(largest > 1e-3); /* the term does something */
    free(perfect);
    free(log);
}

/* Quantization rounds the integral and carries the rest: the sum of the output never strays more
 * than half a step from the sum of the input, and every output is whole steps. */
static void test_quantization(void **state)
{
    (void)state;
    imk_recorded_motion motion = lively_motion();
    imk_simulation simulation = imk_simulation_default();
    simulation.motion.recorded = &motion;
    imk_model model;
    imk_model_default(&model);
    const double lsb = 0.05; /* rad, coarse: a sample is at most 0.025 rad */
    model.gyro.noise.quantization = axes(lsb / sqrt(12.0), lsb / sqrt(12.0), 0.0);
    double *log = simulate_rows(&model, &simulation, ROWS);
    for (int c = 0; c < 2; c++) {
        double in = 0.0, out = 0.0, low = 0.0, high = 0.0;
        for (int k = 0; k < ROWS; k++) {
            double steps = log[c * ROWS + k] / rate / lsb;
            CHECK_CLOSE(steps, rint(steps), 1e-9);
            in += w[c][k] / rate;
            out += log[c * ROWS + k] / rate;
            low = fmin(low, out - in);
            high = fmax(high, out - in);
        }
        /* the residual at the start is somewhere within a step */
        CHECK_BELOW(high - low, lsb * (1.0 + 1e-9));
        assert_true(high - low > 0.8 * lsb);
    }
    for (int k = 0; k < ROWS; k++)
        CHECK_CLOSE(log[2 * ROWS + k], w[2][k], 0.0); /* Q = 0 */
    free(log);
}

/* Sensors in directions of their own, more than three: each reads e . v. */
static void test_redundant_directions(void **state)
{
    (void)state;
    static const double direction[5][3] = {
        {1.0, 0.0, 0.0}, {0.0, 0.6, 0.8}, {0.0, -0.8, 0.6}, {0.8, 0.0, -0.6}, {0.36, 0.48, -0.8}};
    imk_recorded_motion motion = lively_motion();
    imk_simulation simulation = imk_simulation_default();
    simulation.motion.recorded = &motion;
    imk_model model;
    imk_model_default(&model);
    model.gyro.axis_count = 5;
    memcpy(model.gyro.direction, direction, sizeof direction);
    model.gyro.scale_factor.fixed.value[4] = 0.01;
    model.accel.axis_count = 1;
    memcpy(model.accel.direction[0], direction[1], sizeof direction[1]);
    double *log = simulate_rows(&model, &simulation, ROWS);
    for (int k = 0; k < ROWS; k++) {
        sample s = sample_of(k);
        for (int c = 0; c < 5; c++)
            CHECK_CLOSE(log[c * ROWS + k], dot(direction[c], s.w) * (c == 4 ? 1.01 : 1.0), 1e-14);
        CHECK_CLOSE(log[5 * ROWS + k], dot(direction[1], s.f), 1e-14);
    }
    free(log);
}

/* The angular acceleration of a recorded motion without one: difference of the neighbours. */
static void test_recorded_slope(void **state)
{
    (void)state;
    imk_recorded_motion motion = lively_motion();
    for (int i = 0; i < 3; i++)
        motion.angular_acceleration[i] = NULL;
    imk_simulation simulation = imk_simulation_default();
    simulation.motion.recorded = &motion;
    imk_model model;
    imk_model_default(&model);
    set_lever_arm(&model);
    double *log = simulate_rows(&model, &simulation, ROWS);
    for (int k = 0; k < ROWS; k++) {
        sample s = sample_of(k);
        int before = k > 0 ? k - 1 : 0, after = k + 1 < ROWS ? k + 1 : k;
        for (int i = 0; i < 3; i++)
            s.alpha[i] = (w[i][after] - w[i][before]) * rate / (after - before);
        for (int i = 0; i < 3; i++)
            CHECK_CLOSE(log[(3 + i) * ROWS + k] - f[i][k], lever_arm(&s, IMK_ACCEL, i), 1e-13);
    }
    free(log);
}

int main(void)
{
    enum { TERMS = sizeof terms / sizeof terms[0], OTHERS = 3 };
    struct CMUnitTest tests[TERMS + OTHERS];
    for (size_t i = 0; i < TERMS; i++)
        tests[i] = (struct CMUnitTest){
            .name = terms[i].name, .test_func = test_term, .initial_state = (void *)&terms[i]};
    tests[TERMS] = (struct CMUnitTest)cmocka_unit_test(test_quantization);
    tests[TERMS + 1] = (struct CMUnitTest)cmocka_unit_test(test_redundant_directions);
    tests[TERMS + 2] = (struct CMUnitTest)cmocka_unit_test(test_recorded_slope);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
