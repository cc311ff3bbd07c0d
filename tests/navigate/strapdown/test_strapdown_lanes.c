/* SPDX-License-Identifier: Apache-2.0 */
/* The mechanisation in blocks: the same bits for every kernel and division of the samples, and what
 * steps give, to the order of the method. */
#include "car_profile.h"
#include "check.h"

#include "navigate/exact_motion.h"

#include "imukit/motion.h"
#include "imukit/navigate.h"
#include "imukit/random.h"

#include <stdlib.h>
#include <string.h>

static const double degree = 0.017453292519943295, pi = 3.14159265358979323846;

enum { LANES = IMK_STRAPDOWN_LANES };
typedef const double *const (*lane_channels)[6];

/* ---- bits ------------------------------------------------------------------------------------ */

enum { SAMPLES = 700 };

/* Eight runs with samples and starts of their own. Some turn by more than the series are for. */
typedef struct crowd {
    double value[LANES][6][SAMPLES], height[SAMPLES], climb[SAMPLES];
    const double *channel[LANES][6];
    imk_navigation_state start[LANES];
} crowd;

static crowd *crowd_made(void)
{
    crowd *c = malloc(sizeof *c);
    assert_non_null(c);
    const imk_random random = imk_random_seeded(9);
    for (uint32_t lane = 0; lane < LANES; lane++) {
        for (uint8_t j = 0; j < 6; j++) {
            double *const x = c->value[lane][j];
            imk_random_normals(random, imk_stream(lane, 1, 0, j), 0, SAMPLES, x);
            for (size_t k = 0; k < SAMPLES; k++) {
                /* lane 3 tumbles now and then, lane 6 always */
                const bool fast = lane == 6 || (lane == 3 && k % 97 == 5);
                x[k] *= j < 3 ? (fast ? 30.0 : 0.3) : 2.0;
                x[k] += j == 5 ? -9.8 : 0.0;
            }
            c->channel[lane][j] = x;
        }
        const imk_geodetic place = {1.57 - 0.4 * lane, 0.9 * lane, 100.0 * lane};
        c->start[lane] = imk_navigation_state_ned(3.0, place, (imk_vector3){{20.0, 3.0, -0.5}},
                                                  imk_matrix3_from_euler(0.1, 0.2, lane));
    }
    for (size_t k = 0; k < SAMPLES; k++) {
        c->height[k] = 100.0 + 0.01 * (double)k;
        c->climb[k] = 1.0 - 0.001 * (double)k;
    }
    return c;
}

static void offset(const crowd *c, size_t from, const double *channel[LANES][6])
{
    for (size_t lane = 0; lane < LANES; lane++)
        for (size_t j = 0; j < 6; j++)
            channel[lane][j] = c->channel[lane][j] + from;
}

/* `part` samples at a time; 0: by turns 1 … 40. The last 100 have another dt. */
static imk_strapdown_lanes go(const crowd *c, imk_kernel kernel, size_t part, bool hold_height)
{
    imk_strapdown_lanes lanes;
    for (size_t lane = 0; lane < LANES; lane++)
        imk_strapdown_lanes_start(&lanes, lane, &c->start[lane], hold_height);
    size_t turn = 0;
    for (size_t done = 0; done < SAMPLES;) {
        const size_t want = part ? part : 1 + turn++ * 7 % 40;
        const size_t limit = (done < SAMPLES - 100 ? SAMPLES - 100 : SAMPLES) - done;
        const size_t count = want < limit ? want : limit;
        const double *channel[LANES][6];
        offset(c, done, channel);
        imk_strapdown_lanes_run(&lanes, kernel, count, done < SAMPLES - 100 ? 0.01 : 0.013,
                                (lane_channels)channel, hold_height ? c->height + done : NULL,
                                hold_height ? c->climb + done : NULL);
        done += count;
    }
    return lanes;
}

static imk_strapdown go_alone(const crowd *c, size_t lane, size_t part, bool hold_height)
{
    imk_strapdown s = imk_strapdown_start(&c->start[lane]);
    s.hold_height = hold_height;
    for (size_t done = 0; done < SAMPLES;) {
        const size_t limit = (done < SAMPLES - 100 ? SAMPLES - 100 : SAMPLES) - done;
        const size_t count = part < limit ? part : limit;
        const double *channel[LANES][6];
        offset(c, done, channel);
        imk_strapdown_run(&s, count, done < SAMPLES - 100 ? 0.01 : 0.013, channel[lane],
                          hold_height ? c->height + done : NULL,
                          hold_height ? c->climb + done : NULL);
        done += count;
    }
    return s;
}

