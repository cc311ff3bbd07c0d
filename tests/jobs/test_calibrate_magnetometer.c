/* SPDX-License-Identifier: Apache-2.0 */
/* The calibration job with a magnetometer, from arrays: accelerometers and magnetometer at rest in
 * many attitudes. Each fault is told, and a sound log is told nothing. */
#include "check.h"

#include "imukit/attitude.h"
#include "imukit/jobs.h"
#include "imukit/random.h"

#include <stdio.h>
#include <string.h>

enum { RATE = 50, HOLD = 4 * RATE, MOVE = 2 * RATE, POSES = 24, ROWS = POSES * (HOLD + MOVE) };

static const double gravity = 9.80665;
static const double hard[3] = {12e-6, -8e-6, 30e-6};
/* Soft iron of unit determinant, to 1e-5. */
static const double soft[3][3] = {
    {1.02, 0.01, -0.02}, {0.005, 0.97, 0.003}, {0.001, 0.007, 1.01088}};

static double column[6][ROWS]; /* accel_x … z, mag_x … z */
static imk_calibrate_log *found;
static imk_error error;

static imk_vector3 in_body(imk_quaternion q, double x, double y, double z)
{
    return imk_quaternion_rotate(imk_quaternion_conjugate(q), (imk_vector3){{x, y, z}});
}

/* From one attitude, all of which are drawn, to the next. */
static void fill(void)
{
    static double noise[6 * ROWS];
    double draw[4 * (POSES + 1)];
    const imk_random random = imk_random_seeded(7);
    imk_random_normals(random, imk_stream(0, 1, 0, 0), 0, 4 * (POSES + 1), draw);
    imk_random_normals(random, imk_stream(0, 2, 0, 0), 0, 6 * (size_t)ROWS, noise);
    for (int row = 0; row < ROWS; row++) {
        const int pose = row / (HOLD + MOVE), within = row % (HOLD + MOVE);
        const double part = within < HOLD ? 0 : (double)(within - HOLD) / MOVE;
        double q[4];
        for (int i = 0; i < 4; i++)
            q[i] = (1 - part) * draw[4 * pose + i] + part * draw[4 * pose + 4 + i];
        const imk_quaternion attitude =
            imk_quaternion_normalise((imk_quaternion){q[0], q[1], q[2], q[3]});
        const imk_vector3 f = in_body(attitude, 0, 0, -gravity);
        const imk_vector3 u = in_body(attitude, 20e-6, 0, 43e-6);
        for (int i = 0; i < 3; i++) {
            column[i][row] = f.v[i] + 0.1 * (i - 1) + 2e-3 * noise[6 * row + i];
            column[3 + i][row] = hard[i] + 0.2e-6 * noise[6 * row + 3 + i];
            for (int j = 0; j < 3; j++)
                column[3 + i][row] += soft[i][j] * u.v[j];
        }
    }
}

static imk_calibrate_log_settings usual(void)
{
    imk_calibrate_log_settings settings = imk_calibrate_log_default();
    settings.gravity = gravity;
    return settings;
}

/* @param unit  of the magnetometer: "uT" or "count", in which its numbers are */
static imk_status run(imk_procedure procedure, const imk_calibrate_log_settings *settings,
                      int first, const char *unit)
{
    static char name[6][24];
    const char *names[6];
    const double *data[6];
    imk_array_source array;
    imk_record_source source;
    for (int k = first; k < 6; k++) {
        snprintf(name[k], sizeof name[k], "%s_%c%s%s%s", k < 3 ? "accel" : "mag", "xyz"[k % 3],
                 k < 3 ? "" : " [", k < 3 ? "" : unit, k < 3 ? "" : "]");
        names[k - first] = name[k];
        data[k - first] = column[k];
    }
    CHECK_OK(
        imk_array_source_make((size_t)(6 - first), names, data, ROWS, RATE, &array, &source, NULL));
    const imk_calibrate_input input = {"record", procedure, &source};
    return imk_calibrate_logs(1, &input, settings, NULL, &found, &error);
}

