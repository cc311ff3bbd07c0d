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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_held),
        cmocka_unit_test(test_retuned),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
