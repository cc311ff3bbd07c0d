/* SPDX-License-Identifier: Apache-2.0 */
/* Diagnostics of the solution as messages; and what diagnostics, the findings over temperature and
 * the warnings add up to. */
#include "calibrate_message_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Residuals this far above the noise are not a trembling hand: the model is another one. Sound logs
 * of real units turned by hand have 1 to 5. */
static const double residual_alarm = 10;

/* ---- on the solution ------------------------------------------------------------------------- */

static imki_calibrate_message correlated(const imk_calibrate_log *b, double correlation)
{
    char one[IMK_MODEL_PARAMETER_NAME] = "?", other[IMK_MODEL_PARAMETER_NAME] = "?";
    const imk_calibration_result *r = b->result;
    bool linear = true;
    for (int k = 0; k < 2; k++) {
        const imk_model_parameter *p = &r->parameter[r->weakest_parameter[k]];
        (void)imk_model_parameter_name(*p, k == 0 ? one : other);
        linear = linear && (p->term == IMK_MODEL_BIAS || p->term == IMK_MODEL_SCALE_FACTOR ||
                            p->term == IMK_MODEL_MISALIGNMENT);
    }
    /* Few rates do not separate K2 from an asymmetry: their intervals say so, and the log is sound.
     */
    return imki_calibrate_say(
        linear ? IMK_FINDING_WARNING : IMK_FINDING_NOTE, "correlated",
        "%s and %s are strongly correlated (%.4f): an error in one balances an error in the "
        "other, so only a combination of both is known well; add poses or turns that differ "
        "more, or leave one of the two out (--estimate)",
        one, other, correlation);
}

/* Deviations of means that are named as those of samples are divided by the number of samples once
 * more: chi-square per degree of freedom is then this number, within 3 of its sigmas.
 * @return 0: nothing speaks for it */
static double samples_divided_twice(const imk_calibrate_log *b, const imk_diagnostic_finding *d)
{
    const double least = 5, freedom = b->result->group[d->other].degrees_of_freedom;
    for (size_t k = 0; k < b->count && d->other < IMK_GROUP_TURN; k++) {
        const double samples = b->record[k].samples[d->sensor];
        if (samples >= least && fabs(log(d->value / samples)) < 3 * sqrt(2 / freedom))
            return samples;
    }
    return 0;
}

static imki_calibrate_message divided_twice(const imk_diagnostic_finding *d, double samples)
{
    const char *key = imki_sensor_keys[d->sensor];
    return imki_calibrate_say(
        sqrt(d->value) > residual_alarm ? IMK_FINDING_WARNING : IMK_FINDING_NOTE, "std_of_mean",
        "the residuals of the %s means are %.3g times what %s_x_std and samples explain "
        "(chi-square per degree of freedom %.3g, and a mean has %.4g samples): if the deviations "
        "are those of the means already, name the columns %s_x_std_of_mean; else the table, the "
        "hand or the sensor does more than the model describes. Every 1 sigma includes this excess",
        imki_sensor_titles[d->sensor], sqrt(d->value), key, d->value, samples, key);
}

/* What the log holds is not what the model says. */
static imki_calibrate_message unexplained(const imk_calibrate_log *b,
                                          const imk_diagnostic_finding *d)
{
    static const struct {
        const char *what, *si, *causes;
    } groups[IMK_GROUPS] = {
        {"gyro readings at rest", "rad/s",
         "the unit was not at rest in all holds, or the bias drifts"},
        {"accelerometer readings", "m/s^2",
         "a face, a label or a reference is not what it is said to be, the unit was moved during "
         "holds, or the accelerometers are at the end of their range or not linear"},
        {"turns between poses", "rad",
         "gyros and accelerometers are not sampled at the same time, the sampling rate varies, a "
         "gyro saturates, signs or axes are wrong, or the gyros sense the force and g_sensitivity "
         "is not estimated"}};
    const int g = d->other >= 0 && d->other < IMK_GROUPS ? d->other : 0;
    const double rms = b->result->group[g].rms;
    const imk_unit unit = imk_unit_readable(imk_unit_of(groups[g].si).dimension, rms);
    return imki_calibrate_say(
        IMK_FINDING_WARNING, "residuals",
        "the %s differ from the solution by %.3g %s rms, %.3g times what the noise within "
        "the holds explains (chi-square per degree of freedom %.3g): the model does not "
        "describe this log, and the intervals hold only if the excess is random. Likely "
        "causes: %s; --poses lists the residuals",
        groups[g].what, rms / unit.scale, unit.text, sqrt(d->value), d->value, groups[g].causes);
}

