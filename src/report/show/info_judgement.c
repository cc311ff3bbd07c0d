/* SPDX-License-Identifier: Apache-2.0 */
/* What a log can be used for, by its units, its times and the motion in it. */
#include "info_judgement_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* "12 gaps", "one gap" of a kind; nothing of none. */
static void add_fault(imki_text *text, size_t count, const char *one, const char *several)
{
    if (count > 0)
        imki_text_add(text, "%s%zu %s", text->size > 0 ? ", " : "", count,
                      count == 1 ? one : several);
}

void imki_info_faults(const imk_info_log *info, imki_text *faults)
{
    add_fault(faults, info->gaps, "gap", "gaps");
    if (info->gaps > 0)
        imki_text_add(faults, " with %zu missing row%s", info->missing,
                      info->missing == 1 ? "" : "s");
    add_fault(faults, info->repeats, "repeated stamp", "repeated stamps");
    add_fault(faults, info->reversals, "step back of the time", "steps back of the time");
    add_fault(faults, info->not_finite, "row with a value that is no finite number",
              "rows with a value that is no finite number");
    add_fault(faults, info->damaged, "row, message or block that cannot be read",
              "rows, messages or blocks that cannot be read");
    add_fault(faults, info->other_frames, "message of another frame than the first",
              "messages of another frame than the first");
    if (info->other_frames > 0)
        imki_text_add(faults, " (%s): two sensors on one topic?", info->frames);
    if (info->stopped)
        imki_text_add(faults, "%sreading ended with an error", faults->size > 0 ? "; " : "");
    if (info->cut_short)
        imki_text_add(faults, "%sthe file ends in the middle of a row, message or block",
                      faults->size > 0 ? "; " : "");
}

/* Gyros or accelerometers in counts, whose unit nobody stated. */
bool imki_info_counted(const imk_info_log *info)
{
    const imk_dimension count = imk_unit_of("count").dimension;
    bool any = false;
    for (size_t i = 0; i < info->channel_count; i++) {
        const imk_log_column *c = &info->channel[i].column;
        any = any || ((c->quantity == IMK_QUANTITY_ANGULAR_RATE ||
                       c->quantity == IMK_QUANTITY_SPECIFIC_FORCE) &&
                      imk_dimension_equal(c->unit.dimension, count));
    }
    return any;
}

/* A gyro or an accelerometer whose values are all the same. */
const imk_info_channel *imki_info_constant(const imk_info_log *info)
{
    for (size_t i = 0; info->rows_read > 1 && i < info->channel_count; i++) {
        const imk_info_channel *c = &info->channel[i];
        if ((c->column.quantity == IMK_QUANTITY_ANGULAR_RATE ||
             c->column.quantity == IMK_QUANTITY_SPECIFIC_FORCE) &&
            c->lowest == c->highest)
            return c;
    }
    return NULL;
}

/* Each is suggested where it will run: multiposition needs twelve holds, and the places of a long
 * log may show one twice. */
imk_info_next imk_info_log_next(const imk_info_log *info)
{
    const bool times =
        info->duration > 0 && 100 * info->reversals < info->rows_read && !info->times_refused;
    if (!info->stated || imki_info_counted(info) || !times || imki_info_constant(info))
        return IMK_INFO_NEXT_NONE;
    if (info->motion == IMK_INFO_REST)
        return IMK_INFO_NEXT_IDENTIFY;
    if (info->motion != IMK_INFO_POSES || !info->whole)
        return IMK_INFO_NEXT_NONE;
    return info->holds >= 12                          ? IMK_INFO_NEXT_MULTIPOSITION
           : info->holds == 6 && info->attitudes == 6 ? IMK_INFO_NEXT_SIXPOSITION
                                                      : IMK_INFO_NEXT_NONE;
}

/* ---- judgement ------------------------------------------------------------------------------- */

static size_t count_of(const imk_info_log *info, imk_quantity quantity)
{
    size_t count = 0;
    for (size_t i = 0; i < info->channel_count; i++)
        count += info->channel[i].column.quantity == quantity;
    return count;
}

static const imk_info_channel *clipped(const imk_info_log *info)
{
    for (size_t i = 0; i < info->channel_count; i++)
        if (info->channel[i].clipped_low + info->channel[i].clipped_high > 0)
            return &info->channel[i];
    return NULL;
}

/* What makes care needed: faults, ends of a range, and a look at places only. @return any */
static bool add_doubts(const imk_info_log *info, imki_reasons *reasons)
{
    imki_text faults = {0};
    const imk_info_channel *c = clipped(info);
    const size_t told = reasons->told;
    imki_info_faults(info, &faults);
    if (faults.size > 0)
        imki_reason(reasons, "%s", faults.bytes);
    if (c)
        imki_reason(reasons, "%s is clipped in %zu rows", c->column.name,
                    c->clipped_low + c->clipped_high);
    free(faults.bytes);
    return reasons->told > told;
}

