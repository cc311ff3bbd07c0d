/* SPDX-License-Identifier: Apache-2.0 */
/* A programme that reaches what is required.
 *
 * Procedures with many possible poses take, step by step, the one that adds most to the determinant
 * of the information, as many as show misfits too; the others have a list of steps that is done
 * once. Information of steps is added up for the choice, that of a turn being what a pair of holds
 * tells with it less what both tell without; what is stated in the end is that of the whole. Then
 * the time of a step is searched for, and while the longest is not enough more steps are taken,
 * those that lower sum (sigma/wanted)^2 most. */
#include "imukit/calibration_plan.h"

#include "base/workspace_internal.h"
#include "plan_internal.h"

#include <math.h>
#include <string.h>

enum { SEARCH_STEPS = 14, ADDED_AT_ONCE = 4, STEPS_MOST = 10000 };

/* No candidate. */
static const size_t NONE = SIZE_MAX;

imk_plan_settings imk_plan_default(imk_procedure procedure)
{
    return (imk_plan_settings){.cookie = IMKI_PLAN_COOKIE,
                               .procedure = procedure,
                               .rate = procedure == IMK_PROCEDURE_THERMAL ? 10.0 : 100.0,
                               .lasting = true,
                               .hold_minimum = 2.0,
                               .hold_maximum = 120.0,
                               .margin = 2.0,
                               .turn_time = 2.0,
                               .soak = 600.0,
                               .turn_angle = 6.283185307179586,
                               .steps_maximum = 120,
                               .placement_sigma = imk_procedure_default(procedure).placement_sigma,
                               .temperature_minimum = 253.15,
                               .temperature_maximum = 343.15,
                               .temperature_order = 3,
                               .nonlinear = imk_procedure_default(procedure).nonlinear,
                               .g_sensitivity = true};
}

typedef struct plan_job {
    imki_plan plan;
    const imk_plan_settings *settings;
    size_t n; /* parameters */
    size_t candidates, steps;
    imk_plan_step *candidate;
    imk_plan_step *step;
    double *of_candidate; /* information of a hold, n^2 each */
    double *before;       /* of what is observed already */
    double *sum, *trial, *work;
    double regular[IMK_CORRELATED_MAX], sigma[IMK_CORRELATED_MAX];
    imk_calibration *saved;
    imk_error *error;
} plan_job;

/* ---- memory ------------------------------------------------------------------------------------
 */

static void lay_out(plan_job *job, const imk_plan_settings *settings, imki_parts *a)
{
    const size_t square = (size_t)IMK_CORRELATED_MAX * IMK_CORRELATED_MAX * sizeof(double);
    const size_t samples = settings->steps_maximum * IMKI_PLAN_TURN_SAMPLES + 1;
    job->saved = imki_take(a, sizeof *job->saved);
    job->candidate = imki_take(a, IMKI_PLAN_CANDIDATES_MAX * sizeof *job->candidate);
    job->of_candidate = imki_take(a, IMKI_PLAN_CANDIDATES_MAX * square);
    job->before = imki_take(a, square);
    job->sum = imki_take(a, square);
    job->trial = imki_take(a, square);
    job->work = imki_take(a, 2 * square);
    for (int c = 0; c < 6; c++)
        job->plan.reading[c] = imki_take(a, samples * sizeof(double));
}

