/* SPDX-License-Identifier: Apache-2.0 */
/* Static detection: windows of four blocks, one starting with each block, are compared with what
 * the log's own rest shows (static_noise.c). A window stands when on every axis
 *
 *     variance within        <= limit (F quantile),
 *     difference of halves   <= limit (slow turning, which hardly scatters),
 *     rate less that at rest <= limit (steady turning, which does not scatter at all);
 *
 * the rate at rest follows the bias of the gyros from one standing window to the next, so that it
 * may drift, and may differ by a typical g-sensitivity times the change of the force. Runs of
 * standing windows, less a guard at both ends, are the intervals. The noise is learnt from the
 * quietest stretch first, then from the longest interval that is as quiet.
 *
 * A window that is not given is the longest of 0.4, 0.8 and 1.6 s (at least 16 samples) that still
 * finds 85 % of the intervals and 80 % of the standing time: a long one sees slower turning, a
 * short one loses less of a short hold. */
#include "base/refuse_internal.h"
#include "base/workspace_internal.h"
#include "static_internal.h"

#include "imukit/samples.h"

#include <math.h>

enum { COOKIE = 0x1DE70021, SAMPLES_MIN = 64, WINDOW_SAMPLES_MIN = 16, LEVELS_MAX = 3 };

static const double WINDOW_SHORTEST = 0.4, WINDOW_LONGEST = 2.0; /* [s] */

imk_static_settings imk_static_default(void)
{
    return (imk_static_settings){
        .cookie = COOKIE, .false_alarm = 1e-4, .minimum = 1.0, .guard = -1.0};
}

/* ---- sizes -------------------------------------------------------------------------------------
 */

/* Samples of a block: a quarter of the window, or of the shortest one that is tried. */
static size_t block_length(const imk_test_record *record, const imk_static_settings *settings)
{
    const double window = settings->window > 0.0 ? settings->window : WINDOW_SHORTEST;
    const double samples = window / record->dt;
    const size_t least = settings->window > 0.0 ? 2 * IMKI_WINDOW_BLOCKS : WINDOW_SAMPLES_MIN;
    size_t n = samples < (double)record->count ? (size_t)(samples + 0.5) : record->count;
    n = n < least ? least : n;
    const size_t block = (n + IMKI_WINDOW_BLOCKS / 2) / IMKI_WINDOW_BLOCKS;
    /* Where there is a choice, a multiple of four samples, which are added side by side. */
    return settings->window > 0.0 ? block : (block + 3) & ~(size_t)3;
}

static int axes_of(const imk_test_record *record)
{
    int axes = 0;
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < record->axis_count[sensor] && i < IMK_AXES_MAX; i++)
            axes += record->reading[sensor][i] != NULL;
    return axes;
}

/* Doubles of one array over blocks, in whole cache lines. */
static size_t padded(size_t count)
{
    return (count + 7) & ~(size_t)7;
}

size_t imk_static_workspace_size(const imk_test_record *record, const imk_static_settings *settings)
{
    if (!record || !settings || !(record->dt > 0.0))
        return 0;
    const size_t blocks = padded(record->count / block_length(record, settings));
    /* For each axis mean and square, kept for the window chosen and for the one at work; activity
     * and scratch; flags, twice. */
    return IMKI_ALIGNMENT_SLACK +
           blocks * (sizeof(double) * (4 * (size_t)axes_of(record) + 2) + 2 * sizeof(uint8_t));
}

/* ---- intervals ----------------------------------------------------------------------------------
 */

typedef struct lengths {
    size_t guard, minimum; /* samples */
} lengths;

static lengths lengths_of(const imki_static_job *job, const imk_static_settings *settings)
{
    lengths l;
    l.guard = settings->guard < 0.0 ? job->blocks.length * IMKI_WINDOW_BLOCKS
                                    : imk_samples_in(settings->guard, job->record->dt);
    l.minimum = imk_samples_in(settings->minimum, job->record->dt);
    l.minimum = l.minimum < 2 ? 2 : l.minimum;
    return l;
}

/* Samples of a run that count; false when they are too few. */
static bool trim(const imki_static_job *job, lengths l, imki_static_run r, size_t *begin,
                 size_t *end)
{
    *begin = r.begin * job->blocks.length + l.guard;
    *end = r.end * job->blocks.length;
    *end = *end > l.guard ? *end - l.guard : 0;
    return *end >= *begin + l.minimum;
}

