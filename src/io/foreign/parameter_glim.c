/* SPDX-License-Identifier: Apache-2.0 */
/* GLIM: "sensors" of config_sensors.json.
 *
 * imu_acc_noise and imu_gyro_noise become continuous covariances of GTSAM by being squared
 * (imu_integration.cpp of koide3/glim): N. imu_bias_noise is the standard deviation of the change
 * of all six biases from one frame to the next, whatever their unit and the time between frames
 * (odometry_estimation_imu.cpp): K/sqrt(frames per second), the larger of both sensors. imu_bias is
 * where the biases start, the accelerometers' first. */
#include "parameter_internal.h"

#include <math.h>
#include <string.h>

static const char *const keys[] = {"imu_gyro_noise", "imu_acc_noise", "imu_bias_noise", "imu_bias"};
enum { KEYS = sizeof keys / sizeof keys[0] };
static const imki_unit white_units[2] = {{"rad/s/sqrt(Hz)", 1}, {"m/s^2/sqrt(Hz)", 1}};

static void read_walk(imki_parameters *p, int sensors)
{
    if (imki_node_value(p, sensors, keys[2]) == IMKI_NONE)
        return;
    if (!(p->settings->frame_rate > 0)) {
        imki_note(p, true,
                  "imu_bias_noise is per frame and is not read: add --frame-rate RATE (LiDAR scans "
                  "per second)");
        return;
    }
    const double scale = sqrt(p->settings->frame_rate);
    imki_note(p, false, "imu_bias_noise is one number for gyros and accelerometers: both have it");
    for (int kind = 0; kind < 2; kind++)
        imki_node_accept(
            p, sensors, keys[2], kind, IMKI_RANDOM_WALK,
            (imki_unit){kind == IMK_GYRO ? "rad/s per frame" : "m/s^2 per frame", scale},
            p->triad[kind]->noise.random_walk.value);
}

static void read_bias(imki_parameters *p, int sensors)
{
    const int node = imki_node_value(p, sensors, keys[3]);
    double raw[6] = {0};
    if (node == IMKI_NONE)
        return;
    imki_node_numbers(p, node, 6, raw);
    for (int kind = 0; kind < 2; kind++)
        imki_accept(p, imki_node_place(p, node), kind, IMKI_BIAS, raw + (kind == IMK_GYRO ? 3 : 0),
                    (imki_unit){imki_kind_units[kind], 1}, p->triad[kind]->bias.fixed.value);
}

void imki_glim_read(imki_parameters *p)
{
    if (!imki_parameters_document(p))
        return;
    const int sensors = imki_only_mapping_with(p, KEYS, keys);
    for (int kind = 0; kind < 2; kind++)
        imki_node_accept(p, sensors, keys[kind], kind, IMKI_WHITE, white_units[kind],
                         p->triad[kind]->noise.white.value);
    read_walk(p, sensors);
    read_bias(p, sensors);
    imki_note_others(p, sensors, KEYS, keys);
}

/* The larger K of both sensors, as their numbers are; NaN: the frame rate is not known. */
static double walk_per_frame(imki_parameters *p, const char **of)
{
    double k[2] = {0};
    for (int kind = 0; kind < 2; kind++)
        if (p->origin[kind]->present)
            k[kind] = imki_density(p, 2 * kind + 1, keys[2]);
    *of = k[IMK_GYRO] > k[IMK_ACCEL] ? "gyros" : "accelerometers";
    const double largest = fmax(k[0], k[1]);
    if (largest > 0 && !(p->settings->frame_rate > 0))
        imki_parameter_refuse(p, IMK_ERROR_KEY_MISSING, keys[2],
                              "\"imu_bias_noise\" is per frame, and the frame rate is not known",
                              "add --frame-rate RATE (LiDAR scans per second, as 10Hz)");
    else if (largest > 0 && k[0] != k[1])
        imki_note(p, true,
                  "imu_bias_noise is one number for both sensors: that of the %s is written", *of);
    return largest > 0 ? largest / sqrt(p->settings->frame_rate) : 0;
}

/* JSON has no comments that all versions of GLIM can read. */
static void write_explanation(imki_parameters *p, const char *of, bool walks)
{
    static const char *const sensors[2] = {"imu_gyro_noise", "imu_acc_noise"};
    imki_text_add(&p->out,
                  "    \"_note\": \"imukit: noises are continuous-time, two-sided densities "
                  "[rad/s/sqrt(Hz), m/s^2/sqrt(Hz)]");
    for (int kind = 0; kind < 2; kind++)
        if (p->origin[kind]->present && imki_axis_taken(p, 2 * kind)[0])
            imki_text_add(&p->out, "; %s%s", sensors[kind], imki_axis_taken(p, 2 * kind));
    if (walks)
        imki_text_add(&p->out, "; imu_bias_noise is per frame at %s frames per second, of the %s",
                      imki_shortest(p->settings->frame_rate).text, of);
    imki_text_add(&p->out, "\",\n");
    for (size_t i = 0; i < p->remarks; i++)
        imki_text_add(&p->out, "    \"_note%zu\": \"%s\",\n", i + 1, p->notes->note[i].text);
}

void imki_glim_write(imki_parameters *p)
{
    const char *of = "";
    const double walk = walk_per_frame(p, &of);
    double bias[6] = {0};
    if (p->status != IMK_OK)
        return;
    imki_text_add(&p->out, "{\n  \"sensors\": {\n");
    write_explanation(p, of, walk > 0);
    const char *separator = "";
    for (int kind = 0; kind < 2; kind++) {
        if (!p->origin[kind]->present)
            continue;
        imki_text_add(&p->out, "%s    \"%s\": %s", separator, keys[kind],
                      imki_shortest(imki_density(p, 2 * kind, keys[kind])).text);
        memcpy(bias + (kind == IMK_GYRO ? 3 : 0), p->origin[kind]->bias.fixed.value,
               3 * sizeof bias[0]);
        separator = ",\n";
    }
    if (walk > 0)
        imki_text_add(&p->out, "%s    \"%s\": %s", separator, keys[2], imki_shortest(walk).text);
    if (imki_any(bias) || imki_any(bias + 3)) {
        imki_text_add(&p->out, "%s    \"%s\": [", separator, keys[3]);
        imki_text_numbers(&p->out, bias, 6, ", ");
        imki_text_add(&p->out, "]");
    }
    imki_text_add(&p->out, "\n  }\n}\n");
    imki_note(p, true,
              "T_lidar_imu and imu_int_noise are not of the sensor: put these keys into "
              "your config_sensors.json, which has them");
}
