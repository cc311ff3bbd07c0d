/* SPDX-License-Identifier: Apache-2.0 */
/* Does navigation with aids know how good it is? Drives at random, simulated and navigated.
 *
 * usage: aided_drives [drives] [seed] [model.yaml]
 *
 * Each drive is 6 to 12 minutes at 100 Hz: 40 s at rest, then straights, turns and stops drawn by
 * seed and number. The unit is one of the model (without one: biases, flicker and random walks of a
 * tactical unit, all of which the filter has as states), a GNSS receiver reads position (1, 1, 2 m)
 * and velocity (0.05 m/s) once a second at the end of a lever arm, between samples. The tilt is
 * found at rest in 30 s, the heading is given to 2 deg. Prints how much of the time each error is
 * inside its own 95 % bounds, in the last three quarters of the drive also, and its mean square
 * over what is predicted; the same of the smoothed tracks. Exits with 1 when a share of the
 * position or the velocity is outside 93 to 97 %. */
#include "imukit/io.h"
#include "imukit/jobs.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS_MAX = 64, FIGURES = 9, LOG_COLUMNS = 7, AID_COLUMNS = 13 };
static const double DEGREE = 0.017453292519943295, RATE = 100.0;

typedef struct tally {
    size_t rows[FIGURES], inside[FIGURES];
    double square[FIGURES];
} tally;

static double uniform(imk_random random, uint64_t stream, uint64_t *at, double low, double high)
{
    uint32_t word;
    imk_random_words(random, stream, (*at)++, 1, &word);
    return low + (high - low) * ((double)word + 0.5) / 4294967296.0;
}

/* Straights and turns, each third with another speed; a stop now and then. */
static void make_drive(imk_random random, uint32_t drive, imk_motion_script *script,
                       imk_motion_step *step)
{
    const uint64_t stream = imk_stream(drive, 999, 0, 0);
    uint64_t at = 0;
    *script = imk_motion_script_default();
    script->place = (imk_geodetic){uniform(random, stream, &at, -60, 60) * DEGREE, 0.2, 300.0};
    script->heading = uniform(random, stream, &at, -180, 180) * DEGREE;
    script->step = step;
    size_t n = 0;
    double speed = 0.0;
    step[n++] = (imk_motion_step){.kind = IMK_STEP_HOLD, .duration = 40.0};
    const size_t legs = 10 + (size_t)uniform(random, stream, &at, 0, 8);
    for (size_t leg = 0; leg < legs; leg++) {
        if (leg % 3 == 0) {
            const double next = uniform(random, stream, &at, 4, 25);
            step[n++] =
                (imk_motion_step){.kind = IMK_STEP_ACCELERATE, .amount = next - speed, .rate = 2.0};
            speed = next;
        }
        step[n++] = (imk_motion_step){.kind = IMK_STEP_HOLD,
                                      .duration = uniform(random, stream, &at, 5, 40)};
        const double turn = uniform(random, stream, &at, -120, 120);
        step[n++] = (imk_motion_step){.kind = IMK_STEP_TURN,
                                      .amount = turn * DEGREE,
                                      .rate = uniform(random, stream, &at, 5, 25) * DEGREE};
        if (leg % 5 == 4) {
            step[n++] =
                (imk_motion_step){.kind = IMK_STEP_ACCELERATE, .amount = -speed, .rate = 2.5};
            step[n++] = (imk_motion_step){.kind = IMK_STEP_HOLD, .duration = 15.0};
            step[n++] =
                (imk_motion_step){.kind = IMK_STEP_ACCELERATE, .amount = speed, .rate = 2.0};
        }
    }
    script->step_count = n;
}

static void stop(const char *what, const imk_error *error)
{
    fprintf(stderr, "aided_drives: %s: %s %s %s\n", what, error->field, error->found,
            error->expected);
    exit(1);
}

/* A unit whose errors are all states of the filter. */
static void default_model(imk_model *model)
{
    imk_model_default(model);
    const double hour = 3600.0, g = 9.80665;
    imk_triad *triads[2] = {&model->gyro, &model->accel};
    const double bias[2] = {1.0 * DEGREE / hour, 0.5e-3 * g};
    const double white[2] = {0.08 * DEGREE / 60.0, 0.05 / 60.0};
    const double flicker[2] = {0.3 * DEGREE / hour, 40e-6 * g};
    const double walk[2] = {0.3 * DEGREE / hour / 60.0, 30e-6 * g / 60.0};
    for (int s = 0; s < 2; s++) {
        imk_triad *t = triads[s];
        t->present = true;
        t->axis_count = 3;
        for (int i = 0; i < 3; i++) {
            t->direction[i][i] = 1.0;
            t->bias.repeatability.value[i] = bias[s];
            t->noise.white.value[i] = white[s];
            t->noise.bias_instability.value[i] = flicker[s];
            t->noise.random_walk.value[i] = walk[s];
        }
    }
}

