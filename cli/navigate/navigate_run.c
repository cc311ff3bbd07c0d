/* SPDX-License-Identifier: Apache-2.0 */
/* The run: samples through the mechanisation, updates where the unit stands, and the track. */
#include "navigate_parts.h"

#include "shell/progress.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Windows of the detector, and how often one at rest may be taken for motion. Updates come at the
 * same pace: often enough for a stop of some seconds, and rarely enough that the sway of a vehicle
 * differs from one to the next. */
static const double window = 1.0, window_false_alarm = 1e-3; /* [s] */
/* So many windows must be still, and the velocity change by no more than this while they are not,
 * for a unit to count as one that never moved. */
static const double rest_fraction = 0.9, rest_velocity = 0.5; /* [m/s] */
/* Updates refused in a row by which the estimate counts as lost; of a timetable, and found. */
enum { REFUSED_MAX = 20, STANDS_REFUSED_MAX = 3 };

bool navigate_at_rest(const navigation *n)
{
    return n->windows > 10 && !n->moved && n->steady_windows == 0 &&
           (double)n->still_windows > rest_fraction * (double)n->windows;
}

static int describe_errors(navigation *n)
{
    imk_zero_velocity_settings *s = &n->settings;
    const navigate_options *o = n->options;
    imk_error error;
    imk_zero_velocity_default(s);
    s->hold_height = o->vertical == 0;
    s->samples = (int)o->samples.value;
    s->velocity_sigma = o->still_velocity;
    s->rotation_sigma = isnan(o->still_rotation) ? 0.0 : o->still_rotation;
    if (n->aligned)
        s->initial_sigma[3] = s->initial_sigma[4] = s->initial_sigma[5] = o->still_velocity;
    if (!n->has_model) {
        for (int i = 0; i < 3; i++)
            s->initial_sigma[6 + i] = n->attitude_sigma[i];
        return -1;
    }
    imk_geodetic place;
    imk_matrix3 c_nb;
    imk_navigation_state_to_ned(&n->start, &place, NULL, &c_nb);
    const imk_matrix3 c_bn = imk_matrix3_transpose(c_nb);
    const imk_vector3 up = {{0.0, 0.0, -imk_normal_gravity(place.latitude, place.height)}};
    imk_status status = imk_zero_velocity_describe(
        n->model, imk_matrix3_apply(c_bn, imk_earth_rate(place.latitude)),
        imk_matrix3_apply(c_bn, up), s, &error);
    if (status == IMK_OK && n->aligned)
        status = imk_zero_velocity_aligned(&n->alignment, n->method, !o->heading,
                                           n->dt * (double)n->first, s);
    for (int i = 0; i < 3 && !n->aligned; i++)
        s->initial_sigma[6 + i] = n->attitude_sigma[i];
    if (status == IMK_ERROR_UNSUPPORTED)
        return command_failed("%s: navigation needs three gyros and three accelerometers",
                              o->model);
    return status == IMK_OK ? -1 : command_failed("%s: %s", n->path, imk_status_text(status));
}

/* ---- track -------------------------------------------------------------------------------------
 */

static void make_track(navigation *n, size_t every)
{
    const size_t rows = (n->rows - n->first) / every + 2;
    double *memory = command_memory(NULL, rows * TRACK_COLUMNS * sizeof *memory);
    for (int k = 0; k < TRACK_COLUMNS; k++)
        n->track[k] = memory + (size_t)k * rows;
}

/* Relative to the Earth, Earth-fixed axes, mean over a sample: C f + g - 2 w x v. */
static imk_vector3 acceleration(const navigation *n, const imk_navigation_state *before,
                                const imk_navigation_state *after, size_t row)
{
    const imk_vector3 earth = {{0.0, 0.0, IMK_EARTH_RATE}};
    const imk_vector3 force = imk_vector3_subtract(
        imk_vector3_scale(navigate_increment(n, 1, row), 1.0 / n->dt), n->end.accel_bias);
    const imk_vector3 turned =
        imk_vector3_scale(imk_vector3_add(imk_quaternion_rotate(before->attitude, force),
                                          imk_quaternion_rotate(after->attitude, force)),
                          0.5);
    return imk_vector3_subtract(imk_vector3_add(turned, imk_gravity_ecef(after->position)),
                                imk_vector3_scale(imk_vector3_cross(earth, after->velocity), 2.0));
}

