/* SPDX-License-Identifier: Apache-2.0 */
/* imukit calibrate --pose-means: what a table shows, when the option is suggested, and what it does
 * not go with. */
#include "run_command.h"

#define TABLE " -p multiposition -g 9.80743m/s^2 --pose-means"
#define FACES " -p sixposition -g 9.80743m/s^2 --pose-means"

enum { POSES = 26 };

/* Uniform, of unit variance. */
static double draw(void)
{
    static uint32_t state = 1;
    state = state * 1664525u + 1013904223u;
    return ((double)state / 4294967296.0 - 0.5) * sqrt(12.0);
}

/* The directions to the faces, edges and corners of a cube, faces first, up and down in turn. */
static void direction(int pose, double u[3])
{
    int seen = 0;
    for (int size = 1; size <= 3; size++)
        for (int k = 0; k < 27; k++) {
            const int x[3] = {k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1};
            if (x[0] * x[0] + x[1] * x[1] + x[2] * x[2] == size && seen++ == pose)
                for (int i = 0; i < 3; i++)
                    u[i] = x[i] / sqrt(size);
        }
}

/* Noise of 0.1 mg and 2 deg/h; bias 0.2, -0.3, 0.1 m/s^2. `spread`: the last columns. */
static void write_table(const char *path, int poses, bool labels, const char *spread)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file,
            "%saccel_x [m/s^2],accel_y [m/s^2],accel_z [m/s^2],gyro_x [deg/s],gyro_y "
            "[deg/s],gyro_z [deg/s]%s\n",
            labels ? "pose," : "",
            spread ? ",accel_x_std [m/s^2],accel_y_std [m/s^2],accel_z_std [m/s^2],samples" : "");
    for (int k = 0; k < poses; k++) {
        static const double bias[3] = {0.2, -0.3, 0.1};
        double u[3] = {0};
        direction(labels ? k % 6 : k % POSES, u);
        if (labels)
            fprintf(file, "%c_%s,",
                    fabs(u[0]) > 0.5   ? 'x'
                    : fabs(u[1]) > 0.5 ? 'y'
                                       : 'z',
                    u[0] + u[1] + u[2] > 0 ? "up" : "down");
        for (int i = 0; i < 3; i++)
            fprintf(file, "%.6f,", 9.80743 * u[i] + bias[i] + 1e-3 * draw());
        fprintf(file, "%.6f,%.6f,%.6f%s\n", 0.1 + 5e-4 * draw(), 5e-4 * draw(), 5e-4 * draw(),
                spread ? spread : "");
    }
    fclose(file);
}

static json_t *results(const char *line)
{
    json_error_t error;
    if (run(line) != 0)
        fail_msg("%s: %s", line, err);
    json_t *root = json_loads(out, 0, &error);
    assert_non_null(root);
    return root;
}

static bool has_sentence(const json_t *result, const char *code)
{
    size_t k;
    json_t *sentence;
    json_array_foreach(json_object_get(result, "sentences"), k,
                       sentence) if (strcmp(json_string_value(json_object_get(sentence, "code")),
                                            code) == 0) return true;
    return false;
}

/* Rows have numbers and labels and no times; without standard deviations there is no chi-square. */
static void rows_are_named(void **state)
{
    (void)state;
    write_table("faces.csv", 18, true, NULL);
    json_t *root = results("$I calibrate faces.csv" FACES " --json");
    const json_t *result = json_object_get(root, "result");
    const json_t *pose = json_array_get(json_object_get(result, "poses"), 3);
    const json_t *log = json_array_get(json_object_get(json_object_get(root, "inputs"), "logs"), 0);
    const json_t *fit = json_object_get(json_object_get(result, "fit"), "accel");
    assert_int_equal(json_integer_value(json_object_get(pose, "row")), 4);
    assert_string_equal(json_string_value(json_object_get(pose, "label")), "z_up");
    assert_null(json_object_get(pose, "begin"));
    assert_true(json_is_true(json_object_get(log, "pose_means")));
    assert_null(json_object_get(log, "interval"));
    assert_null(json_object_get(fit, "chi_square"));
    assert_non_null(json_object_get(fit, "degrees_of_freedom"));
    assert_true(has_sentence(result, "noise_of_residuals"));
    json_decref(root);
    const char *line = "$I calibrate faces.csv" FACES " --poses";
    assert_int_equal(run(line), 0);
    check_contains(out, "row 4   z_up", line);
    check_contains(out, "accelerometer readings  54        0         - / ", line);
    assert_null(strstr(out, "[s]"));
    sweep();
}

