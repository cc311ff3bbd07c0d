/* SPDX-License-Identifier: Apache-2.0 */
/* Philox4x32-10, a random function of a counter and a key [SALMON2011]. Ten rounds of
 *
 *     {hi(M1 w2) ^ w1 ^ k0, lo(M1 w2), hi(M0 w0) ^ w3 ^ k1, lo(M0 w0)}
 *
 * where the key grows by (W0, W1) from round to round. */
#include "normals_internal.h"

#include <string.h>

void imk_philox4x32(const uint32_t counter[4], const uint32_t key[2], uint32_t out[4])
{
    uint32_t word[4] = {counter[0], counter[1], counter[2], counter[3]};
    uint32_t key0 = key[0], key1 = key[1];
    for (int i = 0; i < IMKI_PHILOX_ROUNDS; i++) {
        const uint64_t product0 = IMKI_PHILOX_M0 * word[0];
        const uint64_t product1 = IMKI_PHILOX_M1 * word[2];
        word[0] = (uint32_t)(product1 >> 32) ^ word[1] ^ key0;
        word[1] = (uint32_t)product1;
        word[2] = (uint32_t)(product0 >> 32) ^ word[3] ^ key1;
        word[3] = (uint32_t)product0;
        key0 += IMKI_PHILOX_W0;
        key1 += IMKI_PHILOX_W1;
    }
    memcpy(out, word, sizeof word);
}

void imk_random_words(imk_random source, uint64_t stream, uint64_t first, size_t count,
                      uint32_t *words)
{
    const uint32_t key[2] = {(uint32_t)source.seed, (uint32_t)(source.seed >> 32)};
    uint64_t block = first / IMKI_PHILOX_BLOCK;
    size_t skip = first % IMKI_PHILOX_BLOCK;
    while (count > 0) {
        const uint32_t counter[4] = {(uint32_t)block, (uint32_t)(block >> 32), (uint32_t)stream,
                                     (uint32_t)(stream >> 32)};
        uint32_t drawn[IMKI_PHILOX_BLOCK];
        imk_philox4x32(counter, key, drawn);
        const size_t left = IMKI_PHILOX_BLOCK - skip;
        const size_t used = count < left ? count : left;
        memcpy(words, drawn + skip, used * sizeof *words);
        words += used;
        count -= used;
        block++;
        skip = 0;
    }
}
