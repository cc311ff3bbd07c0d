/* SPDX-License-Identifier: Apache-2.0 */
/* Logs of robots: containers of messages of many topics, of which one topic of sensor_msgs/Imu is
 * read. A container (ROS 1 bag, MCAP, rosbag2) gives its channels and messages in the order in
 * which they stand; what the messages say, and which of them become rows, is common. */
#ifndef IMUKIT_LOG_ROS_INTERNAL_H
#define IMUKIT_LOG_ROS_INTERNAL_H

#include "io/log/log_reader_internal.h"
#include "log_ros_imu_internal.h"

enum {
    IMKI_ROS_CHANNELS_MAX = 10000,
    IMKI_ROS_LOOK = 16,             /* messages of a topic that tell what it has */
    IMKI_ROS_LOOK_BYTES = 16 << 20, /* of a log without index that are looked at for topics */
    IMKI_ROS_RECORD_MAX = 1 << 30,  /* bytes of a chunk or message */
    IMKI_ROS_MESSAGE_MAX = 1 << 20, /* bytes of an Imu message that is compressed by itself */
    IMKI_ROS_FRAME = 64             /* bytes of a frame that are compared with another */
};

/* A message as it stands in the log. */
typedef struct imki_ros_message {
    uint32_t channel;
    int64_t received; /* time at which it was recorded [ns] */
    const uint8_t *data;
    size_t size;
} imki_ros_message;

/* A topic of one type; a sensor of the log. */
typedef struct imki_ros_topic {
    imk_log_stream stream;
    uint64_t hash; /* of the whole name, type and encoding */
    imki_ros_encoding encoding;
    char form[24];      /* the encoding as the log calls it; "": not said */
    uint64_t seen;      /* messages met in the look at the beginning */
    bool has[2];        /* one of those looked at has gyro, accel */
    int strange;        /* representation of a message that is not read; 0: none was met */
    int64_t time[2][2]; /* of the first two: stamp, recorded */
    bool stamped;       /* a stamp of those looked at is not 0 */
} imki_ros_topic;

/* The number by which a container calls the topic in its messages. */
typedef struct imki_ros_channel {
    uint32_t id, topic;
} imki_ros_channel;

typedef struct imki_ros_log imki_ros_log;

/* Bytes taken as a record. */
typedef struct imki_ros_shape {
    size_t due;      /* bytes needed to tell; if not more than were at hand, the rest is told: */
    uint64_t size;   /* of the record with its head */
    unsigned weight; /* 0: it is none; 3: nothing but a record looks so */
    bool proven;     /* its members agree with its size */
    bool cut;        /* the log ends before it can be told */
} imki_ros_shape;

/* Places of the records of a file at which imk_log_seek() can begin, and reading behind damage. */
typedef struct imki_ros_places {
    uint64_t *place;
    size_t count, room;
    bool sorted;
} imki_ros_places;

/* The functions of a container. */
typedef struct imki_ros_container {
    /* The next message; *found is false at the end. Damage is told by imki_log_damage(). */
    imk_status (*next)(imki_ros_log *log, imki_ros_message *message, bool *found, imk_error *error);
    /* Go back to where `looked` is, or to the first message; see imki_ros_log.looking. */
    imk_status (*back)(imki_ros_log *log, imk_error *error);
    /* What bytes are as a record; of containers of bytes.
     * @param at_hand  at least 9
     * @param strict   at a place that nothing led to: only what this log surely has */
    imki_ros_shape (*shape)(imki_ros_log *log, const uint8_t *at, size_t at_hand, bool strict);
} imki_ros_container;

