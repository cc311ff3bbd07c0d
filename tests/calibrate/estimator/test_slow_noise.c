/* SPDX-License-Identifier: Apache-2.0 */
/* Slow noise in the covariance of a calibration: against Allan variances in closed form, against a
 * dense matrix of covariances, between records, and by coverage over raw logs. */
#include "check.h"

#include "calibrate/coverage.h"
#include "calibrate/slow_units.h"

#include "imukit/linear_algebra.h"
#include "imukit/noise.h"

/* ---- holds of one gyro at known rates -----------------------------------------------------------
 */

enum { HOLDS_MAX = 64, SAMPLES = 6000 };
static const double dt = 0.01, white_sigma = 1e-5;

typedef struct holds {
    imk_calibration calibration;
    imk_calibration_result result;
    imk_observation observation[HOLDS_MAX];
    imk_test_record record[2];
} holds;

static holds shared;

static holds *begin_holds(size_t samples, const double *time)
{
    memset(&shared, 0, sizeof shared);
    imk_calibration_default(&shared.calibration);
    shared.calibration.frame = IMK_FRAME_REFERENCE;
    shared.calibration.observation = shared.observation;
    shared.calibration.observation_capacity = HOLDS_MAX;
    shared.calibration.record_count = 2;
    for (int r = 0; r < 2; r++) {
        shared.record[r] = (imk_test_record){.count = samples, .dt = dt, .time = time};
        shared.record[r].axis_count[IMK_GYRO] = 3;
        shared.calibration.record[r] = &shared.record[r];
    }
    CHECK_OK(imk_calibration_free(&shared.calibration, IMK_GYRO, IMK_MODEL_BIAS, 0, 0));
    return &shared;
}

static void hold(holds *h, int record, size_t begin, size_t end, double rate)
{
    imk_observation o = {.record = record, .begin = begin, .end = end, .fixture = -1};
    for (int sensor = 0; sensor < 2; sensor++)
        for (int axis = 0; axis < IMK_AXES_MAX; axis++)
            o.reading[sensor][axis] = (double)NAN;
    o.reading[IMK_GYRO][0] = o.rate[0] = rate;
    o.sigma[IMK_GYRO][0] = white_sigma;
    assert_true(imk_calibration_observe(&h->calibration, &o) >= 0);
}

static void solve(holds *h)
{
    imk_error error;
    const size_t size = imk_calibration_workspace_size(&h->calibration);
    void *memory = malloc(size);
    CHECK_OK(imk_calibration_solve(&h->calibration, &h->result, memory, size, &error));
    free(memory);
}

/* Beyond what the white noise of one reading, or half of it, leaves. */
static double slow_part(const holds *h, size_t p, double white)
{
    return h->result.sigma[p] * h->result.sigma[p] - white * white_sigma * white_sigma;
}

typedef enum { WALK, FLICKER, MARKOV, KINDS } kind;

/* Sizes that outweigh the white noise. A flicker of stages is that of the formula within 1 %. */
static double state_noise(holds *h, kind which)
{
    imk_noise *noise = &h->calibration.model.gyro.noise;
    if (which == WALK)
        noise->random_walk.value[0] = 1e-3;
    if (which == FLICKER)
        noise->bias_instability.value[0] = 2e-3;
    if (which == MARKOV) {
        noise->gauss_markov_count = 1;
        noise->gauss_markov[0].sigma.value[0] = 1.5e-3;
        noise->gauss_markov[0].correlation_time.value[0] = 30.0;
    }
    return which == FLICKER ? 0.01 : 1e-9;
}

static double allan_variance(kind which, double tau)
{
    return which == WALK ? imk_random_walk_allan_variance(1e-3, tau)
           : which == FLICKER
               ? imk_flicker_allan_variance(2e-3, tau)
               : imk_gauss_markov_allan_variance(
                     (imk_gauss_markov){.sigma = 1.5e-3, .correlation_time = 30.0}, tau);
}

