/* SPDX-License-Identifier: Apache-2.0 */
/* Columns that nothing reads although they resemble those of a sensor: "gryo_y", "-mag_y",
 * "gyro y", "accel_z_raw". A name is taken apart into words at signs, capitals and figures. It
 * resembles a sensor's if a word is the sensor's, give or take a slip, another is an axis, and none
 * says that it is about something else, such as the standard deviation of readings. A unit of
 * another dimension rules a sensor out. Of a sensor that is not read at all, the unit will do:
 * three columns such as "Drehrate_x [deg/s]", "roll_rate_dps", "rate_front [rad/s]". */
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
    const char *increment;       /* name of increments */
} sensors[IMK_KINDS] = {{"gyro", IMK_QUANTITY_ANGULAR_RATE, "rad/s", "rad", "dtheta"},
                        {"accel", IMK_QUANTITY_SPECIFIC_FORCE, "m/s^2", "m/s", "dvel"},
                        {"mag", IMK_QUANTITY_MAGNETIC, "T", "T", "mag"}};

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

/* The sensor whose increments a word and the one behind it are: "delta_theta"; -1: of none. */
static int sensor_of_delta(const words *w, size_t k)
{
    static const char *const angles[] = {"theta", "angle", "ang"};
    static const char *const velocities[] = {"v", "vel", "velocity"};
    if (k + 1 >= w->count || strcmp(w->word[k], "delta") != 0)
        return -1;
    for (size_t i = 0; i < sizeof angles / sizeof angles[0]; i++)
        if (strcmp(w->word[k + 1], angles[i]) == 0)
            return IMK_GYRO;
    for (size_t i = 0; i < sizeof velocities / sizeof velocities[0]; i++)
        if (strcmp(w->word[k + 1], velocities[i]) == 0)
            return IMK_ACCEL;
    return -1;
}

