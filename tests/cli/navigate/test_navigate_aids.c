/* SPDX-License-Identifier: Apache-2.0 */
/* imukit navigate --aid: a simulated drive with a GNSS receiver, the columns of tables, clocks, and
 * what is refused. */
#include "cli/run_command.h"

#define PLACE "--position '45 deg, 7 deg, 300 m'"
#define REST "$I navigate rest.csv --position '45 deg, 10 deg, 100 m' --attitude '0 0 0 +- 1 deg' "

static double after(const char *text, const char *key)
{
    const char *at = strstr(text, key);
    assert_non_null(at);
    return atof(at + strlen(key));
}

static void put_drive(void)
{
    put("drive.yaml",
        "imukit_motion: 1\n"
        "start: {latitude: 45 deg, longitude: 7 deg, height: 300 m, heading: 90 deg}\n"
        "steps:\n"
        "  - hold 30 s\n"
        "  - accelerate to 15 m/s at 2 m/s^2\n"
        "  - hold 20 s\n"
        "  - turn right 90 deg at 15 deg/s\n"
        "  - hold 40 s\n"
        "  - turn left 120 deg at 15 deg/s\n"
        "  - hold 60 s\n");
    put("unit.yaml", "imukit: 1\n"
                     "gyro: {bias: {repeatability: 1 deg/h},"
                     " noise: {angle_random_walk: 0.1 deg/sqrt(h)}}\n"
                     "accel: {bias: {repeatability: 0.5 mg}, noise: {density: two-sided,"
                     " velocity_random_walk: 50 ug/sqrt(Hz)}}\n");
}

static void simulate_drive(void)
{
    assert_int_equal(run("$I simulate unit.yaml --motion drive.yaml --rate 50Hz --seed 4 --truth "
                         "truth.csv -o drive.csv --aid 'position 1 1 2 m, velocity 0.05 m/s' "
                         "--aid-lever-arm '1 -0.5 -1.5 m' --aid-output gnss.csv"),
                     0);
    assert_string_equal(err, "");
}

#define DRIVE                                                                                      \
    "$I navigate drive.csv " PLACE " --align 25s --heading '91 +- 2 deg' --model unit.yaml --aid " \
    "gnss.csv --aid-lever-arm '1 -0.5 -1.5 m' "

#define ARM                                                                                        \
    "$I navigate drive.csv " PLACE " --align 25s --heading '91 +- 2 deg' --model unit.yaml --aid " \
    "gnss.csv --json --aid-sigma 'position 1 m, velocity 0.1 "

#define MILLISECONDS                                                                               \
    "$I navigate drive.csv " PLACE " --align 25s --heading '91 +- 2 deg' --model unit.yaml --aid " \
    "ms.csv --strict"
#define ANYWHERE "--align 25s --heading '91 +- 2 deg' --model unit.yaml --aid gnss.csv"
#define SLOW                                                                                       \
    "$I navigate drive.csv " PLACE " --align 25s --heading '91 +- 2 deg' --model unit.yaml --aid " \
    "slow.csv --aid-sigma 'velocity 0.1 m/s' --aid-lever-arm '1 -0.5 -1.5 m'"
#define LATE                                                                                       \
    "$I navigate drive.csv " PLACE " --align 25s --heading '91 +- 2 deg' --model unit.yaml --aid " \
    "late.csv --aid-lever-arm '1 -0.5 -1.5 m' "
#define SWAPPED                                                                                    \
    "$I navigate drive.csv " PLACE " --align 25s --heading '91 +- 2 deg' --model tactical --aid "  \
    "swapped.csv "

/* 142 readings after the alignment: 426 degrees of freedom, whose mean square is 1 with a standard
 * deviation of sqrt(2/426) = 0.07, and correlations of 0.05; four of these are allowed. The end is
 * where the truth is, to five of the sigmas that the command states; so is its height. */
