/* SPDX-License-Identifier: Apache-2.0 */
/* imukit identify: log at rest -> stochastic model with confidence intervals and a verdict. */
#include "identify_parts.h"
#include "shell/voice.h"

#include "imukit/grade_position.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define AT(field) offsetof(identify_options, field)

static const option identify_option_table[] = {
    {"output", OPTION_OUTPUT, AT(output), .letter = 'o', .value = "MODEL",
     .help = "write the model here (.yaml or .json)"},
    REPORT_OPTION(AT(report),
                  "write one self-contained page: verdict, parameters, Allan plots, model"),
    PLOT_OPTION(
        AT(plot),
        "draw the Allan deviation of each channel with the model, and the difference between them"),
    {"twin", OPTION_FLAG, AT(twin),
     .help = "simulate the model over the length of the log and draw its Allan deviation over the "
             "log's"},
    {"seed", OPTION_INTEGER, AT(seed), .value = "N", .help = "seed of the twin; default 1"},
    {"into", OPTION_INTO, AT(into), .value = "MODEL",
     .help = "start from this model and replace only what is identified: noise and output filter; "
             "the changes are printed"},
    {"name", OPTION_TEXT, AT(name), .value = "TEXT",
     .help = "name of the model; default: the name of the log file"},
    {"truth", OPTION_FILE, AT(truth), .value = "MODEL",
     .help = "print the true values of this model beside the estimates, for simulated logs"},
    CONFIDENCE_OPTION(AT(confidence), "confidence of intervals and bounds; default 0.95"),
    {"significance", OPTION_FRACTION, AT(significance), .value = "FRACTION",
     .help = "chance that an absent term is reported as present; default 0.01"},
    {"keep", OPTION_TEXT, AT(keep), .value = "LIST",
     .help = "leave these in the log: outliers, stuck, saturated (samples), warm-up, temperature, "
             "all; by default they are taken out where found, and reported"},
    {"runs", OPTION_FLAG, AT(runs),
     .help = "several logs are runs of one sensor: make one joint model, test whether the runs "
             "agree, and estimate how much the mean differs from run to run"},
    {"devices", OPTION_FLAG, AT(devices),
     .help = "several logs are of different sensors: estimate the mean and the spread of each "
             "term, and show where the sensors differ"},
    {"verbose", OPTION_FLAG, AT(verbose),
     .help = "print the messages of the verdict with all details, as the page has them"},
    STRICT_OPTION(AT(strict), "exit with 1 when the verdict contains a warning"),
    JSON_OPTION(AT(json), "print the result as JSON instead of tables"),
    THREADS_OPTION(AT(threads), "threads to use; default: all processors"),
};

static const option plan_option_table[] = {
    {"plan", OPTION_FILE, AT(plan), .value = "MODEL",
     .help = "without LOG: compute how precisely a record with this noise (a file or a catalogue "
             "name) determines each term; needs --rate"},
    {"want", OPTION_TEXT, AT(want), .value = "LIST",
     .help = "compute how long to record for this: \"bias_instability 5%, gyro.rate_random_walk "
             "detected 95%\""},
    {"duration", OPTION_QUANTITY, AT(duration), .value = "TIME", .unit = "s", .choices = "positive",
     .help = "length of the planned record, or of the record behind a curve"},
};

static const option allan_option_table[] = {
    {"method", OPTION_CHOICE, AT(method), .value = "CHOICE", .choices = "likelihood|allan",
     .help = "likelihood of the spectrum (default), which uses all information in the log; or "
             "generalised least squares on the Allan deviations, which uses only what an Allan "
             "plot shows"},
    {"curve", OPTION_FLAG, AT(curve),
     .help = "LOG is a table of Allan deviations instead: columns tau [s], gyro_x [deg/s] and so "
             "on; needs --rate and --duration"},
    {"plain", OPTION_FLAG, AT(plain),
     .help = "the clusters of the curve do not overlap; default: they do"},
    {"tolerance", OPTION_FRACTION, AT(tolerance), .value = "FRACTION",
     .help =
         "error allowed in each deviation, in addition to the statistical error, such as 2% for a "
         "curve read from a page; default for --curve: the smallest with which the terms explain "
         "the curve, which is told; for a log 0"},
    {"gauss-markov", OPTION_INTEGER, AT(gauss_markov), .value = "N", .choices = "0-8",
     .help = "number of Gauss-Markov terms to look for in the Allan deviations; default 0 (the "
             "likelihood looks for them by itself)"},
};

