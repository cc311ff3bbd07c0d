/* SPDX-License-Identifier: Apache-2.0 */
/* The ring laser gyro: what follows from its parts. */
#include "imukit/earth.h"
#include "physics/derived_rows_internal.h"
#include "ring_laser_internal.h"

#define DESIGN imk_ring_laser

static const double stated_rate = IMKI_DEGREE; /* 1 deg/s */

VALUE(area, imk_ring_laser_area(d))
VALUE(delay, 4.0 * imk_ring_laser_area(d) * stated_rate / (IMKI_LIGHT_SPEED * IMKI_LIGHT_SPEED))
VALUE(fringes, imk_ring_laser_fringes_per_radian(d))
VALUE(fringe_angle, 1.0 / imk_ring_laser_fringes_per_radian(d))
VALUE(count, imk_ring_laser_count_angle(d))
VALUE(counts, 1.0 / imk_ring_laser_count_angle(d))
VALUE(earth_beat, imk_ring_laser_fringes_per_radian(d) * IMK_EARTH_RATE)
VALUE(transit, d->cavity.perimeter / IMKI_LIGHT_SPEED)
VALUE(spectral_range, IMKI_LIGHT_SPEED / d->cavity.perimeter)
VALUE(linewidth, imk_ring_laser_decay_rate(d) / (2.0 * IMKI_PI))
VALUE(lifetime, 1.0 / imk_ring_laser_decay_rate(d))
VALUE(finesse, spectral_range(d) / linewidth(d))
VALUE(quality, IMKI_LIGHT_SPEED / d->cavity.wavelength / linewidth(d))
VALUE(lock_in_beat, imk_ring_laser_fringes_per_radian(d) * d->lock_in.rate)
VALUE_IF(dither_angle, d->dither.rate > 0.0, imk_ring_laser_dither_angle(d))
VALUE_IF(dither_phase, d->dither.rate > 0.0,
         2.0 * IMKI_PI * imk_ring_laser_fringes_per_radian(d) * imk_ring_laser_dither_angle(d))
VALUE_IF(band, d->dither.rate > 0.0, imk_ring_laser_band(d, 1, NULL))
VALUE(dead_band, imk_ring_laser_dead_band(d))
VALUE_IF(lock_in_noise, d->dither.rate > 0.0, imk_ring_laser_lock_in_noise(d))
VALUE(quantum, imk_ring_laser_quantum_noise(d))
VALUE(hop, imk_ring_laser_mode_hop(d))
VALUE(hop_temperature, imk_ring_laser_hop_temperature(d))

const imk_derived imki_ring_laser_derived[] = {
    {"enclosed area", "A", "m^2", "cm^2", "A = P^2/(12 sqrt(3)), square P^2/16", "[ARONOWITZ1971]",
     area, NULL},
    {"Sagnac time delay at 1 deg/s", "Dt", "s", "s", "Dt = 4 A W/c^2", "[SAGNAC1913]", delay, NULL},
    {"scale factor, beat frequency per rate", "S", "1/rad", "Hz/(deg/s)", "S = 4 A/(lambda P)",
     "[ARONOWITZ1971]", fringes, NULL},
    {"angle of a fringe", "a_f", "rad", "arcsec", "a_f = 1/S", "[ARONOWITZ1971]", fringe_angle,
     NULL},
    {"angle of a count", "a_c", "rad", "arcsec", "a_c = 1/(m S), m = 1, 2, 4 (readout.decoding)",
     "[ARONOWITZ1971]", count, NULL},
    {"counts per angle", "1/a_c", "1/rad", "1/deg", "1/a_c = m S", "[ARONOWITZ1971]", counts, NULL},
    {"beat frequency at Earth's rate", "f_E", "Hz", "Hz", "f_E = S W_E", "[ARONOWITZ1971]",
     earth_beat, NULL},
    {"transit time of a round trip", "tau_r", "s", "ns", "tau_r = P/c", "[SIEGMAN1986]", transit,
     NULL},
    {"free spectral range", "FSR", "Hz", "GHz", "FSR = c/P", "[SIEGMAN1986]", spectral_range, NULL},
    {"cavity linewidth", "f_c", "Hz", "kHz", "f_c = c loss/(2 pi P)", "[SIEGMAN1986]", linewidth,
     NULL},
    {"photon lifetime", "tau", "s", "us", "tau = P/(c loss)", "[SIEGMAN1986]", lifetime, NULL},
    {"finesse", "F", "1", "1", "F = FSR/f_c = 2 pi/loss", "[SIEGMAN1986]", finesse, NULL},
    {"quality factor of the cavity", "Q", "1", "1", "Q = c/(lambda f_c)", "[SIEGMAN1986]", quality,
     NULL},
    {"lock-in frequency", "f_L", "Hz", "Hz", "f_L = S W_L", "[ARONOWITZ1971]", lock_in_beat, NULL},
    {"dither amplitude", "th_d", "rad", "arcsec", "th_d = W_d/(2 pi f_d)", "[ARONOWITZ1971]",
     dither_angle, "there is no dither (dither.rate)"},
    {"dither amplitude as phase of the beat", "K th_d", "rad", "rad", "K th_d = 2 pi S th_d",
     "[CHOW1985]", dither_phase, "there is no dither (dither.rate)"},
    {"distance of the lock-in bands", "W_1", "rad/s", "deg/h", "W_1 = f_d/S", "[CHOW1985]", band,
     "there is no dither (dither.rate)"},
    {"lock-in dead band that is left, half width", "W_b", "rad/s", "deg/h",
     "W_b = W_L |J_0(K th_d)| e^(-(K th_d r)^2/2)", "[CHOW1985]", dead_band, NULL},
    {"angle random walk by lock-in", "N_L", "rad/s/sqrt(Hz)", "deg/sqrt(h)",
     "N_L = W_L/sqrt(K W_d) sqrt(1 - e^(-(K th_d r)^2))", "[CHOW1985]", lock_in_noise,
     "there is no dither (dither.rate)"},
    {"angle random walk by quantum noise", "N_q", "rad/s/sqrt(Hz)", "deg/sqrt(h)",
     "N_q = (c loss/(P K)) sqrt(h nu/(loss power))", "[SCHREIBER2013]", quantum, NULL},
    {"change of scale by a mode hop", "dS/S", "1", "ppm", "dS/S = lambda/P", "[ARONOWITZ1971]", hop,
     NULL},
    {"warming to the first mode hop", "dT", "K", "K", "dT = stroke/(2 P expansion)",
     "[ARONOWITZ1971]", hop_temperature, "the path does not expand (path_length.expansion)"},
    DERIVED_END,
};
