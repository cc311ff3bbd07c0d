/* SPDX-License-Identifier: Apache-2.0 */
/** @file test_record.h
 *  A log of a bench test in memory, the input of calibration and evaluation. */
#ifndef IMUKIT_TEST_RECORD_H
#define IMUKIT_TEST_RECORD_H

#include "imukit/distort.h"

IMK_BEGIN_C

/** The samples of one log. The arrays belong to the caller. Sample k is the mean over the interval
 *  that ends at its time. All values are SI, but readings are in counts if the unit outputs counts.
 */
typedef struct imk_test_record {
    const char *name; /**< name of the log, for messages */
    size_t count;
    double dt;          /**< usual sample interval [s] */
    const double *time; /**< increasing [s]; NULL: k dt. A step above 1.5 dt is a gap */
    int axis_count[2];  /**< of gyros, of accelerometers; 0: the log has none */
    const double *reading[2][IMK_AXES_MAX]; /**< NaN: missing */
    bool counts[2];                         /**< readings are counts */
    const double *temperature;              /**< [K]; NULL: not known */
    /** Reference motion of the body, from the table, the dividing head or the programme: means over
     *  the samples, nominal body axes; rate in inertial space [rad/s], specific force, gravity
     *  included [m/s^2]. NULL: not known. */
    const double *reference_rate[3], *reference_force[3];
    bool reference_on_ground; /**< reference_rate is relative to the ground, as a table tells it:
                                 the Earth's rate is not in it */
    const double *reference_acceleration[3]; /**< angular [rad/s^2]; NULL: zero */
    const int *section; /**< per sample: index of the label of a section, -1: none; NULL: none */
    size_t section_count;
    const char *const *section_name; /**< section_count names */
    /** Each row is the mean over a pose at rest, not a sample: rows do not follow each other in
     *  time. `time` is NULL and `dt` any number above 0. Taken by multiposition (without turns),
     *  sixposition and tumble. */
    bool means;
    const double *mean_sigma[2][IMK_AXES_MAX]; /**< with `means`: 1 sigma of each mean, as the
                                                    readings; > 0 */
    const double *mag[3]; /**< magnetometer [T], NaN: missing; all NULL: the log has none */
} imk_test_record;

IMK_END_C
#endif