/* @param sum  of the accelerations of `count` samples since the row before */
static void put_track(navigation *n, const imk_zero_velocity_estimate *estimate, double time,
                      imk_vector3 sum, size_t count)
{
    double row[TRACK_COLUMNS];
    imk_geodetic place;
    imk_vector3 velocity;
    imk_matrix3 c_nb;
    imk_navigation_state_to_ned(&estimate->state, &place, &velocity, &c_nb);
    const imk_vector3 way = imk_navigation_difference_ned(&estimate->state, &n->start);
    row[TRACK_TIME] = time;
    row[TRACK_LATITUDE] = place.latitude;
    row[TRACK_LONGITUDE] = place.longitude;
    row[TRACK_HEIGHT] = place.height;
    for (int i = 0; i < 3; i++) {
        row[TRACK_NORTH + i] = way.v[i];
        row[TRACK_VELOCITY + i] = velocity.v[i];
    }
    /* Down is along the vertical, north and east across that of the start: a way of 40 km would
     * else lead down by the curvature of the Earth. */
    row[TRACK_NORTH + 2] = n->place.height - place.height;
    imk_matrix3_to_euler(c_nb, &row[TRACK_ROLL], &row[TRACK_PITCH], &row[TRACK_YAW]);
    const imk_matrix3 axes = imk_ned_axes(place.latitude, place.longitude);
    sum = imk_matrix3_apply(imk_matrix3_transpose(axes), sum);
    for (int i = 0; i < 3; i++)
        row[TRACK_ACCELERATION + i] = count > 0 ? sum.v[i] / (double)count : 0.0;
    for (int i = 0; i < IMK_NAVIGATION_ERRORS; i++)
        row[TRACK_SIGMA + i] = sqrt(fmax(0.0, estimate->covariance[i][i]));
    for (int k = 0; k < TRACK_COLUMNS; k++)
        n->track[k][n->track_rows] = row[k];
    n->track_rows++;
    n->largest = fmax(n->largest, hypot(way.v[0], way.v[1]));
}

/* ---- updates -----------------------------------------------------------------------------------
 */

typedef struct stops {
    imk_standstill detector;
    bool stood;           /* the window before */
    bool tried, steady;   /* since it last moved, an update was tried; the first was refused */
    imk_vector3 velocity; /* at the end of the last window that stood, Earth-fixed axes */
    double time;          /* then */
    /* Of smooth motion that was refused, Earth-fixed axes: its velocity, the one navigated at its
     * end, and its speed at first; 0: none [m/s] */
    imk_vector3 smooth, smooth_end;
    double smooth_speed;
    double since_update;
} stops;

static int learn_rest(navigation *n, stops *s)
{
    imk_error error;
    s->detector = imk_standstill_start(window, window_false_alarm);
    for (size_t row = 0; row < n->first; row++)
        imk_standstill_learn(&s->detector, n->dt, navigate_increment(n, 0, row),
                             navigate_increment(n, 1, row));
    if (imk_standstill_ready(&s->detector, &error) == IMK_OK)
        return -1;
    if (n->updates == UPDATES_AUTO)
        return command_failed("--align %.6gs is too short to learn what rest looks like: %g s are "
                              "due",
                              n->options->align, 15 * window);
    s->detector.window = 0.0; /* off */
    return -1;
}

/* Did the velocity change by more than tilt and bias explain, since the unit last seemed to stand?
 */
static void notice_motion(navigation *n, const imk_zero_velocity *filter, stops *s, bool stands,
                          double force_sigma)
{
    const imk_navigation_state now = imk_zero_velocity_state(filter);
    const double change = imk_vector3_norm(imk_vector3_subtract(now.velocity, s->velocity));
    if (change > rest_velocity + 4.0 * force_sigma * (now.time - s->time))
        n->moved = true;
    if (stands) {
        s->velocity = now.velocity;
        s->time = now.time;
    }
}

