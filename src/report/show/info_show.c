/* SPDX-License-Identifier: Apache-2.0 */
/* The display of what is in a log: sensors, times, columns, motion. */
#include "info_judgement_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const basis_words[] = {"read",
                                          "from the index of the log",
                                          "from its first and last row",
                                          "estimated from its size",
                                          "at least: only the beginning was read",
                                          "from the places read"};
static const char *const basis_keys[] = {"read", "index", "ends", "size", "beginning", "places"};
static const char *const motion_keys[] = {"unknown", "at_rest", "poses", "moves"};
static const char *const origin_words[] = {"header", "format", "option", "device"};

/* ---- sensors --------------------------------------------------------------------------------- */

static void stream_name(const imk_log_stream *s, size_t size, char *text)
{
    if (s->instance >= 0)
        snprintf(text, size, "%s, instance %d", s->name, s->instance);
    else
        snprintf(text, size, "%s", s->name);
}

static void show_streams(const imk_info_file *file, imk_result *result)
{
    if (file->stream_count < 2 && (file->stream_count == 0 || file->stream[0].name[0] == '\0'))
        return;
    imk_table *table = imk_result_table(result, 4);
    imk_table_row(table, "topic\tkind\tsamples\tread by imukit");
    for (size_t i = 0; i < file->stream_count; i++) {
        const imk_log_stream *s = &file->stream[i];
        char name[128];
        stream_name(s, sizeof name, name);
        imk_table_row(table, "%s\t%s", name, s->kind);
        if (s->samples > 0)
            imk_table_add(table, "%s%llu", s->estimated ? "about " : "",
                          (unsigned long long)s->samples);
        else
            imk_table_add(table, "%s", "");
        imk_table_add(table, "%s", s->readable ? "yes" : "no");
    }
    imk_result_gap(result);
}

static void stream_data(const imk_log_stream *s, imk_result *result)
{
    imk_result_object(result, NULL);
    imk_result_text(result, "topic", s->name);
    imk_result_text(result, "kind", s->kind);
    if (s->instance >= 0)
        imk_result_count(result, "instance", s->instance);
    else
        imk_result_null(result, "instance");
    imk_result_flag(result, "readable", s->readable);
    if (s->samples > 0)
        imk_result_count(result, "samples", (long long)s->samples);
    else
        imk_result_null(result, "samples");
    imk_result_flag(result, "estimated", s->estimated);
    imk_result_quantity(result, "begin", s->begin, "s");
    imk_result_quantity(result, "end", s->end, "s");
    imk_result_end(result);
}

/* ---- times ----------------------------------------------------------------------------------- */

static void show_faults(const imk_info_log *info, imk_table *table)
{
    imki_text faults = {0};
    imki_info_faults(info, &faults);
    imk_table_row(table, "faults\t%s%s", faults.size > 0 ? faults.bytes : "none",
                  info->whole ? "" : ", in the rows read");
    free(faults.bytes);
}

/* Rows and times of a long log do not fit: what is between the places read is not even. */
static bool contradicts(const imk_info_log *info)
{
    const double due = (double)info->rows * info->interval;
    return info->timed && !info->whole && info->duration_from == IMK_INFO_ENDS &&
           info->interval > 0 && !(fabs(info->duration - due) < 0.05 * due);
}

/* Times in no known unit: as the log has them. */
static void show_plain_times(const imk_info_log *info, imk_table *table)
{
    if (!isfinite(info->first_time))
        return;
    imk_table_row(table, "time\tfrom %.9g to %.9g, in a unit that is not stated",
                  info->time_origin + info->first_time, info->time_origin + info->last_time);
    if (info->interval > 0)
        imk_table_row(table, "step\t%.7g, the median of the time", info->interval);
}

static bool has_jitter(const imk_info_log *info)
{
    return info->interval > 0 && isfinite(info->first_time) && !info->uneven_stamps &&
           !info->rate_stated;
}

