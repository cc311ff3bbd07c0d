/* SPDX-License-Identifier: Apache-2.0 */
/* Static record: noise by identification. How long it has to be follows from the spectrum that the
 * closed forms state: Fisher's information of the cosine coefficients about each term, where the
 * others are not known either [docs/theory/identification.md]. */
#include "laboratory_internal.h"

#include "imukit/linear_algebra.h"
#include "imukit/noise.h"

#include <math.h>
#include <string.h>

enum { SAMPLES_MAX = 1 << 19, TERMS = 4, LINES_MAX = 400 };

/* Shapes of the spectrum; READING is errors of the readings of the integral, counted or not. */
enum { READING, WHITE, FLICKER, WALK };

typedef struct spectrum {
    double size[TERMS]; /* 1 sigma of readings of the integral, N, B, K; 0: none */
    double density;     /* A, more of the same that depends on the rate */
    double rate;
} spectrum;

size_t imki_record_samples(const imk_laboratory *l)
{
    if (l->record == 0.0)
        return 0;
    return l->record < 0.0 ? SAMPLES_MAX
                           : imki_samples_in(l->record * (1.0 - 1e-12), l->physics.rate);
}

static double shape(const spectrum *s, int term, double dt, double f)
{
    switch (term) {
    case READING:
        return imk_quantization_sampled_spectrum(s->size[READING], dt, f) +
               imk_angle_white_sampled_spectrum(s->density, dt, f);
    case WHITE:
        return imk_white_sampled_spectrum(s->size[WHITE], dt, f);
    case FLICKER:
        return s->size[FLICKER] * s->size[FLICKER] / (2.0 * IMKI_PI * f);
    default:
        return imk_random_walk_sampled_spectrum(s->size[WALK], dt, f);
    }
}

/* Relative 1 sigma of each term that is there, from n samples. A random walk may be there even if
 * none is stated: its column is then of arbitrary size. */
static void expected_sigmas(const spectrum *s, size_t n, double dt, double relative[TERMS])
{
    double rows[LINES_MAX * TERMS], beta[TERMS], covariance[TERMS * TERMS];
    int column[TERMS];
    size_t columns = 0, lines = 0;
    spectrum own = *s;
    for (int k = 0; k < TERMS; k++) {
        const bool there = k == READING ? s->size[k] > 0.0 || s->density > 0.0 : s->size[k] > 0.0;
        relative[k] = (double)INFINITY;
        column[k] = there || k == WALK ? (int)columns++ : -1;
    }
    if (!(own.size[WALK] > 0.0))
        own.size[WALK] = 1.0;
    for (size_t k = 1; k < n && lines < LINES_MAX; lines++) {
        const size_t next = k + 1 + k / 24;
        const double f = 0.5 * (double)k / ((double)n * dt);
        double sum = 1e-300;
        for (int j = 0; j < TERMS; j++)
            if (j != WALK || s->size[WALK] > 0.0)
                sum += column[j] >= 0 ? shape(s, j, dt, f) : 0.0;
        for (int j = 0; j < TERMS; j++)
            if (column[j] >= 0)
                rows[lines * columns + (size_t)column[j]] =
                    sqrt(0.5 * (double)((next < n ? next : n) - k)) * shape(&own, j, dt, f) / sum;
        k = next;
    }
    if (columns < 2 || lines <= columns)
        return;
    double largest = 0.0; /* the walk's column is brought to the size of the others */
    for (size_t i = 0; i < lines; i++)
        largest = fmax(largest, rows[i * columns + columns - 1]);
    for (size_t i = 0; i < lines && !(s->size[WALK] > 0.0) && largest > 0.0; i++)
        rows[i * columns + columns - 1] /= largest;
    if (imk_qr_factor(lines, columns, rows, beta) != IMK_OK ||
        imk_qr_covariance(lines, columns, rows, covariance) != IMK_OK)
        return;
    for (int k = 0; k < TERMS; k++)
        if (column[k] >= 0 && (k != WALK || s->size[WALK] > 0.0))
            relative[k] = 0.5 * sqrt(covariance[(size_t)column[k] * (columns + 1)]);
}

static double rate_of(const spectrum *s, double seconds)
{
    return fmin(s->rate, SAMPLES_MAX / 2 / seconds);
}

