/* SPDX-License-Identifier: Apache-2.0 */
/* Do the instruments have the temperature they are said to have?
 *
 * usage: equipartition [seed]
 *
 * Friction at the temperature T pushes back: every degree of freedom that it damps holds the energy
 * kB T/2 on the average, whatever the friction, the springs and the rate of turn. This program runs
 * each instrument with Brownian motion at the full level, as a design whose energies are soon
 * forgotten, with nothing else that is random, and compares the mean energies with that. Standard
 * deviations are those of the means of 100 parts of the run. A ratio may differ from 1 by 1 %, or
 * by 4 standard deviations where these are more; a standard deviation above 0.33 % is a failure
 * too. */
#include "imukit/imukit.h"
#include "imukit/physics.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FREEDOMS = 3, PARTS = 100, SETTLE = 200 };

static const double pi = 3.14159265358979324;
static const double boltzmann = 1.380649e-23; /* exact, SI */
static const double room = 293.15;            /* K */
static const double sigma_limit = 0.0033;

typedef union design_of {
    imk_free_gyro free_gyro;
    imk_mems_accelerometer mems;
    imk_pendulous_servo servo;
    imk_rate_gyro rate_gyro;
    imk_rate_integrating_gyro floated;
    imk_shell_gyro shell;
    imk_tuning_fork fork;
    imk_vibrating_beam beam;
} design_of;

typedef struct trial trial;
struct trial {
    const char *instrument;
    const char *signals[2];         /* that tell the energies */
    const char *freedoms[FREEDOMS]; /* up to the first NULL */
    /* Energies over what they should be on the average, from those signals. */
    void (*energies)(const trial *t, const double *signal, double *ratio);
    void (*prepare)(trial *t);
    size_t samples;
    double rate, step;      /* [Hz], [s]; 0: the instrument's own */
    double turning;         /* rate of the case about x [rad/s] */
    double relaxation;      /* time in which energies fall to 1/e [s] */
    double scale[FREEDOMS]; /* energy over its due mean per square of a signal */
    design_of design;
};

/* ---- instruments ----------------------------------------------------------------------------- */

/* One signal and its square for every degree of freedom. */
static void squares(const trial *t, const double *signal, double *ratio)
{
    for (int i = 0; i < 2 && t->freedoms[i]; i++)
        ratio[i] = t->scale[i] * signal[i] * signal[i];
}

/* The wheel turns at an eighth of its speed. The inner angle's nutation of the amplitude a has the
 * energy (H a)^2/2J, of both gimbals together. Friction acts once a step h, of which the energy
 * lacks D h/2J: friction is low, and the run long. */
static void prepare_free_gyro(trial *t)
{
    imk_free_gyro d = imk_free_gyro_default();
    for (int i = 0; i < 3; i++)
        d.unbalance[i] = d.compliance[i] = 0.0;
    d.spin_rate /= 8.0;
    d.coulomb_friction = d.torque_temperature = d.torque_repeatability = d.torque_instability = 0.0;
    d.pickoff_resolution = d.pickoff_noise = d.start_nutation = 0.0;
    d.viscous_friction = 1.5e-4;
    d.torque_noise = imk_thermal_torque(d.viscous_friction); /* not implied by the friction here */
    const double h = imk_free_gyro_momentum(&d), nutation = imk_free_gyro_nutation(&d, 0.0);
    const double j = d.outer_inertia[0] + d.inner_inertia[0] + d.rotor_transverse;
    const double b = d.inner_inertia[1] + d.rotor_transverse;
    t->scale[0] = h * h / (2.0 * j * boltzmann * room);
    t->relaxation = 1.0 / (d.viscous_friction * (1.0 / j + 1.0 / b));
    t->rate = 1.0 / (2.0 * t->relaxation);
    t->step = 1.0 / (20.0 * nutation);
    t->design.free_gyro = d;
}

static void prepare_rate_gyro(trial *t)
{
    imk_rate_gyro d = imk_rate_gyro_default();
    d.torque = (imk_error_torque){0};
    t->scale[0] = d.stiffness / (boltzmann * room);
    t->scale[1] = d.output_inertia / (boltzmann * room);
    t->relaxation = d.output_inertia / d.damping;
    t->rate = 80.0;
    t->step = 1.0 / 320.0;
    t->design.rate_gyro = d;
}

