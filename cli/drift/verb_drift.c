/* SPDX-License-Identifier: Apache-2.0 */
/* imukit drift: how large the error of a navigator becomes, which terms cause it, and how small
 * they must be. */
#include "campaign/campaign_run.h"
#include "drift_parts.h"
#include "shell/job_progress.h"

#include "imukit/model_file.h"
#include "imukit/names.h"
#include "imukit/show.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define AT(field) offsetof(drift_options, field)

static const option navigation_option_table[] = {
    {"duration", OPTION_QUANTITY, AT(duration), .letter = 'd', .value = "TIME", .unit = "s",
     .help =
         "length of the navigation; default: 24h, with --motion its length, with --want its time"},
    {"times", OPTION_TEXT, AT(times), .value = "TIMES",
     .help = "times to show instead, such as \"1min, 10min, 1h\""},
    {"aligned", OPTION_CHOICE, AT(aligned), .value = "HOW", .choices = "given|self",
     .help = "given (the default): the attitude at the start is true except for "
             "--initial-attitude; self: the unit finds it at rest from its own readings"},
    {"align-time", OPTION_QUANTITY, AT(align_time), .value = "TIME", .unit = "s",
     .help = "length of the alignment of --aligned self; default 300s"},
    {"initial-attitude", OPTION_TEXT, AT(initial_attitude), .value = "ANGLES",
     .help = "1 sigma of the attitude error at the start: \"0.05 deg\", or about north, east and "
             "down, \"0.01 0.01 0.1 deg\"; default 0"},
    {"initial-velocity", OPTION_TEXT, AT(initial_velocity), .value = "SPEEDS",
     .help = "1 sigma of the velocity error at the start, such as \"0.1 m/s\"; default 0"},
    {"initial-position", OPTION_TEXT, AT(initial_position), .value = "LENGTHS",
     .help = "1 sigma of the position error at the start, such as \"10 m\"; default 0"},
    {"vertical", OPTION_CHOICE, AT(vertical), .value = "HOW", .choices = "slaved|free",
     .help = "slaved (the default): height follows the truth, as with a barometer; free: it grows "
             "without bound"},
    {"attitude-errors", OPTION_CHOICE, AT(attitude_errors), .value = "WHICH",
     .choices = "local|earth",
     .help = "local (the default): of what is displayed, tilt and heading relative to the local "
             "level at the computed position (beyond 89 deg of latitude the grid heading); earth: "
             "against Earth-fixed axes; --initial-attitude is meant in the same way"},
    {"gravity-deflection", OPTION_QUANTITY, AT(deflection), .value = "SIGMA", .unit = "m/s^2",
     .help = "1 sigma of what gravity has beside normal gravity, north and east each, such as "
             "\"30 ug\"; default 0"},
    {"gravity-distance", OPTION_QUANTITY, AT(deflection_distance), .value = "LENGTH", .unit = "m",
     .help = "its correlation distance along the ground; default 20km"},
    {"compensated", OPTION_FLAG, AT(compensated),
     .help = "show also the figures after calibration: known values of the model are taken out, "
             "and their uncertainty stays"},
    ASSUME_CLASS_OPTION(AT(assume_class)),
    {"want", OPTION_TEXT, AT(want), .value = "REQUIREMENT",
     .help = "the inverse question, such as \"CEP 1 nmi @ 1h\": how small each term must be, and "
             "which devices meet this; also R95, DRMS, height, velocity, tilt, heading; with --aid "
             "\"CEP 5 m after 60 s\", from the end of the aids on"},
};

static const option place_option_table[] = {
    {"motion", OPTION_FILE, AT(motion), .letter = 'm', .value = "MOTION",
     .help = "a motion script (.yaml) or a table of poses; default: at rest, as stated by the "
             "options below"},
    {"rate", OPTION_QUANTITY, AT(rate), .letter = 'r', .value = "RATE", .unit = "Hz",
     .help = "sampling rate; default 100Hz"},
    LATITUDE_OPTION(AT(latitude), "geodetic latitude; default 45deg"),
    HEIGHT_OPTION(AT(height)),
    TURN_OPTION("roll", AT(roll), "roll; default 0deg: level"),
    TURN_OPTION("pitch", AT(pitch), "pitch; default 0deg: level"),
    TURN_OPTION("yaw", AT(yaw), "heading, from north to east; default 0deg"),
};

