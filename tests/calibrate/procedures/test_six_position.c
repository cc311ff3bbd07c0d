/* SPDX-License-Identifier: Apache-2.0 */
/* sixposition: labels, holds and faces however they are found, exactness, coverage on simulated
 * benches, and what is refused. */
#include "check.h"

#include "calibrate/procedures/six_position_internal.h"
#include "calibrate/six_position_session.h"

/* ---- labels ------------------------------------------------------------------------------------
 */

static void test_labels(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        imki_label_kind kind;
        int axis, sense;
    } cases[] = {{"x_up", IMKI_LABEL_HOLD, 0, 1},
                 {"X UP", IMKI_LABEL_HOLD, 0, 1},
                 {"acc_y_p", IMKI_LABEL_HOLD, 1, 1},
                 {"z_a", IMKI_LABEL_HOLD, 2, -1},
                 {"down: z", IMKI_LABEL_HOLD, 2, -1},
                 {"+x", IMKI_LABEL_HOLD, 0, 1},
                 {"pose -y", IMKI_LABEL_HOLD, 1, -1},
                 {"z-", IMKI_LABEL_HOLD, 2, -1},
                 {"x-up", IMKI_LABEL_HOLD, 0, 1},
                 {"acc-x", IMKI_LABEL_HOLD, 0, 0},
                 {"y+ face", IMKI_LABEL_HOLD, 1, 1},
                 {"y", IMKI_LABEL_HOLD, 1, 0},
                 {"pose 3", IMKI_LABEL_HOLD, -1, 0},
                 {"", IMKI_LABEL_HOLD, -1, 0},
                 {"up", IMKI_LABEL_HOLD, -1, 0},
                 {"hold a", IMKI_LABEL_HOLD, -1, 0},
                 {"x_rot", IMKI_LABEL_TURN, 0, 0},
                 {"turn z neg", IMKI_LABEL_TURN, 2, -1},
                 {"Rotation", IMKI_LABEL_TURN, -1, 0},
                 {"x to y", IMKI_LABEL_OTHER, 1, 0},
                 {"moving", IMKI_LABEL_OTHER, -1, 0},
                 {"xy", IMKI_LABEL_HOLD, -1, 0},
                 {"averyveryverylongword z up", IMKI_LABEL_HOLD, 2, 1}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const imki_label label = imki_label_parse(cases[i].text);
        if (label.kind != cases[i].kind || label.axis != cases[i].axis ||
            label.sense != cases[i].sense)
            print_error("%s\n", cases[i].text);
        assert_int_equal(label.kind, cases[i].kind);
        assert_int_equal(label.axis, cases[i].axis);
        assert_int_equal(label.sense, cases[i].sense);
    }
}

static void test_rounding(void **state)
{
    (void)state;
    CHECK_CLOSE(imki_round_digits(1670.13, 3), 1670.0, 0.0);
    CHECK_CLOSE(imki_round_digits(208.456, 3), 208.0, 0.0);
    CHECK_CLOSE(imki_round_digits(-0.0123456, 3), -0.0123, 1e-17);
    CHECK_CLOSE(imki_round_digits(99960.0, 3), 100000.0, 0.0);
    CHECK_CLOSE(imki_round_digits(0.0, 3), 0.0, 0.0);
    CHECK_CLOSE(imki_round_digits(5.0, 3), 5.0, 0.0);
}

/* ---- holds and faces ---------------------------------------------------------------------------
 */

static const session_plan twice = {2, 8, 0, 1.7e-3, 0, 0, 0, 0, false};

static imk_status look(session *b, bool known, imk_procedure_findings *findings, imk_error *error)
{
    imk_calibration *c = &b->calibration;
    imk_calibration_default(c);
    c->gravity = BENCH_GRAVITY;
    c->latitude = BENCH_LATITUDE;
    c->observation = b->observation;
    c->observation_capacity = BENCH_STRETCHES;
    if (known) {
        c->model.gyro.sensitivity = b->unit.gyro.sensitivity;
        c->model.accel.sensitivity = b->unit.accel.sensitivity;
    }
    const imk_procedure_settings settings = imk_procedure_default(IMK_PROCEDURE_SIXPOSITION);
    const size_t size =
        imk_procedure_workspace_size(IMK_PROCEDURE_SIXPOSITION, &b->record, &settings);
    return imk_procedure_observe(IMK_PROCEDURE_SIXPOSITION, c, &b->record, &settings, false,
                                 findings, session_workspace(b, size), size, error);
}

