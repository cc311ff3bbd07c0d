/* SPDX-License-Identifier: Apache-2.0 */
/* The message of every status: with what was found, with numbers, and with nothing but the
 * status. */
#include "imukit/io.h"

#include "check.h"

#include <stdio.h>
#include <string.h>

static void check_text(const imk_error *error, const char *source, const char *expected)
{
    char text[512];
    const size_t length = imk_error_text(error, source, text, sizeof text);
    assert_string_equal(text, expected);
    assert_int_equal(length, strlen(expected));
}

static imk_error error_of(imk_status status, const char *field, const char *found,
                          const char *expected)
{
    imk_error error;
    imk_error_set(&error, status, field, found, expected);
    return error;
}

/* One line per status, all of them: what it says about a found "X y", and about nothing. */
typedef struct message_of_status {
    imk_status status;
    const char *with_found, *alone;
} message_of_status;

static const message_of_status messages[] = {
    {IMK_OK, "done: X y", "done"},
    {IMK_ERROR_ARGUMENT, "an argument is not valid: X y", "an argument is not valid"},
    {IMK_ERROR_NOT_FINITE, "\"X y\" is not finite", "a number is not finite"},
    {IMK_ERROR_RANGE, "\"X y\" is outside its valid range", "a number is outside its valid range"},
    {IMK_ERROR_SYNTAX, "\"X y\" cannot be read", "the text cannot be read"},
    {IMK_ERROR_UNIT_MISSING, "\"X y\" has no unit", "a number has no unit"},
    {IMK_ERROR_UNIT_UNKNOWN, "\"X y\" is not a known unit", "the unit is not known"},
    {IMK_ERROR_DIMENSION, "\"X y\" has the wrong dimension", "the unit has the wrong dimension"},
    {IMK_ERROR_KEY_UNKNOWN, "\"X y\" is not a known key", "the key is not known"},
    {IMK_ERROR_KEY_DUPLICATE, "\"X y\" is given twice", "the key is given twice"},
    {IMK_ERROR_KEY_MISSING, "\"X y\" is missing", "a required key is missing"},
    {IMK_ERROR_CONFLICT, "two settings exclude each other: X y", "two settings exclude each other"},
    {IMK_ERROR_VERSION, "\"X y\" is not a supported version",
     "the format version is not supported"},
    {IMK_ERROR_UNINITIALISED, "the structure was not initialised by its _default function: X y",
     "the structure was not initialised by its _default function"},
    {IMK_ERROR_WORKSPACE, "the workspace is too small: X y", "the workspace is too small"},
    {IMK_ERROR_MEMORY, "memory is exhausted: X y", "memory is exhausted"},
    {IMK_ERROR_SINGULAR, "the matrix is singular or not positive definite: X y",
     "the matrix is singular or not positive definite"},
    {IMK_ERROR_NO_CONVERGENCE, "the iteration did not converge: X y",
     "the iteration did not converge"},
    {IMK_ERROR_TOO_SHORT, "there are too few samples: X y", "there are too few samples"},
    {IMK_ERROR_CONSTANT, "the channel is constant: X y", "the channel is constant"},
    {IMK_ERROR_TIME_ORDER, "time does not increase: X y", "time does not increase"},
    {IMK_ERROR_GAP, "samples are missing: X y", "samples are missing"},
    {IMK_ERROR_EMPTY, "there is no data: X y", "there is no data"},
    {IMK_ERROR_OPEN, "the file cannot be opened: X y", "the file cannot be opened"},
    {IMK_ERROR_READ, "the file cannot be read: X y", "the file cannot be read"},
    {IMK_ERROR_WRITE, "the file cannot be written: X y", "the file cannot be written"},
    {IMK_ERROR_FORMAT, "the file format is not recognised: X y",
     "the file format is not recognised"},
    {IMK_ERROR_COMPRESSED, "the compressed data is damaged or cut short: X y",
     "the compressed data is damaged or cut short"},
    {IMK_ERROR_COLUMN, "a column is missing, unknown or duplicated: X y",
     "a column is missing, unknown or duplicated"},
    {IMK_ERROR_RATE_MISSING, "the sampling rate is not known: X y",
     "the sampling rate is not known"},
    {IMK_ERROR_UNSUPPORTED, "this is not supported: X y", "this is not supported"},
    {IMK_ERROR_NAME_UNKNOWN, "\"X y\" is not a known name", "the name is not known"},
    {IMK_ERROR_CANCELLED, "the work was cancelled: X y", "the work was cancelled"},
};

