/* SPDX-License-Identifier: Apache-2.0 */
/* Reads the words of a command line by the verb's option tables. */
#include "options.h"

#include "command.h"
#include "file_clash.h"

#include "imukit/names.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NAMES_MAX = 64 };

static bool matches(const option *o, const char *name, size_t length)
{
    return strlen(o->name) == length && strncmp(o->name, name, length) == 0;
}

/* The option of a name (or of a letter when name is NULL) and its group. */
static const option *find(const verb *v, const char *name, size_t length, char letter,
                          const option_group **group)
{
    for (size_t g = 0; g < GROUPS_MAX; g++) {
        for (size_t i = 0; i < v->groups[g].count; i++) {
            const option *o = &v->groups[g].options[i];
            if (name ? matches(o, name, length) : (o->letter && o->letter == letter)) {
                *group = &v->groups[g];
                return o;
            }
        }
    }
    return NULL;
}

/* The one name that begins so; NULL: none, or several. */
static const char *only_name(const char *beginning, size_t count, const char *const *names)
{
    const char *only = NULL;
    for (size_t i = 0; i < count; i++) {
        if (strncmp(names[i], beginning, strlen(beginning)) != 0)
            continue;
        if (only)
            return NULL;
        only = names[i];
    }
    return only;
}

static int unknown_option(const verb *v, const char *name, size_t length)
{
    const char *names[NAMES_MAX];
    size_t count = 0;
    char given[64];
    snprintf(given, sizeof given, "%.*s", (int)(length < 60 ? length : 60), name);
    for (size_t g = 0; g < GROUPS_MAX; g++)
        for (size_t i = 0; i < v->groups[g].count && count < NAMES_MAX; i++)
            names[count++] = v->groups[g].options[i].name;
    const char *meant = only_name(given, count, names);
    if (!meant)
        meant = command_nearest(given, count, names);
    if (meant)
        return command_misused("there is no option --%s; did you mean --%s?", given, meant);
    return command_misused("there is no option --%s", given);
}

/* "1-5" */
static void read_range(const option *o, uint64_t *least, uint64_t *most)
{
    char *end = NULL;
    *least = o->choices ? strtoull(o->choices, &end, 10) : 0;
    *most = end ? strtoull(end + 1, NULL, 10) : UINT64_MAX;
}

static int set_integer(const option *o, const char *text, option_integer *target)
{
    uint64_t value = 0, least, most;
    bool beyond = false;
    const char *c = text;
    read_range(o, &least, &most);
    for (; *c >= '0' && *c <= '9'; c++) {
        const uint64_t digit = (uint64_t)(*c - '0');
        beyond = beyond || value > (UINT64_MAX - digit) / 10;
        value = value * 10 + digit;
    }
    if (c == text || *c)
        return command_misused("--%s %s: expected a whole number, such as --%s %llu", o->name, text,
                               o->name, (unsigned long long)(least > 0 ? least : 1));
    if (o->choices && (beyond || value < least || value > most))
        return command_misused("--%s %s: expected %llu to %llu", o->name, text,
                               (unsigned long long)least, (unsigned long long)most);
    if (beyond)
        return command_misused("--%s %s: the number is too large; at most 18446744073709551615",
                               o->name, text);
    *target = (option_integer){value, true};
    return -1;
}

/* "0.1..0.9". @return the dots, NULL without bounds */
static const char *read_bounds(const option *o, double *least, double *most)
{
    const char *dots = o->choices ? strstr(o->choices, "..") : NULL;
    if (dots) {
        imk_decimal_parse(o->choices, dots, least);
        imk_decimal_parse(dots + 2, dots + strlen(dots), most);
    }
    return dots;
}

static int set_fraction(const option *o, const char *text, double *target)
{
    const char *end = text + strlen(text);
    double value;
    const char *rest = imk_decimal_parse(text, end, &value);
    if (rest != text && strcmp(rest, "%") == 0)
        value /= 100;
    else if (rest == text || *rest)
        value = -1;
    if (!(value > 0 && value < 1))
        return command_misused("--%s %s: expected a fraction between 0 and 1, such as 0.95 or 95%%",
                               o->name, text);
    *target = value;
    double least = 0, most = 1;
    const char *dots = read_bounds(o, &least, &most);
    if (value >= least && value <= most)
        return -1;
    return command_misused("--%s %s: expected a fraction from %.*s to %s", o->name, text,
                           (int)(dots - o->choices), o->choices, dots + 2);
}

