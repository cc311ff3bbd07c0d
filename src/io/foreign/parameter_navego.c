/* SPDX-License-Identifier: Apache-2.0 */
/* NaveGo: assignments to a structure in a MATLAB script, such as
 *
 *     ADIS16405.arw = 2 .* ones(1,3);     % [deg/root-hour]
 *
 * with the units of its imu_si_errors.m: arw [deg/sqrt(h)], vrw [m/s/sqrt(h)], arrw
 * [deg/sqrt(h)/s], vrrw [m/s/sqrt(h)/s], gb_sta and gb_dyn [deg/s], ab_sta and ab_dyn [mg], gb_corr
 * and ab_corr [s], freq [Hz]. *_dyn and *_corr are sigma and time of a Gauss-Markov process; with
 * an infinite time noise_b_dyn.m draws white noise. */
#include "parameter_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const struct field {
    const char *name;
    imki_quantity quantity;
    imki_unit unit;
} fields[2][5] = {{{"arw", IMKI_WHITE, {"deg/sqrt(h)", 2.908882086657216e-04}}, /* pi/180/60 */
                   {"arrw", IMKI_RANDOM_WALK, {"deg/sqrt(h)/s", 2.908882086657216e-04}},
                   {"gb_sta", IMKI_BIAS, {"deg/s", 0.017453292519943295}},
                   {"gb_dyn", IMKI_DRIFT, {"deg/s", 0.017453292519943295}},
                   {"gb_corr", IMKI_TIME, {"s", 1}}},
                  {{"vrw", IMKI_WHITE, {"m/s/sqrt(h)", 1.0 / 60}},
                   {"vrrw", IMKI_RANDOM_WALK, {"m/s/sqrt(h)/s", 1.0 / 60}},
                   {"ab_sta", IMKI_BIAS, {"mg", 9.80665e-3}},
                   {"ab_dyn", IMKI_DRIFT, {"mg", 9.80665e-3}},
                   {"ab_corr", IMKI_TIME, {"s", 1}}}};
enum { FIELDS = 5, NAME_SIZE = 40 };

/* What is read of the structure in question. */
typedef struct script {
    imki_variables variables;
    char structure[NAME_SIZE]; /* "" before the first */
    char others[96];           /* names of all structures, for the message */
    int structure_count;
    double si[2][FIELDS][3];
    bool seen[2][FIELDS];
    imki_place place[2][FIELDS];
    double rate;
} script;

static bool is_name_letter(char c, bool first)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' ||
           (!first && c >= '0' && c <= '9');
}

static const char *skip_blanks(const char *at, const char *end)
{
    while (at < end && (*at == ' ' || *at == '\t'))
        at++;
    return at;
}

static const char *take_name(const char *at, const char *end, char *name)
{
    size_t length = 0;
    while (at < end && is_name_letter(*at, length == 0) && length + 1 < NAME_SIZE)
        name[length++] = *at++;
    name[length] = '\0';
    return at;
}

/* The end of a statement: a semicolon or a comment; not within brackets. */
static const char *statement_end(const char *at, const char *end)
{
    int depth = 0;
    for (; at < end; at++) {
        depth += (*at == '[' || *at == '(') - (*at == ']' || *at == ')');
        if (*at == '%' || *at == '#' || (*at == ';' && depth <= 0))
            break;
    }
    return at;
}

static bool find_field(const char *name, int *kind, int *index)
{
    for (int i = 0; i < 2 * FIELDS; i++)
        if (strcmp(name, fields[i / FIELDS][i % FIELDS].name) == 0) {
            *kind = i / FIELDS;
            *index = i % FIELDS;
            return true;
        }
    return false;
}

static void add_structure(script *s, const char *name)
{
    char listed[NAME_SIZE + 4];
    snprintf(listed, sizeof listed, "%s ", name);
    if (strstr(s->others, listed))
        return;
    size_t length = strlen(s->others);
    snprintf(s->others + length, sizeof s->others - length, "%s", listed);
    s->structure_count++;
}

/* structure.name = expression */
static void take_field(imki_parameters *p, script *s, const char *structure, const char *name,
                       imki_place place, const char *begin, const char *end)
{
    int kind = 0, index = 0, length;
    double value[3];
    const char *stop;
    bool is_rate = strcmp(name, "freq") == 0;
    bool is_known = find_field(name, &kind, &index);
    if (is_known)
        add_structure(s, structure);
    if (p->settings->sensor && strcmp(p->settings->sensor, structure) != 0)
        return;
    bool good = imki_expression(begin, end, &s->variables, &length, value, &stop);
    if (is_rate && good && length == 1 && value[0] > 0 && isfinite(value[0]))
        s->rate = value[0];
    if (!is_known) {
        if (!is_rate)
            imki_note(p, true, "%s.%s (line %zu) is not read", structure, name, place.line);
        return;
    }
    place.field = fields[kind][index].name;
    if (!good) {
        char found[64];
        snprintf(found, sizeof found, "%.*s", (int)(end - begin > 60 ? 60 : end - begin), begin);
        place.column += (size_t)(stop - begin);
        imki_parameter_refuse_at(p, place, IMK_ERROR_SYNTAX, found,
                                 "one number or three: 2, [1 2 3], 2 .* ones(1,3)");
        return;
    }
    s->seen[kind][index] = true;
    s->place[kind][index] = place;
    snprintf(s->structure, sizeof s->structure, "%s", structure);
    imki_accept(p, place, kind, fields[kind][index].quantity, value, fields[kind][index].unit,
                s->si[kind][index]);
}

