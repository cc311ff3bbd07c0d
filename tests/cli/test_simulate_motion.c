/* SPDX-License-Identifier: Apache-2.0 */
/* imukit simulate on moving platforms: what the log, the truth and the runs have to do with one
 * another, physics that can be computed by hand, and what is refused. */
#include "run_command.h"

#include "imukit/log.h"
#include "imukit/navigate.h"

#include <math.h>

static const double standard_g = 9.80665;

static const char perfect[] = "imukit: 1\ngyro: {}\naccel: {}\n";

/* A short drive; no step lasts long, all kinds of change occur. 23 s. */
static const char drive[] =
    "imukit_motion: 1\n"
    "start: {latitude: 48 deg, longitude: 11 deg, height: 500 m, heading: 90 deg}\n"
    "steps:\n  - hold 2 s\n  - accelerate to 15 m/s at 3 m/s^2\n  - turn left 90 deg at 20 deg/s\n"
    "  - climb to 3 deg at 2 deg/s\n  - hold 1 s\n  - level at 2 deg/s\n  - stop at 3 m/s^2\n";

/* Three sines faster than the rows of a log at 100 Hz. */
static const char shaker[] = "imukit_motion: 1\nsteps: [hold 2 s]\nvibration:\n"
                             "  - sine z 2 g at 333 Hz\n  - sine x 2 g at 333 Hz phase 90 deg\n"
                             "  - sine pitch 1 deg/s at 333 Hz\n";

static imk_log load(const char *path)
{
    imk_log log;
    CHECK_OK(imk_log_load(path, NULL, NULL, &log, NULL));
    return log;
}

/* Column by name, SI units. */
static const double *column(const imk_log *log, const char *name)
{
    for (size_t c = 0; c < log->column_count; c++)
        if (strcmp(log->column[c].name, name) == 0)
            return log->data[c];
    print_error("no column %s\n", name);
    fail();
    return NULL;
}

static const char *const sensors[6] = {"gyro_x",  "gyro_y",  "gyro_z",
                                       "accel_x", "accel_y", "accel_z"};

/* Largest difference of the six sensor columns [rad/s], [m/s^2]. */
static double difference(const char *a, const char *b)
{
    double largest = 0;
    imk_log logs[2] = {load(a), load(b)};
    assert_int_equal(logs[0].rows, logs[1].rows);
    for (int i = 0; i < 6; i++)
        for (size_t k = 0; k < logs[0].rows; k++) {
            double d = fabs(column(&logs[0], sensors[i])[k] - column(&logs[1], sensors[i])[k]);
            largest = d <= largest ? largest : d;
        }
    imk_log_free(&logs[0]);
    imk_log_free(&logs[1]);
    return largest;
}

/* ---- log and truth --------------------------------------------------------------------------- */

/* A perfect unit reads the truth: to the bit without vibration; with it, to the rounding of sums
 * over the parts of a row, below 1e-12 of 2 g. The truth is a recorded motion, too, and a table
 * without time has the rate of the log. */
static void test_truth(void **state)
{
    (void)state;
    put("perfect.yaml", perfect);
    put("drive.yaml", drive);
    put("shaker.yaml", shaker);
    assert_int_equal(run("$I simulate perfect.yaml --motion drive.yaml --rate 100Hz -o p.csv "
                         "--truth t.csv && cut -d, -f1,12-17 t.csv >s.csv && cmp s.csv p.csv"),
                     0);
    assert_string_equal(err, "");
    assert_int_equal(run("$I simulate perfect.yaml --motion s.csv --truth - -o q.csv >t.csv && cmp "
                         "q.csv p.csv && cmp t.csv p.csv"),
                     0);
    assert_int_equal(run("cut -d, -f2- s.csv >u.csv && $I simulate perfect.yaml --motion u.csv "
                         "--rate 100Hz | cmp - p.csv"),
                     0);
    assert_int_equal(run("$I simulate tactical --without gyro,accel --motion drive.yaml --rate "
                         "100Hz | cmp - p.csv"),
                     0);
    assert_int_equal(run("$I simulate perfect.yaml --motion shaker.yaml --rate 100Hz -o p.csv "
                         "--truth t.csv && cut -d, -f1,12-17 t.csv >s.csv"),
                     0);
    CHECK_BELOW(difference("s.csv", "p.csv"), 1e-12 * 2 * standard_g);
    sweep();
}

