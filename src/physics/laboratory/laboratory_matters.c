/* SPDX-License-Identifier: Apache-2.0 */
/* How large a difference of each figure has to be to matter, and what a comparison says. */
#include "laboratory_internal.h"

#include "base/algebra/vector_internal.h"
#include "imukit/distributions.h"
#include "imukit/units.h"

#include <math.h>
#include <string.h>

/* A figure u^p f^q T^r times its unit is compared with what the reading changes from run to run. */
typedef struct kind {
    const char *key;    /* beginning of it */
    int input;          /* power of full scale */
    int force;          /* power of 1 g */
    double temperature; /* 20 K of the chamber, 0.01 K/s of its ramp; 1 */
} kind;

static const kind kinds[] = {
    {"bias.fixed", 0, 0, 1.0},         {"bias.temperature_rate", 0, 0, 0.01},
    {"bias.temperature", 0, 0, 20.0},  {"scale_factor.temperature", 1, 0, 20.0},
    {"scale_factor.fixed", 1, 0, 1.0}, {"nonlinearity.k2", 2, 0, 1.0},
    {"nonlinearity.koq", 2, 0, 1.0},   {"nonlinearity.k3", 3, 0, 1.0},
    {"asymmetry", 1, 0, 1.0},          {"nonlinearity.asymmetry", 1, 0, 1.0},
    {"g_sensitivity", 0, 1, 1.0},      {"g2_sensitivity", 0, 2, 1.0},
    {"cross_products", 0, 2, 1.0},     {"dead_band", 0, 0, 1.0}};

static double power(double x, int n)
{
    double product = 1.0;
    for (; n > 0; n--)
        product *= x;
    return product;
}

/* Noise that is not stated: what it does to a mean of 1 s, or, a random walk, in an hour. In units
 * of seconds, Q, A and N make the same of it. */
static double of_noise(const char *key, double bias)
{
    const double hour = 3600.0;
    return strstr(key, "rate_random_walk") || strstr(key, "acceleration_random_walk")
               ? bias / sqrt(hour)
               : bias;
}

/* What the reading changes from run to run, in units of the figure. */
static double run_to_run(const imki_bench *b, const char *key)
{
    const bool gyro = b->laboratory->instrument->sensor == IMK_GYRO;
    const double scale = b->result->full_scale, g = IMK_STANDARD_GRAVITY;
    if (strncmp(key, "misalignment", 12) == 0)
        return gyro ? hypot(b->bias / scale, b->scale) : hypot(b->bias / g, b->scale);
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        const kind *k = &kinds[i];
        if (strncmp(key, k->key, strlen(k->key)) != 0)
            continue;
        const double input = k->input > 0 ? scale : k->force > 0 && !gyro ? g : 0.0;
        return hypot(b->bias, b->scale * input) /
               (power(scale, k->input) * power(g, k->force) * k->temperature);
    }
    return strncmp(key, "noise.", 6) == 0 ? of_noise(key, b->bias) : 0.0;
}

size_t imki_figure_of(const imki_bench *bench, const char *key)
{
    size_t i = 0;
    while (i + 1 < bench->result->figure_count && strcmp(bench->computed[i].key, key) != 0)
        i++;
    return i;
}

void imki_matters(imki_bench *bench, const imk_model *reduced)
{
    imk_laboratory_result *r = bench->result;
    const int sensor = bench->laboratory->instrument->sensor;
    const imk_triad *t = sensor == IMK_GYRO ? &reduced->gyro : &reduced->accel;
    bench->bias = t->bias.repeatability.value[0];
    if (!(bench->bias > 0.0))
        bench->bias = t->noise.bias_instability.value[0];
    bench->scale = t->scale_factor.repeatability.value[0];
    r->figure_count = imk_laboratory_figures(reduced, sensor, bench->computed);
    bench->white = t->noise.white.value[0];
    bench->rounding = t->noise.quantization.value[0];
    bench->ranged = sensor == IMK_ACCEL || t->range.value[0] > 0.0;
    for (size_t i = 0; i < r->figure_count; i++) {
        const double size = fabs(bench->computed[i].value);
        const bool noise = strncmp(bench->computed[i].key, "noise.", 6) == 0;
        r->matters[i] =
            noise && size > 0.0 ? size : fmax(size, run_to_run(bench, bench->computed[i].key));
    }
}

/* ---- verdicts -------------------------------------------------------------------------------- */

static const double false_alarms = 1e-4, room = 0.3, sigmas = 3.0, close = 0.1, equal = 0.01;

const char *imk_laboratory_verdict_text(imk_laboratory_verdict verdict)
{
    static const char *const texts[] = {"agrees", "close", "differs", "cannot tell",
                                        "not measured"};
    return texts[verdict];
}

imk_laboratory_verdict imk_laboratory_compare(const imk_laboratory_figure *computed,
                                              const imk_laboratory_figure *found, double matters,
                                              const imk_laboratory_effort *effort)
{
    const double difference = fabs(found->value - computed->value), sigma = found->sigma;
    if (!(effort->seconds > 0.0) || !isfinite(found->value) || !isfinite(sigma))
        return IMK_LABORATORY_NOT_MEASURED;
    const double chance = sigma * imk_student_quantile(1.0 - 0.5 * false_alarms, effort->freedom);
    if (difference > chance && difference > equal * matters)
        return difference <= close * matters ? IMK_LABORATORY_CLOSE : IMK_LABORATORY_DIFFERS;
    return difference + sigmas * sigma <= room * matters ? IMK_LABORATORY_AGREES
                                                         : IMK_LABORATORY_CANNOT_TELL;
}
