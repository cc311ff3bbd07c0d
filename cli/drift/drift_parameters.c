/* SPDX-License-Identifier: Apache-2.0 */
/* All inputs that the numbers of a campaign depend on, as JSON: equal physics gives equal text.
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

static void put_motion(const drift_scene *scene, imk_result *result)
{
    const imk_trajectory *t = scene->settings.motion;
    digest d = {0xcbf29ce484222325u, 0xcbf29ce484222325u};
    char text[40];
    if (!t) {
        imk_result_null(result, "motion");
        return;
    }
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
    imk_result_object(result, "motion");
    imk_result_count(result, "pieces", (long long)t->piece_count);
    imk_result_count(result, "lines", (long long)t->line_count);
    imk_result_text(result, "digest", text);
    const char *script = imk_motion_file_text(scene->motion);
    if (script) /* for whoever repeats it */
        imk_result_text(result, "script", script);
    imk_result_end(result);
}

/* ---- model ---- */

static void forget(imk_evidence *evidence)
{
    memset(evidence, 0, sizeof *evidence);
}

static void put_physics(const imk_model *model, imk_result *result)
{
    char *text = NULL;
    size_t size;
    imk_model *bare = command_memory(NULL, sizeof *bare);
    *bare = *model;
    bare->name[0] = bare->description[0] = bare->residual_of[0] = '\0';
    forget(&bare->gyro_evidence);
    forget(&bare->accel_evidence);
    bare->gyro.stated_zero = bare->accel.stated_zero = bare->mag.stated_zero = 0;
    bare->gyro.noise.density = bare->accel.noise.density = IMK_DENSITY_TWO_SIDED;
    if (command_unless_memory(imk_model_print_json(bare, NULL, &text, &size, NULL)) == IMK_OK)
        (void)imk_result_json(result, "model", text);
    free(text);
    free(bare);
}

/* ---- settings ---- */

/* As text: the shortest that says it. */
static void put_number(const char *key, double value, imk_result *result)
{
    char text[IMK_DECIMAL_SIZE];
    text[imk_decimal_shortest(value, text)] = '\0';
    imk_result_text(result, key, text);
}

static void put_settings(const imk_drift_settings *s, imk_result *result)
{
    imk_result_object(result, "settings");
    if (!s->motion) {
        put_number("latitude [rad]", s->latitude, result);
        put_number("height [m]", s->height, result);
        put_number("roll [rad]", s->roll, result);
        put_number("pitch [rad]", s->pitch, result);
        put_number("yaw [rad]", s->yaw, result);
    }
    put_number("rate [Hz]", s->rate, result);
    imk_result_text(result, "vertical", s->vertical == IMK_VERTICAL_FREE ? "free" : "slaved");
    imk_result_text(result, "aligned", s->alignment == IMK_ALIGNED_SELF ? "self" : "given");
    if (s->alignment == IMK_ALIGNED_SELF)
        put_number("alignment time [s]", s->alignment_time, result);
    imk_result_text(result, "attitude errors",
                    s->attitude_errors == IMK_ATTITUDE_EARTH ? "earth" : "local");
    if (s->gravity_deflection > 0) {
        put_number("gravity deflection [m/s^2]", s->gravity_deflection, result);
        put_number("gravity distance [m]", s->gravity_distance, result);
    }
    imk_result_flag(result, "compensated", s->compensated);
    imk_result_array(result, "initial sigma [m, m/s, rad]");
    for (int i = 0; i < IMK_DRIFT_STATES; i++)
        put_number(NULL, s->initial_sigma[i], result);
    imk_result_end(result);
    imk_result_end(result);
}

static void put_numbers(const char *key, const double *value, imk_result *result)
{
    imk_result_array(result, key);
    for (int i = 0; i < 3; i++)
        put_number(NULL, value[i], result);
    imk_result_end(result);
}

static void put_aid(const imk_aid *aid, imk_result *result)
{
    imk_result_object(result, NULL);
    imk_result_text(result, "kind", imk_aid_kind_name(aid->kind));
    put_numbers("white sigma", aid->sigma, result);
    put_numbers("correlated sigma", aid->correlated_sigma, result);
    put_number("correlation time [s]", aid->correlation_time, result);
    put_number("interval [s]", aid->interval, result);
    put_number("from [s]", aid->from, result);
    put_number("until [s]", aid->until, result);
    put_numbers("lever arm [m]", aid->lever_arm, result);
    put_numbers("lever arm sigma [m]", aid->lever_arm_sigma, result);
    imk_result_end(result);
}

/* Nothing without aids, so that such a campaign is what it was. */
static void put_aids(const imk_drift_settings *s, imk_result *result)
{
    if (s->aid_count == 0)
        return;
    imk_result_array(result, "aids");
    for (size_t k = 0; k < s->aid_count; k++)
        put_aid(&s->aid[k], result);
    imk_result_end(result);
    if (s->filter_model) {
        imk_result_object(result, "filter");
        put_physics(s->filter_model, result);
        imk_result_end(result);
    }
}

char *drift_parameters(const drift_scene *scene, const imk_drift_settings *settings,
                       const imk_model *model)
{
    char *text = NULL;
    size_t size;
    imk_result *result = imk_result_create(NULL);
    imk_result_text(result, "campaign", "drift");
    put_physics(model, result);
    put_motion(scene, result);
    put_settings(settings, result);
    put_aids(settings, result);
    (void)command_unless_memory(imk_result_to_key(result, &text, &size));
    imk_result_free(result);
    return text;
}
