/* SPDX-License-Identifier: Apache-2.0 */
/* The thermal procedure: a log as observations with a temperature for the joint estimator.
 *
 * One pose. The blocks of the analysis (thermal.h) are observed, the hysteresis it found taken out.
 * The force is what the accelerometers read at the reference temperature, corrected by the model:
 * one pose tells what changes, not what the bias is there, and bias.fixed stays as it was. Where
 * other logs determine the bias, before this one, the force is gravity in that direction, and the
 * attitude is left open by a fixture of its own. Gyros at rest see the vertical part of the Earth's
 * rate, as far as latitude and attitude are known, and their bias is observed.
 *
 * The estimator takes observations for independent. What correlated noise adds to the variance of
 * the coefficients, over what equal weights and white residuals would give them, is a factor k^2
 * for each axis, the largest of its coefficients: residuals and sigmas are both multiplied by k.
 * Equal weights leave the residuals at right angles to the columns, so that the coefficients do
 * not move; only their sigmas are what they must be.
 *
 * Several poses, or a reference: thermal_poses.c. */
#include "base/algebra/vector_internal.h"
#include "calibrate/procedures/procedure_internal.h"
#include "imukit/correct.h"
#include "imukit/elementary.h"
#include "imukit/linear_algebra.h"
#include "imukit/thermal.h"
#include "imukit/units.h"
#include "thermal_internal.h"
#include "thermal_procedure_internal.h"

#include <math.h>
#include <string.h>

enum { N = IMKI_THERMAL_COLUMNS };

static imk_status set_free(const imki_procedure_call *call, int sensor, int term, int axis,
                           int element)
{
    if (call->keep_free)
        return IMK_OK;
    const imk_status status = imk_calibration_free(call->calibration, sensor, term, axis, element);
    return status == IMK_OK ? IMK_OK
                            : imk_error_set(call->error, status, "parameters", NULL,
                                            "at most 64 parameters can be estimated at once");
}

/* Turn a reading in SI back into the unit of the record. */
static double in_record_unit(const imk_model *model, const imk_test_record *record, int sensor,
                             int axis, double reading)
{
    const imk_triad *triad = imk_model_triad(model, sensor);
    if (!record->counts[sensor])
        return reading;
    return reading * triad->sensitivity.value[axis] + triad->zero_offset.value[axis];
}

static double sigma_in_record_unit(const imk_model *model, const imk_test_record *record,
                                   int sensor, int axis, double sigma)
{
    const imk_triad *triad = imk_model_triad(model, sensor);
    return record->counts[sensor] ? sigma * fabs(triad->sensitivity.value[axis]) : sigma;
}

/* ---- one pose -------------------------------------------------------------------------------- */

/* What every block sees. */
typedef struct surroundings {
    double rate[3], force[3];
    int fixture;
} surroundings;

/* Force that the model makes of the readings at the reference temperature. */
static void force_of(const imki_procedure_call *call, const imk_thermal_findings *findings,
                     imk_correction *correction, double force[3])
{
    imk_model *model = &call->calibration->model;
    const imk_test_record *record = call->calibration->record[call->record];
    imk_readings readings = {0};
    double reading[2][IMK_AXES_MAX] = {{0.0}}, out[2][IMK_AXES_MAX];
    double *to[2][IMK_AXES_MAX];
    /* Polynomials vanish without a temperature. What ranges and nonlinear terms would ask for is
     * beside the point: gravity is far inside. */
    imk_correction_settings settings = imk_correction_default();
    settings.force_limit = 2.0 * IMK_STANDARD_GRAVITY;
    settings.rate_limit = 1.0;
    memset(force, 0, 3 * sizeof *force);
    if (imk_correction_start(correction, model, &settings, NULL) != IMK_OK ||
        !correction->solves[IMK_ACCEL])
        return;
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < IMK_AXES_MAX; i++) {
            if (i < record->axis_count[sensor])
                reading[sensor][i] = findings->axis[sensor][i].constant.value;
            const imk_triad *triad = imk_model_triad(model, sensor);
            if (triad->present && i < triad->axis_count && triad->sensitivity.value[i] != 0.0)
                reading[sensor][i] =
                    reading[sensor][i] * triad->sensitivity.value[i] + triad->zero_offset.value[i];
            readings.channel[sensor][i] = &reading[sensor][i];
            to[sensor][i] = &out[sensor][i];
        }
    imk_correct(correction, &readings, 1, (double *const(*)[IMK_AXES_MAX])to);
    memcpy(force, out[IMK_ACCEL], 3 * sizeof *force);
}

