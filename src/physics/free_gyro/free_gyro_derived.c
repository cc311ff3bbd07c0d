/* SPDX-License-Identifier: Apache-2.0 */
/* The free gyro: what follows from its parts. */
#include "free_gyro_internal.h"
#include "imukit/earth.h"
#include "imukit/elementary.h"
#include "physics/derived_rows_internal.h"

#define DESIGN imk_free_gyro

#define LATITUDE (45.0 * IMKI_DEGREE)

static double unbalance(const DESIGN *d, int axis)
{
    double sensitivity[3];
    imk_free_gyro_unbalance(d, sensitivity);
    return sensitivity[axis];
}

VALUE(momentum, imk_free_gyro_momentum(d))
VALUE(per_torque, -imk_free_gyro_precession(d, 0.0, 1.0))
VALUE(nutation, imk_free_gyro_nutation(d, 0.0))
VALUE(walk, imk_free_gyro_gimbal_walk(d, 45.0 * IMKI_DEGREE, d->start_nutation))
VALUE(along_x, unbalance(d, 0))
VALUE(along_z, unbalance(d, 2))
VALUE(compliance, imk_free_gyro_anisoelasticity(d))
VALUE(friction, d->coulomb_friction *per_torque(d))
VALUE(earth_torque, imk_free_gyro_momentum(d) * IMK_EARTH_RATE)

static double apparent(const void *design)
{
    (void)design;
    return IMK_EARTH_RATE * imk_sin(LATITUDE);
}

const imk_derived imki_free_gyro_derived[] = {
    {"angular momentum", "H", "kg*m^2/s", "kg*m^2/s", "H = C_r spin", "[LAWRENCE1998]", momentum,
     NULL},
    {"precession per torque", "w_p/M", "rad/s/(N*m)", "deg/h/(uN*m)", "w_p/M = 1/H",
     "[LAWRENCE1998]", per_torque, NULL},
    {"nutation frequency", "f_n", "Hz", "Hz", "f_n = H/(2 pi sqrt((A + Ao) B))", "[ARNOLD1961]",
     nutation, NULL},
    {"gimbal walk at 45 deg, after the start's nutation", "w_g", "rad/s", "deg/h",
     "w_g = -a^2 H sin(b) (Ao + C)/(2 J^2)", "[PLYMALE1955]", walk, NULL},
    {"mass unbalance drift, force along x", "D_x", "rad/s/(m/s^2)", "deg/h/g", "D_x = -m d_z/H",
     "[LAWRENCE1998]", along_x, NULL},
    {"mass unbalance drift, force along z", "D_z", "rad/s/(m/s^2)", "deg/h/g", "D_z = m d_x/H",
     "[LAWRENCE1998]", along_z, NULL},
    {"anisoelastic drift", "D_xz", "rad/s/(m/s^2)^2", "deg/h/g^2", "D_xz = m^2 (C_z - C_x)/H",
     "[LAWRENCE1998]", compliance, NULL},
    {"drift by bearing friction", "D_f", "rad/s", "deg/h", "D_f = M_c/H", "[LAWRENCE1998]",
     friction, NULL},
    {"apparent drift at latitude 45 deg", "w_v", "rad/s", "deg/h", "w_v = W_E sin(latitude)",
     "[TITTERTON2004]", apparent, NULL},
    {"torque to precess it at Earth's rate", "M_E", "N*m", "uN*m", "M_E = H W_E", "[LAWRENCE1998]",
     earth_torque, NULL},
    DERIVED_END,
};