/* What the solver needs for the whole programme. */
static size_t solver_size(imk_calibration *c, const imk_plan_settings *settings)
{
    const size_t observations = c->observation_count, turns = c->turn_count;
    const bool chained = settings->procedure == IMK_PROCEDURE_MULTIPOSITION;
    for (size_t k = 0;
         k < settings->steps_maximum && c->observation_count < c->observation_capacity; k++) {
        c->observation[c->observation_count++] =
            (imk_observation){.knowledge = chained ? IMK_INPUT_GRAVITY : IMK_INPUT_PLACED,
                              .placement_sigma = settings->placement_sigma,
                              .fixture = -1};
        if (chained && k > 0 && c->turn_count < c->turn_capacity)
            c->turn[c->turn_count++] = (imk_turn){.from = (int)c->observation_count - 2,
                                                  .to = (int)c->observation_count - 1};
    }
    const size_t parameters = c->parameter_count, fixtures = c->fixture_count;
    c->parameter_count = IMK_CORRELATED_MAX; /* only counted here */
    c->fixture_count = fixtures > 0 ? fixtures : 1;
    const size_t size = imk_calibration_workspace_size(c);
    c->parameter_count = parameters;
    c->fixture_count = fixtures;
    c->observation_count = observations;
    c->turn_count = turns;
    return size;
}

size_t imk_plan_workspace_size(imk_calibration *calibration, const imk_plan_settings *settings)
{
    plan_job unused;
    imki_parts a = imki_parts_of(NULL);
    if (!calibration || !settings || settings->steps_maximum > STEPS_MOST)
        return 0;
    lay_out(&unused, settings, &a);
    return a.used + solver_size(calibration, settings) + IMKI_ALIGNMENT_SLACK;
}

/* ---- information ------------------------------------------------------------------------------
 */

static void add(size_t n, const double *information, double factor, double *sum)
{
    for (size_t k = 0; k < n * n; k++)
        sum[k] += factor * information[k];
}

static const double *of_candidate(const plan_job *job, size_t candidate)
{
    return job->of_candidate + candidate * job->n * job->n;
}

/* What a candidate after another, or NONE, adds: its hold, and the turn between. Into trial. */
static imk_status addition(plan_job *job, size_t last, size_t candidate)
{
    const size_t n = job->n;
    const double hold = job->settings->hold_minimum;
    if (last == NONE || job->settings->procedure != IMK_PROCEDURE_MULTIPOSITION) {
        memcpy(job->trial, of_candidate(job, candidate), n * n * sizeof(double));
        return IMK_OK;
    }
    const imk_plan_step *from = &job->candidate[last];
    imki_plan_clear(&job->plan);
    imki_plan_append(&job->plan, NULL, from, hold);
    imki_plan_append(&job->plan, from, &job->candidate[candidate], hold);
    const imk_status status = imki_plan_information(&job->plan, job->trial, job->error);
    if (status == IMK_OK)
        add(n, of_candidate(job, last), -1.0, job->trial);
    return status;
}

/* Information of every candidate, and the most that is told about each parameter. */
static imk_status look_at_candidates(plan_job *job)
{
    const size_t n = job->n;
    double most[IMK_CORRELATED_MAX] = {0.0};
    imk_status status = IMK_OK;
    for (size_t k = 0; k < job->candidates && status == IMK_OK; k++) {
        imki_plan_clear(&job->plan);
        imki_plan_append(&job->plan, NULL, &job->candidate[k], job->settings->hold_minimum);
        status = imki_plan_information(&job->plan, job->of_candidate + k * n * n, job->error);
        if (status == IMK_OK)
            status = addition(job, k > 0 ? 0 : NONE, k);
        for (size_t p = 0; p < n && status == IMK_OK; p++)
            most[p] = fmax(most[p], fmax(job->trial[p * n + p], job->before[p * n + p]));
    }
    imki_plan_regularise(n, most, job->regular);
    return status;
}

/* Sigmas of the whole programme with this time of a step. */
static imk_status evaluate(plan_job *job, double hold)
{
    imki_plan_clear(&job->plan);
    for (size_t k = 0; k < job->steps; k++)
        imki_plan_append(&job->plan, k > 0 ? &job->step[k - 1] : NULL, &job->step[k], hold);
    const imk_status status = imki_plan_information(&job->plan, job->trial, job->error);
    if (status != IMK_OK)
        return status;
    add(job->n, job->before, 1.0, job->trial);
    imki_plan_sigmas(job->n, job->trial, job->regular, job->work, job->sigma);
    return IMK_OK;
}

