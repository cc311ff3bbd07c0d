/* SPDX-License-Identifier: Apache-2.0 */
/* Arguments of a function as the words of a command line: operands first, then options and their
 * values, 'gyro_unit', 'deg/s' as --gyro-unit=deg/s. Numbers are in SI units. */
#include "gateway.h"

#include "shell/command.h"

#include "imukit/names.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { OPTIONS_MAX = 128 };

static bool add_word(char *word)
{
    gateway_call *call = gateway_now();
    if (call->count == GATEWAY_WORDS_MAX) {
        free(word);
        return gateway_refuse("there are too many arguments");
    }
    call->word[call->count++] = word;
    return true;
}

/* "--name=value", or "--name" where value is NULL. */
static bool add_option(const char *name, const char *value)
{
    char *word = malloc(strlen(name) + (value ? strlen(value) : 0) + 4);
    if (!word)
        voice_end(1);
    sprintf(word, "--%s%s%s", name, value ? "=" : "", value ? value : "");
    return add_word(word);
}

/* ---- texts ----------------------------------------------------------------------------------- */

static char *one_text(const mxArray *value)
{
    const bool row = value && mxIsChar(value) && (mxGetM(value) == 1 || mxIsEmpty(value)) &&
                     mxGetNumberOfDimensions(value) == 2;
    char *text = row ? mxArrayToString(value) : NULL;
    return text && strlen(text) == mxGetN(value) ? text : NULL;
}

char *gateway_text(const mxArray *value)
{
    if (!mxIsCell(value))
        return one_text(value);
    if (mxIsEmpty(value))
        return NULL;
    size_t size = 1, length = 0;
    char *joined = mxMalloc(1);
    *joined = '\0';
    for (size_t i = 0; i < mxGetNumberOfElements(value); i++) {
        const char *text = one_text(mxGetCell(value, i));
        if (!text)
            return NULL;
        size += strlen(text) + 1;
        joined = mxRealloc(joined, size);
        length += (size_t)sprintf(joined + length, "%s%s", i > 0 ? "," : "", text);
    }
    return joined;
}

/* A model as the text of a file, or a struct that has one in its field `model`. @return NULL: it is
 * neither */
static const char *model_text(const mxArray *value)
{
    const bool made = mxIsStruct(value) && mxGetNumberOfElements(value) == 1;
    const mxArray *field = made ? mxGetField(value, 0, "model") : NULL;
    const char *text = field ? one_text(field) : one_text(value);
    const bool file = text && (strchr(text, '\n') || text[0] == '{');
    return file ? text : NULL;
}

/* ---- operands -------------------------------------------------------------------------------- */

static bool takes_models(void)
{
    return strncmp(gateway_now()->verb->operands, "MODEL", 5) == 0;
}

/* A file or a name; a model may be a text or a struct. */
static bool take_operand(const mxArray *value, size_t number)
{
    char name[32];
    const char *model = takes_models() ? model_text(value) : NULL;
    const char *text = model ? NULL : one_text(value);
    if (model) {
        snprintf(name, sizeof name, number > 0 ? "model-%zu.yaml" : "model.yaml", number + 1);
        char *path = gateway_write_text(name, model);
        return path && add_word(path);
    }
    if (!text || !*text)
        return takes_models()
                   ? gateway_refuse(
                         "expected a model: the name of a file or of imukit devices, the "
                         "text of a model file, or a result of imukit_identify or "
                         "imukit_calibrate with its field model")
                   : gateway_refuse("expected a log: the name of a file, or a matrix of readings "
                                    "and its sampling rate; this is %s",
                                    mxIsChar(value) ? mxIsEmpty(value) ? "an empty text"
                                                                       : "a text of several rows"
                                                    : mxGetClassName(value));
    if (strcmp(text, "-") == 0 || strncmp(text, "/dev/std", 8) == 0)
        return gateway_refuse("%s is standard input, which belongs to the prompt: name a file",
                              text);
    char *path = malloc(strlen(text) + 3);
    if (!path)
        voice_end(1);
    sprintf(path, "%s%s", text[0] == '-' ? "./" : "", text);
    return add_word(path);
}

static bool is_array(const mxArray *value)
{
    return value && (mxIsNumeric(value) || mxIsLogical(value));
}

/* The sampling rate behind an array; [] where there is a column time. */
static bool take_rate(const mxArray *value)
{
    char text[48];
    if (mxIsDouble(value) && mxIsEmpty(value))
        return true;
    gateway_now()->rate_taken = true;
    const bool number = mxIsNumeric(value) && !mxIsComplex(value) &&
                        mxGetNumberOfElements(value) == 1 && mxGetScalar(value) > 0 &&
                        isfinite(mxGetScalar(value));
    snprintf(text, sizeof text, "%.17gHz", number ? mxGetScalar(value) : 0);
    return number ? add_option("rate", text)
                  : gateway_refuse("the sampling rate is not a positive number [Hz]");
}

