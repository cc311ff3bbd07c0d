/* SPDX-License-Identifier: Apache-2.0 */
/* Foreign parameter files: which format a file has, and reading and writing by it.
 *
 * Writing ends with reading back what was written: whatever does not return as it was is noted as
 * lost, so that no format can drop something silently. */
#define _POSIX_C_SOURCE 200809L
#include "imukit/parameter_file.h"

#include "io/file/text_file_internal.h"
#include "parameter_internal.h"

#include "imukit/names.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- formats --------------------------------------------------------------------------------- */

static const struct format {
    const char *name;
    imki_parameter_function *read, *write;
    bool has_several; /* a file may be of several sensors */
    bool has_flicker; /* it has a place for bias instability */
    imki_walk walk;
} formats[] = {
    [IMK_PARAMETERS_KALIBR] = {"kalibr", imki_kalibr_read, imki_kalibr_write, true, false,
                               IMKI_WALK_NEEDED},
    [IMK_PARAMETERS_GAZEBO] = {"gazebo", imki_gazebo_read, imki_gazebo_write, true, false,
                               IMKI_WALK_NONE},
    [IMK_PARAMETERS_MATLAB] = {"matlab", imki_matlab_read, imki_matlab_write, true, true,
                               IMKI_WALK_HELD},
    [IMK_PARAMETERS_GNSS_INS_SIM] = {"gnss-ins-sim", imki_gnss_ins_sim_read,
                                     imki_gnss_ins_sim_write, false, false, IMKI_WALK_NONE},
    [IMK_PARAMETERS_NAVEGO] = {"navego", imki_navego_read, imki_navego_write, true, false,
                               IMKI_WALK_HELD},
    [IMK_PARAMETERS_OPENVINS] = {"openvins", imki_openvins_read, imki_openvins_write, false, false,
                                 IMKI_WALK_NEEDED},
    [IMK_PARAMETERS_VINS] = {"vins", imki_vins_read, imki_vins_write, false, false,
                             IMKI_WALK_NEEDED},
    [IMK_PARAMETERS_PX4] = {"px4", imki_px4_read, imki_px4_write, true, false, IMKI_WALK_NONE},
    [IMK_PARAMETERS_ARDUPILOT] = {"ardupilot", imki_ardupilot_read, imki_ardupilot_write, true,
                                  false, IMKI_WALK_NONE},
    [IMK_PARAMETERS_FILTER] = {"filter", imki_filter_read, imki_filter_write, false, true,
                               IMKI_WALK_HELD},
    [IMK_PARAMETERS_LIO_SAM] = {"lio-sam", imki_lio_sam_read, imki_lio_sam_write, false, false,
                                IMKI_WALK_NEEDED},
    [IMK_PARAMETERS_FAST_LIO] = {"fast-lio", imki_fast_lio_read, imki_fast_lio_write, false, false,
                                 IMKI_WALK_WANTED},
    [IMK_PARAMETERS_DLIO] = {"dlio", imki_dlio_read, imki_dlio_write, false, false, IMKI_WALK_NONE},
    [IMK_PARAMETERS_GLIM] = {"glim", imki_glim_read, imki_glim_write, false, false,
                             IMKI_WALK_WANTED},
    [IMK_PARAMETERS_ORB_SLAM3] = {"orb-slam3", imki_orb_slam3_read, imki_orb_slam3_write, false,
                                  false, IMKI_WALK_NEEDED},
    [IMK_PARAMETERS_GTSAM] = {"gtsam", imki_gtsam_read, imki_gtsam_write, false, false,
                              IMKI_WALK_OF_EACH},
    [IMK_PARAMETERS_AIRSIM] = {"airsim", imki_airsim_read, imki_airsim_write, true, false,
                               IMKI_WALK_WANTED},
    [IMK_PARAMETERS_FUSION] = {"fusion", imki_fusion_read, imki_fusion_write, false, false,
                               IMKI_WALK_NONE},
};
enum { FORMATS = sizeof formats / sizeof formats[0] };

const char *imk_parameter_format_name(imk_parameter_format format)
{
    return (int)format > 0 && (int)format < FORMATS ? formats[format].name : NULL;
}

imk_parameter_format imk_parameter_format_find(const char *name)
{
    for (int i = 1; i < FORMATS; i++)
        if (strcmp(formats[i].name, name) == 0)
            return (imk_parameter_format)i;
    return IMK_PARAMETERS_UNKNOWN;
}

static const uint32_t settings_cookie = 0x70617231; /* "par1" */

imk_parameter_settings imk_parameter_default(void)
{
    return (imk_parameter_settings){.cookie = settings_cookie,
                                    .filter = imk_filter_noise_default()};
}

/* ---- reading --------------------------------------------------------------------------------- */

