/* SPDX-License-Identifier: Apache-2.0 */
/* LIO-SAM: imuAccNoise, imuGyrNoise, imuAccBiasN, imuGyrBiasN of params.yaml.
 *
 * imuPreintegration.cpp of TixiaoShan/LIO-SAM gives GTSAM the squares of the first two as
 * continuous covariances (ImuFactor.cpp of GTSAM divides them by dt), and the last two, times the
 * square root of the time between two scans, as standard deviations of the change of the biases.
 * So all four are densities: N and K. */
#include "parameter_internal.h"

static const char *const keys[IMKI_DENSITIES] = {"imuGyrNoise", "imuGyrBiasN", "imuAccNoise",
                                                 "imuAccBiasN"};
static const imki_unit units[IMKI_DENSITIES] = {
    {"rad/s/sqrt(Hz)", 1}, {"rad/s^2/sqrt(Hz)", 1}, {"m/s^2/sqrt(Hz)", 1}, {"m/s^3/sqrt(Hz)", 1}};

void imki_lio_sam_read(imki_parameters *p)
{
    if (!imki_parameters_document(p))
        return;
    const int imu = imki_only_mapping_with(p, IMKI_DENSITIES, keys);
    imki_densities_read_some(p, imu, keys, units);
    imki_note_others(p, imu, IMKI_DENSITIES, keys);
}

void imki_lio_sam_write(imki_parameters *p)
{
    static const char *const comments[IMKI_DENSITIES] = {"[rad/s/sqrt(Hz)]", "[rad/s^2/sqrt(Hz)]",
                                                         "[m/s^2/sqrt(Hz)]", "[m/s^3/sqrt(Hz)]"};
    imki_text_add(
        &p->out,
        "# LIO-SAM: continuous-time, two-sided densities, not standard deviations per "
        "sample.\n"
        "# ROS 1: load this file with rosparam after params.yaml. ROS 2: put the keys "
        "under\n"
        "# /**: ros__parameters:. imuGravity is gravity at the place, not of the sensor.\n");
    imki_text_remarks(p, "# ");
    imki_text_add(&p->out, "lio_sam:\n");
    imki_densities_write(
        p, &(imki_density_lines){
               .keys = keys, .units = comments, .indent = "  ", .scale = 1, .both_needed = true});
}