/* "1e-9..1e9", in the option's unit. */
static int check_quantity(const option *o, const char *text, double value)
{
    const imk_unit unit = imk_unit_of(o->unit);
    double least = 0, most = 0;
    const char *dots = read_bounds(o, &least, &most);
    const bool zero_fits = strcmp(o->choices, "not negative") == 0;
    if (!dots)
        return value > 0 || (zero_fits && value == 0)
                   ? -1
                   : command_misused("--%s %s: expected %s", o->name, text,
                                     zero_fits ? "0 or more" : "more than 0");
    if (value >= least * unit.scale + unit.offset && value <= most * unit.scale + unit.offset)
        return -1;
    return command_misused("--%s %s: expected %.*s%s to %s%s", o->name, text,
                           (int)(dots - o->choices), o->choices, o->unit, dots + 2, o->unit);
}

static int set_quantity(const option *o, const char *text, double *target)
{
    imk_error error;
    double value, sigma;
    size_t count;
    imk_unit unit = imk_unit_of(o->unit);
    imk_status status = imk_quantity_parse(text, text + strlen(text), unit.dimension, 1, &value,
                                           &sigma, &count, NULL, &error);
    if (status == IMK_ERROR_UNIT_MISSING)
        return command_misused("--%s %s: the unit is missing; write --%s %s%s", o->name, text,
                               o->name, text, o->unit);
    if (status != IMK_OK || count != 1 || !isfinite(value))
        return command_misused("--%s %s: %s; expected %s such as %s", o->name, text,
                               status == IMK_OK ? "this is not one finite number"
                               : error.found[0] ? error.found
                                                : imk_status_text(status),
                               imk_dimension_name(unit.dimension),
                               imk_dimension_examples(unit.dimension));
    *target = value;
    return o->choices ? check_quantity(o, text, value) : -1;
}

static int set_unit(const option *o, const char *text, imk_unit *target)
{
    imk_error error;
    if (imk_unit_parse(text, text + strlen(text), target, &error) != IMK_OK)
        return command_misused("--%s %s: the unit is not known", o->name, text);
    return o->unit ? options_check_unit(o->name, target, imk_unit_of(o->unit).dimension) : -1;
}

int options_check_unit(const char *name, const imk_unit *unit, imk_dimension due)
{
    if (imk_dimension_equal(unit->dimension, due))
        return -1;
    return command_misused("--%s %s: expected %s such as %s", name, unit->text,
                           imk_dimension_name(due), imk_dimension_examples(due));
}

static int set_choice(const option *o, const char *text, int *target)
{
    int position = 0;
    size_t length = strlen(text);
    for (const char *c = o->choices;; position++) {
        size_t word = strcspn(c, "|");
        if (word == length && strncmp(c, text, word) == 0) {
            *target = position;
            return -1;
        }
        if (!c[word])
            break;
        c += word + 1;
    }
    return command_misused("--%s %s: expected one of %s", o->name, text, o->choices);
}

