/* SPDX-License-Identifier: Apache-2.0 */
/* The steps of a motion script, each written in words.
 *
 * A rate r held for a time t changes by r t; it builds up and dies away over the smoothing time s,
 * so that the step lasts t + s. A change c that is to last t in all has the rate c/(t - s).
 * "to 20 m/s" is a change from what the steps before have made. */
#include "motion_file_internal.h"

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

static void add_step(imki_script_reader *r, int node, const imk_motion_step *step)
{
    if (r->reading.status != IMK_OK)
        return;
    if (r->step_count == r->capacity) {
        const size_t capacity = r->capacity > 0 ? 2 * r->capacity : 64;
        imk_motion_step *steps = realloc(r->step, capacity * sizeof *steps);
        if (steps)
            r->step = steps;
        int *nodes = realloc(r->step_node, capacity * sizeof *nodes);
        if (nodes)
            r->step_node = nodes;
        if (!steps || !nodes) {
            r->reading.status = imk_error_set(r->reading.error, IMK_ERROR_MEMORY, "", "", "");
            return;
        }
        r->capacity = capacity;
    }
    r->step[r->step_count] = *step;
    r->step_node[r->step_count++] = node;
}

/* Rate of a step that changes by `amount`, from its part `at` or `in`. */
static double read_rate(const imki_script_reader *r, const imki_step_text *s, const char *si,
                        double amount)
{
    if (imki_step_text_has(s, IMKI_PART_AT))
        return imki_step_text_positive(s, IMKI_PART_AT, si);
    const double duration = imki_step_text_positive(s, IMKI_PART_IN, "s");
    if (!(duration >= 2.0 * r->script.smoothing))
        imki_step_text_refuse(s, IMKI_PART_IN, IMK_ERROR_RANGE,
                              "at least twice the smoothing time");
    return fabs(amount) / (duration - r->script.smoothing);
}

/* A step that changes something to or by an amount at a rate; one that changes nothing takes no
 * time, or rests for the time it should last. */
static void add_change(imki_script_reader *r, const imki_step_text *s, const char *rate_si,
                       imk_motion_step step)
{
    step.rate = read_rate(r, s, rate_si, step.amount);
    if (step.amount == 0.0 && !imki_step_text_has(s, IMKI_PART_IN))
        return;
    if (step.amount == 0.0)
        step = (imk_motion_step){.kind = IMK_STEP_HOLD,
                                 .duration = imki_step_text_number(s, IMKI_PART_IN, "s")};
    add_step(r, s->node, &step);
}

/* "2 m/s^2 for 10 s", "at 100 deg/s for 10 s": rate times time. */
static void read_product(const imki_step_text *s, imki_part part, const char *si,
                         imk_motion_step *step)
{
    const double rate = imki_step_text_number(s, part, si);
    if (rate == 0.0)
        imki_step_text_refuse(s, part, IMK_ERROR_RANGE,
                              "a rate other than 0; for no change, write hold 10 s");
    step->amount = rate * imki_step_text_positive(s, IMKI_PART_FOR, "s");
    step->rate = fabs(rate);
}

/* A change by the bare amount, or to the amount behind "to", 0 without one. @return the target */
static double read_change(const imki_step_text *s, const char *si, double from, double *amount)
{
    if (imki_step_text_has(s, IMKI_PART_BARE)) {
        *amount = imki_step_text_number(s, IMKI_PART_BARE, si);
        return from + *amount;
    }
    const double target =
        imki_step_text_has(s, IMKI_PART_TO) ? imki_step_text_number(s, IMKI_PART_TO, si) : 0.0;
    *amount = target - from;
    return target;
}

