/* SPDX-License-Identifier: Apache-2.0 */
/* From a header to columns: the cells in between. */
#ifndef IMUKIT_LOG_COLUMNS_INTERNAL_H
#define IMUKIT_LOG_COLUMNS_INTERNAL_H

#include "log_reader_internal.h"
#include "names/log_names_internal.h"

/* A cell of the header. */
typedef struct imki_log_cell {
    imki_log_piece text, unit; /* what stands there; the unit is that in brackets */
    imki_log_name name;
    imk_log_column column;
    bool skipped, lacks_unit;
    bool no_message; /* named as in sensor_msgs/Imu, and not of that message */
} imki_log_cell;

enum { IMKI_LOG_NAME_SIZE = 128 };

/* "gyro_x [deg/s]", "gyro[0] [deg/s]": divide at the bracket that is closed at the end. */
void imki_log_unit_split(imki_log_piece *name, imki_log_piece *unit);

void imki_log_piece_copy(char *target, size_t size, imki_log_piece piece);

/* What the cells of a header are by their names. */
void imki_log_cells_name(const imki_log_piece *header, size_t count, imki_log_cell *cells);

/* Are two cells readings of the same quantity and axis? */
bool imki_log_cells_same(const imki_log_cell *a, const imki_log_cell *b);

const char *imki_log_unit_setting(imk_quantity quantity, const imk_log_settings *settings);
bool imki_log_unit_fits(const imki_log_kind *kind, const imk_unit *unit);
imk_status imki_log_unit_refuse(const imki_log_kind *kind, const imk_unit *unit, const char *field,
                                imk_error *error);

/* A time in two columns: whole seconds and what is beyond them. */
typedef struct imki_log_time_parts {
    size_t whole, rest; /* cells */
    int64_t ticks;      /* [ns] of one of the rest */
} imki_log_time_parts;

/* Has the header such two, and no column of the whole time by an exact name? */
bool imki_log_time_parts_find(const imki_log_piece *header, size_t count,
                              imki_log_time_parts *parts);
/* Refuse to take the seconds alone for the time. @param map  names the columns, or NULL
 * @return IMK_ERROR_COLUMN */
imk_status imki_log_time_parts_refuse(const imki_log_piece *header, size_t count, const char *map,
                                      imk_error *error);

/* The header that settings.map makes of one: columns that it does not name are "-".
 * @param text  holds the new names */
imk_status imki_log_map(const char *map, const imki_log_piece *header, size_t count,
                        char (*text)[IMKI_LOG_NAME_SIZE], imki_log_piece *cells, imk_error *error);

/* The unit by the end of a name, as in "acc_x_mg"; empty: there is none. */
imki_log_piece imki_log_unit_of_name(imki_log_piece name);

/* Read the unit of a column of a kind, which may be written as at the end of a name.
 * @return as imk_unit_parse(); error.expected is a unit that is likely meant, or some of them */
imk_status imki_log_unit_read(imki_log_piece text, const imki_log_kind *kind, imk_unit *unit,
                              imk_error *error);

/* The unit that the file has for a column and the one that is stated: one of them, or the same. A
 * unit of the file that is not known says nothing.
 * @param field  what states it @param kind  of the column; NULL: not known
 * @return IMK_ERROR_CONFLICT */
imk_status imki_log_units_agree(const char *field, const imki_log_kind *kind, imki_log_piece name,
                                imki_log_piece mapped, imki_log_piece own, imk_error *error);

/* Units of the settings: are they units, of the right dimension, and not others than the file's? */
imk_status imki_log_settings_check(const imki_log_layout_read *layout,
                                   const imk_log_settings *settings, imk_error *error);

/* Refuse a log of which a unit or the rate is not known: all that is missing in one message. Notes
 * it in the layout. */
imk_status imki_log_missing_check(const imki_log_cell *cells, imki_log_layout_read *layout,
                                  const imk_log_settings *settings, imk_error *error);

#endif
