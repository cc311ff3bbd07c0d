/* SPDX-License-Identifier: Apache-2.0 */
/* Bias polynomials for autopilots, which have cubics: up to the third order the same polynomial
 * about another temperature; beyond, the cubic of the first four terms of the Chebyshev series over
 * the valid range, which is close to the one of the smallest largest error [TREFETHEN2013, ch. 16].
 */
#include "parameter_internal.h"

#include <math.h>

enum { NODES = 64, PLACES = 200 };

static const double pi = 3.14159265358979323846;

static double value_at(const imk_temperature_polynomial *p, int axis, double temperature)
{
    const double d = temperature - p->reference;
    double sum = 0;
    for (int k = p->order - 1; k >= 0; k--)
        sum = (sum + p->coefficient[k].value[axis]) * d;
    return sum;
}

/* sum of c_k x^k with x = y + shift, as powers of y. */
static void move(double c[4], double shift)
{
    for (int i = 0; i < 3; i++)
        for (int k = 2; k >= i; k--)
            c[k] += shift * c[k + 1];
}

static void economise(const imk_temperature_polynomial *p, int axis, double centre, double c[4])
{
    const double middle = 0.5 * (p->maximum + p->minimum), half = 0.5 * (p->maximum - p->minimum);
    double a[4] = {0}, power = 1;
    for (int k = 0; k < NODES; k++) {
        const double angle = pi * (k + 0.5) / NODES;
        const double value = value_at(p, axis, middle + half * cos(angle));
        for (int j = 0; j < 4; j++)
            a[j] += (j == 0 ? 1.0 : 2.0) / NODES * value * cos(j * angle);
    }
    c[0] = a[0] - a[2];
    c[1] = a[1] - 3 * a[3];
    c[2] = 2 * a[2];
    c[3] = 4 * a[3];
    for (int k = 0; k < 4; k++, power *= half)
        c[k] /= power;
    move(c, centre - middle);
}

double imki_cubic(const imk_temperature_polynomial *polynomial, int axis, double centre,
                  double c[4])
{
    const imk_temperature_polynomial *p = polynomial;
    double worst = 0;
    for (int k = 0; k < 4; k++)
        c[k] = k > 0 && k <= p->order ? p->coefficient[k - 1].value[axis] : 0;
    if (p->order <= 3) {
        move(c, centre - p->reference);
        return 0;
    }
    economise(p, axis, centre, c);
    for (int i = 0; i <= PLACES; i++) {
        const double temperature = p->minimum + (p->maximum - p->minimum) * i / PLACES;
        const double d = temperature - centre;
        const double cubic = c[0] + d * (c[1] + d * (c[2] + d * c[3]));
        worst = fmax(worst, fabs(cubic - value_at(p, axis, temperature)));
    }
    return worst;
}
