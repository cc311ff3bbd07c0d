/* SPDX-License-Identifier: Apache-2.0 */
/* What looks wrong in a log before anything is solved: each diagnostic is founded on something that
 * a sound log cannot show.
 *
 *   - |force| at rest is gravity: within 20 %, which no bias or scale factor explains, or a unit
 *     was mistaken;
 *   - means of different poses scatter in three dimensions: the least standard deviation of a
 *     principal axis is g/sqrt(3) when they are spread evenly, 0 when they lie in a plane, or on a
 *     cone about one axis (then the bias along it is not told from the scale factor);
 *   - readings of a sensor are not all whole numbers unless they are counts;
 *   - an axis that keeps its largest reading for long while it scatters elsewhere is saturated;
 *   - turns: record_turns.c. */
#include "record_diagnostics_internal.h"

#include "imukit/linear_algebra.h"
#include "static_internal.h"

#include <math.h>

enum {
    POSES_MAX = 64,      /* different ones that are kept */
    INTERVALS_MAX = 512, /* that are looked at */
    POSES_NEEDED = 6,    /* three biases and three scale factors */
    WHOLE_SAMPLES = 4096
};

/* Poses whose forces differ by less are the same, in units of gravity: 6 deg. */
static const double SAME_POSE = 0.1;
/* Least standard deviation of poses along a principal axis, in units of gravity. */
static const double FLAT = 0.1;
/* Their mean there, beyond which they are on a cone and not in a plane: 17 deg from the plane. */
static const double CONE = 0.3;
/* Least component of a direction that is said to be that of an axis: within 37 deg. */
static const double ALONG = 0.8;

static imk_diagnostic_finding finding(imk_diagnostic kind, int sensor, int axis, double value,
                                      double limit)
{
    return (imk_diagnostic_finding){
        .kind = kind, .sensor = sensor, .axis = axis, .other = -1, .value = value, .limit = limit};
}

/* ---- single axes --------------------------------------------------------------------------------
 */

static bool is_whole(double x)
{
    return x == floor(x);
}

/* Whole numbers of some size that are said to be rad/s or m/s^2. */
static void diagnostic_counts(const imki_diagnostic_call *call, imki_diagnostic_list *list)
{
    const imk_test_record *r = call->record;
    const size_t count = r->count < WHOLE_SAMPLES ? r->count : WHOLE_SAMPLES;
    for (int sensor = 0; sensor < 2; sensor++) {
        bool whole = r->axis_count[sensor] > 0 && !r->counts[sensor];
        double largest = 0.0;
        for (int i = 0; whole && i < r->axis_count[sensor]; i++) {
            const double *x = r->reading[sensor][i];
            for (size_t k = 0; x && whole && k < count; k++)
                if (isfinite(x[k])) {
                    whole = is_whole(x[k]);
                    largest = fabs(x[k]) > largest ? fabs(x[k]) : largest;
                }
        }
        /* Zeros and ones are whole numbers too. */
        if (whole && largest > 20.0)
            imki_diagnostic_add(list, finding(IMK_DIAGNOSTIC_COUNTS, sensor, -1, largest, 0.0));
    }
}

static void diagnostic_stuck(const imki_diagnostic_call *call, imki_diagnostic_list *list)
{
    const imk_test_record *r = call->record;
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < r->axis_count[sensor]; i++) {
            const double *x = r->reading[sensor][i];
            size_t k = 1;
            while (x && k < r->count && !(x[k] != x[k - 1]))
                k++;
            if (x && r->count > 1 && k == r->count)
                imki_diagnostic_add(list, finding(IMK_DIAGNOSTIC_STUCK, sensor, i, x[0], 0.0));
        }
}

/* Samples in runs at one end of the readings, each at least `least` long. */
static size_t samples_at_end(const double *x, size_t count, double low, double high, size_t least)
{
    size_t total = 0, run = 0;
    for (size_t k = 0; k < count; k++) {
        if (x[k] <= low || x[k] >= high) {
            run++;
        } else {
            total += run >= least ? run : 0;
            run = 0;
        }
    }
    return total + (run >= least ? run : 0);
}

/* Readings at which an axis is saturated: the stated range, else the ends of what it reads, where
 * it scatters over more than a step. @return false: there is no telling */
static bool saturation(const imki_diagnostic_call *call, int sensor, int axis, double *low,
                       double *high)
{
    const imk_test_record *r = call->record;
    const double *x = r->reading[sensor][axis];
    const imki_axis_unit unit = imki_record_unit(r, call->model, sensor, axis);
    const imk_triad *triad = !call->model ? NULL : imk_model_triad(call->model, sensor);
    const double step = imki_static_step(x, 0, r->count < 4096 ? r->count : 4096);
    if (triad && triad->present && axis < triad->axis_count && unit.unit != 0.0 &&
        triad->range.value[axis] > 0.0) {
        const double range = triad->range.value[axis] / fabs(unit.unit);
        *low = unit.zero - range + 0.5 * step;
        *high = unit.zero + range - 0.5 * step;
        return true;
    }
    if (step == 0.0 || !(call->findings->noise[sensor][axis] > step))
        return false;
    *low = (double)INFINITY;
    *high = -(double)INFINITY;
    for (size_t k = 0; k < r->count; k++) {
        *low = x[k] < *low ? x[k] : *low;
        *high = x[k] > *high ? x[k] : *high;
    }
    return true;
}

