/* SPDX-License-Identifier: Apache-2.0 */
/* imukit grade: the class of a model, by its biases and by the errors of position that all its
 * terms make, and where it stands among others. */
#include "grade_parts.h"

#include <stdlib.h>
#include <string.h>

typedef struct grade_options {
    bool json;
    const char *plot, *report;
    int map; /* in the order of the choices */
} grade_options;

static const option grade_option_table[] = {
    {"plot", 0, OPTION_OUTPUT, "FILE.svg|.png|.pdf|term", NULL, NULL,
     "draw the maps: stability of bias against that of scale factor, of gyros and of "
     "accelerometers, and cost against performance",
     offsetof(grade_options, plot)},
    {"map", 0, OPTION_CHOICE, "WHICH", NULL, "all|gyro|accel|cost",
     "the one to draw; default: all, with --plot term gyro", offsetof(grade_options, map)},
    {"report", 0, OPTION_OUTPUT, "FILE.html", NULL, NULL, "write one self-contained page",
     offsetof(grade_options, report)},
    {"json", 0, OPTION_FLAG, NULL, NULL, NULL, "print as JSON", offsetof(grade_options, json)},
};

static int run(int count, char **words);

const verb grade_verb = {
    .name = "grade",
    .summary = "class of a model by its biases and by computed performance, and what limits it",
    .operands = "MODEL...",
    .operands_minimum = 1,
    .operands_maximum = GRADE_MODELS_MAX,
    .examples = {{"imukit grade model.yaml", "the class of an identified model"},
                 {"imukit grade model.yaml HG1700 navigation --report grade.html",
                  "beside a device of the catalogue and a class, with maps"}},
    .description =
        "By the table, what counts is the bias that stays after calibration: the root sum of "
        "squares of repeatability, instability and the uncertainty of the fixed bias, on the worst "
        "axis. The class of the unit is the worse of its gyro and its accelerometer class.\n\nBy "
        "performance, what counts is the error of position that all terms of the model make, as "
        "imukit drift computes it: at rest at 45 deg N, with a perfect attitude at the start, and "
        "with one that the unit finds itself. What a class claims stands beside what is computed.",
    .groups = {{"Options", sizeof grade_option_table / sizeof grade_option_table[0],
                grade_option_table, 0}},
    .run = run};

static int open_models(const char **operands, grade_result *r)
{
    int code = -1;
    for (size_t m = 0; m < GRADE_MODELS_MAX && operands[m] && code < 0; m++) {
        grade_case *one = &r->cases[m];
        one->operand = operands[m];
        one->model = command_memory(NULL, sizeof *one->model);
        r->count = m + 1;
        code = command_model(operands[m], one->model, NULL);
        if (code < 0)
            code = grade_analyse(one);
        if (code < 0 && !one->table.limiting[0] && !one->has_position)
            code = command_failed("%s states no bias repeatability, no bias instability and no "
                                  "uncertainty of the fixed bias: there is nothing to grade",
                                  operands[m]);
    }
    return code;
}

static int show(const grade_result *r, const grade_options *o)
{
    /* A terminal has room for one map. */
    const int all = o->plot && strcmp(o->plot, "term") == 0 ? GRADE_MAP_GYRO : GRADE_MAPS;
    const int map = o->map > 0 ? o->map - 1 : all;
    const bool stands = grade_stands(r, map);
    imk_result *result = show_begin("grade");
    grade_show(r, map, result);
    const int code = show_end(
        result,
        &(show_options){.report = o->report, .plot = stands ? o->plot : NULL, .json = o->json},
        EXIT_DONE);
    return code == EXIT_DONE && o->plot && !stands
               ? command_failed("--map: nothing of the model stands on this map")
               : code;
}

static int run(int count, char **words)
{
    grade_options o = {0};
    const char *operands[GRADE_MODELS_MAX + 1] = {NULL};
    int code = options_parse(&grade_verb, count, words, &o, operands);
    if (code < 0)
        code = command_check_plot(o.plot);
    if (code < 0 && o.map > 0 && !o.plot)
        code = command_misused("--map is of a drawing: add --plot FILE.svg");
    if (code >= 0)
        return code;
    grade_result *r = command_zeroed(sizeof *r);
    code = open_models(operands, r);
    if (code < 0)
        code = show(r, &o);
    for (size_t m = 0; m < r->count; m++) {
        list_free(&r->cases[m].omitted);
        free(r->cases[m].model);
    }
    free(r);
    return code;
}
