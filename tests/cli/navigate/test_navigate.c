/* SPDX-License-Identifier: Apache-2.0 */
/* imukit navigate: exact output, refusals that name what to add, and a real log of a parked vehicle
 * with laser gyros, whose alignment and drift are known from independent estimators. */
#include "cli/run_command.h"

#include "imukit/earth.h"

#define PLACE "--position '45 deg, 10 deg, 100 m'"

/* 20 s at rest at 45 deg north, level, heading north, perfect readings; 10 Hz. */
static void write_rest(void)
{
    assert_int_equal(run("$I simulate perfect.yaml --rate 10Hz --duration 20s --height 100m -o "
                         "rest.csv"),
                     0);
}

static void put_models(void)
{
    put("perfect.yaml", "imukit: 1\ngyro: {}\naccel: {}\n");
    put("unit.yaml", "imukit: 1\n"
                     "gyro: {bias: {repeatability: 0.01 deg/h},"
                     " noise: {angle_random_walk: 0.002 deg/sqrt(h)}}\n"
                     "accel: {bias: {repeatability: 50 ug}}\n");
}

static void test_perfect(void **state)
{
    (void)state;
    put_models();
    write_rest();
    assert_int_equal(run("$I navigate rest.csv " PLACE " --align 10s --align-method means"), 0);
    assert_string_equal(err, "");
    check_contains(out, "Aligned over 10 s (means): roll 0.0000, pitch 0.0000, yaw 0.0000 deg",
                   "start");
    check_contains(out, "Height held at 100.000 m", "height");
    check_contains(out, "Next: add --model MODEL", "next");
    /* The track: rows at 10 s, 15 s, 20 s. */
    assert_int_equal(run("$I navigate rest.csv " PLACE " --attitude '0 0 0 deg' --interval 10s -o "
                         "track.csv && cat track.csv | cut -d, -f1-13"),
                     0);
    check_contains(out,
                   "time [s],latitude [deg],longitude [deg],height [m],north [m],east [m],down [m],"
                   "velocity_north [m/s],velocity_east [m/s],velocity_down [m/s],roll [deg],pitch "
                   "[deg],yaw [deg]\n",
                   "header");
    check_contains(out, ",45.000000000,10.000000000,100.0000,", "place");
    /* With a model, sigmas; a level accelerometer of 50 ug alone gives b t^2/2 after 20 s. */
    assert_int_equal(run("$I navigate rest.csv " PLACE " --attitude '0 0 0 deg' --model unit.yaml "
                         "--interval 20s -o - | tail -1 | cut -d, -f14"),
                     0);
    CHECK_RELATIVE(atof(out), 50e-6 * 9.80665 * 200.0, 5e-3);
    sweep();
}

