/* SPDX-License-Identifier: Apache-2.0 */
/* imukit calibrate: simulate -> calibrate -> compensate comes back to nothing within the stated
 * uncertainty; every kind of log that cannot be used is answered with the message that mends it;
 * a real log of a turntable-free calibration gives the published figures. */
#include "run_command.h"

#include "imukit/model_file.h"
#include "imukit/model_parameter.h"

#define PLACE "--position '48.1 deg, 11.6 deg, 520 m'"
#define POSES "-p multiposition " PLACE

static void put_unit(void)
{
    put("unit.yaml",
        "imukit: 1\n"
        "name: bench unit\n"
        "gyro:\n"
        "  bias: {fixed: 0.5 -0.8 0.3 deg/s}\n"
        "  scale_factor: {fixed: 8000 -5000 3000 ppm}\n"
        "  misalignment: 2 -3 4 1 -2 3 mrad\n"
        "  g_sensitivity: [20 0 10 deg/h/g, 0 -15 0 deg/h/g, 5 0 10 deg/h/g]\n"
        "  noise: {angle_random_walk: 0.3 deg/sqrt(h), bias_instability: 1 deg/h}\n"
        "accel:\n"
        "  bias: {fixed: 20 -35 50 mg}\n"
        "  scale_factor: {fixed: -3000 6000 9000 ppm}\n"
        "  misalignment: 3 -2 0 4 0 0 mrad\n"
        "  noise: {velocity_random_walk: 0.05 m/s/sqrt(h), bias_instability: 10 ug}\n");
}

/* Attitudes all over the sphere, with turns about all axes between. */
static void put_poses(void)
{
    static const char *const poses[] = {
        "100 20 40",    "-80 10 -60",  "170 -10 30", "20 80 0",    "-30 -75 50", "60 30 -40",
        "-140 25 20",   "130 -35 -30", "-45 -30 60", "10 5 -20",   "90 -5 30",   "-95 5 -40",
        "175 15 10",    "5 70 60",     "15 -70 -10", "50 -40 30",  "-50 40 -30", "140 30 40",
        "-130 -30 -20", "0 15 45",     "75 50 0",    "-75 -50 20", "160 0 -45"};
    char text[4000];
    size_t used = (size_t)snprintf(text, sizeof text,
                                   "imukit_motion: 1\nstart: {latitude: 48.1 deg, longitude: 11.6 "
                                   "deg, height: 520 m}\nsteps:\n  - hold 10 s\n");
    for (size_t k = 0; k < sizeof poses / sizeof poses[0]; k++)
        used += (size_t)snprintf(text + used, sizeof text - used,
                                 "  - pose %s deg in 2 s\n  - hold 4 s\n", poses[k]);
    put("poses.yaml", text);
}

static void write_log(void)
{
    put_unit();
    put_poses();
    assert_int_equal(run("$I simulate unit.yaml --motion poses.yaml --rate 100Hz --seed 1 -o "
                         "poses.csv"),
                     0);
}

static imk_model read_model(const char *path)
{
    imk_model model;
    imk_error error;
    if (imk_model_read(path, &model, NULL, &error) != IMK_OK)
        fail_msg("%s: %s %s", path, error.field, error.expected);
    return model;
}

/* Every parameter the model has a 1 sigma of, against the truth. @return how many there are */
static size_t check_against(const imk_model *found, const imk_model *truth, double sigmas)
{
    size_t count = 0;
    for (int k = 0; k < found->correlation.count; k++) {
        const imk_model_parameter p = found->correlation.parameter[k];
        imk_model copy = *found;
        double *sigma;
        char name[IMK_MODEL_PARAMETER_NAME];
        const double *value = imk_model_parameter_at(&copy, p, &sigma);
        CHECK_OK(imk_model_parameter_name(p, name));
        assert_non_null(value);
        const double due = truth ? imk_model_parameter_get(truth, p) : 0;
        /* The mean of a run's flicker noise is a bias of that run: some times its instability. */
        const double instability = p.term != IMK_MODEL_BIAS ? 0 : p.sensor == 0 ? 2e-5 : 4e-4;
        if (!(fabs(*value - due) <= sigmas * *sigma + instability))
            fail_msg("%s: %.9g, due %.9g, 1 sigma %.3g", name, *value, due, *sigma);
        count++;
    }
    return count;
}