/* The noise of each axis, and what no residuals tell. */
static imki_calibrate_message unequal_axes(const imk_calibrate_log *b,
                                           const imk_diagnostic_finding *d)
{
    const imk_group_fit *g =
        &b->result->group[d->sensor == IMK_GYRO ? IMK_GROUP_GYRO : IMK_GROUP_ACCEL];
    const imk_unit unit = imk_unit_readable(imk_unit_of(imki_sensor_units[d->sensor]).dimension,
                                            g->axis_noise[d->other]);
    const char *key = imki_sensor_keys[d->sensor];
    const char quiet = imk_axis_letter(d->axis), noisy = imk_axis_letter(d->other);
    return imki_calibrate_say(
        IMK_FINDING_WARNING, "unequal_axes",
        "the noise of %s_%c (1 sigma of a mean %.3g %s) is %.3g times that of %s_%c (%.3g %s), and "
        "nothing in this log tells how far errors of poses exceed the noise: the intervals take "
        "the "
        "noise for all there is, and those of %s_%c may be much too narrow; add poses or repeat "
        "the faces, and look for what disturbs %s_%c",
        key, noisy, g->axis_noise[d->other] / unit.scale, unit.text, d->value, key, quiet,
        g->axis_noise[d->axis] / unit.scale, unit.text, key, quiet, key, noisy);
}

/* With fewer than three degrees of freedom the estimator leaves the sigmas as stated. */
static imki_calibrate_message slightly_unexplained(const imk_calibrate_log *b,
                                                   const imk_diagnostic_finding *d)
{
    const bool known = d->other >= 0 && d->other < IMK_GROUPS;
    const bool included = !known || b->result->group[d->other].factor > 0.9 * sqrt(d->value);
    return imki_calibrate_say(
        included ? IMK_FINDING_NOTE : IMK_FINDING_WARNING, "residuals",
        "the residuals are %.3g times what the noise within the holds explains (chi-square per "
        "degree of freedom %.3g): the table, the hand or the sensor does more than the model "
        "describes; %s",
        sqrt(d->value), d->value,
        included ? "every 1 sigma includes this excess"
                 : "the residuals are too few to include this excess in the sigmas: add poses or "
                   "repeat them");
}

static imki_calibrate_message on_solution(const imk_calibrate_log *b,
                                          const imk_diagnostic_finding *d)
{
    double samples;
    switch (d->kind) {
    case IMK_DIAGNOSTIC_RESIDUALS:
        samples = samples_divided_twice(b, d);
        if (samples > 0)
            return divided_twice(d, samples);
        if (sqrt(d->value) > residual_alarm)
            return unexplained(b, d);
        return slightly_unexplained(b, d);
    case IMK_DIAGNOSTIC_CORRELATED:
        return correlated(b, d->value);
    case IMK_DIAGNOSTIC_UNEQUAL_AXES:
        return unequal_axes(b, d);
    default:
        return imki_calibrate_say(
            IMK_FINDING_WARNING, "outliers",
            "%.3g %% of the observations do not fit the others and are left out; --poses "
            "lists them; if there are more than a few, the unit moved during the holds, or "
            "the unit of a column or a label is wrong",
            100 * d->value);
    }
}

/* Worth a look only where holds are looked for. */
static bool diagnostic_matters(const imk_calibrate_record *log,
                               const imk_diagnostic_finding *diagnostic)
{
    const bool looks_for_holds = log->procedure == IMK_PROCEDURE_MULTIPOSITION;
    const bool takes_holds = looks_for_holds || log->procedure == IMK_PROCEDURE_SIXPOSITION;
    switch (diagnostic->kind) {
    case IMK_DIAGNOSTIC_NEVER_STATIC:
        return takes_holds || log->procedure == IMK_PROCEDURE_THERMAL ||
               log->procedure == IMK_PROCEDURE_TURNS;
    case IMK_DIAGNOSTIC_NEVER_MOVES:
        return takes_holds;
    case IMK_DIAGNOSTIC_FEW_POSES:
    case IMK_DIAGNOSTIC_ONE_PLANE:
    case IMK_DIAGNOSTIC_ONE_CONE:
        return looks_for_holds;
    default:
        return true;
    }
}

