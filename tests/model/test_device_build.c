/* SPDX-License-Identifier: Apache-2.0 */
/* Size, mass and supply in the catalogue. */
#include "check.h"

#include "imukit/model.h"

#include <string.h>

/* Every row belongs to an entry of the catalogue, and is within what such parts have. */
static void builds_are_sane(void **state)
{
    (void)state;
    size_t found = 0;
    for (size_t i = 0; i < imk_device_count(); i++) {
        const imk_device *device = imk_device_get(i);
        const imk_device_build *b = imk_device_build_find(device->name);
        if (!b)
            continue;
        found++;
        assert_string_equal(b->device, device->name);
        assert_false(device->is_preset);
        assert_true(b->size[0] > 0 || b->mass > 0 || b->power > 0 || b->current > 0);
        for (int k = 0; k < 3; k++) {
            assert_int_equal(b->size[k] > 0, b->size[0] > 0);
            assert_true(b->size[k] >= 0 && b->size[k] < 0.3);
        }
        assert_true(b->mass >= 0 && b->mass < 20);
        assert_true(b->power >= 0 && b->power < 50 && b->current >= 0 && b->current < 10);
        assert_true(b->power <= 0 || b->current <= 0);
        assert_true(!b->is_limit || b->power > 0 || b->current > 0);
        assert_true(strlen(b->source) > 10);
    }
    assert_int_equal(found, 20); /* the rows of device_build.c: no name is misspelled */
    assert_null(imk_device_build_find("strategic"));
    assert_null(imk_device_build_find("HG9900"));
    assert_null(imk_device_build_find(""));
    assert_null(imk_device_build_find(NULL));
}

/* TS1524 rev. 24: 38.6 x 44.8 x 21.5 mm. UM001: 24 x 22 x 3 mm, below 105 mW. DS12140: 0.55 mA. */
static void figures_are_those_of_the_sources(void **state)
{
    (void)state;
    const imk_device_build *b = imk_device_build_find("stim 300");
    assert_non_null(b);
    CHECK_RELATIVE(b->size[0], 38.6e-3, 1e-14);
    CHECK_RELATIVE(b->size[1], 44.8e-3, 1e-14);
    CHECK_RELATIVE(b->size[2], 21.5e-3, 1e-14);
    b = imk_device_build_find("VN-100");
    CHECK_RELATIVE(b->power, 0.105, 1e-14);
    assert_true(b->is_limit);
    b = imk_device_build_find("LSM6DSO");
    CHECK_RELATIVE(b->current, 0.55e-3, 1e-14);
    assert_true(b->power == 0 && b->mass == 0 && !b->is_limit);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(builds_are_sane),
        cmocka_unit_test(figures_are_those_of_the_sources),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
