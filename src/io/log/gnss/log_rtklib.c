/* SPDX-License-Identifier: Apache-2.0 */
/* Solution files of RTKLIB (.pos) [RTKLIB]: lines of numbers, below a line that begins with % and
 * names them,
 *
 *     %  GPST                  latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m) …
 *     2024/05/18 00:00:00.000   45.000000000    7.000000000   300.0000   1   8   0.0117 …
 *
 * between blanks, commas or tabs. The time is in two cells, a date and a time of day, or the GPS
 * week and seconds in it; it stays in the time scale of the file. Positions are geodetic in degrees
 * or degrees, minutes and seconds, Earth-fixed, or relative to a base station. Standard deviations
 * of Earth-fixed coordinates and covariances are not read. */
#include "../log_formats_internal.h"
#include "../log_reader_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LABELS_MAX = 40, CELLS_MAX = 64 };

static const struct {
    const char *label, *name;
    size_t cells; /* 3: degrees, minutes, seconds */
} labels[] = {{"latitude(deg)", "latitude [deg]", 1},
              {"longitude(deg)", "longitude [deg]", 1},
              {"latitude(d'\")", "latitude [deg]", 3},
              {"longitude(d'\")", "longitude [deg]", 3},
              {"height(m)", "height [m]", 1},
              {"x-ecef(m)", "ecef_x [m]", 1},
              {"y-ecef(m)", "ecef_y [m]", 1},
              {"z-ecef(m)", "ecef_z [m]", 1},
              {"e-baseline(m)", "east [m]", 1},
              {"n-baseline(m)", "north [m]", 1},
              {"u-baseline(m)", "up [m]", 1},
              {"Q", "quality [1]", 1},
              {"ns", "satellites [1]", 1},
              {"sdn(m)", "sigma_north [m]", 1},
              {"sde(m)", "sigma_east [m]", 1},
              {"sdu(m)", "sigma_up [m]", 1},
              {"vn(m/s)", "velocity_north [m/s]", 1},
              {"ve(m/s)", "velocity_east [m/s]", 1},
              {"vu(m/s)", "velocity_up [m/s]", 1},
              {"sdvn", "sigma_velocity_north [m/s]", 1},
              {"sdve", "sigma_velocity_east [m/s]", 1},
              {"sdvu", "sigma_velocity_up [m/s]", 1},
              {"age(s)", "age [s]", 1}};
static const char *const positions[] = {"latitude(deg)", "latitude(d'\")", "x-ecef(m)",
                                        "e-baseline(m)"};

typedef struct rtklib {
    size_t count;                 /* columns, the time first */
    size_t cells[LABELS_MAX];     /* of each in a line; of the time 2 */
    const char *name[LABELS_MAX]; /* NULL: not read */
    int64_t origin;               /* [ns] */
    /* Rows that were read while the file was opened. */
    size_t ahead, given;
    int64_t stamp[2];
    double row[2][LABELS_MAX];
} rtklib;

/* ---- text ----------------------------------------------------------------------------------- */

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == ',' || c == ';';
}

/* Cells of a line. @return how many, at most CELLS_MAX */
static size_t split(imki_log_piece line, imki_log_piece cells[CELLS_MAX])
{
    size_t count = 0;
    const char *at = line.begin;
    while (count < CELLS_MAX) {
        while (at < line.end && is_blank(*at))
            at++;
        if (at == line.end)
            break;
        cells[count].begin = at;
        while (at < line.end && !is_blank(*at))
            at++;
        cells[count++].end = at;
    }
    return count;
}

static bool equals(imki_log_piece piece, const char *text)
{
    const size_t length = strlen(text);
    return (size_t)(piece.end - piece.begin) == length && memcmp(piece.begin, text, length) == 0;
}

/* A line that names columns: % and then, after the time, a position. */
static bool is_head(imki_log_piece line, imki_log_piece cells[CELLS_MAX], size_t *count)
{
    if (line.begin == line.end || *line.begin != '%')
        return false;
    line.begin++;
    *count = split(line, cells);
    for (size_t k = 0; k<sizeof positions / sizeof *positions && * count> 1; k++)
        if (equals(cells[1], positions[k]))
            return true;
    return false;
}

