/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzz entry point of the motion script: any bytes are read or refused; what is read has finite
 * steps, and a short script is compiled into a trajectory that is valid. Compiling takes 4 us a
 * piece, with the sanitizers five times that: scripts of many pieces are left to the tests.
 * Reads: src/io/motion/motion_file.c src/io/motion/motion_script_read.c
 * src/io/motion/step_read.c src/io/motion/step_text.c src/io/motion/vibration_lines.c
 * src/motion/script_check.c */
#include "harness.h"

#include "imukit/motion_file.h"

#include "io/motion/motion_file_internal.h"

#include <math.h>
#include <stdlib.h>

enum { RAMPS = 30, PIECES_MAX = 300 };

/* Check the steps. @return whether they are compiled into few pieces: some for each beginning and
 * end, one for 0.2 rad of a turn or 10 s of a way, some for each cycle. */
static bool check_steps(const imki_script_reader *reader)
{
    double pieces = 0.0;
    for (size_t i = 0; i < reader->step_count; i++) {
        const imk_motion_step *step = &reader->step[i];
        require(isfinite(step->amount) && isfinite(step->rate) && isfinite(step->duration) &&
                isfinite(step->frequency));
        require(step->rate >= 0.0 && step->duration >= 0.0 && step->frequency >= 0.0);
        require(step->axis >= 0 && step->axis <= 2);
        require(reader->step_node[i] > 0 &&
                reader->step_node[i] < reader->reading.document->node_count);
        pieces += RAMPS + 5.0 * fabs(step->amount) +
                  0.1 * imk_motion_step_duration(&reader->script, i) +
                  RAMPS * step->duration * step->frequency;
    }
    return pieces < PIECES_MAX && fabs(reader->script.speed) < 1e3;
}

static bool read_steps(const char *text, size_t size, imk_status *status)
{
    imk_document *document = NULL;
    imki_script_reader reader;
    imk_error error = {.status = IMK_OK};
    bool is_quick = false;
    *status = imki_document_parse_as("motion", "imukit_motion: 1", text, size, &document, &error);
    if (*status == IMK_OK) {
        *status = imki_script_read(document, NULL, &reader, &error);
        if (*status == IMK_OK)
            is_quick = check_steps(&reader);
        free(reader.step);
        free(reader.step_node);
    }
    require_told(*status, &error);
    imk_document_free(document);
    return is_quick;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    imk_status status;
    imk_motion_file *file = NULL;
    imk_error error = {.status = IMK_OK};
    const bool is_quick = read_steps((const char *)data, size, &status);
    if (status == IMK_OK && !is_quick)
        return 0;
    const imk_status whole = imk_motion_parse((const char *)data, size, NULL, 1, &file, &error);
    require_told(whole, &error);
    require((file != NULL) == (whole == IMK_OK));
    require(status == IMK_OK || whole == status);
    if (file) {
        require(imk_motion_file_duration(file) > 0.0);
        require(imk_trajectory_validate(imk_motion_file_motion(file)->trajectory, NULL) == IMK_OK);
    }
    imk_motion_file_free(file);
    return 0;
}
