/* SPDX-License-Identifier: Apache-2.0 */
/* Multi-position test without a turntable: any attitudes at rest, turned by hand in between.
 *
 * Each hold is an observation of which |force| = gravity is known; its attitude is a nuisance of
 * the estimator. Between two holds the gyros must carry the vertical from one to the other: the
 * stretch from the end of one to the beginning of the next is a turn. How well both are known:
 * multiposition_sigma.c; what counts stand for when the model does not say: multiposition_start.c.
 * A table of means has holds only, with the sigmas that it states. */
#include "base/refuse_internal.h"
#include "multiposition_internal.h"
#include "procedure_internal.h"

#include "imukit/linear_algebra.h"
#include "imukit/samples.h"

#include "base/workspace_internal.h"

#include <math.h>

enum {
    /* Nine parameters of the accelerometers, and three holds more to tell how well they fit. */
    HOLDS_NEEDED = 12,
    /* Scale factors and misalignments of the gyros, nine, by two equations a turn; likewise. */
    TURNS_NEEDED = 8,
    /* More holds than any bench test has. */
    HOLDS_MAX = 65536
};

/* Left out at both ends of a hold unless the settings say it [s]: a hand needs some time to let go,
 * and a whole window, the detection's own choice, takes short holds away. */
static const double guard_of_holds = 0.3;

/* What is gathered before the calibration is touched. */
typedef struct gathering {
    const imki_procedure_call *call;
    const imk_test_record *record;
    imk_static_interval *hold;
    imk_turn *turn; /* from, to: indices of holds until they are appended */
    size_t hold_count, turn_count;
    imki_scaling scaling[2]; /* by nominal sensitivities, found or given */
    bool found[2];           /* by us */
} gathering;

static imk_static_settings detection_of(const imk_procedure_settings *settings)
{
    imk_static_settings stationary = settings->stationary;
    if (stationary.guard < 0.0)
        stationary.guard = guard_of_holds;
    return stationary;
}

static size_t hold_capacity(const imk_test_record *record, const imk_procedure_settings *settings)
{
    if (record->means)
        return record->count;
    const double shortest = fmax(settings->stationary.minimum, 2.0 * record->dt);
    const double most = (double)record->count * record->dt / shortest + 2.0;
    return most < HOLDS_MAX ? (size_t)most : HOLDS_MAX;
}

size_t imki_multiposition_workspace(const imk_test_record *record,
                                    const imk_procedure_settings *settings)
{
    const imk_static_settings stationary = detection_of(settings);
    return IMKI_ALIGNMENT_SLACK +
           hold_capacity(record, settings) * (sizeof(imk_static_interval) + sizeof(imk_turn)) +
           imk_static_workspace_size(record, &stationary);
}

static imk_status too_few(imk_error *error, const char *field, size_t found, size_t needed,
                          const char *expected)
{
    return imki_refuse(error, IMK_ERROR_TOO_SHORT, field, (double)found, (double)needed, expected);
}

static imk_status find_holds(gathering *g)
{
    const imki_procedure_call *call = g->call;
    const size_t capacity = hold_capacity(g->record, call->settings);
    if (!call->workspace ||
        call->workspace_size < imki_multiposition_workspace(g->record, call->settings))
        return imk_error_set(call->error, IMK_ERROR_WORKSPACE, "workspace", NULL,
                             "imk_procedure_workspace_size() bytes");
    g->hold = (imk_static_interval *)(void *)imki_align(call->workspace);
    g->turn = (imk_turn *)(void *)(g->hold + capacity);
    void *rest = g->turn + capacity;
    const size_t used = (size_t)((char *)rest - (char *)call->workspace);
    size_t count = 0;
    const imk_static_settings stationary = detection_of(call->settings);
    const imk_status status = imk_static_detect(
        g->record, &stationary, &call->calibration->model, g->hold, capacity, &count, NULL,
        &call->findings->stationary, rest, call->workspace_size - used, call->error);
    if (status != IMK_OK)
        return status;
    call->findings->intervals = count;
    /* Holds that something is missing of are left out; the others move up. */
    const size_t written = count < capacity ? count : capacity;
    for (size_t i = 0; i < written; i++) {
        bool complete = g->hold[i].end > g->hold[i].begin &&
                        (!call->settings->labelled_only || g->hold[i].section >= 0);
        for (int axis = 0; axis < g->record->axis_count[IMK_ACCEL]; axis++)
            complete = complete && isfinite(g->hold[i].mean[IMK_ACCEL][axis]);
        if (complete)
            g->hold[g->hold_count++] = g->hold[i];
    }
    call->findings->left_out = count - g->hold_count;
    return IMK_OK;
}

