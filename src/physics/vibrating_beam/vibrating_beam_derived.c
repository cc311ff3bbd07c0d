/* SPDX-License-Identifier: Apache-2.0 */
/* The vibrating beam accelerometer: what follows from its parts. */
#include "physics/derived_rows_internal.h"
#include "vibrating_beam_internal.h"

#define DESIGN imk_vibrating_beam

VALUE_IF(second, d->arrangement == IMK_BEAM_PAIR, imk_vibrating_beam_frequency(d, 1))
VALUE(first, imk_vibrating_beam_frequency(d, 0))
VALUE(stiffening, imk_vibrating_beam_stiffening(d))
VALUE(load, d->proof_mass)
VALUE(full_load, d->proof_mass * d->range)
VALUE(slope, imk_vibrating_beam_slope(d))
VALUE_IF(difference, d->arrangement == IMK_BEAM_PAIR,
         imk_vibrating_beam_slope(d) *
             (1.0 + imk_vibrating_beam_frequency(d, 0) / imk_vibrating_beam_frequency(d, 1)))
/* Euler's load of a bar clamped at both ends: the first at which it buckles without bending. */
VALUE(buckling, 4.0 * IMKI_PI * IMKI_PI * imki_beam_bending_stiffness(d) / (d->length * d->length))
VALUE(margin, full_load(d) / buckling(d))
VALUE(modal_mass, imki_beam_mass(d))
VALUE(decay_time, d->quality / (IMKI_PI * imk_vibrating_beam_frequency(d, 0)))
VALUE(deflection,
      1.0 / (4.0 * IMKI_PI * IMKI_PI * d->suspension_frequency * d->suspension_frequency))

const imk_derived imki_vibrating_beam_derived[] = {
    {"frequency of the first beam, unloaded", "f_01", "Hz", "kHz",
     "f_01 = 4.73004^2/(2 pi) sqrt(E I/(rho A L^4))", "[TIMOSHENKO1974]", first, NULL},
    {"frequency of the second beam, unloaded", "f_02", "Hz", "kHz", "f_02 = f_01 (1 + mismatch)",
     "[TIMOSHENKO1974]", second, "there is one beam (arrangement)"},
    {"change of the squared frequency per load", "kappa", "Hz^2/N", "Hz^2/mN",
     "kappa = 0.02458 f_01^2 L^2/(E I)", "[TIMOSHENKO1974]", stiffening, NULL},
    {"axial load per specific force", "N/a", "kg", "mN/g", "N/a = m", "[LAWRENCE1998]", load, NULL},
    {"axial load at full scale", "N_m", "N", "N", "N_m = m range", "[LAWRENCE1998]", full_load,
     NULL},
    {"buckling load", "N_b", "N", "N", "N_b = 4 pi^2 E I/L^2", "[TIMOSHENKO1961]", buckling, NULL},
    {"load at full scale, share of the buckling load", "s_b", "1", "%", "s_b = N_m/N_b",
     "[TIMOSHENKO1961]", margin, NULL},
    {"frequency per specific force, first beam", "K_1", "Hz/(m/s^2)", "Hz/g",
     "K_1 = kappa m/(2 f_01)", "[LAWRENCE1998]", slope, NULL},
    {"differential scale factor", "K_d", "Hz/(m/s^2)", "Hz/g", "K_d = kappa m (1/f_01 + 1/f_02)/2",
     "[LAWRENCE1998]", difference, "there is one beam (arrangement)"},
    {"modal mass of a beam", "m_b", "kg", "microgram", "m_b = 0.3965 rho A L", "[TIMOSHENKO1974]",
     modal_mass, NULL},
    {"decay time constant of a beam", "tau", "s", "ms", "tau = 2 Q/w = Q/(pi f_01)",
     "[TIMOSHENKO1974]", decay_time, NULL},
    {"displacement of the proof mass per specific force", "x/a", "m/(m/s^2)", "nm/g",
     "x/a = 1/(2 pi f_s)^2", "[LAWRENCE1998]", deflection, NULL},
    DERIVED_END,
};
