/* SPDX-License-Identifier: Apache-2.0 */
/** @file navigation_smoother.h
 *  Smoothing of a filtered navigation: what readings later than an instant say of the estimate
 *  there. The filter records its updates and the points whose estimates are wanted. A pass
 *  backwards gives them.
 *
 *  The estimates are those of Rauch, Tung and Striebel, in the form of Bryson and Frazier, which
 *  needs no inverse of a covariance. Equations: docs/theory/navigation-filter.md.
 *
 *  Memory: with n states a point takes 8 (25 n + 34) bytes, an update of m rows 8 (10 n + 2 n m +
 *  34), and one at the time of the record before 8 (2 n m + 34). With 39 states that is 8 kB for a
 *  point, and 5 kB or 2 kB for an update of three rows. */
#ifndef IMUKIT_NAVIGATION_SMOOTHER_H
#define IMUKIT_NAVIGATION_SMOOTHER_H

#include "imukit/navigation_filter.h"

IMK_BEGIN_C

/** Where the memory of records comes from: it stays until the smoothing is done.
 *  @return `size` bytes, aligned for doubles; NULL: there is none, and the recording has failed */
typedef void *(*imk_smoother_room)(size_t size, void *context);

/** A recording of a filter in progress. */
typedef struct imk_navigation_smoother imk_navigation_smoother;

/** Begin to record a filter that was just started.
 *  @return NULL: there is no memory, or the filter uses the rotation of a standing unit
 *          (rotation_sigma), whose noise is not a state */
IMK_API imk_navigation_smoother *
imk_navigation_smoother_start(imk_navigation_filter *filter, imk_smoother_room room, void *context);
/** Record the present estimate as a point. @return false: memory was exhausted, now or before */
IMK_API bool imk_navigation_smoother_mark(imk_navigation_smoother *smoother);

/** Called for each point, the last one first.
 *  @param index  of the point, 0 the first that was recorded */
typedef void (*imk_smoothed_point)(void *context, size_t index,
                                   const imk_navigation_filter_estimate *estimate);
/** Go backwards through the recording. The filter must still be there, and is not changed.
 *  @return false: memory was exhausted while recording */
IMK_API bool imk_navigation_smoother_run(imk_navigation_smoother *smoother,
                                         imk_smoothed_point point, void *context);

IMK_END_C
#endif
