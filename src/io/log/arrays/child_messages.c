/* SPDX-License-Identifier: Apache-2.0 */
/* Messages of a child, each of a kind that is due and of its size. Texts are ended here. */
#include "child_messages_internal.h"

#include "base/text_internal.h"
#include "child_process_internal.h"

#include <math.h>
#include <string.h>

enum { MESSAGES_MAX = 8 * IMKI_ARRAYS_MAX }; /* in a list */

/* Bytes that follow a message of a list; kinds that are none of it have those of a failure. */
static size_t size_of(uint32_t kind)
{
    return kind == IMKI_MESSAGE_LISTED                               ? 0
           : kind == IMKI_MESSAGE_CODING                             ? sizeof(imki_coding)
           : kind == IMKI_MESSAGE_ARRAY || kind == IMKI_MESSAGE_UNIT ? sizeof(imki_array_message)
                                                                     : sizeof(imki_array_other);
}

static bool receive_array(int socket, bool unit, imki_array_list *list, imk_status *status,
                          imk_error *error)
{
    imki_array_message said;
    imki_array array = {.type = IMKI_FLOAT64};
    if (!imki_socket_receive(socket, &said, sizeof said))
        return false;
    said.group[sizeof said.group - 1] = said.name[sizeof said.name - 1] = '\0';
    said.unit[sizeof said.unit - 1] = said.labels[sizeof said.labels - 1] = '\0';
    if (unit) {
        imki_array_unit(list, said.group, said.name, said.unit);
        return true;
    }
    if (said.type != IMKI_FLOAT64 && said.type != IMKI_INT64 && said.type != IMKI_UINT64)
        return false;
    array.type = (imki_value_type)said.type;
    imki_copy_text(array.group, sizeof array.group, said.group);
    imki_copy_text(array.name, sizeof array.name, said.name);
    imki_copy_text(array.unit, sizeof array.unit, said.unit);
    imki_copy_text(array.labels, sizeof array.labels, said.labels);
    memcpy(array.extent, said.extent, sizeof array.extent);
    *status = imki_array_add(list, &array, error);
    return true;
}

static bool receive_coding(int socket, imki_array_list *list)
{
    imki_coding said;
    if (!imki_socket_receive(socket, &said, sizeof said) || list->count == 0 ||
        said.missing_count > IMKI_MISSING_MAX || !isfinite(said.factor) || said.factor == 0.0 ||
        !isfinite(said.offset))
        return false;
    imki_array *array = &list->array[list->count - 1];
    array->coded = true;
    array->coding = said;
    return true;
}

static bool receive_other(int socket, imki_array_other *said)
{
    if (!imki_socket_receive(socket, said, sizeof *said))
        return false;
    said->name[sizeof said->name - 1] = said->kind[sizeof said->kind - 1] = '\0';
    return true;
}

static bool receive_failure(int socket, imk_status *status, imk_error *error)
{
    imki_array_other said;
    if (!receive_other(socket, &said))
        return false;
    *status = said.name[0] ? imk_error_set(error, IMK_ERROR_FORMAT, "", said.name, said.kind)
                           : imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    return true;
}

bool imki_child_list(int socket, imki_array_list *list, imk_status *status, imk_error *error)
{
    *status = IMK_OK;
    for (size_t i = 0; i < MESSAGES_MAX && *status == IMK_OK; i++) {
        imki_message message;
        imki_array_other other;
        if (!imki_socket_receive(socket, &message, sizeof message))
            return false;
        if (message.size != size_of(message.kind))
            return false;
        switch (message.kind) {
        case IMKI_MESSAGE_LISTED:
            return true;
        case IMKI_MESSAGE_ARRAY:
        case IMKI_MESSAGE_UNIT:
            if (!receive_array(socket, message.kind == IMKI_MESSAGE_UNIT, list, status, error))
                return false;
            break;
        case IMKI_MESSAGE_CODING:
            if (!receive_coding(socket, list))
                return false;
            break;
        case IMKI_MESSAGE_OTHER:
            if (!receive_other(socket, &other))
                return false;
            imki_array_note(list, other.name, other.kind);
            break;
        default:
            return message.kind == IMKI_MESSAGE_FAILED && receive_failure(socket, status, error);
        }
    }
    return *status != IMK_OK;
}

bool imki_child_rows(int socket, unsigned char *values, size_t size, imk_status *status,
                     imk_error *error)
{
    imki_message message;
    *status = IMK_OK;
    if (!imki_socket_receive(socket, &message, sizeof message))
        return false;
    if (message.kind == IMKI_MESSAGE_FAILED && message.size == sizeof(imki_array_other))
        return receive_failure(socket, status, error);
    return message.kind == IMKI_MESSAGE_ROWS && message.size == size &&
           imki_socket_receive(socket, values, size);
}
