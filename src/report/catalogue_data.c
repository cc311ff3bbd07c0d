/* SPDX-License-Identifier: Apache-2.0 */
/* Allan deviations of the sensors of the catalogue as JSON, for pages that lay them over others:
 * four averaging times to a decade, between which the lines of a logarithmic plot are straight
 * enough. They follow from the noise of each model, on its worst axis; what rounded readings
 * add is left out, because it depends on their rate. */
#include "markup_internal.h"
#include "page_internal.h"

#include "imukit/decimal.h"
#include "imukit/model.h"
#include "noise/noise_terms_internal.h"

#include <math.h>

/* From 1 ms, which is the interval of the samples, to 100,000 s. */
enum { TIMES_PER_DECADE = 4, TIMES = 8 * TIMES_PER_DECADE + 1, DIGITS = 4 };
static const double interval = 1e-3;

static double time_of(int index)
{
    return interval * pow(10, (double)index / TIMES_PER_DECADE);
}

static double variance_of(const imk_triad *triad, int axis, double time)
{
    const double q = triad->noise.quantization.value[axis];
    double sum = imk_quantization_allan_variance(q, time) +
                 imk_ramp_allan_variance(triad->noise.ramp.value[axis], time);
    for (int t = 0; t < IMKI_NOISE_TERMS; t++) {
        const imki_noise_term *term = imki_noise_terms[t];
        const int count = imki_term_count(term, &triad->noise);
        imki_term_place place = {triad, axis, 0};
        for (; place.instance < count; place.instance++)
            if (term->strength(place) != 0.0)
                sum += term->mean_variance(place, interval, time);
    }
    return sum;
}

double imki_noise_deviation(const imk_triad *triad, double time)
{
    double most = 0;
    for (int axis = 0; axis < triad->axis_count; axis++)
        most = fmax(most, variance_of(triad, axis, time));
    return sqrt(most);
}

static void put_number(imki_text *out, int index, double value)
{
    char number[IMK_DECIMAL_SIZE];
    number[imk_decimal_significant(value, DIGITS, number)] = '\0';
    imki_text_add(out, "%s%s", index > 0 ? "," : "", number);
}

/* Nothing for a sensor without noise, or without figures. */
static void put_triad(imki_text *out, const char *key, const imk_triad *triad)
{
    if (!triad->present || !(imki_noise_deviation(triad, 1) > 0))
        return;
    imki_text_add(out, ",\"%s\":[", key);
    for (int i = 0; i < TIMES; i++)
        put_number(out, i, imki_noise_deviation(triad, time_of(i)));
    imki_text_put(out, "]");
}

void imki_catalogue_data(imki_text *out)
{
    imki_text_put(out, "{\"tau\":[");
    for (int i = 0; i < TIMES; i++)
        put_number(out, i, time_of(i));
    imki_text_put(out, "],\"sensors\":[");
    for (size_t d = 0; d < imk_device_count(); d++) {
        const imk_device *device = imk_device_get(d);
        imk_model model;
        imk_device_model(device, &model);
        imki_text_put(out, d > 0 ? ",\n{\"name\":" : "\n{\"name\":");
        imki_markup_quote(out, device->name);
        imki_text_add(out, ",\"grade\":%s", device->is_preset ? "true" : "false");
        put_triad(out, "rad/s", &model.gyro);
        put_triad(out, "m/s^2", &model.accel);
        imki_text_put(out, "}");
    }
    imki_text_put(out, "]}");
}
