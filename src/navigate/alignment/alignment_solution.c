/* SPDX-License-Identifier: Apache-2.0 */
/* The attitude from velocities compared:
 *
 *   - inertial: all epochs weigh alike;
 *   - fine: as likely as their noise makes them (alignment_whitener.c). The end state of the
 *     noise's filter says by how much the attitude has walked since the start, and that is taken
 *     off.
 *
 * The noise is not quite known: a model tells that of its sensors, not how much the unit is
 * disturbed; without a model there is only the data. So there are candidates, and each counts by
 * its restricted likelihood, the three angles being fitted [PATTERSON1971]; variances not given are
 * fitted as well. The attitude is the mean over candidates, and its covariance that of the mixture:
 * their own covariances and their disagreement. */
#include "alignment_internal.h"

#include "imukit/elementary.h"
#include "imukit/linear_algebra.h"
#include "navigate/strapdown/strapdown_internal.h"

#include <math.h>
#include <string.h>

enum { EPOCHS_MIN = 8 };

/* One noise, with what fits under it. */
typedef struct candidate {
    const imki_whitener *whitener;
    imki_velocity_fit fit;
    imk_matrix3 inverse; /* of the information */
    double variance;     /* all of the filter's times this */
    double score;        /* log likelihood */
} candidate;

static bool invert(const imk_matrix3 *information, imk_matrix3 *inverse, double *log_determinant)
{
    double factor[9], all[9];
    for (int k = 0; k < 9; k++)
        factor[k] = information->m[k / 3][k % 3];
    if (imk_cholesky_factor(3, factor) != IMK_OK)
        return false;
    imk_cholesky_inverse(3, factor, all);
    for (int k = 0; k < 9; k++)
        inverse->m[k / 3][k % 3] = all[k];
    *log_determinant = imk_cholesky_log_determinant(3, factor);
    return true;
}

static bool assess(const imk_alignment *a, const imki_whitener *whitener, candidate *c)
{
    double log_determinant;
    c->whitener = whitener;
    if (imki_whitener_fit(whitener, &a->coarse, &c->fit) != IMK_OK ||
        !invert(&c->fit.information, &c->inverse, &log_determinant))
        return false;
    const double freedom = 2.0 * (double)(a->epochs - 1) - 3.0;
    const double square = fmax(c->fit.square, 1e-18); /* rounding: 1 nm/s */
    const bool given = a->settings.model != NULL;
    c->variance = given ? 1.0 : square / freedom;
    c->score = -0.5 * ((given ? square : freedom * imk_ln(c->variance)) +
                       2.0 * whitener->log_variance + log_determinant);
    return !isnan(c->score);
}

/* Variance of the force that the attitude's walk has made of gravity in `time`. */
static double attitude_walk(const imki_velocity_noise *noise, double time)
{
    return time * (noise->turn + time * (noise->growth + time * noise->walk / 3.0));
}

/* The attitude's part of what the force has changed by; the rest is the accelerometers'. */
static double attitude_share(const imki_velocity_noise *noise, double time)
{
    const double attitude = attitude_walk(noise, time), forced = noise->forced * time;
    return forced > 0.0 ? attitude / (attitude + forced) : 1.0;
}

/* How far the attitude has walked by the end, in the body's inertial axes: its share of what the
 * filter holds for force besides gravity is gravity turned. */
static imk_vector3 walked(const candidate *c, imk_vector3 force, double time)
{
    const imki_whitener *f = c->whitener;
    const imk_vector3 left =
        imki_difference(f->difference[1], imk_matrix3_apply(c->fit.change, f->reference[1]));
    const imk_vector3 there = imk_matrix3_apply(imk_matrix3_transpose(c->fit.rotation), force);
    return imki_scaled(attitude_share(&f->noise, time) / imki_dot3(force.v, force.v),
                       imki_cross(there, left));
}

/* With the error p of the rotation, e of the filter's force, s its force from the known velocities
 * and c the attitude's share, the attitude at the end errs by
 *
 *     p - c f x (p x s)/f^2 + c f x e/f^2
 *
 * and by what the filter cannot know: c of the accelerometers' walk, which is c (1 - c) of all, and
 * the attitude's since the last epoch. */
