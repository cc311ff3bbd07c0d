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
#include "model/model_schema_internal.h"
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

static imk_status read_intrinsics(imki_parameters *p, const imk_document *document, int imu)
{
    double matrix[5][3][3] = {{{0}}};
    int last[2] = {imu, imu};
    imk_status status = IMK_OK;
    for (int i = 0; i < 5 && status == IMK_OK; i++) {
        int node = imki_document_value(document, imu, openvins_keys[i]);
        for (int j = 0; j < 3; j++)
            matrix[i][j][j] = i < 4;
        if (node == IMKI_NONE)
            continue;
        status = imki_node_matrix(p, document, node, matrix[i]);
        if (i < 4)
            last[i / 2] = node;
    }
    if (status != IMK_OK)
        return status;
    imki_multiply(matrix[0], matrix[1], matrix[0]);
    imki_multiply(matrix[2], matrix[3], matrix[2]);
    for (int i = 0; i < 3; i++)
        memcpy(p->model->gyro.g_sensitivity.value[i], matrix[4][i], sizeof matrix[4][i]);
    status = imki_response_set(p, imki_node_place(document, last[0]), &p->model->gyro, matrix[0]);
    return status == IMK_OK ? imki_response_set(p, imki_node_place(document, last[1]),
                                                &p->model->accel, matrix[2])
                            : status;
}

imk_status imki_openvins_read(imki_parameters *p)
{
    imk_document *document = NULL;
    int imu = 0;
    imk_status status = imki_parameters_document(p, &document);
    if (status != IMK_OK)
        return status;
    status = imki_kalibr_imu(p, document, &imu);
    if (status == IMK_OK)
        status = imki_kalibr_noise_read(p, document, imu);
    if (status == IMK_OK)
        status = read_intrinsics(p, document, imu);
    for (int key = document->node[imu].first; key != IMKI_NONE && status == IMK_OK;) {
        size_t i = 0;
        while (i < OPENVINS_KEYS && strcmp(document->node[key].text, openvins_keys[i]) != 0)
            i++;
        if (i == OPENVINS_KEYS)
            status = imki_foreign_key(p, document, key, OPENVINS_KEYS, openvins_keys);
        key = document->node[document->node[key].next].next;
    }
    if (status == IMK_OK)
        imki_kalibr_note_setup(p, document, imu);
    imk_document_free(document);
    return status;
}

static void write_matrix(imki_parameters *p, const char *key, double matrix[3][3])
{
    imki_text_add(&p->out, "  %s:\n", key);
    imki_text_matrix(&p->out, "    ", matrix);
}

