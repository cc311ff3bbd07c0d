/* SPDX-License-Identifier: Apache-2.0 */
/* What no test of these logs can show, because another sound unit would give the same log: it is
 * named, so that "Good" does not vouch for it. */
#include "calibrate_show_internal.h"

#include <math.h>
#include <stdlib.h>

#define add_item(list, words)                                                                      \
    (imki_text_put(list, (list)->size > 0 ? "; " : ""), imki_text_put(list, words))

static const char of_reference[] = "an error of the reference, or of how the unit is mounted (it "
                                   "goes into bias, scale factor and misalignment)";

static bool is_estimated_term(const imk_calibrate_log *b, int sensor, int term)
{
    for (size_t p = 0; b->result && p < b->result->parameter_count; p++)
        if (b->result->parameter[p].sensor == sensor && b->result->parameter[p].term == term)
            return true;
    return false;
}

static bool is_estimated(const imk_calibrate_log *b, int sensor)
{
    return is_estimated_term(b, sensor, IMK_MODEL_SCALE_FACTOR);
}

/* A procedure of any record; `unnamed`: whose faces or poses have no labels. */
static bool has(const imk_calibrate_log *b, imk_procedure first, imk_procedure last, bool unnamed)
{
    for (size_t k = 0; k < b->count; k++)
        if (b->record[k].procedure >= first && b->record[k].procedure <= last &&
            !(unnamed && b->record[k].record.section))
            return true;
    return false;
}

/* Only these procedures: others would contradict what they cannot show. */
static bool has_only(const imk_calibrate_log *b, imk_procedure one, imk_procedure other)
{
    for (size_t k = 0; k < b->count; k++)
        if (b->record[k].procedure != one && b->record[k].procedure != other)
            return false;
    return true;
}

/* Is the unit turned both ways about each axis that it is turned about? */
static bool turns_both_ways(const imk_calibrate_log *b)
{
    int ways[3] = {0};
    for (size_t i = 0; i < b->calibration->observation_count; i++) {
        const imk_observation *o = &b->calibration->observation[i];
        int axis = 0;
        for (int j = 1; j < 3; j++)
            axis = fabs(o->rate[j]) > fabs(o->rate[axis]) ? j : axis;
        if (o->turn_time > 0)
            ways[axis] |= o->rate[axis] > 0 ? 1 : 2;
    }
    for (int j = 0; j < 3; j++)
        if (ways[j] == 1 || ways[j] == 2)
            return false;
    return true;
}

/* Turns by known angles and nothing else to compare them with. */
static void add_of_turns(const imk_calibrate_log *b, imki_text *list)
{
    if (!has_only(b, IMK_PROCEDURE_FERRARIS, IMK_PROCEDURE_TURNS))
        return;
    add_item(list, "all turns about an axis by the same angle too much or too little, or rows lost "
                   "in turns and times made afterwards (the scale factor changes by as much)");
    if (!turns_both_ways(b))
        add_item(list, "asymmetry and K2 of gyros that are turned one way only (they go into the "
                       "scale factor)");
}

/* On the faces of a housing. */
static void add_of_faces(const imk_calibrate_log *b, imki_text *list)
{
    if (!has_only(b, IMK_PROCEDURE_SIXPOSITION, IMK_PROCEDURE_FERRARIS))
        return;
    add_item(list, "a tilted plate, faces that are not square, or a unit that slips in its housing "
                   "(they go into the misalignments; --placement and --mounting count in their "
                   "uncertainty)");
    if (!is_estimated_term(b, 1, IMK_MODEL_K2))
        add_item(list, "K2 and K3 of the accelerometers (they go into bias and scale factor)");
}

