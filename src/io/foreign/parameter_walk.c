/* SPDX-License-Identifier: Apache-2.0 */
/* The random walk of the bias, which filters need and which a short log does not show: what stands
 * for it when the model has none.
 *
 * Its 95 % bound in the evidence, or bias instability B carried into it. The Allan variance of a
 * walk is K^2 tau/3, that of B is (2 ln 2/pi) B^2 at all tau; they are equal at T for
 * K^2 = (6 ln 2/pi) B^2/T. Elsewhere the Allan deviation of the walk is sqrt(tau/T) times that of
 * B. imk_filter_noise_of() makes it, and says how far all terms together are off. */
#include "parameter_internal.h"

#include "imukit/filter_noise.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A decade to each side of T: what is said about the replacement holds there. */
static const double decade = 10;

static const imk_evidence *evidence_of(const imk_model *model, int kind)
{
    return kind == IMK_GYRO ? &model->gyro_evidence : &model->accel_evidence;
}

/* Path of K below the sensor, which the key of its bound is too. */
static const char *walk_path(int kind)
{
    for (size_t i = 0; i < imki_triad_field_count; i++)
        if (imki_triad_fields[i].shape == IMKI_AXES &&
            imki_triad_fields[i].offset == offsetof(imk_triad, noise.random_walk))
            return imki_triad_fields[i].path[kind];
    return "";
}

/* The bound of K on an axis without; 0: there is none. */
static double bound_of(const imk_model *model, int kind, int axis)
{
    const imk_evidence *evidence = evidence_of(model, kind);
    if (imk_model_triad(model, kind)->noise.random_walk.value[axis] > 0)
        return 0;
    for (int i = 0; i < evidence->interval_count; i++) {
        const imk_interval *interval = &evidence->interval[i];
        if (strcmp(interval->key, walk_path(kind)) == 0 && interval->lower.value[axis] == 0)
            return interval->upper.value[axis];
    }
    return 0;
}

static bool has_bound(const imk_model *model, int kind)
{
    return bound_of(model, kind, 0) > 0 || bound_of(model, kind, 1) > 0 ||
           bound_of(model, kind, 2) > 0;
}

static const char *const walk_units[2] = {"rad/s^2/sqrt(Hz)", "m/s^3/sqrt(Hz)"};

static void use_bounds(imki_parameters *p, int kind, imk_triad *triad)
{
    char list[64] = "";
    for (int axis = 0; axis < 3; axis++) {
        const double bound = bound_of(p->source, kind, axis);
        char number[25];
        if (!(bound > 0))
            continue;
        triad->noise.random_walk.value[axis] = bound;
        imk_decimal_significant(bound, 3, number);
        const size_t length = strlen(list);
        snprintf(list + length, sizeof list - length, "%s%c %s", length > 0 ? ", " : "", 'x' + axis,
                 number);
    }
    imki_note(
        p, false,
        "%s: the random walk (K) was not found; the largest value that the data allow (95 %%) "
        "is taken for it: %s %s",
        imki_kind_names[kind], list, walk_units[kind]);
}

static void carry_instability(imki_parameters *p, int kind, imk_triad *triad)
{
    imk_filter_noise_settings settings = p->settings->filter;
    const double tau = p->settings->bias_instability_tau;
    double misfit = 0, misfit_tau = 0;
    settings.flicker = IMK_FILTER_FLICKER_RANDOM_WALK;
    settings.from = tau / decade;
    settings.to = tau * decade;
    double *k = triad->noise.random_walk.value, *b = triad->noise.bias_instability.value;
    for (int axis = 0; axis < 3; axis++) {
        imk_filter_noise noise;
        if (p->status == IMK_OK)
            p->status = imk_filter_noise_of(triad, axis, &settings, &noise, p->error);
        if (p->status != IMK_OK)
            return;
        for (int i = 0; i < noise.state_count; i++)
            if (noise.state[i].flicker_walk > 0)
                k[axis] = noise.state[i].driving;
        if (noise.misfit > misfit) {
            misfit = noise.misfit;
            misfit_tau = noise.misfit_tau;
        }
        b[axis] = 0;
    }
    imki_note(p, false,
              "%s: bias instability (B) is in the random walk, K^2 + (6 ln 2/pi) B^2/T, T = %g s; "
              "its Allan deviation is right at T, 0.32 times B's at T/10, 3.2 times at 10 T; all "
              "terms together are off by up to %.0f %% (at %.4g s)",
              imki_kind_names[kind], tau, 100 * misfit, misfit_tau);
}

