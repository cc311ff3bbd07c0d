/* SPDX-License-Identifier: Apache-2.0 */
/* The fast way through the rows of a CSV text: plain rows only. */
#ifndef IMUKIT_LOG_CELLS_INTERNAL_H
#define IMUKIT_LOG_CELLS_INTERNAL_H

#include <stdbool.h>
#include <stddef.h>

typedef struct imki_log_cells {
    size_t cell_count; /* per row, 1 or more */
    char separator;
    const double *factor; /* per cell: SI value = factor * number */
} imki_log_cells;

/* Read plain rows: `cell_count` finite numbers with single separators between, no blanks, no
 * quotes, ended by a newline. Stops before the first row that is not so.
 *
 * @param base       the bytes from here on may be read
 * @param text,end   the rows; *text moves behind the rows read
 * @param out        per cell, room for max_rows values
 * @return rows read */
typedef size_t imki_log_cells_reader(const imki_log_cells *cells, const char *base,
                                     const char **text, const char *end, double *const *out,
                                     size_t max_rows);

/* Both give the same numbers and stop at the same rows. */
imki_log_cells_reader imki_log_cells_read_scalar, imki_log_cells_read_avx2;

/* Does this machine run imki_log_cells_read_avx2()? */
bool imki_log_cells_avx2_runs(void);

/* The best of them here; the environment variable IMUKIT_ISA=scalar forces the portable one. */
imki_log_cells_reader *imki_log_cells_choose(void);

/* Any finite number that fills the cell. */
bool imki_log_cell_read(const char *begin, const char *end, double *value);

#endif
