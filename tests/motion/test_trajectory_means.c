/* SPDX-License-Identifier: Apache-2.0 */
/* Means over trajectories against quadrature of states, and the same bits however samples are asked
 * for. */
#include "check.h"

#include "random_pieces.h"

/* Mean of states between two times by eight intervals of five Gauss-Legendre nodes
 * [ABRAMOWITZ1964, table 25.4]. */
static void quadrature(const imk_trajectory *trajectory, double begin, double end, double rate[3],
                       double force[3])
{
    static const double node[] = {-0.906179845938663992798, -0.538469310105683091036, 0.0,
                                  0.538469310105683091036, 0.906179845938663992798};
    static const double weight[] = {0.236926885056189087514, 0.478628670499366468041,
                                    0.568888888888888888889, 0.478628670499366468041,
                                    0.236926885056189087514};
    memset(rate, 0, 3 * sizeof *rate);
    memset(force, 0, 3 * sizeof *force);
    for (int part = 0; part < 8; part++)
        for (int i = 0; i < 5; i++) {
            imk_motion_state at;
            const double x = (part + 0.5 + 0.5 * node[i]) / 8.0;
            imk_trajectory_state(trajectory, begin + x * (end - begin), &at);
            for (int axis = 0; axis < 3; axis++) {
                rate[axis] += weight[i] / 16.0 * at.angular_rate.v[axis];
                force[axis] += weight[i] / 16.0 * at.specific_force.v[axis];
            }
        }
}

/* The same, cut where pieces meet and where the motion begins and ends. */
static void piecewise_quadrature(const imk_trajectory *trajectory, double begin, double end,
                                 double rate[3], double force[3])
{
    double cut[64];
    size_t cuts = 0;
    cut[cuts++] = begin;
    for (size_t i = 0; i <= trajectory->piece_count; i++) {
        const imk_trajectory_piece *piece = &trajectory->piece[i - (i > 0)];
        const double time = piece->start + (i == trajectory->piece_count ? piece->length : 0.0);
        if (i < trajectory->piece_count && i > 0 && trajectory->piece[i].start > begin &&
            trajectory->piece[i].start < end)
            cut[cuts++] = trajectory->piece[i].start;
        else if ((i == 0 || i == trajectory->piece_count) && time > begin && time < end)
            cut[cuts++] = time;
    }
    cut[cuts] = end;
    memset(rate, 0, 3 * sizeof *rate);
    memset(force, 0, 3 * sizeof *force);
    for (size_t i = 0; i < cuts; i++) {
        double part_rate[3], part_force[3];
        quadrature(trajectory, cut[i], cut[i + 1], part_rate, part_force);
        for (int axis = 0; axis < 3; axis++) {
            rate[axis] += (cut[i + 1] - cut[i]) / (end - begin) * part_rate[axis];
            force[axis] += (cut[i + 1] - cut[i]) / (end - begin) * part_force[axis];
        }
    }
}

enum { SAMPLES = 512 };

typedef struct sensor_record {
    double value[9][SAMPLES]; /* rate, acceleration, force */
} sensor_record;

static void take_means(const imk_trajectory *trajectory, imk_kernel kernel, size_t at_once,
                       const double *boundary, sensor_record *record)
{
    double(*v)[SAMPLES] = record->value;
    for (size_t k = 0; k < SAMPLES; k += at_once) {
        const size_t count = k + at_once <= SAMPLES ? at_once : SAMPLES - k;
        double *const rate[] = {v[0] + k, v[1] + k, v[2] + k};
        double *const acceleration[] = {v[3] + k, v[4] + k, v[5] + k};
        double *const force[] = {v[6] + k, v[7] + k, v[8] + k};
        imk_trajectory_means(trajectory, kernel, count, boundary + k, rate, acceleration, force);
    }
}

/* From before the start to after the end, with samples of uneven length. */
static void make_boundaries(double first, double last, double boundary[SAMPLES + 1])
{
    for (int k = 0; k <= SAMPLES; k++) {
        const double u = k / (double)SAMPLES;
        boundary[k] = first + (last - first) * (u + 0.02 * imk_sin(7.0 * u));
    }
}

