/* SPDX-License-Identifier: Apache-2.0 */
/* What changes the results of any log of this kind and leaves no trace in it: a verdict without a
 * doubt says nothing about it. */
#include "identify_show_internal.h"

#include "report/result_internal.h"

#include <stdlib.h>

static bool has_times(const imk_even_record *record)
{
    for (size_t c = 0; c < record->log.column_count; c++)
        if (record->log.column[c].quantity == IMK_QUANTITY_TIME)
            return true;
    return false;
}

static int axes_of(const imk_even_record *record, imk_channel_kind kind)
{
    int axes = 0;
    for (size_t c = 0; c < record->count; c++)
        axes += imk_channel_kind_of(imk_even_record_column(record, c)) == kind;
    return axes;
}

typedef struct untestable {
    imki_text brief, whole;
} untestable;

static void add(untestable *list, const char *brief, const char *effect)
{
    const char *sign = list->brief.size > 0 ? "; " : "";
    imki_text_add(&list->brief, "%s%s", sign, brief);
    imki_text_add(&list->whole, "%s%s (%s)", sign, brief, effect);
}

void imki_assess_untestable(imk_verdict *v, const imk_even_record *record)
{
    const int gyros = axes_of(record, IMK_CHANNEL_GYRO),
              accels = axes_of(record, IMK_CHANNEL_ACCEL);
    untestable list = {{.bytes = NULL}, {.bytes = NULL}};
    if (has_times(record))
        add(&list, "a wrong unit or rate of the time", "all terms of all channels change");
    else
        add(&list, "a wrong --rate", "all terms of all channels change");
    if (gyros > 0)
        add(&list, "a wrong unit or range of the gyros", "all their terms change in proportion");
    if (accels >= 3)
        add(&list, "accelerometer scales off by up to 5 %", "gravity shows larger errors");
    else if (accels > 0)
        add(&list, "a wrong unit of the accelerometers",
            "only three axes together can be compared with gravity");
    if (gyros + accels == 0)
        add(&list, "a wrong unit of the columns", "all their terms change in proportion");
    if (v->result && (list.brief.failed || list.whole.failed))
        v->result->arena.failed = true;
    else if (v->result) {
        imki_verdict_add(v, IMK_FINDING_NOTE, "not_testable", "Cannot be seen in a log: %s.",
                         list.whole.bytes);
        if (v->count > 0)
            v->message[v->count - 1].brief =
                imk_result_key(v->result, "Cannot be seen in a log: %s.", list.brief.bytes);
    }
    free(list.brief.bytes);
    free(list.whole.bytes);
}
