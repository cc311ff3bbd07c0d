/* SPDX-License-Identifier: Apache-2.0 */
/* IMU messages of SBG Systems' sensors, sbgECom [SBGECOM]: FF 5A, id, class, u16 size of the
 * payload, payload, CRC-16 of id … payload, 33. Numbers have their lowest byte first. */
#include "messages_internal.h"

enum {
    HEADER = 6,
    TAIL = 3,
    PAYLOAD_MOST = 4086,
    ETX = 0x33,
    IMU_DATA = 3,
    IMU_SHORT = 44,
    FAST_IMU_DATA = 1 << 8, /* class 1, id 0 */
    HIGH_SCALE = 1 << 10    /* bit of the status */
};

/* Polynomial 0x8408, from 0. */
static unsigned crc_of(const unsigned char *bytes, size_t size)
{
    unsigned crc = 0;
    for (size_t i = 0; i < size; i++) {
        crc ^= bytes[i];
        for (int bit = 0; bit < 8; bit++)
            crc = crc >> 1 ^ (crc & 1 ? 0x8408u : 0u);
    }
    return crc;
}

static imki_found find(const unsigned char *at, size_t size, imki_message *message)
{
    if (size < 2 || at[1] != 0x5A)
        return IMKI_FOUND_NOTHING;
    if (size < HEADER)
        return IMKI_FOUND_PART;
    const size_t payload = (size_t)imki_little(at + 4, 2);
    *message = (imki_message){.id = (uint32_t)at[3] << 8 | at[2],
                              .size = HEADER + payload + TAIL,
                              .body = at + HEADER,
                              .body_size = payload};
    if (payload > PAYLOAD_MOST)
        return IMKI_FOUND_NOTHING;
    if (message->size > size)
        return IMKI_FOUND_PART;
    return at[HEADER + payload + 2] == ETX &&
                   crc_of(at + 2, HEADER - 2 + payload) == imki_little(at + HEADER + payload, 2)
               ? IMKI_FOUND_MESSAGE
               : IMKI_FOUND_DAMAGED;
}

/* All begin with the time [us], which begins again after 71.6 minutes, and the status. */
static bool begin_row(imki_messages *m, const imki_message *message, size_t due, unsigned *status)
{
    m->place = message->body_size;
    m->wrong = message->body_size < due;
    if (m->wrong)
        return false;
    m->stamp = imki_counter_unwrap(&m->counter, imki_little(message->body, 4), 32, false);
    *status = (unsigned)imki_little(message->body + 4, 2);
    return true;
}

static bool row_data(imki_messages *m, const imki_message *message, double *values)
{
    unsigned status;
    if (!begin_row(m, message, 58, &status))
        return false;
    for (size_t i = 0; i < 7; i++)
        values[1 + i] = imki_float(imki_little(message->body + 6 + 4 * i, 4));
    return true;
}

/* What it calls increments are rates: 1048576 counts in 1 m/s^2, and 67108864 in 1 rad/s or, beyond
 * 32 rad/s, 12304174. */
static bool row_short(imki_messages *m, const imki_message *message, double *values)
{
    unsigned status;
    if (!begin_row(m, message, 32, &status))
        return false;
    const double gyro = status & HIGH_SCALE ? 12304174.0 : 67108864.0;
    for (size_t i = 0; i < 6; i++)
        values[1 + i] = (double)imki_signed(imki_little(message->body + 6 + 4 * i, 4), 32) /
                        (i < 3 ? 1048576.0 : gyro);
    values[7] = (double)imki_signed(imki_little(message->body + 30, 2), 16) / 256.0;
    return true;
}

static bool row_fast(imki_messages *m, const imki_message *message, double *values)
{
    unsigned status;
    if (!begin_row(m, message, 18, &status))
        return false;
    for (size_t i = 0; i < 6; i++)
        values[1 + i] = (double)imki_signed(imki_little(message->body + 6 + 2 * i, 2), 16) /
                        (i < 3 ? 100.0 : 1000.0);
    return true;
}

static imk_status layout(imk_log_reader *reader, imki_messages *m, const imki_message *first,
                         imk_error *error)
{
    static const char *const names[] = {"time [us]",       "accel_x [m/s^2]",   "accel_y [m/s^2]",
                                        "accel_z [m/s^2]", "gyro_x [rad/s]",    "gyro_y [rad/s]",
                                        "gyro_z [rad/s]",  "temperature [degC]"};
    m->per_second = 1000000;
    return imki_log_layout_of(reader, first->id == FAST_IMU_DATA ? 7 : 8, names, error);
}

static const imki_message_kind kinds[] = {
    {IMU_SHORT, "imu_short", "SBG_ECOM_LOG_IMU_SHORT", layout, row_short, NULL},
    {IMU_DATA, "imu_data", "SBG_ECOM_LOG_IMU_DATA", layout, row_data, NULL},
    {FAST_IMU_DATA, "fast_imu_data", "SBG_ECOM_LOG_FAST_IMU_DATA", layout, row_fast, NULL},
};

static const imki_maker sbg = {
    .starts = "\xFF",
    .longest = HEADER + PAYLOAD_MOST + TAIL,
    .nothing = "the log has no message IMU_SHORT, IMU_DATA or FAST_IMU_DATA",
    .find = find,
    .kinds = kinds,
    .kind_count = sizeof kinds / sizeof kinds[0],
};

static bool recognise(const char *begin, size_t size)
{
    return imki_messages_recognise(&sbg, begin, size);
}

static imk_status open_sbg(imk_log_reader *reader, imk_error *error)
{
    return imki_messages_open(reader, &sbg, error);
}

const imki_log_codec imki_log_sbg = {.recognise = recognise,
                                     .open = open_sbg,
                                     .read = imki_messages_read,
                                     .seek = imki_messages_seek,
                                     .defines_units = true};
