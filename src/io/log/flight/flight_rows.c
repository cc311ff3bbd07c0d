/* SPDX-License-Identifier: Apache-2.0 */
/* From messages of a flight log to rows. */
#include "flight_log_internal.h"

#include <math.h>
#include <string.h>

size_t imki_flight_size(imki_flight_type type)
{
    static const unsigned char sizes[] = {
        [IMKI_FLIGHT_NONE] = 0,   [IMKI_FLIGHT_INT8] = 1,   [IMKI_FLIGHT_UINT8] = 1,
        [IMKI_FLIGHT_INT16] = 2,  [IMKI_FLIGHT_UINT16] = 2, [IMKI_FLIGHT_INT32] = 4,
        [IMKI_FLIGHT_UINT32] = 4, [IMKI_FLIGHT_INT64] = 8,  [IMKI_FLIGHT_UINT64] = 8,
        [IMKI_FLIGHT_FLOAT] = 4,  [IMKI_FLIGHT_DOUBLE] = 8};
    return sizes[type];
}

#define READ(ctype, result)                                                                        \
    do {                                                                                           \
        ctype value;                                                                               \
        memcpy(&value, place, sizeof value);                                                       \
        return (result)value;                                                                      \
    } while (0)

/* Inline where rows are made: a call for each number would double their time. */
static inline double number_at(imki_flight_type type, const char *place)
{
    switch (type) {
    case IMKI_FLIGHT_FLOAT:
        READ(float, double);
    case IMKI_FLIGHT_INT16:
        READ(int16_t, double);
    case IMKI_FLIGHT_UINT16:
        READ(uint16_t, double);
    case IMKI_FLIGHT_INT32:
        READ(int32_t, double);
    case IMKI_FLIGHT_UINT32:
        READ(uint32_t, double);
    case IMKI_FLIGHT_DOUBLE:
        READ(double, double);
    case IMKI_FLIGHT_INT64:
        READ(int64_t, double);
    case IMKI_FLIGHT_UINT64:
        READ(uint64_t, double);
    case IMKI_FLIGHT_INT8:
        READ(int8_t, double);
    case IMKI_FLIGHT_UINT8:
        READ(uint8_t, double);
    case IMKI_FLIGHT_NONE:
        break;
    }
    return (double)NAN;
}

static inline uint64_t whole_at(imki_flight_type type, const char *place)
{
    switch (type) {
    case IMKI_FLIGHT_INT8:
        READ(int8_t, uint64_t);
    case IMKI_FLIGHT_UINT8:
        READ(uint8_t, uint64_t);
    case IMKI_FLIGHT_INT16:
        READ(int16_t, uint64_t);
    case IMKI_FLIGHT_UINT16:
        READ(uint16_t, uint64_t);
    case IMKI_FLIGHT_INT32:
        READ(int32_t, uint64_t);
    case IMKI_FLIGHT_UINT32:
        READ(uint32_t, uint64_t);
    case IMKI_FLIGHT_INT64:
    case IMKI_FLIGHT_UINT64:
        READ(uint64_t, uint64_t);
    case IMKI_FLIGHT_NONE:
    case IMKI_FLIGHT_FLOAT:
    case IMKI_FLIGHT_DOUBLE:
        break;
    }
    return 0;
}

double imki_flight_number(const imki_flight_field *field, const char *body, size_t index)
{
    return number_at(field->type, body + field->place + index * imki_flight_size(field->type));
}

uint64_t imki_flight_whole(const imki_flight_field *field, const char *body)
{
    return whole_at(field->type, body + field->place);
}

imki_flight_message imki_flight_message_of(const imki_flight_plan *plan, size_t stream,
                                           const char *body, size_t size)
{
    imki_flight_message m = {.size = size, .stream = stream, .body = body, .rows = 1, .rate = 1};
    m.stamp = imki_flight_whole(&plan->stamp, body);
    if (m.stamp == 0)
        m.stamp = imki_flight_whole(&plan->stamp_else, body);
    m.stamp *= plan->stamp_unit;
    if (plan->samples.type != IMKI_FLIGHT_NONE) {
        const uint64_t samples = imki_flight_whole(&plan->samples, body);
        const size_t most = plan->cell[0].value.count;
        m.arrays = true;
        m.rows = samples < most ? (size_t)samples : most;
        m.first = 1 - (double)m.rows;
        m.step = imki_flight_number(&plan->interval, body, 0);
        m.scale = imki_flight_number(&plan->scale, body, 0);
        m.divisor = 1;
    }
    return m;
}

double imki_flight_offset(const imki_flight_message *m, size_t row)
{
    return m->arrays ? (m->first + (double)row) * m->step / m->rate : 0;
}

static inline double value_of(const imki_flight_cell *cell, const imki_flight_message *m,
                              size_t row)
{
    const char *place = m->body + cell->value.place;
    if (m->arrays) {
        place += row * imki_flight_size(cell->value.type);
        return number_at(cell->value.type, place) * m->scale / m->divisor;
    }
    double value = number_at(cell->value.type, place) * cell->factor;
    if (cell->divisor.type != IMKI_FLIGHT_NONE) {
        const double divisor = number_at(cell->divisor.type, m->body + cell->divisor.place);
        value = divisor > 0 ? value / divisor : (double)NAN;
    }
    if (cell->marked && whole_at(cell->mark.type, m->body + cell->mark.place) == INT32_MAX)
        value = (double)NAN;
    return value;
}

double imki_flight_value(const imki_flight_cell *cell, const imki_flight_message *m, size_t row)
{
    return value_of(cell, m, row);
}

/* Rows `from` … `from + count - 1` of a message become rows `at` … of the call. */
static void give(imk_log_reader *reader, const imki_flight_message *m, size_t from, size_t count,
                 double *const *out, size_t at)
{
    const imki_flight_log *log = reader->state;
    const imki_flight_plan *plan = &log->plan;
    const double *factor = reader->layout.cell_factor;
    const double stamp = (double)(int64_t)(m->stamp - log->origin);
    for (size_t row = 0; row < count; row++) {
        bool finite = true;
        const double time = stamp + imki_flight_offset(m, from + row);
        finite &= (bool)isfinite(time);
        out[0][at + row] = time;
        for (size_t i = 0; i < plan->cell_count; i++) {
            const double value = value_of(&plan->cell[i], m, from + row) * factor[i + 1];
            finite &= (bool)isfinite(value);
            out[i + 1][at + row] = value;
        }
        if (!finite && reader->not_finite++ == 0)
            reader->first_not_finite = reader->rows + at + row + 1;
    }
}

imk_status imki_flight_read(imk_log_reader *reader, size_t max_rows, double *const *out,
                            size_t *rows, imk_error *error)
{
    imki_flight_log *log = reader->state;
    imki_flight_message m;
    *rows = 0;
    while (*rows < max_rows) {
        log->rows = *rows;
        const imk_status status = log->next(reader, &m, error);
        if (status != IMK_OK || m.size == 0)
            return status;
        if (m.stream == log->chosen && log->row < m.rows) {
            const size_t left = m.rows - log->row, room = max_rows - *rows;
            const size_t count = left < room ? left : room;
            give(reader, &m, log->row, count, out, *rows);
            if (log->row == 0 && log->idle.column[0])
                reader->later[2] += isfinite(value_of(&log->idle, &m, 0)) != 0;
            *rows += count;
            log->row += count;
            if (log->row < m.rows)
                return IMK_OK;
        }
        log->row = 0;
        reader->text.next += m.size;
    }
    return IMK_OK;
}