/* No step longer than a sample. */
static bool without_gap(const imk_test_record *record, size_t begin, size_t end)
{
    for (size_t k = begin > 0 ? begin : 1; record->time && k < end; k++)
        if (imk_step_is_gap(record->time[k] - record->time[k - 1], record->dt))
            return false;
    return true;
}

/* Every reading of a sensor is there, and within its range. */
static bool within_range(const gathering *g, int sensor, size_t begin, size_t end)
{
    for (int i = 0; i < g->record->axis_count[sensor]; i++) {
        const double *reading = g->record->reading[sensor][i];
        const double range = imk_model_triad(&g->call->calibration->model, sensor)->range.value[i];
        /* A hair below full scale is there. */
        const double limit =
            range > 0.0 ? 0.9999 * range / fabs(g->scaling[sensor].unit[i]) : (double)INFINITY;
        for (size_t k = begin; k < end; k++)
            if (!(fabs(reading[k] - g->scaling[sensor].zero[i]) < limit))
                return false;
    }
    return true;
}

static double span_of(const imk_test_record *record, size_t begin, size_t end)
{
    return record->time && begin > 0 && end > begin
               ? record->time[end - 1] - record->time[begin - 1]
               : (double)(end - begin) * record->dt;
}

static void find_turns(gathering *g)
{
    for (size_t i = 1; i < g->hold_count; i++) {
        const imk_turn turn = {.from = (int)(i - 1),
                               .to = (int)i,
                               .begin = g->hold[i - 1].end,
                               .end = g->hold[i].begin};
        if (turn.end > turn.begin && without_gap(g->record, turn.begin, turn.end) &&
            within_range(g, IMK_GYRO, turn.begin, turn.end) &&
            within_range(g, IMK_ACCEL, turn.begin, turn.end))
            g->turn[g->turn_count++] = turn;
    }
}

/* Four digits are enough for a nominal value: what is left is estimated. */
static double four_digits(double value)
{
    double scale = 1.0;
    while (fabs(value) * scale < 1000.0 && scale < 1e12)
        scale *= 10.0;
    return floor(value * scale + 0.5) / scale;
}

static void set_nominal(gathering *g, int sensor, const imki_scaling *found)
{
    for (int i = 0; i < 3; i++) {
        g->scaling[sensor].unit[i] = 1.0 / four_digits(1.0 / found->unit[i]);
        g->scaling[sensor].zero[i] = floor(found->zero[i] + 0.5);
    }
    g->found[sensor] = true;
}

static bool needs_nominal(const gathering *g, int sensor)
{
    return g->record->counts[sensor] && g->record->axis_count[sensor] > 0 &&
           imk_model_triad(&g->call->calibration->model, sensor)->sensitivity.value[0] == 0.0;
}

static void take_nominal(gathering *g)
{
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < IMK_AXES_MAX; i++) {
            const double sensitivity =
                imk_model_triad(&g->call->calibration->model, sensor)->sensitivity.value[i];
            const bool counts = g->record->counts[sensor] && sensitivity != 0.0;
            g->scaling[sensor].unit[i] = counts ? 1.0 / sensitivity : 1.0;
            g->scaling[sensor].zero[i] =
                counts ? imk_model_triad(&g->call->calibration->model, sensor)->zero_offset.value[i]
                       : 0.0;
        }
}

