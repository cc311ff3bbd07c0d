/* SPDX-License-Identifier: Apache-2.0 */
/* What is wrong about the sigmas stated, of the readings of a sensor. Its residuals scatter by more
 * (or less) than these, and the variance of a reading may be
 *
 *     f^2 sigma^2              noise that is not white, the same share of it on each axis,
 *     f_axis^2 sigma^2         one axis that is worse than the others,
 *     sigma^2 + a^2            what befalls a pose: hands, a table that yields, alike on all axes,
 *     sigma^2 + a_axis^2       the same, unlike.
 *
 * Of these the one is taken that has the least
 *
 *     sum ln V + ln det N + sum residual^2/V + 2 (number of factors),
 *
 * the restricted likelihood [PATTERSON1971] and the price of a parameter [AKAIKE1978]. Where all
 * sigmas are alike the last two are the first two, and are not tried. Where they are not, an
 * addition is the likelier cause: the noise of an axis has been measured within the holds.
 *
 * Turns between rests have a factor too. An excess of accelerometers may look like one of turns,
 * because rests and turns disagree about the same attitudes; so where turns seem far worse than
 * stated, each form of the accelerometers that is common to the axes is also tried with turns as
 * stated.
 *
 * Few residuals do not tell which form is right. So the values are those of the chosen form, and
 * the intervals those that all forms together hold, each weighted by exp(-criterion/2)
 * [HOETING1999]. */
#include "estimator_internal.h"

#include "imukit/distributions.h"
#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

/* A factor that is chosen has so many degrees of freedom, one of an axis a little more. */
static const double least_freedom = 3.0, least_axis_freedom = 4.0, least_added_freedom = 1.0;
/* Errors of poses are looked for where the factor is above this, or that of turns above what turns
 * as stated seldom have by chance. */
static const double least_excess = 0.9, least_turn_excess = 1.5;
/* Sigmas whose root mean square is less than this over their harmonic mean are alike. */
static const double least_unlike = 1.1;
/* Axes that differ by more than their noise within holds says are not usual: -2 ln of 0.14. Nor is
 * an excess that is greater on noisy axes: -2 ln of 0.37. */
static const double by_axis_price = 4.0, share_price = 2.0;

typedef struct form {
    bool by_axis[2], turns_stated;
    double added[2];
    double factor[IMKI_PARTS];
} form;

static form form_of(const imki_estimator *e)
{
    form f;
    memcpy(f.by_axis, e->by_axis, sizeof f.by_axis);
    f.turns_stated = e->turns_stated;
    memcpy(f.added, e->added, sizeof f.added);
    memcpy(f.factor, e->factor, sizeof f.factor);
    return f;
}

static void take_form(imki_estimator *e, const form *f)
{
    memcpy(e->by_axis, f->by_axis, sizeof f->by_axis);
    e->turns_stated = f->turns_stated;
    memcpy(e->added, f->added, sizeof f->added);
    memcpy(e->factor, f->factor, sizeof f->factor);
}

/* -2 ln of the restricted likelihood, but for a constant, at the present solution. */
static double deviance(imki_estimator *e)
{
    double sum = 0.0;
    if (imki_estimator_covariance(e) != IMK_OK)
        return HUGE_VAL;
    for (size_t k = 0; k < imki_things(e); k++) {
        const int count = imki_rows_of(e, k);
        for (int i = 0; i < count; i++) /* whitened: the derivatives are over sqrt(V) */
            sum += imk_ln(imki_row_variance(e, &e->row[i]));
    }
    return sum + e->cost + imki_normal_log_determinant(&e->normal);
}

/* Root mean square of the sigmas stated of the holds of a sensor. */
static double typical_sigma(const imki_estimator *e, int sensor, double *unlike)
{
    double square = 0.0, inverse = 0.0, count = 0.0;
    for (size_t i = 0; i < e->observations; i++)
        for (int axis = 0; axis < IMK_AXES_MAX; axis++)
            if (!isnan(e->reading[i][sensor][axis]) && e->weight[i] >= 1.0 &&
                !e->problem->observation[i].moving) {
                const double variance = e->sigma[i][sensor][axis] * e->sigma[i][sensor][axis];
                square += variance;
                inverse += 1.0 / variance;
                count += 1.0;
            }
    *unlike = sqrt(square * inverse) / count;
    return sqrt(square / count);
}

