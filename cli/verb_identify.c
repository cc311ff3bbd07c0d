/* SPDX-License-Identifier: Apache-2.0 */
/* imukit identify: log at rest -> stochastic model with confidence intervals and a verdict. */
#include "identify_parts.h"

#include <stdlib.h>

static const option identify_option_table[] = {
    {"output", 'o', OPTION_OUTPUT, "MODEL", NULL, NULL, "write the model here (.yaml or .json)",
     offsetof(identify_options, output)},
    {"report", 0, OPTION_OUTPUT, "FILE.html", NULL, NULL,
     "write one self-contained page: verdict, parameters, Allan plots, model",
     offsetof(identify_options, report)},
    {"plot", 0, OPTION_OUTPUT, "FILE.svg|FILE.png|term", NULL, NULL,
     "draw the Allan deviation of each channel with the model", offsetof(identify_options, plot)},
    {"twin", 0, OPTION_FLAG, NULL, NULL, NULL,
     "simulate the model over the length of the log and draw its Allan deviation over the log's",
     offsetof(identify_options, twin)},
    {"seed", 0, OPTION_INTEGER, "N", NULL, NULL, "of the twin; default 1",
     offsetof(identify_options, seed)},
    {"into", 0, OPTION_FILE, "MODEL", NULL, NULL,
     "start from this model and replace only what is identified: noise and output filter; the "
     "changes are printed",
     offsetof(identify_options, into)},
    {"name", 0, OPTION_TEXT, "TEXT", NULL, NULL, "name of the model; default: that of the log file",
     offsetof(identify_options, name)},
    {"truth", 0, OPTION_FILE, "MODEL", NULL, NULL,
     "print these true values beside the estimates, for logs that were simulated",
     offsetof(identify_options, truth)},
    {"confidence", 0, OPTION_FRACTION, "FRACTION", NULL, NULL,
     "of intervals and bounds; default 0.95", offsetof(identify_options, confidence)},
    {"strict", 0, OPTION_FLAG, NULL, NULL, NULL, "exit with 1 when the verdict holds a warning",
     offsetof(identify_options, strict)},
    {"json", 0, OPTION_FLAG, NULL, NULL, NULL, "print the result as JSON instead of tables",
     offsetof(identify_options, json)},
    {"threads", 0, OPTION_INTEGER, "N", NULL, NULL, "threads to use; default: all processors",
     offsetof(identify_options, threads)},
};

static int run(int count, char **words);

const verb identify_verb = {
    .name = "identify",
    .summary = "log of a sensor at rest -> model of its noise, with a verdict on the log",
    .operands = "LOG",
    .operands_minimum = 1,
    .operands_maximum = 1,
    .examples = {{"imukit identify static.csv -o model.yaml --report report.html",
                  "noise terms of every gyro and accelerometer axis, and a page to look at"},
                 {"imukit identify raw.csv --rate 200Hz --columns gyro_x,gyro_y,gyro_z "
                  "--gyro-unit deg/s -o gyro.yaml --twin --plot term",
                  "a log without header and time column; the model's twin is drawn over it"}},
    .description =
        "LOG is a record of a sensor that does not move: CSV with a header such as time [s],gyro_x "
        "[deg/s],accel_x [g] (also .gz, .zst), or .npy; - is standard input. An hour shows the "
        "white noise and the bias instability of most sensors, several hours the random walk.\n\n"
        "Estimated for each channel: quantization, white noise (angle or velocity random walk), "
        "bias instability, rate or acceleration random walk and ramp, with spectral lines, "
        "resonances and the output filter modelled apart. A term that the record does not show is "
        "reported as absent with an upper bound.\n\n"
        "The mean of the record is printed but not written as a bias: at rest it holds the Earth's "
        "rotation and gravity, which need a known attitude to be told apart.",
    .groups = {{"Options", sizeof identify_option_table / sizeof identify_option_table[0],
                identify_option_table, 0},
               {"Reading the log", LOG_INPUT_OPTIONS, log_input_options,
                offsetof(identify_options, log)}},
    .run = run};

