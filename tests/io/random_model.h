/* SPDX-License-Identifier: Apache-2.0 */
/* Random valid models for tests: each field of the schema is absent, a round figure in its usual
 * unit, or any double. */
#ifndef IMUKIT_TESTS_RANDOM_MODEL_H
#define IMUKIT_TESTS_RANDOM_MODEL_H

#include "imukit/model_parameter.h"
#include "imukit/units.h"
#include "model/model_schema_internal.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* SplitMix64: enough for choosing test cases, and the same everywhere. */
static inline uint64_t random_bits(uint64_t *state)
{
    uint64_t z = (*state += 0x9E3779B97F4A7C15u);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

static inline int random_below(uint64_t *state, int limit)
{
    return (int)(random_bits(state) % (uint64_t)limit);
}

static inline double random_unit(uint64_t *state)
{
    return (double)(random_bits(state) >> 11) * 0x1p-53;
}

/* A number for a field: within its range, of a size met in practice, sometimes an extreme one. */
static inline double random_number(uint64_t *state, const imki_field *field, const char *unit)
{
    double scale = imk_unit_of(unit).scale, x;
    switch (random_below(state, 4)) {
    case 0:
        x = random_below(state, 1000) * scale;
        break;
    case 1:
        x = random_below(state, 100000) / 1000.0 * scale;
        break;
    case 2:
        x = random_unit(state) * scale * pow(10, random_below(state, 6) - 3);
        break;
    default:
        x = ldexp(random_unit(state), random_below(state, 400) - 200);
    }
    if (field->minimum < 0 && random_below(state, 2))
        x = -x;
    bool bounded = field->minimum > -DBL_MAX && (field->minimum != 0 || field->maximum < DBL_MAX);
    double width = fmin(field->maximum, field->minimum + 1) - field->minimum;
    if (bounded && !(x > field->minimum && x < field->maximum))
        x = field->minimum + width * (0.01 + 0.9 * random_unit(state));
    return x;
}

static inline void random_axes(uint64_t *state, const imki_field *field, const char *unit,
                               double *values, double *sigmas, int count, bool positive)
{
    bool same = random_below(state, 2), has_sigma = random_below(state, 3) == 0;
    for (int i = 0; i < count; i++) {
        do
            values[i] = same && i > 0 ? values[0] : random_number(state, field, unit);
        while (positive && !(values[i] > 0));
        if (!positive && !same && random_below(state, 5) == 0)
            values[i] = field->minimum > 0 && !(field->flags & IMKI_TYPICAL) ? field->minimum : 0;
        sigmas[i] = !has_sigma      ? 0
                    : same && i > 0 ? sigmas[0]
                                    : fabs(values[i]) * random_below(state, 30) / 100;
    }
}

static inline void random_polynomial(uint64_t *state, const imki_field *field, int kind,
                                     imk_triad *triad)
{
    imk_temperature_polynomial *polynomial =
        (imk_temperature_polynomial *)(void *)((char *)triad + field->offset);
    polynomial->order = 1 + random_below(state, IMK_TEMPERATURE_ORDER_MAX);
    polynomial->reference = 273.15 + random_below(state, 50);
    polynomial->minimum = random_below(state, 2) ? 233.15 : 200 + random_unit(state);
    polynomial->maximum = random_below(state, 2) ? 358.15 : 300 + 100 * random_unit(state);
    for (int i = 0; i < polynomial->order; i++)
        random_axes(state, field, imki_polynomial_unit(field, kind, i + 1),
                    polynomial->coefficient[i].value, polynomial->coefficient[i].sigma,
                    triad->axis_count, false);
}

static inline void random_list(uint64_t *state, const imki_field *field, int kind, imk_triad *triad)
{
    imki_list list = imki_list_of(field);
    int count = 1 + random_below(state, 3);
    memcpy((char *)triad + field->count_offset, &count, sizeof count);
    for (int i = 0; i < count; i++)
        for (size_t j = 0; j < list.field_count; j++) {
            imk_axes *axes = (imk_axes *)(void *)((char *)triad + field->offset +
                                                  (size_t)i * list.size + list.field[j].offset);
            random_axes(state, &list.field[j], list.field[j].unit[kind], axes->value, axes->sigma,
                        triad->axis_count, true);
        }
}

static inline void random_directions(uint64_t *state, imk_triad *triad)
{
    triad->axis_count = 1 + random_below(state, IMK_AXES_MAX);
    for (int i = 0; i < triad->axis_count; i++) {
        double e[3], square = 0;
        for (int j = 0; j < 3; j++) {
            e[j] = random_unit(state) - 0.5;
            square += e[j] * e[j];
        }
        for (int j = 0; j < 3; j++)
            triad->direction[i][j] = e[j] / sqrt(square);
    }
}

/* Across the direction, on some axes. */
static inline void random_pendulous(uint64_t *state, imk_triad *triad)
{
    for (int i = 0; i < triad->axis_count; i++) {
        const double *e = triad->direction[i];
        double *p = triad->nonlinearity.pendulous_axis[i], square = 0;
        int k = fabs(e[0]) < 0.6 ? 0 : 1;
        for (int j = 0; j < 3; j++) {
            p[j] = (j == k ? 1 : 0) - e[k] * e[j];
            square += p[j] * p[j];
        }
        bool is_stated = random_below(state, 2);
        for (int j = 0; j < 3; j++)
            p[j] = is_stated ? p[j] / sqrt(square) : 0;
    }
}

static inline void random_field(uint64_t *state, const imki_field *field, int kind,
                                imk_triad *triad)
{
    double *values = (double *)(void *)((char *)triad + field->offset);
    double *sigmas = values + (imki_field_sigmas(field, triad) - imki_field_values(field, triad));
    int length = imki_row_length(field->shape);
    switch (field->shape) {
    case IMKI_DIRECTION:
        break;
    case IMKI_PENDULOUS:
        random_pendulous(state, triad);
        break;
    case IMKI_DENSITY:
        triad->noise.density = (imk_density)random_below(state, 3);
        break;
    case IMKI_POLYNOMIAL:
        random_polynomial(state, field, kind, triad);
        break;
    case IMKI_LIST:
        random_list(state, field, kind, triad);
        break;
    case IMKI_SCALAR:
        random_axes(state, field, field->unit[kind], values, sigmas, 1, false);
        break;
    default:
        random_axes(state, field, field->unit[kind], values, sigmas, triad->axis_count * length,
                    false);
        for (int i = 0; field->shape == IMKI_OFF_DIAGONAL && i < 3; i++)
            if (triad->axis_count == 3)
                values[4 * i] = sigmas[4 * i] = 0;
    }
}

/* Give settings that need or exclude each other what they need. */
static inline void make_consistent(uint64_t *state, imk_triad *triad)
{
    bool counts = random_below(state, 3) == 0;
    triad->bias.warm_up_time.value = 1 + random_below(state, 1000);
    for (int i = 0; i < triad->axis_count; i++) {
        if (triad->bandwidth.value[i] == 0)
            triad->damping.value[i] = 0;
        if (triad->noise.quantization.value[i] != 0)
            triad->resolution.value[i] = 0;
        if (counts == (triad->sensitivity.value[i] == 0))
            triad->sensitivity.value[i] = counts ? 100.5 : 0;
        if (!counts)
            triad->zero_offset.value[i] = 0;
    }
}

static inline void random_evidence(uint64_t *state, int kind, const imk_triad *triad,
                                   imk_evidence *evidence)
{
    static const char *const keys[2][3] = {
        {"noise.angle_random_walk", "noise.bias_instability", "noise.gauss_markov.sigma"},
        {"noise.velocity_random_walk", "bias.fixed", "noise.resonance.q"}};
    snprintf(evidence->source, sizeof evidence->source, "log %d: a, b", random_below(state, 99));
    for (int i = 0; i < 3; i++) {
        if (random_below(state, 2))
            continue;
        imk_interval *interval = &evidence->interval[evidence->interval_count++];
        snprintf(interval->key, sizeof interval->key, "%s", keys[kind][i]);
        interval->instance = i == 2 ? random_below(state, 3) : 0;
        bool is_bound = random_below(state, 2);
        for (int axis = 0; axis < triad->axis_count; axis++) {
            interval->lower.value[axis] = is_bound ? 0 : random_unit(state) * 1e-5;
            interval->upper.value[axis] = interval->lower.value[axis] + random_unit(state) * 1e-5;
        }
    }
}

/* Some of the numbers of the model, correlated to the decimals that are written. */
static inline void random_correlation(uint64_t *state, imk_model *model)
{
    imk_correlation *correlation = &model->correlation;
    const bool many = random_below(state, 16) == 0;
    const int most = 1 + random_below(state, many ? IMK_CORRELATED_MAX : 6);
    for (unsigned sensor = 0; sensor < 2; sensor++)
        for (unsigned term = 0; term < IMK_MODEL_TERMS; term++)
            for (unsigned axis = 0; axis < IMK_AXES_MAX; axis++)
                for (unsigned element = 0; element < 6; element++) {
                    const imk_model_parameter parameter = {(uint8_t)sensor, (uint8_t)term,
                                                           (uint8_t)axis, (uint8_t)element};
                    if (correlation->count < most && random_below(state, 4) == 0 &&
                        imk_model_parameter_at(model, parameter, NULL))
                        correlation->parameter[correlation->count++] = parameter;
                }
    for (int k = 0; k < correlation->count * (correlation->count - 1) / 2; k++)
        correlation->value[k] = (float)(random_below(state, 2000001) - 1000000) / 1e6f;
}

/* A valid model in which each field is there with a probability of 1/`sparsity`. */
static inline imk_model random_model(uint64_t *state, int sparsity, bool other_axes)
{
    imk_model model;
    imk_model_default(&model);
    imk_triad *triads[2] = {&model.gyro, &model.accel};
    imk_evidence *evidence[2] = {&model.gyro_evidence, &model.accel_evidence};
    snprintf(model.name, sizeof model.name, "random %d", random_below(state, 1000));
    model.gyro.present = random_below(state, 8) > 0;
    model.accel.present = !model.gyro.present || random_below(state, 8) > 0;
    for (int kind = 0; kind < 2; kind++) {
        if (!triads[kind]->present)
            continue;
        if (other_axes && random_below(state, 4) == 0)
            random_directions(state, triads[kind]);
        for (size_t i = 0; i < imki_triad_field_count; i++) {
            const imki_field *field = &imki_triad_fields[i];
            if (field->path[kind] && !(field->flags & IMKI_FLOOR) &&
                random_below(state, sparsity) == 0)
                random_field(state, field, kind, triads[kind]);
        }
        make_consistent(state, triads[kind]);
        if (random_below(state, sparsity) == 0)
            random_evidence(state, kind, triads[kind], evidence[kind]);
    }
    for (size_t i = 0; i < imki_timing_field_count; i++) {
        imk_scalar *scalar =
            (imk_scalar *)(void *)((char *)&model.timing + imki_timing_fields[i].offset);
        if (random_below(state, sparsity) == 0)
            random_axes(state, &imki_timing_fields[i], imki_timing_fields[i].unit[0],
                        &scalar->value, &scalar->sigma, 1, false);
    }
    if (random_below(state, sparsity) == 0)
        random_correlation(state, &model);
    return model;
}

#endif
