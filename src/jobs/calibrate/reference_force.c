/* SPDX-License-Identifier: Apache-2.0 */
/* Are the forces of reference columns specific forces in their unit? At rest they are gravity, as
 * on a dividing head throughout; and accelerometers that a rate table carries along, which its
 * procedure does not use, read about the same. */
#include "calibrate_internal.h"

#include "jobs/job_internal.h"

#include <math.h>
#include <stdio.h>

static const double gravity = 9.80665;
/* Farther from gravity than any place and table is [share]. */
static const double far_from = 0.2;
/* Below this rate a unit is at rest [rad/s]. */
static const double at_rest = 5e-4;
/* Cosine of the angle between the forces of both, over the log, below which the axes differ. */
static const double alike = 0.8;

static double square_of(const double *const channel[3], size_t row)
{
    return channel[0][row] * channel[0][row] + channel[1][row] * channel[1][row] +
           channel[2][row] * channel[2][row];
}

/* Root mean square of the forces at rest; 0: it never rests, or that is not known. */
static double force_at_rest(const imk_calibrate_record *log)
{
    const imk_test_record *record = &log->record;
    double sum = 0, count = 0;
    if (!record->reference_rate[0] && log->procedure != IMK_PROCEDURE_TUMBLE)
        return 0;
    for (size_t k = 0; k < record->count; k++) {
        const bool turns = record->reference_rate[0] &&
                           !(square_of(record->reference_rate, k) < at_rest * at_rest);
        const double square = square_of(record->reference_force, k);
        if (turns || !isfinite(square))
            continue;
        sum += square;
        count++;
    }
    return count > 0 ? sqrt(sum / count) : 0;
}

static void check_size(imk_calibrate_record *log)
{
    static const struct {
        double ratio;
        const char *unit;
    } units[] = {{1 / 9.80665, "g"}, {9.80665, "m/s^2"}, {1000 / 9.80665, "mg"}, {1e-3, "m/s^2"}};
    const double force = force_at_rest(log), ratio = force / gravity;
    const char *unit = NULL;
    if (force == 0 || fabs(ratio - 1) < far_from)
        return;
    for (size_t k = 0; k < sizeof units / sizeof units[0]; k++)
        if (fabs(ratio / units[k].ratio - 1) < far_from)
            unit = units[k].unit;
    imki_find(&log->loaded, IMK_FINDING_WARNING, "calibrate:reference_force", unit,
              IMKI_NUMBERS(force, unit != NULL));
}

/* Their own accelerometers beside them. */
static void check_direction(imk_calibrate_record *log)
{
    const imk_test_record *record = &log->record;
    double both = 0, read = 0, due = 0;
    if (log->procedure != IMK_PROCEDURE_RATE_TABLE || record->axis_count[1] != 3 ||
        record->counts[1])
        return;
    for (size_t k = 0; k < record->count; k++) {
        double product = 0;
        for (int i = 0; i < 3; i++)
            product += record->reading[1][i][k] * record->reference_force[i][k];
        if (!isfinite(product))
            continue;
        both += product;
        read += square_of(record->reading[1], k);
        due += square_of(record->reference_force, k);
    }
    const double cosine = both / sqrt(read * due);
    if (cosine < alike)
        imki_find(&log->loaded, IMK_FINDING_WARNING, "calibrate:reference_direction", NULL,
                  IMKI_NUMBERS(cosine, cosine < -alike));
}

void imki_check_reference_force(imk_calibrate_record *log)
{
    if (!log->record.reference_force[0] || log->record.means)
        return;
    check_size(log);
    check_direction(log);
}