/* A run as quiet as the stretch that was learnt from, not merely within the limits. */
static bool as_quiet(const imki_static_job *job, imki_static_run r)
{
    const imki_static_blocks *b = &job->blocks;
    for (int a = 0; a < job->axis_count; a++) {
        if (job->limit[a].scatter_squared == 0.0)
            continue;
        double variance = 0.0, windows = 0.0;
        for (size_t w = r.begin; w + IMKI_WINDOW_BLOCKS <= r.end; w += IMKI_WINDOW_BLOCKS) {
            variance += imki_static_window(b, a, w).variance;
            windows += 1.0;
        }
        const double step = job->axis[a].step, noise = job->limit[a].noise;
        if (variance / windows > 2.0 * noise * noise + 0.25 * step * step)
            return false;
    }
    return true;
}

/* Learn again from the longest run that is quiet, a window left out at both ends. */
static bool learn_again(imki_static_job *job)
{
    const size_t least = (size_t)IMKI_REST_WINDOWS * IMKI_WINDOW_BLOCKS;
    imki_static_run longest = {0, 0}, r;
    for (size_t w = 0; imki_static_next_run(job, &w, &r);)
        if (r.end - r.begin > longest.end - longest.begin &&
            r.end - r.begin >= least + 2 * IMKI_WINDOW_BLOCKS && as_quiet(job, r))
            longest = r;
    longest.begin += IMKI_WINDOW_BLOCKS;
    if (longest.end <= longest.begin)
        return false;
    longest.end -= IMKI_WINDOW_BLOCKS;
    if (longest.begin == job->rest_begin && longest.end == job->rest_end)
        return false;
    imki_static_learn(job, longest.begin, longest.end);
    imki_static_assess(job);
    return true;
}

/* Longest stretch of usable blocks at the beginning that was said to be at rest. */
static bool given_rest(imki_static_job *job, double initial_rest)
{
    const imki_static_blocks *b = &job->blocks;
    size_t end = imk_samples_in(initial_rest, job->record->dt) / b->length;
    end = end < b->count ? end : b->count;
    imki_static_run longest = {0, 0}, r = {0, 0};
    for (size_t k = 0; k < end; k++) {
        if (b->flag[k] & IMKI_BLOCK_BREAK)
            r.begin = k;
        r.end = k + 1;
        if (b->flag[k] & IMKI_BLOCK_INVALID)
            r.begin = k + 1;
        else if (r.end - r.begin > longest.end - longest.begin)
            longest = r;
    }
    if (longest.end - longest.begin < 2 * IMKI_WINDOW_BLOCKS)
        return false;
    imki_static_learn(job, longest.begin, longest.end);
    job->rests = imki_static_looks_at_rest(job, longest.begin, longest.end);
    return true;
}

/* What a window finds; `thorough`: with the noise of the longest rest instead of the quietest. How
 * many intervals, and how long they are together. */
typedef struct outcome {
    size_t intervals, samples, too_short, standing;
} outcome;

static outcome detect_at(imki_static_job *job, const imk_static_settings *settings, bool thorough)
{
    outcome found = {0, 0, 0, 0};
    job->rests = false;
    job->rest_begin = job->rest_end = 0;
    if (settings->initial_rest > 0.0) {
        if (!given_rest(job, settings->initial_rest))
            return found;
        imki_static_assess(job);
    } else {
        imki_static_find_rest(job);
        if (job->rest_end == 0)
            return found;
        imki_static_assess(job);
        if (job->rests && thorough && learn_again(job))
            learn_again(job);
    }
    if (!job->rests)
        return found;
    const lengths l = lengths_of(job, settings);
    imki_static_run r;
    for (size_t w = 0; imki_static_next_run(job, &w, &r);) {
        size_t begin, end;
        found.standing += (r.end - r.begin) * job->blocks.length;
        if (trim(job, l, r, &begin, &end)) {
            found.intervals++;
            found.samples += end - begin;
        } else {
            found.too_short++;
        }
    }
    return found;
}

/* ---- the window -------------------------------------------------------------------------------
 */

static void copy_blocks(imki_static_blocks *to, const imki_static_blocks *from, int axes)
{
    to->length = from->length;
    to->count = from->count;
    for (int a = 0; a < axes; a++)
        for (size_t k = 0; k < from->count; k++) {
            to->mean[a][k] = from->mean[a][k];
            to->square[a][k] = from->square[a][k];
        }
    for (size_t k = 0; k < from->count; k++)
        to->flag[k] = from->flag[k];
}

/* Try windows, each twice as long as the one before, from the blocks of the shortest, and leave the
 * job with those of the best. */
