/* SPDX-License-Identifier: Apache-2.0 */
/* imukit allan: Allan deviations of a log with confidence intervals. */
#include "allan_output.h"

#include "imukit/decimal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const option allan_option_table[] = {
    {"statistic", 0, OPTION_CHOICE, "CHOICE", NULL, "oadev|adev",
     "overlapping (the default) or plain Allan deviation", offsetof(allan_options, statistic)},
    {"tau", 0, OPTION_TEXT, "octave|decade|all|LIST", NULL, NULL,
     "averaging times: doubling (the default), ten per decade, every one, or a list such as "
     "1,10,100 in seconds",
     offsetof(allan_options, tau)},
    {"confidence", 0, OPTION_FRACTION, "FRACTION", NULL, NULL,
     "of the two-sided intervals; default 0.95", offsetof(allan_options, confidence)},
    {"edf", 0, OPTION_CHOICE, "CHOICE", NULL, "exact|greenhall-riley",
     "degrees of freedom behind the intervals: of the sampled process (the default), or by the "
     "formulas of Greenhall and Riley for the continuous one",
     offsetof(allan_options, edf)},
    {"type", 0, OPTION_CHOICE, "CHOICE", NULL, "rate|phase",
     "what the columns hold: rates (the default), or their integral (phase, angle)",
     offsetof(allan_options, type)},
    {"output", 'o', OPTION_OUTPUT, "FILE.csv", NULL, NULL,
     "write the long table (one line per channel and averaging time, SI) here; - is standard "
     "output",
     offsetof(allan_options, output)},
    {"plot", 0, OPTION_OUTPUT, "FILE.svg|FILE.png|term", NULL, NULL,
     "draw the deviations with their intervals", offsetof(allan_options, plot)},
    {"report", 0, OPTION_OUTPUT, "FILE.html", NULL, NULL,
     "write one self-contained page: plot and tables", offsetof(allan_options, report)},
    {"json", 0, OPTION_FLAG, NULL, NULL, NULL, "print the result as JSON instead of a table",
     offsetof(allan_options, json)},
    {"threads", 0, OPTION_INTEGER, "N", NULL, NULL, "threads to use; default: all processors",
     offsetof(allan_options, threads)},
};

static int run(int count, char **words);

const verb allan_verb = {
    .name = "allan",
    .summary = "Allan deviation of a log with confidence intervals",
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
        "analysed.\n\nRows with values that are not finite and rows out of order are refused, with "
        "their number and the first one, unless --gaps says what to do.",
    .groups = {{"Options", sizeof allan_option_table / sizeof allan_option_table[0],
                allan_option_table, 0},
               {"Reading the log", LOG_INPUT_OPTIONS, log_input_options,
                offsetof(allan_options, log)}},
    .run = run};

/* Averaging factors of --tau; NULL after a message, with the exit code. */
static size_t *parse_tau(const char *text, double dt, size_t n, size_t *count, int *code)
{
    static const char *const grids[] = {"octave", "decade", "all"};
    for (int i = 0; i < 3; i++)
        if (!text || strcmp(text, grids[i]) == 0) {
            size_t *factors = allan_factors_of_grid((imk_allan_grid)i, n, count);
            *code = factors ? -1 : command_failed("memory is exhausted");
            return factors;
        }
    size_t *factors = malloc((strlen(text) + 1) * sizeof *factors);
    *count = 0;
    *code = factors ? -1 : command_failed("memory is exhausted");
    for (const char *item = text; factors && *code < 0;) {
        size_t length = strcspn(item, ",");
        double tau, sigma;
        size_t numbers;
        imk_error error;
        /* The list is one of seconds, so a bare number is no guess here. */
        imk_status status = IMK_OK;
        if (length == 0 || imk_decimal_parse(item, item + length, &tau) != item + length)
            status = imk_quantity_parse(item, item + length, imk_unit_of("s").dimension, 1, &tau,
                                        &sigma, &numbers, NULL, &error);
        double m = status == IMK_OK ? floor(tau / dt + 0.5) : 0;
        if (status != IMK_OK)
            *code = command_misused("--tau %s: \"%.*s\" is no averaging time; expected octave, "
                                    "decade, all or a list such as 1,10,100 in seconds",
                                    text, (int)length, item);
        else if (!(m >= 1 && m <= (double)(n / 2)))
            *code = command_misused("--tau %s: \"%.*s\" is outside what this record allows, %g s "
                                    "to %g s",
                                    text, (int)length, item, dt, dt * (double)(n / 2));
        else if (*count > 0 && (size_t)m <= factors[*count - 1])
            *code = command_misused("--tau %s: the times must ascend", text);
        else
            factors[(*count)++] = (size_t)m;
        if (!item[length])
            break;
        item += length + 1;
    }
    if (*code >= 0) {
        free(factors);
        factors = NULL;
    }
    return factors;
}

/* A column that never changes has no noise to analyse: almost always a wrong column. */
static int check_constant(const char *path, const log_channels *channels)
{
    for (size_t c = 0; c < channels->count; c++) {
        const double *data = log_channel_data(channels, c);
        size_t i = 1;
        while (i < channels->rows && data[i] == data[0])
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
                            size_t n)
{
    double *data = log_channel_data(channels, channel);
    if (o->type == 0)
        imk_allan_sums(n, data, data, NULL);
    else
        for (size_t i = 0; i <= n; i++)
            data[i] /= channels->dt;
    return data;
}

static int compute(allan_result *r, const imk_executor *executor)
{
    const allan_options *o = r->options;
    const log_channels *channels = &r->channels;
    size_t n = o->type == 0 ? channels->rows : channels->rows - 1;
    size_t count = 0;
    int code = check_constant(r->path, channels);
    if (code < 0 && n < 3)
        code = command_failed("%s: %zu rows are too few for an Allan deviation", r->path,
                              channels->rows);
    if (code >= 0)
        return code;
    size_t *factors = parse_tau(o->tau, channels->dt, n, &count, &code);
    imk_allan_settings settings = imk_allan_default();
    settings.statistic = o->statistic ? IMK_ALLAN_PLAIN : IMK_ALLAN_OVERLAPPING;
    settings.confidence = o->confidence;
    settings.greenhall_riley = o->edf == 1;
    for (size_t c = 0; factors && code < 0 && c < channels->count; c++) {
        const char *name = log_channel_column(channels, c)->name;
        const double *sums = running_sums(o, channels, c, n);
        imk_status status = allan_curve_compute(&settings, n, sums, channels->dt, count, factors,
                                                name, executor, &r->curve[c]);
        if (status != IMK_OK)
            code = command_failed("%s: column %s: %s", r->path, name, imk_status_text(status));
    }
    free(factors);
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
    if (code < 0 && !o->json && !o->output)
        allan_print_tables(r);
    if (code < 0 && o->plot)
        code = allan_draw(r, o->plot);
    return code < 0 ? EXIT_DONE : code;
}

static int run(int count, char **words)
{
    allan_options o = {.confidence = 0.95};
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
    code = log_input_load(&o.log, r->path, &r->channels);
    if (code < 0) {
        imk_thread_pool *pool = imk_thread_pool_create(o.threads);
        imk_executor executor = imk_thread_pool_executor(pool);
        code = compute(r, &executor);
        imk_thread_pool_destroy(pool);
        if (code < 0)
            code = show(r);
        for (size_t c = 0; c < r->channels.count; c++)
            allan_curve_free(&r->curve[c]);
        log_channels_free(&r->channels);
    }
    free(r);
    return code;
}
