/* SPDX-License-Identifier: Apache-2.0 */
/* What the columns of a record are of aids, and its rows as their readings. */
#ifndef IMUKI_AID_COLUMNS_INTERNAL_H
#define IMUKI_AID_COLUMNS_INTERNAL_H

#include "imukit/aiding.h"
#include "imukit/job.h"
#include "imukit/record.h"

/* Columns with a meaning; three of a kind in the order of the axes. */
typedef enum imki_aid_role {
    IMKI_AID_GEODETIC = 0, /* latitude, longitude, height */
    IMKI_AID_EARTH_FIXED = 3,
    IMKI_AID_LOCAL = 6, /* north, east, down of the place where navigation begins */
    IMKI_AID_VELOCITY = 9,
    IMKI_AID_HEADING = 12,
    IMKI_AID_HEIGHT,
    IMKI_AID_SPEED,
    IMKI_AID_SIGMA_POSITION,
    IMKI_AID_SIGMA_VELOCITY = IMKI_AID_SIGMA_POSITION + 3,
    IMKI_AID_SIGMA_HEADING = IMKI_AID_SIGMA_VELOCITY + 3,
    IMKI_AID_SIGMA_HEIGHT,
    IMKI_AID_SIGMA_SPEED,
    IMKI_AID_ROLES
} imki_aid_role;

typedef struct imki_aid_columns {
    int time;
    int column[IMKI_AID_ROLES];  /* -1: there is none */
    double sign[IMKI_AID_ROLES]; /* -1: it counts the other way, as "up" for down */
    bool twice[IMKI_AID_ROLES];
} imki_aid_columns;

/* Find them by their names. */
void imki_aid_columns_find(size_t count, const imk_log_column *columns, imki_aid_columns *found);

/* Are those of a kind of aid, which is used, whole, once each and in units that fit?
 * @return IMK_ERROR_COLUMN, _UNIT_MISSING, _DIMENSION with a finding */
imk_status imki_aid_columns_check(const imk_log_column *columns, const imki_aid_columns *found,
                                  imk_aid_kind kind, bool sigmas, imk_findings *findings,
                                  imk_error *error);

/* Which columns a kind of aid is read from: the first of one or three; ROLES: none. */
imki_aid_role imki_aid_columns_of(const imki_aid_columns *columns, imk_aid_kind kind);
/* The first of its sigmas; ROLES: none. */
imki_aid_role imki_aid_sigmas_of(const imki_aid_columns *columns, imk_aid_kind kind);

#endif
