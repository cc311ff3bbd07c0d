/* SPDX-License-Identifier: Apache-2.0 */
/* Vibration: lines alone in closed form, and random vibration of a given density. */
#include "check.h"

#include "imukit/elementary.h"
#include "imukit/fourier.h"
#include "imukit/motion.h"

#include <string.h>

static const double two_pi = 6.283185307179586477;

static imk_trajectory still(imk_trajectory_piece *piece, const imk_vibration_line *line,
                            size_t count)
{
    static const double level[3] = {0.0, 0.0, 0.0};
    imk_trajectory trajectory;
    CHECK_OK(imk_trajectory_standstill((imk_geodetic){0.0, 0.0, 0.0}, level, false, piece,
                                       &trajectory, NULL));
    trajectory.line = line;
    trajectory.line_count = count;
    return trajectory;
}

/* d = A sin(w t + p) along z: f = -A w^2 sin(w t + p), whose mean is A w (cos)|/dt. */
static void test_displacement(void **state)
{
    (void)state;
    const double amplitude = 1e-4, frequency = 173.0, phase = 0.3, w = two_pi * frequency;
    const imk_vibration_line line = {2, amplitude, frequency, phase};
    imk_trajectory_piece piece;
    const imk_trajectory trajectory = still(&piece, &line, 1);
    const double dt = 1e-3;
    const size_t parts = imk_trajectory_substeps(&trajectory, dt);
    assert_int_equal(parts, 3);
    enum { COUNT = 600 };
    double boundary[COUNT + 1], out[6][COUNT];
    double *const rate[] = {out[0], out[1], out[2]}, *const force[] = {out[3], out[4], out[5]};
    for (int k = 0; k <= COUNT; k++)
        boundary[k] = 5.0 + dt / (double)parts * k;
    imk_trajectory_means(&trajectory, IMK_KERNEL_SCALAR, COUNT, boundary, rate, NULL, force);
    for (int k = 0; k < COUNT; k++) {
        const double t0 = boundary[k], t1 = boundary[k + 1];
        const double begin = cos(w * t0 + two_pi * phase), end = cos(w * t1 + two_pi * phase);
        /* of 118 m/s^2; the times are rounded to 1e-15 s */
        CHECK_CLOSE(force[2][k], amplitude * w * (end - begin) / (t1 - t0), 2e-9);
        CHECK_CLOSE(force[0][k], 0.0, 0.0);
        CHECK_CLOSE(rate[1][k], 0.0, 0.0);
        imk_motion_state at;
        imk_trajectory_state(&trajectory, t0, &at);
        CHECK_CLOSE(at.position.v[2], amplitude * sin(w * t0 + two_pi * phase), 1e-15);
        CHECK_CLOSE(at.velocity.v[2], amplitude * w * begin, 1e-12);
    }
}

/* A rotation about y: the angle is the line, exactly, and so the rate its derivative. */
static void test_rotation(void **state)
{
    (void)state;
    const imk_vibration_line line = {4, 0.1, 3.0, -0.1};
    const double w = two_pi * line.frequency;
    imk_trajectory_piece piece;
    const imk_trajectory trajectory = still(&piece, &line, 1);
    for (double t = -3.0; t < 3.0; t += 0.0731) {
        imk_motion_state at;
        imk_trajectory_state(&trajectory, t, &at);
        const double x = w * t + two_pi * line.phase;
        CHECK_CLOSE(at.attitude.y, sin(0.05 * sin(x)), 1e-15);
        CHECK_CLOSE(at.angular_rate.v[1], 0.1 * w * cos(x), 5e-14);
        CHECK_CLOSE(at.angular_acceleration.v[1], -0.1 * w * w * sin(x), 1e-12);
        CHECK_CLOSE(at.angular_rate.v[0], 0.0, 0.0);
    }
}

/* Two rotations in quadrature are a coning motion: no axis turns round, yet there is a mean rate
 * about the third one. First about x by a cos(w t), then about y by a sin(w t), so
 *
 *     w_z = -a w sin(w t) sin(a sin(w t)),   of mean  -a w J1(a) = -a^2 w/2 (1 - a^2/8 + ...)  */
static void test_coning(void **state)
{
    (void)state;
    const double a = 0.02, f = 10.0;
    const imk_vibration_line line[] = {{3, a, f, 0.25}, {4, a, f, 0.0}};
    imk_trajectory_piece piece;
    const imk_trajectory trajectory = still(&piece, line, 2);
    enum { COUNT = 160 };
    double boundary[COUNT + 1], out[6][COUNT], mean = 0.0;
    double *const rate[] = {out[0], out[1], out[2]}, *const force[] = {out[3], out[4], out[5]};
    for (int k = 0; k <= COUNT; k++)
        boundary[k] = 0.1 * k / COUNT;
    imk_trajectory_means(&trajectory, IMK_KERNEL_SCALAR, COUNT, boundary, rate, NULL, force);
    for (int k = 0; k < COUNT; k++)
        mean += rate[2][k] / COUNT;
    /* the next term of the series is a^4/192 = 8e-10 */
    CHECK_RELATIVE(mean, -0.5 * a * a * two_pi * f * (1.0 - a * a / 8.0), 2e-9);
}

