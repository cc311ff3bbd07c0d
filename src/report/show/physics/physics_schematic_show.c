/* SPDX-License-Identifier: Apache-2.0 */
/* The schematic of an instrument on a page. */
#include "physics_show_internal.h"

#include "imukit/schematic.h"

#include <stdlib.h>

/* A run that cannot be drawn leaves the drawing still. */
void imki_show_schematic(const imk_physics_shown *p, imk_result *result)
{
    const imk_physics_log_settings *settings = p->settings;
    const imk_schematic *schematic = imk_schematic_of(settings->instrument);
    imk_error error;
    char *svg;
    size_t size;
    if (!schematic)
        return;
    imk_status status = imk_schematic_animated(settings, 0, 0, NULL, &svg, &size, &error);
    if (status != IMK_OK && status != IMK_ERROR_MEMORY)
        status = imk_schematic_svg(settings->instrument, settings->design, &svg, &size, &error);
    if (status == IMK_OK || status == IMK_ERROR_MEMORY)
        imk_result_drawing(result, status == IMK_OK ? svg : NULL, schematic->description);
    if (status == IMK_OK)
        free(svg);
}