static void test_drive(void **state)
{
    (void)state;
    put_drive();
    simulate_drive();
    assert_int_equal(run(DRIVE "--json -o track.csv"), 0);
    assert_string_equal(err, "");
    const char *aids = strstr(out, "\"aids\"");
    assert_non_null(aids);
    const double accepted = after(aids, "\"accepted\": ");
    assert_true(accepted > 135 && accepted < 150);
    CHECK_CLOSE(after(aids, "\"refused\": "), 0.0, 0.0);
    CHECK_CLOSE(after(aids, "\"chi_square_per_degree\": "), 1.0, 0.28);
    CHECK_CLOSE(after(aids, "\"correlation\": "), 0.0, 0.2);
    const char *velocity = strstr(aids, "\"kind\": \"velocity\"");
    assert_non_null(velocity);
    CHECK_CLOSE(after(velocity, "\"chi_square_per_degree\": "), 1.0, 0.28);
    assert_int_equal(run("tail -1 truth.csv | cut -d, -f2-4 && tail -1 track.csv | cut -d, -f2-4 "
                         "&& tail -1 track.csv | cut -d, -f14-16"),
                     0);
    double t[3], n[3], sigma[3];
    assert_int_equal(sscanf(out, "%lf,%lf,%lf %lf,%lf,%lf %lf,%lf,%lf", t, t + 1, t + 2, n, n + 1,
                            n + 2, sigma, sigma + 1, sigma + 2),
                     9);
    CHECK_BELOW(sigma[0], 1.0); /* better than a single reading */
    CHECK_CLOSE(111e3 * n[0], 111e3 * t[0], 5.0 * sigma[0]);
    CHECK_CLOSE(78e3 * n[1], 78e3 * t[1], 5.0 * sigma[1]);
    CHECK_CLOSE(n[2], t[2], 5.0 * sigma[2]);
    /* Smoothed, the sigma in the middle is smaller, and at the end the same. */
    double s[4];
    assert_int_equal(run(DRIVE "--smooth -o smooth.csv"), 0);
    assert_int_equal(run("for f in track smooth; do sed -n 70p $f.csv | cut -d, -f14; tail -1 "
                         "$f.csv | cut -d, -f14; done"),
                     0);
    assert_int_equal(sscanf(out, "%lf %lf %lf %lf", s, s + 1, s + 2, s + 3), 4);
    CHECK_BELOW(s[2], 0.9 * s[0]);
    CHECK_CLOSE(s[3], s[1], 1e-4);
    /* Times that are called ms and are s: the whole table is within 0.2 s of the log's begin. */
    assert_int_equal(run("sed 's/^time \\[s\\]/time [ms]/' gnss.csv > ms.csv; " MILLISECONDS), 1);
    check_contains(
        err, "position in ms.csv: 0 of 174 readings are used: they are from 0 to 0.173 s", "ms");
    check_contains(err, "differ by a factor of 1000 as ms and s do", "ms");
    assert_int_equal(run(DRIVE "--strict --aid-until 10s"), 1);
    check_contains(err, "none of 174 readings is used", "aligned for longer");
    check_contains(err, "--aid-until leaves none", "aligned for longer");
    /* The lever arm of one aid counts as that of all does, and goes before it. */
    assert_int_equal(run(ARM
                         "m/s' --aid-lever-arm '1 -0.5 -1.5 m' >a && " ARM
                         "m/s, lever arm 1 -0.5 -1.5 m' --aid-lever-arm '9 9 9 m' >b && cmp a b"),
                     0);
    /* An outage: compared, and told. */
    assert_int_equal(run(DRIVE "--aid-until 100s"), 0);
    check_contains(out, "s without aids the estimate is off the position read by north", "outage");
    sweep();
}

/* Columns in each other's place: an estimate that no reading fits is refused, not shown. Here the
 * filter is moved to readings that contradict each other until its velocity is beyond any vehicle's
 * or its variances are spent, whichever is first. */
static void test_swapped(void **state)
{
    (void)state;
    put_drive();
    assert_int_equal(run("sed -i 's/hold 60 s/hold 300 s/' drive.yaml"), 0);
    simulate_drive();
    assert_int_equal(run("awk -F, -v OFS=, 'NR > 1 {x = $2; $2 = $3; $3 = x} {print}' gnss.csv > "
                         "swapped.csv"),
                     0);
    assert_int_equal(run(SWAPPED), 1);
    check_contains(err, "error: drive.csv: at ", "where");
    check_contains(err, "latitude and longitude, or north and east, which may be swapped", "what");
    check_contains(err, "with latitude and longitude exchanged it would be there", "swapped");
    assert_string_equal(out, "");
    run("$I navigate drive.csv --position '-45 deg, 7 deg, 300 m' " ANYWHERE);
    check_contains(err, "with the other sign of the latitude it would be there", "south");
    run("$I navigate drive.csv --position '45 deg, -7 deg, 300 m' " ANYWHERE);
    check_contains(err, "with the other sign of the longitude it would be there", "west");
    run("$I navigate drive.csv --position '46 deg, 7 deg, 300 m' " ANYWHERE);
    check_contains(err, "is taken to be so uncertain\n", "elsewhere");
    assert_int_equal(run("(head -1 gnss.csv; tail -n +2 gnss.csv | tac) > back.csv; $I navigate "
                         "drive.csv " PLACE " --align 25s --model unit.yaml --aid back.csv"),
                     1);
    check_contains(err, "error: back.csv: 413 of 414 readings of the position are not later than ",
                   "backwards");
    /* An error that goes round in 60 readings: the advice is for the kind that has it. */
    assert_int_equal(run("awk -F, -v OFS=, 'NR > 1 {$10 += 0.15 * sin(NR / 10)} {print}' gnss.csv "
                         "> slow.csv; " SLOW),
                     0);
    check_contains(err, "--aid-sigma \"velocity SIGMA correlated SIGMA over TIME\"", "velocity");
    sweep();
}

