/* SPDX-License-Identifier: Apache-2.0 */
/* Streams of standard normals: which kernel draws them, and how any range is made of groups. */
#include "normals_internal.h"

#include <string.h>

/* Where there are several kernels, and an environment to choose one. */
#if __STDC_HOSTED__ && (defined(__x86_64__) || defined(__aarch64__))
#define HAS_KERNELS
#include <stdlib.h>
#endif

const char *imk_kernel_name(imk_kernel kernel)
{
    switch (kernel) {
    case IMK_KERNEL_SCALAR:
        return "scalar";
    case IMK_KERNEL_AVX2:
        return "avx2";
    case IMK_KERNEL_AVX512:
        return "avx512";
    case IMK_KERNEL_NEON:
        return "neon";
    }
    return "unknown";
}

#ifdef HAS_KERNELS
static int machine_has(imk_kernel kernel)
{
#ifdef __x86_64__
    if (kernel == IMK_KERNEL_AVX2)
        return __builtin_cpu_supports("avx2");
    if (kernel == IMK_KERNEL_AVX512)
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq");
    return kernel == IMK_KERNEL_SCALAR;
#else
    return kernel == IMK_KERNEL_SCALAR || kernel == IMK_KERNEL_NEON;
#endif
}
#endif

imk_random imk_random_seeded(uint64_t seed)
{
    imk_random source = {seed, IMK_KERNEL_SCALAR};
#ifdef HAS_KERNELS
    /* In the order of preference. */
    static const imk_kernel kernels[] = {IMK_KERNEL_AVX512, IMK_KERNEL_AVX2, IMK_KERNEL_NEON,
                                         IMK_KERNEL_SCALAR};
    const size_t count = sizeof kernels / sizeof *kernels;
    const char *requirement = getenv("IMUKIT_ISA");
    for (size_t i = count; i-- > 0;) {
        if (!machine_has(kernels[i]))
            continue;
        source.kernel = kernels[i];
        if (requirement && strcmp(requirement, imk_kernel_name(kernels[i])) == 0)
            break;
    }
#endif
    return source;
}

uint64_t imk_stream(uint32_t run, uint16_t term, uint8_t instance, uint8_t axis)
{
    return (uint64_t)run << 32 | (uint64_t)term << 16 | (uint64_t)instance << 8 | axis;
}

static imki_draw_groups *groups_of(imk_kernel kernel)
{
    switch (kernel) {
#if defined(HAS_KERNELS) && defined(__x86_64__)
    case IMK_KERNEL_AVX2:
        return imki_draw_groups_avx2;
    case IMK_KERNEL_AVX512:
        return imki_draw_groups_avx512;
#elif defined(HAS_KERNELS)
    case IMK_KERNEL_NEON:
        return imki_draw_groups_neon;
#endif
    default:
        return imki_draw_groups_scalar;
    }
}

void imki_random_draws(imk_random source, const imki_draw *draws, size_t count)
{
    groups_of(source.kernel)(source.seed, draws, count);
}

/* Part of one group, through a buffer. */
static void draw_part(imki_draw_groups *draw, uint64_t seed, uint64_t stream, uint64_t group,
                      size_t skip, size_t count, double *out)
{
    double normals[IMKI_GROUP_NORMALS];
    draw(seed, &(imki_draw){stream, group, 1, normals}, 1);
    memcpy(out, normals + skip, count * sizeof *out);
}

void imk_random_normals(imk_random source, uint64_t stream, uint64_t first, size_t count,
                        double *out)
{
    /* Groups whose blocks have the same upper half of their number, as the kernels require. */
    const uint64_t period = (UINT64_C(1) << 32) / IMKI_GROUP_BLOCKS;
    imki_draw_groups *draw = groups_of(source.kernel);
    uint64_t group = first / IMKI_GROUP_NORMALS;
    const size_t skip = first % IMKI_GROUP_NORMALS;
    if (skip > 0 && count > 0) {
        const size_t left = IMKI_GROUP_NORMALS - skip;
        const size_t used = count < left ? count : left;
        draw_part(draw, source.seed, stream, group++, skip, used, out);
        out += used;
        count -= used;
    }
    while (count >= IMKI_GROUP_NORMALS) {
        const uint64_t left = period - group % period;
        const size_t whole = count / IMKI_GROUP_NORMALS;
        const size_t groups = whole < left ? whole : (size_t)left;
        draw(source.seed, &(imki_draw){stream, group, groups, out}, 1);
        group += groups;
        out += groups * IMKI_GROUP_NORMALS;
        count -= groups * IMKI_GROUP_NORMALS;
    }
    if (count > 0)
        draw_part(draw, source.seed, stream, group, 0, count, out);
}
