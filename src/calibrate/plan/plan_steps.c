/* SPDX-License-Identifier: Apache-2.0 */
/* A programme as the estimator sees it: an observation for each step, by the noise of the model,
 * and a turn between the poses of a multi-position test. Of a turn the estimator integrates the
 * readings of the gyros, so these are made up: the rotation from one pose to the next about one
 * axis, at a steady rate. */
#include "plan_internal.h"

#include "imukit/attitude.h"
#include "imukit/elementary.h"

#include <math.h>

static imk_vector3 rotation_between(const double from[3], const double to[3])
{
    const imk_quaternion a =
        imk_quaternion_from_matrix(imk_matrix3_from_euler(from[0], from[1], from[2]));
    const imk_quaternion b =
        imk_quaternion_from_matrix(imk_matrix3_from_euler(to[0], to[1], to[2]));
    return imk_quaternion_to_rotation_vector(
        imk_quaternion_multiply(imk_quaternion_conjugate(a), b));
}

/* The angle goes by S(x) of motion_script.h: its peak rate is 15/8 of the mean. */
double imki_plan_turn_time(const imk_plan_settings *settings, const imk_model *model,
                           const double from[3], const double to[3])
{
    double time = settings->turn_time;
    const imk_vector3 rotation = rotation_between(from, to);
    for (int i = 0; i < 3 && model->gyro.present; i++)
        if (model->gyro.range.value[i] > 0.0)
            time = fmax(time, 1.875 * fabs(rotation.v[i]) / (0.8 * model->gyro.range.value[i]));
    return time;
}

bool imki_plan_is_whole_turn(const imk_plan_settings *settings, const imk_plan_step *step)
{
    return step->action == IMK_PLAN_RATE && (settings->procedure == IMK_PROCEDURE_FERRARIS ||
                                             settings->procedure == IMK_PROCEDURE_TURNS);
}

double imki_plan_measured(const imk_plan_settings *settings, const imk_plan_step *step, double hold)
{
    return imki_plan_is_whole_turn(settings, step) ? fabs(settings->turn_angle / step->rate) : hold;
}

double imki_plan_fixture(const imk_plan_settings *settings)
{
    const double placement =
        settings->procedure == IMK_PROCEDURE_TURNS ? settings->placement_sigma : 0.0;
    return sqrt(settings->fixture_sigma * settings->fixture_sigma + placement * placement);
}

bool imki_plan_has_fixture(const imk_plan_settings *settings)
{
    return imki_plan_fixture(settings) > 0.0 &&
           settings->procedure != IMK_PROCEDURE_MULTIPOSITION &&
           settings->procedure != IMK_PROCEDURE_THERMAL;
}

void imki_plan_clear(imki_plan *plan)
{
    plan->calibration->observation_count = 0;
    plan->calibration->turn_count = 0;
    plan->record.count = 0;
}

static imk_observation observation_of(const imki_plan *plan, const imk_plan_step *step, double hold)
{
    const imk_plan_settings *s = plan->settings;
    const imk_model *model = &plan->calibration->model;
    const double time = imki_plan_measured(s, step, hold);
    const bool placed = s->placement_sigma > 0.0 && s->procedure != IMK_PROCEDURE_TURNS;
    imk_observation o = {.record = 0,
                         .temperature = step->temperature,
                         .placement_sigma = s->placement_sigma,
                         .fixture = imki_plan_has_fixture(s) ? 0 : -1};
    o.knowledge = s->procedure == IMK_PROCEDURE_MULTIPOSITION
                      ? IMK_INPUT_GRAVITY
                      : (placed ? IMK_INPUT_PLACED : IMK_INPUT_KNOWN);
    if (step->action == IMK_PLAN_RATE)
        o.rate[step->axis] = step->rate;
    for (int i = 0; i < 3; i++)
        o.force[i] = step->force[i];
    for (int sensor = 0; sensor < 2; sensor++) {
        const imk_triad *triad = imk_model_triad(model, sensor);
        for (int i = 0; i < IMK_AXES_MAX; i++) {
            const bool there = triad->present && i < triad->axis_count;
            o.reading[sensor][i] = there ? 0.0 : (double)NAN;
            o.sigma[sensor][i] =
                there ? sqrt(imki_plan_mean_variance(triad, i, 1.0 / s->rate, time)) : 1.0;
        }
    }
    /* The angle of a turn ends as well as the unit is put down. */
    if (imki_plan_is_whole_turn(s, step)) {
        double *sigma = &o.sigma[IMK_GYRO][step->axis];
        *sigma = sqrt(*sigma * *sigma + s->placement_sigma * s->placement_sigma / (time * time));
    }
    return o;
}