/* Times half a second late, on a way with many turns: the readings that are refused say so, to a
 * tenth, and with the delay that is advised none is refused. */
static void test_late(void **state)
{
    (void)state;
    put_drive();
    assert_int_equal(run("sed -i '/hold 20 s/,$d' drive.yaml; echo '  - repeat: {times: 16, steps: "
                         "[hold 20 s, turn right 90 deg at 15 deg/s]}' >> drive.yaml"),
                     0);
    simulate_drive();
    assert_int_equal(
        run("awk -F, -v OFS=, 'NR > 1 {$1 += 0.5} {print}' gnss.csv > late.csv; " LATE), 0);
    check_contains(err, "the sigmas that are stated hold only if", "doubt");
    CHECK_CLOSE(after(err, "those refused look about "), 0.5, 0.1);
    CHECK_CLOSE(after(err, "late, as with --aid-delay="), 0.5, 0.1);
    assert_int_equal(run(LATE "--aid-delay 0.5s --strict"), 0);
    assert_int_equal(run(LATE "--aid-delay 1s"), 0);
    CHECK_CLOSE(after(err, "early, as with --aid-delay="), 0.5, 0.1);
    sweep();
}

/* A table of hand, a reading each second for ten seconds, at rest: names, units and signs. The unit
 * is at 100 m, known exactly: readings 2 m off with a sigma of 1 m move it, as the start is then
 * taken to be no better known than by its distance from the first of them. */
static void put_table(const char *header, const char *values)
{
    char text[4000];
    size_t used = (size_t)snprintf(text, sizeof text, "time [s],%s\n", header);
    for (int k = 5; k < 15; k++)
        used += (size_t)snprintf(text + used, sizeof text - used, "%d.25,%s\n", k, values);
    put("aid.csv", text);
}

static void test_columns(void **state)
{
    (void)state;
    static const struct {
        const char *header, *values, *options, *expected;
    } tables[] = {
        {"lat [deg],Longitude [deg],alt [m]", "45,10,102", "--aid-sigma 'position 1 m'",
         "position    10"},
        {"gnss_latitude [rad],lon [deg],h [km],sdn [m],sde [m],sdu [m]",
         "0.78539816339744831,10,0.102,1,1,1", "", "position    10"},
        {"north [m],east [m],up [m]", "0,0,2", "--aid-sigma 'position 1 m'", "position    10"},
        {"ecef_x [m],ecef_y [m],ecef_z [m]", "4449028.16,784483.70,4487419.12",
         "--aid-sigma 'position 5 m'", "position    10"},
        {"vel_north [m/s],vel_east [m/s],vel_up [m/s]", "0,0,0", "--aid-sigma 'velocity 0.1 m/s'",
         "velocity    10"},
        {"heading [deg]", "0.5", "--aid-sigma 'heading 1 deg'", "heading    10"},
        {"baro_altitude [m]", "101", "--aid-sigma 'height 1 m'", "height    10"},
        {"wheel_speed [km/h]", "0.1", "--aid-sigma 'odometer 0.1 0.2 0.2 m/s'", "odometer    10"},
        {"a [deg],b [deg]", "45,10",
         "--aid-map 'time=time [s],latitude=a [deg],longitude=b [deg]' --aid-sigma 'position 1 m'",
         "position    10"},
        {"lat [deg],lon [deg],height [m]", "45,10,100",
         "--aid-sigma 'position 1 m' --aid-interval 2s", "position     5"},
        {"lat [deg],lon [deg],height [m]", "45,10,100", "--aid-sigma 'position 1 m' --aid-delay 3s",
         "position    10"}};
    put("unit.yaml", "imukit: 1\ngyro: {}\naccel: {}\n");
    assert_int_equal(run("$I simulate unit.yaml --rate 10Hz --duration 20s --height 100m -o "
                         "rest.csv"),
                     0);
    for (size_t k = 0; k < sizeof tables / sizeof *tables; k++) {
        char line[600];
        put_table(tables[k].header, tables[k].values);
        snprintf(line, sizeof line, REST "--model unit.yaml --aid aid.csv %s", tables[k].options);
        assert_int_equal(run(line), 0);
        check_contains(out, tables[k].expected, tables[k].header);
    }
    sweep();
}

