/* SPDX-License-Identifier: Apache-2.0 */
/* The mechanisation in blocks of samples, written once for every instruction set. No include guard;
 * each strapdown_block_*.c defines first
 *
 *     LANES                    how many mechanisations go side by side: 1, 4 or 8
 *     real                     a double, or a vector of LANES of them
 *     square_root(a)           correctly rounded
 *     fused(a, b, c)           a b + c, rounded once
 *     fused_from(a, b, c)      c - a b, rounded once
 *     larger(a, b)             of two numbers
 *
 * Each lane sees the same operations in the same order whatever LANES is.
 *
 * Samples are taken in pairs, in axes that keep the attitude the body had when the block began, so
 * that q begins with 1. With the rates w1, w2 and forces f1, f2 of a pair and the straight lines
 * through them, w = w1 + w2 and f = f1 + f2,
 *
 *     p  = dt [w + 2/3 dt w1 x w2]                                rotation vector [SAVAGE1998a]
 *     N  = f + 2/3 dt [w1 x f2 + f1 x w2 + w x (b w x f)]
 *        = f + 2/3 dt [w1 x f + w x (b w x f - f1)]               mean force, middle attitude
 *     m  = q (1, tan(x/4) p/x),   q' = 2 cos^2(x/4) m - q,   x = |p|
 *     G  = N + 2 cos^2(x/4) (m0 t + m x t),   t = m x N           [SAVAGE1998b]
 *
 * where b = 3/2 dt (1 - sin(x/2)/(x/2))/x^2: the mean of the turns from -p/2 to p/2 is
 * I + 2/3 b/dt [p]^2. m has the direction of the attitude in the middle and the length 1/cos(x/4):
 * q' is q mirrored in it. Errors are of fourth order in dt: of coning with phase y per sample
 * y^2/20 is missed.
 *
 * A block of m samples, T = m dt. V = dt sum G is the velocity gained, and the way beside the
 * trapezium of the velocities at its ends
 *
 *     T S = 2 dt^2 [sum over pairs of (sum to this pair of G) - (m + 2)/4 sum G]
 *           - dt^2/3 [R(q) f+ - f-]
 *
 * the last the end terms of Euler and Maclaurin's formula [ABRAMOWITZ1964, 23.1.30], f- and f+ the
 * force at the ends of the block by the straight line through the last two samples. Turned to the
 * Earth's axes of the start of the block, V and S take the part of C [<R u> + ...] and S in the
 * equations of strapdown.c; gravity is that where the velocity at the start leads in T/2. Its
 * gradient, D, along the real way adds
 *
 *     T^2/6 D (v' - v) to the velocity,   -T^3/12 D (v' + v)/2 to the position;
 *
 * a sphere's, D = -g/R (I - 3 n n'), is near enough: each is below 1e-7 of what it adds to. */
#include "motion/gravity_kernel.h"
#include "strapdown_block_internal.h"

#include "imukit/elementary.h"

#include <math.h>

#define KERNEL static inline __attribute__((always_inline))

/* 1/(2 R) of a sphere [1/m] */
#define HALF_CURVATURE (0.5 / 6371e3)

typedef struct vector {
    real v[3];
} vector;

typedef struct quaternion {
    real w, x, y, z;
} quaternion;

/* One sample of all lanes: rate x, y, z, force x, y, z. */
typedef struct reading {
    real channel[6];
} reading;

/* Where a block is. */
typedef struct gathered {
    quaternion turn;
    vector gain, way;
} gathered;

KERNEL real spread(double x)
{
    return x - (real){0.0};
}

KERNEL vector rate_of(const reading *r)
{
    return (vector){{r->channel[0], r->channel[1], r->channel[2]}};
}

KERNEL vector force_of(const reading *r)
{
    return (vector){{r->channel[3], r->channel[4], r->channel[5]}};
}

KERNEL vector scaled(real factor, vector a)
{
    return (vector){{factor * a.v[0], factor * a.v[1], factor * a.v[2]}};
}

KERNEL vector sum(vector a, vector b)
{
    return (vector){{a.v[0] + b.v[0], a.v[1] + b.v[1], a.v[2] + b.v[2]}};
}

KERNEL vector difference(vector a, vector b)
{
    return (vector){{a.v[0] - b.v[0], a.v[1] - b.v[1], a.v[2] - b.v[2]}};
}

