/* SPDX-License-Identifier: Apache-2.0 */
/* The beat of a ring laser with lock-in under dither,
 *
 *     psi' = Omega(t) - kappa sin(psi + e),   Omega = K (W + A w cos w t) + noise,  kappa = K W_L
 *
 * Full level. The phase that rotation makes in a step, Theta, is known exactly from the angles at
 * its ends. What is left, chi = psi + e - Theta, moves slowly: chi' = -kappa sin(chi + Theta(t)).
 * Within a step Theta is a straight line and a parabola, which is small,
 *
 *     Theta(s) = Theta_mid + 2 x s/h + bend/2 (s^2/h^2 - 1/4),   -h/2 < s < h/2
 *
 * so the integral of sin(chi + Theta) is, to first order in bend, with xi = chi + Theta_mid,
 *
 *     h [ sinc(x) sin xi + bend q(x) cos xi ],   q = (cos x - sinc x)/(4 x^2)
 *
 * however many turns 2 x has. In second order of kappa (the commutator of Magnus' series, Omega
 * constant) chi moves by -kappa^2 h^2/2 j(x), j = (2 x - sin 2 x)/(4 x^2): half of it before and
 * half after, which makes the step symmetric and of fourth order in kappa h  [BLANES2009]. With
 * constant Omega the mean of these is Adler's rate.
 *
 * Slow level. All the pulling happens where the rate passes zero, once in each half cycle. There
 * the phase is stationary, and the integral over the half cycle is [CHOW1985, BENDER1978]
 *
 *     kappa sqrt(2 pi/a) sin(psi* - sg pi/4),   a = K A w^2 sqrt(1 - r^2),  r = W/(A w)
 *     psi* = u + K W t_n + sg K A [r asin r + sqrt(1 - r^2)] + e,   sg = +-1 in turn
 *
 * at the turn t_n of the dither; u is the phase without rotation and dither. With R = sqrt(1 - r^2)
 * the next order of the expansion turns the phase by -sg/(8 K A R) (1 + 5 r^2/(3 R^2)), at r = 0 as
 * in J_0(z) ~ sqrt(2/pi z) cos(z - pi/4 - 1/8z).
 *
 * A passage at the constant acceleration a is the problem of Landau and Zener with an imaginary
 * coupling. Its exact solution [SHEVCHENKO2010, with delta = -kappa^2/4a] has two more terms in the
 * third order of the kick c = kappa sqrt(2 pi/a): c becomes c (1 + c^2/48), and the pull of second
 * order on the way from the middle of the half cycle to the turn moves the phase by
 * -sg kappa^2/(4 a) [ln(4 K A) + 0.5772], the last number being Euler's constant. */
#include "ring_laser_internal.h"

#include <math.h>

/* Flow of y' = -a sin(y + b) over a unit of time to fourth order, from s = a sin(y + b) and
 * c = a cos(y + b):  y' = -s, y'' = s c, y''' = -s (c^2 - s^2), y'''' = s c (c^2 - 5 s^2). */
static inline double flow(double s, double c)
{
    const double cc = c * c, ss = s * s;
    return s *
           (-1.0 + c * (1.0 / 2.0) - (cc - ss) * (1.0 / 6.0) + c * (cc - 5.0 * ss) * (1.0 / 24.0));
}

/* sinc, q and j of the comment above, of a rotation of 2 x [rad] given in turns. */
static inline void weights(double rotation, double *sinc, double *bend, double *pull)
{
    const double x = IMKI_PI * rotation;
    if (fabs(x) < 0.5) { /* errors below 1e-11 */
        const double y = x * x;
        *sinc =
            1.0 - y * (1.0 / 6.0 - y * (1.0 / 120.0 - y * (1.0 / 5040.0 - y * (1.0 / 362880.0))));
        *bend = -1.0 / 12.0 + y * (1.0 / 120.0 - y * (1.0 / 3360.0 - y * (1.0 / 181440.0)));
        *pull = x * (1.0 / 3.0 - y * (1.0 / 15.0 - y * (2.0 / 315.0 - y * (1.0 / 2835.0))));
        return;
    }
    double sine, cosine;
    imki_ring_laser_sine(0.5 * rotation, &sine, &cosine);
    const double inverse = 1.0 / x;
    *sinc = sine * inverse;
    *bend = 0.25 * inverse * inverse * (cosine - *sinc);
    *pull = 0.5 * inverse * inverse * (x - sine * cosine);
}

