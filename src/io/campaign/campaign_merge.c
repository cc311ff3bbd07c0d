/* SPDX-License-Identifier: Apache-2.0 */
/* Merging shards. Every file is opened, verified and closed again at first (a process may not have
 * a thousand files open), then the good ones are read once more in the order of their runs.
 *
 * The campaign is that of most good files. A file that gives a run other numbers than another file
 * does is refused, and so is the other. */
#include "campaign_internal.h"

#include "imukit/utf8.h"

#include <stdlib.h>
#include <string.h>

/* A good file. */
typedef struct shard {
    const char *path;
    imki_results results; /* closed but while it is read */
    uint64_t last;        /* run */
    bool refused;
} shard;

typedef struct merge {
    size_t count;
    shard *shards;
    imk_campaign_merge_report *report;
    /* While reading: */
    uint64_t *owner; /* of each run in the output: shard */
    uint64_t *place; /* and its place in that */
    shard *open;     /* or NULL */
} merge;

static void complain(merge *m, const char *path, const imk_error *error)
{
    m->report->complaint[m->report->complaint_count++] =
        (imk_campaign_complaint){.path = path, .error = *error};
}

static void refuse(merge *m, shard *s, const imk_error *error)
{
    if (!s->refused)
        complain(m, s->path, error);
    s->refused = true;
}

static imk_status open_all(merge *m, size_t count, const char *const *paths, imk_error *error)
{
    for (size_t i = 0; i < count; i++) {
        imki_results file;
        imk_error about;
        const imk_status status = imki_results_open(paths[i], &file, &about);
        if (status == IMK_ERROR_MEMORY)
            return imk_error_set(error, IMK_ERROR_MEMORY, paths[i], "", "");
        if (status != IMK_OK) {
            complain(m, paths[i], &about);
            continue;
        }
        imki_results_pause(&file);
        m->shards[m->count++] = (shard){
            .path = paths[i], .results = file, .last = file.record.run[file.record.runs - 1]};
    }
    return IMK_OK;
}

/* ---- the campaign of most files ---- */

static bool same(const shard *a, const shard *b)
{
    return imki_campaign_compare(&a->results.record.campaign, &b->results.record.campaign, NULL) ==
           IMK_OK;
}

/* Votes are counted for the first file of each kind; the kinds are few. */
static const shard *most(const merge *m)
{
    const shard *best = NULL;
    size_t best_votes = 0, counted = 0;
    for (size_t i = 0; i < m->count && m->count - counted > best_votes; i++) {
        size_t votes = 0;
        bool new_kind = true;
        for (size_t k = 0; k < i && new_kind; k++)
            new_kind = !same(&m->shards[k], &m->shards[i]);
        for (size_t k = i; k < m->count && new_kind; k++)
            votes += same(&m->shards[k], &m->shards[i]);
        counted += votes;
        if (votes > best_votes) {
            best = &m->shards[i];
            best_votes = votes;
        }
    }
    return best;
}

static void refuse_others(merge *m)
{
    const shard *chosen = most(m);
    for (size_t i = 0; i < m->count; i++) {
        imk_error error;
        if (imki_campaign_compare(&m->shards[i].results.record.campaign,
                                  &chosen->results.record.campaign, &error) != IMK_OK)
            refuse(m, &m->shards[i], &error);
    }
}

/* ---- runs given twice ---- */

static int by_runs(const void *left, const void *right)
{
    const shard *a = left, *b = right;
    if (a->results.record.run[0] != b->results.record.run[0])
        return a->results.record.run[0] < b->results.record.run[0] ? -1 : 1;
    return (a->last < b->last) - (a->last > b->last);
}