static const option aid_option_table[] = {
    {"aid", OPTION_TEXTS, AT(aid), .value = "AID",
     .help =
         "an aid of the navigator, such as \"gnss position 1 m, velocity 0.05 m/s at 1 Hz until "
         "600 s\"; also height, heading, odometer, zero velocity; correlated 60 s; lever arm 1 0 "
         "-2 ± 0.05 m; may be given several times"},
    {"outage", OPTION_TEXT, AT(outage), .value = "TIMES",
     .help = "times after the end of the aids to show, such as \"60s, 300s\"; default 10s, 60s, "
             "300s"},
    {"filter-model", OPTION_FILE, AT(filter_model), .value = "MODEL",
     .help = "the model that the navigator's filter is made for; default: that of the unit, with "
             "all of "
             "its terms, whatever --only and --without leave out"},
    {"gains", OPTION_CHOICE, AT(gains), .value = "HOW", .choices = "held|retuned",
     .help =
         "of --want: held (the default): the filter keeps its gains when terms improve; retuned: "
         "it is made anew for the improved terms"},
};

static const option output_option_table[] = {
    {"monte-carlo", OPTION_INTEGER, AT(monte_carlo), .letter = 'n', .value = "N",
     .choices = "1-4294967295", .help = "also simulate and navigate N runs, without linearising"},
    SEED_OPTION(AT(seed),
                "seed of the runs: the same seed makes the same bytes on every machine; default 1"),
    {"shard", OPTION_TEXT, AT(shard), .value = "I/N",
     .help = "compute only part I of N of the runs, for imukit merge; needs -o PART.h5"},
    THREADS_OPTION(AT(threads),
                   "threads to use; default: all processors. The results do not depend on it"),
    {"output", OPTION_OUTPUT, AT(output), .letter = 'o', .value = "FILE",
     .help = "with --monte-carlo: every run (.h5, or .csv, .csv.gz, .csv.zst); the same command "
             "continues an interrupted campaign. Otherwise: figures and terms against time (.csv)"},
    PLOT_OPTION(AT(plot), "draw the growth and the shares of the terms"),
    REPORT_OPTION(AT(report), "write one self-contained page"),
    JSON_OPTION(AT(json), "print as JSON"),
};

/* ---- checks ---- */

static bool is_csv(const char *path)
{
    return imk_has_ending(path, ".csv") || imk_has_ending(path, ".csv.gz") ||
           imk_has_ending(path, ".csv.zst");
}

static int check_runs(const drift_options *o, size_t models)
{
    if (models > 1)
        return command_misused("--monte-carlo takes one model at a time");
    if (o->shard && !o->output)
        return command_misused("--shard makes a part for imukit merge: add -o PART.h5");
    if (o->output && !is_csv(o->output) && command_is_stream(o->output))
        return command_misused("-o %s: the runs are kept in a file beside the results while they "
                               "are computed; give a name ending in .csv or .h5",
                               o->output);
    if (o->output && !imk_has_ending(o->output, ".h5") && !is_csv(o->output))
        return command_misused("-o %s: expected a name ending in .h5, .csv, .csv.gz or .csv.zst",
                               o->output);
    return -1;
}

static int check(const drift_options *o, bool runs, size_t models)
{
    int code = command_check_plot(o->plot);
    if (code < 0 && runs)
        code = check_runs(o, models);
    if (code >= 0)
        return code;
    if (!runs && o->shard)
        return command_misused("--shard selects a part of --monte-carlo N; add that option");
    if (!runs && o->output && !is_csv(o->output) && !command_is_stream(o->output))
        return command_misused("-o %s: figures against time are written as .csv; %s is for runs: "
                               "add --monte-carlo 1000",
                               o->output,
                               imk_has_ending(o->output, ".h5") ? ".h5" : "a results file");
    if (o->want && models > 1)
        return command_misused("--want takes one model at a time");
    return -1;
}

