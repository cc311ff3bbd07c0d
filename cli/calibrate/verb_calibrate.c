/* SPDX-License-Identifier: Apache-2.0 */
/* imukit calibrate: logs of bench tests -> bias, scale factor, misalignment … with uncertainty. */
#include "calibrate_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define AT(field) offsetof(calibrate_options, field)

static const option result_options[] = {
    {"procedure", OPTION_TEXT, AT(procedure), .letter = 'p', .value = "NAME",
     .help = "procedure of the test: multiposition, sixposition, ferraris, rate-table, tumble, "
             "centrifuge, spin, thermal, turns, magnetometer or repeatability; one for all logs, "
             "or one "
             "for each log, separated by commas"},
    {"output", OPTION_OUTPUT, AT(output), .letter = 'o', .value = "MODEL",
     .help = "write the model here (.yaml or .json)"},
    {"into", OPTION_INTO, AT(into), .value = "MODEL",
     .help = "start from this model and replace only the estimated terms; the changes are printed"},
    {"model", OPTION_FILE, AT(model), .letter = 'm', .value = "MODEL",
     .help = "model known before the test: sensitivities, and terms that are not estimated"},
    {"name", OPTION_TEXT, AT(name), .value = "TEXT",
     .help = "name of the model; default: the name of the log file"},
    REPORT_OPTION(AT(report),
                  "write one self-contained page: verdict, parameters, residuals, model"),
    PLOT_OPTION(AT(plot), "draw the residuals, and the rests of each log"),
    {"poses", OPTION_FLAG, AT(poses), .help = "print every observation with its residuals"},
    JSON_OPTION(AT(json), "print the result as JSON instead of tables"),
    STRICT_OPTION(AT(strict), "exit with 1 when there is a warning"),
    {"plan", OPTION_FLAG, AT(plan),
     .help = "plan a test instead and print its programme; the operand is a model of the unit with "
             "its noise, -o names the motion file to write"},
    {"want", OPTION_TEXT, AT(want), .value = "REQUIREMENTS",
     .help = "with --plan: uncertainties (1 sigma) to reach, such as \"accel.scale_factor 50 ppm, "
             "gyro.bias 5 deg/h\""},
    {"soak", OPTION_QUANTITY, AT(soak), .value = "TIME", .unit = "s", .choices = "0..1e6",
     .help =
         "with --plan, thermal: time at each temperature before the measurement; default 10min"},
    {"anyway", OPTION_FLAG, AT(anyway),
     .help = "write the model although the verdict says that it is not usable"},
};

static const option test_options[] = {
    {"position", OPTION_TEXT, AT(position), .value = "POSITION",
     .help = "latitude, longitude and height of the test, for gravity and the Earth's rotation, "
             "such as \"48.1 deg, 11.6 deg, 520 m\""},
    {"gravity", OPTION_QUANTITY, AT(settings.gravity), .letter = 'g', .value = "G", .unit = "m/s^2",
     .help = "local gravity, if it is known better than from the position, such as 9.80743m/s^2"},
    {"field", OPTION_TEXT, AT(field), .value = "FIELD",
     .help = "strength of the Earth's magnetic field at the place, with 1 sigma, such as \"48.1 +- "
             "0.2 uT\"; sets the scale of the magnetometer"},
    {"dip", OPTION_TEXT, AT(dip), .value = "ANGLE",
     .help =
         "dip of this field below the horizontal, negative if it points up, such as \"64 deg\"; "
         "tells signs of the magnetometer's axes apart, as --position does"},
    {"no-earth", OPTION_FLAG, AT(settings.no_earth),
     .help = "the references do not contain the Earth's rotation; the gyro bias then includes it"},
    {"frame", OPTION_CHOICE, AT(settings.frame), .value = "FRAME",
     .choices = "upper-triangular|lower-triangular|symmetric|reference",
     .help = "convention that fixes the rotation of the triads, which gravity alone does not; "
             "default reference with a procedure of known attitudes, else upper-triangular"},
    {"estimate", OPTION_TEXT, AT(settings.estimate), .value = "TERMS",
     .help = "terms to estimate, such as \"bias,scale_factor,accel.misalignment\"; "
             "default: the terms that the procedure determines"},
    {"with", OPTION_TEXT, AT(with), .value = "TERMS",
     .help =
         "estimate these terms in addition: nonlinearity, cross_products, g_sensitivity, "
         "g2_sensitivity, gyro (multiposition: scale factors and misalignments of the gyros, by "
         "the turns)"},
    {"without", OPTION_TEXT, AT(without), .value = "TERMS", .help = "do not estimate these terms"},
    {"accel-sensitivity", OPTION_TEXT, AT(sensitivity[1]), .value = "NUMBER",
     .help = "nominal sensitivity of the accelerometers, for logs in counts, such as \"415 "
             "count/(m/s^2)\""},
    {"gyro-sensitivity", OPTION_TEXT, AT(sensitivity[0]), .value = "NUMBER",
     .help = "nominal sensitivity of the gyros, such as \"4778 count/(rad/s)\""},
    {"accel-zero", OPTION_TEXT, AT(zero_offset[1]), .value = "NUMBER",
     .help = "counts of the accelerometers at zero input, such as \"32768 count\""},
    {"gyro-zero", OPTION_TEXT, AT(zero_offset[0]), .value = "NUMBER",
     .help = "counts of the gyros at zero input"},
    {"accel-range", OPTION_TEXT, AT(range[1]), .value = "RANGE",
     .help = "full scale of the accelerometers, such as \"16 g\": readings at it are left out as "
             "saturated, and the model states it"},
    {"gyro-range", OPTION_TEXT, AT(range[0]), .value = "RANGE",
     .help = "full scale of the gyros, such as \"2000 deg/s\""},
    {"robust", OPTION_CHOICE, AT(robust), .value = "CHOICE", .choices = "yes|no",
     .help = "yes (default): observations that do not fit the others lose their weight"},
    {"estimator", OPTION_CHOICE, AT(estimator), .value = "CHOICE",
     .choices = "maximum-likelihood|closed-form",
     .help = "ferraris: closed-form uses the published solution, and gives its digits with --trim "
             "0s; for comparison. Default maximum-likelihood"},
};

