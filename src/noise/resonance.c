/* SPDX-License-Identifier: Apache-2.0 */
/* Structural resonance: x'' + (w/Q) x' + w^2 x = drive * white noise, point-sampled.
 *
 * With X[k+1] = phi X[k] + e[k], t = tr phi, d = det phi, the samples obey
 *
 *     x[k] - t x[k-1] + d x[k-2] = e_x[k-1] + ((phi - t) e)_x[k-2],
 *
 * an ARMA(2,1). The drive that gives the standard deviation sigma is sigma sqrt(2 w^3/Q). */
#include "arma_internal.h"
#include "noise_terms_internal.h"

static imki_dynamics resonance_dynamics(imk_resonance resonance)
{
    double omega = 2.0 * IMKI_PI * resonance.frequency;
    double drive = resonance.sigma * omega * sqrt(2.0 * omega / resonance.q);
    return imki_second_order(omega, 0.5 / resonance.q, drive);
}

double imk_resonance_allan_variance(imk_resonance resonance, double tau)
{
    imki_dynamics dynamics = resonance_dynamics(resonance);
    imki_stretch stretch = imki_stretch_of_time(&dynamics, tau);
    return imki_half_difference(&dynamics, &stretch) / (tau * tau);
}

double imk_resonance_sampled_allan_variance(imk_resonance resonance, double dt, size_t n)
{
    imki_dynamics dynamics = resonance_dynamics(resonance);
    imki_stretch stretch = imki_stretch_of_samples(&dynamics, dt, n);
    return imki_half_difference(&dynamics, &stretch) / ((double)n * (double)n);
}

static imk_status check(imk_resonance resonance, double dt)
{
    imk_status status = imki_check_noise(resonance.sigma, dt);
    if (status != IMK_OK)
        return status;
    if (!isfinite(resonance.frequency) || !isfinite(resonance.q))
        return IMK_ERROR_NOT_FINITE;
    double relative = resonance.frequency * dt;
    bool fits = relative >= 1e-6 && relative <= 1e6 && resonance.q > 0.5 && resonance.q <= 1e6;
    return fits ? IMK_OK : IMK_ERROR_RANGE;
}

imk_status imk_resonance_arma(imk_resonance resonance, double dt, imk_arma *arma)
{
    imk_status status = check(resonance, dt);
    if (status != IMK_OK)
        return status;
    imki_dynamics dynamics = resonance_dynamics(resonance);
    imki_stretch s = imki_stretch_of_samples(&dynamics, dt, 1);
    const double now[3] = {1.0, 0.0, 0.0}, before[3] = {-s.phi[1][1], s.phi[0][1], 0.0};
    double autocovariance[3] = {imki_covariance(&s, now, now) + imki_covariance(&s, before, before),
                                imki_covariance(&s, now, before), 0.0};
    *arma = imki_arma_design(autocovariance, &dynamics, dt);
    arma->variance = resonance.sigma * resonance.sigma;
    arma->decrement = imki_half_difference(&dynamics, &s);
    return IMK_OK;
}

double imk_resonance_sampled_spectrum(imk_resonance resonance, double dt, double frequency)
{
    imk_arma arma;
    if (imk_resonance_arma(resonance, dt, &arma) != IMK_OK)
        return (double)NAN;
    return imk_arma_spectrum(&arma, frequency);
}

imk_status imk_resonance_start(imk_arma_state *state, imk_resonance resonance, double dt,
                               imk_random random, uint64_t stream)
{
    imk_arma arma;
    imk_status status = imk_resonance_arma(resonance, dt, &arma);
    return status == IMK_OK ? imk_arma_start(state, &arma, random, stream) : status;
}

static imk_resonance resonance_at(imki_term_place place)
{
    const struct imk_resonance_term *term = &place.triad->noise.resonance[place.instance];
    return (imk_resonance){term->sigma.value[place.axis], term->frequency.value[place.axis],
                           term->q.value[place.axis]};
}

static double strength(imki_term_place place)
{
    return resonance_at(place).sigma;
}

static double frequency(imki_term_place place)
{
    return resonance_at(place).frequency;
}

static imk_status start(void *state, imki_term_place place, double dt, imk_random random,
                        uint64_t stream)
{
    return imk_resonance_start(state, resonance_at(place), dt, random, stream);
}

static const imki_generator generator = {.state_size = IMKI_STATE_SIZE(imk_arma_state),
                                         .start = start,
                                         .field = "noise.resonance",
                                         .refused = frequency,
                                         .across = imki_arma_across};

static int count(const imk_noise *noise)
{
    return noise->resonance_count;
}

static size_t processes(imki_term_place place, double dt, imki_process *process)
{
    (void)dt;
    const size_t one = imki_one_process(process, IMKI_PROCESS_RESONANCE, strength(place));
    process->frequency = frequency(place);
    process->q = resonance_at(place).q;
    return one;
}

static double mean_variance(imki_term_place place, double dt, double time)
{
    (void)dt;
    return imk_resonance_allan_variance(resonance_at(place), time);
}

const imki_noise_term imki_resonance_term = {.path = {"noise.resonance", "noise.resonance"},
                                             .text = {"gyro resonance", "accelerometer resonance"},
                                             .stream = IMK_TERM_RESONANCE,
                                             .count = count,
                                             .strength = strength,
                                             .generator = &generator,
                                             .processes = processes,
                                             .mean_variance = mean_variance};