/* 30 parameters of a fixed seed: all within 4.5 sigma of what was simulated (a false alarm of 2e-4
 * if the sigmas were exact and normal; the seed is fixed and others pass). After compensation of
 * another log of the same unit, what is left is within the uncertainties of both calibrations. */
static void closed_loop(void **state)
{
    (void)state;
    write_log();
    assert_int_equal(run("$I calibrate poses.csv " POSES " -o found.yaml"), 0);
    assert_string_equal(err, "");
    check_contains(out, "Usable: accelerometer bias to ", "verdict");
    check_contains(out, "Frame upper-triangular: the z accelerometer senses along body z", "frame");
    check_contains(out, "Gravity 9.80739 m/s^2 (WGS84 at the place given).", "gravity");
    check_contains(out, "Next: imukit compensate LOG found.yaml -o clean.csv\n", "next");
    const imk_model found = read_model("found.yaml"), truth = read_model("unit.yaml");
    assert_int_equal(check_against(&found, &truth, 4.5), 30);
    assert_string_equal(found.accel_evidence.frame, "upper-triangular");
    assert_string_equal(found.gyro_evidence.source, "poses.csv");
    assert_int_equal(found.accel_evidence.interval_count, 2);

    assert_int_equal(run("$I simulate unit.yaml --motion poses.yaml --rate 100Hz --seed 2 -o "
                         "other.csv && $I compensate other.csv found.yaml -o clean.csv && $I "
                         "calibrate clean.csv " POSES " -o left.yaml"),
                     0);
    imk_model left = read_model("left.yaml");
    for (int k = 0; k < left.correlation.count; k++) {
        double *one, *both;
        (void)imk_model_parameter_at(&left, left.correlation.parameter[k], &both);
        imk_model copy = found;
        (void)imk_model_parameter_at(&copy, left.correlation.parameter[k], &one);
        *both = sqrt(*both * *both + *one * *one);
    }
    assert_int_equal(check_against(&left, NULL, 4.5), 30);
    sweep();
}

/* Only what is estimated is replaced; comments and the noise stay. */
static void into_keeps_the_rest(void **state)
{
    (void)state;
    write_log();
    put("known.yaml", "imukit: 1 # mine\n"
                      "name: my unit\n"
                      "gyro:\n"
                      "  bias: {fixed: 0 deg/s, repeatability: 100 deg/h}\n"
                      "  noise: {angle_random_walk: 0.3 deg/sqrt(h)} # from identify\n"
                      "accel:\n"
                      "  range: 4 g\n");
    assert_int_equal(run("$I calibrate poses.csv " POSES " --into known.yaml -o new.yaml "
                         "--estimate accel.bias,accel.scale_factor,gyro.bias"),
                     0);
    check_contains(err, "Changes to known.yaml:\n- ", "changes");
    read_text("new.yaml", out);
    check_contains(out, "imukit: 1 # mine\nname: my unit\n", "comment");
    check_contains(out, "noise: {angle_random_walk: 0.3 deg/sqrt(h)} # from identify\n", "noise");
    check_contains(out, "repeatability: 100 deg/h", "repeatability");
    check_contains(out, "  range: 4 g\n", "range");
    const imk_model made = read_model("new.yaml");
    assert_int_equal(made.correlation.count, 9);
    assert_true(made.accel.bias.fixed.sigma[2] > 0);
    CHECK_CLOSE(made.accel.misalignment.value[0][1], 0, 0);
    sweep();
}

