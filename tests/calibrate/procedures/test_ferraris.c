/* SPDX-License-Identifier: Apache-2.0 */
/* The Ferraris procedure: the published solution of a real session by the closed form, the same by
 * maximum likelihood, and simulated sessions with known truth. */
#include "check.h"

#include "imukit/ferraris.h"
#include "imukit/imukit.h"
#include "imukit/io.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define LOG SHARED_DIRECTORY "/data/calibration/ferraris_session_204.8hz_counts.csv.gz"

enum { CAPACITY = 64 };

static const double degree = 0.017453292519943295;
static const double turn = 6.283185307179586;

/* ---- the real session -------------------------------------------------------------------------
 */

typedef struct real_session {
    imk_log log;
    int *section;
    const char *name[32];
    imk_test_record record;
} real_session;

static bool load(real_session *s)
{
    imk_error error;
    imk_log_settings settings = imk_log_default();
    memset(s, 0, sizeof *s);
    if (access(LOG, R_OK) != 0) {
        print_message("%s is not there\n", LOG);
        return false;
    }
    settings.rate = 204.8;
    CHECK_OK(imk_log_load(LOG, &settings, NULL, &s->log, &error));
    assert_int_equal(s->log.rows, 9414);
    s->section = malloc(s->log.rows * sizeof *s->section);
    size_t label = 0;
    while (label < s->log.column_count && !s->log.column[label].label)
        label++;
    assert_true(label < s->log.column_count);
    for (size_t k = 0; k < s->log.rows; k++)
        s->section[k] = (int)s->log.data[label][k];
    assert_int_equal(s->log.label_count, 9);
    for (size_t i = 0; i < s->log.label_count; i++)
        s->name[i] = s->log.label[i];
    s->record = (imk_test_record){.name = "session",
                                  .count = s->log.rows,
                                  .dt = 1.0 / 204.8,
                                  .axis_count = {3, 3},
                                  .counts = {true, true},
                                  .section = s->section,
                                  .section_count = s->log.label_count,
                                  .section_name = s->name};
    for (int i = 0; i < 3; i++) {
        s->record.reading[IMK_GYRO][i] =
            s->log.data[imk_log_find(&s->log, IMK_QUANTITY_ANGULAR_RATE, i)];
        s->record.reading[IMK_ACCEL][i] =
            s->log.data[imk_log_find(&s->log, IMK_QUANTITY_SPECIFIC_FORCE, i)];
    }
    return true;
}

static void unload(real_session *s)
{
    imk_log_free(&s->log);
    free(s->section);
}

static size_t stretches(const imk_test_record *record, const imk_procedure_settings *settings,
                        const imk_model *model, imk_ferraris_stretch *stretch)
{
    imk_error error;
    size_t count = 0;
    const size_t size = imk_procedure_workspace_size(IMK_PROCEDURE_FERRARIS, record, settings);
    void *workspace = malloc(size);
    CHECK_OK(imk_ferraris_stretches(record, settings, model, 9.81, CAPACITY, stretch, &count,
                                    workspace, size, &error));
    free(workspace);
    return count;
}

/* shared/data/reference/ferraris_session_expected.json, which gives angles in degrees: what another
 * program finds on this session with the conventions of golden.md (g = 9.81 m/s^2, turns of -360
 * degrees). */
static const imk_ferraris expected = {
    .accel = {.scale = {208.54567263762615, 208.0011341167055, 214.78455364603022},
              .axes = {{0.9999125214309234, 0.007122056140390757, -0.011145662922687352},
                       {-0.007947378455060604, 0.9996887358297629, 0.023648903373787954},
                       {0.021342900724016442, -0.010781879507682177, 0.9997140749549175}},
              .bias = {-6.018868019671572, -48.287874016760156, -28.96636637224333}},
    .gyro = {.scale = {16.67769558952488, 16.187895200550262, 16.253362639451936},
             .axes = {{-0.9999143756542296, -0.0006142300632876558, 0.013071498821540703},
                      {0.0055057030733027396, -0.9992594967426224, -0.03808077472097593},
                      {-0.01314650914177706, 0.0365074524847183, -0.9992469040284595}},
             .bias = {1.960686204431737, -4.472837741243746, -3.6511794138670477}},
    .g_sensitivity = {{0.0022926499308660976, -0.016134632407810497, 0.018465435717563698},
                      {0.013873705024757028, 0.005443610335094903, -0.008812480865044459},
                      {-0.00925910567448679, 0.008506306471459087, -0.003935382156556474}}};