static void check_same(const imk_navigation_state *a, const imk_navigation_state *b)
{
    assert_memory_equal(a, b, sizeof *a);
}

/* imk_random_seeded() names the best kernel of this machine, and IMUKIT_ISA a lesser one. */
static void test_same_bits(void **state)
{
    (void)state;
    crowd *c = crowd_made();
    const imk_kernel best = imk_random_seeded(0).kernel;
    const imk_kernel kernels[] = {IMK_KERNEL_SCALAR,
                                  best == IMK_KERNEL_AVX512 ? IMK_KERNEL_AVX2 : best, best};
    static const size_t parts[] = {0, 1, 5, 32, 96, SAMPLES};
    for (int hold = 0; hold < 2; hold++) {
        const imk_strapdown_lanes all = go(c, IMK_KERNEL_SCALAR, SAMPLES, hold);
        for (size_t k = 0; k < sizeof kernels / sizeof *kernels; k++)
            for (size_t p = 0; p < sizeof parts / sizeof *parts; p++) {
                const imk_strapdown_lanes lanes = go(c, kernels[k], parts[p], hold);
                assert_memory_equal(lanes.carried, all.carried, sizeof all.carried);
            }
        for (size_t lane = 0; lane < LANES; lane++) {
            const imk_navigation_state expected = imk_strapdown_lanes_state(&all, lane);
            for (size_t p = 1; p < sizeof parts / sizeof *parts; p++) {
                const imk_strapdown alone = go_alone(c, lane, parts[p], hold);
                check_same(&alone.state, &expected);
            }
            CHECK_CLOSE(expected.time, 3.0 + 6.0 + 1.3, 1e-12);
        }
    }
    free(c);
}

/* A lane that has lost its head does not disturb its neighbours. */
static void test_lanes_are_apart(void **state)
{
    (void)state;
    crowd *c = crowd_made();
    const imk_kernel kernel = imk_random_seeded(0).kernel;
    const imk_strapdown_lanes before = go(c, kernel, SAMPLES, true);
    for (size_t k = 100; k < SAMPLES; k++)
        c->value[2][k % 6][k] = k % 2 ? (double)NAN : 1e200;
    const imk_strapdown_lanes after = go(c, kernel, SAMPLES, true);
    for (size_t lane = 0; lane < LANES; lane++) {
        const imk_navigation_state a = imk_strapdown_lanes_state(&before, lane);
        const imk_navigation_state b = imk_strapdown_lanes_state(&after, lane);
        if (lane == 2)
            assert_true(b.position.v[0] != b.position.v[0]);
        else
            check_same(&a, &b);
    }
    free(c);
}

/* ---- against steps --------------------------------------------------------------------------- */

static imk_vector3 at(const double *const *channel, size_t k)
{
    return (imk_vector3){{channel[0][k], channel[1][k], channel[2][k]}};
}

static void step_on(imk_strapdown *s, size_t count, double dt, const double *const channel[6])
{
    for (size_t k = 0; k < count; k++)
        imk_strapdown_step(s, dt, imk_vector3_scale(at(channel, k), dt),
                           imk_vector3_scale(at(channel + 3, k), dt));
}

static void report(const char *what, exact_error e)
{
    print_message("%s: %.2e m, %.2e m/s, %.2e rad\n", what, e.position, e.velocity, e.attitude);
}

/* A constant turn for 10 s at 100 Hz: of 1 and 0.4 rad per sample, beyond the series, and of 0.12,
 * where their last terms still show (one of the other sign: 1e-6 m/s or 1e-8 rad). Attitude and
 * velocity are exact in body axes. The way within a pair is of a force that turns by 2 rad, which
 * the end terms of a trapezium do not follow: some dt^2 f/12, 1e-4 m. */
