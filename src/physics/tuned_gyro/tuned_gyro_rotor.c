/* SPDX-License-Identifier: Apache-2.0 */
/* The rotor of a tuned gyro over a step, in the axes of the shaft, and its capture loop.
 *
 * A vector fixed in the case turns backwards in these axes, v1' = N v2, v2' = -N v1; taken into the
 * system as states, the response over a step is exact. */
#include "tuned_gyro_internal.h"

#include "base/algebra/linear_system_internal.h"

#include <math.h>
#include <string.h>

enum { ROTOR = IMKI_ROTOR_STATES, SIZE = IMKI_ROTOR_STATES + IMKI_ROTOR_FORCES };
/* Places of what acts on the rotor, each a pair along axes 1 and 2. */
enum { RATE = ROTOR, TORQUE = ROTOR + 2, ACCELERATION = ROTOR + 4 };

/* Steps to a turn of the shaft: the loop works once a step, and nutation is up to twice as fast as
 * the shaft. */
static const double steps_per_turn = 16.0;

double imki_tuned_gyro_longest_step(const imk_tuned_gyro *d)
{
    return 2.0 * IMKI_PI / (steps_per_turn * imk_tuned_gyro_speed(d));
}

/* With W1' = N W2 + a1 and W2' = -N W1 + a2 the rate acts as -(C + Ag - Bg + Cg) N W2 and C N W1.
 */
void imki_rotor_start(imki_rotor_step *rotor, const imk_tuned_gyro *d, double step)
{
    const double n = imk_tuned_gyro_speed(d);
    const double a_rotor = d->transverse_inertia, c_rotor = d->axial_inertia;
    const double j1 = a_rotor + d->gimbal_inertia_x, j2 = a_rotor;
    const double between = d->gimbal_inertia_z - d->gimbal_inertia_y; /* Cg - Bg */
    double a[SIZE][SIZE], phi[SIZE][SIZE];
    memset(a, 0, sizeof a);
    a[0][1] = 1.0;
    a[1][0] = -((c_rotor - a_rotor + between) * n * n + d->stiffness_x) / j1;
    a[1][1] = -d->hinge_damping / j1;
    a[1][3] = -(c_rotor - 2.0 * a_rotor) * n / j1;
    a[1][RATE + 1] = -(c_rotor + d->gimbal_inertia_x + between) * n / j1;
    a[1][TORQUE] = 1.0 / j1;
    a[1][ACCELERATION] = -1.0;
    a[2][3] = 1.0;
    a[3][2] = -((c_rotor - a_rotor) * n * n + d->stiffness_y) / j2;
    a[3][3] = -d->hinge_damping / j2;
    a[3][1] = (c_rotor - 2.0 * a_rotor) * n / j2;
    a[3][RATE] = c_rotor * n / j2;
    a[3][TORQUE + 1] = 1.0 / j2;
    a[3][ACCELERATION + 1] = -1.0;
    for (int k = ROTOR; k < SIZE; k += 2) {
        a[k][k + 1] = n;
        a[k + 1][k] = -n;
    }
    imki_exponential(SIZE, &a[0][0], step, &phi[0][0]);
    for (int i = 0; i < ROTOR; i++) {
        memcpy(rotor->phi[i], phi[i], sizeof rotor->phi[i]);
        memcpy(rotor->gamma[i], &phi[i][ROTOR], sizeof rotor->gamma[i]);
    }
}

void imki_capture_loop_start(imki_capture_loop *loop, const imk_tuned_gyro *d, double step)
{
    const double w = 2.0 * IMKI_PI * d->loop_frequency, wf = 2.0 * IMKI_PI * d->loop_filter;
    const double a[4] = {0.0, 1.0, -wf * wf, -sqrt(2.0) * wf}, b[2] = {0.0, wf * wf};
    imki_discretise(2, 1, a, b, step, &loop->filter[0][0], loop->input);
    loop->proportional = 2.0 * d->loop_damping * w;
    loop->integral = w * w;
    loop->step = step;
}

/* Largest entry of a^(2^doublings); infinite when it does not stay finite. */
static double power_norm(int n, double *a, int doublings)
{
    double square[SIZE * SIZE], largest = 0.0;
    for (int k = 0; k < doublings; k++) {
        largest = 0.0;
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++) {
                double sum = 0.0;
                for (int m = 0; m < n; m++)
                    sum += a[i * n + m] * a[m * n + j];
                square[i * n + j] = sum;
                largest = fabs(sum) > largest ? fabs(sum) : largest;
            }
        if (!(largest < 1e100))
            return (double)INFINITY;
        memcpy(a, square, (size_t)(n * n) * sizeof *a);
    }
    return largest;
}

/* The rotor in the case's axes, its gimbal averaged over a turn: with th = th_x + i th_y,
 *
 *     J th'' = i H th' + T,   T = i H (P f + I z),   J = A + Ag/2,
 *
 * f the filtered tilt, z' = f. One step of it with its loop, as the instrument takes it, is a
 * matrix; its powers fall when the loop is stable. */
bool imki_capture_loop_stable(const imk_tuned_gyro *d, double step)
{
    enum { N = 10 }; /* th_x th_y th_x' th_y', filter of x and y (2 each), integrals */
    const double h = imk_tuned_gyro_momentum(d, imk_tuned_gyro_speed(d));
    const double nutation = imk_tuned_gyro_nutation(d), per_inertia = nutation / h;
    const double a[16] = {0.0, 0.0, 1.0, 0.0,       0.0, 0.0, 0.0,      1.0,
                          0.0, 0.0, 0.0, -nutation, 0.0, 0.0, nutation, 0.0};
    const double b[8] = {0.0, 0.0, 0.0, 0.0, per_inertia, 0.0, 0.0, per_inertia};
    double phi[16], gamma[8], m[N][N];
    imki_capture_loop loop;
    imki_capture_loop_start(&loop, d, step);
    imki_discretise(4, 2, a, b, step, phi, gamma);
    memset(m, 0, sizeof m);
    for (int axis = 0; axis < 2; axis++) {
        const int filter = 4 + 2 * axis, integral = 8 + axis;
        for (int k = 0; k < 2; k++) {
            m[filter + k][filter] = loop.filter[k][0];
            m[filter + k][filter + 1] = loop.filter[k][1];
            m[filter + k][axis] = loop.input[k];
        }
        /* the integral takes the filtered tilt of this step */
        for (int j = 0; j < N; j++)
            m[integral][j] = step * m[filter][j];
        m[integral][integral] = 1.0;
    }
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++)
            m[i][j] += phi[4 * i + j];
        for (int j = 0; j < N; j++) {
            /* T_x = -H u_y, T_y = H u_x, u = P f + I z */
            const double ux = loop.proportional * m[4][j] + loop.integral * m[8][j];
            const double uy = loop.proportional * m[6][j] + loop.integral * m[9][j];
            m[i][j] += h * (d->torquer_error + 1.0) * (gamma[2 * i + 1] * ux - gamma[2 * i] * uy);
        }
    }
    return power_norm(N, &m[0][0], 24) < 1e-3;
}
