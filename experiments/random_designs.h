/* SPDX-License-Identifier: Apache-2.0 */
/* Designs at random, and what becomes of one: it is refused in words, or it is run at its levels,
 * reduced by its closed forms, and swept by the laboratory. */
#ifndef IMUKIT_RANDOM_DESIGNS_H
#define IMUKIT_RANDOM_DESIGNS_H

#include "imukit/physics.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* How a design is made from the default one. */
enum { MOVE_FEW = 0, MOVE_ALL, MOVES };
static const char *const move_names[] = {"few", "all"};

/* What became of it. REFUSED: by the check of the design. UNFIT: by the start of a run, for its
 * sample rate or number of steps. */
enum { DESIGN_REFUSED = 0, DESIGN_UNFIT, DESIGN_RAN, DESIGN_SWEPT, DESIGN_WRONG, DESIGN_ENDS };

typedef struct design_outcome {
    int end;
    imk_error error;    /* of REFUSED and UNFIT */
    char wrong[160];    /* of WRONG: what is wrong */
    double sweep_steps; /* internal steps that a sweep needs */
    size_t figures;
    double computed[IMK_LABORATORY_FIGURES_MAX], found[IMK_LABORATORY_FIGURES_MAX];
    double sigma[IMK_LABORATORY_FIGURES_MAX]; /* of their difference */
    double full_scale;                        /* of the sweep */
    double scatter;                           /* of its readings without input */
    int attempt;                              /* of design_attempts: the first that agrees */
    bool differs;                             /* none does */
    int says;                                 /* what the model says of it */
    double step;                              /* that the reading has by the model */
    int unmeasured;                           /* figures that are not finite */
} design_outcome;

/* Closed forms are of small inputs, of an instrument that has settled, and of the mean of all runs.
 * An experiment whose figures differ is repeated with smaller inputs, more time, and without what
 * is random, which tells the reason. */
typedef struct design_attempt {
    double inputs, time;
    bool noise;
    const char *reason;
} design_attempt;
enum { DESIGN_ATTEMPTS = 10 };
static const design_attempt design_attempts[DESIGN_ATTEMPTS] = {
    {1.0, 1.0, true, "agrees at once"},
    {0.1, 1.0, true, "agrees at a tenth of the inputs: higher orders, or a stop"},
    {1.0, 1.0, false, "agrees without noise: what the run drew is no small error"},
    {0.1, 1.0, false, "agrees at a tenth of the inputs without noise"},
    {1.0, 100.0, true, "agrees after a hundred times the time: it settles slowly"},
    {0.01, 1.0, true, "agrees at a hundredth of the inputs: higher orders, or a stop"},
    {0.01, 100.0, true, "agrees at a hundredth of the inputs, a hundred times the time"},
    {1e-3, 1.0, true, "agrees at a thousandth of the inputs: higher orders, or a stop"},
    {0.01, 0.1, false,
     "agrees at a hundredth of the inputs in a tenth of the time: it drifts away"},
    {1e-4, 1.0, false, "agrees at a ten-thousandth of the inputs without noise"}};

/* What the model says itself, where no attempt agrees. */
enum { SAYS_NOTHING = 0, SAYS_STEPS, SAYS_ERRORS, SAYS_OPEN, SAYS_FALLEN, SAYINGS };
static const char *const design_sayings[SAYINGS] = {
    "", "the stated step or dead band is above 5 % of full scale",
    "a stated error is above 30 % of full scale: no small input",
    "a free rotor on a residual spring: it drifts as it tilts",
    "the ball touches its stop at 1 g, of which the sweep warns"};

/* ---- a design at random ---------------------------------------------------------------------- */

/* splitmix64: the same designs everywhere */
typedef struct design_random {
    uint64_t state;
} design_random;

