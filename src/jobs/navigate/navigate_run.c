/* SPDX-License-Identifier: Apache-2.0 */
/* The run: samples through the mechanisation, updates where the unit stands, and the track. */
#include "navigate_aids_internal.h"

#include <math.h>

/* Windows of the detector, and how often one at rest may be taken for motion. Updates come at the
 * same pace: often enough for a stop of some seconds, and rarely enough that the sway of a vehicle
 * differs from one to the next. */
static const double window = 1.0, window_false_alarm = 1e-3; /* [s] */
/* So many windows must be still, and the velocity change by no more than this while they are not,
 * for a unit to count as one that never moved. */
static const double rest_fraction = 0.9, rest_velocity = 0.5; /* [m/s] */
/* Updates refused in a row by which the estimate counts as lost; of a timetable, and found. */
enum { REFUSED_MAX = 20, STANDS_REFUSED_MAX = 3 };

static imk_status describe_errors(imk_navigate_log *n, imk_navigation_filter_settings *s,
                                  imk_error *error)
{
    const imk_navigate_log_settings *o = &n->settings;
    const bool aligned = imki_navigate_aligns(n);
    imk_navigation_filter_default(s);
    s->hold_height = o->hold_height;
    s->samples = o->samples;
    s->velocity_sigma = o->still_velocity;
    s->rotation_sigma = o->still_rotation;
    for (int i = 0; i < 3; i++) {
        s->initial_sigma[i] = o->position_sigma[i];
        s->initial_sigma[3 + i] = o->velocity_sigma[i];
    }
    if (aligned)
        s->initial_sigma[3] = s->initial_sigma[4] = s->initial_sigma[5] = o->still_velocity;
    for (int i = 0; i < 3 && !(aligned && o->model); i++)
        s->initial_sigma[6 + i] = n->attitude_sigma[i];
    if (!o->model)
        return IMK_OK;
    imk_geodetic place;
    imk_matrix3 c_nb;
    imk_navigation_state_to_ned(&n->start, &place, NULL, &c_nb);
    const imk_matrix3 c_bn = imk_matrix3_transpose(c_nb);
    const imk_vector3 up = {{0.0, 0.0, -imk_normal_gravity(place.latitude, place.height)}};
    imk_status status = imk_navigation_filter_describe(
        o->model, n->record.dt, imk_matrix3_apply(c_bn, imk_earth_rate(place.latitude)),
        imk_matrix3_apply(c_bn, up), s, error);
    if (status == IMK_OK && aligned) {
        imki_navigate_free_biases(n, s);
        status = imk_navigation_filter_aligned(&n->alignment, n->method, imki_navigate_north(n),
                                               n->record.dt * (double)n->first, s);
    }
    if (status == IMK_OK)
        return status;
    return imki_fail(&n->findings, error, status,
                     status == IMK_ERROR_UNSUPPORTED ? "model_axes" : "navigation_failed",
                     o->model_name, IMKI_NUMBERS(status));
}

/* ---- track -------------------------------------------------------------------------------------
 */

static imk_status make_track(imk_navigate_log *n, size_t every, imk_error *error)
{
    const size_t rows = (n->record.rows - n->first) / every + 2;
    double *memory =
        imki_resize(&n->record.log.allocator, NULL, rows * IMK_TRACK_COLUMNS * sizeof *memory);
    if (!memory)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    for (int k = 0; k < IMK_TRACK_COLUMNS; k++)
        n->track[k] = memory + (size_t)k * rows;
    return IMK_OK;
}

/* Relative to the Earth, Earth-fixed axes, mean over a sample: C f + g - 2 w x v. */
static imk_vector3 acceleration(const imk_navigate_log *n, const imk_navigation_state *before,
                                const imk_navigation_state *after, size_t row)
{
    const imk_vector3 earth = {{0.0, 0.0, IMK_EARTH_RATE}};
    const imk_vector3 force = imk_vector3_subtract(
        imk_vector3_scale(imki_navigate_increment(n, 1, row), 1.0 / n->record.dt),
        n->end.accel_bias);
    const imk_vector3 turned =
        imk_vector3_scale(imk_vector3_add(imk_quaternion_rotate(before->attitude, force),
                                          imk_quaternion_rotate(after->attitude, force)),
                          0.5);
    return imk_vector3_subtract(imk_vector3_add(turned, imk_gravity_ecef(after->position)),
                                imk_vector3_scale(imk_vector3_cross(earth, after->velocity), 2.0));
}

