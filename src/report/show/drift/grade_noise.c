/* SPDX-License-Identifier: Apache-2.0 */
/* The noise of graded models as Allan deviations, each as one curve: what all its terms make
 * together, on the worst axis. */
#include "grade_show_internal.h"

#include "report/page_internal.h"
#include "report/result_internal.h"

#include <math.h>

/* From 10 ms to 10,000 s. */
enum { TIMES_PER_DECADE = 8, TIMES = 6 * TIMES_PER_DECADE + 1 };

static const imk_triad *triad_of(const imk_graded *one, bool gyro)
{
    return gyro ? &one->model->gyro : &one->model->accel;
}

static bool has_noise(const imk_graded *one, bool gyro)
{
    return triad_of(one, gyro)->present && imki_noise_deviation(triad_of(one, gyro), 1) > 0;
}

static bool any_has_noise(const imk_graded_several *r, bool gyro)
{
    bool any = false;
    for (size_t m = 0; m < r->count; m++)
        any = any || has_noise(r->graded[m], gyro);
    return any;
}

static void add_panel(const imk_graded_several *r, bool gyro, imk_figure_builder *figure)
{
    const double unit = imk_unit_of(gyro ? "deg/h" : "ug").scale;
    imk_figure_panel(
        figure, &(imk_panel){.title = gyro ? "gyroscopes" : "accelerometers",
                             .x_label = "averaging time [s]",
                             .y_label = gyro ? "Allan deviation [deg/h]" : "Allan deviation [ug]",
                             .x_logarithmic = true,
                             .y_logarithmic = true,
                             .key = IMK_KEY_BELOW,
                             .allan_deviation = true});
    for (size_t m = 0; m < r->count; m++) {
        if (!has_noise(r->graded[m], gyro))
            continue;
        imki_begin_curve(figure, r->name[m], IMK_CURVE_LINE, (int)m);
        for (int i = 0; i < TIMES; i++) {
            const double time = 0.01 * pow(10, (double)i / TIMES_PER_DECADE);
            imk_figure_point(figure, time,
                             imki_noise_deviation(triad_of(r->graded[m], gyro), time) / unit);
        }
    }
}

void imki_show_grade_noise(const imk_graded_several *r, imk_result *result)
{
    if (!any_has_noise(r, true) && !any_has_noise(r, false))
        return;
    imk_result_heading(result, "Noise");
    imk_figure_builder *figure = imk_result_figure(
        result, "Allan deviation of the noise that the models state", 2,
        "All noise terms of a model together, on its worst axis. What rounded readings add is left "
        "out, because it depends on their rate.");
    for (int gyro = 1; gyro >= 0; gyro--)
        if (any_has_noise(r, gyro))
            add_panel(r, gyro, figure);
}
