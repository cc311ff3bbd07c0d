/* SPDX-License-Identifier: Apache-2.0 */
/* Descriptions of binary records: items with commas between. An item that is wrong is named with an
 * example of a right one. */
#include "description_internal.h"

#include "base/text_internal.h"
#include "imukit/utf8.h"

#include <stdio.h>
#include <string.h>

static const struct type {
    const char *name;
    size_t size;
    bool is_signed, is_float;
} types[] = {{"u8", 1, false, false},  {"i8", 1, true, false},   {"u16", 2, false, false},
             {"i16", 2, true, false},  {"u24", 3, false, false}, {"i24", 3, true, false},
             {"u32", 4, false, false}, {"i32", 4, true, false},  {"u64", 8, false, false},
             {"i64", 8, true, false},  {"f32", 4, true, true},   {"f64", 8, true, true}};

/* Names that three of are x, y, z. */
static const char *const triads[] = {"gyro", "accel", "acc", "mag", "dtheta", "dvel"};

typedef struct parser {
    imki_record_form *form;
    bool big_endian;              /* of fields that do not say it */
    unsigned number;              /* of the item, from 1 */
    const char *begin, *at, *end; /* of the item; what is not read yet */
    imk_error *error;
} parser;

static imk_status refuse(const parser *p, imk_status status, const char *wrong, const char *example)
{
    char text[128], item[32], found[96], expected[160];
    const char *last = p->end;
    while (last > p->begin && last[-1] == ' ')
        last--;
    snprintf(text, sizeof text, "%.*s", (int)(last - p->begin), p->begin);
    imk_utf8_shorten(text, item, sizeof item);
    snprintf(found, sizeof found, "\"%s\" (item %u): %s", item, p->number, wrong);
    snprintf(expected, sizeof expected, "such as %s", example);
    return imk_error_set(p->error, status, "binary", found, expected);
}

static void skip_blanks(parser *p)
{
    while (p->at < p->end && (*p->at == ' ' || *p->at == '\t' || *p->at == '\n'))
        p->at++;
}

/* The next word, cut to the room; "" at the end. */
static void next_word(parser *p, size_t size, char *word)
{
    size_t length = 0;
    skip_blanks(p);
    for (; p->at < p->end && *p->at != ' ' && *p->at != '\t' && *p->at != '\n'; p->at++)
        if (length + 1 < size)
            word[length++] = *p->at;
    word[length] = '\0';
}

/* A whole number at the place. */
static bool take_number(parser *p, uint64_t most, uint64_t *number)
{
    skip_blanks(p);
    const char *at = p->at;
    for (*number = 0; at < p->end && *at >= '0' && *at <= '9'; at++) {
        if (*number > (most - (uint64_t)(*at - '0')) / 10)
            return false;
        *number = *number * 10 + (uint64_t)(*at - '0');
    }
    if (at == p->at)
        return false;
    p->at = at;
    return true;
}

/* "be", "le", as a word of its own or behind a type. */
static bool take_order(const char *word, bool *big_endian)
{
    if (strcmp(word, "be") != 0 && strcmp(word, "le") != 0)
        return false;
    *big_endian = word[0] == 'b';
    return true;
}

/* The type that a word is, as in "i16" and "i16be". */
static const struct type *find_type(const char *word, bool *big_endian)
{
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
        const size_t length = strlen(types[i].name);
        if (strncmp(word, types[i].name, length) == 0 &&
            (word[length] == '\0' || take_order(word + length, big_endian)))
            return &types[i];
    }
    return NULL;
}

/* "3 x": how many fields follow; 1 where it is not said. */
static bool take_repetition(parser *p, uint64_t *count)
{
    const char *back = p->at;
    *count = 1;
    if (!take_number(p, UINT32_MAX, count)) {
        p->at = back;
        *count = 1;
        return true;
    }
    skip_blanks(p);
    if (p->at == p->end || (*p->at != 'x' && *p->at != '*'))
        return false;
    p->at++;
    return *count > 0;
}

static imk_status grow(const parser *p, uint64_t bytes)
{
    if (bytes > IMKI_RECORD_MAX - p->form->size)
        return refuse(p, IMK_ERROR_RANGE, "the record is beyond 65536 bytes", "\"skip 16\"");
    p->form->size += (size_t)bytes;
    return IMK_OK;
}

static imk_status read_header(parser *p)
{
    uint64_t size;
    if (!take_number(p, UINT64_C(1) << 40, &size))
        return refuse(p, IMK_ERROR_SYNTAX, "no number of bytes", "\"header 512\"");
    if (p->form->size > 0 || p->form->header > 0)
        return refuse(p, IMK_ERROR_SYNTAX, "it belongs before all others, once",
                      "\"header 512, u32 time us\"");
    p->form->header = size;
    skip_blanks(p);
    return p->at == p->end ? IMK_OK
                           : refuse(p, IMK_ERROR_SYNTAX, "more than a number", "\"header 512\"");
}

