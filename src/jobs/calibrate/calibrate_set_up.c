/* SPDX-License-Identifier: Apache-2.0 */
/* From the settings to a problem: place and frame, how each record is looked at; and, with the
 * records loaded, what is known before. */
#include "calibrate_internal.h"

#include "base/refuse_internal.h"
#include "jobs/job_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Where the accelerometers' own axes are the frame, those of a table are others: the mounting of
 * the unit is then estimated, from nothing known within this [rad]. */
static const double loose_mounting = 0.1;

/* What there is on Earth [m/s^2]. */
static const double gravity_least = 9.5, gravity_most = 10.1;

/* Gravity differs from that of the ellipsoid by 5e-4 of it at most, in high mountains. */
static const double gravity_anomaly = 1e-3;

static const uint32_t settings_cookie = 0x43414C31; /* "CAL1" */

imk_calibrate_log_settings imk_calibrate_log_default(void)
{
    const double none = (double)NAN;
    return (imk_calibrate_log_settings){.cookie = settings_cookie,
                                        .gravity = none,
                                        .field = none,
                                        .field_sigma = none,
                                        .dip = none,
                                        .frame = -1,
                                        .placement = none,
                                        .g_sensitivity_sigma = none,
                                        .mounting = none,
                                        .turn_angle = none,
                                        .initial_rest = none,
                                        .window = none,
                                        .minimum = none,
                                        .trim = none,
                                        .settle = none,
                                        .reference_temperature = none,
                                        .table_axis = -1};
}

/* ---- place and frame ------------------------------------------------------------------------- */

/* Gravity and the Earth's rotation. */
static imk_status set_place(imk_calibrate_log *b, imk_error *error)
{
    const imk_calibrate_log_settings *s = &b->settings;
    imk_calibration *c = b->calibration;
    if (s->place_known) {
        c->latitude = s->place.latitude;
        c->gravity = imk_normal_gravity(s->place.latitude, s->place.height);
    }
    if (!isnan(s->gravity)) {
        if (!(s->gravity > gravity_least && s->gravity < gravity_most)) {
            (void)imk_error_set(error, IMK_ERROR_RANGE, "gravity", NULL, "9.5 to 10.1 m/s^2");
            if (error)
                error->value = s->gravity;
            return IMK_ERROR_RANGE;
        }
        c->gravity = s->gravity;
    }
    if (s->no_earth)
        c->earth_rate = 0;
    return IMK_OK;
}

/* Forces on the accelerometers are known, and with them how the triad stands in the housing. */
static bool knows_force(imk_procedure procedure)
{
    return imk_procedure_is_known(procedure) && procedure != IMK_PROCEDURE_RATE_TABLE &&
           procedure != IMK_PROCEDURE_SPIN && procedure != IMK_PROCEDURE_TURNS;
}

static imk_status choose_frame(imk_calibrate_log *b, imk_error *error)
{
    bool known = false, force = false, gravity = false;
    for (size_t k = 0; k < b->count; k++) {
        known = known || imk_procedure_is_known(b->record[k].procedure);
        force = force || knows_force(b->record[k].procedure);
        gravity = gravity || b->record[k].procedure == IMK_PROCEDURE_MULTIPOSITION;
    }
    /* A table for the gyros and poses for the accelerometers: the poses fix the frame. */
    const bool reference = known && (force || !gravity);
    b->calibration->frame = b->settings.frame >= 0 ? (imk_triad_frame)b->settings.frame
                            : reference            ? IMK_FRAME_REFERENCE
                                                   : IMK_FRAME_UPPER;
    if (known || b->calibration->frame != IMK_FRAME_REFERENCE)
        return IMK_OK;
    return imk_error_set(error, IMK_ERROR_CONFLICT, "frame",
                         "gravity alone does not tell how the triad stands in the housing",
                         "add a record of sixposition, ferraris, tumble or rate-table, or choose "
                         "upper-triangular, lower-triangular or symmetric");
}

/* ---- procedures ------------------------------------------------------------------------------ */

static void set_if(double *target, double value)
{
    if (!isnan(value))
        *target = value;
}

static void switch_terms(unsigned terms, bool on, imk_procedure_settings *s)
{
    const struct {
        unsigned term;
        bool *target;
    } switches[] = {{IMK_CALIBRATE_NONLINEARITY, &s->nonlinear},
                    {IMK_CALIBRATE_CROSS_PRODUCTS, &s->cross_products},
                    {IMK_CALIBRATE_G_SENSITIVITY, &s->g_sensitivity},
                    {IMK_CALIBRATE_G2_SENSITIVITY, &s->g2_sensitivity},
                    {IMK_CALIBRATE_GYRO_TURNS, &s->gyro_turns}};
    for (size_t k = 0; k < sizeof switches / sizeof *switches; k++)
        if (terms & switches[k].term)
            *switches[k].target = on;
}