/* What there is to do about a missing walk; false: nothing but to know it. */
static bool advise(const imki_parameters *p, const imk_triad *triad, int kind, char *text,
                   size_t size)
{
    const bool bounds = !p->settings->use_bounds && has_bound(p->source, kind);
    const bool tau =
        !(p->settings->bias_instability_tau > 0) && imki_any(triad->noise.bias_instability.value);
    const char *both = "add --use-bounds (the largest K that the data allow) or "
                       "--bias-instability-tau TIME (B as a walk, right at this averaging time)";
    const char *one = bounds ? "add --use-bounds (the largest K that the data allow)"
                             : "add --bias-instability-tau TIME with the averaging time at which B "
                               "as a walk is to be right";
    snprintf(text, size, "%s", bounds && tau ? both : one);
    return bounds || tau;
}

/* White noise without a walk is half of what a filter needs; without both the file is about other
 * things. */
static void require_walk(imki_parameters *p, imki_walk walk, const char *format, int kind,
                         const imk_triad *triad)
{
    char field[64], found[96], expected[160];
    const double *k = triad->noise.random_walk.value;
    const bool enough = walk == IMKI_WALK_OF_EACH ? k[0] > 0 && k[1] > 0 && k[2] > 0 : imki_any(k);
    if (!triad->present || walk < IMKI_WALK_WANTED || enough || !imki_any(triad->noise.white.value))
        return;
    snprintf(field, sizeof field, "%s.%s", imki_kind_names[kind], walk_path(kind));
    snprintf(found, sizeof found, "\"%s\" (K) is not in the model%s, and %s needs it",
             strrchr(field, '.') + 1, imki_any(k) ? " on all axes" : "", format);
    if (advise(p, triad, kind, expected, sizeof expected))
        imki_parameter_refuse(p, IMK_ERROR_KEY_MISSING, field, found, expected);
    else if (walk >= IMKI_WALK_NEEDED)
        imki_parameter_refuse(p, IMK_ERROR_KEY_MISSING, field, found,
                              "nothing in the model stands for it: add it to the model, or "
                              "identify it from a longer log");
    else
        imki_note(p, true, "%s: the model has no random walk (K) and nothing that stands for it",
                  imki_kind_names[kind]);
}

/* An option that changes nothing was meant for another model. */
static void note_unused(imki_parameters *p, bool bounds, bool carried)
{
    if (p->settings->use_bounds && !bounds)
        imki_note(p, false,
                  "--use-bounds changes nothing: the model has a random walk, or no bound "
                  "of one");
    if (p->settings->bias_instability_tau > 0 && !carried)
        imki_note(p, false,
                  "--bias-instability-tau changes nothing: the model has no bias "
                  "instability");
}

void imki_walk_supply(imki_parameters *p, imki_walk walk, const char *format, imk_model **changed)
{
    bool bounds = false, carried = false;
    if (p->settings->use_bounds || p->settings->bias_instability_tau > 0) {
        *changed = malloc(sizeof **changed);
        if (!*changed) {
            imki_parameter_refuse(p, IMK_ERROR_MEMORY, "", "", "");
            return;
        }
        **changed = *p->source;
    }
    for (int kind = 0; kind < 2; kind++) {
        imk_triad *triad = *changed ? imk_model_triad_to_set(*changed, kind) : NULL;
        if (triad && triad->present && p->settings->use_bounds && has_bound(p->source, kind)) {
            use_bounds(p, kind, triad);
            bounds = true;
        }
        if (triad && triad->present && p->settings->bias_instability_tau > 0 &&
            imki_any(triad->noise.bias_instability.value)) {
            carry_instability(p, kind, triad);
            carried = true;
        }
        require_walk(p, walk, format, kind, triad ? triad : p->origin[kind]);
    }
    p->remarks = p->notes ? p->notes->count : 0;
    note_unused(p, bounds, carried);
    if (*changed) {
        p->source = *changed;
        for (int kind = 0; kind < 2; kind++)
            p->origin[kind] = imk_model_triad(p->source, kind);
    }
}

/* Broken at blanks, so that lines stay short. */
void imki_text_remarks(imki_parameters *p, const char *prefix)
{
    enum { WIDTH = 96 };
    for (size_t i = 0; i < p->remarks; i++) {
        size_t column = 0;
        for (const char *at = p->notes->note[i].text; *at;) {
            const size_t length = strcspn(at, " ");
            const bool breaks = column > 0 && column + 1 + length > WIDTH;
            if (column == 0 || breaks) {
                imki_text_add(&p->out, "%s%s", breaks ? "\n" : "", prefix);
                column = strlen(prefix);
            } else {
                imki_text_add(&p->out, " ");
                column++;
            }
            imki_text_add(&p->out, "%.*s", (int)length, at);
            column += length;
            at += length + strspn(at + length, " ");
        }
        imki_text_add(&p->out, "\n");
    }
}
