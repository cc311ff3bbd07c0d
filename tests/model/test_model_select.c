/* SPDX-License-Identifier: Apache-2.0 */
/* Terms switched off by name: every name there is, alone and in groups, and names there are not. */
#include "check.h"
#include "io/random_model.h"

#include "imukit/model.h"

static imk_model full_model(void)
{
    uint64_t random = 5;
    imk_model model;
    /* A valid model with all fields of both sensors: what excludes the other is left to chance. */
    do
        model = random_model(&random, 1, false);
    while (!model.gyro.present || !model.accel.present || model.gyro.resolution.value[0] != 0 ||
           model.accel.resolution.value[0] != 0 || model.gyro.noise.quantization.value[0] == 0 ||
           model.accel.noise.quantization.value[0] == 0 ||
           model.gyro.noise.bias_instability.value[0] == 0 ||
           model.accel.noise.bias_instability.value[0] == 0);
    CHECK_OK(imk_model_validate(&model, NULL));
    return model;
}

static imk_model selected(bool keep, const char *name)
{
    imk_error error;
    imk_model model = full_model();
    CHECK_OK(imk_model_select(&model, keep, 1, &name, &error));
    CHECK_OK(imk_model_validate(&model, &error));
    return model;
}

static imk_model without_errors(void)
{
    imk_model model = full_model();
    CHECK_OK(imk_model_select(&model, true, 0, NULL, NULL));
    CHECK_OK(imk_model_validate(&model, NULL));
    return model;
}

static const imk_triad *triad_of(const imk_model *model, int kind)
{
    return kind == IMK_GYRO ? &model->gyro : &model->accel;
}

static bool is_no_error(const imki_field *field)
{
    return field->shape == IMKI_DIRECTION || field->shape == IMKI_PENDULOUS ||
           field->shape == IMKI_DENSITY || strcmp(field->path[1], "sensitivity") == 0 ||
           strcmp(field->path[1], "zero_offset") == 0;
}

/* Fields of both kinds that are as in the full model, not counting those nothing switches off;
 * where the full model has them. */
static int count_kept(const imk_model *model)
{
    const imk_model full = full_model();
    int kept = 0;
    for (int kind = 0; kind < 2; kind++)
        for (size_t i = 0; i < imki_triad_field_count; i++) {
            const imki_field *field = &imki_triad_fields[i];
            if (!field->path[kind] || (field->flags & IMKI_FLOOR))
                continue;
            const bool equal =
                imki_field_equal(field, triad_of(model, kind), triad_of(&full, kind), true);
            if (field->path[1] && is_no_error(field)) {
                assert_true(equal);
                continue;
            }
            const bool absent = imki_field_absent(field, triad_of(model, kind));
            assert_true(equal || absent); /* whole terms */
            kept += equal && !absent;
        }
    return kept;
}

static void nothing_kept_is_a_perfect_unit(void **state)
{
    (void)state;
    imk_model model = without_errors();
    assert_int_equal(count_kept(&model), 0);
    CHECK_CLOSE(model.timing.jitter.value, 0, 0);
    imk_model same = full_model(), full = same;
    CHECK_OK(imk_model_select(&same, false, 0, NULL, NULL));
    assert_true(imk_model_equal(&same, &full));
}

/* The full path of every key keeps that term alone, of that sensor alone. */
static void every_path_keeps_its_term(void **state)
{
    (void)state;
    const imk_model full = full_model();
    for (int kind = 0; kind < 2; kind++)
        for (size_t i = 0; i < imki_triad_field_count; i++) {
            const imki_field *field = &imki_triad_fields[i];
            char name[96];
            if (!field->path[kind])
                continue;
            snprintf(name, sizeof name, "%s.%s", kind ? "accel" : "gyro", field->path[kind]);
            const imk_model model = selected(true, name), rest = selected(false, name);
            /* a warm-up has two keys; a damping needs its bandwidth */
            const bool with_partner = strstr(name, "warm_up") || strstr(name, "damping");
            const bool is_there = !imki_field_absent(field, triad_of(&full, kind));
            const int due = field->path[1] && is_no_error(field) ? 0 : with_partner ? 2 : is_there;
            assert_int_equal(count_kept(&model), due);
            const bool takes_partner = strstr(name, "warm_up") || strstr(name, "bandwidth");
            assert_int_equal(count_kept(&rest), count_kept(&full) - (due == 0        ? 0
                                                                     : takes_partner ? 2
                                                                                     : 1));
        }
}

