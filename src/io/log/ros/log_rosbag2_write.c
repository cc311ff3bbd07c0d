/* SPDX-License-Identifier: Apache-2.0 */
/* Databases of bags of ROS 2, as Humble writes them: version 3 of the tables, with the metadata in
 * one of them, because a second file of the fixed name metadata.yaml would belong to whatever bag
 * was in the folder before. SQLite writes to the temporary file itself. */
#define _POSIX_C_SOURCE 200809L
#include "log_rosbag2_write_internal.h"

#include "io/file/output_file_internal.h"

#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct db_writer {
    imki_ros_writer writer;
    sqlite3 *handle;
    sqlite3_stmt *insert;
    char *path;
} db_writer;

/* The file is not shown before it is complete, and is synced then: no journal is needed. */
static const char begin[] =
    "PRAGMA journal_mode=OFF; PRAGMA synchronous=OFF; PRAGMA locking_mode=EXCLUSIVE;"
    "BEGIN;"
    "CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);"
    "CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, "
    "metadata TEXT NOT NULL);"
    "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
    "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
    "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, "
    "timestamp INTEGER NOT NULL, data BLOB NOT NULL);"
    "CREATE INDEX timestamp_idx ON messages (timestamp ASC);"
    "INSERT INTO schema VALUES(3, 'humble');"
    "INSERT INTO topics VALUES(1, '" IMKI_ROS_TOPIC "', 'sensor_msgs/msg/Imu', 'cdr', '');";
static const char insert[] = "INSERT INTO messages(topic_id, timestamp, data) VALUES(1, ?1, ?2)";
static const char finish[] = "INSERT INTO metadata(metadata_version, metadata) VALUES(5, ?1)";

static imk_status refuse(const db_writer *db, imk_error *error)
{
    char found[128];
    if (!db->handle || sqlite3_errcode(db->handle) == SQLITE_NOMEM)
        return imk_error_set(error, IMK_ERROR_MEMORY, db->path, "", "");
    snprintf(found, sizeof found, "SQLite cannot write it: %s", sqlite3_errmsg(db->handle));
    return imk_error_set(error, IMK_ERROR_WRITE, db->path, found, "");
}

imk_status imki_rosbag2_create(imki_log_output *log, const char *path, imk_error *error)
{
    db_writer *db = calloc(1, sizeof *db);
    log->state = db;
    if (!db || !(db->path = strdup(path)))
        return imk_error_set(error, IMK_ERROR_MEMORY, path, "", "");
    if (!imki_output_file_can_replace(log->file))
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, path,
                             "a .db3 cannot be compressed or go to a pipe",
                             "write a plain .db3 file, or a .mcap");
    const imk_status status = imki_ros_writer_start(&db->writer, log, path, error);
    if (status != IMK_OK)
        return status;
    const char *name = imki_output_file_temporary(log->file);
    if (sqlite3_open_v2(name, &db->handle, SQLITE_OPEN_READWRITE, NULL) != SQLITE_OK ||
        sqlite3_exec(db->handle, begin, NULL, NULL, NULL) != SQLITE_OK ||
        sqlite3_prepare_v2(db->handle, insert, -1, &db->insert, NULL) != SQLITE_OK)
        return refuse(db, error);
    return IMK_OK;
}

imk_status imki_rosbag2_write(imki_log_output *log, const char *bytes, size_t size, size_t rows)
{
    db_writer *db = log->state;
    const size_t row_size = size / rows;
    for (size_t i = 0; i < rows; i++) {
        uint8_t data[IMKI_ROS_IMU_MAX];
        imki_imu imu;
        if (!imki_ros_writer_take(&db->writer, log->origin, bytes + i * row_size, &imu))
            return IMK_ERROR_RANGE;
        const size_t length = imki_ros_imu_write(IMKI_ROS_CDR, &imu, 0, data);
        sqlite3_bind_int64(db->insert, 1, imu.stamp);
        sqlite3_bind_blob(db->insert, 2, data, (int)length, SQLITE_STATIC);
        const int result = sqlite3_step(db->insert);
        if (result != SQLITE_DONE) /* imki_rosbag2_end() tells what it was */
            return result == SQLITE_NOMEM ? IMK_ERROR_MEMORY : IMK_ERROR_WRITE;
        sqlite3_reset(db->insert);
    }
    return IMK_OK;
}

/* The text of a metadata.yaml, from malloc(). */
static char *metadata_text(const db_writer *db)
{
    enum { SIZE = 2048 };
    const imki_ros_writer *writer = &db->writer;
    const char *slash = strrchr(db->path, '/'), *name = slash ? slash + 1 : db->path;
    const unsigned long long messages = writer->rows;
    char *text = malloc(SIZE);
    if (text)
        snprintf(text, SIZE,
                 "rosbag2_bagfile_information:\n"
                 "  version: 5\n"
                 "  storage_identifier: sqlite3\n"
                 "  duration:\n"
                 "    nanoseconds: %lld\n"
                 "  starting_time:\n"
                 "    nanoseconds_since_epoch: %lld\n"
                 "  message_count: %llu\n"
                 "  topics_with_message_count:\n"
                 "    - topic_metadata:\n"
                 "        name: " IMKI_ROS_TOPIC "\n"
                 "        type: sensor_msgs/msg/Imu\n"
                 "        serialization_format: cdr\n"
                 "        offered_qos_profiles: \"\"\n"
                 "      message_count: %llu\n"
                 "  compression_format: \"\"\n"
                 "  compression_mode: \"\"\n"
                 "  relative_file_paths:\n"
                 "    - \"%.255s\"\n",
                 (long long)(writer->last - writer->first), (long long)writer->first, messages,
                 messages, strpbrk(name, "\"\\") ? "" : name);
    return text;
}

imk_status imki_rosbag2_end(imki_log_output *log, imk_error *error)
{
    db_writer *db = log->state;
    sqlite3_stmt *last = NULL;
    imk_status status = imki_ros_writer_check(&db->writer, error);
    if (status != IMK_OK)
        return status;
    if (db->writer.rows < log->written) /* a row before failed */
        return refuse(db, error);
    char *text = metadata_text(db);
    const bool good = text &&
                      sqlite3_prepare_v2(db->handle, finish, -1, &last, NULL) == SQLITE_OK &&
                      sqlite3_bind_text(last, 1, text, -1, SQLITE_STATIC) == SQLITE_OK &&
                      sqlite3_step(last) == SQLITE_DONE;
    sqlite3_finalize(last);
    sqlite3_finalize(db->insert);
    db->insert = NULL;
    if (!good || sqlite3_exec(db->handle, "COMMIT", NULL, NULL, NULL) != SQLITE_OK)
        status = text ? refuse(db, error) : imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    free(text);
    if (status == IMK_OK && sqlite3_close(db->handle) != SQLITE_OK)
        status = refuse(db, error);
    else if (status == IMK_OK)
        db->handle = NULL;
    return status;
}

void imki_rosbag2_discard(imki_log_output *log)
{
    db_writer *db = log->state;
    if (!db)
        return;
    sqlite3_finalize(db->insert);
    sqlite3_close(db->handle);
    free(db->path);
    free(db);
}
