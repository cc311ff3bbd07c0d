/* SPDX-License-Identifier: Apache-2.0 */
/* Stamps that are no sample times: every row on its place, or a doubt. */
#include "check.h"

#include "imukit/jobs.h"
#include "imukit/show.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 6000, MOST = 12000, AXES = 3 };

static const double nan_value = (double)NAN;

/* A log of white noise; `place` is the sample of each row. */
typedef struct test_log {
    double time[MOST], gyro[AXES][MOST], noise;
    size_t place[MOST], rows;
    double rate;
} test_log;

static uint64_t state;

static double uniform(void)
{
    state += 0x9e3779b97f4a7c15u; /* splitmix64 */
    uint64_t z = state;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static double normal(void)
{
    return sqrt(-2 * log(1 - uniform())) * cos(6.283185307179586 * uniform());
}

static size_t below(size_t n)
{
    return (size_t)(uniform() * (double)n);
}

static void make(test_log *l, uint64_t seed, size_t rows, double rate)
{
    state = seed * 0x51a7;
    l->rows = rows;
    l->rate = rate;
    l->noise = 1e-4;
    for (size_t i = 0; i < rows; i++) {
        l->time[i] = (double)i / rate;
        l->place[i] = i;
        for (int c = 0; c < AXES; c++)
            l->gyro[c][i] = 1e-4 * sqrt(rate) * normal();
    }
}

/* ---- faults ---- */

static void group(test_log *l, double rows)
{
    for (size_t i = 0; i < l->rows; i++)
        l->time[i] = l->time[i - i % (size_t)rows];
}

static void round_down(test_log *l, double unit)
{
    for (size_t i = 0; i < l->rows; i++)
        l->time[i] = floor(l->time[i] / unit + 1e-9) * unit;
}

static void round_times(test_log *l, double unit)
{
    for (size_t i = 0; i < l->rows; i++)
        l->time[i] = floor(l->time[i] / unit + 0.5) * unit;
}

/* Bunches of rows, stamped 0.1 ms one after the other when the last one is there. */
static void bunch(test_log *l, double rows)
{
    const size_t n = (size_t)rows;
    for (size_t i = l->rows - l->rows % n; i-- > 0;)
        l->time[i] = l->time[i - i % n + n - 1] + 1e-4 * (double)(i % n);
}

/* Pauses of 2 to 20 rows, `between` apart on average, all of which arrive at their end. */
static void burst(test_log *l, double between)
{
    for (size_t i = 0;;) {
        const size_t length = 2 + below(19);
        i += 5 + (size_t)(-between * log(1 - uniform()));
        if (i + length >= l->rows)
            return;
        for (size_t k = 0; k < length; k++, i++)
            l->time[i] = l->time[i + length - k] - 2e-4 * (double)(length - k);
    }
}

static void scatter(test_log *l, double share)
{
    for (size_t i = 0; i < l->rows; i++)
        l->time[i] += share * normal() / l->rate;
}

static void delay(test_log *l, double intervals)
{
    for (size_t i = 0; i < l->rows; i++) {
        const double late = l->time[i] - intervals * log(1 - uniform()) / l->rate;
        l->time[i] = i > 0 ? fmax(late, l->time[i - 1] + 1e-7) : late;
    }
}

static void alternate(test_log *l, double share)
{
    for (size_t i = 1; i < l->rows; i += 2)
        l->time[i] += share / l->rate;
}

/* 500 rows at the rate, 500 at 1/ratio of it, and so on. */
static void change_rate(test_log *l, double ratio)
{
    for (size_t i = 1; i < l->rows; i++)
        l->time[i] = l->time[i - 1] + (i / 500 % 2 ? ratio : 1) / l->rate;
}

static void step_back(test_log *l, double seconds)
{
    for (size_t i = l->rows / 2; i < l->rows; i++)
        l->time[i] -= seconds;
}

static void wrap(test_log *l, double period)
{
    for (size_t i = 0; i < l->rows; i++)
        l->time[i] = fmod(l->time[i], period);
}

static void copy_axis(test_log *l, double axis)
{
    memcpy(l->gyro[(int)axis], l->gyro[0], sizeof l->gyro[0]);
}

/* The opposite of another axis, with a scale, an offset and a little noise. */
static void follow_axis(test_log *l, double axis)
{
    for (size_t i = 0; i < l->rows; i++)
        l->gyro[(int)axis][i] = 0.1 - 1.3 * l->gyro[0][i] + 0.01 * l->gyro[1][i];
}

/* As much of the axis before, three rows late, as of its own noise. */
static void mix_axis(test_log *l, double axis)
{
    double *gyro = l->gyro[(int)axis];
    for (size_t i = 3; i < l->rows; i++)
        gyro[i] += 1.2 * l->gyro[(int)axis - 1][i - 3];
}

/* Three times the noise of the axes, of a structure that resonates at an eighth of the rate. */
static void resonate(test_log *l, double strength)
{
    double near = 0, far = 0;
    for (size_t i = 0; i < l->rows; i++) {
        const double now = 2 * 0.96 * sqrt(0.5) * near - 0.96 * 0.96 * far + normal();
        far = near;
        near = now;
        for (int c = 0; c < AXES; c++)
            l->gyro[c][i] += strength * 0.28 * l->noise * sqrt(l->rate) * (c == 1 ? -now : now);
    }
}

static void sound(test_log *l, double unused)
{
    (void)l;
    (void)unused;
}

/* A tone on all axes. */
static void hum(test_log *l, double frequency)
{
    for (size_t i = 0; i < l->rows; i++)
        for (int c = 0; c < AXES; c++)
            l->gyro[c][i] += 3 * l->noise * sqrt(l->rate) *
                             sin(2 * 3.141592653589793 * frequency * l->time[i] + c);
}

static void offset(test_log *l, double seconds)
{
    for (size_t i = 0; i < l->rows; i++)
        l->time[i] += seconds;
}

static void stretch(test_log *l, double share)
{
    for (size_t i = 0; i < l->rows; i++)
        l->time[i] *= 1 + share;
}

static void lack_values(test_log *l, double share)
{
    for (size_t i = 0; i < l->rows; i++)
        if (uniform() < share)
            l->gyro[below(AXES)][i] = nan_value;
}

static void move_row(test_log *l, size_t from, size_t to)
{
    l->time[to] = l->time[from];
    l->place[to] = l->place[from];
    for (int c = 0; c < AXES; c++)
        l->gyro[c][to] = l->gyro[c][from];
}

static void lose_rows(test_log *l, double share)
{
    size_t kept = 1;
    for (size_t i = 1; i < l->rows; i++)
        if (uniform() >= share || i + 1 == l->rows)
            move_row(l, i, kept++);
    l->rows = kept;
}

/* Gaps of 20 to 120 rows. */
static void lose_blocks(test_log *l, double blocks)
{
    for (int b = 0; b < (int)blocks; b++) {
        const size_t first = 300 + below(l->rows - 900), length = 20 + below(101);
        for (size_t i = first + length; i < l->rows; i++)
            move_row(l, i, i - length);
        l->rows -= length;
    }
}

/* Some rows twice. */
static void double_rows(test_log *l, double share)
{
    size_t more = (size_t)(share * (double)l->rows), at = l->rows + more;
    for (size_t i = l->rows; i-- > 0;) {
        move_row(l, i, --at);
        if (more > 0 && (double)more >= share * (double)i) {
            move_row(l, i, --at);
            more--;
        }
    }
    l->rows += (size_t)(share * (double)l->rows);
}

/* The rows of a log of `ratio` times the rate hold the samples of this one. */
static void hold(test_log *l, double ratio)
{
    const size_t rows = (size_t)((double)l->rows * ratio);
    for (size_t i = rows; i-- > 0;) {
        move_row(l, (size_t)((double)i / ratio), i);
        l->time[i] = (double)i / (ratio * l->rate);
        l->place[i] = i;
    }
    l->rows = rows;
    l->rate *= ratio;
}

/* The gyros have values in every row of so many only, as a slower sensor in the same table has. */
static void leave_blank(test_log *l, double every)
{
    for (size_t i = 0; i < l->rows; i++)
        for (int axis = 0; axis < 3 && i % (size_t)every != 0; axis++)
            l->gyro[axis][i] = (double)NAN;
}

/* Rows of the gyros without values, at random. */
static void lose_values(test_log *l, double share)
{
    for (size_t i = 0; i < l->rows; i++)
        for (int axis = 0; axis < 3 && fmod(0.6180339887498949 * (double)(i * i), 1) < share;
             axis++)
            l->gyro[axis][i] = (double)NAN;
}

/* The first rows of every twentieth packet are those of the packet before. */
static void repeat_packets(test_log *l, double packet)
{
    const size_t n = (size_t)packet;
    for (size_t i = 19 * n; i < l->rows; i++)
        for (int c = 0; c < AXES && i / n % 20 == 19; c++)
            l->gyro[c][i] = l->gyro[c][i - n];
}

/* A share of the rows, written a second time behind the others. */
static void write_again(test_log *l, double share)
{
    const size_t again = (size_t)(share * (double)l->rows), first = (l->rows - again) / 2;
    for (size_t i = 0; i < again; i++) {
        move_row(l, first + i, l->rows + i);
        l->time[l->rows + i] = (double)(l->rows + i) / l->rate;
    }
    l->rows += again;
}

/* Other noise of the whole log, in the middle of which it stands still at the value where it
 * began to. */
static void stand_still(test_log *l, double share)
{
    const size_t still = (size_t)(share * (double)l->rows);
    for (size_t part = 0; part < 2; part++)
        for (size_t i = 0; i < still; i++)
            for (int c = 0; c < AXES; c++)
                l->gyro[c][part * l->rows / 2 + i] = l->gyro[c][0];
}

/* A tone of a period of whole rows, which repeats where digits are coarse. */
static void repeat_tone(test_log *l, double period)
{
    for (size_t i = 0; i < l->rows; i++)
        for (int c = 0; c < AXES; c++)
            l->gyro[c][i] =
                0.2 * l->gyro[c][i] +
                5 * l->noise * sqrt(l->rate) * sin(2 * 3.141592653589793 * (double)i / period + c);
}

/* Only the first axis has noise, and that is slow. */
static void wander(test_log *l, double pole)
{
    double level = 0;
    for (size_t i = 0; i < l->rows; i++) {
        level += pole * (l->gyro[0][i] / sqrt(pole / 2) - level);
        l->gyro[0][i] = level;
        for (int c = 1; c < AXES; c++)
            l->gyro[c][i] = level > 0 ? 0 : l->noise;
    }
}

/* Digits of a share of the noise. */
static void round_values(test_log *l, double share)
{
    const double unit = share * l->noise * sqrt(l->rate);
    for (size_t i = 0; i < l->rows; i++)
        for (int c = 0; c < AXES; c++)
            l->gyro[c][i] = floor(l->gyro[c][i] / unit + 0.5) * unit;
}

typedef struct fault {
    void (*make)(test_log *, double);
    double strength;
} fault;

static void apply(test_log *l, const fault *faults)
{
    for (const fault *f = faults; f->make; f++)
        f->make(l, f->strength);
}

/* ---- what the job makes of it ---- */

static imk_record_source source_of(const test_log *l, double rate, imk_array_source *memory)
{
    static const char *const names[] = {"time", "gyro_x", "gyro_y", "gyro_z"};
    const double *const data[] = {l->time, l->gyro[0], l->gyro[1], l->gyro[2]};
    imk_record_source source;
    imk_error error;
    CHECK_OK(imk_array_source_make(4, names, data, l->rows, rate, memory, &source, &error));
    return source;
}

static const imk_finding *find(const imk_findings *findings, const char *code)
{
    for (size_t k = 0; k < findings->count; k++)
        if (strcmp(findings->item[k].code, code) == 0)
            return &findings->item[k];
    return NULL;
}

/* Any doubt about the stamps, or about rows written again? */
static const char *doubt_of(const imk_findings *findings)
{
    for (size_t k = 0; k < findings->count; k++)
        if ((strncmp(findings->item[k].code, "stamps:", 7) == 0 ||
             strcmp(findings->item[k].code, "packets") == 0 ||
             strcmp(findings->item[k].code, "replayed") == 0) &&
            findings->item[k].level == IMK_FINDING_WARNING)
            return findings->item[k].code;
    return NULL;
}

static void load(const test_log *l, imk_even_record *even, imk_findings *findings)
{
    imk_array_source memory;
    imk_error error;
    const imk_job job = {.memory = 0};
    const imk_record_source source = source_of(l, 0, &memory);
    findings->count = 0;
    CHECK_OK(imk_even_record_load(&source, IMK_GAPS_KEEP, &job, even, findings, &error));
}

/* Rows whose value is not within `off` samples of its place. */
static size_t misplaced(const test_log *l, const imk_even_record *even, size_t off)
{
    const double *data = imk_even_record_data(even, 0);
    size_t wrong = 0;
    for (size_t i = 0; i < l->rows; i++) {
        const size_t due = l->place[i] - l->place[0];
        bool found = isnan(l->gyro[0][i]);
        for (size_t at = due > off ? due - off : 0; at <= due + off && at < even->rows; at++)
            found = found || data[at] == l->gyro[0][i];
        wrong += !found;
    }
    return wrong;
}

typedef struct kind {
    const char *code; /* told with each strength; NULL: nothing about stamps */
    fault faults[5];
    size_t off;        /* places that the stamps leave open */
    double wrong_most; /* share of the rows beyond that */
    double rate;
    size_t rows;
} kind;

static void check_kind(const kind *k, uint64_t seed)
{
    static test_log l;
    imk_even_record even;
    imk_findings findings;
    const double rate = k->rate > 0 ? k->rate : 100;
    make(&l, seed, k->rows > 0 ? k->rows : ROWS, rate);
    apply(&l, k->faults);
    load(&l, &even, &findings);
    const size_t wrong = misplaced(&l, &even, k->off);
    if ((double)wrong > k->wrong_most * (double)l.rows)
        fail_msg("%s, seed %d: %zu rows misplaced", k->code ? k->code : "sound", (int)seed, wrong);
    const double due = (double)(l.place[l.rows - 1] + 1);
    CHECK_CLOSE((double)even.rows, due, (double)k->off + k->wrong_most * due);
    CHECK_RELATIVE(even.dt * l.rate, 1.0, 2e-3);
    if (k->code && !find(&findings, k->code))
        fail_msg("%s is not told, seed %d", k->code, (int)seed);
    if (!k->code && doubt_of(&findings))
        fail_msg("%s is told of a sound log, seed %d", doubt_of(&findings), (int)seed);
    imk_even_record_free(&even);
}

/* All rows are kept and on their places. Losses among stamps that are coarse or late are known to a
 * place only as far as the stamps show it. */
static void test_every_row_has_its_place(void **context)
{
    (void)context;
    static const kind kinds[] = {
        {"stamps:coarse_stamps", {{group, 2}}, 0, 0, 0, 0},
        {"stamps:coarse_stamps", {{group, 3}}, 0, 0, 0, 0},
        {"stamps:coarse_stamps", {{round_down, 1}}, 0, 0, 0, 0},
        {"stamps:coarse_stamps", {{round_down, 1}}, 0, 0, 99.7, 0},
        {"stamps:coarse_stamps", {{round_down, 1}, {offset, 1.7e9}}, 0, 0, 0, 0},
        {"stamps:coarse_stamps", {{round_times, 1e-3}}, 0, 0, 2500, 0},
        {"stamps:coarse_stamps", {{group, 2}, {lose_blocks, 3}}, 1, 0.02, 0, 0},
        {"stamps:coarse_stamps",
         {{group, 10}, {lose_blocks, 3}, {lack_values, 0.01}},
         10,
         0.02,
         0,
         0},
        {"stamps:coarse_stamps", {{round_down, 1}, {lose_blocks, 2}}, 100, 0.02, 0, 0},
        {"stamps:coarse_stamps", {{group, 2}, {lose_rows, 0.02}}, 2, 0.02, 0, 0},
        {"stamps:bunched", {{bunch, 4}}, 0, 0, 0, 0},
        {"stamps:bunched", {{bunch, 20}}, 0, 0, 0, 0},
        {"stamps:bunched", {{bunch, 8}, {lose_blocks, 2}}, 8, 0.02, 0, 0},
        {"stamps:late", {{burst, 300}}, 0, 0, 0, 0},
        {"stamps:late", {{burst, 100}}, 0, 0, 0, 0},
        {"stamps:late", {{burst, 30}, {offset, 1.7e9}}, 0, 0, 0, 0},
        {"stamps:late", {{burst, 300}, {lose_blocks, 3}, {lack_values, 0.01}}, 20, 0.01, 0, 0},
        {"stamps:late", {{burst, 100}, {lose_rows, 0.01}}, 20, 0.02, 0, 0},
        {"stamps:late", {{delay, 1}}, 1, 0.01, 0, 0},
        {"stamps:late", {{delay, 3}}, 5, 0.02, 0, 0},
        {"stamps:late", {{delay, 1}, {lose_blocks, 2}}, 10, 0.02, 0, 0},
        {"stamps:alternate", {{alternate, 0.2}}, 0, 0, 0, 0},
        {"stamps:alternate", {{alternate, 0.4}}, 0, 0, 0, 0},
        {"stamps:jumps", {{step_back, 0.3}}, 0, 0, 0, 0},
        {"stamps:jumps", {{step_back, 500}}, 0, 0, 0, 0},
        {"stamps:wrapped", {{wrap, 4.294967296}}, 0, 0, 0, 0},
        {"stamps:wrapped", {{wrap, 60}, {round_times, 1e-6}}, 0, 0, 128, 9000},
        {"stamps:rounded", {{round_times, 1e-3}}, 0, 0, 700, 0},
        {"stamps:rounded", {{round_times, 1e-3}}, 0, 0, 950, 0},
    };
    const int seeds = check_quick() ? 1 : 4;
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++)
        for (int seed = 1; seed <= seeds; seed++)
            check_kind(&kinds[k], (uint64_t)seed);
}

