/* SPDX-License-Identifier: Apache-2.0 */
/* Whether the end of a track is a position, by what is known of its error. */
#include "navigate_aids_show_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A horizontal error beyond a nautical mile is no position [m]. */
static const double usable_error = 1852;
/* An error so many times the rms that is predicted is one in 400, if it is along one axis; the next
 * happens by no chance. */
static const double doubtful_ratio = 3, impossible_ratio = 5;

static double at_end(const imk_navigate_log *n, size_t column)
{
    return n->track[column][n->track_rows - 1];
}

static bool has_warning(const imk_findings *findings, const char *code)
{
    bool has = false;
    for (size_t k = 0; k < findings->count; k++)
        has = has || (findings->item[k].level == IMK_FINDING_WARNING &&
                      strcmp(findings->item[k].code, code) == 0);
    return has;
}

/* The unit stood still, and nothing corrected the track: the error itself is known. */
static imk_usability judge_error(const imk_navigate_log *n, double predicted, imki_reasons *reasons)
{
    const double error = hypot(at_end(n, IMK_TRACK_NORTH), at_end(n, IMK_TRACK_NORTH + 1));
    const double ratio = error / predicted;
    if (!n->settings.model) {
        imki_reason(reasons, "the horizontal error is %.3g m, and no model says what to expect",
                    error);
        return n->largest > usable_error ? IMK_NOT_USABLE : IMK_USABLE_WITH_CARE;
    }
    if (ratio > doubtful_ratio)
        imki_reason(reasons,
                    "the horizontal error is %.3g m, %.2g times the %.3g m rms that the model "
                    "predicts",
                    error, ratio, predicted);
    else
        imki_reason(reasons, "the horizontal error is %.3g m, and the model predicts %.3g m rms",
                    error, predicted);
    return ratio > impossible_ratio || error > usable_error ? IMK_NOT_USABLE
           : ratio > doubtful_ratio                         ? IMK_USABLE_WITH_CARE
                                                            : IMK_USABLE;
}

/* Of another track only what the model predicts is known; most readings have to fit that. */
static imk_usability judge_prediction(const imk_navigate_log *n, double predicted,
                                      imki_reasons *reasons)
{
    size_t used = 0, refused = 0;
    for (size_t k = 0; k < n->aid_count; k++) {
        used += n->aid[k].counts.accepted;
        refused += n->aid[k].counts.refused;
    }
    if (refused > used) {
        imki_reason(reasons, "most readings of aids do not fit, %zu of %zu", refused,
                    used + refused);
        return IMK_NOT_USABLE;
    }
    if (!n->settings.model) {
        imki_reason(reasons, "without a model or an aid nothing says how large the error is");
        return IMK_USABLE_WITH_CARE;
    }
    imki_reason(reasons, "by the model the horizontal position is known to %.3g m rms at the end",
                predicted);
    if (used + refused > 0)
        imki_reason(reasons, "%zu of %zu readings of aids fit", used, used + refused);
    return predicted <= usable_error ? IMK_USABLE : IMK_NOT_USABLE;
}

void imki_judge_navigation(const imk_navigate_log *n, imk_result *result)
{
    imki_reasons reasons = {.result = result};
    char elapsed[60], use[120];
    const bool corrected = n->aid_count > 0 || n->counts.accepted > 0;
    const bool lost =
        has_warning(&n->findings, "aid_lost") || has_warning(&n->findings, "updates_lost");
    const double predicted = hypot(at_end(n, IMK_TRACK_SIGMA), at_end(n, IMK_TRACK_SIGMA + 1));
    imk_usability usability = n->at_rest && !corrected ? judge_error(n, predicted, &reasons)
                                                       : judge_prediction(n, predicted, &reasons);
    if (lost)
        usability = IMK_NOT_USABLE;
    else if (imki_warned(&n->findings) && usability == IMK_USABLE)
        usability = IMK_USABLE_WITH_CARE;
    imki_reasons_of_warnings(&reasons, &n->findings);
    imk_readable_duration(n->record.dt * (double)(n->record.rows - n->first), elapsed,
                          sizeof elapsed);
    snprintf(use, sizeof use, " after %s", elapsed);
    imki_judge(&reasons, usability, use);
}