/* Change of psi by lock-in [fringes] in a step with this rotation [fringes] and bend [rad] from
 * this phase, e included [fringes]. kick = kappa h. */
static inline double locked(double phase, double rotation, double bend, double kick)
{
    double sinc, q, j, sine, cosine;
    weights(rotation, &sinc, &q, &j);
    const double shift = -0.5 * kick * kick * j * (0.5 / IMKI_PI);
    imki_ring_laser_sine(phase + 0.5 * (rotation + shift), &sine, &cosine);
    const double straight = kick * sinc, curved = kick * bend * q;
    return shift + flow(straight * sine + curved * cosine, straight * cosine - curved * sine) *
                       (0.5 / IMKI_PI);
}

/* The dither passes from one half cycle to the next within a step: another amplitude; and once in
 * a cycle the counts are read. `part` is how much of the step lies before. */
static void turn(imki_ring_laser *gyro, uint64_t next, double steady, double random)
{
    if (next < gyro->phase) {
        const double part = (double)(UINT64_C(0) - gyro->phase) / (double)gyro->phase_step;
        imki_fringes fringes = gyro->beat;
        imki_fringes_add(&fringes,
                         part * (steady + random) - gyro->slope * gyro->amplitude * gyro->sine);
        imki_ring_laser_latch(gyro, fringes);
    }
    imki_ring_laser_next_amplitude(gyro);
}

void imki_ring_laser_full(imki_ring_laser *gyro, double rate)
{
    const double steady = gyro->slope * rate * gyro->step, kick = gyro->kappa * gyro->step;
    double cosine = 1.0;
    if (gyro->dithers)
        imki_ring_laser_sine((double)gyro->phase * 0x1p-64, &gyro->sine, &cosine);
    for (size_t i = 0; i < gyro->steps; i++) {
        const double noise = gyro->noise * imki_draw(&gyro->quantum_draws);
        double rotation = steady + noise, bend = 0.0;
        if (gyro->dithers) {
            const double begin = gyro->amplitude * gyro->sine;
            const double sine = gyro->sine * gyro->turn_c + cosine * gyro->turn_s;
            const uint64_t next = gyro->phase + gyro->phase_step;
            if ((next ^ gyro->phase) >> 63)
                turn(gyro, next, steady, noise);
            rotation += gyro->slope * (gyro->amplitude * sine - begin);
            bend = gyro->bend * gyro->slope * gyro->amplitude * (gyro->sine + sine);
            cosine = cosine * gyro->turn_c - gyro->sine * gyro->turn_s;
            gyro->sine = sine;
            gyro->phase = next;
        }
        const double pulled = locked(gyro->beat.part + gyro->scatter, rotation, bend, kick);
        imki_fringes_add(&gyro->beat, rotation + pulled);
    }
}

/* ---- slow level ------------------------------------------------------------------------------ */

/* r asin r + sqrt(1 - r^2) for |r| < 1, given the root. */
static double turning_phase(double r, double root)
{
    const double y = r * r;
    if (y < 0.01) /* the next term is below 1e-12 */
        return 1.0 +
               y * (1.0 / 2.0 +
                    y * (1.0 / 24.0 + y * (1.0 / 80.0 + y * (5.0 / 896.0 + y * (7.0 / 2304.0)))));
    return r * imk_atan2(r, root) + root;
}

