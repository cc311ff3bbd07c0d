/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of the laboratory: points that are run independently, and fits to their readings. */
#ifndef IMUKI_LABORATORY_INTERNAL_H
#define IMUKI_LABORATORY_INTERNAL_H

#include "imukit/distort.h"
#include "imukit/laboratory.h"

#define IMKI_PI 3.14159265358979323846

/* One run of the instrument: constant, or a sine when `frequency` is not 0. */
typedef struct imki_trial {
    imk_exposure exposure;
    double input; /* along x [rad/s or m/s^2]; the amplitude of a sine */
    double frequency;
    imk_laboratory_point reading; /* of a constant input */
    imk_laboratory_response sine; /* of a sine; gain NaN when the instrument refused the rate */
} imki_trial;

/* Run the trials, each in its own part of `states`, with noise of its own. */
void imki_trials_run(const imk_laboratory *laboratory, size_t count, imki_trial *trials,
                     char *states, const imk_executor *executor);

/* Bytes of one state. */
size_t imki_state_size(const imk_laboratory *laboratory);

/* Whole samples of this time, rounded up, at least one. */
size_t imki_samples_in(double time, double rate);

/* A constant trial with this input along x added to the surroundings. */
imki_trial imki_trial_of(const imk_laboratory *laboratory, double input);

/* Linear least squares y = A x with equal weights; sigma from the residuals, or from the readings'
 * own sigma where that is larger. @return false when the columns are dependent */
enum { IMKI_FIT_ROWS = IMK_LABORATORY_POINTS_MAX, IMKI_FIT_COLUMNS = 10 };
bool imki_fit(size_t rows, size_t columns, const double *a, const double *y, double reading_sigma,
              double *x, double *sigma);

/* 1 sigma of a reading: its own noise, or the scatter of readings without input if that is more. */
static inline double imki_reading_sigma(const imk_laboratory_result *result, double own)
{
    return own > result->zero_scatter ? own : result->zero_scatter;
}

/* laboratory_table.c: readings without input, rate table, rates across the input axis, threshold.
 */
void imki_zero_readings(const imk_laboratory *laboratory, char *states,
                        const imk_executor *executor, imk_laboratory_result *result);
void imki_rate_table(const imk_laboratory *laboratory, char *states, const imk_executor *executor,
                     imk_laboratory_result *result);
/* Response of a gyro to rates across its input axis. */
void imki_cross_rates(const imk_laboratory *laboratory, char *states, const imk_executor *executor,
                      imk_laboratory_result *result);
void imki_threshold(const imk_laboratory *laboratory, char *states, const imk_executor *executor,
                    imk_laboratory_result *result);
/* laboratory_chamber.c: tumble and temperature. */
void imki_tumble(const imk_laboratory *laboratory, const double pendulous[3], char *states,
                 const imk_executor *executor, imk_laboratory_result *result);
void imki_chamber(const imk_laboratory *laboratory, char *states, const imk_executor *executor,
                  imk_laboratory_result *result);
/* laboratory_shaker.c: frequency response. `bandwidth`: what reduce states, 0 when it does not. */
void imki_shaker(const imk_laboratory *laboratory, double bandwidth, char *states,
                 const imk_executor *executor, imk_laboratory_result *result);

#endif
