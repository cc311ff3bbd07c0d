/* SPDX-License-Identifier: Apache-2.0 */
/* Running a tuning fork gyro. Full level: frame by frame (tuning_fork_frame.c), and behind each the
 * electronics, once a cycle,
 *
 *     amplitude control   u += G (e - e^{-g T} e_before),  e = amplitude due - amplitude read
 *     phase lock          psi = sin(phase of x - reference),  reference += wp T psi,
 *                         frequency += (wp^2/4) T psi
 *     demodulation        m = quadrature + i rate = e^{i phase} Y/(-2 k x0 wd H)
 *     closed loop         u += G (m - e^{-a T} m_before),  force 2 k x0 wd u e^{-i phase}
 *
 * The zeros of both controllers are the poles of what they control, so that each loop is one of
 * first order at its bandwidth. Slow level: tuning_fork_envelope.c. */
#include "tuning_fork_internal.h"

#include "base/algebra/linear_system_internal.h"
#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

/* 1 - e^{-(x + iy)}, without cancellation. */
static imki_phasor rise(double x, double y)
{
    const double fall = imk_expm1(-x), s = imk_sin(0.5 * y);
    return (imki_phasor){2.0 * s * s - fall * imk_cos(y), (1.0 + fall) * imk_sin(y)};
}

static void filter_design(const imk_tuning_fork *design, double frame_time,
                          imki_fork_electronics *e)
{
    const double w = imki_fork_filter_frequency(design), damping = design->output.damping;
    e->filter_order = !(w > 0.0) ? 0 : damping > 0.0 ? 2 : 1;
    const double first[] = {-w}, second[] = {0.0, w, -w, -2.0 * damping * w};
    const double input_first[] = {w}, input_second[] = {0.0, w};
    if (e->filter_order > 0)
        imki_discretise(e->filter_order, 1, e->filter_order == 1 ? first : second,
                        e->filter_order == 1 ? input_first : input_second, frame_time,
                        e->filter_phi, e->filter_gamma);
}

void imki_fork_electronics_design(const imk_tuning_fork *design, double frame_time,
                                  imki_fork_electronics *e)
{
    const imki_fork_point point = imki_fork_at(design, IMKI_DESIGN_TEMPERATURE);
    const double bandwidth = 2.0 * IMKI_PI * design->drive.loop_bandwidth;
    const double g = 0.5 * point.drive_damping;
    memset(e, 0, sizeof *e);
    e->frame_time = frame_time;
    e->force_limit = design->drive.force_limit / design->mass;
    e->agc_zero = imk_exp(-g * frame_time);
    e->agc_gain = bandwidth * frame_time * 2.0 * point.drive * g / -imk_expm1(-g * frame_time);
    e->pll_gain = bandwidth * frame_time;
    e->pll_integral = 0.25 * bandwidth * bandwidth * frame_time;
    e->coriolis = imki_fork_coriolis(design);
    const imki_phasor inverse = imki_phasor_inverse(imki_fork_compliance(&point));
    e->to_rate = (imki_phasor){-inverse.re / e->coriolis, -inverse.im / e->coriolis};
    const imki_phasor decay = imki_fork_decay(&point);
    const imki_phasor step = rise(decay.re * frame_time, decay.im * frame_time);
    const imki_phasor gain = imki_phasor_inverse(step);
    const double loop = 2.0 * IMKI_PI * design->sense.bandwidth * frame_time;
    e->closed = design->sense.loop == IMK_TUNING_FORK_CLOSED;
    e->loop_gain = (imki_phasor){loop * gain.re, loop * gain.im};
    e->loop_zero = (imki_phasor){1.0 - step.re, -step.im};
    e->range = design->output.range;
    filter_design(design, frame_time, e);
}

static double clamp(double value, double low, double high)
{
    return value < low ? low : value > high ? high : value;
}

/* ---- full level ------------------------------------------------------------------------------ */

/* The forces of a frame in its own phase: the drive's a quarter turn ahead of x, the part of it
 * along y, and the closed loop's. */
static void frame_forces(const imki_fork_state *state, double force[5])
{
    const imki_phasor turn = state->reference_turn;
    const imki_phasor drive = imki_phasor_product(turn, (imki_phasor){0.0, state->drive_force});
    imki_phasor sense = {0.0, 0.0};
    if (state->electronics.closed) {
        const double gain = state->electronics.coriolis;
        const imki_phasor back = {gain * state->phase_turn.re, -gain * state->phase_turn.im};
        sense = imki_phasor_product(turn, imki_phasor_product(back, state->rebalance));
    }
    force[0] = drive.re;
    force[1] = drive.im;
    force[2] = sense.re - state->force_angle * drive.re;
    force[3] = sense.im - state->force_angle * drive.im;
    force[4] = state->constant;
}

