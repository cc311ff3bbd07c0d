/* SPDX-License-Identifier: Apache-2.0 */
/* The closed form of the Ferraris procedure [FERRARIS1995], equations in ferraris.h, and its sigmas
 * to first order. With M = K R and independent elements of M,
 *
 *     dK_i = sum over j of R_ij dM_ij,     dR_ij = (dM_ij - R_ij dK_i)/K_i. */
#include "six_position_internal.h"

#include "base/algebra/vector_internal.h"
#include "base/refuse_internal.h"
#include "imukit/attitude.h"

#include <math.h>
#include <string.h>

/* Sums over all that was logged of one kind. */
typedef struct pool {
    double samples[3][2], sum[3][2][2][3]; /* axis; up, down; sensor; component */
    double variance[3][2][2][3];           /* of those sums */
    double turned[3];                      /* angles of the turns about an axis [rad] */
    double turns[3];
    double duration[3], reading[3][2][3]; /* integrals over turns, each with its sense [s] */
    double time[3];                       /* all of it, without sense [s] */
} pool;

static imk_status wrong_stretch(size_t k, imk_error *error)
{
    return imki_refuse_at(error, IMK_ERROR_ARGUMENT, "stretch", k, 0.0, 0.0,
                          "a stretch within the record, axis 0 to 2, sense 1 or -1");
}

static void add_hold(const imk_test_record *record, const imk_ferraris_stretch *at, pool *p)
{
    const int a = at->axis, down = at->sense < 0;
    const imk_static_interval summary = imk_static_summary(record, at->begin, at->end);
    const double n = (double)(at->end - at->begin);
    p->samples[a][down] += n;
    for (int s = 0; s < 2; s++)
        for (int i = 0; i < 3; i++) {
            double sum = 0.0;
            for (size_t k = at->begin; k < at->end; k++)
                sum += record->reading[s][i][k];
            p->sum[a][down][s][i] += sum;
            p->variance[a][down][s][i] += n * n * summary.sigma[s][i] * summary.sigma[s][i];
        }
}

static bool add_turn(const imk_test_record *record, const imk_ferraris_stretch *at,
                     double turn_angle, pool *p)
{
    const int a = at->axis;
    const imki_turn_means means = imki_turn_mean(record, at->begin, at->end);
    if (!isfinite(means.duration))
        return false;
    p->turned[a] += turn_angle;
    p->turns[a] += 1.0;
    p->duration[a] += at->sense * means.duration;
    p->time[a] += means.duration;
    for (int s = 0; s < 2; s++)
        for (int i = 0; i < 3; i++)
            p->reading[a][s][i] += at->sense * means.duration * means.reading[s][i];
    return true;
}

static imk_status gather(const imk_test_record *record, size_t count,
                         const imk_ferraris_stretch *stretch, double turn_angle, pool *p,
                         imk_error *error)
{
    memset(p, 0, sizeof *p);
    for (size_t k = 0; k < count; k++) {
        const imk_ferraris_stretch *at = &stretch[k];
        if (at->begin >= at->end || at->end > record->count || at->axis < 0 || at->axis > 2 ||
            (at->sense != 1 && at->sense != -1))
            return wrong_stretch(k, error);
        if (!at->turn) {
            add_hold(record, at, p);
        } else if (!add_turn(record, at, turn_angle, p)) {
            return imki_refuse_at(error, IMK_ERROR_GAP, "turn", k, 0.0, 0.0,
                                  "a turn without gaps and missing readings");
        }
    }
    for (int a = 0; a < 3; a++) {
        static const char *const axis_names[3] = {"x", "y", "z"};
        if (p->samples[a][0] == 0.0 || p->samples[a][1] == 0.0)
            return imk_error_set(error, IMK_ERROR_TOO_SHORT, "hold", axis_names[a],
                                 "add holds with this axis up and down");
        if (p->turns[a] == 0.0)
            return imk_error_set(error, IMK_ERROR_TOO_SHORT, "turn", axis_names[a],
                                 "a turn about this axis");
    }
    return IMK_OK;
}

/* M into lengths and directions of its rows, with what the variances of M make of both. */
static bool split_rows(double m[3][3], double variance[3][3], imk_ferraris_triad *t)
{
    for (int i = 0; i < 3; i++) {
        const double k = imki_norm3(m[i]);
        double of_k = 0.0;
        if (!(k > 0.0) || !isfinite(k))
            return false;
        t->scale[i] = k;
        for (int j = 0; j < 3; j++) {
            const double r = m[i][j] / k;
            t->axes[i][j] = r;
            of_k += r * r * variance[i][j];
        }
        t->scale_sigma[i] = sqrt(of_k);
        for (int j = 0; j < 3; j++) {
            double of_r = 0.0;
            for (int l = 0; l < 3; l++) {
                const double d = ((j == l ? 1.0 : 0.0) - t->axes[i][j] * t->axes[i][l]) / k;
                of_r += d * d * variance[i][l];
            }
            t->axes_sigma[i][j] = sqrt(of_r);
        }
    }
    return true;
}

