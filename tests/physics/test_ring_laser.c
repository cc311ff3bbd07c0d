/* SPDX-License-Identifier: Apache-2.0 */
/* The ring laser gyro: check values, lock-in with and without dither, levels, noise, readout,
 * chain.
 *
 * Statistical tests have a fixed seed and limits of five standard deviations (false alarms 6e-7).
 */
#define _POSIX_C_SOURCE 200809L /* setenv */

#include "instrument_run.h"

#include "imukit/ring_laser.h"
#include "imukit/units.h"

static const double pi = 3.14159265358979324;
static const double degree = 3.14159265358979324 / 180.0;
static const double degree_per_hour = 3.14159265358979324 / 180.0 / 3600.0;
static const imk_instrument *const laser = &imk_ring_laser_instrument;

/* Signals by place. */
enum { PHASE, SLOW_PHASE, DITHER_ANGLE, DITHER_RATE, BEAT, PULL, NULL_SHIFT, MODE };

/* The gyro of the check values: 28 cm, lock-in 0.1 deg/s, dither 400 Hz and 100 deg/s, a pure
 * sine. */
static imk_ring_laser checked(void)
{
    imk_ring_laser d = imk_ring_laser_default();
    d.cavity.perimeter = 0.28;
    d.lock_in.rate = 0.1 * degree;
    d.dither.frequency = 400.0;
    d.dither.rate = 100.0 * degree;
    d.dither.randomness = 0.0;
    d.null_shift.repeatability = d.null_shift.instability = 0.0;
    d.scale_factor.repeatability = 0.0;
    return d;
}

/* The same without dither. */
static imk_ring_laser undithered(void)
{
    imk_ring_laser d = checked();
    d.dither.rate = 0.0;
    return d;
}

static imk_physics_settings settings_of(imk_level level, bool noise)
{
    imk_physics_settings settings = imk_physics_default();
    settings.level = level;
    settings.noise = noise;
    settings.seed = 1;
    return settings;
}

static imk_exposure turning(double rate)
{
    imk_exposure exposure = imk_exposure_default();
    exposure.angular_rate[0] = rate;
    return exposure;
}

static double signal_of(const void *state, int which)
{
    double values[IMK_INSTRUMENT_SIGNALS_MAX];
    laser->observe(state, values);
    return values[which];
}

static double phase_per_radian(const imk_ring_laser *d)
{
    return 2.0 * pi * imk_ring_laser_fringes_per_radian(d);
}

/* Mean rate by the phase of the beat, unspoilt by counting. The samples are weighted by a Hann
 * window, under which periodic errors of c cycles in the record have shrunk to about 1/c^3. */
static double rate_by_phase(const imk_ring_laser *d, const imk_physics_settings *settings,
                            double rate, size_t count)
{
    void *state = started(laser, d, settings);
    const imk_exposure exposure = turning(rate);
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX], sum = 0.0, weights = 0.0;
    double last = signal_of(state, SLOW_PHASE);
    for (size_t i = 0; i < count; i++) {
        laser->step(state, &exposure, outputs);
        const double weight = 1.0 - cos(2.0 * pi * ((double)i + 0.5) / (double)count);
        const double phase = signal_of(state, SLOW_PHASE);
        sum += weight * (phase - last);
        weights += weight;
        last = phase;
    }
    free(state);
    return sum / weights * settings->rate / phase_per_radian(d);
}

/* Density of the rate noise by the increments of the phase: their variance per second, about the
 * mean. Also the mean rate. */
static double noise_by_phase(const imk_ring_laser *d, const imk_physics_settings *settings,
                             double rate, size_t count, double *mean)
{
    void *state = started(laser, d, settings);
    const imk_exposure exposure = turning(rate);
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX], sum = 0.0, squares = 0.0;
    double last = signal_of(state, SLOW_PHASE);
    for (size_t i = 0; i < count; i++) {
        laser->step(state, &exposure, outputs);
        const double phase = signal_of(state, SLOW_PHASE);
        const double more =
            (phase - last) / phase_per_radian(d) - rate / settings->rate; /* [rad] */
        sum += more;
        squares += more * more;
        last = phase;
    }
    free(state);
    const double n = (double)count, variance = (squares - sum * sum / n) / (n - 1.0);
    if (mean)
        *mean = rate + sum / n * settings->rate;
    return sqrt(variance * settings->rate);
}

/* ---- check values ---------------------------------------------------------------------------- */

/* All digits printed in the sheet; the Earth's rate is 7.292115e-5 rad/s. */
static void geometry(void **state)
{
    (void)state;
    imk_ring_laser d = checked();
    const double fringes = imk_ring_laser_fringes_per_radian(&d);
    CHECK_CLOSE(fringes * degree, 1486.23, 5e-3);
    CHECK_CLOSE(1.0 / fringes / degree * 3600.0, 2.42223, 5e-6);
    CHECK_CLOSE(fringes * 7.292115e-5, 6.2096, 5e-5);
    CHECK_RELATIVE(imk_ring_laser_count_angle(&d), 0.25 / fringes, 1e-15);
    CHECK_RELATIVE(imk_ring_laser_area(&d), sqrt(3.0) / 4.0 * (0.28 / 3.0) * (0.28 / 3.0), 1e-15);
    d.cavity.shape = IMK_RING_LASER_SQUARE;
    d.readout.decoding = IMK_RING_LASER_FRINGES;
    /* 4 (P/4)^2/(lambda P) = P/(4 lambda) */
    CHECK_RELATIVE(imk_ring_laser_fringes_per_radian(&d), 0.28 / (4.0 * 632.8e-9), 1e-15);
    CHECK_RELATIVE(imk_ring_laser_count_angle(&d), 4.0 * 632.8e-9 / 0.28, 1e-15);
    CHECK_RELATIVE(imk_ring_laser_mode_hop(&d), 632.8e-9 / 0.28, 1e-15);
}

