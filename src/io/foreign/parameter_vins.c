/* SPDX-License-Identifier: Apache-2.0 */
/* Two visual-inertial estimators.
 *
 * OpenVINS (kalibr_imu_chain.yaml): kalibr's noise, and intrinsics that its options turn into
 * D = T^-1 (VioManagerOptions.h of rpng/open_vins), so that forward
 *
 *     w_m = Tw R_IMUtoGYRO w + Tg f + b,     f_m = Ta R_IMUtoACC f + b
 *
 * VINS (acc_n, gyr_n, acc_w, gyr_w): integration_base.h of VINS-Mono adds (acc_n dt)^2 to the
 * variance of the velocity at each step and (acc_w dt)^2 to that of the bias, which is noise per
 * sample: N = acc_n/sqrt(rate), K = acc_w/sqrt(rate). Many users enter densities instead. So the
 * file alone does not say which, and the caller must. */
#include "parameter_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- OpenVINS -------------------------------------------------------------------------------- */

static const char *const openvins_keys[] = {"Tw",
                                            "R_IMUtoGYRO",
                                            "Ta",
                                            "R_IMUtoACC",
                                            "Tg",
                                            "gyroscope_noise_density",
                                            "gyroscope_random_walk",
                                            "accelerometer_noise_density",
                                            "accelerometer_random_walk",
                                            "model",
                                            "rostopic",
                                            "time_offset",
                                            "update_rate",
                                            "T_i_b"};
enum { OPENVINS_KEYS = sizeof openvins_keys / sizeof openvins_keys[0] };

static void read_intrinsics(imki_parameters *p, int imu)
{
    double matrix[5][3][3] = {{{0}}};
    int last[2] = {imu, imu};
    for (int i = 0; i < 5; i++) {
        const int node = imki_node_value(p, imu, openvins_keys[i]);
        for (int j = 0; j < 3; j++)
            matrix[i][j][j] = i < 4;
        if (node == IMKI_NONE)
            continue;
        imki_node_matrix(p, node, matrix[i]);
        if (i < 4)
            last[i / 2] = node;
    }
    for (int i = 0; i < 3; i++)
        memcpy(p->model->gyro.g_sensitivity.value[i], matrix[4][i], sizeof matrix[4][i]);
    for (int kind = 0; kind < 2; kind++) {
        double(*t)[3] = matrix[2 * kind];
        imki_multiply(t, matrix[2 * kind + 1], t);
        imki_response_set(p, imki_node_place(p, last[kind]), p->triad[kind], t);
    }
}

void imki_openvins_read(imki_parameters *p)
{
    if (!imki_parameters_document(p))
        return;
    const int imu = imki_kalibr_imu(p);
    imki_kalibr_noise_read(p, imu);
    read_intrinsics(p, imu);
    imki_foreign_keys(p, imu, OPENVINS_KEYS, openvins_keys);
    imki_kalibr_note_setup(p, imu);
}

static void write_matrix(imki_parameters *p, const char *key, double matrix[3][3])
{
    imki_text_add(&p->out, "  %s:\n", key);
    imki_text_matrix(&p->out, "    ", matrix);
}

