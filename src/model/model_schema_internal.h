/* SPDX-License-Identifier: Apache-2.0 */
/* One table of everything a sensor model can say: where it stands in the file and in the struct,
 * its shape, its units and its valid range. Validation, comparison, reading and writing all walk
 * this table, in its order, so that a new term is one new row. */
#ifndef IMUKI_MODEL_SCHEMA_INTERNAL_H
#define IMUKI_MODEL_SCHEMA_INTERNAL_H

#include "imukit/model.h"

#include <math.h>

typedef enum imki_shape {
    IMKI_SCALAR,       /* imk_scalar */
    IMKI_AXES,         /* imk_axes */
    IMKI_OFF_DIAGONAL, /* imk_rows of which the diagonal is 0 */
    IMKI_ROWS,         /* imk_rows */
    IMKI_QUADRATIC,    /* imk_quadratic_rows */
    IMKI_POLYNOMIAL,   /* imk_temperature_polynomial */
    IMKI_DENSITY,      /* imk_density */
    IMKI_DIRECTION,    /* axis_count and direction */
    IMKI_PENDULOUS,    /* pendulous_axis: a direction for each axis, or zeros */
    IMKI_LIST          /* a list of terms: struct { imk_axes … } [IMK_TERMS_MAX] and its count */
} imki_shape;

enum {
    IMKI_OPEN = 1,      /* the limits themselves are excluded */
    IMKI_BARE = 2,      /* a pure number: needs no unit */
    IMKI_FLOOR = 4,     /* another way to state the field before: times sqrt(2 ln 2/pi) */
    IMKI_TYPICAL = 8,   /* 0 is allowed beside the range: no such thing on this axis */
    IMKI_OUTPUT = 16,   /* says what the outputs are: no error */
    IMKI_COMPANION = 32 /* says how another term acts, or when a reading is saturated */
};

typedef struct imki_field {
    const char
        *path[IMK_KINDS]; /* dotted, below the sensor (or below the list); NULL: not of this kind */
    imki_shape shape;
    unsigned flags;
    size_t offset;               /* in imk_triad; of a list's field in the list's element */
    size_t count_offset;         /* IMKI_LIST: of the int that counts the elements */
    const char *unit[IMK_KINDS]; /* as written when the file does not have it otherwise */
    const char
        *density[IMK_KINDS];   /* the same where the file states a density; NULL: no difference */
    const char *si[IMK_KINDS]; /* the unit of the struct; gives the dimension */
    double minimum, maximum;
} imki_field;

/* What a sensor is called in the file, by its kind. */
extern const char *const imki_kind_names[IMK_KINDS];

/* A kind of list term. */
typedef struct imki_list {
    size_t size; /* of an element */
    size_t field_count;
    const imki_field *field;
} imki_list;

/* The fields of a triad, in the order in which they are written. */
extern const imki_field imki_triad_fields[];
extern const size_t imki_triad_field_count;

/* The fields of imk_timing (path[0], unit[0]; offsets in imk_timing). */
extern const imki_field imki_timing_fields[];
extern const size_t imki_timing_field_count;

/* Fields of a list's elements; `field` has shape IMKI_LIST. */
imki_list imki_list_of(const imki_field *field);

/* SI unit of the coefficient of power `order` (1 … 5) of a temperature polynomial, and the unit it
 * is written in: "rad/s/K^2", "deg/h/K^2". */
const char *imki_polynomial_si(const imki_field *field, int kind, int order);
const char *imki_polynomial_unit(const imki_field *field, int kind, int order);

/* Numbers of a row of this shape: 3 or 6; 1 for axes and scalars. */
int imki_row_length(imki_shape shape);

/* Where number k of a row goes when its sensor is turned on by `turn` body axes in cyclic order:
 * squares and the products xy, yz, zx turn as components do. Kip, Kio, Kpo are of the sensor
 * itself. */
int imki_turned_element(const imki_field *field, int k, int turn);

/* Value and sigma arrays of a field of shape scalar … quadratic: row i, number j at
 * [i * imki_row_length() + j]. `base` is the triad, the list element or the timing. */
const double *imki_field_values(const imki_field *field, const void *base);
const double *imki_field_sigmas(const imki_field *field, const void *base);

/* Rows of a field in a triad of `axis_count`: 1 for a scalar. */
int imki_field_rows(const imki_field *field, int axis_count);

/* Element `index` of a list, and how many there are. */
const void *imki_list_element(const imki_field *field, const imk_triad *triad, int index);
int imki_list_count(const imki_field *field, const imk_triad *triad);

/* True when the field has the same values (and sigmas, if asked) in both triads; they must have
 * equal axis counts except for IMKI_DIRECTION. */
bool imki_field_equal(const imki_field *field, const imk_triad *a, const imk_triad *b,
                      bool with_sigmas);

/* Bit of a field in stated_zero; 0: the field is no set of plain numbers. */
uint64_t imki_field_bit(const imki_field *field);
/* True when the numbers of the field are 0 and stated to be. */
bool imki_field_stated_zero(const imki_field *field, const imk_triad *triad);

/* Terms without which a sensor's errors are not known: those that model_unstated.c looks for. */
bool imki_field_expected(const imki_field *field, int kind);

/* True when the field has its default in the triad, so that it need not be written unless it is
 * stated to be zero. */
bool imki_field_absent(const imki_field *field, const imk_triad *triad);

/* The same of the numbers of a field of shape scalar … quadratic. */
bool imki_numbers_equal(const imki_field *field, const void *a, const void *b, int axis_count,
                        bool with_sigmas);

