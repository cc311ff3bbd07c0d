/* SPDX-License-Identifier: Apache-2.0 */
/* Residuals of each pose, and for each log where it was found to stand still. */
#include "calibrate_show_internal.h"

#include <math.h>

enum { POINTS_MAX = 4000, PANELS_MAX = 6, REGIONS_MAX = 400 };

/* A figure that is begun with its first panel. */
typedef struct drawing {
    imk_result *result;
    imk_figure_builder *figure;
    size_t panels;
} drawing;

static void add_panel(drawing *d, const imk_panel *panel)
{
    if (d->panels++ == 0)
        d->figure =
            imk_result_figure(d->result, "calibration", 2,
                              "Residuals of each observation, and for each log the scatter within "
                              "a short window divided by the threshold from the noise: the unit is "
                              "stationary below the dashed line. Tinted: the intervals found.");
    imk_figure_panel(d->figure, panel);
}

static void show_residuals(const imk_calibrate_log *b, int sensor, drawing *d)
{
    static const imk_panel panels[2] = {
        {.title = "gyro residuals", .x_label = "observation", .y_label = "residual [deg/s]"},
        {.title = "accelerometer residuals", .x_label = "observation", .y_label = "residual [mg]"}};
    static const char *const axes[3] = {"x", "y", "z"};
    static const double scales[2] = {0.017453292519943295, 9.80665e-3};
    bool begun = false;
    for (int axis = 0; axis < 3; axis++) {
        size_t count = 0;
        for (size_t k = 0; k < b->calibration->observation_count && count < POINTS_MAX; k++) {
            const double residual = b->calibration->observation[k].residual[sensor][axis];
            if (!isfinite(residual))
                continue;
            if (!begun)
                add_panel(d, &panels[sensor]);
            begun = true;
            if (count++ == 0)
                imki_begin_curve(d->figure, axes[axis], IMK_CURVE_POINTS, axis);
            imk_figure_point(d->figure, (double)k + 1, residual / scales[sensor]);
        }
    }
}

/* The worst of every stretch of samples, so that no short motion is lost; the intervals found. */
static void show_activity(const imk_calibrate_record *log, drawing *d)
{
    const imk_test_record *record = &log->record;
    const size_t rows = record->count, every = rows / POINTS_MAX + 1;
    double top = 10, end = 0;
    if (!log->activity || rows == 0 || d->panels == PANELS_MAX)
        return;
    add_panel(d, &(imk_panel){.title = record->name,
                              .x_label = "time [s]",
                              .y_label = "scatter / threshold",
                              .y_logarithmic = true,
                              .key = IMK_KEY_BELOW});
    imki_begin_curve(d->figure, "scatter over threshold", IMK_CURVE_POINTS, 0);
    for (size_t row = 0; row < rows; row += every) {
        double most = 0;
        for (size_t k = row; k < row + every && k < rows; k++)
            most = log->activity[k] > most ? log->activity[k] : most;
        end = imk_test_record_time(record, row);
        top = most > top && isfinite(most) ? most : top;
        imk_figure_point(d->figure, end, most > 0 ? most : (double)NAN /* not looked at */);
    }
    imki_begin_curve(d->figure, "threshold", IMK_CURVE_DASHES, 1);
    imk_figure_point(d->figure, imk_test_record_time(record, 0), 1);
    imk_figure_point(d->figure, end, 1);
    for (size_t k = 0; k < log->interval_count && k < REGIONS_MAX; k++)
        imk_figure_region(
            d->figure,
            &(imk_region){.label = "",
                          .color = 2,
                          .x_low = imk_test_record_time(record, log->interval[k].begin),
                          .x_high = imk_test_record_time(record, log->interval[k].end - 1),
                          .y_low = 0.03,
                          .y_high = top});
}

void imki_calibrate_figure(const imk_calibrate_log *b, imk_result *result)
{
    drawing d = {.result = result};
    for (int sensor = 1; sensor >= 0 && b->result; sensor--)
        show_residuals(b, sensor, &d);
    for (size_t k = 0; k < b->count; k++)
        show_activity(&b->record[k], &d);
}