static void fine_covariance(const imk_alignment *a, const candidate *c, imk_vector3 force,
                            imk_matrix3 *covariance)
{
    imk_matrix3 map;
    const imki_velocity_noise *noise = &c->whitener->noise;
    const imk_vector3 s = c->whitener->reference[1];
    const double per_square = 1.0 / imki_dot3(force.v, force.v),
                 share = attitude_share(noise, a->time);
    const double seen = share * per_square, fs = imki_dot3(force.v, s.v);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            map.m[i][j] = (i == j ? 1.0 - fs * seen : 0.0) + s.v[i] * force.v[j] * seen;
    const imk_matrix3 turned =
        imk_matrix3_multiply(imk_matrix3_multiply(map, c->inverse), imk_matrix3_transpose(map));
    const double unseen =
        share * noise->forced * a->time + noise->turn * (a->time - a->velocities.last_epoch);
    const double walk = per_square * (share * share * c->whitener->p[1][1] + unseen);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            covariance->m[i][j] =
                c->variance * (turned.m[i][j] + walk * ((i == j ? 1.0 : 0.0) -
                                                        force.v[i] * force.v[j] * per_square));
}

static void equal_covariance(const imk_alignment *a, const candidate *c, const imk_matrix3 *inverse,
                             imk_vector3 force, imk_matrix3 *covariance)
{
    const imki_velocity_noise *noise = &c->whitener->noise;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            covariance->m[i][j] = c->variance * noise->epoch * inverse->m[i][j];
    const imk_vector3 mean = imki_scaled(1.0 / (double)a->epochs, a->reference_sum);
    const struct {
        int kind;
        bool turning;
        double strength;
    } part[] = {{IMKI_SPREAD_FORCE, false, noise->force},
                {IMKI_SPREAD_TURN, true, noise->turn},
                {IMKI_SPREAD_TURN, false, noise->forced},
                {IMKI_SPREAD_GROWTH, true, noise->growth},
                {IMKI_SPREAD_WALK, true, noise->walk}};
    for (size_t i = 0; i < sizeof part / sizeof part[0]; i++)
        imki_spread_covariance(&a->spread[part[i].kind], inverse, mean, force, part[i].turning,
                               c->variance * part[i].strength, covariance);
}

/* ---- the mixture ------------------------------------------------------------------------------
 */

/* Attitude at the end, body to reference axes, and the covariance of its error there. */
typedef struct solution {
    imk_vector3 force; /* at the end, reference axes */
    candidate equal;   /* all epochs alike */
    imk_quaternion attitude;
    imk_matrix3 covariance;
} solution;

/* What one candidate says. Turning about the vertical is not seen: variance N^2 T + b^2 T^2. */
static imk_quaternion solve_with(const imk_alignment *a, const candidate *c, const solution *s,
                                 imk_matrix3 *covariance)
{
    const double per_square = 1.0 / imki_dot3(s->force.v, s->force.v);
    const double about =
        c->variance * per_square * per_square * attitude_walk(&c->whitener->noise, a->time);
    imk_quaternion body = a->velocities.body;
    const imk_matrix3 *rotation = &s->equal.fit.rotation;
    if (a->settings.method == IMK_ALIGNMENT_FINE) {
        rotation = &c->fit.rotation;
        const imk_vector3 walk = imki_scaled(-1.0, walked(c, s->force, a->time));
        body = imk_quaternion_multiply(imk_quaternion_from_rotation_vector(walk), body);
        fine_covariance(a, c, s->force, covariance);
    } else {
        equal_covariance(a, c, &s->equal.inverse, s->force, covariance);
    }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            covariance->m[i][j] += about * s->force.v[i] * s->force.v[j];
    return imk_quaternion_multiply(imk_quaternion_from_matrix(*rotation), body);
}

/* Mean and covariance over candidates, those counted out that are e^-20 as likely as the best. */
static bool mix(const imk_alignment *a, solution *s)
{
    double score[IMKI_WHITENERS], highest = -HUGE_VAL, sum = 0.0;
    imk_matrix3 p;
    candidate c;
    for (size_t i = 0; i < a->whitener_count; i++) {
        score[i] = assess(a, &a->whitener[i], &c) ? c.score : -HUGE_VAL;
        if (score[i] > highest) {
            highest = score[i];
            s->attitude = solve_with(a, &c, s, &p);
        }
    }
    if (!(highest > -HUGE_VAL))
        return false;
    imk_vector3 mean = {{0}};
    imk_matrix3 all = {{{0}}};
    for (size_t n = 0; n < a->whitener_count; n++) {
        if (!(score[n] > highest - 20.0) || !assess(a, &a->whitener[n], &c))
            continue;
        const double weight = imk_exp(score[n] - highest);
        const imk_quaternion attitude = solve_with(a, &c, s, &p);
        const imk_vector3 d = imk_quaternion_to_rotation_vector(
            imk_quaternion_multiply(attitude, imk_quaternion_conjugate(s->attitude)));
        sum += weight;
        mean = imki_sum(mean, imki_scaled(weight, d));
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                all.m[i][j] += weight * (p.m[i][j] + d.v[i] * d.v[j]);
    }
    mean = imki_scaled(1.0 / sum, mean);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            s->covariance.m[i][j] = all.m[i][j] / sum - mean.v[i] * mean.v[j];
    s->attitude = imk_quaternion_multiply(imk_quaternion_from_rotation_vector(mean), s->attitude);
    return true;
}