static void test_refusals(void **state)
{
    (void)state;
    put_models();
    write_rest();
    check_message("$I navigate rest.csv --align 10s", 2,
                  "imukit navigate: error: the position at the start is missing: add --position "
                  "\"LATITUDE deg, LONGITUDE deg, HEIGHT m\"\n" TRY("navigate"));
    check_message("$I navigate rest.csv --align 10s --position '45 deg, 10 deg'", 2,
                  "imukit navigate: error: --position \"45 deg, 10 deg\": the height is "
                  "missing; expected latitude, longitude, height, such as \"34.25 deg, 108.91 deg, "
                  "380 m\"\n" TRY("navigate"));
    check_message(
        "$I navigate rest.csv " PLACE " --align 10s --rate 1e-5Hz", 1,
        "imukit navigate: error: rest.csv: --rate 1e-05Hz does not agree with the time column, by "
        "which the rate is 10 Hz; leave --rate out; if the times are wrong, leave their column "
        "out, with --map or with - in its place in --columns\n");
    check_message("$I navigate rest.csv --align 10s --position '95 deg, 10 deg, 0 m'", 2,
                  "imukit navigate: error: --position \"95 deg, 10 deg, 0 m\": the latitude must "
                  "be within 90 deg, the longitude within 360 deg\n" TRY("navigate"));
    check_message(
        "$I navigate rest.csv " PLACE, 2,
        "imukit navigate: error: the attitude at the start is missing: add --align 300s if the "
        "unit is at rest for that time at the start, or --attitude \"ROLL PITCH YAW deg\"\n" TRY(
            "navigate"));
    check_message("$I navigate rest.csv " PLACE " --align 10s --attitude '0 0 0 deg'", 2,
                  "imukit navigate: error: --align finds the attitude that --attitude gives: leave "
                  "one out\n" TRY("navigate"));
    check_message(
        "$I navigate rest.csv " PLACE " --align 10s --zero-velocity auto", 2,
        "imukit navigate: error: --zero-velocity needs the errors of the sensors; add --model "
        "MODEL, one from imukit identify or a name from imukit devices\n" TRY("navigate"));
    check_message("$I navigate rest.csv " PLACE " --align 10s --zero-velocity 4 --model unit.yaml",
                  2,
                  "imukit navigate: error: --zero-velocity 4: expected auto, or the time from stop "
                  "to stop, such as 60s\n" TRY("navigate"));
    check_message("$I navigate rest.csv " PLACE " --align 10s --coning 5", 2,
                  "imukit navigate: error: --coning 5: expected 1 to 4\n" TRY("navigate"));
    check_message("$I navigate rest.csv " PLACE " --align 30s", 1,
                  "imukit navigate: error: rest.csv is 20 s long, so nothing is left after --align "
                  "30s; shorten the alignment\n");
    check_message("$I navigate rest.csv " PLACE " --align 10s --aling-method means", 2,
                  "imukit navigate: error: there is no option --aling-method; did you mean "
                  "--align-method?\n" TRY("navigate"));
    check_message("$I navigate rest.csv --position '89.5 deg, 0 deg, 0 m' --align 10s", 1,
                  "imukit navigate: warning: the angle between force and rotation fits latitude "
                  "45.0 deg, not 89.5 deg: the axes are not forward-right-down (state them with "
                  "--axes), or a bias is large\nimukit navigate: error: within 1 deg of a pole "
                  "there is no north to align to: give --attitude\n");
    /* 1 in m/s^2 where g was meant. */
    put("g.csv", "time [s],gyro_x [deg/h],gyro_y [deg/h],gyro_z [deg/h],accel_x [m/s^2],accel_y "
                 "[m/s^2],accel_z [m/s^2]\n0,10,0,-10,0,0,-1\n1,10,0,-10,0,0,-1\n2,10,0,-10,0,0,-1"
                 "\n");
    check_message(
        "$I navigate g.csv " PLACE " --align 2s", 1,
        "imukit navigate: error: g.csv: at rest the accelerometers read 0.102 times gravity: their "
        "unit is probably g, not m/s^2, or gravity was removed, or the unit moves\n");
    put("five.csv", "time [s],gyro_x [deg/h],gyro_y [deg/h],gyro_z [deg/h],accel_x [g],accel_z [g]"
                    "\n0,10,0,-10,0,-1\n1,10,0,-10,0,-1\n");
    check_message("$I navigate five.csv " PLACE " --align 1s", 1,
                  "imukit navigate: error: five.csv has no column accel_y: navigation needs three "
                  "gyros and three accelerometers\n");
    sweep();
}

