/* SPDX-License-Identifier: Apache-2.0 */
/* Arrays and texts on their way to a verb, which reads files: in a folder of their own in TMPDIR,
 * for the time of the call. */
#define _POSIX_C_SOURCE 200809L
#include "gateway.h"

#include "imukit/record.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/statvfs.h>
#include <unistd.h>

enum { NAME_SIZE = 160 };

char *gateway_file(const char *name)
{
    gateway_call *call = gateway_now();
    const char *place = getenv("TMPDIR");
    char path[sizeof call->folder + 300];
    if (!call->folder[0]) {
        const int length = snprintf(call->folder, sizeof call->folder, "%s/imukit-XXXXXX",
                                    place && *place ? place : "/tmp");
        if (length >= (int)sizeof call->folder || !mkdtemp(call->folder)) {
            (void)gateway_refuse(
                "no temporary folder can be made in %s: %s; set TMPDIR to one that "
                "can be written",
                place && *place ? place : "/tmp", strerror(errno));
            call->folder[0] = '\0';
            return NULL;
        }
    }
    snprintf(path, sizeof path, "%s/%s", call->folder, name);
    return gateway_copy(path);
}

bool gateway_has_room(double bytes)
{
    struct statvfs about;
    char *path = gateway_file("");
    const bool known = path && statvfs(path, &about) == 0;
    const double room = known ? (double)about.f_bavail * (double)about.f_frsize : bytes;
    free(path);
    return bytes <= room ||
           gateway_refuse(
               "the log has %.3g GB or more, and does not fit into the temporary "
               "folder, which has %.3g GB: make it shorter, or set TMPDIR to a folder with room",
               bytes / 1e9, room / 1e9);
}

void gateway_remove_files(void)
{
    gateway_call *call = gateway_now();
    DIR *folder = call->folder[0] ? opendir(call->folder) : NULL;
    if (folder)
        for (const struct dirent *entry = readdir(folder); entry; entry = readdir(folder))
            (void)unlinkat(dirfd(folder), entry->d_name, 0); /* "." and ".." stay */
    if (folder)
        closedir(folder);
    if (call->folder[0])
        (void)rmdir(call->folder);
    call->folder[0] = '\0';
}

void gateway_without_folder(char *text)
{
    const gateway_call *call = gateway_now();
    const size_t length = strlen(call->folder);
    if (length == 0)
        return;
    for (char *at = strstr(text, call->folder); at; at = strstr(at, call->folder))
        memmove(at, at + length + (at[length] == '/'),
                strlen(at + length + (at[length] == '/')) + 1);
}

/* @return path, or NULL after a refusal; closes and frees what it is given */
static char *written(FILE *file, char *path)
{
    const bool failed = !file || ferror(file);
    const int reason = errno;
    if (file && fclose(file) == 0 && !failed)
        return path;
    (void)gateway_refuse("%s cannot be written: %s", path, strerror(failed ? reason : errno));
    free(path);
    return NULL;
}

char *gateway_write_text(const char *name, const char *text)
{
    char *path = gateway_file(name);
    FILE *file = path ? fopen(path, "w") : NULL;
    if (file)
        (void)fwrite(text, 1, strlen(text), file);
    return path ? written(file, path) : NULL;
}

/* ---- arrays ---------------------------------------------------------------------------------- */

/* Add a name to a list: "gyro_x" is in rad/s where it does not say otherwise, "gyro" is all three.
 * @return how many names it is */
static size_t put_name(char *list, const char *name, size_t length)
{
    static const char *const triads[] = {"gyro", "accel", "mag"};
    static const char *const units[] = {[IMK_QUANTITY_TIME] = " [s]",
                                        [IMK_QUANTITY_ANGULAR_RATE] = " [rad/s]",
                                        [IMK_QUANTITY_SPECIFIC_FORCE] = " [m/s^2]",
                                        [IMK_QUANTITY_TEMPERATURE] = " [K]",
                                        [IMK_QUANTITY_MAGNETIC] = " [T]"};
    char text[NAME_SIZE];
    snprintf(text, sizeof text, "%.*s", (int)length, name);
    const size_t word = strcspn(text, " [(");
    for (size_t k = 0; k < 3; k++)
        if (word == strlen(triads[k]) && strncmp(text, triads[k], word) == 0) {
            for (const char *axis = "xyz"; *axis; axis++) {
                char one[NAME_SIZE + 8];
                snprintf(one, sizeof one, "%.*s_%c%s", (int)word, text, *axis, text + word);
                put_name(list, one, strlen(one));
            }
            return 3;
        }
    const char *unit = text[word] ? NULL : units[imk_record_column(text).quantity];
    sprintf(list + strlen(list), "%s%s%s", *list ? "," : "", text, unit ? unit : "");
    return 1;
}

char *gateway_column_names(const char *names, size_t *count)
{
    char *list = malloc((strlen(names) + 1) * 3 * 16 + NAME_SIZE);
    if (!list)
        voice_end(1);
    *list = '\0';
    *count = 0;
    for (const char *name = names + strspn(names, ", "); *name; name += strspn(name, ", ")) {
        size_t length = strcspn(name, ",");
        const char *next = name + length;
        while (name[length - 1] == ' ')
            length--;
        *count += put_name(list, name, length < NAME_SIZE ? length : NAME_SIZE - 1);
        name = next;
    }
    return list;
}

static bool check_array(const mxArray *array)
{
    const char *what = NULL, *remedy = "";
    if (mxIsSparse(array)) {
        what = "sparse";
        remedy = "; full(x) converts them";
    } else if (!mxIsDouble(array)) {
        what = mxGetClassName(array);
        remedy = "; double(x) converts them";
    } else if (mxIsComplex(array)) {
        what = "complex";
    } else if (mxIsEmpty(array)) {
        what = "empty";
    } else if (mxGetNumberOfDimensions(array) != 2) {
        what = "an array of more dimensions";
    }
    return !what || gateway_refuse("the readings are %s: expected a real matrix of class double, a "
                                   "row for each sample, a column for each channel%s",
                                   what, remedy);
}

char *gateway_write_array(const char *name, const mxArray *array, size_t named)
{
    const size_t rows = mxGetM(array), columns = mxGetN(array);
    if (!check_array(array))
        return NULL;
    if (named != columns || columns > IMK_LOG_COLUMNS_MAX) {
        (void)gateway_refuse("the array has %zu column%s, and 'columns' names %zu: expected a row "
                             "for each sample and a name for each of up to %d columns; - skips one",
                             columns, columns == 1 ? "" : "s", named, IMK_LOG_COLUMNS_MAX);
        return NULL;
    }
    char *path = gateway_file(name);
    FILE *file = path ? fopen(path, "wb") : NULL;
    const double *value = mxGetPr(array);
    char head[118];
    snprintf(head, sizeof head, "{'descr': '<f8', 'fortran_order': False, 'shape': (%zu, %zu), }",
             rows, columns);
    if (file) /* 10 bytes, and 118 of the dictionary with its blanks and line feed [NPY] */
        fprintf(file, "%cNUMPY%c%c%c%c%-117s\n", 0x93, 1, 0, 118, 0, head);
    for (size_t row = 0; file && row < rows; row++) {
        double line[IMK_LOG_COLUMNS_MAX];
        for (size_t c = 0; c < columns; c++)
            line[c] = value[c * rows + row];
        (void)fwrite(line, sizeof *line, columns, file);
    }
    return path ? written(file, path) : NULL;
}
