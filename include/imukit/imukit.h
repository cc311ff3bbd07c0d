/* SPDX-License-Identifier: Apache-2.0 */
/** @file imukit.h
 *  Everything of libimukit. Instruments: imukit/physics.h; reading and writing files: imukit/io.h.
 *
 *  Threads. The library has no writable data and makes no threads. All functions may run at the
 *  same time on any threads, as long as none writes data that another one uses. A function writes
 *  only to arguments that are not `const`: results, workspaces, objects such as a simulator or a
 *  compensator. Arguments that are `const` may be shared, and must not change while they are used.
 *  If a function takes an executor (executor.h), the bits of its result do not depend on it. */
#ifndef IMUKIT_IMUKIT_H
#define IMUKIT_IMUKIT_H

#include "imukit/aiding.h"
#include "imukit/alignment.h"
#include "imukit/allan.h"
#include "imukit/allan_fit.h"
#include "imukit/allan_gaps.h"
#include "imukit/allan_stream.h"
#include "imukit/attitude.h"
#include "imukit/axes_mending.h"
#include "imukit/calibration.h"
#include "imukit/calibration_plan.h"
#include "imukit/compensate.h"
#include "imukit/correct.h"
#include "imukit/decimal.h"
#include "imukit/device_sensitivity.h"
#include "imukit/distort.h"
#include "imukit/distributions.h"
#include "imukit/drift.h"
#include "imukit/earth.h"
#include "imukit/elementary.h"
#include "imukit/evaluate.h"
#include "imukit/executor.h"
#include "imukit/ferraris.h"
#include "imukit/filter_noise.h"
#include "imukit/firmware.h"
#include "imukit/fourier.h"
#include "imukit/identify.h"
#include "imukit/identify_joint.h"
#include "imukit/identify_plan.h"
#include "imukit/identify_record.h"
#include "imukit/least_squares.h"
#include "imukit/linear_algebra.h"
#include "imukit/magnetometer.h"
#include "imukit/model.h"
#include "imukit/model_join.h"
#include "imukit/model_parameter.h"
#include "imukit/model_unstated.h"
#include "imukit/motion.h"
#include "imukit/motion_script.h"
#include "imukit/names.h"
#include "imukit/navigate.h"
#include "imukit/navigation_filter.h"
#include "imukit/noise.h"
#include "imukit/noise_map.h"
#include "imukit/procedure.h"
#include "imukit/random.h"
#include "imukit/record_screen.h"
#include "imukit/reference_alignment.h"
#include "imukit/repeatability.h"
#include "imukit/samples.h"
#include "imukit/simulate.h"
#include "imukit/spectrum.h"
#include "imukit/standing_start.h"
#include "imukit/standstill.h"
#include "imukit/static_detection.h"
#include "imukit/status.h"
#include "imukit/technology_map.h"
#include "imukit/test_record.h"
#include "imukit/thermal.h"
#include "imukit/units.h"
#include "imukit/utf8.h"

#endif
