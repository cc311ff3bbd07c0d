/* SPDX-License-Identifier: Apache-2.0 */
/* The track as figure and page: where it went, and the distance from the start against time with
 * the band of 1 sigma that the model predicts. */
#include "navigate_parts.h"

#include "shell/page_table.h"

#include "imukit/figure_file.h"

#include <math.h>
#include <stdlib.h>

enum { POINTS_MAX = 4000, PANELS = 4, CURVES = 4 };
enum { NORTH_COLOR = 0, EAST_COLOR = 1, SIGMA_COLOR = 7, LINE_COLOR = 0 };

/* A thinned track, and the curves that show it. */
typedef struct track_figure {
    double *memory, *time, *way[2], *low[2], *high[2], *speed[2];
    imk_curve curve[PANELS][CURVES];
    imk_panel panel[PANELS];
    imk_figure figure;
} track_figure;

static size_t fill(const navigation *n, track_figure *f)
{
    const size_t every = n->track_rows / POINTS_MAX + 1;
    const size_t points = (n->track_rows + every - 1) / every;
    double **arrays[] = {&f->time,    &f->way[0],  &f->way[1],   &f->low[0],  &f->low[1],
                         &f->high[0], &f->high[1], &f->speed[0], &f->speed[1]};
    const size_t array_count = sizeof arrays / sizeof arrays[0];
    f->memory = command_memory(NULL, array_count * points * sizeof(double));
    for (size_t a = 0; a < array_count; a++)
        *arrays[a] = f->memory + a * points;
    for (size_t k = 0; k < points; k++) {
        /* The last point is the last row. */
        const size_t row = k + 1 == points ? n->track_rows - 1 : k * every;
        f->time[k] = n->track[TRACK_TIME][row];
        for (int i = 0; i < 2; i++) {
            f->way[i][k] = n->track[TRACK_NORTH + i][row];
            /* About the start, where a unit that stood is; else about the track. */
            const double middle = navigate_at_rest(n) ? 0.0 : f->way[i][k];
            f->high[i][k] = middle + n->track[TRACK_SIGMA + i][row];
            f->low[i][k] = middle - n->track[TRACK_SIGMA + i][row];
            f->speed[i][k] = n->track[TRACK_VELOCITY + i][row];
        }
    }
    return points;
}

/* One axis against time, between the lines of 1 sigma. */
static size_t axis_curves(const navigation *n, track_figure *f, int axis, size_t count,
                          imk_curve *curve)
{
    const double *const sides[2] = {f->high[axis], f->low[axis]};
    size_t curves = 0;
    for (int side = 0; side < 2 && n->has_model; side++)
        curve[curves++] = (imk_curve){.label = side == 0 ? "1 sigma predicted" : "",
                                      .style = IMK_CURVE_DASHES,
                                      .color = SIGMA_COLOR,
                                      .count = count,
                                      .x = f->time,
                                      .y = sides[side]};
    curve[curves++] = (imk_curve){.label = axis == 0 ? "north" : "east",
                                  .style = IMK_CURVE_LINE,
                                  .color = axis == 0 ? NORTH_COLOR : EAST_COLOR,
                                  .count = count,
                                  .x = f->time,
                                  .y = f->way[axis]};
    return curves;
}

