/* SPDX-License-Identifier: Apache-2.0 */
/* What a Kalman filter needs of a model, as text: continuous densities, the same noises per sample
 * at a stated rate, bias states, and the matrices F, Q_c, Phi, Q_d of each axis (filter_noise.h).
 *
 * The numbers of the model are read back; the matrices and everything that follows from the numbers
 * and the rate are not, nor are states that stand for bias instability. */
#include "parameter_internal.h"

#include "imukit/filter_noise.h"

#include <math.h>
#include <string.h>

static const char *const units[2][6] = {
    {"rad/s", "rad/s/sqrt(Hz)", "rad/s^2/sqrt(Hz)", "rad", "rad/s", "rad/sqrt(Hz)"},
    {"m/s^2", "m/s^2/sqrt(Hz)", "m/s^3/sqrt(Hz)", "m/s", "m/s^2", "m/s/sqrt(Hz)"}};
enum { UNIT_READING, UNIT_WHITE, UNIT_DRIVING, UNIT_INTEGRAL, UNIT_BIAS, UNIT_INTEGRAL_WHITE };

static const char *const sources[] = {[IMK_FILTER_FROM_RANDOM_WALK] = "random_walk",
                                      [IMK_FILTER_FROM_GAUSS_MARKOV] = "gauss_markov",
                                      [IMK_FILTER_FROM_BIAS_INSTABILITY] = "bias_instability",
                                      [IMK_FILTER_FROM_CONSTANT] = "constant"};

/* ---- writing: one tree, as YAML with comments or as JSON ------------------------------------- */

typedef struct tree_writer {
    imki_parameters *p;
    int level;
    bool first; /* nothing yet in the innermost mapping or list */
} tree_writer;

static void begin_line(tree_writer *w)
{
    imki_text_add(&w->p->out, "%s\n%*s", w->p->is_json && !w->first ? "," : "", 2 * w->level, "");
    w->first = false;
}

static void put_key(tree_writer *w, const char *key)
{
    begin_line(w);
    imki_text_add(&w->p->out, w->p->is_json ? "\"%s\":" : "%s:", key);
}

static void open_branch(tree_writer *w, char bracket)
{
    if (w->p->is_json)
        imki_text_add(&w->p->out, " %c", bracket);
    w->level++;
    w->first = true;
}

static void close_branch(tree_writer *w, char bracket)
{
    w->level--;
    if (w->p->is_json)
        imki_text_add(&w->p->out, "\n%*s%c", 2 * w->level, "", bracket);
    w->first = false;
}

static void open_item(tree_writer *w)
{
    begin_line(w);
    if (!w->p->is_json)
        imki_text_add(&w->p->out, "-");
    open_branch(w, '{');
}

static void put_word(tree_writer *w, const char *key, const char *word)
{
    put_key(w, key);
    imki_text_add(&w->p->out, w->p->is_json ? " \"%s\"" : " %s", word);
}

static void put_comment(tree_writer *w, const char *unit, const char *meaning)
{
    if (!w->p->is_json)
        imki_text_add(&w->p->out, "  # [%s] %s", unit, meaning);
}

static void put_vector(tree_writer *w, const char *key, const double values[3], const char *unit,
                       const char *meaning)
{
    put_key(w, key);
    imki_text_add(&w->p->out, " ");
    imki_text_vector(&w->p->out, values);
    put_comment(w, unit, meaning);
}

static void put_square(tree_writer *w, const char *key, size_t n, const double *matrix)
{
    put_key(w, key);
    imki_text_add(&w->p->out, " [");
    for (size_t i = 0; i < n; i++) {
        imki_text_add(&w->p->out, i > 0 ? ", [" : "[");
        imki_text_numbers(&w->p->out, matrix + i * n, (int)n, ", ");
        imki_text_add(&w->p->out, "]");
    }
    imki_text_add(&w->p->out, "]");
}

/* ---- states ---------------------------------------------------------------------------------- */

/* The `instance`-th state of a source on an axis; NULL when it has fewer. */
static const imk_filter_state *find_state(const imk_filter_noise *noise, imk_filter_source source,
                                          int instance)
{
    for (int i = 0; i < noise->state_count; i++)
        if (noise->state[i].source == source && instance-- == 0)
            return &noise->state[i];
    return NULL;
}

