/* SPDX-License-Identifier: Apache-2.0 */
/* Each verb on good input: exact output, published values, the closed loop. */
#include "run_command.h"

#include "imukit/allan.h"

/* The same bytes whatever the threads and the way out; another seed or run makes others. */
static void test_simulate_is_reproducible(void **state)
{
    (void)state;
    assert_int_equal(run("$I simulate AHRS --rate 100Hz --duration 700s --seed 7 -o a.csv"), 0);
    assert_string_equal(err, "");
    assert_string_equal(out, "");
    assert_int_equal(run("head -1 a.csv; wc -l <a.csv"), 0);
    assert_string_equal(out, "time [s],gyro_x [deg/s],gyro_y [deg/s],gyro_z [deg/s],"
                             "accel_x [m/s^2],accel_y [m/s^2],accel_z [m/s^2]\n70001\n");
    assert_int_equal(run("$I simulate AHRS --rate 100Hz --duration 700s --seed 7 --threads 1 | "
                         "cmp - a.csv"),
                     0);
    assert_int_equal(run("$I simulate AHRS --rate 0.1kHz --duration 700s --seed=7 --threads 3 -o - "
                         "| cmp - a.csv"),
                     0);
    assert_int_equal(run("$I simulate AHRS --rate 100Hz --duration 700s --seed 8 | cmp -s - a.csv"),
                     1);
    assert_int_equal(run("$I simulate AHRS --rate 100Hz --duration 700s --seed 7 --run 1 | cmp -s "
                         "- a.csv"),
                     1);
    sweep();
}

static void test_simulate_units_and_decimals(void **state)
{
    (void)state;
    assert_int_equal(run("$I simulate AHRS --rate 4Hz --duration 0.5s --decimals 2 --gyro-unit "
                         "deg/h --accel-unit mg"),
                     0);
    assert_int_equal(strncmp(out, "time [s],gyro_x [deg/h],", 24), 0);
    check_contains(out, ",accel_z [mg]\n0.00,", "two decimals");
    check_contains(out, "\n0.25,", "time by the rate");
    /* Without Earth rate and gravity, and with a model without errors, every sample is zero. */
    put("perfect.yaml", "imukit: 1\nname: perfect\ngyro: {}\naccel: {}\n");
    assert_int_equal(run("$I simulate perfect.yaml --rate 2Hz --duration 1s --no-earth"), 0);
    check_contains(out, "]\n0,0,0,0,0,0,0\n0.5,0,0,0,0,0,0\n", "perfect unit");
    /* At rest and level at the equator: gravity by Somigliana's formula, 9.7803253359 m/s^2. */
    assert_int_equal(run("$I simulate perfect.yaml --rate 1Hz --duration 1s --latitude 0deg "
                         "--decimals 8"),
                     0);
    check_contains(out, ",-9.78032534\n", "gravity");
    /* A single axis keeps its name, and a sensor with a sensitivity makes counts. */
    put("z.yaml", "imukit: 1\ngyro:\n  direction: [0 0 1]\n  sensitivity: 4778 count/(rad/s)\n"
                  "  zero_offset: 32768 count\n");
    assert_int_equal(run("$I simulate z.yaml --rate 1Hz --duration 1s --no-earth"), 0);
    assert_string_equal(out, "time [s],gyro_z [count]\n0,32768\n");
    sweep();
}

/* ---- allan ----------------------------------------------------------------------------------- */

/* The 1000-point set of NIST SP 1065 and its published OADEV at 1, 10, 100. */
static void write_nist(const char *path, bool phase)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    uint64_t n = 1234567890;
    double sum = 0;
    if (phase)
        fputs("0\n", file);
    for (int i = 0; i < 1000; i++, n = 16807 * n % 2147483647) {
        sum += (double)n / 2147483647;
        fprintf(file, "%.17g\n", phase ? sum : (double)n / 2147483647);
    }
    fclose(file);
}

