/* SPDX-License-Identifier: Apache-2.0 */
/* The output stage of sensors side by side for any machine, and the choice among instruction sets.
 */
#include "sensor_kernel.h"

COMPILE_FOR(portable, )

bool imki_sensor_output(imk_kernel kernel, const imki_output *output, size_t count, double *y)
{
#if defined(__x86_64__) && defined(__GNUC__)
    if (kernel == IMK_KERNEL_AVX512)
        return imki_sensor_output_avx512(output, count, y);
    if (kernel == IMK_KERNEL_AVX2)
        return imki_sensor_output_avx2(output, count, y);
#else
    (void)kernel;
#endif
    return imki_sensor_output_portable(output, count, y);
}