/* covariance += what errors of the mean force do, of the gyros' readings, and the last rounding of
 * the angles. */
static void add_sensors(const imk_alignment *a, imk_matrix3 c_nb, double latitude, double gravity,
                        imk_matrix3 *covariance)
{
    const double t = a->time, dt = t / (double)a->count;
    const imk_matrix3 c_bn = imk_matrix3_transpose(c_nb);
    const imk_vector3 f = imk_matrix3_apply(c_bn, (imk_vector3){{0.0, 0.0, -gravity}});
    const imk_vector3 w = imk_matrix3_apply(c_bn, imk_earth_rate(latitude));
    const imki_alignment_errors accel =
        imki_alignment_errors_of(&a->settings.model->accel, t, dt, f, NULL);
    const imki_alignment_errors gyro =
        imki_alignment_errors_of(&a->settings.model->gyro, t, dt, w, &f);
    imk_matrix3 force_error;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            force_error.m[i][j] = accel.mean.m[i][j] + accel.reading.m[i][j];
    imki_alignment_response(c_nb, latitude, gravity, &force_error, &gyro.reading, covariance);
    const double rounding = imki_alignment_isotropic(&gyro.quantum);
    for (int i = 0; i < 3; i++)
        covariance->m[i][i] += rounding;
}

/* To north-east-down where the unit is now. */
static void to_result(const imk_alignment *a, const solution *s, imk_alignment_result *result)
{
    const imki_velocities *v = &a->velocities;
    const imk_geodetic place = imk_geodetic_from_ecef(v->position);
    const double turned = IMK_EARTH_RATE * a->time, c = imk_cos(turned), z = imk_sin(turned);
    /* From Earth-fixed axes at the start to those of now. */
    const imk_matrix3 c_er = {{{c, z, 0.0}, {-z, c, 0.0}, {0.0, 0.0, 1.0}}};
    const imk_matrix3 c_en = imk_ned_axes(place.latitude, place.longitude);
    const imk_matrix3 c_nr = imk_matrix3_multiply(
        imk_matrix3_multiply(imk_matrix3_transpose(c_en), c_er), imk_matrix3_transpose(v->axes));
    const imk_matrix3 c_nb = imk_matrix3_multiply(c_nr, imk_quaternion_to_matrix(s->attitude));
    imk_matrix3 covariance = imk_matrix3_multiply(imk_matrix3_multiply(c_nr, s->covariance),
                                                  imk_matrix3_transpose(c_nr));
    if (a->settings.model != NULL)
        add_sensors(a, c_nb, place.latitude, imk_vector3_norm(s->force), &covariance);
    *result = (imk_alignment_result){
        .state = imk_navigation_state_ned(a->time, place, (imk_vector3){{0}}, c_nb),
        .gravity_ratio = imk_vector3_norm(v->measured) / imk_vector3_norm(v->reference),
        .earth_rate_ratio = s->equal.fit.rate_ratio,
        .disturbance = sqrt(fmax(s->equal.fit.square, 0.0) / (double)(a->epochs - 1))};
    result->state.velocity = v->moving;
    imk_matrix3_to_euler(c_nb, &result->roll, &result->pitch, &result->yaw);
    memcpy(result->covariance, covariance.m, sizeof covariance.m);
}

imk_status imki_alignment_inertial_finish(const imk_alignment *alignment,
                                          imk_alignment_result *result, imk_error *error)
{
    const imk_alignment *a = alignment;
    if (a->epochs < EPOCHS_MIN)
        return imk_error_set(error, IMK_ERROR_TOO_SHORT, "alignment", "",
                             "at least 1/32 of the duration");
    const imk_vector3 gravity = imk_gravity_ecef(a->velocities.position);
    solution s = {.force = imki_alignment_to_reference(a, a->time, imki_scaled(-1.0, gravity))};
    if (!assess(a, &a->equal, &s.equal) || !mix(a, &s))
        return imk_error_set(
            error, IMK_ERROR_SINGULAR, "alignment", "",
            "check the samples: the force and its rotation must be finite and not zero");
    to_result(a, &s, result);
    return IMK_OK;
}