static void json_has_its_shape(void **state)
{
    (void)state;
    write_log();
    assert_int_equal(run("$I calibrate poses.csv " POSES " --json"), 0);
    json_error_t problem;
    json_t *document = json_loads(out, 0, &problem);
    if (!document)
        fail_msg("%s in %s", problem.text, out);
    assert_string_equal(json_string_value(json_object_get(document, "command")), "calibrate");
    const json_t *result = json_object_get(document, "result");
    const json_t *parameters = json_object_get(result, "parameters");
    assert_int_equal(json_array_size(parameters), 30);
    const json_t *first = json_array_get(parameters, 0);
    assert_string_equal(json_string_value(json_object_get(first, "name")), "accel.bias.fixed.x");
    assert_string_equal(json_string_value(json_object_get(first, "unit")), "m/s^2");
    const double value = json_real_value(json_object_get(first, "value"));
    assert_true(json_real_value(json_object_get(first, "lower")) < value);
    assert_true(json_real_value(json_object_get(first, "upper")) > value);
    const json_t *correlation = json_object_get(result, "correlation");
    assert_int_equal(json_array_size(json_array_get(correlation, 29)), 30);
    CHECK_CLOSE(json_number_value(json_array_get(json_array_get(correlation, 7), 7)), 1, 1e-12);
    assert_int_equal(json_array_size(json_object_get(result, "poses")), 24);
    assert_string_equal(
        json_string_value(json_object_get(json_object_get(result, "usability"), "grade")),
        "usable");
    assert_string_equal(json_string_value(json_object_get(result, "frame")), "upper-triangular");
    const json_t *fit = json_object_get(json_object_get(result, "fit"), "accel");
    CHECK_CLOSE(json_real_value(json_object_get(fit, "factor")), 1, 0.5);
    json_decref(document);
    sweep();
}

static void outputs_are_written(void **state)
{
    (void)state;
    write_log();
    assert_int_equal(run("$I calibrate poses.csv " POSES " --report page.html --poses"), 0);
    check_contains(out, "force along", "poses");
    read_text("page.html", err);
    check_contains(err, "Calibration of an inertial sensor", "title");
    check_contains(err, "windows of ", "holds");
    check_contains(err, "correlation:", "model");
    sweep();
}

/* ---- logs that cannot be used ---------------------------------------------------------------- */

/* Alter each row of poses.csv with an awk program. */
static void alter(const char *program)
{
    char line[600];
    snprintf(line, sizeof line,
             "awk -F, 'BEGIN{OFS=\",\"} NR==1{print;next}{%s;print}' poses.csv >bad.csv", program);
    assert_int_equal(run(line), 0);
}

static void check_says(const char *line, int code, const char *message)
{
    const int actual = run(line);
    if (actual != code)
        fail_msg("%s: code %d, expected %d\n%s%s", line, actual, code, out, err);
    check_contains(err, message, line);
}

static void bad_columns_are_explained(void **state)
{
    static const struct {
        const char *program;
        int code;
        const char *says;
    } cases[] = {
        {"for(i=5;i<8;i++)$i/=9.80665", 1,
         "gravity is 9.8074: the columns look like g, not m/s^2; correct the unit in the header to "
         "g"},
        {"for(i=5;i<8;i++)$i*=1000/9.80665", 1, "the columns look like mg, not m/s^2"},
        {"for(i=2;i<5;i++)$i*=3.14159265358979/180", 1,
         "the columns look like rad/s; correct the unit in the header to rad/s"},
        {"$1*=1000", 1, "the times look like ms; add --time-unit ms, or correct the header"},
        {"t=$2;$2=$3;$3=t", 1, "gyro_x and gyro_y look exchanged: the turns of the gyros lead"},
        {"$3=-$3", 1,
         "gyro_y has the wrong sign relative to the other axes: the axes are mirrored"},
        {"$5=\"nan\"", 1, "accel_x never has a number: nothing can be estimated from this column"},
        {"$5=1.25", 1, "accelerometer x never changes its reading"},
        {"for(i=2;i<5;i++)$i=int($i*16.4);for(i=5;i<8;i++)$i=int($i*1670)", 1,
         "they look like counts; write [count] into the header (or add --accel-unit count)"},
        {"for(i=5;i<8;i++)if($i>9.6)$i=9.6;else if($i<-9.6)$i=-9.6", 0,
         "is at the end of its range in"},
    };
    (void)state;
    write_log();
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        if (check_skips(k, 4))
            continue;
        alter(cases[k].program);
        check_says("$I calibrate bad.csv " POSES " -o never.yaml", cases[k].code, cases[k].says);
        assert_int_equal(access("never.yaml", F_OK) == 0, cases[k].code == 0);
    }
    sweep();
}