/* ---- random vibration ------------------------------------------------------------------------ */

/* Rising, flat, falling, and a fall of exactly 1/f, in (m/s^2)^2/Hz. */
static const double corner[] = {20.0, 80.0, 350.0, 600.0, 1200.0};
static const double density[] = {0.5, 2.0, 2.0, 1.0, 0.5};
enum { CORNERS = 5, LINES = 512 };

static double density_at(double f)
{
    for (int i = 0; i + 1 < CORNERS; i++)
        if (f >= corner[i] && f <= corner[i + 1])
            return density[i] * pow(f / corner[i], log(density[i + 1] / density[i]) /
                                                       log(corner[i + 1] / corner[i]));
    return 0.0;
}

/* Power between two frequencies, by the trapezium rule with 0.01 Hz. */
static double power_between(double first, double last)
{
    double sum = 0.0;
    const int steps = (int)((last - first) / 0.01) + 1;
    const double step = (last - first) / steps;
    for (int i = 0; i < steps; i++)
        sum += 0.5 * step * (density_at(first + i * step) + density_at(first + (i + 1) * step));
    return sum;
}

static void make_lines(uint64_t seed, uint64_t stream, imk_vibration_line line[LINES])
{
    CHECK_OK(imk_vibration_from_density(0, CORNERS, corner, density, imk_random_seeded(seed),
                                        stream, LINES, line, NULL));
}

/* Each part of equal power has its line: below any frequency the lines hold the power of the
 * density to one part, and together all of it. */
static void test_lines_hold_the_power(void **state)
{
    (void)state;
    imk_vibration_line line[LINES];
    make_lines(1, 7, line);
    const double total = power_between(corner[0], corner[CORNERS - 1]);
    double held = 0.0;
    for (int i = 0; i < LINES; i++) {
        const double rate = two_pi * line[i].frequency;
        const double a = line[i].amplitude * rate * rate;
        assert_true(i == 0 || line[i].frequency > line[i - 1].frequency);
        assert_true(line[i].phase > 0.0 && line[i].phase < 1.0);
        assert_int_equal(line[i].axis, 0);
        if (i % 16 == 0) { /* i parts lie below the line, i + 1 do not */
            const double below = power_between(corner[0], line[i].frequency) / total * LINES;
            assert_true(below > i - 1e-3 && below < i + 1 + 1e-3);
        }
        held += 0.5 * a * a;
    }
    CHECK_RELATIVE(held, total, 1e-7); /* of the trapezium rule */
}

enum { SEGMENT = 4096, SEGMENTS = 15, RECORD = SEGMENT * (SEGMENTS + 1) / 2, BANDS = 8 };
static const double sample_rate = 4096.0;

/* The force of a record at points in time. */
static void sample_force(const imk_vibration_line *line, double *force)
{
    for (int k = 0; k < RECORD; k++) {
        double sum = 0.0;
        for (int i = 0; i < LINES; i++) {
            const double w = two_pi * line[i].frequency;
            const double x = w * k / sample_rate + two_pi * line[i].phase;
            sum -= line[i].amplitude * w * w * imk_sin(x);
        }
        force[k] = sum;
    }
}

/* Power in bands by Welch's method: segments that overlap by half, with Hann windows; one bin is
 * 1 Hz wide. */
static void welch(const double *force, const double edge[BANDS + 1], double power[BANDS])
{
    static double data[2 * SEGMENT], workspace[40 * SEGMENT];
    const size_t size = imk_fourier_workspace_size(SEGMENT);
    assert_true(size <= sizeof workspace);
    memset(power, 0, BANDS * sizeof *power);
    for (int segment = 0; segment < SEGMENTS; segment++) {
        for (int k = 0; k < SEGMENT; k++) {
            const double window = 0.5 - 0.5 * cos(two_pi * k / SEGMENT);
            data[2 * k] = window * force[segment * SEGMENT / 2 + k];
            data[2 * k + 1] = 0.0;
        }
        CHECK_OK(imk_fourier(SEGMENT, data, 0, workspace, size));
        for (int k = 1; k < SEGMENT / 2; k++)
            for (int band = 0; band < BANDS; band++)
                if (k >= edge[band] && k < edge[band + 1])
                    power[band] += (data[2 * k] * data[2 * k] + data[2 * k + 1] * data[2 * k + 1]) *
                                   2.0 / (0.375 * SEGMENT * SEGMENT) / SEGMENTS;
    }
}

