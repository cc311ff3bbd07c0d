/* SPDX-License-Identifier: Apache-2.0 */
/* Readings of a magnetometer from a record: means at rest, and short means in motion. A sensor that
 * is slower than the log repeats its rows: only a row that differs from the one before is an
 * update. At rest the repetition shows in the autocorrelation, and a coarse step in the step
 * (static_summary.c), which is looked for in the whole record. */
#include "magnetometer_internal.h"

#include "base/algebra/vector_internal.h"
#include "calibrate/standstill/static_internal.h"

#include <math.h>
#include <string.h>

static bool row_of(const imk_test_record *record, size_t row, double m[3])
{
    for (int i = 0; i < 3; i++) {
        m[i] = record->mag[i][row];
        if (!isfinite(m[i]))
            return false;
    }
    return true;
}

static bool same(const double a[3], const double b[3])
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

bool imk_magnetometer_rest(const imk_test_record *record, const imk_magnetometer_record *look,
                           size_t begin, size_t end, imk_magnetometer_observation *o)
{
    double step[2][IMK_AXES_MAX] = {{0.0}};
    imk_test_record as_forces = {
        .count = record->count, .dt = record->dt, .time = record->time, .axis_count = {0, 3}};
    for (int i = 0; i < 3; i++)
        as_forces.reading[IMK_ACCEL][i] = record->mag[i];
    memcpy(step[IMK_ACCEL], look->step, sizeof look->step);
    const imk_static_interval at = imki_static_summarise(&as_forces, begin, end, step);
    memset(o, 0, sizeof *o);
    o->begin = begin;
    o->end = end;
    for (int i = 0; i < 3; i++) {
        o->reading[i] = at.mean[IMK_ACCEL][i];
        o->sigma[i] = at.sigma[IMK_ACCEL][i];
        if (!isfinite(o->reading[i]) || !(o->sigma[i] > 0.0) || !isfinite(o->sigma[i]))
            return false;
    }
    return end - begin > 1;
}

void imk_magnetometer_pool(size_t count, imk_magnetometer_observation *o)
{
    for (int i = 0; i < 3; i++) {
        double sum = 0.0;
        for (size_t k = 0; k < count; k++)
            sum += o[k].sigma[i] * o[k].sigma[i] * (double)(o[k].end - o[k].begin);
        for (size_t k = 0; k < count; k++)
            o[k].sigma[i] = sqrt(sum / (double)count / (double)(o[k].end - o[k].begin));
    }
}

/* ---- the record as a whole ------------------------------------------------------------------- */

/* Updates one after the other. */
typedef struct updates {
    const imk_test_record *record;
    size_t row;
    bool any;
    double last[3];
} updates;

static bool next_update(updates *u, double m[3], size_t *row)
{
    for (; u->row < u->record->count; u->row++)
        if (row_of(u->record, u->row, m) && !(u->any && same(m, u->last))) {
            memcpy(u->last, m, sizeof u->last);
            u->any = true;
            *row = u->row++;
            return true;
        }
    return false;
}

/* Noise from second differences x0 - 2 x1 + x2 of updates, variance 6 of one. The unit is turned
 * during some of them: their logarithms' mean is moved less than that of squares, so the square
 * root of small ones counts. */
static void add_difference(const double m[3][3], double sum[3], double *count)
{
    for (int i = 0; i < 3; i++)
        sum[i] += sqrt(fabs(m[0][i] - 2.0 * m[1][i] + m[2][i]));
    *count += 1.0;
}

typedef struct extremes {
    double low[3], high[3];
    size_t low_run[3], high_run[3], low_most[3], high_most[3];
} extremes;

/* How long each axis stays at its largest and smallest value. */
static void add_extremes(extremes *e, const double m[3])
{
    for (int i = 0; i < 3; i++) {
        if (m[i] > e->high[i])
            e->high_run[i] = e->high_most[i] = 0;
        if (m[i] < e->low[i])
            e->low_run[i] = e->low_most[i] = 0;
        e->high[i] = fmax(e->high[i], m[i]);
        e->low[i] = fmin(e->low[i], m[i]);
        e->high_run[i] = m[i] == e->high[i] ? e->high_run[i] + 1 : 0;
        e->low_run[i] = m[i] == e->low[i] ? e->low_run[i] + 1 : 0;
        if (e->high_run[i] > e->high_most[i])
            e->high_most[i] = e->high_run[i];
        if (e->low_run[i] > e->low_most[i])
            e->low_most[i] = e->low_run[i];
    }
}