static void table_with_deviations(void **state)
{
    (void)state;
    write_table("table.csv", POSES, false, ",0.02,0.02,0.02,400");
    json_t *root = results("$I calibrate table.csv" TABLE " --json");
    const json_t *result = json_object_get(root, "result");
    const json_t *fit = json_object_get(result, "fit");
    /* 0.02/sqrt(400) is what the readings scatter by. */
    CHECK_CLOSE(json_number_value(json_object_get(json_object_get(fit, "accel"), "factor")), 1,
                0.6);
    assert_null(json_object_get(json_object_get(fit, "gyro"), "factor"));
    assert_true(has_sentence(result, "no_turns"));
    json_decref(root);
    const char *line = "$I calibrate table.csv" TABLE " --report page.html -o unit.yaml";
    assert_int_equal(run(line), 0);
    check_contains(out, "table.csv has no turns", line);
    check_contains(out, "table.csv does not say how well the gyro means are known", line);
    assert_null(strstr(out, "sampling rate")); /* no turns, no clock */
    sweep();
}

/* Without turns nothing tells an inverted axis from mirrored attitudes; labels, and turns, do. */
static void inverted_axes_are_seen_or_listed(void **state)
{
    (void)state;
    static const char unseen[] = "an accelerometer with the opposite sign, or several";
    write_table("table.csv", POSES, false, NULL);
    const char *line = "awk -F, -v OFS=, 'NR > 1 {$2 = -$2} {print}' table.csv >inverted.csv; "
                       "$I calibrate inverted.csv" TABLE;
    assert_int_equal(run(line), 0);
    check_contains(out, unseen, line);
    write_table("faces.csv", 18, true, NULL);
    line = "awk -F, -v OFS=, 'NR > 1 {$3 = -$3} {print}' faces.csv >inverted.csv; "
           "$I calibrate inverted.csv" FACES;
    assert_int_equal(run(line), 1);
    check_contains(err, "label each hold by the axis that reads gravity", line);
    line = "$I calibrate faces.csv" FACES;
    assert_int_equal(run(line), 0);
    assert_null(strstr(out, "opposite sign"));
    line = "cut -d, -f2- faces.csv >unnamed.csv; $I calibrate unnamed.csv" FACES;
    assert_int_equal(run(line), 0);
    check_contains(out, unseen, line);
    sweep();
}

/* 0.001 m/s^2 of the means, stated as if it were that of 400 samples: chi-square is 400 for each
 * degree of freedom. Means that are four times too noisy for another reason are not told so. */
static void deviations_divided_twice(void **state)
{
    (void)state;
    const char *line = "$I calibrate table.csv" TABLE " --strict";
    write_table("table.csv", POSES, false, ",0.001,0.001,0.001,400");
    assert_int_equal(run(line), 1);
    check_contains(err, "name the columns accel_x_std_of_mean", line);
    write_table("table.csv", POSES, false, ",0.005,0.005,0.005,400");
    assert_int_equal(run(line), 0);
    check_contains(out, "the residuals are", line);
    assert_null(strstr(out, "std_of_mean"));
    write_table("table.csv", POSES, false, ",0.02,0.02,0.02,400");
    assert_int_equal(run(line), 0);
    assert_null(strstr(out, "std_of_mean"));
    sweep();
}

static void outliers_are_rows(void **state)
{
    (void)state;
    write_table("table.csv", POSES, false, NULL);
    const char *line = "awk -F, -v OFS=, 'NR == 6 {$1 += 0.5} {print}' table.csv > bad.csv; "
                       "$I calibrate bad.csv" TABLE;
    assert_int_equal(run(line), 0);
    check_contains(out, "Left out, because they do not fit the others: row 5.", line);
    sweep();
}

/* Where a table fails as a log for want of times or of rows, the message says so; where a log does,
 * it does not. */
