/* SPDX-License-Identifier: Apache-2.0 */
/* Drift as CSV. */
#include "drift_parts.h"

#include "imukit/output_file.h"

#include <math.h>

static void put_number(imk_output_file *file, double value)
{
    char text[IMK_DECIMAL_SIZE];
    text[isfinite(value) ? imk_decimal_shortest(value, text) : 0] = '\0';
    imk_output_file_print(file, ",%s", text);
}

/* A text that may have a comma or a quote in it. */
static void put_text(imk_output_file *file, const char *text)
{
    imk_output_file_print(file, "\"");
    for (; *text; text++)
        imk_output_file_print(file, *text == '"' ? "\"\"" : "%c", *text);
    imk_output_file_print(file, "\"");
}

static void put_row(imk_output_file *file, const char *model, const char *source, double time,
                    const imk_drift_figures *figures, const imk_drift_moments *moments)
{
    const imk_drift_figures *f = figures;
    const double value[] = {f->cep,    f->r95,      f->drms,  f->north, f->east,
                            f->height, f->velocity, f->climb, f->tilt,  f->heading};
    put_text(file, model);
    imk_output_file_print(file, ",%s", source);
    put_number(file, time);
    for (size_t i = 0; i < sizeof value / sizeof value[0]; i++)
        put_number(file, value[i]);
    for (int i = 0; i < 2; i++)
        put_number(file, moments ? moments->mean[i] : (double)NAN);
    imk_output_file_print(file, "\n");
}

/* The total and every source of an analysis at all times. */
static void put_case(imk_output_file *file, const imk_drift_case *one)
{
    const imk_drift_analysis *a = one->analysis;
    for (size_t t = 0; t < a->time_count; t++)
        put_row(file, one->label, "total", a->time[t], &one->figures[t], &a->total[t]);
    for (size_t k = 0; k < a->source_count; k++)
        for (size_t t = 0; t < a->time_count; t++) {
            const imk_drift_moments *m = &a->contribution[k * a->time_count + t];
            const imk_drift_figures f = imk_drift_figures_of(m);
            put_row(file, one->label, a->source[k].name, a->time[t], &f, m);
        }
}

int drift_write_csv(const imk_drift_models *r, const char *path)
{
    imk_output_file *file;
    imk_error error;
    if (imk_output_file_open(path, &file, &error) != IMK_OK)
        return command_error(&error, NULL);
    imk_output_file_print(file, "model,source,time [s],cep [m],r95 [m],drms [m],north [m],east [m],"
                                "height [m],velocity [m/s],climb [m/s],tilt [rad],heading [rad],"
                                "mean_north [m],mean_east [m]\n");
    for (size_t c = 0; c < r->case_count; c++)
        put_case(file, &r->cases[c]);
    for (size_t k = 0; r->found && k < r->times->row_count; k++) {
        const double time = r->times->time[r->times->row[k]];
        put_row(file, r->name[0], "runs", time, &r->found[k], NULL);
        put_row(file, r->name[0], "runs_lower", time, &r->low[k], NULL);
        put_row(file, r->name[0], "runs_upper", time, &r->high[k], NULL);
    }
    if (imk_output_file_commit(file, &error) != IMK_OK)
        return command_error(&error, NULL);
    return -1;
}