_Static_assert(IMK_TERMS_MAX == 8, "as the range of --gauss-markov says");

void identify_warn(const identify_options *o, const imk_verdict *verdict)
{
    (void)command_unless_memory(verdict->message ? IMK_OK : IMK_ERROR_MEMORY);
    /* On a terminal the sentence and the list below it say the same. */
    if (!o->json && isatty(STDOUT_FILENO))
        return;
    for (size_t k = 0; verdict->message && k < verdict->count; k++) {
        const imk_message *m = &verdict->message[k];
        if (m->level >= IMK_FINDING_WARNING && !m->told)
            command_warn(m->code, "%s", m->clause && !o->json && !o->verbose ? m->clause : m->text);
    }
}

int identify_end(const identification *i, imk_result *result, bool warns)
{
    const identify_options *o = i->options;
    const bool model = i->model.gyro.present || i->model.accel.present;
    if (model)
        voice_model(&i->model);
    imk_result_for(result, IMK_FOR_TERMINAL);
    if (o->report)
        imk_result_line(result, "Report: %s", o->report);
    if (o->output) {
        const char *grade = imk_grade_possible(&i->model)
                                ? imk_result_key(result, "imukit grade %s, or ", o->output)
                                : "";
        imk_result_line(
            result, "Model: %s\nNext: %simukit convert %s filter.yaml --to filter --rate %.7gHz",
            o->output, grade, o->output, 1 / i->shown.log->record.dt);
    } else if (model && i->shown.log->origin != IMK_IDENTIFY_RECORDS)
        imk_result_line(result, "Next: add -o model.yaml to keep the model, --report report.html "
                                "for a page");
    const show_options options = {.report = o->report, .plot = o->plot, .json = o->json};
    return show_end(result, &options, o->strict && warns ? EXIT_FAILED : EXIT_DONE);
}

/* The model, and how the page came about. */
static void end_page(const identification *i, imk_result *result)
{
    const char *model = i->options->output ? i->options->output : "model.yaml";
    const bool grades = imk_grade_possible(&i->model);
    static const char *const flags[] = {"--json", "--twin", "--verbose", "--strict", NULL};
    static const char *const ends[] = {"-o",     "--output", "--report", "--plot", "--seed",
                                       "--into", "--name",   "--truth",  NULL};
    char again[2000];
    imk_result_for(result, IMK_FOR_PAGE);
    if (i->model.gyro.present || i->model.accel.present)
        show_model(result, "Model file", &i->model);
    show_origin(result);
    imk_result_heading(result, "Next");
    imk_result_code(result,
                    imk_result_key(result,
                                   "%s%s%s"
                                   "imukit simulate %s --rate %gHz --duration 1h --seed 2 -o "
                                   "another.csv\n"
                                   "%s --into MODEL -o MODEL   # only the noise of "
                                   "an existing model",
                                   grades ? "imukit grade " : "", grades ? model : "",
                                   grades ? "\n" : "", model, 1 / i->shown.log->record.dt,
                                   command_line_as("identify", flags, ends, sizeof again, again)));
}

static int identify_log(identification *i, const imk_executor *executor)
{
    imk_identify_log *log;
    int code = identify_run(i->options, i->shown.name, executor, &log);
    if (code < 0) {
        imk_result *result = show_begin("identify");
        i->shown.log = log;
        i->shown.verdict = imk_identify_verdict(log, NULL, result);
        identify_warn(i->options, &i->shown.verdict);
        code = identify_make_model(i, executor);
        if (code < 0) {
            imk_show_identify_log(&i->shown, result);
            if (i->options->report)
                end_page(i, result);
            code = identify_end(i, result, imk_verdict_warns(&i->shown.verdict));
        } else {
            imk_result_free(result);
        }
    }
    imk_identify_log_free(log);
    return code;
}