static void check_faces(const session *b, size_t holds)
{
    assert_int_equal(b->calibration.observation_count, holds);
    for (size_t k = 0; k < holds; k++) {
        const int face = (int)(k % 6), sense = face % 2 ? -1 : 1;
        const imk_observation *o = &b->observation[k];
        for (int i = 0; i < 3; i++) {
            CHECK_CLOSE(o->force[i], i == face / 2 ? sense * BENCH_GRAVITY : 0.0, 0.0);
            /* The vertical part of the Earth's rate turns the unit the way the up axis points. */
            CHECK_CLOSE(o->rate[i],
                        i == face / 2 ? sense * BENCH_EARTH_RATE * sin(BENCH_LATITUDE) : 0.0,
                        1e-18);
        }
        assert_int_equal(o->knowledge, IMK_INPUT_PLACED);
        assert_true(o->sigma[IMK_ACCEL][0] > 0.0);
    }
}

/* The same faces from labels, from labels that say nothing, and from the standing alone; with
 * counts that have a sensitivity and without. */
static void test_faces(void **state)
{
    (void)state;
    static const char *const nothing[] = {"a1", "a2", "a3", "a4", "a5", "a6", "a7", "a8", "a9"};
    session *b = session_new();
    imk_procedure_findings findings;
    imk_error error;
    assert_true(session_run(b, &twice, IMK_PROCEDURE_SIXPOSITION, 3, 0, &error));
    check_faces(b, 12);
    for (int known = 0; known < 2; known++) {
        b->record.section_name = session_labels;
        CHECK_OK(look(b, known, &findings, &error));
        check_faces(b, 12);
        assert_int_equal(findings.intervals, 12);
        assert_int_equal(findings.left_out, 0);
        CHECK_CLOSE(findings.spread, 1.0 / 3.0, 1e-12);
        assert_int_equal(b->calibration.frame, IMK_FRAME_REFERENCE);
        /* Gyros in counts stay out when nothing says what these are. */
        assert_int_equal(b->calibration.parameter_count, known ? 12 + 3 + 9 : 12);
        assert_int_equal(isnan(b->observation[0].reading[IMK_GYRO][0]), !known);
        b->record.section_name = nothing;
        CHECK_OK(look(b, known, &findings, &error));
        check_faces(b, 12);
        b->record.section = NULL;
        CHECK_OK(look(b, known, &findings, &error));
        check_faces(b, 12);
        b->record.section = b->section;
    }
    CHECK_RELATIVE(b->calibration.model.accel.sensitivity.value[0], 1670.0, 0.02);
    free(b->workspace);
    b->workspace = NULL;
    b->workspace_size = 0;
    session_free(b);
}

/* Of an unsigned converter, whose zero is in the middle of its range. */
static void test_offset_counts(void **state)
{
    (void)state;
    session *b = session_new();
    imk_procedure_findings findings;
    imk_error error;
    assert_true(session_run(b, &twice, IMK_PROCEDURE_SIXPOSITION, 3, 0, &error));
    for (int i = 0; i < 3; i++)
        for (size_t k = 0; k < b->count; k++)
            b->reading[3 + i][k] += 32768.0;
    CHECK_OK(look(b, false, &findings, &error));
    check_faces(b, 12);
    for (int i = 0; i < 3; i++) {
        /* To the accelerometers' bias, and to their scale factors and three digits. */
        CHECK_CLOSE(b->calibration.model.accel.zero_offset.value[i], 32768.0, 0.35 * 1670.0);
        CHECK_RELATIVE(b->calibration.model.accel.sensitivity.value[i], 1670.0, 0.02);
    }
    const size_t size = imk_calibration_workspace_size(&b->calibration);
    CHECK_OK(imk_calibration_solve(&b->calibration, &b->result, session_workspace(b, size), size,
                                   &error));
    const imk_triad *a = &b->result.model.accel;
    for (int i = 0; i < 3; i++) {
        CHECK_CLOSE(a->sensitivity.value[i] * (1.0 + a->scale_factor.fixed.value[i]),
                    1670.0 * (1.0 + b->unit.accel.scale_factor.fixed.value[i]), 1.0);
    }
    session_free(b);
}

