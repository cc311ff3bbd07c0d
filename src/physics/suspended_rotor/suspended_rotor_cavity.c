/* SPDX-License-Identifier: Apache-2.0 */
/* The ball between its electrodes and its stops, in case axes: x from the middle, f the specific
 * force, u the pulls over the mass,
 *
 *     x'' = u - f,      u = f - w^2 x - 2 z w x'   within   -limit (gap/(gap + x))^2 ... limit
 *                                                                           (gap/(gap - x))^2
 *
 * axis by axis. The control knows the force, so that the ball rests in the middle while no axis is
 * at its limit; from there on an electrode pulls with its full voltage, and the less the farther
 * the ball is. The stop is a sphere. An impact returns the part `restitution` of the speed; a
 * contact that is pressed on is a row of impacts, one a step, without return, whose impulses are
 * the force's. The surface slides far faster than the ball moves, so friction is `friction` times
 * the impulse against the sliding. */
#include "suspended_rotor_internal.h"

#include "base/algebra/vector_internal.h"

#include <math.h>

/* Damping ratio of the control. */
#define DAMPING 0.7
/* Steps to the fall, and to a radian of the control. */
#define FINENESS 16.0
/* Nearer than this part of the clearance, and slower than it a radian of the control, is rest. */
#define REST 1e-3
/* Below this part of that, a component is none. */
#define NOTHING 1e-9
/* A ball that meets the stop with less than this many steps' change of its speed is pressed on it.
 */
#define PRESSED 4.0

double imk_suspended_rotor_touch_down(const imk_suspended_rotor *design)
{
    return design->limit;
}

double imk_suspended_rotor_lift_off(const imk_suspended_rotor *design)
{
    const double part = design->gap / (design->gap + design->clearance);
    return design->limit * part * part;
}

double imk_suspended_rotor_impact(const imk_suspended_rotor *design, double force)
{
    const double mean = design->limit * design->gap / (design->gap + design->clearance);
    return force > design->limit ? sqrt(2.0 * design->clearance * (force - mean)) : 0.0;
}

double imk_suspended_rotor_run_down(const imk_suspended_rotor *design, double force)
{
    const double pressed = force - imk_suspended_rotor_lift_off(design);
    const double torque = design->friction * 0.5 * design->diameter *
                          imk_suspended_rotor_mass(design) * (pressed > 0.0 ? pressed : 0.0);
    return imk_suspended_rotor_momentum(design) / torque;
}

imki_suspended_cavity imki_suspended_cavity_of(const imk_suspended_rotor *design)
{
    const double w = 2.0 * IMKI_PI * design->bandwidth;
    return (imki_suspended_cavity){
        .mass = imk_suspended_rotor_mass(design),
        .limit = design->limit,
        .gap = design->gap,
        .clearance = design->clearance,
        .stiffness = w * w,
        .damping = 2.0 * DAMPING * w,
        .restitution = design->restitution,
        .friction = design->friction,
    };
}

static bool is_carried(const imki_suspended_cavity *cavity, const double force[3])
{
    return fabs(force[0]) <= cavity->limit && fabs(force[1]) <= cavity->limit &&
           fabs(force[2]) <= cavity->limit;
}

bool imki_suspended_held(const imki_suspended_cavity *cavity, const double force[3])
{
    return !cavity->away && is_carried(cavity, force);
}

size_t imki_suspended_steps(const imki_suspended_cavity *cavity, const double force[3],
                            double duration)
{
    const double fall = sqrt(2.0 * cavity->clearance / (imki_norm3(force) + cavity->limit));
    const double turn = 1.0 / sqrt(cavity->stiffness);
    const double away = sqrt(0.5 * cavity->gap / cavity->limit);
    return (size_t)ceil(FINENESS * duration / fmin(fall, fmin(turn, away)));
}

/* What the electrodes of an axis can do of what is asked, at the displacement x. */
static double pull(const imki_suspended_cavity *cavity, double asked, double x)
{
    const double distance = asked > 0.0 ? cavity->gap - x : cavity->gap + x;
    const double part = cavity->gap / distance;
    return imki_clamped(asked, cavity->limit * part * part);
}

static void note(imki_suspended_cavity *cavity, const double force[3], const double normal[3],
                 double speed, double time)
{
    static const char *const axes[] = {"-x", "-y", "-z", "+x", "+y", "+z"};
    int k = 0;
    if (cavity->touched)
        return;
    for (int i = 1; i < 3; i++)
        k = fabs(normal[i]) > fabs(normal[k]) ? i : k;
    cavity->touched = true;
    cavity->time = time;
    cavity->force = fabs(force[k]);
    cavity->speed = speed;
    cavity->axis = axes[normal[k] > 0.0 ? k + 3 : k];
}

