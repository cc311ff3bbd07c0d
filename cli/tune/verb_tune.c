/* SPDX-License-Identifier: Apache-2.0 */
/* imukit tune: the noise parameters that make a Kalman filter consistent on a motion. */
#include "campaign/campaign_run.h"
#include "shell/job_progress.h"
#include "shell/show.h"
#include "shell/term_selection.h"
#include "tune_parts.h"

#include "imukit/model_file.h"
#include "imukit/model_unstated.h"
#include "imukit/names.h"
#include "imukit/show.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define AT(field) offsetof(tune_options, field)

static const option tune_option_table[] = {
    {"rate", OPTION_QUANTITY, AT(rate), .letter = 'r', .value = "RATE", .unit = "Hz",
     .choices = "0.1..100000",
     .help = "sampling rate; default 200Hz, or that of recorded rates and forces"},
    {"from", OPTION_QUANTITY, AT(from), .value = "TIME", .unit = "s", .choices = "1e-6..1000",
     .help = "shortest time between updates of the filter; default 0.01s"},
    {"to-time", OPTION_QUANTITY, AT(to), .value = "TIME", .unit = "s", .choices = "1e-6..1000",
     .help = "longest time between updates of the filter; default 10s"},
    {"windows", OPTION_INTEGER, AT(windows), .value = "N", .choices = "1-256",
     .help = "windows along each motion; default 64"},
    {"gyro-bias", OPTION_QUANTITY, AT(bias[0]), .value = "RATE", .unit = "deg/h",
     .choices = "not negative",
     .help = "1 sigma to which the filter knows the gyro biases; default: the Allan deviation of "
             "the model at 100 s"},
    {"accel-bias", OPTION_QUANTITY, AT(bias[1]), .value = "ACCELERATION", .unit = "mg",
     .choices = "not negative", .help = "the same of the accelerometer biases"},
    {"bias-time", OPTION_QUANTITY, AT(bias_time), .value = "TIME", .unit = "s",
     .choices = "0..10000",
     .help = "the bias that the filter knows is a mean over this time; default 1s"},
    {"learned", OPTION_FLAG, AT(learned),
     .help = "the bias that the filter knows is the mean of all slow errors of the readings, as a "
             "filter with updates learns it; default: of the bias terms alone"},
    {"correlation-time", OPTION_QUANTITY, AT(correlation_time), .value = "TIME", .unit = "s",
     .choices = "1..1e9",
     .help = "the filter's biases are Gauss-Markov processes of this time; default: random walks"},
    {"compensated", OPTION_FLAG, AT(compensated),
     .help = "known values of the model are taken out of the readings, and their uncertainty "
             "stays"},
    ASSUME_CLASS_OPTION(AT(assume_class)),
    {"per-axis", OPTION_FLAG, AT(per_axis), .help = "numbers of each axis; default: of each triad"},
    LATITUDE_OPTION(AT(latitude), "geodetic latitude of motions that state no place; default "
                                  "45deg"),
    HEIGHT_OPTION(AT(height)),
};

static const option output_option_table[] = {
    {"answer", OPTION_CHOICE, AT(answer), .value = "WHICH",
     .choices = "safe|fit|safe-scale-factors|fit-scale-factors",
     .help = "the numbers that -o writes; default: safe"},
    {"output", OPTION_OUTPUT, AT(output), .letter = 'o', .value = "FILE",
     .help = "write them: a model file, or a parameter file of --to"},
    {"to", OPTION_CHOICE, AT(format), .value = "FORMAT",
     .choices = "model|kalibr|gazebo|matlab|gnss-ins-sim|navego|openvins|vins|px4|ardupilot|filter|"
                "lio-sam|fast-lio|dlio|glim|orb-slam3|gtsam|airsim|fusion",
     .help = "format of that file, as in imukit convert; default: model"},
    {"frame-rate", OPTION_QUANTITY, AT(frame_rate), .value = "RATE", .unit = "Hz",
     .choices = "1e-9..1e9", .help = "--to glim: LiDAR scans per second"},
    {"monte-carlo", OPTION_INTEGER, AT(runs), .letter = 'n', .value = "N",
     .choices = "3-4294967295", .help = "also simulate N runs and compare their NEES"},
    SEED_OPTION(AT(seed), "seed of the runs and of random vibration; default 1"),
    THREADS_OPTION(AT(threads),
                   "threads to use; default: all processors. The results do not depend on it"),
    PLOT_OPTION(AT(plot), "draw the NEES against the time between updates"),
    REPORT_OPTION(AT(report), "write one self-contained page"),
    JSON_OPTION(AT(json), "print as JSON"),
};

