/* SPDX-License-Identifier: Apache-2.0 */
/* NAME_test.c: samples of random motion within the limits, what imk_correct() makes of them, and a
 * function that compares. Some are saturated or outside the temperature range: of these the flags
 * are compared, and of saturated ones nothing else. */
#include "emit_internal.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SATURATED_EVERY = 16, HOT_EVERY = 8 };

static const double kelvin = 273.15;

/* Where the model states no range, temperatures of nowhere in particular [degC]. */
static const double usual_temperature[2] = {-40, 85};

/* SplitMix64: the same table everywhere. */
static double uniform(uint64_t *state)
{
    uint64_t z = (*state += 0x9E3779B97F4A7C15u);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static double draw_temperature(const imk_firmware *f, uint64_t *state, uint32_t index)
{
    double lower = f->temperature_minimum, upper = f->temperature_maximum;
    if (!isfinite(lower) || !isfinite(upper)) {
        lower = usual_temperature[0];
        upper = usual_temperature[1];
    }
    const double inside = lower + (upper - lower) * uniform(state), beyond = 30 * uniform(state);
    if (index % HOT_EVERY != HOT_EVERY - 1)
        return inside;
    return index / HOT_EVERY % 2 == 0 ? upper + beyond : fmax(lower - beyond, -kelvin);
}

/* Readings of a motion of random direction and size, rounded to what the device has. */
static void draw_sample(const imk_firmware *f, uint64_t *state, uint32_t index,
                        imk_firmware_sample *sample)
{
    const double size = 0.88 * uniform(state);
    double motion[2][3], temperature;
    imk_stimulus stimulus = {.temperature = &temperature};
    memset(sample, 0, sizeof *sample);
    sample->temperature = draw_temperature(f, state, index);
    temperature = sample->temperature + kelvin;
    for (int j = 0; j < 3; j++) {
        motion[IMK_GYRO][j] = size * f->limit[IMK_GYRO][j] * (2 * uniform(state) - 1);
        motion[IMK_ACCEL][j] = size * f->limit[IMK_ACCEL][j] * (2 * uniform(state) - 1);
        stimulus.angular_rate[j] = f->output_count[IMK_GYRO] > 0 ? &motion[IMK_GYRO][j] : NULL;
        stimulus.specific_force[j] = f->output_count[IMK_ACCEL] > 0 ? &motion[IMK_ACCEL][j] : NULL;
    }
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < f->axis_count[sensor]; i++) {
            double reading;
            imk_distort(&f->correction.distortion, sensor, i, &stimulus, 1, &reading);
            sample->reading[sensor][i] =
                reading / f->correction.per_unit[sensor][i] + f->correction.zero_offset[sensor][i];
        }
    if (index % SATURATED_EVERY == SATURATED_EVERY - 1) {
        const uint32_t axis = index / SATURATED_EVERY % 6;
        const imk_firmware_channel *channel = &f->channel[axis / 3][axis % 3];
        if ((int)(axis % 3) < f->axis_count[axis / 3])
            sample->reading[axis / 3][axis % 3] = axis % 2 ? channel->lower : channel->upper;
    }
    imk_firmware_round(f, sample);
}

static void add_value(imki_text *out, imk_firmware_arithmetic arithmetic, bool integer,
                      double value, int bits)
{
    if (integer)
        imki_text_add(out, "%.0f", ldexp(value, bits));
    else
        imki_emit_number(out, arithmetic, value);
}

