/* SPDX-License-Identifier: Apache-2.0 */
/* Motion scripts that are refused: which number of which step, and nothing written. */
#include "check.h"

#include "imukit/motion_script.h"

#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846
#define DEGREE (PI / 180.0)

/* A script without Earth. */
static imk_motion_script plain(size_t count, const imk_motion_step *step)
{
    imk_motion_script script = imk_motion_script_default();
    script.earth = false;
    script.step_count = count;
    script.step = step;
    return script;
}

static void check_refusal(const imk_motion_script *script, imk_status status, const char *field,
                          int index)
{
    imk_error error;
    size_t count = 99;
    CHECK_STATUS(imk_motion_script_pieces(script, &count, &error), status);
    assert_int_equal(count, 0);
    CHECK_STATUS(error.status, status);
    assert_string_equal(error.field, field);
    assert_int_equal(error.index, index);
    assert_true(error.expected[0] != '\0');
    CHECK_STATUS(imk_motion_script_pieces(script, &count, NULL), status);
}

static void test_refused_steps(void **unused)
{
    (void)unused;
    const imk_motion_step good = {.kind = IMK_STEP_HOLD, .duration = 1.0};
    static const struct {
        imk_motion_step step;
        imk_status status;
        const char *field;
    } cases[] = {
        {{.kind = (imk_step_kind)8}, IMK_ERROR_RANGE, "step.kind"},
        {{.kind = IMK_STEP_HOLD}, IMK_ERROR_RANGE, "step.duration"},
        {{.kind = IMK_STEP_HOLD, .duration = -1.0}, IMK_ERROR_RANGE, "step.duration"},
        {{.kind = IMK_STEP_HOLD, .duration = (double)NAN}, IMK_ERROR_NOT_FINITE, "step.duration"},
        {{.kind = IMK_STEP_HOLD, .duration = 2e9}, IMK_ERROR_RANGE, "step.duration"},
        {{.kind = IMK_STEP_HOLD, .duration = 0.9e-6}, IMK_ERROR_RANGE, "step.duration"},
        {{.kind = IMK_STEP_POSE, .duration = 1e-320, .angle = {3.0, 1.0, 0.0}},
         IMK_ERROR_RANGE,
         "step.duration"},
        {{.kind = IMK_STEP_ACCELERATE, .amount = 1.0}, IMK_ERROR_RANGE, "step.rate"},
        {{.kind = IMK_STEP_ACCELERATE, .amount = 1.0, .rate = -1.0}, IMK_ERROR_RANGE, "step.rate"},
        {{.kind = IMK_STEP_ACCELERATE, .amount = (double)INFINITY, .rate = 1.0},
         IMK_ERROR_NOT_FINITE,
         "step.amount"},
        {{.kind = IMK_STEP_ACCELERATE, .amount = -10.5, .rate = 1.0},
         IMK_ERROR_RANGE,
         "step.amount"},
        {{.kind = IMK_STEP_ACCELERATE, .amount = 99995.0, .rate = 1.0},
         IMK_ERROR_RANGE,
         "step.amount"},
        {{.kind = IMK_STEP_TURN, .amount = (double)NAN, .rate = 1.0},
         IMK_ERROR_NOT_FINITE,
         "step.amount"},
        {{.kind = IMK_STEP_TURN, .amount = 1.0, .rate = (double)NAN},
         IMK_ERROR_NOT_FINITE,
         "step.rate"},
        {{.kind = IMK_STEP_CLIMB, .amount = 2e6, .rate = 1.0}, IMK_ERROR_RANGE, "step.amount"},
        {{.kind = IMK_STEP_ROTATE, .axis = 3, .amount = 1.0, .rate = 1.0},
         IMK_ERROR_RANGE,
         "step.axis"},
        {{.kind = IMK_STEP_ROTATE, .axis = -1, .amount = 1.0, .rate = 1.0},
         IMK_ERROR_RANGE,
         "step.axis"},
        {{.kind = IMK_STEP_POSE, .duration = 1.0, .angle = {0.0, (double)NAN, 0.0}},
         IMK_ERROR_NOT_FINITE,
         "step.angle"},
        {{.kind = IMK_STEP_SWING, .amount = 0.1, .duration = 1.0},
         IMK_ERROR_RANGE,
         "step.frequency"},
        {{.kind = IMK_STEP_SWING, .amount = 0.1, .duration = 1.0, .frequency = 1.9},
         IMK_ERROR_RANGE,
         "step.duration"},
        {{.kind = IMK_STEP_CONING, .amount = 4.0, .duration = 9.0, .frequency = 1.0},
         IMK_ERROR_RANGE,
         "step.amount"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const imk_motion_step steps[3] = {good, good, cases[i].step};
        imk_motion_script script = plain(3, steps);
        script.speed = 10.0;
        check_refusal(&script, cases[i].status, cases[i].field, 2);
    }
}

static void test_refused_scripts(void **unused)
{
    (void)unused;
    const imk_motion_step good[] = {{.kind = IMK_STEP_HOLD, .duration = 100.0}};
    imk_motion_script script = {.step_count = 1, .step = good};
    check_refusal(&script, IMK_ERROR_UNINITIALISED, "motion script", -1);
    script = plain(0, good);
    check_refusal(&script, IMK_ERROR_TOO_SHORT, "step", -1);
    script = plain(1, NULL);
    check_refusal(&script, IMK_ERROR_TOO_SHORT, "step", -1);
    static const struct {
        size_t offset;
        const char *field;
        double bad;
    } cases[] = {
        {offsetof(imk_motion_script, smoothing), "smoothing", 0.0},
        {offsetof(imk_motion_script, smoothing), "smoothing", 1001.0},
        {offsetof(imk_motion_script, place.latitude), "place.latitude", 1.6},
        {offsetof(imk_motion_script, place.longitude), "place.longitude", 7.0},
        {offsetof(imk_motion_script, place.height), "place.height", -2e4},
        {offsetof(imk_motion_script, heading), "heading", 1e7},
        {offsetof(imk_motion_script, climb), "climb", -1.6},
        {offsetof(imk_motion_script, speed), "speed", -1.0},
        {offsetof(imk_motion_script, speed), "speed", 2e5},
        {offsetof(imk_motion_script, mounting[0]), "mounting.roll", 1e7},
        {offsetof(imk_motion_script, mounting[1]), "mounting.pitch", -1e7},
        {offsetof(imk_motion_script, mounting[2]), "mounting.yaw", 1e7},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const double values[2] = {cases[i].bad, (double)NAN};
        for (int j = 0; j < 2; j++) {
            script = plain(1, good);
            memcpy((char *)&script + cases[i].offset, &values[j], sizeof values[j]);
            check_refusal(&script, j ? IMK_ERROR_NOT_FINITE : IMK_ERROR_RANGE, cases[i].field, -1);
        }
    }
}

/* A pole on the way, and ground below: refused where it happens. At rest a pole is a place. */
static void test_refused_ways(void **unused)
{
    (void)unused;
    const imk_motion_step steps[] = {
        {.kind = IMK_STEP_HOLD, .duration = 10.0},
        {.kind = IMK_STEP_ACCELERATE, .amount = 200.0, .rate = 20.0},
        {.kind = IMK_STEP_HOLD, .duration = 1000.0},
    };
    imk_motion_script script = plain(3, steps);
    script.earth = true;
    script.place.latitude = 89.5 * DEGREE;
    check_refusal(&script, IMK_ERROR_RANGE, "step.latitude", 2);
    script.place.latitude = -89.95 * DEGREE;
    check_refusal(&script, IMK_ERROR_RANGE, "step.latitude", 1);
    script.place.latitude = 0.5;
    script.climb = -0.3;
    check_refusal(&script, IMK_ERROR_RANGE, "step.height", 2);
    script.place.latitude = 0.5 * PI;
    script.step_count = 1;
    size_t count = 0;
    CHECK_OK(imk_motion_script_pieces(&script, &count, NULL));
    assert_int_equal(count, 2);
}

/* The shortest step, early and so late that its pieces are below the resolution of the time: the
 * search for good pieces ends either way. */
static void test_shortest_step(void **unused)
{
    (void)unused;
    const imk_motion_step steps[] = {
        {.kind = IMK_STEP_HOLD, .duration = 4.0},
        {.kind = IMK_STEP_POSE, .duration = 1e-6, .angle = {3.0, 1.0, 0.0}},
        {.kind = IMK_STEP_HOLD, .duration = 4.0},
    };
    imk_motion_script script = plain(3, steps);
    size_t count = 0;
    CHECK_OK(imk_motion_script_pieces(&script, &count, NULL));
    assert_in_range(count, 3, 1000);
    const imk_motion_step late[] = {{.kind = IMK_STEP_HOLD, .duration = 1e9}, steps[1]};
    script = plain(2, late);
    check_refusal(&script, IMK_ERROR_RANGE, "step", 1);
}

/* More pieces than there may be are refused at once, not after minutes. */
static void test_too_many_pieces(void **unused)
{
    (void)unused;
    const imk_motion_step steps[] = {
        {.kind = IMK_STEP_HOLD, .duration = 10.0},
        {.kind = IMK_STEP_HOLD, .duration = 9e8},
    };
    imk_motion_script script = plain(2, steps);
    script.speed = 1.0;
    check_refusal(&script, IMK_ERROR_RANGE, "step", 1);
}

static void test_too_small_an_array(void **unused)
{
    (void)unused;
    const imk_motion_step steps[] = {{.kind = IMK_STEP_TURN, .amount = 1.0, .rate = 1.0}};
    const imk_motion_script script = plain(1, steps);
    size_t count = 0;
    CHECK_OK(imk_motion_script_pieces(&script, &count, NULL));
    imk_trajectory_piece *piece = malloc(count * sizeof *piece);
    assert_non_null(piece);
    imk_error error;
    imk_trajectory trajectory = {.piece_count = 77};
    CHECK_STATUS(imk_motion_script_compile(&script, piece, count - 1, &trajectory, &error),
                 IMK_ERROR_WORKSPACE);
    assert_int_equal(trajectory.piece_count, 77);
    free(piece);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_refused_steps),   cmocka_unit_test(test_refused_scripts),
        cmocka_unit_test(test_refused_ways),    cmocka_unit_test(test_shortest_step),
        cmocka_unit_test(test_too_many_pieces), cmocka_unit_test(test_too_small_an_array),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