/* ---- the model ---- */

/* What a model does not state is not zero, and on a motion it is most of the errors. */
static void tell_unstated(const tune_work *w)
{
    char names[300] = "";
    size_t used = 0;
    for (size_t i = 0; i < w->unstated.count && used < sizeof names; i++)
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", used > 0 ? ", " : "",
                                 w->unstated.term[i].text);
    if (used > 0)
        command_warn("unstated",
                     "%s does not state %s: here that is zero, and the noise found is too small if "
                     "the unit has it. --assume-class own takes typical values",
                     w->name[0], names);
}

static int open_model(tune_work *w)
{
    int code = command_model(w->name[0], w->model, NULL);
    for (int sensor = 0; code < 0 && sensor < 2; sensor++)
        if (!imk_model_triad(w->model, sensor)->present)
            code = command_failed("%s has no %s: a filter of attitude, velocity and position needs "
                                  "gyros and accelerometers",
                                  w->name[0], sensor == IMK_GYRO ? "gyros" : "accelerometers");
    if (code < 0)
        imk_tune_model_unstated(w->model, &w->unstated);
    if (code < 0)
        code = term_selection_apply(&w->o->terms, w->model);
    if (code < 0 && w->o->assume_class)
        imk_model_assume_class(w->model, options_assumed_class(w->o->assume_class), &w->assumed);
    return code;
}

/* ---- the numbers as a file ---- */

static imk_filter_answer_kind answer_of(const tune_options *o)
{
    static const imk_filter_answer_kind kinds[4] = {IMK_FILTER_SAFE, IMK_FILTER_FIT,
                                                    IMK_FILTER_SAFE_SCALED, IMK_FILTER_FIT_SCALED};
    return kinds[o->answer];
}

static int write_parameters(const tune_work *w, const imk_model *made)
{
    const tune_options *o = w->o;
    imk_error error;
    imk_parameter_settings settings = imk_parameter_default();
    settings.format = (imk_parameter_format)o->format;
    settings.rate = w->settings.tuning.rate;
    settings.frame_rate = o->frame_rate;
    imk_parameter_notes *notes = command_zeroed(sizeof *notes);
    const imk_status status = imk_parameters_write(o->output, &settings, made, notes, &error);
    for (size_t i = 0; i < notes->count && status == IMK_OK; i++)
        if (notes->note[i].lost)
            command_warn("lost", "%s", notes->note[i].text);
        else
            command_note("assumed", "note: %s", notes->note[i].text);
    free(notes);
    return status == IMK_OK ? -1 : command_error(&error, NULL);
}

static int write_numbers(const tune_work *w)
{
    imk_error error;
    if (!w->o->output)
        return -1;
    imk_model *made = command_memory(NULL, sizeof *made);
    int code = -1;
    if (imk_tune_model_answer(w->r, answer_of(w->o), made, &error) != IMK_OK)
        code = command_error(&error, NULL);
    else if (w->o->format > 0)
        code = write_parameters(w, made);
    else if (imk_model_write(w->o->output, made, NULL, &error) != IMK_OK)
        code = command_error(&error, NULL);
    free(made);
    return code;
}

/* ---- showing ---- */

