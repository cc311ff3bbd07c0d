/* SPDX-License-Identifier: Apache-2.0 */
/* Which column of a record is which axis of a model, and which terms are taken out. */
#ifndef IMUKI_COMPENSATE_INTERNAL_H
#define IMUKI_COMPENSATE_INTERNAL_H

#include "imukit/attitude.h"
#include "imukit/compensate_log.h"

/* How columns of a record and axes of a model belong together, and which columns are written. */
typedef struct imki_compensate_columns {
    int axis[2][IMK_AXES_MAX]; /* of the record: the column of each axis of the model */
    int temperature, time;     /* or -1 */
    size_t count;              /* written */
    imk_log_column column[IMK_LOG_COLUMNS_MAX];
    struct {
        int source;            /* column of the record that is copied, or -1 */
        int sensor, component; /* else what is corrected; sensor 2: the flags */
    } content[IMK_LOG_COLUMNS_MAX];
} imki_compensate_columns;

/* Find the columns of the model's axes; sensors that the record has not, and on which nothing else
 * depends, are taken out of log->model. */
imk_status imki_compensate_match(const imk_record_source *source, imk_compensate_log *log,
                                 imki_compensate_columns *columns, imk_error *error);
/* Columns of the corrected record. */
imk_status imki_compensate_describe(const imk_record_source *source, imk_compensate_log *log,
                                    imki_compensate_columns *columns, imk_error *error);

/* The magnetometer of a record. */
typedef struct imki_magnetic {
    bool present; /* in the record and in the model */
    int column[3];
    double bias[3]; /* [T] */
    imk_matrix3 inverse;
} imki_magnetic;
/* log->model.mag.present says then whether it is corrected. */
void imki_magnetic_start(const imk_record_source *source, imk_compensate_log *log,
                         imki_magnetic *magnetic);
/* Rows begin to before end, in place. */
void imki_magnetic_correct(const imki_magnetic *magnetic, size_t begin, size_t end,
                           double *const *data);

/* What compensation takes out. */
imk_term_keys imki_taken_out(const imk_model *model);
/* What it leaves in: of the terms of the whole model, as far as the sensors are there. */
imk_term_keys imki_left_in(const imk_model *model, const imk_model *whole);
/* Whether a term needs a temperature, and the name of the first. */
bool imki_temperature_term(const imk_model *model, char *name, size_t size);

#endif
