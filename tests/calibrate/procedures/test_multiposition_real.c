/* SPDX-License-Identifier: Apache-2.0 */
/* Published multi-position calibrations of real units: an Xsens MTi from raw counts, two MPU-9150.
 * Skipped when the data folder is not beside the checkout. Published values: shared design notes,
 * golden.md, recomputed there by a second program. */
#include "check.h"

#include "imukit/attitude.h"
#include "imukit/log.h"
#include "imukit/procedure.h"

#include <stdlib.h>
#include <unistd.h>

#define FOLDER SHARED_DIRECTORY "/data/calibration/"
#define DEGREE 0.017453292519943295

enum { POSES = 256 };

typedef struct session {
    imk_log log;
    imk_test_record record;
    imk_calibration calibration;
    imk_calibration_result result;
    imk_observation observation[POSES];
    imk_turn turn[POSES];
    imk_procedure_findings findings;
} session;

static session *load(const char *path, bool counts)
{
    session *s = calloc(1, sizeof *s);
    assert_non_null(s);
    imk_error error;
    const imk_log_settings settings = imk_log_settings_default();
    CHECK_STATUS(imk_log_load(path, &settings, NULL, &s->log, &error), IMK_OK);
    s->record = (imk_test_record){.name = path,
                                  .count = s->log.rows,
                                  .dt = s->log.findings.interval,
                                  .time = s->log.data[imk_log_find(&s->log, IMK_QUANTITY_TIME, -1)],
                                  .axis_count = {3, 3},
                                  .counts = {counts, counts}};
    for (int i = 0; i < 3; i++) {
        s->record.reading[IMK_GYRO][i] =
            s->log.data[imk_log_find(&s->log, IMK_QUANTITY_ANGULAR_RATE, i)];
        s->record.reading[IMK_ACCEL][i] =
            s->log.data[imk_log_find(&s->log, IMK_QUANTITY_SPECIFIC_FORCE, i)];
    }
    return s;
}

static session *solve(const char *path, bool counts, double gravity, bool g_sensitivity)
{
    session *s = load(path, counts);
    imk_calibration *c = &s->calibration;
    imk_calibration_default(c);
    c->gravity = gravity;
    c->observation = s->observation;
    c->turn = s->turn;
    c->observation_capacity = c->turn_capacity = POSES;
    imk_error error = {.status = IMK_OK};
    imk_procedure_settings settings = imk_procedure_default(IMK_PROCEDURE_MULTIPOSITION);
    settings.g_sensitivity = g_sensitivity;
    size_t size = imk_procedure_workspace_size(IMK_PROCEDURE_MULTIPOSITION, &s->record, &settings);
    void *workspace = malloc(size);
    CHECK_OK(imk_procedure_observe(IMK_PROCEDURE_MULTIPOSITION, c, &s->record, &settings, false,
                                   &s->findings, workspace, size, &error));
    free(workspace);
    size = imk_calibration_workspace_size(c);
    workspace = malloc(size);
    const imk_status status = imk_calibration_solve(c, &s->result, workspace, size, &error);
    if (status != IMK_OK)
        fail_msg("%s: %s", imk_status_name(status), error.field);
    free(workspace);
    return s;
}

static void close_session(session *s)
{
    imk_log_free(&s->log);
    free(s);
}

static bool absent(const char *path)
{
    if (access(path, R_OK) == 0)
        return false;
    print_message("%s is not there\n", path);
    return true;
}