static outcome choose_window(imki_static_job *job, const imk_static_settings *settings,
                             imki_static_blocks *kept)
{
    outcome found[LEVELS_MAX];
    int levels = 0;
    copy_blocks(kept, &job->blocks, job->axis_count);
    for (;;) {
        found[levels++] = detect_at(job, settings, false);
        const double next =
            2.0 * (double)(job->blocks.length * IMKI_WINDOW_BLOCKS) * job->record->dt;
        if (levels == LEVELS_MAX || next > WINDOW_LONGEST ||
            job->blocks.count < 4 * IMKI_WINDOW_BLOCKS * IMKI_REST_WINDOWS)
            break;
        imki_static_blocks_join(job);
    }
    size_t most = 0, longest = 0;
    for (int i = 0; i < levels; i++) {
        most = found[i].intervals > most ? found[i].intervals : most;
        longest = found[i].samples > longest ? found[i].samples : longest;
    }
    int best = levels - 1;
    while (best > 0 &&
           (20 * found[best].intervals < 17 * most || 20 * found[best].samples < 16 * longest))
        best--;
    if (best == levels - 1)
        return detect_at(job, settings, true);
    copy_blocks(&job->blocks, kept, job->axis_count);
    for (int i = 0; i < best; i++)
        imki_static_blocks_join(job);
    return detect_at(job, settings, true);
}

/* ---- the whole ----------------------------------------------------------------------------------
 */

static void report(const imki_static_job *job, outcome found, imk_static_findings *findings)
{
    const imki_static_blocks *b = &job->blocks;
    findings->window = (double)(b->length * IMKI_WINDOW_BLOCKS) * job->record->dt;
    findings->rest_begin = job->rests ? job->rest_begin * b->length : 0;
    findings->rest_end = job->rests ? job->rest_end * b->length : 0;
    findings->intervals = found.intervals;
    findings->too_short = found.too_short;
    findings->standing = (double)found.standing / (double)job->record->count;
    for (int a = 0; a < job->axis_count; a++) {
        const int sensor = job->axis[a].sensor, axis = job->axis[a].axis;
        const bool assessed = job->rest_end > 0;
        findings->noise[sensor][axis] = assessed ? job->limit[a].noise : (double)NAN;
        findings->effective[sensor][axis] = assessed ? job->limit[a].effective : (double)NAN;
        findings->threshold[sensor][axis] =
            assessed ? sqrt(job->limit[a].scatter_squared) : (double)NAN;
    }
    findings->quietest = (double)INFINITY;
    findings->loudest = 0.0;
    const size_t windows = job->rest_end > 0 ? imki_static_windows(b) : 0;
    for (size_t w = 0; w < windows; w++) {
        const double activity = job->activity[w];
        findings->quietest = activity < findings->quietest ? activity : findings->quietest;
        findings->loudest = activity > findings->loudest ? activity : findings->loudest;
    }
    if (windows == 0)
        findings->quietest = findings->loudest = (double)NAN;
}

/* The window around each sample, the first and last for those at the ends. */
static void spread_activity(const imki_static_job *job, double *activity)
{
    const size_t windows = job->rest_end > 0 ? imki_static_windows(&job->blocks) : 0;
    const size_t length = job->blocks.length, count = job->record->count;
    for (size_t k = 0, block = 0; k < count; block++) {
        size_t w = block > 1 ? block - 1 : 0; /* windows w: blocks w … w + 3 */
        w = w < windows ? w : windows - 1;
        const double value = windows > 0 ? job->activity[w] : (double)NAN;
        for (const size_t end = k + length < count ? k + length : count; k < end; k++)
            activity[k] = value;
    }
}

static size_t write_intervals(const imki_static_job *job, const imk_static_settings *settings,
                              imk_static_interval *interval, size_t capacity)
{
    const lengths l = lengths_of(job, settings);
    double step[2][IMK_AXES_MAX] = {{0.0}};
    size_t count = 0;
    imki_static_run r;
    if (!job->rests)
        return 0;
    for (int a = 0; a < job->axis_count; a++) {
        const imki_static_axis *axis = &job->axis[a];
        step[axis->sensor][axis->axis] =
            axis->step == 0.0 && job->record->counts[axis->sensor] ? 1.0 : axis->step;
    }
    for (size_t w = 0; imki_static_next_run(job, &w, &r);) {
        size_t begin, end;
        if (!trim(job, l, r, &begin, &end))
            continue;
        if (count < capacity)
            interval[count] = imki_static_summarise(job->record, begin, end, step);
        count++;
    }
    return count;
}

