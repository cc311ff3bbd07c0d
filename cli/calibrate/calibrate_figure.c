/* SPDX-License-Identifier: Apache-2.0 */
/* Residuals of each pose, and for each log where it was found to stand still. */
#include "calibrate_parts.h"

#include "imukit/figure_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { POINTS_MAX = 4000, PANELS_MAX = 6, REGIONS_MAX = 400 };

typedef struct calibrate_figure {
    imk_figure figure;
    imk_panel panel[PANELS_MAX];
    imk_curve curve[PANELS_MAX][4];
    imk_region *region[PANELS_MAX];
    double *memory[PANELS_MAX];
} calibrate_figure;

static void free_figure(calibrate_figure *f)
{
    for (size_t p = 0; p < PANELS_MAX; p++) {
        free(f->memory[p]);
        free(f->region[p]);
    }
    free(f);
}

/* ---- residuals ------------------------------------------------------------------------------- */

/* Points of one axis, from `memory` on. */
static size_t axis_points(const bench *b, int sensor, int axis, double scale, double *x, double *y)
{
    size_t count = 0;
    for (size_t k = 0; k < b->calibration->observation_count && count < POINTS_MAX; k++) {
        const double residual = b->calibration->observation[k].residual[sensor][axis];
        if (!isfinite(residual))
            continue;
        x[count] = (double)k + 1;
        y[count++] = residual / scale;
    }
    return count;
}

static void residual_panel(const bench *b, calibrate_figure *f, int sensor)
{
    static const char *const titles[2] = {"gyro residuals", "accelerometer residuals"};
    static const char *const labels[2] = {"residual [deg/s]", "residual [mg]"};
    static const char *const axes[3] = {"x", "y", "z"};
    const double scales[2] = {0.017453292519943295, 9.80665e-3};
    const size_t p = f->figure.panel_count;
    size_t curves = 0;
    free(f->memory[p]);
    f->memory[p] = command_memory(NULL, 6 * (size_t)POINTS_MAX * sizeof(double));
    for (int axis = 0; axis < 3; axis++) {
        double *x = f->memory[p] + 2 * (size_t)axis * POINTS_MAX, *y = x + POINTS_MAX;
        const size_t count = axis_points(b, sensor, axis, scales[sensor], x, y);
        if (count > 0)
            f->curve[p][curves++] = (imk_curve){.label = axes[axis],
                                                .style = IMK_CURVE_POINTS,
                                                .color = axis,
                                                .count = count,
                                                .x = x,
                                                .y = y};
    }
    if (curves == 0)
        return; /* the memory is freed with the figure, or used by the next panel */
    f->panel[p] = (imk_panel){.title = titles[sensor],
                              .x_label = "observation",
                              .y_label = labels[sensor],
                              .curve_count = curves,
                              .curves = f->curve[p]};
    f->figure.panel_count++;
}

/* ---- activity -------------------------------------------------------------------------------- */

static double time_of(const imk_test_record *record, size_t row)
{
    return record->time ? record->time[row] : (double)row * record->dt;
}

/* The worst of every stretch of samples, so that no short motion is lost. */
static size_t thin(const bench_log *log, double *x, double *y)
{
    const size_t rows = log->record.count, every = rows / POINTS_MAX + 1;
    size_t count = 0;
    for (size_t row = 0; row < rows && count < POINTS_MAX; row += every) {
        double most = 0;
        for (size_t k = row; k < row + every && k < rows; k++)
            most = log->activity[k] > most ? log->activity[k] : most;
        x[count] = time_of(&log->record, row);
        y[count++] = most > 0 ? most : (double)NAN; /* not looked at */
    }
    return count;
}

static void activity_panel(calibrate_figure *f, const bench_log *log)
{
    const size_t p = f->figure.panel_count;
    if (!log->activity || log->record.count == 0 || p == PANELS_MAX)
        return;
    free(f->memory[p]);
    f->memory[p] = command_memory(NULL, (2 * (size_t)POINTS_MAX + 4) * sizeof(double));
    f->region[p] = command_memory(NULL, REGIONS_MAX * sizeof *f->region[p]);
    double *x = f->memory[p], *y = x + POINTS_MAX, *line = y + POINTS_MAX;
    const size_t count = thin(log, x, y);
    double top = 10;
    for (size_t k = 0; k < count; k++) /* NaN is not larger */
        top = y[k] > top && isfinite(y[k]) ? y[k] : top;
    line[0] = x[0], line[1] = x[count - 1], line[2] = line[3] = 1;
    size_t regions = 0;
    for (; regions < log->interval_count && regions < REGIONS_MAX; regions++) {
        const imk_static_interval *i = &log->interval[regions];
        f->region[p][regions] = (imk_region){.label = "",
                                             .color = 2,
                                             .x_low = time_of(&log->record, i->begin),
                                             .x_high = time_of(&log->record, i->end - 1),
                                             .y_low = 0.03,
                                             .y_high = top};
    }
    f->curve[p][0] = (imk_curve){.label = "scatter over threshold",
                                 .style = IMK_CURVE_POINTS,
                                 .color = 0,
                                 .count = count,
                                 .x = x,
                                 .y = y};
    f->curve[p][1] = (imk_curve){.label = "threshold",
                                 .style = IMK_CURVE_DASHES,
                                 .color = 1,
                                 .count = 2,
                                 .x = line,
                                 .y = line + 2};
    f->panel[p] = (imk_panel){.title = log->record.name,
                              .x_label = "time [s]",
                              .y_label = "scatter / threshold",
                              .y_logarithmic = true,
                              .curve_count = 2,
                              .curves = f->curve[p],
                              .region_count = regions,
                              .regions = f->region[p],
                              .key = IMK_KEY_BELOW};
    f->figure.panel_count++;
}

static calibrate_figure *make_figure(const bench *b)
{
    calibrate_figure *f = command_memory(NULL, sizeof *f);
    *f = (calibrate_figure){.figure = {.title = "calibration", .columns = 1, .panels = f->panel}};
    for (int sensor = 1; sensor >= 0 && b->result; sensor--)
        residual_panel(b, f, sensor);
    for (size_t k = 0; k < b->log_count; k++)
        activity_panel(f, &b->log[k]);
    return f;
}

int bench_draw(const bench *b, const char *path)
{
    imk_error error;
    calibrate_figure *f = make_figure(b);
    const imk_status status =
        f->figure.panel_count > 0
            ? imk_figure_write(&f->figure, path, &error)
            : imk_error_set(&error, IMK_ERROR_EMPTY, "plot", NULL, "observations to draw");
    free_figure(f);
    return status == IMK_OK ? -1 : command_error(&error, NULL);
}

void bench_put_figure(const bench *b, imk_page *page)
{
    calibrate_figure *f = make_figure(b);
    if (f->figure.panel_count > 0)
        imk_page_figure(page, &f->figure,
                        "Residuals of each observation, and for each log the scatter within a "
                        "short window over what noise allows: below the dashes it stands still. "
                        "Tinted: the intervals found.");
    free_figure(f);
}
