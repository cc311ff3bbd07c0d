/* SPDX-License-Identifier: Apache-2.0 */
/* Blocks of rows: read, moved, written. Rows that are not ready yet wait at the head of the buffers
 * for the next block. */
#include "imukit/convert_log.h"

#include "convert_motion_internal.h"
#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"
#include "jobs/record/even_record_internal.h"
#include "jobs/record/record_check_internal.h"

#include "imukit/names.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const uint32_t settings_cookie = 0x434F4E31; /* "CON1" */

imk_convert_log_settings imk_convert_log_default(void)
{
    return (imk_convert_log_settings){
        .cookie = settings_cookie, .still = 10, .latitude = (double)NAN};
}

enum { BLOCK_ROWS = 65536 };

typedef struct conversion {
    const imk_record_source *source;
    const imk_convert_log_settings *settings;
    const imk_record_sink *sink;
    const imk_job *job;
    imk_findings *findings;
    size_t count; /* of columns that are written */
    size_t from[IMK_LOG_COLUMNS_MAX];
    imk_log_column column[IMK_LOG_COLUMNS_MAX];
    double *data[IMK_LOG_COLUMNS_MAX]; /* of the source's columns */
    size_t capacity;                   /* rows */
    imki_convert_motion motion;
} conversion;

/* ---- columns ---- */

static imk_status refuse_name(const conversion *c, const char *item, size_t length,
                              imk_error *error)
{
    const char *names[IMK_LOG_COLUMNS_MAX];
    char name[64], both[128];
    for (size_t k = 0; k < c->source->column_count; k++)
        names[k] = c->source->columns[k].name;
    snprintf(name, sizeof name, "%.*s", (int)(length < 60 ? length : 60), item);
    const size_t near = imk_nearest_name(name, c->source->column_count, names);
    snprintf(both, sizeof both, "%s\t%s", name, near < SIZE_MAX ? names[near] : "");
    return imki_fail(c->findings, error, IMK_ERROR_COLUMN, "no_such_column", both,
                     IMKI_NUMBERS(near < SIZE_MAX));
}

static imk_status select_columns(conversion *c, imk_error *error)
{
    const imk_record_source *source = c->source;
    for (size_t k = 0; !c->settings->select && k < source->column_count; k++)
        c->from[c->count++] = k;
    for (const char *item = c->settings->select; item;) {
        const size_t length = strcspn(item, ",");
        size_t k = 0;
        while (k < source->column_count && (strlen(source->columns[k].name) != length ||
                                            strncmp(source->columns[k].name, item, length) != 0))
            k++;
        if (k == source->column_count || c->count == IMK_LOG_COLUMNS_MAX)
            return refuse_name(c, item, length, error);
        c->from[c->count++] = k;
        item = item[length] ? item + length + 1 : NULL;
    }
    for (size_t k = 0; k < c->count; k++)
        c->column[k] = source->columns[c->from[k]];
    return IMK_OK;
}

/* Increments were divided by the interval on reading: name and unit follow. */
static void make_rate(imk_log_column *column)
{
    const bool gyro = column->quantity == IMK_QUANTITY_ANGULAR_RATE;
    if (!column->increment)
        return;
    column->increment = false;
    column->unit = imk_unit_of(gyro ? "deg/s" : "m/s^2");
    if (column->axis >= 0 && column->axis < 3)
        imk_axis_name(gyro ? "gyro" : "accel", column->axis, column->name);
}

static imk_status set_units(conversion *c, imk_error *error)
{
    const imk_convert_log_settings *s = c->settings;
    const struct {
        imk_quantity quantity;
        const char *field;
        const imk_unit *unit;
    } asked[] = {{IMK_QUANTITY_TIME, "time-unit", &s->time_unit},
                 {IMK_QUANTITY_ANGULAR_RATE, "gyro-unit", &s->gyro_unit},
                 {IMK_QUANTITY_SPECIFIC_FORCE, "accel-unit", &s->accel_unit},
                 {IMK_QUANTITY_TEMPERATURE, "temperature-unit", &s->temperature_unit}};
    imk_status status = IMK_OK;
    for (size_t k = 0; k < c->count; k++) {
        make_rate(&c->column[k]);
        for (size_t i = 0; i < sizeof asked / sizeof asked[0] && status == IMK_OK; i++)
            if (c->column[k].quantity == asked[i].quantity && asked[i].unit->scale > 0) {
                status = imki_check_unit(asked[i].unit, c->column[k].unit.dimension, asked[i].field,
                                         error);
                c->column[k].unit = *asked[i].unit;
            }
    }
    return status;
}

/* ---- rows ---- */

static imk_status begin_sink(const conversion *c, imk_error *error)
{
    int decimals[IMK_LOG_COLUMNS_MAX];
    for (size_t k = 0; k < c->count; k++)
        decimals[k] = -1;
    const imk_status status =
        c->sink->begin(c->sink->context, c->count, c->column, decimals, 0, error);
    if (status == IMK_OK && c->sink->labels)
        c->sink->labels(c->sink->context, c->source);
    return imki_written(c->findings, status);
}

