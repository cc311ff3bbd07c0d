/* SPDX-License-Identifier: Apache-2.0 */
/* turns: gyros without accelerometers, turned by known angles a_k about their axes, with rests
 * before and after each turn.
 *
 * With d_k the mean reading over the turn less the mean of the rests around it, each turn about
 * axis j is an observation of the mean rate a_k/T_k,
 *
 *     d_kj = (1 + s_j) a_k/T_k,     sigma = placement/T_k, and the noise of d_k,
 *
 * and all turns about it are one of the misalignments,
 *
 *     d_i = M_ij (rate)             sigma = (placement)(rate), and the noise:
 *
 * how square the axis of the turns is to the unit, turning again does not show. The angles are
 * placements of the estimator, which widens them where repetitions scatter by more than stated.
 *
 * The variance of d_k besides white noise follows from what the readings change by from rest to
 * rest, e_k: rests with independent offsets of the variance v have mean e^2 = 2 v and white noise,
 * and d_k then has v + v/2; a random walk has less. The mean of two rests has a quarter of the sum
 * of their white variances; turns that share a rest count as independent, which turns forth and
 * back make better than that.
 *
 * At rest a gyro reads its bias, a part of the Earth's rate W (variance W^2/3 in an unknown
 * attitude) and its g-sensitivity times g. These are the same until the unit is put down otherwise,
 * so rests between turns about one axis count once. A turn by another angle than stated is found by
 * its ratio of reading to angle, where the others about its axis agree (turns_odd.c). */
#include "turns_internal.h"

#include "base/algebra/vector_internal.h"
#include "base/refuse_internal.h"
#include "imukit/distributions.h"

#include <math.h>

/* Readings are taken for exact beside the angle, whose sigma has their noise in it: then what
 * scatters is the angle, and nothing else is widened. */
static const double reading_share = 0.1;
/* The estimator widens by itself where it has 3 degrees of freedom; of a turn it sees a little less
 * than one. */
static const double freedom_of_estimator = 3.5;
static const double confidence = 0.95;
/* That a sound log has a turn that does not agree with the others. */
static const double odd_by_chance = 1e-3;

size_t imki_turns_workspace(const imk_test_record *record, const imk_procedure_settings *settings)
{
    return imki_turn_list_workspace(record, settings);
}

static int gyros(const imki_turn_list *list)
{
    return list->record.axis_count[IMK_GYRO];
}

/* Ratio of the angle that a gyro reads to the turn's. */
static double ratio_of(const imki_turn_list *list, const imki_known_turn *turn, int axis)
{
    return turn->read[axis] * turn->duration * list->sign[axis] / (list->unit[axis] * turn->angle);
}

/* ---- what the counts stand for ---------------------------------------------------------------
 */

/* One number for the gyros of a part, positive where the directions of the turns are read from
 * them; a zero other than 0 only where readings are plainly offset. */
static void nominal_counts(imki_turn_list *list, imk_triad *gyro)
{
    double per_unit[IMK_AXES_MAX] = {0.0}, turns[IMK_AXES_MAX] = {0.0}, sum = 0.0;
    int turned = 0;
    bool offset = false;
    for (size_t k = 0; k < list->turn_count; k++)
        for (int i = 0; i < gyros(list); i++) {
            const imki_known_turn *turn = &list->turn[k];
            if (list->body[i] != turn->body)
                continue;
            per_unit[i] += ratio_of(list, turn, i);
            turns[i] += 1.0;
            offset = offset || fabs(list->rest[0].mean[IMK_GYRO][i]) > fabs(turn->read[i]);
        }
    for (int i = 0; i < gyros(list); i++)
        if (turns[i] > 0.0) {
            sum += fabs(per_unit[i] / turns[i]);
            turned++;
        }
    for (int i = 0; i < gyros(list); i++) {
        list->unit[i] = (per_unit[i] < 0.0 ? -1.0 : 1.0) * imki_round_digits(sum / turned, 3);
        gyro->sensitivity.value[i] = list->unit[i];
        gyro->zero_offset.value[i] = offset ? rint(list->rest[0].mean[IMK_GYRO][i]) : 0.0;
    }
}

/* ---- variances -------------------------------------------------------------------------------
 */

/* By how much sigmas grow where squares over them sum up to chi_square, with Student's
 * distribution. They are never made smaller. */
