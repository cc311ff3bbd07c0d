/* SPDX-License-Identifier: Apache-2.0 */
/* From sums over windows to the answers: data sheet, ten times that, fit and safe, the last two
 * also with scale factors in the filter. */
#include "tuning_internal.h"

#include "imukit/filter_noise.h"

#include <math.h>
#include <string.h>

/* ---- numbers and variances ---- */

/* Variance of a kind of basis. */
static double variance_of(const imk_filter_parameters *p, int kind, int sensor, int axis)
{
    const double value = kind == IMKI_BASIS_WHITE  ? p->white[sensor][axis]
                         : kind == IMKI_BASIS_WALK ? p->walk[sensor][axis]
                         : kind == IMKI_BASIS_BIAS ? p->bias_sigma[sensor]
                                                   : p->scale_factor[sensor][axis];
    return value * value;
}

static double *number_of(imk_filter_parameters *p, int kind, int sensor, int axis)
{
    return kind == IMKI_BASIS_WHITE ? &p->white[sensor][axis] : &p->walk[sensor][axis];
}

/* P_m in the mean over the windows. */
static void model_of(const imki_tuning_totals *totals, const imk_filter_parameters *parameters,
                     size_t time, double p[9][9])
{
    memset(p, 0, 81 * sizeof(double));
    for (int kind = 0; kind < IMKI_KINDS_OF_BASIS; kind++)
        for (int j = 0; j < 6; j++) {
            const double variance = variance_of(parameters, kind, j / 3, j % 3);
            double(*m)[9] =
                totals->basis[(size_t)imki_basis(kind, j / 3, j % 3) * totals->times + time];
            for (int i = 0; i < 9; i++)
                for (int k = 0; k < 9; k++)
                    p[i][k] += variance * m[i][k];
        }
}

/* P_m of one window. */
static void model_of_window(const imki_tuning_totals *totals,
                            const imk_filter_parameters *parameters, size_t window, size_t time,
                            double p[9][9])
{
    double packed[IMKI_PACKED] = {0.0};
    for (int kind = 0; kind < IMKI_KINDS_OF_BASIS; kind++)
        for (int j = 0; j < 6; j += totals->per_axis ? 1 : 3) {
            const double variance = variance_of(parameters, kind, j / 3, j % 3);
            const size_t base = imki_kept_basis(totals->per_axis, kind, j / 3, j % 3);
            const double *m =
                totals->window_basis[(window * totals->bases + base) * totals->times + time];
            for (int i = 0; i < IMKI_PACKED; i++)
                packed[i] += variance * m[i];
        }
    imki_unpack(packed, p);
}

static double beyond(const imki_tuning_totals *totals, const imk_filter_parameters *parameters,
                     size_t time)
{
    double sum = 0.0;
    for (size_t w = 0; w < totals->windows; w++) {
        double p[9][9], covariance[9][9];
        model_of_window(totals, parameters, w, time, p);
        imki_unpack(totals->window_total[w * totals->times + time], covariance);
        sum += imki_tuning_beyond((const double(*)[9])p, (const double(*)[9])covariance,
                                  totals->window_shift[w * totals->times + time]);
    }
    return sum / (double)totals->windows;
}

/* N or K that makes nowhere a hundred-thousandth of P_m. */
static bool is_unused(const imki_tuning_totals *totals, const imk_filter_answer *answer, int kind,
                      int sensor)
{
    for (size_t t = 0; t < totals->times; t++) {
        double share = 0.0;
        for (int axis = 0; axis < 3; axis++) {
            const size_t at = (size_t)imki_basis(kind, sensor, axis) * totals->times + t;
            share +=
                variance_of(&answer->parameters, kind, sensor, axis) *
                imki_tuning_trace(answer->covariance[t], (const double(*)[9])totals->basis[at]);
        }
        if (share > 9e-5)
            return false;
    }
    return true;
}