/* No doubt about the stamps of sound logs, and the same places: 12 kinds of 8 logs in each run. */
static void test_sound_stamps(void **context)
{
    (void)context;
    static const kind kinds[] = {
        {NULL, {{stretch, 1e-4}}, 0, 0, 0, 0},
        {NULL, {{scatter, 0.02}, {round_times, 1e-6}}, 0, 0, 0, 0},
        {NULL, {{scatter, 0.05}}, 0, 0, 250, 0},
        {NULL, {{scatter, 0.035}, {lose_rows, 0.01}}, 0, 0, 0, 0},
        {NULL, {{round_times, 1e-3}}, 0, 0, 128, 0},
        {NULL, {{round_times, 1e-3}}, 0, 0, 400, 0},
        {NULL, {{round_times, 1e-3}, {lose_blocks, 3}}, 0, 0, 128, 0},
        {NULL, {{round_times, 1e-3}, {lose_blocks, 3}}, 0, 0, 400, 0},
        {NULL, {{round_times, 1e-6}, {lose_blocks, 4}, {offset, 1.7e9}}, 0, 0, 0, 0},
        {NULL, {{lose_rows, 0.05}}, 0, 0, 0, 0},
        {NULL, {{lose_rows, 0.3}, {round_times, 1e-6}}, 0, 0, 0, 0},
        {NULL, {{round_values, 1}, {lack_values, 0.02}}, 0, 0, 0, 0},
        {NULL, {{round_values, 2}}, 0, 0, 0, 0},
    };
    const int seeds = check_quick() ? 1 : 8;
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++)
        for (int seed = 1; seed <= seeds; seed++)
            check_kind(&kinds[k], (uint64_t)(100 + seed));
}

