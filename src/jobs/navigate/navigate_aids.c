/* SPDX-License-Identifier: Apache-2.0 */
/* Readings of aids on their way through the record: into the filter, and what became of them. */
#include "navigate_aids_internal.h"

#include <math.h>
#include <stdio.h>

/* Steps of the covariance: a vehicle turns between them, and readings come. */
static const double aided_step = 0.1; /* [s] */
/* A reading so soon after the start says how well the start is known [s]. */
static const double soon = 5.0;
/* From this distance on, and so many sigma, a start is said to be elsewhere [m]. */
static const double far_off = 100.0, far_sigmas = 5.0;
/* From the start to a place that is meant to be there [m]. */
static const double near_start = 1e4;
/* So many readings refused in a row at the end, and a share of them in all, are told. */
enum { REFUSED_MAX = 20, REFUSED_FEW = 5 };
static const double refused_share = 0.005;
/* A share of refusals that leaves the sigmas of the estimate in doubt; what of the innovations a
 * delay must explain to be told, and the longest one [s]. */
static const double doubt_share = 0.1, late_share = 0.3, late_most = 60.0;
/* Spans of the readings and the log that are as 1000 to 1, within this factor: ms are taken for s.
 */
static const double thousand = 1000.0, thousand_within = 1.25;
/* A correlation from reading to reading that is told, beyond this many of its own sigma. */
static const double correlation_told = 0.2, correlation_sigmas = 4.0;

void imki_aid_find(imk_navigate_log *n, imk_finding_level level, const char *code, const char *name,
                   size_t count, const double *numbers)
{
    char text[96];
    const char *record = n->settings.aids_name;
    snprintf(text, sizeof text, "%.40s\t%.50s", name, record ? record : "the aids");
    imki_find(&n->findings, level, code, text, count, numbers);
}

static double start_time(const imk_navigate_log *n)
{
    return imki_navigate_row_time(n, n->first) - n->record.dt;
}

/* 1 sigma of a reading on an axis. */
static double sigma_of(const imk_aid *aid, const imk_aid_reading *reading, int axis)
{
    return reading->sigma[axis] > 0.0 ? reading->sigma[axis] : aid->sigma[axis];
}

/* The first reading that the filter gets, if it comes soon; NULL. */
static const imk_aid_reading *first_reading(const imk_navigate_log *n, const imki_aid_series *s)
{
    const double start = start_time(n);
    for (size_t i = 0; i < s->count; i++)
        if (s->reading[i].time > start)
            return s->reading[i].time < start + soon ? &s->reading[i] : NULL;
    return NULL;
}

/* The start is no better known than by what it differs from the first reading. */
static void widen(double *sigma, double off, double of_reading)
{
    if (isfinite(of_reading))
        *sigma = fmax(*sigma, hypot(off, of_reading));
}

static void describe_start(const imk_navigate_log *n, const imk_navigate_aid *a,
                           const imk_aid_reading *reading, imk_navigation_filter_settings *s)
{
    imk_geodetic place;
    imk_vector3 velocity;
    imk_matrix3 c_nb;
    imk_navigation_state_to_ned(&n->start, &place, &velocity, &c_nb);
    const imk_vector3 arm = imk_matrix3_apply(
        c_nb, (imk_vector3){{a->aid.lever_arm[0], a->aid.lever_arm[1], a->aid.lever_arm[2]}});
    if (a->aid.kind == IMK_AID_POSITION) {
        const imk_navigation_state there = imk_navigation_state_ned(
            0.0, (imk_geodetic){reading->value[0], reading->value[1], reading->value[2]},
            (imk_vector3){{0}}, imk_matrix3_identity());
        const imk_vector3 off = imk_navigation_difference_ned(&there, &n->start);
        for (int i = 0; i < 3; i++)
            widen(&s->initial_sigma[i], off.v[i] - arm.v[i], sigma_of(&a->aid, reading, i));
    }
    if (a->aid.kind == IMK_AID_HEIGHT)
        widen(&s->initial_sigma[2], reading->value[0] - place.height + arm.v[2],
              sigma_of(&a->aid, reading, 0));
    if (a->aid.kind == IMK_AID_VELOCITY && !imki_navigate_aligns(n))
        for (int i = 0; i < 3; i++)
            widen(&s->initial_sigma[3 + i], reading->value[i] - velocity.v[i],
                  sigma_of(&a->aid, reading, i));
    if (a->aid.kind == IMK_AID_ODOMETER && !imki_navigate_aligns(n))
        for (int i = 0; i < 3; i++)
            widen(&s->initial_sigma[3 + i], c_nb.m[i][0] * reading->value[0] - velocity.v[i],
                  a->aid.sigma[0]);
}

