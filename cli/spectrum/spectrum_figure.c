/* SPDX-License-Identifier: Apache-2.0 */
/* Root densities with their intervals, one panel per kind of sensor, one colour per channel, lines
 * as large points at their peaks. */
#include "spectrum_figure.h"

#include "imukit/figure_file.h"

#include <math.h>
#include <stdlib.h>

struct spectrum_figure {
    imk_figure figure;
    imk_panel panel[CHANNEL_KINDS];
    imk_curve curve[3 * IMK_LOG_COLUMNS_MAX];
    char label[CHANNEL_KINDS][80];
    double *memory;
};

/* Frequencies, root densities and limits in the unit of the panel; then the lines'. */
static void add_channel(spectrum_figure *f, size_t *used, const char *name,
                        const channel_spectrum *c, double sides, double scale, int color,
                        double **rest)
{
    const size_t n = c->plotted_count;
    double *x = *rest, *y = x + n, *lower = y + n, *upper = lower + n;
    double *line_x = upper + n, *line_y = line_x + c->line_count;
    *rest = line_y + c->line_count;
    for (size_t i = 0; i < n; i++) {
        x[i] = c->plotted[i].frequency;
        y[i] = sqrt(sides * c->plotted[i].density) / scale;
        lower[i] = sqrt(sides * c->plotted[i].lower) / scale;
        upper[i] = sqrt(sides * c->plotted[i].upper) / scale;
    }
    for (size_t i = 0; i < c->line_count; i++) {
        line_x[i] = c->line[i].frequency;
        line_y[i] = sqrt(sides * c->line[i].density) / scale;
    }
    f->curve[(*used)++] = (imk_curve){"", IMK_CURVE_BAND, color, n, x, y, lower, upper};
    f->curve[(*used)++] = (imk_curve){name, IMK_CURVE_LINE, color, n, x, y, NULL, NULL};
    if (c->line_count > 0)
        f->curve[(*used)++] =
            (imk_curve){"", IMK_CURVE_MARKS, color, c->line_count, line_x, line_y, NULL, NULL};
}

static void add_panel(spectrum_figure *f, const spectrum_result *result, channel_kind kind,
                      size_t *used, double **rest)
{
    static const char *const titles[] = {"Gyros", "Accelerometers", "Channels"};
    const size_t first = *used, panel = f->figure.panel_count;
    const imk_unit unit = spectrum_root_unit(result, kind);
    int color = 0;
    for (size_t c = 0; c < result->channels.count; c++) {
        const imk_log_column *column = log_channel_column(&result->channels, c);
        if (channel_kind_of(column) == kind)
            add_channel(f, used, column->name, &result->found[c], spectrum_sides(result),
                        unit.scale, color++, rest);
    }
    if (*used == first)
        return;
    snprintf(f->label[panel], sizeof f->label[panel], "root density [%.40s/sqrt(Hz)], %s",
             unit.text, spectrum_sides_text(result));
    f->panel[panel] = (imk_panel){titles[kind], "frequency [Hz]", f->label[panel],  true,
                                  true,         *used - first,    f->curve + first, 0,
                                  NULL,         IMK_KEY_UPPER};
    f->figure.panel_count++;
}

spectrum_figure *spectrum_figure_make(const spectrum_result *result)
{
    spectrum_figure *f = command_memory(NULL, sizeof *f);
    size_t values = 1, used = 0;
    for (size_t c = 0; c < result->channels.count; c++)
        values += 4 * result->found[c].plotted_count + 2 * result->found[c].line_count;
    *f = (spectrum_figure){.memory = command_memory(NULL, values * sizeof *f->memory),
                           .figure = {result->path, 0, 2, f->panel}};
    double *rest = f->memory;
    for (channel_kind kind = CHANNEL_GYRO; kind < CHANNEL_KINDS; kind++)
        add_panel(f, result, kind, &used, &rest);
    return f;
}

const imk_figure *spectrum_figure_get(const spectrum_figure *figure)
{
    return &figure->figure;
}

void spectrum_figure_free(spectrum_figure *figure)
{
    free(figure->memory);
    free(figure);
}

int spectrum_draw(const spectrum_result *result, const char *plot)
{
    imk_error error;
    spectrum_figure *f = spectrum_figure_make(result);
    imk_status status = imk_figure_write(&f->figure, plot, &error);
    spectrum_figure_free(f);
    return status == IMK_OK ? -1 : command_error(&error, NULL);
}