/* ---- what cannot be repaired is told ---- */

static void check_told(const char *code, const fault *faults, double least, double most, int number)
{
    static test_log l;
    imk_even_record even;
    imk_findings findings;
    for (uint64_t seed = 1; seed <= 2; seed++) {
        make(&l, seed, ROWS, 100);
        apply(&l, faults);
        load(&l, &even, &findings);
        const imk_finding *f = find(&findings, code);
        if (!f)
            fail_msg("%s is not told, seed %d, %g and %g", code, (int)seed, faults[0].strength,
                     faults[0].make ? faults[1].strength : 0);
        assert_true(f->number[number] >= least && f->number[number] <= most);
        assert_int_equal(findings.count, 1 + (find(&findings, "jitter") != NULL) +
                                             (find(&findings, "stamps:late") != NULL) +
                                             (find(&findings, "missing") != NULL));
        imk_even_record_free(&even);
    }
}

static void test_two_rates(void **context)
{
    (void)context;
    const double ratios[] = {1.25, 1.6, 2};
    for (int k = 0; k < 3; k++)
        check_told("stamps:two_rates", (fault[]){{change_rate, ratios[k]}, {NULL, 0}}, 50, 110, 0);
}

static void test_doubled_rows(void **context)
{
    (void)context;
    check_told("doubled", (fault[]){{double_rows, 0.005}, {NULL, 0}}, 30, 30, 0);
    check_told("stamps:doubled", (fault[]){{double_rows, 0.05}, {NULL, 0}}, 300, 300, 0);
    check_told("stamps:doubled", (fault[]){{double_rows, 1}, {NULL, 0}}, 6000, 6000, 0);
}

