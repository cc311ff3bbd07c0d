/* SPDX-License-Identifier: Apache-2.0 */
/* A small stack, as `ulimit -s 128` and the threads of some C libraries have it, changes nothing.
 */
#include "run_command.h"

/* The sanitizers' frames are several times as large. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define NEEDS_SMALL_FRAMES skip()
#else
#define NEEDS_SMALL_FRAMES (void)0
#endif

/* Five minutes at 10 Hz; with holes in it; and on a table that turns at another rate every 25 s. */
static void write_logs(void)
{
    assert_int_equal(run("$I simulate AHRS --rate 10Hz --duration 300s --seed 3 -o log.csv"), 0);
    assert_int_equal(run("awk -F, 'NR < 100 || NR % 200 > 9' log.csv >holes.csv"), 0);
    assert_int_equal(run("awk -F, -v OFS=, 'NR == 1 { print \"time [s],gyro_x [deg/s],"
                         "table_rate [deg/s]\"; next } { rate = 10 * int($1 / 25) - 50; "
                         "print $1, $2 + rate, rate }' log.csv >table.csv"),
                     0);
}

static void same_results(void **state)
{
    (void)state;
    NEEDS_SMALL_FRAMES;
    static const char *const lines[] = {
        "identify log.csv --threads 2 --json",
        "identify holes.csv --threads 2 --json",
        "physics rate_gyro --sweep --threads 2 --json",
        "evaluate table.csv --table-axis x --json",
    };
    static char expected[TEXT_SIZE];
    write_logs();
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        char line[200];
        snprintf(line, sizeof line, "$I %s", lines[i]);
        if (run(line) != 0)
            fail_msg("%s: %s", line, err);
        memcpy(expected, out, sizeof expected);
        snprintf(line, sizeof line, "ulimit -s 128; $I %s", lines[i]);
        const int code = run(line);
        if (code != 0 || strcmp(out, expected) != 0)
            fail_msg("%s: code %d\n%s", line, code, err);
    }
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(same_results)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
