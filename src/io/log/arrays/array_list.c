/* SPDX-License-Identifier: Apache-2.0 */
/* The arrays of a file, as its reader finds them. */
#include "array_list_internal.h"

#include "base/text_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

size_t imki_value_size(imki_value_type type)
{
    static const unsigned char size[IMKI_VALUE_TYPES] = {
        [IMKI_FLOAT64] = 8, [IMKI_FLOAT32] = 4, [IMKI_INT8] = 1,  [IMKI_UINT8] = 1,
        [IMKI_INT16] = 2,   [IMKI_UINT16] = 2,  [IMKI_INT32] = 4, [IMKI_UINT32] = 4,
        [IMKI_INT64] = 8,   [IMKI_UINT64] = 8};
    return size[type];
}

/* "gyro_x [deg/s]": the unit is taken off. What divides the cells of a header becomes "_". */
static void divide_name(imki_array *array)
{
    char *name = array->name;
    const size_t length = strlen(name);
    const char close = length > 0 ? name[length - 1] : '\0';
    char *open = close == ']' ? strchr(name, '[') : close == ')' ? strchr(name, '(') : NULL;
    if (open && open > name) {
        name[length - 1] = '\0';
        if (array->unit[0] == '\0')
            imki_copy_text(array->unit, sizeof array->unit, open + 1);
        while (open > name && open[-1] == ' ')
            open--;
        *open = '\0';
    }
    for (char *c = name; *c; c++)
        if (strchr(",;\"#[]()", *c) || (unsigned char)*c < ' ')
            *c = '_';
}

imk_status imki_array_add(imki_array_list *list, const imki_array *array, imk_error *error)
{
    if (list->count == IMKI_ARRAYS_MAX)
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "",
                             "the file holds more than 1024 arrays",
                             "a file of one log: an array for each sensor or axis");
    if (list->count == list->room) {
        const size_t room = list->room > 0 ? 2 * list->room : 16;
        imki_array *larger = realloc(list->array, room * sizeof *larger);
        if (!larger)
            return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
        list->array = larger;
        list->room = room;
    }
    list->array[list->count] = *array;
    divide_name(&list->array[list->count++]);
    return IMK_OK;
}

void imki_array_note(imki_array_list *list, const char *name, const char *kind)
{
    if (list->other_count == sizeof list->other / sizeof list->other[0])
        return;
    imki_array_other *other = &list->other[list->other_count++];
    imki_copy_text(other->name, sizeof other->name, name);
    imki_copy_text(other->kind, sizeof other->kind, kind);
}

void imki_array_unit(imki_array_list *list, const char *group, const char *name, const char *unit)
{
    for (size_t i = 0; i < list->count; i++) {
        imki_array *array = &list->array[i];
        if (array->unit[0] == '\0' && strcmp(array->group, group) == 0 &&
            strcmp(array->name, name) == 0)
            imki_copy_text(array->unit, sizeof array->unit, unit);
    }
}

void imki_array_list_free(imki_array_list *list)
{
    free(list->array);
    *list = (imki_array_list){0};
}
