/* SPDX-License-Identifier: Apache-2.0 */
/* From the options to a problem: what is known before, and how each log is looked at. */
#include "calibrate_parts.h"
#include "shell/place_text.h"

#include <math.h>
#include <string.h>

/* Where the accelerometers' own axes are the frame, those of a table are others: the mounting of
 * the unit is then estimated, from nothing known within this [rad]. */
static const double loose_mounting = 0.1;

/* ---- what is known before -------------------------------------------------------------------- */

/* "415 count/(m/s^2)": one number, or one for each axis. */
static int parse_counts(const char *option_name, const char *text, const char *unit, int axes,
                        double *value)
{
    double read[IMK_AXES_MAX], sigma[IMK_AXES_MAX];
    size_t count = 0;
    imk_error error;
    const imk_status status =
        imk_quantity_parse(text, text + strlen(text), imk_unit_of(unit).dimension, IMK_AXES_MAX,
                           read, sigma, &count, NULL, &error);
    if (status != IMK_OK || (count != 1 && count != (size_t)axes))
        return command_misused("--%s \"%s\": expected one number, or one for each of %d axes, with "
                               "a unit such as %s",
                               option_name, text, axes, unit);
    for (int i = 0; i < axes; i++)
        value[i] = read[count == 1 ? 0 : i];
    return -1;
}

static int apply_counts(const calibrate_options *o, int sensor, imk_triad *triad)
{
    static const char *const units[2] = {"count/(rad/s)", "count/(m/s^2)"};
    static const char *const sensitivity[2] = {"gyro-sensitivity", "accel-sensitivity"};
    static const char *const zero[2] = {"gyro-zero", "accel-zero"};
    int code = -1;
    if (o->sensitivity[sensor])
        code = parse_counts(sensitivity[sensor], o->sensitivity[sensor], units[sensor],
                            triad->axis_count, triad->sensitivity.value);
    if (code < 0 && o->zero_offset[sensor])
        code = parse_counts(zero[sensor], o->zero_offset[sensor], "count", triad->axis_count,
                            triad->zero_offset.value);
    for (int i = 0; code < 0 && i < triad->axis_count; i++) {
        if (o->sensitivity[sensor] && triad->sensitivity.value[i] == 0)
            return command_misused("--%s: a sensitivity of 0 makes no counts", sensitivity[sensor]);
        if (triad->zero_offset.value[i] != 0 && triad->sensitivity.value[i] == 0)
            return command_misused("--%s needs --%s", zero[sensor], sensitivity[sensor]);
    }
    return code;
}

/* Counts per unit say nothing about readings that have a unit. */
static int check_counts(const session *b, int sensor, bool counts)
{
    const calibrate_options *o = b->options;
    if (counts || (!o->sensitivity[sensor] && !o->zero_offset[sensor]))
        return -1;
    return command_misused("--%s-%s is for readings in counts, and those of %s have a unit",
                           sensor_keys[sensor], o->sensitivity[sensor] ? "sensitivity" : "zero",
                           b->found->record[0].path);
}

/* Axes of the logs; a model that is given must have them. */
static int match_axes(session *b, imk_model *model, bool given)
{
    imk_triad *triad[2] = {&model->gyro, &model->accel};
    for (int sensor = 0; sensor < 2; sensor++) {
        int axes = 0;
        bool counts = false;
        for (size_t k = 0; k < b->found->count; k++) {
            const imk_test_record *record = &b->found->record[k].record;
            const int here = record->axis_count[sensor];
            if (here > 0 && axes > 0 && here != axes)
                return command_failed("%s has %d %s axes and the others have %d",
                                      b->found->record[k].path, here, sensor_titles[sensor], axes);
            if (here > 0 && axes > 0 && counts != record->counts[sensor])
                return command_failed("%s: its %s readings are in counts and those of other logs "
                                      "are not, or the reverse",
                                      b->found->record[k].path, sensor_titles[sensor]);
            axes = here > 0 ? here : axes;
            counts = here > 0 ? record->counts[sensor] : counts;
        }
        const int code = axes > 0 ? check_counts(b, sensor, counts) : -1;
        if (code >= 0)
            return code;
        if (given && axes > 0 && (!triad[sensor]->present || triad[sensor]->axis_count != axes))
            return command_failed("%s has %d %s axes, the log has %d: they cannot be matched",
                                  b->options->into ? b->options->into : b->options->model,
                                  triad[sensor]->present ? triad[sensor]->axis_count : 0,
                                  sensor_titles[sensor], axes);
        if (!given) {
            triad[sensor]->present = axes > 0;
            triad[sensor]->axis_count = axes > 0 ? axes : 3;
            for (int i = 3; i < axes; i++)
                triad[sensor]->direction[i][i % 3] = 1;
        }
        b->found->nominal[sensor] = counts && triad[sensor]->sensitivity.value[0] == 0;
    }
    return -1;
}