/* Mean reading of the gyros at rest, a hold weighing by its length. */
static void mean_at_rest(const gathering *g, double mean[IMK_AXES_MAX])
{
    for (int i = 0; i < g->record->axis_count[IMK_GYRO]; i++) {
        double sum = 0.0, weight = 0.0;
        for (size_t k = 0; k < g->hold_count; k++) {
            const double samples = (double)(g->hold[k].end - g->hold[k].begin);
            if (isfinite(g->hold[k].mean[IMK_GYRO][i])) {
                sum += samples * g->hold[k].mean[IMK_GYRO][i];
                weight += samples;
            }
        }
        mean[i] = weight > 0.0 ? sum / weight : 0.0;
    }
}

static imk_status no_nominal(const gathering *g, const char *field, const char *expected)
{
    return imk_error_set(g->call->error, IMK_ERROR_UNIT_MISSING, field, "count", expected);
}

static imk_status find_accel_nominal(gathering *g)
{
    imki_scaling found;
    if (!needs_nominal(g, IMK_ACCEL))
        return IMK_OK;
    if (g->record->axis_count[IMK_ACCEL] != 3 ||
        !imki_start_accelerometers(g->hold_count, g->hold, g->call->calibration->gravity, &found))
        return no_nominal(
            g, "accel.sensitivity",
            "log a triad in poses on all its sides, or state the sensitivity in the model");
    set_nominal(g, IMK_ACCEL, &found);
    return IMK_OK;
}

static imk_status find_gyro_nominal(gathering *g)
{
    imki_scaling found;
    if (!needs_nominal(g, IMK_GYRO))
        return IMK_OK;
    mean_at_rest(g, found.zero);
    if (g->record->axis_count[IMK_GYRO] != 3 || g->record->axis_count[IMK_ACCEL] != 3 ||
        !imki_start_gyros(g->record, &g->scaling[IMK_ACCEL], g->turn_count, g->turn, &found))
        return no_nominal(
            g, "gyro.sensitivity",
            "log two triads in turns about all axes, or state the sensitivity in the model");
    set_nominal(g, IMK_GYRO, &found);
    return IMK_OK;
}

/* Step of a reading, in its unit; 0: not known. */
static double step_of(const gathering *g, int sensor, int axis)
{
    return g->record->counts[sensor]
               ? 1.0
               : imk_model_triad(&g->call->calibration->model, sensor)->resolution.value[axis];
}

static imki_turn_surroundings surroundings_of(const gathering *g)
{
    imki_turn_surroundings around = {.axis_count = g->record->axis_count[IMK_GYRO],
                                     .dt = g->record->dt,
                                     .latitude = g->call->calibration->latitude,
                                     .earth_rate = g->call->calibration->earth_rate};
    for (int i = 0; i < around.axis_count; i++) {
        around.unit[i] = g->scaling[IMK_GYRO].unit[i];
        around.step[i] = step_of(g, IMK_GYRO, i);
    }
    return around;
}

/* Smallest eigenvalue of the mean outer product of the directions of the holds. */
static double spread_of(const gathering *g)
{
    double outer[9] = {0.0}, value[3];
    for (size_t k = 0; k < g->hold_count; k++) {
        double f[3], square = 0.0;
        for (int i = 0; i < 3; i++) {
            f[i] = (g->hold[k].mean[IMK_ACCEL][i] - g->scaling[IMK_ACCEL].zero[i]) *
                   g->scaling[IMK_ACCEL].unit[i];
            square += f[i] * f[i];
        }
        for (int i = 0; square > 0.0 && i < 9; i++)
            outer[i] += f[i / 3] * f[i % 3] / (square * (double)g->hold_count);
    }
    return imk_symmetric_eigen(3, outer, value, NULL) == IMK_OK ? fmax(value[0], 0.0) : 0.0;
}

