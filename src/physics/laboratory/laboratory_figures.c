/* SPDX-License-Identifier: Apache-2.0 */
/* A model of one axis as a list of figures. */
#include "laboratory_internal.h"

#include "model/model_schema_internal.h"

#include <math.h>
#include <stddef.h>

typedef struct list {
    imk_laboratory_figure *figure;
    size_t count;
} list;

static void add(list *l, const char *key, const char *si, const char *unit, double value,
                double sigma)
{
    l->figure[l->count++] = (imk_laboratory_figure){key, si, unit, value, sigma};
}

/* What an instrument shows of an input across its axis: geometry and response together, which no
 * experiment on one axis can tell apart. */
static void add_cross_axis(list *l, const imk_triad *t)
{
    static const char *const keys[] = {"misalignment.y", "misalignment.z"};
    for (int k = 0; k < 2; k++) {
        const double a = t->misalignment.sigma[0][1 + k], b = t->cross_axis.sigma[0][1 + k];
        add(l, keys[k], "1", "%", t->misalignment.value[0][1 + k] + t->cross_axis.value[0][1 + k],
            sqrt(a * a + b * b));
    }
}

static void add_power(list *l, const imk_triad *t, int kind, const imki_field *field)
{
    const imk_temperature_polynomial *p = (const void *)imki_field_values(field, t);
    add(l, field->path[kind], imki_polynomial_si(field, kind, 1),
        imki_polynomial_unit(field, kind, 1), p->coefficient[0].value[0],
        p->coefficient[0].sigma[0]);
}

static void add_row(list *l, const imk_triad *t, int kind, const imki_field *field,
                    const char *const *keys, int elements)
{
    for (int k = 0; k < elements; k++)
        add(l, keys[k], field->si[kind], field->unit[kind], imki_field_values(field, t)[k],
            imki_field_sigmas(field, t)[k]);
}

static void add_term(list *l, const imk_triad *t, int kind, int term)
{
    static const char *const g[] = {"g_sensitivity.x", "g_sensitivity.y", "g_sensitivity.z"};
    static const char *const g2[] = {"g2_sensitivity.xx", "g2_sensitivity.yy", "g2_sensitivity.zz",
                                     "g2_sensitivity.xy", "g2_sensitivity.yz", "g2_sensitivity.zx"};
    static const char *const products[] = {"cross_products.kip", "cross_products.kio",
                                           "cross_products.kpo"};
    const imki_field *field = imki_term_field(term);
    const double *value = imki_field_values(field, t);
    switch (imki_terms[term].form) {
    case IMKI_FORM_SEEN:
        if (term == IMK_MODEL_MISALIGNMENT)
            add_cross_axis(l, t);
        break;
    case IMKI_FORM_FORCE:
        add_row(l, t, kind, field, g, 3);
        break;
    case IMKI_FORM_PRODUCT:
        add_row(l, t, kind, field, g2, 6);
        break;
    case IMKI_FORM_CROSS:
        add_row(l, t, kind, field, products, 3);
        break;
    case IMKI_FORM_WARMTH:
    case IMKI_FORM_WARM_INPUT:
        add_power(l, t, kind, field);
        break;
    case IMKI_FORM_PLACE: /* no experiment on one axis finds these */
    case IMKI_FORM_DECAY:
    case IMKI_FORM_TIME:
        break;
    default:
        add(l, field->path[kind], field->si[kind], field->unit[kind], *value,
            *imki_field_sigmas(field, t));
    }
}

#define AT(member) offsetof(imk_triad, member)
enum { KEY = 0, SI = 2, UNIT = 4 };
/* What is no term: key, SI unit and unit of a sheet, each for gyros and accelerometers. */
static const struct {
    size_t offset;
    const char *text[6];
} outputs[] = {
    {AT(dead_band), {"dead_band", "dead_band", "rad/s", "m/s^2", "deg/h", "ug"}},
    {AT(bandwidth), {"bandwidth", "bandwidth", "Hz", "Hz", "Hz", "Hz"}},
    {AT(noise.quantization),
     {"noise.quantization", "noise.quantization", "rad", "m/s", "arcsec", "mm/s"}},
    {AT(noise.reading_noise),
     {"noise.reading_noise", "noise.reading_noise", "rad", "m/s", "arcsec", "mm/s"}},
    {AT(noise.angle_white),
     {"noise.angle_white", "noise.velocity_white", "rad/sqrt(Hz)", "m/s/sqrt(Hz)",
      "arcsec/sqrt(Hz)", "mm/s/sqrt(Hz)"}},
    {AT(noise.white),
     {"noise.angle_random_walk", "noise.velocity_random_walk", "rad/s/sqrt(Hz)", "m/s^2/sqrt(Hz)",
      "deg/sqrt(h)", "ug/sqrt(Hz)"}},
    {AT(noise.bias_instability),
     {"noise.bias_instability", "noise.bias_instability", "rad/s", "m/s^2", "deg/h", "ug"}},
    {AT(noise.random_walk),
     {"noise.rate_random_walk", "noise.acceleration_random_walk", "rad/s/sqrt(s)", "m/s^2/sqrt(s)",
      "deg/h/sqrt(h)", "ug/sqrt(h)"}},
};

size_t imk_laboratory_figures(const imk_model *model, int sensor, imk_laboratory_figure *figures)
{
    const imk_triad *t = sensor == IMK_GYRO ? &model->gyro : &model->accel;
    list l = {figures, 0};
    uint8_t term[IMKI_TERMS];
    const size_t count = imki_terms_in_order(sensor, term);
    for (size_t i = 0; i < count; i++)
        add_term(&l, t, sensor, term[i]);
    for (size_t i = 0; i < sizeof outputs / sizeof outputs[0]; i++) {
        const imk_axes *axes = (const void *)((const char *)t + outputs[i].offset);
        const char *const *text = outputs[i].text + sensor;
        add(&l, text[KEY], text[SI], text[UNIT], axes->value[0], axes->sigma[0]);
    }
    return l.count;
}