/* One hold over the first half of a record: the bias is off from that during the record by half the
 * difference of two means side by side, whose mean square is twice the Allan variance. */
static void test_half_of_a_record(void **state)
{
    (void)state;
    for (int k = 0; k < KINDS; k++) {
        holds *h = begin_holds(4000, NULL);
        const double tolerance = state_noise(h, (kind)k);
        hold(h, 0, 0, 2000, 0.0);
        solve(h);
        CHECK_RELATIVE(slow_part(h, 0, 1.0), 0.5 * allan_variance((kind)k, 20.0), tolerance);
        assert_true(isinf(h->result.freedom[0]));
    }
}

/* Two holds side by side at rates of both signs: the scale factor takes half of their difference;
 * their mean is that of the record, and the bias is as good as without slow noise. */
static void test_two_holds(void **state)
{
    (void)state;
    for (int k = 0; k < KINDS; k++) {
        holds *h = begin_holds(3000, NULL);
        const double tolerance = state_noise(h, (kind)k);
        CHECK_OK(imk_calibration_free(&h->calibration, IMK_GYRO, IMK_MODEL_SCALE_FACTOR, 0, 0));
        hold(h, 0, 1500, 3000, -1.0); /* out of order */
        hold(h, 0, 0, 1500, 1.0);
        solve(h);
        CHECK_RELATIVE(slow_part(h, 1, 0.5), 0.5 * allan_variance((kind)k, 15.0), tolerance);
        CHECK_CLOSE(slow_part(h, 0, 0.5), 0.0, 1e-9 * allan_variance((kind)k, 15.0));
    }
    /* K^2 (d + 2 h/3) for a random walk with a pause d between. */
    holds *h = begin_holds(5000, NULL);
    (void)state_noise(h, WALK);
    CHECK_OK(imk_calibration_free(&h->calibration, IMK_GYRO, IMK_MODEL_SCALE_FACTOR, 0, 0));
    hold(h, 0, 500, 1500, 1.0);
    hold(h, 0, 3500, 4500, -1.0);
    solve(h);
    CHECK_RELATIVE(slow_part(h, 1, 0.5), 0.25 * 1e-6 * (20.0 + 20.0 / 3.0), 1e-9);
}

/* ---- against a dense matrix ------------------------------------------------------------------ */

/* Second antiderivative of the covariance over a time difference; of flicker and random walk the
 * generalised one, -B^2/pi ln|t| and -K^2 |t|/2 [MATHERON1973]. */
static double twice_integrated(kind which, double t)
{
    const double x = fabs(t);
    if (which == WALK)
        return -1e-6 * x * x * x / 12.0;
    if (which == FLICKER)
        return x > 0.0 ? -4e-6 / session_pi * x * x * (0.5 * log(x) - 0.75) : 0.0;
    return 2.25e-6 * (30.0 * x + 900.0 * exp(-x / 30.0));
}

/* Covariance of means over two stretches, which may overlap. */
static double covariance_of_means(kind which, const double a[2], const double b[2])
{
    return (twice_integrated(which, a[1] - b[0]) + twice_integrated(which, a[0] - b[1]) -
            twice_integrated(which, a[1] - b[1]) - twice_integrated(which, a[0] - b[0])) /
           ((a[1] - a[0]) * (b[1] - b[0]));
}

