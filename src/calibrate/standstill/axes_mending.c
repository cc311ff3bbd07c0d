/* SPDX-License-Identifier: Apache-2.0 */
/* Signed permutations of the axes of gyros and accelerometers, and the simplest pairs of each class
 * of pairs that turns between rests do not tell apart: with P of the gyros alone, (R P, ±R) for the
 * 24 rotations R. */
#include "imukit/axes_mending.h"

#include <stdbool.h>
#include <string.h>

enum { SENSORS = 2, AXES = 3, MISTAKES_MAX = 8 };

static int determinant_of(const imk_signed_axes *p)
{
    const int turned = (p->column[1] - p->column[0] + AXES) % AXES;
    return (turned == 1 ? 1 : -1) * p->sign[0] * p->sign[1] * p->sign[2];
}

imk_signed_axes imk_signed_axes_of(int index)
{
    static const int column[6][AXES] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1},
                                        {1, 0, 2}, {0, 2, 1}, {2, 1, 0}};
    imk_signed_axes p;
    const int number = index >= 0 && index < IMK_SIGNED_AXES ? index : 0;
    for (int i = 0; i < AXES; i++) {
        p.column[i] = column[number / 8][i];
        p.sign[i] = (number >> i) & 1 ? -1 : 1;
    }
    p.determinant = determinant_of(&p);
    return p;
}

/* a after b. */
static imk_signed_axes product(const imk_signed_axes *a, const imk_signed_axes *b)
{
    imk_signed_axes p;
    for (int i = 0; i < AXES; i++) {
        p.column[i] = b->column[a->column[i]];
        p.sign[i] = a->sign[i] * b->sign[a->column[i]];
    }
    p.determinant = a->determinant * b->determinant;
    return p;
}

static imk_signed_axes inverted(imk_signed_axes p)
{
    for (int i = 0; i < AXES; i++)
        p.sign[i] = -p.sign[i];
    p.determinant = -p.determinant;
    return p;
}

static int fixed_axes(const imk_signed_axes *p)
{
    int fixed = 0;
    for (int i = 0; i < AXES; i++)
        fixed += p->column[i] == i;
    return fixed;
}

/* Axes inverted, and exchanges of two: one where one axis stays, two where none does. */
static int mistakes_of(const imk_signed_axes *p)
{
    int mistakes = fixed_axes(p) == AXES ? 0 : 2 - fixed_axes(p);
    for (int i = 0; i < AXES; i++)
        mistakes += p->sign[i] < 0;
    return mistakes;
}

static int total(const imk_axes_mending *m)
{
    return m->mistakes[0] + m->mistakes[1];
}

/* R and -R of the accelerometers explain the same. */
static imk_axes_mending mending_of(const imk_signed_axes *rotation, const imk_signed_axes *gyro,
                                   bool turned_over)
{
    imk_axes_mending m = {.of = {product(rotation, gyro), *rotation}};
    if (turned_over)
        m.of[1] = inverted(m.of[1]);
    for (int sensor = 0; sensor < SENSORS; sensor++)
        m.mistakes[sensor] = mistakes_of(&m.of[sensor]);
    return m;
}

static bool is_shown(const imk_axes_mending *m, int least)
{
    if (total(m) == least)
        return true;
    const int sensor = m->mistakes[0] > 0 ? 0 : 1;
    if (m->mistakes[1 - sensor] > 0)
        return false;
    return total(m) <= least + 1 || fixed_axes(&m->of[sensor]) == AXES;
}

static bool is_known(size_t count, const imk_axes_mending *known, const imk_axes_mending *m)
{
    for (size_t k = 0; k < count; k++)
        if (memcmp(&known[k], m, sizeof *m) == 0)
            return true;
    return false;
}

/* Add what has `mistakes` of one class; -1: find the least number of mistakes only. */
static int visit(int index, int mistakes, int least, size_t *count, imk_axes_mending *mending)
{
    const imk_signed_axes gyro = imk_signed_axes_of(index);
    int found = MISTAKES_MAX + 1;
    for (int k = 0; k < 2 * IMK_SIGNED_AXES; k++) {
        const imk_signed_axes rotation = imk_signed_axes_of(k / 2);
        if (rotation.determinant < 0)
            continue;
        const imk_axes_mending m = mending_of(&rotation, &gyro, k % 2 == 1);
        found = total(&m) < found ? total(&m) : found;
        if (total(&m) == mistakes && *count < IMK_AXES_MENDINGS_MAX && is_shown(&m, least) &&
            !is_known(*count, mending, &m))
            mending[(*count)++] = m;
    }
    return found;
}

size_t imk_axes_mendings(uint64_t classes, imk_axes_mending mending[IMK_AXES_MENDINGS_MAX])
{
    int least = MISTAKES_MAX;
    size_t count = 0;
    for (int index = 0; index < IMK_SIGNED_AXES; index++)
        if (classes >> index & 1) {
            const int here = visit(index, -1, 0, &count, mending);
            least = here < least ? here : least;
        }
    if (classes == 0 || least == 0)
        return 0;
    for (int mistakes = least; mistakes <= least + 2; mistakes++)
        for (int index = 0; index < IMK_SIGNED_AXES; index++)
            if (classes >> index & 1)
                (void)visit(index, mistakes, least, &count, mending);
    return count;
}
