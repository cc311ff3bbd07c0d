/* SPDX-License-Identifier: Apache-2.0 */
/* The same readings of a real unit's model given to the library and to a mechanisation that shares
 * nothing with it, tests/reference/mechanisation.py: in inertial axes, by Runge-Kutta, from other
 * approximations of what happens within a sample. */
#define _DEFAULT_SOURCE
#include "car_profile.h"
#include "check.h"

#include "imukit/model.h"
#include "imukit/navigate.h"
#include "imukit/simulate.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum { COUNT = 60000 };
static const double rate = 100.0, degree = 3.14159265358979323846 / 180.0;

/* Ten minutes of readings, with that before the start. */
typedef struct readings {
    imk_geodetic place;
    double roll, pitch, yaw;
    double *column[6];
    const double *channel[6]; /* from the start on */
} readings;

static readings simulate(const imk_trajectory *trajectory)
{
    imk_model model;
    imk_device_model(imk_device_find("ADIS16465"), &model);
    imk_simulation simulation = imk_simulation_default();
    simulation.rate = rate;
    simulation.seed = 7;
    simulation.motion.trajectory = trajectory;
    const size_t size = imk_simulator_size(&model, &simulation);
    void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    readings r;
    imk_simulator *simulator;
    assert_non_null(memory);
    CHECK_OK(imk_simulator_start(&model, &simulation, &simulator, memory, size, NULL));
    assert_int_equal(imk_simulator_channels(simulator), 6);
    for (int i = 0; i < 6; i++) {
        r.column[i] = malloc((COUNT + 1) * sizeof(double));
        assert_non_null(r.column[i]);
        r.channel[i] = r.column[i] + 1;
    }
    imk_simulator_next(simulator, COUNT + 1, r.column, NULL);
    free(memory);

    imk_motion_state start;
    imk_trajectory_state(trajectory, 0.0, &start);
    r.place = start.place;
    imk_matrix3_to_euler(start.c_nb, &r.roll, &r.pitch, &r.yaw);
    return r;
}

static imk_navigation_state start_of(const readings *r)
{
    return imk_navigation_state_ned(0.0, r->place, (imk_vector3){{0}},
                                    imk_matrix3_from_euler(r->roll, r->pitch, r->yaw));
}

static imk_navigation_state by_steps(const readings *r)
{
    const imk_navigation_state start = start_of(r);
    imk_strapdown strapdown = imk_strapdown_start(&start);
    for (size_t k = 0; k < COUNT; k++) {
        imk_vector3 angle, velocity;
        for (int i = 0; i < 3; i++) {
            angle.v[i] = r->channel[i][k] / rate;
            velocity.v[i] = r->channel[3 + i][k] / rate;
        }
        imk_strapdown_step(&strapdown, 1.0 / rate, angle, velocity);
    }
    return strapdown.state;
}

static imk_navigation_state by_blocks(const readings *r)
{
    const imk_navigation_state start = start_of(r);
    imk_strapdown strapdown = imk_strapdown_start(&start);
    imk_strapdown_run(&strapdown, COUNT, 1.0 / rate, r->channel, NULL, NULL);
    return strapdown.state;
}

/* Skips without Python and NumPy. */
static imk_navigation_state theirs(const readings *r)
{
    if (system("/usr/bin/python3 -c 'import numpy' 2>/dev/null") != 0) {
        print_message("no /usr/bin/python3 with numpy (Debian: python3-numpy)\n");
        skip();
    }
    char path[] = "/tmp/imukit_test_XXXXXX", command[512];
    const int descriptor = mkstemp(path);
    assert_true(descriptor >= 0);
    FILE *file = fdopen(descriptor, "wb");
    assert_non_null(file);
    const double head[10] = {rate, r->place.latitude, r->place.longitude, r->place.height, 0.0, 0.0,
                             0.0,  r->roll,           r->pitch,           r->yaw};
    assert_int_equal(fwrite(head, sizeof head, 1, file), 1);
    for (size_t k = 0; k < COUNT; k++)
        for (int i = 0; i < 6; i++)
            assert_int_equal(fwrite(&r->channel[i][k], sizeof(double), 1, file), 1);
    assert_int_equal(fclose(file), 0);
    snprintf(command, sizeof command,
             "OPENBLAS_NUM_THREADS=1 /usr/bin/python3 %s/tests/reference/mechanisation.py %s",
             SOURCE_DIRECTORY, path);
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    double v[10];
    int found = 0;
    while (found < 10 && fscanf(pipe, "%lf", &v[found]) == 1)
        found++;
    assert_int_equal(pclose(pipe), 0);
    assert_int_equal(found, 10);
    unlink(path);
    return (imk_navigation_state){.time = COUNT / rate,
                                  .position = {{v[0], v[1], v[2]}},
                                  .velocity = {{v[3], v[4], v[5]}},
                                  .attitude = {v[6], v[7], v[8], v[9]}};
}

