/* SPDX-License-Identifier: Apache-2.0 */
/* Lines of random vibration. Between corners the density is a power of frequency, S = S1
 * (f/f1)^m, so that with k = m + 1 and L = log(f/f1)
 *
 *     power from f1 to f  =  S1 f1 (e^{k L} - 1)/k            (S1 f1 L for k = 0)
 *
 * Equal parts of the whole power each become one line, at the frequency below which a random
 * fraction of the part lies; a line of amplitude a has the power a^2/2. */
#include "imukit/motion.h"

#include "base/refuse_internal.h"
#include "imukit/elementary.h"

#include <math.h>

#define TWO_PI 6.283185307179586

/* (e^x - 1)/x */
static double growth(double x)
{
    return x == 0.0 ? 1.0 : imk_expm1(x) / x;
}

/* log(1 + x)/x: the error of 1 + x cancels in the quotient [GOLDBERG1991, theorem 4]. */
static double decay(double x)
{
    const double sum = 1.0 + x;
    return sum == 1.0 ? 1.0 : imk_ln(sum) / (sum - 1.0);
}

typedef struct density_segment {
    double first;    /* f1 */
    double scale;    /* S1 f1 */
    double exponent; /* k */
    double power;    /* of the whole segment */
} density_segment;

static density_segment segment_between(const double *frequency, const double *density)
{
    const double span = imk_ln(frequency[1] / frequency[0]);
    const double exponent = imk_ln(density[1] / density[0]) / span + 1.0;
    const double scale = density[0] * frequency[0];
    return (density_segment){frequency[0], scale, exponent, scale * span * growth(exponent * span)};
}

/* The frequency up to which the segment holds `power`: L = log(1 + k power/scale)/k. */
static double frequency_below(const density_segment *segment, double power)
{
    const double x = power / segment->scale;
    return segment->first * imk_exp(x * decay(segment->exponent * x));
}

/* Uniform in (0, 1), from two words. */
static double uniform(const uint32_t word[2])
{
    const uint64_t bits = (uint64_t)word[0] << 32 | word[1];
    return ((double)(bits >> 12) + 0.5) * 0x1p-52;
}

static imk_status refuse(imk_error *error, imk_status status, const char *field, size_t index,
                         double value, const char *expected)
{
    return imki_refuse_at(error, status, field, index, value, 0.0, expected);
}

static imk_status check_density(int axis, size_t corners, const double *frequency,
                                const double *density, size_t line_count, imk_error *error)
{
    if (axis < 0 || axis > 2)
        return refuse(error, IMK_ERROR_RANGE, "axis", 0, axis, "an axis from 0 to 2");
    if (corners < 2)
        return refuse(error, IMK_ERROR_TOO_SHORT, "density", 0, (double)corners,
                      "at least two corners");
    if (line_count < 8 || line_count > IMK_VIBRATION_LINES_MAX)
        return refuse(error, IMK_ERROR_RANGE, "line_count", 0, (double)line_count,
                      "8 to 512 lines");
    for (size_t i = 0; i < corners; i++) {
        if (!isfinite(frequency[i]) || !isfinite(density[i]))
            return refuse(error, IMK_ERROR_NOT_FINITE, "density", i, density[i],
                          "a finite frequency and a finite density");
        if (!(density[i] >= 1e-100 && density[i] <= 1e100))
            return refuse(error, IMK_ERROR_RANGE, "density", i, density[i],
                          "a positive density, up to 1e100 (m/s^2)^2/Hz");
        if (!((i == 0 || frequency[i] > frequency[i - 1]) &&
              frequency[i] >= IMK_VIBRATION_FREQUENCY_MIN &&
              frequency[i] <= IMK_VIBRATION_FREQUENCY_MAX))
            return refuse(error, IMK_ERROR_RANGE, "frequency", i, frequency[i],
                          "use increasing frequencies from 1e-6 Hz to 1e9 Hz");
    }
    return IMK_OK;
}

imk_status imk_vibration_from_density(int axis, size_t corners, const double *frequency,
                                      const double *density, imk_random random, uint64_t stream,
                                      size_t line_count, imk_vibration_line *line, imk_error *error)
{
    const imk_status status = check_density(axis, corners, frequency, density, line_count, error);
    if (status)
        return status;
    double total = 0.0;
    for (size_t i = 0; i + 1 < corners; i++)
        total += segment_between(frequency + i, density + i).power;
    const double part = total / (double)line_count;
    const double amplitude = sqrt(2.0 * part);
    size_t corner = 0;
    double below = 0.0; /* power below the segment */
    density_segment now = segment_between(frequency, density);
    for (size_t i = 0; i < line_count; i++) {
        uint32_t word[4];
        imk_random_words(random, stream, 4 * i, 4, word);
        const double power = ((double)i + uniform(word)) * part;
        while (power - below > now.power && corner + 2 < corners) {
            below += now.power;
            corner++;
            now = segment_between(frequency + corner, density + corner);
        }
        const double f =
            fmin(frequency_below(&now, fmax(power - below, 0.0)), frequency[corner + 1]);
        const double rate = TWO_PI * f;
        line[i] = (imk_vibration_line){axis, amplitude / (rate * rate), f, uniform(word + 2)};
    }
    return IMK_OK;
}