static imk_navigation_state state_of(const imk_log *truth, size_t row)
{
    const imk_geodetic place = {column(truth, "latitude")[row], column(truth, "longitude")[row],
                                column(truth, "height")[row]};
    const imk_matrix3 axes = imk_ned_axes(place.latitude, place.longitude);
    const imk_vector3 velocity = {{column(truth, "vel_north")[row], column(truth, "vel_east")[row],
                                   column(truth, "vel_down")[row]}};
    const imk_matrix3 attitude = imk_matrix3_from_euler(
        column(truth, "roll")[row], column(truth, "pitch")[row], column(truth, "yaw")[row]);
    return (imk_navigation_state){column(truth, "time")[row], imk_ecef_from_geodetic(place),
                                  imk_matrix3_apply(axes, velocity),
                                  imk_quaternion_from_matrix(imk_matrix3_multiply(axes, attitude))};
}

/* A navigator that starts at the truth's row 0 and integrates rows 1, 2, … of a log of perfect
 * increments is at the truth's row k after row k. A drive this lively at 100 Hz is missed by some
 * micrometres (docs/theory/navigation.md: 0.3 mm in ten minutes); one row late or early would be
 * 15 cm. */
static void test_navigator(void **state)
{
    (void)state;
    put("perfect.yaml", perfect);
    put("drive.yaml", drive);
    assert_int_equal(run("$I simulate perfect.yaml --motion drive.yaml --rate 100Hz --increments "
                         "--gyro-unit rad -o p.csv --truth t.csv"),
                     0);
    imk_log log = load("p.csv"), truth = load("t.csv");
    imk_navigation_state at = state_of(&truth, 0);
    imk_strapdown strapdown = imk_strapdown_start(&at);
    double largest = 0;
    const double dt = 0.01;
    for (size_t k = 1; k < log.rows; k++) {
        imk_vector3 step[2];
        for (int i = 0; i < 6; i++) /* the reader makes rates of increments */
            step[i / 3].v[i % 3] = dt * log.data[1 + i][k];
        imk_strapdown_step(&strapdown, dt, step[0], step[1]);
        at = state_of(&truth, k);
        largest = fmax(
            largest, imk_vector3_norm(imk_vector3_subtract(strapdown.state.position, at.position)));
    }
    assert_true(log.rows > 2000);
    CHECK_BELOW(largest, 1e-4);
    assert_true(imk_vector3_norm(imk_vector3_subtract(at.position, state_of(&truth, 0).position)) >
                100);
    imk_log_free(&log);
    imk_log_free(&truth);
    sweep();
}

/* ---- runs and terms -------------------------------------------------------------------------- */

static void test_runs(void **state)
{
    (void)state;
    put("drive.yaml", drive);
    put("unit.yaml", "imukit: 1\n"
                     "gyro: {bias: {repeatability: 1 deg/h}, noise: {angle_random_walk: 0.1 "
                     "deg/sqrt(h)}}\n"
                     "accel: {bias: {repeatability: 1 mg}}\n");
    setenv("A", "unit.yaml --motion drive.yaml --rate 50Hz --seed 7", 1);
    assert_int_equal(run("$I simulate $A --runs 5 -o runs/ && ls -A runs"), 0);
    assert_string_equal(out, "run_000.csv\nrun_001.csv\nrun_002.csv\nrun_003.csv\nrun_004.csv\n");
    assert_string_equal(err, "");
    assert_int_equal(run("$I simulate $A --run 3 | cmp - runs/run_003.csv"), 0);
    assert_int_equal(run("$I simulate $A --run 3 --runs 1 -o runs --format npy --truth runs/t.csv "
                         "&& $I convert runs/run_003.npy - | cmp - runs/run_003.csv"),
                     0);
    /* Another run is another switching on: no row is that of run 0 but the header. */
    assert_int_equal(run("cut -d, -f2- runs/run_000.csv runs/run_001.csv | sort | uniq -d | wc "
                         "-l"),
                     0);
    assert_string_equal(out, "1\n"); /* the header */
    assert_int_equal(run("rm -r runs; $I simulate $A --runs 1 --run 4294967295 -o runs/; ls runs; "
                         "rm -r runs"),
                     0);
    assert_string_equal(out, "run_4294967295.csv\n");
    sweep();
}

/* Effects of linear terms add up; products of two small ones are left: 1000 ppm of 1 mrad, of
 * 1 deg/s, of 10 mm times the angular acceleration and squared rate (0.5 m/s^2 per metre at most).
 */
