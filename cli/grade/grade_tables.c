/* SPDX-License-Identifier: Apache-2.0 */
/* A grade as tables and sentences. */
#include "grade_parts.h"

#include <math.h>
#include <string.h>

const char grade_assumption[] =
    "Computed by covariance from all terms of the model: at rest at 45 deg N, level, 100 Hz, the "
    "height held by other means, position and velocity perfect at the start. CEP is the radius of "
    "the circle that holds half of all outcomes.";

/* With a heading that is off by more than this there is none. */
static const double no_north = 1; /* [rad] */

/* ---- sentences ---- */

void grade_bias_sentence(const grade_case *one, bool gyro, char *text, size_t size)
{
    const char *unit_text = gyro ? "deg/h" : "ug", *sensor = gyro ? "Gyro" : "Accelerometer";
    const double scale = imk_unit_of(unit_text).scale;
    const double bias = gyro ? one->table.gyro_bias : one->table.accel_bias;
    const imk_grade grade = gyro ? one->table.gyro : one->table.accel;
    if (!(gyro ? one->model->gyro : one->model->accel).present) {
        text[0] = '\0';
        return;
    }
    if (isnan(bias)) {
        snprintf(text, size,
                 "%s: the model states neither repeatability nor instability of the bias", sensor);
        return;
    }
    const imk_grade_row *row = imk_grade_table(grade);
    const imk_grade_row *better =
        grade > IMK_GRADE_STRATEGIC ? imk_grade_table((imk_grade)((int)grade - 1)) : NULL;
    char allows[80] = "", needs[80] = "", number[DRIFT_TEXT];
    if (row)
        snprintf(allows, sizeof allows, ", the class allows %.6g",
                 (gyro ? row->gyro_bias_limit : row->accel_bias_limit) / scale);
    if (better)
        snprintf(needs, sizeof needs, "; the next better class, %s, needs %.6g", better->name,
                 (gyro ? better->gyro_bias_limit : better->accel_bias_limit) / scale);
    snprintf(text, size, "%s: %s; remaining bias %s %s%s%s", sensor, grade_name(grade),
             drift_number(bias / scale, number), unit_text, allows, needs);
}

void grade_position_sentence(const grade_case *one, char *text, size_t size)
{
    if (!one->has_position) {
        snprintf(text, size, "Position: not computed; %s", one->no_position);
        return;
    }
    const grade_position *p = &one->way[GRADE_GIVEN];
    char hour[DRIFT_TEXT], day[DRIFT_TEXT];
    if (p->validity[GRADE_HOUR] == DRIFT_LOST)
        snprintf(text, size,
                 "Position: below every class that claims one; no longer a position after 1 h");
    else if (p->validity[GRADE_DAY] == DRIFT_LOST)
        snprintf(text, size, "Position: %s; CEP %s after 1 h, no longer a position after 24 h",
                 grade_name(p->grade), grade_length(p->cep[GRADE_HOUR], hour));
    else
        snprintf(text, size, "Position: %s; CEP %s after 1 h, %s after 24 h", grade_name(p->grade),
                 grade_length(p->cep[GRADE_HOUR], hour), grade_length(p->cep[GRADE_DAY], day));
}

void grade_share_sentence(const grade_case *one, char *text, size_t size)
{
    size_t used = 0;
    text[0] = '\0';
    for (size_t i = 0; i < one->share_count && used + 1 < size; i++) {
        const grade_share *s = &one->share[i];
        const int more = snprintf(text + used, size - used, "%s%s %.0f %%",
                                  i == 0 ? "What makes it after 1 h, by variance: " : ", ", s->text,
                                  100 * s->value);
        used += more > 0 ? (size_t)more : 0;
    }
    if (one->shifted && used + 1 < size)
        snprintf(text + used, size - used,
                 "%sMost of it is no scatter but a shift by known values, which compensation takes "
                 "out",
                 used > 0 ? ". " : "");
}

void grade_need_sentence(const grade_case *one, char *text, size_t size)
{
    const imk_grade_row *row = imk_grade_table(one->next);
    size_t used = 0;
    text[0] = '\0';
    if (!row || !one->has_position || !(one->next_all > 0))
        return;
    int more = snprintf(
        text, size, "For %s (%s) every term would have to be %.3g times smaller", row->name,
        isinf(row->position_limit) ? "a position at all after 1 h" : row->position_performance,
        1 / one->next_all);
    used += more > 0 ? (size_t)more : 0;
    for (size_t i = 0; i < one->need_count && used + 1 < size; i++) {
        more = snprintf(text + used, size - used, "%s%s %.3g times", i == 0 ? "; or only " : ", ",
                        one->need[i].text, one->need[i].value);
        used += more > 0 ? (size_t)more : 0;
    }
    if (one->need_more > 0 && used + 1 < size)
        snprintf(text + used, size - used, ", and %zu more", one->need_more);
}

