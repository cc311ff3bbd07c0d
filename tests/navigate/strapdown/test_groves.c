/* SPDX-License-Identifier: Apache-2.0 */
/* The mechanisation and its inverse on two published profiles of 60 and 175 s at 100 Hz, against
 * the drift that a textbook implementation had with the same deterministic errors. */
#include "check.h"

#include "navigate/groves_profiles.h"

#define DIRECTORY SHARED_DIRECTORY "/data/navigation/"

static const char *const profile_path[] = {DIRECTORY "groves_profile_1.csv.gz",
                                           DIRECTORY "groves_profile_2.csv.gz"};

static void load_or_skip(int number, groves_profile *profile)
{
    if (!groves_load(profile_path[number - 1], profile)) {
        print_message("%s is not there\n", profile_path[number - 1]);
        skip();
    }
}

/* Within 0.1 % of the largest component is what different implementations of one mechanisation
 * agree to. An exact one comes closer: 0.05 % at 10 s, where profile 2 with the aviation grade has
 * moved by 7 cm only, and 0.015 % from 30 s on. */
static void check_drift(int number)
{
    groves_profile profile;
    load_or_skip(number, &profile);
    for (int g = 0; g < GROVES_GRADES; g++) {
        groves_published published = {0};
        imk_vector3 drift[GROVES_TIMES_MAX] = {{{0}}};
        assert_true(groves_read_published(DIRECTORY "groves_reference_drift.csv", number,
                                          groves_grades[g].name, &published));
        assert_int_equal(published.count, number == 1 ? 3 : 5);
        CHECK_OK(groves_distort(&profile, &groves_grades[g]));
        groves_drift(&profile, published.count, published.after, drift);
        for (size_t k = 0; k < published.count; k++) {
            const double *expected = published.drift[k].v;
            const double largest =
                fmax(fabs(expected[0]), fmax(fabs(expected[1]), fabs(expected[2])));
            const double tolerance = published.after[k] < 30.0 ? 5e-4 : 1.5e-4;
            for (int i = 0; i < 3; i++)
                CHECK_CLOSE(drift[k].v[i], expected[i], tolerance * largest);
        }
    }
    groves_free(&profile);
}

static void test_drift_of_profile_1(void **state)
{
    (void)state;
    check_drift(1);
}

static void test_drift_of_profile_2(void **state)
{
    (void)state;
    check_drift(2);
}

/* The increments that lead from row to row lead to the last row. The attitude is off by what each
 * of up to 17500 steps rounds, 2e-16, the same way on a straight road. The velocity is off because
 * positions are printed to 1e-5 m, and those of profile 2 leave the integral of the velocities by
 * 1e-4 m (its error-free rows in the published drift say so): gravity changes by 3e-6 m/s^2 per
 * metre, so by 5e-8 m/s in 175 s. */
static void test_increments_lead_to_the_end(void **state)
{
    (void)state;
    for (int number = 1; number <= 2; number++) {
        groves_profile profile;
        load_or_skip(number, &profile);
        imk_strapdown strapdown = imk_strapdown_start(&profile.start);
        strapdown.samples = 1;
        for (size_t k = 0; k < profile.count; k++)
            groves_step(&strapdown, &profile, profile.rate, profile.force, k);
        const imk_quaternion off = imk_quaternion_multiply(
            imk_quaternion_conjugate(profile.end.attitude), strapdown.state.attitude);
        CHECK_BELOW(2.0 * imk_vector3_norm((imk_vector3){{off.x, off.y, off.z}}), 4e-12);
        const imk_vector3 velocity =
            imk_vector3_subtract(strapdown.state.velocity, profile.end.velocity);
        CHECK_BELOW(imk_vector3_norm(velocity), 1e-7);
        print_message("profile %d: attitude %.1e rad, velocity %.1e m/s\n", number,
                      2.0 * imk_vector3_norm((imk_vector3){{off.x, off.y, off.z}}),
                      imk_vector3_norm(velocity));
        groves_free(&profile);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_drift_of_profile_1),
        cmocka_unit_test(test_drift_of_profile_2),
        cmocka_unit_test(test_increments_lead_to_the_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