/* One kind of state on three axes; zeros where an axis has none. @return false: none has */
static bool write_states(tree_writer *w, const imk_filter_noise noise[3], const char *const unit[5],
                         imk_filter_source source, int instance, double dt)
{
    double time[3] = {0}, sigma[3] = {0}, driving[3] = {0}, step[3] = {0}, phi[3] = {0};
    bool any = false, decays = false;
    for (int axis = 0; axis < 3; axis++) {
        const imk_filter_state *s = find_state(&noise[axis], source, instance);
        if (!s)
            continue;
        any = true;
        decays = decays || s->correlation_time < HUGE_VAL;
        const double a = dt / s->correlation_time;
        time[axis] = s->correlation_time < HUGE_VAL ? s->correlation_time : 0;
        sigma[axis] = s->sigma;
        driving[axis] = s->driving;
        phi[axis] = exp(-a);
        step[axis] = a > 0 ? s->driving * sqrt(-0.5 * s->correlation_time * expm1(-2 * a))
                           : s->driving * sqrt(dt);
    }
    if (!any)
        return false;
    open_item(w);
    put_word(w, "from", sources[source]);
    if (decays) {
        put_vector(w, "correlation_time", time, "s", "0: the axis has no such state");
        put_vector(w, "sigma", sigma, unit[UNIT_BIAS], "stationary");
    }
    put_vector(w, "driving_noise", driving, unit[UNIT_DRIVING],
               "continuous, two-sided: sigma_bc; Q_c holds its square");
    put_vector(w, "phi", phi, "1", "of one sample");
    put_vector(w, "driving_noise_per_sample", step, unit[UNIT_BIAS],
               decays ? "sigma_bd" : "sigma_bd = sigma_bc sqrt(dt)");
    close_branch(w, '}');
    return true;
}

/* One state of each axis by itself; driving 0: none. */
static void set_alone(imk_filter_noise *alone, imk_filter_state state)
{
    *alone = (imk_filter_noise){.state_count = state.driving > 0 ? 1 : 0};
    alone->state[0] = state;
}

/* Gauss-Markov terms by their number in the model, so that axes without one keep its place. */
static void write_markov_terms(tree_writer *w, const imk_triad *triad, const char *const unit[5],
                               double dt)
{
    for (int i = 0; i < triad->noise.gauss_markov_count; i++) {
        imk_filter_noise alone[3];
        for (int axis = 0; axis < 3; axis++) {
            const double sigma = triad->noise.gauss_markov[i].sigma.value[axis];
            const double time = triad->noise.gauss_markov[i].correlation_time.value[axis];
            set_alone(&alone[axis],
                      (imk_filter_state){.source = IMK_FILTER_FROM_GAUSS_MARKOV,
                                         .correlation_time = time,
                                         .driving = sigma > 0 ? sigma * sqrt(2 / time) : 0,
                                         .sigma = sigma});
        }
        write_states(w, alone, unit, IMK_FILTER_FROM_GAUSS_MARKOV, 0, dt);
    }
}

/* The two parts of a random walk: the model's K, and what stands for bias instability. */
static void write_walks(tree_writer *w, const imk_triad *triad, const imk_filter_noise noise[3],
                        const char *const unit[5], double dt)
{
    imk_filter_noise own[3], flicker[3];
    for (int axis = 0; axis < 3; axis++) {
        double part = 0;
        for (int i = 0; i < noise[axis].state_count; i++)
            part = fmax(part, noise[axis].state[i].flicker_walk);
        set_alone(&own[axis], (imk_filter_state){.source = IMK_FILTER_FROM_RANDOM_WALK,
                                                 .correlation_time = HUGE_VAL,
                                                 .driving = triad->noise.random_walk.value[axis]});
        set_alone(&flicker[axis], (imk_filter_state){.source = IMK_FILTER_FROM_BIAS_INSTABILITY,
                                                     .correlation_time = HUGE_VAL,
                                                     .driving = part});
    }
    write_states(w, own, unit, IMK_FILTER_FROM_RANDOM_WALK, 0, dt);
    write_states(w, flicker, unit, IMK_FILTER_FROM_BIAS_INSTABILITY, 0, dt);
}

