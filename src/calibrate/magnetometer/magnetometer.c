/* SPDX-License-Identifier: Apache-2.0 */
/* The fit of a magnetometer: iterations, outliers, the factor of the sigmas, the result. */
#include "magnetometer_internal.h"

#include "base/algebra/vector_internal.h"
#include "base/refuse_internal.h"
#include "calibrate/standstill/median_internal.h"
#include "imukit/distributions.h"

#include <math.h>
#include <string.h>

enum { STEPS = 100, FEW_STEPS = 6, PASSES = 8, ROBUST_PASSES = 6, LAGS = 400 };

/* Residuals beyond this share of variance are a field that differs from place to place, which adds
 * to the noise of each mean, short or long. */
static const double disturbed = 2.0;

imk_magnetometer imk_magnetometer_default(void)
{
    const double none = (double)NAN;
    return (imk_magnetometer){.cookie = IMKI_MAG_COOKIE,
                              .frame = IMK_FRAME_SYMMETRIC,
                              .field = none,
                              .field_sigma = none,
                              .robust = true};
}

/* ---- checks ---------------------------------------------------------------------------------- */

static imk_status check_known(const imk_magnetometer *p, imk_error *error)
{
    const bool field = !isnan(p->field);
    if (field && !(p->field > 0.0 && p->field < 1.0))
        return imki_refuse(error, IMK_ERROR_RANGE, "field", p->field, 1.0, "above 0 T, below 1 T");
    if (field && !(p->field_sigma >= 0.0 && p->field_sigma < p->field))
        return imki_refuse(error, IMK_ERROR_RANGE, "field", p->field_sigma, p->field,
                           "a sigma of 0 or more, below the field");
    return IMK_OK;
}

static imk_status check(const imk_magnetometer *p, const imk_magnetometer_result *result,
                        const double *scratch, imk_error *error)
{
    if (!p || !result || !scratch || (p->count > 0 && !p->observation))
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "problem", NULL, "see magnetometer.h");
    if (p->cookie != IMKI_MAG_COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, NULL, NULL,
                             "start from imk_magnetometer_default()");
    for (size_t k = 0; k < p->count; k++)
        for (int i = 0; i < 3; i++) {
            const imk_magnetometer_observation *o = &p->observation[k];
            if (!(fabs(o->reading[i]) < 1e6) || !(fabs(o->up[i]) < 1.001))
                return imki_refuse_at(error, IMK_ERROR_RANGE, "reading", k, o->reading[i], 1e6,
                                      "a finite reading and a direction of unit norm");
            if (!(o->sigma[i] > 0.0 && o->sigma[i] < 1e6) || !(o->up_sigma >= 0.0))
                return imki_refuse_at(error, IMK_ERROR_RANGE, "sigma", k, o->sigma[i], 0.0,
                                      "above 0");
        }
    return check_known(p, error);
}

/* ---- iterations ------------------------------------------------------------------------------ */

/* @param steps  STEPS: to the end; fewer: as far as they lead */
static bool converge(imki_mag_fit *fit, int steps, int *iterations)
{
    double size = HUGE_VAL;
    for (int k = 0; k < steps; k++) {
        imki_mag_sum(fit);
        if (!imki_mag_step(fit, &size))
            return false;
        ++*iterations;
        if (size < 1e-5)
            break;
    }
    if (steps == STEPS && !(size < 1e-2))
        return false;
    imki_mag_sum(fit);
    return imki_mag_invert(fit);
}

/* a^T Cov b */
static double spread_of(const imki_mag_fit *fit, const double *a, const double *b)
{
    double sum = 0.0;
    for (int p = 0; p < IMKI_MAG_ALL; p++)
        sum += a[p] * imki_dot(IMKI_MAG_ALL, b, fit->covariance + (ptrdiff_t)p * IMKI_MAG_ALL);
    return sum;
}

