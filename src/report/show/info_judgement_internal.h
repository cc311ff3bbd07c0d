/* SPDX-License-Identifier: Apache-2.0 */
/* What a log can be used for, and what is wrong with it. */
#ifndef IMUKI_INFO_JUDGEMENT_INTERNAL_H
#define IMUKI_INFO_JUDGEMENT_INTERNAL_H

#include "show_internal.h"

/* "2 gaps with 12 missing rows, 1 repeated stamp"; nothing where there is no fault. */
void imki_info_faults(const imk_info_log *info, imki_text *faults);
/* Gyros or accelerometers in counts, whose unit nobody stated. */
bool imki_info_counted(const imk_info_log *info);
/* A gyro or an accelerometer whose values are all the same; NULL: there is none. */
const imk_info_channel *imki_info_constant(const imk_info_log *info);
/* Judge the log in the object of the data that is open. @param info  NULL: no rows were read */
void imki_judge_info(const imk_info_log *info, const imk_info_file *file, imk_result *result);

#endif
