/* SPDX-License-Identifier: Apache-2.0 */
/** @file laboratory.h
 *  The experiments of a test laboratory on an instrument of instrument.h. They find, from readings
 *  alone, the figures that the instrument's `reduce` computes from the design, and tell whether the
 *  two agree.
 *
 *      power cycles     readings without input, and at plus and minus a quarter of full scale: bias
 *                       and scale factor, with their spread from run to run
 *      rate table       constant inputs over +-full scale, or forces for an accelerometer:
 *                       nonlinearity, asymmetry; of a gyro also the response to rates about y and z
 *      threshold        ever smaller inputs: the smallest that gives half of its expected change
 *      tumble           specific forces of 1 g in 18 directions, and none: g- and g2-sensitivity of
 *                       a gyro, cross-axis response and cross products of an accelerometer
 *      thermal chamber  five temperatures and a ramp: bias and scale factor against temperature
 *      shaker           sines: frequency response, bandwidth
 *      static record    noise terms, by identify.h
 *
 *  It is a laboratory of numbers. Each experiment is done in several power cycles, and within a
 *  cycle every point is a simulation from power-on with the same constants of the run and the same
 *  noise, so what an input changes is seen without the noise that both readings have. What is
 *  compared is the physics and not what a bench can show. Sigmas are from the scatter between the
 *  cycles, or from how far the readings are from the law that is fitted, whichever is larger. The
 *  names of terms are those of IEEE 1293 and IEEE 528.
 *
 *  Lengths are chosen from what is there to find. An experiment is repeated, or the record made
 *  longer, until the sigma of each figure is at most 0.06 of the size that matters, if that is
 *  possible within `longest`. The size that matters is the closed form's value, or what the reading
 *  itself changes from run to run if that is more: the repeatability of the bias (the bias
 *  instability of an instrument that states none) together with that of the scale factor at the
 *  input where the term acts: full scale, 1 g, 20 K, 0.01 K/s, and for noise a mean over one hour.
 */
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
    imk_physics_settings physics; /**< power cycle k of the experiments is run 4096 run + k */
    imk_exposure surroundings;    /**< conditions to which the input of each experiment is added */
    double full_scale; /**< largest input [rad/s or m/s^2]; 0: 0.8 of the range that reduce
                          states, else 1 rad/s or 10 m/s^2 */
    int points;       /**< points of the rate table, 7 … 101, odd; 0: no rate table; default 21 */
    int cycles;       /**< power cycles of every experiment, 3 … 255; default 6 */
    double settle;    /**< time left out at the beginning of each point [s]; negative (default):
                         twice the time after which a pilot run no
                         longer changes, at most 6.2 s */
    double dwell;     /**< averaging time of each point [s], longer where the integral is read with
                         an error; default 0.16 */
    bool threshold;   /**< true */
    bool tumble;      /**< true */
    bool temperature; /**< true */
    int frequencies;  /**< frequencies of the shaker; 0: none; default 16 */
    double lowest, highest; /**< [Hz]; 0: from 1/30 to 3 times the bandwidth that reduce states,
                               else 0.01 to 0.25 times the rate */
    /** Length of the static record [s], at least 256 samples; 0: none; negative (default): as the
     *  noise terms need, up to 2^19 samples, at a lower rate where they need longer. */
    double record;
    /** Simulated time that one experiment may take, so that a figure is told [s]; 0 (default): what
     *  takes about 4 s to compute on one core, 6 s at the slow level, estimated from the number and
     *  length of the internal steps. What cannot be told within it is not tried. */
    double longest;
    /** true (default): power cycles, static record and what would take too long otherwise are at
     * the slow level, if there is one. */
    bool quick;
    /** Called between points, never by two threads at once; false stops the experiments. NULL: not
     *  called. @param done,total  points of the stage */
    bool (*progress)(void *context, const char *stage, uint64_t done, uint64_t total);
    void *progress_context;
} imk_laboratory;

/** All experiments, 21 points, 6 power cycles, 16 frequencies. */
IMK_API imk_laboratory imk_laboratory_default(void);

/** One input and the reading there: means over the power cycles. */
typedef struct imk_laboratory_point {
    double input, output; /**< [rad/s or m/s^2] */
    double sigma;         /**< 1 sigma of the mean */
    double error;         /**< output less input and less the reading without input */
    double error_sigma;
    double computed; /**< the error by the closed forms */
} imk_laboratory_point;

/** One direction of 1 g, and what it changes in the reading beyond the force itself. */
typedef struct imk_laboratory_pose {
    double force[3]; /**< [m/s^2] */
    double error, sigma, computed;
} imk_laboratory_pose;

/** One temperature: bias and scale factor less those at the middle temperature. */
typedef struct imk_laboratory_warmth {
    double temperature; /**< [K] */
    double bias, bias_sigma, bias_computed;
    double scale, scale_sigma, scale_computed; /**< [1] */
} imk_laboratory_warmth;

/** One frequency: the response to a sine. The instrument's input is the mean of the sine over each
 *  sample, with at least 64 samples a cycle. */
