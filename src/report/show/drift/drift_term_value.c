/* SPDX-License-Identifier: Apache-2.0 */
/* The value of a term as the model file says it, made so many times larger or smaller: names of
 * sources are paths in the file ("gyro.noise.gauss_markov[0]"). */
#include "drift_show_internal.h"

#include "imukit/decimal.h"

#include <math.h>
#include <stdio.h>
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

/* After compensation, a term with a known value counts with its uncertainty only. */
static bool is_known(const char *source)
{
    return !strstr(source, "repeatability") &&
           (!strstr(source, ".noise.") || strstr(source, "_ramp")) &&
           !strstr(source, "resolution") && !strstr(source, "sensitivity") &&
           !strstr(source, "jitter");
}

static void put(const numbers *n, bool sigma, double factor, imki_text *text)
{
    const size_t count = sigma ? n->sigma_count : n->count;
    const double *value = sigma ? n->sigma : n->value;
    bool equal = true;
    for (size_t i = 1; i < count; i++)
        equal = equal && value[i] == value[0];
    imki_text_add(text, "%s", sigma ? "±" : "");
    for (size_t i = 0; i < (equal ? 1 : count); i++) {
        const double scaled = value[i] * factor;
        char number[40];
        if (factor == 1)
            snprintf(number, sizeof number, "%.6g", scaled);
        else if (scaled != 0 && fabs(scaled) < 1e-3)
            snprintf(number, sizeof number, "%.3g", scaled);
        else
            imk_readable_value(scaled, 0, 3, number, sizeof number);
        imki_text_add(text, "%s%s", i ? " " : "", number);
    }
    imki_text_add(text, " %s", n->unit);
}

static const char *text_at(const imk_result *model, const char *source, const char *member)
{
    char path[120];
    snprintf(path, sizeof path, "model.%s%s", source, member);
    return imk_result_find(model, path);
}

/* Of rows the largest number. */
static bool largest_of_rows(const imk_result *model, const char *source, bool sigma,
                            numbers *largest)
{
    bool any = false;
    for (int row = 0;; row++) {
        numbers n;
        char element[20];
        snprintf(element, sizeof element, "[%d]", row);
        const char *text = text_at(model, source, element);
        if (!text || !read_numbers(text, &n))
            return any && !text;
        const double *value = sigma ? n.sigma : n.value;
        for (size_t i = 0; i < (sigma ? n.sigma_count : n.count); i++) {
            if (any && fabs(value[i]) <= largest->value[0])
                continue;
            *largest = (numbers){.count = 1, .sigma_count = 1, .unit = n.unit};
            largest->value[0] = largest->sigma[0] = fabs(value[i]);
            any = true;
        }
    }
}

void imki_drift_term_value(const imk_result *model, const char *source, bool compensated,
                           double factor, imki_text *text)
{
    static const char *const members[] = {"", ".sigma", ".amplitude"}; /* what sizes a process */
    const bool sigma = compensated && is_known(source);
    const char *found = NULL, *last = strrchr(source, '.');
    numbers n;
    /* A shorter delay is a wider band, and a finer step more counts. */
    if (last && (strcmp(last, ".bandwidth") == 0 || strcmp(last, ".sensitivity") == 0))
        factor = 1 / factor;
    for (size_t i = 0; i < sizeof members / sizeof members[0] && !found; i++)
        found = text_at(model, source, members[i]);
    if (found && read_numbers(found, &n) && (!sigma || n.sigma_count > 0)) {
        put(&n, sigma, factor, text);
    } else if (!found && largest_of_rows(model, source, sigma, &n)) {
        imki_text_add(text, "<= ");
        put(&n, sigma, factor, text);
    }
}
