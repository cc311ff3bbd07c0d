/* SPDX-License-Identifier: Apache-2.0 */
/* "reading log.csv  43 %  310 MB/s  12 s left", redrawn a few times a second. */
#define _POSIX_C_SOURCE 200809L
#include "progress.h"

#include <stdio.h>
#include <time.h>
#include <unistd.h>

/* Nothing is shown before this time: short work stays quiet. */
static const double quiet_time = 0.7, redraw_time = 0.2; /* [s] */

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

progress progress_begin(const char *label, const char *unit, double scale)
{
    progress p = {
        .visible = isatty(STDERR_FILENO) != 0, .label = label, .unit = unit, .scale = scale};
    p.start = p.last = now();
    return p;
}

static void write_rate(double rate, const char *unit)
{
    const char *prefix = "";
    if (rate >= 1e9) {
        rate /= 1e9;
        prefix = "G";
    } else if (rate >= 1e6) {
        rate /= 1e6;
        prefix = "M";
    } else if (rate >= 1e3) {
        rate /= 1e3;
        prefix = "k";
    }
    fprintf(stderr, "  %.3g %s%s/s", rate, prefix, unit);
}

void progress_update(progress *p, uint64_t done, uint64_t total)
{
    if (!p->visible)
        return;
    double time = now();
    if (time - p->start < quiet_time || time - p->last < redraw_time)
        return;
    p->last = time;
    p->shown = true;
    double elapsed = time - p->start, rate = (double)done / elapsed;
    fprintf(stderr, "\r\033[K%s", p->label);
    if (total > 0 && done <= total)
        fprintf(stderr, "  %2.0f %%", 100 * (double)done / (double)total);
    write_rate(rate * p->scale, p->unit);
    if (total > done && rate > 0) {
        double left = (double)(total - done) / rate;
        if (left < 90)
            fprintf(stderr, "  %.0f s left", left);
        else if (left < 90 * 60)
            fprintf(stderr, "  %.0f min left", left / 60);
        else
            fprintf(stderr, "  %.1f h left", left / 3600);
    }
    fflush(stderr);
}

void progress_end(progress *p)
{
    if (p->shown)
        fputs("\r\033[K", stderr);
    p->shown = false;
}
