/* SPDX-License-Identifier: Apache-2.0 */
/* The verdict: what the doubts, the findings over temperature and the warnings add up to. */
#include "calibrate_parts.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

static const char *const sensor_names[2] = {"gyro", "accelerometer"};

calibrate_sentence sentence_make(calibrate_level level, const char *code, const char *format, ...)
{
    calibrate_sentence sentence = {.level = level};
    snprintf(sentence.code, sizeof sentence.code, "%s", code);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(sentence.text, sizeof sentence.text, format, arguments);
    va_end(arguments);
    return sentence;
}

static void add(bench *b, const calibrate_sentence *sentence)
{
    if (b->sentence_count < CALIBRATE_SENTENCES_MAX)
        b->sentence[b->sentence_count++] = *sentence;
}

static void add_thermal(bench *b, const bench_log *log)
{
    const imk_thermal_findings *f = log->thermal;
    for (int sensor = 0; f && sensor < 2; sensor++)
        for (int i = 0; i < f->axis_count[sensor]; i++) {
            const imk_thermal_axis *a = &f->axis[sensor][i];
            if (a->single_valued || !(a->gap_largest > 0))
                continue;
            const imk_unit unit = imk_unit_readable(
                imk_unit_of(sensor == 0 ? "rad/s" : "m/s^2").dimension, a->gap_largest);
            const calibrate_sentence sentence = sentence_make(
                LEVEL_WARNING, "hysteresis",
                "%s: %s %c reads differently while warming and while cooling, by up to %.3g "
                "%s: no polynomial of the temperature can follow it; what compensation leaves "
                "is %.3g %s rms",
                log->path, sensor_names[sensor], axis_letter(i), a->gap_largest / unit.scale,
                unit.text, a->rms_compensated / unit.scale, unit.text);
            add(b, &sentence);
        }
    if (f && !f->both_directions) {
        const calibrate_sentence sentence = sentence_make(
            LEVEL_NOTE, "one_direction",
            "%s: the temperature went one way only, so hysteresis may be there unseen: sweep "
            "up and down",
            log->path);
        add(b, &sentence);
    }
    if (f && f->accel_shared) {
        const calibrate_sentence sentence = sentence_make(
            LEVEL_NOTE, "one_pose",
            "%s: in one pose the bias of accelerometers over temperature cannot be told from "
            "that of their scale factor: the coefficients hold for this pose; sweep in "
            "several to tell them apart",
            log->path);
        add(b, &sentence);
    }
}

/* "gyro.nonlinearity.k2" of gyro.nonlinearity.k2.x. */
static void term_of(imk_model_parameter parameter, char term[IMK_MODEL_PARAMETER_NAME])
{
    parameter.axis = parameter.element = 0;
    term[0] = '\0';
    if (imk_model_parameter_name(parameter, term) != IMK_OK)
        return;
    char *axis = strstr(term, ".x");
    if (axis)
        *axis = '\0';
}

/* Terms a procedure would have estimated and the log does not determine, on some axes at least. */
static void add_undetermined(bench *b, const bench_log *log)
{
    const imk_procedure_findings *f = &log->findings;
    char names[300] = "", term[IMK_MODEL_PARAMETER_NAME];
    size_t used = 0;
    for (size_t k = 0; k < f->undetermined_count && k < IMK_UNDETERMINED_MAX; k++) {
        term_of(f->undetermined[k], term);
        if (bench_find(b, f->undetermined[k]) >= 0 || strstr(names, term) ||
            used + sizeof term > sizeof names)
            continue;
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", used ? ", " : "", term);
    }
    if (used == 0)
        return;
    const calibrate_sentence sentence = sentence_make(
        LEVEL_NOTE, "undetermined",
        "%s does not determine %s (on all axes): left as before. Inputs along other axes, or "
        "more levels, would",
        log->path, names);
    add(b, &sentence);
}

/* What a log showed already need not be said of the solution again, nor of each axis. */
static bool is_said(const bench *b, const char *code)
{
    for (size_t k = 0; k < b->sentence_count; k++)
        if (strcmp(b->sentence[k].code, code) == 0)
            return true;
    return false;
}

