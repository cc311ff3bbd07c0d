/* SPDX-License-Identifier: Apache-2.0 */
/* The claims of position of the grade presets, by computation: horizontal_error.h, first compared
 * with figures known from elsewhere, then applied to the presets. Every term of every axis is an
 * independent source. */
#include "horizontal_error.h"

#include "check.h"

#include "imukit/model.h"

static const double degree_per_hour = 3.14159265358979323846 / 180 / 3600;
static const double micro_g = 9.80665e-6;
static const double nautical_mile = 1852;

/* ---- the propagation is right -----------------------------------------------------------------
 */

/* Three gyros and two accelerometers, each with a constant of this size. */
static covariance biases(double gyro, double accel, double t)
{
    covariance sum = {0, 0, 0};
    for (int i = 0; i < INPUTS; i++)
        add(&sum, i < 3 ? gyro * gyro : accel * accel, unit_constant(i, t));
    return sum;
}

/* Independent arithmetic for the biases of the table alone: CEP and DRMS, printed with two or three
 * digits (1 %). */
static void biases_alone_give_the_known_figures(void **state)
{
    (void)state;
    static const struct {
        double gyro, accel, t, cep, drms, unit;
    } known[] = {
        {0.005, 30, 60, 0.62, 0.75, 1},       {0.005, 30, 3600, 0.455, 0.547, 1852},
        {0.005, 30, 86400, 3.45, 5.11, 1852}, {0.01, 50, 60, 1.04, 1.25, 1},
        {0.01, 50, 3600, 0.895, 1.08, 1852},  {0.01, 50, 86400, 6.90, 10.2, 1852},
        {1, 1000, 60, 20.9, 25.1, 1},         {1, 1000, 3600, 86, 103, 1852},
        {1, 1000, 86400, 689, 1022, 1852},
    };
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        const covariance p =
            biases(known[i].gyro * degree_per_hour, known[i].accel * micro_g, known[i].t);
        CHECK_RELATIVE(cep(p), known[i].cep * known[i].unit, 0.01);
        CHECK_RELATIVE(drms(p), known[i].drms * known[i].unit, 0.01);
    }
}

/* Single sources at 45 deg north, by a separate computation, to the digits printed. */
static void single_sources_give_the_known_figures(void **state)
{
    (void)state;
    const double gyro = 0.01 * degree_per_hour, accel = 50 * micro_g;
    CHECK_CLOSE(gyro * sqrt(unit_constant(0, 3600).ee), 1340.6, 0.06);
    CHECK_CLOSE(gyro * sqrt(unit_constant(1, 3600).nn), 1336.5, 0.06);
    CHECK_CLOSE(gyro * sqrt(unit_constant(2, 3600).nn), 89.6, 0.06);
    CHECK_CLOSE(gyro * sqrt(unit_constant(0, 60).ee), 0.0171, 6e-5);
    CHECK_CLOSE(gyro * sqrt(unit_constant(0, 86400).ee), 13400, 60);
    CHECK_CLOSE(accel * sqrt(unit_constant(3, 3600).nn), 396.0, 0.06);

    const double arw = 0.002 * pi / 180 / 60, vrw = 10 * micro_g;
    static const double times[3] = {60, 3600, 86400};
    static const double arw_known[3] = {0.0503, 440, 1890};
    static const double vrw_known[3] = {0.0372, 4.61, 23.2};
    for (int i = 0; i < 3; i++) {
        covariance tilt = {0, 0, 0}, velocity = {0, 0, 0};
        for (int input = 0; input < INPUTS; input++)
            add(input < 3 ? &tilt : &velocity, 1, unit_white(input, times[i]));
        CHECK_RELATIVE(arw * drms(tilt), arw_known[i], 0.002);
        CHECK_RELATIVE(vrw * drms(velocity), vrw_known[i], 0.002);
    }
}

/* Without the Earth's rotation a bias of the north gyro gives east  R d (t - sin(w t)/w) and one of
 * an accelerometer  a/w^2 (1 - cos(w t)),  w^2 = g/R; the transport rate's tan(latitude) then acts
 * on the azimuth only. */