static void fill_answer(const imki_tuning_totals *totals, const imki_tuning_arrays *arrays,
                        imk_filter_answer_kind kind, const imk_filter_parameters *parameters,
                        imk_filter_answer *answer)
{
    const size_t times = totals->times, at = (size_t)kind * times;
    imk_filter_consistency *consistency = arrays->consistency + at;
    double(*covariance)[9][9] = arrays->covariance + at;
    double *share = arrays->share + at * totals->sources;
    *answer = (imk_filter_answer){.found = true, .parameters = *parameters};
    for (size_t t = 0; t < times; t++) {
        model_of(totals, parameters, t, covariance[t]);
        const double(*p)[9] = (const double(*)[9])covariance[t];
        if (!imki_tuning_compare(p, (const double(*)[9])totals->truth[t], &consistency[t])) {
            *answer = (imk_filter_answer){.found = false};
            return;
        }
        consistency[t].beyond = beyond(totals, parameters, t);
        answer->mean_nees += consistency[t].nees / (double)times;
        for (size_t s = 0; s < totals->sources; s++)
            share[s * times + t] =
                imki_tuning_trace(p, (const double(*)[9])totals->source[s * times + t]) /
                (9.0 * consistency[t].nees);
    }
    answer->consistency = consistency;
    answer->covariance = (const double(*)[9][9])covariance;
    answer->share = share;
    for (int sensor = 0; sensor < 2; sensor++) {
        answer->unused[sensor][0] = is_unused(totals, answer, IMKI_BASIS_WHITE, sensor);
        answer->unused[sensor][1] = is_unused(totals, answer, IMKI_BASIS_WALK, sensor);
    }
}

/* ---- what the model states ---- */

static void stated(const imk_model *model, imk_filter_parameters *p)
{
    const imk_filter_noise_settings settings = imk_filter_noise_default();
    for (int sensor = 0; sensor < 2; sensor++) {
        double white = 0.0, walk = 0.0;
        for (int axis = 0; axis < 3; axis++) {
            imk_filter_noise noise;
            if (imk_filter_noise_of(imk_model_triad(model, sensor), axis, &settings, &noise,
                                    NULL) != IMK_OK)
                continue;
            white += noise.white * noise.white / 3.0;
            for (int i = 0; i < noise.state_count; i++)
                walk += noise.state[i].driving * noise.state[i].driving / 3.0;
        }
        for (int axis = 0; axis < 3; axis++) {
            p->white[sensor][axis] = sqrt(white);
            p->walk[sensor][axis] = sqrt(walk);
        }
    }
}

/* Scale factors of a filter that estimates them: what the model states of them. @return false:
 * nothing */
static bool stated_scales(const imk_model *model, bool compensated, bool per_axis,
                          double sigma[2][3])
{
    bool any = false;
    for (int sensor = 0; sensor < 2; sensor++) {
        const imk_scale_factor *s = &imk_model_triad(model, sensor)->scale_factor;
        double square[3], mean = 0.0;
        for (int i = 0; i < 3; i++) {
            const double known = compensated ? s->fixed.sigma[i] : s->fixed.value[i];
            square[i] = known * known + s->repeatability.value[i] * s->repeatability.value[i];
            mean += square[i] / 3.0;
        }
        for (int i = 0; i < 3; i++)
            sigma[sensor][i] = sqrt(per_axis ? square[i] : mean);
        any = any || mean > 0.0;
    }
    return any;
}

/* ---- fitting ---- */

/* The parameters of a problem: which basis, of which sensor and axis (-1: of all three). */
typedef struct parameter {
    int kind, sensor, axis;
} parameter;

static int list_parameters(bool per_axis, parameter list[IMKI_PARAMETERS_MAX])
{
    static const int kinds[2] = {IMKI_BASIS_WHITE, IMKI_BASIS_WALK};
    int count = 0;
    for (int k = 0; k < 2; k++)
        for (int sensor = 0; sensor < 2; sensor++)
            for (int axis = 0; axis < (per_axis ? 3 : 1); axis++)
                list[count++] = (parameter){kinds[k], sensor, per_axis ? axis : -1};
    return count;
}