static imk_procedure_settings settings_of(const imk_calibrate_log *b, imk_procedure procedure)
{
    const imk_calibrate_log_settings *o = &b->settings;
    imk_procedure_settings s = imk_procedure_default(procedure);
    set_if(&s.stationary.initial_rest, o->initial_rest);
    set_if(&s.stationary.window, o->window);
    set_if(&s.stationary.minimum, o->minimum);
    set_if(&s.minimum, o->minimum);
    set_if(&s.placement_sigma, o->placement);
    set_if(&s.g_sensitivity_sigma, o->g_sensitivity_sigma);
    if (b->calibration->frame != IMK_FRAME_REFERENCE && imk_procedure_is_known(procedure))
        s.fixture_sigma = loose_mounting;
    set_if(&s.fixture_sigma, o->mounting);
    set_if(&s.turn_angle, o->turn_angle);
    set_if(&s.trim, o->trim);
    set_if(&s.settle, o->settle);
    set_if(&s.reference_temperature, o->reference_temperature);
    s.temperature_order = o->temperature_order;
    s.labelled_only = o->section != NULL;
    switch_terms(o->with, true, &s);
    switch_terms(o->without, false, &s);
    return s;
}

/* A setting that no procedure looks at was meant for another one. */
static imk_status check_used(const imk_calibrate_log *b, imk_error *error)
{
    const imk_calibrate_log_settings *s = &b->settings;
    bool has[IMK_PROCEDURES] = {false};
    for (size_t k = 0; k < b->count && !s->repeatability; k++)
        has[b->record[k].procedure] = true;
    const bool referenced = has[IMK_PROCEDURE_RATE_TABLE] || has[IMK_PROCEDURE_TUMBLE] ||
                            has[IMK_PROCEDURE_CENTRIFUGE] || has[IMK_PROCEDURE_SPIN];
    const bool magnetic = has[IMK_PROCEDURE_MAGNETOMETER] || has[IMK_PROCEDURE_MULTIPOSITION];
    const bool turned = has[IMK_PROCEDURE_TURNS] || has[IMK_PROCEDURE_FERRARIS];
    const bool thermal = has[IMK_PROCEDURE_THERMAL];
    const struct {
        const char *field;
        bool given, used;
        const char *by;
    } settings[] = {
        {"field", !isnan(s->field), magnetic, "multiposition and magnetometer"},
        {"dip", !isnan(s->dip), magnetic, "multiposition and magnetometer"},
        {"motion", s->motion != NULL, referenced || thermal,
         "rate-table, tumble, centrifuge, spin and thermal"},
        {"table_axis", s->table_axis >= 0, referenced, "rate-table"},
        {"turn_angle", !isnan(s->turn_angle), turned, "ferraris and turns"},
        {"temperature_order", s->temperature_order != 0, thermal, "thermal"},
        {"reference_temperature", !isnan(s->reference_temperature), thermal, "thermal"},
    };
    for (size_t k = 0; k < sizeof settings / sizeof settings[0]; k++)
        if (settings[k].given && !settings[k].used) {
            char only[80];
            snprintf(only, sizeof only, "only by %s: leave it out", settings[k].by);
            return imk_error_set(error, IMK_ERROR_CONFLICT, settings[k].field,
                                 "not used by the procedures of these records", only);
        }
    if (has[IMK_PROCEDURE_TURNS] && s->turn_angle <= 0)
        return imki_refuse(error, IMK_ERROR_RANGE, "turn_angle", s->turn_angle, 0,
                           "an angle above 0 with turns; a label such as \"z -90deg\" states which "
                           "way a turn goes, else each goes as its gyro reads");
    return IMK_OK;
}

/* Tables of means have no times; a log beside them may need them. */
static imk_status check_means(const imk_calibrate_log *b, imk_error *error)
{
    const imk_calibrate_log_settings *s = &b->settings;
    const struct {
        const char *field;
        double value;
    } times[] = {{"initial_rest", s->initial_rest},
                 {"window", s->window},
                 {"minimum", s->minimum},
                 {"trim", s->trim},
                 {"settle", s->settle}};
    bool tables = false, logs = s->repeatability;
    for (size_t k = 0; k < b->count; k++) {
        const bool means = imk_procedure_takes_means(b->record[k].procedure);
        tables = tables || means;
        logs = logs || !means;
    }
    if (!tables || s->repeatability)
        return imk_error_set(error, IMK_ERROR_CONFLICT, "pose_means",
                             "these procedures need every sample",
                             "only multiposition, sixposition and tumble take tables of means");
    for (size_t k = 0; !logs && k < sizeof times / sizeof times[0]; k++)
        if (!isnan(times[k].value))
            return imk_error_set(error, IMK_ERROR_CONFLICT, times[k].field,
                                 "a table of pose means has no times", "leave it out");
    return IMK_OK;
}