static void check_nist_line(const char *line, double tau, double expected)
{
    double read_tau, deviation, lower, upper;
    assert_non_null(line = strchr(line, ','));
    assert_int_equal(sscanf(line, ",%lf,%lf,%lf,%lf,", &read_tau, &deviation, &lower, &upper), 4);
    CHECK_CLOSE(read_tau, tau, 0);
    CHECK_CLOSE(deviation, expected, 1e-10); /* as printed: ten decimals */
    assert_true(lower < deviation && deviation < upper);
}

static void check_nist_table(void)
{
    const char *header = "channel,tau [s],deviation [unit],lower,upper,edf,count,unit,"
                         "statistic,noise,used\n";
    assert_int_equal(strncmp(out, header, strlen(header)), 0);
    const char *line = strchr(out, '\n') + 1;
    check_nist_line(line, 1, .2922318781);
    line = strchr(line, '\n') + 1;
    check_nist_line(line, 10, .0915995342);
    line = strchr(line, '\n') + 1;
    check_nist_line(line, 100, .0324134303);
}

static void test_allan_published_values(void **state)
{
    (void)state;
    write_nist("rate.txt", false);
    const char *whole = "--columns gyro_x --gyro-unit rad/s --rate 1Hz";
    setenv("A", whole, 1);
    assert_int_equal(run("$I allan rate.txt $A --tau 1,10,100 -o -"), 0);
    check_nist_table();
    assert_int_equal(run("$I allan rate.txt $A --tau 1s,100s --statistic adev -o - | tail -1"), 0);
    check_nist_line(out, 100, .0389780433);
    /* Intervals of Stable32 at 68.3 %: .28515 to .29987 at 1 s to 2e-3. */
    assert_int_equal(
        run("$I allan rate.txt $A --tau 1s --edf greenhall-riley --confidence 68.3% -o "
            "- | tail -1"),
        0);
    double lower, upper;
    assert_int_equal(sscanf(out, "gyro_x,1,%*f,%lf,%lf", &lower, &upper), 2);
    CHECK_RELATIVE(lower, .28515, 2e-3);
    CHECK_RELATIVE(upper, .29987, 2e-3);
    sweep();
}

/* Columns that are no sensor's: rates, and phase (their integral). */
static void test_allan_of_any_column(void **state)
{
    (void)state;
    write_nist("rate.txt", false);
    write_nist("phase.txt", true);
    assert_int_equal(run("$I allan rate.txt --columns x --rate 1Hz --tau 1s,10s,100s -o -"), 0);
    check_nist_table();
    assert_int_equal(run("$I allan phase.txt --columns x --rate 1Hz --tau 1s,10s,100s --type phase "
                         "-o -"),
                     0);
    check_nist_table();
    assert_int_equal(run("$I allan rate.txt --columns x --rate 1Hz | sed -n 3p"), 0);
    assert_string_equal(out, "tau [s]  x [1]\n");
    sweep();
}

