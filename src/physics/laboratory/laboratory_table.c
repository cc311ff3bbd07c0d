/* SPDX-License-Identifier: Apache-2.0 */
/* Rate table (for an accelerometer: forces), rates across the input axis, and threshold.
 *
 *     output - input = b + s u + K2 u^2 + Koq u|u| + K3 u^3 + asymmetry |u|/2 */
#include "laboratory_internal.h"

#include "imukit/elementary.h"
#include "model/model_schema_internal.h"

#include <math.h>

enum { ZEROS = 8, TERMS_MAX = 2 + IMKI_POWERS_MAX, SCAN = 22, BISECTIONS = 6 };

void imki_zero_readings(const imk_laboratory *laboratory, char *states,
                        const imk_executor *executor, imk_laboratory_result *result)
{
    imki_trial trials[ZEROS];
    double scatter = 0.0;
    for (int i = 0; i < ZEROS; i++)
        trials[i] = imki_trial_of(laboratory, 0.0);
    imki_trials_run(laboratory, ZEROS, trials, states, executor);
    for (int i = 0; i < ZEROS; i++)
        result->zero += trials[i].reading.output / ZEROS;
    for (int i = 0; i < ZEROS; i++) {
        const double difference = trials[i].reading.output - result->zero;
        scatter += difference * difference / (ZEROS - 1);
    }
    result->zero_scatter = sqrt(scatter);
}

/* Largest distance of the outputs from their least-squares line. */
static double deviation_from_line(int count, const imk_laboratory_point *point)
{
    double a[2 * IMKI_FIT_ROWS], y[IMKI_FIT_ROWS], x[2], sigma[2], largest = 0.0;
    for (int i = 0; i < count; i++) {
        a[2 * i] = 1.0;
        a[2 * i + 1] = point[i].input;
        y[i] = point[i].output;
    }
    if (!imki_fit((size_t)count, 2, a, y, 0.0, x, sigma))
        return (double)NAN;
    for (int i = 0; i < count; i++) {
        const double distance = fabs(y[i] - x[0] - x[1] * point[i].input);
        largest = distance > largest ? distance : largest;
    }
    return largest;
}

static void store(imk_axes *axes, double value, double sigma)
{
    axes->value[0] = value;
    axes->sigma[0] = sigma;
}

/* Powers that a table looks for. */
static int sought_powers(const imki_power *power[IMKI_POWERS_MAX])
{
    int count = 0;
    for (size_t k = 0; k < imki_input_power_count; k++)
        if (imki_input_powers[k].sought)
            power[count++] = &imki_input_powers[k];
    return count;
}

static void fit_table(imk_triad *triad, imk_laboratory_result *result)
{
    double a[TERMS_MAX * IMKI_FIT_ROWS], y[IMKI_FIT_ROWS], x[TERMS_MAX], sigma[TERMS_MAX];
    const imki_power *power[IMKI_POWERS_MAX];
    const int powers = sought_powers(power), terms = 2 + powers;
    const double scale = result->full_scale;
    double noise = 0.0;
    for (int i = 0; i < result->point_count; i++) {
        const imk_laboratory_point *point = &result->point[i];
        const double u = point->input / scale;
        double *row = &a[i * terms];
        row[0] = 1.0;
        row[1] = u;
        for (int k = 0; k < powers; k++)
            row[2 + k] = imki_power_at(power[k], u);
        y[i] = point->output - point->input;
        noise += point->sigma * point->sigma;
    }
    noise = imki_reading_sigma(result, sqrt(noise / result->point_count));
    if (!imki_fit((size_t)result->point_count, (size_t)terms, a, y, noise, x, sigma))
        return;
    store(&triad->bias.fixed, x[0], sigma[0]);
    store(&triad->scale_factor.fixed, x[1] / scale, sigma[1] / scale);
    for (int k = 0; k < powers; k++) {
        double unit = scale;
        for (int n = 1; n < power[k]->p + power[k]->q; n++)
            unit *= scale;
        store((imk_axes *)(void *)((char *)triad + imki_terms[power[k]->term].offset),
              x[2 + k] / unit, sigma[2 + k] / unit);
    }
}

