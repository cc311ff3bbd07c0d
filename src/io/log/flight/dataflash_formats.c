/* SPDX-License-Identifier: Apache-2.0 */
/* What a DataFlash log says of its own messages: FMT, FMTU, UNIT, MULT. */
#include "dataflash_internal.h"

#include <string.h>

typedef struct type_letter {
    char letter;
    imki_flight_type type; /* NONE: no number that is read */
    unsigned char size, count;
} type_letter;

/* [DATAFLASH, format types]; g is a number of 16 bits with a point. */
static const type_letter letters[] = {
    {'a', IMKI_FLIGHT_INT16, 2, 32}, {'b', IMKI_FLIGHT_INT8, 1, 1},
    {'B', IMKI_FLIGHT_UINT8, 1, 1},  {'h', IMKI_FLIGHT_INT16, 2, 1},
    {'H', IMKI_FLIGHT_UINT16, 2, 1}, {'i', IMKI_FLIGHT_INT32, 4, 1},
    {'I', IMKI_FLIGHT_UINT32, 4, 1}, {'f', IMKI_FLIGHT_FLOAT, 4, 1},
    {'d', IMKI_FLIGHT_DOUBLE, 8, 1}, {'n', IMKI_FLIGHT_NONE, 4, 1},
    {'N', IMKI_FLIGHT_NONE, 16, 1},  {'Z', IMKI_FLIGHT_NONE, 64, 1},
    {'c', IMKI_FLIGHT_INT16, 2, 1},  {'C', IMKI_FLIGHT_UINT16, 2, 1},
    {'e', IMKI_FLIGHT_INT32, 4, 1},  {'E', IMKI_FLIGHT_UINT32, 4, 1},
    {'L', IMKI_FLIGHT_INT32, 4, 1},  {'M', IMKI_FLIGHT_UINT8, 1, 1},
    {'q', IMKI_FLIGHT_INT64, 8, 1},  {'Q', IMKI_FLIGHT_UINT64, 8, 1},
    {'g', IMKI_FLIGHT_NONE, 2, 1}};

static const type_letter *letter_of(char wanted)
{
    for (size_t i = 0; i < sizeof letters / sizeof letters[0]; i++)
        if (letters[i].letter == wanted)
            return &letters[i];
    return NULL;
}

/* A text that ends with its room or a 0; what is not printed ends it, too. */
static void copy_text(const char *from, size_t room, char *to)
{
    size_t size = 0;
    for (; size < room && from[size] > ' ' && from[size] <= '~'; size++)
        to[size] = from[size];
    to[size] = '\0';
}

/* Do the types make up the length? */
static bool is_sound(const imki_dataflash_format *format)
{
    size_t length = IMKI_DATAFLASH_HEADER;
    for (const char *type = format->types; *type; type++) {
        const type_letter *known = letter_of(*type);
        if (!known)
            return false;
        length += (size_t)known->size * known->count;
    }
    return length == format->length;
}

/* Has each field a name? */
static bool is_named(const imki_dataflash_format *format)
{
    size_t names = 1;
    for (const char *at = format->labels; *at; at++)
        names += *at == ',';
    return names == strlen(format->types);
}

/* Logs put together begin with an FMT for FMT each; where there is none, FMTs stand together. */
static void note_joint(imki_dataflash *flash, int number, uint64_t place)
{
    const bool head = number == IMKI_DATAFLASH_FMT && place > flash->log.begin;
    if (head || (!flash->joined && !flash->defining))
        flash->joint = place;
    flash->joined |= head;
    flash->defining = true;
}

/* The plans that are made by a number are to be made anew. */
static void unplan(imki_dataflash *flash, int number)
{
    for (int i = 0; i < IMKI_DATAFLASH_SENSORS; i++)
        if (flash->planned[i] == number + 1)
            flash->planned[i] = 0;
}

bool imki_dataflash_define(imki_dataflash *flash, const char *message, uint64_t place, bool learns)
{
    const int number = (unsigned char)message[3];
    imki_dataflash_format *format = &flash->format[number];
    imki_dataflash_format made = {.length = (unsigned char)message[4], .sensor = -1};
    note_joint(flash, number, place);
    made.number = number;
    made.place = place;
    made.joint = flash->joint;
    copy_text(message + 5, 4, made.name);
    copy_text(message + 9, IMKI_DATAFLASH_FIELDS, made.types);
    copy_text(message + 25, 64, made.labels);
    const bool sound = is_sound(&made);
    if (!sound) /* the messages can be passed over, but not read */
        made.types[0] = '\0';
    const bool known = format->name[0] != '\0';
    if (known && format->length == made.length && strcmp(format->name, made.name) == 0 &&
        strcmp(format->types, made.types) == 0 && strcmp(format->labels, made.labels) == 0)
        return true;
    if (!made.name[0] || made.length < IMKI_DATAFLASH_HEADER ||
        (number == IMKI_DATAFLASH_FMT ? known || made.length != format->length
                                      : known && (!sound || !is_named(&made))))
        return !learns;
    if (!known && !learns)
        return true;
    made.sensor = imki_dataflash_sensor(made.name);
    made.instance = imki_dataflash_field(&made, "I", NULL);
    *format = made;
    if (known)
        flash->log.redefined = true;
    else
        flash->first[number] = made;
    unplan(flash, number);
    return true;
}

