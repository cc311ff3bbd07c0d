/* SPDX-License-Identifier: Apache-2.0 */
/* The filter in the loop: it runs along the true motion with perfect readings, so that its state is
 * the truth, and what it knows of its errors is its covariance alone. At each update its gain and
 * its H are kept for the sources. Estimates are constant between the times at which the filter
 * propagates its covariance, and decay there, as in the filter: each step of the sources ends
 * there at the latest. */
#include "drift_aided_internal.h"

#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

/* The filter's errors (position, velocity, attitude) and those of x (psi, dv, dr). */
static const size_t place_of[9] = {6, 7, 8, 3, 4, 5, 0, 1, 2};

/* Readings are means over at most so long on a motion: its force and its turn are smooth over this
 * [s]. */
static const double longest_sample = 0.02;
enum { SAMPLES = 64 };

/* ---- the filter's description ------------------------------------------------------------------
 */

static const imk_model *filter_model(const imk_model *model, const imk_drift_settings *settings)
{
    return settings->filter_model ? settings->filter_model : model;
}

static void describe_aids(const imk_drift_settings *settings,
                          imk_navigation_filter_settings *filter)
{
    imk_navigation_filter_default(filter);
    filter->aid_count = settings->aid_count;
    for (size_t k = 0; k < settings->aid_count; k++) {
        imk_aid *aid = &filter->aid[k];
        *aid = settings->filter_aid ? settings->filter_aid[k] : settings->aid[k];
        if (aid->kind != IMK_AID_ZERO_VELOCITY)
            continue;
        /* What a standing unit's velocity is beside zero is its error: a reading of the velocity.
         */
        aid->kind = IMK_AID_VELOCITY;
        for (int i = 0; i < 3; i++)
            aid->lever_arm[i] = aid->lever_arm_sigma[i] = 0.0;
    }
}

static imk_alignment_settings alignment_of(const imk_model *model,
                                           const imk_drift_settings *settings)
{
    imk_alignment_settings alignment = imk_alignment_default();
    alignment.method = IMK_ALIGNMENT_MEANS;
    alignment.duration = settings->alignment_time;
    alignment.model = model;
    return alignment;
}

size_t imki_drift_filter_scratch(void)
{
    const imk_alignment_settings alignment = imk_alignment_default();
    return imk_alignment_size(&alignment);
}

/* A self-alignment with perfect readings: its result is the true attitude, with the covariance that
 * the model says. */
static imk_status align(const imk_model *model, const imk_drift_settings *settings,
                        const imk_motion_state *state, imk_navigation_filter_settings *filter,
                        void *scratch, imk_error *error)
{
    enum { PARTS = 256 };
    imk_alignment *alignment;
    imk_alignment_result result;
    imk_alignment_settings of = alignment_of(model, settings);
    of.place = state->place;
    imk_status status =
        imk_alignment_start(&of, &alignment, scratch, imki_drift_filter_scratch(), error);
    const double dt = settings->alignment_time / PARTS;
    for (int i = 0; i < PARTS && status == IMK_OK; i++)
        imk_alignment_add(alignment, dt, imk_vector3_scale(state->angular_rate, dt),
                          imk_vector3_scale(state->specific_force, dt), NULL);
    if (status == IMK_OK)
        status = imk_alignment_finish(alignment, &result, error);
    if (status == IMK_OK)
        status = imk_navigation_filter_aligned(&result, IMK_ALIGNMENT_MEANS, true,
                                               settings->alignment_time, filter);
    return status;
}

imk_status imki_drift_filter_settings(const imk_model *model, const imk_drift_settings *settings,
                                      const imki_drift_motion_of *motion,
                                      imk_navigation_filter_settings *filter, void *scratch,
                                      imk_error *error)
{
    imk_motion_state state;
    imk_trajectory_state(&motion->trajectory, motion->start, &state);
    describe_aids(settings, filter);
    filter->hold_height = imk_drift_vertical(settings) == IMK_VERTICAL_SLAVED;
    memcpy(filter->initial_sigma, settings->initial_sigma, sizeof filter->initial_sigma);
    model = filter_model(model, settings);
    imk_status status = imk_navigation_filter_describe(
        model, 1.0 / settings->rate, state.angular_rate, state.specific_force, filter, error);
    if (status == IMK_OK && settings->alignment == IMK_ALIGNED_SELF) {
        for (int i = 6; i < 9; i++)
            filter->initial_sigma[i] = 0.0;
        status = align(model, settings, &state, filter, scratch, error);
    }
    return status;
}

