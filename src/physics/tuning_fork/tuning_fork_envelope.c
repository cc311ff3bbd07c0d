/* SPDX-License-Identifier: Apache-2.0 */
/* The tuning fork gyro without its carrier: the motion along y as a phasor that varies slowly,
 * the drive locked at its amplitude.
 *
 * In the units of the demodulated rate, q = quadrature + i rate, the averaged equation is
 *
 *     q' = -a q + a eta (xi r - u) ,   r = e^{i phase} (i (W + Wc + …) + Wq)
 *
 * a the decay rate of a free motion seen from the carrier, eta and xi the ratios of compliance and
 * of x0 wd to those the electronics assume, u the force of the closed loop (0 when it is open).
 * The electronics read m = q + n. An open loop gives out m, a closed loop
 *
 *     u = (K/a0) (m + a0 integral m)
 *
 * whose zero cancels the pole of the plant, so that u/r = K/(s + K). Output filter, and integrals
 * over the sample, are further states; all is linear and is solved exactly over a sample, noise
 * included: the force on the mass, white, of density N^2 per component, and the pickoff's n. */
#include "tuning_fork_internal.h"

#include "base/algebra/linear_system_internal.h"

#include <math.h>
#include <string.h>

enum { N = IMKI_FORK_ROWS, INPUTS = IMKI_FORK_ENVELOPE_INPUTS, NOISES = 4 };
/* states: y, controller, filter, integrals; noises: force, pickoff */
enum { Y = 0, CONTROL = 2, FILTER = 4, RATE_SUM = 6, QUADRATURE_SUM = 7, FORCE = 0, PICKOFF = 2 };

/* Add the complex gain g to the block of two rows by two columns at (row, column). */
static void add_complex(double *matrix, int columns, int row, int column, imki_phasor g)
{
    matrix[columns * row + column] += g.re;
    matrix[columns * row + column + 1] -= g.im;
    matrix[columns * (row + 1) + column] += g.im;
    matrix[columns * (row + 1) + column + 1] += g.re;
}

/* Row `to` gets `gain` times the row `part` of a complex signal made of gains of y, the controller
 * and the pickoff's noise. */
typedef struct signal {
    imki_phasor y, control, pickoff;
} signal;

static void add_part(double a[N * N], double noise[N * NOISES], int to, double gain,
                     const signal *from, int part)
{
    const imki_phasor gains[] = {from->y, from->control, from->pickoff};
    double *const row[] = {&a[N * to + Y], &a[N * to + CONTROL], &noise[NOISES * to + PICKOFF]};
    for (int i = 0; i < 3; i++) {
        row[i][0] += gain * (part == 0 ? gains[i].re : gains[i].im);
        row[i][1] += gain * (part == 0 ? -gains[i].im : gains[i].re);
    }
}

static void filter_rows(const imk_tuning_fork *design, const signal *output, double a[N * N],
                        double noise[N * NOISES])
{
    const double w = imki_fork_filter_frequency(design), damping = design->output.damping;
    if (!(w > 0.0)) {
        add_part(a, noise, RATE_SUM, 1.0, output, 1);
        return;
    }
    a[N * RATE_SUM + FILTER] = 1.0;
    if (!(damping > 0.0)) {
        a[N * FILTER + FILTER] = -w;
        add_part(a, noise, FILTER, w, output, 1);
        return;
    }
    a[N * FILTER + FILTER + 1] = w;
    a[N * (FILTER + 1) + FILTER] = -w;
    a[N * (FILTER + 1) + FILTER + 1] = -2.0 * damping * w;
    add_part(a, noise, FILTER + 1, w, output, 1);
}

static void equations(const imk_tuning_fork *design, double temperature, double a[N * N],
                      double b[N * INPUTS], double noise[N * NOISES])
{
    const imki_fork_point point = imki_fork_at(design, temperature);
    const imki_fork_point nominal = imki_fork_at(design, IMKI_DESIGN_TEMPERATURE);
    const imki_phasor decay = imki_fork_decay(&point), zero = imki_fork_decay(&nominal);
    const double xi = imki_fork_force_ratio(design, &point);
    const imki_phasor rho = imki_fork_motion_ratio(design, &point);
    const imki_phasor drive = imki_phasor_product(decay, rho); /* a eta xi */
    const imki_phasor force = {drive.re / xi, drive.im / xi};  /* a eta */
    const double loop = 2.0 * IMKI_PI * design->sense.bandwidth;
    signal output = {{1.0, 0.0}, {0.0, 0.0}, {1.0, 0.0}}; /* m */
    memset(a, 0, N * N * sizeof *a);
    memset(b, 0, N * INPUTS * sizeof *b);
    memset(noise, 0, N * NOISES * sizeof *noise);
    add_complex(a, N, Y, Y, (imki_phasor){-decay.re, -decay.im});
    add_complex(b, INPUTS, Y, 0, drive);
    const double brownian = imk_tuning_fork_brownian_noise(design, temperature) *
                            sqrt(point.sense_damping / nominal.sense_damping);
    const double pickoff = imk_tuning_fork_pickoff_noise(design);
    add_complex(noise, NOISES, Y, FORCE, (imki_phasor){force.re * brownian, force.im * brownian});
    output.pickoff.re *= pickoff;
    if (design->sense.loop == IMK_TUNING_FORK_CLOSED) {
        const imki_phasor inverse = imki_phasor_inverse(zero);
        const imki_phasor gain = {loop * inverse.re, loop * inverse.im};
        const imki_phasor back = imki_phasor_product(force, gain);
        add_complex(a, N, CONTROL, Y, (imki_phasor){1.0, 0.0});
        add_complex(noise, NOISES, CONTROL, PICKOFF, (imki_phasor){pickoff, 0.0});
        add_complex(a, N, Y, Y, (imki_phasor){-back.re, -back.im});
        add_complex(a, N, Y, CONTROL, (imki_phasor){-loop * force.re, -loop * force.im});
        add_complex(noise, NOISES, Y, PICKOFF,
                    (imki_phasor){-back.re * pickoff, -back.im * pickoff});
        output = (signal){gain, {loop, 0.0}, {gain.re * pickoff, gain.im * pickoff}};
    }
    add_part(a, noise, QUADRATURE_SUM, 1.0, &output, 0);
    filter_rows(design, &output, a, noise);
}

void imki_fork_envelope_design(const imk_tuning_fork *design, double temperature, double sample,
                               bool with_noise, imki_fork_envelope *envelope)
{
    double a[N * N], b[N * INPUTS], noise[N * NOISES], density[N * N];
    double phi[N * N], gamma[N * INPUTS], q[N * N];
    equations(design, temperature, a, b, noise);
    imki_discretise(N, INPUTS, a, b, sample, phi, gamma);
    memset(q, 0, sizeof q);
    if (with_noise) {
        for (int i = 0; i < N; i++)
            for (int j = 0; j < N; j++) {
                density[N * i + j] = 0.0;
                for (int k = 0; k < NOISES; k++)
                    density[N * i + j] += noise[NOISES * i + k] * noise[NOISES * j + k];
            }
        imki_step_covariance(N, a, density, sample, q);
        imki_covariance_root(N, q, q);
    }
    for (int row = 0; row < N; row++) {
        for (int c = 0; c < N; c++) {
            envelope->column[c][row] = phi[N * row + c];
            envelope->column[N + INPUTS + c][row] = q[N * row + c];
        }
        for (int c = 0; c < INPUTS; c++)
            envelope->column[N + c][row] = gamma[INPUTS * row + c];
    }
}
