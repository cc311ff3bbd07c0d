/* SPDX-License-Identifier: Apache-2.0 */
/* Which program a parameter file is of, by its content. */
#include "parameter_internal.h"

#include <string.h>

/* Keys that no other program uses, wherever they stand in the tree; `parent` is the key of the
 * mapping they are in, where they alone would not tell. */
static const struct {
    imk_parameter_format format;
    const char *parent;
    const char *keys[4];
} anywhere[] = {
    {IMK_PARAMETERS_LIO_SAM, NULL, {"imuAccNoise", "imuGyrNoise", "imuAccBiasN", "imuGyrBiasN"}},
    {IMK_PARAMETERS_FAST_LIO, "mapping", {"acc_cov", "gyr_cov", "b_acc_cov", "b_gyr_cov"}},
    {IMK_PARAMETERS_GLIM,
     "sensors",
     {"imu_acc_noise", "imu_gyro_noise", "imu_bias_noise", "imu_bias"}},
    {IMK_PARAMETERS_ORB_SLAM3,
     NULL,
     {"IMU.NoiseGyro", "IMU.NoiseAcc", "IMU.GyroWalk", "IMU.AccWalk"}},
    {IMK_PARAMETERS_AIRSIM,
     NULL,
     {"AngularRandomWalk", "VelocityRandomWalk", "GyroBiasStability", "AccelBiasStability"}},
    {IMK_PARAMETERS_DLIO, "imu", {"intrinsics"}},
    {IMK_PARAMETERS_DLIO,
     NULL,
     {"imu/intrinsics/accel/bias", "imu/intrinsics/accel/sm", "imu/intrinsics/gyro/bias"}}};

static bool has_any(const imk_document *document, int node, size_t count, const char *const *keys)
{
    for (size_t i = 0; i < count; i++)
        if (imki_document_value(document, node, keys[i]) != IMKI_NONE)
            return true;
    return false;
}

/* By the keys of the root, or of one of its values. */
static imk_parameter_format recognise_keys(const imk_document *document, int node)
{
    static const char *const vins[] = {"acc_n", "gyr_n", "acc_w", "gyr_w"};
    static const char *const gnss[] = {"gyro_b", "gyro_arw", "gyro_b_stability", "accel_vrw"};
    static const char *const matlab[] = {"Gyroscope", "Accelerometer"};
    static const char *const openvins[] = {"Tw", "Ta", "Tg", "R_IMUtoGYRO", "R_IMUtoACC"};
    static const char *const kalibr[] = {"gyroscopes", "accelerometers"};
    static const char *const filter[] = {"imukit_filter"};
    if (has_any(document, node, 1, filter))
        return IMK_PARAMETERS_FILTER;
    if (has_any(document, node, 4, vins))
        return IMK_PARAMETERS_VINS;
    if (has_any(document, node, 4, gnss))
        return IMK_PARAMETERS_GNSS_INS_SIM;
    if (has_any(document, node, 2, matlab))
        return IMK_PARAMETERS_MATLAB;
    if (has_any(document, node, 5, openvins))
        return IMK_PARAMETERS_OPENVINS;
    if (has_any(document, node, 2, kalibr) ||
        has_any(document, node, IMKI_DENSITIES, imki_kalibr_noise_keys))
        return IMK_PARAMETERS_KALIBR;
    return IMK_PARAMETERS_UNKNOWN;
}

static imk_parameter_format recognise_anywhere(const imk_document *document)
{
    for (size_t i = 0; i < sizeof anywhere / sizeof anywhere[0]; i++) {
        size_t count = 0;
        while (count < 4 && anywhere[i].keys[count])
            count++;
        for (int node = imki_mapping_with(document, 0, count, anywhere[i].keys); node != IMKI_NONE;
             node = imki_mapping_with(document, node + 1, count, anywhere[i].keys)) {
            const int key = document->node[node].key;
            if (!anywhere[i].parent ||
                (key != IMKI_NONE && strcmp(document->node[key].text, anywhere[i].parent) == 0))
                return anywhere[i].format;
        }
    }
    return IMK_PARAMETERS_UNKNOWN;
}