/* @param sum  of the accelerations of `count` samples since the row before */
static void put_track(imk_navigate_log *n, const imk_navigation_filter_estimate *estimate,
                      double time, imk_vector3 sum, size_t count)
{
    double row[IMK_TRACK_COLUMNS];
    imki_navigate_track_row(n, estimate, row);
    row[IMK_TRACK_TIME] = time;
    const imk_geodetic place = imk_geodetic_from_ecef(estimate->state.position);
    const imk_matrix3 axes = imk_ned_axes(place.latitude, place.longitude);
    sum = imk_matrix3_apply(imk_matrix3_transpose(axes), sum);
    for (int i = 0; i < 3; i++)
        row[IMK_TRACK_ACCELERATION + i] = count > 0 ? sum.v[i] / (double)count : 0.0;
    for (int k = 0; k < IMK_TRACK_COLUMNS; k++)
        n->track[k][n->track_rows] = row[k];
    n->track_rows++;
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
    size_t windows, still_windows; /* of the detector */
    size_t steady_windows;         /* that look still while the velocity is not 0 */
    bool moved;                    /* the velocity changed by more than a standing unit's may */
} stops;

static bool is_at_rest(const stops *s)
{
    return s->windows > 10 && !s->moved && s->steady_windows == 0 &&
           (double)s->still_windows > rest_fraction * (double)s->windows;
}

static imk_status learn_rest(imk_navigate_log *n, stops *s, imk_error *error)
{
    s->detector = imk_standstill_start(window, window_false_alarm);
    for (size_t row = 0; row < n->first; row++)
        imk_standstill_learn(&s->detector, n->record.dt, imki_navigate_increment(n, 0, row),
                             imki_navigate_increment(n, 1, row));
    if (imk_standstill_ready(&s->detector, error) == IMK_OK)
        return IMK_OK;
    if (n->settings.stops == IMK_STOPS_FOUND)
        return imki_fail(&n->findings, error, IMK_ERROR_TOO_SHORT, "rest_short", NULL,
                         IMKI_NUMBERS(n->settings.align, 15 * window));
    s->detector.window = 0.0; /* off */
    return IMK_OK;
}

/* Did the velocity change by more than tilt and bias explain, since the unit last seemed to stand?
 */
