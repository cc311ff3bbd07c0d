/* SPDX-License-Identifier: Apache-2.0 */
/* The distribution of the normals: moments, shape, tails, independence.
 *
 * Every statistic is reduced to a number z that is standard normal when all is well, and must stay
 * below 5.5: a false alarm with probability 3.8e-8 each, 3e-6 for all together. The limit
 * leaves room for what is left of skewness (eighth moment) and of the Poisson distribution (tails
 * beyond 5 sigma). The seeds are fixed; both must pass.
 *
 * IMUKIT_TEST_DRAWS sets the number of draws. */
#include "check.h"

#include "imukit/random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#if defined(__SANITIZE_ADDRESS__) || !defined(__OPTIMIZE__)
static const double default_draws = 4e6;
#else
static const double default_draws = 1e8;
#endif

enum {
    CHUNK = 1 << 16,
    MOMENTS = 8,
    CELLS_PER_SIGMA = 64,
    CELLS = 16 * CELLS_PER_SIGMA, /* from -8 to 8 */
    LAGS = 6,
    OCTANTS = 8,
    RINGS = 16
};

/* Neighbouring lanes; both of a pair; the two pairs of a block; neighbouring blocks; a group. */
static const size_t lags[LAGS] = {1, 7, 8, 16, 32, 33};

static const double z_limit = 5.5;

/* Everything counted in one pass over the draws. */
typedef struct tally {
    uint64_t draws;
    double power[MOMENTS + 1];
    uint64_t cell[CELLS];
    double lag_product[LAGS], lag_squares[LAGS];
    uint64_t lag_count;
    double other_product[3], other_squares[3]; /* with another stream, block range and seed */
    uint64_t ring[RINGS][OCTANTS];
} tally;

static double draws_wanted(void)
{
    const char *text = getenv("IMUKIT_TEST_DRAWS");
    if (text)
        return atof(text);
    /* The portable kernel is slow, and makes the same bits. */
    return imk_random_seeded(0).kernel == IMK_KERNEL_SCALAR ? 1e7 : default_draws;
}

static void count_powers(tally *t, const double *x)
{
    double sum[MOMENTS + 1] = {0};
    for (size_t i = 0; i < CHUNK; i++) {
        double power = 1.0;
        for (int k = 1; k <= MOMENTS; k++) {
            power *= x[i];
            sum[k] += power;
        }
    }
    for (int k = 1; k <= MOMENTS; k++)
        t->power[k] += sum[k];
}

static void count_cells(tally *t, const double *x)
{
    for (size_t i = 0; i < CHUNK; i++)
        t->cell[(size_t)((x[i] + 8.0) * CELLS_PER_SIGMA)]++;
}

static void add_products(const double *x, const double *y, size_t count, double *product,
                         double *squares)
{
    double p = 0.0, s = 0.0;
    for (size_t i = 0; i < count; i++) {
        p += x[i] * y[i];
        s += (x[i] * x[i] - 1.0) * (y[i] * y[i] - 1.0);
    }
    *product += p;
    *squares += s;
}

/* Octant and ring of equal probability (P(r > R) = exp(-R^2/2)) of each pair. */
static void count_rings(tally *t, const double *x)
{
    double edge[RINGS];
    for (int i = 0; i < RINGS; i++)
        edge[i] = -2.0 * log((double)(RINGS - i) / RINGS);
    for (size_t i = 0; i < CHUNK / 4; i++) {
        if (i / 8 % 2)
            continue; /* i is a first one of a pair, i + 8 its second */
        const double a = x[i], b = x[i + 8], square = a * a + b * b;
        const int octant = (a < 0.0) + 2 * (b < 0.0) + 4 * (fabs(a) > fabs(b));
        int ring = RINGS - 1;
        while (square < edge[ring])
            ring--;
        t->ring[ring][octant]++;
    }
}

