/* SPDX-License-Identifier: Apache-2.0 */
/* The messages of findings: one table, by code.
 *
 * In braces stands the place of a number of the finding and how it is written: {0} a count, {1g} as
 * %g, {2.1f} as %.1f, {0s} an s unless the count is one, {0a} the name of an Allan statistic, {0t}
 * the text of a status. {name} is the name. */
#include "imukit/allan.h"
#include "imukit/job.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#define HOW_TO_GO_ON "use --gaps longest (the longest clean stretch) or --gaps bridge (interpolate)"
#define CURVE_FIT "{name}: chi-square {0.1f} for {1} degrees of freedom ({2.2g} by chance)"
#define LEFT_OUT "tau below {3.3g} s are left out: the terms do not explain them."
#define CURVE_MISFIT                                                                               \
    "The terms do not explain the curve, or it is not what was said: do its clusters overlap "     \
    "(--plain)? Was it read from a page (--tolerance)? Do not trust the intervals."
#define PLAN_LENGTH                                                                                \
    "--plan: a record of {0g} s at {1g} Hz has not the 256 to 1e12 samples that are due; "

static const struct message {
    const char *code, *text;
} messages[] = {
    /* records: even_record.c */
    {"no_rows", "there is a header but no data row"},
    {"no_channel", "there is no column to analyse; name one with --columns, such as gyro_x or "
                   "accel_z"},
    {"one_row", "there is one row only; a static record of minutes to hours is due"},
    {"no_interval", "the time column does not increase, so the sample rate is not known; name it, "
                    "such as --rate 100Hz"},
    /* record_grid.c */
    {"no_grid", "the times are no even grid: steps scatter by {0.0f} % of their median, {1g} s; "
                "give the rate the samples were taken at, such as --rate 100Hz, if only the time "
                "stamps scatter and the column is left out with --columns, or resample the log"},
    {"jitter", "the times scatter by {0.1f} % of the interval: samples are taken as evenly spaced"},
    {"clock_leaps", "the times leap by far more than there are rows: is there a jump of the clock? "
                    "use --gaps longest (the longest clean stretch)"},
    {"not_finite", "{0} row{0s} with a value that is not a finite number or beyond 1e60, first in "
                   "row {1}: counted as missing"},
    {"unordered", "{0} row{0s} whose time stands still or runs backwards: left out"},
    {"missing", "{0} of {1} samples are missing, in {2} hole{2s}, the longest of {3g} s: their "
                "places are kept empty"},
    /* record_spacing.c */
    {"mostly_missing", "more is missing than is there ({0} good rows, {1} samples missing): "
                       "nothing to interpolate; use --gaps longest"},
    {"refused_not_finite", "{0} row{0s} with a value that is not a finite number or beyond 1e60, "
                           "first in row {1}, column {name}; " HOW_TO_GO_ON},
    {"refused_backwards",
     "time runs backwards in {0} row{0s}, first in row {1} (by {2g} s); " HOW_TO_GO_ON},
    {"refused_standing", "time stands still in {0} row{0s}, first in row {1}; " HOW_TO_GO_ON},
    {"refused_missing",
     "{0} samples are missing in {1} gap{1s}, first before row {2}; " HOW_TO_GO_ON},
    {"longest_stretch", "{0} bad, {1} missing: using the longest clean stretch, rows {2} to {3} of "
                        "{4}"},
    {"no_good_rows", "no two rows in a row are good"},
    /* allan_log.c */
    {"no_value", "column {name} has no finite value in {0} rows; leave it out with --columns, or "
                 "check the log"},
    {"constant", "column {name} is constant in all {0} rows: there is no noise to analyse; leave "
                 "it out with --columns, or check the log"},
    {"too_few_for_allan", "{0} rows are too few for an Allan deviation"},
    {"statistic_needs_all", "column {name} has missing samples: only oadev of rates is defined "
                            "with them; leave out --statistic and --type, or use --gaps bridge or "
                            "--gaps longest"},
    {"statistic_failed", "column {name}: {0a}: {1t}"},
    {"averaging_time", "{0g} s is outside what this record allows, {1g} s to {2g} s"},
    /* identify_log.c, identify_by_allan.c */
    {"constant_identify", "column {name} is constant in all {0} rows: there is no noise to "
                          "identify; leave it out with --columns, or check the log"},
    {"too_few_values", "column {name} has {0} finite values in {1} rows: at least 256 are needed "
                       "to identify noise; leave it out with --columns, or check the log"},
    {"too_few_to_identify", "{1} rows are too few to identify noise: at least 256 are needed, and "
                            "minutes to hours are useful"},
    {"column_failed", "column {name}: {0t}"},
    {"allan_needs_all", "column {name} has {0} samples missing, or taken out: --method allan needs "
                        "all of them; the likelihood, which is the default, does not (or use "
                        "--gaps bridge)"},
    {"allan_fit", "{name}: Allan deviations fitted from {0.3g} s to {1.3g} s, chi-square {2.1f} "
                  "for {3} degrees of freedom ({4.2g} by chance)."},
    /* identify_curve.c */
    {"long_table", "looks like the long table of imukit allan; a curve has a column for each "
                   "channel, such as tau [s],gyro_x [deg/s]. From the log itself, --method allan "
                   "does the same, and needs no table"},
    {"no_curve", "a table of Allan deviations has a column tau [s] and columns such as gyro_x "
                 "[deg/s]"},
    {"too_few_tau", "{0} tau are multiples of 1/{1g} s and at most half of {2g} s; a fit needs 4"},
    {"curve", CURVE_FIT "."},
    {"curve_from", CURVE_FIT "; " LEFT_OUT},
    {"curve_misfit", CURVE_FIT ". " CURVE_MISFIT},
    {"curve_misfit_from", CURVE_FIT "; " LEFT_OUT " " CURVE_MISFIT},
    /* record_plan.c, plan_requirement.c */
    {"plan_length", PLAN_LENGTH "change --duration or --rate"},
    {"plan_no_length", PLAN_LENGTH "add another --duration"},
    {"no_noise", "states no noise, from which to tell how long to record: a catalogue entry near "
                 "it does (imukit devices), or imukit identify finds it in a first log at rest"},
    {"requirement", "--want \"{name}\": expected a term and its 1 sigma in per cent of it, such as "
                    "\"bias_instability 5%\", or \"rate_random_walk detected 95%\""},
    {"requirement_chance",
     "--want \"{name}\": behind \"detected\" a chance below 100% is due, such "
     "as 95%"},
    {"requirements", "--want: these are more than {0} wishes"},
    {"no_such_noise", "--want \"{name}\": there is no such noise"},
    /* spectrum_log.c */
    {"too_few_for_spectrum", "{0} rows are too few for a spectrum; 64 are needed, and some "
                             "thousands useful"},
    {"segments_missing", "column {name}: every segment has missing samples; ask for a coarser "
                         "--resolution, or use --gaps longest"},
    {"resolution", "--resolution {0g} Hz: {name}; this record of {1g} s at {2g} Hz allows about "
                   "{3.2g} Hz to {4.2g} Hz"},
    {"from_beyond", "{1.6g} Hz"},
    {"gaps", "{name}: {0} of {1} segments have missing samples and were left out"},
    {"lines", "{name}: more than {0} lines; the strongest are listed"},
    {"fit", "{name}: the noise parameters could not be fitted: {0t}"},
    {"misfit", "{name}: the four noise terms do not explain the spectrum (misfit {0.1f}, worst at "
               "{1.3g} Hz: {2.2f} of the fit); an output filter, a resonance or a correlated noise "
               "is there: see imukit identify, or fit a part with --from and --to"},
    /* calibrate: bench_record.c */
    {"rows_dropped", "{0} rows whose time does not increase, or is no number, are left out"},
    {"readings_missing",
     "in {0} of {1} rows a reading or the temperature is no finite number, or beyond 1e60, first "
     "in row {2}: such rows are left out, or the hold or step that they interrupt"},
    {"axis_gap", "has {name}: calibration needs the axes one after the other; name the columns "
                 "with --columns"},
    {"counts_mixed", "some {name} columns are in counts and some are not"},
    {"no_sensor", "has no gyro and no accelerometer column; name them with --columns, such as "
                  "time,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z"},
    {"no_section", "has no column \"{name}\" of texts to divide it into sections"},
    {"sections", "has {0} columns of texts: say which one divides it into sections, such as "
                 "--section {name}"},
    /* calibrate_closed_form.c, power_cycles.c, calibrate_model.c */
    {"stretches", "these are more than {0} holds and turns"},
    {"many_runs", "these are more than {0} runs"},
    {"few_runs", "{0} run: at least two are needed, better ten; give a log for each power cycle, "
                 "or one log with a column of texts that names the runs (--section NAME)"},
    {"one_model", "1 run: at least two are needed, better ten; give the model of each power cycle"},
    {"no_uncertainty", "no bias and no scale factor is stated with its uncertainty by all of these "
                       "models"},
    {"attitude", "the forces of the runs differ by up to {0.3g} mrad: was the unit moved? What a "
                 "change of attitude does to accelerometers looks like a change of bias; keep it "
                 "fixed, or state how well it is put back with --placement 0.1deg"},
    {"temperature_left_out", "{name}: what else temperature does is left out: {0t}"},
    {"bridged", "{0} of {1} samples are missing or bad: bridged by straight lines"},
};