/* The share of rows held, and the rate of the sensor, also where digits repeat by chance. */
static void test_held_samples(void **context)
{
    (void)context;
    static const double ratios[] = {1.02, 1.1, 1.5, 2}, digits[] = {1e-6, 0.3, 1, 2};
    for (int r = 0; r < 4; r++)
        for (int d = 0; d < (r < 2 ? r + 2 : 4); d++) /* few do not stand out of coarse digits */
            check_told("stamps:held",
                       (fault[]){{round_values, digits[d]}, {hold, ratios[r]}, {NULL, 0}}, 98.5,
                       101.5, 1);
}

/* Values at even distances are those of a slower sensor; values lost at random are none. */
static void test_blank_rows(void **context)
{
    (void)context;
    static test_log l;
    imk_even_record even;
    imk_findings findings;
    for (int every = 2; every <= 10; every += 4) {
        make(&l, 3, ROWS, 100);
        leave_blank(&l, every);
        load(&l, &even, &findings);
        const imk_finding *f = find(&findings, "stamps:sparse");
        assert_non_null(f);
        assert_string_equal(f->name, "gyro");
        CHECK_RELATIVE(f->number[1], 100.0 / every, 0.01);
        CHECK_RELATIVE(f->number[3], sqrt(every), 0.01);
        imk_even_record_free(&even);
    }
    for (double share = 0.1; share < 0.7; share += 0.2) {
        make(&l, 3, ROWS, 100);
        lose_values(&l, share);
        load(&l, &even, &findings);
        assert_null(find(&findings, "stamps:sparse"));
        imk_even_record_free(&even);
    }
}