void bench_judge(bench *b)
{
    /* What was warned of on the way here belongs to the verdict too. */
    for (size_t k = 0; k < command_warning_count(); k++) {
        const command_warning *warning = command_warning_get(k);
        const calibrate_sentence sentence =
            sentence_make(LEVEL_WARNING, warning->code, "%s", warning->message);
        add(b, &sentence);
    }
    const size_t said = b->sentence_count;
    for (size_t k = 0; k < b->log_count; k++) {
        const bench_log *log = &b->log[k];
        for (size_t d = 0; d < log->doubt_count; d++) {
            if (!doubt_matters(log, &log->doubt[d]))
                continue;
            calibrate_sentence plain = doubt_sentence(b, log, &log->doubt[d]), named = plain;
            snprintf(named.text, sizeof named.text, "%.150s: %.540s", log->path, plain.text);
            add(b, &named);
        }
        add_undetermined(b, log);
        add_thermal(b, log);
    }
    for (size_t d = 0; d < b->doubt_count; d++) {
        const calibrate_sentence sentence = doubt_sentence(b, NULL, &b->doubt[d]);
        if (!is_said(b, sentence.code))
            add(b, &sentence);
    }
    for (size_t k = said; k < b->sentence_count; k++)
        if (b->sentence[k].level >= LEVEL_WARNING)
            command_warn(b->sentence[k].code, "%s", b->sentence[k].text);
}

calibrate_level bench_level(const bench *b)
{
    calibrate_level level = LEVEL_GOOD;
    for (size_t k = 0; k < b->sentence_count; k++)
        level = b->sentence[k].level > level ? b->sentence[k].level : level;
    return level;
}

/* Worst 1 sigma of a term of a sensor; 0 when it was not estimated. */
static double worst(const bench *b, int sensor, int term)
{
    double most = 0;
    for (size_t p = 0; b->result && p < b->result->parameter_count; p++)
        if (b->result->parameter[p].sensor == sensor && b->result->parameter[p].term == term)
            most = fmax(most, b->result->sigma[p]);
    return most;
}

/* "accelerometer bias to 0.05 mg, scale factor to 65 ppm, misalignment to 0.02 mrad" */
static void describe_precision(const bench *b, char *text, size_t size)
{
    static const int terms[3] = {IMK_MODEL_BIAS, IMK_MODEL_SCALE_FACTOR, IMK_MODEL_MISALIGNMENT};
    static const char *const names[3] = {"bias", "scale factor", "misalignment"};
    size_t used = 0;
    text[0] = '\0';
    for (int sensor = 1; sensor >= 0; sensor--) {
        bool first = true;
        for (int t = 0; t < 3 && used < size; t++) {
            const double sigma = worst(b, sensor, terms[t]);
            if (!(sigma > 0))
                continue;
            const imk_model_parameter p = {(uint8_t)sensor, (uint8_t)terms[t], 0, 1};
            const imk_unit unit = parameter_unit(p, sigma);
            char number[40];
            format_value(sigma / unit.scale, sigma / unit.scale, 2, number, sizeof number);
            used += (size_t)snprintf(text + used, size - used, "%s%s%s to %s %s",
                                     used && first ? "; "
                                     : first       ? ""
                                                   : ", ",
                                     first ? (sensor == 0 ? "gyro " : "accelerometer ") : "",
                                     names[t], number, unit.text);
            first = false;
        }
    }
}

void bench_verdict(const bench *b, char *text, size_t size)
{
    char precision[300];
    describe_precision(b, precision, sizeof precision);
    const char *behind = precision[0] ? ", 1 sigma of the worst axis" : "";
    const calibrate_level level = bench_level(b);
    size_t warnings = 0, bad = 0;
    for (size_t k = b->sentence_count; k-- > 0;) {
        warnings += b->sentence[k].level == LEVEL_WARNING;
        bad = b->sentence[k].level == LEVEL_USELESS ? k : bad;
    }
    if (level == LEVEL_USELESS)
        snprintf(text, size, "Not usable: %s.", b->sentence[bad].text);
    else if (level == LEVEL_WARNING)
        snprintf(text, size, "Usable with care (%zu warning%s): %s%s.", warnings,
                 warnings == 1 ? "" : "s", precision[0] ? precision : "see below", behind);
    else
        snprintf(text, size, "Good: %s%s.",
                 precision[0] ? precision : "nothing speaks against these logs", behind);
}
