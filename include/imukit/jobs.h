/* SPDX-License-Identifier: Apache-2.0 */
/** @file jobs.h
 *  All jobs in one header. A job is a task of the command as a function: it takes a record source
 *  and settings and gives one result; renderers make JSON, text and pages of the result. Jobs open
 *  no file and make no thread. Part of libimukit-io. */
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
#include "imukit/info_log.h"
#include "imukit/job.h"
#include "imukit/navigate_log.h"
#include "imukit/physics_log.h"
#include "imukit/readable.h"
#include "imukit/record.h"
#include "imukit/record_plan.h"
#include "imukit/report.h"
#include "imukit/result.h"
#include "imukit/schematic.h"
#include "imukit/show.h"
#include "imukit/simulate_log.h"
#include "imukit/spectrum_log.h"
#include "imukit/tune_model.h"

#endif