/* Residuals of each, with what the fit takes away of them. @return scalar equations with weight */
static size_t assess(imki_mag_fit *fit)
{
    const imk_magnetometer *problem = fit->problem;
    size_t used = 0;
    for (size_t k = 0; k < problem->count; k++) {
        imk_magnetometer_observation *o = &problem->observation[k];
        imki_mag_equations e;
        double square = 0.0, leverage = 0.0;
        imki_mag_equate(fit, o, &e);
        for (int a = 0; a < e.count; a++)
            for (int b = 0; b < e.count; b++) {
                square += e.residual[a] * e.information[a][b] * e.residual[b];
                leverage += e.information[a][b] * spread_of(fit, e.gradient[a], e.gradient[b]);
            }
        o->leverage = o->weight * leverage / e.count;
        o->distance = sqrt(square / e.count / fmax(1.0 - o->leverage, 0.05));
        o->residual[0] = e.residual[0];
        o->residual[1] = e.count == 2 ? e.residual[1] : (double)NAN;
        used += o->weight > 0.0 ? (size_t)e.count : 0;
        for (int i = 0; i < 3; i++) {
            o->field[i] = 0.0;
            for (int j = 0; j < 3; j++)
                o->field[i] += fit->inverse.m[i][j] * (o->reading[j] - fit->x[j]);
        }
    }
    return used;
}

static int equations_of(const imki_mag_fit *fit, const imk_magnetometer_observation *o)
{
    return fit->aligned && imki_mag_has_up(o) ? 2 : 1;
}

/* Square of the scale of the distances, which a minority does not move. */
static double scale_of(const imki_mag_fit *fit, double *scratch)
{
    static const double median[2] = {0.454936, 0.693147}; /* of chi-square over its 1, 2 degrees */
    const imk_magnetometer *problem = fit->problem;
    for (size_t k = 0; k < problem->count; k++) {
        const imk_magnetometer_observation *o = &problem->observation[k];
        scratch[k] = o->distance * o->distance / median[equations_of(fit, o) - 1];
    }
    return imki_median(scratch, problem->count);
}

/* Huber's weights at first, then Tukey's [HUBER1981] [BEATON1974]. */
static void weigh(imki_mag_fit *fit, int pass, double scale)
{
    const imk_magnetometer *problem = fit->problem;
    for (size_t k = 0; k < problem->count; k++) {
        imk_magnetometer_observation *o = &problem->observation[k];
        const double distance = o->distance / sqrt(scale);
        const double inner = 1.0 - distance * distance / (4.7 * 4.7);
        if (pass < ROBUST_PASSES / 2)
            o->weight = distance > 1.5 ? 1.5 / distance : 1.0;
        else
            o->weight = inner > 0.0 ? inner * inner : 0.0;
    }
}

/* Those are refused that one set in a hundred without outliers would have one of. The scale is of a
 * median, which knows as much as 0.37 times as many residuals [HUBER1981]. */
static void refuse_outliers(imki_mag_fit *fit, double scale, double degrees)
{
    const imk_magnetometer *problem = fit->problem;
    static const double of_median = 0.37;
    double limit[2];
    size_t refused = 0;
    for (int m = 1; m <= 2; m++)
        limit[m - 1] =
            scale * imk_f_upper_quantile(0.01 / (double)problem->count, m, of_median * degrees);
    for (size_t k = 0; k < problem->count; k++) {
        imk_magnetometer_observation *o = &problem->observation[k];
        o->weight = o->distance * o->distance > limit[equations_of(fit, o) - 1] ? 0.0 : 1.0;
        refused += o->weight == 0.0;
    }
    for (size_t k = 0; 3 * refused > problem->count && k < problem->count; k++)
        problem->observation[k].weight = 1.0;
}

/* From the start to where outliers are known. */
static bool drop_outliers(imki_mag_fit *fit, double *scratch, int *iterations)
{
    enum { REDUNDANT = 8 };
    if (!converge(fit, FEW_STEPS, iterations))
        return false;
    const size_t equations = assess(fit);
    if (!fit->problem->robust || equations < fit->free + REDUNDANT)
        return true;
    for (int pass = 0; pass < ROBUST_PASSES; pass++) {
        const double scale = scale_of(fit, scratch);
        if (!(scale > 0.0))
            break;
        weigh(fit, pass, scale);
        if (!converge(fit, FEW_STEPS, iterations))
            return false;
        (void)assess(fit);
    }
    refuse_outliers(fit, scale_of(fit, scratch), (double)(equations - fit->free));
    return true;
}

