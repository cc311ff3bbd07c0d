/* SPDX-License-Identifier: Apache-2.0 */
/* Parameter files of other programs: the part of `convert` that turns them into models and back. */
#ifndef IMUKIT_CONVERT_PARAMETERS_H
#define IMUKIT_CONVERT_PARAMETERS_H

#include "shell/show.h"

#include "imukit/parameter_file.h"

/* The choice of --to that is a format of logs; it stands behind the others. */
enum { CONVERT_TO_EUROC = IMK_PARAMETERS_FUSION + 1 };

typedef struct parameter_options {
    int from, to; /* imk_parameter_format; 0: not given; or CONVERT_TO_EUROC */
    int density;  /* imk_density; 0: not given */
    const char *sensor;
    bool json;
    int flicker;                             /* imk_filter_flicker */
    double tau_from, tau_to;                 /* [s]; 0: not given */
    double bias_instability_tau, frame_rate; /* [s], [Hz]; 0: not given */
    bool use_bounds;
} parameter_options;

enum { PARAMETER_OPTIONS = 11 };
extern const option parameter_option_table[PARAMETER_OPTIONS];

/* Is this a conversion of parameters: by the options, or by what the file holds?
 * @param model_due  a log cannot become what is written, so that any file is looked into
 * @return -1 or the exit code, the message printed */
int parameters_wanted(const parameter_options *options, const char *in, bool model_due,
                      bool *wanted);

/* @param rate  [Hz], 0: not given. @return the exit code, messages printed */
int convert_parameters(const parameter_options *options, double rate, const char *in,
                       const char *out);

/* A file that was read or written, with its format. */
void convert_show_file(const char *file, const char *format, imk_result *result);
/* Tell what was converted, and finish. @param notes  those of reading and of writing; NULL: none
 * @return the exit code */
int convert_show(const parameter_options *options, imk_parameter_format from, const char *in,
                 const char *out, const imk_parameter_notes *notes);

#endif
