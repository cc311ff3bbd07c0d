/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzz entry point of the model file: any bytes are read or refused; a model that is read is
 * written with its document as the same bytes, and without it as a text that reads back to the
 * same model.
 * Reads: src/io/model/document.c src/io/model/model_file.c src/io/model/model_items.c
 * src/io/model/model_yaml_correlation.c src/io/model/model_yaml_edit.c
 * src/io/model/model_yaml_fields.c src/io/model/model_yaml_read.c src/io/model/model_yaml_values.c
 * src/io/model/model_yaml_write.c */
#include "harness.h"

#include "imukit/model_file.h"

#include <stdlib.h>
#include <string.h>

/* Write without the document, read, compare, and write again. */
static void check_canonical(const imk_model *model)
{
    char *text = NULL, *again = NULL;
    size_t text_size, again_size;
    imk_model back;
    require(imk_model_print(model, NULL, &text, &text_size, NULL) == IMK_OK);
    require(imk_model_parse(text, text_size, &back, NULL, NULL) == IMK_OK);
    require(imk_model_equal(model, &back));
    require(imk_model_print(&back, NULL, &again, &again_size, NULL) == IMK_OK);
    require(text_size == again_size && memcmp(text, again, text_size) == 0);
    free(text);
    free(again);
}

/* Change one field: the edited document says the changed model. */
static void check_edited(imk_model model, const imk_document *document)
{
    char *text = NULL;
    size_t size;
    imk_model back;
    imk_triad *triad = model.gyro.present ? &model.gyro : &model.accel;
    triad->bias.fixed.value[0] = triad->bias.fixed.value[0] == 1 ? 2 : 1;
    triad->noise.ramp = (imk_axes){.value = {0}};
    require(imk_model_print(&model, document, &text, &size, NULL) == IMK_OK);
    require(imk_model_parse(text, size, &back, NULL, NULL) == IMK_OK);
    require(imk_model_equal(&model, &back));
    free(text);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    imk_model model;
    imk_document *document = NULL;
    imk_error error = {.status = IMK_OK};
    imk_status status = imk_model_parse((const char *)data, size, &model, &document, &error);
    require_told(status, &error);
    if (status != IMK_OK)
        return 0;
    char *same = NULL;
    size_t same_size;
    require(imk_model_print(&model, document, &same, &same_size, NULL) == IMK_OK);
    require(same_size == size && memcmp(same, data, size) == 0);
    free(same);
    check_canonical(&model);
    check_edited(model, document);
    imk_document_free(document);
    return 0;
}
