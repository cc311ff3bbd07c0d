/* SPDX-License-Identifier: Apache-2.0 */
/* What --want says of an aided navigator, fed back: the figure is what was wanted, with the gains
 * that the filter has and with a filter that is made anew. */
#include "check.h"

#include "imukit/aid_text.h"
#include "imukit/drift_models.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double outage = 20.0, wanted = 30.0;

static void set_settings(imk_aid *aid, imk_drift_settings *s)
{
    imk_error error;
    CHECK_OK(imk_aid_parse("position 1 m, velocity 0.05 m/s at 1 Hz until 20 s correlated 10 s, "
                           "lever arm 1 0 0 ± 0.1 m",
                           aid, &s->aid_count, &error));
    s->aid = aid;
    s->rate = 10.0;
    s->compensated = true;
    for (int i = 0; i < 3; i++) {
        s->initial_sigma[i] = 2.0;
        s->initial_sigma[3 + i] = 0.1;
        s->initial_sigma[6 + i] = 0.005;
    }
}

/* The figure, where the model and the aids are what the answer says. */
static double fed_back(const imk_drift_models *r, const double *factor)
{
    const imk_drift_case *one = &r->cases[r->case_count - 1];
    imk_model *model = malloc(sizeof *model);
    imk_aid aid[IMK_AIDS_MAX];
    imk_drift_settings s = one->settings;
    imk_error error;
    assert_non_null(model);
    *model = *one->model;
    memcpy(aid, one->settings.aid, s.aid_count * sizeof *aid);
    for (size_t k = 0; k < one->analysis->source_count; k++)
        assert_true(
            imk_drift_scale_source(one->analysis->source[k].name, factor[k], model, &s, aid));
    s.aid = aid;
    s.time = &wanted;
    s.time_count = 1;
    if (!r->settings.want.retuned) { /* the filter stays that of what was there */
        s.filter_model = one->model;
        s.filter_aid = one->settings.aid;
    }
    const size_t size = imk_drift_covariance_size(model, &s);
    void *memory = malloc(size);
    imk_drift_analysis *analysis;
    assert_non_null(memory);
    CHECK_OK(imk_drift_covariance(model, &s, NULL, &analysis, memory, size, &error));
    const imk_drift_figures figures = imk_drift_figures_of(&analysis->total[0]);
    free(memory);
    free(model);
    return imk_drift_required(&figures, r->settings.want.figure);
}

static void check_want(imk_drift_requirement figure, double goal, bool retuned)
{
    imk_model *model = malloc(sizeof *model);
    assert_non_null(model);
    assert_non_null(imk_device_find("tactical"));
    imk_device_model(imk_device_find("tactical"), model);
    const imk_model *const models[1] = {model};
    const char *const names[1] = {"tactical"};
    const double stated[2] = {outage, wanted};
    imk_aid aid[IMK_AIDS_MAX];
    imk_drift_models_settings settings = imk_drift_models_default();
    imk_drift_times times;
    imk_drift_models *r;
    imk_error error;
    set_settings(aid, &settings.drift);
    settings.calibrated = false;
    settings.want = (imk_drift_wanted){
        .asked = true, .figure = figure, .goal = goal, .time = wanted, .retuned = retuned};
    CHECK_OK(imk_drift_times_choose(0.0, 2, stated, 0.0, 10.0, false, 0.0, NULL, &times, &error));
    CHECK_OK(imk_drift_models_run(1, models, names, &times, &settings, NULL, &r, &error));
    const imk_drift_allocation *need = &r->answer->allocation;
    double all[IMK_DRIFT_SOURCES_MAX];
    for (size_t k = 0; k < IMK_DRIFT_SOURCES_MAX; k++)
        all[k] = need->all;
    assert_true(need->present > goal && need->all < 1.0 && r->answer->order_count > 0);
    if (retuned)
        CHECK_RELATIVE(r->answer->reached, goal, 2e-3);
    CHECK_RELATIVE(fed_back(r, need->source), goal, 0.02);
    CHECK_RELATIVE(fed_back(r, all), goal, 0.02);
    imk_drift_models_free(r);
    imk_drift_times_free(&times);
    free(model);
}

