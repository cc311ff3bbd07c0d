/* SPDX-License-Identifier: Apache-2.0 */
/* Validation of a model: its triads and its timing, field by field, then what is said of them:
 * evidence and correlation. */
#include "model_internal.h"
#include "model_schema_internal.h"

#include <math.h>
#include <string.h>

static imk_status refuse(imki_fault *fault, const char *field, imk_status status, int index,
                         double value, double limit, const char *expected)
{
    *fault = (imki_fault){.field = field,
                          .element = -1,
                          .index = index,
                          .value = value,
                          .limit = limit,
                          .expected = expected};
    return status;
}

static imk_status check_text(const char *text, size_t size, const char *name, imki_fault *fault)
{
    if (memchr(text, '\0', size))
        return IMK_OK;
    return refuse(fault, name, IMK_ERROR_ARGUMENT, -1, 0, 0, "a text that ends within its array");
}

static imk_status check_interval(const imk_interval *interval, const imk_triad *triad, int kind,
                                 imki_fault *fault)
{
    static const char place[] = "evidence.interval_95";
    if (!memchr(interval->key, '\0', sizeof interval->key))
        return refuse(fault, place, IMK_ERROR_ARGUMENT, -1, 0, 0, "a key that ends in its array");
    const imki_field *list;
    const imki_field *field = imki_field_find(interval->key, kind, &list);
    if (!field || field->shape != IMKI_AXES || (field->flags & IMKI_FLOOR))
        return refuse(fault, place, IMK_ERROR_KEY_UNKNOWN, -1, 0, 0,
                      "the path of a parameter with one number per axis, like "
                      "noise.bias_instability");
    int last = list ? IMK_TERMS_MAX - 1 : 0;
    if (!(interval->instance >= 0 && interval->instance <= last))
        return refuse(fault, place, IMK_ERROR_RANGE, -1, interval->instance, last,
                      "the number of a list term, from 0");
    imk_status status = IMK_OK;
    for (int i = 0; status == IMK_OK && i < triad->axis_count; i++) {
        double lower = interval->lower.value[i], upper = interval->upper.value[i];
        if (!isfinite(lower) || !isfinite(upper))
            status = refuse(fault, place, IMK_ERROR_NOT_FINITE, i, isfinite(lower) ? upper : lower,
                            0, "a finite number");
        else if (!(lower <= upper))
            status = refuse(fault, place, IMK_ERROR_RANGE, i, lower, upper,
                            "a lower end that is not above the upper one");
    }
    fault->member = interval->key;
    return status;
}

static imk_status check_evidence(const imk_evidence *evidence, const imk_triad *triad, int kind,
                                 imki_fault *fault)
{
    static const char place[] = "evidence";
    if (!triad->present)
        return IMK_OK;
    imk_status status = check_text(evidence->source, sizeof evidence->source, place, fault);
    if (status == IMK_OK)
        status = check_text(evidence->method, sizeof evidence->method, place, fault);
    if (status == IMK_OK)
        status = check_text(evidence->frame, sizeof evidence->frame, place, fault);
    if (status == IMK_OK &&
        !(evidence->interval_count >= 0 && evidence->interval_count <= IMK_INTERVALS_MAX))
        status = refuse(fault, place, IMK_ERROR_RANGE, -1, evidence->interval_count,
                        IMK_INTERVALS_MAX, "0 to 24 intervals");
    for (int i = 0; status == IMK_OK && i < evidence->interval_count; i++) {
        status = check_interval(&evidence->interval[i], triad, kind, fault);
        for (int j = 0; status == IMK_OK && j < i; j++)
            if (strcmp(evidence->interval[i].key, evidence->interval[j].key) == 0 &&
                evidence->interval[i].instance == evidence->interval[j].instance)
                status = refuse(fault, place, IMK_ERROR_KEY_DUPLICATE, -1, 0, 0,
                                "one interval for each parameter");
    }
    return status;
}

/* Numbers of sensors that are not present are not looked at, but must be numbers of some model. */
static imk_status check_correlated(const imk_model *model, int index, imki_fault *fault)
{
    static const char place[] = "correlation.parameters";
    const imk_model_parameter parameter = model->correlation.parameter[index];
    if (!imki_model_parameter_fits(model, parameter))
        return refuse(fault, place, IMK_ERROR_KEY_UNKNOWN, index, 0, 0,
                      "a number of the model, like accel.bias.fixed.x");
    for (int i = 0; i < index; i++)
        if (memcmp(&model->correlation.parameter[i], &parameter, sizeof parameter) == 0)
            return refuse(fault, place, IMK_ERROR_KEY_DUPLICATE, index, 0, 0,
                          "name every parameter once");
    return IMK_OK;
}

