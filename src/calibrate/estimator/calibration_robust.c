/* SPDX-License-Identifier: Apache-2.0 */
/* Which items to refuse, in two stages.
 *
 * The first finds a solution that a minority of bad items cannot spoil: weights by Huber's function
 * [HUBER1964] until the scale settles, then by Tukey's biweight [BEATON1974], of the distance d of
 * an item from what the others predict,
 *
 *     Huber  min(1, 1/d),      Tukey  (1 - (d/4.685)^2)^2, 0 beyond 4.685,
 *
 * the scale of each group from the median of d^2, which half the items may miss. Bad items that
 * have much leverage may still draw Huber's weights to them. The scale then is far above the sigmas
 * stated; so when it is, in a group of which the unknowns take up half or more, fits to random
 * halves of the items are tried besides, and the one with the smallest scales, sum over groups of
 * count log scale, is taken [ROUSSEEUW2006].
 *
 * The second decides. Least squares over the items in use, at full weight; an item is refused, or
 * taken back, by the ratio of its mean square to that of the others, an F distribution: beyond the
 * limit that a good item passes with the probability `false_refusal` divided by the number of
 * items. So clean data lose nothing in 99 of 100 calibrations, whatever the first stage thought.
 * What a parameter needs to be determined is not refused, however it looks. */
#include "calibrate/standstill/median_internal.h"
#include "estimator_internal.h"

#include "imukit/distributions.h"
#include "imukit/elementary.h"
#include "imukit/random.h"

#include <math.h>
#include <string.h>

static const double false_refusal = 0.01;
static const double far_scale = 3.0;     /* above the sigmas stated */
static const double beyond_median = 1.6; /* scatter over what the median says: 1.3 by chance */
/* Turns are linear enough for weights when their ends are good to so many sigmas. */
static const double linear_enough = 0.3;
/* A few items draw a fit to them where unknowns take up this share of what there is, as attitudes
 * take two of three accelerometers; where most is redundant, a scatter above what is stated is
 * everyone's, and halves of the items would only show it again. */
static const double drawn_share = 0.5;
static const double tukey_limit = 4.685; /* 95 % efficient for normal errors */

enum {
    SCALED_MIN = 6, /* items needed for a median */
    HUBER_ROUNDS = 25,
    TUKEY_ROUNDS = 8,
    DECIDE_ROUNDS = 60,
    STEPS = 2,              /* of the iteration between changes of weights */
    TRIALS_OF_ITEMS = 4800, /* fewer trials of more items, each of which has less leverage */
    TRIALS = 24,            /* with a tenth of 24 items bad, a half without is among them: 93 % */
    TRIAL_STEPS = 5,
    TRIAL_ROUNDS = 2,
    TRIAL_STREAM = 6, /* of the random halves, with seed 0: the same in every calibration */
    REFUSED = 1,      /* bits of state */
    TAKEN_BACK = 2
};

/* ---- distances --------------------------------------------------------------------------------
 */

/* distance[IMKI_GROUPS item + group]: mean square per degree over its median for normal errors; NaN
 * where the item has nothing in the group. */
static void find_distances(imki_estimator *e)
{
    for (size_t item = 0; item < e->items; item++) {
        int degrees[IMKI_GROUPS];
        double square[IMKI_GROUPS];
        imki_item_distances(e, item, square, degrees);
        for (int g = 0; g < IMKI_GROUPS; g++) {
            const double third = degrees[g] > 0 ? 1.0 - 2.0 / (9.0 * degrees[g]) : 1.0;
            e->distance[IMKI_GROUPS * item + (size_t)g] =
                degrees[g] > 0 ? square[g] / (degrees[g] * third * third * third) : (double)NAN;
        }
    }
}

static size_t count_of(const imki_estimator *e, int g)
{
    size_t count = 0;
    for (size_t item = 0; item < e->items; item++)
        count += !isnan(e->distance[IMKI_GROUPS * item + (size_t)g]);
    return count;
}

/* The median of a group's distances, 0 when there are too few. */
static double middle_of(imki_estimator *e, int g)
{
    size_t count = 0;
    for (size_t item = 0; item < e->items; item++) {
        const double d = e->distance[IMKI_GROUPS * item + (size_t)g];
        if (!isnan(d))
            e->sorted[count++] = d;
    }
    return count < SCALED_MIN ? 0.0 : imki_median(e->sorted, count);
}

