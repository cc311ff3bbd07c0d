/* SPDX-License-Identifier: Apache-2.0 */
/* Gyros turned by known angles, without accelerometers: turns found and named, what the readings
 * say and what they cannot, and intervals over simulated benches. */
#include "check.h"

#include "../turns_session.h"

enum { RATE = 100, SAMPLES = 30000, MOVES = 24 };

static const double degree = 0.017453292519943295;
static const imk_axes bias = {.value = {0.01, -0.02, 0.005}};
static const imk_axes scale = {.value = {8e-3, -5e-3, 3e-3}};

/* A move from one rest to the next: an angle about each axis, in 5 s unless told [s]. */
typedef struct move {
    double angle[3]; /* [deg] */
    const char *label;
    double time;
} move;

typedef struct bench {
    double reading[3][SAMPLES], normal[3 * SAMPLES];
    int section[SAMPLES];
    const char *name[MOVES + 1];
    imk_test_record record;
    imk_calibration calibration;
    imk_observation observation[64];
    imk_calibration_result result;
    imk_procedure_findings findings;
    imk_procedure_settings settings;
    imk_error error;
} bench;

static void rest(bench *b)
{
    for (int k = 0; k < 4 * RATE; k++) {
        b->section[b->record.count] = 0;
        for (int i = 0; i < 3; i++)
            b->reading[i][b->record.count] = bias.value[i];
        b->record.count++;
    }
}

/* White noise of 1 mrad/s a sample. A steady turn is even, others begin and end gently. */
static bench *make(size_t moves, const move *moved)
{
    bench *b = calloc(1, sizeof *b);
    b->record = (imk_test_record){
        .name = "bench", .dt = 1.0 / RATE, .axis_count = {3, 0}, .section_name = b->name};
    for (int i = 0; i < 3; i++)
        b->record.reading[IMK_GYRO][i] = b->reading[i];
    b->name[0] = "rest";
    rest(b);
    for (size_t m = 0; m < moves; m++) {
        const int n = (int)(RATE * (moved[m].time > 0.0 ? moved[m].time : 5.0));
        for (int k = 0; k < n; k++) {
            const double share = 1.0 - cos(BENCH_TURN * (k + 0.5) / n);
            for (int i = 0; i < 3; i++)
                b->reading[i][b->record.count] = bias.value[i] + (1.0 + scale.value[i]) *
                                                                     moved[m].angle[i] * degree *
                                                                     share * RATE / n;
            b->section[b->record.count++] = (int)m + 1;
        }
        b->name[m + 1] = moved[m].label;
        if (moved[m].label) {
            b->record.section = b->section;
            b->record.section_count = moves + 1;
        }
        rest(b);
    }
    assert_true(b->record.count <= SAMPLES);
    imk_random_normals(imk_random_seeded(7), 0xA000, 0, 3 * b->record.count, b->normal);
    for (int i = 0; i < 3; i++)
        for (size_t k = 0; k < b->record.count; k++)
            b->reading[i][k] += 1e-3 * b->normal[3 * k + (size_t)i];
    b->settings = imk_procedure_default(IMK_PROCEDURE_TURNS);
    return b;
}

/* The log of a bench into a calibration, which may hold others. */
static imk_status observe(bench *b, imk_calibration *c)
{
    const size_t size = imk_procedure_workspace_size(IMK_PROCEDURE_TURNS, &b->record, &b->settings);
    void *workspace = malloc(size);
    const imk_status status =
        imk_procedure_observe(IMK_PROCEDURE_TURNS, c, &b->record, &b->settings, false, &b->findings,
                              workspace, size, &b->error);
    free(workspace);
    return status;
}

static imk_status solve_observed(bench *b)
{
    const size_t size = imk_calibration_workspace_size(&b->calibration);
    void *workspace = malloc(size);
    const imk_status status =
        imk_calibration_solve(&b->calibration, &b->result, workspace, size, &b->error);
    free(workspace);
    return status;
}

