/* SPDX-License-Identifier: Apache-2.0 */
/* Temporary files beside their targets.
 *
 * The temporary file of DIR/NAME is DIR/.NAME.<process>.<number>.part, made with O_EXCL: no random
 * numbers, and a file left by a killed process only makes the number go up. */
#define _POSIX_C_SOURCE 200809L
#define _XOPEN_SOURCE 700
#include "output_target_internal.h"

#include "descriptor_name_internal.h"
#include "leftovers_internal.h"
#include "system_error_internal.h"

#include "imukit/utf8.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    NAME_SIZE = 4096, /* PATH_MAX of Linux */
    LINKS_MAX = 40,   /* as Linux itself follows */
    ATTEMPTS_MAX = 10000
};

/* Directory part of a path with its slash, as a length. */
static size_t directory_length(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash - path) + 1 : 0;
}

/* The path behind all symbolic links, which need not exist (realpath() would demand it).
 * @return from malloc(); NULL with errno */
static char *follow_links(const char *path)
{
    char *current = strdup(path);
    for (int links = 0; current && links < LINKS_MAX; links++) {
        char link[NAME_SIZE];
        const ssize_t length = readlink(current, link, sizeof link);
        if (length < 0 && (errno == EINVAL || errno == ENOENT)) /* no link, or nothing there */
            return current;
        if (length < 0 || length == sizeof link) {
            const int number = length < 0 ? errno : ENAMETOOLONG;
            free(current);
            errno = number;
            return NULL;
        }
        const size_t directory = link[0] == '/' ? 0 : directory_length(current);
        char *next = malloc(directory + (size_t)length + 1);
        if (next) {
            memcpy(next, current, directory);
            memcpy(next + directory, link, (size_t)length);
            next[directory + (size_t)length] = '\0';
        }
        free(current);
        current = next;
    }
    const int number = current ? ELOOP : ENOMEM;
    free(current);
    errno = number;
    return NULL;
}

