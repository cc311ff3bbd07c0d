/* SPDX-License-Identifier: Apache-2.0 */
/* What programs write before the header of a CSV text, and the names and units that they mean by
 * their own ones. */
#include "log_csv_internal.h"

#include <stdio.h>
#include <string.h>

static bool starts(imki_log_piece line, const char *text)
{
    const size_t length = strlen(text);
    return (size_t)(line.end - line.begin) >= length && memcmp(line.begin, text, length) == 0;
}

/* A scale of a Gyroflow log: "gscale,0.001" [GCSV]. */
static void take_scale(imki_log_piece line, const char *key, double *scale)
{
    double value;
    const size_t length = strlen(key);
    if (!starts(line, key) || line.begin + length == line.end || line.begin[length] != ',')
        return;
    const imki_log_piece number = {line.begin + length + 1, line.end};
    if (imki_log_piece_is_number(number, &value) && value > 0)
        *scale = value;
}

/* Lines of a name and a value, up to the names of the columns. */
static imk_status read_gcsv(imk_log_reader *reader, imki_log_piece *line, bool *whole, bool *found,
                            imki_csv_scales *scales, imk_error *error)
{
    do {
        const imk_status status = imki_csv_line(&reader->text, line, whole, found, NULL, error);
        if (status != IMK_OK || !*found)
            return status;
        take_scale(*line, "tscale", &scales->time);
        take_scale(*line, "gscale", &scales->gyro);
        take_scale(*line, "ascale", &scales->accel);
        take_scale(*line, "mscale", &scales->mag);
    } while (!starts(*line, "t,") && !starts(*line, "time,"));
    return IMK_OK;
}

/* A cell by the name and the unit that the program means. A unit that stands in the file remains,
 * and a map names columns as the file does. */
static void rename_cell(imki_csv_header *header, size_t index, const char *to, bool mapped)
{
    imki_log_piece name = header->cell[index], due = {to, to + strlen(to)}, own, unit;
    char first[48], second[60];
    if (strcmp(to, "-") == 0) { /* a column to skip */
        header->cell[index] = mapped ? name : due;
        return;
    }
    imki_log_unit_split(&name, &own);
    imki_log_unit_split(&due, &unit);
    imki_log_piece_copy(first, sizeof first, mapped ? name : due);
    imki_log_piece_copy(second, sizeof second, own.begin < own.end ? own : unit);
    snprintf(header->text[index], sizeof header->text[index], second[0] ? "%s [%s]" : "%s", first,
             second);
    header->cell[index] =
        (imki_log_piece){header->text[index], header->text[index] + strlen(header->text[index])};
}

void imki_csv_gyroflow_apply(imki_csv_header *header, const imki_csv_scales *scales, bool mapped)
{
    static const struct {
        const char *from, *to;
    } names[] = {{"t", "time [s]"},        {"time", "time [s]"},     {"gx", "gyro_x [rad/s]"},
                 {"rx", "gyro_x [rad/s]"}, {"gy", "gyro_y [rad/s]"}, {"ry", "gyro_y [rad/s]"},
                 {"gz", "gyro_z [rad/s]"}, {"rz", "gyro_z [rad/s]"}, {"ax", "accel_x [g]"},
                 {"ay", "accel_y [g]"},    {"az", "accel_z [g]"},    {"mx", "mag_x [gauss]"},
                 {"my", "mag_y [gauss]"},  {"mz", "mag_z [gauss]"}};
    for (size_t i = 0; i < header->count; i++)
        for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
            char name[16];
            imki_log_piece_copy(name, sizeof name, header->cell[i]);
            if (strcmp(name, names[k].from) != 0)
                continue;
            const char kind = names[k].to[0];
            header->scale[i] = kind == 't'   ? scales->time
                               : kind == 'g' ? scales->gyro
                               : kind == 'a' ? scales->accel
                                             : scales->mag;
            rename_cell(header, i, names[k].to, mapped);
            break;
        }
}

imk_status imki_csv_preamble_skip(imk_log_reader *reader, imki_log_piece *line, bool *whole,
                                  bool *found, imki_csv_scales *scales, imk_error *error)
{
    imk_status status = IMK_OK;
    *scales = (imki_csv_scales){.time = 1e-3, .gyro = 1, .accel = 1, .mag = 1};
    while (status == IMK_OK && *found && (starts(*line, "sep=") || starts(*line, "\"sep=")))
        status = imki_csv_line(&reader->text, line, whole, found, NULL, error);
    if (*found && starts(*line, "\"Product\",\"Blackbox"))
        while (status == IMK_OK && *found && !starts(*line, "\"loopIteration\"") &&
               !starts(*line, "loopIteration"))
            status = imki_csv_line(&reader->text, line, whole, found, NULL, error);
    scales->found = status == IMK_OK && *found &&
                    (starts(*line, "GYROFLOW IMU LOG") || starts(*line, "CAMERA IMU LOG"));
    return scales->found ? read_gcsv(reader, line, whole, found, scales, error) : status;
}

void imki_csv_dialect_apply(imki_csv_header *header, bool mapped)
{
    char name[IMK_LOG_COLUMNS_MAX][48];
    const char *names[IMK_LOG_COLUMNS_MAX];
    for (size_t i = 0; i < header->count; i++) {
        imki_log_piece cell = header->cell[i], unit;
        imki_log_unit_split(&cell, &unit);
        imki_log_piece_copy(name[i], sizeof name[i], cell);
        names[i] = name[i];
    }
    const imki_log_dialect *dialect = imki_log_dialect_of(header->count, names);
    for (size_t i = 0; dialect && i < header->count; i++)
        for (const imki_log_rename *r = dialect->name; r->from; r++)
            if (strcmp(r->from, names[i]) == 0)
                rename_cell(header, i, r->to, mapped);
}
