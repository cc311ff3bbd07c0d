/* SPDX-License-Identifier: Apache-2.0 */
/* imukit grade: the class of a model, by its biases and by the errors of position that all its
 * terms make, and where it stands among others. */
#include "shell/show.h"

#include "imukit/show.h"

#include <stdlib.h>
#include <string.h>

enum { MODELS_MAX = 8 };

typedef struct grade_options {
    bool json;
    const char *plot, *report;
    int map, assume_class; /* in the order of the choices */
} grade_options;

#define AT(field) offsetof(grade_options, field)

static const option grade_option_table[] = {
    PLOT_OPTION(AT(plot), "draw the maps: bias stability against scale factor stability for gyros "
                          "and for accelerometers, prices of units and of single gyros"),
    {"map", OPTION_CHOICE, AT(map), .value = "WHICH", .choices = "all|gyro|accel|cost|sensor-cost",
     .help = "the map to draw; default: all, but gyro with --plot term"},
    ASSUME_CLASS_OPTION(AT(assume_class)),
    REPORT_OPTION(AT(report), "write one self-contained page"),
    JSON_OPTION(AT(json), "print as JSON"),
};

/* What the library is given, and what it gives. */
typedef struct grading {
    size_t count;
    imk_model *model[MODELS_MAX];
    imk_graded *graded[MODELS_MAX];
    imk_unstated assumed[MODELS_MAX];
    const char *name[MODELS_MAX + 1];
} grading;

static int grade(grading *g, int assume_class)
{
    int code = -1;
    for (size_t m = 0; g->name[m] && code < 0; m++) {
        imk_error error;
        char text[200];
        g->model[m] = command_memory(NULL, sizeof *g->model[m]);
        g->count = m + 1;
        code = command_model(g->name[m], g->model[m], NULL);
        if (code < 0 && assume_class)
            imk_model_assume_class(g->model[m], options_assumed_class(assume_class),
                                   &g->assumed[m]);
        if (code >= 0 || imk_grade_run(g->model[m], NULL, &g->graded[m], &error) == IMK_OK)
            continue;
        const imk_finding *why =
            g->graded[m] ? imk_findings_failure(&g->graded[m]->findings) : NULL;
        if (why)
            imk_finding_text(why, text, sizeof text);
        code = why ? command_failed_by(imk_finding_code(why), &error, g->name[m], "%s %s",
                                       g->name[m], text)
                   : command_error(&error, g->name[m]);
    }
    return code;
}

static int show(const grading *g, const grade_options *o)
{
    const imk_graded *graded[MODELS_MAX];
    const imk_graded_several several = {g->count, graded, g->name,
                                        o->assume_class ? g->assumed : NULL};
    for (size_t m = 0; m < g->count; m++)
        graded[m] = g->graded[m];
    /* A terminal has room for one map. */
    const imk_grade_map all =
        o->plot && strcmp(o->plot, "term") == 0 ? IMK_GRADE_MAP_GYRO : IMK_GRADE_MAPS;
    const imk_grade_map map = o->map > 0 ? (imk_grade_map)(o->map - 1) : all;
    const bool stands = imk_grade_stands(&several, map);
    imk_result *result = show_begin("grade");
    imk_show_grade(&several, map, result);
    imk_result_for(result, IMK_FOR_PAGE);
    for (size_t m = 0; m < g->count; m++)
        show_model(result, g->name[m], g->model[m]);
    show_origin(result);
    const int code = o->plot && !stands
                         ? command_failed("--map: the model has no value for this map")
                         : EXIT_DONE;
    return show_end(
        result,
        &(show_options){.report = o->report, .plot = stands ? o->plot : NULL, .json = o->json},
        code);
}

static int run(int count, char **words)
{
    grade_options o = {0};
    grading g = {0};
    int code = options_parse(&grade_verb, count, words, &o, g.name);
    if (code < 0)
        code = command_check_plot(o.plot);
    if (code < 0 && o.map > 0 && !o.plot)
        code = command_misused("--map selects a drawing; add --plot FILE.svg");
    if (code < 0)
        code = grade(&g, o.assume_class);
    if (code < 0)
        code = show(&g, &o);
    for (size_t m = 0; m < g.count; m++) {
        imk_graded_free(g.graded[m]);
        free(g.model[m]);
    }
    return code;
}

const verb grade_verb = {
    .name = "grade",
    .summary =
        "class of a model by its biases and by computed performance, and the terms that limit it",
    .operands = "MODEL...",
    .operands_minimum = 1,
    .operands_maximum = MODELS_MAX,
    .examples = {{"imukit grade model.yaml", "the class of an identified model"},
                 {"imukit grade model.yaml HG1700 navigation --report grade.html",
                  "compared with a device of the catalogue and a class, with maps"}},
    .description =
        "By the table, the class depends on the bias that remains after calibration: the root sum "
        "of squares of repeatability, instability and the uncertainty of the fixed bias, on the "
        "worst axis. The class of the unit is the worse of its gyro and its accelerometer "
        "class.\n\nBy performance, the class depends on the position error that all terms of the "
        "model cause, as imukit drift computes it: at rest at 45 deg N, with a perfect attitude at "
        "the start, and with an attitude that the unit finds itself. The claim of each class is "
        "shown beside the computed error.",
    .groups = {OPTION_GROUP("Options", grade_option_table, 0)},
    .run = run};
