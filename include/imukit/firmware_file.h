/* SPDX-License-Identifier: Apache-2.0 */
/** @file firmware_file.h
 *  A plan of correction (firmware.h) as C99: NAME.h and NAME.c, which need nothing but <stdint.h>,
 *  and NAME_test.c, a table of readings and the results of imk_correct() for them.
 *
 *  The code has no loop, no heap, no libm, no variable outside its function. Equal models give
 *  equal bytes. The comment at its head states the terms taken out and left in, units, bound and
 *  cost. */
#ifndef IMUKIT_FIRMWARE_FILE_H
#define IMUKIT_FIRMWARE_FILE_H

#include "imukit/compensate_log.h"
#include "imukit/firmware.h"

IMK_BEGIN_C

enum { IMK_FIRMWARE_NAME_MAX = 48 };

/** How to write. Start from imk_firmware_file_default(), then change fields. */
typedef struct imk_firmware_file_settings {
    uint32_t cookie;
    const char *name; /**< name of the files, and prefix of every name in them: letters, digits, _;
                         NULL: "imukit_" and the name of the model */
    uint32_t vectors; /**< number of samples in the test's table, 1 … 1 000 000; default 64 */
} imk_firmware_file_settings;
/** Names from the model, 64 vectors. */
IMK_API imk_firmware_file_settings imk_firmware_file_default(void);

/** The name that the files will have: from the settings, or made from the model's name. */
IMK_API void imk_firmware_name(const imk_firmware_file_settings *settings, const imk_model *model,
                               char name[IMK_FIRMWARE_NAME_MAX]);

/** List the terms that the plan takes out of the readings of a unit, and those that it leaves in.
 */
IMK_API void imk_firmware_terms(const imk_firmware *firmware, const imk_model *model,
                                imk_term_keys *taken_out, imk_term_keys *left_in);

/** Write NAME.h, NAME.c and NAME_test.c into a directory, which is created if it does not exist.
 *  Files of these names that were not made by this function are not replaced.
 *  @param firmware  from imk_firmware_plan()
 *  @param model     the model that was planned for
 *  @param settings  NULL: imk_firmware_file_default()
 *  @return IMK_ERROR_UNINITIALISED, _ARGUMENT (name), _RANGE (vectors), _CONFLICT (a file of that
 *          name was not made by this function), _OPEN, _WRITE, _MEMORY */
IMK_API imk_status imk_firmware_write(const char *directory, const imk_firmware *firmware,
                                      const imk_model *model,
                                      const imk_firmware_file_settings *settings, imk_error *error);

IMK_END_C
#endif
