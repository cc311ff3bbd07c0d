/* SPDX-License-Identifier: Apache-2.0 */
/* Which terms does the record hold? The set of terms with the largest
 *
 *     log-likelihood - sum of penalties
 *
 * is looked for by adding, dropping and exchanging terms, from several starts. A penalty is the
 * gain in log-likelihood that chance alone brings in a share `significance` of records that do not
 * hold the term:
 *
 * - a strength, which cannot be negative: half a chi-square, half the time 0 [SELF1987];
 * - a Gauss-Markov term, whose correlation time is searched: the largest of many such ratios
 *   [DAVIES1987]. With Z(T) the normalised score of the term, P(max Z > c) <= Phi(-c) +
 *   L/(2 pi) e^(-c^2/2), L the length of the path of Z. Lorentzians whose times differ by a factor
 *   e^d correlate above white noise by 1/cosh(d/2), so that L = log(T_max/T_min)/2. As it can
 *   imitate bias instability, a random walk and both, it must be ten times less likely by chance
 *   than the other terms;
 * - a ramp: see ramp_penalty(). */
#include "identify_internal.h"
#include "imukit/distributions.h"
#include "imukit/elementary.h"

#include <math.h>

enum {
    RAMP = IMKI_TEMPLATES_MAX, /* after the templates */
    NONE = -1,
    MOVES_MAX = 64
};

typedef struct search {
    imki_fit *fit;
    const imki_bands *bands;
    const imki_penalties *penalties;
    imki_alternatives *met;
} search;

imki_penalties imki_penalties_of(const imki_bands *bands, double significance)
{
    imki_penalties p = {.significance = significance};
    double shortest, longest, path = 0;
    p.term = 0.5 * imk_chi_square_quantile(1 - 2 * significance, 1);
    if (imki_gauss_markov_range(bands, &shortest, &longest))
        path = 0.5 * imk_ln(longest / shortest);
    double low = 0, high = 50;
    for (int i = 0; i < 40; i++) {
        const double gain = 0.5 * (low + high);
        const double chance =
            imk_normal_probability(-sqrt(2 * gain)) + path / 6.283185307179586 * imk_exp(-gain);
        *(chance > 0.1 * significance ? &low : &high) = gain;
    }
    p.gauss_markov = high;
    return p;
}

/* Gain in log-likelihood that a ramp must bring to the fit without it. A ramp and a random walk
 * look much alike in one record, and a ramp that is not there takes the walk's place: it must be
 * ten times less likely by chance than the other terms. Its estimate is assessed against slow
 * noise that is itself known from a few coefficients, so that the ratio follows Student's t with v
 * degrees, those of the fitted spectrum at the lowest frequency. */
static double ramp_penalty(const search *s)
{
    imki_fit *fit = s->fit;
    double slope[IMKI_TEMPLATES_MAX] = {0};
    for (size_t i = 0; i < fit->templates; i++)
        slope[i] = fit->active[i] ? fit->shape[i][0] : 0;
    const double v = fmax(1, imki_fit_degrees(fit, s->bands, imki_fit_spectrum(fit, 0), slope));
    const double z = imk_normal_quantile(1 - 0.05 * s->penalties->significance);
    return 0.5 * imki_student_factor(v) * z * z;
}

static size_t count_of(const imki_amounts *set)
{
    size_t count = 0;
    for (size_t i = IMKI_FIRST_GAUSS_MARKOV; i < IMKI_FIRST_RESONANCE; i++)
        count += set->active[i] && set->amount[i] > 0;
    return count < IMKI_ALTERNATIVE_COUNTS ? count : IMKI_ALTERNATIVE_COUNTS - 1;
}

static void remember(search *s)
{
    const imki_fit *fit = s->fit;
    const imki_amounts set = imki_fit_keep(fit);
    const size_t count = count_of(&set);
    double *best = &s->met->log_likelihood[fit->ramp_active][count];
    if (fit->log_likelihood > *best) {
        *best = fit->log_likelihood;
        s->met->set[fit->ramp_active][count] = set;
    }
}

