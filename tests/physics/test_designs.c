/* SPDX-License-Identifier: Apache-2.0 */
/* The further designs of examples/instruments: the reduced model of each meets the published
 * figures of its class, its grade is the one that docs/physics/designs.md claims, and it runs. A
 * figure's range is that of the source in the head of the design file; where a source gives one
 * number the range allows for what the head says about it (a limit taken as 1 to 3 sigma). */
#include "instrument_run.h"

#include "imukit/design_file.h"
#include "imukit/io.h"
#include "imukit/units.h"
#include "imukit/vibrating_beam.h"

#include <stdio.h>

enum { FIGURES_MAX = 6, SAMPLES = 100 };

typedef enum quantity {
    END,
    REMAINING, /* bias as imukit grade computes it */
    REPEATABILITY,
    FIXED_BIAS,
    INSTABILITY,
    WHITE,
    FIXED_SCALE,
    SCALE,
    G_SENSITIVITY, /* of x to the force along x */
    BANDWIDTH,
    RANGE
} quantity;

/* low < value <= high [unit] */
typedef struct figure {
    quantity of;
    double low, high;
    const char *unit;
} figure;

typedef struct published {
    const char *file, *instrument;
    imk_grade grade;
    figure figures[FIGURES_MAX];
} published;

/* one-sided densities over sqrt(2), Allan floors over 0.664 */
static const published designs[] = {
    /* 4 deg in 10 min, at 1 to 3 sigma [PHANTEC] */
    {"light_aircraft_gyro", "free_gyro", IMK_GRADE_CONTROL, {{REPEATABILITY, 8.0, 24.0, "deg/h"}}},
    /* 1 deg/h, at 1 to 3 sigma [DGDRIFT] */
    {"fine_directional_gyro",
     "free_gyro",
     IMK_GRADE_TACTICAL,
     {{REPEATABILITY, 0.333, 1.0, "deg/h"}}},
    /* rate grade [NOROUZPOUR2013] */
    {"coarse_rate_gyro",
     "rate_gyro",
     IMK_GRADE_CONTROL,
     {{REMAINING, 10.0, 1000.0, "deg/h"},
      {WHITE, 0.5, 5.0, "deg/sqrt(h)"},
      {FIXED_SCALE, 0.1, 1.0, "%"},
      {BANDWIDTH, 70.0, 150.0, "Hz"},
      {RANGE, 50.0, 1000.0, "deg/s"}}},
    {"fine_rate_gyro",
     "rate_gyro",
     IMK_GRADE_CONTROL,
     {{REMAINING, 10.0, 1000.0, "deg/h"},
      {FIXED_SCALE, 0.0, 1.0, "%"},
      {BANDWIDTH, 70.0, 150.0, "Hz"},
      {RANGE, 50.0, 1000.0, "deg/s"}}},
    /* 1.5 deg/h at 3 to 5 sigma [TINDALL1969]; 25 meru/g [MILLER1968] */
    {"floated_gyro_of_a_spacecraft",
     "rate_integrating_gyro",
     IMK_GRADE_TACTICAL,
     {{REPEATABILITY, 0.3, 0.5, "deg/h"}, {G_SENSITIVITY, 0.0, 0.375, "deg/h/g"}}},
    /* strategic [ELSHEIMY2020]; 1 arcsec in 30 min [IUEGYRO] */
    {"strategic_floated_gyro",
     "rate_integrating_gyro",
     IMK_GRADE_STRATEGIC,
     {{REMAINING, 1e-4, 1.0 / 1800.0, "deg/h"}}},
    /* 1 sigma, both within a tenth [SPE90408] */
    {"downhole_tuned_gyro",
     "tuned_gyro",
     IMK_GRADE_TACTICAL,
     {{REPEATABILITY, 0.09, 0.11, "deg/h"}, {G_SENSITIVITY, 0.45, 0.55, "deg/h/g"}}},
    /* inertial [NOROUZPOUR2013] */
    {"navigation_tuned_gyro",
     "tuned_gyro",
     IMK_GRADE_NAVIGATION,
     {{REMAINING, 0.001, 0.01, "deg/h"}, {WHITE, 0.0, 0.001, "deg/sqrt(h)"}}},
    {"aircraft_suspended_rotor",
     "suspended_rotor",
     IMK_GRADE_NAVIGATION,
     {{REMAINING, 0.001, 0.01, "deg/h"}, {WHITE, 0.0, 0.001, "deg/sqrt(h)"}}},
    /* strategic [ELSHEIMY2020], electrostatic [LESSON] */
    {"submarine_suspended_rotor",
     "suspended_rotor",
     IMK_GRADE_STRATEGIC,
     {{REMAINING, 1e-4, 1e-3, "deg/h"}, {WHITE, 0.0, 0.001, "deg/sqrt(h)"}}},
    /* DSP-3000 [KVHMANUAL]; small fibre-optic gyros [LESSON] */
    {"short_fibre_optic",
     "fibre_optic",
     IMK_GRADE_TACTICAL,
     {{RANGE, 374.9, 375.1, "deg/s"},
      {REMAINING, 0.1, 10.0, "deg/h"},
      {WHITE, 0.02, 0.3, "deg/sqrt(h)"}}},
    /* strategic interferometers [GRIGORIE2011] */
    {"long_fibre_optic",
     "fibre_optic",
     IMK_GRADE_STRATEGIC,
     {{REMAINING, 0.0, 3e-4, "deg/h"},
      {WHITE, 0.0, 8e-5, "deg/sqrt(h)"},
      {SCALE, 0.0, 0.5, "ppm"}}},
    /* HG1700: a limit, and 0.125 within a tenth */
    {"tactical_ring_laser",
     "ring_laser",
     IMK_GRADE_TACTICAL,
     {{REPEATABILITY, 0.333, 1.0, "deg/h"}, {WHITE, 0.1125, 0.1375, "deg/sqrt(h)"}}},
    /* strategic [ELSHEIMY2020]; large ring lasers, a few ppm [LESSON] */
    {"large_ring_laser",
     "ring_laser",
     IMK_GRADE_STRATEGIC,
     {{REMAINING, 1e-4, 1e-3, "deg/h"},
      {WHITE, 0.0, 0.001, "deg/sqrt(h)"},
      {SCALE, 1.0, 10.0, "ppm"}}},
    /* 0.014 deg/s/sqrt(Hz), typical: within a tenth; 1 deg/s; 1 % [BMI088DS] */
    {"consumer_fork",
     "tuning_fork",
     IMK_GRADE_NONE,
     {{WHITE, 0.535, 0.653, "deg/sqrt(h)"},
      {REPEATABILITY, 0.9, 1.1, "deg/s"},
      {SCALE, 0.5, 1.0, "%"},
      {BANDWIDTH, 46.5, 47.5, "Hz"},
      {RANGE, 1999.0, 2001.0, "deg/s"}}},
    /* quartz [GNCTECH2025] */
    {"quartz_fork",
     "tuning_fork",
     IMK_GRADE_TACTICAL,
     {{REMAINING, 0.1, 1.0, "deg/h"},
      {WHITE, 0.01, 0.1, "deg/sqrt(h)"},
      {SCALE, 10.0, 100.0, "ppm"},
      {BANDWIDTH, 0.0, 400.0, "Hz"},
      {RANGE, 0.0, 4000.0, "deg/s"}}},
    /* RRS01-01 [CTPRO]; rate grade [NOROUZPOUR2013] */
    {"cheap_ring",
     "shell_gyro",
     IMK_GRADE_CONTROL,
     {{WHITE, 0.02, 0.2, "deg/sqrt(h)"},
      {BANDWIDTH, 50.0, 60.0, "Hz"},
      {REMAINING, 10.0, 1000.0, "deg/h"},
      {FIXED_SCALE, 0.1, 1.0, "%"}}},
    /* navigation [ELSHEIMY2020], [LESSON] */
    {"navigation_hemisphere",
     "shell_gyro",
     IMK_GRADE_NAVIGATION,
     {{REMAINING, 0.001, 0.01, "deg/h"}, {WHITE, 0.002, 0.005, "deg/sqrt(h)"}}},
    /* 160 ug/sqrt(Hz), typical: within a tenth; 20 mg [BMI088DS] */
    {"consumer_accelerometer",
     "mems_accelerometer",
     IMK_GRADE_NONE,
     {{WHITE, 101.8, 124.5, "ug/sqrt(Hz)"},
      {REPEATABILITY, 18.0, 22.0, "mg"},
      {RANGE, 23.99, 24.01, "g"}}},
    /* from 1.08, open loop, to 10 ug/sqrt(Hz), closed [KULAH2006]; navigation [LESSON] */
    {"navigation_sigma_delta",
     "mems_accelerometer",
     IMK_GRADE_NAVIGATION,
     {{WHITE, 0.764, 7.07, "ug/sqrt(Hz)"}, {REMAINING, 25.0, 100.0, "ug"}}},
    /* GSY-QA-03A1 [ERICCO] */
    {"coarse_servo",
     "pendulous_servo",
     IMK_GRADE_TACTICAL,
     {{FIXED_BIAS, 1.0, 3.0, "mg"}, {RANGE, 49.99, 50.01, "g"}}},
    /* quartz pendulums [LESSON] */
    {"fine_servo",
     "pendulous_servo",
     IMK_GRADE_STRATEGIC,
     {{REMAINING, 25.0, 100.0, "ug"}, {SCALE, 10.0, 100.0, "ppm"}}},
    /* [SEOK2003]; see the_beams_have_their_frequencies() */
    {"coarse_beam",
     "vibrating_beam",
     IMK_GRADE_CONTROL,
     {{BANDWIDTH, 100.0, 1000.0, "Hz"}, {RANGE, 9.99, 10.01, "g"}}},
    /* 98 ng/sqrt(Hz) and 56 ng, both within a tenth [ZHAO2019] */
    {"fine_beam",
     "vibrating_beam",
     IMK_GRADE_STRATEGIC,
     {{WHITE, 0.0624, 0.0762, "ug/sqrt(Hz)"}, {INSTABILITY, 0.0759, 0.0928, "ug"}}},
};