/* Scale of each group by the median. @return largest relative change */
static double rescale(imki_estimator *e, double ratio[IMKI_GROUPS])
{
    double change = 0.0;
    for (int g = 0; g < IMKI_GROUPS; g++) {
        const double middle = sqrt(middle_of(e, g));
        ratio[g] = 1.0;
        if (middle == 0.0)
            continue;
        ratio[g] = middle > 1e-3 ? middle : 1e-3;
        change = fmax(change, fabs(ratio[g] - 1.0));
        /* Placements show in the accelerometers, and share their scale. */
        if (g == IMK_GROUP_ACCEL)
            e->factor[IMKI_PART_PLACEMENT] = fmax(1e-3, e->factor[IMKI_PART_PLACEMENT] * ratio[g]);
        int part[IMK_AXES_MAX];
        const int parts = imki_group_parts(e, g, part);
        for (int i = 0; i < parts; i++)
            e->factor[part[i]] = fmax(1e-3, e->factor[part[i]] * ratio[g]);
    }
    return change;
}

static double weight_of(double d, bool tukey)
{
    if (!tukey)
        return d > 1.0 ? 1.0 / d : 1.0;
    const double u = d / tukey_limit;
    return u < 1.0 ? (1.0 - u * u) * (1.0 - u * u) : 0.0;
}

/* An item has the weight of its worst group. */
static void reweigh(imki_estimator *e, const double ratio[IMKI_GROUPS], bool tukey)
{
    for (size_t item = 0; item < e->items; item++) {
        double weight = 1.0;
        for (int g = 0; g < IMKI_GROUPS; g++) {
            const double d = e->distance[IMKI_GROUPS * item + (size_t)g];
            if (!isnan(d))
                weight = fmin(weight, weight_of(sqrt(d) / ratio[g], tukey));
        }
        e->weight[item] = weight > IMKI_WEIGHT_REFUSED ? weight : IMKI_WEIGHT_REFUSED;
    }
}

static imk_status step(imki_estimator *e)
{
    bool converged;
    const imk_status status = imki_iterate(e, STEPS, &converged);
    return status == IMK_OK ? imki_built_covariance(e) : status;
}

typedef struct limits {
    double limit[IMKI_GROUPS][2][IMKI_ROWS_MAX + 1]; /* of F, by degrees; in use and refused */
    imki_fit fit;
    imki_group_sum group[IMKI_GROUPS];
} limits;

/* Least squares over all items show no bad one; but several might hide each other. Their scatter
 * then is far above what is stated, or above what the median says. */
static bool is_suspicious(imki_estimator *e, const limits *l)
{
    bool suspicious = false;
    find_distances(e);
    for (int g = 0; g < IMKI_GROUPS; g++) {
        const double middle = middle_of(e, g);
        suspicious =
            suspicious || (middle > 0.0 && (l->group[g].stated * far_scale * far_scale < 1.0 ||
                                            middle * beyond_median * beyond_median < 1.0));
    }
    return suspicious;
}

/* Groups in which a few items may draw the fit to them, by what the fit of all items left. */
static void find_drawn(imki_estimator *e, const double redundancy[IMKI_GROUPS],
                       bool drawn[IMKI_GROUPS])
{
    double rows[IMKI_GROUPS] = {0.0};
    for (size_t item = 0; item < e->items; item++) {
        const int count = imki_item_rows(e, &e->now, item, e->row);
        for (int i = 0; i < count; i++)
            rows[e->row[i].group] += 1.0;
    }
    for (int g = 0; g < IMKI_GROUPS; g++)
        drawn[g] = redundancy[g] < (1.0 - drawn_share) * rows[g];
}

/* Scales that a solution has left, by medians: the sum of count log scale^2. `far`: one of them, of
 * a group in which that may be a few items' doing, is far above what is stated. */