/* All three: is it told, how gravely, and is the magnetometer in the model? */
static void check_told(const char *code, imk_finding_level level, bool calibrated)
{
    bool told = false;
    for (size_t k = 0; k < found->findings.count; k++) {
        const imk_finding *f = &found->findings.item[k];
        if (strcmp(f->code, code) == 0) {
            char text[1200];
            told = f->level == level;
            assert_true(imk_finding_text(f, text, sizeof text) < sizeof text);
            assert_null(strchr(text, '{'));
        }
    }
    if (!told)
        fail_msg("%s is not told", code);
    assert_int_equal(found->model.mag.present, calibrated);
    imk_calibrate_log_free(found);
}

static void check_value(const char *name, double due)
{
    imk_model_parameter parameter;
    CHECK_OK(imk_model_parameter_parse(name, &parameter));
    const int k = imk_calibrate_find(found, parameter);
    assert_true(k >= 0);
    /* nine numbers, five sigmas */
    CHECK_CLOSE(found->result->value[k], due, 5 * found->result->sigma[k] + 1e-5 * fabs(due));
}

static void test_beside_accelerometers(void **state)
{
    (void)state;
    const imk_calibrate_log_settings settings = usual();
    fill();
    CHECK_OK(run(IMK_PROCEDURE_MULTIPOSITION, &settings, 0, "T"));
    assert_int_equal(found->findings.count, 0);
    assert_true(found->mag->aligned && !found->mag->field_known);
    check_value("mag.bias.fixed.x", hard[0]);
    check_value("mag.bias.fixed.z", hard[2]);
    check_value("mag.scale_factor.fixed.y", soft[1][1] - 1);
    check_value("mag.cross_axis.x.z", soft[0][2]);
    check_value("mag.cross_axis.y.x", soft[1][0]);
    /* tan(dip) = 43/20 */
    CHECK_CLOSE(found->mag->value[IMK_MAGNETOMETER_DIP], 43 / sqrt(43.0 * 43 + 400),
                6 * found->mag->sigma[IMK_MAGNETOMETER_DIP]);
    assert_string_equal(found->model.mag_evidence.frame, "upper-triangular");
    assert_int_equal(found->model.correlation.count, found->result->parameter_count);
    CHECK_OK(imk_model_validate(&found->model, &error));
    imk_calibrate_log_free(found);
}

/* The accelerometers' calibration is a part of the uncertainty, and correlated with it. */
static void test_accelerometers_share(void **state)
{
    (void)state;
    const imk_calibrate_log_settings settings = usual();
    fill();
    CHECK_OK(run(IMK_PROCEDURE_MULTIPOSITION, &settings, 0, "T"));
    const size_t n = found->result->parameter_count;
    double most = 0;
    for (size_t i = n - 12; i < n; i++)
        for (size_t j = 0; j < n - 12; j++)
            most = fmax(most, fabs(found->result->covariance[i * n + j]) /
                                  (found->result->sigma[i] * found->result->sigma[j]));
    assert_true(most > 0.02 && most < 1);
    double alone = 0, with = found->mag->covariance[4 * IMK_MAGNETOMETER_PARAMETERS + 4];
    static double scratch[POSES];
    static imk_magnetometer_result again;
    imk_magnetometer problem = *found->magnetometer;
    problem.accel = NULL;
    CHECK_OK(imk_magnetometer_solve(&problem, &again, scratch, NULL));
    alone = again.covariance[4 * IMK_MAGNETOMETER_PARAMETERS + 4];
    assert_true(with > alone);
    imk_calibrate_log_free(found);
}