/* The solution of psi' = Omega - kappa sin(psi + e) in closed form [ADLER1946], with
 * D = sqrt(Omega^2 - kappa^2):  tan((psi + e)/2) = kappa/Omega + D/Omega tan(D (t - t0)/2).
 *
 * The step is of fourth order: at 0.02 rad of pull its error is below 1e-7 rad, which a step of a
 * half makes 16 times smaller. */
static void the_beat_follows_adler(void **state)
{
    (void)state;
    imk_ring_laser d = undithered();
    d.lock_in.phase = 0.7;
    const double k = phase_per_radian(&d), drive = k * 0.2 * degree, pull = k * d.lock_in.rate;
    const double beat = sqrt(drive * drive - pull * pull), rate = 1e4;
    const double begin = atan((tan(0.5 * 0.7) - pull / drive) * drive / beat);
    const imk_exposure exposure = turning(0.2 * degree);
    double worst[2] = {0.0, 0.0}, outputs[IMK_INSTRUMENT_OUTPUTS_MAX];
    for (int i = 0; i < 2; i++) {
        imk_physics_settings settings = settings_of(IMK_LEVEL_FULL, false);
        settings.rate = rate;
        settings.step = i == 0 ? 2e-5 : 1e-5;
        void *run_state = started(laser, &d, &settings);
        for (int sample = 1; sample <= 1000; sample++) {
            laser->step(run_state, &exposure, outputs);
            const double angle = begin + 0.5 * beat * (double)sample / rate;
            const double exact = 2.0 * atan(pull / drive + beat / drive * tan(angle)) - 0.7;
            const double error = signal_of(run_state, PHASE) - exact;
            worst[i] = fmax(worst[i], fabs(remainder(error, 2.0 * pi)));
        }
        free(run_state);
    }
    CHECK_BELOW(worst[0], 1e-6);
    CHECK_RELATIVE(worst[0] / worst[1], 16.0, 0.1);
}

/* 0.2 deg/s with a lock-in rate of 0.1: the reading is 0.173205 deg/s. A sample is as long as a
 * beat, so that each counts one fringe and has the mean rate. */
static void undithered_rate(void **state)
{
    (void)state;
    const imk_ring_laser d = undithered();
    const double expected = sqrt(0.03) * degree;
    CHECK_RELATIVE(imk_ring_laser_undithered_rate(&d, 0.2 * degree), expected, 1e-14);
    CHECK_RELATIVE(imk_ring_laser_undithered_rate(&d, -0.2 * degree), -expected, 1e-14);
    CHECK_CLOSE(expected / degree, 0.173205, 5e-7);
    imk_physics_settings settings = settings_of(IMK_LEVEL_FULL, false);
    settings.rate = expected * imk_ring_laser_fringes_per_radian(&d);
    imk_exposure exposure = turning(0.2 * degree);
    CHECK_RELATIVE(mean_of(laser, &d, &settings, &exposure, 3, 100, 0), expected, 1e-12);
    /* the phase itself: 100 fringes in 100 samples, 1e-7 rad of error */
    CHECK_RELATIVE(rate_by_phase(&d, &settings, 0.2 * degree, 100), expected, 1e-9);

    /* within the band the phase comes to rest where lock-in balances the input, asin(W/W_L) */
    exposure = turning(0.05 * degree);
    void *run_state = started(laser, &d, &settings);
    run(laser, run_state, &exposure, 50, 0, NULL);
    CHECK_CLOSE(signal_of(run_state, PHASE), asin(0.5), 1e-8);
    CHECK_CLOSE(signal_of(run_state, BEAT), 0.0, 1e-6);
    free(run_state);
    CHECK_CLOSE(mean_of(laser, &d, &settings, &exposure, 50, 100, 0), 0.0, 0.0);
    CHECK_CLOSE(imk_ring_laser_undithered_rate(&d, 0.05 * degree), 0.0, 0.0);
}

/* The sheet: amplitude 143.24 arcsec, J_0 = 0.0413, dead band 14.87 deg/h; 10 deg/h reads 0, 20
 * reads 13.37 and 1000 reads 999.994 where the square-root law gives 999.889. The records are 10 s
 * and hold 55 or more cycles of what is averaged. The default step leaves 4e-4 deg/h, the closed
 * form 1e-3 deg/h of higher orders. */
static void dithered_rate(void **state)
{
    (void)state;
    const imk_ring_laser d = checked();
    const imk_physics_settings settings = settings_of(IMK_LEVEL_FULL, false);
    CHECK_CLOSE(imk_ring_laser_dither_angle(&d) / degree * 3600.0, 143.24, 5e-3);
    CHECK_CLOSE(imk_ring_laser_dead_band(&d) / d.lock_in.rate, 0.0413, 5e-5);
    CHECK_CLOSE(imk_ring_laser_dead_band(&d) / degree_per_hour, 14.87, 5e-3);

    const double read[] = {10.0, 20.0, 1000.0}, expected[] = {0.0, 13.3758, 999.9938};
    const double tolerance[] = {1e-4, 1e-3, 1e-4}; /* of the window, and of the step */
    for (int i = 0; i < 3; i++) {
        const double rate = read[i] * degree_per_hour;
        const double full = rate_by_phase(&d, &settings, rate, 1000) / degree_per_hour;
        const double closed = imk_ring_laser_dithered_rate(&d, rate) / degree_per_hour;
        CHECK_CLOSE(full, expected[i], tolerance[i]);
        CHECK_CLOSE(closed, full, 2e-3);
    }
    const double band = imk_ring_laser_dead_band(&d), at_thousand = 1000.0 * degree_per_hour;
    CHECK_CLOSE(sqrt(at_thousand * at_thousand - band * band) / degree_per_hour, 999.889, 1e-3);
}

