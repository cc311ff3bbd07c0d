/* SPDX-License-Identifier: Apache-2.0 */
/* Amounts, output filter and resonances of a spectrum, fitted jointly.
 *
 * With S the spectrum, D_bi its derivative by the logarithm of parameter i and v the degrees of
 * freedom of a band, information and gradient of the likelihood are
 *
 *     H = 1/2 sum_b v_b D_b D_b^T/S_b^2,    g = 1/2 sum_b v_b D_b (P_b - S_b)/S_b^2
 *
 * and a step is (H + lambda diag H)^-1 g, lambda raised until it climbs [MARQUARDT1963]. */
#include "joint_shape_internal.h"

#include "imukit/distributions.h"
#include "imukit/elementary.h"
#include "imukit/linear_algebra.h"

#include <math.h>

/* Below this part of the sample rate lies what the slow terms and the lines
 * explain. */
static const double LOWEST = 0.01;
static const double Q_MOST = 200;
enum { STEPS = 60 };

double *imki_joint_fit_row(const imki_joint_fit *j, size_t i)
{
    if (i >= 2 * IMKI_TEMPLATES_MAX)
        return j->w->trial->change[i - 2 * IMKI_TEMPLATES_MAX];
    return i < IMKI_TEMPLATES_MAX ? j->w->trial->shape[i]
                                  : j->w->chosen->shape[i - IMKI_TEMPLATES_MAX];
}
_Static_assert((int)IMKI_SHAPE_ROWS <= 2 * (int)IMKI_TEMPLATES_MAX + (int)IMKI_GAUSS_MARKOV_MAX,
               "rows of two fits");
_Static_assert((int)IMKI_SHAPE_PARAMETERS *(int)IMKI_SHAPE_PARAMETERS <= (int)IMKI_BANDS_MAX,
               "a matrix in a row");

static double *place_of(imki_joint_fit *j, size_t i)
{
    const size_t index = j->parameter[i].index;
    switch (j->parameter[i].kind) {
    case IMKI_SHAPE_BANDWIDTH:
        return &j->result->filter.bandwidth;
    case IMKI_SHAPE_DAMPING:
        return &j->result->filter.damping;
    case IMKI_SHAPE_FREQUENCY:
        return &j->result->resonance[index].frequency;
    case IMKI_SHAPE_QUALITY:
        return &j->result->resonance[index].q;
    case IMKI_SHAPE_AMOUNT:
        break;
    }
    return &j->w->fit->amount[index];
}

/* The template that a parameter shapes. */
static size_t slot_of(const imki_joint_fit *j, size_t i)
{
    const imki_shape_parameter p = j->parameter[i];
    if (p.kind == IMKI_SHAPE_AMOUNT)
        return p.index;
    return p.kind == IMKI_SHAPE_FREQUENCY || p.kind == IMKI_SHAPE_QUALITY
               ? IMKI_FIRST_RESONANCE + p.index
               : (size_t)IMK_NOISE_WHITE;
}

static void make_shape(const imki_joint_fit *j, size_t slot, double *shape)
{
    if (slot == IMK_NOISE_WHITE) {
        imki_filter_shape(j->result->filter, j->w->bands, shape);
    } else {
        const imk_resonance *r = &j->result->resonance[slot - IMKI_FIRST_RESONANCE];
        imki_resonance_shape(r->frequency, r->q, j->w->bands, shape);
    }
}

void imki_joint_fit_update(imki_joint_fit *j)
{
    imki_fit *fit = j->w->fit;
    imki_fit_set_filter(fit, j->result->filter, j->w->bands);
    for (size_t slot = IMKI_FIRST_RESONANCE; slot < fit->templates; slot++)
        if (fit->active[slot])
            make_shape(j, slot, fit->shape[slot]);
}

static void add_parameter(imki_joint_fit *j, imki_shape_kind kind, size_t index)
{
    j->parameter[j->count++] = (imki_shape_parameter){kind, index};
}

static void list_parameters(imki_joint_fit *j)
{
    const imki_fit *fit = j->w->fit;
    j->count = 0;
    for (size_t slot = 0; slot < fit->templates; slot++)
        if (fit->active[slot] && fit->amount[slot] > 0)
            add_parameter(j, IMKI_SHAPE_AMOUNT, slot);
    if (j->result->filter.bandwidth > 0 && fit->amount[IMK_NOISE_WHITE] > 0) {
        add_parameter(j, IMKI_SHAPE_BANDWIDTH, 0);
        if (j->result->filter.damping > 0)
            add_parameter(j, IMKI_SHAPE_DAMPING, 0);
    }
    for (size_t r = 0; IMKI_FIRST_RESONANCE + r < fit->templates; r++) {
        const size_t slot = IMKI_FIRST_RESONANCE + r;
        if (fit->active[slot] && fit->amount[slot] > 0) {
            add_parameter(j, IMKI_SHAPE_FREQUENCY, r);
            add_parameter(j, IMKI_SHAPE_QUALITY, r);
        }
    }
}

