/* SPDX-License-Identifier: Apache-2.0 */
/* Schematics at moments that a formula gives: a torque against the rate, unequal and warm beams, a
 * ball that has fallen. */
#include "check.h"

#include "imukit/physics.h"
#include "imukit/schematic.h"

#include <math.h>
#include <string.h>

enum { DESIGN_MAX = 1024 };
static _Alignas(64) unsigned char design[DESIGN_MAX];
static double signals[IMK_INSTRUMENT_SIGNALS_MAX], outputs[IMK_INSTRUMENT_OUTPUTS_MAX];

static const imk_schematic *begin(const char *name)
{
    const imk_schematic *s = imk_schematic_of(imk_instrument_find(name));
    assert_non_null(s);
    assert_true(s->instrument->design_size <= sizeof design);
    s->instrument->set_default(design);
    memset(signals, 0, sizeof signals);
    return s;
}

static void set(const imk_schematic *s, const char *name, double value)
{
    size_t i = 0;
    while (i < s->instrument->signal_count && strcmp(s->instrument->signals[i].name, name) != 0)
        i++;
    assert_true(i < s->instrument->signal_count);
    signals[i] = value;
}

static double part(const imk_schematic *s, const char *id)
{
    const imk_exposure exposure = imk_exposure_default();
    const imk_schematic_moment moment = {
        .exposure = &exposure, .outputs = outputs, .signals = signals};
    size_t i = 0;
    while (i < s->part_count && strcmp(s->parts[i].id, id) != 0)
        i++;
    assert_true(i < s->part_count);
    return imk_schematic_place(s, design, i, &moment);
}

static double quantity(const imk_schematic *s, const char *symbol, double temperature)
{
    imk_exposure exposure = imk_exposure_default();
    exposure.temperature = temperature;
    const imk_schematic_moment moment = {
        .exposure = &exposure, .outputs = outputs, .signals = signals};
    size_t i = 0;
    while (i < s->quantity_count && strcmp(imk_schematic_quantity_get(s, i).symbol, symbol) != 0)
        i++;
    assert_true(i < s->quantity_count);
    return imk_schematic_quantity_value(s, design, i, &moment);
}

/* The bar points to the side that the number states. */
static void test_torque(void **state)
{
    (void)state;
    const imk_schematic *s = begin("rate_integrating_gyro");
    set(s, "torquer_torque", 0.004);
    assert_true(quantity(s, "T", 293.15) < 0);
    assert_true(part(s, "torque") < 0);
}

static void test_ball(void **state)
{
    (void)state;
    const imk_schematic *s = begin("suspended_rotor");
    const imk_suspended_rotor *d = (const void *)design;
    set(s, "spin", d->spin_rate);
    CHECK_CLOSE(part(s, "spins"), 1, 1e-12);
    CHECK_CLOSE(part(s, "stands"), 0, 1e-12);
    CHECK_CLOSE(part(s, "fallen"), 0, 1e-12);
    CHECK_RELATIVE(quantity(s, "H", 293.15), imk_suspended_rotor_momentum(d), 1e-12);
    set(s, "spin", 0);
    set(s, "fallen", 1);
    CHECK_CLOSE(part(s, "spins"), 0, 1e-12);
    CHECK_CLOSE(part(s, "stands"), 1, 1e-12);
    CHECK_CLOSE(part(s, "fallen"), 1, 1e-12);
    CHECK_CLOSE(quantity(s, "H", 293.15), 0, 1e-12);
}

/* Without force each beam has its own frequency, whose square grows by c ΔT with temperature. */
static void test_beams(void **state)
{
    (void)state;
    const imk_schematic *s = begin("vibrating_beam");
    imk_vibrating_beam *d = (void *)design;
    const double warm = d->temperature + 40;
    const double c1 = d->frequency_temperature, c2 = c1 + d->temperature_mismatch;
    CHECK_RELATIVE(quantity(s, "f_1", d->temperature), quantity(s, "f_01", warm), 1e-12);
    CHECK_RELATIVE(quantity(s, "f_2", d->temperature), quantity(s, "f_02", warm), 1e-12);
    CHECK_RELATIVE(quantity(s, "f_2", warm), quantity(s, "f_02", warm) * sqrt(1 + 40 * c2), 1e-12);
    CHECK_RELATIVE(quantity(s, "f_1", warm), quantity(s, "f_01", warm) * sqrt(1 + 40 * c1), 1e-12);
    d->arrangement = IMK_BEAM_SINGLE;
    assert_true(isnan(quantity(s, "f_2", warm)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_torque),
        cmocka_unit_test(test_ball),
        cmocka_unit_test(test_beams),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
