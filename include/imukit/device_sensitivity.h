/* SPDX-License-Identifier: Apache-2.0 */
/** @file device_sensitivity.h
 *  What a count of a digital part is: the sensitivities that data sheets state for each range. They
 *  are nominal; the scale factor of a unit differs by what a calibration finds. */
#ifndef IMUKIT_DEVICE_SENSITIVITY_H
#define IMUKIT_DEVICE_SENSITIVITY_H

#include "imukit/model.h"
#include "imukit/status.h"

IMK_BEGIN_C

/** What a part outputs in counts. */
typedef enum imk_count_kind {
    IMK_COUNTS_GYRO = IMK_GYRO,
    IMK_COUNTS_ACCEL = IMK_ACCEL,
    IMK_COUNTS_TEMPERATURE = 2,
    IMK_COUNT_KINDS = 3
} imk_count_kind;

/** One sensitivity. The texts live for ever. */
typedef struct imk_device_sensitivity {
    const char *part; /**< "BMI088"; parts need not be in the catalogue of devices */
    imk_count_kind kind;
    int bits;           /**< of the number that is output, in two's complement */
    double range;       /**< full scale, + and - [rad/s, m/s^2]; 0: not stated, temperatures */
    double per_count;   /**< SI value of one count [rad/s, m/s^2, K] */
    double zero;        /**< temperature at count 0 [K]; 0 for the other kinds */
    const char *stated; /**< the sensitivity as the source prints it: "16.384 LSB/(deg/s)" */
    const char *range_stated; /**< "2000 deg/s", "24 g"; "" where `range` is 0 */
    const char *source;
} imk_device_sensitivity;

/** Number of sensitivities that are known. */
IMK_API size_t imk_device_sensitivity_count(void);
/** Sensitivity `index`; those of a part stand together. @return false beyond the end */
IMK_API bool imk_device_sensitivity_get(size_t index, imk_device_sensitivity *sensitivity);

/** True when a sensitivity is that of a part of this name, of one of its versions (ADIS16465-2 of
 *  ADIS16465), or of the same part under another name. */
IMK_API bool imk_device_sensitivity_of(const imk_device_sensitivity *sensitivity, const char *name);

/** The sensitivity of a part at a range.
 *
 *  @param part   its name, compared as in imk_name_equal() (names.h). A part with two widths of its
 *                output needs the width behind its name: "ADIS16470 16-bit".
 *  @param range  full scale with its unit: "2000deg/s", "24 g", "+-500 dps". NULL or blank when the
 *                part has one range only; not used for temperatures
 *  @param error  field is "device" or "range"; expected lists the ranges or widths there are, or
 *                names the nearest part
 *  @return IMK_ERROR_NAME_UNKNOWN (part, or its width must be stated), _UNSUPPORTED (nothing known
 *          of this kind of the part), _KEY_MISSING (the range must be stated), _RANGE (no such
 *          range), and what imk_quantity_parse() returns for the range */
IMK_API imk_status imk_device_sensitivity_find(const char *part, imk_count_kind kind,
                                               const char *range,
                                               imk_device_sensitivity *sensitivity,
                                               imk_error *error);

IMK_END_C
#endif
