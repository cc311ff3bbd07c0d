/* SPDX-License-Identifier: Apache-2.0 */
/* Temperature files: the points that steps and tables become, and what is refused. Times and
 * temperatures are sums done by hand; 0 degC is 273.15 K. */
#define _POSIX_C_SOURCE 200809L

#include "check.h"

#include "imukit/io.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static char script_path[64], table_path[64];

static void write_file(const char *path, const char *text)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    assert_int_equal(fclose(file), 0);
}

static imk_temperature_file *read_file(const char *path)
{
    imk_temperature_file *file = NULL;
    imk_error error;
    if (imk_temperature_read(path, &file, &error) != IMK_OK) {
        char message[512];
        imk_error_text(&error, path, message, sizeof message);
        fail_msg("%s", message);
    }
    return file;
}

static void check_points(const imk_temperature_file *file, size_t count, const double (*point)[2])
{
    const imk_temperature_profile *profile = imk_temperature_file_profile(file);
    assert_int_equal(profile->point_count, count);
    for (size_t i = 0; i < count; i++) {
        /* Some roundings of 3000 s and 300 K. */
        CHECK_CLOSE(profile->time[i], point[i][0], 1e-11);
        CHECK_CLOSE(profile->temperature[i], point[i][1] + 273.15, 1e-12);
    }
}

/* 35 K at 1 K/min is 2100 s. */
static void steps_become_points(void **state)
{
    (void)state;
    static const double due[][2] = {{0, 25},    {2100, 60}, {4500, -20}, {6300, -20},
                                    {6300, 25}, {6360, 25}, {6380, 24.5}};
    write_file(script_path, "imukit_temperature: 1\nname: chamber\ntime_constant: 5 min\nsteps:\n"
                            "  - start 25 degC\n  - ramp to 60 degC at 1 degC/min\n"
                            "  - ramp to -20 degC in 40 min\n  - soak 30 min\n"
                            "  - step to 298.15 K\n  - ramp to 25 degC at 1 K/s\n"
                            "  - soak for 60 s\n  - ramp to 24.5 degC at 1.5 degC/min\n");
    imk_temperature_file *file = read_file(script_path);
    check_points(file, COUNT(due), due);
    CHECK_CLOSE(imk_temperature_file_profile(file)->time_constant, 300, 0);
    /* Before the ramp is over the unit is behind: u - m tau (1 - e^{-t/tau}). */
    const double time = 2100, m = 1.0 / 60;
    double temperature, rate;
    imk_temperature_at(imk_temperature_file_profile(file), 1, &time, &temperature, &rate);
    CHECK_RELATIVE(temperature, 333.15 - m * 300 * (1 - exp(-7.0)), 1e-14);
    imk_temperature_file_free(file);
}

/* 45 K at 1 K/min, 30 min, 90 min, and the step. */
static void example_of_the_manual_is_read(void **state)
{
    (void)state;
    static const double due[][2] = {{0, 25}, {2700, -20}, {4500, -20}, {9900, 60}, {9900, 25}};
    static char text[1 << 16];
    FILE *manual = fopen(SOURCE_DIRECTORY "/docs/motion-file.md", "rb");
    assert_non_null(manual);
    assert_true(fread(text, 1, sizeof text - 1, manual) > 0);
    fclose(manual);
    char *example = strstr(text, "```yaml\nimukit_temperature");
    assert_non_null(example);
    example += strlen("```yaml\n");
    char *end = strstr(example, "```");
    assert_non_null(end);
    *end = '\0';
    write_file(script_path, example);
    imk_temperature_file *file = read_file(script_path);
    check_points(file, COUNT(due), due);
    imk_temperature_file_free(file);
}