/* The rest of the family: published values (golden.md), and what is refused. */
static void test_allan_statistics(void **state)
{
    (void)state;
    write_nist("x.txt", false);
    setenv("A", "--columns gyro_x --gyro-unit rad/s --rate 1Hz", 1);
    assert_int_equal(run("$I allan x.txt $A --tau 10 --statistic mdev,tdev,mtot,htot --bias "
                         "published -o - | cut -d, -f3,8,9"),
                     0);
    double mdev, tdev, mtot, htot;
    assert_int_equal(sscanf(out,
                            "deviation [unit],unit,statistic\n%lf,rad/s,mdev\n%lf,rad/s*s,tdev\n"
                            "%lf,rad/s,mtot\n%lf,rad/s,htot\n",
                            &mdev, &tdev, &mtot, &htot),
                     4);
    CHECK_CLOSE(mdev, .0617237638, 1e-10);
    CHECK_CLOSE(tdev, .3563623166, 1e-10);
    CHECK_CLOSE(mtot, .06499161, 1e-8); /* printed to eight decimals, cut */
    CHECK_CLOSE(htot, .09614787, 1e-8);
    assert_int_equal(
        run("$I allan x.txt $A --tau 7.5 --statistic theo1 --bias left -o - | tail -1"), 0);
    check_nist_line(out, 7.5, .1075739889);
    assert_int_equal(run("$I allan x.txt $A --statistic all"), 0);
    for (imk_allan_statistic k = 0; k < IMK_ALLAN_STATISTICS; k++)
        check_contains(out, imk_allan_title(k), "statistic");
    assert_int_equal(run("$I allan x.txt $A --statistic all --tau many --json"), 0);
    check_contains(out, "\"statistic\": \"haar\"", "json");
    check_message("$I allan x.txt $A --statistic mdevv", 2,
                  "imukit allan: error: --statistic mdevv: there is no \"mdevv\"; did you mean "
                  "mdev?\n" TRY("allan"));
    check_message("$I allan x.txt $A --statistic mdev,mdev", 2,
                  "imukit allan: error: --statistic mdev,mdev: mdev is named twice\n" TRY("allan"));
    check_message("$I allan x.txt $A --statistic theo1 --tau 1", 2,
                  "imukit allan: error: --tau 1: 1 s is outside the averaging times of this "
                  "record, 7.5 s to 750 s\n" TRY("allan"));
    sweep();
}

static void test_allan_taus(void **state)
{
    (void)state;
    write_nist("x.txt", false);
    assert_int_equal(run("$I allan x.txt --columns gyro_x --gyro-unit rad/s --rate 1Hz"), 0);
    check_contains(out, "tau [s]  gyro_x [deg/s]", "table");
    check_contains(out, "\n256 ", "octaves");
    assert_int_equal(
        run("$I allan x.txt --columns gyro_x --gyro-unit rad/s --rate 1Hz --tau all -o - | wc -l"),
        0);
    assert_string_equal(out, "501\n");
    assert_int_equal(run("$I allan x.txt $A --tau 1,nan"), 2);
    check_contains(err, "\"nan\" is not an averaging time", "--tau 1,nan");
    check_message("$I allan x.txt --columns gyro_x --gyro-unit rad/s --rate 1Hz --tau 1,2m", 2,
                  "imukit allan: error: --tau 1,2m: \"2m\" is not an averaging time; expected "
                  "octave, decade, many, all or a list such as 1,10,100 in seconds\n" TRY("allan"));
    check_message("$I allan x.txt --columns gyro_x --gyro-unit rad/s --rate 1Hz --tau 1s,501s", 2,
                  "imukit allan: error: --tau 1s,501s: 501 s is outside the averaging times of "
                  "this record, 1 s to 500 s\n" TRY("allan"));
    check_message("$I allan x.txt --columns gyro_x --gyro-unit rad/s --rate 1Hz --tau 10s,1s", 2,
                  "imukit allan: error: --tau 10s,1s: the times must ascend\n" TRY("allan"));
    check_message(
        "$I allan x.txt --columns gyro_x --gyro-unit rad/s --rate 1Hz --plot a.gif", 2,
        "imukit allan: error: --plot a.gif: expected a name ending in .svg, .png or .pdf, or "
        "the word term\n" TRY("allan"));
    sweep();
}

/* Logs side by side: the numbers are those of each alone, a channel that one of them has not is of
 * the other only, and each averaging time of either has a row. */
