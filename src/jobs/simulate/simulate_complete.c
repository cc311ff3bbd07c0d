/* SPDX-License-Identifier: Apache-2.0 */
/* What a simulation is told by its model and its motion: where it begins and ends, the field of the
 * Earth, and what is left out of it. */
#include "simulate_log_internal.h"

#include "base/refuse_internal.h"
#include "jobs/job_internal.h"

#include <math.h>

static bool has_temperature_terms(const imk_triad *triad)
{
    if (!triad->present)
        return false;
    bool any = triad->bias.temperature.order > 0 || triad->scale_factor.temperature.order > 0;
    for (int i = 0; i < triad->axis_count; i++)
        any = any || triad->bias.temperature_rate.value[i] != 0 ||
              triad->bias.hysteresis.value[i] != 0;
    return any;
}

static void find_temperature(const imk_model *model, const imk_simulation *s,
                             imk_findings *findings)
{
    if (!s->temperature &&
        (has_temperature_terms(&model->gyro) || has_temperature_terms(&model->accel) ||
         has_temperature_terms(&model->mag)))
        imki_find(findings, IMK_FINDING_WARNING, "simulate:temperature_unknown", NULL, 0, NULL);
    for (size_t i = 0; s->temperature && i < s->temperature->point_count; i++)
        if (imki_find_temperature(findings, s->temperature->temperature[i]))
            break;
}

/* A magnetometer needs a field, and a motion with an attitude. */
static void choose_field(const imk_model *model, imk_simulation *s, imk_findings *findings)
{
    const imk_trajectory *trajectory = s->motion.trajectory;
    double latitude = s->latitude, first, last;
    if (!model->mag.present || s->field[0] != 0 || s->field[1] != 0 || s->field[2] != 0)
        return;
    if (s->motion.recorded) {
        imki_find(findings, IMK_FINDING_WARNING, "simulate:no_attitude", NULL, 0, NULL);
        return;
    }
    if (trajectory) {
        imk_motion_state state;
        imk_trajectory_span(trajectory, &first, &last);
        imk_trajectory_state(trajectory, first, &state);
        latitude = state.place.latitude;
    }
    imk_dipole_field(latitude, s->field);
}

/* Vibration that the parts of a sample cannot follow is neither averaged nor rectified rightly. */
static void find_vibration(const imk_simulation *s, imk_findings *findings)
{
    if (!s->motion.trajectory || s->substeps > 0)
        return;
    const double parts = (double)imk_trajectory_substeps(s->motion.trajectory, 1 / s->rate);
    if (parts > IMK_SUBSTEPS_MAX)
        imki_find(findings, IMK_FINDING_WARNING, "simulate:vibration", NULL,
                  IMKI_NUMBERS(parts, IMK_SUBSTEPS_MAX, ceil(s->rate * parts / IMK_SUBSTEPS_MAX)));
}

/* A motion without a duration is simulated to its end, the last row included. */
static imk_status choose_rows(double duration, double length, imk_simulate_log_settings *settings,
                              imk_error *error)
{
    const imk_recorded_motion *recorded = settings->simulation.motion.recorded;
    const double rate = settings->simulation.rate;
    if (isnan(duration)) {
        if (!recorded && length < HUGE_VAL && !(length * rate < 1e15))
            return imki_refuse(error, IMK_ERROR_RANGE, "duration", length, 1e15 / rate,
                               "at most 1e15 rows: state a duration, or a lower rate");
        settings->rows = recorded            ? recorded->count
                         : length < HUGE_VAL ? (uint64_t)floor(length * rate + 1e-6) + 1
                                             : 0;
        return IMK_OK;
    }
    if (!(rate * duration >= 0.5 && rate * duration < 1e15))
        return imki_refuse(error, IMK_ERROR_RANGE, "duration", duration,
                           rate * duration < 1 ? 0.5 / rate : 1e15 / rate, "1 to 1e15 rows");
    if (duration > length + 1.5 / rate)
        return imki_refuse(error, IMK_ERROR_RANGE, "duration", duration, length,
                           "at most the length of the motion, unless a script ends with `then: "
                           "hold`");
    settings->rows = (uint64_t)llround(duration * rate);
    return IMK_OK;
}

imk_status imk_simulate_log_complete(const imk_model *model, double duration, double length,
                                     imk_simulate_log_settings *settings, imk_findings *findings,
                                     imk_error *error)
{
    imk_simulation *s = &settings->simulation;
    double last;
    if (!(s->rate >= 1e-9 && s->rate <= 1e12))
        return imki_refuse(error, IMK_ERROR_RANGE, "rate", s->rate, s->rate > 1 ? 1e12 : 1e-9,
                           "a rate of 1e-9 Hz to 1e12 Hz");
    const imk_status status = choose_rows(duration, length, settings, error);
    if (status != IMK_OK)
        return status;
    find_temperature(model, s, findings);
    choose_field(model, s, findings);
    find_vibration(s, findings);
    if (s->motion.trajectory)
        imk_trajectory_span(s->motion.trajectory, &settings->start, &last);
    return IMK_OK;
}
