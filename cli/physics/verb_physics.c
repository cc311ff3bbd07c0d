/* SPDX-License-Identifier: Apache-2.0 */
/* imukit physics: instruments from first principles, run, looked into, reduced to error models. */
#include "physics_parts.h"
#include "shell/progress.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static const option task_option_table[] = {
    {"list", 0, OPTION_FLAG, NULL, NULL, NULL, "the instruments there are; also without INSTRUMENT",
     offsetof(physics_options, list)},
    {"show", 0, OPTION_FLAG, NULL, NULL, NULL,
     "print the design as a file with units and comments, the way to begin a design of your own",
     offsetof(physics_options, show)},
    {"reduce", 0, OPTION_FLAG, NULL, NULL, NULL,
     "the error model by closed forms, as a table; -o MODEL.yaml writes it",
     offsetof(physics_options, reduce)},
    {"sweep", 0, OPTION_FLAG, NULL, NULL, NULL,
     "find the error model by the experiments of a laboratory and compare it with the closed "
     "forms; -o MODEL.yaml without --reduce writes what was measured",
     offsetof(physics_options, sweep)},
    {"single-axis", 0, OPTION_FLAG, NULL, NULL, NULL,
     "write a model of one instrument along x, not of three",
     offsetof(physics_options, single_axis)},
};

static const option input_option_table[] = {
    {"rate", 'r', OPTION_TEXT, "RATE", NULL, NULL,
     "angular rate about x, \"10 deg/s\", or about all axes of the case, \"1 2 3 deg/s\"",
     offsetof(physics_options, rate)},
    {"acceleration", 'a', OPTION_TEXT, "FORCE", NULL, NULL,
     "specific force along x, \"1 g\", or along all axes of the case, \"0 0 -9.81 m/s^2\"",
     offsetof(physics_options, acceleration)},
    {"sine", 0, OPTION_QUANTITY, "FREQUENCY", "Hz", NULL,
     "makes the rate or force given the amplitude of a sine", offsetof(physics_options, sine)},
    {"temperature", 't', OPTION_QUANTITY, "TEMPERATURE", "degC", NULL, "default 20degC",
     offsetof(physics_options, temperature)},
    {"temperature-rate", 0, OPTION_QUANTITY, "RATE", "degC/min", NULL,
     "lets it rise or fall from there", offsetof(physics_options, temperature_rate)},
};

static const option run_option_table[] = {
    {"duration", 'd', OPTION_QUANTITY, "TIME", "s", NULL,
     "run so long and write the log; with --view: draw the view for so long",
     offsetof(physics_options, duration)},
    {"output-rate", 0, OPTION_QUANTITY, "RATE", "Hz", NULL,
     "samples per second; default 100Hz. With --view: points per second of the view",
     offsetof(physics_options, output_rate)},
    {"level", 0, OPTION_CHOICE, "LEVEL", NULL, "full|slow",
     "the dynamics of all parts (the default), or a map or envelope without the fast part",
     offsetof(physics_options, level)},
    {"step", 0, OPTION_QUANTITY, "TIME", "s", "positive",
     "longest internal step; default: what the instrument's accuracy needs. A step that would give "
     "wrong results is refused",
     offsetof(physics_options, step)},
    {"no-noise", 0, OPTION_FLAG, NULL, NULL, NULL,
     "nothing random: no noise and no constants of the run", offsetof(physics_options, no_noise)},
    {"seed", 's', OPTION_INTEGER, "N", NULL, NULL,
     "the same seed makes the same bytes on every machine; default 1",
     offsetof(physics_options, seed)},
    {"run", 0, OPTION_INTEGER, "N", NULL, "0-4294967295",
     "another run of the same instrument: other noise, other constants of the run; default 0",
     offsetof(physics_options, run)},
    {"threads", 0, OPTION_INTEGER, "N", NULL, "1-65536",
     "threads of --sweep; default: all processors. The result does not depend on it",
     offsetof(physics_options, threads)},
};