static void forget(imki_alternatives *met)
{
    for (size_t ramp = 0; ramp < 2; ramp++)
        for (size_t i = 0; i < IMKI_ALTERNATIVE_COUNTS; i++)
            met->log_likelihood[ramp][i] = -HUGE_VAL;
}

/* The likelihood of the fit's set of terms less its penalties, everything fitted. */
static double score(search *s)
{
    imki_fit *fit = s->fit;
    double penalty = 0;
    if (fit->ramp_active) {
        fit->ramp_active = false;
        fit->ramp = 0;
        imki_gauss_markov_settle(fit, s->bands, IMKI_HELD_NONE, IMKI_HELD_NONE);
        penalty += ramp_penalty(s);
        fit->ramp_active = true;
    }
    imki_gauss_markov_settle(fit, s->bands, IMKI_HELD_NONE, IMKI_HELD_NONE);
    remember(s);
    for (size_t j = 0; j < IMKI_FIRST_RESONANCE; j++)
        if (fit->active[j])
            penalty +=
                j < IMKI_FIRST_GAUSS_MARKOV ? s->penalties->term : s->penalties->gauss_markov;
    return fit->log_likelihood - penalty;
}

static bool is_on(const imki_fit *fit, int term)
{
    return term == RAMP ? fit->ramp_active : fit->active[term];
}

static void drop(imki_fit *fit, int term)
{
    if (term == RAMP) {
        fit->ramp_active = false;
        fit->ramp = 0;
    } else {
        fit->active[term] = false;
        fit->amount[term] = 0;
    }
}

static void add(search *s, int term)
{
    imki_fit *fit = s->fit;
    if (term == RAMP) {
        fit->ramp_active = true;
    } else if (!fit->active[term]) {
        fit->active[term] = true;
        fit->amount[term] = term == IMK_NOISE_WHITE
                                ? s->bands->power[s->bands->count * 3 / 4]
                                : 0.1 * s->bands->power[1] / fit->shape[term][1];
    }
}

/* Everything one move away: a term dropped, one added, or one exchanged for another. Quantization
 * is only dropped: whether it may be there is decided together with the output filter. What stands
 * out by more than CLEAR standard deviations is worth far more than any penalty and stays; where it
 * stands for something else, the other start of imki_terms_choose() leaves it out. */
typedef struct move {
    int dropped, added;
} move;

static const double CLEAR = 10;

static bool may_be_dropped(const search *s, const double *covariance, int term)
{
    const imki_fit *fit = s->fit;
    if (term == RAMP)
        return fit->ramp_active;
    if (term >= IMKI_FIRST_RESONANCE || !fit->active[term])
        return false;
    const size_t diagonal = (size_t)term * (fit->templates + 1);
    return !(fit->amount[term] > CLEAR * sqrt(covariance[diagonal]));
}

static size_t moves_of(const search *s, move *moves)
{
    static const int addable[] = {IMK_NOISE_WHITE, IMK_NOISE_BIAS_INSTABILITY,
                                  IMK_NOISE_RANDOM_WALK, RAMP};
    const size_t kinds = sizeof addable / sizeof addable[0];
    double covariance[IMKI_TEMPLATES_MAX * IMKI_TEMPLATES_MAX];
    imki_fit_covariance(s->fit, s->bands, covariance);
    size_t count = 0;
    for (int dropped = NONE; dropped <= RAMP && count + kinds < MOVES_MAX; dropped++) {
        if (dropped != NONE && !may_be_dropped(s, covariance, dropped))
            continue;
        if (dropped != NONE)
            moves[count++] = (move){dropped, NONE};
        for (size_t i = 0; i < kinds; i++)
            if (!is_on(s->fit, addable[i]))
                moves[count++] = (move){dropped, addable[i]};
    }
    return count;
}

