/* SPDX-License-Identifier: Apache-2.0 */
/* Names of columns as people and programs write them. A name is divided into words at signs and
 * capitals: "imu0.AngularVelocity_x" is imu0, angular, velocity, x. The last word is the axis, the
 * words of the sensor stand before it, and what stands before these says which of several sensors
 * it is. A unit may follow: "acc_x_mg". A word that makes it something else, such as "bias" or
 * "std", or one that is not known between sensor and axis, and it is no reading: a column that is
 * left unread is told, and one that is read wrongly is not. */
#include "log_names_internal.h"

#include "log_words_internal.h"

#include "base/text_internal.h"

#include <stdio.h>
#include <string.h>

enum { GYRO, DTHETA, ACCEL, DVEL, MAG, TIME, TEMPERATURE };

const imki_log_kind imki_log_kinds[IMKI_LOG_KINDS] = {
    [GYRO] = {"gyro_", IMK_QUANTITY_ANGULAR_RATE, true, false, "rad/s", "--gyro-unit",
              "deg/s, rad/s, count"},
    [DTHETA] = {"dtheta_", IMK_QUANTITY_ANGULAR_RATE, true, true, "rad", "--gyro-unit",
                "arcsec, rad, count"},
    [ACCEL] = {"accel_", IMK_QUANTITY_SPECIFIC_FORCE, true, false, "m/s^2", "--accel-unit",
               "g, m/s^2, count"},
    [DVEL] = {"dvel_", IMK_QUANTITY_SPECIFIC_FORCE, true, true, "m/s", "--accel-unit",
              "m/s, count"},
    [MAG] = {"mag_", IMK_QUANTITY_MAGNETIC, true, false, "T", NULL, NULL},
    [TIME] = {"time", IMK_QUANTITY_TIME, false, false, "s", "--time-unit", "s, ms, us, ns"},
    [TEMPERATURE] = {"temperature", IMK_QUANTITY_TEMPERATURE, false, false, "K",
                     "--temperature-unit", "degC, K"}};

const imki_log_kind *imki_log_kind_of(imk_quantity quantity)
{
    for (size_t k = 0; k < IMKI_LOG_KINDS; k++)
        if (imki_log_kinds[k].quantity == quantity)
            return &imki_log_kinds[k];
    return NULL;
}

/* The sensor in words, with blanks between. `joined`: it may have the axis at its end, "gyrox", and
 * a number, "gyro1". `of_message`: as the fields of sensor_msgs/Imu are called. */
static const struct {
    const char *words;
    int kind;
    bool joined, of_message;
} sensors[] = {{"angular velocity", GYRO, false, true},
               {"angular rate", GYRO, false, false},
               {"rotation rate", GYRO, false, false},
               {"rot rate", GYRO, false, false},
               {"ang vel", GYRO, false, false},
               {"angularvelocity", GYRO, true, false},
               {"rotationrate", GYRO, true, false},
               {"angvel", GYRO, true, false},
               {"gyro", GYRO, true, false},
               {"gyr", GYRO, true, false},
               {"gyros", GYRO, true, false},
               {"gyroscope", GYRO, true, false},
               {"omega", GYRO, true, false},
               {"dtheta", DTHETA, true, false},
               {"accel", ACCEL, true, false},
               {"acc", ACCEL, true, false},
               {"accelerometer", ACCEL, true, false},
               {"acceleration", ACCEL, true, false},
               {"specific force", ACCEL, false, false},
               {"linear acceleration", ACCEL, false, true},
               {"dvel", DVEL, true, false},
               {"mag", MAG, true, false},
               {"magnetometer", MAG, true, false},
               {"magnetic field", MAG, false, false}};

/* One letter and the axis, alone: "wx", "a_x", and as in EuRoC's "w_RS_S_x". Or joined: "gx". */
static const struct {
    const char *word;
    int kind;
    bool alone; /* "w_x" is a name; "g_x" may be gravity */
} letters[] = {{"w", GYRO, true}, {"g", GYRO, false}, {"a", ACCEL, true}, {"m", MAG, false}};

