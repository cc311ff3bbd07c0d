/* SPDX-License-Identifier: Apache-2.0 */
/* What the label of a section says: "x_up", "acc_x_p", "+x", "x-", "y rot", "turn z". The grammar
 * is in ferraris.h. */
#include "six_position_internal.h"

#include "base/text_internal.h"

#include <string.h>

enum { LONGEST = 12 };

typedef enum meaning { UP = 1, DOWN, TURN, OTHER } meaning;

static const struct {
    const char *word;
    meaning means;
} words[] = {{"up", UP},         {"p", UP},         {"pos", UP},          {"plus", UP},
             {"positive", UP},   {"down", DOWN},    {"a", DOWN},          {"n", DOWN},
             {"neg", DOWN},      {"minus", DOWN},   {"negative", DOWN},   {"rot", TURN},
             {"rotation", TURN}, {"turn", TURN},    {"spin", TURN},       {"to", OTHER},
             {"move", OTHER},    {"moving", OTHER}, {"transition", OTHER}};

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

static bool is_word(char c)
{
    return is_letter(c) || (c >= '0' && c <= '9');
}

static int axis_of(char c)
{
    const char l = imki_lower(c);
    return l >= 'x' && l <= 'z' ? l - 'x' : -1;
}

static int sign_of(char c)
{
    return c == '+' ? 1 : c == '-' ? -1 : 0;
}

/* A sign belongs to an axis when nothing else touches it: "-x" and "x-", but not "acc-x", "x-up".
 */
static int sign_beside(const char *text, size_t begin)
{
    if (begin > 0 && sign_of(text[begin - 1]) && (begin == 1 || !is_word(text[begin - 2])))
        return sign_of(text[begin - 1]);
    return sign_of(text[begin + 1]) && !is_word(text[begin + 2]) ? sign_of(text[begin + 1]) : 0;
}

static int meaning_of(const char *text, size_t length)
{
    char word[LONGEST];
    if (length >= sizeof word)
        return 0;
    for (size_t i = 0; i < length; i++)
        word[i] = imki_lower(text[i]);
    word[length] = '\0';
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (strcmp(word, words[i].word) == 0)
            return (int)words[i].means;
    return 0;
}

imki_label imki_label_parse(const char *text)
{
    imki_label label = {IMKI_LABEL_HOLD, -1, 0};
    size_t length = 0;
    for (size_t at = 0; text[at] != '\0'; at += length) {
        for (length = 0; is_word(text[at + length]);)
            length++;
        if (length == 0) {
            length = 1;
            continue;
        }
        const int axis = length == 1 ? axis_of(text[at]) : -1;
        const int means = axis < 0 ? meaning_of(text + at, length) : 0;
        if (axis >= 0 && label.axis >= 0 && axis != label.axis)
            label.kind = IMKI_LABEL_OTHER;
        if (axis >= 0) {
            label.axis = axis;
            label.sense = sign_beside(text, at) ? sign_beside(text, at) : label.sense;
        }
        if (means == UP || means == DOWN)
            label.sense = means == UP ? 1 : -1;
        if (means == OTHER)
            label.kind = IMKI_LABEL_OTHER;
        if (means == TURN && label.kind != IMKI_LABEL_OTHER)
            label.kind = IMKI_LABEL_TURN;
    }
    if (label.axis < 0)
        label.sense = 0;
    return label;
}