static void test_fast_turn(void **state)
{
    (void)state;
    enum { COUNT = 1000 };
    static double value[6][COUNT];
    const double *channel[6];
    static const double mean[6] = {60.0, -48.0, 64.0, 3.0, -8.0, 11.0}, share[] = {1.0, 0.4, 0.12};
    for (size_t j = 0; j < 6; j++)
        channel[j] = value[j];
    const imk_navigation_state start =
        imk_navigation_state_ned(0.0, (imk_geodetic){0.8, 0.1, 0.0}, (imk_vector3){{5.0, 0.0, 0.0}},
                                 imk_matrix3_from_euler(0.1, 0.7, -2.0));
    for (size_t i = 0; i < sizeof share / sizeof *share; i++) {
        for (size_t j = 0; j < 6; j++)
            for (size_t k = 0; k < COUNT; k++)
                value[j][k] = j < 3 ? share[i] * mean[j] : mean[j];
        imk_strapdown run = imk_strapdown_start(&start), step = run;
        imk_strapdown_run(&run, COUNT, 0.01, channel, NULL, NULL);
        step_on(&step, COUNT, 0.01, channel);
        const exact_error error = exact_compare(&run.state, &step.state);
        report("fast turn", error);
        CHECK_BELOW(error.attitude, i < 2 ? 1e-12 : 1e-8);
        CHECK_BELOW(error.velocity, i < 2 ? 1e-6 : 1e-7);
        CHECK_BELOW(error.position, 2e-4);
    }
}

/* Steps and runs may take turns; a corrected state is gone on from; other settings are steps. */
static void test_taking_turns(void **state)
{
    (void)state;
    crowd *c = crowd_made();
    const size_t lane = 4;
    imk_strapdown mixed = imk_strapdown_start(&c->start[lane]), step = mixed;
    for (size_t done = 0; done < SAMPLES; done += 50) {
        const double *channel[LANES][6];
        offset(c, done, channel);
        if (done % 100 == 0)
            imk_strapdown_run(&mixed, 50, 0.01, channel[lane], NULL, NULL);
        else
            step_on(&mixed, 50, 0.01, channel[lane]);
        step_on(&step, 50, 0.01, channel[lane]);
        const double nudge = 1e-3 * (double)(done % 150);
        mixed.state.velocity.v[1] += nudge;
        step.state.velocity.v[1] += nudge;
    }
    /* Samples of noise, 3e-3 rad: what is taken for coning differs by some 1e-6 rad in each. */
    const exact_error error = exact_compare(&mixed.state, &step.state);
    report("by turns", error);
    CHECK_BELOW(error.attitude, 1e-4);
    CHECK_BELOW(error.velocity, 1e-2);
    CHECK_CLOSE(mixed.state.time, step.state.time, 1e-12);

    imk_strapdown run = imk_strapdown_start(&c->start[lane]);
    run.samples = 1;
    step = run;
    imk_strapdown_run(&run, SAMPLES, 0.01, c->channel[lane], NULL, NULL);
    step_on(&step, SAMPLES, 0.01, c->channel[lane]);
    check_same(&run.state, &step.state);
    free(c);
}

/* Nothing but a few samples, then as many of another length, twice. Of a constant rate and force
 * both forms know the integrals. An odd sample is given the end terms of a pair, dt^2/4 too much of
 * what the force changes by as it turns within the sample, 6e-3 m/s^2: 2e-7 m. */
static void test_few_samples(void **state)
{
    (void)state;
    crowd *c = crowd_made();
    const size_t lane = 1;
    for (size_t j = 0; j < 6; j++)
        for (size_t k = 0; k < SAMPLES; k++)
            c->value[lane][j][k] = j < 3 ? 0.1 : 3.0 - (double)j;
    for (size_t few = 1; few < 6; few++) {
        imk_strapdown run = imk_strapdown_start(&c->start[lane]), step = run, parts = run;
        imk_strapdown_lanes lanes;
        for (size_t i = 0; i < LANES; i++)
            imk_strapdown_lanes_start(&lanes, i, &c->start[i], false);
        for (size_t k = 0, count = few; k < 3 * few; k += count) {
            const double dt = k == 0 ? 0.01 : 0.004;
            const double *channel[LANES][6];
            offset(c, k, channel);
            imk_strapdown_run(&run, count, dt, channel[lane], NULL, NULL);
            imk_strapdown_lanes_run(&lanes, imk_random_seeded(0).kernel, count, dt,
                                    (lane_channels)channel, NULL, NULL);
            step_on(&step, count, dt, channel[lane]);
            for (size_t i = 0; i < count; i++) {
                offset(c, k + i, channel);
                imk_strapdown_run(&parts, 1, dt, channel[lane], NULL, NULL);
            }
        }
        const imk_navigation_state other = imk_strapdown_lanes_state(&lanes, lane);
        check_same(&run.state, &parts.state);
        check_same(&run.state, &other);
        const exact_error error = exact_compare(&run.state, &step.state);
        CHECK_BELOW(error.position, 3e-7);
        CHECK_BELOW(error.velocity, 1e-9);
        CHECK_BELOW(error.attitude, 1e-15);
    }
    free(c);
}