/* Whether the residuals are enough for each factor. */
static bool is_rich(const imki_estimator *e, int sensor, const imki_fit *fit)
{
    const double least = e->added[sensor] > 0.0 ? least_added_freedom
                         : e->by_axis[sensor]   ? least_axis_freedom
                                                : least_freedom;
    for (int axis = 0; axis < IMK_AXES_MAX; axis++) {
        const int part = imki_part_of(e, sensor, axis);
        if (fit->scaled[part] != 0.0 && !(fit->freedom[part] >= least))
            return false;
    }
    return true;
}

/* A form, in bits. */
enum { BY_AXIS = 1, ADDED = 2, TURNS_STATED = 4, FORMS = 6 };

static int form_bits(const imki_estimator *e, int sensor)
{
    return (e->by_axis[sensor] ? BY_AXIS : 0) | (e->added[sensor] > 0.0 ? ADDED : 0) |
           (e->turns_stated ? TURNS_STATED : 0);
}

/* The forms to be tried, by the solution with one factor a group; the first is this. */
static int list_forms(const imki_estimator *e, int sensor, int list[FORMS])
{
    const bool of_turns = sensor == IMK_ACCEL && e->factor[IMK_GROUP_TURN] > least_turn_excess;
    const bool excess = of_turns || e->factor[imki_part_of(e, sensor, 0)] > least_excess;
    double unlike;
    int count = 0;
    (void)typical_sigma(e, sensor, &unlike);
    for (int bits = 0; bits < (of_turns ? 8 : 4); bits++) {
        const bool differs = !(bits & ADDED) || (excess && unlike > least_unlike);
        if (differs && !(bits & TURNS_STATED && bits & BY_AXIS))
            list[count++] = bits;
    }
    return count;
}

/* What its factors cost a form. */
static double price(const imki_estimator *e, int sensor, const imki_fit *fit)
{
    const bool share = !(e->added[sensor] > 0.0) && e->factor[imki_part_of(e, sensor, 0)] > 1.0;
    double unlike, sum = e->by_axis[sensor] ? by_axis_price : 0.0;
    (void)typical_sigma(e, sensor, &unlike);
    if (share && unlike > least_unlike)
        sum += share_price;
    for (int part = 0; part < IMKI_PARTS; part++)
        sum += fit->estimated[part] ? 2.0 : 0.0;
    return sum;
}

/* Solve in another form. @return its deviance and price; HUGE_VAL: not possible */
static double try_form(imki_estimator *e, int sensor, int bits, imki_fit *fit)
{
    double factor = e->factor[imki_part_of(e, sensor, 0)], unlike;
    e->by_axis[sensor] = bits & BY_AXIS;
    e->added[sensor] = bits & ADDED ? typical_sigma(e, sensor, &unlike) : 0.0;
    e->turns_stated = bits & TURNS_STATED;
    if (e->turns_stated) {
        factor *= e->factor[IMK_GROUP_TURN];
        e->factor[IMK_GROUP_TURN] = 1.0;
    }
    for (int axis = 0; axis < IMK_AXES_MAX; axis++)
        e->factor[imki_part_of(e, sensor, axis)] = factor;
    if (imki_estimator_covariance(e) != IMK_OK)
        return HUGE_VAL;
    imki_fit_groups(e, fit);
    if (e->by_axis[sensor] && !is_rich(e, sensor, fit))
        return HUGE_VAL;
    if (imki_variance_factors(e, 0.01, fit) != IMK_OK || !is_rich(e, sensor, fit))
        return HUGE_VAL;
    return deviance(e) + price(e, sensor, fit);
}

static imk_status choose(imki_estimator *e, int sensor, imki_fit *fit)
{
    const form common = form_of(e);
    form best = common;
    int list[FORMS];
    const int count = list_forms(e, sensor, list);
    double least = deviance(e) + price(e, sensor, fit);
    for (int k = 1; k < count; k++) {
        take_form(e, &common);
        const double reached = try_form(e, sensor, list[k], fit);
        if (reached < least) {
            least = reached;
            best = form_of(e);
        }
    }
    take_form(e, &best);
    return imki_variance_factors(e, 0.01, fit);
}