/* Make the temporary file. @return 0 or an errno value */
static int make_temporary(imki_target *target, mode_t mode)
{
    static atomic_uint count;
    const int directory = (int)directory_length(target->name);
    const size_t size = strlen(target->name) + 64;
    target->temporary = malloc(size);
    if (!target->temporary)
        return ENOMEM;
    sigset_t before;
    imki_signals_hold(&before);
    for (int attempt = 0; attempt < ATTEMPTS_MAX; attempt++) {
        /* Half of a name of the greatest length leaves room for what is added. */
        snprintf(target->temporary, size, "%.*s.%.*s.%ld.%u.part", directory, target->name,
                 NAME_MAX / 2, target->name + directory, (long)getpid(),
                 atomic_fetch_add(&count, 1u));
        target->file = open(target->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
        if (target->file >= 0 || errno != EEXIST)
            break;
    }
    const int number = target->file >= 0 ? 0 : errno;
    if (number == 0)
        target->slot = imki_leftover_add(target->temporary);
    imki_signals_release(&before);
    if (number != 0) {
        free(target->temporary);
        target->temporary = NULL;
    }
    return number;
}

/* A temporary file for a target that exists or not. */
static int open_beside(imki_target *target)
{
    struct stat about;
    const bool exists = stat(target->name, &about) == 0;
    if (!exists && errno != ENOENT)
        return errno;
    if (exists && S_ISDIR(about.st_mode))
        return EISDIR;
    if (target->name[directory_length(target->name)] == '\0')
        return target->name[0] == '\0' ? ENOENT : EISDIR;
    if (exists && access(target->name, W_OK) != 0)
        return errno;
    const int number = make_temporary(target, 0666);
    if (number == 0 && exists)
        fchmod(target->file, about.st_mode & 0777); /* not every file system has permissions */
    return number;
}

/* A pipe or a device, and a stream that is open already, whatever it leads to: others may have
 * written to it before. @return 0, an errno value, or -1: it is a file, or to become one */
static int open_stream(imki_target *target, const char *path)
{
    struct stat about;
    const int number = imki_descriptor_named(path);
    if (number < 0 && (stat(path, &about) != 0 || S_ISREG(about.st_mode) || S_ISDIR(about.st_mode)))
        return -1;
    fflush(stdout);
    target->file = number >= 0 ? fcntl(number, F_DUPFD_CLOEXEC, 0)
                               : open(path, O_WRONLY | O_CLOEXEC | O_NOCTTY);
    return target->file < 0 ? errno : 0;
}

int imki_target_open(imki_target *target, const char *path)
{
    *target = (imki_target){.file = -1, .slot = -1, .standard = strcmp(path, "-") == 0};
    target->path = strdup(target->standard ? "standard output" : path);
    if (!target->path)
        return ENOMEM;
    int number = 0;
    if (target->standard) {
        fflush(stdout);
        target->file = STDOUT_FILENO;
    } else if ((number = open_stream(target, path)) < 0) {
        target->name = follow_links(path);
        number = target->name ? open_beside(target) : errno;
    }
    if (number != 0)
        imki_target_close(target);
    return number;
}

/* Of a file that cannot be made beside the others in its folder. */
static imk_status refuse_folder(const char *path, char *name, int number, imk_error *error)
{
    struct stat about;
    imk_error reason;
    char shown[40], found[sizeof reason.found];
    const size_t length = directory_length(name);
    if (name[length] == '\0')
        return imk_error_set(error, IMK_ERROR_OPEN, path, "this is the name of a folder",
                             "a file name");
    name[length > 1 ? length - 1 : length] = '\0';
    const char *folder = length > 0 ? name : ".";
    imk_utf8_shorten(folder, shown, sizeof shown);
    if (stat(folder, &about) != 0 && errno == ENOENT) {
        snprintf(found, sizeof found, "the folder %s does not exist", shown);
        return imk_error_set(error, IMK_ERROR_OPEN, path, found,
                             "create this folder, or choose another");
    }
    (void)imki_system_error(&reason, IMK_ERROR_OPEN, "", number);
    snprintf(found, sizeof found, "the folder %s cannot be written: %.25s", shown, reason.found);
    return imk_error_set(error, IMK_ERROR_OPEN, path, found, "choose another folder");
}

imk_status imki_target_refuse(const char *path, int number, imk_error *error)
{
    struct stat about;
    if (number == ENOMEM)
        return imk_error_set(error, IMK_ERROR_MEMORY, path, "", "");
    const bool of_folder = number == ENOENT || number == EACCES || number == EPERM ||
                           number == EROFS || number == EISDIR;
    char *name = of_folder ? follow_links(path) : NULL;
    const bool refused =
        name && stat(name, &about) == 0 && (S_ISDIR(about.st_mode) || access(name, W_OK) != 0);
    const imk_status status = name && name[0] != '\0' && !refused
                                  ? refuse_folder(path, name, number, error)
                                  : imki_system_error(error, IMK_ERROR_OPEN, path, number);
    free(name);
    return status;
}

int imki_target_check(const char *path)
{
    struct stat about;
    imki_target target;
    if (strcmp(path, "-") == 0 || imki_descriptor_named(path) >= 0)
        return 0;
    if (stat(path, &about) == 0 && !S_ISREG(about.st_mode) && !S_ISDIR(about.st_mode))
        return S_ISSOCK(about.st_mode) ? ENXIO : 0;
    const int number = imki_target_open(&target, path);
    if (number == 0)
        imki_target_close(&target);
    return number;
}

/* Make the rename durable. Failure is no reason to report: the file is complete and in its place;
 * only a power cut within seconds could bring the old one back. */
static void sync_directory(const char *name)
{
    char *directory = strdup(name);
    if (!directory)
        return;
    directory[directory_length(name)] = '\0';
    const int file = open(directory[0] ? directory : ".", O_RDONLY | O_CLOEXEC);
    if (file >= 0) {
        fsync(file);
        close(file);
    }
    free(directory);
}

int imki_target_publish(imki_target *target)
{
    if (target->standard)
        return 0;
    const int closed = close(target->file);
    target->file = -1;
    if (closed != 0 && errno != EINTR)
        return errno;
    if (!target->temporary)
        return 0;
    if (rename(target->temporary, target->name) != 0)
        return errno;
    imki_leftover_drop(target->slot);
    sync_directory(target->name);
    free(target->temporary);
    target->temporary = NULL;
    return 0;
}

void imki_target_close(imki_target *target)
{
    if (target->file >= 0 && !target->standard)
        close(target->file);
    if (target->temporary) {
        unlink(target->temporary);
        imki_leftover_drop(target->slot);
    }
    free(target->path);
    free(target->name);
    free(target->temporary);
    *target = (imki_target){.file = -1, .slot = -1};
}
