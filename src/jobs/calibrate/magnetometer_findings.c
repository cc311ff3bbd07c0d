/* SPDX-License-Identifier: Apache-2.0 */
/* What is told of a magnetometer: its records, then its solution. What cannot be used is the
 * failure of a calibration of it alone, and a warning beside the solution of other sensors, which
 * is then given without it. */
#include "calibrate_internal.h"

#include "base/algebra/vector_internal.h"
#include "jobs/job_internal.h"

#include "imukit/linear_algebra.h"
#include "imukit/simulate.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Field of the Earth on the ground [T] [IGRF14], and how far off a sensor's scale is. */
static const double field_least = 22e-6, field_most = 67e-6, scale_off = 0.2;

/* A share of the field by which residuals are doubted: as much as a third of a degree of heading.
 */
static const double disturbed = 0.005;

/* 1 sigma of the response, and of the hard iron over the field, from which on attitudes are too
 * much alike: half a degree of heading; and the same that is of no use. */
static const double weak = 0.01, useless = 0.1;

/* Axes within this of others' places are those [rad]; a mounting stands somewhere between. */
static const double exchanged = 0.35;

/* |sin dip| above which its sign at a place is that of the dipole there. */
static const double dip_certain = 0.5;

imk_status imki_magnetometer_useless(imk_calibrate_log *b, imk_status status, const char *code,
                                     const char *name, size_t count, const double *numbers,
                                     imk_error *error)
{
    if (b->result) {
        imki_find(&b->findings, IMK_FINDING_WARNING, code, name, count, numbers);
        return IMK_OK;
    }
    return imki_fail(&b->findings, error, status, code, name, count, numbers);
}

/* ---- records --------------------------------------------------------------------------------- */

static bool check_axes(imk_calibrate_log *b, const imk_calibrate_record *log, imk_error *error)
{
    char axis[96];
    for (int i = 0; i < 3; i++) {
        const bool stuck = log->mag.stuck[i];
        if (!stuck && log->mag.saturated[i] == 0)
            continue;
        snprintf(axis, sizeof axis, "mag_%c\t%.60s", imk_axis_letter(i), log->record.name);
        (void)imki_magnetometer_useless(b, IMK_ERROR_RANGE, stuck ? "mag_stuck" : "mag_saturated",
                                        axis, IMKI_NUMBERS(1e6 * log->mag.saturated[i]), error);
        return false;
    }
    return true;
}

bool imki_magnetometer_records(imk_calibrate_log *b, imk_error *error)
{
    bool calibrated = false, there = false, counts = false;
    for (size_t k = 0; k < b->count; k++) {
        const imk_calibrate_record *log = &b->record[k];
        const bool used = log->record.mag[0] && (log->procedure == IMK_PROCEDURE_MULTIPOSITION ||
                                                 log->procedure == IMK_PROCEDURE_MAGNETOMETER);
        there = there || log->record.mag[0];
        counts = counts || log->mag_counts;
        calibrated = calibrated || used;
        if (used && !check_axes(b, log, error))
            return false;
        if (used && 2 * log->mag.updates < log->mag.rows)
            imki_find(&b->findings, IMK_FINDING_NOTE, "mag_held", log->record.name,
                      IMKI_NUMBERS((double)log->mag.updates, (double)log->mag.rows));
    }
    if (there && !calibrated)
        imki_find(&b->findings, IMK_FINDING_NOTE, "mag_not_used", NULL, 0, NULL);
    if (counts && !calibrated)
        imki_find(&b->findings, IMK_FINDING_WARNING, "mag_counts_left", NULL, 0, NULL);
    if (!calibrated && (!isnan(b->settings.field) || !isnan(b->settings.dip)))
        imki_find(&b->findings, IMK_FINDING_WARNING, "mag_no_use_of_field", NULL, 0, NULL);
    return true;
}

/* ---- coverage -------------------------------------------------------------------------------- */

