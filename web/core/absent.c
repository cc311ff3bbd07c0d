/* SPDX-License-Identifier: Apache-2.0 */
/* What a page has not: threads, processes, pipes, gnuplot, HDF5 and SQLite. Functions that would
 * use them do without or say so. */
#include "campaign/campaign_run.h"
#include "drift/drift_parts.h"

#include "base/text_internal.h"
#include "imukit/figure_file.h"
#include "imukit/memory_limit.h"
#include "imukit/names.h"
#include "imukit/thread_pool.h"
#include "io/file/input_copy_internal.h"
#include "io/file/leftovers_internal.h"
#include "io/file/nameless_file_internal.h"
#include "io/file/output_packing_internal.h"
#include "io/foreign/parameter_internal.h"
#include "io/log/log_formats_internal.h"
#include "io/log/log_reader_internal.h"
#include "io/log/ros/log_mcap_write_internal.h"
#include "io/plot/drawing_program_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

/* ---- threads: one ------------------------------------------------------------------------- */

imk_thread_pool *imk_thread_pool_create(size_t threads)
{
    (void)threads;
    return NULL;
}

void imk_thread_pool_destroy(imk_thread_pool *pool)
{
    (void)pool;
}

size_t imk_thread_pool_threads(const imk_thread_pool *pool)
{
    (void)pool;
    return 1;
}

static void run_serial(void *context, size_t count, imk_work work, void *work_context)
{
    (void)context;
    for (size_t i = 0; i < count; i++)
        work(work_context, i);
}

imk_executor imk_thread_pool_executor(imk_thread_pool *pool)
{
    (void)pool;
    return (imk_executor){.run = run_serial, .context = NULL, .threads = 1};
}

size_t imk_memory_limit(void)
{
    return (size_t)4000 * 1024 * 1024; /* of the addresses of 32 bits */
}

/* ---- signals and what they would leave ------------------------------------------------------ */

void imki_signals_hold(sigset_t *before)
{
    *before = 0;
}

void imki_signals_release(const sigset_t *before)
{
    (void)before;
}

int imki_leftover_add(const char *name)
{
    (void)name;
    return -1;
}

void imki_leftover_drop(int slot)
{
    (void)slot;
}

void imk_output_file_abandon_all(void) {}

/* ---- pipes, temporary files ----------------------------------------------------------------- */

imk_status imki_copy_make(const struct stat *about, int file, const char *path,
                          imki_known_bytes *known, const void *context, imk_error *error)
{
    (void)about, (void)file, (void)known, (void)context;
    return imk_error_set(error, IMK_ERROR_UNSUPPORTED, path, "a stream that is read twice",
                         "a file");
}

imk_status imki_copy_open(const struct stat *about, bool kept, int *file, imk_error *error)
{
    (void)about, (void)kept, (void)error;
    *file = -1;
    return IMK_OK;
}

imk_status imki_nameless_write(int file, const char *bytes, size_t size, const char *path,
                               imk_error *error)
{
    (void)file, (void)bytes, (void)size;
    return imk_error_set(error, IMK_ERROR_UNSUPPORTED, path, "a stream that is read twice",
                         "a file");
}

/* In memory, as all files here. */
int imki_open_nameless(void)
{
    static const char name[] = ".nameless";
    const int file = open(name, O_RDWR | O_CREAT | O_EXCL);
    if (file >= 0)
        unlink(name);
    return file;
}

/* There are no links, and one folder: a name is what it says. */
char *realpath(const char *path, char *resolved)
{
    while (path[0] == '/' || (path[0] == '.' && path[1] == '/'))
        path++;
    const size_t size = strlen(path) + 1;
    char *place = resolved ? resolved : malloc(size);
    return place ? memcpy(place, path, size) : NULL;
}

/* One process, and no permissions. */
pid_t getpid(void)
{
    return 1;
}

int fchmod(int file, mode_t mode)
{
    (void)file, (void)mode;
    return 0;
}

