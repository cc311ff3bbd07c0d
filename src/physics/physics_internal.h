/* SPDX-License-Identifier: Apache-2.0 */
/* What the instruments share: constants of nature, random draws, the run's slow bias, and the
 * division of a sample into internal steps. */
#ifndef IMUKI_PHYSICS_INTERNAL_H
#define IMUKI_PHYSICS_INTERNAL_H

#include "base/refuse_internal.h"
#include "imukit/distort.h"
#include "imukit/instrument.h"
#include "imukit/noise.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#define IMKI_PI 3.14159265358979323846
#define IMKI_DEGREE (IMKI_PI / 180.0)
/* The temperature at which designs are stated, if they do not say another [K]. */
#define IMKI_DESIGN_TEMPERATURE 293.15
/* Exact by definition of the SI [SI2019]. */
#define IMKI_LIGHT_SPEED 299792458.0
#define IMKI_PLANCK 6.62607015e-34
#define IMKI_BOLTZMANN 1.380649e-23
#define IMKI_ELEMENTARY_CHARGE 1.602176634e-19
/* Vacuum permittivity [F/m], CODATA 2018. */
#define IMKI_PERMITTIVITY 8.8541878128e-12

/* End of the range of imk_exposure's angular rates [rad/s]. */
#define IMKI_EXPOSURE_RATE_MAX 1e6

/* Normals of one stream, drawn in blocks. `source` numbers the sources of randomness within an
 * instrument and is fixed for ever. Without noise every draw is 0. */
enum { IMKI_DRAWS = 256 };
typedef struct imki_draws {
    imk_random random;
    uint64_t stream, next;
    int position;
    bool silent;
    double buffer[IMKI_DRAWS];
} imki_draws;

void imki_draws_start(imki_draws *draws, const imk_physics_settings *settings, uint8_t source);
void imki_draws_fill(imki_draws *draws);

static inline double imki_draw(imki_draws *draws)
{
    if (draws->position == IMKI_DRAWS)
        imki_draws_fill(draws);
    return draws->buffer[draws->position++];
}

/* A quantity that differs from run to run and wanders within one: a constant drawn once with the
 * 1 sigma `repeatability` and flicker noise of the instability B (model.h) at the sample rate.
 * imki_wander_next() gives the value for the next sample. Of a design and settings that are valid.
 */
enum { IMKI_WANDER_BLOCK = 64 };
typedef struct imki_wander {
    double constant;
    imk_flicker_state flicker;
    bool flickers;
    int position;
    double buffer[IMKI_WANDER_BLOCK];
} imki_wander;

/* The constant by itself, of a quantity that does not wander. */
double imki_run_constant(const imk_physics_settings *settings, uint8_t source,
                         double repeatability);
void imki_wander_start(imki_wander *wander, const imk_physics_settings *settings, uint8_t source,
                       double repeatability, double instability);
void imki_wander_fill(imki_wander *wander);

static inline double imki_wander_next(imki_wander *wander)
{
    if (!wander->flickers)
        return wander->constant;
    if (wander->position == IMKI_WANDER_BLOCK)
        imki_wander_fill(wander);
    return wander->constant + wander->buffer[wander->position++];
}

static inline double imki_clamped(double x, double limit)
{
    return x > limit ? limit : x < -limit ? -limit : x;
}

/* The nearest multiple of a step; 0: no step. */
static inline double imki_quantised(double x, double step)
{
    return step > 0.0 ? step * floor(x / step + 0.5) : x;
}

#define IMKI_LENGTH(array) (sizeof(array) / sizeof((array)[0]))

/* What the description of an instrument has under the same names in every file. */
#define IMKI_DESCRIBED(kind)                                                                       \
    .name = #kind, .design_size = sizeof(imk_##kind), .field_count = IMKI_LENGTH(fields),          \
    .fields = fields, .output_count = IMKI_LENGTH(outputs), .outputs = outputs,                    \
    .signal_count = IMKI_LENGTH(signals), .signals = signals, .view_count = IMKI_LENGTH(views),    \
    .views = views, .derived = imki_##kind##_derived, .set_default = set_default, .check = check,  \
    .reduce = reduce

/* The functions of an instrument that differ in the type of the design only: they call
 * imk_NAME_default(), imki_NAME_reduce() and what imk_NAME_instrument lists. imki_NAME_derived is
 * in NAME_derived.c. */
#define IMKI_DESIGN_FUNCTIONS(name)                                                                \
    static void set_default(void *design)                                                          \
    {                                                                                              \
        *(imk_##name *)design = imk_##name##_default();                                            \
    }                                                                                              \
    static void reduce(const void *design, imk_triad *triad)                                       \
    {                                                                                              \
        imki_##name##_reduce(design, triad);                                                       \
    }                                                                                              \
    imk_status imk_##name##_validate(const imk_##name *design, imk_error *error)                   \
    {                                                                                              \
        return imk_design_check(&imk_##name##_instrument, design, error);                          \
    }                                                                                              \
    void imk_##name##_reduce(const imk_##name *design, imk_model *model)                           \
    {                                                                                              \
        imk_instrument_reduce(&imk_##name##_instrument, design, model);                            \
    }                                                                                              \
    extern const imk_instrument imk_##name##_instrument

/* Divide a sample of 1/rate into equal internal steps no longer than settings.step, or than
 * `longest` when that is 0.
 *  @param limit  a step beyond this is refused (field "step") with `reason`, the end of a message:
 *                "at least 16 steps to a cycle of the drive"
 *  @param count  steps per sample, >= 1;  *step its length [s] */
imk_status imki_divide_sample(const imk_physics_settings *settings, double longest, double limit,
                              const char *reason, size_t *count, double *step, imk_error *error);

/* A design whose numbers do not go together. */
static inline imk_status imki_conflict(imk_error *error, const char *field, double value,
                                       double limit, const char *expected)
{
    return imki_refuse(error, IMK_ERROR_CONFLICT, field, value, limit, expected);
}

/* Reference and valid range of a polynomial: 60 K to both sides, above absolute zero. */
static inline void imki_temperature_range(imk_temperature_polynomial *polynomial, double reference)
{
    polynomial->reference = reference;
    polynomial->minimum = reference > 60.0 ? reference - 60.0 : 0.0;
    polynomial->maximum = reference + 60.0;
}

/* A design whose bias is beyond the range of its reading, which would stay at its end without any
 * input, is refused: its `field`, a range in the unit of the reading. A range of 0 has no end. */
imk_status imki_check_bias(const imk_instrument *instrument, const void *design, const char *field,
                           imk_error *error);

/* A design whose fixed torque is not below the largest that its parts balance is refused: its
 * torque, unless they do not balance the torque of the default design (usual) either; then the
 * `field` to whose value the largest is proportional. */
imk_status imki_check_torque(double torque, double usual, double largest, const char *field,
                             double value, const char *expected, imk_error *error);

/* A damping as a model can have it: beyond 50 the slower of the two roots is all that is left, a
 * first-order filter (0); below 0.05 the nearest. */
static inline double imki_model_damping(double damping)
{
    return damping > 50.0 ? 0.0 : damping < 0.05 ? 0.05 : damping;
}

/* An error u that acts like an input, such as a force on the mass, with its slope per kelvin: what
 * the triad states of scale factor, K2, K3 and their temperature slopes, about no input, becomes
 * that of F(x + u), F(x) = (1 + s) x + K2 x^2 + K3 x^3.
 * @return F'(u), by which small errors of that kind show in the reading */
double imki_reduction_offset(imk_triad *triad, double u, double per_kelvin);

#endif
