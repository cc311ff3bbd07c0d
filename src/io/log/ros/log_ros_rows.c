/* SPDX-License-Identifier: Apache-2.0 */
/* From messages to rows: which topic, which columns, and by which of the two times.
 *
 * The time of a row is header.stamp, that of the measurement. Where no stamp is set, the time at
 * which the message was recorded takes its place, which is told. Rows stand as the messages do: if
 * a log was recorded out of order, its times say so. */
#include "log_ros_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <zstd.h>

/* ---- one message ---- */

/* @param of  its topic */
static bool decode(imki_ros_log *log, const imki_ros_topic *of, const imki_ros_message *message,
                   imki_imu *imu)
{
    const uint8_t *data = message->data;
    size_t size = message->size;
    if (log->packed) {
        size = ZSTD_decompressDCtx(log->unpacker, log->unpacked, IMKI_ROS_MESSAGE_MAX, data, size);
        data = log->unpacked;
        if (ZSTD_isError(size))
            return false;
    }
    return imki_ros_imu_read(of->encoding, data, size, imu);
}

/* ---- the look at the beginning ---- */

static imk_status prepare(imki_ros_log *log, imk_error *error)
{
    log->packed = true;
    log->unpacked = malloc(IMKI_ROS_MESSAGE_MAX);
    log->unpacker = ZSTD_createDCtx();
    return log->unpacked && log->unpacker ? IMK_OK
                                          : imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
}

/* A file of a bag, given alone, does not say that its messages are compressed one by one; no
 * message of CDR begins so. */
static bool begins_packed(const imki_ros_topic *topic, const imki_ros_message *message)
{
    return topic->encoding == IMKI_ROS_CDR && message->size >= 4 &&
           memcmp(message->data, "\x28\xB5\x2F\xFD", 4) == 0;
}

static imk_status look_at(imki_ros_log *log, imki_ros_topic *topic, const imki_ros_message *message,
                          imk_error *error)
{
    imki_imu imu;
    if (topic->encoding == IMKI_ROS_OTHER || topic->seen >= IMKI_ROS_LOOK)
        return IMK_OK;
    const bool finds_packed = !log->packed && begins_packed(topic, message);
    const imk_status status = finds_packed ? prepare(log, error) : IMK_OK;
    if (status != IMK_OK)
        return status;
    if (!decode(log, topic, message, &imu)) {
        if (!log->packed && topic->encoding == IMKI_ROS_CDR)
            topic->strange = imki_ros_imu_representation(message->data, message->size);
        imki_log_damage(log->reader, 0);
        return IMK_OK;
    }
    log->held = true;
    for (int k = 0; k < 2; k++)
        topic->has[k] |= imu.has[k];
    if (topic->seen < 2) {
        topic->time[topic->seen][0] = imu.stamp;
        topic->time[topic->seen][1] = message->received;
    }
    topic->stamped |= imu.stamp != 0;
    topic->seen++;
    return IMK_OK;
}

/* Damage counts where the reading begins behind it.
 *
 * With an index, until the first messages of the topic are known; without, as far as is looked for
 * topics. */
static imk_status look(imki_ros_log *log, imk_error *error)
{
    imki_ros_message message;
    imk_status status = IMK_OK;
    log->looking = true;
    for (bool found = true; status == IMK_OK && found;) {
        status = log->container->next(log, &message, &found, error);
        imki_ros_topic *topic =
            status == IMK_OK && found ? imki_ros_topic_of(log, message.channel) : NULL;
        if (status == IMK_OK && found && !topic)
            imki_log_damage(log->reader, 0);
        if (!topic || (log->indexed && topic != &log->topics[log->topic]))
            continue;
        status = look_at(log, topic, &message, error);
        if (log->indexed && topic->seen == IMKI_ROS_LOOK)
            break;
    }
    log->looking = false;
    log->damaged_met = log->reader->damaged;
    log->cut_met = log->reader->cut_short;
    return status == IMK_OK ? log->container->back(log, error) : status;
}

/* Is it an Imu by the end of its type, whatever its encoding: "foxglove.Imu"? */
static bool is_called_imu(const char *type)
{
    const size_t length = strlen(type);
    return length >= 3 && strcmp(type + length - 3, "Imu") == 0 &&
           (length == 3 || strchr("/.:", type[length - 4]));
}

/* Is all that is damaged chunks that cannot be unpacked? */
static bool is_unread(const imki_ros_log *log)
{
    return log->unread_chunks > 0 && log->unread_chunks >= log->damaged_met;
}

static imk_status refuse_unread(const imki_ros_log *log, imk_error *error)
{
    return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "", log->unread,
                         "chunks below 1 GiB without compression, or with bz2, lz4 or zstd");
}

