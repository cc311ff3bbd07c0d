/* SPDX-License-Identifier: Apache-2.0 */
/* The calibration as one self-contained page. */
#include "calibrate_parts.h"

#include "shell/page_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void put_table(imk_page *page, text_table table)
{
    page_put_table(page, &table);
    text_table_free(&table);
}

static void put_verdict(imk_page *page, const bench *b)
{
    static const int boxes[] = {0, 1, 2, 2};
    char text[900];
    imk_page_heading(page, "Verdict");
    bench_verdict(b, text, sizeof text);
    imk_page_verdict(page, boxes[bench_level(b)], text);
    for (size_t k = 0; k < b->sentence_count; k++)
        imk_page_verdict(page, boxes[b->sentence[k].level], b->sentence[k].text);
}

/* How the threshold came about, and the intervals. */
static void put_holds(imk_page *page, const bench_log *log)
{
    const imk_static_findings *f = &log->stationary;
    char text[400];
    if (!(f->window > 0))
        return;
    snprintf(text, sizeof text,
             "%.120s: windows of %.3g s; noise learnt from %.6g s to %.6g s; %.3g %% of the log "
             "stands still, in %zu intervals; %zu stretches were too short, %zu samples saturated, "
             "%zu no numbers.",
             log->record.name, f->window, (double)f->rest_begin * log->record.dt,
             (double)f->rest_end * log->record.dt, 100 * f->standing, f->intervals, f->too_short,
             f->saturated, f->not_finite);
    imk_page_text(page, text);
}

static void put_parameters(imk_page *page, const bench *b)
{
    char text[900];
    imk_page_heading(page, b->runs ? "From run to run" : "Parameters");
    for (int sensor = 1; sensor >= 0; sensor--)
        put_table(page, b->runs ? bench_run_table(b, sensor) : bench_parameter_table(b, sensor));
    if (b->result)
        imk_page_text(page, "Values with 1 sigma; below each the interval that holds the true "
                            "value with 95 % confidence (Student's distribution, with what the "
                            "residuals show beyond the noise taken into account). A response "
                            "\"misalignment, y\" is how much of the y component the axis sees.");
    for (size_t line = 0; bench_remark(b, line, text, sizeof text); line++)
        imk_page_text(page, text);
}

static void put_temperature(imk_page *page, const bench *b)
{
    bool any = false;
    for (size_t k = 0; k < b->log_count; k++)
        for (int sensor = 1; sensor >= 0; sensor--) {
            text_table table = bench_thermal_table(&b->log[k], sensor, false);
            if (table.rows > 0 && !any)
                imk_page_heading(page, "Over temperature");
            any = any || table.rows > 0;
            put_table(page, table);
        }
}

int bench_report(const bench *b, const char *path)
{
    char subtitle[300];
    size_t used = 0;
    subtitle[0] = '\0';
    for (size_t k = 0; k < b->log_count && used < sizeof subtitle; k++)
        used +=
            (size_t)snprintf(subtitle + used, sizeof subtitle - used, "%s%.100s (%s)",
                             k > 0 ? ", " : "", b->log[k].record.name,
                             b->runs ? "repeatability" : imk_procedure_name(b->log[k].procedure));
    imk_page *page = imk_page_create("Calibration of an inertial sensor", subtitle);
    put_verdict(page, b);
    put_parameters(page, b);
    put_temperature(page, b);
    if (b->result && !b->ferraris) {
        imk_page_heading(page, "Fit");
        put_table(page, bench_fit_table(b));
        bench_put_figure(b, page);
        imk_page_heading(page, "Observations");
    }
    for (size_t k = 0; k < b->log_count; k++)
        put_holds(page, &b->log[k]);
    put_table(page, bench_pose_table(b));
    page_put_model(page, "Model file", &b->model);
    imk_page_heading(page, "This page was made by");
    imk_page_code(page, command_line());
    return page_write(page, path);
}