static const option output_option_table[] = {
    {"output", 'o', OPTION_OUTPUT, "FILE", NULL, NULL,
     "the log (.csv, also .gz, .zst, or .npy; default: standard output), the model of --reduce, or "
     "the design of --show",
     offsetof(physics_options, output)},
    {"signals", 0, OPTION_OUTPUT, "FILE.csv", NULL, NULL, "write what happens inside, against time",
     offsetof(physics_options, signals)},
    {"signal-rate", 0, OPTION_QUANTITY, "RATE", "Hz", NULL,
     "rows per second of --signals; default: the output rate. Another rate is a run of its own",
     offsetof(physics_options, signal_rate)},
    {"plot", 0, OPTION_OUTPUT, "FILE.svg|.png|.pdf|term", NULL, NULL,
     "draw the outputs of the run against time (with --sine also against the input), or what "
     "--sweep found; without either, the views of the instrument",
     offsetof(physics_options, plot)},
    {"view", 0, OPTION_TEXT, "VIEW", NULL, NULL,
     "the view to --plot: its number, or how its title begins", offsetof(physics_options, view)},
    {"animate", 0, OPTION_OUTPUT, "FILE.svg", NULL, NULL,
     "draw a view of one signal against another as a picture that moves: that of --view, else the "
     "first",
     offsetof(physics_options, animate)},
    {"report", 0, OPTION_OUTPUT, "FILE.html", NULL, NULL,
     "write one self-contained page: outputs, views, design, error model",
     offsetof(physics_options, report)},
    {"json", 0, OPTION_FLAG, NULL, NULL, NULL, "print the result as JSON",
     offsetof(physics_options, json)},
};

#define GROUP(title, table)                                                                        \
    {                                                                                              \
        title, sizeof(table) / sizeof(table)[0], table, 0                                          \
    }

static int run(int count, char **words);

const verb physics_verb = {
    .name = "physics",
    .summary = "instruments from first principles: run them, reduce them to error models",
    .operands = "[INSTRUMENT|DESIGN.yaml]",
    .operands_minimum = 0,
    .operands_maximum = 1,
    .examples =
        {{"imukit physics ring_laser --rate \"10 deg/s\" --duration 10s -o out.csv",
          "ten seconds of a ring laser gyro that turns, as a log"},
         {"imukit physics mine.yaml --reduce --sweep -o model.yaml",
          "the error model of a design of your own, by closed forms beside experiments, for "
          "simulate, grade and the others"}},
    .description =
        "INSTRUMENT is a name of the list that imukit physics prints, with its default design; "
        "DESIGN.yaml is a design file (docs/design-file.md), begun with --show. Without an option "
        "the design is printed.\n\nEach row of a log is the mean over the sample that ends at its "
        "time; the input is held over a sample. x is the input axis; what y and z are stands in "
        "the documentation of each instrument. The views are drawn under the input of --rate and "
        "--acceleration, else each under an input that shows something.",
    .groups = {GROUP("What to do", task_option_table), GROUP("Input", input_option_table),
               GROUP("Running", run_option_table), GROUP("Output", output_option_table)},
    .run = run};

/* ---- checks ---------------------------------------------------------------------------------- */

static int check_tasks(const physics_options *o, const char *operand)
{
    const bool runs = !isnan(o->duration), models = o->reduce || o->sweep;
    if (o->list && operand)
        return command_misused("--list takes no instrument");
    if (!operand && !o->list && (models || o->show || runs || o->plot || o->report || o->animate))
        return command_misused("an operand is missing: imukit physics %s; imukit physics lists the "
                               "instruments",
                               physics_verb.operands);
    if (o->show && (models || runs || o->plot || o->report || o->animate || o->json))
        return command_misused("--show prints the design and nothing else");
    if (models && runs)
        return command_misused("--duration runs the instrument and --%s does not: leave one out",
                               o->reduce ? "reduce" : "sweep");
    if (o->view && (o->output || o->signals))
        return command_misused("%s: a view is drawn, not written; leave --view out to write a run",
                               o->output ? "-o" : "--signals");
    if (!runs && !o->show && !models && (o->output || o->signals))
        return command_misused("%s: there is no run to write; add --duration TIME",
                               o->output ? "-o" : "--signals");
    if (!runs && !models && !o->plot && !o->report && !o->animate && (o->rate || o->acceleration))
        return command_misused("--%s: how long? add --duration TIME",
                               o->rate ? "rate" : "acceleration");
    if (o->animate && (runs || models))
        return command_misused("--animate draws a view of the instrument: leave --%s out",
                               runs        ? "duration"
                               : o->reduce ? "reduce"
                                           : "sweep");
    if (o->view && ((!o->plot && !o->animate) || models))
        return command_misused("--view is drawn by --plot FILE or --animate FILE%s%s: add one",
                               models ? ", without --" : "",
                               !models     ? ""
                               : o->reduce ? "reduce"
                                           : "sweep");
    if (o->single_axis && !(models && o->output))
        return command_misused("--single-axis is about the model that --reduce -o MODEL.yaml "
                               "writes");
    if (models && o->signals)
        return command_misused("--signals needs a run: add --duration TIME, and leave --%s out",
                               o->reduce ? "reduce" : "sweep");
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
    const size_t length = o->animate ? strlen(o->animate) : 0;
    if (o->animate && (length < 5 || strcmp(o->animate + length - 4, ".svg") != 0))
        return command_misused("--animate %s: expected a name ending in .svg", o->animate);
    return command_check_plot(o->plot);
}

