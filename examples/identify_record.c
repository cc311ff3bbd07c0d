/* SPDX-License-Identifier: Apache-2.0 */
/* From a record to its noise terms, without any file: this part of the library needs libm only.
 *
 * The record here is made: half an hour at 100 Hz of white noise N and a random walk K. The program
 * fails when the intervals found are absurd, so it serves as a test as well. */
#include "imukit/imukit.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { SAMPLES = 180000 };

static const double interval = 0.01;         /* [s] */
static const double white_density = 1e-4;    /* N [rad/s/sqrt(Hz)] */
static const double random_walk_step = 2e-5; /* K [rad/s/sqrt(s)] */

static const char *const term_name[IMK_NOISE_TERMS] = {"quantization", "white noise",
                                                       "bias instability", "random walk", "ramp"};

static int make_record(double *sample)
{
    imk_random random = imk_random_seeded(1);
    imk_white_state white;
    imk_random_walk_state walk;
    if (imk_white_start(&white, white_density, interval, random,
                        imk_stream(0, IMK_TERM_WHITE, 0, 0)) != IMK_OK ||
        imk_random_walk_start(&walk, random_walk_step, interval, random,
                              imk_stream(0, IMK_TERM_RANDOM_WALK, 0, 0)) != IMK_OK)
        return -1;
    imk_white_add(&white, SAMPLES, sample);
    imk_random_walk_add(&walk, SAMPLES, sample);
    return 0;
}

int main(void)
{
    imk_identify_settings settings = imk_identify_default();
    settings.dt = interval;
    const size_t size = imk_identify_workspace_size(SAMPLES);
    double *sample = calloc(SAMPLES, sizeof *sample);
    void *workspace = malloc(size);
    imk_identification found;
    imk_status status = IMK_ERROR_MEMORY;
    if (sample && workspace && make_record(sample) == 0)
        status = imk_identify_channel(&settings, SAMPLES, sample, &found, workspace, size, NULL);
    free(workspace);
    free(sample);
    if (status != IMK_OK) {
        fprintf(stderr, "%s\n", imk_status_text(status));
        return EXIT_FAILURE;
    }
    for (int term = 0; term < IMK_NOISE_TERMS; term++) {
        const imk_estimate *estimate = &found.term[term];
        if (estimate->present)
            printf("%-17s %.4g +- %.2g, 95 %% in %.4g ... %.4g\n", term_name[term], estimate->value,
                   estimate->sigma, estimate->lower, estimate->upper);
        else
            printf("%-17s absent, below %.4g\n", term_name[term], estimate->upper);
    }
    /* White noise is known to 1/sqrt(2 n) = 0.17 %; 1 % is six standard deviations. */
    double error_ratio = found.term[IMK_NOISE_WHITE].value / white_density - 1;
    return fabs(error_ratio) < 0.01 ? EXIT_SUCCESS : EXIT_FAILURE;
}
