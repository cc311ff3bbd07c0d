/* SPDX-License-Identifier: Apache-2.0 */
/* imukit navigate: a log -> where the unit went, or what it drifts when it went nowhere. */
#include "navigate_parts.h"

#include <math.h>
#include <stdlib.h>

static const option navigate_option_table[] = {
    {"position", 'p', OPTION_TEXT, "POSITION", NULL, NULL,
     "latitude, longitude and height above the ellipsoid at the start, such as \"34.25 deg, 108.91 "
     "deg, 380 m\"",
     offsetof(navigate_options, position)},
    {"align", 0, OPTION_QUANTITY, "TIME", "s", NULL,
     "how long the unit stands at the start, to find its attitude by itself",
     offsetof(navigate_options, align)},
    {"align-method", 0, OPTION_CHOICE, "CHOICE", NULL, "means|inertial|fine",
     "from the means of force and rate (the default for gyros that read more than 1.5 times the "
     "Earth's rotation); from gravity's turn in inertial axes (the default for others: the unit "
     "may rock); the same and an estimate of the rest",
     offsetof(navigate_options, method)},
    {"heading", 0, OPTION_TEXT, "ANGLE", NULL, NULL,
     "azimuth of body x at the start, for gyros that cannot find north, such as \"30 +- 1 deg\"",
     offsetof(navigate_options, heading)},
    {"attitude", 0, OPTION_TEXT, "ANGLES", NULL, NULL,
     "roll, pitch and yaw at the start instead of --align, such as \"0.5 -1.2 90 +- 0.1 deg\"",
     offsetof(navigate_options, attitude)},
    {"model", 'm', OPTION_FILE, "MODEL", NULL, NULL,
     "errors of the sensors, a file or a name from imukit devices: predicts the error, and weighs "
     "updates",
     offsetof(navigate_options, model)},
    {"zero-velocity", 0, OPTION_TEXT, "auto|TIME", NULL, NULL,
     "correct by standing still: whenever it is seen to, or known to at the end of each TIME, such "
     "as 60s",
     offsetof(navigate_options, zero_velocity)},
    {"stop", 0, OPTION_QUANTITY, "TIME", "s", NULL,
     "length of the stops that --zero-velocity TIME knows of; default 5s",
     offsetof(navigate_options, stop)},
    {"still-velocity", 0, OPTION_QUANTITY, "VELOCITY", "m/s", NULL,
     "1 sigma of what moves in a unit that stands; default 0.01m/s",
     offsetof(navigate_options, still_velocity)},
    {"still-rotation", 0, OPTION_QUANTITY, "RATE", "deg/h", NULL,
     "use that a standing unit does not turn either, to this 1 sigma of the mean rate over a "
     "stand; "
     "default: not used",
     offsetof(navigate_options, still_rotation)},
    {"vertical", 0, OPTION_CHOICE, "CHOICE", NULL, "slaved|free",
     "height held as at the start (the default), or free: it then runs away within minutes",
     offsetof(navigate_options, vertical)},
    {"coning", 0, OPTION_INTEGER, "N", NULL, "1-4",
     "samples that coning and sculling are computed from, 1 to 4; default 3",
     offsetof(navigate_options, samples)},
    {"standard-gravity", 0, OPTION_QUANTITY, "G", "m/s^2", NULL,
     "what g stands for in accelerometer columns in g, mg or ug; default 9.80665m/s^2",
     offsetof(navigate_options, standard_gravity)},
    {"gravity-free", 0, OPTION_FLAG, NULL, NULL, NULL,
     "put the acceleration relative to the Earth into the track: mean since the row before; north, "
     "east, down",
     offsetof(navigate_options, gravity_free)},
    {"interval", 0, OPTION_QUANTITY, "TIME", "s", NULL, "between rows of the track; default 1s",
     offsetof(navigate_options, interval)},
    {"output", 'o', OPTION_OUTPUT, "TRACK", NULL, NULL,
     "write the track: .csv (also .gz, .zst) or .npy; - is standard output",
     offsetof(navigate_options, output)},
    {"plot", 0, OPTION_OUTPUT, "FILE.svg|.png|.pdf|term", NULL, NULL,
     "draw the track, and the way from the start against time", offsetof(navigate_options, plot)},
    {"report", 0, OPTION_OUTPUT, "FILE.html", NULL, NULL, "write one self-contained page",
     offsetof(navigate_options, report)},
    {"json", 0, OPTION_FLAG, NULL, NULL, NULL, "print the summary as JSON",
     offsetof(navigate_options, json)},
    {"strict", 0, OPTION_FLAG, NULL, NULL, NULL, "exit with 1 when there is a warning",
     offsetof(navigate_options, strict)},
};

