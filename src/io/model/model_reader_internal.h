/* SPDX-License-Identifier: Apache-2.0 */
/* The state of reading one sensor of a model file, shared by the parts of the reader. */
#ifndef IMUKI_MODEL_READER_INTERNAL_H
#define IMUKI_MODEL_READER_INTERNAL_H

#include "model_yaml_internal.h"

/* One sensor. What fails is kept in `reading`. */
typedef struct imki_reader {
    imki_reading *reading;
    imk_triad *triad;
    int kind;
    int sensor; /* node of the sensor */
    imk_density density;
} imki_reader;

static inline const imki_node *imki_reader_node(const imki_reader *r, int node)
{
    return &r->reading->document->node[node];
}

/* Directions and density, which must be read before the fields. */
void imki_read_direction(imki_reader *r, int node);
void imki_read_density(imki_reader *r, int node);

/* Any other field of the triad. */
void imki_read_field(imki_reader *r, const imki_field *field, int node);

/* A field of shape scalar in any struct. */
void imki_read_scalar(imki_reader *r, const imki_field *field, void *base, int node);

/* One number for all axes, or one for each; sigmas may be NULL. */
void imki_read_per_axis(imki_reader *r, int node, const char *si, unsigned flags, double *values,
                        double *sigmas);

#endif