/* ---- the tasks ------------------------------------------------------------------------------- */

static const char *level_name(const physics *p)
{
    return p->settings.level == IMK_LEVEL_FULL ? "full dynamics" : "slow map";
}

static double internal_step(const physics *p)
{
    return p->settings.step > 0 ? fmin(p->settings.step, 1 / p->settings.rate)
                                : p->file.instrument->step_length(p->file.design, &p->settings);
}

static void print_run(const physics *p, const physics_run *r)
{
    static const char *const headers[] = {"output", "mean", "standard deviation", "at the end",
                                          "unit"};
    const imk_instrument *instrument = p->file.instrument;
    char length[60];
    format_duration(p->options->duration, length, sizeof length);
    printf("%s: %llu samples at %g Hz, %s, %s, internal step %.4g s\n\n",
           p->file.name[0] ? p->file.name : instrument->title, (unsigned long long)r->samples,
           p->settings.rate, length, level_name(p), internal_step(p));
    text_table table = text_table_make(5);
    table.right = 0xeu;
    text_table_row(&table);
    for (size_t c = 0; c < 5; c++)
        text_table_set(&table, c, "%s", headers[c]);
    for (size_t i = 0; i < instrument->output_count; i++) {
        const imk_unit unit = physics_output_unit(p, r, i);
        text_table_row(&table);
        text_table_set(&table, 0, "%s", instrument->outputs[i].name);
        text_table_set(&table, 1, "%.8g", (r->mean[i] - unit.offset) / unit.scale);
        if (r->samples > 1)
            text_table_set(&table, 2, "%.5g", r->deviation[i] / unit.scale);
        else
            text_table_set(&table, 2, "-");
        text_table_set(&table, 3, "%.8g", (r->last[i] - unit.offset) / unit.scale);
        text_table_set(&table, 4, "%s", strcmp(unit.text, "1") == 0 ? "" : unit.text);
    }
    text_table_print(&table, stdout);
    text_table_free(&table);
}

static json_t *inputs_json(const physics *p)
{
    const imk_exposure *e = &p->input.exposure;
    json_t *inputs =
        json_pack("{s:o, s:s, s:o, s:s, s:b, s:I}", "design", json_text(p->source), "instrument",
                  p->file.instrument->name, "output_rate", json_quantity(p->settings.rate, "Hz"),
                  "level", p->settings.level == IMK_LEVEL_FULL ? "full" : "slow", "noise",
                  p->settings.noise, "seed", (json_int_t)p->settings.seed);
    json_t *rate = json_array(), *force = json_array();
    for (int k = 0; k < 3; k++) {
        json_array_append_new(rate, json_quantity(e->angular_rate[k], "rad/s"));
        json_array_append_new(force, json_quantity(e->specific_force[k], "m/s^2"));
    }
    json_object_set_new(inputs, "rate", rate);
    json_object_set_new(inputs, "acceleration", force);
    json_object_set_new(inputs, "sine",
                        p->input.is_sine ? json_quantity(p->input.frequency, "Hz") : json_null());
    json_object_set_new(inputs, "temperature", json_quantity(e->temperature, "K"));
    return inputs;
}

static json_t *run_json(const physics *p, const physics_run *r)
{
    const imk_instrument *instrument = p->file.instrument;
    json_t *outputs = json_array();
    for (size_t i = 0; i < instrument->output_count; i++) {
        const imk_signal *signal = &instrument->outputs[i];
        json_array_append_new(outputs,
                              json_pack("{s:s, s:o, s:o, s:o}", "name", signal->name, "mean",
                                        json_quantity(r->mean[i], signal->si), "standard_deviation",
                                        json_quantity(r->deviation[i], signal->si), "at_the_end",
                                        json_quantity(r->last[i], signal->si)));
    }
    return json_pack("{s:I, s:o, s:o}", "samples", (json_int_t)r->samples, "internal_step",
                     json_quantity(internal_step(p), "s"), "outputs", outputs);
}