/* ---- requirements
 * -----------------------------------------------------------------------------------
 */

static int parameter_of(const plan_job *job, imk_model_parameter wanted)
{
    const imk_calibration *c = job->plan.calibration;
    for (size_t p = 0; p < c->parameter_count; p++)
        if (memcmp(&c->parameter[p], &wanted, sizeof wanted) == 0)
            return (int)p;
    return -1;
}

/* (sigma/what is left for it of what is wanted)^2; 0: nothing can help it. */
static double shortfall(const imk_sigma_requirement *requirement, double sigma)
{
    const double left =
        requirement->sigma * requirement->sigma - requirement->floor * requirement->floor;
    if (!(left > 0.0))
        return 0.0;
    return isnan(sigma) ? (double)INFINITY : sigma * sigma / left;
}

/* The worst requirement of those that can be reached: at most 1 is good. */
static double worst_shortfall(const plan_job *job)
{
    double worst = 0.0;
    for (size_t w = 0; w < job->settings->requirement_count; w++) {
        const imk_sigma_requirement *requirement = &job->settings->requirement[w];
        const int p = parameter_of(job, requirement->parameter);
        worst = fmax(worst, shortfall(requirement, job->sigma[p]));
    }
    return worst;
}

static imk_status check_requirements(plan_job *job)
{
    const imk_plan_settings *s = job->settings;
    for (size_t w = 0; w < s->requirement_count; w++) {
        imk_sigma_requirement *requirement = &s->requirement[w];
        char name[IMK_MODEL_PARAMETER_NAME];
        if (!(requirement->sigma > 0.0 && isfinite(requirement->sigma)))
            return imk_error_set(job->error, IMK_ERROR_RANGE, "requirement", NULL,
                                 "a sigma above 0");
        if (parameter_of(job, requirement->parameter) < 0)
            return imk_error_set(job->error, IMK_ERROR_KEY_MISSING,
                                 imk_model_parameter_name(requirement->parameter, name) == IMK_OK
                                     ? name
                                     : "requirement",
                                 NULL, "a parameter that this procedure estimates");
        requirement->floor = s->lasting
                                 ? sqrt(imki_plan_floor_variance(&job->plan.calibration->model,
                                                                 requirement->parameter))
                                 : 0.0;
    }
    return IMK_OK;
}

static size_t answer_requirements(const plan_job *job)
{
    size_t reached = 0;
    for (size_t w = 0; w < job->settings->requirement_count; w++) {
        imk_sigma_requirement *requirement = &job->settings->requirement[w];
        const double sigma = job->sigma[parameter_of(job, requirement->parameter)];
        requirement->expected = sqrt(sigma * sigma + requirement->floor * requirement->floor);
        requirement->reached = requirement->expected <= 1.0001 * requirement->sigma;
        reached += requirement->reached;
    }
    return reached;
}

/* ---- choosing ---------------------------------------------------------------------------------
 */

/* The larger the better: of the information in trial, everything counted. */
static double score(plan_job *job, bool by_requirements)
{
    const size_t n = job->n;
    if (!by_requirements)
        return imki_plan_log_determinant(n, job->trial, job->regular, job->work);
    double sum = 0.0;
    imki_plan_sigmas(n, job->trial, job->regular, job->work, job->sigma);
    for (size_t w = 0; w < job->settings->requirement_count; w++) {
        const imk_sigma_requirement *requirement = &job->settings->requirement[w];
        sum += shortfall(requirement, job->sigma[parameter_of(job, requirement->parameter)]);
    }
    return -sum;
}