void imki_aids_describe(const imk_navigate_log *n, const imki_navigate_aids *aids,
                        imk_navigation_filter_settings *s)
{
    s->step = aided_step;
    s->aid_count = n->aid_count;
    for (size_t k = 0; k < n->aid_count; k++) {
        const imk_aid_reading *reading = first_reading(n, &aids->series[k]);
        s->aid[k] = n->aid[k].aid;
        if (reading)
            describe_start(n, &n->aid[k], reading, s);
    }
}

/* Is a place near the start? By the chord. */
static bool is_near(const imk_navigate_log *n, double latitude, double longitude)
{
    const imk_geodetic place = {latitude, longitude, n->settings.place.height};
    return imk_vector3_norm(
               imk_vector3_subtract(imk_ecef_from_geodetic(place), n->start.position)) < near_start;
}

/* Of a first position far from the start: would a common slip in it explain that? */
static void tell_start(imk_navigate_log *n, double distance, const double value[3])
{
    const bool swapped = is_near(n, value[1], value[0]);
    const bool south = is_near(n, -value[0], value[1]), west = is_near(n, value[0], -value[1]);
    imki_aid_find(n, IMK_FINDING_WARNING, "aid_start_off", "position",
                  IMKI_NUMBERS(distance, swapped, south, west));
}

static void warn_of_start(imk_navigate_log *n, const imki_navigate_aids *aids)
{
    for (size_t k = 0; k < n->aid_count; k++) {
        const imk_aid_reading *reading = first_reading(n, &aids->series[k]);
        if (n->aid[k].aid.kind != IMK_AID_POSITION || !reading)
            continue;
        const imk_navigation_state there = imk_navigation_state_ned(
            0.0, (imk_geodetic){reading->value[0], reading->value[1], reading->value[2]},
            (imk_vector3){{0}}, imk_matrix3_identity());
        const imk_vector3 off = imk_navigation_difference_ned(&there, &n->start);
        const double distance = hypot(off.v[0], off.v[1]);
        if (distance > far_off && distance > far_sigmas * sigma_of(&n->aid[k].aid, reading, 0))
            tell_start(n, distance, reading->value);
    }
}

imk_status imki_aids_start(imk_navigate_log *n, imki_navigate_aids *aids, imk_error *error)
{
    const double start = start_time(n), rounding = 1e-6 * n->record.dt;
    warn_of_start(n, aids);
    for (size_t k = 0; k < n->aid_count; k++) {
        imki_aid_series *s = &aids->series[k];
        imk_navigate_aid *a = &n->aid[k];
        while (s->next < s->count && !(s->reading[s->next].time > start + rounding))
            s->next++;
        a->outside = s->next;
        const size_t room = s->count - s->next;
        double *memory = imki_resize(&n->record.log.allocator, NULL,
                                     (room + 1) * (4 * sizeof *memory + sizeof *a->verdict));
        if (!memory)
            return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
        a->time = memory;
        for (size_t i = 0; i < 3; i++)
            a->innovation[i] = memory + (i + 1) * (room + 1);
        a->verdict = (unsigned char *)(memory + 4 * (room + 1));
    }
    return IMK_OK;
}

