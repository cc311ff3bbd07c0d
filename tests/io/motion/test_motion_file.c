/* SPDX-License-Identifier: Apache-2.0 */
/* Motion files: what words become steps, which are refused, and the vibration.
 * Converted values are computed here from the definitions of the units: deg = pi/180 rad,
 * g = 9.80665 m/s^2. */
#define _POSIX_C_SOURCE 200809L

#include "check.h"

#include "imukit/io.h"

#include "io/motion/motion_file_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static const double degree = 3.14159265358979323846 / 180;
static const double pi = 3.14159265358979323846;
static const double gravity = 9.80665;

/* A few roundings of conversion. */
static const double rounding = 1e-15;

static void fail_with(const imk_error *error)
{
    char message[512];
    imk_error_text(error, NULL, message, sizeof message);
    fail_msg("%s", message);
}

static imk_motion_file *parsed(const char *text)
{
    imk_motion_file *file = NULL;
    imk_error error;
    if (imk_motion_parse(text, strlen(text), NULL, 1, &file, &error) != IMK_OK)
        fail_with(&error);
    return file;
}

/* ---- steps ----------------------------------------------------------------------------------- */

/* The steps of a list in brackets, by a body that begins at 10 m/s towards the east. */
static size_t steps_of(const char *list, imk_motion_step *steps, size_t capacity)
{
    char text[512];
    imk_document *document = NULL;
    imki_script_reader reader;
    imk_error error;
    snprintf(text, sizeof text,
             "imukit_motion: 1\nstart: {heading: 90 deg, speed: 10 m/s}\nsteps: %s", list);
    if (imki_document_parse_as("motion", "imukit_motion: 1", text, strlen(text), &document,
                               &error) != IMK_OK ||
        imki_script_read(document, NULL, &reader, &error) != IMK_OK)
        fail_with(&error);
    const size_t count = reader.step_count;
    assert_true(count <= capacity);
    memcpy(steps, reader.step, count * sizeof steps[0]);
    free(reader.step);
    free(reader.step_node);
    imk_document_free(document);
    return count;
}

typedef struct step_case {
    const char *step;
    imk_step_kind kind;
    int axis;
    double amount, rate, duration, frequency; /* degrees where they are angles */
    double unit;                              /* of amount and rate */
    bool banked;
} step_case;

/* Smoothing 0.5 s: "in 10 s" is 9.5 s at the rate and 0.5 s of ramps. */
static const step_case step_cases[] = {
    {"hold 10 s", IMK_STEP_HOLD, 0, 0, 0, 10, 0, 1, false},
    {"hold for 2 min", IMK_STEP_HOLD, 0, 0, 0, 120, 0, 1, false},
    {"accelerate 2 m/s^2 for 10 s", IMK_STEP_ACCELERATE, 0, 20, 2, 0, 0, 1, false},
    {"accelerate -0.1 g for 10 s", IMK_STEP_ACCELERATE, 0, -9.80665, 0.980665, 0, 0, 1, false},
    {"accelerate 5 m/s at 2 m/s^2", IMK_STEP_ACCELERATE, 0, 5, 2, 0, 0, 1, false},
    {"accelerate 19 m/s in 10 s", IMK_STEP_ACCELERATE, 0, 19, 2, 0, 0, 1, false},
    {"accelerate to 20 m/s at 2 m/s^2", IMK_STEP_ACCELERATE, 0, 10, 2, 0, 0, 1, false},
    {"accelerate at 2 m/s^2 to 20 m/s", IMK_STEP_ACCELERATE, 0, 10, 2, 0, 0, 1, false},
    {"accelerate to 36 km/h at 1 m/s^2", IMK_STEP_HOLD, 0, 0, 0, 0, 0, 0, false},
    {"accelerate to 10 m/s in 4 s", IMK_STEP_HOLD, 0, 0, 0, 4, 0, 1, false},
    {"brake to 4 m/s at 3 m/s^2", IMK_STEP_ACCELERATE, 0, -6, 3, 0, 0, 1, false},
    {"brake 3 m/s^2 for 2 s", IMK_STEP_ACCELERATE, 0, -6, 3, 0, 0, 1, false},
    {"brake 4 m/s at 2 m/s^2", IMK_STEP_ACCELERATE, 0, -4, 2, 0, 0, 1, false},
    {"stop at 3 m/s^2", IMK_STEP_ACCELERATE, 0, -10, 3, 0, 0, 1, false},
    {"stop in 5.5 s", IMK_STEP_ACCELERATE, 0, -10, 2, 0, 0, 1, false},
    {"turn 90 deg at 10 deg/s", IMK_STEP_TURN, 0, 90, 10, 0, 0, 0, false},
    {"turn -90 deg at 10 deg/s banked", IMK_STEP_TURN, 0, -90, 10, 0, 0, 0, true},
    {"turn left 90 deg at 10 deg/s", IMK_STEP_TURN, 0, -90, 10, 0, 0, 0, false},
    {"turn banked right 95 deg in 10 s", IMK_STEP_TURN, 0, 95, 10, 0, 0, 0, true},
    {"turn to 270 deg at 10 deg/s", IMK_STEP_TURN, 0, -180, 10, 0, 0, 0, false},
    {"turn to 300 deg at 10 deg/s", IMK_STEP_TURN, 0, -150, 10, 0, 0, 0, false},
    {"turn right to 0 deg at 10 deg/s", IMK_STEP_TURN, 0, 270, 10, 0, 0, 0, false},
    {"turn left to 180 deg at 10 deg/s", IMK_STEP_TURN, 0, -270, 10, 0, 0, 0, false},
    {"turn to 450 deg at 10 deg/s", IMK_STEP_HOLD, 0, 0, 0, 0, 0, 0, false},
    {"climb 5 deg at 2 deg/s", IMK_STEP_CLIMB, 0, 5, 2, 0, 0, 0, false},
    {"climb to -5 deg at 2 deg/s", IMK_STEP_CLIMB, 0, -5, 2, 0, 0, 0, false},
    {"rotate z 360 deg at 36 deg/s", IMK_STEP_ROTATE, 2, 360, 36, 0, 0, 0, false},
    {"rotate y -1 rev at 6 rpm", IMK_STEP_ROTATE, 1, -360, 36, 0, 0, 0, false},
    {"rotate x 95 deg in 10 s", IMK_STEP_ROTATE, 0, 95, 10, 0, 0, 0, false},
    {"rotate z at -100 deg/s for 10 s", IMK_STEP_ROTATE, 2, -1000, 100, 0, 0, 0, false},
    {"swing x 5 deg at 1 Hz for 20 s", IMK_STEP_SWING, 0, 5, 0, 20, 1, 0, false},
    {"coning z 1 deg at 10 Hz for 60 s", IMK_STEP_CONING, 2, 1, 0, 60, 10, 0, false},
};