/* Multiples of the dither frequency lock the beat, too: at n w/K, within W_L |J_n|. */
static void bands_at_multiples(void **state)
{
    (void)state;
    imk_ring_laser d = checked();
    const imk_physics_settings settings = settings_of(IMK_LEVEL_FULL, false);
    double half_width;
    const double centre = imk_ring_laser_band(&d, 2, &half_width);
    CHECK_RELATIVE(centre, 2.0 * 2.0 * pi * 400.0 / phase_per_radian(&d), 1e-14);
    /* A band of 2 reads as its centre; the phase is locked within a few 1/(K b) = 0.03 s. */
    void *run_state = started(laser, &d, &settings);
    const imk_exposure exposure = turning(centre + 0.5 * half_width);
    run(laser, run_state, &exposure, 100, 0, NULL);
    const double before = signal_of(run_state, SLOW_PHASE);
    run(laser, run_state, &exposure, 100, 0, NULL);
    const double gained = signal_of(run_state, SLOW_PHASE) - before;
    free(run_state);
    /* 1 s; half a width away from the centre would be 6 rad */
    CHECK_CLOSE(gained - phase_per_radian(&d) * centre, 0.0, 1e-3);
    CHECK_BELOW(5.0, phase_per_radian(&d) * 0.5 * half_width);
}

/* ---- levels ---------------------------------------------------------------------------------- */

/* The equation by Runge and Kutta's method with steps of 0.1 us, independently. */
static double slope_of(const imk_ring_laser *d, double rate, double t, double phase)
{
    const double k = phase_per_radian(d);
    return k * (rate + d->dither.rate * cos(2.0 * pi * d->dither.frequency * t)) -
           k * d->lock_in.rate * sin(phase + d->lock_in.phase);
}

/* Two cycles of the dither, four passages; the default step and one twice as long. */
static void full_level_against_runge_kutta(void **state)
{
    (void)state;
    imk_ring_laser d = checked();
    d.lock_in.phase = -1.1;
    const double rate = 3.0 * degree, h = 1e-7;
    imk_physics_settings settings = settings_of(IMK_LEVEL_FULL, false);
    settings.rate = 1000.0;
    void *run_state = started(laser, &d, &settings);
    settings.step = 2.0 * laser->step_length(&d, &settings);
    void *coarse = started(laser, &d, &settings);
    const imk_exposure exposure = turning(rate);
    double phase = 0.0, outputs[IMK_INSTRUMENT_OUTPUTS_MAX], worst = 0.0, worst_coarse = 0.0;
    for (int sample = 0; sample < 5; sample++) {
        for (int i = 0; i < 10000; i++) {
            const double t = ((double)sample * 10000.0 + (double)i) * h;
            const double k1 = slope_of(&d, rate, t, phase);
            const double k2 = slope_of(&d, rate, t + 0.5 * h, phase + 0.5 * h * k1);
            const double k3 = slope_of(&d, rate, t + 0.5 * h, phase + 0.5 * h * k2);
            const double k4 = slope_of(&d, rate, t + h, phase + h * k3);
            phase += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
        }
        laser->step(run_state, &exposure, outputs);
        laser->step(coarse, &exposure, outputs);
        worst = fmax(worst, fabs(signal_of(run_state, PHASE) - phase));
        worst_coarse = fmax(worst_coarse, fabs(signal_of(coarse, PHASE) - phase));
    }
    free(run_state);
    free(coarse);
    /* a kick is 0.05 rad; of the default step's bend of 0.08 rad about 0.003 of the square is left
     */
    CHECK_BELOW(worst, 0.05 * 0.003 * 0.08 * 0.08 * 10.0);
    CHECK_BELOW(worst_coarse, 16.0 * 0.05 * 0.003 * 0.08 * 0.08 * 10.0);
}

/* The kick map follows the full dynamics kick by kick, under the same random amplitudes: 200 kicks
 * of 0.05 rad, which make a walk of 0.5 rad. The map leaves out what the jump of the rate makes
 * where the amplitude changes, kappa times the change of 1/Omega, 3e-5 rad: 4e-4 rad in all, and
 * 4e-3 where the walk drives neighbours apart. With so much light that quantum noise is below 1e-4
 * rad. That the five walks together are as short as 0.03 rad has a chance of 1e-7. */
static void kicks_against_full_level(void **state)
{
    (void)state;
    imk_ring_laser d = checked();
    d.cavity.power = 1e6;
    d.dither.randomness = 0.02;
    const double rates[] = {0.0, 15.0 * degree_per_hour, -0.3 * degree, 10.0 * degree,
                            -30.0 * degree};
    double walked = 0.0;
    for (int i = 0; i < 5; i++) {
        double gained[2];
        for (int level = 0; level < 2; level++) {
            const imk_physics_settings settings = settings_of((imk_level)level, true);
            const imk_exposure exposure = turning(rates[i]);
            void *run_state = started(laser, &d, &settings);
            const double before = signal_of(run_state, SLOW_PHASE);
            run(laser, run_state, &exposure, 25, 0, NULL);
            gained[level] = signal_of(run_state, SLOW_PHASE) - before;
            free(run_state);
        }
        CHECK_CLOSE(gained[1], gained[0], 5e-3);
        const double walk = gained[0] - 0.25 * phase_per_radian(&d) * rates[i];
        walked += walk * walk;
    }
    assert_true(walked > 1e-3);
}

