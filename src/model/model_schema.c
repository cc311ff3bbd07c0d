/* SPDX-License-Identifier: Apache-2.0 */
/* The table of the sensor model's fields; see model_schema_internal.h. */
#include "model_schema_internal.h"

#include <float.h>
#include <stddef.h>
#include <string.h>

#define UNITS(gyro, accel, mag)                                                                    \
    {                                                                                              \
        gyro, accel, mag                                                                           \
    }
#define PAIR(gyro, accel)                                                                          \
    {                                                                                              \
        gyro, accel                                                                                \
    }
#define UNIT(all) UNITS(all, all, all)
#define NO_UNITS UNITS(NULL, NULL, NULL)
#define ALL(path) UNITS(path, path, path)
#define BOTH(path) UNITS(path, path, NULL)
#define GYRO(path) UNITS(path, NULL, NULL)
#define ACCEL(path) UNITS(NULL, path, NULL)
#define ANY -DBL_MAX, DBL_MAX
#define NOT_NEGATIVE 0.0, DBL_MAX
#define AT(member) offsetof(imk_triad, member)
#define IN(term, member) offsetof(struct term, member)
#define NO_COUNT 0

const char *const imki_kind_names[IMK_KINDS] = {"gyro", "accel", "mag"};

const imki_field imki_triad_fields[] = {
    {ALL("direction"), IMKI_DIRECTION, IMKI_BARE | IMKI_OUTPUT, AT(direction), AT(axis_count),
     UNIT("1"), NO_UNITS, UNIT("1"), ANY},
    {ALL("sensitivity"), IMKI_AXES, IMKI_OUTPUT, AT(sensitivity), NO_COUNT,
     UNITS("count/(rad/s)", "count/(m/s^2)", "count/uT"), NO_UNITS,
     UNITS("count/(rad/s)", "count/(m/s^2)", "count/uT"), ANY},
    {ALL("zero_offset"), IMKI_AXES, IMKI_OUTPUT, AT(zero_offset), NO_COUNT, UNIT("count"), NO_UNITS,
     UNIT("count"), ANY},
    {ALL("bias.fixed"), IMKI_AXES, 0, AT(bias.fixed), NO_COUNT, UNITS("deg/h", "mg", "uT"),
     NO_UNITS, UNITS("rad/s", "m/s^2", "T"), ANY},
    {ALL("bias.repeatability"), IMKI_AXES, 0, AT(bias.repeatability), NO_COUNT,
     UNITS("deg/h", "mg", "uT"), NO_UNITS, UNITS("rad/s", "m/s^2", "T"), NOT_NEGATIVE},
    {ALL("bias.temperature"), IMKI_POLYNOMIAL, 0, AT(bias.temperature), NO_COUNT,
     UNITS("deg/h", "mg", "uT"), NO_UNITS, UNITS("rad/s", "m/s^2", "T"), ANY},
    {ALL("bias.temperature_rate"), IMKI_AXES, 0, AT(bias.temperature_rate), NO_COUNT,
     UNITS("deg/h/(K/min)", "mg/(K/min)", "nT/(K/min)"), NO_UNITS,
     UNITS("rad/s/(K/s)", "m/s^2/(K/s)", "T/(K/s)"), ANY},
    {ALL("bias.warm_up.amplitude"), IMKI_AXES, 0, AT(bias.warm_up_amplitude), NO_COUNT,
     UNITS("deg/h", "mg", "uT"), NO_UNITS, UNITS("rad/s", "m/s^2", "T"), ANY},
    {ALL("bias.warm_up.time"), IMKI_SCALAR, IMKI_COMPANION, AT(bias.warm_up_time), NO_COUNT,
     UNIT("s"), NO_UNITS, UNIT("s"), NOT_NEGATIVE},
    {ALL("bias.hysteresis"), IMKI_AXES, 0, AT(bias.hysteresis), NO_COUNT,
     UNITS("deg/h", "mg", "uT"), NO_UNITS, UNITS("rad/s", "m/s^2", "T"), ANY},
    {ALL("scale_factor.fixed"), IMKI_AXES, IMKI_OPEN, AT(scale_factor.fixed), NO_COUNT, UNIT("ppm"),
     NO_UNITS, UNIT("1"), -1.0, DBL_MAX},
    {ALL("scale_factor.repeatability"), IMKI_AXES, 0, AT(scale_factor.repeatability), NO_COUNT,
     UNIT("ppm"), NO_UNITS, UNIT("1"), NOT_NEGATIVE},
    {ALL("scale_factor.temperature"), IMKI_POLYNOMIAL, 0, AT(scale_factor.temperature), NO_COUNT,
     UNIT("ppm"), NO_UNITS, UNIT("1"), ANY},
    {BOTH("nonlinearity.k2"), IMKI_AXES, 0, AT(nonlinearity.k2), NO_COUNT,
     UNITS("ppm/(deg/s)", "ppm/g", NULL), NO_UNITS, UNITS("1/(rad/s)", "1/(m/s^2)", NULL), ANY},
    {BOTH("nonlinearity.koq"), IMKI_AXES, 0, AT(nonlinearity.koq), NO_COUNT,
     UNITS("ppm/(deg/s)", "ppm/g", NULL), NO_UNITS, UNITS("1/(rad/s)", "1/(m/s^2)", NULL), ANY},
    {BOTH("nonlinearity.k3"), IMKI_AXES, 0, AT(nonlinearity.k3), NO_COUNT,
     UNITS("ppm/(deg/s)^2", "ppm/g^2", NULL), NO_UNITS, UNITS("1/(rad/s)^2", "1/(m/s^2)^2", NULL),
     ANY},
    {BOTH("nonlinearity.asymmetry"), IMKI_AXES, IMKI_OPEN, AT(nonlinearity.asymmetry), NO_COUNT,
     UNIT("ppm"), NO_UNITS, UNIT("1"), -2.0, 2.0},
    {ACCEL("cross_products"), IMKI_ROWS, 0, AT(nonlinearity.cross_products), NO_COUNT,
     UNIT("ppm/g"), NO_UNITS, UNITS("1/(rad/s)", "1/(m/s^2)", NULL), ANY},
    {ACCEL("pendulous_axis"), IMKI_PENDULOUS, IMKI_BARE | IMKI_COMPANION,
     AT(nonlinearity.pendulous_axis), NO_COUNT, UNIT("1"), NO_UNITS, UNIT("1"), ANY},
    {ALL("misalignment"), IMKI_OFF_DIAGONAL, 0, AT(misalignment), NO_COUNT, UNIT("mrad"), NO_UNITS,
     UNIT("rad"), ANY},
    {ALL("cross_axis"), IMKI_OFF_DIAGONAL, 0, AT(cross_axis), NO_COUNT, UNIT("%"), NO_UNITS,
     UNIT("1"), ANY},
    {GYRO("g_sensitivity"), IMKI_ROWS, 0, AT(g_sensitivity), NO_COUNT, UNIT("deg/h/g"), NO_UNITS,
     UNIT("rad/s/(m/s^2)"), ANY},
    {GYRO("g2_sensitivity"), IMKI_QUADRATIC, 0, AT(g2_sensitivity), NO_COUNT, UNIT("deg/h/g^2"),
     NO_UNITS, UNIT("rad/s/(m/s^2)^2"), ANY},
    {ACCEL("lever_arm"), IMKI_ROWS, 0, AT(lever_arm), NO_COUNT, UNIT("mm"), NO_UNITS, UNIT("m"),
     ANY},
    {ALL("noise.density"), IMKI_DENSITY, IMKI_COMPANION, AT(noise.density), NO_COUNT, NO_UNITS,
     NO_UNITS, NO_UNITS, ANY},
    {UNITS("noise.angle_random_walk", "noise.velocity_random_walk", "noise.white_noise"), IMKI_AXES,
     0, AT(noise.white), NO_COUNT, UNITS("deg/sqrt(h)", "m/s/sqrt(h)", "nT*sqrt(s)"),
     UNITS("deg/s/sqrt(Hz)", "ug/sqrt(Hz)", "nT/sqrt(Hz)"),
     UNITS("rad/sqrt(s)", "m/s/sqrt(s)", "T*sqrt(s)"), NOT_NEGATIVE},
    {ALL("noise.bias_instability"), IMKI_AXES, 0, AT(noise.bias_instability), NO_COUNT,
     UNITS("deg/h", "ug", "nT"), NO_UNITS, UNITS("rad/s", "m/s^2", "T"), NOT_NEGATIVE},
    {ALL("noise.allan_floor"), IMKI_AXES, IMKI_FLOOR, AT(noise.bias_instability), NO_COUNT,
     UNITS("deg/h", "ug", "nT"), NO_UNITS, UNITS("rad/s", "m/s^2", "T"), NOT_NEGATIVE},
    {ALL("noise.bias_instability_correlation_time"), IMKI_SCALAR, IMKI_COMPANION,
     AT(noise.bias_instability_correlation_time), NO_COUNT, UNIT("s"), NO_UNITS, UNIT("s"), 0.0,
     1e9}, /* what imk_flicker_start() takes up to 6 GHz */
    {UNITS("noise.rate_random_walk", "noise.acceleration_random_walk", "noise.random_walk"),
     IMKI_AXES, 0, AT(noise.random_walk), NO_COUNT,
     UNITS("deg/h/sqrt(h)", "ug/sqrt(h)", "nT/sqrt(h)"), NO_UNITS,
     UNITS("rad/s/sqrt(s)", "m/s^2/sqrt(s)", "T/sqrt(s)"), NOT_NEGATIVE},
    {UNITS("noise.rate_ramp", "noise.acceleration_ramp", "noise.ramp"), IMKI_AXES, 0,
     AT(noise.ramp), NO_COUNT, UNITS("deg/h/h", "ug/h", "nT/h"), NO_UNITS,
     UNITS("rad/s^2", "m/s^3", "T/s"), ANY},
    {PAIR("noise.angle_white", "noise.velocity_white"), IMKI_AXES, 0, AT(noise.angle_white),
     NO_COUNT, UNITS("arcsec*sqrt(s)", "m/s*sqrt(s)", NULL),
     UNITS("arcsec/sqrt(Hz)", "m/s/sqrt(Hz)", NULL), UNITS("rad*sqrt(s)", "m/s*sqrt(s)", NULL),
     NOT_NEGATIVE},
    {BOTH("noise.reading_noise"), IMKI_AXES, 0, AT(noise.reading_noise), NO_COUNT,
     UNITS("arcsec", "m/s", NULL), NO_UNITS, UNITS("rad", "m/s", NULL), NOT_NEGATIVE},
    {BOTH("noise.quantization"), IMKI_AXES, 0, AT(noise.quantization), NO_COUNT,
     UNITS("arcsec", "m/s", NULL), NO_UNITS, UNITS("rad", "m/s", NULL), NOT_NEGATIVE},
    {ALL("noise.gauss_markov"), IMKI_LIST, 0, AT(noise.gauss_markov), AT(noise.gauss_markov_count),
     NO_UNITS, NO_UNITS, NO_UNITS, ANY},
    {ALL("noise.sinusoid"), IMKI_LIST, 0, AT(noise.sinusoid), AT(noise.sinusoid_count), NO_UNITS,
     NO_UNITS, NO_UNITS, ANY},
    {ALL("noise.resonance"), IMKI_LIST, 0, AT(noise.resonance), AT(noise.resonance_count), NO_UNITS,
     NO_UNITS, NO_UNITS, ANY},
    {ALL("bandwidth"), IMKI_AXES, 0, AT(bandwidth), NO_COUNT, UNIT("Hz"), NO_UNITS, UNIT("Hz"),
     NOT_NEGATIVE},
    /* The limits of imk_low_pass in noise.h. */
    {ALL("damping"), IMKI_AXES, IMKI_BARE | IMKI_TYPICAL | IMKI_COMPANION, AT(damping), NO_COUNT,
     UNIT("1"), NO_UNITS, UNIT("1"), 0.05, 50.0},
    {ALL("dead_band"), IMKI_AXES, 0, AT(dead_band), NO_COUNT, UNITS("deg/s", "mg", "nT"), NO_UNITS,
     UNITS("rad/s", "m/s^2", "T"), NOT_NEGATIVE},
    {ALL("range"), IMKI_AXES, IMKI_COMPANION, AT(range), NO_COUNT, UNITS("deg/s", "g", "uT"),
     NO_UNITS, UNITS("rad/s", "m/s^2", "T"), NOT_NEGATIVE},
    {ALL("resolution"), IMKI_AXES, 0, AT(resolution), NO_COUNT, UNITS("deg/s", "mg", "nT"),
     NO_UNITS, UNITS("rad/s", "m/s^2", "T"), NOT_NEGATIVE},
};
const size_t imki_triad_field_count = sizeof imki_triad_fields / sizeof imki_triad_fields[0];
_Static_assert(sizeof imki_triad_fields / sizeof imki_triad_fields[0] <= 64,
               "stated_zero has a bit for each field");

