/* SPDX-License-Identifier: Apache-2.0 */
/* imukit identify --plan: the bounds of imukit/identify_plan.h for the axes of a model. */
#include "identify_plan_parts.h"

#include "shell/command.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void add_row(identify_plan *p, plan_row row, double value)
{
    for (size_t r = 0; r < p->row_count; r++)
        if (p->row[r].accel == row.accel && p->row[r].term == row.term &&
            p->row[r].time == row.time) {
            p->row[r].low = fmin(p->row[r].low, value);
            p->row[r].high = fmax(p->row[r].high, value);
            return;
        }
    row.low = row.high = value;
    if (p->row_count < PLAN_ROWS_MAX)
        p->row[p->row_count++] = row;
}

static const imk_triad *triad_of(const identify_plan *p, bool accel)
{
    return accel ? &p->model.accel : &p->model.gyro;
}

/* The terms that the model holds, those of the gyros first. */
static void list_rows(identify_plan *p)
{
    for (int accel = 0; accel < 2; accel++) {
        const imk_triad *triad = triad_of(p, accel);
        const imk_log_column column = {.quantity = accel ? IMK_QUANTITY_SPECIFIC_FORCE
                                                         : IMK_QUANTITY_ANGULAR_RATE,
                                       .unit = imk_unit_of(accel ? "m/s^2" : "rad/s")};
        for (int axis = 0; triad->present && axis < triad->axis_count; axis++) {
            const imk_expected_noise noise = imk_expected_noise_of(triad, axis);
            for (int term = 0; term < IMK_NOISE_TERMS; term++)
                if (noise.term[term] != 0) {
                    const imk_term_display display =
                        imk_channel_term(&column, (imk_noise_term)term);
                    plan_row row = {.accel = accel, .term = term, .unit = display.unit};
                    snprintf(row.key, sizeof row.key, "%s", display.key);
                    add_row(p, row, fabs(noise.term[term]));
                }
            for (int i = 0; i < noise.gauss_markov_count; i++) {
                plan_row row = {.accel = accel, .term = IMK_NOISE_TERMS + i};
                row.unit = imk_channel_term(&column, IMK_NOISE_BIAS_INSTABILITY).unit;
                snprintf(row.key, sizeof row.key, "gauss_markov[%d].sigma", i);
                add_row(p, row, noise.gauss_markov[i].sigma);
                row.time = true;
                row.unit = imk_unit_of("s");
                snprintf(row.key, sizeof row.key, "gauss_markov[%d].correlation_time", i);
                add_row(p, row, noise.gauss_markov[i].correlation_time);
            }
        }
    }
}

static const imk_bound *bound_of(const imk_identification_bounds *bounds, const plan_row *row)
{
    const int i = row->term - IMK_NOISE_TERMS;
    return i < 0       ? &bounds->term[row->term]
           : row->time ? &bounds->correlation_time[i]
                       : &bounds->sigma[i];
}

bool identify_plan_cells(identify_plan *p, double duration, plan_cell *cell)
{
    bool any = false;
    for (size_t r = 0; r < p->row_count; r++)
        cell[r] = (plan_cell){0, 1};
    for (int accel = 0; accel < 2; accel++) {
        const imk_triad *triad = triad_of(p, accel);
        for (int axis = 0; triad->present && axis < triad->axis_count; axis++) {
            const imk_expected_noise noise = imk_expected_noise_of(triad, axis);
            imk_identification_bounds bounds;
            if (imk_identify_bounds(&noise, &p->settings, duration, &bounds, p->workspace,
                                    imk_bounds_workspace_size(), NULL) != IMK_OK)
                continue;
            any = true;
            for (size_t r = 0; r < p->row_count; r++) {
                const imk_bound *bound = bound_of(&bounds, &p->row[r]);
                if (p->row[r].accel != accel || bound->value == 0)
                    continue;
                cell[r].relative = fmax(cell[r].relative, bound->relative);
                cell[r].detection = fmin(cell[r].detection, bound->detection);
            }
        }
    }
    return any;
}