/* The map has the dead band and the square-root law of the pure sine as well; its kicks have
 * relative errors of 1e-4. Beyond the peak rate of the dither what is left is the pull of second
 * order, W_L^2/(2 sqrt(W^2 - W_d^2)). */
static void kicks_under_a_pure_sine(void **state)
{
    (void)state;
    imk_ring_laser d = checked();
    const imk_physics_settings settings = settings_of(IMK_LEVEL_SLOW, false);
    const double read[] = {10.0, 20.0, 1000.0}, expected[] = {0.0, 13.3758, 999.9938};
    for (int i = 0; i < 3; i++) {
        const double rate = read[i] * degree_per_hour;
        CHECK_CLOSE(rate_by_phase(&d, &settings, rate, 1000) / degree_per_hour, expected[i],
                    2e-4 * fabs(read[i] - expected[i]) + 1e-4);
    }
    d.lock_in.rate = 0.5 * degree;
    d.dither.rate = 50.0 * degree;
    const double rate = 100.0 * degree;
    const double pull =
        0.5 * d.lock_in.rate * d.lock_in.rate / sqrt(rate * rate - d.dither.rate * d.dither.rate);
    for (int level = 0; level < 2; level++) {
        const imk_physics_settings other = settings_of((imk_level)level, false);
        CHECK_RELATIVE(rate - rate_by_phase(&d, &other, rate, 300), pull, 0.01);
    }
}

/* ---- noise ----------------------------------------------------------------------------------- */

/* The dead band, and what takes it away: at 5 deg/h the gyro without dither and the one with a
 * pure sine read nothing; with a random amplitude the reading is right, and the price is W_L/sqrt(K
 * W_d) of angle random walk. The variance of n Gaussian increments has a relative standard
 * deviation of sqrt(2/n); sums of kicks have less. */
static void random_dither_removes_the_dead_band(void **state)
{
    (void)state;
    enum { SAMPLES = 2000, LONG = 60000 };
    imk_ring_laser d = checked();
    const double rate = 5.0 * degree_per_hour;
    imk_physics_settings settings = settings_of(IMK_LEVEL_FULL, true);
    const imk_exposure exposure = turning(rate);
    const imk_ring_laser without = undithered();
    const double least = 0.5 * degree_per_hour;
    /* a count in 10 s is 0.06 deg/h */
    CHECK_BELOW(fabs(mean_of(laser, &without, &settings, &exposure, 200, 500, 0)), least);
    CHECK_BELOW(fabs(mean_of(laser, &d, &settings, &exposure, 200, 500, 0)), least);

    d.dither.randomness = 0.02;
    CHECK_CLOSE(imk_ring_laser_lock_in_noise(&d) / degree * 60.0, 6.2e-3, 5e-5);
    CHECK_RELATIVE(imk_ring_laser_lock_in_noise(&d),
                   d.lock_in.rate / sqrt(phase_per_radian(&d) * d.dither.rate), 1e-12);
    const double n = hypot(imk_ring_laser_lock_in_noise(&d), imk_ring_laser_quantum_noise(&d));
    double mean;
    CHECK_RELATIVE(noise_by_phase(&d, &settings, rate, SAMPLES, &mean), n,
                   5.0 * sqrt(0.5 / (double)SAMPLES));
    CHECK_CLOSE(mean, rate, 5.0 * n / sqrt((double)SAMPLES / settings.rate));
    settings.level = IMK_LEVEL_SLOW;
    CHECK_RELATIVE(noise_by_phase(&d, &settings, rate, LONG, &mean), n,
                   5.0 * sqrt(0.5 / (double)LONG));
    CHECK_CLOSE(mean, rate, 5.0 * n / sqrt((double)LONG / settings.rate));

    /* hardly random at all: K th_d r = 0.5 rad, and e^(-1/8) of the dead band is left; 1000 deg/h
     * is far outside it */
    d.dither.randomness = 0.5 / (phase_per_radian(&d) * imk_ring_laser_dither_angle(&d));
    imk_ring_laser sine = checked();
    CHECK_RELATIVE(imk_ring_laser_dead_band(&d) / imk_ring_laser_dead_band(&sine), exp(-0.125),
                   1e-12);
    CHECK_RELATIVE(imk_ring_laser_lock_in_noise(&d),
                   d.lock_in.rate / sqrt(phase_per_radian(&d) * d.dither.rate) *
                       sqrt(1.0 - exp(-0.25)),
                   1e-12);
    const double some = hypot(imk_ring_laser_lock_in_noise(&d), imk_ring_laser_quantum_noise(&d));
    CHECK_RELATIVE(noise_by_phase(&d, &settings, 1234.0 * degree_per_hour, LONG, NULL), some,
                   5.0 * sqrt(0.5 / (double)LONG) + 0.01);
}

/* N_q = c P/(4 A Q) sqrt(h nu/P_lost) with Q = 2 pi nu/Gamma [SCHREIBER2013]; both levels make it.
 */
