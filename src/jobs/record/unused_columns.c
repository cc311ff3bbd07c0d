/* SPDX-License-Identifier: Apache-2.0 */
/* Columns that nothing reads although they resemble those of a sensor: "gryo_y", "-mag_y",
 * "gyro y", "accel_z_raw". A name is taken apart into words at signs, capitals and figures. It
 * resembles a sensor's if a word is the sensor's, give or take a slip, another is an axis, and none
 * says that it is about something else, such as the standard deviation of readings. A unit of
 * another dimension rules a sensor out. Of a sensor that is not read at all, the unit and an axis
 * will do: three columns such as "Drehrate_x [deg/s]", "roll_rate_dps", "p [rad/s]". */
#include "even_record_internal.h"

#include "base/text_internal.h"
#include "jobs/job_internal.h"

#include "imukit/model.h"
#include "imukit/names.h"

#include <stdio.h>
#include <string.h>

enum { WORDS_MOST = 12, WORD_SIZE = 48 };

typedef struct words {
    size_t count;
    char word[WORDS_MOST][WORD_SIZE];
} words;

static const struct {
    const char *name;
    imk_quantity quantity;
    const char *unit, *integral; /* that readings and increments may have */
} sensors[IMK_KINDS] = {{"gyro", IMK_QUANTITY_ANGULAR_RATE, "rad/s", "rad"},
                        {"accel", IMK_QUANTITY_SPECIFIC_FORCE, "m/s^2", "m/s"},
                        {"mag", IMK_QUANTITY_MAGNETIC, "T", "T"}};

/* Words of sensors, in full. */
static const struct {
    const char *word;
    int sensor;
} known[] = {{"gyr", IMK_GYRO},     {"omega", IMK_GYRO},  {"dtheta", IMK_GYRO}, {"w", IMK_GYRO},
             {"g", IMK_GYRO},       {"acc", IMK_ACCEL},   {"dvel", IMK_ACCEL},  {"a", IMK_ACCEL},
             {"g", IMK_ACCEL},      {"force", IMK_ACCEL}, {"mag", IMK_MAG},     {"magn", IMK_MAG},
             {"magnetic", IMK_MAG}, {"m", IMK_MAG}};

/* Words that may have a slip. */
static const char *const spelled[] = {"gyro",          "gyros",        "gyroscope",   "accel",
                                      "accelerometer", "acceleration", "magnetometer"};
static const int sensor_spelled[] = {IMK_GYRO,  IMK_GYRO,  IMK_GYRO, IMK_ACCEL,
                                     IMK_ACCEL, IMK_ACCEL, IMK_MAG};

/* With one of these it is no reading. */
static const char *const others[] = {
    "std",      "sigma", "var",       "variance",   "cov",         "covariance",  "bias",
    "offset",   "scale", "range",     "temp",       "temperature", "status",      "state",
    "label",    "flag",  "flags",     "valid",      "count",       "counter",     "samples",
    "time",     "stamp", "timestamp", "reference",  "ref",         "true",        "truth",
    "table",    "error", "err",       "quaternion", "quat",        "orientation", "angle",
    "position", "pos",   "noise",     "residual",   "gravity",     "setpoint",    "target"};

/* With one of these an acceleration has lost its gravity: no reading of an accelerometer. */
static const char *const gravity_free[] = {"free", "user", "linear", "lin", "grav"};

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/* "-gyroX [deg/s]" is gyro, x. */
static void divide(const char *name, words *w)
{
    size_t length = 0;
    char last = '\0';
    w->count = 0;
    for (const char *c = name; *c && w->count < WORDS_MOST; c++) {
        const bool letter = is_letter(*c), figure = *c >= '0' && *c <= '9';
        const bool turn = *c >= 'A' && *c <= 'Z' && last >= 'a' && last <= 'z';
        if (length > 0 && (!(letter || figure) || turn || figure == is_letter(last))) {
            w->word[w->count++][length] = '\0';
            length = 0;
        }
        if ((letter || figure) && w->count < WORDS_MOST && length + 1 < WORD_SIZE)
            w->word[w->count][length++] = imki_lower(*c);
        last = letter || figure ? *c : '\0';
    }
    if (length > 0 && w->count < WORDS_MOST)
        w->word[w->count++][length] = '\0';
}

/* The axis that a word is: 0 … 7; -1: none. */
static int axis_of(const char *word)
{
    if (!word[0] || word[1])
        return -1;
    return word[0] >= 'x' && word[0] <= 'z'   ? word[0] - 'x'
           : word[0] >= '0' && word[0] <= '7' ? word[0] - '0'
                                              : -1;
}

static bool fits(const imk_log_column *column, int sensor)
{
    const imk_dimension d = column->unit.dimension, none = {0};
    return imk_dimension_equal(d, none) || imk_dimension_equal(d, imk_unit_of("count").dimension) ||
           imk_dimension_equal(d, imk_unit_of(sensors[sensor].unit).dimension) ||
           imk_dimension_equal(d, imk_unit_of(sensors[sensor].integral).dimension);
}

