/* SPDX-License-Identifier: Apache-2.0 */
/* Columns by the names that they have in the file: "gyro_x=wx,time=stamp [us]". Those that are not
 * named are not read. */
#include "log_columns_internal.h"

#include "base/text_internal.h"

#include <stdio.h>
#include <string.h>

static const char due[] = "pairs of a name of imukit and one of the file, such as "
                          "\"gyro_x=wx,gyro_y=wy,time=stamp [us]\"";

static bool is_same(imki_log_piece a, imki_log_piece b)
{
    if (a.end - a.begin != b.end - b.begin)
        return false;
    for (; a.begin < a.end; a.begin++, b.begin++)
        if (imki_lower(*a.begin) != imki_lower(*b.begin))
            return false;
    return true;
}

static imki_log_piece strip(imki_log_piece piece)
{
    while (piece.begin < piece.end && (*piece.begin == ' ' || *piece.begin == '\t'))
        piece.begin++;
    while (piece.end > piece.begin && (piece.end[-1] == ' ' || piece.end[-1] == '\t'))
        piece.end--;
    return piece;
}

/* The names of the file, for a message. */
static void list_names(const imki_log_piece *header, size_t count, size_t size, char *text)
{
    imki_copy_text(text, size, "the log has ");
    for (size_t i = 0; i < count; i++) {
        imki_log_piece name = header[i], unit;
        char one[40];
        imki_log_unit_split(&name, &unit);
        imki_log_piece_copy(one, sizeof one, name);
        if (strlen(text) + strlen(one) + 8 > size) {
            imki_append_text(text, size, ", …");
            return;
        }
        imki_append_text(text, size, i > 0 ? ", " : "");
        imki_append_text(text, size, one);
    }
}

static imk_status refuse(imki_log_piece name, const char *what, const char *expected,
                         imk_error *error)
{
    char text[40], found[96];
    imki_log_piece_copy(text, sizeof text, name);
    snprintf(found, sizeof found, "\"%s\" %s", text, what);
    return imk_error_set(error, IMK_ERROR_COLUMN, "map", found, expected);
}

/* The cell that a name of the file means, with its unit or without. */
static imk_status find_cell(imki_log_piece name, imki_log_piece bare, const imki_log_piece *header,
                            size_t count, size_t *index, imk_error *error)
{
    char names[300];
    size_t matches = 0;
    for (int whole = 1; whole >= 0 && matches == 0; whole--)
        for (size_t i = 0; i < count; i++) {
            imki_log_piece cell = strip(header[i]), unit;
            if (!whole)
                imki_log_unit_split(&cell, &unit);
            if (is_same(cell, whole ? name : bare) && matches++ == 0)
                *index = i;
        }
    if (matches == 1)
        return IMK_OK;
    list_names(header, count, sizeof names, names);
    return refuse(bare, matches == 0 ? "is no column of the log" : "is the name of several columns",
                  matches == 0 ? names
                               : "write the name with its unit, as in the header, or use "
                                 "--columns",
                  error);
}

static imk_status map_one(imki_log_piece pair, const imki_log_piece *header, size_t count,
                          char (*text)[IMKI_LOG_NAME_SIZE], imki_log_piece *cells, imk_error *error)
{
    const char *equals = memchr(pair.begin, '=', (size_t)(pair.end - pair.begin));
    if (!equals)
        return refuse(pair, "has no =", due, error);
    imki_log_piece to = strip((imki_log_piece){pair.begin, equals});
    imki_log_piece from = strip((imki_log_piece){equals + 1, pair.end}), bare = from, unit, own;
    if (to.begin == to.end || from.begin == from.end)
        return refuse(pair, "lacks a name", due, error);
    size_t index = 0;
    imki_log_unit_split(&bare, &unit);
    imk_status status = find_cell(from, bare, header, count, &index, error);
    if (status != IMK_OK)
        return status;
    if (cells[index].end - cells[index].begin != 1 || *cells[index].begin != '-')
        return refuse(bare, "is mapped twice", due, error);
    imki_log_piece cell = header[index];
    imki_log_unit_split(&cell, &own);
    if (own.begin == own.end)
        own = imki_log_unit_of_name(cell);
    char name[48], stated[60];
    imki_log_piece_copy(name, sizeof name, to);
    status = imki_log_units_agree("map", imki_log_name_of(name).kind, bare, unit, own, error);
    if (status != IMK_OK)
        return status;
    imki_log_piece_copy(stated, sizeof stated, unit.begin < unit.end ? unit : own);
    snprintf(text[index], sizeof text[index], stated[0] ? "%s [%s]" : "%s", name, stated);
    cells[index] = (imki_log_piece){text[index], text[index] + strlen(text[index])};
    return IMK_OK;
}

imk_status imki_log_map(const char *map, const imki_log_piece *header, size_t count,
                        char (*text)[IMKI_LOG_NAME_SIZE], imki_log_piece *cells, imk_error *error)
{
    static const char skip[] = "-";
    imki_log_piece pairs[IMK_LOG_COLUMNS_MAX];
    const size_t pair_count =
        imki_log_split(map, map + strlen(map), ',', IMK_LOG_COLUMNS_MAX, pairs);
    if (pair_count > IMK_LOG_COLUMNS_MAX)
        return imk_error_set(error, IMK_ERROR_COLUMN, "map", "there are more than 64 names",
                             "at most 64 columns");
    for (size_t i = 0; i < count; i++)
        cells[i] = (imki_log_piece){skip, skip + 1};
    for (size_t i = 0; i < pair_count; i++) {
        const imk_status status = map_one(pairs[i], header, count, text, cells, error);
        if (status != IMK_OK)
            return status;
    }
    return IMK_OK;
}
