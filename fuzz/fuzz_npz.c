/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzz entry point of .npz files.
 * Reads: src/io/log/arrays/log_npz.c src/io/log/arrays/zip_directory.c
 * src/io/log/npy.c
 * src/io/log/arrays/packed_part.c src/io/log/arrays/array_strips.c
 * src/io/log/arrays/array_rows.c src/io/log/arrays/array_choose.c
 * src/io/log/arrays/array_list.c */
#include "harness.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const uint32_t choice = choice_of(data, size);
    imk_log_settings settings = imk_log_default();
    settings.format = "npz";
    settings.rate = choice & 1 ? 100.0 : 0.0;
    if (choice & 6) {
        settings.time_unit = "ms";
        settings.gyro_unit = "deg/s";
        settings.accel_unit = "g";
    }
    settings.columns = choice & 8 ? "time [s],gyro_x [deg/s],-" : NULL;
    read_log(input_file_put(INPUT_TABLE, data, size), &settings, choice / 16);
    return 0;
}