/* The realised record has the power of the density in each of eight bands of equal power, 64 lines,
 * and does not correlate with itself later on.
 *
 * Limits from 60 draws made once: a band differs by 1.1 % (one standard deviation; the largest of
 * 480 was 5.8 %, so the tails are not normal), as lines fall on either side of an edge and
 * neighbours beat: 15 %. The mean square differs by 0.24 %: 2 %. The correlation at a lag is the
 * mean cosine of 512 random angles, normal with the standard deviation sqrt(1/1024) = 0.031 (found
 * 0.0313): 206 lags are below 0.2 but for 4e-8. */
static void test_realised_record(void **state)
{
    (void)state;
    static double force[RECORD];
    static imk_vibration_line line[LINES];
    double edge[BANDS + 1] = {corner[0]}, power[BANDS], square = 0.0;
    const double total = power_between(corner[0], corner[CORNERS - 1]);
    for (int band = 0; band < BANDS; band++) {
        double low = edge[band], high = corner[CORNERS - 1];
        for (int i = 0; i < 20; i++) {
            const double middle = 0.5 * (low + high);
            if (power_between(edge[band], middle) < total / BANDS)
                low = middle;
            else
                high = middle;
        }
        edge[band + 1] = high;
    }
    make_lines(3, 1, line);
    sample_force(line, force);
    welch(force, edge, power);
    for (int band = 0; band < BANDS; band++)
        CHECK_RELATIVE(power[band], total / BANDS, 0.15);
    for (int k = 0; k < RECORD; k++)
        square += force[k] * force[k] / RECORD;
    CHECK_RELATIVE(square, total, 0.02);
    for (int lag = 2000; lag < RECORD / 2; lag += 70) {
        double product = 0.0;
        for (int k = 0; k < RECORD / 2; k++)
            product += force[k] * force[k + lag] / (RECORD / 2);
        CHECK_BELOW(fabs(product) / square, 0.2);
    }
}

static void test_draws_differ_and_repeat(void **state)
{
    (void)state;
    imk_vibration_line a[LINES], b[LINES];
    make_lines(1, 7, a);
    make_lines(1, 7, b);
    for (int i = 0; i < LINES; i++)
        assert_true(a[i].frequency == b[i].frequency && a[i].phase == b[i].phase &&
                    a[i].amplitude == b[i].amplitude);
    make_lines(1, 8, b);
    assert_true(a[0].frequency != b[0].frequency && a[0].phase != b[0].phase);
    make_lines(2, 7, b);
    assert_true(a[0].frequency != b[0].frequency && a[0].phase != b[0].phase);
}

static void test_odd_densities_are_refused(void **state)
{
    (void)state;
    imk_vibration_line line[LINES];
    imk_error error;
    const imk_random random = imk_random_seeded(1);
    double f[] = {10.0, 20.0, 30.0}, d[] = {1.0, 1.0, 1.0};
    CHECK_OK(imk_vibration_from_density(2, 3, f, d, random, 0, 8, line, &error));
    CHECK_STATUS(imk_vibration_from_density(3, 3, f, d, random, 0, 8, line, &error),
                 IMK_ERROR_RANGE);
    CHECK_STATUS(imk_vibration_from_density(0, 1, f, d, random, 0, 8, line, &error),
                 IMK_ERROR_TOO_SHORT);
    CHECK_STATUS(imk_vibration_from_density(0, 3, f, d, random, 0, 7, line, &error),
                 IMK_ERROR_RANGE);
    CHECK_STATUS(imk_vibration_from_density(0, 3, f, d, random, 0, 513, line, &error),
                 IMK_ERROR_RANGE);
    f[0] = 1e-6; /* the least: taken */
    CHECK_OK(imk_vibration_from_density(0, 3, f, d, random, 0, 8, line, &error));
    f[0] = 0.9e-6;
    CHECK_STATUS(imk_vibration_from_density(0, 3, f, d, random, 0, 8, line, &error),
                 IMK_ERROR_RANGE);
    f[0] = 10.0;
    d[1] = 0.0;
    CHECK_STATUS(imk_vibration_from_density(0, 3, f, d, random, 0, 8, line, &error),
                 IMK_ERROR_RANGE);
    assert_int_equal(error.index, 1);
    d[1] = 1.0;
    f[2] = 20.0;
    CHECK_STATUS(imk_vibration_from_density(0, 3, f, d, random, 0, 8, line, &error),
                 IMK_ERROR_RANGE);
    assert_int_equal(error.index, 2);
    f[2] = (double)NAN;
    CHECK_STATUS(imk_vibration_from_density(0, 3, f, d, random, 0, 8, line, &error),
                 IMK_ERROR_NOT_FINITE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_displacement),
        cmocka_unit_test(test_rotation),
        cmocka_unit_test(test_coning),
        cmocka_unit_test(test_lines_hold_the_power),
        cmocka_unit_test(test_realised_record),
        cmocka_unit_test(test_draws_differ_and_repeat),
        cmocka_unit_test(test_odd_densities_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
