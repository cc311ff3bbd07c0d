/* SPDX-License-Identifier: Apache-2.0 */
/* Mechanisation: ten minutes of a car at 100 Hz with perfect sensors. The yardstick is the textbook
 * in north-east-down axes (textbook_ned.c) with coning and sculling from two samples. Times are per
 * sample; for eight lanes per sample and lane.
 *
 * Rows navigate_step, navigate_run and navigate_lanes against the textbook; navigate_lanes_run:
 * eight lanes against our own form for one run. What each misses at the end of the drive is a
 * remark. Row navigation_filter: the filter of a tactical unit at rest (39 states) with
 * position and velocity once a second and the covariance 20 times a second, for a million samples;
 * it has no yardstick. */
#include "bench.h"

#include "textbook_ned.h"

#include "car_profile.h"

#include "imukit/motion.h"
#include "imukit/navigate.h"
#include "imukit/navigation_filter.h"

enum { SAMPLES = 60000, REPEATS = 15, BLOCK = 1000, BLOCKS = 40, MIDDLE = 20000 };
static const double sample_rate = 100.0;
#define INTERVAL (1.0 / sample_rate)

/* The drive: its ends, and the means over its samples. */
typedef struct drive {
    imk_navigation_state start, end;
    double *means[6];
    const double *channel[6];
    imk_kernel kernel;
} drive;

static void *allocate(size_t size)
{
    void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    if (!memory) {
        fprintf(stderr, "bench_navigate: memory is exhausted\n");
        exit(1);
    }
    return memory;
}

static imk_navigation_state state_at(const imk_trajectory *trajectory, double time)
{
    imk_motion_state state;
    imk_trajectory_state(trajectory, time, &state);
    return (imk_navigation_state){time, state.position, state.velocity, state.attitude};
}

static drive make_drive(void)
{
    drive d = {.kernel = imk_random_seeded(0).kernel};
    imk_motion_step step[CAR_PROFILE_STEPS];
    imk_motion_script script;
    imk_trajectory trajectory;
    size_t count;
    car_profile(&script, step);
    if (imk_motion_script_pieces(&script, &count, NULL) != IMK_OK)
        exit(1);
    imk_trajectory_piece *piece = allocate(count * sizeof *piece);
    if (imk_motion_script_compile(&script, piece, count, &trajectory, NULL) != IMK_OK)
        exit(1);
    double *boundary = allocate((SAMPLES + 1) * sizeof *boundary);
    for (size_t k = 0; k <= SAMPLES; k++)
        boundary[k] = (double)k / sample_rate;
    for (int i = 0; i < 6; i++)
        d.channel[i] = d.means[i] = allocate(SAMPLES * sizeof(double));
    imk_trajectory_means(&trajectory, d.kernel, SAMPLES, boundary, d.means, NULL, d.means + 3);
    d.start = state_at(&trajectory, 0.0);
    d.end = state_at(&trajectory, boundary[SAMPLES]);
    free(boundary);
    free(piece);
    return d;
}

static void print_missed(const drive *d, const char *what, const imk_navigation_state *state)
{
    const imk_quaternion off =
        imk_quaternion_multiply(imk_quaternion_conjugate(d->end.attitude), state->attitude);
    fprintf(stderr, "bench_navigate: %s misses %.2g m, %.2g m/s, %.2g rad after %g s\n", what,
            imk_vector3_norm(imk_vector3_subtract(state->position, d->end.position)),
            imk_vector3_norm(imk_vector3_subtract(state->velocity, d->end.velocity)),
            2.0 * imk_vector3_norm((imk_vector3){{off.x, off.y, off.z}}), d->end.time);
}

/* ---- the textbook ------------------------------------------------------------------------------
 */

