/* SPDX-License-Identifier: Apache-2.0 */
/** @file simulate.h
 *  Model -> samples: a static log of an imperfect sensor, in blocks, the same bytes however the
 *  work is divided.
 *
 *  Each channel is a constant (the response of the deterministic terms to the Earth's rate and
 *  gravity, with biases and scale factors drawn for this run) plus its stochastic terms, then the
 *  output stage: range, quantization of the integral, resolution, counts. Some conventions:
 *   - the bandwidth shapes the white noise, exactly; the other terms are taken as they appear in
 *     the output, behind the filter;
 *   - the log has a constant temperature: temperature-rate terms vanish, and terms that depend on
 *     which temperature it is are refused;
 *   - with a sensitivity the output is whole counts, round(sensitivity * x + zero_offset);
 *   - every term of every axis has its own random stream, so that changing one changes no other:
 *     axes 0-7 are gyros, 8-15 accelerometers. Repeatabilities are normal 0 of the term
 *     IMK_TERM_REPEATABILITY, instance 0 the bias, 1 the scale factor. */
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
    double height;   /**< above the ellipsoid [m], -1e4 … 1e5 */
    double roll, pitch, yaw; /**< attitude of the body, north-east-down [rad] */
} imk_simulation;

/** 100 Hz, seed 0, level and at rest at 45 deg north with Earth rate and gravity. */
IMK_API imk_simulation imk_simulation_default(void);

/** True angular rate [rad/s] and specific force [m/s^2] of a body at rest, in body axes. Without
 *  `earth` both are zero. Gravity by WGS84 (Somigliana and height) [NIMA-TR8350.2]. */
IMK_API void imk_simulation_truth(const imk_simulation *simulation, double angular_rate[3],
                                  double specific_force[3]);

/** A running simulation. Opaque: memory of imk_simulator_size() bytes, given by the caller. */
typedef struct imk_simulator imk_simulator;

/** Bytes for a simulator of this model (which must be valid): about 35 kB a channel and 4 kB for
 *  each Gauss-Markov term, sinusoid and resonance of it. */
IMK_API size_t imk_simulator_size(const imk_model *model);

/** Validate and start.
 *  @param memory  imk_simulator_size() bytes, 64-byte aligned; owns nothing else
 *  @return IMK_ERROR_UNSUPPORTED (field names the term) for a model this version cannot simulate
 *          exactly; the errors of imk_model_validate(); IMK_ERROR_RANGE; IMK_ERROR_WORKSPACE */
IMK_API imk_status imk_simulator_start(void *memory, size_t size, const imk_model *model,
                                       const imk_simulation *simulation, imk_simulator **simulator,
                                       imk_error *error);

/** Constant part of channel `channel` in this run, before the output stage [unit]. */
IMK_API double imk_simulator_constant(const imk_simulator *simulator, size_t channel);

/** Channels it makes: gyro axes, then accelerometer axes. */
IMK_API size_t imk_simulator_channels(const imk_simulator *simulator);

/** The next `count` samples of every channel.
 *  @param columns  one array of `count` doubles per channel, SI units (or counts when the model
 *                  has a sensitivity)
 *  @param executor NULL for serial; the bytes do not depend on it nor on how `count` is split. Its
 *                  work items are channels; calls of some thousand samples are worth threads */
IMK_API void imk_simulator_next(imk_simulator *simulator, size_t count, double *const *columns,
                                const imk_executor *executor);

#ifdef __cplusplus
}
#endif
#endif
