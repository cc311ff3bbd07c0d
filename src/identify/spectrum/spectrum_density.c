/* SPDX-License-Identifier: Apache-2.0 */
/* Power spectral density of a record: segments, windows, transforms, averages.
 *
 * With w a window of unit energy, X the transform of a segment less its mean (or line), times w:
 *
 *     S(k/(L dt)) = dt mean |X_k|^2          two-sided, unit^2/Hz   [WELCH1967]
 *
 * so that the sum over all L bins over L dt is the windowed mean square. The degrees of freedom of
 * M overlapping segments are [WELCH1967] [PERCIVAL1993, (292b)]
 *
 *     2 M / (1 + 2 sum_j p_j/M r_j^2),   r_j = sum_i w_i w_(i + j hop)
 *
 * p_j the number of pairs of used segments j hops apart. Two real sequences go through each complex
 * transform: two segments, or two tapers of one. */
#include "spectrum_internal.h"

#include "base/workspace_internal.h"
#include "imukit/fourier.h"

#include <math.h>
#include <string.h>

static const uint32_t settings_cookie = 0x73706331; /* "spc1" */

/* Default segments: a sixteenth of the record is 31 at half overlap, 50 degrees of freedom; longer
 * than the maxima they would only cost memory. */
enum {
    SAMPLES_MIN = 64,
    LENGTH_MIN = 16,
    PARTS = 16,
    WELCH_LENGTH_MAX = 1 << 20,
    MULTITAPER_LENGTH_MAX = 1 << 18
};

imk_spectrum_settings imk_spectrum_default(void)
{
    return (imk_spectrum_settings){.cookie = settings_cookie,
                                   .method = IMK_SPECTRUM_WELCH,
                                   .window = IMK_WINDOW_HANN,
                                   .kaiser_beta = 8.6,
                                   .overlap = 0.5,
                                   .time_bandwidth = 4,
                                   .adaptive = true};
}

/* ---- division into segments ------------------------------------------------------------------ */

/* Largest even number up to `most` with no prime factor but 2, 3 and 5: within 5 % of it. */
static size_t good_length(size_t most)
{
    size_t best = 2;
    for (size_t five = 2; five <= most; five *= 5)
        for (size_t three = five; three <= most; three *= 3) {
            size_t two = three;
            while (two <= most / 2)
                two *= 2;
            best = two > best ? two : best;
        }
    return best;
}

static imk_status check_settings(const imk_spectrum_settings *s, imk_error *error)
{
    if (!s || s->cookie != settings_cookie)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "settings", "",
                             "start from imk_spectrum_default()");
    if (!(s->dt > 0 && s->dt < HUGE_VAL))
        return imk_error_set(error, IMK_ERROR_RANGE, "dt", "", "a positive sample interval");
    if (!(s->resolution >= 0 && s->resolution < HUGE_VAL))
        return imk_error_set(error, IMK_ERROR_RANGE, "resolution", "", "a positive bandwidth");
    if (!(s->overlap >= 0 && s->overlap <= 0.9))
        return imk_error_set(error, IMK_ERROR_RANGE, "overlap", "", "0 to 0.9");
    if (!(s->kaiser_beta >= 0 && s->kaiser_beta <= 40))
        return imk_error_set(error, IMK_ERROR_RANGE, "kaiser_beta", "", "0 to 40");
    if (!(s->time_bandwidth >= 1 && s->time_bandwidth <= 16))
        return imk_error_set(error, IMK_ERROR_RANGE, "time_bandwidth", "", "1 to 16");
    if (!(s->tapers >= 0 && s->tapers <= IMK_TAPERS_MAX &&
          (double)s->tapers <= 2 * s->time_bandwidth))
        return imk_error_set(error, IMK_ERROR_RANGE, "tapers", "",
                             "at most twice the time-bandwidth product, and at most 24");
    if ((unsigned)s->method > IMK_SPECTRUM_MULTITAPER ||
        (unsigned)s->window > IMK_WINDOW_RECTANGULAR)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "method", "",
                             "one of the values of the enumeration");
    return IMK_OK;
}

static size_t default_length(const imk_spectrum_settings *s, size_t n)
{
    if (s->method == IMK_SPECTRUM_MULTITAPER) {
        const size_t parts = (n + MULTITAPER_LENGTH_MAX - 1) / MULTITAPER_LENGTH_MAX;
        return n / parts;
    }
    size_t length = n >= PARTS * LENGTH_MIN ? n / PARTS : n / 4;
    return length < WELCH_LENGTH_MAX ? length : WELCH_LENGTH_MAX;
}

