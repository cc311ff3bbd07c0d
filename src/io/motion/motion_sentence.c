/* SPDX-License-Identifier: Apache-2.0 */
/* The steps of a motion script, each one a sentence.
 *
 * A rate r held for a time t changes by r t; it builds up and dies away over the smoothing time s,
 * so that the step lasts t + s. A change c that is to last t in all has the rate c/(t - s).
 * "to 20 m/s" is a change from what the steps before have made. */
#include "motion_file_internal.h"
#include "step_sentence_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

static const imki_verb verbs[] = {
    {"hold", IMK_STEP_HOLD, 0, 0, {IMKI_BARE_BIT, IMKI_FOR_BIT}, "write hold 10 s"},
    {"accelerate",
     IMK_STEP_ACCELERATE,
     0,
     0,
     {IMKI_TO_BIT | IMKI_AT_BIT, IMKI_TO_BIT | IMKI_IN_BIT, IMKI_BARE_BIT | IMKI_FOR_BIT,
      IMKI_BARE_BIT | IMKI_AT_BIT, IMKI_BARE_BIT | IMKI_IN_BIT},
     "write accelerate to 20 m/s at 2 m/s^2, accelerate to 20 m/s in 10 s or accelerate 2 m/s^2 "
     "for 10 s"},
    {"brake",
     IMK_STEP_ACCELERATE,
     0,
     0,
     {IMKI_TO_BIT | IMKI_AT_BIT, IMKI_TO_BIT | IMKI_IN_BIT, IMKI_BARE_BIT | IMKI_FOR_BIT,
      IMKI_BARE_BIT | IMKI_AT_BIT, IMKI_BARE_BIT | IMKI_IN_BIT},
     "write brake to 5 m/s at 3 m/s^2, brake to 5 m/s in 5 s or brake 3 m/s^2 for 5 s"},
    {"stop",
     IMK_STEP_ACCELERATE,
     0,
     0,
     {IMKI_AT_BIT, IMKI_IN_BIT},
     "write stop at 3 m/s^2 or stop in 10 s"},
    {"turn",
     IMK_STEP_TURN,
     IMKI_WORD_LEFT | IMKI_WORD_RIGHT | IMKI_WORD_BANKED,
     0,
     {IMKI_BARE_BIT | IMKI_AT_BIT, IMKI_BARE_BIT | IMKI_IN_BIT, IMKI_TO_BIT | IMKI_AT_BIT,
      IMKI_TO_BIT | IMKI_IN_BIT},
     "write turn 90 deg at 10 deg/s, turn left 90 deg in 10 s or turn to 270 deg at 10 deg/s "
     "banked"},
    {"climb",
     IMK_STEP_CLIMB,
     0,
     0,
     {IMKI_BARE_BIT | IMKI_AT_BIT, IMKI_BARE_BIT | IMKI_IN_BIT, IMKI_TO_BIT | IMKI_AT_BIT,
      IMKI_TO_BIT | IMKI_IN_BIT},
     "write climb 5 deg at 2 deg/s, climb -5 deg in 5 s or climb to 5 deg at 2 deg/s"},
    {"level",
     IMK_STEP_CLIMB,
     0,
     0,
     {IMKI_AT_BIT, IMKI_IN_BIT},
     "write level at 2 deg/s or level in 5 s"},
    {"rotate",
     IMK_STEP_ROTATE,
     0,
     IMKI_WORDS_XYZ,
     {IMKI_BARE_BIT | IMKI_AT_BIT, IMKI_BARE_BIT | IMKI_IN_BIT, IMKI_AT_BIT | IMKI_FOR_BIT},
     "write rotate z 360 deg at 36 deg/s, rotate z 360 deg in 10 s or rotate z at -100 deg/s for "
     "10 s"},
    {"pose",
     IMK_STEP_POSE,
     0,
     0,
     {IMKI_BARE_BIT | IMKI_IN_BIT},
     "write pose 0 90 0 deg in 5 s (roll, pitch, yaw)"},
    {"swing",
     IMK_STEP_SWING,
     0,
     IMKI_WORDS_XYZ,
     {IMKI_BARE_BIT | IMKI_AT_BIT | IMKI_FOR_BIT},
     "write swing x 5 deg at 1 Hz for 20 s"},
    {"coning",
     IMK_STEP_CONING,
     0,
     IMKI_WORDS_XYZ,
     {IMKI_BARE_BIT | IMKI_AT_BIT | IMKI_FOR_BIT},
     "write coning z 1 deg at 10 Hz for 60 s"},
};

