/* SPDX-License-Identifier: Apache-2.0 */
/* Slow noise: what the observations of one log have in common and no residual shows.
 *
 * An estimate is off by the sum over rows of b_i n_i, b_i = Cov J_i/sigma_i^2 its influence, n_i
 * the mean of the noise over the samples of the row. So noise that the model states adds to the
 * covariance
 *
 *     sum over rows i, j of one record and axis of  b_i C_ij b_j^T,
 *
 * C_ij the covariance of n_i and n_j relative to the mean over the whole record: the bias is that
 * during the test. Flicker and random walk have no covariance of their own, but one of such
 * differences [MATHERON1973].
 *
 * Over two stretches of lengths h, the second d after the first, the means of a Gauss-Markov
 * process with sigma and T have the covariance
 *
 *     sigma^2 q(h_i/T) q(h_j/T) exp(-d/T),   q(x) = (1 - exp(-x))/x,
 *
 * and each the variance 2 sigma^2 (x - 1 + exp(-x))/x^2. The product lets the sum over all pairs
 * run along the record once, with one state for each T. Flicker of instability B is a sum of such
 * processes, T in steps of four, each of variance (ln 4/pi) B^2 [KESHNER1982], from a part of the
 * shortest stretch to a multiple of the record: what is slower is the same over all of it. A random
 * walk from 0 has the covariance K^2 times the middle of the earlier stretch; b + h/3 for one that
 * begins at b with itself.
 *
 * Turns are taken to see the mean over the record: over a turn slow noise is small against the
 * sigma of its angle. Between the records of a joint solution the levels differ, as far as a
 * flicker goes that is independent from one to the next. */
#include "estimator_internal.h"

#include "base/algebra/vector_internal.h"

#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

/* Flicker: from a 64th of the shortest stretch, where a process adds 2/64 of its variance to a
 * mean, to 64 times the record, over which one changes by 1/64. */
static const double flicker_span = 64.0;
static const double flicker_variance = 0.44127120030530319; /* ln 4/pi */
enum { FLICKER_STAGES = 24, STAGES = FLICKER_STAGES + IMK_TERMS_MAX };

typedef struct process {
    int stages;
    double variance[STAGES], time[STAGES];
    double walk; /* K^2 */
    double length;
    double level; /* variance of the mean over the record */
} process;

typedef struct stretch {
    double begin, end; /* since the record began [s] */
} stretch;

/* Sums along a record. */
typedef struct sums {
    double state[STAGES][IMKI_GLOBALS_MAX]; /* of influence q exp(-time since/T) */
    double walk[IMKI_GLOBALS_MAX];          /* of influence times middle */
    double common[IMKI_GLOBALS_MAX];        /* of influence times covariance with the mean */
    double total[IMKI_GLOBALS_MAX];         /* of influence */
    double diagonal[2]; /* sum of C_ii over the variance of the row, what locals took left out; of
                           holds, and where the input moves */
    double shared[2];   /* the same, each row by the share that the factor multiplies */
    double last;        /* end of the stretch before */
} sums;

/* An axis over one record: places in e->slow.order. */
typedef struct run {
    int record, sensor, axis;
    size_t first, end;
} run;

static double flicker_of(const imki_estimator *e, int sensor, int axis)
{
    const double stated =
        imk_model_triad(&e->problem->model, sensor)->noise.bias_instability.value[axis];
    return e->slow.stated ? stated : e->slow.assumed[sensor];
}

static bool is_stated(const imk_noise *noise, int axis)
{
    bool any = noise->bias_instability.value[axis] > 0.0 || noise->random_walk.value[axis] > 0.0;
    for (int i = 0; i < noise->gauss_markov_count; i++)
        any = any || noise->gauss_markov[i].sigma.value[axis] > 0.0;
    return any;
}

/* ---- times ----------------------------------------------------------------------------------- */

static bool has_time(const imk_calibration *c, size_t index)
{
    const imk_observation *o = &c->observation[index];
    return o->record >= 0 && !o->correlated && o->end > o->begin &&
           o->end <= c->record[o->record]->count;
}

