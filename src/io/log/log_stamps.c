/* SPDX-License-Identifier: Apache-2.0 */
/* Times as whole ticks: decimal numbers of up to 18 digits and dates. */
#include "log_stamps_internal.h"

#include "imukit/decimal.h"

#include <math.h>
#include <stddef.h>

enum { DIGITS_MOST = 9, NANOSECONDS = 1000000000 };

/* Times beyond this many seconds count from the first one. */
static const double from_epoch = 1e6;
/* Ticks stay below, so that a difference of two does not overflow. */
static const double ticks_most = 4.6e18;

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* Up to `count` digits; at least one. */
static bool take_number(const char **at, const char *end, int count, int *number)
{
    const char *begin = *at;
    *number = 0;
    for (; *at < end && *at - begin < count && is_digit(**at); (*at)++)
        *number = 10 * *number + (**at - '0');
    return *at - begin == count;
}

static bool take(const char **at, const char *end, char c)
{
    if (*at >= end || **at != c)
        return false;
    (*at)++;
    return true;
}

/* Days from 1970-01-01, of the Gregorian calendar: counted in years that begin in March, so that
 * the leap day is the last one; 146097 days in 400 years. */
static int64_t days_of(int year, int month, int day)
{
    const int64_t y = month <= 2 ? year - 1 : year;
    const int64_t era = (y >= 0 ? y : y - 399) / 400, of_era = y - 400 * era;
    const int64_t of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
    return era * 146097 + 365 * of_era + of_era / 4 - of_era / 100 + of_year - 719468;
}