/* ---- all forms together -----------------------------------------------------------------------
 */

/* Variance and degrees of freedom of a parameter by each form. */
typedef struct opinions {
    size_t count;
    double deviance[FORMS], weight[FORMS];
    double variance[FORMS][IMK_CORRELATED_MAX], freedom[FORMS][IMK_CORRELATED_MAX];
} opinions;

static void set_weights(opinions *o)
{
    double least = HUGE_VAL, sum = 0.0;
    for (size_t k = 0; k < o->count; k++)
        least = fmin(least, o->deviance[k]);
    for (size_t k = 0; k < o->count; k++)
        sum += o->weight[k] = imk_exp(0.5 * (least - o->deviance[k]));
    for (size_t k = 0; k < o->count; k++)
        o->weight[k] /= sum;
}

static const double outside = 0.05;

/* A function that falls through 0 between `low` and `high`. */
typedef double (*imki_falling)(const void *of, double x);

/* Where it is 0, by false position; an end that stays twice counts half. */
static double find_zero(imki_falling f, const void *of, double low, double high)
{
    const double tolerance = 1e-6 * high;
    double at_low = f(of, low), at_high = f(of, high), x = low;
    if (!(at_low > 0.0))
        return low;
    if (!(at_high < 0.0))
        return high;
    for (int round = 0, side = 0; round < 60 && high - low > tolerance; round++) {
        const double last = x;
        x = low + (high - low) * at_low / (at_low - at_high);
        const double at = f(of, x);
        if (fabs(x - last) <= tolerance)
            break;
        if (at > 0.0) {
            low = x;
            at_low = at;
            at_high *= side > 0 ? 0.5 : 1.0;
            side = 1;
        } else {
            high = x;
            at_high = at;
            at_low *= side < 0 ? 0.5 : 1.0;
            side = -1;
        }
    }
    return x;
}

typedef struct parameter_opinions {
    const opinions *of;
    size_t p;
} parameter_opinions;

/* Logarithm of the probability that an error is beyond +-x, over 5 %. */
static double beyond(const void *about, double x)
{
    const parameter_opinions *a = about;
    const opinions *o = a->of;
    double sum = 0.0;
    for (size_t k = 0; k < o->count; k++)
        sum += o->weight[k] * imk_f_upper(x * x / o->variance[k][a->p], 1.0, o->freedom[k][a->p]);
    return sum > 0.0 ? imk_ln(sum / outside) : -700.0;
}

/* Student's quantile of 97.5 % is about linear in 1/(degrees of freedom): the logarithm of 5 % over
 * the probability beyond +-x. */
static double within(const void *x, double inverse_freedom)
{
    const double *bound = x;
    return imk_ln(outside / imk_f_upper(*bound * *bound, 1.0, 1.0 / inverse_freedom));
}

/* The degrees of freedom with which Student's interval of 95 % about a sigma is the one that the
 * forms together hold. It is not narrower than the normal one: the sigma stays that of the
 * solution. */
static double combine(const opinions *o, size_t p, double sigma)
{
    const double normal = imk_normal_quantile(1.0 - 0.5 * outside), least = 1e-9, most = 4.0;
    const parameter_opinions about = {o, p};
    double low = normal * sigma, high = 2.0 * low;
    if (!(beyond(&about, low) > 1e-9)) /* rounding */
        return (double)INFINITY;
    while (high < 1e6 * sigma && beyond(&about, high) > 0.0) {
        low = high;
        high *= 2.0;
    }
    const double bound = find_zero(beyond, &about, low, high) / sigma;
    return 1.0 / find_zero(within, &bound, least, most);
}

/* Variances and degrees by the form solved last, after `o->count` others. */
static void keep_opinion(imki_estimator *e, const imki_fit *fit, opinions *o)
{
    imki_freedoms(e, fit, o->variance[o->count], o->freedom[o->count]);
    for (size_t p = 0; p < e->parameters; p++) {
        const double apart = e->now.global[p] - e->best.global[p];
        o->variance[o->count][p] += apart * apart;
    }
    o->count++;
}