/* Readings of the turn, without errors, and how well its angle is known: white noise gathers as a
 * random walk, what is slower as a rate; the Earth's horizontal rate has an unknown heading. */
static void append_turn(imki_plan *plan, const imk_plan_step *from, const imk_plan_step *step)
{
    imk_calibration *c = plan->calibration;
    const imk_vector3 rotation = rotation_between(from->angle, step->angle);
    /* What is integrated begins where one hold ends and ends where the next begins: the margins
     * belong to it. */
    const double time = imki_plan_turn_time(plan->settings, &c->model, from->angle, step->angle) +
                        plan->settings->margin;
    const double part = 1.0 / IMKI_PLAN_TURN_SAMPLES;
    double up[3], variance = 0.0;
    imki_plan_up(from->angle, up);
    const size_t begin = plan->record.count;
    for (int k = 0; k < IMKI_PLAN_TURN_SAMPLES; k++) {
        const imk_quaternion turned =
            imk_quaternion_from_rotation_vector(imk_vector3_scale(rotation, -part * (k + 0.5)));
        const imk_vector3 force =
            imk_quaternion_rotate(turned, (imk_vector3){{up[0], up[1], up[2]}});
        for (int i = 0; i < 3; i++) {
            plan->reading[i][begin + (size_t)k] = rotation.v[i] * part / plan->record.dt;
            plan->reading[3 + i][begin + (size_t)k] = c->gravity * force.v[i];
        }
    }
    plan->record.count += IMKI_PLAN_TURN_SAMPLES;
    for (int i = 0; i < 3; i++)
        variance +=
            imki_plan_mean_variance(&c->model.gyro, i, 1.0 / plan->settings->rate, time) / 3.0;
    const double cosine = imk_cos(isnan(c->latitude) ? 0.0 : c->latitude);
    const double square = isnan(c->latitude) ? 2.0 / 3.0 : cosine * cosine;
    const double earth = 0.5 * square * c->earth_rate * c->earth_rate;
    c->turn[c->turn_count++] =
        (imk_turn){.from = (int)c->observation_count - 2,
                   .to = (int)c->observation_count - 1,
                   .begin = begin,
                   .end = plan->record.count,
                   .sigma = time * sqrt(variance + earth),
                   .earth_sigma = time * fmin(sqrt(earth), 0.999999 * sqrt(variance + earth))};
}

void imki_plan_append(imki_plan *plan, const imk_plan_step *from, const imk_plan_step *step,
                      double hold)
{
    imk_calibration *c = plan->calibration;
    c->observation[c->observation_count++] = observation_of(plan, step, hold);
    if (from && plan->settings->procedure == IMK_PROCEDURE_MULTIPOSITION && c->model.gyro.present &&
        c->model.gyro.axis_count == 3 && c->model.accel.axis_count == 3)
        append_turn(plan, from, step);
}

imk_status imki_plan_information(imki_plan *plan, double *information, imk_error *error)
{
    /* A record without samples is no record. */
    if (plan->record.count == 0)
        plan->record.count = 1;
    return imk_calibration_information(plan->calibration, information, plan->solver,
                                       plan->solver_size, error);
}
