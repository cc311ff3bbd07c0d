/* SPDX-License-Identifier: Apache-2.0 */
/** @file motion_file.h
 *  Motion and temperature from files: scripts in YAML, tables of poses, and truth recorded by
 *  another program. Formats: docs/motion-file.md. */
#ifndef IMUKIT_MOTION_FILE_H
#define IMUKIT_MOTION_FILE_H

#include "imukit/log.h"
#include "imukit/motion_script.h"

IMK_BEGIN_C

/** What a file holds. Owns everything its motion points to. */
typedef struct imk_motion_file imk_motion_file;

typedef enum imk_motion_kind {
    IMK_MOTION_SCRIPT,  /**< YAML */
    IMK_MOTION_POSES,   /**< a table with positions and attitudes */
    IMK_MOTION_RECORDED /**< a table with rates and forces */
} imk_motion_kind;

/** Read a motion file: a script when the name ends in .yaml, .yml or .json or the content begins as
 *  one, else a log with columns
 *
 *   - time, latitude, longitude, height (or x, y, z: local north-east-down [m] with the place given
 *     in `place`; or ecef_x …), and roll, pitch, yaw or q_w, q_x, q_y, q_z (q_nb): poses. Without
 *     positions the body stays at the place, without attitudes it is level and heads north; other
 *     columns are ignored: imk_motion_file_note() says so;
 *   - gyro_x … accel_z (any names imk_log_open() knows): true rates and forces, in equal steps.
 *
 *  Time 0 of the motion is the first row of a table, which its column of time need not call 0.
 *
 *  @param settings  how to read a table; NULL: from its header
 *  @param place     of local coordinates and default of a script; NULL: 45 deg north, 0 deg east
 *  @param seed      of random vibration
 *  @return errors of the readers with line and column; of tables with the row in error.field */
IMK_API imk_status imk_motion_read(const char *path, const imk_log_settings *settings,
                                   const imk_geodetic *place, uint64_t seed, imk_motion_file **file,
                                   imk_error *error);
/** A script from memory. */
IMK_API imk_status imk_motion_parse(const char *text, size_t size, const imk_geodetic *place,
                                    uint64_t seed, imk_motion_file **file, imk_error *error);
/** Free a file and everything its motion points to; NULL is allowed. */
IMK_API void imk_motion_file_free(imk_motion_file *file);

/** What the file turned out to be. */
IMK_API imk_motion_kind imk_motion_file_kind(const imk_motion_file *file);
/** What the simulator takes; lives as long as the file. */
IMK_API const imk_motion *imk_motion_file_motion(const imk_motion_file *file);
/** Length [s]; infinite when it ends at rest and is a script that says `then: hold`; else where the
 *  script or table ends. */
IMK_API double imk_motion_file_duration(const imk_motion_file *file);
/** Name of a script ("" when it has none). */
IMK_API const char *imk_motion_file_name(const imk_motion_file *file);

/** Text of a script as it was read; NULL of a table. */
IMK_API const char *imk_motion_file_text(const imk_motion_file *file);

/** What was assumed for columns that are missing, and that columns were not used; "" when nothing
 *  was. */
IMK_API const char *imk_motion_file_note(const imk_motion_file *file);

/** A temperature profile. */
typedef struct imk_temperature_file imk_temperature_file;
/** Read one: a YAML script of the steps start, ramp, soak, step; a log with the columns time (0 is
 *  its first row) and temperature; or, when `path` is a quantity such as "25degC" and no file, a
 *  constant. @return errors of the readers with line and column, of tables with the row */
IMK_API imk_status imk_temperature_read(const char *path, imk_temperature_file **file,
                                        imk_error *error);
/** Free a file and its profile; NULL is allowed. */
IMK_API void imk_temperature_file_free(imk_temperature_file *file);
/** What imk_temperature_at() takes; lives as long as the file. */
IMK_API const imk_temperature_profile *
imk_temperature_file_profile(const imk_temperature_file *file);

IMK_END_C
#endif
