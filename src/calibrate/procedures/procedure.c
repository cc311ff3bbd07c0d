/* SPDX-License-Identifier: Apache-2.0 */
/* The procedures by number: names, defaults, what each does with a record; checks before, and
 * putting the calibration back when one fails. */
#include "procedure_internal.h"

#include "base/refuse_internal.h"
#include "base/workspace_internal.h"
#include "calibrate/estimator/calibration_internal.h"

#include <math.h>
#include <string.h>

#define DEGREE 0.017453292519943295

typedef struct procedure_entry {
    const char *name;
    imk_status (*observe)(const imki_procedure_call *call);
    size_t (*workspace)(const imk_test_record *record, const imk_procedure_settings *settings);
    bool means;
} procedure_entry;

/* A magnetometer has an estimator of its own. */
static imk_status refuse_observation(const imki_procedure_call *call)
{
    return imk_error_set(call->error, IMK_ERROR_ARGUMENT, "procedure", "magnetometer",
                         "imk_magnetometer_solve()");
}

static size_t no_workspace(const imk_test_record *record, const imk_procedure_settings *settings)
{
    (void)record;
    (void)settings;
    return 0;
}

static const procedure_entry procedures[IMK_PROCEDURES] = {
    {"multiposition", imki_multiposition_observe, imki_multiposition_workspace, true},
    {"sixposition", imki_six_position_observe, imki_six_position_workspace, true},
    {"ferraris", imki_ferraris_observe, imki_ferraris_workspace, false},
    {"rate-table", imki_reference_observe, imki_reference_workspace, false},
    {"tumble", imki_reference_observe, imki_reference_workspace, true},
    {"centrifuge", imki_reference_observe, imki_reference_workspace, false},
    {"spin", imki_reference_observe, imki_reference_workspace, false},
    {"thermal", imki_thermal_observe, imki_thermal_workspace, false},
    {"turns", imki_turns_observe, imki_turns_workspace, false},
    {"magnetometer", refuse_observation, no_workspace, false},
};

static bool exists(imk_procedure procedure)
{
    return (unsigned)procedure < IMK_PROCEDURES;
}

const char *imk_procedure_name(imk_procedure procedure)
{
    return exists(procedure) ? procedures[procedure].name : NULL;
}

bool imk_procedure_takes_means(imk_procedure procedure)
{
    return exists(procedure) && procedures[procedure].means;
}

imk_procedure_settings imk_procedure_default(imk_procedure procedure)
{
    imk_procedure_settings settings = {.cookie = IMKI_PROCEDURE_COOKIE,
                                       .stationary = imk_static_default(),
                                       .trim = 0.2,
                                       .steady_rate = 1e-4,
                                       .steady_force = 1e-3,
                                       .minimum = 0.5,
                                       .gyro_turns = true,
                                       .turn_angle = 6.283185307179586,
                                       .nonlinear = procedure == IMK_PROCEDURE_RATE_TABLE ||
                                                    procedure == IMK_PROCEDURE_CENTRIFUGE,
                                       .g_sensitivity = true,
                                       .g_sensitivity_sigma = 0.01 * DEGREE / 9.80665,
                                       .scale_temperature_order = -1,
                                       .reference_temperature = (double)NAN};
    /* Faces of a housing are square to some tenths of a degree; a dividing head is exact. */
    if (procedure == IMK_PROCEDURE_SIXPOSITION || procedure == IMK_PROCEDURE_FERRARIS ||
        procedure == IMK_PROCEDURE_TURNS)
        settings.placement_sigma = 0.1 * DEGREE;
    return settings;
}

/* Room for a copy of the calibration, then what the procedure asks for. */
static size_t copy_size(void)
{
    return imki_aligned(sizeof(imk_calibration)) + IMKI_ALIGNMENT_SLACK;
}

size_t imk_procedure_workspace_size(imk_procedure procedure, const imk_test_record *record,
                                    const imk_procedure_settings *settings)
{
    return exists(procedure) ? copy_size() + procedures[procedure].workspace(record, settings) : 0;
}

/* ---- checks ---------------------------------------------------------------------------------- */

static bool positive(double x)
{
    return x > 0.0 && x < HUGE_VAL;
}

static bool not_negative(double x)
{
    return x >= 0.0 && x < HUGE_VAL;
}

