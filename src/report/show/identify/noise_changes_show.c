/* SPDX-License-Identifier: Apache-2.0 */
/* Noise over time: what the verdict says about changes, bursts and tails; the map as data and as a
 * figure. */
#include "identify_show_internal.h"

#include "report/result_internal.h"

#include <math.h>
#include <stdio.h>

enum { TIMES_MAX = 32, CURVES_MAX = 6 }; /* of the data; of a panel */

/* ---- verdict --------------------------------------------------------------------------------- */

static double tau_of(const imk_identify_log *log, size_t octave)
{
    return log->record.dt * (double)((size_t)1 << octave);
}

/* "0.15 until 1800 s, 0.3 until 3600 s" of N or B. */
static void put_values(const imk_identify_log *log, size_t channel, int term, imki_text *text)
{
    const imk_noise_changes *c = &log->changes[channel];
    const imk_term_display display =
        imk_channel_term(imk_even_record_column(&log->record, channel), (imk_noise_term)term);
    imki_text_add(text, "%s [%s] ", display.name, display.unit.text);
    for (size_t k = 0; k < c->segment_count; k++) {
        const imk_noise_segment *s = &c->segment[k];
        const imk_estimate *e = term == IMK_NOISE_WHITE ? &s->white : &s->bias_instability;
        imki_text_add(text, "%s%s until %.5g s", k > 0 ? ", " : "",
                      imki_plus_minus(e->value, e->sigma, display.unit.scale).text,
                      (double)s->end * log->record.dt);
    }
}

static void put_deviation(const imk_identify_log *log, size_t channel, imki_text *text)
{
    const imk_noise_changes *c = &log->changes[channel];
    const imk_noise_segment *s = &c->segment[c->strange];
    const imk_unit unit =
        imk_channel_readable_unit(imk_even_record_column(&log->record, channel), c->of_record);
    imki_text_add(text, "Allan deviation at %.3g s %.3g %s in the log, %.3g from %.5g s to %.5g s",
                  tau_of(log, c->octave), c->of_record / unit.scale, unit.text,
                  c->deviation / unit.scale, (double)s->first * log->record.dt,
                  (double)s->end * log->record.dt);
}

/* The averaging times at which something changed. */
static void put_band(const imk_identify_log *log, size_t channel, imki_text *text)
{
    const unsigned changed = log->changes[channel].changed;
    size_t low = 0, high = 0;
    for (size_t j = IMK_NOISE_MAP_OCTAVES; j-- > 0;)
        low = changed >> j & 1 ? j : low;
    for (size_t j = 0; j < IMK_NOISE_MAP_OCTAVES; j++)
        high = changed >> j & 1 ? j : high;
    if (high > low)
        imki_text_add(text, "; seen at averaging times of %.3g s to %.3g s", tau_of(log, low),
                      tau_of(log, high));
    else
        imki_text_add(text, "; seen at averaging times of %.3g s", tau_of(log, low));
}

static void put_changes(const imk_identify_log *log, size_t channel, imki_text *text)
{
    const imk_noise_changes *c = &log->changes[channel];
    const imk_noise_segment *s = &c->segment[c->strange];
    if ((c->term == IMK_NOISE_WHITE && s->white.present) ||
        (c->term == IMK_NOISE_BIAS_INSTABILITY && s->bias_instability.present))
        put_values(log, channel, c->term, text);
    else
        put_deviation(log, channel, text);
    put_band(log, channel, text);
}

static void put_bursts(const imk_identify_log *log, size_t channel, imki_text *text)
{
    const imk_noise_changes *c = &log->changes[channel];
    imki_text_add(text,
                  "averaging times of %.3g s: the strength scatters %.3g times as much over "
                  "the log as that of steady noise",
                  tau_of(log, c->scatter_octave), sqrt(c->scatter));
}

static void put_tails(const imk_identify_log *log, size_t channel, imki_text *text)
{
    const imk_noise_changes *c = &log->changes[channel];
    imki_text_add(text, "excess kurtosis %.2g, Gaussian 0 within %.1g", c->kurtosis,
                  2 * c->kurtosis_sigma);
}

typedef enum subject { CHANGES, SMALL_CHANGES, SWELLING, TAILS, SUBJECTS } subject;

static bool applies(const imk_noise_changes *c, subject about)
{
    switch (about) {
    case CHANGES:
        return c->changed != 0 && c->matters;
    case SMALL_CHANGES:
        return c->changed != 0 && !c->matters;
    case SWELLING:
        return c->bursts;
    default:
        return c->heavy_tails && !c->bursts;
    }
}