static const mxArray *find_columns(int count, const mxArray *const *arguments)
{
    for (int i = 2; i + 1 < count; i += 2) {
        const char *name = one_text(arguments[i]);
        if (name && strcmp(name, "columns") == 0)
            return arguments[i + 1];
    }
    return NULL;
}

/* "array.npy", or "array-2.npy" of the second of a cell array. */
static bool add_array(const mxArray *array, size_t number, size_t columns)
{
    char name[32] = "array.npy";
    if (number > 0)
        snprintf(name, sizeof name, "array-%zu.npy", number);
    char *path = gateway_write_array(name, array, columns);
    return path && add_word(path);
}

/* An array or a cell array of them, their rate and their columns. */
static bool add_arrays(const mxArray *arrays, const mxArray *rate, const char *names)
{
    size_t columns = 0;
    char *list = gateway_column_names(names, &columns);
    bool added = columns > 0 || gateway_refuse("'columns' names no column");
    const size_t count = mxIsCell(arrays) ? mxGetNumberOfElements(arrays) : 1;
    const size_t most = (size_t)gateway_now()->verb->operands_maximum;
    if (added && count > most)
        added = gateway_refuse("the cell array has %zu matrices: imukit_%s takes up to %zu", count,
                               gateway_now()->verb->name, most);
    for (size_t i = 0; added && i < count; i++) {
        const mxArray *array = mxIsCell(arrays) ? mxGetCell(arrays, i) : arrays;
        if (!is_array(array))
            added = gateway_refuse("element %zu of the cell array is no matrix: expected matrices "
                                   "only, or names of files only",
                                   i + 1);
        else
            added = add_array(array, mxIsCell(arrays) ? i + 1 : 0, columns);
    }
    gateway_now()->named_columns = true;
    added = added && add_option("columns", list) && take_rate(rate);
    free(list);
    return added;
}

/* A matrix, or a cell array of them.
 * @return how many arguments these are; 0: refused */
static int take_array(int count, const mxArray *const *arguments)
{
    const mxArray *columns = find_columns(count, arguments);
    const char *names = columns ? gateway_text(columns) : NULL;
    if (takes_models())
        return take_operand(arguments[0], 0); /* which says what it takes */
    if (count < 2 || one_text(arguments[1]))
        return gateway_refuse("the sampling rate is missing: write it behind the array, in Hz, or "
                              "[] where a column is the time");
    if (names)
        return add_arrays(arguments[0], arguments[1], names) ? 2 : 0;
    return gateway_refuse("%s: write 'columns', {'gyro_x', 'gyro_y', 'gyro_z'}, for instance, or "
                          "{'gyro', 'accel'} for six; units are SI unless a name states another, "
                          "'gyro_x [deg/s]'",
                          columns ? "'columns' is not a text or a cell array of texts"
                                  : "an array does not say what its columns are");
}

static int take_operands(int count, const mxArray *const *arguments)
{
    if (count == 0)
        return gateway_refuse(takes_models() ? "a model is missing" : "a log is missing");
    const mxArray *first = arguments[0];
    if (is_array(first) || (mxIsCell(first) && !mxIsEmpty(first) && is_array(mxGetCell(first, 0))))
        return take_array(count, arguments);
    if (!mxIsCell(first))
        return take_operand(first, 0);
    if (mxIsEmpty(first))
        return gateway_refuse("the cell array names no file");
    for (size_t i = 0; i < mxGetNumberOfElements(first); i++)
        if (is_array(mxGetCell(first, i)) && !takes_models())
            return gateway_refuse("element %zu of the cell array is a matrix: expected matrices "
                                  "only, or names of files only",
                                  i + 1);
    for (size_t i = 0; i < mxGetNumberOfElements(first); i++)
        if (!mxGetCell(first, i) || !take_operand(mxGetCell(first, i), i))
            return gateway_refuse("element %zu of the cell array is empty", i + 1);
    return 1;
}

/* ---- options --------------------------------------------------------------------------------- */

static const option *find_option(const char *name)
{
    const verb *v = gateway_now()->verb;
    for (size_t g = 0; g < GROUPS_MAX; g++)
        for (size_t i = 0; i < v->groups[g].count; i++)
            if (strcmp(v->groups[g].options[i].name, name) == 0)
                return &v->groups[g].options[i];
    return NULL;
}

