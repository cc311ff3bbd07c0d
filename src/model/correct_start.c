/* SPDX-License-Identifier: Apache-2.0 */
/* Preparing the correction of a model: which unknowns there are, how large they can be, whether
 * every reading belongs to one motion, and how many iterations lead to it. */
#include "base/algebra/vector_internal.h"
#include "base/text_internal.h"
#include "correct_internal.h"
#include "model_internal.h"

#include "imukit/decimal.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* What readings can be beyond the stated range, and inputs larger than readings. */
static const double range_margin = 1.1;

/* Limits where everything is linear and none is stated: of these the bound is a fraction. */
static const double nominal_limit[2] = {1.0 /* rad/s */, 10.0 /* m/s^2 */};

/* ---- settings -------------------------------------------------------------------------------- */

imk_correction_settings imk_correction_default(void)
{
    return (imk_correction_settings){
        .cookie = IMKI_CORRECTION_SETTINGS_COOKIE, .tolerance = 1e-14, .kernel = IMK_KERNEL_SCALAR};
}

static imk_status check_settings(const imk_correction_settings *settings, imk_error *error)
{
    if (settings->cookie != IMKI_CORRECTION_SETTINGS_COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "settings", "",
                             "start from imk_correction_default()");
    const double values[3] = {settings->rate_limit, settings->force_limit, settings->tolerance};
    static const char *const fields[3] = {"rate_limit", "force_limit", "tolerance"};
    const double largest[3] = {DBL_MAX, DBL_MAX, 0.1};
    for (int i = 0; i < 3; i++) {
        /* A limit of 0 is one from the ranges; a tolerance of 0 would never be met. */
        if (values[i] >= (i < 2 ? 0.0 : 1e-300) && values[i] <= largest[i])
            continue;
        imk_error_set(error, IMK_ERROR_RANGE, fields[i], "",
                      i < 2 ? "a finite number that is not negative"
                            : "a positive number, at most 0.1");
        if (error) {
            error->value = values[i];
            error->limit = i < 2 ? 0.0 : largest[i];
        }
        return IMK_ERROR_RANGE;
    }
    return IMK_OK;
}

/* ---- what there is --------------------------------------------------------------------------- */

/* True when the directions span space: the determinant of sum e e^T, of trace n, is n^3/27 at most;
 * 1e-12 is a smallest singular value of some 1e-6. */
static bool spans_space(const imk_triad *triad)
{
    double g[3][3] = {{0.0}};
    for (int i = 0; i < triad->axis_count; i++)
        for (int j = 0; j < 9; j++)
            g[j / 3][j % 3] += triad->direction[i][j / 3] * triad->direction[i][j % 3];
    const double determinant = g[0][0] * (g[1][1] * g[2][2] - g[1][2] * g[2][1]) -
                               g[0][1] * (g[1][0] * g[2][2] - g[1][2] * g[2][0]) +
                               g[0][2] * (g[1][0] * g[2][1] - g[1][1] * g[2][0]);
    return triad->axis_count >= 3 && determinant > 1e-12;
}

static unsigned used_by(const imk_distortion *distortion, int sensor)
{
    unsigned used = 0;
    for (int i = 0; i < distortion->axis_count[sensor]; i++)
        for (int k = 0; k < 4; k++)
            used |= distortion->axis[sensor][i].used[k];
    return used;
}

/* Terms that need the other kind of sensor, in three dimensions. */
static imk_status check_partners(const imki_inversion *v, imk_error *error)
{
    const unsigned gyro = used_by(v->distortion, IMK_GYRO);
    const unsigned accel = used_by(v->distortion, IMK_ACCEL);
    const unsigned coupling = IMKI_PRODUCT_FEATURES | IMKI_THIRD_FEATURES;
    const char *key = gyro & IMKI_THIRD_FEATURES ? "g_sensitivity" : "g2_sensitivity";
    if (gyro & coupling && v->outputs[IMK_ACCEL] == 0)
        return imki_correct_refuse(
            error, IMK_ERROR_CONFLICT, IMK_GYRO, key,
            "the effect of specific force on the gyros cannot be taken out: the unit has "
            "no accelerometers",
            "remove this term, or add accelerometers");
    if (gyro & coupling && !v->solves[IMK_ACCEL])
        return imki_correct_refuse(
            error, IMK_ERROR_SINGULAR, IMK_ACCEL, "direction",
            "the effect of specific force on the gyros needs accelerometers in three "
            "directions",
            "remove the g-sensitivity of the gyros");
    if (accel & coupling && v->outputs[IMK_GYRO] == 0)
        return imki_correct_refuse(
            error, IMK_ERROR_CONFLICT, IMK_ACCEL, "lever_arm",
            "the effect of rotation cannot be taken out: the unit has no gyros",
            "remove the lever arms, or add gyros");
    if (accel & coupling && !v->solves[IMK_GYRO])
        return imki_correct_refuse(
            error, IMK_ERROR_SINGULAR, IMK_GYRO, "direction",
            "the effect of rotation on the accelerometers needs gyros in three "
            "directions",
            "remove the lever arms of the accelerometers");
    return IMK_OK;
}