/* Elements that nearly vanish are compared with the size of their kind: the lengths of rows for the
 * directions, 0.02 count/(m/s^2) for the g-sensitivity, whose differences of means cancel. */
static void test_published(void **state)
{
    (void)state;
    real_session s;
    if (!load(&s))
        skip();
    imk_procedure_settings settings = imk_procedure_default(IMK_PROCEDURE_FERRARIS);
    settings.trim = 0.0;
    imk_model model;
    imk_model_default(&model);
    imk_ferraris_stretch stretch[CAPACITY];
    const size_t count = stretches(&s.record, &settings, &model, stretch);
    assert_int_equal(count, 9);
    imk_ferraris f;
    imk_error error;
    CHECK_OK(imk_ferraris_closed_form(&s.record, count, stretch, 9.81, -turn, 0.0, &f, &error));
    for (int i = 0; i < 3; i++) {
        CHECK_RELATIVE(f.accel.scale[i], expected.accel.scale[i], 1e-12);
        CHECK_RELATIVE(f.accel.bias[i], expected.accel.bias[i], 1e-12);
        CHECK_RELATIVE(f.gyro.scale[i] * degree, expected.gyro.scale[i], 1e-12);
        CHECK_RELATIVE(f.gyro.bias[i], expected.gyro.bias[i], 1e-12);
        for (int j = 0; j < 3; j++) {
            CHECK_CLOSE(f.accel.axes[i][j], expected.accel.axes[i][j], 1e-12);
            CHECK_CLOSE(f.gyro.axes[i][j], expected.gyro.axes[i][j], 1e-12);
            CHECK_CLOSE(f.g_sensitivity[i][j], expected.g_sensitivity[i][j], 0.02e-12);
        }
        /* Noise of some counts over some thousand samples. */
        assert_true(f.accel.scale_sigma[i] > 1e-4 && f.accel.scale_sigma[i] < 0.05);
        assert_true(f.gyro.scale_sigma[i] > 1e-4 && f.gyro.scale_sigma[i] < 2.0);
    }
    unload(&s);
}

/* With labels that only tell holds from turns, all are found to be what they were. */
static void test_unlabelled(void **state)
{
    (void)state;
    real_session s;
    if (!load(&s))
        skip();
    imk_procedure_settings settings = imk_procedure_default(IMK_PROCEDURE_FERRARIS);
    settings.trim = 0.0;
    imk_model model;
    imk_model_default(&model);
    imk_ferraris_stretch named[CAPACITY], found[CAPACITY];
    const size_t count = stretches(&s.record, &settings, &model, named);
    for (size_t i = 0; i < s.record.section_count; i++)
        s.name[i] = strstr(s.name[i], "rot") ? "rotation" : "hold";
    const size_t again = stretches(&s.record, &settings, &model, found);
    assert_int_equal(again, count);
    for (size_t k = 0; k < count; k++) {
        assert_int_equal(found[k].begin, named[k].begin);
        assert_int_equal(found[k].end, named[k].end);
        assert_int_equal(found[k].turn, named[k].turn);
        assert_int_equal(found[k].axis, named[k].axis);
        assert_int_equal(found[k].sense, named[k].sense);
    }
    unload(&s);
}

/* ---- by maximum likelihood ----------------------------------------------------------------------
 */

typedef struct session {
    imk_calibration calibration;
    imk_observation observation[CAPACITY];
    imk_calibration_result result;
    imk_procedure_findings findings;
} session;

static session *session_new(void)
{
    session *b = malloc(sizeof *b);
    imk_calibration_default(&b->calibration);
    b->calibration.observation = b->observation;
    b->calibration.observation_capacity = CAPACITY;
    return b;
}

static imk_status observe(session *b, const imk_test_record *record,
                          const imk_procedure_settings *settings, imk_error *error)
{
    const size_t size = imk_procedure_workspace_size(IMK_PROCEDURE_FERRARIS, record, settings);
    void *workspace = malloc(size);
    const imk_status status =
        imk_procedure_observe(IMK_PROCEDURE_FERRARIS, &b->calibration, record, settings, false,
                              &b->findings, workspace, size, error);
    free(workspace);
    return status;
}

static void solve(session *b)
{
    imk_error error;
    const size_t size = imk_calibration_workspace_size(&b->calibration);
    void *workspace = malloc(size);
    CHECK_OK(imk_calibration_solve(&b->calibration, &b->result, workspace, size, &error));
    free(workspace);
}

