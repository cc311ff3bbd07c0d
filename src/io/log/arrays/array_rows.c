/* SPDX-License-Identifier: Apache-2.0 */
/* Values of any type as doubles. Times that are whole numbers are counted from the first one before
 * they become doubles: nanoseconds of an epoch have more digits than a double. */
#include "array_rows_internal.h"

#include <math.h>
#include <string.h>

/* One value, in the order of bytes of this machine. */
static void take(const unsigned char *at, size_t size, bool swapped, void *value)
{
    unsigned char bytes[8];
    for (size_t i = 0; i < size; i++)
        bytes[i] = at[swapped ? size - 1 - i : i];
    memcpy(value, bytes, size);
}

/* Whole numbers less the origin, modulo 2^64: the difference is right where it fits. */
#define WHOLE(type_name, type)                                                                     \
    case type_name:                                                                                \
        for (size_t i = 0; i < rows; i++, at += cell->step) {                                      \
            type value;                                                                            \
            take(at, sizeof value, cell->swapped, &value);                                         \
            out[i] = (double)((int64_t)value - origin) * factor;                                   \
        }                                                                                          \
        return

/* What 64 bits hold may be beyond what the origin can be subtracted from. */
static double signed_number(int64_t value, int64_t origin)
{
    return value == INT64_MIN && origin != 0
               ? (double)NAN /* "not a time" of NumPy, in which alone an origin is due */
               : (double)(int64_t)((uint64_t)value - (uint64_t)origin);
}

static double unsigned_number(uint64_t value, int64_t origin)
{
    return origin == 0 ? (double)value : (double)(int64_t)(value - (uint64_t)origin);
}

static void copy_cell(const imki_array_cell *cell, const unsigned char *at, int64_t origin,
                      double factor, double *out, size_t rows)
{
    switch (cell->type) {
    case IMKI_FLOAT64:
        for (size_t i = 0; i < rows; i++, at += cell->step) {
            double value;
            if (cell->swapped)
                take(at, sizeof value, true, &value);
            else
                memcpy(&value, at, sizeof value);
            out[i] = value * factor;
        }
        return;
    case IMKI_FLOAT32:
        for (size_t i = 0; i < rows; i++, at += cell->step) {
            float value;
            take(at, sizeof value, cell->swapped, &value);
            out[i] = (double)value * factor;
        }
        return;
        WHOLE(IMKI_INT8, int8_t);
        WHOLE(IMKI_UINT8, uint8_t);
        WHOLE(IMKI_INT16, int16_t);
        WHOLE(IMKI_UINT16, uint16_t);
        WHOLE(IMKI_INT32, int32_t);
        WHOLE(IMKI_UINT32, uint32_t);
    case IMKI_INT64:
        for (size_t i = 0; i < rows; i++, at += cell->step) {
            int64_t value;
            take(at, sizeof value, cell->swapped, &value);
            out[i] = signed_number(value, origin) * factor;
        }
        return;
    case IMKI_UINT64:
        for (size_t i = 0; i < rows; i++, at += cell->step) {
            uint64_t value;
            take(at, sizeof value, cell->swapped, &value);
            out[i] = unsigned_number(value, origin) * factor;
        }
        return;
    case IMKI_VALUE_TYPES:
        break;
    }
}

static bool is_missing(const imki_array_cell *cell, const unsigned char *at)
{
    const imki_coding *coding = cell->coding;
    uint64_t number;
    take(at, sizeof number, cell->swapped, &number);
    for (size_t i = 0; i < coding->missing_count; i++) {
        double real, none;
        memcpy(&real, &number, sizeof real);
        memcpy(&none, &coding->missing[i], sizeof none);
        if (cell->type == IMKI_FLOAT64 ? real == none : number == coding->missing[i])
            return true;
    }
    return false;
}

static bool is_scaled(const imki_array_cell *cell)
{
    return cell->coding && (cell->coding->factor != 1.0 || cell->coding->offset != 0.0);
}

/* Values for the numbers of a cell that are coded. */
static void give_cell(const imki_array_cell *cell, const unsigned char *at, int64_t origin,
                      double factor, double *out, size_t rows)
{
    const imki_coding *coding = cell->coding;
    copy_cell(cell, at, origin, is_scaled(cell) ? 1.0 : factor, out, rows);
    for (size_t i = 0; i < rows && coding; i++) {
        if (is_missing(cell, at + i * cell->step))
            out[i] = (double)NAN;
        else if (is_scaled(cell))
            out[i] = (out[i] * coding->factor + coding->offset) * factor;
    }
}

