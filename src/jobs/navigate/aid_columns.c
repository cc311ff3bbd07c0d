/* SPDX-License-Identifier: Apache-2.0 */
/* Names of the columns of aids, as receivers and programs write them: signs and blanks do not
 * count, nor capitals, nor "gnss", "gps", "aid" or "ref" in front. Units are never guessed. */
#include "aid_columns_internal.h"

#include "jobs/job_internal.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

enum { NAME_SIZE = 48 };

/* Names of one column, with blanks between; those in `opposite` count the other way. */
static const struct {
    const char *what, *names, *opposite, *unit;
} roles[IMKI_AID_ROLES] = {
    [IMKI_AID_GEODETIC] = {"latitude", "latitude lat", "", "deg"},
    [IMKI_AID_GEODETIC + 1] = {"longitude", "longitude lon lng long", "", "deg"},
    [IMKI_AID_GEODETIC + 2] = {"height", "height altitude alt hgt h ellipsoidalheight", "", "m"},
    [IMKI_AID_EARTH_FIXED] = {"ecef_x", "ecefx xecef", "", "m"},
    [IMKI_AID_EARTH_FIXED + 1] = {"ecef_y", "ecefy yecef", "", "m"},
    [IMKI_AID_EARTH_FIXED + 2] = {"ecef_z", "ecefz zecef", "", "m"},
    [IMKI_AID_LOCAL] = {"north", "north posnorth positionnorth posn positionn", "", "m"},
    [IMKI_AID_LOCAL + 1] = {"east", "east poseast positioneast pose positione", "", "m"},
    [IMKI_AID_LOCAL + 2] = {"down", "down posdown positiondown posd positiond",
                            "up posup positionup posu positionu", "m"},
    [IMKI_AID_VELOCITY] = {"velocity_north",
                           "velocitynorth velnorth vnorth vn veln velocityn speednorth", "", "m/s"},
    [IMKI_AID_VELOCITY + 1] = {"velocity_east",
                               "velocityeast veleast veast ve vele velocitye speedeast", "", "m/s"},
    [IMKI_AID_VELOCITY + 2] = {"velocity_down",
                               "velocitydown veldown vdown vd veld velocityd speeddown",
                               "velocityup velup vup vu velu velocityu speedup", "m/s"},
    [IMKI_AID_HEADING] = {"heading", "heading trueheading yaw azimuth", "", "deg"},
    [IMKI_AID_HEIGHT] = {"baro_height",
                         "baroheight barometricheight baroaltitude baroalt barometricaltitude "
                         "pressureheight pressurealtitude",
                         "", "m"},
    [IMKI_AID_SPEED] = {"speed",
                        "speed forwardspeed odometer odometerspeed wheelspeed vehiclespeed "
                        "velocityforward velforward",
                        "", "m/s"},
    [IMKI_AID_SIGMA_POSITION] = {"sigma_north", "sigmanorth sdn stdnorth sigmalatitude", "", "m"},
    [IMKI_AID_SIGMA_POSITION + 1] = {"sigma_east", "sigmaeast sde stdeast sigmalongitude", "", "m"},
    [IMKI_AID_SIGMA_POSITION + 2] = {"sigma_down", "sigmadown sigmaup sdu stdup stddown", "", "m"},
    [IMKI_AID_SIGMA_VELOCITY] = {"sigma_velocity_north", "sigmavelocitynorth sigmavelnorth sdvn",
                                 "", "m/s"},
    [IMKI_AID_SIGMA_VELOCITY + 1] = {"sigma_velocity_east", "sigmavelocityeast sigmaveleast sdve",
                                     "", "m/s"},
    [IMKI_AID_SIGMA_VELOCITY + 2] = {"sigma_velocity_down",
                                     "sigmavelocitydown sigmaveldown sigmavelocityup sigmavelup "
                                     "sdvu sdvd",
                                     "", "m/s"},
    [IMKI_AID_SIGMA_HEADING] = {"sigma_heading", "sigmaheading sigmayaw stdheading", "", "deg"},
    [IMKI_AID_SIGMA_HEIGHT] = {"sigma_baro_height",
                               "sigmabaroheight sigmabaroaltitude sigmaheight sigmaaltitude", "",
                               "m"},
    [IMKI_AID_SIGMA_SPEED] = {"sigma_speed", "sigmaspeed sigmaforwardspeed sigmawheelspeed", "",
                              "m/s"},
};

