/* SPDX-License-Identifier: Apache-2.0 */
/* Regions of the maps, each with its published source.
 *
 * Grades with their applications, errors of position and costs are those of [ELSHEIMY2020],
 * table 1, which says nothing of scale factors: they are bands across the map. Classes of gyros by
 * bias drift and scale factor accuracy are those of [YAZDI1998], table 1. Technologies are those
 * which the table of classes (grades.c) lists for a bias; it says nothing of scale factors either:
 * they are columns at the left edge, where no sensor is, and their place along the axis means
 * nothing.
 *
 * What a source leaves open ("< 0.01 deg/h") ends where the better class does or at the edge, and
 * what it states as one number ("0.1 deg/s", "about 100,000 $") is drawn as a factor of two to
 * either side. */
#include "grade_parts.h"

/* Edges of the maps: of the columns, of the bands. */
#define EDGE 0.001
#define LOW 1.0
#define HIGH 1e5

enum { BLUE, RED, GREEN, PURPLE, ORANGE, SKY, BLACK, GREY };

static const char grades[] = "[ELSHEIMY2020] table 1";
static const char classes[] = "[YAZDI1998] table 1";
static const char technology[] = "the table of classes: technology by bias";

/* x: scale factor [ppm], y: bias [deg/h] */
static const grade_region gyro_regions[] = {
    {{"submarines, missiles", PURPLE, LOW, HIGH, 1e-4, 1e-3, true}, grades},
    {{"aircraft, survey", GREEN, LOW, HIGH, 1e-3, 1e-2, true}, grades},
    {{"weapons, mapping", ORANGE, LOW, HIGH, 1, 10, true}, grades},
    {{"cars, walking", RED, LOW, HIGH, 180, 720, true}, grades},
    {{"inertial class", BLUE, LOW, 10, 1e-4, 1e-2, false}, classes},
    {{"tactical class", BLUE, 100, 1000, 0.1, 10, false}, classes},
    {{"rate class", BLUE, 1000, 1e4, 10, 1000, false}, classes},
    {{"ESG", BLACK, EDGE, 0.005, 1e-4, 0.005, false}, technology},
    {{"RLG, FOG", BLACK, 0.005, 0.035, 1e-4, 10, false}, technology},
    {{"MEMS", BLACK, 0.035, 0.14, 1, 10, false}, technology},
    {{"Coriolis", BLACK, 0.14, 0.9, 1, 1000, false}, technology},
};

/* x: scale factor [ppm], y: bias [ug] */
static const grade_region accel_regions[] = {
    {{"submarines, missiles", PURPLE, LOW, HIGH, 0.1, 1, true}, grades},
    {{"aircraft, survey", GREEN, LOW, HIGH, 1, 100, true}, grades},
    {{"cars, walking", RED, LOW, HIGH, 100, 1000, true}, grades},
    {{"weapons, mapping", ORANGE, LOW, HIGH, 1000, 5000, true}, grades},
    {{"servo", BLACK, EDGE, 0.006, 0.1, 1000, false}, technology},
    {{"vibrating beam", BLACK, 0.006, 0.14, 30, 1000, false}, technology},
    {{"MEMS", BLACK, 0.14, 0.9, 50, 10000, false}, technology},
};

/* x: error of position after an hour [nmi], y: cost of a unit [dollars]; 30 … 100 m/h,
 * 1 nmi/h, 10 … 20 nmi/h, "large variation". The commercial row states the cost of one sensor. */
static const grade_region cost_regions[] = {
    {{"strategic", PURPLE, 30 / 1852.0, 100 / 1852.0, 5e5, 2e6, false}, grades},
    {{"navigation", GREEN, 0.5, 2, 5e4, 2e5, false}, grades},
    {{"tactical", ORANGE, 10, 20, 2e3, 5e4, false}, grades},
    {{"commercial: each sensor", RED, 20, 2000, 1, 10, false}, grades},
};

const grade_region *grade_regions(int map, size_t *count)
{
    switch (map) {
    case GRADE_MAP_GYRO:
        *count = sizeof gyro_regions / sizeof gyro_regions[0];
        return gyro_regions;
    case GRADE_MAP_ACCEL:
        *count = sizeof accel_regions / sizeof accel_regions[0];
        return accel_regions;
    default:
        *count = sizeof cost_regions / sizeof cost_regions[0];
        return cost_regions;
    }
}
