/* SPDX-License-Identifier: Apache-2.0 */
/** @file sensor.h
 *  A sensor that is stepped: for a simulation of a robot or a vehicle, which knows the true motion
 *  of a sample only when it has computed it. One sensor, or thousands of one model side by side.
 *
 *  A step takes the true motion of one sample and gives its readings. They are, byte for byte,
 *  those that simulate.h gives for the same model, seed and run with these samples as a recorded
 *  motion; so all that is said there about the order in which a sample is made holds here, too.
 *
 *  What is true of a sample k, in body axes, is what simulate.h takes of a recorded motion:
 *  - the means of angular rate and specific force over the interval (k-1)/rate … k/rate, not the
 *    values at an instant. The specific force is acceleration less gravity: a sensor at rest reads
 *    +9.8 m/s^2 upwards;
 *  - the angular acceleration, which only accelerometers with a lever arm need;
 *  - temperature and its rate in the middle of the interval. Step 0 ends at time 0 (power-on), so
 *    its middle is at -1/(2 rate).
 *
 *  The clock of a sensor that is stepped is that of its caller. Models with timing.rate_error,
 *  timing.jitter or timing.skew, which move samples in time, are refused; imk_sensor_dropped() says
 *  which rows timing.drops loses. A magnetometer of the model is not simulated.
 *
 *  If a truth is not finite, the readings that depend on it are NaN in this step. Nothing of it
 *  stays: the filter of the bandwidth begins anew with the next finite input, as at the start; the
 *  sample adds nothing to the integral that is quantized; hysteresis leaves out the temperature;
 *  noise goes on as always.
 *
 *  Noise is made 512 samples ahead, so one step in 512 takes longer: about 30 us for a sensor. Many
 *  sensors take turns, 32 at a time; the first samples are made at the start.
 */
#ifndef IMUKIT_SENSOR_H
#define IMUKIT_SENSOR_H

#include "imukit/distort.h"

IMK_BEGIN_C

/** Settings of a sensor. Start from imk_sensor_default(), then change fields. */
typedef struct imk_sensor_settings {
    uint32_t cookie;
    double rate; /**< of its samples [Hz], 1e-9 … 1e12 */
    uint64_t seed;
    uint32_t run;     /**< run number, as in imk_simulation */
    size_t count;     /**< sensors side by side, >= 1. Number i is, byte for byte, the one sensor of
                         run number run + i, which must be below 2^32 */
    bool temperature; /**< the truth has a temperature; else the terms of the temperature are 0, as
                         in a simulation without a profile */
} imk_sensor_settings;

/** One sensor at 100 Hz, seed 0, run 0, without a temperature. */
IMK_API imk_sensor_settings imk_sensor_default(void);

/** What is true of a sample, body axes. */
typedef struct imk_sensor_truth {
    double angular_rate[3];         /**< mean over the interval, in inertial space [rad/s] */
    double specific_force[3];       /**< mean, at the reference point of the body [m/s^2] */
    double angular_acceleration[3]; /**< [rad/s^2] */
    double temperature;             /**< in the middle of the interval [K] */
    double temperature_rate;        /**< [K/s] */
} imk_sensor_truth;

/** One sensor or several. Opaque: memory of imk_sensor_size() bytes, given by the caller. */
typedef struct imk_sensor imk_sensor;

/** Bytes for the sensors of these settings, of a model that must be valid: for each about 4 kB an
 *  axis (4.6 kB of more than 32), 5 kB more with flicker noise, and 0.3 kB for each Gauss-Markov
 *  term, 0.6 kB for each sinusoid. Behind the first, noise is made for eight at a time, so that two
 *  need two and a half times as much for each as one or eight. 0 if `count` is 0 or this machine
 *  cannot address them. */
IMK_API size_t imk_sensor_size(const imk_model *model, const imk_sensor_settings *settings);

/** Validate and start.
 *  @param memory  imk_sensor_size() bytes, of any alignment; the sensor needs no other memory
 *  @return the errors of imk_model_validate(); IMK_ERROR_ARGUMENT (a NULL pointer);
 *          IMK_ERROR_UNINITIALISED (settings); IMK_ERROR_RANGE, IMK_ERROR_NOT_FINITE (rate, count,
 *          a noise term that does not fit the rate); IMK_ERROR_CONFLICT (timing.rate_error,
 *          timing.jitter or timing.skew is not 0); IMK_ERROR_WORKSPACE */
IMK_API imk_status imk_sensor_start(const imk_model *model, const imk_sensor_settings *settings,
                                    imk_sensor **sensor, void *memory, size_t memory_size,
                                    imk_error *error);

/** Channels of a sensor: gyro axes, then accelerometer axes. */
IMK_API size_t imk_sensor_channels(const imk_sensor *sensor);

/** The next sample of every sensor, when all see the same motion.
 *  @param readings  channels x count: channel c of sensor i is readings[c * count + i], in SI units
 *                   (or counts when the model has a sensitivity)
 *  @return IMK_ERROR_NOT_FINITE if a reading is not finite because a truth is not, or is too large;
 *          IMK_ERROR_ARGUMENT (a NULL pointer), without a step */
IMK_API imk_status imk_sensor_step(imk_sensor *sensor, const imk_sensor_truth *truth,
                                   double *readings);

/** The next sample of every sensor, when each has a motion of its own.
 *  @param truth     arrays of `count` numbers, one for each sensor; NULL for a quantity that is 0.
 *                   With settings.temperature there are a temperature and its rate. `warm_up` and
 *                   `hysteresis` are not read: the sensors have their own
 *  @param readings  as of imk_sensor_step(); not to overlap the truth
 *  @return as imk_sensor_step() */
IMK_API imk_status imk_sensor_step_each(imk_sensor *sensor, const imk_stimulus *truth,
                                        double *readings);

/** True when row `row` of sensor `number` is lost (timing.drops): step as always, and leave out the
 *  readings. */
IMK_API bool imk_sensor_dropped(const imk_sensor *sensor, size_t number, uint64_t row);

IMK_END_C
#endif