static void fill_problem(const imki_tuning_totals *totals, const imk_filter_parameters *fixed,
                         const parameter *list, imki_tuning_problem *problem)
{
    for (size_t t = 0; t < totals->times; t++) {
        model_of(totals, fixed, t, problem->fixed[t]);
        for (int k = 0; k < problem->parameters; k++) {
            double(*m)[9] = problem->basis[(size_t)k * totals->times + t];
            memset(m, 0, 81 * sizeof(double));
            for (int axis = 0; axis < 3; axis++) {
                const double(*of_axis)[9] =
                    (const double(*)[9])
                        totals->basis[(size_t)imki_basis(list[k].kind, list[k].sensor, axis) *
                                          totals->times +
                                      t];
                for (int i = 0; i < 81 && (list[k].axis < 0 || list[k].axis == axis); i++)
                    m[i / 9][i % 9] += of_axis[i / 9][i % 9];
            }
        }
    }
}

/* Variance that gives a basis alone the truth's trace in its block, attitude or velocity. */
static double alone(const imki_tuning_problem *problem, int k, int sensor, size_t time)
{
    double truth = 0.0, model = 0.0;
    for (int i = 3 * sensor; i < 3 * sensor + 3; i++) {
        truth += problem->truth[time][i][i];
        model += problem->basis[(size_t)k * problem->times + time][i][i];
    }
    return model > 0.0 && truth > 0.0 ? truth / model : 1e-30;
}

/* White noise from the shortest time; the others small, or from the longest time. */
static void start_at(const imki_tuning_problem *problem, const parameter *list, double part,
                     double *theta)
{
    for (int k = 0; k < problem->parameters; k++)
        theta[k] = list[k].kind == IMKI_BASIS_WHITE
                       ? alone(problem, k, list[k].sensor, 0)
                       : part * alone(problem, k, list[k].sensor, problem->times - 1);
}

static bool fit(const imki_tuning_problem *problem, const parameter *list, double *theta)
{
    static const double parts[3] = {1e-4, 1e-2, 1.0};
    double least = (double)INFINITY;
    for (int start = 0; start < 3; start++) {
        double trial[IMKI_PARAMETERS_MAX];
        start_at(problem, list, parts[start], trial);
        const bool found = imki_tuning_fit(problem, trial);
        const double value = found ? imki_tuning_likelihood(problem, trial) : (double)INFINITY;
        if (value < least) {
            least = value;
            memcpy(theta, trial, sizeof trial);
        }
    }
    return isfinite(least);
}

static void take_theta(const imki_tuning_problem *problem, const parameter *list,
                       const double *theta, imk_filter_parameters *p)
{
    for (int k = 0; k < problem->parameters; k++)
        for (int axis = 0; axis < 3; axis++)
            if (list[k].axis < 0 || list[k].axis == axis)
                *number_of(p, list[k].kind, list[k].sensor, axis) = sqrt(theta[k]);
}

/* Variance of the white noise or the random walk that the sensor itself has, B not counted. */
static double own_variance(const imk_model *model, const parameter *of)
{
    const imk_noise *noise = &imk_model_triad(model, of->sensor)->noise;
    const double *value =
        of->kind == IMKI_BASIS_WHITE ? noise->white.value : noise->random_walk.value;
    if (of->axis >= 0)
        return value[of->axis] * value[of->axis];
    return (value[0] * value[0] + value[1] * value[1] + value[2] * value[2]) / 3.0;
}

