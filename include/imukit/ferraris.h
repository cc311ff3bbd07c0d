/* SPDX-License-Identifier: Apache-2.0 */
/** @file ferraris.h
 *  The closed form of the Ferraris procedure: six holds and three turns, solved without iteration.
 *
 *  With U+ and U- the mean readings of the holds with each axis up and down as columns, W those of
 *  the turns (integrated, less bias and g-sensitivity), g gravity and a the angle [FERRARIS1995]:
 *
 *      accelerometers  K R = (U+ - U-)/(2 g)      b = diag(U+ + U-)/2
 *      gyros           K_g R_g = W/a              b_g = mean over all holds, by samples
 *                      G = (Ug+ - Ug-)/(2 g)
 *
 *      accel reading = K R f + b,    gyro reading = K_g R_g w + G f + b_g
 *
 *  K is diagonal and contains the lengths of the rows, R the directions of the axes. Holds of
 *  unequal length up and down leave a part of G in b_g. The Earth's rate, placement errors and
 *  redundant holds are not taken into account; imk_procedure_observe() does that and solves the
 *  same log by maximum likelihood. Use the closed form for comparison, or where it was agreed on.
 */
#ifndef IMUKIT_FERRARIS_H
#define IMUKIT_FERRARIS_H

#include "imukit/procedure.h"

IMK_BEGIN_C

/** A hold or a turn in a log. */
typedef struct imk_ferraris_stretch {
    bool turn;         /**< true: a turn; false: a hold */
    size_t begin, end; /**< samples begin … end - 1 */
    int axis;          /**< axis that points up or down, or axis of the turn; 0 … 2 */
    int sense; /**< hold: 1 up (reads +g), -1 down; turn: 1 in the sense of turn_angle, -1 opposite
                */
} imk_ferraris_stretch;

/** One triad, in units of the reading. */
typedef struct imk_ferraris_triad {
    double scale[3];   /**< K, positive [reading/unit] */
    double axes[3][3]; /**< R, rows of unit length [1] */
    double bias[3];    /**< b [reading] */
    double scale_sigma[3], axes_sigma[3][3], bias_sigma[3];
} imk_ferraris_triad;

/** The solution. */
typedef struct imk_ferraris {
    imk_ferraris_triad gyro, accel;
    double g_sensitivity[3][3]; /**< G [reading/(m/s^2)] */
    double g_sensitivity_sigma[3][3];
} imk_ferraris;

/** Find holds and turns, by the labels of sections or by the times at rest. Labels are words in any
 *  case, separated by anything that is neither letter nor digit: an axis (x, y, z); up, p, pos,
 *  plus, positive or down, a, n, neg, minus, negative; rot, rotation, turn, spin for a turn; "+x",
 *  "x-" are up and down too. A label with two axes, or with to, move, moving, transition, is
 *  skipped. Anything that a label does not state is found from the readings.
 *  @param settings   those of IMK_PROCEDURE_FERRARIS; stationary, trim, settle, minimum and
 *                    turn_angle are used
 *  @param model      nominal sensitivities; zero if not known
 *  @param workspace  imk_procedure_workspace_size(IMK_PROCEDURE_FERRARIS, …)
 *  @param count      number found, also beyond the capacity
 *  @return the errors of imk_procedure_observe() */
IMK_API imk_status imk_ferraris_stretches(const imk_test_record *record,
                                          const imk_procedure_settings *settings,
                                          const imk_model *model, double gravity, size_t capacity,
                                          imk_ferraris_stretch *stretch, size_t *count,
                                          void *workspace, size_t workspace_size, imk_error *error);

/** Solve the closed form. Holds of one face are pooled by samples, turns about one axis by angle.
 *  Sigmas follow from the scatter within the holds and `angle_sigma`, to first order.
 *  @param gravity      [m/s^2], > 0
 *  @param turn_angle   angle of each turn, with sign [rad]
 *  @param angle_sigma  1 sigma of this angle [rad], >= 0
 *  @return IMK_ERROR_TOO_SHORT (field "hold" or "turn"; expected: which are missing),
 *          IMK_ERROR_KEY_MISSING ("gyro", "accel"), IMK_ERROR_RANGE, IMK_ERROR_ARGUMENT (an invalid
 *          stretch), IMK_ERROR_NOT_FINITE, IMK_ERROR_GAP (index: of the turn), IMK_ERROR_SINGULAR
 */
IMK_API imk_status imk_ferraris_closed_form(const imk_test_record *record, size_t count,
                                            const imk_ferraris_stretch *stretch, double gravity,
                                            double turn_angle, double angle_sigma,
                                            imk_ferraris *result, imk_error *error);

/** Write a closed form into a model, with sigmas: biases, scale factors, misalignment,
 *  g-sensitivity. Readings are counts where the model states a sensitivity, else SI:
 *
 *      (K R)_ij = sensitivity_i [(1 + scale_i) delta_ij + misalignment_ij],
 *      b_i = sensitivity_i bias_i + zero_offset_i */
IMK_API void imk_ferraris_to_model(const imk_ferraris *ferraris, imk_model *model);
/** The inverse of imk_ferraris_to_model(). Cross-axis response is added to the misalignment; sigmas
 *  are 0. */
IMK_API void imk_ferraris_from_model(const imk_model *model, imk_ferraris *ferraris);

IMK_END_C
#endif