static size_t band_at(const imki_bands *bands, double frequency)
{
    size_t low = 0, high = bands->count > 0 ? bands->count - 1 : 0;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (bands->frequency[middle] < frequency)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Four bands in its half-power width. */
double imki_quality_resolved(const imki_bands *bands, double frequency)
{
    const size_t b = band_at(bands, frequency);
    const size_t below = b > 0 ? b - 1 : b, above = b + 1 < bands->count ? b + 1 : b;
    const double width = (bands->frequency[above] - bands->frequency[below]) /
                         (double)(above > below ? above - below : 1);
    return fmin(Q_MOST, fmax(1, 0.25 * frequency / width));
}

/* A value after a step, no further than a step may go and within the limits of
 * its kind. */
static double moved(const imki_joint_fit *j, size_t i, double value, double step)
{
    const imki_bands *bands = j->w->bands;
    const imk_resonance *resonances = j->result->resonance;
    const size_t index = j->parameter[i].index; /* of a resonance, for its two kinds */
    double reach = 0.7, low = 0, high = HUGE_VAL;
    switch (j->parameter[i].kind) {
    case IMKI_SHAPE_BANDWIDTH:
        low = 1e-3 / bands->dt;
        high = 10 / bands->dt;
        break;
    case IMKI_SHAPE_DAMPING: /* from the limit of imk_low_pass */
        low = 0.05;
        high = fmax(value, IMKI_OVERDAMPED);
        break;
    case IMKI_SHAPE_FREQUENCY:
        reach = 0.5 / resonances[index].q;
        low = fmin(value, LOWEST / bands->dt);
        high = 0.5 / bands->dt;
        break;
    case IMKI_SHAPE_QUALITY:
        low = fmin(value, IMKI_WIDEST);
        high = fmax(value, imki_quality_resolved(bands, resonances[index].frequency));
        break;
    case IMKI_SHAPE_AMOUNT:
        break;
    }
    return fmin(fmax(value * imk_exp(fmin(fmax(step, -reach), reach)), low), high);
}

/* Those of a shape by differences: a hundred-thousandth is far from rounding,
 * and from curvature for any quality. */
static void differentiate(imki_joint_fit *j)
{
    const double part = 1e-5;
    const size_t bands = j->w->bands->count;
    const imki_fit *fit = j->w->fit;
    for (size_t i = 0; i < j->count; i++) {
        const size_t slot = slot_of(j, i);
        const double amount = fit->amount[slot], *shape = fit->shape[slot];
        double *derivative = imki_joint_fit_row(j, i);
        if (j->parameter[i].kind == IMKI_SHAPE_AMOUNT) {
            for (size_t b = 0; b < bands; b++)
                derivative[b] = amount * shape[b];
            continue;
        }
        double *value = place_of(j, i);
        const double here = *value;
        *value = here * (1 + part);
        make_shape(j, slot, derivative);
        *value = here;
        for (size_t b = 0; b < bands; b++)
            derivative[b] = amount * (derivative[b] - shape[b]) / part;
    }
}

void imki_joint_fit_linearise(imki_joint_fit *j)
{
    list_parameters(j);
    differentiate(j);
    const imki_bands *bands = j->w->bands;
    const size_t p = j->count, count = bands->count;
    double *weight = imki_joint_fit_row(j, IMKI_SHAPE_WEIGHT);
    double *excess = imki_joint_fit_row(j, IMKI_SHAPE_EXCESS);
    double *restrict weighted = imki_joint_fit_row(j, IMKI_SHAPE_SCRATCH);
    double *information = imki_joint_fit_row(j, IMKI_SHAPE_INFORMATION);
    for (size_t b = 0; b < count; b++) {
        const double s = imki_fit_spectrum(j->w->fit, b);
        weight[b] = 0.5 * bands->degrees[b] / (s * s);
        excess[b] = bands->power[b] - s;
    }
    for (size_t i = 0; i < p; i++) {
        const double *row = imki_joint_fit_row(j, i);
        double sum = 0;
        for (size_t b = 0; b < count; b++) {
            weighted[b] = weight[b] * row[b];
            sum += weighted[b] * excess[b];
        }
        j->gradient[i] = sum;
        for (size_t k = 0; k <= i; k++) {
            const double *column = imki_joint_fit_row(j, k);
            sum = 0;
            for (size_t b = 0; b < count; b++)
                sum += weighted[b] * column[b];
            information[i * p + k] = information[k * p + i] = sum;
        }
    }
}

/* The first `count` parameters' part of the information, scaled to a unit diagonal plus lambda, as
 * its Cholesky factor. */
static bool factor(const imki_joint_fit *j, size_t count, double lambda, double *scale)
{
    const double *information = imki_joint_fit_row(j, IMKI_SHAPE_INFORMATION);
    double *h = imki_joint_fit_row(j, IMKI_SHAPE_FACTOR);
    for (size_t i = 0; i < count; i++) {
        const double d = information[i * j->count + i];
        scale[i] = d > 0 ? 1 / sqrt(d) : 0;
    }
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < count; k++)
            h[i * count + k] =
                i == k ? 1 + lambda : information[i * j->count + k] * scale[i] * scale[k];
    return imk_cholesky_factor(count, h) == IMK_OK;
}

