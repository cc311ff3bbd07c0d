/* SPDX-License-Identifier: Apache-2.0 */
/* metadata.yaml of a bag of ROS 2 [ROSBAG2], of which newer databases hold a copy:
 *
 *     rosbag2_bagfile_information:
 *       storage_identifier: sqlite3 | mcap
 *       duration: {nanoseconds: N}
 *       starting_time: {nanoseconds_since_epoch: N}
 *       topics_with_message_count:
 *         - topic_metadata: {name: T, type: T, serialization_format: cdr, …}
 *           message_count: N
 *       compression_format: "" | zstd
 *       compression_mode: "" | NONE | FILE | MESSAGE
 *       relative_file_paths: [FILE, …] */
#include "log_rosbag2_internal.h"

#include "imukit/names.h"
#include "io/model/document_internal.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

imki_ros_encoding imki_rosbag2_encoding(imki_log_piece type, imki_log_piece serialisation)
{
    return imki_piece_is(serialisation, "cdr") && imki_piece_is(type, "sensor_msgs/msg/Imu")
               ? IMKI_ROS_CDR
               : IMKI_ROS_OTHER;
}

/* Text of a scalar of a mapping; "" where there is none. */
static const char *text_of(const imk_document *document, int mapping, const char *key)
{
    const int node = mapping == IMKI_NONE ? IMKI_NONE : imki_document_value(document, mapping, key);
    const bool scalar = node != IMKI_NONE && document->node[node].kind == IMKI_NODE_SCALAR;
    return scalar ? document->node[node].text : "";
}

static imki_log_piece piece_of(const char *text)
{
    return (imki_log_piece){text, text + strlen(text)};
}

/* A value of this kind; IMKI_NONE: there is none. */
static int value_of(const imk_document *document, int mapping, const char *key, imki_node_kind kind)
{
    const int node = mapping == IMKI_NONE ? IMKI_NONE : imki_document_value(document, mapping, key);
    return node != IMKI_NONE && document->node[node].kind == kind ? node : IMKI_NONE;
}

/* A whole number. */
static bool number_of(const imk_document *document, int mapping, const char *key, int64_t *number)
{
    const char *text = text_of(document, mapping, key);
    char *end;
    errno = 0;
    *number = strtoll(text, &end, 10);
    return *text != '\0' && *end == '\0' && errno == 0;
}

static imk_status take_topic(imki_rosbag2 *bag, const imk_document *document, int entry,
                             const int64_t time[2], imk_error *error)
{
    const int about = value_of(document, entry, "topic_metadata", IMKI_NODE_MAPPING);
    const imki_log_piece name = piece_of(text_of(document, about, "name"));
    const imki_log_piece type = piece_of(text_of(document, about, "type"));
    const imki_log_piece form = piece_of(text_of(document, about, "serialization_format"));
    int64_t messages;
    uint32_t topic;
    if (!number_of(document, entry, "message_count", &messages) || messages < 0)
        return IMK_OK;
    const imk_status status =
        imki_ros_topic_add(&bag->log, name, type, imki_rosbag2_encoding(type, form), &topic, error);
    if (status != IMK_OK)
        return status;
    imki_ros_topic_form(&bag->log, topic, form);
    imk_log_stream *stream = &bag->log.topics[topic].stream;
    stream->samples = (uint64_t)messages;
    if (messages > 0 && time[1] >= time[0]) {
        stream->begin = (double)time[0] / 1e9;
        stream->end = (double)time[1] / 1e9;
    }
    return IMK_OK;
}

static imk_status take_topics(imki_rosbag2 *bag, const imk_document *document, int root,
                              imk_error *error)
{
    const int topics = value_of(document, root, "topics_with_message_count", IMKI_NODE_SEQUENCE);
    int64_t time[2] = {0, -1}, duration;
    if (topics == IMKI_NONE)
        return IMK_OK;
    if (number_of(document, value_of(document, root, "starting_time", IMKI_NODE_MAPPING),
                  "nanoseconds_since_epoch", &time[0]) &&
        number_of(document, value_of(document, root, "duration", IMKI_NODE_MAPPING), "nanoseconds",
                  &duration) &&
        duration >= 0 && time[0] >= 0 && time[0] <= INT64_MAX - duration)
        time[1] = time[0] + duration;
    imk_status status = IMK_OK;
    for (int entry = document->node[topics].first; entry != IMKI_NONE && status == IMK_OK;
         entry = document->node[entry].next)
        if (document->node[entry].kind == IMKI_NODE_MAPPING)
            status = take_topic(bag, document, entry, time, error);
    bag->log.indexed = bag->log.counted = true;
    return status;
}

