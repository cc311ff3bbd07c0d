/* SPDX-License-Identifier: Apache-2.0 */
/* The table of fields is consistent with itself: every unit in it can be read, has the dimension
 * of its SI unit, and the SI units have scale 1, so that any double can be written in them. */
#include "check.h"

#include "imukit/units.h"
#include "model/distort_internal.h"
#include "model/model_schema_internal.h"

#include <string.h>

static void check_unit(const char *text, const char *si, const char *path)
{
    imk_unit unit = imk_unit_of(text), base = imk_unit_of(si);
    if (unit.scale == 0 || base.scale != 1 || base.offset != 0 ||
        !imk_dimension_equal(unit.dimension, base.dimension))
        fail_msg("%s: \"%s\" against \"%s\"", path, text, si);
    assert_false(base.per_root_hertz);
}

static void check_field(const imki_field *field)
{
    for (int kind = 0; kind < 2; kind++) {
        if (!field->path[kind] || !field->unit[kind])
            continue;
        check_unit(field->unit[kind], field->si[kind], field->path[kind]);
        if (field->density[kind]) {
            check_unit(field->density[kind], field->si[kind], field->path[kind]);
            assert_true(imk_unit_of(field->density[kind]).per_root_hertz);
        }
        if (field->shape == IMKI_POLYNOMIAL)
            for (int order = 1; order <= IMK_TEMPERATURE_ORDER_MAX; order++)
                check_unit(imki_polynomial_unit(field, kind, order),
                           imki_polynomial_si(field, kind, order), field->path[kind]);
        assert_true(field->minimum < field->maximum);
    }
}

static void units_are_consistent(void **state)
{
    (void)state;
    for (size_t i = 0; i < imki_triad_field_count; i++) {
        const imki_field *field = &imki_triad_fields[i];
        check_field(field);
        if (field->shape == IMKI_LIST) {
            imki_list list = imki_list_of(field);
            for (size_t j = 0; j < list.field_count; j++)
                check_field(&list.field[j]);
        }
    }
    for (size_t i = 0; i < imki_timing_field_count; i++)
        check_field(&imki_timing_fields[i]);
}

static void paths_are_unique_and_found(void **state)
{
    (void)state;
    for (int kind = 0; kind < 2; kind++)
        for (size_t i = 0; i < imki_triad_field_count; i++) {
            const char *path = imki_triad_fields[i].path[kind];
            const imki_field *list;
            if (path)
                assert_ptr_equal(imki_field_find(path, kind, &list), &imki_triad_fields[i]);
        }
    const imki_field *list;
    const imki_field *field = imki_field_find("noise.resonance.q", IMK_ACCEL, &list);
    assert_non_null(field);
    assert_string_equal(list->path[IMK_ACCEL], "noise.resonance");
    assert_null(imki_field_find("noise.resonance.", IMK_ACCEL, &list));
    assert_null(imki_field_find("noise", IMK_GYRO, &list));
    assert_null(imki_field_find("g_sensitivity", IMK_ACCEL, &list));
}

/* A term has a field and draws of its own; a power has a term of that form, and exponents that an
 * axis has a place for, of its own. */
static void terms_are_rows(void **state)
{
    (void)state;
    unsigned draws = 1u << 4 | 1u << 18 | 1u << 19, powers = 0; /* 4, 18, 19: drift_residual.c */
    size_t of_form = 0;
    for (int term = 0; term < IMKI_TERMS; term++) {
        assert_int_equal(imki_field_term(imki_term_field(term)), term);
        assert_false(draws >> imki_terms[term].draw & 1u);
        draws |= 1u << imki_terms[term].draw;
        of_form += imki_terms[term].form == IMKI_FORM_POWER;
    }
    assert_int_equal(of_form, imki_input_power_count);
    assert_true(imki_input_power_count <= IMKI_POWERS_MAX);
    for (size_t k = 0; k < imki_input_power_count; k++) {
        const imki_power *power = &imki_input_powers[k];
        const size_t place = imki_power_place(power);
        assert_int_equal(imki_terms[power->term].form, IMKI_FORM_POWER);
        assert_true(power->q <= 1 && place < IMK_POWERS);
        assert_false(powers >> (power->q * IMK_POWERS + place) & 1u);
        powers |= 1u << (power->q * IMK_POWERS + place);
    }
}

/* sqrt(2 ln 2/pi) = 0.66428247026796001914… by 40-digit decimal arithmetic. */
static void allan_floor_is_exact(void **state)
{
    (void)state;
    CHECK_CLOSE(IMKI_ALLAN_FLOOR, 0.66428247026796001914, 0);
    CHECK_RELATIVE(IMKI_ALLAN_FLOOR * IMKI_ALLAN_FLOOR, 2 * log(2) / acos(-1), 4e-16);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(units_are_consistent),
        cmocka_unit_test(paths_are_unique_and_found),
        cmocka_unit_test(terms_are_rows),
        cmocka_unit_test(allan_floor_is_exact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