void imki_rate_table(const imk_laboratory *laboratory, char *states, const imk_executor *executor,
                     imk_laboratory_result *result)
{
    imki_trial trials[IMK_LABORATORY_POINTS_MAX];
    const int count = laboratory->points;
    for (int i = 0; i < count; i++)
        trials[i] = imki_trial_of(laboratory, result->full_scale * (2.0 * i / (count - 1) - 1.0));
    imki_trials_run(laboratory, (size_t)count, trials, states, executor);
    result->point_count = count;
    for (int i = 0; i < count; i++)
        result->point[i] = trials[i].reading;
    result->line_deviation = deviation_from_line(count, result->point) / result->full_scale;
    fit_table(imk_model_triad_to_set(&result->model, laboratory->instrument->sensor), result);
}

/* Plus and minus a quarter of full scale about y and about z: half of the difference. */
void imki_cross_rates(const imk_laboratory *laboratory, char *states, const imk_executor *executor,
                      imk_laboratory_result *result)
{
    imki_trial trials[4];
    imk_triad *triad = imk_model_triad_to_set(&result->model, laboratory->instrument->sensor);
    const double rate = 0.25 * result->full_scale;
    for (int i = 0; i < 4; i++) {
        trials[i] = imki_trial_of(laboratory, 0.0);
        trials[i].exposure.angular_rate[1 + i / 2] += i % 2 == 0 ? rate : -rate;
    }
    imki_trials_run(laboratory, 4, trials, states, executor);
    for (int k = 0; k < 2; k++) {
        const imk_laboratory_point *plus = &trials[2 * k].reading;
        const imk_laboratory_point *minus = &trials[2 * k + 1].reading;
        triad->cross_axis.value[0][1 + k] = (plus->output - minus->output) / (2.0 * rate);
        const double own = sqrt(0.5 * (plus->sigma * plus->sigma + minus->sigma * minus->sigma));
        triad->cross_axis.sigma[0][1 + k] = imki_reading_sigma(result, own) / (sqrt(2.0) * rate);
    }
}

/* ---- threshold ------------------------------------------------------------------------------- */

/* Is the change from the reading at zero half of the input or more? -1: noise hides it. */
static int responds(const imk_laboratory_result *result, const imk_laboratory_point *point)
{
    const double sigma = imki_reading_sigma(result, point->sigma);
    if (!(6.0 * sigma < point->input))
        return -1;
    return point->output - result->zero >= 0.5 * point->input;
}

/* Inputs fall from full scale by sqrt(10) each, over 10.5 decades; below the first that fails, or
 * that noise hides, nothing is asked. Between it and the last good one the limit is bisected. */
void imki_threshold(const imk_laboratory *laboratory, char *states, const imk_executor *executor,
                    imk_laboratory_result *result)
{
    imki_trial trials[SCAN];
    double input = result->full_scale, good = result->full_scale, bad = 0.0;
    for (int i = 0; i < SCAN; i++, input /= sqrt(10.0))
        trials[i] = imki_trial_of(laboratory, input);
    imki_trials_run(laboratory, SCAN, trials, states, executor);
    for (int i = 0; i < SCAN && bad <= 0.0; i++) {
        const int answer = responds(result, &trials[i].reading);
        if (answer < 0)
            break;
        if (answer == 0)
            bad = trials[i].input;
        else
            good = trials[i].input;
    }
    for (int i = 0; bad > 0.0 && i < BISECTIONS; i++) {
        imki_trial middle = imki_trial_of(laboratory, sqrt(good * bad));
        imki_trials_run(laboratory, 1, &middle, states, NULL);
        if (responds(result, &middle.reading) == 1)
            good = middle.input;
        else
            bad = middle.input;
    }
    result->threshold = bad > 0.0 ? good : 0.0;
    result->threshold_from = good;
    if (bad > 0.0)
        store(&imk_model_triad_to_set(&result->model, laboratory->instrument->sensor)->dead_band,
              sqrt(good * bad), good - bad);
}
