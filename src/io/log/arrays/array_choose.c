/* SPDX-License-Identifier: Apache-2.0 */
/* Which arrays of a file make a log. Arrays of one group and of equal length belong together; a
 * matrix is one column for each of its parts, by the rules
 *
 *     gyro, n x 3 or 3 x n        gyro_x, gyro_y, gyro_z
 *     any other, n x k            NAME column 1 ... k, or its labels
 *
 * The rows are along the dimension that is as long as the time of the group, or else the longer
 * one. What the columns are is told by their names, as in the header of a CSV. */
#include "array_list_internal.h"
#include "base/text_internal.h"
#include "io/log/log_columns_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Names of arrays of three columns that are not those of headers: NaveGo's structures, and what
 * programs call vectors. */
static const struct {
    const char *array, *column;
} vectors[] = {{"gyroscope", "gyro"},  {"omega", "gyro"},          {"wb", "gyro"},
               {"acce", "accel"},      {"accelerometer", "accel"}, {"fb", "accel"},
               {"magnetometer", "mag"}};

typedef struct group_of_arrays {
    size_t first; /* array */
    bool known;   /* it holds a gyro or an accelerometer */
    bool readable;
} group_of_arrays;

static bool same_text(const char *a, const char *b)
{
    while (*a && imki_lower(*a) == imki_lower(*b))
        a++, b++;
    return imki_lower(*a) == imki_lower(*b);
}

/* The quantity of a name as the header of a CSV would have it. */
static imk_quantity quantity_of(const char *name)
{
    imki_log_piece text = {name, name + strlen(name)}, unit;
    char plain[IMKI_LOG_NAME_SIZE];
    imki_log_unit_split(&text, &unit);
    imki_log_piece_copy(plain, sizeof plain, text);
    const imki_log_kind *kind = imki_log_name_of(plain).kind;
    return kind ? kind->quantity : IMK_QUANTITY_OTHER;
}

/* The name of a column. @return false: there are no labels, or not as many as columns */
static bool label_of(const imki_array *array, size_t part, size_t size, char *name)
{
    size_t count = 0;
    const char *at = NULL;
    for (const char *line = array->labels; *line; count++) {
        const size_t length = strcspn(line, "\n");
        at = count == part && length > 0 ? line : at;
        line += length + (line[length] == '\n');
    }
    if (count != array->parts || !at)
        return false;
    snprintf(name, size, "%.*s", (int)strcspn(at, "\n"), at);
    return true;
}

static void name_of(const imki_array *array, size_t part, size_t size, char *name)
{
    if (array->parts > 1 && label_of(array, part, size, name))
        return;
    if (array->parts == 3) {
        snprintf(name, size, "%s_%c", array->name, "xyz"[part]);
        for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; i++)
            if (quantity_of(name) == IMK_QUANTITY_OTHER && same_text(array->name, vectors[i].array))
                snprintf(name, size, "%s_%c", vectors[i].column, "xyz"[part]);
    } else if (array->parts > 1)
        snprintf(name, size, "%s column %zu", array->name, part + 1);
    else
        snprintf(name, size, "%s", array->name);
}

/* Name and unit, as in a header. */
static void head_of(const imki_array *array, size_t part, size_t size, char *text)
{
    char name[96];
    name_of(array, part, sizeof name, name);
    imki_copy_text(text, size, name);
    if (array->unit[0] && !strpbrk(name, "[(")) {
        imki_append_text(text, size, " [");
        imki_append_text(text, size, array->unit);
        imki_append_text(text, size, "]");
    }
}

/* Length of the time of a group; 0: it has none. */
static uint64_t time_of_group(const imki_array_list *list, const char *group)
{
    for (size_t i = 0; i < list->count; i++) {
        const imki_array *array = &list->array[i];
        const uint64_t shorter = array->extent[array->extent[0] > array->extent[1]];
        if (shorter == 1 && strcmp(array->group, group) == 0 &&
            quantity_of(array->name) == IMK_QUANTITY_TIME)
            return array->extent[array->extent[1] > array->extent[0]];
    }
    return 0;
}

