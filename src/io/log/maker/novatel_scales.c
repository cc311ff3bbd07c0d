/* SPDX-License-Identifier: Apache-2.0 */
/* Types and scale factors as the maker's driver has them, which cites the table of its manual
 * [NOVATEL-DRIVER]. The driver divides the counts of Epson's IMUs by the rate and multiplies by it
 * again: they are rates. Its foot is 1/3.2808 m; the one here is exact. The rates are those of its
 * list of IMUs; where its versions or the name of the type leave two, the lower one. */
#include "novatel_internal.h"

#include <stddef.h>

#define FOOT 0.3048 /* [m] */

static const imki_novatel_imu imus[] = {
    {1, "HG1700 AG11", false, 0x1p-33, 0x1p-27 * FOOT, "rad", "m/s", 100},
    {4, "HG1700 AG17", false, 0x1p-33, 0x1p-26 * FOOT, "rad", "m/s", 100},
    {5, "HG1900 CA29", false, 0x1p-33, 0x1p-27 * FOOT, "rad", "m/s", 100},
    {8, "LN-200", false, 0x1p-19, 0x1p-14, "rad", "m/s", 200},
    {11, "HG1700 AG58", false, 0x1p-33, 0x1p-27 * FOOT, "rad", "m/s", 100},
    {12, "HG1700 AG62", false, 0x1p-33, 0x1p-26 * FOOT, "rad", "m/s", 100},
    {13, "iIMU-FSAS", false, 0.1 * 0x1p-8, 0.05 * 0x1p-15, "arcsec", "m/s", 200},
    {16, "KVH CPT", false, 0.1 / (3600.0 * 256.0), 0.05 * 0x1p-15, "rad", "m/s", 100},
    {20, "HG1930 AA99", false, 0x1p-33, 0x1p-27 * FOOT, "rad", "m/s", 100},
    {26, "ISA-100C", false, 1e-9, 2e-8, "rad", "m/s", 100},
    {27, "HG1900 CA50", false, 0x1p-33, 0x1p-27 * FOOT, "rad", "m/s", 100},
    {28, "HG1930 CA50", false, 0x1p-33, 0x1p-27 * FOOT, "rad", "m/s", 100},
    {31, "ADIS16488", false, 720.0 * 0x1p-31, 200.0 * 0x1p-31, "deg", "m/s", 200},
    {32, "STIM300", false, 0x1p-21, 0x1p-22, "deg", "m/s", 125},
    {33, "KVH1750", false, 0.1 / (3600.0 * 256.0), 0.05 * 0x1p-15, "rad", "m/s", 200},
    {41, "G320N", true, 0.008 * 0x1p-16, 0.2 * 0x1p-16, "deg/s", "mg", 0},
    {52, "Litef microIMU", false, 1e-9, 2e-8, "rad", "m/s", 200},
    {56, "STIM300D", false, 0x1p-21, 0x1p-22, "deg", "m/s", 125},
    {58, "HG4930 AN01", false, 0x1p-33, 0x1p-29, "rad", "m/s", 100},
    {61, "G370N", true, 0.0151515 * 0x1p-16, 0.4 * 0x1p-16, "deg/s", "mg", 0},
    {62, "G320N 200 Hz", true, 0.008 * 0x1p-16, 0.2 * 0x1p-16, "deg/s", "mg", 0},
    {68, "HG4930 AN04", false, 0x1p-33, 0x1p-29, "rad", "m/s", 100},
    {69, "HG4930 AN04 400 Hz", false, 0x1p-33, 0x1p-29, "rad", "m/s", 400},
};

const imki_novatel_imu *imki_novatel_imu_of(unsigned type)
{
    for (size_t i = 0; i < sizeof imus / sizeof imus[0]; i++)
        if (imus[i].type == type)
            return &imus[i];
    return NULL;
}
