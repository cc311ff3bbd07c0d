/* SPDX-License-Identifier: Apache-2.0 */
/* Random designs within the tables of their fields, in exposures of any size: a design is refused
 * with the field at fault, or its error model is valid, and derived quantities and readings are
 * finite. */
#include "instrument_run.h"

enum { DESIGNS = 120, STEPS = 24, CHANGES_MAX = 12 };

/* xorshift64*: the same designs everywhere */
static uint64_t seed;
static double uniform(void)
{
    seed ^= seed >> 12;
    seed ^= seed << 25;
    seed ^= seed >> 27;
    return (double)((seed * UINT64_C(0x2545F4914F6CDD1D)) >> 11) * 0x1p-53;
}

/* An end of the range, nothing, something near the default, anything on a logarithmic scale. */
static double any_number(const imk_design_field *f, double usual)
{
    const double kind = uniform(), low = f->minimum, high = f->maximum;
    if (kind < 0.1)
        return f->open ? low + 1e-12 * (high - low) : low;
    if (kind < 0.15)
        return high;
    if (kind < 0.25 && low <= 0.0)
        return f->open ? 1e-14 * high : 0.0;
    if (kind < 0.7 && usual != 0.0)
        return usual * exp(6.0 * (uniform() - 0.5));
    if (low > 0.0)
        return low * exp(uniform() * log(high / low));
    return high * exp(-30.0 * uniform()) * (low < 0.0 && uniform() < 0.5 ? -1.0 : 1.0);
}

static int choices_of(const char *choices)
{
    int count = 1;
    for (; *choices; choices++)
        count += *choices == '|';
    return count;
}

static void change_field(const imk_instrument *instrument, void *design)
{
    const size_t number = (size_t)(uniform() * (double)instrument->field_count);
    const imk_design_field *f = &instrument->fields[number];
    char *place = (char *)design + f->offset;
    double value = 0.0;
    int whole = 0;
    switch (f->kind) {
    case IMK_DESIGN_NUMBER:
        memcpy(&value, place, sizeof value);
        value = any_number(f, value);
        memcpy(place, &value, sizeof value);
        break;
    case IMK_DESIGN_COUNT:
        memcpy(&whole, place, sizeof whole);
        whole = (int)any_number(f, (double)whole);
        memcpy(place, &whole, sizeof whole);
        break;
    case IMK_DESIGN_CHOICE:
        whole = (int)(uniform() * choices_of(f->choices));
        memcpy(place, &whole, sizeof whole);
        break;
    case IMK_DESIGN_SWITCH:
        *(bool *)place = uniform() < 0.5;
        break;
    }
}

static imk_exposure any_exposure(double rate, double force)
{
    imk_exposure exposure = imk_exposure_default();
    for (int k = 0; k < 3; k++) {
        exposure.angular_rate[k] = rate * (2.0 * uniform() - 1.0);
        exposure.angular_acceleration[k] = 10.0 * rate * (2.0 * uniform() - 1.0);
        exposure.specific_force[k] = force * (2.0 * uniform() - 1.0);
    }
    exposure.temperature = uniform() < 0.3 ? 500.0 : uniform() < 0.3 ? 100.0 : 293.15;
    exposure.temperature_rate = uniform() - 0.5;
    return exposure;
}

/* A ball of a suspended rotor that its electrodes let fall is lost, and says so by a NaN. */
static bool may_fall(const imk_instrument *instrument, double force)
{
    return strcmp(instrument->name, "suspended_rotor") == 0 && force > 0.0;
}

static bool runs(const imk_instrument *instrument, const void *design, void *state)
{
    static const double rates[] = {1.0, 100.0, 1e4, 1e6, 3.7}, turns[] = {0.0, 1.0, 174.5},
                        forces[] = {0.0, 9.8, 9806.65};
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX], signals[IMK_INSTRUMENT_SIGNALS_MAX];
    imk_physics_settings settings = imk_physics_default();
    settings.level = uniform() < 0.4 ? IMK_LEVEL_SLOW : IMK_LEVEL_FULL;
    settings.noise = uniform() < 0.7;
    settings.rate = rates[(int)(5.0 * uniform())];
    const double rate = turns[(int)(3.0 * uniform())], force = forces[(int)(3.0 * uniform())];
    const double step = instrument->step_length(design, &settings);
    if (!(step > 0.0 && isfinite(step)))
        return false;
    if (settings.rate * step < 1e-3) /* at most a thousand internal steps */
        settings.rate = 1e-3 / step;
    if (imk_instrument_init(instrument, design, &settings, state, NULL) != IMK_OK)
        return true; /* refused: a rate or level that it does not have */
    for (int i = 0; i < STEPS; i++) {
        const imk_exposure exposure = any_exposure(rate, force);
        instrument->step(state, &exposure, outputs);
        instrument->observe(state, signals);
        if (may_fall(instrument, force))
            continue;
        for (size_t k = 0; k < instrument->output_count; k++)
            if (!isfinite(outputs[k]))
                return false;
        for (size_t k = 0; k < instrument->signal_count; k++)
            if (!isfinite(signals[k]))
                return false;
    }
    return true;
}

/* Every derived quantity is finite, or its row says why there is none; a quantity that all designs
 * have is found in each. */
static void check_derived(const imk_instrument *instrument, const void *design, int number)
{
    for (const imk_derived *d = instrument->derived; d->name; d++)
        if (!isfinite(imk_derived_value(d, design)) && !d->absent)
            fail_msg("%s, design %d: %s is not finite", instrument->name, number, d->name);
}

static void designs_are_refused_or_run(void **unused)
{
    (void)unused;
    imk_model *model = malloc(sizeof *model);
    assert_non_null(model);
    for (size_t n = 0; n < imk_instrument_count(); n++) {
        const imk_instrument *instrument = imk_instrument_get(n);
        void *design = malloc(instrument->design_size);
        void *state = aligned_alloc(64, (instrument->state_size + 63) / 64 * 64);
        int valid = 0;
        assert_true(design && state);
        for (int i = 0; i < DESIGNS; i++) {
            imk_error error = {0};
            seed = UINT64_C(0x9E3779B97F4A7C15) * (uint64_t)(1000 * n + (size_t)i + 1);
            instrument->set_default(design);
            for (int k = (int)(CHANGES_MAX * uniform() * uniform()); k >= 0; k--)
                change_field(instrument, design);
            if (imk_design_check(instrument, design, &error) != IMK_OK) {
                assert_true(error.field[0] != '\0' && error.status != IMK_OK);
                continue;
            }
            valid++;
            imk_instrument_reduce(instrument, design, model);
            if (imk_model_validate(model, &error) != IMK_OK)
                fail_msg("%s, design %d: error model with %s = %g", instrument->name, i,
                         error.field, error.value);
            check_derived(instrument, design, i);
            if (!runs(instrument, design, state))
                fail_msg("%s, design %d: a number that is not finite", instrument->name, i);
        }
        CHECK_BELOW(DESIGNS / 10, valid); /* the test is of designs, not of refusals */
        free(design);
        free(state);
    }
    free(model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(designs_are_refused_or_run)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
