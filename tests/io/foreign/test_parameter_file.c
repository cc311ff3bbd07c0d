/* SPDX-License-Identifier: Apache-2.0 */
/* Parameter files of other programs: each key in its unit and convention (computed here by hand
 * from the programs' own equations, docs/other-formats.md), values that cannot be in the unit, and
 * that writing and reading loses nothing but what is said to be lost. */
#include "check.h"
#include "io/random_model.h"

#include "imukit/io.h"
#include "imukit/parameter_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Units and square roots cost a few roundings. */
static const double rounding = 1e-14;

static const double degree = 0.017453292519943295; /* pi/180 */

static imk_model model;
static imk_parameter_notes notes;
static char message[1000];

static imk_status read_with(const imk_parameter_settings *settings, const char *text)
{
    imk_error error = {.status = IMK_OK};
    imk_status status = imk_parameters_parse(text, strlen(text), settings, &model, &notes, &error);
    assert_int_equal(status, error.status);
    message[0] = '\0';
    if (status != IMK_OK)
        imk_error_text(&error, "f", message, sizeof message);
    return status;
}

static imk_status read(const char *text)
{
    imk_parameter_settings settings = imk_parameter_default();
    return read_with(&settings, text);
}

static void check_says(const char *part)
{
    if (!strstr(message, part)) {
        print_error("said: %s\nexpected in it: %s\n", message, part);
        fail();
    }
}

static void check_note(bool lost, const char *part)
{
    for (size_t i = 0; i < notes.count; i++)
        if (notes.note[i].lost == lost && strstr(notes.note[i].text, part))
            return;
    for (size_t i = 0; i < notes.count; i++)
        print_error("note: %s\n", notes.note[i].text);
    print_error("expected one with: %s\n", part);
    fail();
}

static void check_axes(const imk_axes *axes, double x, double y, double z)
{
    const double expected[3] = {x, y, z};
    for (int i = 0; i < 3; i++)
        CHECK_RELATIVE(axes->value[i], expected[i], rounding);
}

/* A saved input of the fuzzer, which has every key of its format. */
static char *sample(const char *name)
{
    static char text[8192];
    char path[512];
    snprintf(path, sizeof path, "%s/fuzz/corpus/parameters/%s", SOURCE_DIRECTORY, name);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    return text;
}

static const struct sample {
    const char *file, *format;
    double rate;
} samples[] = {{"kalibr.yaml", "kalibr", 0},
               {"gazebo.sdf", "gazebo", 0},
               {"gazebo_old.sdf", "gazebo", 0},
               {"matlab.json", "matlab", 0},
               {"gnss_ins_sim.json", "gnss-ins-sim", 100},
               {"navego.m", "navego", 0},
               {"openvins.yaml", "openvins", 0},
               {"vins.yaml", "vins", 200},
               {"px4.params", "px4", 0},
               {"ardupilot.param", "ardupilot", 0}};
enum { SAMPLES = sizeof samples / sizeof samples[0] };

/* ---- recognition ----------------------------------------------------------------------------- */

static void test_names(void **state)
{
    (void)state;
    assert_null(imk_parameter_format_name(IMK_PARAMETERS_UNKNOWN));
    assert_null(imk_parameter_format_name((imk_parameter_format)99));
    for (int i = 1; i <= IMK_PARAMETERS_ARDUPILOT; i++)
        assert_int_equal(
            imk_parameter_format_find(imk_parameter_format_name((imk_parameter_format)i)), i);
    assert_int_equal(imk_parameter_format_find("klaibr"), IMK_PARAMETERS_UNKNOWN);
}

