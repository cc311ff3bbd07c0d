/* SPDX-License-Identifier: Apache-2.0 */
/* The options of imukit navigate: place, attitude and stops as texts, and numbers. */
#include "navigate_parts.h"
#include "shell/place_text.h"

#include <math.h>
#include <string.h>

static const double degree = 0.017453292519943295;

static int parse_attitude(const char *text, imk_navigate_log_settings *s)
{
    const double turn = 360.0 * degree, quarter = 90.0 * degree;
    size_t count = 0;
    imk_error error;
    if (imk_quantity_parse(text, text + strlen(text), imk_unit_of("deg").dimension, 3, s->attitude,
                           s->attitude_sigma, &count, NULL, &error) != IMK_OK ||
        count != 3)
        return command_misused("--attitude \"%s\": expected roll, pitch and yaw with one unit, "
                               "such as \"0.5 -1.2 90 deg\", and their 1 sigma after +- if known",
                               text);
    if (!(fabs(s->attitude[0]) <= turn && fabs(s->attitude[1]) <= quarter &&
          fabs(s->attitude[2]) <= turn))
        return command_misused(
            "--attitude \"%s\": the pitch must be within 90 deg, roll and yaw within 360 deg",
            text);
    return -1;
}

/* Unless it is said, where nothing else measures it. */
static bool holds_height(const navigate_options *o)
{
    return o->vertical < 0 ? !o->aid : o->vertical == 0;
}

static int parse_velocity(const navigate_options *o, imk_navigate_log_settings *s)
{
    const char *text = o->velocity;
    size_t count = 0;
    imk_error error;
    if (!text)
        return -1;
    if (imk_quantity_parse(text, text + strlen(text), imk_unit_of("m/s").dimension, 3, s->velocity,
                           s->velocity_sigma, &count, NULL, &error) != IMK_OK ||
        count != 3)
        return command_misused("--velocity \"%s\": expected three numbers and a unit, north, east "
                               "and down, such as \"20 -3 0 m/s\", and their 1 sigma after +- if "
                               "known",
                               text);
    for (int i = 0; i < 3; i++)
        if (!(fabs(s->velocity[i]) <= 3e4))
            return command_misused("--velocity \"%s\": expected at most 30 km/s", text);
    if (holds_height(o) && s->velocity[2] != 0)
        return command_misused("--velocity \"%s\" goes up or down, but the height is held: add "
                               "--vertical free",
                               text);
    s->velocity_given = true;
    return -1;
}

static int parse_position_sigma(const char *text, imk_navigate_log_settings *s)
{
    double value[3], spread[3];
    size_t count = 0;
    imk_error error;
    if (!text)
        return -1;
    bool good = imk_quantity_parse(text, text + strlen(text), imk_unit_of("m").dimension, 3, value,
                                   spread, &count, NULL, &error) == IMK_OK &&
                (count == 1 || count == 3);
    for (size_t i = 0; good && i < 3; i++) {
        s->position_sigma[i] = value[count == 1 ? 0 : i];
        good = s->position_sigma[i] >= 0 && s->position_sigma[i] <= 1e7 && spread[0] == 0;
    }
    return good ? -1
                : command_misused("--position-sigma \"%s\": expected one or three numbers (north, "
                                  "east, down) from 0 to 10000 km with a unit, such as 5m",
                                  text);
}

static int parse_heading(const char *text, imk_navigate_log_settings *s)
{
    size_t count = 0;
    imk_error error;
    if (imk_quantity_parse(text, text + strlen(text), imk_unit_of("deg").dimension, 1,
                           &s->attitude[2], &s->attitude_sigma[2], &count, NULL,
                           &error) != IMK_OK ||
        !(fabs(s->attitude[2]) <= 360.0 * degree))
        return command_misused(
            "--heading \"%s\": expected an azimuth within 360 deg, such as 30deg, "
            "or \"30 +- 1 deg\" with its 1 sigma",
            text);
    s->heading_given = true;
    return -1;
}

