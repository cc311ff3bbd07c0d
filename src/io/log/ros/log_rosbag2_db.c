/* SPDX-License-Identifier: Apache-2.0 */
/* The database of a bag of ROS 2 [ROSBAG2]: tables
 *
 *     topics    id, name, type, serialization_format, …
 *     messages  id, topic_id, timestamp [ns], data
 *     metadata  metadata (the text of metadata.yaml), in newer ones
 *
 * and an index, timestamp_idx. Messages are read in the order of their times by that index; without
 * it, or where the file is cut short, in that of recording, so that nothing is to be sorted. */
#define _POSIX_C_SOURCE 200809L
#include "log_rosbag2_internal.h"

#include "io/file/input_copy_internal.h"
#include "io/file/nameless_file_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

/* With the topics to be read: of the others not even the data are fetched. */
static const char by_time[] =
    "SELECT topic_id, timestamp, data FROM messages INDEXED BY timestamp_idx WHERE timestamp >= ?1 "
    "%s ORDER BY timestamp";
static const char by_number[] =
    "SELECT topic_id, timestamp, data, rowid FROM messages WHERE rowid >= ?1 %s ORDER BY rowid";
static const char *const ends[2][2] = {
    {"SELECT rowid FROM messages ORDER BY rowid LIMIT 1",
     "SELECT rowid FROM messages ORDER BY rowid DESC LIMIT 1"},
    {"SELECT timestamp FROM messages INDEXED BY timestamp_idx ORDER BY timestamp LIMIT 1",
     "SELECT timestamp FROM messages INDEXED BY timestamp_idx ORDER BY timestamp DESC LIMIT 1"}};

/* A piece of text that is valid until the next step. */
static imki_log_piece text_at(sqlite3_stmt *query, int column)
{
    const char *text = (const char *)sqlite3_column_text(query, column);
    return text ? (imki_log_piece){text, text + sqlite3_column_bytes(query, column)}
                : (imki_log_piece){"", ""};
}

static bool is_cut(const imki_rosbag2_db *db)
{
    return db->bytes.claimed > db->bytes.size;
}

static imk_status refuse(const imki_rosbag2_db *db, imk_error *error)
{
    const imk_status status = imki_sqlite_refuse(db->handle, &db->bytes, error);
    if (status != IMK_ERROR_FORMAT || !is_cut(db))
        return status;
    char found[128];
    snprintf(found, sizeof found, "the bag is cut short: %llu of its %llu bytes are there",
             (unsigned long long)db->bytes.size, (unsigned long long)db->bytes.claimed);
    return imk_error_set(error, status, "", found, "copy the file again");
}

/* The only number that a query gives; *found is false if it gives none, or cannot be asked of this
 * database. @return IMK_ERROR_MEMORY, IMK_ERROR_READ */
static imk_status ask(imki_rosbag2_db *db, const char *text, bool *found, int64_t *number,
                      imk_error *error)
{
    sqlite3_stmt *query = NULL;
    int result = sqlite3_prepare_v2(db->handle, text, -1, &query, NULL);
    if (result == SQLITE_OK)
        result = sqlite3_step(query);
    *found = result == SQLITE_ROW && sqlite3_column_type(query, 0) == SQLITE_INTEGER;
    if (*found)
        *number = sqlite3_column_int64(query, 0);
    const bool failed = result != SQLITE_ROW && result != SQLITE_DONE &&
                        imki_sqlite_is_system(db->handle, &db->bytes);
    const imk_status status = failed ? refuse(db, error) : IMK_OK;
    sqlite3_finalize(query);
    return status;
}

/* First and last time, or number. */
static imk_status find_ends(imki_rosbag2_db *db, imk_error *error)
{
    bool found[2] = {false, false};
    imk_status status = IMK_OK;
    db->by_time = !is_cut(db);
    for (int pass = 0; pass < 2 && status == IMK_OK && !found[1]; pass++) {
        db->by_time = db->by_time && pass == 0;
        status = ask(db, ends[db->by_time][0], &found[0], &db->first, error);
        db->last = db->first;
        if (status == IMK_OK && found[0])
            status = ask(db, ends[db->by_time][1], &found[1], &db->last, error);
    }
    return status;
}

/* ---- opening ---- */

