/* SPDX-License-Identifier: Apache-2.0 */
/* imukit physics: instruments from first principles, run, looked into, reduced to error models. */
#include "physics_parts.h"

#include "imukit/model_file.h"
#include "imukit/names.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define AT(field) offsetof(physics_options, field)

static const option task_option_table[] = {
    {"list", OPTION_FLAG, AT(list), .help = "list the instruments; the same as without INSTRUMENT"},
    {"show", OPTION_FLAG, AT(show),
     .help =
         "print the design as a file with units and comments, as a start for a design of your own"},
    {"reduce", OPTION_FLAG, AT(reduce),
     .help = "print the error model by closed forms and what follows from the parts as tables; -o "
             "MODEL.yaml writes the model"},
    {"sweep", OPTION_FLAG, AT(sweep),
     .help = "find the error model by the experiments of a laboratory and compare it with the "
             "closed forms; -o MODEL.yaml without --reduce writes what was measured"},
    {"single-axis", OPTION_FLAG, AT(single_axis),
     .help = "write a model of one instrument along x, not of three"},
};

static const option input_option_table[] = {
    {"rate", OPTION_TEXT, AT(rate), .letter = 'r', .value = "RATE",
     .help = "angular rate about x, \"10 deg/s\", or about all axes of the case, \"1 2 3 deg/s\""},
    {"acceleration", OPTION_TEXT, AT(acceleration), .letter = 'a', .value = "FORCE",
     .help = "specific force along x, \"1 g\", or along all axes of the case, \"0 0 -9.81 m/s^2\""},
    {"sine", OPTION_QUANTITY, AT(sine), .value = "FREQUENCY", .unit = "Hz",
     .help = "frequency of a sine; the given rate or force is its amplitude"},
    {"temperature", OPTION_QUANTITY, AT(temperature), .letter = 't', .value = "TEMPERATURE",
     .unit = "degC",
     .help = "temperature of the instrument; default 20degC. --sweep is at the reference "
             "temperature of the error model"},
    {"temperature-rate", OPTION_QUANTITY, AT(temperature_rate), .value = "RATE", .unit = "degC/min",
     .help = "rate at which the temperature changes from --temperature on"},
};

static const option run_option_table[] = {
    {"duration", OPTION_QUANTITY, AT(duration), .letter = 'd', .value = "TIME", .unit = "s",
     .help = "run for this time and write the log; with --view: length of the view; with --sweep: "
             "simulated time that each experiment may take"},
    {"output-rate", OPTION_QUANTITY, AT(output_rate), .value = "RATE", .unit = "Hz",
     .help = "samples per second; default 100Hz. With --view: points per second of the view"},
    {"level", OPTION_CHOICE, AT(level), .value = "LEVEL", .choices = "full|slow",
     .help = "full (the default): the dynamics of all parts; slow: a map or envelope without the "
             "fast part. Without it, --sweep does what takes long at the slow level, if there is "
             "one"},
    {"step", OPTION_QUANTITY, AT(step), .value = "TIME", .unit = "s", .choices = "positive",
     .help = "longest internal step; default: what the instrument's accuracy needs. A step that "
             "would give wrong results is refused"},
    {"no-noise", OPTION_FLAG, AT(no_noise),
     .help = "nothing random: no noise, no random constants of the run"},
    SEED_OPTION(AT(seed), "seed; the same seed makes the same bytes on every machine; default 1"),
    {"run", OPTION_INTEGER, AT(run), .value = "N", .choices = "0-4294967295",
     .help =
         "another run of the same instrument: other noise, other constants of the run; default 0"},
    THREADS_OPTION(AT(threads),
                   "threads of --sweep; default: all processors. The result does not depend on it"),
};