imk_status imki_segments_plan(const imk_spectrum_settings *s, size_t n, imki_segments *segments,
                              imk_error *error)
{
    imk_status status = check_settings(s, error);
    if (status != IMK_OK)
        return status;
    if (n < SAMPLES_MIN)
        return imk_error_set(error, IMK_ERROR_TOO_SHORT, "samples", "", "at least 64 samples");
    double wanted = (double)default_length(s, n);
    if (s->resolution > 0)
        wanted = imki_window_bandwidth(s) / (s->resolution * s->dt);
    /* The width of the whole record, computed by the caller, may be rounded down. */
    if (wanted > (double)n && wanted < (double)n * (1 + 1e-9))
        wanted = (double)n;
    if (!(wanted <= (double)n && wanted < 2147483648.0))
        return imk_error_set(error, IMK_ERROR_RANGE, "resolution", "finer than the record allows",
                             "a wider bandwidth, or a longer record");
    const bool tapered = s->method == IMK_SPECTRUM_MULTITAPER;
    const double least = tapered ? fmax(LENGTH_MIN, 4 * s->time_bandwidth) : LENGTH_MIN;
    if (!(wanted >= least))
        return imk_error_set(error, IMK_ERROR_RANGE, "resolution", "coarser than the method allows",
                             "a narrower bandwidth: segments need at least 16 samples");
    *segments = (imki_segments){
        .settings = s, .n = n, .length = good_length((size_t)(wanted * (1 + 1e-9)))};
    segments->tapers = !tapered ? 1 : s->tapers > 0 ? s->tapers : (int)(2 * s->time_bandwidth) - 1;
    if (segments->tapers > IMK_TAPERS_MAX)
        segments->tapers = IMK_TAPERS_MAX;
    const size_t length = segments->length;
    if (tapered) { /* no overlap: the tapers use the ends; what is left over lies between */
        segments->count = n / length;
        segments->hop = segments->count > 1 ? (n - length) / (segments->count - 1) : length;
    } else {
        const double hop = floor((1 - s->overlap) * (double)length + 0.5);
        segments->hop = hop > 1 ? (size_t)hop : 1;
        segments->count = (n - length) / segments->hop + 1;
    }
    return IMK_OK;
}

size_t imk_spectrum_count(const imk_spectrum_settings *settings, size_t n)
{
    imki_segments segments;
    return imki_segments_plan(settings, n, &segments, NULL) == IMK_OK ? segments.length / 2 + 1 : 0;
}

/* ---- workspace ------------------------------------------------------------------------------- */

typedef struct estimation {
    imki_segments plan;
    const double *samples;
    double offset;
    double *windows;  /* tapers * length */
    double *segment;  /* length */
    double *buffer;   /* 2 length: two real sequences as one complex */
    double *eigen;    /* tapers * count complex numbers, and before that Slepian's workspace */
    double *harmonic; /* 2 count: explained and rest */
    double concentration[IMK_TAPERS_MAX], sums[IMK_TAPERS_MAX];
    void *transform;
    size_t transform_size, eigen_size;
} estimation;

static size_t lay_out(estimation *e, void *workspace)
{
    const size_t length = e->plan.length, count = length / 2 + 1, tapers = (size_t)e->plan.tapers;
    const bool tapered = e->plan.settings->method == IMK_SPECTRUM_MULTITAPER;
    size_t eigen = tapered ? 2 * tapers * count : 0, used = 0;
    if (tapered && eigen < 8 * length + 64)
        eigen = 8 * length + 64;
    double *base = workspace ? imki_align(workspace) : NULL;
    const size_t sizes[] = {tapers * length, length, 2 * length, eigen, tapered ? 2 * count : 0};
    double **const places[] = {&e->windows, &e->segment, &e->buffer, &e->eigen, &e->harmonic};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        *places[i] = base ? base + used : NULL;
        used += sizes[i];
    }
    e->eigen_size = eigen * sizeof(double);
    e->transform = base ? base + used : NULL;
    e->transform_size = imk_fourier_workspace_size(length);
    return used * sizeof(double) + e->transform_size + IMKI_ALIGNMENT_SLACK;
}

size_t imk_spectrum_workspace_size(const imk_spectrum_settings *settings, size_t n)
{
    estimation e = {.samples = NULL};
    if (imki_segments_plan(settings, n, &e.plan, NULL) != IMK_OK)
        return 0;
    return lay_out(&e, NULL);
}

