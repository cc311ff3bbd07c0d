/* SPDX-License-Identifier: Apache-2.0 */
/* Scale factors that no sensor has. One ratio on all axes is one cause: a range, a sampling rate, a
 * unit; else each axis is named. */
#include "solution_scale_internal.h"

#include <math.h>

/* The worst MEMS gyros and accelerometers are within 10 % of their nominal sensitivity, usual ones
 * within 3 %: further than the first is a doubt, further than the second is told. */
static const double DOUBTED = 0.15, TOLD = 0.05;
/* Axes whose ratios differ by less share a cause. */
static const double SHARED = 0.12;

typedef struct scales {
    int count, beyond, axis[IMK_AXES_MAX];
    double factor[IMK_AXES_MAX];
} scales;

/* Scale factors of a sensor that are further from 1 than the limit, their intervals included. */
static scales beyond(const imk_calibration_result *result, int sensor, double limit)
{
    scales s = {0};
    for (size_t p = 0; p < result->parameter_count; p++) {
        const imk_model_parameter at = result->parameter[p];
        if (at.sensor != sensor || at.term != IMK_MODEL_SCALE_FACTOR || at.axis >= IMK_AXES_MAX)
            continue;
        s.count++;
        if (fabs(result->value[p]) - imk_calibration_half_width(result, (int)p, 0.95) > limit) {
            s.axis[s.beyond] = at.axis;
            s.factor[s.beyond++] = 1.0 + result->value[p];
        }
    }
    return s;
}

static bool is_shared(const scales *s)
{
    bool shared = s->beyond == s->count && s->count > 1;
    for (int i = 1; i < s->beyond; i++)
        shared = shared && fabs(s->factor[i] / s->factor[0] - 1.0) < SHARED;
    return shared;
}

static size_t put(const imk_diagnostic_finding *found, size_t count, size_t capacity,
                  imk_diagnostic_finding *diagnostic)
{
    if (count < capacity)
        diagnostic[count] = *found;
    return count + (count < capacity);
}

static size_t look_at(const imk_calibration_result *result, int sensor, double limit, size_t count,
                      size_t capacity, imk_diagnostic_finding *diagnostic)
{
    const scales s = beyond(result, sensor, limit);
    imk_diagnostic_finding f = {
        .kind = IMK_DIAGNOSTIC_SCALE, .sensor = sensor, .axis = -1, .other = -1, .limit = limit};
    if (is_shared(&s)) {
        for (int i = 0; i < s.count; i++)
            f.value += s.factor[i] / s.count;
        return put(&f, count, capacity, diagnostic);
    }
    for (int i = 0; i < s.beyond; i++) {
        f.axis = s.axis[i];
        f.value = s.factor[i];
        count = put(&f, count, capacity, diagnostic);
    }
    return count;
}

size_t imki_solution_scales(const imk_calibration_result *result, size_t count, size_t capacity,
                            imk_diagnostic_finding *diagnostic)
{
    for (int sensor = 0; sensor < 2; sensor++) {
        const size_t before = count;
        count = look_at(result, sensor, DOUBTED, count, capacity, diagnostic);
        if (count == before)
            count = look_at(result, sensor, TOLD, count, capacity, diagnostic);
    }
    return count;
}