/* ---- terms ----------------------------------------------------------------------------------- */

#define TEXTS(words) PAIR("gyro " words, "accelerometer " words)
/* Numbers of draws that no row has: 4 bias.hysteresis, 18 and 19 of the timing. */
const imki_term imki_terms[IMKI_TERMS] = {
    [IMK_MODEL_BIAS] = {AT(bias.fixed), IMKI_FORM_ONE, 0, "bias", TEXTS("bias, fixed")},
    [IMK_MODEL_SCALE_FACTOR] = {AT(scale_factor.fixed), IMKI_FORM_INPUT, 5, "scale factor error",
                                TEXTS("scale factor")},
    [IMK_MODEL_MISALIGNMENT] = {AT(misalignment), IMKI_FORM_SEEN, 12, "misalignment",
                                TEXTS("misalignment")},
    [IMK_MODEL_CROSS_AXIS] = {AT(cross_axis), IMKI_FORM_SEEN, 13, "cross-axis response",
                              TEXTS("cross-axis response")},
    [IMK_MODEL_K2] = {AT(nonlinearity.k2), IMKI_FORM_POWER, 7, "K2",
                      TEXTS("nonlinearity, second order")},
    [IMK_MODEL_KOQ] = {AT(nonlinearity.koq), IMKI_FORM_POWER, 8, "Koq",
                       TEXTS("nonlinearity, odd quadratic")},
    [IMK_MODEL_K3] = {AT(nonlinearity.k3), IMKI_FORM_POWER, 9, "K3",
                      TEXTS("nonlinearity, third order")},
    [IMK_MODEL_ASYMMETRY] = {AT(nonlinearity.asymmetry), IMKI_FORM_POWER, 10, "asymmetry",
                             TEXTS("asymmetry")},
    [IMK_MODEL_CROSS_PRODUCTS] = {AT(nonlinearity.cross_products), IMKI_FORM_CROSS, 11,
                                  "cross product", TEXTS("cross products")},
    [IMK_MODEL_G_SENSITIVITY] = {AT(g_sensitivity), IMKI_FORM_FORCE, 14, "g-sensitivity",
                                 TEXTS("g-sensitivity")},
    [IMK_MODEL_G2_SENSITIVITY] = {AT(g2_sensitivity), IMKI_FORM_PRODUCT, 15, "g^2-sensitivity",
                                  TEXTS("g2-sensitivity")},
    [IMK_MODEL_LEVER_ARM] = {AT(lever_arm), IMKI_FORM_PLACE, 16, "place", TEXTS("lever arms")},
    [IMK_MODEL_BIAS_TEMPERATURE] = {AT(bias.temperature), IMKI_FORM_WARMTH, 1,
                                    "bias over temperature", PAIR(NULL, NULL)},
    [IMK_MODEL_SCALE_TEMPERATURE] = {AT(scale_factor.temperature), IMKI_FORM_WARM_INPUT, 6,
                                     "scale factor over temperature", PAIR(NULL, NULL)},
    [IMK_MODEL_TEMPERATURE_RATE] = {AT(bias.temperature_rate), IMKI_FORM_WARMING, 2,
                                    "bias by temperature rate", PAIR(NULL, NULL)},
    [IMKI_TERM_WARM_UP] = {AT(bias.warm_up_amplitude), IMKI_FORM_DECAY, 3, "warm-up",
                           TEXTS("warm-up")},
    [IMKI_TERM_RAMP] = {AT(noise.ramp), IMKI_FORM_TIME, 17, "ramp",
                        PAIR("gyro rate ramp", "accelerometer ramp")},
};

