/* SPDX-License-Identifier: Apache-2.0 */
/* Gyros against accelerometers: over a turn between two holds the rates must carry the vertical u
 * of the first into that of the second, u' = C^T u, C the product of the small rotations w dt.
 * Where some do not, other units and other axes are tried, w -> factor P w with P one of the 48
 * signed permutations: one that explains nearly all turns, and clearly more than the log as it
 * stands, is what went wrong. All turns take part, so that a mistake about an axis that is seldom
 * turned about is found as well.
 *
 * Rotating the axes properly rotates the result, C(P w) = P C(w) P^T for det P = 1; for det P = -1
 * the same with C(-w). So two integrations a factor serve all 48.
 *
 * What P says: the gyros' axes i and j exchanged give the exchange itself, those of the
 * accelerometers its negative (a rotation vector is mirrored with another sign than a force);
 * likewise one axis that is inverted gives one sign or the other two; and both sensors in
 * left-handed axes give -1 times the unit matrix. */
#include "record_diagnostics_internal.h"

#include "base/algebra/vector_internal.h"
#include "imukit/attitude.h"
#include "imukit/elementary.h"
#include "imukit/samples.h"

#include <math.h>

enum { TURNS_MAX = 48, TURNS_MIN = 3, TURN_STEPS = 256, ALL = 48 };

/* A turn must move the vertical by so much to say anything [rad]; and less than that is what
 * biases, scale factors and misalignments of a raw unit explain. */
static const double TURN_LEAST = 0.35, EXPLAINED = 0.26;

imki_axis_unit imki_record_unit(const imk_test_record *record, const imk_model *model, int sensor,
                                int axis)
{
    if (!record->counts[sensor])
        return (imki_axis_unit){1.0, 0.0};
    if (!model)
        return (imki_axis_unit){0.0, 0.0};
    const imk_triad *triad = imk_model_triad(model, sensor);
    const double sensitivity = triad->sensitivity.value[axis];
    if (!triad->present || axis >= triad->axis_count || sensitivity == 0.0)
        return (imki_axis_unit){0.0, 0.0};
    return (imki_axis_unit){1.0 / sensitivity, triad->zero_offset.value[axis]};
}

/* Another explanation must explain this many turns more, leave no more than this share of what is
 * unexplained as the log stands, and of all turns: a bad turn in ten must not hide a mistake, nor
 * some bad turns make one. Of explanations that differ by less than a turn in three, the simplest:
 * turns about few axes cannot tell all 48 apart. */
static const double GAIN = 1.5, LEFT_OF_BEFORE = 0.6, LEFT_OF_ALL = 0.35, MARGIN = 0.33;

typedef struct turn {
    size_t begin, end;
    double from[3], to[3]; /* verticals */
    double bias[3];        /* of the rates, from both holds [rad/s] */
} turn;

typedef struct turns {
    size_t count;
    turn turn[TURNS_MAX];
    imk_quaternion forward[TURNS_MAX], backward[TURNS_MAX]; /* by w and by -w */
} turns;

typedef struct signed_permutation {
    int column[3], sign[3]; /* row i: sign[i] at column[i] */
    int determinant;
} signed_permutation;

static signed_permutation permutation_of(int index)
{
    static const int column[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1},
                                     {1, 0, 2}, {0, 2, 1}, {2, 1, 0}};
    signed_permutation p;
    p.determinant = index / 8 < 3 ? 1 : -1;
    for (int i = 0; i < 3; i++) {
        p.column[i] = column[index / 8][i];
        p.sign[i] = (index >> i) & 1 ? -1 : 1;
        p.determinant *= p.sign[i];
    }
    return p;
}

static bool unit_vertical(const imki_diagnostic_call *call, const imk_static_interval *interval,
                          double u[3])
{
    double square = 0.0;
    for (int i = 0; i < 3; i++) {
        const imki_axis_unit unit = imki_record_unit(call->record, call->model, IMK_ACCEL, i);
        u[i] = (interval->mean[IMK_ACCEL][i] - unit.zero) * unit.unit;
        square += u[i] * u[i];
    }
    for (int i = 0; i < 3; i++)
        u[i] /= sqrt(square);
    return square > 0.0 && isfinite(square);
}

static double angle_between(const double a[3], const double b[3])
{
    double across[3];
    imki_cross3(a, b, across);
    return imk_atan2(imki_norm3(across), imki_dot3(a, b));
}

/* A turn that is complete: no gap, no border of a section, all readings numbers. */
static bool is_complete(const imk_test_record *r, size_t begin, size_t end)
{
    for (size_t k = begin; k < end; k++) {
        if (r->time && imk_step_is_gap(r->time[k] - r->time[k - 1], r->dt))
            return false;
        if (r->section && r->section[k] != r->section[k - 1])
            return false;
        for (int i = 0; i < 3; i++)
            if (!isfinite(r->reading[IMK_GYRO][i][k]))
                return false;
    }
    return true;
}