/* Times of a sample in words; `exact` ones hold where others are there, too. */
static const struct {
    const char *words;
    bool exact;
    const char *unit;
} times[] = {{"time", true, NULL},
             {"t", true, NULL},
             {"timestamp", true, NULL},
             {"time stamp", false, NULL},
             {"ts", false, NULL},
             {"stamp", false, NULL},
             {"header stamp", false, NULL},
             {"seconds elapsed", false, "s"},
             {"elapsed time", false, NULL},
             {"time elapsed", false, NULL},
             {"elapsed", false, NULL},
             {"epoch", false, NULL},
             {"epoch time", false, NULL},
             {"unix time", false, NULL},
             {"unixtime", false, NULL},
             {"sample time", false, NULL},
             {"seconds", false, "s"},
             {"timestamps", false, NULL},
             {"time since start", false, NULL},
             {"time since start in", false, NULL}};

static const struct {
    const char *words;
    bool exact;
} temperatures[] = {{"temperature", true},         {"temp", true},
                    {"imu temperature", false},    {"imu temp", false},
                    {"sensor temperature", false}, {"sensor temp", false}};

/* Words between the sensor and its axis that leave it what it is. */
static const char *const fillers[] = {"raw",  "adc",         "smooth",   "calibrated",   "cal",
                                      "data", "axis",        "rotation", "acceleration", "rs",
                                      "s",    "measurement", "value"};

/* With one of these it is no reading of a sensor. */
static const char *const others[] = {
    "std",      "stddev",   "sigma",    "var",        "variance", "cov",         "covariance",
    "bias",     "offset",   "scale",    "range",      "temp",     "temperature", "status",
    "error",    "err",      "residual", "true",       "truth",    "reference",   "ref",
    "gt",       "setpoint", "target",   "cmd",        "command",  "desired",     "min",
    "max",      "mean",     "avg",      "average",    "rms",      "noise",       "table",
    "estimate", "est",      "unfilt",   "unfiltered", "filtered", "filt",        "valid",
    "count",    "counter",  "quality",  "integral",   "angle",    "jerk",        "norm",
    "angular",  "world",    "earth",    "nav",        "ned",      "enu",         "lpf",
    "debug"};

/* Words by which an acceleration has lost its gravity. */
static const char *const gravity_free[] = {"free", "user", "linear", "lin", "gravity", "grav"};

static const char without_gravity[] = "gravity is taken out of it";