static double widening(double chi_square, double freedom)
{
    if (!(freedom >= 1.0) || !(chi_square > freedom))
        return 1.0;
    const double tail = 0.5 + 0.5 * confidence;
    return sqrt(chi_square / freedom) * imk_student_quantile(tail, freedom) /
           imk_normal_quantile(tail);
}

/* Variance of a mean over 1 s, by the rests. */
static double noise_density(const imki_turn_list *list, int axis)
{
    double sum = 0.0;
    for (size_t r = 0; r < list->rest_count; r++) {
        const imk_static_interval *rest = &list->rest[r];
        const double sigma = rest->sigma[IMK_GYRO][axis];
        sum += sigma * sigma * (double)(rest->end - rest->begin) * list->record.dt;
    }
    return sum / (double)list->rest_count;
}

/* Variance of what is taken off a turn, and of what it should be. */
static double variance_of_rests(const imki_turn_list *list, int axis)
{
    double square = 0.0, white = 0.0;
    for (size_t k = 0; k < list->turn_count; k++) {
        const imki_known_turn *turn = &list->turn[k];
        const double before = list->rest[turn->before].sigma[IMK_GYRO][axis],
                     after = list->rest[turn->after].sigma[IMK_GYRO][axis];
        square += turn->drift[axis] * turn->drift[axis];
        white += before * before + after * after;
    }
    return (0.25 * white + 0.75 * fmax(0.0, square - white)) / (double)list->turn_count;
}

/* Of the angle that a gyro reads in a turn [rad], without the turn's own. */
static double angle_variance(const imki_turn_list *list, const imki_known_turn *turn, int axis)
{
    const double rate = noise_density(list, axis) / turn->duration + variance_of_rests(list, axis);
    const double time = turn->duration / list->unit[axis];
    /* A count at least: what quantization leaves where nothing scatters. */
    const double step = list->record.counts[IMK_GYRO] ? list->record.dt / list->unit[axis] : 0.0;
    return rate * time * time + step * step;
}

/* The gyro along the axis of a turn; -1: there is none. */
static int gyro_of(const imki_turn_list *list, const imki_known_turn *turn)
{
    for (int i = 0; i < gyros(list); i++)
        if (list->body[i] == turn->body)
            return i;
    return -1;
}

/* What is told of odd turns: `mean` is that of the ratios of the others about each axis. */
static void tell_odd(const imki_turn_list *list, const double mean[3], imk_turns_findings *f)
{
    int number[3] = {0};
    for (size_t k = 0; k < list->turn_count; k++) {
        const imki_known_turn *turn = &list->turn[k];
        const int i = gyro_of(list, turn);
        number[turn->body]++;
        if (!turn->odd)
            continue;
        if (f->odd < IMK_ODD_TURNS_MAX)
            f->odd_turn[f->odd] =
                (imk_odd_turn){.begin = turn->begin,
                               .axis = turn->body,
                               .number = number[turn->body],
                               .angle = turn->angle,
                               .read = turn->angle * ratio_of(list, turn, i) / mean[turn->body]};
        f->odd++;
    }
}

/* Turns by another angle than stated. */
static void find_odd(const imki_procedure_call *call, imki_turn_list *list)
{
    const double placement = call->settings->placement_sigma;
    imk_turns_findings *f = &call->findings->known_turns;
    double mean[3] = {0.0}, count[3] = {0.0}, least[3] = {0.0}, most[3] = {0.0};
    bool torn[3];
    size_t n = 0;
    for (size_t k = 0; k < list->turn_count; k++) {
        const imki_known_turn *turn = &list->turn[k];
        const int i = gyro_of(list, turn);
        if (i < 0)
            continue;
        const double variance = placement * placement + angle_variance(list, turn, i);
        list->repeat[n++] =
            (imki_repeat){.group = turn->body,
                          .value = ratio_of(list, turn, i),
                          .weight = turn->angle * turn->angle / fmax(variance, 1e-18)};
    }
    imki_find_odd(n, list->repeat, odd_by_chance, torn);
    n = 0;
    for (size_t k = 0; k < list->turn_count; k++) {
        imki_known_turn *turn = &list->turn[k];
        const int j = turn->body;
        const imki_repeat *repeat = &list->repeat[n];
        if (gyro_of(list, turn) < 0)
            continue;
        n++;
        turn->odd = repeat->odd;
        if (turn->odd)
            continue;
        least[j] = count[j] > 0.0 ? fmin(least[j], repeat->value) : repeat->value;
        most[j] = count[j] > 0.0 ? fmax(most[j], repeat->value) : repeat->value;
        mean[j] += (repeat->value - mean[j]) / ++count[j];
        if (torn[j])
            f->torn[j] = fabs(turn->angle) * (most[j] - least[j]) / fabs(mean[j]);
    }
    tell_odd(list, mean, f);
}

