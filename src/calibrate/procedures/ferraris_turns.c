/* SPDX-License-Identifier: Apache-2.0 */
/* Turns about the axes of a housing: where they are, and what the sensors read on the average.
 *
 * Between two holds on the same face the unit came back to where it was, so that its gyros
 * integrate to whole turns about one axis and to nothing about the others. */
#include "six_position_internal.h"

#include "base/refuse_internal.h"
#include "base/text_internal.h"
#include "imukit/samples.h"

#include <math.h>
#include <string.h>

/* Share of the angle that a turn may lack by the nominal sensitivity, and that may fall on other
 * axes: misalignment and tilt of a hand-made turn are less, a mere move from face to face more. */
static const double slack = 0.3;

imki_turn_means imki_turn_mean(const imk_test_record *record, size_t begin, size_t end)
{
    imki_turn_means means;
    memset(&means, 0, sizeof means);
    bool gap = false;
    for (size_t k = begin; k < end; k++) {
        double step = record->dt;
        if (record->time && k > begin) {
            step = record->time[k] - record->time[k - 1];
            gap = gap || imk_step_is_gap(step, record->dt);
        }
        means.duration += step;
        for (int s = 0; s < 2; s++)
            for (int i = 0; i < record->axis_count[s]; i++)
                means.reading[s][i] += step * record->reading[s][i][k];
        means.temperature += step * (record->temperature ? record->temperature[k] : (double)NAN);
    }
    for (int s = 0; s < 2; s++)
        for (int i = 0; i < record->axis_count[s]; i++) {
            means.reading[s][i] /= means.duration;
            gap = gap || !isfinite(means.reading[s][i]);
        }
    means.temperature /= means.duration;
    if (gap)
        means.duration = (double)NAN;
    return means;
}

/* Readings of the gyros at rest: mean over the holds, by samples. */
static void rest_readings(const imki_session_stretches *list, double rest[3])
{
    double samples = 0.0;
    rest[0] = rest[1] = rest[2] = 0.0;
    for (size_t k = 0; k < list->count; k++) {
        const imk_ferraris_stretch *at = &list->stretch[k].at;
        if (at->turn)
            continue;
        const double n = (double)(at->end - at->begin);
        samples += n;
        for (int i = 0; i < 3; i++)
            rest[i] += n * list->stretch[k].summary.mean[IMK_GYRO][i];
    }
    for (int i = 0; i < 3; i++)
        rest[i] /= samples;
}

/* Angles turned by about each axis: [rad], or in counts seconds where nothing else is known. */
static bool angles_of(const imk_test_record *record, const imk_model *model,
                      const imk_ferraris_stretch *at, const double rest[3], double angle[3])
{
    const bool known = imki_unit_known(model, record, IMK_GYRO);
    const imki_turn_means means = imki_turn_mean(record, at->begin, at->end);
    for (int i = 0; i < 3; i++) {
        angle[i] = (means.reading[IMK_GYRO][i] - rest[i]) * means.duration;
        if (known)
            angle[i] /= imki_counts_per_unit(model, record, IMK_GYRO, i);
    }
    return isfinite(means.duration);
}

static int largest_of(const double angle[3])
{
    int axis = 0;
    for (int i = 1; i < 3; i++)
        if (fabs(angle[i]) > fabs(angle[axis]))
            axis = i;
    return axis;
}

static bool about_one_axis(const double angle[3], int axis)
{
    for (int i = 0; i < 3; i++)
        if (i != axis && !(fabs(angle[i]) < slack * fabs(angle[axis])))
            return false;
    return true;
}

static bool same_face(const imk_ferraris_stretch *a, const imk_ferraris_stretch *b)
{
    return !a->turn && !b->turn && a->axis == b->axis && a->sense == b->sense;
}

/* Turns between neighbouring holds on one face, behind the holds in the list. In known units the
 * reading says which way round; in counts positive readings are taken for turns by turn_angle. */