static imk_status look_around(const imki_procedure_call *call, const imk_thermal_findings *findings,
                              imki_thermal_work *work, surroundings *s)
{
    /* A unit before its calibration shows the vertical to some degrees. */
    const double attitude_sigma = 0.1;
    imk_calibration *c = call->calibration;
    *s = (surroundings){.fixture = -1};
    if (findings->axis_count[IMK_ACCEL] == 0)
        return IMK_OK;
    force_of(call, findings, &work->correction, s->force);
    const double length = imki_norm3(s->force);
    if (!(length > 0.0))
        return IMK_OK;
    for (int k = 0; k < 3; k++)
        /* The vertical part of the Earth's rate: upwards on the northern half, and so is the force.
         */
        s->rate[k] = c->latitude == c->latitude
                         ? c->earth_rate * imk_sin(c->latitude) * s->force[k] / length
                         : 0.0;
    if (!imki_thermal_is_free(c, IMK_ACCEL, IMK_MODEL_BIAS))
        return IMK_OK;
    for (int k = 0; k < 3; k++)
        s->force[k] *= c->gravity / length;
    if (c->fixture_count >= IMK_FIXTURES_MAX)
        return imk_error_set(call->error, IMK_ERROR_RANGE, "fixtures", NULL,
                             "fewer logs: each log has a mounting of its own");
    s->fixture = (int)c->fixture_count;
    c->fixture_sigma[c->fixture_count++] = attitude_sigma;
    return IMK_OK;
}

/* k of an axis, and the standard deviation of a block by itself. */
static double inflation(const imki_thermal_work *work, int axis, const imk_thermal_axis *out,
                        double *sigma)
{
    int index[N];
    imki_thermal_estimate fit;
    double a[N * N], inverse[N * N], rss = 0.0, largest = 1.0;
    const size_t n = work->blocks.count;
    const size_t q = imki_thermal_list(imki_thermal_columns(out) & work->available, index);
    *sigma = 0.0;
    if (!imki_thermal_fit(work, axis, imki_thermal_columns(out), &fit))
        return 1.0;
    for (size_t b = 0; b < n; b++) {
        double r = work->blocks.reading[axis][b];
        for (int c = 0; c < N; c++)
            r -= fit.value[c] * work->blocks.column[c][b];
        rss += r * r;
    }
    const double variance = rss / (double)(n - q);
    *sigma = sqrt(variance);
    /* Unknowns of the estimator: hysteresis has been taken out, and the constant of accelerometers
     * is the force they are given. */
    const unsigned given = 1u << IMKI_THERMAL_STATE | (axis >= IMK_AXES_MAX ? 1u : 0u);
    const size_t m = imki_thermal_list(imki_thermal_columns(out) & work->available & ~given, index);
    for (size_t i = 0; i < m; i++)
        for (size_t j = 0; j < m; j++)
            a[i * m + j] = work->square_moment[index[i] * N + index[j]];
    if (!(variance > 0.0) || imk_cholesky_factor(m, a) != IMK_OK)
        return 1.0;
    imk_cholesky_inverse(m, a, inverse);
    for (size_t i = 0; i < m; i++)
        if (index[i] > 0)
            largest = fmax(largest, fit.covariance[index[i] * N + index[i]] /
                                        (variance * inverse[i * m + i]));
    return sqrt(largest);
}

typedef struct block_reading {
    double sigma, stretch;
    imki_thermal_estimate fit;
} block_reading;

static void prepare(const imki_thermal_work *work, int axis, const imk_thermal_axis *out,
                    block_reading *r)
{
    double sigma = 0.0;
    r->stretch = inflation(work, axis, out, &sigma);
    r->sigma = r->stretch * sigma;
    /* Readings without noise still need a weight. */
    if (!(r->sigma > 0.0))
        r->sigma = 1e-12;
    if (!imki_thermal_fit(work, axis, imki_thermal_columns(out), &r->fit))
        memset(&r->fit, 0, sizeof r->fit);
}

/* Reading of block b: fit without hysteresis, and the residual stretched. */
static double reading_of(const imki_thermal_work *work, int axis, const block_reading *r, size_t b)
{
    double fit = 0.0, loop;
    for (int c = 0; c < N; c++)
        fit += r->fit.value[c] * work->blocks.column[c][b];
    loop = r->fit.value[IMKI_THERMAL_STATE] * work->blocks.column[IMKI_THERMAL_STATE][b];
    return work->blocks.mean[axis] + fit - loop +
           r->stretch * (work->blocks.reading[axis][b] - fit);
}