/* In the order in which they are summed: that of their fields. */
const imki_power imki_input_powers[] = {
    {IMK_MODEL_K2, 2, 0, true, 1.0},
    {IMK_MODEL_KOQ, 1, 1, true, 1.0},
    {IMK_MODEL_K3, 3, 0, true, 1.0},
    {IMK_MODEL_ASYMMETRY, 0, 1, true, 0.5},
};
const size_t imki_input_power_count = sizeof imki_input_powers / sizeof imki_input_powers[0];

const imki_field *imki_term_field(int term)
{
    const imki_field *field = imki_triad_fields;
    while (field->offset != imki_terms[term].offset)
        field++;
    return field;
}

int imki_field_term(const imki_field *field)
{
    int term = IMKI_TERMS - 1;
    while (term >= 0 && imki_terms[term].offset != field->offset)
        term--;
    return term;
}

bool imki_field_taken_out(const imki_field *field)
{
    const int term = imki_field_term(field);
    return term >= 0 ? term != IMKI_TERM_RAMP : (field->flags & IMKI_OUTPUT) != 0;
}

const char *imki_field_name(const imki_field *field, int kind)
{
    return field->offset == AT(bias.warm_up_amplitude) ? "bias.warm_up" : field->path[kind];
}

/* -1: the sensor has no such term. */
static int group_of(int term, int kind)
{
    const imki_field *field = imki_term_field(term);
    return !field->path[kind] ? -1 : term == IMKI_TERM_RAMP ? 2 : !field->path[1 - kind];
}