static double objective(imki_estimator *e, const bool drawn[IMKI_GROUPS], bool *far)
{
    double sum = 0.0;
    *far = false;
    find_distances(e);
    for (int g = 0; g < IMKI_GROUPS; g++) {
        const double middle = middle_of(e, g);
        if (middle == 0.0)
            continue;
        int part[IMK_AXES_MAX];
        (void)imki_group_parts(e, g, part);
        const double square = e->factor[part[0]] * e->factor[part[0]] * middle;
        sum += (double)count_of(e, g) * imk_ln(square > 1e-12 ? square : 1e-12);
        *far = *far || (drawn[g] && square > far_scale * far_scale);
    }
    return sum;
}

static imk_status reweigh_once(imki_estimator *e, bool tukey, double *change)
{
    double ratio[IMKI_GROUPS];
    find_distances(e);
    *change = rescale(e, ratio);
    reweigh(e, ratio, tukey);
    return step(e);
}

static imk_status reweighted(imki_estimator *e, int first_round)
{
    for (int round = first_round; round < HUBER_ROUNDS + TUKEY_ROUNDS; round++) {
        const bool tukey = round >= HUBER_ROUNDS;
        double change;
        const imk_status status = reweigh_once(e, tukey, &change);
        if (status != IMK_OK)
            return status;
        if (!tukey && change < 0.02)
            round = HUBER_ROUNDS - 1;
        if (!tukey && round % 6 == 5)
            (void)imki_turns_linearise(e, linear_enough);
    }
    return IMK_OK;
}

static void keep_best(imki_estimator *e)
{
    imki_point_copy(e, &e->now, &e->best);
    memcpy(e->best_factor, e->factor, sizeof e->factor);
    memcpy(e->best_weight, e->weight, e->items * sizeof *e->weight);
}

static void take_best(imki_estimator *e)
{
    imki_point_copy(e, &e->best, &e->now);
    memcpy(e->factor, e->best_factor, sizeof e->factor);
    memcpy(e->weight, e->best_weight, e->items * sizeof *e->weight);
}

/* A fit through few items leaves nothing to assess the others by: those that have weight must have
 * half of all redundant directions and of the parameters. */
static bool is_majority(imki_estimator *e)
{
    size_t all = e->parameters, kept = 0;
    for (size_t item = 0; item < e->items; item++) {
        double square[IMKI_GROUPS];
        int degrees[IMKI_GROUPS];
        imki_item_distances(e, item, square, degrees);
        for (int g = 0; g < IMKI_GROUPS; g++) {
            all += (size_t)degrees[g];
            kept += e->weight[item] > 0.1 ? (size_t)degrees[g] : 0;
        }
    }
    return 2 * kept >= all;
}

/* Fit a random half, then weigh all by it. */
static imk_status try_half(imki_estimator *e, int trial)
{
    const imk_random random = {.seed = 0, .kernel = IMK_KERNEL_SCALAR};
    bool converged;
    double change;
    for (size_t item = 0; item < e->items; item++) {
        uint32_t word;
        imk_random_words(random, imk_stream(TRIAL_STREAM, 0, 0, (uint8_t)trial), item, 1, &word);
        e->weight[item] = word & 1 ? 1.0 : IMKI_WEIGHT_REFUSED;
    }
    for (int part = 0; part < IMKI_PARTS; part++)
        e->factor[part] = 1.0;
    imk_status status = imki_iterate(e, TRIAL_STEPS, &converged);
    if (status == IMK_OK)
        status = imki_built_covariance(e);
    for (int round = 0; status == IMK_OK && round < TRIAL_ROUNDS; round++)
        status = reweigh_once(e, true, &change);
    return status;
}

static imk_status find_majority(imki_estimator *e, const double redundancy[IMKI_GROUPS])
{
    bool far, drawn[IMKI_GROUPS];
    find_drawn(e, redundancy, drawn);
    imk_status status = reweighted(e, 0);
    if (status != IMK_OK)
        return status;
    double best = objective(e, drawn, &far);
    keep_best(e);
    const double first = best;
    const size_t affordable = TRIALS_OF_ITEMS / e->items;
    const int trials = affordable < TRIALS ? (int)affordable : TRIALS;
    for (int trial = 0; far && trial < trials; trial++) {
        bool unused;
        if (try_half(e, trial) == IMK_OK) {
            const double reached = objective(e, drawn, &unused);
            if (reached < best && is_majority(e)) {
                best = reached;
                keep_best(e);
            }
        }
        take_best(e);
    }
    status = imki_estimator_covariance(e);
    return status == IMK_OK && best < first ? reweighted(e, HUBER_ROUNDS) : status;
}

