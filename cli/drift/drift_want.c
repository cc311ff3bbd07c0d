/* SPDX-License-Identifier: Apache-2.0 */
/* --want "CEP 1 nmi @ 1h", --want "CEP 5 m after 60 s": a figure, how large it may be, and when. */
#include "drift_parts.h"

#include <math.h>
#include <string.h>
#include <strings.h>

enum { FIGURES = IMK_REQUIRED_HEADING + 1 };

/* Limits of any figure, SI: beyond real sensors and beyond the size of the Earth. */
static const double least_goal = 1e-9, largest_goal = 1e9;

static int refuse(const char *text, const char *why)
{
    return command_misused("--want \"%s\": %s; write --want \"CEP 1 nmi @ 1h\"", text, why);
}

/* A number with a unit of a dimension; `end` is where it stops. */
static bool quantity(const char *begin, const char *end, const char *unit, double *value,
                     imk_unit *found)
{
    double sigma;
    size_t count;
    return imk_quantity_parse(begin, end, imk_unit_of(unit).dimension, 1, value, &sigma, &count,
                              found, NULL) == IMK_OK &&
           count == 1 && *value > 0 && isfinite(*value);
}

static int find_figure(const char *text, size_t length, imk_drift_wanted *want)
{
    char given[32], why[160];
    const char *names[FIGURES];
    snprintf(given, sizeof given, "%.*s", (int)(length < 30 ? length : 30), text);
    for (int w = 0; w < FIGURES; w++) {
        names[w] = imk_drift_requirement_name((imk_drift_requirement)w);
        if (strcasecmp(names[w], given) == 0) {
            want->figure = (imk_drift_requirement)w;
            return -1;
        }
    }
    const char *nearest = command_nearest(given, FIGURES, names);
    snprintf(
        why, sizeof why,
        "\"%s\" is not a figure%s%s%s; expected CEP, R95, DRMS, height, velocity, tilt or heading",
        given, nearest ? " (did you mean " : "", nearest ? nearest : "", nearest ? "?)" : "");
    return refuse(text, why);
}

/* Where the time begins: behind "@" or "after". */
static const char *find_time(const char *text, bool *after, const char **time)
{
    const char *at = strchr(text, '@'), *word = strstr(text, " after ");
    *after = !at && word;
    *time = at ? at + 1 : word ? word + strlen(" after ") : NULL;
    return at ? at : word;
}

int drift_want_parse(const char *text, imk_drift_wanted *want, bool *after)
{
    const char *time, *name = text + strspn(text, " "), *at = find_time(text, after, &time);
    const size_t length = strcspn(name, " <=@");
    const char *value = name + length + strspn(name + length, " <=");
    char why[160];
    *want = (imk_drift_wanted){.asked = true};
    int code = find_figure(name, length, want);
    if (code >= 0)
        return code;
    if (!at)
        return refuse(text, "the time is missing");
    if (value >= at)
        return refuse(text, "the limit is missing");
    const char *unit = imk_drift_requirement_unit(want->figure);
    if (!quantity(value, at, unit, &want->goal, &want->unit)) {
        snprintf(why, sizeof why, "\"%.*s\" is not a positive number with a unit of %s, such as %s",
                 (int)(at - value < 40 ? at - value : 40), value,
                 imk_dimension_name(imk_unit_of(unit).dimension),
                 imk_dimension_examples(imk_unit_of(unit).dimension));
        return refuse(text, why);
    }
    if (!(want->goal >= least_goal && want->goal <= largest_goal)) {
        snprintf(why, sizeof why, "expected a figure from 1e-9 to 1e9 %s", unit);
        return refuse(text, why);
    }
    if (!quantity(time, time + strlen(time), "s", &want->time, NULL))
        return refuse(text, *after ? "expected a positive time with its unit behind \"after\""
                                   : "expected a positive time with its unit after @");
    return -1;
}