static bool recognise(const char *begin, size_t size)
{
    imki_log_piece cells[CELLS_MAX];
    for (const char *at = begin, *end = begin + size; at < end && *at == '%';) {
        const char *stop = memchr(at, '\n', (size_t)(end - at));
        size_t count;
        if (is_head((imki_log_piece){at, stop ? stop : end}, cells, &count))
            return true;
        if (!stop)
            return false;
        at = stop + 1;
    }
    return false;
}

/* ---- times ---------------------------------------------------------------------------------- */

static bool read_number(imki_log_piece cell, double *value)
{
    return imki_log_piece_is_number(cell, value) && isfinite(*value);
}

/* Numbers between signs, as many as there must be: "2024/05/18", "00:00:30.000". */
static bool read_triple(imki_log_piece cell, char sign, double value[3])
{
    for (int k = 0; k < 3; k++) {
        const char *stop =
            k < 2 ? memchr(cell.begin, sign, (size_t)(cell.end - cell.begin)) : cell.end;
        if (!stop || !read_number((imki_log_piece){cell.begin, stop}, &value[k]) || value[k] < 0.0)
            return false;
        cell.begin = stop < cell.end ? stop + 1 : stop;
    }
    return true;
}

/* Days from 1970-01-01 by the calendar of Gregory: years begin in March. */
static int64_t day_of(int64_t year, int64_t month, int64_t day)
{
    const int64_t y = month <= 2 ? year - 1 : year, m = month <= 2 ? month + 9 : month - 3;
    return 365 * y + y / 4 - y / 100 + y / 400 + (153 * m + 2) / 5 + day - 719469;
}

/* Nanoseconds since 1970 of the time scale of the file; the GPS weeks count from 1980-01-06. */
static bool read_time(imki_log_piece first, imki_log_piece second, int64_t *stamp)
{
    const double nano = 1e9;
    double date[3], clock[3], week, seconds;
    if (read_triple(first, '/', date) && read_triple(second, ':', clock)) {
        if (!(date[0] >= 1970 && date[0] < 2200 && date[1] >= 1 && date[1] <= 12 && date[2] >= 1 &&
              date[2] <= 31 && clock[0] < 25 && clock[1] < 60 && clock[2] < 61))
            return false;
        const int64_t day = day_of((int64_t)date[0], (int64_t)date[1], (int64_t)date[2]);
        *stamp = (day * 86400 + (int64_t)clock[0] * 3600 + (int64_t)clock[1] * 60) * 1000000000 +
                 llround(clock[2] * nano);
        return true;
    }
    if (!read_number(first, &week) || !read_number(second, &seconds) ||
        !(week >= 0 && week < 10000 && week == floor(week) && seconds >= 0 && seconds < 604801))
        return false;
    *stamp =
        (day_of(1980, 1, 6) + 7 * (int64_t)week) * 86400 * 1000000000 + llround(seconds * nano);
    return true;
}

/* ---- rows ----------------------------------------------------------------------------------- */

/* Degrees, minutes and seconds: the sign of the degrees is that of all. */
static bool read_angle(const imki_log_piece cells[3], double *value)
{
    double part[3];
    for (int k = 0; k < 3; k++)
        if (!read_number(cells[k], &part[k]))
            return false;
    const double size = fabs(part[0]) + part[1] / 60.0 + part[2] / 3600.0;
    *value = *cells[0].begin == '-' ? -size : size;
    return true;
}

static bool read_row(const rtklib *r, imki_log_piece line, int64_t *stamp, double *row)
{
    imki_log_piece cells[CELLS_MAX];
    const size_t count = split(line, cells);
    size_t at = 2;
    if (count < 2 || !read_time(cells[0], cells[1], stamp))
        return false;
    for (size_t k = 1; k < r->count; at += r->cells[k], k++) {
        row[k] = (double)NAN;
        if (at + r->cells[k] > count)
            return false;
        if (r->name[k] &&
            !(r->cells[k] == 3 ? read_angle(cells + at, &row[k]) : read_number(cells[at], &row[k])))
            return false;
    }
    return true;
}

