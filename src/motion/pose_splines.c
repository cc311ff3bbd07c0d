/* SPDX-License-Identifier: Apache-2.0 */
/* Trajectories through tables of poses: a C2 cubic spline for each component of position and
 * quaternion [DEBOOR1978, chapter IV]. With h[i] the interval from pose i, d[i] the slope of the
 * chord over it, and m[i] the second derivative at pose i,
 *
 *     h[i-1] m[i-1] + 2 (h[i-1] + h[i]) m[i] + h[i] m[i+1] = 6 (d[i] - d[i-1])
 *
 * From four poses on, the third derivative is continuous at the second and the last but one pose
 * too ("not-a-knot"), m[0] = m[1] + h[0]/h[1] (m[1] - m[2]); with fewer, m is 0 at both ends. The
 * system is the same for all components, so it is factorised once. */
#include "imukit/motion.h"

#include "base/refuse_internal.h"
#include "base/workspace_internal.h"

#include <math.h>
#include <string.h>

enum { COMPONENTS = 7 };

/* Arrays of count each in the workspace. */
typedef struct spline_system {
    size_t count;
    const double *time;
    double *sign;    /* of each quaternion, so that neighbours are less than half a turn apart */
    double *inverse; /* of the pivots */
    double *upper;   /* upper diagonal times the inverse pivot */
    double *second;  /* m, COMPONENTS of each pose */
} spline_system;

size_t imk_trajectory_poses_workspace_size(size_t count)
{
    return (3 + COMPONENTS) * count * sizeof(double) + IMKI_ALIGNMENT_SLACK;
}

static double product(imk_quaternion a, imk_quaternion b)
{
    return (a.w * b.w + a.x * b.x) + (a.y * b.y + a.z * b.z);
}

/* Steps of time between poses [s]: the powers of shorter and longer ones overflow. */
static const double shortest_step = 1e-9, longest_step = 1e9;

/* A turn of 120 deg is one of 60 deg between the quaternions. */
static imk_status check_row(const double *time, const double *const position[3],
                            const imk_quaternion *attitude, size_t row, imk_error *error)
{
    if (!isfinite(time[row]))
        return imki_refuse_at(error, IMK_ERROR_NOT_FINITE, "time", row, time[row], 0.0, "a time");
    if (row > 0 && !(time[row] > time[row - 1]))
        return imki_refuse_at(error, IMK_ERROR_TIME_ORDER, "time", row, time[row], time[row - 1],
                              "use times that increase");
    if (row > 0 &&
        !(time[row] - time[row - 1] >= shortest_step && time[row] - time[row - 1] <= longest_step))
        return imki_refuse_at(error, IMK_ERROR_RANGE, "time", row, time[row] - time[row - 1],
                              time[row] - time[row - 1] < 1.0 ? shortest_step : longest_step,
                              "a step of time from 1 ns to 1e9 s");
    for (int axis = 0; axis < 3; axis++)
        if (!isfinite(position[axis][row]))
            return imki_refuse_at(error, IMK_ERROR_NOT_FINITE, "position", row, position[axis][row],
                                  0.0, "a position");
    const double square = product(attitude[row], attitude[row]);
    if (!isfinite(square))
        return imki_refuse_at(error, IMK_ERROR_NOT_FINITE, "attitude", row, square, 0.0,
                              "an attitude");
    if (!(fabs(square - 1.0) <= 1e-2))
        return imki_refuse_at(error, IMK_ERROR_RANGE, "attitude", row, square, 1.0,
                              "a unit quaternion");
    if (row == 0)
        return IMK_OK;
    const double cosine = fabs(product(attitude[row], attitude[row - 1]));
    if (!(cosine >= 0.5 * sqrt(square * product(attitude[row - 1], attitude[row - 1]))))
        return imki_refuse_at(
            error, IMK_ERROR_RANGE, "attitude", row, cosine, 0.5,
            "give more poses per second: successive attitudes must be less than 120 deg apart");
    return IMK_OK;
}

/* Rows 1 … count - 2, the ends eliminated. */
static void factorise(const spline_system *system)
{
    const size_t n = system->count;
    for (size_t i = 1; i + 1 < n; i++) {
        const double before = system->time[i] - system->time[i - 1];
        const double after = system->time[i + 1] - system->time[i];
        double lower = before, diagonal = 2.0 * (before + after), upper = after;
        if (n >= 4 && i == 1) {
            diagonal += before + before * (before / after);
            upper -= before * (before / after);
        }
        if (n >= 4 && i == n - 2) {
            diagonal += after + after * (after / before);
            lower -= after * (after / before);
        }
        if (i > 1)
            diagonal -= lower * system->upper[i - 1];
        system->inverse[i] = 1.0 / diagonal;
        system->upper[i] = upper * system->inverse[i];
    }
}

/* Row i less `lower` times the row before, which is what factorise() assumed. */
static double lower_of(const spline_system *system, size_t i)
{
    const double before = system->time[i] - system->time[i - 1];
    const double after = system->time[i + 1] - system->time[i];
    return system->count >= 4 && i == system->count - 2 ? before - after * (after / before)
                                                        : before;
}

