/* SPDX-License-Identifier: Apache-2.0 */
/* Smoothing against the batch solution of the same linear problem, and what it may not be asked. */
#include "check.h"

#include "navigate/filter/navigation_smoother_internal.h"

#include "imukit/linear_algebra.h"

#include <stdlib.h>
#include <string.h>

enum { N = 18, ROWS_MOST = 3, INSTANTS = 9, DATA = 45, WANTED = 9 };

static void *room(size_t size, void *context)
{
    void *memory = malloc(size);
    void **list = context;
    assert_non_null(memory);
    *(void **)&list[(size_t)list[0]] = memory;
    list[0] = (char *)list[0] + 1;
    return memory;
}

static void *none(size_t size, void *context)
{
    (void)context;
    (void)size;
    return NULL;
}

/* ---- the batch -------------------------------------------------------------------------------
 */

/* Of each record: the transition to it, its covariance before and after, what it measured. */
typedef struct instant {
    size_t rows;
    double a[N][N], before[N][N], after[N][N];
    double h[ROWS_MOST][N], gain[N][ROWS_MOST], z[ROWS_MOST], noise[ROWS_MOST][ROWS_MOST];
    double filtered[WANTED]; /* position, velocity, attitude: of the estimate, as vectors */
} instant;

static void times(double a[N][N], double b[N][N], double out[N][N])
{
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++) {
            out[i][j] = 0.0;
            for (int k = 0; k < N; k++)
                out[i][j] += a[i][k] * b[k][j];
        }
}

static void times_transposed(double a[N][N], double b[N][N], double out[N][N])
{
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++) {
            out[i][j] = 0.0;
            for (int k = 0; k < N; k++)
                out[i][j] += a[i][k] * b[j][k];
        }
}

/* The step of a record as a whole matrix. */
static void whole_step(const imki_smoother_record *r, double a[N][N])
{
    memset(a, 0, sizeof(double[N][N]));
    for (int i = 0; i < N; i++)
        a[i][i] = r->step && i >= 9 ? r->step[9 * N + i] : 1.0;
    for (int i = 0; i < 9 && r->step; i++)
        memcpy(a[i], r->step + i * N, N * sizeof(double));
}

/* R = S - H P H^T, S from the inverse that the record has. */
static void take_noise(const imki_smoother_record *r, instant *t)
{
    double factor[9], s[9];
    for (size_t k = 0; k < r->rows * r->rows; k++)
        factor[k] = r->inverse[k / r->rows][k % r->rows];
    assert_int_equal(imk_cholesky_factor(r->rows, factor), IMK_OK);
    imk_cholesky_inverse(r->rows, factor, s);
    for (size_t p = 0; p < r->rows; p++)
        for (size_t q = 0; q < r->rows; q++) {
            t->noise[p][q] = s[p * r->rows + q];
            for (int i = 0; i < N; i++)
                for (int j = 0; j < N; j++)
                    t->noise[p][q] -= t->h[p][i] * t->before[i][j] * t->h[q][j];
            t->z[p] += s[p * r->rows + q] * r->z[q];
        }
}

/* Prior covariances of the errors at all instants without any update, cross[i][j] for i <= j: the
 * noise of a step is what the filter added to its covariance. */
static double cross[INSTANTS][INSTANTS][N][N];
static void make_prior(instant *t)
{
    double left[N][N], turned[N][N];
    memcpy(cross[0][0], t[0].before, sizeof cross[0][0]);
    for (int k = 1; k < INSTANTS; k++) {
        times(t[k].a, cross[k - 1][k - 1], left);
        times_transposed(left, t[k].a, cross[k][k]);
        times(t[k].a, t[k - 1].after, left);
        times_transposed(left, t[k].a, turned);
        for (int i = 0; i < N; i++)
            for (int j = 0; j < N; j++)
                cross[k][k][i][j] += t[k].before[i][j] - turned[i][j];
        for (int i = 0; i < k; i++)
            times_transposed(cross[i][k - 1], t[k].a, cross[i][k]);
    }
}

static double cross_of(int a, int b, int i, int j)
{
    return a <= b ? cross[a][b][i][j] : cross[b][a][j][i];
}

/* All data as of errors that nobody took out: y = z + H a, a what was taken out before. The
 * estimate of all errors at all instants from all of them, less what was taken out by then. */
