/* SPDX-License-Identifier: Apache-2.0 */
/* Identified terms as tables: a row for each term and channel. */
#include "identify_show_internal.h"
#include "verdict_concern_internal.h"

#include "imukit/identify_plan.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* The channels of a kind, and the table that their terms go to. */
typedef struct term_table {
    imk_table *table;
    const imk_identify_log *log;
    const size_t *member;
    size_t members;
} term_table;

/* One estimate per member; NULL: none on that channel. */
static void estimate_rows(const term_table *t, const char *name, imk_unit unit,
                          const imk_estimate *const *estimates)
{
    for (size_t k = 0; k < t->members; k++) {
        const imk_estimate *e = estimates[k];
        if (!e)
            continue;
        imk_table_row(t->table, "%s\t%s\t%s\t%s\t%s", name,
                      imk_channel_axis_name(imk_even_record_column(&t->log->record, t->member[k])),
                      e->present ? imki_plus_minus(e->value, e->sigma, unit.scale).text : "absent",
                      imki_interval(e, unit.scale).text, unit.text);
        name = "";
    }
}

/* What logs at several rates have told of a channel. */
static const imk_reading_parts *parts_of(const imk_identify_log *log, size_t channel)
{
    return log->readings && log->readings[channel].kind != IMK_READING_UNTOLD
               ? &log->readings[channel]
               : NULL;
}

/* What was counted, and what was white noise of the integral. */
static void reading_rows(const term_table *t)
{
    const imk_identify_log *log = t->log;
    const size_t *member = t->member, members = t->members;
    const imk_log_column *column = imk_even_record_column(&log->record, member[0]);
    const imk_estimate *rows[2][IMK_LOG_COLUMNS_MAX] = {{NULL}};
    bool any[2] = {false, false}, alone = false;
    for (size_t k = 0; k < members; k++) {
        const imk_identification *r = &log->result[member[k]];
        const imk_estimate *e = &r->term[IMK_NOISE_QUANTIZATION];
        const bool white = e->present && !imk_identification_counted(r);
        if (parts_of(log, member[k]))
            continue;
        alone = true;
        rows[white][k] = e;
        any[white] = any[white] || e->present;
    }
    const imk_term_display display[2] = {imk_channel_term(column, IMK_NOISE_QUANTIZATION),
                                         imk_channel_angle_white(column, log->record.dt)};
    for (int white = 0; white < 2 && alone; white++) {
        if (white ? !any[1] : any[1] && !any[0])
            continue;
        for (size_t k = 0; k < members && !any[!white]; k++)
            rows[white][k] = rows[white][k] ? rows[white][k] : rows[!white][k];
        estimate_rows(t, display[white].name, display[white].unit, rows[white]);
    }
}

/* What logs at several rates have parted. */
static void parted_rows(const term_table *t)
{
    const imk_identify_log *log = t->log;
    const size_t *member = t->member, members = t->members;
    const imk_log_column *column = imk_even_record_column(&log->record, member[0]);
    const imk_term_display display[2] = {imk_channel_reading_noise(column),
                                         imk_channel_angle_white(column, 1)};
    const imk_estimate *rows[2][IMK_LOG_COLUMNS_MAX] = {{NULL}};
    bool any = false;
    for (size_t k = 0; k < members; k++) {
        const imk_reading_parts *parts = parts_of(log, member[k]);
        rows[0][k] = parts ? &parts->reading_noise : NULL;
        rows[1][k] = parts ? &parts->angle_white : NULL;
        any = any || parts;
    }
    for (int white = 0; white < 2 && any; white++)
        estimate_rows(t, display[white].name, display[white].unit, rows[white]);
}

static void term_rows(const term_table *t)
{
    const imk_identify_log *log = t->log;
    const size_t *member = t->member, members = t->members;
    const imk_log_column *column = imk_even_record_column(&log->record, member[0]);
    const imk_unit unit = imk_channel_term(column, IMK_NOISE_BIAS_INSTABILITY).unit;
    const imk_estimate *estimates[IMK_LOG_COLUMNS_MAX], *times[IMK_LOG_COLUMNS_MAX];
    reading_rows(t);
    parted_rows(t);
    for (int term = IMK_NOISE_WHITE; term < IMK_NOISE_TERMS; term++) {
        const imk_term_display display = imk_channel_term(column, (imk_noise_term)term);
        for (size_t k = 0; k < members; k++)
            estimates[k] = &log->result[member[k]].term[term];
        /* Each of several records has a ramp of its own. */
        if (log->origin != IMK_IDENTIFY_RECORDS || term != IMK_NOISE_RAMP)
            estimate_rows(t, display.name, display.unit, estimates);
    }
    for (int n = 0; n < IMK_TERMS_MAX; n++) {
        for (size_t k = 0; k < members; k++) {
            const imk_identification *r = &log->result[member[k]];
            const bool has = n < r->gauss_markov_count;
            estimates[k] = has ? &r->gauss_markov[n].sigma : NULL;
            times[k] = has ? &r->gauss_markov[n].correlation_time : NULL;
        }
        estimate_rows(t, "Gauss-Markov sigma", unit, estimates);
        estimate_rows(t, "correlation time", imk_unit_of("s"), times);
    }
}

