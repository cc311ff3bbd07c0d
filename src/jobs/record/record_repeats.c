/* SPDX-License-Identifier: Apache-2.0 */
/* Is a sensor slower than the log, so that rows repeat its samples? Is a column the copy of
 * another?
 *
 * A share h of the rows repeats the row before on all axes of the sensor at once; the others do on
 * axis c by chance, with probability u_c, independently:
 *
 *     p_c = h + (1 - h) u_c        rows equal on axis c
 *     p   = h + (1 - h) prod u_c   rows equal on all axes
 *
 * h follows from the shares p_c and p. The same at a distance at which nothing is held tells what
 * correlated axes and stretches of less noise make of it; the difference is what is held. A clock
 * holds regularly: the number held of WINDOW rows hardly varies, and that equal by chance has the
 * variance of a binomial distribution. */
#include "record_repeats_internal.h"

#include "jobs/job_internal.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum {
    ROWS = 2048,
    FAR = 16,
    WINDOW = 64,
    LEAST = 256,
    HALVINGS = 50,
    MANY = 1 << 18, /* rows; of later ones every fourth stretch is enough for a share of 1 % */
    EVERY = 4
};

/* Fewer repeats change no result. */
static const double held_told = 0.01;
/* Standard errors of a share beyond which it is none of chance: 1e-9. */
static const double errors_beyond = 6.0;
/* Values are fine when they are equal by chance this rarely; one channel alone must be. */
static const double fine = 1e-3;
/* Variance of the held samples in a window over that of as many independent ones: of a clock; of
 * stretches that are not stuck. */
static const double regular_most = 0.5, scattered_most = 2.0;
/* Rows equal by chance alone on all axes: beyond this nothing can be told. */
static const double chance_most = 0.5;

void imki_repeats_start(imki_repeats *r, size_t count, const int *channel,
                        const imk_log_column *columns)
{
    memset(r, 0, sizeof *r);
    for (int k = 0; k < 2; k++)
        imki_replay_start(&r->sensor[k].replay);
    for (size_t c = 0; c < count; c++) {
        r->others = r->others || columns[channel[c]].quantity == IMK_QUANTITY_OTHER;
        const bool accel = columns[channel[c]].quantity == IMK_QUANTITY_SPECIFIC_FORCE;
        imki_repeat_counts *sensor = &r->sensor[accel];
        sensor->column[sensor->channels++] = channel[c];
    }
}

/* Rows equal to the one `lag` before; `all` keeps those that were equal on all axes so far. */
static size_t count_equal(size_t rows, const double *x, size_t lag, uint8_t *all)
{
    size_t count = 0;
    for (size_t i = FAR; i < rows; i++) {
        const uint8_t equal = x[i] == x[i - lag];
        all[i] &= equal;
        count += equal;
    }
    return count;
}

static void count_windows(imki_windows *w, size_t rows, const uint8_t *counted)
{
    for (size_t begin = FAR; begin + WINDOW <= rows; begin += WINDOW) {
        double count = 0;
        for (size_t i = begin; i < begin + WINDOW; i++)
            count += counted[i];
        w->windows++;
        w->sum += count;
        w->square_sum += count * count;
    }
}

/* Rows of a sensor without any value. */
static void count_blanks(imki_repeat_counts *s, size_t rows, double *const *columns, size_t first,
                         uint8_t *blank)
{
    memset(blank, 1, rows);
    for (size_t c = 0; c < s->channels; c++) {
        const double *x = columns[s->column[c]] + first;
        for (size_t i = 0; i < rows; i++)
            blank[i] &= x[i] != x[i];
    }
    count_windows(&s->blank, rows, blank);
}

/* Channels with noise of their own differ within some rows, so that this costs nothing. */
static void compare_channels(imki_repeat_counts *s, size_t rows, double *const *columns,
                             size_t first)
{
    for (size_t b = 1; b < s->channels; b++)
        for (size_t a = 0; a < b; a++)
            if (!s->differ[a][b])
                s->differ[a][b] =
                    memcmp(columns[s->column[a]] + first, columns[s->column[b]] + first,
                           rows * sizeof **columns) != 0;
}

