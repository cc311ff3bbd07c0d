/* SPDX-License-Identifier: Apache-2.0 */
/* What `imukit simulate` is made of: its options, the scene (motion and temperature), and the
 * writing of runs and truth. */
#ifndef IMUKIT_SIMULATE_PARTS_H
#define IMUKIT_SIMULATE_PARTS_H

#include "shell/show.h"
#include "shell/term_selection.h"

#include "imukit/motion_file.h"
#include "imukit/simulate_log.h"

typedef struct simulate_options {
    double rate, duration, latitude, height, roll, pitch, yaw;
    option_integer seed, run, runs, decimals, threads, substeps;
    bool no_earth, increments, json;
    const char *output, *format;
    imk_unit gyro_unit, accel_unit; /* scale 0: not given */
    const char *motion, *temperature, *truth, *field;
    const char *aid, *aid_output, *aid_lever_arm;
    double aid_rate, aid_until; /* NaN: not given */
    term_selection terms;
} simulate_options;

/* ---- simulate_scene.c ---- */

/* What the options say of motion, temperature and length. */
typedef struct scene {
    imk_motion_file *motion;
    imk_temperature_file *temperature;
    imk_simulate_log_settings settings;
    imk_result *result; /* what was written */
} scene;

/* @return -1 or the exit code, the message printed; scene_free() either way */
int scene_open(const simulate_options *o, const imk_model *model, scene *s);
void scene_free(scene *s);

/* ---- simulate_run.c ---- */

/* The truth, and one run or many, each into its file. @param name  of the model
 * @return the exit code, the message printed */
int simulate_logs(const simulate_options *o, const imk_model *model, const char *name, scene *s);

#endif