/* The best move as long as there is one. */
static double improve(search *s)
{
    double best = score(s);
    for (;;) {
        const imki_amounts start = imki_fit_keep(s->fit);
        imki_amounts found = start;
        const double before = best;
        move moves[MOVES_MAX];
        const size_t count = moves_of(s, moves);
        for (size_t i = 0; i < count; i++) {
            if (moves[i].dropped != NONE)
                drop(s->fit, moves[i].dropped);
            if (moves[i].added != NONE)
                add(s, moves[i].added);
            const double reached = score(s);
            if (reached > best) {
                best = reached;
                found = imki_fit_keep(s->fit);
            }
            imki_fit_restore(s->fit, s->bands, &start);
        }
        imki_fit_restore(s->fit, s->bands, &found);
        if (!(best > before))
            return best;
    }
}

/* Gain at which a set is remembered, though it will not be chosen. */
static const double WORTH_MEETING = 0.5;

static void set_slow(search *s, bool on)
{
    static const int slow[] = {IMK_NOISE_BIAS_INSTABILITY, IMK_NOISE_RANDOM_WALK};
    for (size_t i = 0; i < 2; i++)
        if (on)
            add(s, slow[i]);
        else
            drop(s->fit, slow[i]);
}

/* With one more Gauss-Markov term, from the present set with or without bias instability and random
 * walk, which together take the place of a Gauss-Markov term, or it theirs. */
static double with_gauss_markov(search *s, bool five_terms)
{
    set_slow(s, five_terms);
    add(s, IMK_NOISE_WHITE);
    imki_gauss_markov_settle(s->fit, s->bands, IMKI_HELD_NONE, IMKI_HELD_NONE);
    const double before = s->fit->log_likelihood;
    if (!imki_gauss_markov_add(s->fit, s->bands, WORTH_MEETING))
        return -HUGE_VAL;
    const bool hopeful = s->fit->log_likelihood > before + 0.5 * s->penalties->term;
    return hopeful ? improve(s) : score(s);
}

/* Gain of a Gauss-Markov term that was not chosen, from which on a further one may take the place
 * of what was. With 1, bias instability that is there could be two such terms in 45 % of records of
 * N and B, with 2 in 15 % (experiments/coverage_mixtures.c). */
static const double WORTH_FOLLOWING = 2;

/* Bias instability can stand for two Gauss-Markov terms of which one alone does not replace it:
 * then neither is chosen, and two would not be met. */
static void meet_further(search *s, const imki_amounts *chosen)
{
    const size_t count = count_of(chosen);
    const double *met = s->met->log_likelihood[0];
    if (count + 2 >= IMKI_ALTERNATIVE_COUNTS || !(met[count + 1] > met[count] + WORTH_FOLLOWING))
        return;
    const imki_amounts start = s->met->set[0][count + 1];
    for (int five_terms = 0; five_terms < 2; five_terms++) {
        imki_fit_restore(s->fit, s->bands, &start);
        set_slow(s, five_terms > 0);
        imki_gauss_markov_settle(s->fit, s->bands, IMKI_HELD_NONE, IMKI_HELD_NONE);
        if (imki_gauss_markov_add(s->fit, s->bands, 0))
            remember(s);
    }
}

double imki_terms_choose(imki_fit *fit, const imki_bands *bands, const imki_penalties *penalties,
                         imki_alternatives *met)
{
    search s = {fit, bands, penalties, met};
    forget(met);
    double best = improve(&s);
    imki_amounts chosen = imki_fit_keep(fit);
    for (size_t term = 0; term < IMKI_GAUSS_MARKOV_MAX; term++) {
        const imki_amounts start = chosen;
        const double before = best;
        for (int five_terms = 0; five_terms < 2; five_terms++) {
            imki_fit_restore(fit, bands, &start);
            const double reached = with_gauss_markov(&s, five_terms);
            if (reached > best) {
                best = reached;
                chosen = imki_fit_keep(fit);
            }
        }
        if (!(best > before))
            break;
    }
    meet_further(&s, &chosen);
    imki_fit_restore(fit, bands, &chosen);
    return best;
}