/* Take the best candidate; job->sum holds the information of those taken. */
static imk_status take_best(plan_job *job, size_t *last, bool by_requirements)
{
    double best = -(double)INFINITY;
    size_t chosen = 0;
    for (size_t k = 0; k < job->candidates; k++) {
        if (k == *last)
            continue; /* no turn */
        const imk_status status = addition(job, *last, k);
        if (status != IMK_OK)
            return status;
        add(job->n, job->sum, 1.0, job->trial);
        const double value = score(job, by_requirements);
        if (value > best) {
            best = value;
            chosen = k;
        }
    }
    const imk_status status = addition(job, *last, chosen);
    if (status == IMK_OK)
        add(job->n, job->trial, 1.0, job->sum);
    job->step[job->steps++] = job->candidate[chosen];
    *last = chosen;
    return status;
}

/* More steps: the best few, or the list once more. */
static imk_status take_more(plan_job *job, size_t count, size_t *last, bool by_requirements)
{
    imk_status status = IMK_OK;
    if (imki_plan_is_list(job->settings->procedure)) {
        for (size_t k = 0; k < job->candidates; k++)
            job->step[job->steps++] = job->candidate[k];
        return status;
    }
    for (size_t k = 0; k < count && status == IMK_OK; k++)
        status = take_best(job, last, by_requirements);
    return status;
}

/* Enough to show by their residuals when the model does not fit. */
static size_t steps_needed(const plan_job *job)
{
    if (job->settings->steps_minimum > 0)
        return job->settings->steps_minimum;
    return job->settings->procedure == IMK_PROCEDURE_MULTIPOSITION ? 20 : 18;
}

/* The shortest time that satisfies, the longest if none does. */
static imk_status search_hold(plan_job *job, double *hold)
{
    const imk_plan_settings *s = job->settings;
    double low = s->hold_minimum, high = s->hold_maximum;
    *hold = low;
    imk_status status = evaluate(job, low);
    if (status != IMK_OK || worst_shortfall(job) <= 1.0)
        return status;
    *hold = high;
    status = evaluate(job, high);
    if (status != IMK_OK || worst_shortfall(job) > 1.0)
        return status;
    for (int k = 0; k < SEARCH_STEPS && status == IMK_OK; k++) {
        const double middle = sqrt(low * high);
        status = evaluate(job, middle);
        if (worst_shortfall(job) <= 1.0)
            high = middle;
        else
            low = middle;
    }
    *hold = high;
    return status == IMK_OK ? evaluate(job, high) : status;
}

static imk_status choose(plan_job *job, double *hold)
{
    const imk_plan_settings *s = job->settings;
    const size_t batch = imki_plan_is_list(s->procedure) ? job->candidates : ADDED_AT_ONCE;
    const size_t needed = steps_needed(job);
    size_t last = NONE;
    job->steps = 0;
    memcpy(job->sum, job->before, job->n * job->n * sizeof(double));
    if ((imki_plan_is_list(s->procedure) ? job->candidates : needed) > s->steps_maximum)
        return imk_error_set(job->error, IMK_ERROR_RANGE, "steps_maximum", NULL,
                             "allow as many steps as the procedure needs");
    imk_status status = take_more(job, needed, &last, false);
    if (status == IMK_OK)
        status = search_hold(job, hold);
    while (status == IMK_OK && worst_shortfall(job) > 1.0 &&
           job->steps + batch <= s->steps_maximum) {
        status = take_more(job, batch, &last, true);
        if (status == IMK_OK)
            status = evaluate(job, *hold);
    }
    /* A step more may have been more than enough. */
    return status == IMK_OK ? search_hold(job, hold) : status;
}

/* ---- the whole ----------------------------------------------------------------------------------
 */