static void value_row(const term_table *t, size_t channel, const char *name, double value,
                      imk_unit unit)
{
    imk_table_row(t->table, "%s\t%s\t%.4g\t-\t%s", name,
                  imk_channel_axis_name(imk_even_record_column(&t->log->record, channel)),
                  value / unit.scale, unit.text);
}

/* Lines, resonances and filter are found, each at its own frequency, and have no intervals. */
static void part_rows(const term_table *t)
{
    char name[96];
    for (size_t k = 0; k < t->members; k++) {
        const size_t channel = t->member[k];
        const imk_identification *r = &t->log->result[channel];
        for (int i = 0; i < r->sinusoid_count; i++) {
            const double amplitude = r->sinusoid[i].amplitude;
            imki_part_name(r, IMK_IDENTIFIED_SINUSOID, i, sizeof name, name);
            value_row(t, channel, name, amplitude, imki_concern_unit(t->log, channel, amplitude));
        }
        for (int i = 0; i < r->resonance_count; i++) {
            const double sigma = r->resonance[i].sigma;
            imki_part_name(r, IMK_IDENTIFIED_RESONANCE, i, sizeof name, name);
            snprintf(name + strlen(name), sizeof name - strlen(name), ", Q %.3g",
                     r->resonance[i].q);
            value_row(t, channel, name, sigma, imki_concern_unit(t->log, channel, sigma));
        }
        if (r->filter.bandwidth > 0)
            value_row(t, channel, "output filter, bandwidth", r->filter.bandwidth,
                      imk_unit_of("Hz"));
        if (r->filter.damping > 0)
            value_row(t, channel, "output filter, damping", r->filter.damping, imk_unit_of("1"));
    }
}

static void range_cell(imk_table *table, double from, double to)
{
    if (isfinite(from) && from <= to)
        imk_table_add(table, "%.3g to %.3g", from, to);
    else
        imk_table_add(table, "nowhere");
}

/* Mean, the Allan floor beside B, and the averaging times at which the model holds. */
static void show_records(const term_table *t, const char *kind, imk_result *result)
{
    const imk_identify_log *log = t->log;
    const imk_log_column *column = imk_even_record_column(&log->record, t->member[0]);
    const imk_unit floor_unit = imk_channel_term(column, IMK_NOISE_BIAS_INSTABILITY).unit;
    double largest = 0;
    for (size_t k = 0; k < t->members; k++)
        largest = fmax(largest, fabs(log->result[t->member[k]].mean));
    const imk_unit mean_unit = imk_channel_readable_unit(column, largest);
    imk_table *table = imk_result_table(result, 0);
    imk_table_row(table,
                  "%s\tmean [%s]\tAllan minimum / 0.664 [%s]\tmodel holds, tau [s]\tfive terms "
                  "hold [s]",
                  kind, mean_unit.text, floor_unit.text);
    for (size_t k = 0; k < t->members; k++) {
        const imk_identification *r = &log->result[t->member[k]];
        imk_table_row(table, "%s\t%.5g\t%.4g",
                      imk_channel_axis_name(imk_even_record_column(&log->record, t->member[k])),
                      r->mean / mean_unit.scale, r->minimum_floor / floor_unit.scale);
        range_cell(table, r->valid_from, r->valid_to);
        range_cell(table, r->five_terms_from, r->valid_to);
    }
    imk_result_gap(result);
}

void imki_identify_tables(const imk_identify_log *log, imk_result *result)
{
    for (imk_channel_kind kind = IMK_CHANNEL_GYRO; kind < IMK_CHANNEL_KINDS; kind++) {
        size_t member[IMK_LOG_COLUMNS_MAX];
        term_table t = {
            .log = log, .member = member, .members = imki_members(&log->record, kind, member)};
        if (t.members == 0)
            continue;
        t.table = imk_result_table(result, 0);
        imk_table_row(t.table, "%s\taxis\tvalue ± 1 sigma\t%g %% interval\tunit",
                      imk_channel_kind_name(kind), 100 * log->settings.confidence);
        term_rows(&t);
        part_rows(&t);
        imk_result_gap(result);
        if (log->origin == IMK_IDENTIFY_RECORD)
            show_records(&t, imk_channel_kind_name(kind), result);
    }
}