static void test_allan_of_several(void **state)
{
    (void)state;
    put("one.yaml", "imukit: 1\ngyro: {noise: {angle_random_walk: 0.1 deg/sqrt(h)}}\n");
    assert_int_equal(run("$I simulate one.yaml --rate 10Hz --duration 20s --seed 1 -o a.csv && $I "
                         "simulate one.yaml --rate 20Hz --duration 20s --seed 2 -o b.csv && $I "
                         "convert b.csv b.csv.gz --select time,gyro_x"),
                     0);
    assert_int_equal(run("$I allan a.csv --tau octave -o a.txt && $I allan b.csv.gz -o b.txt && $I "
                         "allan a.csv b.csv.gz -o ab.txt && { sed 1d a.txt | sed s/^/a.csv,/; sed "
                         "1d b.txt | sed s/^/b.csv.gz,/; } >expected && sed 1d ab.txt | cmp - "
                         "expected"),
                     0);
    assert_int_equal(run("$I allan a.csv b.csv.gz --plot p.svg"), 0);
    check_contains(out, "\ngyro_x [deg/h]\ntau [s]  a.csv [deg/h]", "table");
    check_contains(out, "b.csv.gz [deg/h]\n0.05     -   ", "table");
    check_contains(out, "\ngyro_y [deg/h]\ntau [s]  a.csv [deg/h]\n0.1 ", "table");
    assert_int_equal(run("grep -c '>gyro_[xyz]<' p.svg; grep -c '>a.csv<' p.svg; grep -c "
                         "'>b.csv.gz<' p.svg"),
                     0);
    assert_string_equal(out, "3\n3\n1\n");
    assert_int_equal(run("$I allan a.csv b.csv.gz --json | grep -c '\"sentence\"'"), 0);
    assert_string_equal(out, "3\n"); /* of each, and of both */
    assert_int_equal(run("$I allan a.csv missing.csv"), 1);
    check_contains(err, "missing.csv", err);
    sweep();
}

/* ---- identify -------------------------------------------------------------------------------- */

/* Simulate, identify, and find the truth inside the intervals: 18 intervals of 99.99 % each all
 * cover with probability 0.998; this seed is fixed, so the test itself does not vary. */
static void test_identify_recovers_the_model(void **state)
{
    (void)state;
    assert_int_equal(run("$I simulate AHRS --rate 20Hz --duration 30min --seed 3 -o s.csv"), 0);
    assert_int_equal(run("$I identify s.csv --truth AHRS --confidence 0.9999 --twin -o m.yaml "
                         "--report r.html"),
                     0);
    check_contains(out, "\n18 of 18 intervals cover the truth; 99.99 % are expected to.\n", out);
    check_contains(out,
                   "Report: r.html\nModel: m.yaml\nNext: imukit grade m.yaml, or imukit convert "
                   "m.yaml filter.yaml --to filter --rate 20Hz\n",
                   out);
    assert_int_equal(run("$I grade m.yaml"), 0);
    assert_int_equal(run("$I convert m.yaml filter.yaml --to filter --rate 20Hz"), 0);
    assert_int_equal(run("$I simulate m.yaml --rate 20Hz --duration 1min -o twin.csv"), 0);
    read_text("r.html", out);
    check_contains(out, "<p class=\"judgement ", "page");
    check_contains(out, "imukit identify s.csv --truth AHRS --confidence 0.9999", "page");
    check_contains(out, "angle_random_walk: ", "page");
    check_contains(out, "<svg", "page");
    sweep();
}

static void test_identify_json(void **state)
{
    (void)state;
    assert_int_equal(run("$I simulate AHRS --rate 20Hz --duration 5min --no-earth -o s.csv"), 0);
    assert_int_equal(run("$I identify s.csv --json"), 0);
    json_error_t error;
    json_t *document = json_loads(out, JSON_REJECT_DUPLICATES, &error);
    assert_non_null(document);
    const char *version, *verb, *code, *name, *unit;
    double value;
    assert_int_equal(json_unpack(document,
                                 "{s:s, s:s, s:{s:i}, s:{s:[{s:s, s:{s:{s:F, s:s}}}]}, "
                                 "s:[{s:s}]}",
                                 "imukit", &version, "command", &verb, "inputs", "rows", &(int){0},
                                 "result", "channels", "name", &name, "terms", "angle_random_walk",
                                 "value", &value, "unit", &unit, "findings", "code", &code),
                     0);
    assert_string_equal(version, IMK_VERSION);
    assert_string_equal(verb, "identify");
    assert_string_equal(name, "gyro_x");
    assert_string_equal(unit, "rad/sqrt(s)");
    /* 0.3 deg/sqrt(h), 6000 samples: 1 sigma is 0.9 %. */
    CHECK_RELATIVE(value, 8.7266462599716e-5, 0.06);
    assert_string_equal(code, "gravity");
    json_decref(document);
    /* Without gravity the verdict is bad: --strict says so by the exit code, --json or not. */
    check_contains(err, "|accel| is ", "gravity");
    assert_int_equal(run("$I identify s.csv --json --strict"), 1);
    assert_int_equal(run("$I identify s.csv --strict"), 1);
    sweep();
}

