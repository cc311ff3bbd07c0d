/* SPDX-License-Identifier: Apache-2.0 */
/* A record of aids as readings, each kind for itself, on the clock of the log that is navigated. */
#include "aid_columns_internal.h"
#include "navigate_aids_internal.h"

#include "jobs/record/even_record_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double half_turn = 3.14159265358979323846;

/* One kind of the record. */
typedef struct columns_of_kind {
    const imk_log *log;
    const imki_aid_columns *columns;
    imki_aid_role value, sigma; /* ROLES: there are none */
    size_t axes;                /* read from columns */
    imk_geodetic place;         /* where local positions count from */
    imk_matrix3 axes_there;
    imk_vector3 there;
} columns_of_kind;

static double number(const columns_of_kind *k, imki_aid_role first, size_t axis, size_t row)
{
    const int column = k->columns->column[(size_t)first + axis];
    return column >= 0 ? k->columns->sign[(size_t)first + axis] * k->log->data[column][row]
                       : (double)NAN;
}

/* ---- one row -------------------------------------------------------------------------------- */

/* @return false: it is no place */
static bool place_of(const columns_of_kind *k, double value[3])
{
    if (k->value == IMKI_AID_GEODETIC) {
        if (isnan(value[2]))
            value[2] = k->place.height;
        return fabs(value[0]) <= 0.5 * half_turn && fabs(value[1]) <= 2.0 * half_turn;
    }
    imk_vector3 position = {{value[0], value[1], isnan(value[2]) ? 0.0 : value[2]}};
    if (k->value == IMKI_AID_LOCAL)
        position = imk_vector3_add(k->there, imk_matrix3_apply(k->axes_there, position));
    const double distance = imk_vector3_norm(position);
    const imk_geodetic place = imk_geodetic_from_ecef(position);
    value[0] = place.latitude;
    value[1] = place.longitude;
    value[2] = place.height;
    return distance > 6e6 && distance < 1e7;
}

typedef enum row_kind { NOTHING, HELD, FAULTY, READING } row_kind;

/* @param stated  its sigmas are used where there are no columns of them */
static row_kind read_row(const columns_of_kind *k, const imk_aid *stated, size_t row,
                         imk_aid_reading *reading)
{
    bool same = row > 0;
    *reading = (imk_aid_reading){.time = k->log->data[k->columns->time][row]};
    for (size_t axis = 0; axis < k->axes; axis++) {
        double *value = &reading->value[axis];
        *value = number(k, k->value, axis, row);
        const bool needed = axis < 2;
        if (isnan(*value) && needed)
            return NOTHING;
        if (isnan(*value) || isinf(stated->sigma[axis]))
            reading->sigma[axis] = (double)INFINITY;
        else if (k->sigma < IMKI_AID_ROLES)
            reading->sigma[axis] = number(k, k->sigma, axis, row);
        if (isinf(*value) || (reading->sigma[axis] != 0.0 && !(reading->sigma[axis] > 0.0)) ||
            (k->sigma < IMKI_AID_ROLES && reading->sigma[axis] == 0.0))
            return FAULTY;
        const double before = same ? number(k, k->value, axis, row - 1) : (double)NAN;
        same = same && (before == *value || (isnan(before) && isnan(*value)));
    }
    if (!isfinite(reading->time))
        return FAULTY;
    if (stated->kind == IMK_AID_POSITION && !place_of(k, reading->value))
        return FAULTY;
    return same ? HELD : READING;
}

/* Values that stay between readings, as where a table is of a faster sensor: most runs of the same
 * values are longer than one row. A place at rest is one run, however long. */
static bool are_held(const columns_of_kind *k, const imk_aid *stated)
{
    size_t runs = 0, longer = 0, length = 0;
    imk_aid_reading reading;
    for (size_t row = 0; row < k->log->rows; row++) {
        const row_kind kind = read_row(k, stated, row, &reading);
        if (kind == READING) {
            longer += length > 1;
            runs++;
            length = 0;
        }
        length += kind == READING || kind == HELD;
    }
    longer += length > 1;
    return runs >= 4 && 2 * longer > runs;
}

/* ---- one kind ------------------------------------------------------------------------------- */

