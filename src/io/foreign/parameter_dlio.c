/* SPDX-License-Identifier: Apache-2.0 */
/* DLIO, direct LiDAR-inertial odometry: imu: intrinsics: of dlio.yaml. It has no noise.
 *
 * odom.cc of vectr-ucla/direct_lidar_inertial_odometry: with imu: calibration: false the
 * accelerometers are corrected to sm f_m - bias, the gyros to w_m - bias; sm is row-major. For
 * f_m = T f + b that is sm = T^-1, bias = T^-1 b. Readings are turned into the axes of the base
 * link before that, so the numbers are in those axes. With calibration: true it averages three
 * seconds at rest instead, and these keys do nothing. */
#include "parameter_internal.h"

#include <string.h>

/* As ROS 1 has them, and as a parameter of ROS 2 is called. */
static const char *const flat[] = {"imu/intrinsics/accel/bias", "imu/intrinsics/accel/sm",
                                   "imu/intrinsics/gyro/bias", "imu/calibration"};
enum { ACCEL_BIAS, ACCEL_SM, GYRO_BIAS, CALIBRATION, KEYS };

/* The nodes of the keys; IMKI_NONE where there is none. */
static void find_nested(imki_parameters *p, int nodes[KEYS])
{
    static const char *const known[] = {"intrinsics", "calibration"};
    static const char *const sensors[] = {"accel", "gyro"};
    static const char *const terms[] = {"bias", "sm"};
    const int imu = imki_only_mapping_with(p, 1, known);
    if (p->status != IMK_OK)
        return;
    nodes[CALIBRATION] = imki_node_value(p, imu, known[1]);
    imki_foreign_keys(p, imu, 2, known);
    const int both = imki_node_value(p, imu, known[0]);
    if (!imki_node_is(p, both, IMKI_NODE_MAPPING)) {
        imki_refuse_node(p, both, IMK_ERROR_SYNTAX, "", "a mapping with accel: and gyro:");
        return;
    }
    imki_foreign_keys(p, both, 2, sensors);
    for (int i = 0; i < 2; i++) {
        const int node = imki_node_value(p, both, sensors[i]);
        if (!imki_node_is(p, node, IMKI_NODE_MAPPING))
            continue;
        nodes[i == 0 ? ACCEL_BIAS : GYRO_BIAS] = imki_node_value(p, node, terms[0]);
        if (i == 0)
            nodes[ACCEL_SM] = imki_node_value(p, node, terms[1]);
        imki_foreign_keys(p, node, i == 0 ? 2 : 1, terms);
    }
}

static void find_keys(imki_parameters *p, int nodes[KEYS])
{
    const int mapping = imki_mapping_with(p->document, 0, CALIBRATION, flat);
    for (int i = 0; i < KEYS; i++)
        nodes[i] = mapping == IMKI_NONE ? IMKI_NONE : imki_node_value(p, mapping, flat[i]);
    if (mapping == IMKI_NONE)
        find_nested(p, nodes);
    else
        imki_note_others(p, mapping, KEYS, flat);
}

static void read_vector(imki_parameters *p, int node, int kind, double si[3])
{
    double raw[3] = {0};
    if (node == IMKI_NONE)
        return;
    imki_node_numbers(p, node, 3, raw);
    imki_accept(p, imki_node_place(p, node), kind, IMKI_BIAS, raw,
                (imki_unit){imki_kind_units[kind], 1}, si);
}

void imki_dlio_read(imki_parameters *p)
{
    int nodes[KEYS];
    double corrected[3] = {0}, sm[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, matrix[3][3], response[3][3];
    imk_triad *accel = &p->model->accel;
    if (!imki_parameters_document(p))
        return;
    find_keys(p, nodes);
    if (p->status != IMK_OK)
        return;
    if (strcmp(imki_node_text(p, nodes[CALIBRATION]), "false") != 0)
        imki_note(p, false,
                  "imu: calibration: is not false: DLIO finds biases by itself and does "
                  "not use these numbers; they are read all the same");
    read_vector(p, nodes[GYRO_BIAS], IMK_GYRO, p->model->gyro.bias.fixed.value);
    read_vector(p, nodes[ACCEL_BIAS], IMK_ACCEL, corrected);
    if (nodes[ACCEL_SM] != IMKI_NONE)
        imki_node_numbers(p, nodes[ACCEL_SM], 9, sm);
    memcpy(matrix, sm, sizeof matrix);
    const imki_place place = nodes[ACCEL_SM] == IMKI_NONE ? (imki_place){"sm", 0, 0}
                                                          : imki_node_place(p, nodes[ACCEL_SM]);
    imki_correction_set(p, place, accel, matrix);
    if (p->status != IMK_OK)
        return;
    imki_response_of(accel, response);
    for (int i = 0; i < 3; i++)
        accel->bias.fixed.value[i] = response[i][0] * corrected[0] + response[i][1] * corrected[1] +
                                     response[i][2] * corrected[2];
}

void imki_dlio_write(imki_parameters *p)
{
    const imk_triad *gyro = &p->source->gyro, *accel = &p->source->accel;
    imki_text_add(
        &p->out, "# DLIO: corrected force sm f - bias, corrected rate w - bias, in the axes of the "
                 "base link:\n# right if extrinsics: baselink2imu: R: is the identity. With "
                 "calibration: false DLIO takes these\n# numbers and does not stand still for "
                 "three seconds to find biases and to align with gravity.\n# ROS 1: load this file "
                 "with rosparam after dlio.yaml. ROS 2: each key is one parameter with\n# slashes, "
                 "imu/intrinsics/accel/bias.\ndlio:\n  imu:\n    calibration: false\n"
                 "    intrinsics:\n");
    if (accel->present) {
        double sm[3][3], bias[3];
        imki_correction_of(p, accel, "accel", sm);
        if (p->status != IMK_OK)
            return;
        for (int i = 0; i < 3; i++) {
            const double *b = accel->bias.fixed.value;
            bias[i] = sm[i][0] * b[0] + sm[i][1] * b[1] + sm[i][2] * b[2];
        }
        imki_text_add(&p->out, "      accel:\n        bias: ");
        imki_text_vector(&p->out, bias);
        imki_text_add(&p->out, "  # [m/s^2]\n        sm: [");
        imki_text_numbers(&p->out, sm[0], 9, ", ");
        imki_text_add(&p->out, "]\n");
    }
    if (gyro->present) {
        imki_text_add(&p->out, "      gyro:\n        bias: ");
        imki_text_vector(&p->out, gyro->bias.fixed.value);
        imki_text_add(&p->out, "  # [rad/s]\n");
    }
}