/* The number of rows in a packet, also where digits repeat by chance. */
static void test_packets_written_again(void **context)
{
    (void)context;
    static const double packets[] = {2, 5, 10, 64}, digits[] = {1e-6, 0.3, 1};
    for (int p = 0; p < 4; p++)
        for (int d = 0; d < 3; d++)
            check_told(
                "packets",
                (fault[]){{round_values, digits[d]}, {repeat_packets, packets[p]}, {NULL, 0}},
                packets[p], packets[p], 1);
}

/* A part that is written twice is told, with when it begins again, whatever the digits; so is a
 * whole log with a clock that begins again. */
static void test_replayed(void **context)
{
    (void)context;
    static test_log l;
    static const double shares[] = {0.1, 0.4, 1}, digits[] = {1e-6, 0.3, 1, 2};
    for (int s = 0; s < 3; s++)
        for (int d = 0; d < 4; d++) {
            imk_even_record even;
            imk_findings findings;
            make(&l, (uint64_t)(7 * s + d), ROWS, 100);
            round_values(&l, digits[d]);
            write_again(&l, shares[s]);
            load(&l, &even, &findings);
            const imk_finding *told = find(&findings, "replayed");
            assert_non_null(told);
            assert_int_equal(told->level, IMK_FINDING_WARNING);
            CHECK_RELATIVE(told->number[0], 100 * shares[s] / (1 + shares[s]), 0.1);
            CHECK_CLOSE(told->number[1], 60, 0.3);
            CHECK_CLOSE(told->number[2], 30 * (1 - shares[s]), 0.3);
            imk_even_record_free(&even);
        }
    make(&l, 1, ROWS, 100);
    write_again(&l, 1);
    for (size_t i = ROWS; i < l.rows; i++)
        l.time[i] = l.time[i - ROWS];
    imk_even_record even;
    imk_findings findings;
    load(&l, &even, &findings);
    assert_non_null(find(&findings, "replayed"));
    imk_even_record_free(&even);
}