/* The velocity of smooth motion: found when it was first refused, it does not change while the
 * signal is that of a stand, and by what the mechanisation says in between. */
static imk_vector3 smooth_velocity(const stops *s, imk_vector3 now)
{
    return imk_vector3_add(s->smooth, imk_vector3_subtract(now, s->smooth_end));
}

/* A stand of one window may be a smooth stretch of road: the second one in a row counts. Smooth
 * motion at a constant velocity has the signal of a stand: only the velocity tells, and it does so
 * best at the beginning. Refused there, the rest of the stretch is left out too: later the velocity
 * would be so uncertain that none fits it as well. For the same reason the next stretch is believed
 * to be a stand only when the velocity has changed so as to be nearer to 0. */
static void update_when_still(navigation *n, imk_zero_velocity *filter, stops *s, bool stands)
{
    const imk_vector3 now = imk_zero_velocity_state(filter).velocity;
    if (!stands) {
        s->tried = s->steady = false;
        imk_zero_velocity_moved(filter);
        return;
    }
    if (!s->steady && !s->stood)
        return;
    if (!s->tried) {
        const double speed = imk_vector3_norm(smooth_velocity(s, now));
        const bool goes_on = s->smooth_speed > 0.0 && speed > 0.5 * s->smooth_speed;
        s->tried = true;
        s->steady = goes_on || !imk_zero_velocity_update(filter);
        if (!s->steady) {
            s->smooth_speed = 0.0;
        } else if (s->smooth_speed > 0.0) {
            s->smooth = smooth_velocity(s, now);
        } else {
            s->smooth = now;
            s->smooth_speed = imk_vector3_norm(now);
        }
    } else if (!s->steady) {
        imk_zero_velocity_update(filter);
    }
    n->steady_windows += s->steady;
    if (s->steady)
        s->smooth_end = now;
}

static void watch(navigation *n, imk_zero_velocity *filter, stops *s, size_t row)
{
    if (!(s->detector.window > 0.0))
        return;
    const imk_rest_readings rest = imk_zero_velocity_rest(filter);
    const imk_standstill_verdict verdict = imk_standstill_add(
        &s->detector, n->dt, navigate_increment(n, 0, row), navigate_increment(n, 1, row), &rest);
    if (verdict == IMK_STANDSTILL_UNDECIDED)
        return;
    const bool stands = verdict == IMK_STANDSTILL_STANDS;
    n->windows++;
    n->still_windows += stands;
    notice_motion(n, filter, s, stands, rest.force_sigma);
    if (n->updates == UPDATES_AUTO)
        update_when_still(n, filter, s, stands);
    s->stood = stands;
}

/* Stops of a timetable: one at the end of each period. */
static void keep_timetable(const navigation *n, imk_zero_velocity *filter, stops *s, double time)
{
    const double half = 0.5 * n->dt;
    const double into = fmod(time - half, n->update_every) + half;
    const double stop = n->stop, every = fmin(stop, window);
    if (into < n->update_every - stop + half) {
        s->since_update = 0.0;
        return;
    }
    if (s->since_update == 0.0)
        imk_zero_velocity_moved(filter); /* the stop begins with this sample, or just did */
    s->since_update += n->dt;
    if (s->since_update > every - half) {
        imk_zero_velocity_update(filter);
        s->since_update = 0.5 * half; /* not 0: the stop goes on */
    }
}

/* ---- run ---------------------------------------------------------------------------------------
 */

