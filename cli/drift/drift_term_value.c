/* SPDX-License-Identifier: Apache-2.0 */
/* The value of a term as the model file says it, made so many times larger or smaller: names of
 * sources are paths in the file ("gyro.noise.gauss_markov[0]"). */
#include "drift_parts.h"

#include <math.h>
#include <string.h>

enum { NUMBERS = 8 };

typedef struct numbers {
    size_t count, sigma_count;
    double value[NUMBERS], sigma[NUMBERS];
    const char *unit;
} numbers;

/* "0.1 -0.2 0.05 ± 0.01 deg/h" */
static bool read_numbers(const char *text, numbers *n)
{
    bool behind = false;
    *n = (numbers){0};
    for (;;) {
        double value;
        text += strspn(text, " ");
        const size_t length = strcspn(text, " ");
        if (strncmp(text, "±", strlen("±")) == 0 || strncmp(text, "+-", 2) == 0) {
            behind = true;
            text += text[0] == '+' ? 2 : strlen("±");
            continue;
        }
        if (length == 0 || imk_decimal_parse(text, text + length, &value) != text + length)
            break;
        size_t *count = behind ? &n->sigma_count : &n->count;
        if (*count == NUMBERS)
            return false;
        (behind ? n->sigma : n->value)[(*count)++] = value;
        text += length;
    }
    n->unit = text;
    return n->count > 0;
}

/* One step of a path: "gauss_markov[1]". */
static const json_t *step(const json_t *node, const char *name, size_t length)
{
    char key[64];
    size_t index = 0;
    const char *bracket = memchr(name, '[', length);
    const size_t word = bracket ? (size_t)(bracket - name) : length;
    snprintf(key, sizeof key, "%.*s", (int)(word < 60 ? word : 60), name);
    node = json_object_get(node, key);
    if (!bracket)
        return node;
    for (const char *c = bracket + 1; *c >= '0' && *c <= '9'; c++)
        index = 10 * index + (size_t)(*c - '0');
    return json_array_get(node, index);
}

static const json_t *find(const json_t *model, const char *path)
{
    const json_t *node = model;
    while (node && *path) {
        const size_t length = strcspn(path, ".");
        node = step(node, path, length);
        path += length;
        path += *path == '.';
    }
    if (json_is_object(node)) { /* of a process: what sizes it */
        const json_t *size = json_object_get(node, "sigma");
        node = size ? size : json_object_get(node, "amplitude");
    }
    return node;
}

/* Terms whose value is known count with their uncertainty once they are compensated. */
static bool is_known(const char *source)
{
    return !strstr(source, "repeatability") &&
           (!strstr(source, ".noise.") || strstr(source, "_ramp")) &&
           !strstr(source, "resolution") && !strstr(source, "sensitivity") &&
           !strstr(source, "jitter");
}

static void put(const numbers *n, bool sigma, double factor, char *text, size_t size)
{
    const size_t count = sigma ? n->sigma_count : n->count;
    const double *value = sigma ? n->sigma : n->value;
    bool equal = true;
    for (size_t i = 1; i < count; i++)
        equal = equal && value[i] == value[0];
    size_t used = (size_t)snprintf(text, size, "%s", sigma ? "±" : "");
    for (size_t i = 0; i < (equal ? 1 : count) && used < size; i++) {
        const double scaled = value[i] * factor;
        char number[40];
        if (scaled != 0 && fabs(scaled) < 1e-3)
            snprintf(number, sizeof number, "%.3g", scaled);
        else
            format_value(scaled, 0, 3, number, sizeof number);
        used += (size_t)snprintf(
            text + used, size - used, "%s%s", i ? " " : "",
            factor == 1 ? (snprintf(number, sizeof number, "%.6g", scaled), number) : number);
    }
    if (used < size)
        snprintf(text + used, size - used, " %s", n->unit);
}

/* Of rows the largest number. */
static bool largest_of_rows(const json_t *rows, bool sigma, numbers *largest)
{
    const json_t *row;
    size_t index;
    bool any = false;
    json_array_foreach(rows, index, row)
    {
        numbers n;
        if (!json_is_string(row) || !read_numbers(json_string_value(row), &n))
            return false;
        const double *value = sigma ? n.sigma : n.value;
        for (size_t i = 0; i < (sigma ? n.sigma_count : n.count); i++) {
            if (any && fabs(value[i]) <= largest->value[0])
                continue;
            *largest = (numbers){.count = 1, .sigma_count = 1, .unit = n.unit};
            largest->value[0] = largest->sigma[0] = fabs(value[i]);
            any = true;
        }
    }
    return any;
}

void drift_term_value(const json_t *model, const char *source, bool compensated, double factor,
                      char *text, size_t size)
{
    numbers n;
    const json_t *node = find(model, source);
    const bool sigma = compensated && is_known(source);
    /* A shorter delay is a wider band, and a finer step more counts. */
    const char *last = strrchr(source, '.');
    if (last && (strcmp(last, ".bandwidth") == 0 || strcmp(last, ".sensitivity") == 0))
        factor = 1 / factor;
    text[0] = '\0';
    if (json_is_array(node)) {
        if (largest_of_rows(node, sigma, &n) && size > 8) {
            snprintf(text, size, "<= ");
            put(&n, sigma, factor, text + 3, size - 3);
        }
    } else if (json_is_string(node) && read_numbers(json_string_value(node), &n) &&
               (!sigma || n.sigma_count > 0)) {
        put(&n, sigma, factor, text, size);
    }
}