/* ---- what is refused ---------------------------------------------------------------------------
 */

static void test_refusals(void **state)
{
    (void)state;
    session *b = session_new();
    imk_procedure_findings findings;
    imk_error error;
    assert_true(session_run(b, &twice, IMK_PROCEDURE_SIXPOSITION, 3, 0, &error));

    /* A face that nobody held. */
    for (size_t k = 0; k < b->count; k++)
        if (b->section[k] == 3)
            b->section[k] = -1;
    for (int known = 0; known < 2; known++) {
        CHECK_STATUS(look(b, known, &findings, &error), IMK_ERROR_TOO_SHORT);
        assert_string_equal(error.field, "hold");
        assert_string_equal(error.expected, "add a hold with y down");
        CHECK_CLOSE(error.value, 5.0, 0.0);
        CHECK_CLOSE(error.limit, 6.0, 0.0);
        assert_int_equal(b->calibration.observation_count, 0);
    }

    /* Axes that are not what the labels say: swapped in the log. */
    assert_true(session_run(b, &twice, IMK_PROCEDURE_SIXPOSITION, 3, 0, &error));
    b->record.reading[IMK_ACCEL][0] = b->reading[4];
    b->record.reading[IMK_ACCEL][1] = b->reading[3];
    CHECK_STATUS(look(b, true, &findings, &error), IMK_ERROR_CONFLICT);
    assert_string_equal(error.field, "section");
    assert_string_equal(error.found, "x up");

    /* No accelerometers; no room. */
    b->record.axis_count[IMK_ACCEL] = 0;
    CHECK_STATUS(look(b, true, &findings, &error), IMK_ERROR_KEY_MISSING);
    assert_string_equal(error.field, "accel");
    assert_true(session_run(b, &twice, IMK_PROCEDURE_SIXPOSITION, 3, 0, &error));
    imk_calibration *c = &b->calibration;
    c->observation_count = 0;
    c->observation_capacity = 11;
    const imk_procedure_settings settings = imk_procedure_default(IMK_PROCEDURE_SIXPOSITION);
    const size_t size =
        imk_procedure_workspace_size(IMK_PROCEDURE_SIXPOSITION, &b->record, &settings);
    CHECK_STATUS(imk_procedure_observe(IMK_PROCEDURE_SIXPOSITION, c, &b->record, &settings, false,
                                       &findings, session_workspace(b, size), size, &error),
                 IMK_ERROR_WORKSPACE);
    CHECK_CLOSE(error.value, 12.0, 0.0);
    CHECK_CLOSE(error.limit, 11.0, 0.0);
    session_free(b);
}

/* One wrong label is left out, saturated holds too. */
static void test_left_out(void **state)
{
    (void)state;
    session *b = session_new();
    imk_procedure_findings findings;
    imk_error error;
    assert_true(session_run(b, &twice, IMK_PROCEDURE_SIXPOSITION, 3, 0, &error));
    for (size_t k = 0; k < b->count / 12; k++)
        if (b->section[k] == 0)
            b->section[k] = 2;
    CHECK_OK(look(b, true, &findings, &error));
    assert_int_equal(findings.intervals, 12);
    assert_int_equal(findings.left_out, 1);
    assert_int_equal(b->calibration.observation_count, 11);
    imk_calibration *c = &b->calibration;
    imk_calibration_default(c);
    c->gravity = BENCH_GRAVITY;
    c->observation = b->observation;
    c->observation_capacity = BENCH_STRETCHES;
    c->model.accel.sensitivity = b->unit.accel.sensitivity;
    for (int i = 0; i < 3; i++)
        c->model.accel.range.value[i] = 5.0;
    const imk_procedure_settings settings = imk_procedure_default(IMK_PROCEDURE_SIXPOSITION);
    const size_t size =
        imk_procedure_workspace_size(IMK_PROCEDURE_SIXPOSITION, &b->record, &settings);
    CHECK_STATUS(imk_procedure_observe(IMK_PROCEDURE_SIXPOSITION, c, &b->record, &settings, false,
                                       &findings, session_workspace(b, size), size, &error),
                 IMK_ERROR_TOO_SHORT);
    CHECK_CLOSE(error.value, 0.0, 0.0);
    session_free(b);
}