static const char *const names[] = {"",
                                    "remaining bias",
                                    "bias repeatability",
                                    "fixed bias",
                                    "bias instability",
                                    "white noise",
                                    "fixed scale factor",
                                    "scale factor repeatability",
                                    "g-sensitivity",
                                    "bandwidth",
                                    "range"};

static void open_design(const char *name, imk_design_file *file)
{
    char path[1024], message[600];
    imk_error error = {0};
    snprintf(path, sizeof path, SOURCE_DIRECTORY "/examples/instruments/%s.yaml", name);
    if (imk_design_read(path, file, &error) != IMK_OK) {
        imk_error_text(&error, path, message, sizeof message);
        fail_msg("%s", message);
    }
}

static double value_of(quantity of, const imk_triad *triad, double remaining)
{
    switch (of) {
    case REMAINING:
        return remaining;
    case REPEATABILITY:
        return triad->bias.repeatability.value[0];
    case FIXED_BIAS:
        return fabs(triad->bias.fixed.value[0]);
    case INSTABILITY:
        return triad->noise.bias_instability.value[0];
    case WHITE:
        return triad->noise.white.value[0];
    case FIXED_SCALE:
        return fabs(triad->scale_factor.fixed.value[0]);
    case SCALE:
        return triad->scale_factor.repeatability.value[0];
    case G_SENSITIVITY:
        return fabs(triad->g_sensitivity.value[0][0]);
    case BANDWIDTH:
        return triad->bandwidth.value[0];
    case RANGE:
        return triad->range.value[0];
    case END:
        break;
    }
    return NAN;
}