/* From the times of the aids to those of the log [s]. */
static double time_offset(const imk_navigate_log *n, const imk_log *aids)
{
    const imk_log_findings *a = &aids->findings, *l = &n->record.log.findings;
    const bool exact = (a->time_origin == 0.0 || a->time_origin_nanoseconds != 0) &&
                       (l->time_origin == 0.0 || l->time_origin_nanoseconds != 0);
    const double origin =
        exact ? 1e-9 * (double)(a->time_origin_nanoseconds - l->time_origin_nanoseconds)
              : a->time_origin - l->time_origin;
    return origin - n->settings.aid_delay;
}

static imk_status fill_series(imk_navigate_log *n, const columns_of_kind *k, imk_navigate_aid *made,
                              imki_aid_series *series, imki_arena *scratch, imk_error *error)
{
    const double offset = time_offset(n, k->log), interval = n->settings.aid_interval;
    double last = -(double)INFINITY;
    series->reading = imki_arena_room(scratch, (k->log->rows + 1) * sizeof *series->reading);
    if (!series->reading)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    made->held = are_held(k, &made->aid);
    for (size_t row = 0; row < k->log->rows; row++) {
        imk_aid_reading reading;
        const row_kind kind = read_row(k, &made->aid, row, &reading);
        if (kind == NOTHING || (kind == HELD && made->held))
            continue;
        made->readings++;
        reading.time += offset;
        if (kind == FAULTY) {
            made->skipped++;
        } else if (!(reading.time > last)) {
            made->disordered++;
        } else if (reading.time < last + interval * (1.0 - 1e-6)) {
            made->skipped++;
        } else {
            last = reading.time;
            series->reading[series->count++] = reading;
        }
    }
    return IMK_OK;
}

static bool has_arm(const imk_aid *aid)
{
    bool any = false;
    for (int i = 0; i < 3; i++)
        any = any || aid->lever_arm[i] != 0.0 || aid->lever_arm_sigma[i] > 0.0;
    return any;
}

/* What is stated of a kind, or its defaults where the sigmas are columns.
 * @return false: neither, so the kind is not used */
static bool describe_kind(const imk_navigate_log *n, imk_aid_kind kind, columns_of_kind *k,
                          imk_navigate_aid *made)
{
    const imk_navigate_log_settings *s = &n->settings;
    const imki_aid_role sigma = imki_aid_sigmas_of(k->columns, kind);
    k->sigma = IMKI_AID_ROLES;
    *made = (imk_navigate_aid){.aid = imk_aid_default(kind), .first = (double)NAN};
    made->last = (double)NAN;
    for (int i = 0; i < 3; i++)
        made->last_off[i] = made->last_sigma[i] = (double)NAN;
    made->sigma_columns = true;
    for (size_t i = 0; i < s->aid_count; i++)
        if (s->aid[i].kind == kind) {
            made->aid = s->aid[i];
            made->sigma_columns = false;
        }
    if (made->sigma_columns && sigma == IMKI_AID_ROLES)
        return false;
    if (made->sigma_columns)
        k->sigma = sigma;
    if (kind != IMK_AID_HEADING && !has_arm(&made->aid))
        for (int i = 0; i < 3; i++) {
            const bool odometer = kind == IMK_AID_ODOMETER;
            made->aid.lever_arm[i] = odometer ? s->speed_lever_arm[i] : s->lever_arm[i];
            made->aid.lever_arm_sigma[i] = odometer ? 0.0 : s->lever_arm_sigma[i];
        }
    return true;
}

/* Few readings out of order are left out; where most are, what remains is not the table. */
static imk_status fail_order(imk_navigate_log *n, imk_aid_kind kind, const imk_navigate_aid *made,
                             imk_error *error)
{
    return imki_fail(&n->findings, error, IMK_ERROR_TIME_ORDER, "aid_order",
                     imk_aid_kind_name(kind),
                     IMKI_NUMBERS((double)made->disordered, (double)made->readings));
}