/* factor a + b */
KERNEL vector scaled_plus(real factor, vector a, vector b)
{
    return (vector){{fused(factor, a.v[0], b.v[0]), fused(factor, a.v[1], b.v[1]),
                     fused(factor, a.v[2], b.v[2])}};
}

KERNEL real dot(vector a, vector b)
{
    return fused(a.v[2], b.v[2], fused(a.v[1], b.v[1], a.v[0] * b.v[0]));
}

KERNEL vector cross(vector a, vector b)
{
    return (vector){{fused_from(a.v[2], b.v[1], a.v[1] * b.v[2]),
                     fused_from(a.v[0], b.v[2], a.v[2] * b.v[0]),
                     fused_from(a.v[1], b.v[0], a.v[0] * b.v[1])}};
}

/* a x b + c */
KERNEL vector cross_plus(vector a, vector b, vector c)
{
    return (vector){{fused_from(a.v[2], b.v[1], fused(a.v[1], b.v[2], c.v[0])),
                     fused_from(a.v[0], b.v[2], fused(a.v[2], b.v[0], c.v[1])),
                     fused_from(a.v[1], b.v[0], fused(a.v[0], b.v[1], c.v[2]))}};
}

/* q (0, r) + c */
KERNEL quaternion product_plus(quaternion q, vector r, quaternion c)
{
    return (quaternion){
        fused_from(q.z, r.v[2], fused_from(q.y, r.v[1], fused_from(q.x, r.v[0], c.w))),
        fused_from(q.z, r.v[1], fused(q.y, r.v[2], fused(q.w, r.v[0], c.x))),
        fused_from(q.x, r.v[2], fused(q.z, r.v[0], fused(q.w, r.v[1], c.y))),
        fused_from(q.y, r.v[0], fused(q.x, r.v[1], fused(q.w, r.v[2], c.z)))};
}

/* v + scale (w t + u x t), t = u x v: turned by a quaternion of squared length 2/scale. */
KERNEL vector rotated(quaternion q, real scale, vector v)
{
    const vector u = {{q.x, q.y, q.z}};
    const vector t = cross(u, v);
    return scaled_plus(scale, cross_plus(u, t, scaled(q.w, t)), v);
}

/* ---- pairs of samples ------------------------------------------------------------------------ */

typedef struct factors {
    real tangent, scale, bend;
} factors;

/* By series in n = (x/dt)^2; their next terms are below 1e-11 at a turn of 1/4 rad per pair, and
 * go with the eighth power of it. */
KERNEL factors small_turn(const imki_sample_constants *k, real n)
{
    const real high = fused(n, spread(k->tangent[3]), spread(k->tangent[2]));
    const real high_scale = fused(n, spread(k->scale[3]), spread(k->scale[2]));
    return (factors){
        .tangent = fused(n, fused(n, high, spread(k->tangent[1])), spread(k->tangent[0])),
        .scale = fused(n, fused(n, high_scale, spread(k->scale[1])), spread(k->scale[0])),
        .bend = fused(n, spread(k->bend[1]), spread(k->bend[0]))};
}

/* Lanes that turn faster than that. */
static factors any_turn(const imki_sample_constants *k, real n)
{
    union {
        real all;
        double lane[LANES];
    } square = {.all = n}, part[3];
    const factors small = small_turn(k, n);
    part[0].all = small.tangent;
    part[1].all = small.scale;
    part[2].all = small.bend;
    for (int i = 0; i < LANES; i++) {
        if (!(square.lane[i] > k->limit))
            continue;
        const double rate = sqrt(square.lane[i]), x = k->dt * rate, cosine = imk_cos(0.25 * x);
        part[0].lane[i] = imk_sin(0.25 * x) / (cosine * rate);
        part[1].lane[i] = 2.0 * cosine * cosine;
        part[2].lane[i] = 1.5 * k->dt * (1.0 - imk_sin(0.5 * x) / (0.5 * x)) / (x * x);
    }
    return (factors){part[0].all, part[1].all, part[2].all};
}

/* What a pair adds, the attitude before it apart. */
typedef struct step {
    vector tangent, force; /* tan(x/4) p/x, N */
    real scale, square;    /* 2 cos^2(x/4), n */
} step;

