/* SPDX-License-Identifier: Apache-2.0 */
/* From the design of a MEMS accelerometer to its error model. */
#include "base/algebra/linear_system_internal.h"
#include "mems_accelerometer_internal.h"

#include <math.h>

enum { SCAN = 2000, BISECTIONS = 60 };

typedef struct complex_number {
    double re, im;
} complex_number;

static complex_number quotient(complex_number a, complex_number b)
{
    const double size = b.re * b.re + b.im * b.im;
    return (complex_number){(a.re * b.re + a.im * b.im) / size, (a.im * b.re - a.re * b.im) / size};
}

typedef struct chain {
    const imk_mems_accelerometer *design;
    imki_mems_point point;
    imk_mems_gains gains; /* of the controller; of the sigma-delta loop likewise */
    double amplifier;     /* [rad/s]; 0: none */
} chain;

static chain chain_of(const imk_mems_accelerometer *d)
{
    chain c = {.design = d, .point = imki_mems_operating_point(d)};
    if (d->loop == IMK_MEMS_ANALOG) {
        c.gains = imk_mems_accelerometer_gains(d);
        c.amplifier = 2.0 * IMKI_PI * d->amplifier;
    } else if (d->loop == IMK_MEMS_SIGMA_DELTA) {
        const double gain = imk_mems_accelerometer_quantizer(d).gain * c.point.a1;
        c.gains = (imk_mems_gains){gain, gain * d->lead / d->clock, gain * d->integral * d->clock};
    }
    return c;
}

/* Reading over specific force at w [rad/s], w > 0. */
static complex_number response(const chain *c, double w)
{
    const imk_mems_accelerometer *d = c->design;
    const complex_number mass = {c->point.a1 - w * w, c->point.damping * w};
    complex_number h;
    if (d->loop == IMK_MEMS_OPEN) {
        h = quotient((complex_number){c->point.a1, 0.0}, mass);
    } else {
        complex_number loop = {c->gains.proportional,
                               c->gains.derivative * w - c->gains.integral / w};
        if (c->amplifier > 0.0) {
            const complex_number stage = {1.0, w / c->amplifier};
            loop = quotient(quotient(loop, stage), stage);
        }
        h = quotient(loop, (complex_number){mass.re + loop.re, mass.im + loop.im});
    }
    if (d->output_bandwidth > 0.0) {
        const double r = w / (2.0 * IMKI_PI * d->output_bandwidth);
        h = quotient(h, (complex_number){1.0 - r * r, 1.41421356237309505 * r});
    }
    return h;
}

static double power(const chain *c, double w)
{
    const complex_number h = response(c, w);
    return h.re * h.re + h.im * h.im;
}

/* The lowest frequency at which the power has fallen to half that at low frequency [rad/s]. */
static double half_power(const chain *c, double low)
{
    const double half = 0.5 * power(c, low);
    double below = low;
    for (int i = 0; i < SCAN; i++) {
        const double above = below * 1.02;
        if (power(c, above) < half) {
            double high = above;
            for (int j = 0; j < BISECTIONS; j++) {
                const double middle = 0.5 * (below + high);
                *(power(c, middle) < half ? &high : &below) = middle;
            }
            return high;
        }
        below = above;
    }
    return 0.0;
}

/* Half-power frequency over undamped frequency of a second-order filter. */
static double bandwidth_ratio(double damping)
{
    const double b = 1.0 - 2.0 * damping * damping;
    return sqrt(b + sqrt(b * b + 1.0));
}

/* The second-order filter with this half-power frequency whose power at half of it is as given;
 * that falls with the damping. */
static double damping_for(double power_at_half)
{
    double low = 0.05, high = 20.0;
    for (int i = 0; i < BISECTIONS; i++) {
        const double middle = 0.5 * (low + high);
        const double r = 0.5 * bandwidth_ratio(middle), real = 1.0 - r * r;
        const double found = 1.0 / (real * real + 4.0 * middle * middle * r * r);
        *(found > power_at_half ? &low : &high) = middle;
    }
    return high;
}

