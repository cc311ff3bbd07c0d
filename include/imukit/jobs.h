/* SPDX-License-Identifier: Apache-2.0 */
/** @file jobs.h
 *  What a user calls a task, as functions: a record source and settings in, one result out, and
 *  renderers that make JSON, text and pages of it. No file is opened and no thread is made. Part of
 *  libimukit-io. */
#ifndef IMUKIT_JOBS_H
#define IMUKIT_JOBS_H

#include "imukit/allan_log.h"
#include "imukit/allocator.h"
#include "imukit/calibrate_log.h"
#include "imukit/channel_units.h"
#include "imukit/compensate_log.h"
#include "imukit/convert_log.h"
#include "imukit/drift_models.h"
#include "imukit/evaluate_log.h"
#include "imukit/evaluate_sheet.h"
#include "imukit/even_record.h"
#include "imukit/grade_position.h"
#include "imukit/identify_curve.h"
#include "imukit/identify_log.h"
#include "imukit/identify_several.h"
#include "imukit/job.h"
#include "imukit/navigate_log.h"
#include "imukit/physics_log.h"
#include "imukit/readable.h"
#include "imukit/record.h"
#include "imukit/record_plan.h"
#include "imukit/report.h"
#include "imukit/result.h"
#include "imukit/show.h"
#include "imukit/simulate_log.h"
#include "imukit/spectrum_log.h"

#endif