static imk_status solve(bench *b)
{
    imk_calibration *c = &b->calibration;
    const imk_triad before = c->model.gyro;
    imk_calibration_default(c);
    c->frame = IMK_FRAME_REFERENCE;
    if (before.present)
        c->model.gyro = before;
    c->model.gyro.axis_count = b->record.axis_count[IMK_GYRO];
    c->observation = b->observation;
    c->observation_capacity = 64;
    const imk_status status = observe(b, c);
    return status == IMK_OK ? solve_observed(b) : status;
}

static const move thrice[] = {{.angle = {0, 0, 360}},  {.angle = {0, 0, -360}},
                              {.angle = {70, 60, 0}},  {.angle = {360, 0, 0}},
                              {.angle = {-360, 0, 0}}, {.angle = {0, 50, -70}},
                              {.angle = {0, 360, 0}},  {.angle = {0, -360, 0}}};
enum { THRICE = sizeof thrice / sizeof *thrice };

static int find(const bench *b, int term, int axis, int element)
{
    for (size_t p = 0; p < b->result.parameter_count; p++) {
        const imk_model_parameter *at = &b->result.parameter[p];
        if (at->sensor == IMK_GYRO && at->term == term && at->axis == axis &&
            at->element == element)
            return (int)p;
    }
    return -1;
}

static double value_of(const bench *b, int term, int axis)
{
    const int p = find(b, term, axis, 0);
    assert_true(p >= 0);
    return b->result.value[p];
}

static double sigma_of(const bench *b, int term, int axis)
{
    const int p = find(b, term, axis, 0);
    assert_true(p >= 0);
    return b->result.sigma[p];
}

/* Turns of both signs are found among other moves, and give what they were made of: to the noise of
 * a turn, 1e-3 rad/s in 5 s of 100 Hz, 2.2e-4 rad with that of the rests, over two turns, at six
 * sigmas 1.7e-4 of an angle; of the misalignment the same. The bias has that of nine rests. Its 1
 * sigma is that of three attitudes: (W^2/3 + (0.01 deg/s)^2)/3. */
static void test_found_by_itself(void **state)
{
    (void)state;
    bench *b = make(THRICE, thrice);
    CHECK_OK(solve(b));
    assert_int_equal(b->calibration.observation_count, 1 + 6 + 3);
    assert_true(b->findings.known_turns.direction_read);
    assert_int_equal(b->findings.known_turns.other_moves, 0);
    CHECK_CLOSE(b->findings.known_turns.freedom, 3.0, 0.0);
    for (int i = 0; i < 3; i++) {
        CHECK_CLOSE(value_of(b, IMK_MODEL_SCALE_FACTOR, i), scale.value[i], 1.7e-4);
        CHECK_CLOSE(value_of(b, IMK_MODEL_BIAS, i), bias.value[i], 1e-4);
        const double earth = 7.292115e-5 * 7.292115e-5 / 3.0, sensed = 0.01 * degree;
        CHECK_RELATIVE(sigma_of(b, IMK_MODEL_BIAS, i), sqrt((earth + sensed * sensed) / 3.0), 0.02);
        /* Two turns, each 0.1 deg of 360 deg, and the noise. */
        CHECK_RELATIVE(sigma_of(b, IMK_MODEL_SCALE_FACTOR, i), 0.1 / 360.0 / sqrt(2.0), 0.06);
        for (int j = 0; j < 3; j++) {
            const int p = find(b, IMK_MODEL_MISALIGNMENT, i, j);
            assert_int_equal(p >= 0, i != j);
            if (p < 0)
                continue;
            CHECK_CLOSE(b->result.value[p], 0.0, 1.7e-4);
            CHECK_RELATIVE(b->result.sigma[p], 0.1 * degree, 0.02);
        }
    }
    free(b);
}

/* What does not turn with the unit has no part in a scale factor: another bias in each attitude
 * changes nothing but the bias and its sigma. */