static const option output_option_table[] = {
    {"output", OPTION_OUTPUT, AT(output), .letter = 'o', .value = "FILE",
     .help = "the log (.csv, also .gz, .zst{, or written}; default: standard output), the model of "
             "--reduce, the design of --show, or the drawing of --view"},
    {"signals", OPTION_OUTPUT, AT(signals), .value = "FILE.csv",
     .help = "write the internal signals against time"},
    {"signal-rate", OPTION_QUANTITY, AT(signal_rate), .value = "RATE", .unit = "Hz",
     .help = "rows per second of --signals; default: the output rate. Another rate needs a "
             "separate run"},
    PLOT_OPTION(AT(plot),
                "draw the outputs of the run against time (with --sine also against the input), or "
                "the results of --sweep; without either, the views of the instrument"),
    {"view", OPTION_TEXT, AT(view), .value = "[VIEW]", .alone = "schematic",
     .help = "without VIEW, or with schematic: write the labelled drawing of the instrument, in "
             "motion, to -o FILE.svg or standard output; else the view for --plot: its number, or "
             "the beginning of its title"},
    {"animate", OPTION_OUTPUT, AT(animate), .value = "FILE.svg",
     .help = "draw a view of one signal against another as an animation: the view of --view, or "
             "else the first"},
    REPORT_OPTION(AT(report), "write one self-contained page: outputs, views, design, error model"),
    JSON_OPTION(AT(json), "print the result as JSON"),
};

/* ---- checks ---------------------------------------------------------------------------------- */

/* The schematic is a drawing of its own. */
static int check_schematic(const physics_options *o, const char *operand)
{
    const char *other = o->plot                ? "plot"
                        : o->animate           ? "animate"
                        : o->report            ? "report"
                        : o->signals           ? "signals"
                        : o->json              ? "json"
                        : o->list              ? "list"
                        : o->show              ? "show"
                        : o->reduce            ? "reduce"
                        : o->sweep             ? "sweep"
                        : !isnan(o->view_rate) ? "output-rate"
                                               : NULL;
    if (!operand)
        return command_misused("an operand is missing: imukit physics INSTRUMENT --view; imukit "
                               "physics lists the instruments");
    if (other)
        return command_misused("--view without a VIEW writes the schematic and nothing else: leave "
                               "--%s out%s",
                               other,
                               o->report ? ", or --view: the page has the schematic at its top"
                               : o->plot || o->animate ? ", or name a view"
                                                       : "");
    if (o->output && strcmp(o->output, "-") != 0 && !imk_has_ending(o->output, ".svg"))
        return command_misused("-o %s: the schematic is an SVG; expected a name ending in .svg",
                               o->output);
    return -1;
}

static int check_tasks(const physics_options *o, const char *operand)
{
    const bool runs = !isnan(o->duration), models = o->reduce || o->sweep;
    const char *const model_task = o->reduce ? "reduce" : "sweep";
    if (o->list && operand)
        return command_misused("--list takes no instrument");
    if (!operand && !o->list && (models || o->show || runs || o->plot || o->report || o->animate))
        return command_misused("an operand is missing: imukit physics %s; imukit physics lists the "
                               "instruments",
                               physics_verb.operands);
    if (!operand && o->view && imk_instrument_find(o->view))
        return command_misused("--view %s: the instrument stands before: imukit physics %s --view",
                               o->view, o->view);
    if (o->show && (models || runs || o->plot || o->report || o->animate || o->json))
        return command_misused("--show prints the design and nothing else");
    if (o->reduce && !o->sweep && runs)
        return command_misused("--duration runs the instrument and --reduce does not: leave one "
                               "out");
    if (o->view && (o->output || o->signals))
        return command_misused("%s: a view is drawn, not written; leave --view out to write a run",
                               o->output ? "-o" : "--signals");
    if (!runs && !o->show && !models && (o->output || o->signals))
        return command_misused("%s: there is no run to write; add --duration TIME",
                               o->output ? "-o" : "--signals");
    if (!runs && !models && !o->plot && !o->report && !o->animate && (o->rate || o->acceleration))
        return command_misused("--%s: the length is missing; add --duration TIME",
                               o->rate ? "rate" : "acceleration");
    if (o->animate && (runs || models))
        return command_misused("--animate draws a view of the instrument: leave --%s out",
                               runs ? "duration" : model_task);
    if (o->view && ((!o->plot && !o->animate) || models))
        return command_misused("--view is drawn by --plot FILE or --animate FILE%s%s: add one",
                               models ? ", without --" : "", models ? model_task : "");
    if (o->single_axis && !(models && o->output))
        return command_misused("--single-axis is about the model that --reduce -o MODEL.yaml "
                               "writes");
    if (models && o->signals)
        return command_misused("--signals needs a run: add --duration TIME, and leave --%s out",
                               model_task);
    return -1;
}

