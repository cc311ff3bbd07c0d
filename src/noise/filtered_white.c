/* SPDX-License-Identifier: Apache-2.0 */
/* White noise through the sensor's output filter, averaged over each sample.
 *
 * The state (x, v) of the filter goes from sample to sample as X[k+1] = phi X[k] + e[k]; the output
 * is y[k] = (g X[k] + n[k])/dt, n the noise's own share of the integral. With t = tr phi and
 * d = det phi, Cayley and Hamilton remove X:
 *
 *     dt (y[k] - t y[k-1] + d y[k-2]) = n[k] + (g e - t n)[k-1] + (g (phi - t) e + d n)[k-2],
 *
 * a moving average of three independent triples, whose autocovariances give B. Relative to that of
 * plain white noise nothing cancels, so both limits are reached: white for a bandwidth far above
 * the rate, the continuous filter far below. */
#include "arma_internal.h"
#include "noise_terms_internal.h"

/* w of the filter from its -3 dB point f: second order, with r = (2 pi f/w)^2,
 * (1 - r)^2 + 4 damping^2 r = 2, whose positive root is r = m + sqrt(m^2 + 1), m = 1 - 2 damping^2.
 */
static imki_dynamics filter_dynamics(double density, imk_low_pass filter)
{
    double cutoff = 2.0 * IMKI_PI * filter.bandwidth;
    if (filter.damping == 0.0)
        return imki_first_order(cutoff, density * cutoff);
    double m = 1.0 - 2.0 * filter.damping * filter.damping;
    double root = sqrt(m * m + 1.0);
    double ratio = m > 0.0 ? m + root : 1.0 / (root - m); /* no cancellation either way */
    double omega = cutoff / sqrt(ratio);
    return imki_second_order(omega, filter.damping, density * omega * omega);
}

double imk_filtered_white_sampled_allan_variance(double density, imk_low_pass filter, double dt,
                                                 size_t n)
{
    if (filter.bandwidth == 0.0)
        return imk_white_sampled_allan_variance(density, dt, n);
    double tau = (double)n * dt;
    imki_dynamics dynamics = filter_dynamics(density, filter);
    imki_stretch stretch = imki_stretch_of_time(&dynamics, tau);
    return imki_half_difference(&dynamics, &stretch) / (tau * tau);
}

static imk_status check_low_pass(imk_low_pass filter, double dt)
{
    if (!isfinite(filter.bandwidth) || !isfinite(filter.damping))
        return IMK_ERROR_NOT_FINITE;
    double relative = filter.bandwidth * dt;
    bool bandwidth_fits = filter.bandwidth == 0.0 || (relative >= 1e-6 && relative <= 1e6);
    bool damping_fits = filter.damping == 0.0 || (filter.damping >= 0.05 && filter.damping <= 50.0);
    return bandwidth_fits && damping_fits ? IMK_OK : IMK_ERROR_RANGE;
}

imk_status imki_low_pass_over(imk_low_pass filter, double time, imki_stretch *stretch)
{
    const imk_status status = check_low_pass(filter, time);
    const imki_dynamics dynamics = filter_dynamics(1.0, filter);
    if (status == IMK_OK)
        *stretch = imki_stretch_of_time(&dynamics, time);
    return status;
}

static imk_status check(double density, imk_low_pass filter, double dt)
{
    imk_status status = imki_check_noise(density, dt);
    return status == IMK_OK ? check_low_pass(filter, dt) : status;
}

imk_status imk_filtered_white_arma(double density, imk_low_pass filter, double dt, imk_arma *arma)
{
    imk_status status = check(density, filter, dt);
    if (status != IMK_OK)
        return status;
    if (filter.bandwidth == 0.0) {
        double sigma = density / sqrt(dt);
        *arma = (imk_arma){.dt = dt,
                           .b0 = sigma,
                           .distance = {1.0, 1.0},
                           .variance = sigma * sigma,
                           .decrement = sigma * sigma};
        return IMK_OK;
    }
    imki_dynamics dynamics = filter_dynamics(density, filter);
    imki_stretch s = imki_stretch_of_time(&dynamics, dt);
    double trace = s.phi[0][0] + s.phi[1][1];
    double determinant = imk_exp(-(dynamics.rate[0] + dynamics.rate[1]) * dt);
    /* phi - t is minus the adjugate of phi; of order 1 it is zero on x */
    bool first = dynamics.order == 1;
    const double form[3][3] = {{0.0, 0.0, 1.0},
                               {s.g[0], s.g[1], -trace},
                               {first ? 0.0 : s.g[1] * s.phi[1][0] - s.g[0] * s.phi[1][1],
                                first ? 0.0 : s.g[0] * s.phi[0][1] - s.g[1] * s.phi[0][0],
                                determinant}};
    double autocovariance[3] = {0.0};
    for (int lag = 0; lag < 3; lag++) {
        for (int i = lag; i < 3; i++)
            autocovariance[lag] += imki_covariance(&s, form[i], form[i - lag]);
        autocovariance[lag] /= dt * dt;
    }
    *arma = imki_arma_design(autocovariance, &dynamics, dt);
    double variance[2];
    imki_stationary(&dynamics, variance);
    arma->variance =
        (s.g[0] * s.g[0] * variance[0] + s.g[1] * s.g[1] * variance[1] + s.q[2][2]) / (dt * dt);
    arma->decrement = imki_half_difference(&dynamics, &s) / (dt * dt);
    return IMK_OK;
}

double imk_filtered_white_sampled_spectrum(double density, imk_low_pass filter, double dt,
                                           double frequency)
{
    imk_arma arma;
    if (imk_filtered_white_arma(density, filter, dt, &arma) != IMK_OK)
        return (double)NAN;
    return imk_arma_spectrum(&arma, frequency);
}

imk_status imk_filtered_white_start(imk_arma_state *state, double density, imk_low_pass filter,
                                    double dt, imk_random random, uint64_t stream)
{
    imk_arma arma;
    imk_status status = imk_filtered_white_arma(density, filter, dt, &arma);
    return status == IMK_OK ? imk_arma_start(state, &arma, random, stream) : status;
}

static double bandwidth(imki_term_place place)
{
    return place.triad->bandwidth.value[place.axis];
}

static imk_status start(void *state, imki_term_place place, double dt, imk_random random,
                        uint64_t stream)
{
    const imk_low_pass filter = {bandwidth(place), place.triad->damping.value[place.axis]};
    return imk_filtered_white_start(state, place.triad->noise.white.value[place.axis], filter, dt,
                                    random, stream);
}

const imki_generator imki_filtered_white = {.state_size = IMKI_STATE_SIZE(imk_arma_state),
                                            .start = start,
                                            .field = "bandwidth",
                                            .refused = bandwidth,
                                            .across = imki_arma_across};
