/* SPDX-License-Identifier: Apache-2.0 */
/* imukit compensate MODEL --emit-c DIR: the correction as C code for the device. */
#include "compensate_parts.h"
#include "shell/growing_list.h"

#include "imukit/show.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define AT(field) offsetof(compensate_emission, field)

const option compensate_emit_options[COMPENSATE_EMIT_OPTIONS] = {
    {"emit-c", OPTION_FILE, AT(directory), .value = "DIR",
     .help = "write C99 code that corrects a sample: PREFIX.h, PREFIX.c, PREFIX_test.c"},
    {"arithmetic", OPTION_CHOICE, AT(arithmetic), .value = "KIND", .choices = "float|double|fixed",
     .help = "arithmetic of the code: float (default), double, or fixed: 32-bit integers, for "
             "parts without an FPU"},
    {"prefix", OPTION_TEXT, AT(prefix), .value = "NAME",
     .help = "prefix of its files and names; default: imukit_ and the name of the model"},
    {"vectors", OPTION_INTEGER, AT(vectors), .value = "N", .choices = "1-1000000",
     .help = "number of samples in its self-test, 1 to 1000000; default 64"},
};

static const char *const arithmetics[3] = {"float", "double", "fixed"};
static const char *const motions[2] = {"rate", "force"}, *const units[2] = {"rad/s", "m/s^2"};

/* The terms that the code leaves in although compensate takes them out of a log. @return how many
 */
static int warn_of_terms(const imk_term_keys *left_in)
{
    int count = 0;
    static const char *const needs_time[] = {"accel.lever_arm", "temperature_rate", "warm_up"};
    for (int i = 0; i < left_in->count; i++)
        for (size_t k = 0; k < sizeof needs_time / sizeof needs_time[0]; k++)
            if (strstr(left_in->key[i], needs_time[k])) {
                count++;
                command_warn("left_in",
                             "the code does not correct %s, which needs more than one sample; "
                             "imukit compensate LOG MODEL takes it out of a log",
                             left_in->key[i]);
            }
    return count;
}

static void show_files(const char *directory, const char *name, imk_result *result)
{
    static const char *const endings[3] = {".h", ".c", "_test.c"};
    imk_result_array(result, "files");
    for (int i = 0; i < 3; i++) {
        growing_list path = {0};
        list_add(&path, "%s/%s%s", directory, name, endings[i]);
        imk_result_text(result, NULL, path.text);
        list_free(&path);
    }
    imk_result_end(result);
}

/* The motion up to which the bound of every output holds. */
static double least_limit(const imk_firmware *plan, int sensor)
{
    double limit = (double)INFINITY;
    for (int j = 0; j < plan->output_count[sensor]; j++)
        limit = fmin(limit, plan->limit[sensor][j]);
    return limit;
}

static void show_cost(const imk_firmware *plan, imk_result *result)
{
    imk_result_object(result, "bound");
    for (int sensor = 0; sensor < 2; sensor++)
        if (plan->axis_count[sensor] > 0)
            imk_result_quantity(result, motions[sensor], plan->bound[sensor], units[sensor]);
    imk_result_end(result);
    imk_result_object(result, "limit");
    for (int sensor = 0; sensor < 2; sensor++)
        if (plan->axis_count[sensor] > 0)
            imk_result_quantity(result, motions[sensor], least_limit(plan, sensor), units[sensor]);
    imk_result_end(result);
    imk_result_object(result, "cost");
    imk_result_count(result, "multiplications", plan->cost.multiplications);
    imk_result_count(result, "additions", plan->cost.additions);
    imk_result_count(result, "comparisons", plan->cost.comparisons);
    imk_result_end(result);
}

/* Faster motion than a model states is flagged; whoever wrote the model should know. */
static void warn_of_ranges(const imk_firmware *plan)
{
    static const char *const names[2] = {"gyro", "accel"}, *const options[2] = {"rate", "force"};
    for (int sensor = 0; sensor < 2; sensor++)
        if (plan->axis_count[sensor] > 0 && !plan->limit_stated[sensor])
            command_warn("no_range",
                         "the model states no %s.range: the code sets its flag LIMIT beyond %.4g "
                         "%s; add the range to the model, or give --%s-limit",
                         names[sensor], least_limit(plan, sensor), units[sensor], options[sensor]);
}