static void print_text(const identification *i)
{
    for (channel_kind kind = CHANNEL_GYRO; kind < CHANNEL_KINDS; kind++) {
        text_table table = identify_table(i, kind);
        if (table.rows > 0) {
            text_table_print(&table, stdout);
            putchar('\n');
        }
        text_table_free(&table);
    }
    if (i->options->truth) {
        size_t covered, stated;
        text_table table = identify_truth_table(i, &covered, &stated);
        text_table_print(&table, stdout);
        text_table_free(&table);
        printf("%zu of %zu intervals cover the truth; %g %% are expected to.\n\n", covered, stated,
               100 * i->options->confidence);
    }
    for (size_t k = 0; k < i->verdict_count; k++)
        if (i->verdict[k].level != VERDICT_WARNING)
            printf("%s\n", i->verdict[k].text);
}

static void suggest_next(const identification *i)
{
    const identify_options *o = i->options;
    if (o->report)
        printf("Report: %s\n", o->report);
    if (o->output)
        printf("Model: %s\nNext: imukit grade %s\n", o->output, o->output);
    else if (i->model.gyro.present || i->model.accel.present)
        printf("Next: add -o model.yaml to keep the model, --report report.html for a page\n");
}

static int draw(const identification *i)
{
    imk_error error;
    imk_status status = imk_error_set(&error, IMK_ERROR_MEMORY, "figure", NULL, NULL);
    identify_figure *figure = malloc(sizeof *figure);
    if (figure && identify_figure_make(i, figure)) {
        status = imk_figure_write(&figure->figure, i->options->plot, &error);
        identify_figure_free(figure);
    }
    free(figure);
    return status == IMK_OK ? -1 : command_error(&error, NULL);
}

/* Everything after the channels are identified. */
static int present(identification *i, const imk_executor *executor)
{
    const identify_options *o = i->options;
    int code = -1;
    identify_judge(i);
    if (o->twin)
        code = identify_twin(i, executor);
    if (code < 0)
        code = identify_write_model(i);
    if (code < 0 && o->report)
        code = identify_report(i, o->report);
    if (code >= 0)
        return code;
    code = o->strict && identify_is_bad(i) ? EXIT_FAILED : EXIT_DONE;
    if (o->json) {
        code = identify_json(i, code);
    } else {
        print_text(i);
        suggest_next(i);
    }
    int drawn = o->plot ? draw(i) : -1;
    return drawn < 0 ? code : drawn;
}

static int identify_log(identification *i, const char *path, const imk_executor *executor)
{
    int code = log_input_load(&i->options->log, path, &i->channels);
    if (code >= 0)
        return code;
    code = identify_channels(i, executor);
    if (code < 0)
        code = present(i, executor);
    for (size_t c = 0; c < i->channels.count; c++) {
        allan_curve_free(&i->curve[c]);
        allan_curve_free(&i->twin[c]);
    }
    log_channels_free(&i->channels);
    return code;
}

static int run(int count, char **words)
{
    identify_options o = {.confidence = 0.95, .seed = 1};
    const char *operands[OPERANDS_MAX];
    int code = options_parse(&identify_verb, count, words, &o, operands);
    if (code < 0)
        code = command_check_plot(o.plot);
    if (code >= 0)
        return code;
    identification *i = calloc(1, sizeof *i);
    if (!i)
        return command_failed("memory is exhausted");
    i->options = &o;
    i->path = operands[0];
    code = o.truth ? command_model(o.truth, &i->truth, NULL) : -1;
    if (code >= 0) {
        free(i);
        return code;
    }
    imk_thread_pool *pool = imk_thread_pool_create(o.threads);
    imk_executor executor = imk_thread_pool_executor(pool);
    code = identify_log(i, operands[0], &executor);
    imk_thread_pool_destroy(pool);
    free(i);
    return code;
}