static void test_refusals(void **state)
{
    (void)state;
    static const struct {
        const char *header, *values, *options, *expected;
        int code;
    } tables[] = {
        {"lat,lon", "45,10", "--aid-sigma 'position 1 m'", "column lat has no unit", 1},
        {"lat [m],lon [deg]", "45,10", "--aid-sigma 'position 1 m'",
         "the unit of column lat does not fit; expected one such as deg", 1},
        {"lat [deg],height [m]", "45,10", "--aid-sigma 'position 1 m'",
         "there is a column of latitude, but none of longitude", 1},
        {"lat [deg],lat [deg],lon [deg]", "45,45,10", "--aid-sigma 'position 1 m'",
         "two columns are latitude", 1},
        {"lat [deg],lon [deg]", "45,10", "", "the sigma of the position is not known", 1},
        {"lat [deg],lon [deg]", "45,10", "--aid-sigma 'heading 1 deg'",
         "there is no column of the heading", 1},
        {"a,b", "45,10", "", "no column has a known name of a position", 1},
        {"lat [deg],lon [deg]", ",", "--aid-sigma 'position 1 m'", "no row has a reading", 1},
        {"lat [deg],lon [deg]", "45,10", "--aid-sigma 'position 1 m' --aid-delay -100s",
         "both must be on one clock", 1},
        {"lat [deg],lon [deg]", "45,10", "--aid-sigma 'position 1 deg'",
         "\"1 deg\" is not understood; expected one to three numbers with a unit of a length", 2},
        {"lat [deg],lon [deg]", "45,10", "--aid-sigma 'position 1 m at 2 Hz'",
         "the times are those of the table", 2},
        {"lat [deg],lon [deg]", "45,10", "--aid-sigma 'position 1 m, position 2 m'",
         "the position is stated twice", 2},
        {"lat [deg],lon [deg]", "45,10", "--aid-lever-arm '1 2 m'", "expected three lengths", 2},
        {"lat [deg],lon [deg]", "45,10", "--smooth --still-rotation 1deg/h --zero-velocity 5s",
         "--smooth cannot be used with --still-rotation", 2}};
    put("unit.yaml", "imukit: 1\ngyro: {}\naccel: {}\n");
    assert_int_equal(run("$I simulate unit.yaml --rate 10Hz --duration 20s --height 100m -o "
                         "rest.csv"),
                     0);
    for (size_t k = 0; k < sizeof tables / sizeof *tables; k++) {
        char line[600];
        put_table(tables[k].header, tables[k].values);
        snprintf(line, sizeof line, REST "--model unit.yaml --aid aid.csv %s", tables[k].options);
        assert_int_equal(run(line), tables[k].code);
        check_contains(err, tables[k].expected, tables[k].header);
    }
    assert_int_equal(run(REST "--model unit.yaml --aid aid.csv --aid second.csv"), 2);
    check_contains(err, "--aid is given twice, aid.csv and second.csv, but it takes one file",
                   "two files");
    assert_int_equal(run(REST "--aid-sigma 'position 1 m'"), 2);
    check_contains(err, "--aid-sigma is about --aid FILE", "without a file");
    assert_int_equal(run(REST "--aid aid.csv"), 2);
    check_contains(err, "--aid needs the errors of the sensors", "without a model");
    assert_int_equal(run(REST "--model unit.yaml --aid nothing.csv"), 1);
    check_contains(err, "nothing.csv", "no file");
    assert_int_equal(run("$I simulate unit.yaml --rate 10Hz --duration 2s --aid 'position 1 m'"),
                     2);
    check_contains(err, "add --aid-output FILE", "no output");
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_drive), cmocka_unit_test(test_swapped),
                                       cmocka_unit_test(test_late), cmocka_unit_test(test_columns),
                                       cmocka_unit_test(test_refusals)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
