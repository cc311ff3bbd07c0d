/* SPDX-License-Identifier: Apache-2.0 */
/* The inverse map: distort and correct is the identity within the proven bound, for a hundred
 * thousand random units and motions; one output per axis; counts; refusals. */
#include "check.h"
#include "moving_unit.h"

#include "imukit/correct.h"
#include "imukit/random.h"

#include <stdlib.h>

/* What a unit reads, and what the correction makes of it. */
typedef struct round_trip {
    double reading[2][IMK_AXES_MAX][SAMPLES_MAX], out[2][IMK_AXES_MAX][SAMPLES_MAX];
    imk_readings readings;
    double *outputs[2][IMK_AXES_MAX];
} round_trip;

static void pass(const imk_correction *c, const motion_samples *m, size_t count, round_trip *t)
{
    imk_stimulus without_hysteresis = m->stimulus;
    memset(without_hysteresis.hysteresis, 0, sizeof without_hysteresis.hysteresis);
    t->readings = (imk_readings){.temperature = m->stimulus.temperature,
                                 .temperature_rate = m->stimulus.temperature_rate};
    for (int s = 0; s < 2; s++) {
        t->readings.warm_up[s] = m->stimulus.warm_up[s];
        for (int i = 0; i < c->distortion.axis_count[s]; i++) {
            imk_distort(&c->distortion, s, i, &without_hysteresis, count, t->reading[s][i]);
            t->readings.channel[s][i] = t->reading[s][i];
        }
        for (int i = 0; i < IMK_AXES_MAX; i++)
            t->outputs[s][i] = t->out[s][i];
    }
    for (int j = 0; j < 3; j++)
        t->readings.angular_acceleration[j] = m->stimulus.angular_acceleration[j];
    imk_correct(c, &t->readings, count, (double *const(*)[IMK_AXES_MAX])t->outputs);
}

/* Largest |e . x| of the axes of a triad. */
static double largest_input(const imk_triad *triad, const double x[3])
{
    double largest = 0;
    for (int i = 0; i < triad->axis_count; i++) {
        const double *e = triad->direction[i];
        largest = fmax(largest, fabs(e[0] * x[0] + e[1] * x[1] + e[2] * x[2]));
    }
    return largest;
}

/* Motion within the limits of a correction: no input beyond the range and a tenth. At lever arms of
 * 5 cm per component the forces of rotation are up to 42 m/s^2, a fifth of the limit. */
static void within_limits(const imk_model *model, size_t count, motion_samples *m)
{
    for (int s = 0; s < 2; s++)
        for (size_t k = 0; k < count; k++) {
            double x[3], most = s == IMK_GYRO ? 1.1 * RATE_RANGE : 0.8 * 1.1 * FORCE_RANGE;
            for (int j = 0; j < 3; j++)
                x[j] = m->value[3 * s + j][k] *= 1.5;
            const double input = largest_input(s == IMK_GYRO ? &model->gyro : &model->accel, x);
            for (int j = 0; j < 3 && input > most; j++)
                m->value[3 * s + j][k] *= most / input;
        }
}

/* Largest error of the outputs relative to the limit, beyond the bound. */
static double excess(const imk_correction *c, const motion_samples *m, size_t count,
                     const round_trip *t)
{
    double worst = 0;
    for (int s = 0; s < 2; s++)
        for (int j = 0; j < 3; j++)
            for (size_t k = 0; k < count; k++) {
                const double off = fabs(t->out[s][j][k] - m->value[3 * s + j][k]) - c->bound[s];
                worst = fmax(worst, off / c->limit[s][j]);
                if (!(off == off))
                    worst = (double)INFINITY;
            }
    return worst;
}

/* How much rounding adds to the bound: the response is computed to some 40 roundings of the largest
 * term, 1e-14 of the range (test_distort.c; 1e-15 seen), and J+ of these cones of axes, with errors
 * in them, is below 5. */
static const double rounding = 1e-14;

enum { LINEAR_UNITS = 1600, UNITS = 2600, MOTIONS = 25 };

