/* SPDX-License-Identifier: Apache-2.0 */
/* Are two campaigns the same, and if not, in what do they differ? */
#include "campaign_internal.h"

#include <string.h>

static const char other_campaign[] = "a file of the same campaign as most others";

/* A clause about the first difference, for imk_error.found. */
typedef struct clause {
    char text[96];
} clause;

/* The piece of a text around a place: from the comma or brace in front of it to the next. */
static void excerpt(const char *text, size_t place, char *piece, size_t size)
{
    static const char ends[] = ",{}[]\n";
    size_t from = place, length;
    while (from > 0 && !strchr(ends, text[from - 1]))
        from--;
    while (text[from] == ' ')
        from++;
    length = strcspn(text + from, ends);
    if (length >= size)
        length = size - 1;
    memcpy(piece, text + from, length);
    piece[length] = '\0';
}

static void parameters_differ(const char *other, const char *own, clause *c)
{
    size_t place = 0;
    char found[32], due[32];
    while (other[place] && other[place] == own[place])
        place++;
    excerpt(other, place, found, sizeof found);
    excerpt(own, place, due, sizeof due);
    snprintf(c->text, sizeof c->text, "a parameter is %s, not %s", found, due);
}

static bool texts_equal(size_t count, const char *const *a, const char *const *b)
{
    for (size_t i = 0; i < count; i++)
        if (strcmp(a[i], b[i]) != 0)
            return false;
    return true;
}

/* @return false when nothing differs */
static bool differ(const imk_campaign *other, const imk_campaign *own, clause *c)
{
    if (strcmp(other->version, own->version) != 0)
        snprintf(c->text, sizeof c->text, "it was made by imukit %.30s, not %.30s", other->version,
                 own->version);
    else if (other->seed != own->seed)
        snprintf(c->text, sizeof c->text, "the seed is %llu, not %llu",
                 (unsigned long long)other->seed, (unsigned long long)own->seed);
    else if (other->run_count != own->run_count)
        snprintf(c->text, sizeof c->text, "the campaign has %llu runs, not %llu",
                 (unsigned long long)other->run_count, (unsigned long long)own->run_count);
    else if (strcmp(other->parameters, own->parameters) != 0)
        parameters_differ(other->parameters, own->parameters, c);
    else if (other->time_count != own->time_count ||
             memcmp(other->time, own->time, own->time_count * sizeof *own->time) != 0)
        snprintf(c->text, sizeof c->text, "the times are not the same");
    else if (other->state_count != own->state_count ||
             !texts_equal(own->state_count, other->state, own->state) ||
             !texts_equal(own->state_count, other->unit, own->unit))
        snprintf(c->text, sizeof c->text, "the states are not the same");
    else
        return false;
    return true;
}

imk_status imki_campaign_compare(const imk_campaign *other, const imk_campaign *campaign,
                                 imk_error *error)
{
    clause c;
    if (!differ(other, campaign, &c))
        return IMK_OK;
    return imk_error_set(error, IMK_ERROR_CONFLICT, "", c.text, other_campaign);
}