/* A knock may clip the accelerometers for some samples; a pose does for long. Of a turn every
 * clipped sample is lost. */
static void diagnostic_saturated(const imki_diagnostic_call *call, imki_diagnostic_list *list)
{
    const imk_test_record *r = call->record;
    for (int sensor = 1; sensor >= 0; sensor--)
        for (int i = 0; i < r->axis_count[sensor]; i++) {
            double low, high;
            if (!r->reading[sensor][i] || !saturation(call, sensor, i, &low, &high))
                continue;
            const double tenth = 0.1 / r->dt;
            const size_t least = sensor == IMK_GYRO ? 3 : (tenth > 8.0 ? (size_t)tenth : 8);
            const size_t at_end = samples_at_end(r->reading[sensor][i], r->count, low, high, least);
            if (at_end > 0)
                imki_diagnostic_add(list, finding(IMK_DIAGNOSTIC_SATURATED, sensor, i,
                                                  (double)at_end / (double)r->count, high));
        }
}

/* ---- forces at rest -----------------------------------------------------------------------------
 */

/* Forces of the holds: in SI where that is known, else as read. */
typedef struct poses {
    bool known;    /* in SI */
    double radius; /* of the sphere they lie on: gravity as read, or half the widest distance */
    size_t count;  /* different ones */
    double force[POSES_MAX][3];
} poses;

static double distance(const double a[3], const double b[3])
{
    double square = 0.0;
    for (int i = 0; i < 3; i++)
        square += (a[i] - b[i]) * (a[i] - b[i]);
    return sqrt(square);
}

static bool force_of(const imki_diagnostic_call *call, const imk_static_interval *interval,
                     double force[3], bool *known)
{
    for (int i = 0; i < 3; i++) {
        const imki_axis_unit unit = imki_record_unit(call->record, call->model, IMK_ACCEL, i);
        force[i] = interval->mean[IMK_ACCEL][i];
        if (unit.unit == 0.0)
            *known = false;
        else
            force[i] = (force[i] - unit.zero) * unit.unit;
    }
    return isfinite(force[0]) && isfinite(force[1]) && isfinite(force[2]);
}

/* Median amount of the forces; 0: none. */
static double median_force(const imki_diagnostic_call *call)
{
    double amount[INTERVALS_MAX];
    size_t count = 0;
    for (size_t k = 0; k < call->interval_count && count < INTERVALS_MAX; k++) {
        double force[3];
        bool known = true;
        if (!force_of(call, &call->interval[k], force, &known) || !known)
            continue;
        const double value = distance(force, (const double[3]){0.0, 0.0, 0.0});
        size_t j = count++;
        for (; j > 0 && amount[j - 1] > value; j--)
            amount[j] = amount[j - 1];
        amount[j] = value;
    }
    return count > 0 ? amount[count / 2] : 0.0;
}

static void collect_poses(const imki_diagnostic_call *call, double radius, poses *p)
{
    p->count = 0;
    p->known = true;
    for (size_t k = 0; k < call->interval_count && k < INTERVALS_MAX; k++) {
        double force[3];
        if (p->count == POSES_MAX || !force_of(call, &call->interval[k], force, &p->known))
            continue;
        bool is_new = true;
        for (size_t j = 0; is_new && j < p->count; j++)
            is_new = distance(force, p->force[j]) > SAME_POSE * radius;
        for (int i = 0; is_new && i < 3; i++)
            p->force[p->count][i] = force[i];
        p->count += is_new;
    }
}

/* Half the widest distance between any two of the forces. */
static double half_width(const imki_diagnostic_call *call)
{
    double widest = 0.0;
    const size_t count = call->interval_count < POSES_MAX ? call->interval_count : POSES_MAX;
    for (size_t k = 0; k < count; k++)
        for (size_t j = 0; j < k; j++) {
            double a[3], b[3];
            bool known = true;
            if (force_of(call, &call->interval[k], a, &known) &&
                force_of(call, &call->interval[j], b, &known)) {
                const double d = distance(a, b);
                widest = d > widest ? d : widest;
            }
        }
    return 0.5 * widest;
}