/* A tree that cannot be built has a fault to be told about; for that its words must do. */
static imk_parameter_format recognise_words(const char *text)
{
    static const struct {
        const char *word;
        imk_parameter_format format;
    } words[] = {{"imukit_filter", IMK_PARAMETERS_FILTER},
                 {"acc_n:", IMK_PARAMETERS_VINS},
                 {"gyr_n:", IMK_PARAMETERS_VINS},
                 {"gyro_arw", IMK_PARAMETERS_GNSS_INS_SIM},
                 {"\"Gyroscope\"", IMK_PARAMETERS_MATLAB},
                 {"\"Accelerometer\"", IMK_PARAMETERS_MATLAB},
                 {"R_IMUto", IMK_PARAMETERS_OPENVINS},
                 {"imuAccNoise:", IMK_PARAMETERS_LIO_SAM},
                 {"imuGyrNoise:", IMK_PARAMETERS_LIO_SAM},
                 {"IMU.NoiseGyro", IMK_PARAMETERS_ORB_SLAM3},
                 {"\"AngularRandomWalk\"", IMK_PARAMETERS_AIRSIM},
                 {"\"imu_gyro_noise\"", IMK_PARAMETERS_GLIM},
                 {"gyroscope_noise_density", IMK_PARAMETERS_KALIBR},
                 {"accelerometer_noise_density", IMK_PARAMETERS_KALIBR}};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        if (strstr(text, words[i].word))
            return words[i].format;
    return IMK_PARAMETERS_UNKNOWN;
}

static imk_parameter_format recognise_tree(const char *text, size_t size)
{
    imk_parameter_settings settings = imk_parameter_default();
    imki_parameters p = {.settings = &settings, .text = text, .size = size};
    if (!imki_parameters_document(&p))
        return recognise_words(text);
    const imk_document *document = p.document;
    imk_parameter_format format = IMK_PARAMETERS_UNKNOWN;
    /* A model file has the last word about itself. */
    if (imki_document_value(document, 0, "imukit") == IMKI_NONE) {
        format = recognise_keys(document, 0);
        for (int key = document->node[0].first;
             key != IMKI_NONE && format == IMK_PARAMETERS_UNKNOWN;) {
            format = recognise_keys(document, document->node[key].next);
            key = document->node[document->node[key].next].next;
        }
        if (format == IMK_PARAMETERS_UNKNOWN)
            format = recognise_anywhere(document);
    }
    imk_document_free(p.document);
    return format;
}

/* Does a word of the text begin so? */
static bool has_word(const char *text, const char *beginning)
{
    for (const char *at = strstr(text, beginning); at; at = strstr(at + 1, beginning))
        if (at == text || strchr(" \t\n,", at[-1]))
            return true;
    return false;
}

/* `name.field =`, with a field of NaveGo's. */
static bool has_assignment(const char *text)
{
    static const char *const fields[] = {".arw",    ".vrw",    ".gb_sta",
                                         ".ab_sta", ".gb_dyn", ".ab_dyn"};
    for (size_t i = 0; i < sizeof fields / sizeof fields[0]; i++)
        for (const char *at = strstr(text, fields[i]); at; at = strstr(at + 1, fields[i])) {
            const char *behind = at + strlen(fields[i]);
            behind += strspn(behind, " \t");
            if (behind[0] == '=' && behind[1] != '=')
                return true;
        }
    return false;
}

/* A program's text, not a tree. */
static imk_parameter_format recognise_program(const char *text)
{
    if (strstr(text, "PreintegrationCombinedParams") && strstr(text, "Covariance("))
        return IMK_PARAMETERS_GTSAM;
    if (strstr(text, "FusionMatrix") || strstr(text, "FusionVector"))
        return IMK_PARAMETERS_FUSION;
    return has_assignment(text) ? IMK_PARAMETERS_NAVEGO : IMK_PARAMETERS_UNKNOWN;
}

imk_parameter_format imki_parameter_recognise(const char *text, size_t size)
{
    const char *first = text + strspn(text, " \t\r\n\xEF\xBB\xBF");
    if (memchr(text, '\0', size))
        return IMK_PARAMETERS_UNKNOWN;
    if (*first == '<')
        return strstr(text, "<imu") || strstr(text, "\"imu\"") ? IMK_PARAMETERS_GAZEBO
                                                               : IMK_PARAMETERS_UNKNOWN;
    imk_parameter_format format = recognise_tree(text, size);
    if (format != IMK_PARAMETERS_UNKNOWN)
        return format;
    if (has_word(text, "CAL_GYRO") || has_word(text, "CAL_ACC") || has_word(text, "TC_G") ||
        has_word(text, "TC_A"))
        return IMK_PARAMETERS_PX4;
    if (has_word(text, "INS_ACC") || has_word(text, "INS_GYR") || has_word(text, "INS_TCAL"))
        return IMK_PARAMETERS_ARDUPILOT;
    return recognise_program(text);
}