/* ---- programs and libraries ------------------------------------------------------------------ */

bool imki_drawing_possible(imki_terminal terminal)
{
    (void)terminal;
    return false;
}

imk_status imki_drawing_make(const imk_figure *figure, imki_drawing *drawing, char **image,
                             size_t *size, imk_error *error)
{
    (void)figure, (void)drawing, (void)image, (void)size;
    return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "plot", "another program",
                         "a name ending in .svg");
}

static imk_status refuse(imk_log_reader *reader, imk_error *error)
{
    (void)reader;
    return imk_error_set(error, IMK_ERROR_UNSUPPORTED, NULL, "a format that the page cannot read",
                         "a file that the command has converted: imukit convert LOG out.npz");
}

static imk_status refuse_writing(imki_log_output *log, const char *path, imk_error *error)
{
    (void)log;
    return imk_error_set(error, IMK_ERROR_UNSUPPORTED, path,
                         "a format that the page does not write",
                         "a name ending in .csv, .npy, .npz, .mat or .bag, or the command");
}

const imki_log_codec imki_log_hdf5 = {.open = refuse, .create = refuse_writing};
const imki_log_codec imki_log_rosbag2 = {.open = refuse, .create = refuse_writing};

/* Compressed files are read, not written. */
imk_status imki_packing_start(const char *path, imki_packing **packing, imk_error *error)
{
    *packing = NULL;
    if (!imk_has_ending(path, ".gz") && !imk_has_ending(path, ".zst"))
        return IMK_OK;
    return imk_error_set(error, IMK_ERROR_UNSUPPORTED, path,
                         "compressed files, which the page does not write",
                         "a name without .gz or .zst, or the command");
}

int imki_packing_step(imki_packing *packing, const unsigned char **bytes, size_t *size, bool last,
                      unsigned char *room, size_t room_size, size_t *used, bool *more)
{
    (void)packing, (void)bytes, (void)size, (void)last, (void)room, (void)room_size, (void)used;
    *more = false;
    return ENOTSUP;
}

void imki_packing_free(imki_packing *packing)
{
    (void)packing;
}

imk_status imki_mcap_create(imki_log_output *log, const char *path, imk_error *error)
{
    return refuse_writing(log, path, error);
}

void imki_mcap_begin(imki_log_output *log)
{
    (void)log;
}

imk_status imki_mcap_write(imki_log_output *log, const char *bytes, size_t size, size_t rows)
{
    (void)log, (void)bytes, (void)size, (void)rows;
    return IMK_ERROR_UNSUPPORTED;
}

imk_status imki_mcap_end(imki_log_output *log, imk_error *error)
{
    (void)log;
    return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "", "", "");
}

void imki_mcap_discard(imki_log_output *log)
{
    (void)log;
}

/* Called by bzip2 for a mistake of its own. */
void bz_internal_error(int number);
void bz_internal_error(int number)
{
    (void)number;
    abort();
}

/* ---- XML, campaigns ------------------------------------------------------------------------- */

static void refuse_gazebo(imki_parameters *p)
{
    p->status = imk_error_set(p->error, IMK_ERROR_UNSUPPORTED, NULL, "Gazebo's SDF",
                              "another format: this one is for the command");
}

void imki_gazebo_read(imki_parameters *p)
{
    refuse_gazebo(p);
}

void imki_gazebo_write(imki_parameters *p)
{
    refuse_gazebo(p);
}

size_t campaign_threads(uint64_t asked)
{
    (void)asked;
    return 1;
}

int drift_runs(const drift_options *o, const drift_scene *scene, imk_drift_models *r)
{
    (void)o, (void)scene, (void)r;
    return command_failed("--monte-carlo is for the command, not for the page");
}

int drift_results(const drift_options *o, const char *path)
{
    (void)o, (void)path;
    return command_failed("results of runs are for the command, not for the page");
}