/* ---- how well ---------------------------------------------------------------------------------
 */

static double mean_variance(const imk_magnetometer *problem)
{
    double sum = 0.0;
    for (size_t k = 0; k < problem->count; k++)
        sum += imki_dot3(problem->observation[k].sigma, problem->observation[k].sigma) / 3.0;
    return sum / (double)problem->count;
}

/* 1 + 2 sum of the autocorrelations, as far as they are seen. */
static double inefficiency(const double *x, size_t count)
{
    const double square = imki_dot(count, x, x);
    double sum = 1.0;
    for (size_t lag = 1; square > 0.0 && lag < LAGS && lag < count / 4; lag++) {
        const double rho = imki_dot(count - lag, x, x + lag) / square;
        if (rho < 2.0 / sqrt((double)count))
            break;
        sum += 2.0 * rho;
    }
    return sum;
}

/* Variance of a mean of neighbours over that of independent ones: of the residuals, or of what they
 * are for the hard iron, if that is more. A field that turns with the unit makes residuals that
 * change with its attitude. */
static double serial_of(const imk_magnetometer *problem, double *scratch)
{
    double most = 1.0;
    for (int i = -1; i < 3; i++) {
        size_t count = 0;
        for (size_t k = 0; k < problem->count; k++) {
            const imk_magnetometer_observation *o = &problem->observation[k];
            const double signed_distance = o->residual[0] < 0.0 ? -o->distance : o->distance;
            if (o->weight > 0.0)
                scratch[count++] = signed_distance * (i < 0 ? 1.0 : o->field[i]);
        }
        most = fmax(most, inefficiency(scratch, count));
    }
    return most;
}

/* Of |u|, and of the dip with what |u| says of it taken away: chi-square and degrees of freedom;
 * and the share of the vertical's variance in that of the second. */
typedef struct parts {
    double chi_square[2], degrees[2], vertical;
} parts;

static parts parts_of(const imki_mag_fit *fit, double degrees)
{
    const imk_magnetometer *problem = fit->problem;
    parts found = {{fit->chi_square, 0.0}, {degrees, 0.0}, 0.0};
    double seconds = 0.0;
    for (size_t k = 0; k < problem->count; k++) {
        const imk_magnetometer_observation *o = &problem->observation[k];
        imki_mag_equations e;
        imki_mag_equate(fit, o, &e);
        if (o->weight == 0.0 || e.count < 2)
            continue;
        /* r2 less its regression on r1 has the variance 1/information[1][1]. */
        const double slope = e.information[1][0] / e.information[1][1];
        const double rest = e.residual[1] + slope * e.residual[0];
        double gradient[IMKI_MAG_ALL];
        for (int p = 0; p < IMKI_MAG_ALL; p++)
            gradient[p] = e.gradient[1][p] + slope * e.gradient[0][p];
        found.chi_square[1] += rest * rest * e.information[1][1];
        found.degrees[1] += 1.0 - e.information[1][1] * spread_of(fit, gradient, gradient);
        found.vertical += fmin(e.up_variance * e.information[1][1], 1.0);
        seconds += 1.0;
    }
    found.chi_square[0] -= found.chi_square[1];
    found.degrees[0] -= found.degrees[1];
    found.vertical /= fmax(seconds, 1.0);
    return found;
}

/* The readings scatter by `ratio` of the variance used. */
static void scale_readings(imki_mag_fit *fit, double ratio, bool places)
{
    if (places) {
        const double variance = mean_variance(fit->problem) + fit->added * fit->added;
        fit->added = sqrt(fmax(fit->added * fit->added + (ratio - 1.0) * variance, 0.0));
    } else {
        fit->factor *= sqrt(ratio);
    }
}

/* Sigmas by the residuals: a factor for all, or if the vertical is the larger error, one for the
 * readings by |u| and one for the vertical by the dip. */