static const option log_options[] = {
    {"pose-means", OPTION_FLAG, AT(settings.pose_means),
     .help = "the logs of multiposition, sixposition and tumble are tables with a row for each "
             "pose: its mean readings, and how well they are known, gyro_x_std [deg/s], "
             "accel_x_std [g] … of the samples and their number, samples, or accel_x_std_of_mean "
             "[g] …; without these the scatter of the residuals tells"},
    {"section", OPTION_TEXT, AT(settings.section), .value = "COLUMN",
     .help =
         "column of texts that name the holds, turns or runs (multiposition: rests without a text "
         "are no holds); default: the only column of texts"},
    {"initial-rest", OPTION_QUANTITY, AT(settings.initial_rest), .value = "TIME", .unit = "s",
     .choices = "not negative",
     .help = "length of the rest at the beginning of the log; default: the quietest part is used"},
    {"window", OPTION_QUANTITY, AT(settings.window), .value = "TIME", .unit = "s",
     .choices = "not negative",
     .help = "length of the window in which rest is detected; default: chosen from the log"},
    {"minimum", OPTION_QUANTITY, AT(settings.minimum), .value = "TIME", .unit = "s",
     .choices = "positive",
     .help =
         "shortest rest, step or run to use; default 1s for rests, 0.5s for steps of a reference"},
    {"trim", OPTION_QUANTITY, AT(settings.trim), .value = "TIME", .unit = "s",
     .choices = "not negative",
     .help = "time left out at both ends of a step or run; default 0.2s"},
    {"settle", OPTION_QUANTITY, AT(settings.settle), .value = "TIME", .unit = "s",
     .choices = "not negative",
     .help = "time left out in addition at the beginning, until filters have settled; default 0s"},
    {"placement", OPTION_QUANTITY, AT(settings.placement), .value = "ANGLE", .unit = "deg",
     .choices = "0..180",
     .help =
         "1 sigma of the attitude of each placement on a face, and of the angle and the axis of "
         "a turn; default 0.1deg for sixposition, ferraris and turns"},
    {"g-sensitivity-sigma", OPTION_QUANTITY, AT(settings.g_sensitivity_sigma), .value = "RATE",
     .unit = "deg/h/g", .choices = "not negative",
     .help = "1 sigma of the g-sensitivity of the gyros where a log with a reference, or of turns, "
             "does not determine it, included in the uncertainty of the biases; default 36deg/h/g, "
             "or what "
             "the log shows; 0deg/h/g: the model has the exact value"},
    {"mounting", OPTION_QUANTITY, AT(settings.mounting), .value = "ANGLE", .unit = "deg",
     .choices = "0..180",
     .help = "1 sigma of the unit's attitude on its fixture or table, which is the same for all "
             "holds; default 0deg"},
    {"turn-angle", OPTION_QUANTITY, AT(settings.turn_angle), .value = "ANGLE", .unit = "deg",
     .choices = "-36000..36000",
     .help = "ferraris: angle of each turn about its axis, with sign; turns: of each turn whose "
             "label states none, above 0; default 360deg"},
    {"motion", OPTION_FILE, AT(motion), .value = "PROGRAMME",
     .help = "motion file that the table ran; it is the reference"},
    {"motion-offset", OPTION_TEXT, AT(motion_offset), .value = "TIME|auto",
     .help = "time of the log at which the programme begins; auto finds it; default 0s"},
    {"table-axis", OPTION_CHOICE, AT(settings.table_axis), .value = "AXIS", .choices = "x|y|z",
     .help = "axis of the unit about which the table turns it, for a column table_rate [deg/s]"},
    {"temperature-order", OPTION_INTEGER, AT(temperature_order), .value = "N", .choices = "1-5",
     .help = "thermal: order of the bias polynomial, 1 to 5; default: chosen by cross-validation"},
    {"reference-temperature", OPTION_QUANTITY, AT(settings.reference_temperature), .value = "T",
     .unit = "degC",
     .help = "thermal: temperature at which the polynomials are 0; default 25degC if the sweep "
             "contains it"},
};