/* Options that go with Allan deviations only. @return -1 or the exit code */
static int check_allan(const identify_options *o)
{
    if (o->curve && (!(o->log.file.rate > 0) || !(o->duration > 0)))
        return command_misused("a curve does not state the rate and the length of its record; add "
                               "--rate and --duration, such as --rate 100Hz --duration 3h");
    if (o->curve && (o->keep || o->twin))
        return command_misused("%s needs the samples of a log, and a curve has none",
                               o->keep ? "--keep" : "--twin");
    if (o->duration > 0 && !o->curve)
        return command_misused("--duration goes with --plan or --curve; a log has its own length");
    if (o->plain && !o->curve)
        return command_misused("--plain goes with --curve");
    if ((!isnan(o->tolerance) || o->gauss_markov.given) && !o->curve && o->method != METHOD_ALLAN)
        return command_misused("%s goes with --method allan or --curve",
                               !isnan(o->tolerance) ? "--tolerance" : "--gauss-markov");
    if (o->tolerance > 0.5)
        return command_misused("--tolerance: at most 50%%");
    return -1;
}

/* Options that do not go together. @return -1 or the exit code */
static int check_request(const identify_options *o, size_t logs)
{
    if (!(o->significance < 0.5))
        return command_misused("--significance: below 50%%; it is a false-alarm rate");
    if (o->plan && (o->output || o->into || o->report || o->truth || o->keep || o->twin ||
                    o->runs || o->devices || o->curve))
        return command_misused("--plan goes with --want, --rate, --duration, --plot, --json and "
                               "--strict; the other options are about a log");
    if (o->plan)
        return logs == 0 ? -1
                         : command_misused("--plan is for a record that does not exist yet; leave "
                                           "out the log, or --plan");
    if (o->want)
        return command_misused("--want states requirements for a planned record; add --plan MODEL");
    if (logs == 0)
        return command_misused("an operand is missing: imukit identify LOG..., or --plan MODEL");
    if (o->runs && o->devices)
        return command_misused(
            "--runs means one sensor, --devices means different ones; leave one out");
    if (logs > 1 && !o->runs && !o->devices)
        return command_misused("%zu logs are given: add --runs when they are of one sensor (one "
                               "joint model), or --devices when they are of different ones (their "
                               "spread)",
                               logs);
    if (logs == 1 && (o->runs || o->devices))
        return command_misused("%s needs two logs or more", o->runs ? "--runs" : "--devices");
    if (o->curve && logs > 1)
        return command_misused("--curve takes one table at a time");
    return check_allan(o);
}

/* What --keep leaves of everything that can be taken out. @return -1 or the exit code */
static int parse_keep(identify_options *o)
{
    static const struct {
        const char *name;
        unsigned bit;
    } parts[] = {{"outliers", IMK_SCREEN_OUTLIERS},       {"stuck", IMK_SCREEN_STUCK},
                 {"saturated", IMK_SCREEN_SATURATED},     {"warm-up", IMK_SCREEN_WARM_UP},
                 {"temperature", IMK_SCREEN_TEMPERATURE}, {"all", IMK_SCREEN_ALL}};
    enum { PARTS = sizeof parts / sizeof parts[0] };
    o->take_out = IMK_SCREEN_ALL;
    for (const char *text = o->keep; text && *text;) {
        const size_t length = strcspn(text, ",");
        size_t k = 0;
        while (k < PARTS &&
               (strlen(parts[k].name) != length || strncmp(parts[k].name, text, length) != 0))
            k++;
        if (k == PARTS)
            return command_misused("--keep: \"%.*s\" is none of outliers, stuck, saturated, "
                                   "warm-up, temperature, all",
                                   (int)length, text);
        o->take_out &= ~parts[k].bit;
        text += length + (text[length] == ',');
    }
    return -1;
}