static void test_offsets_take_no_part(void **state)
{
    (void)state;
    bench *one = make(THRICE, thrice), *other = make(THRICE, thrice);
    CHECK_OK(solve(one));
    size_t from[3] = {0};
    int rests = 0;
    for (size_t k = 1; k < other->record.count;
         k++) /* from the middles of the two other moves on */
        if (other->section[k] == 0 && other->section[k - 1] != 0 && (++rests == 3 || rests == 6))
            from[rests / 3] = k - 5 * RATE / 2;
    for (int attitude = 1; attitude < 3; attitude++)
        for (size_t k = from[attitude]; k < other->record.count; k++)
            other->reading[1][k] += 2e-3;
    CHECK_OK(solve(other));
    for (int i = 0; i < 3; i++)
        CHECK_CLOSE(value_of(one, IMK_MODEL_SCALE_FACTOR, i),
                    value_of(other, IMK_MODEL_SCALE_FACTOR, i), 1e-12);
    CHECK_CLOSE(value_of(other, IMK_MODEL_BIAS, 1) - value_of(one, IMK_MODEL_BIAS, 1), 2e-3, 1e-12);
    assert_true(sigma_of(other, IMK_MODEL_BIAS, 1) > 5.0 * sigma_of(one, IMK_MODEL_BIAS, 1));
    free(one);
    free(other);
}

/* Labels state angles and directions; what is not said is that of the settings, and as the gyro
 * reads. */
static void test_labels(void **state)
{
    (void)state;
    static const move moves[] = {{{0, 0, 90}, "z +90deg", 2},  {{0, 0, -90}, "turn z -90 deg", 2},
                                 {{45, 0, 0}, "move", 2},      {{-90, 0, 0}, "x_90deg", 2},
                                 {{180, 0, 0}, "x 180deg", 3}, {{0, 45, 0}, "x to y", 2},
                                 {{0, 360, 0}, "y_rot", 5},    {{0, -360, 0}, "y", 5},
                                 {{0, -360, 0}, "-y turn", 5}};
    bench *b = make(sizeof moves / sizeof *moves, moves);
    CHECK_OK(solve(b));
    static const double due[] = {90, -90, -90, 180, 360, -360, -360};
    static const int about[] = {2, 2, 0, 0, 1, 1, 1};
    const imk_observation *turn = b->observation + 1;
    assert_int_equal(b->calibration.observation_count, 1 + 7 + 3);
    for (size_t k = 0; k < 7; k++)
        CHECK_CLOSE(turn[k].rate[about[k]] * turn[k].turn_time, due[k] * degree, 1e-12);
    for (int i = 0; i < 3; i++)
        CHECK_CLOSE(value_of(b, IMK_MODEL_SCALE_FACTOR, i), scale.value[i], 7e-4);
    assert_true(b->findings.known_turns.direction_read);
    free(b);
}

/* The direction of a label stands against what the gyro reads. */
static void test_wrong_sign(void **state)
{
    (void)state;
    static const move moves[] = {{{0, 0, 360}, "z -360deg", 0}, {{0, 0, -360}, "z +360deg", 0}};
    bench *b = make(2, moves);
    CHECK_OK(solve(b));
    CHECK_CLOSE(value_of(b, IMK_MODEL_SCALE_FACTOR, 2), -2.0 - scale.value[2], 1.7e-4);
    assert_false(b->findings.known_turns.direction_read);
    free(b);
}

/* One gyro, turned about its axis: bias and scale factor, and no more. */
static void test_one_gyro(void **state)
{
    (void)state;
    static const move moves[] = {{.angle = {0, 0, 360}}, {.angle = {0, 0, -360}}};
    bench *b = make(2, moves);
    b->record.axis_count[IMK_GYRO] = 1;
    b->record.reading[IMK_GYRO][0] = b->reading[2];
    imk_calibration_default(&b->calibration);
    imk_triad *gyro = &b->calibration.model.gyro;
    for (int j = 0; j < 3; j++)
        gyro->direction[0][j] = j == 2 ? -1.0 : 0.0;
    CHECK_OK(solve(b));
    assert_int_equal(b->result.parameter_count, 2);
    /* The axis is against z: turns read the other way round, the scale factor is the same. */
    CHECK_CLOSE(value_of(b, IMK_MODEL_SCALE_FACTOR, 0), scale.value[2], 1.7e-4);
    CHECK_CLOSE(b->observation[1].rate[2] * b->observation[1].turn_time, -360.0 * degree, 1e-12);
    free(b);
}