static imk_status check_correlation(const imk_model *model, imki_fault *fault)
{
    static const char place[] = "correlation.values";
    const imk_correlation *correlation = &model->correlation;
    if (!(correlation->count >= 0 && correlation->count <= IMK_CORRELATED_MAX))
        return refuse(fault, place, IMK_ERROR_RANGE, -1, correlation->count, IMK_CORRELATED_MAX,
                      "0 to 64 parameters");
    imk_status status = IMK_OK;
    for (int i = 0; status == IMK_OK && i < correlation->count; i++)
        status = check_correlated(model, i, fault);
    for (int i = 0; status == IMK_OK && i < correlation->count; i++)
        for (int j = 0; j < i; j++) {
            const double value = (double)correlation->value[i * (i - 1) / 2 + j];
            if (!(value >= -1 && value <= 1))
                return refuse(fault, place, IMK_ERROR_RANGE, i, value, 1,
                              "use correlations from -1 to 1");
        }
    return status;
}

/* The first that is wrong. */
static imk_status check(const imk_model *model, imki_fault *fault)
{
    const imk_triad *triads[IMK_KINDS] = {&model->gyro, &model->accel, &model->mag};
    const imk_evidence *evidence[IMK_KINDS] = {&model->gyro_evidence, &model->accel_evidence,
                                               &model->mag_evidence};
    imk_status status = check_text(model->name, sizeof model->name, "name", fault);
    if (status == IMK_OK)
        status = check_text(model->description, sizeof model->description, "description", fault);
    if (status == IMK_OK)
        status = check_text(model->residual_of, sizeof model->residual_of, "residual_of", fault);
    if (status == IMK_OK && !model->gyro.present && !model->accel.present && !model->mag.present)
        status =
            refuse(fault, "gyro", IMK_ERROR_KEY_MISSING, -1, 0, 0, "a gyro, an accel, or both");
    for (int kind = 0; status == IMK_OK && kind < IMK_KINDS; kind++) {
        status = imki_triad_check(triads[kind], kind, fault);
        fault->part = imki_kind_names[kind];
    }
    if (status == IMK_OK) {
        status = imki_timing_check(&model->timing, fault);
        fault->part = "timing";
    }
    for (int kind = 0; status == IMK_OK && kind < IMK_KINDS; kind++) {
        status = check_evidence(evidence[kind], triads[kind], kind, fault);
        fault->part = imki_kind_names[kind];
    }
    return status == IMK_OK ? check_correlation(model, fault) : status;
}

/* ---- the message ---- */

enum { PATH_SIZE = 96 };

/* What does not fit is cut. */
static void write_place(const imki_fault *fault, char path[PATH_SIZE])
{
    /* Lists have fewer than ten elements: IMK_TERMS_MAX. */
    const char element[4] = {'[', (char)('0' + fault->element), ']', '\0'};
    const char *const pieces[] = {fault->part,
                                  fault->part ? "." : NULL,
                                  fault->field,
                                  fault->element >= 0 ? element : NULL,
                                  fault->member ? "." : NULL,
                                  fault->member};
    size_t length = 0;
    for (size_t i = 0; i < sizeof pieces / sizeof pieces[0]; i++)
        for (const char *c = pieces[i]; c && *c && length + 1 < PATH_SIZE; c++)
            path[length++] = *c;
    path[length] = '\0';
}

static void write_error(imk_status status, const imki_fault *fault, imk_error *error)
{
    char path[PATH_SIZE];
    write_place(fault, path);
    imk_error_set(error, status, path, fault->found, fault->expected);
    error->index = fault->index;
    error->value = fault->value;
    error->limit = fault->limit;
}

imk_status imk_model_validate(const imk_model *model, imk_error *error)
{
    if (!model || model->cookie != IMKI_MODEL_COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "model", "",
                             "a model from imk_model_default() or from a file");
    imki_fault fault;
    const imk_status status = check(model, &fault);
    if (status != IMK_OK && error)
        write_error(status, &fault, error);
    return status;
}
