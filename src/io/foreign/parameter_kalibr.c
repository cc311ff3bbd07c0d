/* SPDX-License-Identifier: Apache-2.0 */
/* kalibr: the noise of imu.yaml and the intrinsics of a calibration result (imu0: …).
 *
 * As its error terms have it (IccSensors.py of ethz-asl/kalibr), forward, with C = C_gyro_i:
 *
 *     accelerometers:  M f + b,   component k of f at the place r_k of that sensor
 *     gyroscopes:      M C w + A C f + b
 *
 * Noise per sample is density * sqrt(update_rate) (ConfigReader.py): the densities are two-sided,
 * N and K of the model. */
#include "parameter_internal.h"

#include <stdio.h>
#include <string.h>

const char *const imki_kalibr_noise_keys[IMKI_DENSITIES] = {
    "gyroscope_noise_density", "gyroscope_random_walk", "accelerometer_noise_density",
    "accelerometer_random_walk"};

static const imki_unit noise_units[IMKI_DENSITIES] = {
    {"rad/s/sqrt(Hz)", 1}, {"rad/s^2/sqrt(Hz)", 1}, {"m/s^2/sqrt(Hz)", 1}, {"m/s^3/sqrt(Hz)", 1}};

static const char explanation[] =
    "# kalibr: noise densities are continuous-time, two-sided.\n"
    "#\n"
    "# The sqrt(dt) trap: these are not standard deviations per sample. kalibr itself makes "
    "those,\n"
    "# with dt = 1/update_rate:\n"
    "#     white noise of a reading:  sigma_d  = noise_density / sqrt(dt)\n"
    "#     step of the bias:          sigma_bd = random_walk * sqrt(dt)\n"
    "# Never enter sigma_d or sigma_bd here; and when the log is thinned out, change update_rate\n"
    "# only.\n"
    "#\n"
    "# noise_density is N, the Allan deviation at 1 s of its slope -1/2; random_walk is K, "
    "sqrt(3)\n"
    "# times the Allan deviation at 1 s of its slope +1/2. The flat part, bias instability B, has "
    "no\n"
    "# key: a filter that has to bridge a time tau covers it with\n"
    "# random_walk = sqrt(K^2 + 6 ln 2/pi B^2/tau), which is --bias-instability-tau.\n";

/* ---- the parts OpenVINS shares --------------------------------------------------------------- */

static bool describes_imu(const imki_parameters *p, int node)
{
    for (int i = 0; i < IMKI_DENSITIES; i++)
        if (imki_node_value(p, node, imki_kalibr_noise_keys[i]) != IMKI_NONE)
            return true;
    return imki_node_value(p, node, "gyroscopes") != IMKI_NONE ||
           imki_node_value(p, node, "accelerometers") != IMKI_NONE;
}

int imki_kalibr_imu(imki_parameters *p)
{
    imki_choice choice = {.found = 0};
    if (describes_imu(p, 0))
        return 0;
    for (int key = p->document->node[0].first; key != IMKI_NONE; key = imki_key_after(p, key))
        if (describes_imu(p, p->document->node[key].next))
            imki_choice_add(p, &choice, p->document->node[key].text, p->document->node[key].next);
    if (choice.count == 0)
        imki_refuse_node(p, 0, IMK_ERROR_KEY_MISSING, "gyroscope_noise_density",
                         "a file with the noise of an IMU, at the top or under imu0:");
    imki_choice_end(p, choice.found, choice.names, "NAME", "the file describes several IMUs");
    return choice.chosen;
}

void imki_kalibr_noise_read(imki_parameters *p, int imu)
{
    imki_densities_read(p, imu, imki_kalibr_noise_keys, noise_units);
}

void imki_kalibr_noise_write(imki_parameters *p, const char *indent)
{
    static const char *const units[IMKI_DENSITIES] = {
        "[rad/s/sqrt(Hz)], two-sided", "[rad/s^2/sqrt(Hz)], two-sided",
        "[m/s^2/sqrt(Hz)], two-sided", "[m/s^3/sqrt(Hz)], two-sided"};
    imki_densities_write(
        p, &(imki_density_lines){
               .keys = imki_kalibr_noise_keys, .units = units, .indent = indent, .scale = 1});
    for (int i = 0; i < IMKI_DENSITIES; i++) {
        const imk_noise *noise = &p->origin[i / 2]->noise;
        if (p->origin[i / 2]->present &&
            !imki_any(i % 2 == 0 ? noise->white.value : noise->random_walk.value))
            imki_note(p, true, "%s is 0, which kalibr and OpenVINS do not accept: set a value",
                      imki_kalibr_noise_keys[i]);
    }
}