/* First common run of two files whose numbers are not equal; UINT64_MAX: none. */
static uint64_t first_difference(const imk_campaign_results *a, const imk_campaign_results *b)
{
    const size_t size = (size_t)imki_run_size(&a->campaign), step = size / sizeof(double);
    for (uint64_t i = 0, k = 0; i < a->runs && k < b->runs;) {
        if (a->run[i] == b->run[k] && memcmp(a->values + i * step, b->values + k * step, size) != 0)
            return a->run[i];
        const bool advance = a->run[i] <= b->run[k];
        k += b->run[k] <= a->run[i];
        i += advance;
    }
    return UINT64_MAX;
}

static void contradict(merge *m, shard *s, uint64_t run, const char *other)
{
    char found[96], expected[160];
    imk_error error;
    snprintf(found, sizeof found, "run %llu has different numbers in another file",
             (unsigned long long)run);
    snprintf(expected, sizeof expected, "compute both again: this and %.100s", other);
    imk_error_set(&error, IMK_ERROR_CONFLICT, "", found, expected);
    refuse(m, s, &error);
}

static imk_status load(const shard *s, imk_campaign_results **results, imk_error *error)
{
    const imk_status status = imk_campaign_load(s->path, results, error);
    if (status != IMK_OK && error)
        imk_utf8_shorten(s->path, error->field, sizeof error->field);
    return status;
}

/* Refuse both when they do not agree. */
static imk_status compare(merge *m, shard *a, shard *b, imk_error *error)
{
    imk_campaign_results *left = NULL, *right = NULL;
    imk_status status = load(a, &left, error);
    if (status == IMK_OK)
        status = load(b, &right, error);
    if (status == IMK_OK) {
        const uint64_t run = first_difference(left, right);
        if (run != UINT64_MAX) {
            contradict(m, a, run, b->path);
            contradict(m, b, run, a->path);
        }
    }
    imk_campaign_free(left);
    imk_campaign_free(right);
    return status;
}

static bool has_gaps(const shard *s)
{
    return s->last - s->results.record.run[0] + 1 != s->results.record.runs;
}

/* Compare a shard with one that is sorted before it, if they may have runs in common. */
static imk_status compare_with(merge *m, shard *s, shard *other, imk_error *error)
{
    if (!other || other->refused || s->refused || other->last < s->results.record.run[0])
        return IMK_OK;
    return compare(m, s, other, error);
}

/* One pass over the shards, sorted by their first run, up to the first contradiction. Each is
 * compared with the one without gaps before it that reaches furthest, which holds every run the new
 * one may share with any without gaps before; and with all partial merges that have gaps.
 * @param found  a contradiction: with two shards less the furthest are others */
static imk_status find_contradiction(merge *m, bool *found, imk_error *error)
{
    shard *furthest = NULL;
    size_t gaps = 0;
    imk_status status = IMK_OK;
    *found = false;
    for (size_t i = 0; i < m->count && status == IMK_OK && !*found; i++) {
        shard *s = &m->shards[i];
        if (s->refused)
            continue;
        status = compare_with(m, s, furthest, error);
        for (size_t k = 0; k < i && gaps > 0 && status == IMK_OK; k++)
            if (has_gaps(&m->shards[k]))
                status = compare_with(m, s, &m->shards[k], error);
        *found = s->refused;
        if (has_gaps(s))
            gaps++;
        else if (!furthest || s->last >= furthest->last)
            furthest = s;
    }
    return status;
}

static imk_status refuse_contradictions(merge *m, imk_error *error)
{
    bool found = true;
    imk_status status = IMK_OK;
    while (found && status == IMK_OK)
        status = find_contradiction(m, &found, error);
    return status;
}

/* ---- what is there ---- */

/* "17-32,65": adds a range; a list that becomes too long ends in "...". */
static void add_range(char *text, size_t size, uint64_t from, uint64_t to)
{
    char range[48];
    const size_t used = strlen(text);
    const char *comma = used > 0 ? "," : "";
    if (used >= 3 && strcmp(text + used - 3, "...") == 0)
        return;
    if (from == to)
        snprintf(range, sizeof range, "%s%llu", comma, (unsigned long long)from);
    else
        snprintf(range, sizeof range, "%s%llu-%llu", comma, (unsigned long long)from,
                 (unsigned long long)to);
    if (used + strlen(range) + sizeof ",..." > size)
        snprintf(text + used, size - used, "%s...", comma);
    else
        snprintf(text + used, size - used, "%s", range);
}

