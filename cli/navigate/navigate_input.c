/* SPDX-License-Identifier: Apache-2.0 */
/* What imukit navigate is given: place, attitude and updates as texts, and the log. */
#include "navigate_parts.h"
#include "shell/place_text.h"

#include "imukit/samples.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double degree = 0.017453292519943295;

static int parse_attitude(navigation *n)
{
    const char *text = n->options->attitude;
    double sigma[3] = {0};
    size_t count = 0;
    imk_error error;
    if (imk_quantity_parse(text, text + strlen(text), imk_unit_of("deg").dimension, 3, n->euler,
                           sigma, &count, NULL, &error) != IMK_OK ||
        count != 3)
        return command_misused("--attitude \"%s\": expected roll, pitch and yaw with one unit, "
                               "such as \"0.5 -1.2 90 deg\", and their 1 sigma behind +- if known",
                               text);
    const double turn = 360.0 * degree, quarter = 90.0 * degree;
    if (!(fabs(n->euler[0]) <= turn && fabs(n->euler[1]) <= quarter && fabs(n->euler[2]) <= turn))
        return command_misused("--attitude \"%s\": the pitch is within 90 deg, roll and yaw within "
                               "360 deg",
                               text);
    memcpy(n->attitude_sigma, sigma, sizeof n->attitude_sigma);
    return -1;
}

static int parse_heading(navigation *n)
{
    const char *text = n->options->heading;
    size_t count = 0;
    imk_error error;
    if (imk_quantity_parse(text, text + strlen(text), imk_unit_of("deg").dimension, 1, &n->heading,
                           &n->heading_sigma, &count, NULL, &error) != IMK_OK ||
        !(fabs(n->heading) <= 360.0 * degree))
        return command_misused(
            "--heading \"%s\": expected an azimuth within 360 deg, such as 30deg, "
            "or \"30 +- 1 deg\" with its 1 sigma",
            text);
    return -1;
}

static int parse_updates(navigation *n)
{
    const char *text = n->options->zero_velocity;
    double sigma;
    size_t count;
    imk_error error;
    if (!text)
        return -1;
    if (strcmp(text, "auto") == 0) {
        n->updates = UPDATES_AUTO;
    } else {
        n->updates = UPDATES_EVERY;
        if (imk_quantity_parse(text, text + strlen(text), imk_unit_of("s").dimension, 1,
                               &n->update_every, &sigma, &count, NULL, &error) != IMK_OK ||
            !(n->update_every > 0))
            return command_misused("--zero-velocity %s: expected auto, or the time from stop to "
                                   "stop, such as 60s",
                                   text);
        if (!(n->stop > 0 && n->stop <= n->update_every))
            return command_misused("--stop must be positive and not longer than the time from stop "
                                   "to stop");
    }
    if (!n->options->model)
        return command_misused("--zero-velocity needs to know how good the sensors are: add "
                               "--model MODEL, one from imukit identify or a name from imukit "
                               "devices");
    if (n->updates == UPDATES_AUTO && n->options->attitude)
        return command_misused("--zero-velocity auto learns what rest looks like during --align, "
                               "which --attitude leaves out");
    return -1;
}

/* Options that mean nothing without another one, or beside it. */
static int check_company(const navigate_options *o)
{
    const bool automatic = o->zero_velocity && strcmp(o->zero_velocity, "auto") == 0;
    if (isnan(o->align) && !o->attitude)
        return command_misused(
            "the attitude at the start is missing: add --align 300s if the unit "
            "stands still that long first, or --attitude \"ROLL PITCH YAW deg\"");
    if (!isnan(o->align) && o->attitude)
        return command_misused("--align finds the attitude that --attitude gives: leave one out");
    if (o->heading && o->attitude)
        return command_misused("--heading is part of --attitude: leave it out");
    if (o->method >= 0 && o->attitude)
        return command_misused("--align-method is of --align, which --attitude leaves out");
    if (!isnan(o->stop) && (!o->zero_velocity || automatic))
        return command_misused("--stop is of --zero-velocity TIME, such as --zero-velocity 60s");
    if (!isnan(o->still_rotation) && !o->zero_velocity)
        return command_misused("--still-rotation is of --zero-velocity: add it");
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
        return command_misused("--standard-gravity is what g stands for in the log's units, "
                               "between 9.7 and 9.9 m/s^2");
    return -1;
}

