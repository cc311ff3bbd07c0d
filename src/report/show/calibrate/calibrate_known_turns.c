/* SPDX-License-Identifier: Apache-2.0 */
/* Logs of the procedure turns: each turn in a table and as data, and what the verdict says of them.
 */
#include "calibrate_message_internal.h"

#include "imukit/distributions.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double degree = 0.017453292519943295;

bool imki_is_of_turns(const imk_calibrate_log *b, const imk_observation *o)
{
    return o->record >= 0 && (size_t)o->record < b->count &&
           b->record[o->record].procedure == IMK_PROCEDURE_TURNS;
}

bool imki_has_only_turns(const imk_calibrate_log *b)
{
    for (size_t k = 0; k < b->count; k++)
        if (b->record[k].procedure != IMK_PROCEDURE_TURNS)
            return false;
    return true;
}

/* ---- each turn -------------------------------------------------------------------------------
 */

typedef struct turn {
    int body;           /* axis of the unit */
    double angle, read; /* stated, and by the calibrated gyro about it [rad] */
    double sigma;       /* of the difference, with the factor found */
} turn;

static bool turn_of(const imk_calibrate_log *b, const imk_observation *o, turn *t)
{
    const imk_triad *gyro = &b->result->model.gyro;
    if (!imki_is_of_turns(b, o) || !(o->turn_time > 0))
        return false;
    *t = (turn){.sigma = o->placement_sigma * b->result->placement.factor};
    for (int axis = 0; axis < gyro->axis_count; axis++) {
        if (isnan(o->reading[0][axis]))
            continue;
        double rate = o->reading[0][axis];
        if (b->record[o->record].record.counts[0])
            rate = (rate - gyro->zero_offset.value[axis]) / gyro->sensitivity.value[axis];
        for (int j = 1; j < 3; j++)
            if (fabs(o->rate[j]) > fabs(o->rate[t->body]))
                t->body = j;
        t->angle = o->rate[t->body] * o->turn_time;
        t->read = rate * o->turn_time / (1 + gyro->scale_factor.fixed.value[axis]) *
                  (gyro->direction[axis][t->body] < 0 ? -1 : 1);
    }
    return true;
}

void imki_turn_table(const imk_calibrate_log *b, imk_result *result)
{
    const bool several = b->count > 1;
    imk_table *table = NULL;
    turn t;
    for (size_t k = 0; k < b->calibration->observation_count; k++) {
        const imk_observation *o = &b->calibration->observation[k];
        if (!turn_of(b, o, &t))
            continue;
        const imk_test_record *record = b->calibration->record[o->record];
        if (!table) {
            table = imk_result_table(result, 0);
            imk_table_row(table,
                          "%s\tfrom [s]\tlength [s]\tabout\tangle [deg]\tread [deg]\toff [deg]\t"
                          "sigmas\t",
                          several ? "log" : "");
        }
        imk_table_row(table, "%.30s\t%.2f\t%.2f\t%c\t%+.5g\t%+.3f\t%+.3f\t%.1f\t%s",
                      several ? record->name : "", imk_test_record_time(record, o->begin),
                      o->turn_time, imk_axis_letter(t.body), t.angle / degree, t.read / degree,
                      (t.read - t.angle) / degree, fabs(t.read - t.angle) / t.sigma,
                      o->weight > 0.5 ? ""
                      : o->weight > 0 ? "doubtful"
                                      : "left out");
    }
    if (table)
        imk_result_gap(result);
}

void imki_turn_fit(const imk_calibrate_log *b, imk_table *table)
{
    const imk_group_fit *fit = &b->result->placement;
    size_t turns = 0, refused = 0;
    double square = 0;
    turn t;
    for (size_t k = 0; k < b->calibration->observation_count; k++) {
        const imk_observation *o = &b->calibration->observation[k];
        if (!turn_of(b, o, &t))
            continue;
        turns++;
        if (o->weight > 0)
            square += (t.read - t.angle) * (t.read - t.angle);
        else
            refused++;
    }
    for (size_t k = 0; k < b->count; k++) {
        turns += b->record[k].findings.known_turns.odd;
        refused += b->record[k].findings.known_turns.odd;
    }
    if (turns == 0)
        return;
    imk_table_row(table, "turns by stated angles\t%zu\t%zu", turns, refused);
    if (imki_has_only_turns(b) && fit->degrees_of_freedom >= 0.5)
        imk_table_add(table, "%.4g / %.1f\t%.3g", fit->chi_square, fit->degrees_of_freedom,
                      fit->factor);
    else
        imk_table_add(table, "-\t-");
    imk_table_add(table, "%.4g deg", sqrt(square / (double)(turns - refused)) / degree);
}

