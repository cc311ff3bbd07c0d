/* SPDX-License-Identifier: Apache-2.0 */
/* What the readers and writers of foreign parameter files share. Each format is one file and two
 * functions; parameter_file.c finds the format, calls them and compares what was written with the
 * model. */
#ifndef IMUKIT_PARAMETER_INTERNAL_H
#define IMUKIT_PARAMETER_INTERNAL_H

#include "io/model/document_internal.h"
#include "model/model_schema_internal.h"
#include "report/growing_text_internal.h"

#include "imukit/decimal.h"
#include "imukit/parameter_file.h"

/* ---- text being written ---------------------------------------------------------------------- */

/* The shortest decimal; negative zero is of no use to anyone. */
typedef struct imki_decimal {
    char text[IMK_DECIMAL_SIZE];
} imki_decimal;
imki_decimal imki_shortest(double value);
/* Shortest decimals, `count` of them. */
void imki_text_numbers(imki_text *text, const double *values, int count, const char *separator);
/* "[a, b, c]". */
void imki_text_vector(imki_text *text, const double values[3]);

/* ---- reading and writing --------------------------------------------------------------------- */

typedef struct imki_parameters {
    const imk_parameter_settings *settings;
    imk_parameter_notes *notes; /* may be NULL */
    imk_status status;          /* the first failure: what comes after it counts for nothing */
    imk_error *error;           /* of that; may be NULL */
    const char *text;           /* reading: the file, ends with a zero */
    size_t size;
    imk_document *document;     /* reading: the same as a tree, by imki_parameters_document() */
    imk_model *model;           /* reading: to be filled, from its default */
    imk_triad *triad[2];        /* its triads */
    const imk_model *source;    /* writing: valid, triads of three axes */
    const imk_triad *origin[2]; /* its triads */
    imki_text out;              /* writing */
    bool is_json;               /* writing to a file whose name ends in .json */
    bool is_cpp;                /* writing to a file whose name ends as those of C++ do */
    size_t remarks;             /* writing: so many first notes say what stands for the walk */
} imki_parameters;

/* Fills p->model or p->out, or p->status says why not. */
typedef void imki_parameter_function(imki_parameters *p);

/* Of IMK_GYRO and IMK_ACCEL. */
static const char *const imki_kind_units[2] = {"rad/s", "m/s^2"};

imki_parameter_function imki_kalibr_read, imki_kalibr_write, imki_gazebo_read, imki_gazebo_write,
    imki_matlab_read, imki_matlab_write, imki_gnss_ins_sim_read, imki_gnss_ins_sim_write,
    imki_navego_read, imki_navego_write, imki_openvins_read, imki_openvins_write, imki_vins_read,
    imki_vins_write, imki_px4_read, imki_px4_write, imki_ardupilot_read, imki_ardupilot_write,
    imki_filter_read, imki_filter_write, imki_lio_sam_read, imki_lio_sam_write, imki_fast_lio_read,
    imki_fast_lio_write, imki_dlio_read, imki_dlio_write, imki_glim_read, imki_glim_write,
    imki_orb_slam3_read, imki_orb_slam3_write, imki_gtsam_read, imki_gtsam_write, imki_airsim_read,
    imki_airsim_write, imki_fusion_read, imki_fusion_write;

/* The format of a text, which ends with a zero (parameter_recognise.c). */
imk_parameter_format imki_parameter_recognise(const char *text, size_t size);

/* Read back what was written and note what is not there (parameter_compare.c). `format` is the name
 * for the notes. Fails with IMK_ERROR_UNSUPPORTED when nothing came back. */
void imki_parameters_compare(imki_parameters *p, imki_parameter_function *read, const char *format);

/* ---- the random walk that filters need (parameter_walk.c) ------------------------------------ */

/* What a format has for K. */
typedef enum imki_walk {
    IMKI_WALK_NONE,   /* nothing */
    IMKI_WALK_HELD,   /* a place, which may be 0 */
    IMKI_WALK_WANTED, /* the program runs without, but its bias then never changes, or by a default
                       */
    IMKI_WALK_NEEDED, /* the program does not run with 0 */
    IMKI_WALK_OF_EACH /* nor with 0 on one axis */
} imki_walk;

/* What is to be written for p->source: the same, or *changed with what stands for K by the settings
 * use_bounds and bias_instability_tau, which the first p->remarks notes say. Fails when K is
 * missing and the program needs it, or an option could supply it. The caller frees *changed. */
