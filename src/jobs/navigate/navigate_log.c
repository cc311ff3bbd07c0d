/* SPDX-License-Identifier: Apache-2.0 */
/* Navigation by a record: what is asked, what its columns are, and the steps. */
#include "base/refuse_internal.h"
#include "imukit/samples.h"
#include "jobs/record/record_check_internal.h"
#include "navigate_log_internal.h"

#include <math.h>
#include <string.h>

static const uint32_t settings_cookie = 0x4e415631; /* "NAV1" */
static const double standard_gravity = 9.80665;

imk_navigate_log_settings imk_navigate_log_default(void)
{
    return (imk_navigate_log_settings){.cookie = settings_cookie,
                                       .align = 300,
                                       .method = IMK_ALIGNMENT_INERTIAL,
                                       .still_velocity = 0.01,
                                       .hold_height = true,
                                       .samples = 3,
                                       .interval = 1,
                                       .standard_gravity = standard_gravity,
                                       .aid_until = (double)INFINITY};
}

void imk_navigate_log_free(imk_navigate_log *result)
{
    if (!result)
        return;
    const imk_allocator allocator = result->record.log.allocator;
    imki_resize(&allocator, result->track[0], 0);
    imki_resize(&allocator, result->filtered[0], 0);
    for (size_t k = 0; k < IMK_AID_KIND_COUNT; k++)
        imki_resize(&allocator, result->aid[k].time, 0);
    imk_even_record_free(&result->record);
    imki_resize(&allocator, result, 0);
}

/* Sigmas of each kind, without times. */
static imk_status check_aids(const imk_navigate_log_settings *s, imk_error *error)
{
    for (size_t k = 0; k < s->aid_count; k++) {
        const imk_aid *aid = &s->aid[k];
        const imk_status status = imk_aid_validate(aid, error);
        if (status != IMK_OK)
            return status;
        if (aid->interval != 1.0 || aid->from != 1.0 || aid->until < HUGE_VAL)
            return imk_error_set(error, IMK_ERROR_CONFLICT, "aid",
                                 "the times of readings are those of the table",
                                 "leave out `at`, `every`, `from` and `until`");
        for (size_t j = 0; j < k; j++)
            if (s->aid[j].kind == aid->kind)
                return imk_error_set(error, IMK_ERROR_KEY_DUPLICATE, "aid",
                                     imk_aid_kind_name(aid->kind), NULL);
    }
    return IMK_OK;
}