/* 1 m at rest and 5 m in the car are asked for. What differs comes from the noise of the samples,
 * n, which each scheme takes for another motion within them. Steps take the polynomial through the
 * samples before, the other mechanisation that through those on both sides: n of 4e-6 rad beside an
 * increment of 0.1 m/s makes 4e-6 0.1/6 = 7e-8 m/s of sculling a sample, in 600 s 2e-5 m/s and 5
 * mm, were it not that most of it is taken back by the next sample. Blocks take pairs of samples,
 * and in a turn by w per sample w x (n2 - n1)/6 of a pair is not taken back: with w = 4 mrad 4e-9
 * rad a pair, 3e-7 rad in the 100 s of turns, and g of that 0.5 m in 600 s. */
static const struct {
    const char *name;
    double position, velocity, attitude;
} form[] = {{"steps", 0.01, 1e-4, 1e-8}, {"blocks", 1.0, 5e-3, 2e-6}};

static void compare(const char *what, const readings *r)
{
    const imk_navigation_state start = start_of(r), b = theirs(r);
    for (size_t blocks = 0; blocks < sizeof form / sizeof *form; blocks++) {
        const imk_navigation_state a = blocks ? by_blocks(r) : by_steps(r);
        const imk_quaternion off =
            imk_quaternion_multiply(imk_quaternion_conjugate(b.attitude), a.attitude);
        const double way = imk_vector3_norm(imk_vector3_subtract(a.position, start.position));
        const double distance = imk_vector3_norm(imk_vector3_subtract(a.position, b.position));
        const double speed = imk_vector3_norm(imk_vector3_subtract(a.velocity, b.velocity));
        const double angle = imk_vector3_norm(imk_quaternion_to_rotation_vector(off));
        print_message("%s, %s: %.4g m from the start; they differ by %.2e m, %.2e m/s, %.2e rad\n",
                      what, form[blocks].name, way, distance, speed, angle);
        CHECK_BELOW(distance, form[blocks].position);
        CHECK_BELOW(speed, form[blocks].velocity);
        CHECK_BELOW(angle, form[blocks].attitude);
    }
}

static void free_readings(readings *r)
{
    for (int i = 0; i < 6; i++)
        free(r->column[i]);
}

static void test_rest(void **state)
{
    (void)state;
    imk_trajectory trajectory;
    imk_trajectory_piece piece;
    const double angles[3] = {0.02, -0.03, 70.0 * degree};
    CHECK_OK(imk_trajectory_standstill((imk_geodetic){30.5 * degree, 114.4 * degree, 20.0}, angles,
                                       true, &piece, &trajectory, NULL));
    readings r = simulate(&trajectory);
    compare("at rest", &r);
    free_readings(&r);
}

static void test_car(void **state)
{
    (void)state;
    imk_motion_step steps[CAR_PROFILE_STEPS];
    imk_motion_script script;
    imk_trajectory trajectory;
    size_t pieces;
    car_profile(&script, steps);
    CHECK_OK(imk_motion_script_pieces(&script, &pieces, NULL));
    imk_trajectory_piece *piece = malloc(pieces * sizeof *piece);
    assert_non_null(piece);
    CHECK_OK(imk_motion_script_compile(&script, piece, pieces, &trajectory, NULL));
    readings r = simulate(&trajectory);
    free(piece);
    compare("in the car", &r);
    free_readings(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rest),
        cmocka_unit_test(test_car),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
