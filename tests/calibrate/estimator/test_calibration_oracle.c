/* SPDX-License-Identifier: Apache-2.0 */
/* The same problems given to the estimator and to a solution that shares nothing with it,
 * tests/reference/calibration_oracle.py: one dense system of all unknowns, derivatives by
 * differences, the rates of turns multiplied up as exponentials. */
#define _DEFAULT_SOURCE
#include "calibrate/estimator_session.h"
#include "check.h"

#include "imukit/attitude.h"
#include "imukit/earth.h"

#include <stdio.h>
#include <unistd.h>

enum { TERMS = 15, ELEMENTS = 6, FIGURES = 9 };

/* ---- the problem as a file --------------------------------------------------------------------
 */

static void put(FILE *file, size_t count, const double *x)
{
    assert_int_equal(fwrite(x, sizeof *x, count, file), count);
}

static void put_model(FILE *file, const imk_model *model)
{
    const imk_triad *triads[2] = {&model->gyro, &model->accel};
    for (unsigned s = 0; s < 2; s++)
        for (unsigned term = 0; term < TERMS; term++)
            for (unsigned axis = 0; axis < IMK_AXES_MAX; axis++)
                for (unsigned k = 0; k < ELEMENTS; k++) {
                    const imk_model_parameter place = {(uint8_t)s, (uint8_t)term, (uint8_t)axis,
                                                       (uint8_t)k};
                    double x = imk_model_parameter_get(model, place);
                    x = isnan(x) ? 0.0 : x;
                    put(file, 1, &x);
                }
    for (int s = 0; s < 2; s++)
        put(file, 24, triads[s]->direction[0]);
    for (int s = 0; s < 2; s++) {
        const double count = triads[s]->axis_count;
        put(file, 1, &count);
    }
    for (int s = 0; s < 2; s++) {
        const imk_temperature_polynomial *both[2] = {&triads[s]->bias.temperature,
                                                     &triads[s]->scale_factor.temperature};
        for (int k = 0; k < 2; k++) {
            const double x[4] = {both[k]->order, both[k]->reference, both[k]->minimum,
                                 both[k]->maximum};
            put(file, 4, x);
        }
    }
}

static void put_observation(FILE *file, const imk_observation *o, double weight)
{
    const double head[2] = {o->knowledge, o->fixture};
    const double tail[4] = {o->temperature, o->temperature_rate, o->placement_sigma, weight};
    put(file, 2, head);
    put(file, 3, o->rate);
    put(file, 3, o->force);
    put(file, 3, o->angular_acceleration);
    put(file, 4, tail);
    put(file, 2 * IMK_AXES_MAX, o->reading[0]);
    put(file, 2 * IMK_AXES_MAX, o->sigma[0]);
}

/* As solved: with the factors and weights found. */
static void put_problem(FILE *file, const session *b)
{
    const imk_calibration *c = &b->calibration;
    const imk_test_record *record = c->record_count > 0 ? c->record[0] : NULL;
    const double head[9] = {c->gravity,
                            c->latitude,
                            c->earth_rate,
                            (double)c->parameter_count,
                            (double)c->fixture_count,
                            (double)c->observation_count,
                            (double)c->turn_count,
                            record ? (double)record->count : 0.0,
                            record ? record->dt : 0.0};
    put(file, 9, head);
    for (int g = 0; g < IMK_GROUPS; g++)
        put(file, 1, &b->result.group[g].factor);
    for (int g = 0; g < IMK_GROUP_TURN; g++)
        put(file, IMK_AXES_MAX, b->result.group[g].axis_factor);
    for (int g = 0; g < IMK_GROUP_TURN; g++)
        put(file, IMK_AXES_MAX, b->result.group[g].axis_added);
    const double assumed[2] = {b->result.placement.factor, b->result.assumed.factor};
    put(file, 2, assumed);
    put_model(file, &c->model);
    for (size_t p = 0; p < c->parameter_count; p++) {
        const imk_model_parameter at = c->parameter[p];
        const double x[5] = {at.sensor, at.term, at.axis, at.element, c->prior_sigma[p]};
        put(file, 5, x);
    }
    put(file, c->fixture_count, c->fixture_sigma);
    for (size_t i = 0; i < c->observation_count; i++)
        put_observation(file, &c->observation[i],
                        c->observation[i].weight > 0.0 ? 1.0 : 1e-8 /* as the estimator */);
    for (size_t t = 0; t < c->turn_count; t++) {
        const imk_turn *turn = &c->turn[t];
        const double x[7] = {turn->from,        turn->to,    (double)turn->begin,
                             (double)turn->end, turn->sigma, turn->weight > 0.0 ? 1.0 : 1e-8,
                             turn->earth_sigma};
        put(file, 7, x);
    }
    for (size_t k = 0; record && k < record->count; k++)
        for (int s = 0; s < 2; s++)
            for (int i = 0; i < 3; i++)
                put(file, 1, &record->reading[s][i][k]);
}

