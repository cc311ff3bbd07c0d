/* SPDX-License-Identifier: Apache-2.0 */
/* Several records that were identified alone, put side by side. */
#include "identify_several_internal.h"

#include "jobs/arena_internal.h"

#include "imukit/distributions.h"

#include <math.h>
#include <string.h>

imk_status imk_identify_comparable(const imk_identify_log *first, const imk_identify_log *other,
                                   bool runs, imk_error *error)
{
    const imk_even_record *a = &first->record, *b = &other->record;
    bool same = a->count == b->count;
    for (size_t c = 0; c < a->count && same; c++)
        same = strcmp(imk_even_record_column(a, c)->name, imk_even_record_column(b, c)->name) == 0;
    if (!same)
        return imk_error_set(error, IMK_ERROR_CONFLICT, "channels", "not those of the first record",
                             "only records with the same columns can be compared");
    if (runs && fabs(b->dt / a->dt - 1) > 1e-3)
        return imk_error_set(error, IMK_ERROR_CONFLICT, "rate", "not that of the first record",
                             "runs of one sensor have one sampling rate");
    return IMK_OK;
}

/* A likelihood profile reaches as far above the likeliest square as the confidence has sigmas. */
imk_device_strength imki_strength_of(const imk_estimate *e, double confidence)
{
    const double z = imk_normal_quantile(0.5 + confidence / 2);
    const double centre = e->free_value > 0 ? e->free_value : e->value;
    imk_device_strength s = {
        .present = e->present, .value = e->value, .sigma = e->sigma, .bound = e->upper};
    s.square = centre * centre;
    s.square_sigma = e->present ? 2 * e->value * e->sigma : (e->upper * e->upper - s.square) / z;
    return s;
}

/* Numbers of the same readings differ by the rounding of their units. */
static bool same_number(double a, double b)
{
    return fabs(a - b) <= 1e-9 * fabs(a);
}

/* A copy of a record has its means and its Allan deviations in all digits, on every channel: noise
 * never has them twice. */
static bool same_readings(const imk_identify_log *a, const imk_identify_log *b)
{
    bool same = a->record.rows == b->record.rows;
    for (size_t c = 0; c < a->record.count && same; c++) {
        const imk_allan_curve *one = &a->curve[c], *other = &b->curve[c];
        same = one->count > 0 && one->count == other->count &&
               same_number(a->result[c].mean, b->result[c].mean);
        for (size_t k = 0; k < one->count && same; k++)
            same = same_number(one->point[k].deviation, other->point[k].deviation);
    }
    return same;
}

static imk_status refuse_copies(size_t count, const imk_identify_log *const *logs, imk_error *error)
{
    for (size_t r = 1; r < count; r++)
        for (size_t q = 0; q < r; q++)
            if (same_readings(logs[q], logs[r])) {
                imk_error_set(error, IMK_ERROR_CONFLICT, "readings",
                              "all are those of an earlier record, which would count twice",
                              "leave one of the two out");
                if (error) {
                    error->index = (int)r;
                    error->value = (double)q;
                }
                return IMK_ERROR_CONFLICT;
            }
    return IMK_OK;
}

void imk_identify_several_free(imk_identify_several *result)
{
    if (!result)
        return;
    const imk_allocator allocator = result->joint.record.log.allocator;
    for (size_t c = 0; c < IMK_LOG_COLUMNS_MAX; c++)
        imk_allan_curve_free(&result->joint.curve[c], &allocator);
    imki_resize(&allocator, result, 0);
}

imk_identify_several *imki_several_begin(bool runs, size_t count,
                                         const imk_identify_log *const *logs, const imk_job *job,
                                         imk_error *error)
{
    for (size_t r = 1; r < count; r++)
        if (imk_identify_comparable(logs[0], logs[r], false, error) != IMK_OK) {
            if (error)
                error->index = (int)r;
            return NULL;
        }
    if (count < 2 || count > IMK_JOINT_RECORDS_MAX) {
        imk_error_set(error, IMK_ERROR_ARGUMENT, "count", NULL, NULL);
        return NULL;
    }
    if (refuse_copies(count, logs, error) != IMK_OK)
        return NULL;
    const imk_allocator allocator = job ? job->allocator : (imk_allocator){0};
    imk_identify_several *s = imki_resize(&allocator, NULL, sizeof *s);
    if (!s) {
        imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
        return NULL;
    }
    memset(s, 0, sizeof *s);
    s->runs = runs;
    s->count = count;
    imk_identify_log *joint = &s->joint;
    joint->settings = logs[0]->settings;
    joint->settings.summarise = false;
    joint->origin = IMK_IDENTIFY_RECORDS;
    joint->record = logs[0]->record;
    memset(joint->record.log.data, 0, sizeof joint->record.log.data); /* the record's own */
    joint->record.log.label = NULL;
    joint->record.log.label_count = 0;
    joint->record.log.allocator = allocator;
    joint->record.temperature = NULL;
    for (size_t r = 0; r < count; r++) {
        const imk_even_record *record = &logs[r]->record;
        s->log[r] = logs[r];
        joint->record.rows = record->rows > joint->record.rows ? record->rows : joint->record.rows;
        joint->duration += logs[r]->duration;
    }
    return s;
}