static void schuler_oscillation_is_exact(void **state)
{
    (void)state;
    static double north[STEPS + 1], east[STEPS + 1];
    const double w = sqrt(gravity / radius), t = 3600;
    respond(0, (double)INFINITY, false, 0, t, north, east);
    const double gyro = 0.01 * degree_per_hour * east[STEPS];
    CHECK_RELATIVE(gyro, 0.01 * degree_per_hour * radius * (t - sin(w * t) / w), 1e-9);
    CHECK_CLOSE(gyro, 1353.4, 0.06);
    respond(3, (double)INFINITY, false, 0, t, north, east);
    CHECK_RELATIVE(north[STEPS], (1 - cos(w * t)) / (w * w), 1e-9);
}

/* Random walk of a gyro over a minute, where gravity does not yet swing: K is integrated four
 * times, K^2 g^2 t^7/(7 (3!)^2). Of an accelerometer K^2 t^5/(5 (2!)^2). Earth and Schuler take
 * less than (w t)^2/10 = 0.06 %. */
static void random_walk_is_integrated(void **state)
{
    (void)state;
    CHECK_RELATIVE(unit_random_walk(0, 60).ee, gravity * gravity * pow(60, 7) / (7 * 36), 2e-3);
    CHECK_RELATIVE(unit_random_walk(3, 60).nn, pow(60, 5) / (5 * 4), 2e-3);
}

/* The stages have the Allan variance of flicker noise, (2 ln 2/pi) B^2 [IEEE952], within 1 % of the
 * deviation from 1 s to 40 000 s (closed form of each stage). */
static void flicker_stages_are_flat(void **state)
{
    (void)state;
    for (double tau = 1; tau < 4e4; tau *= 1.7) {
        double variance = 0;
        for (int j = 0; j < STAGES; j++) {
            const double r = tau / stage_time(j);
            double shape = 2 / r * (1 - (3 - 4 * exp(-r) + exp(-2 * r)) / (2 * r));
            if (r < 1e-3) /* first terms of the series: the bracket cancels */
                shape = 2 * r / 3 * (1 - 3 * r / 4);
            variance += stage_variance(j) * shape;
        }
        CHECK_RELATIVE(variance, 2 * log(2) / pi, 0.02);
    }
}

/* The same flicker noise through frequencies: its spectrum times the squared transform of the
 * impulse response, integrated. Half a per cent for the grid of 12 points an octave. */
static void flicker_agrees_with_its_spectrum(void **state)
{
    (void)state;
    static double north[STEPS + 1], east[STEPS + 1];
    const double t = 3600, step = log(2) / 12;
    respond(0, (double)INFINITY, true, earth_rate, t, north, east);
    double sum = 0;
    for (double f = 1e-11; f < 0.05; f *= exp(step)) {
        double real = 0, imaginary = 0, spectrum = 0;
        for (int k = 0; k <= STEPS; k++) {
            const double weight = k == 0 || k == STEPS ? 0.5 : 1;
            real += weight * east[k] * cos(2 * pi * f * t * k / STEPS);
            imaginary += weight * east[k] * sin(2 * pi * f * t * k / STEPS);
        }
        for (int j = 0; j < STAGES; j++) {
            const double wt = 2 * pi * f * stage_time(j);
            spectrum += 2 * stage_variance(j) * stage_time(j) / (1 + wt * wt);
        }
        sum += 2 * spectrum * (real * real + imaginary * imaginary) * f * step;
    }
    CHECK_RELATIVE(sum * (t / STEPS) * (t / STEPS), unit_flicker(0, t).ee, 0.005);
}

/* The probable radius is 1.1774 s for a circle, sqrt(2 ln 2) s, and 0.6745 s on a line, and close
 * to 0.589 (s1 + s2) between. */
static void probable_radius_is_right(void **state)
{
    (void)state;
    CHECK_RELATIVE(cep((covariance){1, 0, 1}), sqrt(2 * log(2)), 1e-6);
    CHECK_RELATIVE(cep((covariance){4, 4, 4}), 0.674490 * sqrt(8), 1e-3);
    CHECK_RELATIVE(cep((covariance){1, 0, 0.25}), 0.589 * 1.5, 0.02);
}

