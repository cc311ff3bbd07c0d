/* SPDX-License-Identifier: Apache-2.0 */
/* Plain CSV rows to numbers, a few nanoseconds per cell: what is the same for every instruction
 * set. The including file defines before
 *
 *     KERNEL_TARGET  attribute that allows the instructions, or nothing
 *     mark_ends()    64 bytes -> a bit for each separator and newline
 *     count_bits()   how many bits are set
 *     read_number()  a cell -> a finite number
 *
 * First the places of all separators and line ends in some kilobytes of text, 64 bytes at a time;
 * so the cells do not wait for each other. Then each cell by itself. */
#ifndef IMUKIT_LOG_CELLS_KERNEL_H
#define IMUKIT_LOG_CELLS_KERNEL_H

enum {
    CHUNK = 8192,    /* text indexed at a time: with its index it stays in the first cache */
    INDEX_SLACK = 64 /* the index is written in groups of eight beyond its end */
};

/* Offsets of separators and newlines. @return how many */
KERNEL_TARGET static size_t index_ends(const char *text, size_t size, char separator,
                                       uint16_t *ends)
{
    size_t count = 0, at = 0;
    for (; at + 64 <= size; at += 64) {
        uint64_t marks = mark_ends(text + at, separator);
        const size_t here = count_bits(marks);
        /* Always eight at a time: how many there are cannot be predicted, groups of eight can. */
        for (size_t done = 0; done < here; done += 8)
            for (size_t i = 0; i < 8; i++) {
                ends[count + done + i] =
                    (uint16_t)(at + (size_t)__builtin_ctzll(marks | UINT64_C(1) << 63));
                marks &= marks - 1;
            }
        count += here;
    }
    for (; at < size; at++)
        if (text[at] == separator || text[at] == '\n')
            ends[count++] = (uint16_t)at;
    return count;
}

/* The rows whose ends are indexed. @return rows read; *used is what they take of the text */
KERNEL_TARGET static size_t read_rows(const imki_log_cells *cells, const char *base,
                                      const char *text, const uint16_t *ends, size_t end_count,
                                      double *const *out, size_t first, size_t max_rows,
                                      size_t *used)
{
    const size_t last = cells->cell_count - 1;
    const char separator = cells->separator;
    const char *begin = text;
    size_t row = first;
    for (; row < max_rows && end_count > last; row++) {
        const char *cell = begin;
        for (size_t i = 0; i < last; i++) {
            /* As many ends were set as bits were counted, which the analyzer does not know. */
            // NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult)
            const char *end = text + ends[i];
            double value;
            if (*end != separator || !read_number(base, cell, end, &value))
                goto stop;
            out[i][row] = value * cells->factor[i];
            cell = end + 1;
        }
        const char *line_end = text + ends[last];
        const char *end = line_end - (line_end > cell && line_end[-1] == '\r');
        double value;
        if (*line_end != '\n' || !read_number(base, cell, end, &value))
            goto stop;
        out[last][row] = value * cells->factor[last];
        begin = line_end + 1;
        ends += cells->cell_count;
        end_count -= cells->cell_count;
    }
stop:
    *used = (size_t)(begin - text);
    return row;
}

KERNEL_TARGET static size_t read_cells(const imki_log_cells *cells, const char *base,
                                       const char **text, const char *end, double *const *out,
                                       size_t max_rows)
{
    uint16_t ends[CHUNK + INDEX_SLACK];
    size_t row = 0, chunk = 256 + 16 * cells->cell_count;
    while (row < max_rows && *text < end) {
        /* Not more than the rows wanted will need, assessing by those before. */
        if (chunk > CHUNK)
            chunk = CHUNK;
        const size_t at_hand = (size_t)(end - *text);
        const size_t size = at_hand < chunk ? at_hand : chunk;
        const size_t end_count = index_ends(*text, size, cells->separator, ends);
        size_t used;
        const size_t after =
            read_rows(cells, base, *text, ends, end_count, out, row, max_rows, &used);
        *text += used;
        if (after == row)
            break;
        chunk = (max_rows - after) * (used / (after - row) + 4);
        row = after;
    }
    return row;
}

#endif
