/* SPDX-License-Identifier: Apache-2.0 */
/* An instrument that runs on and on in a page, step by step, by the same simulation as
 * `imukit physics`. One module instance runs one instrument. Texts that are given back stay until
 * the next call of the same function; "" means that all went well. */
#include "live.h"

#include "imukit/io.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define EXPORT(name) __attribute__((export_name(#name))) name

/* Rows for each second on the screen: four a frame, so that motion is smooth. */
static const double rows_per_second = 240;
/* A settling time of more rows than this is cut. */
static const double settling_rows = 2e6;
/* A run that needs more internal steps for a second on the screen is refused. */
static const double steps_per_second = 2e7;

live_instrument live = {.physics.rate = 0};

/* ---- texts ----------------------------------------------------------------------------------- */

/* What went wrong, in one sentence. */
static const char *told(imk_status status, imk_error *error)
{
    static char text[1200];
    text[0] = '\0';
    if (status != IMK_OK) {
        if (live.file.instrument)
            imk_design_error_in_units(live.file.instrument, live.file.design, error);
        (void)imk_error_text(error, NULL, text, sizeof text);
    }
    return text;
}

/* ---- the run --------------------------------------------------------------------------------- */

/* The smallest of 1, 2 and 5 times a power of ten that is not below a number > 0. */
static double round_up(double value)
{
    const double power = pow(10, floor(log10(value)));
    const double digits[] = {1, 2, 5, 10};
    for (int i = 0; i < 4; i++)
        if (digits[i] * power >= value * (1 - 1e-9))
            return digits[i] * power;
    return value;
}

static void step(void)
{
    const imk_instrument *instrument = live.file.instrument;
    const bool gyro = instrument->sensor == IMK_GYRO;
    instrument->step(live.state, &live.exposure, live.outputs);
    live.row++;
    live.turned +=
        (gyro ? live.exposure.angular_rate : live.exposure.specific_force)[0] / live.physics.rate;
}

/* The units of a log (physics_log.h). */
const char *live_unit(const imk_instrument *instrument, size_t column)
{
    if (column == 0)
        return instrument->sensor == IMK_GYRO ? "deg/s" : "m/s^2";
    return column < instrument->output_count
               ? instrument->outputs[column].unit
               : instrument->signals[column - instrument->output_count].unit;
}

static void set_units(const imk_instrument *instrument)
{
    for (size_t i = 0; i < instrument->output_count + instrument->signal_count; i++) {
        const imk_unit unit = imk_unit_of(live_unit(instrument, i));
        imki_column_format_set(&live.column[i], unit.scale, unit.offset, -1);
    }
}

/* Start an instrument, or refuse it: also one that would need so many steps for a second on the
 * screen that the page would wait. */
static imk_status start(const imk_design_file *file, imk_physics_settings *settings,
                        const imk_exposure *e, void *state, imk_error *error)
{
    const double *rate = e->angular_rate;
    settings->duration = live.pace;
    settings->turning = fabs(rate[0]) + fabs(rate[1]) + fabs(rate[2]);
    settings->steps_max = steps_per_second;
    imk_status status = imk_instrument_init(file->instrument, file->design, settings, state, error);
    if (status == IMK_ERROR_RANGE && strcmp(error->field, "rate") == 0 &&
        error->limit < settings->rate) {
        settings->rate = error->limit; /* as many as it can */
        status = imk_instrument_init(file->instrument, file->design, settings, state, error);
    }
    if (status != IMK_OK)
        imk_design_error_in_units(file->instrument, file->design, error);
    return status;
}

static void *room_for_state(const imk_instrument *instrument)
{
    return aligned_alloc(64, (instrument->state_size + 63) / 64 * 64);
}

/* A new run, from power-on. What ran before goes on when it is refused. */
static imk_status begin(const imk_design_file *file, double pace, imk_error *error)
{
    imk_physics_settings settings = live.physics;
    const double before = live.pace;
    void *state = room_for_state(file->instrument);
    if (!state)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    settings.rate = round_up(rows_per_second / pace);
    live.pace = pace;
    const imk_status status = start(file, &settings, &live.exposure, state, error);
    if (status != IMK_OK) {
        live.pace = before;
        free(state);
        return status;
    }
    free(live.state);
    live.state = state;
    live.physics = settings;
    live.asked_rate = round_up(rows_per_second / pace);
    live.row = 0;
    live.turned = 0;
    return IMK_OK;
}

/* What a view shows of an instrument, it shows after this time [s]. */
static void settle(void)
{
    const double rows = fmin(live_settling() * live.physics.rate, settling_rows);
    while ((double)live.row < rows)
        step();
}

const char *EXPORT(live_open)(const char *name)
{
    imk_error error = {.status = IMK_OK};
    imk_design_file file = {.design = NULL};
    imk_status status = imk_design_open(name, &file, &error);
    if (status != IMK_OK)
        return told(status, &error);
    live.exposure = imk_exposure_default();
    live.physics = imk_physics_default();
    live.physics.seed = 1; /* as `imukit physics` */
    live.screen = 0;
    live_first_input(file.instrument, &live.exposure);
    status = begin(&file, live_first_pace(file.instrument, file.design), &error);
    if (status != IMK_OK) {
        imk_design_file_free(&file);
        return told(status, &error);
    }
    imk_design_file_free(&live.file);
    live.file = file;
    set_units(file.instrument);
    settle();
    return "";
}