/* Why no analysis can be begun with the log as it is. @return is that so? */
static bool add_obstacles(const imk_info_log *info, imki_reasons *reasons)
{
    const imk_info_channel *constant = imki_info_constant(info);
    const size_t told = reasons->told;
    if (info->rows_read < 2)
        imki_reason(reasons, "there is only one row");
    if (count_of(info, IMK_QUANTITY_ANGULAR_RATE) + count_of(info, IMK_QUANTITY_SPECIFIC_FORCE) ==
        0)
        imki_reason(reasons, "no column is read as one of a gyro or an accelerometer");
    else if (!info->stated)
        imki_reason(reasons, "units or times are missing");
    if (info->stopped)
        imki_reason(reasons, "reading ended with an error");
    for (size_t i = 0; i < info->channel_count; i++)
        if (info->channel[i].finite == 0)
            imki_reason(reasons, "no value of %s is a finite number", info->channel[i].column.name);
    if (constant)
        imki_reason(reasons, "all values of %s are the same", constant->column.name);
    if (info->times_refused)
        imki_reason(reasons, "no rate follows from the times");
    else if (info->stated && info->duration < 0)
        imki_reason(reasons, "the last time is before the first");
    else if (100 * info->reversals >= info->rows_read && info->reversals > 0)
        imki_reason(reasons, "the time goes back in %zu of %zu rows", info->reversals,
                    info->rows_read);
    return reasons->told > told;
}

static void judge_rest(const imk_info_log *info, imki_reasons *reasons)
{
    const bool doubts = add_doubts(info, reasons);
    const char *where = info->whole ? "" : " in the places read";
    if (info->resting < 1)
        imki_reason(reasons, "it was touched or moved in %.2g %% of the time%s",
                    ceil(1000 * (1 - info->resting)) / 10, where);
    else
        imki_reason(reasons, "the sensor is at rest%s, for %s at %.5g Hz", where,
                    imki_duration(info->duration).text, 1 / info->interval);
    imki_judge(reasons, doubts || info->resting < 1 ? IMK_USABLE_WITH_CARE : IMK_USABLE,
               " for identify");
}

/* @param next  the procedure that will run; IMK_INFO_NEXT_NONE: not known, or none */
static void judge_poses(const imk_info_log *info, imk_info_next next, imki_reasons *reasons)
{
    const bool doubts = add_doubts(info, reasons);
    if (next == IMK_INFO_NEXT_NONE && info->whole) {
        imki_reason(reasons,
                    "the sensor is moved, and rests %zu times, while calibrate needs 12 rests in "
                    "different attitudes, or 6 on the faces of a housing",
                    info->holds);
        imki_judge(reasons, IMK_NOT_USABLE, " for identify or calibrate");
        return;
    }
    imki_reason(reasons, "the sensor rests in %zu attitudes%s", info->attitudes,
                info->whole ? "" : " or more; only places in the log were read");
    imki_judge(reasons, doubts || !info->whole ? IMK_USABLE_WITH_CARE : IMK_USABLE,
               next == IMK_INFO_NEXT_SIXPOSITION ? " for a sixposition calibration"
                                                 : " for a multiposition calibration");
}

/* A log in motion is no test, but six axes can be navigated. */
static void judge_motion(const imk_info_log *info, imki_reasons *reasons)
{
    const bool six = count_of(info, IMK_QUANTITY_ANGULAR_RATE) >= 3 &&
                     count_of(info, IMK_QUANTITY_SPECIFIC_FORCE) >= 3;
    const bool doubts = add_doubts(info, reasons);
    imki_reason(reasons, "the sensor is moved%s, so that identify cannot see its noise",
                info->resting < 0.01 ? "" : " in a part of the log");
    imki_judge(reasons,
               !six     ? IMK_NOT_USABLE
               : doubts ? IMK_USABLE_WITH_CARE
                        : IMK_USABLE,
               six ? " for navigate and compensate only" : " for identify");
}

void imki_judge_info(const imk_info_log *info, const imk_info_file *file, imk_result *result)
{
    imki_reasons reasons = {.result = result};
    if (!info) {
        imki_reason(&reasons, "of the %zu sensors in it, one has to be chosen", file->stream_count);
        imki_judge(&reasons, IMK_NOT_USABLE, " yet");
        return;
    }
    if (add_obstacles(info, &reasons)) {
        imki_judge(&reasons, IMK_NOT_USABLE, " as it is");
        return;
    }
    const imk_info_next next = imk_info_log_next(info);
    if (imki_info_counted(info)) {
        imki_reason(&reasons, "the readings are counts, and what a count is has to be stated");
        imki_judge(&reasons, IMK_USABLE_WITH_CARE, " for calibrate only");
    } else if (info->motion == IMK_INFO_REST) {
        judge_rest(info, &reasons);
    } else if (info->motion == IMK_INFO_POSES) {
        judge_poses(info, next, &reasons);
    } else if (info->motion == IMK_INFO_MOVES) {
        judge_motion(info, &reasons);
    } else {
        imki_reason(&reasons, "less than three seconds without holes do not show whether the "
                              "sensor rests");
        imki_judge(&reasons, IMK_NOT_USABLE, " for identify");
    }
}