/* Where no attitude is known, what acts on a gyro at rest is in its bias. */
static void add_of_attitude(const imk_calibrate_log *b, imki_text *list)
{
    const double degrees_per_hour = 4.84813681109536e-6;
    const imk_calibration *c = b->calibration;
    double most = 0;
    bool force = true, earth = false;
    for (size_t i = 0; b->result && i < c->observation_count; i++) {
        const imk_observation *o = &c->observation[i];
        if (isnan(o->reading[0][0]))
            continue;
        if (!(o->offset_sigma > 0))
            return;
        most = fmax(most, o->offset_sigma);
        force = force && (o->force[0] != 0 || o->force[1] != 0 || o->force[2] != 0);
        earth = earth || c->record[o->record]->reference_on_ground;
    }
    if (most > 0)
        imki_text_add(list,
                      "%s%s in the bias of the gyros (%.2g deg/h, 1 sigma: its uncertainty "
                      "includes it)",
                      list->size > 0 ? "; " : "",
                      force   ? "the Earth's rotation"
                      : earth ? "g-sensitivity and the Earth's rotation"
                              : "g-sensitivity",
                      most / degrees_per_hour);
}

/* With references the rates and forces are known: a clock takes no part. */
static void add_of_gyros(const imk_calibrate_log *b, imki_text *list)
{
    const imk_model_parameter across = {IMK_GYRO, IMK_MODEL_MISALIGNMENT, 0, 1};
    if (!is_estimated(b, 0))
        return;
    if (has(b, IMK_PROCEDURE_RATE_TABLE, IMK_PROCEDURE_SPIN, false))
        add_item(list, of_reference);
    else if (has(b, IMK_PROCEDURE_MULTIPOSITION, IMK_PROCEDURE_FERRARIS, false) ||
             has(b, IMK_PROCEDURE_TURNS, IMK_PROCEDURE_TURNS, false))
        add_item(list, "a sampling rate that is some per cent off (the scale factors of all "
                       "gyros change by as much)");
    if (b->nominal[0] && imki_has_only_turns(b))
        add_item(list, "turns by another angle than stated (the sensitivity found is wrong by as "
                       "much)");
    else
        add_of_turns(b, list);
    if (imk_calibrate_find(b, across) >= 0 &&
        has(b, IMK_PROCEDURE_TURNS, IMK_PROCEDURE_TURNS, false))
        add_item(list, "turns about axes that are not quite those of the unit (the misalignments "
                       "change by as much; --placement counts in their uncertainty)");
    bool read = false;
    for (size_t k = 0; k < b->count; k++)
        read = read || b->record[k].findings.known_turns.direction_read;
    if (read)
        add_item(list, "the sign of a gyro (where no label states the direction of a turn, it is "
                       "that which its gyro reads)");
}

/* Mistakes about the axes that no turn of any record would show. */
static uint64_t axes_unseen(const imk_calibrate_log *b)
{
    uint64_t unseen = UINT64_MAX;
    for (size_t k = 0; k < b->count; k++)
        if (b->record[k].procedure <= IMK_PROCEDURE_FERRARIS)
            unseen &= b->record[k].axes_unseen;
    return unseen;
}

/* Single signs; that of an accelerometer is as good as those of both other gyros. */
static void add_signs(uint64_t unseen, imki_text *list)
{
    static const int of_gyro[3] = {1, 2, 4}, of_accel[3] = {6, 5, 3};
    imki_text names = {0};
    int count = 0;
    for (int i = 0; i < 6; i++)
        count += unseen >> (i < 3 ? of_gyro[i] : of_accel[i - 3]) & 1;
    for (int i = 0; i < 3; i++)
        if (unseen >> of_gyro[i] & 1)
            imki_list_item(&names, "gyro_%c", imk_axis_letter(i));
    for (int i = 0; i < 3; i++)
        if (unseen >> of_accel[i] & 1)
            imki_list_item(&names, "accel_%c", imk_axis_letter(i));
    if (names.bytes)
        imki_text_add(list, "; the opposite sign of %s%s (no turn tells it)",
                      count > 1 ? "one of " : "", names.bytes);
    free(names.bytes);
}

static void add_of_axes(const imk_calibrate_log *b, imki_text *list)
{
    const uint64_t unseen = axes_unseen(b), signs = 0xff;
    if (unseen == UINT64_MAX) {
        add_item(list, "an accelerometer with the opposite sign, or several (the attitudes are "
                       "then other ones); axes that are named x, y, z in another order");
        return;
    }
    add_item(list, "all accelerometers with the opposite sign");
    add_signs(unseen, list);
    add_item(list, (unseen & ~signs) ? "axes that are named x, y, z in another order"
                                     : "axes that are named x, y, z in another right-handed order");
}

