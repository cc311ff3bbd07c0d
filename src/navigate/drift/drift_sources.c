/* SPDX-License-Identifier: Apache-2.0 */
/* From a model to the sources of error that the linear theory knows: each term on all axes of its
 * sensor one source, each number of it an independent element. Here those of known value, what
 * differs from run to run, the clock and the start; noise in drift_noise_sources.c. */
#include "drift_aided_internal.h"
#include "drift_correlation_internal.h"

#include "imukit/distort.h"
#include "imukit/navigate.h"
#include "model/model_schema_internal.h"
#include "noise/noise_terms_internal.h"

#include <string.h>

/* ---- terms of known value ---------------------------------------------------------------------
 */

static const char *const kinds[2] = {"gyro", "accel"};

/* A term whose numbers are known: `width` for each axis. */
typedef struct known_term {
    const double *number;
    int term, width, sensor;
} known_term;

/* The kind of column of a form, and which part of it number j is. */
static imki_column_kind kind_of(const known_term *known, int axis, int j, int *part)
{
    static const imki_column_kind kind[] = {
        [IMKI_FORM_POWER] = IMKI_COLUMN_POWER, [IMKI_FORM_CROSS] = IMKI_COLUMN_CROSS,
        [IMKI_FORM_FORCE] = IMKI_COLUMN_FORCE, [IMKI_FORM_PRODUCT] = IMKI_COLUMN_PRODUCT,
        [IMKI_FORM_PLACE] = IMKI_COLUMN_LEVER, [IMKI_FORM_TIME] = IMKI_COLUMN_ONE};
    const imki_form form = imki_terms[known->term].form;
    *part = form == IMKI_FORM_INPUT   ? axis
            : form == IMKI_FORM_POWER ? imki_power_of(known->term)
            : known->width > 1        ? j
                                      : 0;
    return form == IMKI_FORM_INPUT || form == IMKI_FORM_SEEN ? imki_drift_own_input(known->sensor)
                                                             : kind[form];
}

static imki_drift_column known_column(const known_term *known, const imk_triad *triad, int axis,
                                      int j)
{
    int part;
    const imki_column_kind kind = kind_of(known, axis, j, &part);
    imki_drift_column column = imki_drift_column_of(kind, known->sensor, axis, part);
    if (kind != IMKI_COLUMN_CROSS)
        return column;
    const double *stated = triad->nonlinearity.pendulous_axis[axis];
    if (imki_drift_has_any(stated, 3))
        memcpy(column.pendulous, stated, sizeof column.pendulous);
    else
        column.pendulous[(axis + 2) % 3] = 1.0;
    for (int k = 0; k < 3; k++) { /* pendulous x input */
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        const double input[3] = {axis == 0, axis == 1, axis == 2};
        column.output[k] = column.pendulous[l] * input[m] - column.pendulous[m] * input[l];
    }
    return column;
}

static void add_known(imki_drift_plan *plan, const known_term *known, const imk_triad *triad,
                      bool compensated)
{
    const bool ramp = imki_terms[known->term].form == IMKI_FORM_TIME;
    const bool decay = imki_terms[known->term].form == IMKI_FORM_DECAY;
    const imki_drift_driver driver = ramp    ? imki_driver_ramp()
                                     : decay ? imki_driver_decay(triad->bias.warm_up_time.value)
                                             : imki_driver_constant();
    for (int axis = 0; axis < 3; axis++)
        for (int j = 0; j < known->width; j++) {
            const double x = known->number[axis * known->width + j];
            if (x == 0.0)
                continue;
            const imki_drift_column column = known_column(known, triad, axis, j);
            imki_drift_add_constant(plan, compensated ? IMKI_ELEMENT_SIZE : IMKI_ELEMENT_MEAN,
                                    &column, &driver, ramp ? 0.0 : x, ramp ? x : 0.0);
            if (plan->element && compensated)
                plan->element[plan->element_count - 1].correlated =
                    1 + imki_correlation_index(plan->correlation,
                                               (imk_model_parameter){(uint8_t)known->sensor,
                                                                     (uint8_t)known->term,
                                                                     (uint8_t)axis, (uint8_t)j});
        }
}