static imki_calibrate_message diagnostic_message(const imk_calibrate_log *b,
                                                 const imk_calibrate_record *log,
                                                 const imk_diagnostic_finding *diagnostic)
{
    const bool of_solution = diagnostic->kind == IMK_DIAGNOSTIC_RESIDUALS ||
                             diagnostic->kind == IMK_DIAGNOSTIC_CORRELATED ||
                             diagnostic->kind == IMK_DIAGNOSTIC_UNEQUAL_AXES ||
                             diagnostic->kind == IMK_DIAGNOSTIC_OUTLIERS;
    if (of_solution)
        return on_solution(b, diagnostic);
    if (log)
        return imki_message_on_log(b, log, diagnostic);
    /* Responses that were solved for: of a force, times what was read at rest. */
    imk_diagnostic_finding found = *diagnostic;
    if (found.kind == IMK_DIAGNOSTIC_GRAVITY_UNIT)
        found.value *= b->calibration->gravity;
    return imki_message_on_log(b, &b->record[0], &found);
}

bool imki_calibrate_useless(const imk_calibrate_log *b, const imk_calibrate_record *log, char *text,
                            size_t size)
{
    for (size_t k = 0; k < log->diagnostic_count; k++) {
        const imki_calibrate_message message = diagnostic_message(b, log, &log->diagnostic[k]);
        if (!diagnostic_matters(log, &log->diagnostic[k]) || message.level != IMK_FINDING_FAILURE)
            continue;
        snprintf(text, size, "%s: %s", log->path, message.text);
        return true;
    }
    return false;
}

/* ---- all of them ----------------------------------------------------------------------------- */

/* Mean squares over the rests of a log: of what rounding leaves in a mean, as the estimate is told
 * it, and of all that a mean is uncertain by; in the unit of the readings. */
static double rounding_square(const imk_calibrate_record *log, int sensor, int axis)
{
    double sum = 0;
    for (size_t k = 0; k < log->interval_count; k++)
        sum += pow(log->interval[k].rounding[sensor][axis], 2);
    /* The same in all rests of a gyro: it does not average out, and with poses and faces sigmas
     * count it so. */
    const bool counted = sensor == IMK_GYRO && log->procedure <= IMK_PROCEDURE_FERRARIS;
    return counted || log->interval_count == 0 ? sum : sum / (double)log->interval_count;
}

static double sigma_square(const imk_calibrate_log *b, const imk_calibrate_record *log, int sensor,
                           int axis)
{
    const imk_procedure_findings *f = &log->findings;
    double sum = 0, count = 0;
    for (size_t k = f->first_observation; k < f->first_observation + f->observations; k++) {
        const imk_observation *o = &b->calibration->observation[k];
        if (o->relative || !isfinite(o->reading[sensor][axis]))
            continue;
        sum += pow(o->sigma[sensor][axis], 2);
        count++;
    }
    return count > 0 ? sum / count : 0;
}

/* Steps that are coarser than the noise: what rounding leaves in the means is most of what they are
 * uncertain by, and it is an error that does not look random. */
static void add_coarse(const imk_calibrate_log *b, const imk_calibrate_record *log, imk_verdict *v)
{
    const double share = 0.5;
    imki_text names = {0};
    if (!b->result || log->record.means || log->procedure == IMK_PROCEDURE_THERMAL ||
        log->procedure == IMK_PROCEDURE_MAGNETOMETER)
        return;
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < log->record.axis_count[sensor]; i++) {
            const double square = rounding_square(log, sensor, i);
            const double whole = sigma_square(b, log, sensor, i);
            if (whole > 0 && square > share * whole)
                imki_list_item(&names, "%s_%c", imki_sensor_keys[sensor],
                               imk_axis_letter(log->body_axis[sensor][i]));
        }
    if (names.bytes)
        imki_calibrate_add(
            v, imki_calibrate_say(
                   IMK_FINDING_WARNING, "coarse",
                   "%.150s: the readings of %s are rounded to steps coarser than their noise, or "
                   "are cut off around zero: their means at rest are wrong by up to half a step, "
                   "which more samples do not improve; log more digits or choose a smaller range",
                   log->path, names.bytes));
    free(names.bytes);
}