static void leaves_groups_and_sensors(void **state)
{
    (void)state;
    const imk_model full = full_model();
    imk_model model = selected(true, "angle_random_walk");
    assert_int_equal(count_kept(&model), 1);
    assert_memory_equal(&model.gyro.noise.white, &full.gyro.noise.white, sizeof(imk_axes));
    model = selected(true, "gauss_markov"); /* of both */
    assert_int_equal(count_kept(&model), 2);
    assert_int_equal(model.accel.noise.gauss_markov_count, full.accel.noise.gauss_markov_count);
    model = selected(true, "noise.gauss_markov.sigma"); /* a key of its terms */
    assert_int_equal(count_kept(&model), 2);
    model = selected(true, "allan_floor"); /* another way to state the instability */
    assert_int_equal(count_kept(&model), 2);
    model = selected(true, "warm_up");
    assert_int_equal(count_kept(&model), 4);
    model = selected(true, "accel.bias"); /* seven of its keys */
    assert_int_equal(count_kept(&model), 7);
    assert_memory_equal(&model.accel.bias, &full.accel.bias, sizeof model.accel.bias);
    model = selected(false, "noise");
    assert_int_equal(model.gyro.noise.gauss_markov_count + model.accel.noise.sinusoid_count, 0);
    CHECK_CLOSE(model.accel.noise.white.value[1], 0, 0);
    assert_int_equal(model.gyro.noise.density, full.gyro.noise.density);
    assert_memory_equal(&model.gyro.bias, &full.gyro.bias, sizeof model.gyro.bias);
    model = selected(false, "gyro");
    const imk_model perfect = without_errors();
    for (size_t i = 0; i < imki_triad_field_count; i++)
        assert_true(imki_field_equal(&imki_triad_fields[i], &model.gyro, &perfect.gyro, true));
    assert_memory_equal(&model.accel, &full.accel, sizeof model.accel);
}

static void timing_is_a_group(void **state)
{
    (void)state;
    const imk_model full = full_model();
    imk_model model = selected(true, "timing");
    assert_int_equal(count_kept(&model), 0);
    assert_memory_equal(&model.timing, &full.timing, sizeof model.timing);
    model = selected(false, "timing.jitter");
    CHECK_CLOSE(model.timing.jitter.value, 0, 0);
    CHECK_CLOSE(model.timing.skew.value, full.timing.skew.value, 0);
    model = selected(true, "rate_error");
    CHECK_CLOSE(model.timing.rate_error.value, full.timing.rate_error.value, 0);
    CHECK_CLOSE(model.timing.drops.value, 0, 0);
}

static void several_names(void **state)
{
    (void)state;
    const imk_model full = full_model();
    imk_model model = full;
    const char *const names[] = {"bias.fixed", "gyro.bias", "range"};
    CHECK_OK(imk_model_select(&model, true, 3, names, NULL));
    assert_int_equal(count_kept(&model), 7 + 1 + 2);
    /* What lies between the sensor and the name may be left out, as when the sensor is. */
    const char *const of_gyros[] = {"gyro.fixed", "gyro.angle_random_walk"};
    model = full;
    CHECK_OK(imk_model_select(&model, true, 2, of_gyros, NULL));
    assert_int_equal(count_kept(&model), 3);
    assert_memory_equal(&model.gyro.bias.fixed, &full.gyro.bias.fixed, sizeof full.gyro.bias.fixed);
}

/* Names nobody has: the nearest is offered, with the sensor; the model stays. */
static void unknown_names(void **state)
{
    (void)state;
    static const struct {
        const char *name, *nearest;
    } cases[] = {{"angle_random_wlak", "angle_random_walk"},
                 {"gyro.bias.fixd", "gyro.bias.fixed"},
                 {"nois", "noise"},
                 {"accel.lever_arms", "accel.lever_arm"},
                 {"timing.jiter", ""},
                 {"jiter", "jitter"},
                 {"warmup", "warm_up"},
                 {"bias.", ""},
                 {"ias.fixed", "bias.fixed"},
                 {"", ""}};
    const imk_model full = full_model();
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        imk_error error;
        imk_model model = full;
        const char *const names[] = {"noise", cases[i].name};
        CHECK_STATUS(imk_model_select(&model, false, 2, names, &error), IMK_ERROR_NAME_UNKNOWN);
        assert_string_equal(error.found, cases[i].name);
        if (cases[i].nearest[0])
            assert_string_equal(error.expected, cases[i].nearest);
        assert_true(error.expected[0] != '\0');
        assert_true(imk_model_equal(&model, &full));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_kept_is_a_perfect_unit),
        cmocka_unit_test(every_path_keeps_its_term),
        cmocka_unit_test(leaves_groups_and_sensors),
        cmocka_unit_test(timing_is_a_group),
        cmocka_unit_test(several_names),
        cmocka_unit_test(unknown_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
