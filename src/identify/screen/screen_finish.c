/* SPDX-License-Identifier: Apache-2.0 */
/* What the whole record tells when all chunks are decided: values that pile up at an end, noise
 * whose tails are its own, jumps of the level and trends. */
#include "screener_internal.h"

#include "imukit/distributions.h"
#include "imukit/elementary.h"

#include <math.h>

enum { LEVELS_MIN = 64, BATCHES_MIN = 10, CYCLE_LEVELS = 256, CYCLE_LEVELS_MIN = 100 };

/* More outliers than this share of the samples, or half as many samples that are nearly outliers,
 * are the noise itself. */
static const double tail_share = 5e-3, tail_shoulder = 0.5;
/* Beyond 5 standard deviations of most samples there are fewer than from 3.5 to 5 where tails are
 * those of Student's t of 5 degrees or of Laplace's density, by 3 to 4; six times as many where
 * some samples have ten times the noise; and 14 times as many where spikes are 6.5 +- 1. */
static const double tail_normal = 4.65e-4, clustered_least = 8, clustered_ratio = 8;

static void count_saturated(imk_screen *f, const imki_ends *ends)
{
    const imk_screen_count *count = &ends->count[0];
    f->saturated.first = f->saturated.count > 0 && f->saturated.first < count->first
                             ? f->saturated.first
                             : count->first;
    f->saturated.count += count->count;
    f->saturated.runs += count->runs;
}

static void find_saturation(imk_screener *s)
{
    imk_screen *f = &s->found;
    const double present = (double)f->present;
    const bool fast = f->noise > 0.7 * f->deviation;
    const bool low = imki_ends_pile(&s->low, f->resolution, -s->mean, f->deviation, present, fast);
    const bool high = imki_ends_pile(&s->high, f->resolution, s->mean, f->deviation, present, fast);
    f->saturation_low = low ? -s->low.value[0] : -HUGE_VAL;
    f->saturation_high = high ? s->high.value[0] : HUGE_VAL;
    f->saturated = (imk_screen_count){0, 0, f->n};
    if (low)
        count_saturated(f, &s->low);
    if (high)
        count_saturated(f, &s->high);
    const double share[2] = {low ? (double)s->low.count[0].count / present : 0,
                             high ? (double)s->high.count[0].count / present : 0};
    const double limit[2] = {f->saturation_low, f->saturation_high};
    const imki_clipped c = imki_clipped_normal(share, limit, s->mean, f->deviation, f->resolution);
    f->clipped_deviation = c.deviation;
    f->clipped_gain = c.gain;
    f->clipped_misfit = c.misfit;
}

/* Relative standard deviation of the fast variance of the record, by the scatter of batches: of
 * those lengths of which there are enough, the largest. Student's quantile stands for the number of
 * batches. */
static double fast_scatter(const imki_batches *batches)
{
    double most = 0;
    for (int b = 0; b < IMKI_SCREEN_BATCHES; b++) {
        const double n = batches[b].count, total = batches[b].total;
        if (n < BATCHES_MIN || !(total > 0))
            continue;
        const double mean = total / n;
        const double variance = (batches[b].squares - total * mean) / (n - 1);
        const double wider = imk_student_quantile(0.975, n - 1) / imk_normal_quantile(0.975);
        most = fmax(most, wider * sqrt(fmax(0, variance) / n) / mean);
    }
    return most;
}

bool imk_screener_suspects_tails(const imk_screener *s)
{
    const double outliers = (double)s->found.outliers.count, samples = (double)s->found.present;
    return outliers > 0 && ((double)s->shoulder >= tail_shoulder * outliers ||
                            outliers > 16 + 0.05 * tail_share * samples);
}

/* Chance puts 0.6 normal samples in a million between 5 scales and the threshold. */
static void find_tails(imk_screener *s)
{
    imk_screen *f = &s->found;
    const double outliers = (double)f->outliers.count, present = (double)f->present;
    const double due = tail_shoulder * outliers + 3 + 2e-6 * present;
    f->heavy_tails =
        f->outliers.count > 0 && (outliers > tail_share * present || (double)s->shoulder > due);
    const double evenly = s->far[0] - tail_normal * s->tail_samples;
    f->clustered = s->far[1] >= clustered_least && s->far[1] > clustered_ratio * evenly;
    const double fast = s->fast_blocks > 0 ? sqrt(s->fast / s->fast_blocks) : 0;
    const double core = s->core_count > 0 ? 1.4826 * s->core_sum / s->core_count : 0;
    /* a sample is off the mean of 32, itself among them, by 31/32 of its variance */
    f->core = fast > 0 && core > 0 ? core / (fast * sqrt(31.0 / 32)) : 1;
    f->noise_scatter = fast_scatter(s->batches[f->heavy_tails ? 0 : 1]);
}

