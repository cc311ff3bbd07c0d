/* SPDX-License-Identifier: Apache-2.0 */
/* imukit allan: Allan deviations of a log with confidence intervals. */
#include "log/log_input.h"
#include "shell/job_progress.h"
#include "shell/show.h"

#include "imukit/decimal.h"
#include "imukit/show.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct allan_options {
    log_input log;
    int edf, type, bias;
    const char *statistic, *tau, *output, *plot, *report;
    double confidence;
    bool json;
    option_integer threads;
} allan_options;

#define AT(field) offsetof(allan_options, field)

static const option allan_option_table[] = {
    {"statistic", OPTION_TEXT, AT(statistic), .value = "NAME,NAME…|all",
     .help = "oadev (the default), adev, mdev, tdev, ohdev, hdev, totdev, mtot, htot, theo1, pdev, "
             "haar; theo1 takes seconds per million samples"},
    {"tau", OPTION_TEXT, AT(tau), .value = "octave|decade|many|all|LIST",
     .help = "averaging times: octave (doubling, the default), decade (ten per decade), many (all "
             "up to 64 samples, then 32 per octave), all, or a list such as 1,10,100 in seconds"},
    CONFIDENCE_OPTION(AT(confidence), "confidence of the two-sided intervals; default 0.95"),
    {"edf", OPTION_CHOICE, AT(edf), .value = "CHOICE", .choices = "exact|greenhall-riley",
     .help = "degrees of freedom of the intervals: exact for the sampled process (the default), or "
             "by the published formulas for the continuous process"},
    {"bias", OPTION_CHOICE, AT(bias), .value = "CHOICE", .choices = "removed|published|left",
     .help = "bias of totdev, mtot, htot and theo1 against adev, mdev and hdev: removed for the "
             "noise found (the default), removed with the published factors, or left in"},
    {"type", OPTION_CHOICE, AT(type), .value = "CHOICE", .choices = "rate|phase",
     .help = "what the columns contain: rates (the default), or their integral (phase, angle)"},
    {"output", OPTION_OUTPUT, AT(output), .letter = 'o', .value = "FILE.csv",
     .help = "write the long table (one line per channel and averaging time, SI) here; - is "
             "standard output"},
    PLOT_OPTION(AT(plot), "draw the deviations with their intervals"),
    REPORT_OPTION(AT(report), "write one self-contained page: plot and tables"),
    JSON_OPTION(AT(json), "print the result as JSON instead of a table"),
    THREADS_OPTION(AT(threads), "threads to use; default: all processors"),
};