static void solve_batch(instant *t, double x[INSTANTS][N])
{
    static double s[DATA * DATA], y[DATA], taken[INSTANTS][N];
    int first[INSTANTS], data = 0;
    for (int k = 0; k < INSTANTS; k++) {
        double before[N] = {0};
        for (int i = 0; i < N && k > 0; i++)
            for (int j = 0; j < N; j++)
                before[i] += t[k].a[i][j] * taken[k - 1][j];
        memcpy(taken[k], before, sizeof before);
        first[k] = data;
        for (size_t r = 0; r < t[k].rows; r++, data++) {
            y[data] = t[k].z[r];
            for (int i = 0; i < N; i++) {
                y[data] += t[k].h[r][i] * before[i];
                taken[k][i] += t[k].gain[i][r] * t[k].z[r];
            }
        }
    }
    assert_true(data <= DATA);
    for (int a = 0; a < INSTANTS; a++)
        for (int b = 0; b < INSTANTS; b++)
            for (size_t r = 0; r < t[a].rows; r++)
                for (size_t q = 0; q < t[b].rows; q++) {
                    double sum = a == b ? t[a].noise[r][q] : 0.0;
                    for (int i = 0; i < N; i++)
                        for (int j = 0; j < N; j++)
                            sum += t[a].h[r][i] * cross_of(a, b, i, j) * t[b].h[q][j];
                    s[((size_t)first[a] + r) * (size_t)data + (size_t)first[b] + q] = sum;
                }
    assert_int_equal(imk_cholesky_factor((size_t)data, s), IMK_OK);
    imk_cholesky_solve((size_t)data, s, y);
    for (int a = 0; a < INSTANTS; a++)
        for (int i = 0; i < N; i++) {
            x[a][i] = -taken[a][i];
            for (int b = 0; b < INSTANTS; b++)
                for (size_t q = 0; q < t[b].rows; q++)
                    for (int j = 0; j < N; j++)
                        x[a][i] += cross_of(a, b, i, j) * t[b].h[q][j] * y[(size_t)first[b] + q];
        }
}

/* ---- the filter ------------------------------------------------------------------------------
 */

static void note(instant *t, imk_navigation_filter *f, bool after)
{
    assert_int_equal(f->states, N);
    memcpy(after ? t->after : t->before, imki_navigation_filter_covariance(f),
           sizeof(double[N][N]));
    memcpy(t->filtered, f->strapdown.state.position.v, 3 * sizeof(double));
    memcpy(t->filtered + 3, f->strapdown.state.velocity.v, 3 * sizeof(double));
}

typedef struct smoothed {
    instant *instants;
    double (*batch)[N];
    size_t points;
    double worst, last_sigma;
} smoothed;

/* Point k is instant 2 k: the position and the velocity are those of the batch, to 1e-8 of sigma.
 */
static void check_point(void *context, size_t index, const imk_navigation_filter_estimate *e)
{
    smoothed *s = context;
    const instant *t = &s->instants[2 * index];
    s->points++;
    for (int i = 0; i < 3; i++) {
        const double *x = s->batch[2 * index];
        const double sigma = sqrt(e->covariance[i][i]), speed = sqrt(e->covariance[3 + i][3 + i]);
        s->worst = fmax(s->worst, fabs(t->filtered[i] - e->state.position.v[i] - x[i]) / sigma);
        s->worst =
            fmax(s->worst, fabs(t->filtered[3 + i] - e->state.velocity.v[i] - x[3 + i]) / speed);
    }
    /* Later readings only help: the start, smoothed, is known better than filtered. */
    if (index == 0)
        s->last_sigma = sqrt(e->covariance[0][0]);
}