/* N^-1 A^T C A N^-1, all weights alike, less 1 for the mean over the record from the bias. */
static void expected_covariance(kind which, size_t n, const double (*at)[2], const double (*row)[4],
                                double length, double out[16])
{
    double normal[16] = {0.0}, inverse[16], influence[HOLDS_MAX + 1][4];
    const double whole[2] = {0.0, length};
    for (size_t i = 0; i < n; i++)
        for (int p = 0; p < 4; p++)
            for (int q = 0; q < 4; q++)
                normal[4 * p + q] += row[i][p] * row[i][q];
    CHECK_OK(imk_cholesky_factor(4, normal));
    imk_cholesky_inverse(4, normal, inverse);
    memset(influence, 0, sizeof influence);
    for (size_t i = 0; i < n; i++)
        for (int p = 0; p < 4; p++)
            for (int q = 0; q < 4; q++)
                influence[i][p] += inverse[4 * p + q] * row[i][q];
    influence[n][0] = -1.0;
    for (int p = 0; p < 16; p++)
        out[p] = inverse[p] * white_sigma * white_sigma;
    for (size_t i = 0; i <= n; i++)
        for (size_t j = 0; j <= n; j++) {
            const double c =
                covariance_of_means(which, i < n ? at[i] : whole, j < n ? at[j] : whole);
            for (int p = 0; p < 16; p++)
                out[p] += influence[i][p / 4] * c * influence[j][p % 4];
        }
}

/* Bias, scale factor, K2, K3 from six uneven holds, and times that begin at 1000 s with a gap. Two
 * degrees of freedom: the factor is 1. */
static void test_dense(void **state)
{
    (void)state;
    static const size_t begin[6] = {100, 700, 1500, 2200, 3900, 5000};
    static const size_t end[6] = {500, 1400, 1700, 3800, 4700, 5900};
    static const double rate[6] = {0.0, 1.0, -1.0, 2.0, -2.0, 0.5};
    static double time[SAMPLES];
    for (size_t k = 0; k < SAMPLES; k++)
        time[k] = 1000.0 + dt * (double)(k + 1) + (k >= 3850 ? 15.0 : 0.0);
    for (int k = 0; k < KINDS; k++) {
        double at[6][2], row[6][4], expected[16];
        holds *h = begin_holds(SAMPLES, time);
        const double tolerance = state_noise(h, (kind)k);
        CHECK_OK(imk_calibration_free(&h->calibration, IMK_GYRO, IMK_MODEL_SCALE_FACTOR, 0, 0));
        CHECK_OK(imk_calibration_free(&h->calibration, IMK_GYRO, IMK_MODEL_K2, 0, 0));
        CHECK_OK(imk_calibration_free(&h->calibration, IMK_GYRO, IMK_MODEL_K3, 0, 0));
        for (int i = 0; i < 6; i++) {
            hold(h, 0, begin[i], end[i], rate[i]);
            at[i][0] = time[begin[i]] - dt - 1000.0;
            at[i][1] = time[end[i] - 1] - 1000.0;
            for (int p = 0; p < 4; p++)
                row[i][p] = pow(rate[i], p);
        }
        solve(h);
        expected_covariance((kind)k, 6, (const double(*)[2])at, (const double(*)[4])row, 75.0,
                            expected);
        for (size_t p = 0; p < 4; p++)
            for (size_t q = 0; q < 4; q++)
                CHECK_CLOSE(h->result.covariance[4 * p + q], expected[4 * p + q],
                            2.0 * tolerance * sqrt(expected[5 * p] * expected[5 * q]));
    }
}

/* ---- what is left alone ---------------------------------------------------------------------- */

static double sigma_with(bool stated, int record, bool correlated)
{
    holds *h = begin_holds(3000, NULL);
    if (stated)
        (void)state_noise(h, MARKOV);
    hold(h, record, 0, 1000, 0.0);
    h->observation[0].correlated = correlated;
    solve(h);
    return h->result.sigma[0];
}

/* White noise alone, readings without a record, and sigmas that have it already: to the bit as
 * before. */
