/* SPDX-License-Identifier: Apache-2.0 */
/* An extended Kalman filter end to end with the noise that `imukit tune` finds: is it consistent?
 *
 * usage: filter_closed_loop [runs]
 *
 * The filter has attitude, velocity, position and the biases of gyros and accelerometers, is
 * updated by positions (1 Hz, 0.1 m) and fed back; its start is drawn from its own covariance, the
 * biases from the model's repeatability. For each motion and sensor, and the noise of the data
 * sheet, ten times that, fit and safe, with the bias known and (the last two) learned: NEES over
 * its degrees of freedom just before each update from 5 s on, of attitude, velocity, position and
 * of all nine together, the root mean square of the position error, and the share of errors beyond
 * the 95 % ellipsoid. These are figures to look at: the noise is made for increments, and nothing
 * promises that a filter with updates, which learns a scale factor as a bias, is consistent with
 * it. */
#include "filter_motions.h"
#include "imukit/imukit.h"
#include "imukit/io.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { STATES = 15, RATE = 200, CHANNELS = 6 };

static const char *const sensors[3] = {"control", "AHRS", "tactical"};
enum { FILTERS = 6 };
static const imk_filter_answer_kind kinds[FILTERS] = {IMK_FILTER_STATED, IMK_FILTER_TENFOLD,
                                                      IMK_FILTER_FIT,    IMK_FILTER_SAFE,
                                                      IMK_FILTER_FIT,    IMK_FILTER_SAFE};
static const double start_sigma[3] = {0.01, 0.05, 0.1}; /* rad, m/s, m */
static const double fix_sigma = 0.1;                    /* m */

typedef struct filter {
    imk_strapdown strapdown;
    double bias[6], p[STATES][STATES];
} filter;

typedef struct sums {
    double nees[4], beyond, squares; /* attitude, velocity, position, all */
    size_t count;
} sums;

static void *memory_of(size_t size)
{
    void *memory = calloc(1, size);
    if (!memory) {
        fprintf(stderr, "filter_closed_loop: no memory\n");
        exit(2);
    }
    return memory;
}

/* ---- the filter ---- */

static void start_strapdown(filter *f, const imk_navigation_state *state)
{
    f->strapdown = imk_strapdown_start(state);
    f->strapdown.samples = 1;
}

/* rows i … i + 2 of a += [v x] rows j … of b, times factor */
static void add_cross(double a[STATES][STATES], int i, const double v[3], double b[STATES][STATES],
                      int j, double factor)
{
    for (int r = 0; r < 3; r++)
        for (int k = 0; k < STATES; k++)
            a[i + r][k] += factor * (v[(r + 1) % 3] * b[j + (r + 2) % 3][k] -
                                     v[(r + 2) % 3] * b[j + (r + 1) % 3][k]);
}

/* F p for F h of the errors in Earth-fixed axes, biases counted as estimate minus truth. */
static void rates(const imk_matrix3 *c, const double force[3], double p[STATES][STATES],
                  double out[STATES][STATES])
{
    const double earth[3] = {0.0, 0.0, IMK_EARTH_RATE};
    memset(out, 0, STATES * sizeof *out);
    add_cross(out, 0, earth, p, 0, -1.0);
    add_cross(out, 3, force, p, 0, -1.0);
    add_cross(out, 3, earth, p, 3, -2.0);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < STATES; k++) {
            for (int j = 0; j < 3; j++) {
                out[i][k] -= c->m[i][j] * p[9 + j][k];
                out[3 + i][k] -= c->m[i][j] * p[12 + j][k];
            }
            out[6 + i][k] += p[3 + i][k];
        }
}

static void transpose(double p[STATES][STATES])
{
    for (int i = 0; i < STATES; i++)
        for (int j = 0; j < i; j++) {
            const double swap = p[i][j];
            p[i][j] = p[j][i];
            p[j][i] = swap;
        }
}

/* p <- phi p phi^T + q, phi to second order. */
static void predict(filter *f, const imk_matrix3 *c, const double force[3], double h,
                    const imk_filter_parameters *n)
{
    for (int side = 0; side < 2; side++) {
        double once[STATES][STATES], twice[STATES][STATES];
        rates(c, force, f->p, once);
        rates(c, force, once, twice);
        for (int i = 0; i < STATES; i++)
            for (int j = 0; j < STATES; j++)
                f->p[i][j] += h * once[i][j] + 0.5 * h * h * twice[i][j];
        transpose(f->p);
    }
    for (int i = 0; i < 3; i++) {
        f->p[i][i] += h * n->white[0][0] * n->white[0][0];
        f->p[3 + i][3 + i] += h * n->white[1][0] * n->white[1][0];
        f->p[9 + i][9 + i] += h * n->walk[0][0] * n->walk[0][0];
        f->p[12 + i][12 + i] += h * n->walk[1][0] * n->walk[1][0];
    }
}