/* Rows that come again by chance: of coarse digits, of a sensor that stands still, of a tone, of
 * slow noise on few values. */
static void test_rows_by_chance(void **context)
{
    (void)context;
    static test_log l;
    static const fault cases[][3] = {{{sound, 0}, {round_values, 3}, {NULL, 0}},
                                     {{sound, 0}, {round_values, 5}, {NULL, 0}},
                                     {{stand_still, 0.2}, {NULL, 0}},
                                     {{repeat_tone, 4}, {round_values, 1}, {NULL, 0}},
                                     {{repeat_tone, 100}, {round_values, 1}, {NULL, 0}},
                                     {{wander, 0.01}, {round_values, 1}, {NULL, 0}},
                                     {{wander, 0.1}, {round_values, 1}, {NULL, 0}}};
    for (int k = 0; k < 7; k++)
        for (uint64_t seed = 0; seed < 4; seed++) {
            imk_even_record even;
            imk_findings findings;
            make(&l, seed, MOST, 100);
            apply(&l, cases[k]);
            load(&l, &even, &findings);
            assert_null(find(&findings, "replayed"));
            imk_even_record_free(&even);
        }
}

static void test_a_stated_rate(void **context)
{
    (void)context;
    static test_log l;
    const struct {
        double rate;
        bool told;
    } cases[] = {{100, false}, {100.05, false}, {101, true}, {50, true}, {200, true}, {333, true}};
    make(&l, 1, ROWS, 100);
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        imk_array_source memory;
        imk_even_record even;
        imk_findings findings = {.count = 0};
        imk_error error;
        const imk_job job = {.memory = 0};
        const imk_record_source source = source_of(&l, cases[k].rate, &memory);
        CHECK_OK(imk_even_record_load(&source, IMK_GAPS_KEEP, &job, &even, &findings, &error));
        assert_int_equal(even.rows, ROWS);
        CHECK_CLOSE(even.dt, 1 / cases[k].rate, 0);
        const imk_finding *f = find(&findings, "stamps:rate_differs");
        assert_int_equal(f != NULL, cases[k].told);
        if (f)
            CHECK_RELATIVE(f->number[1], 100, 1e-9);
        imk_even_record_free(&even);
    }
}

/* Times of random events are those of no rate. */
static void test_no_rate(void **context)
{
    (void)context;
    static test_log l;
    imk_array_source memory;
    imk_even_record even;
    imk_findings findings = {.count = 0};
    imk_error error;
    const imk_job job = {.memory = 0};
    make(&l, 1, ROWS, 100);
    for (size_t i = 1; i < l.rows; i++)
        l.time[i] = l.time[i - 1] - 0.01 * log(1 - uniform());
    const imk_record_source source = source_of(&l, 0, &memory);
    CHECK_STATUS(imk_even_record_load(&source, IMK_GAPS_KEEP, &job, &even, &findings, &error),
                 IMK_ERROR_TIME_ORDER);
    assert_string_equal(imk_findings_failure(&findings)->code, "no_grid");
    imk_even_record_free(&even);
}