/* Report, JSON, table, picture of what was done. @return the exit code */
static int show(const physics *p, const physics_run *r, const physics_laboratory *l)
{
    const physics_options *o = p->options;
    int code = o->report ? physics_report(p, r, l, o->report) : -1;
    if (code < 0 && o->plot) {
        physics_figure *figure = command_memory(NULL, sizeof *figure);
        memset(figure, 0, sizeof *figure);
        size_t view = SIZE_MAX;
        bool drawn = r != NULL;
        if (r)
            physics_figure_of_run(p, r, figure);
        else if (l)
            drawn = physics_figure_of_laboratory(p, l, figure);
        else if (p->file.instrument->view_count == 0)
            code = command_failed("the %s has no views: add --duration TIME to draw its outputs",
                                  p->file.instrument->title);
        else
            code = o->view ? physics_find_view(p, &view) : -1;
        if (code < 0 && !r && !l) {
            code = physics_figure_of_view(p, view, figure);
            drawn = code < 0;
        }
        if (code < 0)
            code = drawn ? physics_draw(&figure->figure, o->plot)
                         : command_failed("nothing was measured that can be drawn");
        physics_figure_free(figure);
        free(figure);
    }
    return code;
}

static int do_run(const physics *p)
{
    const physics_options *o = p->options;
    physics_run r;
    int code = physics_run_make(p, &r);
    if (code < 0)
        physics_warn_of_run(p, &r);
    if (code < 0)
        code = show(p, &r, NULL);
    if (code < 0 && o->json)
        code = json_print("physics", inputs_json(p), run_json(p, &r), EXIT_DONE);
    else if (code < 0 && !options_stdout_taken() &&
             (o->output || o->plot || o->report || o->signals))
        print_run(p, &r);
    physics_run_free(&r);
    return code < 0 ? EXIT_DONE : code;
}

static void print_table(const char *title, text_table table)
{
    printf("%s\n", title);
    text_table_print(&table, stdout);
    text_table_free(&table);
}

static int do_model(const physics *p)
{
    const physics_options *o = p->options;
    const int sensor = p->file.instrument->sensor;
    physics_laboratory *l = o->sweep ? calloc(1, sizeof *l) : NULL;
    int code = o->sweep && !l ? command_failed("memory is exhausted") : -1;
    if (code < 0 && l)
        code = physics_laboratory_make(p, l);
    if (code < 0 && o->output)
        code = physics_write_model(p, o->reduce ? p->model : &l->result.model, o->output);
    if (code < 0)
        code = show(p, NULL, l);
    if (code < 0 && o->json) {
        json_t *result = json_pack("{s:o}", "reduced", physics_model_json(p->model, sensor));
        if (l)
            json_object_set_new(result, "experiment", physics_sweep_json(p, l));
        code = json_print("physics", inputs_json(p), result, EXIT_DONE);
    } else if (code < 0 && !options_stdout_taken()) {
        if (o->reduce)
            print_table("Error model by closed forms, one axis",
                        physics_model_table(p->model, sensor));
        if (l)
            print_table(o->reduce ? "\nClosed forms against experiments"
                                  : "Closed forms against experiments",
                        physics_sweep_table(p, l));
    }
    free(l);
    return code < 0 ? EXIT_DONE : code;
}

static int do_task(const physics *p)
{
    const physics_options *o = p->options;
    if (o->show)
        return physics_show(p);
    if (o->reduce || o->sweep)
        return do_model(p);
    if (!isnan(o->duration))
        return do_run(p);
    if (o->plot || o->report || o->animate) {
        int code = show(p, NULL, NULL);
        if (code < 0 && o->animate)
            code = physics_animate(p, o->animate);
        if (code < 0 && o->json)
            code = physics_overview(p);
        return code < 0 ? EXIT_DONE : code;
    }
    return physics_overview(p);
}

/* ---- the verb -------------------------------------------------------------------------------- */

/* The instrument that the table of grades calls so: "fog" is the fibre-optic gyro. */
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
    physics p = {.options = o, .source = operand, .settings = imk_physics_settings_default()};
    p.settings.level = o->level == 0 ? IMK_LEVEL_FULL : IMK_LEVEL_SLOW;
    p.settings.rate = o->output_rate;
    p.settings.step = o->step;
    p.settings.noise = !o->no_noise;
    p.settings.seed = o->seed.value;
    p.settings.run = (uint32_t)o->run.value;
    int code = open_design(&p);
    if (code < 0)
        code = physics_input_make(o, &p.input);
    p.model = code < 0 ? malloc(sizeof *p.model) : NULL;
    if (code < 0 && !p.model)
        code = command_failed("memory is exhausted");
    if (code < 0) {
        p.file.instrument->reduce(p.file.design, p.model);
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
    code = check_tasks(&o, operands[0]);
    if (code < 0)
        code = check_numbers(&o);
    if (code >= 0)
        return code;
    return operands[0] ? start(&o, operands[0]) : physics_list(&o);
}
