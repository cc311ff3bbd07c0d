/* SPDX-License-Identifier: Apache-2.0 */
/* A table of positions and attitudes as a trajectory.
 *
 * Every row becomes an Earth-fixed position r and a quaternion q_eb = q_en q_nb. With positions in
 * latitude, longitude and height, or Earth-fixed, the axes n are north, east and down at the row's
 * own place. Local positions x, y, z lie in the axes n0 at the place where they begin, and so do
 * the attitudes:  r = r0 + C_en0 (x, y, z). */
#include "geodetic_difference_internal.h"
#include "motion_file_internal.h"

#include "imukit/units.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SET_MAX = 4, SPELLINGS = 4 };

typedef enum set_kind { GEODETIC, EARTH_FIXED, LOCAL, EULER, QUATERNION, SETS } set_kind;

/* Columns that belong together. */
typedef struct column_set {
    const char *what;
    struct {
        const char *name[SPELLINGS]; /* in lower case */
        const char *si;
        double limit; /* of its magnitude, in degrees or as `si` says; 0: assessed otherwise */
    } column[SET_MAX];
} column_set;

static const column_set sets[SETS] = {
    [GEODETIC] = {"position",
                  {{{"latitude", "lat"}, "rad", 90.0},
                   {{"longitude", "lon"}, "rad", 360.0},
                   {{"height", "altitude", "alt", "h"}, "m", 1e7}}},
    [EARTH_FIXED] = {"position",
                     {{{"ecef_x", "x_ecef"}, "m", 1.64e7},
                      {{"ecef_y", "y_ecef"}, "m", 1.64e7},
                      {{"ecef_z", "z_ecef"}, "m", 1.64e7}}},
    [LOCAL] = {"position",
               {{{"x", "north"}, "m", 1e7}, {{"y", "east"}, "m", 1e7}, {{"z", "down"}, "m", 1e7}}},
    [EULER] = {"attitude",
               {{{"roll"}, "rad", 1e7}, {{"pitch"}, "rad", 1e7}, {{"yaw", "heading"}, "rad", 1e7}}},
    [QUATERNION] = {"attitude",
                    {{{"q_w", "qw"}, "1", 0.0},
                     {{"q_x", "qx"}, "1", 0.0},
                     {{"q_y", "qy"}, "1", 0.0},
                     {{"q_z", "qz"}, "1", 0.0}}},
};

static size_t members(const column_set *set)
{
    return set == &sets[QUATERNION] ? 4 : 3;
}

static const double degree = 3.14159265358979323846 / 180.0;

/* A quaternion of rounded digits may be off by this much in length. */
static const double norm_tolerance = 0.01;

/* Cosine of half of 120 deg, the largest turn whose way is taken to be known. */
static const double half_turn_cosine = 0.5;

/* ---- columns --------------------------------------------------------------------------------- */

static bool same_name(const char *text, const char *lower)
{
    while (*text != '\0' && tolower((unsigned char)*text) == *lower) {
        text++;
        lower++;
    }
    return *text == '\0' && *lower == '\0';
}

/* Column `member` of a set; -1 when it is not there. *twice says that it has two. */
static int find_column(const imk_log *log, const column_set *set, size_t member, bool *twice)
{
    int found = -1;
    for (size_t i = 0; i < log->column_count; i++)
        for (size_t j = 0; j < SPELLINGS && set->column[member].name[j]; j++)
            if (log->column[i].quantity == IMK_QUANTITY_OTHER &&
                same_name(log->column[i].name, set->column[member].name[j])) {
                *twice = found >= 0;
                found = (int)i;
            }
    return found;
}

static bool has_set(const imk_log *log, const column_set *set)
{
    bool unused;
    for (size_t i = 0; i < members(set); i++)
        if (find_column(log, set, i, &unused) >= 0)
            return true;
    return false;
}

bool imki_has_poses(const imk_log *log)
{
    for (size_t i = 0; i < SETS; i++)
        if (has_set(log, &sets[i]))
            return true;
    return false;
}

