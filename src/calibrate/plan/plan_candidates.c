/* SPDX-License-Identifier: Apache-2.0 */
/* What each procedure offers: the steps that can be chosen, and the parameters it is about. */
#include "plan_internal.h"

#include "imukit/attitude.h"
#include "imukit/elementary.h"
#include "model/model_schema_internal.h"

#include <math.h>

static const double QUARTER_TURN = 1.5707963267948966;
static const double STANDARD_GRAVITY = 9.80665;

/* ---- poses --------------------------------------------------------------------------------------
 */

/* Specific force at rest: g (sin pitch, -cos pitch sin roll, -cos pitch cos roll). */
void imki_plan_attitude(const double up[3], double *roll, double *pitch)
{
    const double across = sqrt(up[1] * up[1] + up[2] * up[2]);
    *pitch = imk_atan2(up[0], across);
    *roll = across > 1e-9 ? imk_atan2(-up[1], -up[2]) : 0.0;
}

void imki_plan_up(const double angle[3], double up[3])
{
    const imk_matrix3 c = imk_matrix3_from_euler(angle[0], angle[1], angle[2]);
    for (int i = 0; i < 3; i++)
        up[i] = -c.m[2][i];
}

void imki_plan_direction(size_t index, double direction[3])
{
    /* 27 points of a cube of three by three, the middle left out; faces, then edges, corners. */
    size_t found = 0;
    for (int kind = 1; kind <= 3; kind++)
        for (int point = 0; point < 27; point++) {
            const int v[3] = {point / 9 - 1, point / 3 % 3 - 1, point % 3 - 1};
            const int nonzero = (v[0] != 0) + (v[1] != 0) + (v[2] != 0);
            if (nonzero != kind || found++ != index)
                continue;
            for (int i = 0; i < 3; i++)
                direction[i] = v[i] / sqrt(nonzero);
            return;
        }
}

static imk_plan_step pose_of(const double up[3], double yaw)
{
    imk_plan_step step = {.action = IMK_PLAN_HOLD, .temperature = (double)NAN};
    imki_plan_attitude(up, &step.angle[0], &step.angle[1]);
    step.angle[2] = yaw;
    return step;
}

static size_t offer_poses(size_t directions, size_t yaws, double gravity, imk_plan_step *step)
{
    size_t count = 0;
    for (size_t d = 0; d < directions; d++)
        for (size_t y = 0; y < yaws; y++) {
            double up[3];
            imki_plan_direction(d, up);
            step[count] = pose_of(up, QUARTER_TURN * (y < 3 ? (double)y : -1.0));
            for (int i = 0; i < 3; i++)
                step[count].force[i] = gravity * up[i];
            count++;
        }
    return count;
}

/* ---- rates, forces, temperatures ---------------------------------------------------------------
 */

static double limit_of(double stated, const imk_axes *range, double otherwise)
{
    double least = (double)INFINITY;
    for (int i = 0; i < 3; i++)
        if (range->value[i] > 0.0)
            least = fmin(least, range->value[i]);
    if (stated > 0.0)
        return stated;
    return isfinite(least) ? 0.9 * least : otherwise;
}

/* Each axis up, turning at these parts of the limit. */
static size_t offer_rates(const double *part, size_t parts, double limit, double gravity,
                          imk_plan_step *step)
{
    size_t count = 0;
    for (int axis = 0; axis < 3; axis++)
        for (size_t p = 0; p < parts; p++) {
            double up[3] = {0.0, 0.0, 0.0};
            up[axis] = 1.0;
            imk_plan_step s = pose_of(up, 0.0);
            for (int i = 0; i < 3; i++)
                s.force[i] = gravity * up[i];
            if (part[p] != 0.0) {
                s.action = IMK_PLAN_RATE;
                s.axis = axis;
                s.rate = part[p] * limit;
            }
            step[count++] = s;
        }
    return count;
}

/* Forces along axes, and between two of them where cross products are asked for. */
static size_t offer_forces(const imk_plan_settings *settings, double limit, imk_plan_step *step)
{
    static const double part[4] = {0.25, 0.5, 0.75, 1.0};
    const size_t directions = settings->cross_products ? 18 : 6;
    size_t count = 0;
    for (size_t d = 0; d < directions; d++)
        for (size_t p = 0; p < 4; p++) {
            double direction[3];
            imki_plan_direction(d, direction);
            step[count] = pose_of(direction, 0.0);
            step[count].action = IMK_PLAN_FORCE;
            for (int i = 0; i < 3; i++)
                step[count].force[i] = part[p] * limit * direction[i];
            count++;
        }
    return count;
}