/* The beginning of the state of each of these formats. */
struct imki_ros_log {
    const imki_ros_container *container;
    /* Of the present call: a reader that is rewound is another one. */
    imk_log_reader *reader;
    imki_log_text *text; /* what a container of bytes reads */
    bool apart;          /* which is not that of the reader */
    imki_ros_topic *topics;
    size_t topic_count, topic_room;
    imki_ros_channel *channels; /* by id */
    size_t channel_count, channel_room;
    imki_ros_places places; /* of chunks, by the index */
    imki_ros_channel last;  /* looked up, if last_known */
    bool last_known;
    size_t topic; /* the one that is read */
    bool indexed; /* all topics are known */
    bool counted; /* and their numbers of messages */
    bool moved;   /* by imk_log_seek(): channels may be unknown */
    uint64_t met; /* messages of the topic that is read */
    /* In the look at the beginning: bytes are kept from where `looked` is, a record before the
     * first message of an Imu, so that a pipe can go back, too. */
    bool looking, held;
    uint64_t looked;
    size_t damaged_before; /* there */
    size_t damaged_met;    /* in the look */
    bool cut_met;
    size_t unread_chunks; /* that cannot be unpacked */
    char unread[96];      /* why the first one of them */
    bool by_receipt;      /* the first stamps are 0: the times are those of recording */
    int64_t origin;       /* [ns] */
    bool frame_known;
    uint8_t frame[IMKI_ROS_FRAME]; /* of the first message that is read */
    size_t frame_size;
    uint64_t frame_mask; /* bytes of the first eight that are of the frame */
    size_t rows;         /* of the present call, for the place of damage */
    bool packed;         /* each message is compressed by zstd */
    uint8_t *unpacked;
    void *unpacker;
};

/* Is this the text? A piece that is not there is empty. */
static inline bool imki_piece_is(imki_log_piece piece, const char *text)
{
    const size_t length = (size_t)(piece.end - piece.begin);
    return strlen(text) == length && (length == 0 || memcmp(piece.begin, text, length) == 0);
}

/* ---- log_ros_topics.c ------------------------------------------------------------------------ */

/* Note a topic, if it is not there yet. @param topic  receives its number */
imk_status imki_ros_topic_add(imki_ros_log *log, imki_log_piece name, imki_log_piece type,
                              imki_ros_encoding encoding, uint32_t *topic, imk_error *error);
/* State the encoding of a topic as the log calls it. */
void imki_ros_topic_form(imki_ros_log *log, uint32_t topic, imki_log_piece form);
/* Note a channel. One that is there already is replaced.
 * @param name,type  not terminated by a zero
 * @param topic      receives its number
 * @return IMK_ERROR_MEMORY, IMK_ERROR_RANGE (too many) */
imk_status imki_ros_channel_add(imki_ros_log *log, uint32_t id, imki_log_piece name,
                                imki_log_piece type, imki_ros_encoding encoding, uint32_t *topic,
                                imk_error *error);
/* The topic of a channel; NULL: there is no such channel. */
imki_ros_topic *imki_ros_topic_of(imki_ros_log *log, uint32_t channel);
/* What an index says of a channel: messages, and times [ns] between which they are. */
void imki_ros_topic_count(imki_ros_log *log, uint32_t channel, uint64_t messages);
void imki_ros_topic_times(imki_ros_log *log, uint32_t channel, int64_t begin, int64_t end);
/* The index is none. */
void imki_ros_topic_uncount(imki_ros_log *log);

/* ---- log_ros_rows.c -------------------------------------------------------------------------- */

/* The state of a reader, at the beginning of each call. */
imki_ros_log *imki_ros_log_of(imk_log_reader *reader);
/* As imki_log_codec.open, behind what the container opens itself, and .read. The state of the
 * reader begins with an imki_ros_log. */
imk_status imki_ros_open(imki_ros_log *log, imk_error *error);
imk_status imki_ros_read(imk_log_reader *reader, size_t max_rows, double *const *out, size_t *rows,
                         imk_error *error);
void imki_ros_close(imki_ros_log *log);

/* ---- log_ros_frames.c ------------------------------------------------------------------------ */

static inline size_t imki_ros_frame_compared(const imki_imu *imu)
{
    return imu->frame_size < IMKI_ROS_FRAME ? imu->frame_size : IMKI_ROS_FRAME;
}

/* Is the frame of a message that of the first one? Short ones without a call; behind a frame there
 * are more than eight bytes of numbers. */
static inline bool imki_ros_frame_is_first(const imki_ros_log *log, const imki_imu *imu)
{
    const uint64_t bytes = (imki_get_u64(imu->frame) ^ imki_get_u64(log->frame)) & log->frame_mask;
    return (bytes | (imu->frame_size ^ log->frame_size)) == 0 && log->frame_known &&
           (imu->frame_size <= 8 ||
            memcmp(imu->frame, log->frame, imki_ros_frame_compared(imu)) == 0);
}

/* The first frame, or another one: count it. */
void imki_ros_frame_note(imki_ros_log *log, const imki_imu *imu);

/* ---- log_ros_records.c ----------------------------------------------------------------------- */

