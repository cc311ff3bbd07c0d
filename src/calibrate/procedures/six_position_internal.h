/* SPDX-License-Identifier: Apache-2.0 */
/* Holds on the faces of a housing and turns about its axes, as sixposition and ferraris find them
 * in a log. */
#ifndef IMUKIT_SIX_POSITION_INTERNAL_H
#define IMUKIT_SIX_POSITION_INTERNAL_H

#include "imukit/ferraris.h"
#include "procedure_internal.h"

/* ---- six_position_labels.c ---- */

typedef enum imki_label_kind {
    IMKI_LABEL_HOLD = 0, /* also a label that says nothing */
    IMKI_LABEL_TURN,
    IMKI_LABEL_OTHER /* on the way from one to the next */
} imki_label_kind;

typedef struct imki_label {
    imki_label_kind kind;
    int axis;  /* -1: not named */
    int sense; /* 1 up or positive, -1 down or negative, 0 not said */
} imki_label;

imki_label imki_label_parse(const char *text);

/* ---- six_position_holds.c ---- */

typedef struct imki_session_stretch {
    imk_ferraris_stretch at;
    const char *label; /* NULL: found by itself */
    bool again;        /* a hold that a turn led to from the hold before: the same placement */
    imk_static_interval summary;
} imki_session_stretch;

typedef struct imki_session_stretches {
    size_t count, capacity;
    imki_session_stretch *stretch;
    bool detected;          /* by standing still, not by sections */
    size_t found, left_out; /* stretches */
    double sensitivity[3];  /* of accelerometers in counts, found from the holds; 0: was known */
    double zero_offset[3];
    size_t contradictions;             /* holds whose label says another face than the readings */
    imki_session_stretch contradicted; /* the first, with the face of the readings */
} imki_session_stretches;

/* Bytes for the list and the detection. */
size_t imki_stretches_workspace(const imk_test_record *record,
                                const imk_procedure_settings *settings);

/* Holds with their faces, and turns that sections name (without: none yet). The list lives in the
 * workspace. Stretches that show no face are left out. */
imk_status imki_stretches_find(const imk_test_record *record,
                               const imk_procedure_settings *settings, const imk_model *model,
                               double gravity, void *workspace, size_t workspace_size,
                               imki_session_stretches *list, imk_static_findings *stationary,
                               imk_error *error);

/* Every face seen? @return IMK_ERROR_TOO_SHORT, which names those that are missing */
imk_status imki_faces_complete(const imki_session_stretches *list, imk_error *error);

/* ---- six_position.c: what both procedures add ---- */

/* One observation a placement, and the nominal sensitivity of the accelerometers into the model. */
imk_status imki_holds_observe(const imki_procedure_call *call, const imki_session_stretches *list,
                              size_t more, int *fixture);
/* Standard deviations of the Earth's rate in body axes that the attitude does not tell, along the
 * vertical `up` (unit, body axes), and the part that it does tell. */
void imki_earth_at_rest(const imk_calibration *calibration, const double up[3], double rate[3],
                        double sigma[3]);

/* ---- ferraris_turns.c ---- */

/* Means over a turn, weighted with the sample intervals. */
typedef struct imki_turn_means {
    double duration;                 /* [s]; NaN: a gap or a missing reading within */
    double reading[2][IMK_AXES_MAX]; /* in the record's unit */
    double temperature;              /* [K]; NaN: not known */
} imki_turn_means;
imki_turn_means imki_turn_mean(const imk_test_record *record, size_t begin, size_t end);

/* Find the axes of turns that sections did not name, and, in a list that was detected, the turns
 * themselves; and the holds that are no placements of their own. @return IMK_ERROR_TOO_SHORT (field
 * "turn"), IMK_ERROR_KEY_MISSING ("gyro") */
imk_status imki_turns_find(const imk_test_record *record, const imk_procedure_settings *settings,
                           const imk_model *model, imki_session_stretches *list, imk_error *error);

#endif
