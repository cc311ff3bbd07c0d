/* SPDX-License-Identifier: Apache-2.0 */
/* Records of different sensors: mean and spread of each term over them, and which of them differ.
 */
#include "identify_several_internal.h"

#include "imukit/distributions.h"

#include <math.h>

/* sqrt(a^2 + b^2) of numbers that are not negative, of any size. */
static double root_of_squares(double a, double b)
{
    const double large = fmax(a, b), ratio = large > 0 ? fmin(a, b) / large : 0;
    return large * sqrt(1 + ratio * ratio);
}

/* The two that are farthest apart, in sigmas. */
static void find_farthest(imk_device_term *t, size_t count)
{
    t->sigmas = -1;
    for (size_t r = 0; r < count; r++)
        for (size_t q = 0; q < count; q++) {
            const imk_device_strength *a = &t->device[r], *b = &t->device[q];
            const double sigmas =
                (b->square - a->square) / root_of_squares(a->square_sigma, b->square_sigma);
            if (q != r && sigmas > t->sigmas) {
                t->sigmas = sigmas;
                t->low = r;
                t->high = q;
            }
        }
}

static void compare(imk_identify_several *s, size_t channel, int term)
{
    imk_device_term *t = &s->term[channel][term];
    const double confidence = s->joint.settings.confidence;
    double square[IMK_JOINT_RECORDS_MAX], sigma[IMK_JOINT_RECORDS_MAX];
    bool any = false, all = true;
    for (size_t r = 0; r < s->count; r++) {
        t->device[r] = imki_strength_of(&s->log[r]->result[channel].term[term], confidence);
        square[r] = t->device[r].square;
        sigma[r] = t->device[r].square_sigma;
        any = any || t->device[r].present;
        all = all && sigma[r] > 0 && isfinite(sigma[r]);
    }
    const imk_population *p = &t->squares;
    t->compared =
        any && all &&
        imk_population_estimate(s->count, square, sigma, confidence, &t->squares) == IMK_OK;
    if (!t->compared)
        return;
    s->compared_count++;
    t->mean = sqrt(fmax(0, p->mean));
    t->lower = sqrt(fmax(0, p->mean_lower));
    t->upper = sqrt(fmax(0, p->mean_upper));
    t->spread = p->spread / (2 * t->mean);
    t->spread_lower = p->spread_lower / (2 * t->mean);
    t->spread_upper = p->spread_upper / (2 * t->mean);
    find_farthest(t, s->count);
}

imk_status imk_identify_devices(size_t count, const imk_identify_log *const *logs,
                                const imk_job *job, imk_identify_several **result, imk_error *error)
{
    imk_error own = {.status = IMK_OK};
    imk_identify_several *s = imki_several_begin(false, count, logs, job, &own);
    *result = s;
    if (error)
        *error = own;
    if (!s)
        return own.status;
    const size_t channels = s->joint.record.count;
    for (size_t c = 0; c < channels; c++)
        for (int term = 0; term < IMK_NOISE_RAMP; term++)
            compare(s, c, term);
    const double alarm = (1 - s->joint.settings.confidence) / fmax(1, (double)s->compared_count);
    for (size_t c = 0; c < channels; c++)
        for (int term = 0; term < IMK_NOISE_RAMP; term++) {
            imk_device_term *t = &s->term[c][term];
            t->differs = t->compared && t->squares.probability < alarm;
            s->differing_count += t->differs;
        }
    return IMK_OK;
}
