/* SPDX-License-Identifier: Apache-2.0 */
/* The figures of the catalogue against independent conversions: by hand from the numbers and units
 * the sources print, and from the survey in ../shared/data/devices.csv, row by row. */
#include "check.h"

#include "imukit/model.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;
static const double g = 9.80665; /* [m/s^2], by definition */

static imk_model model_of(const char *name)
{
    imk_model model;
    const imk_device *device = imk_device_find(name);
    if (!device)
        fail_msg("%s is not in the catalogue", name);
    imk_device_model(device, &model);
    return model;
}

/* Densities per root hertz, of the gyro in deg/s or rad/s, of the accelerometer in ug or m/s^2, as
 * printed; the catalogue holds them with four digits, in per root hour. */
static void densities_become_random_walks(void **state)
{
    (void)state;
    const double degree = pi / 180, ug = 1e-6 * g;
    const struct {
        const char *name;
        double gyro, accel; /* 0: not compared */
    } printed[] = {
        {"ADIS16448 EuRoC", 1.6968e-4, 2e-3},
        {"ADIS16448 RotorS", 2 * 1.6968e-4, 4e-3},
        {"MPU-6000", 0.005 * degree / sqrt(2), 400 * ug / sqrt(2)},
        {"BMI088", 0.014 * degree / sqrt(2), 0}, /* of data sheets: one-sided */
        {"BMI160", 0.008 * degree / sqrt(2), 180 * ug / sqrt(2)},
        {"BMI270", 0.007 * degree / sqrt(2), 160 * ug / sqrt(2)},
        {"ICM-20948", 0.015 * degree / sqrt(2), 230 * ug / sqrt(2)},
        {"ICM-42688-P", 0.0028 * degree / sqrt(2), 0},
        {"MPU-6050", 0.005 * degree / sqrt(2), 400 * ug / sqrt(2)},
        {"MPU-9250", 0.01 * degree / sqrt(2), 300 * ug / sqrt(2)},
        {"LSM6DSO", 3.8e-3 * degree / sqrt(2), 70 * ug / sqrt(2)},
        {"ISM330DHCX", 0, 60 * ug / sqrt(2)},
        {"ADIS16470", 0, 100 * ug / sqrt(2)},
        {"Xsens MTi-3", 0.007 * degree, 120 * ug},
        {"MicroStrain MV5-AR", 0.0075 * degree, 85 * ug},
        {"Xsens MTi-G-700", 0.01 * degree, 60 * ug},
        {"CH Robotics UM7", 0.005 * degree, 400 * ug},
        {"Xsens MTi-100", 1.7453e-4, 0},
        {"RealSense D435i", 1.5198973532e-4, 6.308226052e-3},
        {"Xsens MTi-630", 0.007 * degree, 60 * ug},
        {"Xsens MTi-1", 0.007 * degree, 120 * ug},
        {"NovAtel SPAN", 1.75e-5, 1e-3},
        {"NovAtel SPAN measured", 3.98e-5, 1.76e-3},
        {"VN-100", 6.10866e-5, 140 * ug},
        {"Groves consumer", 0, 1000 * ug},
        {"Groves tactical", 0, 100 * ug},
        {"Groves aviation", 0, 20 * ug},
        {"HG1700", 0, 0.065 * 0.3048 / 60}, /* ft/s/sqrt(h) */
        {"HG1125CA01", 0, 0.18 * 0.3048 / 60},
    };
    for (size_t i = 0; i < sizeof printed / sizeof printed[0]; i++) {
        const imk_model model = model_of(printed[i].name);
        for (int axis = 0; axis < 3; axis++) {
            if (printed[i].gyro > 0)
                CHECK_RELATIVE(model.gyro.noise.white.value[axis], printed[i].gyro, 6e-4);
            if (printed[i].accel > 0)
                CHECK_RELATIVE(model.accel.noise.white.value[axis], printed[i].accel, 6e-4);
        }
    }
}

/* Instabilities and random walks of some sources, in the units printed there: floors of the Allan
 * deviation are sqrt(2 ln 2/pi) B. */
