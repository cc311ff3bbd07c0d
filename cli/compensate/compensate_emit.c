/* SPDX-License-Identifier: Apache-2.0 */
/* imukit compensate MODEL --emit-c DIR: the correction as C code for the device. */
#include "compensate_parts.h"
#include "shell/json_output.h"

#include "imukit/firmware_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const option compensate_emit_options[COMPENSATE_EMIT_OPTIONS] = {
    {"emit-c", 0, OPTION_FILE, "DIR", NULL, NULL,
     "write C99 code that corrects a sample: PREFIX.h, PREFIX.c, PREFIX_test.c",
     offsetof(compensate_emission, directory)},
    {"arithmetic", 0, OPTION_CHOICE, "KIND", NULL, "float|double|fixed",
     "of that code: float (default), double, or fixed: 32-bit integers, for parts without an FPU",
     offsetof(compensate_emission, arithmetic)},
    {"prefix", 0, OPTION_TEXT, "NAME", NULL, NULL,
     "of its files and names; default: imukit_ and the name of the model",
     offsetof(compensate_emission, prefix)},
    {"vectors", 0, OPTION_INTEGER, "N", NULL, "1-1000000",
     "samples in its self-test, 1 to 1000000; default 64", offsetof(compensate_emission, vectors)},
};

static const char *const arithmetics[3] = {"float", "double", "fixed"};
static const char *const motions[2] = {"rate", "force"}, *const units[2] = {"rad/s", "m/s^2"};

static void print_keys(const char *label, const imk_firmware_keys *keys)
{
    fprintf(stderr, "%s:", label);
    for (int i = 0; i < keys->count; i++)
        fprintf(stderr, "%s %s", i > 0 ? "," : "", keys->key[i]);
    fputs(keys->count > 0 ? "\n" : " nothing\n", stderr);
}

static json_t *json_keys(const imk_firmware_keys *keys)
{
    json_t *array = json_array();
    for (int i = 0; i < keys->count; i++)
        json_array_append_new(array, json_string(keys->key[i]));
    return array;
}

/* The terms that the code leaves in although compensate takes them out of a log. */
static void warn_of_terms(const imk_firmware_keys *left_in)
{
    static const char *const needs_time[] = {"accel.lever_arm", "temperature_rate", "warm_up"};
    for (int i = 0; i < left_in->count; i++)
        for (size_t k = 0; k < sizeof needs_time / sizeof needs_time[0]; k++)
            if (strstr(left_in->key[i], needs_time[k]))
                command_warn("left_in",
                             "%s stays in: it needs more than one sample; imukit compensate LOG "
                             "MODEL takes it out of a log",
                             left_in->key[i]);
}

static int print_json(const compensate_options *o, const imk_firmware *plan, const char *model_name,
                      const char *name, const imk_firmware_keys *taken_out,
                      const imk_firmware_keys *left_in)
{
    json_t *files = json_array(), *bound = json_object();
    static const char *const endings[3] = {".h", ".c", "_test.c"};
    const size_t size = strlen(o->emission.directory) + strlen(name) + 16;
    char *path = command_memory(NULL, size);
    for (int i = 0; i < 3; i++) {
        snprintf(path, size, "%s/%s%s", o->emission.directory, name, endings[i]);
        json_array_append_new(files, json_text(path));
    }
    free(path);
    for (int sensor = 0; sensor < 2; sensor++)
        if (plan->axis_count[sensor] > 0)
            json_object_set_new(bound, motions[sensor],
                                json_quantity(plan->bound[sensor], units[sensor]));
    json_t *cost =
        json_pack("{s:i, s:i, s:i}", "multiplications", plan->cost.multiplications, "additions",
                  plan->cost.additions, "comparisons", plan->cost.comparisons);
    json_t *result = json_pack(
        "{s:o, s:o, s:s, s:i, s:o, s:o, s:o, s:o}", "files", files, "function", json_text(name),
        "arithmetic", arithmetics[plan->arithmetic], "iterations", plan->iterations, "bound", bound,
        "cost", cost, "taken_out", json_keys(taken_out), "left_in", json_keys(left_in));
    return json_print("compensate", json_pack("{s:o}", "model", json_text(model_name)), result,
                      EXIT_DONE);
}