static void take_variable(script *s, const char *name, const char *begin, const char *end)
{
    int length;
    double value[3];
    const char *stop;
    if (strlen(name) >= sizeof s->variables.variable[0].name ||
        s->variables.count == IMKI_VARIABLES_MAX ||
        !imki_expression(begin, end, &s->variables, &length, value, &stop))
        return;
    size_t i = 0;
    while (i < s->variables.count && strcmp(s->variables.variable[i].name, name) != 0)
        i++;
    snprintf(s->variables.variable[i].name, sizeof s->variables.variable[i].name, "%.31s", name);
    s->variables.variable[i].length = length;
    memcpy(s->variables.variable[i].value, value, sizeof value);
    s->variables.count += i == s->variables.count;
}

/* One line; what is no assignment means nothing here. */
static void take_line(imki_parameters *p, void *context, const char *line, const char *end,
                      size_t number)
{
    script *s = context;
    char name[NAME_SIZE], field[NAME_SIZE] = "";
    const char *at = take_name(skip_blanks(line, end), end, name);
    if (name[0] == '\0')
        return;
    if (at < end && *at == '.')
        at = take_name(at + 1, end, field);
    at = skip_blanks(at, end);
    if (at == end || *at != '=' || (at + 1 < end && at[1] == '='))
        return;
    at = skip_blanks(at + 1, end);
    const char *stop = statement_end(at, end);
    while (stop > at && (stop[-1] == ' ' || stop[-1] == '\t' || stop[-1] == '\r'))
        stop--;
    imki_place place = {field, number, (size_t)(at - line) + 1};
    if (field[0])
        take_field(p, s, name, field, place, at, stop);
    else
        take_variable(s, name, at, stop);
}

static void check_structure(imki_parameters *p, const script *s)
{
    const bool named = p->settings->sensor != NULL;
    if (s->structure_count == 0 && !(s->structure[0] && named))
        imki_parameter_refuse(p, IMK_ERROR_KEY_MISSING, "arw", "arw",
                              "a file with assignments such as imu.arw = 2 .* ones(1,3);");
    imki_choice_end(p, s->structure[0] && (named || s->structure_count == 1), s->others, "NAME",
                    "the file has several structures");
}

static void fill(imki_parameters *p, script *s, int kind)
{
    imk_triad *triad = p->triad[kind];
    double(*si)[3] = s->si[kind];
    triad->present = false;
    for (int i = 0; i < FIELDS; i++)
        triad->present = triad->present || s->seen[kind][i];
    memcpy(triad->noise.white.value, si[0], sizeof si[0]);
    memcpy(triad->noise.random_walk.value, si[1], sizeof si[1]);
    memcpy(triad->bias.fixed.value, si[2], sizeof si[2]);
    imki_white_where_infinite(p, s->place[kind][s->seen[kind][4] ? 4 : 3], triad,
                              s->rate > 0 ? s->rate : p->settings->rate, "NaveGo", si[3], si[4]);
    imki_add_gauss_markov(triad, si[3], si[4]);
    if (imki_any(si[2]))
        imki_note(p, false,
                  "%s: NaveGo adds a random tenth of this value in each run; the model leaves this "
                  "part out",
                  fields[kind][2].name);
    if (imki_any(si[1]))
        imki_note(p, false,
                  "%s is taken as documented; NaveGo's simulation makes steps of K/rate instead of "
                  "K/sqrt(rate)",
                  fields[kind][1].name);
}

void imki_navego_read(imki_parameters *p)
{
    script s = {.variables = {.count = 0}};
    imki_each_line(p, take_line, &s);
    check_structure(p, &s);
    for (int kind = 0; kind < 2; kind++)
        fill(p, &s, kind);
    snprintf(p->model->name, sizeof p->model->name, "%s", s.structure);
}

/* ---- writing --------------------------------------------------------------------------------- */

static void write_triad(imki_parameters *p, const char *structure, int kind, const imk_triad *triad)
{
    double values[FIELDS][3] = {{0}};
    imki_first_gauss_markov(triad, values[3], values[4]);
    for (int i = 0; i < 3; i++) {
        values[0][i] = triad->noise.white.value[i];
        values[1][i] = triad->noise.random_walk.value[i];
        values[2][i] = triad->bias.fixed.value[i];
        /* Where there is no process any finite time will do. */
        if (values[3][i] == 0)
            values[4][i] = 100;
    }
    for (int k = 0; k < FIELDS; k++) {
        imki_text_add(&p->out, "%s.%s = [", structure, fields[kind][k].name);
        for (int i = 0; i < 3; i++)
            values[k][i] /= fields[kind][k].unit.scale;
        imki_text_numbers(&p->out, values[k], 3, " ");
        imki_text_add(&p->out, "];  %% [%s]\n", fields[kind][k].unit.name);
    }
}

void imki_navego_write(imki_parameters *p)
{
    char structure[NAME_SIZE];
    size_t length = 0;
    for (const char *c = p->source->name; *c && length + 1 < sizeof structure; c++)
        if (is_name_letter(*c, length == 0))
            structure[length++] = *c;
    structure[length] = '\0';
    if (length == 0)
        snprintf(structure, sizeof structure, "imu");
    imki_text_add(&p->out, "%% NaveGo: error profile of an IMU, for imu_si_errors(); x y z\n");
    for (int kind = 0; kind < 2; kind++)
        if (p->origin[kind]->present)
            write_triad(p, structure, kind, p->origin[kind]);
    if (p->settings->rate > 0)
        imki_text_add(&p->out, "%s.freq = %s;  %% [Hz]\n", structure,
                      imki_shortest(p->settings->rate).text);
    else
        imki_note(p, true, "NaveGo needs freq: add it to the file, or convert with --rate");
}
