/* SPDX-License-Identifier: Apache-2.0 */
/* The catalogue: size, mass and supply of devices, as read in data sheets and in copies of them.
 * What could not be read is left out; docs/devices.md lists it. */
#include "imukit/model.h"
#include "imukit/names.h"

#define MM 1e-3
#define SIZE(x, y, z) .size = {(x)*MM, (y)*MM, (z)*MM}
#define GRAM 1e-3
#define MILLI 1e-3

static const char stim300[] = "data sheet TS1524 rev. 24, page 1";
static const char adis16448[] = "data sheet of the ADIS16448 rev. A, page 1";
static const char mpu60x0[] = "data sheet of the MPU-60X0 as public projects copy it";
static const char mti1[] =
    "data sheet MT0512P rev. B, page 1; mass: NitinJSanket/RoboticsHardware, "
    "IMUs.md, for the series";

static const imk_device_build builds[] = {
    {"STIM300", SIZE(38.6, 44.8, 21.5), .source = stim300},
    {"STIM300 measured", SIZE(38.6, 44.8, 21.5), .source = stim300},
    {"HG4930", .current = 400 * MILLI, .is_limit = true,
     .source = "the maker's installation manual, page 5: typically below 400 mA at 5 V"},
    {"Xsens MTi-1", SIZE(12.1, 12.1, 2.6), .mass = 0.66 * GRAM, .power = 45 * MILLI,
     .source = mti1},
    {"Xsens MTi-3", SIZE(12.1, 12.1, 2.6), .mass = 0.66 * GRAM, .power = 45 * MILLI,
     .source = mti1},
    {"VN-100", SIZE(24, 22, 3), .mass = 3.5 * GRAM, .power = 105 * MILLI, .is_limit = true,
     .source = "manual UM001, section 1.4.1 (surface-mount package); mass: "
               "NitinJSanket/RoboticsHardware, IMUs.md"},
    {"ADIS16448 EuRoC", SIZE(24.1, 37.7, 10.8), .source = adis16448},
    {"ADIS16448 RotorS", SIZE(24.1, 37.7, 10.8), .source = adis16448},
    {"ADIS16475-2", SIZE(11, 15, 11), .current = 44 * MILLI,
     .source = "data sheet of the ADIS16475 rev. C as a public collection copies it"},
    {"BMI088", SIZE(3, 4.5, 0.95), .source = "data sheet BST-BMI088-DS001-13, page 2"},
    {"BMI160", SIZE(2.5, 3, 0.8), .current = 0.95 * MILLI,
     .source = "text of the maker in a public driver, os.mbed.com, BMI160"},
    {"BMI270", SIZE(2.5, 3, 0.83), .current = 0.97 * MILLI,
     .source = "data sheet BST-BMI270-DS000-05, page 2; current in performance mode: a copy at "
               "protoboard.xyz"},
    {"ICM-20948", SIZE(3, 3, 1), .source = "data sheet DS-000189 rev. 1.5, page 1"},
    {"ICM-42688-P", SIZE(2.5, 3, 0.91), .current = 0.88 * MILLI,
     .source = "data sheet of the ICM-42688-P, section 1.1 and table 3"},
    {"ICM20602", SIZE(3, 3, 0.75), .source = "a table of parts, blog.csdn.net, 103731233"},
    {"MPU-6000", SIZE(4, 4, 0.9), .source = mpu60x0},
    {"MPU-6050", SIZE(4, 4, 0.9), .current = 3.9 * MILLI, .source = mpu60x0},
    {"MPU-9250", SIZE(3, 3, 1), .source = "data sheet of the MPU-9250 as public projects copy it"},
    {"LSM6DSO", SIZE(2.5, 3, 0.83), .current = 0.55 * MILLI,
     .source = "data sheet DS12140, page 1 (high-performance mode)"},
    {"ISM330DHCX", SIZE(2.5, 3, 0.83),
     .source = "data sheet of the ISM330DHCX as public projects copy it"},
};

const imk_device_build *imk_device_build_find(const char *name)
{
    for (size_t i = 0; name && i < sizeof builds / sizeof builds[0]; i++)
        if (imk_name_equal(name, builds[i].device))
            return &builds[i];
    return NULL;
}