KERNEL step step_of(const imki_sample_constants *k, bool fast, const reading pair[2])
{
    const real share = spread(k->share);
    const vector w1 = rate_of(&pair[0]), w2 = rate_of(&pair[1]), w = sum(w1, w2);
    const vector f1 = force_of(&pair[0]), f = sum(f1, force_of(&pair[1]));
    const vector p = scaled_plus(share, cross(w1, w2), w);
    const real n = dot(p, p);
    const factors x = fast ? any_turn(k, n) : small_turn(k, n);
    const vector wf = cross(w, f);
    const vector inner = {{fused(x.bend, wf.v[0], -f1.v[0]), fused(x.bend, wf.v[1], -f1.v[1]),
                           fused(x.bend, wf.v[2], -f1.v[2])}};
    const vector beside = cross_plus(w1, f, cross(w, inner));
    return (step){.tangent = scaled(x.tangent, p),
                  .force = scaled_plus(share, beside, f),
                  .scale = x.scale,
                  .square = n};
}

KERNEL void take_step(const step *by, gathered *g)
{
    const quaternion q = g->turn, m = product_plus(q, by->tangent, q);
    const real s = by->scale;
    g->turn = (quaternion){fused(s, m.w, -q.w), fused(s, m.x, -q.x), fused(s, m.y, -q.y),
                           fused(s, m.z, -q.z)};
    g->gain = sum(g->gain, rotated(m, s, by->force));
    g->way = sum(g->way, g->gain);
}

KERNEL bool any_above(real a, double limit)
{
    union {
        real all;
        double lane[LANES];
    } u = {.all = a};
    bool above = false;
    for (int i = 0; i < LANES; i++)
        above |= u.lane[i] > limit;
    return above;
}

/* Not inlined, as it hardly ever runs. */
static __attribute__((noinline)) void take_fast(const imki_sample_constants *k,
                                                const reading *sample, size_t pairs, gathered *g)
{
    for (size_t i = 0; i < pairs; i++) {
        const step by = step_of(k, true, sample + 2 * i);
        take_step(&by, g);
    }
}

static void take_pairs(const imki_sample_constants *k, const reading *sample, size_t pairs,
                       gathered *g)
{
    gathered next = *g;
    real largest = spread(0.0);
    for (size_t i = 0; i < pairs; i++) {
        const step by = step_of(k, false, sample + 2 * i);
        largest = larger(largest, by.square);
        take_step(&by, &next);
    }
    if (any_above(largest, k->limit))
        take_fast(k, sample, pairs, g);
    else
        *g = next;
}

/* ---- the end of a block ---------------------------------------------------------------------- */

typedef struct carrier {
    vector position, position_low, velocity;
    quaternion attitude, attitude_low;
    real time;
    reading last, before;
    gathered block;
    vector force;
    real height, climb;
} carrier;

/* sum += more, what is lost to rounding carried to the next one [HIGHAM2002, alg. 4.2]. */
KERNEL void add(real *total, real *low, real more)
{
    const real all = more + *low, next = *total + all;
    *low = all - (next - *total);
    *total = next;
}

/* The force at the end of the last of two samples. */
KERNEL vector force_after(const reading *last, const reading *before)
{
    const real half = spread(0.5);
    return scaled_plus(half, difference(force_of(last), force_of(before)), force_of(last));
}

/* h x a, h along the axis of the Earth */
KERNEL vector earth_cross(real h, vector a)
{
    return (vector){{-(h * a.v[1]), h * a.v[0], spread(0.0)}};
}

/* To Earth axes of the middle of the block. */
KERNEL vector half_turned(const imki_block_constants *k, vector a)
{
    const real s = spread(k->sine), c = spread(k->cosine_to_one);
    return (vector){{a.v[0] + fused_from(c, a.v[0], s * a.v[1]),
                     a.v[1] - fused(c, a.v[1], s * a.v[0]), a.v[2]}};
}

/* q' = q(-h) q q(block), as in strapdown.c; (1 - |q|^2)/2 of it keeps the length, of what has been
 * turned, as that is far from q after a fast turn. */
