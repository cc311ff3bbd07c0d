/* SPDX-License-Identifier: Apache-2.0 */
/* The frames that the messages of a topic name. Sensors that publish on one topic look like one in
 * all else: their rows follow each other, and the times are even. */
#include "imukit/utf8.h"
#include "log_ros_internal.h"

#include <stdio.h>

/* Texts of strangers, for a message. */
static void copy_frame(const imki_imu *imu, char *text, size_t size)
{
    char whole[IMKI_ROS_FRAME];
    const size_t most = sizeof whole - 1;
    const size_t length = imu->frame_size < most ? imu->frame_size : most;
    for (size_t i = 0; i < length; i++)
        whole[i] = imu->frame[i] < 32 || imu->frame[i] == 127 ? '?' : (char)imu->frame[i];
    whole[length] = '\0';
    imk_utf8_shorten(whole, text, size);
}

/* In quotes, if it is not among them; "..." for those that have no room. */
static void add_frame(const imki_imu *imu, char *frames, size_t size)
{
    static const char more[] = ", ...";
    char text[28], quoted[32];
    const size_t length = strlen(frames);
    copy_frame(imu, text, sizeof text);
    snprintf(quoted, sizeof quoted, "\"%s\"", text);
    if (strstr(frames, quoted) || strstr(frames, more))
        return;
    const bool room = length + strlen(quoted) + 2 + sizeof more <= size;
    if (length == 0 || room)
        snprintf(frames + length, size - length, "%s%s", length > 0 ? ", " : "", quoted);
    else
        snprintf(frames + length, size - length, "%s", more);
}

void imki_ros_frame_note(imki_ros_log *log, const imki_imu *imu)
{
    imk_log_reader *reader = log->reader;
    if (!log->frame_known) {
        log->frame_known = true;
        log->frame_size = imu->frame_size;
        log->frame_mask =
            imu->frame_size < 8 ? (UINT64_C(1) << 8 * imu->frame_size) - 1 : UINT64_MAX;
        memcpy(log->frame, imu->frame, imki_ros_frame_compared(imu));
        reader->frames[0] = '\0';
    } else {
        reader->other_frames++;
    }
    add_frame(imu, reader->frames, sizeof reader->frames);
}