static void reduced_models_meet_the_published_figures(void **state)
{
    (void)state;
    imk_model *model = malloc(sizeof *model);
    for (size_t i = 0; i < sizeof designs / sizeof designs[0]; i++) {
        const published *p = &designs[i];
        imk_design_file file;
        open_design(p->file, &file);
        assert_string_equal(file.instrument->name, p->instrument);
        imk_instrument_reduce(file.instrument, file.design, model);
        imk_model_three_axes(model);
        const imk_grade_result result = imk_grade_model(model);
        const bool gyro = file.instrument->sensor == IMK_GYRO;
        const imk_triad *triad = gyro ? &model->gyro : &model->accel;
        for (const figure *f = p->figures; f < p->figures + FIGURES_MAX && f->of != END; f++) {
            const double value =
                value_of(f->of, triad, gyro ? result.gyro_bias : result.accel_bias) /
                imk_unit_of(f->unit).scale;
            if (!(value > f->low && value <= f->high))
                fail_msg("%s: %s %g %s, published %g to %g", p->file, names[f->of], value, f->unit,
                         f->low, f->high);
        }
        if ((gyro ? result.gyro : result.accel) != p->grade)
            fail_msg("%s: grade %d, claimed %d", p->file, (int)(gyro ? result.gyro : result.accel),
                     (int)p->grade);
        imk_design_file_free(&file);
    }
    free(model);
}