/* ---- decisions --------------------------------------------------------------------------------
 */

/* A placement is told by its readings and by what is known of it before: as the distance of an
 * item counts both, so must what it is compared with. */
static void add_placements(imki_estimator *e, imki_group_sum sum[IMKI_GROUPS])
{
    for (size_t i = 0; i < e->observations; i++) {
        double matrix[9];
        if (e->weight[i] < 1.0 || imki_placement_rows(e, &e->now, i, e->row) == 0)
            continue;
        int group = IMK_GROUP_GYRO;
        for (int axis = 0; axis < IMK_AXES_MAX; axis++)
            group = isnan(e->reading[i][IMK_ACCEL][axis]) ? group : IMK_GROUP_ACCEL;
        imki_whiten(e, 3, e->row);
        imki_rows_covariance(&e->normal, e->row, 3, matrix, NULL);
        for (int k = 0; k < 3; k++) {
            sum[group].square += e->row[k].residual * e->row[k].residual;
            sum[group].redundancy += 1.0 - matrix[4 * k];
        }
    }
}

/* F of an item in a group over its limit: above 1 it does not belong. Where few directions are
 * redundant the others may scatter by far less than their sigmas by chance; so they count as
 * scattering by what is stated at least. */
static double excess(limits *l, bool used, int g, double square, int degrees, double probability)
{
    if (degrees == 0)
        return 0.0;
    const bool estimated = l->group[g].estimated;
    double left = l->group[g].redundancy, others = l->group[g].square;
    if (used) {
        left -= degrees;
        others -= square;
    }
    double *limit = &l->limit[g][used][degrees];
    if (*limit == 0.0)
        *limit = imk_f_upper_quantile(probability, degrees,
                                      estimated && left > 0.0 ? left : (double)INFINITY);
    if (!estimated)
        return square / degrees / *limit;
    if (!(left >= 1.0))
        return 0.0;
    return square / degrees / fmax(others / left, l->group[g].stated) / *limit;
}

static double worst_excess(imki_estimator *e, limits *l, size_t item, double probability)
{
    double worst = 0.0, square[IMKI_GROUPS];
    int degrees[IMKI_GROUPS];
    imki_item_distances(e, item, square, degrees);
    for (int g = 0; g < IMKI_GROUPS; g++)
        worst =
            fmax(worst, excess(l, e->weight[item] >= 1.0, g, square[g], degrees[g], probability));
    return worst;
}

static void set_weights(imki_estimator *e)
{
    for (size_t item = 0; item < e->items; item++)
        e->weight[item] = e->state[item] & REFUSED ? IMKI_WEIGHT_REFUSED : 1.0;
}

/* One look at all items. @return whether any was refused or taken back. An item that is refused
 * again after it was taken back stays so. */
static bool decide(imki_estimator *e, limits *l)
{
    const double probability = false_refusal / (double)e->items;
    double worst = 1.0;
    bool changed = false;
    memset(l->limit, 0, sizeof l->limit);
    for (int g = 0; g < IMKI_GROUPS; g++)
        l->group[g] = imki_sum_group(e, &l->fit, g);
    add_placements(e, l->group);
    for (size_t item = 0; item < e->items; item++) {
        e->distance[item] = worst_excess(e, l, item, probability);
        if (!(e->state[item] & REFUSED))
            worst = fmax(worst, e->distance[item]);
    }
    for (size_t item = 0; item < e->items; item++) {
        if (!(e->state[item] & REFUSED)) {
            /* The worst first, and what is as bad: others may look bad because of them. */
            if (e->distance[item] > 1.0 && e->distance[item] >= 0.5 * worst) {
                e->state[item] |= REFUSED;
                changed = true;
            }
        } else if (e->distance[item] <= 1.0 && !(e->state[item] & TAKEN_BACK)) {
            e->state[item] = TAKEN_BACK;
            changed = true;
        }
    }
    return changed;
}