/* Factors by which a unit may have been mistaken: readings times one of them are m/s^2. */
static void diagnostic_gravity(const imki_diagnostic_call *call, double force,
                               imki_diagnostic_list *list)
{
    static const double factor[] = {
        9.80665,       /* g */
        9.80665e-3,    /* mg; Gal differ by 2 % only and are rare */
        9.80665e-6,    /* ug */
        1.0 / 9.80665, /* converted from g twice */
        0.3048,        /* ft/s^2 */
    };
    const double ratio = call->gravity / force;
    if (!(force > 0.0) || fabs(ratio - 1.0) < 0.2)
        return;
    double best = 0.0;
    for (size_t i = 0; i < sizeof factor / sizeof *factor; i++)
        if (fabs(ratio / factor[i] - 1.0) < 0.1)
            best = factor[i];
    imki_diagnostic_add(list, finding(IMK_DIAGNOSTIC_GRAVITY_UNIT, IMK_ACCEL, -1, force, best));
}

/* Standard deviations of the poses along the two directions in which they differ least; the body
 * axis of the first, -1 where it is along none of them, and their mean along it. */
static double least_spread(const poses *p, double *next, int *axis, double *middle)
{
    double mean[3] = {0.0, 0.0, 0.0}, square[9] = {0.0}, eigenvalue[3], direction[9];
    for (size_t k = 0; k < p->count; k++)
        for (int i = 0; i < 3; i++)
            mean[i] += p->force[k][i] / (double)p->count;
    for (size_t k = 0; k < p->count; k++)
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                square[3 * i + j] +=
                    (p->force[k][i] - mean[i]) * (p->force[k][j] - mean[j]) / (double)p->count;
    *axis = -1;
    *middle = 0.0;
    if (imk_symmetric_eigen(3, square, eigenvalue, direction) != IMK_OK)
        return (double)INFINITY;
    for (int i = 0; i < 3; i++) {
        *axis = fabs(direction[3 * i]) > ALONG ? i : *axis;
        *middle += mean[i] * direction[3 * i];
    }
    *next = sqrt(eigenvalue[1] > 0.0 ? eigenvalue[1] : 0.0);
    return sqrt(eigenvalue[0] > 0.0 ? eigenvalue[0] : 0.0);
}

static void diagnostic_poses(const imki_diagnostic_call *call, double force,
                             imki_diagnostic_list *list)
{
    if (call->record->axis_count[IMK_ACCEL] != 3)
        return;
    poses p;
    p.radius = force > 0.0 ? force : half_width(call);
    collect_poses(call, p.radius, &p);
    /* Where the size of gravity is not known a single pose looks like several: its noise tells. */
    double noise = 0.0;
    for (int i = 0; i < 3; i++)
        noise += call->findings->noise[IMK_ACCEL][i];
    if (p.count <= 1 || (force == 0.0 && !(p.radius > noise))) {
        imki_diagnostic_add(list, finding(IMK_DIAGNOSTIC_NEVER_MOVES, -1, -1, 1.0, POSES_NEEDED));
        return;
    }
    int axis;
    double middle, next = 0.0;
    const double spread = least_spread(&p, &next, &axis, &middle) / p.radius;
    axis = next > FLAT * p.radius ? axis : -1;
    const bool cone = p.known && axis >= 0 && fabs(middle) > CONE * p.radius;
    if (p.count >= 4 && spread < FLAT)
        imki_diagnostic_add(list, finding(cone ? IMK_DIAGNOSTIC_ONE_CONE : IMK_DIAGNOSTIC_ONE_PLANE,
                                          IMK_ACCEL, axis, spread, FLAT));
    if (p.count < POSES_NEEDED)
        imki_diagnostic_add(
            list, finding(IMK_DIAGNOSTIC_FEW_POSES, -1, -1, (double)p.count, POSES_NEEDED));
}

size_t imk_record_diagnostics(const imk_test_record *record, const imk_static_findings *findings,
                              size_t interval_count, const imk_static_interval *interval,
                              double gravity, const imk_model *model, size_t capacity,
                              imk_diagnostic_finding *diagnostic)
{
    if (!record || !findings || !diagnostic || (interval_count > 0 && !interval))
        return 0;
    const imki_diagnostic_call call = {record, findings, interval_count, interval, gravity, model};
    imki_diagnostic_list list = {0, capacity, diagnostic};
    diagnostic_counts(&call, &list);
    diagnostic_stuck(&call, &list);
    if (interval_count == 0)
        imki_diagnostic_add(&list,
                            finding(IMK_DIAGNOSTIC_NEVER_STATIC, -1, -1, findings->standing, 0.0));
    const double force = median_force(&call);
    /* Forces that are said to be SI but are whole numbers have been named above. */
    bool whole = false;
    for (size_t i = 0; i < list.count; i++)
        whole |= diagnostic[i].kind == IMK_DIAGNOSTIC_COUNTS && diagnostic[i].sensor == IMK_ACCEL;
    if (!whole)
        diagnostic_gravity(&call, force, &list);
    imki_diagnostic_turns(&call, &list);
    diagnostic_saturated(&call, &list);
    if (interval_count > 0)
        diagnostic_poses(&call, force, &list);
    return list.count;
}