static int digit_of(char c)
{
    const char lower = imki_lower(c);
    return lower >= '0' && lower <= '9'   ? lower - '0'
           : lower >= 'a' && lower <= 'f' ? lower - 'a' + 10
                                          : -1;
}

static imk_status read_sync(parser *p)
{
    static const char example[] = "\"sync 0xAA55\"";
    char word[2 + 2 * IMKI_SYNC_MAX + 2] = "";
    if (p->form->size > 0)
        return refuse(p, IMK_ERROR_SYNTAX, "it belongs before all fields",
                      "\"sync 0xAA55, u32 time us\"");
    next_word(p, sizeof word, word);
    const size_t digits = strlen(word) < 2 ? 0 : strlen(word) - 2;
    if (digits < 2 || digits % 2 != 0 || digits > 2 * IMKI_SYNC_MAX || word[0] != '0' ||
        imki_lower(word[1]) != 'x')
        return refuse(p, IMK_ERROR_SYNTAX, "not 1 to 8 bytes as 0x...", example);
    for (size_t i = 0; i < digits; i += 2) {
        const int high = digit_of(word[2 + i]), low = digit_of(word[3 + i]);
        if (high < 0 || low < 0)
            return refuse(p, IMK_ERROR_SYNTAX, "not 1 to 8 bytes as 0x...", example);
        p->form->sync[p->form->sync_size++] = (unsigned char)(16 * high + low);
    }
    skip_blanks(p);
    if (p->at != p->end)
        return refuse(p, IMK_ERROR_SYNTAX, "more than one word", example);
    return grow(p, p->form->sync_size);
}

/* Behind "skip", "checksum" or "crc": bytes, or types. */
static imk_status read_skip(parser *p)
{
    static const char example[] = "\"skip 4\", \"skip u16\" or \"checksum u16\"";
    uint64_t count;
    bool big_endian;
    char word[16];
    const bool counted = !take_repetition(p, &count);
    next_word(p, sizeof word, word);
    const struct type *type = find_type(word, &big_endian);
    skip_blanks(p);
    if (p->at != p->end || (counted ? word[0] != '\0' : !type))
        return refuse(p, IMK_ERROR_SYNTAX, "neither a number of bytes nor a type", example);
    return grow(p, counted ? count : count * type->size);
}

static bool is_name(const char *word)
{
    bool fits = word[0] != '\0' && !(word[0] >= '0' && word[0] <= '9');
    for (const char *at = word; *at; at++)
        fits = fits && ((imki_lower(*at) >= 'a' && imki_lower(*at) <= 'z') || *at == '_' ||
                        (*at >= '0' && *at <= '9'));
    return fits;
}

static bool is_triad(const char *name)
{
    for (size_t i = 0; i < sizeof triads / sizeof triads[0]; i++)
        if (strcmp(name, triads[i]) == 0)
            return true;
    return false;
}

static bool is_time(const char *name)
{
    return strcmp(name, "time") == 0 || strcmp(name, "t") == 0 || strcmp(name, "timestamp") == 0;
}

/* Has a field before it this name? */
static bool is_taken(const imki_record_form *form, const char *name)
{
    const size_t length = strcspn(name, " ");
    for (size_t i = 0; i < form->field_count; i++)
        if (strcspn(form->field[i].name, " ") == length &&
            strncmp(form->field[i].name, name, length) == 0)
            return true;
    return false;
}

/* `count` fields of one name. */
static imk_status add_fields(parser *p, const struct type *type, bool big_endian, uint64_t count,
                             const char *name, const imki_count_scale *scale)
{
    imki_record_form *form = p->form;
    if (count > IMK_LOG_COLUMNS_MAX - form->field_count)
        return refuse(p, IMK_ERROR_RANGE, "more than 64 fields are named", "\"skip u16\"");
    for (uint64_t i = 0; i < count; i++) {
        imki_record_field *field = &form->field[form->field_count];
        char suffix[8] = "";
        if (count == 3 && is_triad(name))
            snprintf(suffix, sizeof suffix, "_%c", "xyz"[i]);
        else if (count > 1)
            snprintf(suffix, sizeof suffix, "_%u", (unsigned)i);
        *field = (imki_record_field){.place = form->size,
                                     .size = type->size,
                                     .is_signed = type->is_signed,
                                     .is_float = type->is_float,
                                     .big_endian = big_endian,
                                     .scale = *scale};
        snprintf(field->name, sizeof field->name, scale->unit[0] ? "%s%s [%s]" : "%s%s", name,
                 suffix, scale->unit);
        if (is_taken(form, field->name))
            return refuse(p, IMK_ERROR_COLUMN, "the name is there twice", "\"u16 status_2\"");
        if (is_time(name)) {
            if (form->time_field >= 0)
                return refuse(p, IMK_ERROR_COLUMN, "there is a time before it", "\"skip u32\"");
            form->time_field = (int)form->field_count;
        }
        const imk_status status = grow(p, type->size);
        if (status != IMK_OK)
            return status;
        form->field_count++;
    }
    return IMK_OK;
}

