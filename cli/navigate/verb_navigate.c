/* SPDX-License-Identifier: Apache-2.0 */
/* imukit navigate: a log -> the track of the unit, or its drift if it was at rest. */
#include "navigate_parts.h"
#include "shell/job_progress.h"
#include "shell/show.h"

#include "imukit/show.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define AT(field) offsetof(navigate_options, field)

static const option navigate_option_table[] = {
    {"position", OPTION_TEXT, AT(position), .letter = 'p', .value = "POSITION",
     .help = "latitude, longitude and height above the ellipsoid at the start, such as \"34.25 "
             "deg, 108.91 deg, 380 m\""},
    {"align", OPTION_QUANTITY, AT(align), .value = "TIME", .unit = "s",
     .help = "time at rest at the start, in which the unit finds its attitude"},
    {"align-method", OPTION_CHOICE, AT(method), .value = "CHOICE", .choices = "means|inertial|fine",
     .help =
         "means: from the mean force and rate (the default for gyros that read more than 1.5 "
         "times the Earth's rotation, or that the --model says cannot find north to 11 deg); "
         "inertial: from the turn of gravity in inertial axes (the default for other gyros; the "
         "unit may rock); fine: inertial, then an estimate of the remaining errors"},
    {"heading", OPTION_TEXT, AT(heading), .value = "ANGLE",
     .help = "azimuth of body x at the start, for gyros that cannot find north, such as \"30 +- 1 "
             "deg\""},
    {"attitude", OPTION_TEXT, AT(attitude), .value = "ANGLES",
     .help =
         "roll, pitch and yaw at the start instead of --align, such as \"0.5 -1.2 90 +- 0.1 deg\""},
    {"velocity", OPTION_TEXT, AT(velocity), .value = "VELOCITY",
     .help =
         "velocity at the start with --attitude, north, east and down, such as \"20 -3 0 +- 0.1 "
         "m/s\"; default 0"},
    {"position-sigma", OPTION_TEXT, AT(position_sigma), .value = "SIGMA",
     .help = "1 sigma of --position: one value, or north, east and down, such as \"2 2 5 m\"; "
             "default 0"},
    {"model", OPTION_FILE, AT(model), .letter = 'm', .value = "MODEL",
     .help = "error model of the sensors, a file or a name from imukit devices: it predicts the "
             "error and weighs updates"},
    {"zero-velocity", OPTION_TEXT, AT(zero_velocity), .value = "auto|TIME",
     .help = "correct the error while the unit is at rest: auto detects this in the log; TIME, "
             "such as 60s, means a stop at the end of each TIME"},
    {"stop", OPTION_QUANTITY, AT(stop), .value = "TIME", .unit = "s",
     .help = "length of the stops of --zero-velocity TIME; default 5s"},
    {"still-velocity", OPTION_QUANTITY, AT(still_velocity), .value = "VELOCITY", .unit = "m/s",
     .help = "1 sigma of the velocity of a unit at rest; default 0.01m/s"},
    {"still-rotation", OPTION_QUANTITY, AT(still_rotation), .value = "RATE", .unit = "deg/h",
     .help = "use also that a unit at rest does not turn: RATE is the 1 sigma of its mean rate "
             "over a stop; default: not used"},
    {"vertical", OPTION_CHOICE, AT(vertical), .value = "CHOICE", .choices = "slaved|free",
     .help = "slaved (the default without --aid): the height stays as at the start; free (the "
             "default with --aid): the height diverges within minutes without an aid that measures "
             "it"},
    {"coning", OPTION_INTEGER, AT(samples), .value = "N", .choices = "1-4",
     .help = "number of samples from which coning and sculling are computed, 1 to 4; default 3"},
    {"standard-gravity", OPTION_QUANTITY, AT(standard_gravity), .value = "G", .unit = "m/s^2",
     .help = "value of g for accelerometer columns in g, mg or ug; default 9.80665m/s^2"},
    {"gravity-free", OPTION_FLAG, AT(gravity_free),
     .help = "add the acceleration relative to the Earth to the track: north, east, down; mean "
             "since the previous row"},
    {"smooth", OPTION_FLAG, AT(smooth),
     .help = "correct the track backwards, too: later readings and stops tell of earlier errors"},
    {"interval", OPTION_QUANTITY, AT(interval), .value = "TIME", .unit = "s",
     .help = "time between rows of the track; default 1s"},
    {"output", OPTION_OUTPUT, AT(output), .letter = 'o', .value = "TRACK",
     .help = "write the track: .csv (also .gz, .zst){ or written}; - is standard output"},
    PLOT_OPTION(AT(plot), "draw the track, and the displacement from the start against time"),
    REPORT_OPTION(AT(report), "write one self-contained page"),
    JSON_OPTION(AT(json), "print the summary as JSON"),
    STRICT_OPTION(AT(strict), "exit with 1 when there is a warning"),
};

