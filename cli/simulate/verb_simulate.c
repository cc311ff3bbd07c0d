/* SPDX-License-Identifier: Apache-2.0 */
/* imukit simulate: model + motion -> log, one run or many. */
#include "shell/file_clash.h"
#include "simulate_parts.h"

#include "imukit/model_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define AT(field) offsetof(simulate_options, field)

static const option simulate_option_table[] = {
    {"rate", OPTION_QUANTITY, AT(rate), .letter = 'r', .value = "RATE", .unit = "Hz",
     .help = "sampling rate, such as 100Hz; required unless a recorded motion has one"},
    {"duration", OPTION_QUANTITY, AT(duration), .letter = 'd', .value = "TIME", .unit = "s",
     .help = "length, such as 2h; default: the whole motion"},
    {"output", OPTION_OUTPUT, AT(output), .letter = 'o', .value = "LOG",
     .help = "where to write: .csv (also .gz, .zst){ or written}; - (the default) is standard "
             "output; a directory, DIR/, with --runs"},
    SEED_OPTION(AT(seed), "seed; the same seed makes the same bytes on every machine; default 1"),
    {"run", OPTION_INTEGER, AT(run), .value = "N", .choices = "0-4294967295",
     .help = "another run of the same sensor: other noise, other run-to-run biases; default 0"},
    {"runs", OPTION_INTEGER, AT(runs), .value = "N", .choices = "1-4294967295",
     .help = "number of runs, from --run on, written to DIR/run_000.csv and so on"},
    {"format", OPTION_TEXT, AT(format), .value = "EXTENSION",
     .help = "format of the logs of --runs: csv (default), csv.gz, csv.zst, npy, npz, mat, h5, "
             "bag, mcap or db3"},
    {"truth", OPTION_OUTPUT, AT(truth), .value = "FILE",
     .help = "write the true motion and the readings of perfect sensors, row by row"},
    {"aid", OPTION_TEXT, AT(aid), .value = "AIDS",
     .help = "write also what other instruments read of the motion, with their errors, such as "
             "\"position 1 1 2 m, velocity 0.05 m/s\" (1 sigma)"},
    {"aid-output", OPTION_OUTPUT, AT(aid_output), .value = "FILE",
     .help = "where the readings of --aid are written"},
    {"aid-rate", OPTION_QUANTITY, AT(aid_rate), .value = "RATE", .unit = "Hz",
     .choices = "1e-6..1e6", .help = "rate of the readings of --aid; default 1Hz"},
    {"aid-until", OPTION_QUANTITY, AT(aid_until), .value = "TIME", .unit = "s",
     .help = "time of the last reading; default: the end"},
    {"aid-lever-arm", OPTION_TEXT, AT(aid_lever_arm), .value = "LENGTHS",
     .help = "from the unit to the antenna: forward, right, down, such as \"0.2 -0.5 -1.1 m\"; "
             "default 0"},
    {"increments", OPTION_FLAG, AT(increments),
     .help = "write increments of angle and velocity (dtheta_x, dvel_x) instead of rates"},
    DECIMALS_OPTION(AT(decimals)),
    JSON_OPTION(AT(json), "print what was written as JSON; the log must go to a file"),
    {"gyro-unit", OPTION_UNIT, AT(gyro_unit), .value = "UNIT",
     .help = "unit of the gyro columns; default deg/s, or deg for increments"},
    {"accel-unit", OPTION_UNIT, AT(accel_unit), .value = "UNIT",
     .help = "unit of the accelerometer columns; default m/s^2, or m/s for increments"},
    THREADS_OPTION(AT(threads),
                   "threads to use; default: all processors. The bytes do not depend on it"),
};

static const option motion_option_table[] = {
    {"motion", OPTION_FILE, AT(motion), .letter = 'm', .value = "MOTION",
     .help = "a motion script (.yaml), a table of poses, or a log of true rates and forces; "
             "default: at rest, as stated by the options below"},
    {"temperature", OPTION_FILE, AT(temperature), .letter = 't', .value = "PROFILE",
     .help = "a constant such as 25degC, a profile (.yaml), or a table of time and temperature"},
    {"substeps", OPTION_INTEGER, AT(substeps), .value = "N", .choices = "1-512",
     .help =
         "parts into which a sample is divided, for vibration and bandwidth; default: as needed"},
    LATITUDE_OPTION(AT(latitude), "geodetic latitude; default 45deg"),
    HEIGHT_OPTION(AT(height)),
    TURN_OPTION("roll", AT(roll), "roll; default 0deg: level"),
    TURN_OPTION("pitch", AT(pitch), "pitch; default 0deg: level"),
    TURN_OPTION("yaw", AT(yaw), "heading, from north to east; default 0deg"),
    {"no-earth", OPTION_FLAG, AT(no_earth), .help = "without Earth rate and gravity"},
    {"field", OPTION_TEXT, AT(field), .value = "FIELD",
     .help =
         "magnetic field north, east and down for a model with a magnetometer, such as \"20 1 43 "
         "uT\"; default: that of a dipole at the latitude"},
};

_Static_assert(IMK_SUBSTEPS_MAX == 512, "as the range of --substeps says");

static bool is_directory(const char *path)
{
    struct stat status;
    const size_t length = path ? strlen(path) : 0;
    return length > 0 &&
           (path[length - 1] == '/' || (stat(path, &status) == 0 && S_ISDIR(status.st_mode)));
}

