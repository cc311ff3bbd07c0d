/* SPDX-License-Identifier: Apache-2.0 */
/* True rates and forces of a motion, part after part of a sample, as the simulator sees them. */
#include "tuning_internal.h"

#include <string.h>

static imk_simulation simulation_of(const imk_filter_tuning_settings *settings, size_t motion)
{
    imk_simulation simulation = imk_simulation_default();
    simulation.rate = settings->rate;
    simulation.motion = settings->motion[motion];
    return simulation;
}

size_t imki_tuning_parts(const imk_model *model, const imk_filter_tuning_settings *settings,
                         size_t motion)
{
    /* Coning and sculling within a sample of a smooth motion are right to a 250th by pairs of a
     * quarter of it, whose error is of fourth order. */
    enum { SMOOTH = 4 };
    const imk_simulation simulation = simulation_of(settings, motion);
    const size_t parts = imki_substeps(model, &simulation);
    if (simulation.motion.recorded)
        return 1;
    return parts < SMOOTH ? SMOOTH : parts + parts % 2;
}

imk_status imki_tuning_scene_start(imki_scene *scene, imk_model *perfect, const imk_model *model,
                                   const imk_filter_tuning_settings *settings, size_t motion,
                                   imki_parts *memory, imk_error *error)
{
    imk_simulation simulation = simulation_of(settings, motion);
    simulation.substeps = imki_tuning_parts(model, settings, motion);
    imk_model_default(perfect);
    perfect->accel.lever_arm = model->accel.lever_arm; /* asks for angular acceleration */
    return imki_scene_start(scene, perfect, &simulation, true, memory, error);
}

void imki_tuning_expose(imki_scene *scene, size_t first, size_t rows, imki_exposed *exposed)
{
    imki_scene_fill(scene, first - 1, rows + 2, NULL);
    const imk_stimulus *stimulus = &scene->stimulus[IMK_ACCEL];
    exposed->rows = rows;
    exposed->parts = scene->substeps;
    for (int i = 0; i < 3; i++) {
        exposed->rate[i] = stimulus->angular_rate[i] + scene->substeps;
        exposed->force[i] = stimulus->specific_force[i] + scene->substeps;
        exposed->acceleration[i] = stimulus->angular_acceleration[i]
                                       ? stimulus->angular_acceleration[i] + scene->substeps
                                       : NULL;
    }
}