static void detect_turns(const imk_test_record *record, const imk_procedure_settings *settings,
                         const imk_model *model, const double rest[3], imki_session_stretches *list)
{
    const bool known = imki_unit_known(model, record, IMK_GYRO);
    const size_t holds = list->count;
    double angle[3], full = fabs(settings->turn_angle);
    for (int pass = known ? 1 : 0; pass < 2; pass++) {
        if (pass == 0)
            full = 0.0;
        for (size_t k = 1; k < holds && list->count < list->capacity; k++) {
            const imk_ferraris_stretch *before = &list->stretch[k - 1].at,
                                       *after = &list->stretch[k].at;
            imk_ferraris_stretch turn = {true, before->end, after->begin, 0, 1};
            if (!same_face(before, after) || turn.end <= turn.begin ||
                !angles_of(record, model, &turn, rest, angle))
                continue;
            turn.axis = largest_of(angle);
            if (!about_one_axis(angle, turn.axis))
                continue;
            if (pass == 0) {
                full = fmax(full, fabs(angle[turn.axis]));
                continue;
            }
            if (!(fabs(fabs(angle[turn.axis]) - full) < slack * full))
                continue;
            turn.sense = angle[turn.axis] > 0.0 ? 1 : -1;
            if (known && settings->turn_angle < 0.0)
                turn.sense = -turn.sense;
            imki_session_stretch *added = &list->stretch[list->count++];
            memset(added, 0, sizeof *added);
            added->at = turn;
            list->found++;
        }
    }
}

/* The hold before another, in time; NULL: there is none. */
static imki_session_stretch *hold_before(const imki_session_stretches *list, size_t begin)
{
    imki_session_stretch *last = NULL;
    for (size_t k = 0; k < list->count; k++) {
        imki_session_stretch *hold = &list->stretch[k];
        if (!hold->at.turn && hold->at.end <= begin && (!last || hold->at.end > last->at.end))
            last = hold;
    }
    return last;
}

/* A unit that is turned on the plate is not placed anew: holds on one face with a turn between them
 * are one placement. What is trimmed off the holds of sections lies between them and the turn. */
static void find_again(const imk_test_record *record, const imk_procedure_settings *settings,
                       imki_session_stretches *list)
{
    const double trimmed = list->detected ? 0.0 : settings->trim + settings->settle;
    const size_t apart = trimmed > 0.0 ? imk_samples_in(trimmed, record->dt) : 0;
    for (size_t k = 0; k < list->count; k++) {
        imki_session_stretch *hold = &list->stretch[k];
        const imki_session_stretch *before =
            hold->at.turn ? NULL : hold_before(list, hold->at.begin);
        for (size_t t = 0; before && t < list->count; t++) {
            const imk_ferraris_stretch *turn = &list->stretch[t].at;
            if (turn->turn && same_face(&before->at, &hold->at) && turn->begin >= before->at.end &&
                turn->begin <= before->at.end + apart && turn->end <= hold->at.begin &&
                turn->end + apart >= hold->at.begin)
                hold->again = true;
        }
    }
}

static imk_status turns_missing(int axes, const bool seen[3], imk_error *error)
{
    char missing[160] = "add a full turn about ";
    bool first = true;
    for (int i = 0; i < 3; i++) {
        if (seen[i])
            continue;
        imki_append_text(missing, sizeof missing, first ? "" : ", ");
        imki_append_text(missing, sizeof missing, i == 0 ? "x" : i == 1 ? "y" : "z");
        first = false;
    }
    imki_append_text(missing, sizeof missing,
                     "; if there is one, state its angle (--turn-angle), or look for missing "
                     "samples and a wrong range");
    return imki_refuse(error, IMK_ERROR_TOO_SHORT, "turn", axes, 3, missing);
}

imk_status imki_turns_find(const imk_test_record *record, const imk_procedure_settings *settings,
                           const imk_model *model, imki_session_stretches *list, imk_error *error)
{
    double rest[3], angle[3];
    bool seen[3] = {false};
    size_t kept = 0;
    if (record->axis_count[IMK_GYRO] != 3)
        return imk_error_set(error, IMK_ERROR_KEY_MISSING, "gyro", NULL, "three gyros");
    rest_readings(list, rest);
    if (list->detected)
        detect_turns(record, settings, model, rest, list);
    for (size_t k = 0; k < list->count; k++) {
        imki_session_stretch stretch = list->stretch[k];
        if (stretch.at.turn) {
            if (!angles_of(record, model, &stretch.at, rest, angle)) {
                list->left_out++;
                continue;
            }
            if (stretch.at.axis < 0)
                stretch.at.axis = largest_of(angle);
            seen[stretch.at.axis] = true;
        }
        list->stretch[kept++] = stretch;
    }
    list->count = kept;
    find_again(record, settings, list);
    const int axes = seen[0] + seen[1] + seen[2];
    return axes == 3 ? IMK_OK : turns_missing(axes, seen, error);
}