imk_magnetometer_record imk_magnetometer_look(const imk_test_record *record)
{
    enum { RUN = 20 };
    /* E sqrt|z| of a standard normal is 2^(1/4) Gamma(3/4)/sqrt(pi). */
    static const double root = 0.8221789586624;
    imk_magnetometer_record found = {.rows = 0};
    extremes e = {
        {HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, {0}, {0}, {0}, {0}};
    updates u = {.record = record};
    double m[3][3] = {{0.0}}, sum[3] = {0.0, 0.0, 0.0}, count = 0.0, changed[3] = {0.0, 0.0, 0.0};
    size_t row;
    for (size_t k = 0; k < record->count; k++)
        found.rows += row_of(record, k, m[2]);
    while (next_update(&u, m[2], &row)) {
        add_extremes(&e, m[2]);
        for (int i = 0; found.updates > 0 && i < 3; i++)
            changed[i] += m[2][i] != m[1][i];
        if (++found.updates > 2)
            add_difference((const double(*)[3])m, sum, &count);
        memcpy(m[0], m[1], sizeof m[0]);
        memcpy(m[1], m[2], sizeof m[1]);
    }
    for (int i = 0; i < 3; i++) {
        const double mean = count > 0.0 ? sum[i] / count / root : 0.0;
        const bool lively = changed[i] > 0.5 * (double)found.updates;
        found.noise[i] = mean * mean / sqrt(6.0);
        found.step[i] = imki_static_step(record->mag[i], 0, record->count);
        found.stuck[i] = found.updates > 0 && e.low[i] == e.high[i];
        if (lively && e.high_most[i] >= RUN)
            found.saturated[i] = e.high[i];
        else if (lively && e.low_most[i] >= RUN)
            found.saturated[i] = e.low[i];
    }
    return found;
}

/* ---- motion ---------------------------------------------------------------------------------- */

/* A mean that grows while the field turns little. */
typedef struct block {
    double sum[3], first[3], centre[3];
    size_t count, begin, end;
} block;

static bool belongs(const block *b, const double m[3], size_t row, double limit, double most)
{
    double square = 0.0;
    for (int i = 0; i < 3; i++)
        square += (m[i] - b->first[i]) * (m[i] - b->first[i]);
    return b->count > 0 && (double)(row - b->begin) < most && square < limit * limit;
}

static void finish(const block *b, const imk_magnetometer_record *look,
                   imk_magnetometer_observation *o)
{
    memset(o, 0, sizeof *o);
    o->begin = b->begin;
    o->end = b->end;
    for (int i = 0; i < 3; i++) {
        o->reading[i] = b->sum[i] / (double)b->count;
        o->sigma[i] = fmax(look->noise[i], 1e-12) / sqrt((double)b->count);
    }
}

/* Extent of the readings: half of their range on the axis of the largest. */
static double extent_of(const imk_test_record *record)
{
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    double m[3], most = 0.0;
    for (size_t row = 0; row < record->count; row++)
        for (int i = 0; row_of(record, row, m) && i < 3; i++) {
            low[i] = fmin(low[i], m[i]);
            high[i] = fmax(high[i], m[i]);
            most = fmax(most, 0.5 * (high[i] - low[i]));
        }
    return most;
}

/* Blocks of a record; every `stride`-th is written, as far as there is room.
 * @return their number: written, or in all if the capacity is 0 */
static size_t fill(const imk_test_record *record, const imk_magnetometer_record *look, double limit,
                   size_t stride, size_t capacity, imk_magnetometer_observation *observation)
{
    static const double longest = 1.0; /* [s] */
    updates u = {.record = record};
    block b = {.count = 0};
    double m[3] = {0.0, 0.0, 0.0};
    size_t row = 0, count = 0, written = 0;
    bool more = true;
    while (more) {
        more = next_update(&u, m, &row);
        if (more && belongs(&b, m, row, limit, longest / record->dt)) {
            for (int i = 0; i < 3; i++)
                b.sum[i] += m[i];
            b.count++;
            b.end = row + 1;
            continue;
        }
        if (b.count > 0 && count++ % stride == 0 && written < capacity)
            finish(&b, look, &observation[written++]);
        b = (block){.count = 1, .begin = row, .end = row + 1};
        memcpy(b.sum, m, sizeof b.sum);
        memcpy(b.first, m, sizeof b.first);
    }
    return capacity == 0 ? count : written;
}

size_t imk_magnetometer_motion(const imk_test_record *record, size_t capacity,
                               imk_magnetometer_observation *observation)
{
    static const double turned = 0.02; /* [rad]; a mean is then too short by 2e-5 at most */
    if (capacity == 0)
        return 0;
    const imk_magnetometer_record look = imk_magnetometer_look(record);
    double limit = turned * extent_of(record);
    /* Noise that ends blocks would choose which readings they hold. */
    for (int i = 0; i < 3; i++)
        if (6.0 * look.noise[i] > limit)
            limit = 0.0;
    const size_t count = fill(record, &look, limit, 1, 0, NULL);
    return fill(record, &look, limit, (count + capacity - 1) / capacity, capacity, observation);
}