/* A record in memory as a source. */
typedef struct table {
    size_t columns, rows;
    double *data[AID_COLUMNS];
    imk_array_sink sink;
    imk_array_source source;
} table;

static void table_open(table *t, size_t columns, size_t rows)
{
    *t = (table){.columns = columns};
    for (size_t c = 0; c < columns; c++)
        t->data[c] = malloc(rows * sizeof(double));
    t->sink = (imk_array_sink){.column_count = columns, .capacity = rows, .data = t->data};
}

static imk_record_source table_source(table *t, const char *const *names)
{
    imk_record_source source;
    imk_error error;
    if (imk_array_source_make(t->columns, names, (const double *const *)t->data, t->sink.rows, 0.0,
                              &t->source, &source, &error) != IMK_OK)
        stop("source", &error);
    return source;
}

static void table_free(table *t)
{
    for (size_t c = 0; c < t->columns; c++)
        free(t->data[c]);
}

static void count(tally *t, int figure, double error, double sigma)
{
    t->rows[figure]++;
    t->inside[figure] += fabs(error) <= 1.959963985 * sigma;
    t->square[figure] += error * error / (sigma * sigma);
}

static void compare(const imk_navigate_log *n, double *const *track, const imk_trajectory *truth,
                    tally *whole, tally *late)
{
    for (size_t row = 0; row < n->track_rows; row++) {
        imk_motion_state m;
        double off[FIGURES];
        imk_trajectory_state(truth, track[IMK_TRACK_TIME][row], &m);
        const imk_vector3 there = imk_ecef_from_geodetic(
            (imk_geodetic){track[IMK_TRACK_LATITUDE][row], track[IMK_TRACK_LONGITUDE][row],
                           track[IMK_TRACK_HEIGHT][row]});
        const imk_matrix3 axes = imk_ned_axes(m.place.latitude, m.place.longitude);
        const imk_vector3 way =
            imk_matrix3_apply(imk_matrix3_transpose(axes), imk_vector3_subtract(there, m.position));
        const imk_matrix3 c = imk_matrix3_from_euler(
            track[IMK_TRACK_ROLL][row], track[IMK_TRACK_PITCH][row], track[IMK_TRACK_YAW][row]);
        const imk_vector3 turn = imk_quaternion_to_rotation_vector(
            imk_quaternion_from_matrix(imk_matrix3_multiply(c, imk_matrix3_transpose(m.c_nb))));
        for (int i = 0; i < 3; i++) {
            off[i] = way.v[i];
            off[3 + i] = track[IMK_TRACK_VELOCITY + i][row] - m.velocity_ned.v[i];
            off[6 + i] = turn.v[i];
        }
        for (int i = 0; i < FIGURES; i++) {
            const double sigma = track[IMK_TRACK_SIGMA + i][row];
            count(whole, i, off[i], sigma);
            if (4 * row > n->track_rows)
                count(late, i, off[i], sigma);
        }
    }
}

static void print(const char *title, const tally *t, bool *good)
{
    static const char *const names[FIGURES] = {"north",  "east",   "down",   "v_north", "v_east",
                                               "v_down", "tilt_N", "tilt_E", "heading"};
    printf("%s\n", title);
    for (int i = 0; i < FIGURES; i++) {
        const double share = (double)t->inside[i] / (double)t->rows[i];
        printf("  %-8s %6.2f %% inside its 95 %% bounds, mean square %.3f of that predicted\n",
               names[i], 100.0 * share, t->square[i] / (double)t->rows[i]);
        if (good && i < 6)
            *good = *good && share >= 0.93 && share <= 0.97;
    }
}

