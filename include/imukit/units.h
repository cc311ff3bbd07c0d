/* SPDX-License-Identifier: Apache-2.0 */
/** @file units.h
 *  Units of measurement, checked by dimension. Everything inside imukit is SI; units exist where
 *  text comes in or goes out. */
#ifndef IMUKIT_UNITS_H
#define IMUKIT_UNITS_H

#include "imukit/status.h"

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Exponents of the base dimensions, in halves (so that 1/sqrt(Hz) is time^{+1}): metre, second,
 *  radian, kelvin, count. The angle is a dimension here: deg/s and Hz must not be mixed. */
typedef struct imk_dimension {
    int8_t half[5];
} imk_dimension;

enum { IMK_METRE, IMK_SECOND, IMK_RADIAN, IMK_KELVIN, IMK_COUNT };

/** A unit: SI value = scale * value + offset (offset only for degC). */
typedef struct imk_unit {
    double scale;
    double offset;
    imk_dimension dimension;
    bool per_root_hertz; /**< written per sqrt(Hz): a density that needs one-/two-sided said */
    char text[48];       /**< as it was written */
} imk_unit;

/** Standard gravity, the g of mg and ug [m/s^2] (CGPM 1901). */
#define IMK_STANDARD_GRAVITY 9.80665

/** Read a unit such as deg/h, deg/sqrt(h), deg/√h, °/rt-hr, ug/sqrt(Hz), m/s/sqrt(h), m/s^1.5, mg,
 *  count/(rad/s), deg/h/g^2, ppm, %, degC, degC/min, arcsec, 1 (dimensionless).
 *
 *  @param begin,end  the text, blanks around it allowed
 *  @return IMK_ERROR_UNIT_MISSING for blank text, IMK_ERROR_UNIT_UNKNOWN (error.found is the part
 *          not known, error.expected the nearest known spelling) or IMK_ERROR_SYNTAX */
IMK_API imk_status imk_unit_parse(const char *begin, const char *end, imk_unit *unit,
                                  imk_error *error);

/** Read a unit known to be right, in a string literal of the caller; scale 0 if it is not. */
IMK_API imk_unit imk_unit_of(const char *text);

IMK_API bool imk_dimension_equal(imk_dimension a, imk_dimension b);

/** What a dimension is called: "an angular rate", "a white-noise density of angular rate", … and
 *  the usual units for it: "deg/h, deg/s or rad/s". Both are never NULL. */
IMK_API const char *imk_dimension_name(imk_dimension dimension);
IMK_API const char *imk_dimension_examples(imk_dimension dimension);

/** Read `number… [± sigma…] unit`, a quantity of the model file: 1 or up to max_count numbers, then
 *  optionally ± (or +-) and as many 1-sigma values (or one for all), then the unit.
 *
 *  @param expected  dimension due; IMK_ERROR_DIMENSION says what was found and what is due.
 *                   A unit may be missing only when every number is 0 and zero_without_unit is set.
 *  @param values,sigmas  max_count doubles, SI; sigmas 0 where not given
 *  @param count     how many numbers stood there
 *  @param unit      the unit found (may be NULL) */
IMK_API imk_status imk_quantity_parse(const char *begin, const char *end, imk_dimension expected,
                                      size_t max_count, double *values, double *sigmas,
                                      size_t *count, imk_unit *unit, imk_error *error);

/** Write values (and sigmas unless NULL or all 0) in a unit, the shortest decimals that read back
 *  to the same doubles; in SI base units where no decimal in `unit` does.
 *  @return length, or 0 when text_size is too small */
IMK_API size_t imk_quantity_format(const double *values, const double *sigmas, size_t count,
                                   const imk_unit *unit, char *text, size_t text_size);

/** Best-readable unit among the usual ones of a dimension for a typical magnitude (SI): for 5e-8
 *  rad/s "deg/h", for 3 rad/s "deg/s". */
IMK_API imk_unit imk_unit_readable(imk_dimension dimension, double magnitude);

#ifdef __cplusplus
}
#endif
#endif
