/* SPDX-License-Identifier: Apache-2.0 */
/* Fourier transform of a length with large prime factors [BLUESTEIN1970]: with
 * jk = (j^2 + k^2 - (k-j)^2)/2 and the chirp c[j] = e^{-i pi j^2/n},
 *
 *     X[k] = c[k] sum_j (x[j] c[j]) conj(c[k-j]),
 *
 * a convolution, done by transforms of a length m >= 2n - 1 without large primes. */
#include "fourier_internal.h"

#include <string.h>

/* Smallest 2^a 3^b 5^c >= n. */
static size_t next_smooth(size_t n)
{
    size_t best = SIZE_MAX;
    for (size_t five = 1;; five *= 5) {
        for (size_t three = five;; three *= 3) {
            size_t product = three;
            while (product < n)
                product *= 2;
            if (product < best)
                best = product;
            if (three >= n)
                break;
        }
        if (five >= n)
            return best;
    }
}

size_t imki_bluestein_workspace(size_t n)
{
    const size_t m = next_smooth(2 * n - 1);
    return 2 * n + 4 * m + IMKI_LANES + imki_smooth_workspace(m);
}

void imki_bluestein_transform(size_t n, double *data, double *workspace)
{
    const size_t m = next_smooth(2 * n - 1);
    double *kernel = workspace;
    double *product = kernel + 2 * m;
    double *chirp = product + 2 * m;
    double *rest = chirp + 2 * n;
    for (uint64_t j = 0; j < n; j++)
        imki_root(j * j % (2 * (uint64_t)n), 2 * (uint64_t)n, &chirp[2 * j], &chirp[2 * j + 1]);
    memset(kernel, 0, 4 * m * sizeof *kernel);
    for (size_t j = 0; j < n; j++) {
        const double cr = chirp[2 * j], ci = chirp[2 * j + 1];
        const size_t mirror = j == 0 ? 0 : m - j;
        kernel[2 * j] = kernel[2 * mirror] = cr;
        kernel[2 * j + 1] = kernel[2 * mirror + 1] = -ci;
        product[2 * j] = data[2 * j] * cr - data[2 * j + 1] * ci;
        product[2 * j + 1] = data[2 * j] * ci + data[2 * j + 1] * cr;
    }
    imki_smooth_transform(m, kernel, rest);
    imki_smooth_transform(m, product, rest);
    /* Multiplied and conjugated: the next forward transform is then the conjugate inverse. */
    for (size_t j = 0; j < m; j++) {
        const double ar = product[2 * j], ai = product[2 * j + 1];
        const double br = kernel[2 * j], bi = kernel[2 * j + 1];
        product[2 * j] = ar * br - ai * bi;
        product[2 * j + 1] = -(ar * bi + ai * br);
    }
    imki_smooth_transform(m, product, rest);
    const double scale = (double)m;
    for (size_t k = 0; k < n; k++) {
        const double yr = product[2 * k] / scale, yi = -product[2 * k + 1] / scale;
        data[2 * k] = yr * chirp[2 * k] - yi * chirp[2 * k + 1];
        data[2 * k + 1] = yr * chirp[2 * k + 1] + yi * chirp[2 * k];
    }
}
