/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzz entry point of the design file: any bytes are read or refused; what is read is a valid
 * design, which is written and read again with the same bits.
 * Reads: src/io/design/design_file.c src/io/design/design_read.c src/io/design/design_field.c
 * src/io/design/design_print.c */
#include "harness.h"

#include "imukit/design_file.h"

#include <stdlib.h>
#include <string.h>

static void require_same(const imk_design_file *a, const imk_design_file *b)
{
    const imk_instrument *instrument = a->instrument;
    require(b->design && b->instrument == instrument);
    for (size_t i = 0; i < instrument->field_count; i++) {
        const imk_design_field *field = &instrument->fields[i];
        const size_t bytes = field->kind == IMK_DESIGN_NUMBER   ? sizeof(double)
                             : field->kind == IMK_DESIGN_SWITCH ? sizeof(bool)
                                                                : sizeof(int);
        require(memcmp((const char *)a->design + field->offset,
                       (const char *)b->design + field->offset, bytes) == 0);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    imk_design_file file = {.design = NULL}, back = {.design = NULL};
    imk_error error = {.status = IMK_OK};
    char *text = NULL;
    size_t length = 0;
    const imk_status status = imk_design_parse((const char *)data, size, &file, &error);
    require_told(status, &error);
    require((file.design != NULL) == (status == IMK_OK));
    if (status != IMK_OK)
        return 0;
    require(imk_design_check(file.instrument, file.design, NULL) == IMK_OK);
    require(imk_design_print(&file, &text, &length, NULL) == IMK_OK);
    require(imk_design_parse(text, length, &back, NULL) == IMK_OK);
    require_same(&file, &back);
    free(text);
    imk_design_file_free(&back);
    imk_design_file_free(&file);
    return 0;
}
