/* SPDX-License-Identifier: Apache-2.0 */
/* An instrument as an HTML page: its outputs, its views, its design, its error model. */
#include "physics_parts.h"
#include "shell/page_table.h"

#include "imukit/model_file.h"

#include <stdlib.h>

static void put_run(imk_page *page, const physics *p, const physics_run *run)
{
    physics_figure *figure = command_memory(NULL, sizeof *figure);
    physics_figure_of_run(p, run, figure);
    imk_page_heading(page, "Outputs against time");
    imk_page_figure(page, &figure->figure,
                    run->stride > 1 ? "Each point is the mean of several samples."
                                    : "Each point is a sample: the mean since the one before.");
    physics_figure_free(figure);
    free(figure);
}

static void put_view(imk_page *page, const imk_view *view, const physics_figure *figure)
{
    char clock[80];
    if (physics_view_can_move(view)) {
        const imk_animation animation =
            physics_animation_of_view(view, figure, clock, sizeof clock);
        imk_page_animation(page, &animation, view->caption);
    } else {
        imk_page_figure(page, &figure->figure, view->caption);
    }
}

/* A view that cannot be drawn (the reason is on standard error) is left out, and so is one of what
 * this design has not. */
static void put_views(imk_page *page, const physics *p)
{
    const imk_instrument *instrument = p->file.instrument;
    physics_figure *figure = command_memory(NULL, sizeof *figure);
    if (instrument->view_count > 0)
        imk_page_heading(page, "Inside the instrument");
    for (size_t i = 0; i < instrument->view_count; i++) {
        const imk_view *view = &instrument->views[i];
        if (physics_figure_of_view(p, i, figure) >= 0) {
            command_warn("view", "the view \"%s\" is left out", view->title);
            continue;
        }
        if (!physics_view_is_empty(view, &figure->panel[0]))
            put_view(page, view, figure);
        physics_figure_free(figure);
    }
    free(figure);
}

static void put_table(imk_page *page, const char *title, text_table table)
{
    imk_page_heading(page, title);
    page_put_table(page, &table);
    text_table_free(&table);
}

static void put_model(imk_page *page, const physics *p)
{
    put_table(page, "Reduced error model",
              physics_model_table(p->model, p->file.instrument->sensor));
    imk_page_text(page, "From the design by closed forms; one axis, along x.");
    page_put_model(page, "As a file", p->model);
}

static void put_laboratory(imk_page *page, const physics *p, const physics_laboratory *l)
{
    physics_figure *figure = command_memory(NULL, sizeof *figure);
    put_table(page, "Closed forms against experiments", physics_sweep_table(p, l));
    if (physics_figure_of_laboratory(p, l, figure))
        imk_page_figure(page, &figure->figure,
                        "The rate table shows output less input, bars of two standard deviations; "
                        "the response is the gain for a sine.");
    physics_figure_free(figure);
    free(figure);
}

int physics_report(const physics *p, const physics_run *run, const physics_laboratory *laboratory,
                   const char *path)
{
    const imk_instrument *instrument = p->file.instrument;
    char subtitle[400];
    snprintf(subtitle, sizeof subtitle, "%.120s. Default design: %.240s", instrument->title,
             instrument->source);
    imk_page *page = imk_page_create(p->file.name[0] ? p->file.name : instrument->title, subtitle);
    if (p->file.description[0])
        imk_page_text(page, p->file.description);
    if (run)
        put_run(page, p, run);
    put_views(page, p);
    put_table(page, "Design", physics_design_table(p));
    put_model(page, p);
    if (laboratory)
        put_laboratory(page, p, laboratory);
    /* all warnings are known now */
    for (size_t i = 0; i < command_warning_count(); i++)
        imk_page_verdict(page, 2, command_warning_get(i)->message);
    imk_page_heading(page, "This page was made by");
    imk_page_code(page, command_line());
    return page_write(page, path);
}
