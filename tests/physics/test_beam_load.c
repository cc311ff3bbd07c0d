/* SPDX-License-Identifier: Apache-2.0 */
/* The frequency of a beam under a load, and what is not linear in the readings. */
#include "vibrating_beam_designs.h"

/* Square of the first frequency of a clamped beam over that without a load, by the determinant of
 * all four end conditions, without use of symmetry: 2 (1 - cosh a cos b) + (a^2 - b^2)/(a b)
 * sinh a sin b = 0 [TIMOSHENKO1974]. Loads n = N L^2/(E I) from -36 to 36. */
static double determinant_square(double n)
{
    double low = 2.0, high = 6.2;
    for (int i = 0; i < 100; i++) {
        const double k = 0.5 * (low + high); /* the square is (k/x1)^4 */
        const double half = 0.5 * n, root = sqrt(half * half + k * k * k * k);
        const double a = sqrt(root + half), b = sqrt(root - half);
        const double value =
            2.0 * (1.0 - cosh(a) * cos(b)) + (a * a - b * b) / (a * b) * sinh(a) * sin(b);
        if (value > 0.0)
            low = k;
        else
            high = k;
    }
    const double k = 0.5 * (low + high) / 4.730040744862704;
    return k * k * k * k;
}

/* Load per g of the default's beams: 2 (80/40000)/0.02457752. */
static double load_per_g(void)
{
    return 2.0 * 80.0 / 40000.0 / 0.0245775186348646;
}

/* By Ritz's method: experiments/clamped_beam.py, which knows no characteristic equation. */
static void the_frequency_is_that_of_a_clamped_beam(void **state)
{
    (void)state;
    static const struct {
        double n, square;
    } ritz[] = {{-39.0, 0.0125701692189}, {-35.5, 0.1041113490916}, {-30.0, 0.2465655781519},
                {-20.0, 0.5017197357878}, {-12.0, 0.7027567427141}, {-5.0, 0.8767260074153},
                {-1.0, 0.9754073498347},  {1.0, 1.0245625437212},   {5.0, 1.1225207870689},
                {12.0, 1.2928891653406},  {20.0, 1.4860909076289},  {30.0, 1.7255808161105},
                {35.5, 1.8564406676991},  {100.0, 3.3570923569286}};
    const imk_vibrating_beam d = plain();
    const double force = d.modulus * d.width * pow(d.thickness, 3.0) / 12.0 / d.length / d.length;
    for (size_t i = 0; i < sizeof ritz / sizeof ritz[0]; i++)
        CHECK_CLOSE(pow(imk_vibrating_beam_loaded(&d, 0, ritz[i].n * force) / 40000.0, 2.0),
                    ritz[i].square, 1e-12);
    for (int i = -144; i <= 144; i++)
        CHECK_CLOSE(imki_beam_load_at(0.25 * i).square, determinant_square(0.25 * i), 3e-12);
}

/* Euler's load of a beam between clamps, 4 pi^2 E I/L^2. */
static void a_beam_buckles_at_eulers_load(void **state)
{
    (void)state;
    imk_vibrating_beam d = plain();
    const double load = 4.0 * 3.14159265358979324 * 3.14159265358979324 * d.modulus * d.width *
                        pow(d.thickness, 3.0) / 12.0 / d.length / d.length;
    CHECK_RELATIVE(imk_vibrating_beam_buckling(&d), load, 1e-12);
    CHECK_CLOSE(imk_vibrating_beam_loaded(&d, 0, -load * (1.0 + 1e-12)), 0.0, 0.0);
    CHECK_CLOSE(imk_vibrating_beam_loaded(&d, 0, -1e6 * load), 0.0, 0.0);
    /* slope there: mode 1 - cos(2 pi x/L), 4 pi^2/3 of n to x1^4 */
    const double slope = 13.159472534785812 / 500.563901740433;
    const double near = imk_vibrating_beam_loaded(&d, 0, -load * (1.0 - 1e-4)) / 40000.0;
    CHECK_RELATIVE(near * near, slope * 39.47841760435743e-4, 1e-4);
    d.frequency_mismatch = -0.1; /* the weaker beam has 0.81 of the stiffness */
    CHECK_RELATIVE(imk_vibrating_beam_buckling(&d), 0.81 * load, 1e-12);
    CHECK_CLOSE(imk_vibrating_beam_loaded(&d, 1, -0.82 * load), 0.0, 0.0);
}

/* At n = 0 by perturbation (experiments/clamped_beam.py); elsewhere by differences of the
 * determinant's root, whose error is h^2/6 of the next odd derivative and 3e-13/h^k of rounding. */
static void the_derivatives_are_those_of_the_relation(void **state)
{
    (void)state;
    const imki_beam_load zero = imki_beam_load_at(0.0);
    CHECK_RELATIVE(zero.square, 1.0, 1e-14);
    CHECK_RELATIVE(zero.first, 0.024577518635, 1e-10);
    CHECK_RELATIVE(zero.second / 2.0, -1.505276877e-05, 1e-9);
    CHECK_RELATIVE(zero.third / 6.0, 7.83056352e-08, 1e-8);
    for (int i = -8; i <= 8; i++) {
        const double n = 4.0 * i, h = 0.5;
        double y[5];
        for (int k = 0; k < 5; k++)
            y[k] = determinant_square(n + (k - 2) * h);
        const imki_beam_load found = imki_beam_load_at(n);
        CHECK_CLOSE(found.first, (y[0] - 8.0 * y[1] + 8.0 * y[3] - y[4]) / (12.0 * h), 1e-10);
        CHECK_CLOSE(found.second, (y[1] - 2.0 * y[2] + y[3]) / (h * h), 1e-9);
        CHECK_CLOSE(found.third, (y[4] - 2.0 * y[3] + 2.0 * y[1] - y[0]) / (2.0 * h * h * h),
                    1e-10);
    }
}