static void table_becomes_points(void **state)
{
    (void)state;
    static const double due[][2] = {{0, 20}, {30, 20.5}, {30, 25}, {90, -10}};
    write_file(table_path, "time [min],Temp [degC],gyro_x [deg/s]\n"
                           "2,20,0\n2.5,20.5,0\n2.5,25,0\n3.5,-10,0\n");
    imk_temperature_file *file = read_file(table_path);
    check_points(file, COUNT(due), due);
    CHECK_CLOSE(imk_temperature_file_profile(file)->time_constant, 0, 0);
    imk_temperature_file_free(file);
}

static void quantity_is_a_constant(void **state)
{
    (void)state;
    static const double due[][2] = {{0, 25}}, cold[][2] = {{0, -40}};
    imk_temperature_file *file = read_file("25degC");
    check_points(file, 1, due);
    imk_temperature_file_free(file);
    file = read_file("-40 degC");
    check_points(file, 1, cold);
    imk_temperature_file_free(file);
    file = read_file("298.15 K");
    check_points(file, 1, due);
    imk_temperature_file_free(file);
}

#define HEAD "imukit_temperature: 1\n"

static const struct {
    const char *text, *message;
} bad_scripts[] =
    {
        {HEAD "steps: [soak 30 min]\n", "t.yaml:2:9: steps[0]: \"soak 30 min\" cannot be read; "
                                        "start with a step such as start 25 degC"},
        {HEAD "steps: [start 25 degC, start 30 degC]\n",
         "t.yaml:2:24: steps[1]: \"start 30 degC\" cannot be read; start can only be the first "
         "step; write step to 25 degC"},
        {HEAD "steps: [start 25 degC, warm to 30 degC]\n",
         "t.yaml:2:24: steps[1]: \"warm\" is not a step; expected one of start, ramp, soak, step"},
        {HEAD "steps: [start 25 degC, ramp to 30 degC]\n",
         "t.yaml:2:24: steps[1]: \"ramp to 30 degC\" cannot be read; write ramp to 60 degC at 1 "
         "degC/min or ramp to 60 degC in 40 min"},
        {HEAD "steps: [start 25 degC, ramp to 30 degC at 1 degC]\n",
         "t.yaml:2:43: steps[1]: \"1 degC\" is a temperature; expected a rate of temperature like "
         "degC/min or K/s"},
        {HEAD "steps: [start 25 degC, ramp to 30 degC at -1 K/min]\n",
         "t.yaml:2:43: steps[1]: \"-1 K/min\" is outside its valid range; expected a number above "
         "0"},
        {HEAD "steps: [start 25 degC, rmp to 30 degC at 1 K/min]\n",
         "t.yaml:2:24: steps[1]: \"rmp\" is not a step; did you mean \"ramp\"?"},
        {HEAD "steps: [start 25]\n",
         "t.yaml:2:15: steps[0]: \"25\" has no unit; expected a unit such as degC or K"},
        {HEAD "steps: [start -300 degC]\n", "t.yaml:2:15: steps[0]: \"-300 degC\" is outside its "
                                            "valid range; expected a temperature above 0 K"},
        {HEAD "steps: [start 25 degC, soak -5 s]\n",
         "t.yaml:2:29: steps[1]: \"-5 s\" is outside its valid range; expected a number above 0"},
        {HEAD "steps: [start 25 degC, {soak: 5 s}]\n",
         "t.yaml:2:24: steps[1]: the text cannot be read; expected a step such as ramp to 60 degC "
         "at 1 degC/min"},
        {HEAD "steps: []\n", "t.yaml:2:8: steps: \"[]\" cannot be read; expected a list of steps: "
                             "[start 25 degC, soak 30 min, …]"},
        {HEAD "name: x\n", "t.yaml:1:1: \"steps\" is missing; expected a list of steps: [start 25 "
                           "degC, soak 30 min, …]"},
        {HEAD "step: [start 25 degC]\n",
         "t.yaml:2:1: step: \"step\" is not a known key; did you mean \"steps\"?"},
        {HEAD "time_constant: -5 s\nsteps: [start 25 degC]\n",
         "t.yaml:2:16: time_constant: \"-5 s\" is outside its valid range; expected a time of 0 s "
         "or more"},
        {"imukit_temperature: 1.1\nsteps: [start 25 degC]\n",
         "t.yaml:1:21: imukit_temperature: \"1.1\" is not a supported version; version 1 of the "
         "format"},
        {"steps: [start 25 degC]\n", "t.yaml:1:1: a required key is missing; write "
                                     "imukit_temperature: 1, the version of the format"},
        {"- start 25 degC\n",
         "t.yaml:1:1: the file format is not recognised; expected a temperature file: keys and "
         "values, beginning with imukit_temperature: 1"},
},
  bad_tables[] =
      {
          {"time [s],x\n0,1\n", "t.csv: temperature: this column is missing; give the columns time "
                                "[s] and temperature [degC]"},
          {"time [s],temperature [degC]\n0,1\n2,1\n1,1\n",
           "t.csv: time, row 3: this time is before that of the row before; sort the rows by time"},
          {"time [s],temperature [degC]\n0,1\n1,\n",
           "t.csv: temperature, row 2: nan is not finite; expected a number in every row"},
          {"time [s],temperature [K]\n0,1\n1,-2\n",
           "t.csv: temperature, row 2: \"-2 K\" is not above absolute zero; expected a temperature "
           "above 0 K"},
          {"time [s],temperature [count]\n0,1\n1,2\n",
           "t.csv: temperature: \"count\" is a number of counts; expected a temperature, such as "
           "degC or K"},
          {"temperature [K]\n1\n2\n",
           "t.csv: time: this column is missing; give the columns time [s] and temperature [degC]"},
},
  bad_quantities[] = {
      {"25", "--temperature: \"25\" has no unit; expected a unit such as degC or K"},
      {"25 m", "--temperature: \"25 m\" is a length; expected a temperature like degC or K"},
      {"25 ± 1 degC", "--temperature: \"25 ± 1 degC\" is outside its valid range; expected a "
                      "temperature above 0 K, without uncertainty"},
      {"-300 degC", "--temperature: \"-300 degC\" is outside its valid range; expected a "
                    "temperature above 0 K, without uncertainty"},
      {"nowhere.csv", "--temperature: nowhere.csv: the file cannot be opened: No such file or "
                      "directory; check the path"},
};

