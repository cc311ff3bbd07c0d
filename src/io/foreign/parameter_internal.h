/* SPDX-License-Identifier: Apache-2.0 */
/* What the readers and writers of foreign parameter files share. Each format is one file and two
 * functions; parameter_file.c finds the format, calls them and compares what was written with the
 * model. */
#ifndef IMUKIT_PARAMETER_INTERNAL_H
#define IMUKIT_PARAMETER_INTERNAL_H

#include "io/model/document_internal.h"
#include "report/growing_text_internal.h"

#include "imukit/parameter_file.h"

/* ---- text being written ---------------------------------------------------------------------- */

/* Shortest decimals, `count` of them. */
void imki_text_numbers(imki_text *text, const double *values, int count, const char *separator);
/* "[a, b, c]". */
void imki_text_vector(imki_text *text, const double values[3]);

/* ---- reading and writing --------------------------------------------------------------------- */

typedef struct imki_parameters {
    const imk_parameter_settings *settings;
    imk_parameter_notes *notes; /* may be NULL */
    imk_error *error;           /* may be NULL */
    const char *text;           /* reading: the file, ends with a zero */
    size_t size;
    imk_model *model;        /* reading: to be filled, from its default */
    const imk_model *source; /* writing: valid, triads of three axes */
    imki_text out;           /* writing */
    bool is_json;            /* writing to a file whose name ends in .json */
} imki_parameters;

typedef imk_status imki_parameter_function(imki_parameters *p);

imki_parameter_function imki_kalibr_read, imki_kalibr_write, imki_gazebo_read, imki_gazebo_write,
    imki_matlab_read, imki_matlab_write, imki_gnss_ins_sim_read, imki_gnss_ins_sim_write,
    imki_navego_read, imki_navego_write, imki_openvins_read, imki_openvins_write, imki_vins_read,
    imki_vins_write, imki_px4_read, imki_px4_write, imki_ardupilot_read, imki_ardupilot_write,
    imki_filter_read, imki_filter_write;

/* Read back what was written and note what is not there (parameter_compare.c). `format` is the name
 * for the notes.
 * @return IMK_ERROR_UNSUPPORTED when nothing came back, errors of reading */
imk_status imki_parameters_compare(imki_parameters *p, imki_parameter_function *read,
                                   const char *format);