static void show_seconds(const imk_info_log *info, imk_table *table)
{
    if (info->duration < 0)
        imk_table_row(table, "duration\tnot known: the last time is before the first");
    else
        imk_table_row(table, "duration\t%s, %s", imki_duration(info->duration).text,
                      basis_words[info->duration_from]);
    if (info->time_origin != 0)
        imk_table_row(table, "clock\tbegins at %.3f s, which is subtracted", info->time_origin);
    else if (isfinite(info->first_time))
        imk_table_row(table, "clock\tbegins at %.9g s", info->first_time);
    if (info->interval > 0)
        imk_table_row(table, "rate\t%.7g Hz%s", 1 / info->interval,
                      !isfinite(info->first_time) ? ""
                      : info->rate_stated         ? ", as stated"
                      : info->uneven_stamps       ? ", as the analyses read the stamps"
                                                  : ", by the median step of the time");
    if (has_jitter(info)) {
        if (info->jitter > 1e-6 * info->interval)
            imk_table_row(table, "jitter\t%.2g %% of the interval, rms",
                          100 * info->jitter / info->interval);
        else
            imk_table_row(table, "jitter\tnone");
    }
}

static void show_times(const imk_info_log *info, imk_result *result)
{
    imk_table *table = imk_result_table(result, 0);
    const char *about = info->rows_from == IMK_INFO_SIZE ? "about " : "";
    imk_table_row(table, "figure\tvalue");
    if (info->whole)
        imk_table_row(table, "rows\t%llu, all read", (unsigned long long)info->rows);
    else
        imk_table_row(table, "rows\t%s%llu, %s (%zu read, in %zu place%s)", about,
                      (unsigned long long)info->rows, basis_words[info->rows_from], info->rows_read,
                      info->places, info->places == 1 ? "" : "s");
    if (info->timed)
        show_seconds(info, table);
    else
        show_plain_times(info, table);
    show_faults(info, table);
    imk_result_gap(result);
    if (contradicts(info))
        imk_result_line(
            result,
            "At %.5g Hz so many rows would take %s: the rate changes, rows are missing, "
            "or the clock begins anew. --full counts them.",
            1 / info->interval, imki_duration((double)info->rows * info->interval).text);
}

static void time_data(const imk_info_log *info, imk_result *result)
{
    const double seconds = info->timed ? 1 : (double)NAN;
    imk_result_count(result, "rows", (long long)info->rows);
    imk_result_text(result, "rows_from", basis_keys[info->rows_from]);
    imk_result_count(result, "rows_read", (long long)info->rows_read);
    imk_result_flag(result, "whole", info->whole);
    imk_result_quantity(result, "duration",
                        info->duration < 0 ? (double)NAN : seconds * info->duration, "s");
    imk_result_text(result, "duration_from", basis_keys[info->duration_from]);
    imk_result_quantity(result, "first_time", seconds * info->first_time, "s");
    imk_result_quantity(result, "last_time", seconds * info->last_time, "s");
    imk_result_quantity(result, "time_origin", seconds * info->time_origin, "s");
    imk_result_quantity(result, "interval",
                        seconds * (info->interval > 0 ? info->interval : (double)NAN), "s");
    imk_result_quantity(result, "jitter", has_jitter(info) ? seconds * info->jitter : (double)NAN,
                        "s");
    imk_result_count(result, "gaps", (long long)info->gaps);
    imk_result_count(result, "missing", (long long)info->missing);
    imk_result_count(result, "repeats", (long long)info->repeats);
    imk_result_count(result, "reversals", (long long)info->reversals);
    imk_result_count(result, "not_finite", (long long)info->not_finite);
    imk_result_count(result, "damaged", (long long)info->damaged);
    imk_result_flag(result, "cut_short", info->cut_short);
    imk_result_flag(result, "stopped", info->stopped);
    imk_result_count(result, "other_frames", (long long)info->other_frames);
    imk_result_text(result, "frames", info->other_frames > 0 ? info->frames : NULL);
}

/* ---- columns --------------------------------------------------------------------------------- */

/* A value of SI in the unit of the log. */
static double in_unit(const imk_info_channel *c, double value)
{
    const imk_unit *u = &c->column.unit;
    return c->column.label ? value : (value - u->offset) / u->scale;
}

/* The unit of what is shown: increments are shown as rates. */
static const char *unit_of(const imk_info_channel *c, size_t size, char *text)
{
    const char *own = c->column.unit.text;
    const size_t length = strlen(own);
    if (length == 0)
        return "-";
    if (!c->column.increment)
        return own;
    const bool rate = length > 2 && strcmp(own + length - 2, "/s") == 0;
    snprintf(text, size, "%s%s", own, rate ? "^2" : "/s");
    return text;
}