size_t imki_drift_filter_states(const imk_model *model, const imk_drift_settings *settings,
                                size_t *filter_size)
{
    const imk_vector3 none = {{0.0, 0.0, 0.0}};
    imk_navigation_filter_settings filter;
    *filter_size = 0;
    if (settings->aid_count == 0)
        return IMK_NAVIGATION_ERRORS;
    describe_aids(settings, &filter);
    (void)imk_navigation_filter_describe(filter_model(model, settings), 1.0 / settings->rate, none,
                                         none, &filter, NULL);
    *filter_size = imk_navigation_filter_size(&filter);
    return IMK_NAVIGATION_ERRORS + 3 * (filter.gyro.part_count + filter.accel.part_count) +
           6 * settings->aid_count;
}

/* ---- times -------------------------------------------------------------------------------------
 */

static double time_of_row(uint64_t row, double rate)
{
    return (double)row / rate;
}

uint64_t imki_aid_row(const imk_aid *aid, uint64_t k, double rate)
{
    const double late = 1e-6; /* of a row: what rounding of the product is given */
    const double time = aid->from + (double)k * aid->interval;
    const double row = floor(time * rate + late);
    return time <= aid->until * (1.0 + 1e-12) && row < 1e18 ? (uint64_t)row : UINT64_MAX;
}

imk_status imki_loop_start(imki_drift_loop *loop, const imk_model *model,
                           const imk_drift_settings *settings, imki_drift_walk *walk,
                           imki_drift_plan *plan, const imki_loop_memory *memory, imk_error *error)
{
    imk_navigation_filter_settings filter;
    imk_motion_state state;
    *loop = (imki_drift_loop){.settings = settings,
                              .trajectory = &walk->motion.trajectory,
                              .start = walk->motion.start,
                              .kernel = imk_random_seeded(0).kernel,
                              .longest = walk->rests ? 1.0 : longest_sample};
    for (int b = 0; b < 6; b++) {
        const imki_drift_column one =
            imki_drift_column_of(IMKI_COLUMN_ONE, b < 3 ? IMK_GYRO : IMK_ACCEL, b % 3, 0);
        loop->bias_column[b] = imki_drift_column_number(plan, &one);
    }
    imk_status status =
        imki_drift_filter_settings(model, settings, &walk->motion, &filter, memory->scratch, error);
    if (status != IMK_OK)
        return status;
    loop->step = filter.step;
    filter.step = 10.0; /* it propagates where it is told to: at the ends of the steps */
    imk_trajectory_state(loop->trajectory, loop->start, &state);
    const imk_navigation_state start = {
        .position = state.position, .velocity = state.velocity, .attitude = state.attitude};
    status = imk_navigation_filter_start(&filter, &start, &loop->filter, memory->filter,
                                         memory->filter_size, error);
    loop->states = status == IMK_OK ? loop->filter->states : 0;
    return status;
}

double imki_loop_limit(const imki_drift_loop *loop, double time, double goal)
{
    const double rate = loop->settings->rate, step = loop->step;
    double limit = time + step < goal - 1e-6 * step ? time + step : goal;
    for (size_t k = 0; k < loop->settings->aid_count; k++) {
        const uint64_t row = imki_aid_row(&loop->settings->aid[k], loop->next[k], rate);
        if (row != UINT64_MAX && time_of_row(row, rate) < limit)
            limit = time_of_row(row, rate);
    }
    return limit > time ? limit : goal;
}

/* ---- running the filter ------------------------------------------------------------------------
 */

/* A vertical that is held follows the truth. */
static void hold(imki_drift_loop *loop, double time)
{
    imk_motion_state state;
    imk_trajectory_state(loop->trajectory, time, &state);
    loop->filter->strapdown.height = state.place.height;
    loop->filter->strapdown.climb = -state.velocity_ned.v[2];
}

