/* SPDX-License-Identifier: Apache-2.0 */
/* One unit from its parts: taken apart and joined, every model is what it was; three instruments of
 * a kind are what imk_model_three_axes() makes of one; what contradicts is refused by name. */
#include "check.h"
#include "io/random_model.h"

#include "imukit/model_join.h"
#include "imukit/model_unstated.h"
#include "imukit/physics.h"

#include <stdlib.h>

static bool has_note(const imk_joined *joined, imk_join_note_kind kind)
{
    for (size_t i = 0; i < joined->note_count; i++)
        if (joined->note[i].kind == kind)
            return true;
    return false;
}

static imk_model only(const imk_model *model, int kind)
{
    imk_model part = *model;
    for (int k = 0; k < IMK_KINDS; k++)
        if (k != kind)
            imk_model_triad_to_set(&part, k)->present = false;
    if (kind != IMK_GYRO)
        memset(&part.timing, 0, sizeof part.timing);
    return part;
}

/* Correlation of two parameters; NaN when one is not there. */
static double correlation_of(const imk_model *model, imk_model_parameter a, imk_model_parameter b)
{
    const imk_correlation *c = &model->correlation;
    for (int i = 1; i < c->count; i++)
        for (int j = 0; j < i; j++) {
            const bool same = memcmp(&c->parameter[i], &a, sizeof a) == 0 &&
                              memcmp(&c->parameter[j], &b, sizeof b) == 0;
            const bool reverse = memcmp(&c->parameter[i], &b, sizeof b) == 0 &&
                                 memcmp(&c->parameter[j], &a, sizeof a) == 0;
            if (same || reverse)
                return (double)c->value[i * (i - 1) / 2 + j];
        }
    return (double)NAN;
}

/* Gyros of one file, accelerometers of another: all of both is there, evidence and correlations
 * within each kind included. */
static void sensors_come_as_they_are(void **state)
{
    (void)state;
    uint64_t random = 3;
    int tried = 0;
    while (tried < 40) {
        static imk_model model, gyro, accel, unit;
        imk_joined joined;
        imk_error error;
        model = random_model(&random, 2, true);
        if (!model.gyro.present || !model.accel.present)
            continue;
        tried++;
        gyro = only(&model, IMK_GYRO);
        accel = only(&model, IMK_ACCEL);
        const imk_join_part part[] = {{&accel, "a", IMK_JOIN_WHOLE}, {&gyro, "g", IMK_JOIN_WHOLE}};
        CHECK_OK(imk_model_join(2, part, NULL, &unit, &joined, &error));
        assert_true(imk_model_equal(&unit, &model));
        assert_memory_equal(&unit.gyro, &model.gyro, sizeof unit.gyro);
        assert_memory_equal(&unit.accel_evidence, &model.accel_evidence,
                            sizeof unit.accel_evidence);
        assert_int_equal(joined.from[IMK_GYRO][2], 1);
        assert_int_equal(joined.from[IMK_ACCEL][0], 0);
        assert_int_equal(joined.from[IMK_MAG][0], -1);
        assert_true(has_note(&joined, IMK_JOIN_PARALLEL));
        const imk_correlation *c = &model.correlation;
        assert_int_equal(unit.correlation.count, c->count);
        for (int i = 1; i < c->count; i++)
            for (int j = 0; j < i; j++) {
                const bool kept = c->parameter[i].sensor == c->parameter[j].sensor;
                CHECK_CLOSE(correlation_of(&unit, c->parameter[i], c->parameter[j]),
                            kept ? (double)c->value[i * (i - 1) / 2 + j] : 0, 0);
            }
    }
}