/* Sample k is the mean over the interval that ends at its time. */
static double end_of(const imk_test_record *record, size_t sample)
{
    return record->time ? record->time[sample] - record->time[0] + record->dt
                        : (double)(sample + 1) * record->dt;
}

static stretch stretch_of(const imk_calibration *c, size_t index)
{
    const imk_observation *o = &c->observation[index];
    const imk_test_record *record = c->record[o->record];
    return (stretch){end_of(record, o->begin) - record->dt, end_of(record, o->end - 1)};
}

static double length_of(const imk_test_record *record)
{
    return end_of(record, record->count - 1);
}

static bool is_before(const imk_calibration *c, int a, int b)
{
    const imk_observation *x = &c->observation[a], *y = &c->observation[b];
    return x->record != y->record ? x->record < y->record
           : x->begin != y->begin ? x->begin < y->begin
                                  : a < b;
}

size_t imki_slow_noise_sums(void)
{
    return sizeof(sums);
}

void imki_slow_noise_start(imki_estimator *e)
{
    const imk_calibration *c = e->problem;
    bool *stated = &e->slow.stated;
    *stated = false;
    for (int sensor = 0; sensor < 2; sensor++)
        for (int axis = 0; axis < imk_model_triad(&e->problem->model, sensor)->axis_count; axis++)
            *stated =
                *stated || is_stated(&imk_model_triad(&e->problem->model, sensor)->noise, axis);
    e->slow.count = 0;
    for (size_t i = 0; i < e->observations; i++)
        if (has_time(c, i))
            e->slow.order[e->slow.count++] = (int)i;
    /* By record and time: insertion with shrinking gaps. They come in order as a rule. */
    for (size_t gap = e->slow.count / 2; gap > 0; gap /= 2)
        for (size_t i = gap; i < e->slow.count; i++) {
            const int moved = e->slow.order[i];
            size_t k = i;
            for (; k >= gap && is_before(c, moved, e->slow.order[k - gap]); k -= gap)
                e->slow.order[k] = e->slow.order[k - gap];
            e->slow.order[k] = moved;
        }
}

/* ---- one process -------------------------------------------------------------------------------
 */

static double q_of(double x)
{
    return x > 0.0 ? -imk_expm1(-x) / x : 1.0;
}

/* Variance of a mean over x times T, sigma 1; the series where the difference cancels. */
static double mean_variance(double x)
{
    return x < 0.01 ? 1.0 - x / 3.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0))
                    : 2.0 * (x + imk_expm1(-x)) / (x * x);
}

static void add_stage(process *p, double variance, double time)
{
    if (!(variance > 0.0) || !(time > 0.0))
        return;
    p->variance[p->stages] = variance;
    p->time[p->stages++] = time;
    p->level += variance * mean_variance(p->length / time);
}

/* What is slower than the slowest stage changes by t/T, what is quicker than the quickest adds 2
 * T/h to a mean: both sums are a third of that of the stage at the end. */
static void add_flicker(process *p, double instability, double quickest)
{
    const double variance = flicker_variance * instability * instability;
    double time = flicker_span * p->length;
    for (int i = 0; i < FLICKER_STAGES && time > quickest; i++, time *= 0.25) {
        const bool at_end = i == 0 || i + 1 == FLICKER_STAGES || !(0.25 * time > quickest);
        add_stage(p, at_end ? variance * 4.0 / 3.0 : variance, time);
    }
}

static double reading_of(const imki_estimator *e, const run *r, size_t i)
{
    return e->reading[e->slow.order[i]][r->sensor][r->axis];
}

/* What the model states of an axis. A Gauss-Markov process quicker than a hold is not slow: it
 * shows in the residuals, and the group's factor has it. @return false: nothing */
