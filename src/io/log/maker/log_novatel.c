/* SPDX-License-Identifier: Apache-2.0 */
/* Raw IMU messages of NovAtel's OEM receivers, binary and ASCII [NOVATEL-OEM7]. Binary: AA 44 12
 * and a long header (its size, u16 id at 4, type at 6, u16 size of the body at 8), or AA 44 13 and
 * a header of 12 bytes (u8 size of the body, u16 id at 4); the body; a CRC-32 of all before. ASCII:
 * "#" or "%", header, ";", fields, "*", CRC-32 of what is between. */
#include "messages_internal.h"
#include "novatel_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum {
    LONG_HEADER = 28,
    SHORT_HEADER = 12,
    CRC_SIZE = 4,
    LONGEST = 16384, /* messages of observations of many satellites have 9 kB */
    LINE_LONGEST = 1024,
    RAWIMU = 268,
    RAWIMUS = 325,
    RAWIMUX = 1461,
    RAWIMUSX = 1462,
    WEEK = 604800,
    WEEKS_MOST = 10000, /* so that nanoseconds since 1980 are an int64_t */
    BODY_SIZE = 40
};

/* The polynomial of zlib's crc32(), without its initial and final complement. */
static uint32_t crc_of(const unsigned char *bytes, size_t size)
{
    uint32_t crc = 0;
    for (size_t i = 0; i < size; i++) {
        crc ^= bytes[i];
        for (int bit = 0; bit < 8; bit++)
            crc = crc >> 1 ^ (crc & 1 ? UINT32_C(0xEDB88320) : 0);
    }
    return crc;
}

static imki_found find_binary(const unsigned char *at, size_t size, imki_message *message)
{
    if (size < 2 || at[1] != 0x44)
        return IMKI_FOUND_NOTHING;
    if (size < SHORT_HEADER)
        return IMKI_FOUND_PART;
    const bool is_long = at[2] == 0x12;
    if ((!is_long && at[2] != 0x13) || (is_long && at[3] < LONG_HEADER))
        return IMKI_FOUND_NOTHING;
    const size_t header = is_long ? at[3] : SHORT_HEADER;
    const size_t body = is_long ? (size_t)imki_little(at + 8, 2) : at[3];
    *message = (imki_message){.id = (uint32_t)imki_little(at + 4, 2),
                              .size = header + body + CRC_SIZE,
                              .body = at + header,
                              .body_size = body};
    if (message->size > LONGEST)
        return IMKI_FOUND_NOTHING;
    if (message->size > size)
        return IMKI_FOUND_PART;
    if (crc_of(at, header + body) != imki_little(at + header + body, CRC_SIZE))
        return IMKI_FOUND_DAMAGED;
    if (is_long && (at[6] & 0xE0) != 0) /* bits 5 and 6: not binary; bit 7: a response */
        message->id = 0;
    return IMKI_FOUND_MESSAGE;
}

static uint32_t id_of(const char *name, size_t length)
{
    static const struct {
        const char *name;
        uint32_t id;
    } ids[] = {
        {"RAWIMUA", RAWIMU}, {"RAWIMUSA", RAWIMUS}, {"RAWIMUXA", RAWIMUX}, {"RAWIMUSXA", RAWIMUSX}};
    for (size_t i = 0; i < sizeof ids / sizeof ids[0]; i++)
        if (strlen(ids[i].name) == length && memcmp(name, ids[i].name, length) == 0)
            return ids[i].id;
    return 0;
}

