/* SPDX-License-Identifier: Apache-2.0 */
/** @file show.h
 *  The results of jobs, made ready to be shown: each function adds data, tables and figures to an
 *  imk_result (result.h). `name` is what the record is called, such as its file. */
#ifndef IMUKIT_SHOW_RESULTS_H
#define IMUKIT_SHOW_RESULTS_H

#include "imukit/allan_log.h"
#include "imukit/result.h"
#include "imukit/spectrum_log.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Deviations: a table for each statistic and kind of sensor, a figure. */
IMK_API void imk_show_allan_log(const imk_allan_log *allan, const char *name, imk_result *result);

/** Densities, lines and parameters: a table for each kind of sensor, a figure. */
IMK_API void imk_show_spectrum_log(const imk_spectrum_log *spectrum, const char *name,
                                   imk_result *result);

#ifdef __cplusplus
}
#endif
#endif
