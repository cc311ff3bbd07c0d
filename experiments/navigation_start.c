/* SPDX-License-Identifier: Apache-2.0 */
/* Units at rest that align themselves and navigate on: where do they end, beside what the filter
 * predicts, and are the biases of the gyros what it says?
 *
 * usage: navigation_start [runs] [seed] [device]
 *
 * Each run is half an hour at rest at 45 deg of latitude, at 20 Hz, of a unit drawn from the model
 * (turn-on biases included), with 120 s of alignment: with a stop in every minute and without, with
 * a given heading and without. Prints, per case, quantiles of the horizontal error at the end, the
 * mean of its normalised square (2 degrees of freedom), the mean of that of the three gyro biases
 * at the end (3 degrees), how often updates were
 * refused, and which methods were chosen. Exits with 1 when an error is beyond 6 predicted sigmas.
 */
#include "imukit/io.h"
#include "imukit/navigate_log.h"
#include "imukit/simulate_log.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 7, RUNS_MAX = 2000 };

static const double degree = 0.017453292519943295, rate = 20.0, duration = 1800.0;
static const double latitude = 0.78539816339744831;

typedef struct kind {
    const char *device;
    const char *name;
    imk_stop_policy stops;
    bool heading;
    double align;
} kind;

typedef struct outcome {
    double error, predicted, square, bias_square;
    int method;
    bool failed, refused, no_update;
} outcome;

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static imk_status simulate(const imk_model *model, uint64_t seed, uint32_t number,
                           double *const *data)
{
    imk_simulate_log_settings simulation = imk_simulate_log_default();
    simulation.simulation.rate = rate;
    simulation.simulation.latitude = latitude;
    simulation.simulation.seed = seed;
    simulation.simulation.run = number;
    simulation.rows = (uint64_t)(rate * duration);
    simulation.gyro_unit = imk_unit_of("rad/s");
    imk_array_sink array = {.column_count = COLUMNS, .capacity = simulation.rows, .data = data};
    const imk_record_sink sink = imk_array_sink_of(&array);
    return imk_simulate_log_run(model, &simulation, &sink, "simulating", NULL, NULL);
}

/* What imukit compensate takes out, and navigation takes for taken out. */
static void take_known_out(imk_triad *triad)
{
    memset(triad->misalignment.value, 0, sizeof triad->misalignment.value);
    memset(triad->g_sensitivity.value, 0, sizeof triad->g_sensitivity.value);
    memset(&triad->g2_sensitivity, 0, sizeof triad->g2_sensitivity);
    memset(&triad->nonlinearity, 0, sizeof triad->nonlinearity);
}

/* The slow part of the gyros' errors over the last 20 s: the same log without its white noise, less
 * the Earth's rate. The filter has no flicker that is faster. */
static void true_bias(const imk_model *model, uint64_t seed, uint32_t number, double *const *data,
                      double bias[3])
{
    static imk_model quiet;
    const double earth[3] = {IMK_EARTH_RATE * cos(latitude), 0.0, -IMK_EARTH_RATE * sin(latitude)};
    quiet = *model;
    memset(&quiet.gyro.noise.white, 0, sizeof quiet.gyro.noise.white);
    memset(&quiet.gyro.resolution, 0, sizeof quiet.gyro.resolution);
    const size_t rows = (size_t)(rate * duration), last = (size_t)(20 * rate);
    (void)simulate(&quiet, seed, number, data);
    for (int i = 0; i < 3; i++) {
        double sum = 0.0;
        for (size_t k = rows - last; k < rows; k++)
            sum += data[1 + i][k];
        bias[i] = sum / (double)last - earth[i];
    }
}

static outcome run(const kind *what, const imk_model *model, uint64_t seed, uint32_t number,
                   double *const *data)
{
    static const char *const names[COLUMNS] = {"time [s]", "gyro_x",  "gyro_y", "gyro_z",
                                               "accel_x",  "accel_y", "accel_z"};
    outcome out = {.failed = true};
    imk_error error;
    imk_array_source memory;
    imk_record_source source;
    imk_navigate_log_settings settings = imk_navigate_log_default();
    settings.place.latitude = latitude;
    settings.align = what->align;
    settings.model = model;
    settings.model_name = what->device;
    settings.heading_given = what->heading;
    settings.attitude_sigma[2] = 1.0 * degree;
    settings.stops = what->stops;
    settings.stop_period = 60.0;
    settings.stop_length = 5.0;
    imk_navigate_log *n = NULL;
    if (simulate(model, seed, number, data) != IMK_OK ||
        imk_array_source_make(COLUMNS, names, (const double *const *)data,
                              (size_t)(rate * duration), 0.0, &memory, &source, &error) != IMK_OK ||
        imk_navigate_log_run(&source, &settings, NULL, &n, &error) != IMK_OK) {
        imk_navigate_log_free(n);
        return out;
    }
    const size_t last = n->track_rows - 1;
    const double north = n->track[IMK_TRACK_NORTH][last],
                 east = n->track[IMK_TRACK_NORTH + 1][last];
    const double(*p)[IMK_NAVIGATION_ERRORS] =
        (const double(*)[IMK_NAVIGATION_ERRORS])n->end.covariance;
    const double determinant = p[0][0] * p[1][1] - p[0][1] * p[1][0];
    double bias[3];
    true_bias(model, seed, number, data, bias);
    out.failed = false;
    out.error = hypot(north, east);
    out.predicted = sqrt(p[0][0] + p[1][1]);
    out.square = (north * north * p[1][1] - 2.0 * north * east * p[0][1] + east * east * p[0][0]) /
                 determinant;
    for (int i = 0; i < 3; i++) {
        const double off = (n->end.gyro_bias.v[i] - bias[i]) / n->end.gyro_bias_sigma.v[i];
        out.bias_square += off * off;
    }
    out.method = (int)n->method;
    out.refused = n->counts.refused > 0;
    out.no_update = what->stops && n->counts.accepted == 0;
    imk_navigate_log_free(n);
    return out;
}

