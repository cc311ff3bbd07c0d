/* SPDX-License-Identifier: Apache-2.0 */
/* What a person should know beside the tables: frame, gravity, what was left out, what is
 * correlated. */
#include "calibrate_parts.h"

#include <math.h>
#include <string.h>

enum { LISTED_MAX = 6 };

static bool free_of(const bench *b, int sensor, int term)
{
    for (size_t p = 0; p < b->result->parameter_count; p++)
        if (b->result->parameter[p].sensor == sensor && b->result->parameter[p].term == term)
            return true;
    return false;
}

static bool frame_remark(const bench *b, char *text, size_t size)
{
    static const char *const meaning[] = {
        "the z accelerometer senses along body z, the y accelerometer in the plane of y and z",
        "the x accelerometer senses along body x, the y accelerometer in the plane of x and y",
        "the body axes are turned so that the accelerometers' misalignments are symmetric",
        "the body axes are those of the reference: faces of the housing, axes of the table"};
    const imk_triad_frame frame = b->calibration->frame;
    if (!free_of(b, 0, IMK_MODEL_MISALIGNMENT) && !free_of(b, 1, IMK_MODEL_MISALIGNMENT))
        return false;
    snprintf(text, size, "Frame %s: %s.%s", imk_triad_frame_name(frame), meaning[frame],
             frame == IMK_FRAME_REFERENCE ? ""
                                          : " Gravity does not tell how that stands in the "
                                            "housing.");
    return true;
}

static bool gravity_remark(const bench *b, char *text, size_t size)
{
    bool used = false;
    for (size_t k = 0; k < b->log_count; k++)
        used = used || (b->log[k].procedure < IMK_PROCEDURE_RATE_TABLE &&
                        b->log[k].record.axis_count[1] > 0);
    if (!used)
        return false;
    snprintf(text, size, "Gravity %.5f m/s^2 (%s).", b->calibration->gravity,
             !isnan(b->options->gravity) ? "given"
             : b->place_known            ? "WGS84 at the place given"
                                         : "WGS84 at 45 deg and sea level: the place is not known");
    return true;
}

/* How the unit stands on its fixtures. */
static bool fixture_remark(const bench *b, char *text, size_t size)
{
    static const double degree = 0.017453292519943295;
    size_t used = 0;
    for (size_t k = 0; k < b->calibration->fixture_count && used < size; k++) {
        const double *angle = b->result->fixture[k];
        if (!(b->calibration->fixture_sigma[k] > 0))
            continue;
        used += (size_t)snprintf(text + used, size - used, "%s%.3f %.3f %.3f deg about x, y, z",
                                 used ? "; " : "Mounting: ", angle[0] / degree, angle[1] / degree,
                                 angle[2] / degree);
    }
    if (used > 0 && used < size)
        snprintf(text + used, size - used, ".");
    return used > 0;
}

static double time_of(const imk_test_record *record, size_t row)
{
    return record->time ? record->time[row] : (double)row * record->dt;
}

/* Observations and turns without weight, by time. */
static bool refused_remark(const bench *b, char *text, size_t size)
{
    const imk_calibration *c = b->calibration;
    const size_t total = b->result->observations_refused + b->result->turns_refused;
    size_t listed = 0, used = 0;
    if (total == 0)
        return false;
    used = (size_t)snprintf(text, size, "Left out, because they do not fit the others: ");
    for (size_t k = 0; k < c->observation_count + c->turn_count && listed < LISTED_MAX; k++) {
        const bool is_turn = k >= c->observation_count;
        const size_t i = is_turn ? k - c->observation_count : k;
        const double weight = is_turn ? c->turn[i].weight : c->observation[i].weight;
        const size_t begin = is_turn ? c->turn[i].begin : c->observation[i].begin;
        const int record =
            is_turn ? c->observation[c->turn[i].from].record : c->observation[i].record;
        if (weight > 0 || used >= size)
            continue;
        used += (size_t)snprintf(text + used, size - used, "%s%s at %.2f s", listed ? ", " : "",
                                 is_turn ? "the turn" : "the observation",
                                 time_of(c->record[record], begin));
        if (b->log_count > 1 && used < size)
            used += (size_t)snprintf(text + used, size - used, " of %s", c->record[record]->name);
        listed++;
    }
    if (used < size)
        snprintf(text + used, size - used, total > listed ? " and %zu more." : ".", total - listed);
    return true;
}

/* Number `which` of the pairs that are correlated above 0.9. */
static bool correlation_remark(const bench *b, size_t which, char *text, size_t size)
{
    const imk_calibration_result *r = b->result;
    const size_t n = r->parameter_count;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < i; j++) {
            const double value = r->covariance[i * n + j] / (r->sigma[i] * r->sigma[j]);
            char one[IMK_MODEL_PARAMETER_NAME], other[IMK_MODEL_PARAMETER_NAME];
            if (!(fabs(value) > 0.9) || which-- > 0 ||
                imk_model_parameter_name(r->parameter[i], one) != IMK_OK ||
                imk_model_parameter_name(r->parameter[j], other) != IMK_OK)
                continue;
            snprintf(text, size, "Correlation of %s and %s: %+.4f.", other, one, value);
            return true;
        }
    return false;
}

/* Where a reference that never holds still was found to lead the readings. */
static bool lag_remark(const bench *b, size_t which, char *text, size_t size)
{
    for (size_t k = 0; k < b->log_count; k++) {
        const imk_procedure_findings *f = &b->log[k].findings;
        if (!(f->lag_sigma > 0) || which-- > 0)
            continue;
        snprintf(text, size,
                 "%s: the readings come %.4g ± %.2g ms after the reference, which was "
                 "allowed for.",
                 b->log[k].path, f->lag * 1e3, f->lag_sigma * 1e3);
        return true;
    }
    return false;
}

static bool closed_form_remark(const bench *b, char *text, size_t size)
{
    if (b->ferraris)
        snprintf(text, size,
                 "Closed form: 1 sigma is that of the scatter within the holds and of the angles "
                 "of the turns; how well the faces were placed is not in it, nor the Earth's "
                 "rotation.");
    return b->ferraris != NULL;
}

bool bench_remark(const bench *b, size_t line, char *text, size_t size)
{
    typedef bool single(const bench *, char *, size_t);
    static single *const singles[] = {frame_remark, gravity_remark, closed_form_remark,
                                      fixture_remark, refused_remark};
    if (!b->result)
        return false;
    for (size_t k = 0; k < sizeof singles / sizeof singles[0]; k++)
        if (singles[k](b, text, size) && line-- == 0)
            return true;
    for (size_t k = 0; lag_remark(b, k, text, size); k++)
        if (line-- == 0)
            return true;
    for (size_t k = 0; k < LISTED_MAX && correlation_remark(b, k, text, size); k++)
        if (line-- == 0)
            return true;
    return false;
}
