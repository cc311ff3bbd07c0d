/* SPDX-License-Identifier: Apache-2.0 */
/* The same without any file: a sensor is simulated into arrays, which are identified. Everything
 * here runs in a browser too.
 *
 * Ten minutes at 100 Hz of one gyro; the program fails when the noise that went in does not come
 * out, so it serves as a test as well. */
#include "imukit/jobs.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { RATE = 100, ROWS = 600 * RATE };

static const double white = 1e-4; /* [rad/s/sqrt(Hz)] */

static imk_status simulate(double *const *columns, imk_error *error)
{
    static imk_model model; /* large: keep it off the stack */
    imk_model_default(&model);
    model.accel.present = false;
    model.gyro.axis_count = 1;
    model.gyro.noise.white.value[0] = white;
    imk_simulate_log_settings settings = imk_simulate_log_default();
    settings.simulation.rate = RATE;
    settings.rows = ROWS;
    imk_array_sink arrays = {.column_count = 2, .capacity = ROWS, .data = columns};
    const imk_record_sink sink = imk_array_sink_of(&arrays);
    return imk_simulate_log_run(&model, &settings, &sink, "simulating", NULL, error);
}

static imk_status identify(double *const *columns, imk_identify_log **found, imk_error *error)
{
    static const char *const names[] = {"time", "gyro_x"};
    const double *const data[] = {columns[0], columns[1]};
    static imk_array_source arrays; /* as long as the source is used */
    imk_record_source source;
    const imk_identify_log_settings settings = imk_identify_log_default();
    *found = NULL;
    const imk_status status =
        imk_array_source_make(2, names, data, ROWS, RATE, &arrays, &source, error);
    return status == IMK_OK ? imk_identify_log_run(&source, &settings, NULL, found, error) : status;
}

int main(void)
{
    double *columns[] = {malloc(ROWS * sizeof(double)), malloc(ROWS * sizeof(double))};
    imk_identify_log *found = NULL;
    imk_error error = {.status = IMK_ERROR_MEMORY};
    int failed = EXIT_FAILURE;
    if (columns[0] && columns[1] && simulate(columns, &error) == IMK_OK &&
        identify(columns, &found, &error) == IMK_OK) {
        const imk_estimate *e = &found->result[0].term[IMK_NOISE_WHITE];
        printf("white noise %.4g, in 95 %% from %.4g to %.4g; it is %.4g [rad/s/sqrt(Hz)]\n",
               e->value, e->lower, e->upper, white);
        failed = fabs(e->value - white) < 5 * e->sigma ? 0 : EXIT_FAILURE;
    } else {
        fprintf(stderr, "%s: %s %s\n", error.field, imk_status_text(error.status), error.expected);
    }
    imk_identify_log_free(found);
    free(columns[0]);
    free(columns[1]);
    return failed;
}