void imki_dataflash_restore(imki_dataflash *flash)
{
    memcpy(flash->format, flash->first, sizeof flash->format);
    memset(flash->planned, 0, sizeof flash->planned);
    flash->joint = 0;
    flash->joined = flash->defining = false;
}

/* @return the letter of the field, NULL: there is none */
static const type_letter *find(const imki_dataflash_format *format, const char *label,
                               size_t *place, size_t *index)
{
    const char *at = format->labels;
    *place = IMKI_DATAFLASH_HEADER;
    for (*index = 0; format->types[*index]; ++*index) {
        const size_t size = strcspn(at, ",");
        const type_letter *type = letter_of(format->types[*index]);
        if (strlen(label) == size && memcmp(at, label, size) == 0)
            return type;
        *place += (size_t)type->size * type->count;
        at += size + (at[size] == ',');
    }
    return NULL;
}

imki_flight_field imki_dataflash_field(const imki_dataflash_format *format, const char *label,
                                       size_t *index)
{
    size_t place, which;
    const type_letter *type = find(format, label, &place, &which);
    if (index)
        *index = which;
    return type ? (imki_flight_field){type->type, place, type->count}
                : (imki_flight_field){IMKI_FLIGHT_NONE, 0, 0};
}

static const char *text_field(const imki_dataflash_format *format, const char *label, char letter,
                              const char *message)
{
    size_t place, index;
    const type_letter *type = find(format, label, &place, &index);
    return type && type->letter == letter ? message + place : NULL;
}

/* Is it what the same FMT said? */
static bool is_same(const imki_dataflash_format *a, const imki_dataflash_format *b)
{
    return a->number == b->number && a->place == b->place;
}

static void learn_fields(imki_dataflash *flash, int number, const char *units,
                         const char *multipliers)
{
    imki_dataflash_format *of = &flash->format[number], *first = &flash->first[number];
    if (is_same(of, first) && !flash->log.surveying)
        return;
    copy_text(units, IMKI_DATAFLASH_FIELDS, of->units);
    copy_text(multipliers, IMKI_DATAFLASH_FIELDS, of->multipliers);
    if (is_same(of, first))
        *first = *of;
    for (int i = 0; i < IMKI_DATAFLASH_SENSORS && flash->log.surveying; i++)
        if (flash->basis[i].length > 0 && is_same(of, &flash->basis[i]))
            flash->basis[i] = *of;
    unplan(flash, number);
}

void imki_dataflash_learn(imki_dataflash *flash, const imki_dataflash_format *format,
                          const char *message)
{
    if (strcmp(format->name, "FMTU") == 0) {
        const imki_flight_field number = imki_dataflash_field(format, "FmtType", NULL);
        const char *units = text_field(format, "UnitIds", 'N', message);
        const char *multipliers = text_field(format, "MultIds", 'N', message);
        if (number.type == IMKI_FLIGHT_NONE || !units || !multipliers)
            return;
        learn_fields(flash, (int)(imki_flight_whole(&number, message) & 0xFF), units, multipliers);
        return;
    }
    if (!flash->log.surveying)
        return;
    const imki_flight_field id = imki_dataflash_field(format, "Id", NULL);
    if (id.type == IMKI_FLIGHT_NONE)
        return;
    const size_t letter = imki_flight_whole(&id, message) & 0xFF;
    const char *label = text_field(format, "Label", 'Z', message);
    const imki_flight_field multiplier = imki_dataflash_field(format, "Mult", NULL);
    if (strcmp(format->name, "UNIT") == 0 && label)
        copy_text(label, sizeof flash->unit[letter] - 1, flash->unit[letter]);
    else if (strcmp(format->name, "MULT") == 0 && multiplier.type == IMKI_FLIGHT_DOUBLE)
        flash->multiplier[letter] = imki_flight_number(&multiplier, message, 0);
}
