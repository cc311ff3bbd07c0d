/* SPDX-License-Identifier: Apache-2.0 */
/* What the files of the extension module share. Each function of the module takes the values that
 * the package checked and named, runs a job of the library without the interpreter's lock, and
 * gives back its result, or raises imukit.Error with the library's sentence.
 *
 * Only the stable ABI of CPython 3.11 is used, so one build serves all later versions. */
#ifndef IMUKIT_EXTENSION_H
#define IMUKIT_EXTENSION_H

#define PY_SSIZE_T_CLEAN
#ifndef Py_LIMITED_API
#define Py_LIMITED_API 0x030b0000
#endif
#include <Python.h>

#include "imukit/job.h"
#include "imukit/log.h"
#include "imukit/model_file.h"
#include "imukit/record.h"
#include "imukit/result.h"
#include "imukit/thread_pool.h"

#include <stdbool.h>

/** @name Errors
 *  @{ */
/** A text of the library, in which arguments stand for options of the command; NULL with an
 *  exception. */
PyObject *told_text(const char *text);
/** Raise imukit.Error, or MemoryError, FileNotFoundError's kind imukit.FileError, with the message
 *  of an error. @param source  name of the file that it is about; NULL: none. @return NULL */
PyObject *raise_error(const imk_error *error, const char *source);
/** The same with another message. @return NULL */
PyObject *raise_message(const imk_error *error, const char *message);
/** Raise what a job failed with: its finding that says why, else the error. @return NULL */
PyObject *raise_failure(const imk_findings *findings, const imk_error *error, const char *record,
                        const char *model);
/** The findings as a list of tuples (level, code, message, name); NULL with an exception. */
PyObject *list_findings(const imk_findings *findings, const char *record, const char *model);
/** Add the classes of exceptions to the module. */
bool add_errors(PyObject *module);
/** @} */

/** @name Work without the interpreter's lock
 *  @{ */
/** A job with its threads, its progress and Ctrl-C. It points into itself. */
typedef struct work {
    imk_job job;
    imk_executor executor;
    imk_thread_pool *pool;
    PyObject *progress;             /* borrowed; NULL: none */
    PyObject *type, *value, *trace; /* what was raised meanwhile */
    PyThreadState *state;
    double asked; /* when signals were looked for last [s] */
} work;

/** Start threads and let go of the lock.
 *  @param threads   0: one per processor
 *  @param progress  called with (stage, unit, done, total); None: not
 *  @return false with an exception */
bool work_begin(work *w, int threads, PyObject *progress);
/** Take the lock again. @return false with the exception that progress or Ctrl-C raised */
bool work_end(work *w);
/** @} */

/** @name Columns of numbers
 *  @{ */
/** Columns that are borrowed from Python objects by the buffer protocol. Numbers that are not
 *  float64 were copied. */
typedef struct columns {
    size_t count, rows;
    double *data[IMK_LOG_COLUMNS_MAX];
    ptrdiff_t stride[IMK_LOG_COLUMNS_MAX]; /* [doubles] */
    size_t views;
    Py_buffer view[IMK_LOG_COLUMNS_MAX];
    double *copy[IMK_LOG_COLUMNS_MAX]; /* to be freed; NULL: none */
} columns;

/** Take columns of equal length: a matrix (rows are samples), or a sequence of vectors.
 *  @param c  released by columns_release(), also after a failure
 *  @return false with an exception: TypeError (no numbers), ValueError (shapes) */
bool columns_take(PyObject *data, columns *c);
/** Take vectors of float64 to be written, each contiguous; errors as above, and for read-only ones.
 */
bool columns_take_writable(PyObject *data, columns *c);
/** Let go of the objects. */
void columns_release(columns *c);
/** @} */

/** A record to be read: arrays of Python objects, or a log. */
typedef struct record {
    PyObject_HEAD imk_record_source source;
    imk_array_source array;
    columns columns;
    void *reader; /* imk_log_reader; NULL: arrays */
    char *name;   /* in messages */
    bool busy;    /* a job reads it */
} record;
/** The record of an argument, marked as busy; NULL with an exception. */
record *record_begin(PyObject *object);
/** It is free again. */
void record_end(record *r);
/** Read settings of a log, as settings_read(). */
bool log_settings_read(PyObject *dictionary, imk_log_settings *settings);
/** A log in memory as a tuple of its columns and counts, which takes it over: it is in memory of
 *  PyMem_Calloc(); NULL with an exception. */
PyObject *describe_log(imk_log *log);
/** A log that grows while a job writes its rows; `sink` points into it. */
typedef struct log_sink {
    imk_record_sink sink;
    imk_log *log;
    size_t capacity;
} log_sink;
/** @return false with an exception */
bool log_sink_begin(log_sink *s);
/** The log as a tuple (describe_log()), with what the source found of its times; NULL: an exception
 *  is set, or is to be. @param source  NULL: the job failed, and there is no log */