static void instabilities_become_b(void **state)
{
    (void)state;
    const double per_floor = 1 / sqrt(2 * log(2) / pi);
    const double degree = pi / 180;
    imk_model model = model_of("ADIS16405");
    CHECK_RELATIVE(model.gyro.noise.bias_instability.value[0], 0.007 * degree * per_floor, 1e-12);
    CHECK_RELATIVE(model.gyro.bias.repeatability.value[1], 3 * degree, 1e-12);
    CHECK_RELATIVE(model.accel.bias.repeatability.value[2], 0.050 * g, 1e-12);
    model = model_of("ADIS16488");
    CHECK_RELATIVE(model.gyro.bias.repeatability.value[0], 0.2 * degree, 1e-12);
    CHECK_RELATIVE(model.accel.bias.repeatability.value[0], 0.016 * g, 1e-12);
    model = model_of("AHRS380SA");
    CHECK_RELATIVE(model.accel.noise.bias_instability.value[0], 2e-4 * per_floor, 6e-4);
    model = model_of("IMU381");
    CHECK_RELATIVE(model.accel.noise.bias_instability.value[0], 5e-5 * per_floor, 6e-4);
    model = model_of("ADIS16448 EuRoC");
    CHECK_RELATIVE(model.gyro.noise.random_walk.value[0], 1.9393e-5, 6e-4);
    model = model_of("ADIS16448 RotorS");
    CHECK_RELATIVE(model.gyro.bias.repeatability.value[0], 0.0087, 1e-9);
    CHECK_RELATIVE(model.accel.bias.repeatability.value[0], 0.196, 1e-9);
    model = model_of("RealSense D435i"); /* means of the three axes printed */
    CHECK_RELATIVE(model.gyro.noise.bias_instability.value[0],
                   (1.76568 + 4.88153 + 3.15431) / 3 * degree / 3600 * per_floor, 6e-4);
    CHECK_RELATIVE(model.gyro.noise.random_walk.value[0], 2.664506559e-6, 5e-3); /* 2 digits */
    CHECK_RELATIVE(model.accel.noise.random_walk.value[0], 1.167372353e-4, 6e-4);
    model = model_of("NovAtel SPAN");
    CHECK_RELATIVE(model.gyro.noise.bias_instability.value[0], 2.18e-6 * per_floor, 6e-4);
    CHECK_RELATIVE(model.accel.noise.bias_instability.value[0], 7.35e-4 * per_floor, 6e-4);
    model = model_of("NovAtel SPAN measured");
    CHECK_RELATIVE(model.gyro.noise.bias_instability.value[0], 6.98e-7, 6e-4);
    CHECK_RELATIVE(model.gyro.noise.random_walk.value[0], 1.71e-7, 6e-4);
    model = model_of("Leador-A15");
    CHECK_RELATIVE(model.accel.bias.repeatability.value[0], 15e-5, 6e-4); /* 15 mGal */
    model = model_of("ASTRIX 200");
    CHECK_RELATIVE(model.gyro.bias.repeatability.value[0], 0.0005 / 3 * degree / 3600, 1e-9);
    model = model_of("Hipnuc CH104");
    CHECK_RELATIVE(model.gyro.resolution.value[0], 0.01 * degree, 1e-12);
    CHECK_RELATIVE(model.accel.resolution.value[0], 1e-3 * g, 1e-12);
}

/* ---- the survey -------------------------------------------------------------------------------
 */

enum {
    NAME,
    CLASS,
    ARW,
    GYRO_BI,
    RRW,
    GYRO_RANGE,
    VRW,
    ACCEL_BI,
    ACCEL_RANGE,
    KIND = 11,
    NOTE,
    COLUMNS
};

/* One line into fields, quotes removed, in place. */
static int split(char *line, char *field[COLUMNS])
{
    int count = 0;
    bool quoted = false;
    char *out = line;
    field[count++] = out;
    for (const char *in = line; *in && *in != '\n' && *in != '\r'; in++) {
        if (*in == '"' && quoted && in[1] == '"')
            *out++ = *in++;
        else if (*in == '"')
            quoted = !quoted;
        else if (*in == ',' && !quoted && count < COLUMNS) {
            *out++ = '\0';
            field[count++] = out;
        } else
            *out++ = *in;
    }
    *out = '\0';
    return count;
}

/* Figures of the survey that the notes of the catalogue explain: left out, or known for something
 * else. */