static void test_recognition(void **state)
{
    (void)state;
    char path[512];
    imk_parameter_format format;
    for (int i = 0; i < SAMPLES; i++) {
        snprintf(path, sizeof path, "%s/fuzz/corpus/parameters/%s", SOURCE_DIRECTORY,
                 samples[i].file);
        CHECK_OK(imk_parameter_format_detect(path, &format, NULL));
        assert_string_equal(imk_parameter_format_name(format), samples[i].format);
    }
    CHECK_OK(imk_parameter_format_detect("/nowhere/imu.yaml", &format, NULL));
    assert_int_equal(format, IMK_PARAMETERS_UNKNOWN);
    CHECK_STATUS(imk_parameter_format_detect("/", &format, NULL), IMK_ERROR_OPEN);
    CHECK_STATUS(read("imukit: 1\ngyro: {}\n"), IMK_ERROR_FORMAT);
    CHECK_STATUS(read("time [s],gyro_x [deg/s]\n0,1\n"), IMK_ERROR_FORMAT);
    check_says("(name the format with --from)");
    CHECK_STATUS(read(""), IMK_ERROR_FORMAT);
    imk_parameter_settings settings = {.cookie = 0};
    CHECK_STATUS(read_with(&settings, "gyr_n: 1"), IMK_ERROR_UNINITIALISED);
}

/* ---- conventions ----------------------------------------------------------------------------- */

static void check_kalibr_noise(void)
{
    check_axes(&model.gyro.noise.white, 2e-4, 2e-4, 2e-4);
    check_axes(&model.gyro.noise.random_walk, 3e-6, 3e-6, 3e-6);
    check_axes(&model.accel.noise.white, 4e-3, 4e-3, 4e-3);
    check_axes(&model.accel.noise.random_walk, 5e-5, 5e-5, 5e-5);
}

/* T of the model: (1 + s) e + A + X. */
static double response(const imk_triad *triad, int i, int j)
{
    return (1 + triad->scale_factor.fixed.value[i]) * triad->direction[i][j] +
           triad->misalignment.value[i][j] + triad->cross_axis.value[i][j];
}

/* gyroscopes: M C w + A C f, accelerometers: M f. C turns by acos(0.8) = 36.9 deg, so that the
 * axes become directions; the products are formed by hand. */
static void test_kalibr(void **state)
{
    (void)state;
    static const double gyro[3][3] = {
        {0.792, -0.594, 0},
        {0.003 * 0.8 + 1.01 * 0.6, -0.003 * 0.6 + 1.01 * 0.8, 0},
        {-0.002 * 0.8 + 0.004 * 0.6, 0.002 * 0.6 + 0.004 * 0.8, 1.02}};
    static const double accel[3][3] = {{1.001, 0, 0}, {0.002, 0.998, 0}, {0.01, -0.02, 1.003}};
    static const double g[3][3] = {{1e-4 * 0.8 + 2e-4 * 0.6, -1e-4 * 0.6 + 2e-4 * 0.8, 0},
                                   {-1e-4 * 0.6, -1e-4 * 0.8, 0},
                                   {3e-5 * 0.6, 3e-5 * 0.8, 2e-5}};
    CHECK_OK(read(sample("kalibr.yaml")));
    check_kalibr_noise();
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            CHECK_CLOSE(response(&model.gyro, i, j), gyro[i][j], rounding);
            CHECK_CLOSE(response(&model.accel, i, j), accel[i][j], rounding);
            CHECK_CLOSE(model.gyro.g_sensitivity.value[i][j], g[i][j], 1e-19);
        }
    CHECK_CLOSE(model.accel.lever_arm.value[1][2], -0.003, 0);
    CHECK_CLOSE(model.accel.lever_arm.value[2][0], 0.004, 0);
    check_note(true, "update_rate");
    check_note(false, "lever arms");
}

static void test_openvins(void **state)
{
    (void)state;
    CHECK_OK(read(sample("openvins.yaml")));
    check_kalibr_noise();
    /* Tw R: row 1 is 0.001 (0.8, -0.6) + 1.002 (0.6, 0.8); Tg acts on f in the axes of the IMU. */
    CHECK_CLOSE(response(&model.gyro, 0, 1), -1.001 * 0.6, rounding);
    CHECK_CLOSE(response(&model.gyro, 1, 0), 0.001 * 0.8 + 1.002 * 0.6, rounding);
    CHECK_CLOSE(response(&model.accel, 1, 0), 0.002, rounding);
    CHECK_CLOSE(response(&model.accel, 2, 2), 0.99, rounding);
    CHECK_CLOSE(model.gyro.g_sensitivity.value[0][2], 2e-4, 0);
}

