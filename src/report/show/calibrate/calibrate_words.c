/* SPDX-License-Identifier: Apache-2.0 */
/* In words: the verdict, and what a person should know beside the tables: frame, gravity, what was
 * left out, what is correlated. */
#include "calibrate_show_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double degree = 0.017453292519943295;

/* ---- verdict --------------------------------------------------------------------------------- */

imk_finding_level imk_verdict_level(const imk_verdict *v)
{
    imk_finding_level level = IMK_FINDING_GOOD;
    /* What no log of this kind can show is no fault of this one. */
    for (size_t k = 0; k < v->count; k++)
        if (v->message[k].level > level && strcmp(v->message[k].code, "not_testable") != 0)
            level = v->message[k].level;
    return level;
}

/* Worst 1 sigma of a term of a sensor; 0 when it was not estimated. */
static double worst(size_t count, const imk_model_parameter *parameter, const double *sigma,
                    int sensor, int term)
{
    double most = 0;
    for (size_t p = 0; p < count; p++)
        if (parameter[p].sensor == sensor && parameter[p].term == term)
            most = fmax(most, sigma[p]);
    return most;
}

void imki_precision(size_t count, const imk_model_parameter *parameter, const double *sigma_of,
                    imki_text *list)
{
    static const int terms[4] = {IMK_MODEL_BIAS, IMK_MODEL_SCALE_FACTOR, IMK_MODEL_MISALIGNMENT,
                                 IMK_MODEL_CROSS_AXIS};
    static const char *const names[4] = {"bias", "scale factor", "misalignment", "cross-axis"};
    static const int order[IMK_KINDS] = {IMK_ACCEL, IMK_GYRO, IMK_MAG};
    for (int k = 0; k < IMK_KINDS; k++) {
        const int sensor = order[k];
        bool first = true;
        for (int t = 0; t < 4; t++) {
            const double sigma = worst(count, parameter, sigma_of, sensor, terms[t]);
            if (!(sigma > 0))
                continue;
            const imk_model_parameter p = {(uint8_t)sensor, (uint8_t)terms[t], 0, 1};
            const imk_unit unit = imk_parameter_unit(p, sigma);
            char number[40];
            imk_readable_value(sigma / unit.scale, sigma / unit.scale, 2, number, sizeof number);
            imki_text_add(list, "%s%s%s%s to %s %s",
                          !first           ? ", "
                          : list->size > 0 ? "; "
                                           : "",
                          first ? imki_sensor_titles[sensor] : "", first ? " " : "", names[t],
                          number, unit.text);
            first = false;
        }
    }
}

void imki_calibrate_summary(const imk_calibrate_log *b, const imk_verdict *v, char *text,
                            size_t size)
{
    imki_text precision = {0};
    if (b->result)
        imki_precision(b->result->parameter_count, b->result->parameter, b->result->sigma,
                       &precision);
    const char *known = precision.bytes, *behind = known ? ", 1 sigma of the worst axis" : "";
    const imk_finding_level level = imk_verdict_level(v);
    size_t warnings = 0, bad = 0;
    for (size_t k = v->count; k-- > 0;) {
        warnings += v->message[k].level == IMK_FINDING_WARNING;
        bad = v->message[k].level == IMK_FINDING_FAILURE ? k : bad;
    }
    if (level == IMK_FINDING_FAILURE)
        snprintf(text, size, "Not usable: %s.", v->message[bad].text);
    else if (level == IMK_FINDING_WARNING)
        snprintf(text, size, "Usable with care (%zu warning%s): %s%s.", warnings,
                 warnings == 1 ? "" : "s", known ? known : "see below", behind);
    else
        snprintf(text, size, "Usable: %s%s.", known ? known : "no test found a fault in these logs",
                 behind);
    free(precision.bytes);
}

static double whole_degrees(double angle)
{
    return floor(angle / degree + 0.5) + 0.0;
}

void imki_calibrate_poses(const imk_calibrate_log *b, const imk_calibrate_record *log,
                          const char *before, char *text, size_t size)
{
    imk_pose_advice advice[IMK_CALIBRATE_POSES];
    text[0] = '\0';
    if (imk_calibrate_advise(b, log, NULL, advice))
        snprintf(text, size,
                 "%sroll %.0f pitch %.0f deg, roll %.0f pitch %.0f deg and roll %.0f pitch %.0f "
                 "deg",
                 before, whole_degrees(advice[0].roll), whole_degrees(advice[0].pitch),
                 whole_degrees(advice[1].roll), whole_degrees(advice[1].pitch),
                 whole_degrees(advice[2].roll), whole_degrees(advice[2].pitch));
}

/* ---- remarks --------------------------------------------------------------------------------- */

enum { LISTED_MAX = 6 };

static bool is_free(const imk_calibrate_log *b, int term)
{
    for (size_t p = 0; p < b->result->parameter_count; p++)
        if (b->result->parameter[p].term == term)
            return true;
    return false;
}

static void show_frame(const imk_calibrate_log *b, imk_result *result)
{
    static const char *const meaning[] = {
        "the z accelerometer senses along body z, the y accelerometer in the plane of y and z",
        "the x accelerometer senses along body x, the y accelerometer in the plane of x and y",
        "the body axes are turned so that the accelerometers' misalignments are symmetric",
        "the body axes are those of the reference: faces of the housing, axes of the table"};
    const imk_triad_frame frame = b->calibration->frame;
    if (is_free(b, IMK_MODEL_MISALIGNMENT))
        imk_result_line(result, "Frame %s: %s.%s", imk_triad_frame_name(frame), meaning[frame],
                        frame == IMK_FRAME_REFERENCE
                            ? ""
                            : " Gravity does not show how these axes stand in the housing.");
}

