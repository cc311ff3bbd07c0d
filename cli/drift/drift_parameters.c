/* SPDX-License-Identifier: Apache-2.0 */
/* Everything that the numbers of a campaign depend on, as JSON: equal physics gives equal text.
 *
 * The model is without its name, its evidence and the texts of the file it came from; numbers are
 * the shortest that read back to the same double. A motion script is there as it is; of any motion
 * there is a digest of the compiled numbers, two 64-bit hashes of Fowler, Noll and Vo
 * [FOWLER1991]. */
#include "drift_parts.h"

#include "imukit/model_file.h"

#include <stdlib.h>
#include <string.h>

/* ---- motion ---- */

typedef struct digest {
    uint64_t a, b;
} digest;

static void add_bytes(digest *d, const void *bytes, size_t size)
{
    const uint64_t prime = 0x100000001b3u;
    const unsigned char *byte = bytes;
    for (size_t i = 0; i < size; i++) {
        d->a = (d->a ^ byte[i]) * prime;
        d->b = d->b * prime ^ byte[i];
    }
}

/* By the value, the lowest byte first, so that it is the same on every machine. */
static void add_numbers(digest *d, const double *number, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint64_t bits;
        unsigned char byte[8];
        memcpy(&bits, &number[i], sizeof bits);
        for (int k = 0; k < 8; k++)
            byte[k] = (unsigned char)(bits >> (8 * k));
        add_bytes(d, byte, sizeof byte);
    }
}

static json_t *json_of_motion(const drift_scene *scene)
{
    const imk_trajectory *t = scene->settings.motion;
    digest d = {0xcbf29ce484222325u, 0xcbf29ce484222325u};
    char text[40];
    if (!t)
        return json_null();
    add_numbers(&d, t->origin, 3);
    for (size_t i = 0; i < t->piece_count; i++) {
        const imk_trajectory_piece *p = &t->piece[i];
        add_numbers(&d, &p->start, 1);
        add_numbers(&d, &p->length, 1);
        add_numbers(&d, p->position[0], 3 * 7);
        add_numbers(&d, p->quaternion[0], 4 * 6);
    }
    for (size_t i = 0; i < t->line_count; i++) {
        const imk_vibration_line *l = &t->line[i];
        const double number[] = {l->axis, l->amplitude, l->frequency, l->phase};
        add_numbers(&d, number, 4);
    }
    snprintf(text, sizeof text, "%016llx%016llx", (unsigned long long)d.a, (unsigned long long)d.b);
    json_t *motion = json_pack("{s:I, s:I, s:s}", "pieces", (json_int_t)t->piece_count, "lines",
                               (json_int_t)t->line_count, "digest", text);
    const char *script = imk_motion_file_text(scene->motion);
    if (script) /* for whoever repeats it */
        json_object_set_new(motion, "script", json_string(script));
    return motion;
}

/* ---- model ---- */

static void forget(imk_evidence *evidence)
{
    memset(evidence, 0, sizeof *evidence);
}

/* NULL when it cannot be printed. */
static json_t *json_of_physics(const imk_model *model)
{
    char *text = NULL;
    size_t size;
    json_t *tree = NULL;
    imk_model *bare = command_memory(NULL, sizeof *bare);
    *bare = *model;
    bare->name[0] = bare->description[0] = bare->residual_of[0] = '\0';
    forget(&bare->gyro_evidence);
    forget(&bare->accel_evidence);
    bare->gyro.noise.density = bare->accel.noise.density = IMK_DENSITY_TWO_SIDED;
    if (command_unless_memory(imk_model_print_json(bare, NULL, &text, &size, NULL)) == IMK_OK)
        tree = json_loadb(text, size, 0, NULL);
    free(text);
    free(bare);
    return tree;
}

/* ---- settings ---- */

/* As text, for jansson writes 17 digits where fewer say the same. */
static json_t *number(double value)
{
    char text[IMK_DECIMAL_SIZE];
    text[imk_decimal_shortest(value, text)] = '\0';
    return json_string(text);
}

static json_t *json_of_settings(const imk_drift_settings *s)
{
    json_t *initial = json_array();
    for (int i = 0; i < IMK_DRIFT_STATES; i++)
        json_array_append_new(initial, number(s->initial_sigma[i]));
    json_t *settings = json_object();
    if (!s->motion) {
        json_object_set_new(settings, "latitude [rad]", number(s->latitude));
        json_object_set_new(settings, "height [m]", number(s->height));
        json_object_set_new(settings, "roll [rad]", number(s->roll));
        json_object_set_new(settings, "pitch [rad]", number(s->pitch));
        json_object_set_new(settings, "yaw [rad]", number(s->yaw));
    }
    json_object_set_new(settings, "rate [Hz]", number(s->rate));
    json_object_set_new(settings, "vertical",
                        json_string(s->vertical == IMK_VERTICAL_FREE ? "free" : "slaved"));
    json_object_set_new(settings, "aligned",
                        json_string(s->alignment == IMK_ALIGNED_SELF ? "self" : "given"));
    if (s->alignment == IMK_ALIGNED_SELF)
        json_object_set_new(settings, "alignment time [s]", number(s->alignment_time));
    json_object_set_new(settings, "compensated", json_boolean(s->compensated));
    json_object_set_new(settings, "initial sigma [m, m/s, rad]", initial);
    return settings;
}

char *drift_parameters(const drift_scene *scene, const imk_drift_settings *settings,
                       const imk_model *model)
{
    json_t *physics = json_of_physics(model);
    json_t *tree =
        physics ? json_pack("{s:s, s:o, s:o, s:o}", "campaign", "drift", "model", physics, "motion",
                            json_of_motion(scene), "settings", json_of_settings(settings))
                : NULL;
    char *text = tree ? json_dumps(tree, JSON_COMPACT | JSON_SORT_KEYS) : NULL;
    json_decref(tree);
    if (!text)
        command_failed("the parameters of the campaign are no valid JSON: a text is no UTF-8");
    return text;
}