/* A file where the log of a run goes would be lost. */
static int check_run_folder(const simulate_options *o)
{
    const struct {
        const char *option, *path;
    } files[] = {{"truth", o->truth},
                 {"motion", o->motion},
                 {"temperature", o->temperature},
                 {"aid-output", o->aid_output}};
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        const char *slash = files[i].path ? strrchr(files[i].path, '/') : NULL;
        const char *name = slash ? slash + 1 : files[i].path;
        if (name && strncmp(name, "run_", 4) == 0 && file_is_in(files[i].path, o->output))
            return command_misused("--%s %s has the name of a run in -o %s: give another name",
                                   files[i].option, files[i].path, o->output);
    }
    return -1;
}

/* Files that would be written one over the other, or into each other. */
static int check_outputs(const simulate_options *o)
{
    static const char *const formats[] = {"csv", "csv.gz", "csv.zst", "npy",  "npz",
                                          "mat", "h5",     "bag",     "mcap", "db3"};
    const char *output = o->output ? o->output : "-";
    if (o->runs.given && !is_directory(o->output))
        return command_misused("--runs writes one log per run into a directory: add -o DIR/");
    if (!o->runs.given && *output && output[strlen(output) - 1] == '/')
        return command_misused("-o %s is a directory: name a file, or add --runs N", output);
    bool known = !o->format;
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++)
        known = known || strcmp(o->format, formats[i]) == 0;
    if (!known)
        return command_misused(
            "--format %s: expected csv, csv.gz, csv.zst, npy, npz, mat, h5, bag, "
            "mcap or db3",
            o->format);
    if (o->format && !o->runs.given)
        return command_misused("--format is for --runs: a single log has it in its name, -o LOG.%s",
                               o->format);
    if (o->json && strcmp(output, "-") == 0)
        return command_misused("--json and the log cannot both go to standard output: add -o LOG");
    if (o->truth && strcmp(o->truth, "-") == 0 && strcmp(output, "-") == 0)
        return command_misused("the log and the truth cannot both go to standard output: add -o "
                               "LOG");
    return o->runs.given ? check_run_folder(o) : -1;
}

static int check_aid(const simulate_options *o)
{
    if (!o->aid &&
        (o->aid_output || o->aid_lever_arm || !isnan(o->aid_rate) || !isnan(o->aid_until)))
        return command_misused("--aid-%s is about --aid; add --aid \"position 1 m\", for instance",
                               o->aid_output        ? "output"
                               : o->aid_lever_arm   ? "lever-arm"
                               : isnan(o->aid_rate) ? "until"
                                                    : "rate");
    if (o->aid && !o->aid_output)
        return command_misused("--aid: add --aid-output FILE for the readings");
    if (o->aid && o->runs.given)
        return command_misused("--aid is for one run: use --run N in place of --runs N");
    return -1;
}

static int check(const simulate_options *o)
{
    const int code = check_aid(o);
    if (code >= 0)
        return code;
    if (o->runs.given && o->runs.value > UINT32_MAX - o->run.value + 1)
        return command_misused("run numbers: expected at most %u", UINT32_MAX);
    return check_outputs(o);
}

static int simulate(const simulate_options *o, const imk_model *model, const char *name)
{
    scene s;
    int code = scene_open(o, model, &s);
    if (code < 0)
        code = simulate_logs(o, model, name, &s);
    scene_free(&s);
    return code;
}

static int run(int count, char **words)
{
    double missing = (double)NAN;
    simulate_options o = {.rate = missing,
                          .duration = missing,
                          .latitude = missing,
                          .aid_rate = missing,
                          .aid_until = missing,
                          .seed = {.value = 1}};
    const char *operands[OPERANDS_MAX];
    int code = options_parse(&simulate_verb, count, words, &o, operands);
    if (code < 0)
        code = check(&o);
    if (code >= 0)
        return code;
    imk_model *model = command_memory(NULL, sizeof *model);
    code = command_model(operands[0], model, NULL);
    if (code < 0)
        code = term_selection_apply(&o.terms, model);
    if (code < 0)
        code = simulate(&o, model, operands[0]);
    free(model);
    return code;
}

const verb simulate_verb = {
    .name = "simulate",
    .summary = "model + motion -> log of a sensor unit with all its errors",
    .operands = "MODEL",
    .operands_minimum = 1,
    .operands_maximum = 1,
    .examples = {{"imukit simulate AHRS --rate 100Hz --duration 1h --seed 1 -o static.csv",
                  "an hour of a unit of AHRS grade, level at 45 degrees north"},
                 {"imukit simulate model.yaml --motion car.yaml --temperature 25degC --rate 100Hz "
                  "--runs 20 -o runs/ --truth runs/truth.csv",
                  "a model file on a motion script, twenty runs and the truth"}},
    .description =
        "MODEL is a model file or a name from `imukit devices`. The log has a time column, one "
        "column per axis, and the temperature when it is given; a model with a sensitivity makes "
        "counts. Axes are forward-right-down, so at rest and level accel_z is about -9.8 m/s^2. A "
        "row is the mean over the interval that ends at its time; row 0 shows the unit before the "
        "motion begins.",
    .groups = {OPTION_GROUP("Options", simulate_option_table, 0),
               {"Terms", TERM_OPTIONS, term_options, AT(terms)},
               OPTION_GROUP("Motion and place", motion_option_table, 0)},
    .run = run};
