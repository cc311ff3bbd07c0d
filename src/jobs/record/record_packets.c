/* SPDX-License-Identifier: Apache-2.0 */
/* Are packets of rows written again, in place of the next ones?
 *
 * A packet of L rows that is written twice is a run of L rows whose channels all equal those of the
 * row L before. Coarse digits repeat rows by chance, but hardly so many in a row: of independent
 * rows, of which the share p repeats the row L before, L p^L are in such runs. Rows that repeat the
 * row directly before are told by others. */
#include "record_packets_internal.h"

#include "row_keys_internal.h"

#include "imukit/elementary.h"
#include "jobs/job_internal.h"

#include <math.h>
#include <stdint.h>

enum {
    LAGS = IMKI_PACKET_LAGS,
    LEAST = 2, /* lag of a packet; channels of a sensor */
    ROWS = 2048,
    EARLY = 32, /* stretches that are all counted; later one of so many */
    ROWS_LEAST = 1024
};

/* Share of the rows written again that is told. */
static const double told = 0.015;

/* Numbers of rows. Those with missing samples are all different. */
static void number_rows(size_t channels, const int *column, size_t rows, double *const *columns,
                        size_t first, uint32_t *number)
{
    uint64_t key[ROWS];
    imki_row_keys(channels, column, rows, columns, first, key);
    for (size_t i = 0; i < rows; i++)
        number[i] = key[i] == 0 ? (uint32_t)i : (uint32_t)(key[i] >> 32);
}

static size_t count_equal(size_t rows, const uint32_t *number, size_t lag)
{
    uint32_t count = 0;
    for (size_t i = LAGS; i < rows; i++)
        count += number[i] == number[i - lag];
    return count;
}

/* Rows in runs of at least `lag`, most of which are not those of a value that is held. */
static size_t count_again(size_t rows, const uint32_t *number, size_t lag)
{
    size_t count = 0, run = 0, changes = 0;
    for (size_t i = LAGS; i < rows; i++) {
        const bool equal = number[i] == number[i - lag];
        run = equal ? run + 1 : 0;
        changes = equal ? changes + (number[i] != number[i - 1]) : 0;
        if (run >= lag && 2 * changes > run)
            count += run == lag ? lag : 1;
    }
    return count;
}

/* Rows that differ from the one before, behind a row that equals that `lag` before; and those of
 * them that equal it, too. */
static void count_agreement(size_t rows, const uint32_t *number, size_t lag, size_t *behind,
                            size_t *on)
{
    for (size_t i = LAGS + 1; i < rows; i++) {
        const bool counts = number[i] != number[i - 1] && number[i - 1] == number[i - 1 - lag];
        *behind += counts;
        *on += counts && number[i] == number[i - lag];
    }
}

void imki_packets_add(imki_packets *packets, size_t channels, const int *column, size_t rows,
                      double *const *columns, size_t first)
{
    uint32_t number[ROWS];
    const size_t stretch = packets->stretches++;
    if (rows <= LAGS || (stretch >= EARLY && stretch % EARLY != 0))
        return;
    number_rows(channels, column, rows, columns, first, number);
    for (size_t lag = 1; lag <= LAGS; lag++) {
        const size_t equal = count_equal(rows, number, lag);
        packets->equal[lag] += equal;
        packets->again[lag] += equal < lag || lag < LEAST ? 0 : count_again(rows, number, lag);
        if (equal > 0)
            count_agreement(rows, number, lag, &packets->behind[lag], &packets->on[lag]);
    }
    packets->rows += rows - LAGS;
}

/* Share of equal rows that at most one lag in four exceeds: of a tone, at lags in phase with it. */
static double upper_quarter(const imki_packets *packets)
{
    size_t least = packets->rows;
    for (size_t lag = LEAST; lag <= LAGS; lag++) {
        size_t beyond = 0;
        for (size_t other = LEAST; other <= LAGS; other++)
            beyond += packets->equal[other] > packets->equal[lag];
        if (beyond <= LAGS / 4 && packets->equal[lag] < least)
            least = packets->equal[lag];
    }
    return (double)least / (double)packets->rows;
}

double imki_packets_agreement(const imki_packets *packets)
{
    double most = 0;
    for (size_t lag = 1; lag <= LAGS; lag++)
        most = fmax(most, ((double)packets->on[lag] + 1) / ((double)packets->behind[lag] + 2));
    return most;
}

void imki_packets_tell(const imki_packets *packets, size_t channels, const char *name,
                       imk_findings *findings)
{
    size_t most = LEAST;
    for (size_t lag = LEAST; lag <= LAGS; lag++)
        most = packets->again[lag] > packets->again[most] ? lag : most;
    if (channels < LEAST || packets->rows < ROWS_LEAST)
        return;
    const double share = (double)packets->again[most] / (double)packets->rows;
    const double by_chance = (double)most * imk_exp((double)most * imk_ln(upper_quarter(packets)));
    if (share > told + 3 * by_chance)
        imki_find(findings, IMK_FINDING_WARNING, "packets", name,
                  IMKI_NUMBERS(100 * share, (double)most));
}