static int follow(navigation *n, imk_zero_velocity *filter, stops *s, size_t every)
{
    progress p = progress_begin("navigating", "rows", 1);
    imk_zero_velocity_get(filter, &n->end);
    imk_vector3 sum = {{0}};
    size_t count = 0;
    put_track(n, &n->end, n->first_time + n->dt * ((double)n->first - 1.0), sum, count);
    for (size_t row = n->first; row < n->rows; row++) {
        const size_t done = row + 1 - n->first;
        const imk_navigation_state before = imk_zero_velocity_state(filter);
        imk_zero_velocity_step(filter, n->dt, navigate_increment(n, 0, row),
                               navigate_increment(n, 1, row));
        const imk_navigation_state after = imk_zero_velocity_state(filter);
        sum = imk_vector3_add(sum, acceleration(n, &before, &after, row));
        count++;
        watch(n, filter, s, row);
        if (n->updates == UPDATES_EVERY)
            keep_timetable(n, filter, s, n->dt * (double)done);
        if (done % every == 0 || row + 1 == n->rows) {
            imk_zero_velocity_get(filter, &n->end);
            put_track(n, &n->end, n->first_time + n->dt * (double)row, sum, count);
            sum = (imk_vector3){{0}};
            count = 0;
            progress_update(&p, row, n->rows);
        }
    }
    progress_end(&p);
    n->counts = imk_zero_velocity_counted(filter);
    return -1;
}

static void warn_of_updates(const navigation *n)
{
    const imk_zero_velocity_counts *c = &n->counts;
    const unsigned long long refused = c->refused, accepted = c->accepted;
    const unsigned long long in_row = c->refused_in_row;
    const bool found = n->updates == UPDATES_AUTO;
    if (c->refused > 0)
        command_warn("updates_refused",
                     "%llu of %llu updates do not fit what the model allows and were refused, "
                     "first at %.1f s: the unit moved then, or the model is too good for it",
                     refused, refused + accepted, n->first_time + c->first_refused);
    if (n->steady_windows > 1)
        command_warn("steady_motion",
                     "%.4g s look like standing, but begin with a velocity that is not 0: taken "
                     "for smooth motion and not used",
                     window * (double)n->steady_windows);
    if (in_row >= (found ? STANDS_REFUSED_MAX : REFUSED_MAX))
        command_warn("updates_lost",
                     "the last %llu updates were all refused: the estimate is lost%s", in_row,
                     found ? ", or the unit moved smoothly ever since" : "");
    if (n->updates != UPDATES_NONE && c->accepted + c->refused == 0)
        command_warn("no_stop", "no standstill was %s: there was no update",
                     found ? "found" : "due before the end of the log");
    if (c->degrees > 20) {
        const double q = c->chi_square / (double)c->degrees;
        if (q > 2.0)
            command_warn("model_too_good",
                         "innovations are %.1f times as large as the model says (squared: %.1f): "
                         "its predictions are too good",
                         sqrt(q), q);
    }
}

/* An absurd reading makes all that follows absurd. */
static int check_track(const navigation *n)
{
    for (size_t row = 0; row < n->track_rows; row++)
        for (int k = 0; k < TRACK_COLUMNS; k++)
            if (!(fabs(n->track[k][row]) < 1e12))
                return command_failed("%s: by %.3f s the estimate has left the Earth's "
                                      "surroundings: a reading before is absurd, or its unit wrong",
                                      n->path, n->track[TRACK_TIME][row]);
    return -1;
}

int navigate_run(navigation *n)
{
    imk_error error;
    imk_zero_velocity *filter;
    stops s = {.velocity = n->start.velocity, .time = n->start.time};
    const double steps = n->options->interval / n->dt;
    const size_t every = steps < 1.5 ? 1 : steps < 1e15 ? (size_t)llround(steps) : n->rows;
    int code = describe_errors(n);
    if (code < 0 && n->aligned)
        code = learn_rest(n, &s);
    if (code >= 0)
        return code;
    make_track(n, every);
    const size_t size = imk_zero_velocity_size(&n->settings);
    void *memory = command_memory(NULL, size);
    if (imk_zero_velocity_start(memory, size, &n->settings, &n->start, &filter, &error) != IMK_OK)
        code = command_error(&error, n->path);
    if (code < 0)
        code = follow(n, filter, &s, every);
    free(memory);
    if (code < 0)
        warn_of_updates(n);
    return code < 0 ? check_track(n) : code;
}

void navigate_free(navigation *n)
{
    free(n->track[0]);
    log_channels_free(&n->channels);
}