/* Seconds that each term needs. */
static void lengths_needed(const spectrum *s, double needs[TERMS])
{
    double relative[TERMS];
    for (int k = 0; k < TERMS; k++)
        needs[k] = (double)INFINITY;
    for (double t = 512.0 / s->rate; t < 1e9; t *= 1.25) {
        const double rate = rate_of(s, t);
        expected_sigmas(s, (size_t)(t * rate), 1.0 / rate, relative);
        for (int k = 0; k < TERMS; k++)
            if (relative[k] <= IMKI_WANTED && t < needs[k])
                needs[k] = t;
    }
}

/* Readings without input, and their identification. @return false when there is none */
static bool identify(imki_bench *b, double rate, size_t count, imk_identification *found)
{
    const imk_laboratory *l = b->laboratory;
    imk_physics_settings physics = imki_cycle(b, 0, l->quick);
    imk_identify_settings settings = imk_identify_default();
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX];
    physics.rate = rate;
    settings.dt = 1.0 / rate;
    if (imk_instrument_init(l->instrument, l->design, &physics, b->states, NULL) != IMK_OK)
        return false;
    for (size_t i = imki_samples_in(b->settle, rate); i > 0; i--)
        l->instrument->step(b->states, &l->surroundings, outputs);
    for (size_t i = 0; i < count; i++) {
        if (i % 4096 == 0 && !imki_progress(b, "record at rest", i, count))
            return false;
        l->instrument->step(b->states, &l->surroundings, outputs);
        b->record[i] = outputs[0];
    }
    return imk_identify_channel(&settings, count, b->record, found, b->identification,
                                imk_identify_workspace_size(count), NULL) == IMK_OK;
}

/* ---- figures --------------------------------------------------------------------------------- */

typedef struct place {
    const char *key[2]; /* of a gyro, of an accelerometer */
    imk_noise_term term;
} place;

static const place places[TERMS] = {
    {{"noise.quantization", "noise.quantization"}, IMK_NOISE_QUANTIZATION},
    {{"noise.angle_random_walk", "noise.velocity_random_walk"}, IMK_NOISE_WHITE},
    {{"noise.bias_instability", "noise.bias_instability"}, IMK_NOISE_BIAS_INSTABILITY},
    {{"noise.rate_random_walk", "noise.acceleration_random_walk"}, IMK_NOISE_RANDOM_WALK}};
/* Three kinds of errors of readings, which a record at one rate cannot tell from each other. */
static const char *const readings[2][3] = {
    {"noise.quantization", "noise.reading_noise", "noise.angle_white"},
    {"noise.quantization", "noise.reading_noise", "noise.velocity_white"}};

static imk_axes *axes_of(imk_noise *noise, int term)
{
    imk_axes *const axes[TERMS] = {&noise->quantization, &noise->white, &noise->bias_instability,
                                   &noise->random_walk};
    return axes[term];
}

/* Errors of readings are given to the largest of the stated kinds, the others as stated.
 * @return the figure */
static size_t reading_figure(imki_bench *b, const imk_identification *found, imk_axes **axes,
                             double *unit, double *others)
{
    const char *const *key = readings[b->laboratory->instrument->sensor];
    imk_noise *noise = &b->triad->noise;
    imk_axes *const all[3] = {&noise->quantization, &noise->reading_noise, &noise->angle_white};
    const double units[3] = {1.0, 1.0, sqrt(found->dt)};
    double stated[3], square = 0.0;
    int largest = imk_identification_counted(found) ? 0 : 2;
    for (int k = 0; k < 3; k++) {
        *all[k] = (imk_axes){{0.0}, {0.0}};
        stated[k] = b->computed[imki_figure_of(b, key[k])].value / units[k];
        square += stated[k] * stated[k];
    }
    for (int k = 0; k < 3 && square > 0.0; k++)
        if (stated[k] >= stated[largest])
            largest = k;
    *axes = all[largest];
    *unit = units[largest];
    *others = sqrt(fmax(0.0, square - stated[largest] * stated[largest]));
    return imki_figure_of(b, key[largest]);
}

/* Keep what a record of these seconds says of a term, which needs so many. What is absent although
 * stated is known as well as the record would show it. Where the rounding is coarser than the
 * noise, nothing is known. */
