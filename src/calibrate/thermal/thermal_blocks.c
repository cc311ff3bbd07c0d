/* SPDX-License-Identifier: Apache-2.0 */
/* A log as means over blocks of equally many samples. A linear fit to means of readings against
 * means of its columns is exact, whatever the temperature does within a block; nearly a hundred
 * blocks keep what a polynomial of order 5 and a loop can follow, and are few enough that the
 * covariance of all of them is handled as a whole. */
#include "base/refuse_internal.h"
#include "calibrate/standstill/median_internal.h"
#include "thermal_internal.h"

#include "imukit/samples.h"

#include <math.h>
#include <string.h>

double imki_thermal_reading(const imk_test_record *record, const imk_model *model, int sensor,
                            int axis, size_t sample)
{
    const imk_triad *triad = imk_model_triad(model, sensor);
    const double *const *reference =
        sensor == IMK_GYRO ? record->reference_rate : record->reference_force;
    double y = record->reading[sensor][axis][sample];
    if (record->counts[sensor])
        y = (y - triad->zero_offset.value[axis]) / triad->sensitivity.value[axis];
    if (triad->range.value[axis] > 0.0 && !(fabs(y) < triad->range.value[axis]))
        return (double)NAN;
    for (int k = 0; k < 3; k++)
        if (reference[k])
            y -= triad->direction[axis][k] * reference[k][sample];
    return y;
}

bool imki_thermal_usable(const imk_test_record *record, const imk_model *model,
                         const imki_thermal_blocks *blocks, size_t sample)
{
    if (!(record->temperature[sample] > 0.0) || isinf(record->temperature[sample]))
        return false;
    for (int a = 0; a < IMKI_THERMAL_AXES; a++)
        if (blocks->used[a] && !isfinite(imki_thermal_reading(record, model, a / IMK_AXES_MAX,
                                                              a % IMK_AXES_MAX, sample)))
            return false;
    return true;
}

/* Axes with a reading in at least half of the samples: one that is dead does not cost the others
 * the log. */
static void find_axes(const imk_test_record *record, const imk_model *model,
                      imki_thermal_blocks *blocks)
{
    for (int sensor = 0; sensor < 2; sensor++)
        for (int axis = 0; axis < record->axis_count[sensor]; axis++) {
            size_t finite = 0;
            for (size_t k = 0; k < record->count; k++)
                finite += isfinite(imki_thermal_reading(record, model, sensor, axis, k));
            blocks->used[sensor * IMK_AXES_MAX + axis] = 2 * finite > record->count;
        }
}

/* Range of the temperature, and how many samples there are. */
static void find_range(const imk_test_record *record, const imk_model *model,
                       imki_thermal_blocks *blocks)
{
    blocks->minimum = (double)INFINITY;
    blocks->maximum = -(double)INFINITY;
    for (size_t k = 0; k < record->count; k++)
        if (imki_thermal_usable(record, model, blocks, k)) {
            const double t = record->temperature[k];
            blocks->minimum = t < blocks->minimum ? t : blocks->minimum;
            blocks->maximum = t > blocks->maximum ? t : blocks->maximum;
            blocks->samples++;
        }
    blocks->left_out = record->count - blocks->samples;
}

/* Sums over the samples of one piece; times and temperatures relative to its first, readings to
 * the first of the log, so that nothing cancels. */
typedef struct sums {
    double n, temperature, power[IMK_TEMPERATURE_ORDER_MAX + 1];
    double first_time, first_temperature, last_time;
    double reading[IMKI_THERMAL_AXES];
} sums;

static void add_sample(const imk_test_record *record, const imk_model *model,
                       const imki_thermal_blocks *blocks, size_t k, sums *s,
                       double square[IMKI_THERMAL_AXES])
{
    const double time = imki_thermal_time(record, k), temperature = record->temperature[k];
    const double z = (temperature - blocks->reference) / blocks->scale;
    if (s->n == 0.0) {
        s->first_time = time;
        s->first_temperature = temperature;
    }
    s->last_time = time;
    s->n += 1.0;
    s->temperature += temperature - s->first_temperature;
    double power = 1.0;
    for (int i = 0; i <= IMK_TEMPERATURE_ORDER_MAX; i++, power *= z)
        s->power[i] += power;
    for (int a = 0; a < IMKI_THERMAL_AXES; a++)
        if (blocks->used[a]) {
            const double y =
                imki_thermal_reading(record, model, a / IMK_AXES_MAX, a % IMK_AXES_MAX, k) -
                blocks->mean[a];
            s->reading[a] += y;
            square[a] += y * y;
        }
}