/* The name of an ASCII log has capitals and digits, and an A at its end. */
static imki_found find_text(const unsigned char *at, size_t size, imki_message *message)
{
    size_t name = 1;
    while (name < size && name < 32 &&
           ((at[name] >= 'A' && at[name] <= 'Z') || (at[name] >= '0' && at[name] <= '9')))
        name++;
    if (name < 5)
        return IMKI_FOUND_NOTHING;
    if (name == size)
        return IMKI_FOUND_PART;
    if (at[name] != ',' || at[name - 1] != 'A')
        return IMKI_FOUND_NOTHING;
    const size_t room = size < LINE_LONGEST ? size : LINE_LONGEST;
    const size_t star = imki_star_find(at + 1, room - 1) + 1;
    uint32_t crc;
    if (star == 1) { /* the line goes on behind what is at hand, or ends without one */
        for (size_t i = 1; i < room; i++)
            if (at[i] < ' ' || at[i] > '~')
                return IMKI_FOUND_DAMAGED;
        return room == size ? IMKI_FOUND_PART : IMKI_FOUND_NOTHING;
    }
    if (star + 9 > size)
        return IMKI_FOUND_PART;
    if (!imki_hex_read(at + star + 1, 8, &crc) || crc != crc_of(at + 1, star - 1))
        return IMKI_FOUND_DAMAGED;
    const unsigned char *fields = memchr(at, ';', star);
    fields = fields ? fields + 1 : at + star;
    *message = (imki_message){.id = id_of((const char *)at + 1, name - 1),
                              .is_text = true,
                              .size = star + 9,
                              .body = fields,
                              .body_size = (size_t)(at + star - fields)};
    return IMKI_FOUND_MESSAGE;
}

static imki_found find(const unsigned char *at, size_t size, imki_message *message)
{
    return *at == 0xAA ? find_binary(at, size, message) : find_text(at, size, message);
}

/* What a message says; the counts in its order: z, -y, x of the forces, then of the rates. */
typedef struct raw_imu {
    unsigned type;
    double week, seconds, counts[6];
} raw_imu;

static bool has_type(uint32_t id)
{
    return id == RAWIMUX || id == RAWIMUSX;
}

/* Fields of RAWIMUX: info, type, week, seconds, status, counts; of RAWIMU: week and so on. The
 * status is hexadecimal. */
static bool read_text(const imki_message *message, raw_imu *raw)
{
    const size_t first = has_type(message->id) ? 2 : 0, count = first + 9;
    const char *begin = (const char *)message->body;
    imki_log_piece cells[IMKI_MESSAGE_COLUMNS];
    double type = 0.0;
    if (imki_log_split(begin, begin + message->body_size, ',', IMKI_MESSAGE_COLUMNS, cells) !=
        count)
        return false;
    bool whole = imki_log_piece_is_number(cells[first], &raw->week) &&
                 imki_log_piece_is_number(cells[first + 1], &raw->seconds) &&
                 (first == 0 || imki_log_piece_is_number(cells[1], &type));
    for (size_t i = 0; i < 6 && whole; i++)
        whole = imki_log_piece_is_number(cells[first + 3 + i], &raw->counts[i]) &&
                fabs(raw->counts[i]) <= 2147483648.0;
    raw->type = type >= 0.0 && type <= 255.0 ? (unsigned)type : 0;
    return whole;
}

static bool read_binary(const imki_message *message, raw_imu *raw)
{
    const unsigned char *body = message->body;
    const bool extended = has_type(message->id);
    if (message->body_size < BODY_SIZE)
        return false;
    raw->type = extended ? body[1] : 0;
    raw->week = (double)(extended ? imki_little(body + 2, 2) : imki_little(body, 4));
    raw->seconds = imki_double(imki_little(body + 4, 8));
    for (size_t i = 0; i < 6; i++)
        raw->counts[i] = (double)imki_signed(imki_little(body + 16 + 4 * i, 4), 32);
    return true;
}

static bool read_raw(const imki_message *message, raw_imu *raw)
{
    return (message->is_text ? read_text : read_binary)(message, raw) && raw->week >= 0.0 &&
           raw->week <= WEEKS_MOST && raw->seconds >= 0.0 && raw->seconds <= WEEK;
}

