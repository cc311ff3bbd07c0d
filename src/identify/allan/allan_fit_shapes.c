/* SPDX-License-Identifier: Apache-2.0 */
/* Shapes that are not linear in the variances: correlation times of Gauss-Markov terms and
 * frequencies of sinusoids. With p the logarithm of one, its equation is that of the amounts,
 *
 *     (dv/dp)^T C^-1 (v - A a) = 0
 *
 * which is the minimum of chi-square with C held: so C of the model at hand is held, p searched
 * with the amounts fitted again at each step, C made anew, and so on. A search with C held needs no
 * new covariance: the first one, over the whole range of times with C of the model without the
 * term, is the score test at each. */
#include "allan_fit_internal.h"
#include "identify/likelihood/identify_internal.h"
#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

enum { ROUNDS = 3, SECTIONS = 16 };

typedef struct search {
    imki_allan_problem *problem;
    imki_allan_state state, trial;
    double held[IMKI_ALLAN_TERMS]; /* amounts that C is held at */
    size_t term;
} search;

static void set_shape(search *s, double log_value)
{
    const int origin = s->problem->origin[s->term];
    if (s->problem->term[s->term].kind == IMKI_LAG_DECAY)
        s->problem->noise.gauss_markov[origin].correlation_time = imk_exp(log_value);
    else
        s->problem->noise.sinusoid[origin].frequency = imk_exp(log_value);
    imki_allan_term_set(s->problem, s->term);
}

/* Minus chi-square with C held. */
static double height(void *context, double log_value)
{
    search *s = context;
    set_shape(s, log_value);
    s->trial = s->state;
    s->trial.active[s->term] = true;
    s->problem->held = s->held;
    imki_allan_solve(s->problem, &s->trial, IMKI_ALLAN_NONE, 0);
    s->problem->held = NULL;
    return s->trial.status == IMK_OK ? -s->trial.chi_square : -(double)INFINITY;
}

/* Covariance and fit at a place: what the next search holds. */
static void settle(search *s, double log_value)
{
    set_shape(s, log_value);
    imki_allan_sums(s->problem, s->term, false);
    s->state.active[s->term] = true;
    imki_allan_solve(s->problem, &s->state, IMKI_ALLAN_NONE, 0);
    memcpy(s->held, s->state.amount, sizeof s->held);
}

static double refine(search *s, double place, double reach)
{
    for (int i = 0; i < ROUNDS; i++) {
        place = imki_peak(height, s, place - reach, place + reach, SECTIONS);
        settle(s, place);
    }
    return place;
}

/* Best of times three in a decade, from twice the shortest tau to the longest. */
static double scan_times(search *s)
{
    const imk_allan_table *table = s->problem->table;
    const double first = imk_ln(2 * table->dt * (double)table->factors[0]);
    const double last = imk_ln(table->dt * (double)table->factors[table->count - 1]);
    double best = first, highest = -(double)INFINITY;
    for (double x = first; x <= last; x += 0.75) {
        const double here = height(s, x);
        if (here > highest) {
            highest = here;
            best = x;
        }
    }
    return best;
}

void imki_allan_gauss_markov_find(imki_allan_problem *problem, imki_allan_state *state, int most,
                                  double needed)
{
    for (int i = 0; i < most; i++) {
        search s = {.problem = problem, .term = problem->terms};
        problem->terms++;
        problem->noise.gauss_markov_count = i + 1;
        problem->noise.gauss_markov[i].correlation_time = problem->table->dt;
        problem->origin[s.term] = i;
        problem->term[s.term] = (imki_lag_term){.kind = IMKI_LAG_DECAY};
        state->active[s.term] = false;
        state->amount[s.term] = 0;
        set_shape(&s, imk_ln(problem->table->dt));
        imki_allan_sums(problem, s.term,
                        true); /* only so that they hold numbers: the amount is 0 */
        s.state = *state;
        memcpy(s.held, state->amount, sizeof s.held);
        const double start = scan_times(&s);
        settle(&s, start);
        refine(&s, start, 0.75);
        const bool found = s.state.status == IMK_OK && s.state.amount[s.term] > 0 &&
                           imki_allan_deviance(problem, &s.state, (int)s.term, 0) > needed;
        if (!found) {
            problem->terms--;
            problem->noise.gauss_markov_count = i;
            break;
        }
        *state = s.state;
    }
    /* The solution's tables are as wide as the terms in use. */
    imki_allan_solve(problem, state, IMKI_ALLAN_NONE, 0);
}

void imki_allan_sinusoids_refine(imki_allan_problem *problem, imki_allan_state *state)
{
    for (size_t term = 0; term < problem->terms; term++) {
        if (problem->term[term].kind != IMKI_LAG_SINUSOID)
            continue;
        search s = {.problem = problem, .state = *state, .term = term};
        memcpy(s.held, state->amount, sizeof s.held);
        refine(&s, imk_ln(problem->noise.sinusoid[problem->origin[term]].frequency), 0.1);
        *state = s.state;
    }
}

double imki_allan_time_end(imki_allan_problem *problem, const imki_allan_state *state, size_t term,
                           double direction, double drop)
{
    search s = {.problem = problem, .state = *state, .term = term};
    memcpy(s.held, state->amount, sizeof s.held);
    const double centre =
        imk_ln(problem->noise.gauss_markov[problem->origin[term]].correlation_time);
    const double needed = height(&s, centre) - drop;
    double inside = 0, outside = 0.05;
    while (outside < 4.6 && height(&s, centre + direction * outside) > needed) { /* factor 100 */
        inside = outside;
        outside *= 2;
    }
    for (int i = 0; i < 20; i++) {
        const double middle = 0.5 * (inside + outside);
        *(height(&s, centre + direction * middle) > needed ? &inside : &outside) = middle;
    }
    set_shape(&s, centre);
    return imk_exp(centre + direction * 0.5 * (inside + outside));
}
