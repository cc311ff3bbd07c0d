/* SPDX-License-Identifier: Apache-2.0 */
/* Which pose would help most: of directions all over the sphere the one whose observation adds most
 * to the determinant of the information there is, 1/2 log det(F + F_pose)/det F, and so on with
 * those chosen taken as done. What is not determined yet counts by the little that is assumed
 * (plan_criterion.c), so that poses which determine it come first. */
#include "base/workspace_internal.h"
#include "plan_internal.h"

#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

enum { CUBE = 26, SPIRAL = 48, DIRECTIONS = CUBE + SPIRAL, LINE = 64 };

typedef struct pose_job {
    imk_calibration *calibration; /* a copy with one observation */
    imk_observation observation;
    double *sum, *of_direction, *work;
    void *solver;
    size_t solver_size, n;
    double regular[IMK_CORRELATED_MAX], before[IMK_CORRELATED_MAX], after[IMK_CORRELATED_MAX];
} pose_job;

static void direction_of(size_t index, double up[3])
{
    if (index < CUBE) {
        imki_plan_direction(index, up);
        return;
    }
    /* Evenly over the sphere along a spiral. */
    const double k = (double)(index - CUBE) + 0.5;
    up[2] = 1.0 - 2.0 * k / SPIRAL;
    const double across = sqrt(1.0 - up[2] * up[2]), turn = 2.399963229728653 * k;
    up[0] = across * imk_cos(turn);
    up[1] = across * imk_sin(turn);
}

static size_t fixed_size(void)
{
    const size_t square = (size_t)IMK_CORRELATED_MAX * IMK_CORRELATED_MAX * sizeof(double);
    return (sizeof(imk_calibration) + LINE) / LINE * LINE + (DIRECTIONS + 4) * square;
}

size_t imk_next_pose_workspace_size(const imk_calibration *calibration)
{
    if (!calibration)
        return 0;
    /* One observation needs less than those there are, or this much. */
    const imk_calibration *c = calibration;
    const size_t solver = imk_calibration_workspace_size(c);
    return IMKI_ALIGNMENT_SLACK + fixed_size() + 2 * solver + 65536;
}

/* Median of what is stated for an axis; `otherwise` where it was not observed. */
static double usual_sigma(const imk_calibration *c, int sensor, int axis, double otherwise)
{
    enum { MOST = 255 };
    double value[MOST];
    size_t count = 0;
    for (size_t i = 0; i < c->observation_count && count < MOST; i++) {
        const imk_observation *o = &c->observation[i];
        if (isnan(o->reading[sensor][axis]))
            continue;
        size_t j = count++;
        for (; j > 0 && value[j - 1] > o->sigma[sensor][axis]; j--)
            value[j] = value[j - 1];
        value[j] = o->sigma[sensor][axis];
    }
    return count > 0 ? value[count / 2] : otherwise;
}

static void prepare(pose_job *job, const imk_calibration *c, double sigma)
{
    imk_observation *o = &job->observation;
    memset(o, 0, sizeof *o);
    o->knowledge = IMK_INPUT_GRAVITY;
    o->record = -1;
    o->fixture = -1;
    o->temperature = (double)NAN;
    for (int sensor = 0; sensor < 2; sensor++) {
        const imk_triad *triad = imk_model_triad(&c->model, sensor);
        for (int i = 0; i < IMK_AXES_MAX; i++) {
            const bool there = triad->present && i < triad->axis_count;
            const double usual =
                there ? usual_sigma(c, sensor, i, sensor == IMK_GYRO ? 0.0 : 1e-3) : 0.0;
            o->sigma[sensor][i] = sensor == IMK_ACCEL && sigma > 0.0 ? sigma : usual;
            o->reading[sensor][i] = usual > 0.0 ? 0.0 : (double)NAN;
        }
    }
    /* Stated in counts where the log has them; the copy has no record, so in SI. */
    for (size_t i = 0; i < c->observation_count; i++) {
        const int record = c->observation[i].record;
        const imk_test_record *r =
            record >= 0 && record < (int)c->record_count ? c->record[record] : NULL;
        for (int sensor = 0; r && sensor < 2; sensor++) {
            const imk_triad *triad = imk_model_triad(&c->model, sensor);
            for (int k = 0; r->counts[sensor] && k < triad->axis_count; k++)
                if (triad->sensitivity.value[k] != 0.0 && !(sensor == IMK_ACCEL && sigma > 0.0))
                    o->sigma[sensor][k] /= fabs(triad->sensitivity.value[k]);
        }
        if (r)
            break;
    }
    *job->calibration = *c;
    job->calibration->observation = &job->observation;
    job->calibration->observation_count = 1;
    job->calibration->turn_count = 0;
    job->calibration->record_count = 0;
    job->calibration->fixture_count = 0;
    for (size_t p = 0; p < c->parameter_count; p++)
        job->calibration->prior_sigma[p] = 0.0;
}

