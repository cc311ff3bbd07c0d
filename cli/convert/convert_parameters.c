/* SPDX-License-Identifier: Apache-2.0 */
/* imukit convert: parameter files of kalibr, Gazebo and others become models, and models such
 * files. */
#include "convert_parameters.h"

#include "shell/show.h"

#include "imukit/model_file.h"
#include "imukit/names.h"
#include "imukit/parameter_file.h"

#include <stdlib.h>
#include <string.h>

/* Position 0 applies when the option is not given. The names stand in the order of
 * imk_parameter_format and imk_density. */
static const char formats[] =
    "auto|kalibr|gazebo|matlab|gnss-ins-sim|navego|openvins|vins|px4|ardupilot|filter|lio-sam|"
    "fast-lio|dlio|glim|orb-slam3|gtsam|airsim|fusion";
static const char target_formats[] =
    "model|kalibr|gazebo|matlab|gnss-ins-sim|navego|openvins|vins|px4|ardupilot|filter|lio-sam|"
    "fast-lio|dlio|glim|orb-slam3|gtsam|airsim|fusion|euroc";

#define AT(field) offsetof(parameter_options, field)

const option parameter_option_table[PARAMETER_OPTIONS] = {
    {"from", OPTION_CHOICE, AT(from), .value = "FORMAT", .choices = formats,
     .help = "format of the parameter file read; default: recognised by its content"},
    {"to", OPTION_CHOICE, AT(to), .value = "FORMAT", .choices = target_formats,
     .help = "format of the parameter file written; default: a model file; euroc: write a log as "
             "the data.csv of a sensor in the EuRoC data set"},
    {"density", OPTION_CHOICE, AT(density), .value = "SIDES",
     .choices = "as-the-program|two-sided|one-sided",
     .help = "meaning of a number per sqrt(Hz), where the format leaves it open (vins, matlab)"},
    {"sensor", OPTION_TEXT, AT(sensor), .value = "NAME",
     .help = "name of the sensor, if the parameter file has several"},
    JSON_OPTION(AT(json),
                "print as JSON what was written, assumed and left out; the output must be a file"),
    {"flicker", OPTION_CHOICE, AT(flicker), .value = "CHOICE",
     .choices = "random-walk|gauss-markov|two-gauss-markov|left-out",
     .help = "--to filter: the process that replaces bias instability, because no filter state can "
             "model it exactly"},
    {"tau-from", OPTION_QUANTITY, AT(tau_from), .value = "TIME", .unit = "s",
     .choices = "1e-9..1e9",
     .help =
         "--to filter: shortest averaging time at which the replacement has to hold; default 1 s"},
    {"tau-to", OPTION_QUANTITY, AT(tau_to), .value = "TIME", .unit = "s", .choices = "1e-9..1e9",
     .help = "--to filter: longest averaging time at which it has to hold; default 1000 s"},
    {"bias-instability-tau", OPTION_QUANTITY, AT(bias_instability_tau), .value = "TIME",
     .unit = "s", .choices = "1e-8..1e8",
     .help =
         "a format with a random walk (K) but no bias instability (B): carry B into the walk, so "
         "that its Allan deviation is right at this averaging time"},
    {"use-bounds", OPTION_FLAG, AT(use_bounds),
     .help = "where the model has no random walk (K), use its upper bound in the evidence"},
    {"frame-rate", OPTION_QUANTITY, AT(frame_rate), .value = "RATE", .unit = "Hz",
     .choices = "1e-9..1e9",
     .help = "glim: LiDAR scans per second, because its noise of the biases is per frame"},
};

static bool only_parameters(const char *path)
{
    static const char *const endings[] = {".m",     ".sdf",    ".xml",   ".urdf",
                                          ".world", ".params", ".param", ".parm"};
    bool any = false;
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++)
        any = any || imk_has_ending(path, endings[i]);
    return any;
}

int parameters_wanted(const parameter_options *options, const char *in, bool model_due,
                      bool *wanted)
{
    imk_error error;
    imk_parameter_format format;
    *wanted = options->from > 0 || (options->to > 0 && options->to != CONVERT_TO_EUROC);
    const bool named = only_parameters(in) || imk_is_script_name(in);
    if (*wanted || !(named || model_due)) /* logs are not looked into */
        return -1;
    const imk_status status = imk_parameter_format_detect(in, &format, &error);
    if (status == IMK_ERROR_UNSUPPORTED && !named) /* too long: a log */
        return -1;
    if (status != IMK_OK)
        return command_error(&error, in);
    *wanted = format != IMK_PARAMETERS_UNKNOWN || only_parameters(in);
    return -1;
}