/** Take another design: a design file of the same instrument. A new run begins. */
const char *EXPORT(live_change)(const char *text)
{
    imk_error error = {.status = IMK_OK};
    imk_design_file file = {.design = NULL};
    imk_status status =
        imk_design_parse_as(live.file.instrument, text, strlen(text), &file, &error);
    if (status == IMK_OK)
        status = begin(&file, live.pace, &error);
    if (status != IMK_OK) {
        imk_design_file_free(&file);
        return told(status, &error);
    }
    imk_design_file_free(&live.file);
    live.file = file;
    settle();
    return "";
}

/** Simulated seconds for each second on the screen, and whether there is noise. A new run begins
 *  when the samples get another rate or noise. */
const char *EXPORT(live_pace)(double pace, int noise)
{
    imk_error error = {.status = IMK_OK};
    if (!(pace > 0 && pace <= 1e6))
        return "the time scale must be above 0";
    const bool same = round_up(rows_per_second / pace) == live.asked_rate;
    if (same && live.physics.noise == (noise != 0)) {
        live.pace = pace;
        return "";
    }
    const bool before = live.physics.noise;
    live.physics.noise = noise != 0;
    const imk_status status = begin(&live.file, pace, &error);
    if (status == IMK_OK)
        settle();
    else
        live.physics.noise = before;
    return told(status, &error);
}

/** Begin again, from power-on and without settling: the rows are those of `imukit physics`. */
const char *EXPORT(live_restart)(void)
{
    imk_error error = {.status = IMK_OK};
    return told(begin(&live.file, live.pace, &error), &error);
}

/* One number is along x, three are x y z; as the options of `imukit physics`. */
static imk_status read_vector(const char *text, const char *unit, double *values, imk_error *error)
{
    double read[3] = {0}, sigmas[3];
    size_t count = 0;
    const imk_status status =
        imk_quantity_parse(text, text + strlen(text), imk_unit_of(unit).dimension, 3, read, sigmas,
                           &count, NULL, error);
    if (status == IMK_OK && count == 2)
        return imk_error_set(error, IMK_ERROR_SYNTAX, "", "two numbers", "one about x, or three");
    if (status == IMK_OK)
        memcpy(values, read, sizeof read);
    return status;
}

/* Some instruments need more steps the quicker they turn. */
static imk_status try_exposure(const imk_exposure *exposure, imk_error *error)
{
    imk_physics_settings settings = live.physics;
    void *state = room_for_state(live.file.instrument);
    const imk_status status = state ? start(&live.file, &settings, exposure, state, error)
                                    : imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    free(state);
    return status;
}

/** Motion and temperature from now on.
 *  @param what  "rate", "acceleration" or "temperature"
 *  @param text  "10 deg/s", "0 0 1 g", "40 degC" */
const char *EXPORT(live_expose)(const char *what, const char *text)
{
    imk_error error = {.status = IMK_OK};
    imk_physics_log_settings settings = imk_physics_log_default();
    imk_exposure *e = &settings.input.exposure;
    double temperature[3];
    imk_status status;
    *e = live.exposure;
    settings.physics = live.physics;
    if (strcmp(what, "rate") == 0) {
        status = read_vector(text, "rad/s", e->angular_rate, &error);
    } else if (strcmp(what, "acceleration") == 0) {
        status = read_vector(text, "m/s^2", e->specific_force, &error);
    } else {
        status = read_vector(text, "K", temperature, &error);
        if (status == IMK_OK)
            e->temperature = temperature[0];
    }
    if (status == IMK_OK)
        status = imk_physics_input_check(&settings, &error);
    if (status == IMK_OK)
        status = try_exposure(e, &error);
    if (status == IMK_OK)
        live.exposure = *e;
    return told(status, &error);
}

/* The outputs and signals of this moment as a log holds them. */
static double *put_row(double *at)
{
    const imk_instrument *instrument = live.file.instrument;
    const size_t count = instrument->output_count + instrument->signal_count;
    memcpy(at, live.outputs, instrument->output_count * sizeof *at);
    instrument->observe(live.state, at + instrument->output_count);
    for (size_t i = 0; i < count; i++)
        at[i] = imki_log_in_unit(&live.column[i], at[i]);
    return at + count;
}

/** Samples for a time on the screen [s]; what is left of a row waits for the next time.
 *  @return how many, LIVE_ROWS at most; of each the time [s] and all outputs and signals, in the
 *          units of live_unit(), are at live_rows() */
int EXPORT(live_step)(double seconds)
{
    const double due = live.owed + seconds * live.pace * live.physics.rate;
    const int rows = due < LIVE_ROWS ? (int)due : LIVE_ROWS;
    live.owed = due < LIVE_ROWS ? due - rows : 0;
    live.screen += seconds;
    double *at = live.rows;
    for (int i = 0; i < rows; i++) {
        step();
        *at++ = (double)live.row / live.physics.rate;
        at = put_row(at);
    }
    return rows;
}

double *EXPORT(live_rows)(void)
{
    return live.rows;
}
