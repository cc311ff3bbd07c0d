/* SPDX-License-Identifier: Apache-2.0 */
/* The tuning fork gyro: what follows from its parts. */
#include "physics/derived_rows_internal.h"
#include "tuning_fork_internal.h"

#define DESIGN imk_tuning_fork

static imki_fork_point usual(const DESIGN *d)
{
    return imki_fork_at(d, IMKI_DESIGN_TEMPERATURE);
}

VALUE(drive_frequency, usual(d).drive / (2.0 * IMKI_PI))
VALUE(sense_frequency, usual(d).sense / (2.0 * IMKI_PI))
VALUE(split, (usual(d).sense - usual(d).drive) / (2.0 * IMKI_PI))
VALUE(drive_stiffness, d->mass *usual(d).drive *usual(d).drive)
VALUE(sense_stiffness, d->mass *usual(d).sense *usual(d).sense)
VALUE(drive_time, 2.0 / usual(d).drive_damping)
VALUE(sense_time, 2.0 / usual(d).sense_damping)
VALUE(speed, d->drive.amplitude *usual(d).drive)
VALUE(coriolis, imki_fork_coriolis(d))
VALUE(force, d->mass *imki_fork_coriolis(d))
VALUE(response, imk_tuning_fork_response(d))
VALUE(drive_force, imk_tuning_fork_drive_force(d))
VALUE_IF(bandwidth, d->sense.loop == IMK_TUNING_FORK_OPEN, imk_tuning_fork_bandwidth(d))
VALUE(brownian, imk_tuning_fork_brownian_noise(d, IMKI_DESIGN_TEMPERATURE))

const imk_derived imki_tuning_fork_derived[] = {
    {"drive frequency", "f_d", "Hz", "kHz", "f_d = wd/(2 pi)", "[SHKEL2006]", drive_frequency,
     NULL},
    {"sense frequency", "f_s", "Hz", "kHz", "f_s = f_d + split", "[SHKEL2006]", sense_frequency,
     NULL},
    {"frequency split", "Df", "Hz", "Hz", "Df = f_s - f_d", "[SHKEL2006]", split, NULL},
    {"stiffness of the drive mode", "k_d", "N/m", "N/m", "k_d = m wd^2", "[SHKEL2006]",
     drive_stiffness, NULL},
    {"stiffness of the sense mode", "k_s", "N/m", "N/m", "k_s = m ws^2", "[SHKEL2006]",
     sense_stiffness, NULL},
    {"decay time constant of the drive mode", "tau_d", "s", "ms", "tau_d = 2 Qd/wd", "[LYNCH1995]",
     drive_time, NULL},
    {"decay time constant of the sense mode", "tau_s", "s", "ms", "tau_s = 2 Qs/ws", "[LYNCH1995]",
     sense_time, NULL},
    {"peak speed of the drive motion", "v", "m/s", "m/s", "v = x0 wd", "[SHKEL2006]", speed, NULL},
    {"Coriolis acceleration per rate", "a_c", "m/s^2/(rad/s)", "m/s^2/(deg/s)", "a_c = 2 k x0 wd",
     "[SHKEL2006]", coriolis, NULL},
    {"Coriolis force per rate", "F_c", "N/(rad/s)", "nN/(deg/s)", "F_c = 2 k m x0 wd",
     "[SHKEL2006]", force, NULL},
    {"Coriolis gain, sense motion per rate", "y/W", "m/(rad/s)", "pm/(deg/s)",
     "y/W = 2 k x0 wd/|ws^2 - wd^2 + i wd ws/Qs|", "[SHKEL2006]", response, NULL},
    {"force that holds the drive amplitude", "F_d", "N", "uN", "F_d = m wd^2 x0/Qd", "[SHKEL2006]",
     drive_force, NULL},
    {"bandwidth of the sense mode (3 dB)", "f_b", "Hz", "Hz",
     "f_b: |G(f_b)|^2 = 2 or 1/2, near 0.54 Df", "[SHKEL2006]", bandwidth,
     "a force holds the sense motion (sense.loop)"},
    {"angle random walk by Brownian motion", "N_B", "rad/s/sqrt(Hz)", "deg/sqrt(h)",
     "N_B = sqrt(k_B T ws/(m Qs))/(k x0 wd)", "[LELAND2005]", brownian, NULL},
    DERIVED_END,
};
