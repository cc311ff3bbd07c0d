/* SPDX-License-Identifier: Apache-2.0 */
/* Bags of ROS 2 as logs: the files of a folder one after the other, in the order in which its
 * metadata name them, or one database. */
#define _POSIX_C_SOURCE 200809L
#include "log_rosbag2_internal.h"
#include "log_rosbag2_write_internal.h"

#include "io/file/text_file_internal.h"

#include <stdio.h>
#include <stdlib.h>

enum { METADATA_MAX = IMKI_ROSBAG2_METADATA * (1 << 20) };

/* ---- one file ---- */

static void close_file(imki_rosbag2 *bag)
{
    if (!bag->open)
        return;
    imki_rosbag2_db_close(&bag->db);
    imki_mcap_stop(&bag->mcap);
    bag->mcap = (imki_mcap){.log = &bag->log};
    if (bag->files)
        imki_log_text_stop(&bag->part);
    bag->open = false;
}

static imk_status start_file(imki_rosbag2 *bag, imk_error *error)
{
    imk_status status;
    if (bag->of_mcap) {
        bag->log.channel_count = 0; /* each file numbers its topics anew */
        bag->log.last_known = false;
        return imki_mcap_start(&bag->mcap, error);
    }
    status = imki_rosbag2_db_open(bag, error);
    if (status == IMK_OK)
        status = imki_rosbag2_db_topics(bag, error);
    return status == IMK_OK ? imki_rosbag2_db_start(bag, 0.0, error) : status;
}

/* Open file `index`, at its beginning. */
static imk_status open_file(imki_rosbag2 *bag, size_t index, imk_error *error)
{
    imki_input *input;
    close_file(bag);
    bag->file = index;
    bag->db.copy = -1;
    bag->mcap.log = &bag->log;
    if (bag->files) {
        imk_status status = imki_input_open(bag->files[index], &input, error);
        if (status == IMK_OK)
            status = imki_log_text_start(&bag->part, input, error);
        if (status != IMK_OK)
            return status;
    }
    bag->open = true;
    return start_file(bag, error);
}

/* ---- messages ---- */

static imk_status next(imki_ros_log *log, imki_ros_message *message, bool *found, imk_error *error)
{
    imki_rosbag2 *bag = (imki_rosbag2 *)log;
    for (;;) {
        imk_status status = bag->of_mcap ? imki_mcap_next(&bag->mcap, message, found, error)
                                         : imki_rosbag2_db_next(bag, message, found, error);
        /* A look at the beginning that has found the sensor goes no farther. */
        if (status != IMK_OK || *found || bag->file + 1 >= bag->file_count ||
            (log->looking && log->held))
            return status;
        status = open_file(bag, bag->file + 1, error);
        if (status != IMK_OK)
            return status;
    }
}

static imk_status back(imki_ros_log *log, imk_error *error)
{
    imki_rosbag2 *bag = (imki_rosbag2 *)log;
    log->reader->cut_short = false;
    log->reader->damaged = log->reader->first_damaged = 0;
    return bag->files ? open_file(bag, 0, error) : imki_rosbag2_db_start(bag, 0.0, error);
}

/* ---- the codec ---- */

static imk_status open_folder(imki_rosbag2 *bag, const char *folder, imk_error *error)
{
    char *text = NULL, *path;
    size_t size = strlen(folder);
    while (size > 1 && folder[size - 1] == '/')
        size--;
    char *name = strndup(folder, size);
    path = malloc(size + sizeof "/metadata.yaml");
    imk_status status =
        name && path ? IMK_OK : imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    if (status == IMK_OK) {
        snprintf(path, size + sizeof "/metadata.yaml", "%s/metadata.yaml", name);
        status = imki_text_file_read(path, METADATA_MAX, &text, &size, error);
        if (status == IMK_ERROR_OPEN)
            imk_error_set(error, status, folder, "this is a folder, without a metadata.yaml",
                          "give a file, or the folder of a bag of ROS 2 (ros2 bag reindex FOLDER "
                          "writes that file)");
    }
    if (status == IMK_OK)
        status = imki_rosbag2_metadata(bag, name, text, size, error);
    free(text);
    free(path);
    free(name);
    return status == IMK_OK ? open_file(bag, 0, error) : status;
}

