/* SPDX-License-Identifier: Apache-2.0 */
/** @file simulate.h
 *  Simulation: samples of an imperfect sensor unit from a model and a motion, in blocks. The bytes
 *  do not depend on how the work is divided.
 *
 *  A sample is made in this order:
 *
 *      motion (means over the sample) and temperature
 *      -> deterministic terms (distort.h), with this run's repeatabilities
 *      -> bandwidth -> + noise -> dead band -> range -> quantization of the integral
 *      -> resolution -> counts
 *
 *  Some conventions:
 *  - row k has the timestamp k/rate. It covers the interval that ends there: a motion starts at
 *    time 0 with row 0, which shows the body before the start;
 *  - samples are means. Terms that are not linear are applied to the mean of each of `substeps`
 *    parts of a sample;
 *  - the bandwidth shapes the white noise, exactly, and the deterministic signal; the slower noise
 *    terms are defined at the output, after the filter;
 *  - the dead band sets a sample within +-dead_band to 0 and does not change others;
 *  - without a temperature profile the temperature terms are zero;
 *  - timing: the sample clock is too fast by rate_error, so samples are shorter than 1/rate; each
 *    boundary between two samples has a random error `jitter` (normal); accelerometers lag the
 *    gyros by `skew`; a row is lost with the probability `drops`. Timestamps are always k/rate;
 *  - with a sensitivity the output is whole counts, round(sensitivity * x + zero_offset);
 *  - every term of every axis has its own random stream, so that changing one changes no other:
 *    axes 0-7 are gyros, 8-15 accelerometers, 16-23 magnetometers. Repeatabilities are normal 0 of
 *    the term IMK_TERM_REPEATABILITY, instance 0 the bias, 1 the scale factor;
 *  - a magnetometer sees the field, which is the same everywhere, in body axes at the middle of
 *    each part of a sample. */
#ifndef IMUKIT_SIMULATE_H
#define IMUKIT_SIMULATE_H

#include "imukit/executor.h"
#include "imukit/model.h"
#include "imukit/motion.h"
#include "imukit/random.h"

IMK_BEGIN_C

enum { IMK_SUBSTEPS_MAX = 512 };

/** Settings of a simulation. Start from imk_simulation_default(), then change fields. */
typedef struct imk_simulation {
    uint32_t cookie;
    double rate; /**< [Hz], > 0 */
    uint64_t seed;
    uint32_t run; /**< run number: each run draws other noise and other run-to-run constants from
                     the same model */
    imk_motion motion; /**< trajectory or recorded motion; if both are NULL (default), the unit is
                          at rest as follows */
    bool earth;        /**< Earth rate and gravity at the place below (default true) */
    double latitude;   /**< geodetic [rad]; default 45 deg */
    double height;     /**< above the ellipsoid [m], -1e4 … 1e5 */
    double roll, pitch, yaw; /**< attitude of the body, north-east-down [rad] */
    double field[3]; /**< magnetic flux density, north, east and down [T]. Not all 0: the channels
                        of the model's magnetometer are made, too; default 0 */
    const imk_temperature_profile *temperature; /**< of the unit, time 0 at row 0; NULL: none */
    size_t substeps; /**< parts of a sample, 1 … IMK_SUBSTEPS_MAX; 0 (default): as many as the
                        vibration needs, and 8 for a moving unit with a bandwidth */
} imk_simulation;

/** 100 Hz, seed 0, level and at rest at 45 deg north with Earth rate and gravity. */
IMK_API imk_simulation imk_simulation_default(void);

/** A running simulation. Opaque: memory of imk_simulator_size() bytes, given by the caller. */
typedef struct imk_simulator imk_simulator;

/** Bytes for a simulator of this model (which must be valid): about 15 kB a channel, 0.6 kB for
 * each Gauss-Markov term, sinusoid and resonance of it, and 1 to 10 MB for a unit that moves. */
IMK_API size_t imk_simulator_size(const imk_model *model, const imk_simulation *simulation);

/** Validate and start.
 *  @param memory  imk_simulator_size() bytes for the simulator, which needs no other memory. The
 *                 motion and the temperature profile must exist while it is used
 *  @return the errors of imk_model_validate() and of the motion; IMK_ERROR_RANGE;
 *          IMK_ERROR_CONFLICT (a recorded motion with a clock error, with another rate than its
 *          own, or with a magnetometer, because it states no attitude); IMK_ERROR_WORKSPACE */
IMK_API imk_status imk_simulator_start(const imk_model *model, const imk_simulation *simulation,
                                       imk_simulator **simulator, void *memory, size_t memory_size,
                                       imk_error *error);

/** Field of a magnetic dipole along the Earth's axis at a geodetic latitude [rad] on the ground, by
 *  the first coefficient of the geomagnetic model of 2025, 29.35 uT [IGRF14]. The true field
 *  differs by up to 20 uT.
 *  @param field  north, east (0), down [T] */
IMK_API void imk_dipole_field(double latitude, double field[3]);

/** Number of channels: gyro axes, then accelerometer axes, then those of the magnetometer if the
 *  simulation has a field. */
IMK_API size_t imk_simulator_channels(const imk_simulator *simulator);

/** Make the next `count` samples of every channel.
 *  @param columns   one array of `count` doubles per channel, SI units (or counts when the model
 *                   has a sensitivity)
 *  @param executor  NULL: serial. The bytes depend neither on it nor on how `count` is split. Its
 *                   work items are channels; threads pay off for calls of some thousand samples */
IMK_API void imk_simulator_next(imk_simulator *simulator, size_t count, double *const *columns,
                                const imk_executor *executor);

/** True time at the end of row `row`, from the start of the motion [s]; row -1 stands for the
 *  beginning of row 0. It is row/rate apart from timing errors. */
IMK_API double imk_simulator_true_time(const imk_simulator *simulator, int64_t row);

/** True when row `row` is lost (timing.drops). */
IMK_API bool imk_simulator_dropped(const imk_simulator *simulator, uint64_t row);

IMK_END_C
#endif