/* Turn the sums of piece b into means. */
static void close_piece(const sums *s, double dt, imki_thermal_blocks *blocks, size_t b)
{
    blocks->begin[b] = s->first_time - dt;
    blocks->end[b] = s->last_time;
    blocks->size[b] = s->n;
    blocks->temperature[b] = s->first_temperature + s->temperature / s->n;
    for (int i = 0; i <= IMK_TEMPERATURE_ORDER_MAX; i++)
        blocks->column[i][b] = s->power[i] / s->n;
    for (int a = 0; a < IMKI_THERMAL_AXES; a++)
        blocks->reading[a][b] = s->reading[a] / s->n;
}

static double middle_of(const imki_thermal_blocks *blocks, size_t b)
{
    return 0.5 * (blocks->begin[b] + blocks->end[b]);
}

/* Temperature where piece b begins, from the means of up to two pieces on either side: exact for
 * cubics where these are equally long. */
static double edge_of(const imki_thermal_blocks *blocks, size_t b)
{
    const size_t n = blocks->count;
    const double *t = blocks->temperature, uneven = 0.1;
    if (b == 0)
        return 1.5 * t[0] - 0.5 * t[1];
    if (b == n)
        return 1.5 * t[n - 1] - 0.5 * t[n - 2];
    const double near = middle_of(blocks, b) - middle_of(blocks, b - 1);
    if (b >= 2 && b + 1 < n) {
        const double wide = middle_of(blocks, b + 1) - middle_of(blocks, b - 2);
        if (fabs(wide - 3.0 * near) < uneven * near)
            return (7.0 * (t[b - 1] + t[b]) - t[b - 2] - t[b + 1]) / 12.0;
    }
    return 0.5 * (t[b - 1] + t[b]);
}

/* Where the temperature turns within piece b, by the parabola with the means of it and of its
 * neighbours; its own mean when it does not turn there. */
static double apex_of(const imki_thermal_blocks *blocks, size_t b)
{
    const double *t = blocks->temperature;
    if (b == 0 || b + 1 >= blocks->count || !((t[b] - t[b - 1]) * (t[b + 1] - t[b]) < 0.0))
        return t[b];
    const double slope = 0.5 * (t[b + 1] - t[b - 1]), bend = t[b + 1] - 2.0 * t[b] + t[b - 1];
    return t[b] - bend / 24.0 - 0.5 * slope * slope / bend;
}

/* Mean rate over each piece, and the state of hysteresis. The history begins with the first sample,
 * not with the first mean, and turns where the temperature does. */
static void follow_temperature(imki_thermal_blocks *blocks)
{
    const imk_triad span = {
        .bias.temperature = {.order = 1, .minimum = blocks->minimum, .maximum = blocks->maximum}};
    imk_hysteresis hysteresis = imk_hysteresis_start(&span);
    double unused, begin = edge_of(blocks, 0);
    imk_hysteresis_next(&hysteresis, 1, &begin, &unused);
    for (size_t b = 0; b < blocks->count; b++) {
        const double end = edge_of(blocks, b + 1), apex = apex_of(blocks, b);
        blocks->rate[b] = (end - begin) / (blocks->end[b] - blocks->begin[b]);
        begin = end;
        imk_hysteresis_next(&hysteresis, 1, &blocks->temperature[b], &blocks->state[b]);
        imk_hysteresis_next(&hysteresis, 1, &apex, &unused);
    }
}

static void scale_columns(imki_thermal_blocks *blocks)
{
    double square = 0.0;
    for (size_t b = 0; b < blocks->count; b++)
        square += blocks->rate[b] * blocks->rate[b] / (double)blocks->count;
    blocks->rate_scale = square > 0.0 ? sqrt(square) : 1.0;
    for (size_t b = 0; b < blocks->count; b++) {
        blocks->column[IMKI_THERMAL_RATE][b] = blocks->rate[b] / blocks->rate_scale;
        blocks->column[IMKI_THERMAL_STATE][b] = blocks->state[b];
    }
}

