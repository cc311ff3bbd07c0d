/* SPDX-License-Identifier: Apache-2.0 */
/* Names compared by their letters; and the nearest name of a list, by the distance of Damerau and
 * Levenshtein in its restricted form (optimal string alignment) [DAMERAU1964]: with d[i][j] for the
 * first i and j letters,
 *
 *     d[i][j] = min( d[i-1][j] + 1, d[i][j-1] + 1, d[i-1][j-1] + (a_i != b_j),
 *                    d[i-2][j-2] + 1  where a_i a_{i-1} = b_{j-1} b_j )
 *
 * Three rows of the table are kept. */
#include "nearest_name_internal.h"

#include "imukit/names.h"

#include <string.h>

enum { LETTERS_MAX = 63 };

/* Letters that count, in lower case; SIZE_MAX for a name too long to compare. */
static size_t reduce(const char *name, char *letters)
{
    size_t length = 0;
    for (const char *c = name; *c; c++) {
        if (*c == ' ' || *c == '-' || *c == '_')
            continue;
        if (length == LETTERS_MAX)
            return SIZE_MAX;
        letters[length++] = (char)(*c >= 'A' && *c <= 'Z' ? *c - 'A' + 'a' : *c);
    }
    return length;
}

static size_t smaller(size_t a, size_t b)
{
    return a < b ? a : b;
}

static size_t distance(const char *a, size_t a_length, const char *b, size_t b_length)
{
    size_t rows[3][LETTERS_MAX + 1];
    size_t *before_last = rows[0], *last = rows[1], *row = rows[2];
    for (size_t j = 0; j <= b_length; j++) {
        before_last[j] = j;
        last[j] = j;
    }
    for (size_t i = 1; i <= a_length; i++) {
        row[0] = i;
        for (size_t j = 1; j <= b_length; j++) {
            row[j] = smaller(smaller(last[j], row[j - 1]) + 1,
                             last[j - 1] + (a[i - 1] != b[j - 1] ? 1 : 0));
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                row[j] = smaller(row[j], before_last[j - 2] + 1);
        }
        size_t *free_row = before_last;
        before_last = last;
        last = row;
        row = free_row;
    }
    return last[b_length];
}

size_t imki_nearest_name(const char *name, size_t count, const char *const *candidates)
{
    char wanted[LETTERS_MAX], letters[LETTERS_MAX];
    size_t wanted_length = reduce(name, wanted);
    size_t best = SIZE_MAX, best_distance = SIZE_MAX;
    if (wanted_length == SIZE_MAX || wanted_length == 0)
        return SIZE_MAX;
    for (size_t i = 0; i < count; i++) {
        size_t length = candidates[i] ? reduce(candidates[i], letters) : SIZE_MAX;
        if (length == SIZE_MAX || length == 0)
            continue;
        /* A third of the longer name, but one slip also in the shortest. */
        const size_t longer = length > wanted_length ? length : wanted_length;
        const size_t allowed = longer < 6 ? 1 : longer / 3;
        if (longer < 2 || length + wanted_length < 2 * longer - allowed)
            continue; /* they differ by more in their lengths */
        const size_t d = distance(wanted, wanted_length, letters, length);
        if (d <= allowed && d < best_distance) {
            best = i;
            best_distance = d;
        }
    }
    return best;
}

size_t imk_nearest_name(const char *name, size_t count, const char *const *candidates)
{
    return imki_nearest_name(name, count, candidates);
}

bool imk_name_equal(const char *a, const char *b)
{
    char letters[2][LETTERS_MAX];
    const size_t length = reduce(a, letters[0]);
    return length != SIZE_MAX && length > 0 && reduce(b, letters[1]) == length &&
           memcmp(letters[0], letters[1], length) == 0;
}

bool imk_name_within(const char *part, const char *name)
{
    char wanted[LETTERS_MAX], letters[LETTERS_MAX];
    const size_t wanted_length = reduce(part, wanted), length = reduce(name, letters);
    if (wanted_length == SIZE_MAX || wanted_length == 0 || length == SIZE_MAX)
        return false;
    for (size_t i = 0; i + wanted_length <= length; i++)
        if (memcmp(letters + i, wanted, wanted_length) == 0)
            return true;
    return false;
}
