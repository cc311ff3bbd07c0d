/* SPDX-License-Identifier: Apache-2.0 */
/* From the options to the settings of a calibration. */
#include "calibrate_parts.h"
#include "shell/place_text.h"

#include <math.h>
#include <string.h>

/* ---- quantities and terms -------------------------------------------------------------------- */

/* "415 count/(m/s^2)": one number, or one for each axis. */
static int parse_counts(const char *option_name, const char *text, const char *unit,
                        imk_calibrate_counts *counts)
{
    double sigma[IMK_AXES_MAX];
    size_t count = 0;
    if (!text)
        return -1;
    if (imk_quantity_parse(text, text + strlen(text), imk_unit_of(unit).dimension, IMK_AXES_MAX,
                           counts->value, sigma, &count, NULL, NULL) != IMK_OK)
        return command_misused("--%s \"%s\": expected one number, or one for each axis, with a "
                               "unit such as %s",
                               option_name, text, unit);
    counts->count = (int)count;
    return -1;
}

static int take_counts(session *b)
{
    const calibrate_options *o = b->options;
    imk_calibrate_log_settings *s = &b->settings;
    const struct {
        const char *option, *text, *unit;
        imk_calibrate_counts *counts;
    } given[] = {
        {"gyro-sensitivity", o->sensitivity[0], "count/(rad/s)", &s->sensitivity[0]},
        {"gyro-zero", o->zero_offset[0], "count", &s->zero_offset[0]},
        {"accel-sensitivity", o->sensitivity[1], "count/(m/s^2)", &s->sensitivity[1]},
        {"accel-zero", o->zero_offset[1], "count", &s->zero_offset[1]},
        {"gyro-range", o->range[0], "deg/s", &s->range[0]},
        {"accel-range", o->range[1], "m/s^2", &s->range[1]},
    };
    int code = -1;
    for (size_t k = 0; code < 0 && k < sizeof given / sizeof *given; k++)
        code = parse_counts(given[k].option, given[k].text, given[k].unit, given[k].counts);
    return code;
}

/* "48.1 +- 0.2 uT": a number with its 1 sigma, or exact. */
static int parse_known(const char *option_name, const char *text, const char *unit,
                       const char *sample, double *value, double *sigma)
{
    size_t count = 0;
    if (!text)
        return -1;
    if (imk_quantity_parse(text, text + strlen(text), imk_unit_of(unit).dimension, 1, value, sigma,
                           &count, NULL, NULL) == IMK_OK &&
        count == 1)
        return -1;
    return command_misused("--%s \"%s\": expected a number and a unit, such as \"%s\"", option_name,
                           text, sample);
}

/* The field of the Earth. */
static int take_field(session *b)
{
    const calibrate_options *o = b->options;
    imk_calibrate_log_settings *s = &b->settings;
    double sigma;
    int code = parse_known("field", o->field, "T", "48.1 +- 0.2 uT", &s->field, &s->field_sigma);
    if (code < 0)
        code = parse_known("dip", o->dip, "rad", "64 deg", &s->dip, &sigma);
    if (code < 0 && o->field && !(s->field > 0 && s->field < 1e-3))
        code = command_misused("--field \"%s\": the field of the Earth is 22 to 67 uT", o->field);
    if (code < 0 && o->dip && !(fabs(s->dip) <= 1.5707963267948966))
        code = command_misused("--dip \"%s\": expected -90 deg to 90 deg", o->dip);
    return code;
}

/* --with and --without as bits. */
static int take_switches(const char *option_name, const char *list, unsigned *terms)
{
    static const char *const names[] = {"nonlinearity", "cross_products", "g_sensitivity",
                                        "g2_sensitivity", "gyro"};
    static const char between[] = ", ";
    enum { NAMES = sizeof names / sizeof names[0] };
    for (list += list ? strspn(list, between) : 0; list && *list; list += strspn(list, between)) {
        char item[48];
        int which = 0;
        const size_t length = strcspn(list, between);
        snprintf(item, sizeof item, "%.*s", (int)(length < sizeof item ? length : sizeof item - 1),
                 list);
        while (which < NAMES && strcmp(names[which], item) != 0)
            which++;
        if (which == NAMES) {
            const char *nearest = command_nearest(item, NAMES, names);
            return command_misused("--%s %s: expected nonlinearity, cross_products, g_sensitivity, "
                                   "g2_sensitivity or gyro%s%s%s",
                                   option_name, item, nearest ? "; did you mean " : "",
                                   nearest ? nearest : "", nearest ? "?" : "");
        }
        *terms |= 1u << which;
        list += length;
    }
    return -1;
}