int session_known_before(session *b)
{
    const calibrate_options *o = b->options;
    imk_model *model = &b->found->calibration->model;
    const char *given = o->into ? o->into : o->model;
    int code = given ? command_model(given, model, o->into ? &b->document : NULL) : -1;
    if (code < 0 && given && model->residual_of[0])
        code = command_failed("%s is what is left after compensating with \"%s\": to calibrate "
                              "again, take the log before it was compensated, and that model with "
                              "--into",
                              given, model->residual_of);
    for (int sensor = 0; code < 0 && sensor < 2; sensor++)
        code = apply_counts(o, sensor, imk_model_triad_to_set(model, sensor));
    if (code < 0)
        code = match_axes(b, model, given != NULL);
    b->before = *model;
    return code;
}

/* Gravity and the Earth's rotation. */
static int set_place(session *b)
{
    const calibrate_options *o = b->options;
    imk_calibration *c = b->found->calibration;
    int code = o->position ? place_parse(o->position, &b->place) : -1;
    if (code >= 0)
        return code;
    b->found->settings.place_known = o->position != NULL;
    if (b->found->settings.place_known) {
        c->latitude = b->place.latitude;
        c->gravity = imk_normal_gravity(b->place.latitude, b->place.height);
    }
    if (!isnan(o->gravity)) {
        if (!(o->gravity > 9.5 && o->gravity < 10.1))
            return command_misused("--gravity %.6g m/s^2: expected 9.5 to 10.1 m/s^2, which is "
                                   "what there is on Earth",
                                   o->gravity);
        c->gravity = o->gravity;
    }
    if (o->no_earth)
        c->earth_rate = 0;
    return -1;
}

/* Where gravity is the reference, its amount is the scale of the accelerometers. */
static void warn_of_gravity(const session *b)
{
    bool needed = false;
    for (size_t k = 0; k < b->found->count; k++)
        needed = needed || (b->found->record[k].record.axis_count[1] > 0 &&
                            b->found->record[k].procedure < IMK_PROCEDURE_RATE_TABLE);
    if (needed && !b->found->settings.place_known && isnan(b->found->settings.gravity))
        command_warn("gravity",
                     "the place is not known: gravity is taken as %.5f m/s^2, that of 45 deg and "
                     "sea level, and differs from it by up to 0.3 %%, which goes into the scale "
                     "factors; add --position \"48.1 deg, 11.6 deg, 520 m\" or --gravity "
                     "9.80780m/s^2",
                     b->found->calibration->gravity);
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
            b->found->record[log].procedure = (imk_procedure)p;
            return -1;
        }
    }
    names[IMK_PROCEDURES] = "repeatability";
    if (strcmp(given, "repeatability") == 0) {
        b->found->settings.repeatability = true;
        return -1;
    }
    const char *nearest = command_nearest(given, IMK_PROCEDURES + 1, names);
    return command_misused("--procedure %s: there is no such procedure%s%s%s; there are "
                           "multiposition, sixposition, ferraris, rate-table, tumble, centrifuge, "
                           "spin, thermal and repeatability",
                           given, nearest ? " (did you mean " : "", nearest ? nearest : "",
                           nearest ? "?)" : "");
}

/* One for all logs, or one for each. */
static int assign_procedures(session *b)
{
    const char *text = b->options->procedure;
    size_t count = 1;
    if (!text)
        return command_misused("what was done is missing: add --procedure multiposition for a unit "
                               "turned by hand from rest to rest; the others are in imukit "
                               "calibrate --help");
    for (const char *c = text; *c; c++)
        count += *c == ',';
    if (count != 1 && count != b->found->count)
        return command_misused("--procedure %s: %zu procedures for %zu log%s; give one for all, or "
                               "one for each",
                               text, count, b->found->count, b->found->count == 1 ? "" : "s");
    for (size_t k = 0; k < b->found->count; k++) {
        const size_t length = strcspn(text, ",");
        int code = procedure_of(text, length, b, k);
        if (code >= 0)
            return code;
        if (count > 1)
            text += length + 1;
    }
    if (b->found->settings.repeatability && count > 1)
        return command_misused("--procedure: repeatability compares all logs, each of one power "
                               "cycle; it cannot stand beside another procedure");
    return -1;
}

static void set_if(double *target, double value)
{
    if (!isnan(value))
        *target = value;
}