/* The true value of a term in a model, SI; NaN when the model has no such axis. What an estimate
 * without the model's filter tends to is the truth that the log can show. */
static double true_value(const imk_identify_shown *shown, size_t channel, imk_noise_term term)
{
    const imk_log_column *column = imk_even_record_column(&shown->log->record, channel);
    const imk_identification *r = &shown->log->result[channel];
    const imk_triad *triad =
        column->quantity == IMK_QUANTITY_ANGULAR_RATE ? &shown->truth->gyro : &shown->truth->accel;
    if (!triad->present || column->axis < 0 || column->axis >= triad->axis_count)
        return (double)NAN;
    const double dt = shown->log->record.dt;
    const imk_identify_seen seen =
        r->filter.bandwidth > 0
            ? (imk_identify_seen){triad->noise.white.value[column->axis],
                                  imk_noise_reading(&triad->noise, column->axis, dt)}
            : imk_identify_seen_of(triad, column->axis, dt, shown->log->duration,
                                   r->term[IMK_NOISE_QUANTIZATION].present);
    const double value[IMK_NOISE_TERMS] = {
        seen.reading, seen.white, triad->noise.bias_instability.value[column->axis],
        triad->noise.random_walk.value[column->axis], triad->noise.ramp.value[column->axis]};
    return value[term];
}

static void truth_row(imk_table *table, const imk_log_column *column,
                      const imk_term_display *display, double truth, const imk_estimate *e,
                      size_t *covered)
{
    if (isnan(truth) || (truth == 0 && !e->present))
        return;
    const double scale = display->unit.scale;
    const bool inside = truth >= e->lower && truth <= e->upper;
    imk_table_row(table, "%s\t%s\t%.4g\t%s\t%s\t%s\t%s", column->name, display->name, truth / scale,
                  e->present ? imki_value(e->value / scale, e->sigma / scale, 4).text : "absent",
                  imki_range(e->lower, e->upper, scale).text, display->unit.text,
                  inside ? "yes" : "no");
    *covered += inside;
}

static void truth_rows(imk_table *table, const imk_identify_shown *shown, size_t channel,
                       size_t *covered)
{
    const imk_identify_log *log = shown->log;
    const imk_log_column *column = imk_even_record_column(&log->record, channel);
    const imk_reading_parts *parts = parts_of(log, channel);
    const int terms = log->origin == IMK_IDENTIFY_RECORDS ? IMK_NOISE_RAMP : IMK_NOISE_TERMS;
    const imk_triad *triad = imk_model_triad(
        shown->truth, column->quantity == IMK_QUANTITY_ANGULAR_RATE ? IMK_GYRO : IMK_ACCEL);
    if (parts && triad->present && column->axis >= 0 && column->axis < triad->axis_count) {
        const imk_term_display reading = imk_channel_reading_noise(column);
        const imk_term_display white = imk_channel_angle_white(column, 1);
        truth_row(table, column, &reading,
                  hypot(triad->noise.reading_noise.value[column->axis],
                        triad->noise.quantization.value[column->axis]),
                  &parts->reading_noise, covered);
        truth_row(table, column, &white, triad->noise.angle_white.value[column->axis],
                  &parts->angle_white, covered);
    }
    for (int term = parts ? IMK_NOISE_WHITE : 0; term < terms; term++) {
        const imk_identification *r = &log->result[channel];
        const imk_term_display display = imk_identified_term(column, r, (imk_noise_term)term);
        const double truth = true_value(shown, channel, (imk_noise_term)term);
        truth_row(table, column, &display, term == IMK_NOISE_RAMP ? truth : fabs(truth),
                  &r->term[term], covered);
    }
}

void imki_truth_table(const imk_identify_shown *shown, imk_result *result)
{
    const imk_even_record *record = &shown->log->record;
    size_t covered = 0;
    imk_table *table = imk_result_table(result, 0);
    imk_table_row(table, "channel\tterm\ttruth\testimate\tinterval\tunit\tcovered");
    for (size_t c = 0; c < record->count; c++)
        if (imk_channel_kind_of(imk_even_record_column(record, c)) != IMK_CHANNEL_OTHER)
            truth_rows(table, shown, c, &covered);
    if (shown->log->origin == IMK_IDENTIFY_RECORDS)
        imk_result_gap(result);
    imk_result_line(result, "%zu of %zu intervals cover the truth; %g %% are expected to.", covered,
                    table ? imk_table_rows(table) - 1 : 0, 100 * shown->log->settings.confidence);
    imk_result_gap(result);
}