static int days_in(int year, int month)
{
    static const int days[] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    const bool leap = (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
    return days[month - 1] + (month == 2 && leap);
}

/* "2024-05-01", "2024/05/01" */
static bool take_day(const char **at, const char *end, int64_t *days)
{
    int year, month, day;
    if (!take_number(at, end, 4, &year))
        return false;
    const char sign = *at < end && **at == '/' ? '/' : '-';
    if (!take(at, end, sign) || !take_number(at, end, 2, &month) || !take(at, end, sign) ||
        !take_number(at, end, 2, &day) || month < 1 || month > 12 || day < 1 ||
        day > days_in(year, month) || year < 1680 || year > 2260)
        return false;
    *days = days_of(year, month, day);
    return true;
}

/* "12:00:00.123456": a second 60 is a leap second, which the count of days has no place for. */
static bool take_clock(const char **at, const char *end, int64_t *ticks)
{
    int hour, minute, second = 0;
    int64_t fraction = 0;
    if (!take_number(at, end, 2, &hour) || !take(at, end, ':') ||
        !take_number(at, end, 2, &minute) || hour > 23 || minute > 59)
        return false;
    if (take(at, end, ':')) {
        if (!take_number(at, end, 2, &second) || second > 59)
            return false;
        if (take(at, end, '.') || take(at, end, ',')) {
            int64_t place = NANOSECONDS / 10;
            if (*at >= end || !is_digit(**at))
                return false;
            for (; *at < end && is_digit(**at); (*at)++, place /= 10)
                fraction += place * (**at - '0');
        }
    }
    *ticks = ((int64_t)hour * 3600 + minute * 60 + second) * NANOSECONDS + fraction;
    return true;
}

/* "Z", "+02:00", "+0200", "-05"; nothing: taken as it is. */
static bool take_zone(const char **at, const char *end, int64_t *ticks)
{
    int hour, minute = 0;
    if (*at == end || ((take(at, end, 'Z') || take(at, end, 'z')) && *at == end))
        return true;
    while (take(at, end, ' ')) {
    }
    if (end - *at == 3 && (*at)[0] == 'U' && (*at)[1] == 'T' && (*at)[2] == 'C')
        return true;
    const bool west = *at < end && **at == '-';
    if ((!take(at, end, '+') && !take(at, end, '-')) || !take_number(at, end, 2, &hour))
        return false;
    if (*at < end) {
        (void)take(at, end, ':');
        if (!take_number(at, end, 2, &minute) || *at != end)
            return false;
    }
    if (hour > 14 || minute > 59)
        return false;
    const int64_t offset = ((int64_t)hour * 3600 + minute * 60) * NANOSECONDS;
    *ticks += west ? offset : -offset;
    return true;
}

bool imki_log_date_read(const char *begin, const char *end, int64_t *ticks)
{
    const char *at = begin;
    int64_t days, clock;
    if (!take_day(&at, end, &days) ||
        (!take(&at, end, 'T') && !take(&at, end, 't') && !take(&at, end, ' ')) ||
        !take_clock(&at, end, &clock) || !take_zone(&at, end, &clock))
        return false;
    if (ticks)
        *ticks = days * 86400 * NANOSECONDS + clock;
    return true;
}

/* A decimal number in ticks; digits beyond them are rounded. */
static bool read_ticks(const char *begin, const char *end, int digits, int64_t *ticks)
{
    const bool negative = begin < end && *begin == '-';
    int64_t number = 0;
    int decimals = -1; /* of the digits so far; -1: no point yet */
    size_t count = 0;
    for (const char *c = begin + negative; c < end; c++) {
        if (*c == '.' && decimals < 0) {
            decimals = 0;
            continue;
        }
        if (!is_digit(*c))
            return false;
        count++;
        if (decimals >= digits) { /* the first one rounds */
            number += decimals++ == digits && *c >= '5';
            continue;
        }
        decimals += decimals >= 0;
        if (number > (INT64_MAX - 9) / 10)
            return false;
        number = 10 * number + (*c - '0');
    }
    for (int k = decimals > 0 ? decimals : 0; k < digits; k++) {
        if (number > INT64_MAX / 10)
            return false;
        number *= 10;
    }
    *ticks = negative ? -number : number;
    return count > 0;
}

imki_log_stamps imki_log_stamps_start(const char *begin, const char *end, double scale)
{
    imki_log_stamps s = {.per_unit = 1};
    double value;
    if (imki_log_date_read(begin, end, &s.origin)) {
        s.exact = s.dates = true;
        s.digits = DIGITS_MOST;
        s.per_unit = NANOSECONDS;
        return s;
    }
    if (begin == end || imk_decimal_parse(begin, end, &value) != end ||
        !(fabs(value) * scale > from_epoch))
        return s;
    for (; s.digits < DIGITS_MOST && fabs(value) * s.per_unit * 10 < ticks_most; s.digits++)
        s.per_unit *= 10;
    s.exact = fabs(value) < ticks_most && read_ticks(begin, end, s.digits, &s.origin);
    return s;
}

/* Whole seconds, and less than a second of the rest. */
static bool join(const char *begin, const char *end, const char *rest, const char *rest_end,
                 int64_t rest_ticks, int64_t *ticks)
{
    int64_t more;
    return read_ticks(begin, end, DIGITS_MOST, ticks) && *ticks % NANOSECONDS == 0 &&
           read_ticks(rest, rest_end, 0, &more) && more >= 0 && more < NANOSECONDS / rest_ticks &&
           !__builtin_add_overflow(*ticks, more * rest_ticks, ticks);
}

imki_log_stamps imki_log_stamps_join(const char *begin, const char *end, const char *rest,
                                     const char *rest_end, int64_t rest_ticks)
{
    imki_log_stamps s = {.digits = DIGITS_MOST, .per_unit = NANOSECONDS, .rest_ticks = rest_ticks};
    s.exact = join(begin, end, rest, rest_end, rest_ticks, &s.origin);
    if (s.exact && (double)s.origin <= from_epoch * NANOSECONDS)
        s.origin = 0;
    return s;
}

bool imki_log_stamp_join(const imki_log_stamps *stamps, const char *begin, const char *end,
                         const char *rest, const char *rest_end, double *value)
{
    int64_t ticks;
    if (!join(begin, end, rest, rest_end, stamps->rest_ticks, &ticks) ||
        __builtin_sub_overflow(ticks, stamps->origin, &ticks))
        return false;
    *value = (double)ticks / stamps->per_unit;
    return true;
}

double imki_log_stamps_origin(const imki_log_stamps *stamps)
{
    return (double)stamps->origin / stamps->per_unit;
}

bool imki_log_stamp_read(const imki_log_stamps *stamps, const char *begin, const char *end,
                         double *value)
{
    int64_t ticks, difference;
    if (stamps->dates ? imki_log_date_read(begin, end, &ticks)
                      : read_ticks(begin, end, stamps->digits, &ticks)) {
        if (!__builtin_sub_overflow(ticks, stamps->origin, &difference)) {
            *value = (double)difference / stamps->per_unit;
            return true;
        }
    }
    if (stamps->dates || begin == end || imk_decimal_parse(begin, end, value) != end)
        return false;
    *value -= imki_log_stamps_origin(stamps);
    return true;
}