static int check_numbers(const physics_options *o)
{
    if (!isnan(o->duration) && !(o->duration > 0))
        return command_misused("--duration: expected a time above 0");
    if (!isnan(o->view_duration) && !(o->view_duration > 0))
        return command_misused("--duration: expected a time above 0");
    if (!(o->output_rate > 0))
        return command_misused("--output-rate: expected a rate above 0");
    if (!(o->signal_rate > 0))
        return command_misused("--signal-rate: expected a rate above 0");
    if (!isnan(o->duration) && o->duration * fmax(o->output_rate, o->signal_rate) > 9e15)
        return command_misused("--duration %g s: too many samples", o->duration);
    if (o->animate && !imk_has_ending(o->animate, ".svg"))
        return command_misused("--animate %s: expected a name ending in .svg", o->animate);
    return command_check_plot(o->plot);
}

/* ---- the tasks ------------------------------------------------------------------------------- */

/* How to go on from the design. */
static void show_next(const physics *p, imk_result *result)
{
    const bool gyro = p->settings.instrument->sensor == IMK_GYRO;
    imk_result_for(result, IMK_FOR_TERMINAL);
    imk_result_line(result,
                    "\nNext\n"
                    "  imukit physics %s --%s --duration 10s -o out.csv\n"
                    "  imukit physics %s --report report.html\n"
                    "  imukit physics %s --reduce -o model.yaml\n"
                    "  imukit physics %s --sweep",
                    p->source, gyro ? "rate \"10 deg/s\"" : "acceleration \"1 g\"", p->source,
                    p->source, p->source);
    imk_result_for(result, IMK_FOR_PAGE);
}

/* The whole display of a run, of the error models (sweep NULL: not measured), or of the design.
 * @return -1 or the exit code, the message printed */
static int make_result(const physics *p, const imk_physics_shown *shown, imk_result *result)
{
    const physics_options *o = p->options;
    const imk_physics_sweep *l = shown->sweep;
    int code = -1;
    imk_show_physics(shown, result);
    if (!shown->run && !l && !o->reduce)
        show_next(p, result);
    if (o->report) {
        physics_show_views(p, result);
        imk_show_physics_design(shown, result);
        show_model(result, "As a file", p->model);
    }
    if (l) {
        imk_show_physics_sweep(shown, result);
        if (o->plot && l->result.point_count == 0 && l->result.response_count == 0)
            code = command_failed("nothing was measured that can be drawn");
    } else if (o->plot && !shown->run) {
        imk_result_for(result, IMK_FOR_PLOT);
        code = physics_show_view_figure(p, result);
        imk_result_for(result, IMK_FOR_PAGE);
    }
    show_warnings(result); /* all are known now */
    show_origin(result);
    return code;
}

/* Picture, page, JSON and tables of the result: if the picture fails because gnuplot is missing,
 * the page is still written. @return the exit code */
