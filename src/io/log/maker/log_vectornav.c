/* SPDX-License-Identifier: Apache-2.0 */
/* Lines $VNIMU of VectorNav's sensors [VERSASYNC]: the uncompensated magnetic field, force, rate,
 * the temperature and the pressure. "*" is followed by the XOR of the bytes between "$" and it (two
 * digits) or their CRC-16 (four) [VNPROGLIB]. There is no time. Other lines of that form may stand
 * between. */
#include "messages_internal.h"

#include <string.h>

enum { VNIMU = 1, LONGEST = 512, NUMBERS = 11 };

static uint32_t xor_of(const unsigned char *bytes, size_t size)
{
    uint32_t sum = 0;
    for (size_t i = 0; i < size; i++)
        sum ^= bytes[i];
    return sum;
}

/* Polynomial 0x1021, from 0, the highest bit first. */
static uint32_t crc_of(const unsigned char *bytes, size_t size)
{
    uint32_t crc = 0;
    for (size_t i = 0; i < size; i++) {
        crc ^= (uint32_t)bytes[i] << 8;
        for (int bit = 0; bit < 8; bit++)
            crc = (crc << 1 ^ (crc & 0x8000 ? 0x1021u : 0u)) & 0xFFFF;
    }
    return crc;
}

static imki_found find(const unsigned char *at, size_t size, imki_message *message)
{
    uint32_t stated;
    if (size > 1 && (at[1] < 'A' || at[1] > 'Z'))
        return IMKI_FOUND_NOTHING;
    const size_t room = size < LONGEST ? size : LONGEST;
    const size_t star = imki_star_find(at + 1, room - 1) + 1;
    if (star == 1) {
        for (size_t i = 1; i < room; i++)
            if (at[i] < ' ' || at[i] > '~')
                return IMKI_FOUND_DAMAGED;
        return room == size ? IMKI_FOUND_PART : IMKI_FOUND_NOTHING;
    }
    size_t digits = 0;
    while (digits < 4 && star + 1 + digits < size &&
           imki_hex_read(at + star + 1 + digits, 1, &stated))
        digits++;
    imki_hex_read(at + star + 1, digits, &stated);
    if ((digits != 2 || stated != xor_of(at + 1, star - 1)) &&
        (digits != 4 || stated != crc_of(at + 1, star - 1)))
        return digits < 4 && star + 1 + digits == size ? IMKI_FOUND_PART : IMKI_FOUND_DAMAGED;
    *message = (imki_message){.is_text = true, .size = star + 1 + digits, .body = at + star};
    if (star > 7 && memcmp(at, "$VNIMU,", 7) == 0) {
        message->id = VNIMU;
        message->body = at + 7;
        message->body_size = star - 7;
    }
    return IMKI_FOUND_MESSAGE;
}

static bool row(imki_messages *m, const imki_message *message, double *values)
{
    m->place = message->body_size;
    m->wrong = !imki_numbers_read(message, NUMBERS, values);
    return !m->wrong;
}

static imk_status layout(imk_log_reader *reader, imki_messages *m, const imki_message *first,
                         imk_error *error)
{
    static const char *const names[NUMBERS] = {
        "mag_x [gauss]",   "mag_y [gauss]",      "mag_z [gauss]",  "accel_x [m/s^2]",
        "accel_y [m/s^2]", "accel_z [m/s^2]",    "gyro_x [rad/s]", "gyro_y [rad/s]",
        "gyro_z [rad/s]",  "temperature [degC]", "pressure [kPa]"};
    (void)first;
    m->timed = false;
    return imki_log_layout_of(reader, NUMBERS, names, error);
}

static const imki_message_kind kinds[] = {{VNIMU, "VNIMU", "$VNIMU", layout, row, NULL}};

static const imki_maker vectornav = {
    .starts = "$",
    .longest = LONGEST,
    .nothing = "the log has no lines $VNIMU",
    .find = find,
    .kinds = kinds,
    .kind_count = sizeof kinds / sizeof kinds[0],
};

static bool recognise(const char *begin, size_t size)
{
    imki_message message;
    for (size_t at = 0; at + 3 < size; at++)
        if (memcmp(begin + at, "$VN", 3) == 0 && (at == 0 || begin[at - 1] == '\n') &&
            find((const unsigned char *)begin + at, size - at, &message) == IMKI_FOUND_MESSAGE)
            return true;
    return false;
}

static imk_status open_vectornav(imk_log_reader *reader, imk_error *error)
{
    return imki_messages_open(reader, &vectornav, error);
}

const imki_log_codec imki_log_vectornav = {.recognise = recognise,
                                           .open = open_vectornav,
                                           .read = imki_messages_read,
                                           .seek = imki_messages_seek,
                                           .defines_units = true};
