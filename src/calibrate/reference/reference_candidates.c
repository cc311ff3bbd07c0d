/* SPDX-License-Identifier: Apache-2.0 */
/* What each procedure with a reference would make free, in the order in which it is tried. */
#include "model/model_schema_internal.h"
#include "reference_internal.h"

static void want(imki_candidate *list, size_t *count, int sensor, int term, bool promised)
{
    list[(*count)++] = (imki_candidate){(uint8_t)sensor, (uint8_t)term, promised, false};
}

/* Powers with q that are looked for: of the first degree alone, or of higher ones. */
static void want_powers(imki_candidate *list, size_t *count, int sensor, int q, bool first)
{
    for (size_t k = 0; k < imki_input_power_count; k++) {
        const imki_power *power = &imki_input_powers[k];
        if (power->sought && power->q == q && (power->p + q == 1) == first)
            want(list, count, sensor, power->term, true);
    }
}

static void want_nonlinear(imki_candidate *list, size_t *count, int sensor)
{
    want_powers(list, count, sensor, 1, true);
    want_powers(list, count, sensor, 0, false);
    want_powers(list, count, sensor, 1, false);
}

static void want_linear(imki_candidate *list, size_t *count, int sensor, bool promised)
{
    want(list, count, sensor, IMK_MODEL_SCALE_FACTOR, promised);
    want(list, count, sensor, IMK_MODEL_MISALIGNMENT, promised);
}

static void want_gravity(const imk_procedure_settings *s, imki_candidate *list, size_t *count)
{
    want(list, count, IMK_GYRO, IMK_MODEL_G_SENSITIVITY, s->g_sensitivity);
    list[*count - 1].hidden = !s->g_sensitivity;
    if (s->g2_sensitivity)
        want(list, count, IMK_GYRO, IMK_MODEL_G2_SENSITIVITY, true);
}

static bool forces_known(const imki_procedure_call *call)
{
    const imk_calibration *c = call->calibration;
    for (size_t i = c->observation_count; i-- > 0 && c->observation[i].record == call->record;)
        for (int j = 0; j < 3; j++)
            if (c->observation[i].force[j] != 0.0)
                return true;
    return false;
}

size_t imki_reference_candidates(const imki_procedure_call *call,
                                 imki_candidate list[IMKI_CANDIDATES_MAX])
{
    const imk_procedure_settings *s = call->settings;
    const imk_test_record *record = call->calibration->record[call->record];
    size_t count = 0;
    switch (call->procedure) {
    case IMK_PROCEDURE_RATE_TABLE:
        want(list, &count, IMK_GYRO, IMK_MODEL_BIAS, true);
        want_linear(list, &count, IMK_GYRO, true);
        if (s->nonlinear)
            want_nonlinear(list, &count, IMK_GYRO);
        if (forces_known(call))
            want_gravity(s, list, &count);
        break;
    case IMK_PROCEDURE_SPIN:
        if (imki_reference_channels(record, IMK_ACCEL))
            want(list, &count, IMK_ACCEL, IMK_MODEL_BIAS, true);
        want(list, &count, IMK_ACCEL, IMK_MODEL_LEVER_ARM, true);
        if (imki_reference_channels(record, IMK_ACCEL))
            want_linear(list, &count, IMK_ACCEL, false);
        break;
    default: {
        const bool tumble = call->procedure == IMK_PROCEDURE_TUMBLE;
        want(list, &count, IMK_ACCEL, IMK_MODEL_BIAS, true);
        want_linear(list, &count, IMK_ACCEL, true);
        if (s->nonlinear && tumble) {
            want_powers(list, &count, IMK_ACCEL, 0, false);
        } else if (s->nonlinear) {
            want_nonlinear(list, &count, IMK_ACCEL);
        }
        if (s->cross_products || (s->nonlinear && tumble))
            want(list, &count, IMK_ACCEL, IMK_MODEL_CROSS_PRODUCTS, true);
        /* At rest the Earth's rate may tell scale factors too, but after what the test is for. */
        want(list, &count, IMK_GYRO, IMK_MODEL_BIAS, true);
        if (!tumble)
            want_linear(list, &count, IMK_GYRO, false);
        want_gravity(s, list, &count);
        if (tumble)
            want_linear(list, &count, IMK_GYRO, false);
        break;
    }
    }
    return count;
}