static inline double design_uniform(design_random *random)
{
    uint64_t z = random->state += UINT64_C(0x9E3779B97F4A7C15);
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static inline design_random design_random_of(uint64_t seed, const char *name, int move, int number)
{
    design_random random = {seed};
    for (; *name; name++)
        random.state = (random.state ^ (unsigned char)*name) * UINT64_C(0x100000001B3);
    random.state ^= ((uint64_t)move << 32) + (uint64_t)number * UINT64_C(0xD1342543DE82EF95);
    (void)design_uniform(&random);
    return random;
}

/* A temperature of some zero point, which is moved by kelvins and not by a factor. */
static inline bool is_temperature(const imk_design_field *field)
{
    return strcmp(field->unit, "degC") == 0 || strcmp(field->unit, "K") == 0;
}

/* FEW: by up to three decades; ALL: by up to `part`, drawn again if that is beyond the range. A
 * number that is 0 has no size of its own: FEW makes it a part of its range, from a billionth to a
 * thousandth. Signs are turned where the range has both. */
static inline double number_beside(const imk_design_field *field, double usual, int move,
                                   double part, design_random *random)
{
    const double u = 2.0 * design_uniform(random) - 1.0;
    const bool turns = field->minimum < 0.0 && design_uniform(random) < 0.5;
    if (is_temperature(field))
        return usual + (move == MOVE_FEW ? 100.0 : 20.0) * u;
    if (move == MOVE_ALL)
        return usual * (1.0 + part * u) * (turns && design_uniform(random) < 0.25 ? -1.0 : 1.0);
    const double size =
        usual != 0.0 ? usual * pow(10.0, 3.0 * u) : field->maximum * pow(10.0, -6.0 + 3.0 * u);
    return turns ? -size : size;
}

static inline double moved_number(const imk_design_field *field, double usual, int move,
                                  double part, design_random *random)
{
    double value = number_beside(field, usual, move, part, random);
    if (move == MOVE_ALL)
        while (value < field->minimum || value > field->maximum)
            value = number_beside(field, usual, move, part, random);
    return value;
}

static inline int choices_in(const char *choices)
{
    int count = 1;
    for (; *choices; choices++)
        count += *choices == '|';
    return count;
}

static inline void move_field(const imk_design_field *field, void *design, int move, double part,
                              design_random *random)
{
    char *place = (char *)design + field->offset;
    double value;
    int whole;
    bool yes;
    /* where all parameters are moved, the words mostly stay: they are other instruments */
    const bool word = move == MOVE_FEW || design_uniform(random) < 0.25;
    switch (field->kind) {
    case IMK_DESIGN_NUMBER:
        memcpy(&value, place, sizeof value);
        value = moved_number(field, value, move, part, random);
        memcpy(place, &value, sizeof value);
        break;
    case IMK_DESIGN_COUNT:
        memcpy(&whole, place, sizeof whole);
        value = floor(moved_number(field, (double)whole, move, part, random) + 0.5);
        whole = value > 2e9 ? 2000000000 : value < -2e9 ? -2000000000 : (int)value;
        memcpy(place, &whole, sizeof whole);
        break;
    case IMK_DESIGN_CHOICE:
        if (word) {
            whole = (int)(design_uniform(random) * choices_in(field->choices));
            memcpy(place, &whole, sizeof whole);
        }
        break;
    case IMK_DESIGN_SWITCH:
        if (word) {
            yes = design_uniform(random) < 0.5;
            memcpy(place, &yes, sizeof yes);
        }
        break;
    }
}

/* Design `number` of a kind of move. */
static inline void random_design(const imk_instrument *instrument, int move, int number,
                                 uint64_t seed, void *design)
{
    design_random random = design_random_of(seed, instrument->name, move, number);
    instrument->set_default(design);
    if (move == MOVE_ALL) {
        /* some designs by little: numbers that belong together rarely fit when all move by 40 % */
        const double part = 0.4 * design_uniform(&random);
        for (size_t i = 0; i < instrument->field_count; i++)
            move_field(&instrument->fields[i], design, move, part, &random);
        return;
    }
    for (int k = 1 + (int)(3.0 * design_uniform(&random)); k > 0; k--) {
        const double place = design_uniform(&random) * (double)instrument->field_count;
        move_field(&instrument->fields[(size_t)place], design, move, 0.0, &random);
    }
}

/* ---- how far a closed form is off ------------------------------------------------------------ */

/* The input at which a figure acts, to the power at which it does: its value times this is an error
 * of the reading [rad/s or m/s^2]. 0: the figure is none of the reading. */
static inline double acts_at(const char *key, double full_scale)
{
    static const struct {
        const char *begin;
        int powers;   /* of full scale */
        double times; /* 1 g, 1 g^2, 20 K, 0.01 K/s */
    } terms[] = {{"bias.fixed", 0, 1.0},        {"bias.temperature_rate", 0, 0.01},
                 {"bias.temperature", 0, 20.0}, {"scale_factor.temperature", 1, 20.0},
                 {"scale_factor", 1, 1.0},      {"asymmetry", 1, 0.5},
                 {"nonlinearity.k2", 2, 1.0},   {"nonlinearity.koq", 2, 1.0},
                 {"nonlinearity.k3", 3, 1.0},   {"nonlinearity.asymmetry", 1, 0.5},
                 {"misalignment", 1, 1.0},      {"g_sensitivity", 0, 9.80665},
                 {"g2_sensitivity", 0, 96.17},  {"cross_products", 0, 96.17}};
    for (size_t i = 0; i < sizeof terms / sizeof *terms; i++)
        if (strncmp(key, terms[i].begin, strlen(terms[i].begin)) == 0)
            return terms[i].times * pow(full_scale, terms[i].powers);
    return 0.0;
}

/* Is a figure of a design that was swept beyond four sigmas, by a tenth of itself or more, and by
 * more than the readings scatter, than their steps, and than a ten-thousandth of full scale? */
static inline bool figure_differs(const design_outcome *o, size_t i, const char *key)
{
    const double difference = fabs(o->found[i] - o->computed[i]);
    const double acts = acts_at(key, o->full_scale);
    if (acts <= 0.0 || difference <= 4.0 * o->sigma[i] || difference <= 0.1 * fabs(o->computed[i]))
        return false;
    return difference * acts > 4.0 * (o->scatter + o->step) &&
           difference * acts > 1e-4 * o->full_scale;
}

/* ---- what becomes of it ---------------------------------------------------------------------- */

static inline void *design_state(const imk_instrument *instrument)
{
    return aligned_alloc(64, (instrument->state_size + 63) / 64 * 64);
}

/* A refusal must name the parameter and say what is expected. */
static inline bool in_words(const imk_error *error)
{
    return error->field[0] != '\0' && error->expected[0] != '\0' && isfinite(error->value) &&
           isfinite(error->limit);
}

static inline void design_wrong(design_outcome *outcome, const char *what, const char *which)
{
    outcome->end = DESIGN_WRONG;
    snprintf(outcome->wrong, sizeof outcome->wrong, "%s%s%s", what, *which ? ": " : "", which);
}

static inline void input_of(const imk_instrument *instrument, double input, imk_exposure *exposure)
{
    *(instrument->sensor == IMK_GYRO ? &exposure->angular_rate[0] : &exposure->specific_force[0]) =
        input;
}

/* A tenth of the range, 32 samples, a thousand internal steps each at most. */
static inline void run_level(const imk_instrument *instrument, const void *design,
                             const imk_triad *triad, imk_level level, void *state,
                             design_outcome *outcome)
{
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX], signals[IMK_INSTRUMENT_SIGNALS_MAX];
    imk_physics_settings settings = imk_physics_default();
    imk_exposure exposure = imk_exposure_default();
    settings.level = level;
    const double step = instrument->step_length(design, &settings);
    if (!(step > 0.0 && isfinite(step))) {
        design_wrong(outcome, "internal step that is not above 0", "");
        return;
    }
    settings.rate = step < 1e-5 ? 1e-3 / step : 100.0;
    const imk_status status =
        imk_instrument_init(instrument, design, &settings, state, &outcome->error);
    if (status == IMK_ERROR_UNSUPPORTED && level == IMK_LEVEL_SLOW)
        return; /* it has one level */
    if (status != IMK_OK) {
        outcome->end = DESIGN_UNFIT;
        if (!in_words(&outcome->error))
            design_wrong(outcome, "start refused without words", outcome->error.field);
        return;
    }
    const double range = triad->range.value[0];
    input_of(instrument, range > 0.0 ? 0.1 * range : 0.1, &exposure);
    for (int i = 0; i < 32; i++) {
        instrument->step(state, &exposure, outputs);
        instrument->observe(state, signals);
        for (size_t k = 0; k < instrument->output_count; k++)
            if (!isfinite(outputs[k]))
                design_wrong(outcome, "output is not finite", instrument->outputs[k].name);
        for (size_t k = 0; k < instrument->signal_count; k++)
            if (!isfinite(signals[k]))
                design_wrong(outcome, "signal is not finite", instrument->signals[k].name);
    }
}