/* Have a record of `size` bytes at hand, from text->next. *whole: it is all there; else the log is
 * cut short, which is noted, and text->next stays. */
imk_status imki_ros_need(imki_ros_log *log, uint64_t size, bool *whole, imk_error *error);
/* Pass bytes without a look at them; *whole is false if the log ends before. */
imk_status imki_ros_skip(imki_ros_log *log, uint64_t size, bool *whole, imk_error *error);
/* A record begins at text->next. *enough: the look at the beginning ends before it, as the bytes
 * kept would become too many. */
void imki_ros_mark(imki_ros_log *log, uint64_t size, bool *enough);
/* Back to the mark. */
imk_status imki_ros_back(imki_ros_log *log, imk_error *error);
/* Can the text go to any place? And the size of the file, then. */
bool imki_ros_can_seek(const imki_ros_log *log);
uint64_t imki_ros_size(const imki_ros_log *log);

/* Refuse a record whose lengths contradict each other. */
imk_status imki_ros_refuse_record(const imki_ros_log *log, const char *what, const char *remedy,
                                  imk_error *error);

/* ---- log_ros_chunk.c ------------------------------------------------------------------------- */

typedef enum imki_ros_packing {
    IMKI_ROS_PLAIN = 0,
    IMKI_ROS_BZ2,
    IMKI_ROS_LZ4,
    IMKI_ROS_ZSTD,
    IMKI_ROS_PACKING_UNKNOWN
} imki_ros_packing;

imki_ros_packing imki_ros_packing_named(imki_log_piece name);

/* A chunk unpacked; the buffer grows with what comes out, and stays for the next. */
typedef struct imki_ros_chunk {
    uint8_t *bytes;
    size_t size, room;
    void *lz4, *zstd;
} imki_ros_chunk;

/* Unpack. Zero-initialised before the first.
 * @param due     size that the log claims; more than that is not unpacked
 * @param intact  whether all could be unpacked and is as much as claimed; else chunk->size is what
 *                came out before the fault
 * @return IMK_ERROR_MEMORY */
imk_status imki_ros_unpack(imki_ros_chunk *chunk, imki_ros_packing packing, const uint8_t *bytes,
                           size_t size, uint64_t due, bool *intact, imk_error *error);
void imki_ros_chunk_free(imki_ros_chunk *chunk);

/* The chunk whose records are being read. */
typedef struct imki_ros_inside {
    imki_ros_chunk unpacked;
    const uint8_t *at, *end; /* records that are left; NULL: none is open */
    uint64_t behind;         /* bytes from text->next to the next record of the file */
    bool cut;                /* the log ends within it */
} imki_ros_inside;

/* Begin with a chunk that stands in the text; where it is damaged it is told and passed.
 * @param bytes,size  at hand, less than all if the log is cut short, which is known then
 * @param due,sum     size and CRC-32 of the unpacked bytes; 0: no CRC */
imk_status imki_ros_enter(imki_ros_log *log, imki_ros_inside *inside, imki_log_piece packing,
                          const uint8_t *bytes, size_t size, uint64_t due, uint32_t sum,
                          imk_error *error);
/* All is read, or what is left makes no sense. */
void imki_ros_leave(imki_ros_log *log, imki_ros_inside *inside, bool damaged);

bool imki_ros_place_add(imki_ros_places *places, uint64_t place);
/* The last one that is not behind this fraction of the file; the first, if all are. In any order.
 * @return false: there is none */
bool imki_ros_place_find(const imki_ros_places *places, uint64_t target, uint64_t *place);
/* The first one behind `here`. @return false: there is none */
bool imki_ros_place_next(imki_ros_places *places, uint64_t here, uint64_t *place);

/* ---- log_ros_search.c ------------------------------------------------------------------------ */

/* The shape of a message with a head of `head` bytes before its `size` bytes. */
imki_ros_shape imki_ros_message_shape(imki_ros_log *log, uint32_t channel, const uint8_t *at,
                                      size_t at_hand, size_t head, uint64_t size, bool strict);
/* Is the record at text->next to be believed? If not, this is told as damage, and the text goes to
 * the next place at which records begin.
 * @param sound  the text stays where it is; also at the end of the log
 * @param over   there is no such place, or it is not looked for any farther */
imk_status imki_ros_go_on(imki_ros_log *log, bool *sound, bool *over, imk_error *error);

#endif