static bool process_of(const imki_estimator *e, const run *r, process *p)
{
    const imk_calibration *c = e->problem;
    const imk_test_record *record = c->record[r->record];
    const imk_noise *noise = &imk_model_triad(&e->problem->model, r->sensor)->noise;
    double shortest = (double)INFINITY, sum = 0.0, count = 0.0;
    *p = (process){.length = length_of(record)};
    if (!imk_model_triad(&e->problem->model, r->sensor)->present ||
        r->axis >= imk_model_triad(&e->problem->model, r->sensor)->axis_count ||
        !(is_stated(noise, r->axis) || flicker_of(e, r->sensor, r->axis) > 0.0))
        return false;
    for (size_t i = r->first; i < r->end; i++)
        if (!isnan(reading_of(e, r, i))) {
            const stretch s = stretch_of(c, (size_t)e->slow.order[i]);
            shortest = fmin(shortest, s.end - s.begin);
            sum += s.end - s.begin;
            count += 1.0;
        }
    if (count == 0.0)
        return false;
    const double b = flicker_of(e, r->sensor, r->axis), k = noise->random_walk.value[r->axis];
    const double quickest = fmax(shortest / flicker_span, 0.25 * record->dt);
    add_flicker(p, b, quickest);
    for (int i = 0; i < noise->gauss_markov_count; i++) {
        const double sigma = noise->gauss_markov[i].sigma.value[r->axis];
        const double own = noise->gauss_markov[i].correlation_time.value[r->axis];
        if (own >= sum / count)
            add_stage(p, sigma * sigma, own);
    }
    p->walk = k * k;
    p->level += p->walk * p->length / 3.0;
    return p->stages > 0 || p->walk > 0.0;
}

/* ---- sums along a record -----------------------------------------------------------------------
 */

/* One row: `reach` <- covariance with the rows before it, by influence; the states go on to its
 * end. *with_mean is its covariance with the mean over the record. @return its variance */
static double follow(const process *p, const stretch *at, size_t globals, const double *influence,
                     sums *s, double *reach, double *with_mean)
{
    /* A stretch does not reach back into the one before it. */
    const double begin = fmax(at->begin, s->last), end = fmax(at->end, begin), h = end - begin;
    const double middle = 0.5 * (begin + end), length = p->length;
    double own = p->walk * (begin + h / 3.0);
    *with_mean = p->walk * (middle - (begin * begin + begin * end + end * end) / (6.0 * length));
    for (size_t c = 0; c < globals; c++) {
        reach[c] = p->walk * s->walk[c];
        s->walk[c] += middle * influence[c];
    }
    for (int k = 0; k < p->stages; k++) {
        const double time = p->time[k], variance = p->variance[k], q = q_of(h / time);
        const double gap = imk_exp((s->last - begin) / time), past = imk_exp(-h / time);
        double *state = s->state[k];
        own += variance * mean_variance(h / time);
        *with_mean += variance * time / length *
                      (2.0 - q * (imk_exp(-begin / time) + imk_exp((end - length) / time)));
        for (size_t c = 0; c < globals; c++) {
            const double before = gap * state[c];
            reach[c] += variance * q * before;
            state[c] = past * before + q * influence[c];
        }
    }
    s->last = end;
    return own;
}

/* L^T x of the Cholesky factor of the information: its square is x^T S x. */
static double information_of(const imki_normal *n, const double *x)
{
    double square = 0.0;
    for (size_t j = 0; j < n->globals; j++) {
        double sum = 0.0;
        for (size_t i = j; i < n->globals; i++)
            sum += n->schur[i * n->globals + j] * x[i];
        square += sum * sum;
    }
    return square;
}

/* tr(S B) */
static double trace_with_information(const imki_normal *n, const double *matrix)
{
    const size_t g = n->globals;
    double trace = 0.0;
    for (size_t k = 0; k < g; k++)
        for (size_t i = k; i < g; i++) {
            double sum = 0.0;
            for (size_t j = k; j < g; j++)
                sum += matrix[i * g + j] * n->schur[j * g + k];
            trace += n->schur[i * g + k] * sum;
        }
    return trace;
}

static void add_products(size_t g, const double *a, const double *b, double factor, double *matrix)
{
    for (size_t i = 0; i < g; i++)
        for (size_t j = 0; a[i] != 0.0 && j < g; j++)
            matrix[i * g + j] += factor * a[i] * b[j];
}

