/* SPDX-License-Identifier: Apache-2.0 */
/* The three files of a plan: all texts are made before the first file is opened, and each file
 * appears complete or not at all. */
#define _POSIX_C_SOURCE 200809L

#include "emit_internal.h"
#include "io/file/output_file_internal.h"
#include "io/file/system_error_internal.h"

#include "imukit/output_file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { FILES = 3, PATH_SIZE = 4096, VECTORS_MAX = 1000000 };

static const uint32_t settings_cookie = 0x66776631; /* "fwf1" */

static const char *const endings[FILES] = {".h", ".c", "_test.c"};

imk_firmware_file_settings imk_firmware_file_default(void)
{
    return (imk_firmware_file_settings){.cookie = settings_cookie, .vectors = 64};
}

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

void imk_firmware_name(const imk_firmware_file_settings *settings, const imk_model *model,
                       char name[IMK_FIRMWARE_NAME_MAX])
{
    size_t length;
    if (settings->name) {
        snprintf(name, IMK_FIRMWARE_NAME_MAX, "%s", settings->name);
        return;
    }
    length = (size_t)snprintf(name, IMK_FIRMWARE_NAME_MAX, "imukit_");
    for (const char *c = model->name; *c && length + 1 < IMK_FIRMWARE_NAME_MAX; c++) {
        const bool capital = *c >= 'A' && *c <= 'Z';
        if (is_letter(*c) || is_digit(*c))
            name[length++] = capital ? (char)(*c - 'A' + 'a') : *c;
        else if (name[length - 1] != '_')
            name[length++] = '_';
    }
    while (name[length - 1] == '_')
        length--;
    name[length] = '\0';
    if (strcmp(name, "imukit") == 0)
        snprintf(name, IMK_FIRMWARE_NAME_MAX, "imukit_unit");
}

static imk_status check(const imk_firmware *firmware, const imk_firmware_file_settings *settings,
                        imk_error *error)
{
    const char *name = settings->name;
    if (settings->cookie != settings_cookie)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "settings", "",
                             "settings from imk_firmware_file_default()");
    if (firmware->cookie == 0)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "firmware", "",
                             "a plan from imk_firmware_plan()");
    if (settings->vectors < 1 || settings->vectors > VECTORS_MAX)
        return imk_error_set(error, IMK_ERROR_RANGE, "vectors", "", "a number from 1 to 1000000");
    bool good = !name || is_letter(name[0]) || name[0] == '_';
    for (const char *c = name; good && c && *c; c++)
        good = is_letter(*c) || is_digit(*c) || *c == '_';
    if (!good || (name && strlen(name) >= IMK_FIRMWARE_NAME_MAX))
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "prefix", name,
                             "a name of letters, digits and _, at most 47, that does not begin "
                             "with a digit");
    return IMK_OK;
}

/* A file that is there already must be one of ours. */
static imk_status check_owner(const char *path, imk_error *error)
{
    char first[sizeof IMKI_EMIT_MARK] = "";
    FILE *file = fopen(path, "rb");
    if (!file)
        return IMK_OK; /* what else is wrong with it shows when it is written */
    const size_t got = fread(first, 1, sizeof first - 1, file);
    fclose(file);
    if (got == sizeof first - 1 && strcmp(first, IMKI_EMIT_MARK) == 0)
        return IMK_OK;
    return imk_error_set(error, IMK_ERROR_CONFLICT, path,
                         "this file was not made by --emit-c and is not replaced",
                         "give another --prefix or directory");
}

static imk_status make_directory(const char *directory, bool *made, imk_error *error)
{
    *made = mkdir(directory, 0777) == 0;
    if (*made || errno == EEXIST)
        return IMK_OK;
    return imki_system_error(error, IMK_ERROR_OPEN, directory, errno);
}

static imk_status write_files(const char *directory, const char *name, const imki_text *texts,
                              imk_error *error)
{
    char path[FILES][PATH_SIZE];
    imk_output_file *file[FILES] = {NULL};
    bool made;
    imk_status status = make_directory(directory, &made, error);
    for (int i = 0; i < FILES && status == IMK_OK; i++) {
        const int length = snprintf(path[i], PATH_SIZE, "%s/%s%s", directory, name, endings[i]);
        status = length >= PATH_SIZE
                     ? imk_error_set(error, IMK_ERROR_OPEN, directory, "the name is too long",
                                     "choose a shorter directory or --prefix")
                     : check_owner(path[i], error);
    }
    for (int i = 0; i < FILES && status == IMK_OK; i++) {
        status = imk_output_file_open(path[i], &file[i], error);
        /* A failed write is reported by commit. */
        if (status == IMK_OK)
            (void)imk_output_file_write(file[i], texts[i].bytes, texts[i].size);
    }
    /* All are made ready before the first appears: they belong together. */
    for (int i = 0; i < FILES && status == IMK_OK; i++) {
        status = imki_output_file_prepare(file[i], error);
        if (status != IMK_OK)
            file[i] = NULL;
    }
    for (int i = 0; i < FILES; i++) {
        if (status == IMK_OK)
            status = imk_output_file_commit(file[i], error);
        else
            imk_output_file_abandon(file[i]);
    }
    if (made && status != IMK_OK)
        (void)rmdir(directory); /* it stays when a file is in it */
    return status;
}

imk_status imk_firmware_write(const char *directory, const imk_firmware *firmware,
                              const imk_model *model, const imk_firmware_file_settings *settings,
                              imk_error *error)
{
    const imk_firmware_file_settings usual = imk_firmware_file_default();
    const imk_firmware_file_settings *with = settings ? settings : &usual;
    imki_text texts[FILES] = {{.bytes = NULL}};
    char name[IMK_FIRMWARE_NAME_MAX];
    imki_emission emission = {
        .plan = firmware, .model = model, .name = name, .vectors = with->vectors};
    imk_status status = check(firmware, with, error);
    if (status != IMK_OK)
        return status;
    imk_firmware_name(with, model, name);
    emission.out = &texts[0];
    imki_emit_header(&emission);
    emission.out = &texts[1];
    imki_emit_source(&emission);
    emission.out = &texts[2];
    status = imki_emit_test(&emission, error);
    for (int i = 0; i < FILES && status == IMK_OK; i++)
        if (texts[i].failed)
            status = imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    if (status == IMK_OK)
        status = write_files(directory, name, texts, error);
    for (int i = 0; i < FILES; i++)
        free(texts[i].bytes);
    return status;
}
