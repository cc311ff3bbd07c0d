/* SPDX-License-Identifier: Apache-2.0 */
/* The sigma-delta loop of a MEMS accelerometer, from clock to clock:
 *
 *     s[k+1] = phi s[k] + gamma unit b[k],   s = (position, velocity)
 *     y[k]   = (1 + c)(x[k] + n[k]) - c (x[k-1] + n[k-1]) + i sum_{j<=k} (x[j] + n[j])
 *     b[k]   = -sign y[k]
 *
 * Without noise and input it goes through a cycle of p clocks of +1 and p of -1. Half a cycle turns
 * the state into its negative, s0 = -(I + phi^p)^-1 (I + phi + ... + phi^(p-1)) gamma unit; a cycle
 * is possible when every sign agrees, and of several the one with the largest margin withstands
 * most: the loop falls into it. */
#include "base/algebra/linear_system_internal.h"
#include "mems_accelerometer_internal.h"

#include <math.h>
#include <string.h>

enum { LONGEST = 32, STATES = 4, DOUBLINGS = 60, BISECTIONS = 80 };

typedef struct clocked_mass {
    double phi[4], gamma[2], noise[4];
    double unit, stiffness;
} clocked_mass;

static clocked_mass plant_of(const imk_mems_accelerometer *d)
{
    const imki_mems_point p = imki_mems_operating_point(d);
    const double a[4] = {0.0, 1.0, -p.a1, -p.damping}, b[2] = {0.0, 1.0};
    const double w[4] = {0.0, 0.0, 0.0,
                         2.0 * IMKI_BOLTZMANN * d->temperature * p.damping / d->mass};
    clocked_mass plant = {.unit = p.unit, .stiffness = p.a1};
    imki_discretise(2, 1, a, b, 1.0 / d->clock, plant.phi, plant.gamma);
    imki_step_covariance(2, a, w, 1.0 / d->clock, plant.noise);
    return plant;
}

static void advance(const clocked_mass *plant, double force, double s[2])
{
    const double x = s[0], v = s[1];
    s[0] = plant->phi[0] * x + plant->phi[1] * v + plant->gamma[0] * force;
    s[1] = plant->phi[2] * x + plant->phi[3] * v + plant->gamma[1] * force;
}

/* The state at the first clock of +1 in a cycle of half period p. */
static void cycle_start(const clocked_mass *plant, int p, double s[2])
{
    double sum[2] = {0.0, 0.0}, one[2] = {1.0, 0.0}, two[2] = {0.0, 1.0};
    for (int k = 0; k < p; k++) {
        advance(plant, plant->unit, sum);
        advance(plant, 0.0, one);
        advance(plant, 0.0, two);
    }
    const double a = 1.0 + one[0], b = two[0], c = one[1], d = 1.0 + two[1];
    const double determinant = a * d - b * c;
    s[0] = -(d * sum[0] - b * sum[1]) / determinant;
    s[1] = -(a * sum[1] - c * sum[0]) / determinant;
}

/* Smallest -y over the clocks of +1, which must be positive; *amplitude the largest |x|. */
static double smallest_margin(const clocked_mass *plant, double lead, int p, double *amplitude)
{
    double s[2], smallest = HUGE_VAL;
    cycle_start(plant, p, s);
    /* the clock before is the last of -1: the negative of the state p - 1 clocks on */
    double last[2] = {s[0], s[1]};
    for (int k = 1; k < p; k++)
        advance(plant, plant->unit, last);
    double before = -last[0];
    *amplitude = 0.0;
    for (int k = 0; k < p; k++) {
        const double margin = -((1.0 + lead) * s[0] - lead * before);
        smallest = margin < smallest ? margin : smallest;
        *amplitude = fabs(s[0]) > *amplitude ? fabs(s[0]) : *amplitude;
        before = s[0];
        advance(plant, plant->unit, s);
    }
    return smallest;
}

imk_mems_limit_cycle imk_mems_accelerometer_limit_cycle(const imk_mems_accelerometer *d)
{
    const clocked_mass plant = plant_of(d);
    imk_mems_limit_cycle best = {0};
    double largest = 0.0;
    for (int p = 1; p <= LONGEST; p++) {
        double amplitude;
        const double margin = smallest_margin(&plant, d->lead, p, &amplitude);
        if (!(margin > largest))
            continue;
        largest = margin;
        best = (imk_mems_limit_cycle){p, amplitude, plant.stiffness * margin};
    }
    return best;
}

bool imki_mems_locked(const imk_mems_accelerometer *d)
{
    /* of y + lead (y - y before); at 6 sigma one clock in 1e9 takes another bit, which frees the
     * loop for long */
    const double lead = d->lead, own = sqrt((1.0 + lead) * (1.0 + lead) + lead * lead);
    const double noise = own * d->pickoff_noise * sqrt(0.5 * d->clock);
    const double margin =
        imk_mems_accelerometer_limit_cycle(d).dead_zone / imki_mems_operating_point(d).a1;
    return !(d->integral > 0.0) && 6.0 * noise < margin;
}

