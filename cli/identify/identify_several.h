/* SPDX-License-Identifier: Apache-2.0 */
/* imukit identify of several logs: runs of one sensor make one joint model, different sensors a
 * population. */
#ifndef IMUKIT_IDENTIFY_SEVERAL_H
#define IMUKIT_IDENTIFY_SEVERAL_H

#include "identify_parts.h"

#include "imukit/repeatability.h"

/* A strength of one log, and whether it is there; sigma of its square too, which is known where the
 * term is absent as well. */
typedef struct strength {
    bool present;
    double value, sigma, bound;
    double square, square_sigma;
} strength;

/* One term of one channel over all devices. */
typedef struct device_term {
    bool compared;                             /* some device shows it, and all state its square */
    imk_population squares;                    /* of the squares */
    double mean, lower, upper;                 /* roots of the mean square and of its interval */
    double spread, spread_lower, spread_upper; /* of the value, to first order */
    strength device[IMK_JOINT_RECORDS_MAX];
} device_term;

typedef struct several_logs {
    const identify_options *options;
    size_t count;
    identification *log[IMK_JOINT_RECORDS_MAX];
    const char *label[IMK_JOINT_RECORDS_MAX];
    identification *joint;          /* of runs: the joint estimate; of devices: holds the verdict */
    char path[400];                 /* of joint: the labels of all */
    imk_joint_agreement *agreement; /* of each channel: runs */
    imk_repeatability bias[IMK_LOG_COLUMNS_MAX]; /* of each channel: runs */
    device_term (*term)[IMK_NOISE_TERMS];        /* of each channel: devices */
} several_logs;

/* identify_several.c: load, identify, compare and show. @return the exit code */
int identify_several(const identify_options *options, size_t count, const char *const *paths,
                     const imk_identify_log_settings *settings, const imk_model *truth,
                     const imk_executor *executor);

/* identify_runs.c. @return -1 or the exit code */
int several_join_runs(several_logs *s);
/* identify_devices.c. @return -1 or the exit code */
int several_compare_devices(several_logs *s);

/* identify_several_output.c */
/* "0.03", "below 1e-12" */
void several_chance(double probability, char *text, size_t size);
/* Each log's strengths on a channel, and what they are together. */
text_table several_table(const several_logs *s, size_t channel);
/* Means from run to run. */
text_table several_bias_table(const several_logs *s);
void several_print(const several_logs *s);
int several_report(const several_logs *s, const char *path);
int several_json(const several_logs *s, int code);

#endif
