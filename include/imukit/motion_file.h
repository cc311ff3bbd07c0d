/* SPDX-License-Identifier: Apache-2.0 */
/** @file motion_file.h
 *  Motion and temperature from files: scripts in YAML, tables of poses, and truth recorded by
 *  another program. Formats: docs/motion-file.md. */
#ifndef IMUKIT_MOTION_FILE_H
#define IMUKIT_MOTION_FILE_H

#include "imukit/log.h"
#include "imukit/motion_script.h"

IMK_BEGIN_C

/** The content of a motion file. It owns everything that its motion points to. */
typedef struct imk_motion_file imk_motion_file;

typedef enum imk_motion_kind {
    IMK_MOTION_SCRIPT,  /**< YAML */
    IMK_MOTION_POSES,   /**< a table with positions and attitudes */
    IMK_MOTION_RECORDED /**< a table with rates and forces */
} imk_motion_kind;

/** Read a motion file: a script when the name ends in .yaml, .yml or .json or the content begins as
 *  one, else a log with columns
 *
 *  - time, latitude, longitude, height (or x, y, z: local north-east-down [m] with the place given
 *    in `place`; or ecef_x …), and roll, pitch, yaw or q_w, q_x, q_y, q_z (q_nb): poses. Without
 *    positions the body stays at the place, without attitudes it is level and heads north; other
 *    columns are ignored, as imk_motion_file_note() tells;
 *  - gyro_x … accel_z (any names imk_log_open() knows): true rates and forces, in equal steps.
 *
 *  Time 0 of the motion is the first row of a table, whatever its time column says.
 *
 *  @param settings  how to read a table; NULL: from its header
 *  @param place     of local coordinates and default of a script; NULL: 45 deg north, 0 deg east
 *  @param seed      of random vibration
 *  @return errors of the readers with line and column; of tables with the row in error.field */
IMK_API imk_status imk_motion_read(const char *path, const imk_log_settings *settings,
                                   const imk_geodetic *place, uint64_t seed, imk_motion_file **file,
                                   imk_error *error);
/** As imk_motion_read(), for a script in memory. */
IMK_API imk_status imk_motion_parse(const char *text, size_t size, const imk_geodetic *place,
                                    uint64_t seed, imk_motion_file **file, imk_error *error);
/** As imk_motion_read(), for a table whose rows come from a source: arrays of poses, or of rates
 * and forces, in the columns named there. */
IMK_API imk_status imk_motion_of_record(const imk_record_source *source, const imk_geodetic *place,
                                        imk_motion_file **file, imk_error *error);
/** Free a file and everything its motion points to; NULL is allowed. */
IMK_API void imk_motion_file_free(imk_motion_file *file);

/** Kind of the file. */
IMK_API imk_motion_kind imk_motion_file_kind(const imk_motion_file *file);
/** Motion for the simulator; valid until the file is freed. */
IMK_API const imk_motion *imk_motion_file_motion(const imk_motion_file *file);
/** Length of the motion [s]: end of the script or table; infinite for a script that ends at rest
 *  with `then: hold`. */
IMK_API double imk_motion_file_duration(const imk_motion_file *file);
/** Name of a script ("" when it has none). */
IMK_API const char *imk_motion_file_name(const imk_motion_file *file);

/** Text of a script as it was read; NULL for a table. */
IMK_API const char *imk_motion_file_text(const imk_motion_file *file);

/** A note about assumptions for missing columns, and about columns not used; "" if there is none.
 */
IMK_API const char *imk_motion_file_note(const imk_motion_file *file);

/** A temperature profile. */
typedef struct imk_temperature_file imk_temperature_file;
/** Read a temperature profile: a YAML script of the steps start, ramp, soak, step; a log with the
 *  columns time (0 is its first row) and temperature; or, if `path` is a quantity such as "25degC"
 *  and not a file, a constant. @return errors of the readers with line and column, of tables with
 *  the row */
IMK_API imk_status imk_temperature_read(const char *path, imk_temperature_file **file,
                                        imk_error *error);
/** As imk_temperature_read(), for a table whose rows come from a source with the columns time and
 *  temperature. */
IMK_API imk_status imk_temperature_of_record(const imk_record_source *source,
                                             imk_temperature_file **file, imk_error *error);
/** Free a file and its profile; NULL is allowed. */
IMK_API void imk_temperature_file_free(imk_temperature_file *file);
/** Profile for imk_temperature_at(); valid until the file is freed. */
IMK_API const imk_temperature_profile *
imk_temperature_file_profile(const imk_temperature_file *file);

IMK_END_C
#endif
