/* SPDX-License-Identifier: Apache-2.0 */
/** @file model_file.h
 *  The model file: YAML 1.1 (or JSON), every number with its unit. Format: docs/model-file.md.
 *
 *  A document keeps the text of every value it was read from, so that reading and writing a model
 *  changes nothing, and changing one field changes that field's text only. */
#ifndef IMUKIT_MODEL_FILE_H
#define IMUKIT_MODEL_FILE_H

#include "imukit/model.h"
#include "imukit/result.h"

IMK_BEGIN_C

typedef struct imk_document imk_document;

/** Read a model file ("-": standard input) and validate it.
 *  @param model     untouched on error
 *  @param document  the file's texts, for imk_model_write(); NULL when not wanted;
 *                   free with imk_document_free()
 *  @return IMK_ERROR_OPEN, _READ, _EMPTY, _FORMAT, _SYNTAX, _VERSION, _KEY_UNKNOWN ("did you mean"
 *          in error.expected), _KEY_DUPLICATE, _KEY_MISSING, _CONFLICT, _UNIT_MISSING,
 *          _UNIT_UNKNOWN, _DIMENSION, _NOT_FINITE, _RANGE, _UNSUPPORTED (anchors, aliases, tags,
 *          more than 1 MiB), with line and column */
IMK_API imk_status imk_model_read(const char *path, imk_model *model, imk_document **document,
                                  imk_error *error);

/** The same from memory. */
IMK_API imk_status imk_model_parse(const char *text, size_t size, imk_model *model,
                                   imk_document **document, imk_error *error);

/** Is it a model, or another script of imukit or a parameter file, by its name (.yaml, .yml,
 * .json), or else a model by its content? A pipe can be read after this. */
IMK_API bool imk_model_recognise(const char *path);

/** Free a document; NULL is allowed. */
IMK_API void imk_document_free(imk_document *document);

/** Write a model file. Values equal to those of `document` keep its text, units and order; others
 *  are written in the document's unit or a readable one. Comments are kept where the document has
 *  them before a kept key.
 *  @param path      see imk_output_file_open(); .json writes JSON
 *  @param document  from reading, or NULL */
IMK_API imk_status imk_model_write(const char *path, const imk_model *model,
                                   const imk_document *document, imk_error *error);

/** The same into memory obtained from malloc(), which the caller frees: YAML, or JSON when the
 *  document is JSON. */
IMK_API imk_status imk_model_print(const imk_model *model, const imk_document *document,
                                   char **text, size_t *size, imk_error *error);

/** The same as JSON, whatever the document is. */
IMK_API imk_status imk_model_print_json(const imk_model *model, const imk_document *document,
                                        char **text, size_t *size, imk_error *error);

/** The model of a catalogue name or of a model file, whichever `name` is (a file first). An unknown
 *  name that is no file is IMK_ERROR_NAME_UNKNOWN with the nearest names in error.expected. */
IMK_API imk_status imk_model_open(const char *name, imk_model *model, imk_document **document,
                                  imk_error *error);

/** A value that is JSON already, an object: it is shown like the rest. Its keys are copied.
 *  @return false: it is none; null is added */
IMK_API bool imk_result_json(imk_result *result, const char *key, const char *text);

IMK_END_C
#endif