static bool find_factor(imki_mag_fit *fit, imk_magnetometer_result *made)
{
    enum { LEAST = 3 }; /* degrees of freedom of a factor */
    const double degrees = made->degrees_of_freedom;
    const parts stated = parts_of(fit, degrees);
    const bool apart =
        stated.vertical > 0.5 && stated.degrees[0] >= LEAST && stated.degrees[1] >= LEAST;
    const double first =
        apart ? stated.chi_square[0] / stated.degrees[0] : fit->chi_square / degrees;
    made->chi_square = fit->chi_square;
    made->freedom = apart ? fmin(stated.degrees[0], stated.degrees[1]) : degrees;
    for (int pass = 0; pass < PASSES && degrees > 0.0; pass++) {
        const parts now = parts_of(fit, degrees);
        const double all = fit->chi_square / degrees;
        const double dip = now.chi_square[1] / now.degrees[1];
        scale_readings(fit, apart ? now.chi_square[0] / now.degrees[0] : all, first > disturbed);
        if (apart)
            fit->up_factor *= sqrt(fmax(1.0 + (dip - 1.0) / fmax(now.vertical, 0.3), 0.1));
        else if (!(first > disturbed))
            fit->up_factor = fit->factor;
        if (!converge(fit, STEPS, &made->iterations))
            return false;
        if (fabs(all - 1.0) < 1e-6)
            break;
    }
    return true;
}

/* ---- result ---------------------------------------------------------------------------------- */

/* The part of the accelerometers' uncertainty: errors of `up` that all attitudes share. With f =
 * A^-1 (reading - b), a bias b_i moves f by -e_i, a scale factor by -f_i e_i, a response to axis j
 * by -f_j e_i. */
static void add_accelerometers(imki_mag_fit *fit, imk_magnetometer_result *result)
{
    const imk_magnetometer *problem = fit->problem;
    const imk_calibration_result *accel = problem->accel;
    double moved[IMKI_MAG_ALL][IMK_CORRELATED_MAX] = {{0.0}};
    for (size_t k = 0; k < problem->count; k++) {
        const imk_magnetometer_observation *o = &problem->observation[k];
        imki_mag_equations e;
        imki_mag_equate(fit, o, &e);
        for (size_t a = 0; o->weight > 0.0 && e.count == 2 && a < accel->parameter_count; a++) {
            const imk_model_parameter at = accel->parameter[a];
            if (at.sensor != IMK_ACCEL || at.axis > 2)
                continue;
            const double size = at.term == IMK_MODEL_BIAS           ? 1.0 / 9.80665
                                : at.term == IMK_MODEL_SCALE_FACTOR ? o->up[at.axis]
                                : at.term == IMK_MODEL_MISALIGNMENT ? o->up[at.element % 3]
                                                                    : 0.0;
            const double change = -size * e.up_gradient[at.axis];
            for (int p = 0; p < IMKI_MAG_ALL; p++)
                for (int l = 0; l < 2; l++)
                    moved[p][a] += e.gradient[l][p] * e.information[l][1] * change;
        }
    }
    double slope[IMKI_MAG_ALL][IMK_CORRELATED_MAX] = {{0.0}};
    const size_t n = accel->parameter_count;
    for (int p = 0; p < IMKI_MAG_ALL; p++)
        for (size_t a = 0; a < n; a++)
            for (int q = 0; q < IMKI_MAG_ALL; q++)
                slope[p][a] -= fit->covariance[p * IMKI_MAG_ALL + q] * moved[q][a];
    for (int p = 0; p < IMKI_MAG_ALL; p++)
        for (size_t a = 0; a < n; a++)
            result->cross[p][a] = imki_dot(n, slope[p], accel->covariance + a * n);
    for (int p = 0; p < IMKI_MAG_ALL; p++)
        for (int q = 0; q < IMKI_MAG_ALL; q++)
            result->covariance[p * IMKI_MAG_ALL + q] += imki_dot(n, result->cross[p], slope[q]);
}

static void find_rms(const imki_mag_fit *fit, imk_magnetometer_result *result)
{
    const imk_magnetometer *problem = fit->problem;
    double square[2] = {0.0, 0.0}, count[2] = {0.0, 0.0};
    for (size_t k = 0; k < problem->count; k++) {
        const imk_magnetometer_observation *o = &problem->observation[k];
        result->refused += o->weight == 0.0;
        for (int r = 0; r < equations_of(fit, o) && o->weight > 0.0; r++) {
            square[r] += o->residual[r] * o->residual[r];
            count[r] += 1.0;
        }
    }
    for (int r = 0; r < 2; r++)
        result->rms[r] = count[r] > 0.0 ? sqrt(square[r] / count[r]) : 0.0;
}