KERNEL void turn_attitude(const imki_block_constants *k, carrier *c)
{
    quaternion *q = &c->attitude, *low = &c->attitude_low;
    const quaternion turn = c->block.turn;
    const real less = turn.w - 1.0;
    const quaternion b =
        product_plus(*q, (vector){{turn.x, turn.y, turn.z}},
                     (quaternion){less * q->w, less * q->x, less * q->y, less * q->z});
    const quaternion m = {q->w + b.w, q->x + b.x, q->y + b.y, q->z + b.z};
    const real one = spread(k->cosine_to_one), e = spread(k->sine), half = spread(0.5);
    const real square = fused(q->z, q->z, fused(q->y, q->y, fused(q->x, q->x, q->w * q->w)));
    const real length = half - half * square;
    add(&q->w, &low->w, b.w + fused(length, m.w, fused(e, m.z, -(one * m.w))));
    add(&q->x, &low->x, b.x + fused(length, m.x, fused(e, m.y, -(one * m.x))));
    add(&q->y, &low->y, b.y + fused(length, m.y, fused_from(one, m.y, -(e * m.x))));
    add(&q->z, &low->z, b.z + fused(length, m.z, fused_from(one, m.z, -(e * m.w))));
}

/* (a - 3 n n'a) factor: what a displacement takes from gravity. */
KERNEL vector gradient(real factor, vector up, vector a)
{
    const real along = dot(up, a);
    return scaled(factor, scaled_plus(-3.0 * along, up, a));
}

/* Where the velocity at the start of a block leads in half of it: gravity, the vertical and the
 * height there. Found in four parts, each of which waits long for itself. */
typedef struct place {
    vector middle, gravity, up;
    real square, inverse; /* of the distance from the axis; 1/r */
    slope parametric, vertical;
    real height;
} place;

KERNEL void find_distance(const imki_block_constants *k, const carrier *c, place *at)
{
    at->middle = scaled_plus(spread(k->half_length), c->velocity, c->position);
    const real *const r = at->middle.v;
    at->square = r[0] * r[0] + r[1] * r[1];
    at->inverse = 1.0 / square_root(at->square + r[2] * r[2]);
}

KERNEL void find_parametric(place *at)
{
    at->parametric = parametric_slope(at->middle.v[2], at->inverse);
}

KERNEL void find_vertical(place *at)
{
    at->vertical = vertical_from(at->parametric, at->square, at->middle.v[2], at->inverse);
}

KERNEL void find_gravity(place *at)
{
    const slope vertical = at->vertical;
    const real *const r = at->middle.v;
    at->up = (vector){{vertical.k * r[0], vertical.k * r[1], vertical.s}};
    at->height = height_along(vertical, at->square, r[2]);
    gravity_along(vertical, at->height, r, at->gravity.v);
}

KERNEL place place_halfway(const imki_block_constants *k, const carrier *c)
{
    place at;
    find_distance(k, c, &at);
    find_parametric(&at);
    find_vertical(&at);
    find_gravity(&at);
    return at;
}

/* V and S of the head, in Earth axes of the start of the block. */
KERNEL void integrals(const imki_block_constants *k, const carrier *c, vector *force,
                      vector *scrolling)
{
    const gathered *g = &c->block;
    const real two = spread(2.0), middle = spread(k->middle);
    const vector end = force_after(&c->last, &c->before);
    const vector edge = difference(rotated(g->turn, two, end), c->force);
    const vector beside = {{fused_from(middle, g->gain.v[0], g->way.v[0]),
                            fused_from(middle, g->gain.v[1], g->way.v[1]),
                            fused_from(middle, g->gain.v[2], g->way.v[2])}};
    const vector s = scaled_plus(spread(-k->edge), edge, scaled(spread(k->way_share), beside));
    *force = half_turned(k, rotated(c->attitude, two, scaled(spread(k->dt), g->gain)));
    *scrolling = rotated(c->attitude, two, s);
}

/* (v + v')/2 without a vertical channel: m + h x m = v + gain/2, then the gradient. */
KERNEL vector mean_velocity(const imki_block_constants *k, const place *at, vector velocity,
                            vector force, vector scrolling)
{
    const real h = spread(k->angle), half = spread(0.5), solved = spread(k->solved);
    const vector turned =
        earth_cross(h, sum(scrolling, scaled(spread(0.125), earth_cross(h, force))));
    const vector gain = scaled_plus(spread(k->length), at->gravity, difference(force, turned));
    const vector a = scaled_plus(half, gain, velocity);
    const vector mean = {
        {solved * fused(h, a.v[1], a.v[0]), solved * fused_from(h, a.v[0], a.v[1]), a.v[2]}};
    return difference(mean,
                      gradient(spread(k->gradient_velocity), at->up, difference(mean, velocity)));
}