void imki_walk_supply(imki_parameters *p, imki_walk walk, const char *format, imk_model **changed);
/* Those notes as comments, in lines that begin with `prefix`. */
void imki_text_remarks(imki_parameters *p, const char *prefix);

/* A note: what was left out, or what was assumed. The same text is kept once. */
void imki_note(imki_parameters *p, bool lost, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* A failure, unless there was one before. */
void imki_parameter_refuse(imki_parameters *p, imk_status status, const char *field,
                           const char *found, const char *expected);

/* Which of several sensors of a file is meant: that of settings->sensor, or the only one. */
typedef struct imki_choice {
    char names[96]; /* of all, "imu0, imu1" */
    int count, found, chosen;
} imki_choice;
void imki_choice_add(const imki_parameters *p, imki_choice *choice, const char *name, int chosen);
/* Fails when none or several are meant. `several` is "the file has several IMUs", `placeholder`
 * what
 * --sensor takes, "NAME". */
void imki_choice_end(imki_parameters *p, int found, const char *names, const char *placeholder,
                     const char *several);

/* ---- numbers --------------------------------------------------------------------------------- */

/* Where a number stands. */
typedef struct imki_place {
    const char *field; /* key, as the file has it */
    size_t line, column;
} imki_place;

void imki_parameter_refuse_at(imki_parameters *p, imki_place place, imk_status status,
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
 * IMK_GYRO or IMK_ACCEL. */
typedef struct imki_unit {
    const char *name;
    double scale;
} imki_unit;
void imki_accept(imki_parameters *p, imki_place place, int kind, imki_quantity quantity,
                 const double raw[3], imki_unit unit, double si[3]);
bool imki_any(const double values[3]); /* is one of them not 0? */

/* The number between begin and end, nothing behind it; "inf" is one. */
bool imki_number(const char *begin, const char *end, double *value);

/* ---- lines ----------------------------------------------------------------------------------- */

/* Each line of the file, from `line` to `end`, until one fails. */
typedef void imki_line_function(imki_parameters *p, void *context, const char *line,
                                const char *end, size_t number);
void imki_each_line(imki_parameters *p, imki_line_function *take, void *context);

/* Lines `NAME VALUE`, with `separators` between them; the value goes where target_of() says, NULL:
 * the name means nothing. Up to `numbers` numbers may stand before the name. */
typedef struct imki_assignments {
    const char *separators;
    int numbers;
    double *(*target_of)(void *context, const char *name, size_t line);
    void *context;
} imki_assignments;
void imki_read_assignments(imki_parameters *p, imki_assignments *assignments);

/* ---- YAML and JSON --------------------------------------------------------------------------- */

/* The file as p->document. The first line %YAML:1.0 and the tags of OpenCV, and in JSON the
 * comments that nlohmann's reader can skip, are taken for blanks.
 * @return false when it has failed */
bool imki_parameters_document(imki_parameters *p);

/* What p->document has at a node. */
imki_place imki_node_place(const imki_parameters *p, int node);
bool imki_node_is(const imki_parameters *p, int node, imki_node_kind kind); /* IMKI_NONE: no */
/* The text of a scalar node, or "". */
const char *imki_node_text(const imki_parameters *p, int node);
int imki_node_value(const imki_parameters *p, int mapping, const char *key);
/* The key of a mapping behind another, whose value lies between them. */
int imki_key_after(const imki_parameters *p, int key);
void imki_refuse_node(imki_parameters *p, int node, imk_status status, const char *found,
                      const char *expected);
/* One number for all, or `count` in a list. */
void imki_node_numbers(imki_parameters *p, int node, int count, double *values);
/* A list of three lists of three. */
void imki_node_matrix(imki_parameters *p, int node, double matrix[3][3]);
/* imki_node_numbers() and imki_accept() of a key's value; nothing happens when it is not there. */
void imki_node_accept(imki_parameters *p, int mapping, const char *key, int kind,
                      imki_quantity quantity, imki_unit unit, double si[3]);
/* The next mapping from node `from` on, anywhere in the tree, that has one of the keys; IMKI_NONE:
 * there is no further. */
int imki_mapping_with(const imk_document *document, int from, size_t count,
                      const char *const *keys);
/* The only one; fails when there is none or when there are several. */
int imki_only_mapping_with(imki_parameters *p, size_t count, const char *const *keys);
/* How many keys of a mapping are none of these, as a note. */
void imki_note_others(imki_parameters *p, int mapping, size_t count, const char *const *known);
bool imki_is_one_of(const char *name, size_t count, const char *const *names);
/* A key that means nothing here: refused when it is a known one misspelt, else noted as lost. */
void imki_foreign_key(imki_parameters *p, int key, size_t count, const char *const *known);
/* All keys of a mapping but the known ones. */
void imki_foreign_keys(imki_parameters *p, int mapping, size_t count, const char *const *known);

/* ---- model ----------------------------------------------------------------------------------- */

/* What three axes make of a vector without bias: reading = T vector. Rows are axes. */
void imki_response_of(const imk_triad *triad, double matrix[3][3]);
bool imki_is_identity(double matrix[3][3]);
/* The opposite: scale factors and misalignment about the body axes, or, where the matrix turns the
 * axes by more than half a right angle or so, directions and scale factors. cross_axis becomes 0.
 * Fails with IMK_ERROR_RANGE when a row is nearly zero. */
void imki_response_set(imki_parameters *p, imki_place place, imk_triad *triad, double matrix[3][3]);
/* The matrix that takes readings back to the vector; fails with IMK_ERROR_UNSUPPORTED when the axes
 * of the sensor (`name`) are not independent. */
void imki_correction_of(imki_parameters *p, const imk_triad *triad, const char *name,
                        double matrix[3][3]);
/* The opposite of that: imki_response_set() of the inverse. */
void imki_correction_set(imki_parameters *p, imki_place place, imk_triad *triad,
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
void imki_white_where_infinite(imki_parameters *p, imki_place place, imk_triad *triad, double rate,
                               const char *program, double sigma[3], double time[3]);
/* The four densities of a visual-inertial estimator: white noise and random walk of the gyros, then
 * of the accelerometers. */
enum { IMKI_DENSITIES = 4 };
void imki_densities_read(imki_parameters *p, int mapping, const char *const keys[IMKI_DENSITIES],
                         const imki_unit units[IMKI_DENSITIES]);
/* One number for all axes: see imki_largest(). */
double imki_density(imki_parameters *p, int index, const char *key);
/* Which axis that was, for a comment: ", axis y (the largest)", or "" when they are alike. */
const char *imki_axis_taken(const imki_parameters *p, int index);
/* Lines "KEY: NUMBER  # UNIT" of the densities over `scale`, or of the squares of that. A sensor
 * that the model lacks has no line, which is noted if the program needs both. */
typedef struct imki_density_lines {
    const char *const *keys;  /* of IMKI_DENSITIES */
    const char *const *units; /* as the comment has them, "[rad/s/sqrt(Hz)]" */
    const char *indent;
    double scale;
    bool squared, both_needed;
    bool with_point; /* a number always has a decimal point */
} imki_density_lines;
void imki_densities_write(imki_parameters *p, const imki_density_lines *lines);
/* imki_densities_read() of a file that may lack a key, which is noted. */
void imki_densities_read_some(imki_parameters *p, int mapping,
                              const char *const keys[IMKI_DENSITIES],
                              const imki_unit units[IMKI_DENSITIES]);
/* Standard deviations of variances. Fails where one is negative or not finite. */
void imki_square_roots(imki_parameters *p, imki_place place, int count, double *values);
/* For formats with one number for all axes: the largest, with a note when they differ. */
double imki_largest(imki_parameters *p, const char *name, const imk_axes *axes);

/* A bias polynomial of an axis as c[0] … c[3] of powers of T - centre [K] (parameter_cubic.c).
 * @return the largest error over the valid range: 0 up to the third order */
double imki_cubic(const imk_temperature_polynomial *polynomial, int axis, double centre,
                  double c[4]);

/* kalibr's four noise keys, which OpenVINS shares. */
extern const char *const imki_kalibr_noise_keys[IMKI_DENSITIES];
void imki_kalibr_noise_read(imki_parameters *p, int imu);
void imki_kalibr_noise_write(imki_parameters *p, const char *indent);
/* The mapping that describes the IMU: the root, or one of its values, by settings->sensor. */
int imki_kalibr_imu(imki_parameters *p);
/* One note that names the keys of the set-up, not of the sensor, that say something. */
void imki_kalibr_note_setup(imki_parameters *p, int imu);
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