/* Scatter of the ratios of each axis, into the findings. @return what widens the angles */
static double look_at_scatter(const imki_procedure_call *call, const imki_turn_list *list)
{
    const double placement = call->settings->placement_sigma;
    imk_turns_findings *f = &call->findings->known_turns;
    double square = 0.0;
    for (int i = 0; i < gyros(list); i++) {
        double weights = 0.0, mean = 0.0, turns = 0.0;
        for (int pass = 0; pass < 2; pass++)
            for (size_t k = 0; k < list->turn_count; k++) {
                const imki_known_turn *turn = &list->turn[k];
                if (turn->body != list->body[i] || turn->odd)
                    continue;
                const double variance = placement * placement + angle_variance(list, turn, i);
                const double weight = turn->angle * turn->angle / fmax(variance, 1e-30);
                const double ratio = ratio_of(list, turn, i);
                if (pass == 0) {
                    weights += weight;
                    mean += weight * ratio;
                    turns += 1.0;
                } else {
                    /* of the angle, also where a gyro reads in another unit */
                    const double off = mean != 0.0 ? ratio * weights / mean - 1.0 : 0.0;
                    f->chi_square += weight * off * off;
                    square += off * off * turn->angle * turn->angle;
                }
            }
        f->freedom += turns > 0.0 ? turns - 1.0 : 0.0;
    }
    f->scatter = f->freedom > 0.0 ? sqrt(square / f->freedom) : 0.0;
    return f->freedom < freedom_of_estimator ? widening(f->chi_square, f->freedom) : 1.0;
}

/* ---- observations ----------------------------------------------------------------------------
 */

static imk_observation empty_observation(const imki_procedure_call *call, int fixture)
{
    imk_observation o = {.knowledge = IMK_INPUT_KNOWN,
                         .record = call->record,
                         .fixture = fixture,
                         .temperature = (double)NAN,
                         .correlated = true};
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < IMK_AXES_MAX; i++) {
            o.reading[sensor][i] = (double)NAN;
            o.sigma[sensor][i] = 1.0;
        }
    return o;
}

/* What an earlier log of turns gave of the same: at rest, or about the same axis. */
static imk_observation *like_before(const imk_calibration *c, const imk_observation *o)
{
    int last = -1; /* record of the latest turn */
    for (size_t k = c->observation_count; k-- > 0;) {
        imk_observation *other = &c->observation[k];
        const bool across = other->relative && !(other->turn_time > 0.0);
        if (other->record == o->record)
            continue;
        if (other->relative)
            last = other->record;
        if (o->relative ? across && imki_dot3(other->rate, o->rate) > 0.5
                        : !other->relative && other->record == last)
            return other;
    }
    return NULL;
}

/* Of several logs the weighted mean is one observation: the estimator would take how they agree for
 * the scatter of all gyro readings. */
static void observe_or_join(const imki_procedure_call *call, const imk_observation *o)
{
    imk_observation *before = like_before(call->calibration, o);
    double chi_square = 0.0, freedom = 0.0;
    if (!before) {
        (void)imk_calibration_observe(call->calibration, o);
        return;
    }
    for (int i = 0; i < IMK_AXES_MAX; i++) {
        double *reading = &before->reading[IMK_GYRO][i], *sigma = &before->sigma[IMK_GYRO][i];
        if (isnan(o->reading[IMK_GYRO][i]))
            continue;
        const double own = o->sigma[IMK_GYRO][i], off = o->reading[IMK_GYRO][i] - *reading;
        const double sum = own * own + *sigma * *sigma;
        chi_square += off * off / sum;
        freedom += 1.0;
        *reading += off * *sigma * *sigma / sum;
        *sigma *= own / sqrt(sum);
    }
    const double widened = widening(chi_square, freedom);
    for (int i = 0; i < IMK_AXES_MAX; i++)
        before->sigma[IMK_GYRO][i] *= widened;
}

/* A reading less that at rest, where the model's zero offset is to be taken off. */
static double relative_reading(const imki_procedure_call *call, const imki_turn_list *list,
                               double reading, int axis)
{
    return reading + (list->record.counts[IMK_GYRO]
                          ? call->calibration->model.gyro.zero_offset.value[axis]
                          : 0.0);
}