/* Up and down again, so that hysteresis shows. */
static size_t offer_temperatures(const imk_plan_settings *settings, double gravity,
                                 imk_plan_step *step)
{
    const int levels = settings->temperature_order + 3;
    const double width =
        (settings->temperature_maximum - settings->temperature_minimum) / (levels - 1);
    size_t count = 0;
    for (int k = 0; k < 2 * levels; k++) {
        const double up[3] = {0.0, 0.0, -1.0};
        const int level = k < levels ? k : 2 * levels - 1 - k;
        step[count] = pose_of(up, 0.0);
        step[count].action = IMK_PLAN_SOAK;
        step[count].temperature = settings->temperature_minimum + width * level;
        step[count++].force[2] = -gravity;
    }
    return count;
}

/* Of a turn by hand: pi rad/s at most, and with the sign of its angle. */
static double by_hand(const imk_plan_settings *settings, double limit)
{
    const double most = 3.141592653589793;
    return (settings->turn_angle < 0.0 ? -1.0 : 1.0) * fmin(limit, most);
}

size_t imki_plan_candidates(const imk_plan_settings *settings, const imk_model *model,
                            double gravity, imk_plan_step step[IMKI_PLAN_CANDIDATES_MAX])
{
    static const double table[9] = {0.0, 0.25, 0.5, 0.75, 1.0, -1.0, -0.75, -0.5, -0.25};
    static const double linear[5] = {0.0, 0.5, 1.0, -1.0, -0.5};
    static const double full[2] = {1.0, -1.0};
    const double rate = limit_of(settings->rate_limit, &model->gyro.range, 3.0);
    const double force =
        limit_of(settings->force_limit, &model->accel.range, 10.0 * STANDARD_GRAVITY);
    size_t count;
    switch (settings->procedure) {
    case IMK_PROCEDURE_SIXPOSITION:
        return offer_poses(6, 1, gravity, step);
    case IMK_PROCEDURE_FERRARIS:
        count = offer_poses(6, 1, gravity, step);
        return count + offer_rates(full, 1, by_hand(settings, rate), gravity, step + count);
    case IMK_PROCEDURE_TURNS:
        return offer_rates(full, 2, by_hand(settings, rate), gravity, step);
    case IMK_PROCEDURE_RATE_TABLE:
        count = settings->nonlinear ? offer_rates(table, 9, rate, gravity, step)
                                    : offer_rates(linear, 5, rate, gravity, step);
        /* Three axes up do not tell three g-sensitivities and a bias: three down besides. */
        for (int axis = 0; settings->g_sensitivity && axis < 3; axis++) {
            double down[3] = {0.0, 0.0, 0.0};
            down[axis] = -1.0;
            step[count] = pose_of(down, 0.0);
            step[count++].force[axis] = -gravity;
        }
        return count;
    case IMK_PROCEDURE_TUMBLE:
        return offer_poses(26, 1, gravity, step);
    case IMK_PROCEDURE_CENTRIFUGE:
        count = offer_poses(6, 1, gravity, step);
        return count + offer_forces(settings, force, step + count);
    case IMK_PROCEDURE_SPIN:
        count = offer_rates(linear, 1, rate, gravity, step);
        return count + offer_rates(full, 2, rate, gravity, step + count);
    case IMK_PROCEDURE_THERMAL:
        return offer_temperatures(settings, gravity, step);
    default:
        return offer_poses(26, 4, gravity, step);
    }
}

bool imki_plan_is_list(imk_procedure procedure)
{
    return procedure != IMK_PROCEDURE_MULTIPOSITION && procedure != IMK_PROCEDURE_TUMBLE;
}

/* ---- parameters ---------------------------------------------------------------------------------
 */

static imk_status free_term(imk_calibration *c, int sensor, int term, int elements)
{
    const imk_triad *triad = imk_model_triad(&c->model, sensor);
    imk_status status = IMK_OK;
    for (int axis = 0; triad->present && axis < triad->axis_count && status == IMK_OK; axis++)
        for (int element = 0; element < elements && status == IMK_OK; element++) {
            if (term == IMK_MODEL_MISALIGNMENT && triad->axis_count == 3) {
                /* What the frame takes: see imk_triad_frame. */
                const bool upper = c->frame == IMK_FRAME_UPPER || c->frame == IMK_FRAME_SYMMETRIC;
                if (element == axis ||
                    (sensor == IMK_ACCEL && ((upper && element < axis) ||
                                             (c->frame == IMK_FRAME_LOWER && element > axis))))
                    continue;
            }
            status = imk_calibration_free(c, sensor, term, axis, element);
        }
    return status;
}