/* Rows and columns; no rows: it is no part of a log. */
static void find_shape(const imki_array_list *list, imki_array *array)
{
    const uint64_t *extent = array->extent, time = time_of_group(list, array->group);
    array->along = extent[1] > extent[0];
    if (time > 0 && extent[!array->along] == time && extent[array->along] != time)
        array->along = !array->along;
    const uint64_t parts = extent[!array->along];
    array->rows = parts >= 1 && parts <= IMK_LOG_COLUMNS_MAX ? extent[array->along] : 0;
    array->parts = (size_t)(array->rows > 0 ? parts : 0);
}

static bool belong_together(const imki_array *a, const imki_array *b)
{
    return a->rows == b->rows && strcmp(a->group, b->group) == 0;
}

static bool is_sensor(const imki_array *array)
{
    char name[96];
    for (size_t part = 0; part < array->parts; part++) {
        name_of(array, part, sizeof name, name);
        const imk_quantity quantity = quantity_of(name);
        if (quantity == IMK_QUANTITY_ANGULAR_RATE || quantity == IMK_QUANTITY_SPECIFIC_FORCE)
            return true;
    }
    return false;
}

bool imki_array_is_sensor(const char *name)
{
    imki_array array = {.parts = 1};
    snprintf(array.name, sizeof array.name, "%.*s", (int)strcspn(name, " [("), name);
    bool sensor = is_sensor(&array);
    array.parts = 3;
    sensor = sensor || is_sensor(&array);
    return sensor;
}

/* Arrays that a reader of the log will miss: those beside the arrays that are read, and, unless a
 * group was asked for, those of sensors anywhere. */
static void tell_unread(imk_log_reader *reader, const imki_array_list *list, const char *group)
{
    for (size_t i = 0; i < list->other_count; i++) {
        const imki_array_other *other = &list->other[i];
        const char *last = NULL; /* separator before the name, which may have a unit */
        for (const char *c = other->name; *c && *c != '[' && *c != '('; c++)
            last = *c == list->separator ? c : last;
        const size_t length = last ? (size_t)(last - other->name) : 0;
        const bool beside = strlen(group) == length && strncmp(group, other->name, length) == 0;
        const bool sensor = imki_array_is_sensor(last ? last + 1 : other->name);
        if (!beside && (!sensor || reader->settings.topic))
            continue;
        if (reader->unread++ > 0)
            continue;
        imki_copy_text(reader->unread_name, sizeof reader->unread_name, other->name);
        imki_copy_text(reader->unread_kind, sizeof reader->unread_kind, other->kind);
    }
}

/* Where no name in the file is known, what could be named by --columns is readable.
 * @param asked  so it is where that is asked for */
static size_t find_groups(imki_array_list *list, bool asked, group_of_arrays *group)
{
    size_t count = 0;
    bool known = false;
    for (size_t i = 0; i < list->count; i++)
        find_shape(list, &list->array[i]);
    for (size_t i = 0; i < list->count; i++) {
        const imki_array *array = &list->array[i];
        size_t at = 0;
        while (at < count && !belong_together(&list->array[group[at].first], array))
            at++;
        if (array->rows == 0)
            continue;
        if (at == count)
            group[count++] = (group_of_arrays){.first = i};
        group[at].known = group[at].known || is_sensor(array);
        known = known || group[at].known;
    }
    for (size_t i = 0; i < count; i++)
        group[i].readable =
            group[i].known || ((asked || !known) && list->array[group[i].first].rows > 1);
    return count;
}

