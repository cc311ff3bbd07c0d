/* SPDX-License-Identifier: Apache-2.0 */
/* The regions of the maps (technology_map.h), with the source of each.
 *
 * An open range of a source ("< 0.01 deg/h") ends at the limit of the better class or at the edge
 * of the map. A single number ("0.1 deg/s", "about 100,000 $") becomes a range of a factor of two
 * to either side. "A few" is 2 to 5, "tens" 10 to 100. The well-known charts of technologies
 * [BARBOUR2001] could not be read where this was written: limits from memory have a doubt, the
 * factor by which each may be wrong. */
#include "imukit/technology_map.h"

#include <math.h>

#define PPM 1e-6
#define DEG_H (3.14159265358979323846 / 180 / 3600)
#define UG 9.80665e-6
#define UNSTATED (double)NAN, (double)NAN

/* Scale factor [ppm] and bias [deg/h] or [ug]; prices [dollars] against bias [deg/h]. */
#define GYRO(x0, x1, y0, y1) (x0) * PPM, (x1)*PPM, (y0)*DEG_H, (y1)*DEG_H
#define GYRO_BIAS(y0, y1) UNSTATED, (y0)*DEG_H, (y1)*DEG_H
#define ACCEL(x0, x1, y0, y1) (x0) * PPM, (x1)*PPM, (y0)*UG, (y1)*UG
#define ACCEL_BIAS(y0, y1) UNSTATED, (y0)*UG, (y1)*UG
#define PRICE(x0, x1, y0, y1) (x0) * DEG_H, (x1)*DEG_H, y0, y1

#define TECHNOLOGY IMK_MAP_TECHNOLOGY
#define CLASS IMK_MAP_CLASS
#define APPLICATION IMK_MAP_APPLICATION

static const char survey[] = "[ELSHEIMY2020] table 1";
static const char gyro_classes[] = "[YAZDI1998] table 1; [NOROUZPOUR2013] page 3";
static const char chart[] = "from memory of [BARBOUR2001] figures 1 and 2";
static const char book[] = "from memory of [LAWRENCE1998]";
static const char maker[] = "[GNCTECH2025] gyroscope-technology-comparison";
static const char lesson[] = "[IMULESSON]";
static const char notes[] = "[INSNOTES] entries 33 to 35";
static const char shop[] = "[DIGIKEY2026]";

static const imk_map_region gyro_map[] = {
    {APPLICATION, "submarines, missiles", "", GYRO_BIAS(1e-4, 1e-3), 2020, 1, survey},
    {APPLICATION, "aircraft, survey", "", GYRO_BIAS(1e-3, 1e-2), 2020, 1, survey},
    {APPLICATION, "weapons, mapping", "", GYRO_BIAS(1, 10), 2020, 1, survey},
    {APPLICATION, "cars, walking", "", GYRO_BIAS(180, 720), 2020, 1, survey},
    {CLASS, "inertial class", "", GYRO(1, 10, 1e-4, 1e-2), 1998, 1, gyro_classes},
    {CLASS, "tactical class", "", GYRO(100, 1000, 0.1, 10), 1998, 1, gyro_classes},
    {CLASS, "rate class", "", GYRO(1000, 1e4, 10, 1000), 1998, 1, gyro_classes},
    {TECHNOLOGY, "ESG", "", GYRO_BIAS(1e-4, 0.005), 1998, 10, book},
    {TECHNOLOGY, "floated", "", GYRO(1, 300, 1e-4, 1), 2001, 10, chart},
    {TECHNOLOGY, "DTG", "", GYRO(10, 1000, 0.005, 10), 2001, 10, chart},
    {TECHNOLOGY, "RLG", "navigation", GYRO(2, 5, 0.001, 0.01), 0, 1, lesson},
    {TECHNOLOGY, "RLG", "", GYRO(1, 150, 5e-4, 5), 2001, 10, chart},
    {TECHNOLOGY, "FOG", "navigation", GYRO(1, 10, 0.001, 0.01), 2025, 1, maker},
    {TECHNOLOGY, "FOG", "", GYRO(3, 1500, 0.001, 20), 2001, 10, chart},
    {TECHNOLOGY, "Coriolis", "quartz", GYRO(10, 100, 0.1, 1), 2025, 1, maker},
    {TECHNOLOGY, "Coriolis", "", GYRO(300, 1e4, 1, 1000), 2001, 10, chart},
    {TECHNOLOGY, "MEMS", "silicon", GYRO(100, 1000, 1, 10), 2025, 1, maker},
    {TECHNOLOGY, "wheel", "", GYRO(1000, 3e4, 10, 1000), 1998, 10, book},
};