/* ---- solutions ---------------------------------------------------------------------------------
 *
 * Per parameter the 95 % interval must hold the truth as often as a false alarm of 1e-8 a parameter
 * (1e-6 all of them) leaves at a coverage of 93 %; a bias of 0.2 sigma is allowed, and 5.73 sigma
 * of a mean. Of fewer than RMS_LEAST benches, each with a Student's distribution of few degrees of
 * freedom, the root mean square may be anything. */
static void check_coverage(const coverage_count *c, double rms_limit)
{
    enum { RMS_LEAST = 50 };
    const double n = (double)c->benches;
    const size_t least = coverage_least_held(c->benches, 0.93, 1e-8);
    assert_true(c->benches > 0);
    for (size_t p = 0; p < c->parameter_count; p++) {
        char name[IMK_MODEL_PARAMETER_NAME];
        CHECK_OK(imk_model_parameter_name(c->parameter[p], name));
        if (c->held[p] < least ||
            !(fabs(coverage_bias(c, p)) <= 0.2 + 5.73 * rms_limit / sqrt(n)) ||
            (c->benches >= RMS_LEAST && !(coverage_rms(c, p) <= rms_limit))) {
            print_error("%s: held %.1f %%, bias %.2f sigma, rms %.2f sigma\n", name,
                        100.0 * coverage_share(c, p), coverage_bias(c, p), coverage_rms(c, p));
            fail();
        }
    }
}

static void run_benches(const session_plan *plan, imk_procedure procedure, uint32_t benches,
                        size_t refused, double rms_limit)
{
    static coverage_count count;
    session *b = session_new();
    memset(&count, 0, sizeof count);
    for (uint32_t n = 0; n < benches; n++) {
        imk_error error;
        if (session_run(b, plan, procedure, 1, n, &error))
            coverage_add(&count, &b->result, &b->truth, 0.95);
        else
            count.failed++;
    }
    assert_true(count.failed <= refused);
    check_coverage(&count, rms_limit);
    session_free(b);
}

/* Student's distribution with few degrees of freedom has a large standard deviation: 1.5 for those
 * of two rounds is beyond any chance with 60 benches. */
static void test_coverage_placed(void **state)
{
    (void)state;
    run_benches(&twice, IMK_PROCEDURE_SIXPOSITION, check_runs(60), 0, 1.6);
}

/* Placements of 0.3 deg where 0.1 is stated: six faces show it with six degrees of freedom, two
 * rounds with eighteen. */
static void test_coverage_placed_worse(void **state)
{
    (void)state;
    static const session_plan once = {
        .rounds = 1, .hold = 8, .placement = 5.1e-3, .stated = 1.0 / 3};
    static const session_plan more = {
        .rounds = 2, .hold = 8, .placement = 5.1e-3, .stated = 1.0 / 3};
    run_benches(&once, IMK_PROCEDURE_SIXPOSITION, check_runs(60), 0, 1.8);
    run_benches(&more, IMK_PROCEDURE_SIXPOSITION, check_runs(60), 0, 1.8);
}

/* What is said of the placements: chi-square of the stated sigma has the degrees that the faces
 * leave, and the factor never takes them for better than stated. */
static void test_placements_are_tested(void **state)
{
    (void)state;
    const session_plan good = {.rounds = 1, .hold = 8, .placement = 1.7e-3, .stated = 1.0};
    const session_plan wide = {.rounds = 1, .hold = 8, .placement = 1.7e-3, .stated = 4.0};
    const uint32_t benches = check_runs(60);
    double chi_square = 0.0, square = 0.0;
    session *b = session_new();
    for (uint32_t n = 0; n < benches; n++) {
        imk_error error;
        assert_true(session_run(b, &good, IMK_PROCEDURE_SIXPOSITION, 1, n, &error));
        const imk_group_fit *fit = &b->result.placement;
        CHECK_CLOSE(fit->degrees_of_freedom, 6.0, 0.1);
        assert_true(fit->factor >= 1.0);
        chi_square += fit->chi_square / benches;
        square += fit->rms * fit->rms / benches;
        assert_true(session_run(b, &wide, IMK_PROCEDURE_SIXPOSITION, 1, n, &error));
        CHECK_CLOSE(b->result.placement.factor, 1.0, 0.0);
    }
    /* A mean of chi-squares: six sigma are below one in a million. */
    CHECK_CLOSE(chi_square, 6.0, 6.0 * sqrt(12.0 / benches));
    CHECK_CLOSE(square / (1.7e-3 * 1.7e-3), 1.0, 6.0 * sqrt(2.0 / 6.0 / benches));
    session_free(b);
}