static void find_unknowns(imki_inversion *v, const imk_model *model)
{
    const imk_triad *triads[2] = {&model->gyro, &model->accel};
    for (int sensor = 0; sensor < 2; sensor++) {
        const imk_triad *triad = triads[sensor];
        v->solves[sensor] = triad->present && spans_space(triad);
        v->outputs[sensor] = !triad->present ? 0 : v->solves[sensor] ? 3 : triad->axis_count;
        for (int i = 0; triad->present && i < triad->axis_count; i++) {
            const double *e = triad->direction[i];
            const double squared = imki_dot3(e, e);
            for (int j = 0; j < 3; j++)
                v->along[sensor][i][j] = e[j] / squared;
        }
    }
}

/* ---- limits ---------------------------------------------------------------------------------- */

/* Axes whose response along their own input is not linear. */
static bool has_curvature(const imk_distortion *distortion, int sensor)
{
    for (int i = 0; i < distortion->axis_count[sensor]; i++) {
        const imk_axis_response *axis = &distortion->axis[sensor][i];
        if (axis->powers > 1 || axis->power[0][0] != 0.0 || axis->has_cross_products)
            return true;
    }
    return false;
}

/* Nothing but products of the other kind's components stands between the model and a linear one,
 * and in one direction only: one step finds that kind, the next one this, however large they are.
 */
static bool is_one_way(const imk_distortion *distortion)
{
    const unsigned coupling = IMKI_PRODUCT_FEATURES | IMKI_THIRD_FEATURES;
    bool is_simple =
        !(used_by(distortion, IMK_GYRO) & coupling) || !(used_by(distortion, IMK_ACCEL) & coupling);
    for (int sensor = 0; sensor < 2; sensor++) {
        is_simple = is_simple && !has_curvature(distortion, sensor);
        for (int i = 0; i < distortion->axis_count[sensor]; i++)
            is_simple = is_simple && !distortion->axis[sensor][i].has_nonlinearity &&
                        distortion->axis[sensor][i].scale_order == 0;
    }
    return is_simple;
}

/* Terms whose derivatives depend on how large the rates, or forces, are. */
static bool needs_limit(const imk_distortion *distortion, int sensor)
{
    return has_curvature(distortion, sensor) ||
           ((used_by(distortion, 1 - sensor) & IMKI_PRODUCT_FEATURES) != 0 &&
            !is_one_way(distortion));
}

/* Limits of the unknowns from those of the inputs, which the ranges give. */
static void limits_from_ranges(imki_inversion *v, const imk_triad *triad, int sensor)
{
    double inverse[3][IMK_AXES_MAX];
    const int own = sensor * IMK_AXES_MAX;
    for (int i = 0; i < triad->axis_count; i++) {
        v->input_limit[sensor][i] = range_margin * triad->range.value[i];
        v->limit[own + i] = v->input_limit[sensor][i];
    }
    if (!v->solves[sensor] ||
        imki_pseudo_inverse(triad->axis_count, triad->direction, inverse) != IMK_OK)
        return;
    for (int j = 0; j < IMK_AXES_MAX; j++) {
        v->limit[own + j] = 0.0;
        for (int i = 0; j < 3 && i < triad->axis_count; i++)
            v->limit[own + j] += fabs(inverse[j][i]) * v->input_limit[sensor][i];
    }
}

static imk_status find_limits(imki_inversion *v, const imk_triad *triad, int sensor, double stated,
                              imk_error *error)
{
    bool has_ranges = true;
    for (int i = 0; i < triad->axis_count; i++)
        has_ranges = has_ranges && triad->range.value[i] > 0.0;
    if (!(stated > 0.0) && has_ranges) {
        limits_from_ranges(v, triad, sensor);
        return IMK_OK;
    }
    if (!(stated > 0.0) && needs_limit(v->distortion, sensor))
        return imki_correct_refuse(error, IMK_ERROR_KEY_MISSING, sensor, "range", "",
                                   "add the range: the model has nonlinear terms, and their "
                                   "correction needs a known range");
    const double limit = stated > 0.0 ? stated : nominal_limit[sensor];
    for (int i = 0; i < triad->axis_count; i++) {
        const double *e = triad->direction[i];
        v->input_limit[sensor][i] = (fabs(e[0]) + fabs(e[1]) + fabs(e[2])) * limit;
    }
    for (int j = 0; j < v->outputs[sensor]; j++)
        v->limit[sensor * IMK_AXES_MAX + j] = v->solves[sensor] ? limit : v->input_limit[sensor][j];
    return IMK_OK;
}

/* ---- monotonic responses --------------------------------------------------------------------- */