static void control_drive(imki_fork_state *state, double due)
{
    const imki_fork_electronics *e = &state->electronics;
    const imki_phasor x = state->drive_motion;
    const double size = sqrt(x.re * x.re + x.im * x.im), error = due - size;
    /* as long as there is hardly any motion its phase says nothing */
    const double least = 0.05 * due, psi = x.im / (size > least ? size : least);
    const double force =
        state->drive_force + e->agc_gain * (error - e->agc_zero * state->amplitude_error_before);
    state->drive_force = clamp(force, 0.0, e->force_limit);
    state->amplitude_error_before = error;
    state->detuning += e->pll_integral * psi;
    const double turn = (double)state->frame.steps * state->frame.angle +
                        state->detuning * e->frame_time + e->pll_gain * psi;
    const double next = state->reference + turn, cycle = 2.0 * IMKI_PI;
    state->reference = next - cycle * floor(next / cycle);
    state->reference_turn = (imki_phasor){imk_cos(state->reference), imk_sin(state->reference)};
}

static void control_sense(imki_fork_state *state)
{
    const imki_fork_electronics *e = &state->electronics;
    const imki_phasor to_rate = imki_phasor_product(state->phase_turn, e->to_rate);
    const imki_phasor m = imki_phasor_product(to_rate, state->sense_motion);
    if (!e->closed) {
        state->measured = m;
        return;
    }
    const imki_phasor before = imki_phasor_product(e->loop_zero, state->measured_before);
    const imki_phasor change =
        imki_phasor_product(e->loop_gain, (imki_phasor){m.re - before.re, m.im - before.im});
    state->rebalance.re += change.re;
    state->rebalance.im += change.im;
    if (e->range > 0.0)
        state->rebalance.im = clamp(state->rebalance.im, -e->range, e->range);
    state->measured_before = m;
    state->measured = state->rebalance;
}

static void filter_output(imki_fork_state *state)
{
    const imki_fork_electronics *e = &state->electronics;
    const double in = state->measured.im, a = state->filter[0], b = state->filter[1];
    if (e->filter_order == 0) {
        state->filter[0] = in;
    } else if (e->filter_order == 1) {
        state->filter[0] = e->filter_phi[0] * a + e->filter_gamma[0] * in;
    } else {
        state->filter[0] = e->filter_phi[0] * a + e->filter_phi[1] * b + e->filter_gamma[0] * in;
        state->filter[1] = e->filter_phi[2] * a + e->filter_phi[3] * b + e->filter_gamma[1] * in;
    }
}

static void run_frame(imki_fork_state *state, double due)
{
    double input[IMKI_FORK_COLUMNS], out[IMKI_FORK_ROWS];
    memcpy(input, state->motion, sizeof(double[IMKI_FORK_STATES]));
    frame_forces(state, input + IMKI_FORK_STATES);
    for (int i = IMKI_FORK_INPUTS; state->noise && i < IMKI_FORK_COLUMNS; i++)
        input[i] = imki_draw(&state->draws);
    imki_fork_apply(state->frame.column[0], state->noise ? IMKI_FORK_COLUMNS : IMKI_FORK_INPUTS,
                    input, out);
    memcpy(state->motion, out, sizeof(double[IMKI_FORK_STATES]));
    const imki_phasor back = {state->reference_turn.re, -state->reference_turn.im};
    state->drive_motion = imki_phasor_product(back, (imki_phasor){out[4], out[5]});
    state->sense_motion = imki_phasor_product(back, (imki_phasor){out[6], out[7]});
    control_sense(state);
    control_drive(state, due);
    filter_output(state);
}

static void full_step(imki_fork_state *state, double due, double sums[2])
{
    size_t left = state->steps;
    while (left > 0) {
        const size_t rest = (size_t)(state->frame.steps - state->position);
        const size_t done = left < rest ? left : rest;
        state->position += (int)done;
        left -= done;
        if (state->position == state->frame.steps) {
            state->position = 0;
            run_frame(state, due);
        }
        sums[0] += (double)done * state->filter[0];
        sums[1] += (double)done * state->measured.re;
    }
    sums[0] /= (double)state->steps;
    sums[1] /= (double)state->steps;
}

/* ---- slow level ------------------------------------------------------------------------------ */

