/* SPDX-License-Identifier: Apache-2.0 */
/* Power cycles, rate table (for an accelerometer: forces), rates across the input axis.
 *
 *     output - input = b + s u + K2 u^2 + Koq u|u| + K3 u^3 + asymmetry |u|/2
 *
 * and terms u^4, u^5, which are not told but would else be in the others. */
#include "laboratory_internal.h"

#include "model/model_schema_internal.h"

#include <math.h>

enum { POINTS_OF_HIGH_ORDERS = 13 };

/* In which the noise of a reading is as large as what differs from run to run, if time allows for a
 * few hundred such cycles. */
static double own_dwell(const imki_bench *bench)
{
    const double shortest = 0.25 * bench->laboratory->dwell, cycles = 600.0;
    const double noise = bench->white / bench->bias, wanted = noise * noise;
    return wanted > shortest && wanted * cycles < bench->longest[1] ? wanted : shortest;
}

/* Bias and scale factor by themselves, as they need many cycles and few points. */
void imki_power_cycles(imki_bench *bench)
{
    imk_triad *t = bench->triad;
    imk_laboratory_result *result = bench->result;
    imki_experiment *e = imki_experiment_begin(bench, "power cycles");
    e->rows = 1;
    e->ramps = false;
    e->quick = e->repeats = true;
    e->dwell = own_dwell(bench);
    e->trial[0] = imki_trial_of(bench->laboratory, 0.0);
    e->a[0] = 1.0;
    imki_experiment_column(e, "bias.fixed", 1.0, &t->bias.fixed.value[0], &t->bias.fixed.sigma[0]);
    imki_experiment_run(bench);
    result->zero = e->mean[0];
    result->zero_scatter = e->spread[0] * sqrt((double)e->cycles);
}

/* From plus and minus a quarter of full scale, where higher orders are small; what the table found
 * of them is taken out, or what the closed forms state where it did not tell. */
static void scale_factor(imki_bench *bench)
{
    imk_triad *t = bench->triad;
    const double u = 0.25 * bench->result->full_scale;
    double bent = t->nonlinearity.k3.value[0] * u * u + t->nonlinearity.koq.value[0] * u;
    double bent_sigma =
        hypot(t->nonlinearity.k3.sigma[0] * u * u, t->nonlinearity.koq.sigma[0] * u);
    const double matters = bench->result->matters[imki_figure_of(bench, "scale_factor.fixed")];
    if (bent_sigma > fmax(IMKI_WANTED * matters, 0.1 * fabs(bent))) {
        bent = bench->computed[imki_figure_of(bench, "nonlinearity.k3")].value * u * u +
               bench->computed[imki_figure_of(bench, "nonlinearity.koq")].value * u;
        bent_sigma = 0.0;
    }
    imki_experiment *e = imki_experiment_begin(bench, "scale factor");
    e->rows = 2;
    e->quick = e->repeats = true;
    for (size_t i = 0; i < 2; i++) {
        const double input = i == 0 ? -u : u;
        e->trial[i] = imki_trial_of(bench->laboratory, input);
        e->offset[i] = input + bent * input;
        e->a[2 * i] = 1.0;
        e->a[2 * i + 1] = input / u;
    }
    imki_experiment_column(e, NULL, 1.0, NULL, NULL);
    imki_experiment_column(e, "scale_factor.fixed", u, &t->scale_factor.fixed.value[0],
                           &t->scale_factor.fixed.sigma[0]);
    imki_experiment_run(bench);
    t->scale_factor.fixed.sigma[0] = hypot(t->scale_factor.fixed.sigma[0], bent_sigma);
}

/* Largest distance of the mean readings from their least-squares line. */
static double deviation_from_line(const imki_experiment *e)
{
    double a[2 * IMKI_TRIALS], x[2], sigma[2], largest = 0.0;
    for (size_t i = 0; i < e->rows; i++) {
        a[2 * i] = 1.0;
        a[2 * i + 1] = e->trial[i].input;
    }
    if (!imki_fit(e->rows, 2, a, e->mean, x, sigma))
        return (double)NAN;
    for (size_t i = 0; i < e->rows; i++)
        largest = fmax(largest, fabs(e->mean[i] - x[0] - x[1] * e->trial[i].input));
    return largest;
}