static int show(const tune_work *w)
{
    const tune_options *o = w->o;
    const imk_filter_tuning *tuning = w->r->tuning;
    char text[600];
    if (!o->assume_class)
        tell_unstated(w);
    for (size_t i = 0; i < tuning->omitted_count; i++)
        command_warn("left_out", "%s is left out of the prediction", tuning->omitted[i]);
    imk_tune_verdict(w->r, text, sizeof text);
    if (*text)
        command_warn("inconstant", "%s", text);
    const int code = write_numbers(w);
    if (code >= 0)
        return code;
    imk_result *result = show_begin("tune");
    imk_show_tune(w->r, &w->assumed, result);
    imk_result_for(result, IMK_FOR_TERMINAL);
    if (!o->output)
        imk_result_line(result, "\nNext: write the numbers for a program with --to FORMAT -o FILE");
    imk_result_for(result, IMK_FOR_PAGE);
    show_model(result, w->name[0], w->model);
    show_origin(result);
    return show_end(result, &(show_options){.report = o->report, .plot = o->plot, .json = o->json},
                    EXIT_DONE);
}

static int tune(tune_work *w)
{
    imk_error error;
    threaded_job job;
    threaded_job_begin(&job, w->name[0], campaign_threads(w->o->threads.value));
    const imk_status status =
        imk_tune_model_run(w->model, w->name[0], &w->settings, &job.job, &w->r, &error);
    threaded_job_end(&job);
    int code = status == IMK_OK ? -1 : tune_refuse(w, &error);
    if (code < 0)
        code = show(w);
    imk_tune_model_free(w->r);
    return code;
}

static int check(const tune_options *o)
{
    int code = command_check_plot(o->plot);
    if (code < 0 && !o->output && (o->format > 0 || o->answer > 0 || o->frame_rate > 0))
        code = command_misused("--to, --answer and --frame-rate are for the file of -o FILE; add "
                               "that option");
    if (code < 0 && o->json && o->output && strcmp(o->output, "-") == 0)
        code = command_misused("--json and the file would both go to standard output");
    return code;
}

static int run(int count, char **words)
{
    const double missing = (double)NAN;
    tune_options o = {.rate = missing,
                      .latitude = missing,
                      .bias_time = missing,
                      .bias = {missing, missing},
                      .seed = {.value = 1}};
    tune_work w = {.o = &o};
    int code = options_parse(&tune_verb, count, words, &o, w.name);
    if (code < 0)
        code = check(&o);
    if (code >= 0)
        return code;
    w.model = command_memory(NULL, sizeof *w.model);
    code = open_model(&w);
    if (code < 0)
        code = tune_scene_open(&w);
    if (code < 0)
        code = tune(&w);
    tune_scene_free(&w);
    free(w.model);
    return code < 0 ? EXIT_DONE : code;
}

const verb tune_verb = {
    .name = "tune",
    .summary = "noise parameters that make a Kalman filter consistent on a motion",
    .operands = "MODEL MOTION...",
    .operands_minimum = 2,
    .operands_maximum = TUNE_OPERANDS,
    .examples = {{"imukit tune unit.yaml walk.yaml",
                  "by how much the noise of the data sheet must be multiplied for this motion"},
                 {"imukit tune unit.yaml walk.yaml drive.csv --to kalibr -o imu.yaml",
                  "for both motions; the safe numbers as a file of kalibr"}},
    .description =
        "MODEL is a model file or a name from `imukit devices`; a MOTION is a motion script, a "
        "table of poses, or recorded rates and forces of the platform.\n\nA filter adds noise for "
        "all errors of its sensor, and most of them are no noise: scale factors, misalignments, "
        "vibration. The errors of attitude, velocity and position over times between two updates "
        "are computed from the model on the motion, and the noise is chosen so that the filter's "
        "covariance is theirs in the mean (fit), or nowhere less than theirs (safe). The bias is "
        "known when a time begins.\n\nNEES is the mean square of the errors in units of the "
        "filter's covariance: 1 is consistent, 4 means errors twice as large as the filter "
        "believes.",
    .groups = {OPTION_GROUP("Filter", tune_option_table, 0),
               {"Terms", TERM_OPTIONS, term_options, AT(terms)},
               OPTION_GROUP("Runs and output", output_option_table, 0)},
    .run = run};