static imk_status look(pose_job *job, imk_error *error)
{
    const size_t n = job->n;
    double most[IMK_CORRELATED_MAX];
    for (size_t p = 0; p < n; p++)
        most[p] = job->sum[p * n + p];
    for (size_t d = 0; d < DIRECTIONS; d++) {
        double up[3];
        direction_of(d, up);
        for (int i = 0; i < 3; i++)
            job->observation.force[i] = job->calibration->gravity * up[i];
        double *f = job->of_direction + d * n * n;
        const imk_status status =
            imk_calibration_information(job->calibration, f, job->solver, job->solver_size, error);
        if (status != IMK_OK)
            return status;
        for (size_t p = 0; p < n; p++)
            most[p] = fmax(most[p], f[p * n + p]);
    }
    imki_plan_regularise(n, most, job->regular);
    return IMK_OK;
}

static void advise(pose_job *job, imk_pose_advice *advice)
{
    const size_t n = job->n;
    double *trial = job->work + 2 * n * n;
    const double now = imki_plan_log_determinant(n, job->sum, job->regular, job->work);
    double best = -(double)INFINITY;
    size_t chosen = 0;
    for (size_t d = 0; d < DIRECTIONS; d++) {
        for (size_t k = 0; k < n * n; k++)
            trial[k] = job->sum[k] + job->of_direction[d * n * n + k];
        const double value = imki_plan_log_determinant(n, trial, job->regular, job->work);
        if (value > best) {
            best = value;
            chosen = d;
        }
    }
    imki_plan_sigmas(n, job->sum, job->regular, job->work, job->before);
    for (size_t k = 0; k < n * n; k++)
        job->sum[k] += job->of_direction[chosen * n * n + k];
    imki_plan_sigmas(n, job->sum, job->regular, job->work, job->after);
    direction_of(chosen, advice->up);
    imki_plan_attitude(advice->up, &advice->roll, &advice->pitch);
    advice->gain = 0.5 * (best - now);
    advice->improved = -1;
    advice->ratio = 1.0;
    for (size_t p = 0; p < n; p++) {
        const double ratio = isnan(job->after[p])    ? 1.0
                             : isnan(job->before[p]) ? 0.0
                                                     : job->after[p] / job->before[p];
        if (ratio < advice->ratio) {
            advice->ratio = ratio;
            advice->improved = (int)p;
        }
    }
}

imk_status imk_next_pose(const imk_calibration *calibration, double sigma, size_t count,
                         imk_pose_advice *advice, void *workspace, size_t workspace_size,
                         imk_error *error)
{
    if (!calibration || !workspace || (count > 0 && !advice))
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "", NULL, "no null pointer");
    if (!(sigma >= 0.0 && isfinite(sigma)))
        return imk_error_set(error, IMK_ERROR_RANGE, "sigma", NULL, "0 or more m/s^2");
    if (workspace_size < imk_next_pose_workspace_size(calibration))
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "workspace", NULL,
                             "imk_next_pose_workspace_size() bytes");
    const size_t n = calibration->parameter_count;
    const size_t square = (size_t)IMK_CORRELATED_MAX * IMK_CORRELATED_MAX;
    pose_job job = {.n = n};
    char *memory = (char *)imki_align(workspace);
    job.calibration = (imk_calibration *)(void *)memory;
    job.sum = (double *)(void *)(memory + (sizeof(imk_calibration) + LINE) / LINE * LINE);
    /* work: two squares for the criterion, one for a trial; fixed_size() leaves the room by the
     * squares being those of all parameters there can be, and one more for each direction. */
    job.work = job.sum + square;
    job.of_direction = job.work + 3 * n * n;
    job.solver = memory + fixed_size();
    job.solver_size = workspace_size - (size_t)((char *)job.solver - (char *)workspace);
    memset(job.sum, 0, n * n * sizeof(double));
    imk_status status = IMK_OK;
    if (calibration->observation_count > 0)
        status =
            imk_calibration_information(calibration, job.sum, job.solver, job.solver_size, error);
    if (status != IMK_OK)
        return status;
    prepare(&job, calibration, sigma);
    status = look(&job, error);
    for (size_t k = 0; k < count && status == IMK_OK; k++)
        advise(&job, &advice[k]);
    return status;
}