static imk_status observe_blocks(const imki_procedure_call *call,
                                 const imk_thermal_findings *findings, imki_thermal_work *work)
{
    const imk_test_record *record = call->calibration->record[call->record];
    const imk_model *model = &call->calibration->model;
    block_reading prepared[IMKI_THERMAL_AXES];
    surroundings around;
    imk_status status = look_around(call, findings, work, &around);
    for (int a = 0; a < IMKI_THERMAL_AXES; a++)
        if (work->blocks.used[a])
            prepare(work, a, &findings->axis[a / IMK_AXES_MAX][a % IMK_AXES_MAX], &prepared[a]);
    for (size_t b = 0; b < work->blocks.count && status == IMK_OK; b++) {
        imk_observation o = {.knowledge = IMK_INPUT_KNOWN,
                             .record = call->record,
                             .begin = work->blocks.first[b],
                             .end = work->blocks.last[b] + 1,
                             .temperature = work->blocks.temperature[b],
                             .temperature_rate = work->blocks.rate[b],
                             .fixture = around.fixture,
                             .correlated = true};
        memcpy(o.rate, around.rate, sizeof o.rate);
        memcpy(o.force, around.force, sizeof o.force);
        for (int a = 0; a < IMKI_THERMAL_AXES; a++) {
            const int sensor = a / IMK_AXES_MAX, axis = a % IMK_AXES_MAX;
            o.reading[sensor][axis] = (double)NAN;
            o.sigma[sensor][axis] = 1.0;
            if (!work->blocks.used[a])
                continue;
            o.reading[sensor][axis] =
                in_record_unit(model, record, sensor, axis, reading_of(work, a, &prepared[a], b));
            o.sigma[sensor][axis] =
                sigma_in_record_unit(model, record, sensor, axis, prepared[a].sigma);
        }
        status = imki_thermal_add(call, &o);
    }
    return status;
}

static imk_status free_one_pose(const imki_procedure_call *call,
                                const imk_thermal_findings *findings)
{
    imk_model *model = &call->calibration->model;
    imk_status status = IMK_OK;
    for (int sensor = 0; sensor < 2; sensor++) {
        int order = 0;
        for (int i = 0; i < findings->axis_count[sensor]; i++)
            order =
                findings->axis[sensor][i].order > order ? findings->axis[sensor][i].order : order;
        imki_thermal_set_range(
            &imk_model_triad_to_set(model, sensor)->bias.temperature, order, findings->reference,
            findings->minimum, findings->maximum,
            imki_thermal_is_free(call->calibration, sensor, IMK_MODEL_BIAS_TEMPERATURE));
        for (int i = 0; i < findings->axis_count[sensor] && status == IMK_OK; i++) {
            const imk_thermal_axis *axis = &findings->axis[sensor][i];
            if (sensor == IMK_GYRO)
                status = set_free(call, sensor, IMK_MODEL_BIAS, i, 0);
            for (int k = 0; k < axis->order && status == IMK_OK; k++)
                status = set_free(call, sensor, IMK_MODEL_BIAS_TEMPERATURE, i, k);
            if (status == IMK_OK &&
                (axis->cause == IMK_THERMAL_RATE || axis->cause == IMK_THERMAL_BOTH))
                status = set_free(call, sensor, IMK_MODEL_TEMPERATURE_RATE, i, 0);
        }
    }
    return status;
}

static imk_status observe_one_pose(const imki_procedure_call *call)
{
    imk_calibration *c = call->calibration;
    imk_thermal_settings settings = imk_thermal_default();
    imk_thermal_findings *findings = call->workspace;
    void *workspace = findings + 1;
    const size_t size = call->workspace_size - sizeof *findings;
    settings.order = call->settings->temperature_order > 0 ? call->settings->temperature_order : -1;
    settings.reference_temperature = call->settings->reference_temperature;
    /* A second log must agree with the first about where the polynomial vanishes. */
    for (int sensor = 0; sensor < 2; sensor++)
        if (imki_thermal_is_free(c, sensor, IMK_MODEL_BIAS_TEMPERATURE))
            settings.reference_temperature =
                imk_model_triad_to_set(&c->model, sensor)->bias.temperature.reference;
    imk_status status = imk_thermal_analyse(c->record[call->record], &settings, &c->model, findings,
                                            workspace, size, call->error);
    if (status == IMK_OK)
        status = free_one_pose(call, findings);
    if (status == IMK_OK)
        status = observe_blocks(call, findings, imki_thermal_work_of(workspace));
    call->findings->intervals = status == IMK_OK ? findings->blocks : 0;
    return status;
}

/* ---- interface ------------------------------------------------------------------------------- */

imk_status imki_thermal_observe(const imki_procedure_call *call)
{
    const imk_test_record *record = call->calibration->record[call->record];
    if (!record->temperature)
        return imk_error_set(call->error, IMK_ERROR_KEY_MISSING, "temperature", NULL,
                             "a temperature column");
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; record->counts[sensor] && i < record->axis_count[sensor]; i++)
            if (!(imk_model_triad_to_set(&call->calibration->model, sensor)->sensitivity.value[i] !=
                  0.0))
                return imk_error_set(call->error, IMK_ERROR_UNIT_MISSING,
                                     sensor == IMK_GYRO ? "gyro" : "accel", "counts",
                                     "a model with the sensitivity of the sensors");
    const bool reference = record->reference_force[0] || record->reference_rate[0];
    return reference || imki_thermal_turned(record, &call->calibration->model) < record->count
               ? imki_thermal_observe_poses(call)
               : observe_one_pose(call);
}

size_t imki_thermal_workspace(const imk_test_record *record, const imk_procedure_settings *settings)
{
    const size_t one = sizeof(imk_thermal_findings) + imk_thermal_workspace_size();
    const size_t several = imki_thermal_poses_workspace(record, settings);
    return one > several ? one : several;
}