/* ---- with noise ------------------------------------------------------------------------------ */

static void multiply(const double a[STATES][STATES], const double b[STATES][STATES], bool transpose,
                     double product[STATES][STATES])
{
    for (int i = 0; i < STATES; i++)
        for (int j = 0; j < STATES; j++) {
            product[i][j] = 0.0;
            for (int k = 0; k < STATES; k++)
                product[i][j] += a[i][k] * (transpose ? b[j][k] : b[k][j]);
        }
}

/* P = A P A^T + Q by doubling; false when the loop is not stable. */
static bool stationary(double a[STATES][STATES], double q[STATES][STATES])
{
    for (int i = 0; i < DOUBLINGS; i++) {
        double left[STATES][STATES], square[STATES][STATES], size = 0.0;
        multiply((const double(*)[STATES])a, (const double(*)[STATES])q, false, left);
        multiply((const double(*)[STATES])left, (const double(*)[STATES])a, true, square);
        for (int j = 0; j < STATES; j++)
            for (int k = 0; k < STATES; k++)
                q[j][k] += square[j][k];
        multiply((const double(*)[STATES])a, (const double(*)[STATES])a, false, square);
        memcpy(a, square, sizeof square);
        for (int j = 0; j < STATES; j++)
            for (int k = 0; k < STATES; k++)
                size += fabs(a[j][k]);
        if (!(size < 1e100))
            return false;
        if (size < 1e-12)
            return true;
    }
    return false;
}

/* Standard deviation of y when the quantizer is a gain for an input of deviation s, infinite when
 * that loop is not stable; *velocity that of the mass. Positions are in units of `scale`, those of
 * one clock's force, so that the entries are of one size. */
static double deviation_for(const imk_mems_accelerometer *d, const clocked_mass *plant, double s,
                            double *velocity)
{
    const double h = 1.0 / d->clock, scale = plant->unit * h * h;
    const double gain = sqrt(2.0 / IMKI_PI) / s * scale, rest = 1.0 - 2.0 / IMKI_PI;
    const double now = 1.0 + d->lead + d->integral;
    const double row[STATES] = {now, 0.0, -d->lead, d->integral};
    const double gx = plant->gamma[0] / (h * h), gv = plant->gamma[1] / h;
    const double n = d->pickoff_noise * sqrt(0.5 * d->clock) / scale;
    double a[STATES][STATES] = {{plant->phi[0], plant->phi[1] / h, 0.0, 0.0},
                                {plant->phi[2] * h, plant->phi[3], 0.0, 0.0},
                                {1.0, 0.0, 0.0, 0.0},
                                {1.0, 0.0, 0.0, d->integral > 0.0 ? 1.0 : 0.0}};
    for (int j = 0; j < STATES; j++) {
        a[0][j] -= gx * gain * row[j];
        a[1][j] -= gv * gain * row[j];
    }
    const double from_noise[STATES] = {-gx * gain * now * n, -gv * gain * now * n, n, n};
    const double from_quantizer[STATES] = {gx, gv, 0.0, 0.0};
    const double unit2 = scale * scale;
    double q[STATES][STATES] = {
        {plant->noise[0] / unit2, plant->noise[1] * h / unit2, 0.0, 0.0},
        {plant->noise[2] * h / unit2, plant->noise[3] * h * h / unit2, 0.0, 0.0}};
    for (int i = 0; i < STATES; i++)
        for (int j = 0; j < STATES; j++)
            q[i][j] += from_noise[i] * from_noise[j] + rest * from_quantizer[i] * from_quantizer[j];
    if (!stationary(a, q))
        return HUGE_VAL;
    double variance = now * now * n * n;
    for (int i = 0; i < STATES; i++)
        for (int j = 0; j < STATES; j++)
            variance += row[i] * q[i][j] * row[j];
    *velocity = sqrt(q[1][1]) * scale / h;
    return sqrt(variance) * scale;
}

imk_mems_quantizer imk_mems_accelerometer_quantizer(const imk_mems_accelerometer *d)
{
    const clocked_mass plant = plant_of(d);
    const double one = plant.unit / (d->clock * d->clock);
    double low = 1e-6 * one, high = 1e6 * one, velocity = 0.0;
    for (int i = 0; i < BISECTIONS; i++) {
        const double middle = sqrt(low * high);
        const double found = deviation_for(d, &plant, middle, &velocity);
        if (found > middle)
            low = middle;
        else
            high = middle;
    }
    (void)deviation_for(d, &plant, high, &velocity);
    const double gain = sqrt(2.0 / IMKI_PI) / high * plant.unit / plant.stiffness;
    /* no gain below the upper end holds the mass */
    if (!(high < 1e5 * one))
        velocity = HUGE_VAL;
    imk_mems_quantizer q = {.deviation = high, .gain = gain, .velocity = velocity};
    if (!(d->integral > 0.0))
        q.quantization = plant.unit * sqrt((1.0 - 2.0 / IMKI_PI) / d->clock) / fabs(1.0 + gain);
    return q;
}