/* Options that would mean nothing, and texts out of range. */
static void test_company(void **state)
{
    (void)state;
    put_models();
    write_rest();
#define REFUSED(options, message)                                                                  \
    check_message("$I navigate rest.csv " options, 2,                                              \
                  "imukit navigate: error: " message "\n" TRY("navigate"))
    REFUSED(PLACE " --attitude '0 0 0 deg' --align-method fine",
            "--align-method is for --align, and --attitude excludes --align");
    REFUSED(PLACE " --align 10s --stop 3s",
            "--stop is for --zero-velocity TIME, such as --zero-velocity 60s");
    REFUSED(PLACE " --align 10s --model unit.yaml --zero-velocity auto --stop 3s",
            "--stop is for --zero-velocity TIME, such as --zero-velocity 60s");
    REFUSED(PLACE " --align 10s --still-rotation 1deg/h",
            "--still-rotation is for --zero-velocity; add that option");
    REFUSED(PLACE " --align 10s --heading 720deg",
            "--heading \"720deg\": expected an azimuth within 360 deg, such as 30deg, or \"30 +- 1 "
            "deg\" with its 1 sigma");
    REFUSED(
        PLACE " --attitude '0 95 0 deg'",
        "--attitude \"0 95 0 deg\": the pitch must be within 90 deg, roll and yaw within 360 deg");
    REFUSED("--align 10s --position '45 +- 1 deg, 10 deg, 0 m'",
            "--position \"45 +- 1 deg, 10 deg, 0 m\": the latitude takes no uncertainty; leave out "
            "its +-");
    REFUSED(PLACE " --align 10s -o rest.csv",
            "--output rest.csv would overwrite what is read: give another name");
    REFUSED(PLACE " --align 10s -o ./rest.csv",
            "--output ./rest.csv would overwrite what is read: give another name");
    REFUSED(PLACE " --align 10s -o a.svg --plot a.svg",
            "--output and --plot both write a.svg: give another name");
    assert_int_equal(run("$I navigate rest.csv " PLACE " --align 10s --heading '300 +- 2 deg'"), 0);
    check_contains(out, "yaw -60.0000 deg (yaw given)", "heading");
    check_contains(out, "heading 2 deg", "its sigma");
    assert_int_equal(run("$I navigate rest.csv " PLACE " --align 10s --model unit.yaml "
                         "--zero-velocity 1h"),
                     0);
    assert_string_equal(err, "imukit navigate: warning: no standstill was scheduled before the end "
                             "of the log, so there was no update\n");
    /* However short: an attitude with a sigma, or a reason. */
    assert_int_equal(run("$I navigate rest.csv " PLACE " --align 1s"), 0);
    check_contains(out, "heading", "sigma");
    assert_null(strstr(out, "nan"));
    sweep();
}

static void put_readings(const char *units, const char *rate, const char *force)
{
    char text[4000];
    size_t used = (size_t)snprintf(text, sizeof text, "%s", units);
    for (int k = 0; k < 20; k++)
        used += (size_t)snprintf(text + used, sizeof text - used, "%d,%s,%s\n", k, rate, force);
    put("readings.csv", text);
}

/* Units and signs that cannot be: 15 deg/h is 1/240 deg/s. */
static void test_units(void **state)
{
    (void)state;
#define HEADER(gyro, accel)                                                                        \
    "time [s],gyro_x [" gyro "],gyro_y [" gyro "],gyro_z [" gyro "],accel_x [" accel               \
    "],accel_y [" accel "],accel_z [" accel "]\n"
    put_readings(HEADER("rad/s", "m/s^2"), "0.00295,0,-0.00295", "0,0,-9.806");
    assert_int_equal(run("$I navigate readings.csv " PLACE " --align 15s --align-method means"), 0);
    check_contains(err, "their unit may be deg/s, not rad/s; north cannot be found", "deg/s");
    put_readings(HEADER("deg/s", "m/s^2"), "0.00295,0,-0.00295", "0,0,-9.806");
    assert_int_equal(run("$I navigate readings.csv --position '-45 deg, 10 deg, 0 m' --align 15s "
                         "--align-method means"),
                     0);
    check_contains(err, "the sign of the latitude, ", "latitude");
    put_readings(HEADER("deg/s", "g"), "0.00295,0,-0.00295", "0,0,-9.806");
    assert_int_equal(run("$I navigate readings.csv " PLACE " --attitude '0 0 0 deg'"), 0);
    check_contains(err, "the unit of the accelerometers is probably m/s^2, not g", "g");
    put_readings(HEADER("deg/s", "m/s^2"), "0.00295,0,-0.00295", "0,0,-9.806");
    assert_int_equal(run("$I navigate readings.csv " PLACE " --attitude '0 20 0 deg'"), 0);
    check_contains(err, "begins with an acceleration of 3.41 m/s^2: the attitude", "attitude");
    assert_int_equal(run("(cat readings.csv; echo 20,0,0,0,1e50,0,-1e50; echo 21,0,0,0,0,0,-9) "
                         "> absurd.csv; $I navigate absurd.csv " PLACE " --align 15s "
                         "--align-method means -o track.csv"),
                     1);
    check_contains(
        err, "error: absurd.csv: at 20.000 s the estimate is no longer near the Earth: ", "absurd");
    check_contains(err, "check the units of the log's columns, --position\n", "no aid");
    assert_int_equal(access("track.csv", F_OK), -1);
    assert_int_equal(run("sed -i 's/1e50/1e200/g' absurd.csv; $I navigate absurd.csv " PLACE
                         " --align 15s --align-method means -o track.csv"),
                     1);
    check_contains(err, "beyond 1e60, first in row 21, column accel_x", "1e200");
    assert_int_equal(access("track.csv", F_OK), -1);
    sweep();
}