static void show_channels(const imk_info_log *info, imk_result *result)
{
    imk_table *table = imk_result_table(result, 0xf8);
    imk_table_row(table, "column\tunit\tby\tmean\tscatter%s\tlowest\thighest\tstep\tclipped",
                  info->timed ? " in 1 s" : "");
    for (size_t i = 0; i < info->channel_count; i++) {
        const imk_info_channel *c = &info->channel[i];
        char unit[sizeof c->column.unit.text + 2];
        if (c->column.quantity == IMK_QUANTITY_TIME)
            continue;
        imk_table_row(table, "%s%s\t%s\t%s", c->column.name,
                      c->column.increment ? " (as a rate)" : "", unit_of(c, sizeof unit, unit),
                      c->column.unit.text[0] ? origin_words[c->column.unit_origin] : "");
        if (c->column.label) {
            imk_table_add(table, "texts");
            continue;
        }
        imk_table_add(table, "%.5g", in_unit(c, c->mean));
        if (isfinite(c->scatter))
            imk_table_add(table, "%.3g", c->scatter / c->column.unit.scale);
        else
            imk_table_add(table, "-");
        imk_table_add(table, "%.5g\t%.5g", in_unit(c, c->lowest), in_unit(c, c->highest));
        if (c->step > 0)
            imk_table_add(table, "%.3g", c->step / c->column.unit.scale);
        else
            imk_table_add(table, "%s", "");
        if (c->clipped_low + c->clipped_high > 0)
            imk_table_add(table, "%zu rows", c->clipped_low + c->clipped_high);
        else
            imk_table_add(table, "%s", "");
    }
    imk_result_gap(result);
}

static void channel_data(const imk_info_channel *c, imk_result *result)
{
    const imk_unit unit = imk_channel_plain_unit(&c->column);
    const double scale = c->column.label ? 1 : unit.scale,
                 offset = c->column.label ? 0 : unit.offset;
    imk_result_object(result, NULL);
    imk_result_text(result, "name", c->column.name);
    imk_result_text(result, "unit", c->column.unit.text[0] ? c->column.unit.text : NULL);
    imk_result_text(result, "unit_from",
                    c->column.unit.text[0] ? origin_words[c->column.unit_origin] : NULL);
    imk_result_flag(result, "increment", c->column.increment);
    imk_result_flag(result, "label", c->column.label);
    imk_result_quantity(result, "mean", (c->mean - offset) / scale, unit.text);
    imk_result_quantity(result, "scatter", c->scatter / scale, unit.text);
    imk_result_quantity(result, "lowest", (c->lowest - offset) / scale, unit.text);
    imk_result_quantity(result, "highest", (c->highest - offset) / scale, unit.text);
    imk_result_quantity(result, "step", c->step > 0 ? c->step / scale : (double)NAN, unit.text);
    imk_result_count(result, "clipped_low", (long long)c->clipped_low);
    imk_result_count(result, "clipped_high", (long long)c->clipped_high);
    imk_result_end(result);
}

/* ---- the whole ------------------------------------------------------------------------------- */

/* What the numbers of an accelerometer without a unit say. */
static void show_unstated(const imk_info_log *info, imk_result *result)
{
    double square = 0;
    int axes = 0;
    for (size_t i = 0; i < info->channel_count; i++) {
        const imk_info_channel *c = &info->channel[i];
        if (c->column.quantity == IMK_QUANTITY_SPECIFIC_FORCE && !c->column.increment &&
            c->column.axis >= 0 && c->column.axis < 3 && c->column.unit.text[0] == '\0') {
            square += c->mean * c->mean;
            axes++;
        }
    }
    imk_result_line(result, "Whether the sensor rests is not known: units or times are missing.");
    if (axes == 3 && isfinite(square))
        imk_result_line(result,
                        "The mean of the accelerometers has the length %.4g. At rest it is 9.81 in "
                        "m/s^2, 1 in g, 1000 in mg, and another number in counts.",
                        sqrt(square));
}

/* What is to be known of the stamps; warnings stand apart. */
static void show_notes(const imk_info_log *info, imk_result *result)
{
    char text[900];
    for (size_t k = 0; k < info->findings.count; k++)
        if (info->findings.item[k].level == IMK_FINDING_NOTE) {
            imk_finding_text(&info->findings.item[k], text, sizeof text);
            imk_result_line(result, "Note: %s.", text);
        }
}