/* The median of some readings of each axis, as an origin: one that is absurdly large, taken for it,
 * would leave no digits to the others. */
static void set_origins(const imk_test_record *record, const imk_model *model,
                        imki_thermal_blocks *blocks)
{
    enum { SOME = 15 };
    double reading[IMKI_THERMAL_AXES][SOME];
    size_t count = 0, usable = 0;
    for (size_t k = 0; k < record->count && count < SOME; k++) {
        if (!imki_thermal_usable(record, model, blocks, k) ||
            usable++ < count * (blocks->samples / SOME))
            continue;
        for (int a = 0; a < IMKI_THERMAL_AXES; a++)
            if (blocks->used[a])
                reading[a][count] =
                    imki_thermal_reading(record, model, a / IMK_AXES_MAX, a % IMK_AXES_MAX, k);
        count++;
    }
    for (int a = 0; a < IMKI_THERMAL_AXES; a++)
        if (blocks->used[a])
            blocks->mean[a] = imki_median(reading[a], count);
}

static void sum_pieces(const imk_test_record *record, const imk_model *model,
                       imki_thermal_blocks *blocks)
{
    double square[IMKI_THERMAL_AXES] = {0.0};
    const double n = (double)blocks->samples;
    sums s = {0};
    size_t used = 0, b = 0;
    set_origins(record, model, blocks);
    for (size_t k = 0; k < record->count; k++) {
        if (!imki_thermal_usable(record, model, blocks, k))
            continue;
        if (s.n == 0.0)
            blocks->first[b] = k;
        blocks->last[b] = k;
        add_sample(record, model, blocks, k, &s, square);
        if (++used == blocks->samples * (b + 1) / blocks->count) {
            close_piece(&s, record->dt, blocks, b++);
            memset(&s, 0, sizeof s);
        }
    }
    for (int a = 0; a < IMKI_THERMAL_AXES; a++) {
        double sum = 0.0;
        for (size_t i = 0; i < blocks->count; i++)
            sum += blocks->size[i] * blocks->reading[a][i];
        blocks->scatter[a] = sqrt(fmax(0.0, (square[a] - sum * sum / n) / (n - 1.0)));
    }
}

/* ---- pieces to blocks ------------------------------------------------------------------------ */

/* Mean of a quantity over the samples of a block, into its place. */
static void merge_mean(const double *size, size_t first, size_t b, double *value)
{
    double sum = 0.0, n = 0.0;
    for (size_t p = first; p < first + IMKI_THERMAL_PARTS; p++) {
        sum += size[p] * value[p];
        n += size[p];
    }
    value[b] = sum / n;
}

/* Keep the readings of an axis relative to their mean, now that no disturbed one is in it. */
static void centre(imki_thermal_blocks *blocks, int axis)
{
    double sum = 0.0, n = 0.0;
    for (size_t b = 0; b < blocks->count; b++) {
        sum += blocks->size[b] * blocks->reading[axis][b];
        n += blocks->size[b];
    }
    for (size_t b = 0; b < blocks->count; b++)
        blocks->reading[axis][b] -= sum / n;
    blocks->mean[axis] += sum / n;
}

void imki_thermal_merge(imki_thermal_blocks *blocks)
{
    double size[IMKI_THERMAL_PIECES];
    memcpy(size, blocks->size, sizeof size);
    blocks->count /= IMKI_THERMAL_PARTS;
    for (size_t b = 0; b < blocks->count; b++) {
        const size_t first = b * IMKI_THERMAL_PARTS, last = first + IMKI_THERMAL_PARTS - 1;
        blocks->first[b] = blocks->first[first];
        blocks->last[b] = blocks->last[last];
        blocks->begin[b] = blocks->begin[first];
        blocks->end[b] = blocks->end[last];
        merge_mean(size, first, b, blocks->temperature);
        merge_mean(size, first, b, blocks->rate);
        merge_mean(size, first, b, blocks->state);
        for (int i = 0; i <= IMK_TEMPERATURE_ORDER_MAX; i++)
            merge_mean(size, first, b, blocks->column[i]);
        for (int a = 0; a < IMKI_THERMAL_AXES; a++)
            merge_mean(size, first, b, blocks->reading[a]);
        blocks->size[b] = 0.0;
        for (size_t p = first; p <= last; p++)
            blocks->size[b] += size[p];
    }
    blocks->per_block = (double)blocks->samples / (double)blocks->count;
    scale_columns(blocks);
    for (int a = 0; a < IMKI_THERMAL_AXES; a++)
        if (blocks->used[a])
            centre(blocks, a);
}