/* Positions in which the unit goes on turning; a few may be knocks. */
static void add_creeping(const imk_calibrate_record *log, imk_verdict *v)
{
    const imk_procedure_findings *f = &log->findings;
    const size_t few = 2;
    const double share = 0.15;
    if (f->creeping > few && (double)f->creeping > share * (double)f->intervals)
        imki_calibrate_add(
            v, imki_calibrate_say(
                   IMK_FINDING_WARNING, "creep",
                   "%.150s: in %zu of %zu positions the accelerometers change steadily while the "
                   "reference does not: the unit goes on turning, which the gyros feel, or the "
                   "bias drifts; wait until the table stands, or clamp it",
                   log->path, f->creeping, f->intervals));
}

/* Rests of the sensors in which no position of the reference was found. */
static size_t rests_without_position(const imk_calibrate_log *b, const imk_calibrate_record *log)
{
    const imk_procedure_findings *f = &log->findings;
    size_t without = 0;
    for (size_t k = 0; k < log->interval_count; k++) {
        bool found = false;
        for (size_t i = f->first_observation; i < f->first_observation + f->observations; i++)
            found = found || (b->calibration->observation[i].begin < log->interval[k].end &&
                              b->calibration->observation[i].end > log->interval[k].begin);
        without += !found;
    }
    return without;
}

static void add_moving_reference(const imk_calibrate_log *b, const imk_calibrate_record *log,
                                 imk_verdict *v)
{
    const double many = 0.2;
    if (log->procedure != IMK_PROCEDURE_TUMBLE || log->record.means)
        return;
    const size_t without = rests_without_position(b, log);
    if ((double)without > many * (double)log->interval_count)
        imki_calibrate_add(
            v, imki_calibrate_say(
                   IMK_FINDING_WARNING, "reference_moves",
                   "%.150s: in %zu of %zu rests the reference is not constant for long enough, and "
                   "they are not used: the table creeps, or the reference is too noisy or late; "
                   "wait until the table stands, or clamp it",
                   log->path, without, log->interval_count));
}

/* Few labels that the readings contradict: their holds are left out. */
static void add_contradicted(const imk_calibrate_record *log, imk_verdict *v)
{
    const imk_procedure_findings *f = &log->findings;
    const char *label = f->contradicted ? imki_label_of(&log->record, f->contradicted_at) : NULL;
    if (label)
        imki_calibrate_add(
            v, imki_calibrate_say(
                   IMK_FINDING_WARNING, "wrong_label",
                   "%.150s: the label %.60s names another face than the accelerometers show, and "
                   "the hold is left out (%zu such label%s): correct the labels",
                   log->path, label, f->contradicted, f->contradicted == 1 ? "" : "s"));
}

/* Rests that were not taken: what is estimated holds without them, but a log that lacks many of its
 * rests is not the one that was meant. */
static void add_lost(const imk_calibrate_record *log, imk_verdict *v)
{
    const double many = 0.2;
    char list[700];
    const double all = (double)(log->lost_count + log->interval_count);
    const bool one = log->lost_count == 1;
    if (log->lost_count == 0)
        return;
    imki_lost_text(log, list, sizeof list);
    imki_calibrate_add(
        v, imki_calibrate_say((double)log->lost_count > many * all ? IMK_FINDING_WARNING
                                                                   : IMK_FINDING_NOTE,
                              "lost_rests",
                              "%.150s: %zu stretch%s between turns, of %g, look%s like %s, but "
                              "cannot be used: %s",
                              log->path, log->lost_count, one ? "" : "es", all, one ? "s" : "",
                              one ? "a rest" : "rests", list));
}

/* "gyro.nonlinearity.k2" of gyro.nonlinearity.k2.x. */
static void term_of(imk_model_parameter parameter, char term[IMK_MODEL_PARAMETER_NAME])
{
    parameter.axis = parameter.element = 0;
    term[0] = '\0';
    if (imk_model_parameter_name(parameter, term) != IMK_OK)
        return;
    char *axis = strstr(term, ".x");
    if (axis)
        *axis = '\0';
}

/* Terms a procedure would have estimated and the log does not determine, on some axes at least. */
static void add_undetermined(const imk_calibrate_log *b, const imk_calibrate_record *log,
                             imk_verdict *v)
{
    const imk_procedure_findings *f = &log->findings;
    imki_text names = {0};
    char term[IMK_MODEL_PARAMETER_NAME];
    for (size_t k = 0; k < f->undetermined_count && k < IMK_UNDETERMINED_MAX; k++) {
        term_of(f->undetermined[k], term);
        if (imk_calibrate_find(b, f->undetermined[k]) < 0 &&
            !(names.bytes && strstr(names.bytes, term)))
            imki_list_item(&names, "%s", term);
    }
    if (names.bytes)
        imki_calibrate_add(
            v, imki_calibrate_say(
                   IMK_FINDING_NOTE, "undetermined",
                   "%s does not determine %s (on all axes): the undetermined values are left as "
                   "before; apply inputs along other axes, or more levels",
                   log->path, names.bytes));
    free(names.bytes);
}