/* The whole text, decompressed. */
static imk_status copy_text(imki_rosbag2_db *db, imki_log_text *text, imk_error *error)
{
    size_t at_hand = 1;
    db->copy = imki_open_nameless();
    imk_status status = imki_nameless_write(db->copy, "", 0, "", error);
    while (status == IMK_OK && at_hand > 0) {
        status = imki_log_text_need(text, 1, error);
        at_hand = status == IMK_OK ? (size_t)(text->end - text->next) : 0;
        if (at_hand > 0)
            status = imki_nameless_write(db->copy, text->next, at_hand, "", error);
        text->next += at_hand;
        db->bytes.size += at_hand;
    }
    db->bytes.file = db->copy;
    return status;
}

/* What is not a plain file is copied to one. */
static imk_status find_bytes(imki_rosbag2 *bag, imk_error *error)
{
    imki_rosbag2_db *db = &bag->db;
    imki_log_text *text = bag->log.text;
    db->bytes = (imki_sqlite_bytes){.file = -1};
    if (!text->buffer) {
        db->bytes.memory = text->base;
        db->bytes.size = (uint64_t)(text->end - text->base);
        return IMK_OK;
    }
    db->bytes.file = imki_input_file(text->input);
    if (db->bytes.file >= 0) {
        uint64_t done;
        imki_input_progress(text->input, &done, &db->bytes.size);
        return IMK_OK;
    }
    return copy_text(db, text, error);
}

/* A program that records keeps the newest messages in a second file. */
static imk_status check_closed(const char *path, imk_error *error)
{
    static const char *const others[] = {"-wal", "-journal"};
    for (size_t i = 0; i < sizeof others / sizeof others[0] && path; i++) {
        char name[4096], found[160];
        const int length = snprintf(name, sizeof name, "%s%s", path, others[i]);
        struct stat about;
        if (length < 0 || (size_t)length >= sizeof name || stat(name, &about) != 0 ||
            about.st_size == 0)
            continue;
        snprintf(found, sizeof found,
                 "the bag is being recorded, or was not closed: there is a file of this name "
                 "with %s behind it",
                 others[i]);
        return imk_error_set(error, IMK_ERROR_OPEN, path, found,
                             "end the recording, or close it: sqlite3 FILE.db3 'SELECT "
                             "count(*) FROM topics'");
    }
    return IMK_OK;
}

static imk_status refuse_tables(const imki_rosbag2_db *db, imk_error *error)
{
    return imk_error_set(error, IMK_ERROR_FORMAT, "",
                         "the SQLite database has no tables \"topics\" and \"messages\"",
                         db->bytes.ahead ? "it was copied before it was closed: copy the file with "
                                           "-wal behind its name, too, and close it: sqlite3 "
                                           "FILE.db3 'SELECT count(*) FROM topics'"
                                         : "a bag of ROS 2");
}

imk_status imki_rosbag2_db_open(imki_rosbag2 *bag, imk_error *error)
{
    imki_rosbag2_db *db = &bag->db;
    *db = (imki_rosbag2_db){.copy = -1};
    imk_status status =
        check_closed(bag->files ? bag->files[bag->file] : bag->log.reader->path, error);
    if (status == IMK_OK)
        status = find_bytes(bag, error);
    if (status == IMK_OK)
        status = imki_sqlite_open(&db->bytes, &db->handle, error);
    if (status != IMK_OK)
        return status;
    if (!imki_sqlite_has_table(db->handle, "messages") ||
        !imki_sqlite_has_table(db->handle, "topics"))
        return sqlite3_errcode(db->handle) == SQLITE_OK ||
                       sqlite3_errcode(db->handle) == SQLITE_DONE
                   ? refuse_tables(db, error)
                   : refuse(db, error);
    return find_ends(db, error);
}

imk_status imki_rosbag2_db_topics(imki_rosbag2 *bag, imk_error *error)
{
    sqlite3 *handle = bag->db.handle;
    sqlite3_stmt *query = NULL;
    imk_status status = IMK_OK;
    bag->log.channel_count = 0; /* each file numbers its topics anew */
    bag->log.last_known = false;
    int result = sqlite3_prepare_v2(
        handle, "SELECT id, name, type, serialization_format FROM topics", -1, &query, NULL);
    while (result == SQLITE_OK && status == IMK_OK) {
        result = sqlite3_step(query);
        if (result != SQLITE_ROW)
            break;
        result = SQLITE_OK;
        const int64_t id = sqlite3_column_int64(query, 0);
        const imki_log_piece name = text_at(query, 1), type = text_at(query, 2);
        const imki_log_piece form = text_at(query, 3);
        uint32_t topic;
        if (id >= 0 && id <= UINT32_MAX)
            status = imki_ros_channel_add(&bag->log, (uint32_t)id, name, type,
                                          imki_rosbag2_encoding(type, form), &topic, error);
        if (id >= 0 && id <= UINT32_MAX && status == IMK_OK)
            imki_ros_topic_form(&bag->log, topic, form);
    }
    if (status == IMK_OK && result != SQLITE_DONE)
        status = refuse(&bag->db, error);
    sqlite3_finalize(query);
    return status;
}