static int parse_stops(const navigate_options *o, imk_navigate_log_settings *s)
{
    const char *text = o->zero_velocity;
    double sigma;
    size_t count;
    imk_error error;
    if (!text)
        return -1;
    if (strcmp(text, "auto") == 0) {
        s->stops = IMK_STOPS_FOUND;
    } else {
        s->stops = IMK_STOPS_TIMETABLE;
        s->stop_length = isnan(o->stop) ? 5.0 : o->stop;
        if (imk_quantity_parse(text, text + strlen(text), imk_unit_of("s").dimension, 1,
                               &s->stop_period, &sigma, &count, NULL, &error) != IMK_OK ||
            !(s->stop_period > 0))
            return command_misused("--zero-velocity %s: expected auto, or the time from stop to "
                                   "stop, such as 60s",
                                   text);
        if (!(s->stop_length > 0 && s->stop_length <= s->stop_period))
            return command_misused("--stop must be positive and not longer than the time from stop "
                                   "to stop");
    }
    if (!o->model)
        return command_misused("--zero-velocity needs the errors of the sensors; add --model "
                               "MODEL, one from imukit identify or a name from imukit devices");
    if (s->stops == IMK_STOPS_FOUND && o->attitude)
        return command_misused("--zero-velocity auto learns the readings at rest during --align, "
                               "and --attitude excludes --align");
    return -1;
}

/* Options that need another option, or exclude it. */
static int check_company(const navigate_options *o)
{
    const bool automatic = o->zero_velocity && strcmp(o->zero_velocity, "auto") == 0;
    if (isnan(o->align) && !o->attitude)
        return command_misused(
            "the attitude at the start is missing: add --align 300s if the unit is at rest for "
            "that time at the start, or --attitude \"ROLL PITCH YAW deg\"");
    if (!isnan(o->align) && o->attitude)
        return command_misused("--align finds the attitude that --attitude gives: leave one out");
    if (o->velocity && !o->attitude)
        return command_misused(
            "--velocity is for a start with --attitude: a unit that aligns itself "
            "is at rest");
    if (o->heading && o->attitude)
        return command_misused("--heading is part of --attitude: leave it out");
    if (o->method >= 0 && o->attitude)
        return command_misused("--align-method is for --align, and --attitude excludes --align");
    if (!isnan(o->stop) && (!o->zero_velocity || automatic))
        return command_misused("--stop is for --zero-velocity TIME, such as --zero-velocity 60s");
    if (!isnan(o->still_rotation) && !o->zero_velocity)
        return command_misused("--still-rotation is for --zero-velocity; add that option");
    return -1;
}

static int check_numbers(const navigate_options *o)
{
    if (!isnan(o->align) && !(o->align >= 1))
        return command_misused("--align must be 1 s or more");
    if (!(o->interval > 0))
        return command_misused("--interval must be positive");
    if (!(o->still_velocity > 0))
        return command_misused("--still-velocity must be positive");
    if (o->still_rotation < 0)
        return command_misused("--still-rotation must not be negative");
    if (!(o->standard_gravity > 9.7 && o->standard_gravity < 9.9))
        return command_misused("--standard-gravity must be between 9.7 and 9.9 m/s^2; it is the "
                               "value of g in the log's units");
    return -1;
}

static void take_numbers(const navigate_options *o, imk_navigate_log_settings *s)
{
    s->gaps = (imk_gap_policy)o->log.gaps;
    s->align = isnan(o->align) ? 0.0 : o->align;
    s->method_given = o->method >= 0;
    s->method = o->method >= 0 ? (imk_alignment_method)o->method : s->method;
    s->still_velocity = o->still_velocity;
    s->still_rotation = isnan(o->still_rotation) ? 0.0 : o->still_rotation;
    s->hold_height = holds_height(o);
    s->samples = (int)o->samples.value;
    s->interval = o->interval;
    s->standard_gravity = o->standard_gravity;
    s->gravity_free = o->gravity_free;
    s->smooth = o->smooth;
}

int navigate_parse(const navigate_options *o, imk_model *model, imk_navigate_log_settings *s)
{
    if (!o->position)
        return command_misused("the position at the start is missing: add --position \"LATITUDE "
                               "deg, LONGITUDE deg, HEIGHT m\"");
    int code = check_company(o);
    if (code < 0)
        code = check_numbers(o);
    if (code < 0)
        code = place_parse(o->position, &s->place);
    if (code < 0 && o->attitude)
        code = parse_attitude(o->attitude, s);
    if (code < 0)
        code = parse_velocity(o, s);
    if (code < 0)
        code = parse_position_sigma(o->position_sigma, s);
    if (code < 0 && o->heading)
        code = parse_heading(o->heading, s);
    if (code < 0)
        code = parse_stops(o, s);
    if (code < 0)
        code = navigate_parse_aids(o, s);
    if (code < 0 && o->model) {
        code = command_model(o->model, model, NULL);
        s->model = model;
        s->model_name = o->model;
    }
    take_numbers(o, s);
    return code;
}