static imk_status check_settings(const imk_navigate_log_settings *s, imk_error *error)
{
    const bool timetable = s->stops == IMK_STOPS_TIMETABLE, stops = s->stops != IMK_STOPS_NONE;
    const double g = s->standard_gravity, quarter = 1.5707963267948968; /* rounded upwards */
    const struct {
        const char *field;
        bool wrong;
        double value, limit;
        const char *expected;
    } rules[] = {
        {"place.latitude", !(fabs(s->place.latitude) <= quarter), s->place.latitude, quarter,
         "at most 90 deg"},
        {"place.longitude", !(fabs(s->place.longitude) <= 4 * quarter), s->place.longitude,
         4 * quarter, "at most 360 deg"},
        {"place.height", !(s->place.height >= -1e4 && s->place.height <= 1e5), s->place.height, 1e5,
         "-10 to 100 km"},
        {"attitude", !(fabs(s->attitude[0]) + fabs(s->attitude[2]) <= 8 * quarter), s->attitude[0],
         4 * quarter, "roll and yaw within 360 deg"},
        {"attitude", !(fabs(s->attitude[1]) <= quarter), s->attitude[1], quarter,
         "a pitch within 90 deg"},
        {"align", !(s->align >= 1 || s->align == 0), s->align, 1, "at least 1 s, or 0"},
        {"model", stops && !s->model, 0, 0, "a model: stops need one"},
        {"stops", s->stops == IMK_STOPS_FOUND && s->align == 0, 0, 0, "an alignment before stops"},
        {"stop_length", timetable && !(s->stop_length > 0 && s->stop_length <= s->stop_period),
         s->stop_length, s->stop_period, "more than 0 s, at most the period"},
        {"aids", s->aids && !s->model, 0, 0, "a model: aids need one"},
        {"smooth", s->smooth && !s->model, 0, 0, "a model: smoothing needs one"},
        {"smooth", s->smooth && s->still_rotation > 0, 0, 0,
         "no still_rotation, whose noise is not a state"},
        {"aid_count", s->aid_count > IMK_AIDS_MAX, (double)s->aid_count, IMK_AIDS_MAX,
         "at most 8 kinds"},
        {"aid_delay", !(fabs(s->aid_delay) <= 1e18), s->aid_delay, 0, "a time"},
        {"aid_interval", !(s->aid_interval >= 0), s->aid_interval, 0, "at least 0 s"},
        {"aid_until", !(s->aid_until >= 0), s->aid_until, 0, "at least 0 s"},
        {"still_velocity", !(s->still_velocity > 0), s->still_velocity, 0, "more than 0 m/s"},
        {"still_rotation", !(s->still_rotation >= 0), s->still_rotation, 0, "at least 0 rad/s"},
        {"velocity", s->velocity_given && s->align > 0, s->align, 0,
         "0: a unit that aligns itself is at rest"},
        {"velocity", !(fabs(s->velocity[0]) + fabs(s->velocity[1]) + fabs(s->velocity[2]) <= 1e5),
         s->velocity[0], 1e5, "at most 1e5 m/s"},
        {"velocity", s->hold_height && s->velocity[2] != 0, s->velocity[2], 0,
         "0 downwards while the height is held"},
        {"interval", !(s->interval > 0), s->interval, 0, "more than 0 s"},
        {"standard_gravity", !(g > 9.7 && g < 9.9), g, g < 9.8 ? 9.7 : 9.9,
         "between 9.7 and 9.9 m/s^2"}};
    for (size_t k = 0; k < sizeof rules / sizeof *rules; k++)
        if (rules[k].wrong)
            return imki_refuse(error, IMK_ERROR_RANGE, rules[k].field, rules[k].value,
                               rules[k].limit, rules[k].expected);
    const imk_status status = check_aids(s, error);
    if (status != IMK_OK)
        return status;
    for (int i = 0; i < 3; i++)
        if (!(s->position_sigma[i] >= 0 && s->velocity_sigma[i] >= 0))
            return imki_refuse(error, IMK_ERROR_RANGE,
                               s->position_sigma[i] >= 0 ? "velocity_sigma" : "position_sigma",
                               s->position_sigma[i], 0, "at least 0");
    return s->model ? imki_check_model(s->model, error) : IMK_OK;
}

/* ---- columns --------------------------------------------------------------------------------- */

/* Is one of the units in a product g, or a multiple of it (mg, ug)? */
static bool has_gravity_unit(const char *text)
{
    while (*text) {
        const char *start = text;
        while ((*text >= 'a' && *text <= 'z') || (*text >= 'A' && *text <= 'Z') ||
               (unsigned char)*text >= 0x80)
            text++;
        const size_t length = (size_t)(text - start);
        if (length > 0 && length < 8 && text[-1] == 'g' &&
            (length == 1 || *start == 'm' || *start == 'u' || (unsigned char)*start >= 0x80))
            return true;
        text += text == start;
    }
    return false;
}

/* g of the log's maker instead of 9.80665 m/s^2. */
static imk_status scale_gravity(imk_navigate_log *n, imk_error *error)
{
    const double factor = n->settings.standard_gravity / standard_gravity;
    bool any = false;
    if (factor == 1.0)
        return IMK_OK;
    for (size_t k = 0; k < n->record.count; k++) {
        const imk_log_column *column = imk_even_record_column(&n->record, k);
        if (column->quantity != IMK_QUANTITY_SPECIFIC_FORCE || !has_gravity_unit(column->unit.text))
            continue;
        any = true;
        double *data = imk_even_record_data(&n->record, k);
        for (size_t row = 0; row < n->record.rows; row++)
            data[row] *= factor;
    }
    return any ? IMK_OK
               : imki_fail(&n->findings, error, IMK_ERROR_UNIT_UNKNOWN, "no_gravity_unit", NULL, 0,
                           NULL);
}

