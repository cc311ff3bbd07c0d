/* SPDX-License-Identifier: Apache-2.0 */
/* The parameters as tables: one row of values and one of intervals for each term. */
#include "identify_parts.h"

#include <math.h>
#include <string.h>

static size_t members_of(const identification *i, channel_kind kind, size_t *member)
{
    size_t count = 0;
    for (size_t c = 0; c < i->found->record.count; c++)
        if (channel_kind_of(log_channel_column(&i->found->record, c)) == kind)
            member[count++] = c;
    return count;
}

/* One estimate per member (NULL: none on that channel): values, and intervals below them. */
static void estimate_rows(text_table *table, const char *name, const imk_unit *unit,
                          const imk_estimate *const *estimates, size_t members, double confidence)
{
    double scale = unit->scale;
    char value[40], sigma[40], lower[40], upper[40];
    text_table_row(table);
    text_table_set(table, 0, "%s", name);
    text_table_set(table, 1, "%s", unit->text);
    for (size_t k = 0; k < members; k++) {
        const imk_estimate *e = estimates[k];
        if (!e)
            continue;
        if (!e->present) {
            text_table_set(table, 2 + k, "absent");
            continue;
        }
        format_value(e->value / scale, e->sigma / scale, 4, value, sizeof value);
        format_value(e->sigma / scale, e->sigma / scale, 2, sigma, sizeof sigma);
        text_table_set(table, 2 + k, "%s ± %s", value, sigma);
    }
    text_table_row(table);
    text_table_set(table, 1, "%g %%", 100 * confidence);
    for (size_t k = 0; k < members; k++) {
        const imk_estimate *e = estimates[k];
        if (!e)
            continue;
        double width = (e->upper - e->lower) / scale / 4;
        format_value(e->lower / scale, width, 3, lower, sizeof lower);
        format_value(e->upper / scale, e->present ? width : 0, e->present ? 3 : 2, upper,
                     sizeof upper);
        if (e->present)
            text_table_set(table, 2 + k, "%s to %s", lower, upper);
        else
            text_table_set(table, 2 + k, "< %s", upper);
    }
}

static void term_rows(text_table *table, const identification *i, const size_t *member,
                      size_t members)
{
    const imk_log_column *column = log_channel_column(&i->found->record, member[0]);
    const imk_estimate *estimates[IMK_LOG_COLUMNS_MAX];
    double confidence = i->options->confidence;
    for (int term = 0; term < IMK_NOISE_TERMS; term++) {
        if (i->joint && term == IMK_NOISE_RAMP)
            continue; /* each log has its own */
        term_display display = identify_term(column, (imk_noise_term)term);
        for (size_t k = 0; k < members; k++)
            estimates[k] = &i->found->result[member[k]].term[term];
        estimate_rows(table, display.name, &display.unit, estimates, members, confidence);
    }
    imk_unit unit = identify_term(column, IMK_NOISE_BIAS_INSTABILITY).unit;
    imk_unit seconds = imk_unit_of("s");
    for (int n = 0; n < IMK_TERMS_MAX; n++) {
        const imk_estimate *times[IMK_LOG_COLUMNS_MAX];
        bool any = false;
        for (size_t k = 0; k < members; k++) {
            const imk_identification *r = &i->found->result[member[k]];
            bool has = n < r->gauss_markov_count;
            estimates[k] = has ? &r->gauss_markov[n].sigma : NULL;
            times[k] = has ? &r->gauss_markov[n].correlation_time : NULL;
            any = any || has;
        }
        if (!any)
            break;
        estimate_rows(table, "Gauss-Markov sigma", &unit, estimates, members, confidence);
        estimate_rows(table, "correlation time", &seconds, times, members, confidence);
    }
}

/* Mean, the Allan floor beside B, and from which averaging time on the model holds. */
static void record_rows(text_table *table, const identification *i, const size_t *member,
                        size_t members)
{
    const imk_log_column *column = log_channel_column(&i->found->record, member[0]);
    imk_unit floor_unit = identify_term(column, IMK_NOISE_BIAS_INSTABILITY).unit;
    double mean_size = 0;
    for (size_t k = 0; k < members; k++)
        mean_size = fmax(mean_size, fabs(i->found->result[member[k]].mean));
    imk_unit mean_unit = channel_readable_unit(column, mean_size);
    text_table_row(table);
    text_table_set(table, 0, "Allan minimum / 0.664");
    text_table_set(table, 1, "%s", floor_unit.text);
    for (size_t k = 0; k < members; k++)
        text_table_set(table, 2 + k, "%.4g",
                       i->found->result[member[k]].minimum_floor / floor_unit.scale);
    text_table_row(table);
    text_table_set(table, 0, "mean of the record");
    text_table_set(table, 1, "%s", mean_unit.text);
    for (size_t k = 0; k < members; k++)
        text_table_set(table, 2 + k, "%.5g", i->found->result[member[k]].mean / mean_unit.scale);
    for (int five = 0; five < 2; five++) {
        text_table_row(table);
        text_table_set(table, 0, five ? "the five terms alone from" : "model holds from tau =");
        text_table_set(table, 1, "s");
        for (size_t k = 0; k < members; k++) {
            const imk_identification *r = &i->found->result[member[k]];
            double from = five ? r->five_terms_from : r->valid_from;
            if (isfinite(from))
                text_table_set(table, 2 + k, "%.3g", from);
            else
                text_table_set(table, 2 + k, "nowhere");
        }
    }
}