static void test_gazebo(void **state)
{
    (void)state;
    CHECK_OK(read(sample("gazebo.sdf")));
    assert_string_equal(model.name, "unit");
    check_axes(&model.gyro.noise.white, 0.004 / 20, 0.002 / 20, 0); /* sqrt(400 Hz) = 20 */
    check_axes(&model.gyro.bias.fixed, 0.003, 0, 0);
    check_axes(&model.gyro.bias.repeatability, 1e-4, 0, 0);
    assert_int_equal(model.gyro.noise.gauss_markov_count, 1);
    check_axes(&model.gyro.noise.gauss_markov[0].sigma, 2e-5 * 5, 0, 0); /* sqrt(50/2) = 5 */
    check_axes(&model.gyro.noise.gauss_markov[0].correlation_time, 50, 0, 0);
    check_axes(&model.accel.resolution, 0.001, 0, 0);
    check_note(false, "draws the sign at random");
    CHECK_OK(read(sample("gazebo_old.sdf")));
    check_axes(&model.gyro.noise.white, 0.001, 0.001, 0.001);
    check_axes(&model.accel.bias.fixed, 0.1, 0.1, 0.1);
    check_axes(&model.accel.bias.repeatability, 0.02, 0.02, 0.02);
}

/* NoiseDensity 0.1 shows an Allan deviation of 0.0707 at one second: MATLAB's double-sided. */
static void test_matlab(void **state)
{
    (void)state;
    const double root = sqrt(0.5);
    CHECK_OK(read(sample("matlab.json")));
    assert_string_equal(model.name, "unit");
    check_axes(&model.gyro.noise.white, 0.1 * root, 0.1 * root, 0.1 * root);
    check_axes(&model.gyro.noise.random_walk, 0.001 / root, 0.001 / root, 0.001 / root);
    check_axes(&model.gyro.bias.fixed, 0.3, 0.5, 0);
    check_axes(&model.gyro.range, 4.36, 4.36, 4.36);
    check_axes(&model.accel.range, 0, 0, 0);
    check_axes(&model.gyro.resolution, 1e-4, 1e-4, 1e-4);
    check_axes(&model.accel.noise.bias_instability, 0.001, 0.001, 0.001);
    /* Three numbers are the off-diagonal elements of the columns, in percent. */
    CHECK_CLOSE(response(&model.gyro, 1, 0), 0.01, rounding);
    CHECK_CLOSE(response(&model.gyro, 2, 1), 0.02, rounding);
    CHECK_CLOSE(response(&model.gyro, 0, 2), 0.03, rounding);
    CHECK_CLOSE(response(&model.accel, 0, 2), 0.02, rounding);
    check_axes(&model.accel.scale_factor.fixed, 0, 0.99 - 1, 1.01 - 1);
    assert_int_equal(model.gyro.bias.temperature.order, 1);
    check_axes(&model.gyro.bias.temperature.coefficient[0], 0.03, 0.03, 0.03);
    CHECK_CLOSE(model.gyro.bias.temperature.reference, 298.15, 0);
    check_axes(&model.gyro.scale_factor.temperature.coefficient[0], 2e-4, 0, 5e-3);
    CHECK_CLOSE(model.gyro.g_sensitivity.value[2][2], 3e-4, 0);
    assert_true(model.mag.present);
    check_note(false, "one-sided");

    CHECK_OK(read("{\"Gyroscope\": {\"NoiseDensity\": 0.01, \"RandomWalk\": 0.001, "
                  "\"NoiseType\": \"single-sided\"}}"));
    check_axes(&model.gyro.noise.white, 0.01, 0.01, 0.01);
    check_axes(&model.gyro.noise.random_walk, 0.001, 0.001, 0.001);
    assert_false(model.accel.present);
    imk_parameter_settings settings = imk_parameter_default();
    settings.density = IMK_DENSITY_TWO_SIDED;
    CHECK_OK(read_with(&settings, "{\"Gyroscope\": {\"NoiseDensity\": 0.01}}"));
    check_axes(&model.gyro.noise.white, 0.01, 0.01, 0.01);
    CHECK_STATUS(read("{\"Gyroscope\": {\"NoiseType\": \"both\"}}"), IMK_ERROR_SYNTAX);
}

