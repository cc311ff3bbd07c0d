/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of the reader of motion files. */
#ifndef IMUKI_MOTION_FILE_INTERNAL_H
#define IMUKI_MOTION_FILE_INTERNAL_H

#include "step_text_internal.h"

#include "imukit/motion_file.h"

enum {
    IMKI_MOTION_NAME_SIZE = 96,
    IMKI_MOTION_NOTE_SIZE = 256,
    IMKI_STEPS_MAX = 100000,   /* with repeats written out: at a step a second, a day */
    IMKI_VIBRATION_TERM = 64,  /* in stream numbers: beyond the noise terms, which count from 1 */
    IMKI_VIBRATION_LINES = 128 /* of a random vibration, when the file does not say */
};

struct imk_motion_file {
    imk_motion_kind kind;
    char name[IMKI_MOTION_NAME_SIZE];
    char note[IMKI_MOTION_NOTE_SIZE];
    char *text; /* of a script, from malloc; else NULL */
    double duration;
    imk_motion motion; /* points to one of the two below */
    imk_trajectory trajectory;
    imk_recorded_motion recorded;
    imk_trajectory_piece *piece;
    imk_vibration_line *line;
    imk_log log; /* owns the arrays of a recorded motion */
};

/* Steps as they are read: the state of the body is followed, so that "to 20 m/s" can become a
 * change of speed. */
typedef struct imki_script_reader {
    imki_reading reading;
    imk_motion_script script; /* step, step_count are set at the end */
    imk_motion_step *step;    /* from malloc */
    int *step_node;           /* where each stands */
    size_t step_count, capacity;
    size_t steps_read;            /* so far, each pass of a repeat anew */
    double speed, heading, climb; /* after the steps read so far */
} imki_script_reader;

/* step_read.c: one step, written in words. */
void imki_step_read(imki_script_reader *reader, int node);

/* vibration_lines.c: the entries of `vibration`, added to file->line. */
void imki_vibration_read(imki_reading *reading, int sequence, uint64_t seed, imk_motion_file *file);

/* motion_script_read.c: the script of a document, vibration left out. The caller frees reader->step
 * and reader->step_node, also after an error. */
imk_status imki_script_read(const imk_document *document, const imk_geodetic *place,
                            imki_script_reader *reader, imk_error *error);
/* The whole file. */
imk_status imki_motion_script_open(const imk_document *document, const imk_geodetic *place,
                                   uint64_t seed, imk_motion_file *file, imk_error *error);

/* motion_table.c: poses or recorded truth, whichever the columns of file->log are.
 * @param rate  where there is no column of times; 0: not stated */
imk_status imki_motion_table_take(double rate, const imk_geodetic *place, imk_motion_file *file,
                                  imk_error *error);

/* pose_columns.c: the trajectory of a table of poses. time: from 0, increasing. */
imk_status imki_poses_open(const imk_log *log, const double *time, const imk_geodetic *place,
                           imk_motion_file *file, imk_error *error);

/* True when the table has a column of positions or attitudes. */
bool imki_has_poses(const imk_log *log);

/* recorded_motion.c: takes the columns over from the log. */
imk_status imki_recorded_open(imk_log *log, double rate, imk_motion_file *file, imk_error *error);

/* table_column.c: check that a column has a unit of this dimension and no missing number. */
imk_status imki_table_column_check(const imk_log *log, size_t column, const char *si,
                                   imk_error *error);

/* An error about a row, which counts from 1: "<name>, row 17: <found>; …". */
imk_status imki_table_row_error(const char *name, imk_status status, size_t row, const char *found,
                                const char *expected, imk_error *error);

/* Where a trajectory goes when its place is not said: 45 deg north. */
static inline imk_geodetic imki_default_place(void)
{
    return (imk_geodetic){.latitude = 3.14159265358979323846 / 4.0};
}

#endif