static void bad_tests_are_explained(void **state)
{
    (void)state;
    put_unit();
    put("swing.yaml", "imukit_motion: 1\nsteps:\n  - swing x 20 deg at 0.7 Hz for 60 s\n");
    put("plane.yaml", "imukit_motion: 1\nsteps:\n  - hold 10 s\n"
                      "  - repeat: {times: 12, steps: [rotate x 29 deg in 2 s, hold 4 s]}\n");
    put("few.yaml", "imukit_motion: 1\nsteps:\n  - hold 10 s\n"
                    "  - pose 100 20 40 deg in 2 s\n  - hold 4 s\n"
                    "  - pose 20 70 0 deg in 2 s\n  - hold 4 s\n"
                    "  - pose -30 -40 50 deg in 2 s\n  - hold 4 s\n");
    const char *const names[] = {"swing", "plane", "few"};
    for (int k = 0; k < 3; k++) {
        char line[200];
        snprintf(line, sizeof line, "$I simulate unit.yaml --motion %s.yaml --rate 100Hz -o %s.csv",
                 names[k], names[k]);
        assert_int_equal(run(line), 0);
    }
    assert_int_equal(run("$I simulate unit.yaml --rate 100Hz --duration 60s -o rest.csv"), 0);
    check_says(
        "$I calibrate swing.csv " POSES, 1,
        "swing.csv: the unit is never stationary for long enough: it is stationary in 0 % of");
    check_says("$I calibrate rest.csv " POSES, 1,
               "rest.csv: the unit is stationary in one pose all the time");
    check_says("$I calibrate plane.csv " POSES, 1,
               "plane.csv: the poses all lie in one plane: gravity hardly ever acts along x; add "
               "poses with x up, with x down and with x at 45 deg");
    check_says("$I calibrate few.csv " POSES, 1, "few.csv: the log has 4 poses, ");
    check_says("$I calibrate rest.csv -p rate-table", 1,
               "rest.csv: rate-table needs the rates or forces that acted on the unit");
    check_says("$I calibrate rest.csv -p thermal", 1,
               "rest.csv has no column temperature [degC], which thermal needs");
    sweep();
}

static void wrong_usage_is_explained(void **state)
{
    (void)state;
    put_unit();
    put("left.yaml", "imukit: 1\nname: rest\nresidual_of: bench unit\ngyro: {}\naccel: {}\n");
    assert_int_equal(run("$I simulate unit.yaml --rate 100Hz --duration 10s -o rest.csv"), 0);
    check_message("$I calibrate rest.csv", 2,
                  "imukit calibrate: error: the procedure of the test is missing: add --procedure "
                  "multiposition for a unit that was turned by hand from rest to rest; imukit "
                  "calibrate --help lists the others\n" TRY("calibrate"));
    check_message("$I calibrate rest.csv -p multiposistion", 2,
                  "imukit calibrate: error: --procedure multiposistion: there is no such procedure "
                  "(did you mean multiposition?); there are multiposition, sixposition, ferraris, "
                  "rate-table, tumble, centrifuge, spin, thermal, turns, magnetometer and "
                  "repeatability\n" TRY("calibrate"));
    check_message("$I calibrate rest.csv -p multiposition,thermal", 2,
                  "imukit calibrate: error: --procedure multiposition,thermal: 2 procedures for 1 "
                  "log; give one for all, or one for each\n" TRY("calibrate"));
    check_message("$I calibrate rest.csv " POSES " --gravity 1m/s^2", 2,
                  "imukit calibrate: error: --gravity 1 m/s^2: expected 9.5 to 10.1 m/s^2, the "
                  "range on Earth\n" TRY("calibrate"));
    check_message(
        "$I calibrate rest.csv " POSES " --frame reference", 2,
        "imukit calibrate: error: --frame reference: gravity alone does not tell how the "
        "triad stands in the housing; add a log of sixposition, ferraris, tumble or "
        "rate-table, or choose upper-triangular, lower-triangular or symmetric\n" TRY("calibrate"));
    check_message("$I calibrate rest.csv " POSES " --with k2", 2,
                  "imukit calibrate: error: --with k2: expected nonlinearity, cross_products, "
                  "g_sensitivity, g2_sensitivity or gyro\n" TRY("calibrate"));
    check_message(
        "$I calibrate rest.csv " POSES " --model left.yaml", 1,
        "imukit calibrate: error: left.yaml describes the errors left after compensation with "
        "\"bench unit\"; calibrate the log before it was compensated, with that model "
        "and --into\n");
    check_says("$I calibrate rest.csv " POSES " --estimate bais", 2,
               "--estimate bais: no such term; expected bias, scale_factor");
    check_says("$I calibrate rest.csv " POSES " --accel-sensitivity '415 count'", 2,
               "--accel-sensitivity \"415 count\": expected one number, or one for each axis");
    sweep();
}