/* The number of shards of which every file is one. The size of a file leaves few candidates: N
 * shards have run_count / N runs or one more. */
static uint64_t division(const merge *m, uint64_t run_count)
{
    const shard *any = NULL;
    for (size_t i = 0; i < m->count && !any; i++)
        any = m->shards[i].refused ? NULL : &m->shards[i];
    const uint64_t runs = any->results.record.runs;
    const uint64_t low = run_count / (runs + 1), high = run_count / (runs > 1 ? runs - 1 : 1);
    for (uint64_t n = low > 1 ? low : 1; n <= high && n <= run_count; n++) {
        bool all = true;
        for (size_t i = 0; i < m->count && all; i++) {
            const shard *s = &m->shards[i];
            uint64_t first = 0, count = 0;
            if (s->refused)
                continue;
            /* The shard that the first run is in, by the two sizes there are. */
            const uint64_t least = run_count / n, more = run_count % n,
                           run = s->results.record.run[0];
            const uint64_t index = run < more * (least + 1)
                                       ? run / (least + 1)
                                       : more + (run - more * (least + 1)) / least;
            imk_campaign_shard(run_count, index + 1, n, &first, &count);
            all = first == run && count == s->results.record.runs && s->last == first + count - 1;
        }
        if (all)
            return n;
    }
    return 0;
}

/* Walk the runs that are missing. */
static void find_missing(merge *m, uint64_t run_count)
{
    imk_campaign_merge_report *r = m->report;
    uint64_t from = UINT64_MAX;
    for (uint64_t run = 0; run <= run_count; run++) {
        const bool there = run == run_count || m->owner[run] != 0;
        if (!there && from == UINT64_MAX)
            from = run;
        if (there && from != UINT64_MAX) {
            add_range(r->missing, sizeof r->missing, from, run - 1);
            from = UINT64_MAX;
        }
    }
    r->shard_count = division(m, run_count);
    for (uint64_t index = 1; index <= r->shard_count; index++) {
        uint64_t first, count;
        imk_campaign_shard(run_count, index, r->shard_count, &first, &count);
        const bool there = m->owner[first] != 0;
        if (!there && from == UINT64_MAX)
            from = index;
        if (there && from != UINT64_MAX) {
            add_range(r->shards, sizeof r->shards, from, index - 1);
            from = UINT64_MAX;
        }
    }
    if (from != UINT64_MAX)
        add_range(r->shards, sizeof r->shards, from, r->shard_count);
}

/* Which shard gives each run: owner is 1 + its index, 0 where none does. */
static imk_status assign(merge *m, const imk_campaign *campaign, imk_error *error)
{
    const uint64_t run_count = campaign->run_count;
    if (run_count > SIZE_MAX / sizeof *m->owner ||
        !(m->owner = calloc(run_count, sizeof *m->owner)) ||
        !(m->place = calloc(run_count, sizeof *m->place)))
        return imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    m->report->run_count = run_count;
    for (size_t i = 0; i < m->count; i++) {
        const imki_record *r = &m->shards[i].results.record;
        for (uint64_t k = 0; k < r->runs && !m->shards[i].refused; k++) {
            m->report->present += m->owner[r->run[k]] == 0;
            m->owner[r->run[k]] = i + 1;
            m->place[r->run[k]] = k;
        }
    }
    find_missing(m, run_count);
    return IMK_OK;
}

/* ---- writing ---- */