static void units_without_nonlinearity(void **state)
{
    (void)state;
    uint64_t random = 11;
    static imk_correction c;
    static motion_samples m;
    static round_trip t;
    imk_error error;
    double worst = 0;
    for (int trial = 0; trial < LINEAR_UNITS; trial++) {
        const imk_model model = draw_unit(&random, true);
        imk_correction_settings settings = imk_correction_default();
        settings.kernel = imk_random_seeded(0).kernel;
        CHECK_OK(imk_model_validate(&model, &error));
        CHECK_OK(imk_correction_start(&c, &model, &settings, &error));
        if (model.gyro.scale_factor.temperature.order == 0 &&
            model.accel.scale_factor.temperature.order == 0)
            assert_true(c.iterations == 1 && c.contraction == 0);
        draw_motion(&random, MOTIONS, &m);
        within_limits(&model, MOTIONS, &m);
        pass(&c, &m, MOTIONS, &t);
        worst = fmax(worst, excess(&c, &m, MOTIONS, &t));
        for (int s = 0; s < 2; s++)
            CHECK_BELOW(c.bound[s],
                        1e-14 * 1.01 * fmax(fmax(c.limit[s][0], c.limit[s][1]), c.limit[s][2]));
    }
    CHECK_BELOW(worst, rounding);
}

/* Everything together: lever arms, g- and g2-sensitivity, nonlinearity, cross products. */
static void complete_units(void **state)
{
    (void)state;
    uint64_t random = 12;
    static imk_correction c;
    static motion_samples m;
    static round_trip t;
    imk_error error;
    double worst = 0;
    int most = 0, refusals = 0;
    for (int trial = 0; trial < UNITS; trial++) {
        const imk_model model = draw_unit(&random, false);
        imk_correction_settings settings = imk_correction_default();
        settings.kernel = imk_random_seeded(0).kernel;
        CHECK_OK(imk_model_validate(&model, &error));
        /* A few of these units are so poor that nothing can be proven. */
        if (imk_correction_start(&c, &model, &settings, &error) != IMK_OK) {
            assert_int_equal(error.status, IMK_ERROR_NO_CONVERGENCE);
            refusals++;
            continue;
        }
        assert_true(c.contraction >= 0 && c.contraction < 1);
        draw_motion(&random, MOTIONS, &m);
        within_limits(&model, MOTIONS, &m);
        pass(&c, &m, MOTIONS, &t);
        worst = fmax(worst, excess(&c, &m, MOTIONS, &t));
        most = c.iterations > most ? c.iterations : most;
    }
    CHECK_BELOW(worst, rounding);
    assert_true(most > 5); /* else nothing was hard */
    assert_true(refusals <= UNITS / 200);
}

/* The bound is proven, and so holds after a few iterations too: with a coarse tolerance, where
 * rounding is nothing beside it. It is also not far off: some unit comes within a factor 1000. */
static void bound_is_never_exceeded(void **state)
{
    (void)state;
    uint64_t random = 13;
    static imk_correction c;
    static motion_samples m;
    static round_trip t;
    double closest = 0;
    for (int trial = 0; trial < 600; trial++) {
        const imk_model model = draw_unit(&random, false);
        imk_correction_settings settings = imk_correction_default();
        settings.tolerance = trial % 2 ? 1e-2 : 1e-5;
        CHECK_OK(imk_correction_start(&c, &model, &settings, NULL));
        draw_motion(&random, MOTIONS, &m);
        within_limits(&model, MOTIONS, &m);
        pass(&c, &m, MOTIONS, &t);
        for (int s = 0; s < 2; s++)
            for (int j = 0; j < 3; j++)
                for (int k = 0; k < MOTIONS; k++) {
                    const double off = fabs(t.out[s][j][k] - m.value[3 * s + j][k]);
                    CHECK_BELOW(off, c.bound[s] + rounding * c.limit[s][j]);
                    closest = fmax(closest, off / (c.bound[s] + 1e-12));
                }
    }
    assert_true(closest > 1e-3);
}

/* ---- convergence ----------------------------------------------------------------------------- */

/* Forces depend on rates through a lever arm, but not the rates on the forces: P^2 = 0 whatever the
 * arm is, so two steps are enough, also for an arm of a hundred metres. */
static void lever_arms_alone_take_two_steps(void **state)
{
    (void)state;
    static imk_correction c;
    imk_model model;
    imk_model_default(&model);
    for (int i = 0; i < 3; i++) {
        model.gyro.range.value[i] = 10;
        model.accel.range.value[i] = 100;
        model.accel.lever_arm.value[i][(i + 1) % 3] = 100;
    }
    CHECK_OK(imk_correction_start(&c, &model, NULL, NULL));
    assert_int_equal(c.iterations, 2);
    CHECK_CLOSE(c.contraction, 0, 0);
}

