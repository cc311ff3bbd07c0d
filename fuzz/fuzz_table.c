/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzz entry point of tables that are loaded whole: poses, recorded rates and forces, temperatures.
 * What is read is a valid motion or profile.
 * Reads: src/io/log/log_load.c src/io/motion/motion_table.c src/io/motion/pose_columns.c
 * src/io/motion/recorded_motion.c */
#include "harness.h"

#include "imukit/motion_file.h"

#include <math.h>
#include <stdlib.h>

static void check_motion(const imk_motion_file *file)
{
    const imk_motion *motion = imk_motion_file_motion(file);
    require(imk_motion_file_duration(file) > 0.0 && isfinite(imk_motion_file_duration(file)));
    if (motion->trajectory) {
        require(imk_motion_file_kind(file) == IMK_MOTION_POSES);
        require(imk_trajectory_validate(motion->trajectory, NULL) == IMK_OK);
    } else {
        require(imk_motion_file_kind(file) == IMK_MOTION_RECORDED);
        require(motion->recorded->count >= 2 && motion->recorded->rate > 0.0);
    }
}

static void check_temperature(const imk_temperature_file *file)
{
    const imk_temperature_profile *profile = imk_temperature_file_profile(file);
    require(imk_temperature_validate(profile, NULL) == IMK_OK);
    double last;
    imk_temperature_at(profile, 1, &profile->time[profile->point_count - 1], &last, NULL);
    require(isfinite(last));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const uint32_t choice = choice_of(data, size);
    const char *path = input_file_put(INPUT_TABLE, data, size);
    imk_log_settings settings = imk_log_default();
    imk_motion_file *motion = NULL;
    imk_temperature_file *temperature = NULL;
    imk_error error = {.status = IMK_OK};
    settings.rate = choice % 4 == 0 ? 100.0 : 0.0;
    settings.axes = choice % 8 < 6 ? NULL : "right-forward-up";
    imk_status status = imk_motion_read(path, &settings, NULL, 1, &motion, &error);
    require_told(status, &error);
    if (motion)
        check_motion(motion);
    imk_motion_file_free(motion);
    if (status != IMK_ERROR_COLUMN) /* no table of temperatures */
        return 0;
    error = (imk_error){.status = IMK_OK};
    status = imk_temperature_read(path, &temperature, &error);
    require_told(status, &error);
    if (temperature)
        check_temperature(temperature);
    imk_temperature_file_free(temperature);
    return 0;
}
