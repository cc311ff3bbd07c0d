/* SPDX-License-Identifier: Apache-2.0 */
/* Files that are known but not read are named, with the way to export them; texts and logs that are
 * read are not taken for them. */
#include "check.h"

#include "imukit/log.h"

#include <stdio.h>
#include <string.h>

#define BYTES(text) text, sizeof text - 1

static imk_status open_bytes(const char *bytes, size_t size, imk_error *error)
{
    imk_log_settings settings = imk_log_default();
    imk_log_reader *reader = NULL;
    settings.rate = 1.0;
    const imk_status status = imk_log_open_memory(bytes, size, &settings, &reader, error);
    imk_log_close(reader);
    return status;
}

/* The beginnings are those of the definitions of the formats. */
static void known_kinds_are_named(void **state)
{
    static const struct {
        const char *bytes;
        size_t size;
        const char *name, *remedy;
    } files[] = {
        {BYTES("PAR1\x15\x04\x15"), "Parquet", "read_parquet"},
        {BYTES("ARROW1\0\0"), "Arrow", "read_feather"},
        {BYTES("PK\x03\x04\x14\0\6\0xl/workbook.xml"), ".xlsx", "save it as CSV"},
        {BYTES("PK\x03\x04\x14\0\0\0log.csv"), "zip", "unzip"},
        {BYTES("\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1"), ".xls", "save it as CSV"},
        {BYTES("H Product:Blackbox flight data recorder by Nicholas Sherlock\nH Data version:2\n"),
         "Blackbox", "blackbox_decode"},
        {BYTES("#ROSRECORD V1.2\nversion 1.2\n"), "ROS bag", "rosbag"},
        {BYTES("#ROSBAG V1.3\n"), "ROS bag", "rosbag"},
        {BYTES("TDSm\x0E\0\0\0"), "TDMS", "nptdms"},
        {BYTES("\xFA\xFF\x3E\0\xC3"), "Xsens", "MT Manager"}, /* WakeUp: FF + 3E + 00 + C3 = 200 */
        {BYTES("\0\0\0\x18"
               "ftypmp42"),
         ".mp4", "CSV"},
        {BYTES("RIFF\x24\0\0\0WAVEfmt "), ".wav", "CSV"},
        {BYTES("\x80\x04\x95\x10\0\0\0"), "pickle", "CSV"},
        {BYTES("RDX3\nX\n\0\0\0\3"), ".rda", "write.csv"},
        {BYTES("X\n\0\0\0\3"), ".rds", "write.csv"},
        {BYTES("\x89PNG\r\n\x1A\n"), ".png", "log"},
        {BYTES("\xFF\xD8\xFF\xE0"), ".jpg", "log"},
        {BYTES("%PDF-1.4\n"), "PDF", "log"},
        {BYTES("{\"t\": 0, \"g\": [1, 2]}\n{\"t\": 1, \"g\": [1, 2]}\n"), "in each line",
         "json.loads"},
        {BYTES("{\"t\":0}\r\n{\"t\":1}\r\n"), "in each line", "json.loads"},
        {BYTES("[{\"time\": 0.0, \"gyro_x\": 1}, {\"time\": 1.0"), "JSON", "json.load("},
        {BYTES("\xEF\xBB\xBF{\n  \"rows\": [\n"), "JSON", "json.load("},
        {BYTES("[[0, 1, 2],\n [1, 1, 2]]\n"), "JSON", "json.load("},
        {BYTES("<?xml version=\"1.0\"?>\n<gpx>\n"), "XML", "CSV"},
        {BYTES("\n<!DOCTYPE html>\n"), "HTML", "CSV"},
        {BYTES("header:\n  stamp:\n    sec: 1\nangular_velocity:\n  x: 1\n"), "YAML", "bag"},
        {BYTES("---\r\nheader:\r\n  seq: 1\r\n"), "YAML", "bag"},
        {BYTES("\xFD\x37zXZ\0\0\4"), "by xz", "xz -dk FILE"},
        {BYTES("BZh9\x31\x41\x59\x26\x53\x59"), "by bzip2", "bzip2 -dk FILE"},
        {BYTES("\x04\x22\x4D\x18\x64\x40\xA7"), "by lz4", "lz4 -d FILE NEW"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        imk_error error = {.status = IMK_OK};
        check_status(open_bytes(files[i].bytes, files[i].size, &error), IMK_ERROR_UNSUPPORTED,
                     files[i].name, __FILE__, __LINE__);
        assert_non_null(strstr(error.found, files[i].name));
        assert_non_null(strstr(error.expected, files[i].remedy));
    }
    char tar[512] = "log.csv";
    imk_error error;
    memcpy(tar + 257, "ustar", 6);
    CHECK_STATUS(open_bytes(tar, sizeof tar, &error), IMK_ERROR_UNSUPPORTED);
    assert_non_null(strstr(error.found, "tar"));
}

static void others_are_not(void **state)
{
    static const struct {
        const char *bytes;
        size_t size;
        imk_status status;
    } files[] = {
        {BYTES("gyro_x [deg/s]\n1\n2\n"), IMK_OK},
        {BYTES("# PAR1\ngyro_x [deg/s]\n1\n"), IMK_OK},
        {BYTES("gyro_x [deg/s]\n1\n2"), IMK_OK},
        {BYTES("H,gyro_x [deg/s]\n1,2\n"), IMK_OK},
        {BYTES("[a],gyro_x [deg/s]\n1,2\n2,2\n"), IMK_OK}, /* a name in brackets */
        {BYTES("{a},gyro_x_dps\n1,2\n2,2\n"), IMK_OK},
        {BYTES("gyro_x_dps:\n  1\n  2\n"), IMK_OK}, /* a single column */
        {BYTES("{\r\n"), IMK_ERROR_COLUMN},
        {BYTES("\xFA\xFF\x3E\0\xC4\0"), IMK_ERROR_FORMAT},     /* the sum is wrong */
        {BYTES("\xFA\xFF\x3E\x20\xC3\0"), IMK_ERROR_FORMAT},   /* it is not whole */
        {BYTES("\x80\x09\x95\0"), IMK_ERROR_FORMAT},           /* no such protocol */
        {BYTES("\0\0\0\0\0\0\0\0\0\0\0\0"), IMK_ERROR_FORMAT}, /* nothing */
    };
    (void)state;
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        imk_error error = {.status = IMK_OK};
        check_status(open_bytes(files[i].bytes, files[i].size, &error), files[i].status,
                     files[i].bytes, __FILE__, __LINE__);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_kinds_are_named),
        cmocka_unit_test(others_are_not),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
