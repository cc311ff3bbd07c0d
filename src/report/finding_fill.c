/* SPDX-License-Identifier: Apache-2.0 */
/* The braces of a message filled in with what a finding holds; finding_text.c lists them. */
#include "finding_fill_internal.h"

#include "imukit/allan.h"
#include "imukit/units.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

void imki_finding_put(imki_finding_writing *w, const char *text, size_t length)
{
    for (size_t i = 0; i < length; i++, w->length++)
        if (w->length + 1 < w->size)
            w->text[w->length] = text[i];
}

/* One of two words about a sensor; NULL: `how` asks for none. */
static const char *sensor_word(double sensor, char how)
{
    return how == 'k'   ? (sensor == 0 ? "gyro" : "accel")
           : how == 'p' ? (sensor == 0   ? "gyros"
                           : sensor == 1 ? "accelerometers"
                                         : "magnetometer")
           : how == 'q' ? (sensor == 0 ? "rate" : "specific force")
                        : NULL;
}

/* In a readable unit for its size, of the same dimension as the unit `si`. */
static void put_quantity(imki_finding_writing *w, double number, const char *si)
{
    const imk_unit unit = imk_unit_readable(imk_unit_of(si).dimension, number);
    char text[80];
    snprintf(text, sizeof text, "%.5g %s", number / unit.scale, unit.text);
    imki_finding_put(w, text, strlen(text));
}

/* A number, written as the letters after its index say. */
static void put_number(imki_finding_writing *w, double number, const char *how, size_t length)
{
    char format[16], text[64];
    if (length == 1 && *how == 's') {
        imki_finding_put(w, "s", number == 1 ? 0 : 1);
        return;
    }
    const char *sensor = length == 1 ? sensor_word(number, *how) : NULL;
    if (sensor) {
        imki_finding_put(w, sensor, strlen(sensor));
        return;
    }
    if (length == 1 && (*how == 'a' || *how == 't')) {
        const char *word = *how == 'a' ? imk_allan_name((imk_allan_statistic)number)
                                       : imk_status_text((imk_status)number);
        imki_finding_put(w, word, strlen(word));
        return;
    }
    snprintf(format, sizeof format, "%%%.*s", (int)(length > 0 ? length : 3),
             length > 0 ? how : ".0f");
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
    const int written = snprintf(text, sizeof text, format, number);
#pragma GCC diagnostic pop
    imki_finding_put(w, text, written > 0 ? strlen(text) : 0);
}

/* The text for a placeholder, "{name}" or "{0g}", of `length` characters without its last. */
static void put_place(imki_finding_writing *w, const char *place, size_t length,
                      const imk_finding *finding)
{
    const size_t first = strcspn(finding->name, "\t");
    const char *other = finding->name[first] ? finding->name + first + 1 : "";
    if (strncmp(place, "{name}", 6) == 0)
        imki_finding_put(w, finding->name, first);
    else if (strncmp(place, "{other}", 7) == 0)
        imki_finding_put(w, other, strlen(other));
    else if (strncmp(place, "{record}", 8) == 0)
        imki_finding_put(w, w->record, strlen(w->record));
    else if (strncmp(place, "{model}", 7) == 0)
        imki_finding_put(w, w->model, strlen(w->model));
    else if (strncmp(place + 2, "u}", 2) == 0)
        put_quantity(w, finding->number[place[1] - '0'], finding->name);
    else
        put_number(w, finding->number[place[1] - '0'], place + 2, length - 2);
}

static void put_message(imki_finding_writing *w, const char *message, const imk_finding *finding)
{
    bool told = true;
    for (const char *c = message; *c;) {
        const size_t plain = strcspn(c, "{");
        if (told)
            imki_finding_put(w, c, plain);
        c += plain;
        if (!*c)
            return;
        const size_t length = strcspn(c, "}");
        const char how = c[length - 1];
        if (how == '?' || how == '!')
            told = length == 2 || (finding->number[c[1] - '0'] != 0) == (how == '?');
        else if (told)
            put_place(w, c, length, finding);
        c += length + 1;
    }
}

size_t imki_finding_fill(imki_finding_writing *w, const char *message, const imk_finding *finding)
{
    put_message(w, message, finding);
    if (w->size > 0)
        w->text[w->length < w->size ? w->length : w->size - 1] = '\0';
    return w->length;
}
