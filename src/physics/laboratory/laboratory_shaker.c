/* SPDX-License-Identifier: Apache-2.0 */
/* Frequency response: sines at frequencies in equal ratios, each beside a run of the same noise
 * without it. Where the gain falls by 3 dB below the static one, more frequencies are tried between
 * the two. */
#include "laboratory_internal.h"

#include "imukit/elementary.h"

#include <math.h>

/* Of full scale: small enough for the response to be linear. */
static const double amplitude = 0.05;

enum { REFINEMENTS = 3 };

/* Two instruments side by side, one with the sine. */
typedef struct pair {
    const imki_bench *bench;
    void *state[2];
    double input;
} pair;

/* What the sine changes in the reading of a sample from `begin` to `end` [rad of its phase]. */
static double step(const pair *p, double begin, double end, double dt, double *mean)
{
    const imk_laboratory *l = p->bench->laboratory;
    double outputs[2][IMK_INSTRUMENT_OUTPUTS_MAX];
    imk_exposure exposure = l->surroundings;
    *mean = p->input * (imk_cos(begin) - imk_cos(end)) / (end - begin);
    l->instrument->step(p->state[0], &exposure, outputs[0]);
    if (l->instrument->sensor == IMK_GYRO) {
        exposure.angular_rate[0] += *mean;
        exposure.angular_acceleration[0] += p->input * (imk_sin(end) - imk_sin(begin)) / dt;
    } else {
        exposure.specific_force[0] += *mean;
    }
    l->instrument->step(p->state[1], &exposure, outputs[1]);
    return outputs[1][0] - outputs[0][0];
}

/* A hundred periods of the bandwidth are enough where that is known: what decays more slowly is
 * small in the response to a sine. */
static double settling(const imki_bench *bench)
{
    return bench->bandwidth > 0.0 ? fmin(bench->settle, 100.0 / bench->bandwidth) : bench->settle;
}

/* Correlation of change and input with the cosine and the sine of the input's phase, over whole
 * cycles. The mean of a sine over a sample is what the instrument is exposed to. */
static imk_laboratory_response measure_sine(const pair *p, double frequency, size_t per_cycle)
{
    const imk_laboratory *l = p->bench->laboratory;
    const double angle = 2.0 * IMKI_PI / (double)per_cycle;
    const double dt = 1.0 / (frequency * (double)per_cycle);
    const size_t settle = imki_samples_in(settling(p->bench) + 4.0 / frequency, 1.0 / dt);
    const size_t wanted = imki_samples_in(l->dwell, frequency);
    const size_t cycles = wanted < 4 ? 4 : wanted;
    double out[2] = {0.0, 0.0}, in[2] = {0.0, 0.0}, mean;
    for (size_t i = 0; i < settle + cycles * per_cycle; i++) {
        const double begin = angle * (double)(i % per_cycle), middle = begin + 0.5 * angle;
        const double change = step(p, begin, begin + angle, dt, &mean);
        if (i < settle)
            continue;
        const double c = imk_cos(middle), s = imk_sin(middle);
        out[0] += change * c;
        out[1] += change * s;
        in[0] += mean * c;
        in[1] += mean * s;
    }
    double phase = imk_atan2(out[0], out[1]) - imk_atan2(in[0], in[1]);
    phase -= 2.0 * IMKI_PI * floor(phase / (2.0 * IMKI_PI) + 0.5);
    const double ratio = (out[0] * out[0] + out[1] * out[1]) / (in[0] * in[0] + in[1] * in[1]);
    /* an input that is held and a mean each have sin(x)/x of the amplitude, x half of the angle */
    const double held = imk_sin(0.5 * angle) / (0.5 * angle);
    return (imk_laboratory_response){frequency, sqrt(ratio) / (held * held), phase};
}

/* Samples to a cycle: as the sample rate gives, at least 64: what holding the input and taking the
 * mean of the output change in the gain, and is taken out, is then less than 1e-3. */
static size_t samples_per_cycle(const imk_laboratory *laboratory, double frequency)
{
    const double count = floor(laboratory->physics.rate / frequency + 0.5);
    return count > 64.0 ? (size_t)count : 64;
}

typedef struct shaking {
    imki_bench *bench;
    imk_laboratory_response *response; /* of these frequencies; gain NaN: the rate is refused */
} shaking;