/* ---- the presets ------------------------------------------------------------------------------
 */

static double square(double x)
{
    return x * x;
}

/* Variance of the constant errors of one input at rest: repeatability, and what scale factor,
 * misalignment and sensitivity to force make of the Earth's rate and of gravity, each one standard
 * deviation. */
static double constant_variance(const imk_model *model, int input)
{
    const imk_triad *triad = input < 3 ? &model->gyro : &model->accel;
    const int axis = input < 3 ? input : input - 3;
    const double rate[3] = {earth_rate * cos(latitude), 0, -earth_rate * sin(latitude)};
    const double force[3] = {0, 0, -gravity};
    const double *own = input < 3 ? rate : force;
    double sum = square(triad->bias.repeatability.value[axis]);
    sum += square(triad->scale_factor.repeatability.value[axis] * own[axis]);
    sum += square(triad->nonlinearity.k2.value[axis] * square(own[axis]));
    for (int j = 0; j < 3; j++) {
        sum += square(triad->misalignment.value[axis][j] * own[j]);
        sum += square(triad->g_sensitivity.value[axis][j] * force[j]);
        sum += square(triad->g2_sensitivity.value[axis][j] * square(force[j]));
    }
    return sum;
}

/* Resolution and quantization of dithered outputs do not add up, and a bandwidth takes nothing from
 * a position after a minute. */
static covariance position_of(const imk_model *model, double t)
{
    covariance sum = {0, 0, 0};
    for (int i = 0; i < INPUTS; i++) {
        const imk_noise *noise = i < 3 ? &model->gyro.noise : &model->accel.noise;
        const int axis = i < 3 ? i : i - 3;
        add(&sum, constant_variance(model, i), unit_constant(i, t));
        add(&sum, square(noise->white.value[axis]), unit_white(i, t));
        add(&sum, square(noise->random_walk.value[axis]), unit_random_walk(i, t));
        add(&sum, square(noise->bias_instability.value[axis]), unit_flicker(i, t));
    }
    return sum;
}

static covariance position_of_preset(const char *name, double t)
{
    imk_model model;
    const imk_device *device = imk_device_find(name);
    assert_non_null(device);
    imk_device_model(device, &model);
    for (int i = 0; i < 2; i++) { /* nothing that position_of() does not know of */
        const imk_noise *noise = i ? &model.gyro.noise : &model.accel.noise;
        assert_int_equal(noise->gauss_markov_count + noise->sinusoid_count + noise->resonance_count,
                         0);
        assert_true(noise->ramp.value[0] == 0);
    }
    const covariance p = position_of(&model, t);
    print_message("%-10s %6.0f s: CEP %9.4g m = %9.4g nmi, DRMS %9.4g nmi\n", name, t, cep(p),
                  cep(p) / nautical_mile, drms(p) / nautical_mile);
    return p;
}

static void strategic_claim_holds(void **state)
{
    (void)state;
    CHECK_BELOW(cep(position_of_preset("strategic", 86400)), nautical_mile);
    position_of_preset("strategic", 3600);
    position_of_preset("strategic", 60);
}

/* And its first day: 1 nmi/h times 24 h. */
static void navigation_claim_holds(void **state)
{
    (void)state;
    CHECK_BELOW(cep(position_of_preset("navigation", 3600)), nautical_mile);
    CHECK_BELOW(cep(position_of_preset("navigation", 86400)), 24 * nautical_mile);
    position_of_preset("navigation", 60);
}

/* More than 10 nmi in an hour: worse than the class above. */
static void tactical_claim_holds(void **state)
{
    (void)state;
    CHECK_BELOW(10 * nautical_mile, cep(position_of_preset("tactical", 3600)));
    position_of_preset("tactical", 86400);
    position_of_preset("tactical", 60);
}