/* ---- theirs -----------------------------------------------------------------------------------
 */

typedef struct answer {
    double value[IMK_CORRELATED_MAX], covariance[IMK_CORRELATED_MAX * IMK_CORRELATED_MAX];
    double figure[IMK_GROUPS][3]; /* chi-square, redundancy, step of the factor squared */
} answer;

static int numbers(FILE *pipe, int count, double *x)
{
    int found = 0;
    while (found < count && fscanf(pipe, "%lf", &x[found]) == 1)
        found++;
    return found;
}

/* Skips without Python and NumPy. */
static void ask(const session *b, answer *a)
{
    static bool is_there;
    if (!is_there && system("/usr/bin/python3 -c 'import numpy' 2>/dev/null") != 0) {
        print_message("no /usr/bin/python3 with numpy (Debian: python3-numpy)\n");
        skip();
    }
    is_there = true;
    char path[] = "/tmp/imukit_test_XXXXXX", command[512];
    const int descriptor = mkstemp(path), n = (int)b->result.parameter_count;
    assert_true(descriptor >= 0);
    FILE *file = fdopen(descriptor, "wb");
    assert_non_null(file);
    put_problem(file, b);
    assert_int_equal(fclose(file), 0);
    snprintf(command, sizeof command,
             "OPENBLAS_NUM_THREADS=1 /usr/bin/python3 %s/tests/reference/calibration_oracle.py %s",
             SOURCE_DIRECTORY, path);
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    const int found = numbers(pipe, n, a->value) + numbers(pipe, n * n, a->covariance) +
                      numbers(pipe, FIGURES, a->figure[0]);
    assert_int_equal(pclose(pipe), 0);
    assert_int_equal(found, n + n * n + FIGURES);
    unlink(path);
}

/* `in_sigmas` of the estimates; `relative` of covariances (to the product of the sigmas), of
 * chi-square and redundancy; of what is still to do to the factors squared. */
static void compare(const char *what, const session *b, double in_sigmas, double relative,
                    double factors)
{
    static answer a;
    const imk_calibration_result *r = &b->result;
    const size_t n = r->parameter_count;
    double worst[4] = {0.0};
    ask(b, &a);
    for (size_t p = 0; p < n; p++) {
        worst[0] = fmax(worst[0], fabs(a.value[p] - r->value[p]) / r->sigma[p]);
        for (size_t q = 0; q < n; q++)
            worst[1] = fmax(worst[1], fabs(a.covariance[p * n + q] - r->covariance[p * n + q]) /
                                          (r->sigma[p] * r->sigma[q]));
    }
    for (int g = 0; g < IMK_GROUPS; g++) {
        const imk_group_fit *group = &r->group[g];
        if (group->count == 0)
            continue;
        worst[2] = fmax(worst[2], fabs(a.figure[g][0] / group->chi_square - 1.0));
        worst[2] = fmax(worst[2], fabs(a.figure[g][1] / group->degrees_of_freedom - 1.0));
        bool common = true; /* one factor, which is what is solved for */
        for (int axis = 0; axis < IMK_AXES_MAX; axis++)
            common = common && group->axis_factor[axis] == group->factor;
        if (common && group->factor != 1.0)
            worst[3] = fmax(worst[3], fabs(a.figure[g][2] - 1.0));
    }
    print_message("%s: estimates %.1e sigma, covariance %.1e, chi-square %.1e, factors %.1e\n",
                  what, worst[0], worst[1], worst[2], worst[3]);
    CHECK_BELOW(worst[0], in_sigmas);
    CHECK_BELOW(worst[1], relative);
    CHECK_BELOW(worst[2], relative);
    CHECK_BELOW(worst[3], factors);
}