static void put_detail(const imk_identify_log *log, size_t channel, subject about, imki_text *text)
{
    if (about == SWELLING)
        put_bursts(log, channel, text);
    else if (about == TAILS)
        put_tails(log, channel, text);
    else
        put_changes(log, channel, text);
}

void imki_verdict_noise_changes(imk_verdict *v, const imk_identify_log *log)
{
    static const struct {
        imk_finding_level level;
        const char *code, *text;
    } messages[SUBJECTS] = {
        {IMK_FINDING_WARNING, "noise_changes",
         ": the noise changes with time, so no single value describes the log; look for what was "
         "switched on or touched then, or identify the parts of the log separately."},
        {IMK_FINDING_NOTE, "noise_changes",
         ": the noise changes with time, by too little to matter."},
        {IMK_FINDING_WARNING, "bursts",
         ": the noise comes in bursts, as from vibration or interference that comes and goes; the "
         "values are means over the bursts."},
        {IMK_FINDING_NOTE, "gaussian",
         ": the white noise has heavier tails than Gaussian noise, in every part of the log; its "
         "strength is that of all samples together, and its interval allows for the tails. If a "
         "program made single samples noisier or weaker, that of the sensor differs."}};
    for (int about = 0; about < SUBJECTS; about++) {
        imki_text list = {.bytes = NULL};
        uint64_t channels = 0;
        for (size_t c = 0; c < log->record.count; c++) {
            if (!log->map[c] || !applies(&log->changes[c], (subject)about))
                continue;
            channels |= (uint64_t)1 << c;
            imki_text_add(&list, "%s%s (", list.size > 0 ? ", " : "",
                          imk_even_record_column(&log->record, c)->name);
            put_detail(log, c, (subject)about, &list);
            imki_text_put(&list, ")");
        }
        imki_verdict_list(v, messages[about].level, messages[about].code, "", &list,
                          messages[about].text);
        if (channels)
            imki_verdict_about(v, &log->record, channels);
    }
}

/* ---- data ------------------------------------------------------------------------------------ */

/* Columns of the map that make one column of the data. */
static size_t width_of(const imk_noise_map *map)
{
    return (imk_noise_map_blocks(map) + TIMES_MAX - 1) / TIMES_MAX;
}

static void map_data(const imk_identify_log *log, size_t channel, imk_unit unit, imk_result *result)
{
    const imk_noise_map *map = log->map[channel];
    const size_t width = width_of(map), blocks = imk_noise_map_blocks(map);
    const size_t octaves = imk_noise_map_octaves(map);
    imk_result_object(result, "map");
    imk_result_array(result, "time");
    for (size_t b = 0; b < blocks; b += width)
        imk_result_number(result, NULL, (double)(b * map->block) * log->record.dt);
    imk_result_end(result);
    imk_result_array(result, "tau");
    for (size_t j = 0; j < octaves; j++)
        imk_result_number(result, NULL, tau_of(log, j));
    imk_result_end(result);
    imk_result_text(result, "unit", unit.text);
    imk_result_array(result, "deviation");
    for (size_t b = 0; b < blocks; b += width) {
        imk_result_array(result, NULL);
        for (size_t j = 0; j < octaves; j++) {
            const imk_estimate e = imk_noise_map_deviation(map, j, b, b + width, 0.95);
            imk_result_number(result, NULL, e.present ? e.value / unit.scale : (double)NAN);
        }
        imk_result_end(result);
    }
    imk_result_end(result);
    imk_result_end(result);
}

static void strength_data(const imk_identify_log *log, size_t channel, int term,
                          const imk_estimate *e, imk_result *result)
{
    const imk_log_column *column = imk_even_record_column(&log->record, channel);
    const bool other = imk_channel_kind_of(column) == IMK_CHANNEL_OTHER;
    const imk_term_display display = imk_channel_term(column, (imk_noise_term)term);
    const double scale = other ? display.unit.scale : 1;
    if (!imki_begin_object(result, imk_result_key(result, "%s", display.key), e->present))
        return;
    imk_result_number(result, "value", e->value / scale);
    imk_result_number(result, "lower", e->lower / scale);
    imk_result_number(result, "upper", e->upper / scale);
    imk_result_text(result, "unit", display.si);
    imk_result_end(result);
}