/* "+z, -x+y and +x-y-z" */
void imki_magnetometer_directions(const imk_magnetometer_result *r, char *text, size_t size)
{
    size_t length = 0;
    for (int k = 0; k < IMK_MAGNETOMETER_ADVICE; k++) {
        char one[8] = "";
        size_t used = 0;
        for (int i = 0; i < 3; i++)
            if (fabs(r->advice[k][i]) > 0.1) {
                one[used++] = r->advice[k][i] < 0 ? '-' : '+';
                one[used++] = imk_axis_letter(i);
            }
        length += (size_t)snprintf(text + length, length < size ? size - length : 0, "%s%s",
                                   k == 0                             ? ""
                                   : k == IMK_MAGNETOMETER_ADVICE - 1 ? " and "
                                                                      : ", ",
                                   one);
    }
}

static bool check_coverage(imk_calibrate_log *b, const imk_magnetometer_result *r, imk_error *error)
{
    char where[96];
    double worst = 0;
    for (int p = 0; p < IMK_MAGNETOMETER_FIELD; p++)
        worst =
            fmax(worst, r->sigma[p] /
                            (p < IMK_MAGNETOMETER_RESPONSE ? r->value[IMK_MAGNETOMETER_FIELD] : 1));
    imki_magnetometer_directions(r, where, sizeof where);
    if (worst > useless)
        (void)imki_magnetometer_useless(b, IMK_ERROR_SINGULAR, "mag_coverage", where,
                                        IMKI_NUMBERS(r->spread), error);
    else if (worst > weak)
        imki_find(&b->findings, IMK_FINDING_WARNING, "mag_weak", where,
                  IMKI_NUMBERS(100 * worst, r->spread));
    return worst <= useless;
}

/* Soft iron and scale factors make some tens of per cent between directions. */
static bool check_shape(imk_calibrate_log *b, const imk_magnetometer_result *r, imk_error *error)
{
    static const double most = 3;
    const double *a = r->value + IMK_MAGNETOMETER_RESPONSE;
    double square[9], value[3];
    for (int i = 0; i < 9; i++)
        square[i] = imki_dot3(a + (ptrdiff_t)(i / 3) * 3, a + (ptrdiff_t)(i % 3) * 3);
    if (imk_symmetric_eigen(3, square, value, NULL) != IMK_OK || value[2] < most * most * value[0])
        return true;
    (void)imki_magnetometer_useless(b, IMK_ERROR_CONFLICT, "mag_shape", NULL,
                                    IMKI_NUMBERS(sqrt(value[2] / value[0])), error);
    return false;
}

/* ---- axes ------------------------------------------------------------------------------------ */

/* How a log with these axes is mended: what becomes x, y, z. */
static void describe_mending(const imk_signed_axes *axes, char *text, size_t size)
{
    char from[3][3];
    int moved = 0, inverted = 0;
    for (int i = 0; i < 3; i++) {
        snprintf(from[axes->column[i]], sizeof from[0], "%s%c", axes->sign[i] < 0 ? "-" : "",
                 imk_axis_letter(i));
        moved += axes->column[i] != i;
        inverted += axes->sign[i] < 0;
    }
    if (moved == 0 && inverted == 3)
        snprintf(text, size, "all three axes inverted");
    else
        snprintf(text, size, "mag x, y, z taken from %s, %s, %s", from[0], from[1], from[2]);
}

/* Axes that moved, and those with the other sign. */
static int mistakes_of(const imk_signed_axes *axes)
{
    int mistakes = 0;
    for (int i = 0; i < 3; i++)
        mistakes += (axes->column[i] != i) + (axes->sign[i] < 0);
    return mistakes;
}

static imk_signed_axes inverted(imk_signed_axes axes)
{
    for (int i = 0; i < 3; i++)
        axes.sign[i] = -axes.sign[i];
    return axes;
}

/* Sine of the dip that is known from the options or the place; 0: its sign is not known. */
static double known_dip(const imk_calibrate_log *b)
{
    double field[3];
    if (!isnan(b->settings.dip))
        return sin(b->settings.dip);
    if (!b->settings.place_known)
        return 0;
    imk_dipole_field(b->settings.place.latitude, field);
    const double sine = field[2] / sqrt(field[0] * field[0] + field[2] * field[2]);
    return fabs(sine) > dip_certain ? sine : 0;
}

