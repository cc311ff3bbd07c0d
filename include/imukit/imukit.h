/* SPDX-License-Identifier: Apache-2.0 */
/** @file imukit.h
 *  Everything of libimukit. Reading and writing files: imukit/io.h. */
#ifndef IMUKIT_IMUKIT_H
#define IMUKIT_IMUKIT_H

#include "imukit/allan.h"
#include "imukit/attitude.h"
#include "imukit/compensate.h"
#include "imukit/correct.h"
#include "imukit/decimal.h"
#include "imukit/distort.h"
#include "imukit/distributions.h"
#include "imukit/earth.h"
#include "imukit/elementary.h"
#include "imukit/executor.h"
#include "imukit/fourier.h"
#include "imukit/identify.h"
#include "imukit/instrument.h"
#include "imukit/laboratory.h"
#include "imukit/least_squares.h"
#include "imukit/linear_algebra.h"
#include "imukit/model.h"
#include "imukit/motion.h"
#include "imukit/motion_script.h"
#include "imukit/names.h"
#include "imukit/navigate.h"
#include "imukit/noise.h"
#include "imukit/pendulous_servo.h"
#include "imukit/random.h"
#include "imukit/ring_laser.h"
#include "imukit/simulate.h"
#include "imukit/status.h"
#include "imukit/units.h"

#endif
