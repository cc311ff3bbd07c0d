/* SPDX-License-Identifier: Apache-2.0 */
/* imukit calibrate with logs whose faults the solution does not show by itself: each is a doubt or
 * is named, and the sound log beside it stays good. */
#include "cli/run_command.h"

#define PLACE "--position '48.1 deg, 11.6 deg, 520 m'"
#define SIX "$I calibrate faces.csv -p sixposition " PLACE

static void check_verdict(const char *line, int code, const char *verdict)
{
    const int actual = run(line);
    if (actual != code)
        fail_msg("%s: code %d, expected %d\n%s%s", line, actual, code, out, err);
    check_contains(out, verdict, line);
}

/* Six faces, from one to the next about x three times, then about z. */
static void write_faces(void)
{
    put("unit.yaml", "imukit: 1\n"
                     "name: bench unit\n"
                     "gyro:\n"
                     "  bias: {fixed: 0.5 -0.8 0.3 deg/s}\n"
                     "  noise: {angle_random_walk: 0.3 deg/sqrt(h), bias_instability: 5 deg/h}\n"
                     "accel:\n"
                     "  bias: {fixed: 20 -35 50 mg}\n"
                     "  scale_factor: {fixed: -3000 6000 9000 ppm}\n"
                     "  noise: {velocity_random_walk: 0.05 m/s/sqrt(h), bias_instability: 30 "
                     "ug}\n");
    put("faces.yaml", "imukit_motion: 1\n"
                      "start: {latitude: 48.1 deg, longitude: 11.6 deg, height: 520 m}\n"
                      "steps:\n"
                      "  - hold 6 s\n  - rotate x 90 deg at 45 deg/s\n"
                      "  - hold 6 s\n  - rotate x 90 deg at 45 deg/s\n"
                      "  - hold 6 s\n  - rotate x 90 deg at 45 deg/s\n"
                      "  - hold 6 s\n  - rotate z 90 deg at 45 deg/s\n"
                      "  - hold 6 s\n  - rotate z 180 deg at 90 deg/s\n"
                      "  - hold 6 s\nthen: hold\n");
    assert_int_equal(run("$I simulate unit.yaml --motion faces.yaml --rate 100Hz --duration 48s "
                         "--seed 3 -o sound.csv"),
                     0);
}

/* Change the columns of the sound log by a statement of awk; $2 … $4 are rates, $5 … $7 forces. */
static void spoil(const char *from, const char *to, const char *statement)
{
    char line[800];
    snprintf(line, sizeof line, "awk -F, -v OFS=, 'NR>1{%s}{print}' %s >%s", statement, from, to);
    assert_int_equal(run(line), 0);
}

/* Few turns tell little about the signs: what they contradict is a doubt, what they do not show is
 * named. */
static void signs_of_six_faces(void **state)
{
    (void)state;
    write_faces();
    spoil("sound.csv", "faces.csv", "");
    check_verdict(SIX " --strict", 0, "Good: ");
    check_contains(out, "the opposite sign of gyro_y (no turn tells it)", "sound.csv");
    spoil("sound.csv", "faces.csv", "$5=-$5");
    check_verdict(SIX, 0, "Usable with care (1 warning)");
    check_contains(err, "signs or order of the axes may be wrong: some turns", "accel_x");
    check_contains(err, "accel_x inverted", "accel_x");
    spoil("sound.csv", "faces.csv", "$3=-$3");
    check_verdict(SIX, 0, "the opposite sign of gyro_y (no turn tells it)");
    spoil("sound.csv", "faces.csv", "$2=-$2");
    assert_int_equal(run(SIX), 1);
    check_contains(err, "gyro_x inverted; or accel_z inverted", "gyro_x");
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(signs_of_six_faces),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