/* Units as ends of names. */
static const struct {
    const char *end, *unit;
    int kind, other; /* whose they are; -1: none */
} ends[] = {{"dps", "deg/s", GYRO, -1},
            {"mdps", "mdps", GYRO, -1},
            {"degs", "deg/s", GYRO, -1},
            {"deg s", "deg/s", GYRO, -1},
            {"deg per s", "deg/s", GYRO, -1},
            {"deg sec", "deg/s", GYRO, -1},
            {"degrees per second", "deg/s", GYRO, -1},
            {"radians per second", "rad/s", GYRO, -1},
            {"dph", "deg/h", GYRO, -1},
            {"deg h", "deg/h", GYRO, -1},
            {"rads", "rad/s", GYRO, -1},
            {"radps", "rad/s", GYRO, -1},
            {"rps", NULL, GYRO, -1}, /* radians, or revolutions */
            {"rad s", "rad/s", GYRO, -1},
            {"rad per s", "rad/s", GYRO, -1},
            {"rad sec", "rad/s", GYRO, -1},
            {"rad", "rad", DTHETA, -1},
            {"deg", "deg", DTHETA, -1},
            {"arcsec", "arcsec", DTHETA, -1},
            {"g", "g", ACCEL, -1},
            {"mg", "mg", ACCEL, -1},
            {"milli g", "mg", ACCEL, -1},
            {"ug", "ug", ACCEL, -1},
            {"gal", "Gal", ACCEL, -1},
            {"mgal", "mGal", ACCEL, -1},
            {"ms2", "m/s^2", ACCEL, -1},
            {"mss", "m/s^2", ACCEL, -1},
            {"mps2", "m/s^2", ACCEL, -1},
            {"m s2", "m/s^2", ACCEL, -1},
            {"m s 2", "m/s^2", ACCEL, -1},
            {"m s s", "m/s^2", ACCEL, -1},
            {"m per s2", "m/s^2", ACCEL, -1},
            {"mps", "m/s", DVEL, -1},
            {"m s", "m/s", DVEL, -1},
            {"ut", "uT", MAG, -1},
            {"nt", "nT", MAG, -1},
            {"gauss", "gauss", MAG, -1},
            {"gs", "gauss", MAG, -1},
            {"mgauss", "mG", MAG, -1},
            {"lsb", "count", GYRO, ACCEL},
            {"count", "count", GYRO, ACCEL},
            {"counts", "count", GYRO, ACCEL},
            {"s", "s", TIME, -1},
            {"sec", "s", TIME, -1},
            {"sek", "s", TIME, -1},
            {"secs", "s", TIME, -1},
            {"seconds", "s", TIME, -1},
            {"ms", "ms", TIME, -1},
            {"msec", "ms", TIME, -1},
            {"millis", "ms", TIME, -1},
            {"milliseconds", "ms", TIME, -1},
            {"us", "us", TIME, -1},
            {"usec", "us", TIME, -1},
            {"micros", "us", TIME, -1},
            {"microseconds", "us", TIME, -1},
            {"ns", "ns", TIME, -1},
            {"nsec", "ns", TIME, -1},
            {"nanos", "ns", TIME, -1},
            {"nanoseconds", "ns", TIME, -1},
            {"c", "degC", TEMPERATURE, -1},
            {"degc", "degC", TEMPERATURE, -1},
            {"deg c", "degC", TEMPERATURE, -1},
            {"celsius", "degC", TEMPERATURE, -1},
            {"k", "K", TEMPERATURE, -1},
            {"kelvin", "K", TEMPERATURE, -1}};

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static bool is_figure(char c)
{
    return c >= '0' && c <= '9';
}

static bool is_one_of(const char *word, const char *const *list, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (strcmp(word, list[i]) == 0)
            return true;
    return false;
}

/* "gyro1" is a gyro, the one of the number. */
static size_t match_numbered(const imki_log_words *w, size_t first, size_t end, const char *phrase)
{
    const size_t length = strlen(phrase);
    return first < end && strncmp(w->word[first], phrase, length) == 0 &&
                   w->word[first][length] != '\0' &&
                   w->word[first][length + strspn(w->word[first] + length, "0123456789")] == '\0'
               ? 1
               : 0;
}

static int axis_of(const char *word)
{
    if (!word[0] || word[1])
        return -1;
    return word[0] >= 'x' && word[0] <= 'z'   ? word[0] - 'x'
           : word[0] >= '0' && word[0] <= '7' ? word[0] - '0'
                                              : -1;
}

/* The words before the sensor, with _ between. */
static void take_group(const imki_log_words *w, size_t end, imki_log_name *name)
{
    for (size_t i = 0; i < end; i++) {
        imki_append_text(name->group, sizeof name->group, i > 0 ? "_" : "");
        imki_append_text(name->group, sizeof name->group, w->word[i]);
    }
}

/* Is it a reading by its other words? Notes the reason if not. */
static bool is_reading(const imki_log_words *w, size_t first, size_t behind, size_t end, int kind,
                       imki_log_name *name)
{
    for (size_t i = 0; i < end; i++) {
        if (i >= first && i < behind)
            continue;
        if (kind == ACCEL && is_one_of(w->word[i], gravity_free, COUNT(gravity_free)))
            name->reason = without_gravity;
        if (is_one_of(w->word[i], others, COUNT(others)) || name->reason)
            return false;
        if (i >= behind && !is_one_of(w->word[i], fillers, COUNT(fillers)))
            return false;
    }
    return true;
}