static void table_columns(imki_bench *bench, imki_experiment *e)
{
    const double scale = bench->result->full_scale;
    imki_experiment_column(e, NULL, 1.0, NULL, NULL);
    imki_experiment_column(e, NULL, 1.0, NULL, NULL);
    for (size_t k = 0; k < imki_input_power_count; k++) {
        const imki_power *power = &imki_input_powers[k];
        const imki_field *field = imki_term_field(power->term);
        double unit = scale;
        if (!power->sought)
            continue;
        for (int n = 1; n < power->p + power->q; n++)
            unit *= scale;
        imk_axes *axes =
            (imk_axes *)(void *)((char *)bench->triad + imki_terms[power->term].offset);
        imki_experiment_column(e, field->path[bench->laboratory->instrument->sensor], unit,
                               &axes->value[0], &axes->sigma[0]);
    }
    if (e->rows >= POINTS_OF_HIGH_ORDERS) {
        imki_experiment_column(e, NULL, 1.0, NULL, NULL);
        imki_experiment_column(e, NULL, 1.0, NULL, NULL);
    }
}

static void table_row(imki_experiment *e, size_t i, double u)
{
    double *row = &e->a[i * e->columns], power = u * u * u * u;
    size_t n = 0;
    row[n++] = 1.0;
    row[n++] = u;
    for (size_t k = 0; k < imki_input_power_count; k++)
        if (imki_input_powers[k].sought)
            row[n++] = imki_power_at(&imki_input_powers[k], u);
    for (; n < e->columns; power *= u)
        row[n++] = power;
}

static void keep_points(imki_bench *bench)
{
    const imki_experiment *e = &bench->experiment;
    imk_laboratory_result *result = bench->result;
    const double scale = bench->computed[imki_figure_of(bench, "scale_factor.fixed")].value;
    result->point_count = (int)e->rows;
    for (size_t i = 0; i < e->rows; i++) {
        const double input = e->trial[i].input;
        result->point[i] = (imk_laboratory_point){
            input,         e->mean[i],
            e->spread[i],  e->change[i] - input,
            e->scatter[i], imki_experiment_computed(bench, i) - input + scale * input};
    }
    result->line_deviation = deviation_from_line(e) / result->full_scale;
}

void imki_rate_table(imki_bench *bench)
{
    imki_experiment *e = imki_experiment_begin(bench, "rate table");
    e->rows = (size_t)bench->laboratory->points;
    e->rest = e->rows / 2;
    e->limit = "higher orders of the input";
    table_columns(bench, e);
    for (size_t i = 0; i < e->rows; i++) {
        const double u = 2.0 * (double)i / (double)(e->rows - 1) - 1.0;
        e->trial[i] = imki_trial_of(bench->laboratory, u * bench->result->full_scale);
        e->offset[i] = e->trial[i].input;
        table_row(e, i, u);
    }
    imki_experiment_run(bench);
    if (e->cycles > 0)
        keep_points(bench);
    scale_factor(bench);
}

/* Plus and minus a quarter of full scale about y and about z. */
void imki_cross_rates(imki_bench *bench)
{
    static const char *const keys[] = {"misalignment.y", "misalignment.z"};
    const double rate = 0.25 * bench->result->full_scale;
    imki_experiment *e = imki_experiment_begin(bench, "rates across the axis");
    e->rows = 5;
    e->rest = 4;
    e->limit = "even orders of the rate";
    imki_experiment_column(e, NULL, 1.0, NULL, NULL);
    for (int k = 0; k < 2; k++)
        imki_experiment_column(e, keys[k], rate, &bench->triad->cross_axis.value[0][1 + k],
                               &bench->triad->cross_axis.sigma[0][1 + k]);
    for (size_t i = 0; i < 5; i++) {
        const double sign = i % 2 == 0 ? 1.0 : -1.0;
        e->trial[i] = imki_trial_of(bench->laboratory, 0.0);
        e->a[3 * i] = 1.0;
        if (i == e->rest)
            continue;
        e->trial[i].exposure.angular_rate[1 + i / 2] += sign * rate;
        e->a[3 * i + 1 + i / 2] = sign;
    }
    imki_experiment_run(bench);
}
