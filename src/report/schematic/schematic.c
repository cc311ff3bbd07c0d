/* SPDX-License-Identifier: Apache-2.0 */
/* The schematics there are, and the sheet that a drawing stands on. */
#include "schematic_internal.h"

#include "report/markup_internal.h"

#define SCHEMATIC(name) &imki_schematic_##name,
static const imk_schematic *const schematics[] = {IMKI_SCHEMATICS(SCHEMATIC)};

const imk_schematic *imk_schematic_of(const imk_instrument *instrument)
{
    for (size_t i = 0; i < IMKI_SCHEMATIC_LENGTH(schematics); i++)
        if (schematics[i]->instrument == instrument)
            return schematics[i];
    return NULL;
}

/* ---- the sheet ------------------------------------------------------------------------------- */

/* Classes begin with "s-", since a drawing may stand in a page with classes of its own. Colours
 * that readers with colour blindness can tell apart, for light and dark sheets. Widths do not grow
 * where a part is stretched. */
static const char style[] =
    "<style>\n"
    ".schematic{fill:none;stroke:#1f2933;stroke-width:2;stroke-linejoin:round;fill-rule:evenodd}\n"
    ".s-elastic *{vector-effect:non-scaling-stroke}.s-paper{fill:#fff;stroke:none}\n"
    ".schematic text{fill:#1f2933;stroke:none}.schematic .s-note{fill:#55616c}\n"
    ".s-small{font-size:15px}.s-thin,.s-bar{stroke:#7b8794;stroke-width:1.2}\n"
    ".s-axis{stroke:#7b8794;stroke-width:1.2;stroke-dasharray:14 4 3 4}\n"
    ".s-hatch{stroke:#7b8794;stroke-width:1.5}.s-dot{fill:#7b8794;stroke:none}\n"
    ".s-body{fill:#e3e7eb}.s-mass{fill:#b9d4ec}.s-glass{fill:#d7eef6}\n"
    ".s-spring{stroke:#3d4b57;stroke-width:2}.s-field{fill:#f7d9bd;stroke:#9a4a0a}\n"
    ".s-one{stroke:#d55e00;stroke-width:3}.s-two{stroke:#0072b2;stroke-width:3}\n"
    ".s-accent{stroke:#00805d;stroke-width:3}.s-wide{stroke-width:46}\n"
    ".s-shaft{stroke-width:5}.s-rim{stroke:none}.s-glowing{fill:#ffd23f;stroke:none}\n"
    ".s-rim-marks{stroke-width:40}.s-ring{stroke-width:9}.s-fill-one{fill:#d55e00;stroke:none}\n"
    ".s-fill-two{fill:#0072b2;stroke:none}.s-fill-accent{fill:#00805d;stroke:none}\n"
    ".s-head{stroke:none;fill:#1f2933}.s-head.s-one{fill:#d55e00}\n"
    ".s-head.s-two{fill:#0072b2}.s-head.s-accent{fill:#00805d}\n"
    "@media screen and (prefers-color-scheme:dark){.s-glowing{fill:#a07800}\n"
    ".schematic{stroke:#e4e9ee}.s-paper{fill:#14191e;stroke:none}\n"
    ".schematic text{fill:#e4e9ee}.schematic .s-note{fill:#a6b1bb}\n"
    ".s-thin,.s-bar,.s-axis,.s-hatch{stroke:#8794a0}.s-dot{fill:#8794a0;stroke:none}\n"
    ".s-body{fill:#333d46}.s-mass{fill:#21507a}.s-glass{fill:#1d4552}\n"
    ".s-spring{stroke:#b8c4ce}.s-field{fill:#5c3716;stroke:#f0a468}.s-one{stroke:#ff9447}\n"
    ".s-two{stroke:#5db8f5}.s-accent{stroke:#2fd0a0}.s-fill-one{fill:#ff9447;stroke:none}\n"
    ".s-fill-two{fill:#5db8f5;stroke:none}.s-fill-accent{fill:#2fd0a0;stroke:none}\n"
    ".s-head{stroke:none;fill:#e4e9ee}.s-head.s-one{fill:#ff9447}\n"
    ".s-head.s-two{fill:#5db8f5}.s-head.s-accent{fill:#2fd0a0}\n"
    "}\n";

static const char which[] =
    ".s-still{display:none}\n"
    "@media (prefers-reduced-motion:reduce){.s-still{display:inline}.s-moving{display:none}}\n"
    "@media print{.s-still{display:inline}.s-moving{display:none}}\n";

static void put_drawing(imki_drawing *d)
{
    d->schematic->draw(d, d->design);
    imki_draw_time(d);
}

static void put_title(imki_drawing *d)
{
    imki_text_put(&d->text, "<title>");
    imki_markup_escape(&d->text, d->schematic->instrument->title);
    imki_text_put(&d->text, "</title>\n<desc>");
    imki_markup_escape(&d->text, d->schematic->description);
    imki_text_put(&d->text, "</desc>\n");
}

imk_status imki_schematic_sheet(const imk_schematic *schematic, const void *design,
                                const imki_film *film, char **svg, size_t *size, imk_error *error)
{
    imki_drawing drawing = {.schematic = schematic, .design = design}, *d = &drawing;
    imki_text_add(&d->text,
                  "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"schematic\" "
                  "viewBox=\"0 0 %d %d\" width=\"%d\" height=\"%d\" role=\"img\" "
                  "font-family=\"DejaVu Sans,Verdana,sans-serif\" font-size=\"20\">\n",
                  IMK_SCHEMATIC_WIDTH, IMK_SCHEMATIC_HEIGHT, IMK_SCHEMATIC_WIDTH,
                  IMK_SCHEMATIC_HEIGHT);
    put_title(d);
    imki_text_put(&d->text, style);
    imki_text_put(&d->text, film ? which : "");
    imki_text_add(&d->text,
                  "</style>\n<rect class=\"s-paper\" width=\"%d\" height=\"%d\" rx=\"8\"/>\n",
                  IMK_SCHEMATIC_WIDTH, IMK_SCHEMATIC_HEIGHT);
    imki_draw_title(d);
    imki_text_put(&d->text, film ? "<g class=\"s-still\">\n" : "");
    put_drawing(d);
    if (film) {
        imki_text_put(&d->text, "</g>\n<g class=\"s-moving\">\n");
        d->film = film;
        put_drawing(d);
        imki_text_put(&d->text, "</g>\n");
    }
    imki_text_put(&d->text, "</svg>\n");
    *svg = imki_text_take(&d->text, size);
    return *svg ? IMK_OK : imk_error_set(error, IMK_ERROR_MEMORY, "schematic", NULL, NULL);
}

imk_status imki_schematic_find(const imk_instrument *instrument, const void *design,
                               const imk_schematic **schematic, imk_error *error)
{
    if (!instrument || !design)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, instrument ? "design" : "instrument", NULL,
                             "an instrument, and a design of it");
    *schematic = imk_schematic_of(instrument);
    if (!*schematic)
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "instrument", instrument->name,
                             "an instrument with a schematic");
    return imk_design_check(instrument, design, error);
}

imk_status imk_schematic_svg(const imk_instrument *instrument, const void *design, char **svg,
                             size_t *size, imk_error *error)
{
    const imk_schematic *schematic = NULL;
    const imk_status status = imki_schematic_find(instrument, design, &schematic, error);
    return status == IMK_OK ? imki_schematic_sheet(schematic, design, NULL, svg, size, error)
                            : status;
}