/* Experiments as short as the bandwidth allows: five of its periods to settle and 64 samples. */
static inline imk_laboratory short_experiments(const imk_instrument *instrument, const void *design,
                                               const imk_triad *triad,
                                               const design_attempt *attempt)
{
    imk_laboratory laboratory = imk_laboratory_default();
    const double bandwidth = triad->bandwidth.value[0], range = triad->range.value[0];
    const imk_temperature_polynomial *warmth = &triad->bias.temperature;
    laboratory.instrument = instrument;
    laboratory.design = design;
    laboratory.physics.level = IMK_LEVEL_SLOW;
    laboratory.physics.rate = bandwidth > 0.0       ? fmin(8.0 * bandwidth, 2000.0)
                              : attempt->time < 1.0 ? 1000.0
                                                    : 100.0;
    laboratory.physics.noise = attempt->noise;
    laboratory.settle = attempt->time * (bandwidth > 0.0 ? fmax(0.2, 5.0 / bandwidth) : 0.2);
    if (warmth->order > 0) /* where the closed forms are stated */
        laboratory.surroundings.temperature = warmth->reference;
    laboratory.full_scale = attempt->inputs * (range > 0.0                      ? 0.8 * range
                                               : instrument->sensor == IMK_GYRO ? 1.0
                                                                                : 10.0);
    laboratory.dwell = 64.0 / laboratory.physics.rate;
    laboratory.points = 7;
    /* 64 samples to a cycle: of a high bandwidth, the time to settle has too many of them */
    laboratory.frequencies = bandwidth > 0.0 && bandwidth * laboratory.settle < 1000.0 ? 6 : 0;
    laboratory.record = 0.0;
    laboratory.cycles = 3;
    /* what these points take, and no more: what is not told within it is left */
    laboratory.longest = laboratory.cycles * (2.0 * laboratory.points + 12.0) *
                         (laboratory.settle + laboratory.dwell);
    return laboratory;
}