void imki_show_turns(const imk_calibrate_log *b, imk_result *result)
{
    turn t;
    bool any = false;
    for (size_t k = 0; k < b->count; k++)
        any = any || b->record[k].procedure == IMK_PROCEDURE_TURNS;
    if (!any)
        return;
    imk_result_array(result, "turns");
    for (size_t k = 0; b->result && k < b->calibration->observation_count; k++) {
        const imk_observation *o = &b->calibration->observation[k];
        if (!turn_of(b, o, &t))
            continue;
        const imk_test_record *record = b->calibration->record[o->record];
        const char axis[2] = {imk_axis_letter(t.body), '\0'};
        imk_result_object(result, NULL);
        imk_result_text(result, "log", record->name);
        imk_result_quantity(result, "begin", imk_test_record_time(record, o->begin), "s");
        imk_result_quantity(result, "length", o->turn_time, "s");
        imk_result_text(result, "axis", axis);
        imk_result_quantity(result, "angle", t.angle, "rad");
        imk_result_quantity(result, "read", t.read, "rad");
        imk_result_quantity(result, "sigma", t.sigma, "rad");
        imk_result_number(result, "weight", o->weight);
        imk_result_end(result);
    }
    imk_result_end(result);
}

/* ---- verdict ---------------------------------------------------------------------------------
 */

static void add_other_moves(const imk_calibrate_record *log, imk_verdict *v)
{
    const imk_turns_findings *f = &log->findings.known_turns;
    char many[80] = "a move is", what[120], range[120] = "";
    if (f->other_moves == 0)
        return;
    if (f->other_moves > 1)
        snprintf(many, sizeof many, "%zu moves are", f->other_moves);
    const double begin = imk_test_record_time(&log->record, f->other_begin),
                 angle = f->other_angle / degree, due = log->settings.turn_angle / degree;
    if (f->other_axis < 0)
        snprintf(what, sizeof what, "is not about one axis, or not about that of its label");
    else
        snprintf(what, sizeof what, "is by %.4g deg about %c, not by %.4g deg", angle,
                 imk_axis_letter(f->other_axis), due);
    if (f->other_axis >= 0 && f->other_moves > 1)
        snprintf(range, sizeof range,
                 "; if all turns about %c read so, gyro_%c may have another range or unit",
                 imk_axis_letter(f->other_axis), imk_axis_letter(f->other_axis));
    imki_calibrate_add(
        v, imki_calibrate_say(
               IMK_FINDING_NOTE, "other_move",
               "%s: %s left out: %s at %.2f s %s. If it was a turn, state its angle (--turn-angle, "
               "or a label such as \"z %+.3gdeg\"), and turn about one axis of the unit only%s",
               log->path, many, f->other_moves > 1 ? "the first" : "that", begin, what,
               f->other_axis < 0 ? due : angle, range));
}

/* Labels that name another axis than the gyro that reads the turn. */
static void add_other_gyros(const imk_calibrate_record *log, imk_verdict *v)
{
    const imk_turns_findings *f = &log->findings.known_turns;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const char label = imk_axis_letter(i), gyro = imk_axis_letter(j);
            if (f->other_gyro[i][j] == 0 || (i > j && f->other_gyro[j][i] > 0))
                continue;
            if (f->other_gyro[j][i] > 0)
                imki_calibrate_add(
                    v, imki_calibrate_say(
                           IMK_FINDING_WARNING, "swapped_axes",
                           "%s: gyro_%c and gyro_%c look exchanged: %zu turns whose labels name "
                           "%c are read by gyro_%c, and %zu that name %c by gyro_%c, and are left "
                           "out; exchange the two names, in the header or with --columns, or "
                           "correct the labels",
                           log->path, label, gyro, f->other_gyro[i][j], label, gyro,
                           f->other_gyro[j][i], gyro, label));
            else
                imki_calibrate_add(
                    v,
                    imki_calibrate_say(
                        IMK_FINDING_WARNING, "swapped_axes",
                        "%s: gyro_%c reads most of turns whose labels name %c (%zu of them, left "
                        "out): correct the labels, or the names of the columns",
                        log->path, gyro, label, f->other_gyro[i][j]));
        }
}

/* By the solution, which leaves outliers out, where it has repetitions enough; else by the log. */
static void add_scatter(const imk_calibrate_log *b, const imk_calibrate_record *log, imk_verdict *v)
{
    const double by_chance = 1e-3;
    const imk_group_fit *fit = &b->result->placement;
    imk_turns_findings f = log->findings.known_turns;
    char advice[160] = "no mark is so far off: some turns were by another angle, or stopped on the "
                       "way, or samples are missing in them";
    if (imki_has_only_turns(b) && b->count == 1 && fit->degrees_of_freedom >= 3) {
        f.freedom = fit->degrees_of_freedom;
        f.chi_square = fit->chi_square;
        f.scatter = fit->factor * log->settings.placement_sigma;
    }
    if (f.torn[0] + f.torn[1] + f.torn[2] > 0)
        return; /* said of the axis that causes it */
    if (!(f.freedom > 0))
        imki_calibrate_add(
            v, imki_calibrate_say(
                   IMK_FINDING_NOTE, "placement_untested",
                   "%s: no turn is repeated, so the log does not test the angles: their "
                   "uncertainty is as --placement states, %.2g deg; turn about each axis three "
                   "times or more to test it",
                   log->path, log->settings.placement_sigma / degree));
    else if (imk_gamma_upper(0.5 * f.freedom, 0.5 * f.chi_square) < by_chance) {
        if (f.scatter < imki_placement_most)
            snprintf(advice, sizeof advice,
                     "check the mark or the edge that the unit is turned to, or state --placement "
                     "%.2gdeg, which counts for the misalignments too",
                     f.scatter / degree);
        imki_calibrate_add(
            v, imki_calibrate_say(
                   IMK_FINDING_WARNING, "placement",
                   "%s: the angles of the turns scatter by %.2g deg (1 sigma), %.2g times what "
                   "--placement and the noise explain: the uncertainty of the scale factors "
                   "includes this; %s",
                   log->path, f.scatter / degree, sqrt(f.chi_square / f.freedom), advice));
    }
}

