/* SPDX-License-Identifier: Apache-2.0 */
/* What a count of a digital part is: the look-up. */
#include "base/text_internal.h"
#include "device_sensitivity_internal.h"

#include "imukit/names.h"
#include "imukit/units.h"

#include <math.h>
#include <string.h>

/* Two texts of one range, as "24 g" and "235.3596 m/s^2", differ by a few roundings. */
static const double same_range = 1e-9;

/* Widths as they stand behind a name. */
static const struct {
    const char *text, *letters;
    int bits;
} widths[] = {{" 11-bit", "11bit", 11}, {" 16-bit", "16bit", 16}, {" 32-bit", "32bit", 32}};
enum { WIDTHS = sizeof widths / sizeof widths[0] };

typedef struct request {
    char part[64]; /* the name without a width */
    int bits;      /* 0: not stated */
    imk_count_kind kind;
    const char *range; /* NULL: not stated */
    imk_error *error;
} request;

static imk_dimension dimension_of(imk_count_kind kind)
{
    static const char *const units[IMK_COUNT_KINDS] = {"rad/s", "m/s^2", "K"};
    return imk_unit_of(units[kind]).dimension;
}

size_t imk_device_sensitivity_count(void)
{
    return imki_sensitivity_row_count;
}

static double range_of(const imki_sensitivity_row *row)
{
    double range = 0, sigma;
    size_t count;
    if (row->range[0])
        (void)imk_quantity_parse(row->range, row->range + strlen(row->range),
                                 dimension_of(row->kind), 1, &range, &sigma, &count, NULL, NULL);
    return range;
}

bool imk_device_sensitivity_get(size_t index, imk_device_sensitivity *sensitivity)
{
    if (index >= imki_sensitivity_row_count)
        return false;
    const imki_sensitivity_row *row = &imki_sensitivity_rows[index];
    *sensitivity = (imk_device_sensitivity){.part = row->part,
                                            .kind = row->kind,
                                            .bits = row->bits,
                                            .range = range_of(row),
                                            .stated = row->stated,
                                            .range_stated = row->range,
                                            .source = row->source};
    (void)imk_count_scale_parse(row->stated, row->stated + strlen(row->stated),
                                dimension_of(row->kind), &sensitivity->per_count, NULL);
    if (row->kind == IMK_COUNTS_TEMPERATURE)
        sensitivity->zero = row->zero + imk_unit_of("degC").offset;
    return true;
}

static bool of_part(const request *r, const imki_sensitivity_row *row)
{
    return imk_name_equal(r->part, row->part) && row->kind == r->kind;
}

/* The name without "16-bit" or the like at its end. */
static void read_part(const char *text, request *r)
{
    char letters[sizeof r->part];
    size_t length = 0, ends[sizeof r->part];
    imki_copy_text(r->part, sizeof r->part, text);
    for (size_t i = 0; r->part[i]; i++)
        if (!strchr(" -_\t", r->part[i])) {
            letters[length] = imki_lower(r->part[i]);
            ends[length++] = i;
        }
    for (size_t i = 0; i < WIDTHS; i++) {
        const size_t size = strlen(widths[i].letters);
        if (length > size && memcmp(letters + length - size, widths[i].letters, size) == 0) {
            r->bits = widths[i].bits;
            r->part[ends[length - size]] = '\0';
            return;
        }
    }
}

/* The name under which the rows of a part stand. */
static const char *name_of_rows(const char *part)
{
    for (size_t i = 0; i < imki_sensitivity_alias_count; i++)
        if (imk_name_equal(part, imki_sensitivity_aliases[i].name))
            return imki_sensitivity_aliases[i].part;
    return part;
}

bool imk_device_sensitivity_of(const imk_device_sensitivity *sensitivity, const char *name)
{
    char family[64];
    imki_copy_text(family, sizeof family, sensitivity->part);
    char *version = strrchr(family, '-');
    if (imk_name_equal(name_of_rows(name), sensitivity->part))
        return true;
    if (!version)
        return false;
    *version = '\0';
    return imk_name_equal(name, family);
}

static imk_status refuse_part(const request *r, const char *part)
{
    enum { PARTS_MAX = 128 };
    const char *names[PARTS_MAX];
    size_t count = 0;
    for (size_t i = 0; i < imki_sensitivity_row_count && count < PARTS_MAX; i++)
        if (count == 0 || strcmp(imki_sensitivity_rows[i].part, names[count - 1]) != 0)
            names[count++] = imki_sensitivity_rows[i].part;
    const size_t nearest = imk_nearest_name(part, count, names);
    char expected[sizeof r->error->expected] =
        "a part whose sensitivities are known, such as BMI088; of another part, state the "
        "sensitivity itself";
    if (nearest < count)
        imki_copy_text(expected, sizeof expected, names[nearest]);
    return imk_error_set(r->error, IMK_ERROR_NAME_UNKNOWN, "device", part, expected);
}

static imk_status refuse_kind(const request *r, const char *part)
{
    static const char *const kinds[IMK_COUNT_KINDS] = {"gyro", "accelerometer", "temperature"};
    char expected[sizeof r->error->expected] = "the sensitivity of its ";
    imki_append_text(expected, sizeof expected, kinds[r->kind]);
    imki_append_text(expected, sizeof expected, " itself: it is not known here");
    return imk_error_set(r->error, IMK_ERROR_UNSUPPORTED, "device", part, expected);
}