static void test_alone(void **state)
{
    (void)state;
    imk_calibrate_log_settings settings = usual();
    fill();
    CHECK_OK(run(IMK_PROCEDURE_MAGNETOMETER, &settings, 3, "T"));
    assert_int_equal(found->findings.count, 0);
    assert_false(found->mag->aligned);
    assert_false(found->model.accel.present);
    check_value("mag.bias.fixed.y", hard[1]);
    assert_string_equal(found->model.mag_evidence.frame, "symmetric");
    CHECK_OK(imk_model_validate(&found->model, &error));
    imk_calibrate_log_free(found);
    /* A field that is given is the scale. */
    settings.field = 1.3 * sqrt(43.0 * 43 + 400) * 1e-6;
    settings.frame = IMK_FRAME_UPPER;
    CHECK_OK(run(IMK_PROCEDURE_MAGNETOMETER, &settings, 3, "T"));
    CHECK_CLOSE(found->model.mag.scale_factor.fixed.value[2], 1 / 1.3 - 1, 0.02);
    CHECK_CLOSE(found->model.mag.cross_axis.value[2][0], 0, 0);
    assert_int_equal(found->result->parameter_count, 9);
    check_told("mag_scale", IMK_FINDING_WARNING, true);
}

static void change_axes(int x, int y, int z, double sx, double sy, double sz)
{
    const int from[3] = {x, y, z};
    const double sign[3] = {sx, sy, sz};
    fill();
    for (int row = 0; row < ROWS; row++) {
        const double m[3] = {column[3][row], column[4][row], column[5][row]};
        for (int i = 0; i < 3; i++)
            column[3 + i][row] = sign[i] * m[from[i]];
    }
}

static void test_axes(void **state)
{
    (void)state;
    imk_calibrate_log_settings settings = usual();
    change_axes(1, 0, 2, 1, 1, -1);
    CHECK_OK(run(IMK_PROCEDURE_MULTIPOSITION, &settings, 0, "T"));
    assert_string_equal(found->findings.item[0].name, "mag x, y, z taken from y, x, -z\t"
                                                      "mag x, y, z taken from -y, -x, z");
    CHECK_CLOSE(found->findings.item[0].number[0], 65, 0.2);
    CHECK_CLOSE(found->findings.item[0].number[1], 1, 0); /* down */
    check_told("mag_axes", IMK_FINDING_WARNING, false);
    settings.dip = -1;
    CHECK_OK(run(IMK_PROCEDURE_MULTIPOSITION, &settings, 0, "T"));
    assert_memory_equal(found->findings.item[0].name, "mag x, y, z taken from -y, -x, z", 32);
    check_told("mag_axes_known", IMK_FINDING_WARNING, false);
    /* All inverted: only the sign of the dip tells. */
    change_axes(0, 1, 2, -1, -1, -1);
    settings.dip = NAN;
    CHECK_OK(run(IMK_PROCEDURE_MULTIPOSITION, &settings, 0, "T"));
    assert_int_equal(found->findings.count, 0);
    imk_calibrate_log_free(found);
    settings.place_known = true;
    settings.place.latitude = 0.84;
    CHECK_OK(run(IMK_PROCEDURE_MULTIPOSITION, &settings, 0, "T"));
    check_told("mag_inverted", IMK_FINDING_WARNING, false);
    settings.place.latitude = -0.84;
    CHECK_OK(run(IMK_PROCEDURE_MULTIPOSITION, &settings, 0, "T"));
    assert_true(found->model.mag.present);
    imk_calibrate_log_free(found);
    /* A third of a right angle is how it is mounted. */
    fill();
    for (int row = 0; row < ROWS; row++) {
        const double x = column[3][row], y = column[4][row];
        column[3][row] = 0.866 * x + 0.5 * y;
        column[4][row] = 0.866 * y - 0.5 * x;
    }
    settings = usual();
    CHECK_OK(run(IMK_PROCEDURE_MULTIPOSITION, &settings, 0, "T"));
    assert_int_equal(found->findings.count, 0);
    assert_true(found->model.mag.present);
    imk_calibrate_log_free(found);
    /* So is more than half of one, but nearer to other axes: it is said. */
    fill();
    for (int row = 0; row < ROWS; row++) {
        const double x = column[3][row], y = column[4][row];
        column[3][row] = 0.6428 * x + 0.766 * y;
        column[4][row] = 0.6428 * y - 0.766 * x;
    }
    CHECK_OK(run(IMK_PROCEDURE_MULTIPOSITION, &settings, 0, "T"));
    assert_int_equal(found->findings.count, 1);
    check_told("mag_mounting", IMK_FINDING_WARNING, true);
}

