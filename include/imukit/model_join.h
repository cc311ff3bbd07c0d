/* SPDX-License-Identifier: Apache-2.0 */
/** @file model_join.h
 *  One unit from its parts: gyros of one model and accelerometers of another, or three single axes
 *  of three models. What instruments reduce to (physics.h) and what is calibrated or identified
 *  apart becomes a model that can be simulated and navigated. */
#ifndef IMUKIT_MODEL_JOIN_H
#define IMUKIT_MODEL_JOIN_H

#include "imukit/model.h"

IMK_BEGIN_C

enum { IMK_JOIN_WHOLE = -1, IMK_JOIN_ANY = -1, IMK_JOIN_MAX = 16 };

/** One model of those that are joined. */
typedef struct imk_join_part {
    const imk_model *model;
    const char *name; /**< in errors: that of its file */
    /** IMK_JOIN_WHOLE: it gives the kinds of sensors that it has, as they are. 0, 1 or 2: it gives
     *  the axis x, y or z of the kinds that it has. A sensor of one axis, along a body axis, is
     *  turned in cyclic order: what it senses along the next body axis, it does so in the unit. Of
     *  three sensors along x, y and z the one of this axis is taken. */
    int axis;
} imk_join_part;

/** Settings. Start from imk_join_default(). */
typedef struct imk_join_settings {
    uint32_t cookie;
    /** Part that gives a kind of sensor, where several whole parts have it; IMK_JOIN_ANY (default):
     *  the only one that has it. */
    int from[IMK_KINDS];
    int timing_from;  /**< the same of the sample clock; default IMK_JOIN_ANY: those that state one
                         must agree */
    const char *name; /**< name of the unit; default "joined" */
} imk_join_settings;

/** Two parts, none chosen. */
IMK_API imk_join_settings imk_join_default(void);

/** What joining could not keep, or had to take for granted. */
typedef enum imk_join_note_kind {
    IMK_JOIN_PARALLEL = 0,  /**< gyros and accelerometers come from different parts: their axes are
                               taken as parallel, and no misalignment between them is known */
    IMK_JOIN_AXIS_UNSTATED, /**< `key` of the sensor is stated by other axes and not by that of
                               `part`, which therefore has 0 */
    IMK_JOIN_INTERVAL_LOST, /**< evidence of `key` is left out: not all axes have it, or there is no
                               room */
    IMK_JOIN_CORRELATION_LOST, /**< the correlations of `part` are left out: together there are more
                                  than IMK_CORRELATED_MAX parameters */
    IMK_JOIN_RANGE_NARROWED, /**< `key` is a polynomial: its range is the one that all axes have */
    IMK_JOIN_FRAME_LOST,     /**< the parts state different frames, and none is kept */
    IMK_JOIN_RESIDUAL_LOST   /**< parts are the residual of different compensations, or of none:
                                residual_of is left out */
} imk_join_note_kind;

typedef struct imk_join_note {
    imk_join_note_kind kind;
    int sensor, part; /**< -1: does not matter */
    char key[48];
} imk_join_note;

enum { IMK_JOIN_NOTES = 40 };

/** Where the unit is from. */
typedef struct imk_joined {
    int from[IMK_KINDS][3]; /**< part that gives axis x, y, z; of a whole sensor thrice the same;
                               -1: none */
    int timing_from;        /**< -1: no part states a clock */
    size_t note_count;
    imk_join_note note[IMK_JOIN_NOTES];
} imk_joined;

/** Join models.
 *
 *  Sensors, their evidence, the correlations of their parameters and the clock are carried over;
 *  correlations between parameters of different parts are 0. Parts that state different warm-up
 *  times, reference temperatures or clocks for what the unit has once are refused.
 *  @param settings  NULL: imk_join_default()
 *  @param unit      of no use after an error; must not be one of the parts
 *  @param joined    NULL: not wanted
 *  @return IMK_ERROR_EMPTY (no part), IMK_ERROR_RANGE (more than IMK_JOIN_MAX parts, an axis or
 *          part that does not exist), IMK_ERROR_CONFLICT (two parts give the same; error.field is
 *          the sensor or key, error.found the names), IMK_ERROR_KEY_MISSING (an axis is missing),
 *          IMK_ERROR_UNSUPPORTED (a part that gives an axis has other sensors than one along a body
 *          axis or three along x, y, z), and the errors of imk_model_validate() for a part and for
 *          the unit */
IMK_API imk_status imk_model_join(size_t count, const imk_join_part *part,
                                  const imk_join_settings *settings, imk_model *unit,
                                  imk_joined *joined, imk_error *error);

IMK_END_C
#endif