static const option aid_option_table[] = {
    {"aid", OPTION_FILE, AT(aid), .value = "FILE",
     .help = "readings of position, velocity, heading, height or speed: a table with a time column "
             "on the clock of the log, which may be the log itself"},
    {"aid-sigma", OPTION_TEXT, AT(aid_sigma), .value = "SIGMAS",
     .help = "1 sigma of what is used of it, such as \"position 1 1 2 m, velocity 0.05 m/s\"; "
             "needed unless the table has columns of sigmas"},
    {"aid-map", OPTION_TEXT, AT(aid_map), .value = "NAMES",
     .help = "columns by the names that the table has for them, such as \"time=t "
             "[s],latitude=Lat [deg],longitude=Lon [deg]\""},
    {"aid-lever-arm", OPTION_TEXT, AT(aid_lever_arm), .value = "LENGTHS",
     .help = "from the unit to the antenna: forward, right, down, such as \"0.2 -0.5 -1.1 +- 0.02 "
             "m\"; default 0"},
    {"speed-lever-arm", OPTION_TEXT, AT(speed_lever_arm), .value = "LENGTHS",
     .help = "from the unit to the wheel or axle whose speed is read; default 0"},
    {"aid-delay", OPTION_QUANTITY, AT(aid_delay), .value = "TIME", .unit = "s",
     .help = "the readings are older by TIME than their times say; default 0s"},
    {"aid-interval", OPTION_QUANTITY, AT(aid_interval), .value = "TIME", .unit = "s",
     .help = "use at most one reading per TIME; default: all"},
    {"aid-until", OPTION_QUANTITY, AT(aid_until), .value = "TIME", .unit = "s",
     .help = "an outage: readings later than TIME from the start of the log are only compared"},
};

static int show(const imk_navigate_log *n, const navigate_options *o, const char *path)
{
    if (o->output) {
        imk_error error;
        imk_log_sink log = {.path = o->output, .fixed = true};
        const imk_record_sink sink = imk_log_sink_of(&log);
        const imk_status status = imk_navigate_log_track(n, &sink, &error);
        if (imk_log_sink_end(&log, status, &error) != IMK_OK)
            return command_error(&error, NULL);
    }
    imk_result *result = show_begin("navigate");
    imk_show_navigate_log(n, path, result);
    imk_result_for(result, IMK_FOR_TERMINAL);
    if (!o->model)
        imk_result_line(result, "Next: add --model MODEL for the error that the sensors' model "
                                "predicts (imukit identify, imukit devices)");
    imk_result_for(result, IMK_FOR_PAGE);
    show_origin(result);
    return show_end(result, &(show_options){.report = o->report, .plot = o->plot, .json = o->json},
                    o->strict && told_warnings() > 0 ? EXIT_FAILED : EXIT_DONE);
}

/* Failures that are not of the log alone. */
static int tell(const imk_navigate_log *n, const navigate_options *o, const char *path,
                imk_status status, const imk_error *error)
{
    static const struct {
        const char *code;
        bool named; /* begins with the path */
    } messages[] = {
        {"no_sensor_column", true}, {"align_whole", true}, {"pole", false}, {"rest_short", false}};
    const imk_findings none = {.count = 0}, *findings = n ? &n->findings : &none;
    const imk_finding *failure = status != IMK_OK ? imk_findings_failure(findings) : NULL;
    const bool of_aid = failure && strncmp(failure->code, "aid_", 4) == 0;
    char text[500];
    if (!failure)
        return log_input_tell(path, findings, status, error);
    log_input_tell(path, findings, IMK_OK, error);
    imk_finding_text(failure, text, sizeof text);
    if (strcmp(failure->code, "no_gravity_unit") == 0)
        return command_misused("--standard-gravity: no accelerometer column of %s is in g, mg or "
                               "ug",
                               path);
    for (size_t i = 0; i < sizeof messages / sizeof messages[0]; i++)
        if (strcmp(failure->code, messages[i].code) == 0)
            return command_failed_by(imk_finding_code(failure), error, path, "%s%s%s",
                                     messages[i].named ? path : "", messages[i].named ? " " : "",
                                     text);
    const bool of_model = strcmp(failure->code, "model_axes") == 0;
    const char *file = of_model ? o->model : of_aid ? o->aid : path;
    return command_failed_by(imk_finding_code(failure), error, file, "%s: %s", file, text);
}