/* ---- claims beside figures ---- */

/* The computed figure that answers a claim. */
static void set_answer(text_table *table, const grade_case *one, const imk_grade_row *row)
{
    char length[DRIFT_TEXT];
    if (!one->has_position || isnan(row->position_time)) {
        text_table_set(table, 3, "-");
        return;
    }
    const size_t time = row->position_time > grade_time[GRADE_HOUR] ? GRADE_DAY : GRADE_HOUR;
    const double cep = one->way[GRADE_GIVEN].cep[time];
    if (isnan(cep))
        text_table_set(table, 3, "no position");
    else
        text_table_set(table, 3, "%s%s", grade_length(cep, length),
                       cep <= row->position_limit * (1 + 1e-9) ? ", met" : "");
}

static const char *met(imk_grade grade, double bias, int row)
{
    return isnan(bias) || (int)grade > row ? "" : ", met";
}

text_table grade_class_table(const grade_case *one)
{
    static const char *const headers[] = {
        "",          "class",      "claimed",           "computed", "gyro [deg/h]",
        "gyros are", "accel [ug]", "accelerometers are"};
    enum { COLUMNS = sizeof headers / sizeof headers[0] };
    text_table table = text_table_make(COLUMNS);
    text_table_row(&table);
    for (size_t c = 0; c < COLUMNS; c++)
        text_table_set(&table, c, "%s", headers[c]);
    for (int g = 0; g < IMK_GRADE_NONE; g++) {
        const imk_grade_row *row = imk_grade_table((imk_grade)g);
        text_table_row(&table);
        text_table_set(&table, 0, "%s",
                       one->table.limiting[0] && (int)one->table.overall == g ? "->" : "");
        text_table_set(&table, 1, "%s", row->name);
        text_table_set(&table, 2, "%s", row->position_performance);
        set_answer(&table, one, row);
        text_table_set(&table, 4, "%.4g%s", row->gyro_bias_limit / imk_unit_of("deg/h").scale,
                       met(one->table.gyro, one->table.gyro_bias, g));
        text_table_set(&table, 5, "%s", row->gyro_technology);
        text_table_set(&table, 6, "%.6g%s", row->accel_bias_limit / imk_unit_of("ug").scale,
                       met(one->table.accel, one->table.accel_bias, g));
        text_table_set(&table, 7, "%s", row->accel_technology);
    }
    return table;
}

/* ---- errors of position ---- */

static bool finds_north(const grade_position *p, int way)
{
    const bool self = way == GRADE_SELF || way == GRADE_SELF_COMPENSATED;
    return !(self && p->figures[GRADE_MINUTE].heading > no_north);
}

text_table grade_position_table(const grade_case *one)
{
    static const char *const headers[] = {"CEP after",  "1 min",         "1 h",  "24 h",
                                          "tilt (1 h)", "heading (1 h)", "class"};
    static const char *const names[GRADE_WAYS] = {
        "attitude perfect at the start", "self-aligned, 5 min at rest",
        "perfect start, compensated", "self-aligned, compensated"};
    enum { COLUMNS = sizeof headers / sizeof headers[0] };
    text_table table = text_table_make(one->has_position ? COLUMNS : 0);
    if (!one->has_position)
        return table;
    table.right = (1u << (COLUMNS - 1)) - 2;
    text_table_row(&table);
    for (size_t c = 0; c < COLUMNS; c++)
        text_table_set(&table, c, "%s", headers[c]);
    for (int way = 0; way < (one->compensation_matters ? GRADE_WAYS : 2); way++) {
        const grade_position *p = &one->way[way];
        char text[DRIFT_TEXT];
        text_table_row(&table);
        text_table_set(&table, 0, "%s", names[way]);
        if (!finds_north(p, way)) {
            text_table_set(&table, 1, "no north");
            continue;
        }
        for (size_t t = 0; t < GRADE_TIMES; t++)
            text_table_set(&table, 1 + t, "%s%s",
                           p->validity[t] == DRIFT_LOST ? "no position"
                                                        : grade_length(p->cep[t], text),
                           p->validity[t] == DRIFT_ROUGH ? " ~" : "");
        if (p->validity[GRADE_HOUR] != DRIFT_LOST) {
            text_table_set(&table, 4, "%s", drift_angle(p->figures[GRADE_HOUR].tilt, text));
            text_table_set(&table, 5, "%s", drift_angle(p->figures[GRADE_HOUR].heading, text));
        }
        text_table_set(&table, 6, "%s",
                       p->grade == IMK_GRADE_NONE ? "none claims it" : grade_name(p->grade));
    }
    return table;
}

/* Without the bias that differs from run to run the figures are those of a better sensor. */
static bool states_repeatability(const imk_triad *triad)
{
    for (int i = 0; i < triad->axis_count; i++)
        if (triad->bias.repeatability.value[i] > 0 || triad->bias.fixed.sigma[i] > 0)
            return true;
    return false;
}

