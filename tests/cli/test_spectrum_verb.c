/* SPDX-License-Identifier: Apache-2.0 */
/* imukit spectrum: what it prints, writes and refuses. */
#include "run_command.h"

/* A minute at 100 Hz: white noise of one gyro, and a line of 12.5 Hz on it. */
static void write_line_log(void)
{
    assert_int_equal(run("$I simulate AHRS --rate 100Hz --duration 5min --seed 3 -o quiet.csv"), 0);
    FILE *in = fopen("quiet.csv", "r"), *to = fopen("line.csv", "w");
    char row[600];
    assert_non_null(in);
    assert_non_null(to);
    fputs("time [s],gyro_x [deg/s]\n", to);
    int i = 0;
    while (fgets(row, sizeof row, in)) {
        double t, x;
        if (sscanf(row, "%lf,%lf", &t, &x) == 2) {
            fprintf(to, "%.2f,%.6f\n", t, x + 0.02 * cos(6.283185307179586 * 12.5 * t));
            i++;
        }
    }
    fclose(in);
    fclose(to);
    assert_int_equal(i, 30000);
}

static json_t *spectrum_json(const char *line)
{
    json_error_t error;
    if (run(line) != 0) {
        print_error("%s\n%s", line, err);
        fail();
    }
    json_t *root = json_loads(out, 0, &error);
    assert_non_null(root);
    return root;
}

static double number(json_t *object, const char *key)
{
    return json_number_value(json_object_get(json_object_get(object, key), "value"));
}

/* The line with its frequency and amplitude, and N within its interval of what was simulated:
 * 0.3 deg/sqrt(h) = 8.727e-5 rad/sqrt(s); one-sided densities are twice the two-sided ones. */
static void test_values(void **state)
{
    (void)state;
    static const char *const methods[] = {"welch", "multitaper"};
    write_line_log();
    for (int m = 0; m < 2; m++) {
        char line[200];
        snprintf(line, sizeof line, "$I spectrum line.csv --json --method %s", methods[m]);
        json_t *root = spectrum_json(line);
        json_t *channel =
            json_array_get(json_object_get(json_object_get(root, "result"), "channels"), 0);
        json_t *lines = json_object_get(channel, "lines");
        assert_int_equal(json_array_size(lines), 1);
        json_t *found = json_array_get(lines, 0);
        assert_true(json_is_true(json_object_get(found, "coherent")));
        CHECK_CLOSE(number(found, "frequency"), 12.5, 5 * number(found, "frequency_sigma"));
        CHECK_CLOSE(number(found, "amplitude"), 0.02 * 0.017453292519943295,
                    5 * number(found, "amplitude_sigma"));
        json_t *white = json_object_get(
            json_object_get(json_object_get(channel, "parameters"), "terms"), "angle_random_walk");
        assert_string_equal(json_string_value(json_object_get(white, "unit")), "rad/sqrt(s)");
        CHECK_CLOSE(json_number_value(json_object_get(white, "value")),
                    0.3 * 0.017453292519943295 / 60,
                    5 * json_number_value(json_object_get(white, "sigma")));
        json_decref(root);
    }
    json_t *two = spectrum_json("$I spectrum line.csv --json");
    json_t *one = spectrum_json("$I spectrum line.csv --json --density one-sided");
    double density[2];
    json_t *roots[2] = {two, one};
    for (int i = 0; i < 2; i++) {
        json_t *channel =
            json_array_get(json_object_get(json_object_get(roots[i], "result"), "channels"), 0);
        json_t *band = json_array_get(json_object_get(channel, "bands"), 3);
        density[i] = number(band, "density");
        assert_string_equal(
            json_string_value(json_object_get(json_object_get(band, "density"), "unit")),
            "(rad/s)^2/Hz");
        json_decref(roots[i]);
    }
    CHECK_RELATIVE(density[1], 2 * density[0], 1e-15);
    assert_int_equal(sweep(), 2);
}

/* Where there is no spectrum, the option is named, not the log. */
static void test_begin_of_fit(void **state)
{
    (void)state;
    write_line_log();
    check_message("$I spectrum line.csv --from=-1Hz", 2,
                  "imukit spectrum: error: --from -1Hz: expected 0 or more\n" TRY("spectrum"));
    assert_int_equal(run("$I spectrum line.csv --from 1e308Hz"), 2);
    check_contains(err, "--from 1e+308 Hz: the spectrum of line.csv ends at half its sample rate, ",
                   "--from 1e308Hz");
    assert_int_equal(run("$I spectrum line.csv --from 0Hz"), 0);
    sweep();
}

static void test_outputs(void **state)
{
    (void)state;
    write_line_log();
    assert_int_equal(run("$I spectrum line.csv"), 0);
    check_contains(out, "frequency [Hz]  gyro_x [deg/h/sqrt(Hz)]", "the table");
    check_contains(out, "sinusoid", "the list of lines");
    check_contains(out, "angle random walk  deg/sqrt(h)", "the parameters");
    check_contains(out, "Root densities, two-sided, lines left out", "the explanation");
    assert_string_equal(err, "");
    assert_int_equal(run("$I spectrum line.csv -o psd.csv --report page.html --density one-sided "
                         "--resolution 0.1Hz --window blackman-harris --trend"),
                     0);
    assert_string_equal(out, "");
    assert_int_equal(run("head -1 psd.csv; grep -c 'gyro_x.*one-sided,rad/s' psd.csv"), 0);
    check_contains(out,
                   "channel,frequency [Hz],density [unit^2/Hz],lower,upper,degrees,sides,unit\n",
                   "the CSV");
    assert_int_equal(run("grep -c 'Power spectral density' page.html"), 0);
    assert_int_equal(run("$I spectrum line.csv --plot figure.svg > /dev/null"), 0);
    assert_int_equal(run("grep -q '<svg' figure.svg && rm figure.svg"), 0);
    assert_int_equal(sweep(), 4);
}

static void test_refusals(void **state)
{
    (void)state;
    write_good();
    check_message(
        "$I spectrum good.csv --resolution 0.01Hz", 2,
        "imukit spectrum: error: --resolution 0.01 Hz: finer than the record allows; this "
        "record of 10 s at 100 Hz allows about 0.15 Hz to 9 Hz\n" TRY("spectrum"));
    check_message("$I spectrum good.csv --from 20Hz --to 10Hz", 2,
                  "imukit spectrum: error: --from 20 Hz is not below --to 10 Hz\n" TRY("spectrum"));
    put("short.csv", "time [s],gyro_x [deg/s]\n0,1\n1,2\n2,1\n");
    check_message("$I spectrum short.csv", 1,
                  "imukit spectrum: error: short.csv: 3 rows are too few for a spectrum; at least "
                  "64 are needed, and some thousands are useful\n");
    assert_int_equal(run("$I spectrum good.csv --method wlech"), 2);
    check_contains(err, "welch", "the nearest choice");
    assert_int_equal(run("awk 'BEGIN {print \"time [s],gyro_x [deg/s]\"; for (i = 0; i < 100; i++) "
                         "print i \",1\"}' > flat.csv; $I spectrum flat.csv"),
                     1);
    check_contains(err, "is constant in all 100 rows", "a constant column");
    assert_int_equal(sweep(), 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_values), cmocka_unit_test(test_begin_of_fit),
        cmocka_unit_test(test_outputs), cmocka_unit_test(test_refusals)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
