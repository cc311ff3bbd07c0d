/* SPDX-License-Identifier: Apache-2.0 */
/* imukit calibrate with logs whose rows, references or temperatures are not what they seem: each is
 * a doubt, and the sound log is none. */
#include "cli/run_command.h"

#define PLACE " --position '48.1 deg, 11.6 deg, 520 m'"
#define START "imukit_motion: 1\nstart: {latitude: 48.1 deg, longitude: 11.6 deg, height: 520 m}\n"

/* A log and the forces and rates of its motion beside it, in one file of 17 columns. */
#define WITH_REFERENCE                                                                             \
    "awk -F, -v OFS=, 'FNR == NR {for (i = 0; i < 3; i++) {w[FNR, i] = $(12 + i); f[FNR, i] = "    \
    "$(15 + i)} next} FNR == 1 {print $0, \"reference_rate_x [deg/s],reference_rate_y "            \
    "[deg/s],reference_rate_z [deg/s],reference_force_x [m/s^2],reference_force_y "                \
    "[m/s^2],reference_force_z [m/s^2]\"; next} {print $0, w[FNR, 0], w[FNR, 1], w[FNR, 2], "      \
    "f[FNR, 0], f[FNR, 1], f[FNR, 2]}' truth.csv "

static void check_doubt(const char *line, const char *message)
{
    run(line);
    check_contains(err, message, line);
    assert_null(strstr(out, "Usable:"));
}

static void check_sound(const char *line)
{
    if (run(line) != 0)
        fail_msg("%s\n%s%s", line, out, err);
    check_contains(out, "Usable:", line);
}

/* A table that turns the unit in three attitudes, and rests in six. */
static void write_table(void)
{
    put("table.yaml", START
        "steps:\n  - hold 5 s\n"
        "  - repeat: {times: 2, steps: [rotate z at 40 deg/s for 4 s, rotate z at -40 deg/s for 4 "
        "s, rotate z at 90 deg/s for 4 s, rotate z at -90 deg/s for 4 s, hold 3 s]}\n"
        "  - pose 0 90 0 deg in 4 s\n  - hold 3 s\n"
        "  - rotate x at 60 deg/s for 5 s\n  - rotate x at -60 deg/s for 5 s\n  - hold 3 s\n"
        "  - pose 90 0 0 deg in 4 s\n  - hold 3 s\n"
        "  - rotate y at 60 deg/s for 5 s\n  - rotate y at -60 deg/s for 5 s\n  - hold 3 s\n"
        "  - pose 180 0 0 deg in 4 s\n  - hold 3 s\n  - pose 0 -90 0 deg in 4 s\n  - hold 3 s\n"
        "  - pose -90 0 0 deg in 4 s\n  - hold 3 s\nthen: hold\n");
    assert_int_equal(run("$I simulate tactical --motion table.yaml --rate 100Hz --duration 111s "
                         "--seed 2 -o log.csv --truth truth.csv && " WITH_REFERENCE
                         "log.csv >table.csv"),
                     0);
}

#define TABLE "$I calibrate table.csv -p rate-table --without nonlinearity" PLACE
#define CHANGED(statement)                                                                         \
    "awk -F, -v OFS=, 'NR > 1 {" statement "} 1' table.csv >bad.csv; $I calibrate bad.csv -p "     \
    "rate-table --without nonlinearity" PLACE

static void filled_rows_are_found(void **state)
{
    (void)state;
    write_table();
    check_sound(TABLE);
    check_doubt(CHANGED("if (NR % 20 == 0) for (i = 2; i < 8; i++) $i = 0"),
                "all gyro axes have the value 0");
    check_contains(err, "all accelerometer axes have the value 0", "both");
    if (check_quick()) {
        sweep();
        return;
    }
    check_doubt(CHANGED("if (NR % 40 == 0) for (i = 2; i < 5; i++) $i = -999"),
                "all gyro axes have the same values");
    sweep();
}