/* The sensor of a word; -1: it is none.
 * @param short_too  one letter will do: only an axis stands beside it, as in "wx" */
static int sensor_of(const imk_log_column *column, const char *word, bool short_too)
{
    for (size_t k = 0; k < sizeof known / sizeof known[0]; k++)
        if (strcmp(word, known[k].word) == 0 && (word[1] || short_too) &&
            fits(column, known[k].sensor))
            return known[k].sensor;
    const size_t k = strlen(word) > 2
                         ? imk_nearest_name(word, sizeof spelled / sizeof spelled[0], spelled)
                         : SIZE_MAX;
    return k < sizeof spelled / sizeof spelled[0] && fits(column, sensor_spelled[k])
               ? sensor_spelled[k]
               : -1;
}

/* A word with its axis in front or behind: "accelx", "zgyro", "wy". */
static int joined(const imk_log_column *column, const char *word, bool short_too, int *axis)
{
    const size_t length = strlen(word);
    char rest[WORD_SIZE];
    for (int front = 0; front < 2 && length > 1; front++) {
        const char letter[2] = {front ? word[0] : word[length - 1], '\0'};
        snprintf(rest, sizeof rest, "%.*s", (int)length - 1, word + front);
        const int sensor = axis_of(letter) < 0 ? -1 : sensor_of(column, rest, short_too && !front);
        if (sensor >= 0) {
            *axis = axis_of(letter);
            return sensor;
        }
    }
    return -1;
}

static bool is_gravity_free(const char *word)
{
    for (size_t i = 0; i < sizeof gravity_free / sizeof gravity_free[0]; i++)
        if (strcmp(word, gravity_free[i]) == 0)
            return true;
    return false;
}

static bool is_other(const char *word)
{
    if (is_gravity_free(word))
        return true;
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
        if (strcmp(word, others[i]) == 0)
            return true;
    return false;
}

/* The sensor whose axis a column seems to be; -1: of none. */
static int resembles(const imk_log_column *column, int *axis)
{
    words w;
    int sensor = -1, letter = -1, figure = -1;
    divide(column->name, &w);
    for (size_t k = 0; k < w.count; k++) {
        if (is_other(w.word[k]))
            return -1;
        const int place = axis_of(w.word[k]);
        const bool is_figure = w.word[k][0] >= '0' && w.word[k][0] <= '9';
        int found = -1, its = -1;
        if (place >= 0)
            *(is_figure ? &figure : &letter) = place;
        else if ((found = joined(column, w.word[k], w.count == 1, &its)) < 0)
            found = sensor_of(column, w.word[k], w.count == 2 && k == 0);
        sensor = found >= 0 ? found : sensor;
        letter = its >= 0 ? its : letter;
    }
    if (w.count > 1 && strcmp(w.word[0], "angular") == 0) { /* "angular_velocity.x" */
        const bool rate = strcmp(w.word[1], "velocity") == 0 || strcmp(w.word[1], "rate") == 0;
        sensor = rate && fits(column, IMK_GYRO) ? IMK_GYRO : -1;
    }
    *axis = letter >= 0 ? letter : figure;
    return *axis >= 0 ? sensor : -1;
}

static bool has(size_t count, const imk_log_column *columns, int sensor, int axis)
{
    for (size_t k = 0; k < count; k++)
        if (columns[k].quantity == sensors[sensor].quantity &&
            (axis < 0 || columns[k].axis == axis))
            return true;
    return false;
}

/* The axis of a rate about it, by the names of angles and of rates in books on flight. */
static int axis_of_rate(const char *word)
{
    static const char *const axes[][2] = {{"roll", "p"}, {"pitch", "q"}, {"yaw", "r"}};
    for (int axis = 0; axis < 3; axis++)
        if (strcmp(word, axes[axis][0]) == 0 || strcmp(word, axes[axis][1]) == 0)
            return axis;
    return -1;
}

/* Is it a rate by its unit, which may stand at the end of the name? */
static bool is_rate(const imk_log_column *column, const words *w)
{
    static const char *const ends[] = {"dps", "mdps", "radps"};
    const imk_dimension none = {0};
    if (!imk_dimension_equal(column->unit.dimension, none))
        return imk_dimension_equal(column->unit.dimension, imk_unit_of("rad/s").dimension);
    for (size_t i = 0; i < sizeof ends / sizeof ends[0]; i++)
        if (w->count > 0 && strcmp(w->word[w->count - 1], ends[i]) == 0)
            return true;
    return false;
}

