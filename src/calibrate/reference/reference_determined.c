/* SPDX-License-Identifier: Apache-2.0 */
/* Which parameters a set of known inputs tells apart.
 *
 * Of every axis the normal matrix of its regressors is formed over all observations of known input,
 * weighted by 1/sigma^2. Candidates are taken in order; one is free when, after those taken before
 * it are eliminated from its regressor,
 *
 *     1. what is left is above 1e-4 of the regressor itself: it is not a combination of others;
 *     2. its root mean square is above 1e-3 of what the largest input could do: a tilt of a
 *        milliradian, or the Earth's rate beside those of the table, is no experiment;
 *     3. the sigma that follows is below a limit beyond which a number says nothing.
 *
 * The three components of g-sensitivity go together: where one of them is a combination of the
 * others and the bias, as in three attitudes only, the others would take it in. */
#include "base/algebra/vector_internal.h"
#include "calibrate/estimator/calibration_internal.h"
#include "model/model_schema_internal.h"
#include "reference_internal.h"

#include "imukit/linear_algebra.h"

#include <math.h>
#include <string.h>

enum { COLUMNS = 64 };

static const double own_share = 1e-4, least_effect = 1e-3;

typedef struct design {
    size_t columns;
    imk_model_parameter parameter[COLUMNS];
    bool promised[COLUMNS], hidden[COLUMNS];
    double normal[COLUMNS * COLUMNS];
    double weight;             /* sum of weights */
    double input, force, spin; /* largest input of the sensor, force, and rate^2 or acceleration */
    size_t taken_count;
    size_t taken[COLUMNS];
    double factor[COLUMNS * COLUMNS];
} design;

/* Effect of one unit of the parameter at the largest input, and the largest sigma worth having:
 * 1 % of a scale factor, of the largest input for the powers; a hundredth of a rad/s per m/s^2,
 * which is 5 deg/s per g; 50 mm. */
static void scale_of(const design *d, int term, double *effect, double *limit)
{
    const double u = d->input, f = fmax(d->force, 1.0);
    const imki_form form = imki_terms[term].form;
    int n = form == IMKI_FORM_CROSS ? 2 : 1; /* of u^n */
    *effect = 1.0;
    *limit = HUGE_VAL;
    switch (form) {
    case IMKI_FORM_POWER:
        n = imki_power_degree(term);
        /* fall through */
    case IMKI_FORM_INPUT:
    case IMKI_FORM_SEEN:
    case IMKI_FORM_CROSS:
        for (int k = 1; k < n; k++)
            *effect *= u;
        *limit = 0.01 / *effect;
        *effect *= u;
        break;
    case IMKI_FORM_FORCE:
        *effect = f;
        *limit = 0.01;
        break;
    case IMKI_FORM_PRODUCT:
        *effect = f * f;
        *limit = 0.01;
        break;
    case IMKI_FORM_PLACE:
        *effect = d->spin;
        *limit = 0.05;
        break;
    default:
        break;
    }
}

static void add_observation(design *d, const imk_calibration *c, const imk_observation *o,
                            int sensor, int axis)
{
    const imk_triad *triad = imk_model_triad(&c->model, sensor);
    double row[COLUMNS], sigma = o->sigma[sensor][axis];
    if (c->record[o->record]->counts[sensor])
        sigma /= fabs(triad->sensitivity.value[axis]);
    if (!(fabs(o->reading[sensor][axis]) < HUGE_VAL) || !(sigma > 0.0 && sigma < HUGE_VAL))
        return;
    const double known = sensor == IMK_GYRO ? o->heading_variance[axis] : 0.0;
    const double weight = 1.0 / (sigma * sigma + known);
    imki_calibration_regressors(&c->model, d->columns, d->parameter, sensor, axis, o->rate,
                                o->force, o->angular_acceleration, o->temperature,
                                o->temperature_rate, row);
    for (size_t i = 0; i < d->columns; i++)
        for (size_t j = 0; j <= i; j++)
            d->normal[i * COLUMNS + j] += weight * row[i] * row[j];
    d->weight += weight;
    const double rate = imki_norm3(o->rate), force = imki_norm3(o->force);
    d->input = fmax(d->input, sensor == IMK_GYRO ? rate : force);
    d->force = fmax(d->force, force);
    d->spin = fmax(d->spin, fmax(rate * rate, imki_norm3(o->angular_acceleration)));
}

