/* SPDX-License-Identifier: Apache-2.0 */
/* What holds for every kind of instrument: its tables, its default design, refusals field by field,
 * reproducibility, and the class that its default reaches. */
#include "instrument_run.h"

#include "imukit/distort.h"
#include "imukit/units.h"

static const imk_instrument *get(size_t i)
{
    return imk_instrument_get(i);
}

static void *design_of(const imk_instrument *instrument)
{
    void *design = malloc(instrument->design_size);
    assert_non_null(design);
    instrument->set_default(design);
    return design;
}

static void names_are_found(void **state)
{
    (void)state;
    assert_true(imk_instrument_count() >= 12);
    assert_null(imk_instrument_get(imk_instrument_count()));
    assert_null(imk_instrument_find("sundial"));
    assert_null(imk_instrument_find(NULL));
    for (size_t i = 0; i < imk_instrument_count(); i++) {
        char loud[64];
        size_t n = 0;
        for (; get(i)->name[n]; n++)
            loud[n] = get(i)->name[n] == '_' ? ' ' : (char)(get(i)->name[n] - ('a' - 'A'));
        loud[n] = '\0';
        assert_ptr_equal(imk_instrument_find(get(i)->name), get(i));
        assert_ptr_equal(imk_instrument_find(loud), get(i));
    }
}

static bool unit_exists(const char *text)
{
    return text && (strcmp(text, "1") == 0 || imk_unit_of(text).scale > 0.0);
}

static void tables_are_complete(void **state)
{
    (void)state;
    for (size_t i = 0; i < imk_instrument_count(); i++) {
        const imk_instrument *k = get(i);
        assert_true(k->title[0] && k->source[0]);
        assert_in_range(k->output_count, 1, IMK_INSTRUMENT_OUTPUTS_MAX);
        assert_in_range(k->signal_count, 1, IMK_INSTRUMENT_SIGNALS_MAX);
        assert_in_range(k->view_count, 1, 16);
        assert_string_equal(k->outputs[0].si, k->sensor == IMK_GYRO ? "rad/s" : "m/s^2");
        for (size_t f = 0; f < k->field_count; f++) {
            const imk_design_field *field = &k->fields[f];
            const bool is_number = field->kind == IMK_DESIGN_NUMBER;
            if ((is_number && !unit_exists(field->unit)) || !field->help || !field->help[0] ||
                (field->kind == IMK_DESIGN_CHOICE) != (field->choices != NULL) ||
                !(field->offset < k->design_size)) {
                print_error("%s: %s [%s]\n", k->name, field->path, is_number ? field->unit : "");
                fail();
            }
            for (size_t other = 0; other < f; other++)
                assert_string_not_equal(field->path, k->fields[other].path);
        }
        for (size_t s = 0; s < k->signal_count; s++)
            assert_true(unit_exists(k->signals[s].si) && unit_exists(k->signals[s].unit));
        for (size_t s = 0; s < k->output_count; s++)
            assert_true(unit_exists(k->outputs[s].si) && unit_exists(k->outputs[s].unit));
        for (size_t v = 0; v < k->view_count; v++) {
            const imk_view *view = &k->views[v];
            assert_in_range(view->curve_count, 1, IMK_VIEW_CURVES_MAX);
            assert_true(view->x >= -1 && view->x < (int)k->signal_count);
            assert_true(view->duration > 0.0 && view->rate > 0.0 && view->settle >= 0.0);
            /* between enough points for a picture and what a file can hold */
            assert_true(view->duration * view->rate >= 20.0 && view->duration * view->rate <= 2e5);
            for (int c = 0; c < view->curve_count; c++)
                assert_in_range(view->y[c], 0, k->signal_count - 1);
        }
    }
}