static void note_innovation(imk_navigate_aid *a, double time, imk_aid_verdict verdict,
                            const imk_innovation *i, bool compared)
{
    const size_t at = a->tested++;
    a->time[at] = time;
    a->verdict[at] = (unsigned char)(compared ? IMK_AID_NOT_USED : verdict);
    for (int axis = 0; axis < 3; axis++) {
        a->innovation[axis][at] = (double)NAN;
        if (compared)
            a->last_off[axis] = a->last_sigma[axis] = (double)NAN;
    }
    for (size_t r = 0; r < i->rows; r++) {
        a->innovation[i->axis[r]][at] = i->value[r] / i->sigma[r];
        if (compared) {
            a->last_off[i->axis[r]] = i->value[r];
            a->last_sigma[i->axis[r]] = i->sigma[r];
        }
    }
    if (compared) {
        a->compared++;
        a->compared_square += i->chi_square;
        a->compared_degrees += i->rows;
    } else {
        a->first = isnan(a->first) ? time : a->first;
        a->last = time;
    }
}

/* Those that were used have drawn the estimate to where they are. */
static void note_along(imki_aid_series *s, const imk_navigation_state *state,
                       const imk_innovation *innovation)
{
    imk_vector3 velocity;
    imk_navigation_state_to_ned(state, NULL, &velocity, NULL);
    for (size_t r = 0; r < innovation->rows; r++) {
        const double z = innovation->value[r] / innovation->sigma[r];
        const double v = velocity.v[innovation->axis[r]] / innovation->sigma[r];
        if (innovation->axis[r] == 2)
            continue;
        s->along += z * v;
        s->along_square += v * v;
        s->square += z * z;
    }
}

void imki_aids_update(imk_navigate_log *n, imki_navigate_aids *aids, imk_navigation_filter *filter,
                      size_t row)
{
    const double now = imki_navigate_row_time(n, row), rounding = 1e-6 * n->record.dt;
    const double until = imki_navigate_row_time(n, 0) + n->settings.aid_until;
    for (size_t k = 0; k < n->aid_count; k++) {
        imki_aid_series *s = &aids->series[k];
        for (; s->next < s->count && s->reading[s->next].time <= now + rounding; s->next++) {
            imk_aid_reading reading = s->reading[s->next];
            const double time = reading.time;
            reading.compare = time > until;
            /* From the row on, so that no rounding of the filter's clock comes in. */
            reading.time = imk_navigation_filter_state(filter).time + (time - now);
            const imk_navigation_state state = imk_navigation_filter_state(filter);
            const imk_aid_verdict verdict = imk_navigation_filter_aid(filter, k, &reading);
            const imk_innovation innovation = imk_navigation_filter_innovation(filter);
            if (n->aid[k].aid.kind == IMK_AID_POSITION && !reading.compare &&
                (verdict == IMK_AID_REFUSED || verdict == IMK_AID_RECOVERED))
                note_along(s, &state, &innovation);
            if (verdict == IMK_AID_NOT_USED)
                n->aid[k].skipped++;
            else
                note_innovation(&n->aid[k], time, verdict, &innovation, reading.compare);
        }
    }
}

/* Readings at other times than those navigated: none is used, or the whole table is within an
 * instant of the log, or the log within one of the table. */
static void tell_unused(imk_navigate_log *n, const imk_navigate_aid *a, const imki_aid_series *s)
{
    const double begin = imki_navigate_row_time(n, 0);
    const double end = imki_navigate_row_time(n, n->record.rows - 1);
    if (s->count == 0)
        return;
    const double first = s->reading[0].time, last = s->reading[s->count - 1].time;
    const uint64_t used = a->counts.accepted + a->counts.refused;
    const double ratio =
        last > first ? fabs(log((end - begin) / (last - first)) / log(thousand)) : 0.0;
    const bool unit =
        s->count > REFUSED_MAX && fabs(ratio - 1.0) < log(thousand_within) / log(thousand);
    const bool unused = used == 0 && a->outside + a->compared == s->count;
    const char *name = imk_aid_kind_name(a->aid.kind);
    const double count = (double)s->count;
    if (unit)
        imki_aid_find(n, IMK_FINDING_WARNING, "aid_time_unit", name,
                      IMKI_NUMBERS((double)used, count, first, last, begin, end));
    else if (unused)
        imki_aid_find(n, IMK_FINDING_WARNING, "aid_unused", name,
                      IMKI_NUMBERS(count, first, last, start_time(n), end, a->compared > 0));
}