/* "3 x i16 gyro 16.4 LSB/(deg/s)" */
static imk_status read_field(parser *p)
{
    uint64_t count;
    char word[16], name[40], wrong[64];
    bool big_endian = p->big_endian;
    if (!take_repetition(p, &count))
        return refuse(p, IMK_ERROR_SYNTAX, "a number without \"x\" behind it", "\"3 x i16 gyro\"");
    next_word(p, sizeof word, word);
    if (take_order(word, &big_endian))
        next_word(p, sizeof word, word);
    const struct type *type = find_type(word, &big_endian);
    if (!type) {
        snprintf(wrong, sizeof wrong, "\"%.12s\" is no type", word);
        return refuse(p, IMK_ERROR_SYNTAX, wrong,
                      "\"u32 time us\"; types are u8 i8 u16 i16 u24 i24 u32 i32 u64 i64 f32 f64");
    }
    next_word(p, sizeof name, name);
    if (take_order(name, &big_endian))
        next_word(p, sizeof name, name);
    if (strcmp(name, "skip") == 0 || strcmp(name, "checksum") == 0 || strcmp(name, "crc") == 0)
        return grow(p, count * type->size);
    if (!is_name(name) || strlen(name) > 32)
        return refuse(p, IMK_ERROR_SYNTAX, "no name is behind the type", "\"i16 gyro_x deg/s\"");
    if (count == 1 && is_triad(name))
        return refuse(p, IMK_ERROR_SYNTAX, "a sensor without its axis",
                      "\"3 x i16 gyro 16.4 LSB/(deg/s)\" or \"i16 gyro_x 16.4 LSB/(deg/s)\"");
    if (count > 8 && is_triad(name))
        return refuse(p, IMK_ERROR_RANGE, "more than 8 of a sensor", "\"3 x i16 gyro\"");
    if (count > 1 && is_time(name))
        return refuse(p, IMK_ERROR_SYNTAX, "more than one time", "\"u32 time us\"");
    imki_count_scale scale;
    if (!imki_count_scale_read(p->at, p->end, &scale, sizeof wrong, wrong))
        return refuse(p, IMK_ERROR_UNIT_UNKNOWN, wrong,
                      "\"i16 gyro_x 16.4 LSB/(deg/s)\", or with 0.061 mg/LSB, deg/s, count");
    return add_fields(p, type, big_endian, count, name, &scale);
}

static imk_status read_item(parser *p)
{
    char word[12];
    next_word(p, sizeof word, word);
    if (strcmp(word, "be:") == 0 || strcmp(word, "le:") == 0) {
        if (p->number > 1)
            return refuse(p, IMK_ERROR_SYNTAX, "the order of bytes stands before all",
                          "\"be: u32 time us\"");
        p->big_endian = word[0] == 'b';
        p->begin = p->at;
        next_word(p, sizeof word, word);
    }
    if (strcmp(word, "header") == 0)
        return read_header(p);
    if (strcmp(word, "sync") == 0)
        return read_sync(p);
    if (strcmp(word, "skip") == 0 || strcmp(word, "checksum") == 0 || strcmp(word, "crc") == 0)
        return read_skip(p);
    p->at = p->begin;
    skip_blanks(p);
    return p->at == p->end ? refuse(p, IMK_ERROR_SYNTAX, "there is nothing", "\"u32 time us\"")
                           : read_field(p);
}

imk_status imki_record_form_parse(const char *text, imki_record_form *form, imk_error *error)
{
    parser p = {.form = form, .error = error};
    imk_status status = IMK_OK;
    *form = (imki_record_form){.time_field = -1};
    for (const char *at = text; status == IMK_OK; at = p.end + 1) {
        while (*at == ' ')
            at++;
        p.number++;
        p.begin = p.at = at;
        p.end = at + strcspn(at, ",");
        status = read_item(&p);
        if (*p.end == '\0')
            break;
    }
    if (status == IMK_OK && form->field_count == 0)
        return imk_error_set(error, IMK_ERROR_EMPTY, "binary", "no field has a name",
                             "such as \"u32 time us, 3 x i16 gyro 16.4 LSB/(deg/s)\"");
    return status;
}
