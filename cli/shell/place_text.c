/* SPDX-License-Identifier: Apache-2.0 */
/* Latitude, longitude and height of --position. */
#include "place_text.h"

#include <math.h>
#include <string.h>

static const double degree = 0.017453292519943295;

int place_parse(const char *text, imk_geodetic *place)
{
    static const char *const unit[3] = {"deg", "deg", "m"};
    static const char *const name[3] = {"latitude", "longitude", "height"};
    double value[3];
    const char *item = text;
    for (int i = 0; i < 3; i++) {
        const size_t length = strcspn(item, ",");
        double sigma;
        size_t count;
        imk_error error;
        const bool read = imk_quantity_parse(item, item + length, imk_unit_of(unit[i]).dimension, 1,
                                             &value[i], &sigma, &count, NULL, &error) == IMK_OK;
        if (read && i < 2 && !item[length])
            return command_misused("--position \"%s\": the %s is missing; expected latitude, "
                                   "longitude, height, such as \"34.25 deg, 108.91 deg, 380 m\"",
                                   text, name[i + 1]);
        if (!read || (i < 2) != (item[length] == ','))
            return command_misused("--position \"%s\": the %s cannot be read; expected latitude, "
                                   "longitude, height, such as \"34.25 deg, 108.91 deg, 380 m\"",
                                   text, name[i]);
        if (sigma > 0)
            return command_misused(
                "--position \"%s\": the %s takes no uncertainty; leave out its +-", text, name[i]);
        item += length + 1;
    }
    if (!(fabs(value[0]) <= 90.0 * degree) || !(fabs(value[1]) <= 360.0 * degree))
        return command_misused(
            "--position \"%s\": the latitude must be within 90 deg, the longitude within 360 deg",
            text);
    if (!(value[2] >= -1e4 && value[2] <= 1e5))
        return command_misused("--position \"%s\": the height must be between -10 and 100 km",
                               text);
    *place = (imk_geodetic){value[0], value[1], value[2]};
    return -1;
}