static void set_bandwidth(const imk_mems_accelerometer *d, imk_triad *triad)
{
    const chain c = chain_of(d);
    /* far below all corners */
    const double low = 2.0 * IMKI_PI * 1e-4 * d->frequency, w = half_power(&c, low);
    if (!(w > 0.0))
        return;
    triad->bandwidth.value[0] = w / (2.0 * IMKI_PI);
    triad->damping.value[0] = damping_for(power(&c, 0.5 * w) / power(&c, low));
}

static double reduced_range(const imk_mems_accelerometer *d)
{
    const double limit = imk_mems_accelerometer_limit(d);
    return d->range > 0.0 && d->range < limit ? d->range : limit;
}

/* Rms velocity of the mass in an analog loop: the stationary covariance of the linear system. */
static double loop_velocity(const imk_mems_accelerometer *d, const imki_mems_point *p)
{
    imki_mems_system system;
    double covariance[IMKI_MEMS_STATES * IMKI_MEMS_STATES];
    imki_mems_linear_system(d, p, false, &system);
    /* a thousand times the slowest of springs, loop and integral part */
    const double slowest = d->reset > 0.0 && d->reset < d->frequency ? d->reset : d->frequency;
    imki_step_covariance(system.n, system.a, system.w, 1e3 / slowest, covariance);
    return sqrt(covariance[IMKI_VELOCITY * system.n + IMKI_VELOCITY]);
}

/* What the mean of a loop's force over a sample and the input differ by is the change of the
 * mass's momentum: noise of the readings of velocity, unless a filter takes it away. */
static void set_loop_noise(const imk_mems_accelerometer *d, const imki_mems_point *p,
                           imk_triad *triad)
{
    const bool clocked = d->loop == IMK_MEMS_SIGMA_DELTA;
    if (clocked && imki_mems_locked(d))
        triad->dead_band.value[0] = imk_mems_accelerometer_limit_cycle(d).dead_zone;
    if (!(d->output_bandwidth > 0.0))
        triad->noise.reading_noise.value[0] =
            clocked ? imk_mems_accelerometer_quantizer(d).velocity : loop_velocity(d, p);
}

void imki_mems_accelerometer_reduce(const imk_mems_accelerometer *d, imk_triad *triad)
{
    const imki_mems_point p = imki_mems_operating_point(d);
    const imki_mems_static e = imki_mems_static_errors(d, &p);
    triad->scale_factor.fixed.value[0] = e.scale;
    triad->scale_factor.temperature.coefficient[0].value[0] = e.scale_temperature;
    triad->nonlinearity.k2.value[0] = e.k2;
    triad->nonlinearity.k3.value[0] = e.k3;
    triad->bias.fixed.value[0] = e.bias;
    const double seen = imki_reduction_offset(triad, d->bias, e.bias_temperature);
    triad->bias.repeatability.value[0] = seen * d->bias_repeatability;
    triad->noise.bias_instability.value[0] = seen * d->bias_instability;
    triad->noise.density = IMK_DENSITY_TWO_SIDED;
    triad->noise.white.value[0] = imki_mems_white(d, &p);
    triad->scale_factor.repeatability.value[0] = d->gain_repeatability;
    triad->cross_axis.value[0][1] = seen * d->tilt_y;
    triad->cross_axis.value[0][2] = seen * d->tilt_z;
    triad->range.value[0] = reduced_range(d);
    triad->resolution.value[0] = d->resolution;
    set_bandwidth(d, triad);
    if (d->loop != IMK_MEMS_OPEN)
        set_loop_noise(d, &p, triad);
    imk_temperature_polynomial *const polynomials[2] = {&triad->bias.temperature,
                                                        &triad->scale_factor.temperature};
    for (int i = 0; i < 2; i++) {
        if (polynomials[i]->coefficient[0].value[0] == 0.0)
            continue;
        polynomials[i]->order = 1;
        imki_temperature_range(polynomials[i], d->temperature);
    }
}