/* Why there is none: what is damaged, or an encoding that is not read; else as it was said. */
static imk_status refuse_empty(const imki_ros_log *log, imk_error *error)
{
    const size_t damaged = log->damaged_met;
    char found[96];
    for (size_t i = 0; i < log->topic_count; i++) {
        const imki_ros_topic *topic = &log->topics[i];
        if (topic->encoding != IMKI_ROS_OTHER || !is_called_imu(topic->stream.kind))
            continue;
        if (topic->form[0])
            snprintf(found, sizeof found, "the messages %.32s are in the encoding \"%s\"",
                     topic->stream.kind, topic->form);
        else
            snprintf(found, sizeof found, "the messages %.32s are of another definition",
                     topic->stream.kind);
        return imk_error_set(error, IMK_ERROR_EMPTY, "", found,
                             "write sensor_msgs/Imu in ros1, or sensor_msgs/msg/Imu in cdr");
    }
    if (is_unread(log))
        return refuse_unread(log, error);
    if (damaged == 0 && !log->cut_met)
        return IMK_ERROR_EMPTY;
    if (damaged == 0)
        snprintf(found, sizeof found,
                 "the log is cut short, with no sensor_msgs/Imu before its end");
    else
        snprintf(found, sizeof found,
                 "no sensor_msgs/Imu can be read, and %zu block%s or message%s damaged", damaged,
                 damaged == 1 ? "" : "s", damaged == 1 ? " is" : "s are");
    return imk_error_set(error, IMK_ERROR_EMPTY, "", found, "copy the file again");
}

static imk_status choose(imki_ros_log *log, imk_error *error)
{
    imk_log_reader *reader = log->reader;
    imk_status status = IMK_OK;
    for (size_t i = 0; i < log->topic_count && status == IMK_OK; i++) {
        imki_ros_topic *topic = &log->topics[i];
        /* One that nobody published to is not to be asked about. */
        const bool used = log->counted   ? topic->stream.samples > 0
                          : log->indexed ? true
                                         : topic->seen > 0;
        topic->stream.readable = topic->encoding != IMKI_ROS_OTHER && used;
        status = imki_log_stream_add(reader, &topic->stream, error);
    }
    if (status == IMK_OK)
        status = imki_log_stream_choose(reader, "no topic of the log has messages sensor_msgs/Imu",
                                        &log->topic, error);
    return status == IMK_ERROR_EMPTY ? refuse_empty(log, error) : status;
}

/* ---- columns and times ---- */

static imk_status make_layout(imki_ros_log *log, imk_error *error)
{
    static const char *const all[7] = {"time [s]",       "gyro_x [rad/s]",  "gyro_y [rad/s]",
                                       "gyro_z [rad/s]", "accel_x [m/s^2]", "accel_y [m/s^2]",
                                       "accel_z [m/s^2]"};
    const imki_ros_topic *topic = &log->topics[log->topic];
    const char *names[7] = {all[0]};
    for (int i = 1; i < 7; i++)
        names[i] = topic->has[(i - 1) / 3] ? all[i] : NULL;
    if (topic->seen > 0 && !topic->has[0] && !topic->has[1])
        return imk_error_set(error, IMK_ERROR_EMPTY, topic->stream.name,
                             "its messages hold neither angular rate nor specific force: their "
                             "covariances begin with -1",
                             "a topic with gyros or accelerometers");
    return imki_log_layout_of(log->reader, 7, names, error);
}

/* Wraps, as the times of a hostile log may be any. */
static int64_t difference(int64_t a, int64_t b)
{
    return (int64_t)((uint64_t)a - (uint64_t)b);
}

static imk_status find_times(imki_ros_log *log, imk_error *error)
{
    enum { BILLION = 1000000000 };
    imk_log_reader *reader = log->reader;
    const imki_ros_topic *topic = &log->topics[log->topic];
    double time[2];
    if (topic->seen == 0 && topic->strange > 0) {
        char found[96];
        snprintf(found, sizeof found, "the messages are in CDR of another kind, number %d",
                 topic->strange);
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, topic->stream.name, found,
                             "record them in plain CDR (0 or 1), as ROS 2 does, or export them "
                             "as CSV");
    }
    log->by_receipt = !topic->stamped;
    log->origin = imki_log_stamp_origin(reader, topic->time[0][log->by_receipt], BILLION);
    for (int i = 0; i < 2; i++)
        time[i] = (double)difference(topic->time[i][log->by_receipt], log->origin) / BILLION;
    return imki_log_first_rows(reader, topic->seen, time, "the topic has no message that is whole",
                               "messages sensor_msgs/Imu", error);
}

imki_ros_log *imki_ros_log_of(imk_log_reader *reader)
{
    imki_ros_log *log = reader->state;
    log->reader = reader;
    if (!log->apart)
        log->text = &reader->text;
    return log;
}

/* The index is damaged: other topics stand in the log. */
static imk_status look_again(imki_ros_log *log, uint64_t begin, imk_error *error)
{
    log->indexed = log->counted = false;
    imki_ros_topic_uncount(log);
    log->reader->stream_count = 0;
    log->looked = begin;
    log->damaged_before = 0;
    const imk_status status = log->container->back(log, error);
    return status == IMK_OK ? look(log, error) : status;
}