/* ---- one segment ----------------------------------------------------------------------------- */

/* Least squares: the mean, and the slope against i - (length - 1)/2. */
static void remove_trend(size_t length, bool line, double *x)
{
    double sum = 0, product = 0;
    const double middle = 0.5 * ((double)length - 1);
    for (size_t i = 0; i < length; i++)
        sum += x[i];
    const double mean = sum / (double)length;
    for (size_t i = 0; i < length; i++) {
        x[i] -= mean;
        product += ((double)i - middle) * x[i];
    }
    const double size = (double)length, squares = size * (size * size - 1) / 12;
    for (size_t i = 0; line && i < length; i++)
        x[i] -= product / squares * ((double)i - middle);
}

/* A segment without its mean; false when samples are missing. */
static bool take_segment(const estimation *e, size_t index)
{
    const double *from = e->samples + index * e->plan.hop;
    double check = 0; /* not a number as soon as one sample is not finite */
    for (size_t i = 0; i < e->plan.length; i++) {
        e->segment[i] = from[i] - e->offset;
        check += 0 * e->segment[i];
    }
    if (check != 0)
        return false;
    remove_trend(e->plan.length, e->plan.settings->trend, e->segment);
    return true;
}

static void put_windowed(const estimation *e, int taper, int slot)
{
    const double *w = e->windows + (size_t)taper * e->plan.length;
    for (size_t i = 0; i < e->plan.length; i++)
        e->buffer[2 * i + (size_t)slot] = w[i] * e->segment[i];
}

static void clear_slot(const estimation *e)
{
    for (size_t i = 0; i < e->plan.length; i++)
        e->buffer[2 * i + 1] = 0;
}

/* Coefficient `bin` of the sequence in a slot: its part of the transform of both. */
static void unpack(const double *buffer, size_t length, size_t bin, int slot, double *re,
                   double *im)
{
    const size_t mirror = bin == 0 ? 0 : length - bin;
    const double a = buffer[2 * bin], b = buffer[2 * bin + 1];
    const double c = buffer[2 * mirror], d = buffer[2 * mirror + 1];
    *re = slot == 0 ? 0.5 * (a + c) : 0.5 * (b + d);
    *im = slot == 0 ? 0.5 * (b - d) : 0.5 * (c - a);
}

static imk_status transform(const estimation *e)
{
    return imk_fourier(e->plan.length, e->buffer, 0, e->transform, e->transform_size);
}

/* ---- Welch ----------------------------------------------------------------------------------- */

static imk_status add_pair(const estimation *e, int slots, double *density)
{
    const size_t length = e->plan.length;
    if (slots == 1)
        clear_slot(e);
    const imk_status status = transform(e);
    for (size_t bin = 0; status == IMK_OK && bin <= length / 2; bin++)
        for (int slot = 0; slot < slots; slot++) {
            double re, im;
            unpack(e->buffer, length, bin, slot, &re, &im);
            density[bin] += e->plan.settings->dt * (re * re + im * im);
        }
    return status;
}

/* Which segments were used: pairs[j] of them are j hops apart. */
typedef struct usage {
    size_t used, pairs[IMKI_LAGS_MAX + 1], covered, covered_to;
    uint32_t history; /* bit j: the segment j + 1 before was used */
} usage;

static void note_segment(usage *u, const imki_segments *plan, size_t index, bool used)
{
    if (used) {
        const size_t begin = index * plan->hop, end = begin + plan->length;
        u->used++;
        u->covered += end - (begin > u->covered_to ? begin : u->covered_to);
        u->covered_to = end;
        for (int j = 1; j <= IMKI_LAGS_MAX; j++)
            u->pairs[j] += u->history >> (j - 1) & 1;
    }
    u->history = u->history << 1 | (used ? 1 : 0);
}

static imk_status estimate_welch(estimation *e, imk_spectrum *s, usage *u)
{
    int slots = 0;
    imk_status status = IMK_OK;
    imki_window_fill(e->plan.settings, e->plan.length, e->windows);
    for (size_t index = 0; index < e->plan.count && status == IMK_OK; index++) {
        const bool used = take_segment(e, index);
        note_segment(u, &e->plan, index, used);
        if (!used)
            continue;
        put_windowed(e, 0, slots++);
        if (slots == 2) {
            status = add_pair(e, 2, s->density);
            slots = 0;
        }
    }
    return status == IMK_OK && slots == 1 ? add_pair(e, 1, s->density) : status;
}