/* Only what was turned about is determined. */
static void test_one_axis(void **state)
{
    (void)state;
    static const move moves[] = {{.angle = {0, 360, 0}}};
    bench *b = make(1, moves);
    CHECK_OK(solve(b));
    assert_int_equal(b->result.parameter_count, 3 + 1 + 2);
    assert_int_equal(b->findings.undetermined_count, 2);
    assert_int_equal(b->findings.undetermined[0].axis, 0);
    assert_int_equal(b->findings.undetermined[1].axis, 2);
    CHECK_CLOSE(b->findings.known_turns.freedom, 0.0, 0.0);
    free(b);
}

/* Half a turn among whole ones, and one about an axis between the axes, are told and left out. */
static void test_other_moves(void **state)
{
    (void)state;
    move moves[THRICE];
    memcpy(moves, thrice, sizeof moves);
    moves[1].angle[2] = -180.0;
    bench *b = make(THRICE, moves);
    CHECK_OK(solve(b));
    assert_int_equal(b->calibration.observation_count, 1 + 5 + 3);
    assert_int_equal(b->findings.known_turns.other_moves, 1);
    assert_int_equal(b->findings.known_turns.other_axis, 2);
    CHECK_CLOSE(b->findings.known_turns.other_angle, -180.0 * degree * 1.003, 2e-3);
    free(b);
    moves[1] = thrice[1];
    moves[4].angle[1] = 200.0;
    b = make(THRICE, moves);
    CHECK_OK(solve(b));
    assert_int_equal(b->calibration.observation_count, 1 + 5 + 3);
    assert_int_equal(b->findings.known_turns.other_axis, -1);
    free(b);
}

/* Where no move is near the angle stated, the largest are the turns, and the scale factor says so.
 */
static void test_wrong_angle(void **state)
{
    (void)state;
    bench *b = make(THRICE, thrice);
    b->settings.turn_angle = 720.0 * degree;
    CHECK_OK(solve(b));
    for (int i = 0; i < 3; i++)
        CHECK_CLOSE(value_of(b, IMK_MODEL_SCALE_FACTOR, i), 0.5 * (1.0 + scale.value[i]) - 1.0,
                    1e-4);
    free(b);
}

/* In counts, where nothing says how large the readings of a turn are, most moves are turns: two
 * moves by twice the angle are none. */
static void test_counts_of_most(void **state)
{
    (void)state;
    move moves[THRICE];
    memcpy(moves, thrice, sizeof moves);
    moves[2] = (move){.angle = {720, 0, 0}};
    moves[5] = (move){.angle = {0, -720, 0}};
    bench *b = make(THRICE, moves);
    for (int i = 0; i < 3; i++)
        for (size_t k = 0; k < b->record.count; k++)
            b->reading[i][k] = rint(940.0 * b->reading[i][k]);
    b->record.counts[IMK_GYRO] = true;
    CHECK_OK(solve(b));
    CHECK_RELATIVE(b->result.model.gyro.sensitivity.value[2], 940.0, 0.01);
    assert_int_equal(b->findings.known_turns.other_moves, 2);
    CHECK_CLOSE(b->findings.known_turns.other_angle, 720.0 * degree, 0.2);
    free(b);
}