static void test_gnss_ins_sim(void **state)
{
    (void)state;
    imk_parameter_settings settings = imk_parameter_default();
    CHECK_STATUS(read(sample("gnss_ins_sim.json")), IMK_ERROR_KEY_MISSING);
    check_says("add --rate 100Hz (samples per second)");
    settings.rate = 100;
    CHECK_OK(read_with(&settings, sample("gnss_ins_sim.json")));
    check_axes(&model.gyro.bias.fixed, degree / 3600, 2 * degree / 3600, 3 * degree / 3600);
    check_axes(&model.gyro.noise.white, 0.25 * degree / 60, 0.25 * degree / 60, 0.5 * degree / 60);
    check_axes(&model.gyro.noise.gauss_markov[0].sigma, 3.5 * degree / 3600, 3.5 * degree / 3600,
               0);
    check_axes(&model.gyro.noise.gauss_markov[0].correlation_time, 100, 200, 0);
    check_axes(&model.accel.bias.fixed, 0.01, 0.01, 0.01);
    /* An infinite time: white noise of 5e-5 per sample at 100 Hz beside the density. */
    double white = hypot(0.03 / 60, 5e-5 / 10);
    check_axes(&model.accel.noise.white, white, white, hypot(0.06 / 60, 5e-5 / 10));
    assert_int_equal(model.accel.noise.gauss_markov_count, 0);
    check_note(true, "mag_std");
    CHECK_STATUS(read("gyro_b: 0\ngyro_arw: 1\n"), IMK_ERROR_KEY_MISSING);
    check_says("gyro_b_stability");
}

static void test_navego(void **state)
{
    (void)state;
    CHECK_OK(read(sample("navego.m")));
    assert_string_equal(model.name, "unit");
    check_axes(&model.gyro.noise.white, 2 * degree / 60, 2 * degree / 60, 2 * degree / 60);
    check_axes(&model.gyro.bias.fixed, 3 * degree, -2 * degree, 0.5 * degree);
    check_axes(&model.accel.bias.fixed, 0.490332499999999996, 0.490332499999999996,
               0.490332499999999996); /* 50 mg */
    check_axes(&model.gyro.noise.gauss_markov[0].sigma, 0.002 * degree, 0.002 * degree,
               0.002 * degree);
    /* Infinite time: 0.2 mg of white noise per sample at 100 Hz, besides vrw. */
    double extra = 0.2e-3 * 9.80665 / 10;
    check_axes(&model.accel.noise.white, hypot(0.1 / 60, extra), hypot(0.2 / 60, extra),
               hypot(0.3 / 60, extra));
    CHECK_STATUS(read("a.arw = 1;\nb.arw = 2;\n"), IMK_ERROR_KEY_MISSING);
    check_says("add --sensor NAME with one of a b");
    imk_parameter_settings settings = imk_parameter_default();
    settings.sensor = "b";
    CHECK_OK(read_with(&settings, "a.arw = 1;\nb.arw = 2;\n"));
    check_axes(&model.gyro.noise.white, 2 * degree / 60, 2 * degree / 60, 2 * degree / 60);
    CHECK_STATUS(read("% a\nimu.arw = ref.arw;\n"), IMK_ERROR_SYNTAX);
    check_says("f:2:");
    check_says("\"ref.arw\" cannot be read; expected one number or three");
}

