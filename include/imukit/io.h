/* SPDX-License-Identifier: Apache-2.0 */
/** @file io.h
 *  Everything of libimukit-io: files, threads, sentences. Needs libyaml, zlib, zstd, pthreads. */
#ifndef IMUKIT_IO_H
#define IMUKIT_IO_H

#include "imukit/log.h"
#include "imukit/model_file.h"
#include "imukit/output_file.h"
#include "imukit/report.h"
#include "imukit/thread_pool.h"

#ifdef __cplusplus
extern "C" {
#endif

/** One or two sentences that say what was found, what was expected and what to do:
 *  `tactical.yaml:7:3: gyro.noise.angle_random_walk: "0.1 deg/h" is an angular rate; expected …`
 *  @param source  file name to put in front, or NULL
 *  @return length; the text is shortened to fit `size` */
IMK_API size_t imk_error_text(const imk_error *error, const char *source, char *text, size_t size);

#ifdef __cplusplus
}
#endif
#endif