/* y = u + K3 u^3 with K3 U^2 = 0.3: the slope is 1 to 1.9, J its middle 1.45, and the contraction
 * 0.45/1.45. */
static void contraction_of_a_cubic(void **state)
{
    (void)state;
    static imk_correction c;
    imk_correction_settings settings = imk_correction_default();
    imk_model model;
    imk_model_default(&model);
    model.accel.present = false;
    for (int i = 0; i < 3; i++)
        model.gyro.nonlinearity.k3.value[i] = 0.3;
    settings.rate_limit = 1;
    CHECK_OK(imk_correction_start(&c, &model, &settings, NULL));
    CHECK_RELATIVE(c.inverse[0][0], 1 / 1.45, 1e-15);
    CHECK_RELATIVE(c.contraction, 0.45 / 1.45, 1e-12); /* 1e-14 is left, which widens the box */
    /* a slope that falls to 1 - 0.9, just not to nothing: 0.45/0.55 */
    for (int i = 0; i < 3; i++)
        model.gyro.nonlinearity.k3.value[i] = -0.3;
    CHECK_OK(imk_correction_start(&c, &model, &settings, NULL));
    CHECK_RELATIVE(c.contraction, 0.45 / 0.55, 1e-12);
    assert_true(c.iterations > 100);
}

/* Readings far beyond the limits of a cubic that turns back behind them stay finite, and do nothing
 * to the other axes. */
static void glitches_stay_finite(void **state)
{
    (void)state;
    static imk_correction c;
    imk_model model;
    imk_model_default(&model);
    model.accel.present = false;
    for (int i = 0; i < 3; i++) {
        model.gyro.range.value[i] = 10;
        model.gyro.nonlinearity.k3.value[i] = -1e-3;
    }
    CHECK_OK(imk_correction_start(&c, &model, NULL, NULL));
    const double reading[3] = {1e9, 5 - 0.125, -1e300};
    double out[3];
    imk_readings readings = {.channel = {{&reading[0], &reading[1], &reading[2]}}};
    double *outputs[2][IMK_AXES_MAX] = {{&out[0], &out[1], &out[2]}};
    imk_correct(&c, &readings, 1, (double *const(*)[IMK_AXES_MAX])outputs);
    assert_true(out[0] > 1e8 && out[0] < 1e10);
    CHECK_CLOSE(out[1], 5, c.bound[IMK_GYRO] + 1e-14);
    assert_true(out[2] < -1e299 && isfinite(out[2]));
}

static void bits_do_not_depend_on_the_division(void **state)
{
    (void)state;
    uint64_t random = 14;
    static imk_correction scalar, fast;
    static motion_samples m;
    static round_trip t;
    static double whole[2][IMK_AXES_MAX][SAMPLES_MAX];
    imk_correction_settings settings = imk_correction_default();
    for (int trial = 0; trial < 10; trial++) {
        const imk_model model = draw_unit(&random, false);
        settings.kernel = IMK_KERNEL_SCALAR;
        CHECK_OK(imk_correction_start(&scalar, &model, &settings, NULL));
        settings.kernel = imk_random_seeded(0).kernel;
        CHECK_OK(imk_correction_start(&fast, &model, &settings, NULL));
        draw_motion(&random, SAMPLES_MAX, &m);
        pass(&scalar, &m, SAMPLES_MAX, &t);
        memcpy(whole, t.out, sizeof whole);
        pass(&fast, &m, SAMPLES_MAX, &t);
        assert_memory_equal(whole, t.out, sizeof whole);
        /* the first 100, and these in place of the readings, in pieces */
        for (int s = 0; s < 2; s++)
            for (int j = 0; j < 3; j++)
                t.outputs[s][j] = t.reading[s][j];
        imk_correct(&fast, &t.readings, 100, (double *const(*)[IMK_AXES_MAX])t.outputs);
        for (int s = 0; s < 2; s++)
            for (int j = 0; j < 3; j++)
                assert_memory_equal(whole[s][j], t.reading[s][j], 100 * sizeof(double));
    }
}

/* ---- one output per axis --------------------------------------------------------------------- */

