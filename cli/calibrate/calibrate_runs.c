/* SPDX-License-Identifier: Apache-2.0 */
/* --procedure repeatability of models, each the calibration of a power cycle: bias and scale factor
 * are compared. */
#include "calibrate_parts.h"

#include "imukit/names.h"

#include <stdlib.h>
#include <string.h>

bool session_has_run_models(const session *b)
{
    if (!b->options->procedure || strcmp(b->options->procedure, "repeatability") != 0)
        return false;
    for (size_t k = 0; k < b->count; k++)
        if (imk_is_script_name(b->path[k]))
            return true;
    return false;
}

int session_compare_models(session *b)
{
    imk_error error;
    const imk_model *run[IMK_TEST_RECORDS_MAX];
    imk_model *model = command_zeroed(b->count * sizeof *model);
    int code = -1;
    for (size_t k = 0; code < 0 && k < b->count; k++) {
        run[k] = &model[k];
        code = imk_is_script_name(b->path[k])
                   ? command_model(b->path[k], &model[k], NULL)
                   : command_misused("--procedure repeatability: %s is a log and others are "
                                     "models: calibrate each run first, or give logs only",
                                     b->path[k]);
    }
    if (code < 0)
        code = session_known_before(b);
    if (code < 0)
        code = session_done(b, imk_calibrate_log_compare(b->found, run, b->path, &error), &error);
    free(model);
    return code;
}
