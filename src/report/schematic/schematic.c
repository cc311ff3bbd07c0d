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

/* Colours that readers with colour blindness can tell apart, for light and dark sheets. Widths do
 * not grow where a part is stretched. */
static const char style[] =
    "<style>\n"
    ".schematic path,.schematic circle,.schematic ellipse,.schematic rect{fill:none;"
    "stroke:#1f2933;stroke-width:2;stroke-linejoin:round;fill-rule:evenodd}\n"
    ".schematic .elastic *{vector-effect:non-scaling-stroke}\n"
    ".schematic .paper{fill:#fff;stroke:none}\n"
    ".schematic text{fill:#1f2933}.schematic .note{fill:#55616c}.schematic .small{font-size:15px}\n"
    ".schematic .thin,.schematic .bar{stroke:#7b8794;stroke-width:1.2}\n"
    ".schematic .axis{stroke:#7b8794;stroke-width:1.2;stroke-dasharray:14 4 3 4}\n"
    ".schematic .hatch{stroke:#7b8794;stroke-width:1.5}.schematic .dot{fill:#7b8794;stroke:none}\n"
    ".schematic .body{fill:#e3e7eb}.schematic .mass{fill:#b9d4ec}.schematic .glass{fill:#d7eef6}\n"
    ".schematic .spring{stroke:#3d4b57;stroke-width:2}\n"
    ".schematic .field{fill:#f7d9bd;stroke:#9a4a0a}\n"
    ".schematic .one{stroke:#d55e00;stroke-width:3}.schematic .two{stroke:#0072b2;stroke-width:3}\n"
    ".schematic .accent{stroke:#00805d;stroke-width:3}.schematic .wide{stroke-width:46}.schematic "
    ".shaft{stroke-width:5}.schematic .rim{stroke:none}.schematic "
    ".glowing{fill:#ffd23f;stroke:none}.schematic .rim-marks{stroke-width:40}.schematic "
    ".ring{stroke-width:9}\n"
    ".schematic .fill-one{fill:#d55e00;stroke:none}.schematic .fill-two{fill:#0072b2;stroke:none}\n"
    ".schematic .fill-accent{fill:#00805d;stroke:none}\n"
    ".schematic .head{stroke:none;fill:#1f2933}.schematic .head.one{fill:#d55e00}"
    ".schematic .head.two{fill:#0072b2}.schematic .head.accent{fill:#00805d}\n"
    "@media (prefers-color-scheme:dark){.schematic .glowing{fill:#a07800}\n"
    ".schematic path,.schematic circle,.schematic ellipse,.schematic rect{stroke:#e4e9ee}\n"
    ".schematic .paper{fill:#14191e;stroke:none}\n"
    ".schematic text{fill:#e4e9ee}.schematic .note{fill:#a6b1bb}\n"
    ".schematic .thin,.schematic .bar,.schematic .axis,.schematic .hatch{stroke:#8794a0}"
    ".schematic .dot{fill:#8794a0;stroke:none}\n"
    ".schematic .body{fill:#333d46}.schematic .mass{fill:#21507a}.schematic .glass{fill:#1d4552}\n"
    ".schematic .spring{stroke:#b8c4ce}.schematic .field{fill:#5c3716;stroke:#f0a468}\n"
    ".schematic .one{stroke:#ff9447}.schematic .two{stroke:#5db8f5}.schematic .accent{stroke:"
    "#2fd0a0}\n"
    ".schematic .fill-one{fill:#ff9447;stroke:none}.schematic .fill-two{fill:#5db8f5;stroke:none}"
    ".schematic .fill-accent{fill:#2fd0a0;stroke:none}\n"
    ".schematic .head{stroke:none;fill:#e4e9ee}.schematic .head.one{fill:#ff9447}"
    ".schematic .head.two{fill:#5db8f5}.schematic .head.accent{fill:#2fd0a0}\n}\n";

static const char which[] = ".schematic .still{display:none}\n"
                            "@media (prefers-reduced-motion:reduce){.schematic .still{display:"
                            "inline}.schematic .moving{display:none}}\n"
                            "@media print{.schematic .still{display:inline}.schematic "
                            ".moving{display:none}}\n";

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
                  "</style>\n<rect class=\"paper\" width=\"%d\" height=\"%d\" rx=\"8\"/>\n",
                  IMK_SCHEMATIC_WIDTH, IMK_SCHEMATIC_HEIGHT);
    imki_draw_title(d);
    imki_text_put(&d->text, film ? "<g class=\"still\">\n" : "");
    put_drawing(d);
    if (film) {
        imki_text_put(&d->text, "</g>\n<g class=\"moving\">\n");
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
