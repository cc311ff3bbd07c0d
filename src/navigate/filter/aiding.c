/* SPDX-License-Identifier: Apache-2.0 */
/* The description of an aid. */
#include "imukit/aiding.h"

#include "navigation_filter_internal.h"

#include "base/refuse_internal.h"

#include <math.h>

static const uint32_t cookie = 0xA1D1A1D1;

static const struct {
    const char *name, *unit;
    size_t axes;
} kinds[IMK_AID_KIND_COUNT] = {
    [IMK_AID_POSITION] = {"position", "m", 3},
    [IMK_AID_VELOCITY] = {"velocity", "m/s", 3},
    [IMK_AID_HEADING] = {"heading", "rad", 1},
    [IMK_AID_HEIGHT] = {"height", "m", 1},
    [IMK_AID_ODOMETER] = {"odometer", "m/s", 3},
    [IMK_AID_ZERO_VELOCITY] = {"zero velocity", "m/s", 3},
};

static bool is_kind(imk_aid_kind kind)
{
    return (unsigned)kind < IMK_AID_KIND_COUNT;
}

const char *imk_aid_kind_name(imk_aid_kind kind)
{
    return is_kind(kind) ? kinds[kind].name : NULL;
}

size_t imk_aid_axes(imk_aid_kind kind)
{
    return is_kind(kind) ? kinds[kind].axes : 0;
}

const char *imk_aid_unit(imk_aid_kind kind)
{
    return is_kind(kind) ? kinds[kind].unit : NULL;
}

imk_aid imk_aid_default(imk_aid_kind kind)
{
    imk_aid aid = {.cookie = cookie, .kind = kind, .interval = 1, .from = 1};
    aid.until = (double)INFINITY;
    for (size_t axis = 0; axis < 3; axis++)
        aid.sigma[axis] = axis < imk_aid_axes(kind) && !(kind == IMK_AID_ODOMETER && axis > 0)
                              ? 1.0
                              : (double)INFINITY;
    return aid;
}

/* Finite and not negative, and not too large to be squared. */
static bool is_size(double value)
{
    return value >= 0.0 && value <= 1e100;
}

static imk_status refuse(imk_error *error, const char *field, int axis, double value,
                         const char *expected)
{
    const imk_status status = isnan(value) ? IMK_ERROR_NOT_FINITE : IMK_ERROR_RANGE;
    return imki_refuse_at(error, status, field, (size_t)axis, value, 0.0, expected);
}

static imk_status check_sigmas(const imk_aid *a, imk_error *error)
{
    bool measured = false, correlated = false;
    for (int i = 0; i < 3; i++) {
        const bool is_axis = (size_t)i < imk_aid_axes(a->kind);
        if (!(a->sigma[i] > 0.0) || (a->sigma[i] > 1e100 && !isinf(a->sigma[i])))
            return refuse(error, "sigma", i, a->sigma[i],
                          "a sigma above 0; infinity: not measured");
        if (!is_axis && !isinf(a->sigma[i]))
            return refuse(error, "sigma", i, a->sigma[i], "infinity: the kind has one axis");
        if (!is_size(a->correlated_sigma[i]))
            return refuse(error, "correlated_sigma", i, a->correlated_sigma[i],
                          "a sigma of 0 or more");
        if (!(fabs(a->lever_arm[i]) <= 1e6))
            return refuse(error, "lever_arm", i, a->lever_arm[i], "a length");
        if (!is_size(a->lever_arm_sigma[i]))
            return refuse(error, "lever_arm_sigma", i, a->lever_arm_sigma[i],
                          "a length of 0 or more");
        measured = measured || !isinf(a->sigma[i]);
        correlated = correlated || a->correlated_sigma[i] > 0.0;
    }
    if (!measured)
        return refuse(error, "sigma", 0, a->sigma[0], "a finite sigma of at least one axis");
    if (correlated ? !(a->correlation_time > 0.0 && a->correlation_time <= 1e100)
                   : !is_size(a->correlation_time))
        return imki_refuse(error, IMK_ERROR_RANGE, "correlation_time", a->correlation_time, 0.0,
                           "a time above 0");
    return IMK_OK;
}

imk_status imk_aid_validate(const imk_aid *a, imk_error *error)
{
    if (a->cookie != cookie)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "aid", "",
                             "start from imk_aid_default()");
    if (!is_kind(a->kind))
        return imki_refuse(error, IMK_ERROR_RANGE, "kind", (double)a->kind, 0.0, "a kind of aid");
    const imk_status status = check_sigmas(a, error);
    if (status != IMK_OK)
        return status;
    if (!(a->interval > 0.0 && a->interval <= 1e100))
        return imki_refuse(error, IMK_ERROR_RANGE, "interval", a->interval, 0.0, "a time above 0");
    if (!(fabs(a->from) <= 1e100))
        return imki_refuse(error, IMK_ERROR_RANGE, "from", a->from, 0.0, "a time");
    if (!(a->until >= a->from))
        return imki_refuse(error, IMK_ERROR_RANGE, "until", a->until, a->from,
                           "a time not before `from`");
    return IMK_OK;
}

bool imki_aids_at_one_point(const imk_aid *a, const imk_aid *b)
{
    bool same = true;
    for (int i = 0; i < 3; i++)
        same = same && a->lever_arm[i] == b->lever_arm[i] &&
               a->lever_arm_sigma[i] == b->lever_arm_sigma[i];
    return same;
}