static void test_units(void **state)
{
    (void)state;
    const imk_calibrate_log_settings settings = usual();
    fill();
    CHECK_OK(run(IMK_PROCEDURE_MULTIPOSITION, &settings, 0, "mT"));
    assert_string_equal(found->findings.item[0].name, "T");
    check_told("mag_field_unit", IMK_FINDING_WARNING, true);
    for (int k = 3; k < 6; k++)
        for (int row = 0; row < ROWS; row++)
            column[k][row] *= 5e4; /* 2.4 T */
    CHECK_OK(run(IMK_PROCEDURE_MULTIPOSITION, &settings, 0, "T"));
    check_told("mag_field", IMK_FINDING_WARNING, true);
    fill();
    for (int row = 0; row < ROWS; row++)
        column[5][row] *= 0.1; /* one axis in another unit */
    CHECK_OK(run(IMK_PROCEDURE_MULTIPOSITION, &settings, 0, "T"));
    check_told("mag_shape", IMK_FINDING_WARNING, false);
    CHECK_OK(run(IMK_PROCEDURE_MULTIPOSITION, &settings, 0, "count"));
    check_told("mag_counts_left", IMK_FINDING_WARNING, false);
    CHECK_STATUS(run(IMK_PROCEDURE_MAGNETOMETER, &settings, 3, "count"), IMK_ERROR_UNIT_MISSING);
    assert_string_equal(imk_findings_failure(&found->record[0].loaded)->code, "mag_counts");
    imk_calibrate_log_free(found);
    CHECK_STATUS(run(IMK_PROCEDURE_MULTIPOSITION, &settings, 3, "T"), IMK_ERROR_COLUMN);
    assert_string_equal(imk_findings_failure(&found->record[0].loaded)->code, "magnetometer_only");
    imk_calibrate_log_free(found);
}

/* A scale that no sensor has is none: which unit was taken for which, by the ratio. */
static void test_useless_scales(void **state)
{
    (void)state;
    static const struct {
        double field; /* [uT] */
        const char *unit, *words;
        bool given;
    } faults[] = {{0.474, "T", "gauss taken for uT", true},
                  {474, "T", "mG taken for uT", true},
                  {47.4, "mT", "T taken for mT, or mT taken for uT, or uT taken for nT", false},
                  {47.4, "uT", "T taken for uT, or mT taken for nT", false},
                  {100, "T", "", false}};
    imk_calibrate_log_settings settings = usual();
    fill();
    settings.field = 0.0474; /* no field of the Earth in any unit */
    CHECK_STATUS(run(IMK_PROCEDURE_MAGNETOMETER, &settings, 3, "T"), IMK_ERROR_RANGE);
    for (size_t k = 0; k < sizeof faults / sizeof *faults; k++) {
        const char *code = faults[k].words[0] ? "mag_scale_unit" : "mag_scale_useless";
        settings.field = 1e-6 * faults[k].field;
        CHECK_STATUS(run(IMK_PROCEDURE_MAGNETOMETER, &settings, 3, faults[k].unit),
                     IMK_ERROR_CONFLICT);
        const imk_finding *f = imk_findings_failure(&found->findings);
        assert_string_equal(f->code, code);
        assert_string_equal(f->name, faults[k].words);
        assert_true((f->number[2] != 0) == faults[k].given || !faults[k].words[0]);
        check_told(code, IMK_FINDING_FAILURE, false);
        CHECK_OK(run(IMK_PROCEDURE_MULTIPOSITION, &settings, 0, faults[k].unit));
        check_told(code, IMK_FINDING_WARNING, false);
    }
}

