/* SPDX-License-Identifier: Apache-2.0 */
/* Several sensors in one table, told by the words before the names: imu0_gyro_x, imu1_gyro_x. */
#include "log_csv_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static bool is_sensor(const imki_log_cell *cell)
{
    return cell->name.kind && cell->name.axis >= 0;
}

/* Are readings of the same axis in columns of different groups? */
static bool has_several(const imki_log_cell *cells, size_t count)
{
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < i && is_sensor(&cells[i]); k++)
            if (imki_log_cells_same(&cells[i], &cells[k]) &&
                strcmp(cells[i].name.group, cells[k].name.group) != 0)
                return true;
    return false;
}

/* Is there a reading whose sensor has no name of its own, and is not one that all may share: a
 * single accelerometer beside gyro1 and gyro2? */
static bool has_nameless(const imki_log_cell *cells, size_t count)
{
    bool any = false, shared = true, several = false;
    for (size_t i = 0; i < count; i++) {
        if (!is_sensor(&cells[i]))
            continue;
        const bool nameless = !cells[i].name.group[0];
        any = any || nameless;
        for (size_t k = 0; k < count; k++) {
            if (!is_sensor(&cells[k]) || !cells[k].name.group[0] ||
                cells[k].name.kind->quantity != cells[i].name.kind->quantity)
                continue;
            shared = shared && !nameless;
            several = several || (cells[i].name.kind->quantity != IMK_QUANTITY_MAGNETIC &&
                                  strcmp(cells[k].name.group, cells[i].name.group) != 0);
        }
    }
    return any && !(shared && several);
}

static imk_status add_groups(imk_log_reader *reader, const imki_log_cell *cells, size_t count,
                             imk_error *error)
{
    for (size_t i = 0; i < count; i++) {
        imk_log_stream stream = {.instance = -1, .begin = (double)NAN, .end = (double)NAN};
        bool known = false;
        if (!is_sensor(&cells[i]) || !cells[i].name.group[0])
            continue;
        for (size_t k = 0; k < i; k++)
            known = known ||
                    (is_sensor(&cells[k]) && strcmp(cells[k].name.group, cells[i].name.group) == 0);
        for (size_t k = i; k < count; k++)
            stream.readable =
                stream.readable ||
                (is_sensor(&cells[k]) && strcmp(cells[k].name.group, cells[i].name.group) == 0 &&
                 cells[k].name.kind->quantity != IMK_QUANTITY_MAGNETIC);
        if (known)
            continue;
        snprintf(stream.name, sizeof stream.name, "%s", cells[i].name.group);
        const imk_status status = imki_log_stream_add(reader, &stream, error);
        if (status != IMK_OK)
            return status;
    }
    return IMK_OK;
}

imk_status imki_csv_choose_sensor(imk_log_reader *reader, imki_csv_header *header, imk_error *error)
{
    static const char skip[] = "-";
    imki_log_cell cells[IMK_LOG_COLUMNS_MAX];
    size_t index;
    if (reader->settings.columns || reader->settings.map)
        return IMK_OK;
    imki_log_cells_name(header->cell, header->count, cells);
    const bool asked = reader->settings.topic || reader->settings.instance > 0;
    if (has_nameless(cells, header->count) || !(asked || has_several(cells, header->count)))
        return asked ? imk_error_set(error, IMK_ERROR_NAME_UNKNOWN, "topic",
                                     "the columns of the table have no names of sensors",
                                     "leave --topic and --instance out, or name columns by --map")
                     : IMK_OK;
    imk_status status = add_groups(reader, cells, header->count, error);
    if (status == IMK_OK)
        status = imki_log_stream_choose(reader, "there is no column of a gyro or accelerometer",
                                        &index, error);
    if (status != IMK_OK)
        return status;
    for (size_t i = 0; i < header->count; i++)
        if (is_sensor(&cells[i]) && cells[i].name.group[0] &&
            strcmp(cells[i].name.group, reader->streams[index].name) != 0)
            header->cell[i] = (imki_log_piece){skip, skip + 1};
    return IMK_OK;
}