static void test_terms(void **state)
{
    (void)state;
    static const char *const names[] = {"bias.fixed",         "scale_factor",  "misalignment",
                                        "angle_random_walk",  "g_sensitivity", "lever_arm",
                                        "gyro.repeatability", "resonance"};
    enum { NAMES = sizeof names / sizeof names[0] };
    double largest[2] = {0};
    put("drive.yaml", drive);
    put("unit.yaml",
        "imukit: 1\n"
        "gyro: {bias: {fixed: 1 2 3 deg/s, repeatability: 1 deg/s}, scale_factor: {fixed: 0.1 %}, "
        "misalignment: 1 mrad, g_sensitivity: [1 0 0 deg/h/g, 0 1 0 deg/h/g, 0 0 1 deg/h/g], "
        "noise: {angle_random_walk: 0.1 deg/sqrt(h), resonance: [{sigma: 1 deg/s, frequency: 20 "
        "Hz, q: 9}]}}\n"
        "accel: {bias: {fixed: 1 mg}, scale_factor: {fixed: 0.1 %}, "
        "lever_arm: [10 0 0 mm, 0 10 0 mm, 0 0 10 mm]}\n"
        "timing: {drops: 5 %}\n");
    setenv("A", "simulate unit.yaml --motion drive.yaml --rate 100Hz", 1);
    assert_int_equal(run("$I $A --without drops -o all.csv; $I $A --without gyro,accel,drops -o "
                         "none.csv"),
                     0);
    imk_log all = load("all.csv"), none = load("none.csv"), each[NAMES];
    for (int i = 0; i < NAMES; i++) {
        setenv("TERM_NAME", names[i], 1);
        assert_int_equal(run("$I $A --only $TERM_NAME -o one.csv"), 0);
        each[i] = load("one.csv");
        assert_int_equal(each[i].rows, none.rows);
    }
    for (int c = 1; c <= 6; c++)
        for (size_t k = 0; k < all.rows; k++) {
            double sum = none.data[c][k] - all.data[c][k];
            for (int i = 0; i < NAMES; i++)
                sum += each[i].data[c][k] - none.data[c][k];
            largest[c > 3] = fmax(largest[c > 3], fabs(sum));
        }
    CHECK_BELOW(largest[0], 1e-3 * 1e-3 * 0.4);
    CHECK_BELOW(largest[1], 1e-3 * 0.01 * 0.5);
    for (int i = 0; i < NAMES; i++)
        imk_log_free(&each[i]);
    imk_log_free(&all);
    imk_log_free(&none);
    /* Rows that are dropped are missing, the others are the same; 5 % of some 2000, whose standard
     * deviation is 10: 50 to 150 holds with 1e-6. The truth has them all. */
    assert_int_equal(run("$I $A -o dropped.csv --truth t.csv; wc -l <all.csv; wc -l <t.csv; wc -l "
                         "<dropped.csv; grep -c -x -F -f all.csv dropped.csv"),
                     0);
    int lines[4];
    assert_int_equal(sscanf(out, "%d %d %d %d", &lines[0], &lines[1], &lines[2], &lines[3]), 4);
    assert_int_equal(lines[1], lines[0]);
    assert_in_range(lines[0] - lines[2], 50, 150);
    assert_int_equal(lines[3], lines[2]);
    sweep();
}

/* ---- physics --------------------------------------------------------------------------------- */

/* A rate table shows the scale factor: over a turn of 360 deg and back the Earth's part drops out.
 * Two faces show bias and scale factor: half the sum and half the difference of what they read. */
