/* SPDX-License-Identifier: Apache-2.0 */
/* The circle about the origin that holds a given part of a normal distribution in the plane. */
#ifndef IMUKI_DRIFT_RADIUS_INTERNAL_H
#define IMUKI_DRIFT_RADIUS_INTERNAL_H

/* In the axes of the ellipse: independent, major >= minor >= 0. */
typedef struct imki_ellipse {
    double mean_major, mean_minor;
    double major, minor; /* 1 sigma */
} imki_ellipse;

imki_ellipse imki_ellipse_of(double mean_x, double mean_y, double xx, double xy, double yy);
/* Probability of a distance of at most `radius`; absolute error below 1e-12. */
double imki_ellipse_probability(const imki_ellipse *ellipse, double radius);
/* Radius of a probability in (0, 1); relative error below 1e-10. NaN when the ellipse has one. */
double imki_ellipse_radius(const imki_ellipse *ellipse, double probability);

#endif