static void collect_turns(const imki_diagnostic_call *call, turns *t)
{
    t->count = 0;
    for (size_t k = 0; k + 1 < call->interval_count && t->count < TURNS_MAX; k++) {
        const imk_static_interval *a = &call->interval[k], *b = a + 1;
        turn *next = &t->turn[t->count];
        if (!unit_vertical(call, a, next->from) || !unit_vertical(call, b, next->to) ||
            angle_between(next->from, next->to) < TURN_LEAST || a->end == 0 || a->end >= b->begin ||
            !is_complete(call->record, a->end, b->begin))
            continue;
        next->begin = a->end;
        next->end = b->begin;
        for (int i = 0; i < 3; i++)
            next->bias[i] = 0.5 * (a->mean[IMK_GYRO][i] + b->mean[IMK_GYRO][i]);
        t->count++;
    }
}

/* Both rotations of a turn, in at most TURN_STEPS steps of averaged rates. */
static void integrate(const imki_diagnostic_call *call, const turn *t, double factor,
                      imk_quaternion *forward, imk_quaternion *backward)
{
    const imk_test_record *r = call->record;
    const size_t part = (t->end - t->begin + TURN_STEPS - 1) / TURN_STEPS;
    double unit[3];
    for (int i = 0; i < 3; i++)
        unit[i] = factor * r->dt * imki_record_unit(r, call->model, IMK_GYRO, i).unit;
    *forward = *backward = imk_quaternion_identity();
    for (size_t k = t->begin; k < t->end; k += part) {
        const size_t end = k + part < t->end ? k + part : t->end;
        imk_vector3 rotation = {{0.0, 0.0, 0.0}};
        for (int i = 0; i < 3; i++) {
            for (size_t j = k; j < end; j++)
                rotation.v[i] += r->reading[IMK_GYRO][i][j] - t->bias[i];
            rotation.v[i] *= unit[i];
        }
        const imk_quaternion step = imk_quaternion_from_rotation_vector(rotation);
        *forward = imk_quaternion_multiply(*forward, step);
        *backward = imk_quaternion_multiply(*backward, imk_quaternion_conjugate(step));
    }
}

/* Angle by which a turn, its rates permuted, misses the vertical it should lead to. */
static double miss(const turns *t, size_t k, const signed_permutation *p)
{
    /* u' = P C^T P^T u; the sign of a P with determinant -1 cancels. */
    const imk_quaternion c = p->determinant > 0 ? t->forward[k] : t->backward[k];
    imk_vector3 u = {{0.0, 0.0, 0.0}};
    for (int i = 0; i < 3; i++)
        u.v[p->column[i]] = p->sign[i] * t->turn[k].from[i];
    u = imk_quaternion_rotate(imk_quaternion_conjugate(c), u);
    double end[3];
    for (int i = 0; i < 3; i++)
        end[i] = p->sign[i] * u.v[p->column[i]];
    return angle_between(end, t->turn[k].to);
}

/* How badly the turns are explained, from 0 to their number: each counts m^2/(m^2 + e^2), m what it
 * misses by and e what a raw unit may miss by. A turn that fits nothing counts one, however far off
 * it is, and few turns about an axis that hardly takes part in the others are still heard. */
static double cost_of(const turns *t, int index)
{
    const signed_permutation p = permutation_of(index);
    double sum = 0.0;
    for (size_t k = 0; k < t->count; k++) {
        const double m = miss(t, k, &p);
        sum += m * m / (m * m + EXPLAINED * EXPLAINED);
    }
    return sum;
}

static void integrate_all(const imki_diagnostic_call *call, turns *t, double factor)
{
    for (size_t k = 0; k < t->count; k++)
        integrate(call, &t->turn[k], factor, &t->forward[k], &t->backward[k]);
}

/* What a permutation other than the identity means. */
static imk_diagnostic_finding axes_finding(int index, double missed)
{
    const signed_permutation p = permutation_of(index);
    imk_diagnostic_finding f = {.kind = IMK_DIAGNOSTIC_SWAPPED_AXES,
                                .sensor = -1,
                                .axis = -1,
                                .other = -1,
                                .value = missed,
                                .limit = EXPLAINED};
    int negative = 0, fixed = 0;
    for (int i = 0; i < 3; i++) {
        negative += p.sign[i] < 0;
        fixed += p.column[i] == i;
    }
    if (fixed == 3) {
        f.kind = IMK_DIAGNOSTIC_LEFT_HANDED;
        f.sensor = negative == 3 ? -1 : (negative == 1 ? IMK_GYRO : IMK_ACCEL);
        for (int i = 0; i < 3; i++)
            if ((negative == 1 && p.sign[i] < 0) || (negative == 2 && p.sign[i] > 0))
                f.axis = i;
    } else if (fixed == 1) {
        f.sensor = negative == 0 ? IMK_GYRO : (negative == 3 ? IMK_ACCEL : -1);
        for (int i = 2; i >= 0; i--)
            if (p.column[i] != i) {
                f.axis = i;
                f.other = p.column[i];
            }
    }
    return f;
}