/* The row of an axis among those of an item, and its influence in SI. @return NULL: not there */
static const imki_row *influence_of(imki_estimator *e, size_t item, int sensor, int axis,
                                    double *influence, double *local)
{
    const int count = imki_whitened_rows(e, item);
    for (int i = 0; i < count; i++) {
        const imki_row *row = &e->row[i];
        double m;
        if (row->sensor != sensor || row->axis != axis)
            continue;
        imki_rows_covariance(&e->normal, row, 1, &m, influence);
        *local = row->locals > 0 ? fmax(0.0, m - information_of(&e->normal, influence)) : 0.0;
        const double scale = 1.0 / sqrt(imki_row_variance(e, row));
        for (size_t c = 0; c < e->globals; c++)
            influence[c] *= scale;
        return row;
    }
    return NULL;
}

/* Sum over all pairs of an axis in a record, into e->slow.axis. */
static void sum_pairs(imki_estimator *e, const run *r, const process *p, sums *s)
{
    const size_t g = e->globals;
    double *matrix = e->slow.axis, influence[IMKI_GLOBALS_MAX], reach[IMKI_GLOBALS_MAX];
    memset(s, 0, sizeof *s);
    memset(matrix, 0, g * g * sizeof *matrix);
    for (size_t i = r->first; i < r->end; i++) {
        const size_t item = (size_t)e->slow.order[i];
        double local = 0.0, with_mean;
        if (e->weight[item] < 1.0 || isnan(reading_of(e, r, i)))
            continue;
        const imki_row *row = influence_of(e, item, r->sensor, r->axis, influence, &local);
        if (!row)
            continue;
        const stretch at = stretch_of(e->problem, item);
        const double own = follow(p, &at, g, influence, s, reach, &with_mean);
        add_products(g, influence, reach, 1.0, matrix);
        add_products(g, reach, influence, 1.0, matrix);
        add_products(g, influence, influence, own, matrix);
        for (size_t c = 0; c < g; c++) {
            s->common[c] += with_mean * influence[c];
            s->total[c] += influence[c];
        }
        const double square =
            (own - 2.0 * with_mean + p->level) * (1.0 - local) / imki_row_variance(e, row);
        s->diagonal[e->problem->observation[item].moving] += square;
        s->shared[e->problem->observation[item].moving] += row->share * square;
    }
    add_products(g, s->common, s->total, -1.0, matrix);
    add_products(g, s->total, s->common, -1.0, matrix);
    add_products(g, s->total, s->total, p->level, matrix);
}

/* ---- several records ---------------------------------------------------------------------------
 */

/* Number of a free bias; -1: none. */
static int bias_of(const imki_estimator *e, int sensor, int axis)
{
    for (int k = 0; k < e->axis_parameters[sensor][axis]; k++) {
        const int p = e->axis_parameter[sensor][axis][k];
        if (e->problem->parameter[p].term == IMK_MODEL_BIAS)
            return p;
    }
    return -1;
}

/* Influence of a record's level through its turns: it acts on them as a change of bias does. */
static void add_turns(imki_estimator *e, int record, int bias, double *total)
{
    const imk_calibration *c = e->problem;
    double matrix[4], by_globals[2 * IMKI_GLOBALS_MAX];
    for (size_t t = 0; t < e->turns; t++) {
        const size_t item = e->observations + t;
        if (c->observation[c->turn[t].from].record != record || e->weight[item] < 1.0)
            continue;
        const int count = imki_whitened_rows(e, item);
        imki_rows_covariance(&e->normal, e->row, count, matrix, by_globals);
        for (int i = 0; i < count; i++)
            for (int k = 0; k < e->row[i].globals; k++)
                for (size_t g = 0; e->row[i].global[k] == bias && g < e->globals; g++)
                    total[g] += e->row[i].by_global[k] * by_globals[(size_t)i * e->globals + g];
    }
}

/* Levels of an axis differ from record to record; the bias is their mean by length. */
static void add_level(imki_estimator *e, const run *r, const process *p, double all, sums *s)
{
    const int bias = bias_of(e, r->sensor, r->axis);
    if (bias < 0 || all <= p->length)
        return;
    if (r->sensor == IMK_GYRO)
        add_turns(e, r->record, bias, s->total);
    s->total[bias] -= p->length / all;
    add_products(e->globals, s->total, s->total, p->level, e->slow.covariance);
}

/* ---- all of it ---------------------------------------------------------------------------------
 */

