/* SPDX-License-Identifier: Apache-2.0 */
/** @file technology_map.h
 *  Maps of technologies, classes and applications: bias stability against scale factor stability
 *  for gyros and for accelerometers, and prices against bias stability. These are the regions that
 *  `imukit grade --plot` draws. */
#ifndef IMUKIT_TECHNOLOGY_MAP_H
#define IMUKIT_TECHNOLOGY_MAP_H

#include "imukit/model.h"

IMK_BEGIN_C

/** The maps. The two kinds of prices are never on one map. */
typedef enum imk_grade_map {
    IMK_GRADE_MAP_GYRO = 0,    /**< x: scale factor stability [1], y: bias stability [rad/s] */
    IMK_GRADE_MAP_ACCEL,       /**< x: scale factor stability [1], y: bias stability [m/s^2] */
    IMK_GRADE_MAP_COST,        /**< x: bias stability of the gyros [rad/s], y: price of a whole unit
                                  [US dollars] */
    IMK_GRADE_MAP_SENSOR_COST, /**< x: bias stability [rad/s], y: price of one gyro [US dollars] */
    IMK_GRADE_MAPS             /**< all of them */
} imk_grade_map;

/** What a region stands for. */
typedef enum imk_map_kind {
    IMK_MAP_TECHNOLOGY = 0, /**< its name is one of those that imk_grade_table() has */
    IMK_MAP_CLASS,
    IMK_MAP_APPLICATION
} imk_map_kind;

/** A region of a map. */
typedef struct imk_map_region {
    imk_map_kind kind;
    const char *name;     /**< "DTG"; several technologies that a source does not tell apart are
                             separated by ", " */
    const char *detail;   /**< which part of them: "navigation"; "" for the whole */
    double x_low, x_high; /**< NaN: the source states none, and the place along x has no meaning */
    double y_low, y_high;
    int year;           /**< of the source; 0: undated */
    double doubt;       /**< 1: the limits were read in the source; larger: they are quoted from
                           memory, and each may be wrong by this factor */
    const char *source; /**< "[KEY] place", with a key of docs/references.md */
} imk_map_region;

/** Number of regions of a map; 0 for IMK_GRADE_MAPS. */
IMK_API size_t imk_map_region_count(imk_grade_map map);
/** Region `index`, which lives for ever; NULL beyond the end. */
IMK_API const imk_map_region *imk_map_region_get(imk_grade_map map, size_t index);

/** A technology of the table of grades. */
typedef struct imk_technology {
    const char *name;    /**< "DTG" */
    const char *meaning; /**< "dynamically tuned gyro: …" */
    bool gyro;           /**< false: of accelerometers */
} imk_technology;

/** Technology `index`; NULL beyond the end. */
IMK_API const imk_technology *imk_technology_get(size_t index);

IMK_END_C
#endif