static void test_nothing_slow(void **state)
{
    (void)state;
    const double plain = sigma_with(false, 0, false);
    CHECK_RELATIVE(plain, white_sigma, 1e-12);
    assert_true(sigma_with(true, -1, false) == plain);
    assert_true(sigma_with(true, 0, true) == plain);
    CHECK_BELOW(10.0 * plain, sigma_with(true, 0, false));
    /* A process much quicker than the hold is white noise of its mean. */
    holds *h = begin_holds(3000, NULL);
    (void)state_noise(h, MARKOV);
    h->calibration.model.gyro.noise.gauss_markov[0].correlation_time.value[0] = 0.1;
    hold(h, 0, 0, 1000, 0.0);
    solve(h);
    assert_true(h->result.sigma[0] == plain);
}

/* One rate in each of two records that their holds fill: the scale factor takes half of the
 * difference of their levels, each K^2 L/3 from where the walk began; the bias is their mean. */
static void test_two_records(void **state)
{
    (void)state;
    holds *h = begin_holds(3000, NULL);
    (void)state_noise(h, WALK);
    CHECK_OK(imk_calibration_free(&h->calibration, IMK_GYRO, IMK_MODEL_SCALE_FACTOR, 0, 0));
    hold(h, 0, 0, 3000, 1.0);
    hold(h, 1, 0, 3000, -1.0);
    solve(h);
    CHECK_RELATIVE(slow_part(h, 1, 0.5), 0.25 * 2.0 * 1e-6 * 30.0 / 3.0, 1e-9);
    CHECK_CLOSE(slow_part(h, 0, 0.5), 0.0, 1e-14);
}

/* ---- poses under gravity -----------------------------------------------------------------------
 */

/* 27 holds of 3 s, faces, edges and corners, one second between, accelerometers with white noise
 * and a random walk that a hold's mean is drawn from: the mean over [b, b + h] of a walk is the
 * walk at b, plus h/2 of what it walks in all, plus a part of variance K^2 h/12 of its own. */
static void poses(holds *h, uint64_t seed, imk_model *truth)
{
    enum { POSES = 26 };
    static double normal[16384];
    size_t used = 0;
    const double step = 3e-4, white = 2e-4, length = 3.0, pause = 1.0;
    imk_random_normals(imk_random_seeded(seed), imk_stream(0, 900, 0, 0), 0, 16384, normal);
    imk_model_default(truth);
    begin_holds(100 * 4 * POSES, NULL);
    h->calibration.parameter_count = 0;
    h->calibration.frame = IMK_FRAME_UPPER;
    h->record[0].axis_count[IMK_ACCEL] = 3;
    double place[3] = {0.0}, mean[POSES][3], overall[3] = {0.0};
    for (int axis = 0; axis < 3; axis++) {
        h->calibration.model.accel.noise.random_walk.value[axis] = step;
        CHECK_OK(imk_calibration_free(&h->calibration, IMK_ACCEL, IMK_MODEL_BIAS, axis, 0));
        CHECK_OK(imk_calibration_free(&h->calibration, IMK_ACCEL, IMK_MODEL_SCALE_FACTOR, axis, 0));
        for (int j = axis + 1; j < 3; j++)
            CHECK_OK(
                imk_calibration_free(&h->calibration, IMK_ACCEL, IMK_MODEL_MISALIGNMENT, axis, j));
    }
    for (int i = 0; i < POSES; i++)
        for (int axis = 0; axis < 3; axis++)
            for (int part = 0; part < 2; part++) {
                const double time = part == 0 ? length : pause;
                const double walked = step * sqrt(time) * normal[used++];
                const double own = step * sqrt(time / 12.0) * normal[used++];
                const double middle = place[axis] + 0.5 * walked + own;
                if (part == 0)
                    mean[i][axis] = middle;
                overall[axis] += middle * time / (POSES * (length + pause));
                place[axis] += walked;
            }
    for (int i = 0, code = 0; i < POSES; i++, code++) {
        if (code == 13)
            code++; /* no direction */
        const double v[3] = {code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1};
        const double size = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        hold(h, 0, (size_t)i * 400, (size_t)i * 400 + 300, 0.0);
        imk_observation *o = &h->observation[i];
        o->knowledge = IMK_INPUT_GRAVITY;
        o->reading[IMK_GYRO][0] = (double)NAN;
        for (int axis = 0; axis < 3; axis++) {
            o->sigma[IMK_ACCEL][axis] = white;
            o->reading[IMK_ACCEL][axis] =
                h->calibration.gravity * v[axis] / size + mean[i][axis] + white * normal[used++];
        }
    }
    for (int axis = 0; axis < 3; axis++)
        truth->accel.bias.fixed.value[axis] = overall[axis];
}