static imk_status too_short(imk_error *error, const char *field, double value, double limit,
                            const char *expected)
{
    return imki_refuse(error, IMK_ERROR_TOO_SHORT, field, value, limit, expected);
}

/* 24 blocks of 4 samples: three for each of eight unknowns. */
enum { FEWEST_BLOCKS = 24, FEWEST_SAMPLES = 4 * FEWEST_BLOCKS, BLOCK_SAMPLES = 8 };
static const double least_range = 2.0;     /* [K], below which nothing is worth a polynomial */
static const double usual_kelvin = 298.15; /* 25 degC */

imk_status imki_thermal_divide(const imk_test_record *record, const imk_model *model,
                               double reference, imki_thermal_blocks *blocks, imk_error *error)
{
    memset(blocks, 0, sizeof *blocks);
    find_axes(record, model, blocks);
    find_range(record, model, blocks);
    if (blocks->samples < FEWEST_SAMPLES)
        return too_short(error, "samples", (double)blocks->samples, FEWEST_SAMPLES,
                         "a longer log with a temperature in each row");
    if (!(blocks->maximum - blocks->minimum >= least_range))
        return too_short(error, "temperature", blocks->maximum - blocks->minimum, least_range,
                         "a log over a wider range of temperature");
    const size_t count = blocks->samples / BLOCK_SAMPLES;
    blocks->count = IMKI_THERMAL_PARTS * (count > IMKI_THERMAL_BLOCKS ? IMKI_THERMAL_BLOCKS
                                          : count < FEWEST_BLOCKS     ? FEWEST_BLOCKS
                                                                      : count);
    const bool usual = usual_kelvin >= blocks->minimum && usual_kelvin <= blocks->maximum;
    blocks->reference = reference == reference ? reference
                        : usual                ? usual_kelvin
                                               : 0.5 * (blocks->minimum + blocks->maximum);
    blocks->scale =
        fmax(fabs(blocks->maximum - blocks->reference), fabs(blocks->minimum - blocks->reference));
    sum_pieces(record, model, blocks);
    for (size_t b = 1; b < blocks->count; b++)
        if (!(blocks->end[b] > blocks->end[b - 1]))
            return imk_error_set(error, IMK_ERROR_NOT_FINITE, "time", NULL,
                                 "check the times: they must be finite and increase");
    follow_temperature(blocks);
    scale_columns(blocks);
    return IMK_OK;
}

/* The attitude is watched through the accelerometers, a second and 16 samples at a time: heat does
 * not turn the force by 0.2 rad. */
size_t imki_thermal_turned(const imk_test_record *record, const imk_model *model)
{
    const double cosine = 0.98; /* of 0.2 rad */
    const size_t least = 16;
    const size_t window =
        record->dt * (double)least < 1.0 ? imk_samples_in(1.0, record->dt) : least;
    double first[3] = {0.0}, sum[3], length_first = 0.0;
    if (record->axis_count[IMK_ACCEL] != 3 || record->reference_force[0])
        return record->count;
    for (size_t k = 0; k + window <= record->count; k += window) {
        double length = 0.0, product = 0.0;
        for (int i = 0; i < 3; i++) {
            sum[i] = 0.0;
            for (size_t j = k; j < k + window; j++)
                sum[i] += imki_thermal_reading(record, model, IMK_ACCEL, i, j);
            length += sum[i] * sum[i];
            product += sum[i] * first[i];
        }
        if (!(length > 0.0))
            continue;
        if (length_first == 0.0) {
            memcpy(first, sum, sizeof first);
            length_first = length;
        } else if (product < cosine * sqrt(length * length_first)) {
            return k;
        }
    }
    return record->count;
}
