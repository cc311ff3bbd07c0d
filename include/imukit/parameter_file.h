/* SPDX-License-Identifier: Apache-2.0 */
/** @file parameter_file.h
 *  Sensor parameters in the formats of other programs, read into a model and written from one.
 *
 *  None of these formats states units. Some do not tell whether a density is one- or two-sided, or
 *  whether a standard deviation is per sample or per root hertz. The notes say how each value was
 *  interpreted, and list every value that a format cannot hold. See docs/other-formats.md. */
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
    IMK_PARAMETERS_FILTER,    /**< for Kalman filters: bias states, Q_c, Phi, Q_d (filter_noise.h),
                                   as YAML or JSON */
    IMK_PARAMETERS_LIO_SAM,   /**< imuAccNoise, imuGyrNoise, … of params.yaml */
    IMK_PARAMETERS_FAST_LIO,  /**< mapping: acc_cov, gyr_cov, b_acc_cov, b_gyr_cov */
    IMK_PARAMETERS_DLIO,      /**< imu: intrinsics: of direct LiDAR-inertial odometry */
    IMK_PARAMETERS_GLIM,      /**< config_sensors.json */
    IMK_PARAMETERS_ORB_SLAM3, /**< IMU.NoiseGyro, … in an OpenCV yaml */
    IMK_PARAMETERS_GTSAM,     /**< PreintegrationCombinedParams in Python or C++ */
    IMK_PARAMETERS_AIRSIM,    /**< Imu of settings.json */
    IMK_PARAMETERS_FUSION     /**< calibration of xioTechnologies/Fusion as constants of C */
} imk_parameter_format;

/** Name of a format ("kalibr", "gazebo", "matlab", "gnss-ins-sim", "navego", "openvins", "vins",
 *  "px4", "ardupilot", "filter", "lio-sam", "fast-lio", "dlio", "glim", "orb-slam3", "gtsam",
 *  "airsim", "fusion"); NULL beyond the last. */
IMK_API const char *imk_parameter_format_name(imk_parameter_format format);
/** Format by its name; IMK_PARAMETERS_UNKNOWN when there is none. */
IMK_API imk_parameter_format imk_parameter_format_find(const char *name);
/** Detect the format of a file by its name and content: IMK_PARAMETERS_UNKNOWN if it has none of
 *  these formats or does not exist. A pipe is copied to a temporary file, which is read when this
 *  process opens the pipe next.
 *  @return IMK_ERROR_OPEN, IMK_ERROR_READ, IMK_ERROR_MEMORY */
IMK_API imk_status imk_parameter_format_detect(const char *path, imk_parameter_format *format,
                                               imk_error *error);

enum { IMK_PARAMETER_NOTES_MAX = 64 };

/** Assumptions made and values left out: one message each. */
typedef struct imk_parameter_notes {
    size_t count;
    struct imk_parameter_note {
        bool lost; /**< true: a value was left out; false: an assumption was made */
        char text[240];
    } note[IMK_PARAMETER_NOTES_MAX];
} imk_parameter_notes;

/** How to read or write. Start from imk_parameter_default(). */
typedef struct imk_parameter_settings {
    uint32_t cookie;
    imk_parameter_format format; /**< UNKNOWN: detected when reading; must be set for writing */
    /** Sampling rate [Hz], 1e-9 … 1e9; 0: not given. Required if a format states noise per sample
     *  (Gazebo without update_rate), or if an infinite correlation time means white noise per
     *  sample (gnss-ins-sim, NaveGo). For a VINS file, a rate means that the numbers are per
     *  sample. */
    double rate;
    /** Kind of density in formats that do not state it: VINS (the numbers are then densities, not
     *  per sample) and MATLAB (instead of the interpretation of imuSensor). UNSTATED: as the
     *  format's program interprets it; if that is not defined, reading fails and names the options.
     */
    imk_density density;
    const char *sensor; /**< name of one of several sensors in the file; NULL: there is only one */
    imk_filter_noise_settings filter; /**< writing FILTER: how bias instability is approximated */
    /** GLIM: frames (LiDAR scans) per second [Hz], 1e-9 … 1e9, because its noise of the biases is
     *  per frame; 0: not given. */
    double frame_rate;
    /** Writing a format that has a random walk but no bias instability: carry B into the walk, as
     *  sqrt(K^2 + (6 ln 2/pi) B^2/T), which has the Allan deviation of B at T [s], 1e-8 … 1e8. 0: B
     *  is left out. */
    double bias_instability_tau;
    /** Writing: where the model has no random walk (K), use its upper bound in the evidence. */
    bool use_bounds;
} imk_parameter_settings;
/** Detect the format; no rate, density not stated; imk_filter_noise_default(). */
IMK_API imk_parameter_settings imk_parameter_default(void);

/** Read a parameter file into a model.
 *  @return IMK_ERROR_FORMAT (none of the formats), _KEY_MISSING (error.expected: the option to
 *          add), _KEY_UNKNOWN, _SYNTAX, _RANGE (a value cannot be in the unit of the format; the
 *          message names the likely unit), … with line */
IMK_API imk_status imk_parameters_read(const char *path, const imk_parameter_settings *settings,
                                       imk_model *model, imk_parameter_notes *notes,
                                       imk_error *error);
/** As imk_parameters_read(), for a text in memory. */
IMK_API imk_status imk_parameters_parse(const char *text, size_t size,
                                        const imk_parameter_settings *settings, imk_model *model,
                                        imk_parameter_notes *notes, imk_error *error);
/** Write a model as a parameter file. Comments state every unit, if the format has comments.
 *
 *  The file is read back and compared with the model; differences are noted as lost.
 *  Filters and estimators need white noise and a random walk. If the model has none and the program
 *  cannot do without, or if B or a bound could stand for it, nothing is written unless
 *  `bias_instability_tau` or `use_bounds` is set.
 *  @return IMK_ERROR_UNSUPPORTED when nothing of the model fits, _KEY_MISSING (error.expected: the
 *          option to add), _CONFLICT (a setting that the format has no use for); errors of
 *          validation and of writing */
IMK_API imk_status imk_parameters_write(const char *path, const imk_parameter_settings *settings,
                                        const imk_model *model, imk_parameter_notes *notes,
                                        imk_error *error);

/** As imk_parameters_write(), into memory obtained from malloc(), which the caller frees. `path`
 *  only decides between JSON (.json) and YAML, or C++ (.h, .hpp, .cpp) and Python, if a format has
 *  both; NULL: YAML, Python. */
IMK_API imk_status imk_parameters_print(const char *path, const imk_parameter_settings *settings,
                                        const imk_model *model, char **text, size_t *size,
                                        imk_parameter_notes *notes, imk_error *error);

IMK_END_C
#endif
