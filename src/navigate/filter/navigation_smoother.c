/* SPDX-License-Identifier: Apache-2.0 */
/* Smoothing by the adjoint of Bryson and Frazier [BIERMAN1973]. With x the errors that the filter's
 * estimates leave, l and L what all later readings say of them,
 *
 *     at an instant       x (smoothed) = P l,     P (smoothed) = P - P L P
 *     before an update    l <- H^T S^-1 z + (I - K H)^T l
 *                         L <- H^T S^-1 H + (I - K H)^T L (I - K H)
 *     before a step A     l <- A^T l,             L <- A^T L A
 *
 * from l = 0, L = 0 at the end. It gives what the recursion of Rauch, Tung and Striebel gives
 * [RAUCH1965], without the inverse of P, which does not exist where an error is known to be zero.
 * Of P only the rows of what is wanted are kept: nine errors, and the sums of the biases' parts. */
#include "navigation_filter_internal.h"
#include "navigation_smoother_internal.h"

#include <math.h>
#include <string.h>

enum { ERRORS = IMK_NAVIGATION_ERRORS, WANTED = ERRORS + 6, STATES_MAX = IMKI_FILTER_STATES_MAX };

typedef imki_smoother_record record;

struct imk_navigation_smoother {
    imk_navigation_filter *filter;
    imk_smoother_room room;
    void *context;
    bool failed;
    record *last;
    size_t points;
    bool moved;   /* the step is not that of no time */
    double *step; /* 10 x n: since the last record */
};

/* ---- recording ------------------------------------------------------------------------------ */

static void *take(imk_navigation_smoother *s, size_t size)
{
    void *memory = s->failed ? NULL : s->room(size, s->context);
    s->failed = s->failed || !memory;
    return memory;
}

static void clear_step(imk_navigation_smoother *s)
{
    const size_t n = s->filter->states;
    memset(s->step, 0, 10 * n * sizeof *s->step);
    for (size_t i = 0; i < n; i++)
        s->step[(i < ERRORS ? i : ERRORS) * n + i] = 1.0;
    s->moved = false;
}

imk_navigation_smoother *imk_navigation_smoother_start(imk_navigation_filter *filter,
                                                       imk_smoother_room room, void *context)
{
    imk_navigation_smoother *s = NULL;
    if (!(filter->settings.rotation_sigma > 0.0))
        s = room(sizeof *s, context);
    double *step = s ? room(10 * filter->states * sizeof *step, context) : NULL;
    if (!step)
        return NULL;
    *s =
        (imk_navigation_smoother){.filter = filter, .room = room, .context = context, .step = step};
    clear_step(s);
    filter->smoother = s;
    return s;
}

const imki_smoother_record *imki_smoother_last(const imk_navigation_smoother *s)
{
    return s->last;
}

/* A record with the step since the one before, which begins anew. */
static record *add_record(imk_navigation_smoother *s)
{
    const size_t n = s->filter->states;
    record *made = take(s, sizeof *made);
    double *step = made && s->moved ? take(s, 10 * n * sizeof *step) : NULL;
    if (s->failed)
        return NULL;
    *made = (record){.before = s->last, .step = step};
    if (step) {
        memcpy(step, s->step, 10 * n * sizeof *step);
        clear_step(s);
    }
    s->last = made;
    return made;
}

/* Column j of the step so far: what state j was is now in the nine, and in itself. */
static void advance_column(imk_navigation_smoother *s, const imki_filter_step *by, size_t j,
                           const double *gamma_column)
{
    const size_t n = s->filter->states;
    const double kept = j < ERRORS ? 0.0 : s->step[ERRORS * n + j];
    double now[ERRORS];
    for (size_t i = 0; i < ERRORS; i++)
        now[i] = s->step[i * n + j];
    for (size_t i = 0; i < ERRORS; i++) {
        double sum = gamma_column ? gamma_column[3 * i] * kept : 0.0;
        for (size_t k = 0; k < ERRORS; k++)
            sum += by->phi[i][k] * now[k];
        s->step[i * n + j] = sum;
    }
}

