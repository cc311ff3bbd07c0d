/* SPDX-License-Identifier: Apache-2.0 */
/* Golden-section search: each section shrinks the bracket to 0.618 of itself at the cost of one
 * evaluation [KIEFER1953]. */
#include "identify_internal.h"

double imki_peak(imki_height height, void *context, double low, double high, int sections)
{
    const double golden = 0.6180339887498949; /* (sqrt(5) - 1)/2 */
    double a = high - golden * (high - low), b = low + golden * (high - low);
    double at_a = height(context, a), at_b = height(context, b);
    for (int i = 0; i < sections; i++) {
        if (at_a > at_b) {
            high = b;
            b = a;
            at_b = at_a;
            a = high - golden * (high - low);
            at_a = height(context, a);
        } else {
            low = a;
            a = b;
            at_a = at_b;
            b = low + golden * (high - low);
            at_b = height(context, b);
        }
    }
    return 0.5 * (low + high);
}