size_t imki_terms_in_order(int kind, uint8_t term[IMKI_TERMS])
{
    size_t count = 0;
    for (int group = 0; group < 3; group++)
        for (size_t i = 0; i < imki_triad_field_count; i++) {
            const int found = imki_field_term(&imki_triad_fields[i]);
            if (found >= 0 && group_of(found, kind) == group)
                term[count++] = (uint8_t)found;
        }
    return count;
}

int imki_form_elements(imki_form form)
{
    static const uint8_t elements[] = {[IMKI_FORM_SEEN] = 3,
                                       [IMKI_FORM_CROSS] = 3,
                                       [IMKI_FORM_FORCE] = 3,
                                       [IMKI_FORM_PRODUCT] = 6,
                                       [IMKI_FORM_PLACE] = 3,
                                       [IMKI_FORM_WARMTH] = IMK_TEMPERATURE_ORDER_MAX,
                                       [IMKI_FORM_WARM_INPUT] = IMK_TEMPERATURE_ORDER_MAX,
                                       [IMKI_FORM_TIME] = 1};
    return elements[form] > 0 ? elements[form] : 1;
}

void imki_add_rows(const imk_triad *triad, int axis, imki_form form, double *row)
{
    const int count = imki_form_elements(form);
    for (int term = 0; term < IMK_MODEL_TERMS; term++)
        for (int k = 0; imki_terms[term].form == form && k < count; k++)
            row[k] += imki_term_values(term, triad)[axis * count + k];
}