static textbook_ned textbook_start(const drive *d, int samples)
{
    imk_geodetic place;
    imk_vector3 velocity;
    imk_matrix3 c_nb;
    imk_navigation_state_to_ned(&d->start, &place, &velocity, &c_nb);
    const imk_quaternion q = imk_quaternion_from_matrix(c_nb);
    return (textbook_ned){.latitude = place.latitude,
                          .longitude = place.longitude,
                          .height = place.height,
                          .velocity = {velocity.v[0], velocity.v[1], velocity.v[2]},
                          .attitude = {q.w, q.x, q.y, q.z},
                          .samples = samples};
}

static inline void textbook_sample(textbook_ned *s, const double *const channel[6], size_t k)
{
    double angle[3], velocity[3];
    for (int i = 0; i < 3; i++) {
        angle[i] = INTERVAL * channel[i][k];
        velocity[i] = INTERVAL * channel[3 + i][k];
    }
    textbook_ned_step(s, INTERVAL, angle, velocity);
}

static textbook_ned textbook_drive(const drive *d, int samples)
{
    textbook_ned s = textbook_start(d, samples);
    for (size_t k = 0; k < SAMPLES; k++)
        textbook_sample(&s, d->channel, k);
    return s;
}

static imk_navigation_state textbook_end(const drive *d, int samples)
{
    const textbook_ned s = textbook_drive(d, samples);
    const imk_quaternion q = {s.attitude[0], s.attitude[1], s.attitude[2], s.attitude[3]};
    return imk_navigation_state_ned(d->end.time, (imk_geodetic){s.latitude, s.longitude, s.height},
                                    (imk_vector3){{s.velocity[0], s.velocity[1], s.velocity[2]}},
                                    imk_quaternion_to_matrix(q));
}

static void run_textbook(void *context)
{
    const textbook_ned end = textbook_drive(context, 2);
    bench_use(&end);
}

/* ---- ours --------------------------------------------------------------------------------------
 */

static imk_navigation_state step_drive(const drive *d, int samples)
{
    imk_strapdown s = imk_strapdown_start(&d->start);
    s.samples = samples;
    for (size_t k = 0; k < SAMPLES; k++) {
        imk_vector3 angle, velocity;
        for (int i = 0; i < 3; i++) {
            angle.v[i] = INTERVAL * d->channel[i][k];
            velocity.v[i] = INTERVAL * d->channel[3 + i][k];
        }
        imk_strapdown_step(&s, INTERVAL, angle, velocity);
    }
    return s.state;
}

static void run_step(void *context)
{
    const imk_navigation_state end = step_drive(context, 3);
    bench_use(&end);
}

static void run_run(void *context)
{
    const drive *d = context;
    imk_strapdown s = imk_strapdown_start(&d->start);
    imk_strapdown_run(&s, SAMPLES, INTERVAL, d->channel, NULL, NULL);
    bench_use(&s);
}

/* Eight lanes, each with readings of its own, a second after the other lanes' so that no two are
 * alike; BLOCK samples of them in the cache, as they come from a simulator. */
typedef struct lanes {
    const drive *drive;
    imk_strapdown_lanes lanes;
    double *block[IMK_STRAPDOWN_LANES][6];
    const double *channel[IMK_STRAPDOWN_LANES][6];
} lanes;

static lanes *make_lanes(const drive *d)
{
    lanes *l = allocate(sizeof *l);
    l->drive = d;
    for (size_t lane = 0; lane < IMK_STRAPDOWN_LANES; lane++) {
        imk_strapdown_lanes_start(&l->lanes, lane, &d->start, false);
        for (int i = 0; i < 6; i++) {
            l->channel[lane][i] = l->block[lane][i] = allocate(BLOCK * sizeof(double));
            memcpy(l->block[lane][i], d->channel[i] + MIDDLE + 100 * lane, BLOCK * sizeof(double));
        }
    }
    return l;
}

static void free_lanes(lanes *l)
{
    for (size_t lane = 0; lane < IMK_STRAPDOWN_LANES; lane++)
        for (int i = 0; i < 6; i++)
            free(l->block[lane][i]);
    free(l);
}