/* A force that grows along a straight line on a body that does not turn, which both forms know, if
 * what one leaves of the samples before is what the other needs, and a block what the next one
 * does: steps, runs, a run of one sample of another length, steps, runs; last in blocks of four.
 * Wrong by half a sample's growth the way is 1e-6 m off,
 * half a slope's 3e-8 m, and 3 mm in each of the last blocks. */
static void test_what_is_known_of_samples_before(void **state)
{
    (void)state;
    static const struct {
        size_t count;
        double dt;
        bool run;
        double tolerance; /* rounding of positions; a growth from samples as if of one length;
                             Coriolis on the way within a block */
    } part[] = {{40, 0.01, false, 0.0},  {8, 0.01, true, 1e-8},    {1, 0.004, true, 1e-6},
                {1, 0.004, false, 1e-8}, {10, 0.004, true, 1e-8},  {9, 0.004, false, 1e-8},
                {6, 0.004, true, 1e-8},  {12, 0.004, false, 1e-8}, {40, 0.1, true, 1e-4}};
    const imk_navigation_state start = imk_navigation_state_ned(
        0.0, (imk_geodetic){0.8, 0.1, 0.0}, (imk_vector3){{0}}, imk_matrix3_identity());
    imk_strapdown mixed = imk_strapdown_start(&start), step = mixed;
    double value[6][40] = {{0}}, time = 0.0;
    const double *channel[6];
    for (size_t j = 0; j < 6; j++)
        channel[j] = value[j];
    for (size_t i = 0; i < sizeof part / sizeof *part; i++) {
        mixed.state = step.state;
        for (size_t k = 0; k < part[i].count; k++, time += part[i].dt)
            for (size_t j = 3; j < 6; j++)
                value[j][k] = 10.0 * (double)(j - 3) * (time + 0.5 * part[i].dt);
        if (part[i].run)
            imk_strapdown_run(&mixed, part[i].count, part[i].dt, channel, NULL, NULL);
        else
            step_on(&mixed, part[i].count, part[i].dt, channel);
        step_on(&step, part[i].count, part[i].dt, channel);
        const exact_error error = exact_compare(&mixed.state, &step.state);
        report("samples before", error);
        CHECK_BELOW(error.position, part[i].tolerance);
    }
}

/* Less in each sample than the last bit of a position or an attitude tells is not lost between
 * steps and runs: 0.1 um/s at 1 kHz, where runs are of one sample. */
static void test_small_ways(void **state)
{
    (void)state;
    enum { COUNT = 20000 };
    const imk_navigation_state start = imk_navigation_state_ned(
        0.0, (imk_geodetic){0.8, 0.1, 0.0}, (imk_vector3){{1e-7, 0.0, 0.0}},
        imk_matrix3_from_euler(0.4, 0.7, -2.0));
    imk_strapdown mixed = imk_strapdown_start(&start), step = mixed;
    /* Perfect sensors at rest. */
    const imk_quaternion back = imk_quaternion_conjugate(mixed.state.attitude);
    const imk_vector3 rate = imk_quaternion_rotate(back, (imk_vector3){{0.0, 0.0, IMK_EARTH_RATE}});
    const imk_vector3 force =
        imk_vector3_scale(imk_quaternion_rotate(back, imk_gravity_ecef(start.position)), -1.0);
    const double *channel[6];
    for (size_t j = 0; j < 3; j++) {
        channel[j] = &rate.v[j];
        channel[3 + j] = &force.v[j];
    }
    for (size_t k = 0; k < COUNT; k++) {
        step_on(&step, 1, 1e-3, channel);
        if (k % 2 == 0)
            step_on(&mixed, 1, 1e-3, channel);
        else
            imk_strapdown_run(&mixed, 1, 1e-3, channel, NULL, NULL);
    }
    const exact_error error = exact_compare(&mixed.state, &step.state);
    report("small ways", error);
    const imk_navigation_state begin = imk_strapdown_start(&start).state;
    const imk_vector3 way = imk_navigation_difference_ned(&mixed.state, &begin);
    CHECK_CLOSE(way.v[0], 1e-7 * 20.0, 3e-9);
    CHECK_BELOW(error.position, 3e-9);
    CHECK_BELOW(error.attitude, 5e-16);
}