/* No claim; but each class is worse than the one before, at every time. */
static void classes_are_in_order(void **state)
{
    (void)state;
    static const char *const names[] = {"strategic", "navigation", "tactical", "AHRS", "control"};
    static const double times[] = {60, 3600};
    for (int i = 0; i < 2; i++)
        for (int grade = 1; grade < 5; grade++)
            CHECK_BELOW(1.5 * cep(position_of_preset(names[grade - 1], times[i])),
                        cep(position_of_preset(names[grade], times[i])));
}

/* What the notes of the presets and docs/choose-a-sensor.md print, to their digits. */
static void printed_figures_are_the_computed_ones(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double t, cep, tolerance; /* [m] */
    } printed[] = {
        {"strategic", 60, 0.071, 6e-4},
        {"navigation", 60, 0.86, 6e-3},
        {"tactical", 60, 17, 0.6},
        {"AHRS", 60, 35, 0.6},
        {"control", 60, 1200, 60},
        {"strategic", 3600, 0.056 * 1852, 1},
        {"strategic", 86400, 0.43 * 1852, 10},
        {"navigation", 3600, 0.71 * 1852, 10},
        {"navigation", 86400, 6.0 * 1852, 100},
        {"tactical", 3600, 80 * 1852, 1000},
        {"tactical", 86400, 870 * 1852, 10000},
    };
    for (size_t i = 0; i < sizeof printed / sizeof printed[0]; i++)
        CHECK_CLOSE(cep(position_of_preset(printed[i].name, printed[i].t)), printed[i].cep,
                    printed[i].tolerance);
}

/* DRMS of the three gyros' share that one kind of source has, of this strength on each. */
static double gyro_share(covariance (*unit)(int input, double t), double strength, double t)
{
    covariance sum = {0, 0, 0};
    for (int i = 0; i < 3; i++)
        add(&sum, strength * strength, unit(i, t));
    return drms(sum) / nautical_mile;
}

/* And the shares that docs/choose-a-sensor.md prints [nmi]. */
static void printed_shares_are_the_computed_ones(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double t, repeatability, instability, white; /* 0: not printed */
    } printed[] = {
        {"strategic", 86400, 0.41, 0.41, 0},
        {"navigation", 3600, 0.62, 0.475, 0.24},
        {"tactical", 3600, 82, 47.5, 0},
    };
    for (size_t i = 0; i < sizeof printed / sizeof printed[0]; i++) {
        imk_model model;
        const double t = printed[i].t;
        imk_device_model(imk_device_find(printed[i].name), &model);
        const imk_triad *gyro = &model.gyro;
        print_message("%-10s %6.0f s: DRMS of the gyros' B %.4g nmi\n", printed[i].name, t,
                      gyro_share(unit_flicker, gyro->noise.bias_instability.value[0], t));
        CHECK_RELATIVE(gyro_share(unit_constant, gyro->bias.repeatability.value[0], t),
                       printed[i].repeatability, 0.01);
        CHECK_RELATIVE(gyro_share(unit_flicker, gyro->noise.bias_instability.value[0], t),
                       printed[i].instability, 0.01);
        if (printed[i].white > 0)
            CHECK_RELATIVE(gyro_share(unit_white, gyro->noise.white.value[0], t), printed[i].white,
                           0.02);
    }
    imk_model model;
    imk_device_model(imk_device_find("navigation"), &model);
    model.gyro = (imk_triad){.present = false};
    CHECK_CLOSE(drms(position_of(&model, 3600)) / nautical_mile, 0.25, 0.005);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(biases_alone_give_the_known_figures),
        cmocka_unit_test(single_sources_give_the_known_figures),
        cmocka_unit_test(schuler_oscillation_is_exact),
        cmocka_unit_test(random_walk_is_integrated),
        cmocka_unit_test(flicker_stages_are_flat),
        cmocka_unit_test(flicker_agrees_with_its_spectrum),
        cmocka_unit_test(probable_radius_is_right),
        cmocka_unit_test(strategic_claim_holds),
        cmocka_unit_test(navigation_claim_holds),
        cmocka_unit_test(tactical_claim_holds),
        cmocka_unit_test(classes_are_in_order),
        cmocka_unit_test(printed_figures_are_the_computed_ones),
        cmocka_unit_test(printed_shares_are_the_computed_ones),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