static void fill_result(imki_mag_fit *fit, imk_magnetometer_result *result)
{
    result->aligned = fit->aligned;
    result->field_known = fit->field_known;
    result->parameter_count = fit->free;
    result->factor = fit->factor;
    result->added = fit->added;
    memcpy(result->value, fit->x, sizeof result->value);
    for (int p = 0; p < IMKI_MAG_ALL * IMKI_MAG_ALL; p++)
        result->covariance[p] = fit->covariance[p] * result->serial;
    if (fit->aligned && fit->problem->accel)
        add_accelerometers(fit, result);
    for (int p = 0; p < IMKI_MAG_ALL; p++) {
        result->sigma[p] = sqrt(fmax(result->covariance[p * (IMKI_MAG_ALL + 1)], 0.0));
    }
    if (!fit->aligned)
        result->value[IMKI_MAG_DIP] = (double)NAN;
    result->nearest = imki_mag_nearest(fit->x + IMKI_MAG_RESPONSE, &result->nearest_angle);
    find_rms(fit, result);
}

static imk_status not_determined(imki_mag_fit *fit, imk_magnetometer_result *result,
                                 imk_error *error)
{
    imki_mag_start(fit);
    fit->factor = fit->up_factor = 1.0;
    fit->added = 0.0;
    imki_mag_coverage(fit, result);
    return imk_error_set(error, IMK_ERROR_SINGULAR, "attitude", NULL,
                         "attitudes in which the field has all directions");
}

static imk_status solve(imki_mag_fit *fit, imk_magnetometer_result *made, double *scratch,
                        imk_error *error)
{
    imki_mag_start(fit);
    size_t equations = 0;
    for (size_t k = 0; k < fit->problem->count; k++)
        equations += (size_t)equations_of(fit, &fit->problem->observation[k]);
    if (equations < fit->free + 3)
        return imki_refuse(error, IMK_ERROR_TOO_SHORT, "attitude", (double)equations,
                           (double)(fit->free + 3), "more attitudes");
    fit->rough = true;
    const bool begun = drop_outliers(fit, scratch, &made->iterations);
    fit->rough = false;
    if (!begun || !converge(fit, STEPS, &made->iterations))
        return not_determined(fit, made, error);
    made->equations = equations;
    const size_t used = assess(fit);
    made->degrees_of_freedom = (double)used - (double)fit->free;
    if (fit->field_known && fit->problem->field_sigma > 0.0)
        made->degrees_of_freedom += 1.0;
    if (!find_factor(fit, made))
        return not_determined(fit, made, error);
    (void)assess(fit);
    made->serial = fit->problem->series ? serial_of(fit->problem, scratch) : 1.0;
    made->freedom = fmax(1.0, made->freedom / made->serial);
    fill_result(fit, made);
    imki_mag_coverage(fit, made);
    return IMK_OK;
}

imk_status imk_magnetometer_solve(const imk_magnetometer *problem, imk_magnetometer_result *result,
                                  double *scratch, imk_error *error)
{
    imk_status status = check(problem, result, scratch, error);
    if (status != IMK_OK)
        return status;
    imki_mag_fit fit = {.problem = problem, .factor = 1.0, .up_factor = 1.0};
    imk_magnetometer used = *problem;
    if (used.frame == IMK_FRAME_REFERENCE)
        used.frame = IMK_FRAME_SYMMETRIC;
    fit.problem = &used;
    fit.field_known = !isnan(problem->field);
    for (size_t k = 0; k < problem->count; k++) {
        problem->observation[k].weight = 1.0;
        fit.aligned = fit.aligned || imki_mag_has_up(&problem->observation[k]);
    }
    memset(result, 0, sizeof *result);
    if (problem->count == 0)
        return imki_refuse(error, IMK_ERROR_TOO_SHORT, "attitude", 0.0, 12.0, "more attitudes");
    return solve(&fit, result, scratch, error);
}
