/* SPDX-License-Identifier: Apache-2.0 */
/* Aids: their true errors as sources, their readings, and how an error of a reading enters an
 * update. */
#include "drift_aided_internal.h"

#include "base/text_internal.h"
#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

static const struct {
    const char *name, *white, *correlated;
} kinds[IMK_AID_KIND_COUNT] = {
    [IMK_AID_POSITION] = {"position", "position aid, white noise",
                          "position aid, correlated error"},
    [IMK_AID_VELOCITY] = {"velocity", "velocity aid, white noise",
                          "velocity aid, correlated error"},
    [IMK_AID_HEADING] = {"heading", "heading aid, white noise", "heading aid, correlated error"},
    [IMK_AID_HEIGHT] = {"height", "height aid, white noise", "height aid, correlated error"},
    [IMK_AID_ODOMETER] = {"odometer", "odometer, white noise", "odometer, correlated error"},
    [IMK_AID_ZERO_VELOCITY] = {"zero_velocity", "zero velocity, white noise",
                               "zero velocity, correlated error"},
};

/* ---- sources -----------------------------------------------------------------------------------
 */

enum { NAME_SIZE = 40 };

static const char *const numbers[IMK_AIDS_MAX] = {"[0]", "[1]", "[2]", "[3]",
                                                  "[4]", "[5]", "[6]", "[7]"};

/* "velocity[1]" of the second aid of its kind, and so on; "velocity" of an only one. */
static void name_of(const imk_drift_settings *s, size_t aid, char name[NAME_SIZE])
{
    size_t before = 0, all = 0;
    for (size_t k = 0; k < s->aid_count; k++) {
        before += k < aid && s->aid[k].kind == s->aid[aid].kind;
        all += s->aid[k].kind == s->aid[aid].kind;
    }
    name[0] = '\0';
    imki_append_text(name, NAME_SIZE, kinds[s->aid[aid].kind].name);
    if (all > 1)
        imki_append_text(name, NAME_SIZE, numbers[before]);
}

static bool is_measured(const imk_drift_settings *s, size_t aid, int axis)
{
    const imk_aid *a = &s->aid[aid];
    const bool down = axis == 2 && a->kind != IMK_AID_ODOMETER;
    return isfinite(a->sigma[axis]) && !(down && imk_drift_vertical(s) == IMK_VERTICAL_SLAVED);
}

static void add_noise(imki_drift_plan *plan, const imk_drift_settings *s, size_t aid, bool white)
{
    const imk_aid *a = &s->aid[aid];
    const double *size = white ? a->sigma : a->correlated_sigma;
    const int part = white ? IMKI_AID_WHITE : IMKI_AID_CORRELATED;
    char name[NAME_SIZE];
    bool any = false;
    for (int axis = 0; axis < 3; axis++)
        any = any || (is_measured(s, aid, axis) && size[axis] > 0.0);
    if (!any)
        return;
    name_of(s, aid, name);
    imki_drift_add_source(plan, "aid", name, white ? ".white" : ".correlated",
                          white ? kinds[a->kind].white : kinds[a->kind].correlated);
    for (int axis = 0; axis < 3; axis++) {
        const imki_drift_column column =
            imki_drift_column_of(IMKI_COLUMN_AID, (int)aid, axis, part);
        const imki_drift_driver driver =
            white ? imki_driver_white() : imki_driver_gauss_markov(a->correlation_time);
        if (is_measured(s, aid, axis) && size[axis] > 0.0)
            imki_drift_add_noise(plan, IMKI_ELEMENT_NOISE, &column, &driver,
                                 size[axis] * size[axis]);
    }
}

size_t imki_aid_point(const imk_aid *aids, size_t aid)
{
    size_t first = 0;
    while (first < aid && !imki_aids_at_one_point(&aids[first], &aids[aid]))
        first++;
    return first;
}

static void add_lever_arm(imki_drift_plan *plan, const imk_drift_settings *s, size_t aid)
{
    const double *sigma = s->aid[aid].lever_arm_sigma;
    if (imki_aid_point(s->aid, aid) != aid || !imki_drift_has_any(sigma, 3))
        return;
    imki_drift_add_source(plan, "aid", "lever_arm", aid > 0 ? numbers[aid] : "",
                          "lever arm of an aid");
    const imki_drift_driver driver = imki_driver_constant();
    for (int axis = 0; axis < 3; axis++) {
        const imki_drift_column column =
            imki_drift_column_of(IMKI_COLUMN_AID, (int)aid, axis, IMKI_AID_LEVER_ARM);
        if (sigma[axis] > 0.0)
            imki_drift_add_constant(plan, IMKI_ELEMENT_SIZE, &column, &driver, sigma[axis], 0.0);
    }
}

void imki_drift_aid_sources(imki_drift_plan *plan, const imk_drift_settings *settings)
{
    for (size_t aid = 0; aid < settings->aid_count; aid++) {
        add_noise(plan, settings, aid, true);
        add_noise(plan, settings, aid, false);
    }
    for (size_t aid = 0; aid < settings->aid_count; aid++)
        add_lever_arm(plan, settings, aid);
}

/* Is it the name, and what is behind it? */
static bool begins(const char *name, const char *first, const char **behind)
{
    const size_t length = strlen(first);
    *behind = name + length;
    return strncmp(name, first, length) == 0;
}

static void scale(double number[3], double factor)
{
    for (int i = 0; i < 3; i++)
        number[i] *= factor; /* infinity stays */
}