/* What is estimated must be left to choose. */
static imk_status check_terms(const imk_calibrate_log *b, imk_error *error)
{
    const imk_calibrate_log_settings *s = &b->settings;
    if (s->estimate && (s->with || s->without))
        return imk_error_set(error, IMK_ERROR_CONFLICT, "estimate",
                             "it names all terms to estimate",
                             "leave out what is to be estimated with or without them");
    for (size_t k = 0; s->estimate && k < b->count; k++)
        if (b->record[k].procedure == IMK_PROCEDURE_MAGNETOMETER)
            return imk_error_set(error, IMK_ERROR_CONFLICT, "estimate",
                                 "it names terms of gyros and accelerometers",
                                 "leave it out with magnetometer, which always estimates the same");
    if (s->closed_form &&
        (b->count != 1 || b->record[0].procedure != IMK_PROCEDURE_FERRARIS || s->repeatability))
        return imk_error_set(error, IMK_ERROR_CONFLICT, "closed_form",
                             "it solves one record of ferraris only",
                             "use maximum likelihood for other procedures and for several records");
    if (s->closed_form && (s->estimate || s->with || s->without))
        return imk_error_set(error, IMK_ERROR_CONFLICT, "closed_form",
                             "it always finds the same terms",
                             "leave out what is to be estimated, with them or without");
    return IMK_OK;
}

/* Numbers that there cannot be. */
static imk_status check_numbers(const imk_calibrate_log_settings *s, imk_error *error)
{
    const double right = 1.5707963267948966;
    if (s->place_known && !(fabs(s->place.latitude) <= right))
        return imki_refuse(error, IMK_ERROR_RANGE, "latitude", s->place.latitude, right,
                           "-90 to 90 deg");
    if (s->place_known && !(s->place.height >= -1e4 && s->place.height <= 1e5))
        return imki_refuse(error, IMK_ERROR_RANGE, "height", s->place.height, 1e5, "-10 to 100 km");
    if (!isnan(s->field) && !(s->field > 0 && s->field < 1e-3))
        return imki_refuse(error, IMK_ERROR_RANGE, "field", s->field, 1e-3,
                           "the field of the Earth, 22 to 67 uT");
    if (!isnan(s->dip) && !(fabs(s->dip) <= right))
        return imki_refuse(error, IMK_ERROR_RANGE, "dip", s->dip, right, "-90 to 90 deg");
    return IMK_OK;
}

imk_status imki_calibrate_set_up(imk_calibrate_log *b, const imk_procedure *procedure,
                                 imk_error *error)
{
    const imk_calibrate_log_settings *s = &b->settings;
    imk_status status = IMK_OK;
    imk_calibration_default(b->calibration);
    b->calibration->robust = !s->least_squares;
    for (size_t k = 0; k < b->count; k++) {
        if ((int)procedure[k] < 0 || procedure[k] >= IMK_PROCEDURES)
            return imk_error_set(error, IMK_ERROR_RANGE, "procedure", NULL, NULL);
        b->record[k].procedure = procedure[k];
    }
    if (s->pose_means)
        status = check_means(b, error);
    if (status == IMK_OK)
        status = check_terms(b, error);
    if (status == IMK_OK)
        status = check_used(b, error);
    if (status == IMK_OK)
        status = check_numbers(s, error);
    if (status == IMK_OK)
        status = set_place(b, error);
    if (status == IMK_OK)
        status = choose_frame(b, error);
    for (size_t k = 0; status == IMK_OK && k < b->count; k++)
        b->record[k].settings = settings_of(b, procedure[k]);
    return status;
}

/* ---- what is known before -------------------------------------------------------------------- */

static imk_status refuse(imk_calibrate_log *b, const char *code, int sensor, imk_error *error)
{
    return imki_fail(&b->findings, error, IMK_ERROR_ARGUMENT, code, imki_sensor_keys[sensor], 0,
                     NULL);
}

/* Numbers of a data sheet for the axes of a triad; false where they are of other axes. */
static bool take_counts(const imk_calibrate_counts *given, int axes, double *value)
{
    if (given->count > 1 && given->count != axes)
        return false;
    for (int i = 0; given->count > 0 && i < axes; i++)
        value[i] = given->value[given->count == 1 ? 0 : i];
    return true;
}

