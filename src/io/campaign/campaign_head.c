/* SPDX-License-Identifier: Apache-2.0 */
/* The head: what a campaign and some of its runs are, in one piece of bytes. Two are the same when
 * their bytes are.
 *
 *   numbers of 8 bytes: seed, run_count, runs, times, states, bytes of the texts
 *   times (float64), numbers of the runs (uint64)
 *   texts, each ended by a zero: version, parameters, names of the states, their units
 *
 * All little-endian; texts and arrays are used where they stand. */
#include "campaign_internal.h"

#include <stdlib.h>
#include <string.h>

enum { SEED, RUN_COUNT, RUNS, TIMES, STATES, TEXTS, NUMBERS };
enum { FIXED = NUMBERS * 8 };

/* Names and units are attributes of the results file, texts of equal size. HDF5 keeps less than
 * 64 KiB of an attribute, with its own head, beside its object. */
enum { ATTRIBUTE_MAX = 60000 };

uint64_t imki_run_size(const imk_campaign *campaign)
{
    return (uint64_t)campaign->time_count * campaign->state_count * sizeof(double);
}

imk_status imki_record_refuse(imk_error *error)
{
    return imk_error_set(error, IMK_ERROR_FORMAT, "", "", "a results file that imukit wrote (.h5)");
}

/* ---- limits ---- */

static size_t longest(size_t count, const char *const *texts)
{
    size_t length = 0;
    for (size_t i = 0; i < count; i++)
        if (strlen(texts[i]) > length)
            length = strlen(texts[i]);
    return length;
}

static bool texts_fit(const imk_campaign *c)
{
    return strlen(c->version) < 256 && c->state_count < ATTRIBUTE_MAX &&
           (longest(c->state_count, c->state) + 1) * c->state_count < ATTRIBUTE_MAX &&
           (longest(c->state_count, c->unit) + 1) * c->state_count < ATTRIBUTE_MAX;
}

static bool values_fit(const imk_campaign *c, uint64_t runs)
{
    const uint64_t limit = INT64_MAX / 2;
    return c->time_count < limit / c->state_count / sizeof(double) &&
           runs < limit / imki_run_size(c);
}

/* Run numbers increase and belong to the campaign. */
static bool runs_are_valid(const imki_record *r)
{
    for (uint64_t i = 0; i < r->runs; i++)
        if (r->run[i] >= r->campaign.run_count || (i > 0 && r->run[i] <= r->run[i - 1]))
            return false;
    return true;
}

/* ---- writing ---- */

static size_t texts_size(const imk_campaign *c)
{
    size_t size = strlen(c->version) + 1 + strlen(c->parameters) + 1;
    for (size_t i = 0; i < c->state_count; i++)
        size += strlen(c->state[i]) + 1 + strlen(c->unit[i]) + 1;
    return size;
}

static void put(unsigned char **at, const void *bytes, size_t size)
{
    memcpy(*at, bytes, size);
    *at += size;
}

static void put_text(unsigned char **at, const char *text)
{
    put(at, text, strlen(text) + 1);
}

static void put_head(unsigned char *at, const imk_campaign *c, uint64_t runs, const uint64_t *run)
{
    const uint64_t numbers[NUMBERS] = {
        [SEED] = c->seed,        [RUN_COUNT] = c->run_count, [RUNS] = runs,
        [TIMES] = c->time_count, [STATES] = c->state_count,  [TEXTS] = texts_size(c)};
    put(&at, numbers, sizeof numbers);
    put(&at, c->time, c->time_count * sizeof *c->time);
    put(&at, run, runs * sizeof *run);
    put_text(&at, c->version);
    put_text(&at, c->parameters);
    for (size_t i = 0; i < c->state_count; i++)
        put_text(&at, c->state[i]);
    for (size_t i = 0; i < c->state_count; i++)
        put_text(&at, c->unit[i]);
}

imk_status imki_record_make(const imk_campaign *campaign, uint64_t runs, const uint64_t *run,
                            imki_record *record, imk_error *error)
{
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
    return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "", "this machine is big-endian",
                         "use a little-endian machine");
#endif
    if (campaign->run_count == 0 || runs == 0 || runs > campaign->run_count ||
        campaign->time_count == 0 || campaign->state_count == 0)
        return imk_error_set(error, IMK_ERROR_RANGE, "campaign", "a campaign has no numbers",
                             "at least one run, time and state");
    if (!texts_fit(campaign) || !values_fit(campaign, runs))
        return imk_error_set(error, IMK_ERROR_RANGE, "campaign",
                             "the results are too many for a file", "fewer states or runs");
    const size_t size = FIXED + (campaign->time_count + runs) * 8 + texts_size(campaign);
    unsigned char *head = malloc(size);
    if (!head)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    put_head(head, campaign, runs, run);
    return imki_record_read(head, size, record, error);
}

/* ---- reading ---- */

/* The texts one after the other. @return false when there are not `count` */
static bool view_texts(const char *at, size_t size, size_t count, const char **texts)
{
    for (size_t i = 0; i < count; i++) {
        const char *end = memchr(at, '\0', size);
        if (!end)
            return false;
        texts[i] = at;
        size -= (size_t)(end - at) + 1;
        at = end + 1;
    }
    return size == 0;
}

/* The parts of a head as a campaign. */
static imk_status view_record(imki_record *r)
{
    imk_campaign *c = &r->campaign;
    uint64_t numbers[NUMBERS];
    if (r->head_size < FIXED)
        return IMK_ERROR_FORMAT;
    memcpy(numbers, r->head, sizeof numbers);
    const uint64_t rest = r->head_size - FIXED, most = rest / 8;
    if (numbers[RUNS] == 0 || numbers[TIMES] == 0 || numbers[STATES] == 0 || numbers[RUNS] > most ||
        numbers[TIMES] > most - numbers[RUNS] || numbers[STATES] >= ATTRIBUTE_MAX ||
        numbers[TEXTS] != rest - (numbers[RUNS] + numbers[TIMES]) * 8)
        return IMK_ERROR_FORMAT;
    c->seed = numbers[SEED];
    c->run_count = numbers[RUN_COUNT];
    c->time_count = (size_t)numbers[TIMES];
    c->state_count = (size_t)numbers[STATES];
    r->runs = numbers[RUNS];
    c->time = (const double *)(const void *)(r->head + FIXED);
    r->run = (const uint64_t *)(const void *)(c->time + c->time_count);
    r->texts = calloc(2 + 2 * c->state_count, sizeof *r->texts);
    if (!r->texts)
        return IMK_ERROR_MEMORY;
    if (!view_texts((const char *)(r->run + r->runs), (size_t)numbers[TEXTS],
                    2 + 2 * c->state_count, r->texts))
        return IMK_ERROR_FORMAT;
    c->version = r->texts[0];
    c->parameters = r->texts[1];
    c->state = r->texts + 2;
    c->unit = r->texts + 2 + c->state_count;
    return runs_are_valid(r) && values_fit(c, r->runs) ? IMK_OK : IMK_ERROR_FORMAT;
}

imk_status imki_record_read(unsigned char *head, size_t head_size, imki_record *record,
                            imk_error *error)
{
    imki_record read = {.head = head, .head_size = head_size};
    const imk_status status = view_record(&read);
    if (status == IMK_OK) {
        *record = read;
        return IMK_OK;
    }
    imki_record_free(&read);
    return status == IMK_ERROR_MEMORY ? imk_error_set(error, status, "", "", "")
                                      : imki_record_refuse(error);
}

void imki_record_free(imki_record *record)
{
    free(record->texts);
    free(record->head);
    *record = (imki_record){0};
}