/* ---- doing it ---- */

/* Models, where the errors are of, and what they make. */
typedef struct work {
    const drift_options *o;
    size_t count;
    imk_model *model[IMK_DRIFT_MODELS_MAX];
    imk_model *whole[IMK_DRIFT_MODELS_MAX]; /* before --only and --without; NULL without them */
    imk_unstated assumed[IMK_DRIFT_MODELS_MAX];
    const char *name[IMK_DRIFT_MODELS_MAX + 1];
    drift_scene scene;
    imk_drift_models *r;
} work;

/* What a term does alone is asked of a filter that knows of all of them. */
static void keep_whole(work *w, size_t m)
{
    const drift_options *o = w->o;
    if (!o->terms.only && !o->terms.without)
        return;
    w->whole[m] = command_memory(NULL, sizeof *w->whole[m]);
    *w->whole[m] = *w->model[m];
    if (o->assume_class)
        imk_model_assume_class(w->whole[m], options_assumed_class(o->assume_class), NULL);
    (void)imk_model_complete(w->whole[m]);
}

static int open_models(work *w)
{
    int code = -1;
    for (size_t m = 0; w->name[m] && code < 0; m++) {
        w->model[m] = command_memory(NULL, sizeof *w->model[m]);
        w->count = m + 1;
        code = command_model(w->name[m], w->model[m], NULL);
        if (code < 0)
            keep_whole(w, m);
        if (code < 0)
            code = term_selection_apply(&w->o->terms, w->model[m]);
        if (code < 0 && w->o->assume_class)
            imk_model_assume_class(w->model[m], options_assumed_class(w->o->assume_class),
                                   &w->assumed[m]);
        const int added = code < 0 ? imk_model_complete(w->model[m]) : -1;
        if (added >= 0)
            command_note(
                "completed",
                "%s has no %s: perfect ones are taken, so that all errors are those of its "
                "%s; imukit join %s MODEL -o UNIT.yaml adds those of another model",
                w->name[m], added == IMK_GYRO ? "gyros" : "accelerometers",
                added == IMK_GYRO ? "accelerometers" : "gyros", w->name[m]);
    }
    return code;
}

/* A requirement that can be typed: half of the present figure, at a time of the table. */
static void show_requirement(const imk_drift_models *r, imk_result *result)
{
    char length[IMK_READABLE_SIZE];
    const imk_drift_case *one = &r->cases[r->case_count - 1];
    const imk_drift_figures *f = &one->figures[one->time];
    const double at = r->times->time[one->time], outage = imk_drift_outage(&r->settings.drift);
    const bool after = at > outage; /* not without an outage */
    const double time = after ? at - outage : at, hours = time / 3600, minutes = time / 60;
    const bool whole_hours = hours == floor(hours), whole_minutes = minutes == floor(minutes);
    if (!(f->cep > 0) || imk_drift_validity_of(f) == IMK_DRIFT_LOST)
        return;
    imk_result_line(result,
                    "\nNext, to see what would halve the error: %s --want \"CEP %s %s %.8g%s\"",
                    command_line(), imk_readable_figure(IMK_REQUIRED_CEP, 0.5 * f->cep, length),
                    after ? "after" : "@",
                    whole_hours     ? hours
                    : whole_minutes ? minutes
                                    : time,
                    whole_hours     ? "h"
                    : whole_minutes ? "min"
                                    : "s");
}

/* The last model as data, for the values of its terms. */
static imk_result *model_data(const work *w)
{
    char *text = NULL;
    size_t size;
    imk_result *model = imk_result_create(NULL);
    if (command_unless_memory(
            imk_model_print_json(w->model[w->count - 1], NULL, &text, &size, NULL)) == IMK_OK)
        (void)imk_result_json(model, "model", text);
    free(text);
    return model;
}