/* ---- with a reference ------------------------------------------------------------------------ */

static void put_table(void)
{
    put("table.yaml",
        "imukit_motion: 1\n"
        "start: {latitude: 48.1 deg, longitude: 11.6 deg, height: 520 m}\n"
        "steps:\n"
        "  - hold 5 s\n"
        "  - repeat: {times: 1, steps: [rotate z at 20 deg/s for 4 s, rotate z at -20 deg/s for 4 "
        "s, rotate z at 80 deg/s for 4 s, rotate z at -80 deg/s for 4 s]}\n"
        "  - pose 0 90 0 deg in 4 s\n"
        "  - repeat: {times: 1, steps: [rotate x at 20 deg/s for 4 s, rotate x at -20 deg/s for 4 "
        "s, rotate x at 80 deg/s for 4 s, rotate x at -80 deg/s for 4 s]}\n"
        "  - pose 90 0 0 deg in 4 s\n"
        "  - repeat: {times: 1, steps: [rotate y at 20 deg/s for 4 s, rotate y at -20 deg/s for 4 "
        "s, rotate y at 80 deg/s for 4 s, rotate y at -80 deg/s for 4 s]}\n"
        "  - hold 4 s\n");
}

/* The programme that was simulated is the reference: gyro errors within 4.5 sigma; begun at another
 * time, the offset is found to a fraction of a sample. */
static void programme_is_the_reference(void **state)
{
    (void)state;
    put_unit();
    put_table();
    assert_int_equal(run("$I simulate unit.yaml --motion table.yaml --rate 100Hz --seed 3 -o "
                         "table.csv"),
                     0);
    assert_int_equal(run("$I calibrate table.csv -p rate-table --motion table.yaml --without "
                         "nonlinearity,g_sensitivity -o found.yaml"),
                     0);
    const imk_model found = read_model("found.yaml");
    imk_model truth = read_model("unit.yaml");
    assert_int_equal(found.correlation.count, 12);
    assert_string_equal(found.gyro_evidence.frame, "reference");
    for (int i = 0; i < 3; i++) {
        /* The table stands level or on edge, so that g-sensitivity is part of the bias. */
        CHECK_CLOSE(found.gyro.scale_factor.fixed.value[i], truth.gyro.scale_factor.fixed.value[i],
                    300e-6);
        for (int j = 0; j < 3; j++)
            CHECK_CLOSE(found.gyro.misalignment.value[i][j], truth.gyro.misalignment.value[i][j],
                        300e-6);
    }
    assert_int_equal(run("awk -F, 'BEGIN{OFS=\",\"} NR==1{print;next}{$1+=1.337;print}' table.csv "
                         ">late.csv"),
                     0);
    check_says("$I calibrate late.csv -p rate-table --motion table.yaml", 0,
               "fits the programme best if the programme begins 1.337");
    check_says("$I calibrate late.csv -p rate-table --motion table.yaml --motion-offset auto", 0,
               "late.csv: the programme begins at 1.337");
    sweep();
}

