/* SPDX-License-Identifier: Apache-2.0 */
/** @file procedure.h
 *  The procedures of a test laboratory. Each analyses a log, adds its observations to a
 *  calibration, and makes the parameters free that these can determine. Names of terms are as in
 *  IEEE 1293 and IEEE 528. docs/calibrate.md tells how to do each test.
 *
 *      multiposition  any attitudes at rest, turned by hand between: |force| = gravity, and the
 *                     gyros must carry the vertical from pose to pose. No turntable
 *      sixposition    each axis up and down on a level plate: attitudes known, with or without
 *                     placement errors
 *      ferraris       six holds and a full turn about each axis
 *      rate-table     known rates: steps or sines
 *      tumble         known attitudes under gravity: dividing head
 *      centrifuge     known forces of several g
 *      spin           fast rotation: places of the accelerometers (size effect)
 *      thermal        bias, and scale factor, against temperature
 *      turns          gyros alone: turns by known angles about their axes, between rests
 *      magnetometer   any rotation by hand: hard and soft iron of a magnetometer alone, by
 *                     magnetometer.h; imk_procedure_observe() refuses it */
#ifndef IMUKIT_PROCEDURE_H
#define IMUKIT_PROCEDURE_H

#include "imukit/calibration.h"
#include "imukit/static_detection.h"

IMK_BEGIN_C

typedef enum imk_procedure {
    IMK_PROCEDURE_MULTIPOSITION = 0,
    IMK_PROCEDURE_SIXPOSITION,
    IMK_PROCEDURE_FERRARIS,
    IMK_PROCEDURE_RATE_TABLE,
    IMK_PROCEDURE_TUMBLE,
    IMK_PROCEDURE_CENTRIFUGE,
    IMK_PROCEDURE_SPIN,
    IMK_PROCEDURE_THERMAL,
    IMK_PROCEDURE_TURNS,
    IMK_PROCEDURE_MAGNETOMETER,
    IMK_PROCEDURES
} imk_procedure;
/** "multiposition", "rate-table" …; NULL beyond the last. */
IMK_API const char *imk_procedure_name(imk_procedure procedure);

/** Does the procedure take records whose rows are means of poses (imk_test_record.means)? */
IMK_API bool imk_procedure_takes_means(imk_procedure procedure);

/** How to analyse a log. Start from imk_procedure_default(procedure), then change fields. A field
 *  whose comment names procedures is used by these only. */
typedef struct imk_procedure_settings {
    uint32_t cookie;
    imk_static_settings stationary; /**< detection of holds at unknown times */
    double
        placement_sigma;  /**< sixposition, ferraris, tumble: 1 sigma of the attitude of each hold;
                             turns: of the angle of each turn, and of its axis [rad]; 0: exact */
    double fixture_sigma; /**< all procedures with a reference: 1 sigma of the unit's mounting on
                             its fixture or table [rad]; 0: exact */
    /** Time left out at each end of a stretch of constant reference [s]; default 0.2. */
    double trim;
    /** Further time left out at the beginning, for filters to settle [s]; default 0. */
    double settle;
    double steady_rate;  /**< largest variation of the reference within a stretch, per axis [rad/s];
                            default 1e-4 */
    double steady_force; /**< the same for the force [m/s^2]; default 1e-3 */
    double minimum;      /**< shortest stretch [s]; default 0.5 */
    bool gyro_turns;     /**< multiposition: calibrate the gyros, too, by the turns; default true */
    double turn_angle;   /**< ferraris: angle of each turn about its axis, with sign; turns: of each
                            turn whose label states none, above 0 [rad]; default 2 pi */
    bool nonlinear; /**< estimate, too: K2, Koq, K3 and asymmetry, as far as the inputs determine
                       them (rate-table, centrifuge); K2, K3 and cross products (tumble). Default
                       true, for tumble false */
    bool cross_products; /**< tumble, centrifuge: estimate Kip, Kio, Kpo; default false */
    bool g_sensitivity, g2_sensitivity; /**< estimate those of the gyros, where the forces vary;
                                           default true, false */
    bool labelled_only; /**< multiposition: only rests within sections that have a label are holds;
                             default false */
    double g_sensitivity_sigma; /**< rate-table, tumble, centrifuge, turns: 1 sigma of each
                                   g-sensitivity that is not determined or not estimated, as part of
                                   the other sigmas [rad/s per m/s^2]; default 0.01 deg/s per g; 0:
                                   it is exactly as in the model */
    double sine_block;     /**< rate-table: averaging time of samples where the reference is never
                              constant [s]; 0 (default): single samples */
    int temperature_order; /**< thermal: order for the bias; 0 (default): chosen by
                              cross-validation, at most 5 */
    int scale_temperature_order;  /**< thermal: order for the scale factor; -1 (default): none for
                                     one pose at rest, else chosen by cross-validation */
    double reference_temperature; /**< thermal [K]; NaN (default): 25 degC if the range contains it,
                                     else the middle */
    double temperature_bin;       /**< thermal: width of the bins [K]; 0 (default): chosen */
} imk_procedure_settings;
/** Default settings of a procedure. */
IMK_API imk_procedure_settings imk_procedure_default(imk_procedure procedure);