/* A steady turn about the vertical looks like rest with a large zero offset. */
static void show_rest(const imk_info_log *info, const char *where, imk_result *result)
{
    const double large = 3 * imk_unit_of("deg/s").scale;
    const imk_info_channel *fastest = NULL;
    for (size_t i = 0; i < info->channel_count; i++) {
        const imk_info_channel *c = &info->channel[i];
        if (c->column.quantity == IMK_QUANTITY_ANGULAR_RATE && fabs(c->mean) > large &&
            (!fastest || fabs(c->mean) > fabs(fastest->mean)))
            fastest = c;
    }
    if (info->resting < 1)
        imk_result_line(result,
                        "The sensor is at rest for %.3g %% of the time%s, and touched or moved in "
                        "the rest of it.",
                        floor(1000 * info->resting) / 10, where);
    else if (fastest)
        imk_result_line(result,
                        "The sensor is at rest%s, or turns steadily: the mean of %s is %.3g deg/s.",
                        where, fastest->column.name, fastest->mean / imk_unit_of("deg/s").scale);
    else
        imk_result_line(result, "The sensor is at rest%s.", where);
}

static void show_motion(const imk_info_log *info, imk_result *result)
{
    const imk_info_channel *constant = imki_info_constant(info);
    if (constant)
        imk_result_line(result, "All values of %s are the same.", constant->column.name);
    if (!info->stated) {
        show_unstated(info, result);
        return;
    }
    const char *where = info->whole ? "" : " in the places read";
    switch (info->motion) {
    case IMK_INFO_REST:
        show_rest(info, where, result);
        break;
    case IMK_INFO_POSES:
        imk_result_line(result,
                        "The sensor rests in %zu attitudes%s, %.0f %% of the time%s, and is "
                        "moved between them.",
                        info->attitudes, info->whole ? "" : " or more", 100 * info->resting, where);
        break;
    case IMK_INFO_MOVES:
        if (info->resting < 0.01)
            imk_result_line(result, "The sensor is moved%s.", where);
        else
            imk_result_line(result,
                            "The sensor rests %.0f %% of the time%s, and is touched or moved in "
                            "the rest of it.",
                            fmin(99, floor(100 * info->resting)), where);
        break;
    case IMK_INFO_UNKNOWN:
        imk_result_line(result, "Whether the sensor rests is not known: there are no gyros and "
                                "accelerometers, or less than three seconds without holes.");
        break;
    }
    if (imki_info_counted(info))
        imk_result_line(result,
                        "The readings are counts: state --device PART with --gyro-range and "
                        "--accel-range, or --gyro-scale and --accel-scale.");
}

static void show_data(const imk_info_log *info, const imk_info_file *file, const char *name,
                      const char *chosen, const char *next, imk_result *result)
{
    imk_result_object(result, "inputs");
    imk_result_text(result, "log", name);
    imk_result_text(result, "format", file->format);
    imk_result_end(result);
    imk_result_object(result, "result");
    imki_judge_info(info, file, result);
    imk_result_array(result, "topics");
    for (size_t i = 0; i < file->stream_count; i++)
        stream_data(&file->stream[i], result);
    imk_result_end(result);
    if (imki_begin_object(result, "record", info != NULL) && info) {
        imk_result_text(result, "topic", chosen[0] ? chosen : NULL);
        imk_result_flag(result, "stated", info->stated);
        time_data(info, result);
        imk_result_text(result, "motion", motion_keys[info->motion]);
        imk_result_number(result, "resting", info->resting);
        imk_result_count(result, "attitudes", (long long)info->attitudes);
        imk_result_array(result, "columns");
        for (size_t i = 0; i < info->channel_count; i++)
            channel_data(&info->channel[i], result);
        imk_result_end(result);
        imk_result_end(result);
    }
    imk_result_text(result, "next", next);
    imk_result_end(result);
}

void imk_show_info_log(const imk_info_log *info, const imk_info_file *file, const char *name,
                       const char *next, imk_result *result)
{
    char chosen[128] = "";
    if (file->chosen)
        stream_name(file->chosen, sizeof chosen, chosen);
    show_data(info, file, name, chosen, next, result);
    imk_result_title(result, name, "%s", file->format);
    imk_result_for(result, IMK_FOR_TERMINAL);
    imk_result_line(result, IMK_BOLD "%s" IMK_PLAIN ": %s", name, file->format);
    imk_result_gap(result);
    imk_result_for(result, IMK_FOR_BOTH);
    show_streams(file, result);
    if (info) {
        if (chosen[0] && file->stream_count > 1)
            imk_result_line(result, "%s:", chosen);
        show_times(info, result);
        show_channels(info, result);
        show_notes(info, result);
        show_motion(info, result);
    }
    if (next)
        imk_result_line(result, "Next: %s", next);
}