/* Without a loop, held by flex leads so stiff that the float swings: damping ratio 0.7. */
static void prepare_floated(trial *t)
{
    imk_rate_integrating_gyro d = imk_rate_integrating_gyro_default();
    d.torque = (imk_error_torque){0};
    d.rebalance = IMK_REBALANCE_OPEN;
    d.pickoff_noise = 0.0;
    d.stiffness = d.damping * d.damping / (1.96 * d.output_inertia);
    t->scale[0] = d.stiffness / (boltzmann * room);
    t->scale[1] = d.output_inertia / (boltzmann * room);
    t->relaxation = d.output_inertia / d.damping;
    t->rate = 100.0;
    t->design.floated = d;
}

/* The drive can hold an amplitude of 0.1 nm and hardly more, a part in 1e4 of the thermal motion:
 * it adds less than that to the energy. */
static void prepare_fork(trial *t)
{
    imk_tuning_fork d = imk_tuning_fork_default();
    d.mass = 1e-15;
    d.drive.frequency = 300.0;
    d.drive.q = d.sense.q = 20.0;
    d.sense.split = 12.0;
    d.drive.loop_bandwidth = 8.0;
    d.drive.amplitude = 1e-10;
    d.drive.force_angle = d.tines.asymmetry = 0.0;
    d.drive.amplitude_repeatability = d.drive.pickoff_noise = d.sense.pickoff_noise = 0.0;
    memset(&d.temperature, 0, sizeof d.temperature);
    d.quadrature = d.damping_coupling = 0.0;
    d.phase.error = d.phase.repeatability = d.phase.instability = 0.0;
    d.output.bandwidth = d.output.range = 0.0;
    const double wd = 2.0 * pi * d.drive.frequency;
    const double ws = wd + 2.0 * pi * d.sense.split;
    d.drive.force_limit = 1.2 * d.mass * wd * wd * d.drive.amplitude / d.drive.q;
    t->scale[0] = d.mass * wd * wd / (boltzmann * room);
    t->scale[1] = d.mass * ws * ws / (boltzmann * room);
    t->relaxation = d.drive.q / wd;
    t->rate = d.drive.frequency / 8.0;
    t->turning = 20.0;
    t->design.fork = d;
}

/* x and y of the pattern, without electronics. Unequal damping is a bath of one temperature. */
static void prepare_shell(trial *t)
{
    imk_shell_gyro d = imk_shell_gyro_default();
    d.mode = IMK_SHELL_FREE;
    d.resonator.shape = IMK_SHELL_HEMISPHERE;
    d.resonator.mass = 1e-6;
    d.resonator.frequency = 1000.0;
    d.resonator.quality = 20.0;
    d.resonator.frequency_temperature = d.resonator.damping_temperature = 0.0;
    memset(&d.anisotropy, 0, sizeof d.anisotropy);
    d.anisotropy.damping_difference = 100.0; /* of 314 */
    d.anisotropy.damping_angle = 0.3;
    memset(&d.pickoff, 0, sizeof d.pickoff);
    memset(&d.forcer, 0, sizeof d.forcer);
    memset(&d.package, 0, sizeof d.package);
    d.pattern.amplitude = 1e-15;
    d.control.cycles = 1;
    d.control.rebalance_bandwidth = d.control.support_bandwidth = 20.0;
    d.control.phase_error = 0.0;
    const double w = 2.0 * pi * d.resonator.frequency;
    t->scale[0] = t->scale[1] = d.resonator.mass * w * w / (boltzmann * room);
    t->relaxation = d.resonator.quality / w;
    t->rate = d.resonator.frequency / 10.0;
    t->turning = 20.0;
    t->design.shell = d;
}

/* Long and short axis of the pattern's ellipse: a^2 + q^2 is twice the energy over m w^2, of four
 * degrees of freedom. */
static void ellipse(const trial *t, const double *signal, double *ratio)
{
    ratio[0] = 0.25 * t->scale[0] * (signal[0] * signal[0] + signal[1] * signal[1]);
}

/* A mass so small that it swings over a good part of its gap, between plates with a voltage, and a
 * film that damps the more the nearer it is to one of them. */
