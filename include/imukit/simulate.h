/* SPDX-License-Identifier: Apache-2.0 */
/** @file simulate.h
 *  Model -> samples: a static log of an imperfect sensor, in blocks, the same bytes however the
 *  work is divided. */
#ifndef IMUKIT_SIMULATE_H
#define IMUKIT_SIMULATE_H

#include "imukit/executor.h"
#include "imukit/model.h"
#include "imukit/random.h"

#ifdef __cplusplus
extern "C" {
#endif

/** What to simulate. Start from imk_simulation_default(), then change fields. */
typedef struct imk_simulation {
    uint32_t cookie;
    double rate; /**< [Hz], > 0 */
    uint64_t seed;
    uint32_t run;    /**< run number: another draw of the same model, other run-to-run constants */
    bool earth;      /**< Earth rate and gravity at the place below (default true) */
    double latitude; /**< geodetic [rad]; default 45 deg */
    double height;   /**< above the ellipsoid [m] */
    double roll, pitch, yaw; /**< attitude of the body, north-east-down [rad] */
} imk_simulation;

IMK_API imk_simulation imk_simulation_default(void);

/** True angular rate [rad/s] and specific force [m/s^2] of a body at rest, in body axes. Without
 *  `earth` both are zero. Gravity by WGS84 (Somigliana and height) [NIMA-TR8350.2]. */
IMK_API void imk_simulation_truth(const imk_simulation *simulation, double angular_rate[3],
                                  double specific_force[3]);

/** A running simulation. Opaque: memory of imk_simulator_size() bytes, given by the caller. */
typedef struct imk_simulator imk_simulator;

IMK_API size_t imk_simulator_size(const imk_model *model);

/** Validate and start.
 *  @param memory  imk_simulator_size() bytes, 64-byte aligned; owns nothing else
 *  @return IMK_ERROR_UNSUPPORTED (field names the term) for a model this version cannot simulate
 *          exactly; the errors of imk_model_validate(); IMK_ERROR_RANGE; IMK_ERROR_WORKSPACE */
IMK_API imk_status imk_simulator_start(void *memory, size_t size, const imk_model *model,
                                       const imk_simulation *simulation, imk_simulator **simulator,
                                       imk_error *error);

/** Channels it makes: gyro axes, then accelerometer axes. */
IMK_API size_t imk_simulator_channels(const imk_simulator *simulator);

/** The next `count` samples of every channel.
 *  @param columns  one array of `count` doubles per channel, SI units (or counts when the model
 *                  has a sensitivity)
 *  @param executor NULL for serial; the bytes do not depend on it nor on how `count` is split */
IMK_API void imk_simulator_next(imk_simulator *simulator, size_t count, double *const *columns,
                                const imk_executor *executor);

#ifdef __cplusplus
}
#endif
#endif
