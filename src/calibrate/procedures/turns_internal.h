/* SPDX-License-Identifier: Apache-2.0 */
/* Rests and turns by known angles in a log of gyros. */
#ifndef IMUKIT_TURNS_INTERNAL_H
#define IMUKIT_TURNS_INTERNAL_H

#include "six_position_internal.h"

/* A turn about a body axis, from one rest to the next. */
typedef struct imki_known_turn {
    size_t begin, end;
    int body;             /* body axis, 0 to 2 */
    double angle;         /* about it, with sign [rad] */
    bool odd;             /* does not agree with the others: not observed */
    bool stated;          /* its direction; false: as the gyro reads, or in counts as is settled */
    size_t before, after; /* rests */
    double duration;      /* [s] */
    double temperature;   /* [K]; NaN: not known */
    double read[IMK_AXES_MAX];  /* mean readings, less those of the rests, in the record's unit */
    double drift[IMK_AXES_MAX]; /* of the readings from the rest before to that after */
} imki_known_turn;

/* A measurement of what is the same for all of its group. */
typedef struct imki_repeat {
    int group;            /* 0 to 2 */
    double value, weight; /* weight: 1/variance */
    size_t set_aside;     /* of the search */
    bool odd;             /* does not agree with the rest */
} imki_repeat;

typedef struct imki_turn_list {
    imk_test_record record;    /* without accelerometers */
    int body[IMK_AXES_MAX];    /* body axis that each gyro is along */
    int sign[IMK_AXES_MAX];    /* -1: against it */
    bool known;                /* what the readings stand for */
    double unit[IMK_AXES_MAX]; /* of the readings per rad/s; 1 where that is not known */
    size_t rest_count, rest_capacity, turn_count, turn_capacity;
    imk_static_interval *rest;
    imki_known_turn *turn;
    imki_repeat *repeat; /* one of each turn */
} imki_turn_list;

/* Bytes for the list and the detection. */
size_t imki_turn_list_workspace(const imk_test_record *record,
                                const imk_procedure_settings *settings);
/* The list lives in the workspace of the call. Findings about the log are set.
 * @return IMK_ERROR_TOO_SHORT ("hold", "turn"), IMK_ERROR_KEY_MISSING ("gyro"),
 * IMK_ERROR_UNSUPPORTED (directions), errors of imk_static_detect() */
imk_status imki_turn_list_make(const imki_procedure_call *call, imki_turn_list *list);

/* turns_odd.c: which do not agree with the rest. @param chance  that any is found among good ones
 * @param torn  of each group: its repetitions disagree, and do not tell which are odd */
void imki_find_odd(size_t count, imki_repeat *repeat, double chance, bool torn[3]);

#endif
