/* SPDX-License-Identifier: Apache-2.0 */
/* A reference whose clock differs from that of the readings, or that comes late through its own
 * filters: the last part of a step is then compared with the level before it, which looks like
 * hysteresis and nonlinearity. The delay is found by imk_reference_offset() and taken out by whole
 * samples; what is left is far below the time that is trimmed from each step. */
#include "evaluate_job_internal.h"

#include "imukit/procedure.h"
#include "imukit/reference_alignment.h"

#include <math.h>
#include <string.h>

/* Delays looked for [s], of a quarter of the record at most. */
static const double largest_delay = 10;
/* Readings that follow their reference less than this do not tell when. */
static const double followed = 0.9;
/* What the errors of the sensor, such as hysteresis, and the interpolation do to a delay [samples].
 */
static const double own_part = 0.1;
/* Another delay that fits as well as this part of the best one: a sine. */
static const double ambiguous = 0.95;

/* Programmes are compared with the log where they are read. */
static bool is_told(const imk_calibrate_record *log)
{
    for (size_t k = 0; k < log->loaded.count; k++)
        if (strstr(log->loaded.item[k].code, "motion_offset"))
            return true;
    return false;
}

static bool find_delay(const imk_test_record *record, imki_arena *scratch,
                       imk_reference_shift *shift)
{
    const double most = fmin(largest_delay, 0.25 * (double)record->count * record->dt);
    const size_t size = imk_reference_offset_workspace_size(record, most);
    void *workspace = size > 0 ? imki_arena_take(scratch, size) : NULL;
    return workspace &&
           imk_reference_offset(record, most, shift, workspace, size, NULL) == IMK_OK &&
           shift->correlation > followed && fabs(shift->offset) >= record->dt + 5 * shift->sigma;
}

/* A channel `late` samples later; before and after it, not a number. */
static const double *moved(const double *channel, size_t count, long late, imki_arena *scratch)
{
    double *out = channel ? imki_arena_take(scratch, count * sizeof *out) : NULL;
    for (size_t k = 0; out && k < count; k++) {
        const long from = (long)k - late;
        out[k] = from >= 0 && from < (long)count ? channel[from] : (double)NAN;
    }
    return out;
}

static void move_reference(imk_test_record *record, long late, imki_arena *scratch)
{
    for (int k = 0; k < 3; k++) {
        record->reference_rate[k] = moved(record->reference_rate[k], record->count, late, scratch);
        record->reference_force[k] =
            moved(record->reference_force[k], record->count, late, scratch);
        record->reference_acceleration[k] =
            moved(record->reference_acceleration[k], record->count, late, scratch);
    }
}

imk_status imki_evaluate_align(imk_evaluate_log *v, const imk_calibrate_record *log,
                               imki_arena *scratch, imk_test_record *record, imk_error *error)
{
    imk_reference_shift shift;
    v->delay = 0;
    if (is_told(log) || !find_delay(record, scratch, &shift))
        return scratch->failed ? imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL) : IMK_OK;
    const double trim = isfinite(v->settings.trim)
                            ? v->settings.trim
                            : imk_procedure_default(IMK_PROCEDURE_RATE_TABLE).trim;
    const bool kept = v->settings.keep_delay || shift.rival > ambiguous * shift.correlation;
    const double misfit = own_part * record->dt;
    v->delay = -shift.offset;
    v->delay_sigma = sqrt(shift.sigma * shift.sigma + misfit * misfit);
    if (fabs(shift.offset) > 0.9 * trim)
        imki_find(&v->findings, IMK_FINDING_WARNING, "reference_delay", NULL,
                  IMKI_NUMBERS(fabs(shift.offset), shift.offset < 0, v->delay_sigma, kept));
    if (!kept)
        move_reference(record, lround(shift.offset / record->dt), scratch);
    return scratch->failed ? imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL) : IMK_OK;
}