/* Fit and safe of one kind of filter. */
static bool solve(const imki_tuning_totals *totals, const imki_tuning_arrays *arrays,
                  const imk_filter_tuning_settings *settings, const imk_model *model, bool scaled,
                  imk_filter_tuning *tuning)
{
    parameter list[IMKI_PARAMETERS_MAX];
    double theta[IMKI_PARAMETERS_MAX], safe[IMKI_PARAMETERS_MAX];
    imki_tuning_problem problem = {.times = totals->times,
                                   .parameters = list_parameters(totals->per_axis, list),
                                   .truth = (const double(*)[9][9])totals->truth,
                                   .fixed = arrays->fixed,
                                   .basis = arrays->basis,
                                   .limit = settings->eigen_limit};
    imk_filter_parameters fixed = {.bias_sigma = {tuning->bias_sigma[0], tuning->bias_sigma[1]},
                                   .correlation_time = settings->correlation_time};
    const imk_filter_answer_kind kind = scaled ? IMK_FILTER_FIT_SCALED : IMK_FILTER_FIT;
    if (scaled &&
        !stated_scales(model, settings->compensated, totals->per_axis, fixed.scale_factor))
        return false;
    fill_problem(totals, &fixed, list, &problem);
    if (!fit(&problem, list, theta))
        return false;
    imk_filter_parameters parameters = fixed;
    take_theta(&problem, list, theta, &parameters);
    fill_answer(totals, arrays, kind, &parameters, &tuning->answer[kind]);
    if (!(tuning->answer[kind].mean_nees > 1e-3)) /* no errors: the fit follows them to nothing */
        return false;
    for (int k = 0; k < problem.parameters; k++)
        problem.floor[k] = own_variance(model, &list[k]);
    if (!imki_tuning_safe(&problem, theta, safe))
        return false;
    take_theta(&problem, list, safe, &parameters);
    fill_answer(totals, arrays, kind + 1, &parameters, &tuning->answer[kind + 1]);
    return tuning->answer[kind].found && tuning->answer[kind + 1].found;
}

/* Where a fit by constant noise is farthest from consistent, and what it is that grows otherwise:
 * the largest error where there is most. */
static void find_worst(const imki_tuning_totals *totals, imk_filter_tuning *tuning)
{
    const imk_filter_answer *answer = &tuning->answer[IMK_FILTER_FIT];
    double most = 0.0, high = 0.0;
    size_t highest = 0;
    for (size_t t = 0; t < totals->times; t++) {
        const double nees = answer->consistency[t].nees, away = fmax(nees, 1.0 / nees);
        if (nees > high) {
            high = nees;
            highest = t;
        }
        tuning->inconstant = tuning->inconstant || away > 2.0;
        if (away > most) {
            most = away;
            tuning->worst_time = t;
        }
    }
    for (size_t s = 0; s < totals->sources; s++)
        if (answer->share[s * totals->times + highest] >
            answer->share[tuning->worst_source * totals->times + highest])
            tuning->worst_source = s;
}

bool imki_tuning_answers(const imki_tuning_totals *totals, const imki_tuning_arrays *arrays,
                         const imk_model *model, const imk_filter_tuning_settings *settings,
                         imk_filter_tuning *tuning)
{
    imk_filter_parameters p = {.bias_sigma = {tuning->bias_sigma[0], tuning->bias_sigma[1]},
                               .correlation_time = settings->correlation_time};
    stated(model, &p);
    fill_answer(totals, arrays, IMK_FILTER_STATED, &p, &tuning->answer[IMK_FILTER_STATED]);
    for (int j = 0; j < 6; j++) {
        p.white[j / 3][j % 3] *= 10.0;
        p.walk[j / 3][j % 3] *= 10.0;
    }
    fill_answer(totals, arrays, IMK_FILTER_TENFOLD, &p, &tuning->answer[IMK_FILTER_TENFOLD]);
    if (!solve(totals, arrays, settings, model, false, tuning))
        return false;
    find_worst(totals, tuning);
    (void)solve(totals, arrays, settings, model, true, tuning);
    return true;
}