static imk_status check_settings(const imk_procedure_settings *s, imk_error *error)
{
    const struct {
        const char *field;
        bool valid;
        double value;
        const char *expected;
    } rules[] = {
        {"placement_sigma", not_negative(s->placement_sigma), s->placement_sigma, "0 or more"},
        {"fixture_sigma", not_negative(s->fixture_sigma), s->fixture_sigma, "0 or more"},
        {"trim", not_negative(s->trim), s->trim, "0 or more seconds"},
        {"settle", not_negative(s->settle), s->settle, "0 or more seconds"},
        {"steady_rate", positive(s->steady_rate), s->steady_rate, "above 0"},
        {"steady_force", positive(s->steady_force), s->steady_force, "above 0"},
        {"minimum", positive(s->minimum), s->minimum, "above 0 seconds"},
        {"turn_angle", positive(fabs(s->turn_angle)), s->turn_angle, "an angle that is not 0"},
        {"g_sensitivity_sigma", not_negative(s->g_sensitivity_sigma), s->g_sensitivity_sigma,
         "0 or more rad/s per m/s^2"},
        {"sine_block", not_negative(s->sine_block), s->sine_block, "0 or more seconds"},
        {"temperature_order",
         s->temperature_order >= 0 && s->temperature_order <= IMK_TEMPERATURE_ORDER_MAX,
         s->temperature_order, "1 to 5, or 0 to choose"},
        {"scale_temperature_order",
         s->scale_temperature_order >= -1 &&
             s->scale_temperature_order <= IMK_TEMPERATURE_ORDER_MAX,
         s->scale_temperature_order, "0 to 5, or -1 to choose"},
        {"reference_temperature",
         isnan(s->reference_temperature) || positive(s->reference_temperature),
         s->reference_temperature, "above 0 K"},
        {"temperature_bin", not_negative(s->temperature_bin), s->temperature_bin, "0 or more K"},
    };
    for (size_t i = 0; i < sizeof rules / sizeof *rules; i++) {
        if (rules[i].valid)
            continue;
        return imki_refuse(error, IMK_ERROR_RANGE, rules[i].field, rules[i].value, 0.0,
                           rules[i].expected);
    }
    return IMK_OK;
}

static imk_status check_record(const imk_test_record *record, const imk_model *model,
                               imk_error *error)
{
    static const char *const names[2] = {"gyro", "accel"};
    const imk_triad *triads[2] = {&model->gyro, &model->accel};
    if (record->count == 0 || record->axis_count[0] + record->axis_count[1] < 1)
        return imk_error_set(error, IMK_ERROR_EMPTY, record->name, NULL,
                             "samples of gyros or accelerometers");
    if (!positive(record->dt))
        return imk_error_set(error, IMK_ERROR_RATE_MISSING, record->name, NULL,
                             "a sample interval above 0");
    for (int sensor = 0; sensor < 2; sensor++) {
        const int axes = triads[sensor]->present ? triads[sensor]->axis_count : 0;
        if (record->axis_count[sensor] < 0 || record->axis_count[sensor] > axes) {
            imk_error_set(error, IMK_ERROR_CONFLICT, names[sensor],
                          "the log has more axes than the model",
                          "a model of the unit that was logged");
            if (error) {
                error->value = record->axis_count[sensor];
                error->limit = axes;
            }
            return IMK_ERROR_CONFLICT;
        }
        for (int i = 0; i < record->axis_count[sensor]; i++)
            if (!record->reading[sensor][i] || (record->means && !record->mean_sigma[sensor][i]))
                return imk_error_set(error, IMK_ERROR_ARGUMENT, names[sensor], NULL,
                                     "readings of every axis, and of means their sigmas");
    }
    return IMK_OK;
}

/* ---- observing --------------------------------------------------------------------------------
 */

imk_status imk_procedure_observe(imk_procedure procedure, imk_calibration *calibration,
                                 const imk_test_record *record,
                                 const imk_procedure_settings *settings, bool keep_free,
                                 imk_procedure_findings *findings, void *workspace,
                                 size_t workspace_size, imk_error *error)
{
    if (!exists(procedure) || !calibration || !record || !settings || !workspace)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "procedure", NULL, "see procedure.h");
    if (settings->cookie != IMKI_PROCEDURE_COOKIE || calibration->cookie != IMKI_CALIBRATION_COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, NULL, NULL,
                             "start from imk_procedure_default() and imk_calibration_default()");
    imk_status status = check_settings(settings, error);
    if (record->means && !imk_procedure_takes_means(procedure))
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "means", NULL,
                             "a log: this procedure does not take means of poses");
    if (status == IMK_OK)
        status = check_record(record, &calibration->model, error);
    if (status != IMK_OK)
        return status;
    if (calibration->record_count >= IMK_TEST_RECORDS_MAX)
        return imk_error_set(error, IMK_ERROR_RANGE, "records", NULL, "at most 64 logs");
    if (workspace_size < imk_procedure_workspace_size(procedure, record, settings))
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "workspace", NULL,
                             "imk_procedure_workspace_size() bytes");
    char *memory = (char *)imki_align(workspace);
    memcpy(memory, calibration, sizeof *calibration);
    imk_procedure_findings own;
    imk_procedure_findings *seen = findings ? findings : &own;
    memset(seen, 0, sizeof *seen);
    seen->first_observation = calibration->observation_count;
    seen->first_turn = calibration->turn_count;
    calibration->record[calibration->record_count] = record;
    const size_t used = copy_size();
    const imki_procedure_call call = {.procedure = procedure,
                                      .calibration = calibration,
                                      .record = (int)calibration->record_count++,
                                      .settings = settings,
                                      .keep_free = keep_free,
                                      .workspace = (char *)workspace + used,
                                      .workspace_size = workspace_size - used,
                                      .findings = seen,
                                      .error = error};
    status = procedures[procedure].observe(&call);
    if (status != IMK_OK) {
        memcpy(calibration, memory, sizeof *calibration);
        return status;
    }
    seen->observations = calibration->observation_count - seen->first_observation;
    seen->turns = calibration->turn_count - seen->first_turn;
    return IMK_OK;
}