/* Numbers as a list, each with the unit that options of texts need. @return false: refused */
static bool take_numbers(const option *o, const mxArray *value)
{
    static const struct {
        const char *name, *unit;
    } lists[] = {{"tau", ""}, {"times", "s"}, {"outage", "s"}};
    const size_t count = mxGetNumberOfElements(value);
    const char *unit = NULL;
    for (size_t k = 0; k < sizeof lists / sizeof lists[0]; k++)
        if (strcmp(o->name, lists[k].name) == 0)
            unit = lists[k].unit;
    if (!unit || !mxIsDouble(value) || count == 0)
        return gateway_refuse("'%s': expected %sa text, such as '%s'", o->name,
                              unit ? "numbers of class double, or " : "", o->value ? o->value : "");
    char *text = mxMalloc(count * 40), *end = text;
    for (size_t k = 0; k < count; k++)
        end += sprintf(end, "%s%.17g%s", k > 0 ? "," : "", mxGetPr(value)[k], unit);
    return add_option(o->name, text);
}

/* That of the option where it is an SI unit, which messages then have. */
static void si_unit(const option *o, char *text, size_t size)
{
    const imk_unit unit = imk_unit_of(o->unit);
    if (unit.scale == 1 && unit.offset == 0)
        snprintf(text, size, "%s", o->unit);
    else
        (void)imk_dimension_si(unit.dimension, text, size);
}

/* One number, in SI units where there is a unit. */
static bool take_number(const option *o, const mxArray *value)
{
    char unit[64] = "", text[128];
    const double x = mxGetNumberOfElements(value) == 1 ? mxGetScalar(value) : (double)NAN;
    if (!isfinite(x))
        return gateway_refuse("'%s': expected one finite number", o->name);
    if (o->kind == OPTION_INTEGER && mxIsClass(value, "uint64"))
        snprintf(text, sizeof text, "%llu", (unsigned long long)*(uint64_t *)mxGetData(value));
    else if (o->kind == OPTION_INTEGER && (x != floor(x) || x < 0 || x > 9007199254740992.0))
        return gateway_refuse("'%s': expected a whole number that is not negative, and as a double "
                              "not above 2^53",
                              o->name);
    else if (o->kind == OPTION_INTEGER)
        snprintf(text, sizeof text, "%.0f", x);
    else {
        if (o->kind == OPTION_QUANTITY)
            si_unit(o, unit, sizeof unit);
        snprintf(text, sizeof text, "%.17g%s%s", x, unit[0] ? " " : "", unit);
    }
    return add_option(o->name, text);
}

static bool take_flag(const option *o, const mxArray *value)
{
    const bool one = (mxIsLogical(value) || mxIsNumeric(value)) && !mxIsComplex(value) &&
                     mxGetNumberOfElements(value) == 1;
    const double x = one ? mxGetScalar(value) : (double)NAN;
    if (x != 0 && x != 1)
        return gateway_refuse("'%s': expected true or false", o->name);
    return x == 0 || add_option(o->name, NULL);
}

/* Texts, each with the option before it. */
static bool take_texts(const option *o, const mxArray *value)
{
    for (size_t i = 0; i < mxGetNumberOfElements(value); i++) {
        const char *text = one_text(mxGetCell(value, i));
        if (!text)
            return gateway_refuse("'%s': expected texts in the cell array", o->name);
        if (!add_option(o->name, text))
            return false;
    }
    return true;
}

static bool take_value(const option *o, const mxArray *value)
{
    const bool file = o->kind == OPTION_FILE || o->kind == OPTION_INTO;
    const char *model = file ? model_text(value) : NULL, *text;
    if (o->kind == OPTION_FLAG)
        return take_flag(o, value);
    if (model) {
        char name[64];
        snprintf(name, sizeof name, "%.40s.yaml", o->name);
        char *path = gateway_write_text(name, model);
        const bool added = path && add_option(o->name, path);
        free(path);
        return added;
    }
    if (o->kind == OPTION_TEXTS && mxIsCell(value))
        return take_texts(o, value);
    if (mxIsNumeric(value) && (mxIsComplex(value) || mxIsSparse(value)))
        return gateway_refuse("'%s': expected real numbers", o->name);
    if (mxIsNumeric(value) &&
        (o->kind == OPTION_INTEGER || o->kind == OPTION_QUANTITY || o->kind == OPTION_FRACTION))
        return take_number(o, value);
    if (mxIsNumeric(value))
        return take_numbers(o, value);
    text = gateway_text(value);
    if (!text)
        return gateway_refuse("'%s': expected %s", o->name,
                              o->kind == OPTION_INTEGER || o->kind == OPTION_QUANTITY ||
                                      o->kind == OPTION_FRACTION
                                  ? "a number, or a text with a number and its unit"
                                  : "a text, or a cell array of texts");
    if ((o->kind == OPTION_OUTPUT || file) && strcmp(text, "-") == 0)
        return gateway_refuse("'%s': - is a stream of the command; name a file", o->name);
    return add_option(o->name, text);
}