/* ---- the parked laser-gyro log -----------------------------------------------------------------
 */

static const char parked[] =
    SHARED_DIRECTORY "/data/navigation/laser_gyro_parked_100hz_increments.csv.gz";
#define PARKED                                                                                     \
    "$I navigate $LOG --position '34.246048 deg, 108.909664 deg, 380 m' --align 300s "             \
    "--standard-gravity '9.780327 m/s^2' --axes right-forward-up "

static double number_after(const char *text, const char *key)
{
    const char *at = strstr(text, key);
    assert_non_null(at);
    return atof(at + strlen(key));
}

/* Horizontal distance from the start so long after the alignment, in the track. */
static double distance_at(const char *track, int seconds)
{
    char label[40];
    double north, east;
    snprintf(label, sizeof label, "\n%d.000,", 300 + seconds);
    const char *row = strstr(track, label);
    assert_non_null(row);
    assert_int_equal(sscanf(row + strlen(label), "%*[^,],%*[^,],%*[^,],%lf,%lf", &north, &east), 2);
    return hypot(north, east);
}

/* Azimuth of body y, which is forward there and our x, +90.6 deg; drift at 300 … 1500 s of the best
 * of three independent estimators 5.1, 31.4, 188, 326 m (design/golden.md), with 15 % to spare. */
static void test_parked(void **state)
{
    (void)state;
    if (access(parked, R_OK) != 0) {
        print_message("%s is not there\n", parked);
        skip();
    }
    setenv("LOG", parked, 1);
    static const struct {
        int seconds;
        double limit;
    } drift[] = {{600, 31.4}, {1200, 188.0}, {1500, 326.0}};
    assert_int_equal(run(PARKED "--align-method fine -o track.csv"), 0);
    assert_string_equal(err, "");
    CHECK_CLOSE(number_after(out, "yaw "), 90.6, 0.2);
    check_contains(out, "The unit stood still all the time", "rest");
    assert_int_equal(run("cat track.csv"), 0);
    for (int i = 0; i < 3; i++) {
        const double distance = distance_at(out, drift[i].seconds);
        print_message("parked, %d s: %.1f m\n", drift[i].seconds, distance);
        CHECK_BELOW(distance, 1.15 * drift[i].limit);
    }
    /* Updates every minute: the distance stays within 3 sigma of what is predicted, itself small.
     */
    assert_int_equal(run(PARKED "--model navigation --zero-velocity 60s --still-velocity 2mm/s -o "
                                "track.csv --json >/dev/null 2>&1; true"),
                     0);
    assert_int_equal(run(PARKED "--model navigation --zero-velocity 60s --still-velocity 2mm/s"),
                     0);
    assert_string_equal(err, "");
    const double error = number_after(out, "from the start, at most ");
    const double predicted = number_after(out, "the model predicts ");
    print_message("parked, updates every 60 s: at most %.2f m, predicted %.2f m rms\n", error,
                  predicted);
    CHECK_BELOW(predicted, 5.0);
    CHECK_BELOW(error, 3.0 * predicted);
    check_contains(out, "refused 0;", "updates");
    /* Free, the preset of a navigation unit predicts what is seen too. */
    assert_int_equal(run(PARKED "--model navigation"), 0);
    CHECK_BELOW(number_after(out, "at most "), 3.0 * number_after(out, "the model predicts "));
    /* Without the maker's g. */
    assert_int_equal(run("$I navigate $LOG --position '34.246048 deg, 108.909664 deg, 380 m' "
                         "--align 300s --axes right-forward-up"),
                     0);
    check_contains(err, "g may mean 9.780327 m/s^2", "standard gravity");
    sweep();
}