static void test_identify_names_the_likely_unit(void **state)
{
    (void)state;
    assert_int_equal(run("$I simulate AHRS --rate 20Hz --duration 1min --accel-unit g | sed "
                         "'1s/[[]g[]]/[m\\/s^2]/g' >s.csv; head -1 s.csv"),
                     0);
    check_contains(out, "accel_z [m/s^2]", "header");
    assert_int_equal(run("$I identify s.csv"), 0);
    check_contains(err,
                   "m/s^2 at rest: the numbers look like g; write g into the header, or add "
                   "--accel-unit g if it has no unit.",
                   err);
    sweep();
}

/* Only what is identified is replaced, and the changes are shown. */
static void test_identify_into(void **state)
{
    (void)state;
    put("old.yaml",
        "imukit: 1\n# measured on the table\nname: unit 7\ngyro:\n  bias: {fixed: 1 2 3 "
        "deg/h}\n  noise: {angle_random_walk: 9 deg/sqrt(h)}\n");
    assert_int_equal(run("$I simulate AHRS --rate 20Hz --duration 2min | cut -d, -f1-4 >s.csv"), 0);
    assert_int_equal(run("$I identify s.csv --into old.yaml -o new.yaml"), 0);
    check_contains(err, "Changes to old.yaml:\n-   noise: {angle_random_walk: 9 deg/sqrt(h)}\n+ ",
                   err);
    read_text("new.yaml", out);
    check_contains(out, "bias: {fixed: 1 2 3 deg/h}", "kept");
    check_contains(out, "# measured on the table", "kept");
    check_contains(out, "name: unit 7", "kept");
    assert_null(strstr(out, "{angle_random_walk: 9 deg/sqrt(h)}"));
    sweep();
}

/* ---- models, catalogue, conversion ----------------------------------------------------------- */

static void test_models(void **state)
{
    (void)state;
    assert_int_equal(run("$I grade navigation"), 0);
    check_contains(out, "navigation: navigation\n", "grade");
    check_contains(out, "\n->  navigation ", "grade");
    assert_int_equal(run("$I grade AHRS | head -4"), 0);
    check_contains(out, "Gyro: AHRS; remaining bias ", "grade");
    check_message("$I grade navigatoin", 1,
                  "imukit grade: error: model: \"navigatoin\" is not a known name; did you mean "
                  "\"navigation\"?\n");
    put("k.yaml", "imukit: 1\ngyro:\n  noise:\n    angle_random_wlk: 0.1 deg/sqrt(h)\n");
    check_message("$I grade k.yaml", 1,
                  "imukit grade: error: k.yaml:4:5: gyro.noise.angle_random_wlk: "
                  "\"angle_random_wlk\" is not a known key; did you mean "
                  "\"angle_random_walk\"?\n");
    put("u.yaml", "imukit: 1\ngyro:\n  noise:\n    angle_random_walk: 0.1 deg/h\n");
    assert_int_equal(run("$I simulate u.yaml --rate 1Hz --duration 1s -o s.csv"), 1);
    check_contains(err, "u.yaml:4:", "dimension");
    put("e.yaml", "imukit: 1\ngyro: {}\n");
    check_message("$I grade e.yaml", 1,
                  "imukit grade: error: e.yaml states no bias repeatability, no bias instability "
                  "and no uncertainty of the fixed bias: there is nothing to grade\n");
    assert_int_equal(access("s.csv", F_OK), -1);
    sweep();
}