/* The pose is of interest only when it is not that of the reference IMU, the offset when there is
 * one. */
static bool says_something(const imki_parameters *p, int node)
{
    const imki_node *nodes = p->document->node, *n = &nodes[node];
    double value;
    if (n->kind == IMKI_NODE_SCALAR)
        return !imki_number(n->text, n->text + n->length, &value) || value != 0;
    for (int row = n->first, i = 0; row != IMKI_NONE; row = nodes[row].next, i++)
        for (int cell = nodes[row].first, j = 0; cell != IMKI_NONE; cell = nodes[cell].next, j++) {
            const char *text = imki_node_text(p, cell);
            if (!imki_number(text, text + strlen(text), &value) || value != (i == j))
                return true;
        }
    return false;
}

void imki_kalibr_note_setup(imki_parameters *p, int imu)
{
    static const char *const names[] = {"rostopic", "update_rate", "time_offset", "T_i_b"};
    char list[64] = "";
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        const int node = imki_node_value(p, imu, names[i]);
        const size_t length = strlen(list);
        if (node != IMKI_NONE && says_something(p, node))
            snprintf(list + length, sizeof list - length, "%s%s", length > 0 ? ", " : "", names[i]);
    }
    if (list[0])
        imki_note(p, true, "these keys describe the set-up, not the sensor, and are not read: %s",
                  list);
}

/* ---- reading --------------------------------------------------------------------------------- */

/* The matrix of a key; as it was where there is none. @return the node of the last one read */
static int read_matrix(imki_parameters *p, int mapping, const char *key, double matrix[3][3],
                       int last)
{
    const int node = imki_node_value(p, mapping, key);
    if (node == IMKI_NONE)
        return last;
    imki_node_matrix(p, node, matrix);
    return node;
}

