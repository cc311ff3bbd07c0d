/* SPDX-License-Identifier: Apache-2.0 */
/* Noise model from a table of Allan variances: which terms are there, how strong, how sure. */
#include "allan_fit_internal.h"
#include "base/workspace_internal.h"
#include "imukit/distributions.h"

#include <math.h>
#include <string.h>

enum { COOKIE = 0x0A11F170 };

imk_allan_fit_settings imk_allan_fit_default(void)
{
    return (imk_allan_fit_settings){.cookie = COOKIE,
                                    .confidence = 0.95,
                                    .significance = 0.01,
                                    .trim = true,
                                    .term = {true, true, true, true, true}};
}

static size_t capacity(const imk_allan_fit_settings *settings)
{
    size_t count = (size_t)settings->sinusoid_count;
    count += (size_t)settings->resonance_count;
    count += (size_t)settings->gauss_markov_max;
    for (int i = 0; i < IMK_NOISE_TERMS; i++)
        count += settings->term[i] || settings->keep[i];
    return count;
}

static imk_status settings_check(const imk_allan_fit_settings *settings)
{
    if (settings->cookie != COOKIE)
        return IMK_ERROR_UNINITIALISED;
    const int counts[3] = {settings->sinusoid_count, settings->resonance_count,
                           settings->gauss_markov_max};
    for (int i = 0; i < 3; i++)
        if (counts[i] < 0 || counts[i] > IMK_TERMS_MAX)
            return IMK_ERROR_RANGE;
    if (!(settings->confidence > 0 && settings->confidence < 1) ||
        !(settings->significance > 0 && settings->significance < 0.5))
        return IMK_ERROR_RANGE;
    for (int i = 0; i < settings->sinusoid_count; i++)
        if (!(settings->sinusoid[i].frequency > 0) || !isfinite(settings->sinusoid[i].frequency))
            return IMK_ERROR_RANGE;
    for (int i = 0; i < settings->resonance_count; i++)
        if (!(settings->resonance[i].frequency > 0) || !(settings->resonance[i].q > 0.5) ||
            !isfinite(settings->resonance[i].frequency) || !isfinite(settings->resonance[i].q))
            return IMK_ERROR_RANGE;
    if (!(settings->tolerance >= 0 && settings->tolerance <= 0.5))
        return IMK_ERROR_RANGE;
    if (!(settings->filter.bandwidth >= 0) || !(settings->filter.damping >= 0))
        return IMK_ERROR_RANGE;
    return IMK_OK;
}

size_t imk_allan_fit_workspace_size(const imk_allan_fit_settings *settings, size_t count,
                                    size_t draws)
{
    const size_t terms = capacity(settings);
    const size_t solution = count * (count + terms + 1) + 2 * terms * terms;
    const size_t bootstrap = draws > 0 ? count * count + draws * IMK_NOISE_TERMS : 0;
    return sizeof(imki_allan_work) + imki_allan_problem_size(count, terms) +
           (solution + bootstrap) * sizeof(double) + IMKI_ALIGNMENT_SLACK;
}

imk_status imki_allan_fit_start(const imk_allan_fit_settings *settings,
                                const imk_allan_table *table, void *workspace,
                                size_t workspace_size, imki_allan_work **work)
{
    imk_status status = settings_check(settings);
    if (status == IMK_OK)
        status = imki_allan_table_check(table);
    if (status != IMK_OK)
        return status;
    for (size_t i = 0; table->variances && i < table->count; i++)
        if (!isfinite(table->variances[i]))
            return IMK_ERROR_NOT_FINITE;
        else if (!(table->variances[i] > 0))
            return IMK_ERROR_RANGE;
    if (!table->variances)
        return IMK_ERROR_ARGUMENT;
    if (workspace_size < imk_allan_fit_workspace_size(settings, table->count, 0))
        return IMK_ERROR_WORKSPACE;
    imki_allan_work *w = (void *)imki_align(workspace);
    imki_allan_problem *problem = &w->problem;
    double *memory = (double *)(void *)(w + 1);
    const size_t count = table->count, terms = capacity(settings);
    memset(w, 0, sizeof *w);
    problem->table = table;
    problem->variances = table->variances;
    imki_allan_problem_lay(problem, count, terms, memory);
    problem->matrix = memory + imki_allan_problem_size(count, terms) / sizeof(double);
    problem->white = problem->matrix + count * count;
    problem->scaled = problem->white + count * (terms + 1);
    problem->factor = problem->scaled + terms * terms;
    w->rest = problem->factor + terms * terms;
    problem->tolerance = settings->tolerance;
    problem->noise.filter = settings->filter;
    problem->noise.sinusoid_count = settings->sinusoid_count;
    problem->noise.resonance_count = settings->resonance_count;
    memcpy(problem->noise.sinusoid, settings->sinusoid, sizeof settings->sinusoid);
    memcpy(problem->noise.resonance, settings->resonance, sizeof settings->resonance);
    bool use[IMK_NOISE_TERMS];
    for (int i = 0; i < IMK_NOISE_TERMS; i++)
        use[i] = settings->term[i] || settings->keep[i];
    imki_allan_problem_terms(problem, use);
    imki_allan_sums(problem, 0, false);
    *work = w;
    return IMK_OK;
}