/* By the dip alone, a magnetometer that is inverted looks like one in a field that points the other
 * way: with the nearest axes P, -P and the opposite dip explain the log as well. */
static bool check_order(imk_calibrate_log *b, const imk_magnetometer_result *r, imk_error *error)
{
    static const double degree = 0.017453292519943295;
    const double sine = r->value[IMK_MAGNETOMETER_DIP], known = known_dip(b);
    const double dip = asin(fmax(-1, fmin(1, sine))) / degree;
    const bool opposite =
        known != 0 && sine * known < 0 && fabs(sine) > 5 * r->sigma[IMK_MAGNETOMETER_DIP];
    char words[96], one[48], other[48];
    if (!r->aligned || (r->nearest == 0 && !opposite))
        return true;
    const imk_signed_axes axes = imk_signed_axes_of(r->nearest), turned = inverted(axes);
    const bool second =
        known != 0 ? opposite : mistakes_of(&turned) < mistakes_of(&axes); /* comes first */
    describe_mending(second ? &turned : &axes, one, sizeof one);
    describe_mending(second ? &axes : &turned, other, sizeof other);
    if (r->nearest == 0) {
        (void)imki_magnetometer_useless(b, IMK_ERROR_CONFLICT, "mag_inverted", NULL,
                                        IMKI_NUMBERS(fabs(dip), dip > 0), error);
        return false;
    }
    if (r->nearest_angle > exchanged) {
        imki_find(&b->findings, IMK_FINDING_WARNING, "mag_mounting", one,
                  IMKI_NUMBERS(r->nearest_angle / degree));
        return true;
    }
    snprintf(words, sizeof words, "%.46s\t%.46s", one, other);
    (void)imki_magnetometer_useless(b, IMK_ERROR_CONFLICT,
                                    known != 0 ? "mag_axes_known" : "mag_axes", words,
                                    IMKI_NUMBERS(fabs(dip), second ? dip < 0 : dip > 0), error);
    return false;
}

/* ---- field ----------------------------------------------------------------------------------- */

static bool is_of_earth(double field)
{
    return field > field_least * (1 - scale_off) && field < field_most * (1 + scale_off);
}

/* The unit that the columns look like: "" if none makes a field of the Earth. */
static const char *likely_unit(const imk_calibrate_log *b, double field)
{
    static const char *const units[] = {"uT", "nT", "mG", "gauss", "mT", "T"};
    const imk_calibrate_record *log = &b->record[b->magnetometer->observation[0].record];
    const int column = imk_log_find(&log->log, IMK_QUANTITY_MAGNETIC, 0);
    const double stated = column >= 0 ? log->log.column[column].unit.scale : 1;
    for (size_t k = 0; k < sizeof units / sizeof *units; k++) {
        const double here = field / stated * imk_unit_of(units[k]).scale;
        if (is_of_earth(here))
            return units[k];
    }
    return "";
}

/* What makes readings, or a field that is given, this many times too small: a unit that was taken
 * for another. "": none. */
static const char *mistaken_unit(double ratio)
{
    static const struct {
        double ratio;
        const char *words;
    } units[] = {{10, "uT taken for mG"},
                 {100, "gauss taken for uT"},
                 {1e3, "T taken for mT, or mT taken for uT, or uT taken for nT"},
                 {1e4, "T taken for gauss"},
                 {1e5, "gauss taken for nT"},
                 {1e6, "T taken for uT, or mT taken for nT"}};
    static const char *const turned[] = {"mG taken for uT",
                                         "uT taken for gauss",
                                         "mT taken for T, or uT taken for mT, or nT taken for uT",
                                         "gauss taken for T",
                                         "nT taken for gauss",
                                         "uT taken for T, or nT taken for mT"};
    for (size_t k = 0; k < sizeof units / sizeof *units; k++) {
        if (fabs(ratio / units[k].ratio - 1) < scale_off)
            return units[k].words;
        if (fabs(ratio * units[k].ratio - 1) < scale_off)
            return turned[k];
    }
    return "";
}

