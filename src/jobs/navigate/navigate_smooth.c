/* SPDX-License-Identifier: Apache-2.0 */
/* Rows of the track, and their smoothing backwards. */
#include "navigate_log_internal.h"

#include <math.h>
#include <string.h>

void imki_navigate_track_row(imk_navigate_log *n, const imk_navigation_filter_estimate *estimate,
                             double row[IMK_TRACK_COLUMNS])
{
    imk_geodetic place;
    imk_vector3 velocity;
    imk_matrix3 c_nb;
    imk_navigation_state_to_ned(&estimate->state, &place, &velocity, &c_nb);
    const imk_vector3 way = imk_navigation_difference_ned(&estimate->state, &n->start);
    row[IMK_TRACK_LATITUDE] = place.latitude;
    row[IMK_TRACK_LONGITUDE] = place.longitude;
    row[IMK_TRACK_HEIGHT] = place.height;
    for (int i = 0; i < 3; i++) {
        row[IMK_TRACK_NORTH + i] = way.v[i];
        row[IMK_TRACK_VELOCITY + i] = velocity.v[i];
    }
    /* Down is along the vertical, north and east across that of the start: a way of 40 km would
     * else lead down by the curvature of the Earth. */
    row[IMK_TRACK_NORTH + 2] = n->settings.place.height - place.height;
    imk_matrix3_to_euler(c_nb, &row[IMK_TRACK_ROLL], &row[IMK_TRACK_PITCH], &row[IMK_TRACK_YAW]);
    for (int i = 0; i < IMK_NAVIGATION_ERRORS; i++)
        row[IMK_TRACK_SIGMA + i] = sqrt(fmax(0.0, estimate->covariance[i][i]));
    n->largest = fmax(n->largest, hypot(way.v[0], way.v[1]));
}

static void *room_of_arena(size_t size, void *context)
{
    return imki_arena_room(context, size);
}

imk_status imki_navigate_record(imk_navigation_filter *filter, imki_arena *scratch,
                                imk_navigation_smoother **smoother, imk_error *error)
{
    *smoother = imk_navigation_smoother_start(filter, room_of_arena, scratch);
    return *smoother ? IMK_OK : imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
}

imk_status imki_navigate_mark(imk_navigation_smoother *smoother, imk_error *error)
{
    if (!smoother || imk_navigation_smoother_mark(smoother))
        return IMK_OK;
    return imk_error_set(error, IMK_ERROR_MEMORY, "", "the memory for smoothing is exhausted",
                         "smooth a shorter log, or write fewer rows of the track (--interval)");
}

/* A row of the track in place of that of the filter; the acceleration stays. */
static void put_smoothed(void *context, size_t index, const imk_navigation_filter_estimate *e)
{
    imk_navigate_log *n = context;
    double row[IMK_TRACK_COLUMNS];
    imki_navigate_track_row(n, e, row);
    for (int k = 0; k < IMK_TRACK_COLUMNS; k++) {
        const bool stays =
            k == IMK_TRACK_TIME || (k >= IMK_TRACK_ACCELERATION && k < IMK_TRACK_ACCELERATION + 3);
        if (!stays)
            n->track[k][index] = row[k];
    }
}

imk_status imki_navigate_smooth(imk_navigate_log *n, imk_navigation_smoother *smoother,
                                imk_error *error)
{
    const size_t bytes = n->track_rows * sizeof(double);
    double *memory = imki_resize(&n->record.log.allocator, NULL, IMK_TRACK_COLUMNS * bytes);
    if (!memory)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    for (size_t k = 0; k < IMK_TRACK_COLUMNS; k++) {
        n->filtered[k] = memory + k * n->track_rows;
        memcpy(n->filtered[k], n->track[k], bytes);
    }
    n->largest = 0.0;
    return imk_navigation_smoother_run(smoother, put_smoothed, n)
               ? IMK_OK
               : imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
}
