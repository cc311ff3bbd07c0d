/* SPDX-License-Identifier: Apache-2.0 */
/* Text that grows in memory: whole whatever the length of a piece, and none where memory failed. */
#include "check.h"

#include "report/growing_text_internal.h"

#include <stdlib.h>
#include <string.h>

static void pieces_of_any_length_are_whole(void **state)
{
    (void)state;
    enum { LENGTH = 20000 };
    imki_text text = {.bytes = NULL};
    char *piece = malloc(LENGTH + 1);
    assert_non_null(piece);
    memset(piece, 'x', LENGTH);
    piece[LENGTH] = '\0';
    for (size_t length = 0; length <= LENGTH; length = length * 3 + 1) {
        const size_t before = text.size;
        imki_text_add(&text, "<%.*s>", (int)length, piece);
        assert_int_equal(text.size, before + length + 2);
        assert_int_equal(strlen(text.bytes), text.size);
        assert_memory_equal(text.bytes + before + 1, piece, length);
        assert_int_equal(text.bytes[text.size - 1], '>');
    }
    size_t size;
    char *taken = imki_text_take(&text, &size);
    assert_int_equal(size, strlen(taken));
    free(taken);
    free(piece);
}

static void what_has_failed_is_not_taken(void **state)
{
    (void)state;
    imki_text text = {.bytes = NULL};
    size_t size = 7;
    imki_text_put(&text, "some words");
    text.failed = true;
    imki_text_put(&text, "and more");
    imki_text_add(&text, "%d", 5);
    assert_int_equal(text.size, strlen("some words"));
    assert_null(imki_text_take(&text, &size));
    assert_int_equal(size, 7);
}

static void nothing_is_a_text_too(void **state)
{
    (void)state;
    imki_text text = {.bytes = NULL};
    size_t size = 7;
    imki_text_put(&text, "");
    char *taken = imki_text_take(&text, &size);
    assert_string_equal(taken, "");
    assert_int_equal(size, 0);
    free(taken);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pieces_of_any_length_are_whole),
        cmocka_unit_test(what_has_failed_is_not_taken),
        cmocka_unit_test(nothing_is_a_text_too),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
