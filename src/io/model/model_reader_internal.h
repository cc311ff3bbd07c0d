/* SPDX-License-Identifier: Apache-2.0 */
/* The state of reading one sensor of a model file, shared by the parts of the reader. */
#ifndef IMUKI_MODEL_READER_INTERNAL_H
#define IMUKI_MODEL_READER_INTERNAL_H

#include "model_yaml_internal.h"

typedef struct imki_reader {
    const imk_document *document;
    imk_error *error;
    imk_triad *triad;
    int kind;
    int sensor; /* node of the sensor */
    imk_density density;
} imki_reader;

static inline const imki_node *imki_reader_node(const imki_reader *r, int node)
{
    return &r->document->node[node];
}

/* An error at a node: found is the node's text. */
static inline imk_status imki_reader_fail(const imki_reader *r, int node, imk_status status,
                                          const char *expected)
{
    const imki_node *n = imki_reader_node(r, node);
    return imki_document_error(r->document, node, status,
                               n->kind == IMKI_NODE_SCALAR ? n->text : "", expected, r->error);
}

/* IMK_ERROR_SYNTAX unless the node is of this kind. */
imk_status imki_reader_require(const imki_reader *r, int node, imki_node_kind kind,
                               const char *expected);

/* Directions and density, which must be read before the fields. */
imk_status imki_read_direction(imki_reader *r, int node);
imk_status imki_read_density(imki_reader *r, int node);

/* Any other field of the triad. */
imk_status imki_read_field(imki_reader *r, const imki_field *field, int node);

/* A field of shape scalar in any struct. */
imk_status imki_read_scalar(imki_reader *r, const imki_field *field, void *base, int node);

/* One number for all axes, or one for each; sigmas may be NULL. */
imk_status imki_read_per_axis(imki_reader *r, int node, const char *si, unsigned flags,
                              double *values, double *sigmas);

#endif