/* Increments since the row before; of some types, rates. */
static bool row(imki_messages *m, const imki_message *message, double *values)
{
    raw_imu raw;
    m->place = message->body_size;
    if (!read_raw(message, &raw) || raw.type != m->type) {
        m->wrong = true;
        return false;
    }
    m->stamp = (int64_t)raw.week * WEEK * INT64_C(1000000000) + llround(raw.seconds * 1e9);
    for (int axis = 0; axis < 3; axis++) {
        const double sign = axis == 1 ? -1.0 : 1.0;
        values[1 + axis] = sign * raw.counts[5 - axis] * m->gyro_scale;
        values[4 + axis] = sign * raw.counts[2 - axis] * m->accel_scale;
    }
    return true;
}

static imk_status refuse_type(const imki_messages *m, const imki_message *first, imk_error *error)
{
    char found[96];
    if (has_type(first->id))
        snprintf(found, sizeof found,
                 "\"%s\" is of an IMU of type %u, whose scale factors are not known here",
                 m->kind->name, m->type);
    else
        snprintf(found, sizeof found, "\"%s\" does not tell the type of the IMU, nor its scale",
                 m->kind->name);
    return imk_error_set(error, IMK_ERROR_UNIT_MISSING, "", found,
                         "add --gyro-unit count --accel-unit count");
}

static imk_status layout(imk_log_reader *reader, imki_messages *m, const imki_message *first,
                         imk_error *error)
{
    static const char *const axes[] = {"x", "y", "z"};
    raw_imu raw;
    char texts[6][48];
    const char *names[7] = {"time [ns]"};
    m->type = read_raw(first, &raw) ? raw.type : 0;
    m->tick = 1.0;
    m->per_second = 1000000000;
    m->gyro_scale = m->accel_scale = 1.0;
    const imki_novatel_imu *imu = imki_novatel_imu_of(m->type);
    for (size_t i = 0; i < 3; i++) {
        const bool rates = imu && imu->rates;
        snprintf(texts[i], sizeof texts[i], imu ? "%s_%s [%s]" : "%s_%s", rates ? "gyro" : "dtheta",
                 axes[i], imu ? imu->gyro_unit : "");
        snprintf(texts[3 + i], sizeof texts[3 + i], imu ? "%s_%s [%s]" : "%s_%s",
                 rates ? "accel" : "dvel", axes[i], imu ? imu->accel_unit : "");
    }
    for (size_t i = 0; i < 6; i++)
        names[1 + i] = texts[i];
    if (imu) {
        m->gyro_scale = imu->gyro_scale;
        m->accel_scale = imu->accel_scale;
        reader->device_interval = imu->rate > 0 ? 1 / imu->rate : 0;
    }
    const imk_status status = imki_log_layout_of(reader, 7, names, error);
    for (size_t i = 0; i < reader->layout.column_count; i++)
        reader->layout.column[i].unit_origin =
            imu || (int)i == reader->layout.time_column ? IMK_UNIT_OF_FORMAT : IMK_UNIT_OF_SETTINGS;
    return status == IMK_ERROR_UNIT_MISSING ? refuse_type(m, first, error) : status;
}

static const imki_message_kind kinds[] = {
    {RAWIMU, "RAWIMU", "RAWIMU", layout, row, NULL},
    {RAWIMUS, "RAWIMUS", "RAWIMUS", layout, row, NULL},
    {RAWIMUX, "RAWIMUX", "RAWIMUX", layout, row, NULL},
    {RAWIMUSX, "RAWIMUSX", "RAWIMUSX", layout, row, NULL},
};

static const imki_maker novatel = {
    .starts = "\xAA#%",
    .longest = LONGEST,
    .text_between = true,
    .nothing = "the log has no RAWIMU, RAWIMUS, RAWIMUX or RAWIMUSX messages",
    .find = find,
    .kinds = kinds,
    .kind_count = sizeof kinds / sizeof kinds[0],
};

static bool recognise(const char *begin, size_t size)
{
    return imki_messages_recognise(&novatel, begin, size);
}

static imk_status open_novatel(imk_log_reader *reader, imk_error *error)
{
    return imki_messages_open(reader, &novatel, error);
}

const imki_log_codec imki_log_novatel = {.recognise = recognise,
                                         .open = open_novatel,
                                         .read = imki_messages_read,
                                         .seek = imki_messages_seek};