imk_status imki_ros_open(imki_ros_log *log, imk_error *error)
{
    imk_status status = IMK_OK;
    if (log->packed)
        status = prepare(log, error);
    if (status == IMK_OK && log->indexed)
        status = choose(log, error);
    const size_t known = log->topic_count;
    const uint64_t begin = log->looked;
    if (status == IMK_OK)
        status = look(log, error);
    if (status == IMK_OK && log->indexed && log->topics[log->topic].seen == 0 &&
        log->topic_count > known)
        status = look_again(log, begin, error);
    if (status == IMK_OK && !log->indexed)
        status = choose(log, error);
    if (status == IMK_OK && log->topics[log->topic].seen == 0 && is_unread(log))
        status = refuse_unread(log, error);
    if (status == IMK_OK)
        status = make_layout(log, error);
    return status == IMK_OK ? find_times(log, error) : status;
}

/* ---- rows ---- */

static void ask_for(const imk_log_stream *stream, size_t size, char *text)
{
    const int used = snprintf(text, size, "--topic %.96s", stream->name);
    if (stream->instance >= 0)
        snprintf(text + used, size - (size_t)used, " --instance %d", stream->instance);
}

/* A second sensor that was not there at the beginning: which one is meant is not known. */
static imk_status refuse_second(const imki_ros_log *log, const imki_ros_topic *other,
                                imk_error *error)
{
    char found[96], expected[280], one[128], two[128];
    snprintf(found, sizeof found, "a second sensor, %.64s, begins later", other->stream.name);
    ask_for(&log->topics[log->topic].stream, sizeof one, one);
    ask_for(&other->stream, sizeof two, two);
    snprintf(expected, sizeof expected, "add %s (or %s)", one, two);
    return imk_error_set(error, IMK_ERROR_NAME_UNKNOWN, "topic", found, expected);
}

static void put_row(imki_ros_log *log, const imki_imu *imu, int64_t received, double *const *out,
                    size_t row)
{
    imk_log_reader *reader = log->reader;
    const imki_log_layout_read *layout = &reader->layout;
    const int64_t time = log->by_receipt ? received : imu->stamp;
    bool finite = true;
    reader->stamps += log->by_receipt && imu->stamp != 0;
    for (int k = 0; k < 2; k++)
        reader->later[k] += imu->has[k] && layout->cell_column[3 * k + 1] < 0;
    out[0][row] = (double)difference(time, log->origin) / 1e9;
    for (int i = 0; i < 6; i++) {
        if (layout->cell_column[i + 1] < 0)
            continue;
        const double value = imu->value[i / 3][i % 3];
        out[i + 1][row] = value * layout->cell_factor[i + 1];
        finite &= isfinite(value) != 0;
    }
    if (!finite && reader->not_finite++ == 0)
        reader->first_not_finite = reader->rows + row + 1;
}

/* At the end of a log that was read as a whole. */
static void compare_with_index(const imki_ros_log *log)
{
    const uint64_t stated = log->topics[log->topic].stream.samples;
    if (!log->counted || log->moved || log->met >= stated)
        return;
    log->reader->stated = stated;
    log->reader->absent = stated - log->met;
}

imk_status imki_ros_read(imk_log_reader *reader, size_t max_rows, double *const *out, size_t *rows,
                         imk_error *error)
{
    imki_ros_log *log = imki_ros_log_of(reader);
    imki_ros_message message;
    imki_imu imu;
    bool found = true;
    reader->received = log->by_receipt;
    for (log->rows = 0; log->rows < max_rows;) {
        *rows = log->rows;
        const imk_status status = log->container->next(log, &message, &found, error);
        if (status == IMK_OK && !found)
            compare_with_index(log);
        if (status != IMK_OK || !found)
            return status;
        imki_ros_topic *topic = imki_ros_topic_of(log, message.channel);
        log->met += topic == &log->topics[log->topic];
        if (topic != &log->topics[log->topic]) {
            if (!topic && !log->moved)
                imki_log_damage(reader, log->rows);
            if (topic && topic->encoding != IMKI_ROS_OTHER && topic->seen++ == 0 && !log->indexed &&
                !reader->settings.topic)
                return refuse_second(log, topic, error);
            continue;
        }
        if (!decode(log, topic, &message, &imu)) {
            imki_log_damage(reader, log->rows);
            continue;
        }
        if (!imki_ros_frame_is_first(log, &imu))
            imki_ros_frame_note(log, &imu);
        put_row(log, &imu, message.received, out, log->rows++);
    }
    *rows = log->rows;
    return IMK_OK;
}

void imki_ros_close(imki_ros_log *log)
{
    free(log->topics);
    free(log->channels);
    free(log->places.place);
    free(log->unpacked);
    ZSTD_freeDCtx(log->unpacker);
}
