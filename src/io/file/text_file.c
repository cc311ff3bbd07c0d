/* SPDX-License-Identifier: Apache-2.0 */
/* A short text file in memory: model files and scripts. */
#include "text_file_internal.h"

#include "input_stream_internal.h"
#include "io/campaign/campaign_internal.h"

#include "imukit/names.h"
#include "imukit/output_file.h"

#include <stdlib.h>
#include <string.h>

static bool begins_with(const char *bytes, size_t size, const char *beginning)
{
    const size_t length = strlen(beginning);
    return size >= length && memcmp(bytes, beginning, length) == 0;
}

imk_status imki_file_read(const char *path, bool reopened, size_t limit, char **bytes, size_t *size,
                          imk_error *error)
{
    imki_input *input = NULL;
    imk_status status =
        reopened ? imki_input_open_kept(path, &input, error) : imki_input_open(path, &input, error);
    if (status != IMK_OK)
        return status;
    const size_t capacity = limit + 1;
    size_t used = 0;
    char *buffer = malloc(capacity + 1);
    if (!buffer)
        status = imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    for (size_t got = 1; status == IMK_OK && got > 0 && used < capacity; used += got) {
        got = 0;
        status = imki_input_read(input, buffer + used, capacity - used, &got, error);
    }
    imki_input_close(input);
    if (status != IMK_OK) {
        free(buffer);
        return status;
    }
    buffer[used] = '\0';
    *bytes = buffer;
    *size = used;
    return IMK_OK;
}

imk_status imki_text_file_read(const char *path, size_t limit, char **bytes, size_t *size,
                               imk_error *error)
{
    char *read = NULL;
    const imk_status status = imki_file_read(path, false, limit, &read, size, error);
    if (status == IMK_OK && begins_with(read, *size, IMKI_RESULTS_MAGIC)) {
        free(read);
        return imk_error_set(error, IMK_ERROR_FORMAT, "", "this is the results file of a campaign",
                             "give the file itself to imukit drift, with a name ending in .h5");
    }
    if (status == IMK_OK)
        *bytes = read;
    return status;
}

imk_status imki_text_file_write(const char *path, const char *bytes, size_t size, imk_error *error)
{
    imk_output_file *file = NULL;
    const imk_status status = imk_output_file_open(path, &file, error);
    if (status != IMK_OK)
        return status;
    /* A failed write is reported by commit. */
    (void)imk_output_file_write(file, bytes, size);
    return imk_output_file_commit(file, error);
}

/* Does a line of the text begin with the key? JSON has a brace and a quote before it. */
static bool has_key(const char *text, const char *key)
{
    while (text) {
        text += strspn(text, " {\"\r\n");
        if (strncmp(text, key, strlen(key)) == 0)
            return true;
        text = strchr(text, '\n');
    }
    return false;
}

bool imki_is_script(const char *path, const char *key)
{
    enum { HEAD = 4096 };
    imki_input *input;
    char head[HEAD];
    size_t used = 0, got = 1;
    if (imk_is_script_name(path))
        return true;
    if (imki_input_open_kept(path, &input, NULL) != IMK_OK)
        return false; /* who reads it says why */
    while (got > 0 && used < HEAD - 1)
        if (imki_input_read(input, head + used, HEAD - 1 - used, &got, NULL) == IMK_OK)
            used += got;
        else
            got = 0;
    imki_input_close(input);
    head[used] = '\0';
    return has_key(head, key);
}