static double normal_at(const design *d, size_t i, size_t j)
{
    return i > j ? d->normal[i * COLUMNS + j] : d->normal[j * COLUMNS + i];
}

/* Square of what is left of a column after those taken, as a share of its own square; 0 when it
 * cannot be told. Columns are scaled to unit length first. */
static double left_over(design *d, size_t column)
{
    const size_t n = d->taken_count + 1;
    d->taken[n - 1] = column;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
            d->factor[i * n + j] = normal_at(d, d->taken[i], d->taken[j]) /
                                   sqrt(normal_at(d, d->taken[i], d->taken[i]) *
                                        normal_at(d, d->taken[j], d->taken[j]));
    if (imk_cholesky_factor(n, d->factor) != IMK_OK)
        return 0.0;
    const double pivot = d->factor[n * n - 1];
    return pivot * pivot;
}

static bool determined(design *d, size_t column)
{
    const double own = normal_at(d, column, column);
    double effect, limit;
    if (!(own > 0.0))
        return false;
    const double share = left_over(d, column);
    const double left = share * own;
    scale_of(d, d->parameter[column].term, &effect, &limit);
    return share > own_share * own_share && sqrt(left / d->weight) > least_effect * effect &&
           1.0 / sqrt(left) < limit;
}

/* A column that is the same in all observations is one with the bias, and concerns no other. */
static bool is_constant(const design *d, size_t column, double bias_effect)
{
    const double own = normal_at(d, column, column), sum = bias_effect;
    double effect, limit;
    scale_of(d, d->parameter[column].term, &effect, &limit);
    return sqrt(fmax(own - sum * sum / d->weight, 0.0) / d->weight) <= least_effect * effect;
}

/* ---- taking columns --------------------------------------------------------------------------
 */

static bool is_free(const imk_calibration *c, const imk_model_parameter *parameter)
{
    for (size_t p = 0; p < c->parameter_count; p++)
        if (memcmp(&c->parameter[p], parameter, sizeof *parameter) == 0)
            return true;
    return false;
}

static void add_column(design *d, imk_model_parameter parameter, bool promised, bool hidden)
{
    for (size_t i = 0; i < d->columns; i++)
        if (memcmp(&d->parameter[i], &parameter, sizeof parameter) == 0)
            return;
    if (d->columns < COLUMNS) {
        d->promised[d->columns] = promised;
        d->hidden[d->columns] = hidden;
        d->parameter[d->columns++] = parameter;
    }
}

/* Elements of accelerometers' misalignments that the frame has taken; see imki_free_term(). */
static bool fixed_by_frame(const imk_calibration *c, const imk_model_parameter *p)
{
    if (p->sensor != IMK_ACCEL || p->term != IMK_MODEL_MISALIGNMENT ||
        c->model.accel.axis_count != 3)
        return false;
    return c->frame == IMK_FRAME_UPPER ? p->element < p->axis
                                       : c->frame == IMK_FRAME_LOWER && p->element > p->axis;
}

static void collect(design *d, const imk_calibration *c, int sensor, int axis, size_t count,
                    const imki_candidate *candidate)
{
    const imk_triad *triad = imk_model_triad(&c->model, sensor);
    for (size_t p = 0; p < c->parameter_count; p++)
        if (c->parameter[p].sensor == sensor && c->parameter[p].axis == axis)
            add_column(d, c->parameter[p], false, false);
    for (size_t i = 0; i < count; i++) {
        const int elements = imk_model_term_elements(sensor, candidate[i].term);
        for (int e = 0; candidate[i].sensor == sensor && e < elements; e++) {
            const imk_model_parameter p = {(uint8_t)sensor, candidate[i].term, (uint8_t)axis,
                                           (uint8_t)e};
            const bool diagonal =
                p.term == IMK_MODEL_MISALIGNMENT && triad->axis_count == 3 && e == axis;
            if (!diagonal && !fixed_by_frame(c, &p))
                add_column(d, p, candidate[i].promised, candidate[i].hidden);
        }
    }
}