#define COUNT(table) (sizeof(table) / sizeof *(table))

_Static_assert(IMK_TEMPERATURE_ORDER_MAX == 5, "as the range of --temperature-order says");

/* Solve, or compare runs. */
static int find_result(session *b)
{
    imk_error error;
    int code = session_choose(b);
    if (code < 0 && b->options->plan)
        return session_plan(b);
    if (code < 0 && session_has_run_models(b))
        code = session_compare_models(b);
    else if (code < 0 && (code = session_load(b)) < 0)
        code = session_done(b, imk_calibrate_log_run(b->found, &error), &error);
    return code < 0 ? session_show(b) : code;
}

static int check(const calibrate_options *o)
{
    if (o->into && o->model)
        return command_misused(
            "--into and --model both name the model to start from: leave one of them out");
    if (o->want && !o->plan)
        return command_misused("--want is used with --plan only: add --plan");
    if (!isnan(o->soak) && !o->plan)
        return command_misused("--soak is used with --plan only: add --plan");
    return command_check_plot(o->plot);
}

static void free_session(session *b)
{
    imk_calibrate_log_free(b->found);
    imk_motion_file_free(b->motion);
    imk_document_free(b->document);
    free(b->known);
    free(b);
}

static int run(int count, char **words)
{
    calibrate_options o = {.settings = imk_calibrate_log_default(), .soak = (double)NAN};
    session *b = command_zeroed(sizeof *b);
    b->options = &o;
    int code = options_parse(&calibrate_verb, count, words, &o, b->path);
    while (b->count < IMK_TEST_RECORDS_MAX && b->path[b->count])
        b->count++;
    if (code < 0)
        code = check(&o);
    if (code < 0 && o.plan && b->count != 1)
        code = command_misused("--plan takes one MODEL, that of the unit to be tested");
    if (code < 0)
        code = find_result(b);
    free_session(b);
    return code;
}

const verb calibrate_verb = {
    .name = "calibrate",
    .summary = "logs of bench tests -> bias, scale, misalignment with uncertainty",
    .operands = "LOG...",
    .operands_minimum = 1,
    .operands_maximum = IMK_TEST_RECORDS_MAX,
    .all_are_evidence = true,
    .examples = {{"imukit calibrate poses.csv --procedure multiposition --position \"48.1 deg, "
                  "11.6 deg, 520 m\" -o model.yaml",
                  "a unit turned by hand, resting some seconds in each of 20 or more attitudes"},
                 {"imukit calibrate poses.csv table.csv --procedure multiposition,rate-table "
                  "--motion programme.yaml -o model.yaml --report report.html",
                  "two tests solved together; the table ran the programme"}},
    .description =
        "LOG is CSV (also .gz, .zst){ or logs}, in physical units or raw counts. A procedure "
        "takes observations from each log. All logs are solved together, robustly, and every "
        "parameter comes with 1 sigma, a 95 % interval and correlations. A verdict says whether "
        "the result can be used.\n\n"
        "multiposition needs no equipment: the unit rests in different attitudes and is turned by "
        "hand between them. turns calibrates gyros without accelerometers, by turns of known angle "
        "about each axis. sixposition and ferraris need the faces of a housing, and ferraris full "
        "turns about three axes as well. rate-table, tumble, centrifuge and spin need the "
        "rates or forces that acted on the unit: columns reference_rate_x [deg/s] …, "
        "reference_force_x [g] … in the log (mean over the sample, in inertial space, gravity "
        "included), table_rate [deg/s] with --table-axis, or the programme of the table as a "
        "motion file. thermal needs a column temperature. magnetometer needs any rotation by hand; "
        "with "
        "multiposition, a magnetometer beside the accelerometers is calibrated and aligned to "
        "them. repeatability compares power cycles, "
        "each given as a log, a section of a log or a MODEL; models compare the scale factors "
        "too.\n\n"
        "docs/calibrate.md says how to do each test.",
    .groups = {{"Options", COUNT(result_options), result_options, 0},
               {"The test", COUNT(test_options), test_options, 0},
               {"What to look for in the logs", COUNT(log_options), log_options, 0},
               {"Reading the logs", LOG_RANGELESS_OPTIONS, log_input_options, AT(log)}},
    .run = run};
