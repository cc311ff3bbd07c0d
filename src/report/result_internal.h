/* SPDX-License-Identifier: Apache-2.0 */
/* The two parts of a result: the tree of its data, and the list of what is displayed. */
#ifndef IMUKI_RESULT_INTERNAL_H
#define IMUKI_RESULT_INTERNAL_H

#include "jobs/arena_internal.h"

#include "imukit/result.h"

typedef enum imki_data_kind {
    IMKI_DATA_OBJECT = 0,
    IMKI_DATA_ARRAY,
    IMKI_DATA_NUMBER,
    IMKI_DATA_COUNT,
    IMKI_DATA_TEXT,
    IMKI_DATA_FLAG,
    IMKI_DATA_NULL
} imki_data_kind;

typedef struct imki_data {
    imki_data_kind kind;
    const char *key; /* NULL: an element */
    union {
        double number;
        long long count;
        const char *text;
        bool flag;
    } value;
    size_t size; /* of an object or array: its members */
    struct imki_data *first, *last, *next, *parent;
} imki_data;

typedef enum imki_block_kind {
    IMKI_BLOCK_HEADING = 0,
    IMKI_BLOCK_LINE,
    IMKI_BLOCK_FINDING,
    IMKI_BLOCK_CODE,
    IMKI_BLOCK_BREAK,
    IMKI_BLOCK_TABLE,
    IMKI_BLOCK_FIGURE,
    IMKI_BLOCK_ANIMATION,
    IMKI_BLOCK_DRAWING
} imki_block_kind;

typedef struct imki_row {
    size_t count;
    const char **cells;
} imki_row;

struct imk_table {
    imki_arena *arena;
    unsigned right;
    size_t rows, columns; /* columns: of the longest row */
    imki_row *row;
};

struct imk_figure_builder {
    imki_arena *arena;
    imk_figure figure;
    imk_panel *panels; /* what figure.panels points to */
};

typedef struct imki_block {
    imki_block_kind kind;
    imk_audience audience;
    int level;        /* of a finding */
    const char *text; /* or caption */
    imk_table table;
    imk_figure_builder figure;
    imk_animation animation;
    const char *drawing;
    struct imki_block *next;
} imki_block;

struct imk_result {
    imki_arena arena;
    imki_data root, *open; /* the object or array that is being filled */
    imk_audience audience;
    const char *title, *subtitle;
    imk_usability usability;
    const char *judgement; /* NULL: none */
    imki_block *first, *last;
};

#endif