static bool has_width(const request *r, const imki_sensitivity_row *row, int bits)
{
    return of_part(r, row) && row->bits == bits;
}

/* The widths of the part, each once: "one of ADIS16470 16-bit, ADIS16470 32-bit". */
static imk_status refuse_width(const request *r, const char *part)
{
    char list[sizeof r->error->expected] = "";
    for (size_t w = 0; w < WIDTHS; w++)
        for (size_t i = 0; i < imki_sensitivity_row_count; i++)
            if (has_width(r, &imki_sensitivity_rows[i], widths[w].bits)) {
                imki_append_text(list, sizeof list, list[0] ? ", " : "one of ");
                imki_append_text(list, sizeof list, imki_sensitivity_rows[i].part);
                imki_append_text(list, sizeof list, widths[w].text);
                break;
            }
    return imk_error_set(r->error, IMK_ERROR_NAME_UNKNOWN, "device", part, list);
}

/* The ranges of the part, each once: "one of 3 g, 6 g, 12 g, 24 g". */
static imk_status refuse_range(const request *r, imk_status status, const char *found)
{
    char list[sizeof r->error->expected] = "";
    const imki_sensitivity_row *before = NULL;
    for (size_t i = 0; i < imki_sensitivity_row_count; i++) {
        const imki_sensitivity_row *row = &imki_sensitivity_rows[i];
        if (!of_part(r, row) || (before && strcmp(before->range, row->range) == 0))
            continue;
        imki_append_text(list, sizeof list, before ? ", " : "one of ");
        imki_append_text(list, sizeof list, row->range);
        before = row;
    }
    if (before && !before->range[0])
        imki_copy_text(list, sizeof list, "leave it out: the part has one range");
    return imk_error_set(r->error, status, "range", found, list);
}

/* "2000deg/s", also behind ± or +-; not a number when nothing is stated. */
static imk_status read_range(const request *r, double *range)
{
    static const char *const signs[] = {"±", "+/-", "+-"};
    const char *at = r->range ? r->range : "";
    at += strspn(at, " \t");
    *range = (double)NAN;
    if (*at == '\0')
        return IMK_OK;
    for (size_t i = 0; i < sizeof signs / sizeof signs[0]; i++)
        if (strncmp(at, signs[i], strlen(signs[i])) == 0) {
            at += strlen(signs[i]);
            break;
        }
    double sigma;
    size_t count;
    const imk_status status = imk_quantity_parse(at, at + strlen(at), dimension_of(r->kind), 1,
                                                 range, &sigma, &count, NULL, r->error);
    if (status != IMK_OK)
        imki_copy_text(r->error->field, sizeof r->error->field, "range");
    return status;
}

static bool has_range(const imki_sensitivity_row *row, double range)
{
    return isnan(range) || fabs(range_of(row) - range) <= same_range * range;
}

/* The rows that fit: their number, the last of them, and whether they differ in their ranges. */
static size_t fitting(const request *r, double range, size_t *index, bool *ranges_differ)
{
    size_t count = 0;
    *ranges_differ = false;
    for (size_t i = 0; i < imki_sensitivity_row_count; i++) {
        const imki_sensitivity_row *row = &imki_sensitivity_rows[i];
        if (!of_part(r, row) || (r->bits && row->bits != r->bits) || !has_range(row, range))
            continue;
        if (count++ > 0 && strcmp(imki_sensitivity_rows[*index].range, row->range) != 0)
            *ranges_differ = true;
        *index = i;
    }
    return count;
}

static bool is_known(const char *part)
{
    for (size_t i = 0; i < imki_sensitivity_row_count; i++)
        if (imk_name_equal(part, imki_sensitivity_rows[i].part))
            return true;
    return false;
}

imk_status imk_device_sensitivity_find(const char *part, imk_count_kind kind, const char *range,
                                       imk_device_sensitivity *sensitivity, imk_error *error)
{
    imk_error own;
    request r = {.kind = kind, .range = range, .error = error ? error : &own};
    if (!part || (unsigned)kind >= IMK_COUNT_KINDS)
        return imk_error_set(r.error, IMK_ERROR_ARGUMENT, part ? "kind" : "device", NULL, NULL);
    read_part(part, &r);
    const char *rows = name_of_rows(r.part);
    if (rows != r.part)
        imki_copy_text(r.part, sizeof r.part, rows);
    if (kind == IMK_COUNTS_TEMPERATURE) {
        r.range = NULL;
        r.bits = 0; /* the temperature has its own width */
    }
    double asked;
    size_t index = 0;
    bool ranges_differ;
    if (!is_known(r.part))
        return refuse_part(&r, part);
    request any = r;
    any.bits = 0;
    if (fitting(&any, (double)NAN, &index, &ranges_differ) == 0)
        return refuse_kind(&r, part);
    if (fitting(&r, (double)NAN, &index, &ranges_differ) == 0)
        return refuse_width(&r, part);
    const imk_status status = read_range(&r, &asked);
    if (status != IMK_OK)
        return status;
    const size_t count = fitting(&r, asked, &index, &ranges_differ);
    if (count == 0)
        return refuse_range(&r, IMK_ERROR_RANGE, r.range);
    if (ranges_differ)
        return refuse_range(&r, IMK_ERROR_KEY_MISSING, "");
    if (count > 1)
        return refuse_width(&r, part);
    (void)imk_device_sensitivity_get(index, sensitivity);
    return IMK_OK;
}
