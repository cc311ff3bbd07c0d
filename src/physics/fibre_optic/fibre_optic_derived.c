/* SPDX-License-Identifier: Apache-2.0 */
/* The fibre-optic gyro: what follows from its parts. */
#include "fibre_optic_internal.h"
#include "physics/derived_rows_internal.h"

#define DESIGN imk_fibre_optic

static const double stated_rate = IMKI_DEGREE; /* 1 deg/s */

/* Phase and delay are the same thing: a wavelength passes in lambda/c. */
VALUE(delay,
      imk_fibre_optic_scale(d) * stated_rate * d->wavelength / (2.0 * IMKI_PI * IMKI_LIGHT_SPEED))
VALUE(turns, imk_fibre_optic_turns(d))
VALUE(area, imk_fibre_optic_turns(d) * 0.25 * IMKI_PI * d->coil_diameter * d->coil_diameter)
VALUE(scale, imk_fibre_optic_scale(d))
VALUE(fringe, imk_fibre_optic_fringe_rate(d))
VALUE(unambiguous, 0.5 * imk_fibre_optic_fringe_rate(d))
VALUE(transit, imk_fibre_optic_transit_time(d))
VALUE(proper, imk_fibre_optic_proper_frequency(d))
VALUE(reset, imk_fibre_optic_reset_angle(d))
VALUE_IF(resets, d->loop == IMK_FIBRE_OPTIC_CLOSED, 1.0 / imk_fibre_optic_reset_angle(d))
VALUE_IF(count, d->output_bits > 0, imki_fibre_optic_count_angle(d))
VALUE_IF(counts, d->output_bits > 0, 1.0 / imki_fibre_optic_count_angle(d))
VALUE(power, imk_fibre_optic_detector_power(d))
VALUE(coherence, d->wavelength * d->wavelength / d->linewidth)
VALUE(shupe, imk_fibre_optic_shupe_coefficient(d))
VALUE_IF(gain, d->loop == IMK_FIBRE_OPTIC_CLOSED, imk_fibre_optic_effective_gain(d))
VALUE_IF(bandwidth, imk_fibre_optic_bandwidth(d) > 0.0, imk_fibre_optic_bandwidth(d))

const imk_derived imki_fibre_optic_derived[] = {
    {"number of turns", "N", "1", "1", "N = L/(pi D)", "[LEFEVRE2014]", turns, NULL},
    {"enclosed area", "N A", "m^2", "m^2", "N A = N pi D^2/4", "[LEFEVRE2014]", area, NULL},
    {"Sagnac time delay at 1 deg/s", "Dt", "s", "s", "Dt = 4 N A W/c^2 = L D W/c^2", "[SAGNAC1913]",
     delay, NULL},
    {"Sagnac phase per rate", "K", "rad/(rad/s)", "mrad/(deg/s)", "K = 2 pi L D/(lambda c)",
     "[VALI1976]", scale, NULL},
    {"rate of a fringe", "W_2pi", "rad/s", "deg/s", "W_2pi = 2 pi/K", "[LEFEVRE2014]", fringe,
     NULL},
    {"unambiguous rate, either way", "W_pi", "rad/s", "deg/s", "W_pi = pi/K", "[LEFEVRE2014]",
     unambiguous, NULL},
    {"transit time", "tau", "s", "us", "tau = n L/c", "[LEFEVRE2014]", transit, NULL},
    {"proper (eigen) frequency", "f_p", "Hz", "kHz", "f_p = 1/(2 tau)", "[LEFEVRE2014]", proper,
     NULL},
    {"angle between two resets of the ramp", "a_r", "rad", "arcsec", "a_r = lambda n/D",
     "[LEFEVRE2014]", reset, NULL},
    {"resets of the ramp per rate", "R", "1/rad", "Hz/(deg/s)", "R = D/(lambda n)", "[LEFEVRE2014]",
     resets, "an open loop has no ramp (loop.mode)"},
    {"angle of a count", "a_c", "rad", "arcsec", "a_c = lambda n/(D 2^bits)", "[LEFEVRE2014]",
     count, "the angle is not rounded (output.bits)"},
    {"counts per rate", "1/a_c", "1/rad", "Hz/(deg/s)", "1/a_c = D 2^bits/(lambda n)",
     "[LEFEVRE2014]", counts, "the angle is not rounded (output.bits)"},
    {"power on a bright fringe", "P_0", "W", "uW", "P_0 = P_source e^(-loss - attenuation L)",
     "[LEFEVRE2014]", power, NULL},
    {"coherence length of the source", "L_c", "m", "um", "L_c = lambda^2/linewidth",
     "[LEFEVRE2014]", coherence, NULL},
    {"Shupe error per rate of temperature", "W_S", "rad/s/(K/s)", "deg/h/(K/min)",
     "W_S = residual n (dn/dT) L/(4 D)", "[SHUPE1980]", shupe, NULL},
    {"effective loop gain", "g", "1", "1", "g: share of an error corrected in 2 tau",
     "[LEFEVRE2014]", gain, "an open loop has no feedback (loop.mode)"},
    {"loop bandwidth (-3 dB)", "f_b", "Hz", "kHz", "f_b: sin^2(2 pi f_b tau) = g^2/(4 (1 - g))",
     "[LEFEVRE2014]", bandwidth,
     "there is no loop, or it loses less than 3 dB up to half its sampling rate"},
    DERIVED_END,
};