/* A column of the table's rate, and what is said when it cannot be understood. */
static void reference_columns_are_read(void **state)
{
    (void)state;
    put_unit();
    put("spin.yaml", "imukit_motion: 1\nearth: no\nsteps:\n  - hold 5 s\n"
                     "  - rotate z at 20 deg/s for 5 s\n  - rotate z at -20 deg/s for 5 s\n"
                     "  - rotate z at 90 deg/s for 5 s\n  - rotate z at -90 deg/s for 5 s\n"
                     "  - hold 5 s\n");
    put("perfect.yaml", "imukit: 1\ngyro: {}\n");
    assert_int_equal(run("$I simulate unit.yaml --motion spin.yaml --rate 50Hz -o a.csv && $I "
                         "simulate perfect.yaml --motion spin.yaml --rate 50Hz -o b.csv && paste "
                         "-d, a.csv b.csv | cut -d, -f1-4,11 | sed '1s/.*/time [s],gyro_x "
                         "[deg\\/s],gyro_y [deg\\/s],gyro_z [deg\\/s],table_rate [deg\\/s]/' "
                         ">table.csv"),
                     0);
    assert_int_equal(run("$I calibrate table.csv -p rate-table --table-axis z --estimate "
                         "gyro.bias,gyro.scale_factor.fixed.z -o found.yaml"),
                     0);
    const imk_model found = read_model("found.yaml");
    CHECK_CLOSE(found.gyro.scale_factor.fixed.value[2], 3000e-6, 300e-6);
    assert_false(found.accel.present);
    assert_int_equal(run("$I calibrate table.csv -p rate-table --table-axis z --without "
                         "nonlinearity | grep -q \"g-sensitivity and the Earth's rotation in the "
                         "bias of the gyros (37 deg/h\""),
                     0);
    check_says("$I calibrate table.csv -p rate-table", 2,
               "table.csv has a column table_rate; state the axis of the unit about which the "
               "table turns it, such as --table-axis z");
    assert_int_equal(run("sed '1s/table_rate .deg.s./table_rate/' table.csv >none.csv && sed "
                         "'1s/table_rate .deg.s./table_rate [g]/' table.csv >wrong.csv"),
                     0);
    check_says("$I calibrate none.csv -p rate-table --table-axis z", 1,
               "none.csv: table_rate has no unit; write it into the header, such as table_rate "
               "[deg/s]");
    check_says("$I calibrate wrong.csv -p rate-table --table-axis z", 1,
               "wrong.csv: table_rate [g] should be an angular rate, such as deg/s");
    sweep();
}

/* Eight power cycles of a unit that stays where it is: the simulated repeatability lies within the
 * interval of 95 % on this seed; one run is refused. */
static void runs_are_compared(void **state)
{
    (void)state;
    put("cycles.yaml", "imukit: 1\ngyro:\n  bias: {repeatability: 60 deg/h}\n  noise: "
                       "{angle_random_walk: 0.3 deg/sqrt(h)}\n");
    assert_int_equal(run("for k in 0 1 2 3 4 5 6 7; do $I simulate cycles.yaml --rate 50Hz "
                         "--duration 20s --run $k -o run$k.csv; done"),
                     0);
    assert_int_equal(run("$I calibrate run?.csv -p repeatability -o found.yaml"), 0);
    check_contains(out, "bias, 1 sigma from run to run  deg/h", "table");
    const imk_model found = read_model("found.yaml");
    const imk_interval *interval = &found.gyro_evidence.interval[0];
    assert_string_equal(interval->key, "bias.repeatability");
    for (int axis = 0; axis < 3; axis++) {
        const double truth = 60.0 / 3600.0 * 3.14159265358979 / 180.0;
        assert_true(interval->lower.value[axis] < truth && truth < interval->upper.value[axis]);
    }
    check_says("$I calibrate run0.csv -p repeatability", 1,
               "1 run: at least two are needed, better ten");
    sweep();
}

/* ---- plan ------------------------------------------------------------------------------------ */

/* A programme for 100 ppm, simulated and calibrated, states no more than that, and finds the truth
 * within 4.5 sigma. */
static void programme_reaches_what_was_wanted(void **state)
{
    (void)state;
    put_unit();
    assert_int_equal(run("$I calibrate --plan unit.yaml " POSES " --want 'accel.scale_factor 100 "
                         "ppm, gyro.scale_factor 100 ppm' -o programme.yaml"),
                     0);
    check_contains(out, "accel.scale_factor.fixed.x  ppm   100", "wishes");
    check_contains(out,
                   "Programme: programme.yaml\nNext: imukit simulate unit.yaml --motion "
                   "programme.yaml --rate 100Hz --duration ",
                   "next");
    assert_int_equal(run("$I simulate unit.yaml --motion programme.yaml --rate 100Hz --duration "
                         "200s --seed 5 -o bench.csv && $I calibrate bench.csv " POSES
                         " -o found.yaml"),
                     0);
    const imk_model found = read_model("found.yaml"), truth = read_model("unit.yaml");
    assert_true(check_against(&found, &truth, 4.5) >= 21);
    for (int i = 0; i < 3; i++) {
        assert_true(found.accel.scale_factor.fixed.sigma[i] < 100e-6);
        assert_true(found.gyro.scale_factor.fixed.sigma[i] < 115e-6);
    }
    check_says("$I calibrate --plan unit.yaml " POSES " --want 'accel.scale_factor'", 2,
               "--want \"accel.scale_factor\": expected a term and its 1 sigma");
    check_says("$I calibrate --plan unit.yaml " POSES " --want 'accel.bias 5 ppm'", 2,
               "--want \"accel.bias 5 ppm\": expected a positive number with a unit such as mg");
    put("perfect.yaml", "imukit: 1\ngyro: {}\naccel: {}\n");
    check_says("$I calibrate --plan perfect.yaml " POSES, 1,
               "perfect.yaml states no noise, so the length of the test cannot be computed");
    sweep();
}

