/* SPDX-License-Identifier: Apache-2.0 */
/* The MEMS accelerometer: what follows from its parts. */
#include "mems_accelerometer_internal.h"
#include "physics/derived_rows_internal.h"

#define DESIGN imk_mems_accelerometer

/* Stiffness over mass where the mass is without input [1/s^2]; NaN: nothing but a loop holds it. */
static double stiffness_at_rest(const DESIGN *d)
{
    const imki_mems_point p = imki_mems_operating_point(d);
    return p.exists && p.a1 > 0.0 ? p.a1 : (double)NAN;
}

/* Change of C+ - C- there with the displacement, of one plate that of C+ [F/m]. */
static double capacitance_slope(const DESIGN *d)
{
    const double z = imki_mems_operating_point(d).z, plus = d->gap - z, minus = d->gap + z;
    const double ea = IMKI_PERMITTIVITY * d->area, first = ea / (plus * plus);
    return d->plates == IMK_MEMS_SINGLE ? first : first + ea / (minus * minus);
}

VALUE(stiffness, d->mass *imki_mems_spring(d, 0.0).first)
VALUE(softening, imk_mems_accelerometer_softening(d))
VALUE(ratio, imk_mems_accelerometer_softening(d) / stiffness(d))
VALUE(natural, sqrt(stiffness_at_rest(d)) / (2.0 * IMKI_PI))
VALUE(damping, d->mass * 2.0 * IMKI_PI * d->frequency / d->quality)
VALUE(damping_ratio, 0.5 / d->quality)
VALUE_IF(decay_time, d->quality > 0.5, d->quality / (IMKI_PI * d->frequency))
VALUE(sensitivity, 1.0 / stiffness_at_rest(d))
VALUE(capacitance, IMKI_PERMITTIVITY * d->area / d->gap)
VALUE(pickoff, capacitance_slope(d) / stiffness_at_rest(d))
VALUE(pull_in, imk_mems_accelerometer_pull_in(d))
VALUE(margin, d->voltage / imk_mems_accelerometer_pull_in(d))
VALUE(limit, imk_mems_accelerometer_limit(d))
VALUE(brownian, imk_mems_accelerometer_brownian(d))
VALUE_IF(loop, d->loop == IMK_MEMS_ANALOG, imk_mems_accelerometer_gains(d).proportional)
VALUE_IF(cycle,
         d->loop == IMK_MEMS_SIGMA_DELTA && imk_mems_accelerometer_limit_cycle(d).half_period > 0,
         d->clock / (2.0 * imk_mems_accelerometer_limit_cycle(d).half_period))

const imk_derived imki_mems_accelerometer_derived[] = {
    {"stiffness of the springs", "k", "N/m", "N/m", "k = m w0^2", "[SENTURIA2001]", stiffness,
     NULL},
    {"spring softening, mass in the middle", "k_e", "N/m", "N/m",
     "k_e = 2 eps A V^2/gap^3, one plate half of it", "[SENTURIA2001]", softening, NULL},
    {"softening, share of the stiffness", "s_e", "1", "%", "s_e = k_e/k", "[SENTURIA2001]", ratio,
     NULL},
    {"natural frequency, softened", "f_n", "Hz", "Hz",
     "f_n = sqrt((k - k_e(z))/m)/(2 pi), z at rest; bits: V^2 + U^2/2", "[SENTURIA2001]", natural,
     "the plates outweigh the springs; the loop alone holds the mass"},
    {"damping coefficient", "b", "N*s/m", "N*s/m", "b = m w0/Q", "[SENTURIA2001]", damping, NULL},
    {"damping ratio", "z", "1", "1", "z = 1/(2 Q)", "[SENTURIA2001]", damping_ratio, NULL},
    {"decay time constant", "tau", "s", "us", "tau = 2 Q/w0", "[SENTURIA2001]", decay_time,
     "the mass does not swing (proof_mass.quality)"},
    {"displacement per specific force", "x/a", "m/(m/s^2)", "nm/g", "x/a = 1/(2 pi f_n)^2",
     "[SENTURIA2001]", sensitivity,
     "the plates outweigh the springs; the loop alone holds the mass"},
    {"capacitance of a plate, mass in the middle", "C_0", "F", "pF", "C_0 = eps A/gap",
     "[SENTURIA2001]", capacitance, NULL},
    {"change of capacitance per specific force", "dC/a", "F/(m/s^2)", "fF/g",
     "dC/a = eps A (1/(gap - z)^2 + 1/(gap + z)^2) x/a, one plate: 1st", "[SENTURIA2001]", pickoff,
     "the plates outweigh the springs; the loop alone holds the mass"},
    {"pull-in voltage", "V_p", "V", "V",
     "V_p = sqrt(k gap^3/(2 eps A)), one plate 4/sqrt(27) of it", "[SENTURIA2001]", pull_in, NULL},
    {"voltage, share of pull-in", "s_V", "1", "%", "s_V = V/V_p", "[SENTURIA2001]", margin, NULL},
    {"largest specific force", "a_m", "m/s^2", "g",
     "a_m: to the stops; 2 eps A V U/(m gap^2); eps A U^2/(2 m gap^2)", "[SENTURIA2001]", limit,
     NULL},
    {"Brownian noise, one-sided", "a_B", "m/s^2/sqrt(Hz)", "ug/sqrt(Hz)",
     "a_B = sqrt(4 k_B T w0/(m Q))", "[GABRIELSON1993]", brownian, NULL},
    {"acceleration per displacement of the loop", "K_p", "1/s^2", "1/s^2",
     "K_p = (2 pi f_c)^2 - (k - k_e)/m", "[SENTURIA2001]", loop, "there is no analog loop (loop)"},
    {"limit cycle frequency", "f_l", "Hz", "kHz", "f_l = clock/(2 n), n clocks of each force",
     "[SENTURIA2001]", cycle, "there is no sigma-delta loop with a limit cycle (loop)"},
    DERIVED_END,
};
