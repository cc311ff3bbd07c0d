/* SPDX-License-Identifier: Apache-2.0 */
/* Drift of the strapdown mechanisation on published truth profiles, beside the published drift of a
 * textbook implementation with the same deterministic errors.
 *
 * usage: groves_drift [directory of groves_profile_1.csv.gz and groves_reference_drift.csv]
 *
 * Prints, for each profile, grade and time, north, east and down of both, and the difference as a
 * fraction of the largest component. */
#include "../tests/navigate/groves_profiles.h"

#include <math.h>

static void print(int profile, const char *grade, const groves_published *rows,
                  const imk_vector3 *drift)
{
    for (size_t k = 0; k < rows->count; k++) {
        const double *p = rows->drift[k].v, *d = drift[k].v;
        double largest = 0.0, off = 0.0;
        for (int i = 0; i < 3; i++) {
            largest = fmax(largest, fabs(p[i]));
            off = fmax(off, fabs(d[i] - p[i]));
        }
        printf("%d %-8s %5.0f s  %12.4f %12.4f %12.4f  %12.4f %12.4f %12.4f  %8.4f %%\n", profile,
               grade, rows->after[k], d[0], d[1], d[2], p[0], p[1], p[2], 100.0 * off / largest);
    }
}

int main(int argc, char **argv)
{
    const char *directory = argc > 1 ? argv[1] : "../shared/data/navigation";
    char path[1024], reference[1024];
    snprintf(reference, sizeof reference, "%s/groves_reference_drift.csv", directory);
    printf("%-18s %38s  %38s  %10s\n", "profile, grade", "imukit N E D [m]", "published N E D [m]",
           "difference");
    for (int number = 1; number <= 2; number++) {
        groves_profile profile;
        snprintf(path, sizeof path, "%s/groves_profile_%d.csv.gz", directory, number);
        if (!groves_load(path, &profile)) {
            fprintf(stderr, "groves_drift: no profile in %s\n", path);
            return 1;
        }
        for (int i = 0; i < GROVES_GRADES; i++) {
            groves_published rows;
            imk_vector3 drift[GROVES_TIMES_MAX] = {{{0}}};
            if (!groves_read_published(reference, number, groves_grades[i].name, &rows) ||
                groves_distort(&profile, &groves_grades[i]) != IMK_OK) {
                fprintf(stderr, "groves_drift: no drift of %s in %s\n", groves_grades[i].name,
                        reference);
                return 1;
            }
            groves_drift(&profile, rows.count, rows.after, drift);
            print(number, groves_grades[i].name, &rows, drift);
        }
        groves_free(&profile);
    }
    return 0;
}