/* Why there is no rate: each case has its own reason. */
static void check_reason(const test_log *l, imk_gap_policy gaps, imk_status expected,
                         const char *code)
{
    imk_array_source memory;
    imk_even_record even;
    imk_findings findings = {.count = 0};
    imk_error error;
    char text[900];
    const imk_job job = {.memory = 0};
    const imk_record_source source = source_of(l, 0, &memory);
    CHECK_STATUS(imk_even_record_load(&source, gaps, &job, &even, &findings, &error), expected);
    const imk_finding *last = &findings.item[findings.count - 1];
    assert_string_equal(last->code, code);
    imk_finding_text(last, text, sizeof text);
    assert_null(strstr(text, "nan"));
    assert_null(strstr(text, "scatter"));
    imk_even_record_free(&even);
}

static void test_why_there_is_no_rate(void **context)
{
    (void)context;
    static test_log l;
    make(&l, 1, ROWS, 100);
    for (size_t i = 0; i < ROWS; i++)
        l.time[i] = 7;
    check_reason(&l, IMK_GAPS_KEEP, IMK_ERROR_TIME_ORDER, "time_constant");
    for (size_t i = 0; i < ROWS; i++)
        l.time[i] = 0.01 * (double)(ROWS - i);
    check_reason(&l, IMK_GAPS_KEEP, IMK_ERROR_TIME_ORDER, "time_backwards");
    for (size_t i = 0; i < ROWS; i++) /* blocks of a second, the last first */
        l.time[i] = 0.01 * (double)(ROWS - 100 - i / 100 * 100 + i % 100);
    check_reason(&l, IMK_GAPS_KEEP, IMK_ERROR_TIME_ORDER, "time_order");
    check_reason(&l, IMK_GAPS_LONGEST, IMK_OK, "stamps:short_stretch");
    make(&l, 1, ROWS, 100);
    for (size_t i = 0; i < ROWS / 5; i++) /* the clock is not set yet */
        l.time[i] = 0;
    check_reason(&l, IMK_GAPS_KEEP, IMK_ERROR_TIME_ORDER, "time_stands");
    make(&l, 1, MOST, 10);
    round_down(&l, 128);
    check_reason(&l, IMK_GAPS_KEEP, IMK_ERROR_TIME_ORDER, "time_digits");
    make(&l, 1, ROWS, 100); /* half of the log is no short stretch */
    l.gyro[0][ROWS / 2] = nan_value;
    check_reason(&l, IMK_GAPS_LONGEST, IMK_OK, "stamps:longest_stretch");
}

/* ---- the estimates ---- */

/* The white noise of the first channels is that of the same log with sound stamps. */
static void check_noise(const fault *faults, uint64_t seed)
{
    static test_log l;
    double clean = 0;
    for (int faulty = 0; faulty < 2; faulty++) {
        imk_array_source memory;
        imk_identify_log *found;
        imk_error error;
        const imk_identify_log_settings settings = imk_identify_log_default();
        make(&l, seed, ROWS, 100);
        if (faulty)
            apply(&l, faults);
        const imk_record_source source = source_of(&l, 0, &memory);
        CHECK_OK(imk_identify_log_run(&source, &settings, NULL, &found, &error));
        const double n = found->result[0].term[IMK_NOISE_WHITE].value;
        if (faulty)
            CHECK_RELATIVE(n, clean, 0.01);
        clean = n;
        imk_identify_log_free(found);
    }
}

static void test_noise(void **context)
{
    (void)context;
    check_noise((fault[]){{group, 2}, {NULL, 0}}, 1);
    check_noise((fault[]){{round_down, 1}, {NULL, 0}}, 2);
    check_noise((fault[]){{burst, 100}, {NULL, 0}}, 3);
    check_noise((fault[]){{delay, 1}, {NULL, 0}}, 4);
    check_noise((fault[]){{step_back, 5}, {NULL, 0}}, 5);
}

/* The verdict of held samples, of late rows, of a column given twice, of axes with one noise and of
 * rows written again is no all-clear, and begins with a short sentence. */