/* The sensor that a column is by its unit, whatever its name; -1: none. */
static int sensor_of_unit(const imk_log_column *column, int *axis)
{
    words w;
    *axis = -1;
    divide(column->name, &w);
    const bool rate = is_rate(column, &w);
    for (size_t k = 0; k < w.count; k++) {
        if (is_other(w.word[k]))
            return -1;
        const int place = axis_of(w.word[k]), about = rate ? axis_of_rate(w.word[k]) : -1;
        *axis = place >= 0 ? place : about >= 0 ? about : *axis;
    }
    if (rate && *axis >= 0 && *axis < 3)
        return IMK_GYRO;
    for (int sensor = 0; sensor < IMK_KINDS && *axis >= 0 && *axis < 3; sensor++)
        if (imk_dimension_equal(column->unit.dimension,
                                imk_unit_of(sensors[sensor].unit).dimension))
            return sensor;
    return -1;
}

/* Are three axes of a sensor in columns of its unit that nothing reads? */
static bool triad_by_unit(size_t count, const imk_log_column *columns, int sensor)
{
    bool found[3] = {false};
    for (size_t k = 0; k < count; k++) {
        int axis;
        if (columns[k].quantity == IMK_QUANTITY_OTHER && !columns[k].label &&
            sensor_of_unit(&columns[k], &axis) == sensor)
            found[axis] = true;
    }
    return found[0] && found[1] && found[2];
}

/* One more of a list that may become too long for its text. */
static void list(char *text, size_t size, const char *item)
{
    const bool first = !text[0];
    if (strlen(text) + strlen(item) + 8 > size) {
        imki_append_text(text, size, strstr(text, ", …") ? "" : ", …");
        return;
    }
    imki_append_text(text, size, first ? "" : ", ");
    imki_append_text(text, size, item);
}

/* The columns that nothing reads and that seem to be of one sensor. */
typedef struct likeness {
    char names[60], likes[36];
    bool any, lacking, named, sign;
} likeness;

/* @param by_unit  the unit of the sensor and an axis will do */
static likeness look(size_t count, const imk_log_column *columns, int sensor, bool by_unit)
{
    likeness l = {.any = false};
    char like[48];
    for (size_t k = 0; k < count; k++) {
        int axis = -1;
        if (columns[k].quantity != IMK_QUANTITY_OTHER || columns[k].label ||
            (resembles(&columns[k], &axis) != sensor &&
             !(by_unit && sensor_of_unit(&columns[k], &axis) == sensor)))
            continue;
        imk_axis_name(sensors[sensor].name, axis, like);
        l.any = true;
        l.lacking =
            l.lacking || (has(count, columns, sensor, -1) && !has(count, columns, sensor, axis));
        l.named = l.named || strcmp(columns[k].name, like) == 0;
        l.sign = l.sign || columns[k].name[0] == '-' || columns[k].name[0] == '+';
        list(l.names, sizeof l.names, columns[k].name);
        list(l.likes, sizeof l.likes, like);
    }
    return l;
}

/* Columns of accelerations without gravity, where no accelerometer is read. */
static void tell_gravity_free(size_t count, const imk_log_column *columns, imk_findings *findings)
{
    char names[96] = "";
    if (has(count, columns, IMK_ACCEL, -1))
        return;
    for (size_t k = 0; k < count; k++) {
        words w;
        bool without = false, acceleration = false;
        divide(columns[k].name, &w);
        for (size_t i = 0; i < w.count; i++) {
            without = without || is_gravity_free(w.word[i]);
            acceleration = acceleration || strcmp(w.word[i], "acc") == 0 ||
                           strcmp(w.word[i], "accel") == 0 ||
                           strcmp(w.word[i], "acceleration") == 0;
        }
        if (columns[k].quantity == IMK_QUANTITY_OTHER && without && acceleration)
            list(names, sizeof names, columns[k].name);
    }
    if (names[0])
        imki_find(findings, IMK_FINDING_NOTE, "gravity_free", names, IMKI_NUMBERS(0));
}

bool imki_tell_unused(size_t count, const imk_log_column *columns, int kinds,
                      imk_findings *findings)
{
    bool whole = false;
    tell_gravity_free(count, columns, findings);
    for (int sensor = 0; sensor < kinds; sensor++) {
        /* A magnetometer beside the others is an extra, and often has no unit. */
        const bool read = sensor == IMK_MAG || has(count, columns, sensor, -1);
        const likeness l =
            look(count, columns, sensor, !read && triad_by_unit(count, columns, sensor));
        char both[sizeof l.names + sizeof l.likes];
        if (!l.any)
            continue;
        snprintf(both, sizeof both, "%s\t%s", l.names, l.likes);
        imki_find(findings, l.lacking || !read ? IMK_FINDING_WARNING : IMK_FINDING_NOTE,
                  !read       ? "unused_sensor"
                  : l.lacking ? "unused_axis"
                              : "unused_columns",
                  both, IMKI_NUMBERS(l.named, l.sign));
        whole = whole || !read;
    }
    return whole;
}