/* A left-out value is a warning; an assumption is only a line. */
static void tell(const imk_parameter_notes *notes)
{
    for (size_t i = 0; i < notes->count; i++)
        if (notes->note[i].lost)
            command_warn("lost", "%s", notes->note[i].text);
        else
            command_note("assumed", "note: %s", notes->note[i].text);
}

void convert_show_file(const char *file, const char *format, imk_result *result)
{
    imk_result_text(result, "file", file);
    imk_result_text(result, "format", format);
}

static void show_end_of(const char *file, imk_parameter_format format, imk_result *result)
{
    const char *name = imk_parameter_format_name(format);
    convert_show_file(file, name ? name : "model", result);
}

static int read_source(const parameter_options *o, const imk_parameter_settings *settings,
                       const char *in, imk_model *model, imk_parameter_format *format,
                       imk_parameter_notes *notes)
{
    imk_error error;
    imk_parameter_settings reading = *settings;
    reading.format = (imk_parameter_format)o->from;
    if (o->from == 0 && imk_parameter_format_detect(in, &reading.format, &error) != IMK_OK)
        return command_error(&error, in);
    *format = reading.format;
    const bool is_model = reading.format == IMK_PARAMETERS_UNKNOWN && !only_parameters(in);
    if (is_model && o->sensor)
        return command_misused(
            "--sensor is for a parameter file with several sensors, and %s is a model", in);
    if (is_model)
        return command_model(in, model, NULL);
    if (imk_parameters_read(in, &reading, model, notes, &error) != IMK_OK)
        return command_log_error(&error, in);
    return -1;
}

static int write_target(const parameter_options *o, const imk_parameter_settings *settings,
                        const char *in, const char *out, const imk_model *model,
                        imk_parameter_notes *notes)
{
    imk_error error;
    imk_parameter_settings writing = *settings;
    writing.format = (imk_parameter_format)o->to;
    writing.sensor = NULL;
    if (o->to == 0)
        return imk_model_write(out, model, NULL, &error) == IMK_OK ? -1
                                                                   : command_error(&error, NULL);
    imk_status status = imk_parameters_write(out, &writing, model, notes, &error);
    if (status == IMK_OK)
        return -1;
    bool of_output = status == IMK_ERROR_OPEN || status == IMK_ERROR_WRITE;
    return command_log_error(&error, of_output ? NULL : in);
}

int convert_show(const parameter_options *o, imk_parameter_format from, const char *in,
                 const char *out, const imk_parameter_notes *notes)
{
    imk_result *result = show_begin("convert");
    imk_result_object(result, "inputs");
    show_end_of(in, from, result);
    imk_result_end(result);
    imk_result_object(result, "result");
    show_end_of(out, (imk_parameter_format)o->to, result);
    for (int k = 0; notes && k < 2; k++)
        tell(&notes[k]);
    show_judge(result, "%s holds all of %s", out, in);
    imk_result_end(result);
    return show_end(result, &(show_options){.json = o->json, .quiet = true}, EXIT_DONE);
}

int convert_parameters(const parameter_options *options, double rate, const char *in,
                       const char *out)
{
    imk_parameter_settings settings = imk_parameter_default();
    settings.rate = rate;
    settings.density = (imk_density)options->density;
    settings.sensor = options->sensor;
    settings.frame_rate = options->frame_rate;
    settings.bias_instability_tau = options->bias_instability_tau;
    settings.use_bounds = options->use_bounds;
    settings.filter.flicker = (imk_filter_flicker)options->flicker;
    if (options->tau_from > 0)
        settings.filter.from = options->tau_from;
    if (options->tau_to > 0)
        settings.filter.to = options->tau_to;
    if (!(settings.filter.from <= settings.filter.to))
        return command_misused("--tau-from %g s is later than --tau-to %g s", settings.filter.from,
                               settings.filter.to);
    if (options->to == 0 && (options->bias_instability_tau > 0 || options->use_bounds))
        return command_misused("--bias-instability-tau and --use-bounds are for parameter files of "
                               "other programs, and %s is a model; state the format with --to",
                               out);
    imk_model *model = command_memory(NULL, sizeof *model);
    imk_parameter_notes *notes = command_zeroed(2 * sizeof *notes); /* of reading, of writing */
    imk_parameter_format format = IMK_PARAMETERS_UNKNOWN;
    int code = read_source(options, &settings, in, model, &format, &notes[0]);
    if (code < 0 && options->frame_rate > 0 && format != IMK_PARAMETERS_GLIM &&
        options->to != IMK_PARAMETERS_GLIM)
        code = command_misused("--frame-rate is for the format glim");
    if (code < 0)
        code = write_target(options, &settings, in, out, model, &notes[1]);
    if (code < 0)
        code = convert_show(options, format, in, out, notes);
    free(notes);
    free(model);
    return code;
}