static void run(const imk_model *model, uint64_t seed, uint32_t drive, tally tallies[4])
{
    static const char *const log_names[] = {"time",    "gyro_x",  "gyro_y", "gyro_z",
                                            "accel_x", "accel_y", "accel_z"};
    static const char *const aid_names[] = {"time",
                                            "latitude [rad]",
                                            "longitude [rad]",
                                            "height [m]",
                                            "sigma_north [m]",
                                            "sigma_east [m]",
                                            "sigma_down [m]",
                                            "velocity_north [m/s]",
                                            "velocity_east [m/s]",
                                            "velocity_down [m/s]",
                                            "sigma_velocity_north [m/s]",
                                            "sigma_velocity_east [m/s]",
                                            "sigma_velocity_down [m/s]"};
    imk_error error;
    imk_motion_step step[STEPS_MAX];
    imk_motion_script script;
    imk_trajectory truth;
    size_t pieces;
    const imk_random random = imk_random_seeded(seed);
    make_drive(random, drive, &script, step);
    if (imk_motion_script_pieces(&script, &pieces, &error) != IMK_OK)
        stop("script", &error);
    imk_trajectory_piece *piece = malloc(pieces * sizeof *piece);
    if (imk_motion_script_compile(&script, piece, pieces, &truth, &error) != IMK_OK)
        stop("script", &error);
    double first, last;
    imk_trajectory_span(&truth, &first, &last);
    const size_t rows = (size_t)(last * RATE);
    table log, aids;
    table_open(&log, LOG_COLUMNS, rows);
    table_open(&aids, AID_COLUMNS, rows);
    imk_simulate_log_settings s = imk_simulate_log_default();
    s.simulation.motion.trajectory = &truth;
    s.simulation.rate = RATE;
    s.simulation.seed = seed;
    s.simulation.run = drive;
    s.rows = rows;
    imk_record_sink log_sink = imk_array_sink_of(&log.sink);
    imk_record_sink aid_sink = imk_array_sink_of(&aids.sink);
    imk_aid aid[2] = {imk_aid_default(IMK_AID_POSITION), imk_aid_default(IMK_AID_VELOCITY)};
    imk_navigate_log_settings o = imk_navigate_log_default();
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 3; i++) {
            aid[k].lever_arm[i] = o.lever_arm[i] = (double[3]){1.0, -0.5, -1.5}[i];
            aid[k].sigma[i] = k == 1 ? 0.05 : i == 2 ? 2.0 : 1.0;
            aid[k].from = 0.337;
        }
    if (imk_simulate_log_run(model, &s, &log_sink, "", NULL, &error) != IMK_OK ||
        imk_simulate_aids_run(model, &s, 2, aid, &aid_sink, NULL, &error) != IMK_OK)
        stop("simulate", &error);
    const imk_record_source log_source = table_source(&log, log_names);
    const imk_record_source aid_source = table_source(&aids, aid_names);
    double normal;
    imk_random_normals(random, imk_stream(drive, 999, 1, 0), 0, 1, &normal);
    o.place = script.place;
    o.align = 30.0;
    o.heading_given = true;
    o.attitude_sigma[2] = 2.0 * DEGREE;
    o.attitude[2] = script.heading + normal * o.attitude_sigma[2];
    o.model = model;
    o.model_name = "model";
    o.hold_height = false;
    o.aids = &aid_source;
    o.smooth = true;
    imk_navigate_log *n;
    if (imk_navigate_log_run(&log_source, &o, NULL, &n, &error) != IMK_OK)
        stop("navigate", &error);
    compare(n, n->filtered, &truth, &tallies[0], &tallies[1]);
    compare(n, n->track, &truth, &tallies[2], &tallies[3]);
    imk_navigate_log_free(n);
    table_free(&log);
    table_free(&aids);
    free(piece);
}

int main(int count, char **words)
{
    const uint32_t drives = count > 1 ? (uint32_t)atoi(words[1]) : 300;
    const uint64_t seed = count > 2 ? strtoull(words[2], NULL, 10) : 1;
    imk_model *model = malloc(sizeof *model);
    imk_error error;
    default_model(model);
    if (count > 3 && imk_model_open(words[3], model, NULL, &error) != IMK_OK)
        stop(words[3], &error);
    tally tallies[4] = {{{0}, {0}, {0}}};
    for (uint32_t drive = 0; drive < drives; drive++)
        run(model, seed, drive, tallies);
    bool good = true;
    printf("%u drives of %s, %zu rows of tracks, one a second\n", drives,
           count > 3 ? words[3] : "a unit whose errors are all states", tallies[0].rows[0]);
    print("filtered", &tallies[0], &good);
    print("filtered, without the first quarter of each drive", &tallies[1], NULL);
    print("smoothed", &tallies[2], &good);
    print("smoothed, without the first quarter", &tallies[3], NULL);
    free(model);
    return good || count > 3 ? 0 : 1;
}
