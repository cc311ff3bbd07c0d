/* SPDX-License-Identifier: Apache-2.0 */
/* The axes of the maps, where a model stands on them, and what the map says about that. Models are
 * drawn at what remains of bias and scale factor after calibration. */
#include "grade_show_internal.h"

#include <math.h>
#include <stdio.h>

#define SCALE_FACTOR                                                                               \
    {                                                                                              \
        "stability of the scale factor [ppm]", "ppm", "scale factor", 0.1, 1e5                     \
    }
#define GYRO_BIAS                                                                                  \
    {                                                                                              \
        "stability of the bias [deg/h]", "deg/h", "bias", 1e-5, 1e5                                \
    }

static const imki_grade_map maps[IMK_GRADE_MAPS] = {
    {"gyro", "Gyros: technologies, classes and applications",
     "Coloured boxes are technologies, black ones classes, grey bands applications; the sources of "
     "the bands state no scale factors.",
     "Dashed outlines: limits from memory; each may be wrong by a factor of ten.\n"
     "ESG, at the left edge, has no scale factor: its place along this axis means nothing.",
     SCALE_FACTOR, GYRO_BIAS},
    {"accel",
     "Accelerometers: technologies and applications",
     "Coloured boxes are technologies, grey bands applications; the sources of the bands state no "
     "scale factors.",
     "Dashed outlines: limits from memory; each may be wrong by a factor of ten.",
     SCALE_FACTOR,
     {"stability of the bias [ug]", "ug", "bias", 0.01, 1e6}},
    {"cost",
     "Price of a whole unit against the bias of its gyros",
     "A published single number is drawn as a range of a factor of two to either side. No price of "
     "a unit with floated or tuned gyros was found.",
     "Prices of whole units only. Models state no price: the height of their lines means nothing.",
     {"stability of the gyro bias [deg/h]", "deg/h", "gyro bias", 1e-5, 1e5},
     {"price of a whole unit [US dollars]", "1", "price", 0.1, 1e7}},
    {"sensor_cost",
     "Price of one gyro against its bias",
     "A published single number is drawn as a range of a factor of two to either side. One "
     "accelerometer of the commercial class costs about 1 dollar [ELSHEIMY2020]; no other price of "
     "one accelerometer was found.",
     "Prices of single gyros only. Bands: the source states no bias. Models state no price: the "
     "height of their lines means nothing.",
     {"stability of the bias [deg/h]", "deg/h", "gyro bias", 1e-5, 1e5},
     {"price of one gyro [US dollars]", "1", "price", 0.1, 1e6}},
};

const imki_grade_map *imki_grade_map_of(int map)
{
    return &maps[map];
}

static bool has_prices(int map)
{
    return map == IMK_GRADE_MAP_COST || map == IMK_GRADE_MAP_SENSOR_COST;
}

static imki_placing place_on(const imki_map_axis *axis, double value, double *at)
{
    const double drawn = isnan(value) ? value : value / imk_unit_of(axis->unit).scale;
    *at = fmin(fmax(drawn, axis->low), axis->high);
    if (isnan(value))
        *at = (double)NAN;
    return isnan(value) ? IMKI_UNSTATED : *at < drawn || *at > drawn ? IMKI_OUTSIDE : IMKI_PLACED;
}

imki_grade_place imki_grade_place_of(const imk_graded *one, int map)
{
    const double gyro = one->table.gyro_bias, none = (double)NAN;
    imki_grade_place place = {.x = one->gyro_scale, .y = gyro};
    if (map == IMK_GRADE_MAP_ACCEL)
        place = (imki_grade_place){.x = one->accel_scale, .y = one->table.accel_bias};
    if (has_prices(map))
        place = (imki_grade_place){.x = gyro, .y = none};
    place.how[0] = place_on(&maps[map].x, place.x, &place.at[0]);
    place.how[1] = has_prices(map) ? IMKI_UNSTATED : place_on(&maps[map].y, place.y, &place.at[1]);
    if (has_prices(map))
        place.at[1] = none;
    return place;
}

bool imki_grade_is_drawn(const imki_grade_place *place)
{
    return place->how[0] != IMKI_UNSTATED || place->how[1] != IMKI_UNSTATED;
}

bool imk_grade_stands(const imk_graded_several *r, imk_grade_map map)
{
    for (int i = 0; i < IMK_GRADE_MAPS; i++)
        for (size_t m = 0; m < r->count && (map == IMK_GRADE_MAPS || i == (int)map); m++) {
            const imki_grade_place place = imki_grade_place_of(r->graded[m], i);
            if (imki_grade_is_drawn(&place))
                return true;
        }
    return false;
}

/* ---- words ---- */

static void add_line(imki_text *note, const char *text)
{
    imki_text_add(note, "%s%s", note->size > 0 ? "\n" : "", text);
}

/* The axis along which the place of a model is not that of its value. */
static void add_axis(const char *name, const char *quantity, imki_placing how, imki_text *note)
{
    char line[200];
    snprintf(line, sizeof line,
             how == IMKI_UNSTATED
                 ? "%.40s states no %s: a dashed line, whose place along that axis means nothing."
                 : "%.40s has its %s outside the map: drawn at the edge, which is not its place.",
             name, quantity);
    add_line(note, line);
}

static void add_model(const imk_graded *one, const char *name, int map, imki_text *note)
{
    const imki_grade_place place = imki_grade_place_of(one, map);
    const imki_map_axis *axes[] = {&maps[map].x, &maps[map].y};
    char line[200];
    if (!imki_grade_is_drawn(&place)) {
        snprintf(line, sizeof line, "%.40s states no %s%s%s: it is not on this map.", name,
                 axes[0]->quantity, has_prices(map) ? "" : " and no ",
                 has_prices(map) ? "" : axes[1]->quantity);
        add_line(note, line);
        return;
    }
    const bool is_best =
        map == IMK_GRADE_MAP_ACCEL ? one->table.accel_at_best : one->table.gyro_at_best;
    if (is_best) {
        snprintf(line, sizeof line,
                 "%.40s does not state all of its bias: its place is the best that is possible.",
                 name);
        add_line(note, line);
    }
    for (int k = 0; k < 2; k++)
        if (place.how[k] == IMKI_OUTSIDE ||
            (place.how[k] == IMKI_UNSTATED && !(k == 1 && has_prices(map))))
            add_axis(name, axes[k]->quantity, place.how[k], note);
}

void imki_grade_note(const imk_graded_several *r, int map, imki_text *note)
{
    add_line(note, maps[map].note);
    for (size_t m = 0; m < r->count; m++)
        add_model(r->graded[m], r->name[m], map, note);
}

/* ---- data ---- */

void imki_show_place_data(const imk_graded *one, imk_result *result)
{
    static const char *const words[] = {"stated", "not stated", "outside the map"};
    imk_result_object(result, "places");
    for (int map = 0; map < IMK_GRADE_MAPS; map++) {
        const imki_grade_place place = imki_grade_place_of(one, map);
        imk_result_object(result, maps[map].key);
        imk_result_flag(result, "drawn", imki_grade_is_drawn(&place));
        imk_result_text(result, "x", words[place.how[0]]);
        imk_result_text(result, "y", words[place.how[1]]);
        imk_result_end(result);
    }
    imk_result_end(result);
}