static int identify_operands(const identify_options *o, size_t logs, const char *const *operands)
{
    identification *i = command_zeroed(sizeof *i);
    i->options = o;
    i->shown.name = operands[0];
    i->shown.verbose = o->verbose;
    int code = -1;
    if (o->truth) {
        code = command_model(o->truth, &i->truth, NULL);
        i->shown.truth = &i->truth;
    }
    if (code < 0) {
        imk_thread_pool *pool = imk_thread_pool_create(o->threads.value);
        const imk_executor executor = imk_thread_pool_executor(pool);
        code =
            logs > 1 ? identify_several(i, logs, operands, &executor) : identify_log(i, &executor);
        imk_thread_pool_destroy(pool);
    }
    for (size_t c = 0; c < IMK_LOG_COLUMNS_MAX; c++)
        imk_allan_curve_free(&i->twin[c], &(imk_allocator){0});
    free(i);
    return code;
}

static int run(int count, char **words)
{
    identify_options o = {.confidence = 0.95,
                          .significance = 0.01,
                          .tolerance = (double)NAN,
                          .seed = {.value = 1},
                          .log = {.gaps = IMK_GAPS_KEEP, .missing_allowed = true}};
    const char *operands[IMK_JOINT_RECORDS_MAX];
    size_t logs = 0;
    int code = options_parse(&identify_verb, count, words, &o, operands);
    while (code < 0 && logs < IMK_JOINT_RECORDS_MAX && operands[logs])
        logs++;
    if (code < 0)
        code = check_request(&o, logs);
    if (code < 0)
        code = command_check_plot(o.plot);
    if (code < 0)
        code = parse_keep(&o);
    if (code >= 0)
        return code;
    return o.plan ? identify_plan(&o) : identify_operands(&o, logs, operands);
}

const verb identify_verb = {
    .name = "identify",
    .summary = "log of a sensor at rest -> model of its noise, with a verdict on the log",
    .operands = "LOG... | --plan MODEL",
    .operands_minimum = 0,
    .operands_maximum = IMK_JOINT_RECORDS_MAX,
    .all_are_evidence = true,
    .examples = {{"imukit identify static.csv -o model.yaml --report report.html",
                  "noise terms of every gyro and accelerometer axis, and a page to look at"},
                 {"imukit identify raw.csv --rate 200Hz --columns gyro_x,gyro_y,gyro_z "
                  "--gyro-unit deg/s -o gyro.yaml --twin --plot term",
                  "a log without header and time column; the model's twin is drawn over it"}},
    .description =
        "LOG is a record of a stationary sensor: CSV with a header such as time [s],gyro_x "
        "[deg/s],accel_x [g] (also .gz, .zst){, or logs}; - is standard input. An hour shows the "
        "white noise and the bias instability of most sensors, several hours the random "
        "walk.\n\nThe estimated terms of each channel are quantization, white noise (angle or "
        "velocity random walk), bias instability, rate or acceleration random walk and ramp; "
        "spectral lines, resonances and the output filter are modelled separately. A term that the "
        "record does not show is reported as absent with an upper bound.\n\nMissing samples stay "
        "missing. Where the log shows them, outliers, stuck and saturated samples are left out, "
        "and a warm-up and the effect of a temperature column are subtracted. The verdict reports "
        "what was found; --keep leaves it in the log.\n\nSeveral LOGs need --runs (of one sensor) "
        "or --devices (different sensors).\n\nThe mean of the record is printed but not written as "
        "a bias: at rest it contains the Earth's rotation and gravity, and only a known attitude "
        "separates these from the bias.",
    .groups = {OPTION_GROUP("Options", identify_option_table, 0),
               OPTION_GROUP("Planning a record", plan_option_table, 0),
               OPTION_GROUP("From Allan deviations", allan_option_table, 0),
               LOG_INPUT_GROUP(AT(log))},
    .run = run};