static void test_devices(void **state)
{
    (void)state;
    assert_int_equal(run("$I devices | head -4"), 0);
    check_contains(out, "gyro N [deg/sqrt(h)]", "devices");
    check_contains(out, "\nstrategic ", "devices");
    assert_int_equal(run("$I devices ADIS16488 >d.yaml && $I grade d.yaml"), 0);
    assert_string_equal(err, "");
    assert_int_equal(run("$I devices --json"), 0);
    json_t *document = json_loads(out, JSON_REJECT_DUPLICATES, NULL);
    assert_non_null(document);
    json_decref(document);
    sweep();
}

/* Part of a name, without regard to case, blanks and hyphens. */
static void test_devices_by_part_of_name(void **state)
{
    (void)state;
    assert_int_equal(run("$I devices bmi | cut -d' ' -f1 | sed -n 3,6p"), 0);
    assert_string_equal(out, "name\nBMI088\nBMI160\nBMI270\n");
    assert_int_equal(run("$I devices 'Mti 630'"), 0);
    check_contains(out, "# Xsens MTi-630 (industrial MEMS)\n", "one hit");
    assert_int_equal(run("$I devices adis16405"), 0); /* "ADIS16405 measured" is another one */
    check_contains(out, "# ADIS16405 (industrial MEMS)\n", "the name itself");
    assert_int_equal(run("$I devices ADIS16505-2"), 0);
    check_contains(out, "# ADIS16505-2: the catalogue has no errors of this part", "a part");
    check_contains(out, "#   ADIS16505-2 gyro: 40 LSB/(deg/s), 16 bits\n", "a part");
    assert_int_equal(run("$I devices adis1649 | grep -c 'sensitivities only'"), 0);
    assert_string_equal(out, "3\n");
    check_message("$I devices ICM20649", 1,
                  "imukit devices: error: there is no device \"ICM20649\"; did you mean "
                  "\"ICM20602\" or \"ICM-20948\"?\n");
    check_message("$I devices xyz", 1,
                  "imukit devices: error: there is no device \"xyz\"; the names are listed by: "
                  "imukit devices\n");
    sweep();
}

/* What a count is, in an entry that stays a model file, and in its JSON. */
static void test_devices_sensitivities(void **state)
{
    (void)state;
    assert_int_equal(run("$I devices bmi088 | tee d.yaml"), 0);
    check_contains(out, "#   BMI088 accel 24 g: 1365 LSB/g, 16 bits\n", "an entry");
    check_contains(out, "#   BMI088 temperature: 0.125 K/LSB, 11 bits, 0 at 23 degC\n", "an entry");
    assert_int_equal(run("$I grade d.yaml"), 0);
    assert_string_equal(err, "");
    assert_int_equal(run("$I devices bmi088 --json"), 0);
    json_t *document = json_loads(out, JSON_REJECT_DUPLICATES, NULL), *list, *row;
    const json_t *result = json_object_get(document, "result");
    list = json_object_get(json_array_get(json_object_get(result, "devices"), 0), "sensitivities");
    assert_int_equal(json_array_size(list), 10);
    row = json_array_get(list, 8);
    assert_string_equal(json_string_value(json_object_get(row, "kind")), "accel");
    assert_string_equal(json_string_value(json_object_get(row, "stated")), "1365 LSB/g");
    const json_t *value = json_object_get(json_object_get(row, "per_count"), "value");
    CHECK_RELATIVE(json_number_value(value), 9.80665 / 1365, 1e-14);
    assert_true(json_is_null(json_object_get(row, "zero")));
    assert_int_equal(json_array_size(json_object_get(result, "parts")), 0);
    json_decref(document);
    assert_int_equal(run("$I devices ADIS16505 --json"), 0);
    document = json_loads(out, JSON_REJECT_DUPLICATES, NULL);
    list = json_object_get(json_object_get(document, "result"), "parts");
    assert_int_equal(json_array_size(list), 3);
    json_decref(document);
    sweep();
}