/* s x n, of unit length: how the surface moves at the place of contact; zeros where it stands. */
static void sliding(const double s[3], const double n[3], double direction[3])
{
    imki_cross3(s, n, direction);
    const double length = imki_norm3(direction);
    for (int k = 0; k < 3; k++)
        direction[k] = length > 0.0 ? direction[k] / length : 0.0;
}

/* The ball is at its stop or beyond it: back to it, and its speed turned round. An impact has the
 * speed with which the ball passed the stop, v^2 - 2 a times what it went beyond. */
static imki_suspended_push meet_stop(imki_suspended_cavity *cavity, const double force[3],
                                     const double spin[3], const double a[3], double step,
                                     double time)
{
    imki_suspended_push push = {.impulse = 0.0};
    double *x = cavity->x, *v = cavity->v, slide[3];
    const double distance = imki_norm3(x), beyond = distance - cavity->clearance;
    for (int k = 0; k < 3; k++) {
        push.normal[k] = x[k] / distance;
        x[k] = push.normal[k] * cavity->clearance;
    }
    const double reached = imki_dot3(v, push.normal);
    if (!(reached > 0.0))
        return push;
    const bool impact = reached > PRESSED * step * imki_norm3(a);
    const double square = reached * reached - 2.0 * beyond * imki_dot3(a, push.normal);
    const double speed = impact && square > 0.0 ? sqrt(square) : reached;
    note(cavity, force, push.normal, speed, time - beyond / reached);
    const double change = reached + (impact ? cavity->restitution * speed : 0.0);
    sliding(spin, push.normal, slide);
    for (int k = 0; k < 3; k++)
        v[k] -= change * (push.normal[k] + cavity->friction * slide[k]);
    push.impulse = cavity->mass * change;
    return push;
}

/* The control only comes near to rest: what hardly differs from it is rest. */
static void settle(imki_suspended_cavity *cavity, const double force[3])
{
    const double w = sqrt(cavity->stiffness), far = REST * cavity->clearance;
    double *x = cavity->x, *v = cavity->v;
    for (int k = 0; k < 3; k++)
        if (fabs(x[k]) < NOTHING * far && fabs(v[k]) < NOTHING * far * w)
            x[k] = v[k] = 0.0;
    if (!is_carried(cavity, force) || imki_norm3(x) >= far || imki_norm3(v) >= far * w)
        return;
    for (int k = 0; k < 3; k++)
        x[k] = v[k] = 0.0;
    cavity->away = false;
}

imki_suspended_push imki_suspended_move(imki_suspended_cavity *cavity, const double force[3],
                                        const double spin[3], double step, double time)
{
    double *x = cavity->x, *v = cavity->v, a[3];
    cavity->away = true;
    for (int k = 0; k < 3; k++) {
        x[k] += 0.5 * step * v[k];
        const double asked = force[k] - cavity->stiffness * x[k] - cavity->damping * v[k];
        a[k] = pull(cavity, asked, x[k]) - force[k];
        v[k] += step * a[k];
        x[k] += 0.5 * step * v[k];
    }
    settle(cavity, force);
    return imki_norm3(x) >= cavity->clearance ? meet_stop(cavity, force, spin, a, step, time)
                                              : (imki_suspended_push){.impulse = 0.0};
}

/* The force that the electrodes do not carry, over the mass. @return its size */
static double left_over(const imki_suspended_cavity *cavity, const double force[3],
                        double excess[3])
{
    for (int k = 0; k < 3; k++)
        excess[k] = force[k] - pull(cavity, force[k], cavity->x[k]);
    return imki_norm3(excess);
}

imki_suspended_push imki_suspended_rest(imki_suspended_cavity *cavity, const double force[3],
                                        double step, double time)
{
    enum { ROUNDS = 20 }; /* the place on the stop, where the pulls depend on it */
    imki_suspended_push push = {.impulse = 0.0};
    double excess[3], size = left_over(cavity, force, excess);
    for (int i = 0; i < ROUNDS && size > 0.0; i++) {
        for (int k = 0; k < 3; k++) {
            push.normal[k] = (0.0 - excess[k]) / size; /* no -0 */
            cavity->x[k] = cavity->clearance * push.normal[k];
        }
        size = left_over(cavity, force, excess);
    }
    cavity->away = size > 0.0;
    if (!cavity->away) {
        for (int k = 0; k < 3; k++)
            cavity->x[k] = 0.0;
        return push;
    }
    note(cavity, force, push.normal, 0.0, time);
    push.impulse = cavity->mass * size * step;
    return push;
}
