/* SPDX-License-Identifier: Apache-2.0 */
/* A requirement in a line of text: "CEP 1 nmi @ 1h", "CEP 5 m after 60 s". */
#include "imukit/drift_models.h"

#include "imukit/names.h"
#include "imukit/units.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

enum { FIGURES = IMK_REQUIRED_HEADING + 1 };

/* Limits of any figure, SI: beyond real sensors and beyond the size of the Earth. */
static const double least_goal = 1e-9, largest_goal = 1e9;

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

static imk_status find_figure(const char *text, size_t length, imk_drift_wanted *want,
                              imk_error *error)
{
    char given[32], why[160];
    const char *names[FIGURES];
    snprintf(given, sizeof given, "%.*s", (int)(length < 30 ? length : 30), text);
    for (int w = 0; w < FIGURES; w++) {
        names[w] = imk_drift_requirement_name((imk_drift_requirement)w);
        if (strcasecmp(names[w], given) == 0) {
            want->figure = (imk_drift_requirement)w;
            return IMK_OK;
        }
    }
    const size_t nearest = imk_nearest_name(given, FIGURES, names);
    snprintf(why, sizeof why, "\"%s\" is not a figure%s%s%s", given,
             nearest < FIGURES ? " (did you mean " : "", nearest < FIGURES ? names[nearest] : "",
             nearest < FIGURES ? "?)" : "");
    return imk_error_set(error, IMK_ERROR_SYNTAX, NULL, why,
                         "CEP, R95, DRMS, height, velocity, tilt or heading");
}

/* Where the time begins: behind "@" or "after". */
static const char *find_time(const char *text, bool *after, const char **time)
{
    const char *at = strchr(text, '@'), *word = strstr(text, " after ");
    *after = !at && word;
    *time = at ? at + 1 : word ? word + strlen(" after ") : NULL;
    return at ? at : word;
}

static imk_status read_goal(const char *value, const char *end, imk_drift_wanted *want,
                            imk_error *error)
{
    const char *unit = imk_drift_requirement_unit(want->figure);
    const imk_dimension dimension = imk_unit_of(unit).dimension;
    char text[160];
    if (!quantity(value, end, unit, &want->goal, &want->unit)) {
        snprintf(text, sizeof text, "\"%.*s\" is not a positive number with a unit of %s",
                 (int)(end - value < 40 ? end - value : 40), value, imk_dimension_name(dimension));
        return imk_error_set(error, IMK_ERROR_SYNTAX, NULL, text,
                             imk_dimension_examples(dimension));
    }
    if (want->goal >= least_goal && want->goal <= largest_goal)
        return IMK_OK;
    snprintf(text, sizeof text, "a figure from 1e-9 to 1e9 %s", unit);
    const imk_status status = imk_error_set(error, IMK_ERROR_RANGE, NULL, NULL, text);
    if (error)
        error->value = want->goal;
    return status;
}

imk_status imk_drift_wanted_parse(const char *text, imk_drift_wanted *want, bool *after,
                                  imk_error *error)
{
    if (!text || !want || !after)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "text", NULL, NULL);
    bool from_outage;
    const char *time, *name = text + strspn(text, " "), *at = find_time(text, &from_outage, &time);
    const size_t length = strcspn(name, " <=@");
    const char *value = name + length + strspn(name + length, " <=");
    imk_drift_wanted made = {.asked = true};
    imk_status status = find_figure(name, length, &made, error);
    if (status != IMK_OK)
        return status;
    if (!at || value >= at)
        return imk_error_set(error, IMK_ERROR_EMPTY, NULL,
                             at ? "the limit is missing" : "the time is missing", NULL);
    status = read_goal(value, at, &made, error);
    if (status != IMK_OK)
        return status;
    if (!quantity(time, time + strlen(time), "s", &made.time, NULL))
        return imk_error_set(error, IMK_ERROR_SYNTAX, NULL, NULL,
                             from_outage ? "a positive time with its unit behind \"after\""
                                         : "a positive time with its unit after @");
    *want = made;
    *after = from_outage;
    return IMK_OK;
}