static void single_axes_give_their_inputs(void **state)
{
    (void)state;
    static imk_correction c;
    imk_model model;
    imk_model_default(&model);
    model.gyro.present = false;
    model.accel.axis_count = 2;
    model.accel.direction[1][0] = 0.6; /* not at right angles, in the x-y plane */
    model.accel.direction[1][1] = 0.8;
    for (int i = 0; i < 2; i++) {
        model.accel.bias.fixed.value[i] = 0.5;
        model.accel.scale_factor.fixed.value[i] = 0.01;
        model.accel.nonlinearity.k2.value[i] = 1e-4;
        model.accel.misalignment.value[i][0] = 0.02;
        model.accel.range.value[i] = 100;
    }
    CHECK_OK(imk_model_validate(&model, NULL));
    CHECK_OK(imk_correction_start(&c, &model, NULL, NULL));
    assert_false(c.solves[IMK_ACCEL]);
    assert_int_equal(c.output_count[IMK_GYRO], 0);
    assert_int_equal(c.output_count[IMK_ACCEL], 2);
    /* The input of the second axis is 7 along its own direction: f = (4.2, 5.6), of which the
     * misalignment sees 4.2. */
    double out[2], reading[2];
    const double u[2] = {-3, 7}, x[2] = {-3, 4.2};
    imk_readings readings = {0};
    double *outputs[2][IMK_AXES_MAX] = {{NULL}, {&out[0], &out[1]}};
    for (int i = 0; i < 2; i++) {
        reading[i] = 0.5 + 1.01 * u[i] + 0.02 * x[i] + 1e-4 * u[i] * u[i];
        readings.channel[IMK_ACCEL][i] = &reading[i];
    }
    imk_correct(&c, &readings, 1, (double *const(*)[IMK_AXES_MAX])outputs);
    CHECK_CLOSE(out[0], -3, c.bound[IMK_ACCEL] + 1e-14);
    CHECK_CLOSE(out[1], 7, c.bound[IMK_ACCEL] + 1e-14);
}

/* A single gyro beside three accelerometers: its g-sensitivity is taken out. */
static void single_gyro_beside_accelerometers(void **state)
{
    (void)state;
    static imk_correction c;
    imk_model model;
    imk_model_default(&model);
    model.gyro.axis_count = 1;
    const double g[3] = {1e-3, 2e-3, -1e-3}, f[3] = {5, -2, 9.5};
    memcpy(model.gyro.g_sensitivity.value[0], g, sizeof g);
    CHECK_OK(imk_correction_start(&c, &model, NULL, NULL));
    double out[4];
    const double reading = 0.7 + 5e-3 - 4e-3 - 9.5e-3;
    imk_readings readings = {.channel = {{&reading}, {&f[0], &f[1], &f[2]}}};
    double *outputs[2][IMK_AXES_MAX] = {{&out[0]}, {&out[1], &out[2], &out[3]}};
    imk_correct(&c, &readings, 1, (double *const(*)[IMK_AXES_MAX])outputs);
    CHECK_CLOSE(out[0], 0.7, 1e-15);
    for (int j = 0; j < 3; j++)
        CHECK_CLOSE(out[1 + j], f[j], 1e-15);
}

static void counts_become_units(void **state)
{
    (void)state;
    static imk_correction c;
    imk_model model;
    imk_model_default(&model);
    model.accel.present = false;
    for (int i = 0; i < 3; i++) {
        model.gyro.sensitivity.value[i] = 1000;
        model.gyro.zero_offset.value[i] = 32768;
        model.gyro.bias.fixed.value[i] = 0.5;
    }
    CHECK_OK(imk_correction_start(&c, &model, NULL, NULL));
    const double reading = 32768 + 1000 * (2 + 0.5), missing = (double)NAN;
    double out[3];
    imk_readings readings = {.channel = {{&reading, &missing, &reading}}};
    double *outputs[2][IMK_AXES_MAX] = {{&out[0], &out[1], &out[2]}};
    imk_correct(&c, &readings, 1, (double *const(*)[IMK_AXES_MAX])outputs);
    CHECK_CLOSE(out[0], 2, 1e-15);
    assert_true(isnan(out[1]));
    CHECK_CLOSE(out[2], 2, 1e-15);
}

/* Four axes with noise on one: the least-squares solution, by its definition: the residuals are at
 * right angles to the columns of the directions. */