/* The way during a block: T (mean velocity + S + h x (3 F + 2 g T)/12), and the gradient. */
KERNEL vector way_of(const imki_block_constants *k, const place *at, vector mean, vector force,
                     vector scrolling)
{
    const real twelfth = spread(k->angle * (1.0 / 12)), three = spread(3.0);
    const vector fall = scaled(spread(2.0 * k->length), at->gravity);
    const vector coriolis = earth_cross(twelfth, scaled_plus(three, force, fall));
    const vector all = sum(mean, sum(scrolling, coriolis));
    return sum(scaled(spread(k->length), all),
               gradient(spread(k->gradient_position), at->up, mean));
}

/* The vertical at the end of the block: that half-way, turned by the way from there. */
KERNEL vector up_after(const imki_block_constants *k, const place *at, vector velocity)
{
    const real along = dot(at->up, velocity);
    return scaled_plus(spread(k->vertical), scaled_plus(-along, at->up, velocity), at->up);
}

/* The climb, along the vertical at the end, is held by a constant force along that half-way, which
 * Coriolis turns as any other: half of what it adds to the velocity. */
KERNEL vector held_climb(const imki_block_constants *k, const place *at, vector up, real climb,
                         vector velocity)
{
    const real half = 0.5 * (climb - dot(up, velocity));
    return scaled(half, difference(at->up, earth_cross(spread(k->angle), at->up)));
}

/* By how much the end of a way is too high. Horizontally by d from where height and vertical are
 * known, the ellipsoid is d^2/(2 R) lower. */
KERNEL real excess_height(const imki_block_constants *k, const carrier *c, const place *at,
                          vector way)
{
    const vector d = scaled_plus(spread(-k->half_length), c->velocity, way);
    const real rise = dot(at->up, d), across = dot(d, d) - rise * rise;
    return (at->height - c->height) + (rise + across * HALF_CURVATURE);
}

/* The end of a block, in four parts for the same reason: integrals(), velocity, position, attitude.
 */
typedef struct ending {
    vector force, scrolling, mean, velocity;
} ending;

KERNEL void end_velocity(const imki_block_constants *k, bool hold_height, const place *at,
                         const carrier *c, ending *e)
{
    e->mean = mean_velocity(k, at, c->velocity, e->force, e->scrolling);
    e->velocity = difference(scaled(spread(2.0), e->mean), c->velocity);
    if (hold_height) {
        const vector up = up_after(k, at, e->velocity);
        const vector held = held_climb(k, at, up, c->climb, e->velocity);
        e->mean = sum(e->mean, held);
        e->velocity = scaled_plus(spread(2.0), held, e->velocity);
    }
}

KERNEL void end_position(const imki_block_constants *k, bool hold_height, const place *at,
                         const ending *e, carrier *c)
{
    vector way = way_of(k, at, e->mean, e->force, e->scrolling);
    if (hold_height)
        way = scaled_plus(-excess_height(k, c, at, way), at->up, way);
    for (int i = 0; i < 3; i++)
        add(&c->position.v[i], &c->position_low.v[i], way.v[i]);
    c->velocity = e->velocity;
    c->time += k->length;
}

KERNEL void end_attitude(const imki_block_constants *k, carrier *c)
{
    c->force = force_after(&c->last, &c->before);
    turn_attitude(k, c);
    c->block = (gathered){{spread(1.0), spread(0.0), spread(0.0), spread(0.0)},
                          {{spread(0.0), spread(0.0), spread(0.0)}},
                          {{spread(0.0), spread(0.0), spread(0.0)}}};
}

KERNEL void end_block(const imki_block_constants *k, bool hold_height, const place *at, carrier *c)
{
    ending e;
    integrals(k, c, &e.force, &e.scrolling);
    end_velocity(k, hold_height, at, c, &e);
    end_position(k, hold_height, at, &e, c);
    end_attitude(k, c);
}