enum { VERBS = sizeof verbs / sizeof verbs[0] };

static imk_status add_step(imki_script_reader *r, int node, const imk_motion_step *step)
{
    if (r->step_count == r->capacity) {
        const size_t capacity = r->capacity > 0 ? 2 * r->capacity : 64;
        imk_motion_step *steps = realloc(r->step, capacity * sizeof *steps);
        if (steps)
            r->step = steps;
        int *nodes = realloc(r->step_node, capacity * sizeof *nodes);
        if (nodes)
            r->step_node = nodes;
        if (!steps || !nodes)
            return imk_error_set(r->error, IMK_ERROR_MEMORY, "", "", "");
        r->capacity = capacity;
    }
    r->step[r->step_count] = *step;
    r->step_node[r->step_count++] = node;
    return IMK_OK;
}

/* Rate of a step that changes by `amount`, from its part `at` or `in`. */
static imk_status read_rate(const imki_script_reader *r, const imki_sentence *s, const char *si,
                            double amount, double *rate)
{
    if (imki_sentence_has(s, IMKI_PART_AT))
        return imki_sentence_positive(s, IMKI_PART_AT, si, rate);
    double duration = 0.0;
    const imk_status status = imki_sentence_positive(s, IMKI_PART_IN, "s", &duration);
    if (status != IMK_OK)
        return status;
    if (!(duration >= 2.0 * r->script.smoothing))
        return imki_sentence_refuse(s, IMKI_PART_IN, IMK_ERROR_RANGE,
                                    "at least twice the smoothing time");
    *rate = fabs(amount) / (duration - r->script.smoothing);
    return IMK_OK;
}

/* A step that changes something to or by an amount at a rate; one that changes nothing takes no
 * time, or rests for the time it should last. */
static imk_status add_change(imki_script_reader *r, const imki_sentence *s, const char *rate_si,
                             imk_motion_step step)
{
    imk_status status = read_rate(r, s, rate_si, step.amount, &step.rate);
    if (status == IMK_OK && step.amount == 0.0 && imki_sentence_has(s, IMKI_PART_IN)) {
        step = (imk_motion_step){.kind = IMK_STEP_HOLD};
        status = imki_sentence_numbers(s, IMKI_PART_IN, "s", 1, &step.duration);
    } else if (step.amount == 0.0) {
        return status;
    }
    return status == IMK_OK ? add_step(r, s->node, &step) : status;
}

/* "2 m/s^2 for 10 s", "at 100 deg/s for 10 s": rate times time. */
static imk_status read_product(const imki_sentence *s, imki_part part, const char *si,
                               imk_motion_step *step)
{
    double time = 0.0, rate = 0.0;
    imk_status status = imki_sentence_numbers(s, part, si, 1, &rate);
    if (status == IMK_OK && rate == 0.0)
        status = imki_sentence_refuse(s, part, IMK_ERROR_RANGE,
                                      "a rate other than 0; write hold 10 s to go on as it is");
    if (status == IMK_OK)
        status = imki_sentence_positive(s, IMKI_PART_FOR, "s", &time);
    step->amount = rate * time;
    step->rate = fabs(rate);
    return status;
}

