/* SPDX-License-Identifier: Apache-2.0 */
/* MCAP files as logs. */
#include "log_mcap_internal.h"
#include "log_mcap_write_internal.h"

#include <stdlib.h>

typedef struct state {
    imki_ros_log log;
    imki_mcap mcap;
} state;

static imk_status next(imki_ros_log *log, imki_ros_message *message, bool *found, imk_error *error)
{
    return imki_mcap_next(&((state *)log)->mcap, message, found, error);
}

static imk_status back(imki_ros_log *log, imk_error *error)
{
    ((state *)log)->mcap.inside.at = NULL;
    return imki_ros_back(log, error);
}

static imk_status open_mcap(imk_log_reader *reader, imk_error *error)
{
    static const imki_ros_container container = {next, back, imki_mcap_shape};
    state *s = calloc(1, sizeof *s);
    reader->state = s;
    if (!s)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    s->log = (imki_ros_log){.container = &container, .reader = reader, .text = &reader->text};
    s->mcap.log = &s->log;
    imk_status status = imki_mcap_start(&s->mcap, error);
    if (status == IMK_OK && imki_ros_can_seek(&s->log)) {
        status = imki_mcap_summary_read(&s->mcap, &s->log.indexed, error);
        s->log.counted = s->log.indexed;
        if (!s->log.indexed)
            imki_ros_topic_uncount(&s->log);
    }
    return status == IMK_OK ? imki_ros_open(&s->log, error) : status;
}

static imk_status seek(imk_log_reader *reader, double fraction, imk_error *error)
{
    return imki_mcap_go(&((state *)imki_ros_log_of(reader))->mcap, fraction, error);
}

static void close_mcap(imk_log_reader *reader)
{
    state *s = reader->state;
    if (!s)
        return;
    imki_mcap_stop(&s->mcap);
    imki_ros_close(&s->log);
}

const imki_log_codec imki_log_mcap = {.defines_units = true,
                                      .open = open_mcap,
                                      .read = imki_ros_read,
                                      .close = close_mcap,
                                      .seek = seek,
                                      .create = imki_mcap_create,
                                      .begin = imki_mcap_begin,
                                      .format = imki_log_format_matrix,
                                      .write = imki_mcap_write,
                                      .end = imki_mcap_end,
                                      .discard = imki_mcap_discard};