static void write_sample(imki_emission *e, const imk_correction *exact,
                         const imk_firmware_sample *sample)
{
    const imk_firmware *f = e->plan;
    const bool fixed = f->arithmetic == IMK_FIRMWARE_FIXED;
    const double temperature = sample->temperature + kelvin;
    double out[2][IMK_AXES_MAX], *to[2][IMK_AXES_MAX];
    imk_readings readings = {.temperature = &temperature};
    for (int k = 0; k < 2 * IMK_AXES_MAX; k++) {
        const int sensor = k / IMK_AXES_MAX, i = k % IMK_AXES_MAX;
        readings.channel[sensor][i] = &sample->reading[sensor][i];
        to[sensor][i] = &out[sensor][i];
    }
    /* The cast only adds const, which C17 does not do by itself for arrays of pointers. */
    imk_correct(exact, &readings, 1, (double *const(*)[IMK_AXES_MAX])to);
    imki_text_add(e->out, "    {");
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < f->axis_count[sensor]; i++) {
            const imk_firmware_channel *channel = &f->channel[sensor][i];
            imki_text_add(e->out, i == 0 ? "{" : ", ");
            add_value(e->out, f->arithmetic, fixed || channel->in_counts,
                      sample->reading[sensor][i], channel->bits);
            imki_text_add(e->out, i + 1 == f->axis_count[sensor] ? "}, " : "");
        }
    if (f->needs_temperature) {
        add_value(e->out, f->arithmetic, fixed, sample->temperature, f->temperature_bits);
        imki_text_add(e->out, ", ");
    }
    for (int sensor = 0; sensor < 2; sensor++)
        for (int j = 0; j < f->output_count[sensor]; j++) {
            imki_text_add(e->out, j == 0 ? "{" : ", ");
            if (fixed)
                imki_text_add(e->out, "%.0f",
                              fmin(fmax(floor(ldexp(out[sensor][j], f->output_bits[sensor]) + 0.5),
                                        -2147483647.0),
                                   2147483647.0));
            else
                imki_emit_number(e->out, IMK_FIRMWARE_DOUBLE, out[sensor][j]);
            imki_text_add(e->out, j + 1 == f->output_count[sensor] ? "}, " : "");
        }
    imki_text_add(e->out, "%u},\n", sample->flags);
}

/* The structure of the table, and how far off an output may be. */
static void write_types(const imki_emission *e)
{
    const imk_firmware *f = e->plan;
    const bool fixed = f->arithmetic == IMK_FIRMWARE_FIXED;
    imki_text *out = e->out;
    imki_text_add(out, "struct sample {\n");
    for (int sensor = 0; sensor < 2; sensor++)
        if (f->axis_count[sensor] > 0)
            imki_text_add(out, "    %s %s[%d];\n", imki_emit_reading_type(f, sensor),
                          imki_emit_sensor[sensor], f->axis_count[sensor]);
    if (f->needs_temperature)
        imki_text_add(out, "    %s temperature;\n", imki_emit_type(f));
    for (int sensor = 0; sensor < 2; sensor++)
        if (f->axis_count[sensor] > 0)
            imki_text_add(out, "    %s %s[%d]; /* exact%s */\n", fixed ? "int32_t" : "double",
                          imki_emit_motion[sensor], f->output_count[sensor],
                          fixed ? ", rounded" : "");
    imki_text_add(out, "    unsigned flags;\n};\n\n");
    for (int sensor = 0; sensor < 2; sensor++) {
        if (f->axis_count[sensor] == 0)
            continue;
        imki_text_add(out, "static const %s %s_bound = ", fixed ? "int32_t" : "double",
                      imki_emit_motion[sensor]);
        if (fixed) /* and half a unit of the table */
            imki_text_add(out, "%.0f", ceil(ldexp(f->bound[sensor], f->output_bits[sensor]) + 0.5));
        else
            imki_emit_number(out, IMK_FIRMWARE_DOUBLE, f->bound[sensor]);
        imki_text_add(out, "; /* ");
        imki_emit_decimal(out, f->bound[sensor], 2);
        imki_text_add(out, " %s */\n", imki_emit_unit[sensor]);
    }
    imki_text_add(out, "\n");
}