static void run_lanes(void *context)
{
    lanes *l = context;
    for (size_t lane = 0; lane < IMK_STRAPDOWN_LANES; lane++)
        imk_strapdown_lanes_start(&l->lanes, lane, &l->drive->start, false);
    for (int block = 0; block < BLOCKS; block++)
        imk_strapdown_lanes_run(&l->lanes, l->drive->kernel, BLOCK, INTERVAL,
                                (const double *const(*)[6])l->channel, NULL, NULL);
    bench_use(l);
}

/* The same block by our form for one run. */
static void run_block(void *context)
{
    const lanes *l = context;
    imk_strapdown s = imk_strapdown_start(&l->drive->start);
    for (int block = 0; block < BLOCKS; block++)
        imk_strapdown_run(&s, BLOCK, INTERVAL, l->channel[0], NULL, NULL);
    bench_use(&s);
}

/* And by the textbook. */
static void run_block_textbook(void *context)
{
    const lanes *l = context;
    textbook_ned s = textbook_start(l->drive, 2);
    for (size_t k = 0; k < (size_t)BLOCKS * BLOCK; k++)
        textbook_sample(&s, l->channel[0], k % BLOCK);
    bench_use(&s);
}

static imk_navigation_state lanes_end(const drive *d)
{
    const double *channel[IMK_STRAPDOWN_LANES][6];
    imk_strapdown_lanes *s = allocate(sizeof *s);
    for (size_t lane = 0; lane < IMK_STRAPDOWN_LANES; lane++) {
        imk_strapdown_lanes_start(s, lane, &d->start, false);
        memcpy(channel[lane], d->channel, sizeof channel[lane]);
    }
    imk_strapdown_lanes_run(s, d->kernel, SAMPLES, INTERVAL, (const double *const(*)[6])channel,
                            NULL, NULL);
    const imk_navigation_state end = imk_strapdown_lanes_state(s, 5);
    free(s);
    return end;
}

static void print_accuracy(const drive *d)
{
    char what[64];
    for (int samples = 1; samples <= 2; samples++) {
        const imk_navigation_state end = textbook_end(d, samples);
        snprintf(what, sizeof what, "the textbook, %d samples,", samples);
        print_missed(d, what, &end);
    }
    for (int samples = 1; samples <= 4; samples++) {
        const imk_navigation_state end = step_drive(d, samples);
        snprintf(what, sizeof what, "the step, %d samples,", samples);
        print_missed(d, what, &end);
    }
    imk_strapdown s = imk_strapdown_start(&d->start);
    imk_strapdown_run(&s, SAMPLES, INTERVAL, d->channel, NULL, NULL);
    print_missed(d, "the run", &s.state);
    const imk_navigation_state end = lanes_end(d);
    print_missed(d, "a lane", &end);
}

/* ---- the filter ------------------------------------------------------------------------------
 */

enum { FILTER_SAMPLES = 1000000, FILTER_REPEATS = 3 };

typedef struct filtered {
    const drive *drive;
    imk_navigation_filter_settings settings;
    void *memory;
    size_t size;
} filtered;

static imk_aid_reading reading_at(imk_aid_kind kind, const imk_navigation_state *state)
{
    imk_geodetic place;
    imk_vector3 velocity;
    imk_navigation_state_to_ned(state, &place, &velocity, NULL);
    imk_aid_reading reading = {.time = state->time};
    memcpy(reading.value, velocity.v, sizeof velocity.v);
    if (kind == IMK_AID_POSITION) {
        reading.value[0] = place.latitude;
        reading.value[1] = place.longitude;
        reading.value[2] = place.height;
    }
    return reading;
}