/* Small letters and figures alone. */
static void plain_name(const char *name, char text[NAME_SIZE])
{
    static const char *const fronts[] = {"gnss", "gps", "aid", "ref"};
    size_t length = 0;
    for (; *name && length + 1 < NAME_SIZE; name++)
        if (isalnum((unsigned char)*name))
            text[length++] = (char)tolower((unsigned char)*name);
    text[length] = '\0';
    for (size_t k = 0; k < sizeof fronts / sizeof *fronts; k++) {
        const size_t front = strlen(fronts[k]);
        if (strncmp(text, fronts[k], front) == 0 && text[front]) {
            memmove(text, text + front, length - front + 1);
            return;
        }
    }
}

static bool is_listed(const char *name, const char *list)
{
    const size_t length = strlen(name);
    for (const char *at = list; length > 0 && (at = strstr(at, name)) != NULL; at += length)
        if ((at == list || at[-1] == ' ') && (at[length] == ' ' || at[length] == '\0'))
            return true;
    return false;
}

static imk_status check_unit(const imk_log_column *column, int role, imk_findings *findings,
                             imk_error *error)
{
    const imk_dimension due = imk_unit_of(roles[role].unit).dimension;
    char text[96];
    if (imk_dimension_equal(column->unit.dimension, due))
        return IMK_OK;
    snprintf(text, sizeof text, "%s\t%s", column->name, roles[role].unit);
    return column->unit.text[0] == '\0'
               ? imki_fail(findings, error, IMK_ERROR_UNIT_MISSING, "aid_unit", text, 0, NULL)
               : imki_fail(findings, error, IMK_ERROR_DIMENSION, "aid_dimension", text, 0, NULL);
}

/* Of what goes together, all or nothing; the third may be missing. */
static imk_status check_set(const imki_aid_columns *found, imki_aid_role first, bool third,
                            imk_findings *findings, imk_error *error)
{
    const int *c = found->column + first;
    char text[96];
    if ((c[0] >= 0) == (c[1] >= 0) && (c[2] < 0 || c[0] >= 0) && (c[0] < 0 || c[2] >= 0 || third))
        return IMK_OK;
    const int lacking = c[0] < 0 ? 0 : c[1] < 0 ? 1 : 2;
    const int there = c[0] >= 0 ? 0 : c[1] >= 0 ? 1 : 2;
    snprintf(text, sizeof text, "%s\t%s", roles[(int)first + there].what,
             roles[(int)first + lacking].what);
    return imki_fail(findings, error, IMK_ERROR_COLUMN, "aid_partial", text, 0, NULL);
}

void imki_aid_columns_find(size_t count, const imk_log_column *columns, imki_aid_columns *found)
{
    found->time = -1;
    for (int role = 0; role < IMKI_AID_ROLES; role++) {
        found->column[role] = -1;
        found->sign[role] = 1.0;
        found->twice[role] = false;
    }
    for (size_t i = 0; i < count; i++) {
        char name[NAME_SIZE];
        if (columns[i].quantity == IMK_QUANTITY_TIME && found->time < 0)
            found->time = (int)i;
        if (columns[i].quantity != IMK_QUANTITY_OTHER || columns[i].label)
            continue;
        plain_name(columns[i].name, name);
        for (int role = 0; role < IMKI_AID_ROLES; role++) {
            const bool opposite = is_listed(name, roles[role].opposite);
            if (!opposite && !is_listed(name, roles[role].names))
                continue;
            found->twice[role] = found->column[role] >= 0;
            found->column[role] = (int)i;
            found->sign[role] = opposite ? -1.0 : 1.0;
        }
    }
    /* A height alone is one. */
    int *place = found->column + IMKI_AID_GEODETIC;
    if (place[0] < 0 && place[1] < 0 && place[2] >= 0 && found->column[IMKI_AID_HEIGHT] < 0) {
        found->column[IMKI_AID_HEIGHT] = place[2];
        found->twice[IMKI_AID_HEIGHT] = found->twice[IMKI_AID_GEODETIC + 2];
        place[2] = -1;
    }
}