static imk_status check_settings(const imk_plan_settings *s, const imk_calibration *c,
                                 imk_error *error)
{
    const struct {
        const char *field;
        bool valid;
    } rules[] = {
        {"procedure",
         (unsigned)s->procedure < IMK_PROCEDURES && s->procedure != IMK_PROCEDURE_MAGNETOMETER},
        {"rate", s->rate > 0.0 && isfinite(s->rate)},
        {"hold_minimum", s->hold_minimum > 0.0 && s->hold_minimum <= s->hold_maximum},
        {"hold_maximum", s->hold_maximum > 0.0 && isfinite(s->hold_maximum)},
        {"margin", s->margin >= 0.0 && isfinite(s->margin)},
        {"turn_time", s->turn_time > 0.0 && isfinite(s->turn_time)},
        {"steps_maximum", s->steps_maximum >= 1 && s->steps_maximum <= STEPS_MOST},
        {"steps_minimum", s->steps_minimum <= s->steps_maximum},
        {"soak", s->soak >= 0.0 && isfinite(s->soak)},
        {"placement_sigma", s->placement_sigma >= 0.0 && isfinite(s->placement_sigma)},
        {"fixture_sigma", s->fixture_sigma >= 0.0 && isfinite(s->fixture_sigma)},
        {"turn_angle", s->turn_angle != 0.0 && isfinite(s->turn_angle)},
        {"rate_limit", s->rate_limit >= 0.0 && isfinite(s->rate_limit)},
        {"force_limit", s->force_limit >= 0.0 && isfinite(s->force_limit)},
        {"temperature_minimum",
         s->temperature_minimum > 0.0 && s->temperature_minimum < s->temperature_maximum},
        {"temperature_maximum", isfinite(s->temperature_maximum)},
        {"temperature_order",
         s->temperature_order >= 1 && s->temperature_order <= IMK_TEMPERATURE_ORDER_MAX},
        {"requirement", s->requirement_count == 0 || s->requirement},
    };
    if (s->cookie != IMKI_PLAN_COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "plan_settings", NULL,
                             "start from imk_plan_default()");
    for (size_t i = 0; i < sizeof rules / sizeof *rules; i++)
        if (!rules[i].valid)
            return imk_error_set(error, IMK_ERROR_RANGE, rules[i].field, NULL,
                                 "see calibration_plan.h");
    const bool turns = s->procedure == IMK_PROCEDURE_MULTIPOSITION;
    if (c->observation_capacity - c->observation_count < s->steps_maximum ||
        (turns && c->turn_capacity - c->turn_count < s->steps_maximum))
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "observation", NULL,
                             "provide room for steps_maximum observations and turns");
    return IMK_OK;
}

/* Means that are known exactly make no programme. */
static imk_status check_noise(const imk_model *model, imk_error *error)
{
    const imk_triad *triads[2] = {&model->gyro, &model->accel};
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; triads[sensor]->present && i < triads[sensor]->axis_count; i++)
            if (!(imki_plan_mean_variance(triads[sensor], i, 0.01, 1.0) > 0.0)) {
                imk_error_set(error, IMK_ERROR_KEY_MISSING,
                              sensor == IMK_GYRO ? "gyro.noise" : "accel.noise", NULL,
                              "state the noise of every axis, such as angle_random_walk");
                if (error)
                    error->index = i;
                return IMK_ERROR_KEY_MISSING;
            }
    return IMK_OK;
}

/* Polynomials that a thermal test is to find must be there to be free. */
static void prepare_temperature(imk_model *model, const imk_plan_settings *s)
{
    imk_triad *triads[2] = {&model->gyro, &model->accel};
    for (int sensor = 0; sensor < 2; sensor++) {
        imk_temperature_polynomial *t = &triads[sensor]->bias.temperature;
        if (t->order < s->temperature_order) {
            t->order = s->temperature_order;
            t->reference = 298.15;
            t->minimum = s->temperature_minimum;
            t->maximum = s->temperature_maximum;
        }
    }
}