bool imki_aid_scale(const char *name, double factor, size_t count, imk_aid *aids)
{
    const imk_drift_settings all = {.aid_count = count, .aid = aids};
    const char *behind;
    for (size_t k = 0; k < count; k++) {
        char own[NAME_SIZE];
        name_of(&all, k, own);
        if (begins(name, own, &behind) && strcmp(behind, ".white") == 0) {
            scale(aids[k].sigma, factor);
            return true;
        }
        if (begins(name, own, &behind) && strcmp(behind, ".correlated") == 0) {
            scale(aids[k].correlated_sigma, factor);
            return true;
        }
    }
    if (!begins(name, "lever_arm", &behind))
        return false;
    const size_t point = *behind == '[' ? (size_t)(behind[1] - '0') : 0;
    bool same[IMK_AIDS_MAX];
    for (size_t k = 0; k < count; k++)
        same[k] = imki_aid_point(aids, k) == point;
    for (size_t k = 0; k < count; k++)
        if (same[k])
            scale(aids[k].lever_arm_sigma, factor);
    return true;
}

/* ---- readings ----------------------------------------------------------------------------------
 */

static const imk_vector3 earth = {{0.0, 0.0, IMK_EARTH_RATE}};

/* Of the body relative to the Earth, body axes. */
static imk_vector3 turning(const imk_motion_state *state, const imk_matrix3 *c)
{
    return imk_vector3_subtract(state->angular_rate,
                                imk_matrix3_apply(imk_matrix3_transpose(*c), earth));
}

static bool is_velocity(imk_aid_kind kind)
{
    return kind == IMK_AID_VELOCITY || kind == IMK_AID_ODOMETER || kind == IMK_AID_ZERO_VELOCITY;
}

void imki_aid_reading(const imk_aid *aid, const imk_motion_state *state, const double arm[3],
                      const double off[3], double value[3])
{
    const imk_matrix3 c = imk_quaternion_to_matrix(state->attitude);
    const imk_matrix3 axes = imk_ned_axes(state->place.latitude, state->place.longitude);
    const imk_vector3 l = {{arm[0], arm[1], arm[2]}}, error = {{off[0], off[1], off[2]}};
    const imk_vector3 point = imk_vector3_add(state->position, imk_matrix3_apply(c, l));
    const imk_vector3 swept = imk_vector3_cross(turning(state, &c), l);
    imk_vector3 v = imk_vector3_add(state->velocity, imk_matrix3_apply(c, swept));
    value[0] = value[1] = value[2] = 0.0;
    switch (aid->kind) {
    case IMK_AID_POSITION: {
        const imk_geodetic place =
            imk_geodetic_from_ecef(imk_vector3_add(point, imk_matrix3_apply(axes, error)));
        value[0] = place.latitude;
        value[1] = place.longitude;
        value[2] = place.height;
        break;
    }
    case IMK_AID_ZERO_VELOCITY:
        v = imk_matrix3_apply(imk_matrix3_transpose(axes), state->velocity);
        break;
    case IMK_AID_VELOCITY:
        v = imk_matrix3_apply(imk_matrix3_transpose(axes), v);
        break;
    case IMK_AID_ODOMETER:
        v = imk_matrix3_apply(imk_matrix3_transpose(c), v);
        break;
    case IMK_AID_HEIGHT:
        value[0] = imk_geodetic_from_ecef(point).height + off[0];
        break;
    case IMK_AID_HEADING: {
        const imk_matrix3 c_nb = imk_matrix3_multiply(imk_matrix3_transpose(axes), c);
        value[0] = atan2(c_nb.m[1][0], c_nb.m[0][0]) + off[0];
        break;
    }
    case IMK_AID_KIND_COUNT:
        break;
    }
    for (int i = 0; i < 3 && is_velocity(aid->kind); i++)
        value[i] = v.v[i] + off[i];
}

/* ---- errors in an update ----------------------------------------------------------------------
 */

/* Prediction minus reading on one axis, per length of the true arm beyond the one that is taken. */
static double arm_response(const imk_aid *aid, int axis, int along, const imki_drift_node *node)
{
    const imk_motion_state *state = &node->state;
    const imk_matrix3 to = imk_matrix3_transpose(node->axes);
    imk_vector3 unit = {{0.0, 0.0, 0.0}};
    unit.v[along] = 1.0;
    const imk_vector3 swept = imk_vector3_cross(turning(state, &node->c_eb), unit);
    switch (aid->kind) {
    case IMK_AID_POSITION:
        return -imk_matrix3_apply(to, imk_matrix3_apply(node->c_eb, unit)).v[axis];
    case IMK_AID_VELOCITY:
        return -imk_matrix3_apply(to, imk_matrix3_apply(node->c_eb, swept)).v[axis];
    case IMK_AID_ODOMETER:
        return -swept.v[axis];
    case IMK_AID_HEIGHT:
        return imk_matrix3_apply(to, imk_matrix3_apply(node->c_eb, unit)).v[2];
    default:
        return 0.0;
    }
}

double imki_aid_enters(const imki_drift_column *column, const imk_aid *aids, size_t aid, int axis,
                       const imki_drift_node *node)
{
    const size_t of = (size_t)column->sensor;
    if (column->part == IMKI_AID_LEVER_ARM)
        return of == imki_aid_point(aids, aid) ? arm_response(&aids[aid], axis, column->axis, node)
                                               : 0.0;
    return of == aid && column->axis == axis ? -1.0 : 0.0;
}