/* Internal steps of all its points. */
static inline double sweep_steps(const imk_laboratory *laboratory)
{
    enum { POINTS = 90 };
    const imk_physics_settings *physics = &laboratory->physics;
    const double step = laboratory->instrument->step_length(laboratory->design, physics);
    const double samples = 32.0 + (laboratory->settle + laboratory->dwell) * physics->rate;
    return POINTS * samples * fmax(1.0, 1.0 / (physics->rate * step));
}

/* Steps of the reading and of its integral, and the dead band. */
static inline double step_of(const imk_triad *triad, double dwell)
{
    return triad->resolution.value[0] + triad->dead_band.value[0] +
           sqrt(12.0) * triad->noise.quantization.value[0] / dwell;
}

/* The rotor of a tuned gyro that no loop holds in line with the shaft. */
static inline bool is_free_rotor(const imk_instrument *instrument, const void *design)
{
    return instrument == &imk_tuned_gyro_instrument && !((const imk_tuned_gyro *)design)->captured;
}

/* The ball of a suspended gyro that 1 g, as in the tumble, puts on its stop: `imukit physics
 * --sweep` warns of it. */
static inline bool is_fallen(const imk_instrument *instrument, const void *design)
{
    return instrument == &imk_suspended_rotor_instrument &&
           imk_suspended_rotor_touch_down(design) < 1.1 * 9.80665;
}

/* What a model says itself of the size of its errors. */
static inline int saying_of(const imk_laboratory *laboratory, const imk_model *reduced,
                            double full_scale)
{
    const int sensor = laboratory->instrument->sensor;
    const double dwell = laboratory->dwell;
    imk_laboratory_figure figure[IMK_LABORATORY_FIGURES_MAX];
    const size_t count = imk_laboratory_figures(reduced, sensor, figure);
    if (step_of(imk_model_triad(reduced, sensor), dwell) > 0.05 * full_scale)
        return SAYS_STEPS;
    for (size_t i = 0; i < count; i++)
        if (fabs(figure[i].value) * acts_at(figure[i].key, full_scale) > 0.3 * full_scale)
            return SAYS_ERRORS;
    return is_free_rotor(laboratory->instrument, laboratory->design) ? SAYS_OPEN
           : is_fallen(laboratory->instrument, laboratory->design)   ? SAYS_FALLEN
                                                                     : SAYS_NOTHING;
}