/* The components of pose i: position and quaternion, its sign turned where it must be. */
static void load_pose(const spline_system *system, const double *const position[3],
                      const imk_quaternion *attitude, size_t i, double value[COMPONENTS])
{
    for (int axis = 0; axis < 3; axis++)
        value[axis] = position[axis][i];
    value[3] = system->sign[i] * attitude[i].w;
    value[4] = system->sign[i] * attitude[i].x;
    value[5] = system->sign[i] * attitude[i].y;
    value[6] = system->sign[i] * attitude[i].z;
}

/* m of the components, side by side, forward. */
static void eliminate(const spline_system *system, const double *const position[3],
                      const imk_quaternion *attitude)
{
    double value[2][COMPONENTS], chord[COMPONENTS] = {0};
    load_pose(system, position, attitude, 0, value[0]);
    for (size_t i = 0; i + 1 < system->count; i++) {
        const double length = system->time[i + 1] - system->time[i];
        const double lower = i > 1 ? lower_of(system, i) : 0.0;
        double *const second = system->second + COMPONENTS * i;
        load_pose(system, position, attitude, i + 1, value[1]);
        for (size_t c = 0; c < COMPONENTS; c++) {
            const double next = (value[1][c] - value[0][c]) / length;
            if (i > 0) {
                double right = 6.0 * (next - chord[c]);
                if (i > 1)
                    right -= lower * system->second[COMPONENTS * (i - 1) + c];
                second[c] = right * system->inverse[i];
            }
            chord[c] = next;
            value[0][c] = value[1][c];
        }
    }
}

/* And backward, with the ends. */
static void substitute(const spline_system *system)
{
    const size_t n = system->count;
    const double *const time = system->time;
    double *const first = system->second, *const last = first + COMPONENTS * (n - 1);
    for (size_t i = n - 2; i-- > 1;)
        for (size_t c = 0; c < COMPONENTS; c++)
            first[COMPONENTS * i + c] -= system->upper[i] * first[COMPONENTS * (i + 1) + c];
    for (size_t c = 0; c < COMPONENTS; c++)
        first[c] = last[c] = 0.0;
    if (n < 4)
        return;
    const double begin = (time[1] - time[0]) / (time[2] - time[1]);
    const double end = (time[n - 1] - time[n - 2]) / (time[n - 2] - time[n - 3]);
    for (size_t c = 0; c < COMPONENTS; c++) {
        const double *const one = first + COMPONENTS + c, *const before = last - COMPONENTS + c;
        first[c] = one[0] + begin * (one[0] - one[COMPONENTS]);
        last[c] = before[0] + end * (before[0] - *(before - COMPONENTS));
    }
}

/* y + (d - h (2 m + m_next)/6) s + m/2 s^2 + (m_next - m)/(6 h) s^3 */
static void set_cubic(double now, double next, double h, const double *second, double *coefficient)
{
    coefficient[0] = now;
    coefficient[1] = (next - now) / h - h * ((2.0 * second[0] + second[COMPONENTS]) / 6.0);
    coefficient[2] = 0.5 * second[0];
    coefficient[3] = (second[COMPONENTS] - second[0]) / (6.0 * h);
}

static void set_pieces(const spline_system *system, const double *const position[3],
                       const imk_quaternion *attitude, imk_trajectory_piece *piece)
{
    double value[2][COMPONENTS];
    load_pose(system, position, attitude, 0, value[0]);
    for (size_t i = 0; i + 1 < system->count; i++) {
        const double length = system->time[i + 1] - system->time[i];
        const double *const second = system->second + COMPONENTS * i;
        piece[i] = (imk_trajectory_piece){.start = system->time[i], .length = length};
        load_pose(system, position, attitude, i + 1, value[1]);
        for (size_t c = 0; c < COMPONENTS; c++)
            set_cubic(value[0][c], value[1][c], length, second + c,
                      c < 3 ? piece[i].position[c] : piece[i].quaternion[c - 3]);
        memcpy(value[0], value[1], sizeof value[0]);
    }
}

imk_status imk_trajectory_from_poses(size_t count, const double *time,
                                     const double *const position[3],
                                     const imk_quaternion *attitude, imk_trajectory_piece *piece,
                                     void *workspace, size_t workspace_size, imk_error *error)
{
    if (count < 2)
        return imki_refuse_at(error, IMK_ERROR_TOO_SHORT, "poses", 0, (double)count, 2.0,
                              "at least two poses");
    for (size_t row = 0; row < count; row++) {
        const imk_status status = check_row(time, position, attitude, row, error);
        if (status)
            return status;
    }
    if (!workspace || workspace_size < imk_trajectory_poses_workspace_size(count))
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "workspace", NULL,
                             "imk_trajectory_poses_workspace_size() bytes");
    double *array = imki_align(workspace);
    const spline_system system = {
        count, time, array, array + count, array + 2 * count, array + 3 * count};
    system.sign[0] = 1.0;
    for (size_t i = 0; i + 1 < count; i++) {
        const double cosine = product(attitude[i], attitude[i + 1]);
        system.sign[i + 1] = cosine < 0.0 ? -system.sign[i] : system.sign[i];
    }
    factorise(&system);
    eliminate(&system, position, attitude);
    substitute(&system);
    set_pieces(&system, position, attitude, piece);
    return IMK_OK;
}