static void slow_step(imki_fork_state *state, const imk_exposure *exposure, double due,
                      double sums[2])
{
    enum { ROWS = IMKI_FORK_ROWS, INPUTS = IMKI_FORK_ENVELOPE_INPUTS };
    const imki_fork_point *point = &state->point;
    const double gain = due / point->amplitude, k = state->design.angular_gain;
    const double rate = exposure->angular_rate[0] + state->design.damping_coupling +
                        state->force_angle * point->drive_damping / (2.0 * k);
    const double quadrature =
        (state->design.quadrature * 2.0 * IMKI_PI * state->design.drive.frequency +
         0.5 * exposure->angular_acceleration[0]) /
        point->drive;
    const double c = state->phase_turn.re, s = state->phase_turn.im;
    double input[2 * ROWS + INPUTS], out[ROWS];
    memcpy(input, state->motion, sizeof state->motion);
    input[6] = input[7] = 0.0; /* the integrals of the sample before */
    input[ROWS] = gain * (c * quadrature - s * rate);
    input[ROWS + 1] = gain * (c * rate + s * quadrature);
    for (int i = ROWS + INPUTS; state->noise && i < 2 * ROWS + INPUTS; i++)
        input[i] = imki_draw(&state->draws);
    imki_fork_apply(state->envelope.column[0], state->noise ? 2 * ROWS + INPUTS : ROWS + INPUTS,
                    input, out);
    memcpy(state->motion, out, sizeof state->motion);
    sums[0] = out[6] / state->sample;
    sums[1] = out[7] / state->sample;
    state->measured = (imki_phasor){sums[1], sums[0]};
}

/* ---- interface ------------------------------------------------------------------------------- */

/* What follows from the exposure. The matrices are made anew only when it has changed. */
static void expose(imki_fork_state *state, const imk_exposure *exposure)
{
    const double force = exposure->specific_force[state->leak_axis];
    const imki_fork_condition condition = {
        exposure->angular_rate[0], exposure->angular_acceleration[0], exposure->temperature};
    const bool warmer = !state->ready || condition.temperature != state->condition.temperature;
    const bool moved = warmer || condition.rate != state->condition.rate ||
                       condition.acceleration != state->condition.acceleration;
    if (warmer)
        state->point = imki_fork_at(&state->design, condition.temperature);
    if (state->full && moved)
        imki_fork_frame_design(&state->design, &condition, state->step, state->frame.steps,
                               state->noise, &state->frame);
    else if (!state->full && warmer)
        imki_fork_envelope_design(&state->design, condition.temperature, state->sample,
                                  state->noise, &state->envelope);
    state->condition = condition;
    state->ready = true;
    state->constant = -state->design.tines.asymmetry * force;
    state->force_angle = imki_fork_force_angle(&state->design, force);
    state->phase_error = state->point.phase + imki_wander_next(&state->phase);
    state->phase_turn = (imki_phasor){imk_cos(state->phase_error), imk_sin(state->phase_error)};
}

/* Saturation, then the nearest step of the output. */
static double output_stage(const imk_tuning_fork *design, double value)
{
    const double range = design->output.range, step = design->output.resolution;
    const double limited = range > 0.0 ? clamp(value, -range, range) : value;
    return step > 0.0 ? step * rint(limited / step) : limited;
}

void imki_fork_step(void *place, const imk_exposure *exposure, double *outputs)
{
    imki_fork_state *state = place;
    double sums[2] = {0.0, 0.0};
    expose(state, exposure);
    const double due = state->point.amplitude * (1.0 + imki_wander_next(&state->amplitude));
    if (state->full)
        full_step(state, due, sums);
    else
        slow_step(state, exposure, due, sums);
    outputs[0] = output_stage(&state->design, sums[0]);
    outputs[1] = sums[1];
}

static void observe_full(const imki_fork_state *state, double *signals)
{
    double force[5], inside[4];
    const imki_phasor x = state->drive_motion;
    const double size = sqrt(x.re * x.re + x.im * x.im);
    frame_forces(state, force);
    imki_fork_frame_inside(&state->frame, state->motion, force, state->position, inside);
    signals[0] = inside[0];
    signals[1] = inside[2];
    signals[2] = size;
    signals[3] = (state->frame.angle / state->step + state->detuning) / (2.0 * IMKI_PI);
    signals[4] = state->design.mass * state->drive_force;
    signals[5] = size > 0.0 ? imk_atan2(x.im, x.re) : 0.0;
}