/* Root mean square of |corrected mean| - gravity over the holds that were not refused. */
static double residual_of_holds(const session *s)
{
    const imk_triad *accel = &s->result.model.accel;
    imk_matrix3 m, inverse;
    double sum = 0.0;
    size_t count = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            m.m[i][j] =
                i == j ? 1.0 + accel->scale_factor.fixed.value[i] : accel->misalignment.value[i][j];
    CHECK_OK(imk_matrix3_inverse(m, &inverse));
    for (size_t k = 0; k < s->calibration.observation_count; k++) {
        const imk_observation *o = &s->observation[k];
        if (!(o->weight > 0.0))
            continue;
        imk_vector3 f;
        for (int i = 0; i < 3; i++) {
            const double reading = s->record.counts[IMK_ACCEL]
                                       ? (o->reading[IMK_ACCEL][i] - accel->zero_offset.value[i]) /
                                             accel->sensitivity.value[i]
                                       : o->reading[IMK_ACCEL][i];
            f.v[i] = reading - accel->bias.fixed.value[i];
        }
        const double miss =
            imk_vector3_norm(imk_matrix3_apply(inverse, f)) - s->calibration.gravity;
        sum += miss * miss;
        count++;
    }
    return sqrt(sum / (double)count);
}

/* Both components of the angle between the verticals over the turns used, rms [deg]. */
static double residual_of_turns(const session *s)
{
    double sum = 0.0;
    size_t count = 0;
    for (size_t t = 0; t < s->calibration.turn_count; t++) {
        const imk_turn *turn = &s->turn[t];
        if (!(turn->weight > 0.0))
            continue;
        sum += turn->residual[0] * turn->residual[0] + turn->residual[1] * turn->residual[1];
        count++;
    }
    return sqrt(sum / (double)count) / DEGREE;
}

static double counts_per_unit(const imk_triad *triad, int axis)
{
    return triad->sensitivity.value[axis] * (1.0 + triad->scale_factor.fixed.value[axis]);
}

/* 512 s of an Xsens MTi, 37 or so poses by hand after 50 s of rest, no sensitivity known.
 * Published: true = T K (raw - b), T upper triangular with a, b, c; so a response of K^-1 T^-1
 * counts per unit, which is upper triangular as ours is. */
static void test_xsens(void **state)
{
    (void)state;
    const char *path = FOLDER "xsens_mti_multiposition_raw_counts.csv.gz";
    if (absent(path))
        skip();
    session *s = solve(path, true, 9.81744, true);
    const imk_triad *accel = &s->result.model.accel;
    static const double scale[3] = {414.4589, 412.0105, 414.6487};
    static const double zero[3] = {33124.18, 33275.18, 32364.42};
    static const double ppm[3] = {65e-6, 34e-6, 39e-6};
    static const double a = -.003359, b = -.008906, c = -.021334;
    const double response[3][3] = {
        {0.0, -a * scale[0], (a * c - b) * scale[0]}, {0.0, 0.0, -c * scale[1]}, {0.0, 0.0, 0.0}};
    for (int i = 0; i < 3; i++) {
        const double sensitivity = accel->sensitivity.value[i];
        CHECK_CLOSE(counts_per_unit(accel, i), scale[i],
                    2.0 * accel->scale_factor.fixed.sigma[i] * sensitivity);
        CHECK_CLOSE(accel->zero_offset.value[i] + sensitivity * accel->bias.fixed.value[i], zero[i],
                    2.0 * accel->bias.fixed.sigma[i] * sensitivity);
        for (int j = i + 1; j < 3; j++)
            CHECK_CLOSE(accel->misalignment.value[i][j] * sensitivity, response[i][j],
                        2.0 * accel->misalignment.sigma[i][j] * sensitivity);
        print_message("accel %d: sigma of scale %.0f ppm\n", i,
                      1e6 * accel->scale_factor.fixed.sigma[i]);
        /* Stated there for other holds, which are more: a half. */
        CHECK_CLOSE(accel->scale_factor.fixed.sigma[i], ppm[i], 0.5 * ppm[i]);
    }
    print_message("residual of holds %.3g m/s^2\n", residual_of_holds(s));
    CHECK_BELOW(residual_of_holds(s), 1.12e-3);
    close_session(s);
}

/* The gyros of the same log. The published solution has no g-sensitivity; with it the turns fit
 * five times better, and the three scale factors, which depart from the factory sheet by 0.00, 0.13
 * and 0.16 %, depart from it by nearly the same 0.08 %: what a clock that is off by as much would
 * do. */