/* Options of the command that have no meaning here. */
static bool is_left_out(const char *name)
{
    static const char *const always[] = {"json", "strict", "help", "plan"};
    static const char *const simulating[] = {"output", "runs", "format", "decimals"};
    static const char *const drifting[] = {"output", "shard"}; /* they catch signals */
    bool out = false;
    for (size_t k = 0; k < sizeof always / sizeof always[0]; k++)
        out = out || strcmp(name, always[k]) == 0;
    for (size_t k = 0; k < sizeof simulating / sizeof simulating[0]; k++)
        out = out || (gateway_now()->log_due && strcmp(name, simulating[k]) == 0);
    for (size_t k = 0; k < sizeof drifting / sizeof drifting[0]; k++)
        out = out || (gateway_now()->verb == &drift_verb && strcmp(name, drifting[k]) == 0);
    return out;
}

/* A name that no option has, in the words of the function. */
static bool refuse_name(const char *given)
{
    const verb *v = gateway_now()->verb;
    const char *names[OPTIONS_MAX];
    size_t count = 0;
    for (size_t g = 0; g < GROUPS_MAX; g++)
        for (size_t i = 0; i < v->groups[g].count && count < OPTIONS_MAX; i++)
            if (!is_left_out(v->groups[g].options[i].name))
                names[count++] = v->groups[g].options[i].name;
    const char *nearest = command_nearest(given, count, names);
    char meant[64];
    snprintf(meant, sizeof meant, "%s", nearest ? nearest : "");
    for (char *c = meant; *c; c++)
        *c = *c == '-' ? '_' : *c;
    return gateway_refuse("there is no option '%s'%s%s%s", given, nearest ? "; did you mean '" : "",
                          meant, nearest ? "'?" : "");
}

static bool take_option(const mxArray *given, const mxArray *value)
{
    const char *text = one_text(given);
    char name[64];
    if (!text || !*text || strlen(text) >= sizeof name)
        return gateway_refuse("expected the name of an option, such as 'rate', and its value");
    text += strncmp(text, "--", 2) == 0 ? 2 : 0;
    snprintf(name, sizeof name, "%s", text);
    for (char *c = name; *c; c++)
        *c = *c == '_' ? '-' : (char)tolower((unsigned char)*c);
    if (gateway_now()->named_columns && strcmp(name, "columns") == 0)
        return true;
    if (is_left_out(name))
        return gateway_refuse("'%s' is an option of the command only", name);
    const option *o = find_option(name);
    if (!o)
        return refuse_name(one_text(given));
    if (gateway_now()->rate_taken && strcmp(name, "rate") == 0)
        return gateway_refuse("the sampling rate is given twice, behind the array and as 'rate': "
                              "leave one out");
    if (!value)
        return gateway_refuse("'%s' has no value: options come in pairs of name and value", name);
    return take_value(o, value);
}

/* The number of an option that was taken [SI]; 0: it is not there, or no such number. */
static double taken_number(const char *start, const char *unit)
{
    const gateway_call *call = gateway_now();
    const size_t length = strlen(start);
    double value = 0, sigma;
    size_t count;
    for (int i = 2; i < call->count; i++)
        if (strncmp(call->word[i], start, length) == 0) {
            const char *text = call->word[i] + length;
            if (imk_quantity_parse(text, text + strlen(text), imk_unit_of(unit).dimension, 1,
                                   &value, &sigma, &count, NULL, NULL) != IMK_OK)
                value = 0;
        }
    return value;
}

/* The log that a simulation writes: in the temporary folder, if there is room for the time and the
 * three columns that every log has at least. */
static bool take_log(void)
{
    const double rows = taken_number("--rate=", "Hz") * taken_number("--duration=", "s");
    if (!gateway_has_room(rows * 4 * sizeof(double)))
        return false;
    char *path = gateway_file(GATEWAY_LOG);
    const bool added = path && add_option("output", path);
    free(path);
    return added;
}

bool gateway_take(int count, const mxArray *const *arguments)
{
    gateway_call *call = gateway_now();
    call->log_due = strcmp(call->verb->name, "simulate") == 0;
    (void)add_word(gateway_copy("imukit"));
    (void)add_word(gateway_copy(call->verb->name));
    int taken = take_operands(count, arguments);
    if (taken == 0)
        return false;
    for (; taken < count; taken += 2)
        if (!take_option(arguments[taken], taken + 1 < count ? arguments[taken + 1] : NULL))
            return false;
    if (!add_option("json", NULL))
        return false;
    return !call->log_due || take_log();
}