static void add_terms(imki_drift_plan *plan, const imk_triad *triad, int sensor, bool compensated)
{
    uint8_t term[IMKI_TERMS];
    const size_t count = imki_terms_in_order(sensor, term);
    for (size_t i = 0; i < count; i++) {
        const imki_term *row = &imki_terms[term[i]];
        const imki_field *field = imki_term_field(term[i]);
        const known_term known = {compensated ? imki_field_sigmas(field, triad)
                                              : imki_field_values(field, triad),
                                  term[i], imki_form_elements(row->form), sensor};
        /* A model without a warm-up states no time for it. */
        if (!row->text[sensor] || !imki_drift_has_any(known.number, 3 * known.width) ||
            (row->form == IMKI_FORM_DECAY && !(triad->bias.warm_up_time.value > 0.0)))
            continue;
        imki_drift_add_source(plan, kinds[sensor], imki_field_name(field, sensor), "",
                              row->text[sensor]);
        add_known(plan, &known, triad, compensated);
    }
}

/* ---- from run to run ---------------------------------------------------------------------------
 */

static void add_repeatabilities(imki_drift_plan *plan, const imk_triad *triad, int sensor)
{
    static const char *const names[2] = {"bias.repeatability", "scale_factor.repeatability"};
    static const char *const texts[2][2] = {
        {"gyro bias repeatability", "accelerometer bias repeatability"},
        {"gyro scale factor repeatability", "accelerometer scale factor repeatability"}};
    const imki_drift_driver driver = imki_driver_constant();
    for (int which = 0; which < 2; which++) {
        const double *value =
            which == 0 ? triad->bias.repeatability.value : triad->scale_factor.repeatability.value;
        if (!imki_drift_has_any(value, 3))
            continue;
        imki_drift_add_source(plan, kinds[sensor], names[which], "", texts[which][sensor]);
        for (int axis = 0; axis < 3; axis++) {
            const imki_drift_column column =
                which == 0 ? imki_drift_column_of(IMKI_COLUMN_ONE, sensor, axis, 0)
                           : imki_drift_column_of(imki_drift_own_input(sensor), sensor, axis, axis);
            if (value[axis] != 0.0)
                imki_drift_add_constant(plan, IMKI_ELEMENT_SIZE, &column, &driver, value[axis],
                                        0.0);
        }
    }
}

/* ---- the clock and the start ------------------------------------------------------------------
 */

/* A body at rest looks the same at all times. */
static void add_timing(imki_drift_plan *plan, const imk_timing *timing, bool compensated, double dt)
{
    const imki_drift_driver constant = imki_driver_constant(), white = imki_driver_white();
    const imki_element_use use = compensated ? IMKI_ELEMENT_SIZE : IMKI_ELEMENT_MEAN;
    const struct {
        const imk_scalar *scalar;
        imki_column_kind kind;
        const char *name, *text;
    } known[2] = {
        {&timing->rate_error, IMKI_COLUMN_CLOCK, "rate_error", "rate error of the sample clock"},
        {&timing->skew, IMKI_COLUMN_SKEW, "skew", "delay of the accelerometers"}};
    for (int i = 0; i < 2; i++) {
        const double x = compensated ? known[i].scalar->sigma : known[i].scalar->value;
        const imki_drift_column column = imki_drift_column_of(known[i].kind, 0, 0, 0);
        if (x == 0.0)
            continue;
        imki_drift_add_source(plan, "timing", known[i].name, "", known[i].text);
        imki_drift_add_constant(plan, use, &column, &constant, x, 0.0);
    }
    if (timing->jitter.value != 0.0) {
        const imki_drift_column column = imki_drift_column_of(IMKI_COLUMN_JITTER, 0, 0, 0);
        imki_drift_add_source(plan, "timing", "jitter", "", "jitter of the samples");
        imki_drift_add_noise(plan, IMKI_ELEMENT_ROUNDING, &column, &white,
                             timing->jitter.value * timing->jitter.value * dt);
        if (plan->element)
            plan->element[plan->element_count - 1].state[0] = timing->jitter.value;
    }
}