static void test_laboratory(void **state)
{
    (void)state;
    put("unit.yaml", "imukit: 1\ngyro: {scale_factor: {fixed: 1000 ppm}, bias: {fixed: 1 deg/s}}\n"
                     "accel: {scale_factor: {fixed: 500 ppm}, bias: {fixed: 5 mg}}\n");
    put("table.yaml", "imukit_motion: 1\nstart: {latitude: 45 deg}\nsteps:\n"
                      "  - rotate z 360 deg at 100 deg/s\n  - rotate z -360 deg at 100 deg/s\n"
                      "  - pose 0 90 0 deg in 5 s\n  - hold 5 s\n"
                      "  - pose 0 -90 0 deg in 5 s\n  - hold 5 s\nthen: hold\n");
    assert_int_equal(run("$I simulate unit.yaml --motion table.yaml --rate 100Hz --duration 40s "
                         "--gyro-unit rad/s -o log.csv"),
                     0);
    imk_log log = load("log.csv");
    const double *gyro = column(&log, "gyro_z"), *accel = column(&log, "accel_x");
    const double degree = 3.14159265358979 / 180, dt = 0.01;
    double turned[2] = {0};
    for (size_t k = 1; k <= 820; k++) /* 360/100 + 0.5 s each: 4.1 s */
        turned[k > 410] += (gyro[k] - degree) * dt;
    CHECK_CLOSE((turned[0] - turned[1]) / (720 * degree), 1 + 1000e-6, 1e-12);
    const double gravity = imk_normal_gravity(45 * degree, 0);
    const double up = accel[1700], down = accel[3900];
    CHECK_CLOSE((up + down) / 2, 5e-3 * standard_g, 1e-12);
    CHECK_CLOSE((up - down) / 2 / gravity, 1 + 500e-6, 1e-12);
    imk_log_free(&log);
    sweep();
}

/* K2 makes a bias of K2 a^2/2 of a vibration a, which the parts of a row (at least 16 to a cycle)
 * see less the squared sinc of one of them. The log does not show the vibration, so compensation
 * takes out K2 g^2 and leaves this. Fewer parts than vibration needs are warned of. */
static void test_rectification(void **state)
{
    (void)state;
    put("perfect.yaml", perfect);
    put("k2.yaml", "imukit: 1\naccel: {nonlinearity: {k2: 100 ug/g^2}, range: 10 g}\n");
    put("shaker.yaml", shaker);
    assert_int_equal(run("$I simulate k2.yaml --motion shaker.yaml --rate 100Hz -o k2.csv && $I "
                         "simulate perfect.yaml --motion shaker.yaml --rate 100Hz -o p.csv && $I "
                         "compensate k2.csv k2.yaml -o clean.csv"),
                     0);
    imk_log bent = load("k2.csv"), straight = load("p.csv"), clean = load("clean.csv");
    const double parts = ceil(16 * 3.33), angle = 3.14159265358979 * 3.33 / parts;
    const double bias = 100e-6 * 2 * 2 / 2 * pow(sin(angle) / angle, 2) * standard_g;
    double mean[4] = {0}; /* x, z; x, z compensated */
    for (size_t k = 1; k < bent.rows; k++)
        for (int i = 0; i < 2; i++) {
            const char *name = i == 0 ? "accel_x" : "accel_z";
            double truth = column(&straight, name)[k];
            mean[i] += (column(&bent, name)[k] - truth) / (double)(bent.rows - 1);
            mean[2 + i] += (column(&clean, name)[k] - truth) / (double)(bent.rows - 1);
        }
    /* 200 rows are 666 cycles: the mean of the squares is exact. Gravity, 0.99994 g at 45 deg, adds
     * 100 ug; what of the vibration is left in the rows takes 1 % off the compensated ones. */
    CHECK_RELATIVE(mean[0], bias, 1e-6);
    CHECK_RELATIVE(mean[1] - bias, 100e-6 * standard_g, 1e-3);
    CHECK_RELATIVE(mean[2], bias, 0.02);
    CHECK_RELATIVE(mean[3], bias, 0.02);
    imk_log_free(&bent);
    imk_log_free(&straight);
    imk_log_free(&clean);
    check_message("$I simulate k2.yaml --motion shaker.yaml --rate 1Hz", 0,
                  "imukit simulate: warning: the vibration needs 5328 parts per sample, but 512 "
                  "are the most; its effect is wrong below --rate 11Hz\n");
    sweep();
}

/* Warm-up that is simulated is taken out, to rounding: of exponentials, and of 1e-16 of 5 deg/s in
 * the log. */
static void test_warm_up(void **state)
{
    (void)state;
    put("perfect.yaml", perfect);
    put("unit.yaml", "imukit: 1\ngyro: {bias: {warm_up: {amplitude: 5 deg/s, time: 20 s}}}\n"
                     "accel: {bias: {warm_up: {amplitude: 1 m/s^2, time: 50 s}}}\n");
    assert_int_equal(run("$I simulate unit.yaml --rate 10Hz --duration 100s -o log.csv && $I "
                         "compensate log.csv unit.yaml -o clean.csv && $I simulate perfect.yaml "
                         "--rate 10Hz --duration 100s -o p.csv"),
                     0);
    CHECK_BELOW(difference("clean.csv", "p.csv"), 1e-4); /* (dt/time)^2/24 of the amplitudes */
    sweep();
}

