/* SPDX-License-Identifier: Apache-2.0 */
/* Bags of ROS 2: a folder of SQLite databases or MCAP files with a metadata.yaml, or a database
 * alone [ROSBAG2]. */
#ifndef IMUKIT_LOG_ROSBAG2_INTERNAL_H
#define IMUKIT_LOG_ROSBAG2_INTERNAL_H

#include "log_mcap_internal.h"
#include "log_sqlite_internal.h"

/* Times the limits of other documents: each of some thousand topics may have forty values. */
enum { IMKI_ROSBAG2_METADATA = 8 };

/* The database that is being read. */
typedef struct imki_rosbag2_db {
    imki_sqlite_bytes bytes;
    sqlite3 *handle;
    sqlite3_stmt *query;
    bool by_time;        /* in the order of times, by the index; else in that of recording */
    bool begun, over;    /* a message was read; there are no more */
    int64_t first, last; /* times, or numbers, of the first and last message */
    int64_t at;
    int copy; /* a temporary file; -1: none */
} imki_rosbag2_db;

typedef struct imki_rosbag2 {
    imki_ros_log log;
    imki_mcap mcap;
    imki_rosbag2_db db;
    imki_log_text part; /* of the file that is being read */
    char **files;       /* of a folder; NULL: the text of the reader */
    size_t file_count, file;
    bool of_mcap, open;
} imki_rosbag2;

/* ---- log_rosbag2_metadata.c ------------------------------------------------------------------ */

/* Read the file or table of metadata: topics with their numbers of messages, files.
 * @param folder  of the files; NULL: only topics are taken */
imk_status imki_rosbag2_metadata(imki_rosbag2 *bag, const char *folder, const char *text,
                                 size_t size, imk_error *error);

/* ---- log_rosbag2_db.c ------------------------------------------------------------------------ */

/* Open the database that bag->log.text gives. */
imk_status imki_rosbag2_db_open(imki_rosbag2 *bag, imk_error *error);
/* The channels of its table of topics. */
imk_status imki_rosbag2_db_topics(imki_rosbag2 *bag, imk_error *error);
/* The text of its table of metadata, from malloc(); NULL: there is none. */
char *imki_rosbag2_db_metadata(const imki_rosbag2_db *db);
/* Read on from a fraction of the database, 0 … 1. */
imk_status imki_rosbag2_db_start(imki_rosbag2 *bag, double fraction, imk_error *error);
imk_status imki_rosbag2_db_next(imki_rosbag2 *bag, imki_ros_message *message, bool *found,
                                imk_error *error);
void imki_rosbag2_db_close(imki_rosbag2_db *db);

/* By the name of a type and of a serialisation. */
imki_ros_encoding imki_rosbag2_encoding(imki_log_piece type, imki_log_piece serialisation);

#endif