/* Noise of the axes 1 : 2 : 4, and every hold off by the same on all of them: one factor for the
 * sensor would make the first axis too certain. */
static void test_coverage_unequal_axes(void **state)
{
    (void)state;
    static const session_plan plan = {.rounds = 3, .hold = 8, .unequal = 2.0, .push = 3e-3};
    run_benches(&plan, IMK_PROCEDURE_SIXPOSITION, check_runs(60), 0, 1.6);
}

static void test_coverage_exact(void **state)
{
    (void)state;
    static const session_plan plan = {2, 8, 0, 0, 0, 0, 0, 0, false};
    run_benches(&plan, IMK_PROCEDURE_SIXPOSITION, check_runs(60), 0, 1.8);
}

static void test_coverage_ferraris(void **state)
{
    (void)state;
    static const session_plan plan = {2, 8, 6, 1.7e-3, 0, 0, 0, 0, false};
    run_benches(&plan, IMK_PROCEDURE_FERRARIS, check_runs(60), 0, 1.8);
}

/* Without labels, turned where it lies and left there for a while: nine observations, six of them
 * placements. As if it had been placed anew after each turn, errors of misalignments were 1.25
 * sigma; the limit is eight standard deviations of their mean square from 0.9. */
static void test_turned_where_it_lies(void **state)
{
    (void)state;
    static const session_plan plan = {
        .rounds = 1, .hold = 5, .turn = 6, .placement = 1.7e-3, .unlabelled = true};
    static coverage_count count;
    const uint32_t benches = check_runs(80);
    session *b = session_new();
    memset(&count, 0, sizeof count);
    imk_error error;
    for (uint32_t n = 0; n < benches; n++) {
        assert_true(session_run(b, &plan, IMK_PROCEDURE_FERRARIS, 1, n, &error));
        assert_int_equal(b->calibration.observation_count, 9);
        coverage_add(&count, &b->result, &b->truth, 0.95);
    }
    double square = 0.0, misalignments = 0.0;
    for (size_t p = 0; p < count.parameter_count; p++)
        if (count.parameter[p].sensor == IMK_ACCEL &&
            count.parameter[p].term == IMK_MODEL_MISALIGNMENT) {
            square += count.square[p];
            misalignments += (double)count.benches;
        }
    CHECK_BELOW(square / misalignments, 0.9 + 8.0 * sqrt(2.0 / misalignments));
    check_coverage(&count, 1.6);
    session_free(b);
}

/* Both rests read the same placement: their mean is as good as both together. */
static void test_pooled_holds(void **state)
{
    (void)state;
    const session_plan plan = {
        .rounds = 1, .hold = 5, .turn = 6, .placement = 1.7e-3, .unlabelled = true};
    session *b = session_new();
    imk_error error;
    assert_true(session_run(b, &plan, IMK_PROCEDURE_FERRARIS, 1, 0, &error));
    const imk_observation *up = &b->observation[0], *down = &b->observation[1];
    assert_true(up->force[0] > 0.0 && down->force[0] < 0.0);
    for (int s = 0; s < 2; s++)
        for (int i = 0; i < 3; i++)
            CHECK_RELATIVE(up->sigma[s][i] / down->sigma[s][i], sqrt(0.5), 0.25);
    session_free(b);
}

/* The heading is not part of what a factor multiplies: the variance of the Earth's rate across the
 * vertical is stated beside the noise. */