/* The sensor whose axis a column seems to be; -1: of none. */
static int resembles(const imk_log_column *column, int *axis, bool *by_figure)
{
    words w;
    int sensor = -1, letter = -1, figure = -1;
    divide(column->name, &w);
    for (size_t k = 0; k < w.count; k++) {
        const int delta = sensor_of_delta(&w, k);
        if (delta >= 0 && fits(column, delta)) {
            sensor = delta;
            k++;
            continue;
        }
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
    *by_figure = letter < 0;
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

static bool is_unread(const imk_log_column *column)
{
    return column->quantity == IMK_QUANTITY_OTHER && !column->label;
}

/* Is it a reading of the sensor by its unit, and of nothing else by its name? */
static bool has_unit_of(const imk_log_column *column, int sensor)
{
    words w;
    divide(column->name, &w);
    for (size_t k = 0; k < w.count; k++)
        if (is_other(w.word[k]))
            return false;
    return sensor == IMK_GYRO ? is_rate(column, &w)
                              : imk_dimension_equal(column->unit.dimension,
                                                    imk_unit_of(sensors[sensor].unit).dimension);
}

/* How columns that nothing reads may be of a sensor that is not read. */
typedef enum likeness_by {
    BY_NAME,          /* only by their names */
    BY_UNIT_AND_AXIS, /* three axes in columns of its unit */
    BY_UNIT           /* three columns of its unit, of which the axes are not known */
} likeness_by;

static likeness_by likeness_of(size_t count, const imk_log_column *columns, int sensor)
{
    bool found[3] = {false};
    size_t of_unit = 0;
    for (size_t k = 0; k < count; k++) {
        int axis;
        if (!is_unread(&columns[k]))
            continue;
        of_unit += has_unit_of(&columns[k], sensor);
        if (sensor_of_unit(&columns[k], &axis) == sensor)
            found[axis] = true;
    }
    return found[0] && found[1] && found[2] ? BY_UNIT_AND_AXIS : of_unit >= 3 ? BY_UNIT : BY_NAME;
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

/* Does a column seem to be of the sensor? @param axis  receives which; -1: it is not known */
static bool is_like(const imk_log_column *column, int sensor, likeness_by by, int *axis,
                    bool *by_figure)
{
    *by_figure = false;
    if (!is_unread(column))
        return false;
    if (resembles(column, axis, by_figure) == sensor)
        return true;
    *by_figure = false;
    if (by == BY_UNIT_AND_AXIS)
        return sensor_of_unit(column, axis) == sensor;
    *axis = -1;
    return by == BY_UNIT && has_unit_of(column, sensor);
}

/* Do the figures of the names count from 1, as in gyro1, gyro2, gyro3? */
static bool counts_from_one(size_t count, const imk_log_column *columns, int sensor, likeness_by by)
{
    unsigned figures = 0;
    for (size_t k = 0; k < count; k++) {
        int axis;
        bool by_figure;
        if (is_like(&columns[k], sensor, by, &axis, &by_figure) && by_figure)
            figures |= 1U << axis;
    }
    return figures == (1U << 1 | 1U << 2 | 1U << 3);
}

static likeness look(size_t count, const imk_log_column *columns, int sensor, likeness_by by)
{
    likeness l = {.any = false};
    char like[48];
    const bool shifted = counts_from_one(count, columns, sensor, by);
    for (size_t k = 0; k < count; k++) {
        int axis;
        bool by_figure;
        if (!is_like(&columns[k], sensor, by, &axis, &by_figure))
            continue;
        l.any = true;
        l.sign = l.sign || columns[k].name[0] == '-' || columns[k].name[0] == '+';
        list(l.names, sizeof l.names, columns[k].name);
        if (axis < 0)
            continue;
        axis -= by_figure && shifted;
        const bool increment = imk_dimension_equal(columns[k].unit.dimension,
                                                   imk_unit_of(sensors[sensor].integral).dimension);
        imk_axis_name(increment ? sensors[sensor].increment : sensors[sensor].name, axis, like);
        l.lacking =
            l.lacking || (has(count, columns, sensor, -1) && !has(count, columns, sensor, axis));
        l.named = l.named || strcmp(columns[k].name, like) == 0;
        if (!strstr(l.likes, like)) /* names of one length */
            list(l.likes, sizeof l.likes, like);
    }
    if (l.any && !l.likes[0])
        snprintf(l.likes, sizeof l.likes, "%s_x, %s_y, %s_z", sensors[sensor].name,
                 sensors[sensor].name, sensors[sensor].name);
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
            look(count, columns, sensor, read ? BY_NAME : likeness_of(count, columns, sensor));
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

/* Is it of an axis, or of the attitude of the axes? "qw", "q0", "roll", "vel_x", "vy". */
static bool depends_on_axes(const imk_log_column *column)
{
    static const char *const attitude[] = {"roll",    "pitch",      "yaw",  "heading",
                                           "azimuth", "quaternion", "quat", "orientation",
                                           "euler",   "attitude",   "q",    "qw"};
    words w;
    divide(column->name, &w);
    for (size_t k = 0; k < w.count; k++) {
        const size_t length = strlen(w.word[k]);
        const char last = w.word[k][length - 1];
        if (length <= 2 && last >= 'x' && last <= 'z')
            return true;
        for (size_t i = 0; i < sizeof attitude / sizeof attitude[0]; i++)
            if (strcmp(w.word[k], attitude[i]) == 0)
                return true;
    }
    return false;
}

void imki_tell_not_turned(const imk_record_source *source, size_t count,
                          const imk_log_column *columns, imk_findings *findings)
{
    char names[96] = "";
    for (size_t k = 0; k < count && source->axes_turned; k++)
        if (is_unread(&columns[k]) && depends_on_axes(&columns[k]))
            list(names, sizeof names, columns[k].name);
    if (names[0])
        imki_find(findings, IMK_FINDING_WARNING, "not_turned", names, IMKI_NUMBERS(0));
}
