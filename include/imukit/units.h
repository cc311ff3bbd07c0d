/* SPDX-License-Identifier: Apache-2.0 */
/** @file units.h
 *  Units of measurement, checked by dimension. Everything inside imukit is SI; units are used only
 *  where text is read or written. */
#ifndef IMUKIT_UNITS_H
#define IMUKIT_UNITS_H

#include "imukit/status.h"

#include <stdbool.h>

IMK_BEGIN_C

/** Exponents of the base dimensions, in halves (so that 1/sqrt(Hz), time^{1/2}, has the number 1):
 *  metre, second, radian, kelvin, count, kilogram, ampere. Here angle is a dimension: deg/s and Hz
 *  must not be mixed, and a torsional stiffness is in N*m/rad. */
typedef struct imk_dimension {
    int8_t half[7];
} imk_dimension;

enum { IMK_METRE, IMK_SECOND, IMK_RADIAN, IMK_KELVIN, IMK_COUNT, IMK_KILOGRAM, IMK_AMPERE };

/** A unit: SI value = scale * value + offset (offset only for degC). */
typedef struct imk_unit {
    double scale;
    double offset;
    imk_dimension dimension;
    bool per_root_hertz; /**< written per sqrt(Hz): a density, which may be one- or two-sided */
    char text[48];       /**< as it was written */
} imk_unit;

/** Standard gravity, the g of mg and ug [m/s^2] (CGPM 1901). */
#define IMK_STANDARD_GRAVITY 9.80665

/** Read a unit such as deg/h, deg/sqrt(h), deg/√h, °/rt-hr, ug/sqrt(Hz), m/s/sqrt(h), m/s^1.5, mg,
 *  count/(rad/s), deg/h/g^2, ppm, %, degC, degC/min, arcsec, 1 (dimensionless).
 *
 *  `*`, `·` and `/` work from left to right, a/b/c = a/(b c); a blank multiplies, but is refused
 *  after a `/`, where it is ambiguous. Exponents are ^2, ^-1, ^0.5, ^1/2, ², ³, ½, ⁻¹ and s2; roots
 *  are sqrt(…), √, rt- and root-. Only listed multiples exist (mg is a thousandth of g, min a
 *  minute); names are case-sensitive. degC has its offset only if it stands alone: in degC/min it
 *  is a kelvin. g, mg and ug are accelerations: a mass is in kg, gram, milligram or microgram. dB
 *  refers to power: ln(10)/10 in the exponent, so dB/km is an attenuation.
 *
 *  @param begin,end  the text; blanks around it are allowed
 *  @return IMK_ERROR_UNIT_MISSING for blank text, IMK_ERROR_UNIT_UNKNOWN (error.found: the unknown
 *          part, error.expected: the nearest known spelling) or IMK_ERROR_SYNTAX (also for more
 *          than 47 bytes) */
IMK_API imk_status imk_unit_parse(const char *begin, const char *end, imk_unit *unit,
                                  imk_error *error);

/** Read a unit that is known to be valid, such as a string literal; the scale is 0 if it is not
 *  valid. */
IMK_API imk_unit imk_unit_of(const char *text);

/** True when all exponents are the same. */
IMK_API bool imk_dimension_equal(imk_dimension a, imk_dimension b);

/** Name of a dimension: "an angular rate", "a white-noise density of angular rate" …; never NULL.
 */
IMK_API const char *imk_dimension_name(imk_dimension dimension);
/** The usual units of a dimension: "deg/h, deg/s or rad/s"; never NULL. */
IMK_API const char *imk_dimension_examples(imk_dimension dimension);

/** The SI base units of a dimension as text: "rad/s", "kg*m^2/s^3".
 *  @return length, or 0 when `size` is too small */
IMK_API size_t imk_dimension_si(imk_dimension dimension, char *text, size_t size);

/** Read `number… [± sigma…] unit`, a quantity of the model file: 1 or up to max_count numbers, then
 *  optionally ± (or +-) and as many 1-sigma values (or one for all), then the unit.
 *
 *  @param expected       required dimension; IMK_ERROR_DIMENSION says what was found and what is
 *                        required. The unit may never be missing, not even for 0; a ratio has the
 *                        unit 1.
 *  @param max_count      1 … 64
 *  @param values,sigmas  max_count doubles, SI; sigmas 0 where not given. An uncertainty has no
 *                        offset: 25 ± 2 degC is 298.15 K and 2 K
 *  @param count          receives how many numbers were found
 *  @param unit           the unit found (may be NULL)
 *  @return IMK_ERROR_EMPTY, _SYNTAX, _UNIT_MISSING, _UNIT_UNKNOWN, _DIMENSION, _NOT_FINITE, _RANGE
 *          (negative uncertainty), _ARGUMENT (max_count) */
IMK_API imk_status imk_quantity_parse(const char *begin, const char *end, imk_dimension expected,
                                      size_t max_count, double *values, double *sigmas,
                                      size_t *count, imk_unit *unit, imk_error *error);

/** Read what a count of a digital sensor is, as data sheets write it: counts per unit
 *  ("16.4 LSB/(deg/s)", "2048 counts/g") or units per count ("8.75 mdps/LSB", "0.061 mg/digit").
 *  LSB, count and digit are the same; mdps is a thousandth of a degree per second.
 *
 *  @param begin,end  the text; blanks around it are allowed
 *  @param quantity   what is counted: the dimension of rad/s, m/s^2, K …
 *  @param per_count  receives the SI value of one count, above 0
 *  @return IMK_ERROR_SYNTAX (no number), _RANGE (not above 0), _UNIT_MISSING, _UNIT_UNKNOWN,
 *          _DIMENSION (error.expected: what the quantity needs) */
IMK_API imk_status imk_count_scale_parse(const char *begin, const char *end, imk_dimension quantity,
                                         double *per_count, imk_error *error);

/** Write values (and sigmas unless NULL or all 0) in a unit, the shortest decimals that read back
 *  to the same doubles; in SI base units where no decimal in `unit` does (a density per sqrt(Hz)
 *  stays one). Equal sigmas are written once. Numbers that are not finite are written in SI.
 *  @return length, or 0 when text_size is too small */
IMK_API size_t imk_quantity_format(const double *values, const double *sigmas, size_t count,
                                   const imk_unit *unit, char *text, size_t text_size);

/** Most readable of the usual units of a dimension for a magnitude (SI): "deg/h" for 5e-8 rad/s,
 *  "deg/s" for 3 rad/s. A temperature has degC from 150 K on (a reading), K below (a difference). A
 *  dimension without a name has its SI unit. */
IMK_API imk_unit imk_unit_readable(imk_dimension dimension, double magnitude);

IMK_END_C
#endif
