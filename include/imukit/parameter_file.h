/* SPDX-License-Identifier: Apache-2.0 */
/** @file parameter_file.h
 *  Sensor parameters in the formats of other programs, read into a model and written from one.
 *
 *  None of these formats carries units, and some leave open whether a density is one- or two-sided,
 *  a standard deviation per sample or per root hertz. What each value is taken for is said in the
 *  notes; what a format cannot hold is listed, never dropped silently. Docs: docs/other-formats.md.
 */
#ifndef IMUKIT_PARAMETER_FILE_H
#define IMUKIT_PARAMETER_FILE_H

#include "imukit/filter_noise.h"
#include "imukit/model.h"

IMK_BEGIN_C

typedef enum imk_parameter_format {
    IMK_PARAMETERS_UNKNOWN = 0,
    IMK_PARAMETERS_KALIBR,       /**< imu.yaml and the intrinsics of a calibration result */
    IMK_PARAMETERS_GAZEBO,       /**< SDF sensor noise (XML) */
    IMK_PARAMETERS_MATLAB,       /**< imuSensor parameters as JSON */
    IMK_PARAMETERS_GNSS_INS_SIM, /**< its accuracy dictionary, as JSON or YAML */
    IMK_PARAMETERS_NAVEGO,       /**< assignments to a structure, .m */
    IMK_PARAMETERS_OPENVINS,     /**< kalibr_imu_chain.yaml */
    IMK_PARAMETERS_VINS,         /**< acc_n, gyr_n, acc_w, gyr_w in an OpenCV yaml */
    IMK_PARAMETERS_PX4,          /**< TC_…, CAL_… in a parameter file */
    IMK_PARAMETERS_ARDUPILOT,    /**< INS_ACC…, INS_GYR…, INS_TCAL… in a parameter file */
    IMK_PARAMETERS_FILTER /**< for Kalman filters: bias states, Q_c, Phi, Q_d (filter_noise.h),
                               as YAML or JSON */
} imk_parameter_format;

/** Name of a format ("kalibr", "gazebo", "matlab", "gnss-ins-sim", "navego", "openvins", "vins",
 *  "px4", "ardupilot", "filter"); NULL beyond the last. */
IMK_API const char *imk_parameter_format_name(imk_parameter_format format);
/** Format of a name; IMK_PARAMETERS_UNKNOWN when there is none. */
IMK_API imk_parameter_format imk_parameter_format_find(const char *name);
/** Format of a file by its name and content, IMK_PARAMETERS_UNKNOWN when it is none of them, or not
 *  there. A pipe is copied to a temporary file, which the next opening in this process reads.
 *  @return IMK_ERROR_OPEN, IMK_ERROR_READ, IMK_ERROR_MEMORY */
IMK_API imk_status imk_parameter_format_detect(const char *path, imk_parameter_format *format,
                                               imk_error *error);

enum { IMK_PARAMETER_NOTES_MAX = 64 };

/** What was assumed or left out: one message each. */
typedef struct imk_parameter_notes {
    size_t count;
    struct imk_parameter_note {
        bool lost; /**< left out; else assumed */
        char text[240];
    } note[IMK_PARAMETER_NOTES_MAX];
} imk_parameter_notes;

/** How to read or write. Start from imk_parameter_default(). */
typedef struct imk_parameter_settings {
    uint32_t cookie;
    imk_parameter_format format; /**< UNKNOWN: detect (reading); needed for writing */
    /** [Hz], 1e-9 … 1e9; 0: not given. Needed where a format states noise per sample (Gazebo
     *  without update_rate) or an infinite correlation time means white noise per sample
     *  (gnss-ins-sim, NaveGo). In a VINS file it says that the numbers are per sample. */
    double rate;
    /** Of formats that leave it open: VINS (the numbers are densities, not per sample) and MATLAB
     *  (instead of what imuSensor makes of them). UNSTATED: as the format's program takes it; where
     *  that is not settled, refuse, naming the options. */
    imk_density density;
    const char *sensor; /**< which of several sensors in the file; NULL: the only one */
    imk_filter_noise_settings filter; /**< writing FILTER: how bias instability is approximated */
} imk_parameter_settings;
/** Detect the format; no rate, density not stated; imk_filter_noise_default(). */
IMK_API imk_parameter_settings imk_parameter_default(void);

/** Read. @return IMK_ERROR_FORMAT (none of the formats), _KEY_MISSING (error.expected: the option
 *  to add), _KEY_UNKNOWN, _SYNTAX, _RANGE (a value that cannot be in the unit of the format: the
 *  message says which unit it looks like), … with line */
IMK_API imk_status imk_parameters_read(const char *path, const imk_parameter_settings *settings,
                                       imk_model *model, imk_parameter_notes *notes,
                                       imk_error *error);
/** The same from memory. */
IMK_API imk_status imk_parameters_parse(const char *text, size_t size,
                                        const imk_parameter_settings *settings, imk_model *model,
                                        imk_parameter_notes *notes, imk_error *error);
/** Write; comments in the file state every unit where the format has comments.
 *
 *  What was written is read back and compared with the model: whatever does not come back is noted
 *  as lost.
 *  @return IMK_ERROR_UNSUPPORTED when nothing of the model fits, _KEY_MISSING (error.expected: the
 *          option to add); errors of validation and of writing */
IMK_API imk_status imk_parameters_write(const char *path, const imk_parameter_settings *settings,
                                        const imk_model *model, imk_parameter_notes *notes,
                                        imk_error *error);

/** The same into memory obtained from malloc(), which the caller frees. `path` decides only
 *  between JSON (.json) and YAML where a format has both; NULL is YAML. */
IMK_API imk_status imk_parameters_print(const char *path, const imk_parameter_settings *settings,
                                        const imk_model *model, char **text, size_t *size,
                                        imk_parameter_notes *notes, imk_error *error);

IMK_END_C
#endif
