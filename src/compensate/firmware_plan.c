/* SPDX-License-Identifier: Apache-2.0 */
/* From a model to the plan of its correction: what is left out, what the readings are, how good and
 * how dear the result is. */
#include "firmware_plan_internal.h"

#include <math.h>
#include <string.h>

static const uint32_t settings_cookie = 0x66777331; /* "fws1" */

static const double kelvin = 273.15;

/* What imk_correct() itself does wrong by rounding, of the limit: correct.h. */
static const double reference_rounding = 4e-15;

/* The largest motion of a sensor without range or limit, which only a linear model may have: that
 * of the usual MEMS unit, 2000 deg/s and 16 g. */
static const double usual_limit[2] = {35.0 /* rad/s */, 160.0 /* m/s^2 */};

/* Integers between which the scale of a temperature in fixed point lies: 1/65536 degC. */
enum { TEMPERATURE_BITS = 16 };

imk_firmware_settings imk_firmware_default(void)
{
    return (imk_firmware_settings){.cookie = settings_cookie};
}

static imk_status check_settings(const imk_firmware_settings *settings, imk_error *error)
{
    if (settings->cookie != settings_cookie)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "settings", "",
                             "start from imk_firmware_default()");
    if ((unsigned)settings->arithmetic > IMK_FIRMWARE_FIXED)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "arithmetic", "",
                             "float, double or fixed point");
    if (!(settings->tolerance >= 0 && settings->tolerance < 1))
        return imk_error_set(error, IMK_ERROR_RANGE, "tolerance", "", "a number from 0 to 1");
    return IMK_OK;
}

/* ---- what is taken out ----------------------------------------------------------------------- */

/* Without the terms that need more than a sample and its temperature. */
static void leave_out(imk_model *model)
{
    imk_triad *triads[2] = {&model->gyro, &model->accel};
    for (int sensor = 0; sensor < 2; sensor++) {
        imk_bias *bias = &triads[sensor]->bias;
        memset(&bias->temperature_rate, 0, sizeof bias->temperature_rate);
        memset(&bias->warm_up_amplitude, 0, sizeof bias->warm_up_amplitude);
    }
    memset(&model->accel.lever_arm, 0, sizeof model->accel.lever_arm);
}

/* Do the settings or the ranges of all axes limit the motion? */
static bool is_limited(const imk_model *model, int sensor, double stated)
{
    const imk_triad *triad = imk_model_triad(model, sensor);
    bool has_ranges = triad->present;
    for (int i = 0; has_ranges && i < triad->axis_count; i++)
        has_ranges = triad->range.value[i] > 0;
    return has_ranges || stated > 0;
}

static imk_status compile(imk_firmware *f, const imk_firmware_settings *settings,
                          imk_compensator *reference, imk_error *error)
{
    static const double tolerances[3] = {0x1p-22, 1e-14, 0x1p-28};
    imk_correction_settings with = imk_correction_default();
    with.rate_limit = settings->rate_limit;
    with.force_limit = settings->force_limit;
    /* The sample interval matters to what is left out only. */
    imk_status status = imk_compensator_start(reference, &f->model, 1e9, &with, error);
    if (status != IMK_OK)
        return status;
    for (int sensor = 0; sensor < 2; sensor++)
        f->limit_stated[sensor] =
            is_limited(&f->model, sensor, sensor == IMK_GYRO ? with.rate_limit : with.force_limit);
    if (!f->limit_stated[IMK_GYRO])
        with.rate_limit = usual_limit[IMK_GYRO];
    if (!f->limit_stated[IMK_ACCEL])
        with.force_limit = usual_limit[IMK_ACCEL];
    status = imk_compensator_start(reference, &f->model, 1e9, &with, error);
    if (status != IMK_OK)
        return status;
    with.tolerance =
        settings->tolerance > 0 ? settings->tolerance : tolerances[settings->arithmetic];
    return imk_correction_start(&f->correction, &f->model, &with, error);
}

/* ---- readings and outputs -------------------------------------------------------------------- */