static void test_records(void **state)
{
    (void)state;
    const imk_calibrate_log_settings settings = usual();
    fill();
    for (int row = 0; row < ROWS; row++)
        column[4][row] = 5e-6;
    CHECK_OK(run(IMK_PROCEDURE_MULTIPOSITION, &settings, 0, "T"));
    check_told("mag_stuck", IMK_FINDING_WARNING, false);
    CHECK_STATUS(run(IMK_PROCEDURE_MAGNETOMETER, &settings, 3, "T"), IMK_ERROR_RANGE);
    check_told("mag_stuck", IMK_FINDING_FAILURE, false);
    fill();
    for (int row = 0; row < ROWS; row++)
        column[5][row] = fmin(column[5][row], 50e-6);
    CHECK_OK(run(IMK_PROCEDURE_MULTIPOSITION, &settings, 0, "T"));
    check_told("mag_saturated", IMK_FINDING_WARNING, false);
    fill();
    for (int row = 0; row < ROWS; row++)
        for (int k = 3; k < 6 && row % 5 > 0; k++)
            column[k][row] = column[k][row - 1];
    CHECK_OK(run(IMK_PROCEDURE_MULTIPOSITION, &settings, 0, "T"));
    check_told("mag_held", IMK_FINDING_NOTE, true);
}

/* Another field in each attitude, or in three of them; and attitudes that are alike. */
static void test_field(void **state)
{
    (void)state;
    const imk_calibrate_log_settings settings = usual();
    double draw[3 * POSES];
    imk_random_normals(imk_random_seeded(9), imk_stream(0, 1, 0, 0), 0, 3 * POSES, draw);
    for (int bad = 0; bad < 2; bad++) {
        fill();
        for (int row = 0; row < ROWS; row++)
            for (int i = 0; i < 3; i++) {
                const int pose = row / (HOLD + MOVE);
                column[3 + i][row] += bad ? (pose % 8 == 0 ? 9e-6 : 0) : 1e-6 * draw[3 * pose + i];
            }
        CHECK_OK(run(IMK_PROCEDURE_MULTIPOSITION, &settings, 0, "T"));
        if (bad)
            assert_int_equal(found->mag->refused, 3);
        check_told(bad ? "mag_outliers" : "mag_disturbed", IMK_FINDING_WARNING, true);
    }
    fill();
    for (int row = 0; row < ROWS; row++) {
        const double angle = 1e-3 * row;
        column[3][row] = 20e-6 * cos(angle);
        column[4][row] = 20e-6 * sin(angle);
        column[5][row] = 43e-6 + 1e-3 * (column[5][row] - 43e-6);
    }
    CHECK_STATUS(run(IMK_PROCEDURE_MAGNETOMETER, &settings, 3, "T"), IMK_ERROR_SINGULAR);
    check_told("mag_coverage", IMK_FINDING_FAILURE, false);
}

/* What goes into the model is what compensation takes out. */
static void test_shown(void **state)
{
    (void)state;
    const imk_calibrate_log_settings settings = usual();
    fill();
    CHECK_OK(run(IMK_PROCEDURE_MULTIPOSITION, &settings, 0, "T"));
    assert_true(found->model.mag_evidence.interval_count == 2);
    assert_non_null(strstr(found->model.mag_evidence.method, "24 means"));
    imk_calibrate_log_free(found);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_beside_accelerometers),
                                       cmocka_unit_test(test_accelerometers_share),
                                       cmocka_unit_test(test_alone),
                                       cmocka_unit_test(test_axes),
                                       cmocka_unit_test(test_units),
                                       cmocka_unit_test(test_useless_scales),
                                       cmocka_unit_test(test_records),
                                       cmocka_unit_test(test_field),
                                       cmocka_unit_test(test_shown)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
