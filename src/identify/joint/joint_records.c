/* SPDX-License-Identifier: Apache-2.0 */
/* One likelihood for several records of a sensor.
 *
 * A summary is the bands of a record with its ramp taken out. Coefficients that stand alone, at the
 * lowest frequencies, are kept from every record, with the length of its transform; bands of
 * several whose centres agree to 1 % are averaged, degrees of freedom as weights. What comes out is
 * a set of bands like that of one record, and goes the same way: terms, then intervals. */
#include "joint_internal.h"

#include "base/refuse_internal.h"

#include <math.h>
#include <string.h>

static bool stands_alone(const imki_bands *bands, size_t b)
{
    return bands->degrees[b] < 1.5;
}

static void copy_band(imki_bands *to, const imki_bands *from, size_t b, double factor)
{
    const size_t at = to->count++;
    to->frequency[at] = from->frequency[b];
    to->degrees[at] = from->degrees[b];
    to->length[at] = from->length[b];
    to->power[at] = from->power[b] * factor;
}

/* Bands that are averaged may differ this much in frequency. */
static const double same_frequency = 0.01;

static bool may_join(const imki_bands *a, size_t i, const imki_bands *b, size_t j)
{
    return !stands_alone(a, i) && !stands_alone(b, j) &&
           fabs(a->frequency[i] - b->frequency[j]) < same_frequency * a->frequency[i];
}

/* Both, in the order of their frequencies, into `out`; false when they are too many. */
static bool merge(const imki_bands *a, const imki_bands *b, double factor, imki_bands *out)
{
    size_t i = 0, j = 0;
    out->count = 0;
    while (i < a->count || j < b->count) {
        if (out->count == IMKI_BANDS_MAX)
            return false;
        if (i < a->count && j < b->count && may_join(a, i, b, j)) {
            const size_t at = out->count;
            const double p = a->degrees[i], q = b->degrees[j], sum = p + q;
            copy_band(out, a, i, 1);
            out->frequency[at] = (p * a->frequency[i] + q * b->frequency[j]) / sum;
            out->power[at] = (p * a->power[i] + q * factor * b->power[j]) / sum;
            out->degrees[at] = sum;
            i++;
            j++;
        } else if (j == b->count || (i < a->count && a->frequency[i] <= b->frequency[j])) {
            copy_band(out, a, i++, 1);
        } else {
            copy_band(out, b, j++, factor);
        }
    }
    return true;
}

/* The summaries as one set in `bands`; `other` is as large, and used by turns. */
static bool join(size_t count, const imk_spectral_summary *const *summaries, imki_bands *bands,
                 imki_bands *other)
{
    imki_bands *now = bands, *next = other;
    size_t longest = 0;
    double dt = 0;
    memset(bands, 0, sizeof *bands);
    memset(other, 0, sizeof *other);
    for (size_t r = 0; r < count; r++) {
        const imk_spectral_summary *s = summaries[r];
        const double factor = summaries[0]->scale / s->scale;
        if (!merge(now, &s->bands, factor * factor, next))
            return false;
        imki_bands *swap = now;
        now = next;
        next = swap;
        longest = s->bands.n > longest ? s->bands.n : longest;
        dt += s->bands.dt / (double)count;
    }
    if (now != bands)
        *bands = *now;
    bands->dt = dt;
    bands->n = longest + 1; /* no band is that of a whole record whose two ends are known */
    return true;
}

static imk_status check(const imk_identify_settings *settings, size_t count,
                        const imk_spectral_summary *const *summaries, size_t workspace_size,
                        imk_error *error)
{
    const imk_status status = imki_identify_check(settings, error);
    if (status != IMK_OK)
        return status;
    if (count < 2 || count > IMK_JOINT_RECORDS_MAX)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "records", NULL, "2 to 24");
    if (workspace_size < imk_identify_joint_workspace_size())
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "workspace", NULL,
                             "imk_identify_joint_workspace_size() bytes");
    for (size_t r = 0; r < count; r++) {
        if (summaries[r]->cookie != IMKI_SUMMARY_COOKIE)
            return imk_error_set(error, IMK_ERROR_UNINITIALISED, "summary", NULL,
                                 "identify each record with settings.summary first");
        if (!(fabs(summaries[r]->bands.dt / summaries[0]->bands.dt - 1) < 1e-3)) {
            return imki_refuse_at(error, IMK_ERROR_CONFLICT, "sample interval", r, 0.0, 0.0,
                                  "use records of the same sample rate");
        }
    }
    return IMK_OK;
}

/* Wide resonances of all records, those of the same frequency once, for the joint fit to begin
 * with. */
static void gather_resonances(size_t count, const imk_identification *single,
                              imk_identification *joint, double scale)
{
    for (size_t r = 0; r < count; r++)
        for (int k = 0; k < single[r].resonance_count; k++) {
            const imk_resonance *found = &single[r].resonance[k];
            bool known = found->q > IMKI_NARROW || joint->resonance_count == IMK_TERMS_MAX;
            for (int i = 0; i < joint->resonance_count && !known; i++) {
                const imk_resonance *other = &joint->resonance[i];
                known = fabs(found->frequency - other->frequency) <
                        found->frequency / found->q + other->frequency / other->q;
            }
            if (known)
                continue;
            joint->resonance[joint->resonance_count] = *found;
            joint->resonance[joint->resonance_count++].sigma *= scale;
        }
}

size_t imk_identify_joint_workspace_size(void)
{
    imki_work unused;
    imki_parts parts = imki_parts_of(NULL);
    imki_work_take_fits(&unused, &parts);
    imki_take(&parts, sizeof(imki_bands));
    return imki_parts_size(&parts);
}

imk_status imk_identify_joint(const imk_identify_settings *settings, size_t count,
                              const imk_spectral_summary *const *summaries,
                              const imk_identification *single, imk_identification *joint,
                              imk_joint_agreement *agreement, void *workspace,
                              size_t workspace_size, imk_error *error)
{
    const imk_status status = check(settings, count, summaries, workspace_size, error);
    if (status != IMK_OK)
        return status;
    imki_parts parts = imki_parts_of(workspace);
    imki_work work = {.settings = settings, .scale = summaries[0]->scale, .bands_given = true};
    imki_work_take_fits(&work, &parts);
    imki_bands *other = imki_take(&parts, sizeof *other);
    if (!join(count, summaries, work.bands, other))
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "records", NULL,
                             "fewer records, or records of the same length");
    work.n = work.bands->n;
    imk_identification found = {0};
    gather_resonances(count, single, &found, work.scale);
    imki_identify_terms(&work, &found);
    imk_joint_agreement agree = {.record = -1, .term = -1};
    if (agreement)
        imki_joint_agreement(&work, &found, count, summaries, other, &agree);
    imki_identify_intervals(&work, &found);
    found.term[IMK_NOISE_RAMP] = (imk_estimate){0}; /* nothing is known of one: each had its own */
    found.dt = settings->dt;
    found.resolution = single[0].resolution;
    for (size_t r = 0; r < count; r++) {
        found.mean += single[r].mean / (double)count;
        if (fabs(single[r].resolution - single[0].resolution) > 0.01 * single[0].resolution)
            found.resolution = 0; /* no grid of all */
    }
    imki_identification_rescale(&found, 1 / work.scale);
    if (!imki_identification_is_finite(&found))
        return imk_error_set(error, IMK_ERROR_NO_CONVERGENCE, NULL, "no noise in the records",
                             "records of a real sensor: these are smooth or too regular");
    *joint = found;
    if (agreement)
        *agreement = agree;
    return IMK_OK;
}