static void words_become_steps(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(step_cases); i++) {
        const step_case *c = &step_cases[i];
        const double unit = c->unit != 0.0 ? c->unit : degree;
        char list[128];
        imk_motion_step step[4];
        const bool nothing = c->kind == IMK_STEP_HOLD && c->duration == 0.0;
        if (strstr(c->step, "km/h")) /* 36 km/h is 10 m/s up to rounding */
            continue;
        snprintf(list, sizeof list, "[hold 1 s, %s]", c->step);
        const size_t count = steps_of(list, step, COUNT(step));
        if (count != (nothing ? 1 : 2))
            fail_msg("%s: %zu steps", c->step, count);
        if (nothing)
            continue;
        const imk_motion_step *s = &step[1];
        const double wrong =
            fmax(fmax(fabs(s->amount - c->amount * unit), fabs(s->rate - c->rate * unit)),
                 fmax(fabs(s->duration - c->duration), fabs(s->frequency - c->frequency)));
        /* Angles are sums of some pi: rounded to 1e-15. */
        if (s->kind != c->kind || s->axis != c->axis || s->banked != c->banked || !(wrong < 1e-14))
            fail_msg("%s: kind %d axis %d amount %.17g rate %.17g duration %.17g frequency %.17g",
                     c->step, (int)s->kind, s->axis, s->amount, s->rate, s->duration, s->frequency);
    }
}

static void pose_has_three_angles(void **state)
{
    (void)state;
    imk_motion_step step;
    assert_int_equal(steps_of("[pose 10 -20 30 deg in 5 s]", &step, 1), 1);
    assert_int_equal(step.kind, IMK_STEP_POSE);
    CHECK_RELATIVE(step.angle[0], 10 * degree, rounding);
    CHECK_RELATIVE(step.angle[1], -20 * degree, rounding);
    CHECK_RELATIVE(step.angle[2], 30 * degree, rounding);
    CHECK_CLOSE(step.duration, 5, 0);
}

/* "to" counts from what the steps before have made, in each pass of a repeat. */
static void repeats_are_written_out(void **state)
{
    (void)state;
    imk_motion_step step[16];
    size_t count =
        steps_of("[repeat: {times: 3, steps: [accelerate to 12 m/s at 1 m/s^2, "
                 "repeat: {times: 2, steps: [turn right to 90 deg at 9 deg/s, turn right "
                 "to 180 deg at 9 deg/s]}, level at 1 deg/s]}]",
                 step, COUNT(step));
    /* 90 -> 180 the first time: nothing to turn to 90 deg; 270 deg, then 90 deg in every other. */
    assert_int_equal(count, 1 + 1 + 5 * 2);
    CHECK_CLOSE(step[0].amount, 2, 0);
    CHECK_CLOSE(step[1].amount, 90 * degree, 1e-15);
    for (size_t i = 2; i < count; i++)
        CHECK_CLOSE(step[i].amount, (i % 2 == 0 ? 270 : 90) * degree, 1e-14);
}

/* ---- whole scripts --------------------------------------------------------------------------- */

static const char car[] = "imukit_motion: 1\n"
                          "name: car\n"
                          "start: {latitude: 60 deg, longitude: 7 deg, height: 300 m, heading: 90 "
                          "deg}\n"
                          "mounting: {roll: 0 deg, pitch: 0 deg, yaw: 90 deg}\n"
                          "smoothing: 1 s\n"
                          "earth: yes\n"
                          "steps:\n"
                          "  - hold 10 s\n"
                          "  - accelerate to 20 m/s at 2 m/s^2\n"
                          "  - turn right 90 deg at 9 deg/s banked\n"
                          "  - stop at 4 m/s^2\n";

/* 10 s, 20/2 + 1 s, 90/9 + 1 s, 20/4 + 1 s. The body yawed by 90 deg in a car that goes south then
 * faces west: yaw 270 deg. */