static void prepare_mems(trial *t)
{
    imk_mems_accelerometer d = imk_mems_accelerometer_default();
    d.mass = 2e-16;
    d.frequency = 5000.0;
    d.quality = 0.6;
    d.temperature = 300.0;
    d.squeeze_film = true;
    d.area = 1e-9;
    d.voltage = 3e-3;
    d.stop = 0.95;
    d.restitution = 1.0;
    d.offset = d.tilt_y = d.pickoff_noise = d.output_bandwidth = d.range = 0.0;
    d.bias_repeatability = d.bias_instability = d.bias_temperature = d.gain_repeatability = 0.0;
    d.spring_temperature = 0.0;
    t->relaxation = d.quality / (2.0 * pi * d.frequency);
    t->rate = d.frequency;
    t->step = 1.0 / (60.0 * d.frequency);
    t->design.mems = d;
}

/* x dU/dx = kB T in any potential that holds the mass; between double plates
 * U = k x^2/2 - c (1/(g - x) + 1/(g + x)). */
static void virial(const trial *t, const double *signal, double *ratio)
{
    const imk_mems_accelerometer *d = &t->design.mems;
    const double w = 2.0 * pi * d->frequency, x = signal[0];
    const double c = 0.5 * 8.8541878128e-12 * d->area * d->voltage * d->voltage;
    const double p = 1.0 / (d->gap - x), m = 1.0 / (d->gap + x);
    const double slope = d->mass * w * w * x - c * (p * p - m * m);
    ratio[0] = x * slope / (boltzmann * d->temperature);
    ratio[1] = d->mass * signal[1] * signal[1] / (boltzmann * d->temperature);
}

/* A controller that is a spring: no integral, and a pickoff without noise. */
static void prepare_servo(trial *t)
{
    imk_pendulous_servo d = imk_pendulous_servo_default();
    d.integral = d.pickoff_noise = d.readout_noise = d.torquer_repeatability = 0.0;
    d.hinge_torque = d.hinge_torque_repeatability = d.hinge_torque_instability = 0.0;
    t->scale[0] = (d.proportional + d.hinge_stiffness) / (boltzmann * d.temperature);
    t->relaxation = d.inertia / d.damping;
    t->rate = 500.0;
    t->step = 1.0 / (8.0 * imk_pendulous_servo_frequency(&d));
    t->design.servo = d;
}

/* The proof mass on its suspension; the force on a beam is m w^2 times its displacement. */
static void prepare_beam(trial *t)
{
    imk_vibrating_beam d = imk_vibrating_beam_default();
    d.mount_force = d.mount_force_repeatability = d.mount_force_instability = 0.0;
    const double w = 2.0 * pi * d.suspension_frequency;
    t->scale[0] = 1.0 / (d.proof_mass * w * w * boltzmann * d.temperature);
    t->relaxation = 1.0 / (2.0 * d.suspension_damping * w);
    t->rate = 1000.0;
    t->design.beam = d;
}

static trial trials[] = {
    {.instrument = "free_gyro",
     .signals = {"nutation"},
     .freedoms = {"both gimbals, motion"},
     .prepare = prepare_free_gyro,
     .energies = squares,
     .samples = 300000},
    {.instrument = "rate_gyro",
     .signals = {"gimbal_angle", "gimbal_rate"},
     .freedoms = {"gimbal, spring", "gimbal, motion"},
     .prepare = prepare_rate_gyro,
     .energies = squares,
     .samples = 1000000},
    {.instrument = "rate_integrating_gyro",
     .signals = {"float_angle", "float_rate"},
     .freedoms = {"float, spring", "float, motion"},
     .prepare = prepare_floated,
     .energies = squares,
     .samples = 1000000},
    {.instrument = "tuning_fork",
     .signals = {"drive_displacement", "sense_displacement"},
     .freedoms = {"drive mode, spring", "sense mode, spring"},
     .prepare = prepare_fork,
     .energies = squares,
     .samples = 1000000},
    {.instrument = "shell_gyro",
     .signals = {"x", "y"},
     .freedoms = {"mode x, spring", "mode y, spring"},
     .prepare = prepare_shell,
     .energies = squares,
     .samples = 1000000},
    {.instrument = "shell_gyro",
     .signals = {"amplitude", "quadrature"},
     .freedoms = {"both modes, all four"},
     .prepare = prepare_shell,
     .energies = ellipse,
     .samples = 500000},
    {.instrument = "mems_accelerometer",
     .signals = {"displacement", "velocity"},
     .freedoms = {"mass, springs and plates", "mass, motion"},
     .prepare = prepare_mems,
     .energies = virial,
     .samples = 1000000},
    {.instrument = "pendulous_servo",
     .signals = {"angle"},
     .freedoms = {"pendulum, loop as a spring"},
     .prepare = prepare_servo,
     .energies = squares,
     .samples = 1000000},
    {.instrument = "vibrating_beam",
     .signals = {"force"},
     .freedoms = {"proof mass, suspension"},
     .prepare = prepare_beam,
     .energies = squares,
     .samples = 600000},
};