static void measure(void *context, size_t item)
{
    const shaking *s = context;
    const imk_laboratory *l = s->bench->laboratory;
    imk_laboratory_response *r = &s->response[item];
    const size_t per_cycle = samples_per_cycle(l, r->frequency), size = imki_state_size(l);
    imk_physics_settings physics = imki_cycle(s->bench, 0, false);
    pair p = {.bench = s->bench, .input = amplitude * s->bench->result->full_scale};
    physics.rate = r->frequency * (double)per_cycle;
    r->gain = r->phase = (double)NAN;
    for (size_t k = 0; k < 2; k++) {
        p.state[k] = s->bench->states + (2 * item + k) * size;
        if (imk_instrument_init(l->instrument, l->design, &physics, p.state[k], NULL) != IMK_OK)
            return;
    }
    *r = measure_sine(&p, r->frequency, per_cycle);
}

static double between(double low, double high, double fraction)
{
    return low * imk_exp(fraction * imk_ln(high / low));
}

static double crossing(const imk_laboratory_response *a, const imk_laboratory_response *b,
                       double gain)
{
    return between(a->frequency, b->frequency, imk_ln(a->gain / gain) / imk_ln(a->gain / b->gain));
}

/* Narrow the two frequencies about the crossing: each time to the neighbourhood of where the line
 * between them crosses. */
static void refine(shaking *s, double limit, imk_laboratory_response *low,
                   imk_laboratory_response *high)
{
    for (int i = 0; i < REFINEMENTS; i++) {
        const double at = crossing(low, high, limit);
        const double wide = imk_ln(high->frequency / low->frequency) / 8.0;
        imk_laboratory_response tried[2] = {{fmax(at * imk_exp(-wide), low->frequency), 0.0, 0.0},
                                            {fmin(at * imk_exp(wide), high->frequency), 0.0, 0.0}};
        shaking two = {s->bench, tried};
        imk_execute(s->bench->executor, 2, measure, &two);
        for (int k = 0; k < 2; k++) {
            if (tried[k].gain >= limit && tried[k].frequency > low->frequency)
                *low = tried[k];
            else if (tried[k].gain < limit && tried[k].frequency < high->frequency)
                *high = tried[k];
        }
    }
}

static void find_bandwidth(imki_bench *bench)
{
    imk_laboratory_result *result = bench->result;
    /* a loop with an integrator exceeds its static gain long before its bandwidth */
    const double s = bench->triad->scale_factor.fixed.value[0];
    const double limit = (1.0 + s) / sqrt(2.0);
    for (int i = 1; i < result->response_count; i++) {
        imk_laboratory_response low = result->response[i - 1], high = result->response[i];
        if (!(low.gain >= limit && high.gain < limit))
            continue;
        refine(&(shaking){bench, NULL}, limit, &low, &high);
        result->bandwidth = crossing(&low, &high, limit);
        bench->triad->bandwidth.value[0] = result->bandwidth;
        /* and the samples' part in the gain */
        bench->triad->bandwidth.sigma[0] =
            hypot((high.frequency - low.frequency) / sqrt(12.0), 1e-3 * result->bandwidth);
        return;
    }
}

void imki_shaker(imki_bench *bench)
{
    imk_laboratory_response response[IMK_LABORATORY_FREQUENCIES_MAX];
    const imk_laboratory *laboratory = bench->laboratory;
    imk_laboratory_result *result = bench->result;
    const int count = laboratory->frequencies;
    const double rate = laboratory->physics.rate, bandwidth = bench->bandwidth;
    const double lowest = laboratory->lowest > 0.0 ? laboratory->lowest
                          : bandwidth > 0.0        ? bandwidth / 30.0
                                                   : 0.01 * rate;
    const double highest = laboratory->highest > 0.0 ? laboratory->highest
                           : bandwidth > 0.0         ? bandwidth * 3.0
                                                     : 0.25 * rate;
    double seconds = 0.0;
    if (!imki_progress(bench, "shaker", 0, (uint64_t)count))
        return;
    for (int i = 0; i < count; i++) {
        response[i].frequency = between(lowest, highest, count > 1 ? i / (count - 1.0) : 0.0);
        seconds += settling(bench) + 8.0 / response[i].frequency;
    }
    imk_execute(bench->executor, (size_t)count, measure, &(shaking){bench, response});
    for (int i = 0; i < count; i++)
        if (isfinite(response[i].gain))
            result->response[result->response_count++] = response[i];
    if (result->response_count > 1)
        find_bandwidth(bench);
    if (result->bandwidth > 0.0)
        result->effort[imki_figure_of(bench, "bandwidth")] = (imk_laboratory_effort){
            (double)INFINITY, seconds, (double)INFINITY, "steps of the frequency"};
}
