/* SPDX-License-Identifier: Apache-2.0 */
/* The operations of a plan carried out here as they are on the device, and the flags. */
#include "firmware_internal.h"

#include <float.h>
#include <math.h>

static const double all_of_int32 = 2147483648.0;

/* The nearest integer of 32 bits, times 2^-bits. */
static double to_grid(double x, int bits)
{
    const double integer = floor(ldexp(x, bits) + 0.5);
    return ldexp(fmax(fmin(integer, all_of_int32 - 1), -all_of_int32), -bits);
}

void imk_firmware_round(const imk_firmware *firmware, imk_firmware_sample *sample)
{
    const bool fixed = firmware->arithmetic == IMK_FIRMWARE_FIXED;
    const bool single = firmware->arithmetic == IMK_FIRMWARE_FLOAT;
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < firmware->axis_count[sensor]; i++) {
            const imk_firmware_channel *channel = &firmware->channel[sensor][i];
            double *reading = &sample->reading[sensor][i];
            if (channel->in_counts || fixed)
                *reading = to_grid(*reading, channel->bits);
            else if (single)
                *reading = imki_firmware_single(*reading);
        }
    if (fixed)
        sample->temperature = to_grid(sample->temperature, firmware->temperature_bits);
    else if (single)
        sample->temperature = imki_firmware_single(sample->temperature);
}

/* ---- operations ------------------------------------------------------------------------------ */

static void run_float(const imk_firmware *f, const imk_firmware_sample *s, float *value)
{
    for (int n = 0; n < f->operation_count; n++) {
        const imk_firmware_operation *o = &f->operation[n];
        const float a = o->a >= 0 ? value[o->a] : 0.0f, b = o->b >= 0 ? value[o->b] : 0.0f;
        const float lower = (float)o->lower, upper = (float)o->upper;
        float sum = (float)o->constant;
        switch (o->kind) {
        case IMK_FIRMWARE_READING:
            value[n] =
                (float)(s->reading[o->sensor][o->axis] - f->channel[o->sensor][o->axis].origin);
            break;
        case IMK_FIRMWARE_TEMPERATURE:
            value[n] = (float)s->temperature;
            break;
        case IMK_FIRMWARE_CLIP:
            value[n] = a < lower ? lower : a > upper ? upper : a;
            break;
        case IMK_FIRMWARE_SIZE:
            value[n] = a < 0.0f ? -a : a;
            break;
        case IMK_FIRMWARE_PRODUCT:
            value[n] = a * b;
            value[n] += sum;
            break;
        case IMK_FIRMWARE_SUM:
            for (int k = o->first; k < o->first + o->count; k++) {
                const float product = (float)f->term[k].coefficient * value[f->term[k].operand];
                sum += product;
            }
            value[n] = sum;
        }
    }
}

static void run_double(const imk_firmware *f, const imk_firmware_sample *s, double *value)
{
    for (int n = 0; n < f->operation_count; n++) {
        const imk_firmware_operation *o = &f->operation[n];
        const double a = o->a >= 0 ? value[o->a] : 0.0, b = o->b >= 0 ? value[o->b] : 0.0;
        double sum = o->constant;
        switch (o->kind) {
        case IMK_FIRMWARE_READING:
            value[n] = s->reading[o->sensor][o->axis] - f->channel[o->sensor][o->axis].origin;
            break;
        case IMK_FIRMWARE_TEMPERATURE:
            value[n] = s->temperature;
            break;
        case IMK_FIRMWARE_CLIP:
            value[n] = a < o->lower ? o->lower : a > o->upper ? o->upper : a;
            break;
        case IMK_FIRMWARE_SIZE:
            value[n] = a < 0.0 ? -a : a;
            break;
        case IMK_FIRMWARE_PRODUCT:
            value[n] = a * b + sum;
            break;
        case IMK_FIRMWARE_SUM:
            for (int k = o->first; k < o->first + o->count; k++)
                sum += f->term[k].coefficient * value[f->term[k].operand];
            value[n] = sum;
        }
    }
}

/* A shift to the right rounds down, as floor() does: of negative numbers too, by every compiler
 * these are made for. */
static int32_t shifted(int64_t x, int shift)
{
    return (int32_t)(x >> shift);
}