static int show(const work *w)
{
    const drift_options *o = w->o;
    const imk_drift_models *r = w->r;
    imk_result *result = show_begin("drift"), *model = r->answer ? model_data(w) : NULL;
    const imk_drift_shown shown = {w->scene.motion ? o->motion : NULL,  o->seed.value,
                                   imk_drift_verdict(r, result),        model,
                                   o->assume_class ? w->assumed : NULL, o->filter_model};
    for (size_t i = 0; i < shown.verdict.count; i++)
        command_warn(shown.verdict.message[i].code, "%s", shown.verdict.message[i].text);
    const int code = o->output && !r->found ? drift_write_csv(r, o->output) : -1;
    if (code >= 0) {
        imk_result_free(result);
        imk_result_free(model);
        return code;
    }
    imk_show_drift(r, &shown, result);
    imk_result_free(model);
    imk_result_for(result, IMK_FOR_TERMINAL);
    if (w->count == 1 && !r->answer && !r->found)
        show_requirement(r, result);
    else if (w->count == 1 && !r->answer && !o->output)
        imk_result_line(result, "\nNext: keep the runs with -o RESULTS.h5");
    if (o->aid.count && w->scene.settings.alignment == IMK_ALIGNED_GIVEN && !o->initial_position &&
        !o->initial_velocity && !o->initial_attitude)
        imk_result_line(result, "\nThe navigator starts without error; --initial-attitude "
                                "\"0.5 0.5 5 deg\" (1 sigma) gives it one.");
    imk_result_for(result, IMK_FOR_PAGE);
    for (size_t m = 0; m < w->count; m++)
        show_model(result, w->name[m], w->model[m]);
    show_origin(result);
    return show_end(result, &(show_options){.report = o->report, .plot = o->plot, .json = o->json},
                    EXIT_DONE);
}

/* A part of a campaign has no figures worth showing: print the next step instead. */
static int show_shard(const work *w)
{
    const drift_options *o = w->o;
    imk_result *result = show_begin("drift");
    imk_result_object(result, "inputs");
    imk_result_text(result, "model", w->name[0]);
    imk_result_count(result, "seed", (long long)o->seed.value);
    imk_result_text(result, "shard", o->shard);
    imk_result_end(result);
    imk_result_object(result, "result");
    imk_result_judge(result, IMK_USABLE_WITH_CARE,
                     "Usable with care, as part %s of a campaign: %s has %llu runs.", o->shard,
                     o->output, (unsigned long long)w->r->run_count);
    imk_result_text(result, "output", o->output);
    imk_result_count(result, "runs", (long long)w->r->run_count);
    imk_result_end(result);
    imk_result_line(result, "Next, with all parts: imukit merge PART.h5... -o WHOLE.h5");
    return show_end(result, &(show_options){.json = o->json}, EXIT_DONE);
}

/* A message about the model names it; one about the settings does not. */
static int refuse(const work *w, const imk_error *error)
{
    const bool of_model = strncmp(error->field, "gyro", 4) == 0 ||
                          strncmp(error->field, "accel", 5) == 0 ||
                          strncmp(error->field, "timing", 6) == 0;
    return command_error(error, of_model && w->r ? w->r->cases[w->r->case_count - 1].name : NULL);
}