static imk_status apply_counts(imk_calibrate_log *b, int sensor, imk_error *error)
{
    const imk_calibrate_counts *sensitivity = &b->settings.sensitivity[sensor];
    imk_triad *triad = imk_model_triad_to_set(&b->calibration->model, sensor);
    const int axes = triad->axis_count;
    if (!take_counts(sensitivity, axes, triad->sensitivity.value) ||
        !take_counts(&b->settings.range[sensor], axes, triad->range.value) ||
        !take_counts(&b->settings.zero_offset[sensor], axes, triad->zero_offset.value))
        return imki_fail(&b->findings, error, IMK_ERROR_ARGUMENT, "counts_of_axes",
                         imki_sensor_keys[sensor], IMKI_NUMBERS(axes));
    for (int i = 0; i < axes; i++) {
        if (b->settings.range[sensor].count > 0 && !(triad->range.value[i] > 0))
            return refuse(b, "no_range", sensor, error);
        if (sensitivity->count > 0 && triad->sensitivity.value[i] == 0)
            return refuse(b, "no_sensitivity", sensor, error);
        if (triad->zero_offset.value[i] != 0 && triad->sensitivity.value[i] == 0)
            return refuse(b, "zero_of_nothing", sensor, error);
    }
    return IMK_OK;
}

/* Does the record name the axes of a sensor as the first record that has some? */
static bool names_same_axes(const imk_calibrate_log *b, int sensor, size_t index)
{
    const imk_calibrate_record *here = &b->record[index], *first = b->record;
    while (first->record.axis_count[sensor] == 0 && first < here)
        first++;
    for (int i = 0; i < here->record.axis_count[sensor]; i++)
        if (here->body_axis[sensor][i] != first->body_axis[sensor][i])
            return false;
    return true;
}

/* The axes that the records have of a sensor: all that have some have the same. */
static imk_status find_axes(imk_calibrate_log *b, int sensor, int *axes, bool *counts,
                            imk_error *error)
{
    *axes = 0, *counts = false;
    for (size_t k = 0; k < b->count; k++) {
        const imk_test_record *record = &b->record[k].record;
        const int here = record->axis_count[sensor];
        b->failed = k;
        if (here > 0 && *axes > 0 && here != *axes)
            return imki_fail(&b->findings, error, IMK_ERROR_COLUMN, "axes_differ",
                             imki_sensor_titles[sensor], IMKI_NUMBERS(here, *axes));
        if (!names_same_axes(b, sensor, k))
            return imki_fail(&b->findings, error, IMK_ERROR_COLUMN, "axes_named",
                             imki_sensor_titles[sensor], 0, NULL);
        if (here > 0 && *axes > 0 && *counts != record->counts[sensor])
            return imki_fail(&b->findings, error, IMK_ERROR_COLUMN, "counts_differ",
                             imki_sensor_titles[sensor], 0, NULL);
        *axes = here > 0 ? here : *axes;
        *counts = here > 0 ? record->counts[sensor] : *counts;
    }
    b->failed = 0;
    return IMK_OK;
}

/* Counts per unit say nothing about readings that have a unit. */
static imk_status check_counts(imk_calibrate_log *b, int sensor, bool counts, imk_error *error)
{
    const imk_calibrate_log_settings *s = &b->settings;
    if (counts || (s->sensitivity[sensor].count == 0 && s->zero_offset[sensor].count == 0))
        return IMK_OK;
    return imki_fail(&b->findings, error, IMK_ERROR_ARGUMENT, "not_in_counts",
                     imki_sensor_keys[sensor], IMKI_NUMBERS(s->sensitivity[sensor].count));
}

/* A record with gyro_z alone has one axis, which points along z. */
static void point_axes(imk_calibrate_log *b, int sensor, int axes, imk_triad *triad)
{
    const imk_calibrate_record *log = b->record;
    while (log < b->record + b->count - 1 && log->record.axis_count[sensor] == 0)
        log++;
    for (int i = 0; i < axes && i < 3; i++) {
        if (log->body_axis[sensor][i] == i)
            continue;
        for (int j = 0; j < 3; j++)
            triad->direction[i][j] = j == log->body_axis[sensor][i];
        char words[60];
        snprintf(words, sizeof words, "%s_%c\t%c", imki_sensor_keys[sensor],
                 imk_axis_letter(log->body_axis[sensor][i]), imk_axis_letter(i));
        imki_find(&b->findings, IMK_FINDING_NOTE, "axis_renamed", words, 0, NULL);
    }
}