const char *imki_form_element(imki_form form, int element)
{
    static const char *const components[] = {"x", "y", "z"}, *const cross[] = {"ip", "io", "po"},
                             *const products[] = {"xx", "yy", "zz", "xy", "yz", "zx"},
                             *const powers[] = {"1", "2", "3", "4", "5"};
    const char *const *names = form == IMKI_FORM_CROSS     ? cross
                               : form == IMKI_FORM_PRODUCT ? products
                               : form == IMKI_FORM_WARMTH || form == IMKI_FORM_WARM_INPUT
                                   ? powers
                                   : components;
    return imki_form_elements(form) > 1 ? names[element] : NULL;
}

/* ---- lists, units ---------------------------------------------------------------------------- */

static const imki_field gauss_markov_fields[] = {
    {ALL("sigma"), IMKI_AXES, 0, IN(imk_gauss_markov_term, sigma), NO_COUNT,
     UNITS("deg/h", "ug", "nT"), NO_UNITS, UNITS("rad/s", "m/s^2", "T"), NOT_NEGATIVE},
    {ALL("correlation_time"), IMKI_AXES, IMKI_OPEN | IMKI_TYPICAL,
     IN(imk_gauss_markov_term, correlation_time), NO_COUNT, UNIT("s"), NO_UNITS, UNIT("s"),
     NOT_NEGATIVE},
};

static const imki_field sinusoid_fields[] = {
    {ALL("amplitude"), IMKI_AXES, 0, IN(imk_sinusoid_term, amplitude), NO_COUNT,
     UNITS("deg/h", "ug", "nT"), NO_UNITS, UNITS("rad/s", "m/s^2", "T"), NOT_NEGATIVE},
    {ALL("frequency"), IMKI_AXES, IMKI_OPEN | IMKI_TYPICAL, IN(imk_sinusoid_term, frequency),
     NO_COUNT, UNIT("Hz"), NO_UNITS, UNIT("Hz"), NOT_NEGATIVE},
};

