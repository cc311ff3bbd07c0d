/* SPDX-License-Identifier: Apache-2.0 */
/* imukit allan: Allan deviations of a log with confidence intervals. */
#include "allan_output.h"

#include "imukit/decimal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const option allan_option_table[] = {
    {"statistic", 0, OPTION_TEXT, "NAME,NAME…|all", NULL, NULL,
     "oadev (the default), adev, mdev, tdev, ohdev, hdev, totdev, mtot, htot, theo1, pdev, haar; "
     "theo1 takes seconds a million samples",
     offsetof(allan_options, statistic)},
    {"tau", 0, OPTION_TEXT, "octave|decade|many|all|LIST", NULL, NULL,
     "averaging times: doubling (the default), ten per decade, many (all up to 64 samples, then 32 "
     "to the octave), every one, or a list such as 1,10,100 in seconds",
     offsetof(allan_options, tau)},
    {"confidence", 0, OPTION_FRACTION, "FRACTION", NULL, CONFIDENCE_RANGE,
     "of the two-sided intervals; default 0.95", offsetof(allan_options, confidence)},
    {"edf", 0, OPTION_CHOICE, "CHOICE", NULL, "exact|greenhall-riley",
     "degrees of freedom behind the intervals: of the sampled process (the default), or by the "
     "published formulas for the continuous one",
     offsetof(allan_options, edf)},
    {"bias", 0, OPTION_CHOICE, "CHOICE", NULL, "removed|published|left",
     "the bias of totdev, mtot, htot and theo1 against adev, mdev and hdev: taken off for the "
     "noise "
     "found (the default), the same with the factors in print, or left in",
     offsetof(allan_options, bias)},
    {"type", 0, OPTION_CHOICE, "CHOICE", NULL, "rate|phase",
     "what the columns hold: rates (the default), or their integral (phase, angle)",
     offsetof(allan_options, type)},
    {"output", 'o', OPTION_OUTPUT, "FILE.csv", NULL, NULL,
     "write the long table (one line per channel and averaging time, SI) here; - is standard "
     "output",
     offsetof(allan_options, output)},
    {"plot", 0, OPTION_OUTPUT, "FILE.svg|.png|.pdf|term", NULL, NULL,
     "draw the deviations with their intervals", offsetof(allan_options, plot)},
    {"report", 0, OPTION_OUTPUT, "FILE.html", NULL, NULL,
     "write one self-contained page: plot and tables", offsetof(allan_options, report)},
    {"json", 0, OPTION_FLAG, NULL, NULL, NULL, "print the result as JSON instead of a table",
     offsetof(allan_options, json)},
    {"threads", 0, OPTION_INTEGER, "N", NULL, "1-65536", "threads to use; default: all processors",
     offsetof(allan_options, threads)},
};

static int run(int count, char **words);

const verb allan_verb = {
    .name = "allan",
    .summary = "Allan family deviations of a log with confidence intervals",
    .operands = "LOG",
    .operands_minimum = 1,
    .operands_maximum = 1,
    .examples = {{"imukit allan static.csv --plot allan.svg",
                  "every gyro and accelerometer column of a log at rest, as a table and a plot"},
                 {"imukit allan phase.txt --columns x --rate 1Hz --type phase -o adev.csv",
                  "one column of phase data without header, sampled once a second"}},
    .description =
        "LOG is CSV with a header such as time [s],gyro_x [deg/s],accel_x [g] (also .gz, .zst), or "
        ".npy; - is standard input. Without gyro and accelerometer columns every other column is "
        "analysed.\n\nWhich statistic: oadev to look at a sensor; mdev or pdev to tell "
        "quantization from "
        "other fast noise; ohdev when the rate drifts in a straight line; totdev, htot and theo1 "
        "for tau near the length of the log; tdev (in units of the column times s) for the scatter "
        "of the integral; haar as published for wavelet methods. \n\nRows that are missing or not "
        "finite keep their places empty: oadev of rates is then taken of what is there, and the "
        "share of the record's pairs behind each point is shown. The other statistics, and phase, "
        "need a complete record: --gaps bridge or --gaps longest.",
    .groups = {{"Options", sizeof allan_option_table / sizeof allan_option_table[0],
                allan_option_table, 0},
               {"Reading the log", LOG_INPUT_OPTIONS, log_input_options,
                offsetof(allan_options, log)}},
    .run = run};