/* ---- every kind of term -----------------------------------------------------------------------
 */

static imk_observation read_unit(session *b, const double rate[3], const double force[3],
                                 const double acceleration[3], double temperature,
                                 double temperature_rate)
{
    imk_distortion distortion;
    imk_stimulus stimulus;
    imk_observation o;
    memset(&o, 0, sizeof o);
    memset(&stimulus, 0, sizeof stimulus);
    CHECK_OK(imk_distortion_start(&distortion, &b->truth, NULL, IMK_KERNEL_SCALAR, NULL));
    for (int j = 0; j < 3; j++) {
        stimulus.angular_rate[j] = &rate[j];
        stimulus.specific_force[j] = &force[j];
        stimulus.angular_acceleration[j] = &acceleration[j];
    }
    if (!isnan(temperature)) {
        stimulus.temperature = &temperature;
        stimulus.temperature_rate = &temperature_rate;
    }
    o.temperature = temperature;
    o.temperature_rate = temperature_rate;
    o.record = o.fixture = -1;
    for (int sensor = 0; sensor < 2; sensor++)
        for (int axis = 0; axis < IMK_AXES_MAX; axis++) {
            o.reading[sensor][axis] = (double)NAN;
            o.sigma[sensor][axis] = 1.0;
            if (axis >= 3)
                continue;
            imk_distort(&distortion, sensor, axis, &stimulus, 1, &o.reading[sensor][axis]);
            o.sigma[sensor][axis] = b->sigma[sensor] / b->understated;
            o.reading[sensor][axis] += b->sigma[sensor] * session_normal(b);
        }
    return o;
}

/* Errors of every kind, of the size of a MEMS unit. */
static void worsen(imk_model *m)
{
    imk_triad *triads[2] = {&m->gyro, &m->accel};
    for (int i = 0; i < 3; i++) {
        m->accel.nonlinearity.k2.value[i] = 1e-4 * (i + 1);
        m->accel.nonlinearity.koq.value[i] = -2e-5 * (i - 2);
        m->accel.nonlinearity.k3.value[i] = 1e-6 * (i - 1.5);
        m->accel.nonlinearity.asymmetry.value[i] = 1e-3 * (i - 0.5);
        for (int j = 0; j < 3; j++) {
            m->accel.nonlinearity.cross_products.value[i][j] = 1e-5 * (i + j - 1.5);
            m->accel.lever_arm.value[i][j] = 0.01 * (i - j + 0.5);
            m->accel.misalignment.value[i][j] = i == j ? 0.0 : 0.002 * (i - 2 * j + 0.3);
        }
        for (int j = 0; j < 6; j++)
            m->gyro.g2_sensitivity.value[i][j] = 1e-6 * (i - j + 2);
        for (int s = 0; s < 2; s++) {
            triads[s]->bias.temperature_rate.value[i] = 0.1 * (i + 1 - 2 * s);
            triads[s]->bias.temperature.coefficient[0].value[i] = 1e-3 * (i - 1);
            triads[s]->bias.temperature.coefficient[1].value[i] = 1e-5 * (i + 1);
            triads[s]->scale_factor.temperature.coefficient[0].value[i] = 1e-5 * (i + 1);
        }
    }
    for (int s = 0; s < 2; s++) {
        imk_temperature_polynomial *p[2] = {&triads[s]->bias.temperature,
                                            &triads[s]->scale_factor.temperature};
        for (int k = 0; k < 2; k++) {
            p[k]->order = 2 - k;
            p[k]->reference = 298.15;
            p[k]->minimum = 253.15;
            p[k]->maximum = 333.15; /* some observations are beyond */
        }
    }
}

static void free_one(session *b, int sensor, int term, int axis, int element)
{
    CHECK_OK(imk_calibration_free(&b->calibration, sensor, term, axis, element));
}