/* A field that is given is another one than the readings have. */
static bool check_scale(imk_calibrate_log *b, double field, double known, imk_error *error)
{
    static const double most = 1.5;
    const bool given_is_wrong = is_of_earth(field) && !is_of_earth(known);
    const char *words = mistaken_unit(given_is_wrong ? field / known : known / field);
    if (field < most * known && known < most * field) {
        imki_find(&b->findings, IMK_FINDING_WARNING, "mag_scale", NULL,
                  IMKI_NUMBERS(1e6 * field, 1e6 * known));
        return true;
    }
    (void)imki_magnetometer_useless(b, IMK_ERROR_CONFLICT,
                                    words[0] ? "mag_scale_unit" : "mag_scale_useless", words,
                                    IMKI_NUMBERS(1e6 * field, 1e6 * known, given_is_wrong), error);
    return false;
}

static bool check_field(imk_calibrate_log *b, const imk_magnetometer_result *r, imk_error *error)
{
    const double *a = r->value + IMK_MAGNETOMETER_RESPONSE;
    double cross[3];
    imki_cross3(a + 3, a + 6, cross);
    const double scale = cbrt(fabs(imki_dot3(a, cross)));
    /* as the readings have it */
    const double field = r->value[IMK_MAGNETOMETER_FIELD] * scale;
    const char *unit = likely_unit(b, field);
    if (r->field_known && fabs(scale - 1) > scale_off)
        return check_scale(b, field, r->value[IMK_MAGNETOMETER_FIELD], error);
    if (!r->field_known && !is_of_earth(field))
        imki_find(&b->findings, IMK_FINDING_WARNING, unit[0] ? "mag_field_unit" : "mag_field", unit,
                  IMKI_NUMBERS(1e6 * field));
    return true;
}

/* The dip that is given is not used in the fit: it is another witness. */
static void check_dip(imk_calibrate_log *b, const imk_magnetometer_result *r)
{
    static const double degree = 0.017453292519943295, off = 2;
    const double dip = asin(fmax(-1, fmin(1, r->value[IMK_MAGNETOMETER_DIP]))) / degree;
    const double due = b->settings.dip / degree;
    if (r->aligned && fabs(dip - due) > off)
        imki_find(&b->findings, IMK_FINDING_WARNING, "mag_dip", NULL, IMKI_NUMBERS(dip, due));
}

/* ---- residuals ------------------------------------------------------------------------------- */

static void check_residuals(imk_calibrate_log *b, const imk_magnetometer_result *r)
{
    const double field = r->value[IMK_MAGNETOMETER_FIELD];
    const double off = fmax(r->rms[0], r->rms[1]);
    const double ratio = sqrt(r->chi_square / fmax(r->degrees_of_freedom, 1));
    if (r->added > 0 && off > disturbed * field)
        imki_find(&b->findings, IMK_FINDING_WARNING, "mag_disturbed", NULL,
                  IMKI_NUMBERS(1e6 * off, ratio, 100 * off / field));
    if (10 * r->refused > b->magnetometer->count)
        imki_find(&b->findings, IMK_FINDING_WARNING, "mag_outliers", NULL,
                  IMKI_NUMBERS((double)r->refused, (double)b->magnetometer->count,
                               b->magnetometer->series));
    else if (r->refused > 0)
        imki_find(&b->findings, IMK_FINDING_NOTE, "mag_left_out", NULL,
                  IMKI_NUMBERS((double)r->refused, (double)b->magnetometer->count,
                               b->magnetometer->series));
}

bool imki_magnetometer_result(imk_calibrate_log *b, imk_error *error)
{
    const imk_magnetometer_result *r = b->mag;
    if (!check_coverage(b, r, error) || !check_shape(b, r, error) || !check_order(b, r, error))
        return false;
    if (!check_field(b, r, error))
        return false;
    check_dip(b, r);
    check_residuals(b, r);
    return true;
}
