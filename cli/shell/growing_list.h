/* SPDX-License-Identifier: Apache-2.0 */
/* A text that grows while it is put together, such as a list of names. */
#ifndef IMUKIT_GROWING_LIST_H
#define IMUKIT_GROWING_LIST_H

#include <stddef.h>

/* From {0} on. The command ends where memory is exhausted. */
typedef struct growing_list {
    char *text; /* NULL while nothing is in it */
    size_t size;
} growing_list;

void list_add(growing_list *list, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* The same behind ", " unless it is the first. */
void list_add_item(growing_list *list, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void list_free(growing_list *list);

#endif