/* Next record of the order from `first`. */
static run next_run(const imki_estimator *e, size_t first, int sensor, int axis)
{
    const imk_calibration *c = e->problem;
    run r = {c->observation[e->slow.order[first]].record, sensor, axis, first, first};
    while (r.end < e->slow.count && c->observation[e->slow.order[r.end]].record == r.record)
        r.end++;
    return r;
}

/* Length of all records that observe an axis. */
static double length_of_all(const imki_estimator *e, int sensor, int axis)
{
    double sum = 0.0;
    for (size_t first = 0; first < e->slow.count;) {
        const run r = next_run(e, first, sensor, axis);
        process p;
        sum += process_of(e, &r, &p) ? p.length : 0.0;
        first = r.end;
    }
    return sum;
}

static bool is_active(const imki_estimator *e)
{
    return e->slow.count > 0 &&
           (e->slow.stated || e->slow.assumed[IMK_GYRO] > 0.0 || e->slow.assumed[IMK_ACCEL] > 0.0);
}

void imki_slow_noise_fit(imki_estimator *e, imki_fit *fit)
{
    const size_t g = e->globals;
    sums *s = e->slow.sums;
    if (!is_active(e))
        return;
    memset(e->slow.covariance, 0, g * g * sizeof *e->slow.covariance);
    for (int sensor = 0; sensor < 2; sensor++) {
        double expected[IMKI_PARTS] = {0.0};
        for (int axis = 0; axis < IMK_AXES_MAX; axis++) {
            const double all = length_of_all(e, sensor, axis);
            for (size_t first = 0; all > 0.0 && first < e->slow.count;) {
                const run r = next_run(e, first, sensor, axis);
                process p;
                first = r.end;
                if (!process_of(e, &r, &p))
                    continue;
                sum_pairs(e, &r, &p, s);
                /* What the globals take is shared as what there is. */
                const double all_rows = s->diagonal[0] + s->diagonal[1];
                const double taken = trace_with_information(&e->normal, e->slow.axis);
                const double left = all_rows > 0.0 ? 1.0 - taken / all_rows : 0.0;
                expected[imki_part_of(e, sensor, axis)] += left * s->shared[0];
                expected[imki_moving_part(sensor, axis)] += left * s->shared[1];
                for (size_t i = 0; i < g * g; i++)
                    e->slow.covariance[i] += e->slow.axis[i];
                add_level(e, &r, &p, all, s);
            }
        }
        for (int part = 0; part < IMKI_PARTS; part++)
            if (expected[part] > 0.0 && fit->redundancy[part] > 0.0)
                fit->slow_square[part] = expected[part];
    }
}

void imki_slow_noise_add(imki_estimator *e, double *freedom)
{
    const size_t g = e->globals;
    if (!is_active(e))
        return;
    for (size_t p = 0; p < e->parameters; p++) {
        const double white = e->normal.covariance[p * g + p];
        const double share = (white + e->slow.covariance[p * g + p]) / white;
        freedom[p] *= share * share;
    }
    for (size_t i = 0; i < g * g; i++)
        e->normal.covariance[i] += e->slow.covariance[i];
}

/* ---- not stated ------------------------------------------------------------------------------ */

/* All readings of a sensor have a time and no other input than gravity and the Earth. */
static bool is_at_rest(const imki_estimator *e, int sensor)
{
    const double still = 1e-3; /* [rad/s]; the Earth's rate is 7e-5 */
    for (size_t i = 0; i < e->observations; i++) {
        const imk_observation *o = &e->problem->observation[i];
        bool read = false;
        for (int axis = 0; axis < IMK_AXES_MAX; axis++)
            read = read || !isnan(e->reading[i][sensor][axis]);
        const bool rests = o->knowledge == IMK_INPUT_GRAVITY || imki_norm3(o->rate) < still;
        if (read && (!has_time(e->problem, i) || o->moving || !rests))
            return false;
    }
    return true;
}

bool imki_slow_noise_assume(imki_estimator *e, int sensor, imki_fit *fit)
{
    if (e->slow.stated || !is_at_rest(e, sensor))
        return false;
    e->slow.assumed[sensor] = 1.0;
    imki_fit_groups(e, fit);
    e->slow.assumed[sensor] = 0.0;
    return true;
}
