/* SPDX-License-Identifier: Apache-2.0 */
/* Wrong signs and exchanged axes in words: each of the simplest mendings, and what decides between
 * them. */
#include "calibrate_show_internal.h"

#include "imukit/axes_mending.h"

#include <stdio.h>
#include <stdlib.h>

enum { AXES = 3 };

/* What of one sensor must change. */
typedef struct change {
    const imk_signed_axes *axes;
    const char *key; /* gyro or accel */
    int inverted, moved;
} change;

static change change_of(const imk_axes_mending *m, int sensor)
{
    change c = {.axes = &m->of[sensor], .key = imki_sensor_keys[sensor]};
    for (int i = 0; i < AXES; i++) {
        c.inverted += c.axes->sign[i] < 0;
        c.moved += c.axes->column[i] != i;
    }
    return c;
}

/* The axes with a property, as "gyro_x and gyro_y". */
static void list_axes(const change *c, bool moved, imki_text *to)
{
    int named = 0;
    for (int i = 0; i < AXES; i++)
        if (moved ? c->axes->column[i] != i : c->axes->sign[i] < 0)
            imki_text_add(to, "%s%s_%c", named++ ? " and " : "", c->key, imk_axis_letter(i));
}

static void describe(const change *c, imki_text *to)
{
    if (c->moved == 0 && c->inverted == AXES)
        imki_text_add(to, "all three %s inverted", c->key[0] == 'g' ? "gyros" : "accelerometers");
    else if (c->moved == 0 || (c->moved == 2 && c->inverted == 0)) {
        list_axes(c, c->moved > 0, to);
        imki_text_put(to, c->moved == 0 ? " inverted" : " exchanged");
    } else {
        imki_text_add(to, "%s x, y, z taken from ", c->key);
        for (int i = 0; i < AXES; i++)
            imki_text_add(to, "%s%s%c", i ? ", " : "", c->axes->sign[i] < 0 ? "-" : "",
                          imk_axis_letter(c->axes->column[i]));
    }
}

/* One mistake in each sensor, the same: axes that are left-handed. */
static bool is_left_handed(const imk_axes_mending *m)
{
    bool same = m->mistakes[0] == 1 && m->mistakes[1] == 1;
    for (int i = 0; i < AXES; i++)
        same = same && m->of[0].column[i] == m->of[1].column[i] &&
               m->of[0].sign[i] == m->of[1].sign[i];
    return same;
}

static void add_mending(const imk_axes_mending *m, imki_text *to)
{
    const change gyro = change_of(m, 0), accel = change_of(m, 1);
    imki_text_put(to, to->size > 0 ? "; or " : "");
    if (m->mistakes[0] > 0)
        describe(&gyro, to);
    imki_text_put(to, m->mistakes[0] > 0 && m->mistakes[1] > 0 ? " and " : "");
    if (m->mistakes[1] > 0)
        describe(&accel, to);
}

size_t imki_axes_text(uint64_t classes, bool certain, char *text, size_t size)
{
    imk_axes_mending mending[IMK_AXES_MENDINGS_MAX];
    imki_text list = {0};
    bool left_handed = false;
    const size_t count = imk_axes_mendings(classes, mending);
    for (size_t k = 0; k < count; k++) {
        if (!is_left_handed(&mending[k]))
            add_mending(&mending[k], &list);
        else if (!left_handed)
            imki_text_add(&list,
                          "%sleft-handed axes: the same axis of both sensors (x, y or z) "
                          "inverted, or the same two axes of both exchanged",
                          list.size > 0 ? "; or " : "");
        left_handed = left_handed || is_left_handed(&mending[k]);
    }
    snprintf(text, size,
             "signs or order of the axes %s. %s explains the log: %s. %sHold the "
             "unit with an axis up: its accelerometer must read +9.8 m/s^2. Turn it "
             "counter-clockwise as seen from the tip of an axis: its gyro must read positive. Then "
             "correct the columns (names: in the header or with --columns; signs: in the values)",
             certain ? "are wrong: the turns of the gyros do not lead from one attitude of the "
                       "accelerometers to the next"
                     : "may be wrong: some turns of the gyros do not lead from one attitude of the "
                       "accelerometers to the next, and too few turns tell more",
             count > 1 ? "Each of these" : "This",
             list.bytes ? list.bytes : "several mistakes at once",
             count > 1 ? "The log does not show which it is. " : "");
    free(list.bytes);
    return count;
}

static bool has(const imk_calibrate_log *b, imk_procedure procedure)
{
    for (size_t k = 0; k < b->count; k++)
        if (b->record[k].procedure == procedure)
            return true;
    return false;
}

/* Against the sensitivity that was stated, or by the one that was found. */
static bool is_opposite(const imk_calibrate_log *b, int axis)
{
    const imk_triad *gyro = &b->result->model.gyro;
    return gyro->scale_factor.fixed.value[axis] < -1 ||
           (b->nominal[0] && gyro->sensitivity.value[axis] < 0);
}

size_t imki_turns_text(const imk_calibrate_log *b, char *text, size_t size)
{
    imki_text list = {0};
    size_t count = 0;
    const int axes = b->result ? b->result->model.gyro.axis_count : 0;
    const bool labelled = has(b, IMK_PROCEDURE_TURNS);
    for (int i = 0; i < axes && (labelled || has(b, IMK_PROCEDURE_FERRARIS)); i++)
        if (is_opposite(b, i))
            imki_text_add(&list, "%sgyro_%c", count++ ? " and " : "", imk_axis_letter(i));
    if (count > 0)
        snprintf(text, size,
                 "%s read%s the full turns with the opposite sign: either these turns went the "
                 "other way round (%s), or these columns are inverted. The log does not show "
                 "which: turn the unit counter-clockwise as seen from the tip of an axis, and its "
                 "gyro must read positive",
                 count == (size_t)axes || !list.bytes ? "all gyros" : list.bytes,
                 count == 1 ? "s" : "",
                 labelled                ? "correct the signs in their labels"
                 : count == (size_t)axes ? "change the sign of --turn-angle"
                                         : "all turns must go the same way");
    free(list.bytes);
    return count;
}
