/* SPDX-License-Identifier: Apache-2.0 */
/* What bytes are as a record of an MCAP file, by the lengths of its members [MCAP]. */
#include "log_mcap_internal.h"

/* Members of records: a number of so many bytes; s: bytes behind their number, of 4 bytes; L: of
 * 8 bytes. Messages are not among them: what follows their numbers has any length. */
static const char *const layouts[] = {[IMKI_MCAP_HEADER] = "ss",
                                      [IMKI_MCAP_FOOTER] = "884",
                                      [IMKI_MCAP_SCHEMA] = "2sss",
                                      [IMKI_MCAP_CHANNEL] = "22sss",
                                      [IMKI_MCAP_CHUNK] = "8884sL",
                                      [IMKI_MCAP_MESSAGE_INDEX] = "2s",
                                      [IMKI_MCAP_CHUNK_INDEX] = "8888s8s88",
                                      [IMKI_MCAP_ATTACHMENT] = "88ssL4",
                                      [IMKI_MCAP_ATTACHMENT_INDEX] = "88888ss",
                                      [IMKI_MCAP_STATISTICS] = "82444488s",
                                      [IMKI_MCAP_METADATA] = "ss",
                                      [IMKI_MCAP_METADATA_INDEX] = "88s",
                                      [IMKI_MCAP_SUMMARY_OFFSET] = "188",
                                      [IMKI_MCAP_DATA_END] = "4"};

enum {
    KINDS = sizeof layouts / sizeof layouts[0],
    LINKED = 3,          /* weight of what nothing else looks like */
    TEXTS_MAX = 1 << 16, /* bytes of members before the last length */
    LATER_MAX = 1 << 12  /* bytes of members that later versions of the format may add */
};

static const imki_ros_shape none = {.due = 0};

static imki_ros_shape message_shape(imki_ros_log *log, const uint8_t *at, size_t at_hand,
                                    uint64_t size, bool strict)
{
    enum { CHANNEL = IMKI_MCAP_HEAD, TIMES = CHANNEL + 6, BEHIND = TIMES + 16 };
    if (size < IMKI_MCAP_MESSAGE_MEMBERS || size > IMKI_ROS_RECORD_MAX)
        return none;
    if (at_hand < BEHIND)
        return (imki_ros_shape){.due = BEHIND};
    if (strict &&
        (imki_get_u64(at + TIMES) > INT64_MAX || imki_get_u64(at + TIMES + 8) > INT64_MAX))
        return none;
    return imki_ros_message_shape(log, imki_get_u16(at + CHANNEL), at, at_hand, BEHIND,
                                  size - IMKI_MCAP_MESSAGE_MEMBERS, strict);
}

/* Of a chunk whose lengths agree. */
static bool is_chunk(const uint8_t *at, size_t at_hand)
{
    imki_mcap_members m = {at + IMKI_MCAP_HEAD, at + at_hand, false};
    const uint64_t begin = imki_mcap_u64(&m), end = imki_mcap_u64(&m), due = imki_mcap_u64(&m);
    imki_mcap_u32(&m);
    const imki_ros_packing packing = imki_ros_packing_named(imki_mcap_text(&m));
    const uint64_t size = imki_mcap_u64(&m);
    return !m.bad && begin <= end && end <= INT64_MAX && due <= IMKI_ROS_RECORD_MAX &&
           packing != IMKI_ROS_PACKING_UNKNOWN && (packing != IMKI_ROS_PLAIN || size == due);
}

/* The bytes of all members. @return false: they are not those of a record of `size` bytes
 * @param due  bytes needed to tell, if those at hand are too few */
static bool add_members(const char *layout, const uint8_t *at, size_t at_hand, uint64_t size,
                        uint64_t *sum, size_t *due)
{
    *sum = 0;
    for (; *layout; layout++) {
        const bool number = *layout >= '0' && *layout <= '9';
        const unsigned width = number ? (unsigned)(*layout - '0') : *layout == 'L' ? 8 : 4;
        if (width > size - *sum)
            return false;
        const uint8_t *member = at + IMKI_MCAP_HEAD + *sum;
        *sum += width;
        if (number)
            continue;
        if (*sum > TEXTS_MAX)
            return false;
        *due = IMKI_MCAP_HEAD + (size_t)*sum;
        if (at_hand < *due)
            return true;
        const uint64_t length = width == 8 ? imki_get_u64(member) : imki_get_u32(member);
        if (length > size - *sum)
            return false;
        *sum += length;
    }
    return true;
}

/* With the magic behind it, which is shorter than a record. */
static imki_ros_shape footer_shape(const uint8_t *at, size_t at_hand)
{
    enum { SIZE = IMKI_MCAP_HEAD + 20, ALL = SIZE + IMKI_MCAP_MAGIC };
    if (at_hand < ALL)
        return (imki_ros_shape){.due = ALL};
    if (memcmp(at + SIZE, IMKI_MCAP_MAGIC_TEXT, IMKI_MCAP_MAGIC) != 0)
        return none;
    return (imki_ros_shape){.size = ALL, .weight = LINKED, .proven = true};
}

imki_ros_shape imki_mcap_shape(imki_ros_log *log, const uint8_t *at, size_t at_hand, bool strict)
{
    enum { CHUNK = 2 };
    const uint8_t kind = at[0];
    const uint64_t size = imki_get_u64(at + 1), all = IMKI_MCAP_HEAD + size;
    uint64_t sum;
    size_t due = 0;
    if (kind == IMKI_MCAP_MESSAGE)
        return message_shape(log, at, at_hand, size, strict);
    if (kind == 0 || size > UINT64_MAX / 2 || (kind >= KINDS && strict))
        return none;
    if (kind >= KINDS)
        return (imki_ros_shape){.size = all, .weight = size <= IMKI_ROS_RECORD_MAX};
    if (!add_members(layouts[kind], at, at_hand, size, &sum, &due))
        return none;
    if (at_hand < due)
        return (imki_ros_shape){.due = due};
    if (strict && kind == IMKI_MCAP_FOOTER)
        return footer_shape(at, at_hand);
    const bool chunk = kind == IMKI_MCAP_CHUNK;
    const bool defines = kind == IMKI_MCAP_SCHEMA || kind == IMKI_MCAP_CHANNEL;
    if (sum != size)
        return (imki_ros_shape){.size = all,
                                .weight = !strict && (chunk || defines) && size - sum <= LATER_MAX};
    if (strict && chunk && !is_chunk(at, at_hand))
        return none;
    return (imki_ros_shape){.size = all,
                            .weight = defines ? LINKED
                                      : chunk ? CHUNK
                                              : 1,
                            .proven = true};
}

bool imki_mcap_holds_messages(imki_ros_log *log, const uint8_t *at, size_t at_hand)
{
    uint64_t sum;
    size_t due = 0;
    const uint64_t size = imki_get_u64(at + 1);
    if (message_shape(log, at, at_hand, size, true).weight > 0)
        return true;
    return add_members(layouts[IMKI_MCAP_CHUNK], at, at_hand, size, &sum, &due) && sum == size &&
           at_hand >= due && is_chunk(at, at_hand);
}