static void test_batch(void **state)
{
    (void)state;
    static double memory[20000], batch[INSTANTS][N];
    static instant t[INSTANTS];
    static void *rooms[200];
    rooms[0] = (void *)(size_t)1;
    imk_navigation_filter_settings s;
    imk_navigation_filter_default(&s);
    s.gyro.part_count = s.accel.part_count = 1;
    s.step = 0.5;
    s.aid_count = 2;
    s.aid[0] = imk_aid_default(IMK_AID_POSITION);
    s.aid[1] = imk_aid_default(IMK_AID_VELOCITY);
    s.aid[0].correlation_time = 20.0;
    for (int i = 0; i < 3; i++) {
        s.gyro.white[i] = 1e-4;
        s.accel.white[i] = 1e-3;
        s.gyro.part[0].sigma[i] = 1e-4;
        s.accel.part[0].sigma[i] = i == 2 ? 0.0 : 0.02; /* a singular covariance */
        s.accel.part[0].correlation_time = 60.0;
        s.aid[0].correlated_sigma[i] = 0.7;
        s.aid[1].sigma[i] = 0.1;
        s.initial_sigma[i] = 5.0;
        s.initial_sigma[3 + i] = 1.0;
        s.initial_sigma[6 + i] = 0.02;
    }
    const imk_geodetic place = {0.6, 0.2, 0.0};
    const imk_navigation_state start =
        imk_navigation_state_ned(0.0, place, (imk_vector3){{0}}, imk_matrix3_identity());
    imk_navigation_filter *f;
    imk_error error;
    assert_true(imk_navigation_filter_size(&s) <= sizeof memory);
    CHECK_OK(imk_navigation_filter_start(&s, &start, &f, memory, sizeof memory, &error));
    imk_navigation_smoother *smoother = imk_navigation_smoother_start(f, room, rooms);
    assert_non_null(smoother);
    int k = 0;
    const double up = -imk_normal_gravity(place.latitude, 0.0);
    for (int second = 0; k < INSTANTS; second++) {
        note(&t[k], f, false);
        note(&t[k++], f, true);
        assert_true(imk_navigation_smoother_mark(smoother));
        if (k == INSTANTS)
            break;
        for (int step = 0; step < 20; step++)
            imk_navigation_filter_step(f, 0.1,
                                       imk_vector3_scale(imk_earth_rate(place.latitude), 0.1),
                                       (imk_vector3){{0.002 * step, -0.001, up * 0.1}});
        note(&t[k], f, false);
        const size_t aid = second % 2 == 0 ? 0 : 1;
        const imk_aid_reading reading = {
            .time = imk_navigation_filter_state(f).time - 0.03,
            .value = {aid == 0 ? 0.6 + 1e-7 * second : 0.1, aid == 0 ? 0.2 : -0.2, 0.3}};
        assert_int_equal(imk_navigation_filter_aid(f, aid, &reading), IMK_AID_USED);
        note(&t[k++], f, true);
    }
    const imki_smoother_record *r = imki_smoother_last(smoother);
    for (int at = INSTANTS - 1; at >= 0; at--, r = r->before) {
        assert_non_null(r);
        whole_step(r, t[at].a);
        t[at].rows = r->rows;
        for (size_t q = 0; q < r->rows; q++)
            for (size_t i = 0; i < N; i++) {
                t[at].h[q][i] = r->h[q * N + i];
                t[at].gain[i][q] = r->gain[i * r->rows + q];
            }
        if (r->rows > 0)
            take_noise(r, &t[at]);
    }
    assert_null(r);
    make_prior(t);
    solve_batch(t, batch);
    smoothed result = {.instants = t, .batch = batch};
    assert_true(imk_navigation_smoother_run(smoother, check_point, &result));
    assert_int_equal(result.points, (INSTANTS + 1) / 2);
    print_message("off the batch by %.2e sigma at most; the start is known to %.3f m\n",
                  result.worst, result.last_sigma);
    CHECK_BELOW(result.worst, 1e-8);
    CHECK_BELOW(result.last_sigma, 2.0); /* of 5 m, by readings of 1 m */
    for (size_t i = 1; i < (size_t)rooms[0]; i++)
        free(rooms[i]);
}

/* Without memory, and with a rotation that is used, there is no recording. */
static void test_refusals(void **state)
{
    (void)state;
    static double memory[4000];
    imk_navigation_filter_settings s;
    imk_navigation_filter_default(&s);
    const imk_navigation_state start = imk_navigation_state_ned(
        0.0, (imk_geodetic){0.6, 0.2, 0.0}, (imk_vector3){{0}}, imk_matrix3_identity());
    imk_navigation_filter *f;
    imk_error error;
    CHECK_OK(imk_navigation_filter_start(&s, &start, &f, memory, sizeof memory, &error));
    assert_null(imk_navigation_smoother_start(f, none, NULL));
    s.rotation_sigma = 1e-5;
    CHECK_OK(imk_navigation_filter_start(&s, &start, &f, memory, sizeof memory, &error));
    static void *rooms[2];
    rooms[0] = (void *)(size_t)1;
    assert_null(imk_navigation_smoother_start(f, room, rooms));
    assert_int_equal((size_t)rooms[0], 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_batch),
                                       cmocka_unit_test(test_refusals)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