static int degrees_of(const imki_allan_problem *problem, const imki_allan_state *state)
{
    int degrees = (int)(problem->table->count - problem->first);
    for (size_t t = 0; t < problem->terms; t++)
        if (state->active[t])
            degrees -= problem->term[t].kind == IMKI_LAG_DECAY ? 2 : 1;
    return degrees;
}

static double probability(const imki_allan_problem *problem, const imki_allan_state *state)
{
    const int degrees = degrees_of(problem, state);
    return degrees > 0 ? imk_gamma_upper(0.5 * degrees, 0.5 * fmax(0, state->chi_square))
                       : (double)NAN;
}

/* Leave out shortest tau until the rest is explained. One that the model misses by many times its
 * standard deviation does not only fail itself: the correlations carry it to all others. */
static void trim(imki_allan_work *w)
{
    imki_allan_problem *problem = &w->problem;
    imki_allan_state *state = &w->state;
    w->other = *state;
    const size_t half = problem->table->count / 2;
    /* Chance alone comes near the first limit in no record; what is left must look ordinary. */
    double limit = 1e-6;
    while (problem->first <= half && !(probability(problem, state) >= limit)) {
        limit = 0.01;
        problem->first++;
        imki_allan_solve(problem, state, IMKI_ALLAN_NONE, 0);
        if (problem->first > half || degrees_of(problem, state) < 1 || state->status != IMK_OK) {
            problem->first = 0;
            *state = w->other;
            return;
        }
    }
}

/* Place of one of the five terms in the problem; IMKI_ALLAN_NONE when it is no candidate. */
static int place_of(const imki_allan_problem *problem, int term)
{
    static const imki_lag_kind kinds[IMK_NOISE_TERMS] = {
        IMKI_LAG_DELTA, IMKI_LAG_LINEAR, IMKI_LAG_LOGARITHM, IMKI_LAG_CUBIC, IMKI_LAG_RAMP};
    for (size_t j = 0; j < problem->terms; j++)
        if (problem->term[j].kind == kinds[term] ||
            (term == IMK_NOISE_WHITE && problem->term[j].kind == IMKI_LAG_FILTERED))
            return (int)j;
    return IMKI_ALLAN_NONE;
}

static bool kept(const imk_allan_fit_settings *settings, const imki_allan_problem *problem,
                 size_t term)
{
    return problem->term[term].kind == IMKI_LAG_DECAY ||
           (problem->term[term].kind != IMKI_LAG_RINGING &&
            problem->term[term].kind != IMKI_LAG_SINUSOID && settings->keep[problem->origin[term]]);
}

/* Backward elimination: the term that costs least goes, until each costs more than chance would. */
static void choose(const imk_allan_fit_settings *settings, const imki_allan_problem *problem,
                   imki_allan_state *state, double needed)
{
    for (;;) {
        size_t weakest = problem->terms;
        double least = needed;
        for (size_t t = 0; t < problem->terms; t++)
            if (state->active[t] && !kept(settings, problem, t)) {
                const double cost = imki_allan_deviance(problem, state, (int)t, 0);
                if (cost < least) {
                    least = cost;
                    weakest = t;
                }
            }
        if (weakest == problem->terms)
            return;
        state->active[weakest] = false;
        state->amount[weakest] = 0;
        imki_allan_solve(problem, state, IMKI_ALLAN_NONE, 0);
    }
}