/* Levels and the temperatures beside them, in at most `most` means. @return how many levels */
static size_t take_means(const imk_screener *s, size_t most, double *mean, double *temperature,
                         bool *thermal, double *empty)
{
    const imki_levels *l = &s->levels;
    *thermal = s->thermal && imki_levels_means(l, most, l->temperature, l->measured,
                                               l->shift_temperature, temperature, empty) > 0;
    return imki_levels_means(l, most, l->sum, l->present, l->shift, mean, empty);
}

/* Share of a stretch of samples that lies behind a jump. */
static double share_behind(size_t jump, size_t from, size_t length)
{
    if (jump <= from)
        return 1;
    return jump >= from + length ? 0 : 1 - (double)(jump - from) / (double)length;
}

/* The trends of the record less the jumps that are known. */
static void find_trends(imk_screener *s)
{
    imk_screen *f = &s->found;
    double *mean = s->room, *temperature = s->room + IMKI_TREND_PARTS, empty;
    bool thermal;
    const size_t parts = take_means(s, IMKI_TREND_PARTS, mean, temperature, &thermal, &empty);
    const size_t length = imki_levels_length(&s->levels, IMKI_TREND_PARTS);
    for (size_t k = 0; k < f->steps.count; k++)
        for (size_t p = 0; p < parts; p++)
            mean[p] -= f->step_size[k] * share_behind(f->step_place[k], p * length, length);
    f->warm_up = false;
    f->temperature_degree = f->degrees_taken = 0;
    f->temperature_slope = f->temperature_curvature = 0;
    imki_trend_of_means(s->settings.significance, parts, length, s->settings.dt, mean,
                        thermal ? temperature : NULL, f);
}

static double trend_at(const imk_screen *f, unsigned what, double time, double temperature)
{
    double trend = 0;
    if ((what & IMK_SCREEN_WARM_UP) && f->warm_up)
        trend = f->warm_up_amplitude * imk_exp(-time / f->warm_up_time);
    if ((what & IMK_SCREEN_TEMPERATURE) && f->temperature_degree > 0) {
        const double t = temperature - f->temperature_reference;
        trend += (f->temperature_slope + f->temperature_curvature * t) * t;
    }
    return trend;
}

/* The jumps of the levels less some trends; @return what the first one gains in log-likelihood. */
static double find_jumps(imk_screener *s, unsigned without)
{
    imk_screen *f = &s->found;
    double *mean = s->room, *temperature = mean + IMKI_SCREEN_LEVELS, empty, gain;
    imki_jump possible;
    bool thermal;
    const size_t n = take_means(s, IMKI_SCREEN_LEVELS, mean, temperature, &thermal, &empty);
    const double length = (double)imki_levels_length(&s->levels, IMKI_SCREEN_LEVELS);
    f->steps = (imk_screen_count){0, 0, f->n};
    f->largest_step = 0;
    f->possible_step = f->possible_step_square = 0;
    f->possible_step_place = f->n;
    if (n < LEVELS_MIN)
        return 0;
    for (size_t i = 0; i < n; i++)
        mean[i] -= trend_at(f, without, ((double)i + 0.5) * length * s->settings.dt,
                            thermal ? temperature[i] : 0);
    f->steps.count = f->steps.runs =
        imki_jumps_find(n, mean, empty, s->settings.significance, temperature + IMKI_SCREEN_LEVELS,
                        IMK_SCREEN_STEPS, f->step_place, f->step_size, &gain, &possible);
    f->possible_step = possible.size;
    f->possible_step_place = possible.place * (size_t)length;
    f->possible_step_square = possible.square;
    for (size_t k = 0; k < f->steps.count; k++) {
        f->step_place[k] *= (size_t)length;
        if (fabs(f->step_size[k]) > fabs(f->largest_step)) {
            f->largest_step = f->step_size[k];
            f->steps.first = f->step_place[k];
        }
    }
    return gain;
}

/* A cycle of the level, where it does not jump. */
static void find_cycle(imk_screener *s)
{
    imk_screen *f = &s->found;
    double *mean = s->room, *temperature = mean + CYCLE_LEVELS, empty;
    imki_cycle cycle;
    bool thermal;
    const size_t n = take_means(s, CYCLE_LEVELS, mean, temperature, &thermal, &empty);
    const double length = (double)imki_levels_length(&s->levels, CYCLE_LEVELS) * s->settings.dt;
    if (n < CYCLE_LEVELS_MIN || f->steps.count > 0)
        return;
    for (size_t i = 0; i < n; i++)
        mean[i] -= trend_at(f, IMK_SCREEN_TEMPERATURE | IMK_SCREEN_WARM_UP,
                            ((double)i + 0.5) * length, thermal ? temperature[i] : 0);
    if (!imki_cycle_find(n, mean, empty, s->settings.significance, temperature + CYCLE_LEVELS,
                         &cycle))
        return;
    f->cycle_amplitude = cycle.amplitude;
    f->cycle_period = (double)n * length / cycle.periods;
}