/* The term that pulls the slope down most at the turning point. */
static const char *worst_term(const imk_axis_response *axis, int sensor, double u)
{
    int worst = IMK_MODEL_SCALE_TEMPERATURE;
    double least = 0.0;
    for (size_t k = 0; k < imki_input_power_count; k++) {
        const imki_power *power = &imki_input_powers[k];
        const double slope =
            imki_power_slope(power, imki_axis_power(axis, power), u, u < 0.0 ? -1.0 : 1.0);
        if (slope < least) {
            least = slope;
            worst = power->term;
        }
    }
    return imki_term_field(worst)->path[sensor];
}

static imk_status check_monotonic(const imki_inversion *v, imk_error *error)
{
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < v->distortion->axis_count[sensor]; i++) {
            const imk_axis_response *axis = &v->distortion->axis[sensor][i];
            const double *along = v->along[sensor][i], limit = v->input_limit[sensor][i];
            const double linear = imki_dot3(axis->other, along);
            const double u = imki_turning_point(axis, linear, limit);
            if (!(fabs(u) <= limit))
                continue;
            char found[IMK_DECIMAL_SIZE + 96] = "the reading turns back at an input of ";
            imk_decimal_significant(u, 6, found + strlen(found));
            const char *unit = sensor == IMK_GYRO ? " rad/s, which is within the range"
                                                  : " m/s^2, which is within the range";
            imki_append_text(found, sizeof found, unit);
            imki_correct_refuse(error, IMK_ERROR_NO_CONVERGENCE, sensor,
                                worst_term(axis, sensor, u), found,
                                "state a smaller range, or correct without this term");
            if (error) {
                error->index = i;
                error->value = u;
                error->limit = limit;
            }
            return IMK_ERROR_NO_CONVERGENCE;
        }
    return IMK_OK;
}

/* ---- start ----------------------------------------------------------------------------------- */

static void copy_results(imk_correction *made, const imki_inversion *v, const imk_model *model,
                         const double *error)
{
    const imk_triad *triads[2] = {&model->gyro, &model->accel};
    for (int sensor = 0; sensor < 2; sensor++) {
        const int own = sensor * IMK_AXES_MAX;
        made->solves[sensor] = v->solves[sensor];
        made->stays_within[sensor] = v->stays_within[sensor];
        made->output_count[sensor] = v->outputs[sensor];
        for (int j = 0; j < v->outputs[sensor]; j++) {
            made->bound[sensor] = fmax(made->bound[sensor], error[own + j]);
            made->limit[sensor][j] = v->limit[own + j];
        }
        for (int j = 0; v->solves[sensor] && j < 3; j++)
            memcpy(made->inverse[3 * sensor + j], v->inverse[own + j], sizeof made->inverse[0]);
        for (int i = 0; i < v->distortion->axis_count[sensor]; i++) {
            const double sensitivity = triads[sensor]->sensitivity.value[i];
            made->axis_inverse[sensor][i] = v->inverse[own + i][own + i];
            memcpy(made->along[sensor][i], v->along[sensor][i], sizeof made->along[0][0]);
            made->per_unit[sensor][i] = sensitivity != 0.0 ? 1.0 / sensitivity : 1.0;
            made->zero_offset[sensor][i] = triads[sensor]->zero_offset.value[i];
        }
    }
}

imk_status imk_correction_start(imk_correction *correction, const imk_model *model,
                                const imk_correction_settings *settings, imk_error *error)
{
    const imk_correction_settings usual = imk_correction_default();
    const imk_correction_settings *with = settings ? settings : &usual;
    imk_correction made;
    imki_inversion v;
    double left[IMKI_UNKNOWNS];
    int singular = IMK_GYRO;
    memset(&made, 0, sizeof made);
    memset(&v, 0, sizeof v);
    imk_status status = check_settings(with, error);
    if (status == IMK_OK)
        status = imk_distortion_start(&made.distortion, model, NULL, with->kernel, error);
    if (status != IMK_OK)
        return status;
    v.distortion = &made.distortion;
    find_unknowns(&v, model);
    for (int sensor = 0; sensor < 2; sensor++)
        v.stays_within[sensor] = has_curvature(v.distortion, sensor);
    status = check_partners(&v, error);
    if (status == IMK_OK && model->gyro.present)
        status = find_limits(&v, &model->gyro, IMK_GYRO, with->rate_limit, error);
    if (status == IMK_OK && model->accel.present)
        status = find_limits(&v, &model->accel, IMK_ACCEL, with->force_limit, error);
    if (status == IMK_OK)
        status = check_monotonic(&v, error);
    if (status != IMK_OK)
        return status;
    if (imki_invert_middle(&v, &singular) != IMK_OK)
        return imki_correct_refuse(error, IMK_ERROR_SINGULAR, singular, "misalignment",
                                   "the axes with their errors do not span three dimensions",
                                   "check direction, misalignment, cross_axis and scale_factor");
    status = imki_count_iterations(&v, with->tolerance, &made.iterations, &made.contraction, left);
    if (status != IMK_OK)
        return imki_refuse_inversion(&v, &made.distortion, error);
    copy_results(&made, &v, model, left);
    made.cookie = IMKI_CORRECTION_COOKIE;
    *correction = made;
    return IMK_OK;
}