/* A ramp, which has a sign, is added by a two-sided test at a tenth of the significance, as
 * elsewhere: in one record it and a random walk look much alike. */
static void choose_ramp(const imk_allan_fit_settings *settings, imki_allan_work *w, double needed)
{
    const imki_allan_problem *problem = &w->problem;
    imki_allan_state *state = &w->state, *with = &w->other;
    const int ramp = place_of(problem, IMK_NOISE_RAMP);
    if (ramp == IMKI_ALLAN_NONE)
        return;
    *with = *state;
    with->active[ramp] = true;
    imki_allan_solve(problem, with, IMKI_ALLAN_NONE, 0);
    const double enough = imk_chi_square_quantile(1 - 0.1 * settings->significance, 1);
    if (settings->keep[IMK_NOISE_RAMP] || (with->status == IMK_OK && with->amount[ramp] > 0 &&
                                           imki_allan_deviance(problem, with, ramp, 0) > enough)) {
        *state = *with;
        choose(settings, problem, state, needed);
    }
}

/* Bartlett's factor of a likelihood ratio, as in identify_intervals.c. */
static double small_sample_factor(double amount, double sd)
{
    const double degrees = 2 * (amount / sd) * (amount / sd);
    return 1 + 1 / (3 * (degrees > 2 ? degrees : 2));
}

/* Value, sigma and profile interval of one term, in the model in which white noise, bias
 * instability, random walk and the term itself are free. */
static void store_estimate(const imki_allan_problem *problem, const imki_allan_state *state,
                           size_t term, double drop, imk_estimate *e)
{
    const size_t terms = problem->terms;
    double covariance[IMKI_ALLAN_TERMS * IMKI_ALLAN_TERMS];
    imki_allan_spread(problem, state, covariance);
    e->present = state->active[term] && state->amount[term] > 0;
    e->value = e->present ? sqrt(state->amount[term]) : 0;
    e->sigma = e->present ? sqrt(covariance[term * terms + term]) / (2 * e->value) : 0;
    imki_allan_state free_state = *state;
    for (int i = IMK_NOISE_WHITE; i <= IMK_NOISE_RANDOM_WALK; i++)
        if (place_of(problem, i) != IMKI_ALLAN_NONE)
            free_state.active[place_of(problem, i)] = true;
    free_state.active[term] = true;
    imki_allan_solve(problem, &free_state, IMKI_ALLAN_NONE, 0);
    imki_allan_spread(problem, &free_state, covariance);
    const double amount = free_state.amount[term], sd = sqrt(covariance[term * terms + term]);
    const double centre = sqrt(amount), step = sqrt(amount + sd) - centre;
    drop *= small_sample_factor(amount, sd);
    e->free_value = centre;
    e->upper = imki_allan_profile_end(problem, &free_state, (int)term, step, drop);
    e->lower =
        e->present ? imki_allan_profile_end(problem, &free_state, (int)term, -step, drop) : 0;
}

static void store_correlation(const imki_allan_problem *problem, const imki_allan_state *state,
                              imk_allan_fit *fit)
{
    const size_t terms = problem->terms;
    double covariance[IMKI_ALLAN_TERMS * IMKI_ALLAN_TERMS];
    imki_allan_spread(problem, state, covariance);
    for (int i = 0; i < IMK_NOISE_TERMS; i++)
        for (int j = 0; j < IMK_NOISE_TERMS; j++) {
            const int a = place_of(problem, i), b = place_of(problem, j);
            fit->correlation[i][j] = i == j;
            if (a == IMKI_ALLAN_NONE || b == IMKI_ALLAN_NONE || i == j)
                continue;
            const double product = covariance[(size_t)a * terms + (size_t)a] *
                                   covariance[(size_t)b * terms + (size_t)b];
            if (product > 0)
                fit->correlation[i][j] = covariance[(size_t)a * terms + (size_t)b] / sqrt(product);
        }
}

