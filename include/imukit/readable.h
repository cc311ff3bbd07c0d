/* SPDX-License-Identifier: Apache-2.0 */
/** @file readable.h
 *  Numbers and durations as a person reads them. Part of libimukit-io. */
#ifndef IMUKIT_READABLE_H
#define IMUKIT_READABLE_H

#include "imukit/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A value to as many decimals as two digits of its uncertainty need, or `digits` significant ones
 *  when the uncertainty is 0; "-" for no number. */
IMK_API void imk_readable_value(double value, double uncertainty, int digits, char *text,
                                size_t size);
/** "2 h 46 min 40 s", "12.5 s" */
IMK_API void imk_readable_duration(double seconds, char *text, size_t size);

#ifdef __cplusplus
}
#endif
#endif
