/* SPDX-License-Identifier: Apache-2.0 */
/* Text that grows in memory, which cannot fail: the command ends instead. */
#include "growing_list.h"

#include "command.h"

#include <stdarg.h>
#include <stdlib.h>

static void add(growing_list *list, const char *format, va_list arguments)
    __attribute__((format(printf, 2, 0)));

static void add(growing_list *list, const char *format, va_list arguments)
{
    va_list again;
    va_copy(again, arguments);
    const int length = vsnprintf(NULL, 0, format, again);
    va_end(again);
    if (length < 0)
        return;
    list->text = command_memory(list->text, list->size + (size_t)length + 1);
    vsnprintf(list->text + list->size, (size_t)length + 1, format, arguments);
    list->size += (size_t)length;
}

void list_add(growing_list *list, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    add(list, format, arguments);
    va_end(arguments);
}

void list_add_item(growing_list *list, const char *format, ...)
{
    va_list arguments;
    if (list->size > 0)
        list_add(list, ", ");
    va_start(arguments, format);
    add(list, format, arguments);
    va_end(arguments);
}

void list_free(growing_list *list)
{
    free(list->text);
    *list = (growing_list){0};
}
