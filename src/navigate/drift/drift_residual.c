/* SPDX-License-Identifier: Apache-2.0 */
/* What calibration left: a model whose known values v with 1-sigma uncertainties s are taken out
 * has, in each run, values of its own in their place,
 *
 *     v <- s n,   n normal number `component` of the stream (run, IMK_TERM_RESIDUAL, parameter,
 *                 axis),
 *
 * axis 0-7 of the gyros, 8-15 of the accelerometers, 0 for the timing. The numbers of the
 * parameters (imki_term.draw) are fixed for ever, so that a new one changes no draw of an old one;
 * components are counted along a row of the model (x, y, z), a scalar being component 0. */
#include "drift_correlation_internal.h"
#include "drift_runs_internal.h"

#include "imukit/model_parameter.h"
#include "imukit/noise.h"
#include "model/model_schema_internal.h"

#include <string.h>

/* Of the timing; those of the terms stand in their rows. */
enum { RATE_ERROR = 18, SKEW = 19 };

typedef struct draw {
    imk_random random;
    uint32_t run;
    uint8_t first_axis;
    int axis_count;
} draw;

/* One row of a parameter: value[i] <- sigma[i] n[i]. */
static void draw_row(const draw *d, int parameter, int axis, size_t count, const double *sigma,
                     double *value)
{
    double normal[6];
    bool any = false;
    for (size_t i = 0; i < count; i++)
        any = any || sigma[i] != 0.0;
    memset(value, 0, count * sizeof *value);
    if (!any)
        return;
    const uint64_t stream =
        imk_stream(d->run, IMK_TERM_RESIDUAL, (uint8_t)parameter, (uint8_t)(d->first_axis + axis));
    imk_random_normals(d->random, stream, 0, count, normal);
    for (size_t i = 0; i < count; i++)
        value[i] = sigma[i] * normal[i];
}

static void draw_scalar(const draw *d, int parameter, imk_scalar *scalar)
{
    draw_row(d, parameter, 0, 1, &scalar->sigma, &scalar->value);
}

/* Without a temperature profile what needs one does nothing. */
static void draw_term(const draw *d, int term, imk_triad *triad)
{
    const imki_form form = imki_terms[term].form;
    const size_t count = (size_t)imki_form_elements(form);
    double *value = (double *)(void *)((char *)triad + imki_terms[term].offset);
    if (form == IMKI_FORM_WARMTH || form == IMKI_FORM_WARM_INPUT)
        ((imk_temperature_polynomial *)(void *)value)->order = 0;
    else if (form == IMKI_FORM_WARMING)
        memset(value, 0, sizeof(imk_axes));
    /* A model without a warm-up states no time for it. */
    else if (form != IMKI_FORM_DECAY || triad->bias.warm_up_time.value > 0.0)
        for (int i = 0; i < d->axis_count; i++)
            draw_row(d, imki_terms[term].draw, i, count,
                     value + ((size_t)IMK_AXES_MAX + (size_t)i) * count, value + (size_t)i * count);
}

static void draw_triad(const draw *d, imk_triad *triad)
{
    for (int term = 0; term < IMKI_TERMS; term++)
        draw_term(d, term, triad);
    memset(&triad->bias.hysteresis, 0, sizeof triad->bias.hysteresis);
}

/* Correlated values: L n in place of n, which the first of them keeps. A value that has no effect
 * without a temperature profile is drawn for the sake of the others. */
static void correlate(const draw *d, const double *factor, imk_model *model)
{
    const imk_correlation *c = &model->correlation;
    double normal[IMK_CORRELATED_MAX];
    for (int i = 0; i < c->count; i++) {
        const imk_model_parameter *p = &c->parameter[i];
        const imki_form form = imki_terms[p->term].form;
        const uint8_t first = p->sensor == IMK_GYRO ? 0 : IMK_AXES_MAX;
        const uint64_t stream =
            imk_stream(d->run, IMK_TERM_RESIDUAL, (uint8_t)imki_terms[p->term].draw,
                       (uint8_t)(first + p->axis));
        double *sigma, *value = imk_model_parameter_at(model, *p, &sigma), sum = 0.0;
        imk_random_normals(d->random, stream, p->element, 1, &normal[i]);
        for (int j = 0; j <= i; j++)
            sum += factor[i * (i + 1) / 2 + j] * normal[j];
        if (value && form != IMKI_FORM_WARMTH && form != IMKI_FORM_WARM_INPUT &&
            form != IMKI_FORM_WARMING)
            *value = *sigma * sum;
    }
}

void imki_drift_residual(imk_model *model, const double *factor, imk_random random, uint32_t run)
{
    draw d = {random, run, 0, model->gyro.axis_count};
    draw_scalar(&d, RATE_ERROR, &model->timing.rate_error);
    draw_scalar(&d, SKEW, &model->timing.skew);
    draw_triad(&d, &model->gyro);
    d.first_axis = IMK_AXES_MAX;
    d.axis_count = model->accel.axis_count;
    draw_triad(&d, &model->accel);
    correlate(&d, factor, model);
}
