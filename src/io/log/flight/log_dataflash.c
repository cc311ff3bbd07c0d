/* SPDX-License-Identifier: Apache-2.0 */
/* Logs of ArduPilot [DATAFLASH]; see flight_log.c. */
#include "dataflash_internal.h"

#include <stdlib.h>
#include <string.h>

/* The same log as text: "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns". */
static const char as_text[] = "FMT, 128, 89, ";

static bool recognise(const char *begin, size_t size)
{
    return size >= sizeof as_text - 1 && memcmp(begin, as_text, sizeof as_text - 1) == 0;
}

/* The units of all formats are known only behind the first rows. */
static void settle(imk_log_reader *reader)
{
    imki_dataflash *flash = reader->state;
    for (int i = 0; i < IMKI_DATAFLASH_SENSORS; i++)
        if (flash->basis[i].length > 0)
            imki_dataflash_plan(flash, &flash->basis[i], i, &flash->plan[i]);
}

static imk_status open_dataflash(imk_log_reader *reader, imk_error *error)
{
    imki_log_text *text = &reader->text;
    const size_t size = (size_t)(text->end - text->next);
    if (recognise(text->next, size))
        return imk_error_set(error, IMK_ERROR_FORMAT, "",
                             "this is a DataFlash log that was written out as text",
                             "give the .bin file that it was made from");
    if (size < 2 || memcmp(text->next, "\xA3\x95", 2) != 0)
        return imk_error_set(error, IMK_ERROR_FORMAT, "",
                             "the first bytes are not those of a DataFlash log",
                             "a .bin file that ArduPilot wrote");
    imki_dataflash *flash = calloc(1, sizeof *flash);
    reader->state = flash;
    if (!flash)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    for (int i = 0; i < 256; i++)
        flash->first[i] = (imki_dataflash_format){.number = i, .sensor = -1};
    flash->first[IMKI_DATAFLASH_FMT].length = IMKI_DATAFLASH_FMT_LENGTH;
    imki_dataflash_restore(flash);
    flash->log.next = imki_dataflash_next;
    flash->log.forget = imki_dataflash_forget;
    flash->log.settle = settle;
    flash->log.nothing = "the log holds no messages of gyros or accelerometers";
    return imki_flight_open(reader, error);
}

const imki_log_codec imki_log_dataflash = {.recognise = recognise,
                                           .defines_units = true,
                                           .open = open_dataflash,
                                           .read = imki_flight_read,
                                           .close = imki_flight_close,
                                           .seek = imki_flight_seek};