static void script_is_compiled(void **state)
{
    (void)state;
    imk_motion_file *file = parsed(car);
    assert_int_equal(imk_motion_file_kind(file), IMK_MOTION_SCRIPT);
    assert_string_equal(imk_motion_file_name(file), "car");
    assert_string_equal(imk_motion_file_note(file), "");
    CHECK_RELATIVE(imk_motion_file_duration(file), 38, 1e-14);
    const imk_motion *motion = imk_motion_file_motion(file);
    assert_non_null(motion->trajectory);
    assert_null(motion->recorded);
    CHECK_OK(imk_trajectory_validate(motion->trajectory, NULL));
    imk_motion_state at;
    imk_trajectory_state(motion->trajectory, 0.0, &at);
    CHECK_CLOSE(at.place.latitude, 60 * degree, 1e-12);
    CHECK_CLOSE(at.place.longitude, 7 * degree, 1e-12);
    CHECK_CLOSE(at.place.height, 300, 1e-6);
    imk_trajectory_state(motion->trajectory, 40.0, &at);
    double roll, pitch, yaw;
    imk_matrix3_to_euler(at.c_nb, &roll, &pitch, &yaw);
    CHECK_CLOSE(yaw, -90 * degree, 1e-6);
    CHECK_CLOSE(imk_vector3_norm(at.velocity), 0.0, 1e-9);
    imk_motion_file_free(file);
}

/* The manual, to be freed. */
static char *manual(void)
{
    char *text = calloc(1, 1 << 16);
    FILE *file = fopen(SOURCE_DIRECTORY "/docs/motion-file.md", "rb");
    assert_non_null(file);
    assert_non_null(text);
    assert_true(fread(text, 1, (1 << 16) - 1, file) > 0);
    fclose(file);
    return text;
}

/* A swing takes 20 to 80 pieces a cycle: room for a thousand does not do for a hundred cycles. */
static void long_scripts_are_compiled_whole(void **state)
{
    (void)state;
    static const char swing[] = "imukit_motion: 1\nsteps:\n  - swing x 5 deg at 1 Hz for 100 s\n";
    static const char wrong[] = "imukit_motion: 1\nsteps:\n  - swing x 5 deg at 1 Hz for 100 s\n"
                                "  - brake 1 m/s^2 for 1 s\n";
    imk_motion_file *file = parsed(swing);
    const imk_trajectory *trajectory = imk_motion_file_motion(file)->trajectory;
    assert_true(trajectory->piece_count > 2000 && trajectory->piece_count < 8000);
    CHECK_OK(imk_trajectory_validate(trajectory, NULL));
    CHECK_CLOSE(imk_motion_file_duration(file), 100, 1e-12);
    imk_motion_file_free(file);
    imk_error error = {.status = IMK_OK};
    file = NULL;
    CHECK_STATUS(imk_motion_parse(wrong, strlen(wrong), NULL, 1, &file, &error), IMK_ERROR_RANGE);
    assert_null(file);
    assert_int_equal(error.line, 4);
    assert_string_equal(error.found, "brake 1 m/s^2 for 1 s");
}

static void examples_of_the_manual_are_read(void **state)
{
    (void)state;
    char *text = manual();
    int count = 0;
    static const char begin[] = "```yaml\nimukit_motion";
    for (char *at = strstr(text, begin); at; at = strstr(at, begin)) {
        at += strlen("```yaml\n");
        char *end = strstr(at, "```");
        assert_non_null(end);
        *end = '\0';
        imk_motion_file_free(parsed(at));
        at = end + 1;
        count++;
    }
    assert_int_equal(count, 3);
    free(text);
}

/* Every text in backquotes of the first column of a table below a heading. */
static int read_table_of(char *text, const char *heading, const char *format)
{
    int count = 0;
    char *at = strstr(text, heading);
    assert_non_null(at);
    char *line = strstr(at, "|---|");
    for (line = strchr(line, '\n') + 1; *line == '|'; line = strchr(line, '\n') + 1) {
        char *column_end = strchr(line + 1, '|');
        for (char *code = strchr(line, '`'); code && code < column_end; code = strchr(code, '`')) {
            char script[512];
            const int length = (int)strcspn(code + 1, "`");
            snprintf(script, sizeof script, format, length, code + 1);
            imk_motion_file_free(parsed(script));
            code += length + 2;
            count++;
        }
    }
    return count;
}

static void tables_of_the_manual_are_read(void **state)
{
    (void)state;
    char *text = manual();
    assert_int_equal(read_table_of(text, "### Steps",
                                   "imukit_motion: 1\nstart: {speed: 10 m/s}\nsteps: [hold 1 s, "
                                   "%.*s]"),
                     19);
    assert_int_equal(read_table_of(text, "### Vibration",
                                   "imukit_motion: 1\nsteps: [hold 1 s]\nvibration: [%.*s]"),
                     5);
    free(text);
}

static void end_is_stop_or_hold(void **state)
{
    (void)state;
    char text[1024];
    snprintf(text, sizeof text, "%sthen: hold\n", car);
    imk_motion_file *file = parsed(text);
    assert_true(isinf(imk_motion_file_duration(file)));
    imk_motion_file_free(file);
    snprintf(text, sizeof text, "%sthen: stop\n", car);
    file = parsed(text);
    CHECK_RELATIVE(imk_motion_file_duration(file), 38, 1e-14);
    imk_motion_file_free(file);
}

static void place_is_the_callers_where_the_script_says_none(void **state)
{
    (void)state;
    static const char text[] = "{\"imukit_motion\": 1, \"start\": {\"height\": \"5 m\"}, "
                               "\"steps\": [\"hold 1 s\"]}";
    const imk_geodetic place = {.latitude = 0.3, .longitude = -1.0, .height = 9};
    imk_motion_file *file = NULL;
    imk_motion_state at;
    CHECK_OK(imk_motion_parse(text, sizeof text - 1, &place, 0, &file, NULL));
    imk_trajectory_state(imk_motion_file_motion(file)->trajectory, 0.5, &at);
    CHECK_CLOSE(at.place.latitude, 0.3, 1e-14);
    CHECK_CLOSE(at.place.longitude, -1.0, 1e-14);
    CHECK_CLOSE(at.place.height, 5, 1e-8);
    imk_motion_file_free(file);
    file = parsed("imukit_motion: 1\nearth: no\nsteps: [hold 1 s]");
    assert_false(imk_motion_file_motion(file)->trajectory->earth);
    imk_motion_file_free(file);
    file = parsed(text);
    imk_trajectory_state(imk_motion_file_motion(file)->trajectory, 0.5, &at);
    CHECK_CLOSE(at.place.latitude, 45 * degree, 1e-14);
    imk_motion_file_free(file);
}