static void show_summary(const char *directory, const char *name, const imk_firmware *plan,
                         imk_result *result)
{
    for (int sensor = 0; sensor < 2; sensor++)
        if (plan->axis_count[sensor] > 0)
            imk_result_line(result,
                            "The %s is within %.2g %s of the exact correction up to %.4g %s",
                            motions[sensor], plan->bound[sensor], units[sensor],
                            least_limit(plan, sensor), units[sensor]);
    imk_result_line(result, "%d multiplications, %d additions, %d comparisons a sample",
                    plan->cost.multiplications, plan->cost.additions, plan->cost.comparisons);
    imk_result_line(result,
                    "Wrote %s/%s.h, .c and _test.c. Next, for example:\n"
                    "    arm-none-eabi-gcc -mcpu=cortex-m4 -mfpu=fpv4-sp-d16 -mfloat-abi=hard -O2 "
                    "-c %s/%s.c",
                    directory, name, directory, name);
}

/* A bound that holds is no use without a term to correct.
 * @param left  terms that the code cannot correct */
static void judge(const imk_firmware *plan, const imk_term_keys *taken_out, int left,
                  imk_result *result)
{
    char text[200] = "", care[80] = "";
    bool stated = true;
    for (int sensor = 0; sensor < 2; sensor++) {
        const size_t used = strlen(text);
        if (plan->axis_count[sensor] == 0)
            continue;
        stated = stated && plan->limit_stated[sensor];
        (void)snprintf(text + used, sizeof text - used,
                       "%sthe %s is exact to %.2g %s up to %.4g %s", used > 0 ? ", " : "",
                       motions[sensor], plan->bound[sensor], units[sensor],
                       least_limit(plan, sensor), units[sensor]);
    }
    if (left > 0)
        (void)snprintf(care, sizeof care,
                       " with care, as it leaves in %d term%s that need%s more than one sample",
                       left, left == 1 ? "" : "s", left == 1 ? "s" : "");
    else if (!stated)
        (void)snprintf(care, sizeof care, " with care, as the model does not state every range");
    if (taken_out->count == 0)
        imk_result_judge(result, IMK_NOT_USABLE,
                         "Not usable: the model has no deterministic term that the code could take "
                         "out.");
    else
        imk_result_judge(result, care[0] ? IMK_USABLE_WITH_CARE : IMK_USABLE, "Usable%s: %s.", care,
                         text);
}

static int emit(const compensate_options *o, const char *model_name, const imk_model *model,
                const imk_model *whole, imk_firmware *plan)
{
    imk_error error;
    imk_term_keys taken_out, left_in;
    imk_firmware_settings settings = imk_firmware_default();
    imk_firmware_file_settings files = imk_firmware_file_default();
    char name[IMK_FIRMWARE_NAME_MAX];
    settings.arithmetic = (imk_firmware_arithmetic)o->emission.arithmetic;
    settings.rate_limit = o->settings.rate_limit;
    settings.force_limit = o->settings.force_limit;
    files.name = o->emission.prefix;
    files.vectors = (uint32_t)o->emission.vectors.value;
    if (imk_firmware_plan(plan, model, &settings, &error) != IMK_OK)
        return command_error(&error, model_name);
    imk_firmware_terms(plan, whole, &taken_out, &left_in);
    if (taken_out.count == 0)
        command_warn("nothing", "%s has no deterministic term: there is nothing to take out",
                     model_name);
    const int left = warn_of_terms(&left_in);
    warn_of_ranges(plan);
    if (imk_firmware_write(o->emission.directory, plan, whole, &files, &error) != IMK_OK)
        return command_error(&error, NULL);
    imk_firmware_name(&files, whole, name);
    imk_result *result = show_begin("compensate");
    imk_result_object(result, "inputs");
    imk_result_text(result, "model", model_name);
    imk_result_end(result);
    imk_result_object(result, "result");
    judge(plan, &taken_out, left, result);
    show_files(o->emission.directory, name, result);
    imk_result_text(result, "function", name);
    imk_result_text(result, "arithmetic", arithmetics[plan->arithmetic]);
    imk_result_count(result, "iterations", plan->iterations);
    show_cost(plan, result);
    imk_show_terms("taken_out", "Taken out", &taken_out, result);
    imk_show_terms("left_in", "Left in", &left_in, result);
    imk_result_end(result);
    show_summary(o->emission.directory, name, plan, result);
    return compensate_end(o, result);
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
    imk_model *models = command_memory(NULL, 2 * sizeof *models);
    imk_firmware *plan = command_memory(NULL, sizeof *plan);
    code = compensate_models(o, operands[0], &models[1], &models[0]);
    if (code < 0)
        code = emit(o, operands[0], &models[0], &models[1], plan);
    free(models);
    free(plan);
    return code;
}