/* The first time, if it is a whole number that others can be counted from. */
static bool first_stamp(const imki_array_cell *cell, size_t rows, int64_t *first)
{
    if ((cell->type != IMKI_INT64 && cell->type != IMKI_UINT64) || is_scaled(cell))
        return false;
    size_t row = 0;
    while (cell->coding && row < rows && is_missing(cell, cell->at + row * cell->step))
        row++;
    if (row == rows)
        return false;
    take(cell->at + row * cell->step, sizeof *first, cell->swapped, first);
    return *first != INT64_MIN && (cell->type == IMKI_INT64 || *first >= 0);
}

imk_status imki_array_rows_begin(imk_log_reader *reader, imk_error *error)
{
    imki_array_rows *state = reader->state;
    const imki_log_layout_read *layout = &reader->layout;
    double time[2] = {(double)NAN, (double)NAN};
    const imk_status status = state->rows > 0 ? state->load(reader, error) : IMK_OK;
    if (status != IMK_OK)
        return status;
    for (size_t i = 0; i < layout->cell_count && state->rows > 0; i++) {
        const imki_array_cell *cell = &state->cell[i];
        if (layout->cell_column[i] < 0 || layout->cell_column[i] != layout->time_column)
            continue;
        const double per_second = 1.0 / layout->factor[layout->time_column];
        int64_t first;
        if (first_stamp(cell, state->at_hand, &first) && per_second >= 1.0 && per_second <= 1e12)
            state->origin = imki_log_stamp_origin(reader, first, (int64_t)llround(per_second));
        give_cell(cell, cell->at, state->origin, 1.0, time, state->at_hand < 2 ? 1 : 2);
    }
    return imki_log_first_rows(reader, state->rows, time, "the arrays have no rows",
                               "at least one row of numbers", error);
}

static void count_not_finite(imk_log_reader *reader, double *const *out, size_t rows)
{
    const imki_log_layout_read *layout = &reader->layout;
    for (size_t row = 0; row < rows; row++) {
        bool finite = true;
        for (size_t i = 0; i < layout->cell_count; i++)
            finite &= layout->cell_column[i] < 0 || isfinite(out[i][row]);
        if (!finite && reader->not_finite++ == 0)
            reader->first_not_finite = reader->rows + row + 1;
    }
}

imk_status imki_array_rows_read(imk_log_reader *reader, size_t max_rows, double *const *out,
                                size_t *rows, imk_error *error)
{
    imki_array_rows *state = reader->state;
    const imki_log_layout_read *layout = &reader->layout;
    *rows = 0;
    if (state->next >= state->rows)
        return IMK_OK;
    if (state->next < state->begin || state->next >= state->begin + state->at_hand) {
        state->begin = state->next;
        state->at_hand = 0;
        const imk_status status = state->load(reader, error);
        if (status != IMK_OK)
            return status;
    }
    const size_t skipped = (size_t)(state->next - state->begin);
    const size_t there = state->at_hand - skipped;
    const size_t count = there < max_rows ? there : max_rows;
    for (size_t i = 0; i < layout->cell_count; i++) {
        const imki_array_cell *cell = &state->cell[i];
        if (layout->cell_column[i] >= 0)
            give_cell(cell, cell->at + skipped * cell->step,
                      layout->cell_column[i] == layout->time_column ? state->origin : 0,
                      layout->cell_factor[i], out[i], count);
    }
    count_not_finite(reader, out, count);
    state->next += count;
    *rows = count;
    return IMK_OK;
}

imk_status imki_array_rows_seek(imk_log_reader *reader, double fraction, imk_error *error)
{
    imki_array_rows *state = reader->state;
    const uint64_t row = (uint64_t)(fraction * (double)state->rows);
    (void)error;
    state->next = row < state->rows ? row : state->rows;
    return IMK_OK;
}

void imki_array_rows_progress(const imk_log_reader *reader, uint64_t *done, uint64_t *size)
{
    const imki_array_rows *state = reader->state;
    *done = state->next * reader->layout.cell_count;
    *size = state->rows * reader->layout.cell_count;
}