typedef enum treatment {
    AS_SURVEYED,
    LEFT_OUT,
    IS_REPEATABILITY,
    REPLACED, /* by something smaller */
    CORRECTED /* by another source */
} treatment;
static const struct {
    const char *name;
    int column;
    treatment treatment;
} exceptions[] = {
    {"ADIS16405 measured", VRW, REPLACED},
    {"Leador-A15", GYRO_BI, IS_REPEATABILITY},
    {"Leador-A15", ACCEL_BI, IS_REPEATABILITY},
    {"HG9900-like", GYRO_BI, LEFT_OUT},
    {"HG9900-like", VRW, LEFT_OUT},
    {"HG1700", GYRO_BI, IS_REPEATABILITY},
    {"HG1700", ACCEL_BI, IS_REPEATABILITY},
    {"HG9900", GYRO_BI, IS_REPEATABILITY},
    {"HG9900", ACCEL_BI, IS_REPEATABILITY},
    {"Sagem Primus 200", GYRO_BI, IS_REPEATABILITY},
    {"Sagem Primus 200", VRW, LEFT_OUT},
    {"Sagem Primus 200", ACCEL_BI, IS_REPEATABILITY},
    {"STIM300 measured", ARW, LEFT_OUT},
    {"MPU-6000", ARW, CORRECTED}, /* the survey has a thesis's, the catalogue the data sheet's */
    {"MPU-6000", VRW, CORRECTED},
    {"Xsens MTi-100", RRW, LEFT_OUT},
    {"Xsens MTi-100", VRW, LEFT_OUT},
    {"SBG IG-500N", ARW, LEFT_OUT},
    {"SBG IG-500N", VRW, LEFT_OUT},
    {"VN-100", GYRO_BI, CORRECTED}, /* the survey has none */
    {"VN-100", ACCEL_BI, CORRECTED},
    {"ASTRIX 200", GYRO_BI, IS_REPEATABILITY},
};

static treatment treatment_of(const char *name, int column)
{
    for (size_t i = 0; i < sizeof exceptions / sizeof exceptions[0]; i++)
        if (strcmp(exceptions[i].name, name) == 0 && exceptions[i].column == column)
            return exceptions[i].treatment;
    return AS_SURVEYED;
}

static bool is_gyro(int column)
{
    return column < VRW;
}

/* What a model states for a column, in the column's unit. */
static double figure_of(const imk_model *model, int column, bool repeatability)
{
    const imk_triad *triad = is_gyro(column) ? &model->gyro : &model->accel;
    const double unit = is_gyro(column) ? pi / 180 / 3600 : 1e-6 * g; /* deg/h, ug */
    switch (column) {
    case ARW:
        return triad->noise.white.value[1] / (pi / 180 / 60);
    case VRW:
        return triad->noise.white.value[1] * 60;
    case RRW:
        return triad->noise.random_walk.value[1] / unit * 60;
    case GYRO_RANGE:
        return triad->range.value[1] / (pi / 180);
    case ACCEL_RANGE:
        return triad->range.value[1] / g;
    default:
        return (repeatability ? triad->bias.repeatability : triad->noise.bias_instability)
                   .value[1] /
               unit;
    }
}

/* The survey's instability is B where it was measured, unless its note says that it is the plain
 * minimum; data sheets state the minimum. */
static bool is_floor(char *const field[COLUMNS])
{
    return strcmp(field[KIND], "datasheet") == 0 || strstr(field[NOTE], "plain minimum") ||
           strstr(field[NOTE], "Allan minimum") || strstr(field[NOTE], "not divided by");
}

/* Returns whether the figure was compared with the survey. */
static bool check_figure(const imk_device *device, const imk_model *model,
                         char *const field[COLUMNS], int column)
{
    const treatment how = treatment_of(device->name, column);
    const bool repeatability = how == IS_REPEATABILITY;
    const double figure = figure_of(model, column, repeatability);
    double surveyed = strtod(field[column], NULL);
    const bool instability = column == GYRO_BI || column == ACCEL_BI;
    if (instability && !repeatability && is_floor(field))
        surveyed /= sqrt(2 * log(2) / pi);
    bool good = how == LEFT_OUT    ? figure == 0
                : how == REPLACED  ? figure > 0 && figure < surveyed
                : how == CORRECTED ? figure > 0 && figure != surveyed
                                   : fabs(figure - surveyed) <= 3e-4 * surveyed; /* four digits */
    if (repeatability) /* and not told twice */
        good = good && figure_of(model, column, false) == 0;
    if (!good)
        fail_msg("%s, column %d: %.9g in the catalogue, %.9g in the survey", device->name, column,
                 figure, surveyed);
    return how != LEFT_OUT && surveyed > 0;
}

/* Rows of the survey and entries behind the presets have the same order; parts by their data sheets
 * follow. */