/* Values of single expressions, through one field [deg/s]. */
static void test_expressions(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double value[3];
    } good[] = {{"[3 -2 1]", {3, -2, 1}},
                {"[3 - 2, 1 + 1, -1]", {1, 2, -1}},
                {"2 .* ones(1,3) + [1 2 3]", {3, 4, 5}},
                {"-(1 + 2) * 2 / 4", {-1.5, -1.5, -1.5}},
                {"sqrt(16) ./ 2", {2, 2, 2}},
                {"pi", {3.14159265358979323846, 3.14159265358979323846, 3.14159265358979323846}},
                {"[1 2 3]' ", {1, 2, 3}},
                {"zeros( 1 , 3 ) ", {0, 0, 0}},
                {"k*[1 2 4]", {0.5, 1, 2}}};
    static const char *const bad[] = {"",        "[1 2]",   "[1 2 3",  "ones(2,3)", "x",
                                      "1 2",     "(1",      "1 +",     "[1 2 3 4]", "load('a')",
                                      "1e999*0", "ones(1)", "sqrt(-1)"};
    char line[200];
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        snprintf(line, sizeof line, "k = 0.5;\nu.gb_sta = %s; %% text\n", good[i].text);
        CHECK_OK(read(line));
        check_axes(&model.gyro.bias.fixed, good[i].value[0] * degree, good[i].value[1] * degree,
                   good[i].value[2] * degree);
    }
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        snprintf(line, sizeof line, "u.gb_sta = %s;\n", bad[i]);
        imk_status status = read(line);
        assert_true(status == IMK_ERROR_SYNTAX || status == IMK_ERROR_NOT_FINITE);
    }
}

static void test_vins(void **state)
{
    (void)state;
    imk_parameter_settings settings = imk_parameter_default();
    CHECK_STATUS(read(sample("vins.yaml")), IMK_ERROR_KEY_MISSING);
    check_says("add --rate RATE");
    check_says("--density two-sided");
    settings.rate = 400;
    CHECK_OK(read_with(&settings, sample("vins.yaml")));
    check_axes(&model.gyro.noise.white, 0.01 / 20, 0.01 / 20, 0.01 / 20);
    check_axes(&model.accel.noise.random_walk, 0.001 / 20, 0.001 / 20, 0.001 / 20);
    check_note(true, "2 other keys");
    settings.density = IMK_DENSITY_ONE_SIDED;
    CHECK_STATUS(read_with(&settings, sample("vins.yaml")), IMK_ERROR_CONFLICT);
    settings.rate = 0;
    CHECK_OK(read_with(&settings, sample("vins.yaml")));
    check_axes(&model.accel.noise.white, 0.1 * sqrt(0.5), 0.1 * sqrt(0.5), 0.1 * sqrt(0.5));
    CHECK_STATUS(read_with(&settings, sample("kalibr.yaml")), IMK_ERROR_CONFLICT);
    check_says("two-sided");
}

/* corrected = (reading - thermal - offset) scale; thermal parameters are found by the device's ID,
 * here in the other slot. */
static void test_px4(void **state)
{
    (void)state;
    CHECK_OK(read(sample("px4.params")));
    check_axes(&model.accel.bias.fixed, 0.12 + 0.05, 0, 0);
    check_axes(&model.accel.scale_factor.fixed, 0.8 - 1, 0, 0);
    const imk_temperature_polynomial *t = &model.accel.bias.temperature;
    assert_int_equal(t->order, 3);
    check_axes(&t->coefficient[0], 0.003, 0, 0);
    check_axes(&t->coefficient[2], 0, -1e-5, 0);
    CHECK_CLOSE(t->reference, 293.15, 1e-12);
    CHECK_CLOSE(t->minimum, 263.15, 1e-12);
    CHECK_CLOSE(t->maximum, 333.15, 1e-12);
    check_axes(&model.gyro.bias.fixed, 0, 0, -0.01);
    CHECK_OK(read("TC_G_ENABLE 0\nTC_G0_X1_0 1e-4\nCAL_GYRO0_XOFF 0.5\n"));
    assert_int_equal(model.gyro.bias.temperature.order, 0);
    check_note(true, "TC_G_ENABLE is 0");
    CHECK_STATUS(read("CAL_GYRO0_XOFF 0.5\nCAL_GYRO1_XOFF 0.1\n"), IMK_ERROR_KEY_MISSING);
    check_says("add --sensor NUMBER with one of 0, 1");
    CHECK_STATUS(read("CAL_GYRO0_XOFF abc\n"), IMK_ERROR_SYNTAX);
    check_says("f:1:16: CAL_GYRO0_XOFF: \"abc\" cannot be read; expected a finite number");
}

/* ---- values that cannot be ------------------------------------------------------------------- */