/* Names of --statistic. @return -1 or the exit code */
static int parse_statistics(const char *text, allan_result *r)
{
    const char *names[IMK_ALLAN_STATISTICS];
    for (size_t k = 0; k < IMK_ALLAN_STATISTICS; k++)
        names[k] = imk_allan_name((imk_allan_statistic)k);
    if (!text)
        text = names[IMK_ALLAN_OVERLAPPING];
    r->statistic_count = 0;
    if (strcmp(text, "all") == 0)
        for (; r->statistic_count < IMK_ALLAN_STATISTICS; r->statistic_count++)
            r->statistic[r->statistic_count] = (imk_allan_statistic)r->statistic_count;
    else
        for (const char *item = text;; item++) {
            const size_t length = strcspn(item, ",");
            char name[16];
            snprintf(name, sizeof name, "%.*s", (int)(length < 15 ? length : 15), item);
            size_t k = 0;
            while (k < IMK_ALLAN_STATISTICS && strcmp(name, names[k]) != 0)
                k++;
            const char *nearest = command_nearest(name, IMK_ALLAN_STATISTICS, names);
            if (k == IMK_ALLAN_STATISTICS && nearest)
                return command_misused("--statistic %s: there is no \"%.*s\"; did you mean %s?",
                                       text, (int)length, item, nearest);
            if (k == IMK_ALLAN_STATISTICS)
                return command_misused("--statistic %s: there is no \"%.*s\"; expected all, or "
                                       "some of oadev, adev, mdev, tdev, ohdev, hdev, totdev, "
                                       "mtot, htot, theo1, pdev, haar",
                                       text, (int)length, item);
            for (size_t i = 0; i < r->statistic_count; i++)
                if (r->statistic[i] == (imk_allan_statistic)k)
                    return command_misused("--statistic %s: %s is named twice", text, names[k]);
            r->statistic[r->statistic_count++] = (imk_allan_statistic)k;
            item += length;
            if (!*item)
                break;
        }
    return -1;
}

/* The times of a --tau list [s]; NULL after a message, with the exit code. */
static double *parse_times(const char *text, size_t *count, int *code)
{
    double *times = malloc((strlen(text) + 1) * sizeof *times);
    *count = 0;
    *code = times ? -1 : command_failed("memory is exhausted");
    for (const char *item = text; times && *code < 0;) {
        size_t length = strcspn(item, ",");
        double tau, sigma;
        size_t numbers;
        imk_error error;
        /* The list is one of seconds, so a bare number is no guess here. */
        imk_status status = IMK_OK;
        if (length == 0 || imk_decimal_parse(item, item + length, &tau) != item + length)
            status = imk_quantity_parse(item, item + length, imk_unit_of("s").dimension, 1, &tau,
                                        &sigma, &numbers, NULL, &error);
        if (status != IMK_OK || !isfinite(tau))
            *code = command_misused("--tau %s: \"%.*s\" is no averaging time; expected octave, "
                                    "decade, many, all or a list such as 1,10,100 in seconds",
                                    text, (int)length, item);
        else if (*count > 0 && !(tau > times[*count - 1]))
            *code = command_misused("--tau %s: the times must ascend", text);
        else
            times[(*count)++] = tau;
        if (!item[length])
            break;
        item += length + 1;
    }
    if (*code >= 0) {
        free(times);
        times = NULL;
    }
    return times;
}

/* Factors of a statistic at listed times: those in its range. With one statistic a time outside is
 * an error; with several it is left out of those that do not reach it. */