static const imk_map_region accel_map[] = {
    {APPLICATION, "submarines, missiles", "", ACCEL_BIAS(0.1, 1), 2020, 1, survey},
    {APPLICATION, "aircraft, survey", "", ACCEL_BIAS(1, 100), 2020, 1, survey},
    {APPLICATION, "cars, walking", "", ACCEL_BIAS(100, 1000), 2020, 1, survey},
    {APPLICATION, "weapons, mapping", "", ACCEL_BIAS(1000, 5000), 2020, 1, survey},
    {TECHNOLOGY, "servo", "quartz flexure", ACCEL(10, 30, 10, 25), 2025, 1,
     "[GNCTECH2025] qac-accelerometer-flexure-jdsj25tk01"},
    {TECHNOLOGY, "servo", "navigation", ACCEL(10, 100, 25, 100), 0, 1, lesson},
    {TECHNOLOGY, "servo", "", ACCEL(3, 1000, 1, 1000), 2001, 10, chart},
    {TECHNOLOGY, "vibrating beam", "", ACCEL(10, 500, 30, 1000), 2001, 10, chart},
    {TECHNOLOGY, "MEMS", "", ACCEL(50, 500, 100, 5000), 2025, 1,
     "[IMULESSON] bias; [GNCTECH2025] accelerometer-scale-factor-accuracy"},
};

/* Prices of whole units. "Under a dollar" is drawn from half a dollar on, "over 100,000" up to
 * twice that. The prices of parts in the catalogue are those of one shop on one day. */
static const imk_map_region unit_prices[] = {
    {CLASS, "strategic", "", PRICE(1e-4, 1e-3, 5e5, 2e6), 2020, 1, survey},
    {CLASS, "navigation", "", PRICE(1e-3, 1e-2, 5e4, 2e5), 2020, 1, survey},
    {CLASS, "tactical", "", PRICE(1, 10, 2e3, 5e4), 2020, 1, survey},
    {TECHNOLOGY, "RLG", "navigation", PRICE(1e-3, 1e-2, 5e4, 2e5), 0, 1, notes},
    {TECHNOLOGY, "FOG", "navigation", PRICE(1e-3, 1e-2, 1e5, 2e5), 0, 1, notes},
    {TECHNOLOGY, "FOG", "tactical", PRICE(2, 5, 2e3, 5e3), 0, 1, notes},
    {TECHNOLOGY, "MEMS", "tactical", PRICE(0.1, 3, 500, 5e3), 0, 1, notes},
    {TECHNOLOGY, "MEMS", "consumer", PRICE(10, 100, 0.5, 1), 0, 1, notes},
    {TECHNOLOGY, "MEMS", "HG4930", PRICE(0.125, 0.5, 8300, 13500), 2026, 1, shop},
    {TECHNOLOGY, "MEMS", "ADIS16470", PRICE(4, 16, 240, 963), 2026, 1, shop},
    {TECHNOLOGY, "MEMS", "VN-100", PRICE(5, 20, 500, 1100), 0, 1, "[ROBOTICSHW] VN-100"},
};

/* Prices of one gyro. The second source states no biases; its "few hundred" begins at 200. */
static const imk_map_region sensor_prices[] = {
    {CLASS, "commercial", "", PRICE(180, 720, 5, 20), 2020, 1, survey},
    {TECHNOLOGY, "RLG, FOG", "", UNSTATED, 200, 1e4, 0, 1, "[GYROSCOPICS] laser gyroscope"},
    {TECHNOLOGY, "wheel", "", UNSTATED, 50, 1e4, 0, 1, "[GYROSCOPICS] spinning mass"},
    {TECHNOLOGY, "Coriolis", "", UNSTATED, 10, 1000, 0, 1, "[GYROSCOPICS] vibrating"},
};

#define ALL(map) sizeof(map) / sizeof(map)[0], map

static const struct {
    size_t count;
    const imk_map_region *regions;
} maps[IMK_GRADE_MAPS] = {
    {ALL(gyro_map)}, {ALL(accel_map)}, {ALL(unit_prices)}, {ALL(sensor_prices)}};

static const imk_technology technologies[] = {
    {"ESG", "electrostatically suspended ball; it reads angles and has no scale factor", true},
    {"floated", "rate-integrating gyro: a wheel in a float in a viscous liquid", true},
    {"DTG", "dynamically tuned gyro: a wheel on flexures", true},
    {"RLG", "ring laser gyro", true},
    {"FOG", "fibre-optic gyro", true},
    {"MEMS", "micromachined vibrating mass of silicon", true},
    {"Coriolis", "vibrating body: fork, ring, shell, beam", true},
    {"wheel", "wheel in gimbals with bearings: rate gyro, free gyro", true},
    {"servo", "pendulum held at zero by a current", false},
    {"vibrating beam", "beams whose frequency changes with their load", false},
    {"MEMS", "micromachined proof mass of silicon", false},
};

static bool is_map(imk_grade_map map)
{
    return (unsigned)map < IMK_GRADE_MAPS;
}

size_t imk_map_region_count(imk_grade_map map)
{
    return is_map(map) ? maps[map].count : 0;
}

const imk_map_region *imk_map_region_get(imk_grade_map map, size_t index)
{
    return is_map(map) && index < maps[map].count ? &maps[map].regions[index] : NULL;
}

const imk_technology *imk_technology_get(size_t index)
{
    return index < sizeof technologies / sizeof technologies[0] ? &technologies[index] : NULL;
}