/* The columns of a set, all of them, checked. */
static imk_status take_set(const imk_log *log, const column_set *set, const double **column,
                           imk_error *error)
{
    const size_t count = members(set);
    for (size_t i = 0; i < count; i++) {
        bool twice = false;
        const char *name = set->column[i].name[0];
        const int found = find_column(log, set, i, &twice);
        char expected[96];
        if (found < 0) {
            snprintf(expected, sizeof expected, "the columns %s, %s%s%s and %s go together",
                     set->column[0].name[0], set->column[1].name[0], count == 4 ? ", " : "",
                     count == 4 ? set->column[2].name[0] : "", set->column[count - 1].name[0]);
            return imk_error_set(error, IMK_ERROR_COLUMN, name, "this column is missing", expected);
        }
        if (twice)
            return imk_error_set(error, IMK_ERROR_COLUMN, name, "this column is in the table twice",
                                 "remove one of the two columns");
        const imk_status status =
            imki_table_column_check(log, (size_t)found, set->column[i].si, error);
        if (status != IMK_OK)
            return status;
        column[i] = log->data[found];
    }
    return IMK_OK;
}

/* Which one of the sets first … last the table has; SETS when it has none. */
static imk_status choose(const imk_log *log, set_kind first, set_kind last, set_kind *chosen,
                         imk_error *error)
{
    *chosen = SETS;
    for (size_t i = first; i <= (size_t)last; i++) {
        if (!has_set(log, &sets[i]))
            continue;
        if (*chosen != SETS) {
            char found[96];
            snprintf(found, sizeof found, "%s and %s are two descriptions of the %s",
                     sets[*chosen].column[0].name[0], sets[i].column[0].name[0], sets[i].what);
            return imk_error_set(error, IMK_ERROR_CONFLICT, "", found,
                                 "remove the columns of one of the two");
        }
        *chosen = (set_kind)i;
    }
    return IMK_OK;
}

/* ---- rows ------------------------------------------------------------------------------------ */

typedef struct pose_table {
    size_t rows;
    set_kind position, attitude; /* SETS: at the place; level, heading north */
    const double *p[SET_MAX], *a[SET_MAX];
    imk_vector3 origin;     /* Earth-fixed, of the first row */
    imk_matrix3 local_axes; /* C_en0 */
    double *relative[3];    /* Earth-fixed, from the origin */
    imk_quaternion *turn;   /* q_eb */
} pose_table;

static imk_geodetic place_of(const pose_table *t, size_t row)
{
    return (imk_geodetic){t->p[0][row], t->p[1][row], t->p[2][row]};
}

static imk_vector3 ecef_of(const pose_table *t, size_t row)
{
    return (imk_vector3){{t->p[0][row], t->p[1][row], t->p[2][row]}};
}

/* Position from the origin, and the axes in which the row's attitude is stated. */
static imk_vector3 position_of(const pose_table *t, size_t row, imk_matrix3 *axes)
{
    imk_geodetic place;
    imk_vector3 position = {{0.0, 0.0, 0.0}};
    *axes = t->local_axes;
    switch (t->position) {
    case LOCAL:
        return imk_matrix3_apply(t->local_axes, ecef_of(t, row));
    case GEODETIC:
        place = place_of(t, row);
        position = imki_geodetic_difference(place_of(t, 0), place);
        break;
    case EARTH_FIXED:
        place = imk_geodetic_from_ecef(ecef_of(t, row));
        position = imk_vector3_subtract(ecef_of(t, row), t->origin);
        break;
    default:
        return position;
    }
    *axes = imk_ned_axes(place.latitude, place.longitude);
    return position;
}

static imk_status attitude_of(const pose_table *t, size_t row, imk_quaternion *q_nb,
                              imk_error *error)
{
    *q_nb = imk_quaternion_identity();
    if (t->attitude == EULER)
        *q_nb = imk_quaternion_from_matrix(
            imk_matrix3_from_euler(t->a[0][row], t->a[1][row], t->a[2][row]));
    if (t->attitude != QUATERNION)
        return IMK_OK;
    *q_nb = (imk_quaternion){t->a[0][row], t->a[1][row], t->a[2][row], t->a[3][row]};
    const double norm =
        sqrt(q_nb->w * q_nb->w + q_nb->x * q_nb->x + q_nb->y * q_nb->y + q_nb->z * q_nb->z);
    if (!(fabs(norm - 1.0) <= norm_tolerance)) {
        char found[64];
        snprintf(found, sizeof found, "\"%.6g\" is the length of the quaternion", norm);
        return imki_table_row_error("q_w", IMK_ERROR_RANGE, row + 1, found,
                                    "a length of 1, up to the rounding of the digits", error);
    }
    *q_nb = imk_quaternion_normalise(*q_nb);
    return IMK_OK;
}

