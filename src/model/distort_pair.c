/* SPDX-License-Identifier: Apache-2.0 */
/* What an axis reads over two samples: for a single sensor that is stepped. A vector of two lanes
 * costs what one sample would, with every instruction set. */
#define LANES 2
#define VECTORS 1
#include "distort_kernel.h"

void imki_distort_pair(const imk_axis_response *axis, const imki_exposure *exposure, double *out)
{
    distort_step(axis, exposure, 0, out);
}