/* Its group, and where that has several lengths, its first sensor. */
static void name_stream(const imki_array_list *list, const group_of_arrays *group, size_t count,
                        size_t index, imk_log_stream *stream)
{
    const imki_array *first = &list->array[group[index].first];
    size_t alike = 0, readable = 0;
    for (size_t i = 0; i < count; i++) {
        readable += group[i].readable;
        alike += group[i].readable && strcmp(list->array[group[i].first].group, first->group) == 0;
    }
    for (size_t i = group[index].first; i < list->count; i++) {
        const imki_array *array = &list->array[i];
        if (!belong_together(array, first))
            continue;
        if (stream->kind[0])
            imki_append_text(stream->kind, sizeof stream->kind, ", ");
        imki_append_text(stream->kind, sizeof stream->kind, array->name);
        if (is_sensor(array) && !is_sensor(first))
            first = array;
    }
    if (alike == 1 && (first->group[0] || readable == 1))
        snprintf(stream->name, sizeof stream->name, "%s", first->group);
    else
        snprintf(stream->name, sizeof stream->name, "%.47s%.1s%.47s", first->group,
                 first->group[0] ? &list->separator : "", first->name);
}

/* @param of  receives the group of each readable stream */
static imk_status add_streams(imk_log_reader *reader, const imki_array_list *list,
                              const group_of_arrays *group, size_t count, size_t *of,
                              imk_error *error)
{
    imk_status status = IMK_OK;
    size_t added = 0;
    for (size_t i = 0; i < count && status == IMK_OK; i++) {
        imk_log_stream stream = {.instance = -1,
                                 .readable = true,
                                 .samples = list->array[group[i].first].rows,
                                 .begin = (double)NAN,
                                 .end = (double)NAN};
        if (!group[i].readable)
            continue;
        name_stream(list, group, count, i, &stream);
        of[added++] = i;
        status = imki_log_stream_add(reader, &stream, error);
    }
    for (size_t i = 0; i < list->other_count && status == IMK_OK; i++) {
        imk_log_stream stream = {.instance = -1, .begin = (double)NAN, .end = (double)NAN};
        imki_copy_text(stream.name, sizeof stream.name, list->other[i].name);
        imki_copy_text(stream.kind, sizeof stream.kind, list->other[i].kind);
        status = imki_log_stream_add(reader, &stream, error);
    }
    return status;
}

/* What to do about arrays that cannot be read, by the word that their kind has. */
static imk_status refuse_other(const imki_array_other *other, imk_error *error)
{
    static const struct {
        const char *word, *remedy;
    } remedies[] = {
        {"complex", "write its real part, as a vector or matrix of numbers"},
        {"dimensions", "write it as a matrix of two: a row for each sample"},
        {"fields", "write each of them as a vector of its own"},
        {"NumPy", "write it as float64: numpy.savez(FILE, NAME=NAME.astype('f8'), ...)"},
        {"MATLAB", "write it in MATLAB as a CSV: writetable(TABLE, 'log.csv'), for a timetable "
                   "writetimetable()"},
        {"record", "write its fields: numpy.savez(FILE, **{n: table[n] for n in "
                   "table.dtype.names})"},
        {"compression", "write it with gzip, where its filter is installed: h5repack -f GZIP=4 IN "
                        "OUT"},
        {"another file", "write the values into the file itself"},
        {"unclear", "state it as one number, a factor other than 0, of a dataset of numbers; "
                    "or write the values themselves without it"},
        {"soft link", "write what it leads to in its place: h5copy -i FILE -s FROM -o NEW -d TO"},
        {"", "copy the file again, or write it with the usual compression"}};
    char found[96];
    size_t i = 0;
    while (!strstr(other->kind, remedies[i].word))
        i++;
    snprintf(found, sizeof found, "\"%.36s\" is a %.47s", other->name, other->kind);
    return imk_error_set(error, IMK_ERROR_EMPTY, "", found, remedies[i].remedy);
}

