/* SPDX-License-Identifier: Apache-2.0 */
/* Requirements as they are written: "bias_instability 5%, rate_random_walk detected 95%". */
#include "record_plan_internal.h"

#include "jobs/job_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

/* Letters of the five terms, as they are spoken of. */
static const char *const letters[IMK_NOISE_TERMS] = {"Q", "N", "B", "K", "R"};

static bool names(const imk_plan_parameter *parameter, const char *given)
{
    const char *kind = parameter->sensor == IMK_ACCEL ? "accel." : "gyro.";
    if (strncasecmp(given, kind, strlen(kind)) == 0)
        given += strlen(kind);
    else if (strchr(given, '.') && strncasecmp(given, "gauss_markov", 12) != 0)
        return false;
    return strcasecmp(parameter->key, given) == 0 ||
           (parameter->term < IMK_NOISE_TERMS && strcmp(letters[parameter->term], given) == 0);
}

/* "5%", "0.05 1", or the chance of "detected 95%". */
static bool read_ratio(const char *text, double *value)
{
    double sigma;
    size_t count;
    return imk_quantity_parse(text, text + strlen(text), imk_unit_of("%").dimension, 1, value,
                              &sigma, &count, NULL, NULL) == IMK_OK &&
           *value > 0 && isfinite(*value);
}

/* The value behind the name. @return NULL, or the code of what is wrong */
static const char *read_value(const char *value, imk_plan_requirement *requirement)
{
    if (strncasecmp(value, "detected", 8) != 0 || (value[8] != ' ' && value[8] != '\0'))
        return read_ratio(value, &requirement->relative) ? NULL : "requirement";
    value += 8 + strspn(value + 8, " ");
    requirement->detection = 0.95;
    const bool read =
        !*value || (read_ratio(value, &requirement->detection) && requirement->detection < 1);
    return read ? NULL : "requirement_chance";
}

static imk_status add_requirement(imk_record_plan *p, const char *text, size_t length,
                                  imk_error *error)
{
    imk_plan_requirement asked = {.relative = 0};
    char name[sizeof asked.text];
    const size_t blank = strspn(text, " ");
    length = length > blank ? length - blank : 0;
    snprintf(asked.text, sizeof asked.text, "%.*s",
             (int)(length < sizeof name ? length : sizeof name - 1), text + blank);
    const size_t named = strcspn(asked.text, " ");
    snprintf(name, sizeof name, "%.*s", (int)named, asked.text);
    const char *value = asked.text + named, *wrong = read_value(value + strspn(value, " "), &asked);
    if (wrong)
        return imki_fail(&p->findings, error, IMK_ERROR_SYNTAX, wrong, asked.text, 0, NULL);
    bool found = false;
    for (size_t k = 0; k < p->parameter_count; k++) {
        if (!names(&p->parameter[k], name))
            continue;
        if (p->requirement_count == IMK_PLAN_REQUIREMENTS_MAX)
            return imki_fail(&p->findings, error, IMK_ERROR_SYNTAX, "requirements", NULL,
                             IMKI_NUMBERS(IMK_PLAN_REQUIREMENTS_MAX));
        asked.parameter = k;
        p->requirement[p->requirement_count++] = asked;
        found = true;
    }
    return found ? IMK_OK
                 : imki_fail(&p->findings, error, IMK_ERROR_NAME_UNKNOWN, "no_such_noise", name, 0,
                             NULL);
}

imk_status imki_plan_requirements(imk_record_plan *p, imk_error *error)
{
    imk_status status = IMK_OK;
    for (const char *text = p->settings.want; status == IMK_OK && text && *text;) {
        const size_t length = strcspn(text, ",");
        status = add_requirement(p, text, length, error);
        text += length + (text[length] == ',');
    }
    return status;
}