static int32_t clipped(int32_t x, const imk_firmware_operation *o)
{
    return x < o->fixed_lower ? o->fixed_lower : x > o->fixed_upper ? o->fixed_upper : x;
}

static void run_fixed(const imk_firmware *f, const imk_firmware_sample *s, int32_t *value)
{
    for (int n = 0; n < f->operation_count; n++) {
        const imk_firmware_operation *o = &f->operation[n];
        const int32_t a = o->a >= 0 ? value[o->a] : 0, b = o->b >= 0 ? value[o->b] : 0;
        int64_t sum = o->fixed_constant;
        switch (o->kind) {
        case IMK_FIRMWARE_READING:
            value[n] = clipped((int32_t)ldexp(s->reading[o->sensor][o->axis], o->bits), o) -
                       f->channel[o->sensor][o->axis].origin;
            break;
        case IMK_FIRMWARE_TEMPERATURE:
            value[n] = (int32_t)ldexp(s->temperature, o->bits);
            break;
        case IMK_FIRMWARE_CLIP:
            value[n] = clipped(a, o);
            break;
        case IMK_FIRMWARE_SIZE:
            value[n] = a < 0 ? -a : a;
            break;
        case IMK_FIRMWARE_PRODUCT:
            value[n] = shifted((int64_t)a * b + ((int64_t)1 << (o->shift - 1)), o->shift) +
                       (int32_t)o->fixed_constant;
            break;
        case IMK_FIRMWARE_SUM:
            for (int k = o->first; k < o->first + o->count; k++)
                sum += (int64_t)f->term[k].fixed * value[f->term[k].operand];
            value[n] = shifted(sum, o->shift);
        }
    }
}

/* ---- flags ----------------------------------------------------------------------------------- */

static unsigned flags_of(const imk_firmware *f, const imk_firmware_sample *s)
{
    unsigned flags = 0;
    for (int sensor = 0; sensor < 2; sensor++) {
        for (int i = 0; i < f->axis_count[sensor]; i++) {
            const imk_firmware_channel *channel = &f->channel[sensor][i];
            const double r = s->reading[sensor][i];
            if (!(fabs(r) <= DBL_MAX))
                flags |= IMK_FLAG_NOT_FINITE;
            else if (!(r > channel->lower && r < channel->upper))
                flags |= channel->flag;
        }
        for (int j = 0; j < f->output_count[sensor] && f->limited[sensor]; j++)
            if (fabs(s->out[sensor][j]) > f->limit[sensor][j])
                flags |= IMK_FLAG_LIMIT;
    }
    if (f->needs_temperature && !(fabs(s->temperature) <= DBL_MAX))
        flags |= IMK_FLAG_NOT_FINITE;
    else if (f->needs_temperature && !(s->temperature >= f->temperature_minimum &&
                                       s->temperature <= f->temperature_maximum))
        flags |= IMK_FLAG_TEMPERATURE;
    return flags;
}

void imk_firmware_run(const imk_firmware *firmware, imk_firmware_sample *sample)
{
    union {
        float single[IMK_FIRMWARE_OPERATIONS_MAX];
        double both[IMK_FIRMWARE_OPERATIONS_MAX];
        int32_t fixed[IMK_FIRMWARE_OPERATIONS_MAX];
    } value;
    const imk_firmware *f = firmware;
    if (f->arithmetic == IMK_FIRMWARE_FLOAT)
        run_float(f, sample, value.single);
    else if (f->arithmetic == IMK_FIRMWARE_DOUBLE)
        run_double(f, sample, value.both);
    else
        run_fixed(f, sample, value.fixed);
    for (int sensor = 0; sensor < 2; sensor++)
        for (int j = 0; j < f->output_count[sensor]; j++) {
            const int n = f->output[sensor][j];
            sample->out[sensor][j] = f->arithmetic == IMK_FIRMWARE_FLOAT ? (double)value.single[n]
                                     : f->arithmetic == IMK_FIRMWARE_DOUBLE
                                         ? value.both[n]
                                         : ldexp(value.fixed[n], -f->output_bits[sensor]);
        }
    sample->flags = flags_of(f, sample);
}