/* A turn in which a gyro is at the end of its range is left out, stated or seen. */
static void test_saturated(void **state)
{
    (void)state;
    const double end = 3.0; /* [rad/s]; the first turn reaches 4.2, the others 2.5 */
    move moves[THRICE];
    memcpy(moves, thrice, sizeof moves);
    moves[0].time = 3.0;
    for (int stated = 0; stated < 2; stated++) {
        bench *b = make(THRICE, moves);
        for (size_t k = 0; k < b->record.count; k++)
            b->reading[2][k] = fmin(b->reading[2][k], end);
        imk_calibration_default(&b->calibration);
        b->calibration.model.gyro.range.value[2] = stated ? end : 0.0;
        CHECK_OK(solve(b));
        assert_int_equal(b->findings.known_turns.saturated, 1);
        assert_int_equal(b->calibration.observation_count, 1 + 5 + 3);
        CHECK_CLOSE(value_of(b, IMK_MODEL_SCALE_FACTOR, 2), scale.value[2], 2.4e-4);
        free(b);
    }
}

/* Two turns that differ by 1 deg, or by no more than the 0.1 deg stated of each leave to chance, a
 * degree of freedom: Student's interval of their half difference, 12.7 times. */
static void test_scatter(void **state)
{
    (void)state;
    static const double off[] = {1.0, 0.2};
    for (int k = 0; k < 2; k++) {
        const move moves[] = {{.angle = {0, 0, 360}}, {.angle = {0, 0, -360 - off[k]}}};
        bench *b = make(2, moves);
        CHECK_OK(solve(b));
        const int p = find(b, IMK_MODEL_SCALE_FACTOR, 2, 0);
        const double half = imk_calibration_half_width(&b->result, p, 0.95);
        const double scatter = b->findings.known_turns.scatter;
        CHECK_CLOSE(scatter, off[k] * degree / sqrt(2.0), 0.035 * degree);
        CHECK_RELATIVE(
            half, imk_student_quantile(0.975, 1.0) * scatter / (sqrt(2.0) * 360 * degree), 0.05);
        free(b);
    }
}

/* Three logs of turns about one axis each: the bias has three attitudes, and how little they differ
 * here makes nothing more certain, neither it nor how square the axes are. */
static void test_several_logs(void **state)
{
    (void)state;
    static const move moves[3][2] = {{{.angle = {360, 0, 0}}, {.angle = {-360, 0, 0}}},
                                     {{.angle = {0, 360, 0}}, {.angle = {0, -360, 0}}},
                                     {{.angle = {0, 0, 360}}, {.angle = {0, 0, -360}}}};
    bench *b[3];
    for (int k = 0; k < 3; k++)
        b[k] = make(2, moves[k]);
    CHECK_OK(solve(b[0]));
    const double alone = sigma_of(b[0], IMK_MODEL_BIAS, 1);
    CHECK_OK(observe(b[1], &b[0]->calibration));
    CHECK_OK(observe(b[2], &b[0]->calibration));
    assert_int_equal(b[0]->calibration.observation_count, 1 + 3 * 3);
    CHECK_OK(solve_observed(b[0]));
    CHECK_RELATIVE(sigma_of(b[0], IMK_MODEL_BIAS, 1), alone / sqrt(3.0), 1e-3);
    for (int i = 0; i < 3; i++) {
        CHECK_CLOSE(value_of(b[0], IMK_MODEL_SCALE_FACTOR, i), scale.value[i], 1.7e-4);
        const int p = find(b[0], IMK_MODEL_MISALIGNMENT, i, (i + 1) % 3);
        CHECK_RELATIVE(b[0]->result.sigma[p], 0.1 * degree, 0.02);
    }
    for (int k = 0; k < 3; k++)
        free(b[k]);
}

/* In counts the sensitivity is found; the scale factors are relative to it. */
static void test_counts(void **state)
{
    (void)state;
    bench *b = make(THRICE, thrice);
    for (int i = 0; i < 3; i++)
        for (size_t k = 0; k < b->record.count; k++)
            b->reading[i][k] = rint(940.0 * b->reading[i][k] + 2000.0);
    b->record.counts[IMK_GYRO] = true;
    CHECK_OK(solve(b));
    const imk_triad *gyro = &b->result.model.gyro;
    for (int i = 0; i < 3; i++) {
        CHECK_RELATIVE(gyro->sensitivity.value[i] * (1.0 + gyro->scale_factor.fixed.value[i]),
                       940.0 * (1.0 + scale.value[i]), 1.7e-4);
        CHECK_CLOSE(gyro->zero_offset.value[i] +
                        gyro->sensitivity.value[i] * gyro->bias.fixed.value[i],
                    2000.0 + 940.0 * bias.value[i], 0.1);
    }
    free(b);
}

