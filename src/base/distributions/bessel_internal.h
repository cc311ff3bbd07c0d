/* SPDX-License-Identifier: Apache-2.0 */
/* Bessel functions of the first kind and whole order. */
#ifndef IMUKI_BESSEL_INTERNAL_H
#define IMUKI_BESSEL_INTERNAL_H

/* J_n(x), |n| and |x| up to 1e6; absolute error below 1e-14 sqrt(1 + |x|). Time grows with |x|. */
double imki_bessel_j(int n, double x);

#endif