static const struct refusal {
    const char *text;
    imk_status status;
    const char *says;
} refusals[] = {
    {"gyroscope_noise_density: 0.3\n", IMK_ERROR_RANGE,
     "f:1:26: gyroscope_noise_density: \"0.3\" cannot be in rad/s/sqrt(Hz), it looks like "
     "deg/sqrt(h); this format uses rad/s/sqrt(Hz): write 8.72665e-05, or correct the value"},
    {"accelerometer_noise_density: 60\n", IMK_ERROR_RANGE, "looks like ug/sqrt(Hz)"},
    {"gyroscope_noise_density: -1e-4\n", IMK_ERROR_RANGE, "a number that is not negative"},
    {"gyroscope_noise_density: 1e-4 rad\n", IMK_ERROR_SYNTAX, "a number without a unit"},
    {"gyroscope_noise_density: nan\n", IMK_ERROR_NOT_FINITE, "a finite number"},
    {"gyroscope_noise_density: 1e-4\ngyroscope_random_wlk: 1e-5\n", IMK_ERROR_KEY_UNKNOWN,
     "did you mean \"gyroscope_random_walk\"?"},
    {"gyroscope_noise_density: 1e-4\ngyroscope_noise_density: 1e-5\n", IMK_ERROR_KEY_DUPLICATE,
     "line 1"},
    {"gyroscopes: {M: [[1, 0], [0, 1]]}\n", IMK_ERROR_SYNTAX, "a list of three rows"},
    {"gyroscopes: {M: [[0, 0, 0], [0, 1, 0], [0, 0, 1]]}\n", IMK_ERROR_RANGE,
     "a matrix near a rotation"},
    {"imu0: {gyroscope_noise_density: 1e-4}\nimu1: {gyroscope_noise_density: 2e-4}\n",
     IMK_ERROR_KEY_MISSING, "add --sensor NAME with one of imu0, imu1"},
    {"{\"Gyroscope\": {\"ConstantBias\": 100}}", IMK_ERROR_RANGE, "looks like deg/h"},
    {"{\"a\": {\"Gyroscope\": {}}, \"b\": {\"Gyroscope\": {}}}", IMK_ERROR_KEY_MISSING,
     "add --sensor NAME with one of a, b"},
    {"u.ab_sta = 5e4;\n", IMK_ERROR_RANGE, "it looks like ug"},
    {"<sdf><sensor name='a' type='imu'><imu></sensor></sdf>", IMK_ERROR_SYNTAX, "mismatched tag"},
    {"<!DOCTYPE a [<!ENTITY b 'c'>]><sensor name='a' type='imu'><imu/></sensor>",
     IMK_ERROR_UNSUPPORTED, "SDF has none"},
    {"<sensor name='a' type='imu'><imu><angular_velocity><x><noise><stddev>1e-3</stddev>\n"
     "</noise></x></angular_velocity></imu></sensor>",
     IMK_ERROR_KEY_MISSING,
     "f:1:74: stddev: \"stddev\" is per sample, and update_rate is missing; "
     "add --rate RATE (samples per second, as 200Hz)"},
    {"<sensor name='a' type='imu'><imu><angular_velocity><x><noise><stddev>${s}</stddev></noise>"
     "</x></angular_velocity></imu></sensor>",
     IMK_ERROR_SYNTAX, "expand the macros first"},
    {"<sensor name='a' type='imu'><imu/></sensor><sensor name='b' type='imu'/>", IMK_ERROR_SYNTAX,
     "junk after document element"},
    {"CAL_ACC0_XSCALE 0\n", IMK_ERROR_RANGE, "a scale between 0.1 and 3"},
    {"CAL_ACC0_XOFF 50\n", IMK_ERROR_RANGE, "it looks like mg"},
    {"TC_A_ENABLE 1\nTC_A0_X1_0 0.1\nTC_A0_TMIN 50\nTC_A0_TMAX 10\n", IMK_ERROR_RANGE,
     "a TMIN above absolute zero and below TMAX"},
};

static void test_refusals(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof refusals / sizeof refusals[0]; i++) {
        memset(&model, 0x5A, sizeof model);
        imk_model before = model;
        CHECK_STATUS(read(refusals[i].text), refusals[i].status);
        check_says(refusals[i].says);
        assert_memory_equal(&model, &before, sizeof model);
    }
}