static void references_are_compared(void **state)
{
    (void)state;
    write_table();
    check_doubt(CHANGED("for (i = 11; i < 14; i++) $i = -$i"),
                "the columns have the opposite sign");
    if (check_quick()) {
        sweep();
        return;
    }
    check_doubt(CHANGED("for (i = 11; i < 14; i++) $i /= 9.80665"), "they look like g;");
    check_doubt(CHANGED("t = $11; $11 = $12; $12 = t"), "check signs and order of their axes");
    check_doubt("awk -F, -v OFS=, '{for (i = 8; i < 14; i++) {t = $i; if (NR > 1) $i = w[(NR - 32) "
                "% 30, i]; w[(NR - 2) % 30, i] = t} if (NR == 1 || NR > 32) print}' table.csv "
                ">bad.csv; $I calibrate bad.csv -p rate-table --without nonlinearity" PLACE,
                "the gyro readings are 0.3 s ahead of the columns reference_rate");
    sweep();
}

/* Slow noise is named as long as no model states it. */
static void unstated_noise_is_named(void **state)
{
    (void)state;
    write_table();
    check_sound(TABLE);
    check_contains(out, "slow noise that no model states", TABLE);
    put("noise.yaml", "imukit: 1\ngyro:\n  noise:\n    bias_instability: 0.5 deg/h\n"
                      "accel:\n  noise:\n    bias_instability: 20 ug\n");
    check_sound(TABLE " --model noise.yaml");
    assert_null(strstr(out, "slow noise that no model states"));
    sweep();
}

static void creeping_positions_are_found(void **state)
{
    (void)state;
#define TUMBLE(step)                                                                               \
    START "steps:\n  - hold 3 s\n"                                                                 \
          "  - repeat: {times: 11, steps: [rotate y 30 deg at 30 deg/s, " step "]}\nthen: hold\n"
    put("still.yaml", TUMBLE("hold 3 s"));
    put("creep.yaml", TUMBLE("rotate x 0.15 deg at 0.05 deg/s"));
    assert_int_equal(
        run("$I simulate tactical --motion creep.yaml --rate 100Hz --duration 47s --seed 2 -o "
            "creep.csv "
            "&& $I simulate tactical --motion still.yaml --rate 100Hz --duration 47s --seed 2 -o "
            "still.csv --truth truth.csv && for i in creep still; do " WITH_REFERENCE
            "$i.csv | cut -d, "
            "-f1-7,11-13 >$i-table.csv; done"),
        0);
    /* Equal steps: with this seed another step fits the noise better than the true one. */
    check_sound("$I calibrate still-table.csv -p tumble" PLACE);
    check_doubt("$I calibrate creep-table.csv -p tumble" PLACE,
                "positions the accelerometers change steadily while the reference does not");
    sweep();
}

static void temperatures_of_no_sensor_are_doubted(void **state)
{
    (void)state;
    put("sweep.csv", "time [s],temperature [degC]\n0,-20\n1000,60\n2000,-20\n");
    assert_int_equal(run("$I simulate AHRS --temperature sweep.csv --rate 2Hz --duration 2000s -o "
                         "sweep-log.csv && head -1 sweep-log.csv"),
                     0);
    check_contains(out, "temperature [degC]", "column");
    static const char as_kelvin[] =
        "awk -F, -v OFS=, 'NR > 1 {$NF += 273.15} 1' sweep-log.csv >kelvin.csv; $I calibrate ";
    char line[300];
    snprintf(line, sizeof line, "%s%s", as_kelvin, "kelvin.csv -p thermal");
    check_doubt(line, "the column looks like K; correct the unit in the header");
    check_doubt("sed '1s/degC/K/' kelvin.csv >as-k.csv; sed '1s/degC/K/' sweep-log.csv >as-c.csv; "
                "$I calibrate as-c.csv -p thermal",
                "the column looks like degC");
    assert_int_equal(run("$I calibrate as-k.csv -p thermal --strict"), 0);
    check_contains(out, "a thermometer with a wrong scale", "not testable");
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(filled_rows_are_found),
        cmocka_unit_test(references_are_compared),
        cmocka_unit_test(unstated_noise_is_named),
        cmocka_unit_test(creeping_positions_are_found),
        cmocka_unit_test(temperatures_of_no_sensor_are_doubted),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