typedef struct writing {
    char *text;
    size_t size, length;
} writing;

static void put(writing *w, const char *text, size_t length)
{
    for (size_t i = 0; i < length; i++, w->length++)
        if (w->length + 1 < w->size)
            w->text[w->length] = text[i];
}

/* A number as what stands behind its place says. */
static void put_number(writing *w, double number, const char *how, size_t length)
{
    char format[16], text[64];
    if (length == 1 && *how == 's') {
        put(w, "s", number == 1 ? 0 : 1);
        return;
    }
    if (length == 1 && (*how == 'a' || *how == 't')) {
        const char *word = *how == 'a' ? imk_allan_name((imk_allan_statistic)number)
                                       : imk_status_text((imk_status)number);
        put(w, word, strlen(word));
        return;
    }
    snprintf(format, sizeof format, "%%%.*s", (int)(length > 0 ? length : 3),
             length > 0 ? how : ".0f");
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
    const int written = snprintf(text, sizeof text, format, number);
#pragma GCC diagnostic pop
    put(w, text, written > 0 ? strlen(text) : 0);
}

static void put_message(writing *w, const char *message, const imk_finding *finding)
{
    for (const char *c = message; *c;) {
        const size_t plain = strcspn(c, "{");
        put(w, c, plain);
        c += plain;
        if (!*c)
            return;
        const size_t length = strcspn(c, "}");
        if (strncmp(c, "{name}", 6) == 0)
            put(w, finding->name, strlen(finding->name));
        else
            put_number(w, finding->number[c[1] - '0'], c + 2, length - 2);
        c += length + 1;
    }
}

size_t imk_finding_text(const imk_finding *finding, char *text, size_t size)
{
    writing w = {text, size, 0};
    size_t k = 0;
    while (k < sizeof messages / sizeof messages[0] && strcmp(messages[k].code, finding->code) != 0)
        k++;
    if (k < sizeof messages / sizeof messages[0])
        put_message(&w, messages[k].text, finding);
    else
        put(&w, finding->code, strlen(finding->code));
    if (size > 0)
        text[w.length < size ? w.length : size - 1] = '\0';
    return w.length;
}