static void option_is_suggested(void **state)
{
    (void)state;
    const char *const tables[] = {
        "$I calibrate table.csv -p multiposition", "$I calibrate faces.csv -p sixposition",
        "$I calibrate stated.csv -p multiposition", "$I calibrate timed.csv -p multiposition",
        "$I calibrate table.csv -p multiposition --rate 1Hz"};
    const char *const logs[] = {"$I calibrate table.csv -p rate-table", /* needs times */
                                "$I calibrate log.csv -p multiposition",
                                "$I calibrate rest.csv -p multiposition",
                                "$I calibrate rest.csv -p multiposition --rate 100Hz",
                                "$I calibrate log.csv -p multiposition --rate 100Hz"};
    write_table("table.csv", POSES, false, NULL);
    write_table("stated.csv", POSES, false, ",0.02,0.02,0.02,400");
    write_table("faces.csv", 6, true, NULL);
    assert_int_equal(run("awk 'NR == 1 {print \"time [s],\" $0} NR > 1 {print 10*NR \",\" $0}' "
                         "table.csv > timed.csv; "
                         "awk 'NR == 1 {print} NR > 1 {for (k = 0; k < 10; k++) print}' table.csv "
                         "> log.csv; "
                         "awk 'NR == 1 {print} NR == 2 {for (k = 0; k < 300; k++) print}' "
                         "table.csv > rest.csv"),
                     0);
    for (size_t k = 0; k < sizeof tables / sizeof *tables; k++) {
        assert_int_equal(run(tables[k]), 1);
        check_contains(err, "add --pose-means", tables[k]);
    }
    for (size_t k = 0; k < sizeof logs / sizeof *logs; k++) {
        assert_int_equal(run(logs[k]), 1);
        if (strstr(err, "pose-means"))
            fail_msg("%s: %s", logs[k], err);
    }
    sweep();
}

static void check_says(const char *line, int code, const char *message)
{
    const int actual = run(line);
    if (actual != code)
        fail_msg("%s: code %d, expected %d\n%s%s", line, actual, code, out, err);
    check_contains(err, message, line);
}

static void what_does_not_go_with_it(void **state)
{
    (void)state;
    write_table("table.csv", POSES, false, ",0.02,0.02,0.02,400");
    check_says("$I calibrate table.csv -p rate-table --pose-means", 2, "rate-table needs a log");
    check_says("$I calibrate table.csv -p repeatability --pose-means", 2,
               "repeatability needs a log");
    check_says("$I calibrate table.csv" TABLE " --window 2s", 2,
               "--window: a table of pose means has no times");
    check_says("$I calibrate table.csv" TABLE " --rate 100Hz", 2,
               "--rate: a table of pose means has no times");
    check_says("$I calibrate table.csv" TABLE " --axes right-forward-up", 2,
               "--axes does not go with --pose-means");
    check_says("$I calibrate table.csv -p tumble --pose-means", 1, "reference_force_x [g]");
    check_says(
        "sed '1s/accel_x_std .m.s.2./accel_x_std/' table.csv > w.csv; $I calibrate w.csv" TABLE, 1,
        "accel_x_std has no unit; write it into the header, such as accel_x_std [m/s^2]");
    check_says("cut -d, -f1-9 table.csv > w.csv; $I calibrate w.csv" TABLE, 1,
               "add a column samples with their number");
    check_says("sed '1s/accel_z_std/other/' table.csv > w.csv; $I calibrate w.csv" TABLE, 1,
               "but not that of accel_z");
    check_says("awk 'NR == 1 {print} NR > 1 {for (k = 0; k < 10; k++) print}' table.csv | "
               "cut -d, -f1-6 > w.csv; $I calibrate w.csv" TABLE,
               1, "w.csv looks like a log");
    check_says("awk -F, -v OFS=, 'NR == 1 {print} NR == 2 {for (k = 0; k < 9; k++) "
               "{for (i = 1; i <= 6; i++) $i += 1e-4*(k*i % 5 - 2); print}}' table.csv | "
               "cut -d, -f1-6 > w.csv; $I calibrate w.csv" TABLE,
               1, "all rows are of one attitude");
    check_says("head -8 table.csv > w.csv; $I calibrate w.csv" TABLE, 1,
               "multiposition needs at least 12 holds, found 7");
    check_says("(cat table.csv; sed -n 4p table.csv) > w.csv; $I calibrate w.csv" TABLE, 0,
               "the readings of rows 3 and 27 are equal on all axes");
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_are_named),
        cmocka_unit_test(table_with_deviations),
        cmocka_unit_test(inverted_axes_are_seen_or_listed),
        cmocka_unit_test(deviations_divided_twice),
        cmocka_unit_test(outliers_are_rows),
        cmocka_unit_test(option_is_suggested),
        cmocka_unit_test(what_does_not_go_with_it),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