/* ---- vibration ------------------------------------------------------------------------------- */

static void vibration_has_an_amplitude_in_any_derivative(void **state)
{
    (void)state;
    imk_motion_file *file = parsed("imukit_motion: 1\nsteps: [hold 1 s]\nvibration:\n"
                                   "  - sine z 0.5 g at 50 Hz\n"
                                   "  - sine x 0.1 mm at 20 Hz phase 90 deg\n"
                                   "  - sine y 1 mm/s at 20 Hz\n"
                                   "  - sine roll 0.01 deg at 30 Hz\n"
                                   "  - sine pitch 1 deg/s at 30 Hz\n"
                                   "  - sine yaw 2 rad/s^2 at 30 Hz\n");
    const imk_trajectory *trajectory = imk_motion_file_motion(file)->trajectory;
    const double due[6] = {0.5 * gravity / (100 * pi * 100 * pi),
                           1e-4,
                           1e-3 / (40 * pi),
                           0.01 * degree,
                           degree / (60 * pi),
                           2 / (60 * pi * 60 * pi)};
    const int axes[6] = {2, 0, 1, 3, 4, 5};
    assert_int_equal(trajectory->line_count, 6);
    for (int i = 0; i < 6; i++) {
        assert_int_equal(trajectory->line[i].axis, axes[i]);
        CHECK_RELATIVE(trajectory->line[i].amplitude, due[i], rounding);
        CHECK_CLOSE(trajectory->line[i].phase, i == 1 ? 0.25 : 0.0, 1e-16);
    }
    CHECK_CLOSE(trajectory->line[3].frequency, 30, 0);
    imk_motion_file_free(file);
}

/* A displacement a sin(w t) is an acceleration -a w^2 sin(w t): at a quarter of a cycle, 0.5 g up
 * the axis z that points down, on top of gravity. */
static void stated_acceleration_is_felt(void **state)
{
    (void)state;
    imk_motion_file *file =
        parsed("imukit_motion: 1\nsteps: [hold 1 s]\nvibration: [sine z 0.5 g at 50 Hz]\n");
    imk_motion_state rest, peak;
    imk_trajectory_state(imk_motion_file_motion(file)->trajectory, 0.5, &rest);
    imk_trajectory_state(imk_motion_file_motion(file)->trajectory, 0.505, &peak);
    /* Of the 50 um on which gravity changes by 2e-10 m/s^2. */
    CHECK_CLOSE(peak.specific_force.v[2] - rest.specific_force.v[2], -0.5 * gravity, 1e-9);
    imk_motion_file_free(file);
}

static double line_power(const imk_trajectory *trajectory, size_t first, size_t count)
{
    double power = 0.0;
    for (size_t i = first; i < first + count; i++) {
        const double w = 2 * pi * trajectory->line[i].frequency;
        const double acceleration = w * w * trajectory->line[i].amplitude;
        power += 0.5 * acceleration * acceleration;
    }
    return power;
}

/* The lines together have the power of the density: 0.01 g^2/Hz over 1980 Hz; and a triangle in
 * log-log axes of slope +1 from 10 to 20 Hz, whose area is d (20^2 - 10^2)/(2 20). Every
 * line has the power of its part; rounding of some hundred terms. */
static void random_vibration_has_the_power_of_its_density(void **state)
{
    (void)state;
    static const char text[] =
        "imukit_motion: 1\nsteps: [hold 1 s]\nvibration:\n"
        "  - random z 0.01 g^2/Hz from 20 Hz to 2000 Hz\n"
        "  - random: {axis: x, density: [10 Hz 0.5 (m/s^2)^2/Hz, 20 Hz 1 (m/s^2)^2/Hz], lines: "
        "64}\n"
        "  - random: {axis: x, density: [10 Hz 0.5 (m/s^2)^2/Hz, 20 Hz 1 (m/s^2)^2/Hz], lines: "
        "64}\n";
    imk_motion_file *file = parsed(text), *again = parsed(text), *other = NULL;
    const imk_trajectory *trajectory = imk_motion_file_motion(file)->trajectory;
    assert_int_equal(trajectory->line_count, 128 + 64 + 64);
    CHECK_RELATIVE(line_power(trajectory, 0, 128), 0.01 * gravity * gravity * 1980, 1e-12);
    CHECK_RELATIVE(line_power(trajectory, 128, 64), 7.5, 1e-12);
    for (size_t i = 0; i < 128; i++) {
        assert_int_equal(trajectory->line[i].axis, 2);
        assert_true(trajectory->line[i].frequency >= 20 && trajectory->line[i].frequency <= 2000);
    }
    /* The same seed is the same draw, another is another; and so is a second one on an axis. */
    const imk_trajectory *same = imk_motion_file_motion(again)->trajectory;
    for (size_t i = 0; i < 256; i++) {
        CHECK_CLOSE(trajectory->line[i].amplitude, same->line[i].amplitude, 0);
        CHECK_CLOSE(trajectory->line[i].frequency, same->line[i].frequency, 0);
        CHECK_CLOSE(trajectory->line[i].phase, same->line[i].phase, 0);
    }
    CHECK_OK(imk_motion_parse(text, sizeof text - 1, NULL, 2, &other, NULL));
    assert_true(imk_motion_file_motion(other)->trajectory->line[0].phase !=
                trajectory->line[0].phase);
    assert_true(trajectory->line[128].phase != trajectory->line[192].phase);
    imk_motion_file_free(file);
    imk_motion_file_free(again);
    imk_motion_file_free(other);
}