/* Room for a block behind what waits. */
static imk_status reserve(conversion *c, imk_error *error)
{
    const size_t rows = c->motion.stored + BLOCK_ROWS;
    for (size_t k = 0; k < c->source->column_count && rows > c->capacity; k++) {
        double *grown = imki_resize(&c->job->allocator, c->data[k], rows * sizeof *grown);
        if (!grown)
            return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
        c->data[k] = grown;
    }
    c->capacity = rows > c->capacity ? rows : c->capacity;
    return IMK_OK;
}

static imk_status read_block(conversion *c, size_t *got, imk_error *error)
{
    const imk_record_source *source = c->source;
    imki_convert_motion *m = &c->motion;
    double *place[IMK_LOG_COLUMNS_MAX];
    imk_status status = reserve(c, error);
    for (size_t k = 0; k < source->column_count; k++)
        place[k] = c->data[k] + m->stored;
    if (status == IMK_OK)
        status = source->read(source->context, BLOCK_ROWS, place, got, error);
    if (status != IMK_OK)
        return status;
    if (m->interval == 0) {
        imk_log_findings found;
        status = imki_source_findings(source, *got, place, &c->job->allocator, &found, error);
        m->interval = found.interval;
    }
    if (status != IMK_OK)
        return status;
    if (!(m->interval > 0)) /* a single row has none, and no use for it */
        m->interval = 1;
    m->stored += *got;
    m->over = *got == 0;
    return imki_convert_motion_rows(m, error);
}

/* The rows that are ready; the others move to the head. */
static imk_status write_block(conversion *c, imk_error *error)
{
    imki_convert_motion *m = &c->motion;
    const size_t ready = m->ready;
    const double *written[IMK_LOG_COLUMNS_MAX];
    if (ready == 0)
        return IMK_OK;
    for (size_t k = 0; k < c->count; k++)
        written[k] = c->data[c->from[k]];
    const imk_status status =
        c->sink->write(c->sink->context, ready, written, c->job->executor, error);
    for (size_t k = 0; k < c->source->column_count; k++)
        memmove(c->data[k], c->data[k] + ready, (m->stored - ready) * sizeof(double));
    m->stored -= ready;
    m->moved -= ready;
    m->ready = 0;
    return imki_written(c->findings, status);
}

static imk_status convert(conversion *c, imk_error *error)
{
    const imk_record_source *source = c->source;
    imk_status status = begin_sink(c, error);
    uint64_t total = 0, at = 0, size = 0;
    for (size_t got = 1; status == IMK_OK && got > 0;) {
        status = read_block(c, &got, error);
        total += status == IMK_OK ? got : 0;
        if (status == IMK_OK)
            status = write_block(c, error);
        if (source->progress)
            source->progress(source->context, &at, &size);
        if (status == IMK_OK)
            status = imki_job_progress(c->job, "converting", "B", at, size, error);
    }
    if (status == IMK_OK && total == 0)
        status = imki_fail(c->findings, error, IMK_ERROR_EMPTY, "no_rows", NULL, 0, NULL);
    if (status == IMK_OK)
        imki_tell_damage(source, c->findings);
    imki_convert_motion_warn(&c->motion);
    return status;
}

imk_status imk_convert_log_run(const imk_record_source *source,
                               const imk_convert_log_settings *settings,
                               const imk_record_sink *sink, const imk_job *job,
                               imk_findings *findings, imk_error *error)
{
    imk_findings unheard = {.count = 0};
    imk_status status =
        imki_check_call(&unheard, settings, settings_cookie, "imk_convert_log_default()", error);
    if (status == IMK_OK)
        status = imki_check_source(source, error);
    if (status == IMK_OK)
        status = imki_check_sink(sink, error);
    if (status != IMK_OK)
        return status;
    conversion c = {.source = source,
                    .settings = settings,
                    .sink = sink,
                    .job = imki_job_of(job),
                    .findings = findings ? findings : &unheard};
    c.motion = (imki_convert_motion){.settings = settings, .findings = c.findings, .data = c.data};
    c.findings->count = 0;
    status = select_columns(&c, error);
    if (status == IMK_OK && !settings->select) /* what is selected is known by its name */
        imki_tell_unused(source->column_count, source->columns, IMK_KINDS, c.findings);
    if (status == IMK_OK)
        imki_tell_not_turned(source, c.count, c.column, c.findings);
    if (status == IMK_OK)
        status = set_units(&c, error);
    if (status == IMK_OK && (settings->to_point || settings->gravity_free))
        status = imki_convert_motion_start(&c.motion, source, error);
    if (status == IMK_OK)
        status = convert(&c, error);
    for (size_t k = 0; k < source->column_count; k++)
        imki_resize(&c.job->allocator, c.data[k], 0);
    return status;
}