static inline void compare(const imk_laboratory *laboratory, const imk_model *reduced,
                           const imk_laboratory_result *result, design_outcome *outcome)
{
    const int sensor = laboratory->instrument->sensor;
    imk_laboratory_figure computed[IMK_LABORATORY_FIGURES_MAX], found[IMK_LABORATORY_FIGURES_MAX];
    outcome->figures = imk_laboratory_figures(reduced, sensor, computed);
    (void)imk_laboratory_figures(&result->model, sensor, found);
    outcome->full_scale = result->full_scale;
    outcome->scatter = result->zero_scatter;
    outcome->step = step_of(imk_model_triad(reduced, sensor), laboratory->dwell);
    outcome->differs = false;
    outcome->unmeasured = 0;
    for (size_t i = 0; i < outcome->figures; i++) {
        outcome->computed[i] = computed[i].value;
        outcome->found[i] = found[i].value;
        outcome->sigma[i] = hypot(computed[i].sigma, found[i].sigma);
        if (!isfinite(found[i].value) || !isfinite(found[i].sigma))
            outcome->unmeasured++;
        outcome->differs = outcome->differs || figure_differs(outcome, i, found[i].key);
    }
}

/* One attempt, if it is not too long. */
static inline void sweep_once(const imk_laboratory *laboratory, const imk_model *reduced,
                              design_outcome *outcome)
{
    const size_t size = imk_laboratory_workspace_size(laboratory);
    imk_laboratory_result *result = malloc(sizeof *result);
    void *workspace = malloc(size);
    imk_error *error = &outcome->error;
    if (!result || !workspace)
        abort();
    if (imk_laboratory_run(laboratory, NULL, result, workspace, size, error) == IMK_OK) {
        outcome->end = DESIGN_SWEPT;
        compare(laboratory, reduced, result, outcome);
    } else {
        outcome->end = DESIGN_UNFIT;
        if (!in_words(error))
            design_wrong(outcome, "sweep refused without words", error->field);
    }
    free(workspace);
    free(result);
}

static inline void sweep_design(const imk_instrument *instrument, const void *design,
                                const imk_model *reduced, double steps_allowed, void *state,
                                design_outcome *outcome)
{
    const imk_triad *triad = imk_model_triad(reduced, instrument->sensor);
    design_outcome other;
    for (int attempt = 0; attempt < DESIGN_ATTEMPTS; attempt++) {
        imk_laboratory laboratory =
            short_experiments(instrument, design, triad, &design_attempts[attempt]);
        if (imk_instrument_init(instrument, design, &laboratory.physics, state, NULL) ==
            IMK_ERROR_UNSUPPORTED)
            laboratory.physics.level = IMK_LEVEL_FULL;
        other = *outcome;
        other.attempt = attempt;
        other.sweep_steps = sweep_steps(&laboratory);
        if (other.sweep_steps <= steps_allowed)
            sweep_once(&laboratory, reduced, &other);
        else if (attempt > 0)
            continue;
        /* the first attempt stands if none agrees */
        if (attempt == 0 || other.end == DESIGN_WRONG || !other.differs)
            *outcome = other;
        if (outcome->end != DESIGN_SWEPT || !outcome->differs)
            return;
        if (attempt == 0)
            outcome->says = saying_of(&laboratory, reduced, outcome->full_scale);
    }
}

/* @param steps_allowed  a sweep of more internal steps is left out; 0: none */
static inline void try_design(const imk_instrument *instrument, const void *design,
                              double steps_allowed, design_outcome *outcome)
{
    imk_model *model = malloc(sizeof *model);
    void *state = design_state(instrument);
    if (!model || !state)
        abort();
    memset(outcome, 0, sizeof *outcome);
    if (imk_design_check(instrument, design, &outcome->error) != IMK_OK) {
        outcome->end = DESIGN_REFUSED;
        if (!in_words(&outcome->error))
            design_wrong(outcome, "refused without words", outcome->error.field);
    } else {
        outcome->end = DESIGN_RAN;
        imk_instrument_reduce(instrument, design, model);
        const imk_triad *triad = imk_model_triad(model, instrument->sensor);
        if (imk_model_validate(model, &outcome->error) != IMK_OK)
            design_wrong(outcome, "error model", outcome->error.field);
        for (int level = IMK_LEVEL_FULL; level <= IMK_LEVEL_SLOW; level++)
            if (outcome->end == DESIGN_RAN)
                run_level(instrument, design, triad, (imk_level)level, state, outcome);
        if (outcome->end == DESIGN_RAN && steps_allowed > 0.0)
            sweep_design(instrument, design, model, steps_allowed, state, outcome);
    }
    free(state);
    free(model);
}

#endif