static void write_axis(tree_writer *w, const imk_filter_noise *noise, const char *name, double dt)
{
    enum { SIZE = 1 + IMK_FILTER_STATES_MAX };
    double a[SIZE * SIZE], b[SIZE * SIZE];
    const size_t n = 1 + (size_t)noise->state_count;
    put_key(w, name);
    open_branch(w, '{');
    put_key(w, "states");
    imki_text_add(&w->p->out, w->p->is_json ? " [\"integral\"" : " [integral");
    for (int i = 0; i < noise->state_count; i++)
        imki_text_add(&w->p->out, w->p->is_json ? ", \"%s\"" : ", %s",
                      sources[noise->state[i].source]);
    imki_text_add(&w->p->out, "]");
    double initial[SIZE] = {0};
    for (int i = 0; i < noise->state_count; i++)
        initial[i + 1] = noise->state[i].initial;
    put_key(w, "initial_sigma");
    imki_text_add(&w->p->out, " [");
    imki_text_numbers(&w->p->out, initial, (int)n, ", ");
    imki_text_add(&w->p->out, "]");
    imk_filter_continuous(noise, a, b);
    put_square(w, "F", n, a);
    put_square(w, "Q_c", n, b);
    imk_filter_discrete(noise, dt, a, b);
    put_square(w, "Phi", n, a);
    put_square(w, "Q_d", n, b);
    close_branch(w, '}');
}

/* ---- sensors --------------------------------------------------------------------------------- */

static void note_what_is_lost(imki_parameters *p, const char *sensor,
                              const imk_filter_noise noise[3],
                              const imk_filter_noise_settings *settings)
{
    static const char *const as[] = {"a random walk", "a Gauss-Markov process",
                                     "two Gauss-Markov processes"};
    const imk_filter_noise *worst = &noise[0];
    bool quantized = false;
    for (int axis = 0; axis < 3; axis++) {
        worst = noise[axis].misfit > worst->misfit ? &noise[axis] : worst;
        quantized = quantized || noise[axis].quantization > 0 || noise[axis].reading_noise > 0 ||
                    noise[axis].angle_white > 0;
    }
    if (worst->misfit > 0 && settings->flicker != IMK_FILTER_FLICKER_LEFT_OUT)
        imki_note(p, false,
                  "%s: bias instability is approximated by %s; from %g s to %g s the Allan "
                  "deviation is off by up to %.0f %% (at %.0f s)",
                  sensor, as[settings->flicker], settings->from, settings->to, 100 * worst->misfit,
                  worst->misfit_tau);
    if (quantized)
        imki_note(p, false,
                  "%s: quantization, reading noise and white noise of the integral are measurement "
                  "noise of the integral (R of a filter), not process noise: Q does not contain "
                  "them",
                  sensor);
}