static int show(const physics *p, const imk_physics_log *r, const imk_physics_sweep *l, bool quiet)
{
    const physics_options *o = p->options;
    imk_result *result = show_begin("physics");
    const imk_physics_shown shown = {.settings = &p->settings,
                                     .source = p->source,
                                     .name = p->file.name,
                                     .description = p->file.description,
                                     .model = p->model,
                                     .reduced = o->reduce,
                                     .run = r,
                                     .sweep = l};
    const int code = make_result(p, &shown, result);
    if (code >= 0) {
        imk_result_free(result);
        return code;
    }
    const int failed = o->plot ? show_plot(result, o->plot) : -1;
    const show_options options = {
        .report = o->report, .json = o->json, .quiet = quiet || failed >= 0};
    return show_end(result, &options, failed < 0 ? EXIT_DONE : failed);
}

static int do_run(const physics *p)
{
    const physics_options *o = p->options;
    imk_physics_log *r;
    int code = physics_run_make(p, &r);
    if (code < 0)
        code = show(p, r, NULL, !o->output && !o->plot && !o->report && !o->signals);
    imk_physics_log_free(r);
    return code;
}

static int write_model(const physics *p, const imk_model *model)
{
    imk_error error;
    imk_model *copy = command_memory(NULL, sizeof *copy);
    *copy = *model;
    if (p->file.name[0])
        snprintf(copy->name, sizeof copy->name, "%s", p->file.name);
    if (!p->options->single_axis)
        imk_model_three_axes(copy);
    const imk_status status = imk_model_write(p->options->output, copy, NULL, &error);
    free(copy);
    return status == IMK_OK ? -1 : command_error(&error, NULL);
}

static int do_model(const physics *p)
{
    const physics_options *o = p->options;
    imk_physics_sweep *l = NULL;
    int code = o->sweep ? physics_sweep_make(p, &l) : -1;
    if (code < 0 && o->output)
        code = write_model(p, o->reduce ? p->model : &l->result.model);
    if (code < 0)
        code = show(p, NULL, l, false);
    imk_physics_sweep_free(l);
    return code;
}

static int do_task(const physics *p)
{
    const physics_options *o = p->options;
    imk_error error;
    if (physics_asks_schematic(o)) {
        const int failed = physics_draw_schematic(p, o->output ? o->output : "-");
        return failed < 0 ? EXIT_DONE : failed;
    }
    if (o->show && o->json && !o->output)
        return command_misused("--show and --json cannot both go to standard output: add -o "
                               "DESIGN.yaml, or leave --show out");
    if (o->show && imk_design_write(o->output ? o->output : "-", &p->file, &error) != IMK_OK)
        return command_error(&error, NULL);
    if (o->show)
        return o->json ? show(p, NULL, NULL, true) : EXIT_DONE;
    if (o->reduce || o->sweep)
        return do_model(p);
    if (!isnan(o->duration))
        return do_run(p);
    const int code = o->animate ? physics_animate(p, o->animate) : -1;
    return code < 0 ? show(p, NULL, NULL, o->plot || o->report || o->animate) : code;
}

static int list(const physics_options *o)
{
    imk_result *result = show_begin("physics");
    imk_show_instruments(result);
    imk_result_line(result, "\nOne of them: imukit physics NAME\n"
                            "A design of your own: imukit physics NAME --show > mine.yaml");
    return show_end(result, &(show_options){.json = o->json}, EXIT_DONE);
}

/* ---- the verb -------------------------------------------------------------------------------- */

/* The instrument with this name in the table of grades: "fog" is the fibre-optic gyro. */
static const imk_instrument *of_technology(const char *name)
{
    for (size_t i = 0; i < imk_instrument_count(); i++)
        if (strcasecmp(imk_instrument_get(i)->technology, name) == 0)
            return imk_instrument_get(i);
    return NULL;
}

static int open_design(physics *p)
{
    imk_error error = {.status = IMK_OK};
    const imk_status status = imk_design_open(p->source, &p->file, &error);
    if (status == IMK_OK)
        return -1;
    if (status == IMK_ERROR_NAME_UNKNOWN && error.line == 0) {
        const imk_instrument *alike = of_technology(p->source);
        if (alike)
            snprintf(error.expected, sizeof error.expected, "did you mean \"%s\"?", alike->name);
        return command_error(&error, NULL);
    }
    return command_error(&error, p->source);
}