/* @param left  the name of a kind that has no sigma */
static imk_status load_kind(imk_navigate_log *n, imk_aid_kind kind, columns_of_kind *k,
                            imki_navigate_aids *aids, imki_arena *scratch, const char **left,
                            imk_error *error)
{
    imk_navigate_aid *made = &n->aid[n->aid_count];
    bool stated = false;
    for (size_t i = 0; i < n->settings.aid_count; i++)
        stated = stated || n->settings.aid[i].kind == kind;
    k->value = imki_aid_columns_of(k->columns, kind);
    if (k->value == IMKI_AID_ROLES)
        return stated ? imki_fail(&n->findings, error, IMK_ERROR_COLUMN, "aid_no_column",
                                  imk_aid_kind_name(kind), 0, NULL)
                      : IMK_OK;
    if (!describe_kind(n, kind, k, made)) {
        *left = imk_aid_kind_name(kind);
        imki_aid_find(n, IMK_FINDING_NOTE, "aid_not_used", *left, 0, NULL);
        return IMK_OK;
    }
    k->axes = kind == IMK_AID_POSITION || kind == IMK_AID_VELOCITY ? 3 : 1;
    if (k->axes == 3 && k->columns->column[(size_t)k->value + 2] < 0)
        made->aid.sigma[2] = (double)INFINITY;
    imk_status status = imki_aid_columns_check(k->log->column, k->columns, kind,
                                               made->sigma_columns, &n->findings, error);
    if (status == IMK_OK)
        status = fill_series(n, k, made, &aids->series[n->aid_count], scratch, error);
    if (status == IMK_OK && 2 * made->disordered > made->readings)
        status = fail_order(n, kind, made, error);
    n->aid_count += status == IMK_OK;
    return status;
}

/* ---- all ------------------------------------------------------------------------------------ */

static imk_status load_kinds(imk_navigate_log *n, const imk_log *log, imki_navigate_aids *aids,
                             imki_arena *scratch, imk_error *error)
{
    imki_aid_columns columns;
    imki_aid_columns_find(log->column_count, log->column, &columns);
    if (columns.time < 0)
        return imki_fail(&n->findings, error, IMK_ERROR_COLUMN, "aid_no_time", NULL, 0, NULL);
    columns_of_kind k = {.log = log, .columns = &columns, .place = n->settings.place};
    k.axes_there = imk_ned_axes(k.place.latitude, k.place.longitude);
    k.there = imk_ecef_from_geodetic(k.place);
    imk_status status = IMK_OK;
    const char *left = NULL;
    for (int kind = 0; kind < IMK_AID_KIND_COUNT && status == IMK_OK; kind++)
        if (kind != IMK_AID_ZERO_VELOCITY)
            status = load_kind(n, (imk_aid_kind)kind, &k, aids, scratch, &left, error);
    if (status == IMK_OK && n->aid_count == 0)
        status = imki_fail(&n->findings, error, IMK_ERROR_COLUMN,
                           left ? "aid_no_sigma" : "aid_nothing", left, 0, NULL);
    return status;
}

/* Nothing within the log: other clocks, most likely. */
static imk_status check_times(imk_navigate_log *n, const imki_navigate_aids *aids, imk_error *error)
{
    const double begin = imki_navigate_row_time(n, 0);
    const double end = imki_navigate_row_time(n, n->record.rows - 1);
    double first = (double)INFINITY, last = -(double)INFINITY;
    size_t within = 0, all = 0;
    for (size_t k = 0; k < n->aid_count; k++) {
        const imki_aid_series *s = &aids->series[k];
        for (size_t i = 0; i < s->count; i++)
            within += s->reading[i].time >= begin && s->reading[i].time <= end;
        all += s->count;
        if (s->count > 0) {
            first = fmin(first, s->reading[0].time);
            last = fmax(last, s->reading[s->count - 1].time);
        }
    }
    if (within > 0)
        return IMK_OK;
    return all == 0 ? imki_fail(&n->findings, error, IMK_ERROR_EMPTY, "aid_empty", NULL, 0, NULL)
                    : imki_fail(&n->findings, error, IMK_ERROR_EMPTY, "aid_other_clock", NULL,
                                IMKI_NUMBERS(first, last, begin, end));
}

imk_status imki_aids_load(imk_navigate_log *n, const imk_job *job, imki_arena *scratch,
                          imki_navigate_aids *aids, imk_error *error)
{
    imk_log log;
    memset(aids, 0, sizeof *aids);
    imk_status status = imki_record_load(n->settings.aids, job, &log, error);
    if (status != IMK_OK)
        return imki_fail(&n->findings, error, status, "aid_unreadable", NULL,
                         IMKI_NUMBERS((double)status));
    if (log.findings.damaged > 0)
        imki_find(&n->findings, IMK_FINDING_WARNING, "aid_damaged", n->settings.aids_name,
                  IMKI_NUMBERS((double)log.findings.damaged));
    status = load_kinds(n, &log, aids, scratch, error);
    if (status == IMK_OK)
        status = check_times(n, aids, error);
    imk_log_free(&log);
    return status;
}
