/* SPDX-License-Identifier: Apache-2.0 */
/* What holds for every job: a result that closed forms know, from arrays alone; memory that fails
 * at any call is said, and none of it is left; progress may give up. */
#include "check.h"

#include "imukit/jobs.h"

#include <string.h>

enum { RATE = 50, ROWS = 120 * RATE, COLUMNS = 7 };

static const char *const names[COLUMNS] = {"time",    "gyro_x",  "gyro_y", "gyro_z",
                                           "accel_x", "accel_y", "accel_z"};
static double column[COLUMNS][ROWS];
static double *const columns[COLUMNS] = {column[0], column[1], column[2], column[3],
                                         column[4], column[5], column[6]};
static imk_model unit; /* its noise is in the columns */

static imk_status simulate(const imk_job *job)
{
    imk_simulate_log_settings settings = imk_simulate_log_default();
    imk_array_sink arrays = {.column_count = COLUMNS, .capacity = ROWS, .data = columns};
    const imk_record_sink sink = imk_array_sink_of(&arrays);
    settings.simulation.rate = RATE;
    settings.rows = ROWS;
    return imk_simulate_log_run(&unit, &settings, &sink, "simulating", job, NULL);
}

static int set_up(void **state)
{
    (void)state;
    imk_model_default(&unit);
    for (int i = 0; i < 3; i++) {
        unit.gyro.noise.white.value[i] = 1e-5;
        unit.accel.noise.white.value[i] = 1e-3;
    }
    CHECK_OK(simulate(NULL));
    return 0;
}

static imk_record_source source(void)
{
    static imk_array_source arrays;
    static const double *const data[COLUMNS] = {column[0], column[1], column[2], column[3],
                                                column[4], column[5], column[6]};
    imk_record_source made;
    CHECK_OK(imk_array_source_make(COLUMNS, names, data, ROWS, RATE, &arrays, &made, NULL));
    return made;
}

/* ---- what each finds ---- */

static imk_status allan(const imk_job *job)
{
    const imk_allan_log_settings settings = imk_allan_log_default();
    const imk_record_source from = source();
    imk_allan_log *found;
    const imk_status status = imk_allan_log_run(&from, &settings, job, &found, NULL);
    if (status == IMK_OK) /* N/sqrt(tau) at the first tau, one sample: 1 % of 3000 pairs */
        CHECK_RELATIVE(found->curve[0][0].deviation[0], 1e-5 * sqrt(RATE), 0.05);
    imk_allan_log_free(found);
    return status;
}

static imk_status spectrum(const imk_job *job)
{
    const imk_spectrum_log_settings settings = imk_spectrum_log_default();
    const imk_record_source from = source();
    imk_spectrum_log *found;
    const imk_status status = imk_spectrum_log_run(&from, &settings, job, &found, NULL);
    if (status == IMK_OK)
        CHECK_RELATIVE(found->channel[0].coarse[found->channel[0].coarse_count / 2].density, 1e-10,
                       0.3);
    imk_spectrum_log_free(found);
    return status;
}

static imk_status identify(const imk_job *job)
{
    const imk_identify_log_settings settings = imk_identify_log_default();
    const imk_record_source from = source();
    imk_identify_log *found;
    const imk_status status = imk_identify_log_run(&from, &settings, job, &found, NULL);
    if (status == IMK_OK) {
        const imk_estimate *white = &found->result[0].term[IMK_NOISE_WHITE];
        CHECK_CLOSE(white->value, 1e-5, 5 * white->sigma);
    }
    imk_identify_log_free(found);
    return status;
}

/* A perfect start at 45 deg: what the sensors' noise makes of a minute. */
static imk_status navigate(const imk_job *job)
{
    imk_navigate_log_settings settings = imk_navigate_log_default();
    const imk_record_source from = source();
    imk_navigate_log *found;
    settings.place.latitude = imk_simulation_default().latitude;
    settings.align = 60;
    settings.heading_given = true;
    settings.model = &unit;
    const imk_status status = imk_navigate_log_run(&from, &settings, job, &found, NULL);
    if (status == IMK_OK) {
        assert_int_equal(found->track_rows, 61);
        assert_true(found->at_rest);
        /* Position from the tilt of the alignment and from white noise of the force. */
        CHECK_BELOW(found->largest, 5 * found->track[IMK_TRACK_SIGMA][60]);
        CHECK_BELOW(found->track[IMK_TRACK_SIGMA][60], 2.0);
    }
    imk_navigate_log_free(found);
    return status;
}