enum { IMK_UNDETERMINED_MAX = 32 };

/** A turn whose angle does not agree with the others about its axis. */
typedef struct imk_odd_turn {
    size_t begin;       /**< first sample */
    int axis;           /**< body axis, 0 to 2 */
    int number;         /**< which of the turns about this axis, from 1 */
    double angle, read; /**< stated, and by the gyro with the scale factor of the others [rad] */
} imk_odd_turn;

enum { IMK_ODD_TURNS_MAX = 8 };

/** Findings of the procedure "turns". */
typedef struct imk_turns_findings {
    double freedom;      /**< repetitions: turns less the axes turned about */
    double scatter;      /**< 1 sigma of the angle of a turn that these show [rad] */
    double chi_square;   /**< of them, by placement_sigma and the noise */
    bool direction_read; /**< some turns state no direction: it is that which their gyro reads */
    size_t saturated;    /**< turns left out in which a gyro is at the end of its range */
    size_t missing;      /**< turns left out in which samples are missing, or beside no rest */
    size_t other_moves;  /**< moves left out that are about one axis by about half or twice the
                            angle stated, or more, or as large but about no one axis */
    size_t other_begin;  /**< sample at which the first of these begins */
    int other_axis;      /**< its axis; -1: about no one axis */
    double other_angle;  /**< angle that the gyro reads in it [rad] */
    size_t other_gyro[3][3]; /**< turns left out, by the axis of their label and that of the gyro
                                which reads most of them */
    size_t odd; /**< turns left out because their angle does not agree with the others; the
                   chance that a sound log has one is 1 in 1000 or less */
    imk_odd_turn odd_turn[IMK_ODD_TURNS_MAX]; /**< the first of them */
    double torn[3]; /**< of the turns about each axis: largest difference of what the gyro reads by
                       angles that were stated equal, where they do not agree and are too few to
                       tell which is wrong [rad]; else 0 */
} imk_turns_findings;

/** Findings of a procedure about the log. */
typedef struct imk_procedure_findings {
    imk_static_findings stationary; /**< only for procedures that detect holds */
    size_t observations, turns;     /**< numbers added to the calibration */
    size_t first_observation, first_turn;
    size_t intervals;    /**< number of stretches found */
    size_t left_out;     /**< stretches not used: saturated, not finite, too short, contradicted */
    size_t contradicted; /**< of these, holds whose label says another face than their readings */
    size_t contradicted_at; /**< a sample of the first of them */
    double spread; /**< spread of the directions of holds: smallest eigenvalue of the mean outer
                      product of their unit vectors, 1/3 at best; 0: all in one plane */
    double lag, lag_sigma; /**< delay of the readings against a reference that is never constant,
                              estimated and corrected [s]; sigma 0: not estimated */
    size_t creeping;       /**< of the procedure "tumble": stretches in which the readings of
                              accelerometers have a slope */
    imk_turns_findings known_turns; /**< of the procedure "turns", else zeros */
    size_t undetermined_count; /**< number of parameters that the procedure estimates but this log
                                  does not determine: they keep the model's values */
    imk_model_parameter undetermined[IMK_UNDETERMINED_MAX]; /**< the first of them */
} imk_procedure_findings;

/** Bytes of workspace for imk_procedure_observe(). */
IMK_API size_t imk_procedure_workspace_size(imk_procedure procedure, const imk_test_record *record,
                                            const imk_procedure_settings *settings);

/** Analyse a record: add it, its observations and its turns to the calibration, and make free the
 *  parameters that can be determined. If readings are in counts and the model states no
 *  sensitivity, multiposition, sixposition, ferraris, turns and rate-table find a nominal one and
 *  put it into the model; the others return IMK_ERROR_UNIT_MISSING.
 *  @param keep_free  true: the caller has chosen the free parameters, and none are added
 *  @return IMK_ERROR_TOO_SHORT (field "hold", "turn", "step", "temperature"; value: number found,
 *          limit: number needed), IMK_ERROR_KEY_MISSING (field: what the record lacks:
 *          "reference_rate", "temperature", "section", "gyro" …), IMK_ERROR_UNIT_MISSING,
 *          IMK_ERROR_WORKSPACE (also for the capacity of observations; value: needed, limit:
 *          available), IMK_ERROR_RANGE (settings), IMK_ERROR_UNSUPPORTED (a record of means, and
 *          the procedure does not take them), errors of imk_static_detect(); on error the
 *          calibration is unchanged */
IMK_API imk_status imk_procedure_observe(imk_procedure procedure, imk_calibration *calibration,
                                         const imk_test_record *record,
                                         const imk_procedure_settings *settings, bool keep_free,
                                         imk_procedure_findings *findings, void *workspace,
                                         size_t workspace_size, imk_error *error);

/* ---- diagnostics --------------------------------------------------------------------------------
 */