/* The two estimators on the real session, turned the other way round, so that gyros read what
 * accelerometers call positive. They differ in what they take for the bias of the
 * accelerometers (all six holds against two) and in weights: by less than 0.3 % of the scale, 5
 * mrad, and 5 counts of bias, as repeated placement by hand allows. */
static void test_both_estimators(void **state)
{
    (void)state;
    real_session s;
    if (!load(&s))
        skip();
    imk_procedure_settings settings = imk_procedure_default(IMK_PROCEDURE_FERRARIS);
    settings.placement_sigma = 0.5 * degree;
    session *b = session_new();
    imk_error error;
    b->calibration.gravity = 9.81;
    b->calibration.earth_rate = 0.0;
    CHECK_OK(observe(b, &s.record, &settings, &error));
    assert_int_equal(b->calibration.observation_count, 9);
    assert_int_equal(b->findings.left_out, 0);
    CHECK_CLOSE(b->findings.spread, 1.0 / 3.0, 1e-12);
    solve(b);
    imk_ferraris f;
    imk_ferraris_from_model(&b->result.model, &f);
    for (int i = 0; i < 3; i++) {
        CHECK_RELATIVE(f.accel.scale[i], expected.accel.scale[i], 3e-3);
        CHECK_RELATIVE(f.gyro.scale[i] * degree, expected.gyro.scale[i], 3e-3);
        CHECK_CLOSE(f.gyro.bias[i], expected.gyro.bias[i], 0.2);
        for (int j = 0; j < 3; j++) {
            CHECK_CLOSE(f.accel.axes[i][j], expected.accel.axes[i][j], 5e-3);
            CHECK_CLOSE(f.gyro.axes[i][j], -expected.gyro.axes[i][j], 5e-3);
        }
    }
    free(b);
    unload(&s);
}

/* To a model and back: the same numbers, for any nominal sensitivity. */
static void test_model_and_back(void **state)
{
    (void)state;
    imk_ferraris back;
    imk_model model;
    imk_model_default(&model);
    for (int pass = 0; pass < 2; pass++) {
        for (int i = 0; pass == 1 && i < 3; i++) {
            model.gyro.sensitivity.value[i] = -930.0;
            model.accel.sensitivity.value[i] = 210.0;
            model.accel.zero_offset.value[i] = 32.0;
        }
        imk_ferraris_to_model(&expected, &model);
        imk_ferraris_from_model(&model, &back);
        for (int i = 0; i < 3; i++) {
            CHECK_RELATIVE(back.accel.scale[i], expected.accel.scale[i], 1e-14);
            CHECK_RELATIVE(back.gyro.scale[i], expected.gyro.scale[i], 1e-14);
            CHECK_CLOSE(back.accel.bias[i], expected.accel.bias[i], 1e-13);
            CHECK_CLOSE(back.gyro.bias[i], expected.gyro.bias[i], 1e-13);
            for (int j = 0; j < 3; j++) {
                CHECK_CLOSE(back.accel.axes[i][j], expected.accel.axes[i][j], 1e-14);
                CHECK_CLOSE(back.gyro.axes[i][j], expected.gyro.axes[i][j], 1e-14);
                CHECK_CLOSE(back.g_sensitivity[i][j], expected.g_sensitivity[i][j], 1e-15);
            }
        }
    }
    /* Counts with that sensitivity: the model itself says what a count stands for. */
    CHECK_RELATIVE(model.accel.scale_factor.fixed.value[0],
                   expected.accel.scale[0] * expected.accel.axes[0][0] / 210.0 - 1.0, 1e-12);
}

/* ---- simulated sessions ------------------------------------------------------------------------
 *
 * Made by hand: holds of 6 s with moves between, turns about each axis while it points up, so that
 * the truth of every sample is written down here and nothing else computes it. Rates of a turn rise
 * and fall as 1 - cos, which closes at exactly a full turn. */

enum { RATE = 100, HOLD = 600, MOVE = 100, TURN = 500, SAMPLES = 9 * HOLD + 5 * MOVE + 3 * TURN };

typedef struct made {
    double reading[6][SAMPLES];
    int section[SAMPLES];
    size_t count;
    imk_test_record record;
} made;

static const char *const labels[] = {"x_up",   "x_down", "y_up",  "y_down", "z_up",
                                     "z_down", "x rot",  "y rot", "z rot"};

