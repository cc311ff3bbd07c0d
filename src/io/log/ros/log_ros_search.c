/* SPDX-License-Identifier: Apache-2.0 */
/* Where the records of a log go on behind damage.
 *
 * A record is believed if its members agree with its length, as those of an Imu do, or if another
 * one stands where it ends. Otherwise its own length may be damaged: if a place at which records
 * begin is within it, it is left out, and the log goes on there. Such a place is a chunk or a
 * definition whose members agree, or several records of which each begins where the one before
 * ends. A file with an index knows the places of its chunks. */
#include "log_ros_internal.h"

enum {
    HEAD = 9,              /* bytes by which most places are told to be none */
    ENOUGH = 3,            /* weight of the records of a place */
    UNPROVEN_MAX = 1 << 24 /* bytes that are looked through for what stands behind a message */
};

imki_ros_shape imki_ros_message_shape(imki_ros_log *log, uint32_t channel, const uint8_t *at,
                                      size_t at_hand, size_t head, uint64_t size, bool strict)
{
    enum { IMU_MAX = 1 << 12 };
    const imki_ros_topic *topic = imki_ros_topic_of(log, channel);
    imki_ros_shape shape = {.size = head + size, .weight = topic || !strict};
    if (!topic || topic->encoding == IMKI_ROS_OTHER || size > IMU_MAX)
        return shape;
    if (at_hand < shape.size)
        return (imki_ros_shape){.due = (size_t)shape.size};
    shape.proven = imki_ros_imu_fits(topic->encoding, at + head, (size_t)size);
    return shape;
}

/* What stands `offset` bytes behind text->next. @param strict  as of imki_ros_container.shape */
static imk_status shape_at(imki_ros_log *log, uint64_t offset, bool strict, imki_ros_shape *shape,
                           imk_error *error)
{
    imki_log_text *text = log->text;
    *shape = (imki_ros_shape){.due = HEAD};
    for (uint64_t at_hand = 0; shape->due > at_hand;) {
        const uint64_t due = offset + shape->due;
        const imk_status status =
            imki_log_text_need(text, due < SIZE_MAX / 2 ? (size_t)due : SIZE_MAX / 2, error);
        if (status != IMK_OK)
            return status;
        if ((uint64_t)(text->end - text->next) < due) {
            shape->cut = true;
            return IMK_OK;
        }
        at_hand = (uint64_t)(text->end - text->next) - offset;
        *shape = log->container->shape(log, (const uint8_t *)text->next + offset, (size_t)at_hand,
                                       strict);
    }
    return IMK_OK;
}

static bool ends_at(const imki_log_text *text, uint64_t offset)
{
    return (uint64_t)(text->end - text->next) == offset;
}

/* Do records begin there? */
static imk_status is_place(imki_ros_log *log, uint64_t offset, bool *place, imk_error *error)
{
    imki_ros_shape shape;
    *place = false;
    for (unsigned weight = 0; weight < ENOUGH; weight += shape.weight, offset += shape.size) {
        const imk_status status = shape_at(log, offset, true, &shape, error);
        if (status != IMK_OK)
            return status;
        if (shape.cut)
            *place = weight > 0 && ends_at(log->text, offset);
        if (shape.cut || shape.weight == 0 || shape.size > IMKI_ROS_RECORD_MAX ||
            (!shape.proven && shape.size > UNPROVEN_MAX))
            return IMK_OK;
    }
    *place = true;
    return IMK_OK;
}

/* The first place from *offset on, before `end`. */
static imk_status find_place(imki_ros_log *log, uint64_t *offset, uint64_t end, bool *found,
                             imk_error *error)
{
    imk_status status = IMK_OK;
    for (*found = false; *offset < end; ++*offset) {
        if ((uint64_t)(log->text->end - log->text->next) < *offset + HEAD && log->text->finished)
            break;
        status = is_place(log, *offset, found, error);
        if (status != IMK_OK || *found)
            break;
    }
    return status;
}

/* Does another record, or the end, stand behind one of this size? */
static imk_status fits(imki_ros_log *log, uint64_t size, bool *is, imk_error *error)
{
    imki_ros_shape shape;
    const imk_status status = shape_at(log, size, true, &shape, error);
    *is = shape.cut ? ends_at(log->text, size) : shape.weight > 0;
    return status;
}

/* Is the record at text->next to be believed? Also if it is cut, and nothing else is in it. */
static imk_status believe(imki_ros_log *log, bool *sound, imk_error *error)
{
    imki_ros_shape shape;
    uint64_t offset = 1;
    bool other = false;
    imk_status status = shape_at(log, 0, false, &shape, error);
    *sound = shape.proven || ends_at(log->text, 0);
    if (status != IMK_OK || *sound || (!shape.cut && shape.weight == 0))
        return status;
    if (!shape.cut)
        status = fits(log, shape.size, sound, error);
    if (status != IMK_OK || *sound)
        return status;
    status = find_place(log, &offset, shape.cut ? UINT64_MAX : shape.size, &other, error);
    *sound = !other;
    return status;
}

imk_status imki_ros_go_on(imki_ros_log *log, bool *sound, bool *over, imk_error *error)
{
    enum { STEP = 1 << 16 };
    imki_log_text *text = log->text;
    uint64_t place;
    bool found = false;
    *over = false;
    imk_status status = believe(log, sound, error);
    if (status != IMK_OK || *sound)
        return status;
    imki_log_damage(log->reader, log->rows);
    if (imki_ros_can_seek(log) &&
        imki_ros_place_next(&log->places, imki_log_text_place(text), &place) &&
        place < imki_ros_size(log))
        return imki_log_text_seek(text, place, error);
    while (status == IMK_OK && !found && !*over) {
        uint64_t offset = 1;
        status = find_place(log, &offset, STEP, &found, error);
        const uint64_t at_hand = (uint64_t)(text->end - text->next);
        *over = !found && offset < STEP;
        text->next += *over ? at_hand : found ? offset : offset - 1;
        if (!found && !*over)
            imki_ros_mark(log, 0, over);
    }
    return status;
}
