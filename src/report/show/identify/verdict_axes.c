/* SPDX-License-Identifier: Apache-2.0 */
/* Axes that do not fit their triad, and gyros that no gyro is like. The axes of a triad are made
 * alike, so white noise of another size is that of another unit or of another column. Gravity tells
 * the unit of accelerometers; the unit of gyros only shows where the numbers are beyond all
 * sensors. */
#include "identify_show_internal.h"

#include "report/result_internal.h"

#include <math.h>

/* Axes of one sensor differ by less than 2 in their white noise. */
static const double factor_most = 4;
/* A larger one is of a channel without a model. */
static const double factor_believed = 1e6;
/* How near a factor must be to a ratio of units: axes may differ by a third. */
static const double unit_near = 1.35;
/* The worst MEMS gyros have an angle random walk of some deg/sqrt(h), and an offset of 20 deg/s. */
static const double walk_most = 10, mean_most = 30;

static const imk_log_column *column_of(const imk_identify_log *log, size_t channel)
{
    return imk_even_record_column(&log->record, channel);
}

/* 0: absent, or kept from its value by outliers or by movements. */
static double white_of(const imk_identify_log *log, size_t channel)
{
    const imk_estimate *white = &log->result[channel].term[IMK_NOISE_WHITE];
    const imk_screen *screen = &log->screen[channel];
    return white->present && !screen->heavy_tails && screen->moved.count == 0 ? white->value : 0;
}

/* The three axes of a kind; false where there are not exactly these, or one has no white noise. */
static bool triad_of(const imk_identify_log *log, imk_channel_kind kind, size_t axis[3])
{
    unsigned found = 0;
    for (size_t c = 0; c < log->record.count; c++) {
        const imk_log_column *column = column_of(log, c);
        if (imk_channel_kind_of(column) != kind)
            continue;
        if (column->axis < 0 || column->axis > 2 || !(white_of(log, c) > 0))
            return false;
        axis[column->axis] = c;
        found |= 1U << column->axis;
    }
    return found == 7;
}

/* The unit of numbers that are `factor` times those of the other axes; NULL: of no common one. */
static const char *unit_of_factor(const imk_log_column *column, double factor)
{
    static const char *const names[] = {"m/s^2", "g", "mg", "deg/s", "rad/s", "deg/h", "mdeg/s"};
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
        const imk_unit unit = imk_unit_of(names[k]);
        const double apart = factor * unit.scale / column->unit.scale;
        if (imk_dimension_equal(unit.dimension, column->unit.dimension) && apart < unit_near &&
            apart > 1 / unit_near)
            return names[k];
    }
    return NULL;
}

static void tell_axis(imk_verdict *v, const imk_identify_log *log, size_t channel, double factor)
{
    const imk_log_column *column = column_of(log, channel);
    const char *unit = unit_of_factor(column, factor);
    const char *more = factor > 1 ? "larger" : "smaller";
    const double times = factor > 1 ? factor : 1 / factor;
    const char *clause = imk_result_key(
        v->result, "the white noise of %s is %.*f times %s than that of the other two axes%s%s",
        column->name, times < 100 ? 1 : 0, times, more, unit ? ", as if it were in " : "",
        unit ? unit : "");
    imki_verdict_add(v, IMK_FINDING_WARNING, "axis_differs",
                     "%s; axes of one sensor are more alike: check the unit of this column and the "
                     "order of the columns.",
                     clause);
    if (v->count > 0)
        v->message[v->count - 1].clause = clause;
}

static void assess_triad(imk_verdict *v, const imk_identify_log *log, imk_channel_kind kind)
{
    size_t axis[3];
    if (!triad_of(log, kind, axis))
        return;
    for (int k = 0; k < 3; k++) {
        const double own = white_of(log, axis[k]), one = white_of(log, axis[(k + 1) % 3]),
                     other = white_of(log, axis[(k + 2) % 3]);
        const double factor = own / sqrt(one * other);
        if (((own > factor_most * one && own > factor_most * other) ||
             (factor_most * own < one && factor_most * own < other)) &&
            fabs(log10(factor)) < log10(factor_believed))
            tell_axis(v, log, axis[k], factor);
    }
}

/* Rates and noises beyond those of gyros at rest. */
static void assess_gyros(imk_verdict *v, const imk_identify_log *log)
{
    const double degree = imk_unit_of("deg").scale;
    imki_text list = {.bytes = NULL};
    uint64_t channels = 0;
    for (size_t c = 0; c < log->record.count; c++) {
        const imk_log_column *column = column_of(log, c);
        const double walk = white_of(log, c) / degree * 60, mean = log->result[c].mean / degree;
        if (imk_channel_kind_of(column) != IMK_CHANNEL_GYRO ||
            !imk_dimension_equal(column->unit.dimension, imk_unit_of("rad/s").dimension) ||
            !(walk > walk_most || fabs(mean) > mean_most))
            continue;
        channels |= (uint64_t)1 << c;
        imki_text_add(&list, "%s%s (%.3g deg/s, angle random walk %.3g deg/sqrt(h))",
                      list.size > 0 ? ", " : "", column->name, mean, walk);
    }
    imki_verdict_list(v, IMK_FINDING_WARNING, "gyro_size",
                      "no gyro at rest has such a mean or such noise: ", &list,
                      "; the unit is wrong (deg/s read as rad/s are 57.3 times too large), or the "
                      "sensor turned: check the header or --gyro-unit.");
    if (channels)
        imki_verdict_about(v, &log->record, channels);
}

void imki_assess_axes(imk_verdict *v, const imk_identify_log *log)
{
    assess_triad(v, log, IMK_CHANNEL_GYRO);
    assess_triad(v, log, IMK_CHANNEL_ACCEL);
    assess_gyros(v, log);
}