/* Change of u [fringes] at a turn of the dither in the direction `sign`; `phase` is u + K W t_n + e
 * [fringes]. Where the input rate is beyond the dither's there is no passage, and lock-in slows the
 * beat by its mean over the half cycle, kappa^2/(2 K W_d sqrt(r^2 - 1)). Where the two passages of
 * a cycle merge these forms grow without limit; the root is kept above (K A)^(-1/4) there. */
static double kick(const imki_ring_laser *gyro, double phase, double sign, double rate)
{
    const double swing = gyro->slope * gyro->amplitude; /* K A [fringes] */
    const double per_swing = 1.0 / swing;
    const double r = gyro->slope * rate * gyro->radian_time * per_swing;
    const double square = fabs(1.0 - r * r);
    const double root = sqrt(square > gyro->merged ? square : gyro->merged);
    const double inverse = 1.0 / root, pull = gyro->kappa * gyro->radian_time;
    if (fabs(r) >= 1.0) {
        /* half a cycle, pi radians, of kappa^2/(2 K W_d root); K W_d in fringes is swing/time */
        const double slowed = 0.125 / IMKI_PI * pull * pull * per_swing * inverse;
        return r < 0.0 ? slowed : -slowed;
    }
    double sine, cosine;
    const double next = gyro->kick_phase * (1.0 + 5.0 / 3.0 * r * r * inverse * inverse);
    const double turning =
        swing * turning_phase(r, root) - 0.125 - (next + gyro->kick_pull) * inverse;
    imki_ring_laser_sine(phase + sign * turning, &sine, &cosine);
    double size = pull * sqrt(per_swing * inverse);
    size += size * size * size * (1.0 / 48.0);
    return flow(size * sine, size * cosine) * (0.5 / IMKI_PI);
}

void imki_ring_laser_slow(imki_ring_laser *gyro, double rate)
{
    const double quarter = 0.25 / gyro->design.dither.frequency; /* [s] */
    const uint64_t mask = (UINT64_C(1) << 62) - 1, next = gyro->phase + gyro->phase_sample;
    const double cycles = gyro->whole_cycles + (next < gyro->phase ? 1.0 : 0.0);
    const int64_t events =
        4 * (int64_t)cycles + (int64_t)(next >> 62) - (int64_t)(gyro->phase >> 62);
    const bool reads_cycles = gyro->design.readout.stripping == IMK_RING_LASER_PERIODS;
    double time = 0.0;
    double coming = ((double)(mask + 1 - (gyro->phase & mask)) * 0x1p-62) * quarter;
    unsigned place = (unsigned)(gyro->phase >> 62);
    for (int64_t i = 0; i < events; i++, coming += quarter) {
        place = (place + 1) & 3;
        /* odd quarters are turns, even ones pass through the middle with a new amplitude */
        const bool turns = place & 1;
        if (turns || (place == 0 && reads_cycles)) {
            const double noise =
                gyro->noise * sqrt(coming - time) * imki_draw(&gyro->quantum_draws);
            imki_fringes_add(&gyro->beat, gyro->slope * rate * (coming - time) + noise);
            time = coming;
        }
        if (place == 0 && reads_cycles)
            imki_ring_laser_latch(gyro, gyro->beat);
        if (turns)
            imki_fringes_add(&gyro->beat, kick(gyro, gyro->beat.part + gyro->scatter,
                                               place == 1 ? 1.0 : -1.0, rate));
        else
            imki_ring_laser_next_amplitude(gyro);
    }
    const double rest = gyro->dt > time ? gyro->dt - time : 0.0;
    imki_fringes_add(&gyro->beat, gyro->slope * rate * rest +
                                      gyro->noise * sqrt(rest) * imki_draw(&gyro->quantum_draws));
    double cosine;
    gyro->phase = next;
    imki_ring_laser_sine((double)next * 0x1p-64, &gyro->sine, &cosine);
}