static void quantum_noise(void **state)
{
    (void)state;
    imk_ring_laser d = checked();
    const double light = 299792458.0, nu = light / d.cavity.wavelength;
    const double decay = light * d.cavity.loss / d.cavity.perimeter, q = 2.0 * pi * nu / decay;
    const double lost = d.cavity.loss * d.cavity.power;
    CHECK_RELATIVE(imk_ring_laser_decay_rate(&d), decay, 1e-14);
    CHECK_RELATIVE(imk_ring_laser_quantum_noise(&d),
                   light * d.cavity.perimeter / (4.0 * imk_ring_laser_area(&d) * q) *
                       sqrt(6.62607015e-34 * nu / lost),
                   1e-13);
    d.lock_in.rate = 0.0;
    for (int level = 0; level < 2; level++) {
        const size_t count = level == 0 ? 1000 : 20000;
        const imk_physics_settings settings = settings_of((imk_level)level, true);
        CHECK_RELATIVE(noise_by_phase(&d, &settings, 1e-3, count, NULL),
                       imk_ring_laser_quantum_noise(&d), 5.0 * sqrt(0.5 / (double)count));
    }
}

/* Mean velocity of psi' = F - B sin psi + noise of the diffusion D [STRATONOVICH1967], with the
 * potential U = -F x - B cos x:
 *     2 pi D (1 - e^(-2 pi F/D))/integral_0^2pi dx integral_x^(x+2pi) dy e^((U(y) - U(x))/D)
 * by the rectangle rule, which is exact to rounding for the outer, periodic integral; the inner one
 * by the trapezium rule is good to 1e-4. */
static double washboard(double f, double b, double d)
{
    enum { POINTS = 400 };
    const double h = 2.0 * pi / POINTS;
    double sum = 0.0;
    for (int i = 0; i < POINTS; i++)
        for (int j = 0; j <= POINTS; j++) {
            const double x = h * i, y = x + h * j;
            const double rise = -f * (y - x) - b * (cos(y) - cos(x));
            sum += h * h * exp(rise / d) * (j == 0 || j == POINTS ? 0.5 : 1.0);
        }
    return 2.0 * pi * d * -expm1(-2.0 * pi * f / d) / sum;
}

/* Noise carries the phase through lock-in: where 2 W_L/(K N^2) = 1, the limit at which `reduce`
 * states a dead band, the slope at zero is 1/I_0(1)^2 = 0.624. Without dither, with so little light
 * that the noise is large; 8 s, by the counts. */
static void noise_outweighs_the_dead_band(void **state)
{
    (void)state;
    imk_ring_laser d = undithered();
    d.cavity.power = 1e-8;
    const double k = phase_per_radian(&d), n = imk_ring_laser_quantum_noise(&d);
    d.lock_in.rate = 0.5 * k * n * n;
    const double b = k * d.lock_in.rate, diffusion = 0.5 * k * k * n * n;
    CHECK_CLOSE(washboard(0.01 * b, b, diffusion) / (0.01 * b), 0.624, 1e-3);

    const double rate = 0.5 * d.lock_in.rate, duration = 8.0;
    imk_physics_settings settings = settings_of(IMK_LEVEL_FULL, true);
    const imk_exposure exposure = turning(rate);
    const double mean = mean_of(laser, &d, &settings, &exposure, 10, 800, 0);
    const double expected = washboard(0.5 * b, b, diffusion) / k;
    CHECK_CLOSE(mean, expected, 5.0 * n / sqrt(duration));
    assert_true(fabs(rate - expected) > 10.0 * n / sqrt(duration)); /* it is not just the input */

    imk_model *model = malloc(sizeof *model);
    assert_non_null(model);
    d.lock_in.rate *= 0.99;
    imk_instrument_reduce(laser, &d, model);
    CHECK_CLOSE(model->gyro.dead_band.value[0], 0.0, 0.0);
    d.lock_in.rate *= 1.02;
    imk_instrument_reduce(laser, &d, model);
    CHECK_RELATIVE(model->gyro.dead_band.value[0], d.lock_in.rate, 1e-15);
    free(model);
}

/* ---- readout --------------------------------------------------------------------------------- */

/* No count is ever lost: the angle read is the angle turned, to a count at each end, at any rate
 * and with either way to take the dither out; which is late by a cycle if it is by whole cycles. */
static void counts_are_conserved(void **state)
{
    (void)state;
    imk_ring_laser d = checked();
    d.lock_in.rate = 0.0;
    d.dither.randomness = 0.03;
    d.dither.frequency = 413.0;
    const double rates[] = {0.3, -15.0}, duration = 1.0;
    for (int level = 0; level < 2; level++)
        for (int i = 0; i < 4; i++) {
            imk_physics_settings settings = settings_of((imk_level)level, true);
            settings.rate = 100.0;
            d.cavity.power = 1e6; /* hardly any noise */
            d.readout.stripping = i < 2 ? IMK_RING_LASER_PICKOFF : IMK_RING_LASER_PERIODS;
            const imk_exposure exposure = turning(rates[i % 2]);
            const double read = mean_of(laser, &d, &settings, &exposure, 0, 100, 0) * duration;
            const double late = i < 2 ? 0.0 : 1.0 / d.dither.frequency;
            CHECK_CLOSE(read, rates[i % 2] * (duration - late),
                        2.0 * imk_ring_laser_count_angle(&d));
        }
}

/* A pickoff that errs by 5 % leaves the dither in the reading: at most the closed form, and nearly
 * that in some sample, give or take a count; nothing when the samples are whole cycles. */
