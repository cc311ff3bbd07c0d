/* SPDX-License-Identifier: Apache-2.0 */
/* ARMA(2,2) sequences: spectrum, stationary start, recursion. */
#include "arma_internal.h"

/* S(f) = dt |B|^2/|A|^2 at z = exp(2 pi i f dt), with u = sin^2(pi f dt):
 *
 *     |B|^2 = B(1)^2 - 4 (b1 (b0 + b2) + 4 b0 b2) u + 16 b0 b2 u^2
 *     |A|^2 = product over the poles p e^(i angle) of (1-p)^2 + 4 p sin^2(pi f dt -+ angle/2)
 *
 * a sum of positive parts for each pole, so that nothing cancels at a sharp resonance. */
double imk_arma_spectrum(const imk_arma *arma, double frequency)
{
    double half = IMKI_PI * frequency * arma->dt;
    double sine = imk_sin(half), u = sine * sine;
    double level = arma->b0 + arma->b1 + arma->b2, product = arma->b0 * arma->b2;
    double numerator = level * level -
                       4.0 * (arma->b1 * (arma->b0 + arma->b2) + 4.0 * product) * u +
                       16.0 * product * u * u;
    double minus = imk_sin(half - 0.5 * arma->angle), plus = imk_sin(half + 0.5 * arma->angle);
    double first = arma->distance[0] * arma->distance[0] + 4.0 * arma->pole[0] * minus * minus;
    double second = arma->distance[1] * arma->distance[1] + 4.0 * arma->pole[1] * plus * plus;
    return arma->dt * numerator / (first * second);
}

/* The recursion needs y[-1], y[-2], e[-1], e[-2]. With the impulse response g0 = b0,
 * g1 = b1 + a1 b0:  y[-1] = g0 e[-1] + g1 e[-2] + r1,  y[-2] = g0 e[-2] + r2, and r1, r2 are
 * independent of both innovations. Their covariance is drawn through d = r1 - r2, whose variance
 * follows from the decrement without cancellation however slow the sequence is:
 *
 *     var d = 2 decrement - g0^2 - (g1 - g0)^2,   var r2 = variance - g0^2,
 *     cov(r2, d) = g0^2 - g0 g1 - decrement                                                     */
imk_status imk_arma_start(imk_arma_state *state, const imk_arma *arma, imk_random random,
                          uint64_t stream)
{
    double normal[4];
    imk_random_normals(random, stream, IMKI_START_NORMAL, 4, normal);
    double g0 = arma->b0, g1 = arma->b1 + arma->a1 * arma->b0;
    double variance_d = 2.0 * arma->decrement - g0 * g0 - (g1 - g0) * (g1 - g0);
    double variance_r = arma->variance - g0 * g0;
    double covariance = g0 * g0 - g0 * g1 - arma->decrement;
    double d = 0.0, r = 0.0;
    if (variance_d > 0.0) {
        double slope = covariance / variance_d;
        d = sqrt(variance_d) * normal[2];
        r = slope * d;
        variance_r -= slope * covariance;
    }
    if (variance_r > 0.0)
        r += sqrt(variance_r) * normal[3];
    *state = (imk_arma_state){.random = random,
                              .stream = stream,
                              .a1 = arma->a1,
                              .a2 = arma->a2,
                              .b0 = arma->b0,
                              .b1 = arma->b1,
                              .b2 = arma->b2,
                              .y1 = g0 * normal[0] + g1 * normal[1] + r + d,
                              .y2 = g0 * normal[1] + r,
                              .e1 = normal[0],
                              .e2 = normal[1],
                              .block.used = IMK_NOISE_BLOCK};
    return IMK_OK;
}

/* One sequence alone. */
static void add_block(imk_arma_state *state, double *block)
{
    double normals[IMK_NOISE_BLOCK];
    imk_random_normals(state->random, state->stream, state->next, IMK_NOISE_BLOCK, normals);
    state->next += IMK_NOISE_BLOCK;
    double y1 = state->y1, y2 = state->y2, e1 = state->e1, e2 = state->e2;
    for (size_t k = 0; k < IMK_NOISE_BLOCK; k++) {
        double e = normals[k];
        /* y[k-1] last: only one multiplication and addition wait for the sample before. */
        double y = (state->b0 * e + state->b1 * e1 + state->b2 * e2) + state->a2 * y2;
        y += state->a1 * y1;
        block[imki_place(k)] += y;
        y2 = y1;
        y1 = y;
        e2 = e1;
        e1 = e;
    }
    state->y1 = y1;
    state->y2 = y2;
    state->e1 = e1;
    state->e2 = e2;
}

