/* SPDX-License-Identifier: Apache-2.0 */
/* The verdict on a record in words: what it is good for, and what is wrong with it. */
#include "identify_show_internal.h"

#include <math.h>
#include <string.h>

/* Gravity on the surface of the Earth [m/s^2]: equator to pole by WGS84, rounded outwards; a value
 * more than 5 % outside is not the specific force at rest. */
static const double gravity_least = 9.78 * (1 - 0.05), gravity_most = 9.83 * (1 + 0.05);

/* ---- the record as a whole ------------------------------------------------------------------- */

/* The unit in which the numbers of the file would equal gravity. */
static const char *likely_unit(double magnitude, double scale)
{
    static const char *const names[] = {"m/s^2", "g", "mg", "ug", "Gal", "mGal"};
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
        const double as = magnitude / scale * imk_unit_of(names[k]).scale;
        if (as > gravity_least && as < gravity_most)
            return names[k];
    }
    return NULL;
}

/* The mean specific force of a triad at rest has the size of gravity; otherwise the unit is wrong
 * in most cases. */
static void assess_gravity(imk_verdict *v, const imk_identify_log *log)
{
    double square = 0, scale = 0;
    int axes = 0;
    for (size_t c = 0; c < log->record.count; c++) {
        const imk_log_column *column = imk_even_record_column(&log->record, c);
        if (imk_channel_kind_of(column) != IMK_CHANNEL_ACCEL || column->axis > 2)
            continue;
        square += log->result[c].mean * log->result[c].mean;
        scale = column->unit.scale;
        axes++;
    }
    const double magnitude = sqrt(square);
    if (axes != 3 || (magnitude > gravity_least && magnitude < gravity_most))
        return;
    const char *unit = likely_unit(magnitude, scale);
    if (unit)
        imki_verdict_add(v, IMK_FINDING_WARNING, "gravity",
                         "|accel| is %.4g m/s^2 at rest: the numbers look like %s; write %s into "
                         "the header, or add --accel-unit %s if it has no unit.",
                         magnitude, unit, unit, unit);
    else
        imki_verdict_add(v, IMK_FINDING_WARNING, "gravity",
                         "|accel| is %.4g m/s^2 at rest, not gravity (9.78 to 9.83), and no common "
                         "unit explains this value: was gravity removed, or did the sensor move?",
                         magnitude);
}

/* The times at which the five terms alone do not explain the log, and the other terms that dominate
 * it there. */
static void assess_five_terms(imk_verdict *v, const imk_identify_log *log)
{
    imki_text list = {.bytes = NULL};
    uint64_t channels = 0;
    for (size_t c = 0; c < log->record.count; c++) {
        const imk_identification *r = &log->result[c];
        if (r->five_terms_from <= 1.5 * log->record.dt)
            continue;
        const struct {
            bool is;
            const char *name;
        } causes[] = {{r->filter.bandwidth > 0, "output filter"},
                      {r->resonance_count > 0, "resonances"},
                      {r->sinusoid_count > 0, "lines"},
                      {r->gauss_markov_count > 0, "Gauss-Markov noise"}};
        bool any = false;
        channels |= (uint64_t)1 << c;
        imki_text_add(&list, "%s%s ", list.size > 0 ? "; " : "",
                      imk_even_record_column(&log->record, c)->name);
        if (isfinite(r->five_terms_from))
            imki_text_add(&list, "from %.3g s (", r->five_terms_from);
        else
            imki_text_put(&list, "nowhere (");
        for (size_t k = 0; k < sizeof causes / sizeof causes[0]; k++)
            if (causes[k].is) {
                imki_text_add(&list, "%s%s", any ? ", " : "", causes[k].name);
                any = true;
            }
        imki_text_put(&list, any ? ")" : "cause not known)");
    }
    imki_verdict_list(v, IMK_FINDING_NOTE, "five_terms",
                      "white noise, bias instability, random walk, ramp and quantization alone "
                      "explain the log only from some averaging time on. At shorter times other "
                      "terms of the model dominate the log: ",
                      &list, ".");
    if (channels)
        imki_verdict_about(v, &log->record, channels);
}

static bool has_times(const imk_even_record *record)
{
    for (size_t c = 0; c < record->log.column_count; c++)
        if (record->log.column[c].quantity == IMK_QUANTITY_TIME)
            return true;
    return false;
}

static void assess_length(imk_verdict *v, const imk_identify_log *log)
{
    const imk_even_record *record = &log->record;
    const imki_words length = imki_duration(record->dt * (double)record->rows);
    const char *rate = has_times(record) ? "" : " as stated, which no log can test";
    double from = 0, to = (double)INFINITY;
    for (size_t c = 0; c < record->count; c++)
        if (isfinite(log->result[c].valid_from)) {
            from = fmax(from, log->result[c].valid_from);
            to = fmin(to, log->result[c].valid_to);
        }
    if (from > to)
        imki_verdict_add(v, IMK_FINDING_NOTE, "length",
                         "%s at %.6g Hz%s: at no averaging time are the models of all channels "
                         "valid.",
                         length.text, 1 / record->dt, rate);
    else if (from > 0)
        imki_verdict_add(
            v, imk_verdict_warns(v) ? IMK_FINDING_NOTE : IMK_FINDING_GOOD, "length",
            "%s at %.6g Hz%s: the model is valid for averaging times from %.3g s to %.3g s.",
            length.text, 1 / record->dt, rate, from, to);
    else
        imki_verdict_add(v, IMK_FINDING_NOTE, "length", "%s at %.6g Hz%s.", length.text,
                         1 / record->dt, rate);
}

/* Findings of the job itself. For a curve, only the quality of the fit is known. */
static void add_findings(imk_verdict *v, const imk_identify_log *log)
{
    char text[900];
    for (size_t k = 0; k < log->findings.count; k++) {
        const imk_finding *f = &log->findings.item[k];
        const bool misfit = strncmp(f->code, "curve_misfit", 12) == 0;
        const size_t before = v->count;
        imk_finding_text(f, text, sizeof text);
        if (misfit)
            imki_verdict_add(v, IMK_FINDING_WARNING, "misfit", "%s", text);
        else if (strcmp(f->code, "missing") != 0)
            imki_verdict_add(v, f->level,
                             f->level == IMK_FINDING_GOOD ? "curve" : imk_finding_code(f), "%s",
                             text);
        if (v->count > before)
            imki_verdict_clause(v, f->code);
        if (f->level == IMK_FINDING_WARNING && v->count > before)
            v->message[before].told = true;
    }
}

imk_verdict imk_identify_verdict(const imk_identify_log *log, const char *label, imk_result *result)
{
    imk_verdict v = {.result = result, .label = label};
    add_findings(&v, log);
    if (log->origin == IMK_IDENTIFY_CURVE)
        return v;
    assess_gravity(&v, log);
    imki_assess_axes(&v, log);
    imki_assess_samples(&v, log);
    imki_assess_values(&v, log);
    imki_assess_terms(&v, log);
    imki_assess_vibration(&v, log);
    imki_verdict_noise_changes(&v, log);
    assess_five_terms(&v, log);
    assess_length(&v, log);
    if (log->record.bridged > 0)
        imki_verdict_add(&v, IMK_FINDING_NOTE, "bridged",
                         "%zu of %zu samples were bridged by straight lines.", log->record.bridged,
                         log->record.rows);
    if (!label) /* of several logs, once for all: several_verdict.c */
        imki_assess_untestable(&v, &log->record);
    if (!imk_verdict_warns(&v))
        imki_verdict_add(&v, IMK_FINDING_GOOD, "good", "No test found a fault in this record.");
    return v;
}