static void pickoff_error(void **state)
{
    (void)state;
    imk_ring_laser d = checked();
    const imk_physics_settings settings = settings_of(IMK_LEVEL_FULL, false);
    const imk_exposure exposure = turning(1.0 * degree);
    d.readout.pickoff_error = 0.05;
    CHECK_CLOSE(imk_ring_laser_dither_residual(&d, settings.rate), 0.0, 1e-15);
    d.dither.frequency = 413.0;
    const double largest = imk_ring_laser_dither_residual(&d, settings.rate);
    const double count = imk_ring_laser_count_angle(&d) * settings.rate;
    double samples[100], worst = 0.0;
    void *run_state = started(laser, &d, &settings);
    run(laser, run_state, &exposure, 100, 0, samples);
    free(run_state);
    for (int i = 0; i < 100; i++)
        worst = fmax(worst, fabs(samples[i] - 1.0 * degree));
    CHECK_CLOSE(worst, largest, 2.0 * count);
    assert_true(largest > 3.0 * count);
}

/* Between samples the reading has no delay and no loss: unity gain, no phase; 0.1 deg/s of
 * amplitude is 40 counts a sample, random dither makes their rounding random. */
static void bandwidth(void **state)
{
    (void)state;
    imk_ring_laser d = checked();
    d.dither.randomness = 0.02;
    for (int level = 0; level < 2; level++) {
        double phase;
        const imk_physics_settings settings = settings_of((imk_level)level, true);
        const double gain = sine_gain(laser, &d, &settings, 50.0 * degree, 10.0, 0, 20, &phase);
        CHECK_CLOSE(gain, 1.0, 1e-4);
        CHECK_CLOSE(phase, 0.0, 1e-4);
    }
}

/* ---- slow errors ----------------------------------------------------------------------------- */

/* Null shift, scale factor, tilt and temperature come out as `reduce` says. */
static void slow_errors(void **state)
{
    (void)state;
    imk_ring_laser d = checked();
    d.lock_in.rate = 0.0;
    d.null_shift.fixed = 2.0 * degree_per_hour;
    d.null_shift.temperature = 0.1 * degree_per_hour;
    d.scale_factor.error = 200e-6;
    d.alignment.y = 1e-3;
    d.alignment.z = -2e-3;
    imk_model *model = malloc(sizeof *model);
    assert_non_null(model);
    imk_instrument_reduce(laser, &d, model);
    CHECK_OK(imk_model_validate(model, NULL));
    const imk_triad *gyro = &model->gyro;
    const double rate[3] = {0.5, 0.2, -0.1}, warmer = 20.0;
    const double scale = 1.0 + gyro->scale_factor.fixed.value[0];
    const double expected = gyro->bias.fixed.value[0] +
                            gyro->bias.temperature.coefficient[0].value[0] * warmer +
                            scale * rate[0] + gyro->misalignment.value[0][1] * rate[1] +
                            gyro->misalignment.value[0][2] * rate[2];
    for (int level = 0; level < 2; level++) {
        imk_exposure exposure = imk_exposure_default();
        memcpy(exposure.angular_rate, rate, sizeof rate);
        exposure.temperature = d.temperature.reference + warmer;
        const imk_physics_settings settings = settings_of((imk_level)level, false);
        const double mean = mean_of(laser, &d, &settings, &exposure, 0, 400, 0);
        /* a count in 4 s; the error of scale acts on the small terms, too: 2e-4 of 1e-4 rad/s */
        CHECK_CLOSE(mean, expected, imk_ring_laser_count_angle(&d) / 4.0 + 2e-4 * 5e-4);
    }
    free(model);
}

/* Warming up from the reference the control follows to half its stroke, then hops to the mode in
 * the middle; on the way back it hops later. Each mode changes the scale by lambda/P. */
static void mode_hops(void **state)
{
    (void)state;
    imk_ring_laser d = checked();
    d.lock_in.rate = 0.0;
    d.path_length.expansion = 1e-6;
    d.path_length.stroke = 2e-6;
    const double grows = d.path_length.expansion * d.cavity.perimeter; /* 0.28 um/K */
    CHECK_RELATIVE(imk_ring_laser_hop_temperature(&d), 1e-6 / grows, 1e-14);
    const imk_physics_settings settings = settings_of(IMK_LEVEL_SLOW, false);
    void *run_state = started(laser, &d, &settings);
    const double rate = 10.0, temperatures[] = {0.0, 3.5, 3.6, 2.0, 1.84};
    /* 3.6 K are 1.008 um or 1.59 wavelengths: mode 2, at -0.26 um. Back at 2 K it is at -0.706 um,
     * at 1.84 K at -0.750, still within the stroke; at 0.9 K at -1.01 um it hops, to mode 0. */
    const double modes[] = {0.0, 0.0, 2.0, 2.0, 2.0};
    imk_exposure exposure = turning(rate);
    for (int i = 0; i < 5; i++) {
        double samples[10], sum = 0.0;
        exposure.temperature = d.temperature.reference + temperatures[i];
        run(laser, run_state, &exposure, 10, 0, samples);
        CHECK_CLOSE(signal_of(run_state, MODE), modes[i], 0.0);
        for (int j = 0; j < 10; j++)
            sum += samples[j] / 10.0;
        CHECK_CLOSE(sum, rate * (1.0 + modes[i] * imk_ring_laser_mode_hop(&d)),
                    imk_ring_laser_count_angle(&d) / 0.1);
    }
    exposure.temperature = d.temperature.reference + 0.9;
    run(laser, run_state, &exposure, 1, 0, NULL);
    CHECK_CLOSE(signal_of(run_state, MODE), 0.0, 0.0);
    free(run_state);
}

/* Run constants: the spread of 200 runs is that of the design. A variance of n normals is within
 * 5 sqrt(2/n) of itself. */