static void observe_slow(const imki_fork_state *state, double *signals)
{
    const imki_phasor to_rate = state->electronics.to_rate;
    const imki_phasor turn = {state->phase_turn.re, -state->phase_turn.im};
    const imki_phasor q = {state->motion[0], state->motion[1]};
    const imki_phasor y =
        imki_phasor_product(imki_phasor_product(q, turn), imki_phasor_inverse(to_rate));
    const double amplitude = state->point.amplitude * (1.0 + state->amplitude.constant);
    signals[0] = amplitude;
    signals[1] = y.re;
    signals[2] = amplitude;
    signals[3] = state->point.drive / (2.0 * IMKI_PI);
    signals[4] = state->design.mass * state->point.drive * state->point.drive_damping * amplitude;
    signals[5] = 0.0;
}

void imki_fork_observe(const void *place, double *signals)
{
    const imki_fork_state *state = place;
    if (!state->ready)
        memset(signals, 0, 6 * sizeof *signals);
    else if (state->full)
        observe_full(state, signals);
    else
        observe_slow(state, signals);
    signals[6] = state->measured.im;
    signals[7] = state->measured.re;
    signals[8] = state->phase_error;
}

/* Steps per sample and per frame. A sample of four cycles or more is divided into whole frames, so
 * that the exposure changes between frames; a shorter one runs through them. */
static imk_status divide(const imk_tuning_fork *design, const imk_physics_settings *settings,
                         size_t *count, double *step, int *steps, imk_error *error)
{
    const double cycle = 1.0 / design->drive.frequency;
    const double longest = cycle / IMKI_FORK_STEPS_MIN, shortest = cycle / IMKI_FORK_STEPS_MAX;
    const imk_status status =
        imki_divide_sample(settings, longest, longest * (1.0 + 1e-9),
                           "at least 16 steps to a cycle of the drive", count, step, error);
    if (status != IMK_OK)
        return status;
    if (*step < shortest * (1.0 - 1e-9))
        return settings->step > 0.0 && settings->step < shortest
                   ? imki_refuse(error, IMK_ERROR_RANGE, "step", settings->step, shortest,
                                 "at most 128 steps to a cycle of the drive")
                   : imki_refuse(error, IMK_ERROR_RANGE, "rate", settings->rate, 1.0 / shortest,
                                 "at most 128 samples to a cycle");
    const double frames = rint(*step * (double)*count / cycle);
    if (frames >= 4.0) {
        const double wanted = settings->step > 0.0 ? settings->step : longest;
        *steps = (int)ceil(1.0 / (settings->rate * frames * wanted) * (1.0 - 1e-9));
        *count = (size_t)frames * (size_t)*steps;
        *step = 1.0 / (settings->rate * (double)*count);
    } else {
        *steps = (int)rint(cycle / *step);
    }
    return IMK_OK;
}

static void start(imki_fork_state *state, const imk_physics_settings *settings)
{
    const imk_tuning_fork *design = &state->design;
    imki_draws_start(&state->draws, settings,
                     state->full ? IMKI_FORK_SOURCE_FRAME : IMKI_FORK_SOURCE_ENVELOPE);
    imki_wander_start(&state->phase, settings, IMKI_FORK_SOURCE_PHASE, design->phase.repeatability,
                      design->phase.instability);
    imki_wander_start(&state->amplitude, settings, IMKI_FORK_SOURCE_AMPLITUDE,
                      design->drive.amplitude_repeatability, 0.0);
}

imk_status imki_fork_init(const void *place, const imk_physics_settings *settings, void *memory,
                          imk_error *error)
{
    const imk_tuning_fork *design = place;
    imki_fork_state *state = memory;
    size_t count = 0;
    double step = 0.0;
    int steps = 0;
    imk_status status = IMK_OK;
    if (settings->level == IMK_LEVEL_FULL)
        status = divide(design, settings, &count, &step, &steps, error);
    if (status != IMK_OK)
        return status;
    state->design = *design;
    state->full = settings->level == IMK_LEVEL_FULL;
    state->noise = settings->noise;
    state->leak_axis = design->arrangement == IMK_TUNING_FORK_IN_PLANE ? 1 : 2;
    state->steps = count;
    state->step = step;
    state->sample = 1.0 / settings->rate;
    state->frame.steps = steps;
    state->reference_turn.re = 1.0;
    imki_fork_electronics_design(design, state->full ? step * (double)steps : state->sample,
                                 &state->electronics);
    start(state, settings);
    return IMK_OK;
}

double imki_fork_step_length(const void *place, const imk_physics_settings *settings)
{
    size_t count;
    double step;
    int steps;
    imk_physics_settings own = *settings;
    own.step = 0.0;
    if (settings->level != IMK_LEVEL_FULL ||
        divide(place, &own, &count, &step, &steps, NULL) != IMK_OK)
        return 1.0 / settings->rate;
    return step;
}
