/* SPDX-License-Identifier: Apache-2.0 */
/* Messages ESF-RAW of u-blox receivers [UBX]: B5 62, class, id, u16 size of the payload, payload,
 * two sums of class … payload. Lines of NMEA and messages of RTCM 3 may stand between (D3, ten bits
 * of size, payload, CRC-24). The payload is four bytes and pairs of u32: a reading, whose type is
 * in the highest byte and whose number in the others, and the sensor's time tag. Readings of one
 * tag are a row, also where they stand in several messages. u-blox does not say what a tag lasts,
 * so the user has to. */
#include "description_internal.h"
#include "messages_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum {
    HEADER = 6,
    SUMS = 2,
    PAYLOAD_MOST = 8192,
    ESF_MEAS = 0x1002,
    ESF_RAW = 0x1003,
    RESERVED = 4,
    PAIR = 8,
    TAG_BITS = 24, /* of the sensors whose tags begin again before 2^32 */
    READINGS = 7,
    GYROS = 0x07, /* cells, by bits */
    ACCELS = 0x38,
    TEMPERATURE = 0x40
};

/* In the order of the cells behind the time. */
static const struct {
    unsigned type;
    const char *name;
    double scale;
} readings[READINGS] = {{14, "gyro_x [deg/s]", 0x1p-12},  {13, "gyro_y [deg/s]", 0x1p-12},
                        {5, "gyro_z [deg/s]", 0x1p-12},   {16, "accel_x [m/s^2]", 0x1p-10},
                        {17, "accel_y [m/s^2]", 0x1p-10}, {18, "accel_z [m/s^2]", 0x1p-10},
                        {12, "temperature [degC]", 0.01}};

/* [RTCM3]: polynomial 0x1864CFB, from 0, the highest bit first. */
static imki_found find_rtcm(const unsigned char *at, size_t size, imki_message *message)
{
    enum { RTCM_HEADER = 3, CRC = 3 };
    if (size < 2 || at[1] > 3)
        return IMKI_FOUND_NOTHING;
    if (size < RTCM_HEADER)
        return IMKI_FOUND_PART;
    const size_t covered = RTCM_HEADER + (size_t)imki_big(at + 1, 2);
    *message = (imki_message){.size = covered + CRC};
    if (message->size > size)
        return IMKI_FOUND_PART;
    uint32_t crc = 0;
    for (size_t i = 0; i < covered; i++) {
        crc ^= (uint32_t)at[i] << 16;
        for (int bit = 0; bit < 8; bit++)
            crc = (crc << 1 ^ (crc & 0x800000 ? UINT32_C(0x1864CFB) : 0)) & 0xFFFFFF;
    }
    return imki_big(at + covered, CRC) == crc ? IMKI_FOUND_MESSAGE : IMKI_FOUND_DAMAGED;
}

static imki_found find(const unsigned char *at, size_t size, imki_message *message)
{
    if (*at == 0xD3)
        return find_rtcm(at, size, message);
    if (size < 2 || at[1] != 0x62)
        return IMKI_FOUND_NOTHING;
    if (size < HEADER)
        return IMKI_FOUND_PART;
    const size_t payload = (size_t)imki_little(at + 4, 2);
    *message = (imki_message){.id = (uint32_t)at[2] << 8 | at[3],
                              .size = HEADER + payload + SUMS,
                              .body = at + HEADER,
                              .body_size = payload};
    if (payload > PAYLOAD_MOST)
        return IMKI_FOUND_NOTHING;
    if (message->size > size)
        return IMKI_FOUND_PART;
    unsigned first = 0, second = 0;
    for (size_t i = 2; i < HEADER + payload; i++) {
        first = (first + at[i]) & 0xFF;
        second = (second + first) & 0xFF;
    }
    return at[HEADER + payload] == first && at[HEADER + payload + 1] == second ? IMKI_FOUND_MESSAGE
                                                                               : IMKI_FOUND_DAMAGED;
}