typedef struct imk_laboratory_response {
    double frequency; /**< [Hz] */
    double gain;      /**< [1] */
    double phase;     /**< negative when late [rad], -pi … pi */
} imk_laboratory_response;

/** How a figure was measured. */
typedef struct imk_laboratory_effort {
    double freedom; /**< degrees of freedom of the sigma; infinite for noise */
    double seconds; /**< simulated time of its experiment [s]; 0: not measured */
    /** Simulated time at which its sigma would be 0.06 of what matters [s]; infinite: no length
     *  suffices, and `limit` says why. */
    double needs;
    const char *limit; /**< "higher orders of the input"; NULL: noise */
} imk_laboratory_effort;

enum { IMK_LABORATORY_POSES = 19, IMK_LABORATORY_TEMPERATURES = 5 };

/** Result of the experiments. About 70 kB. */
typedef struct imk_laboratory_result {
    double full_scale;
    /** Mean of the readings without input over the power cycles, and 1 sigma of one of them. */
    double zero, zero_scatter;
    int point_count;
    imk_laboratory_point point[IMK_LABORATORY_POINTS_MAX];
    double line_deviation; /**< largest distance from the least-squares line, of full scale [1] */
    double threshold; /**< smallest input that gave at least half of its expected change; 0: all
                         inputs did */
    double threshold_from; /**< smallest input that noise allowed to assess */
    int pose_count;
    imk_laboratory_pose pose[IMK_LABORATORY_POSES];
    int warmth_count;
    imk_laboratory_warmth warmth[IMK_LABORATORY_TEMPERATURES];
    int response_count;
    imk_laboratory_response response[IMK_LABORATORY_FREQUENCIES_MAX];
    double bandwidth; /**< -3 dB bandwidth [Hz]; 0: above the frequencies tried */
    bool has_noise;
    imk_identification noise; /**< of the static record, at the rate of the instrument */
    imk_model model; /**< model of one axis, as from `reduce`: all measured values, significant or
                        not, with their sigmas */
    size_t figure_count;
    imk_laboratory_effort effort[IMK_LABORATORY_FIGURES_MAX]; /**< of imk_laboratory_figures() */
    double matters[IMK_LABORATORY_FIGURES_MAX];               /**< the size that matters of each */
} imk_laboratory_result;

/** Bytes of workspace. */
IMK_API size_t imk_laboratory_workspace_size(const imk_laboratory *laboratory);

/** Run the experiments.
 *  @param executor  NULL for serial; work items are single points
 *  @return the errors of the instrument's init; IMK_ERROR_RANGE (field names the setting),
 *          IMK_ERROR_WORKSPACE, IMK_ERROR_UNINITIALISED, IMK_ERROR_CANCELLED */
IMK_API imk_status imk_laboratory_run(const imk_laboratory *laboratory,
                                      const imk_executor *executor, imk_laboratory_result *result,
                                      void *workspace, size_t workspace_size, imk_error *error);

/** One parameter of a model of one axis, in a list that is the same for all models of one kind. */
typedef struct imk_laboratory_figure {
    const char *key;  /**< "scale_factor.fixed", "g_sensitivity.y"; "misalignment.y" contains the
                         cross-axis response */
    const char *si;   /**< unit of the value */
    const char *unit; /**< unit in which it is shown */
    double value, sigma;
} imk_laboratory_figure;

/** List the figures of axis 0 of a model, in the order of the model file, to compare `reduce` with
 *  an experiment.
 *  @return their number, the same for every model of this sensor; at most
 *          IMK_LABORATORY_FIGURES_MAX */
IMK_API size_t imk_laboratory_figures(const imk_model *model, int sensor,
                                      imk_laboratory_figure *figures);

/** What a comparison says. */
typedef enum imk_laboratory_verdict {
    /** No difference that matters: |difference| + 3 sigma is at most 0.3 of the size that matters,
     *  and the difference is within chance, or 1 % of that size. A closed form that is wrong by
     *  half of its value is called this in less than 1 % of the cases, whatever the noise. */
    IMK_LABORATORY_AGREES = 0,
    /** The difference is beyond chance, but within a tenth of the size that matters. */
    IMK_LABORATORY_CLOSE,
    /** It is beyond chance and larger. False alarms: one figure in 10000. */
    IMK_LABORATORY_DIFFERS,
    IMK_LABORATORY_CANNOT_TELL, /**< within chance, but the experiment could not show what matters
                                 */
    IMK_LABORATORY_NOT_MEASURED
} imk_laboratory_verdict;

/** "agrees", "close", "differs", "cannot tell" or "not measured". */
IMK_API const char *imk_laboratory_verdict_text(imk_laboratory_verdict verdict);

/** Compare a figure by closed forms with the one that was measured.
 *  @param matters  the size that matters [unit of the figures] */
IMK_API imk_laboratory_verdict imk_laboratory_compare(const imk_laboratory_figure *computed,
                                                      const imk_laboratory_figure *found,
                                                      double matters,
                                                      const imk_laboratory_effort *effort);

IMK_END_C
#endif
