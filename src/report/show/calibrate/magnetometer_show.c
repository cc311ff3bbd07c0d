/* SPDX-License-Identifier: Apache-2.0 */
/* The calibration of a magnetometer as data and in words: which axes, which scale, which field. */
#include "calibrate_show_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double degree = 0.017453292519943295;

static double dip_of(const imk_magnetometer_result *r)
{
    return asin(fmax(-1, fmin(1, r->value[IMK_MAGNETOMETER_DIP])));
}

/* 1 sigma of the dip, from that of its sine. */
static double dip_sigma_of(const imk_magnetometer_result *r)
{
    const double sine = r->value[IMK_MAGNETOMETER_DIP];
    return r->sigma[IMK_MAGNETOMETER_DIP] /
           sqrt(fmax(1 - sine * sine, r->sigma[IMK_MAGNETOMETER_DIP]));
}

/* Rests one by one; readings in motion are too many. */
static void show_means(const imk_calibrate_log *b, imk_result *result)
{
    const imk_magnetometer *problem = b->magnetometer;
    imk_result_array(result, "poses");
    for (size_t k = 0; !problem->series && k < problem->count; k++) {
        const imk_magnetometer_observation *o = &problem->observation[k];
        const imk_test_record *record = &b->record[o->record].record;
        imk_result_object(result, NULL);
        imk_result_text(result, "log", record->name);
        imk_result_quantity(result, "begin", imk_test_record_time(record, o->begin), "s");
        imk_result_numbers(result, "field", 3, o->field);
        imk_result_quantity(result, "field_residual", o->residual[0], "T");
        imk_result_quantity(result, "vertical_residual", o->residual[1], "T");
        imk_result_number(result, "distance", o->distance);
        imk_result_number(result, "weight", o->weight);
        imk_result_end(result);
    }
    imk_result_end(result);
}

void imki_magnetometer_data(const imk_calibrate_log *b, imk_result *result)
{
    const imk_magnetometer_result *r = b->mag;
    if (!imki_begin_object(result, "magnetometer", r))
        return;
    imk_result_flag(result, "aligned", r->aligned);
    imk_result_text(
        result, "frame",
        imk_triad_frame_name(r->aligned ? b->calibration->frame : b->magnetometer->frame));
    imk_result_flag(result, "field_known", r->field_known);
    imk_result_quantity(result, "field", r->value[IMK_MAGNETOMETER_FIELD], "T");
    imk_result_quantity(result, "field_sigma", r->sigma[IMK_MAGNETOMETER_FIELD], "T");
    imk_result_quantity(result, "dip", dip_of(r), "rad");
    imk_result_quantity(result, "dip_sigma", dip_sigma_of(r), "rad");
    imk_result_count(result, "means", (long long)b->magnetometer->count);
    imk_result_count(result, "refused", (long long)r->refused);
    imk_result_number(result, "chi_square", r->chi_square);
    imk_result_number(result, "degrees_of_freedom", r->degrees_of_freedom);
    imk_result_number(result, "factor", r->factor);
    imk_result_quantity(result, "added", r->added, "T");
    imk_result_number(result, "serial", r->serial);
    imk_result_quantity(result, "rms", fmax(r->rms[0], r->rms[1]), "T");
    imk_result_number(result, "spread", r->spread);
    show_means(b, result);
    imk_result_end(result);
}

void imki_magnetometer_row(const imk_calibrate_log *b, imk_table *table)
{
    const imk_magnetometer_result *r = b->mag;
    if (!r)
        return;
    const double rms = fmax(r->rms[0], r->rms[1]);
    const imk_unit unit = imk_unit_readable(imk_unit_of("T").dimension, rms);
    const double ratio = sqrt(r->chi_square / fmax(r->degrees_of_freedom, 1));
    imk_table_row(table, "magnetometer\t%zu\t%zu\t%.4g / %.1f\t%.3g\t%.4g %s", r->equations,
                  r->refused, r->chi_square, r->degrees_of_freedom, ratio, rms / unit.scale,
                  unit.text);
}

static bool is_told(const imk_calibrate_log *b, const char *code)
{
    for (size_t k = 0; k < b->findings.count; k++)
        if (strcmp(b->findings.item[k].code, code) == 0)
            return true;
    return false;
}

/* Rests without weight, by time; readings in motion are too many. */
static void show_refused(const imk_calibrate_log *b, imk_result *result)
{
    enum { LISTED_MAX = 8 };
    const imk_magnetometer *problem = b->magnetometer;
    size_t refused = 0;
    imki_text list = {0};
    for (size_t k = 0; !problem->series && k < problem->count; k++) {
        const imk_magnetometer_observation *o = &problem->observation[k];
        const imk_test_record *record = &b->record[o->record].record;
        if (o->weight > 0 || ++refused > LISTED_MAX)
            continue;
        imki_list_item(&list, "%.2f s", imk_test_record_time(record, o->begin));
        if (b->count > 1)
            imki_text_add(&list, " of %s", record->name);
    }
    if (refused > LISTED_MAX)
        imki_text_add(&list, " and %zu more", refused - LISTED_MAX);
    if (refused > 0)
        imk_result_line(result, "Rests left out for the magnetometer: at %s.", list.bytes);
    free(list.bytes);
}

void imki_magnetometer_remarks(const imk_calibrate_log *b, imk_result *result)
{
    const imk_magnetometer_result *r = b->mag;
    char field[40], dip[40];
    if (!r)
        return;
    show_refused(b, result);
    imk_readable_value(1e6 * r->value[IMK_MAGNETOMETER_FIELD],
                       1e6 * r->sigma[IMK_MAGNETOMETER_FIELD], 5, field, sizeof field);
    if (r->field_known)
        imk_result_line(result, "Magnetometer: its scale is that of the field given, %s uT.",
                        field);
    else
        imk_result_line(result,
                        "Magnetometer: the field is not known (--field), so its scale is a "
                        "convention, by which the determinant of its matrix is 1; the field is "
                        "then %s uT.",
                        field);
    if (!r->aligned) {
        imk_result_line(result,
                        "Its matrix is %s by convention: without accelerometers beside it, how its "
                        "axes stand to those of the unit is not determined.",
                        imk_triad_frame_name(b->magnetometer->frame));
        return;
    }
    imk_readable_value(dip_of(r) / degree, dip_sigma_of(r) / degree, 5, dip, sizeof dip);
    imk_result_line(
        result,
        "It is aligned to the axes of the accelerometers, against which it is turned by "
        "%.3g deg: the dip of the field is %s, %s deg. Hard iron "
        "is its bias; soft iron, scale and alignment are one matrix.",
        r->nearest_angle / degree,
        is_told(b, "mag_disturbed") ? "taken for the same in all attitudes, although the field is "
                                      "not"
                                    : "the same in all attitudes",
        dip);
}
