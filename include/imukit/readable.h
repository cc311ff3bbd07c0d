/* SPDX-License-Identifier: Apache-2.0 */
/** @file readable.h
 *  Numbers, durations and figures of drift as a person reads them. Part of libimukit-io. */
#ifndef IMUKIT_READABLE_H
#define IMUKIT_READABLE_H

#include "imukit/drift.h"
#include "imukit/units.h"

IMK_BEGIN_C

/** A value to as many decimals as two digits of its uncertainty need, or `digits` significant ones
 *  when the uncertainty is 0; "-" for no number. */
IMK_API void imk_readable_value(double value, double uncertainty, int digits, char *text,
                                size_t size);
/** "2 h 46 min 40 s", "12.5 s" */
IMK_API void imk_readable_duration(double seconds, char *text, size_t size);

enum { IMK_READABLE_SIZE = 40 };
/** Three digits; "-" for no number. @return text, as the two below */
IMK_API const char *imk_readable_number(double value, char text[IMK_READABLE_SIZE]);
/** "1.2 nmi": an SI value in a unit. */
IMK_API const char *imk_readable_quantity(double value, const imk_unit *unit,
                                          char text[IMK_READABLE_SIZE]);
/** The unit a person reads a figure of this size in: m, km, m/s, arcsec, arcmin, deg. */
IMK_API imk_unit imk_readable_figure_unit(imk_drift_requirement figure, double value);
/** "1.2 km": a figure in it. */
IMK_API const char *imk_readable_figure(imk_drift_requirement figure, double value,
                                        char text[IMK_READABLE_SIZE]);

IMK_END_C
#endif
