/* SPDX-License-Identifier: Apache-2.0 */
/** @file axes_mending.h
 *  Which wrong signs and exchanged axes of a log look alike.
 *
 *  A log of rests and turns compares the gyros with the accelerometers: the turn C of the rates w
 *  carries the force f of one rest to that of the next. If the gyros are read as Q w and the
 *  accelerometers as S f, with signed permutations Q and S, the comparison is the same for R Q and
 *  ±R S, R any of the 24 permutations that are rotations: C(R w) = R C(w) R^T. So the 48 x 48 pairs
 *  (Q, S) make 48 classes of 48 that no such log tells apart. Each class has one pair with S = 1,
 *  and is named by its Q. What is in the class of Q = S = 1 looks sound: all axes renamed by a
 *  rotation, and all accelerometers inverted. Method: docs/theory/calibration.md. */
#ifndef IMUKIT_AXES_MENDING_H
#define IMUKIT_AXES_MENDING_H

#include "imukit/status.h"

#include <stddef.h>
#include <stdint.h>

IMK_BEGIN_C

enum { IMK_SIGNED_AXES = 48, IMK_AXES_MENDINGS_MAX = 8 };

/** A signed permutation: axis i should be sign[i] times what the log calls axis column[i]. */
typedef struct imk_signed_axes {
    int column[3], sign[3]; /**< 0 to 2; -1 or 1 */
    int determinant;        /**< 1: a rotation, -1: a mirror */
} imk_signed_axes;

/** Signed permutation number `index`, 0 to 47; 0 changes nothing, any other number is taken as 0.
 */
IMK_API imk_signed_axes imk_signed_axes_of(int index);

/** One way to mend a log. */
typedef struct imk_axes_mending {
    imk_signed_axes of[2]; /**< of gyros, of accelerometers */
    int mistakes[2];       /**< inverted axes and exchanges in each of them */
} imk_axes_mending;

/** The simplest ways to mend a log, the simplest first: all with the fewest mistakes, and those
 *  that change one sensor only, by signs alone or with at most one mistake more.
 *  @param classes  bit k: signed permutation k of the gyros alone explains the turns; bits above 47
 *                  are ignored
 *  @param mending  room for IMK_AXES_MENDINGS_MAX
 *  @return their number; 0: no class, or the log looks sound in one of them */
IMK_API size_t imk_axes_mendings(uint64_t classes, imk_axes_mending mending[IMK_AXES_MENDINGS_MAX]);

IMK_END_C
#endif