static void every_status(void **state)
{
    (void)state;
    static const imk_status all[] = {
#define STATUS(name, value, text) name,
        IMK_STATUS_LIST(STATUS)
#undef STATUS
    };
    const size_t count = sizeof messages / sizeof messages[0];
    assert_int_equal(count, sizeof all / sizeof all[0]);
    for (size_t i = 0; i < count; i++) {
        assert_int_equal(messages[i].status, all[i]);
        char expected[256];
        imk_error error = error_of(all[i], "gyro.bias", "X y", "a thing");
        snprintf(expected, sizeof expected, "a.yaml: gyro.bias: %s; expected a thing",
                 messages[i].with_found);
        check_text(&error, "a.yaml", expected);
        error = error_of(all[i], "", NULL, NULL);
        check_text(&error, NULL, messages[i].alone);
    }
}

static void place(void **state)
{
    (void)state;
    imk_error error =
        error_of(IMK_ERROR_DIMENSION, "gyro.angle_random_walk", "\"0.1 deg/h\" is a rate",
                 "expected a unit like deg/sqrt(h) or rad/s/sqrt(Hz)");
    error.line = 7;
    error.column = 3;
    /* the example of the design document */
    check_text(&error, "tactical.yaml",
               "tactical.yaml:7:3: gyro.angle_random_walk: \"0.1 deg/h\" is a rate; "
               "expected a unit like deg/sqrt(h) or rad/s/sqrt(Hz)");
    check_text(&error, "-",
               "standard input:7:3: gyro.angle_random_walk: \"0.1 deg/h\" is a rate; "
               "expected a unit like deg/sqrt(h) or rad/s/sqrt(Hz)");
    check_text(&error, NULL,
               "line 7, column 3: gyro.angle_random_walk: \"0.1 deg/h\" is a rate; "
               "expected a unit like deg/sqrt(h) or rad/s/sqrt(Hz)");
    error = error_of(IMK_ERROR_EMPTY, "", NULL, NULL);
    error.line = 12;
    check_text(&error, "a.csv", "a.csv:12: there is no data");
    check_text(&error, NULL, "line 12: there is no data");
}

/* A file is named once, however long its name. */
static void field_that_is_the_source(void **state)
{
    (void)state;
    imk_error error = error_of(IMK_ERROR_OPEN, "a.csv", "Permission denied", "");
    check_text(&error, "a.csv", "a.csv: the file cannot be opened: Permission denied");
    check_text(&error, NULL, "a.csv: the file cannot be opened: Permission denied");
    check_text(&error, "b.csv", "b.csv: a.csv: the file cannot be opened: Permission denied");
    error = error_of(IMK_ERROR_READ, "standard input", "Is a directory", "");
    check_text(&error, "-", "standard input: the file cannot be read: Is a directory");
    char path[201], expected[300];
    memset(path, 'p', 200);
    path[200] = '\0';
    error = error_of(IMK_ERROR_EMPTY, path, "", "");
    snprintf(expected, sizeof expected, "%s: there is no data", path);
    check_text(&error, path, expected);
}

static void index_is_an_axis_a_row_or_an_element(void **state)
{
    (void)state;
    imk_error error = error_of(IMK_ERROR_RANGE, "gyro.bias.fixed", "", "");
    static const char *const expected[] = {
        "gyro.bias.fixed, axis x: a number is outside its valid range",
        "gyro.bias.fixed, axis y: a number is outside its valid range",
        "gyro.bias.fixed, axis z: a number is outside its valid range",
        "gyro.bias.fixed[3]: a number is outside its valid range",
    };
    for (error.index = 0; error.index < 4; error.index++)
        check_text(&error, NULL, expected[error.index]);
    error = error_of(IMK_ERROR_RANGE, "tau", "", "");
    error.index = 17;
    check_text(&error, NULL, "tau[17]: a number is outside its valid range");
    error = error_of(IMK_ERROR_TIME_ORDER, "time", "", "");
    error.index = 1200;
    check_text(&error, "a.csv", "a.csv: time, row 1200: time does not increase");
    error = error_of(IMK_ERROR_GAP, "", "", "");
    error.index = 5;
    check_text(&error, "a.csv", "a.csv: row 5: samples are missing");
    error = error_of(IMK_ERROR_NOT_FINITE, "", "", "");
    error.index = 0;
    check_text(&error, NULL, "element 0: a number is not finite");
}

