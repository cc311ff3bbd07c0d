/* SPDX-License-Identifier: Apache-2.0 */
/* Tones that several channels share are motion of what the sensor stands on, not noise of its own:
 * each axis of a sensor has electronics and a structure of its own, but they all stand on the same
 * table. Harmonics tell a machine. */
#include "identify_show_internal.h"

#include <math.h>

enum { TONES_MAX = 2 * IMK_TERMS_MAX * IMK_LOG_COLUMNS_MAX, TOLD_MAX = 3, HARMONICS = 5 };

/* Resonances wider than this have a place of their own in each axis. */
static const double narrow_q = 20;

typedef struct tone {
    double frequency;
    size_t channel;
} tone;

typedef struct tone_list {
    size_t count;
    tone item[TONES_MAX];
} tone_list;

static void add_tone(tone_list *list, double frequency, size_t channel)
{
    if (list->count < TONES_MAX)
        list->item[list->count++] = (tone){frequency, channel};
}

static void gather(const imk_identify_log *log, tone_list *list)
{
    for (size_t c = 0; c < log->record.count; c++) {
        const imk_identification *r = &log->result[c];
        for (int k = 0; k < r->sinusoid_count; k++)
            add_tone(list, r->sinusoid[k].frequency, c);
        for (int k = 0; k < r->resonance_count; k++)
            if (r->resonance[k].q > narrow_q)
                add_tone(list, r->resonance[k].frequency, c);
    }
}

/* Channels with a tone of this frequency: within 1 %, or what the length of the record tells. */
static uint64_t channels_at(const tone_list *list, double frequency, double duration)
{
    const double apart = fmax(0.01 * frequency, 2 / duration);
    uint64_t channels = 0;
    for (size_t k = 0; k < list->count; k++)
        if (fabs(list->item[k].frequency - frequency) < apart)
            channels |= (uint64_t)1 << list->item[k].channel;
    return channels;
}

static bool is_single(uint64_t channels)
{
    return (channels & (channels - 1)) == 0;
}

/* "23.1 Hz (with 46.2, 69.3 Hz)" */
static uint64_t name_tone(const tone_list *list, double frequency, double duration, imki_text *text)
{
    uint64_t channels = channels_at(list, frequency, duration);
    int found = 0;
    imki_text_add(text, "%s%.4g Hz", text->size > 0 ? ", " : "", frequency);
    for (int n = 2; n <= HARMONICS; n++) {
        const uint64_t here = channels_at(list, n * frequency, duration);
        if (here == 0)
            continue;
        imki_text_add(text, "%s%.4g", found++ == 0 ? " (with " : ", ", n * frequency);
        channels |= here;
    }
    if (found > 0)
        imki_text_put(text, " Hz)");
    return channels;
}

/* Is it a harmonic of a lower tone that is shared? */
static bool is_overtone(const tone_list *list, double frequency, double duration)
{
    for (int n = 2; n <= HARMONICS; n++)
        if (!is_single(channels_at(list, frequency / n, duration)))
            return true;
    return false;
}

/* A mean of neighbouring samples has zeros in its spectrum at the same frequencies on all channels.
 * The model has no such filter, and explains it by a low-pass filter and tones. */
static bool may_be_averaged(const imk_identify_log *log, uint64_t channels)
{
    for (size_t c = 0; c < log->record.count; c++)
        if (!(log->result[c].filter.bandwidth > 0) || !(channels >> c & 1))
            return false;
    return true;
}

void imki_assess_vibration(imk_verdict *v, const imk_identify_log *log)
{
    tone_list list;
    imki_text text = {.bytes = NULL};
    uint64_t channels = 0;
    double told[TOLD_MAX];
    size_t count = 0;
    list.count = 0;
    gather(log, &list);
    for (size_t k = 0; k < list.count && count < TOLD_MAX; k++) {
        const double f = list.item[k].frequency;
        bool known =
            is_single(channels_at(&list, f, log->duration)) || is_overtone(&list, f, log->duration);
        for (size_t i = 0; i < count; i++)
            known = known || fabs(told[i] - f) < fmax(0.01 * f, 2 / log->duration);
        if (known)
            continue;
        told[count++] = f;
        channels |= name_tone(&list, f, log->duration, &text);
    }
    const bool averaged = may_be_averaged(log, channels);
    imki_verdict_list(v, IMK_FINDING_NOTE, "vibration",
                      averaged ? "all channels have the same tones and a low-pass filter: what the "
                                 "sensor stands on vibrates (a fan, a motor, the building), or the "
                                 "logger wrote averages of several samples, at "
                               : "several channels have the same tones: what the sensor stands on "
                                 "vibrates (a fan, a motor, the building), at ",
                      &text, "; they are modelled, but are none of the sensor's own.");
    if (!channels)
        return;
    imki_verdict_about(v, &log->record, channels);
    if (averaged && v->message && v->count > 0 && !v->label)
        v->message[v->count - 1].brief = "Vibration of what the sensor stands on, or averages of "
                                         "the logger: all channels.";
}