static void runs_differ(void **state)
{
    (void)state;
    enum { RUNS = 200 };
    imk_ring_laser d = checked();
    d.lock_in.rate = 0.0;
    d.null_shift.repeatability = 3.0 * degree_per_hour;
    double sum = 0.0;
    for (uint32_t i = 0; i < RUNS; i++) {
        imk_physics_settings settings = settings_of(IMK_LEVEL_SLOW, true);
        settings.run = i;
        void *run_state = started(laser, &d, &settings);
        const imk_exposure exposure = turning(0.0);
        run(laser, run_state, &exposure, 1, 0, NULL);
        const double shift = signal_of(run_state, NULL_SHIFT);
        sum += shift * shift;
        free(run_state);
    }
    CHECK_RELATIVE(sqrt(sum / RUNS), d.null_shift.repeatability, 2.5 * sqrt(2.0 / RUNS));
}

/* ---- model ----------------------------------------------------------------------------------- */

static void default_design(void **state)
{
    (void)state;
    const imk_ring_laser d = imk_ring_laser_default();
    imk_model *model = malloc(sizeof *model);
    assert_non_null(model);
    CHECK_OK(imk_ring_laser_validate(&d, NULL));
    imk_instrument_reduce(laser, &d, model);
    CHECK_OK(imk_model_validate(model, NULL));
    const imk_noise *noise = &model->gyro.noise;
    CHECK_CLOSE(noise->white.value[0] / degree * 60.0, 0.0035, 1e-6);
    CHECK_CLOSE(0.6643 * noise->bias_instability.value[0] / degree_per_hour, 0.0035, 1e-9);
    CHECK_RELATIVE(noise->reading_noise.value[0], imk_ring_laser_count_angle(&d) / sqrt(12.0),
                   1e-14);
    CHECK_CLOSE(model->gyro.dead_band.value[0], 0.0, 0.0);
    CHECK_CLOSE(model->gyro.scale_factor.temperature.order, 0, 0.0);
    imk_model_three_axes(model);
    CHECK_OK(imk_model_validate(model, NULL));
    const imk_grade_result grade = imk_grade_model(model);
    assert_int_equal(grade.gyro, IMK_GRADE_NAVIGATION);
    assert_non_null(strstr(imk_grade_table(grade.gyro)->gyro_technology, laser->technology));
    assert_ptr_equal(imk_instrument_find("ring laser"), laser);

    const imk_ring_laser without = undithered(), sine = checked();
    imk_instrument_reduce(laser, &without, model);
    CHECK_RELATIVE(model->gyro.dead_band.value[0], without.lock_in.rate, 1e-15);
    CHECK_RELATIVE(model->gyro.noise.white.value[0], imk_ring_laser_quantum_noise(&without), 1e-14);
    imk_instrument_reduce(laser, &sine, model);
    CHECK_RELATIVE(model->gyro.dead_band.value[0], imk_ring_laser_dead_band(&sine), 1e-15);
    free(model);
}

/* Design -> log of the full level -> identified terms. Scaled so that 300 s tell Q, N and B: a slow
 * dither of 7 deg/s, 5 % random, with kicks of 0.3 rad (their variance is c^2/16 = 0.5 % smaller
 * than that of the formula, which is for small ones). B is chosen to be plain in each record: at
 * the edge of what a record shows, flicker may be taken for a random walk. */
static void chain(void **state)
{
    (void)state;
    imk_ring_laser d = imk_ring_laser_default();
    d.dither.frequency = 101.0;
    d.dither.rate = 7.0 * degree;
    d.dither.randomness = 0.05;
    d.lock_in.rate = 0.1 * degree;
    d.null_shift.instability = 5.0 * degree_per_hour;
    const imk_exposure exposure = turning(15.0 * degree_per_hour);
    imk_physics_settings settings = settings_of(IMK_LEVEL_FULL, true);
    settings.rate = 20.0;
    check_chain(laser, &d, &settings, &exposure, 0, 6000);
    d.null_shift.instability = 2.0 * degree_per_hour;
    settings.level = IMK_LEVEL_SLOW;
    check_chain(laser, &d, &settings, &exposure, 0, 40000);
}

/* ---- refusals, bits -------------------------------------------------------------------------- */

static void refused(imk_ring_laser design, imk_status status, const char *field)
{
    imk_error error = {0};
    CHECK_STATUS(imk_ring_laser_validate(&design, &error), status);
    assert_string_equal(error.field, field);
}

static void impossible_designs(void **state)
{
    (void)state;
    imk_ring_laser d = {0};
    refused(d, IMK_ERROR_UNINITIALISED, "design");
    d = checked();
    d.cavity.perimeter = -0.28;
    refused(d, IMK_ERROR_RANGE, "cavity.perimeter");
    d = checked();
    d.cavity.loss = 0.0;
    refused(d, IMK_ERROR_RANGE, "cavity.loss");
    d = checked();
    d.dither.randomness = (double)NAN;
    refused(d, IMK_ERROR_NOT_FINITE, "dither.randomness");
    d = checked();
    d.dither.rate = 0.05 * degree;
    refused(d, IMK_ERROR_CONFLICT, "dither.rate");
    d = checked();
    d.path_length.stroke = 0.5e-6;
    refused(d, IMK_ERROR_CONFLICT, "path_length.stroke");
    d = checked();
    d.temperature.minimum = 300.0;
    refused(d, IMK_ERROR_CONFLICT, "temperature.minimum");
    d = checked();
    d.temperature.maximum = 280.0;
    refused(d, IMK_ERROR_CONFLICT, "temperature.maximum");
}