static imk_error numbers(imk_status status, double value, double limit)
{
    imk_error error = error_of(status, "", "", "");
    error.value = value;
    error.limit = limit;
    return error;
}

static void numbers_when_nothing_was_found(void **state)
{
    (void)state;
    imk_error error = numbers(IMK_ERROR_RANGE, -3.0, 0.0);
    check_text(&error, NULL, "-3 is outside its valid range");
    error = numbers(IMK_ERROR_RANGE, 1.0 / 3.0, 0.25);
    check_text(&error, NULL, "0.333333 is outside its valid range (limit 0.25)");
    /* six digits would say that 1 is above the limit 1 */
    error = numbers(IMK_ERROR_RANGE, 1.0000000001, 1.0);
    check_text(&error, NULL, "1.0000000001 is outside its valid range (limit 1)");
    error = numbers(IMK_ERROR_NOT_FINITE, (double)NAN, 0.0);
    check_text(&error, NULL, "nan is not finite");
    error = numbers(IMK_ERROR_NOT_FINITE, (double)-INFINITY, 0.0);
    check_text(&error, NULL, "-inf is not finite");
    error = numbers(IMK_ERROR_TOO_SHORT, 100.0, 256.0);
    check_text(&error, NULL, "100 samples are too few (needed: 256)");
    error = numbers(IMK_ERROR_WORKSPACE, 100.0, 4096.0);
    check_text(&error, NULL, "100 bytes of workspace are too few (needed: 4096)");
    error = numbers(IMK_ERROR_UNIT_MISSING, 0.1, 0.0);
    check_text(&error, NULL, "0.1 has no unit");
    error = numbers(IMK_ERROR_VERSION, 2.0, 1.0);
    check_text(&error, NULL, "2 is not a supported version");
    error = numbers(IMK_ERROR_CONSTANT, 5.0, 0.0);
    check_text(&error, NULL, "the channel is constant (5)");
    error = numbers(IMK_ERROR_TIME_ORDER, 3.25, 3.5);
    check_text(&error, NULL, "time does not increase (3.25, limit 3.5)");
}

static void found_that_is_a_clause(void **state)
{
    (void)state;
    imk_error error = error_of(IMK_ERROR_UNSUPPORTED, "plot", "gnuplot is not installed",
                               "install it: apt install gnuplot-nox");
    check_text(&error, NULL, "plot: gnuplot is not installed; install it: apt install gnuplot-nox");
    error = error_of(IMK_ERROR_CONFLICT, "gyro.noise",
                     "bias_instability and allan_floor exclude each other", "keep one of them");
    check_text(&error, NULL,
               "gyro.noise: bias_instability and allan_floor exclude each other; keep one of them");
    error =
        error_of(IMK_ERROR_SYNTAX, "", "it is not", ""); /* quoted all the same: it stood there */
    check_text(&error, NULL, "\"it is not\" cannot be read");
}