/* All bytes of a file and a zero. */
static imk_status read_all(const char *path, bool reopened, char **text, size_t *size,
                           imk_error *error)
{
    enum { LIMIT = IMKI_DOCUMENT_SIZE_MAX - 1 };
    const imk_status status = imki_file_read(path, reopened, LIMIT, text, size, error);
    if (status != IMK_OK || *size <= LIMIT)
        return status;
    free(*text);
    *text = NULL;
    return imk_error_set(error, IMK_ERROR_UNSUPPORTED, path, "the file is longer than 1 MiB",
                         "a parameter file");
}

imk_status imk_parameter_format_detect(const char *path, imk_parameter_format *format,
                                       imk_error *error)
{
    char *text = NULL;
    size_t size;
    const imk_status status = read_all(path, true, &text, &size, error);
    const bool is_missing = status == IMK_ERROR_OPEN && access(path, F_OK) != 0;
    if (status == IMK_ERROR_READ || status == IMK_ERROR_MEMORY ||
        (status == IMK_ERROR_OPEN && !is_missing))
        return status;
    *format = status == IMK_OK ? imki_parameter_recognise(text, size) : IMK_PARAMETERS_UNKNOWN;
    free(text);
    return IMK_OK;
}

static imk_status check_settings(const imk_parameter_settings *settings, imk_error *error)
{
    if (!settings || settings->cookie != settings_cookie)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "settings", "",
                             "settings from imk_parameter_default()");
    if (settings->rate != 0 && !(settings->rate >= 1e-9 && settings->rate <= 1e9))
        return imk_error_set(error, IMK_ERROR_RANGE, "rate", "",
                             "a sample rate from 1e-9 Hz to 1e9 Hz");
    if (settings->frame_rate != 0 && !(settings->frame_rate >= 1e-9 && settings->frame_rate <= 1e9))
        return imk_error_set(error, IMK_ERROR_RANGE, "frame_rate", "",
                             "a frame rate from 1e-9 Hz to 1e9 Hz");
    if (settings->bias_instability_tau != 0 &&
        !(settings->bias_instability_tau >= 1e-8 && settings->bias_instability_tau <= 1e8))
        return imk_error_set(error, IMK_ERROR_RANGE, "bias_instability_tau", "",
                             "an averaging time from 1e-8 s to 1e8 s");
    if ((int)settings->format < 0 || (int)settings->format >= FORMATS)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "format", "", "one of the formats");
    return IMK_OK;
}

/* Where the densities are settled, an option that says otherwise would be a mistake. */
static imk_status check_density(const imk_parameter_settings *settings, imk_parameter_format format,
                                imk_error *error)
{
    if (settings->density != IMK_DENSITY_ONE_SIDED || format == IMK_PARAMETERS_VINS ||
        format == IMK_PARAMETERS_MATLAB)
        return IMK_OK;
    char found[96];
    snprintf(found, sizeof found, "the densities of the format %s are two-sided, not one-sided",
             formats[format].name);
    return imk_error_set(error, IMK_ERROR_CONFLICT, "density", found,
                         "leave --density out, or divide the numbers by sqrt(2) first");
}

static imk_status check_sensor(const imk_parameter_settings *settings, imk_parameter_format format,
                               imk_error *error)
{
    if (!settings->sensor || formats[format].has_several)
        return IMK_OK;
    char found[96];
    snprintf(found, sizeof found, "the format %s has one sensor only", formats[format].name);
    return imk_error_set(error, IMK_ERROR_CONFLICT, "sensor", found, "leave --sensor out");
}

/* `text` ends with a zero. */
static imk_status parse_text(const char *text, size_t size, const imk_parameter_settings *settings,
                             imk_model *made, imk_parameter_notes *notes, imk_error *error)
{
    imki_parameters p = {.settings = settings,
                         .notes = notes,
                         .error = error,
                         .text = text,
                         .size = size,
                         .model = made,
                         .triad = {&made->gyro, &made->accel}};
    imk_parameter_format format = settings->format;
    imk_model_default(made);
    if (memchr(text, '\0', size))
        return imk_error_set(error, IMK_ERROR_FORMAT, "", "", "a text file");
    if (format == IMK_PARAMETERS_UNKNOWN)
        format = imki_parameter_recognise(text, size);
    if (format == IMK_PARAMETERS_UNKNOWN)
        return imk_error_set(error, IMK_ERROR_FORMAT, "", "",
                             "a parameter file of a program that imukit convert --help lists (name "
                             "the format with --from)");
    p.status = check_density(settings, format, error);
    if (p.status == IMK_OK)
        p.status = check_sensor(settings, format, error);
    if (p.status == IMK_OK)
        formats[format].read(&p);
    imk_document_free(p.document);
    return p.status == IMK_OK ? imk_model_validate(made, error) : p.status;
}

imk_status imk_parameters_parse(const char *text, size_t size,
                                const imk_parameter_settings *settings, imk_model *model,
                                imk_parameter_notes *notes, imk_error *error)
{
    imk_status status = check_settings(settings, error);
    if (status != IMK_OK)
        return status;
    char *copy = malloc(size + 1);
    imk_model *made = malloc(sizeof *made);
    imk_parameter_notes found = {.count = 0};
    if (!copy || !made) {
        free(copy);
        free(made);
        return imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    }
    if (size > 0)
        memcpy(copy, text, size);
    copy[size] = '\0';
    status = parse_text(copy, size, settings, made, &found, error);
    if (status == IMK_OK) {
        *model = *made;
        if (notes)
            *notes = found;
    }
    free(copy);
    free(made);
    return status;
}