typedef struct maker {
    made *m;
    imk_distortion distortion;
    double gravity, latitude;
    const double *normal;
    double gyro_noise, accel_noise, per_count[2];
} maker;

static void add(maker *w, size_t n, int section, const double force[3], int axis, double turned,
                const double side[3])
{
    for (size_t k = 0; k < n; k++) {
        const double shape = 1.0 - cos(turn * ((double)k + 0.5) / (double)n);
        double rate[3], reading;
        for (int i = 0; i < 3; i++)
            rate[i] = IMK_EARTH_RATE * sin(w->latitude) * force[i] / w->gravity +
                      (axis < 0 ? side[i] * shape : 0.0);
        if (axis >= 0)
            rate[axis] += shape * turned * RATE / (double)n;
        for (int s = 0; s < 2; s++)
            for (int i = 0; i < 3; i++) {
                imk_stimulus stimulus = {.angular_rate = {&rate[0], &rate[1], &rate[2]},
                                         .specific_force = {&force[0], &force[1], &force[2]}};
                imk_distort(&w->distortion, s, i, &stimulus, 1, &reading);
                const size_t at = w->m->count;
                const double noise = w->normal[6 * at + (size_t)(3 * s + i)];
                reading += noise * (s == 0 ? w->gyro_noise : w->accel_noise);
                if (w->per_count[s] > 0.0)
                    reading = rint(reading / w->per_count[s]);
                w->m->reading[3 * s + i][at] = reading;
            }
        w->m->section[w->m->count++] = section;
    }
}

/* Six holds, and after each hold with an axis up a turn about it and a hold again, which is the
 * same placement. */
static made *make(const imk_model *truth, double latitude, double turned, uint64_t seed,
                  double noise, const double per_count[2])
{
    made *m = calloc(1, sizeof *m);
    double *normal = malloc(6 * SAMPLES * sizeof *normal);
    imk_random_normals(imk_random_seeded(seed), 0, 0, 6 * (size_t)SAMPLES, normal);
    maker w = {.m = m,
               .gravity = 9.81,
               .latitude = latitude,
               .normal = normal,
               .gyro_noise = noise * 1e-3,
               .accel_noise = noise * 0.02};
    for (int s = 0; s < 2 && per_count; s++)
        w.per_count[s] = per_count[s];
    CHECK_OK(imk_distortion_start(&w.distortion, truth, NULL, IMK_KERNEL_SCALAR, NULL));
    const double still[3] = {0.0}, side[3] = {0.9, -1.1, 0.8};
    for (int face = 0; face < 6; face++) {
        double force[3] = {0.0};
        force[face / 2] = face % 2 ? -w.gravity : w.gravity;
        if (face > 0)
            add(&w, MOVE, -1, force, -1, 0.0, side);
        add(&w, HOLD, face, force, -1, 0.0, still);
        if (face % 2 == 0) {
            add(&w, TURN, 6 + face / 2, force, face / 2, turned, still);
            add(&w, HOLD, face, force, -1, 0.0, still);
        }
    }
    assert_int_equal(m->count, SAMPLES);
    m->record = (imk_test_record){.name = "made",
                                  .count = m->count,
                                  .dt = 1.0 / RATE,
                                  .axis_count = {3, 3},
                                  .counts = {per_count != NULL, per_count != NULL},
                                  .section = m->section,
                                  .section_count = 9,
                                  .section_name = labels};
    for (int i = 0; i < 6; i++)
        m->record.reading[i / 3][i % 3] = m->reading[i];
    free(normal);
    return m;
}

static imk_model imperfect(void)
{
    imk_model model;
    imk_model_default(&model);
    static const double bias[2][3] = {{0.01, -0.02, 0.015}, {0.2, -0.1, 0.15}};
    static const double scale[2][3] = {{0.012, -0.02, 0.015}, {0.01, -0.006, 0.004}};
    static const double rows[2][3][3] = {
        {{0.0, 0.008, -0.011}, {0.006, 0.0, 0.012}, {-0.007, 0.009, 0.0}},
        {{0.0, -0.005, 0.003}, {0.008, 0.0, -0.002}, {0.004, -0.006, 0.0}}};
    for (int i = 0; i < 3; i++) {
        model.gyro.bias.fixed.value[i] = bias[0][i];
        model.accel.bias.fixed.value[i] = bias[1][i];
        model.gyro.scale_factor.fixed.value[i] = scale[0][i];
        model.accel.scale_factor.fixed.value[i] = scale[1][i];
        for (int j = 0; j < 3; j++) {
            model.gyro.misalignment.value[i][j] = rows[0][i][j];
            model.accel.misalignment.value[i][j] = rows[1][i][j];
            model.gyro.g_sensitivity.value[i][j] = 2e-6 * (1 + i - 2 * j);
        }
    }
    return model;
}