static void test_refusals(void **state)
{
    (void)state;
    bench *b = make(THRICE, thrice);
    b->settings.turn_angle = -1.0;
    CHECK_STATUS(solve(b), IMK_ERROR_RANGE);
    b->settings.turn_angle = (double)NAN;
    CHECK_STATUS(solve(b), IMK_ERROR_RANGE);
    b->settings.turn_angle = BENCH_TURN;
    b->record.axis_count[IMK_GYRO] = 0;
    b->record.axis_count[IMK_ACCEL] = 1;
    b->record.reading[IMK_ACCEL][0] = b->reading[0];
    CHECK_STATUS(solve(b), IMK_ERROR_KEY_MISSING);
    b->record.axis_count[IMK_GYRO] = 3;
    b->record.axis_count[IMK_ACCEL] = 0;
    imk_calibration_default(&b->calibration);
    b->calibration.model.gyro.direction[0][0] = b->calibration.model.gyro.direction[0][1] =
        sqrt(0.5);
    CHECK_STATUS(solve(b), IMK_ERROR_UNSUPPORTED);
    free(b);
    b = make(0, thrice); /* it never moves */
    CHECK_STATUS(solve(b), IMK_ERROR_TOO_SHORT);
    assert_string_equal(b->error.field, "hold");
    free(b);
    static const move crooked[] = {{.angle = {200, 200, 200}}};
    b = make(1, crooked);
    CHECK_STATUS(solve(b), IMK_ERROR_TOO_SHORT);
    assert_string_equal(b->error.field, "turn");
    free(b);
}

/* Simulated benches: 95 % intervals hold the truth in at least as many of all scale factors as a
 * share of 93 % would with a probability of 1e-7, and scale factors and misalignments scatter as
 * their sigmas say: sums of squares with the quantiles of chi-square at 1e-7, widened by 10 % for
 * what of a sigma is estimated. */
static void test_intervals(void **state)
{
    (void)state;
    static const turns_plan plan = {.pairs = 2, .angle = BENCH_TURN, .placement = 1.7e-3};
    const uint32_t benches = check_runs(100);
    static coverage_count count;
    session *b = session_new();
    for (uint32_t n = 0; n < benches; n++) {
        imk_error error;
        assert_true(turns_run(b, &plan, 3, n, &error));
        coverage_add(&count, &b->result, &b->truth, 0.95);
    }
    size_t held = 0, numbers = 0;
    double square = 0.0;
    for (size_t p = 0; p < count.parameter_count; p++) {
        if (count.parameter[p].term == IMK_MODEL_BIAS)
            continue;
        held += count.held[p];
        numbers += count.benches;
        square += count.square[p];
    }
    assert_int_equal(numbers, 9 * benches);
    assert_true(held >= coverage_least_held(numbers, 0.93, 1e-7));
    CHECK_BELOW(square, 1.1 * imk_chi_square_quantile(1.0 - 1e-7, (double)numbers));
    assert_true(square > 0.9 * imk_chi_square_quantile(1e-7, (double)numbers));
    session_free(b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_found_by_itself), cmocka_unit_test(test_offsets_take_no_part),
        cmocka_unit_test(test_labels),          cmocka_unit_test(test_wrong_sign),
        cmocka_unit_test(test_one_gyro),        cmocka_unit_test(test_one_axis),
        cmocka_unit_test(test_other_moves),     cmocka_unit_test(test_wrong_angle),
        cmocka_unit_test(test_counts_of_most),  cmocka_unit_test(test_saturated),
        cmocka_unit_test(test_scatter),         cmocka_unit_test(test_counts),
        cmocka_unit_test(test_several_logs),    cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_intervals)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