/* Files lie in the folder itself, whatever folder their names say they were recorded in. */
static imk_status take_files(imki_rosbag2 *bag, const imk_document *document, int root,
                             const char *folder, imk_error *error)
{
    const int files = value_of(document, root, "relative_file_paths", IMKI_NODE_SEQUENCE);
    const int count = files == IMKI_NONE ? 0 : document->node[files].count;
    if (count == 0)
        return imk_error_set(error, IMK_ERROR_EMPTY, folder, "metadata.yaml names no files",
                             "write it anew: ros2 bag reindex FOLDER");
    bag->files = calloc((size_t)count, sizeof *bag->files);
    if (!bag->files)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    for (int entry = document->node[files].first; entry != IMKI_NONE;
         entry = document->node[entry].next) {
        const imki_node *node = &document->node[entry];
        if (node->kind != IMKI_NODE_SCALAR)
            continue;
        const char *slash = strrchr(node->text, '/');
        const char *name = slash ? slash + 1 : node->text;
        const size_t size = strlen(folder) + strlen(name) + 2;
        char *path = malloc(size);
        if (!path)
            return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
        snprintf(path, size, "%s/%s", folder, name);
        bag->files[bag->file_count++] = path;
    }
    return IMK_OK;
}

static imk_status take_form(imki_rosbag2 *bag, const imk_document *document, int root,
                            imk_error *error)
{
    const char *storage = text_of(document, root, "storage_identifier");
    const char *packing = text_of(document, root, "compression_format");
    const char *mode = text_of(document, root, "compression_mode");
    char found[96];
    bag->of_mcap = strcmp(storage, "mcap") == 0;
    bag->log.packed =
        *packing != '\0' && (strcmp(mode, "MESSAGE") == 0 || strcmp(mode, "message") == 0);
    if (!bag->of_mcap && strcmp(storage, "sqlite3") != 0) {
        snprintf(found, sizeof found, "the storage of the bag is \"%.32s\"", storage);
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "storage_identifier", found,
                             "sqlite3 or mcap");
    }
    if (*packing != '\0' && strcmp(packing, "zstd") != 0) {
        snprintf(found, sizeof found, "the bag is compressed by \"%.32s\"", packing);
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "compression_format", found,
                             "zstd, or no compression");
    }
    return IMK_OK;
}

/* Does the list name this file of the folder, or the compressed one that it was made from? */
static bool is_listed(const imki_rosbag2 *bag, const char *name)
{
    for (size_t i = 0; i < bag->file_count; i++)
        if (strncmp(strrchr(bag->files[i], '/') + 1, name, strlen(name)) == 0)
            return true;
    return false;
}

/* Files of logs that are not in the list, as where a recording was not ended. */
static void look_for_others(imki_rosbag2 *bag, const char *folder)
{
    imk_log_reader *reader = bag->log.reader;
    DIR *entries = opendir(folder);
    const struct dirent *entry;
    while (entries && (entry = readdir(entries)) != NULL) {
        const char *name = entry->d_name;
        if ((!imk_has_ending(name, ".db3") && !imk_has_ending(name, ".mcap")) ||
            is_listed(bag, name))
            continue;
        /* The first by name, as the order of a folder is any. */
        if (reader->unlisted++ == 0 || strcmp(name, reader->unlisted_name) < 0)
            snprintf(reader->unlisted_name, sizeof reader->unlisted_name, "%s", name);
    }
    if (entries)
        closedir(entries);
}

imk_status imki_rosbag2_metadata(imki_rosbag2 *bag, const char *folder, const char *text,
                                 size_t size, imk_error *error)
{
    static const char head[] = "rosbag2_bagfile_information";
    imk_document *document;
    imk_status status = imki_document_parse_large("metadata", head, IMKI_ROSBAG2_METADATA, text,
                                                  size, &document, error);
    if (status != IMK_OK)
        return status;
    const int root = value_of(document, 0, head, IMKI_NODE_MAPPING);
    if (root == IMKI_NONE)
        status = imk_error_set(error, IMK_ERROR_FORMAT, head,
                               "the metadata of the bag have no such part",
                               "write them anew: ros2 bag reindex FOLDER");
    if (status == IMK_OK && folder)
        status = take_form(bag, document, root, error);
    if (status == IMK_OK && folder)
        status = take_files(bag, document, root, folder, error);
    if (status == IMK_OK && folder)
        look_for_others(bag, folder);
    /* In a file of several, the numbers are those of the whole bag. */
    const int files = value_of(document, root, "relative_file_paths", IMKI_NODE_SEQUENCE);
    const bool alone = !folder && files != IMKI_NONE && document->node[files].count > 1;
    if (status == IMK_OK && !alone)
        status = take_topics(bag, document, root, error);
    imk_document_free(document);
    return status;
}