/* Degrees of freedom of a bin, and bins per independent value: the latter from the variance of a
 * mean over all bins, in which lag j counts L sum_i w_i^2 w_(i+j)^2 instead of r_j^2. */
static void welch_degrees(const estimation *e, imk_spectrum *s, const usage *u)
{
    const size_t length = e->plan.length, hop = e->plan.hop;
    const double *w = e->windows;
    double bins = 1, all = 0;
    for (size_t i = 0; i < length; i++)
        all += (double)length * w[i] * w[i] * w[i] * w[i];
    for (size_t j = 1; j <= IMKI_LAGS_MAX && j * hop < length; j++) {
        double product = 0, squares = 0;
        for (size_t i = 0; i + j * hop < length; i++) {
            const double p = w[i] * w[i + j * hop];
            product += p;
            squares += p * p;
        }
        const double pairs = 2 * (double)u->pairs[j] / (double)u->used;
        bins += pairs * product * product;
        all += pairs * (double)length * squares;
    }
    for (size_t bin = 0; bin < s->count; bin++)
        s->degrees[bin] = 2 * (double)u->used / bins;
    s->correlation = all / bins;
}

/* ---- multitaper ------------------------------------------------------------------------------ */

static imk_status take_eigenspectra(estimation *e)
{
    const size_t length = e->plan.length, count = length / 2 + 1;
    const double root = sqrt(e->plan.settings->dt);
    for (int taper = 0; taper < e->plan.tapers; taper += 2) {
        const int slots = e->plan.tapers - taper > 1 ? 2 : 1;
        for (int slot = 0; slot < slots; slot++)
            put_windowed(e, taper + slot, slot);
        if (slots == 1)
            clear_slot(e);
        const imk_status status = transform(e);
        if (status != IMK_OK)
            return status;
        for (int slot = 0; slot < slots; slot++) {
            double *to = e->eigen + 2 * (size_t)(taper + slot) * count;
            for (size_t bin = 0; bin < count; bin++) {
                unpack(e->buffer, length, bin, slot, &to[2 * bin], &to[2 * bin + 1]);
                to[2 * bin] *= root;
                to[2 * bin + 1] *= root;
            }
        }
    }
    return IMK_OK;
}

static double segment_power(const estimation *e)
{
    double squares = 0;
    for (size_t i = 0; i < e->plan.length; i++)
        squares += e->segment[i] * e->segment[i];
    return squares / (double)e->plan.length * e->plan.settings->dt;
}

static imk_status prepare_tapers(estimation *e)
{
    const size_t length = e->plan.length;
    const imk_status status =
        imk_slepian_tapers(length, e->plan.settings->time_bandwidth, e->plan.tapers, e->windows,
                           e->concentration, e->eigen, e->eigen_size);
    for (int k = 0; status == IMK_OK && k < e->plan.tapers; k++) {
        e->sums[k] = 0;
        for (size_t i = 0; k % 2 == 0 && i < length; i++)
            e->sums[k] += e->windows[(size_t)k * length + i];
    }
    return status;
}

static imk_status estimate_multitaper(estimation *e, imk_spectrum *s, usage *u)
{
    const size_t count = s->count;
    double *explained = e->harmonic, *rest = explained + count;
    memset(e->harmonic, 0, 2 * count * sizeof *e->harmonic);
    imk_status status = prepare_tapers(e);
    for (size_t index = 0; index < e->plan.count && status == IMK_OK; index++) {
        const bool used = take_segment(e, index);
        note_segment(u, &e->plan, index, used);
        if (!used)
            continue;
        status = take_eigenspectra(e);
        imki_multitaper_add(e->plan.tapers, count, e->eigen, e->concentration,
                            e->plan.settings->adaptive, segment_power(e), s->density, s->degrees);
        imki_harmonic_add(e->plan.tapers, count, e->eigen, e->sums, explained, rest);
    }
    s->harmonic_degrees[0] = 2 * (double)u->used;
    s->harmonic_degrees[1] = s->harmonic_degrees[0] * (e->plan.tapers - 1);
    for (size_t bin = 0; s->harmonic && bin < count; bin++)
        s->harmonic[bin] = rest[bin] > 0 ? explained[bin] * (e->plan.tapers - 1) / rest[bin] : 0;
    return status;
}