static void notice_motion(const imk_navigation_filter *filter, stops *s, bool stands,
                          double force_sigma)
{
    const imk_navigation_state now = imk_navigation_filter_state(filter);
    const double change = imk_vector3_norm(imk_vector3_subtract(now.velocity, s->velocity));
    if (change > rest_velocity + 4.0 * force_sigma * (now.time - s->time))
        s->moved = true;
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
static void update_when_still(imk_navigation_filter *filter, stops *s, bool stands)
{
    const imk_vector3 now = imk_navigation_filter_state(filter).velocity;
    if (!stands) {
        s->tried = s->steady = false;
        imk_navigation_filter_moved(filter);
        return;
    }
    if (!s->steady && !s->stood)
        return;
    if (!s->tried) {
        const double speed = imk_vector3_norm(smooth_velocity(s, now));
        const bool goes_on = s->smooth_speed > 0.0 && speed > 0.5 * s->smooth_speed;
        s->tried = true;
        s->steady = goes_on || !imk_navigation_filter_stand(filter);
        if (!s->steady) {
            s->smooth_speed = 0.0;
        } else if (s->smooth_speed > 0.0) {
            s->smooth = smooth_velocity(s, now);
        } else {
            s->smooth = now;
            s->smooth_speed = imk_vector3_norm(now);
        }
    } else if (!s->steady) {
        imk_navigation_filter_stand(filter);
    }
    s->steady_windows += s->steady;
    if (s->steady)
        s->smooth_end = now;
}

static void watch(const imk_navigate_log *n, imk_navigation_filter *filter, stops *s, size_t row)
{
    if (!(s->detector.window > 0.0))
        return;
    const imk_rest_readings rest = imk_navigation_filter_rest(filter);
    const imk_standstill_verdict verdict =
        imk_standstill_add(&s->detector, n->record.dt, imki_navigate_increment(n, 0, row),
                           imki_navigate_increment(n, 1, row), &rest);
    if (verdict == IMK_STANDSTILL_UNDECIDED)
        return;
    const bool stands = verdict == IMK_STANDSTILL_STANDS;
    s->windows++;
    s->still_windows += stands;
    notice_motion(filter, s, stands, rest.force_sigma);
    if (n->settings.stops == IMK_STOPS_FOUND)
        update_when_still(filter, s, stands);
    s->stood = stands;
}

/* Stops of a timetable: one at the end of each period. */
static void keep_timetable(const imk_navigate_log *n, imk_navigation_filter *filter, stops *s,
                           double time)
{
    const double half = 0.5 * n->record.dt;
    const double into = fmod(time - half, n->settings.stop_period) + half;
    const double stop = n->settings.stop_length, every = fmin(stop, window);
    if (into < n->settings.stop_period - stop + half) {
        s->since_update = 0.0;
        return;
    }
    if (s->since_update == 0.0)
        imk_navigation_filter_moved(filter); /* the stop begins with this sample, or just did */
    s->since_update += n->record.dt;
    if (s->since_update > every - half) {
        imk_navigation_filter_stand(filter);
        s->since_update = 0.5 * half; /* not 0: the stop goes on */
    }
}

/* ---- run ---------------------------------------------------------------------------------------
 */

static imk_status follow(imk_navigate_log *n, imk_navigation_filter *filter, stops *s,
                         imki_navigate_aids *aids, imk_navigation_smoother *smoother, size_t every,
                         const imk_job *job, imk_error *error)
{
    imk_status status = IMK_OK;
    imk_navigation_filter_get(filter, &n->end);
    imk_vector3 sum = {{0}};
    size_t count = 0;
    put_track(n, &n->end, n->first_time + n->record.dt * ((double)n->first - 1.0), sum, count);
    status = imki_navigate_mark(smoother, error);
    for (size_t row = n->first; row < n->record.rows && status == IMK_OK; row++) {
        const size_t done = row + 1 - n->first;
        const imk_navigation_state before = imk_navigation_filter_state(filter);
        imk_navigation_filter_step(filter, n->record.dt, imki_navigate_increment(n, 0, row),
                                   imki_navigate_increment(n, 1, row));
        const imk_navigation_state after = imk_navigation_filter_state(filter);
        sum = imk_vector3_add(sum, acceleration(n, &before, &after, row));
        count++;
        imki_aids_update(n, aids, filter, row);
        watch(n, filter, s, row);
        if (n->settings.stops == IMK_STOPS_TIMETABLE)
            keep_timetable(n, filter, s, n->record.dt * (double)done);
        if (done % every == 0 || row + 1 == n->record.rows) {
            imk_navigation_filter_get(filter, &n->end);
            put_track(n, &n->end, n->first_time + n->record.dt * (double)row, sum, count);
            sum = (imk_vector3){{0}};
            count = 0;
            status = imki_navigate_mark(smoother, error);
            if (status == IMK_OK)
                status = imki_job_progress(job, "navigating", "rows", row, n->record.rows, error);
        }
    }
    n->counts = imk_navigation_filter_counted(filter);
    n->at_rest = is_at_rest(s) && n->aid_count == 0;
    return status;
}

static void warn_of_updates(imk_navigate_log *n, const stops *s)
{
    const imk_navigation_filter_counts *c = &n->counts;
    const double refused = (double)c->refused, tried = refused + (double)c->accepted;
    const bool found = n->settings.stops == IMK_STOPS_FOUND;
    const imk_finding_level level = IMK_FINDING_WARNING;
    if (c->refused > 0)
        imki_find(&n->findings, level, "updates_refused", NULL,
                  IMKI_NUMBERS(refused, tried, n->first_time + c->first_refused));
    if (s->steady_windows > 1)
        imki_find(&n->findings, level, "steady_motion", NULL,
                  IMKI_NUMBERS(window * (double)s->steady_windows));
    if (c->refused_in_row >= (found ? STANDS_REFUSED_MAX : REFUSED_MAX))
        imki_find(&n->findings, level, "updates_lost", NULL,
                  IMKI_NUMBERS((double)c->refused_in_row, found));
    if (n->settings.stops != IMK_STOPS_NONE && c->accepted + c->refused == 0)
        imki_find(&n->findings, level, "no_stop", NULL, IMKI_NUMBERS(found));
    const double q = c->degrees > 20 ? c->chi_square / (double)c->degrees : 0.0;
    if (q > 2.0)
        imki_find(&n->findings, level, "model_too_good", NULL, IMKI_NUMBERS(sqrt(q), q));
}

/* Beyond any vehicle: such an estimate is of no use, and no start may be given there [m/s], [m]. */
static const double speed_lost = 1e5, height_lost = 1e8;

/* Is there a row of which nothing can be said? Compared so that NaN is one. */
static bool is_lost(const imk_navigate_log *n, size_t row, double speed)
{
    for (int k = 0; k < IMK_TRACK_COLUMNS; k++)
        if (!(fabs(n->track[k][row]) < 1e12))
            return true;
    return !(speed < speed_lost) || !(fabs(n->track[IMK_TRACK_HEIGHT][row]) < height_lost);
}

/* Every reading has a sigma above 0, and so has an estimate from them: a variance that was above 0
 * and is not any more was made negative by rounding. */
static bool is_sigma_lost(const imk_navigate_log *n, size_t row)
{
    for (int i = 0; i < IMK_NAVIGATION_ERRORS && row > 0 && n->aid_count > 0; i++) {
        const double *sigma = n->track[IMK_TRACK_SIGMA + i];
        const bool held = n->settings.hold_height && (i == 2 || i == 5);
        if (!held && sigma[row - 1] > 0.0 && !(sigma[row] > 0.0))
            return true;
    }
    return false;
}

/* An absurd reading makes all that follows absurd. */
static imk_status check_track(imk_navigate_log *n, imk_error *error)
{
    for (size_t row = 0; row < n->track_rows; row++) {
        double *const *v = &n->track[IMK_TRACK_VELOCITY];
        const double time = n->track[IMK_TRACK_TIME][row];
        const double speed = hypot(hypot(v[0][row], v[1][row]), v[2][row]);
        if (is_lost(n, row, speed))
            return imki_fail(&n->findings, error, IMK_ERROR_NOT_FINITE, "left_the_earth", NULL,
                             IMKI_NUMBERS(time, speed, n->track[IMK_TRACK_HEIGHT][row],
                                          (double)(n->aid_count > 0)));
        if (is_sigma_lost(n, row))
            return imki_fail(&n->findings, error, IMK_ERROR_NOT_FINITE, "sigma_lost", NULL,
                             IMKI_NUMBERS(time));
    }
    return IMK_OK;
}

imk_status imki_navigate_follow(imk_navigate_log *n, const imk_job *job, imki_arena *scratch,
                                imk_error *error)
{
    imk_navigation_filter_settings settings;
    imk_navigation_filter *filter;
    stops s = {.velocity = n->start.velocity, .time = n->start.time};
    const double steps = n->settings.interval / n->record.dt;
    const size_t every = steps < 1.5 ? 1 : steps < 1e15 ? (size_t)llround(steps) : n->record.rows;
    imk_status status = describe_errors(n, &settings, error);
    imki_navigate_aids *aids = imki_arena_take(scratch, sizeof *aids);
    if (!aids)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    if (status == IMK_OK && n->settings.aids) {
        status = imki_aids_load(n, job, scratch, aids, error);
        if (status == IMK_OK)
            status = imki_aids_start(n, aids, error);
        if (status == IMK_OK)
            imki_aids_describe(n, aids, &settings);
    }
    if (status == IMK_OK && imki_navigate_aligns(n))
        status = learn_rest(n, &s, error);
    if (status == IMK_OK)
        status = make_track(n, every, error);
    if (status != IMK_OK)
        return status;
    const size_t size = imk_navigation_filter_size(&settings);
    void *memory = imki_arena_room(scratch, size);
    status = memory
                 ? imk_navigation_filter_start(&settings, &n->start, &filter, memory, size, error)
                 : imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    imk_navigation_smoother *smoother = NULL;
    if (status == IMK_OK)
        imki_navigate_start_biases(n, filter);
    if (status == IMK_OK && n->settings.smooth)
        status = imki_navigate_record(filter, scratch, &smoother, error);
    if (status == IMK_OK)
        status = follow(n, filter, &s, aids, smoother, every, job, error);
    if (status == IMK_OK && smoother)
        status = imki_navigate_smooth(n, smoother, error);
    if (status != IMK_OK)
        return status;
    imki_aids_finish(n, aids, filter);
    warn_of_updates(n, &s);
    return check_track(n, error);
}
