/* SPDX-License-Identifier: Apache-2.0 */
/* The forward map against the printed equation of distort.h, written down once more in long double
 * with vectors and cross products; the same bits for every kernel, count and place; zeros. */
#include "check.h"
#include "moving_unit.h"

#include "imukit/distort.h"
#include "imukit/random.h"
#include "model/distort_internal.h"

/* ---- the equation, literally ----------------------------------------------------------------- */

static void cross(const long double a[3], const long double b[3], long double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static long double dot(const double a[3], const long double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static long double polynomial(const imk_temperature_polynomial *p, int i, long double temperature)
{
    long double sum = 0, power = 1;
    if (temperature < p->minimum)
        temperature = p->minimum;
    if (temperature > p->maximum)
        temperature = p->maximum;
    for (int k = 0; k < p->order; k++) {
        power *= temperature - p->reference;
        sum += p->coefficient[k].value[i] * power;
    }
    return sum;
}

/* Kip u p + Kio u o + Kpo p o */
static long double cross_products(const imk_triad *triad, int i, const long double v[3])
{
    const double *k = triad->nonlinearity.cross_products.value[i], *e = triad->direction[i];
    const double *p = triad->nonlinearity.pendulous_axis[i];
    const double o[3] = {p[1] * e[2] - p[2] * e[1], p[2] * e[0] - p[0] * e[2],
                         p[0] * e[1] - p[1] * e[0]};
    return k[0] * dot(e, v) * dot(p, v) + k[1] * dot(e, v) * dot(o, v) +
           k[2] * dot(p, v) * dot(o, v);
}

static double expected(const imk_triad *triad, int sensor, int i, const motion_samples *m, int k)
{
    long double w[3], f[3], alpha[3], r[3], turn[3], inward[3], tangential[3], v[3];
    for (int j = 0; j < 3; j++) {
        w[j] = m->value[j][k];
        f[j] = m->value[3 + j][k];
        alpha[j] = m->value[6 + j][k];
        r[j] = triad->lever_arm.value[i][j];
    }
    cross(w, r, turn);
    cross(w, turn, inward);
    cross(alpha, r, tangential);
    for (int j = 0; j < 3; j++)
        v[j] = sensor == IMK_GYRO ? w[j] : f[j] + tangential[j] + inward[j];
    const imk_bias *bias = &triad->bias;
    const imk_nonlinearity *n = &triad->nonlinearity;
    const long double temperature = m->value[9][k], u = dot(triad->direction[i], v);
    const long double size = u < 0 ? -u : u;
    long double y = bias->fixed.value[i] + polynomial(&bias->temperature, i, temperature) +
                    bias->temperature_rate.value[i] * (long double)m->value[10][k] +
                    bias->warm_up_amplitude.value[i] * (long double)m->value[11 + sensor][k] +
                    bias->hysteresis.value[i] / 2 * (long double)m->value[13 + sensor][k];
    y += u + (triad->scale_factor.fixed.value[i] +
              polynomial(&triad->scale_factor.temperature, i, temperature)) *
                 u;
    y += dot(triad->misalignment.value[i], v) + dot(triad->cross_axis.value[i], v);
    y += n->k2.value[i] * u * u + n->koq.value[i] * u * size + n->k3.value[i] * u * u * u +
         n->asymmetry.value[i] * size / 2;
    if (sensor == IMK_ACCEL)
        return (double)(y + cross_products(triad, i, v));
    const long double q[6] = {f[0] * f[0], f[1] * f[1], f[2] * f[2],
                              f[0] * f[1], f[1] * f[2], f[2] * f[0]};
    y += dot(triad->g_sensitivity.value[i], f);
    for (int j = 0; j < 6; j++)
        y += triad->g2_sensitivity.value[i][j] * q[j];
    return (double)y;
}

/* Tolerance: 1e-14 of the range. Some forty operations on terms of which the largest is the input
 * itself, of the range's size, or for an accelerometer that and w x (w x r), 17 m/s^2. */
static void equation_holds(void **state)
{
    (void)state;
    uint64_t random = 1;
    const double range[2] = {RATE_RANGE, FORCE_RANGE};
    for (int trial = 0; trial < 500; trial++) {
        imk_model model = draw_unit(&random, draw_chance(&random, 4));
        fill(&random, model.gyro.bias.hysteresis.value, IMK_AXES_MAX, 0.01);
        static imk_distortion distortion;
        static motion_samples m;
        const int count = 1 + (int)(draw(&random) % SAMPLES_MAX);
        double out[SAMPLES_MAX];
        draw_motion(&random, count, &m);
        CHECK_OK(
            imk_distortion_start(&distortion, &model, NULL, imk_random_seeded(0).kernel, NULL));
        for (int sensor = 0; sensor < 2; sensor++) {
            const imk_triad *triad = sensor == IMK_GYRO ? &model.gyro : &model.accel;
            for (int i = 0; i < triad->axis_count; i++) {
                imk_distort(&distortion, sensor, i, &m.stimulus, (size_t)count, out);
                for (int k = 0; k < count; k++)
                    CHECK_CLOSE(out[k], expected(triad, sensor, i, &m, k), 1e-14 * range[sensor]);
            }
        }
    }
}

/* ---- bits ------------------------------------------------------------------------------------ */

static void start(imk_distortion *distortion, const imk_model *model, imk_kernel kernel)
{
    CHECK_OK(imk_distortion_start(distortion, model, NULL, kernel, NULL));
}

static imk_stimulus moved_by(const imk_stimulus *s, size_t by)
{
    imk_stimulus moved = *s;
    for (int j = 0; j < 3; j++) {
        moved.angular_rate[j] += by;
        moved.specific_force[j] += by;
        moved.angular_acceleration[j] += by;
    }
    moved.temperature += by;
    moved.temperature_rate += by;
    for (int sensor = 0; sensor < 2; sensor++) {
        moved.warm_up[sensor] += by;
        moved.hysteresis[sensor] += by;
    }
    return moved;
}

/* One call, calls of one sample, and calls of 1, 2, 3 … samples, with every kernel there is. */
static void bits_do_not_depend_on_the_division(void **state)
{
    (void)state;
    uint64_t random = 2;
    static imk_distortion scalar, fast;
    static motion_samples m;
    double whole[SAMPLES_MAX], parts[SAMPLES_MAX];
    for (int trial = 0; trial < 30; trial++) {
        const imk_model model = draw_unit(&random, false);
        draw_motion(&random, SAMPLES_MAX, &m);
        start(&scalar, &model, IMK_KERNEL_SCALAR);
        start(&fast, &model, imk_random_seeded(0).kernel);
        for (int sensor = 0; sensor < 2; sensor++)
            for (int i = 0; i < scalar.axis_count[sensor]; i++) {
                imk_distort(&scalar, sensor, i, &m.stimulus, SAMPLES_MAX, whole);
                imk_distort(&fast, sensor, i, &m.stimulus, SAMPLES_MAX, parts);
                assert_memory_equal(whole, parts, sizeof whole);
                for (size_t at = 0, size = 0; at < SAMPLES_MAX; at += size) {
                    size = trial % 2 ? 1 : size + 1;
                    size = at + size < SAMPLES_MAX ? size : SAMPLES_MAX - at;
                    const imk_stimulus s = moved_by(&m.stimulus, at);
                    imk_distort(&fast, sensor, i, &s, size, parts + at);
                }
                assert_memory_equal(whole, parts, sizeof whole);
            }
    }
#if defined(__x86_64__)
    if (imk_random_seeded(0).kernel == IMK_KERNEL_AVX512) {
        imk_distortion avx2;
        const imk_model model = draw_unit(&random, false);
        start(&scalar, &model, IMK_KERNEL_SCALAR);
        start(&avx2, &model, IMK_KERNEL_AVX2);
        imk_distort(&scalar, IMK_ACCEL, 1, &m.stimulus, SAMPLES_MAX, whole);
        imk_distort(&avx2, IMK_ACCEL, 1, &m.stimulus, SAMPLES_MAX, parts);
        assert_memory_equal(whole, parts, sizeof whole);
    }
#endif
}

/* A constant motion reads the same in every lane, and an array of zeros what no array does. */
static void constants_and_zeros(void **state)
{
    (void)state;
    uint64_t random = 3;
    static const double zeros[SAMPLES_MAX];
    static double minus[SAMPLES_MAX];
    static imk_distortion distortion;
    static motion_samples m;
    double out[SAMPLES_MAX], other[SAMPLES_MAX];
    for (int k = 0; k < SAMPLES_MAX; k++)
        minus[k] = -0.0;
    for (int trial = 0; trial < 30; trial++) {
        imk_model model;
        if (trial)
            model = draw_unit(&random, false);
        else
            imk_model_default(&model);
        start(&distortion, &model, imk_random_seeded(0).kernel);
        draw_motion(&random, 1, &m);
        for (int c = 0; c < COMPONENTS; c++)
            for (int k = 1; k < SAMPLES_MAX; k++)
                m.value[c][k] = m.value[c][0];
        imk_stimulus with = {0}, without = {0};
        with.angular_rate[0] = without.angular_rate[0] = m.value[0];
        with.angular_rate[1] = with.angular_rate[2] = trial % 2 ? zeros : minus;
        for (int j = 0; j < 3; j++)
            with.specific_force[j] = with.angular_acceleration[j] = trial % 3 ? zeros : minus;
        with.temperature_rate = with.warm_up[0] = with.warm_up[1] = zeros;
        for (int sensor = 0; sensor < 2; sensor++) {
            imk_distort(&distortion, sensor, 1, &m.stimulus, SAMPLES_MAX, out);
            for (int k = 1; k < SAMPLES_MAX; k++)
                assert_memory_equal(&out[k], &out[0], sizeof *out);
            imk_distort(&distortion, sensor, 1, &with, 37, out);
            imk_distort(&distortion, sensor, 1, &without, 37, other);
            assert_memory_equal(out, other, 37 * sizeof *out);
        }
        imk_distort(&distortion, IMK_ACCEL, 0, &(imk_stimulus){0}, 1, out);
        if (trial == 0)
            assert_false(signbit(out[0]));
    }
}

/* ---- single terms ---------------------------------------------------------------------------- */

static double read_one(const imk_model *model, int sensor, int axis, const imk_stimulus *s)
{
    static imk_distortion distortion;
    double out;
    start(&distortion, model, IMK_KERNEL_SCALAR);
    imk_distort(&distortion, sensor, axis, s, 1, &out);
    return out;
}

/* The reading of a sensor on +x of a turntable, by the equations of models of lever arms:
 * f_x - (wy^2 + wz^2) rx + (wx wy - az) ry + (wx wz + ay) rz. */
static void lever_arm_pulls_inwards(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    const double w[3] = {1, 2, 3}, a[3] = {5, 7, 11}, r[3] = {0.5, 0.25, 0.125}, f = 4;
    imk_stimulus s = {.specific_force = {&f},
                      .angular_rate = {&w[0], &w[1], &w[2]},
                      .angular_acceleration = {&a[0], &a[1], &a[2]}};
    memcpy(model.accel.lever_arm.value[0], r, sizeof r);
    CHECK_CLOSE(read_one(&model, IMK_ACCEL, 0, &s),
                4 - 13 * 0.5 + (2 - 11) * 0.25 + (3 + 7) * 0.125, 0);
}

/* Default axes: pendulous z, x, y and output y, z, x for sensors along x, y, z; a sensor turned
 * round has its output axis turned round. */
static void pendulous_axes(void **state)
{
    (void)state;
    const double f[3] = {2, 3, 5};
    const imk_stimulus s = {.specific_force = {&f[0], &f[1], &f[2]}};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            imk_model model;
            imk_model_default(&model);
            model.accel.nonlinearity.cross_products.value[i][k] = 0x1p-7;
            const double input = f[i], pendulous = f[(i + 2) % 3], output = f[(i + 1) % 3];
            const double product[3] = {input * pendulous, input * output, pendulous * output};
            CHECK_CLOSE(read_one(&model, IMK_ACCEL, i, &s), f[i] + product[k] / 128, 0);
            model.accel.direction[i][i] = -1;
            const double turned[3] = {-1, 1, -1};
            CHECK_CLOSE(read_one(&model, IMK_ACCEL, i, &s), -f[i] + turned[k] * product[k] / 128,
                        0);
        }
    imk_model model;
    imk_model_default(&model);
    imk_error error;
    static imk_distortion distortion;
    model.accel.direction[1][1] = 0.6;
    model.accel.direction[1][0] = 0.8;
    CHECK_OK(imk_distortion_start(&distortion, &model, NULL, IMK_KERNEL_SCALAR, &error));
    model.accel.nonlinearity.cross_products.value[1][0] = 1e-6;
    distortion.cookie = 7;
    CHECK_STATUS(imk_distortion_start(&distortion, &model, NULL, IMK_KERNEL_SCALAR, &error),
                 IMK_ERROR_CONFLICT);
    assert_int_equal(distortion.cookie, 7); /* untouched */
    assert_int_equal(error.index, 1);
    assert_string_equal(error.field, "accel.cross_products");
    model.accel.nonlinearity.pendulous_axis[1][2] = 1;
    CHECK_OK(imk_model_validate(&model, &error));
    /* u = 0.8 2 + 0.6 3 = 3.4, p = 5 */
    CHECK_CLOSE(read_one(&model, IMK_ACCEL, 1, &s), 3.4 + 17e-6, 1e-15);
}

/* A motion of which one chunk is known and that stays so, while the warm-up goes on: what the whole
 * map reads of it. Some components, or the warm-up, are not there. */
static void a_still_unit_warms_up(void **state)
{
    (void)state;
    uint64_t random = 4;
    static imk_distortion distortion;
    static motion_samples m;
    double chunk[9][IMKI_CHUNK], whole[SAMPLES_MAX], still[SAMPLES_MAX];
    const imk_kernel kernels[2] = {IMK_KERNEL_SCALAR, imk_random_seeded(0).kernel};
    for (int trial = 0; trial < 100; trial++) {
        const imk_model model = draw_unit(&random, false);
        start(&distortion, &model, kernels[0]);
        draw_motion(&random, SAMPLES_MAX, &m);
        imk_stimulus at_rest = {.warm_up = {m.stimulus.warm_up[0], m.stimulus.warm_up[1]}};
        for (int c = 0; c < 9; c++) {
            const double **of = c < 3   ? &at_rest.angular_rate[c]
                                : c < 6 ? &at_rest.specific_force[c - 3]
                                        : &at_rest.angular_acceleration[c - 6];
            for (int k = 0; k < SAMPLES_MAX; k++)
                m.value[c][k] = m.value[c][0];
            for (int k = 0; k < IMKI_CHUNK; k++)
                chunk[c][k] = m.value[c][0];
            *of = trial % (c + 2) == 1 ? NULL : m.value[c];
        }
        if (trial % 5 == 4)
            at_rest.warm_up[0] = at_rest.warm_up[1] = NULL;
        imk_stimulus known = at_rest;
        for (int j = 0; j < 3; j++) {
            known.angular_rate[j] = at_rest.angular_rate[j] ? chunk[j] : NULL;
            known.specific_force[j] = at_rest.specific_force[j] ? chunk[3 + j] : NULL;
            known.angular_acceleration[j] = at_rest.angular_acceleration[j] ? chunk[6 + j] : NULL;
        }
        for (int sensor = 0; sensor < 2; sensor++)
            for (int i = 0; i < distortion.axis_count[sensor]; i++) {
                const imki_exposure exposure = imki_expose(sensor, &known);
                imk_distort(&distortion, sensor, i, &at_rest, SAMPLES_MAX, whole);
                imki_distort_still(kernels[trial % 2], &distortion.axis[sensor][i], &exposure,
                                   SAMPLES_MAX / IMKI_CHUNK, still);
                assert_memory_equal(whole, still, sizeof whole);
            }
    }
}

/* Units that differ in bias and scale factor only, worked on together: what each reads alone. */
static void units_alike(void **state)
{
    (void)state;
    enum { UNITS = 3 };
    uint64_t random = 6;
    static imk_distortion unit[UNITS];
    static motion_samples m;
    double alone[SAMPLES_MAX], together[UNITS][SAMPLES_MAX];
    double *const out[UNITS] = {together[0], together[1], together[2]};
    const imk_kernel best = imk_random_seeded(0).kernel;
    const imk_kernel kernels[] = {IMK_KERNEL_SCALAR, best,
                                  best == IMK_KERNEL_AVX512 ? IMK_KERNEL_AVX2 : best};
    for (int trial = 0; trial < 100; trial++) {
        const imk_model model = draw_unit(&random, false);
        draw_motion(&random, SAMPLES_MAX, &m);
        imk_stimulus s = {.warm_up = {m.stimulus.warm_up[0], m.stimulus.warm_up[1]}};
        for (int c = 0; c < 9; c++) {
            const double **of = c < 3   ? &s.angular_rate[c]
                                : c < 6 ? &s.specific_force[c - 3]
                                        : &s.angular_acceleration[c - 6];
            *of = trial % (c + 2) == 1 ? NULL : m.value[c];
        }
        for (int k = 0; k < UNITS; k++) {
            imk_run_constants constants = {.bias = {{0.0}}};
            for (int sensor = 0; sensor < 2; sensor++)
                for (int i = 0; i < 3; i++) {
                    constants.bias[sensor][i] = 0.1 * k * (i + 1);
                    constants.scale_factor[sensor][i] = 1e-3 * k * (i - 4);
                }
            CHECK_OK(imk_distortion_start(&unit[k], &model, &constants, kernels[0], NULL));
        }
        for (int sensor = 0; sensor < 2; sensor++)
            for (int i = 0; i < unit[0].axis_count[sensor]; i++) {
                const imki_exposure exposure = imki_expose(sensor, &s);
                const imk_axis_response *const axes[UNITS] = {
                    &unit[0].axis[sensor][i], &unit[1].axis[sensor][i], &unit[2].axis[sensor][i]};
                assert_true(imki_axes_alike(axes[0], axes[1]));
                imki_distort_alike(kernels[trial % 3], UNITS, axes, &exposure,
                                   SAMPLES_MAX / IMKI_CHUNK, out);
                for (int k = 0; k < UNITS; k++) {
                    imk_distort(&unit[k], sensor, i, &s, SAMPLES_MAX, alone);
                    assert_memory_equal(together[k], alone, sizeof alone);
                }
                imk_axis_response *const other = &unit[1].axis[sensor][i];
                double *const changed[] = {&other->input[0], &other->other[11], &other->power[0][0],
                                           &other->warm_up, &other->place[2]};
                *changed[trial % 5] += 1.0;
                assert_false(imki_axes_alike(axes[0], axes[1]));
            }
    }
}

static void constants_of_the_run(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    imk_run_constants constants = {.bias = {{0.5}}, .scale_factor = {{0.25}}};
    static imk_distortion distortion;
    const double w = 2;
    double out;
    model.gyro.bias.fixed.value[0] = 1;
    model.gyro.scale_factor.fixed.value[0] = 0.125;
    CHECK_OK(imk_distortion_start(&distortion, &model, &constants, IMK_KERNEL_SCALAR, NULL));
    imk_distort(&distortion, IMK_GYRO, 0, &(imk_stimulus){.angular_rate = {&w}}, 1, &out);
    CHECK_CLOSE(out, 1.5 + 2 + 0.375 * 2, 0);
}

/* Outside the valid range the polynomials stay at their end values; a temperature that is missing
 * leaves no number. */
static void temperature_is_clipped(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    imk_temperature_polynomial *p = &model.gyro.bias.temperature;
    p->order = 2;
    p->reference = 300;
    p->minimum = 290;
    p->maximum = 320;
    p->coefficient[0].value[0] = 1;
    p->coefficient[1].value[0] = 0.5;
    const double temperature[5] = {0, 290, 300, 320, 1000}, bias[5] = {40, 40, 0, 220, 220};
    for (int k = 0; k < 5; k++)
        CHECK_CLOSE(read_one(&model, IMK_GYRO, 0, &(imk_stimulus){.temperature = &temperature[k]}),
                    bias[k], 0);
    const double missing = (double)NAN;
    assert_true(isnan(read_one(&model, IMK_GYRO, 0, &(imk_stimulus){.temperature = &missing})));
    assert_false(isnan(read_one(&model, IMK_GYRO, 1, &(imk_stimulus){.temperature = &missing})));
    CHECK_CLOSE(read_one(&model, IMK_GYRO, 0, &(imk_stimulus){0}), 0, 0);
}

/* ---- hysteresis ------------------------------------------------------------------------------ */

/* From p = 0 warming by x L leads to 1 - e^-x, cooling by x L from p to -1 + (1 + p) e^-x; the step
 * does not matter. 2e-15: the roundings of 300 steps. */
static void hysteresis_follows_its_equation(void **state)
{
    (void)state;
    imk_triad triad = {0};
    imk_hysteresis h = imk_hysteresis_start(&triad), fine = h;
    double p[3], temperature[301], fine_p[301];
    const double turns[3] = {300, 320, 305};
    CHECK_CLOSE(h.span, 10, 0);
    imk_hysteresis_next(&h, 3, turns, p);
    const double up = 1 - exp(-2), down = -1 + (1 + up) * exp(-1.5);
    CHECK_CLOSE(p[0], 0, 0);
    CHECK_CLOSE(p[1], up, 4e-16);
    CHECK_CLOSE(p[2], down, 4e-16);
    for (int k = 0; k <= 300; k++)
        temperature[k] = k <= 200 ? 300 + 0.1 * k : 320 - 0.15 * (k - 200);
    imk_hysteresis_next(&fine, 150, temperature, fine_p);
    imk_hysteresis_next(&fine, 151, temperature + 150, fine_p + 150);
    CHECK_CLOSE(fine_p[200], up, 2e-15);
    CHECK_CLOSE(fine_p[300], down, 2e-15);
    triad.bias.temperature.order = 1;
    triad.bias.temperature.minimum = 240;
    triad.bias.temperature.maximum = 320;
    CHECK_CLOSE(imk_hysteresis_start(&triad).span, 10, 0);
}

/* A sweep over a range of 8 L there and back opens a loop of the width, less e^-8 at the ends; a
 * missing temperature is passed over. */
static void hysteresis_opens_a_loop(void **state)
{
    (void)state;
    imk_triad triad = {0};
    imk_hysteresis h = imk_hysteresis_start(&triad);
    const double path[8] = {260, (double)NAN, 340, 340, 300, 260, 300, 340};
    double p[8];
    imk_hysteresis_next(&h, 8, path, p);
    CHECK_CLOSE(p[1], p[0], 0);
    CHECK_CLOSE(p[3], p[2], 0);
    CHECK_CLOSE((p[6] - p[4]) / 2, 1, 2.1 * exp(-4)); /* in the middle, after 4 L */
    CHECK_CLOSE((p[7] - p[5]) / 2, 1, 2.1 * exp(-8));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equation_holds),
        cmocka_unit_test(bits_do_not_depend_on_the_division),
        cmocka_unit_test(constants_and_zeros),
        cmocka_unit_test(lever_arm_pulls_inwards),
        cmocka_unit_test(pendulous_axes),
        cmocka_unit_test(a_still_unit_warms_up),
        cmocka_unit_test(units_alike),
        cmocka_unit_test(constants_of_the_run),
        cmocka_unit_test(temperature_is_clipped),
        cmocka_unit_test(hysteresis_follows_its_equation),
        cmocka_unit_test(hysteresis_opens_a_loop),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
