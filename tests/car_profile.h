/* SPDX-License-Identifier: Apache-2.0 */
/* A drive of ten minutes: pulls away, turns at crossings, a roundabout, hills, a motorway, lanes
 * changed, stops between, and a rest at the end. For tests of motion and of what is built on it. */
#ifndef IMUKIT_TESTS_CAR_PROFILE_H
#define IMUKIT_TESTS_CAR_PROFILE_H

#include "imukit/motion_script.h"

enum { CAR_PROFILE_STEPS = 51 };

/* Its length [s]. */
#define CAR_PROFILE_DURATION 600.0

/* Fill the script; `step` holds CAR_PROFILE_STEPS steps and must stay as long as it. */
static inline void car_profile(imk_motion_script *script, imk_motion_step *step)
{
    const double degree = 3.14159265358979323846 / 180.0;
    enum { HOLD, GO, TURN, CLIMB };
    static const imk_step_kind kinds[] = {IMK_STEP_HOLD, IMK_STEP_ACCELERATE, IMK_STEP_TURN,
                                          IMK_STEP_CLIMB};
    /* Kind; seconds, m/s or degrees; and m/s^2 or degrees per second. The last hold fills up. */
    static const struct {
        int kind;
        double amount, rate;
    } drive[CAR_PROFILE_STEPS] = {
        {HOLD, 30.0, 0.0},   {GO, 8.0, 1.5},      {HOLD, 12.0, 0.0}, {TURN, 90.0, 18.0},
        {GO, 6.0, 1.8},      {HOLD, 15.0, 0.0},   {CLIMB, 3.0, 1.0}, {HOLD, 20.0, 0.0},
        {CLIMB, -3.0, 1.0},  {GO, -14.0, 2.5},    {HOLD, 25.0, 0.0}, {GO, 10.0, 2.2},
        {TURN, -90.0, 20.0}, {HOLD, 10.0, 0.0},   {GO, -4.0, 1.5},   {TURN, -40.0, 25.0},
        {TURN, 200.0, 30.0}, {TURN, -40.0, 25.0}, {GO, 10.0, 2.0},   {CLIMB, -4.0, 1.5},
        {HOLD, 15.0, 0.0},   {CLIMB, 4.0, 1.5},   {TURN, 35.0, 8.0}, {GO, 14.0, 1.6},
        {HOLD, 50.0, 0.0},   {TURN, 5.0, 4.0},    {TURN, -5.0, 4.0}, {HOLD, 60.0, 0.0},
        {TURN, -60.0, 3.0},  {CLIMB, 2.0, 0.5},   {HOLD, 60.0, 0.0}, {TURN, -5.0, 4.0},
        {TURN, 5.0, 4.0},    {CLIMB, -2.0, 0.5},  {GO, -15.0, 2.0},  {TURN, 80.0, 12.0},
        {GO, -15.0, 3.0},    {HOLD, 20.0, 0.0},   {GO, 5.0, 1.0},    {TURN, 120.0, 25.0},
        {GO, 7.0, 1.5},      {HOLD, 20.0, 0.0},   {GO, -12.0, 4.0},  {HOLD, 20.0, 0.0},
        {GO, 12.0, 2.5},     {TURN, -75.0, 15.0}, {HOLD, 30.0, 0.0}, {GO, -9.0, 2.0},
        {TURN, -90.0, 30.0}, {GO, -3.0, 1.0},     {HOLD, 1.0, 0.0},
    };
    *script = imk_motion_script_default();
    script->place = (imk_geodetic){45.0 * degree, 7.0 * degree, 300.0};
    script->heading = 20.0 * degree;
    script->step_count = CAR_PROFILE_STEPS;
    script->step = step;
    double before = 0.0;
    for (size_t i = 0; i < CAR_PROFILE_STEPS; i++) {
        const int kind = drive[i].kind;
        const double unit = kind == TURN || kind == CLIMB ? degree : 1.0;
        step[i] = (imk_motion_step){.kind = kinds[kind]};
        if (kind == HOLD)
            step[i].duration = drive[i].amount;
        step[i].amount = kind == HOLD ? 0.0 : drive[i].amount * unit;
        step[i].rate = drive[i].rate * unit;
        if (i + 1 < CAR_PROFILE_STEPS)
            before += imk_motion_step_duration(script, i);
    }
    step[CAR_PROFILE_STEPS - 1].duration = CAR_PROFILE_DURATION - before;
}

#endif