/* Without noise, placement error and Earth's level rate the procedure gives the truth back, with
 * turns either way; what is left is rounding and the stop of the iteration. With a little noise and
 * no labels it finds holds and turns itself; 6 sigma of Student's distribution then. */
static void test_truth_recovered(void **state)
{
    (void)state;
    const imk_model truth = imperfect();
    for (int variant = 0; variant < 4; variant++) {
        const double turned = variant % 2 ? -turn : turn;
        const bool labelled = variant < 2;
        made *m = make(&truth, 45.0 * degree, turned, 1, labelled ? 0.0 : 0.1, NULL);
        imk_procedure_settings settings = imk_procedure_default(IMK_PROCEDURE_FERRARIS);
        settings.placement_sigma = 0.0;
        if (labelled)
            settings.turn_angle = turned; /* the sign is what the settings say */
        else
            m->record.section = NULL; /* that of the reading */
        session *b = session_new();
        imk_error error;
        b->calibration.gravity = 9.81;
        b->calibration.latitude = 45.0 * degree;
        CHECK_OK(observe(b, &m->record, &settings, &error));
        assert_int_equal(b->calibration.observation_count, 9);
        solve(b);
        assert_int_equal(b->result.parameter_count, 12 + 21);
        for (size_t p = 0; p < b->result.parameter_count; p++)
            CHECK_CLOSE(b->result.value[p], imk_model_parameter_get(&truth, b->result.parameter[p]),
                        labelled ? 1e-7
                                 : imk_calibration_half_width(&b->result, (int)p, 1.0 - 2e-9));
        free(b);
        free(m);
    }
}

/* Counts nobody has said the meaning of: nominal sensitivities are found, and what counts stand for
 * in the end is right to the resolution of their means. */
static void test_counts(void **state)
{
    (void)state;
    const imk_model truth = imperfect();
    const double per_count[2] = {1.0 / 900.0, 1.0 / 200.0};
    made *m = make(&truth, 45.0 * degree, turn, 1, 1.0, per_count);
    for (int labelled = 1; labelled >= 0; labelled--) {
        imk_procedure_settings settings = imk_procedure_default(IMK_PROCEDURE_FERRARIS);
        session *b = session_new();
        imk_error error;
        b->calibration.gravity = 9.81;
        b->calibration.latitude = 45.0 * degree;
        if (!labelled)
            m->record.section = NULL;
        CHECK_OK(observe(b, &m->record, &settings, &error));
        solve(b);
        imk_ferraris found, wanted;
        imk_ferraris_from_model(&b->result.model, &found);
        imk_ferraris_from_model(&truth, &wanted);
        for (int i = 0; i < 3; i++) {
            CHECK_RELATIVE(found.gyro.scale[i], wanted.gyro.scale[i] * 900.0, 1e-3);
            CHECK_RELATIVE(found.accel.scale[i], wanted.accel.scale[i] * 200.0, 1e-3);
            for (int j = 0; j < 3; j++) {
                CHECK_CLOSE(found.gyro.axes[i][j], wanted.gyro.axes[i][j], 1e-3);
                CHECK_CLOSE(found.accel.axes[i][j], wanted.accel.axes[i][j], 1e-3);
            }
        }
        CHECK_OK(imk_model_validate(&b->result.model, NULL));
        free(b);
    }
    free(m);
}

/* One hold a face: the mean over unequal times up and down would put g-sensitivity into the bias of
 * the gyros. */
static size_t once_each(imk_ferraris_stretch *stretch, size_t count)
{
    size_t kept = 0;
    for (size_t k = 0; k < count; k++) {
        bool again = false;
        for (size_t j = 0; j < kept; j++)
            again = again ||
                    (!stretch[k].turn && !stretch[j].turn && stretch[j].axis == stretch[k].axis &&
                     stretch[j].sense == stretch[k].sense);
        if (!again)
            stretch[kept++] = stretch[k];
    }
    return kept;
}

/* Stated sigmas of the closed form are those of its results over many sessions with white noise, on
 * the equator, where the closed form misses nothing by leaving the Earth's rate out:
 * the sum of squares over sigma^2 of 30 numbers and 40 sessions. Numbers of a session are somewhat
 * correlated, so each one's own sum is tested, chi-square of 40 with the sigma itself known to some
 * per cent from the scatter: limits of 1e-7 either way, widened by 10 %. */