/* The cell of a type of reading, from 0; READINGS: none. */
static size_t cell_of(unsigned type)
{
    size_t cell = 0;
    while (cell < READINGS && readings[cell].type != type)
        cell++;
    return cell;
}

/* Tags that begin again, after 2^24 or 2^32. */
static void set_stamp(imki_messages *m, uint32_t tag)
{
    const uint64_t range = UINT64_C(1) << TAG_BITS;
    imki_counter *c = &m->counter;
    const bool small =
        c->begun && c->last < range && tag < range && tag < c->last && c->last - tag > range / 2;
    if (small)
        c->total += (int64_t)(range - c->last + tag);
    else
        imki_counter_unwrap(c, tag, 32, false);
    c->last = tag;
    m->stamp = c->total;
}

/* Readings from m->place on that have the tag of the first, each once. @return their cells */
static unsigned take_set(imki_messages *m, const imki_message *message, uint32_t *tag,
                         double numbers[READINGS])
{
    unsigned taken = 0;
    *tag = (uint32_t)imki_little(message->body + m->place + 4, 4);
    for (; m->place + PAIR <= message->body_size; m->place += PAIR) {
        const unsigned char *pair = message->body + m->place;
        const size_t cell = cell_of(pair[3]);
        if (imki_little(pair + 4, 4) != *tag || (cell < READINGS && taken & 1u << cell))
            break;
        if (cell == READINGS)
            continue;
        taken |= 1u << cell;
        numbers[cell] = (double)imki_signed(imki_little(pair, 3), 24) * readings[cell].scale;
    }
    return taken;
}

/* Give what is held as a row, unless it has none of the columns.
 * @return whether it is one */
static bool give(imki_messages *m, double *values)
{
    static const unsigned kinds[3] = {GYROS, ACCELS, TEMPERATURE};
    const unsigned taken = m->held.cells, sensors = m->cells & (GYROS | ACCELS);
    const bool broken = m->held.broken && (taken & sensors) != sensors;
    m->held.cells = 0;
    m->held.broken = false;
    for (int i = 0; i < 3; i++)
        m->later[i] += (taken & kinds[i] & ~m->cells) != 0;
    if ((taken & sensors) == 0 || broken)
        return false;
    set_stamp(m, m->held.tag);
    values[0] = (double)m->held.tag;
    for (size_t i = 0; i < READINGS; i++)
        values[1 + i] = taken & 1u << i ? m->held.numbers[i] : (double)NAN;
    return true;
}

static void hold(imki_messages *m, unsigned taken, uint32_t tag, const double numbers[READINGS])
{
    m->held.cells |= taken;
    m->held.tag = tag;
    for (size_t i = 0; i < READINGS; i++)
        if (taken & 1u << i)
            m->held.numbers[i] = numbers[i];
}

static bool row(imki_messages *m, const imki_message *message, double *values)
{
    double numbers[READINGS];
    uint32_t tag;
    if (message->body_size < RESERVED || (message->body_size - RESERVED) % PAIR != 0) {
        m->wrong = true;
        return false;
    }
    m->place = m->place < RESERVED ? RESERVED : m->place;
    while (m->place < message->body_size) {
        const unsigned taken = take_set(m, message, &tag, numbers);
        const bool ends = m->held.cells != 0 && (tag != m->held.tag || (m->held.cells & taken));
        const bool is_row = ends && give(m, values);
        hold(m, taken, tag, numbers);
        if (is_row)
            return true;
    }
    return false;
}

static bool rest(imki_messages *m, double *values)
{
    return m->held.cells != 0 && give(m, values);
}

