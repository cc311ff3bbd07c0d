/* SPDX-License-Identifier: Apache-2.0 */
/* What the table of a schematic says of a design and of a moment. */
#include "schematic_internal.h"

#include <math.h>
#include <string.h>

const char *imk_move_name(imk_move move)
{
    static const char *const names[] = {"turn",      "shift-x", "shift-y", "stretch-x",
                                        "stretch-y", "squeeze", "flow",    "glow"};
    return names[move];
}

double imk_schematic_pace(const imk_schematic *schematic, const void *design)
{
    return schematic->cycle(design) / schematic->cycle_screen;
}

static const imk_schematic_part *part_of(const imk_schematic *schematic, const char *id)
{
    for (size_t i = 0; i < schematic->part_count; i++)
        if (strcmp(schematic->parts[i].id, id) == 0)
            return &schematic->parts[i];
    return NULL;
}

double imk_schematic_gain(const imk_schematic *schematic, const void *design, size_t index)
{
    const imk_schematic_part *part = &schematic->parts[index];
    const imk_schematic_part *leader = part->with ? part_of(schematic, part->with) : part;
    const double radian = 180 / 3.14159265358979323846;
    const double full = leader && leader->full ? leader->full(design) : 1;
    if (!leader || !(full > 0 && isfinite(full)))
        return 0;
    double gain = leader->reach / full;
    if (leader->move == IMK_MOVE_TURN && leader->full)
        gain = (gain < 0 ? -radian : radian) * imki_round_down(fabs(gain) / radian);
    return leader == part ? gain : part->reach * gain;
}

double imki_signal(const imk_instrument *instrument, const char *name,
                   const imk_schematic_moment *moment)
{
    if (strcmp(name, "screen") == 0)
        return moment->screen;
    if (strcmp(name, "turned") == 0)
        return moment->turned;
    if (strcmp(name, "input") == 0)
        return instrument->sensor == IMK_GYRO ? moment->exposure->angular_rate[0]
                                              : moment->exposure->specific_force[0];
    for (size_t i = 0; i < instrument->signal_count; i++)
        if (strcmp(name, instrument->signals[i].name) == 0)
            return moment->signals[i];
    for (size_t i = 0; i < instrument->output_count; i++)
        if (strcmp(name, instrument->outputs[i].name) == 0)
            return moment->outputs[i];
    return (double)NAN;
}

double imk_schematic_place(const imk_schematic *schematic, const void *design, size_t index,
                           const imk_schematic_moment *moment)
{
    const imk_schematic_part *part = &schematic->parts[index];
    return part->base + imk_schematic_gain(schematic, design, index) *
                            imki_signal(schematic->instrument, part->signal, moment);
}

double imki_still_value(const imk_schematic *schematic, const void *design, size_t index)
{
    const imk_schematic_part *part = &schematic->parts[index];
    const imk_schematic_part *leader = part->with ? part_of(schematic, part->with) : part;
    const double full = leader && leader->full ? leader->full(design) : 1;
    const double gain = imk_schematic_gain(schematic, design, index);
    return part->base + (leader && gain != 0 ? gain * leader->still * full : 0);
}

imk_schematic_quantity imk_schematic_quantity_get(const imk_schematic *schematic, size_t index)
{
    imk_schematic_quantity quantity = schematic->quantities[index];
    const imk_derived *derived = imk_instrument_derived(schematic->instrument, quantity.name);
    if (!quantity.value && derived) {
        quantity.name = derived->name;
        quantity.symbol = derived->symbol;
        quantity.si = derived->si;
        quantity.unit = derived->unit;
        quantity.equation = derived->equation;
    }
    return quantity;
}

double imk_schematic_quantity_value(const imk_schematic *schematic, const void *design,
                                    size_t index, const imk_schematic_moment *moment)
{
    const imk_schematic_quantity *quantity = &schematic->quantities[index];
    if (quantity->value)
        return quantity->value(design, moment);
    const imk_derived *derived = imk_instrument_derived(schematic->instrument, quantity->name);
    return derived ? imk_derived_value(derived, design) : (double)NAN;
}