static void add_of_gravity(const imk_calibrate_log *b, imki_text *list)
{
    const bool referenced = has(b, IMK_PROCEDURE_RATE_TABLE, IMK_PROCEDURE_SPIN, false);
    if (is_estimated(b, 1) && !is_estimated(b, 0) && referenced)
        add_item(list, of_reference);
    if (!is_estimated(b, 1) || !has(b, IMK_PROCEDURE_MULTIPOSITION, IMK_PROCEDURE_FERRARIS, false))
        return;
    add_item(list, "gravity that is some per cent off (the scale factors of all "
                   "accelerometers change by as much)");
    add_of_faces(b, list);
    if (is_estimated_term(b, 0, IMK_MODEL_G_SENSITIVITY) && b->settings.place_known)
        add_item(list, "the sign of the latitude (g-sensitivity of each gyro to the force along "
                       "it)");
    if (has(b, IMK_PROCEDURE_RATE_TABLE, IMK_PROCEDURE_SPIN, false))
        return;
    if (has(b, IMK_PROCEDURE_MULTIPOSITION, IMK_PROCEDURE_MULTIPOSITION, false) ||
        has(b, IMK_PROCEDURE_SIXPOSITION, IMK_PROCEDURE_FERRARIS, true))
        add_of_axes(b, list);
}

/* Where each attitude was taken once, the solution explains its readings whatever they are. */
static void add_of_single_attitudes(const imk_calibrate_log *b, imki_text *list)
{
    const double least_freedom = 3;
    if (b->result && is_estimated(b, 1) &&
        b->result->group[IMK_GROUP_ACCEL].degrees_of_freedom < least_freedom)
        add_item(list,
                 "errors of the accelerometers that stay for a whole attitude, such as a bias "
                 "that drifts from one to the next: they go into bias, scale factor and "
                 "misalignment (take each attitude again)");
}

/* The sign of the dip tells which way round a magnetometer is, where it is known. */
static void add_of_magnetometer(const imk_calibrate_log *b, imki_text *list)
{
    if (!b->mag)
        return;
    if (b->mag->aligned && isnan(b->settings.dip) && !b->settings.place_known)
        add_item(list, "all three axes of the magnetometer with the opposite sign (the dip is then "
                       "the opposite one)");
    if (!b->mag->aligned)
        add_item(list, "signs and order of the magnetometer's axes");
}

static void add_of_thermometer(const imk_calibrate_log *b, imki_text *list)
{
    if (has(b, IMK_PROCEDURE_THERMAL, IMK_PROCEDURE_THERMAL, false))
        add_item(list, "a thermometer with a wrong scale, such as degrees Fahrenheit written as "
                       "degrees Celsius (the coefficients change by as much)");
}

/* What the observations of a test have in common shows in no residual. */
static void add_of_slow_noise(const imk_calibrate_log *b, imki_text *list)
{
    bool timed = false, unknown = false;
    for (size_t k = 0; k < b->count; k++)
        timed = timed ||
                (!b->record[k].record.means && b->record[k].procedure != IMK_PROCEDURE_THERMAL &&
                 b->record[k].procedure != IMK_PROCEDURE_MAGNETOMETER);
    for (int sensor = 0; sensor < 2 && b->result; sensor++)
        unknown =
            unknown || (imki_has_parameters(b, sensor) &&
                        !imki_states_slow_noise(imk_model_triad(&b->calibration->model, sensor)));
    if (timed && unknown)
        add_item(list,
                 "slow noise that no model states (with --into and a model of identify, every "
                 "uncertainty includes it)");
}

void imki_untestable(const imk_calibrate_log *b, imk_verdict *v)
{
    imki_text list = {0};
    add_of_gyros(b, &list);
    add_of_attitude(b, &list);
    add_of_gravity(b, &list);
    add_of_single_attitudes(b, &list);
    add_of_magnetometer(b, &list);
    add_of_thermometer(b, &list);
    add_of_slow_noise(b, &list);
    if (list.bytes)
        imki_verdict_add(v, IMK_FINDING_NOTE, "not_testable", "Cannot be seen in %s: %s",
                         b->count == 1 ? "this log" : "these logs", list.bytes);
    free(list.bytes);
}