/* ---- compensating some terms ------------------------------------------------------------------
 */

static void test_selected_correction(void **state)
{
    (void)state;
    put("unit.yaml", "imukit: 1\ngyro: {bias: {fixed: 1 rad/s}, scale_factor: {fixed: 100 %}, "
                     "range: 4 rad/s}\n");
    put("log.csv", "time [s],gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s]\n0,3,1,1\n1,4,1,1\n");
    check_message(
        "$I compensate log.csv unit.yaml --only bias -o - --flags", 0,
        "imukit compensate: warning: saturated, at or beyond the range of an axis: 1 of 2 "
        "samples (first: row 2)\n"
        "Usable with care: 1 of 2 samples are flagged, 1 saturated; 1 term is taken out, and 1 "
        "stay in.\n\n"
        "Taken out: gyro.bias.fixed\nLeft in: gyro.scale_factor.fixed\n"
        "2 samples, 1 flagged\n");
    assert_string_equal(out, "time [s],gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s],flags\n"
                             "0,2,0,0,0\n1,3,0,0,1\n");
    assert_int_equal(run("$I compensate log.csv unit.yaml --without 'bias, gyro.misalignment'"), 0);
    assert_string_equal(out, "time [s],gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s]\n"
                             "0,1.5,0.5,0.5\n1,2,0.5,0.5\n");
    assert_int_equal(run("$I compensate log.csv unit.yaml --only noise -o same.csv && cmp log.csv "
                         "same.csv"),
                     0);
    check_contains(err, "unit.yaml has no deterministic term of those selected: there is nothing",
                   "nothing selected");
    check_message("$I compensate log.csv unit.yaml --only biass", 2,
                  "imukit compensate: error: --only: \"biass\" is not a known name; did you mean "
                  "bias?\n" TRY("compensate"));
    check_message(
        "$I compensate log.csv unit.yaml --only bias --without noise", 2,
        "imukit compensate: error: --only and --without exclude each other\n" TRY("compensate"));
    sweep();
}

/* ---- refusals -------------------------------------------------------------------------------- */

#define REFUSED(options, message)                                                                  \
    check_message("$I simulate " options, 2,                                                       \
                  "imukit simulate: error: " message "\n" TRY("simulate"))

