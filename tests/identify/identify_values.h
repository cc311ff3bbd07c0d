/* SPDX-License-Identifier: Apache-2.0 */
/* The estimate from values at 100 Hz: of a record in memory, and in one pass. Used by
 * test_agreement.c and test_level.c. */
#ifndef IMUKIT_TEST_IDENTIFY_VALUES_H
#define IMUKIT_TEST_IDENTIFY_VALUES_H

#include "check.h"
#include "imukit/identify.h"
#include "imukit/identify_record.h"

#include <stdlib.h>

/* @param shape whether lines, resonances and a filter are looked for */
static inline imk_identification identify_values(bool shape, size_t n, const double *x)
{
    imk_identify_settings settings = imk_identify_default();
    imk_identification r;
    const size_t size = imk_identify_workspace_size(n);
    void *workspace = malloc(size);
    settings.dt = 0.01;
    settings.shape = shape;
    CHECK_STATUS(imk_identify_channel(&settings, n, x, &r, workspace, size, NULL), IMK_OK);
    free(workspace);
    return r;
}

static inline imk_identification identify_values_in_one_pass(size_t n, const double *x)
{
    imk_identify_settings settings = imk_identify_default();
    imk_identification r;
    imk_identify_record *record;
    const size_t size = imk_identify_record_size(n);
    void *memory = malloc(size);
    settings.dt = 0.01;
    CHECK_STATUS(imk_identify_record_begin(n, &record, memory, size, NULL), IMK_OK);
    CHECK_STATUS(imk_identify_record_add(record, n, x, NULL), IMK_OK);
    const size_t room = imk_identify_record_workspace_size(record);
    void *workspace = malloc(room);
    CHECK_STATUS(imk_identify_record_finish(record, &settings, &r, workspace, room, NULL), IMK_OK);
    free(workspace);
    free(memory);
    return r;
}

#endif