/* What an axis can read of a motion within the limits. */
static double largest_reading(const imk_firmware *f, int sensor, int axis)
{
    const imk_axis_response *r = &f->correction.distortion.axis[sensor][axis];
    const imk_correction *c = &f->correction;
    double along = 0, other = 0, force = 0, products = 0, p = 0, o = 0, coldest, warmest;
    const double *f_limit = c->limit[IMK_ACCEL];
    for (int j = 0; j < 3; j++) {
        const double limit = c->solves[sensor] ? c->limit[sensor][j] : c->limit[sensor][axis];
        along += fabs(r->input[j]) * limit;
        other += fabs(r->other[j]) * limit;
        p += fabs(r->pendulous[j]) * limit;
        o += fabs(r->output[j]) * limit;
        if (sensor == IMK_ACCEL || !c->solves[IMK_ACCEL])
            continue;
        force += fabs(r->other[9 + j]) * f_limit[j];
        products += fabs(r->other[3 + j]) * f_limit[j] * f_limit[j] +
                    fabs(r->other[6 + j]) * f_limit[j] * f_limit[(j + 1) % 3];
    }
    if (!c->solves[sensor])
        along = c->limit[sensor][axis];
    imki_scale_range(r, &coldest, &warmest);
    double scale = 1 + fabs(r->scale) + fmax(fabs(coldest), fabs(warmest));
    for (int n = 1; n <= IMK_POWERS + 1; n++) { /* |u|^(n - 1) */
        double slope = (n > 1 ? fabs(r->power[0][n - 2]) : 0) +
                       (n <= IMK_POWERS ? fabs(r->power[1][n - 1]) : 0);
        for (int k = 1; k < n; k++)
            slope *= along;
        scale += slope;
    }
    return fabs(r->bias) + imki_firmware_bias_reach(r) + scale * along + other + force + products +
           fabs(r->kip) * along * p + fabs(r->kio) * along * o + fabs(r->kpo) * p * o;
}

static imk_status set_channel(imk_firmware *f, const imk_compensator *reference, int sensor,
                              int axis, imk_error *error)
{
    static const char *const keys[2] = {"gyro.range", "accel.range"};
    const imk_triad *triad = imk_model_triad(&f->model, sensor);
    const imk_correction *c = &f->correction;
    imk_firmware_channel *channel = &f->channel[sensor][axis];
    const double range = reference->range[sensor][axis], per_unit = c->per_unit[sensor][axis];
    const double zero = c->zero_offset[sensor][axis];
    const bool has_range = range < (double)INFINITY;
    double reach = (has_range ? range : largest_reading(f, sensor, axis)) / fabs(per_unit);
    channel->in_counts = triad->sensitivity.value[axis] != 0;
    channel->lower = zero - reach;
    channel->upper = zero + reach;
    channel->flag = has_range ? IMK_FLAG_SATURATED : IMK_FLAG_LIMIT;
    if (channel->in_counts) {
        channel->lower = floor(channel->lower);
        channel->upper = ceil(channel->upper);
        if (!(channel->lower > -0x1p30 && channel->upper < 0x1p30))
            return imk_error_set(error, IMK_ERROR_UNSUPPORTED, keys[sensor],
                                 "readings of more than 30 bits", "state a smaller range");
        channel->origin = (int32_t)floor(zero + 0.5);
    }
    if (f->arithmetic != IMK_FIRMWARE_FIXED)
        return IMK_OK;
    if (!has_range && !f->limit_stated[sensor])
        return imk_error_set(error, IMK_ERROR_KEY_MISSING, keys[sensor], "",
                             "add the range, or --rate-limit and --force-limit: fixed point needs "
                             "the largest values");
    channel->bits = channel->in_counts ? 0 : imki_firmware_bits(reach);
    if (channel->bits < 0)
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, keys[sensor],
                             "a range beyond 32-bit integers", "state a smaller range");
    return IMK_OK;
}

static imk_status set_frame(imk_firmware *f, const imk_compensator *reference, imk_error *error)
{
    const imk_triad *triads[2] = {&f->model.gyro, &f->model.accel};
    f->iterations = 1;
    f->needs_temperature = reference->needs_temperature;
    f->temperature_minimum = reference->temperature_minimum - kelvin;
    f->temperature_maximum = reference->temperature_maximum - kelvin;
    f->temperature_bits = TEMPERATURE_BITS;
    for (int sensor = 0; sensor < 2; sensor++) {
        const bool present = triads[sensor]->present;
        f->axis_count[sensor] = present ? triads[sensor]->axis_count : 0;
        f->output_count[sensor] = f->correction.output_count[sensor];
        f->limited[sensor] = reference->limited[sensor];
        memcpy(f->limit[sensor], f->correction.limit[sensor], sizeof f->limit[sensor]);
        for (int i = 0; i < f->axis_count[sensor]; i++) {
            const imk_status status = set_channel(f, reference, sensor, i, error);
            if (status != IMK_OK)
                return status;
        }
    }
    return IMK_OK;
}