static int drift(work *w)
{
    const drift_options *o = w->o;
    const drift_scene *scene = &w->scene;
    const imk_model *models[IMK_DRIFT_MODELS_MAX], *whole[IMK_DRIFT_MODELS_MAX];
    imk_error error;
    threaded_job t;
    threaded_job_begin(&t, NULL, campaign_threads(o->threads.value));
    imk_drift_models_settings settings = imk_drift_models_default();
    settings.drift = scene->settings;
    settings.calibrated = o->compensated;
    settings.want = scene->want;
    settings.assume = o->assume_class > 0;
    settings.assumed_class = options_assumed_class(o->assume_class);
    settings.want.retuned = o->gains == 1;
    for (size_t m = 0; m < w->count; m++) {
        models[m] = w->model[m];
        whole[m] = w->whole[m];
    }
    if (w->whole[0])
        settings.filter_models = whole;
    const imk_status status = imk_drift_models_run(w->count, models, w->name, &scene->times,
                                                   &settings, &t.job, &w->r, &error);
    threaded_job_end(&t);
    int code = status == IMK_OK ? -1 : refuse(w, &error);
    if (code < 0 && o->monte_carlo.given)
        code = drift_runs(o, scene, w->r);
    if (code < 0 && o->shard)
        code = show_shard(w);
    else if (code < 0)
        code = show(w);
    imk_drift_models_free(w->r);
    return code;
}

static int run(int count, char **words)
{
    const double missing = (double)NAN;
    drift_options o = {.duration = missing,
                       .rate = missing,
                       .align_time = missing,
                       .latitude = missing,
                       .deflection_distance = missing,
                       .seed = {.value = 1}};
    work w = {.o = &o};
    int code = options_parse(&drift_verb, count, words, &o, w.name);
    if (code >= 0)
        return code;
    const bool runs = o.monte_carlo.given;
    size_t models = 0;
    while (w.name[models])
        models++;
    code = check(&o, runs, models);
    if (code >= 0)
        return code;
    for (size_t m = 0; m < models && models > 1; m++)
        if (imk_has_ending(w.name[m], ".h5"))
            return command_misused("%s: a results file is shown alone; combine several parts of a "
                                   "campaign with imukit merge",
                                   w.name[m]);
    if (models == 1 && imk_has_ending(w.name[0], ".h5"))
        return runs ? command_misused(
                          "%s contains runs that exist already; leave --monte-carlo out", w.name[0])
                    : drift_results(&o, w.name[0]);
    code = open_models(&w);
    if (code < 0)
        code = drift_scene_open(&o, &w.scene);
    if (code < 0)
        code = drift(&w);
    for (size_t m = 0; m < w.count; m++) {
        free(w.model[m]);
        free(w.whole[m]);
    }
    drift_scene_free(&w.scene);
    return code < 0 ? EXIT_DONE : code;
}

const verb drift_verb = {
    .name = "drift",
    .summary = "position error after a minute, an hour, a day, and the terms that cause it",
    .operands = "MODEL... | RESULTS.h5",
    .operands_minimum = 1,
    .operands_maximum = IMK_DRIFT_MODELS_MAX,
    .examples =
        {{"imukit drift tactical --duration 1h --monte-carlo 100",
          "error growth of a class by covariance, with the budget of its terms, beside a hundred "
          "simulated runs"},
         {"imukit drift model.yaml --aligned self --want \"CEP 1 nmi @ 1h\" --report drift.html",
          "how small each term must be for one mile in an hour, and which devices meet this"}},
    .description =
        "MODEL is a model file or a name from `imukit devices`; several are compared. The unit "
        "navigates by itself, at rest or on a motion, and the figures state its error: CEP is the "
        "radius of the circle that holds half of all outcomes, R95 the radius for 95 % of "
        "them.\n\nKnown values of the model (bias.fixed, misalignment) shift every run by the same "
        "amount; terms with only a known size (repeatability, noise) scatter. The covariance is "
        "linear: ~ marks figures for which attitude errors are too large.\n\nRESULTS.h5 is a file "
        "from --monte-carlo or imukit merge; its statistics are printed.",
    .groups = {OPTION_GROUP("Navigation", navigation_option_table, 0),
               {"Terms", TERM_OPTIONS, term_options, AT(terms)},
               OPTION_GROUP("Motion and place", place_option_table, 0),
               OPTION_GROUP("Aids", aid_option_table, 0),
               OPTION_GROUP("Runs and output", output_option_table, 0)},
    .run = run};