static const imki_field resonance_fields[] = {
    {ALL("sigma"), IMKI_AXES, 0, IN(imk_resonance_term, sigma), NO_COUNT,
     UNITS("deg/h", "ug", "nT"), NO_UNITS, UNITS("rad/s", "m/s^2", "T"), NOT_NEGATIVE},
    {ALL("frequency"), IMKI_AXES, IMKI_OPEN | IMKI_TYPICAL, IN(imk_resonance_term, frequency),
     NO_COUNT, UNIT("Hz"), NO_UNITS, UNIT("Hz"), NOT_NEGATIVE},
    {ALL("q"), IMKI_AXES, IMKI_OPEN | IMKI_TYPICAL | IMKI_BARE, IN(imk_resonance_term, q), NO_COUNT,
     UNIT("1"), NO_UNITS, UNIT("1"), 0.5, DBL_MAX},
};

const imki_field imki_timing_fields[] = {
    {ALL("rate_error"), IMKI_SCALAR, IMKI_OPEN, offsetof(imk_timing, rate_error), NO_COUNT,
     UNIT("ppm"), NO_UNITS, UNIT("1"), -1.0, DBL_MAX},
    {ALL("jitter"), IMKI_SCALAR, 0, offsetof(imk_timing, jitter), NO_COUNT, UNIT("us"), NO_UNITS,
     UNIT("s"), NOT_NEGATIVE},
    {ALL("skew"), IMKI_SCALAR, 0, offsetof(imk_timing, skew), NO_COUNT, UNIT("us"), NO_UNITS,
     UNIT("s"), ANY},
    {ALL("drops"), IMKI_SCALAR, 0, offsetof(imk_timing, drops), NO_COUNT, UNIT("%"), NO_UNITS,
     UNIT("1"), 0.0, 0.99},
};
const size_t imki_timing_field_count = sizeof imki_timing_fields / sizeof imki_timing_fields[0];

imki_list imki_list_of(const imki_field *field)
{
    if (field->offset == AT(noise.gauss_markov))
        return (imki_list){sizeof(struct imk_gauss_markov_term),
                           sizeof gauss_markov_fields / sizeof gauss_markov_fields[0],
                           gauss_markov_fields};
    if (field->offset == AT(noise.sinusoid))
        return (imki_list){sizeof(struct imk_sinusoid_term),
                           sizeof sinusoid_fields / sizeof sinusoid_fields[0], sinusoid_fields};
    return (imki_list){sizeof(struct imk_resonance_term),
                       sizeof resonance_fields / sizeof resonance_fields[0], resonance_fields};
}

const char *imki_polynomial_si(const imki_field *field, int kind, int order)
{
    static const char *const units[IMK_KINDS + 1][IMK_TEMPERATURE_ORDER_MAX] = {
        {"rad/s/K", "rad/s/K^2", "rad/s/K^3", "rad/s/K^4", "rad/s/K^5"},
        {"m/s^2/K", "m/s^2/K^2", "m/s^2/K^3", "m/s^2/K^4", "m/s^2/K^5"},
        {"T/K", "T/K^2", "T/K^3", "T/K^4", "T/K^5"},
        {"1/K", "1/K^2", "1/K^3", "1/K^4", "1/K^5"}};
    bool is_bias = field->offset == AT(bias.temperature);
    return units[is_bias ? kind : IMK_KINDS][order - 1];
}

const char *imki_polynomial_unit(const imki_field *field, int kind, int order)
{
    static const char *const units[IMK_KINDS + 1][IMK_TEMPERATURE_ORDER_MAX] = {
        {"deg/h/K", "deg/h/K^2", "deg/h/K^3", "deg/h/K^4", "deg/h/K^5"},
        {"mg/K", "mg/K^2", "mg/K^3", "mg/K^4", "mg/K^5"},
        {"nT/K", "nT/K^2", "nT/K^3", "nT/K^4", "nT/K^5"},
        {"ppm/K", "ppm/K^2", "ppm/K^3", "ppm/K^4", "ppm/K^5"}};
    bool is_bias = field->offset == AT(bias.temperature);
    return units[is_bias ? kind : IMK_KINDS][order - 1];
}
