/* SPDX-License-Identifier: Apache-2.0 */
/* imukit calibrate with logs whose faults the solution does not show by itself: each is a doubt or
 * is named, and the sound log beside it stays good. */
#include "cli/run_command.h"

#define PLACE "--position '48.1 deg, 11.6 deg, 520 m'"
#define POSES "$I calibrate poses.csv -p multiposition " PLACE
#define SIX "$I calibrate faces.csv -p sixposition " PLACE

static void check_verdict(const char *line, int code, const char *verdict)
{
    const int actual = run(line);
    if (actual != code)
        fail_msg("%s: code %d, expected %d\n%s%s", line, actual, code, out, err);
    check_contains(out, verdict, line);
}

static void put_unit(void)
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
}

/* 24 attitudes over the sphere, the first for 6 s, then one every 6 s. */
static void write_poses(void)
{
    enum { COUNT = 24, APART = 5 };
    char text[3000];
    size_t used = (size_t)snprintf(text, sizeof text,
                                   "imukit_motion: 1\nstart: {latitude: 48.1 deg, longitude: 11.6 "
                                   "deg, height: 520 m}\nsteps:\n  - hold 6 s\n");
    for (int i = 1; i < COUNT; i++) {
        const int k = i * APART % COUNT;
        used += (size_t)snprintf(
            text + used, sizeof text - used, "  - pose %.2f %.2f %.2f deg in 2 s\n  - hold 4 s\n",
            remainder(137.50776 * k, 360), asin(1 - (2.0 * k + 1) / COUNT) * 57.29578,
            remainder(63.0 * i, 360));
    }
    put("motion.yaml", text);
    put_unit();
    assert_int_equal(
        run("$I simulate unit.yaml --motion motion.yaml --rate 100Hz --seed 3 -o sound.csv"), 0);
}