static void free_every_kind(session *b)
{
    for (int s = 0; s < 2; s++) {
        session_free_term(b, s, IMK_MODEL_BIAS, false);
        session_free_term(b, s, IMK_MODEL_SCALE_FACTOR, false);
        session_free_term(b, s, IMK_MODEL_MISALIGNMENT, false);
        free_one(b, s, IMK_MODEL_BIAS_TEMPERATURE, s, 0);
        free_one(b, s, IMK_MODEL_BIAS_TEMPERATURE, s, 1);
        free_one(b, s, IMK_MODEL_SCALE_TEMPERATURE, 2, 0);
        free_one(b, s, IMK_MODEL_TEMPERATURE_RATE, 1, 0);
    }
    free_one(b, IMK_ACCEL, IMK_MODEL_K2, 0, 0);
    free_one(b, IMK_ACCEL, IMK_MODEL_K2, 1, 0);
    free_one(b, IMK_ACCEL, IMK_MODEL_KOQ, 1, 0);
    free_one(b, IMK_ACCEL, IMK_MODEL_K3, 2, 0);
    free_one(b, IMK_ACCEL, IMK_MODEL_ASYMMETRY, 2, 0);
    for (int k = 0; k < 3; k++) {
        free_one(b, IMK_ACCEL, IMK_MODEL_CROSS_PRODUCTS, 1, k);
        free_one(b, IMK_ACCEL, IMK_MODEL_LEVER_ARM, 2, k);
        free_one(b, IMK_GYRO, IMK_MODEL_G_SENSITIVITY, 0, k);
    }
    for (int k = 0; k < 6; k++)
        free_one(b, IMK_GYRO, IMK_MODEL_G2_SENSITIVITY, 1, k);
    session_know_the_rest(b);
    b->calibration.prior_sigma[0] = 1e-3; /* known before, not too well */
}

/* Known inputs on two fixtures, placed ones, and gravity. */
static void expose_unit(session *b, int count)
{
    static const double mounting[2][3] = {{2e-3, -1e-3, 1.5e-3}, {-4e-3, 3e-3, 1e-3}};
    for (int i = 0; i < count; i++) {
        const int fixture = i % 2;
        const bool rest = i % 4 == 3, placed = i % 4 == 1;
        double rate[3], force[3], acceleration[3], vertical[3];
        session_unit_vector(b, vertical);
        for (int j = 0; j < 3; j++) {
            rate[j] = rest ? b->calibration.earth_rate * sin(b->place) * vertical[j]
                           : fmax(-6.0, fmin(6.0, 3.0 * session_normal(b)));
            force[j] = rest ? b->calibration.gravity * vertical[j] : 10.0 * session_normal(b);
            acceleration[j] = rest ? 0.0 : 20.0 * session_normal(b);
        }
        imk_vector3 nominal[3];
        memcpy(nominal[0].v, rate, sizeof rate);
        memcpy(nominal[1].v, force, sizeof force);
        memcpy(nominal[2].v, acceleration, sizeof acceleration);
        imk_vector3 seen[3];
        for (int v = 0; v < 3; v++) {
            imk_vector3 back = {{0}}, own = {{0}};
            for (int j = 0; j < 3 && !rest; j++) {
                back.v[j] = -mounting[fixture][j];
                own.v[j] = placed ? -1e-3 * b->normal[3 * i + j] : 0.0;
            }
            seen[v] = imk_quaternion_rotate(imk_quaternion_from_rotation_vector(back), nominal[v]);
            seen[v] = imk_quaternion_rotate(imk_quaternion_from_rotation_vector(own), seen[v]);
        }
        imk_observation o =
            read_unit(b, seen[0].v, seen[1].v, seen[2].v,
                      i % 9 == 8 ? (double)NAN : 248.0 + 90.0 * i / count, 0.02 * (i % 5 - 2));
        o.knowledge = rest ? IMK_INPUT_GRAVITY : placed ? IMK_INPUT_PLACED : IMK_INPUT_KNOWN;
        o.fixture = rest ? -1 : fixture;
        o.placement_sigma = placed ? 1e-3 : 0.0;
        memcpy(o.rate, rate, sizeof rate);
        memcpy(o.force, force, sizeof force);
        memcpy(o.angular_acceleration, acceleration, sizeof acceleration);
        if (i == 5)
            o.reading[IMK_ACCEL][1] = (double)NAN;
        (void)imk_calibration_observe(&b->calibration, &o);
    }
}