static void every_row_of_the_survey_is_there(void **state)
{
    (void)state;
    FILE *file = fopen(SHARED_DIRECTORY "/data/devices.csv", "r");
    if (!file) {
        print_message("%s is absent: skipped\n", SHARED_DIRECTORY "/data/devices.csv");
        skip();
    }
    char line[2048], *field[COLUMNS];
    size_t row = 0, compared = 0;
    assert_non_null(fgets(line, sizeof line, file));
    for (; fgets(line, sizeof line, file); row++) {
        assert_int_equal(split(line, field), COLUMNS);
        const imk_device *device = imk_device_get(5 + row);
        assert_non_null(device);
        assert_false(device->is_preset);
        assert_int_equal(strncmp(device->grade, field[CLASS], strlen(device->grade)), 0);
        imk_model model;
        imk_device_model(device, &model);
        for (int column = ARW; column <= ACCEL_RANGE; column++)
            compared += check_figure(device, &model, field, column);
    }
    fclose(file);
    assert_string_equal(imk_device_get(5 + row)->name, "BMI088");
    assert_true(row >= 40 && compared >= 160);
    print_message("%zu rows, %zu figures compared\n", row, compared);
}

/* Data sheets that state a density and, beside it, the rms noise in a bandwidth or a random walk:
 * both agree when the density is one-sided, to the digits printed. A two-sided one would be 41 %
 * off.
 */
static void densities_of_data_sheets_are_one_sided(void **state)
{
    (void)state;
    static const struct {
        double density, bandwidth, rms; /* [deg/s/sqrt(Hz), Hz, deg/s] */
        double digit;                   /* half of the last digit of the rms, relative */
    } printed[] = {
        {0.014, 47, 0.1, 0.5},      /* BMI088, table 5 */
        {0.0028, 100, 0.028, 0.02}, /* ICM-42688-P, table 1 */
        {0.005, 100, 0.05, 0.1},    /* MPU-6050, 6.1 */
    };
    for (size_t i = 0; i < sizeof printed / sizeof printed[0]; i++)
        CHECK_RELATIVE(printed[i].density * sqrt(printed[i].bandwidth), printed[i].rms,
                       printed[i].digit);
    CHECK_RELATIVE(0.005 * 60 / sqrt(2), 0.21, 0.024); /* ISM330DHCX, table 2: deg/sqrt(h) */
    CHECK_RELATIVE(0.008 * 60 / sqrt(2), 0.34, 0.015); /* ADIS16470, table 1 */
    const imk_model bmi = model_of("BMI088");
    CHECK_RELATIVE(bmi.accel.noise.white.value[1], 160e-6 * g / sqrt(2), 6e-4);
    CHECK_RELATIVE(bmi.accel.noise.white.value[2], 190e-6 * g / sqrt(2), 6e-4);
    CHECK_RELATIVE(bmi.gyro.bias.repeatability.value[0], pi / 180, 1e-12); /* 1 deg/s */
    CHECK_RELATIVE(bmi.accel.bias.repeatability.value[0], 0.02 * g, 1e-12);
    const imk_model icm = model_of("ICM-42688-P");
    CHECK_RELATIVE(icm.accel.noise.white.value[0], 65e-6 * g / sqrt(2), 6e-4);
    CHECK_RELATIVE(icm.accel.noise.white.value[2], 70e-6 * g / sqrt(2), 6e-4);
}

/* No sensor is simulated without errors because its source states none. */
static void what_is_present_states_something(void **state)
{
    (void)state;
    for (size_t i = 0; i < imk_device_count(); i++) {
        const imk_device *device = imk_device_get(i);
        imk_model model;
        imk_device_model(device, &model);
        const imk_triad *triads[2] = {&model.gyro, &model.accel};
        for (int k = 0; k < 2; k++)
            if (triads[k]->present && !(triads[k]->noise.white.value[0] > 0 ||
                                        triads[k]->noise.bias_instability.value[0] > 0 ||
                                        triads[k]->bias.repeatability.value[0] > 0))
                fail_msg("%s states nothing of its %s", device->name,
                         k ? "accelerometers" : "gyros");
        if (!model.accel.present) /* and the note says so */
            assert_true(strstr(device->note, "Gyros only") || strstr(device->note, "eft out"));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(densities_become_random_walks),
        cmocka_unit_test(instabilities_become_b),
        cmocka_unit_test(every_row_of_the_survey_is_there),
        cmocka_unit_test(densities_of_data_sheets_are_one_sided),
        cmocka_unit_test(what_is_present_states_something),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