static void check_refused(const char *path, const char *source, const char *due)
{
    imk_temperature_file *file = NULL;
    imk_error error;
    char message[512];
    const imk_status status = imk_temperature_read(path, &file, &error);
    assert_true(status != IMK_OK && error.status == status && !file);
    imk_error_text(&error, source, message, sizeof message);
    assert_string_equal(message, due);
    CHECK_STATUS(imk_temperature_read(path, &file, NULL), status);
}

static void refusals_say_what_is_due(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(bad_scripts); i++) {
        write_file(script_path, bad_scripts[i].text);
        check_refused(script_path, "t.yaml", bad_scripts[i].message);
    }
    for (size_t i = 0; i < COUNT(bad_tables); i++) {
        write_file(table_path, bad_tables[i].text);
        check_refused(table_path, "t.csv", bad_tables[i].message);
    }
    for (size_t i = 0; i < COUNT(bad_quantities); i++)
        check_refused(bad_quantities[i].text, "--temperature", bad_quantities[i].message);
}

static int make_paths(void **state)
{
    (void)state;
    snprintf(script_path, sizeof script_path, "/tmp/imukit_temperature_%ld.yaml", (long)getpid());
    snprintf(table_path, sizeof table_path, "/tmp/imukit_temperature_%ld.csv", (long)getpid());
    return 0;
}

static int remove_files(void **state)
{
    (void)state;
    remove(script_path);
    remove(table_path);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(steps_become_points),      cmocka_unit_test(example_of_the_manual_is_read),
        cmocka_unit_test(table_becomes_points),     cmocka_unit_test(quantity_is_a_constant),
        cmocka_unit_test(refusals_say_what_is_due),
    };
    return cmocka_run_group_tests(tests, make_paths, remove_files);
}