static void test_xsens_gyros(void **state)
{
    (void)state;
    const char *path = FOLDER "xsens_mti_multiposition_raw_counts.csv.gz";
    if (absent(path))
        skip();
    static const double published[3] = {4777.96, 4764.21, 4773.66};
    static const double factory[3] = {4778.0, 4758.0, 4766.0};
    session *without = solve(path, true, 9.81744, false);
    session *with = solve(path, true, 9.81744, true);
    double low = 1.0, high = -1.0;
    for (int i = 0; i < 3; i++) {
        CHECK_RELATIVE(counts_per_unit(&without->result.model.gyro, i), published[i], 5e-4);
        const double off = counts_per_unit(&with->result.model.gyro, i) / factory[i] - 1.0;
        low = fmin(low, off);
        high = fmax(high, off);
    }
    print_message("turns: %.3f deg without g-sensitivity, %.3f with it; scale %.4f to %.4f %% off "
                  "the factory's\n",
                  residual_of_turns(without), residual_of_turns(with), 100.0 * low, 100.0 * high);
    CHECK_BELOW(high - low, 5e-4);
    CHECK_BELOW(3.0 * residual_of_turns(with), residual_of_turns(without));
    close_session(without);
    close_session(with);
}

typedef struct published {
    const char *path;
    double accel_scale[3], misalignment[3], bias[3], gyro_scale[3]; /* misalignments yz, xy, xz */
} published;

static void check_accelerometers(const session *s, const published *p)
{
    static const int row[3] = {1, 0, 0}, column[3] = {2, 1, 2};
    const imk_triad *accel = &s->result.model.accel;
    for (int i = 0; i < 3; i++) {
        CHECK_CLOSE(accel->scale_factor.fixed.value[i], p->accel_scale[i],
                    2.0 * accel->scale_factor.fixed.sigma[i]);
        CHECK_CLOSE(accel->bias.fixed.value[i], p->bias[i], 2.0 * accel->bias.fixed.sigma[i]);
        CHECK_CLOSE(accel->misalignment.value[row[i]][column[i]], p->misalignment[i] * DEGREE,
                    2.0 * accel->misalignment.sigma[row[i]][column[i]]);
    }
}

static void test_mpu9150_unit0(void **state)
{
    (void)state;
    static const published p = {FOLDER "mpu9150_unit0_multiposition_100hz.csv.gz",
                                {.00363, .00315, .00647},
                                {.123, .020, .317},
                                {.103, .097, .344},
                                {.00041, .00457, .00826}};
    if (absent(p.path))
        skip();
    session *s = solve(p.path, false, 9.81, true);
    check_accelerometers(s, &p);
    for (int i = 0; i < 3; i++)
        CHECK_CLOSE(s->result.model.gyro.scale_factor.fixed.value[i], p.gyro_scale[i], 1e-3);
    close_session(s);
}

/* The published gyro of this unit is not the optimum of its own residual: 0.143 deg rms against
 * 0.092 deg attainable. */
static void test_mpu9150_unit1(void **state)
{
    (void)state;
    static const published p = {FOLDER "mpu9150_unit1_multiposition_100hz.csv.gz",
                                {.00471, .00482, .00932},
                                {-.284, -.010, .145},
                                {.090, .070, .338},
                                {0.0, 0.0, 0.0}};
    if (absent(p.path))
        skip();
    session *s = solve(p.path, false, 9.81, true);
    check_accelerometers(s, &p);
    print_message("turns: %.3f deg\n", residual_of_turns(s));
    CHECK_BELOW(residual_of_turns(s), 0.143);
    close_session(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_xsens),
        cmocka_unit_test(test_xsens_gyros),
        cmocka_unit_test(test_mpu9150_unit0),
        cmocka_unit_test(test_mpu9150_unit1),
    };
    return cmocka_run_group_tests_name("multiposition_real", tests, NULL, NULL);
}
