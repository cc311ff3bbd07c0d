/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzz entry point of the texts that come with a log as options: names of columns, units, axes; and
 * of names of a model's parameters. Lines in this order: columns, unit of the gyros, of the
 * accelerometers, of time, of temperature, axes. An empty line, and one that is not there, is an
 * option not given.
 * Reads: src/io/log/log_axes.c src/io/log/log_columns.c src/io/log/csv/log_csv.c
 * src/io/log/csv/log_csv_header.c src/model/model_parameter.c */
#include "harness.h"

#include "imukit/log.h"
#include "imukit/model_parameter.h"

#include <stdlib.h>
#include <string.h>

enum { LINES = 6, ROWS = 4 };

/* Divide at the first line ends. */
static void divide(char *text, const char *line[LINES])
{
    for (size_t i = 0; i < LINES; i++) {
        char *end = text ? strchr(text, '\n') : NULL;
        line[i] = text && *text != '\0' && text != end ? text : NULL;
        if (end)
            *end++ = '\0';
        text = end;
    }
}

static void check_parameter(const char *name)
{
    imk_model_parameter parameter, back;
    char text[IMK_MODEL_PARAMETER_NAME], again[IMK_MODEL_PARAMETER_NAME];
    if (imk_model_parameter_parse(name, &parameter) != IMK_OK)
        return;
    require(imk_model_parameter_name(parameter, text) == IMK_OK);
    require(imk_model_parameter_parse(text, &back) == IMK_OK);
    require(imk_model_parameter_name(back, again) == IMK_OK && strcmp(text, again) == 0);
    require(imk_model_parameter_unit(parameter) != NULL);
}

/* The same rows under the header of a file, or with names from the settings only. */
static void check_log(const char *rows, const imk_log_settings *settings)
{
    double values[IMK_LOG_COLUMNS_MAX][ROWS], *columns[IMK_LOG_COLUMNS_MAX];
    imk_log_reader *reader = NULL;
    imk_error error = {.status = IMK_OK};
    size_t count = 0;
    imk_status status = imk_log_open_memory(rows, strlen(rows), settings, &reader, &error);
    require_told(status, &error);
    if (status != IMK_OK)
        return;
    require(imk_log_column_count(reader) >= 1);
    for (size_t i = 0; i < IMK_LOG_COLUMNS_MAX; i++)
        columns[i] = values[i];
    status = imk_log_read(reader, ROWS, columns, &count, &error);
    require_told(status, &error);
    imk_log_close(reader);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const char *line[LINES];
    char *text = malloc(size + 1);
    if (!text)
        return 0;
    memcpy(text, data, size);
    text[size] = '\0';
    divide(text, line);
    imk_log_settings settings = imk_log_default();
    settings.columns = line[0];
    settings.gyro_unit = line[1];
    settings.accel_unit = line[2];
    settings.time_unit = line[3];
    settings.temperature_unit = line[4];
    settings.axes = line[5];
    check_parameter(line[0] ? line[0] : "");
    check_log("0,1,2,3,4,5,6\n1,1,2,3,4,5,6\n2,1,2,3,4,5,7\n", &settings);
    settings.rate = 100.0;
    check_log("0 1\n1 2\n2 3\n", &settings);
    settings.columns = NULL;
    check_log("t,gyro_x,gyro_y,gyro_z,acc_x,acc_y,acc_z,temp\n0,1,2,3,4,5,6,25\n1,1,2,3,4,5,7,26\n",
              &settings);
    free(text);
    return 0;
}