/* Constants that nothing drives: their column is that of a bias, but their driver is zero. A
 * displayed attitude belongs to the level where the unit believes to be, and so does one that it
 * finds: an error of the position turns both. */
static void add_initial(imki_drift_plan *plan, const imk_drift_settings *settings,
                        imk_geodetic start)
{
    static const char *const names[3] = {"position", "velocity", "attitude"};
    static const char *const texts[3] = {"position at the start", "velocity at the start",
                                         "attitude at the start"};
    static const int place[3] = {6, 3, 0}; /* in x */
    const bool self = settings->alignment == IMK_ALIGNED_SELF;
    const bool displayed = self || settings->attitude_errors == IMK_ATTITUDE_LOCAL;
    const imk_matrix3 axes = imk_ned_axes(start.latitude, start.longitude);
    const imk_matrix3 turn = imk_matrix3_multiply(axes, imk_level_turn(start));
    const imki_drift_driver constant = imki_driver_constant();
    const imki_drift_column column = imki_drift_column_of(IMKI_COLUMN_ONE, IMK_GYRO, 0, 0);
    for (int group = 0; group < 3; group++) {
        const double *sigma = settings->initial_sigma + (ptrdiff_t)3 * group;
        if (!imki_drift_has_any(sigma, 3) || (group == 2 && self))
            continue;
        imki_drift_add_source(plan, "initial", names[group], "", texts[group]);
        for (int j = 0; j < 3; j++) {
            imki_drift_element *element =
                imki_drift_add_element(plan, IMKI_ELEMENT_SIZE, &column, &constant);
            for (int i = 0; element && i < 3; i++) {
                element->x[place[group] + i] = axes.m[i][j] * sigma[j];
                if (group == 0 && displayed)
                    element->x[i] = turn.m[i][j] * sigma[j];
            }
        }
    }
}

/* ---- all ---------------------------------------------------------------------------------------
 */

size_t imki_drift_drivers_max(const imk_model *model, const imk_drift_settings *settings)
{
    const imk_noise *noise[2] = {&model->gyro.noise, &model->accel.noise};
    /* white, constant, walk, ramp, gravity, two warm-ups; two correlation times of flicker noise */
    size_t count = 2 * IMK_FLICKER_STAGES + 7 + settings->aid_count;
    for (int t = 0; t < IMKI_NOISE_TERMS; t++)
        for (int i = 0; i < 2 && imki_noise_terms[t]->count; i++)
            count += 3 * (size_t)imki_term_count(imki_noise_terms[t], noise[i]);
    return count;
}

static void add_triad(imki_drift_plan *plan, const imk_triad *triad, int sensor,
                      const imk_drift_settings *settings)
{
    add_repeatabilities(plan, triad, sensor);
    add_terms(plan, triad, sensor, settings->compensated);
    imki_drift_noise_sources(plan, triad, sensor, settings);
}

void imki_drift_sources(imki_drift_plan *plan, const imk_model *model,
                        const imk_drift_settings *settings, imk_geodetic start)
{
    plan->correlation =
        settings->compensated && model->correlation.count > 1 ? &model->correlation : NULL;
    add_triad(plan, &model->gyro, IMK_GYRO, settings);
    add_triad(plan, &model->accel, IMK_ACCEL, settings);
    if (settings->motion) {
        add_timing(plan, &model->timing, settings->compensated, 1.0 / settings->rate);
        if (settings->motion->line_count > 0)
            imki_drift_omit(plan, "motion.vibration");
    }
    if (model->timing.drops.value > 0.0)
        imki_drift_omit(plan, "timing.drops");
    imki_drift_gravity_source(plan, settings);
    add_initial(plan, settings, start);
    imki_drift_aid_sources(plan, settings);
}