/* The first field of a triad with a number or a sigma that is not finite; NULL: all are. */
const imki_field *imki_triad_not_finite(const imk_triad *triad);

/* What a check refuses: part.field[element].member of a model, of this axis or row. NULL and -1
 * stand for what the place does not have. */
typedef struct imki_fault {
    const char *part, *field, *member; /* of the member the element of a list, if any */
    int element, index;
    double value, limit;
    const char *found, *expected;
} imki_fault;

/* Every field against its range, then what the ranges of single fields cannot say: settings that
 * need or exclude one another. Where the status is not IMK_OK the fault has all but its part. */
imk_status imki_triad_check(const imk_triad *triad, int kind, imki_fault *fault);
imk_status imki_timing_check(const imk_timing *timing, imki_fault *fault);

/* The field of a triad with this dotted path, "noise.gauss_markov.sigma" included (then *list is
 * the list it belongs to, else NULL); NULL when there is none. */
const imki_field *imki_field_find(const char *path, int kind, const imki_field **list);

/* ---- terms: what a field does to a reading --------------------------------------------------- */

/* What a number of a term is multiplied by: u is the input along the axis, v what the axis sees,
 * f the specific force (distort.h). */
typedef enum imki_form {
    IMKI_FORM_ONE,
    IMKI_FORM_INPUT,      /* u */
    IMKI_FORM_POWER,      /* a power of u: imki_input_powers */
    IMKI_FORM_SEEN,       /* components of v */
    IMKI_FORM_CROSS,      /* u p, u o, p o */
    IMKI_FORM_FORCE,      /* of a gyro: components of f */
    IMKI_FORM_PRODUCT,    /* of a gyro: fx^2, fy^2, fz^2, fx fy, fy fz, fz fx */
    IMKI_FORM_PLACE,      /* of an accelerometer: what a unit of length makes of the rotation */
    IMKI_FORM_WARMTH,     /* powers of the temperature */
    IMKI_FORM_WARM_INPUT, /* u times these */
    IMKI_FORM_WARMING,    /* dT/dt */
    IMKI_FORM_DECAY,      /* e^(-t/time) of the warm-up */
    IMKI_FORM_TIME        /* t */
} imki_form;

/* Behind imk_model_term: terms that no calibration finds. */
enum { IMKI_TERM_WARM_UP = IMK_MODEL_TERMS, IMKI_TERM_RAMP, IMKI_TERMS };

typedef struct imki_term {
    size_t offset; /* of its field */
    imki_form form;
    int draw;            /* number of its draws in drift_residual.c, fixed for ever */
    const char *title;   /* as calibration calls it */
    const char *text[2]; /* as a source of drift; NULL: none */
} imki_term;
extern const imki_term imki_terms[IMKI_TERMS];

/* The field of a term, and the term of a field or -1. */
const imki_field *imki_term_field(int term);
int imki_field_term(const imki_field *field);

/* True for what compensation takes out of readings, as far as a model has it. */
bool imki_field_taken_out(const imki_field *field);

/* What a field is called as a term: its path, but "bias.warm_up" for the amplitude of it. */
const char *imki_field_name(const imki_field *field, int kind);

/* The terms of a sensor in the order in which results are told: those that both kinds of sensor
 * have, its own, the ramp; each group in the order of the fields. @return how many */
size_t imki_terms_in_order(int kind, uint8_t term[IMKI_TERMS]);

/* Numbers of a form for each axis, and what they are called ("x", "xy"); NULL where it is one. */
int imki_form_elements(imki_form form);
const char *imki_form_element(imki_form form, int element);

/* Values of a term, in which those of axis i begin at [i * imki_form_elements()]; of powers of the
 * temperature each is an imk_axes. */
static inline const double *imki_term_values(int term, const imk_triad *triad)
{
    return (const double *)(const void *)((const char *)triad + imki_terms[term].offset);
}

/* Add the numbers of an axis of all terms of a form: imki_form_elements() of them. */
void imki_add_rows(const imk_triad *triad, int axis, imki_form form, double *row);

/* weight u^p |u|^q, p + q > 0 */
typedef struct imki_power {
    uint8_t term;
    uint8_t p, q; /* q is 0 or 1 */
    bool sought;  /* by procedures without being named */
    double weight;
} imki_power;
enum { IMKI_POWERS_MAX = 8 };
extern const imki_power imki_input_powers[];
extern const size_t imki_input_power_count;

/* The power that a term of IMKI_FORM_POWER is. */
static inline int imki_power_of(int term)
{
    int power = 0;
    while (imki_input_powers[power].term != term)
        power++;
    return power;
}

/* p + q of it */
static inline int imki_power_degree(int term)
{
    const imki_power *power = &imki_input_powers[imki_power_of(term)];
    return power->p + power->q;
}

static inline double imki_power_at(const imki_power *power, double u)
{
    double x = power->q ? power->weight * fabs(u) : power->weight;
    for (int k = 0; k < power->p; k++)
        x *= u;
    return x;
}

/* Derivative by u of a power with this coefficient (and weight); `side` is the sign of u. */
static inline double imki_power_slope(const imki_power *power, double coefficient, double u,
                                      double side)
{
    double x = (power->p + power->q) * coefficient;
    if (power->p == 0)
        return side * x;
    if (power->q)
        x *= fabs(u);
    for (int k = 1; k < power->p; k++)
        x *= u;
    return x;
}

/* sqrt(2 ln 2/pi): the flat floor of the Allan deviation of flicker noise of instability 1
 * [IEEE952]. */
#define IMKI_ALLAN_FLOOR 0.66428247026796002

#endif