text_table identify_table(const identification *i, channel_kind kind)
{
    size_t member[IMK_LOG_COLUMNS_MAX], members = members_of(i, kind, member);
    text_table table = text_table_make(2 + members);
    if (members == 0)
        return table;
    text_table_row(&table);
    text_table_set(&table, 0, "%s", channel_kind_name(kind));
    text_table_set(&table, 1, "unit");
    for (size_t k = 0; k < members; k++)
        text_table_set(&table, 2 + k, "%s",
                       channel_axis_name(log_channel_column(&i->found->record, member[k])));
    term_rows(&table, i, member, members);
    if (!i->joint && !i->options->curve)
        record_rows(&table, i, member, members);
    return table;
}

/* The true value of a term in a model, SI; NaN when the model has no such axis. */
static double true_value(const imk_model *truth, const imk_log_column *column, imk_noise_term term)
{
    const imk_triad *triad =
        column->quantity == IMK_QUANTITY_ANGULAR_RATE ? &truth->gyro : &truth->accel;
    if (!triad->present || column->axis < 0 || column->axis >= triad->axis_count)
        return (double)NAN;
    const imk_axes *axes[IMK_NOISE_TERMS] = {&triad->noise.quantization, &triad->noise.white,
                                             &triad->noise.bias_instability,
                                             &triad->noise.random_walk, &triad->noise.ramp};
    return axes[term]->value[column->axis];
}

static void truth_row(text_table *table, const identification *i, size_t channel,
                      imk_noise_term term, size_t *covered, size_t *stated)
{
    const imk_log_column *column = log_channel_column(&i->found->record, channel);
    const imk_estimate *e = &i->found->result[channel].term[term];
    double truth = true_value(&i->truth, column, term);
    if (isnan(truth) || (truth == 0 && !e->present) || (i->joint && term == IMK_NOISE_RAMP))
        return;
    term_display display = identify_term(column, term);
    double scale = display.unit.scale, width = (e->upper - e->lower) / scale / 4;
    bool inside = fabs(truth) >= e->lower && fabs(truth) <= e->upper;
    if (term == IMK_NOISE_RAMP)
        inside = truth >= e->lower && truth <= e->upper;
    char text[40];
    text_table_row(table);
    text_table_set(table, 0, "%s", column->name);
    text_table_set(table, 1, "%s", display.name);
    text_table_set(table, 2, "%.4g", truth / scale);
    format_value(e->value / scale, e->sigma / scale, 4, text, sizeof text);
    text_table_set(table, 3, "%s", e->present ? text : "absent");
    char lower[40], upper[40];
    format_value(e->lower / scale, width, 3, lower, sizeof lower);
    format_value(e->upper / scale, width, 3, upper, sizeof upper);
    text_table_set(table, 4, "%s to %s", lower, upper);
    text_table_set(table, 5, "%s", display.unit.text);
    text_table_set(table, 6, "%s", inside ? "yes" : "no");
    *covered += inside;
    *stated += 1;
}

text_table identify_truth_table(const identification *i, size_t *covered, size_t *stated)
{
    static const char *const headers[] = {"channel",  "term", "truth",  "estimate",
                                          "interval", "unit", "covered"};
    text_table table = text_table_make(7);
    *covered = *stated = 0;
    text_table_row(&table);
    for (size_t c = 0; c < 7; c++)
        text_table_set(&table, c, "%s", headers[c]);
    for (size_t c = 0; c < i->found->record.count; c++)
        if (channel_kind_of(log_channel_column(&i->found->record, c)) != CHANNEL_OTHER)
            for (int term = 0; term < IMK_NOISE_TERMS; term++)
                truth_row(&table, i, c, (imk_noise_term)term, covered, stated);
    return table;
}