/* `samples` of dt from `begin`. */
static void take(imki_drift_loop *loop, double begin, double dt, size_t samples)
{
    double rate[3][SAMPLES], force[3][SAMPLES], boundary[SAMPLES + 1];
    double *const rates[3] = {rate[0], rate[1], rate[2]};
    double *const forces[3] = {force[0], force[1], force[2]};
    for (size_t done = 0; done < samples;) {
        const size_t now = samples - done < SAMPLES ? samples - done : SAMPLES;
        for (size_t i = 0; i <= now; i++)
            boundary[i] = loop->start + begin + dt * (double)(done + i);
        imk_trajectory_means(loop->trajectory, loop->kernel, now, boundary, rates, NULL, forces);
        for (size_t i = 0; i < now; i++) {
            const imk_vector3 turn = {{rate[0][i] * dt, rate[1][i] * dt, rate[2][i] * dt}};
            const imk_vector3 gain = {{force[0][i] * dt, force[1][i] * dt, force[2][i] * dt}};
            if (loop->filter->settings.hold_height)
                hold(loop, boundary[i + 1]);
            imk_navigation_filter_step(loop->filter, dt, turn, gain);
        }
        done += now;
    }
}

/* The last sample is as long as those of the unit: the filter counts the noise of its rate to what
 * an aid with a lever arm measures. */
static void run(imki_drift_loop *loop, double end)
{
    const double begin = loop->time, last = 1.0 / loop->settings->rate, rest = end - begin - last;
    const bool divided = rest > 1e-6 * last;
    if (divided) {
        const double count = ceil(rest / loop->longest * (1.0 - 1e-9));
        const size_t samples = count > 1.0 ? (size_t)count : 1;
        take(loop, begin, rest / (double)samples, samples);
    }
    take(loop, divided ? end - last : begin, divided ? last : end - begin, 1);
    loop->time = end;
}

/* The filter's last gain in the order of x. */
static void keep(const imki_drift_loop *loop, size_t aid, imki_drift_update *update)
{
    const imki_filter_gain gain = imki_navigation_filter_gain(loop->filter);
    const imk_innovation innovation = imk_navigation_filter_innovation(loop->filter);
    update->aid = aid;
    update->rows = gain.rows;
    for (size_t r = 0; r < gain.rows; r++) {
        update->axis[r] = innovation.axis[r];
        for (size_t i = 0; i < gain.states; i++) {
            const size_t to = i < 9 ? place_of[i] : i;
            update->h[r * gain.states + to] = gain.h[r * gain.states + i];
            update->gain[to * gain.rows + r] = gain.gain[i * gain.rows + r];
        }
    }
}

bool imki_drift_stands(const imk_motion_state *state)
{
    const double rest_rate = 1e-3 * IMK_EARTH_RATE, rest_velocity = 1e-3 / 60.0;
    const imk_vector3 earth = {{0.0, 0.0, IMK_EARTH_RATE}};
    const imk_vector3 turning =
        imk_vector3_subtract(imk_quaternion_rotate(state->attitude, state->angular_rate), earth);
    return imk_vector3_norm(turning) <= rest_rate &&
           imk_vector3_norm(state->velocity) <= rest_velocity;
}

/* A reading without an error. */
static void read_aid(imki_drift_loop *loop, size_t aid, imki_aided_step *step)
{
    static const double none[3] = {0.0, 0.0, 0.0};
    const imk_aid *of = &loop->settings->aid[aid];
    imk_motion_state state;
    imk_aid_reading reading = {.time = imk_navigation_filter_state(loop->filter).time};
    imk_trajectory_state(loop->trajectory, loop->start + loop->time, &state);
    if (of->kind == IMK_AID_ZERO_VELOCITY && !imki_drift_stands(&state))
        return;
    imki_aid_reading(of, &state, of->lever_arm, none, reading.value);
    if (imk_navigation_filter_aid(loop->filter, aid, &reading) == IMK_AID_USED)
        keep(loop, aid, &step->update[step->update_count++]);
}

/* What the filter leaves of its estimates over a time. */
static void fill_decay(const imk_navigation_filter *f, double length, double *decay)
{
    const imk_triad_errors *triad[2] = {&f->settings.gyro, &f->settings.accel};
    for (int sensor = 0; sensor < 2; sensor++)
        for (size_t p = 0; p < f->parts[sensor]; p++)
            for (int axis = 0; axis < 3; axis++)
                *decay++ = imki_bias_part_decay(&triad[sensor]->part[p], length);
    for (size_t i = 0; i < f->aid_states; i++) {
        const double time = f->aid_state[i].correlation_time;
        *decay++ = time > 0.0 ? 1.0 + imk_expm1(-length / time) : 1.0;
    }
}