static void take(filter *f, const double reading[6], double h, const imk_filter_parameters *n)
{
    imk_vector3 angle, velocity, force;
    const imk_matrix3 c = imk_quaternion_to_matrix(f->strapdown.state.attitude);
    for (int i = 0; i < 3; i++) {
        angle.v[i] = (reading[i] - f->bias[i]) * h;
        force.v[i] = reading[3 + i] - f->bias[3 + i];
        velocity.v[i] = force.v[i] * h;
    }
    predict(f, &c, imk_matrix3_apply(c, force).v, h, n);
    imk_strapdown_step(&f->strapdown, h, angle, velocity);
}

/* One axis of a position after the other. */
static void update(filter *f, const imk_vector3 *fix)
{
    double x[STATES] = {0.0};
    imk_navigation_state state = f->strapdown.state;
    for (int axis = 0; axis < 3; axis++) {
        double gain[STATES], row[STATES];
        const double s = f->p[6 + axis][6 + axis] + fix_sigma * fix_sigma;
        const double z = state.position.v[axis] - fix->v[axis] - x[6 + axis];
        memcpy(row, f->p[6 + axis], sizeof row);
        for (int i = 0; i < STATES; i++) {
            gain[i] = row[i] / s;
            x[i] += gain[i] * z;
        }
        for (int i = 0; i < STATES; i++)
            for (int j = 0; j < STATES; j++)
                f->p[i][j] -= gain[i] * row[j];
    }
    for (int i = 0; i < 3; i++) {
        state.position.v[i] -= x[6 + i];
        state.velocity.v[i] -= x[3 + i];
        f->bias[i] -= x[9 + i];
        f->bias[3 + i] -= x[12 + i];
    }
    const imk_vector3 back = {{-x[0], -x[1], -x[2]}};
    state.attitude =
        imk_quaternion_multiply(imk_quaternion_from_rotation_vector(back), state.attitude);
    start_strapdown(f, &state);
}

/* ---- its errors ---- */

/* e^T P^-1 e of `count` states from `first` on. */
static double square(filter *f, const double *e, int first, int count)
{
    double l[81], x[9];
    for (int i = 0; i < count; i++) {
        x[i] = e[first + i];
        for (int j = 0; j < count; j++)
            l[i * count + j] = f->p[first + i][first + j];
    }
    if (imk_cholesky_factor((size_t)count, l) != IMK_OK)
        return (double)NAN;
    imk_cholesky_solve((size_t)count, l, x);
    double sum = 0.0;
    for (int i = 0; i < count; i++)
        sum += x[i] * e[first + i];
    return sum;
}

static void judge(filter *f, const imk_motion_state *truth, sums *s)
{
    const imk_navigation_state *state = &f->strapdown.state;
    double e[9];
    const imk_vector3 psi = imk_quaternion_to_rotation_vector(
        imk_quaternion_multiply(state->attitude, imk_quaternion_conjugate(truth->attitude)));
    for (int i = 0; i < 3; i++) {
        e[i] = psi.v[i];
        e[3 + i] = state->velocity.v[i] - truth->velocity.v[i];
        e[6 + i] = state->position.v[i] - truth->position.v[i];
        s->squares += e[6 + i] * e[6 + i];
    }
    for (int block = 0; block < 3; block++)
        s->nees[block] += square(f, e, 3 * block, 3) / 3.0;
    const double all = square(f, e, 0, 9);
    s->nees[3] += all / 9.0;
    s->beyond += all > imk_chi_square_quantile(0.95, 9.0);
    s->count++;
}

/* ---- a run ---- */

static void start(filter *f, const imk_motion_state *truth, const imk_model *model,
                  const double normal[9])
{
    imk_navigation_state state = {
        .position = truth->position, .velocity = truth->velocity, .attitude = truth->attitude};
    imk_vector3 turn;
    memset(f, 0, sizeof *f);
    for (int i = 0; i < 3; i++) {
        turn.v[i] = start_sigma[0] * normal[i];
        state.velocity.v[i] += start_sigma[1] * normal[3 + i];
        state.position.v[i] += start_sigma[2] * normal[6 + i];
        for (int block = 0; block < 3; block++)
            f->p[3 * block + i][3 * block + i] = start_sigma[block] * start_sigma[block];
        for (int sensor = 0; sensor < 2; sensor++) {
            const imk_triad *triad = imk_model_triad(model, sensor);
            const double r = triad->bias.repeatability.value[i];
            const double b = triad->noise.bias_instability.value[i];
            f->p[9 + 3 * sensor + i][9 + 3 * sensor + i] = r * r + 4.0 * b * b;
        }
    }
    state.attitude =
        imk_quaternion_multiply(imk_quaternion_from_rotation_vector(turn), state.attitude);
    start_strapdown(f, &state);
}