_Static_assert(IMK_CALIBRATE_NONLINEARITY == 1 << 0 && IMK_CALIBRATE_GYRO_TURNS == 1 << 4,
               "in the order of the names");

static int take_terms(session *b)
{
    const calibrate_options *o = b->options;
    if (o->settings.estimate && (o->with || o->without))
        return command_misused(
            "--estimate names all terms to estimate: leave --with and --without out");
    const int code = take_switches("with", o->with, &b->settings.with);
    return code < 0 ? take_switches("without", o->without, &b->settings.without) : code;
}

int session_terms_refused(const char *option_name, const imk_error *error)
{
    const char *name = error->field;
    if (error->status == IMK_ERROR_RANGE)
        return command_misused("--%s %s: there is no such axis", option_name, name);
    if (error->status == IMK_ERROR_WORKSPACE)
        return command_misused("--%s: there are more than %d numbers", option_name,
                               IMK_CORRELATED_MAX);
    return command_misused("--%s %s: no such term; %s", option_name, name, error->expected);
}

/* ---- procedures ------------------------------------------------------------------------------ */

static int procedure_of(const char *name, size_t length, session *b, size_t log)
{
    const char *names[IMK_PROCEDURES + 1];
    char given[40];
    snprintf(given, sizeof given, "%.*s", (int)(length < 39 ? length : 39), name);
    for (int p = 0; p < IMK_PROCEDURES; p++) {
        names[p] = imk_procedure_name((imk_procedure)p);
        if (strcmp(names[p], given) == 0) {
            b->procedure[log] = (imk_procedure)p;
            return -1;
        }
    }
    names[IMK_PROCEDURES] = "repeatability";
    if (strcmp(given, "repeatability") == 0) {
        b->settings.repeatability = true;
        return -1;
    }
    const char *nearest = command_nearest(given, IMK_PROCEDURES + 1, names);
    char all[200] = "";
    for (size_t p = 0, used = 0; p < IMK_PROCEDURES; p++)
        used +=
            (size_t)snprintf(all + used, sizeof all - used, "%s%s", p > 0 ? ", " : "", names[p]);
    return command_misused("--procedure %s: there is no such procedure%s%s%s; there are %s and "
                           "repeatability",
                           given, nearest ? " (did you mean " : "", nearest ? nearest : "",
                           nearest ? "?)" : "", all);
}

/* One for all logs, or one for each. */
static int assign_procedures(session *b)
{
    const char *text = b->options->procedure;
    size_t count = 1;
    if (!text)
        return command_misused(
            "the procedure of the test is missing: add --procedure multiposition for a unit that "
            "was turned by hand from rest to rest; imukit calibrate --help lists the others");
    for (const char *c = text; *c; c++)
        count += *c == ',';
    if (count != 1 && count != b->count)
        return command_misused("--procedure %s: %zu procedures for %zu log%s; give one for all, or "
                               "one for each",
                               text, count, b->count, b->count == 1 ? "" : "s");
    for (size_t k = 0; k < b->count; k++) {
        const size_t length = strcspn(text, ",");
        int code = procedure_of(text, length, b, k);
        if (code >= 0)
            return code;
        if (count > 1)
            text += length + 1;
    }
    if (b->settings.repeatability && count > 1)
        return command_misused("--procedure: repeatability compares all logs, each of one power "
                               "cycle; it cannot be combined with another procedure");
    return -1;
}

/* Tables of pose means are read from files with names, and have no rate. */
static int check_means(const session *b)
{
    const calibrate_options *o = b->options;
    bool tables = false, logs = b->settings.repeatability;
    for (size_t k = 0; k < b->count && !b->settings.repeatability; k++) {
        tables = tables || imk_procedure_takes_means(b->procedure[k]);
        logs = logs || !imk_procedure_takes_means(b->procedure[k]);
    }
    if (!tables)
        return command_misused("--pose-means: %s needs a log, with every sample; only "
                               "multiposition, sixposition and tumble take tables of pose means",
                               o->procedure);
    if (!logs && o->log.file.rate > 0)
        return command_misused("--rate: a table of pose means has no times; leave it out");
    if (o->log.file.axes)
        return command_misused("--axes does not go with --pose-means: name the columns in the "
                               "header by forward-right-down axes");
    return -1;
}

/* An option that no procedure looks at was meant for another one. */
static int check_used(const session *b)
{
    const calibrate_options *o = b->options;
    bool compass = false;
    for (size_t k = 0; k < b->count && !b->settings.repeatability; k++)
        compass = compass || b->procedure[k] == IMK_PROCEDURE_MAGNETOMETER;
    if (o->motion_offset && !o->motion)
        return command_misused("--motion-offset is used with --motion only: add --motion");
    if (o->settings.estimate && compass)
        return command_misused("--estimate names terms of gyros and accelerometers; --procedure "
                               "magnetometer always estimates the same: leave one of them out");
    return o->settings.pose_means ? check_means(b) : -1;
}