/* Missing samples count nothing. */
static void add_products(imki_repeat_counts *s, size_t rows, double *const *columns, size_t first)
{
    for (size_t b = 0; b < s->channels && b < IMKI_REPEAT_AXES; b++)
        for (size_t a = 0; a <= b; a++) {
            const double *x = columns[s->column[a]] + first, *y = columns[s->column[b]] + first;
            double sum = 0, alike = 0, opposed = 0;
            for (size_t i = 1; i < rows; i++) {
                const double product = (x[i] - x[i - 1]) * (y[i] - y[i - 1]);
                sum += product == product ? product : 0;
                alike += product > 0;
                opposed += product < 0;
            }
            s->product[a][b] += sum;
            s->alike[a][b] += alike;
            s->opposed[a][b] += opposed;
        }
}

static void add_rows(imki_repeat_counts *s, size_t rows, double *const *columns, size_t first)
{
    compare_channels(s, rows, columns, first);
    imki_packets_add(&s->packets, s->channels, s->column, rows, columns, first);
    if (s->rows > MANY && s->stretches++ % EVERY != 0)
        return;
    if (s->rows <= MANY)
        add_products(s, rows, columns, first);
    uint8_t all[2][ROWS];
    memset(all, 1, sizeof all);
    for (size_t c = 0; c < s->channels; c++) {
        const double *x = columns[s->column[c]] + first;
        s->equal[c][0] += count_equal(rows, x, 1, all[0]);
        s->equal[c][1] += count_equal(rows, x, FAR, all[1]);
    }
    for (size_t i = FAR; i < rows; i++) {
        s->all[0] += all[0][i];
        s->all[1] += all[1][i];
    }
    s->rows += rows - FAR;
    count_windows(&s->held, rows, all[0]);
    count_blanks(s, rows, columns, first, all[1]);
}

void imki_repeats_add(imki_repeats *r, size_t rows, double *const *columns)
{
    for (int k = 0; k < 2; k++) {
        imki_repeat_counts *s = &r->sensor[k];
        for (size_t first = 0; s->channels > 0 && first + FAR < rows; first += ROWS)
            add_rows(s, rows - first < ROWS ? rows - first : ROWS, columns, first);
        if (s->channels > 0)
            imki_replay_add(&s->replay, s->channels, s->column, rows, columns);
    }
}

/* Share of rows equal on all axes if a share h of them is held. */
static double share_of(const imki_repeat_counts *s, int lag, double h, double *chance)
{
    *chance = 1;
    for (size_t c = 0; c < s->channels; c++)
        *chance *= fmax(0, ((double)s->equal[c][lag] / (double)s->rows - h) / (1 - h));
    return h + (1 - h) * *chance;
}

/* Share of rows held, and of the others those that are equal by chance. */
static double held_share(const imki_repeat_counts *s, int lag, double *chance)
{
    double low = 0, high = 1;
    const double all = (double)s->all[lag] / (double)s->rows;
    for (size_t c = 0; c < s->channels; c++)
        high = fmin(high, (double)s->equal[c][lag] / (double)s->rows);
    high = fmin(high, 1 - 1 / (double)s->rows);
    for (int k = 0; k < HALVINGS; k++) {
        const double middle = (low + high) / 2;
        if (share_of(s, lag, middle, chance) < all)
            low = middle;
        else
            high = middle;
    }
    share_of(s, lag, low, chance);
    return low;
}

/* Of one axis, every repeat of fine values is held. */
static double held_of(const imki_repeat_counts *s, double *chance)
{
    const double far = (double)s->all[1] / (double)s->rows;
    if (s->channels == 1) {
        *chance = far;
        return far < fine ? (double)s->all[0] / (double)s->rows : 0;
    }
    double far_chance;
    const double near = held_share(s, 0, chance);
    return near - held_share(s, 1, &far_chance);
}

