/* SPDX-License-Identifier: Apache-2.0 */
/* Two model files compared line by line. */
#include "model_changes.h"

#include "command.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Lines of one text that the other does not hold. Of the correlations, hundreds of numbers that
 * change with every digit, only that they do. */
static void print_missing_lines(const char *text, const char *other, char sign)
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
            fprintf(stderr, "%c %.*s\n", sign, (int)length, text);
        else if (!found && !named)
            fprintf(stderr, "%c correlation: …\n", sign);
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
        fprintf(stderr, "Changes to %s:\n", path);
        print_missing_lines(old_text, new_text, '-');
        print_missing_lines(new_text, old_text, '+');
    }
    free(old_text);
    free(new_text);
}