/* At 250 m/s the Earth bends away by 0.1 mm in half a block: the height held is the height all the
 * same, and the climb the climb; and it counts from the call on in which hold_height is set or not,
 * wherever in a block that is. */
static void test_held_height(void **state)
{
    (void)state;
    static double value[6][SAMPLES];
    const double *channel[6];
    for (size_t j = 0; j < 6; j++)
        channel[j] = value[j];
    const imk_geodetic place = {0.8, 0.1, 9000.0};
    const imk_navigation_state start = imk_navigation_state_ned(
        0.0, place, (imk_vector3){{200.0, 150.0, 0.0}}, imk_matrix3_identity());
    const double gravity = imk_normal_gravity(place.latitude, place.height);
    for (size_t k = 0; k < SAMPLES; k++)
        value[5][k] = -gravity - 0.5;
    imk_strapdown s = imk_strapdown_start(&start);
    imk_geodetic now;
    imk_vector3 ned;
    static const size_t counts[] = {160, 7, 31, 1};
    s.hold_height = true;
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        imk_strapdown_run(&s, counts[i], 0.01, channel, NULL, NULL);
        imk_navigation_state_to_ned(&s.state, &now, &ned, NULL);
        CHECK_CLOSE(now.height, place.height, 1e-6);
        CHECK_CLOSE(ned.v[2], 0.0, 1e-5);
    }
    /* 7 into a block: free for 0.05 s, held for as long, free again. Upwards 0.5 m/s^2, and 0.01 of
     * Coriolis and of the way round the Earth. */
    for (int turn = 0; turn < 3; turn++) {
        s.hold_height = turn == 1;
        imk_strapdown_run(&s, 5, 0.01, channel, NULL, NULL);
        imk_navigation_state_to_ned(&s.state, &now, &ned, NULL);
        CHECK_CLOSE(ned.v[2], s.hold_height ? 0.0 : -0.5 * 0.05, s.hold_height ? 1e-5 : 2e-3);
        CHECK_CLOSE(now.height, s.hold_height ? s.height : place.height + 0.5 * 0.05 * 0.05 / 2,
                    s.hold_height ? 1e-6 : 1e-4);
    }
}

/* ---- driving --------------------------------------------------------------------------------- */

enum { CAR_SAMPLES = 60000 };

typedef struct drive {
    imk_trajectory trajectory;
    imk_trajectory_piece *piece;
    double *memory;
    const double *channel[6];
} drive;

static imk_navigation_state truth_at(const imk_trajectory *trajectory, double time)
{
    imk_motion_state state;
    imk_trajectory_state(trajectory, time, &state);
    return (imk_navigation_state){time, state.position, state.velocity, state.attitude};
}

static drive drive_made(void)
{
    static imk_motion_step steps[CAR_PROFILE_STEPS];
    imk_motion_script script;
    size_t pieces;
    drive d;
    car_profile(&script, steps);
    CHECK_OK(imk_motion_script_pieces(&script, &pieces, NULL));
    d.piece = malloc(pieces * sizeof *d.piece);
    d.memory = malloc((7 * (size_t)CAR_SAMPLES + 1) * sizeof *d.memory);
    assert_true(d.piece && d.memory);
    CHECK_OK(imk_motion_script_compile(&script, d.piece, pieces, &d.trajectory, NULL));
    double *boundary = d.memory + 6 * (size_t)CAR_SAMPLES, *mean[6];
    for (size_t j = 0; j < 6; j++)
        d.channel[j] = mean[j] = d.memory + j * CAR_SAMPLES;
    for (size_t k = 0; k <= CAR_SAMPLES; k++)
        boundary[k] = (double)k / 100.0;
    imk_trajectory_means(&d.trajectory, imk_random_seeded(0).kernel, CAR_SAMPLES, boundary, mean,
                         NULL, mean + 3);
    return d;
}

static void drive_freed(drive *d)
{
    free(d->piece);
    free(d->memory);
}