static void test_refusals(void **state)
{
    (void)state;
    put("drive.yaml", drive);
    put("counts.yaml", "imukit: 1\ngyro: {sensitivity: 16 count/(deg/s)}\naccel: {}\n");
    put("clock.yaml", "imukit: 1\ngyro: {}\naccel: {}\ntiming: {jitter: 0.1 ms, drops: 1 %}\n");
    assert_int_equal(run("$I simulate AHRS --rate 10Hz --duration 1s -o log.csv"), 0);
    setenv("D", "--motion drive.yaml --rate 100Hz", 1);
    REFUSED("AHRS --motion drive.yaml", "the sampling rate is missing: add --rate 100Hz");
    REFUSED("AHRS --rate 100Hz", "the length is missing: add --duration 1h");
    REFUSED("AHRS $D --duration 1h", "--duration 3600 s: the motion ends after 23 s (leave "
                                     "the option out, or let the motion end with `then: hold`)");
    REFUSED("AHRS --motion log.csv --duration 2s",
            "--duration 2 s: the motion ends after 1 s (leave the option out)");
    REFUSED("AHRS $D --runs 2", "--runs writes one log per run into a directory: add -o DIR/");
    REFUSED("AHRS $D --runs 2 -o log.csv",
            "--runs writes one log per run into a directory: add -o DIR/");
    REFUSED("AHRS $D --runs 0", "--runs 0: expected 1 to 4294967295");
    REFUSED("AHRS $D --runs 2 --run 4294967295 -o x/", "run numbers: expected at most 4294967295");
    REFUSED("AHRS $D -o x/", "-o x/ is a directory: name a file, or add --runs N");
    REFUSED("AHRS $D --format npy",
            "--format is for --runs: a single log has it in its name, -o LOG.npy");
    REFUSED("AHRS $D --truth x.csv -o x.csv",
            "--output and --truth both write x.csv: give another name");
    REFUSED("AHRS $D --truth -",
            "the log and the truth cannot both go to standard output: add -o LOG");
    REFUSED("AHRS $D --yaw 5deg", "--roll, --pitch and --yaw are for a unit at rest; with --motion "
                                  "the attitude is in the motion file");
    REFUSED("AHRS $D --no-earth",
            "--no-earth is for a unit at rest; in a motion script write `earth: no`");
    REFUSED("AHRS --rate 1Hz --duration 1s --latitude 100deg",
            "--latitude 100deg: expected -90deg to 90deg");
    REFUSED("AHRS --rate 1Hz --duration 1s --height 1e6m",
            "--height 1e6m: expected -10000m to 100000m");
    REFUSED("AHRS --rate 1Hz --duration 1s --yaw 1e20deg",
            "--yaw 1e20deg: expected -36000deg to 36000deg");
    REFUSED("AHRS --rate 1e20Hz --duration 1e-20s", "--rate 1e+20 Hz: expected 1e-9 Hz to 1e12 Hz");
    REFUSED("AHRS --motion log.csv --rate 20Hz",
            "--rate 20 Hz: the recorded motion has 10 Hz; leave the option out");
    REFUSED("clock.yaml --motion log.csv",
            "log.csv is known at its samples only, and the model has errors of the clock: add "
            "--without rate_error,jitter,skew");
    REFUSED("counts.yaml $D --increments", "--increments: a model with a sensitivity makes counts, "
                                           "which are rates; leave the option out");
    REFUSED("counts.yaml $D --gyro-unit deg/h",
            "--gyro-unit deg/h: the model's gyros have a sensitivity and make counts; leave the "
            "option out");
    REFUSED("AHRS $D --only ,", "--only ,: expected names of terms between commas");
    REFUSED("AHRS $D --only scale_factr",
            "--only: \"scale_factr\" is not a known name; did you mean scale_factor?");
    /* What is wrong with a file is no misuse; nothing is left behind. */
    check_message("$I simulate AHRS $D --truth nowhere/t.csv -o x.csv", 1,
                  "imukit simulate: error: nowhere/t.csv: the folder nowhere does not exist; "
                  "create this folder, or choose another\n");
    check_message("$I simulate AHRS $D --runs 2 -o nowhere/x/", 1,
                  "imukit simulate: error: nowhere/x/: No such file or directory\n");
    check_message("sed '1s/ .s.//' log.csv >bare.csv; $I simulate AHRS --motion bare.csv", 1,
                  "imukit simulate: error: bare.csv:1: \"time\" has no unit; imukit convert "
                  "bare.csv NEW.csv --time-unit UNIT \n");
    check_message("cut -d, -f1-5 log.csv >part.csv; $I simulate AHRS --motion part.csv", 1,
                  "imukit simulate: error: part.csv: accel_y: this column is missing; recorded "
                  "motion needs gyro_x, gyro_y, gyro_z, accel_x, accel_y and accel_z\n");
    put("poses.csv", "time [s],x [m],y [m],z [m],speed [m/s]\n0,0,0,0,1\n1,1,0,0,1\n");
    check_message("$I simulate AHRS --motion poses.csv --rate 1Hz -o x.csv", 0,
                  "imukit simulate: warning: poses.csv: the table has no attitude: the unit is "
                  "level, heading north; 1 column is not used\n");
    assert_int_equal(sweep(), 8);
}

/* Interrupted twice in a row, as timeout(1) does to a process and its group: the file under way is
 * removed before the second signal ends the process. */
static void test_interrupted(void **state)
{
    (void)state;
    assert_int_equal(run("$I simulate AHRS --rate 10kHz --duration 1000h -o x.csv & p=$!; sleep "
                         "0.4; ls -A; kill $p; kill $p; wait $p; ls -A"),
                     0);
    check_contains(out, ".part", "the file was under way");
    assert_true(strchr(out, '\n') == strrchr(out, '\n')); /* and is not there any more */
    assert_int_equal(sweep(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_truth),      cmocka_unit_test(test_navigator),
        cmocka_unit_test(test_runs),       cmocka_unit_test(test_terms),
        cmocka_unit_test(test_laboratory), cmocka_unit_test(test_rectification),
        cmocka_unit_test(test_warm_up),    cmocka_unit_test(test_selected_correction),
        cmocka_unit_test(test_refusals),   cmocka_unit_test(test_interrupted)};
    return cmocka_run_group_tests_name("simulate on moving platforms", tests, set_up, tear_down);
}