static void write_sensor(tree_writer *w, int kind)
{
    imki_parameters *p = w->p;
    const imk_triad *triad = p->origin[kind];
    const char *const *unit = units[kind];
    const double dt = 1 / p->settings->rate;
    imk_filter_noise noise[3];
    double white[3], sampled[3], angle[3], quantization[3], reading[3], angle_white[3];
    if (!triad->present)
        return;
    for (int axis = 0; axis < 3; axis++) {
        if (p->status == IMK_OK)
            p->status =
                imk_filter_noise_of(triad, axis, &p->settings->filter, &noise[axis], p->error);
        if (p->status != IMK_OK)
            return;
        white[axis] = noise[axis].white;
        sampled[axis] = white[axis] / sqrt(dt);
        angle[axis] = white[axis] * sqrt(dt);
        quantization[axis] = noise[axis].quantization;
        reading[axis] = noise[axis].reading_noise;
        angle_white[axis] = noise[axis].angle_white;
    }
    note_what_is_lost(p, imki_kind_names[kind], noise, &p->settings->filter);
    put_key(w, imki_kind_names[kind]);
    open_branch(w, '{');
    put_word(w, "unit", unit[UNIT_READING]);
    put_vector(w, "white_noise", white, unit[UNIT_WHITE],
               "continuous, two-sided: sigma_c; Q_c holds its square");
    put_vector(w, "white_noise_per_reading", sampled, unit[UNIT_READING],
               "sigma_d = sigma_c/sqrt(dt)");
    put_vector(w, "white_noise_per_step", angle, unit[UNIT_INTEGRAL],
               "of the integral: sigma_c sqrt(dt)");
    put_vector(w, "quantization", quantization, unit[UNIT_INTEGRAL],
               "1 sigma of each reading of the integral: measurement noise");
    put_vector(w, "reading_noise", reading, unit[UNIT_INTEGRAL],
               "the same, not of counting: the variances add up");
    put_vector(w, "integral_white_noise", angle_white, unit[UNIT_INTEGRAL_WHITE],
               "sigma of a reading of the integral: this/sqrt(dt), beside them");
    put_vector(w, "initial_bias_sigma", triad->bias.repeatability.value, unit[UNIT_BIAS],
               "from run to run");
    put_key(w, "bias_states");
    const size_t before = p->out.size;
    open_branch(w, '[');
    write_markov_terms(w, triad, unit, dt);
    write_walks(w, triad, noise, unit, dt);
    for (int i = 0; i < 2 && p->settings->filter.flicker != IMK_FILTER_FLICKER_RANDOM_WALK; i++)
        write_states(w, noise, unit, IMK_FILTER_FROM_BIAS_INSTABILITY, i, dt);
    if (!p->is_json && p->out.size == before)
        imki_text_add(&p->out, " []");
    close_branch(w, ']');
    for (int axis = 0; axis < 3; axis++)
        write_axis(w, &noise[axis], (const char[2]){(char)('x' + axis), '\0'}, dt);
    close_branch(w, '}');
}

static const char explanation[] =
    "# What a Kalman filter needs from a sensor model, per axis.\n"
    "#\n"
    "# Error states: x0, the integral of the axis' error, and its biases b_i:\n"
    "#     dx0/dt = sum b_i + w,    db_i/dt = -b_i/T_i + w_i    (a random walk: no -b_i/T_i)\n"
    "# Continuous: dx/dt = F x + w, w white of density Q_c (two-sided).\n"
    "# Discrete, over one sample of dt = 1/rate: x[k+1] = Phi x[k] + w[k], w[k] of covariance "
    "Q_d.\n"
    "#\n"
    "# The sqrt(dt) trap: a continuous density is not a standard deviation per sample.\n"
    "#     white noise of a reading:   sigma_d  = sigma_c / sqrt(dt)    larger at a higher rate\n"
    "#     random walk of a bias:      sigma_bd = sigma_bc * sqrt(dt)   smaller at a higher rate\n"
    "# Use the continuous numbers and let the filter convert them, or the numbers per sample, or\n"
    "# Q_d; never convert twice. At another rate only the continuous numbers still hold.\n"
    "#\n"
    "# A gyro's Q_d is in rad^2, rad^2/s and rad^2/s^2, an accelerometer's in m^2/s^2, m^2/s^3 "
    "and\n"
    "# m^2/s^4. x0 of the three gyros is the attitude error, of the accelerometers the velocity "
    "error.";

void imki_filter_write(imki_parameters *p)
{
    if (!(p->settings->rate > 0))
        imki_parameter_refuse(p, IMK_ERROR_KEY_MISSING, "rate",
                              "\"Phi\" and \"Q_d\" depend on the sampling rate, which is not known",
                              "add --rate RATE (samples per second, as 200Hz)");
    tree_writer w = {.p = p};
    if (p->is_json)
        imki_text_add(&p->out, "{");
    else
        imki_text_add(&p->out, "%s", explanation);
    w.level = p->is_json ? 1 : 0;
    w.first = true;
    put_key(&w, "imukit_filter");
    imki_text_add(&p->out, " 1");
    put_key(&w, "rate");
    imki_text_add(&p->out, " %s", imki_shortest(p->settings->rate).text);
    put_comment(&w, "Hz", "of the matrices and of the numbers per sample");
    for (int kind = 0; kind < 2; kind++)
        write_sensor(&w, kind);
    if (p->is_json)
        close_branch(&w, '}');
    imki_text_add(&p->out, "\n");
}

