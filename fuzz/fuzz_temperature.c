/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzz entry point of temperature profiles: scripts, and constants, which begin as numbers do. What
 * is read is a valid profile.
 * Reads: src/io/motion/temperature_file.c src/io/motion/step_text.c */
#include "harness.h"

#include "imukit/motion_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CONSTANT_MAX = 100, TIMES = 4 };

static void check(const char *path)
{
    imk_temperature_file *file = NULL;
    imk_error error = {.status = IMK_OK};
    const imk_status status = imk_temperature_read(path, &file, &error);
    require_told(status, &error);
    require((file != NULL) == (status == IMK_OK));
    if (!file)
        return;
    const imk_temperature_profile *profile = imk_temperature_file_profile(file);
    require(imk_temperature_validate(profile, NULL) == IMK_OK);
    const double last = profile->time[profile->point_count - 1];
    const double time[TIMES] = {0.0, 0.25 * last, 0.5 * last, last};
    double temperature[TIMES], rate[TIMES];
    imk_temperature_at(profile, TIMES, time, temperature, rate);
    for (int i = 0; i < TIMES; i++)
        require(isfinite(temperature[i]) && !isnan(rate[i]));
    imk_temperature_file_free(file);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char text[CONSTANT_MAX + 1];
    if (size > 0 && size <= CONSTANT_MAX && data[0] >= '0' && data[0] <= '9') {
        memcpy(text, data, size);
        text[size] = '\0';
        check(text);
    } else {
        check(input_file_put(INPUT_SCRIPT, data, size));
    }
    return 0;
}
