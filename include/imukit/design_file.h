/* SPDX-License-Identifier: Apache-2.0 */
/** @file design_file.h
 *  Design files: the parameters of an instrument of instrument.h as YAML 1.1 (or JSON), every
 *  number with its unit. Format: docs/design-file.md.
 *
 *      imukit: 1
 *      instrument: ring_laser
 *      dither: {frequency: 400 Hz}      # what is not given keeps its default
 *
 *  The keys are those of the instrument's table (imk_design_field), nested by the dots of their
 *  paths. */
#ifndef IMUKIT_DESIGN_FILE_H
#define IMUKIT_DESIGN_FILE_H

#include "imukit/physics_log.h"

IMK_BEGIN_C

enum { IMK_DESIGN_NAME_SIZE = 96 };

/** A design that was read. */
typedef struct imk_design_file {
    const imk_instrument *instrument;
    void *design; /**< instrument->design_size bytes from malloc(); imk_design_file_free() */
    char name[IMK_DESIGN_NAME_SIZE]; /**< name stated in the file; "" without */
    char description[256];           /**< description stated in the file; "" without */
} imk_design_file;

/** Read a design file ("-": standard input) and validate the design.
 *  @param file  untouched on error; free with imk_design_file_free()
 *  @return IMK_ERROR_OPEN, _READ, _EMPTY, _FORMAT, _SYNTAX, _VERSION, _KEY_UNKNOWN and
 *          _NAME_UNKNOWN ("did you mean" in error.expected), _KEY_DUPLICATE, _KEY_MISSING,
 *          _UNIT_MISSING, _UNIT_UNKNOWN, _DIMENSION, _NOT_FINITE, _RANGE, _CONFLICT,
 *          _UNSUPPORTED, with line and column; _MEMORY */
IMK_API imk_status imk_design_read(const char *path, imk_design_file *file, imk_error *error);

/** As imk_design_read(), from a text in memory. */
IMK_API imk_status imk_design_parse(const char *text, size_t size, imk_design_file *file,
                                    imk_error *error);

/** As imk_design_parse(), for a known instrument, which need not be in the list of instrument.h. A
 *  file for another instrument is refused with IMK_ERROR_CONFLICT. */
IMK_API imk_status imk_design_parse_as(const imk_instrument *instrument, const char *text,
                                       size_t size, imk_design_file *file, imk_error *error);

/** Get the design of the file `name` or, if there is no such file, the default design of the
 *  instrument with this name. @return errors of imk_design_read() */
IMK_API imk_status imk_design_open(const char *name, imk_design_file *file, imk_error *error);

/** Free the design; a file of zeros is allowed. */
IMK_API void imk_design_file_free(imk_design_file *file);

/** Write a design file: every parameter with its unit and description, as imk_design_print().
 *  @param path  see imk_output_file_open()
 *  @return errors of imk_design_print(); IMK_ERROR_OPEN, _WRITE */
IMK_API imk_status imk_design_write(const char *path, const imk_design_file *file,
                                    imk_error *error);

/** Write a design file into memory obtained from malloc(), which the caller frees. Reading the text
 *  gives the same bits in every field.
 *  @return errors of the instrument's validate; IMK_ERROR_MEMORY */
IMK_API imk_status imk_design_print(const imk_design_file *file, char **text, size_t *size,
                                    imk_error *error);

IMK_END_C
#endif