void imki_loop_take(imki_drift_loop *loop, imki_drift_step *step, double end, bool last)
{
    imki_aided_step *aided = step->aided;
    const double rate = loop->settings->rate;
    aided->update_count = 0;
    aided->decays = last;
    if (!last)
        return;
    const double length = end - loop->time;
    run(loop, end);
    imki_navigation_filter_propagate(loop->filter);
    fill_decay(loop->filter, length, aided->decay);
    for (size_t k = 0; k < loop->settings->aid_count; k++) {
        uint64_t row = imki_aid_row(&loop->settings->aid[k], loop->next[k], rate);
        if (row == UINT64_MAX || time_of_row(row, rate) > end + 1e-6 / rate)
            continue;
        read_aid(loop, k, aided);
        do
            row = imki_aid_row(&loop->settings->aid[k], ++loop->next[k], rate);
        while (row != UINT64_MAX && time_of_row(row, rate) <= end + 1e-6 / rate);
    }
}

/* ---- what the sources need ---------------------------------------------------------------------
 */

/* What a constant of 1 on a column does over the step. */
static void fill_gamma(const imki_drift_loop *loop, imki_drift_step *step)
{
    double power = step->h;
    memset(step->aided->gamma, 0, sizeof step->aided->gamma);
    for (int k = 0; k < step->moments; k++) {
        for (int b = 0; b < 6; b++)
            for (int i = 0; i < 9; i++)
                step->aided->gamma[i][b] += power * step->column[loop->bias_column[b]][k][i];
        power *= step->h / (double)(k + 2);
    }
}

/* H x of the first nine. */
static double observed(const double *h, const double x[9])
{
    double sum = 0.0;
    for (int i = 0; i < 9; i++)
        sum += h[i] * x[i];
    return sum;
}

/* What a unit of a column's driver is in prediction minus reading, beside H x: the error of an aid;
 * what is carried and not in x; and, where a lever arm turns with the body, the error of the rate
 * that is read. */
static double enters(const imki_drift_loop *loop, const imki_drift_column *column,
                     const imki_drift_node *node, const imki_drift_update *update, const double *h,
                     int axis)
{
    double g[9], sum = 0.0;
    if (column->kind == IMKI_COLUMN_AID)
        return imki_aid_enters(column, loop->settings->aid, update->aid, axis, node);
    if (imki_drift_carried_at(column, node, g))
        return observed(h, g);
    if (column->sensor != IMK_GYRO || column->kind == IMKI_COLUMN_CLOCK ||
        !imki_drift_has_any(h + 9, 3))
        return 0.0;
    imki_drift_column_at(column, node, g);
    const imk_vector3 body =
        imk_matrix3_apply(imk_matrix3_transpose(node->c_eb), (imk_vector3){{g[0], g[1], g[2]}});
    for (int i = 0; i < 3; i++)
        sum += h[9 + i] * body.v[i];
    return sum;
}

/* A slaved vertical gives the velocity a part that is not in x. */
static void complete(const imki_drift_node *node, double *h)
{
    double all[9] = {0.0};
    for (int i = 0; i < 9; i++)
        for (int j = 0; j < 9; j++)
            all[j] += h[i] * node->full.m[i][j];
    memcpy(h, all, sizeof all);
}

void imki_loop_fill(const imki_drift_loop *loop, const imki_drift_plan *plan,
                    const imki_drift_walk *walk, imki_drift_step *step)
{
    const imki_drift_node *node = &step->node[walk->rests ? 0 : 4];
    imki_aided_step *aided = step->aided;
    fill_gamma(loop, step);
    for (size_t u = 0; u < aided->update_count; u++) {
        imki_drift_update *update = &aided->update[u];
        for (size_t r = 0; r < update->rows; r++) {
            double *h = update->h + r * aided->states;
            for (size_t c = 0; c < plan->column_count; c++)
                update->enter[c][r] =
                    enters(loop, &plan->column[c], node, update, h, update->axis[r]);
            complete(node, h);
        }
    }
}

void imki_loop_believed(const imki_drift_loop *loop, const imki_drift_node *node,
                        imk_drift_moments *moments)
{
    const double *p = imki_navigation_filter_covariance(loop->filter);
    double covariance[9 * 9];
    for (size_t i = 0; i < 9; i++)
        for (size_t j = 0; j < 9; j++)
            covariance[place_of[i] * 9 + place_of[j]] = p[i * loop->states + j];
    const imki_drift_plan plan = {.states = 9};
    const imki_drift_part part = {.covariance = covariance};
    imki_drift_moments_at(&plan, &part, node, moments);
}