static void tell_sensor(const imki_repeat_counts *s, const char *name, double dt,
                        imk_findings *findings)
{
    double chance;
    const imki_windows *w = &s->held;
    if (s->channels == 0 || s->rows < LEAST || w->windows < 2)
        return;
    const double n = (double)s->rows, held = held_of(s, &chance);
    const double mean = w->sum / w->windows;
    const double variance = w->square_sum / w->windows - mean * mean;
    const double by_chance = WINDOW * (1 - held) * chance * (1 - chance);
    const double share = (variance - by_chance) / (WINDOW * held * (1 - held));
    const bool beyond = held > held_told && held > errors_beyond * sqrt(held / n);
    const bool regular = share < regular_most;
    const bool scattered = chance < fine && share < scattered_most;
    if (beyond && chance < chance_most && (regular || scattered))
        imki_find(findings, IMK_FINDING_WARNING, "stamps:held", name,
                  IMKI_NUMBERS(100 * held, (1 - held) / dt, 1 / dt));
}

/* Blank rows at even distances are those of a slower sensor; lost ones are at random, and their
 * number in a window has the variance of a binomial distribution or more. The estimate of it by 32
 * windows is below a quarter in one log of 1e5. */
static void tell_blank(const imki_repeat_counts *s, const char *name, double dt,
                       imk_findings *findings)
{
    const imki_windows *w = &s->blank;
    const double windows_least = 32, told = 0.02, even = 0.25;
    if (w->windows < windows_least)
        return;
    const double mean = w->sum / w->windows, share = mean / WINDOW;
    const double variance = w->square_sum / w->windows - mean * mean;
    if (share > told && share < 1 && variance < even * WINDOW * share * (1 - share))
        imki_find(findings, IMK_FINDING_WARNING, "stamps:sparse", name,
                  IMKI_NUMBERS(100 * share, (1 - share) / dt, 1 / dt, 1 / sqrt(1 - share)));
}

/* A channel that hardly ever changes is told by others, and may equal a second one by chance. */
static bool is_copy(const imki_repeat_counts *s, size_t a, size_t b)
{
    return !s->differ[a][b] && s->rows >= LEAST && (double)s->equal[b][0] < 0.9 * (double)s->rows;
}

/* Are the steps of one channel those of another, times a factor? Two sensors have noise of their
 * own; a vibration that both feel would have to be thirty times as large. A few rows far off on
 * both, such as those written for lost ones, outweigh all others: nearly all have to agree in
 * sign, which a correlation of 0.9995 does in 99 of 100. */
static bool follows(const imki_repeat_counts *s, size_t a, size_t b, double *factor)
{
    const double own = 1e-3, most_signs = 0.8;
    if (b >= IMKI_REPEAT_AXES)
        return false;
    const double square = s->product[a][a] * s->product[b][b];
    const double signs = s->alike[a][b] + s->opposed[a][b];
    *factor = s->product[a][a] > 0 ? s->product[a][b] / s->product[a][a] : 0;
    return s->rows >= LEAST && square > 0 && square < HUGE_VAL &&
           (double)s->equal[b][0] < 0.9 * (double)s->rows &&
           fabs(s->alike[a][b] - s->opposed[a][b]) > most_signs * signs &&
           s->product[a][b] * s->product[a][b] > (1 - own) * square;
}

static void tell_copies(const imki_repeat_counts *s, const imk_log_column *columns,
                        imk_findings *findings)
{
    for (size_t b = 1; b < s->channels; b++)
        for (size_t a = 0; a < b; a++) {
            double factor;
            const bool copy = is_copy(s, a, b);
            if (!copy && !follows(s, a, b, &factor))
                continue;
            char names[2 * sizeof columns->name];
            snprintf(names, sizeof names, "%s\t%s", columns[s->column[b]].name,
                     columns[s->column[a]].name);
            if (copy)
                imki_find(findings, IMK_FINDING_WARNING, "copy", names, 0, NULL);
            else
                imki_find(findings, IMK_FINDING_WARNING, "follows", names, IMKI_NUMBERS(factor));
            break;
        }
}

void imki_repeats_tell(imki_repeats *r, const imk_log_column *columns, double dt,
                       imk_findings *findings)
{
    for (int k = 0; k < 2; k++) {
        imki_repeat_counts *s = &r->sensor[k];
        const char *name = k == 1 ? "accel" : r->others ? "columns" : "gyro";
        tell_sensor(s, name, dt, findings);
        tell_blank(s, name, dt, findings);
        imki_packets_tell(&s->packets, s->channels, name, findings);
        imki_replay_tell(&s->replay, imki_packets_agreement(&s->packets), name, dt, findings);
        tell_copies(s, columns, findings);
    }
}
