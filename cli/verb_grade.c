/* SPDX-License-Identifier: Apache-2.0 */
/* imukit grade: the class of a model by its biases, and why. */
#include "json_output.h"
#include "text_table.h"

#include "imukit/model_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct grade_options {
    bool json;
} grade_options;

static const option grade_option_table[] = {
    {"json", 0, OPTION_FLAG, NULL, NULL, NULL, "print as JSON", offsetof(grade_options, json)},
};

static int run(int count, char **words);

const verb grade_verb = {
    .name = "grade",
    .summary = "class of a model among the five, and on which term it falls short",
    .operands = "MODEL",
    .operands_minimum = 1,
    .operands_maximum = 1,
    .examples = {{"imukit grade model.yaml", "the class of an identified model"},
                 {"imukit grade HG1700", "the class of a device of the catalogue"}},
    .description =
        "Compared is the bias that stays after calibration: the root sum of squares of "
        "repeatability, instability and the uncertainty of the fixed bias, on the worst axis. The "
        "class of the unit is the worse of its gyro and its accelerometer class.",
    .groups = {{"Options", 1, grade_option_table, 0}},
    .run = run};

static const char *grade_name(imk_grade grade)
{
    const imk_grade_row *row = imk_grade_table(grade);
    return row ? row->name : "below every class";
}

static void describe_bias(const char *sensor, double bias, imk_grade grade, const char *unit_text)
{
    double scale = imk_unit_of(unit_text).scale;
    if (isnan(bias)) {
        printf("%s: the model states neither repeatability nor instability of the bias\n", sensor);
        return;
    }
    const imk_grade_row *row = imk_grade_table(grade);
    bool gyro = strcmp(sensor, "Gyro") == 0;
    printf("%s: %s; remaining bias %.3g %s", sensor, grade_name(grade), bias / scale, unit_text);
    if (row)
        printf(", the class allows %.6g",
               (gyro ? row->gyro_bias_limit : row->accel_bias_limit) / scale);
    if (grade > IMK_GRADE_STRATEGIC) {
        const imk_grade_row *better =
            imk_grade_table((imk_grade)((grade == IMK_GRADE_NONE ? IMK_GRADE_NONE : grade) - 1));
        double limit = (gyro ? better->gyro_bias_limit : better->accel_bias_limit) / scale;
        printf("; the next better class, %s, needs %.6g", better->name, limit);
    }
    putchar('\n');
}

static void print_table(imk_grade overall)
{
    text_table table = text_table_make(7);
    static const char *const headers[] = {"",          "class",      "position",          "gyro",
                                          "gyros are", "accel [ug]", "accelerometers are"};
    text_table_row(&table);
    for (size_t c = 0; c < 7; c++)
        text_table_set(&table, c, "%s", headers[c]);
    text_table_set(&table, 3, "gyro [deg/h]");
    for (int g = 0; g < IMK_GRADE_NONE; g++) {
        const imk_grade_row *row = imk_grade_table((imk_grade)g);
        text_table_row(&table);
        text_table_set(&table, 0, "%s", (int)overall == g ? "->" : "");
        text_table_set(&table, 1, "%s", row->name);
        text_table_set(&table, 2, "%s", row->position_performance);
        text_table_set(&table, 3, "%.4g", row->gyro_bias_limit / imk_unit_of("deg/h").scale);
        text_table_set(&table, 4, "%s", row->gyro_technology);
        text_table_set(&table, 5, "%.6g", row->accel_bias_limit / imk_unit_of("ug").scale);
        text_table_set(&table, 6, "%s", row->accel_technology);
    }
    text_table_print(&table, stdout);
    text_table_free(&table);
}

static int print_json(const char *name, const imk_grade_result *result)
{
    bool known = result->limiting && result->limiting[0];
    const imk_grade_row *row = imk_grade_table(result->overall);
    json_t *found = json_pack(
        "{s:o, s:o, s:o, s:o, s:o, s:s, s:o}", "overall",
        known ? json_string(grade_name(result->overall)) : json_null(), "gyro",
        isnan(result->gyro_bias) ? json_null() : json_string(grade_name(result->gyro)), "accel",
        isnan(result->accel_bias) ? json_null() : json_string(grade_name(result->accel)),
        "gyro_bias", json_quantity(result->gyro_bias, "rad/s"), "accel_bias",
        json_quantity(result->accel_bias, "m/s^2"), "limiting", result->limiting,
        "position_performance",
        known && row ? json_string(row->position_performance) : json_null());
    return json_print("grade", json_pack("{s:s}", "model", name), found, EXIT_DONE);
}

static void print_text(const imk_model *model, const char *name, const imk_grade_result *result)
{
    const char *bold = command_color(stdout, COLOR_BOLD),
               *reset = command_color(stdout, COLOR_RESET);
    printf("%s: %s%s%s\n", model->name[0] ? model->name : name, bold, grade_name(result->overall),
           reset);
    if (model->gyro.present)
        describe_bias("Gyro", result->gyro_bias, result->gyro, "deg/h");
    if (model->accel.present)
        describe_bias("Accelerometer", result->accel_bias, result->accel, "ug");
    printf("The class is decided by the %s.\n\n", result->limiting);
    print_table(result->overall);
    printf("\nThe position performance is the table's claim for the class, not computed from this "
           "model.\n");
}

static int run(int count, char **words)
{
    grade_options o = {0};
    const char *operands[OPERANDS_MAX];
    int code = options_parse(&grade_verb, count, words, &o, operands);
    if (code >= 0)
        return code;
    imk_model *model = malloc(sizeof *model);
    if (!model)
        return command_failed("memory is exhausted");
    code = command_model(operands[0], model, NULL);
    if (code < 0) {
        imk_grade_result result = imk_grade_model(model);
        if (!result.limiting[0])
            code = command_failed("%s states no bias repeatability, no bias instability and no "
                                  "uncertainty of the fixed bias: there is nothing to grade",
                                  operands[0]);
        else if (o.json)
            code = print_json(operands[0], &result);
        else
            print_text(model, operands[0], &result);
        if (code < 0)
            code = EXIT_DONE;
    }
    free(model);
    return code;
}