/* What the forms say of the parameters of a sensor; the solution is the chosen one's. */
static void ask_forms(imki_estimator *e, int sensor, const imki_fit *solution, opinions *o)
{
    const form chosen = form_of(e);
    const int bits = form_bits(e, sensor);
    int list[FORMS] = {0}, count = 1;
    o->count = 0;
    for (int k = 0; k < count; k++) {
        imki_fit fit = *solution;
        take_form(e, &chosen);
        imki_point_copy(e, &e->best, &e->now);
        if (list[k] != bits && bits != 0)
            for (int axis = 0; axis < IMK_AXES_MAX; axis++)
                e->factor[imki_part_of(e, sensor, axis)] = 1.0;
        const double reached = list[k] == bits ? deviance(e) + price(e, sensor, &fit)
                                               : try_form(e, sensor, list[k], &fit);
        if (k == 0)
            count = list_forms(e, sensor, list);
        if (!(reached < HUGE_VAL))
            continue;
        o->deviance[o->count] = reached;
        keep_opinion(e, &fit, o);
    }
    take_form(e, &chosen);
    imki_point_copy(e, &e->best, &e->now);
}

/* By the solution alone. */
static void ask_solution(imki_estimator *e, const imki_fit *fit, opinions *o)
{
    o->count = 1;
    o->deviance[0] = 0.0;
    imki_freedoms(e, fit, o->variance[0], o->freedom[0]);
}

/* Parameters of a sensor (-1: of both) by its forms; those of the other, which turns tie to it, are
 * not made more certain. */
static void combine_all(const imki_estimator *e, int sensor, const opinions *o,
                        const double *variance, double *freedom)
{
    for (size_t p = 0; p < e->parameters; p++) {
        const double combined = combine(o, p, sqrt(variance[p]));
        const bool own = sensor < 0 || e->problem->parameter[p].sensor == sensor;
        freedom[p] = own ? combined : fmin(freedom[p], combined);
    }
}

/* ---- an excess that is slow --------------------------------------------------------------------
 */

/* Squares of the residuals of a sensor, of white noise as stated and flicker of strength b:
 *
 *     S = tr R + b tr RC,   variance 2 (tr R + 2 b tr RC + b^2 tr (RC)^2). */
typedef struct slow_excess {
    double square;   /* S */
    double white;    /* tr R */
    double expected; /* tr RC */
    double modes;    /* (tr RC)^2/tr (RC)^2 */
} slow_excess;

/* Degrees of freedom of a sum of squares of n equally spaced values of flicker about their mean:
 * its components have variances 1, 1/2, 1/3 ... of the first. */
static double flicker_modes(size_t n)
{
    double sum = 0.0, squares = 0.0;
    for (size_t k = 1; k < n; k++) {
        sum += 1.0 / (double)k;
        squares += 1.0 / ((double)k * (double)k);
    }
    return sum * sum / squares;
}

static slow_excess excess_of(const imki_estimator *e, int sensor, const imki_fit *fit)
{
    slow_excess x = {0.0, 0.0, 0.0, 0.0};
    for (int axis = 0; axis < IMK_AXES_MAX; axis++) {
        const int part = imki_part_of(e, sensor, axis);
        const size_t count = fit->count[part];
        if (count < 2)
            continue;
        x.square += fit->shared_square[part];
        x.white += fit->shared_redundancy[part];
        x.expected += fit->slow_square[part];
        x.modes += flicker_modes(count) * fit->shared_redundancy[part] / (double)(count - 1);
    }
    return x;
}

/* Variance of the squares, when `slow` of them are flicker's. */
static double spread_of(const slow_excess *x, double slow)
{
    return 2.0 * (x->white + 2.0 * slow + slow * slow / x->modes);
}

/* ln of the density of the squares, taken for a gamma distribution. */
static double log_density(const slow_excess *x, double slow)
{
    const double mean = x->white + slow, scale = spread_of(x, slow) / mean, shape = mean / scale;
    return (shape - 1.0) * imk_ln(x->square) - x->square / scale - shape * imk_ln(scale) -
           imk_log_gamma(shape);
}

/* Variances with flicker of several strengths, each by how well it agrees with the squares; none
 * of the instabilities sqrt(b) is likelier before. */