/* Placements that scatter beyond what is stated of them: in one of a thousand calibrations by
 * chance. */
static void add_placements(const imk_calibrate_log *b, imk_verdict *v)
{
    const double by_chance = 1e-3, degrees = 57.29577951308232;
    const imk_group_fit *fit = b->result ? &b->result->placement : NULL;
    if (!fit || fit->count == 0 || imki_has_only_turns(b))
        return;
    if (!(fit->degrees_of_freedom >= 3))
        imki_calibrate_add(
            v, imki_calibrate_say(
                   IMK_FINDING_NOTE, "placement_untested",
                   "this log does not test the placements: their uncertainty is as --placement "
                   "states; put the unit on each face three times to test it"));
    else if (imk_calibration_placement_probability(b->result) < by_chance) {
        char advice[80] = "";
        if (fit->rms < imki_placement_most)
            snprintf(advice, sizeof advice, ", or state --placement %.2gdeg", fit->rms * degrees);
        imki_calibrate_add(
            v, imki_calibrate_say(
                   IMK_FINDING_WARNING, "placement",
                   "the placements scatter by %.2g deg (1 sigma), %.2g times what --placement "
                   "states: this is included in every uncertainty; check the faces and the plate%s",
                   fit->rms * degrees, fit->factor, advice));
    }
}

bool imki_states_slow_noise(const imk_triad *triad)
{
    bool any = false;
    for (int axis = 0; axis < triad->axis_count; axis++)
        any = any || triad->noise.bias_instability.value[axis] > 0 ||
              triad->noise.random_walk.value[axis] > 0;
    return triad->present && (any || triad->noise.gauss_markov_count > 0);
}

bool imki_has_parameters(const imk_calibrate_log *b, int sensor)
{
    size_t p = 0;
    while (p < b->result->parameter_count && b->result->parameter[p].sensor != sensor)
        p++;
    return p < b->result->parameter_count;
}

/* What the means of a table leave open. */
static void add_means(const imk_calibrate_log *b, const imk_calibrate_record *log, imk_verdict *v)
{
    static const int groups[2] = {IMK_GROUP_GYRO, IMK_GROUP_ACCEL};
    const imk_model_parameter scale = {IMK_GYRO, IMK_MODEL_SCALE_FACTOR, 0, 0};
    const bool turns = log->record.axis_count[0] == 0 || imk_calibrate_find(b, scale) >= 0;
    bool slow = false;
    if (!log->record.means || !b->result)
        return;
    for (int sensor = 1; sensor >= 0; sensor--) {
        const imk_group_fit *fit = &b->result->group[groups[sensor]];
        if (!imki_has_parameters(b, sensor))
            continue;
        slow = slow || imki_states_slow_noise(imk_model_triad(&b->calibration->model, sensor));
        if (!log->no_sigma[sensor] || fit->count == 0)
            continue;
        const imk_unit unit =
            imk_unit_readable(imk_unit_of(imki_sensor_units[sensor]).dimension, fit->rms);
        imki_calibrate_add(
            v, imki_calibrate_say(
                   IMK_FINDING_NOTE, "noise_of_residuals",
                   "%.150s does not say how well the %s means are known: their noise is taken from "
                   "the scatter of the residuals, %.3g %s rms, with %.1f degrees of freedom",
                   log->path, imki_sensor_titles[sensor], fit->rms / unit.scale, unit.text,
                   fit->degrees_of_freedom));
    }
    if (!turns && log->procedure == IMK_PROCEDURE_MULTIPOSITION && log->settings.gyro_turns)
        imki_calibrate_add(
            v, imki_calibrate_say(IMK_FINDING_NOTE, "no_turns",
                                  "%.150s has no turns: the scale factors and misalignments of the "
                                  "gyros are left as before",
                                  log->path));
    if (slow)
        imki_calibrate_add(
            v, imki_calibrate_say(
                   IMK_FINDING_NOTE, "no_times",
                   "%.150s has no times: the slow noise that the model states is not included "
                   "beyond what the residuals show",
                   log->path));
}