/* By how much the positions that were refused are late, by least squares; 0: not known [s]. */
static double lateness(const imki_aid_series *s)
{
    const double late = s->along / s->along_square;
    const bool explains = s->along * late > late_share * s->square;
    return explains && fabs(late) < late_most ? late : 0.0;
}

/* The sigmas of the estimate are those of readings that were used, if only wrong ones were not. */
static void tell_doubt(imk_navigate_log *n, const imk_navigate_aid *a, const imki_aid_series *s)
{
    const imk_navigation_filter_counts *c = &a->counts;
    const double refused = (double)c->refused, tried = refused + (double)c->accepted;
    if (c->recovered < 2 && !(c->refused > REFUSED_MAX && refused > doubt_share * tried))
        return;
    const double late = c->refused > REFUSED_MAX ? lateness(s) : 0.0;
    imki_aid_find(n, IMK_FINDING_WARNING, "aid_doubt", imk_aid_kind_name(a->aid.kind),
                  IMKI_NUMBERS(100.0 * refused / tried, fabs(late), late > 0.0, late < 0.0,
                               n->settings.aid_delay + late));
}

static void tell(imk_navigate_log *n, const imk_navigate_aid *a)
{
    const imk_navigation_filter_counts *c = &a->counts;
    const char *name = imk_aid_kind_name(a->aid.kind);
    const double refused = (double)c->refused, tried = refused + (double)c->accepted;
    const imk_finding_level level = IMK_FINDING_WARNING;
    if (a->disordered > 0)
        imki_aid_find(n, level, "aid_disordered", name,
                      IMKI_NUMBERS((double)a->disordered, (double)a->readings));
    if (a->skipped > 0 && !(n->settings.aid_interval > 0))
        imki_aid_find(n, level, "aid_skipped", name,
                      IMKI_NUMBERS((double)a->skipped, (double)a->readings));
    if (refused > REFUSED_FEW + refused_share * tried)
        imki_aid_find(
            n, level, "aid_refused", name,
            IMKI_NUMBERS(refused, tried, n->first_time + c->first_refused - n->record.dt));
    if (c->recovered > 0)
        imki_aid_find(
            n, level, "aid_recovered", name,
            IMKI_NUMBERS((double)c->recovered, n->first_time + c->first_recovered - n->record.dt));
    if (c->refused_in_row >= REFUSED_MAX)
        imki_aid_find(n, level, "aid_lost", name, IMKI_NUMBERS((double)c->refused_in_row));
    const double q = c->degrees > 20 ? c->chi_square / (double)c->degrees : 0.0;
    if (q > 2.0)
        imki_aid_find(n, level, "aid_too_good", name, IMKI_NUMBERS(sqrt(q), q));
    const double r = c->pairs > 20 ? imk_navigation_filter_correlation(c) : 0.0;
    if (fabs(r) > correlation_told && fabs(r) > correlation_sigmas / sqrt((double)c->pairs))
        imki_aid_find(n, level, "aid_correlated", name, IMKI_NUMBERS(100 * r));
}

void imki_aids_finish(imk_navigate_log *n, imki_navigate_aids *aids,
                      const imk_navigation_filter *filter)
{
    for (size_t k = 0; k < n->aid_count; k++) {
        n->aid[k].counts = imk_navigation_filter_aided(filter, k);
        n->aid[k].outside += aids->series[k].count - aids->series[k].next;
        tell_unused(n, &n->aid[k], &aids->series[k]);
        tell(n, &n->aid[k]);
        tell_doubt(n, &n->aid[k], &aids->series[k]);
    }
}