/* The inflated figures of filter settings are no mistake of the unit. */
static void test_plausible(void **state)
{
    (void)state;
    CHECK_OK(read("gyroscope_noise_density: 0.02\naccelerometer_noise_density: 0.4\n"));
    CHECK_OK(read("gyroscope_noise_density: 2.9e-8\naccelerometer_noise_density: 1e-6\n"));
    CHECK_OK(read("gyroscope_noise_density: 1e-4\nsomething_else: 1\n"));
    check_note(true, "something_else");
}

/* ---- writing --------------------------------------------------------------------------------- */

static bool same(const imk_axes *a, const imk_axes *b)
{
    for (int i = 0; i < 3; i++)
        if (!(fabs(a->value[i] - b->value[i]) <= 1e-12 * fabs(a->value[i])))
            return false;
    return true;
}

static void check_same_triad(const imk_triad *a, const imk_triad *b)
{
    assert_int_equal(a->present, b->present);
    assert_true(same(&a->noise.white, &b->noise.white));
    assert_true(same(&a->noise.random_walk, &b->noise.random_walk));
    assert_true(same(&a->noise.bias_instability, &b->noise.bias_instability));
    assert_true(same(&a->bias.fixed, &b->bias.fixed));
    assert_true(same(&a->bias.repeatability, &b->bias.repeatability));
    assert_true(same(&a->range, &b->range));
    assert_true(same(&a->resolution, &b->resolution));
    assert_int_equal(a->noise.gauss_markov_count, b->noise.gauss_markov_count);
    assert_true(same(&a->noise.gauss_markov[0].sigma, &b->noise.gauss_markov[0].sigma));
    assert_int_equal(a->bias.temperature.order, b->bias.temperature.order);
    for (int i = 0; i < a->bias.temperature.order; i++)
        assert_true(same(&a->bias.temperature.coefficient[i], &b->bias.temperature.coefficient[i]));
    for (int i = 0; i < 9; i++) {
        CHECK_CLOSE(response(a, i / 3, i % 3), response(b, i / 3, i % 3), 1e-14);
        CHECK_CLOSE(a->g_sensitivity.value[i / 3][i % 3], b->g_sensitivity.value[i / 3][i % 3],
                    1e-18);
        CHECK_CLOSE(a->lever_arm.value[i / 3][i % 3], b->lever_arm.value[i / 3][i % 3], 0);
    }
}

/* Reading, writing and reading a file of the same format is the identity on what it holds, and
 * nothing is noted as lost of the model. */
static void test_round_trip(void **state)
{
    (void)state;
    for (int i = 0; i < SAMPLES; i++) {
        imk_parameter_settings settings = imk_parameter_default();
        settings.rate = samples[i].rate;
        CHECK_OK(read_with(&settings, sample(samples[i].file)));
        imk_model first = model;
        settings.format = imk_parameter_format_find(samples[i].format);
        if (settings.format == IMK_PARAMETERS_GAZEBO)
            settings.rate = 400;
        char *text = NULL;
        size_t size;
        CHECK_OK(imk_parameters_print("a.json", &settings, &first, &text, &size, &notes, NULL));
        for (size_t k = 0; k < notes.count; k++)
            assert_null(strstr(notes.note[k].text, "held"));
        CHECK_OK(read_with(&settings, text));
        free(text);
        check_same_triad(&first.gyro, &model.gyro);
        check_same_triad(&first.accel, &model.accel);
    }
}