static void show_gravity(const imk_calibrate_log *b, imk_result *result)
{
    bool used = false;
    for (size_t k = 0; k < b->count; k++)
        used = used || (b->record[k].procedure < IMK_PROCEDURE_RATE_TABLE &&
                        b->record[k].record.axis_count[1] > 0);
    if (used)
        imk_result_line(result, "Gravity %.5f m/s^2 (%s).", b->calibration->gravity,
                        !isnan(b->settings.gravity) ? "given"
                        : b->settings.place_known
                            ? "WGS84 at the place given"
                            : "WGS84 at 45 deg and sea level: the place is not known");
}

/* How the unit stands on its fixtures. */
static void show_fixtures(const imk_calibrate_log *b, imk_result *result)
{
    imki_text list = {0};
    for (size_t k = 0; k < b->calibration->fixture_count; k++) {
        const double *angle = b->result->fixture[k];
        if (b->calibration->fixture_sigma[k] > 0)
            imki_text_add(&list, "%s%.3f %.3f %.3f deg about x, y, z", list.size > 0 ? "; " : "",
                          angle[0] / degree, angle[1] / degree, angle[2] / degree);
    }
    if (list.size > 0)
        imk_result_line(result, "Mounting: %s.", list.bytes);
    free(list.bytes);
}

bool imki_no_sigma(const imk_calibrate_log *b, int group)
{
    bool any = false;
    for (size_t k = 0; k < b->count; k++)
        any = any || (group == IMK_GROUP_GYRO && b->record[k].no_sigma[0]) ||
              (group == IMK_GROUP_ACCEL && b->record[k].no_sigma[1]);
    return any;
}

const char *imki_label_of(const imk_test_record *record, size_t row)
{
    const int section = record->section ? record->section[row] : -1;
    return section >= 0 ? record->section_name[section] : NULL;
}

/* "row 3 (x_up)" of a table. */
static void list_row(imki_text *list, const imk_test_record *record, size_t row)
{
    const char *label = imki_label_of(record, row);
    imki_list_item(list, "row %zu", row + 1);
    if (label)
        imki_text_add(list, " (%s)", label);
}

/* Observations and turns without weight, by time. */
static void show_refused(const imk_calibrate_log *b, imk_result *result)
{
    const imk_calibration *c = b->calibration;
    const size_t total = b->result->observations_refused + b->result->turns_refused;
    size_t listed = 0;
    imki_text list = {0};
    for (size_t k = 0; k < c->observation_count + c->turn_count && listed < LISTED_MAX; k++) {
        const bool is_turn = k >= c->observation_count;
        const size_t i = is_turn ? k - c->observation_count : k;
        const double weight = is_turn ? c->turn[i].weight : c->observation[i].weight;
        const size_t begin = is_turn ? c->turn[i].begin : c->observation[i].begin;
        const imk_test_record *record =
            c->record[c->observation[is_turn ? (size_t)c->turn[i].from : i].record];
        if (weight > 0)
            continue;
        if (record->means)
            list_row(&list, record, begin);
        else
            imki_list_item(&list, "%s at %.2f s", is_turn ? "the turn" : "the observation",
                           imk_test_record_time(record, begin));
        if (b->count > 1)
            imki_text_add(&list, " of %s", record->name);
        listed++;
    }
    if (total > listed)
        imki_text_add(&list, " and %zu more", total - listed);
    if (total > 0)
        imk_result_line(result, "Left out, because they do not fit the others: %s.", list.bytes);
    free(list.bytes);
}

/* The first pairs that are correlated above 0.9. */
static void show_correlated(const imk_calibrate_log *b, imk_result *result)
{
    const imk_calibration_result *r = b->result;
    const size_t n = r->parameter_count;
    for (size_t i = 0, listed = 0; i < n; i++)
        for (size_t j = 0; j < i && listed < LISTED_MAX; j++) {
            const double value = r->covariance[i * n + j] / (r->sigma[i] * r->sigma[j]);
            char one[IMK_MODEL_PARAMETER_NAME], other[IMK_MODEL_PARAMETER_NAME];
            /* Pairs that a symmetric frame ties are one number. */
            if (!(fabs(value) > 0.9 && fabs(value) < 1 - 1e-9) ||
                imk_model_parameter_name(r->parameter[i], one) != IMK_OK ||
                imk_model_parameter_name(r->parameter[j], other) != IMK_OK)
                continue;
            imk_result_line(result, "Correlation of %s and %s: %+.4f.", other, one, value);
            listed++;
        }
}

void imki_calibrate_remarks(const imk_calibrate_log *b, imk_result *result)
{
    if (!b->result)
        return;
    show_frame(b, result);
    show_gravity(b, result);
    imki_magnetometer_remarks(b, result);
    if (b->ferraris)
        imk_result_line(result, "Closed form: 1 sigma contains the scatter within the holds and "
                                "the uncertainty of the turn angles; it does not contain how well "
                                "the faces were placed, nor the Earth's rotation.");
    show_fixtures(b, result);
    show_refused(b, result);
    for (size_t k = 0; k < b->count; k++) { /* a reference that never holds still may lead */
        const imk_procedure_findings *f = &b->record[k].findings;
        if (f->lag_sigma > 0)
            imk_result_line(
                result,
                "%s: the readings lag the reference by %.4g ± %.2g ms; this lag is corrected.",
                b->record[k].path, f->lag * 1e3, f->lag_sigma * 1e3);
    }
    show_correlated(b, result);
}
