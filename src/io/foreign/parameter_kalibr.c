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
#include "model/model_schema_internal.h"
#include "parameter_internal.h"

#include <stdio.h>
#include <string.h>

const char *const imki_kalibr_noise_keys[IMKI_KALIBR_NOISE_KEYS] = {
    "gyroscope_noise_density", "gyroscope_random_walk", "accelerometer_noise_density",
    "accelerometer_random_walk"};

static const imki_unit noise_units[IMKI_KALIBR_NOISE_KEYS] = {
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
    "# random_walk = sqrt(K^2 + 6 ln 2/pi B^2/tau).\n";

/* ---- the parts OpenVINS shares --------------------------------------------------------------- */

static bool describes_imu(const imk_document *document, int node)
{
    for (int i = 0; i < IMKI_KALIBR_NOISE_KEYS; i++)
        if (imki_document_value(document, node, imki_kalibr_noise_keys[i]) != IMKI_NONE)
            return true;
    return imki_document_value(document, node, "gyroscopes") != IMKI_NONE ||
           imki_document_value(document, node, "accelerometers") != IMKI_NONE;
}

imk_status imki_kalibr_imu(imki_parameters *p, const imk_document *document, int *imu)
{
    const char *wanted = p->settings->sensor;
    int found = 0;
    char names[64] = "";
    if (describes_imu(document, 0)) {
        *imu = 0;
        return IMK_OK;
    }
    for (int key = document->node[0].first; key != IMKI_NONE;) {
        int value = document->node[key].next;
        const char *name = document->node[key].text;
        if (describes_imu(document, value)) {
            if (!wanted || strcmp(wanted, name) == 0) {
                *imu = value;
                found++;
            }
            size_t length = strlen(names);
            snprintf(names + length, sizeof names - length, "%s%.20s", length > 0 ? ", " : "",
                     name);
        }
        key = document->node[value].next;
    }
    if (found == 1)
        return IMK_OK;
    if (names[0] == '\0')
        return imki_document_error(document, 0, IMK_ERROR_KEY_MISSING, "gyroscope_noise_density",
                                   "the noise of an IMU, at the top or under imu0:", p->error);
    char expected[96];
    snprintf(expected, sizeof expected, "add --sensor NAME with one of %s", names);
    imk_error_set(p->error, wanted ? IMK_ERROR_NAME_UNKNOWN : IMK_ERROR_KEY_MISSING, "sensor",
                  wanted ? wanted : "\"sensor\" is missing: the file describes several IMUs",
                  expected);
    return wanted ? IMK_ERROR_NAME_UNKNOWN : IMK_ERROR_KEY_MISSING;
}

imk_status imki_kalibr_noise_read(imki_parameters *p, const imk_document *document, int imu)
{
    imk_triad *triads[2] = {&p->model->gyro, &p->model->accel};
    imk_status status = IMK_OK;
    for (int i = 0; i < IMKI_KALIBR_NOISE_KEYS && status == IMK_OK; i++) {
        imk_noise *noise = &triads[i / 2]->noise;
        double si[3] = {0};
        status = imki_node_accept(p, document, imu, imki_kalibr_noise_keys[i], i / 2,
                                  i % 2 == 0 ? IMKI_WHITE : IMKI_RANDOM_WALK, noise_units[i], si);
        imki_to_axes(si, i % 2 == 0 ? &noise->white : &noise->random_walk);
    }
    return status;
}

void imki_kalibr_noise_write(imki_parameters *p, const char *indent)
{
    const imk_triad *triads[2] = {&p->source->gyro, &p->source->accel};
    for (int i = 0; i < IMKI_KALIBR_NOISE_KEYS; i++) {
        if (!triads[i / 2]->present)
            continue;
        const imk_noise *noise = &triads[i / 2]->noise;
        double largest = imki_largest(p, imki_kalibr_noise_keys[i],
                                      i % 2 == 0 ? &noise->white : &noise->random_walk);
        imki_text_add(&p->out, "%s%s: ", indent, imki_kalibr_noise_keys[i]);
        imki_text_numbers(&p->out, &largest, 1, "");
        imki_text_add(&p->out, "  # [%s], two-sided\n", noise_units[i].name);
        if (largest == 0)
            imki_note(p, true, "%s is 0, which kalibr and OpenVINS do not take: set it",
                      imki_kalibr_noise_keys[i]);
    }
}

bool imki_kalibr_is_setup(const char *key)
{
    static const char *const names[] = {"model", "rostopic", "time_offset", "update_rate", "T_i_b"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (strcmp(key, names[i]) == 0)
            return true;
    return false;
}

/* The pose is of interest only when it is not that of the reference IMU, the offset when there is
 * one. */
static bool says_something(const imk_document *document, int node)
{
    const imki_node *n = &document->node[node];
    double value;
    if (n->kind == IMKI_NODE_SCALAR)
        return !imki_number(n->text, n->text + n->length, &value) || value != 0;
    for (int row = n->first, i = 0; row != IMKI_NONE; row = document->node[row].next, i++)
        for (int cell = document->node[row].first, j = 0; cell != IMKI_NONE;
             cell = document->node[cell].next, j++) {
            const char *text = imki_node_text(document, cell);
            if (!imki_number(text, text + strlen(text), &value) || value != (i == j))
                return true;
        }
    return false;
}

void imki_kalibr_note_setup(imki_parameters *p, const imk_document *document, int imu)
{
    static const char *const names[] = {"rostopic", "update_rate", "time_offset", "T_i_b"};
    char list[64] = "";
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        int node = imki_document_value(document, imu, names[i]);
        size_t length = strlen(list);
        if (node != IMKI_NONE && says_something(document, node))
            snprintf(list + length, sizeof list - length, "%s%s", length > 0 ? ", " : "", names[i]);
    }
    if (list[0])
        imki_note(p, true, "not of the sensor but of its set-up: %s", list);
}

/* ---- reading --------------------------------------------------------------------------------- */

static imk_status matrix_of(imki_parameters *p, const imk_document *document, int mapping,
                            const char *key, double matrix[3][3], int *node)
{
    *node = imki_document_value(document, mapping, key);
    return *node == IMKI_NONE ? IMK_OK : imki_node_matrix(p, document, *node, matrix);
}

static imk_status read_gyroscopes(imki_parameters *p, const imk_document *document, int mapping)
{
    static const char *const known[] = {"M", "A", "C_gyro_i"};
    double m[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, c[3][3], a[3][3] = {{0}};
    int node, last = mapping;
    memcpy(c, m, sizeof c);
    imk_status status = matrix_of(p, document, mapping, "M", m, &node);
    if (status == IMK_OK && node != IMKI_NONE)
        last = node;
    if (status == IMK_OK)
        status = matrix_of(p, document, mapping, "C_gyro_i", c, &node);
    if (status == IMK_OK)
        status = matrix_of(p, document, mapping, "A", a, &node);
    for (int key = document->node[mapping].first; key != IMKI_NONE && status == IMK_OK;) {
        const char *name = document->node[key].text;
        if (strcmp(name, "M") != 0 && strcmp(name, "A") != 0 && strcmp(name, "C_gyro_i") != 0)
            status = imki_foreign_key(p, document, key, 3, known);
        key = document->node[document->node[key].next].next;
    }
    if (status != IMK_OK)
        return status;
    imki_multiply(m, c, m);
    imki_multiply(a, c, a);
    for (int i = 0; i < 3; i++)
        memcpy(p->model->gyro.g_sensitivity.value[i], a[i], sizeof a[i]);
    return imki_response_set(p, imki_node_place(document, last), &p->model->gyro, m);
}

static imk_status read_accelerometers(imki_parameters *p, const imk_document *document, int mapping)
{
    static const char *const known[] = {"M", "rx_i", "ry_i", "rz_i"};
    double m[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    imk_triad *accel = &p->model->accel;
    int node, last;
    imk_status status = matrix_of(p, document, mapping, "M", m, &node);
    last = node == IMKI_NONE ? mapping : node;
    for (int i = 0; i < 3 && status == IMK_OK; i++) {
        node = imki_document_value(document, mapping, known[i + 1]);
        double position[3] = {0};
        if (node != IMKI_NONE)
            status = imki_node_numbers(p, document, node, 3, position);
        memcpy(accel->lever_arm.value[i], position, sizeof position);
        if (position[0] != 0 || position[1] != 0 || position[2] != 0)
            imki_note(p, false,
                      "lever arms: kalibr lets M mix the components of several places; here axis i "
                      "senses all of them at its own (a difference of misalignment times lever "
                      "arm)");
    }
    for (int key = document->node[mapping].first; key != IMKI_NONE && status == IMK_OK;) {
        bool is_known = false;
        for (int i = 0; i < 4; i++)
            is_known = is_known || strcmp(document->node[key].text, known[i]) == 0;
        if (!is_known)
            status = imki_foreign_key(p, document, key, 4, known);
        key = document->node[document->node[key].next].next;
    }
    return status == IMK_OK ? imki_response_set(p, imki_node_place(document, last), accel, m)
                            : status;
}

static imk_status read_keys(imki_parameters *p, const imk_document *document, int imu)
{
    static const char *const known[] = {"gyroscope_noise_density",
                                        "gyroscope_random_walk",
                                        "accelerometer_noise_density",
                                        "accelerometer_random_walk",
                                        "gyroscopes",
                                        "accelerometers",
                                        "update_rate",
                                        "time_offset"};
    enum { KNOWN = sizeof known / sizeof known[0] };
    imk_status status = IMK_OK;
    for (int key = document->node[imu].first; key != IMKI_NONE && status == IMK_OK;) {
        int value = document->node[key].next;
        const char *name = document->node[key].text;
        bool is_mapping = document->node[value].kind == IMKI_NODE_MAPPING;
        bool is_known = imki_kalibr_is_setup(name);
        for (size_t i = 0; i < KNOWN; i++)
            is_known = is_known || strcmp(name, known[i]) == 0;
        if (strcmp(name, "gyroscopes") == 0 && is_mapping)
            status = read_gyroscopes(p, document, value);
        else if (strcmp(name, "accelerometers") == 0 && is_mapping)
            status = read_accelerometers(p, document, value);
        else if (!is_known)
            status = imki_foreign_key(p, document, key, KNOWN, known);
        key = document->node[value].next;
    }
    return status;
}

imk_status imki_kalibr_read(imki_parameters *p)
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
        status = read_keys(p, document, imu);
    if (status == IMK_OK)
        imki_kalibr_note_setup(p, document, imu);
    imk_document_free(document);
    return status;
}

/* ---- writing --------------------------------------------------------------------------------- */

static imk_status write_gyroscopes(imki_parameters *p)
{
    double response[3][3], m[3][3], c[3][3], a[3][3], c_transposed[3][3];
    imki_response_of(&p->source->gyro, response);
    if (!imki_lower_and_rotation(response, m, c))
        return imk_error_set(p->error, IMK_ERROR_UNSUPPORTED, "gyro.direction",
                             "the gyro axes are not a right-handed set", "");
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
    return IMK_OK;
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
        imki_text_add(&p->out, "%supdate_rate: ", indent);
        imki_text_numbers(&p->out, &p->settings->rate, 1, "");
        imki_text_add(&p->out, "  # [Hz]\n");
    } else {
        imki_text_add(&p->out, "%s# update_rate: [Hz], add it\n", indent);
        imki_note(p, true, "kalibr needs update_rate: add it to the file, or convert with --rate");
    }
    if (intrinsics)
        imki_text_add(&p->out, "  model: scale-misalignment%s\n", lever_arms ? "-size-effect" : "");
}

/* With intrinsics the file is like a result (imu0: …), without like the input imu.yaml. */
imk_status imki_kalibr_write(imki_parameters *p)
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
    imki_text_add(&p->out, "%s%s", explanation, intrinsics ? "imu0:\n" : "");
    imki_kalibr_noise_write(p, intrinsics ? "  " : "");
    imk_status status = intrinsics && gyro->present ? write_gyroscopes(p) : IMK_OK;
    if (intrinsics && accel->present)
        write_accelerometers(p, lever_arms);
    write_setup(p, intrinsics, lever_arms);
    return status;
}
