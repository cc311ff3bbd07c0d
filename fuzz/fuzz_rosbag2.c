/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzz entry point of bags of ROS 2: a database, or else the text of a metadata.yaml.
 * Reads: src/io/log/ros/log_rosbag2.c src/io/log/ros/log_rosbag2_db.c
 * src/io/log/ros/log_rosbag2_metadata.c src/io/log/ros/log_sqlite.c */
#include "bags.h"
#include "io/log/ros/log_rosbag2_internal.h"

#include <string.h>

static void check_metadata(const char *text, size_t size)
{
    imki_rosbag2 *bag = calloc(1, sizeof *bag);
    imk_error error = {.status = IMK_OK};
    if (!bag)
        return;
    const imk_status status = imki_rosbag2_metadata(bag, "folder", text, size, &error);
    require_told(status, &error);
    for (size_t i = 0; i < bag->file_count; i++) {
        /* No name leads out of the folder. */
        require(strncmp(bag->files[i], "folder/", 7) == 0 && !strchr(bag->files[i] + 7, '/'));
        free(bag->files[i]);
    }
    free(bag->files);
    imki_ros_close(&bag->log);
    free(bag);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size >= 6 && memcmp(data, "SQLite", 6) == 0)
        bags_check(data, size, "rosbag2");
    else
        check_metadata((const char *)data, size);
    return 0;
}
