/* SPDX-License-Identifier: Apache-2.0 */
/* imukit spectrum: power spectral density of a log, its lines, and the noise it shows. */
#include "log/log_input.h"
#include "shell/job_progress.h"
#include "shell/show.h"

#include "imukit/channel_units.h"
#include "imukit/show.h"

#include <string.h>

typedef struct spectrum_options {
    log_input log;
    imk_spectrum_log_settings settings;
    int density; /* one-sided: 1 */
    const char *output, *plot, *report;
    bool json;
    option_integer threads;
} spectrum_options;

#define AT(field) offsetof(spectrum_options, field)

static const option spectrum_option_table[] = {
    {"method", OPTION_CHOICE, AT(settings.method), .value = "CHOICE", .choices = "welch|multitaper",
     .help = "averaged windowed segments (the default), or Slepian tapers, for records too short "
             "to be divided"},
    {"resolution", OPTION_QUANTITY, AT(settings.resolution), .value = "BANDWIDTH", .unit = "Hz",
     .choices = "positive",
     .help = "smallest distance at which two lines are separated; default: 31 segments, or one for "
             "multitaper"},
    {"window", OPTION_CHOICE, AT(settings.window), .value = "CHOICE",
     .choices = "hann|blackman-harris|kaiser",
     .help =
         "window of the segments; blackman-harris and kaiser suit weak lines beside strong ones"},
    {"trend", OPTION_FLAG, AT(settings.trend),
     .help = "remove a straight line from each segment, not only its mean"},
    {"density", OPTION_CHOICE, AT(density), .value = "SIDES", .choices = "two-sided|one-sided",
     .help = "convention of the densities shown: that of IEEE (the default), or twice as large, as "
             "in many data sheets and analysers; parameters are always two-sided"},
    {"false-alarm", OPTION_FRACTION, AT(settings.false_alarm), .value = "FRACTION",
     .help = "chance that a channel without lines shows any; default 0.001"},
    {"from", OPTION_QUANTITY, AT(settings.from), .value = "FREQUENCY", .unit = "Hz",
     .choices = "not negative",
     .help = "lowest frequency of the fit of the noise parameters; default: the lowest resolved"},
    {"to", OPTION_QUANTITY, AT(settings.to), .value = "FREQUENCY", .unit = "Hz",
     .choices = "positive",
     .help = "highest frequency of this fit; set it below the sensor's own filter; default: half "
             "the sampling rate"},
    CONFIDENCE_OPTION(AT(settings.confidence),
                      "confidence of the two-sided intervals; default 0.95"),
    {"output", OPTION_OUTPUT, AT(output), .letter = 'o', .value = "FILE.csv",
     .help = "write the densities (100 per decade, one line per channel and frequency, SI) here; - "
             "is standard output"},
    PLOT_OPTION(AT(plot), "draw the root densities with their intervals, and mark the lines"),
    REPORT_OPTION(AT(report), "write one self-contained page: plot and tables"),
    JSON_OPTION(AT(json), "print the result as JSON instead of tables"),
    THREADS_OPTION(AT(threads), "threads to use; default: all processors"),
};

static void write_rows(const imk_spectrum_log *s, size_t channel, imk_output_file *file)
{
    const imk_log_column *column = imk_even_record_column(&s->record, channel);
    const imk_channel_spectrum *f = &s->channel[channel];
    const imk_unit unit = imk_channel_plain_unit(column);
    for (size_t i = 0; i < f->fine_count; i++) {
        const imk_spectrum_band b = imk_spectrum_log_band(s, channel, &f->fine[i]);
        const double values[] = {b.frequency, b.density, b.lower, b.upper};
        char text[IMK_DECIMAL_SIZE];
        imk_output_file_print(file, "%s", column->name);
        for (int k = 0; k < 4; k++) {
            text[imk_decimal_shortest(values[k], text)] = '\0';
            imk_output_file_print(file, ",%s", text);
        }
        text[imk_decimal_significant(b.degrees, 6, text)] = '\0';
        imk_output_file_print(file, ",%s,%s,%s\n", text,
                              s->settings.one_sided ? "one-sided" : "two-sided", unit.text);
    }
}