static imk_status compensate(const imk_job *job)
{
    static double out[COLUMNS][ROWS];
    double *const to[COLUMNS] = {out[0], out[1], out[2], out[3], out[4], out[5], out[6]};
    static imk_model biased;
    const imk_compensate_log_settings settings = imk_compensate_log_default();
    const imk_record_source from = source();
    imk_array_sink arrays = {.column_count = COLUMNS, .capacity = ROWS, .data = to};
    const imk_record_sink sink = imk_array_sink_of(&arrays);
    imk_compensate_log *found;
    imk_model_default(&biased);
    biased.accel.bias.fixed.value[2] = 0.5;
    const imk_status status =
        imk_compensate_log_run(&from, &biased, &settings, &sink, job, &found, NULL);
    if (status == IMK_OK)
        CHECK_CLOSE(out[6][17], column[6][17] - 0.5, 1e-14);
    imk_compensate_log_free(found);
    return status;
}

/* An accelerometer bias b leaves b (1 - cos w t)/w^2, w = sqrt(g/R): Schuler's oscillation. */
static imk_status drift(const imk_job *job)
{
    static imk_model biased;
    const imk_model *const models[] = {&biased};
    const char *const called[] = {"biased"};
    const double minute = 60;
    imk_drift_times times;
    imk_drift_models *found = NULL;
    const imk_drift_models_settings settings = imk_drift_models_default();
    imk_model_default(&biased);
    biased.accel.bias.repeatability.value[0] = 1e-3;
    imk_status status =
        imk_drift_times_choose(0, 1, &minute, 0, 100, false, 0.0, &job->allocator, &times, NULL);
    if (status == IMK_OK)
        status = imk_drift_models_run(1, models, called, &times, &settings, job, &found, NULL);
    if (status == IMK_OK) {
        const imk_drift_analysis *a = found->cases[0].analysis;
        const double w2 = 9.806 / 6.367e6;
        CHECK_RELATIVE(sqrt(a->total[0].covariance[0][0]), 1e-3 * (1 - cos(60 * sqrt(w2))) / w2,
                       1e-3);
    }
    imk_drift_models_free(found);
    imk_drift_times_free(&times);
    return status;
}

/* Of the class of navigation by its biases: 0.01 deg/h, 25 ug. */
static imk_status grade(const imk_job *job)
{
    static imk_model model;
    imk_graded *found;
    imk_model_default(&model);
    for (int i = 0; i < 3; i++) {
        model.gyro.bias.repeatability.value[i] = 4e-8;
        model.accel.bias.repeatability.value[i] = 2e-4;
    }
    const imk_status status = imk_grade_run(&model, job, &found, NULL);
    if (status == IMK_OK) {
        assert_int_equal(found->table.overall, IMK_GRADE_NAVIGATION);
        assert_null(found->no_position);
        assert_true(found->way[IMK_GRADE_GIVEN].cep[IMK_GRADE_HOUR] >
                    found->way[IMK_GRADE_GIVEN].cep[IMK_GRADE_MINUTE]);
        assert_true(found->share_count > 0 && found->share[0].value <= 1);
    }
    imk_graded_free(found);
    return status;
}

/* White noise alone is what a filter has, too: the fit is the model. */
static imk_status tune(const imk_job *job)
{
    const double level[3] = {0};
    imk_trajectory_piece piece;
    imk_trajectory trajectory;
    imk_tune_model_settings settings = imk_tune_model_default();
    imk_tune_model *found;
    CHECK_OK(imk_trajectory_standstill((imk_geodetic){0.8, 0.0, 0.0}, level, true, &piece,
                                       &trajectory, NULL));
    settings.tuning.motion[0].trajectory = &trajectory;
    settings.tuning.duration[0] = 4;
    settings.tuning.motion_count = 1;
    settings.tuning.rate = RATE;
    settings.tuning.to = 0.5;
    settings.tuning.window_count = 1;
    settings.run_count = 3;
    const imk_status status = imk_tune_model_run(&unit, "unit", &settings, job, &found, NULL);
    if (status == IMK_OK) {
        CHECK_RELATIVE(found->tuning->answer[IMK_FILTER_FIT].parameters.white[0][0], 1e-5, 0.01);
        assert_true(found->found[0].lower < found->found[0].upper);
    }
    imk_tune_model_free(found);
    return status;
}

/* A pendulous servo under 1 g reads 1 g. */
static imk_status physics(const imk_job *job)
{
    imk_physics_log_settings settings = imk_physics_log_default();
    imk_physics_log *found;
    settings.instrument = imk_instrument_find("pendulous_servo");
    assert_non_null(settings.instrument);
    static double design[512];
    assert_true(settings.instrument->design_size <= sizeof design);
    settings.instrument->set_default(design);
    settings.design = design;
    settings.input.exposure.specific_force[0] = 9.80665;
    settings.duration = 2;
    const imk_status status = imk_physics_log_run(&settings, NULL, NULL, job, &found, NULL);
    if (status == IMK_OK)
        CHECK_RELATIVE(found->mean[0], 9.80665, 1e-2);
    imk_physics_log_free(found);
    return status;
}