static void write_function(const imki_emission *e)
{
    const imk_firmware *f = e->plan;
    const bool fixed = f->arithmetic == IMK_FIRMWARE_FIXED;
    const char *type = fixed ? "int64_t" : "double", *separator = "";
    imki_text *out = e->out;
    imki_text_add(out, "static int is_off(%s actual, %s exact, %s bound)\n{\n", type, type, type);
    imki_text_add(out, "    const %s difference = actual - exact;\n", type);
    imki_text_add(out, "    return !(difference <= bound && -difference <= bound);\n}\n\n");
    imki_text_add(out, "unsigned long %s_self_test(void)\n{\n    unsigned long wrong = 0;\n",
                  e->name);
    imki_text_add(out,
                  "    for (unsigned long i = 0; i < %luul; i++) {\n"
                  "        const struct sample *s = &samples[i];\n",
                  (unsigned long)e->vectors);
    for (int sensor = 0; sensor < 2; sensor++)
        if (f->axis_count[sensor] > 0)
            imki_text_add(out, "        %s %s[%d];\n", imki_emit_type(f), imki_emit_motion[sensor],
                          f->output_count[sensor]);
    imki_text_add(out, "        const unsigned flags = %s_correct(", e->name);
    for (int sensor = 0; sensor < 2; sensor++)
        if (f->axis_count[sensor] > 0) {
            imki_text_add(out, "%ss->%s", separator, imki_emit_sensor[sensor]);
            separator = ", ";
        }
    imki_text_add(out, f->needs_temperature ? ", s->temperature" : "");
    for (int sensor = 0; sensor < 2; sensor++)
        if (f->axis_count[sensor] > 0)
            imki_text_add(out, ", %s", imki_emit_motion[sensor]);
    imki_text_add(out,
                  ");\n        int bad = flags != s->flags;\n        if ((flags & ~(unsigned)");
    imki_emit_capitals(out, e->name);
    imki_text_add(out, "_TEMPERATURE) == 0) {\n");
    for (int sensor = 0; sensor < 2; sensor++)
        if (f->axis_count[sensor] > 0)
            imki_text_add(out,
                          "            for (int j = 0; j < %d; j++)\n                bad |= "
                          "is_off(%s[j], s->%s[j], %s_bound);\n",
                          f->output_count[sensor], imki_emit_motion[sensor],
                          imki_emit_motion[sensor], imki_emit_motion[sensor]);
    imki_text_add(out, "        }\n        wrong += bad != 0;\n    }\n    return wrong;\n}\n");
}

imk_status imki_emit_test(imki_emission *e, imk_error *error)
{
    imk_correction *exact = malloc(sizeof *exact);
    imk_correction_settings settings = imk_correction_default();
    uint64_t state = 1;
    if (!exact)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    for (int sensor = 0; sensor < 2; sensor++) {
        double *limit = sensor == IMK_GYRO ? &settings.rate_limit : &settings.force_limit;
        const imk_triad *triad = imk_model_triad(&e->plan->model, sensor);
        for (int j = 0; triad->present && j < e->plan->output_count[sensor]; j++)
            *limit = fmax(*limit, e->plan->correction.limit[sensor][j]);
        for (int i = 0; triad->present && i < triad->axis_count; i++)
            if (triad->range.value[i] > 0)
                *limit = 0; /* as the plan took them from the ranges */
    }
    const imk_status status = imk_correction_start(exact, &e->plan->model, &settings, error);
    if (status != IMK_OK) {
        free(exact);
        return status;
    }
    imki_text_add(e->out, IMKI_EMIT_MARK ": change the model, not this file. */\n");
    imki_text_add(e->out, "#include \"%s.h\"\n\n", e->name);
    write_types(e);
    imki_text_add(e->out, "static const struct sample samples[%lu] = {\n",
                  (unsigned long)e->vectors);
    for (uint32_t i = 0; i < e->vectors; i++) {
        imk_firmware_sample sample;
        draw_sample(e->plan, &state, i, &sample);
        imk_firmware_run(e->plan, &sample);
        write_sample(e, exact, &sample);
    }
    imki_text_add(e->out, "};\n\n");
    write_function(e);
    free(exact);
    return IMK_OK;
}