static void wrong_settings(void **state)
{
    (void)state;
    imk_ring_laser d = checked();
    imk_error error = {0};
    void *memory = malloc(laser->state_size);
    assert_non_null(memory);
    imk_physics_settings settings = settings_of(IMK_LEVEL_FULL, true);
    /* twice as long as allowed: curvature of the phase, then lock-in without dither */
    settings.step = 5.0 * laser->step_length(&d, &settings);
    CHECK_STATUS(imk_instrument_init(laser, &d, &settings, memory, &error), IMK_ERROR_RANGE);
    assert_string_equal(error.field, "step");
    d.dither.rate = 0.0;
    settings.step = 0.0;
    settings.step = 10.0 * laser->step_length(&d, &settings);
    CHECK_STATUS(imk_instrument_init(laser, &d, &settings, memory, &error), IMK_ERROR_RANGE);
    settings = settings_of(IMK_LEVEL_SLOW, true);
    CHECK_STATUS(imk_instrument_init(laser, &d, &settings, memory, &error), IMK_ERROR_UNSUPPORTED);
    assert_string_equal(error.field, "level");
    d = checked();
    d.dither.rate = 5.0 * degree; /* 18.6 rad */
    CHECK_STATUS(imk_instrument_init(laser, &d, &settings, memory, &error), IMK_ERROR_UNSUPPORTED);
    d = checked();
    d.lock_in.rate = 2.0 * degree; /* kicks of 0.97 rad */
    CHECK_STATUS(imk_instrument_init(laser, &d, &settings, memory, &error), IMK_ERROR_UNSUPPORTED);
    d = checked();
    settings.step = 1.0;
    CHECK_STATUS(imk_instrument_init(laser, &d, &settings, memory, &error), IMK_ERROR_RANGE);
    free(memory);
}

/* Copies of the state go on alike; random numbers are the same from every instruction set. */
static void same_bits(void **state)
{
    (void)state;
    enum { SAMPLES = 300 };
    const imk_ring_laser d = imk_ring_laser_default();
    char before[16] = "";
    if (getenv("IMUKIT_ISA"))
        strncpy(before, getenv("IMUKIT_ISA"), sizeof before - 1);
    for (int level = 0; level < 2; level++) {
        double samples[2][SAMPLES];
        const imk_physics_settings settings = settings_of((imk_level)level, true);
        const imk_exposure exposure = turning(0.01);
        void *one = started(laser, &d, &settings);
        run(laser, one, &exposure, 7, 0, NULL);
        void *copy = aligned_alloc(64, (laser->state_size + 63) / 64 * 64);
        assert_non_null(copy);
        memcpy(copy, one, laser->state_size);
        run(laser, one, &exposure, SAMPLES, 0, samples[0]);
        run(laser, copy, &exposure, SAMPLES, 0, samples[1]);
        assert_memory_equal(samples[0], samples[1], sizeof samples[0]);
        free(copy);
        free(one);
        assert_int_equal(setenv("IMUKIT_ISA", "scalar", 1), 0);
        one = started(laser, &d, &settings);
        run(laser, one, &exposure, 7, 0, NULL);
        run(laser, one, &exposure, SAMPLES, 0, samples[1]);
        assert_memory_equal(samples[0], samples[1], sizeof samples[0]);
        free(one);
        assert_int_equal(before[0] ? setenv("IMUKIT_ISA", before, 1) : unsetenv("IMUKIT_ISA"), 0);
    }
}

/* Beyond the range of rates as many fringes are counted as at its end: a number that overflows has
 * another sign. */
static void endless_rates(void **state)
{
    (void)state;
    const imk_ring_laser design = imk_ring_laser_default();
    const double most = 1e6 / imk_ring_laser_count_angle(&design) / 100.0; /* in 10 ms */
    for (int level = 0; level < 2; level++) {
        imk_physics_settings settings = imk_physics_default();
        settings.level = (imk_level)level;
        void *gyro = started(&imk_ring_laser_instrument, &design, &settings);
        imk_exposure exposure = imk_exposure_default();
        double readings[IMK_INSTRUMENT_OUTPUTS_MAX];
        for (int i = 0; i < 3; i++) {
            const double rates[] = {1e17, 1e300, (double)INFINITY};
            exposure.angular_rate[0] = rates[i];
            imk_ring_laser_instrument.step(gyro, &exposure, readings);
            CHECK_RELATIVE(readings[1], most, 1e-4); /* scale factor error: 5 ppm, 1 sigma */
            CHECK_CLOSE(readings[0], design.readout.range, 0.0);
        }
        free(gyro);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(geometry),
        cmocka_unit_test(the_beat_follows_adler),
        cmocka_unit_test(undithered_rate),
        cmocka_unit_test(dithered_rate),
        cmocka_unit_test(bands_at_multiples),
        cmocka_unit_test(full_level_against_runge_kutta),
        cmocka_unit_test(kicks_against_full_level),
        cmocka_unit_test(kicks_under_a_pure_sine),
        cmocka_unit_test(random_dither_removes_the_dead_band),
        cmocka_unit_test(quantum_noise),
        cmocka_unit_test(noise_outweighs_the_dead_band),
        cmocka_unit_test(counts_are_conserved),
        cmocka_unit_test(pickoff_error),
        cmocka_unit_test(bandwidth),
        cmocka_unit_test(slow_errors),
        cmocka_unit_test(mode_hops),
        cmocka_unit_test(runs_differ),
        cmocka_unit_test(default_design),
        cmocka_unit_test(chain),
        cmocka_unit_test(impossible_designs),
        cmocka_unit_test(wrong_settings),
        cmocka_unit_test(endless_rates),
        cmocka_unit_test(same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
