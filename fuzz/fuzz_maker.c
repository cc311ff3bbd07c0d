/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzz entry point of makers' messages. Which format it is follows from the bytes, or from a name
 * at their beginning ("ubx:"). Checksums are corrected in half of the inputs, because anybody could
 * compute the right ones.
 * Reads: src/io/log/maker/messages.c src/io/log/maker/log_novatel.c src/io/log/maker/log_sbg.c
 * src/io/log/maker/log_ubx.c src/io/log/maker/log_vectornav.c src/io/log/maker/foreign_kinds.c */
#include "harness.h"

#include "imukit/log.h"

#include <stdio.h>
#include <string.h>

enum { ROWS = 64 };

static void put_little(uint8_t *at, uint32_t number, size_t size)
{
    for (size_t i = 0; i < size; i++)
        at[i] = (uint8_t)(number >> 8 * i);
}

static uint32_t crc_of(const uint8_t *bytes, size_t size, uint32_t polynomial)
{
    uint32_t crc = 0;
    for (size_t i = 0; i < size; i++) {
        crc ^= bytes[i];
        for (int bit = 0; bit < 8; bit++)
            crc = crc >> 1 ^ (crc & 1 ? polynomial : 0);
    }
    return crc;
}

static void correct_novatel(uint8_t *at, size_t left)
{
    const size_t header = at[2] == 0x12 ? at[3] : 12;
    const size_t body = at[2] == 0x12 ? (size_t)(at[8] | at[9] << 8) : at[3];
    if (header + body + 4 <= left)
        put_little(at + header + body, crc_of(at, header + body, 0xEDB88320), 4);
}

static void correct_sbg(uint8_t *at, size_t left)
{
    const size_t payload = (size_t)(at[4] | at[5] << 8);
    if (payload + 9 > left)
        return;
    put_little(at + 6 + payload, crc_of(at + 2, payload + 4, 0x8408), 2);
    at[8 + payload] = 0x33;
}

static void correct_ubx(uint8_t *at, size_t left)
{
    const size_t payload = (size_t)(at[4] | at[5] << 8);
    uint8_t first = 0, second = 0;
    if (payload + 8 > left)
        return;
    for (size_t i = 2; i < payload + 6; i++) {
        first = (uint8_t)(first + at[i]);
        second = (uint8_t)(second + first);
    }
    at[6 + payload] = first;
    at[7 + payload] = second;
}

static void correct_line(uint8_t *at, size_t left)
{
    char text[16];
    uint8_t sum = 0;
    const uint8_t *star = memchr(at, '*', left);
    const size_t covered = star ? (size_t)(star - at) - 1 : 0;
    for (size_t i = 0; i < covered; i++)
        sum ^= at[1 + i];
    if (at[0] == '$')
        snprintf(text, sizeof text, "%02X", sum);
    else
        snprintf(text, sizeof text, "%08x", (unsigned)crc_of(at + 1, covered, 0xEDB88320));
    if (star && covered + 2 + strlen(text) <= left)
        memcpy(at + covered + 2, text, strlen(text));
}

static void correct(uint8_t *bytes, size_t size)
{
    for (size_t at = 0; at + 12 <= size; at++) {
        uint8_t *p = bytes + at;
        const size_t left = size - at;
        if (p[0] == 0xAA && p[1] == 0x44)
            correct_novatel(p, left);
        else if (p[0] == 0xFF && p[1] == 0x5A)
            correct_sbg(p, left);
        else if (p[0] == 0xB5 && p[1] == 0x62)
            correct_ubx(p, left);
        else if (p[0] == '$' || p[0] == '%' || p[0] == '#')
            correct_line(p, left < 512 ? left : 512);
    }
}

static void check_rows(imk_log_reader *reader, size_t piece)
{
    static double values[IMK_LOG_COLUMNS_MAX][ROWS];
    double *columns[IMK_LOG_COLUMNS_MAX];
    size_t rows = 0, total = 0;
    imk_error error = {.status = IMK_OK};
    imk_status status;
    for (size_t i = 0; i < IMK_LOG_COLUMNS_MAX; i++)
        columns[i] = values[i];
    while ((status = imk_log_read(reader, piece, columns, &rows, &error)) == IMK_OK && rows > 0)
        total += rows;
    require_told(status, &error);
    require(imk_log_findings_get(reader).rows == total);
}

static void check(const uint8_t *bytes, size_t size, const char *format, uint32_t choice)
{
    imk_log_settings settings = imk_log_default();
    settings.format = format;
    settings.rate = choice % 2 == 0 ? 100.0 : 0.0;
    settings.time_unit = choice % 8 < 4 ? "39.0625 us" : NULL;
    settings.gyro_unit = settings.accel_unit = choice % 16 < 12 ? "count" : NULL;
    settings.topic = choice % 3 == 0 ? "imu_data" : choice % 3 == 1 ? "imu_short" : NULL;
    imk_log_reader *reader = NULL;
    imk_error error = {.status = IMK_OK};
    imk_status status = imk_log_open_memory((const char *)bytes, size, &settings, &reader, &error);
    require_told(status, &error);
    if (status == IMK_ERROR_NAME_UNKNOWN && settings.topic) {
        settings.topic = NULL;
        status = imk_log_open_memory((const char *)bytes, size, &settings, &reader, NULL);
    }
    if (status != IMK_OK)
        return;
    check_rows(reader, 1 + choice / 4 % ROWS);
    if (imk_log_seek(reader, choice % 101 / 100.0, NULL) == IMK_OK)
        check_rows(reader, ROWS);
    imk_log_close(reader);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const char *const names[] = {"novatel:", "sbg:", "ubx:", "vectornav:"};
    static const char *const formats[] = {"novatel", "sbg", "ubx", "vectornav"};
    const char *format = NULL;
    const uint32_t choice = choice_of(data, size);
    for (size_t i = 0; i < 4 && !format; i++)
        if (size >= strlen(names[i]) && memcmp(data, names[i], strlen(names[i])) == 0) {
            format = formats[i];
            data += strlen(names[i]);
            size -= strlen(names[i]);
        }
    uint8_t *bytes = malloc(size + 1);
    if (!bytes)
        return 0;
    memcpy(bytes, data, size);
    if (choice % 2 == 0)
        correct(bytes, size);
    check(bytes, size, format, choice / 2);
    free(bytes);
    return 0;
}
