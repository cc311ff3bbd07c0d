/* SPDX-License-Identifier: Apache-2.0 */
/* Records of MCAP files, which are logs of their own and parts of rosbag2 folders. */
#ifndef IMUKIT_LOG_MCAP_INTERNAL_H
#define IMUKIT_LOG_MCAP_INTERNAL_H

#include "log_ros_internal.h"

enum {
    IMKI_MCAP_MAGIC = 8,
    IMKI_MCAP_HEAD = 9,
    IMKI_MCAP_MESSAGE_MEMBERS = 22, /* channel, sequence, two times */
    IMKI_MCAP_SCHEMAS_MAX = 10000
};
#define IMKI_MCAP_MAGIC_TEXT "\x89MCAP0\r\n"

/* First bytes of records. */
enum {
    IMKI_MCAP_HEADER = 1,
    IMKI_MCAP_FOOTER = 2,
    IMKI_MCAP_SCHEMA = 3,
    IMKI_MCAP_CHANNEL = 4,
    IMKI_MCAP_MESSAGE = 5,
    IMKI_MCAP_CHUNK = 6,
    IMKI_MCAP_MESSAGE_INDEX = 7,
    IMKI_MCAP_CHUNK_INDEX = 8,
    IMKI_MCAP_ATTACHMENT = 9,
    IMKI_MCAP_ATTACHMENT_INDEX = 10,
    IMKI_MCAP_STATISTICS = 11,
    IMKI_MCAP_METADATA = 12,
    IMKI_MCAP_METADATA_INDEX = 13,
    IMKI_MCAP_SUMMARY_OFFSET = 14,
    IMKI_MCAP_DATA_END = 15
};

typedef struct imki_mcap_schema {
    uint32_t id;
    char name[64];
} imki_mcap_schema;

typedef struct imki_mcap {
    imki_ros_log *log;
    imki_ros_inside inside;
    imki_mcap_schema *schemas;
    size_t schema_count, schema_room;
    /* CRC-32 of the file up to a place, as long as all of it was met and no chunk has its own. */
    uint32_t sum;
    uint64_t summed;
} imki_mcap;

typedef struct imki_mcap_record {
    uint8_t kind;
    const uint8_t *data;
    uint64_t size; /* of the data */
} imki_mcap_record;

/* The members of a record, one after the other; what is beyond its end is 0 and sets `bad`. */
typedef struct imki_mcap_members {
    const uint8_t *at, *end;
    bool bad;
} imki_mcap_members;

/* The next `size` bytes. */
const uint8_t *imki_mcap_take(imki_mcap_members *members, uint64_t size);

static inline uint16_t imki_mcap_u16(imki_mcap_members *members)
{
    const uint8_t *at = imki_mcap_take(members, 2);
    return at ? imki_get_u16(at) : 0;
}

static inline uint32_t imki_mcap_u32(imki_mcap_members *members)
{
    const uint8_t *at = imki_mcap_take(members, 4);
    return at ? imki_get_u32(at) : 0;
}

static inline uint64_t imki_mcap_u64(imki_mcap_members *members)
{
    const uint8_t *at = imki_mcap_take(members, 8);
    return at ? imki_get_u64(at) : 0;
}

imki_log_piece imki_mcap_text(imki_mcap_members *members);

/* ---- log_mcap_read.c ------------------------------------------------------------------------- */

/* Begin at the first byte of the text of mcap->log. */
imk_status imki_mcap_start(imki_mcap *mcap, imk_error *error);
/* As imki_ros_container.next. */
imk_status imki_mcap_next(imki_mcap *mcap, imki_ros_message *message, bool *found,
                          imk_error *error);
void imki_mcap_stop(imki_mcap *mcap);

/* Have the record whose head is at hand. */
imk_status imki_mcap_need(imki_ros_log *log, imki_mcap_record *record, bool *whole,
                          imk_error *error);
/* Note a schema or a channel. */
imk_status imki_mcap_define(imki_mcap *mcap, const imki_mcap_record *record, imk_error *error);

/* ---- log_mcap_shape.c ------------------------------------------------------------------------ */

/* As imki_ros_container.shape. */
imki_ros_shape imki_mcap_shape(imki_ros_log *log, const uint8_t *at, size_t at_hand, bool strict);
/* Do the members of a record of a kind that is not known look as those of a message or a chunk? */
bool imki_mcap_holds_messages(imki_ros_log *log, const uint8_t *at, size_t at_hand);

/* ---- log_mcap_summary.c ---------------------------------------------------------------------- */

/* What the summary says of topics, numbers of messages and places of chunks; *intact: all channels
 * are in it. The text is then at the first record. Of files, not of pipes. */
imk_status imki_mcap_summary_read(imki_mcap *mcap, bool *intact, imk_error *error);
imk_status imki_mcap_go(imki_mcap *mcap, double fraction, imk_error *error);

#endif
