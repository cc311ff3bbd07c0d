/* SPDX-License-Identifier: Apache-2.0 */
/* In words: the verdict, and what a person should know beside the tables: frame, gravity, what was
 * left out, what is correlated. */
#include "calibrate_parts.h"
#include "shell/growing_list.h"

#include <math.h>

/* ---- verdict --------------------------------------------------------------------------------- */

calibrate_level bench_level(const bench *b)
{
    calibrate_level level = LEVEL_GOOD;
    for (size_t k = 0; k < b->sentence_count; k++)
        level = b->sentence[k].level > level ? b->sentence[k].level : level;
    return level;
}

/* Worst 1 sigma of a term of a sensor; 0 when it was not estimated. */
static double worst(const bench *b, int sensor, int term)
{
    double most = 0;
    for (size_t p = 0; b->result && p < b->result->parameter_count; p++)
        if (b->result->parameter[p].sensor == sensor && b->result->parameter[p].term == term)
            most = fmax(most, b->result->sigma[p]);
    return most;
}

/* "accelerometer bias to 0.05 mg, scale factor to 65 ppm, misalignment to 0.02 mrad" */
static void describe_precision(const bench *b, growing_list *list)
{
    static const int terms[3] = {IMK_MODEL_BIAS, IMK_MODEL_SCALE_FACTOR, IMK_MODEL_MISALIGNMENT};
    static const char *const names[3] = {"bias", "scale factor", "misalignment"};
    for (int sensor = 1; sensor >= 0; sensor--) {
        bool first = true;
        for (int t = 0; t < 3; t++) {
            const double sigma = worst(b, sensor, terms[t]);
            if (!(sigma > 0))
                continue;
            const imk_model_parameter p = {(uint8_t)sensor, (uint8_t)terms[t], 0, 1};
            const imk_unit unit = parameter_unit(p, sigma);
            char number[40];
            imk_readable_value(sigma / unit.scale, sigma / unit.scale, 2, number, sizeof number);
            list_add(list, "%s%s%s%s to %s %s",
                     !first           ? ", "
                     : list->size > 0 ? "; "
                                      : "",
                     first ? sensor_titles[sensor] : "", first ? " " : "", names[t], number,
                     unit.text);
            first = false;
        }
    }
}

void bench_verdict(const bench *b, char *text, size_t size)
{
    growing_list precision = {0};
    describe_precision(b, &precision);
    const char *known = precision.text, *behind = known ? ", 1 sigma of the worst axis" : "";
    const calibrate_level level = bench_level(b);
    size_t warnings = 0, bad = 0;
    for (size_t k = b->sentence_count; k-- > 0;) {
        warnings += b->sentence[k].level == LEVEL_WARNING;
        bad = b->sentence[k].level == LEVEL_USELESS ? k : bad;
    }
    if (level == LEVEL_USELESS)
        snprintf(text, size, "Not usable: %s.", b->sentence[bad].text);
    else if (level == LEVEL_WARNING)
        snprintf(text, size, "Usable with care (%zu warning%s): %s%s.", warnings,
                 warnings == 1 ? "" : "s", known ? known : "see below", behind);
    else
        snprintf(text, size, "Good: %s%s.", known ? known : "nothing speaks against these logs",
                 behind);
    list_free(&precision);
}

/* ---- remarks --------------------------------------------------------------------------------- */

enum { LISTED_MAX = 6 };

static bool is_free(const bench *b, int term)
{
    for (size_t p = 0; p < b->result->parameter_count; p++)
        if (b->result->parameter[p].term == term)
            return true;
    return false;
}

static void show_frame(const bench *b, imk_result *result)
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
                            : " Gravity does not tell how that stands in the housing.");
}

static void show_gravity(const bench *b, imk_result *result)
{
    bool used = false;
    for (size_t k = 0; k < b->log_count; k++)
        used = used || (b->log[k].procedure < IMK_PROCEDURE_RATE_TABLE &&
                        b->log[k].record.axis_count[1] > 0);
    if (used)
        imk_result_line(result, "Gravity %.5f m/s^2 (%s).", b->calibration->gravity,
                        !isnan(b->options->gravity) ? "given"
                        : b->place_known            ? "WGS84 at the place given"
                                         : "WGS84 at 45 deg and sea level: the place is not known");
}