static void count_all(tally *t, uint64_t seed, double draws)
{
    static double x[CHUNK], other[CHUNK];
    memset(t, 0, sizeof *t);
    const imk_random source = imk_random_seeded(seed);
    const imk_random sources[3] = {source, source, imk_random_seeded(seed ^ 1)};
    const uint64_t stream = imk_stream(0, 1, 0, 0), streams[3] = {stream + 1, stream, stream};
    const uint64_t offsets[3] = {0, UINT64_C(1) << 34, 0};
    for (uint64_t first = 0; (double)first < draws; first += CHUNK) {
        imk_random_normals(source, stream, first, CHUNK, x);
        t->draws += CHUNK;
        count_powers(t, x);
        count_cells(t, x);
        count_rings(t, x);
        for (int k = 0; k < LAGS; k++)
            add_products(x, x + lags[k], CHUNK - 64, &t->lag_product[k], &t->lag_squares[k]);
        t->lag_count += CHUNK - 64;
        for (int k = 0; k < 3; k++) {
            imk_random_normals(sources[k], streams[k], first + offsets[k], CHUNK, other);
            add_products(x, other, CHUNK, &t->other_product[k], &t->other_squares[k]);
        }
    }
}

static void check_z(double z, const char *what, double which)
{
    if (!(fabs(z) <= z_limit)) {
        print_error("%s %g: z = %.2f\n", what, which, z);
        fail();
    }
}

/* E x^k = (k - 1)!! for even k, 0 for odd. */
static double moment(int k)
{
    double product = k % 2 ? 0.0 : 1.0;
    for (int i = k - 1; i > 1; i -= 2)
        product *= i;
    return product;
}

static void check_moments(const tally *t)
{
    const double n = (double)t->draws;
    for (int k = 1; k <= MOMENTS; k++) {
        const double variance = moment(2 * k) - moment(k) * moment(k);
        check_z((t->power[k] / n - moment(k)) * sqrt(n / variance), "moment", k);
    }
}

static double cell_probability(int cell)
{
    /* Both edges from the nearer tail, where erfc is accurate. */
    const int from_centre = cell < CELLS / 2 ? CELLS / 2 - 1 - cell : cell - CELLS / 2;
    const double scale = 1.0 / (CELLS_PER_SIGMA * sqrt(2.0));
    return 0.5 * (erfc(from_centre * scale) - erfc((from_centre + 1) * scale));
}

/* Chi-square z by the cube-root transform [WILSON1931]. */
static double chi_square_z(double chi_square, double degrees)
{
    const double c = 2.0 / (9.0 * degrees);
    return (cbrt(chi_square / degrees) - (1.0 - c)) / sqrt(c);
}

/* Chi-square over cells of 50 expected or more (smaller ones are joined), and the largest
 * difference of the distribution functions at the cell edges: P(D sqrt n > 2.9) < 1e-7
 * [KOLMOGOROV1933]. */
static void check_shape(const tally *t)
{
    const double n = (double)t->draws;
    double chi_square = 0.0, degrees = -1.0, distance = 0.0;
    double expected = 0.0, seen = 0.0, total_expected = 0.0, total_seen = 0.0;
    for (int i = 0; i < CELLS; i++) {
        expected += n * cell_probability(i);
        seen += (double)t->cell[i];
        total_expected += n * cell_probability(i);
        total_seen += (double)t->cell[i];
        distance = fmax(distance, fabs(total_seen - total_expected) / n);
        const double rest = n - total_expected;
        if (expected >= 50.0 && (rest >= 50.0 || i == CELLS - 1)) {
            chi_square += (seen - expected) * (seen - expected) / expected;
            degrees += 1.0;
            expected = seen = 0.0;
        }
    }
    if (expected > 0.0) {
        chi_square += (seen - expected) * (seen - expected) / expected;
        degrees += 1.0;
    }
    check_z(chi_square_z(chi_square, degrees), "chi-square of cells", degrees);
    CHECK_BELOW(distance * sqrt(n), 2.9);
}