/* The table of --aid. @return -1 or the exit code */
static int open_aid(const navigate_options *o, imk_log_reader **reader)
{
    imk_error error;
    imk_log_settings settings = imk_log_default();
    settings.any_columns = true;
    settings.map = o->aid_map;
    if (imk_log_open(o->aid, &settings, reader, &error) != IMK_OK)
        return command_log_error(&error, o->aid);
    return -1;
}

static int navigate(const navigate_options *o, const char *path,
                    imk_navigate_log_settings *settings)
{
    imk_log_reader *reader, *aid_reader = NULL;
    int code = log_input_check(&o->log);
    if (code < 0 && o->aid)
        code = open_aid(o, &aid_reader);
    if (code < 0)
        code = log_input_open(&o->log, path, false, &reader);
    if (code >= 0) {
        imk_log_close(aid_reader);
        return code;
    }
    imk_navigate_log *n;
    imk_error error;
    job_progress shown = job_progress_begin(path);
    const imk_job job = job_progress_job(&shown, NULL);
    const imk_record_source source = imk_log_source(reader);
    imk_record_source aids;
    if (aid_reader) {
        aids = imk_log_source(aid_reader);
        settings->aids = &aids;
    }
    const imk_status status = imk_navigate_log_run(&source, settings, &job, &n, &error);
    job_progress_end(&shown);
    imk_log_close(reader);
    imk_log_close(aid_reader);
    code = tell(n, o, path, status, &error);
    if (code < 0)
        code = show(n, o, path);
    imk_navigate_log_free(n);
    return code;
}

static int run(int count, char **words)
{
    navigate_options o = {.align = (double)NAN,
                          .stop = (double)NAN,
                          .still_velocity = 0.01,
                          .still_rotation = (double)NAN,
                          .interval = 1.0,
                          .standard_gravity = 9.80665,
                          .aid_delay = (double)NAN,
                          .aid_interval = (double)NAN,
                          .aid_until = (double)NAN,
                          .vertical = -1,
                          .samples = {.value = 3},
                          .method = -1};
    const char *operands[OPERANDS_MAX];
    int code = options_parse(&navigate_verb, count, words, &o, operands);
    if (code < 0)
        code = command_check_plot(o.plot);
    if (code >= 0)
        return code;
    imk_navigate_log_settings settings = imk_navigate_log_default();
    imk_model *model = command_memory(NULL, sizeof *model);
    code = navigate_parse(&o, model, &settings);
    if (code < 0)
        code = navigate(&o, operands[0], &settings);
    free(model);
    return code;
}

const verb navigate_verb = {
    .name = "navigate",
    .summary = "log + place -> attitude, velocity and position, and their drift",
    .operands = "LOG",
    .operands_minimum = 1,
    .operands_maximum = 1,
    .examples = {{"imukit navigate parked.csv --position \"34.25 deg, 108.91 deg, 380 m\" --align "
                  "300s --model unit.yaml --report parked.html",
                  "a unit at rest: its drift, beside the drift that its model predicts"},
                 {"imukit navigate drive.csv --position \"48.1 deg, 11.6 deg, 520 m\" --align 2min "
                  "--model tactical --aid gnss.csv --aid-sigma \"position 1 m, velocity 0.05 m/s\"",
                  "a drive with a GNSS receiver"}},
    .description =
        "LOG is CSV (also .gz, .zst){ or logs} with three gyros and three accelerometers, as rates "
        "or increments; - is standard input. A strapdown mechanisation on the WGS84 ellipsoid "
        "integrates the log from --position on. Only --zero-velocity and --aid correct the "
        "result, so without them the error grows.\n\nWith --model the error is predicted by "
        "covariance, "
        "alignment included. Known errors of the model are not taken out here: use imukit "
        "compensate first.\n\nIf the unit is at rest all the time, the distance from the start is "
        "the error.",
    .groups = {OPTION_GROUP("Options", navigate_option_table, 0),
               OPTION_GROUP("Aiding", aid_option_table, 0), LOG_INPUT_GROUP(AT(log))},
    .run = run};
