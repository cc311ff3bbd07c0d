/* SPDX-License-Identifier: Apache-2.0 */
/* Profile of the quasi-likelihood of one amount.
 *
 * The quasi-score U = A^T C^-1 (v - A a) is the slope of a function that behaves like a
 * log-likelihood. Along the profile, where the other amounts solve their own equations (or stay at
 * zero), only the held amount's slope counts, so that
 *
 *     D(value) = 2 int_value^solution U_held d(amount)
 *
 * For one variance of v degrees of freedom this is exactly twice the loss of log-likelihood of a
 * chi-square, v (x - 1 - log x), x = variance/amount: the skewness of such estimates is in it,
 * which the asymptotic interval leaves out. */
#include "allan_fit_internal.h"

#include <math.h>

/* dD/d(amplitude) and the state at an amplitude, the state before being the start. */
static double slope_at(const imki_allan_problem *problem, imki_allan_state *state, int term,
                       double amplitude)
{
    imki_allan_solve(problem, state, term, amplitude * amplitude);
    return -4 * amplitude * state->score[term];
}

double imki_allan_deviance(const imki_allan_problem *problem, const imki_allan_state *solution,
                           int term, double value)
{
    enum { PANELS = 8 };
    imki_allan_state state = *solution;
    const double from = sqrt(solution->amount[term]), to = sqrt(value);
    const double step = (to - from) / PANELS;
    double before = slope_at(problem, &state, term, from), sum = 0;
    for (int i = 0; i < PANELS; i++) { /* Simpson */
        const double middle = slope_at(problem, &state, term, from + (i + 0.5) * step);
        const double after =
            slope_at(problem, &state, term, i + 1 < PANELS ? from + (i + 1) * step : to);
        sum += step / 6 * (before + 4 * middle + after);
        before = after;
    }
    return fmax(0, sum);
}

/* Where in a panel of unit length, slopes s0, s1 (half), s2, the integral reaches `needed`. */
static double place_in_panel(double s0, double s1, double s2, double step, double needed)
{
    const double linear = -3 * s0 + 4 * s1 - s2, square = 2 * s0 - 4 * s1 + 2 * s2;
    double low = 0, high = 1;
    for (int i = 0; i < 40; i++) {
        const double x = 0.5 * (low + high);
        const double sum = step * x * (s0 + x * (linear / 2 + x * square / 3));
        *(sum < needed ? &low : &high) = x;
    }
    return 0.5 * (low + high);
}

double imki_allan_profile_end(const imki_allan_problem *problem, const imki_allan_state *solution,
                              int term, double step, double drop)
{
    enum { PANELS = 200 };
    imki_allan_state state = *solution;
    double from = sqrt(solution->amount[term]), sum = 0;
    double before = slope_at(problem, &state, term, from);
    step *= 0.5;
    for (int i = 0; i < PANELS; i++) {
        const bool last = step < 0 && from + step <= 0;
        const double length = last ? -from : step;
        const double middle = slope_at(problem, &state, term, from + 0.5 * length);
        const double after = slope_at(problem, &state, term, from + length);
        const double panel = length / 6 * (before + 4 * middle + after);
        if (sum + panel >= drop)
            return from + length * place_in_panel(before, middle, after, length, drop - sum);
        if (last)
            return 0;
        sum += panel;
        from += length;
        before = after;
        if (sum < 0.25 * drop && i > 3)
            step *= 1.5;
    }
    return from;
}
