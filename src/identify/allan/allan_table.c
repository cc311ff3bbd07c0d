/* SPDX-License-Identifier: Apache-2.0 */
/* A table of Allan variances as the caller gives it: what must hold of it, the memory it needs, and
 * the covariance of its variances under a given noise. */
#include "allan_fit_internal.h"

#include "base/workspace_internal.h"

#include <math.h>

imk_status imki_allan_table_check(const imk_allan_table *table)
{
    if (!isfinite(table->dt))
        return IMK_ERROR_NOT_FINITE;
    if (!(table->dt > 0) || table->count < 2 || table->count > IMKI_ALLAN_TAUS)
        return IMK_ERROR_RANGE;
    if (!table->factors || table->record_count < 1 || !table->lengths)
        return IMK_ERROR_ARGUMENT;
    for (size_t i = 0; i < table->count; i++) {
        const size_t m = table->factors[i], stride = imki_allan_stride(table, i);
        if (m < 1 || m > SIZE_MAX / 4 || (i > 0 && m <= table->factors[i - 1]) || stride < 1 ||
            m % stride != 0)
            return IMK_ERROR_RANGE;
        if (!(imki_allan_squares(table, i) > 0))
            return IMK_ERROR_TOO_SHORT;
    }
    return IMK_OK;
}

size_t imki_allan_problem_size(size_t count, size_t terms)
{
    return (count * terms + count * (count + 1) / 2 * imki_allan_combinations(terms)) *
           sizeof(double);
}

void imki_allan_problem_lay(imki_allan_problem *problem, size_t count, size_t terms, double *memory)
{
    problem->capacity = terms;
    problem->shape = memory;
    problem->sums = memory + count * terms;
}

size_t imk_allan_covariance_workspace_size(size_t count, size_t terms)
{
    return imki_allan_problem_size(count, terms) + IMKI_ALIGNMENT_SLACK;
}

static imk_status noise_check(const imk_allan_noise *noise)
{
    const int counts[3] = {noise->gauss_markov_count, noise->sinusoid_count,
                           noise->resonance_count};
    for (int i = 0; i < 3; i++)
        if (counts[i] < 0 || counts[i] > IMK_TERMS_MAX)
            return IMK_ERROR_RANGE;
    if (!(noise->filter.bandwidth >= 0) || !(noise->filter.damping >= 0))
        return IMK_ERROR_RANGE;
    for (int i = 0; i < IMK_NOISE_TERMS; i++)
        if (!isfinite(noise->term[i]))
            return IMK_ERROR_NOT_FINITE;
    for (int i = 0; i < noise->gauss_markov_count; i++)
        if (!(noise->gauss_markov[i].correlation_time > 0))
            return IMK_ERROR_RANGE;
    for (int i = 0; i < noise->sinusoid_count; i++)
        if (!(noise->sinusoid[i].frequency > 0))
            return IMK_ERROR_RANGE;
    for (int i = 0; i < noise->resonance_count; i++)
        if (!(noise->resonance[i].frequency > 0) || !(noise->resonance[i].q > 0.5))
            return IMK_ERROR_RANGE;
    return IMK_OK;
}

static size_t count_terms(const imk_allan_noise *noise, bool use[IMK_NOISE_TERMS])
{
    size_t terms = (size_t)noise->gauss_markov_count;
    terms += (size_t)noise->sinusoid_count;
    terms += (size_t)noise->resonance_count;
    for (int i = 0; i < IMK_NOISE_TERMS; i++)
        terms += use[i] = noise->term[i] != 0;
    return terms;
}

double imki_allan_variance_of_one(const imk_allan_noise *noise, double dt, size_t n, size_t m,
                                  size_t stride)
{
    enum { PAIRS = IMKI_ALLAN_TERMS * (IMKI_ALLAN_TERMS + 1) / 2 };
    double memory[IMKI_ALLAN_TERMS + PAIRS], amount[IMKI_ALLAN_TERMS], variance;
    bool use[IMK_NOISE_TERMS];
    const imk_allan_table table = {
        .dt = dt, .count = 1, .factors = &m, .strides = &stride, .record_count = 1, .lengths = &n};
    imki_allan_problem problem = {.table = &table, .noise = *noise};
    imki_allan_problem_lay(&problem, 1, count_terms(noise, use), memory);
    imki_allan_problem_terms(&problem, use);
    imki_allan_sums(&problem, 0, true);
    for (size_t t = 0; t < problem.terms; t++)
        amount[t] = imki_allan_amount(&problem, noise, t);
    imki_allan_matrix(&problem, amount, &variance);
    return variance;
}

imk_status imk_allan_covariance(const imk_allan_table *table, const imk_allan_noise *noise,
                                double *covariance, void *workspace, size_t workspace_size)
{
    imk_status status = imki_allan_table_check(table);
    if (status == IMK_OK)
        status = noise_check(noise);
    if (status != IMK_OK)
        return status;
    bool use[IMK_NOISE_TERMS];
    const size_t terms = count_terms(noise, use);
    if (workspace_size < imk_allan_covariance_workspace_size(table->count, terms))
        return IMK_ERROR_WORKSPACE;
    imki_allan_problem problem = {.table = table, .noise = *noise};
    imki_allan_problem_lay(&problem, table->count, terms, imki_align(workspace));
    imki_allan_problem_terms(&problem, use);
    imki_allan_sums(&problem, 0, false);
    double amount[IMKI_ALLAN_TERMS];
    for (size_t t = 0; t < terms; t++)
        amount[t] = imki_allan_amount(&problem, noise, t);
    imki_allan_matrix(&problem, amount, covariance);
    return IMK_OK;
}