static void every_design_runs_a_second_on_both_levels(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof designs / sizeof designs[0]; i++)
        for (int level = IMK_LEVEL_FULL; level <= IMK_LEVEL_SLOW; level++) {
            imk_design_file file;
            imk_physics_settings settings = imk_physics_default();
            const imk_exposure exposure = imk_exposure_default();
            double readings[SAMPLES];
            open_design(designs[i].file, &file);
            settings.level = (imk_level)level;
            settings.rate = SAMPLES;
            void *instrument_state = started(file.instrument, file.design, &settings);
            run(file.instrument, instrument_state, &exposure, SAMPLES, 0, readings);
            for (int k = 0; k < SAMPLES; k++)
                if (!isfinite(readings[k]))
                    fail_msg("%s, level %d: sample %d is %g", designs[i].file, level, k,
                             readings[k]);
            free(instrument_state);
            imk_design_file_free(&file);
        }
}

/* Each instrument has two further designs, a coarse one before a fine one. */
static void coarse_designs_come_before_fine_ones(void **state)
{
    (void)state;
    const size_t count = sizeof designs / sizeof designs[0];
    imk_model *model = malloc(sizeof *model);
    assert_int_equal(count, 2 * imk_instrument_count());
    for (size_t i = 0; i < count; i += 2) {
        double bias[2];
        assert_string_equal(designs[i].instrument, designs[i + 1].instrument);
        for (size_t k = 0; k < 2; k++) {
            imk_design_file file;
            open_design(designs[i + k].file, &file);
            imk_instrument_reduce(file.instrument, file.design, model);
            imk_model_three_axes(model);
            const imk_grade_result result = imk_grade_model(model);
            bias[k] = file.instrument->sensor == IMK_GYRO ? result.gyro_bias : result.accel_bias;
            imk_design_file_free(&file);
        }
        if (!(bias[0] > 5.0 * bias[1]))
            fail_msg("%s: %g, %s: %g", designs[i].file, bias[0], designs[i + 1].file, bias[1]);
    }
    free(model);
}

/* 6928 Hz and 10 Hz/g between two beams [SEOK2003]; 0.77 ppb of the frequency for 98 ng
 * [ZHAO2019]. */
static void the_beams_have_their_frequencies(void **state)
{
    (void)state;
    const double g = 9.80665;
    imk_design_file file;
    open_design("coarse_beam", &file);
    const imk_vibrating_beam *beam = file.design;
    CHECK_RELATIVE(imk_vibrating_beam_frequency(beam, 0), 6928.0, 0.002);
    CHECK_RELATIVE(2.0 * g * imk_vibrating_beam_slope(beam), 10.0, 0.02);
    imk_design_file_free(&file);
    open_design("fine_beam", &file);
    beam = file.design;
    CHECK_RELATIVE(g * imk_vibrating_beam_slope(beam) / imk_vibrating_beam_frequency(beam, 0),
                   0.77e-9 / 98e-9, 0.02);
    imk_design_file_free(&file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reduced_models_meet_the_published_figures),
        cmocka_unit_test(every_design_runs_a_second_on_both_levels),
        cmocka_unit_test(coarse_designs_come_before_fine_ones),
        cmocka_unit_test(the_beams_have_their_frequencies),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