/* The next line that is a row; others are damage, but for comments. */
static imk_status next_row(imk_log_reader *reader, size_t rows, int64_t *stamp, double *row,
                           bool *found, imk_error *error)
{
    for (*found = false; !*found;) {
        imki_log_piece line;
        bool whole;
        const imk_status status = imki_log_text_need_line(&reader->text, error);
        if (status != IMK_OK)
            return status;
        if (!imki_log_text_take_line(&reader->text, &line.begin, &line.end, &whole))
            return IMK_OK;
        if (line.end > line.begin && line.end[-1] == '\r')
            line.end--;
        if (line.begin == line.end || *line.begin == '%')
            continue;
        *found = read_row(reader->state, line, stamp, row);
        if (!*found && !whole)
            reader->cut_short = true;
        else if (!*found)
            imki_log_damage(reader, rows);
    }
    return IMK_OK;
}

/* ---- reading -------------------------------------------------------------------------------- */

static void take_head(rtklib *r, const imki_log_piece *cells, size_t count)
{
    r->count = 1;
    r->cells[0] = 2;
    r->name[0] = "time [s]";
    for (size_t k = 1; k < count && r->count < LABELS_MAX; k++, r->count++) {
        r->cells[r->count] = 1;
        r->name[r->count] = NULL;
        for (size_t i = 0; i < sizeof labels / sizeof *labels; i++)
            if (equals(cells[k], labels[i].label)) {
                r->cells[r->count] = labels[i].cells;
                r->name[r->count] = labels[i].name;
            }
    }
}

static imk_status find_head(imk_log_reader *reader, rtklib *r, imk_error *error)
{
    for (;;) {
        imki_log_piece line, cells[CELLS_MAX];
        bool whole;
        size_t count;
        const imk_status status = imki_log_text_need_line(&reader->text, error);
        if (status != IMK_OK)
            return status;
        if (!imki_log_text_take_line(&reader->text, &line.begin, &line.end, &whole) ||
            (line.begin < line.end && *line.begin != '%' && *line.begin != '\r'))
            return imk_error_set(error, IMK_ERROR_FORMAT, "", "no line that names the columns",
                                 "a line such as \"%  GPST  latitude(deg) longitude(deg) …\" "
                                 "before the first row, as RTKLIB writes it");
        if (line.end > line.begin && line.end[-1] == '\r')
            line.end--;
        if (is_head(line, cells, &count)) {
            take_head(r, cells, count);
            return IMK_OK;
        }
    }
}

static double time_of(const rtklib *r, int64_t stamp)
{
    return 1e-9 * (double)(stamp - r->origin);
}

static imk_status open_rtklib(imk_log_reader *reader, imk_error *error)
{
    rtklib *r = calloc(1, sizeof *r);
    double time[2] = {(double)NAN, (double)NAN};
    reader->state = r;
    if (!r)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    imk_status status = find_head(reader, r, error);
    if (status == IMK_OK)
        status = imki_log_layout_of(reader, r->count, r->name, error);
    for (bool found = true; r->ahead < 2 && found && status == IMK_OK; r->ahead += found)
        status = next_row(reader, 0, &r->stamp[r->ahead], r->row[r->ahead], &found, error);
    if (status != IMK_OK)
        return status;
    if (r->ahead > 0)
        r->origin = imki_log_stamp_origin(reader, r->stamp[0], 1000000000);
    for (size_t k = 0; k < r->ahead; k++)
        time[k] = time_of(r, r->stamp[k]);
    return imki_log_first_rows(reader, r->ahead, time, "no row of a solution",
                               "a solution file of RTKLIB", error);
}

static imk_status read_rtklib(imk_log_reader *reader, size_t max_rows, double *const *out,
                              size_t *rows, imk_error *error)
{
    rtklib *r = reader->state;
    const imki_log_layout_read *layout = &reader->layout;
    for (*rows = 0; *rows < max_rows; ++*rows) {
        double row[LABELS_MAX];
        const double *values = row;
        int64_t stamp;
        bool found = true;
        if (r->given < r->ahead) {
            stamp = r->stamp[r->given];
            values = r->row[r->given++];
        } else {
            const imk_status status = next_row(reader, *rows, &stamp, row, &found, error);
            if (status != IMK_OK || !found)
                return status;
        }
        for (size_t i = 0; i < layout->cell_count; i++)
            if (layout->cell_column[i] >= 0)
                out[i][*rows] = (i == 0 ? time_of(r, stamp) : values[i]) * layout->cell_factor[i];
    }
    return IMK_OK;
}

const imki_log_codec imki_log_rtklib = {
    .recognise = recognise, .defines_units = true, .open = open_rtklib, .read = read_rtklib};