/* Where the sensor was moved, by the samples. In few means slow movements are plain, in many the
 * short ones, and where it had not settled. */
static void find_moves(imk_screener *s)
{
    enum { MOST = IMK_SCREEN_MOVES, EDGE = 4 };
    static const size_t means[] = {IMKI_SCREEN_LEVELS, 512, 128};
    imk_screen *f = &s->found;
    double *mean = s->room, *other = mean + IMKI_SCREEN_LEVELS, empty = 0;
    imki_move move[MOST];
    bool thermal;
    size_t count = 0, n = 0, length = 0;
    for (size_t k = 0; count == 0 && k < sizeof means / sizeof means[0]; k++) {
        n = take_means(s, means[k], mean, other, &thermal, &empty);
        length = imki_levels_length(&s->levels, means[k]);
        const double least = length > 0 ? f->resolution / sqrt((double)length) : 0;
        count = imki_moves_find(n, mean, empty, least, k == 0 ? EDGE : 0, other, move, MOST);
    }
    f->moved =
        (imk_screen_count){.runs = count, .first = count > 0 ? move[0].first * length : f->n};
    for (size_t k = 0; k < count; k++) {
        f->move_first[k] = move[k].first * length;
        f->move_end[k] = k + 1 < MOST && move[k].end < n ? move[k].end * length : f->n;
        f->moved.count += f->move_end[k] - f->move_first[k];
    }
}

/* An exponential at the start and a jump explain each other in part: what gains more is right. */
static void find_slow(imk_screener *s)
{
    imk_screen *f = &s->found;
    find_trends(s);
    if (f->warm_up) {
        const double amplitude = f->warm_up_amplitude / f->warm_up_amplitude_sigma;
        if (find_jumps(s, IMK_SCREEN_TEMPERATURE) > 0.5 * amplitude * amplitude) {
            find_trends(s);
            return;
        }
    }
    find_jumps(s, IMK_SCREEN_TEMPERATURE | IMK_SCREEN_WARM_UP);
    if (f->steps.count > 0)
        find_trends(s);
}

void imki_screen_conclude(imk_screener *s)
{
    imk_screen *f = &s->found;
    f->deviation = s->norm / sqrt((double)f->present);
    f->noise = s->scale_count > 0 ? s->scale_sum / s->scale_count : 0;
    f->outlier_threshold = s->scale_count > 0 ? s->threshold_sum / s->scale_count : HUGE_VAL;
    f->repeated = s->compared > 0 ? (double)s->repeats / (double)s->compared : 0;
    f->missing.first = f->missing.count > 0 ? f->missing.first : f->n;
    f->outliers.first = f->outliers.count > 0 ? f->outliers.first : f->n;
    f->stuck.first = f->stuck.count > 0 ? f->stuck.first : f->n;
    f->lost.first = f->lost.count > 0 ? f->lost.first : f->n;
    f->zeros = imki_zeros_excess(&s->zeros);
    f->filled = imki_frequent_excess(&s->frequent);
    f->filled_value = s->frequent.value[IMKI_FREQUENT_SIDE];
    f->held = imki_repeated_excess(s);
    f->straight = imki_straight_excess(s);
    find_saturation(s);
    f->ends_low = imki_edge_is_abrupt(&s->lower, f->present, f->noise, f->resolution);
    f->ends_high = imki_edge_is_abrupt(&s->upper, f->present, f->noise, f->resolution);
    f->end_low = s->lower.count > 0 ? -s->lower.largest[0] : 0;
    f->end_high = s->upper.count > 0 ? s->upper.largest[0] : 0;
    find_tails(s);
    f->interpolated = imki_cycles_find(&s->cycles, 0.1 * s->settings.significance, f->sensor_rate);
    f->steps.first = f->possible_step_place = f->n;
    find_moves(s);
    if (f->moved.count == 0) {
        find_slow(s);
        find_cycle(s);
    }
    /* The room holds the temperatures from here on, for imk_screener_trend(). */
    const imki_levels *l = &s->levels;
    double empty;
    imki_levels_means(l, IMKI_SCREEN_LEVELS, l->temperature, l->measured, l->shift_temperature,
                      s->room, &empty);
}

double imk_screener_trend(const imk_screener *s, unsigned what, double time)
{
    const imki_levels *l = &s->levels;
    const double length = (double)l->block * s->settings.dt, at = time / length - 0.5;
    double temperature = 0;
    if (s->found.temperature_degree > 0 && l->count > 1) {
        const double last = (double)(l->count - 2), from = at < 0 ? 0 : floor(fmin(at, last));
        const double *mean = s->room; /* of the temperature */
        const size_t i = (size_t)from;
        temperature = mean[i] + (mean[i + 1] - mean[i]) * fmin(fmax(at - from, 0), 1);
    }
    return trend_at(&s->found, what, time, temperature);
}