/* The dynamics' series is the root; beyond its ends it stays what it is there. */
static void the_series_is_the_relation(void **state)
{
    (void)state;
    double series[IMKI_LOAD_TERMS];
    const double end = IMKI_BEAM_LOAD_MAX;
    imki_load_series_make(series);
    for (int i = -1000; i <= 1000; i++)
        CHECK_CLOSE(imki_load_series_at(series, 1e-3 * i * end),
                    imki_beam_load_at(1e-3 * i * end).square, 4e-15);
    CHECK_CLOSE(imki_load_series_at(series, -1e9), imki_load_series_at(series, -end), 0.0);
    CHECK_CLOSE(imki_load_series_at(series, 1e9), imki_load_series_at(series, end), 0.0);
}

/* 40 kHz, 80 Hz/g, +-50 g: a pair read by the difference of its frequencies deviates by 5817 ppm of
 * full scale from the slope at no force and by 2342 ppm from the best line; by squares by 211 ppm.
 * Both follow from the determinant at n = 8.1375; the first order alone would give 5090 and 0. */
static void nonlinearity_of_a_pair(void **state)
{
    (void)state;
    imk_vibrating_beam d = plain();
    const double full = 50.0 * G, n = 50.0 * load_per_g();
    const double up = determinant_square(n), down = determinant_square(-n);
    d.readout = IMK_BEAM_FREQUENCIES;
    const double by_frequency = (sqrt(up) - sqrt(down)) / (0.0245775186348646 * n) - 1.0;
    CHECK_CLOSE(by_frequency * 1e6, 5817.14, 0.01);
    CHECK_CLOSE(imk_vibrating_beam_reading(&d, full) / full - 1.0, by_frequency, 1e-10);
    /* the least-squares line over +-50 g, 2001 points: its largest distance is at the ends */
    double product = 0.0, square = 0.0;
    for (int i = -1000; i <= 1000; i++) {
        const double f = full * i / 1000.0;
        product += f * imk_vibrating_beam_reading(&d, f);
        square += f * f;
    }
    const double end = imk_vibrating_beam_reading(&d, full) - product / square * full;
    CHECK_CLOSE(end / full * 1e6, 2342.1, 0.1);
    d.readout = IMK_BEAM_SQUARES;
    const double by_squares = (up - down) / (2.0 * 0.0245775186348646 * n) - 1.0;
    CHECK_CLOSE(by_squares * 1e6, 211.46, 0.01);
    CHECK_CLOSE(imk_vibrating_beam_reading(&d, full) / full - 1.0, by_squares, 1e-10);
}

/* A single beam rectifies: at 10 g rms -110.06 mg read by frequency and -9.97 mg by squares, the
 * means of determinant_square over a cycle. By the full dynamics at 20 Hz, which the suspension of
 * 1500 Hz amplifies by 2 (f/fs)^2, 0.04 %. */
static void a_single_beam_rectifies(void **state)
{
    (void)state;
    imk_vibrating_beam d = plain();
    d.arrangement = IMK_BEAM_SINGLE;
    const double amplitude = 10.0 * G * sqrt(2.0), rate = 640.0;
    for (int readout = 0; readout < 2; readout++) {
        double sum = 0.0, expected = 0.0, outputs[IMK_INSTRUMENT_OUTPUTS_MAX];
        const imk_physics_settings settings = quiet(rate);
        d.readout = readout;
        void *run_state = started(beam, &d, &settings);
        for (int i = 0; i < 96; i++) {
            const double wave = cos(2.0 * 3.14159265358979324 * (i + 0.5) / 32.0);
            const imk_exposure exposure = force_of(amplitude * wave);
            beam->step(run_state, &exposure, outputs);
            if (i < 32)
                continue;
            const double square = determinant_square(10.0 * sqrt(2.0) * load_per_g() * wave);
            sum += outputs[0] / 64.0;
            expected += (readout == IMK_BEAM_SQUARES ? square : 2.0 * sqrt(square)) / 64.0;
        }
        free(run_state);
        expected -= readout == IMK_BEAM_SQUARES ? 1.0 : 2.0;
        expected *= G / (0.0245775186348646 * load_per_g());
        CHECK_CLOSE(expected / (1e-3 * G), readout == IMK_BEAM_SQUARES ? -9.97 : -110.06, 0.01);
        /* counting from crossing to crossing leaves 1/(cycles of a sample) of the change from one
         * sample to the next, which sums to the ends of the interval */
        CHECK_CLOSE(sum / (1e-3 * G), expected / (1e-3 * G), 3.0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_frequency_is_that_of_a_clamped_beam),
        cmocka_unit_test(a_beam_buckles_at_eulers_load),
        cmocka_unit_test(the_derivatives_are_those_of_the_relation),
        cmocka_unit_test(the_series_is_the_relation),
        cmocka_unit_test(nonlinearity_of_a_pair),
        cmocka_unit_test(a_single_beam_rectifies),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