int navigate_parse(navigation *n)
{
    const navigate_options *o = n->options;
    if (!o->position)
        return command_misused("the place of the start is missing: add --position \"LATITUDE deg, "
                               "LONGITUDE deg, HEIGHT m\"");
    n->stop = isnan(o->stop) ? 5.0 : o->stop;
    int code = check_company(o);
    if (code < 0)
        code = check_numbers(o);
    if (code < 0)
        code = place_parse(o->position, &n->place);
    if (code < 0 && o->attitude)
        code = parse_attitude(n);
    if (code < 0 && o->heading)
        code = parse_heading(n);
    if (code < 0)
        code = parse_updates(n);
    if (code < 0 && o->model) {
        code = command_model(o->model, n->model, NULL);
        n->has_model = code < 0;
    }
    return code;
}

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
static int scale_gravity(navigation *n)
{
    const double standard = 9.80665, factor = n->options->standard_gravity / standard;
    bool any = false;
    if (factor == 1.0)
        return -1;
    for (size_t k = 0; k < n->channels.count; k++) {
        const imk_log_column *column = log_channel_column(&n->channels, k);
        if (column->quantity != IMK_QUANTITY_SPECIFIC_FORCE || !has_gravity_unit(column->unit.text))
            continue;
        any = true;
        double *data = log_channel_data(&n->channels, k);
        for (size_t row = 0; row < n->rows; row++)
            data[row] *= factor;
    }
    if (!any)
        return command_misused("--standard-gravity: no accelerometer column of %s is in g, mg or "
                               "ug",
                               n->path);
    return -1;
}

/* The six channels there must be, and no others of their kinds. */
static int find_channels(navigation *n)
{
    static const char *const names[6] = {"gyro_x",  "gyro_y",  "gyro_z",
                                         "accel_x", "accel_y", "accel_z"};
    for (size_t k = 0; k < n->channels.count; k++) {
        const imk_log_column *column = log_channel_column(&n->channels, k);
        const bool gyro = column->quantity == IMK_QUANTITY_ANGULAR_RATE;
        if (imk_dimension_equal(column->unit.dimension, imk_unit_of("count").dimension))
            return command_failed("%s: %s is in counts: imukit compensate makes rates and forces "
                                  "of them",
                                  n->path, column->name);
        if (column->quantity == IMK_QUANTITY_OTHER || column->axis > 2)
            continue;
        n->reading[(gyro ? 0 : 3) + column->axis] = log_channel_data(&n->channels, k);
    }
    for (int k = 0; k < 6; k++)
        if (!n->reading[k])
            return command_failed("%s has no column %s: navigation needs three gyros and three "
                                  "accelerometers",
                                  n->path, names[k]);
    return -1;
}

/* What the columns of a loaded log are, and where navigation begins. */
static int prepare(navigation *n)
{
    n->rows = n->channels.rows;
    n->dt = n->channels.dt;
    const imk_log *log = &n->channels.log;
    const int time = imk_log_find(log, IMK_QUANTITY_TIME, -1);
    if (time >= 0 && n->channels.rows == log->rows && isfinite(log->data[time][0]))
        n->first_time = log->data[time][0];
    int code = find_channels(n);
    if (code < 0)
        code = scale_gravity(n);
    if (code >= 0)
        return code;
    if (n->options->align > 0) {
        n->first = imk_samples_in(n->options->align, n->dt);
        if (n->first == 0)
            return command_failed("%s: no sample falls into --align %.6gs: its rows are %.6g s "
                                  "apart; align for longer, or correct --rate or the times",
                                  n->path, n->options->align, n->dt);
        if (n->first + 1 > n->rows)
            return command_failed("%s is %.6g s long: nothing is left after --align %.6gs", n->path,
                                  n->dt * (double)n->rows, n->options->align);
    }
    return -1;
}

int navigate_load(navigation *n)
{
    int code = log_input_load(&n->options->log, n->path, &n->channels);
    if (code >= 0)
        return code;
    code = prepare(n);
    if (code >= 0)
        log_channels_free(&n->channels);
    return code;
}
