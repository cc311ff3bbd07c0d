/* SPDX-License-Identifier: Apache-2.0 */
/* What is wrong with the samples of a log, taken out before they are identified, and told. */
#include "identify_parts.h"

#include "shell/json_output.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Names of the channels for which something holds, with what was found on each in parentheses. */
typedef bool (*finding)(const identification *i, size_t channel, char *text, size_t size);

static bool list_of(const identification *i, finding find, char *list, size_t size)
{
    size_t used = 0;
    list[0] = '\0';
    for (size_t c = 0; c < i->found->record.count && used < size; c++) {
        char text[160];
        if (find(i, c, text, sizeof text))
            used += (size_t)snprintf(list + used, size - used, "%s%s (%s)", used ? ", " : "",
                                     log_channel_column(&i->found->record, c)->name, text);
    }
    return used > 0;
}

static imk_unit unit_for(const identification *i, size_t channel, double value)
{
    return channel_readable_unit(log_channel_column(&i->found->record, channel), value);
}

static bool find_outliers(const identification *i, size_t channel, char *text, size_t size)
{
    const imk_screen *s = &i->found->screen[channel];
    const imk_unit unit = unit_for(i, channel, s->largest_outlier);
    snprintf(text, size, "%zu, the largest %.3g %s or %.3g standard deviations off",
             s->outliers.count, s->largest_outlier / unit.scale, unit.text,
             s->noise > 0 ? s->largest_outlier / s->noise : (double)INFINITY);
    return s->outliers.count > 0;
}

static bool find_stuck(const identification *i, size_t channel, char *text, size_t size)
{
    const imk_screen *s = &i->found->screen[channel];
    snprintf(text, size, "%zu samples in %zu %s, the longest of %zu", s->stuck.count, s->stuck.runs,
             s->stuck.runs == 1 ? "run" : "runs", s->longest_stuck);
    return s->stuck.count > 0;
}

static bool find_saturated(const identification *i, size_t channel, char *text, size_t size)
{
    const imk_screen *s = &i->found->screen[channel];
    snprintf(text, size, "%zu samples", s->saturated.count);
    return s->saturated.count > 0;
}

static bool find_warm_up(const identification *i, size_t channel, char *text, size_t size)
{
    const imk_screen *s = &i->found->screen[channel];
    const imk_unit unit = unit_for(i, channel, s->warm_up_amplitude);
    const double width = s->warm_up_amplitude_sigma / unit.scale;
    char amplitude[40], sigma[40], time[40], time_sigma[40];
    format_value(s->warm_up_amplitude / unit.scale, width, 3, amplitude, sizeof amplitude);
    format_value(width, width, 2, sigma, sizeof sigma);
    format_value(s->warm_up_time, s->warm_up_time_sigma, 3, time, sizeof time);
    format_value(s->warm_up_time_sigma, s->warm_up_time_sigma, 2, time_sigma, sizeof time_sigma);
    snprintf(text, size, "%s ± %s %s at the start, falling with %s ± %s s", amplitude, sigma,
             unit.text, time, time_sigma);
    return s->warm_up;
}

static bool find_temperature(const identification *i, size_t channel, char *text, size_t size)
{
    const imk_screen *s = &i->found->screen[channel];
    const imk_unit unit = unit_for(i, channel, s->temperature_slope);
    const double width = s->temperature_slope_sigma / unit.scale;
    char slope[40], sigma[40];
    format_value(s->temperature_slope / unit.scale, width, 3, slope, sizeof slope);
    format_value(width, width, 2, sigma, sizeof sigma);
    snprintf(text, size, "%s ± %s %s/degC%s", slope, sigma, unit.text,
             s->temperature_degree > 1 ? " and a curvature" : "");
    return s->temperature_degree > 0;
}

static bool find_steps(const identification *i, size_t channel, char *text, size_t size)
{
    const imk_screen *s = &i->found->screen[channel];
    const imk_unit unit = unit_for(i, channel, s->largest_step);
    snprintf(text, size, "%zu, the largest %.3g %s at %.5g s", s->steps.count,
             s->largest_step / unit.scale, unit.text, (double)s->steps.first * i->found->record.dt);
    return s->steps.count > 0;
}