static void load_lane(imki_arma_lanes *lanes, size_t lane, const imk_arma_state *state)
{
    lanes->a1[lane] = state->a1;
    lanes->a2[lane] = state->a2;
    lanes->b0[lane] = state->b0;
    lanes->b1[lane] = state->b1;
    lanes->b2[lane] = state->b2;
    lanes->y1[lane] = state->y1;
    lanes->y2[lane] = state->y2;
    lanes->e1[lane] = state->e1;
    lanes->e2[lane] = state->e2;
}

static void store_lane(const imki_arma_lanes *lanes, size_t lane, imk_arma_state *state)
{
    state->y1 = lanes->y1[lane];
    state->y2 = lanes->y2[lane];
    state->e1 = lanes->e1[lane];
    state->e2 = lanes->e2[lane];
    state->next += IMK_NOISE_BLOCK;
}

/* Half a block at a time, for the sake of the stack. Spare lanes have coefficients of zero, and the
 * normals of the first. */
void imki_arma_blocks(imk_arma_state *const *states, size_t count, double *const *blocks)
{
    enum { HALF = IMK_NOISE_BLOCK / 2, LANES = IMKI_ARMA_LANES };
    IMKI_ALIGNED double normals[LANES][HALF];
    imki_draw draws[LANES];
    imki_arma_lanes lanes = {.count = count};
    if (count == 1)
        add_block(states[0], blocks[0]);
    if (count <= 1)
        return;
    for (size_t i = 0; i < LANES; i++)
        lanes.normals[i] = normals[0];
    for (size_t i = 0; i < count; i++) {
        load_lane(&lanes, i, states[i]);
        lanes.normals[i] = normals[i];
        lanes.block[i] = blocks[i];
    }
    for (size_t half = 0; half < 2; half++) {
        for (size_t i = 0; i < count; i++)
            draws[i] =
                imki_draw_of(states[i]->stream, states[i]->next + half * HALF, HALF, normals[i]);
        imki_random_draws(states[0]->random, draws, count);
        imki_add_arma(states[0]->random.kernel, &lanes, half);
    }
    for (size_t i = 0; i < count; i++)
        store_lane(&lanes, i, states[i]);
}

void imki_arma_across(void *const *states, size_t count, double *const *blocks)
{
    for (size_t first = 0; first < count; first += IMKI_ARMA_LANES) {
        imk_arma_state *some[IMKI_ARMA_LANES];
        const size_t left = count - first, now = left < IMKI_ARMA_LANES ? left : IMKI_ARMA_LANES;
        for (size_t i = 0; i < now; i++)
            some[i] = states[first + i];
        imki_arma_blocks(some, now, blocks + first);
    }
}

static void next_block(void *state, double *block)
{
    add_block(state, block);
}

void imk_arma_add(imk_arma_state *state, size_t count, double *out)
{
    imki_add_blocks(&state->block, next_block, state, count, out);
}

imk_arma imki_arma_design(const double autocovariance[3], const imki_dynamics *dynamics, double dt)
{
    const double *c = autocovariance;
    double one = c[0] + 2.0 * (c[1] + c[2]), minus_one = c[0] - 2.0 * (c[1] - c[2]);
    double at_one = sqrt(one > 0.0 ? one : 0.0);
    double at_minus_one = sqrt(minus_one > 0.0 ? minus_one : 0.0);
    double outer = 0.5 * (at_one + at_minus_one); /* b0 + b2 */
    double square = outer * outer - 4.0 * c[2];   /* (b0 - b2)^2 */
    imk_arma arma = {.dt = dt};
    arma.b0 = 0.5 * (outer + sqrt(square > 0.0 ? square : 0.0));
    arma.b1 = 0.5 * (at_one - at_minus_one);
    arma.b2 = arma.b0 > 0.0 ? c[2] / arma.b0 : 0.0;
    if (dynamics->angular > 0.0) {
        double modulus = imk_exp(-dynamics->rate[0] * dt);
        arma.angle = imki_angle_of(dynamics->angular, dt);
        arma.pole[0] = arma.pole[1] = modulus;
        arma.distance[0] = arma.distance[1] = -imk_expm1(-dynamics->rate[0] * dt);
        arma.a1 = 2.0 * modulus * imk_cos(arma.angle);
    } else {
        for (int i = 0; i < 2; i++) {
            arma.pole[i] = imk_exp(-dynamics->rate[i] * dt);
            arma.distance[i] = -imk_expm1(-dynamics->rate[i] * dt);
        }
        arma.a1 = arma.pole[0] + arma.pole[1];
    }
    arma.a2 = -arma.pole[0] * arma.pole[1];
    return arma;
}