/* Two power cycles of the same noise: the biases do not differ. */
static imk_status calibrate(const imk_job *job)
{
    imk_calibrate_log_settings settings = imk_calibrate_log_default();
    imk_array_source arrays;
    imk_record_source again;
    const double *data[COLUMNS];
    for (int k = 0; k < COLUMNS; k++)
        data[k] = column[k];
    CHECK_OK(imk_array_source_make(COLUMNS, names, data, ROWS, RATE, &arrays, &again, NULL));
    const imk_record_source once = source();
    const imk_calibrate_input input[] = {{"first", IMK_PROCEDURE_MULTIPOSITION, &once},
                                         {"second", IMK_PROCEDURE_MULTIPOSITION, &again}};
    imk_calibrate_log *found;
    settings.repeatability = true;
    const imk_status status = imk_calibrate_logs(2, input, &settings, job, &found, NULL);
    if (status == IMK_OK)
        CHECK_CLOSE(found->model.gyro.bias.repeatability.value[0], 0, 1e-12);
    imk_calibrate_log_free(found);
    return status;
}

static const struct {
    const char *name;
    imk_status (*run)(const imk_job *job);
} jobs[] = {{"simulate", simulate},   {"allan", allan},       {"spectrum", spectrum},
            {"identify", identify},   {"navigate", navigate}, {"compensate", compensate},
            {"drift", drift},         {"grade", grade},       {"physics", physics},
            {"calibrate", calibrate}, {"tune", tune}};
enum { JOBS = sizeof jobs / sizeof jobs[0] };

static void test_results(void **state)
{
    (void)state;
    const imk_job plain = {.memory = 0};
    for (int i = 0; i < JOBS; i++)
        check_status(jobs[i].run(&plain), IMK_OK, jobs[i].name, __FILE__, __LINE__);
}

/* ---- memory ---- */

typedef struct counted {
    size_t calls, fails_at, live;
} counted;

enum { HEAD = 64 }; /* before each piece: its size */

/* Giving back a part never fails. */
static void *resize(void *context, void *at, size_t size)
{
    counted *c = context;
    char *piece = at ? (char *)at - HEAD : NULL;
    if (size == 0) {
        c->live -= at != NULL;
        free(piece);
        return NULL;
    }
    const bool grows = !piece || size > *(size_t *)(void *)piece;
    if (grows && ++c->calls == c->fails_at)
        return NULL;
    char *larger = realloc(piece, size + HEAD);
    assert_non_null(larger);
    c->live += at == NULL;
    *(size_t *)(void *)larger = size;
    return larger + HEAD;
}

/* Each call fails once, of many every so many-th. */
static void test_memory_that_fails(void **state)
{
    (void)state;
    for (int i = 0; i < JOBS; i++) {
        counted count = {.fails_at = 0};
        imk_job job = {.allocator = {resize, &count}};
        check_status(jobs[i].run(&job), IMK_OK, jobs[i].name, __FILE__, __LINE__);
        assert_int_equal(count.live, 0);
        const size_t calls = count.calls, step = calls / 24 + 1;
        assert_true(calls > 0);
        for (size_t at = 1; at <= calls; at += step) {
            count = (counted){.fails_at = at};
            const imk_status status = jobs[i].run(&job);
            if (status != IMK_ERROR_MEMORY || count.live > 0)
                print_error("%s: call %zu of %zu\n", jobs[i].name, at, calls);
            check_status(status, IMK_ERROR_MEMORY, jobs[i].name, __FILE__, __LINE__);
            assert_int_equal(count.live, 0);
        }
    }
}

/* ---- progress ---- */

static bool give_up(void *context, const char *stage, const char *unit_of_count, uint64_t done,
                    uint64_t total)
{
    size_t *heard = context;
    (void)done;
    (void)total;
    assert_true(stage[0] != '\0' && unit_of_count[0] != '\0');
    ++*heard;
    return false;
}

/* Short ones may be over before anything is said; who was heard has given up. */
static void test_giving_up(void **state)
{
    (void)state;
    size_t any = 0;
    for (int i = 0; i < JOBS; i++) {
        size_t heard = 0;
        const imk_job job = {.progress = give_up, .progress_context = &heard};
        const imk_status status = jobs[i].run(&job);
        check_status(status, heard > 0 ? IMK_ERROR_CANCELLED : IMK_OK, jobs[i].name, __FILE__,
                     __LINE__);
        any += heard > 0;
    }
    assert_true(any >= 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_results),
        cmocka_unit_test(test_memory_that_fails),
        cmocka_unit_test(test_giving_up),
    };
    return cmocka_run_group_tests(tests, set_up, NULL);
}