/* A note: what was left out, or what was assumed. The same text is kept once. */
void imki_note(imki_parameters *p, bool lost, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* ---- numbers --------------------------------------------------------------------------------- */

/* Where a number stands. */
typedef struct imki_place {
    const char *field; /* key, as the file has it */
    size_t line, column;
} imki_place;

imk_status imki_place_error(imki_parameters *p, imki_place place, imk_status status,
                            const char *found, const char *expected);

/* What a number is, for the check whether it can be in the format's unit. */
typedef enum imki_quantity {
    IMKI_WHITE,       /* [unit/sqrt(Hz)] */
    IMKI_RANDOM_WALK, /* [unit/s/sqrt(Hz)] */
    IMKI_BIAS,        /* [unit] */
    IMKI_DRIFT,       /* sigma of a drifting bias [unit] */
    IMKI_TIME,        /* [s], positive */
    IMKI_PLAIN        /* finite is enough */
} imki_quantity;

/* Three numbers of a file, in `unit`, which is `scale` SI units: checked and converted. kind is
 * IMK_GYRO or IMK_ACCEL of the model's schema. */
typedef struct imki_unit {
    const char *name;
    double scale;
} imki_unit;
imk_status imki_accept(imki_parameters *p, imki_place place, int kind, imki_quantity quantity,
                       const double raw[3], imki_unit unit, double si[3]);

/* The number between begin and end, nothing behind it; "inf" is one. */
bool imki_number(const char *begin, const char *end, double *value);

/* ---- YAML and JSON --------------------------------------------------------------------------- */

/* The file as a tree. The first line %YAML:1.0 and the tags of OpenCV are taken for blanks. */
imk_status imki_parameters_document(imki_parameters *p, imk_document **document);

imki_place imki_node_place(const imk_document *document, int node);
/* The text of a scalar node, or "". */
const char *imki_node_text(const imk_document *document, int node);
/* One number for all, or `count` in a list. */
imk_status imki_node_numbers(imki_parameters *p, const imk_document *document, int node, int count,
                             double *values);
/* A list of three lists of three. */
imk_status imki_node_matrix(imki_parameters *p, const imk_document *document, int node,
                            double matrix[3][3]);
/* imki_node_numbers() and imki_accept() of a key's value; nothing happens when it is not there. */
imk_status imki_node_accept(imki_parameters *p, const imk_document *document, int mapping,
                            const char *key, int kind, imki_quantity quantity, imki_unit unit,
                            double si[3]);
/* A key that means nothing here: refused when it is a known one misspelt, else noted as lost. */
imk_status imki_foreign_key(imki_parameters *p, const imk_document *document, int key, size_t count,
                            const char *const *known);

/* ---- model ----------------------------------------------------------------------------------- */

/* What three axes make of a vector without bias: reading = T vector. Rows are axes. */
void imki_response_of(const imk_triad *triad, double matrix[3][3]);
bool imki_is_identity(double matrix[3][3]);
/* The opposite: scale factors and misalignment about the body axes, or, where the matrix turns the
 * axes by more than half a right angle or so, directions and scale factors. cross_axis becomes 0.
 * IMK_ERROR_RANGE when a row is nearly zero. */
imk_status imki_response_set(imki_parameters *p, imki_place place, imk_triad *triad,
                             double matrix[3][3]);
/* matrix = lower * rotation, lower triangular with positive diagonal. False when the matrix is
 * singular or mirrors. */
bool imki_lower_and_rotation(double matrix[3][3], double lower[3][3], double rotation[3][3]);
void imki_multiply(double a[3][3], double b[3][3], double product[3][3]);

/* One Gauss-Markov process; nothing is added when sigma is 0 on all axes. */
void imki_add_gauss_markov(imk_triad *triad, const double sigma[3], const double time[3]);
/* sigma and correlation time of the first one; zeros when there is none. */
void imki_first_gauss_markov(const imk_triad *triad, double sigma[3], double time[3]);
/* Infinite correlation times: the program then draws the drift anew for each sample. Those axes'
 * sigma goes into the white noise of `rate` and becomes 0 here, their time too. */
imk_status imki_white_where_infinite(imki_parameters *p, imki_place place, imk_triad *triad,
                                     double rate, const char *program, double sigma[3],
                                     double time[3]);
void imki_to_axes(const double values[3], imk_axes *axes);
/* For formats with one number for all axes: the largest, with a note when they differ. */
double imki_largest(imki_parameters *p, const char *name, const imk_axes *axes);

/* A bias polynomial of an axis as c[0] … c[3] of powers of T - centre [K] (parameter_cubic.c).
 * @return the largest error over the valid range: 0 up to the third order */
double imki_cubic(const imk_temperature_polynomial *polynomial, int axis, double centre,
                  double c[4]);

/* kalibr's four noise keys, which OpenVINS shares. */
enum { IMKI_KALIBR_NOISE_KEYS = 4 };
extern const char *const imki_kalibr_noise_keys[IMKI_KALIBR_NOISE_KEYS];
imk_status imki_kalibr_noise_read(imki_parameters *p, const imk_document *document, int imu);
void imki_kalibr_noise_write(imki_parameters *p, const char *indent);
/* The mapping that describes the IMU: the root, or one of its values, by settings->sensor. */
imk_status imki_kalibr_imu(imki_parameters *p, const imk_document *document, int *imu);
/* Keys of the set-up, not of the sensor; and one note that names those that say something. */
bool imki_kalibr_is_setup(const char *key);
void imki_kalibr_note_setup(imki_parameters *p, const imk_document *document, int imu);
/* "  - [a, b, c]" three times. */
void imki_text_matrix(imki_text *text, const char *indent, double matrix[3][3]);

/* ---- expressions of MATLAB (parameter_expression.c) ------------------------------------------ */

enum { IMKI_VARIABLES_MAX = 32 };
typedef struct imki_variables {
    size_t count;
    struct {
        char name[32];
        int length; /* 1 or 3 */
        double value[3];
    } variable[IMKI_VARIABLES_MAX];
} imki_variables;

/* The value of the expression between begin and end: a number (broadcast) or three.
 * @return false when it is none that can be read; *stop is then where */
bool imki_expression(const char *begin, const char *end, const imki_variables *variables,
                     int *length, double value[3], const char **stop);

#endif
