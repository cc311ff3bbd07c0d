/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of the fit of a noise model to a table of Allan variances. */
#ifndef IMUKIT_ALLAN_FIT_INTERNAL_H
#define IMUKIT_ALLAN_FIT_INTERNAL_H

#include "imukit/allan_fit.h"

enum { IMKI_ALLAN_TAUS = IMK_ALLAN_FIT_FACTORS_MAX, IMKI_ALLAN_TERMS = IMK_ALLAN_FIT_TERMS_MAX };

/* How the generalised autocovariance R(t) of the running sums depends on the lag t [samples]. */
typedef enum imki_lag_kind {
    IMKI_LAG_DELTA,     /* quantization: R(0) only */
    IMKI_LAG_LINEAR,    /* white noise */
    IMKI_LAG_FILTERED,  /* white noise behind a low-pass */
    IMKI_LAG_LOGARITHM, /* flicker noise */
    IMKI_LAG_CUBIC,     /* random walk */
    IMKI_LAG_DECAY,     /* Gauss-Markov */
    IMKI_LAG_RINGING,   /* resonance */
    IMKI_LAG_RAMP,      /* deterministic: a mean */
    IMKI_LAG_SINUSOID   /* deterministic: a mean of random phase */
} imki_lag_kind;

/* One term: R(t) for amount 1 (the square of its parameter) is
 *     linear |t| + scale * (form of its kind) + Re sum_i g_i exp(-lambda_i |t|). */
typedef struct imki_lag_term {
    imki_lag_kind kind;
    double scale, linear;
    double rate;         /* inverse correlation time, or angular frequency, per sample */
    int exponentials;    /* 0 … 2 */
    double g[2][2];      /* real and imaginary part */
    double lambda[2][2]; /* [1/sample]; the imaginary part negative */
} imki_lag_term;

/* A table and a model, ready to fit. */
typedef struct imki_allan_problem {
    const imk_allan_table *table;
    size_t terms;                 /* in use */
    size_t capacity;              /* that the tables below have room for */
    imk_allan_noise noise;        /* shapes; strengths are not read */
    int origin[IMKI_ALLAN_TERMS]; /* the term's place among its kind */
    imki_lag_term term[IMKI_ALLAN_TERMS];
    double spectrum[IMK_TERMS_MAX][IMKI_ALLAN_TERMS]; /* of each term at each sinusoid, amount 1 */
    double *shape; /* count x capacity: Allan variance for amount 1 */
    double *sums;  /* (pair of tau) x (pair of terms): covariance for amounts 1 */
    /* For a while: covariance, count x count; whitened shapes and variances, (capacity + 1) x
     * count; matrices of the terms, capacity x capacity. */
    double *matrix, *white, *scaled, *factor;
    const double *variances; /* of the table, or drawn */
    const double *held;      /* amounts that C is held at while a shape is searched; NULL: those of
                                the state */
    size_t first;            /* shortest tau that is used, by its place in the table */
    double tolerance;        /* relative error of the model admitted in each deviation */
} imki_allan_problem;

/* Amounts and which of them are free. */
typedef struct imki_allan_state {
    bool active[IMKI_ALLAN_TERMS];
    double amount[IMKI_ALLAN_TERMS];
    double information[IMKI_ALLAN_TERMS * IMKI_ALLAN_TERMS]; /* A^T C^-1 A, all terms */
    double score[IMKI_ALLAN_TERMS];                          /* A^T C^-1 (v - A a), all terms */
    double chi_square;
    imk_status status;
} imki_allan_state;