/* What a g-sensitivity that is not determined, or not estimated, does to the biases. */
static void add_considered(const imk_calibrate_log *b, imk_verdict *v)
{
    const double si = 57.29577951308232 * 3600 * 9.80665;
    const imk_group_fit *fit = b->result ? &b->result->assumed : NULL;
    double sigma = 0;
    if (!fit || fit->count == 0)
        return;
    for (size_t p = 0; p < b->calibration->parameter_count; p++)
        if (b->calibration->prior_guessed[p])
            sigma = b->calibration->prior_sigma[p] * fit->factor;
    imki_calibrate_add(
        v,
        imki_calibrate_say(
            IMK_FINDING_NOTE, "g_sensitivity_assumed",
            "the attitudes do not separate the g-sensitivity of the gyros from their bias, or it "
            "is not estimated: the uncertainty of the bias includes a g-sensitivity of %.2g "
            "deg/h/g (1 sigma, %s); turn the unit upside down in each attitude, or state "
            "--g-sensitivity-sigma",
            sigma * si, fit->degrees_of_freedom >= 3 ? "as this log shows it" : "assumed"));
}

/* What a log showed already need not be said of the solution again, nor of each axis. */
static bool is_said(const imk_verdict *v, size_t count, const char *code)
{
    for (size_t k = 0; k < v->count && k < count; k++)
        if (strcmp(v->message[k].code, code) == 0)
            return true;
    return false;
}

/* A sensitivity that was found takes a sign with it: the model is right if the turns were, and of
 * all gyros alike when the direction of the turns was stated. */
static void add_opposite_turns(const imk_calibrate_log *b, imk_verdict *v)
{
    imki_calibrate_message m = {.level = IMK_FINDING_FAILURE, .code = "left_handed"};
    const size_t count =
        is_said(v, v->count, m.code) ? 0 : imki_turns_text(b, m.text, sizeof m.text);
    if (count == 0)
        return;
    if (b->nominal[0])
        m.level =
            count == (size_t)b->result->model.gyro.axis_count && !isnan(b->settings.turn_angle)
                ? IMK_FINDING_NOTE
                : IMK_FINDING_WARNING;
    imki_calibrate_add(v, m);
}

imk_verdict imk_calibrate_verdict(const imk_calibrate_log *b, size_t count,
                                  const imk_message *before, imk_result *result)
{
    imk_verdict v = {.result = result};
    for (size_t k = 0; k < count; k++)
        imki_verdict_add(&v, before[k].level, before[k].code, "%s", before[k].text);
    for (const imk_calibrate_record *log = b->record; log < b->record + b->count; log++) {
        for (size_t d = 0; d < log->diagnostic_count; d++) {
            if (!diagnostic_matters(log, &log->diagnostic[d]))
                continue;
            const imki_calibrate_message plain = diagnostic_message(b, log, &log->diagnostic[d]);
            imki_calibrate_add(&v, imki_calibrate_say(plain.level, plain.code, "%.150s: %.1000s",
                                                      log->path, plain.text));
        }
        add_undetermined(b, log, &v);
        add_means(b, log, &v);
        add_coarse(b, log, &v);
        add_lost(log, &v);
        add_contradicted(log, &v);
        add_creeping(log, &v);
        add_moving_reference(b, log, &v);
        imki_thermal_verdict(log, &v);
        imki_turns_verdict(b, log, &v);
    }
    add_opposite_turns(b, &v);
    const size_t of_logs = v.count;
    add_placements(b, &v);
    add_considered(b, &v);
    for (size_t d = 0; d < b->diagnostic_count; d++) {
        const imki_calibrate_message message = diagnostic_message(b, NULL, &b->diagnostic[d]);
        const bool of_scale = b->diagnostic[d].kind == IMK_DIAGNOSTIC_SCALE;
        const char *unit = b->diagnostic[d].sensor == 0 ? "rate_unit" : "gravity_unit";
        if (!is_said(&v, of_scale ? of_logs : v.count, message.code) &&
            !(of_scale && is_said(&v, v.count, unit)) &&
            !(of_scale && b->diagnostic[d].value < 0 && is_said(&v, v.count, "left_handed")))
            imki_calibrate_add(&v, message);
    }
    imki_untestable(b, &v);
    return v;
}