static int start(const physics_options *o, const char *operand)
{
    physics p = {.options = o, .source = operand, .settings = imk_physics_log_default()};
    p.settings.physics.level = o->level == 1 ? IMK_LEVEL_SLOW : IMK_LEVEL_FULL;
    p.settings.quick = o->level < 0;
    p.settings.physics.rate = o->output_rate;
    p.settings.physics.step = o->step;
    p.settings.physics.noise = !o->no_noise;
    p.settings.physics.seed = o->seed.value;
    p.settings.physics.run = (uint32_t)o->run.value;
    p.settings.duration = isnan(o->duration) ? 0 : o->duration;
    p.settings.signal_rate = o->signal_rate;
    p.settings.view_duration = isnan(o->view_duration) ? 0 : o->view_duration;
    p.settings.view_rate = o->view && !isnan(o->view_rate) ? o->view_rate : 0;
    p.settings.view_input = o->rate || o->acceleration;
    int code = open_design(&p);
    p.settings.instrument = p.file.instrument;
    p.settings.design = p.file.design;
    if (code < 0)
        code = physics_input_make(o, &p.settings);
    if (code < 0) {
        p.model = command_memory(NULL, sizeof *p.model);
        imk_instrument_reduce(p.file.instrument, p.file.design, p.model);
        code = do_task(&p);
    }
    free(p.model);
    imk_design_file_free(&p.file);
    return code;
}

static int run(int count, char **words)
{
    const double missing = (double)NAN;
    physics_options o = {.sine = missing,
                         .temperature = 293.15,
                         .duration = missing,
                         .view_duration = missing,
                         .output_rate = missing,
                         .signal_rate = missing,
                         .level = -1,
                         .seed = {.value = 1}};
    const char *operands[OPERANDS_MAX];
    int code = options_parse(&physics_verb, count, words, &o, operands);
    if (code >= 0)
        return code;
    o.view_rate = o.output_rate;
    if (isnan(o.output_rate))
        o.output_rate = 100;
    if (o.view) {
        o.view_duration = o.duration;
        o.duration = missing;
    }
    if (isnan(o.signal_rate))
        o.signal_rate = o.output_rate;
    code = physics_asks_schematic(&o) ? check_schematic(&o, operands[0])
                                      : check_tasks(&o, operands[0]);
    if (code < 0)
        code = check_numbers(&o);
    if (code >= 0)
        return code;
    return operands[0] ? start(&o, operands[0]) : list(&o);
}

const verb physics_verb = {
    .name = "physics",
    .summary = "instruments from first principles: run them, reduce them to error models",
    .operands = "[INSTRUMENT|DESIGN.yaml]",
    .operands_minimum = 0,
    .operands_maximum = 1,
    .examples = {{"imukit physics ring_laser --rate \"10 deg/s\" --duration 10s -o out.csv",
                  "ten seconds of a ring laser gyro that turns, as a log"},
                 {"imukit physics mine.yaml --reduce --sweep -o model.yaml",
                  "the error model of a design of your own, by closed forms and by experiments, "
                  "for simulate, grade and the other verbs"}},
    .description =
        "INSTRUMENT is a name from the list that imukit physics prints, with its default design; "
        "DESIGN.yaml is a design file (docs/design-file.md); --show prints one to start from. "
        "Without an option the design and what follows from it are printed.\n\nEach row of a log "
        "is the mean over the sample "
        "that ends at its time; the input is held over a sample. x is the input axis; the "
        "documentation of each instrument describes y and z. The views are drawn for the input of "
        "--rate and --acceleration; without these options each view has an input that suits it.",
    .groups = {OPTION_GROUP("What to do", task_option_table, 0),
               OPTION_GROUP("Input", input_option_table, 0),
               OPTION_GROUP("Running", run_option_table, 0),
               OPTION_GROUP("Output", output_option_table, 0)},
    .run = run};