static void test_held(void **state)
{
    (void)state;
    if (check_quick()) /* test_retuned() goes through all of it */
        skip();
    check_want(IMK_REQUIRED_CEP, 0.5, false);
}

static void test_retuned(void **state)
{
    (void)state;
    check_want(IMK_REQUIRED_CEP, 0.5, true);
    if (!check_quick())
        check_want(IMK_REQUIRED_HEADING, 2e-3, true);
}

/* ---- what is not stated ---- */

enum { MOMENTS = 2 };

/* Mean square of a figure of a model in the filter of another. */
static void squares(const imk_model *model, const imk_model *filter, imk_drift_settings s,
                    imk_drift_requirement figure, double square[MOMENTS])
{
    static const int first[] = {[IMK_REQUIRED_DRMS] = 0,
                                [IMK_REQUIRED_HEIGHT] = 2,
                                [IMK_REQUIRED_VELOCITY] = 3,
                                [IMK_REQUIRED_TILT] = 6,
                                [IMK_REQUIRED_HEADING] = 8};
    const int last = first[figure] + (first[figure] == 2 || first[figure] == 8 ? 0 : 1);
    imk_drift_analysis *analysis;
    imk_error error;
    s.filter_model = filter;
    const size_t size = imk_drift_covariance_size(model, &s);
    void *memory = malloc(size);
    assert_non_null(memory);
    CHECK_OK(imk_drift_covariance(model, &s, NULL, &analysis, memory, size, &error));
    for (size_t t = 0; t < MOMENTS; t++) {
        const imk_drift_moments *m = &analysis->total[t];
        square[t] = 0.0;
        for (int i = first[figure]; i <= last; i++)
            square[t] += m->covariance[i][i] + m->mean[i] * m->mean[i];
    }
    free(memory);
}

/* The share of a term that is not stated is what the mean square grows by when it is added, in the
 * filter of the model as it is, as the mean of both signs: by brute force. */
static void test_share_of_unstated(void **state)
{
    (void)state;
    const double stated[MOMENTS] = {outage, wanted};
    imk_model *model = malloc(3 * sizeof *model), *plus = &model[1], *minus = &model[2];
    assert_non_null(model);
    assert_non_null(imk_device_find("tactical"));
    imk_device_model(imk_device_find("tactical"), model);
    memset(&model->accel.misalignment, 0, sizeof model->accel.misalignment);
    for (int i = 0; i < 3; i++) /* so that a misalignment is not lost in it */
        model->accel.bias.repeatability.value[i] *= 0.25;
    *plus = *model;
    imk_model_assume_class(plus, IMK_GRADE_NONE, NULL);
    *minus = *plus;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            minus->accel.misalignment.value[i][j] *= -1;
    imk_aid aid[IMK_AIDS_MAX];
    imk_drift_models_settings settings = imk_drift_models_default();
    imk_drift_times times;
    imk_drift_models *r;
    imk_error error;
    const char *const name = "tactical";
    const imk_model *const one = model;
    set_settings(aid, &settings.drift);
    settings.drift.compensated = false;
    for (int i = 6; i < 9; i++)
        settings.drift.initial_sigma[i] = 1e-4;
    CHECK_OK(
        imk_drift_times_choose(0.0, MOMENTS, stated, 0.0, 10.0, false, 0.0, NULL, &times, &error));
    CHECK_OK(imk_drift_models_run(1, &one, &name, &times, &settings, NULL, &r, &error));
    assert_int_equal(r->cases[0].missing_count, 1);
    const imk_drift_missing *missing = &r->cases[0].missing[0];
    assert_string_equal(missing->term.key, "misalignment");
    settings.drift.time = stated;
    settings.drift.time_count = MOMENTS;
    double of[3][MOMENTS], largest = 0.0;
    for (int k = 0; k < 3; k++)
        squares(&model[k], model, settings.drift, missing->figure, of[k]);
    for (size_t t = 0; t < MOMENTS; t++)
        largest = fmax(largest, 1.0 - of[0][t] / (0.5 * (of[1][t] + of[2][t])));
    CHECK_RELATIVE(missing->share, largest, 1e-9);
    imk_drift_models_free(r);
    imk_drift_times_free(&times);
    free(model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_held),
        cmocka_unit_test(test_retuned),
        cmocka_unit_test(test_share_of_unstated),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