/* Six faces, from one to the next about x three times, then about z. */
static void write_faces(void)
{
    put_unit();
    put("faces.yaml", "imukit_motion: 1\n"
                      "start: {latitude: 48.1 deg, longitude: 11.6 deg, height: 520 m}\n"
                      "steps:\n"
                      "  - hold 6 s\n  - rotate x 90 deg at 45 deg/s\n"
                      "  - hold 6 s\n  - rotate x 90 deg at 45 deg/s\n"
                      "  - hold 6 s\n  - rotate x 90 deg at 45 deg/s\n"
                      "  - hold 6 s\n  - rotate z 90 deg at 45 deg/s\n"
                      "  - hold 6 s\n  - rotate z 180 deg at 90 deg/s\n"
                      "  - hold 6 s\nthen: hold\n");
    assert_int_equal(run("$I simulate unit.yaml --motion faces.yaml --rate 100Hz --duration 49s "
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
    check_verdict(SIX " --strict", 0, "Usable: ");
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

/* Steps of twice the noise do no harm; coarser ones leave an error in the means that no residual
 * shows, and so does a dead band. */
static void coarse_steps(void **state)
{
    (void)state;
    write_poses();
    spoil("sound.csv", "poses.csv", "for(i=2;i<5;i++)$i=0.1*sprintf(\"%d\",$i*10+1000.5)-100");
    check_verdict(POSES " --strict", 0, "Usable: ");
    spoil("sound.csv", "poses.csv", "for(i=2;i<5;i++)$i=sprintf(\"%d\",$i+1000.5)-1000");
    check_verdict(POSES, 0, "gyro bias to 0.1");
    check_contains(err, "the readings of gyro_x, gyro_y, gyro_z are rounded to steps", "rounded");
    spoil("sound.csv", "poses.csv", "for(i=2;i<5;i++)if($i<1&&$i>-1)$i=0");
    check_verdict(POSES, 0, "gyro bias to 0.3");
    check_contains(err, "or are cut off around zero", "dead band");
    spoil("sound.csv", "poses.csv", "$7=0.2*sprintf(\"%d\",$7*5+1000.5)-200");
    check_verdict(POSES, 0, "Usable with care");
    check_contains(err, "the readings of accel_z are rounded to steps", "accel_z");
    sweep();
}

/* Rests that were not taken are told, and many of them are a doubt. */
static void lost_rests(void **state)
{
    (void)state;
    write_poses();
    spoil("sound.csv", "poses.csv", "");
    check_verdict(POSES " --strict", 0, "Usable: ");
    assert_null(strstr(out, "between turns"));
    spoil("sound.csv", "poses.csv", "if($1>77.8&&$1<82.2)$5+=(NR*7919%100-50)/50");
    check_verdict(POSES, 0, "Usable: ");
    check_contains(out, "1 stretch between turns, of 24, looks like a rest, but cannot be used",
                   "noise");
    check_contains(out, "the noise of accel_x is ", "noise");
    spoil("sound.csv", "poses.csv", "if($1>72)for(i=2;i<5;i++)$i*=2");
    check_verdict(POSES, 0, "Usable with care (1 warning)");
    check_contains(err, " stretches between turns, of 24, look like rests", "range");
    write_faces();
    spoil("sound.csv", "faces.csv", "if($1>7.5&&$1<14.5)$5+=(NR*7919%100-50)/50");
    assert_int_equal(run(SIX), 1);
    check_contains(err, "found 5; 1 more looks like one, but cannot be used: ", "six faces");
    check_contains(err, "; repeat it, or add a hold with y down", "six faces");
    sweep();
}

/* Few sensors are off by 6 %, hardly any by 10 %: the first is told, the second is a doubt. */
static void scales_of_few_sensors(void **state)
{
    (void)state;
    write_poses();
    spoil("sound.csv", "poses.csv", "$4*=1.06");
    check_verdict(POSES " --strict", 0, "Usable: ");
    check_contains(out, "gyro_z reads 1.06 times the true rate: few such sensors err", "1.06");
    spoil("sound.csv", "poses.csv", "$4*=1.1");
    check_verdict(POSES, 0, "Usable with care (1 warning)");
    check_contains(err, "gyro_z reads 1.1 times the true rate: few such sensors err", "1.1");
    spoil("sound.csv", "poses.csv", "for(i=2;i<5;i++)$i*=1.12");
    check_verdict(POSES, 0, "Usable with care (1 warning)");
    sweep();
}

/* The sound log of six faces with a section per hold, one word for each. */
static void label_faces(const char *names, const char *statement)
{
    char line[800];
    snprintf(line, sizeof line,
             "awk -F, -v OFS=, 'BEGIN{split(\"%s\",n,\" \")}NR==1{print $0,\"section\";next}"
             "{l=$1%%8.5<6?n[int($1/8.5)+1]:\"\";%s;print $0,l}' sound.csv >faces.csv",
             names, statement);
    assert_int_equal(run(line), 0);
}

static void labels_that_contradict(void **state)
{
    (void)state;
    write_faces();
    label_faces("z_down y_down z_up y_up x_up x_down", "");
    check_verdict(SIX " --strict", 0, "Usable: ");
    label_faces("z_up y_down z_down y_up x_up x_down", "");
    assert_int_equal(run(SIX), 1);
    check_contains(err,
                   "the label z_up contradicts the readings (2 of 6 labels do): accel_z reads "
                   "gravity there, with a negative sign (z is down); label each hold by",
                   "up and down");
    label_faces("z_down y_down z_up y_up x_up x_up", "");
    assert_int_equal(run(SIX), 1);
    check_contains(err,
                   "found 5: add a hold with x down, or correct the label x_up of a hold that "
                   "reads x down",
                   "one label twice");
    label_faces("z_down y_down z_up y_up x_up x_down", "if($1<3)l=\"x_up\"");
    check_verdict(SIX, 0, "Usable with care (1 warning)");
    check_contains(err, "the label x_up names another face than the accelerometers show",
                   "one of seven");
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(signs_of_six_faces),
        cmocka_unit_test(coarse_steps),
        cmocka_unit_test(lost_rests),
        cmocka_unit_test(scales_of_few_sensors),
        cmocka_unit_test(labels_that_contradict),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