/* What the first message holds, and those behind it that go on with its last tag. */
static unsigned first_cells(const imki_message *first, const unsigned char *end)
{
    unsigned cells = 0;
    uint32_t tag = 0;
    imki_message message = *first;
    const unsigned char *at = first->body - HEADER;
    do {
        const bool raw = message.id == ESF_RAW && message.body_size >= RESERVED + PAIR;
        if (raw && cells != 0 && imki_little(message.body + RESERVED + 4, 4) != tag)
            break;
        for (size_t i = RESERVED; raw && i + PAIR <= message.body_size; i += PAIR) {
            cells |= 1u << cell_of(message.body[i + 3]);
            tag = (uint32_t)imki_little(message.body + i + 4, 4);
        }
        at += message.size;
    } while (at < end && find(at, (size_t)(end - at), &message) == IMKI_FOUND_MESSAGE);
    return cells;
}

/* The tags as times, in a unit that the user states, as in "39.0625 us". */
static imk_status set_tick(imki_messages *m, const char *unit, size_t size, char *name,
                           imk_error *error)
{
    imki_count_scale scale;
    char wrong[64];
    if (!imki_count_scale_read(unit, unit + strlen(unit), &scale, sizeof wrong, wrong) ||
        scale.divisor != 1.0 || scale.offset != 0.0 || scale.factor <= 0.0)
        return imk_error_set(error, IMK_ERROR_UNIT_UNKNOWN, "--time-unit", unit,
                             "such as \"39.0625 us\" or ms, which is what one tag lasts");
    m->tick = scale.factor;
    snprintf(name, size, "time [%s]", scale.unit);
    return IMK_OK;
}

static imk_status layout(imk_log_reader *reader, imki_messages *m, const imki_message *first,
                         imk_error *error)
{
    char time[64] = "sensor_tag";
    const char *names[1 + READINGS] = {time};
    const char *unit = reader->settings.time_unit;
    m->cells = first_cells(first, (const unsigned char *)reader->text.end);
    for (size_t i = 0; i < READINGS; i++)
        names[1 + i] = m->cells & 1u << i ? readings[i].name : NULL;
    m->timed = unit != NULL;
    if (!unit && reader->settings.rate == 0.0)
        return imk_error_set(error, IMK_ERROR_RATE_MISSING, "time",
                             "what a time tag of the sensors lasts is not stated by u-blox",
                             "add --rate RATE with the rate of the sensors, or --time-unit with "
                             "what one tag lasts, such as --time-unit \"39.0625 us\"");
    imk_status status = unit ? set_tick(m, unit, sizeof time, time, error) : IMK_OK;
    if (status != IMK_OK)
        return status;
    reader->settings.time_unit = NULL; /* which is no unit alone */
    status = imki_log_layout_of(reader, 1 + READINGS, names, error);
    reader->settings.time_unit = unit;
    for (size_t i = 0; i < reader->layout.column_count; i++)
        reader->layout.column[i].unit_origin =
            (int)i == reader->layout.time_column ? IMK_UNIT_OF_SETTINGS : IMK_UNIT_OF_FORMAT;
    return status;
}

static const imki_message_kind kinds[] = {
    {ESF_RAW, "ESF-RAW", "UBX-ESF-RAW", layout, row, rest},
    {ESF_MEAS, "ESF-MEAS", "UBX-ESF-MEAS", NULL, NULL, NULL},
};

static const imki_maker ubx = {
    .starts = "\xB5\xD3",
    .longest = HEADER + PAYLOAD_MOST + SUMS,
    .text_between = true,
    .nothing = "the log has no UBX-ESF-RAW messages",
    .find = find,
    .kinds = kinds,
    .kind_count = sizeof kinds / sizeof kinds[0],
};

static bool recognise(const char *begin, size_t size)
{
    imki_maker own = ubx;
    own.starts = "\xB5"; /* RTCM alone is another's */
    return imki_messages_recognise(&own, begin, size);
}

static imk_status open_ubx(imk_log_reader *reader, imk_error *error)
{
    return imki_messages_open(reader, &ubx, error);
}

const imki_log_codec imki_log_ubx = {.recognise = recognise,
                                     .open = open_ubx,
                                     .read = imki_messages_read,
                                     .seek = imki_messages_seek};
