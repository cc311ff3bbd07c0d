/* SPDX-License-Identifier: Apache-2.0 */
/* Memory that is given back all at once: alignment, growth, and an allocator that fails. */
#include "check.h"

#include "jobs/arena_internal.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef struct account {
    size_t pieces, calls, fail_at; /* fail_at 0: never */
} account;

static void *counted(void *context, void *at, size_t size)
{
    account *a = context;
    if (size == 0) {
        a->pieces -= at != NULL;
        free(at);
        return NULL;
    }
    if (++a->calls == a->fail_at)
        return NULL;
    a->pieces += at == NULL;
    return realloc(at, size);
}

static void test_pieces_do_not_touch(void **state)
{
    (void)state;
    account a = {0};
    imki_arena arena = {.allocator = {counted, &a}};
    unsigned char *piece[300];
    for (size_t i = 0; i < 300; i++) {
        const size_t size = 1 + i * i % 3000;
        piece[i] = imki_arena_take(&arena, size);
        assert_int_equal((uintptr_t)piece[i] % (size >= 256 ? 64 : 16), 0);
        for (size_t k = 0; k < size; k++) {
            assert_int_equal(piece[i][k], 0);
            piece[i][k] = (unsigned char)i;
        }
    }
    for (size_t i = 0; i < 300; i++)
        assert_int_equal(piece[i][i * i % 3000], (unsigned char)i);
    imki_arena_free(&arena);
    assert_int_equal(a.pieces, 0);
}

static void test_large_piece_leaves_the_shared_block_in_use(void **state)
{
    (void)state;
    account a = {0};
    imki_arena arena = {.allocator = {counted, &a}};
    imki_arena_take(&arena, 8);
    imki_arena_take(&arena, 1 << 20);
    imki_arena_take(&arena, 8);
    assert_int_equal(a.calls, 2);
    imki_arena_free(&arena);
}

static void test_array_grows(void **state)
{
    (void)state;
    imki_arena arena = {.blocks = NULL};
    int *values = NULL;
    for (int i = 0; i < 1000; i++) {
        values = imki_arena_extend(&arena, values, (size_t)i, sizeof *values);
        values[i] = i;
    }
    for (int i = 0; i < 1000; i++)
        assert_int_equal(values[i], i);
    imki_arena_free(&arena);
}

static void test_failure_is_remembered(void **state)
{
    (void)state;
    account a = {.fail_at = 2};
    imki_arena arena = {.allocator = {counted, &a}};
    assert_non_null(imki_arena_take(&arena, 100));
    assert_false(arena.failed);
    assert_null(imki_arena_take(&arena, 1 << 20));
    assert_true(arena.failed);
    assert_null(imki_arena_take(&arena, SIZE_MAX - 10));
    imki_arena_free(&arena);
    assert_int_equal(a.pieces, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pieces_do_not_touch),
        cmocka_unit_test(test_large_piece_leaves_the_shared_block_in_use),
        cmocka_unit_test(test_array_grows),
        cmocka_unit_test(test_failure_is_remembered),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