static void observe_turn(const imki_procedure_call *call, const imki_turn_list *list,
                         const imki_known_turn *turn, double widened, int fixture)
{
    const double placement = call->settings->placement_sigma;
    imk_observation o = empty_observation(call, fixture);
    o.knowledge = IMK_INPUT_PLACED;
    o.relative = true;
    o.begin = turn->begin;
    o.end = turn->end;
    o.temperature = turn->temperature;
    o.turn_time = turn->duration;
    o.rate[turn->body] = turn->angle / turn->duration;
    for (int i = 0; i < gyros(list); i++) {
        if (list->body[i] != turn->body)
            continue;
        const double variance = placement * placement + angle_variance(list, turn, i);
        const double sigma = fmax(widened * sqrt(variance), 1e-9);
        o.placement_sigma = sigma * sqrt(1.0 - reading_share * reading_share);
        o.reading[IMK_GYRO][i] = relative_reading(call, list, turn->read[i], i);
        o.sigma[IMK_GYRO][i] = reading_share * sigma / turn->duration * fabs(list->unit[i]);
    }
    (void)imk_calibration_observe(call->calibration, &o);
}

/* What the gyros across an axis read in all turns about it, by its angles: at 1 rad/s. */
static void observe_across(const imki_procedure_call *call, const imki_turn_list *list, int body,
                           int fixture)
{
    const double placement = call->settings->placement_sigma;
    /* The Earth's rate across the axis turns with the unit. */
    const double earth = 0.5 * call->calibration->earth_rate * call->calibration->earth_rate;
    imk_observation o = empty_observation(call, fixture);
    size_t turns = 0;
    o.relative = true;
    o.rate[body] = 1.0;
    for (int i = 0; i < gyros(list); i++) {
        double angles = 0.0, product = 0.0, variance = 0.0;
        for (size_t k = 0; k < list->turn_count && list->body[i] != body; k++) {
            const imki_known_turn *turn = &list->turn[k];
            const double square = turn->angle * turn->angle;
            if (turn->body != body || turn->odd)
                continue;
            o.begin = turns++ == 0 ? turn->begin : o.begin;
            o.end = turn->end;
            angles += square;
            product += turn->angle * turn->read[i] * turn->duration;
            variance +=
                square * (angle_variance(list, turn, i) + earth * turn->duration * turn->duration);
        }
        if (!(angles > 0.0))
            continue;
        const double sigma = sqrt(variance / (angles * angles) + placement * placement);
        o.reading[IMK_GYRO][i] = relative_reading(call, list, product / angles, i);
        o.sigma[IMK_GYRO][i] = fmax(sigma, 1e-9) * fabs(list->unit[i]);
    }
    if (turns > 0)
        observe_or_join(call, &o);
}

/* A turn leads from the rest before to this one: the unit was not put down otherwise. */
static bool is_turned_to(const imki_turn_list *list, size_t rest)
{
    for (size_t k = 0; k < list->turn_count; k++)
        if (list->turn[k].before + 1 == rest && list->turn[k].after == rest)
            return true;
    return false;
}

/* What a gyro reads at rest, over the attitudes. */
typedef struct offset {
    double mean, square; /* square: of the attitudes' deviations from the mean */
    double white;        /* variance of an attitude's mean */
    double attitudes;
} offset;

static offset offset_of(const imki_turn_list *list, int axis)
{
    offset o = {.attitudes = 0.0};
    for (size_t r = 0, next; r < list->rest_count; r = next) {
        double sum = 0.0, white = 0.0;
        for (next = r; next == r || (next < list->rest_count && is_turned_to(list, next)); next++) {
            const double sigma = list->rest[next].sigma[IMK_GYRO][axis];
            sum += list->rest[next].mean[IMK_GYRO][axis];
            white += sigma * sigma;
        }
        const double rests = (double)(next - r), off = sum / rests - o.mean;
        o.attitudes += 1.0;
        o.mean += off / o.attitudes;
        o.square += off * off * (1.0 - 1.0 / o.attitudes);
        o.white += white / (rests * rests);
    }
    o.white /= o.attitudes;
    return o;
}

/* Where the attitudes scatter by more than the Earth and the g-sensitivity stated explain, that
 * counts. */
