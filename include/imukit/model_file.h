/* SPDX-License-Identifier: Apache-2.0 */
/** @file model_file.h
 *  The model file: YAML 1.1 (or JSON), every number with its unit. Format: docs/model-file.md.
 *
 *  A document keeps the text from which every value was read. So a model that is read and written
 *  is unchanged, and changing one field changes only that field's text. */
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

/** Read a model file from a text in memory; see imk_model_read(). */
IMK_API imk_status imk_model_parse(const char *text, size_t size, imk_model *model,
                                   imk_document **document, imk_error *error);

/** True when a file is a script or parameter file by its name (.yaml, .yml, .json), or a model by
 *  its content. A pipe can still be read afterwards. */
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

/** Write a model file into memory obtained from malloc(), which the caller frees: YAML, or JSON
 *  when the document is JSON. See imk_model_write(). */
IMK_API imk_status imk_model_print(const imk_model *model, const imk_document *document,
                                   char **text, size_t *size, imk_error *error);

/** As imk_model_print(), but always JSON. */
IMK_API imk_status imk_model_print_json(const imk_model *model, const imk_document *document,
                                        char **text, size_t *size, imk_error *error);

/** Get a model by the name of a model file or, if there is no such file, of a catalogue entry.
 *  @return errors of imk_model_read(); IMK_ERROR_NAME_UNKNOWN when it is neither (nearest names in
 *          error.expected) */
IMK_API imk_status imk_model_open(const char *name, imk_model *model, imk_document **document,
                                  imk_error *error);

/** Add a JSON object, given as text, to the data of a result. Its keys are copied.
 *  @return false when the text is not a JSON object; null is then added */
IMK_API bool imk_result_json(imk_result *result, const char *key, const char *text);

IMK_END_C
#endif