void grade_flattery_sentence(const grade_case *one, char *text, size_t size)
{
    const bool gyro = states_repeatability(&one->model->gyro);
    const bool accel = states_repeatability(&one->model->accel);
    text[0] = '\0';
    if (one->has_position && !(gyro && accel))
        snprintf(text, size,
                 "The model states no run-to-run bias of its %s: class and errors of "
                 "position flatter it.",
                 gyro    ? "accelerometers"
                 : accel ? "gyros"
                         : "gyros and accelerometers");
}

static bool any_rough(const grade_case *one)
{
    for (int way = 0; one->has_position && way < GRADE_WAYS; way++)
        for (size_t t = 0; t < GRADE_TIMES; t++)
            if (one->way[way].validity[t] == DRIFT_ROUGH && finds_north(&one->way[way], way))
                return true;
    return false;
}

/* ---- several models ---- */

static void set_value(text_table *table, size_t column, double value, const char *unit)
{
    char text[DRIFT_TEXT];
    const imk_unit of = imk_unit_of(unit);
    text_table_set(table, column, "%s", isnan(value) ? "-" : drift_in_unit(value, &of, text));
}

text_table grade_comparison_table(const grade_result *r)
{
    static const char *const headers[] = {
        "model",    "by biases", "by position",  "CEP 1 min",  "CEP 1 h",
        "CEP 24 h", "gyro bias", "scale factor", "accel bias", "scale factor"};
    enum { COLUMNS = sizeof headers / sizeof headers[0] };
    text_table table = text_table_make(r->count > 1 ? COLUMNS : 0);
    if (r->count < 2)
        return table;
    text_table_row(&table);
    for (size_t c = 0; c < COLUMNS; c++)
        text_table_set(&table, c, "%s", headers[c]);
    for (size_t m = 0; m < r->count; m++) {
        const grade_case *one = &r->cases[m];
        const grade_position *p = &one->way[GRADE_GIVEN];
        char text[DRIFT_TEXT];
        text_table_row(&table);
        text_table_set(&table, 0, "%.40s", one->operand);
        text_table_set(&table, 1, "%s",
                       one->table.limiting[0] ? grade_name(one->table.overall) : "-");
        text_table_set(&table, 2, "%s",
                       !one->has_position           ? "-"
                       : p->grade == IMK_GRADE_NONE ? "none claims it"
                                                    : grade_name(p->grade));
        for (size_t t = 0; t < GRADE_TIMES; t++)
            text_table_set(&table, 3 + t, "%s",
                           !one->has_position             ? "-"
                           : p->validity[t] == DRIFT_LOST ? "no position"
                                                          : grade_length(p->cep[t], text));
        set_value(&table, 6, one->table.gyro_bias, "deg/h");
        set_value(&table, 7, one->gyro_scale, "ppm");
        set_value(&table, 8, one->table.accel_bias, "ug");
        set_value(&table, 9, one->accel_scale, "ppm");
    }
    return table;
}

/* ---- all ---- */

static void print_line(const char *text)
{
    if (text[0])
        printf("%s\n", text);
}

static void print_case(const grade_case *one)
{
    const char *bold = command_color(stdout, COLOR_BOLD),
               *reset = command_color(stdout, COLOR_RESET);
    char text[600];
    snprintf(text, sizeof text, "%s", one->model->name[0] ? one->model->name : one->operand);
    command_clean(text);
    printf("%s: %s%s%s\n", text, bold,
           one->table.limiting[0] ? grade_name(one->table.overall) : "no biases stated", reset);
    for (int gyro = 1; gyro >= 0; gyro--) {
        grade_bias_sentence(one, gyro == 1, text, sizeof text);
        print_line(text);
    }
    if (one->table.limiting[0])
        printf("The class is decided by the %s.\n", one->table.limiting);
    grade_position_sentence(one, text, sizeof text);
    print_line(text);
    grade_share_sentence(one, text, sizeof text);
    print_line(text);
    grade_need_sentence(one, text, sizeof text);
    print_line(text);
    drift_print_table(grade_class_table(one));
    if (!one->has_position)
        return;
    drift_print_table(grade_position_table(one));
    printf("\n%s\n", grade_assumption);
    if (any_rough(one))
        printf("~ The errors of attitude are too large for the linear theory.\n");
    grade_flattery_sentence(one, text, sizeof text);
    print_line(text);
    if (!one->compensation_matters)
        printf("The model holds no known value that compensation would take out.\n");
    if (one->omitted[0])
        printf("Not in these figures: %s.\n", one->omitted);
}

void grade_print(const grade_result *r)
{
    for (size_t m = 0; m < r->count; m++) {
        if (m > 0)
            putchar('\n');
        print_case(&r->cases[m]);
    }
    if (r->count > 1)
        drift_print_table(grade_comparison_table(r));
}