static size_t *factors_of_times(const allan_result *r, imk_allan_statistic statistic, size_t n,
                                size_t time_count, const double *times, size_t *count, int *code)
{
    const double dt = r->channels.dt;
    size_t lowest, highest, step;
    imk_allan_range(statistic, n, &lowest, &highest, &step);
    const double unit = dt * (double)step * imk_allan_averaging(statistic, 1);
    size_t *factors = malloc((time_count + 1) * sizeof *factors);
    *count = 0;
    *code = factors ? -1 : command_failed("memory is exhausted");
    for (size_t i = 0; i < time_count && *code < 0; i++) {
        const double place = floor(times[i] / unit + 0.5);
        const bool inside =
            place >= 1 && place <= (double)(highest / step) && (size_t)place * step >= lowest;
        if (!inside && r->statistic_count == 1)
            *code = command_misused("--tau %s: %g s is outside what this record allows, %g s to "
                                    "%g s",
                                    r->options->tau, times[i],
                                    dt * imk_allan_averaging(statistic, lowest),
                                    dt * imk_allan_averaging(statistic, highest));
        else if (inside && (*count == 0 || (size_t)place * step > factors[*count - 1]))
            factors[(*count)++] = (size_t)place * step;
    }
    if (*code >= 0) {
        free(factors);
        factors = NULL;
    }
    return factors;
}

/* Averaging factors of --tau for one statistic; NULL after a message, with the exit code. */
static size_t *parse_tau(const allan_result *r, imk_allan_statistic statistic, size_t n,
                         size_t *count, int *code)
{
    static const char *const grids[] = {"octave", "decade", "all", "many"};
    const char *text = r->options->tau;
    for (int i = 0; i < 4; i++)
        if (!text || strcmp(text, grids[i]) == 0) {
            size_t *factors = allan_factors_of(statistic, (imk_allan_grid)i, n, count);
            *code = factors ? -1 : command_failed("memory is exhausted");
            return factors;
        }
    size_t time_count;
    double *times = parse_times(text, &time_count, code);
    if (!times)
        return NULL;
    size_t *factors = factors_of_times(r, statistic, n, time_count, times, count, code);
    free(times);
    return factors;
}

/* A column that never changes has no noise to analyse: almost always a wrong column. */
static int check_constant(const char *path, const log_channels *channels)
{
    for (size_t c = 0; c < channels->count; c++) {
        const double *data = log_channel_data(channels, c);
        size_t first = 0, i;
        while (first < channels->rows && !isfinite(data[first]))
            first++;
        if (first == channels->rows)
            return command_failed("%s: column %s has no finite value in %zu rows; leave it out "
                                  "with --columns, or check the log",
                                  path, log_channel_column(channels, c)->name, first);
        i = first;
        while (i < channels->rows && (data[i] == data[first] || !isfinite(data[i])))
            i++;
        if (i == channels->rows)
            return command_failed("%s: column %s is constant in all %zu rows: there is no noise to "
                                  "analyse; leave it out with --columns, or check the log",
                                  path, log_channel_column(channels, c)->name, channels->rows);
    }
    return -1;
}

/* The record as running sums, in place of the data. n is the number of rates. */
static double *running_sums(const allan_options *o, const log_channels *channels, size_t channel,
                            size_t n, const imk_executor *executor)
{
    double *data = log_channel_data(channels, channel);
    if (o->type == 0)
        imk_allan_sums(n, data, data, executor);
    else
        for (size_t i = 0; i <= n; i++)
            data[i] /= channels->dt;
    return data;
}

static bool has_missing(const log_channels *channels, size_t channel)
{
    return log_channel_finite(channels, channel) < channels->rows;
}

