/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzz entry point of the foreign parameter files: any bytes are read or refused, as the format
 * they are recognised as and as one that they are said to be; what is read is written in a format,
 * and that reads back. Trying all pairs of formats, up to 110 of ten formats, took 20 ms an input:
 * the bytes choose one. Reads: src/io/foreign/parameter_airsim.c
 * src/io/foreign/parameter_ardupilot.c src/io/foreign/parameter_dlio.c
 * src/io/foreign/parameter_expression.c src/io/foreign/parameter_fast_lio.c
 * src/io/foreign/parameter_file.c src/io/foreign/parameter_filter.c
 * src/io/foreign/parameter_fusion.c src/io/foreign/parameter_gazebo.c
 * src/io/foreign/parameter_glim.c src/io/foreign/parameter_gnss_ins_sim.c
 * src/io/foreign/parameter_gtsam.c src/io/foreign/parameter_kalibr.c
 * src/io/foreign/parameter_lio_sam.c src/io/foreign/parameter_matlab.c
 * src/io/foreign/parameter_navego.c src/io/foreign/parameter_nodes.c
 * src/io/foreign/parameter_orb_slam3.c src/io/foreign/parameter_px4.c
 * src/io/foreign/parameter_recognise.c src/io/foreign/parameter_values.c
 * src/io/foreign/parameter_vins.c */
#include "harness.h"

#include "imukit/parameter_file.h"

#include <stdlib.h>
#include <string.h>

enum { FORMATS = IMK_PARAMETERS_FUSION };

/* Write a model in a format and read that again. A value near the edge of what is plausible may
 * leave it in another unit, a model may hold nothing that fits, it may lack the random walk that
 * the program needs, and the program may have no place for one. */
static void check_written(const imk_model *model, imk_parameter_settings settings,
                          imk_parameter_format format)
{
    char *text = NULL;
    size_t text_size;
    imk_model back;
    imk_error error = {.status = IMK_OK};
    settings.format = format;
    settings.sensor = NULL;
    const imk_status status =
        imk_parameters_print(NULL, &settings, model, &text, &text_size, NULL, &error);
    require_told(status, &error);
    require(status == IMK_OK || status == IMK_ERROR_RANGE || status == IMK_ERROR_UNSUPPORTED ||
            status == IMK_ERROR_NOT_FINITE || status == IMK_ERROR_CONFLICT ||
            (status == IMK_ERROR_KEY_MISSING && strstr(error.found, "(K)")));
    if (status == IMK_OK)
        require(imk_parameters_parse(text, text_size, &settings, &back, NULL, NULL) == IMK_OK);
    free(text);
}

/* @return whether it was read */
static bool check_read(const uint8_t *data, size_t size, const imk_parameter_settings *settings,
                       imk_model *model)
{
    imk_parameter_notes notes;
    imk_error error = {.status = IMK_OK};
    const imk_status status =
        imk_parameters_parse((const char *)data, size, settings, model, &notes, &error);
    require_told(status, &error);
    if (status == IMK_OK)
        require(imk_model_validate(model, NULL) == IMK_OK);
    return status == IMK_OK;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    imk_model model;
    const uint32_t choice = choice_of(data, size);
    imk_parameter_settings settings = imk_parameter_default();
    settings.rate = 100;
    settings.frame_rate = 10;
    settings.use_bounds = choice / FORMATS / FORMATS % 2 == 1;
    settings.bias_instability_tau = choice / FORMATS / FORMATS / 2 % 2 == 1 ? 30 : 0;
    bool is_read = check_read(data, size, &settings, &model);
    if (!is_read) {
        settings.format = (imk_parameter_format)(1 + choice % FORMATS);
        is_read = check_read(data, size, &settings, &model);
    }
    if (is_read)
        check_written(&model, settings, (imk_parameter_format)(1 + choice / FORMATS % FORMATS));
    return 0;
}
