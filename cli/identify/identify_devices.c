/* SPDX-License-Identifier: Apache-2.0 */
/* Logs of different sensors: mean and spread of each term over them, and which of them differ.
 *
 * Squares are compared, N^2 and so on: they are nearly normal and known also where a term is
 * absent, so that a sensor without a term counts as one that has little of it. */
#include "identify_several.h"

#include "imukit/distributions.h"

#include <math.h>
#include <string.h>

/* A likelihood profile reaches as far above the likeliest square as the confidence has sigmas. */
static strength strength_of(const imk_estimate *e, double confidence)
{
    const double z = imk_normal_quantile(0.5 + confidence / 2);
    strength s = {.present = e->present, .value = e->value, .sigma = e->sigma, .bound = e->upper};
    const double centre = e->free_value > 0 ? e->free_value : e->value;
    s.square = centre * centre;
    s.square_sigma = e->present ? 2 * e->value * e->sigma : (e->upper * e->upper - s.square) / z;
    return s;
}

static void compare(several_logs *s, size_t channel, int term)
{
    device_term *t = &s->term[channel][term];
    double square[IMK_JOINT_RECORDS_MAX], sigma[IMK_JOINT_RECORDS_MAX];
    bool any = false, all = true;
    for (size_t r = 0; r < s->count; r++) {
        t->device[r] =
            strength_of(&s->log[r]->found->result[channel].term[term], s->options->confidence);
        square[r] = t->device[r].square;
        sigma[r] = t->device[r].square_sigma;
        any = any || t->device[r].present;
        all = all && sigma[r] > 0 && isfinite(sigma[r]);
    }
    if (!any || !all ||
        imk_population_estimate(s->count, square, sigma, s->options->confidence, &t->squares) !=
            IMK_OK)
        return;
    const imk_population *p = &t->squares;
    t->compared = true;
    t->mean = sqrt(fmax(0, p->mean));
    t->lower = sqrt(fmax(0, p->mean_lower));
    t->upper = sqrt(fmax(0, p->mean_upper));
    t->spread = p->spread / (2 * t->mean);
    t->spread_lower = p->spread_lower / (2 * t->mean);
    t->spread_upper = p->spread_upper / (2 * t->mean);
}

/* The two that are farthest apart, in sigmas. */
static double farthest(const device_term *t, size_t count, size_t *low, size_t *high)
{
    double most = -1;
    for (size_t r = 0; r < count; r++)
        for (size_t q = 0; q < count; q++) {
            const strength *a = &t->device[r], *b = &t->device[q];
            const double sigmas = (b->square - a->square) / hypot(a->square_sigma, b->square_sigma);
            if (q != r && sigmas > most) {
                most = sigmas;
                *low = r;
                *high = q;
            }
        }
    return most;
}

static void put_strength(const strength *s, double scale, char *text, size_t size)
{
    char value[40], sigma[40];
    if (!s->present) {
        format_value(s->bound / scale, 0, 2, value, sizeof value);
        snprintf(text, size, "less than %s", value);
        return;
    }
    format_value(s->value / scale, s->sigma / scale, 4, value, sizeof value);
    format_value(s->sigma / scale, s->sigma / scale, 2, sigma, sizeof sigma);
    snprintf(text, size, "%s ± %s", value, sigma);
}

/* What else the model of a channel has, which changes what its terms mean. */
static unsigned kind_of_model(const imk_identification *r)
{
    return (r->gauss_markov_count > 0 ? 1U : 0U) | (r->filter.bandwidth > 0 ? 2U : 0U);
}

static void judge_models(several_logs *s, size_t channel)
{
    static const char *const what[] = {"Gauss-Markov noise", "an output filter"};
    for (unsigned bit = 0; bit < 2; bit++) {
        size_t have = 0, one = 0;
        for (size_t r = 0; r < s->count; r++)
            if (kind_of_model(&s->log[r]->found->result[channel]) >> bit & 1) {
                have++;
                one = r;
            }
        if (have == 0 || have == s->count)
            continue;
        identify_add_sentence(
            s->joint, VERDICT_NOTE, "models_differ",
            "%s: %zu of %zu logs show %s (%s%s); the other terms are what is left "
            "beside it, so compare them with care.",
            log_channel_column(&s->joint->found->record, channel)->name, have, s->count, what[bit],
            s->label[one], have > 1 ? " and others" : "");
    }
}

static void tell_difference(several_logs *s, size_t channel, int term)
{
    const device_term *t = &s->term[channel][term];
    const imk_log_column *column = log_channel_column(&s->joint->found->record, channel);
    const term_display display = identify_term(column, (imk_noise_term)term);
    size_t low = 0, high = 0;
    char less[100], more[100], chance[40];
    const double sigmas = farthest(t, s->count, &low, &high);
    put_strength(&t->device[low], display.unit.scale, less, sizeof less);
    put_strength(&t->device[high], display.unit.scale, more, sizeof more);
    several_chance(t->squares.probability, chance, sizeof chance);
    identify_add_sentence(s->joint, VERDICT_NOTE, "devices_differ",
                          "%s: %s differs: %s %s in %s, %s in %s (%.1f sigmas; chance if all were "
                          "alike %s).",
                          column->name, display.name, more, display.unit.text, s->label[high], less,
                          s->label[low], sigmas, chance);
}

/* All comparisons together raise a false alarm with the probability 1 - confidence at most. */
static void judge(several_logs *s)
{
    identification *j = s->joint;
    size_t compared = 0, differ = 0;
    for (size_t c = 0; c < j->found->record.count; c++)
        for (int term = 0; term < IMK_NOISE_RAMP; term++)
            compared += s->term[c][term].compared;
    const double alarm = (1 - s->options->confidence) / fmax(1, (double)compared);
    for (size_t c = 0; c < j->found->record.count; c++)
        for (int term = 0; term < IMK_NOISE_RAMP; term++)
            if (s->term[c][term].compared && s->term[c][term].squares.probability < alarm) {
                tell_difference(s, c, term);
                differ++;
            }
    for (size_t c = 0; c < j->found->record.count; c++)
        judge_models(s, c);
    if (differ == 0)
        identify_add_sentence(j, VERDICT_GOOD, "devices_agree",
                              "The %zu sensors agree within their joint intervals in all %zu "
                              "parameters compared (%g %% over all of them).",
                              s->count, compared, 100 * s->options->confidence);
    else
        identify_add_sentence(j, VERDICT_GOOD, "devices_spread",
                              "The %zu sensors differ in %zu of %zu parameters compared by more "
                              "than their joint intervals (%g %% over all of them).",
                              s->count, differ, compared, 100 * s->options->confidence);
    if (s->count == 2)
        identify_add_sentence(j, VERDICT_NOTE, "two_devices",
                              "Two sensors tell whether they differ, but next to nothing about the "
                              "spread of their kind.");
}

int several_compare_devices(several_logs *s)
{
    for (size_t c = 0; c < s->joint->found->record.count; c++)
        for (int term = 0; term < IMK_NOISE_RAMP; term++)
            compare(s, c, term);
    judge(s);
    return -1;
}