static void test_heading(void **state)
{
    (void)state;
    const session_plan plan = {.rounds = 1, .hold = 8};
    const double level = BENCH_EARTH_RATE * cos(BENCH_LATITUDE);
    session *b = session_new();
    imk_error error;
    double square[2] = {0.0}; /* of the noise: along the vertical, across */
    assert_true(session_run(b, &plan, IMK_PROCEDURE_SIXPOSITION, 1, 0, &error));
    for (size_t k = 0; k < 6; k++)
        for (size_t i = 0; i < 3; i++) {
            const imk_observation *o = &b->observation[k];
            const bool across = i != k / 2;
            CHECK_CLOSE(o->heading_variance[i], across ? 0.5 * level * level : 0.0, 1e-20);
            square[across] += o->sigma[IMK_GYRO][i] * o->sigma[IMK_GYRO][i] / (across ? 12.0 : 6.0);
        }
    CHECK_RELATIVE(square[1], square[0], 0.3);
    session_free(b);
}

/* A turn and the hold before it may be one placement, which is no reason for a doubt: of two groups
 * the smaller probability counts twice. */
static void test_probability_of_placements(void **state)
{
    (void)state;
    static imk_calibration_result r;
    r.placement.degrees_of_freedom = 40.0;
    r.placement.chi_square = 70.0;
    r.turn_freedom = 16.0;
    r.turn_chi_square = 38.0;
    CHECK_RELATIVE(imk_calibration_placement_probability(&r), 2.0 * imk_gamma_upper(8.0, 19.0),
                   1e-12);
    r.turn_freedom = r.turn_chi_square = 0.0;
    CHECK_RELATIVE(imk_calibration_placement_probability(&r), imk_gamma_upper(20.0, 35.0), 1e-12);
    r.placement.degrees_of_freedom = 0.5;
    assert_true(isnan(imk_calibration_placement_probability(&r)));
}

/* Thirty holds of which three are bad: two lean by 0.05 rad, 29 sigma of their placement, and one
 * is pushed by 0.3 m/s^2, hundreds of its sigma. Of each bench these are refused and, as of clean
 * ones, one more in a hundred. */
static void test_bad_holds_refused(void **state)
{
    (void)state;
    static const session_plan plan = {5, 8, 0, 1.7e-3, 0.1, 0, 0, 0, false};
    static coverage_count count;
    const uint32_t benches = check_quick() ? 4 : 16;
    session *b = session_new();
    memset(&count, 0, sizeof count);
    size_t refused = 0;
    imk_error error;
    for (uint32_t n = 0; n < benches; n++) {
        assert_true(session_run(b, &plan, IMK_PROCEDURE_SIXPOSITION, 1, n, &error));
        coverage_add(&count, &b->result, &b->truth, 0.95);
        refused += b->result.observations_refused;
    }
    assert_in_range(refused, 3 * benches, 3 * benches + 4);
    check_coverage(&count, 1.6);
    session_free(b);
}

/* Six holds, each of which is needed for some parameter: bad or not, none is refused when that
 * would leave a parameter without. Bench 33 lost both faces of an axis once, by bad luck. */
static void test_needed_holds_kept(void **state)
{
    (void)state;
    static const session_plan clean = {1, 8, 0, 0, 0, 0, 0, 0, false},
                              spoilt = {1, 8, 0, 0, 0.34, 0, 0, 0, false};
    session *b = session_new();
    imk_error error;
    for (uint32_t n = 30; n < 36; n++) {
        assert_true(session_run(b, &clean, IMK_PROCEDURE_SIXPOSITION, 1, n, &error));
        assert_true(session_run(b, &spoilt, IMK_PROCEDURE_SIXPOSITION, 1, n, &error));
    }
    session_free(b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_labels),
                                       cmocka_unit_test(test_rounding),
                                       cmocka_unit_test(test_faces),
                                       cmocka_unit_test(test_offset_counts),
                                       cmocka_unit_test(test_refusals),
                                       cmocka_unit_test(test_left_out),
                                       cmocka_unit_test(test_coverage_placed),
                                       cmocka_unit_test(test_coverage_placed_worse),
                                       cmocka_unit_test(test_placements_are_tested),
                                       cmocka_unit_test(test_coverage_unequal_axes),
                                       cmocka_unit_test(test_coverage_exact),
                                       cmocka_unit_test(test_turned_where_it_lies),
                                       cmocka_unit_test(test_pooled_holds),
                                       cmocka_unit_test(test_heading),
                                       cmocka_unit_test(test_probability_of_placements),
                                       cmocka_unit_test(test_coverage_ferraris),
                                       cmocka_unit_test(test_bad_holds_refused),
                                       cmocka_unit_test(test_needed_holds_kept)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