static bool show(const kind *what, const outcome *out, size_t runs)
{
    static double error[RUNS_MAX], ratio[RUNS_MAX];
    double square = 0.0, bias = 0.0, predicted = 0.0;
    size_t count = 0, failed = 0, refused = 0, none = 0, methods[3] = {0};
    for (size_t i = 0; i < runs; i++) {
        failed += out[i].failed;
        if (out[i].failed)
            continue;
        error[count] = out[i].error;
        ratio[count++] = out[i].error / out[i].predicted;
        square += out[i].square;
        bias += out[i].bias_square;
        predicted += out[i].predicted * out[i].predicted;
        refused += out[i].refused;
        none += out[i].no_update;
        methods[out[i].method]++;
    }
    qsort(error, count, sizeof *error, compare);
    qsort(ratio, count, sizeof *ratio, compare);
    const double n = count > 0 ? (double)count : 1.0;
    printf("%-10s %-24s error %8.3g %8.3g %8.3g m (50, 95, 100 %%), predicted %8.3g m rms, error/"
           "predicted at most %.2f; NEES %.2f of 2, biases %.2f of 3; updates refused in %zu, none "
           "in %zu; means %zu, inertial %zu; failed %zu\n",
           what->device, what->name, error[count / 2], error[(size_t)(0.95 * n)],
           error[count > 0 ? count - 1 : 0], sqrt(predicted / n), ratio[count > 0 ? count - 1 : 0],
           square / n, bias / n, refused, none, methods[0], methods[1], failed);
    fflush(stdout);
    return failed == 0 && count > 0 && ratio[count - 1] < 6.0;
}

int main(int argc, char **argv)
{
    const imk_stop_policy NONE = IMK_STOPS_NONE, TIMES = IMK_STOPS_TIMETABLE,
                          FOUND = IMK_STOPS_FOUND;
    const kind kinds[] = {{"AHRS", "stops", TIMES, false, 120},
                          {"AHRS", "stops found", FOUND, false, 300},
                          {"AHRS", "free", NONE, false, 120},
                          {"AHRS", "stops, heading given", TIMES, true, 120},
                          {"AHRS", "free, heading given", NONE, true, 120},
                          {"ADIS16488", "stops", TIMES, false, 120},
                          {"ADIS16488", "stops found", FOUND, false, 300},
                          {"ADIS16488", "free", NONE, false, 120},
                          {"ADIS16488", "stops, heading given", TIMES, true, 120},
                          {"ADIS16488", "free, heading given", NONE, true, 120},
                          {"tactical", "stops", TIMES, false, 120},
                          {"tactical", "free", NONE, false, 120},
                          {"tactical", "free, heading given", NONE, true, 120}};
    static outcome out[RUNS_MAX];
    const size_t asked = argc > 1 ? strtoul(argv[1], NULL, 10) : 200;
    const size_t runs = asked < RUNS_MAX ? asked : RUNS_MAX;
    const uint64_t seed = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    double *data[COLUMNS];
    for (int i = 0; i < COLUMNS; i++)
        data[i] = malloc((size_t)(rate * duration) * sizeof(double));
    bool good = true;
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        static imk_model model;
        if (argc > 3 && strcmp(argv[3], kinds[k].device) != 0)
            continue;
        imk_device_model(imk_device_find(kinds[k].device), &model);
        take_known_out(&model.gyro);
        take_known_out(&model.accel);
        for (size_t i = 0; i < runs; i++)
            out[i] = run(&kinds[k], &model, seed, (uint32_t)i, data);
        good = show(&kinds[k], out, runs) && good;
    }
    for (int i = 0; i < COLUMNS; i++)
        free(data[i]);
    return good ? 0 : 1;
}
