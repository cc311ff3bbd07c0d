/* SPDX-License-Identifier: Apache-2.0 */
/* The elementary functions against those of the C library, which may use FMA and tables. Calls do
 * not depend on one another. */
#include "bench.h"

#include "imukit/elementary.h"

enum { CALLS = 100000, REPEATS = 20 };

typedef struct elementary_run {
    double (*function)(double x);
    double first, step, sum;
} elementary_run;

static void run(void *context)
{
    elementary_run *r = context;
    double sum = 0.0;
    for (int i = 0; i < CALLS; i++)
        sum += r->function(r->first + i * r->step);
    r->sum = sum;
}

int main(void)
{
    bench_pin();
    static const struct {
        const char *name;
        double (*ours)(double x), (*library)(double x);
        double first, last;
    } rows[] = {
        {"exp", imk_exp, exp, -30.0, 30.0},
        {"expm1", imk_expm1, expm1, -3.0, 3.0},
        {"ln", imk_ln, log, 1e-3, 1e3},
        {"sin_small", imk_sin, sin, -0.7, 0.7},
        {"sin_turns", imk_sin, sin, -100.0, 100.0},
        {"cos_turns", imk_cos, cos, -100.0, 100.0},
        {"sin_large", imk_sin, sin, 1.1e6, 1.5e6},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const double step = (rows[i].last - rows[i].first) / CALLS;
        elementary_run ours = {rows[i].ours, rows[i].first, step, 0.0};
        elementary_run library = {rows[i].library, rows[i].first, step, 0.0};
        double our_time, library_time;
        bench_compare(REPEATS, run, &ours, run, &library, &our_time, &library_time);
        bench_use(&ours);
        bench_use(&library);
        bench_row_time(rows[i].name, 1e9 * our_time / CALLS, 1e9 * library_time / CALLS, "ns", "-",
                       1);
    }
    return 0;
}
