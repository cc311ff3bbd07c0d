/* SPDX-License-Identifier: Apache-2.0 */
/* Results become JSON, text, a page and a drawing. */
#include "show.h"
#include "voice.h"

#include "imukit/figure_file.h"
#include "imukit/model_file.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

imk_result *show_begin(const char *name)
{
    imk_result *result = imk_result_create(NULL);
    (void)command_unless_memory(result ? IMK_OK : IMK_ERROR_MEMORY);
    imk_result_text(result, "imukit", imk_version());
    imk_result_text(result, "command", name);
    return result;
}

void show_origin(imk_result *result)
{
    imk_result_heading(result, "This page was made by");
    imk_result_code(result, command_line());
}

void show_warnings(imk_result *result)
{
    for (size_t i = 0; i < told_count(); i++)
        if (told_get(i)->level == IMK_FINDING_WARNING)
            imk_result_finding(result, 2, told_get(i)->message);
}

void show_model(imk_result *result, const char *title, const imk_model *model)
{
    char *text = NULL, reason[900];
    size_t size;
    imk_error error;
    imk_result_heading(result, title);
    if (command_unless_memory(imk_model_print(model, NULL, &text, &size, &error)) == IMK_OK) {
        imk_result_code(result, text);
    } else {
        imk_error_text(&error, NULL, reason, sizeof reason);
        imk_result_line(result, "%s", reason);
    }
    free(text);
}

void show_judge(imk_result *result, const char *format, ...)
{
    const size_t warnings = told_warnings();
    char good[200], more[60] = "";
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(good, sizeof good, format, arguments);
    va_end(arguments);
    const told *first = NULL;
    for (size_t i = told_count(); i-- > 0;)
        first = told_get(i)->level == IMK_FINDING_WARNING ? told_get(i) : first;
    if (warnings > 1)
        snprintf(more, sizeof more, "; and %zu more warning%s", warnings - 1,
                 warnings == 2 ? "" : "s");
    if (first)
        imk_result_judge(result, IMK_USABLE_WITH_CARE, "Usable with care: %s%s.", first->message,
                         more);
    else
        imk_result_judge(result, IMK_USABLE, "Usable: %s.", good);
}

/* @return -1 or the exit code */
static int write_page(const imk_result *result, const char *path)
{
    char *text = NULL;
    size_t size = 0;
    imk_output_file *file;
    imk_error error;
    imk_status status = imk_result_to_page(result, &text, &size, &error);
    if (status == IMK_OK)
        status = imk_output_file_open(path, &file, &error);
    if (status == IMK_OK) {
        imk_output_file_write(file, text, size);
        status = imk_output_file_commit(file, &error);
    }
    free(text);
    return status == IMK_OK ? -1 : command_error(&error, NULL);
}

static void print(const imk_result *result, bool json, FILE *out)
{
    char *text = NULL;
    size_t size = 0;
    imk_status status = IMK_OK;
    if (json)
        status = imk_result_to_json(result, &text, &size);
    else
        status = imk_result_to_text(result, command_color(out, COLOR_BOLD),
                                    command_color(out, COLOR_RESET), &text, &size);
    (void)command_unless_memory(status);
    if (out == stdout)
        voice_result(text, size);
    else
        voice_aside(text, size);
    free(text);
}

void show_aside(const imk_result *result)
{
    print(result, false, stderr);
}

/* Letters have room for less: a figure of their own where there is one. @return -1 or the code */
static int draw(const imk_result *result, const char *plot)
{
    const imk_figure *figure = imk_result_figure_get(result, IMK_FOR_PLOT, 0);
    imk_error error;
    if (!figure && strcmp(plot, "term") == 0)
        figure = imk_result_figure_get(result, IMK_FOR_TERMINAL, 0);
    if (!figure)
        figure = imk_result_figure_get(result, IMK_FOR_PAGE, 0);
    if (!figure)
        figure = imk_result_figure_get(result, IMK_FOR_TERMINAL, 0);
    (void)command_unless_memory(figure ? IMK_OK : IMK_ERROR_MEMORY);
    return imk_figure_write(figure, plot, &error) == IMK_OK ? -1 : command_error(&error, NULL);
}

int show_plot(const imk_result *result, const char *plot)
{
    return draw(result, plot);
}

static int draw_nothing(const char *lacking)
{
    imk_error error;
    (void)imk_error_set(&error, IMK_ERROR_EMPTY, "plot", NULL, lacking);
    return command_error(&error, NULL);
}

/* JSON comes last, since it tells what failed, too. */
int show_end(imk_result *result, const show_options *options, int code)
{
    int failed = options->report ? write_page(result, options->report) : -1;
    if (failed < 0 && !options->json && !options->quiet && !options_stdout_taken())
        print(result, false, stdout);
    if (failed < 0 && options->plot && options->lacking)
        failed = draw_nothing(options->lacking);
    else if (failed < 0 && options->plot)
        failed = draw(result, options->plot);
    if (options->json) {
        told_show(result);
        print(result, true, stdout);
    }
    imk_result_free(result);
    return failed < 0 ? code : failed;
}