static void set(imki_log_name *name, int kind, int axis, const imki_log_words *w, size_t first)
{
    name->kind = &imki_log_kinds[kind];
    name->axis = axis;
    take_group(w, first, name);
}

/* "gyro x": the sensor somewhere before the axis. @param end  behind the axis */
static bool find_sensor(const imki_log_words *w, size_t end, imki_log_name *name)
{
    const int axis = axis_of(w->word[end - 1]);
    for (size_t first = 0; axis >= 0 && first + 1 < end; first++)
        for (size_t k = 0; k < COUNT(sensors); k++) {
            size_t count = imki_log_words_match(w, first, end - 1, sensors[k].words);
            const bool numbered = count == 0 && sensors[k].joined &&
                                  (count = match_numbered(w, first, end - 1, sensors[k].words)) > 0;
            if (count == 0)
                continue;
            if (!is_reading(w, first, first + count, end - 1, sensors[k].kind, name))
                return false;
            set(name, sensors[k].kind, axis, w, first);
            name->numbered = is_figure(w->word[end - 1][0]);
            name->of_message = sensors[k].of_message;
            if (numbered)
                imki_append_text(name->group, sizeof name->group,
                                 w->word[first] + strlen(sensors[k].words));
            return true;
        }
    return false;
}

/* "gyrox", "gx", "xgyro": the sensor and its axis in one word, the last one. */
static bool find_joined(const imki_log_words *w, size_t end, imki_log_name *name)
{
    const char *last = w->word[end - 1];
    const size_t length = strlen(last);
    char rest[IMKI_LOG_WORD_SIZE];
    for (int front = 0; front < 2 && length > 1; front++) {
        const char letter[2] = {front ? last[0] : last[length - 1], '\0'};
        const int axis = is_figure(letter[0]) ? -1 : axis_of(letter);
        snprintf(rest, sizeof rest, "%.*s", (int)length - 1, last + front);
        int kind = -1;
        for (size_t k = 0; k < COUNT(sensors); k++)
            if (sensors[k].joined && strcmp(rest, sensors[k].words) == 0)
                kind = sensors[k].kind;
        for (size_t k = 0; k < COUNT(letters) && front == 0; k++)
            if (strcmp(rest, letters[k].word) == 0)
                kind = letters[k].kind;
        if (axis < 0 || kind < 0 || !is_reading(w, end - 1, end, end, kind, name))
            continue;
        set(name, kind, axis, w, end - 1);
        return true;
    }
    return false;
}

/* "w_x", "a_RS_S_z": the letter first, and nothing but the frames of EuRoC behind it. */
static bool find_letter(const imki_log_words *w, size_t end, imki_log_name *name)
{
    const int axis = axis_of(w->word[end - 1]);
    if (axis < 0 || is_figure(w->word[end - 1][0]) ||
        !(end == 2 || (end == 4 && imki_log_words_are(w, 1, 3, "rs s"))))
        return false;
    for (size_t k = 0; k < COUNT(letters); k++)
        if (letters[k].alone && strcmp(w->word[0], letters[k].word) == 0) {
            set(name, letters[k].kind, axis, w, 0);
            return true;
        }
    return false;
}

/* A time or a temperature, whose words are all of the name. */
static bool find_other(const imki_log_words *w, size_t end, imki_log_name *name)
{
    size_t first = 0; /* "field.header.stamp" */
    if (end > 2 && strcmp(w->word[0], "field") == 0 && strcmp(w->word[1], "header") == 0)
        first = 1;
    for (size_t k = 0; k < COUNT(times); k++)
        if (imki_log_words_are(w, first, end, times[k].words)) {
            name->kind = &imki_log_kinds[TIME];
            name->exact = times[k].exact;
            name->unit = times[k].unit;
            return true;
        }
    for (size_t k = 0; k < COUNT(temperatures); k++)
        if (imki_log_words_are(w, 0, end, temperatures[k].words)) {
            name->kind = &imki_log_kinds[TEMPERATURE];
            name->exact = temperatures[k].exact;
            return true;
        }
    return false;
}