static void read_gyroscopes(imki_parameters *p, int mapping)
{
    static const char *const known[] = {"M", "A", "C_gyro_i"};
    double m[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, c[3][3], a[3][3] = {{0}};
    memcpy(c, m, sizeof c);
    const int place = read_matrix(p, mapping, "M", m, mapping);
    read_matrix(p, mapping, "C_gyro_i", c, 0);
    read_matrix(p, mapping, "A", a, 0);
    imki_foreign_keys(p, mapping, 3, known);
    imki_multiply(m, c, m);
    imki_multiply(a, c, a);
    for (int i = 0; i < 3; i++)
        memcpy(p->model->gyro.g_sensitivity.value[i], a[i], sizeof a[i]);
    imki_response_set(p, imki_node_place(p, place), &p->model->gyro, m);
}

static void read_accelerometers(imki_parameters *p, int mapping)
{
    static const char *const known[] = {"M", "rx_i", "ry_i", "rz_i"};
    double m[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    imk_triad *accel = &p->model->accel;
    const int place = read_matrix(p, mapping, "M", m, mapping);
    for (int i = 0; i < 3; i++) {
        const int node = imki_node_value(p, mapping, known[i + 1]);
        double position[3] = {0};
        if (node != IMKI_NONE)
            imki_node_numbers(p, node, 3, position);
        memcpy(accel->lever_arm.value[i], position, sizeof position);
        if (imki_any(position))
            imki_note(p, false,
                      "lever arms: in kalibr M mixes components that are sensed at several places; "
                      "in the model axis i senses all components at its own place (they differ by "
                      "misalignment times lever arm)");
    }
    imki_foreign_keys(p, mapping, 4, known);
    imki_response_set(p, imki_node_place(p, place), accel, m);
}

static void read_keys(imki_parameters *p, int imu)
{
    /* The last three are of the set-up, and nothing is taken for one of them misspelt. */
    static const char *const known[] = {"gyroscope_noise_density",
                                        "gyroscope_random_walk",
                                        "accelerometer_noise_density",
                                        "accelerometer_random_walk",
                                        "gyroscopes",
                                        "accelerometers",
                                        "update_rate",
                                        "time_offset",
                                        "model",
                                        "rostopic",
                                        "T_i_b"};
    enum { KNOWN = sizeof known / sizeof known[0] };
    for (int key = p->document->node[imu].first; key != IMKI_NONE; key = imki_key_after(p, key)) {
        const int value = p->document->node[key].next;
        const char *name = p->document->node[key].text;
        const bool is_mapping = imki_node_is(p, value, IMKI_NODE_MAPPING);
        if (strcmp(name, "gyroscopes") == 0 && is_mapping)
            read_gyroscopes(p, value);
        else if (strcmp(name, "accelerometers") == 0 && is_mapping)
            read_accelerometers(p, value);
        else if (!imki_is_one_of(name, KNOWN, known))
            imki_foreign_key(p, key, KNOWN - 3, known);
    }
}

void imki_kalibr_read(imki_parameters *p)
{
    if (!imki_parameters_document(p))
        return;
    const int imu = imki_kalibr_imu(p);
    imki_kalibr_noise_read(p, imu);
    read_keys(p, imu);
    imki_kalibr_note_setup(p, imu);
}

/* ---- writing --------------------------------------------------------------------------------- */

static void write_gyroscopes(imki_parameters *p)
{
    double response[3][3], m[3][3], c[3][3], a[3][3], c_transposed[3][3];
    imki_response_of(&p->source->gyro, response);
    if (!imki_lower_and_rotation(response, m, c)) {
        imki_parameter_refuse(p, IMK_ERROR_UNSUPPORTED, "gyro.direction",
                              "the gyro axes are not a right-handed set", "");
        return;
    }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            a[i][j] = p->source->gyro.g_sensitivity.value[i][j];
            c_transposed[i][j] = c[j][i];
        }
    imki_multiply(a, c_transposed, a);
    imki_text_add(&p->out, "  gyroscopes:\n    # reading = M C_gyro_i w + A C_gyro_i f\n    M:\n");
    imki_text_matrix(&p->out, "    ", m);
    imki_text_add(&p->out, "    # [(rad/s)/(m/s^2)]\n    A:\n");
    imki_text_matrix(&p->out, "    ", a);
    imki_text_add(&p->out, "    C_gyro_i:\n");
    imki_text_matrix(&p->out, "    ", c);
}

static void write_accelerometers(imki_parameters *p, bool lever_arms)
{
    double response[3][3];
    imki_response_of(&p->source->accel, response);
    if (response[0][1] != 0 || response[0][2] != 0 || response[1][2] != 0)
        imki_note(
            p, false,
            "accelerometers: M is not lower triangular; kalibr itself lets the accelerometers "
            "fix the frame and estimates a lower triangle only");
    imki_text_add(&p->out, "  accelerometers:\n    # reading = M f\n    M:\n");
    imki_text_matrix(&p->out, "    ", response);
    for (int i = 0; i < 3 && lever_arms; i++) {
        imki_text_add(&p->out, "    r%c_i: ", 'x' + i);
        imki_text_vector(&p->out, p->source->accel.lever_arm.value[i]);
        imki_text_add(&p->out, "  # [m]\n");
    }
}

static bool any_row(const imk_rows *rows)
{
    for (int i = 0; i < 9; i++)
        if (rows->value[i / 3][i % 3] != 0)
            return true;
    return false;
}

static void write_setup(imki_parameters *p, bool intrinsics, bool lever_arms)
{
    const char *indent = intrinsics ? "  " : "";
    imki_text_add(&p->out, "%srostopic: /imu0\n", indent);
    if (p->settings->rate > 0) {
        imki_text_add(&p->out, "%supdate_rate: %s  # [Hz]\n", indent,
                      imki_shortest(p->settings->rate).text);
    } else {
        imki_text_add(&p->out, "%s# update_rate: [Hz], add it\n", indent);
        imki_note(p, true, "kalibr needs update_rate: add it to the file, or convert with --rate");
    }
    if (intrinsics)
        imki_text_add(&p->out, "  model: scale-misalignment%s\n", lever_arms ? "-size-effect" : "");
}

/* With intrinsics the file is like a result (imu0: …), without like the input imu.yaml. */
void imki_kalibr_write(imki_parameters *p)
{
    const imk_triad *gyro = &p->source->gyro, *accel = &p->source->accel;
    double response[2][3][3] = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    if (gyro->present)
        imki_response_of(gyro, response[0]);
    if (accel->present)
        imki_response_of(accel, response[1]);
    bool lever_arms = accel->present && any_row(&accel->lever_arm);
    bool intrinsics = lever_arms || (gyro->present && any_row(&gyro->g_sensitivity)) ||
                      !imki_is_identity(response[0]) || !imki_is_identity(response[1]);
    imki_text_add(&p->out, "%s", explanation);
    imki_text_remarks(p, "# ");
    imki_text_add(&p->out, "%s", intrinsics ? "imu0:\n" : "");
    imki_kalibr_noise_write(p, intrinsics ? "  " : "");
    if (intrinsics && gyro->present)
        write_gyroscopes(p);
    if (intrinsics && accel->present)
        write_accelerometers(p, lever_arms);
    write_setup(p, intrinsics, lever_arms);
}
