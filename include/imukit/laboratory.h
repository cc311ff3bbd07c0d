/* SPDX-License-Identifier: Apache-2.0 */
/** @file laboratory.h
 *  The experiments of a test laboratory on an instrument of instrument.h. They find, from readings
 *  alone, the figures that the instrument's `reduce` computes from the design.
 *
 *      rate table       constant inputs over +-full scale, or forces for an accelerometer:
 *                       bias, scale factor, nonlinearity, asymmetry; of a gyro also the response
 *                       to rates about y and z
 *      threshold        ever smaller inputs: the smallest that gives half of its expected change
 *      tumble           specific forces of 1 g in 18 directions, and none: g- and g2-sensitivity of
 *                       a gyro, cross-axis response and cross products of an accelerometer
 *      thermal chamber  five temperatures and a ramp: bias and scale factor against temperature
 *      shaker           sines: frequency response, bandwidth
 *      static record    noise terms, by identify.h
 *
 *  Every point is a separate simulation from power-on, with its own noise and the run constants of
 *  physics.run, as for a unit that is not switched off between the points. The names of terms are
 *  those of IEEE 1293 and IEEE 528. */
#ifndef IMUKIT_LABORATORY_H
#define IMUKIT_LABORATORY_H

#include "imukit/executor.h"
#include "imukit/identify.h"
#include "imukit/instrument.h"

IMK_BEGIN_C

enum {
    IMK_LABORATORY_POINTS_MAX = 101,
    IMK_LABORATORY_FREQUENCIES_MAX = 48,
    IMK_LABORATORY_FIGURES_MAX = 40
};

/** Settings of the experiments. Start from imk_laboratory_default(), then change fields. */
typedef struct imk_laboratory {
    uint32_t cookie;
    const imk_instrument *instrument;
    const void *design;
    imk_physics_settings physics;
    imk_exposure surroundings; /**< conditions to which the input of each experiment is added */
    double full_scale;         /**< largest input [rad/s or m/s^2]; 0: 0.8 of the range that reduce
                                  states, else 1 rad/s or 10 m/s^2 */
    int points;       /**< points of the rate table, 7 … 101, odd; 0: no rate table; default 21 */
    double settle;    /**< time left out at the beginning of each point [s]; default 0.2 */
    double dwell;     /**< averaging time of each point [s]; default 1 */
    bool threshold;   /**< true */
    bool tumble;      /**< true */
    bool temperature; /**< true */
    int frequencies;  /**< frequencies of the shaker; 0: none; default 16 */
    double lowest, highest; /**< [Hz]; 0: from 1/30 to 3 times the bandwidth that reduce states,
                               else 0.01 to 0.25 times the rate */
    /** Length of the static record [s], at least 256 samples; 0: none; default 60. */
    double record;
} imk_laboratory;

/** All experiments, 21 points of 1.2 s, 16 frequencies, a record of 60 s. */
IMK_API imk_laboratory imk_laboratory_default(void);

/** One input and the reading there. */
typedef struct imk_laboratory_point {
    double input, output; /**< [rad/s or m/s^2] */
    double sigma;         /**< 1 sigma of the mean, from the scatter of 16 parts of the dwell */
} imk_laboratory_point;

/** One frequency: the response to a sine. The instrument's input is the mean of the sine over each
 *  sample, with at least 64 samples a cycle. */
typedef struct imk_laboratory_response {
    double frequency; /**< [Hz] */
    double gain;      /**< [1] */
    double phase;     /**< negative when late [rad], -pi … pi */
} imk_laboratory_response;

/** Result of the experiments. About 60 kB. */
typedef struct imk_laboratory_result {
    double full_scale;
    /** Mean of eight readings without input, and 1 sigma of one of them; slow noise makes it larger
     *  than the sigma of each reading. */
    double zero, zero_scatter;
    int point_count;
    imk_laboratory_point point[IMK_LABORATORY_POINTS_MAX];
    double line_deviation; /**< largest distance from the least-squares line, of full scale [1] */
    double threshold; /**< smallest input that gave at least half of its expected change; 0: all
                         inputs did */
    double threshold_from; /**< smallest input that noise allowed to assess */
    int response_count;
    imk_laboratory_response response[IMK_LABORATORY_FREQUENCIES_MAX];
    double bandwidth; /**< -3 dB bandwidth [Hz]; 0: above the frequencies tried */
    bool has_noise;
    imk_identification noise; /**< of the static record */
    imk_model model; /**< model of one axis, as from `reduce`: all measured values, significant or
                        not, with their sigmas */
} imk_laboratory_result;

/** Bytes of workspace. */
IMK_API size_t imk_laboratory_workspace_size(const imk_laboratory *laboratory);

/** Run the experiments.
 *  @param executor  NULL for serial; work items are single points
 *  @return the errors of the instrument's init; IMK_ERROR_RANGE (field names the setting),
 *          IMK_ERROR_WORKSPACE, IMK_ERROR_UNINITIALISED */
IMK_API imk_status imk_laboratory_run(const imk_laboratory *laboratory,
                                      const imk_executor *executor, imk_laboratory_result *result,
                                      void *workspace, size_t workspace_size, imk_error *error);

/** One parameter of a model of one axis, in a list that is the same for all models of one kind. */
typedef struct imk_laboratory_figure {
    const char *key;     /**< "scale_factor.fixed", "g_sensitivity.y"; "misalignment.y" contains the
                            cross-axis response */
    const char *si;      /**< unit of the value */
    const char *unit;    /**< unit in which it is shown */
    double value, sigma; /**< the sigma of a bias or scale factor includes its spread from run to
                            run and its instability */
} imk_laboratory_figure;

/** List the figures of axis 0 of a model, in the order of the model file, to compare `reduce` with
 *  an experiment.
 *  @return their number, the same for every model of this sensor; at most
 *          IMK_LABORATORY_FIGURES_MAX */
IMK_API size_t imk_laboratory_figures(const imk_model *model, int sensor,
                                      imk_laboratory_figure *figures);

IMK_END_C
#endif