const char *options_output_name(const char *name)
{
    static const char *const names[] = {"/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (strcmp(name, names[i]) == 0)
            return "-";
    return name;
}

static int add_text(const option *o, const char *text, option_texts *texts)
{
    if (!*text)
        return command_misused("--%s: the value is empty", o->name);
    if (texts->count == OPTION_TEXTS_MAX)
        return command_misused("--%s is given more than %d times", o->name, OPTION_TEXTS_MAX);
    texts->text[texts->count++] = text;
    return -1;
}

/* A second file would take the place of the first unseen. */
static int set_file(const option *o, const char *text, const char **target)
{
    if (!*text)
        return command_misused("--%s: the value is empty", o->name);
    if (*target)
        return command_misused("--%s is given twice, %s and %s, but it takes one file: leave one "
                               "out, or make one file of both",
                               o->name, *target, text);
    *target = text;
    return -1;
}

static int set_value(const option *o, const option_group *group, const char *text, void *settings)
{
    void *target = (char *)settings + group->offset + o->offset;
    switch (o->kind) {
    case OPTION_FLAG:
        *(bool *)target = true;
        return -1;
    case OPTION_TEXTS:
        return add_text(o, text, target);
    case OPTION_FILE:
        return set_file(o, text, target);
    case OPTION_TEXT:
    case OPTION_INTO:
    case OPTION_OUTPUT:
        if (!*text)
            return command_misused("--%s: the value is empty", o->name);
        *(const char **)target = o->kind == OPTION_OUTPUT ? options_output_name(text) : text;
        return -1;
    case OPTION_INTEGER:
        return set_integer(o, text, target);
    case OPTION_QUANTITY:
        return set_quantity(o, text, target);
    case OPTION_UNIT:
        return set_unit(o, text, target);
    case OPTION_FRACTION:
        return set_fraction(o, text, target);
    case OPTION_CHOICE:
        return set_choice(o, text, target);
    }
    return -1;
}

/* One option word, with its value from the same word ("--rate=100Hz", "-oFILE") or the next. */
static int take_option(const verb *v, int count, char **words, int *index, void *settings)
{
    const char *word = words[*index];
    const option_group *group = NULL;
    const option *o;
    const char *value = NULL;
    if (word[1] == '-') {
        size_t length = strcspn(word + 2, "=");
        o = find(v, word + 2, length, 0, &group);
        if (!o)
            return unknown_option(v, word + 2, length);
        if (word[2 + length] == '=')
            value = word + 3 + length;
    } else {
        o = find(v, NULL, 0, word[1], &group);
        if (!o)
            return command_misused("there is no option -%c", word[1]);
        if (word[2])
            value = word + 2;
    }
    if (o->kind == OPTION_FLAG && value)
        return command_misused("--%s takes no value", o->name);
    if (o->kind != OPTION_FLAG && !value) {
        const bool follows = *index + 1 < count && !(o->alone && words[*index + 1][0] == '-');
        if (!follows && !o->alone)
            return command_misused("--%s needs a value: --%s %s", o->name, o->name, o->value);
        value = follows ? words[++*index] : o->alone;
    }
    return set_value(o, group, value, settings);
}

/* The option whose output goes to standard output; NULL: none. */
static const char *stdout_taken_by;

bool options_stdout_taken(void)
{
    return stdout_taken_by != NULL;
}

/* Two texts in one stream are neither. */
static int take_stdout(const verb *v, const void *settings, const char *name)
{
    const option_group *group = NULL;
    const option *json = find(v, "json", 4, 0, &group);
    const char *other = stdout_taken_by;
    if (!other && json && *(const bool *)((const char *)settings + group->offset + json->offset))
        other = json->name;
    stdout_taken_by = name;
    return other ? command_misused("--%s and --%s cannot both go to standard output: give a file "
                                   "name",
                                   other, name)
                 : -1;
}

/* A report is a page, whatever the name of its file says. */
static int check_report(const char *path)
{
    if (!imk_has_ending(path, ".pdf"))
        return -1;
    return command_misused(
        "--report %s: a report is a page, FILE.html; a browser prints it as PDF: "
        "chromium --headless --no-pdf-header-footer --print-to-pdf=FILE.pdf "
        "FILE.html",
        path);
}

/* At most one output goes to standard output, where a figure on the terminal goes, too. */
static int check_stdout(const verb *v, const void *settings)
{
    int code = -1;
    bool json = false, drawn = false;
    for (size_t g = 0; g < GROUPS_MAX; g++)
        for (size_t i = 0; i < v->groups[g].count && code < 0; i++) {
            const option *o = &v->groups[g].options[i];
            const void *at = (const char *)settings + v->groups[g].offset + o->offset;
            const char *path = o->kind == OPTION_OUTPUT ? *(const char *const *)at : NULL;
            if (path && strcmp(o->name, "report") == 0)
                code = check_report(path);
            if (code < 0 && path && strcmp(path, "-") == 0)
                code = take_stdout(v, settings, o->name);
            json = json || (strcmp(o->name, "json") == 0 && *(const bool *)at);
            drawn = drawn || (path && strcmp(o->name, "plot") == 0 && strcmp(path, "term") == 0);
        }
    return code < 0 && json && drawn
               ? command_misused("--json and --plot term cannot both go to standard output: give a "
                                 "file name")
               : code;
}

static int check_operands(const verb *v, size_t count)
{
    if (count < v->operands_minimum)
        return command_misused("%s missing: imukit %s %s",
                               v->operands_minimum - count > 1 ? "operands are" : "an operand is",
                               v->name, v->operands);
    return -1;
}

static int refuse_operand(const verb *v, const char *word)
{
    char most[40] = "";
    if (strstr(v->operands, "..."))
        snprintf(most, sizeof most, ", at most %zu of them", v->operands_maximum);
    return command_misused("\"%s\" is one word too many: imukit %s %s%s", word, v->name,
                           v->operands, most);
}

int options_parse(const verb *v, int argument_count, char **arguments, void *settings,
                  const char **operands)
{
    size_t operand_count = 0;
    bool options_over = false;
    stdout_taken_by = NULL;
    for (size_t i = 0; i < v->operands_maximum; i++)
        operands[i] = NULL;
    for (int i = 0; i < argument_count; i++) {
        const char *word = arguments[i];
        if (!options_over && strcmp(word, "--") == 0) {
            options_over = true;
        } else if (!options_over && (strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0)) {
            options_help(v, stdout);
            return command_finish(EXIT_DONE);
        } else if (!options_over && word[0] == '-' && word[1]) {
            int code = take_option(v, argument_count, arguments, &i, settings);
            if (code >= 0)
                return code;
        } else if (operand_count < v->operands_maximum) {
            operands[operand_count++] = word;
        } else {
            return refuse_operand(v, word);
        }
    }
    int code = check_operands(v, operand_count);
    if (code < 0)
        code = check_stdout(v, settings);
    return code < 0 ? file_clash(v, settings, operands) : code;
}