bool imki_joint_fit_factor(const imki_joint_fit *j, double lambda, double *scale)
{
    return factor(j, j->count, lambda, scale);
}

/* What a step changes of the likelihood; the ends of the record and its ramp do
 * not. */
static double likelihood(const imki_joint_fit *j)
{
    const imki_bands *bands = j->w->bands;
    double sum = 0;
    for (size_t b = 0; b < bands->count; b++) {
        const double s = imki_fit_spectrum(j->w->fit, b);
        sum += bands->degrees[b] * imki_deviance(bands->power[b], s);
    }
    return -0.5 * sum;
}

/* One step, the damping raised until it climbs. False at the top. */
static bool climb(imki_joint_fit *j, double *lambda)
{
    const double before = likelihood(j);
    double start[IMKI_SHAPE_PARAMETERS], next[IMKI_SHAPE_PARAMETERS];
    imki_joint_fit_linearise(j);
    const size_t count = j->count;
    for (size_t i = 0; i < count; i++)
        start[i] = *place_of(j, i);
    for (; *lambda < 1e6; *lambda *= 10) {
        double scale[IMKI_SHAPE_PARAMETERS], step[IMKI_SHAPE_PARAMETERS];
        if (!imki_joint_fit_factor(j, *lambda, scale))
            continue;
        for (size_t i = 0; i < count; i++)
            step[i] = j->gradient[i] * scale[i];
        imk_cholesky_solve(count, imki_joint_fit_row(j, IMKI_SHAPE_FACTOR), step);
        for (size_t i = 0; i < count; i++)
            next[i] = moved(j, i, start[i], step[i] * scale[i]);
        for (size_t i = 0; i < count; i++)
            *place_of(j, i) = next[i];
        imki_joint_fit_update(j);
        const double gain = likelihood(j) - before;
        if (gain > 0) {
            *lambda = fmax(1e-6, 0.1 * *lambda);
            return gain > j->enough;
        }
        for (size_t i = 0; i < count; i++)
            *place_of(j, i) = start[i];
    }
    imki_joint_fit_update(j);
    return false;
}

double imki_joint_fit_maximise(imki_joint_fit *j)
{
    double lambda = 1e-3;
    imki_joint_fit_update(j);
    imki_fit_maximise(j->w->fit, j->w->bands);
    for (int step = 0; step < STEPS && climb(j, &lambda); step++)
        continue;
    /* Amounts that have reached zero, or leave it. */
    const double best = imki_fit_maximise(j->w->fit, j->w->bands);
    for (size_t slot = IMKI_FIRST_RESONANCE; slot < j->w->fit->templates; slot++)
        if (j->w->fit->active[slot])
            j->result->resonance[slot - IMKI_FIRST_RESONANCE].sigma = sqrt(j->w->fit->amount[slot]);
    return best;
}

/* Variances of the logarithms of the first `count` parameters, the others free; false if they
 * cannot be told apart. */
static bool variances(const imki_joint_fit *j, size_t count, size_t wanted, double *variance)
{
    double scale[IMKI_SHAPE_PARAMETERS];
    if (!factor(j, count, 1e-9, scale))
        return false;
    double *inverse = imki_joint_fit_row(j, IMKI_SHAPE_INVERSE);
    imk_cholesky_inverse(count, imki_joint_fit_row(j, IMKI_SHAPE_FACTOR), inverse);
    for (size_t i = 0; i < wanted; i++)
        variance[i] = inverse[i * count + i] * scale[i] * scale[i];
    return true;
}

/* Side of an interval, once the shapes have multiplied the variance by a factor: what they add is
 * independent of what quantization and other sets of terms have added already. `half` is the side
 * that the variance alone gives. */
static double widened(double side, double half, double factor)
{
    const double own = fmin(half, side);
    return sqrt(side * side + (factor - 1) * own * own);
}

void imki_identify_widen(imki_work *w, imk_identification *result)
{
    imki_joint_fit joint = {.w = w, .result = result}, *j = &joint;
    imki_joint_fit_linearise(j);
    size_t amounts = 0, random = 0;
    while (amounts < j->count && j->parameter[amounts].kind == IMKI_SHAPE_AMOUNT)
        random += j->parameter[amounts++].index < IMKI_FIRST_GAUSS_MARKOV;
    double fixed[IMKI_FIRST_GAUSS_MARKOV], free[IMKI_FIRST_GAUSS_MARKOV];
    if (amounts == j->count || !variances(j, amounts, random, fixed) ||
        !variances(j, j->count, random, free))
        return;
    const double quantile = imk_chi_square_quantile(w->settings->confidence, 1);
    for (size_t i = 0; i < random; i++) {
        imk_estimate *e = &result->term[j->parameter[i].index];
        const double factor = free[i] > fixed[i] ? free[i] / fixed[i] : 1;
        const double half = 0.5 * e->free_value * sqrt(quantile * fixed[i]);
        e->sigma *= sqrt(factor);
        e->lower = fmax(0, e->free_value - widened(e->free_value - e->lower, half, factor));
        e->upper = e->free_value + widened(e->upper - e->free_value, half, factor);
    }
}
