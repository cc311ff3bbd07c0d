/* SPDX-License-Identifier: Apache-2.0 */
/** @file procedure.h
 *  The procedures of a test laboratory: each looks at a log, adds what it observed to a calibration
 *  and makes free what that can determine. Names of terms as in IEEE 1293 and IEEE 528; how to do
 *  each test: docs/calibrate.md.
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
 *      thermal        bias, and scale factor, against temperature */
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
    IMK_PROCEDURES
} imk_procedure;
/** "multiposition", "rate-table" …; NULL beyond the last. */
IMK_API const char *imk_procedure_name(imk_procedure procedure);

/** How to look at a log. Start from imk_procedure_default(procedure), then change fields; each
 *  procedure reads those it names in its own part, and the common ones. */
typedef struct imk_procedure_settings {
    uint32_t cookie;
    imk_static_settings stationary; /**< holds at unknown times */
    double placement_sigma; /**< of each hold [rad]; 0: exact. sixposition, ferraris, tumble */
    double fixture_sigma;   /**< of the unit on its fixture or table [rad]; 0: exact. All with a
                                 reference */
    double trim;   /**< left out at each end of a stretch of constant reference [s]; default 0.2 */
    double settle; /**< left out at its beginning besides, for filters [s]; default 0 */
    double steady_rate;  /**< by how much the reference may vary within a stretch, per axis
                              [rad/s]; 1e-4 */
    double steady_force; /**< [m/s^2]; 1e-3 */
    double minimum;      /**< shortest stretch [s]; default 0.5 */
    bool gyro_turns;     /**< multiposition: also the gyros, by the turns; default true */
    double turn_angle; /**< ferraris: of each turn about its axis, with sign [rad]; default 2 pi */
    bool nonlinear;    /**< rate-table, centrifuge: K2, Koq, K3, asymmetry too (as many as the
                            inputs tell apart); tumble: K2, K3, cross products; true but for
                            tumble */
    bool cross_products;                /**< tumble, centrifuge: Kip, Kio, Kpo; default false */
    bool g_sensitivity, g2_sensitivity; /**< of the gyros, where the forces vary; true, false */
    double sine_block;     /**< rate-table: samples are averaged over so long where the reference
                                never holds still [s]; 0 (default): single samples */
    int temperature_order; /**< thermal: of the bias; 0 (default): chosen by cross-validation,
                                at most 5 */
    int scale_temperature_order;  /**< thermal: of the scale factor; -1 (default): none at rest in
                                       one pose, else chosen likewise */
    double reference_temperature; /**< thermal [K]; NaN (default): 25 degC if within, else the
                                       middle */
    double temperature_bin;       /**< thermal: width of the bins [K]; 0 (default): chosen */
} imk_procedure_settings;
/** Defaults of a procedure. */
IMK_API imk_procedure_settings imk_procedure_default(imk_procedure procedure);

enum { IMK_UNDETERMINED_MAX = 32 };

/** What a procedure saw in the log, besides what it added. */
typedef struct imk_procedure_findings {
    imk_static_findings stationary; /**< of the procedures that detect holds */
    size_t observations, turns;     /**< added */
    size_t first_observation, first_turn;
    size_t intervals; /**< stretches found */
    size_t left_out;  /**< stretches not used: saturated, not finite, too short */
    double spread; /**< of the directions of holds: smallest eigenvalue of the mean outer product of
                        their unit vectors, 1/3 at best; 0: all in one plane */
    double lag, lag_sigma; /**< of the readings behind a reference that never holds still, found and
                                allowed for [s]; sigma 0: not looked for */
    size_t undetermined_count; /**< parameters the procedure would have made free, and the log does
                                    not determine: they stay as the model has them */
    imk_model_parameter undetermined[IMK_UNDETERMINED_MAX]; /**< the first of them */
} imk_procedure_findings;

/** Bytes of workspace for looking at a record. */
IMK_API size_t imk_procedure_workspace_size(imk_procedure procedure, const imk_test_record *record,
                                            const imk_procedure_settings *settings);