/* Root mean square miss of the log as it stands, of the turns it does not explain. */
static double missed_as_is(const turns *t)
{
    const signed_permutation identity = permutation_of(0);
    double sum = 0.0, count = 0.0;
    for (size_t k = 0; k < t->count; k++) {
        const double m = miss(t, k, &identity);
        if (m > EXPLAINED) {
            sum += m * m;
            count += 1.0;
        }
    }
    return count > 0.0 ? sqrt(sum / count) : 0.0;
}

/* An exchange or an inversion within one sensor comes before combinations of them. */
static int complexity(int index)
{
    const imk_diagnostic_finding f = axes_finding(index, 0.0);
    if (index == 0)
        return 0;
    return f.kind == IMK_DIAGNOSTIC_LEFT_HANDED || (f.axis >= 0 && f.sensor >= 0) ? 1 : 2;
}

/* One way to read the log: rates times a factor, permuted. */
typedef struct explanation {
    double factor, cost;
    int index;
} explanation;

/* The simplest explanation that is as good as the best, within MARGIN. `t` is left integrated with
 * another factor. */
static explanation explain(const imki_diagnostic_call *call, turns *t, size_t factors,
                           const double *factor)
{
    enum { FACTORS_MAX = 8 };
    double cost[FACTORS_MAX][ALL], least = HUGE_VAL;
    for (size_t f = 0; f < factors; f++) {
        integrate_all(call, t, factor[f]);
        for (int index = 0; index < ALL; index++) {
            cost[f][index] = cost_of(t, index);
            least = fmin(least, cost[f][index]);
        }
    }
    explanation chosen = {.cost = HUGE_VAL};
    int simplest = 100;
    for (size_t f = 0; f < factors; f++)
        for (int index = 0; index < ALL; index++) {
            const int simple = complexity(index) + (f > 0 ? 3 : 0);
            if (cost[f][index] > least + MARGIN || simple > simplest ||
                (simple == simplest && cost[f][index] >= chosen.cost))
                continue;
            simplest = simple;
            chosen = (explanation){factor[f], cost[f][index], index};
        }
    return chosen;
}

void imki_diagnostic_turns(const imki_diagnostic_call *call, imki_diagnostic_list *list)
{
    static const double degree = 0.017453292519943295;
    /* Rates in deg/s taken for rad/s, the reverse; times in ms or us taken for s, the reverse. */
    const double factor[] = {1.0, degree, 1.0 / degree, 1e-3, 1e-6, 1e3};
    const imk_test_record *r = call->record;
    if (r->axis_count[IMK_GYRO] != 3 || r->axis_count[IMK_ACCEL] != 3)
        return;
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < 3; i++)
            if (!r->reading[sensor][i] || imki_record_unit(r, call->model, sensor, i).unit == 0.0)
                return;
    turns t;
    collect_turns(call, &t);
    if (t.count < TURNS_MIN)
        return;
    integrate_all(call, &t, 1.0);
    const double as_is = cost_of(&t, 0), missed = missed_as_is(&t);
    if (as_is < GAIN)
        return;
    const explanation best = explain(call, &t, sizeof factor / sizeof *factor, factor);
    if ((best.index == 0 && best.factor == 1.0) || as_is - best.cost < GAIN ||
        best.cost > LEFT_OF_BEFORE * as_is || best.cost > LEFT_OF_ALL * (double)t.count)
        return;
    imk_diagnostic_finding unit = {.sensor = IMK_GYRO, .axis = -1, .other = -1};
    if (best.factor == factor[1] || best.factor == factor[2]) {
        unit.kind = IMK_DIAGNOSTIC_RATE_UNIT;
        unit.value = 1.0 / best.factor;
        imki_diagnostic_add(list, unit);
    } else if (best.factor != 1.0) {
        unit.kind = IMK_DIAGNOSTIC_TIME_UNIT;
        unit.sensor = -1;
        unit.value = 1.0 / best.factor;
        imki_diagnostic_add(list, unit);
    }
    if (best.index != 0)
        imki_diagnostic_add(list, axes_finding(best.index, missed));
}