/* Readings in g whose g is 9.780327 m/s^2 are 1.0026905 of gravity, and are told to be within 1e-4
 * of that: from both sides, just within and just without. */
static void test_g_of_another_maker(void **state)
{
    (void)state;
    static const struct {
        double off;
        bool told;
    } cases[] = {{0.97e-4, true}, {-0.97e-4, true}, {1.03e-4, false}, {-1.03e-4, false}};
    const double gravity = imk_normal_gravity(45 * 3.14159265358979323846 / 180, 0) / 9.80665;
    const double rate = 15.041067 / 3600 / sqrt(2); /* deg/s, north and down at 45 deg */
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        if (check_skips(i, 3))
            continue;
        FILE *file = fopen("g.csv", "wb");
        assert_non_null(file);
        fprintf(file, "time [s],gyro_x [deg/s],gyro_y [deg/s],gyro_z [deg/s],accel_x [g],accel_y "
                      "[g],accel_z [g]\n");
        for (int k = 0; k < 700; k++)
            fprintf(file, "%.1f,%.12f,0,%.12f,0,0,%.12f\n", 0.1 * k, rate, -rate,
                    -(9.80665 / 9.780327 + cases[i].off) * gravity);
        fclose(file);
        assert_int_equal(run("$I navigate g.csv --position '45 deg, 0 deg, 0 m' --align 60s"), 0);
        const bool told = strstr(err, "g may mean 9.780327 m/s^2") != NULL;
        assert_int_equal(told, cases[i].told);
    }
    sweep();
}

/* Gyros with a bias of 0.1 deg/s, 70 times the Earth's rotation, turn 8 deg in the minute of
 * alignment: the vertical is found all the same, to what 0.06 mg/sqrt(Hz) and 0.3 deg/sqrt(h)
 * leave, and north is not claimed. */
static void test_coarse_gyros(void **state)
{
    (void)state;
    assert_int_equal(run("printf 'imukit: 1\\ngyro:\\n  bias: {fixed: 0.1 -0.05 0.08 deg/s, "
                         "repeatability: 0.1 deg/s}\\n  noise: {angle_random_walk: 0.3 "
                         "deg/sqrt(h)}\\naccel:\\n  noise: {density: two-sided, "
                         "velocity_random_walk: 60 ug/sqrt(Hz)}\\n' > coarse.yaml && $I simulate "
                         "coarse.yaml --rate 20Hz --duration 70s --seed 1 -o coarse.csv"),
                     0);
    assert_int_equal(run("$I navigate coarse.csv --position '45 deg, 0 deg, 0 m' --align 60s "
                         "--heading 30deg"),
                     0);
    check_contains(out, "(means, because the gyros read more than the Earth's rotation)", "method");
    CHECK_CLOSE(number_after(out, "roll "), 0.0, 0.01);
    CHECK_CLOSE(number_after(out, "pitch "), 0.0, 0.01);
    assert_int_equal(run("$I navigate coarse.csv --position '45 deg, 0 deg, 0 m' --align 60s "
                         "--model coarse.yaml"),
                     0);
    check_contains(out, "north not found", "heading");
    check_contains(out, "(means, because the gyro biases hide the Earth's rotation)", "method");
    check_contains(err, "add --heading", "north_unknown");
    sweep();
}

