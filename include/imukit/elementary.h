/* SPDX-License-Identifier: Apache-2.0 */
/** @file elementary.h
 *  Elementary functions whose results have the same bits everywhere: only + - * / sqrt and
 *  rounding, no fused operations, no libm. Used wherever the bytes of a log depend on them. */
#ifndef IMUKIT_ELEMENTARY_H
#define IMUKIT_ELEMENTARY_H

#include "imukit/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/** e^x. Error below 1 ulp; 0 and infinity at the ends of the range; NaN stays NaN. */
IMK_API double imk_exp(double x);

/** e^x - 1, accurate also for small x. Error below 2 ulp. */
IMK_API double imk_expm1(double x);

/** Natural logarithm. Error below 1 ulp; -infinity at 0, NaN below. */
IMK_API double imk_log(double x);

/** Sine and cosine of x [rad]. Error below 1 ulp for |x| <= 1e5 (and below 2 ulp of the result or
 *  1e-16 absolute, whichever is larger, up to 1e9); NaN beyond 1e15 and for infinities. */
IMK_API double imk_sin(double x);
IMK_API double imk_cos(double x);

#ifdef __cplusplus
}
#endif
#endif