/* Perfect sensors, ten minutes: errors of fourth order in a pair of samples (0.02 s) and of third
 * in a block (0.16 s), where turns begin and end in the middle of one, leave some micrometres. */
static void test_car(void **state)
{
    (void)state;
    drive d = drive_made();
    const imk_navigation_state start = truth_at(&d.trajectory, 0.0);
    const imk_navigation_state end = truth_at(&d.trajectory, 600.0);
    imk_strapdown run = imk_strapdown_start(&start), step = run;
    imk_strapdown_run(&run, CAR_SAMPLES, 0.01, d.channel, NULL, NULL);
    step_on(&step, CAR_SAMPLES, 0.01, d.channel);
    const exact_error error = exact_compare(&run.state, &end);
    const exact_error beside = exact_compare(&run.state, &step.state);
    report("car, blocks", error);
    report("car, steps", exact_compare(&step.state, &end));
    report("car, between", beside);
    CHECK_BELOW(error.position, 2e-5);
    CHECK_BELOW(error.velocity, 1e-7);
    CHECK_BELOW(error.attitude, 1e-12);
    CHECK_BELOW(beside.position, 2e-5);
    CHECK_BELOW(beside.attitude, 1e-12);
    drive_freed(&d);
}

/* With the biases of a MEMS unit and a wrong attitude the drift is that of steps, to 1e-6 of it. */
static void test_drift_of_car(void **state)
{
    (void)state;
    drive d = drive_made();
    static const double bias[6] = {2e-3, -1e-3, 1.5e-3, 0.1, -0.05, 0.2};
    for (size_t j = 0; j < 6; j++)
        for (size_t k = 0; k < CAR_SAMPLES; k++)
            d.memory[j * CAR_SAMPLES + k] += bias[j];
    imk_navigation_state start = truth_at(&d.trajectory, 0.0);
    start.attitude = imk_quaternion_multiply(
        start.attitude, imk_quaternion_from_rotation_vector((imk_vector3){{0.05, -0.1, 0.6}}));
    const imk_navigation_state end = truth_at(&d.trajectory, 600.0);
    for (int hold = 0; hold < 2; hold++) {
        imk_strapdown run = imk_strapdown_start(&start), step = run;
        run.hold_height = step.hold_height = hold;
        imk_strapdown_run(&run, CAR_SAMPLES, 0.01, d.channel, NULL, NULL);
        step_on(&step, CAR_SAMPLES, 0.01, d.channel);
        const exact_error beside = exact_compare(&run.state, &step.state);
        const exact_error drift = exact_compare(&step.state, &end);
        report(hold ? "drift, slaved" : "drift, free", drift);
        report("blocks beside steps", beside);
        CHECK_BELOW(beside.position, 1e-6 * drift.position);
        CHECK_BELOW(beside.velocity, 1e-6 * drift.velocity);
        CHECK_BELOW(beside.attitude, 1e-10);
    }
    drive_freed(&d);
}

/* ---- coning ---------------------------------------------------------------------------------- */

static const double coning_angle = 0.017453292519943295, coning_rate = 62.83185307179586;

static exact_instant coning_at(double time)
{
    const double sine = imk_sin(coning_rate * time), cosine = imk_cos(coning_rate * time);
    const double sb = imk_sin(coning_angle), cb = imk_cos(coning_angle);
    return (exact_instant){
        .attitude = imk_quaternion_from_rotation_vector(
            (imk_vector3){{coning_angle * cosine, coning_angle * sine, 0.0}}),
        .rate = {{-coning_rate * sb * sine, coning_rate * sb * cosine, coning_rate * (cb - 1.0)}}};
}

/* Of a pair with phase x per sample the turn beyond the sum of increments is sin^2 b (x -
 * sin(2x)/2) for a cone of half-angle b; 2/3 of the product of the two increments gives sin^2 b
 * (4/3) (1 - cos x) sin x back. To relative b^2. */
