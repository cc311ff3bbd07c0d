/* SPDX-License-Identifier: Apache-2.0 */
/** @file readable.h
 *  Numbers, durations and figures of drift as text that a person reads easily. Part of
 *  libimukit-io. */
#ifndef IMUKIT_READABLE_H
#define IMUKIT_READABLE_H

#include "imukit/drift.h"
#include "imukit/units.h"

IMK_BEGIN_C

/** Write a value with the decimals of two digits of its uncertainty, or with `digits` significant
 *  digits when the uncertainty is 0; "-" for NaN. */
IMK_API void imk_readable_value(double value, double uncertainty, int digits, char *text,
                                size_t size);
/** Write a duration: "2 h 46 min 40 s", "12.5 s". */
IMK_API void imk_readable_duration(double seconds, char *text, size_t size);

enum { IMK_READABLE_SIZE = 40 };
/** Write a number with three digits; "-" for NaN. This function and the two similar ones below
 *  return `text`. */
IMK_API const char *imk_readable_number(double value, char text[IMK_READABLE_SIZE]);
/** Write an SI value in a unit: "1.2 nmi". */
IMK_API const char *imk_readable_quantity(double value, const imk_unit *unit,
                                          char text[IMK_READABLE_SIZE]);
/** Readable unit for a figure of this size: m, km, m/s, arcsec, arcmin or deg. */
IMK_API imk_unit imk_readable_figure_unit(imk_drift_requirement figure, double value);
/** Write a figure in its readable unit: "1.2 km". */
IMK_API const char *imk_readable_figure(imk_drift_requirement figure, double value,
                                        char text[IMK_READABLE_SIZE]);

IMK_END_C
#endif