static void keep(imki_bench *b, const imk_identification *found, int term, const spectrum *s,
                 double seconds, double needs)
{
    const imk_estimate *e = &found->term[places[term].term];
    const bool coarse = (found->verdict & IMK_VERDICT_COARSE) != 0;
    imk_axes *axes = axes_of(&b->triad->noise, term);
    size_t i = imki_figure_of(b, places[term].key[b->laboratory->instrument->sensor]);
    double unit = 1.0, others = 0.0, relative[TERMS];
    if (term == READING)
        i = reading_figure(b, found, &axes, &unit, &others);
    expected_sigmas(s, (size_t)(seconds / found->dt + 0.5), found->dt, relative);
    const double rest = sqrt(fmax(0.0, e->value * e->value - others * others));
    axes->value[0] = e->present ? rest * unit : 0.0;
    axes->sigma[0] =
        rest > 0.0 ? e->sigma * e->value / rest * unit : relative[term] * b->computed[i].value;
    if (!e->present && !(b->computed[i].value > 0.0)) /* how large it may be */
        axes->sigma[0] = e->upper / 2.0 * unit;
    if (coarse)
        axes->sigma[0] = fmax(axes->sigma[0], fabs(axes->value[0] - b->computed[i].value));
    b->result->effort[i] =
        (imk_laboratory_effort){(double)INFINITY, seconds, coarse ? (double)INFINITY : needs,
                                coarse         ? "rounding is not white"
                                : isinf(needs) ? "other noise hides it"
                                               : NULL};
}

static spectrum stated(const imki_bench *b)
{
    const int sensor = b->laboratory->instrument->sensor;
    spectrum s = {.rate = b->laboratory->physics.rate};
    for (int k = 0; k < TERMS; k++)
        s.size[k] = b->computed[imki_figure_of(b, places[k].key[sensor])].value;
    s.size[READING] =
        hypot(s.size[READING], b->computed[imki_figure_of(b, readings[sensor][1])].value);
    s.density = b->computed[imki_figure_of(b, readings[sensor][2])].value;
    /* errors of successive readings are independent where a sample is longer than the response */
    if ((s.size[READING] > 0.0 || s.density > 0.0) && b->bandwidth > 0.0)
        s.rate /= fmax(1.0, ceil(s.rate / b->bandwidth));
    return s;
}

/* The roundings at the two ends of a record look like white noise of 2 Q/sqrt(T), see
 * docs/theory/identification.md: what is not above that is not known. */
static void add_ends(imki_bench *b, const imk_identification *found, double seconds)
{
    imk_axes *white = &b->triad->noise.white;
    const double ends = 2.0 * found->term[IMK_NOISE_QUANTIZATION].value / seconds;
    white->sigma[0] = hypot(white->sigma[0], ends * sqrt(found->dt));
}

/* The first record is at the rate of the instrument, as long as the terms need that fit into it;
 * those that need more have a second one at a lower rate. */
void imki_record(imki_bench *b)
{
    const imk_laboratory *l = b->laboratory;
    const spectrum s = stated(b);
    const double rate = s.rate;
    double needs[TERMS], first = 0.0, second = 0.0;
    lengths_needed(&s, needs);
    for (int k = 0; k < TERMS; k++) {
        if (isinf(needs[k]) || needs[k] > imki_longest(b, rate_of(&s, needs[k]), l->quick))
            continue;
        if (needs[k] * rate <= (double)b->samples)
            first = fmax(first, needs[k]);
        else
            second = fmax(second, needs[k]);
    }
    first = l->record > 0.0 ? l->record
                            : fmax(first, fmax(1024.0 / rate, fmin(60.0, b->longest[l->quick])));
    first = fmin(first, (double)b->samples / rate);
    imk_identification *found = &b->result->noise;
    b->result->has_noise = identify(b, rate, (size_t)(first * rate + 0.5), found);
    if (!b->result->has_noise)
        return;
    const imk_axes bandwidth = b->triad->bandwidth; /* the shaker's, not that of the noise */
    imk_identification_store(found, &b->result->model, l->instrument->sensor, 0);
    if (bandwidth.value[0] > 0.0)
        b->triad->bandwidth = bandwidth;
    for (int k = 0; k < TERMS; k++)
        keep(b, found, k, &s, first, needs[k]);
    add_ends(b, found, first);
    if (!(second > first) || l->record > 0.0)
        return;
    const double slow = rate_of(&s, second);
    imk_identification other;
    if (!identify(b, slow, (size_t)(second * slow), &other))
        return;
    for (int k = 0; k < TERMS; k++)
        if (needs[k] > first && needs[k] <= second)
            keep(b, &other, k, &s, second, needs[k]);
}