static void observe_rests(const imki_procedure_call *call, const imki_turn_list *list)
{
    const imk_calibration *c = call->calibration;
    const double sensed = call->settings->g_sensitivity_sigma * c->gravity;
    const double unknown = c->earth_rate * c->earth_rate / 3.0 + sensed * sensed;
    imk_observation o = empty_observation(call, -1);
    offset at_rest[IMK_AXES_MAX];
    double variance[IMK_AXES_MAX], chi_square = 0.0, freedom = 0.0;
    for (int i = 0; i < gyros(list); i++) {
        at_rest[i] = offset_of(list, i);
        const double floor = list->record.counts[IMK_GYRO] ? 1.0 / 12.0 : 1e-18;
        variance[i] = fmax(unknown * list->unit[i] * list->unit[i] + at_rest[i].white, floor);
        chi_square += at_rest[i].square / variance[i];
        freedom += at_rest[i].attitudes - 1.0;
    }
    const double widened = widening(chi_square, freedom);
    for (int i = 0; i < gyros(list); i++) {
        o.reading[IMK_GYRO][i] = at_rest[i].mean;
        o.sigma[IMK_GYRO][i] = widened * sqrt(variance[i] / at_rest[i].attitudes);
    }
    o.begin = list->rest[0].begin;
    o.end = list->rest[list->rest_count - 1].end;
    o.temperature = list->rest[0].temperature;
    observe_or_join(call, &o);
}

/* ---- parameters ------------------------------------------------------------------------------
 */

static bool is_turned_about(const imki_turn_list *list, int body)
{
    for (size_t k = 0; k < list->turn_count; k++)
        if (list->turn[k].body == body)
            return true;
    return false;
}

static imk_status free_one(const imki_procedure_call *call, int term, int axis, int element)
{
    const imk_status status =
        imk_calibration_free(call->calibration, IMK_GYRO, term, axis, element);
    return status == IMK_OK ? IMK_OK
                            : imk_error_set(call->error, status, "parameters", NULL,
                                            "at most 64 parameters can be estimated at once");
}

/* Scale factors of the axes turned about, and what the gyros across them sense. */
static imk_status free_terms(const imki_procedure_call *call, const imki_turn_list *list)
{
    imk_procedure_findings *f = call->findings;
    imk_status status = imki_free_term(call, IMK_GYRO, IMK_MODEL_BIAS, 1, true);
    for (int i = 0; status == IMK_OK && !call->keep_free && i < gyros(list); i++) {
        if (is_turned_about(list, list->body[i]))
            status = free_one(call, IMK_MODEL_SCALE_FACTOR, i, 0);
        else
            f->undetermined[f->undetermined_count++] =
                (imk_model_parameter){IMK_GYRO, IMK_MODEL_SCALE_FACTOR, (uint8_t)i, 0};
        for (int j = 0; status == IMK_OK && j < 3; j++)
            if (j != list->body[i] && is_turned_about(list, j))
                status = free_one(call, IMK_MODEL_MISALIGNMENT, i, j);
    }
    return status;
}

imk_status imki_turns_observe(const imki_procedure_call *call)
{
    imk_calibration *c = call->calibration;
    imki_turn_list list;
    if (!(call->settings->turn_angle > 0.0))
        return imki_refuse(call->error, IMK_ERROR_RANGE, "turn_angle", call->settings->turn_angle,
                           0.0, "above 0: labels, or the gyros, say which way a turn goes");
    imk_status status = imki_turn_list_make(call, &list);
    if (status == IMK_OK)
        status = free_terms(call, &list);
    if (status != IMK_OK)
        return status;
    const size_t needed = c->observation_count + list.turn_count + 4;
    if (needed > c->observation_capacity)
        return imki_refuse(call->error, IMK_ERROR_WORKSPACE, "observations", (double)needed,
                           (double)c->observation_capacity,
                           "provide room for one observation per turn, and four");
    const int fixture = imki_add_fixture(call);
    if (fixture == -2)
        return imk_error_set(call->error, IMK_ERROR_RANGE, "fixture", NULL,
                             "at most 8 mountings in one solution");
    if (!list.known)
        nominal_counts(&list, &c->model.gyro);
    for (size_t k = 0; k < list.turn_count; k++)
        if (!list.turn[k].stated)
            call->findings->known_turns.direction_read = true;
    find_odd(call, &list);
    const double widened = look_at_scatter(call, &list);
    observe_rests(call, &list);
    for (size_t k = 0; k < list.turn_count; k++)
        if (!list.turn[k].odd)
            observe_turn(call, &list, &list.turn[k], widened, fixture);
    for (int body = 0; body < 3; body++)
        observe_across(call, &list, body, fixture);
    return IMK_OK;
}