/* The axis that needs the longest decides. */
static int grant(identify_plan *p, plan_wish *wish)
{
    const plan_row *row = &p->row[wish->row];
    const imk_triad *triad = triad_of(p, row->accel);
    const imk_identify_wish asked = {row->term, row->time, wish->relative, wish->detection};
    for (int axis = 0; axis < triad->axis_count; axis++) {
        const imk_expected_noise noise = imk_expected_noise_of(triad, axis);
        const int i = row->term - IMK_NOISE_TERMS;
        if (i < 0 ? noise.term[row->term] == 0 : i >= noise.gauss_markov_count)
            continue;
        double duration = HUGE_VAL;
        imk_error error;
        const imk_status status =
            imk_identify_duration(&noise, &p->settings, &asked, &duration, p->workspace,
                                  imk_bounds_workspace_size(), &error);
        if (status != IMK_OK && status != IMK_ERROR_NO_CONVERGENCE)
            return command_error(&error, p->request->model);
        wish->duration = fmax(wish->duration, duration);
    }
    return -1;
}

/* The bounds are known of so many samples (identify_plan.h). */
static const double fewest_samples = 256, most_samples = 1e12;

/* Is there a statement about the planned record, or about one of those that are always shown? What
 * is wanted finds its own length. */
static int check_length(const identify_plan_request *request)
{
    const double day = 86400, planned = request->duration > 0 ? request->duration : day;
    const double samples = planned * request->rate;
    const bool finds_length = request->want && !(request->duration > 0);
    if (finds_length || (samples >= fewest_samples && samples <= most_samples))
        return -1;
    return command_misused("--plan: a record of %g s at %g Hz has not the 256 to 1e12 samples that "
                           "are due; %s",
                           planned, request->rate,
                           request->duration > 0 ? "change --duration or --rate"
                                                 : "add another --duration");
}

static int set_up(identify_plan *p)
{
    const identify_plan_request *request = p->request;
    if (!(request->rate > 0))
        return command_misused(
            "--plan: the sample rate of the record is due, such as --rate 100Hz");
    int code = check_length(request);
    if (code < 0)
        code = command_model(request->model, &p->model, NULL);
    if (code >= 0)
        return code;
    p->settings = imk_bounds_default();
    p->settings.dt = 1 / request->rate;
    p->settings.significance = request->significance > 0 ? request->significance : 0.01;
    list_rows(p);
    if (p->row_count == 0)
        return command_failed(
            "%s states no noise, from which to tell how long to record: a catalogue "
            "entry near it does (imukit devices), or imukit identify finds it in a "
            "first log at rest",
            request->model);
    code = identify_wish_parse(p);
    p->workspace = malloc(imk_bounds_workspace_size());
    if (code < 0 && !p->workspace)
        code = command_failed("memory is exhausted");
    for (size_t k = 0; code < 0 && k < p->wish_count; k++)
        code = grant(p, &p->wish[k]);
    p->duration = request->duration;
    for (size_t k = 0; k < p->wish_count && !(request->duration > 0); k++)
        if (isfinite(p->wish[k].duration))
            p->duration = fmax(p->duration, p->wish[k].duration);
    return code;
}

static bool all_granted(const identify_plan *p)
{
    for (size_t k = 0; k < p->wish_count; k++)
        if (!(p->wish[k].duration <= p->duration))
            return false;
    return true;
}

int identify_plan_run(const identify_plan_request *request)
{
    identify_plan *p = calloc(1, sizeof *p);
    if (!p)
        return command_failed("memory is exhausted");
    p->request = request;
    int code = set_up(p);
    if (code < 0) {
        code = request->strict && !all_granted(p) ? EXIT_FAILED : EXIT_DONE;
        if (request->json)
            code = identify_plan_json(p, code);
        else
            identify_plan_print(p);
        const int drawn = request->plot ? identify_plan_draw(p) : -1;
        code = drawn < 0 ? code : drawn;
    }
    free(p->workspace);
    free(p);
    return code;
}