static void run(const imk_trajectory *trajectory, const imk_model *model,
                const imk_filter_parameters numbers[FILTERS], size_t rows, uint32_t number,
                sums out[FILTERS])
{
    const imk_random random = imk_random_seeded(77);
    imk_simulation simulation = imk_simulation_default();
    simulation.rate = RATE;
    simulation.seed = 77;
    simulation.run = number;
    simulation.motion.trajectory = trajectory;
    const size_t size = imk_simulator_size(model, &simulation);
    void *memory = memory_of(size);
    double *column[CHANNELS], normal[9];
    imk_simulator *simulator;
    imk_error error;
    for (int i = 0; i < CHANNELS; i++)
        column[i] = memory_of(rows * sizeof(double));
    if (imk_simulator_start(model, &simulation, &simulator, memory, size, &error) != IMK_OK)
        exit(2);
    imk_simulator_next(simulator, rows, column, NULL);
    imk_random_normals(random, imk_stream(number, 4711, 0, 0), 0, 9, normal);
    double first, last;
    imk_trajectory_span(trajectory, &first, &last);
    for (int k = 0; k < FILTERS; k++) {
        filter f;
        imk_motion_state truth;
        imk_trajectory_state(trajectory, first, &truth);
        start(&f, &truth, model, normal);
        for (size_t row = 1; row < rows; row++) {
            double reading[6];
            for (int i = 0; i < CHANNELS; i++)
                reading[i] = column[i][row];
            take(&f, reading, 1.0 / RATE, &numbers[k]);
            if (row % RATE != 0)
                continue;
            double noise[3];
            imk_trajectory_state(trajectory, first + (double)row / RATE, &truth);
            if (row >= 5 * RATE)
                judge(&f, &truth, &out[k]);
            imk_random_normals(random, imk_stream(number, 4711, 1, 0), row, 3, noise);
            imk_vector3 fix = truth.position;
            for (int i = 0; i < 3; i++)
                fix.v[i] += fix_sigma * noise[i];
            update(&f, &fix);
        }
    }
    for (int i = 0; i < CHANNELS; i++)
        free(column[i]);
    free(memory);
}

static void study(const imk_trajectory *trajectory, const imk_model *model, uint32_t runs,
                  const imk_executor *executor)
{
    imk_filter_tuning_settings settings = imk_filter_tuning_default();
    imk_filter_tuning *tuning;
    imk_error error;
    double first, last;
    sums s[FILTERS] = {{{0.0}, 0.0, 0.0, 0}};
    imk_filter_parameters numbers[FILTERS];
    settings.motion_count = 1;
    settings.motion[0].trajectory = trajectory;
    settings.from = 0.01;
    settings.to = 1.0; /* the time between updates */
    settings.rate = RATE;
    for (int learned = 0; learned < 2; learned++) {
        settings.learned = learned == 1;
        const size_t size = imk_filter_tuning_size(model, &settings);
        void *memory = memory_of(size);
        if (imk_filter_tuning_run(model, &settings, executor, &tuning, memory, size, &error) !=
            IMK_OK) {
            fprintf(stderr, "filter_closed_loop: %s\n", error.expected);
            exit(2);
        }
        for (int k = learned ? 4 : 0; k < (learned ? FILTERS : 4); k++)
            numbers[k] = tuning->answer[kinds[k]].parameters;
        free(memory);
    }
    imk_trajectory_span(trajectory, &first, &last);
    if (isinf(last)) /* it ends at rest */
        last = trajectory->piece[trajectory->piece_count - 1].start;
    for (uint32_t r = 0; r < runs; r++)
        run(trajectory, model, numbers, (size_t)((last - first) * RATE), r, s);
    for (int k = 0; k < FILTERS; k++) {
        const double n = (double)s[k].count;
        printf("  %-8s%-16s %9.3g %10.3g %10.3g %10.3g %12.3f %9.1f %%\n",
               k < 4 ? "known" : "learned", imk_filter_answer_name(kinds[k]), s[k].nees[0] / n,
               s[k].nees[1] / n, s[k].nees[2] / n, s[k].nees[3] / n, sqrt(s[k].squares / n),
               100.0 * s[k].beyond / n);
    }
    fflush(stdout);
}

int main(int count, char **words)
{
    const uint32_t runs = count > 1 ? (uint32_t)strtoul(words[1], NULL, 10) : 20;
    imk_model *model = memory_of(sizeof *model);
    imk_thread_pool *pool = imk_thread_pool_create(0);
    const imk_executor executor = imk_thread_pool_executor(pool);
    for (size_t m = 0; m < FILTER_MOTIONS; m++) {
        imk_motion_file *motion;
        imk_error error;
        if (imk_motion_parse(filter_motions[m].text, strlen(filter_motions[m].text), NULL, 1,
                             &motion, &error) != IMK_OK)
            return 2;
        for (int s = 0; s < 3; s++) {
            imk_device_model(imk_device_find(sensors[s]), model);
            printf("%s, %s\n                            attitude   velocity   position        all"
                   "  position [m]    beyond\n",
                   filter_motions[m].name, sensors[s]);
            study(imk_motion_file_motion(motion)->trajectory, model, runs, &executor);
        }
        imk_motion_file_free(motion);
    }
    imk_thread_pool_destroy(pool);
    free(model);
    return 0;
}
