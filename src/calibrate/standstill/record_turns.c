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
 * What P means, and which other mendings explain the same: axes_mending.c. */
#include "record_diagnostics_internal.h"

#include "base/algebra/vector_internal.h"
#include "imukit/attitude.h"
#include "imukit/axes_mending.h"
#include "imukit/elementary.h"
#include "imukit/samples.h"

#include <math.h>

enum { TURNS_MAX = 48, TURNS_MIN = 3, TURN_STEPS = 256 };

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

/* A turn that is complete: no gap, all readings numbers. Without times, sections may have been cut
 * out of a longer log. */
static bool is_complete(const imk_test_record *r, size_t begin, size_t end)
{
    for (size_t k = begin; k < end; k++) {
        if (r->time && imk_step_is_gap(r->time[k] - r->time[k - 1], r->dt))
            return false;
        if (!r->time && r->section && r->section[k] != r->section[k - 1])
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
static double miss(const turns *t, size_t k, const imk_signed_axes *p)
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
    const imk_signed_axes p = imk_signed_axes_of(index);
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

/* What is wrong with the axes, by the simplest mending. */
static imk_diagnostic_finding axes_finding(uint64_t classes, double missed)
{
    imk_axes_mending mending[IMK_AXES_MENDINGS_MAX];
    imk_diagnostic_finding f = {.kind = IMK_DIAGNOSTIC_SWAPPED_AXES,
                                .sensor = -1,
                                .axis = -1,
                                .other = -1,
                                .value = missed,
                                .limit = EXPLAINED,
                                .classes = classes};
    if (imk_axes_mendings(classes, mending) == 0)
        return f;
    const int sensor = mending[0].mistakes[IMK_GYRO] > 0 ? IMK_GYRO : IMK_ACCEL;
    const imk_signed_axes *wrong = &mending[0].of[sensor];
    bool in_place = true;
    for (int i = 2; i >= 0; i--) {
        in_place = in_place && wrong->column[i] == i;
        if (wrong->column[i] != i || wrong->sign[i] < 0) {
            f.axis = i;
            f.other = wrong->column[i];
        }
    }
    const bool one_mistake = mending[0].mistakes[0] + mending[0].mistakes[1] == 1;
    f.sensor = one_mistake ? sensor : -1;
    f.kind = in_place ? IMK_DIAGNOSTIC_LEFT_HANDED : IMK_DIAGNOSTIC_SWAPPED_AXES;
    if (!one_mistake)
        f.axis = -1;
    if (!one_mistake || in_place)
        f.other = -1;
    return f;
}

/* Root mean square miss of the log as it stands, of the turns it does not explain. */
static double missed_as_is(const turns *t)
{
    const imk_signed_axes identity = imk_signed_axes_of(0);
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

/* One way to read the log: rates times a factor, permuted by any of some classes. */
typedef struct explanation {
    double factor, cost;
    uint64_t classes; /* that are as good as the best, within MARGIN */
} explanation;

/* The best for one factor. `t` is left integrated with it. */
static explanation explain(const imki_diagnostic_call *call, turns *t, double factor)
{
    explanation e = {.factor = factor, .cost = HUGE_VAL};
    double cost[IMK_SIGNED_AXES];
    integrate_all(call, t, factor);
    for (int index = 0; index < IMK_SIGNED_AXES; index++) {
        cost[index] = cost_of(t, index);
        e.cost = fmin(e.cost, cost[index]);
    }
    for (int index = 0; index < IMK_SIGNED_AXES; index++)
        if (cost[index] <= e.cost + MARGIN)
            e.classes |= UINT64_C(1) << index;
    return e;
}

/* Rates as they are, permuted or not, come before other units; of these, axes as they are. */
static explanation explain_all(const imki_diagnostic_call *call, turns *t, size_t factors,
                               const double *factor)
{
    explanation best = explain(call, t, factor[0]);
    for (size_t f = 1; f < factors; f++) {
        const explanation e = explain(call, t, factor[f]);
        if (e.cost < best.cost - MARGIN)
            best = e;
    }
    if (best.classes & 1)
        best.classes = 1;
    return best;
}

/* A turn that is off by nearly half a turn with other axes tells these from the axes as they are.
 */
static const double SEEN = 0.8;

/* Axes that are changed would explain the few turns that do not fit, and all others as well. */
static bool is_odd(const turns *t, double as_is, const explanation *e)
{
    return !(e->classes & 1) && as_is - e->cost >= SEEN && e->cost <= 0.1 * (double)t->count;
}

/* Better than the log as it stands, by enough, and good. */
static bool explains(const turns *t, double as_is, double cost)
{
    return as_is - cost >= GAIN && cost <= LEFT_OF_BEFORE * as_is &&
           cost <= LEFT_OF_ALL * (double)t->count;
}

/* The factor on all rates, from `low` to `high` in steps of a ratio, that explains the turns best.
 * `t` is left integrated with the last of them. */
static explanation scan(const imki_diagnostic_call *call, turns *t, double low, double high,
                        double ratio)
{
    explanation best = {.factor = 1.0, .cost = HUGE_VAL, .classes = 1};
    for (double factor = low; factor <= high; factor *= ratio) {
        integrate_all(call, t, factor);
        const double cost = cost_of(t, 0);
        if (cost < best.cost)
            best = (explanation){factor, cost, 1};
    }
    return best;
}

/* Rates that are too large or too small by a factor that is none of a unit: another sampling rate,
 * another range of the device. */
static explanation explain_scale(const imki_diagnostic_call *call, turns *t)
{
    enum { ROUNDS = 3 };
    double ratio = 1.05;
    explanation best = scan(call, t, 0.15, 7.0, ratio);
    for (int round = 0; round < ROUNDS; round++) {
        const double finer = 1.0 + 0.2 * (ratio - 1.0);
        best = scan(call, t, best.factor / (ratio * finer), best.factor * ratio * finer, finer);
        ratio = finer;
    }
    return best;
}

static void add_explanation(const explanation *e, double missed, imki_diagnostic_list *list)
{
    imk_diagnostic_finding f = {
        .sensor = IMK_GYRO, .axis = -1, .other = -1, .value = 1.0 / e->factor};
    const bool of_time = e->factor == 1e-3 || e->factor == 1e-6 || e->factor == 1e3;
    f.kind = of_time ? IMK_DIAGNOSTIC_TIME_UNIT : IMK_DIAGNOSTIC_RATE_UNIT;
    if (of_time)
        f.sensor = -1;
    if (e->factor != 1.0)
        imki_diagnostic_add(list, f);
    if (e->classes != 1)
        imki_diagnostic_add(list, axes_finding(e->classes, missed));
}

static bool has_both_triads(const imki_diagnostic_call *call)
{
    const imk_test_record *r = call->record;
    if (r->means || r->axis_count[IMK_GYRO] != 3 || r->axis_count[IMK_ACCEL] != 3)
        return false;
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < 3; i++)
            if (!r->reading[sensor][i] || imki_record_unit(r, call->model, sensor, i).unit == 0.0)
                return false;
    return true;
}

/* Too few turns to be sure of it: a doubt. */
static void add_odd_turn(const imki_diagnostic_call *call, turns *t, double as_is, double missed,
                         imki_diagnostic_list *list)
{
    const explanation e = explain(call, t, 1.0);
    if (!is_odd(t, as_is, &e))
        return;
    imk_diagnostic_finding f = axes_finding(e.classes, missed);
    f.kind = IMK_DIAGNOSTIC_ODD_TURN;
    imki_diagnostic_add(list, f);
}

uint64_t imk_record_axes_unseen(const imk_test_record *record, size_t interval_count,
                                const imk_static_interval *interval, const imk_model *model)
{
    const imki_diagnostic_call call = {
        .record = record, .interval_count = interval_count, .interval = interval, .model = model};
    turns t;
    uint64_t unseen = 0;
    if (!record || !interval || !has_both_triads(&call))
        return UINT64_MAX;
    collect_turns(&call, &t);
    if (t.count < TURNS_MIN)
        return UINT64_MAX;
    integrate_all(&call, &t, 1.0);
    const double as_is = cost_of(&t, 0);
    if (as_is > LEFT_OF_ALL * (double)t.count)
        return UINT64_MAX;
    for (int index = 1; index < IMK_SIGNED_AXES; index++)
        if (cost_of(&t, index) - as_is < SEEN)
            unseen |= UINT64_C(1) << index;
    return unseen;
}

void imki_diagnostic_turns(const imki_diagnostic_call *call, imki_diagnostic_list *list)
{
    static const double degree = 0.017453292519943295;
    /* Rates in deg/s taken for rad/s, the reverse; times in ms or us taken for s, the reverse. */
    const double factor[] = {1.0, degree, 1.0 / degree, 1e-3, 1e-6, 1e3};
    turns t;
    if (!has_both_triads(call))
        return;
    collect_turns(call, &t);
    if (t.count < TURNS_MIN)
        return;
    integrate_all(call, &t, 1.0);
    const double as_is = cost_of(&t, 0), missed = missed_as_is(&t);
    if (as_is < GAIN) {
        if (as_is >= SEEN)
            add_odd_turn(call, &t, as_is, missed, list);
        return;
    }
    const explanation best = explain_all(call, &t, sizeof factor / sizeof *factor, factor);
    const explanation scale = explain_scale(call, &t);
    const bool is_scale = scale.cost < best.cost - MARGIN;
    if (is_scale && explains(&t, as_is, scale.cost) &&
        fabs(1.0 / scale.factor - 1.0) > IMKI_SCALE_DOUBTED)
        imki_diagnostic_add(list, (imk_diagnostic_finding){.kind = IMK_DIAGNOSTIC_SCALE,
                                                           .sensor = IMK_GYRO,
                                                           .axis = -1,
                                                           .other = -1,
                                                           .value = 1.0 / scale.factor,
                                                           .limit = IMKI_SCALE_DOUBTED});
    else if (!is_scale && explains(&t, as_is, best.cost))
        add_explanation(&best, missed, list);
}