/* ---- refusals -------------------------------------------------------------------------------- */

#define TOO_FAR                                                                                    \
    "the displacement must stay within 10 km along an axis; raise the frequencies or lower the "   \
    "amplitudes"

/* Below imukit_motion: 1, so the first line is line 2. */
static const struct {
    const char *text, *message;
} refusals[] = {
    {"steps: [trun 90 deg at 10 deg/s]",
     "m.yaml:2:9: steps[0]: \"trun\" is not a step; did you mean \"turn\"?"},
    {"steps: [fly]", "m.yaml:2:9: steps[0]: \"fly\" is not a step; expected one of hold, "
                     "accelerate, brake, stop, turn, climb, level, rotate, pose, swing, coning"},
    {"steps: [hold]", "m.yaml:2:9: steps[0]: \"hold\" cannot be read; write hold 10 s"},
    {"steps: [hold 10]",
     "m.yaml:2:14: steps[0]: \"10\" has no unit; expected a unit such as s, ms, min or h"},
    {"steps: [hold -1 s]",
     "m.yaml:2:14: steps[0]: \"-1 s\" is outside its valid range; expected a number above 0"},
    {"steps: [hold 10 m]",
     "m.yaml:2:14: steps[0]: \"10 m\" is a length; expected a time like s, ms, min or h"},
    {"steps: [hold 10 ± 1 s]",
     "m.yaml:2:14: steps[0]: \"10 ± 1 s\" cannot be read; expected a quantity without uncertainty"},
    {"steps: [turn 90 deg]",
     "m.yaml:2:9: steps[0]: \"turn 90 deg\" cannot be read; write turn 90 deg at 10 deg/s, turn "
     "left 90 deg in 10 s or turn to 270 deg at 10 deg/s banked"},
    {"steps: [turn 90 deg with 10 deg/s]",
     "m.yaml:2:9: steps[0]: \"turn 90 deg with 10 deg/s\" cannot be read; write turn 90 deg at 10 "
     "deg/s, turn left 90 deg in 10 s or turn to 270 deg at 10 deg/s banked"},
    {"steps: [turn 90 deg at 10 deg/s fast]",
     "m.yaml:2:33: steps[0]: \"fast\" cannot be read; write turn 90 deg at 10 deg/s, turn left 90 "
     "deg in 10 s or turn to 270 deg at 10 deg/s banked"},
    {"steps: [turn left right 90 deg at 10 deg/s]",
     "m.yaml:2:9: steps[0]: \"turn left right 90 deg at 10 deg/s\" cannot be read; write turn 90 "
     "deg at 10 deg/s, turn left 90 deg in 10 s or turn to 270 deg at 10 deg/s banked"},
    {"steps: [turn left -90 deg at 10 deg/s]",
     "m.yaml:2:19: steps[0]: \"-90 deg\" is outside its valid range; expected a number above 0"},
    {"steps: [turn 90 deg at -10 deg/s]",
     "m.yaml:2:24: steps[0]: \"-10 deg/s\" is outside its valid range; expected a number above 0"},
    {"steps: [turn 90 deg in 0.9 s]", "m.yaml:2:24: steps[0]: \"0.9 s\" is outside its valid "
                                      "range; expected at least twice the smoothing time"},
    {"steps: [turn 90 deg at 10 m/s^2]",
     "m.yaml:2:24: steps[0]: \"10 m/s^2\" is a specific force or acceleration; expected an angular "
     "rate like deg/h, deg/s or rad/s"},
    {"steps: [turn x 90 deg at 10 deg/s]",
     "m.yaml:2:9: steps[0]: \"turn x 90 deg at 10 deg/s\" cannot be read; write turn 90 deg at 10 "
     "deg/s, turn left 90 deg in 10 s or turn to 270 deg at 10 deg/s banked"},
    {"steps: [hold 1 s, 'turn  90 deg  at 10 furlong']",
     "m.yaml:2:37: steps[1]: \"furlong\" is not a known unit; expected a unit such as deg/h, deg/s "
     "or rad/s"},
    {"steps: [climb 90 deg at 10 deg/s]",
     "m.yaml:2:9: steps[0]: \"climb 90 deg at 10 deg/s\" is outside its valid range; expected a "
     "climb angle between -90 deg and 90 deg"},
    {"steps: [accelerate to 20 m/s]",
     "m.yaml:2:9: steps[0]: \"accelerate to 20 m/s\" cannot be read; write accelerate to 20 m/s at "
     "2 m/s^2, accelerate to 20 m/s in 10 s or accelerate 2 m/s^2 for 10 s"},
    {"steps: [accelerate 0 m/s^2 for 5 s]",
     "m.yaml:2:20: steps[0]: \"0 m/s^2\" is outside its valid range; expected a rate other than 0; "
     "for no change, write hold 10 s"},
    {"steps: [brake to 5 m/s at 1 m/s^2]",
     "m.yaml:2:18: steps[0]: \"5 m/s\" is outside its valid range; expected a speed below the "
     "present one; to go faster, write accelerate"},
    {"steps: [brake -5 m/s at 1 m/s^2]",
     "m.yaml:2:15: steps[0]: \"-5 m/s\" is outside its valid range; expected a number above 0"},
    {"steps: [accelerate -5 m/s at 1 m/s^2]",
     "m.yaml:2:9: steps[0]: \"accelerate -5 m/s at 1 m/s^2\" is outside its valid range; expected "
     "a change of speed that brakes at most to rest"},
    {"steps: [rotate 90 deg at 10 deg/s]",
     "m.yaml:2:9: steps[0]: \"rotate 90 deg at 10 deg/s\" cannot be read; write rotate z 360 deg "
     "at 36 deg/s, rotate z 360 deg in 10 s or rotate z at -100 deg/s for 10 s"},
    {"steps: [rotate x y 90 deg at 10 deg/s]",
     "m.yaml:2:9: steps[0]: \"rotate x y 90 deg at 10 deg/s\" cannot be read; write rotate z 360 "
     "deg at 36 deg/s, rotate z 360 deg in 10 s or rotate z at -100 deg/s for 10 s"},
    {"steps: [pose 10 deg in 5 s]",
     "m.yaml:2:14: steps[0]: \"10 deg\" cannot be read; expected three numbers and a unit"},
    {"steps: [swing x 5 deg at 1 Hz]", "m.yaml:2:9: steps[0]: \"swing x 5 deg at 1 Hz\" cannot be "
                                       "read; write swing x 5 deg at 1 Hz for 20 s"},
    {"steps: [coning x 200 deg at 1 Hz for 5 s]",
     "m.yaml:2:9: steps[0]: \"coning x 200 deg at 1 Hz for 5 s\" is outside its valid range; "
     "expected at most 180 deg"},
    {"steps: [hold 4 s, pose 180 45 0 deg in 1e-320 s, hold 4 s]",
     "m.yaml:2:19: steps[1]: \"pose 180 45 0 deg in 1e-320 s\" is outside its valid range; "
     "expected a duration from 1 us to 1e9 s"},
    {"steps: [hold 1e9 s, pose 180 45 0 deg in 1 us]",
     "m.yaml:2:21: steps[1]: \"pose 180 45 0 deg in 1 us\" is outside its valid range; expected a "
     "longer step: this one is lost in the rounding of the time so far"},
    {"steps: [hold 1 s]\nvibration: [sine roll 0.11 rad at 30 Hz]",
     "m.yaml:3:23: vibration[0]: \"0.11 rad\" is outside its valid range; expected a rotation "
     "below "
     "0.1 rad; write a step swing for larger ones"},
    {"steps: []",
     "m.yaml:2:8: steps: \"[]\" cannot be read; expected at least one step, such as hold 10 s"},
    {"steps: hold 10 s",
     "m.yaml:2:8: steps: \"hold 10 s\" cannot be read; expected a list of steps: [hold 10 s, …]"},
    {"steps: [level at 1 deg/s]", "m.yaml:2:8: steps: the steps do not change anything; expected "
                                  "at least one step that takes time"},
    {"steps: [[hold 1 s]]",
     "m.yaml:2:9: steps[0]: the text cannot be read; expected a step such as hold 10 s"},
    {"steps: [{repeat: {times: 0, steps: [hold 1 s]}}]",
     "m.yaml:2:26: steps[0].repeat.times: \"0\" cannot be read; expected a whole number of times, "
     "from 1 to 100000"},
    {"steps: [{repeat: {times: 2.5, steps: [hold 1 s]}}]",
     "m.yaml:2:26: steps[0].repeat.times: \"2.5\" cannot be read; expected a whole number of "
     "times, from 1 to 100000"},
    {"steps: [{repeat: {times: 2}}]", "m.yaml:2:18: steps[0].repeat: \"steps\" is missing; "
                                      "expected a mapping: {times: 3, steps: [hold 1 s, …]}"},
    {"steps: [{repeat: 3}]", "m.yaml:2:18: steps[0].repeat: \"3\" cannot be read; expected a "
                             "mapping: {times: 3, steps: [hold 1 s, …]}"},
    {"steps: [{repeats: {times: 2, steps: [hold 1 s]}}]",
     "m.yaml:2:10: steps[0].repeats: \"repeats\" is not a known key; did you mean \"repeat\"?"},
    {"steps: [{repeat: {times: 1000, steps: [{repeat: {times: 1000, steps: [level at 1 "
     "deg/s]}}]}}]",
     "m.yaml:2:71: steps[0].repeat.steps[0].repeat.steps[0]: the file has too many steps; expected "
     "at most 100000 steps, with every repetition counted"},
    {"name: x", "m.yaml:1:1: \"steps\" is missing; expected a list of steps: [hold 10 s, …]"},
    {"step: [hold 1 s]", "m.yaml:2:1: step: \"step\" is not a known key; did you mean \"steps\"?"},
    {"start: {lattitude: 45 deg}\nsteps: [hold 1 s]",
     "m.yaml:2:9: start.lattitude: \"lattitude\" is not a known key; did you mean \"latitude\"?"},
    {"start: {latitude: 45}\nsteps: [hold 1 s]",
     "m.yaml:2:19: start.latitude: \"45\" has no unit; expected a unit such as deg, mrad, urad or "
     "arcsec"},
    {"start: {latitude: 95 deg}\nsteps: [hold 1 s]",
     "m.yaml:2:19: start.latitude: \"95 deg\" is outside its valid range; expected a latitude "
     "within 90 deg"},
    {"start: {speed: -5 m/s}\nsteps: [hold 1 s]",
     "m.yaml:2:16: start.speed: \"-5 m/s\" is outside its valid range; expected a speed between 0 "
     "and 100 km/s"},
    {"start: 45 deg\nsteps: [hold 1 s]",
     "m.yaml:2:8: start: \"45 deg\" cannot be read; expected a mapping: {key: value, …}"},
    {"mounting: {yaw: 1 m}\nsteps: [hold 1 s]", "m.yaml:2:17: mounting.yaw: \"1 m\" is a length; "
                                                "expected an angle like deg, mrad, urad or arcsec"},
    {"smoothing: 0 s\nsteps: [hold 1 s]", "m.yaml:2:12: smoothing: \"0 s\" is outside its valid "
                                          "range; expected a time from 1 ms to 1000 s"},
    {"earth: maybe\nsteps: [hold 1 s]",
     "m.yaml:2:8: earth: \"maybe\" cannot be read; expected \"yes\" or \"no\""},
    {"then: go\nsteps: [hold 1 s]",
     "m.yaml:2:7: then: \"go\" cannot be read; expected \"stop\" or \"hold\""},
    {"then: hold\nsteps: [accelerate to 3 m/s at 1 m/s^2]",
     "m.yaml:2:7: then: the body is not at rest after the last step; add a last step such as stop "
     "at 3 m/s^2, or write then: stop"},
    {"steps: [hold 1 s]\nvibration: [sine z 0.5 g]",
     "m.yaml:3:13: vibration[0]: \"sine z 0.5 g\" cannot be read; write sine z 0.5 g at 50 Hz, "
     "sine y 0.1 mm at 50 Hz phase 90 deg or sine roll 0.01 deg at 30 Hz"},
    {"steps: [hold 1 s]\nvibration: [sine z 0.5 s at 5 Hz]",
     "m.yaml:3:20: vibration[0]: \"0.5 s\" is a time; expected a specific force or acceleration "
     "like mg, ug, g or m/s^2"},
    {"steps: [hold 1 s]\nvibration: [sine z 0.5 g at 0 Hz]",
     "m.yaml:3:29: vibration[0]: \"0 Hz\" is outside its valid range; expected a number above 0"},
    {"steps: [hold 1 s]\nvibration: [sine z 2 m/s^2 at 1e-9 Hz]",
     "m.yaml:3:31: vibration[0]: \"1e-9 Hz\" is outside its valid range; expected a frequency from "
     "1e-6 Hz to 1e9 Hz"},
    {"steps: [hold 1 s]\nvibration: [sine z 1 m at 1e12 Hz]",
     "m.yaml:3:27: vibration[0]: \"1e12 Hz\" is outside its valid range; expected a frequency from "
     "1e-6 Hz to 1e9 Hz"},
    {"steps: [hold 1 s]\nvibration: [sine z 1e200 m/s^2 at 1 Hz]",
     "m.yaml:3:13: vibration[0]: " TOO_FAR},
    {"steps: [hold 1 s]\nvibration: [sine z 1e300 m/s^2 at 100 Hz]",
     "m.yaml:3:13: vibration[0]: " TOO_FAR},
    {"steps: [hold 1 s]\nvibration: [sine z 8 km at 1 Hz, sine x 8 km at 1 Hz, sine z 3 km at 2 "
     "Hz]",
     "m.yaml:3:55: vibration[2]: " TOO_FAR},
    {"steps: [hold 1 s]\nvibration: [random z 1e90 g^2/Hz from 1 Hz to 2 Hz]",
     "m.yaml:3:13: vibration[0]: " TOO_FAR},
    {"steps: [hold 1 s]\nvibration: [sine roll 10 deg at 1 Hz]",
     "m.yaml:3:23: vibration[0]: \"10 deg\" is outside its valid range; expected a rotation below "
     "0.1 rad; write a step swing for larger ones"},
    {"steps: [hold 1 s]\nvibration: [random roll 1 g^2/Hz from 1 Hz to 2 Hz]",
     "m.yaml:3:13: vibration[0]: \"random roll 1 g^2/Hz from 1 Hz to 2 Hz\" cannot be read; write "
     "random z 0.01 g^2/Hz from 20 Hz to 2000 Hz, or random: {axis: z, density: [20 Hz 0.01 "
     "g^2/Hz, …]}"},
    {"steps: [hold 1 s]\nvibration: [random z 1 g^2/Hz from 2 Hz to 1 Hz]",
     "m.yaml:3:13: vibration[0]: the frequencies do not rise; put the lower frequency first"},
    {"steps: [hold 1 s]\nvibration: [random z 1 g/sqrt(Hz) from 1 Hz to 2 Hz]",
     "m.yaml:3:22: vibration[0]: \"1 g/sqrt(Hz)\" is a white-noise density of specific force "
     "(velocity random walk); expected a power spectral density of specific force like ug^2/Hz or "
     "(m/s^2)^2/Hz"},
    {"steps: [hold 1 s]\nvibration: [noise z 1 g^2/Hz from 1 Hz to 2 Hz]",
     "m.yaml:3:13: vibration[0]: \"noise\" is not a vibration; expected one of sine, random"},
    {"steps: [hold 1 s]\nvibration: [random: {axis: w, density: [1 Hz 1 g^2/Hz, 2 Hz 1 g^2/Hz]}]",
     "m.yaml:3:28: vibration[0].random.axis: \"w\" cannot be read; expected one of the axes x, y, "
     "z"},
    {"steps: [hold 1 s]\nvibration: [random: {axis: z, density: [1 Hz 1 g^2/Hz]}]",
     "m.yaml:3:40: vibration[0].random.density: the text cannot be read; expected a list of 2 to "
     "64 corners: [20 Hz 0.01 g^2/Hz, 2000 Hz 0.01 g^2/Hz]"},
    {"steps: [hold 1 s]\nvibration: [random: {axis: z, density: [1 Hz, 2 Hz 1 g^2/Hz]}]",
     "m.yaml:3:41: vibration[0].random.density[0]: \"1 Hz\" cannot be read; expected a frequency "
     "and a density, such as 20 Hz 0.01 g^2/Hz"},
    {"steps: [hold 1 s]\nvibration: [random: {axis: z, density: [1 Hz 1 g, 2 Hz 1 g^2/Hz]}]",
     "m.yaml:3:41: vibration[0].random.density[0]: \"1 g\" is a specific force or acceleration; "
     "expected a power spectral density of specific force like ug^2/Hz or (m/s^2)^2/Hz"},
    {"steps: [hold 1 s]\nvibration: [random: {axis: z}]",
     "m.yaml:3:21: vibration[0].random: \"density\" is missing; expected a mapping: {axis: z, "
     "density: [20 Hz 0.01 g^2/Hz, 2000 Hz 0.01 g^2/Hz]}"},
    {"steps: [hold 1 s]\nvibration: [random: {axis: z, density: [1 Hz 1 g^2/Hz, 2 Hz 1 g^2/Hz], "
     "lines: 4}]",
     "m.yaml:3:79: vibration[0].random.lines: \"4\" cannot be read; expected a whole number of "
     "lines, from 8 to 512"},
    {"steps: [hold 1 s]\nvibration: [random: {axis: z, density: [1 Hz 1 g^2/Hz, 2 Hz 1 g^2/Hz], "
     "lines: 400}, random z 1 g^2/Hz from 1 Hz to 2 Hz]",
     "m.yaml:3:85: vibration[1]: the file has too many vibration lines; expected at most 512 lines "
     "in all; give the random vibrations fewer lines"},
    {"steps: &x [hold 1 s]", "m.yaml:2:8: this is not supported: an anchor (&); write every value "
                             "out: motion files have no anchors and aliases"},
    {"steps: [hold 1 s]\nsteps: [hold 1 s]",
     "m.yaml:3:1: steps: \"steps\" is given twice; the first one is in line 2"},
};