/* Each axis of a triad from a copy of it: the same triad, with its evidence and correlations. */
static void axes_come_as_they_are(void **state)
{
    (void)state;
    uint64_t random = 8;
    for (int tried = 0; tried < 40; tried++) {
        static imk_model model, unit;
        imk_joined joined;
        imk_error error;
        model = random_model(&random, 2, false);
        const imk_join_part part[] = {{&model, "a", 0}, {&model, "b", 1}, {&model, "c", 2}};
        CHECK_OK(imk_model_join(3, part, NULL, &unit, &joined, &error));
        assert_true(imk_model_equal(&unit, &model));
        for (int kind = 0; kind < 2; kind++)
            for (size_t i = 0; i < imki_triad_field_count; i++)
                if (imk_model_triad(&model, kind)->present)
                    assert_true(imki_field_equal(&imki_triad_fields[i],
                                                 imk_model_triad(&unit, kind),
                                                 imk_model_triad(&model, kind), true));
        assert_int_equal(unit.gyro_evidence.interval_count, model.gyro_evidence.interval_count);
        assert_string_equal(unit.gyro_evidence.source, model.gyro_evidence.source);
        assert_false(has_note(&joined, IMK_JOIN_AXIS_UNSTATED));
        assert_false(has_note(&joined, IMK_JOIN_INTERVAL_LOST));
        const imk_correlation *c = &model.correlation;
        assert_int_equal(unit.correlation.count, c->count);
        for (int i = 1; i < c->count; i++)
            for (int j = 0; j < i; j++) {
                const bool kept = c->parameter[i].axis == c->parameter[j].axis;
                CHECK_CLOSE(correlation_of(&unit, c->parameter[i], c->parameter[j]),
                            kept ? (double)c->value[i * (i - 1) / 2 + j] : 0, 0);
            }
    }
}

/* Case axes of a sensor turn with it, as imk_model_three_axes() does it. */
static void instruments_become_a_triad(void **state)
{
    (void)state;
    for (size_t i = 0; i < imk_instrument_count(); i++) {
        static imk_model one, three, unit;
        imk_error error;
        const imk_instrument *instrument = imk_instrument_get(i);
        void *design = malloc(instrument->design_size);
        assert_non_null(design);
        instrument->set_default(design);
        imk_instrument_reduce(instrument, design, &one);
        free(design);
        three = one;
        imk_model_three_axes(&three);
        const imk_join_part part[] = {{&one, "x", 0}, {&one, "y", 1}, {&one, "z", 2}};
        CHECK_OK(imk_model_join(3, part, NULL, &unit, NULL, &error));
        assert_true(imk_model_equal(&unit, &three));
    }
}

/* A sensor that is along z already is not turned when it becomes the z axis. */
static void sensors_turn_to_their_axis(void **state)
{
    (void)state;
    static imk_model z, unit;
    imk_error error;
    const imk_model_parameter misaligned = {IMK_GYRO, IMK_MODEL_MISALIGNMENT, 0, 0};
    imk_model_default(&z);
    z.accel.present = false;
    z.gyro.axis_count = 1;
    memset(z.gyro.direction, 0, sizeof z.gyro.direction);
    z.gyro.direction[0][2] = 1;
    z.gyro.misalignment.value[0][0] = 0.01; /* towards body x */
    z.gyro.misalignment.sigma[0][0] = 1e-4;
    z.correlation.count = 2;
    z.correlation.parameter[0] = misaligned;
    z.correlation.parameter[1] = (imk_model_parameter){IMK_GYRO, IMK_MODEL_BIAS, 0, 0};
    z.correlation.value[0] = 0.5F;
    const imk_join_part part[] = {{&z, "x", 0}, {&z, "y", 1}, {&z, "z", 2}};
    CHECK_OK(imk_model_join(3, part, NULL, &unit, NULL, &error));
    /* What is towards the next body axis stays so: x follows z, y follows x, z follows y. */
    CHECK_CLOSE(unit.gyro.misalignment.value[2][0], 0.01, 0);
    CHECK_CLOSE(unit.gyro.misalignment.value[0][1], 0.01, 0);
    CHECK_CLOSE(unit.gyro.misalignment.value[1][2], 0.01, 0);
    CHECK_CLOSE(unit.gyro.misalignment.sigma[1][2], 1e-4, 0);
    assert_int_equal(unit.correlation.count, 6);
    CHECK_CLOSE(correlation_of(&unit, (imk_model_parameter){IMK_GYRO, IMK_MODEL_MISALIGNMENT, 1, 2},
                               (imk_model_parameter){IMK_GYRO, IMK_MODEL_BIAS, 1, 0}),
                0.5, 0);
    CHECK_CLOSE(correlation_of(&unit, (imk_model_parameter){IMK_GYRO, IMK_MODEL_MISALIGNMENT, 1, 2},
                               (imk_model_parameter){IMK_GYRO, IMK_MODEL_BIAS, 0, 0}),
                0, 0);
}

/* ---- what is told, and refused --------------------------------------------------------------- */