/* Differences of 1e-4 rad leave 1e-8 of a derivative; the last step is 1e-3 sigma at most, and what
 * it leaves the square of what it was. Factors are iterated to 1e-3. */
static void every_kind_of_term(void **state)
{
    (void)state;
    session *b = session_new(41, 1);
    imk_calibration *c = &b->calibration;
    c->frame = IMK_FRAME_REFERENCE;
    c->robust = false;
    c->fixture_count = 2;
    c->fixture_sigma[0] = 3e-3;
    c->fixture_sigma[1] = 1e-2;
    b->place = 0.0; /* at the equator: no vertical rate to take in */
    c->latitude = 0.0;
    c->earth_rate = 0.0;
    worsen(&b->truth);
    free_every_kind(b);
    expose_unit(b, 72);
    CHECK_OK(session_solve(b));
    compare("every kind of term", b, 1e-5, 1e-4, 4e-3);
    for (size_t p = 0; p < b->result.parameter_count; p++)
        CHECK_CLOSE(b->result.value[p], imk_model_parameter_get(&b->truth, b->result.parameter[p]),
                    6.0 * b->result.sigma[p]);
    session_free(b);
}

/* ---- poses under gravity ----------------------------------------------------------------------
 */

/* The Earth's variance of a gyro is that at the attitude of the start, up to 3e-2 rad from where it
 * is found; near the vertical, where it is small, some per cent of it. At the pole it is none. */
static void poses(const char *what, double latitude, int bad, double understated, double agree)
{
    session *b = session_new(42, 1);
    b->understated = understated;
    b->calibration.latitude = latitude;
    b->place = isnan(latitude) ? 0.8 : latitude;
    b->calibration.robust = bad > 0;
    session_free_static(b);
    session_know_the_rest(b);
    for (int i = 0; i < 24; i++)
        session_pose(b, i < bad ? 1.03 : 1.0);
    CHECK_OK(session_solve(b));
    assert_int_equal(b->result.observations_refused, bad);
    for (int g = 0; g < IMK_GROUP_TURN; g++)
        assert_int_equal(b->result.group[g].refused, 3 * bad);
    compare(what, b, agree, agree, fmax(3.0 * agree, 4e-3));
    session_free(b);
}

static void poses_under_gravity(void **state)
{
    (void)state;
    const double pole = 1.5707963267948966;
    poses("poses", 0.8, 0, 1.0, 0.03);
    poses("poses at the pole", pole, 0, 1.0, 1e-4);
    poses("poses of unknown latitude", (double)NAN, 0, 1.0, 0.03);
    poses("poses, sigmas too small", pole, 0, 2.5, 1e-4);
    poses("poses, three bad", pole, 3, 1.0, 1e-4);
}

/* ---- turns ------------------------------------------------------------------------------------
 */

enum { TURN_POSES = 16, TURN_SAMPLES = 100 };

