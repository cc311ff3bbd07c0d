/* SPDX-License-Identifier: Apache-2.0 */
/* A start whose attitude is given: does the log begin as it would from there?
 *
 * The unit need not be at rest. What can be told are seconds that are none of rest (turning,
 * shaking, changing), and, while the readings are steady, whether force and rotation fit the
 * attitude, the place and the velocity. Each axis of the rotation, north, east, down, may be off by
 *
 *     the bias, the noise over the time, the unit's sway, and w times the sigma of
 *     the attitude;
 *
 * all three together are tested by chi-square. Without a model, or with one that states no bias,
 * the bias is not known. Then only gyros are trusted whose reading has the size of the Earth's
 * rotation to a tenth, and a tenth of it is allowed for. */
#include "imukit/distributions.h"
#include "imukit/samples.h"
#include "navigate_log_internal.h"

#include <math.h>

static const double degree = 0.017453292519943295, hour = 3600.0;

/* Beyond these a second is none of a unit at rest, of any sensor: a MEMS gyro's bias is below
 * 1 deg/s, and an idling engine shakes by less. */
static const double turning = 2.0 * 0.017453292519943295, shaking = 1.0, changing = 0.5;
/* The means of steady seconds differ from the first one by no more. */
static const double steady_rate = 0.1 * 0.017453292519943295, steady_force = 0.05;
enum { LOOKED_AT = 10, STEADY_MIN = 3, STEADY_MAX = 300 }; /* [s] */
/* Probability of a warning where all is as stated, and the same in sigmas of one figure. */
static const double false_alarm = 1e-6, sigmas = 5.0;

typedef struct start {
    size_t second, seconds; /* rows of a second; seconds that are steady */
    double time;            /* of these */
    imk_matrix3 c_nb;
    double gravity;
} start;

static double scatter(const imk_navigate_log *n, int sensor, size_t first, size_t rows)
{
    const imk_vector3 mean = imki_navigate_mean(n, sensor, first, rows);
    double sum = 0.0;
    for (size_t row = first; row < first + rows; row++)
        for (int i = 0; i < 3; i++) {
            const double off = n->reading[3 * sensor + i][row] - mean.v[i];
            sum += off * off;
        }
    return sqrt(sum / (3.0 * (double)rows));
}

static double step(imk_vector3 a, imk_vector3 b)
{
    return imk_vector3_norm(imk_vector3_subtract(a, b));
}

/* Standard deviation of a second's mean of white noise, all three axes together. */
static double noise_of_second(const imk_navigate_log *n, int sensor, const start *s)
{
    return scatter(n, sensor, 0, s->second) * sqrt(3.0 / (double)s->second);
}

static start look(const imk_navigate_log *n)
{
    const imk_navigate_log_settings *o = &n->settings;
    const size_t rows = n->record.rows;
    start s = {.second = n->record.dt < 1.0 ? imk_samples_in(1.0, n->record.dt) : 1,
               .c_nb = imk_matrix3_from_euler(o->attitude[0], o->attitude[1], o->attitude[2]),
               .gravity = imk_normal_gravity(o->place.latitude, o->place.height)};
    s.second = s.second < rows ? s.second : rows;
    const imk_vector3 rate = imki_navigate_mean(n, 0, 0, s.second);
    const imk_vector3 force = imki_navigate_mean(n, 1, 0, s.second);
    const double rate_limit = steady_rate + 2.0 * sigmas * noise_of_second(n, 0, &s);
    const double force_limit = steady_force + 2.0 * sigmas * noise_of_second(n, 1, &s);
    while (s.seconds < STEADY_MAX && (s.seconds + 1) * s.second <= rows &&
           step(imki_navigate_mean(n, 0, s.seconds * s.second, s.second), rate) <= rate_limit &&
           step(imki_navigate_mean(n, 1, s.seconds * s.second, s.second), force) <= force_limit)
        s.seconds++;
    s.time = (double)(s.seconds * s.second) * n->record.dt;
    return s;
}

