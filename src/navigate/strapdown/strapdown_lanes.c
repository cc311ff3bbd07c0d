/* SPDX-License-Identifier: Apache-2.0 */
/* Eight mechanisations side by side. Lanes are worked on by as many as the kernel takes at once;
 * each group goes through all samples and leaves the block where the others do. */
#include "strapdown_block_internal.h"

#include "strapdown_internal.h"

enum { LANES = IMK_STRAPDOWN_LANES };

void imk_strapdown_lanes_start(imk_strapdown_lanes *lanes, size_t lane,
                               const imk_navigation_state *state, bool hold_height)
{
    imk_navigation_state start = *state;
    start.attitude = imk_quaternion_normalise(state->attitude);
    imki_block_enter(&lanes->carried[0][lane], LANES, &start,
                     imk_geodetic_from_ecef(state->position).height, 0.0);
    lanes->block = (imk_strapdown_block){.taken = 0};
    lanes->hold_height = hold_height;
}

static void copy_lane(const imk_strapdown_lanes *lanes, size_t lane, double carried[IMKI_ROWS])
{
    for (size_t row = 0; row < IMKI_ROWS; row++)
        carried[row] = lanes->carried[row][lane];
}

imk_navigation_state imk_strapdown_lanes_state(const imk_strapdown_lanes *lanes, size_t lane)
{
    double carried[IMKI_ROWS];
    imk_strapdown_block block = lanes->block;
    copy_lane(lanes, lane, carried);
    imki_block_complete(carried, &block, lanes->hold_height);
    return imki_block_state(carried);
}

static void complete_all(imk_strapdown_lanes *lanes)
{
    for (size_t lane = 0; lane < LANES; lane++) {
        double carried[IMKI_ROWS];
        imk_strapdown_block block = lanes->block;
        copy_lane(lanes, lane, carried);
        imki_block_complete(carried, &block, lanes->hold_height);
        for (size_t row = 0; row < IMKI_ROWS; row++)
            lanes->carried[row][lane] = carried[row];
    }
    lanes->block.taken = 0;
}

typedef struct lane_kernel {
    imki_block_kernel *run;
    size_t width;
} lane_kernel;

static lane_kernel kernel_of(imk_kernel kernel)
{
#if defined(__x86_64__) && defined(__GNUC__)
    if (kernel == IMK_KERNEL_AVX512)
        return (lane_kernel){imki_block_run_avx512, 8};
    if (imki_block_has_fma(kernel))
        return (lane_kernel){imki_block_run_avx2, 4};
#endif
    (void)kernel;
    return (lane_kernel){imki_block_run_portable, 1};
}

void imk_strapdown_lanes_run(imk_strapdown_lanes *lanes, imk_kernel kernel, size_t count, double dt,
                             const double *const channel[][6], const double *height,
                             const double *climb)
{
    if (count == 0)
        return;
    if (lanes->block.taken > 0 && lanes->block.step != dt)
        complete_all(lanes);
    const lane_kernel use = kernel_of(kernel);
    imk_strapdown_block block = lanes->block;
    imki_block_run run =
        imki_block_run_of(NULL, LANES, &block, lanes->hold_height, count, dt, NULL, height, climb);
    const imk_strapdown_block begin = block;
    for (size_t lane = 0; lane < LANES; lane += use.width) {
        block = begin;
        run.carried = &lanes->carried[0][lane];
        run.channel = channel + lane;
        use.run(&run);
    }
    lanes->block = block;
}

size_t imki_lanes_heights(const imk_strapdown_lanes *lanes, double dt, size_t count, size_t *sample)
{
    const size_t size = imki_block_size(dt);
    const size_t taken = lanes->block.step == dt ? lanes->block.taken : 0;
    size_t used = 0;
    if (count == 0)
        return 0;
    for (size_t k = size - taken - 1; k + 1 < count; k += size)
        sample[used++] = k;
    sample[used++] = count - 1;
    return used;
}