imk_status imki_aid_columns_check(const imk_log_column *columns, const imki_aid_columns *found,
                                  imk_aid_kind kind, bool sigmas, imk_findings *findings,
                                  imk_error *error)
{
    const imki_aid_role first[2] = {imki_aid_columns_of(found, kind),
                                    sigmas ? imki_aid_sigmas_of(found, kind) : IMKI_AID_ROLES};
    imk_status status = IMK_OK;
    for (int k = 0; k < 2; k++) {
        const int count = kind == IMK_AID_POSITION || kind == IMK_AID_VELOCITY ? 3 : 1;
        for (int i = 0; i < count && first[k] < IMKI_AID_ROLES && status == IMK_OK; i++) {
            const int role = (int)first[k] + i;
            if (found->twice[role])
                status = imki_fail(findings, error, IMK_ERROR_COLUMN, "aid_twice", roles[role].what,
                                   0, NULL);
            else if (found->column[role] >= 0)
                status = check_unit(&columns[found->column[role]], role, findings, error);
        }
        if (count == 3 && first[k] < IMKI_AID_ROLES && status == IMK_OK)
            status = check_set(found, first[k], first[k] != IMKI_AID_EARTH_FIXED, findings, error);
    }
    return status;
}

imki_aid_role imki_aid_columns_of(const imki_aid_columns *columns, imk_aid_kind kind)
{
    static const imki_aid_role places[] = {IMKI_AID_GEODETIC, IMKI_AID_EARTH_FIXED, IMKI_AID_LOCAL};
    const imki_aid_role one = kind == IMK_AID_VELOCITY   ? IMKI_AID_VELOCITY
                              : kind == IMK_AID_HEADING  ? IMKI_AID_HEADING
                              : kind == IMK_AID_HEIGHT   ? IMKI_AID_HEIGHT
                              : kind == IMK_AID_ODOMETER ? IMKI_AID_SPEED
                                                         : IMKI_AID_ROLES;
    for (size_t k = 0; k < 3 && kind == IMK_AID_POSITION; k++)
        if (columns->column[places[k]] >= 0 || columns->column[(int)places[k] + 1] >= 0)
            return places[k];
    const bool found =
        one < IMKI_AID_ROLES && (columns->column[one] >= 0 ||
                                 (kind == IMK_AID_VELOCITY && columns->column[(int)one + 1] >= 0));
    return found ? one : IMKI_AID_ROLES;
}

imki_aid_role imki_aid_sigmas_of(const imki_aid_columns *columns, imk_aid_kind kind)
{
    static const imki_aid_role first[IMK_AID_KIND_COUNT] = {
        [IMK_AID_POSITION] = IMKI_AID_SIGMA_POSITION, [IMK_AID_VELOCITY] = IMKI_AID_SIGMA_VELOCITY,
        [IMK_AID_HEADING] = IMKI_AID_SIGMA_HEADING,   [IMK_AID_HEIGHT] = IMKI_AID_SIGMA_HEIGHT,
        [IMK_AID_ODOMETER] = IMKI_AID_SIGMA_SPEED,    [IMK_AID_ZERO_VELOCITY] = IMKI_AID_ROLES};
    return first[kind] < IMKI_AID_ROLES && columns->column[first[kind]] >= 0 ? first[kind]
                                                                             : IMKI_AID_ROLES;
}