/* A database alone. Its metadata, if it has some, know the numbers of messages. */
static imk_status open_database(imki_rosbag2 *bag, imk_error *error)
{
    imk_status status = open_file(bag, 0, error);
    if (status != IMK_OK)
        return status;
    bag->log.indexed = true;
    char *text = imki_rosbag2_db_metadata(&bag->db);
    if (text && imki_rosbag2_metadata(bag, NULL, text, strlen(text), NULL) == IMK_ERROR_MEMORY)
        status = imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    free(text);
    bag->log.reader->unclosed = bag->db.bytes.ahead && !bag->log.counted;
    return status;
}

static imk_status open_rosbag2(imk_log_reader *reader, imk_error *error)
{
    static const imki_ros_container container = {next, back, imki_mcap_shape};
    imki_rosbag2 *bag = calloc(1, sizeof *bag);
    reader->state = bag;
    if (!bag)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    bag->log = (imki_ros_log){.container = &container, .reader = reader, .text = &reader->text};
    bag->mcap.log = &bag->log;
    bag->db.copy = -1;
    imk_status status;
    if (!reader->text.input) {
        bag->log.text = &bag->part;
        bag->log.apart = true;
        status = open_folder(bag, reader->path, error);
    } else {
        status = open_database(bag, error);
    }
    return status == IMK_OK ? imki_ros_open(&bag->log, error) : status;
}

static imk_status seek(imk_log_reader *reader, double fraction, imk_error *error)
{
    imki_rosbag2 *bag = (imki_rosbag2 *)imki_ros_log_of(reader);
    double within = fraction;
    imk_status status = IMK_OK;
    if (bag->files) {
        const double place = fraction * (double)bag->file_count;
        size_t index = (size_t)place;
        index = index < bag->file_count ? index : bag->file_count - 1;
        within = place - (double)index;
        status = open_file(bag, index, error);
    }
    bag->log.moved = true;
    if (status != IMK_OK || !bag->of_mcap)
        return status == IMK_OK ? imki_rosbag2_db_start(bag, within, error) : status;
    bool intact;
    if (imki_ros_can_seek(&bag->log))
        status = imki_mcap_summary_read(&bag->mcap, &intact, error);
    return status == IMK_OK ? imki_mcap_go(&bag->mcap, within, error) : status;
}

static void progress(const imk_log_reader *reader, uint64_t *done, uint64_t *size)
{
    enum { PARTS = 10000 };
    const imki_rosbag2 *bag = reader->state;
    double part = 0.0;
    uint64_t at = 0, all = 0;
    if (bag->of_mcap && bag->open) {
        at = imki_log_text_place(&bag->part);
        all = imki_ros_can_seek(&bag->log) ? imki_ros_size(&bag->log) : 0;
        part = all > 0 ? (double)at / (double)all : 0.0;
    } else if (bag->db.last > bag->db.first) {
        part = ((double)bag->db.at - (double)bag->db.first) /
               ((double)bag->db.last - (double)bag->db.first);
    }
    part = part < 0.0 ? 0.0 : part > 1.0 ? 1.0 : part;
    *size = (uint64_t)(bag->files ? bag->file_count : 1) * PARTS;
    *done = (uint64_t)bag->file * PARTS + (uint64_t)(part * PARTS);
}

static void close_rosbag2(imk_log_reader *reader)
{
    imki_rosbag2 *bag = reader->state;
    if (!bag)
        return;
    close_file(bag);
    imki_rosbag2_db_close(&bag->db);
    imki_log_text_stop(&bag->part);
    for (size_t i = 0; i < bag->file_count; i++)
        free(bag->files[i]);
    free(bag->files);
    imki_ros_close(&bag->log);
}

const imki_log_codec imki_log_rosbag2 = {.folders = true,
                                         .defines_units = true,
                                         .open = open_rosbag2,
                                         .read = imki_ros_read,
                                         .close = close_rosbag2,
                                         .seek = seek,
                                         .progress = progress,
                                         .create = imki_rosbag2_create,
                                         .format = imki_log_format_matrix,
                                         .write = imki_rosbag2_write,
                                         .end = imki_rosbag2_end,
                                         .discard = imki_rosbag2_discard};