PyObject *log_sink_end(log_sink *s, const imk_record_source *source);
/** Make a record of a reader and take it over. @param name  of the log. @return NULL with an
 *  exception; the reader is then closed */
PyObject *record_of_reader(void *reader, const char *name);
/** Add the type to the module. */
bool add_record(PyObject *module);

/** A result as an object, which takes it over; NULL with an exception. */
PyObject *make_result(imk_result *result);
/** An empty result that names what is run; NULL with an exception. */
imk_result *begin_result(const char *command);
/** The result and the findings as a tuple. Takes over the result. */
PyObject *result_with(imk_result *result, const imk_findings *findings, const char *record,
                      const char *model);
/** A tuple with one value more. Both are taken over; NULL for one of them gives NULL. */
PyObject *extended(PyObject *tuple, PyObject *more);
/** Add the type to the module. */
bool add_result(PyObject *module);

/** The bytes of a text, which live as long as it does; NULL with a TypeError for what is no text.
 *  @param size  NULL: not wanted */
const char *utf8_of(PyObject *object, Py_ssize_t *size);

/** @name Settings
 *  @{ */
/** What a setting is in Python, and in the structure. */
typedef enum setting_kind {
    SETTING_NUMBER,   /* double; a number */
    SETTING_QUANTITY, /* double, SI; a number in SI units, or a text with a unit like `words` */
    SETTING_FLAG,     /* bool */
    SETTING_INT,      /* int */
    SETTING_SIZE,     /* size_t */
    SETTING_COUNT,    /* uint64_t */
    SETTING_TEXT,     /* const char *, which lives as long as the dictionary */
    SETTING_CHOICE,   /* int (an enumeration): position in `words`, "octave|decade|all" */
    SETTING_UNIT      /* imk_unit; a text */
} setting_kind;

/** One setting. */
typedef struct setting {
    const char *name;
    setting_kind kind;
    size_t offset; /* in the structure */
    const char *words;
} setting;

/** Read the settings of a dictionary into a structure; None leaves what is there.
 *  @return false with an exception: TypeError (another type, a name that there is not),
 *          ValueError (a choice, a number that does not fit), imukit.Error (a unit) */
bool settings_read(PyObject *dictionary, size_t count, const setting *rows, void *structure);
#define SETTINGS_READ(dictionary, rows, structure)                                                 \
    settings_read(dictionary, sizeof(rows) / sizeof(rows)[0], rows, structure)
/** A number in SI units, or a text with a unit; false with an exception. */
bool quantity_read(PyObject *object, const char *name, const char *unit, double *value);
/** A unit of a text; false with an exception. @param name  in the message; NULL: none */
bool unit_read(PyObject *object, const char *name, imk_unit *unit);
/** @} */

/** A model with the text of its file. */
typedef struct model_object {
    PyObject_HEAD imk_model model;
    imk_document *document; /* NULL: none */
} model_object;
/** Is it a model? */
bool is_model(PyObject *object);
/** The model of an argument; NULL with an exception. It may change when the lock is let go: take a
 *  copy for work without it. */
model_object *model_of(PyObject *object);
/** Make an object of a model, which is copied, and of its document, which is taken over; NULL with
 *  an exception. */
PyObject *make_model(const imk_model *model, imk_document *document);
/** Add the type to the module. */
bool add_model(PyObject *module);

/** Add the type of designs of instruments to the module. */
bool add_design(PyObject *module);
/** Add the type of sensors that are stepped to the module. */
bool add_sensor(PyObject *module);
/** Add the constants of calibration to the module. */
bool add_calibrate(PyObject *module);
/** Add the constants of identification to the module. */
bool add_identify(PyObject *module);

/** The motion of imukit.Motion, which the object keeps; NULL with an exception. */
const struct imk_motion_file *motion_of(PyObject *object);
/** Add the type of simulations to the module. */
bool add_simulate(PyObject *module);

/** Functions of the module, by their files; each ends with a row of zeros. */
extern PyMethodDef allan_functions[];
extern PyMethodDef calibrate_functions[];
extern PyMethodDef compensate_functions[];
extern PyMethodDef design_functions[];
extern PyMethodDef drift_functions[];
extern PyMethodDef evaluate_functions[];
extern PyMethodDef grade_functions[];
extern PyMethodDef identify_functions[];
extern PyMethodDef info_functions[];
extern PyMethodDef model_functions[];
extern PyMethodDef navigate_functions[];
extern PyMethodDef parameter_functions[];
extern PyMethodDef physics_functions[];
extern PyMethodDef plan_functions[];
extern PyMethodDef record_functions[];
extern PyMethodDef sensor_functions[];
extern PyMethodDef simulate_functions[];
extern PyMethodDef spectrum_functions[];
extern PyMethodDef tune_functions[];
extern PyMethodDef unit_functions[];

#endif