/* The default is valid, and so is what it reduces to, for one axis and for three. */
static void defaults_are_valid(void **state)
{
    (void)state;
    imk_model *model = malloc(sizeof *model);
    assert_non_null(model);
    for (size_t i = 0; i < imk_instrument_count(); i++) {
        imk_error error = {0};
        void *design = design_of(get(i));
        if (imk_design_check(get(i), design, &error) != IMK_OK)
            print_error("%s: %s %s\n", get(i)->name, error.field, error.expected);
        assert_int_equal(error.status, IMK_OK);
        for (int axes = 1; axes <= 3; axes += 2) {
            imk_instrument_reduce(get(i), design, model);
            if (axes == 3)
                imk_model_three_axes(model);
            if (imk_model_validate(model, &error) != IMK_OK)
                print_error("%s: %s %s\n", get(i)->name, error.field, error.expected);
            assert_int_equal(error.status, IMK_OK);
            const imk_triad *triad = get(i)->sensor == IMK_GYRO ? &model->gyro : &model->accel;
            assert_int_equal(triad->axis_count, axes);
            assert_true(model->gyro.present != model->accel.present);
        }
        free(design);
    }
    free(model);
}

/* NaN, infinity and what lies outside its range are refused by name, in every field. */
static void every_field_is_checked(void **state)
{
    (void)state;
    for (size_t i = 0; i < imk_instrument_count(); i++)
        for (size_t f = 0; f < get(i)->field_count; f++) {
            const imk_design_field *field = &get(i)->fields[f];
            const double bad[] = {(double)NAN, (double)INFINITY,
                                  field->maximum + 1.0 + 0.1 * fabs(field->maximum),
                                  field->minimum - 1.0 - 0.1 * fabs(field->minimum)};
            for (int b = 0; b < 4; b++) {
                imk_error error = {0};
                char *design = design_of(get(i));
                const int word = 99;
                if (field->kind == IMK_DESIGN_NUMBER)
                    memcpy(design + field->offset, &bad[b], sizeof bad[b]);
                else if (field->kind == IMK_DESIGN_CHOICE)
                    memcpy(design + field->offset, &word, sizeof word);
                else {
                    free(design);
                    continue;
                }
                const imk_status status = imk_design_check(get(i), design, &error);
                const imk_status due = field->kind == IMK_DESIGN_NUMBER && b < 2
                                           ? IMK_ERROR_NOT_FINITE
                                           : IMK_ERROR_RANGE;
                if (status != due || strcmp(error.field, field->path) != 0) {
                    print_error("%s: %s = %g: %s %s\n", get(i)->name, field->path, bad[b],
                                imk_status_name(status), error.field);
                    fail();
                }
                free(design);
            }
        }
}

static void settings_are_checked(void **state)
{
    (void)state;
    for (size_t i = 0; i < imk_instrument_count(); i++) {
        const imk_instrument *k = get(i);
        void *design = design_of(k);
        void *memory = aligned_alloc(64, (k->state_size + 63) / 64 * 64);
        imk_error error = {0};
        imk_physics_settings settings = imk_physics_default();
        settings.rate = 0.0;
        CHECK_STATUS(imk_instrument_init(k, design, &settings, memory, &error), IMK_ERROR_RANGE);
        assert_string_equal(error.field, "rate");
        settings = imk_physics_default();
        settings.step = (double)NAN;
        CHECK_STATUS(imk_instrument_init(k, design, &settings, memory, &error),
                     IMK_ERROR_NOT_FINITE);
        settings = imk_physics_default();
        settings.cookie = 0;
        CHECK_STATUS(imk_instrument_init(k, design, &settings, memory, &error),
                     IMK_ERROR_UNINITIALISED);
        memset(design, 0, k->design_size);
        settings = imk_physics_default();
        CHECK_STATUS(imk_instrument_init(k, design, &settings, memory, &error),
                     IMK_ERROR_UNINITIALISED);
        free(memory);
        free(design);
    }
}

/* A step of a second in the full dynamics would show anything but the instrument. */
static void steps_that_would_lie_are_refused(void **state)
{
    (void)state;
    for (size_t i = 0; i < imk_instrument_count(); i++) {
        const imk_instrument *k = get(i);
        void *design = design_of(k);
        void *memory = aligned_alloc(64, (k->state_size + 63) / 64 * 64);
        imk_error error = {0};
        imk_physics_settings settings = imk_physics_default();
        settings.rate = 0.5;
        settings.step = 1.0;
        const imk_status status = imk_instrument_init(k, design, &settings, memory, &error);
        if (status != IMK_ERROR_RANGE || strcmp(error.field, "step") != 0 || !error.expected[0]) {
            print_error("%s: %s %s %s\n", k->name, imk_status_name(status), error.field,
                        error.expected);
            fail();
        }
        free(memory);
        free(design);
    }
}