static void redundant_axes_are_least_squares(void **state)
{
    (void)state;
    static imk_correction c;
    imk_model model;
    imk_model_default(&model);
    model.accel.present = false;
    model.gyro.axis_count = 4;
    for (int j = 0; j < 3; j++)
        model.gyro.direction[3][j] = sqrt(1.0 / 3);
    CHECK_OK(imk_correction_start(&c, &model, NULL, NULL));
    const double reading[4] = {1, 2, 3, 3.6};
    double out[3];
    imk_readings readings = {.channel = {{&reading[0], &reading[1], &reading[2], &reading[3]}}};
    double *outputs[2][IMK_AXES_MAX] = {{&out[0], &out[1], &out[2]}};
    imk_correct(&c, &readings, 1, (double *const(*)[IMK_AXES_MAX])outputs);
    for (int j = 0; j < 3; j++) {
        double sum = 0;
        for (int i = 0; i < 4; i++) {
            const double *e = model.gyro.direction[i];
            sum += e[j] * (reading[i] - e[0] * out[0] - e[1] * out[1] - e[2] * out[2]);
        }
        CHECK_CLOSE(sum, 0, 1e-14);
    }
}

/* ---- refusals -------------------------------------------------------------------------------- */

static void refused(const imk_model *model, imk_status status, const char *field, imk_error *error)
{
    static imk_correction c;
    c.cookie = 7;
    CHECK_STATUS(imk_correction_start(&c, model, NULL, error), status);
    assert_string_equal(error->field, field);
    assert_int_equal(c.cookie, 7); /* untouched */
    assert_true(error->expected[0] != '\0');
}

/* u + K3 u^3 turns where 1 + 3 K3 u^2 = 0; u + K2 u^2 at u = -1/(2 K2). */
static void readings_that_turn_back(void **state)
{
    (void)state;
    imk_error error;
    imk_model model;
    imk_model_default(&model);
    for (int i = 0; i < 3; i++)
        model.gyro.range.value[i] = 10;
    model.gyro.nonlinearity.k3.value[1] = -1.0 / 300;
    refused(&model, IMK_ERROR_NO_CONVERGENCE, "gyro.nonlinearity.k3", &error);
    assert_int_equal(error.index, 1);
    CHECK_RELATIVE(fabs(error.value), 10, 1e-14);
    CHECK_RELATIVE(error.limit, 11, 1e-14);
    assert_non_null(strstr(error.found, "turns back at an input of "));
    model.gyro.nonlinearity.k3.value[1] = 0;
    model.gyro.nonlinearity.k2.value[2] = 0.05;
    refused(&model, IMK_ERROR_NO_CONVERGENCE, "gyro.nonlinearity.k2", &error);
    assert_int_equal(error.index, 2);
    CHECK_RELATIVE(error.value, -10, 1e-14);
    model.gyro.nonlinearity.k2.value[2] = 0;
    model.gyro.nonlinearity.koq.value[0] = -0.05;
    refused(&model, IMK_ERROR_NO_CONVERGENCE, "gyro.nonlinearity.koq", &error);
    CHECK_RELATIVE(fabs(error.value), 10, 1e-14);
}

/* A scale factor that vanishes within the temperatures. */
static void scale_factor_that_vanishes(void **state)
{
    (void)state;
    imk_error error;
    imk_model model;
    imk_model_default(&model);
    imk_temperature_polynomial *p = &model.accel.scale_factor.temperature;
    p->order = 1;
    p->reference = 300;
    p->minimum = 250;
    p->maximum = 350;
    p->coefficient[0].value[2] = 0.021;
    refused(&model, IMK_ERROR_NO_CONVERGENCE, "accel.scale_factor.temperature", &error);
    p->coefficient[0].value[2] = 0.015;
    static imk_correction c;
    CHECK_OK(imk_correction_start(&c, &model, NULL, &error));
}

/* Strong coupling both ways: force on the gyros, and rotation on the accelerometers. */
static void coupling_both_ways(void **state)
{
    (void)state;
    imk_error error;
    imk_model model;
    imk_model_default(&model);
    for (int i = 0; i < 3; i++) {
        model.gyro.range.value[i] = 30;
        model.accel.range.value[i] = 100;
        for (int j = 0; j < 3; j++) {
            model.accel.lever_arm.value[i][j] = 1;
            model.gyro.g_sensitivity.value[i][j] = 0.1;
        }
    }
    static imk_correction c;
    CHECK_STATUS(imk_correction_start(&c, &model, NULL, &error), IMK_ERROR_NO_CONVERGENCE);
    assert_true(error.value > 1 && error.limit == 1);
    assert_true(strcmp(error.field, "accel.lever_arm") == 0 ||
                strcmp(error.field, "gyro.g_sensitivity") == 0);
}