static imk_observation observation_of(const gathering *g, const imki_hold_noise *noise,
                                      const imk_static_interval *hold)
{
    imk_observation o = {.knowledge = IMK_INPUT_GRAVITY,
                         .record = g->call->record,
                         .begin = hold->begin,
                         .end = hold->end,
                         .temperature = hold->temperature,
                         .temperature_rate = hold->temperature_rate,
                         .fixture = -1,
                         .correlated =
                             g->record->means /* when the rows were taken, nobody says */};
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < IMK_AXES_MAX; i++) {
            const bool present = i < g->record->axis_count[sensor];
            o.reading[sensor][i] = present ? hold->mean[sensor][i] : (double)NAN;
            o.sigma[sensor][i] =
                !present           ? 1.0
                : g->record->means ? hold->sigma[sensor][i]
                                   : imki_hold_sigma(noise, hold, sensor, i, step_of(g, sensor, i));
        }
    for (int i = 0; i < 3; i++)
        o.force[i] = (hold->mean[IMK_ACCEL][i] - g->scaling[IMK_ACCEL].zero[i]) *
                     g->scaling[IMK_ACCEL].unit[i];
    return o;
}

/* Holds of unknown attitude that other logs have brought already. */
static size_t holds_before(const imk_calibration *calibration)
{
    size_t count = 0;
    for (size_t i = 0; i < calibration->observation_count; i++)
        count += calibration->observation[i].knowledge == IMK_INPUT_GRAVITY;
    return count;
}

static bool with_turns(const gathering *g)
{
    return g->call->settings->gyro_turns && g->record->axis_count[IMK_GYRO] >= 3 &&
           !g->record->means;
}

static imk_status check_amount(const gathering *g)
{
    const imk_calibration *calibration = g->call->calibration;
    imk_error *error = g->call->error;
    const size_t holds = g->hold_count + holds_before(calibration);
    const size_t turns = g->turn_count + calibration->turn_count;
    if (g->hold_count == 0 || (!g->call->keep_free && holds < HOLDS_NEEDED))
        return too_few(error, "hold", holds, HOLDS_NEEDED,
                       "add poses at rest, each with another side up");
    if (!g->call->keep_free && with_turns(g) && turns < TURNS_NEEDED)
        return too_few(error, "turn", turns, TURNS_NEEDED,
                       "log successive holds in one record, with no samples missing between them");
    const size_t observations = calibration->observation_count + g->hold_count;
    if (observations > calibration->observation_capacity || turns > calibration->turn_capacity) {
        const bool of_turns = observations <= calibration->observation_capacity;
        return imki_refuse(
            error, IMK_ERROR_WORKSPACE, of_turns ? "turn" : "observation",
            (double)(of_turns ? turns : observations),
            (double)(of_turns ? calibration->turn_capacity : calibration->observation_capacity),
            "provide room for all of them");
    }
    return IMK_OK;
}

/* The estimator starts the gyros' biases from their means at rest, unless something is known. */
static void start_gyro_bias(const gathering *g)
{
    imk_calibration *calibration = g->call->calibration;
    imk_axes *bias = &calibration->model.gyro.bias.fixed;
    double mean[IMK_AXES_MAX];
    if (g->call->keep_free || g->record->axis_count[IMK_GYRO] == 0)
        return;
    mean_at_rest(g, mean);
    for (size_t p = 0; p < calibration->parameter_count; p++) {
        const imk_model_parameter at = calibration->parameter[p];
        if (at.sensor == IMK_GYRO && at.term == IMK_MODEL_BIAS &&
            at.axis < g->record->axis_count[IMK_GYRO] && calibration->prior_sigma[p] == 0.0 &&
            bias->value[at.axis] == 0.0)
            bias->value[at.axis] =
                imki_reading_si(&calibration->model, g->record, IMK_GYRO, at.axis, mean[at.axis]);
    }
}

static imk_status free_parameters(const gathering *g)
{
    const imki_procedure_call *call = g->call;
    imk_status status = IMK_OK;
    if (call->keep_free)
        return status;
    static const struct {
        int sensor, term, elements;
    } terms[] = {{IMK_ACCEL, IMK_MODEL_BIAS, 1},         {IMK_ACCEL, IMK_MODEL_SCALE_FACTOR, 1},
                 {IMK_ACCEL, IMK_MODEL_MISALIGNMENT, 3}, {IMK_GYRO, IMK_MODEL_BIAS, 1},
                 {IMK_GYRO, IMK_MODEL_SCALE_FACTOR, 1},  {IMK_GYRO, IMK_MODEL_MISALIGNMENT, 3},
                 {IMK_GYRO, IMK_MODEL_G_SENSITIVITY, 3}};
    for (size_t i = 0; i < sizeof terms / sizeof terms[0] && status == IMK_OK; i++) {
        const bool gyro = terms[i].sensor == IMK_GYRO;
        const bool by_turns =
            terms[i].term == IMK_MODEL_SCALE_FACTOR || terms[i].term == IMK_MODEL_MISALIGNMENT;
        if ((gyro && g->record->axis_count[IMK_GYRO] == 0) ||
            (gyro && by_turns && !with_turns(g)) ||
            (terms[i].term == IMK_MODEL_G_SENSITIVITY && !call->settings->g_sensitivity))
            continue;
        status = imki_free_term(call, terms[i].sensor, terms[i].term, terms[i].elements, false);
    }
    return status;
}