static void test_coning(void **state)
{
    (void)state;
    const exact_motion motion = {{0.78, 0.15, 100.0}, coning_at};
    static const double rates[] = {100, 200, 400};
    const double sb = imk_sin(coning_angle), seconds = 10.0;
    for (int i = 0; i < 3; i++) {
        const size_t count = (size_t)(seconds * rates[i]);
        double *memory = malloc(6 * count * sizeof *memory);
        assert_non_null(memory);
        const double *channel[6];
        for (size_t k = 0; k < count; k++) {
            imk_vector3 angle, velocity;
            exact_increments(&motion, (double)k / rates[i], (double)(k + 1) / rates[i], &angle,
                             &velocity);
            for (size_t j = 0; j < 3; j++) {
                memory[j * count + k] = angle.v[j] * rates[i];
                memory[(3 + j) * count + k] = velocity.v[j] * rates[i];
            }
        }
        for (size_t j = 0; j < 6; j++)
            channel[j] = memory + j * count;
        const imk_navigation_state start = exact_state(&motion, 0.0);
        const imk_navigation_state truth = exact_state(&motion, seconds);
        imk_strapdown s = imk_strapdown_start(&start);
        imk_strapdown_run(&s, count, 1.0 / rates[i], channel, NULL, NULL);
        const double x = coning_rate / rates[i];
        const double missed = (x - imk_sin(2 * x) / 2) - 4.0 / 3 * (1 - imk_cos(x)) * imk_sin(x);
        const double drift = sb * sb * missed * 0.5 * rates[i] * seconds;
        const double error = exact_compare(&s.state, &truth).attitude;
        print_message("coning at %g Hz: %.4g rad, expected %.4g\n", rates[i], error, fabs(drift));
        CHECK_RELATIVE(error, fabs(drift), 5e-3);
        free(memory);
    }
}

/* ---- rest ------------------------------------------------------------------------------------ */

/* A day at rest with a slaved vertical at 1 Hz in eight places, poles and 180 degrees of longitude
 * among them: some micrometres of rounding. */
static void test_day_at_rest(void **state)
{
    (void)state;
    enum { COUNT = 4320, RATE = 1, DAY = 86400 };
    static double value[LANES][6][COUNT];
    const double *channel[LANES][6];
    const imk_geodetic places[LANES] = {
        {pi / 2, 0.0, 2800.0}, {-pi / 2 + 1e-9, 1.0, 0.0}, {0.3, pi, 0.0},    {-0.8, -pi, 100.0},
        {0.0, 1.0, 9000.0},    {45 * degree, 0.1, 0.0},    {1.5, 2.0, -50.0}, {-1.2, -2.0, 0.0}};
    imk_strapdown_lanes lanes;
    imk_navigation_state start[LANES];
    for (size_t lane = 0; lane < LANES; lane++) {
        imk_trajectory trajectory;
        imk_trajectory_piece piece;
        const double angles[3] = {0.1, -0.05, 2.0}, boundary[2] = {0.0, 1.0 / RATE};
        double mean[6], *out[6];
        for (size_t j = 0; j < 6; j++)
            out[j] = &mean[j];
        CHECK_OK(imk_trajectory_standstill(places[lane], angles, true, &piece, &trajectory, NULL));
        imk_trajectory_means(&trajectory, IMK_KERNEL_SCALAR, 1, boundary, out, NULL, out + 3);
        for (size_t j = 0; j < 6; j++) {
            for (size_t k = 0; k < COUNT; k++)
                value[lane][j][k] = mean[j];
            channel[lane][j] = value[lane][j];
        }
        start[lane] = truth_at(&trajectory, 0.0);
        imk_strapdown_lanes_start(&lanes, lane, &start[lane], true);
    }
    for (int k = 0; k < DAY * RATE / COUNT; k++)
        imk_strapdown_lanes_run(&lanes, imk_random_seeded(0).kernel, COUNT, 1.0 / RATE,
                                (lane_channels)channel, NULL, NULL);
    for (size_t lane = 0; lane < LANES; lane++) {
        const imk_navigation_state end = imk_strapdown_lanes_state(&lanes, lane);
        const exact_error error = exact_compare(&end, &start[lane]);
        report("a day at rest", error);
        CHECK_BELOW(error.position, 1e-4);
        CHECK_BELOW(error.attitude, 1e-12);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_bits),   cmocka_unit_test(test_lanes_are_apart),
        cmocka_unit_test(test_fast_turn),   cmocka_unit_test(test_taking_turns),
        cmocka_unit_test(test_few_samples), cmocka_unit_test(test_what_is_known_of_samples_before),
        cmocka_unit_test(test_small_ways),  cmocka_unit_test(test_held_height),
        cmocka_unit_test(test_car),         cmocka_unit_test(test_drift_of_car),
        cmocka_unit_test(test_coning),      cmocka_unit_test(test_day_at_rest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