/* Axes of the records; a model that is given must have them. */
static imk_status match_axes(imk_calibrate_log *b, int sensor, imk_error *error)
{
    int axes;
    bool counts;
    imk_triad *triad = imk_model_triad_to_set(&b->calibration->model, sensor);
    imk_status status = find_axes(b, sensor, &axes, &counts, error);
    if (status == IMK_OK && axes > 0)
        status = check_counts(b, sensor, counts, error);
    if (status != IMK_OK)
        return status;
    if (b->settings.model && axes > 0 && (!triad->present || triad->axis_count != axes)) {
        const int there = triad->present ? triad->axis_count : 0;
        return imki_fail(&b->findings, error, IMK_ERROR_CONFLICT, "axes_of_model",
                         imki_sensor_titles[sensor], IMKI_NUMBERS(there, axes));
    }
    if (!b->settings.model) {
        triad->present = axes > 0;
        triad->axis_count = axes > 0 ? axes : 3;
        for (int i = 3; i < axes; i++)
            triad->direction[i][i % 3] = 1;
        point_axes(b, sensor, axes, triad);
    }
    b->nominal[sensor] = counts && triad->sensitivity.value[0] == 0;
    return IMK_OK;
}

/* An axis that points up or down is then beyond its full scale. */
static void tell_small_range(imk_calibrate_log *b)
{
    const imk_triad *accel = &b->calibration->model.accel;
    for (int i = 0; i < accel->axis_count; i++) {
        const double range = accel->range.value[i];
        char name[48];
        if (!(range > 0 && range < b->calibration->gravity))
            continue;
        imk_axis_name("accel", i, name);
        imki_find(&b->findings, IMK_FINDING_WARNING, "range_below_gravity", name,
                  IMKI_NUMBERS(range));
        return;
    }
}

/* Where gravity is the reference, its amount is the scale of the accelerometers. */
static void tell_gravity(imk_calibrate_log *b)
{
    bool needed = false;
    for (size_t k = 0; k < b->count; k++)
        needed = needed || (b->record[k].record.axis_count[1] > 0 &&
                            b->record[k].procedure < IMK_PROCEDURE_RATE_TABLE);
    if (needed)
        tell_small_range(b);
    if (needed && !b->settings.place_known && isnan(b->settings.gravity))
        imki_find(&b->findings, IMK_FINDING_WARNING, "calibrate:gravity", NULL,
                  IMKI_NUMBERS(b->calibration->gravity));
    if (needed && b->settings.place_known && !isnan(b->settings.gravity)) {
        const double due = imk_normal_gravity(b->settings.place.latitude, b->settings.place.height);
        const double off = b->settings.gravity / due - 1;
        if (fabs(off) > gravity_anomaly)
            imki_find(&b->findings, IMK_FINDING_WARNING, "calibrate:gravity_of_place", NULL,
                      IMKI_NUMBERS(b->settings.gravity, due, 100 * off));
    }
}

/* Turns take no notice of accelerometers: they are none of these records. */
static void leave_out_accelerometers(imk_calibrate_log *b)
{
    for (size_t k = 0; k < b->count; k++) {
        imk_test_record *record = &b->record[k].record;
        if (b->record[k].procedure != IMK_PROCEDURE_TURNS || record->axis_count[IMK_GYRO] == 0 ||
            record->axis_count[IMK_ACCEL] == 0)
            continue;
        record->axis_count[IMK_ACCEL] = 0;
        imki_find(&b->findings, IMK_FINDING_NOTE, "turns_without_accel", b->record[k].path, 0,
                  NULL);
    }
}

imk_status imki_know_before(imk_calibrate_log *b, imk_error *error)
{
    imk_model *model = &b->calibration->model;
    imk_status status = IMK_OK;
    b->failed = b->count;
    leave_out_accelerometers(b);
    if (b->settings.model)
        *model = *b->settings.model;
    if (model->residual_of[0])
        return imki_fail(&b->findings, error, IMK_ERROR_CONFLICT, "model_of_residuals",
                         model->residual_of, 0, NULL);
    for (int sensor = 0; sensor < 2 && status == IMK_OK; sensor++)
        status = apply_counts(b, sensor, error);
    for (int sensor = 0; sensor < 2 && status == IMK_OK; sensor++)
        status = match_axes(b, sensor, error);
    if (status != IMK_OK)
        return status;
    b->failed = b->count;
    *b->before = *model;
    if (!b->settings.repeatability)
        tell_gravity(b);
    return IMK_OK;
}
