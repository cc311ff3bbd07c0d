/* SPDX-License-Identifier: Apache-2.0 */
/* The maps of technologies: complete, sane, with sources that exist, and in agreement with the
 * table of classes. */
#include "check.h"

#include "imukit/technology_map.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const imk_map_region *region_of(imk_grade_map map, size_t index)
{
    return imk_map_region_get(map, index);
}

static char *read_references(void)
{
    FILE *file = fopen(SOURCE_DIRECTORY "/docs/references.md", "rb");
    char *text = calloc(1, 1 << 20);
    assert_non_null(file);
    assert_non_null(text);
    assert_in_range(fread(text, 1, (1 << 20) - 1, file), 1000, (1 << 20) - 2);
    fclose(file);
    return text;
}

/* Every [KEY] of a source is a row of docs/references.md, and every source has one. */
static void sources_are_in_the_references(void **state)
{
    (void)state;
    char *references = read_references();
    const imk_map_region *region;
    for (int map = 0; map < IMK_GRADE_MAPS; map++)
        for (size_t i = 0; (region = region_of((imk_grade_map)map, i)); i++) {
            const char *key = strchr(region->source, '[');
            assert_non_null(key);
            for (; key; key = strchr(key + 1, '[')) {
                char row[80];
                snprintf(row, sizeof row, "\n| %.*s | ", (int)strcspn(key + 1, "]"), key + 1);
                if (!strstr(references, row))
                    fail_msg("%s: no row%s in docs/references.md", region->name, row);
            }
        }
    free(references);
}

/* Limits are positive and in order, within what any sensor has; what is from memory says so in its
 * source, and what was read does not. */
static void ranges_are_sane(void **state)
{
    (void)state;
    const double deg_h = 3.14159265358979323846 / 180 / 3600, ug = 9.80665e-6, ppm = 1e-6;
    const struct {
        double x[2], y[2];
    } limits[IMK_GRADE_MAPS] = {{{ppm, 0.1}, {1e-5 * deg_h, 1e4 * deg_h}},
                                {{ppm, 0.1}, {0.01 * ug, 1e5 * ug}},
                                {{1e-5 * deg_h, 1e4 * deg_h}, {0.1, 1e7}},
                                {{1e-5 * deg_h, 1e4 * deg_h}, {0.1, 1e6}}};
    const imk_map_region *r;
    for (int map = 0; map < IMK_GRADE_MAPS; map++) {
        assert_true(imk_map_region_count((imk_grade_map)map) >= 4);
        for (size_t i = 0; (r = region_of((imk_grade_map)map, i)); i++) {
            assert_true(isnan(r->x_low) == isnan(r->x_high));
            assert_true(isnan(r->x_low) || (r->x_low < r->x_high && r->x_low >= limits[map].x[0] &&
                                            r->x_high <= limits[map].x[1]));
            assert_true(r->y_low < r->y_high && r->y_low >= limits[map].y[0] &&
                        r->y_high <= limits[map].y[1]);
            assert_true(r->year == 0 || (r->year >= 1990 && r->year <= 2026));
            assert_true(r->doubt >= 1);
            assert_int_equal(r->doubt > 1, strncmp(r->source, "from memory of [", 16) == 0);
            assert_non_null(r->detail);
        }
        assert_null(region_of((imk_grade_map)map, imk_map_region_count((imk_grade_map)map)));
    }
    assert_int_equal(imk_map_region_count(IMK_GRADE_MAPS), 0);
    assert_null(region_of(IMK_GRADE_MAPS, 0));
    assert_null(region_of((imk_grade_map)-1, 0));
}

/* "ESG, floated, RLG": the next name of a column. */
static bool next_name(const char **column, char name[40])
{
    const size_t length = strcspn(*column, ",");
    if (length == 0)
        return false;
    snprintf(name, 40, "%.*s", (int)length, *column);
    *column += length + strspn(*column + length, ", ");
    return true;
}

static const imk_technology *technology_of(const char *name, bool gyro)
{
    const imk_technology *t = NULL;
    for (size_t i = 0; (t = imk_technology_get(i)); i++)
        if (t->gyro == gyro && strcmp(t->name, name) == 0)
            break;
    return t;
}

static double limit_of(int grade, bool gyro)
{
    const imk_grade_row *row = imk_grade_table((imk_grade)grade);
    return gyro ? row->gyro_bias_limit : row->accel_bias_limit;
}