static imk_status open_shard(merge *m, shard *s, imk_error *error)
{
    if (m->open == s)
        return IMK_OK;
    if (m->open)
        imki_results_pause(&m->open->results);
    m->open = NULL;
    const imk_status status = imki_results_resume(s->path, &s->results, error);
    if (status == IMK_OK)
        m->open = s;
    else if (error)
        imk_utf8_shorten(s->path, error->field, sizeof error->field);
    return status;
}

/* Runs of the output by their places there; owner and place are compacted to the runs that are. */
static imk_status read_runs(void *context, uint64_t place, uint64_t count, double *values,
                            imk_error *error)
{
    merge *m = context;
    while (count > 0) {
        const uint64_t owner = m->owner[place];
        uint64_t together = 1;
        while (together < count && m->owner[place + together] == owner &&
               m->place[place + together] == m->place[place] + together)
            together++;
        shard *s = &m->shards[owner - 1];
        imk_status status = open_shard(m, s, error);
        if (status == IMK_OK)
            status = imki_results_read(&s->results, m->place[place], together, values, error);
        if (status != IMK_OK)
            return status;
        values += together * (imki_run_size(&s->results.record.campaign) / sizeof *values);
        place += together;
        count -= together;
    }
    return IMK_OK;
}

static imk_status write_runs(merge *m, const imk_campaign *campaign, const char *output,
                             imk_error *error)
{
    uint64_t *run = malloc(campaign->run_count * sizeof *run), there = 0;
    if (!run)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    for (uint64_t k = 0; k < campaign->run_count; k++) {
        if (m->owner[k] == 0)
            continue;
        m->owner[there] = m->owner[k];
        m->place[there] = m->place[k];
        run[there++] = k;
    }
    imki_record record;
    imk_status status = imki_record_make(campaign, there, run, &record, error);
    free(run);
    if (status != IMK_OK)
        return status;
    status = imki_store(output, &record, read_runs, m, error);
    imki_record_free(&record);
    return status;
}

static imk_status merge_shards(merge *m, const char *output, bool partial, imk_error *error)
{
    imk_status status = IMK_OK;
    if (m->count > 0) {
        refuse_others(m);
        qsort(m->shards, m->count, sizeof *m->shards, by_runs);
        status = refuse_contradictions(m, error);
    }
    if (status != IMK_OK)
        return status;
    const shard *any = NULL;
    for (size_t i = 0; i < m->count && !any; i++)
        any = m->shards[i].refused ? NULL : &m->shards[i];
    if (!any)
        return imk_error_set(error, IMK_ERROR_EMPTY, "", "no file is usable",
                             "give results files of one campaign");
    const imk_campaign *campaign = &any->results.record.campaign;
    status = assign(m, campaign, error);
    if (status == IMK_OK && m->report->present < campaign->run_count && !partial) {
        char found[96];
        snprintf(found, sizeof found, "%llu of %llu runs are missing",
                 (unsigned long long)(campaign->run_count - m->report->present),
                 (unsigned long long)campaign->run_count);
        return imk_error_set(error, IMK_ERROR_CONFLICT, "", found, "");
    }
    return status == IMK_OK ? write_runs(m, campaign, output, error) : status;
}

imk_status imk_campaign_merge(size_t count, const char *const *paths, const char *output,
                              bool partial, imk_campaign_merge_report *report, imk_error *error)
{
    imk_campaign_complaint *complaint = report->complaint;
    *report = (imk_campaign_merge_report){.complaint = complaint};
    imk_status status = imki_store_check(output, error);
    if (status != IMK_OK)
        return status;
    merge m = {.report = report, .shards = calloc(count > 0 ? count : 1, sizeof *m.shards)};
    if (!m.shards)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    status = open_all(&m, count, paths, error);
    if (status == IMK_OK)
        status = merge_shards(&m, output, partial, error);
    for (size_t i = 0; i < m.count; i++)
        imki_results_close(&m.shards[i].results);
    free(m.shards);
    free(m.owner);
    free(m.place);
    return status;
}