/* Was velocity 0 assumed for what is not at rest? @return true: told */
static bool warn_of_motion(imk_navigate_log *n, const start *s)
{
    const size_t rows = n->record.rows;
    const double bias = sigmas * imki_navigate_bias_size(n, 0);
    const imk_vector3 first = imki_navigate_mean(n, 1, 0, s->second);
    double turn = 0.0, shake = 0.0, change = 0.0;
    for (size_t k = 0; k < LOOKED_AT && (k + 1) * s->second <= rows; k++) {
        turn = fmax(turn, imk_vector3_norm(imki_navigate_mean(n, 0, k * s->second, s->second)));
        if (s->second > 1)
            shake = fmax(shake, scatter(n, 1, k * s->second, s->second));
        change = fmax(change, step(imki_navigate_mean(n, 1, k * s->second, s->second), first));
    }
    const double noise = sigmas * noise_of_second(n, 1, s);
    const int kind = turn > turning + bias       ? 0
                     : change > changing + noise ? 1
                     : shake > shaking           ? 2
                                                 : -1;
    static const char *const codes[3] = {"start_turning", "start_changing", "start_shaking"};
    const double number[3] = {turn / degree, change, shake};
    if (kind >= 0)
        imki_find(&n->findings, IMK_FINDING_WARNING, codes[kind], NULL, IMKI_NUMBERS(number[kind]));
    return kind >= 0;
}

/* In a given attitude the force of the first second, less gravity, is an acceleration. */
static bool warn_of_force(imk_navigate_log *n, const start *s)
{
    const double tolerance = 0.05;
    const imk_vector3 force = imki_navigate_mean(n, 1, 0, s->second);
    imk_vector3 acceleration = imk_matrix3_apply(s->c_nb, force);
    acceleration.v[2] += s->gravity;
    if (imk_vector3_norm(acceleration) <=
        tolerance * s->gravity + 3.0 * imki_navigate_bias_size(n, 1))
        return false;
    const imk_log_column *column = imki_navigate_first_column(n, IMK_QUANTITY_SPECIFIC_FORCE);
    const char *unit =
        imki_navigate_likely_unit(column, imk_vector3_norm(force) / s->gravity, tolerance);
    char names[96];
    imki_navigate_unit_names(column, unit, names);
    if (unit || !n->settings.velocity_given)
        imki_find(&n->findings, IMK_FINDING_WARNING, "start_acceleration", names,
                  IMKI_NUMBERS(imk_vector3_norm(acceleration), unit != NULL));
    return true;
}

/* Steady, but the force is not along the vertical of the attitude, as its sigma would have it. */
static bool warn_of_tilt(imk_navigate_log *n, const start *s)
{
    const double *sigma = n->settings.attitude_sigma;
    const double tilt = fmax(sigma[0], sigma[1]), bias = imki_navigate_bias_size(n, 1);
    if (!(tilt > 0.0) || !(bias > 0.0) || s->seconds < STEADY_MIN)
        return false;
    const imk_vector3 force =
        imk_matrix3_apply(s->c_nb, imki_navigate_mean(n, 1, 0, s->seconds * s->second));
    const double off = hypot(force.v[0], force.v[1]) / s->gravity;
    const double noise = noise_of_second(n, 1, s) / sqrt((double)s->seconds);
    const double known = hypot(tilt, hypot(bias, noise) / s->gravity);
    if (!(off > sigmas * sqrt(2.0) * known))
        return false;
    imki_find(&n->findings, IMK_FINDING_WARNING, "attitude_tilt", NULL,
              IMKI_NUMBERS(off / degree, known / degree));
    return true;
}

/* Rotation of the local axes in space, north, east, down. */
static imk_vector3 rotation_of_axes(double latitude, double height, const double velocity[3])
{
    const double radius = 6.371e6 + height; /* to 0.4 % of 0.6 deg/h at 20 m/s */
    imk_vector3 w = imk_earth_rate(latitude);
    w.v[0] += velocity[1] / radius;
    w.v[1] -= velocity[0] / radius;
    w.v[2] -= velocity[1] * tan(latitude) / radius;
    return w;
}