typedef struct term_list {
    imk_calibration *calibration;
    imk_status status; /* of the first that did not fit */
} term_list;

static void add(term_list *list, bool wanted, int sensor, int term, int elements)
{
    if (wanted && list->status == IMK_OK)
        list->status = free_term(list->calibration, sensor, term, elements);
}

/* Powers with q that procedures look for. */
static void add_powers(term_list *list, bool wanted, int sensor, int q)
{
    for (size_t k = 0; k < imki_input_power_count; k++)
        add(list, wanted && imki_input_powers[k].sought && imki_input_powers[k].q == q, sensor,
            imki_input_powers[k].term, 1);
}

imk_status imki_plan_free(const imk_plan_settings *s, imk_calibration *c, imk_error *error)
{
    const imk_procedure p = s->procedure;
    const bool turns = p == IMK_PROCEDURE_TURNS;
    const bool accel = p != IMK_PROCEDURE_RATE_TABLE && !turns;
    const bool linear_accel = accel && p != IMK_PROCEDURE_THERMAL && p != IMK_PROCEDURE_SPIN;
    const bool gyro = p != IMK_PROCEDURE_SPIN;
    const bool turned = p == IMK_PROCEDURE_MULTIPOSITION || p == IMK_PROCEDURE_FERRARIS ||
                        p == IMK_PROCEDURE_RATE_TABLE || turns;
    const bool forces = s->g_sensitivity && gyro && p != IMK_PROCEDURE_THERMAL && !turns;
    const bool curved_accel =
        s->nonlinear && (p == IMK_PROCEDURE_TUMBLE || p == IMK_PROCEDURE_CENTRIFUGE);
    const bool curved_gyro = s->nonlinear && p == IMK_PROCEDURE_RATE_TABLE;
    const bool centrifuge = p == IMK_PROCEDURE_CENTRIFUGE;
    const bool thermal = p == IMK_PROCEDURE_THERMAL;
    if (p != IMK_PROCEDURE_MULTIPOSITION)
        c->frame = IMK_FRAME_REFERENCE;
    if (c->parameter_count > 0)
        return IMK_OK;
    term_list list = {c, IMK_OK};
    add(&list, accel, IMK_ACCEL, IMK_MODEL_BIAS, 1);
    add(&list, linear_accel, IMK_ACCEL, IMK_MODEL_SCALE_FACTOR, 1);
    add(&list, linear_accel, IMK_ACCEL, IMK_MODEL_MISALIGNMENT, 3);
    /* Of turns the attitude limits the bias, and no longer test mends that. */
    add(&list, gyro && !turns, IMK_GYRO, IMK_MODEL_BIAS, 1);
    add(&list, turned, IMK_GYRO, IMK_MODEL_SCALE_FACTOR, 1);
    add(&list, turned, IMK_GYRO, IMK_MODEL_MISALIGNMENT, 3);
    add(&list, forces, IMK_GYRO, IMK_MODEL_G_SENSITIVITY, 3);
    add_powers(&list, curved_accel, IMK_ACCEL, 0);
    add_powers(&list, curved_accel && centrifuge, IMK_ACCEL, 1);
    add(&list, s->cross_products && linear_accel, IMK_ACCEL, IMK_MODEL_CROSS_PRODUCTS, 3);
    add_powers(&list, curved_gyro, IMK_GYRO, 0);
    add_powers(&list, curved_gyro, IMK_GYRO, 1);
    add(&list, p == IMK_PROCEDURE_SPIN, IMK_ACCEL, IMK_MODEL_LEVER_ARM, 3);
    add(&list, thermal, IMK_ACCEL, IMK_MODEL_BIAS_TEMPERATURE, s->temperature_order);
    add(&list, thermal, IMK_GYRO, IMK_MODEL_BIAS_TEMPERATURE, s->temperature_order);
    return list.status == IMK_OK ? IMK_OK
                                 : imk_error_set(error, list.status, "parameters", NULL,
                                                 "at most 64 free parameters");
}