/* Bins per independent value: L sum_i (sum_k v_k^2)^2/K. */
static void multitaper_correlation(const estimation *e, imk_spectrum *s)
{
    const size_t length = e->plan.length;
    double sum = 0;
    for (size_t i = 0; i < length; i++) {
        double energy = 0;
        for (int k = 0; k < e->plan.tapers; k++) {
            const double v = e->windows[(size_t)k * length + i];
            energy += v * v;
        }
        sum += energy * energy;
    }
    s->correlation = (double)length * sum / e->plan.tapers;
}

/* ---- the whole ------------------------------------------------------------------------------- */

/* The first finite sample is the offset; the mean; whether any other differs from it. */
static imk_status inspect(estimation *e, imk_spectrum *s, imk_error *error)
{
    size_t finite = 0, different = 0;
    double sum = 0;
    for (size_t i = 0; i < e->plan.n; i++) {
        if (!isfinite(e->samples[i]))
            continue;
        if (finite++ == 0)
            e->offset = e->samples[i];
        different += e->samples[i] != e->offset;
        sum += e->samples[i] - e->offset;
    }
    if (finite == 0)
        return imk_error_set(error, IMK_ERROR_GAP, "samples", "no sample is finite",
                             "a record with finite samples");
    if (different == 0)
        return imk_error_set(error, IMK_ERROR_CONSTANT, "samples", "", "use samples that vary");
    s->mean = e->offset + sum / (double)finite;
    return IMK_OK;
}

static void finish(const estimation *e, imk_spectrum *s, const usage *u)
{
    const imk_spectrum_settings *settings = e->plan.settings;
    if (settings->method == IMK_SPECTRUM_WELCH)
        welch_degrees(e, s, u);
    else
        multitaper_correlation(e, s);
    for (size_t bin = 0; bin < s->count; bin++)
        s->density[bin] /= (double)u->used;
    /* The transform is real at both ends. */
    s->degrees[0] *= 0.5;
    s->degrees[s->count - 1] *= 0.5;
    s->segments = u->used;
    s->left_out = e->plan.count - u->used;
    const size_t apart = e->plan.hop < e->plan.length ? e->plan.hop : e->plan.length;
    s->fraction_used = (double)u->covered / (double)((e->plan.count - 1) * apart + e->plan.length);
    s->noise_bandwidth = imki_window_bandwidth(settings) * s->step;
    s->blur = imki_window_blur(settings, s->length, e->windows) * s->step;
    s->blur_bins = imki_window_lobe(settings);
}

imk_status imk_spectrum_estimate(const imk_spectrum_settings *settings, size_t n,
                                 const double *samples, imk_spectrum *spectrum, double *density,
                                 double *degrees, double *harmonic, void *workspace,
                                 size_t workspace_size, imk_error *error)
{
    estimation e = {.samples = samples};
    usage u = {0};
    imk_status status = imki_segments_plan(settings, n, &e.plan, error);
    if (status != IMK_OK)
        return status;
    if (!workspace || workspace_size < lay_out(&e, NULL))
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "workspace", "",
                             "imk_spectrum_workspace_size() bytes");
    lay_out(&e, workspace);
    const bool welch = settings->method == IMK_SPECTRUM_WELCH;
    imk_spectrum s = {.dt = settings->dt,
                      .count = e.plan.length / 2 + 1,
                      .step = 1 / ((double)e.plan.length * settings->dt),
                      .density = density,
                      .degrees = degrees,
                      .harmonic = welch || e.plan.tapers < 2 ? NULL : harmonic,
                      .length = e.plan.length,
                      .hop = e.plan.hop};
    status = inspect(&e, &s, error);
    if (status != IMK_OK)
        return status;
    memset(density, 0, s.count * sizeof *density);
    memset(degrees, 0, s.count * sizeof *degrees);
    status = welch ? estimate_welch(&e, &s, &u) : estimate_multitaper(&e, &s, &u);
    if (status != IMK_OK)
        return imk_error_set(error, status, "workspace", "", "");
    if (u.used == 0)
        return imk_error_set(error, IMK_ERROR_GAP, "samples", "every segment has missing samples",
                             "use shorter segments, which means a coarser resolution");
    finish(&e, &s, &u);
    for (size_t bin = 0; bin < s.count; bin++)
        if (!(density[bin] < HUGE_VAL))
            return imk_error_set(error, IMK_ERROR_NOT_FINITE, "samples", "",
                                 "leave out samples whose squares overflow");
    *spectrum = s;
    return IMK_OK;
}