static void what_is_missing_is_named(void **state)
{
    (void)state;
    imk_error error;
    static imk_correction c;
    imk_correction_settings settings = imk_correction_default();
    imk_model model;
    imk_model_default(&model);
    model.gyro.nonlinearity.k2.value[0] = 1e-4;
    refused(&model, IMK_ERROR_KEY_MISSING, "gyro.range", &error);
    settings.rate_limit = 10;
    CHECK_OK(imk_correction_start(&c, &model, &settings, &error));
    /* Products in one direction are found in two steps whatever the range is; not in both. */
    imk_model_default(&model);
    model.accel.lever_arm.value[0][0] = 0.1;
    CHECK_OK(imk_correction_start(&c, &model, NULL, &error));
    assert_int_equal(c.iterations, 2);
    model.gyro.g_sensitivity.value[0][0] = 1e-5;
    refused(&model, IMK_ERROR_KEY_MISSING, "gyro.range", &error);
    imk_model_default(&model);
    model.gyro.g2_sensitivity.value[0][0] = 1e-7;
    CHECK_OK(imk_correction_start(&c, &model, NULL, &error));
    assert_int_equal(c.iterations, 2);
    model.gyro.nonlinearity.asymmetry.value[1] = 1e-3;
    refused(&model, IMK_ERROR_KEY_MISSING, "accel.range", &error);
    model.accel.present = false;
    refused(&model, IMK_ERROR_CONFLICT, "gyro.g2_sensitivity", &error);
    model.gyro.g_sensitivity.value[0][0] = 1e-7;
    refused(&model, IMK_ERROR_CONFLICT, "gyro.g_sensitivity", &error);
    imk_model_default(&model);
    model.gyro.present = false;
    model.accel.lever_arm.value[0][0] = 0.1;
    refused(&model, IMK_ERROR_CONFLICT, "accel.lever_arm", &error);
}

static void singular_directions(void **state)
{
    (void)state;
    imk_error error;
    imk_model model;
    imk_model_default(&model);
    model.accel.axis_count = 2;
    model.gyro.g_sensitivity.value[0][0] = 1e-5;
    refused(&model, IMK_ERROR_SINGULAR, "accel.direction", &error);
    imk_model_default(&model);
    model.gyro.axis_count = 2;
    model.accel.lever_arm.value[0][0] = 0.1;
    refused(&model, IMK_ERROR_SINGULAR, "gyro.direction", &error);
    /* Directions that span space, with errors that turn one axis into another. */
    imk_model_default(&model);
    model.gyro.misalignment.value[0][1] = 1;
    model.gyro.misalignment.value[1][0] = 1;
    refused(&model, IMK_ERROR_SINGULAR, "gyro.misalignment", &error);
}

static void settings_are_checked(void **state)
{
    (void)state;
    static imk_correction c;
    imk_error error;
    imk_model model;
    imk_model_default(&model);
    imk_correction_settings settings = {0};
    CHECK_STATUS(imk_correction_start(&c, &model, &settings, &error), IMK_ERROR_UNINITIALISED);
    settings = imk_correction_default();
    settings.tolerance = 0;
    CHECK_STATUS(imk_correction_start(&c, &model, &settings, &error), IMK_ERROR_RANGE);
    settings = imk_correction_default();
    settings.force_limit = (double)NAN;
    CHECK_STATUS(imk_correction_start(&c, &model, &settings, &error), IMK_ERROR_RANGE);
    assert_string_equal(error.field, "force_limit");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(units_without_nonlinearity),
        cmocka_unit_test(complete_units),
        cmocka_unit_test(bound_is_never_exceeded),
        cmocka_unit_test(lever_arms_alone_take_two_steps),
        cmocka_unit_test(contraction_of_a_cubic),
        cmocka_unit_test(glitches_stay_finite),
        cmocka_unit_test(bits_do_not_depend_on_the_division),
        cmocka_unit_test(single_axes_give_their_inputs),
        cmocka_unit_test(single_gyro_beside_accelerometers),
        cmocka_unit_test(counts_become_units),
        cmocka_unit_test(redundant_axes_are_least_squares),
        cmocka_unit_test(readings_that_turn_back),
        cmocka_unit_test(scale_factor_that_vanishes),
        cmocka_unit_test(coupling_both_ways),
        cmocka_unit_test(what_is_missing_is_named),
        cmocka_unit_test(singular_directions),
        cmocka_unit_test(settings_are_checked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