char *imki_rosbag2_db_metadata(const imki_rosbag2_db *db)
{
    sqlite3_stmt *query = NULL;
    char *text = NULL;
    if (imki_sqlite_has_table(db->handle, "metadata") &&
        sqlite3_prepare_v2(db->handle, "SELECT metadata FROM metadata ORDER BY rowid DESC LIMIT 1",
                           -1, &query, NULL) == SQLITE_OK &&
        sqlite3_step(query) == SQLITE_ROW) {
        const char *stored = (const char *)sqlite3_column_text(query, 0);
        text = stored ? strdup(stored) : NULL;
    }
    sqlite3_finalize(query);
    return text;
}

/* ---- reading ---- */

/* "AND topic_id IN (2, 5)" with the topics that can be read; "" if they are too many to be listed.
 */
static void list_topics(const imki_rosbag2 *bag, size_t size, char *text)
{
    const imki_ros_log *log = &bag->log;
    size_t used = (size_t)snprintf(text, size, "AND topic_id IN (");
    bool any = false;
    for (size_t i = 0; i < log->channel_count; i++) {
        if (log->topics[log->channels[i].topic].encoding == IMKI_ROS_OTHER)
            continue;
        if (size - used < 16) {
            text[0] = '\0';
            return;
        }
        used += (size_t)snprintf(text + used, size - used, "%s%u", any ? ", " : "",
                                 (unsigned)log->channels[i].id);
        any = true;
    }
    snprintf(text + used, size - used, ")");
}

imk_status imki_rosbag2_db_start(imki_rosbag2 *bag, double fraction, imk_error *error)
{
    imki_rosbag2_db *db = &bag->db;
    sqlite3_finalize(db->query);
    db->query = NULL;
    db->begun = db->over = false;
    db->bytes.steps = 0;
    char chosen[512], text[sizeof by_time + sizeof by_number + sizeof chosen];
    list_topics(bag, sizeof chosen, chosen);
    snprintf(text, sizeof text, db->by_time ? by_time : by_number, chosen);
    if (sqlite3_prepare_v2(db->handle, text, -1, &db->query, NULL) != SQLITE_OK)
        return refuse(db, error);
    const double length = (double)db->last - (double)db->first;
    int64_t from = INT64_MIN;
    if (fraction > 0.0 && length > 0.0 && length < 9e18) {
        const int64_t all = db->last - db->first, step = (int64_t)(fraction * (double)all);
        from = db->first + (step < all ? step : all);
    }
    sqlite3_bind_int64(db->query, 1, from);
    db->at = db->first;
    return IMK_OK;
}

imk_status imki_rosbag2_db_next(imki_rosbag2 *bag, imki_ros_message *message, bool *found,
                                imk_error *error)
{
    imki_rosbag2_db *db = &bag->db;
    imki_ros_log *log = &bag->log;
    *found = false;
    while (!db->over) {
        const int result = sqlite3_step(db->query);
        if (result != SQLITE_ROW) {
            db->over = true; /* another step would begin anew */
            if (result != SQLITE_DONE &&
                (!db->begun || imki_sqlite_is_system(db->handle, &db->bytes)))
                return refuse(db, error);
            log->reader->cut_short |= result != SQLITE_DONE || is_cut(db);
            break;
        }
        db->begun = true;
        const int64_t id = sqlite3_column_int64(db->query, 0);
        message->channel = (uint32_t)id;
        message->received = sqlite3_column_int64(db->query, 1);
        db->at = db->by_time ? message->received : sqlite3_column_int64(db->query, 3);
        const imki_ros_topic *topic =
            id >= 0 && id <= UINT32_MAX ? imki_ros_topic_of(log, message->channel) : NULL;
        if (!topic || topic->encoding == IMKI_ROS_OTHER)
            continue;
        message->data = sqlite3_column_blob(db->query, 2);
        message->size = message->data ? (size_t)sqlite3_column_bytes(db->query, 2) : 0;
        *found = true;
        break;
    }
    return IMK_OK;
}

void imki_rosbag2_db_close(imki_rosbag2_db *db)
{
    sqlite3_finalize(db->query);
    sqlite3_close(db->handle);
    if (db->copy >= 0)
        close(db->copy);
    *db = (imki_rosbag2_db){.copy = -1};
}
