/* SPDX-License-Identifier: Apache-2.0 */
/* A loop as the simulator of a robot has it: the motion is computed step by step, and the sensor
 * reads each sample when it has happened.
 *
 *     example_step_sensor [DEVICE]
 *
 * A robot hops and turns. The sensor, a device of the catalogue or a class, is sampled every fifth
 * step of the simulation. Beside it a perfect one shows that nothing of the motion is lost.
 */
#include "imukit/sensor.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { RATE = 200, STEPS_A_SAMPLE = 5, SAMPLES = 10 * RATE };

static const double gravity = 9.81; /* [m/s^2] */

/* What a simulator knows of a body now, world axes x, y, z up. */
typedef struct body {
    double heading;             /* about z [rad]; other simulators have a quaternion here */
    double angular_velocity[3]; /* [rad/s] */
    double height, velocity[3]; /* [m], [m/s] */
} body;

/* A step of the simulation. The leg is a spring. */
static void move(body *b, double time, double dt)
{
    static const double stiffness = 400.0; /* [1/s^2] */
    b->angular_velocity[2] = 2.0 * sin(3.0 * time);
    b->velocity[0] = cos(time);
    b->velocity[2] -= gravity * dt;
    if (b->height < 0.0)
        b->velocity[2] -= stiffness * b->height * dt;
    b->heading += b->angular_velocity[2] * dt;
    b->height += b->velocity[2] * dt;
}

/* The means over a sample, in the axes of the body, from its state before and after. */
static imk_sensor_truth truth_between(const body *before, const body *after, double dt)
{
    imk_sensor_truth truth = {.angular_rate = {0.0, 0.0, (after->heading - before->heading) / dt}};
    const double middle = 0.5 * (before->heading + after->heading);
    double world[3]; /* acceleration less gravity */
    for (int i = 0; i < 3; i++)
        world[i] = (after->velocity[i] - before->velocity[i]) / dt + (i == 2 ? gravity : 0.0);
    truth.specific_force[0] = cos(middle) * world[0] + sin(middle) * world[1];
    truth.specific_force[1] = cos(middle) * world[1] - sin(middle) * world[0];
    truth.specific_force[2] = world[2];
    for (int i = 0; i < 3; i++)
        truth.angular_acceleration[i] =
            (after->angular_velocity[i] - before->angular_velocity[i]) / dt;
    return truth;
}

static imk_sensor *start(const imk_model *model, void **memory)
{
    imk_sensor_settings settings = imk_sensor_default();
    settings.rate = RATE;
    settings.seed = 1;
    const size_t size = imk_sensor_size(model, &settings);
    imk_sensor *sensor = NULL;
    imk_error error;
    *memory = malloc(size);
    if (!*memory)
        exit(EXIT_FAILURE);
    if (imk_sensor_start(model, &settings, &sensor, *memory, size, &error) != IMK_OK) {
        fprintf(stderr, "%s: %s\n", error.field, imk_status_text(error.status));
        exit(EXIT_FAILURE);
    }
    return sensor;
}

int main(int argc, char **argv)
{
    static imk_model model, perfect; /* large: keep them off the stack */
    const imk_device *device = imk_device_find(argc > 1 ? argv[1] : "tactical");
    if (!device) {
        fprintf(stderr, "usage: example_step_sensor [DEVICE]\n");
        return EXIT_FAILURE;
    }
    imk_device_model(device, &model);
    imk_model_default(&perfect);
    void *memory[2];
    imk_sensor *sensor = start(&model, &memory[0]), *ideal = start(&perfect, &memory[1]);

    body now = {.height = 0.1};
    double readings[2][6], heading[2] = {0.0}, climb[2] = {0.0}, time = 0.0;
    const double dt = 1.0 / RATE, step = dt / STEPS_A_SAMPLE;
    for (int sample = 0; sample < SAMPLES; sample++) {
        const body before = now;
        for (int i = 0; i < STEPS_A_SAMPLE; i++, time += step)
            move(&now, time, step);
        const imk_sensor_truth truth = truth_between(&before, &now, dt);
        imk_sensor_step(sensor, &truth, readings[0]);
        imk_sensor_step(ideal, &truth, readings[1]);
        for (int i = 0; i < 2; i++) { /* what a navigator does with them */
            heading[i] += readings[i][2] * dt;
            climb[i] += (readings[i][5] - gravity) * dt;
        }
    }
    free(memory[0]);
    free(memory[1]);
    printf("%d samples of %s: heading off by %.2e rad, vertical velocity by %.2e m/s\n", SAMPLES,
           device->name, heading[0] - now.heading, climb[0] - now.velocity[2]);
    /* What is left of the perfect one is the rounding of 2000 sums of numbers of some m/s. */
    const double lost = fabs(heading[1] - now.heading) + fabs(climb[1] - now.velocity[2]);
    return lost < 1e-10 ? EXIT_SUCCESS : EXIT_FAILURE;
}