static void test_verdict(void **context)
{
    (void)context;
    static test_log l;
    static const fault faults[][2] = {
        {{hold, 1.5}, {NULL, 0}},      {{burst, 100}, {NULL, 0}},  {{copy_axis, 2}, {NULL, 0}},
        {{follow_axis, 2}, {NULL, 0}}, {{mix_axis, 2}, {NULL, 0}}, {{repeat_packets, 5}, {NULL, 0}},
        {{write_again, 1}, {NULL, 0}}};
    static const char *const codes[] = {"held",       "late",    "copy",    "follows",
                                        "correlated", "packets", "replayed"};
    static const char *const sentences[] = {
        "Usable with care: rows repeat the samples of a slower sensor",
        "Usable with care: rows are stamped late",
        "Usable with care: a column is the copy of another",
        "Usable with care: a column is computed from another",
        "Usable with care: axes share their noise",
        "Usable with care: rows are written twice in place of others",
        "Usable with care: a part of the log is written a second time"};
    for (int k = 0; k < 7; k++) {
        imk_array_source memory;
        imk_identify_log *found;
        imk_error error;
        const imk_identify_log_settings settings = imk_identify_log_default();
        make(&l, 7, ROWS, 100);
        apply(&l, faults[k]);
        const imk_record_source source = source_of(&l, 0, &memory);
        CHECK_OK(imk_identify_log_run(&source, &settings, NULL, &found, &error));
        imk_result *result = imk_result_create(NULL);
        const imk_verdict verdict = imk_identify_verdict(found, NULL, result);
        bool told = false;
        for (size_t m = 0; m < verdict.count; m++)
            told = told || (strcmp(verdict.message[m].code, codes[k]) == 0 &&
                            verdict.message[m].level == IMK_FINDING_WARNING);
        assert_true(told);
        const char *sentence = imk_identify_sentence(&verdict);
        assert_memory_equal(sentence, sentences[k], strlen(sentences[k]));
        imk_result_free(result);
        imk_identify_log_free(found);
    }
}

/* An accelerometer that follows a gyro is told; what all axes feel at some frequencies is not. */
static void test_noise_of_both_sensors(void **context)
{
    (void)context;
    static test_log l;
    static const char *const names[] = {"time", "gyro_x", "gyro_y", "accel_z"};
    static const fault faults[] = {{sound, 0}, {hum, 7}, {resonate, 3}, {mix_axis, 2}};
    for (int k = 0; k < 4; k++) {
        imk_array_source memory;
        imk_record_source source;
        imk_identify_log *found;
        imk_error error;
        const imk_identify_log_settings settings = imk_identify_log_default();
        make(&l, 11, ROWS, 100);
        faults[k].make(&l, faults[k].strength);
        const double *const data[] = {l.time, l.gyro[0], l.gyro[1], l.gyro[2]};
        CHECK_OK(imk_array_source_make(4, names, data, l.rows, 0, &memory, &source, &error));
        CHECK_OK(imk_identify_log_run(&source, &settings, NULL, &found, &error));
        const imk_finding *told = find(&found->findings, "correlated");
        assert_int_equal(told != NULL, k == 3);
        if (told) {
            assert_int_equal(told->level, IMK_FINDING_WARNING);
            assert_string_equal(told->name, "accel_z\tgyro_y");
        }
        imk_identify_log_free(found);
    }
}

/* A record that is not held in memory has the same places: two rows per stamp, and a gap. */
static void test_long_record(void **context)
{
    (void)context;
    enum { LONG = (1 << 21) + 300000, GAP = 50 };
    double *time = malloc(LONG * sizeof *time), *gyro = malloc(LONG * sizeof *gyro);
    assert_non_null(time);
    assert_non_null(gyro);
    state = 1;
    for (size_t i = 0; i < LONG; i++) {
        const size_t place = i < 1000000 ? i : i + GAP;
        time[i] = 0.02 * (double)(place / 2);
        gyro[i] = 1e-3 * normal();
    }
    const char *const names[] = {"time", "gyro_x"};
    const double *const data[] = {time, gyro};
    imk_array_source memory;
    imk_record_source source;
    imk_identify_log *found;
    imk_error error;
    const imk_identify_log_settings settings = imk_identify_log_default();
    CHECK_OK(imk_array_source_make(2, names, data, LONG, 0, &memory, &source, &error));
    CHECK_OK(imk_identify_log_run(&source, &settings, NULL, &found, &error));
    assert_true(found->screened);
    assert_int_equal(found->record.rows, LONG + GAP);
    assert_int_equal(found->record.missing, GAP);
    CHECK_RELATIVE(found->record.dt, 0.01, 1e-6);
    CHECK_RELATIVE(found->result[0].term[IMK_NOISE_WHITE].value, 1e-4, 0.01);
    assert_non_null(find(&found->findings, "stamps:coarse_stamps"));
    imk_identify_log_free(found);
    free(time);
    free(gyro);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_row_has_its_place),
        cmocka_unit_test(test_sound_stamps),
        cmocka_unit_test(test_two_rates),
        cmocka_unit_test(test_doubled_rows),
        cmocka_unit_test(test_held_samples),
        cmocka_unit_test(test_blank_rows),
        cmocka_unit_test(test_packets_written_again),
        cmocka_unit_test(test_replayed),
        cmocka_unit_test(test_rows_by_chance),
        cmocka_unit_test(test_a_stated_rate),
        cmocka_unit_test(test_no_rate),
        cmocka_unit_test(test_why_there_is_no_rate),
        cmocka_unit_test(test_noise),
        cmocka_unit_test(test_verdict),
        cmocka_unit_test(test_noise_of_both_sensors),
        cmocka_unit_test(test_long_record),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