imk_status imk_parameters_read(const char *path, const imk_parameter_settings *settings,
                               imk_model *model, imk_parameter_notes *notes, imk_error *error)
{
    char *text = NULL;
    size_t size = 0;
    imk_status status = read_all(path, false, &text, &size, error);
    if (status == IMK_OK && text)
        status = imk_parameters_parse(text, size, settings, model, notes, error);
    free(text);
    return status;
}

/* ---- writing --------------------------------------------------------------------------------- */

/* An option that the format has no use for was meant for another. */
static imk_status check_walk(const imk_parameter_settings *settings, imk_error *error)
{
    const struct format *format = &formats[settings->format];
    const bool tau = settings->bias_instability_tau > 0;
    char found[96];
    if (format->walk == IMKI_WALK_NONE && (tau || settings->use_bounds)) {
        snprintf(found, sizeof found, "the format %s has no random walk", format->name);
        return imk_error_set(error, IMK_ERROR_CONFLICT, tau ? "bias_instability_tau" : "use_bounds",
                             found,
                             tau ? "leave --bias-instability-tau out" : "leave --use-bounds out");
    }
    if (!tau || !format->has_flicker)
        return IMK_OK;
    snprintf(found, sizeof found, "the format %s has bias instability itself", format->name);
    return imk_error_set(error, IMK_ERROR_CONFLICT, "bias_instability_tau", found,
                         settings->format == IMK_PARAMETERS_FILTER
                             ? "leave --bias-instability-tau out; --flicker, --tau-from and "
                               "--tau-to say how it is approximated"
                             : "leave --bias-instability-tau out");
}

static imk_status check_model(const imk_parameter_settings *settings, const imk_model *model,
                              imk_error *error)
{
    imk_status status = check_settings(settings, error);
    if (status == IMK_OK && settings->format == IMK_PARAMETERS_UNKNOWN)
        status = imk_error_set(error, IMK_ERROR_ARGUMENT, "format", "", "the format to write");
    if (status == IMK_OK)
        status = check_density(settings, settings->format, error);
    if (status == IMK_OK)
        status = check_walk(settings, error);
    if (status == IMK_OK)
        status = imk_model_validate(model, error);
    if (status != IMK_OK)
        return status;
    if (!model->gyro.present && !model->accel.present && settings->format != IMK_PARAMETERS_FUSION)
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "model",
                             "the model has neither gyros nor accelerometers",
                             "a model of an IMU, or --to fusion for a magnetometer alone");
    const imk_triad *triads[2] = {&model->gyro, &model->accel};
    for (int i = 0; i < 2; i++)
        if (triads[i]->present && triads[i]->axis_count != 3)
            return imk_error_set(
                error, IMK_ERROR_UNSUPPORTED, i == 0 ? "gyro.direction" : "accel.direction",
                "the foreign formats have three axes, the model has another number of axes", "");
    return IMK_OK;
}

imk_status imk_parameters_print(const char *path, const imk_parameter_settings *settings,
                                const imk_model *model, char **text, size_t *size,
                                imk_parameter_notes *notes, imk_error *error)
{
    imk_parameter_notes found = {.count = 0};
    imk_status status = check_model(settings, model, error);
    if (status != IMK_OK)
        return status;
    imki_parameters p = {.settings = settings,
                         .notes = &found,
                         .error = error,
                         .source = model,
                         .origin = {&model->gyro, &model->accel},
                         .is_json = imk_has_ending(path, ".json"),
                         .is_cpp = imk_has_ending(path, ".h") || imk_has_ending(path, ".hpp") ||
                                   imk_has_ending(path, ".cpp")};
    const struct format *format = &formats[settings->format];
    imk_model *changed = NULL;
    imki_walk_supply(&p, format->walk, format->name, &changed);
    if (p.status == IMK_OK)
        format->write(&p);
    if (p.out.failed)
        imki_parameter_refuse(&p, IMK_ERROR_MEMORY, "", "", "");
    if (p.status == IMK_OK)
        imki_parameters_compare(&p, format->read, format->name);
    free(changed);
    if (p.status != IMK_OK) {
        free(p.out.bytes);
        return p.status;
    }
    if (notes)
        *notes = found;
    *text = p.out.bytes;
    *size = p.out.size;
    return IMK_OK;
}

imk_status imk_parameters_write(const char *path, const imk_parameter_settings *settings,
                                const imk_model *model, imk_parameter_notes *notes,
                                imk_error *error)
{
    char *text = NULL;
    size_t size = 0;
    imk_status status = imk_parameters_print(path, settings, model, &text, &size, notes, error);
    if (status == IMK_OK)
        status = imki_text_file_write(path, text, size, error);
    free(text);
    return status;
}