static int compute_curve(allan_result *r, size_t channel, size_t k, size_t n, const double *data,
                         bool missing, const imk_executor *executor)
{
    const allan_options *o = r->options;
    const char *name = log_channel_column(&r->channels, channel)->name;
    imk_allan_settings settings = imk_allan_default();
    settings.statistic = r->statistic[k];
    settings.confidence = o->confidence;
    settings.greenhall_riley = o->edf == 1;
    settings.bias = (imk_allan_bias_removal)o->bias;
    size_t count = 0;
    int code;
    size_t *factors = parse_tau(r, settings.statistic, n, &count, &code);
    imk_status status = IMK_OK;
    if (factors && count == 0 && r->statistic_count == 1)
        status = IMK_ERROR_TOO_SHORT;
    else if (factors && count > 0 && missing)
        status = allan_curve_with_gaps(&settings, n, data, r->channels.dt, count, factors, executor,
                                       &r->curve[channel][k]);
    else if (factors && count > 0)
        status = allan_curve_compute(&settings, n, data, r->channels.dt, count, factors, name,
                                     executor, &r->curve[channel][k]);
    free(factors);
    if (status != IMK_OK)
        code = command_failed("%s: column %s: %s: %s", r->path, name,
                              imk_allan_name(settings.statistic), imk_status_text(status));
    return code;
}

static int compute(allan_result *r, const imk_executor *executor)
{
    const allan_options *o = r->options;
    const log_channels *channels = &r->channels;
    size_t n = o->type == 0 ? channels->rows : channels->rows - 1;
    int code = check_constant(r->path, channels);
    if (code < 0 && n < 3)
        code = command_failed("%s: %zu rows are too few for an Allan deviation", r->path,
                              channels->rows);
    for (size_t c = 0; code < 0 && c < channels->count; c++) {
        const bool missing = has_missing(channels, c);
        const char *name = log_channel_column(channels, c)->name;
        if (missing &&
            (o->type == 1 || r->statistic_count > 1 || r->statistic[0] != IMK_ALLAN_OVERLAPPING))
            return command_failed("%s: column %s has missing samples: only oadev of rates is "
                                  "defined with them; leave out --statistic and --type, or use "
                                  "--gaps bridge or --gaps longest",
                                  r->path, name);
        const double *data =
            missing ? log_channel_data(channels, c) : running_sums(o, channels, c, n, executor);
        for (size_t k = 0; code < 0 && k < r->statistic_count; k++)
            code = compute_curve(r, c, k, n, data, missing, executor);
    }
    return code;
}

static int show(const allan_result *r)
{
    const allan_options *o = r->options;
    int code = -1;
    if (o->output)
        code = allan_write_csv(r, o->output);
    if (code < 0 && o->report)
        code = allan_write_report(r, o->report);
    if (code < 0 && o->json)
        code = allan_print_json(r);
    if (code < 0 && !o->json && !o->output && !options_stdout_taken())
        allan_print_tables(r);
    if (code < 0 && o->plot)
        code = allan_draw(r, o->plot);
    return code < 0 ? EXIT_DONE : code;
}

static int run(int count, char **words)
{
    allan_options o = {.confidence = 0.95, .log = {.gaps = GAPS_KEEP, .missing_allowed = true}};
    const char *operands[OPERANDS_MAX];
    int code = options_parse(&allan_verb, count, words, &o, operands);
    if (code < 0)
        code = command_check_plot(o.plot);
    if (code >= 0)
        return code;
    allan_result *r = calloc(1, sizeof *r);
    if (!r)
        return command_failed("memory is exhausted");
    r->options = &o;
    r->path = operands[0];
    code = parse_statistics(o.statistic, r);
    if (code < 0)
        code = log_input_load(&o.log, r->path, &r->channels);
    if (code < 0) {
        imk_thread_pool *pool = imk_thread_pool_create(o.threads.value);
        imk_executor executor = imk_thread_pool_executor(pool);
        code = compute(r, &executor);
        imk_thread_pool_destroy(pool);
        if (code < 0)
            code = show(r);
        for (size_t c = 0; c < r->channels.count; c++)
            for (size_t k = 0; k < r->statistic_count; k++)
                allan_curve_free(&r->curve[c][k]);
        log_channels_free(&r->channels);
    }
    free(r);
    return code;
}