static double largest(const imk_trajectory *trajectory, double time, double *rate)
{
    imk_motion_state at;
    imk_trajectory_state(trajectory, time, &at);
    *rate = imk_vector3_norm(at.angular_rate);
    return imk_vector3_norm(at.specific_force);
}

static void check_means(const imk_trajectory *trajectory, const double *boundary, double tolerance)
{
    static sensor_record record;
    take_means(trajectory, IMK_KERNEL_SCALAR, SAMPLES, boundary, &record);
    for (size_t k = 0; k < SAMPLES; k += 3) {
        double rate[3], force[3], turning;
        const double scale =
            fmax(largest(trajectory, 0.5 * (boundary[k] + boundary[k + 1]), &turning), 1.0);
        piecewise_quadrature(trajectory, boundary[k], boundary[k + 1], rate, force);
        for (int i = 0; i < 3; i++) {
            CHECK_CLOSE(record.value[i][k], rate[i], tolerance * fmax(turning, 1.0));
            CHECK_CLOSE(record.value[6 + i][k], force[i], tolerance * scale);
        }
    }
}

static void test_means_are_integrals(void **state)
{
    (void)state;
    double boundary[SAMPLES + 1];
    imk_trajectory_piece piece[40];
    for (uint64_t seed = 1; seed <= 3; seed++) {
        random_pieces(8, 1.0, seed, piece); /* samples of 20 ms, eight of them straddle */
        imk_trajectory trajectory = on_earth(8, piece);
        make_boundaries(2.5, 11.5, boundary);
        check_means(&trajectory, boundary, 1e-12);
        trajectory.earth = false;
        check_means(&trajectory, boundary, 1e-12);
        random_pieces(40, 0.007, seed, piece); /* many pieces in a sample, and long rests */
        trajectory = on_earth(40, piece);
        make_boundaries(2.0, 12.0, boundary);
        check_means(&trajectory, boundary, 1e-12);
    }
}

/* Fast and far: gravity is interpolated within a sample. 20 ms at 3 km/s are 60 m. */
static void test_gravity_of_fast_motion(void **state)
{
    (void)state;
    double boundary[SAMPLES + 1];
    imk_trajectory_piece piece;
    random_pieces(1, 20.0, 5, &piece);
    memset(piece.position, 0, sizeof piece.position);
    piece.position[0][1] = 2000.0;
    piece.position[1][1] = -2500.0;
    piece.position[2][1] = 1000.0;
    for (int part = 0; part < 4; part++)
        for (int power = 1; power < 6; power++)
            piece.quaternion[part][power] *= pow(0.1, power);
    const imk_trajectory trajectory = on_earth(1, &piece);
    make_boundaries(3.0, 13.0, boundary);
    check_means(&trajectory, boundary, 1e-12);
}

/* A sample is a quarter of a cycle of the fastest line at most, by imk_trajectory_substeps(). */
static void test_means_of_vibration(void **state)
{
    (void)state;
    double boundary[SAMPLES + 1];
    imk_trajectory_piece piece[4];
    random_pieces(4, 1.0, 11, piece);
    imk_trajectory trajectory = on_earth(4, piece);
    assert_int_equal(imk_trajectory_substeps(&trajectory, 0.01), 1);
    trajectory.line = lines;
    trajectory.line_count = LINES;
    assert_int_equal(imk_trajectory_substeps(&trajectory, 0.01), 1);
    assert_int_equal(imk_trajectory_substeps(&trajectory, 0.1), 10); /* 16 x 5.7 Hz x 0.1 s */
    make_boundaries(2.9, 7.1, boundary);
    check_means(&trajectory, boundary, 2e-12);
}