/* The unit turns by w against the Earth, whose rate has the part `horizontal` of its own. */
static void turns(const char *what, double earth_rate, double gyro_sigma, double agree)
{
    session *b = session_new(43, 1);
    imk_calibration *c = &b->calibration;
    static double reading[2][3][TURN_POSES * TURN_SAMPLES];
    const double dt = 0.01;
    b->sigma[IMK_GYRO] = gyro_sigma;
    c->earth_rate = earth_rate;
    c->robust = false;
    session_free_static(b);
    session_free_term(b, IMK_GYRO, IMK_MODEL_SCALE_FACTOR, false);
    session_free_term(b, IMK_GYRO, IMK_MODEL_MISALIGNMENT, false);
    session_know_the_rest(b);
    imk_test_record record = {.name = "turns", .dt = dt, .axis_count = {3, 3}};
    for (int s = 0; s < 2; s++)
        for (int i = 0; i < 3; i++)
            record.reading[s][i] = reading[s][i];
    const double up = earth_rate * sin(b->place), across = earth_rate * cos(b->place);
    const double earth_sigma = sqrt(0.5) * across * dt * TURN_SAMPLES;
    double vertical[3], horizontal[3], any[3];
    size_t k = 0;
    session_unit_vector(b, vertical);
    session_unit_vector(b, any);
    const imk_vector3 level =
        imk_vector3_cross((imk_vector3){{any[0], any[1], any[2]}},
                          (imk_vector3){{vertical[0], vertical[1], vertical[2]}});
    for (int j = 0; j < 3; j++)
        horizontal[j] = across * level.v[j] / imk_vector3_norm(level);
    for (int pose = 0; pose < TURN_POSES; pose++) {
        double still[3], force[3], axis[3];
        for (int j = 0; j < 3; j++) {
            still[j] = up * vertical[j] + horizontal[j];
            force[j] = c->gravity * vertical[j];
        }
        imk_observation o = session_read(b, still, force, NULL, (double)NAN);
        o.knowledge = IMK_INPUT_GRAVITY;
        o.record = 0;
        memset(o.force, 0, sizeof o.force);
        assert_int_equal(imk_calibration_observe(c, &o), pose);
        if (pose + 1 == TURN_POSES)
            break;
        session_unit_vector(b, axis);
        double w[3], back[3];
        for (int j = 0; j < 3; j++) {
            w[j] = (0.8 + 0.1 * pose) * axis[j];
            back[j] = -w[j] * dt;
        }
        const imk_quaternion step =
            imk_quaternion_from_rotation_vector((imk_vector3){{back[0], back[1], back[2]}});
        c->turn[pose] = (imk_turn){.from = pose,
                                   .to = pose + 1,
                                   .begin = k,
                                   .end = k + TURN_SAMPLES,
                                   .sigma = sqrt(4e-8 + earth_sigma * earth_sigma),
                                   .earth_sigma = earth_sigma};
        for (int n = 0; n < TURN_SAMPLES; n++, k++) {
            double rate[3];
            for (int j = 0; j < 3; j++) {
                rate[j] = w[j] + up * vertical[j] + horizontal[j];
                force[j] = c->gravity * vertical[j];
            }
            const imk_observation turning = session_read(b, rate, force, NULL, (double)NAN);
            imk_vector3 v = {{vertical[0], vertical[1], vertical[2]}};
            imk_vector3 h = {{horizontal[0], horizontal[1], horizontal[2]}};
            v = imk_quaternion_rotate(step, v);
            h = imk_quaternion_rotate(step, h);
            memcpy(vertical, v.v, sizeof vertical);
            memcpy(horizontal, h.v, sizeof horizontal);
            for (int s = 0; s < 2; s++)
                for (int i = 0; i < 3; i++)
                    reading[s][i][k] = turning.reading[s][i];
        }
    }
    record.count = k;
    c->record[c->record_count++] = &record;
    c->turn_count = TURN_POSES - 1;
    CHECK_OK(session_solve(b));
    compare(what, b, agree, agree, 4e-3);
    if (gyro_sigma < 1e-4)
        CHECK_CLOSE(b->result.group[IMK_GROUP_TURN].factor, 1.0, 0.0);
    session_free(b);
}

/* Derivatives take a step's attitude as the mean of both ends: (w dt)^2/12, 4e-5, of what a
 * parameter does, and turns are integrated again at 0.01 sigma. The stated sigma of the turns is
 * larger than their errors; where gyros at rest are good, turns lose their redundancy to the poses
 * as their factor falls, and keep the sigma stated. */
static void turns_between_poses(void **state)
{
    (void)state;
    turns("turns", 0.0, 3e-5, 1e-3);
}

/* Poor gyros take the Earth's horizontal rate as a variance, good ones have it as unknowns that the
 * turns carry on. */
static void turns_on_the_earth(void **state)
{
    (void)state;
    turns("turns, heading a variance", IMK_EARTH_RATE, 4e-4, 1e-3);
    turns("turns, heading unknown", IMK_EARTH_RATE, 3e-5, 1e-3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kind_of_term),
        cmocka_unit_test(poses_under_gravity),
        cmocka_unit_test(turns_between_poses),
        cmocka_unit_test(turns_on_the_earth),
    };
    return cmocka_run_group_tests_name("calibration_oracle", tests, NULL, NULL);
}