static imk_status read_speed(imki_script_reader *r, const imki_sentence *s)
{
    const bool brakes = strcmp(s->verb->name, "brake") == 0;
    imk_motion_step step = {.kind = IMK_STEP_ACCELERATE};
    imk_status status = IMK_OK;
    double target = 0.0;
    if (imki_sentence_has(s, IMKI_PART_FOR)) {
        status = read_product(s, IMKI_PART_BARE, "m/s^2", &step);
    } else if (imki_sentence_has(s, IMKI_PART_BARE)) {
        status = imki_sentence_numbers(s, IMKI_PART_BARE, "m/s", 1, &step.amount);
    } else {
        if (imki_sentence_has(s, IMKI_PART_TO))
            status = imki_sentence_numbers(s, IMKI_PART_TO, "m/s", 1, &target);
        step.amount = target - r->speed;
    }
    if (status != IMK_OK)
        return status;
    if (brakes && imki_sentence_has(s, IMKI_PART_BARE)) {
        if (!(step.amount > 0.0))
            return imki_sentence_refuse(s, IMKI_PART_BARE, IMK_ERROR_RANGE, "a number above 0");
        step.amount = -step.amount;
    }
    if (brakes && step.amount > 0.0)
        return imki_sentence_refuse(s, IMKI_PART_TO, IMK_ERROR_RANGE,
                                    "a speed below the one the body has here; or write accelerate");
    r->speed = imki_sentence_has(s, IMKI_PART_BARE) ? r->speed + step.amount : target;
    if (!imki_sentence_has(s, IMKI_PART_FOR))
        return add_change(r, s, "m/s^2", step);
    return add_step(r, s->node, &step);
}

/* To a heading by the shorter way, or by the way that is said. A heading that is there already up
 * to rounding stays. */
static double turn_towards(double heading, double target, unsigned words)
{
    const double nothing = 1e-9; /* [rad]: rounding of a thousand turns is less */
    double turn = target - heading;
    turn -= 2.0 * PI * floor(turn / (2.0 * PI) + 0.5);
    if (fabs(turn) < nothing)
        return 0.0;
    if (turn > 0.0 && (words & IMKI_WORD_LEFT))
        turn -= 2.0 * PI;
    if (turn < 0.0 && (words & IMKI_WORD_RIGHT))
        turn += 2.0 * PI;
    return turn;
}

static imk_status read_turn(imki_script_reader *r, const imki_sentence *s)
{
    const unsigned sides = s->words & (IMKI_WORD_LEFT | IMKI_WORD_RIGHT);
    imk_motion_step step = {.kind = IMK_STEP_TURN, .banked = (s->words & IMKI_WORD_BANKED) != 0};
    imk_status status;
    if (sides == (IMKI_WORD_LEFT | IMKI_WORD_RIGHT))
        return imki_sentence_refuse(s, IMKI_PARTS, IMK_ERROR_SYNTAX, s->verb->usage);
    if (imki_sentence_has(s, IMKI_PART_TO)) {
        double target = 0.0;
        status = imki_sentence_numbers(s, IMKI_PART_TO, "rad", 1, &target);
        step.amount = turn_towards(r->heading, target, s->words);
    } else if (sides == 0) {
        status = imki_sentence_numbers(s, IMKI_PART_BARE, "rad", 1, &step.amount);
    } else {
        status = imki_sentence_positive(s, IMKI_PART_BARE, "rad", &step.amount);
        step.amount = sides == IMKI_WORD_LEFT ? -step.amount : step.amount;
    }
    if (status != IMK_OK)
        return status;
    r->heading += step.amount;
    return add_change(r, s, "rad/s", step);
}