static imk_status check_turn(const pose_table *t, size_t row, imk_error *error)
{
    const imk_quaternion a = t->turn[row - 1], b = t->turn[row];
    const double cosine = fabs(a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z);
    if (cosine >= half_turn_cosine)
        return IMK_OK;
    char found[64];
    snprintf(found, sizeof found, "\"%.6g deg\" is the rotation since the row before",
             2.0 * acos(cosine) / degree);
    return imki_table_row_error("attitude", IMK_ERROR_RANGE, row + 1, found,
                                "at most 120 deg from row to row, so that its direction is clear",
                                error);
}

/* Numbers that no motion near the Earth has: an angle so large has lost its digits. */
static imk_status check_limits(size_t rows, const column_set *set, const double *const *column,
                               imk_error *error)
{
    for (size_t i = 0; i < members(set); i++) {
        const double limit = set->column[i].limit;
        const bool is_angle = strcmp(set->column[i].si, "rad") == 0;
        const double unit = is_angle ? degree : 1.0;
        const char *const name = is_angle ? "deg" : set->column[i].si;
        for (size_t row = 0; limit > 0.0 && row < rows; row++) {
            if (fabs(column[i][row]) <= limit * unit)
                continue;
            char found[64], expected[64];
            snprintf(found, sizeof found, "\"%.10g %s\" is beyond %s", column[i][row] / unit, name,
                     limit == 90.0 ? "a pole" : "the limit");
            snprintf(expected, sizeof expected, "between -%.10g %s and %.10g %s", limit, name,
                     limit, name);
            return imki_table_row_error(set->column[i].name[0], IMK_ERROR_RANGE, row + 1, found,
                                        expected, error);
        }
    }
    return IMK_OK;
}

/* As imk_trajectory_validate() has it: gravity is known there. */
static imk_status check_place(const pose_table *t, size_t row, imk_vector3 relative,
                              imk_error *error)
{
    const double radius = imk_vector3_norm(imk_vector3_add(t->origin, relative));
    if (radius >= 6.34e6 && radius <= 1.64e7)
        return IMK_OK;
    char found[80];
    snprintf(found, sizeof found, "\"%.10g km\" is the distance from the centre of the Earth",
             radius / 1000.0);
    return imki_table_row_error("position", IMK_ERROR_RANGE, row + 1, found, "6340 km to 16400 km",
                                error);
}

static imk_status convert(pose_table *t, imk_error *error)
{
    if (t->position == GEODETIC)
        t->origin = imk_ecef_from_geodetic(place_of(t, 0));
    if (t->position == EARTH_FIXED)
        t->origin = ecef_of(t, 0);
    for (size_t row = 0; row < t->rows; row++) {
        imk_matrix3 axes;
        const imk_vector3 position = position_of(t, row, &axes);
        imk_quaternion q_nb;
        imk_status status = check_place(t, row, position, error);
        if (status == IMK_OK)
            status = attitude_of(t, row, &q_nb, error);
        if (status != IMK_OK)
            return status;
        for (int i = 0; i < 3; i++)
            t->relative[i][row] = position.v[i];
        t->turn[row] = imk_quaternion_multiply(imk_quaternion_from_matrix(axes), q_nb);
        status = row > 0 ? check_turn(t, row, error) : IMK_OK;
        if (status != IMK_OK)
            return status;
    }
    return IMK_OK;
}

/* ---- the trajectory -------------------------------------------------------------------------- */

/* Say what was assumed and what was not used. */
static void note(const imk_log *log, const pose_table *t, imk_motion_file *file)
{
    size_t used = imk_log_find(log, IMK_QUANTITY_TIME, -1) >= 0 ? 1 : 0;
    used += t->position == SETS ? 0 : members(&sets[t->position]);
    used += t->attitude == SETS ? 0 : members(&sets[t->attitude]);
    const size_t others = log->column_count - used;
    char ignored[64] = "";
    if (others > 0)
        snprintf(ignored, sizeof ignored, "%zu column%s not used", others,
                 others == 1 ? " is" : "s are");
    const char *assumed =
        t->position == SETS   ? "the table has no position: the unit stays at its place"
        : t->attitude == SETS ? "the table has no attitude: the unit is level, heading north"
                              : "";
    snprintf(file->note, sizeof file->note, "%s%s%s", assumed, assumed[0] && ignored[0] ? "; " : "",
             ignored);
}