static void ask_strengths(const imki_estimator *e, const slow_excess *x, opinions *o)
{
    const double seen = fmax(0.0, x->square - x->white);
    const double most = seen + 4.0 * sqrt(spread_of(x, seen));
    o->count = FORMS;
    for (size_t k = 0; k < o->count; k++) {
        const double part = ((double)k + 0.5) / FORMS, slow = part * part * most;
        o->deviance[k] = -2.0 * log_density(x, slow);
        for (size_t p = 0; p < e->parameters; p++) {
            const size_t at = p * e->globals + p;
            o->variance[k][p] =
                e->normal.covariance[at] + slow / x->expected * fmax(0.0, e->slow.covariance[at]);
            o->freedom[k][p] = (double)INFINITY;
        }
    }
    set_weights(o);
}

/* What gyros at rest scatter by beyond the noise within holds may be slow, while accelerometers
 * also read what a hand or a table did to a pose. Parameters whose inputs change slowly in the test
 * are then known less well than the excess says on the average, as those whose inputs change
 * quickly are known better. Few holds do not tell which it is; the intervals are not narrower than
 * with flicker. */
static void ask_slow_noise(imki_estimator *e, const double *variance, double *freedom, opinions *o)
{
    const form chosen = form_of(e);
    imki_fit fit;
    e->by_axis[IMK_GYRO] = true;
    e->added[IMK_GYRO] = 0.0;
    for (int axis = 0; axis < IMK_AXES_MAX; axis++)
        e->factor[imki_part_of(e, IMK_GYRO, axis)] = 1.0;
    if (imki_estimator_covariance(e) == IMK_OK && imki_slow_noise_assume(e, IMK_GYRO, &fit)) {
        const slow_excess x = excess_of(e, IMK_GYRO, &fit);
        if (x.white > 0.0 && x.expected > 0.0) {
            ask_strengths(e, &x, o);
            for (size_t p = 0; p < e->parameters; p++)
                if (e->problem->parameter[p].sensor == IMK_GYRO)
                    freedom[p] = fmin(freedom[p], combine(o, p, sqrt(variance[p])));
        }
    }
    take_form(e, &chosen);
}

imk_status imki_scatter_freedoms(imki_estimator *e, imki_fit *fit, double *freedom)
{
    opinions o;
    bool asked = false, estimated[IMKI_PARTS];
    double variance[IMK_CORRELATED_MAX] = {0.0};
    for (size_t p = 0; p < e->parameters; p++)
        variance[p] = e->normal.covariance[p * e->globals + p];
    ask_solution(e, fit, &o);
    set_weights(&o);
    combine_all(e, -1, &o, variance, freedom);
    imki_point_copy(e, &e->now, &e->best);
    for (int sensor = 0; sensor < 2; sensor++) {
        const int group = sensor == IMK_GYRO ? IMK_GROUP_GYRO : IMK_GROUP_ACCEL;
        if (!imki_sum_group(e, fit, group).estimated)
            continue;
        ask_forms(e, sensor, fit, &o);
        set_weights(&o);
        asked = true;
        if (o.count > 1)
            combine_all(e, sensor, &o, variance, freedom);
        if (sensor == IMK_GYRO)
            ask_slow_noise(e, variance, freedom, &o);
    }
    if (!asked)
        return IMK_OK;
    imki_point_apply(e, &e->now);
    const imk_status status = imki_estimator_covariance(e);
    memcpy(estimated, fit->estimated, sizeof estimated);
    imki_fit_groups(e, fit);
    memcpy(fit->estimated, estimated, sizeof estimated);
    return status;
}

void imki_common_scatter(imki_estimator *e)
{
    memset(e->by_axis, 0, sizeof e->by_axis);
    memset(e->added, 0, sizeof e->added);
    e->turns_stated = false;
    for (int part = 0; part < IMKI_PARTS; part++)
        e->factor[part] = 1.0;
}

imk_status imki_choose_scatter(imki_estimator *e, imki_fit *fit)
{
    imk_status status = IMK_OK;
    for (int sensor = 0; status == IMK_OK && sensor < 2; sensor++) {
        const int group = sensor == IMK_GYRO ? IMK_GROUP_GYRO : IMK_GROUP_ACCEL;
        if (fit->estimated[group] && fit->freedom[group] >= least_freedom)
            status = choose(e, sensor, fit);
    }
    return status;
}