static int run(int count, char **words);

const verb navigate_verb = {
    .name = "navigate",
    .summary = "log + place -> attitude, velocity and position, and their drift",
    .operands = "LOG",
    .operands_minimum = 1,
    .operands_maximum = 1,
    .examples = {{"imukit navigate parked.csv --position \"34.25 deg, 108.91 deg, 380 m\" --align "
                  "300s --model unit.yaml --report parked.html",
                  "a unit that stands: its drift, beside what its model predicts"},
                 {"imukit navigate drive.csv --position \"48.1 deg, 11.6 deg, 520 m\" --align 2min "
                  "--model tactical --zero-velocity auto -o track.csv",
                  "a drive with stops, each of which corrects"}},
    .description =
        "LOG is CSV (also .gz, .zst) or .npy with three gyros and three accelerometers, as rates "
        "or increments; - is standard input. A strapdown mechanisation on the WGS84 ellipsoid "
        "integrates it from --position on. Nothing but --zero-velocity corrects it, so its error "
        "grows.\n\nWith --model the error is predicted by covariance, alignment included. Errors "
        "that the model knows are not taken out here: imukit compensate does that first.\n\n"
        "Where the unit stands still all the time, the distance from the start is the error.",
    .groups = {{"Options", sizeof navigate_option_table / sizeof navigate_option_table[0],
                navigate_option_table, 0},
               {"Reading the log", LOG_INPUT_OPTIONS, log_input_options,
                offsetof(navigate_options, log)}},
    .run = run};

static bool is_known(const imk_axes *axes, int count)
{
    for (int i = 0; i < count; i++)
        if (axes->value[i] != 0.0)
            return true;
    return false;
}

/* What a model knows is for imukit compensate. */
static void warn_of_model(const navigation *n)
{
    if (!n->has_model || n->model->residual_of[0])
        return;
    const imk_triad *triad[2] = {&n->model->gyro, &n->model->accel};
    for (int sensor = 0; sensor < 2; sensor++)
        if (is_known(&triad[sensor]->bias.fixed, triad[sensor]->axis_count) ||
            is_known(&triad[sensor]->scale_factor.fixed, triad[sensor]->axis_count)) {
            command_warn("compensate_first",
                         "%s knows fixed errors of the %ss: the log is taken for one from which "
                         "they are gone already (imukit compensate)",
                         n->options->model, sensor == 0 ? "gyro" : "accelerometer");
            return;
        }
}

static int show(const navigation *n)
{
    const navigate_options *o = n->options;
    const bool warned = command_warning_count() > 0;
    const int code = o->output ? navigate_write_track(n, o->output) : -1;
    if (code >= 0)
        return code;
    imk_result *result = show_begin("navigate");
    navigate_show(n, warned, result);
    return show_end(result, &(show_options){.report = o->report, .plot = o->plot, .json = o->json},
                    o->strict && warned ? EXIT_FAILED : EXIT_DONE);
}

static int navigate(navigation *n)
{
    int code = navigate_parse(n);
    if (code < 0)
        code = navigate_load(n);
    if (code >= 0)
        return code;
    code = navigate_check(n);
    if (code < 0)
        code = navigate_align(n);
    if (code < 0) {
        warn_of_model(n);
        code = navigate_run(n);
    }
    if (code < 0)
        code = show(n);
    navigate_free(n);
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
                          .samples = {.value = 3},
                          .method = -1};
    const char *operands[OPERANDS_MAX];
    int code = options_parse(&navigate_verb, count, words, &o, operands);
    if (code < 0)
        code = command_check_plot(o.plot);
    if (code >= 0)
        return code;
    imk_model *model = command_memory(NULL, sizeof *model);
    navigation *n = command_zeroed(sizeof *n);
    n->options = &o;
    n->path = operands[0];
    n->model = model;
    code = navigate(n);
    free(model);
    free(n);
    return code;
}