static bool find_kind(const imki_log_words *w, size_t end, imki_log_name *name)
{
    return end > 0 && (find_sensor(w, end, name) || find_joined(w, end, name) ||
                       find_letter(w, end, name) || find_other(w, end, name));
}

/* A unit at the end, of the kind that the words before it are. */
static bool find_with_unit(const imki_log_words *w, imki_log_name *name)
{
    for (size_t k = 0; k < COUNT(ends); k++) {
        for (size_t count = 1; count <= 3 && count < w->count; count++) {
            const size_t end = w->count - count;
            imki_log_name found = {.axis = -1};
            if (!imki_log_words_are(w, end, w->count, ends[k].end) || !find_kind(w, end, &found))
                continue;
            if (found.kind == &imki_log_kinds[TIME] && ends[k].kind == TEMPERATURE &&
                ends[k].end[1] && imki_log_words_are(w, 0, end, "t")) /* "T_degC" */
                found = (imki_log_name){.kind = &imki_log_kinds[TEMPERATURE], .axis = -1};
            if (found.unit || (found.kind != &imki_log_kinds[ends[k].kind] &&
                               (ends[k].other < 0 || found.kind != &imki_log_kinds[ends[k].other])))
                continue;
            *name = found;
            name->unit = ends[k].unit;
            return true;
        }
    }
    return false;
}

static const char *unit_by_end(const imki_log_words *w, const imki_log_kind *kind)
{
    for (size_t k = 0; k < COUNT(ends) && !w->overflow; k++)
        if (imki_log_words_are(w, 0, w->count, ends[k].end) &&
            (kind == &imki_log_kinds[ends[k].kind] ||
             (ends[k].other >= 0 && kind == &imki_log_kinds[ends[k].other])))
            return ends[k].unit;
    return NULL;
}

const char *imki_log_unit_of_words(const char *text, const imki_log_kind *kind)
{
    imki_log_words w;
    char small[IMKI_LOG_WORD_SIZE];
    size_t length = 0;
    imki_log_words_divide(text, &w);
    const char *unit = unit_by_end(&w, kind);
    for (; text[length] && length + 1 < sizeof small; length++) /* "mDPS" is no m and dps */
        small[length] = imki_lower(text[length]);
    small[length] = '\0';
    imki_log_words_divide(small, &w);
    return unit || text[length] ? unit : unit_by_end(&w, kind);
}

/* "gyro_x": the sensor as docs/logs.md has it, and its axis. */
static bool is_exact(const char *name)
{
    static const char *const prefixes[] = {"gyro_", "dtheta_", "accel_", "acc_", "dvel_", "mag_"};
    for (size_t k = 0; k < COUNT(prefixes); k++) {
        size_t length = 0;
        while (prefixes[k][length] && imki_lower(name[length]) == prefixes[k][length])
            length++;
        const char letter[2] = {imki_lower(name[length]), '\0'};
        if (!prefixes[k][length] && name[length] && !name[length + 1] && axis_of(letter) >= 0)
            return true;
    }
    return false;
}

imki_log_name imki_log_name_of(const char *text)
{
    imki_log_name name = {.axis = -1};
    imki_log_words w;
    /* A sign does not turn the readings round. */
    if (text[0] == '-' || text[0] == '+')
        return name;
    imki_log_words_divide(text, &w);
    if (w.overflow || w.count == 0 ||
        (!find_kind(&w, w.count, &name) && !find_with_unit(&w, &name)))
        return (imki_log_name){.axis = -1, .reason = name.reason};
    name.exact = name.exact || is_exact(text);
    return name;
}