/* What a format cannot hold is named; nothing that fits is refused. */
static void test_lost(void **state)
{
    (void)state;
    imk_parameter_settings settings = imk_parameter_default();
    imk_model full;
    imk_model_default(&full);
    char *text = NULL;
    size_t size;
    full.gyro.noise.white = (imk_axes){.value = {1e-4, 2e-4, 1e-4}};
    full.gyro.noise.bias_instability = (imk_axes){.value = {1e-5, 1e-5, 1e-5}};
    full.gyro.noise.random_walk = (imk_axes){.value = {1e-6, 1e-6, 1e-6}};
    full.gyro.bias.fixed = (imk_axes){.value = {1e-3, 0, 0}, .sigma = {1e-4}};
    full.gyro.misalignment.value[0][1] = 1e-3;
    full.gyro.cross_axis.value[0][1] = 2e-3;
    full.timing.jitter.value = 1e-6;
    settings.format = IMK_PARAMETERS_KALIBR;
    CHECK_OK(imk_parameters_print(NULL, &settings, &full, &text, &size, &notes, NULL));
    check_note(true, "gyro.noise.bias_instability is not held");
    check_note(true, "gyro.bias.fixed is not held");
    check_note(true, "gyroscope_noise_density is one number for all axes");
    check_note(true, "timing.jitter is not held");
    check_note(true, "uncertainties");
    check_note(false, "their sum");
    check_note(true, "kalibr needs update_rate");
    CHECK_OK(read(text));
    check_axes(&model.gyro.noise.white, 2e-4, 2e-4, 2e-4);
    CHECK_CLOSE(response(&model.gyro, 0, 1), 3e-3, rounding);
    free(text);

    imk_error error;
    imk_model nothing;
    imk_model_default(&nothing);
    nothing.gyro.noise.ramp.value[0] = 1e-9;
    CHECK_STATUS(imk_parameters_print(NULL, &settings, &nothing, &text, &size, NULL, &error),
                 IMK_ERROR_UNSUPPORTED);
    settings.format = IMK_PARAMETERS_GAZEBO;
    CHECK_STATUS(imk_parameters_print(NULL, &settings, &full, &text, &size, NULL, &error),
                 IMK_ERROR_KEY_MISSING);
    assert_string_equal(error.expected, "add --rate RATE (samples per second, as 200Hz)");
    full.accel.axis_count = 2;
    CHECK_STATUS(imk_parameters_print(NULL, &settings, &full, &text, &size, NULL, &error),
                 IMK_ERROR_UNSUPPORTED);
    settings.format = IMK_PARAMETERS_UNKNOWN;
    CHECK_STATUS(imk_parameters_print(NULL, &settings, &nothing, &text, &size, NULL, &error),
                 IMK_ERROR_ARGUMENT);
}

/* Any valid model is written or refused, and what is written reads back; a field that does not
 * come back is in the notes, or the notes are full. */
static void test_random_models(void **state)
{
    (void)state;
    uint64_t seed = 20261121;
    int written = 0;
    for (int i = 0; i < 60; i++) {
        imk_model random = random_model(&seed, 4, false);
        for (int format = 1; format <= IMK_PARAMETERS_FUSION; format++) {
            imk_parameter_settings settings = imk_parameter_default();
            settings.format = (imk_parameter_format)format;
            settings.rate = 200;
            settings.frame_rate = 10;
            char *text = NULL;
            size_t size;
            imk_error error;
            imk_status status =
                imk_parameters_print(NULL, &settings, &random, &text, &size, &notes, &error);
            if (status != IMK_OK) {
                /* White noise without a walk, for a program that needs one. */
                assert_true(status == IMK_ERROR_UNSUPPORTED || status == IMK_ERROR_RANGE ||
                            (status == IMK_ERROR_KEY_MISSING && strstr(error.found, "(K)")));
                continue;
            }
            written++;
            bool dropped = random.gyro.present && random.gyro.noise.ramp.value[0] != 0;
            if (dropped && notes.count < IMK_PARAMETER_NOTES_MAX)
                check_note(true, "gyro.noise.rate_ramp is not held");
            CHECK_OK(read_with(&settings, text));
            free(text);
        }
    }
    assert_true(written > 60);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_names),        cmocka_unit_test(test_recognition),
        cmocka_unit_test(test_kalibr),       cmocka_unit_test(test_openvins),
        cmocka_unit_test(test_gazebo),       cmocka_unit_test(test_matlab),
        cmocka_unit_test(test_gnss_ins_sim), cmocka_unit_test(test_navego),
        cmocka_unit_test(test_expressions),  cmocka_unit_test(test_vins),
        cmocka_unit_test(test_px4),          cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_plausible),    cmocka_unit_test(test_round_trip),
        cmocka_unit_test(test_lost),         cmocka_unit_test(test_random_models),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