/* Three legs of a drive with stops between them. With perfect sensors its end is known; a unit with
 * 1 mg and 1 deg/h that finds its stops by itself ends within what the filter says (4 sigma: 1e-4
 * for each of two, and the draw is fixed), and nearer than one that does not. */
static void end_of(const char *options, double at[2])
{
    char line[600];
    snprintf(line, sizeof line,
             "$I navigate %s --interval 1h --heading 30deg -o - | tail -1 | cut -d, -f5,6",
             options);
    assert_int_equal(run(line), 0);
    assert_int_equal(sscanf(out, "%lf,%lf", &at[0], &at[1]), 2);
}

static void test_stops(void **state)
{
    (void)state;
    put_models();
    put("drive.yaml", "imukit_motion: 1\n"
                      "start: {latitude: 45 deg, longitude: 10 deg, height: 100 m, heading: 30 "
                      "deg}\n"
                      "steps:\n"
                      "  - hold 60 s\n"
                      "  - repeat:\n"
                      "      times: 3\n"
                      "      steps:\n"
                      "        - accelerate to 15 m/s at 2 m/s^2\n"
                      "        - hold 30 s\n"
                      "        - turn right 90 deg at 15 deg/s\n"
                      "        - hold 30 s\n"
                      "        - stop at 3 m/s^2\n"
                      "        - hold 20 s\n");
    assert_int_equal(
        run("$I simulate perfect.yaml --motion drive.yaml --rate 50Hz -o perfect.csv && "
            "$I simulate tactical --motion drive.yaml --rate 50Hz --seed 5 -o real.csv"),
        0);
    double truth[2], found[2], lost[2];
    end_of("perfect.csv " PLACE " --align 60s", truth);
    end_of("real.csv " PLACE " --align 60s", lost);
    end_of("real.csv " PLACE " --align 60s --model tactical --zero-velocity auto", found);
    assert_int_equal(run("$I navigate real.csv " PLACE " --align 60s --heading 30deg --model "
                         "tactical --zero-velocity auto --json 2>/dev/null"),
                     0);
    const double off = hypot(found[0] - truth[0], found[1] - truth[1]);
    const double free_off = hypot(lost[0] - truth[0], lost[1] - truth[1]);
    json_t *document = json_loads(out, 0, NULL);
    json_t *result = json_object_get(document, "result");
    json_t *sigma =
        json_object_get(json_object_get(json_object_get(result, "end"), "position_sigma"), "value");
    const double predicted = hypot(json_number_value(json_array_get(sigma, 0)),
                                   json_number_value(json_array_get(sigma, 1)));
    const double accepted =
        json_number_value(json_object_get(json_object_get(result, "updates"), "accepted"));
    print_message("drive to (%.1f, %.1f) m: off by %.2f m with %g updates (predicted %.2f), %.1f m "
                  "without\n",
                  truth[0], truth[1], off, accepted, predicted, free_off);
    json_decref(document);
    CHECK_BELOW(40.0, accepted);
    CHECK_BELOW(off, 4.0 * predicted);
    CHECK_BELOW(3.0 * off, free_off);
    sweep();
}

/* A cruise without any vibration has the signal of a stand. Two minutes at 25 m/s must not be taken
 * for one, nor the whole log for a unit that never moved; the stop behind is used. */