/* Half differences of the holds over g: M of the accelerometers, G of the gyros. */
static void half_differences(const pool *p, int sensor, double gravity, double m[3][3],
                             double variance[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const double up = p->samples[j][0], down = p->samples[j][1];
            m[i][j] =
                (p->sum[j][0][sensor][i] / up - p->sum[j][1][sensor][i] / down) / (2.0 * gravity);
            variance[i][j] = (p->variance[j][0][sensor][i] / (up * up) +
                              p->variance[j][1][sensor][i] / (down * down)) /
                             (4.0 * gravity * gravity);
        }
}

static void solve_biases(const pool *p, imk_ferraris *f)
{
    for (int i = 0; i < 3; i++) {
        const double up = p->samples[i][0], down = p->samples[i][1];
        f->accel.bias[i] =
            0.5 * (p->sum[i][0][IMK_ACCEL][i] / up + p->sum[i][1][IMK_ACCEL][i] / down);
        f->accel.bias_sigma[i] = 0.5 * sqrt(p->variance[i][0][IMK_ACCEL][i] / (up * up) +
                                            p->variance[i][1][IMK_ACCEL][i] / (down * down));
        double sum = 0.0, variance = 0.0, samples = 0.0;
        for (int a = 0; a < 3; a++)
            for (int d = 0; d < 2; d++) {
                sum += p->sum[a][d][IMK_GYRO][i];
                variance += p->variance[a][d][IMK_GYRO][i];
                samples += p->samples[a][d];
            }
        f->gyro.bias[i] = sum / samples;
        f->gyro.bias_sigma[i] = sqrt(variance) / samples;
    }
}

/* Density of the gyros' noise by the holds [reading^2 s]: a sum's variance over its length. */
static double noise_density(const pool *p, double dt, int i)
{
    double variance = 0.0, samples = 0.0;
    for (int a = 0; a < 3; a++)
        for (int d = 0; d < 2; d++) {
            variance += p->variance[a][d][IMK_GYRO][i];
            samples += p->samples[a][d];
        }
    return variance / samples * dt;
}

/* M of the gyros from the turns. */
static void solve_turns(const pool *p, double dt, imk_matrix3 to_force, double angle_sigma,
                        const imk_ferraris *f, double m[3][3], double variance[3][3])
{
    for (int j = 0; j < 3; j++) {
        imk_vector3 force; /* its integral [m/s] */
        for (int i = 0; i < 3; i++)
            force.v[i] = p->reading[j][IMK_ACCEL][i] - f->accel.bias[i] * p->duration[j];
        force = imk_matrix3_apply(to_force, force);
        for (int i = 0; i < 3; i++) {
            double rest = f->gyro.bias[i] * p->duration[j];
            double v = noise_density(p, dt, i) * p->time[j] + f->gyro.bias_sigma[i] *
                                                                  f->gyro.bias_sigma[i] *
                                                                  p->duration[j] * p->duration[j];
            for (int l = 0; l < 3; l++) {
                const double s = f->g_sensitivity_sigma[i][l] * force.v[l];
                rest += f->g_sensitivity[i][l] * force.v[l];
                v += s * s;
            }
            m[i][j] = (p->reading[j][IMK_GYRO][i] - rest) / p->turned[j];
            /* Each turn ends somewhere else; the response to its own rate scales that. */
            const double end = m[i][j] * angle_sigma;
            variance[i][j] = (v + end * end * p->turns[j]) / (p->turned[j] * p->turned[j]);
        }
    }
}