void imki_noise_changes_data(const imk_identify_log *log, size_t channel, imk_unit unit,
                             imk_result *result)
{
    const imk_noise_changes *c = &log->changes[channel];
    if (!imki_begin_object(result, "noise_over_time", log->map[channel] != NULL))
        return;
    imk_result_flag(result, "changes", c->changed != 0);
    imk_result_number(result, "probability", c->probability);
    imk_result_array(result, "changed_tau");
    for (size_t j = 0; j < IMK_NOISE_MAP_OCTAVES; j++)
        if (c->changed >> j & 1)
            imk_result_number(result, NULL, tau_of(log, j));
    imk_result_end(result);
    imk_result_number(result, "largest_ratio", c->ratio);
    imk_result_array(result, "segments");
    for (size_t k = 0; k < c->segment_count; k++) {
        const imk_noise_segment *s = &c->segment[k];
        imk_result_object(result, NULL);
        imk_result_quantity(result, "from", (double)s->first * log->record.dt, "s");
        imk_result_quantity(result, "to", (double)s->end * log->record.dt, "s");
        strength_data(log, channel, IMK_NOISE_WHITE, &s->white, result);
        strength_data(log, channel, IMK_NOISE_BIAS_INSTABILITY, &s->bias_instability, result);
        imk_result_end(result);
    }
    imk_result_end(result);
    imk_result_number(result, "kurtosis", c->gaussian_tested ? c->kurtosis : (double)NAN);
    imk_result_number(result, "kurtosis_sigma",
                      c->gaussian_tested ? c->kurtosis_sigma : (double)NAN);
    imk_result_flag(result, "heavy_tails", c->heavy_tails);
    imk_result_flag(result, "light_tails", c->light_tails);
    imk_result_flag(result, "bursts", c->bursts);
    imk_result_number(result, "scatter", c->scatter);
    map_data(log, channel, unit, result);
    imk_result_end(result);
}

/* ---- figure ---------------------------------------------------------------------------------- */

static size_t wide_enough(const imk_noise_map *map, size_t octave)
{
    enum { LEAST = 32 }; /* differences to a point */
    const size_t need = (LEAST << (octave + 1)) / map->block;
    const size_t width = width_of(map);
    return need > width ? need : width;
}

static void show_octave(const imk_identify_log *log, size_t channel, size_t octave, int color,
                        imk_figure_builder *figure)
{
    const imk_noise_map *map = log->map[channel];
    const size_t width = wide_enough(map, octave), blocks = imk_noise_map_blocks(map);
    const double whole = imk_noise_map_deviation(map, octave, 0, blocks, 0.95).value;
    char label[40];
    snprintf(label, sizeof label, "%.3g s", tau_of(log, octave));
    imki_begin_curve(figure, label, IMK_CURVE_LINE, color);
    for (size_t b = 0; b + width <= blocks; b += width) {
        const imk_estimate e = imk_noise_map_deviation(map, octave, b, b + width, 0.95);
        const double time = ((double)b + 0.5 * (double)width) * (double)map->block;
        if (e.present)
            imk_figure_point(figure, time * log->record.dt, e.value / whole);
    }
}

static void show_channel(const imk_identify_log *log, size_t channel, imk_figure_builder *figure)
{
    const imk_noise_map *map = log->map[channel];
    size_t octaves = imk_noise_map_octaves(map);
    while (octaves > 1 && 3 * wide_enough(map, octaves - 1) > imk_noise_map_blocks(map))
        octaves--;
    const size_t every = (octaves + CURVES_MAX - 1) / CURVES_MAX;
    imk_figure_panel(figure,
                     &(imk_panel){.title = imk_even_record_column(&log->record, channel)->name,
                                  .x_label = "time [s]",
                                  .y_label = "Allan deviation over that of the log"});
    int color = 0;
    for (size_t j = 0; j < octaves; j += every)
        show_octave(log, channel, j, color++, figure);
}

void imki_noise_changes_figure(const imk_identify_shown *shown, imk_result *result)
{
    const imk_identify_log *log = shown->log;
    const size_t count = log->record.count, columns = count % 3 == 0 ? 3 : count % 2 == 0 ? 2 : 1;
    bool all = count > 0;
    for (size_t c = 0; c < count; c++)
        all = all && log->map[c];
    if (!all)
        return;
    imk_result_for(result, IMK_FOR_PAGE);
    imk_result_heading(result, "Noise over time");
    imk_figure_builder *figure = imk_result_figure(
        result, shown->name, columns,
        "Allan deviations of parts of the log, over those of the whole log, at the averaging times "
        "of the key. Steady noise scatters about 1, the more, the longer the averaging time.");
    for (size_t c = 0; c < count; c++)
        show_channel(log, c, figure);
}