typedef struct rotation {
    imk_vector3 read;
    double sigma[3];
} rotation;

static double test(const rotation *r, imk_vector3 expected)
{
    double sum = 0.0;
    for (int i = 0; i < 3; i++) {
        const double off = (r->read.v[i] - expected.v[i]) / r->sigma[i];
        sum += off * off;
    }
    return sum;
}

/* What the gyros read along north, east, down, and how far that may be off. @return false: it says
 * nothing */
static bool read_rotation(const imk_navigate_log *n, const start *s, imk_vector3 expected,
                          rotation *r)
{
    const size_t rows = s->seconds * s->second;
    const double *attitude = n->settings.attitude_sigma;
    const double size = imk_vector3_norm(expected), known = imki_navigate_bias_size(n, 0);
    r->read = imk_matrix3_apply(s->c_nb, imki_navigate_mean(n, 0, 0, rows));
    if (known == 0.0 && !(fabs(imk_vector3_norm(r->read) / size - 1.0) <= 0.1))
        return false;
    const double bias = known > 0.0 ? known : 0.1 * size;
    const double noise = noise_of_second(n, 0, s) / sqrt((double)s->seconds);
    const double sway = imki_navigate_sway(n, rows);
    const double tilt = fmax(attitude[0], attitude[1]), heading = attitude[2];
    const double across = hypot(expected.v[0], expected.v[1]);
    for (int i = 0; i < 3; i++) {
        const double second = 0.5 * heading * heading * across; /* a cosine less 1 */
        const double turned =
            i == 2 ? tilt * across
                   : hypot(second, hypot(tilt * expected.v[2], heading * expected.v[1 - i]));
        r->sigma[i] = sqrt(bias * bias + noise * noise + sway * sway + turned * turned);
    }
    return true;
}

static void warn_of_rotation(imk_navigate_log *n, const start *s)
{
    const imk_navigate_log_settings *o = &n->settings;
    const imk_vector3 here = rotation_of_axes(o->place.latitude, o->place.height, o->velocity);
    const imk_vector3 there = rotation_of_axes(-o->place.latitude, o->place.height, o->velocity);
    const double limit = imk_chi_square_quantile(1.0 - false_alarm, 3.0);
    rotation r;
    if (s->seconds < STEADY_MIN || !read_rotation(n, s, here, &r) || !(test(&r, here) > limit))
        return;
    if (!(test(&r, there) > limit)) {
        imki_find(&n->findings, IMK_FINDING_WARNING, "hemisphere", NULL,
                  IMKI_NUMBERS(r.read.v[2] / degree * hour, here.v[2] / degree * hour));
        return;
    }
    const double read = hypot(r.read.v[0], r.read.v[1]), expected = hypot(here.v[0], here.v[1]);
    const double angle = atan2(r.read.v[1], r.read.v[0]) - atan2(here.v[1], here.v[0]);
    const double across = hypot(r.sigma[0], r.sigma[1]);
    if (fabs(r.read.v[2] - here.v[2]) <= sigmas * r.sigma[2] &&
        fabs(read - expected) <= sigmas * across && across < 0.3 * expected)
        imki_find(
            &n->findings, IMK_FINDING_WARNING, "heading_off", NULL,
            IMKI_NUMBERS(remainder(angle, 360.0 * degree) / degree, across / expected / degree));
    else
        imki_find(&n->findings, IMK_FINDING_WARNING, "rotation_off", NULL,
                  IMKI_NUMBERS(r.read.v[0] / degree * hour, r.read.v[1] / degree * hour,
                               r.read.v[2] / degree * hour, here.v[0] / degree * hour,
                               here.v[1] / degree * hour, here.v[2] / degree * hour));
}

void imki_navigate_check_given(imk_navigate_log *n)
{
    const start s = look(n);
    if (!n->settings.velocity_given && !n->settings.aids && warn_of_motion(n, &s))
        return;
    if (!warn_of_force(n, &s) && !warn_of_tilt(n, &s))
        warn_of_rotation(n, &s);
}
