/* SPDX-License-Identifier: Apache-2.0 */
/* Properties of model files over random models:
 *   - reading what was written gives the same model, bit for bit, sigmas and evidence included;
 *   - writing what was read gives the same text;
 *   - a document edited towards another model says that model;
 *   - no text makes the reader misbehave, and what it takes it can write. */
#include "check.h"
#include "io/random_model.h"

#include "imukit/io.h"
#include "io/model/model_yaml_internal.h"

#include <stdlib.h>

enum { MODELS = 1000, EDITS = 150, MUTATIONS = 3000 };

static void assert_same(const imk_model *a, const imk_model *b, const char *text)
{
    imki_item item;
    for (size_t i = 0; imki_item_at(i, &item); i++)
        if (!imki_item_equal(&item, a, b))
            fail_msg("%s differs in\n%s", item.path, text);
    assert_true(imk_model_equal(a, b));
}

static void parse(const char *text, size_t size, imk_model *model, imk_document **document)
{
    imk_error error;
    if (imk_model_parse(text, size, model, document, &error) != IMK_OK) {
        char message[512];
        imk_error_text(&error, NULL, message, sizeof message);
        fail_msg("%s in\n%s", message, text);
    }
}

static void written_model_reads_back(void **state)
{
    (void)state;
    uint64_t seed = 1;
    for (int i = 0; i < (int)check_runs(MODELS); i++) {
        imk_model model = random_model(&seed, 1 + i % 5, true), back;
        imk_error error;
        char *text = NULL, *again = NULL;
        size_t size, again_size;
        if (imk_model_validate(&model, &error) != IMK_OK)
            fail_msg("model %d: %s: %s %g", i, error.field, error.expected, error.value);
        bool is_json = i % 4 == 3;
        CHECK_OK(is_json ? imk_model_print_json(&model, NULL, &text, &size, NULL)
                         : imk_model_print(&model, NULL, &text, &size, NULL));
        parse(text, size, &back, NULL);
        assert_same(&model, &back, text);
        CHECK_OK(is_json ? imk_model_print_json(&back, NULL, &again, &again_size, NULL)
                         : imk_model_print(&back, NULL, &again, &again_size, NULL));
        assert_int_equal(size, again_size);
        assert_memory_equal(text, again, size);
        free(text);
        free(again);
    }
}

static void edited_document_says_the_other_model(void **state)
{
    (void)state;
    uint64_t seed = 2;
    for (int i = 0; i < (int)check_runs(EDITS); i++) {
        imk_model model = random_model(&seed, 1 + i % 8, i % 3 == 0), back;
        imk_model other = random_model(&seed, 1 + i % 8, i % 3 == 0);
        imk_document *document = NULL;
        char *text = NULL, *edited = NULL;
        size_t size, edited_size;
        CHECK_OK(i % 4 == 3 ? imk_model_print_json(&model, NULL, &text, &size, NULL)
                            : imk_model_print(&model, NULL, &text, &size, NULL));
        parse(text, size, &back, &document);
        CHECK_OK(imk_model_print(&other, document, &edited, &edited_size, NULL));
        parse(edited, edited_size, &back, NULL);
        assert_same(&other, &back, edited);
        free(text);
        free(edited);
        imk_document_free(document);
    }
}

/* One field at a time: every line of the text but one stays. */
static void one_change_leaves_the_other_lines(void **state)
{
    (void)state;
    uint64_t seed = 3;
    for (int i = 0; i < (int)check_runs(EDITS); i++) {
        imk_model model = random_model(&seed, 2, false), back;
        model.gyro.present = true;
        imk_document *document = NULL;
        char *text = NULL, *edited = NULL;
        size_t size, edited_size;
        CHECK_OK(imk_model_print(&model, NULL, &text, &size, NULL));
        parse(text, size, &back, &document);
        model.gyro.bias.fixed.value[i % 3] += 1.5;
        CHECK_OK(imk_model_print(&model, document, &edited, &edited_size, NULL));
        parse(edited, edited_size, &back, NULL);
        assert_same(&model, &back, edited);
        size_t head = 0, tail = 0;
        while (head < size && head < edited_size && text[head] == edited[head])
            head++;
        while (tail < size - head && tail < edited_size - head &&
               text[size - 1 - tail] == edited[edited_size - 1 - tail])
            tail++;
        /* What differs is within one line, or is one new line with its new group. */
        size_t removed_lines = 0, added_lines = 0;
        for (size_t k = head; k < size - tail; k++)
            removed_lines += text[k] == '\n';
        for (size_t k = head; k < edited_size - tail; k++)
            added_lines += edited[k] == '\n';
        assert_int_equal(removed_lines, 0);
        assert_true(added_lines <= 2);
        free(text);
        free(edited);
        imk_document_free(document);
    }
}

static void mutated_text_does_no_harm(void **state)
{
    (void)state;
    static const char pool[] = "[]{}:,-#&*!|>'\"%@ \t\n0159.e±udeghzs/()^_";
    uint64_t seed = 4;
    int accepted = 0;
    imk_model model = random_model(&seed, 3, false);
    char *text = NULL;
    size_t size;
    CHECK_OK(imk_model_print(&model, NULL, &text, &size, NULL));
    char *mutated = malloc(size + 1);
    assert_non_null(mutated);
    for (int i = 0; i < (int)check_runs(MUTATIONS); i++) {
        memcpy(mutated, text, size);
        for (int j = random_below(&seed, 3); j >= 0; j--)
            mutated[random_below(&seed, (int)size)] = pool[random_below(&seed, sizeof pool - 1)];
        imk_document *document = NULL;
        imk_model back;
        imk_error error = {.status = IMK_OK};
        imk_status status = imk_model_parse(mutated, size, &back, &document, &error);
        assert_int_equal(status, error.status);
        if (status != IMK_OK)
            continue;
        char *written = NULL;
        size_t written_size;
        accepted++;
        CHECK_OK(imk_model_print(&model, document, &written, &written_size, NULL));
        free(written);
        imk_document_free(document);
    }
    /* digits and comments may change; of few mutations all may hit something else */
    assert_true(check_quick() || accepted > (int)check_runs(MUTATIONS) / 50);
    free(mutated);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(written_model_reads_back),
        cmocka_unit_test(edited_document_says_the_other_model),
        cmocka_unit_test(one_change_leaves_the_other_lines),
        cmocka_unit_test(mutated_text_does_no_harm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