static void differences_of_axes_are_told(void **state)
{
    (void)state;
    static imk_model a, b, unit;
    imk_joined joined;
    imk_error error;
    imk_model_default(&a);
    a.accel.present = false;
    a.gyro.noise.white.value[0] = a.gyro.noise.white.value[1] = a.gyro.noise.white.value[2] = 1e-5;
    a.gyro.bias.temperature =
        (imk_temperature_polynomial){.order = 1, .reference = 293, .minimum = 253, .maximum = 333};
    a.gyro.bias.temperature.coefficient[0].value[0] = 1e-7;
    strcpy(a.gyro_evidence.source, "a log");
    strcpy(a.gyro_evidence.frame, "one");
    a.gyro_evidence.interval_count = 1;
    strcpy(a.gyro_evidence.interval[0].key, "noise.angle_random_walk");
    strcpy(a.residual_of, "first");
    b = a;
    for (int i = 0; i < 3; i++)
        b.gyro.noise.white.value[i] = 0;
    b.gyro_evidence.interval_count = 0;
    b.gyro.bias.temperature.order = 2;
    b.gyro.bias.temperature.minimum = 263;
    b.gyro.bias.temperature.coefficient[1].value[1] = 1e-9;
    strcpy(b.gyro_evidence.source, "another");
    strcpy(b.gyro_evidence.frame, "two");
    strcpy(b.residual_of, "second");
    const imk_join_part part[] = {{&a, "a", 0}, {&b, "b", 1}, {&a, "c", 2}};
    CHECK_OK(imk_model_join(3, part, NULL, &unit, &joined, &error));
    static const imk_join_note_kind kinds[] = {IMK_JOIN_AXIS_UNSTATED, IMK_JOIN_INTERVAL_LOST,
                                               IMK_JOIN_RANGE_NARROWED, IMK_JOIN_FRAME_LOST,
                                               IMK_JOIN_RESIDUAL_LOST};
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        assert_true(has_note(&joined, kinds[i]));
    assert_false(has_note(&joined, IMK_JOIN_PARALLEL));
    assert_int_equal(unit.gyro.bias.temperature.order, 2);
    CHECK_CLOSE(unit.gyro.bias.temperature.minimum, 263, 0);
    CHECK_CLOSE(unit.gyro.bias.temperature.coefficient[1].value[1], 1e-9, 0);
    CHECK_CLOSE(unit.gyro.bias.temperature.coefficient[0].value[0], 1e-7, 0);
    assert_string_equal(unit.gyro_evidence.source, "x: a log; y: another; z: a log");
    assert_string_equal(unit.gyro_evidence.frame, "");
    assert_string_equal(unit.residual_of, "");
    for (size_t i = 0; i < joined.note_count; i++)
        if (joined.note[i].kind == IMK_JOIN_AXIS_UNSTATED) {
            assert_int_equal(joined.note[i].part, 1);
            assert_string_equal(joined.note[i].key, "noise.angle_random_walk");
        }
}

/* Too many correlated parameters for one model: those of the second part are told. */
static void too_many_correlations_are_told(void **state)
{
    (void)state;
    static imk_model model[2], unit;
    imk_joined joined;
    for (int m = 0; m < 2; m++) {
        imk_model_default(&model[m]);
        imk_model_triad_to_set(&model[m], 1 - m)->present = false;
    }
    for (int m = 0; m < 2; m++) {
        int *count = &model[m].correlation.count;
        for (int term = 0; term < IMK_MODEL_TERMS; term++)
            for (int axis = 0; axis < 3; axis++)
                for (int e = 0; e < imk_model_term_elements(m, term) && *count < 36; e++) {
                    const imk_model_parameter p = {(uint8_t)m, (uint8_t)term, (uint8_t)axis,
                                                   (uint8_t)e};
                    if (imk_model_parameter_at(&model[m], p, NULL))
                        model[m].correlation.parameter[(*count)++] = p;
                }
        assert_int_equal(*count, 36);
    }
    const imk_join_part part[] = {{&model[0], "g", IMK_JOIN_WHOLE},
                                  {&model[1], "a", IMK_JOIN_WHOLE}};
    CHECK_OK(imk_model_join(2, part, NULL, &unit, &joined, NULL));
    assert_true(has_note(&joined, IMK_JOIN_CORRELATION_LOST));
    assert_int_equal(unit.correlation.count, 36);
}

