/* SPDX-License-Identifier: Apache-2.0 */
/* Names and texts of the statuses, from the one list in status.h, and filling an imk_error. */
#include "imukit/status.h"
#include "base/text_internal.h"
#include "imukit/utf8.h"

#include <stddef.h>
#include <string.h>

const char *imk_status_name(imk_status status)
{
    switch (status) {
#define NAME(name, value, text)                                                                    \
    case name:                                                                                     \
        return #name;
        IMK_STATUS_LIST(NAME)
#undef NAME
    }
    return "unknown";
}

const char *imk_version(void)
{
    return IMK_VERSION;
}

const char *imk_status_text(imk_status status)
{
    switch (status) {
#define TEXT(name, value, text)                                                                    \
    case name:                                                                                     \
        return text;
        IMK_STATUS_LIST(TEXT)
#undef TEXT
    }
    return "unknown";
}

imk_status imk_error_set(imk_error *error, imk_status status, const char *field, const char *found,
                         const char *expected)
{
    if (error) {
        memset(error, 0, sizeof *error);
        error->status = status;
        error->index = -1;
        imk_utf8_shorten(field ? field : "", error->field, sizeof error->field);
        imki_copy_text(error->found, sizeof error->found, found ? found : "");
        imki_copy_text(error->expected, sizeof error->expected, expected ? expected : "");
    }
    return status;
}