/* At rest, as readings must fit: what is computed is the same on a drive. */
static void run_filter(void *context)
{
    const filtered *w = context;
    imk_navigation_state here = w->drive->start;
    imk_navigation_filter *f;
    here.velocity = (imk_vector3){{0}};
    if (imk_navigation_filter_start(&w->settings, &here, &f, w->memory, w->size, NULL) != IMK_OK)
        exit(1);
    const imk_vector3 gravity = imk_gravity_ecef(here.position), earth = {{0, 0, IMK_EARTH_RATE}};
    const imk_quaternion down = imk_quaternion_conjugate(here.attitude);
    const imk_vector3 angle = imk_quaternion_rotate(down, imk_vector3_scale(earth, INTERVAL));
    const imk_vector3 lift = imk_quaternion_rotate(down, imk_vector3_scale(gravity, -INTERVAL));
    for (size_t k = 0; k < FILTER_SAMPLES; k++) {
        imk_navigation_filter_step(f, INTERVAL, angle, lift);
        if (k % 100 != 99)
            continue;
        here.time = imk_navigation_filter_state(f).time;
        const imk_aid_reading place = reading_at(IMK_AID_POSITION, &here);
        const imk_aid_reading velocity = reading_at(IMK_AID_VELOCITY, &here);
        if (imk_navigation_filter_aid(f, 0, &place) != IMK_AID_USED ||
            imk_navigation_filter_aid(f, 1, &velocity) != IMK_AID_USED)
            exit(1);
    }
    bench_use(f);
}

static void bench_filter(const drive *d)
{
    imk_model *model = allocate(sizeof *model);
    filtered w = {.drive = d};
    imk_navigation_filter_default(&w.settings);
    imk_device_model(imk_device_find("tactical"), model);
    if (imk_navigation_filter_describe(model, INTERVAL, (imk_vector3){{0}}, (imk_vector3){{0}},
                                       &w.settings, NULL) != IMK_OK)
        exit(1);
    w.settings.step = 0.05;
    w.settings.aid_count = 2;
    w.settings.aid[0] = imk_aid_default(IMK_AID_POSITION);
    w.settings.aid[1] = imk_aid_default(IMK_AID_VELOCITY);
    for (int i = 0; i < 9; i++)
        w.settings.initial_sigma[i] = i < 3 ? 1.0 : i < 6 ? 0.1 : 1e-2;
    w.size = imk_navigation_filter_size(&w.settings);
    w.memory = allocate(w.size);
    double time, none;
    bench_compare(FILTER_REPEATS, run_filter, &w, NULL, NULL, &time, &none);
    bench_row_time("navigation_filter", time, (double)NAN, "s", "-", 1);
    free(w.memory);
    free(model);
}

int main(void)
{
    bench_pin();
    drive d = make_drive();
    print_accuracy(&d);
    const char *isa = imk_kernel_name(d.kernel);
    double ours, yardstick;
    bench_compare(REPEATS, run_step, &d, run_textbook, &d, &ours, &yardstick);
    bench_row_time("navigate_step", 1e9 * ours / SAMPLES, 1e9 * yardstick / SAMPLES, "ns", "-", 1);
    bench_compare(REPEATS, run_run, &d, run_textbook, &d, &ours, &yardstick);
    bench_row_time("navigate_run", 1e9 * ours / SAMPLES, 1e9 * yardstick / SAMPLES, "ns", isa, 1);

    lanes *l = make_lanes(&d);
    const double each = 1e9 / ((double)BLOCKS * BLOCK);
    bench_compare(REPEATS, run_lanes, l, run_block_textbook, l, &ours, &yardstick);
    bench_row_time("navigate_lanes", each * ours / IMK_STRAPDOWN_LANES, each * yardstick, "ns", isa,
                   1);
    bench_compare(REPEATS, run_lanes, l, run_block, l, &ours, &yardstick);
    bench_row_time("navigate_lanes_run", each * ours / IMK_STRAPDOWN_LANES, each * yardstick, "ns",
                   isa, 1);
    free_lanes(l);
    bench_filter(&d);
    for (int i = 0; i < 6; i++)
        free(d.means[i]);
    return 0;
}
