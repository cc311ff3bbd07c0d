/* SPDX-License-Identifier: Apache-2.0 */
/* The one shape of the command's JSON. Numbers are written as the shortest decimals that read back
 * to the same double, which jansson's own writer cannot do. */
#include "json_output.h"

#include "imukit/utf8.h"

#include <math.h>
#include <stdlib.h>

static void *allocate(size_t size)
{
    return command_memory(NULL, size);
}

void json_begin(void)
{
    json_set_alloc_funcs(allocate, free);
}

json_t *json_number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

json_t *json_text(const char *text)
{
    const size_t size = imk_utf8_clean(text, NULL, 0) + 1;
    char *clean = command_memory(NULL, size);
    imk_utf8_clean(text, clean, size);
    json_t *made = json_string(clean);
    free(clean);
    return made;
}

json_t *json_quantity(double value, const char *unit)
{
    return json_pack("{s:o, s:o}", "value", json_number(value), "unit", json_text(unit));
}

static void put_scalar(const json_t *value)
{
    if (json_is_real(value)) {
        char text[IMK_DECIMAL_SIZE];
        text[imk_decimal_shortest(json_real_value(value), text)] = '\0';
        fputs(text, stdout);
        return;
    }
    char *text = json_dumps(value, JSON_ENCODE_ANY);
    fputs(text ? text : "null", stdout);
    free(text);
}

static void put_name(const char *name)
{
    json_t *text = json_text(name);
    put_scalar(text);
    json_decref(text);
    fputs(": ", stdout);
}

/* An object of scalars, such as a quantity, goes on one line. */
static bool is_flat(json_t *value)
{
    const char *key;
    json_t *member;
    json_object_foreach(value, key,
                        member) if (json_is_object(member) || json_is_array(member)) return false;
    return json_is_object(value) && json_object_size(value) <= 6;
}

static void put(json_t *value, int indent)
{
    bool object = json_is_object(value), flat = is_flat(value);
    const char *separator = "", *key;
    json_t *member;
    size_t index;
    if (!object && !json_is_array(value)) {
        put_scalar(value);
        return;
    }
    putchar(object ? '{' : '[');
    json_object_foreach(value, key, member)
    {
        if (flat)
            fputs(separator, stdout);
        else
            printf("%s\n%*s", separator, indent + 2, "");
        put_name(key);
        put(member, indent + 2);
        separator = flat ? ", " : ",";
    }
    json_array_foreach(value, index, member)
    {
        printf("%s\n%*s", separator, indent + 2, "");
        put(member, indent + 2);
        separator = ",";
    }
    if (*separator && !flat)
        printf("\n%*s", indent, "");
    putchar(object ? '}' : ']');
}

int json_print(const char *command, json_t *inputs, json_t *result, int code)
{
    json_t *warnings = json_array();
    for (size_t i = 0; i < command_warning_count(); i++) {
        const command_warning *warning = command_warning_get(i);
        json_array_append_new(warnings, json_pack("{s:s, s:o}", "code", warning->code, "message",
                                                  json_text(warning->message)));
    }
    json_t *document = json_pack("{s:s, s:s, s:o, s:o, s:o}", "imukit", IMK_VERSION, "command",
                                 command, "inputs", inputs, "result", result, "warnings", warnings);
    if (!document)
        return command_failed("the result is no valid JSON: a name in the log is no UTF-8");
    put(document, 0);
    putchar('\n');
    json_decref(document);
    return code;
}