/* The same seed gives the same bits; another seed, run, axis or occasion gives others; a copied
 * state goes on as the original does; without noise nothing depends on the seed. */
static void runs_repeat(void **state)
{
    (void)state;
    enum { COUNT = 16 };
    for (size_t i = 0; i < imk_instrument_count(); i++) {
        const imk_instrument *k = get(i);
        void *design = design_of(k);
        double first[COUNT], other[COUNT], outputs[IMK_INSTRUMENT_OUTPUTS_MAX];
        imk_exposure exposure = imk_exposure_default();
        exposure.angular_rate[0] = 0.02;
        exposure.specific_force[0] = 1.0;
        imk_physics_settings settings = imk_physics_default();
        settings.rate = 20.0;
        void *one = started(k, design, &settings);
        run(k, one, &exposure, COUNT, 0, first);
        for (int change = 0; change < 6; change++) {
            imk_physics_settings s = settings;
            s.seed += change == 1;
            s.run += change == 2;
            s.axis = change == 3;
            s.occasion = change == 4;
            void *two = started(k, design, &s);
            run(k, two, &exposure, COUNT, 0, other);
            const bool same = memcmp(first, other, sizeof first) == 0;
            if (same != (change == 0 || change == 5))
                print_error("%s, change %d\n", k->name, change);
            assert_int_equal(same, change == 0 || change == 5);
            free(two);
        }
        void *copy = aligned_alloc(64, (k->state_size + 63) / 64 * 64);
        memcpy(copy, one, k->state_size);
        run(k, one, &exposure, COUNT, 0, first);
        run(k, copy, &exposure, COUNT, 0, other);
        assert_memory_equal(first, other, sizeof first);
        k->step(one, &exposure, outputs);
        for (size_t o = 0; o < k->output_count; o++)
            assert_true(isfinite(outputs[o]));
        free(copy);
        free(one);
        settings.noise = false;
        void *quiet = started(k, design, &settings);
        run(k, quiet, &exposure, COUNT, 0, first);
        free(quiet);
        settings.seed = 77;
        quiet = started(k, design, &settings);
        run(k, quiet, &exposure, COUNT, 0, other);
        assert_memory_equal(first, other, sizeof first);
        free(quiet);
        free(design);
    }
}

/* The class of the lecture's table that the default design reaches names the instrument's
 * technology. */
static void classes_agree_with_the_technology_column(void **state)
{
    (void)state;
    imk_model *model = malloc(sizeof *model);
    for (size_t i = 0; i < imk_instrument_count(); i++) {
        const imk_instrument *k = get(i);
        void *design = design_of(k);
        imk_instrument_reduce(k, design, model);
        imk_model_three_axes(model);
        const imk_grade_result result = imk_grade_model(model);
        const imk_grade grade = k->sensor == IMK_GYRO ? result.gyro : result.accel;
        const imk_grade_row *row = imk_grade_table(grade);
        print_message("%-22s %-12s %s\n", k->name, row ? row->name : "none", k->technology);
        assert_true(k->technology[0] != '\0');
        assert_non_null(row);
        assert_non_null(strstr(k->sensor == IMK_GYRO ? row->gyro_technology : row->accel_technology,
                               k->technology));
        free(design);
    }
    free(model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_are_found),
        cmocka_unit_test(tables_are_complete),
        cmocka_unit_test(defaults_are_valid),
        cmocka_unit_test(every_field_is_checked),
        cmocka_unit_test(settings_are_checked),
        cmocka_unit_test(steps_that_would_lie_are_refused),
        cmocka_unit_test(runs_repeat),
        cmocka_unit_test(classes_agree_with_the_technology_column),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
