/* SPDX-License-Identifier: Apache-2.0 */
/* Places and labels of the ticks of an axis. Labels of a linear axis are 1, 2 or 5 times a power of
 * ten apart. A logarithmic axis has labels at the powers of ten if it spans many decades, at 1, 2
 * and 5 in each decade if it spans few, and the steps of a linear axis if this gives fewer than two
 * labels. */
#include "figure_internal.h"

#include "imukit/decimal.h"

#include <stdio.h>
#include <string.h>

/* Decades shorter than this [px] have no ticks between the powers of ten. */
static const double open_decade = 36;

/* Powers of ten need less room than numbers, by this factor. */
static const double slimmer = 1.3;

/* An imki_tick.text has room for so many decimals of a number below 1e7. */
enum { DECIMALS_MAX = 17 };

/* Distance of ticks: digit times ten to the power. */
typedef struct step {
    int digit, power;
} step;

static step step_make(double span, double most)
{
    const double rough = span / fmax(most, 1);
    const int power = (int)floor(log10(rough));
    const double digit = rough / pow(10, power);
    if (digit > 5)
        return (step){1, power + 1};
    return (step){digit <= 1 ? 1 : digit <= 2 ? 2 : 5, power};
}

/* Tick n, from whole numbers, so that 3 times 0.1 is 0.3. */
static double step_value(step s, double n)
{
    return s.power < 0 ? n * s.digit / pow(10, -s.power) : n * s.digit * pow(10, s.power);
}

/* ---- labels ---------------------------------------------------------------------------------- */

/* A number with a minus sign that is as wide as a plus. */
static void put_number(char *text, size_t size, double value, int decimals)
{
    char digits[IMK_DECIMAL_SIZE];
    digits[imk_decimal_fixed(fabs(value), decimals, digits)] = '\0';
    snprintf(text, size, "%s%.24s", value < 0 ? "−" : "", digits);
}

static void put_power(imki_tick *tick, int power)
{
    snprintf(tick->power, sizeof tick->power, "%s%d", power < 0 ? "−" : "",
             power < 0 ? -power : power);
}

static int digits_of(int power, int decimals)
{
    return (power > 0 ? power : 0) + 1 + (decimals > 0 ? decimals + 1 : 0);
}

/* A label of a linear axis: 0.25, or 2.5·10⁻⁷ if all labels are very small or large, unless this
 * form is longer, as for 1000000.5. */
static void label_linear(imki_tick *tick, const imki_axis *axis, step s, double n)
{
    const double value = step_value(s, n), most = fmax(fabs(axis->low), fabs(axis->high));
    const int power = (int)floor(log10(most)), plain = s.power < 0 ? -s.power : 0;
    const int behind = power > s.power ? power - s.power : 0;
    const bool short_enough = digits_of(power, plain) <= digits_of(0, behind) + 4;
    if (n == 0)
        snprintf(tick->text, sizeof tick->text, "0");
    else if ((most >= 1e-3 && most < 1e6) || short_enough)
        put_number(tick->text, sizeof tick->text, value,
                   plain < DECIMALS_MAX ? plain : DECIMALS_MAX);
    else {
        const double mantissa = power < 0 ? value * pow(10, -power) : value / pow(10, power);
        char number[24];
        put_number(number, sizeof number, mantissa, behind < 10 ? behind : 10);
        snprintf(tick->text, sizeof tick->text, "%s·10", number);
        put_power(tick, power);
    }
}

/* 0.02, 500 or 2·10⁻⁵ */
static void label_digit(imki_tick *tick, int digit, int power)
{
    if (power >= -3 && power <= 4) {
        put_number(tick->text, sizeof tick->text, step_value((step){digit, power}, 1),
                   power < 0 ? -power : 0);
    } else {
        if (digit > 1)
            snprintf(tick->text, sizeof tick->text, "%d·10", digit);
        else
            snprintf(tick->text, sizeof tick->text, "10");
        put_power(tick, power);
    }
}

/* ---- ticks ----------------------------------------------------------------------------------- */

/* @return the tick, to be labelled; NULL when it is outside */
static imki_tick *add(imki_ticks *ticks, const imki_axis *axis, double at)
{
    const double place = (at - axis->low) / (axis->high - axis->low);
    if (!(place >= 0 && place <= 1) || ticks->count == IMKI_TICKS_MAX)
        return NULL;
    imki_tick *tick = &ticks->tick[ticks->count++];
    *tick = (imki_tick){.place = place};
    return tick;
}

static void add_linear(imki_ticks *ticks, const imki_axis *axis, double most)
{
    const double low = axis->logarithmic ? pow(10, axis->low) : axis->low;
    const double high = axis->logarithmic ? pow(10, axis->high) : axis->high;
    const imki_axis shown = {.low = low, .high = high};
    const step s = step_make(high - low, most);
    const int parts = s.digit == 1 ? 2 : s.digit;
    const double distance = step_value(s, 1);
    const double first = floor(low / distance) * parts, last = ceil(high / distance) * parts;
    for (double n = first; n <= last && ticks->count < IMKI_TICKS_MAX; n++) {
        const bool labelled = fmod(n, parts) == 0;
        const double value = labelled ? step_value(s, n / parts) : n / parts * distance;
        if (axis->logarithmic && !(value > 0))
            continue;
        imki_tick *tick = add(ticks, axis, axis->logarithmic ? log10(value) : value);
        if (tick && labelled) {
            tick->labelled = true;
            label_linear(tick, &shown, s, n / parts);
        }
    }
}

static void add_digits(imki_ticks *ticks, const imki_axis *axis)
{
    for (int power = (int)floor(axis->low); power <= (int)ceil(axis->high); power++)
        for (int digit = 1; digit <= 9; digit++) {
            imki_tick *tick = add(ticks, axis, power + log10(digit));
            if (tick && (digit == 1 || digit == 2 || digit == 5)) {
                tick->labelled = true;
                label_digit(tick, digit, power);
            }
        }
}

/* Powers of ten: every one, or every second, fifth, tenth …, as there is room. */
static void add_powers(imki_ticks *ticks, const imki_axis *axis, double length, double most)
{
    const double decades = axis->high - axis->low;
    most *= slimmer;
    const step s = step_make(fmax(decades, most), most);
    const int stride = (int)lround(step_value(s, 1));
    const bool open = stride == 1 && length / decades >= open_decade;
    for (int power = (int)floor(axis->low); power <= (int)ceil(axis->high); power++) {
        imki_tick *tick = add(ticks, axis, power);
        if (tick && power % stride == 0) {
            tick->labelled = true;
            snprintf(tick->text, sizeof tick->text, "10");
            put_power(tick, power);
        } else if (tick && decades > 10 * most) {
            ticks->count--;
        }
        for (int digit = 2; digit <= 9 && open; digit++)
            add(ticks, axis, power + log10(digit));
    }
}

static size_t labels(const imki_ticks *ticks)
{
    size_t count = 0;
    for (size_t i = 0; i < ticks->count; i++)
        count += ticks->tick[i].labelled;
    return count;
}

void imki_axis_ticks(const imki_axis *axis, double length, double room, imki_ticks *ticks)
{
    const double most = fmax(length / room, 2);
    ticks->count = 0;
    if (axis->logarithmic && axis->few_decades) {
        const bool numbers = axis->low > -290 && axis->high < 300; /* and their steps */
        add_digits(ticks, axis);
        if (labels(ticks) >= 3 || !numbers)
            return;
        ticks->count = 0;
    }
    if (axis->logarithmic && !axis->few_decades)
        add_powers(ticks, axis, length, most);
    else
        add_linear(ticks, axis, most);
}
