/* SPDX-License-Identifier: Apache-2.0 */
/* The output stage of sensors side by side for any machine, and the choice among instruction sets.
 */
#include "sensor_kernel.h"

COMPILE_FOR(portable, )

bool imki_sensor_output(const imk_sensor *s, size_t channel, size_t first, const double *noise,
                        size_t count, double *y)
{
#if defined(__x86_64__) && defined(__GNUC__)
    if (s->random.kernel == IMK_KERNEL_AVX512)
        return imki_sensor_output_avx512(s, channel, first, noise, count, y);
    if (s->random.kernel == IMK_KERNEL_AVX2)
        return imki_sensor_output_avx2(s, channel, first, noise, count, y);
#endif
    return imki_sensor_output_portable(s, channel, first, noise, count, y);
}