static void refusals_say_what_is_due(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(refusals); i++) {
        char text[512], message[512];
        imk_error error;
        imk_motion_file *file = NULL;
        snprintf(text, sizeof text, "imukit_motion: 1\n%s\n", refusals[i].text);
        const imk_status status = imk_motion_parse(text, strlen(text), NULL, 0, &file, &error);
        assert_null(file);
        if (status == IMK_OK)
            fail_msg("%s is taken", refusals[i].text);
        assert_int_equal(error.status, status);
        imk_error_text(&error, "m.yaml", message, sizeof message);
        assert_string_equal(message, refusals[i].message);
        CHECK_STATUS(imk_motion_parse(text, strlen(text), NULL, 0, &file, NULL), status);
    }
}

static void what_is_no_script_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"", "m.yaml: there is no data; expected a motion, beginning with imukit_motion: 1"},
        {"- hold 1 s\n", "m.yaml:1:1: the file format is not recognised; expected a motion file: "
                         "keys and values, beginning with imukit_motion: 1"},
        {"steps: [hold 1 s]\n", "m.yaml:1:1: a required key is missing; write imukit_motion: 1, "
                                "the version of the format"},
        {"imukit_motion: 2\nsteps: [hold 1 s]\n",
         "m.yaml:1:16: imukit_motion: \"2\" is not a supported version; version 1 of the format"},
        {"imukit: 1\ngyro: {}\n",
         "m.yaml:1:1: imukit: \"imukit\" is not a known key; expected one of imukit_motion, name, "
         "start, mounting, smoothing, earth, steps, vibration, then"}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        imk_motion_file *file = NULL;
        imk_error error;
        char message[512];
        assert_true(imk_motion_parse(cases[i].text, strlen(cases[i].text), NULL, 0, &file,
                                     &error) != IMK_OK);
        imk_error_text(&error, "m.yaml", message, sizeof message);
        assert_string_equal(message, cases[i].message);
    }
}

