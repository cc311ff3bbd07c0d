// SPDX-License-Identifier: Apache-2.0
// Yardstick of bench_simulate: what one writes first in C++. White noise and random walk on six
// channels from one std::mt19937_64 and std::normal_distribution; prints ns per row, the shortest
// of the repeats.
//
//     mt19937_loop ROWS REPEATS
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

int main(int argc, char **argv)
{
    const long rows = argc > 1 ? std::atol(argv[1]) : 1000000;
    const int repeats = argc > 2 ? std::atoi(argv[2]) : 3;
    const double rate = 100.0, white = 1e-3 * std::sqrt(rate), walk = 1e-5 / std::sqrt(rate);
    std::vector<double> out(6 * static_cast<std::size_t>(rows));
    double best = INFINITY;
    for (int repeat = 0; repeat < repeats; repeat++) {
        std::mt19937_64 engine(static_cast<unsigned long>(repeat));
        std::normal_distribution<double> normal;
        double bias[6] = {};
        const auto start = std::chrono::steady_clock::now();
        for (long row = 0; row < rows; row++)
            for (int channel = 0; channel < 6; channel++) {
                bias[channel] += walk * normal(engine);
                out[6 * static_cast<std::size_t>(row) + channel] =
                    bias[channel] + white * normal(engine);
            }
        const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
        best = std::min(best, taken.count());
    }
    std::fprintf(stderr, "%g\n", out.back());
    std::printf("%.4f\n", 1e9 * best / static_cast<double>(rows));
}