/* What rounding leaves in the mean of a gyro is most of what its bias is uncertain by. */
static bool is_coarse(const gathering *g, const imki_hold_noise *noise)
{
    bool coarse = false;
    for (int i = 0; i < g->record->axis_count[IMK_GYRO]; i++) {
        const double rounding = noise->rounding[IMK_GYRO][i];
        coarse = coarse ||
                 noise->holds * rounding * rounding > noise->level[IMK_GYRO][i] / noise->typical;
    }
    return coarse;
}

/* Everything is there: append. */
static imk_status append(gathering *g)
{
    const imki_procedure_call *call = g->call;
    imk_calibration *calibration = call->calibration;
    imk_procedure_findings *findings = call->findings;
    for (int sensor = 0; sensor < 2; sensor++) {
        imk_triad *triad = imk_model_triad_to_set(&calibration->model, sensor);
        for (int i = 0; g->found[sensor] && i < 3; i++) {
            triad->sensitivity.value[i] = four_digits(1.0 / g->scaling[sensor].unit[i]);
            triad->zero_offset.value[i] = g->scaling[sensor].zero[i];
        }
    }
    const imki_turn_surroundings around = surroundings_of(g);
    imki_hold_noise noise;
    imki_hold_noise_find(g->record, g->hold_count, g->hold, &noise);
    calibration->gyro_coarse = calibration->gyro_coarse || is_coarse(g, &noise);
    findings->first_observation = calibration->observation_count;
    findings->first_turn = calibration->turn_count;
    for (size_t k = 0; k < g->hold_count; k++) {
        const imk_observation o = observation_of(g, &noise, &g->hold[k]);
        if (imk_calibration_observe(calibration, &o) < 0)
            return imk_error_set(call->error, IMK_ERROR_WORKSPACE, "observation", NULL,
                                 "provide room for all of them");
    }
    const int first = (int)findings->first_observation;
    for (size_t t = 0; with_turns(g) && t < g->turn_count; t++) {
        imk_turn turn = g->turn[t];
        turn.sigma = imki_turn_sigma(&around, &noise, span_of(g->record, turn.begin, turn.end),
                                     &turn.earth_sigma);
        turn.from += first;
        turn.to += first;
        calibration->turn[calibration->turn_count++] = turn;
    }
    findings->observations = g->hold_count;
    findings->turns = calibration->turn_count - findings->first_turn;
    findings->spread = spread_of(g);
    return IMK_OK;
}

imk_status imki_multiposition_observe(const imki_procedure_call *call)
{
    gathering g = {.call = call, .record = call->calibration->record[call->record]};
    if (g.record->axis_count[IMK_ACCEL] < 3)
        return imk_error_set(call->error, IMK_ERROR_KEY_MISSING, "accel", NULL,
                             "three accelerometers");
    take_nominal(&g);
    imk_status status = find_holds(&g);
    if (status == IMK_OK && with_turns(&g))
        find_turns(&g);
    if (status == IMK_OK)
        status = check_amount(&g);
    if (status == IMK_OK)
        status = find_accel_nominal(&g);
    if (status == IMK_OK)
        status = find_gyro_nominal(&g);
    if (status == IMK_OK)
        status = append(&g);
    if (status == IMK_OK)
        status = free_parameters(&g);
    if (status == IMK_OK)
        start_gyro_bias(&g);
    return status;
}