imk_status imk_ferraris_closed_form(const imk_test_record *record, size_t count,
                                    const imk_ferraris_stretch *stretch, double gravity,
                                    double turn_angle, double angle_sigma, imk_ferraris *result,
                                    imk_error *error)
{
    pool p;
    imk_ferraris f;
    double m[3][3], variance[3][3], g_variance[3][3];
    if (record->axis_count[IMK_GYRO] != 3 || record->axis_count[IMK_ACCEL] != 3)
        return imk_error_set(error, IMK_ERROR_KEY_MISSING,
                             record->axis_count[IMK_GYRO] != 3 ? "gyro" : "accel", NULL,
                             "three gyros and three accelerometers");
    if (!(gravity > 0.0) || !(fabs(turn_angle) > 0.0) || !(angle_sigma >= 0.0) ||
        !isfinite(gravity + turn_angle + angle_sigma))
        return imk_error_set(
            error, IMK_ERROR_RANGE, "gravity, turn_angle, angle_sigma", NULL,
            "use a gravity above 0, an angle other than 0 and a sigma of 0 or more");
    const imk_status status = gather(record, count, stretch, turn_angle, &p, error);
    if (status != IMK_OK)
        return status;
    memset(&f, 0, sizeof f);
    solve_biases(&p, &f);
    half_differences(&p, IMK_GYRO, gravity, f.g_sensitivity, g_variance);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            f.g_sensitivity_sigma[i][j] = sqrt(g_variance[i][j]);
    half_differences(&p, IMK_ACCEL, gravity, m, variance);
    imk_matrix3 response, to_force;
    memcpy(response.m, m, sizeof m);
    if (!split_rows(m, variance, &f.accel))
        return imk_error_set(error, IMK_ERROR_NOT_FINITE, "accel", NULL,
                             "check that every axis has readings in every hold");
    if (imk_matrix3_inverse(response, &to_force) != IMK_OK)
        return imk_error_set(
            error, IMK_ERROR_SINGULAR, "accel", NULL,
            "check the accelerometers: their readings do not distinguish the six holds");
    solve_turns(&p, record->dt, to_force, angle_sigma, &f, m, variance);
    if (!split_rows(m, variance, &f.gyro))
        return imk_error_set(error, IMK_ERROR_NOT_FINITE, "gyro", NULL,
                             "check that every axis has readings in every hold and turn");
    *result = f;
    return IMK_OK;
}

/* ---- to and from a model ----------------------------------------------------------------------
 */

static double per_unit(const imk_triad *triad, int i)
{
    return triad->sensitivity.value[i] != 0.0 ? triad->sensitivity.value[i] : 1.0;
}

static void triad_to_model(const imk_ferraris_triad *from, imk_triad *to)
{
    for (int i = 0; i < 3; i++) {
        const double s = per_unit(to, i), k = from->scale[i];
        to->bias.fixed.value[i] = (from->bias[i] - to->zero_offset.value[i]) / s;
        to->bias.fixed.sigma[i] = from->bias_sigma[i] / fabs(s);
        for (int j = 0; j < 3; j++) {
            /* M_ij = K_i R_ij; their covariance is R_ij (var M_ij - var K_i)/K_i, next to
             * nothing: one of the factors always is. */
            const double of_k = from->axes[i][j] * from->scale_sigma[i],
                         of_r = k * from->axes_sigma[i][j];
            const double sigma = sqrt(of_k * of_k + of_r * of_r) / fabs(s);
            const double m = k * from->axes[i][j] / s;
            to->misalignment.value[i][j] = i == j ? 0.0 : m;
            to->misalignment.sigma[i][j] = i == j ? 0.0 : sigma;
            to->cross_axis.value[i][j] = to->cross_axis.sigma[i][j] = 0.0;
            if (i == j) {
                to->scale_factor.fixed.value[i] = m - 1.0;
                to->scale_factor.fixed.sigma[i] = sigma;
            }
        }
    }
}

void imk_ferraris_to_model(const imk_ferraris *ferraris, imk_model *model)
{
    triad_to_model(&ferraris->gyro, &model->gyro);
    triad_to_model(&ferraris->accel, &model->accel);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const double s = per_unit(&model->gyro, i);
            model->gyro.g_sensitivity.value[i][j] = ferraris->g_sensitivity[i][j] / s;
            model->gyro.g_sensitivity.sigma[i][j] = ferraris->g_sensitivity_sigma[i][j] / fabs(s);
        }
}

static void triad_from_model(const imk_triad *from, imk_ferraris_triad *to)
{
    double m[3][3];
    double none[3][3] = {{0.0}};
    for (int i = 0; i < 3; i++) {
        const double s = per_unit(from, i);
        to->bias[i] = s * from->bias.fixed.value[i] + from->zero_offset.value[i];
        for (int j = 0; j < 3; j++)
            m[i][j] = s * ((i == j ? 1.0 + from->scale_factor.fixed.value[i] : 0.0) +
                           from->misalignment.value[i][j] + from->cross_axis.value[i][j]);
    }
    (void)split_rows(m, none, to);
}

void imk_ferraris_from_model(const imk_model *model, imk_ferraris *ferraris)
{
    memset(ferraris, 0, sizeof *ferraris);
    triad_from_model(&model->gyro, &ferraris->gyro);
    triad_from_model(&model->accel, &ferraris->accel);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            ferraris->g_sensitivity[i][j] =
                per_unit(&model->gyro, i) * model->gyro.g_sensitivity.value[i][j];
}