/* Limits of a class: those of the next better class with another limit, and its own. */
static void class_range(int grade, bool gyro, double range[2])
{
    range[0] = 0;
    range[1] = limit_of(grade, gyro);
    for (int g = 0; g < grade; g++)
        range[0] = limit_of(g, gyro) < range[1] ? limit_of(g, gyro) : range[0];
}

/* Each technology that the table names in a class has a region on the map of its kind of sensor,
 * and one of them reaches into the biases of the class. */
static void table_and_maps_agree(void **state)
{
    (void)state;
    size_t named = 0;
    for (int g = 0; g < IMK_GRADE_NONE; g++)
        for (int gyro = 0; gyro < 2; gyro++) {
            const imk_grade_row *row = imk_grade_table((imk_grade)g);
            const char *column = gyro ? row->gyro_technology : row->accel_technology;
            char name[40];
            double range[2];
            class_range(g, gyro, range);
            for (; next_name(&column, name); named++) {
                const imk_map_region *r;
                bool reaches = false;
                assert_non_null(technology_of(name, gyro));
                for (size_t i = 0;
                     (r = region_of(gyro ? IMK_GRADE_MAP_GYRO : IMK_GRADE_MAP_ACCEL, i)); i++)
                    if (r->kind == IMK_MAP_TECHNOLOGY && strcmp(r->name, name) == 0)
                        reaches = reaches || (r->y_low <= range[1] && r->y_high > range[0]);
                if (!reaches)
                    fail_msg("no region of %s reaches into %s", name, row->name);
            }
        }
    assert_int_equal(named, 18 + 8); /* of the printed table and our additions: docs/theory */
}

/* Nothing on the maps or in the list that the table does not have; the tuned and the floated gyros
 * are there along both axes. */
static void technologies_are_those_of_the_table(void **state)
{
    (void)state;
    const imk_technology *t;
    size_t both = 0;
    for (size_t i = 0; (t = imk_technology_get(i)); i++) {
        bool found = false;
        for (int g = 0; g < IMK_GRADE_NONE; g++) {
            const imk_grade_row *row = imk_grade_table((imk_grade)g);
            const char *column = t->gyro ? row->gyro_technology : row->accel_technology;
            char name[40];
            while (next_name(&column, name))
                found = found || strcmp(name, t->name) == 0;
        }
        assert_true(found);
        assert_true(strlen(t->meaning) > 5);
    }
    for (int map = 0; map < IMK_GRADE_MAPS; map++) {
        const imk_map_region *r;
        for (size_t i = 0; (r = region_of((imk_grade_map)map, i)); i++) {
            const char *names = r->name;
            char name[40];
            while (r->kind == IMK_MAP_TECHNOLOGY && next_name(&names, name))
                assert_non_null(technology_of(name, map != IMK_GRADE_MAP_ACCEL));
            if (strcmp(r->name, "DTG") == 0 || strcmp(r->name, "floated") == 0)
                both += !isnan(r->x_low);
        }
    }
    assert_int_equal(both, 2);
}

/* A better class costs more [ELSHEIMY2020, table 1: 1 million, 100,000, 2,000 to 50,000 dollars],
 * and a gyro less than a unit of the same source. */
static void prices_are_in_order(void **state)
{
    (void)state;
    double price[3][2], bias[3];
    int found = 0;
    const imk_map_region *r;
    for (size_t i = 0; (r = region_of(IMK_GRADE_MAP_COST, i)); i++)
        if (r->kind == IMK_MAP_CLASS) {
            assert_true(found < 3);
            price[found][0] = r->y_low;
            price[found][1] = r->y_high;
            bias[found++] = r->x_high;
        }
    assert_int_equal(found, 3);
    for (int k = 0; k < 2; k++) {
        assert_true(price[k][0] >= price[k + 1][1] * (1 - 1e-12));
        assert_true(bias[k] < bias[k + 1]);
    }
    assert_true(price[0][0] <= 1e6 && price[0][1] >= 1e6 && price[1][0] <= 1e5 &&
                price[1][1] >= 1e5 && price[2][0] == 2000 && price[2][1] == 50000);
    r = region_of(IMK_GRADE_MAP_SENSOR_COST, 0);
    assert_true(r->kind == IMK_MAP_CLASS && r->y_low <= 10 && r->y_high >= 10 &&
                r->y_high < price[2][0]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sources_are_in_the_references),
        cmocka_unit_test(ranges_are_sane),
        cmocka_unit_test(table_and_maps_agree),
        cmocka_unit_test(technologies_are_those_of_the_table),
        cmocka_unit_test(prices_are_in_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
