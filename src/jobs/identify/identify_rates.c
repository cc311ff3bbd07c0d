/* SPDX-License-Identifier: Apache-2.0 */
/* Runs of one sensor at several rates. Their spectra have no bands in common, so there is no joint
 * estimate: the terms are those of the longest record. But only they tell what the readings of the
 * integral have at every rate from what they have less of at a lower one. */
#include "identify_several_internal.h"

#include "jobs/allan/allan_curve_internal.h"

#include "imukit/distributions.h"

#include <math.h>

/* The interval of an estimate also covers other sets of terms, which sigma does not know of: the
 * longer of its sides counts. */
static double sigma_of_square(const imk_estimate *e, imk_device_strength s, double confidence)
{
    const double z = imk_normal_quantile(0.5 + confidence / 2);
    const double side = fmax(e->upper * e->upper - s.square, s.square - e->lower * e->lower);
    return fmax(s.square_sigma, side / z);
}

/* The readings of a channel, if the term is there at two rates at least and is counted in no
 * record. */
static imk_status part_channel(imk_identify_several *s, size_t channel)
{
    double dt[IMK_JOINT_RECORDS_MAX], square[IMK_JOINT_RECORDS_MAX], sigma[IMK_JOINT_RECORDS_MAX];
    const double confidence = s->joint.settings.confidence;
    double first = 0;
    bool two = false;
    size_t count = 0;
    for (size_t r = 0; r < s->count; r++) {
        const imk_identification *one = &s->log[r]->result[channel];
        const imk_estimate *e = &one->term[IMK_NOISE_QUANTIZATION];
        const imk_device_strength strength = imki_strength_of(e, confidence);
        if (e->present && imk_identification_counted(one))
            return IMK_OK;
        if (e->present) {
            first = first > 0 ? first : one->dt;
            two = two || fabs(one->dt / first - 1) > 1e-3;
        }
        const double scatter = sigma_of_square(e, strength, confidence);
        if (!(scatter > 0) || !isfinite(scatter))
            continue;
        dt[count] = s->log[r]->record.dt;
        square[count] = strength.square;
        sigma[count++] = scatter;
    }
    return two ? imk_reading_parts_estimate(count, dt, square, sigma, confidence,
                                            s->joint.settings.significance, &s->readings[channel])
               : IMK_OK;
}

/* The joint estimate becomes that of one record. */
static imk_status take_longest(imk_identify_several *s)
{
    for (size_t r = 1; r < s->count; r++)
        if (s->log[r]->duration > s->log[s->longest]->duration)
            s->longest = r;
    const imk_identify_log *log = s->log[s->longest];
    imk_identify_log *joint = &s->joint;
    joint->record.rows = log->record.rows;
    joint->record.dt = log->record.dt;
    joint->duration = log->duration;
    joint->readings = s->readings;
    for (size_t c = 0; c < joint->record.count; c++) {
        const imk_allan_curve *curve = &log->curve[c];
        joint->result[c] = log->result[c];
        joint->result[c].term[IMK_NOISE_RAMP] = (imk_estimate){0}; /* each record has its own */
        if (imki_allan_curve_of(curve->count, curve->point, log->record.dt,
                                &joint->record.log.allocator, &joint->curve[c]) != IMK_OK)
            return IMK_ERROR_MEMORY;
    }
    return IMK_OK;
}

/* By chance fewer than one comparison of all channels in a hundred finds that nothing explains the
 * readings. */
static const double alarm = 0.01;

imk_status imki_compare_rates(imk_identify_several *s, size_t other, imk_error *error)
{
    bool any = false;
    for (size_t c = 0; c < s->joint.record.count; c++) {
        const imk_status status = part_channel(s, c);
        if (status != IMK_OK)
            return imk_error_set(error, status, imk_even_record_column(&s->joint.record, c)->name,
                                 NULL, NULL);
        any = any || s->readings[c].count > 0;
        s->differs[c] = s->readings[c].count > 0 &&
                        s->readings[c].probability < alarm / (double)s->joint.record.count;
        if (s->differs[c])
            s->readings[c].kind = IMK_READING_UNTOLD;
    }
    if (!any) {
        imk_error_set(error, IMK_ERROR_CONFLICT, "rate", "not that of the first record",
                      "runs of one sensor have one sampling rate");
        if (error)
            error->index = (int)other;
        return IMK_ERROR_CONFLICT;
    }
    s->rates = true;
    return take_longest(s) == IMK_OK ? IMK_OK
                                     : imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
}