void imki_smoother_step(imk_navigation_smoother *s, const imki_filter_step *by, const double *decay,
                        const imk_vector3 *held_up)
{
    const imk_navigation_filter *f = s->filter;
    const size_t n = f->states, parts = 3 * (f->parts[0] + f->parts[1]);
    for (size_t j = 0; j < n; j++) {
        const size_t part = j - ERRORS;
        const bool is_part = j >= ERRORS && part < parts;
        const int sensor = is_part && part >= 3 * f->parts[0] ? IMKI_ACCEL_PART : IMKI_GYRO_PART;
        advance_column(s, by, j, is_part ? &by->gamma[sensor][0][part % 3] : NULL);
        for (size_t block = 0; block < 6 && held_up; block += 3) {
            double along = 0.0;
            for (size_t i = 0; i < 3; i++)
                along += held_up->v[i] * s->step[(block + i) * n + j];
            for (size_t i = 0; i < 3; i++)
                s->step[(block + i) * n + j] -= along * held_up->v[i];
        }
    }
    for (size_t j = ERRORS; j < n; j++)
        s->step[ERRORS * n + j] *= decay[j - ERRORS];
    s->moved = true;
}

void imki_smoother_update(imk_navigation_smoother *s, const imki_measurement *m, const double *gain,
                          double inverse[3][3])
{
    const size_t n = s->filter->states, size = m->rows * n * sizeof(double);
    record *r = add_record(s);
    if (!r)
        return;
    r->h = take(s, size);
    r->gain = take(s, size);
    if (s->failed)
        return;
    r->rows = m->rows;
    memcpy(r->h, m->h, size);
    memcpy(r->gain, gain, size);
    for (size_t a = 0; a < m->rows; a++)
        for (size_t b = 0; b < m->rows; b++) {
            r->inverse[a][b] = inverse[a][b];
            r->z[a] += inverse[a][b] * m->z[b];
        }
}

/* Row w of what is wanted, out of P: one of nine errors, or a sum of parts. */
static void wanted_row(const imk_navigation_filter *f, size_t w, double *out)
{
    const size_t n = f->states;
    if (w < ERRORS) {
        memcpy(out, f->covariance + w * n, n * sizeof *out);
        return;
    }
    const int sensor = w < ERRORS + 3 ? IMKI_GYRO_PART : IMKI_ACCEL_PART;
    const size_t axis = (w - ERRORS) % 3, first = sensor == IMKI_GYRO_PART ? 0 : f->parts[0];
    memset(out, 0, n * sizeof *out);
    for (size_t p = 0; p < f->parts[sensor]; p++) {
        const double *row = f->covariance + (ERRORS + 3 * (first + p) + axis) * n;
        for (size_t j = 0; j < n; j++)
            out[j] += row[j];
    }
}

bool imk_navigation_smoother_mark(imk_navigation_smoother *s)
{
    imk_navigation_filter *f = s->filter;
    imki_navigation_filter_propagate(f);
    record *r = add_record(s);
    double *rows = r ? take(s, WANTED * f->states * sizeof *rows) : NULL;
    if (!rows)
        return false;
    for (size_t w = 0; w < WANTED; w++)
        wanted_row(f, w, rows + w * f->states);
    r->h = rows;
    r->state = f->strapdown.state;
    r->bias[0] = f->bias_sum[0];
    r->bias[1] = f->bias_sum[1];
    s->points++;
    return true;
}

/* ---- backwards ------------------------------------------------------------------------------ */

typedef struct adjoint {
    size_t n;
    double small[STATES_MAX];              /* l */
    double large[STATES_MAX * STATES_MAX]; /* L */
    double scratch[STATES_MAX * STATES_MAX];
} adjoint;

/* v^T (I - K H), in place */
static void reduce_row(const record *r, size_t n, double *v)
{
    double along[3] = {0};
    for (size_t q = 0; q < r->rows; q++)
        for (size_t i = 0; i < n; i++)
            along[q] += v[i] * r->gain[i * r->rows + q];
    for (size_t q = 0; q < r->rows; q++)
        for (size_t j = 0; j < n; j++)
            v[j] -= along[q] * r->h[q * n + j];
}

static void transpose(size_t n, double *m)
{
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < i; j++) {
            const double other = m[i * n + j];
            m[i * n + j] = m[j * n + i];
            m[j * n + i] = other;
        }
}

static void make_symmetric(size_t n, double *m)
{
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < i; j++)
            m[i * n + j] = m[j * n + i] = 0.5 * (m[i * n + j] + m[j * n + i]);
}

static void before_update(const record *r, adjoint *a)
{
    const size_t n = a->n;
    reduce_row(r, n, a->small);
    for (int side = 0; side < 2; side++) {
        for (size_t i = 0; i < n; i++)
            reduce_row(r, n, a->large + i * n);
        transpose(n, a->large);
    }
    for (size_t q = 0; q < r->rows; q++)
        for (size_t i = 0; i < n; i++) {
            double row = 0.0;
            a->small[i] += r->h[q * n + i] * r->z[q];
            for (size_t p = 0; p < r->rows; p++)
                row += r->inverse[q][p] * r->h[p * n + i];
            for (size_t j = 0; j < n && row != 0.0; j++)
                a->large[i * n + j] += row * r->h[q * n + j];
        }
    make_symmetric(n, a->large);
}