/* Counts beyond 3, 4 and 5 sigma on each side; Poisson, made normal by the root [ANSCOMBE1948]. */
static void check_tails(const tally *t)
{
    for (int sigma = 3; sigma <= 5; sigma++) {
        const int from = CELLS / 2 + sigma * CELLS_PER_SIGMA;
        double above = 0.0, below = 0.0;
        for (int i = from; i < CELLS; i++) {
            above += (double)t->cell[i];
            below += (double)t->cell[CELLS - 1 - i];
        }
        const double expected = 0.5 * erfc(sigma / sqrt(2.0)) * (double)t->draws;
        const double root = 2.0 * sqrt(expected + 0.375);
        check_z(2.0 * sqrt(above + 0.375) - root, "tail above", sigma);
        check_z(2.0 * sqrt(below + 0.375) - root, "tail below", -sigma);
    }
}

/* E (xy)^2 = 1 and E ((x^2 - 1)(y^2 - 1))^2 = 4 for independent normals. */
static void check_independence(const tally *t)
{
    const double lagged = sqrt((double)t->lag_count), all = sqrt((double)t->draws);
    for (int k = 0; k < LAGS; k++) {
        check_z(t->lag_product[k] / lagged, "correlation at lag", (double)lags[k]);
        check_z(t->lag_squares[k] / (2.0 * lagged), "correlation of squares at lag",
                (double)lags[k]);
    }
    for (int k = 0; k < 3; k++) {
        check_z(t->other_product[k] / all, "correlation with other", k);
        check_z(t->other_squares[k] / (2.0 * all), "correlation of squares with other", k);
    }
}

/* Radius and direction of the pairs: all 128 sectors are equally likely. */
static void check_rings(const tally *t)
{
    double total = 0.0, chi_square = 0.0;
    for (int i = 0; i < RINGS; i++)
        for (int k = 0; k < OCTANTS; k++)
            total += (double)t->ring[i][k];
    const double expected = total / (RINGS * OCTANTS);
    for (int i = 0; i < RINGS; i++)
        for (int k = 0; k < OCTANTS; k++) {
            const double difference = (double)t->ring[i][k] - expected;
            chi_square += difference * difference / expected;
        }
    check_z(chi_square_z(chi_square, RINGS * OCTANTS - 1), "chi-square of sectors", RINGS);
}

static void check_seed(uint64_t seed, double draws)
{
    static tally t;
    count_all(&t, seed, draws);
    check_moments(&t);
    check_shape(&t);
    check_tails(&t);
    check_independence(&t);
    check_rings(&t);
}

static void normals_are_standard_normal(void **state)
{
    (void)state;
    check_seed(1, draws_wanted());
}

static void another_seed_passes_too(void **state)
{
    (void)state;
    check_seed(UINT64_C(0x9e3779b97f4a7c15), draws_wanted() / 10.0);
}

/* Seeds and streams that differ in one bit, the first normals of each: correlation over them. */
static void neighbouring_sources_are_independent(void **state)
{
    (void)state;
    enum { COUNT = 32, SOURCES = 4096 };
    double product = 0.0, squares = 0.0;
    for (uint64_t i = 0; i < SOURCES; i++) {
        double first[COUNT], stream[COUNT], seed[COUNT];
        imk_random_normals(imk_random_seeded(i), i, 0, COUNT, first);
        imk_random_normals(imk_random_seeded(i), i ^ UINT64_C(1) << i % 64, 0, COUNT, stream);
        imk_random_normals(imk_random_seeded(i ^ UINT64_C(1) << i % 64), i, 0, COUNT, seed);
        add_products(first, stream, COUNT, &product, &squares);
        add_products(first, seed, COUNT, &product, &squares);
    }
    const double root = sqrt(2.0 * COUNT * SOURCES);
    check_z(product / root, "correlation of neighbours", 0.0);
    check_z(squares / (2.0 * root), "correlation of squares of neighbours", 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(normals_are_standard_normal),
        cmocka_unit_test(another_seed_passes_too),
        cmocka_unit_test(neighbouring_sources_are_independent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
