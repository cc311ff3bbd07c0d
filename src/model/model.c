/* SPDX-License-Identifier: Apache-2.0 */
/* The default model: orthogonal triads of gyros and accelerometers without any error. */
#include "imukit/model.h"

#include "model_internal.h"

#include <string.h>

static void set_triad(imk_triad *triad)
{
    triad->present = true;
    triad->axis_count = 3;
    for (int i = 0; i < 3; i++)
        triad->direction[i][i] = 1;
}

void imk_model_default(imk_model *model)
{
    memset(model, 0, sizeof *model);
    model->cookie = IMKI_MODEL_COOKIE;
    set_triad(&model->gyro);
    set_triad(&model->accel);
}

const imk_triad *imk_model_triad(const imk_model *model, int sensor)
{
    return sensor == IMK_GYRO ? &model->gyro : &model->accel;
}

imk_triad *imk_model_triad_to_set(imk_model *model, int sensor)
{
    return sensor == IMK_GYRO ? &model->gyro : &model->accel;
}