/* The six channels there must be, and no others of their kinds. */
static imk_status find_channels(imk_navigate_log *n, imk_error *error)
{
    static const char *const sensors[2] = {"gyro", "accel"};
    for (size_t k = 0; k < n->record.count; k++) {
        const imk_log_column *column = imk_even_record_column(&n->record, k);
        const bool gyro = column->quantity == IMK_QUANTITY_ANGULAR_RATE;
        if (imk_dimension_equal(column->unit.dimension, imk_unit_of("count").dimension))
            return imki_fail(&n->findings, error, IMK_ERROR_COLUMN, "column_of_counts",
                             column->name, 0, NULL);
        if (column->quantity == IMK_QUANTITY_OTHER || column->axis > 2)
            continue;
        n->reading[(gyro ? 0 : 3) + column->axis] = imk_even_record_data(&n->record, k);
    }
    for (int k = 0; k < 6; k++) {
        char name[48];
        imk_axis_name(sensors[k / 3], k % 3, name);
        if (!n->reading[k])
            return imki_fail(&n->findings, error, IMK_ERROR_COLUMN, "no_sensor_column", name, 0,
                             NULL);
    }
    return IMK_OK;
}

imk_status imki_navigate_channels(imk_navigate_log *n, imk_error *error)
{
    const double align = n->settings.align, dt = n->record.dt;
    n->first_time = n->record.first_time;
    imk_status status = find_channels(n, error);
    if (status == IMK_OK)
        status = scale_gravity(n, error);
    if (status != IMK_OK || !(align > 0))
        return status;
    n->first = imk_samples_in(align, dt);
    if (n->first == 0)
        return imki_fail(&n->findings, error, IMK_ERROR_TOO_SHORT, "align_empty", NULL,
                         IMKI_NUMBERS(align, dt));
    if (n->first + 1 > n->record.rows)
        return imki_fail(&n->findings, error, IMK_ERROR_TOO_SHORT, "align_whole", NULL,
                         IMKI_NUMBERS(dt * (double)n->record.rows, align));
    return IMK_OK;
}

/* ---- all ------------------------------------------------------------------------------------- */

static bool is_known(const imk_axes *axes, int count)
{
    for (int i = 0; i < count; i++)
        if (axes->value[i] != 0.0)
            return true;
    return false;
}

/* What a model knows is taken out before. */
static void warn_of_model(imk_navigate_log *n)
{
    const imk_model *model = n->settings.model;
    if (!model || model->residual_of[0])
        return;
    const imk_triad *triad[2] = {&model->gyro, &model->accel};
    for (int sensor = 0; sensor < 2; sensor++)
        if (is_known(&triad[sensor]->bias.fixed, triad[sensor]->axis_count) ||
            is_known(&triad[sensor]->scale_factor.fixed, triad[sensor]->axis_count)) {
            imki_find(&n->findings, IMK_FINDING_WARNING, "compensate_first", n->settings.model_name,
                      IMKI_NUMBERS(sensor));
            return;
        }
}

static imk_status navigate(imk_navigate_log *n, const imk_job *job, imk_error *error)
{
    imki_arena scratch = {.allocator = job->allocator};
    imk_status status = imki_navigate_channels(n, error);
    if (status == IMK_OK)
        status = imki_navigate_check(n, error);
    if (status == IMK_OK)
        status = imki_navigate_align(n, &scratch, error);
    if (status == IMK_OK) {
        warn_of_model(n);
        status = imki_navigate_follow(n, job, &scratch, error);
    }
    imki_arena_free(&scratch);
    return status;
}

imk_status imk_navigate_log_run(const imk_record_source *source,
                                const imk_navigate_log_settings *settings, const imk_job *job,
                                imk_navigate_log **result, imk_error *error)
{
    imk_status status =
        imki_check_call(result, settings, settings_cookie, "imk_navigate_log_default()", error);
    if (!result)
        return status;
    *result = NULL;
    job = imki_job_of(job);
    if (status == IMK_OK)
        status = check_settings(settings, error);
    imk_navigate_log *made = imki_result_new(job, sizeof *made, &status, error);
    if (!made)
        return status;
    made->settings = *settings;
    *result = made;
    status =
        imk_even_record_load(source, settings->gaps, job, &made->record, &made->findings, error);
    made->record.log.allocator = job->allocator;
    if (status == IMK_OK)
        status = navigate(made, job, error);
    made->settings.aids = NULL; /* the caller's, for the call */
    return status;
}
