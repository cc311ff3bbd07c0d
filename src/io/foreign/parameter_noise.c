/* SPDX-License-Identifier: Apache-2.0 */
/* Noise that several foreign parameter files have: Gauss-Markov processes, and the four numbers of
 * an estimator. */
#include "parameter_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void imki_add_gauss_markov(imk_triad *triad, const double sigma[3], const double time[3])
{
    struct imk_gauss_markov_term term = {.sigma = {{0}, {0}}};
    if (!imki_any(sigma))
        return;
    memcpy(term.sigma.value, sigma, 3 * sizeof sigma[0]);
    for (int i = 0; i < 3; i++)
        term.correlation_time.value[i] = sigma[i] == 0 ? 0 : time[i];
    triad->noise.gauss_markov[triad->noise.gauss_markov_count++] = term;
}

void imki_first_gauss_markov(const imk_triad *triad, double sigma[3], double time[3])
{
    const struct imk_gauss_markov_term *term = &triad->noise.gauss_markov[0];
    for (int i = 0; i < 3; i++) {
        sigma[i] = triad->noise.gauss_markov_count > 0 ? term->sigma.value[i] : 0;
        time[i] = triad->noise.gauss_markov_count > 0 ? term->correlation_time.value[i] : 0;
    }
}

void imki_white_where_infinite(imki_parameters *p, imki_place place, imk_triad *triad, double rate,
                               const char *program, double sigma[3], double time[3])
{
    for (int i = 0; i < 3; i++) {
        if (sigma[i] != 0 && time[i] == 0)
            imki_parameter_refuse_at(p, place, IMK_ERROR_RANGE, "0",
                                     "a positive correlation time [s]");
        if (sigma[i] == 0 || !isinf(time[i]))
            continue;
        if (!(rate > 0)) {
            imki_parameter_refuse_at(
                p, place, IMK_ERROR_KEY_MISSING,
                "\"inf\" is white noise per sample, and the sampling rate is not known",
                "add --rate 100Hz (samples per second)");
            return;
        }
        double n = triad->noise.white.value[i];
        triad->noise.white.value[i] = sqrt(n * n + sigma[i] * sigma[i] / rate);
        sigma[i] = time[i] = 0;
        imki_note(p, false,
                  "%s: with an infinite correlation time %s draws a new drift for each sample: the "
                  "drift is taken as white noise",
                  place.field, program);
    }
}

double imki_largest(imki_parameters *p, const char *name, const imk_axes *axes)
{
    double largest = fmax(axes->value[0], fmax(axes->value[1], axes->value[2]));
    double smallest = fmin(axes->value[0], fmin(axes->value[1], axes->value[2]));
    if (smallest != largest)
        imki_note(p, true, "%s is one number for all axes: the largest of the three is written",
                  name);
    return largest;
}

void imki_densities_read(imki_parameters *p, int mapping, const char *const keys[IMKI_DENSITIES],
                         const imki_unit units[IMKI_DENSITIES])
{
    for (int i = 0; i < IMKI_DENSITIES; i++) {
        imk_noise *noise = &p->triad[i / 2]->noise;
        const bool white = i % 2 == 0;
        imki_node_accept(p, mapping, keys[i], i / 2, white ? IMKI_WHITE : IMKI_RANDOM_WALK,
                         units[i], white ? noise->white.value : noise->random_walk.value);
    }
}

double imki_density(imki_parameters *p, int index, const char *key)
{
    const imk_noise *noise = &p->origin[index / 2]->noise;
    return imki_largest(p, key, index % 2 == 0 ? &noise->white : &noise->random_walk);
}

void imki_densities_read_some(imki_parameters *p, int mapping,
                              const char *const keys[IMKI_DENSITIES],
                              const imki_unit units[IMKI_DENSITIES])
{
    for (int i = 0; i < IMKI_DENSITIES; i++)
        if (imki_node_value(p, mapping, keys[i]) == IMKI_NONE)
            imki_note(p, true,
                      "%s is not in the file: the program then takes its default, the "
                      "model has none",
                      keys[i]);
    imki_densities_read(p, mapping, keys, units);
}

void imki_square_roots(imki_parameters *p, imki_place place, int count, double *values)
{
    for (int i = 0; i < count; i++) {
        char found[25]; /* six digits, a sign and an exponent */
        imk_decimal_significant(values[i], 6, found);
        if (!(values[i] >= 0 && isfinite(values[i])))
            imki_parameter_refuse_at(p, place, IMK_ERROR_RANGE, found,
                                     "a variance: a finite number that is not negative");
        else
            values[i] = sqrt(values[i]);
    }
}

const char *imki_axis_taken(const imki_parameters *p, int index)
{
    static const char *const taken[] = {", axis x (the largest)", ", axis y (the largest)",
                                        ", axis z (the largest)"};
    const imk_noise *noise = &p->origin[index / 2]->noise;
    const double *value = index % 2 == 0 ? noise->white.value : noise->random_walk.value;
    const int largest = value[0] >= value[1] && value[0] >= value[2] ? 0
                        : value[1] >= value[2]                       ? 1
                                                                     : 2;
    return value[0] == value[1] && value[1] == value[2] ? "" : taken[largest];
}

/* OpenCV tells a real number from an integer by its point. */
static imki_decimal with_point(imki_decimal number)
{
    imki_decimal pointed = number;
    const size_t digits = strcspn(number.text, ".e");
    if (number.text[digits] != '.')
        snprintf(pointed.text, sizeof pointed.text, "%.*s.0%s", (int)digits, number.text,
                 number.text + digits);
    return pointed;
}

void imki_densities_write(imki_parameters *p, const imki_density_lines *lines)
{
    for (int i = 0; i < IMKI_DENSITIES; i++) {
        if (!p->origin[i / 2]->present) {
            if (lines->both_needed)
                imki_note(p, true, "%s is not written, because the model has no %s: add it",
                          lines->keys[i], i < 2 ? "gyros" : "accelerometers");
            continue;
        }
        const double value = imki_density(p, i, lines->keys[i]) / lines->scale;
        const imki_decimal number = imki_shortest(lines->squared ? value * value : value);
        imki_text_add(&p->out, "%s%s: %s  # %s%s\n", lines->indent, lines->keys[i],
                      lines->with_point ? with_point(number).text : number.text, lines->units[i],
                      imki_axis_taken(p, i));
    }
}