static void assert_refused(size_t count, const imk_join_part *part, imk_status due,
                           const char *field, const char *found)
{
    static imk_model unit;
    imk_error error;
    CHECK_STATUS(imk_model_join(count, part, NULL, &unit, NULL, &error), due);
    assert_string_equal(error.field, field);
    if (!strstr(error.found, found))
        fail_msg("%s", error.found);
}

static void contradictions_are_refused(void **state)
{
    (void)state;
    static imk_model both, gyro, single, skewed, warm;
    imk_model_default(&both);
    gyro = only(&both, IMK_GYRO);
    single = gyro;
    single.gyro.axis_count = 1;
    skewed = single;
    skewed.gyro.direction[0][0] = 0.6;
    skewed.gyro.direction[0][1] = 0.8;
    warm = single;
    warm.gyro.bias.warm_up_amplitude.value[0] = 1e-6;
    warm.gyro.bias.warm_up_time.value = 100;
    const imk_join_part twice[] = {{&both, "a", IMK_JOIN_WHOLE}, {&gyro, "b", IMK_JOIN_WHOLE}};
    assert_refused(2, twice, IMK_ERROR_CONFLICT, "gyro", "both a and b");
    const imk_join_part two[] = {{&single, "a", 0}, {&single, "b", 2}};
    assert_refused(2, two, IMK_ERROR_KEY_MISSING, "gyro", "b");
    const imk_join_part same[] = {{&single, "a", 0}, {&single, "b", 0}};
    assert_refused(2, same, IMK_ERROR_CONFLICT, "gyro", "both a and b");
    const imk_join_part slanted[] = {{&single, "a", 0}, {&skewed, "b", 1}, {&single, "c", 2}};
    assert_refused(3, slanted, IMK_ERROR_UNSUPPORTED, "gyro", "b");
    static imk_model warmer;
    warmer = warm;
    warmer.gyro.bias.warm_up_time.value = 200;
    const imk_join_part warming[] = {{&warm, "a", 0}, {&single, "b", 1}, {&warmer, "c", 2}};
    assert_refused(3, warming, IMK_ERROR_CONFLICT, "bias.warm_up.time", "both a and c");
    static imk_model here, there;
    here = gyro;
    here.timing.jitter.value = 1e-6;
    there = only(&both, IMK_ACCEL);
    there.timing.jitter.value = 2e-6;
    const imk_join_part clocks[] = {{&here, "a", IMK_JOIN_WHOLE}, {&there, "b", IMK_JOIN_WHOLE}};
    assert_refused(2, clocks, IMK_ERROR_CONFLICT, "timing", "both a and b");
    assert_refused(0, NULL, IMK_ERROR_EMPTY, "part", "");

    static imk_model unit;
    imk_joined joined;
    imk_join_settings settings = imk_join_default();
    settings.timing_from = 1;
    CHECK_OK(imk_model_join(2, clocks, &settings, &unit, &joined, NULL));
    CHECK_CLOSE(unit.timing.jitter.value, 2e-6, 0);
    settings = imk_join_default();
    settings.from[IMK_GYRO] = 1;
    CHECK_OK(imk_model_join(2, twice, &settings, &unit, &joined, NULL));
    assert_int_equal(joined.from[IMK_GYRO][0], 1);
    settings.from[IMK_GYRO] = 2;
    CHECK_STATUS(imk_model_join(2, twice, &settings, &unit, NULL, NULL), IMK_ERROR_RANGE);
    settings.from[IMK_GYRO] = 0;
    settings.from[IMK_MAG] = 0;
    CHECK_STATUS(imk_model_join(2, twice, &settings, &unit, NULL, NULL), IMK_ERROR_KEY_MISSING);
    settings.cookie = 0;
    CHECK_STATUS(imk_model_join(2, twice, &settings, &unit, NULL, NULL), IMK_ERROR_UNINITIALISED);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sensors_come_as_they_are),
        cmocka_unit_test(axes_come_as_they_are),
        cmocka_unit_test(instruments_become_a_triad),
        cmocka_unit_test(sensors_turn_to_their_axis),
        cmocka_unit_test(differences_of_axes_are_told),
        cmocka_unit_test(too_many_correlations_are_told),
        cmocka_unit_test(contradictions_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