static imk_status refuse_count(size_t given, size_t count, const imki_log_piece *head,
                               imk_error *error)
{
    char found[96], expected[160] = "the columns are ";
    snprintf(found, sizeof found, "%zu name%s given for %zu columns", given,
             given == 1 ? " is" : "s are", count);
    for (size_t i = 0; i < count; i++) {
        imki_append_text(expected, sizeof expected, i > 0 ? ", " : "");
        imki_append_text(expected, sizeof expected, head[i].begin);
    }
    return imk_error_set(error, IMK_ERROR_COLUMN, "columns", found, expected);
}

static imk_status make_layout(imk_log_reader *reader, size_t count, const imki_log_piece *head,
                              imk_error *error)
{
    const imk_log_settings *settings = &reader->settings;
    imki_log_piece named[IMK_LOG_COLUMNS_MAX];
    const char *columns = settings->columns;
    if (columns) {
        const size_t given =
            imki_log_split(columns, columns + strlen(columns), ',', IMK_LOG_COLUMNS_MAX, named);
        if (given != count)
            return refuse_count(given, count, head, error);
        head = named;
    }
    const imk_status status = imki_log_time_parts_refuse(head, count, settings->map, error);
    return status == IMK_OK ? imki_log_layout_make(head, count, settings, &reader->layout, error)
                            : status;
}

/* The arrays that belong to `first`, as columns. */
static imk_status take_columns(imk_log_reader *reader, const imki_array_list *list,
                               const imki_array *first, imki_array_column *column, imk_error *error)
{
    char text[IMK_LOG_COLUMNS_MAX][144];
    imki_log_piece head[IMK_LOG_COLUMNS_MAX];
    size_t count = 0;
    for (size_t i = 0; i < list->count; i++) {
        const imki_array *array = &list->array[i];
        for (size_t part = 0; part < array->parts && belong_together(array, first); part++) {
            if (count == IMK_LOG_COLUMNS_MAX)
                return imk_error_set(error, IMK_ERROR_COLUMN, "",
                                     "the arrays have more than 64 columns together",
                                     "write those of the sensor to a file of their own");
            head_of(array, part, sizeof text[count], text[count]);
            head[count] = (imki_log_piece){text[count], text[count] + strlen(text[count])};
            column[count++] = (imki_array_column){i, part};
        }
    }
    return make_layout(reader, count, head, error);
}

/* A time of the group that cannot be read; NULL: there is none. */
static const imki_array_other *time_among_others(const imki_array_list *list, const char *group)
{
    const size_t length = strlen(group);
    for (size_t i = 0; i < list->other_count; i++) {
        const char *name = list->other[i].name;
        const bool within =
            strncmp(name, group, length) == 0 && (length == 0 || name[length] == list->separator);
        if (within && quantity_of(name + length + (length > 0)) == IMK_QUANTITY_TIME)
            return &list->other[i];
    }
    return NULL;
}

imk_status imki_arrays_choose(imk_log_reader *reader, imki_array_list *list,
                              imki_array_column column[IMK_LOG_COLUMNS_MAX], uint64_t *rows,
                              imk_error *error)
{
    group_of_arrays group[IMKI_ARRAYS_MAX];
    size_t of[IMKI_ARRAYS_MAX], chosen = 0;
    const size_t count =
        find_groups(list, reader->settings.columns && reader->settings.topic, group);
    imk_status status = add_streams(reader, list, group, count, of, error);
    if (status == IMK_OK)
        status =
            imki_log_stream_choose(reader, "the file holds no arrays of samples", &chosen, error);
    if (status == IMK_ERROR_EMPTY && list->other_count > 0)
        return refuse_other(&list->other[0], error);
    if (status != IMK_OK)
        return status;
    const imki_array *first = &list->array[group[of[chosen]].first];
    *rows = first->rows;
    tell_unread(reader, list, first->group);
    status = take_columns(reader, list, first, column, error);
    const imki_array_other *time = status != IMK_OK && reader->layout.missing.rate
                                       ? time_among_others(list, first->group)
                                       : NULL;
    if (!time)
        return status;
    refuse_other(time, error);
    if (error)
        error->status = status;
    return status;
}
