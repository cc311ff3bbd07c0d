/* SPDX-License-Identifier: Apache-2.0 */
/* ORB-SLAM3: IMU.NoiseGyro, IMU.NoiseAcc, IMU.GyroWalk, IMU.AccWalk and IMU.Frequency of the
 * settings file of OpenCV.
 *
 * Tracking.cc of UZ-SLAMLab/ORB_SLAM3 multiplies the noises by sqrt(IMU.Frequency) and divides the
 * walks by it to have them per sample: densities, N and K. Settings.cc, for files of File.version
 * 1.0, reads all five as real numbers, which need a point in most of its versions; the parser of
 * older files in Tracking.cc wants an integer for IMU.Frequency alone. The information of the walk
 * is one over its variance (ImuTypes.cc), so that it cannot be 0. */
#include "parameter_internal.h"

#include <string.h>

static const char *const keys[] = {"IMU.NoiseGyro", "IMU.GyroWalk", "IMU.NoiseAcc", "IMU.AccWalk",
                                   "IMU.Frequency"};
static const imki_unit units[IMKI_DENSITIES] = {
    {"rad/s/sqrt(Hz)", 1}, {"rad/s^2/sqrt(Hz)", 1}, {"m/s^2/sqrt(Hz)", 1}, {"m/s^3/sqrt(Hz)", 1}};

void imki_orb_slam3_read(imki_parameters *p)
{
    if (!imki_parameters_document(p))
        return;
    const int imu = imki_only_mapping_with(p, IMKI_DENSITIES, keys);
    imki_densities_read_some(p, imu, keys, units);
    imki_note_others(p, imu, IMKI_DENSITIES + 1, keys);
}

void imki_orb_slam3_write(imki_parameters *p)
{
    static const char *const comments[IMKI_DENSITIES] = {"[rad/s/sqrt(Hz)]", "[rad/s^2/sqrt(Hz)]",
                                                         "[m/s^2/sqrt(Hz)]", "[m/s^3/sqrt(Hz)]"};
    const double rate = p->settings->rate;
    if (!(rate > 0)) {
        imki_parameter_refuse(p, IMK_ERROR_KEY_MISSING, keys[IMKI_DENSITIES],
                              "\"IMU.Frequency\" is not known, and ORB-SLAM3 stops without it",
                              "add --rate RATE (samples per second, as 200Hz)");
        return;
    }
    imki_text_add(
        &p->out,
        "%%YAML:1.0\n\n# ORB-SLAM3: continuous-time, two-sided densities; it converts them "
        "with IMU.Frequency.\n# These lines belong into the settings file of the camera, "
        "in place of its own.\n");
    imki_text_remarks(p, "# ");
    imki_densities_write(p, &(imki_density_lines){.keys = keys,
                                                  .units = comments,
                                                  .indent = "",
                                                  .scale = 1,
                                                  .both_needed = true,
                                                  .with_point = true});
    const char *rate_text = imki_shortest(rate).text;
    imki_text_add(&p->out, "%s: %s%s  # [Hz]; without File.version 1.0 an integer\n",
                  keys[IMKI_DENSITIES], rate_text, strpbrk(rate_text, ".e") ? "" : ".0");
}