/* Turns by another angle than stated, or about an axis that does not tell which these are. */
static void add_odd(const imk_calibrate_record *log, imk_verdict *v)
{
    const imk_turns_findings *f = &log->findings.known_turns;
    for (size_t k = 0; k < f->odd && k < IMK_ODD_TURNS_MAX; k++) {
        const imk_odd_turn *t = &f->odd_turn[k];
        const char axis = imk_axis_letter(t->axis);
        imki_calibrate_add(
            v,
            imki_calibrate_say(
                IMK_FINDING_WARNING, "odd_turn",
                "%s: turn %d about %c, at %.2f s: %.4g deg recorded for %.5g deg stated, against "
                "what the other turns show: it is left out. If it was turned by this angle, "
                "label it \"%c %+.4gdeg\"; else look for what happened to the unit or the log "
                "there",
                log->path, t->number, axis, imk_test_record_time(&log->record, t->begin),
                t->read / degree, t->angle / degree, axis, t->read / degree));
    }
    if (f->odd > IMK_ODD_TURNS_MAX)
        imki_calibrate_add(v, imki_calibrate_say(IMK_FINDING_WARNING, "odd_turn",
                                                 "%s: %zu more such turns", log->path,
                                                 f->odd - IMK_ODD_TURNS_MAX));
    for (int j = 0; j < 3; j++)
        if (f->torn[j] > 0)
            imki_calibrate_add(
                v, imki_calibrate_say(
                       IMK_FINDING_WARNING, "turns_disagree",
                       "%s: the turns about %c disagree by %.3g deg with each other, and are too "
                       "few to "
                       "tell which is by another angle than stated: none is left out, and the "
                       "scale factors of all gyros are less certain by as much; turn about %c "
                       "again, three times or more",
                       log->path, imk_axis_letter(j), f->torn[j] / degree, imk_axis_letter(j)));
}

/* As the diagnostics of the log have said it. */
static bool saturation_is_said(const imk_calibrate_record *log)
{
    for (size_t d = 0; d < log->diagnostic_count; d++)
        if (log->diagnostic[d].kind == IMK_DIAGNOSTIC_SATURATED)
            return true;
    return false;
}

void imki_turns_verdict(const imk_calibrate_log *b, const imk_calibrate_record *log, imk_verdict *v)
{
    const imk_turns_findings *f = &log->findings.known_turns;
    if (log->procedure != IMK_PROCEDURE_TURNS || !b->result)
        return;
    add_other_moves(log, v);
    add_other_gyros(log, v);
    if (f->saturated > 0 && !saturation_is_said(log))
        imki_calibrate_add(
            v, imki_calibrate_say(IMK_FINDING_WARNING, "saturated",
                                  "%s: in %zu turn%s a gyro is at the end of its range: left out; "
                                  "turn more slowly, or choose a larger range in the device",
                                  log->path, f->saturated, f->saturated == 1 ? "" : "s"));
    if (f->missing > 0)
        imki_calibrate_add(
            v, imki_calibrate_say(IMK_FINDING_WARNING, "turns_missing",
                                  "%s: in %zu move%s samples are missing, or there is no rest "
                                  "beside it: left out",
                                  log->path, f->missing, f->missing == 1 ? "" : "s"));
    add_odd(log, v);
    add_scatter(b, log, v);
    if (!imki_has_only_turns(b) || log != b->record)
        return;
    imki_calibrate_add(
        v, imki_calibrate_say(
               IMK_FINDING_NOTE, "attitude_unknown",
               "without accelerometers the attitude is not known: the uncertainty of the bias "
               "includes the Earth's rotation and a g-sensitivity of %.2g deg/h/g (1 sigma, state "
               "--g-sensitivity-sigma), and that of the misalignments how square the axes of the "
               "turns are to the unit, %.2g deg (--placement)",
               log->settings.g_sensitivity_sigma * 9.80665 * 3600 / degree,
               log->settings.placement_sigma / degree));
}
