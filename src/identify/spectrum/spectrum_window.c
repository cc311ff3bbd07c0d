/* SPDX-License-Identifier: Apache-2.0 */
/* The windows of Welch's estimator, and what they do to a spectrum.
 *
 * Periodic forms, w(t) with t = i/length: their transforms have zeros on the bins, so that the mean
 * of a segment touches only the lowest ones. */
#include "spectrum_internal.h"

#include "imukit/elementary.h"

#include <math.h>

static const double PI = 3.14159265358979323846;

/* Modified Bessel function I0 by its series, whose terms are all positive; 60 of them are enough
 * for arguments up to 40. */
static double bessel_i0(double x)
{
    double term = 1, sum = 1;
    const double quarter = 0.25 * x * x;
    for (int k = 1; k < 100 && term > 1e-17 * sum; k++) {
        term *= quarter / ((double)k * k);
        sum += term;
    }
    return sum;
}

static double window_value(const imk_spectrum_settings *settings, double t)
{
    switch (settings->window) {
    case IMK_WINDOW_HANN:
        return 0.5 - 0.5 * imk_cos(2 * PI * t);
    case IMK_WINDOW_BLACKMAN_HARRIS: /* four terms, -92 dB [HARRIS1978, table I] */
        return 0.35875 - 0.48829 * imk_cos(2 * PI * t) + 0.14128 * imk_cos(4 * PI * t) -
               0.01168 * imk_cos(6 * PI * t);
    case IMK_WINDOW_KAISER:
        return bessel_i0(settings->kaiser_beta * sqrt(fmax(0, 4 * t * (1 - t))));
    case IMK_WINDOW_RECTANGULAR:
    default:
        return 1;
    }
}

void imki_window_fill(const imk_spectrum_settings *settings, size_t length, double *window)
{
    double energy = 0;
    for (size_t i = 0; i < length; i++) {
        window[i] = window_value(settings, (double)i / (double)length);
        energy += window[i] * window[i];
    }
    for (size_t i = 0; i < length; i++)
        window[i] /= sqrt(energy);
}

/* Mean square over squared mean, by the midpoint rule, which is exact for the sums of cosines and
 * good to 1e-6 for Kaiser's. */
double imki_window_bandwidth(const imk_spectrum_settings *settings)
{
    enum { POINTS = 512 };
    double sum = 0, squares = 0;
    if (settings->method == IMK_SPECTRUM_MULTITAPER)
        return 2 * settings->time_bandwidth;
    for (int i = 0; i < POINTS; i++) {
        const double w = window_value(settings, (i + 0.5) / POINTS);
        sum += w;
        squares += w * w;
    }
    return POINTS * squares / (sum * sum);
}

double imki_window_lobe(const imk_spectrum_settings *settings)
{
    if (settings->method == IMK_SPECTRUM_MULTITAPER)
        return settings->time_bandwidth;
    switch (settings->window) {
    case IMK_WINDOW_HANN:
        return 2;
    case IMK_WINDOW_BLACKMAN_HARRIS:
        return 4;
    case IMK_WINDOW_KAISER: /* [HARRIS1978, (46)] */
        return sqrt(1 + settings->kaiser_beta * settings->kaiser_beta / (PI * PI));
    case IMK_WINDOW_RECTANGULAR:
    default:
        return 1;
    }
}

/* Integral of f^2 |W|^2 is that of the squared derivative over (2 pi)^2. A window that does not end
 * at zero has side lobes without a second moment: three bins then stand for their nearer part. The
 * tapers together are level over -W … W. */
double imki_window_blur(const imk_spectrum_settings *settings, size_t length, const double *window)
{
    double squares = 0;
    if (settings->method == IMK_SPECTRUM_MULTITAPER)
        return settings->time_bandwidth / sqrt(3.0);
    for (size_t i = 0; i < length; i++) {
        const double change = window[(i + 1) % length] - window[i];
        squares += change * change;
    }
    const double ends = 2 * (window[0] - window[length - 1]) * (window[0] - window[length - 1]);
    return fmin(3, sqrt(squares + ends) * (double)length / (2 * PI));
}