/* allan_covariance_terms.c */
/* Terms of a model: the five of `use`, then sinusoids, resonances, Gauss-Markov terms. */
void imki_allan_problem_terms(imki_allan_problem *problem, const bool use[IMK_NOISE_TERMS]);
/* Make the lag form, the shape and the spectra of term j anew. */
void imki_allan_term_set(imki_allan_problem *problem, size_t j);
/* R(t) of the part of a term that varies slowly beside a resonance, and of the ringing part. */
double imki_lag_smooth(const imki_lag_term *term, double lag);
double imki_lag_ringing(const imki_lag_term *term, double lag);
/* Sum over all lags of the ringing part, and of its product with itself shifted by d >= 0. */
double imki_ringing_sum(const imki_lag_term *term);
double imki_ringing_product(const imki_lag_term *term, double shift);
/* Amount (square) of term j of a problem in a model; and back. */
double imki_allan_amount(const imki_allan_problem *problem, const imk_allan_noise *noise, size_t j);
void imki_allan_store_amount(const imki_allan_problem *problem, size_t j, double amount,
                             imk_allan_noise *noise);

/* allan_covariance.c */
/* Sums of the pairs of terms whose second is `first` or later. `coarse`: half the nodes. */
void imki_allan_sums(imki_allan_problem *problem, size_t first, bool coarse);
/* Covariance matrix count x count for amounts. */
void imki_allan_matrix(const imki_allan_problem *problem, const double *amount, double *matrix);
/* Pairs of terms, the term with itself included. */
size_t imki_allan_combinations(size_t terms);
size_t imki_allan_stride(const imk_allan_table *table, size_t i);

/* allan_table.c */
imk_status imki_allan_table_check(const imk_allan_table *table);
size_t imki_allan_problem_size(size_t count, size_t terms); /* of shape and sums */
void imki_allan_problem_lay(imki_allan_problem *problem, size_t count, size_t terms,
                            double *memory);
/* Second differences of all records at a factor. */
double imki_allan_squares(const imk_allan_table *table, size_t i);

/* Variance of the Allan variance at factor m of a record of n samples with a model's noise, its
 * second differences `stride` samples apart, a divisor of m. Good to a few per cent. */
double imki_allan_variance_of_one(const imk_allan_noise *noise, double dt, size_t n, size_t m,
                                  size_t stride);

/* allan_fit_solve.c */
enum { IMKI_ALLAN_NONE = -1 };
/* Solve for the active amounts, one of them held at a value unless `held` is IMKI_ALLAN_NONE. The
 * amounts in the state are the start; all zero: makes its own. */
void imki_allan_solve(const imki_allan_problem *problem, imki_allan_state *state, int held,
                      double value);
/* Covariance of the active amounts, terms x terms; zero for the others. */
void imki_allan_spread(const imki_allan_problem *problem, const imki_allan_state *state,
                       double *covariance);

/* allan_fit_profile.c */
/* Twice the quasi-likelihood lost from the solution to where one amount is held at a value. */
double imki_allan_deviance(const imki_allan_problem *problem, const imki_allan_state *solution,
                           int term, double value);
/* Amplitude (root of the amount) at which twice the quasi-likelihood has fallen by `drop`; upwards
 * or downwards from the solution; 0 when it never does downwards. */
double imki_allan_profile_end(const imki_allan_problem *problem, const imki_allan_state *solution,
                              int term, double step, double drop);

/* allan_fit_shapes.c: Gauss-Markov terms that the table asks for, and frequencies. */
void imki_allan_gauss_markov_find(imki_allan_problem *problem, imki_allan_state *state, int most,
                                  double needed);
void imki_allan_sinusoids_refine(imki_allan_problem *problem, imki_allan_state *state);
double imki_allan_time_end(imki_allan_problem *problem, const imki_allan_state *state, size_t term,
                           double direction, double drop);

/* What a fit needs, at the start of its workspace. */
typedef struct imki_allan_work {
    imki_allan_problem problem;
    imki_allan_state state, other;
    double *rest; /* the workspace behind what the problem needs */
} imki_allan_work;

/* allan_fit.c: problem of a table in a workspace, with room for all terms the settings allow. */
imk_status imki_allan_fit_start(const imk_allan_fit_settings *settings,
                                const imk_allan_table *table, void *workspace,
                                size_t workspace_size, imki_allan_work **work);

#endif