/* ---- runs ------------------------------------------------------------------------------------ */

static int signal_index(const imk_instrument *instrument, const char *name)
{
    for (size_t i = 0; i < instrument->signal_count; i++)
        if (strcmp(instrument->signals[i].name, name) == 0)
            return (int)i;
    fprintf(stderr, "%s has no signal %s\n", instrument->name, name);
    exit(2);
}

static void *started(const imk_instrument *instrument, const trial *t, uint64_t seed)
{
    imk_error error = {0};
    imk_physics_settings settings = imk_physics_settings_default();
    settings.rate = t->rate;
    settings.step = t->step;
    settings.seed = seed;
    void *state = aligned_alloc(64, (instrument->state_size + 63) / 64 * 64);
    if (state && imk_instrument_init(instrument, &t->design, &settings, state, &error) == IMK_OK)
        return state;
    fprintf(stderr, "%s: %s: %s (%g, limit %g)\n", t->instrument, error.field, error.expected,
            error.value, error.limit);
    exit(2);
}

static void advance(const imk_instrument *instrument, void *state, const imk_exposure *exposure,
                    double *signals)
{
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX];
    instrument->step(state, exposure, outputs);
    instrument->observe(state, signals);
}

/* Means of the parts of a run. */
static void run(const trial *t, uint64_t seed, double means[FREEDOMS][PARTS])
{
    const imk_instrument *instrument = imk_instrument_find(t->instrument);
    int chosen[2] = {0, 0};
    for (int i = 0; i < 2 && t->signals[i]; i++)
        chosen[i] = signal_index(instrument, t->signals[i]);
    imk_exposure exposure = imk_exposure_default();
    exposure.angular_rate[0] = t->turning;
    double signals[IMK_INSTRUMENT_SIGNALS_MAX];
    void *state = started(instrument, t, seed);
    for (int i = 0; i < SETTLE; i++)
        advance(instrument, state, &exposure, signals);
    const size_t count = t->samples / PARTS;
    for (int part = 0; part < PARTS; part++) {
        double sum[FREEDOMS] = {0.0};
        for (size_t i = 0; i < count; i++) {
            double ratio[FREEDOMS] = {0.0};
            advance(instrument, state, &exposure, signals);
            t->energies(t, (const double[2]){signals[chosen[0]], signals[chosen[1]]}, ratio);
            for (int k = 0; k < FREEDOMS; k++)
                sum[k] += ratio[k];
        }
        for (int k = 0; k < FREEDOMS; k++)
            means[k][part] = sum[k] / (double)count;
    }
    free(state);
}

static bool report(const trial *t, const char *freedom, const double *means)
{
    double sum = 0.0, squares_sum = 0.0;
    for (int i = 0; i < PARTS; i++)
        sum += means[i];
    const double mean = sum / PARTS;
    for (int i = 0; i < PARTS; i++)
        squares_sum += (means[i] - mean) * (means[i] - mean);
    const double sigma = sqrt(squares_sum / (PARTS - 1) / PARTS);
    const bool good = sigma <= sigma_limit && fabs(mean - 1.0) <= fmax(0.01, 4.0 * sigma);
    printf("| `%s` | %s | %.4f | %.4f | %.2g | %s |\n", t->instrument, freedom, mean, sigma,
           (double)t->samples / (t->rate * t->relaxation), good ? "yes" : "NO");
    return good;
}

int main(int argc, char **argv)
{
    const uint64_t seed = argc > 1 ? strtoull(argv[1], NULL, 10) : 1;
    bool good = true;
    printf(
        "| instrument | degree of freedom | energy/(kB T/2) | 1 sigma | relaxation times | within "
        "1 %% |\n|---|---|---|---|---|---|\n");
    for (size_t i = 0; i < sizeof trials / sizeof *trials; i++) {
        static double means[FREEDOMS][PARTS];
        trials[i].prepare(&trials[i]);
        run(&trials[i], seed, means);
        for (int k = 0; k < FREEDOMS && trials[i].freedoms[k]; k++)
            good = report(&trials[i], trials[i].freedoms[k], means[k]) && good;
        fflush(stdout);
    }
    printf("equipartition %s\n", good ? "holds" : "DOES NOT HOLD");
    return good ? 0 : 1;
}
