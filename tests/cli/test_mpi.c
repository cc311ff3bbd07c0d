/* SPDX-License-Identifier: Apache-2.0 */
/* imukit-mpi: the bytes of one process from any number of ranks, and an end in every case. Skipped
 * where it was not built or mpirun is not there. */
#include "run_command.h"

#ifndef IMUKIT_MPI_COMMAND
#define IMUKIT_MPI_COMMAND ""
#endif

static const char model[] =
    "imukit: 1\n"
    "gyro: {bias: {repeatability: 0 deg/h}, " NO_OTHER_GYRO_TERM_THAN(
        "0.3 deg/sqrt(h)") "}\n"
                           "accel: {bias: {repeatability: 0 mg}, " NO_OTHER_ACCEL_TERM_THAN(
                               "0.1 m/s/sqrt(h)") "}\n";

#define DRIFT " drift m.yaml --duration 20s --seed 3 --monte-carlo 100 "
/* A rank that waits for another for ever would be a fault: it is given a minute. mpirun makes a
 * terminal of standard output. */
#define RANKS(n) "NO_COLOR=1 timeout 60 mpirun -n " #n " $M"

/* As root, and with more ranks than processors: Open MPI wants to be told. */
static bool mpi_is_there(void)
{
    setenv("M", IMUKIT_MPI_COMMAND, 1);
    setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
    setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
    setenv("OMPI_MCA_rmaps_base_oversubscribe", "1", 1);
    return *IMUKIT_MPI_COMMAND && run("command -v mpirun") == 0;
}

static void ranks_and_threads_do_not_matter(void **state)
{
    (void)state;
    if (!mpi_is_there())
        skip();
    put("m.yaml", model);
    assert_int_equal(run("$I" DRIFT "-o one.h5"), 0);
    static char expected[TEXT_SIZE], said[TEXT_SIZE];
    strcpy(expected, out);
    strcpy(said, err);
    assert_int_equal(run(RANKS(1) DRIFT "-o r1.h5"), 0);
    assert_int_equal(run(RANKS(3) DRIFT "-o r3.h5"), 0);
    /* What is printed is printed once. */
    assert_string_equal(out, expected);
    assert_string_equal(err, said);
    assert_int_equal(run(RANKS(2) DRIFT "-o r2.h5 --threads 2"), 0);
    assert_int_equal(run("cmp one.h5 r1.h5 && cmp one.h5 r2.h5 && cmp one.h5 r3.h5"), 0);
    sweep();
}

static void every_run_ends(void **state)
{
    (void)state;
    if (!mpi_is_there())
        skip();
    put("m.yaml", model);
    /* No campaign at all. */
    assert_int_equal(run(RANKS(2) " --version"), 0);
    assert_string_equal(out, "imukit " IMK_VERSION "\n");
    /* An error that only the rank that keeps the books can find. */
    put("x.h5.part", "a letter, which someone may want to keep");
    assert_int_equal(run(RANKS(2) DRIFT "-o x.h5"), 1);
    check_contains(err,
                   "imukit drift: error: x.h5.part: the file is not from an interrupted campaign",
                   "a part of something else");
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ranks_and_threads_do_not_matter),
        cmocka_unit_test(every_run_ends),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
