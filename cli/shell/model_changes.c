/* SPDX-License-Identifier: Apache-2.0 */
/* Two model files compared line by line. */
#include "model_changes.h"

#include "show.h"

#include <stdlib.h>
#include <string.h>

/* Lines of one text that the other does not hold. Of the correlations, hundreds of numbers that
 * change with every digit, only that they do. */
static void show_missing_lines(const char *text, const char *other, char sign, imk_result *result)
{
    bool correlations = false, named = false;
    while (*text) {
        size_t length = strcspn(text, "\n");
        if (length > 0 && *text != ' ')
            correlations = strncmp(text, "correlation:", 12) == 0;
        bool found = false;
        for (const char *line = other; *line && !found;) {
            size_t other_length = strcspn(line, "\n");
            found = other_length == length && strncmp(line, text, length) == 0;
            line += other_length + (line[other_length] == '\n');
        }
        if (!found && !correlations)
            imk_result_line(result, "%c %.*s", sign, (int)length, text);
        else if (!found && !named)
            imk_result_line(result, "%c correlation: …", sign);
        named = named || (!found && correlations);
        text += length + (text[length] == '\n');
    }
}

void model_print_changes(const char *path, const imk_model *before, const imk_model *after,
                         const imk_document *document)
{
    char *old_text = NULL, *new_text = NULL;
    size_t size;
    imk_error error;
    if (command_unless_memory(imk_model_print(before, document, &old_text, &size, &error)) ==
            IMK_OK &&
        command_unless_memory(imk_model_print(after, document, &new_text, &size, &error)) ==
            IMK_OK) {
        imk_result *result = show_begin("changes");
        imk_result_line(result, "Changes to %s:", path);
        show_missing_lines(old_text, new_text, '-', result);
        show_missing_lines(new_text, old_text, '+', result);
        show_aside(result);
        imk_result_free(result);
    }
    free(old_text);
    free(new_text);
}