static imk_status read_climb(imki_script_reader *r, const imki_sentence *s)
{
    imk_motion_step step = {.kind = IMK_STEP_CLIMB};
    imk_status status = IMK_OK;
    double target = 0.0;
    if (imki_sentence_has(s, IMKI_PART_BARE)) {
        status = imki_sentence_numbers(s, IMKI_PART_BARE, "rad", 1, &step.amount);
        target = r->climb + step.amount;
    } else {
        if (imki_sentence_has(s, IMKI_PART_TO))
            status = imki_sentence_numbers(s, IMKI_PART_TO, "rad", 1, &target);
        step.amount = target - r->climb;
    }
    if (status == IMK_OK && !(fabs(target) < 0.5 * PI))
        status = imki_sentence_refuse(s, IMKI_PARTS, IMK_ERROR_RANGE,
                                      "a climb angle between -90 deg and 90 deg");
    if (status != IMK_OK)
        return status;
    r->climb = target;
    return add_change(r, s, "rad/s", step);
}

static imk_status read_rotation(imki_script_reader *r, const imki_sentence *s)
{
    imk_motion_step step = {.kind = IMK_STEP_ROTATE, .axis = imki_sentence_axis(s)};
    imk_status status;
    if (imki_sentence_has(s, IMKI_PART_FOR)) {
        status = read_product(s, IMKI_PART_AT, "rad/s", &step);
        return status == IMK_OK ? add_step(r, s->node, &step) : status;
    }
    status = imki_sentence_numbers(s, IMKI_PART_BARE, "rad", 1, &step.amount);
    return status == IMK_OK ? add_change(r, s, "rad/s", step) : status;
}

static imk_status read_oscillation(imki_script_reader *r, const imki_sentence *s)
{
    imk_motion_step step = {.kind = (imk_step_kind)s->verb->kind, .axis = imki_sentence_axis(s)};
    imk_status status = imki_sentence_positive(s, IMKI_PART_BARE, "rad", &step.amount);
    if (status == IMK_OK)
        status = imki_sentence_positive(s, IMKI_PART_AT, "Hz", &step.frequency);
    if (status == IMK_OK)
        status = imki_sentence_positive(s, IMKI_PART_FOR, "s", &step.duration);
    return status == IMK_OK ? add_step(r, s->node, &step) : status;
}

static imk_status read_pose(imki_script_reader *r, const imki_sentence *s)
{
    imk_motion_step step = {.kind = IMK_STEP_POSE};
    imk_status status = imki_sentence_numbers(s, IMKI_PART_BARE, "rad", 3, step.angle);
    if (status == IMK_OK)
        status = imki_sentence_positive(s, IMKI_PART_IN, "s", &step.duration);
    return status == IMK_OK ? add_step(r, s->node, &step) : status;
}

static imk_status read_hold(imki_script_reader *r, const imki_sentence *s)
{
    imk_motion_step step = {.kind = IMK_STEP_HOLD};
    const imki_part part = imki_sentence_has(s, IMKI_PART_FOR) ? IMKI_PART_FOR : IMKI_PART_BARE;
    const imk_status status = imki_sentence_positive(s, part, "s", &step.duration);
    return status == IMK_OK ? add_step(r, s->node, &step) : status;
}

imk_status imki_step_sentence_read(imki_script_reader *r, int node)
{
    imki_sentence s;
    const imk_status status =
        imki_sentence_read(r->document, node, "a step", VERBS, verbs, &s, r->error);
    if (status != IMK_OK)
        return status;
    switch ((imk_step_kind)s.verb->kind) {
    case IMK_STEP_ACCELERATE:
        return read_speed(r, &s);
    case IMK_STEP_TURN:
        return read_turn(r, &s);
    case IMK_STEP_CLIMB:
        return read_climb(r, &s);
    case IMK_STEP_ROTATE:
        return read_rotation(r, &s);
    case IMK_STEP_POSE:
        return read_pose(r, &s);
    case IMK_STEP_SWING:
    case IMK_STEP_CONING:
        return read_oscillation(r, &s);
    case IMK_STEP_HOLD:
        break;
    }
    return read_hold(r, &s);
}