static void read_speed(imki_script_reader *r, const imki_step_text *s)
{
    const bool brakes = strcmp(s->verb->name, "brake") == 0;
    const bool lasts = imki_step_text_has(s, IMKI_PART_FOR),
               by = imki_step_text_has(s, IMKI_PART_BARE);
    imk_motion_step step = {.kind = IMK_STEP_ACCELERATE};
    double target = 0.0;
    if (lasts)
        read_product(s, IMKI_PART_BARE, "m/s^2", &step);
    else
        target = read_change(s, "m/s", r->speed, &step.amount);
    if (brakes && by) {
        if (!(step.amount > 0.0))
            imki_step_text_refuse(s, IMKI_PART_BARE, IMK_ERROR_RANGE, "a number above 0");
        step.amount = -step.amount;
    }
    if (brakes && step.amount > 0.0)
        imki_step_text_refuse(s, IMKI_PART_TO, IMK_ERROR_RANGE,
                              "a speed below the present one; to go faster, write accelerate");
    r->speed = by ? r->speed + step.amount : target;
    if (lasts)
        add_step(r, s->node, &step);
    else
        add_change(r, s, "m/s^2", step);
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

static void read_turn(imki_script_reader *r, const imki_step_text *s)
{
    const unsigned sides = s->words & (IMKI_WORD_LEFT | IMKI_WORD_RIGHT);
    imk_motion_step step = {.kind = IMK_STEP_TURN, .banked = (s->words & IMKI_WORD_BANKED) != 0};
    if (sides == (IMKI_WORD_LEFT | IMKI_WORD_RIGHT))
        imki_step_text_refuse(s, IMKI_PARTS, IMK_ERROR_SYNTAX, s->verb->usage);
    if (imki_step_text_has(s, IMKI_PART_TO)) {
        step.amount =
            turn_towards(r->heading, imki_step_text_number(s, IMKI_PART_TO, "rad"), s->words);
    } else if (sides == 0) {
        step.amount = imki_step_text_number(s, IMKI_PART_BARE, "rad");
    } else {
        step.amount = imki_step_text_positive(s, IMKI_PART_BARE, "rad");
        step.amount = sides == IMKI_WORD_LEFT ? -step.amount : step.amount;
    }
    r->heading += step.amount;
    add_change(r, s, "rad/s", step);
}

static void read_climb(imki_script_reader *r, const imki_step_text *s)
{
    imk_motion_step step = {.kind = IMK_STEP_CLIMB};
    r->climb = read_change(s, "rad", r->climb, &step.amount);
    if (!(fabs(r->climb) < 0.5 * PI))
        imki_step_text_refuse(s, IMKI_PARTS, IMK_ERROR_RANGE,
                              "a climb angle between -90 deg and 90 deg");
    add_change(r, s, "rad/s", step);
}

static void read_rotation(imki_script_reader *r, const imki_step_text *s)
{
    imk_motion_step step = {.kind = IMK_STEP_ROTATE, .axis = imki_step_text_axis(s)};
    if (imki_step_text_has(s, IMKI_PART_FOR)) {
        read_product(s, IMKI_PART_AT, "rad/s", &step);
        add_step(r, s->node, &step);
    } else {
        step.amount = imki_step_text_number(s, IMKI_PART_BARE, "rad");
        add_change(r, s, "rad/s", step);
    }
}

static void read_oscillation(imki_script_reader *r, const imki_step_text *s)
{
    imk_motion_step step = {.kind = (imk_step_kind)s->verb->kind, .axis = imki_step_text_axis(s)};
    step.amount = imki_step_text_positive(s, IMKI_PART_BARE, "rad");
    step.frequency = imki_step_text_positive(s, IMKI_PART_AT, "Hz");
    step.duration = imki_step_text_positive(s, IMKI_PART_FOR, "s");
    add_step(r, s->node, &step);
}

static void read_pose(imki_script_reader *r, const imki_step_text *s)
{
    imk_motion_step step = {.kind = IMK_STEP_POSE};
    imki_step_text_numbers(s, IMKI_PART_BARE, "rad", 3, step.angle);
    step.duration = imki_step_text_positive(s, IMKI_PART_IN, "s");
    add_step(r, s->node, &step);
}

static void read_hold(imki_script_reader *r, const imki_step_text *s)
{
    const imki_part part = imki_step_text_has(s, IMKI_PART_FOR) ? IMKI_PART_FOR : IMKI_PART_BARE;
    const imk_motion_step step = {.kind = IMK_STEP_HOLD,
                                  .duration = imki_step_text_positive(s, part, "s")};
    add_step(r, s->node, &step);
}

void imki_step_read(imki_script_reader *r, int node)
{
    static void (*const readers[])(imki_script_reader *, const imki_step_text *) = {
        [IMK_STEP_HOLD] = read_hold,         [IMK_STEP_ACCELERATE] = read_speed,
        [IMK_STEP_TURN] = read_turn,         [IMK_STEP_CLIMB] = read_climb,
        [IMK_STEP_ROTATE] = read_rotation,   [IMK_STEP_POSE] = read_pose,
        [IMK_STEP_SWING] = read_oscillation, [IMK_STEP_CONING] = read_oscillation};
    imki_step_text s;
    if (imki_step_text_read(&r->reading, node, "a step", VERBS, verbs, &s))
        readers[s.verb->kind](r, &s);
}