static imk_status check(const imk_test_record *record, const imk_static_settings *settings,
                        size_t workspace_size, imk_error *error)
{
    if (settings->cookie != COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "static_settings", NULL,
                             "start from imk_static_default()");
    if (!(settings->window >= 0.0 && settings->window <= 1e6))
        return imki_refuse(error, IMK_ERROR_RANGE, "window", settings->window, 0.0,
                           "a time in seconds, or 0 to choose it automatically");
    if (!(settings->false_alarm > 1e-12 && settings->false_alarm < 0.5))
        return imki_refuse(error, IMK_ERROR_RANGE, "false_alarm", settings->false_alarm, 0.5,
                           "a probability, such as 1e-4");
    if (!(settings->minimum >= 0.0 && settings->minimum <= 1e6))
        return imki_refuse(error, IMK_ERROR_RANGE, "minimum", settings->minimum, 0.0,
                           "a time in seconds");
    if (!(settings->guard >= -1.0 && settings->guard <= 1e6))
        return imki_refuse(error, IMK_ERROR_RANGE, "guard", settings->guard, 0.0,
                           "a time in seconds, or -1 for the length of a window");
    if (!(settings->initial_rest >= 0.0 && settings->initial_rest <= 1e6))
        return imki_refuse(error, IMK_ERROR_RANGE, "initial_rest", settings->initial_rest, 0.0,
                           "a time in seconds, or 0 to search for the quietest part");
    if (!(record->dt > 0.0 && isfinite(record->dt)) || axes_of(record) == 0)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "record", NULL,
                             "a sample interval and readings");
    if (record->means)
        return IMK_OK;
    const size_t block = block_length(record, settings);
    const size_t needed = block * IMKI_WINDOW_BLOCKS * 2;
    if (record->count < needed || record->count < SAMPLES_MIN)
        return imki_refuse(error, IMK_ERROR_TOO_SHORT, "samples", (double)record->count,
                           (double)(needed > SAMPLES_MIN ? needed : SAMPLES_MIN),
                           "at least two windows");
    if (workspace_size < imk_static_workspace_size(record, settings))
        return imki_refuse(error, IMK_ERROR_WORKSPACE, "workspace", (double)workspace_size,
                           (double)imk_static_workspace_size(record, settings),
                           "imk_static_workspace_size() bytes");
    return IMK_OK;
}

/* Arrays over blocks: the job's and a second set; those of the job are used when a window is
 * chosen, the second keeps the shortest blocks meanwhile. */
static void lay_out(imki_static_job *job, imki_static_blocks *kept, size_t block, void *workspace)
{
    double *next = imki_align(workspace);
    const size_t count = job->record->count / block, size = padded(count);
    job->blocks.length = kept->length = block;
    job->blocks.count = kept->count = count;
    for (int a = 0; a < job->axis_count; a++) {
        job->blocks.mean[a] = next;
        job->blocks.square[a] = next + size;
        kept->mean[a] = next + 2 * size;
        kept->square[a] = next + 3 * size;
        next += 4 * size;
    }
    job->activity = next;
    job->scratch = next + size;
    job->blocks.flag = (uint8_t *)(next + 2 * size);
    kept->flag = job->blocks.flag + size;
}

imk_status imk_static_detect(const imk_test_record *record, const imk_static_settings *settings,
                             const imk_model *model, imk_static_interval *interval, size_t capacity,
                             size_t *count, double *activity, imk_static_findings *findings,
                             void *workspace, size_t workspace_size, imk_error *error)
{
    if (!record || !settings || !workspace || !count || !findings || (capacity > 0 && !interval))
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "", NULL, "no null pointer");
    const imk_status status = check(record, settings, workspace_size, error);
    if (status != IMK_OK)
        return status;
    if (record->means) {
        *count = imki_static_means(record, interval, capacity, activity, findings);
        return IMK_OK;
    }
    imki_static_job job = {.false_alarm = settings->false_alarm};
    imki_static_blocks kept;
    imk_static_findings found = {0};
    imki_static_axes(record, model, &job);
    lay_out(&job, &kept, block_length(record, settings), workspace);
    imki_static_blocks_fill(&job, &found);
    size_t usable = 0;
    for (size_t k = 0; k < job.blocks.count; k++)
        usable += !(job.blocks.flag[k] & IMKI_BLOCK_INVALID);
    if (usable == 0)
        return imk_error_set(error, IMK_ERROR_NOT_FINITE, "record", NULL,
                             "a record with finite samples within the range, without gaps");
    const outcome best = settings->window > 0.0 ? detect_at(&job, settings, true)
                                                : choose_window(&job, settings, &kept);
    report(&job, best, &found);
    *count = write_intervals(&job, settings, interval, capacity);
    if (activity)
        spread_activity(&job, activity);
    *findings = found;
    return IMK_OK;
}
