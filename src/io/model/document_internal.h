/* SPDX-License-Identifier: Apache-2.0 */
/* A model file as a tree of nodes that know where in the text they stand, so that errors have a
 * line and column and single values can be exchanged without touching the rest. */
#ifndef IMUKI_DOCUMENT_INTERNAL_H
#define IMUKI_DOCUMENT_INTERNAL_H

#include "imukit/model_file.h"

enum {
    IMKI_DOCUMENT_SIZE_MAX = 1 << 20, /* bytes of a model file: a hundred times the longest real */
    IMKI_DOCUMENT_NODES_MAX = 10000,
    IMKI_DOCUMENT_DEPTH_MAX = 16,
    IMKI_NONE = -1
};

typedef enum imki_node_kind {
    IMKI_NODE_SCALAR,
    IMKI_NODE_SEQUENCE,
    IMKI_NODE_MAPPING
} imki_node_kind;

typedef struct imki_node {
    imki_node_kind kind;
    bool is_flow;        /* sequence or mapping in brackets */
    bool is_plain;       /* scalar without quotes */
    char *text;          /* of a scalar, without quotes, ends with a zero */
    size_t length;       /* of that text */
    size_t begin, end;   /* byte range in the document */
    size_t line, column; /* of the beginning, from 1 */
    int parent, key;     /* IMKI_NONE at the root; key: of a mapping's value */
    int first, last;     /* children; in a mapping key, value, key, value … */
    int next;            /* sibling */
    int count;           /* of children */
} imki_node;

struct imk_document {
    char *text; /* ends with a zero that does not belong to it */
    size_t size;
    imki_node *node; /* [0] is the root, a mapping */
    int node_count;
    bool is_json;    /* the root is in braces and its keys are quoted */
    imk_model model; /* what the text says */
};

/* Read the text into a tree; document->model is left alone. */
imk_status imki_document_parse(const char *text, size_t size, imk_document **document,
                               imk_error *error);

/* The same for files of another kind, which messages call "a <what> file, beginning with <head>".
 */
imk_status imki_document_parse_as(const char *what, const char *head, const char *text, size_t size,
                                  imk_document **document, imk_error *error);

/* The same for files that may be `times` as long and have as many more values. */
imk_status imki_document_parse_large(const char *what, const char *head, int times,
                                     const char *text, size_t size, imk_document **document,
                                     imk_error *error);

/* Value of a key of a mapping; IMKI_NONE when there is none. */
int imki_document_value(const imk_document *document, int mapping, const char *key);

/* Node at a dotted path below `start` ("noise.gauss_markov[1].sigma"), or the nearest one above it
 * that exists; *complete says which. */
int imki_document_find(const imk_document *document, int start, const char *path, bool *complete);

/* Dotted path of a node. */
void imki_document_path(const imk_document *document, int node, char *text, size_t size);

/* End of the text of a node and of all that is in it, without comments behind it. */
size_t imki_document_end(const imk_document *document, int node);

/* Fill the error with the node's path, line and column, and return the status. */
imk_status imki_document_error(const imk_document *document, int node, imk_status status,
                               const char *found, const char *expected, imk_error *error);

/* ---- reading: document_reading.c ------------------------------------------------------------- */

/* A document that is read, and the first failure: what comes after it counts for nothing. */
typedef struct imki_reading {
    const imk_document *document;
    imk_error *error; /* may be NULL */
    imk_status status;
} imki_reading;

/* A failure at a node, unless there was one before. */
void imki_value_refuse(imki_reading *reading, int node, imk_status status, const char *found,
                       const char *expected);
/* The same, found being the node's text. */
void imki_refuse_value(imki_reading *reading, int node, imk_status status, const char *expected);
/* A key that is none of these: "did you mean" the nearest of them, or all. */
void imki_refuse_key(imki_reading *reading, int key, size_t count, const char *const *names);
/* The same of a value. `found` is its name, or more. */
void imki_refuse_name(imki_reading *reading, int node, const char *name, const char *found,
                      size_t count, const char *const *names);

/* IMK_ERROR_SYNTAX unless the node is of this kind. @return false after any failure */
bool imki_value_require(imki_reading *reading, int node, imki_node_kind kind, const char *expected);

/* Text of a node, or of a key of the root; "" where there is none. It is shorter than `size`. */
void imki_value_text(imki_reading *reading, int node, char *text, size_t size);
void imki_value_name(imki_reading *reading, const char *key, char *text, size_t size);

/* All keys of a mapping are among these; the version key of the root says 1. */
void imki_value_keys(imki_reading *reading, int mapping, size_t count, const char *const *names);
void imki_value_version(imki_reading *reading, const char *key);
/* A key that must be there. @return false after any failure */
bool imki_value_find(imki_reading *reading, int mapping, const char *key, const char *expected,
                     int *node);
/* "yes" and "no" as YAML has them; or other words, of which the first three mean true. */
extern const char *const imki_yes_no[6];
void imki_value_choice(imki_reading *reading, int node, const char *const words[6],
                       const char *expected, bool *value);
/* Digits only, from `least` to `most`. */
size_t imki_value_count(imki_reading *reading, int node, size_t least, size_t most,
                        const char *expected);

/* model_yaml_read.c: the model that the tree says. Ranges are left to imk_model_validate(). */
imk_status imki_document_read_model(const imk_document *document, imk_model *model,
                                    imk_error *error);

/* Tree, model in document->model, and validation if asked. */
imk_status imki_document_open(const char *text, size_t size, bool validate, imk_document **document,
                              imk_error *error);

#endif