static void refuse_nothing(imki_estimator *e)
{
    memset(e->state, 0, e->items);
    set_weights(e);
}

/* Take back what a parameter needs, those first that are least over their limit: what nothing else
 * tells is predicted so loosely that it is not over any. */
static imk_status keep_determined(imki_estimator *e)
{
    for (;;) {
        double weakest;
        size_t least = e->items;
        set_weights(e);
        const imk_status status = imki_check_determined(e, &weakest, NULL);
        if (status != IMK_ERROR_SINGULAR)
            return status;
        for (size_t item = 0; item < e->items; item++)
            if (e->state[item] & REFUSED &&
                (least == e->items || e->distance[item] < e->distance[least]))
                least = item;
        if (least == e->items)
            return IMK_OK; /* nothing is refused: the solution says what is not determined */
        e->state[least] = 0;
    }
}

static size_t count_refused(const imki_estimator *e)
{
    size_t refused = 0;
    for (size_t item = 0; item < e->items; item++)
        refused += (e->state[item] & REFUSED) != 0;
    return refused;
}

/* Decide until that changes nothing. */
static imk_status decide_all(imki_estimator *e, limits *l)
{
    imk_status status = IMK_OK;
    for (int round = 0; round < DECIDE_ROUNDS; round++) {
        set_weights(e);
        status = imki_variance_factors(e, 0.01, &l->fit);
        if (status != IMK_OK || !decide(e, l))
            break;
    }
    return status;
}

/* Nothing to refuse: neither by one factor a group, nor, where axes differ, by what fits better. */
static imk_status look(imki_estimator *e, limits *l, bool *clean)
{
    imk_status status = imki_variance_factors(e, 0.01, &l->fit);
    *clean = false;
    for (int way = 0; status == IMK_OK && !*clean && way < 2; way++) {
        if (way == 1)
            status = imki_choose_scatter(e, &l->fit);
        memset(e->state, 0, e->items);
        if (status == IMK_OK)
            *clean = !decide(e, l) && !is_suspicious(e, l);
    }
    return status;
}

/* The second stage, from the solution of the first. */
static imk_status decide_from_majority(imki_estimator *e, limits *l)
{
    (void)imki_turns_linearise(e, linear_enough);
    for (size_t item = 0; item < e->items; item++)
        e->state[item] = e->weight[item] <= IMKI_WEIGHT_REFUSED ? REFUSED : 0;
    imk_status status = decide_all(e, l);
    if (status == IMK_OK)
        status = imki_choose_scatter(e, &l->fit);
    if (status == IMK_OK &&
        (e->by_axis[0] || e->by_axis[1] || e->added[0] > 0.0 || e->added[1] > 0.0))
        status = decide_all(e, l);
    if (2 * count_refused(e) > e->items) { /* no majority: the misfit is the model's */
        refuse_nothing(e);
        return status;
    }
    return status == IMK_OK || status == IMK_ERROR_SINGULAR ? keep_determined(e) : status;
}

imk_status imki_refuse_outliers(imki_estimator *e)
{
    limits l;
    bool clean;
    imk_status status = look(e, &l, &clean);
    if (status != IMK_OK)
        return status;
    if (clean)
        return e->by_axis[0] || e->by_axis[1] || e->added[0] > 0.0 || e->added[1] > 0.0
                   ? IMK_OK
                   : imki_choose_scatter(e, &l.fit);
    imki_common_scatter(e);
    memset(e->state, 0, e->items);
    set_weights(e);
    status = imki_variance_factors(e, 0.01, &l.fit);
    if (status != IMK_OK)
        return status;
    double redundancy[IMKI_GROUPS]; /* of all items */
    for (int g = 0; g < IMKI_GROUPS; g++)
        redundancy[g] = imki_sum_group(e, &l.fit, g).redundancy;
    (void)decide(e, &l);
    set_weights(e);
    keep_best(e);
    status = find_majority(e, redundancy);
    if (status == IMK_ERROR_SINGULAR) { /* no solution without the items in diagnostic */
        take_best(e);
        refuse_nothing(e);
        return IMK_OK;
    }
    return status == IMK_OK ? decide_from_majority(e, &l) : status;
}