static void test_convert(void **state)
{
    (void)state;
    write_good();
    static const char *const formats[] = {"b.csv", "b.csv.gz", "b.csv.zst"};
    char line[300];
    assert_int_equal(run("$I convert good.csv a.csv"), 0);
    for (size_t i = 0; i < 3; i++) {
        snprintf(line, sizeof line, "$I convert good.csv %s && $I convert %s - | cmp - a.csv",
                 formats[i], formats[i]);
        assert_int_equal(run(line), 0);
    }
    assert_int_equal(run("$I convert good.csv b.npy && $I convert b.npy - --rate 100Hz | cmp - "
                         "a.csv"),
                     0);
    assert_int_equal(
        run("$I convert good.csv - --select gyro_x --to-gyro-unit deg/min --decimals 3 "
            "| head -2"),
        0);
    assert_string_equal(out, "gyro_x [deg/min]\n0.000\n");
    check_message("$I convert good.csv c.csv --select gyrox", 1,
                  "imukit convert: error: --select: the log has no column \"gyrox\"; did you mean "
                  "\"gyro_x\"?\n");
    /* Increments become rates: 0.1 deg in each 0.01 s is 10 deg/s. */
    put("i.csv", "time [s],dtheta_x [deg]\n0,0.1\n0.01,0.1\n0.02,0.1\n");
    assert_int_equal(run("$I convert i.csv - --decimals 3"), 0);
    check_contains(out, "time [s],gyro_x [deg/s]\n0.000,10.000\n", "increments");
    /* A model goes to JSON and back. */
    put("m.yaml", "imukit: 1\nname: m\ngyro:\n  noise:\n    angle_random_walk: 0.3 deg/sqrt(h)\n");
    assert_int_equal(
        run("$I convert m.yaml m.json && $I convert m.json n.yaml && cmp m.yaml n.yaml"), 0);
    read_text("m.json", out);
    json_t *document = json_loads(out, JSON_REJECT_DUPLICATES, NULL);
    assert_non_null(document);
    json_decref(document);
    sweep();
}

static void test_plots(void **state)
{
    (void)state;
    write_good();
    assert_int_equal(run("$I allan good.csv --plot a.svg && grep -c '</svg>' a.svg"), 0);
    if (!imk_plot_available("x.png")) {
        print_message("the rest skipped: rsvg-convert is not installed\n");
        sweep();
        return;
    }
    assert_int_equal(run("$I identify good.csv --plot b.png && head -c 4 b.png | tail -c 3 >&2"),
                     0);
    check_contains(err, "PNG", "png");
    assert_int_equal(run("$I allan good.csv --plot term"), 0);
    check_contains(out, "averaging time [s]", "terminal");
    assert_null(strchr(out, '\033'));
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_simulate_is_reproducible),
        cmocka_unit_test(test_simulate_units_and_decimals),
        cmocka_unit_test(test_allan_published_values),
        cmocka_unit_test(test_allan_of_any_column),
        cmocka_unit_test(test_allan_statistics),
        cmocka_unit_test(test_allan_taus),
        cmocka_unit_test(test_identify_recovers_the_model),
        cmocka_unit_test(test_identify_json),
        cmocka_unit_test(test_identify_names_the_likely_unit),
        cmocka_unit_test(test_identify_into),
        cmocka_unit_test(test_models),
        cmocka_unit_test(test_devices),
        cmocka_unit_test(test_devices_by_part_of_name),
        cmocka_unit_test(test_devices_sensitivities),
        cmocka_unit_test(test_convert),
        cmocka_unit_test(test_allan_of_several),
        cmocka_unit_test(test_plots),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