static int settle(const session *b, session_log *log)
{
    const calibrate_options *o = b->options;
    imk_procedure_settings s = imk_procedure_default(log->procedure);
    set_if(&s.stationary.initial_rest, o->initial_rest);
    set_if(&s.stationary.window, o->window);
    set_if(&s.stationary.minimum, o->minimum);
    set_if(&s.minimum, o->minimum);
    set_if(&s.placement_sigma, o->placement);
    if (b->found->calibration->frame != IMK_FRAME_REFERENCE &&
        imk_procedure_is_known(log->procedure))
        s.fixture_sigma = loose_mounting;
    set_if(&s.fixture_sigma, o->mounting);
    set_if(&s.turn_angle, o->turn_angle);
    set_if(&s.trim, o->trim);
    set_if(&s.settle, o->settle);
    set_if(&s.reference_temperature, o->reference_temperature);
    s.temperature_order = (int)o->temperature_order.value;
    log->settings = s;
    return session_switch_terms(o, log->procedure, &log->settings);
}

/* Forces on the accelerometers are known, and with them how the triad stands in the housing. */
static bool knows_force(imk_procedure procedure)
{
    return imk_procedure_is_known(procedure) && procedure != IMK_PROCEDURE_RATE_TABLE &&
           procedure != IMK_PROCEDURE_SPIN;
}

static int choose_frame(session *b)
{
    bool known = false, force = false, gravity = false;
    for (size_t k = 0; k < b->found->count; k++) {
        known = known || imk_procedure_is_known(b->found->record[k].procedure);
        force = force || knows_force(b->found->record[k].procedure);
        gravity = gravity || b->found->record[k].procedure == IMK_PROCEDURE_MULTIPOSITION;
    }
    /* A table for the gyros and poses for the accelerometers: the poses fix the frame. */
    const bool reference = known && (force || !gravity);
    b->found->calibration->frame = b->options->frame >= 0 ? (imk_triad_frame)b->options->frame
                                   : reference            ? IMK_FRAME_REFERENCE
                                                          : IMK_FRAME_UPPER;
    if (!known && b->found->calibration->frame == IMK_FRAME_REFERENCE)
        return command_misused("--frame reference: gravity alone does not tell how the triad "
                               "stands in the housing; add a log of sixposition, ferraris, tumble "
                               "or rate-table, or choose upper-triangular, lower-triangular or "
                               "symmetric");
    return -1;
}

/* An option that no procedure looks at was meant for another one. */
static int check_used(const session *b)
{
    const calibrate_options *o = b->options;
    bool referenced = false, ferraris = false, thermal = false;
    for (size_t k = 0; k < b->found->count && !b->found->settings.repeatability; k++) {
        const imk_procedure p = b->found->record[k].procedure;
        ferraris = ferraris || p == IMK_PROCEDURE_FERRARIS;
        thermal = thermal || p == IMK_PROCEDURE_THERMAL;
        referenced = referenced || p == IMK_PROCEDURE_RATE_TABLE || p == IMK_PROCEDURE_TUMBLE ||
                     p == IMK_PROCEDURE_CENTRIFUGE || p == IMK_PROCEDURE_SPIN;
    }
    const char *none = "--%s is not used by --procedure %s: it is of %s";
    if (o->motion && !referenced && !thermal)
        return command_misused(none, "motion", o->procedure,
                               "rate-table, tumble, centrifuge, spin and thermal");
    if (o->motion_offset && !o->motion)
        return command_misused("--motion-offset is of --motion");
    if (o->table_axis >= 0 && !referenced)
        return command_misused(none, "table-axis", o->procedure, "rate-table");
    if (!isnan(o->turn_angle) && !ferraris)
        return command_misused(none, "turn-angle", o->procedure, "ferraris");
    if (o->temperature_order.given && !thermal)
        return command_misused(none, "temperature-order", o->procedure, "thermal");
    if (!isnan(o->reference_temperature) && !thermal)
        return command_misused(none, "reference-temperature", o->procedure, "thermal");
    return -1;
}

int session_choose(session *b)
{
    imk_calibration_default(b->found->calibration);
    b->found->calibration->robust = b->options->robust == 0;
    int code = assign_procedures(b);
    if (code < 0)
        code = check_used(b);
    if (code < 0)
        code = set_place(b);
    if (code < 0)
        code = choose_frame(b);
    for (size_t k = 0; code < 0 && k < b->found->count; k++)
        code = settle(b, &b->found->record[k]);
    return code;
}

int session_prepare(session *b)
{
    int code = session_choose(b);
    if (code < 0 && b->options->motion) {
        imk_error error;
        const imk_geodetic *place = b->found->settings.place_known ? &b->place : NULL;
        if (imk_motion_read(b->options->motion, NULL, place, 1, &b->motion, &error) != IMK_OK)
            code = command_error(&error, b->options->motion);
    }
    for (size_t k = 0; code < 0 && k < b->found->count; k++) {
        code = session_load(b, &b->found->record[k]);
        if (code < 0)
            code = session_reference(b, &b->found->record[k]);
    }
    if (code < 0)
        code = session_known_before(b);
    if (code < 0 && !b->found->settings.repeatability)
        warn_of_gravity(b);
    if (code < 0 && b->options->estimate)
        code = session_free_terms(b);
    return code;
}
