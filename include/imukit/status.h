/* SPDX-License-Identifier: Apache-2.0 */
/** @file status.h
 *  Statuses and errors: how every imukit function reports success or failure.
 *
 *  A function that can fail returns an imk_status; its outputs are untouched on error. Validators,
 *  parsers and solvers also fill a caller-owned imk_error, from which imk_error_text() (io.h) makes
 *  the message for a person. */
#ifndef IMUKIT_STATUS_H
#define IMUKIT_STATUS_H

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32) || defined(__wasm__)
#define IMK_API
#else
#define IMK_API __attribute__((visibility("default")))
#endif

/* Around what C and C++ share. */
#ifdef __cplusplus
#define IMK_BEGIN_C extern "C" {
#define IMK_END_C }
#else
#define IMK_BEGIN_C
#define IMK_END_C
#endif

IMK_BEGIN_C

#define IMK_VERSION_MAJOR 0
#define IMK_VERSION_MINOR 1
#define IMK_VERSION_PATCH 0
#define IMK_VERSION "0.1.0"
/** Version of the linked library, "0.1.0"; IMK_VERSION is that of the header. */
IMK_API const char *imk_version(void);

/** All statuses: name, value (fixed for ever) and meaning. */
#define IMK_STATUS_LIST(X)                                                                         \
    X(IMK_OK, 0, "done")                                                                           \
    X(IMK_ERROR_ARGUMENT, -1, "an argument is not valid")                                          \
    X(IMK_ERROR_NOT_FINITE, -2, "a number is not finite")                                          \
    X(IMK_ERROR_RANGE, -3, "a number is outside its valid range")                                  \
    X(IMK_ERROR_SYNTAX, -4, "the text cannot be read")                                             \
    X(IMK_ERROR_UNIT_MISSING, -5, "a number has no unit")                                          \
    X(IMK_ERROR_UNIT_UNKNOWN, -6, "the unit is not known")                                         \
    X(IMK_ERROR_DIMENSION, -7, "the unit has the wrong dimension")                                 \
    X(IMK_ERROR_KEY_UNKNOWN, -8, "the key is not known")                                           \
    X(IMK_ERROR_KEY_DUPLICATE, -9, "the key is given twice")                                       \
    X(IMK_ERROR_KEY_MISSING, -10, "a required key is missing")                                     \
    X(IMK_ERROR_CONFLICT, -11, "two settings exclude each other")                                  \
    X(IMK_ERROR_VERSION, -12, "the format version is not supported")                               \
    X(IMK_ERROR_UNINITIALISED, -13, "the structure was not initialised by its _default function")  \
    X(IMK_ERROR_WORKSPACE, -14, "the workspace is too small")                                      \
    X(IMK_ERROR_MEMORY, -15, "memory is exhausted")                                                \
    X(IMK_ERROR_SINGULAR, -16, "the matrix is singular or not positive definite")                  \
    X(IMK_ERROR_NO_CONVERGENCE, -17, "the iteration did not converge")                             \
    X(IMK_ERROR_TOO_SHORT, -18, "there are too few samples")                                       \
    X(IMK_ERROR_CONSTANT, -19, "the channel is constant")                                          \
    X(IMK_ERROR_TIME_ORDER, -20, "time does not increase")                                         \
    X(IMK_ERROR_GAP, -21, "samples are missing")                                                   \
    X(IMK_ERROR_EMPTY, -22, "there is no data")                                                    \
    X(IMK_ERROR_OPEN, -23, "the file cannot be opened")                                            \
    X(IMK_ERROR_READ, -24, "the file cannot be read")                                              \
    X(IMK_ERROR_WRITE, -25, "the file cannot be written")                                          \
    X(IMK_ERROR_FORMAT, -26, "the file format is not recognised")                                  \
    X(IMK_ERROR_COMPRESSED, -27, "the compressed data is damaged or cut short")                    \
    X(IMK_ERROR_COLUMN, -28, "a column is missing, unknown or duplicated")                         \
    X(IMK_ERROR_RATE_MISSING, -29, "the sampling rate is not known")                               \
    X(IMK_ERROR_UNSUPPORTED, -30, "this is not supported")                                         \
    X(IMK_ERROR_NAME_UNKNOWN, -31, "the name is not known")                                        \
    X(IMK_ERROR_CANCELLED, -32, "the work was cancelled")

typedef enum imk_status {
#define IMK_STATUS_ENUM(name, value, text) name = value,
    IMK_STATUS_LIST(IMK_STATUS_ENUM)
#undef IMK_STATUS_ENUM
} imk_status;

/** Details of a failure. Fields that do not apply are zero or "". */
typedef struct imk_error {
    imk_status status;
    int index;          /**< axis, row or element; -1 when it does not apply */
    double value;       /**< the offending number; of a file that failed errno, or 0 */
    double limit;       /**< the limit that it exceeds */
    size_t line;        /**< in a text, from 1; 0 when it does not apply */
    size_t column;      /**< in that line, from 1 */
    char field[96];     /**< dotted path of the parameter, or name of the column or file */
    char found[96];     /**< the text found, shortened */
    char expected[512]; /**< what is expected there, or what to do: the end of a message */
} imk_error;

/** Name of a status ("IMK_ERROR_RANGE"); "unknown" for a value not in the list. */
IMK_API const char *imk_status_name(imk_status status);

/** One clause that says what a status means ("a number is outside its valid range"). */
IMK_API const char *imk_status_text(imk_status status);

/** Fill an error and return its status, so that a failing function can end with
 *  `return imk_error_set(error, IMK_ERROR_RANGE, "gyro.range", "-3 deg/s", "a positive range");`
 *  @param error    may be NULL; cleared first
 *  @param field,found,expected  copied and shortened at a UTF-8 boundary; NULL is "" */
IMK_API imk_status imk_error_set(imk_error *error, imk_status status, const char *field,
                                 const char *found, const char *expected);

IMK_END_C
#endif
