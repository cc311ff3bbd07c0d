/* SPDX-License-Identifier: Apache-2.0 */
/* --want of identify --plan: "bias_instability 5%": a term, and its 1 sigma in per cent of itself
 * or "detected" with the chance wanted. */
#include "identify_plan_parts.h"
#include "shell/command.h"

#include <math.h>
#include <string.h>
#include <strings.h>

/* Letters of the five terms, as they are spoken of. */
static const char *const letters[IMK_NOISE_TERMS] = {"Q", "N", "B", "K", "R"};

static bool names(const plan_row *row, const char *given)
{
    const char *kind = row->accel ? "accel." : "gyro.";
    if (strncasecmp(given, kind, strlen(kind)) == 0)
        given += strlen(kind);
    else if (strchr(given, '.') && strncasecmp(given, "gauss_markov", 12) != 0)
        return false;
    return strcasecmp(row->key, given) == 0 ||
           (row->term < IMK_NOISE_TERMS && strcmp(letters[row->term], given) == 0);
}

static int refuse_name(const identify_plan *p, const char *given)
{
    const char *keys[PLAN_ROWS_MAX];
    size_t count = 0;
    char list[400] = "";
    for (size_t r = 0; r < p->row_count; r++) {
        bool known = false;
        for (size_t k = 0; k < count; k++)
            known = known || strcmp(keys[k], p->row[r].key) == 0;
        if (known)
            continue;
        keys[count++] = p->row[r].key;
        const size_t used = strlen(list);
        snprintf(list + used, sizeof list - used, "%s%s", used > 0 ? ", " : "", p->row[r].key);
    }
    const char *nearest = command_nearest(given, count, keys);
    return command_misused("--want \"%s\": %s has no such noise%s%s%s; it has %s", given,
                           p->request->model, nearest ? " (did you mean " : "",
                           nearest ? nearest : "", nearest ? "?)" : "", list);
}

/* "5%", "0.05 1", or the chance of "detected 95%". */
static bool ratio(const char *text, double *value)
{
    double sigma;
    size_t count;
    return imk_quantity_parse(text, text + strlen(text), imk_unit_of("%").dimension, 1, value,
                              &sigma, &count, NULL, NULL) == IMK_OK &&
           *value > 0 && isfinite(*value);
}

static int parse_item(identify_plan *p, const char *text, size_t length)
{
    char item[96];
    snprintf(item, sizeof item, "%.*s", (int)(length < 95 ? length : 95), text);
    char *name = item + strspn(item, " "), *value = name + strcspn(name, " ");
    plan_wish wish = {0};
    snprintf(wish.text, sizeof wish.text, "%s", name);
    if (*value)
        *value++ = '\0';
    value += strspn(value, " ");
    if (strncasecmp(value, "detected", 8) == 0 && (value[8] == ' ' || value[8] == '\0')) {
        value += 8 + strspn(value + 8, " ");
        wish.detection = 0.95;
        if (*value && !(ratio(value, &wish.detection) && wish.detection < 1))
            return command_misused(
                "--want \"%s\": behind \"detected\" a chance below 100%% is due, "
                "such as 95%%",
                wish.text);
    } else if (!ratio(value, &wish.relative)) {
        return command_misused("--want \"%s\": expected a term and its 1 sigma in per cent of it, "
                               "such as \"bias_instability 5%%\", or \"rate_random_walk detected "
                               "95%%\"",
                               wish.text);
    }
    bool found = false;
    for (size_t r = 0; r < p->row_count; r++) {
        if (!names(&p->row[r], name))
            continue;
        if (p->wish_count == PLAN_WISHES_MAX)
            return command_misused("--want: these are more than %d wishes", PLAN_WISHES_MAX);
        wish.row = r;
        p->wish[p->wish_count++] = wish;
        found = true;
    }
    return found ? -1 : refuse_name(p, name);
}

int identify_wish_parse(identify_plan *p)
{
    int code = -1;
    for (const char *text = p->request->want; code < 0 && text && *text;) {
        const size_t length = strcspn(text, ",");
        code = parse_item(p, text, length);
        text += length + (text[length] == ',');
    }
    return code;
}