/* R_IMUtoGYRO and Tw from the gyros' response, R_IMUtoACC and Ta from the accelerometers'. */
static imk_status write_response(imki_parameters *p, const imk_triad *triad, const char *name,
                                 const char *t, const char *r)
{
    double response[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, lower[3][3], rotation[3][3];
    if (triad->present)
        imki_response_of(triad, response);
    if (!imki_lower_and_rotation(response, lower, rotation)) {
        char found[64];
        snprintf(found, sizeof found, "the %s axes are not a right-handed set", name);
        return imk_error_set(p->error, IMK_ERROR_UNSUPPORTED, name, found, "");
    }
    write_matrix(p, t, lower);
    write_matrix(p, r, rotation);
    if (triad == &p->source->accel && !imki_is_identity(rotation))
        imki_note(p, false,
                  "R_IMUtoACC is no identity: OpenVINS' model kalibr keeps it and estimates "
                  "R_IMUtoGYRO only");
    return IMK_OK;
}

imk_status imki_openvins_write(imki_parameters *p)
{
    double tg[3][3] = {{0}};
    for (int i = 0; i < 3 && p->source->gyro.present; i++)
        memcpy(tg[i], p->source->gyro.g_sensitivity.value[i], sizeof tg[i]);
    imki_text_add(&p->out, "%%YAML:1.0\n\n# OpenVINS: w_m = Tw R_IMUtoGYRO w + Tg f, f_m = Ta "
                           "R_IMUtoACC f\nimu0:\n  T_i_b:\n    - [1.0, 0.0, 0.0, 0.0]\n    - [0.0, "
                           "1.0, 0.0, 0.0]\n    - [0.0, 0.0, 1.0, 0.0]\n    - [0.0, 0.0, 0.0, "
                           "1.0]\n");
    imki_kalibr_noise_write(p, "  ");
    imki_text_add(&p->out, "  rostopic: /imu0\n  time_offset: 0.0\n");
    if (p->settings->rate > 0) {
        imki_text_add(&p->out, "  update_rate: ");
        imki_text_numbers(&p->out, &p->settings->rate, 1, "");
        imki_text_add(&p->out, "  # [Hz]\n");
    } else {
        imki_note(p, true, "update_rate is not known: add it to the file, or convert with --rate");
    }
    imki_text_add(&p->out, "  model: \"kalibr\"\n");
    imk_status status = write_response(p, &p->source->gyro, "gyro", "Tw", "R_IMUtoGYRO");
    if (status == IMK_OK)
        status = write_response(p, &p->source->accel, "accelerometer", "Ta", "R_IMUtoACC");
    imki_text_add(&p->out, "  # [(rad/s)/(m/s^2)]\n");
    write_matrix(p, "Tg", tg);
    return status;
}

/* ---- VINS ------------------------------------------------------------------------------------ */

static const char *const vins_keys[4] = {"gyr_n", "gyr_w", "acc_n", "acc_w"};
static const char *const vins_units[2][4] = {
    {"rad/s per sample", "rad/s^2 per sample", "m/s^2 per sample", "m/s^3 per sample"},
    {"rad/s/sqrt(Hz)", "rad/s^2/sqrt(Hz)", "m/s^2/sqrt(Hz)", "m/s^3/sqrt(Hz)"}};

/* What the numbers are multiplied by to be two-sided densities. */
static imk_status vins_scale(imki_parameters *p, double *scale)
{
    const imk_parameter_settings *s = p->settings;
    if (s->rate > 0 && s->density != IMK_DENSITY_UNSTATED)
        return imk_error_set(p->error, IMK_ERROR_CONFLICT, "density",
                             "--rate and --density exclude each other: the first says that the "
                             "numbers are per sample",
                             "keep one of them");
    if (s->rate > 0) {
        *scale = 1 / sqrt(s->rate);
        imki_note(p, false, "acc_n, gyr_n, acc_w, gyr_w are taken as noise per sample at %g Hz",
                  s->rate);
        return IMK_OK;
    }
    if (s->density != IMK_DENSITY_UNSTATED) {
        *scale = s->density == IMK_DENSITY_ONE_SIDED ? sqrt(0.5) : 1;
        imki_note(p, false, "acc_n, gyr_n, acc_w, gyr_w are taken as %s densities per sqrt(Hz)",
                  s->density == IMK_DENSITY_ONE_SIDED ? "one-sided" : "two-sided");
        return IMK_OK;
    }
    return imk_error_set(p->error, IMK_ERROR_KEY_MISSING, "acc_n",
                         "\"acc_n\" and the others are per sample or per sqrt(Hz), which is not "
                         "known",
                         "add --rate 200Hz (if per sample, as VINS itself takes them; or --density "
                         "two-sided if they are densities)");
}

imk_status imki_vins_read(imki_parameters *p)
{
    imk_document *document = NULL;
    imk_triad *triads[2] = {&p->model->gyro, &p->model->accel};
    double scale = 1;
    int others = 0;
    imk_status status = vins_scale(p, &scale);
    if (status == IMK_OK)
        status = imki_parameters_document(p, &document);
    if (status != IMK_OK)
        return status;
    bool per_sample = p->settings->rate > 0;
    for (int i = 0; i < 4 && status == IMK_OK; i++) {
        double si[3] = {0};
        imki_unit unit = {vins_units[!per_sample][i], scale};
        status = imki_node_accept(p, document, 0, vins_keys[i], i / 2,
                                  i % 2 == 0 ? IMKI_WHITE : IMKI_RANDOM_WALK, unit, si);
        imk_noise *noise = &triads[i / 2]->noise;
        imki_to_axes(si, i % 2 == 0 ? &noise->white : &noise->random_walk);
    }
    for (int key = document->node[0].first; key != IMKI_NONE;) {
        bool known = false;
        for (int i = 0; i < 4; i++)
            known = known || strcmp(document->node[key].text, vins_keys[i]) == 0;
        others += !known;
        key = document->node[document->node[key].next].next;
    }
    if (others > 0)
        imki_note(p, true, "%d other keys (cameras, estimator) are not parameters of the IMU",
                  others);
    imk_document_free(document);
    return status;
}

imk_status imki_vins_write(imki_parameters *p)
{
    const imk_triad *triads[2] = {&p->source->gyro, &p->source->accel};
    double scale;
    imk_status status = vins_scale(p, &scale);
    if (status != IMK_OK)
        return status;
    imki_text_add(&p->out, "%%YAML:1.0\n");
    for (int i = 0; i < 4; i++) {
        const imk_noise *noise = &triads[i / 2]->noise;
        double value = 0;
        if (triads[i / 2]->present)
            value =
                imki_largest(p, vins_keys[i], i % 2 == 0 ? &noise->white : &noise->random_walk) /
                scale;
        imki_text_add(&p->out, "%s: ", vins_keys[i]);
        imki_text_numbers(&p->out, &value, 1, "");
        imki_text_add(&p->out, "  # [%s]\n", vins_units[p->settings->rate <= 0][i]);
    }
    return IMK_OK;
}