static int check_closed_form(const session *b)
{
    const calibrate_options *o = b->options;
    if (!b->settings.closed_form || b->settings.repeatability)
        return -1;
    if (b->count != 1 || b->procedure[0] != IMK_PROCEDURE_FERRARIS)
        return command_misused(
            "--estimator closed-form solves one log of --procedure ferraris only: leave "
            "--estimator out for other procedures and for several logs");
    if (o->settings.estimate || o->with || o->without)
        return command_misused("--estimator closed-form always finds the same terms: leave "
                               "--estimate, --with and --without out");
    return -1;
}

/* ---- all of them ----------------------------------------------------------------------------- */

/* Settings that exclude each other, or that nothing looks at. */
static int refused(const calibrate_options *o, const imk_error *error)
{
    char name[sizeof error->field];
    if (strcmp(error->field, "gravity") == 0)
        return command_misused(
            "--gravity %.6g m/s^2: expected 9.5 to 10.1 m/s^2, the range on Earth", error->value);
    if (strcmp(error->field, "frame") == 0)
        return command_misused("--frame reference: gravity alone does not tell how the triad "
                               "stands in the housing; add a log of sixposition, ferraris, tumble "
                               "or rate-table, or choose upper-triangular, lower-triangular or "
                               "symmetric");
    if (strcmp(error->field, "turn_angle") == 0 && error->status == IMK_ERROR_RANGE)
        return command_misused("--turn-angle: expected %s", error->expected);
    const bool of_means = strcmp(error->expected, "leave it out") == 0;
    if (error->status != IMK_ERROR_CONFLICT ||
        (!of_means && strncmp(error->expected, "only by", 7) != 0))
        return command_error(error, NULL);
    snprintf(name, sizeof name, "%s", error->field);
    for (char *c = name; *c; c++)
        *c = *c == '_' ? '-' : *c;
    if (of_means)
        return command_misused("--%s: %s; leave it out", name, error->found);
    return command_misused("--%s is not used by --procedure %s, %s", name, o->procedure,
                           error->expected);
}

int session_choose(session *b)
{
    static const imk_motion unread = {
        0}; /* until session_load(): it is only asked if there is one */
    const calibrate_options *o = b->options;
    imk_error error;
    b->settings = o->settings;
    b->settings.motion = o->motion ? &unread : NULL;
    b->settings.closed_form = o->estimator != 0;
    b->settings.least_squares = o->robust != 0;
    b->settings.temperature_order = (int)o->temperature_order.value;
    b->settings.activity = o->plot || o->report;
    int code = assign_procedures(b);
    if (code < 0)
        code = check_used(b);
    if (code < 0 && o->position)
        code = place_parse(o->position, &b->settings.place);
    b->settings.place_known = o->position != NULL;
    if (code < 0)
        code = take_terms(b);
    if (code < 0)
        code = check_closed_form(b);
    if (code < 0)
        code = take_counts(b);
    if (code < 0)
        code = take_field(b);
    if (code < 0 && command_unless_memory(imk_calibrate_log_create(
                        b->count, b->procedure, &b->settings, NULL, &b->found, &error)) != IMK_OK)
        code = refused(o, &error);
    return code;
}

/* ---- files ----------------------------------------------------------------------------------- */

int session_motion(const calibrate_options *o, const imk_geodetic *place, imk_motion_file **motion,
                   imk_calibrate_log_settings *settings)
{
    imk_error error;
    double sigma;
    size_t count;
    const char *text = o->motion_offset;
    if (!o->motion)
        return -1;
    if (!*motion && imk_motion_read(o->motion, NULL, place, 1, motion, &error) != IMK_OK)
        return command_error(&error, o->motion);
    settings->motion = imk_motion_file_motion(*motion);
    settings->find_offset = text && strcmp(text, "auto") == 0;
    if (text && !settings->find_offset &&
        imk_quantity_parse(text, text + strlen(text), imk_unit_of("s").dimension, 1,
                           &settings->motion_offset, &sigma, &count, NULL, &error) != IMK_OK)
        return command_misused("--motion-offset %s: expected the time of the log at which the "
                               "programme begins, such as 2.5s, or auto",
                               text);
    return -1;
}

int session_known_before(session *b)
{
    const calibrate_options *o = b->options;
    const char *given = o->into ? o->into : o->model;
    if (!given)
        return -1;
    b->known = command_memory(NULL, sizeof *b->known);
    b->found->settings.model = b->known;
    return command_model(given, b->known, o->into ? &b->document : NULL);
}