/* How the unit stands on its fixtures. */
static void show_fixtures(const bench *b, imk_result *result)
{
    static const double degree = 0.017453292519943295;
    growing_list list = {0};
    for (size_t k = 0; k < b->calibration->fixture_count; k++) {
        const double *angle = b->result->fixture[k];
        if (b->calibration->fixture_sigma[k] > 0)
            list_add(&list, "%s%.3f %.3f %.3f deg about x, y, z", list.size > 0 ? "; " : "",
                     angle[0] / degree, angle[1] / degree, angle[2] / degree);
    }
    if (list.size > 0)
        imk_result_line(result, "Mounting: %s.", list.text);
    list_free(&list);
}

/* Observations and turns without weight, by time. */
static void show_refused(const bench *b, imk_result *result)
{
    const imk_calibration *c = b->calibration;
    const size_t total = b->result->observations_refused + b->result->turns_refused;
    size_t listed = 0;
    growing_list list = {0};
    for (size_t k = 0; k < c->observation_count + c->turn_count && listed < LISTED_MAX; k++) {
        const bool is_turn = k >= c->observation_count;
        const size_t i = is_turn ? k - c->observation_count : k;
        const double weight = is_turn ? c->turn[i].weight : c->observation[i].weight;
        const size_t begin = is_turn ? c->turn[i].begin : c->observation[i].begin;
        const imk_test_record *record =
            c->record[c->observation[is_turn ? (size_t)c->turn[i].from : i].record];
        if (weight > 0)
            continue;
        list_add_item(&list, "%s at %.2f s%s%s", is_turn ? "the turn" : "the observation",
                      bench_time(record, begin), b->log_count > 1 ? " of " : "",
                      b->log_count > 1 ? record->name : "");
        listed++;
    }
    if (total > listed)
        list_add(&list, " and %zu more", total - listed);
    if (total > 0)
        imk_result_line(result, "Left out, because they do not fit the others: %s.", list.text);
    list_free(&list);
}

/* The first pairs that are correlated above 0.9. */
static void show_correlated(const bench *b, imk_result *result)
{
    const imk_calibration_result *r = b->result;
    const size_t n = r->parameter_count;
    for (size_t i = 0, listed = 0; i < n; i++)
        for (size_t j = 0; j < i && listed < LISTED_MAX; j++) {
            const double value = r->covariance[i * n + j] / (r->sigma[i] * r->sigma[j]);
            char one[IMK_MODEL_PARAMETER_NAME], other[IMK_MODEL_PARAMETER_NAME];
            if (!(fabs(value) > 0.9) || imk_model_parameter_name(r->parameter[i], one) != IMK_OK ||
                imk_model_parameter_name(r->parameter[j], other) != IMK_OK)
                continue;
            imk_result_line(result, "Correlation of %s and %s: %+.4f.", other, one, value);
            listed++;
        }
}

void bench_show_remarks(const bench *b, imk_result *result)
{
    if (!b->result)
        return;
    show_frame(b, result);
    show_gravity(b, result);
    if (b->ferraris)
        imk_result_line(result, "Closed form: 1 sigma is that of the scatter within the holds and "
                                "of the angles of the turns; how well the faces were placed is not "
                                "in it, nor the Earth's rotation.");
    show_fixtures(b, result);
    show_refused(b, result);
    for (size_t k = 0; k < b->log_count; k++) { /* a reference that never holds still may lead */
        const imk_procedure_findings *f = &b->log[k].findings;
        if (f->lag_sigma > 0)
            imk_result_line(result,
                            "%s: the readings come %.4g ± %.2g ms after the reference, which was "
                            "allowed for.",
                            b->log[k].path, f->lag * 1e3, f->lag_sigma * 1e3);
    }
    show_correlated(b, result);
}