/* Comparisons take the thresholds as the arithmetic holds them. */
static void round_thresholds(imk_firmware *f)
{
    if (f->arithmetic != IMK_FIRMWARE_FLOAT)
        return;
    f->temperature_minimum = imki_firmware_single(f->temperature_minimum);
    f->temperature_maximum = imki_firmware_single(f->temperature_maximum);
    for (int k = 0; k < 2 * IMK_AXES_MAX; k++) {
        imk_firmware_channel *channel = &f->channel[k / IMK_AXES_MAX][k % IMK_AXES_MAX];
        double *limit = &f->limit[k / IMK_AXES_MAX][k % IMK_AXES_MAX];
        *limit = imki_firmware_single(*limit);
        if (!channel->in_counts) {
            channel->lower = imki_firmware_single(channel->lower);
            channel->upper = imki_firmware_single(channel->upper);
        }
    }
}

/* ---- result ---------------------------------------------------------------------------------- */

static void count_cost(imk_firmware *f)
{
    imk_firmware_cost *cost = &f->cost;
    for (int i = 0; i < f->operation_count; i++) {
        const imk_firmware_operation *o = &f->operation[i];
        const bool product = o->kind == IMK_FIRMWARE_PRODUCT;
        const bool clips = o->kind == IMK_FIRMWARE_CLIP ||
                           (o->kind == IMK_FIRMWARE_READING && f->arithmetic == IMK_FIRMWARE_FIXED);
        int addends = o->kind == IMK_FIRMWARE_SUM ? o->count : 0;
        cost->multiplications += product;
        cost->comparisons += clips ? 2 : o->kind == IMK_FIRMWARE_SIZE;
        cost->additions += product && o->constant != 0;
        for (int k = 0; k < addends; k++)
            cost->multiplications += fabs(f->term[o->first + k].coefficient) != 1;
        cost->additions += addends > 0 ? addends - 1 + (o->constant != 0) : 0;
    }
    for (int sensor = 0; sensor < 2; sensor++) {
        cost->comparisons += 2 * f->axis_count[sensor];
        cost->comparisons += f->limited[sensor] ? 2 * f->output_count[sensor] : 0;
    }
    cost->comparisons += f->needs_temperature ? 2 : 0;
}

/* Against imk_correct(): rounding, the steps that are not made, and what that function errs itself
 * by. */
static void find_bounds(imk_firmware *f, const imk_compensator *reference, const double left[2])
{
    for (int sensor = 0; sensor < 2; sensor++) {
        double rounding = 0, limit = 0;
        for (int j = 0; j < f->output_count[sensor]; j++) {
            rounding = fmax(rounding, f->operation[f->output[sensor][j]].error);
            limit = fmax(limit, f->correction.limit[sensor][j]);
        }
        if (f->output_count[sensor] > 0)
            f->bound[sensor] = rounding + left[sensor] + f->correction.bound[sensor] +
                               reference->correction.bound[sensor] + reference_rounding * limit;
    }
}

static imk_status plan_operations(imk_firmware *f, double left[2], imk_error *error)
{
    static const double roundoffs[3] = {0x1p-24, 0x1p-53, 0};
    imki_builder builder = {.plan = f, .unit_roundoff = roundoffs[f->arithmetic]};
    /* In fixed point all outputs of a kind have one scale, found by trying. */
    for (int reserve = 0; reserve < 8; reserve++) {
        builder.full = builder.too_large = false;
        f->operation_count = f->term_count = 0;
        if (imki_firmware_build(&builder, reserve, left))
            return IMK_OK;
        if (builder.full)
            return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "model",
                                 "more steps than a plan has room for",
                                 "state a smaller range, or leave terms out");
        if (f->arithmetic != IMK_FIRMWARE_FIXED)
            break;
    }
    return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "model",
                         "numbers that differ too much in size for 32-bit integers",
                         "choose float, or state a smaller range");
}

imk_status imk_firmware_plan(imk_firmware *firmware, const imk_model *model,
                             const imk_firmware_settings *settings, imk_error *error)
{
    const imk_firmware_settings usual = imk_firmware_default();
    imk_firmware *f = firmware;
    imk_compensator reference;
    double left[2] = {0, 0};
    settings = settings ? settings : &usual;
    imk_status status = check_settings(settings, error);
    if (status == IMK_OK)
        status = imk_model_validate(model, error);
    if (status != IMK_OK)
        return status;
    memset(f, 0, sizeof *f);
    f->arithmetic = settings->arithmetic;
    f->model = *model;
    leave_out(&f->model);
    status = compile(f, settings, &reference, error);
    if (status == IMK_OK)
        status = set_frame(f, &reference, error);
    if (status == IMK_OK) {
        round_thresholds(f);
        status = plan_operations(f, left, error);
    }
    if (status != IMK_OK)
        return status;
    find_bounds(f, &reference, left);
    count_cost(f);
    f->cookie = IMKI_FIRMWARE_COOKIE;
    return IMK_OK;
}