/* v^T A, in place */
static void step_row(const record *r, size_t n, double *v)
{
    double nine[ERRORS];
    memcpy(nine, v, sizeof nine);
    memset(v, 0, sizeof nine);
    for (size_t j = ERRORS; j < n; j++)
        v[j] *= r->step[ERRORS * n + j];
    for (size_t i = 0; i < ERRORS; i++)
        for (size_t j = 0; j < n; j++)
            v[j] += nine[i] * r->step[i * n + j];
}

static void before_step(const record *r, adjoint *a)
{
    step_row(r, a->n, a->small);
    for (int side = 0; side < 2; side++) {
        for (size_t i = 0; i < a->n; i++)
            step_row(r, a->n, a->large + i * a->n);
        transpose(a->n, a->large);
    }
    make_symmetric(a->n, a->large);
}

/* WANTED x WANTED of P - P L P, and P l. */
static void smooth(const imk_navigation_filter *f, const record *r, adjoint *a, double x[WANTED],
                   double covariance[WANTED][WANTED])
{
    const size_t n = a->n;
    for (size_t w = 0; w < WANTED; w++) {
        const double *row = r->h + w * n;
        double *product = a->scratch + w * n; /* of P L */
        memset(product, 0, n * sizeof *product);
        x[w] = 0.0;
        for (size_t k = 0; k < n; k++) {
            x[w] += row[k] * a->small[k];
            for (size_t j = 0; j < n; j++)
                product[j] += row[k] * a->large[k * n + j];
        }
    }
    for (size_t w = 0; w < WANTED; w++)
        for (size_t u = 0; u < WANTED; u++) {
            double sum = 0.0;
            if (u < ERRORS)
                sum = r->h[w * n + u];
            else {
                const int sensor = u < ERRORS + 3 ? IMKI_GYRO_PART : IMKI_ACCEL_PART;
                const size_t first = sensor == IMKI_GYRO_PART ? 0 : f->parts[0];
                for (size_t p = 0; p < f->parts[sensor]; p++)
                    sum += r->h[w * n + ERRORS + 3 * (first + p) + (u - ERRORS) % 3];
            }
            for (size_t j = 0; j < n; j++)
                sum -= a->scratch[w * n + j] * r->h[u * n + j];
            covariance[w][u] = sum;
        }
}

static void give_point(const imk_navigation_filter *f, const record *r, adjoint *a, size_t index,
                       imk_smoothed_point point, void *context)
{
    double x[WANTED], covariance[WANTED][WANTED];
    imk_navigation_filter_estimate e;
    imk_navigation_state state = r->state;
    smooth(f, r, a, x, covariance);
    imk_vector3 turn;
    for (int i = 0; i < 3; i++) {
        state.position.v[i] -= x[i];
        state.velocity.v[i] -= x[3 + i];
        turn.v[i] = -x[6 + i];
        e.gyro_bias.v[i] = r->bias[0].v[i] + x[ERRORS + i];
        e.accel_bias.v[i] = r->bias[1].v[i] + x[ERRORS + 3 + i];
        e.gyro_bias_sigma.v[i] = sqrt(fmax(0.0, covariance[ERRORS + i][ERRORS + i]));
        e.accel_bias_sigma.v[i] = sqrt(fmax(0.0, covariance[ERRORS + 3 + i][ERRORS + 3 + i]));
    }
    state.attitude = imk_quaternion_normalise(
        imk_quaternion_multiply(imk_quaternion_from_rotation_vector(turn), state.attitude));
    imki_estimate_of(&state, &covariance[0][0], WANTED, &e);
    point(context, index, &e);
}

bool imk_navigation_smoother_run(imk_navigation_smoother *s, imk_smoothed_point point,
                                 void *context)
{
    adjoint *a = take(s, sizeof *a);
    if (!a)
        return false;
    size_t index = s->points;
    memset(a, 0, sizeof *a);
    a->n = s->filter->states;
    for (const record *r = s->last; r; r = r->before) {
        if (r->rows > 0)
            before_update(r, a);
        else
            give_point(s->filter, r, a, --index, point, context);
        if (r->step)
            before_step(r, a);
    }
    return true;
}