/* @return -1 or the exit code */
static int write_csv(const imk_spectrum_log *s, const char *output)
{
    imk_output_file *file;
    imk_error error;
    if (imk_output_file_open(output, &file, &error) != IMK_OK)
        return command_error(&error, NULL);
    imk_output_file_print(file, "channel,frequency [Hz],density [unit^2/Hz],lower,upper,degrees,"
                                "sides,unit\n");
    for (size_t c = 0; c < s->record.count; c++)
        write_rows(s, c, file);
    if (imk_output_file_commit(file, &error) != IMK_OK)
        return command_error(&error, NULL);
    return -1;
}

static int show(const imk_spectrum_log *s, const spectrum_options *o, const char *path)
{
    const int code = o->output ? write_csv(s, o->output) : -1;
    if (code >= 0)
        return code;
    imk_result *result = show_begin("spectrum");
    imk_show_spectrum_log(s, path, result);
    imk_result_for(result, IMK_FOR_PAGE);
    show_origin(result);
    const show_options options = {
        .report = o->report, .plot = o->plot, .json = o->json, .quiet = o->output != NULL};
    return show_end(result, &options, EXIT_DONE);
}

/* A wrong option is not an error of the log. */
static int tell(const char *path, const imk_spectrum_log *s, imk_status status,
                const imk_error *error)
{
    const imk_findings none = {.count = 0}, *findings = s ? &s->findings : &none;
    const imk_finding *failure = status == IMK_ERROR_RANGE ? imk_findings_failure(findings) : NULL;
    char text[400];
    log_input_note(path, findings);
    if (status == IMK_ERROR_RANGE && strcmp(error->field, "from") == 0)
        return command_misused(
            "--from %g Hz: the spectrum of %s ends at half its sample rate, %g Hz", error->value,
            path, error->limit);
    if (!failure)
        return log_input_tell(path, findings, status, error);
    imk_finding_text(failure, text, sizeof text);
    return command_misused("%s", text);
}

static int analyse(const spectrum_options *o, const char *path)
{
    imk_log_reader *reader;
    int code = log_input_open(&o->log, path, false, &reader);
    if (code >= 0)
        return code;
    imk_spectrum_log *s;
    imk_error error;
    threaded_job t;
    threaded_job_begin(&t, path, o->threads.value);
    const imk_record_source source = imk_log_source(reader);
    const imk_status status = imk_spectrum_log_run(&source, &o->settings, &t.job, &s, &error);
    threaded_job_end(&t);
    imk_log_close(reader);
    code = tell(path, s, status, &error);
    if (code < 0)
        code = show(s, o, path);
    imk_spectrum_log_free(s);
    return code;
}

static int run(int count, char **words)
{
    spectrum_options o = {.settings = imk_spectrum_log_default()};
    imk_spectrum_log_settings *settings = &o.settings;
    const char *operands[OPERANDS_MAX];
    int code = options_parse(&spectrum_verb, count, words, &o, operands);
    if (code < 0)
        code = command_check_plot(o.plot);
    if (code < 0)
        code = log_table_check(o.output);
    if (code < 0)
        code = log_input_check(&o.log);
    if (code < 0 && settings->to > 0 && !(settings->from < settings->to))
        code =
            command_misused("--from %g Hz is not below --to %g Hz", settings->from, settings->to);
    settings->gaps = (imk_gap_policy)o.log.gaps;
    settings->one_sided = o.density == 1;
    return code < 0 ? analyse(&o, operands[0]) : code;
}

const verb spectrum_verb = {
    .name = "spectrum",
    .summary = "power spectral density of a log, its lines and its noise",
    .operands = "LOG",
    .operands_minimum = 1,
    .operands_maximum = 1,
    .examples = {{"imukit spectrum static.csv --plot spectrum.svg",
                  "densities, vibration and interference lines, noise parameters of every channel"},
                 {"imukit spectrum bench.csv --resolution 0.01Hz --density one-sided -o psd.csv",
                  "a finer resolution, in the convention of most spectrum analysers, as a table"}},
    .description =
        "LOG is CSV with a header such as time [s],gyro_x [deg/s],accel_x [g] (also .gz, .zst){, "
        "or logs}; - is standard input. Without gyro and accelerometer columns every other column "
        "is analysed.\n\nEach line is listed with its frequency, its amplitude and the line of "
        "which it is a multiple. The noise parameters are a cross-check of imukit identify, which "
        "is the better estimator; where the two differ, the log contains something that neither of "
        "them models.",
    .groups = {OPTION_GROUP("Options", spectrum_option_table, 0), LOG_INPUT_GROUP(AT(log))},
    .run = run};