/* Names of --statistic. @return -1 or the exit code */
static int parse_statistics(const char *text, imk_allan_log_settings *r)
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
    *code = times ? -1 : command_failed_by("memory", NULL, NULL, "memory is exhausted");
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
            *code = command_misused("--tau %s: \"%.*s\" is not an averaging time; expected octave, "
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

/* Averaging times of --tau. @return -1 or the exit code; *times is to be freed */
static int parse_tau(const char *text, imk_allan_log_settings *settings, double **times)
{
    static const char *const grids[] = {"octave", "decade", "all", "many"};
    int code = -1;
    for (int i = 0; i < 4; i++)
        if (!text || strcmp(text, grids[i]) == 0) {
            settings->grid = (imk_allan_grid)i;
            return code;
        }
    settings->times = *times = parse_times(text, &settings->time_count, &code);
    return code;
}

/* @param log  begins each line; "": nothing */
static void write_rows(const imk_allan_log *a, const char *log, size_t channel, size_t k,
                       imk_output_file *file)
{
    const imk_allan_statistic statistic = a->settings.statistic[k];
    const imk_allan_curve *curve = &a->curve[channel][k];
    const imk_unit unit = imk_allan_log_unit(a, channel, statistic);
    for (size_t i = 0; i < curve->count; i++) {
        const imk_allan_point *point = &curve->point[i];
        const double values[] = {curve->tau[i], point->deviation / unit.scale,
                                 point->lower / unit.scale, point->upper / unit.scale};
        imk_output_file_print(file, "%s%s%s", log, *log ? "," : "",
                              imk_even_record_column(&a->record, channel)->name);
        for (int j = 0; j < 4; j++) {
            char text[IMK_DECIMAL_SIZE];
            text[imk_decimal_shortest(values[j], text)] = '\0';
            imk_output_file_print(file, ",%s", text);
        }
        char edf[IMK_DECIMAL_SIZE], used[IMK_DECIMAL_SIZE];
        edf[imk_decimal_significant(point->edf, 6, edf)] = '\0';
        used[imk_decimal_significant(curve->used ? curve->used[i] : 1, 6, used)] = '\0';
        imk_output_file_print(file, ",%s,%zu,%s,%s,%s,%s\n", edf, point->count, unit.text,
                              imk_allan_name(statistic), imk_power_law_name(point->type), used);
    }
}

static int write_csv(const imk_allan_shown *shown, const char *output)
{
    imk_output_file *file;
    imk_error error;
    const bool several = shown->count > 1;
    if (imk_output_file_open(output, &file, &error) != IMK_OK)
        return command_error(&error, NULL);
    imk_output_file_print(file,
                          "%schannel,tau [s],deviation [unit],lower,upper,edf,count,unit,"
                          "statistic,noise,used\n",
                          several ? "log," : "");
    for (size_t l = 0; l < shown->count; l++)
        for (size_t c = 0; c < shown->log[l]->record.count; c++)
            for (size_t k = 0; k < shown->log[l]->settings.statistic_count; k++)
                write_rows(shown->log[l], several ? shown->label[l] : "", c, k, file);
    if (imk_output_file_commit(file, &error) != IMK_OK)
        return command_error(&error, NULL);
    return -1;
}

static const char *base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* The names without folders, if all differ. */
static void label_logs(imk_allan_shown *shown)
{
    bool same = false;
    for (size_t l = 0; l < shown->count; l++)
        for (size_t q = 0; q < l; q++)
            same = same || strcmp(base_name(shown->name[l]), base_name(shown->name[q])) == 0;
    for (size_t l = 0; l < shown->count; l++)
        shown->label[l] = same ? shown->name[l] : base_name(shown->name[l]);
}

static int show(const imk_allan_shown *shown, const allan_options *o)
{
    const int code = o->output ? write_csv(shown, o->output) : -1;
    if (code >= 0)
        return code;
    imk_result *result = show_begin("allan");
    imk_show_allan_logs(shown, result);
    imk_result_for(result, IMK_FOR_PAGE);
    show_origin(result);
    const show_options options = {
        .report = o->report, .plot = o->plot, .json = o->json, .quiet = o->output != NULL};
    return show_end(result, &options, EXIT_DONE);
}

/* A time that the record does not allow is a wrong option, not a wrong log. */
static int tell(const allan_options *o, const char *path, const imk_allan_log *a, imk_status status,
                const imk_error *error)
{
    const imk_findings none = {.count = 0}, *findings = a ? &a->findings : &none;
    const imk_finding *failure = status == IMK_ERROR_RANGE ? imk_findings_failure(findings) : NULL;
    char text[300];
    log_input_note(path, findings);
    if (!failure)
        return log_input_tell(path, findings, status, error);
    imk_finding_text(failure, text, sizeof text);
    return command_misused("--tau %s: %s", o->tau, text);
}

static int analyse(const allan_options *o, const char *path, const imk_allan_log_settings *settings,
                   imk_allan_log **a)
{
    imk_log_reader *reader;
    int code = log_input_open(&o->log, path, false, &reader);
    if (code >= 0)
        return code;
    imk_error error;
    threaded_job t;
    threaded_job_begin(&t, path, o->threads.value);
    const imk_record_source source = imk_log_source(reader);
    const imk_status status = imk_allan_log_run(&source, settings, &t.job, a, &error);
    threaded_job_end(&t);
    imk_log_close(reader);
    return tell(o, path, *a, status, &error);
}

static int analyse_all(const allan_options *o, const char *const *paths,
                       const imk_allan_log_settings *settings)
{
    imk_allan_log *log[IMK_ALLAN_LOGS_MAX] = {NULL};
    imk_allan_shown shown = {.count = 0};
    int code = -1;
    for (; code < 0 && shown.count < IMK_ALLAN_LOGS_MAX && paths[shown.count]; shown.count++) {
        shown.name[shown.count] = paths[shown.count];
        code = analyse(o, paths[shown.count], settings, &log[shown.count]);
        shown.log[shown.count] = log[shown.count];
    }
    label_logs(&shown);
    if (code < 0)
        code = show(&shown, o);
    for (size_t l = 0; l < shown.count; l++)
        imk_allan_log_free(log[l]);
    return code;
}

static int run(int count, char **words)
{
    allan_options o = {.confidence = 0.95, .log = {.gaps = IMK_GAPS_KEEP, .missing_allowed = true}};
    const char *operands[IMK_ALLAN_LOGS_MAX + 1] = {NULL};
    imk_allan_log_settings settings = imk_allan_log_default();
    double *times = NULL;
    int code = options_parse(&allan_verb, count, words, &o, operands);
    if (code < 0)
        code = command_check_plot(o.plot);
    if (code < 0)
        code = log_table_check(o.output);
    if (code < 0)
        code = parse_statistics(o.statistic, &settings);
    if (code < 0)
        code = parse_tau(o.tau, &settings, &times);
    settings.gaps = (imk_gap_policy)o.log.gaps;
    settings.phase = o.type == 1;
    settings.confidence = o.confidence;
    settings.greenhall_riley = o.edf == 1;
    settings.bias = (imk_allan_bias_removal)o.bias;
    if (code < 0)
        code = analyse_all(&o, operands, &settings);
    free(times);
    return code;
}

const verb allan_verb = {
    .name = "allan",
    .summary = "Allan family deviations of a log with confidence intervals",
    .operands = "LOG...",
    .operands_minimum = 1,
    .operands_maximum = IMK_ALLAN_LOGS_MAX,
    .examples = {{"imukit allan static.csv --plot allan.svg",
                  "every gyro and accelerometer column of a log at rest, as a table and a plot"},
                 {"imukit allan phase.txt --columns x --rate 1Hz --type phase -o adev.csv",
                  "one column of phase data without header, sampled once a second"}},
    .description =
        "LOG is CSV with a header such as time [s],gyro_x [deg/s],accel_x [g] (also .gz, .zst){, "
        "or logs}; - is standard input. Without gyro and accelerometer columns every other column "
        "is analysed. Several logs are shown side by side: a panel and a table for each channel, "
        "with a colour and a column for each log.\n\nChoice of the statistic: oadev for a first "
        "look at a sensor; mdev or pdev "
        "to distinguish quantization from other fast noise; ohdev when the rate drifts linearly; "
        "totdev, htot and theo1 for tau near the length of the log; tdev (in units of the column "
        "times s) for the scatter of the integral; haar as published for wavelet methods. \n\nRows "
        "that are missing or not finite leave gaps. oadev of rates then uses the existing samples, "
        "and the table shows the share of the record's pairs behind each point. The other "
        "statistics, and phase, need a complete record: --gaps bridge or --gaps longest.",
    .groups = {OPTION_GROUP("Options", allan_option_table, 0), LOG_INPUT_GROUP(AT(log))},
    .run = run};