/* ---- reading --------------------------------------------------------------------------------- */

static void read_state(imki_parameters *p, int node, int kind, imk_triad *triad)
{
    const char *source = imki_node_text(p, imki_node_value(p, node, "from"));
    const char *const *unit = units[kind];
    double sigma[3] = {0}, time[3] = {0};
    if (strcmp(source, sources[IMK_FILTER_FROM_RANDOM_WALK]) == 0) {
        imki_node_accept(p, node, "driving_noise", kind, IMKI_RANDOM_WALK,
                         (imki_unit){unit[UNIT_DRIVING], 1}, triad->noise.random_walk.value);
    } else if (strcmp(source, sources[IMK_FILTER_FROM_GAUSS_MARKOV]) == 0) {
        imki_node_accept(p, node, "sigma", kind, IMKI_DRIFT, (imki_unit){unit[UNIT_BIAS], 1},
                         sigma);
        imki_node_accept(p, node, "correlation_time", kind, IMKI_PLAIN, (imki_unit){"s", 1}, time);
        if (triad->noise.gauss_markov_count == IMK_TERMS_MAX)
            imki_refuse_node(p, node, IMK_ERROR_RANGE, "bias_states",
                             "at most 8 Gauss-Markov states");
        else
            imki_add_gauss_markov(triad, sigma, time);
    } else if (strcmp(source, sources[IMK_FILTER_FROM_BIAS_INSTABILITY]) == 0) {
        imki_note(p, true, "a state that stands for bias instability is not read");
    } else {
        imki_refuse_node(p, node, IMK_ERROR_SYNTAX, "from",
                         "one of random_walk, gauss_markov, bias_instability");
    }
}

static void read_sensor(imki_parameters *p, int node, int kind)
{
    static const char *const known[] = {"unit",
                                        "white_noise",
                                        "white_noise_per_reading",
                                        "white_noise_per_step",
                                        "quantization",
                                        "reading_noise",
                                        "integral_white_noise",
                                        "initial_bias_sigma",
                                        "bias_states",
                                        "x",
                                        "y",
                                        "z"};
    imk_triad *triad = p->triad[kind];
    const char *const *unit = units[kind];
    imki_node_accept(p, node, "white_noise", kind, IMKI_WHITE, (imki_unit){unit[UNIT_WHITE], 1},
                     triad->noise.white.value);
    imki_node_accept(p, node, "quantization", kind, IMKI_PLAIN, (imki_unit){unit[UNIT_INTEGRAL], 1},
                     triad->noise.quantization.value);
    imki_node_accept(p, node, "reading_noise", kind, IMKI_PLAIN,
                     (imki_unit){unit[UNIT_INTEGRAL], 1}, triad->noise.reading_noise.value);
    imki_node_accept(p, node, "integral_white_noise", kind, IMKI_PLAIN,
                     (imki_unit){unit[UNIT_INTEGRAL_WHITE], 1}, triad->noise.angle_white.value);
    imki_node_accept(p, node, "initial_bias_sigma", kind, IMKI_BIAS,
                     (imki_unit){unit[UNIT_BIAS], 1}, triad->bias.repeatability.value);
    const int states = imki_node_value(p, node, "bias_states");
    if (imki_node_is(p, states, IMKI_NODE_SEQUENCE))
        for (int item = p->document->node[states].first; item != IMKI_NONE && p->status == IMK_OK;
             item = p->document->node[item].next)
            read_state(p, item, kind, triad);
    imki_foreign_keys(p, node, sizeof known / sizeof known[0], known);
}

void imki_filter_read(imki_parameters *p)
{
    if (!imki_parameters_document(p))
        return;
    for (int kind = 0; kind < 2; kind++) {
        const int node = imki_node_value(p, 0, imki_kind_names[kind]);
        p->triad[kind]->present = node != IMKI_NONE;
        if (imki_node_is(p, node, IMKI_NODE_MAPPING))
            read_sensor(p, node, kind);
        else if (node != IMKI_NONE)
            imki_refuse_node(p, node, IMK_ERROR_SYNTAX, imki_kind_names[kind],
                             "a mapping with white_noise and bias_states");
    }
}