/** Look at a record: append it to calibration->record, observations and turns to theirs, and make
 *  free what can be determined (unless `keep_free`: the caller has chosen). Readings in counts
 *  without a sensitivity in the model: multiposition, sixposition, ferraris, rate-table find a
 *  nominal one and put it into the model; others refuse with IMK_ERROR_UNIT_MISSING.
 *  @return IMK_ERROR_TOO_SHORT (field "hold", "turn", "step", "temperature": value found, limit
 *          needed), IMK_ERROR_KEY_MISSING (field: "reference_rate", "temperature", "section",
 *          "gyro" … that the record lacks), IMK_ERROR_UNIT_MISSING, IMK_ERROR_WORKSPACE (also:
 *          capacity of observations; value needed, limit there), IMK_ERROR_RANGE (settings), errors
 *          of imk_static_detect(); the calibration is then as before */
IMK_API imk_status imk_procedure_observe(imk_procedure procedure, imk_calibration *calibration,
                                         const imk_test_record *record,
                                         const imk_procedure_settings *settings, bool keep_free,
                                         imk_procedure_findings *findings, void *workspace,
                                         size_t workspace_size, imk_error *error);

/* ---- what looks wrong ---------------------------------------------------------------------------
 */

/** Diagnostics about a log or a solution, each with a message in the command. */
typedef enum imk_diagnostic {
    IMK_DIAGNOSTIC_NEVER_STATIC = 0, /**< no stretch stands still */
    IMK_DIAGNOSTIC_NEVER_MOVES,      /**< one pose only */
    IMK_DIAGNOSTIC_FEW_POSES,        /**< value different ones found, limit needed */
    IMK_DIAGNOSTIC_ONE_PLANE, /**< poses all in one plane or on a cone about `axis`: value is their
                              spread across it over gravity (0.58 at best), limit needed */
    IMK_DIAGNOSTIC_GRAVITY_UNIT, /**< |force| at rest is not gravity: value is |force| [m/s^2],
                                 limit the factor that would mend it: 9.80665 (forces are in g),
                                 9.80665e-3 (mg, or Gal), 9.80665e-6 (ug), 1/9.80665 (converted
                                 from g twice), 0.3048 (ft/s^2); 0: none of these */
    IMK_DIAGNOSTIC_RATE_UNIT,    /**< rates of the turns look like deg/s taken for rad/s, or the
                                 reverse: value is the ratio, 57.3 or 1/57.3 */
    IMK_DIAGNOSTIC_SATURATED,    /**< an axis stays at the end of its range: value is the share of
                                 samples, limit the reading there */
    IMK_DIAGNOSTIC_COUNTS,       /**< a sensor's readings are whole numbers and said to be SI: value
                                 is the largest */
    IMK_DIAGNOSTIC_SWAPPED_AXES, /**< `axis` and `other` of `sensor` look exchanged, by the turns;
                                 sensor -1: axes of the gyros and of the accelerometers differ
                                 otherwise. value: angle by which turns miss [rad] */
    IMK_DIAGNOSTIC_LEFT_HANDED,  /**< `axis` of `sensor` looks inverted; sensor -1: both sensors are
                                 in left-handed axes */
    IMK_DIAGNOSTIC_TIME_UNIT,  /**< times look like ms or us taken for s: value is the factor, 1e3,
                               1e6, or 1e-3 for the reverse */
    IMK_DIAGNOSTIC_STUCK,      /**< an axis never changes */
    IMK_DIAGNOSTIC_RESIDUALS,  /**< chi-square per degree of freedom far above one: value */
    IMK_DIAGNOSTIC_CORRELATED, /**< two parameters told apart by noise only: value correlation */
    IMK_DIAGNOSTIC_OUTLIERS,   /**< many observations refused: value share */
    IMK_DIAGNOSTICS
} imk_diagnostic;

typedef struct imk_diagnostic_finding {
    imk_diagnostic kind;
    int sensor, axis, other; /**< -1: none */
    double value, limit;
} imk_diagnostic_finding;

/** Look a record over, with the static intervals found in it, before anything is solved.
 *  @return number of diagnostics written, at most `capacity`, the gravest first */
IMK_API size_t imk_record_diagnostics(const imk_test_record *record,
                                      const imk_static_findings *findings, size_t interval_count,
                                      const imk_static_interval *interval, double gravity,
                                      const imk_model *model, size_t capacity,
                                      imk_diagnostic_finding *diagnostic);
/** Look a solution over. */
IMK_API size_t imk_solution_diagnostics(const imk_calibration *calibration,
                                        const imk_calibration_result *result, size_t capacity,
                                        imk_diagnostic_finding *diagnostic);

IMK_END_C
#endif