/** Diagnostics of a log or a solution. `value` and `limit` are those of imk_diagnostic_finding. */
typedef enum imk_diagnostic {
    IMK_DIAGNOSTIC_NEVER_STATIC = 0, /**< the unit is never at rest */
    IMK_DIAGNOSTIC_NEVER_MOVES,      /**< there is only one pose */
    IMK_DIAGNOSTIC_FEW_POSES,        /**< too few different poses: value found, limit needed */
    IMK_DIAGNOSTIC_ONE_PLANE, /**< all poses are in one plane across `axis` (-1: across none): value
                                 is their spread along this axis over gravity (0.58 at best), limit
                                 the spread needed */
    IMK_DIAGNOSTIC_GRAVITY_UNIT, /**< |force| at rest is not gravity: value is |force| [m/s^2],
                                    limit the factor that would correct it: 9.80665 (forces are in
                                    g), 9.80665e-3 (mg, or Gal), 9.80665e-6 (ug), 1/9.80665
                                    (converted from g twice), 0.3048 (ft/s^2); 0: none of these */
    IMK_DIAGNOSTIC_RATE_UNIT,    /**< rates of the turns look like deg/s taken for rad/s, or the
                                 reverse: value is the ratio, 57.3 or 1/57.3 */
    IMK_DIAGNOSTIC_SATURATED, /**< an axis stays at the end of its range: value is the share of such
                                 samples, limit the reading */
    IMK_DIAGNOSTIC_COUNTS, /**< a sensor's readings are whole numbers although stated as SI: value
                              is the largest */
    IMK_DIAGNOSTIC_SWAPPED_AXES, /**< by the turns, `axis` and `other` of `sensor` look exchanged;
                                    sensor -1: axes of the gyros and of the accelerometers differ in
                                    another way. value: angle by which turns miss [rad] */
    IMK_DIAGNOSTIC_LEFT_HANDED,  /**< `axis` of `sensor` looks inverted; sensor -1: both sensors are
                                 in left-handed axes */
    IMK_DIAGNOSTIC_TIME_UNIT,  /**< times look like ms or us taken for s: value is the factor, 1e3,
                               1e6, or 1e-3 for the reverse */
    IMK_DIAGNOSTIC_STUCK,      /**< an axis never changes */
    IMK_DIAGNOSTIC_RESIDUALS,  /**< value, chi-square per degree of freedom, is far above one */
    IMK_DIAGNOSTIC_CORRELATED, /**< only noise separates two parameters: value is their correlation
                                */
    IMK_DIAGNOSTIC_OUTLIERS,   /**< many observations are refused: value is their share */
    IMK_DIAGNOSTIC_SCALE, /**< readings of `sensor` (`axis` -1: of all its axes) are `value` times
                             the input, further from 1 than `limit`: 0.15, no sensor errs by so
                             much; of a solution also 0.05, few sensors do */
    IMK_DIAGNOSTIC_ONE_CONE, /**< as ONE_PLANE, and the force along `axis` is nearly the same in all
                                poses and not 0 */
    IMK_DIAGNOSTIC_UNEQUAL_AXES, /**< the sigmas stated of `axis` and `other` of `sensor`, the
                                    quietest and the noisiest, differ by the factor `value`, and no
                                    residuals tell what else makes them scatter */
    IMK_DIAGNOSTIC_ODD_TURN, /**< few turns do not fit the axes as they stand, and would with axes
                                that are changed: too few to be sure. value: angle by which they
                                miss [rad] */
    IMK_DIAGNOSTICS
} imk_diagnostic;

typedef struct imk_diagnostic_finding {
    imk_diagnostic kind;
    int sensor, axis, other; /**< -1: none */
    double value, limit;
    uint64_t classes; /**< of a record, SWAPPED_AXES, LEFT_HANDED and ODD_TURN: how the axes may be
                         mended, for imk_axes_mendings(); else 0 */
} imk_diagnostic_finding;

/** Check a record, with the static intervals found in it, before the calibration is solved.
 *  @return number of diagnostics written, at most `capacity`, the gravest first */
IMK_API size_t imk_record_diagnostics(const imk_test_record *record,
                                      const imk_static_findings *findings, size_t interval_count,
                                      const imk_static_interval *interval, double gravity,
                                      const imk_model *model, size_t capacity,
                                      imk_diagnostic_finding *diagnostic);
/** Which mistakes about the axes the turns between the static intervals would not show: bit k is
 *  set when the gyros read as imk_signed_axes_of(k), and so each of its mendings
 *  (imk_axes_mendings()), would fit the turns as well. The signs of single gyros are bits 1, 2 and
 *  4, all of them bit 7; a sign of an accelerometer is that of both other gyros.
 *  @return all bits when there are not enough turns to tell anything */
IMK_API uint64_t imk_record_axes_unseen(const imk_test_record *record, size_t interval_count,
                                        const imk_static_interval *interval,
                                        const imk_model *model);
/** Check a solution. @return number of diagnostics written, at most `capacity`, the gravest first
 */
IMK_API size_t imk_solution_diagnostics(const imk_calibration *calibration,
                                        const imk_calibration_result *result, size_t capacity,
                                        imk_diagnostic_finding *diagnostic);

IMK_END_C
#endif