static void script_is_read_from_a_file(void **state)
{
    (void)state;
    char path[80];
    snprintf(path, sizeof path, "/tmp/imukit_motion_%ld.yaml", (long)getpid());
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fputs(car, file);
    fclose(file);
    imk_motion_file *motion = NULL;
    CHECK_OK(imk_motion_read(path, NULL, NULL, 0, &motion, NULL));
    assert_string_equal(imk_motion_file_name(motion), "car");
    imk_motion_file_free(motion);
    remove(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(words_become_steps),
        cmocka_unit_test(pose_has_three_angles),
        cmocka_unit_test(repeats_are_written_out),
        cmocka_unit_test(script_is_compiled),
        cmocka_unit_test(long_scripts_are_compiled_whole),
        cmocka_unit_test(examples_of_the_manual_are_read),
        cmocka_unit_test(tables_of_the_manual_are_read),
        cmocka_unit_test(end_is_stop_or_hold),
        cmocka_unit_test(place_is_the_callers_where_the_script_says_none),
        cmocka_unit_test(vibration_has_an_amplitude_in_any_derivative),
        cmocka_unit_test(stated_acceleration_is_felt),
        cmocka_unit_test(random_vibration_has_the_power_of_its_density),
        cmocka_unit_test(refusals_say_what_is_due),
        cmocka_unit_test(what_is_no_script_is_refused),
        cmocka_unit_test(script_is_read_from_a_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