static void make_figure(const navigation *n, track_figure *f)
{
    const size_t count = fill(n, f);
    f->curve[0][0] = (imk_curve){.style = IMK_CURVE_LINE,
                                 .color = LINE_COLOR,
                                 .label = "",
                                 .count = count,
                                 .x = f->way[1],
                                 .y = f->way[0]};
    for (int i = 0; i < 2; i++)
        f->curve[3][i] = (imk_curve){.style = IMK_CURVE_LINE,
                                     .color = i == 0 ? NORTH_COLOR : EAST_COLOR,
                                     .label = i == 0 ? "north" : "east",
                                     .count = count,
                                     .x = f->time,
                                     .y = f->speed[i]};
    static const char *const titles[PANELS] = {"horizontal track", "north", "east", "velocity"};
    static const char *const y_labels[PANELS] = {"north [m]", "from the start [m]",
                                                 "from the start [m]", "velocity [m/s]"};
    for (int p = 0; p < PANELS; p++)
        f->panel[p] = (imk_panel){.title = titles[p],
                                  .x_label = p == 0 ? "east [m]" : "time [s]",
                                  .y_label = y_labels[p],
                                  .curve_count = p == 0 ? 1 : 2,
                                  .key = IMK_KEY_BELOW,
                                  .curves = f->curve[p]};
    for (int axis = 0; axis < 2; axis++)
        f->panel[1 + axis].curve_count = axis_curves(n, f, axis, count, f->curve[1 + axis]);
    f->figure = (imk_figure){n->path, PANELS, 2, f->panel};
}

int navigate_draw(const navigation *n, const char *path)
{
    track_figure f = {0};
    imk_error error;
    make_figure(n, &f);
    const imk_status status = imk_figure_write(&f.figure, path, &error);
    free(f.memory);
    return status == IMK_OK ? -1 : command_error(&error, NULL);
}

static void put_verdict(imk_page *page, const navigation *n)
{
    char text[400];
    navigate_drift_sentence(n, text, sizeof text);
    imk_page_heading(page, "Verdict");
    imk_page_verdict(page, command_warning_count() > 0 ? 1 : 0, text);
    const imk_zero_velocity_counts *c = &n->counts;
    if (c->accepted + c->refused > 0) {
        snprintf(text, sizeof text, "Zero-velocity updates: %llu, refused %llu.",
                 (unsigned long long)c->accepted, (unsigned long long)c->refused);
        imk_page_text(page, text);
    }
    for (size_t k = 0; k < command_warning_count(); k++)
        imk_page_verdict(page, 2, command_warning_get(k)->message);
}

static void put_start(imk_page *page, const navigation *n)
{
    static const double degree = 0.017453292519943295;
    char text[300];
    snprintf(text, sizeof text,
             "%s: roll %.4f, pitch %.4f, yaw %.4f deg; 1 sigma %.2g deg of tilt, %.2g deg of "
             "heading.",
             !n->aligned           ? "Given"
             : n->options->heading ? "Tilt found by the unit itself, at rest; heading given"
                                   : "Found by the unit itself, at rest",
             n->euler[0] / degree, n->euler[1] / degree, n->euler[2] / degree,
             hypot(n->attitude_sigma[0], n->attitude_sigma[1]) / degree,
             n->attitude_sigma[2] / degree);
    imk_page_heading(page, "Attitude at the start");
    imk_page_text(page, text);
}

int navigate_report(const navigation *n, const char *path)
{
    char subtitle[300], length[60];
    track_figure f = {0};
    format_duration(n->dt * (double)n->rows, length, sizeof length);
    snprintf(subtitle, sizeof subtitle, "%.120s: %zu samples, %g Hz, %s", n->path, n->rows,
             1.0 / n->dt, length);
    imk_page *page = imk_page_create("Navigation of a log", subtitle);
    put_verdict(page, n);
    put_start(page, n);
    imk_page_heading(page, "Track");
    make_figure(n, &f);
    imk_page_figure(page, &f.figure,
                    !n->has_model ? "Horizontal track, and position and velocity against time."
                    : navigate_at_rest(n)
                        ? "Grey: 1 sigma of the error that the model predicts, about the start, "
                          "where the unit stood."
                        : "Grey: 1 sigma of the error that the model predicts, about the track.");
    free(f.memory);
    text_table table = navigate_table(n);
    imk_page_heading(page, "At the end");
    page_put_table(page, &table);
    text_table_free(&table);
    imk_page_heading(page, "This page was made by");
    imk_page_code(page, command_line());
    return page_write(page, path);
}