static bool find_missing(const identification *i, size_t channel, char *text, size_t size)
{
    /* Not what was taken out: other sentences tell of it. */
    const imk_screen *s = &i->found->screen[channel];
    const imk_identification *r = &i->found->result[channel];
    const size_t missing = i->found->screened ? s->missing.count : r->missing;
    const double gap =
        i->found->screened ? (double)s->longest_hole * i->found->record.dt : r->largest_gap;
    snprintf(text, size, "%.3g %%, longest gap %.3g s",
             100 * (double)missing / (double)i->found->record.rows, gap);
    return missing > 0;
}

/* What each finding means, taken out or kept. */
static const struct {
    finding find;
    unsigned bit; /* 0: nothing is taken out */
    verdict_level level;
    const char *code, *done, *kept;
} findings[] = {
    {find_outliers, IMK_SCREEN_OUTLIERS, VERDICT_NOTE, "outliers",
     "outliers, left out of the estimate", "outliers, kept"},
    {find_stuck, IMK_SCREEN_STUCK, VERDICT_NOTE, "stuck",
     "one value repeated longer than the noise allows, left out", "one value repeated, kept"},
    {find_saturated, IMK_SCREEN_SATURATED, VERDICT_NOTE, "at_limit",
     "samples at the end of the range, left out", "samples at the end of the range, kept"},
    {find_warm_up, IMK_SCREEN_WARM_UP, VERDICT_NOTE, "warm_up_removed",
     "a warm-up at the start, subtracted", "a warm-up at the start, kept"},
    {find_temperature, IMK_SCREEN_TEMPERATURE, VERDICT_NOTE, "temperature",
     "the readings follow the temperature; subtracted",
     "the readings follow the temperature; kept"},
    {find_steps, 0, VERDICT_WARNING, "steps",
     "the level jumps: the sensor was touched, or its range or filter was changed; the slow terms "
     "take it for noise",
     NULL},
    {find_missing, 0, VERDICT_NOTE, "missing",
     "samples that are not there; the estimate is that of what is there, and its intervals are "
     "as wide as that makes them",
     NULL}};

void identify_judge_samples(identification *i)
{
    if (!i->found->screened && !i->joint)
        identify_add_sentence(i, VERDICT_NOTE, "not_screened",
                              "the log is longer than what is held in memory: outliers, steps, the "
                              "warm-up and the temperature were not looked for.");
    for (size_t k = 0; k < sizeof findings / sizeof findings[0]; k++) {
        char list[600];
        if (!i->found->screened && findings[k].find != find_missing)
            continue;
        if (!list_of(i, findings[k].find, list, sizeof list))
            continue;
        const bool kept = findings[k].bit && !(i->found->settings.take_out & findings[k].bit);
        identify_add_sentence(i, findings[k].level, findings[k].code, "%s: %s.", list,
                              kept ? findings[k].kept : findings[k].done);
    }
}

static json_t *count_json(const imk_screen_count *c)
{
    return json_pack("{s:I, s:I, s:I}", "samples", (json_int_t)c->count, "runs",
                     (json_int_t)c->runs, "first", (json_int_t)c->first);
}

json_t *identify_screen_json(const identification *i, size_t channel)
{
    const imk_screen *s = &i->found->screen[channel];
    const imk_unit plain = channel_plain_unit(log_channel_column(&i->found->record, channel));
    if (!i->found->screened)
        return json_null();
    json_t *warm_up = json_null(), *temperature = json_null();
    if (s->warm_up)
        warm_up = json_pack("{s:o, s:o, s:o, s:o}", "amplitude",
                            json_quantity(s->warm_up_amplitude / plain.scale, plain.text),
                            "amplitude_sigma",
                            json_quantity(s->warm_up_amplitude_sigma / plain.scale, plain.text),
                            "time", json_quantity(s->warm_up_time, "s"), "time_sigma",
                            json_quantity(s->warm_up_time_sigma, "s"));
    if (s->temperature_degree > 0) {
        char unit[64];
        snprintf(unit, sizeof unit, "%.40s/K", plain.text);
        temperature =
            json_pack("{s:i, s:o, s:o}", "degree", s->temperature_degree, "slope",
                      json_quantity(s->temperature_slope / plain.scale, unit), "slope_sigma",
                      json_quantity(s->temperature_slope_sigma / plain.scale, unit));
    }
    return json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "missing", count_json(&s->missing),
                     "outliers", count_json(&s->outliers), "stuck", count_json(&s->stuck),
                     "saturated", count_json(&s->saturated), "steps", count_json(&s->steps),
                     "warm_up", warm_up, "temperature", temperature);
}