static imk_status plan(plan_job *job, double *hold)
{
    imk_calibration *c = job->plan.calibration;
    const imk_plan_settings *s = job->settings;
    if (s->procedure == IMK_PROCEDURE_THERMAL)
        prepare_temperature(&c->model, s);
    imk_status status = imki_plan_free(s, c, job->error);
    job->n = c->parameter_count;
    memset(job->before, 0, job->n * job->n * sizeof(double));
    if (status == IMK_OK && c->observation_count > 0)
        status = imk_calibration_information(c, job->before, job->plan.solver,
                                             job->plan.solver_size, job->error);
    if (status != IMK_OK)
        return status;
    /* From here the calibration is about the programme alone. */
    for (size_t p = 0; p < job->n; p++)
        c->prior_sigma[p] = 0.0;
    c->observation += c->observation_count;
    c->turn += c->turn_count;
    c->record[0] = &job->plan.record;
    c->record_count = 1;
    c->fixture_count = imki_plan_has_fixture(s);
    c->fixture_sigma[0] = imki_plan_fixture(s);
    for (int sensor = 0; sensor < 2; sensor++) {
        const imk_triad *triad = imk_model_triad(&c->model, sensor);
        job->plan.record.axis_count[sensor] = triad->present && triad->axis_count == 3 ? 3 : 0;
        for (int i = 0; i < 3; i++)
            job->plan.record.reading[sensor][i] = job->plan.reading[3 * sensor + i];
    }
    job->candidates = imki_plan_candidates(s, &c->model, c->gravity, job->candidate);
    status = check_requirements(job);
    if (status == IMK_OK)
        status = look_at_candidates(job);
    return status == IMK_OK ? choose(job, hold) : status;
}

static void fill_result(const plan_job *job, double hold, imk_plan_result *result)
{
    const imk_calibration *c = job->plan.calibration;
    const imk_plan_settings *s = job->settings;
    static const double level[3] = {0.0, 0.0, 0.0};
    *result = (imk_plan_result){
        .step_count = job->steps, .hold = hold, .parameter_count = c->parameter_count};
    for (size_t k = 0; k < job->steps; k++) {
        imk_plan_step *step = &job->step[k];
        step->duration = imki_plan_measured(s, step, hold);
        result->duration +=
            step->duration + s->margin +
            imki_plan_turn_time(s, &c->model, k > 0 ? step[-1].angle : level, step->angle);
        if (step->action == IMK_PLAN_SOAK)
            result->duration += s->soak;
    }
    for (size_t p = 0; p < c->parameter_count; p++) {
        result->parameter[p] = c->parameter[p];
        result->sigma[p] = job->sigma[p];
    }
    result->reached = answer_requirements(job);
}

imk_status imk_plan_make(imk_calibration *calibration, const imk_plan_settings *settings,
                         imk_plan_step *step, imk_plan_result *result, void *workspace,
                         size_t workspace_size, imk_error *error)
{
    if (!calibration || !settings || !workspace || !step || !result)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "", NULL, "no null pointer");
    imk_status status = check_settings(settings, calibration, error);
    if (status == IMK_OK)
        status = check_noise(&calibration->model, error);
    if (status == IMK_OK && workspace_size < imk_plan_workspace_size(calibration, settings))
        status = imk_error_set(error, IMK_ERROR_WORKSPACE, "workspace", NULL,
                               "imk_plan_workspace_size() bytes");
    if (status != IMK_OK)
        return status;
    plan_job job = {.settings = settings, .step = step, .error = error};
    imki_parts a = imki_parts_of(workspace);
    lay_out(&job, settings, &a);
    job.plan.settings = settings;
    job.plan.calibration = calibration;
    /* Turns of about two seconds in so many samples; only rate times interval matters. */
    job.plan.record =
        (imk_test_record){.name = "programme", .dt = settings->turn_time / IMKI_PLAN_TURN_SAMPLES};
    job.plan.solver = a.memory + a.used;
    job.plan.solver_size = workspace_size - (size_t)((char *)job.plan.solver - (char *)workspace);
    *job.saved = *calibration;
    double hold = settings->hold_minimum;
    status = plan(&job, &hold);
    if (status == IMK_OK)
        fill_result(&job, hold, result);
    *calibration = *job.saved;
    return status;
}