static void store_agreement(const imki_allan_problem *problem, const imki_allan_state *state,
                            imk_allan_fit *fit)
{
    const imk_allan_table *table = problem->table;
    imki_allan_matrix(problem, state->amount, problem->matrix);
    fit->noise = problem->noise;
    for (size_t t = 0; t < problem->terms; t++)
        imki_allan_store_amount(problem, t, state->active[t] ? state->amount[t] : 0, &fit->noise);
    for (size_t i = 0; i < table->count; i++) {
        fit->expected[i] = imk_allan_noise_variance(&fit->noise, table->dt, table->factors[i]);
        fit->sigma[i] = sqrt(problem->matrix[i * table->count + i]);
    }
    fit->chi_square = state->chi_square;
    fit->first = problem->first;
    fit->degrees = degrees_of(problem, state);
    fit->probability = probability(problem, state);
}

static void store_terms(imki_allan_problem *problem, const imki_allan_state *state, double drop,
                        imk_allan_fit *fit)
{
    for (size_t t = 0; t < problem->terms; t++) {
        const int i = problem->origin[t];
        switch (problem->term[t].kind) {
        case IMKI_LAG_DECAY:
            store_estimate(problem, state, t, drop, &fit->gauss_markov[i].sigma);
            break;
        case IMKI_LAG_RINGING:
            store_estimate(problem, state, t, drop, &fit->resonance[i]);
            break;
        case IMKI_LAG_SINUSOID:
            store_estimate(problem, state, t, drop, &fit->sinusoid[i]);
            break;
        default:
            store_estimate(problem, state, t, drop, &fit->term[i]);
        }
    }
    fit->gauss_markov_count = problem->noise.gauss_markov_count;
    for (size_t t = 0; t < problem->terms; t++) {
        if (problem->term[t].kind != IMKI_LAG_DECAY)
            continue;
        const int i = problem->origin[t];
        imk_estimate *time = &fit->gauss_markov[i].correlation_time;
        time->present = true;
        time->value = time->free_value = problem->noise.gauss_markov[i].correlation_time;
        time->lower = imki_allan_time_end(problem, state, t, -1, drop);
        time->upper = imki_allan_time_end(problem, state, t, 1, drop);
        time->sigma = (time->upper - time->lower) / (2 * sqrt(drop));
    }
}

imk_status imk_allan_fit_table(const imk_allan_fit_settings *settings, const imk_allan_table *table,
                               imk_allan_fit *fit, void *workspace, size_t workspace_size,
                               imk_error *error)
{
    imki_allan_work *w = NULL;
    const imk_status status = imki_allan_fit_start(settings, table, workspace, workspace_size, &w);
    if (status != IMK_OK)
        return imk_error_set(error, status, "table", NULL, NULL);
    imki_allan_problem *problem = &w->problem;
    imki_allan_state *state = &w->state;
    const int ramp = place_of(problem, IMK_NOISE_RAMP);
    for (size_t t = 0; t < problem->terms; t++)
        state->active[t] = (int)t != ramp;
    imki_allan_solve(problem, state, IMKI_ALLAN_NONE, 0);
    if (state->status != IMK_OK)
        return imk_error_set(error, state->status, "table", NULL, NULL);
    if (settings->sinusoid_refine)
        imki_allan_sinusoids_refine(problem, state);
    /* A Gauss-Markov term has two parameters and is searched for: 10, as in the spectral fit. */
    imki_allan_gauss_markov_find(problem, state, settings->gauss_markov_max, 10);
    if (settings->trim)
        trim(w);
    const double needed = imk_chi_square_quantile(1 - 2 * settings->significance, 1);
    choose(settings, problem, state, needed);
    choose_ramp(settings, w, needed);
    if (state->status != IMK_OK)
        return imk_error_set(error, state->status, "table", NULL, NULL);
    const double drop = imk_chi_square_quantile(settings->confidence, 1);
    *fit = (imk_allan_fit){.gauss_markov_count = 0};
    store_agreement(problem, state, fit);
    store_correlation(problem, state, fit);
    store_terms(problem, state, drop, fit);
    return IMK_OK;
}
