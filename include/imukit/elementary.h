/* SPDX-License-Identifier: Apache-2.0 */
/** @file elementary.h
 *  Elementary functions whose results have the same bits everywhere: only + - * / sqrt and
 *  rounding, no fused operations, no libm. Used wherever the bytes of a log depend on them. */
#ifndef IMUKIT_ELEMENTARY_H
#define IMUKIT_ELEMENTARY_H

#include "imukit/status.h"

IMK_BEGIN_C

/** e^x. Error below 0.7 ulp, below 1 ulp where the result is subnormal; 0 below -745.2, infinity
 *  where the result is beyond the largest double; NaN stays NaN. */
IMK_API double imk_exp(double x);

/** e^x - 1, accurate also for small x. Error below 1.1 ulp; -1 and infinity at the ends of the
 *  range; -0 and NaN stay. */
IMK_API double imk_expm1(double x);

/** Natural logarithm. Error below 0.95 ulp; -infinity at 0, NaN below. */
IMK_API double imk_ln(double x);

/** Natural logarithm of 1 + x, accurate also for small x. Error below 2 ulp; -infinity at -1, NaN
 *  below; -0 stays. */
IMK_API double imk_ln1p(double x);

/** Sine and cosine of x [rad]. Error below 0.85 ulp for |x| <= 1e5; up to 1e9 below 2 ulp or 1e-16,
 *  whichever is larger; up to 1e15 below 1e-15. NaN beyond and for infinities. */
IMK_API double imk_sin(double x);
/** Cosine of x [rad]; as imk_sin(). */
IMK_API double imk_cos(double x);

/** Angle of the point (x, y) [rad], -pi … pi, signs of zeros as in C. Error below 1 ulp. */
IMK_API double imk_atan2(double y, double x);

IMK_END_C
#endif
