/* SPDX-License-Identifier: Apache-2.0 */
/* How the numbers of a dataset are coded [CF, sections 2.5.1 and 8.1]: in the attributes
 * scale_factor, add_offset, _FillValue and missing_value. */
#define _POSIX_C_SOURCE 200809L
#include "hdf5_reader_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *const names[] = {"scale_factor", "add_offset", "_FillValue", "missing_value"};

enum { FACTOR, OFFSET, NAMES = sizeof names / sizeof names[0] };

/* A number of an attribute in each of the types that an array has. */
typedef union number {
    double real;
    int64_t whole;
    uint64_t positive;
} number;

/* Whole numbers that an array of the type cannot have stand for none of its values. */
static bool convert(imki_value_type from, imki_value_type to, number *value)
{
    const number given = *value;
    const bool positive = to == IMKI_UINT64;
    if (from == IMKI_FLOAT64) {
        const double least = positive ? 0.0 : -0x1p63, most = positive ? 0x1p64 : 0x1p63;
        if (!(given.real >= least && given.real < most && given.real == trunc(given.real)))
            return false;
        if (positive)
            value->positive = (uint64_t)given.real;
        else
            value->whole = (int64_t)given.real;
        return true;
    }
    return from == to || given.positive <= INT64_MAX; /* the same bits */
}

/* As the dataset would hold it: a float has other digits. */
static bool round_real(hid_t type, number *value)
{
    unsigned char bytes[64] = {0};
    if (H5Tget_size(type) > sizeof bytes)
        return false;
    memcpy(bytes, &value->real, sizeof value->real);
    if (H5Tconvert(H5T_NATIVE_DOUBLE, type, 1, bytes, NULL, H5P_DEFAULT) < 0 ||
        H5Tconvert(type, H5T_NATIVE_DOUBLE, 1, bytes, NULL, H5P_DEFAULT) < 0)
        return false;
    memcpy(&value->real, bytes, sizeof value->real);
    return true;
}

/* @param from  receives their type
 * @return how many; 0: they are none, or more than IMKI_MISSING_MAX */
static size_t read_numbers(hid_t attribute, bool real, imki_value_type *from,
                           number value[IMKI_MISSING_MAX])
{
    const hid_t type = H5Aget_type(attribute), space = H5Aget_space(attribute);
    const hssize_t count = H5Sget_simple_extent_npoints(space);
    const bool numbers = imki_hdf5_type(type, from) && count >= 1 && count <= IMKI_MISSING_MAX;
    *from = real ? IMKI_FLOAT64 : *from;
    const bool read = numbers && H5Aread(attribute, imki_hdf5_memory_type(*from), value) >= 0;
    H5Sclose(space);
    H5Tclose(type);
    return read ? (size_t)count : 0;
}

/* Both attributes state the same one as a rule. */
static bool add_missing(imki_coding *coding, uint64_t bits)
{
    for (size_t i = 0; i < coding->missing_count; i++)
        if (coding->missing[i] == bits)
            return true;
    if (coding->missing_count == IMKI_MISSING_MAX)
        return false;
    coding->missing[coding->missing_count++] = bits;
    return true;
}

/* @return false: it has no such meaning */
static bool take_attribute(hid_t dataset, int name, imki_value_type array, imki_coding *coding)
{
    number value[IMKI_MISSING_MAX] = {{.whole = 0}};
    imki_value_type from;
    const hid_t attribute = H5Aopen(dataset, names[name], H5P_DEFAULT);
    if (attribute < 0)
        return false;
    const bool scales = name == FACTOR || name == OFFSET;
    const size_t count = read_numbers(attribute, scales || array == IMKI_FLOAT64, &from, value);
    H5Aclose(attribute);
    if (scales && count != 1)
        return false;
    if (scales) {
        *(name == FACTOR ? &coding->factor : &coding->offset) = value[0].real;
        return isfinite(value[0].real) && coding->factor != 0.0;
    }
    const hid_t type = H5Dget_type(dataset);
    bool room = true;
    for (size_t i = 0; i < count && room; i++)
        if (array == IMKI_FLOAT64 ? round_real(type, &value[i]) : convert(from, array, &value[i]))
            room = add_missing(coding, value[i].positive);
    H5Tclose(type);
    return count > 0 && room;
}

bool imki_hdf5_coding(hid_t dataset, const imki_hdf5_array *array, imki_coding *coding, size_t size,
                      char *obstacle)
{
    bool coded = false;
    *coding = (imki_coding){.factor = 1.0};
    /* Of numbers that are written as if they had a sign. */
    if (array->type == IMKI_INT64 && H5Aexists(dataset, "_Unsigned") > 0) {
        snprintf(obstacle, size, "dataset whose _Unsigned is unclear");
        return false;
    }
    for (int name = 0; name < NAMES; name++) {
        if (H5Aexists(dataset, names[name]) <= 0)
            continue;
        coded = true;
        if (array->member < 0 && take_attribute(dataset, name, array->type, coding))
            continue;
        snprintf(obstacle, size, "dataset whose %s is unclear", names[name]);
        return false;
    }
    obstacle[0] = '\0';
    return coded;
}