/* Sum of weight times column: its product with the bias, when that is a column. */
static double product_with_bias(const design *d, size_t column)
{
    for (size_t i = 0; i < d->columns; i++)
        if (d->parameter[i].term == IMK_MODEL_BIAS)
            return normal_at(d, column, i);
    return 0.0;
}

/* Decide about the columns; those of g-sensitivity fall together. */
static void decide(design *d, const imk_calibration *c, bool accepted[COLUMNS])
{
    bool together = true;
    for (int pass = 0; pass < 2; pass++) {
        bool torn = false;
        d->taken_count = 0;
        for (size_t i = 0; i < d->columns; i++) {
            const bool g = d->parameter[i].term == IMK_MODEL_G_SENSITIVITY;
            const bool already = is_free(c, &d->parameter[i]);
            accepted[i] = !d->hidden[i] && (together || !g || already) && determined(d, i);
            if (accepted[i])
                d->taken[d->taken_count++] = i;
            else if (g && !already && !d->hidden[i] && !is_constant(d, i, product_with_bias(d, i)))
                torn = true;
        }
        if (!torn)
            return;
        together = false;
    }
}

static void report(const imki_procedure_call *call, imk_model_parameter parameter)
{
    imk_procedure_findings *f = call->findings;
    if (f->undetermined_count < IMK_UNDETERMINED_MAX)
        f->undetermined[f->undetermined_count] = parameter;
    f->undetermined_count++;
}

/* A term that acts on the readings and is not determined is part of what the others are uncertain
 * by: the bias of a gyro holds g-sensitivity times the mean force. */
static imk_status consider(const imki_procedure_call *call, const design *d, size_t column)
{
    const double sigma = call->settings->g_sensitivity_sigma;
    const bool no_estimate = is_constant(d, column, product_with_bias(d, column));
    if (d->parameter[column].term != IMK_MODEL_G_SENSITIVITY || !(sigma > 0.0) ||
        !(normal_at(d, column, column) > 0.0))
        return IMK_OK;
    return imk_calibration_consider(call->calibration, d->parameter[column], sigma,
                                    d->hidden[column] || no_estimate);
}

static imk_status free_of_axis(const imki_procedure_call *call, int sensor, int axis, size_t count,
                               const imki_candidate *candidate)
{
    imk_calibration *c = call->calibration;
    design *d = call->workspace;
    bool accepted[COLUMNS] = {false};
    memset(d, 0, sizeof *d);
    collect(d, c, sensor, axis, count, candidate);
    for (size_t i = 0; i < c->observation_count; i++)
        if (c->observation[i].knowledge != IMK_INPUT_GRAVITY)
            add_observation(d, c, &c->observation[i], sensor, axis);
    if (!(d->weight > 0.0))
        return IMK_OK; /* the axis was not observed */
    decide(d, c, accepted);
    for (size_t i = 0; i < d->columns; i++) {
        const imk_model_parameter p = d->parameter[i];
        if (is_free(c, &p))
            continue;
        if (!accepted[i] && d->promised[i])
            report(call, p);
        if ((accepted[i] ? imk_calibration_free(c, p.sensor, p.term, p.axis, p.element)
                         : consider(call, d, i)) != IMK_OK)
            return imk_error_set(call->error, IMK_ERROR_RANGE, "parameters", NULL,
                                 "at most 64 parameters can be estimated at once");
    }
    return IMK_OK;
}

size_t imki_free_determined_workspace(void)
{
    return sizeof(design);
}

imk_status imki_free_determined(const imki_procedure_call *call, size_t count,
                                const imki_candidate *candidate)
{
    if (call->keep_free)
        return IMK_OK;
    const imk_test_record *record = call->calibration->record[call->record];
    for (int sensor = 0; sensor < 2; sensor++)
        for (int axis = 0; axis < record->axis_count[sensor]; axis++) {
            const imk_status status = free_of_axis(call, sensor, axis, count, candidate);
            if (status != IMK_OK)
                return status;
        }
    return IMK_OK;
}