/* What the library says of step `index` of time, as it is said of rows. */
static imk_status refuse_step(imk_status status, imk_error *error)
{
    if (!error || status != IMK_ERROR_RANGE || strcmp(error->field, "time") != 0)
        return status;
    char found[64];
    snprintf(found, sizeof found, "\"%g s\" is the time since the row before", error->value);
    return imki_table_row_error("time", status, (size_t)error->index + 1, found,
                                "a step of time from 1 ns to 1e9 s", error);
}

/* One allocation for the positions, the quaternions and the workspace. */
static imk_status build(pose_table *t, const double *time, imk_motion_file *file, imk_error *error)
{
    const size_t size = imk_trajectory_poses_workspace_size(t->rows);
    double *memory = malloc(3 * t->rows * sizeof *memory + size);
    t->turn = malloc(t->rows * sizeof *t->turn);
    file->piece = calloc(t->rows, sizeof *file->piece);
    imk_status status = memory && t->turn && file->piece
                            ? IMK_OK
                            : imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    if (status == IMK_OK) {
        for (size_t i = 0; i < 3; i++)
            t->relative[i] = memory + i * t->rows;
        status = convert(t, error);
    }
    if (status == IMK_OK) {
        const double *const position[3] = {t->relative[0], t->relative[1], t->relative[2]};
        status = imk_trajectory_from_poses(t->rows, time, position, t->turn, file->piece,
                                           memory + 3 * t->rows, size, error);
        status = refuse_step(status, error);
    }
    free(memory);
    free(t->turn);
    return status;
}

/* Rows may each be sound, and yet no polynomials lead through all of them: a second beside days, a
 * leap across the Earth. */
static imk_status check_way(const imk_trajectory *trajectory, imk_error *error)
{
    imk_error of_piece = {.status = IMK_OK};
    const imk_status status = imk_trajectory_validate(trajectory, &of_piece);
    if (status == IMK_OK)
        return IMK_OK;
    const size_t row = of_piece.index >= 0 ? (size_t)of_piece.index + 1 : 1;
    return imki_table_row_error("poses", IMK_ERROR_CONFLICT, row,
                                "the rows around this one cannot be joined by a smooth motion",
                                "split the table at this row, or fill the gap", error);
}

imk_status imki_poses_open(const imk_log *log, const double *time, const imk_geodetic *place,
                           imk_motion_file *file, imk_error *error)
{
    pose_table t = {.rows = log->rows};
    const imk_geodetic where = place ? *place : imki_default_place();
    imk_status status = choose(log, GEODETIC, LOCAL, &t.position, error);
    if (status == IMK_OK)
        status = choose(log, EULER, QUATERNION, &t.attitude, error);
    if (status == IMK_OK && t.position != SETS)
        status = take_set(log, &sets[t.position], t.p, error);
    if (status == IMK_OK && t.attitude != SETS)
        status = take_set(log, &sets[t.attitude], t.a, error);
    if (status == IMK_OK && t.position != SETS)
        status = check_limits(t.rows, &sets[t.position], t.p, error);
    if (status == IMK_OK && t.attitude != SETS)
        status = check_limits(t.rows, &sets[t.attitude], t.a, error);
    if (status != IMK_OK)
        return status;
    t.origin = imk_ecef_from_geodetic(where);
    t.local_axes = imk_ned_axes(where.latitude, where.longitude);
    status = build(&t, time, file, error);
    if (status != IMK_OK)
        return status;
    note(log, &t, file);
    file->trajectory = (imk_trajectory){.earth = true,
                                        .origin = {t.origin.v[0], t.origin.v[1], t.origin.v[2]},
                                        .piece_count = t.rows - 1,
                                        .piece = file->piece};
    file->kind = IMK_MOTION_POSES;
    file->motion.trajectory = &file->trajectory;
    return check_way(&file->trajectory, error);
}