/* ---- real log -------------------------------------------------------------------------------- */

#define XSENS SHARED_DIRECTORY "/data/calibration/xsens_mti_multiposition_raw_counts.csv.gz"

/* Raw counts of a turntable-free calibration: what the reference implementation published
 * (golden.md). Its solution is not quite the least-squares optimum, hence 3 sigma. It has no
 * g-sensitivity: without it the scale of the gyros agrees to 0.05 %. The unit does have one, of
 * some 600 deg/h/g, so that this leaves a chi-square per degree of freedom of turns far above one;
 * with it, the default, that is near one, and the scale is 0.06 to 0.09 % from the published. */
static void real_log_gives_the_published_figures(void **state)
{
    (void)state;
    if (access(XSENS, R_OK) != 0) {
        print_message("[ SKIPPED ] %s is not there\n", XSENS);
        skip();
    }
    static const double accel[3] = {414.4589, 412.0105, 414.6487},
                        gyro[3] = {4777.96, 4764.21, 4773.66};
    static const double limit[2] = {1e-3, 5e-4};
    double chi_square[2], g_sensitivity = 0, sigma = 0;
    for (int without = 0; without < 2; without++) {
        assert_int_equal(run(without ? "$I calibrate " XSENS " -p multiposition --gravity "
                                       "9.81744m/s^2 --without g_sensitivity --json -o found.yaml"
                                     : "$I calibrate " XSENS " -p multiposition --gravity "
                                       "9.81744m/s^2 --json -o found.yaml"),
                         0);
        const imk_model m = read_model("found.yaml");
        for (int i = 0; i < 3; i++) {
            const double s = m.accel.sensitivity.value[i], r = m.gyro.sensitivity.value[i];
            CHECK_CLOSE(s * (1 + m.accel.scale_factor.fixed.value[i]), accel[i],
                        3 * s * m.accel.scale_factor.fixed.sigma[i]);
            CHECK_RELATIVE(r * (1 + m.gyro.scale_factor.fixed.value[i]), gyro[i], limit[without]);
            for (int j = 0; j < 3 && !without; j++)
                if (fabs(m.gyro.g_sensitivity.value[i][j]) > g_sensitivity) {
                    g_sensitivity = fabs(m.gyro.g_sensitivity.value[i][j]);
                    sigma = m.gyro.g_sensitivity.sigma[i][j];
                }
        }
        json_t *all = json_loads(out, 0, NULL);
        const json_t *turns =
            json_object_get(json_object_get(json_object_get(all, "result"), "fit"), "turn");
        chi_square[without] = json_number_value(json_object_get(turns, "chi_square")) /
                              json_number_value(json_object_get(turns, "degrees_of_freedom"));
        json_decref(all);
    }
    print_message("chi-square per degree of freedom %.3g with and %.3g without g-sensitivity %.3g "
                  "+- %.3g deg/h/g\n",
                  chi_square[0], chi_square[1], g_sensitivity * 206264.80624709636 * 9.80665,
                  sigma * 206264.80624709636 * 9.80665);
    assert_true(g_sensitivity > 10 * sigma);
    assert_true(chi_square[0] < 2 && chi_square[1] > 4 * chi_square[0]);
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closed_loop),
        cmocka_unit_test(into_keeps_the_rest),
        cmocka_unit_test(json_has_its_shape),
        cmocka_unit_test(outputs_are_written),
        cmocka_unit_test(bad_columns_are_explained),
        cmocka_unit_test(bad_tests_are_explained),
        cmocka_unit_test(wrong_usage_is_explained),
        cmocka_unit_test(programme_is_the_reference),
        cmocka_unit_test(reference_columns_are_read),
        cmocka_unit_test(runs_are_compared),
        cmocka_unit_test(programme_reaches_what_was_wanted),
        cmocka_unit_test(real_log_gives_the_published_figures),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