static void print_summary(const compensate_options *o, const imk_firmware *plan, const char *name)
{
    const char *directory = o->emission.directory;
    for (int sensor = 0; sensor < 2; sensor++)
        if (plan->axis_count[sensor] > 0)
            fprintf(stderr, "The %s is within %.2g %s of the exact correction%s\n", motions[sensor],
                    plan->bound[sensor], units[sensor],
                    plan->limit_stated[sensor] ? "" : " (no range is stated: of small motions)");
    fprintf(stderr, "%d multiplications, %d additions, %d comparisons a sample\n",
            plan->cost.multiplications, plan->cost.additions, plan->cost.comparisons);
    fprintf(stderr,
            "Wrote %s/%s.h, .c and _test.c. Next, for example:\n"
            "    arm-none-eabi-gcc -mcpu=cortex-m4 -mfpu=fpv4-sp-d16 -mfloat-abi=hard -O2 -c "
            "%s/%s.c\n",
            directory, name, directory, name);
}

static int emit(const compensate_options *o, const char *model_name, const imk_model *model,
                const imk_model *whole, imk_firmware *plan)
{
    imk_error error;
    imk_firmware_keys taken_out, left_in;
    imk_firmware_settings settings = imk_firmware_default();
    imk_firmware_file_settings files = imk_firmware_file_default();
    char name[IMK_FIRMWARE_NAME_MAX];
    settings.arithmetic = (imk_firmware_arithmetic)o->emission.arithmetic;
    settings.rate_limit = o->rate_limit;
    settings.force_limit = o->force_limit;
    files.name = o->emission.prefix;
    files.vectors = (uint32_t)o->emission.vectors.value;
    if (imk_firmware_plan(plan, model, &settings, &error) != IMK_OK)
        return command_error(&error, model_name);
    imk_firmware_terms(plan, whole, &taken_out, &left_in);
    if (taken_out.count == 0)
        command_warn("nothing", "%s has no deterministic term: there is nothing to take out",
                     model_name);
    warn_of_terms(&left_in);
    if (imk_firmware_write(o->emission.directory, plan, whole, &files, &error) != IMK_OK)
        return command_error(&error, NULL);
    imk_firmware_name(&files, whole, name);
    const int code = o->strict && command_warning_count() > 0 ? EXIT_FAILED : EXIT_DONE;
    if (o->json) {
        const int printed = print_json(o, plan, model_name, name, &taken_out, &left_in);
        return printed != EXIT_DONE ? printed : code;
    }
    print_keys("Taken out", &taken_out);
    print_keys("Left in", &left_in);
    print_summary(o, plan, name);
    return code;
}

static int check(const compensate_options *o, const char *second)
{
    if (second)
        return command_misused("--emit-c makes code from the model alone: imukit compensate MODEL "
                               "--emit-c DIR");
    if (o->output)
        return command_misused("--emit-c writes into its directory: leave --output out");
    return -1;
}

int compensate_emit(const compensate_options *o, const char *const *operands)
{
    int code = check(o, operands[1]);
    if (code >= 0)
        return code;
    imk_model *models = malloc(2 * sizeof *models);
    imk_firmware *plan = malloc(sizeof *plan);
    if (models && plan) {
        code = command_model(operands[0], &models[1], NULL);
        if (code < 0) {
            models[0] = models[1];
            code = compensate_select(o, &models[0]);
        }
        if (code < 0)
            code = emit(o, operands[0], &models[0], &models[1], plan);
    } else {
        code = command_failed("memory is exhausted");
    }
    free(models);
    free(plan);
    return code;
}
