/* SPDX-License-Identifier: Apache-2.0 */
/* Names of terms between commas, with or without blanks; the names themselves are a matter of
 * imk_model_select(). */
#include "term_selection.h"

#include <string.h>

const option term_options[TERM_OPTIONS] = {
    {"only", OPTION_TEXT, offsetof(term_selection, only), .value = "TERMS",
     .help =
         "use only these terms of the model, such as angle_random_walk,scale_factor or gyro.bias"},
    {"without", OPTION_TEXT, offsetof(term_selection, without), .value = "TERMS",
     .help = "use all terms of the model except these"},
};

enum { TERMS_MAX = 64 };

/* "a, b" -> two texts in `storage`. @return how many, or -1 for too many */
static int split(char *storage, const char **names)
{
    int count = 0;
    for (char *name = strtok(storage, ", "); name; name = strtok(NULL, ", ")) {
        if (count == TERMS_MAX)
            return -1;
        names[count++] = name;
    }
    return count;
}

static int apply(const char *option_name, const char *list, bool keep, imk_model *model)
{
    char storage[1024];
    const char *names[TERMS_MAX];
    imk_error error;
    snprintf(storage, sizeof storage, "%s", list);
    int count = strlen(list) < sizeof storage ? split(storage, names) : -1;
    if (count <= 0)
        return command_misused("--%s %s: expected names of terms between commas", option_name,
                               list);
    if (imk_model_select(model, keep, (size_t)count, names, &error) != IMK_OK) {
        char text[600];
        imk_error_text(&error, NULL, text, sizeof text);
        return command_misused("--%s: %s", option_name, text);
    }
    return -1;
}

int term_selection_apply(const term_selection *selection, imk_model *model)
{
    if (selection->only && selection->without)
        return command_misused("--only and --without exclude each other");
    if (selection->only)
        return apply("only", selection->only, true, model);
    if (selection->without)
        return apply("without", selection->without, false, model);
    return -1;
}