static void remedies(void **state)
{
    (void)state;
    static const char *const given[] = {
        "a positive number",    "an angular rate",  "0 to 8 terms",
        "at least 256 samples", "add --rate 100Hz", "did you mean deg/h?",
        "expected 3 numbers",   "one of them",      "dt > 0",
        "save it as float64",
    };
    static const char *const said[] = {
        "expected a positive number",
        "expected an angular rate",
        "expected 0 to 8 terms",
        "expected at least 256 samples",
        "add --rate 100Hz",
        "did you mean deg/h?",
        "expected 3 numbers",
        "expected one of them",
        "dt > 0",
        "save it as float64",
    };
    for (size_t i = 0; i < sizeof given / sizeof given[0]; i++) {
        char expected[128];
        imk_error error = error_of(IMK_ERROR_UNIT_UNKNOWN, "", "x", given[i]);
        snprintf(expected, sizeof expected, "\"x\" is not a known unit; %s", said[i]);
        check_text(&error, NULL, expected);
    }
    imk_error error = error_of(IMK_ERROR_UNIT_UNKNOWN, "", "degh", "deg/h");
    check_text(&error, NULL, "\"degh\" is not a known unit; did you mean deg/h?");
    error = error_of(IMK_ERROR_KEY_UNKNOWN, "", "bias_instabilty", "bias_instability");
    check_text(&error, NULL,
               "\"bias_instabilty\" is not a known key; did you mean bias_instability?");
    error = error_of(IMK_ERROR_NAME_UNKNOWN, "", "navigaton", "navigation");
    check_text(&error, NULL, "\"navigaton\" is not a known name; did you mean navigation?");
    /* A sentence about names is not quoted as a name. */
    error = error_of(IMK_ERROR_NAME_UNKNOWN, "", "the log holds 2 sensors", "add --topic a (or b)");
    check_text(&error, NULL, "the log holds 2 sensors; add --topic a (or b)");
    error = error_of(IMK_ERROR_RANGE, "", "x", "positive"); /* no name: no question */
    check_text(&error, NULL, "\"x\" is outside its valid range; positive");
}

/* Text from a file must not command the terminal. */
static void control_characters(void **state)
{
    (void)state;
    imk_error error = error_of(IMK_ERROR_SYNTAX, "",
                               "a\x1B[31mb\nc\x7F\xC2\x9B"
                               "d",
                               "");
    check_text(&error, NULL, "\"a?[31mb?c???d\" cannot be read");
    error = error_of(IMK_ERROR_SYNTAX, "", "\xFF\xC3 \xE2\x88\x9A \xF0\x9F\x98\x80 \xC0\x80", "");
    check_text(&error, NULL, "\"?? \xE2\x88\x9A \xF0\x9F\x98\x80 ??\" cannot be read");
}

/* Every size gives a beginning of the text, cut between characters, with its terminating zero. */
static void shortened(void **state)
{
    (void)state;
    const imk_error error = error_of(IMK_ERROR_UNIT_UNKNOWN, "gyro", "deg/\xE2\x88\x9Ah", "deg/h");
    char whole[256];
    const size_t length = imk_error_text(&error, "a", whole, sizeof whole);
    for (size_t size = 1; size <= length + 1; size++) {
        char text[256];
        memset(text, 'x', sizeof text);
        const size_t got = imk_error_text(&error, "a", text, size);
        assert_true(got < size && got + 3 >= size); /* at most one character of 3 bytes is lost */
        assert_int_equal(text[got], '\0');
        assert_memory_equal(text, whole, got);
        assert_int_equal(text[size], 'x');
        assert_false(((unsigned char)whole[got] & 0xC0) == 0x80);
    }
    char byte = 'x';
    assert_int_equal(imk_error_text(&error, "a", &byte, 0), 0);
    assert_int_equal(byte, 'x');
}

/* The middle of a long path is left out, and it is not said twice either. */
static void long_path(void **state)
{
    (void)state;
    char path[200], message[500];
    imk_error error;
    memset(path, 'a', sizeof path);
    strcpy(path + sizeof path - 9, "/end.csv");
    imk_error_set(&error, IMK_ERROR_OPEN, path, "", "");
    imk_error_text(&error, path, message, sizeof message);
    assert_string_equal(message + strlen(path), ": the file cannot be opened");
    imk_error_text(&error, NULL, message, sizeof message);
    assert_non_null(strstr(message, "aaa\xE2\x80\xA6"
                                    "aaa"));
    assert_non_null(strstr(message, "aaa/end.csv: the file cannot be opened"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_status),
        cmocka_unit_test(place),
        cmocka_unit_test(field_that_is_the_source),
        cmocka_unit_test(index_is_an_axis_a_row_or_an_element),
        cmocka_unit_test(numbers_when_nothing_was_found),
        cmocka_unit_test(found_that_is_a_clause),
        cmocka_unit_test(remedies),
        cmocka_unit_test(control_characters),
        cmocka_unit_test(shortened),
        cmocka_unit_test(long_path),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
