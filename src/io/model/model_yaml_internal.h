/* SPDX-License-Identifier: Apache-2.0 */
/* What reading, writing and editing model files share. */
#ifndef IMUKI_MODEL_YAML_INTERNAL_H
#define IMUKI_MODEL_YAML_INTERNAL_H

#include "document_internal.h"

#include "imukit/units.h"
#include "model/model_schema_internal.h"

/* imk_quantity_parse() for the dimension of an SI unit; flags IMKI_BARE: the unit may be missing.
 * `text` ends with a zero at `length`. */
imk_status imki_parse_quantity(const char *text, size_t length, const char *si, unsigned flags,
                               size_t max_count, double *values, double *sigmas, size_t *count,
                               imk_unit *unit, imk_error *error);

/* ---- items: everything a model file can say, in the order in which it is written ------------- */

typedef enum imki_item_type {
    IMKI_ITEM_TEXT,      /* name, source, … */
    IMKI_ITEM_SENSOR,    /* that gyro: or accel: stands there */
    IMKI_ITEM_FIELD,     /* a field of a triad */
    IMKI_ITEM_INTERVALS, /* evidence.interval_95 or evidence.upper_bound */
    IMKI_ITEM_TIMING,    /* a field of the timing */
    IMKI_ITEM_CORRELATION
} imki_item_type;

typedef struct imki_item {
    imki_item_type type;
    int kind;                /* IMK_GYRO or IMK_ACCEL */
    const imki_field *field; /* of a field or timing */
    size_t offset;           /* of a text in imk_model */
    bool is_bound;           /* of intervals */
    char path[80];           /* from the root of the file */
} imki_item;

/* Item number `index`; false beyond the last. */
bool imki_item_at(size_t index, imki_item *item);

/* True when both models say the same there (sigmas included). */
bool imki_item_equal(const imki_item *item, const imk_model *a, const imk_model *b);

/* True when the model says nothing there. */
bool imki_item_absent(const imki_item *item, const imk_model *model);

const imk_evidence *imki_evidence_of(const imk_model *model, int kind);

/* True when the interval is the bound of an absent term. */
bool imki_is_bound(const imk_interval *interval, int axis_count);

/* model_yaml_correlation.c. Equal as they are written: to six decimals. */
bool imki_correlation_equal(const imk_correlation *a, const imk_correlation *b);
void imki_read_correlation(imki_reading *reading, imk_correlation *correlation);

/* ---- writing --------------------------------------------------------------------------------- */

typedef enum imki_layout {
    IMKI_BLOCK, /* YAML by indentation */
    IMKI_LINE,  /* one line in braces */
    IMKI_LINES  /* braces, an entry a line */
} imki_layout;

typedef struct imki_writer {
    char *bytes; /* from malloc */
    size_t size, capacity;
    bool failed; /* memory is exhausted */
    imki_layout layout;
    bool is_json;
    int indent;
    bool is_first;              /* of the entries of the mapping being written */
    const imk_document *source; /* texts to keep where values are equal; or NULL */
    const imk_unit *unit;       /* unit to write in if it can be; or NULL */
} imki_writer;

void imki_write_bytes(imki_writer *writer, const char *bytes, size_t size);
void imki_write_text(imki_writer *writer, const char *text);

void imki_write_indent(imki_writer *writer);
/* In double quotes with JSON's escapes; a text, quoted where it must be; a key and its colon. */
void imki_write_quoted(imki_writer *writer, const char *text);
void imki_write_text_value(imki_writer *writer, const char *text);
void imki_write_key(imki_writer *writer, const char *key);

/* An element of a list of terms; an entry of interval_95 or upper_bound: in one line. */
void imki_write_element(imki_writer *writer, const imki_field *field, int kind,
                        const imk_triad *triad, int index);
void imki_write_interval(imki_writer *writer, const imk_interval *interval, int kind,
                         const imk_triad *triad, bool is_bound);

/* In one line; in lines below its key. */
void imki_write_correlation(imki_writer *writer, const imk_correlation *correlation);
void imki_write_correlation_block(imki_writer *writer, const imk_correlation *correlation);

/* Beginning and end of a mapping within a mapping. */
void imki_open_group(imki_writer *writer, const char *key);
void imki_close_group(imki_writer *writer);

/* A key and its value. */
void imki_write_item(imki_writer *writer, const imki_item *item, const imk_model *model);
/* The value alone, in one line. */
void imki_write_item_value(imki_writer *writer, const imki_item *item, const imk_model *model);

/* All of the items first … last - 1 that are not absent, with the groups they stand in below the
 * group of this many components that is already open. */
void imki_write_items(imki_writer *writer, const imk_model *model, size_t first, size_t last,
                      size_t open_components);

/* The whole model. */
void imki_write_model(imki_writer *writer, const imk_model *model);

/* Change a document's text item by item until it says the model. IMK_ERROR_UNSUPPORTED when its
 * structure does not allow that; then write it anew. */
imk_status imki_edit_document(const imk_document *document, const imk_model *model, char **text,
                              size_t *size);

#endif
