/* SPDX-License-Identifier: Apache-2.0 */
/* What forward and inverse map share: the loops over samples, by instruction set.
 *
 * Samples are taken in chunks, four vectors of eight lanes. A feature is a component or the product
 * of two. Features of weight zero, and those the stimulus does not have, are left out of the loop
 * by a bit mask that is the same for all samples; this changes no bit of a result, as no sum is
 * ever -0. */
#ifndef IMUKI_DISTORT_INTERNAL_H
#define IMUKI_DISTORT_INTERNAL_H

#include "model_schema_internal.h"

#include "imukit/distort.h"

enum {
    IMKI_CHUNK = 32,               /* samples */
    IMKI_CORRECT_BLOCK = 64,       /* samples corrected together: some 30 kB of stack */
    IMKI_OWN_FEATURES = 0x007,     /* w of a gyro, f of an accelerometer */
    IMKI_PRODUCT_FEATURES = 0x1F8, /* products of components of the other kind */
    IMKI_THIRD_FEATURES = 0xE00    /* f of a gyro, angular acceleration of an accelerometer */
};

/* Which of the weights of an axis are not zero; index of imk_axis_response.used. */
enum { IMKI_ROW_INPUT, IMKI_ROW_OTHER, IMKI_ROW_PENDULOUS, IMKI_ROW_OUTPUT };

/* Where an axis has the coefficient of a power, times its weight. */
static inline size_t imki_power_place(const imki_power *power)
{
    return power->p - (power->q ? 0u : 2u);
}

static inline double imki_axis_power(const imk_axis_response *axis, const imki_power *power)
{
    return axis->power[power->q][imki_power_place(power)];
}

/* One component of the motion, or a chunk of zeros that stays where it is. */
typedef struct imki_component {
    const double *at;
    size_t moving; /* all ones, or 0 */
} imki_component;

/* A stimulus as one axis takes it. Feature k is factor[k][0], times factor[k][1] for a product. */
typedef struct imki_exposure {
    const double *factor[IMK_FEATURES][2];
    uint32_t available; /* bit k: feature k is not zero throughout */
    /* For an accelerometer away from the reference point: f, w and angular acceleration. The force
     * at its place is computed once for all rows, with the weights of the first three features. */
    imki_component force[3], rate[3], acceleration[3];
    bool turns; /* w or the angular acceleration is not zero throughout */
    const double *temperature, *temperature_rate, *warm_up, *hysteresis;
    /* Of imki_distort_chunks() and imki_distort_pair(): bias and scale factor of each sample, of
     * sensors side by side; NULL: those of the axis. Never -0. */
    const double *bias, *scale;
} imki_exposure;

imki_exposure imki_expose(int sensor, const imk_stimulus *stimulus);

/* What an axis reads over whole chunks. */
void imki_distort_chunks(imk_kernel kernel, const imk_axis_response *axis,
                         const imki_exposure *exposure, size_t chunks, double *out);

/* The same of two samples only. */
void imki_distort_pair(const imk_axis_response *axis, const imki_exposure *exposure, double *out);

/* The same where the motion stays what it is in the first chunk, which is all that is read of it;
 * the warm-up alone goes on, and there is no temperature. */
void imki_distort_still(imk_kernel kernel, const imk_axis_response *axis,
                        const imki_exposure *exposure, size_t chunks, double *out);

/* True when nothing but the bias and the scale factor may differ. */
bool imki_axes_alike(const imk_axis_response *a, const imk_axis_response *b);

/* What `count` axes read of one motion over whole chunks, all of them alike: as
 * imki_distort_chunks() gives it. There is no temperature. */
void imki_distort_alike(imk_kernel kernel, size_t count, const imk_axis_response *const *axes,
                        const imki_exposure *exposure, size_t chunks, double *const *out);

/* response = reading - response */
void imki_residual(imk_kernel kernel, size_t chunks, const double *reading, double *response);
/* sum += gain * residual */
void imki_add_residual(imk_kernel kernel, size_t chunks, double gain, const double *residual,
                       double *sum);
/* x = x clipped to +-limit; what is not a number stays so */
void imki_limit(imk_kernel kernel, size_t chunks, double limit, double *x);

/* The same of one instruction set. */
#define IMKI_DISTORT_LOOPS(isa)                                                                    \
    void imki_distort_chunks_##isa(const imk_axis_response *axis, const imki_exposure *exposure,   \
                                   size_t chunks, double *out);                                    \
    void imki_distort_still_##isa(const imk_axis_response *axis, const imki_exposure *exposure,    \
                                  size_t chunks, double *out);                                     \
    void imki_distort_alike_##isa(size_t count, const imk_axis_response *const *axes,              \
                                  const imki_exposure *exposure, size_t chunks,                    \
                                  double *const *out);                                             \
    void imki_residual_##isa(size_t chunks, const double *reading, double *response);              \
    void imki_add_residual_##isa(size_t chunks, double gain, const double *residual, double *sum); \
    void imki_limit_##isa(size_t chunks, double limit, double *x);
IMKI_DISTORT_LOOPS(portable)
IMKI_DISTORT_LOOPS(avx2)
IMKI_DISTORT_LOOPS(avx512)

/* The magnetometer of a model as the accelerometers of a distortion, which see the field. */
void imki_distortion_of_mag(imk_distortion *distortion, const imk_model *model,
                            const imk_run_constants *constants, imk_kernel kernel);

#endif
