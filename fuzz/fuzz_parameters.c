/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzz entry point of the foreign parameter files: any bytes are read or refused; what is read is
 * written in its own format, and that reads back. */
#include "imukit/parameter_file.h"

#include <stdint.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool condition)
{
    if (!condition)
        abort();
}

/* Write a model in a format and read that again. A value near the edge of what is plausible may
 * leave it in another unit, and a model may hold nothing that fits. */
static void check_written(const imk_model *model, imk_parameter_settings settings,
                          imk_parameter_format format)
{
    char *text = NULL;
    size_t text_size;
    imk_model back;
    imk_error error;
    settings.format = format;
    settings.sensor = NULL;
    imk_status status =
        imk_parameters_print(NULL, &settings, model, &text, &text_size, NULL, &error);
    require(status == IMK_OK || status == error.status);
    require(status == IMK_OK || status == IMK_ERROR_RANGE || status == IMK_ERROR_UNSUPPORTED ||
            status == IMK_ERROR_NOT_FINITE);
    if (status == IMK_OK)
        require(imk_parameters_parse(text, text_size, &settings, &back, NULL, NULL) == IMK_OK);
    free(text);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    imk_model model;
    imk_parameter_notes notes;
    imk_parameter_settings settings = imk_parameter_settings_default();
    settings.rate = 100;
    for (int format = 0; imk_parameter_format_name((imk_parameter_format)(format ? format : 1));
         format++) {
        imk_error error = {.status = IMK_OK};
        settings.format = (imk_parameter_format)format;
        imk_status status =
            imk_parameters_parse((const char *)data, size, &settings, &model, &notes, &error);
        require(status == error.status);
        if (status != IMK_OK)
            continue;
        require(imk_model_validate(&model, NULL) == IMK_OK);
        for (int target = 1; imk_parameter_format_name((imk_parameter_format)target); target++)
            check_written(&model, settings, (imk_parameter_format)target);
    }
    return 0;
}