/* ---- coverage ----------------------------------------------------------------------------------
 */

/* Probability of at most k of n. */
static double binomial_below(size_t n, double p, size_t k)
{
    double sum = 0.0;
    for (size_t i = 0; i <= k; i++)
        sum +=
            exp(lgamma((double)n + 1.0) - lgamma((double)i + 1.0) - lgamma((double)(n - i) + 1.0) +
                (double)i * log(p) + (double)(n - i) * log(1.0 - p));
    return sum;
}

/* Each parameter is held in 93 % or more, false alarm 1e-6 over all; and all together in 93 to 97
 * %: they share a log and are not independent, their number counts as a tenth (4.9 sigma: 1e-6). */
static void assess(const coverage_count *count)
{
    double held = 0.0;
    for (size_t p = 0; p < count->parameter_count; p++) {
        held += coverage_share(count, p) / (double)count->parameter_count;
        if (binomial_below(count->benches, 0.93, count->held[p]) <
            1e-6 / (double)count->parameter_count) {
            coverage_print(count, stderr);
            fail_msg("parameter %zu is held in %zu of %zu", p, count->held[p], count->benches);
        }
        CHECK_BELOW(fabs(coverage_bias(count, p)), 0.2 + 5.6 / sqrt((double)count->benches));
    }
    const double independent = (double)count->benches * (double)count->parameter_count / 10.0;
    const double margin = 4.9 * sqrt(0.95 * 0.05 / independent);
    CHECK_BELOW(0.93 - margin, held);
    CHECK_BELOW(held, 0.97 + margin);
}

/* Raw logs; without the noise stated the same benches hold asymmetry and g-sensitivity in 60 to 80
 * %. */
static void cover(imk_procedure procedure, void (*programme)(session *),
                  void (*slower)(imk_model *), uint32_t benches)
{
    session *b = malloc(sizeof *b);
    coverage_count count = {0};
    imk_error error;
    assert_non_null(b);
    session_start(b, procedure, programme);
    b->settings.nonlinear = true;
    b->slower = slower;
    b->noise_known = true;
    for (uint32_t i = 0; i < check_runs(benches); i++) {
        session_log(b, 7000 + i, 0.0);
        CHECK_OK(session_solve(b, &error));
        coverage_add(&count, &b->result, &b->truth, 0.95);
    }
    assess(&count);
    free(b->workspace);
    free(b);
}

static void test_rate_table(void **state)
{
    (void)state;
    cover(IMK_PROCEDURE_RATE_TABLE, session_rate_steps, slow_flicker, 70);
}

static void test_tumble(void **state)
{
    (void)state;
    cover(IMK_PROCEDURE_TUMBLE, session_tumble, slow_all, 60);
}

static void test_poses(void **state)
{
    (void)state;
    coverage_count count = {0};
    for (uint32_t i = 0; i < check_runs(150); i++) {
        imk_model truth;
        poses(&shared, 8000 + i, &truth);
        solve(&shared);
        coverage_add(&count, &shared.result, &truth, 0.95);
    }
    assess(&count);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_half_of_a_record),
        cmocka_unit_test(test_two_holds),
        cmocka_unit_test(test_dense),
        cmocka_unit_test(test_nothing_slow),
        cmocka_unit_test(test_two_records),
        cmocka_unit_test(test_poses),
        cmocka_unit_test(test_rate_table),
        cmocka_unit_test(test_tumble),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