/* R_IMUtoGYRO and Tw from the gyros' response, R_IMUtoACC and Ta from the accelerometers'. */
static void write_response(imki_parameters *p, const imk_triad *triad, const char *name,
                           const char *t, const char *r)
{
    double response[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, lower[3][3], rotation[3][3];
    if (triad->present)
        imki_response_of(triad, response);
    if (!imki_lower_and_rotation(response, lower, rotation)) {
        char found[64];
        snprintf(found, sizeof found, "the %s axes are not a right-handed set", name);
        imki_parameter_refuse(p, IMK_ERROR_UNSUPPORTED, name, found, "");
        return;
    }
    write_matrix(p, t, lower);
    write_matrix(p, r, rotation);
    if (triad == &p->source->accel && !imki_is_identity(rotation))
        imki_note(p, false,
                  "R_IMUtoACC is not the identity: the model kalibr of OpenVINS keeps R_IMUtoACC "
                  "as it is and estimates R_IMUtoGYRO only");
}

void imki_openvins_write(imki_parameters *p)
{
    double tg[3][3] = {{0}};
    for (int i = 0; i < 3 && p->source->gyro.present; i++)
        memcpy(tg[i], p->source->gyro.g_sensitivity.value[i], sizeof tg[i]);
    imki_text_add(&p->out, "%%YAML:1.0\n\n# OpenVINS: w_m = Tw R_IMUtoGYRO w + Tg f, f_m = Ta "
                           "R_IMUtoACC f\nimu0:\n  T_i_b:\n    - [1.0, 0.0, 0.0, 0.0]\n    - [0.0, "
                           "1.0, 0.0, 0.0]\n    - [0.0, 0.0, 1.0, 0.0]\n    - [0.0, 0.0, 0.0, "
                           "1.0]\n");
    imki_text_remarks(p, "  # ");
    imki_kalibr_noise_write(p, "  ");
    imki_text_add(&p->out, "  rostopic: /imu0\n  time_offset: 0.0\n");
    if (p->settings->rate > 0)
        imki_text_add(&p->out, "  update_rate: %s  # [Hz]\n",
                      imki_shortest(p->settings->rate).text);
    else
        imki_note(p, true, "update_rate is not known: add it to the file, or convert with --rate");
    imki_text_add(&p->out, "  model: \"kalibr\"\n");
    write_response(p, &p->source->gyro, "gyro", "Tw", "R_IMUtoGYRO");
    write_response(p, &p->source->accel, "accelerometer", "Ta", "R_IMUtoACC");
    imki_text_add(&p->out, "  # [(rad/s)/(m/s^2)]\n");
    write_matrix(p, "Tg", tg);
}

/* ---- VINS ------------------------------------------------------------------------------------ */

static const char *const vins_keys[IMKI_DENSITIES] = {"gyr_n", "gyr_w", "acc_n", "acc_w"};
static const char *const vins_units[2][IMKI_DENSITIES] = {
    {"rad/s per sample", "rad/s^2 per sample", "m/s^2 per sample", "m/s^3 per sample"},
    {"rad/s/sqrt(Hz)", "rad/s^2/sqrt(Hz)", "m/s^2/sqrt(Hz)", "m/s^3/sqrt(Hz)"}};

/* What the numbers are multiplied by to be two-sided densities. */
static double vins_scale(imki_parameters *p)
{
    const imk_parameter_settings *s = p->settings;
    const bool one_sided = s->density == IMK_DENSITY_ONE_SIDED;
    if (s->rate > 0 && s->density != IMK_DENSITY_UNSTATED)
        imki_parameter_refuse(
            p, IMK_ERROR_CONFLICT, "density",
            "--rate and --density exclude each other: the first says that the numbers are "
            "per sample",
            "keep one of them");
    else if (s->rate > 0)
        imki_note(p, false, "acc_n, gyr_n, acc_w, gyr_w are taken as noise per sample at %g Hz",
                  s->rate);
    else if (s->density != IMK_DENSITY_UNSTATED)
        imki_note(p, false, "acc_n, gyr_n, acc_w, gyr_w are taken as %s densities per sqrt(Hz)",
                  one_sided ? "one-sided" : "two-sided");
    else
        imki_parameter_refuse(
            p, IMK_ERROR_KEY_MISSING, "acc_n",
            "\"acc_n\" and the others are per sample or per sqrt(Hz): the file does not say which",
            "add --rate RATE (samples per second, if the numbers are per sample, as VINS takes "
            "them; if they are densities, add --density two-sided)");
    return s->rate > 0 ? 1 / sqrt(s->rate) : one_sided ? sqrt(0.5) : 1;
}

void imki_vins_read(imki_parameters *p)
{
    const double scale = vins_scale(p);
    imki_unit units[IMKI_DENSITIES];
    if (p->status != IMK_OK || !imki_parameters_document(p))
        return;
    for (int i = 0; i < IMKI_DENSITIES; i++)
        units[i] = (imki_unit){vins_units[p->settings->rate <= 0][i], scale};
    imki_densities_read(p, 0, vins_keys, units);
    imki_note_others(p, 0, IMKI_DENSITIES, vins_keys);
}

void imki_vins_write(imki_parameters *p)
{
    const double scale = vins_scale(p);
    imki_text_add(&p->out, "%%YAML:1.0\n");
    imki_text_remarks(p, "# ");
    for (int i = 0; i < IMKI_DENSITIES; i++) {
        const bool present = p->origin[i / 2]->present;
        const double value = present ? imki_density(p, i, vins_keys[i]) / scale : 0;
        imki_text_add(&p->out, "%s: %s  # [%s]%s\n", vins_keys[i], imki_shortest(value).text,
                      vins_units[p->settings->rate <= 0][i], present ? imki_axis_taken(p, i) : "");
    }
}