/* The mean angular acceleration is the change of the rate, and rates are continuous. */
static void test_angular_acceleration(void **state)
{
    (void)state;
    static sensor_record record;
    double boundary[SAMPLES + 1];
    imk_trajectory_piece piece;
    random_pieces(1, 9.0, 2, &piece);
    const imk_trajectory trajectory = on_earth(1, &piece);
    make_boundaries(3.5, 6.0, boundary);
    take_means(&trajectory, IMK_KERNEL_SCALAR, SAMPLES, boundary, &record);
    for (int k = 0; k < SAMPLES; k++) {
        imk_motion_state begin, end;
        imk_trajectory_state(&trajectory, boundary[k], &begin);
        imk_trajectory_state(&trajectory, boundary[k + 1], &end);
        for (int i = 0; i < 3; i++)
            CHECK_CLOSE(record.value[3 + i][k],
                        (end.angular_rate.v[i] - begin.angular_rate.v[i]) /
                            (boundary[k + 1] - boundary[k]),
                        0.0);
    }
}

static void check_bits(const imk_trajectory *trajectory, const double *boundary)
{
    static sensor_record expected, found;
    static const size_t at_once[] = {1, 7, 64, SAMPLES};
    const imk_kernel best = imk_random_seeded(0).kernel;
    take_means(trajectory, IMK_KERNEL_SCALAR, SAMPLES, boundary, &expected);
    for (int kernel = IMK_KERNEL_SCALAR; kernel <= (int)best;
         kernel++) /* a machine has all below */
        for (size_t i = 0; i < 4; i++) {
            memset(&found, 0, sizeof found);
            take_means(trajectory, (imk_kernel)kernel, at_once[i], boundary, &found);
            assert_memory_equal(&found, &expected, sizeof found);
        }
}

static void test_bits_do_not_depend_on_division(void **state)
{
    (void)state;
    double boundary[SAMPLES + 1];
    imk_trajectory_piece piece[30];
    for (uint64_t seed = 1; seed <= 3; seed++) {
        random_pieces(30, seed == 3 ? 0.02 : 0.31, seed, piece);
        if (seed == 2) /* some of them at rest */
            for (int i = 0; i < 30; i += 3)
                for (int j = 0; j < 4; j++) {
                    memset(piece[i].quaternion[j] + 1, 0, 5 * sizeof(double));
                    memset(piece[i].position[j % 3] + 1, 0, 6 * sizeof(double));
                }
        imk_trajectory trajectory = on_earth(30, piece);
        make_boundaries(2.7, seed == 3 ? 4.0 : 13.0, boundary);
        check_bits(&trajectory, boundary);
        trajectory.earth = false;
        check_bits(&trajectory, boundary);
        trajectory.line = lines;
        trajectory.line_count = LINES;
        check_bits(&trajectory, boundary);
    }
}

/* FNV-1a of the bits of means: the same with every compiler and machine. */
static void test_bits_are_fixed(void **state)
{
    (void)state;
    static sensor_record record;
    double boundary[SAMPLES + 1];
    imk_trajectory_piece piece[5];
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    random_pieces(5, 1.3, 77, piece);
    imk_trajectory trajectory = on_earth(5, piece);
    make_boundaries(2.0, 10.0, boundary);
    for (int shaken = 0; shaken < 2; shaken++) {
        trajectory.line = lines;
        trajectory.line_count = shaken ? LINES : 0;
        take_means(&trajectory, imk_random_seeded(0).kernel, SAMPLES, boundary, &record);
        for (size_t i = 0; i < sizeof record; i += sizeof(uint64_t)) {
            uint64_t bits;
            memcpy(&bits, (const char *)&record + i, sizeof bits);
            for (int shift = 0; shift < 64; shift += 8)
                hash = (hash ^ (bits >> shift & 0xff)) * UINT64_C(0x100000001b3);
        }
    }
    assert_int_equal(hash, UINT64_C(0x9fe97fc7e84f352a));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_means_are_integrals),
        cmocka_unit_test(test_gravity_of_fast_motion),
        cmocka_unit_test(test_means_of_vibration),
        cmocka_unit_test(test_angular_acceleration),
        cmocka_unit_test(test_bits_do_not_depend_on_division),
        cmocka_unit_test(test_bits_are_fixed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