static void test_closed_form_sigmas(void **state)
{
    (void)state;
    enum { SESSIONS = 40, NUMBERS = 12 };
    const imk_model truth = imperfect();
    imk_ferraris wanted;
    imk_ferraris_from_model(&truth, &wanted);
    double sum[NUMBERS] = {0.0};
    for (int n = 0; n < SESSIONS; n++) {
        made *m = make(&truth, 0.0, turn, 100 + (uint64_t)n, 1.0, NULL);
        const imk_procedure_settings settings = imk_procedure_default(IMK_PROCEDURE_FERRARIS);
        imk_ferraris_stretch stretch[CAPACITY];
        imk_ferraris f;
        const size_t count = once_each(stretch, stretches(&m->record, &settings, &truth, stretch));
        assert_int_equal(count, 9);
        CHECK_OK(imk_ferraris_closed_form(&m->record, count, stretch, 9.81, turn, 0.0, &f, NULL));
        for (int i = 0; i < 3; i++) {
            const double z[4] = {
                (f.gyro.scale[i] - wanted.gyro.scale[i]) / f.gyro.scale_sigma[i],
                (f.gyro.axes[i][(i + 1) % 3] - wanted.gyro.axes[i][(i + 1) % 3]) /
                    f.gyro.axes_sigma[i][(i + 1) % 3],
                (f.accel.scale[i] - wanted.accel.scale[i]) / f.accel.scale_sigma[i],
                (f.g_sensitivity[i][(i + 1) % 3] - wanted.g_sensitivity[i][(i + 1) % 3]) /
                    f.g_sensitivity_sigma[i][(i + 1) % 3]};
            for (int j = 0; j < 4; j++)
                sum[3 * j + i] += z[j] * z[j];
        }
        free(m);
    }
    for (int j = 0; j < NUMBERS; j++) {
        assert_true(sum[j] > 0.9 * imk_chi_square_quantile(1e-7, SESSIONS));
        CHECK_BELOW(sum[j], 1.1 * imk_chi_square_quantile(1.0 - 1e-7, SESSIONS));
    }
}

/* What is missing is named. */
static void test_refusals(void **state)
{
    (void)state;
    const imk_model truth = imperfect();
    made *m = make(&truth, 45.0 * degree, turn, 1, 1.0, NULL);
    const imk_procedure_settings settings = imk_procedure_default(IMK_PROCEDURE_FERRARIS);
    session *b = session_new();
    imk_error error;
    for (size_t k = 0; k < m->count; k++)
        if (m->section[k] == 7)
            m->section[k] = -1;
    CHECK_STATUS(observe(b, &m->record, &settings, &error), IMK_ERROR_TOO_SHORT);
    assert_string_equal(error.field, "turn");
    assert_non_null(strstr(error.expected, "add a full turn about y; if there is one"));
    CHECK_CLOSE(error.value, 2.0, 0.0);
    for (size_t k = 0; k < m->count; k++)
        if (m->section[k] == 5 || m->section[k] == 0)
            m->section[k] = -1;
    CHECK_STATUS(observe(b, &m->record, &settings, &error), IMK_ERROR_TOO_SHORT);
    assert_string_equal(error.field, "hold");
    assert_string_equal(error.expected, "add a hold with x up, z down");
    assert_int_equal(b->calibration.observation_count, 0);
    assert_int_equal(b->calibration.record_count, 0);
    m->record.axis_count[IMK_GYRO] = 0;
    CHECK_STATUS(observe(b, &m->record, &settings, &error), IMK_ERROR_TOO_SHORT);
    free(b);
    free(m);
    made *other = make(&truth, 45.0 * degree, turn, 1, 1.0, NULL);
    other->record.axis_count[IMK_GYRO] = 0;
    b = session_new();
    CHECK_STATUS(observe(b, &other->record, &settings, &error), IMK_ERROR_KEY_MISSING);
    assert_string_equal(error.field, "gyro");
    free(b);
    free(other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_published),          cmocka_unit_test(test_unlabelled),
        cmocka_unit_test(test_both_estimators),    cmocka_unit_test(test_model_and_back),
        cmocka_unit_test(test_truth_recovered),    cmocka_unit_test(test_counts),
        cmocka_unit_test(test_closed_form_sigmas), cmocka_unit_test(test_refusals)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