static void test_smooth_motion(void **state)
{
    (void)state;
    put_models();
    put("cruise.yaml", "imukit_motion: 1\n"
                       "start: {latitude: 45 deg, longitude: 10 deg, height: 100 m, heading: 30 "
                       "deg}\n"
                       "steps:\n"
                       "  - hold 60 s\n"
                       "  - accelerate to 25 m/s at 5 m/s^2\n"
                       "  - hold 10 min\n"
                       "  - stop at 5 m/s^2\n"
                       "  - hold 20 s\n");
    assert_int_equal(
        run("$I simulate perfect.yaml --motion cruise.yaml --rate 20Hz -o perfect.csv && "
            "$I simulate tactical --motion cruise.yaml --rate 20Hz --seed 3 -o real.csv"),
        0);
    double truth[2], found[2];
    end_of("perfect.csv " PLACE " --align 60s", truth);
    end_of("real.csv " PLACE " --align 60s --model tactical --zero-velocity auto 2>err2", found);
    assert_int_equal(run("cat err2; rm err2"), 0);
    check_contains(out, "look like rest but begin with a velocity that is not 0", "cruise");
    assert_null(strstr(out, "the estimate is lost"));
    const double off = hypot(found[0] - truth[0], found[1] - truth[1]);
    assert_int_equal(run("$I navigate real.csv " PLACE " --align 60s --heading 30deg --model "
                         "tactical --zero-velocity auto 2>/dev/null"),
                     0);
    const double predicted = number_after(out, "the model predicts ");
    print_message("cruise: off by %.0f m of %.0f, predicted %.0f m rms\n", off,
                  hypot(truth[0], truth[1]), predicted);
    CHECK_BELOW(off, 4.0 * predicted);
    CHECK_BELOW(predicted, 1000.0);
    assert_null(strstr(out, "stood still all the time"));
    sweep();
}

/* v dv/ds of the motion: 2 m/s^2 to the east of north by 30 deg, and towards the centre of the
 * Earth v^2/R at constant height. */
static void test_gravity_free(void **state)
{
    (void)state;
    put_models();
    put("dash.yaml", "imukit_motion: 1\n"
                     "start: {latitude: 45 deg, longitude: 10 deg, height: 100 m, heading: 30 "
                     "deg}\n"
                     "smoothing: 1 ms\n"
                     "steps:\n"
                     "  - hold 10 s\n"
                     "  - accelerate to 20 m/s at 2 m/s^2\n"
                     "  - hold 10 s\n");
    assert_int_equal(run("$I simulate perfect.yaml --motion dash.yaml --rate 50Hz -o dash.csv"), 0);
    assert_int_equal(run("$I navigate dash.csv " PLACE " --attitude '0 0 30 deg' --interval 5s "
                         "--gravity-free -o - | cut -d, -f14-"),
                     0);
    double a[6][3];
    char *line = strchr(out, '\n');
    check_contains(out,
                   "acceleration_north [m/s^2],acceleration_east [m/s^2],acceleration_down "
                   "[m/s^2]\n",
                   "header");
    for (int k = 0; k < 6; k++, line = strchr(line + 1, '\n'))
        assert_int_equal(sscanf(line, "\n%lf,%lf,%lf", &a[k][0], &a[k][1], &a[k][2]), 3);
    const double degree = 0.017453292519943295, rounding = 1e-6;
    CHECK_CLOSE(a[2][0], 0.0, rounding + 1e-6);
    CHECK_CLOSE(a[4][0], 2.0 * cos(30.0 * degree), 1e-3); /* turning axes: v/R = 3e-6 rad/s */
    CHECK_CLOSE(a[4][1], 2.0 * sin(30.0 * degree), 1e-3);
    CHECK_CLOSE(a[5][2], 400.0 / 6.38e6, rounding + 1e-6); /* 20 m/s by then */
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_perfect),       cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_company),       cmocka_unit_test(test_units),
        cmocka_unit_test(test_parked),        cmocka_unit_test(test_g_of_another_maker),
        cmocka_unit_test(test_coarse_gyros),  cmocka_unit_test(test_stops),
        cmocka_unit_test(test_smooth_motion), cmocka_unit_test(test_gravity_free),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
