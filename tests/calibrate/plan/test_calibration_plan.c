/* SPDX-License-Identifier: Apache-2.0 */
/* Experiment design: what a programme promises is what a simulated bench that runs it gives. */
#include "check.h"

#include "calibrate/plan/plan_internal.h"
#include "calibrate/pose_log.h"

#include "imukit/calibration_plan.h"

enum { STEPS = 60 };

typedef struct session {
    imk_calibration calibration;
    imk_observation observation[8 * STEPS];
    imk_turn turn[8 * STEPS];
    imk_plan_step step[STEPS];
    imk_plan_result result;
    imk_error error;
} session;

static imk_model noisy(void)
{
    imk_model model;
    imk_model_default(&model);
    for (int i = 0; i < 3; i++) {
        model.gyro.noise.white.value[i] = 1e-4;
        model.gyro.noise.bias_instability.value[i] = 2e-5;
        model.accel.noise.white.value[i] = 1e-3;
        model.accel.noise.bias_instability.value[i] = 1e-4;
    }
    return model;
}

static session *new_session(const imk_model *model)
{
    session *b = calloc(1, sizeof *b);
    imk_calibration_default(&b->calibration);
    b->calibration.model = *model;
    b->calibration.latitude = 0.7853981633974483;
    b->calibration.observation = b->observation;
    b->calibration.observation_capacity = (size_t)8 * STEPS;
    b->calibration.turn = b->turn;
    b->calibration.turn_capacity = (size_t)8 * STEPS;
    return b;
}

static imk_status make(session *b, const imk_plan_settings *settings)
{
    const size_t size = imk_plan_workspace_size(&b->calibration, settings);
    void *workspace = malloc(size);
    const imk_status status =
        imk_plan_make(&b->calibration, settings, b->step, &b->result, workspace, size, &b->error);
    free(workspace);
    return status;
}

static imk_plan_settings settings_of(imk_procedure procedure)
{
    imk_plan_settings settings = imk_plan_default(procedure);
    settings.steps_maximum = STEPS;
    return settings;
}

static imk_model_parameter parameter(int sensor, int term, int axis, int element)
{
    return (imk_model_parameter){(uint8_t)sensor, (uint8_t)term, (uint8_t)axis, (uint8_t)element};
}

static double sigma_of(const session *b, imk_model_parameter wanted)
{
    for (size_t p = 0; p < b->result.parameter_count; p++)
        if (memcmp(&b->result.parameter[p], &wanted, sizeof wanted) == 0)
            return b->result.sigma[p];
    return (double)NAN;
}

/* Six exact faces: an axis reads b + (1 + s) f_x + a f_y + c f_z in each, so that var b = v/6 and
 * var s = v/(2 g^2), v = N^2/T + (2 ln 2/pi) B^2. */
/* Of a mean over T = 20 s the errors of the readings at its two ends count, 2 r^2/T^2; white ones
 * are A^2/dt with dt = 0.01 s. */
static void readings_count_at_the_ends(void **state)
{
    (void)state;
    for (int kind = 0; kind < 3; kind++) {
        imk_model model;
        imk_model_default(&model);
        imk_noise *noise = &model.gyro.noise;
        (kind == 0   ? &noise->quantization
         : kind == 1 ? &noise->reading_noise
                     : &noise->angle_white)
            ->value[1] = kind == 2 ? 3e-5 : 3e-4;
        CHECK_RELATIVE(imki_plan_mean_variance(&model.gyro, 1, 0.01, 20.0), 2.0 * 9e-8 / 400.0,
                       1e-14);
        CHECK_CLOSE(imki_plan_mean_variance(&model.gyro, 0, 0.01, 20.0), 0.0, 0.0);
    }
}

static void six_faces_by_closed_form(void **state)
{
    (void)state;
    const imk_model model = noisy();
    session *b = new_session(&model);
    imk_plan_settings settings = settings_of(IMK_PROCEDURE_SIXPOSITION);
    settings.placement_sigma = 0.0;
    settings.hold_minimum = 4.0;
    CHECK_OK(make(b, &settings));
    assert_int_equal(b->result.step_count, 6);
    const double v = 1e-6 / 4.0 + 0.4412712003053032 * 1e-8;
    const double g = b->calibration.gravity;
    for (int i = 0; i < 3; i++) {
        /* What the regularisation adds, 1e-8, and rounding. */
        CHECK_RELATIVE(sigma_of(b, parameter(IMK_ACCEL, IMK_MODEL_BIAS, i, 0)), sqrt(v / 6.0),
                       1e-6);
        CHECK_RELATIVE(sigma_of(b, parameter(IMK_ACCEL, IMK_MODEL_SCALE_FACTOR, i, 0)),
                       sqrt(v / 2.0) / g, 1e-6);
        CHECK_RELATIVE(sigma_of(b, parameter(IMK_ACCEL, IMK_MODEL_MISALIGNMENT, i, (i + 1) % 3)),
                       sqrt(v / 2.0) / g, 1e-6);
    }
    /* 6 holds of 4 s and margins of 2 s, and 6 turns of 2 s but where a pose is that before. */
    CHECK_CLOSE(b->result.duration, 48.0, 2.0);
    assert_int_equal(b->calibration.observation_count, 0);
    assert_int_equal(b->calibration.parameter_count, 0);
    free(b);
}

/* A requirement sets the time: here sigma^2 of a scale factor is v(T)/(2 g^2), so that T follows.
 */
static void time_follows_from_the_requirement(void **state)
{
    (void)state;
    const imk_model model = noisy();
    session *b = new_session(&model);
    imk_plan_settings settings = settings_of(IMK_PROCEDURE_SIXPOSITION);
    const double v = 1e-6 / 30.0 + 0.4412712003053032 * 1e-8;
    imk_sigma_requirement requirement = {.parameter =
                                             parameter(IMK_ACCEL, IMK_MODEL_SCALE_FACTOR, 1, 0),
                                         .sigma = sqrt(v / 2.0) / b->calibration.gravity};
    settings.placement_sigma = 0.0;
    settings.requirement = &requirement;
    settings.requirement_count = 1;
    CHECK_OK(make(b, &settings));
    CHECK_RELATIVE(b->result.hold, 30.0, 2e-3); /* 14 halvings of log 60 */
    assert_true(requirement.reached);
    CHECK_RELATIVE(requirement.expected, requirement.sigma, 2e-3);
    /* Below the instability no time is enough, but another round of faces is. */
    requirement.sigma = sqrt(0.4 * 1e-8 / 2.0) / b->calibration.gravity;
    CHECK_OK(make(b, &settings));
    assert_true(requirement.reached);
    assert_true(b->result.step_count > 6 && b->result.step_count % 6 == 0);
    free(b);
}

/* What does not last cannot be reached: bias instability, repeatability; attainable is said. */
static void floors_are_told(void **state)
{
    (void)state;
    imk_model model = noisy();
    model.accel.scale_factor.repeatability.value[2] = 1e-4;
    session *b = new_session(&model);
    imk_plan_settings settings = settings_of(IMK_PROCEDURE_SIXPOSITION);
    settings.placement_sigma = 0.0;
    imk_sigma_requirement requirement[3] = {
        {.parameter = parameter(IMK_ACCEL, IMK_MODEL_BIAS, 0, 0), .sigma = 5e-5},
        {.parameter = parameter(IMK_ACCEL, IMK_MODEL_SCALE_FACTOR, 2, 0), .sigma = 5e-5},
        {.parameter = parameter(IMK_ACCEL, IMK_MODEL_SCALE_FACTOR, 0, 0), .sigma = 5e-5}};
    settings.requirement = requirement;
    settings.requirement_count = 3;
    CHECK_OK(make(b, &settings));
    assert_false(requirement[0].reached);
    assert_false(requirement[1].reached);
    assert_true(requirement[2].reached);
    assert_int_equal(b->result.reached, 1);
    CHECK_RELATIVE(requirement[0].floor, 0.6642824701161626 * 1e-4, 1e-6); /* sqrt(2 ln 2/pi) B */
    CHECK_RELATIVE(requirement[1].floor, 1e-4, 1e-12);
    assert_true(requirement[0].expected >= requirement[0].floor && requirement[1].expected >= 1e-4);
    settings.lasting = false;
    CHECK_OK(make(b, &settings));
    assert_int_equal(b->result.reached, 3);
    free(b);
}

/* Every procedure determines what it is about. */
static void all_procedures_are_planned(void **state)
{
    (void)state;
    const imk_model model = noisy();
    session *b = new_session(&model);
    static imk_motion_step motion[4 * STEPS + 1];
    for (int procedure = 0; procedure < IMK_PROCEDURES; procedure++) {
        const imk_plan_settings settings = settings_of((imk_procedure)procedure);
        if (procedure == IMK_PROCEDURE_MAGNETOMETER) { /* needs no plan: any rotation by hand */
            CHECK_STATUS(make(b, &settings), IMK_ERROR_RANGE);
            continue;
        }
        CHECK_OK(make(b, &settings));
        assert_true(b->result.step_count >= 3 && b->result.parameter_count > 0);
        imk_motion_script script;
        const imk_status status =
            imk_plan_script(&settings, b->result.step_count, b->step, motion, &script, &b->error);
        if (procedure == IMK_PROCEDURE_CENTRIFUGE) {
            CHECK_STATUS(status, IMK_ERROR_UNSUPPORTED);
        } else {
            size_t pieces;
            CHECK_OK(status);
            assert_true(script.step_count <= imk_plan_script_steps(b->result.step_count));
            CHECK_OK(imk_motion_script_pieces(&script, &pieces, &b->error));
        }
        for (size_t p = 0; p < b->result.parameter_count; p++) {
            /* Steady rates about single axes tell each accelerometer's place across its own
             * axis not at all; that is the only thing a programme may leave. */
            if (procedure != IMK_PROCEDURE_SPIN && !(b->result.sigma[p] > 0.0)) {
                char name[IMK_MODEL_PARAMETER_NAME];
                CHECK_OK(imk_model_parameter_name(b->result.parameter[p], name));
                fail_msg("%s is not determined by %s", name,
                         imk_procedure_name((imk_procedure)procedure));
            }
        }
    }
    free(b);
}

/* A rotation of the whole unit moves each misalignment by its angle: none is known better than the
 * mounting; scale factors and biases do not care. */
static void mounting_is_counted(void **state)
{
    (void)state;
    const imk_model model = noisy();
    session *b = new_session(&model);
    imk_plan_settings settings = settings_of(IMK_PROCEDURE_SIXPOSITION);
    settings.placement_sigma = 1e-6;
    CHECK_OK(make(b, &settings));
    const imk_plan_result exact = b->result;
    settings.fixture_sigma = 0.01;
    CHECK_OK(make(b, &settings));
    for (size_t p = 0; p < exact.parameter_count; p++) {
        const imk_model_parameter which = exact.parameter[p];
        if (which.sensor != IMK_ACCEL)
            continue;
        if (which.term == IMK_MODEL_MISALIGNMENT)
            assert_true(b->result.sigma[p] > 0.0099 && b->result.sigma[p] < 0.0101);
        else
            CHECK_RELATIVE(b->result.sigma[p], exact.sigma[p], 1e-3);
    }
    free(b);
}

/* Six holds and three whole turns, each between two holds, with the sign of the angle; the time of
 * a turn is that of the angle, and it bounds the sigma of the scale: placement over the angle. */
static void whole_turns_of_ferraris(void **state)
{
    (void)state;
    const double turn = 6.283185307179586;
    const imk_model model = noisy();
    session *b = new_session(&model);
    static imk_motion_step motion[4 * STEPS + 1];
    imk_motion_script script;
    imk_plan_settings settings = settings_of(IMK_PROCEDURE_FERRARIS);
    settings.placement_sigma = 0.002;
    settings.turn_angle = -turn;
    CHECK_OK(make(b, &settings));
    CHECK_OK(imk_plan_script(&settings, b->result.step_count, b->step, motion, &script, &b->error));
    int turns = 0;
    for (size_t k = 0; k < script.step_count; k++) {
        if (motion[k].kind != IMK_STEP_ROTATE)
            continue;
        turns++;
        CHECK_CLOSE(motion[k].amount, -turn, 0.0);
        assert_int_equal(motion[k - 1].kind, IMK_STEP_HOLD);
        assert_int_equal(motion[k + 1].kind, IMK_STEP_HOLD);
    }
    assert_int_equal(turns, 3);
    for (size_t p = 0; p < b->result.parameter_count; p++) {
        const imk_model_parameter which = b->result.parameter[p];
        if (which.sensor == IMK_GYRO && which.term == IMK_MODEL_SCALE_FACTOR)
            assert_true(b->result.sigma[p] > 0.99 * 0.002 / turn &&
                        b->result.sigma[p] < 1.3 * 0.002 / turn);
    }
    free(b);
}

/* The soak lengthens the programme, once a temperature. */
static void temperatures_are_soaked(void **state)
{
    (void)state;
    const imk_model model = noisy();
    session *b = new_session(&model);
    imk_plan_settings settings = settings_of(IMK_PROCEDURE_THERMAL);
    CHECK_CLOSE(settings.soak, 600.0, 0.0);
    CHECK_OK(make(b, &settings));
    const imk_plan_result usual = b->result;
    settings.soak = 0.0;
    CHECK_OK(make(b, &settings));
    assert_int_equal(b->result.step_count, usual.step_count);
    CHECK_RELATIVE(usual.duration - b->result.duration, 600.0 * (double)usual.step_count, 1e-9);
    settings.soak = -1.0;
    CHECK_STATUS(make(b, &settings), IMK_ERROR_RANGE);
    free(b);
}

/* Run a multi-position programme on simulated benches, calibrate, and compare with the promise. The
 * requirement is met within 15 %, by the mean sigma the calibrations state; it may be beaten,
 * because the Earth's rate, which counts as unknown in each turn, is partly found. And by their
 * errors, whose rms over 24 benches and 3 axes has 1 sigma of 8 %, here with a limit of 45 %. */
static void programme_keeps_its_promise(void **state)
{
    (void)state;
    enum { WISHES = 6 };
    const uint64_t benches = check_quick() ? 8 : 24;
    imk_model model = noisy();
    session *b = new_session(&model);
    imk_plan_settings settings = settings_of(IMK_PROCEDURE_MULTIPOSITION);
    imk_sigma_requirement requirement[WISHES];
    for (int i = 0; i < 3; i++) {
        requirement[i] = (imk_sigma_requirement){
            .parameter = parameter(IMK_ACCEL, IMK_MODEL_SCALE_FACTOR, i, 0), .sigma = 1.6e-5};
        requirement[3 + i] = (imk_sigma_requirement){
            .parameter = parameter(IMK_GYRO, IMK_MODEL_SCALE_FACTOR, i, 0), .sigma = 6e-5};
    }
    settings.requirement = requirement;
    settings.requirement_count = WISHES;
    CHECK_OK(make(b, &settings));
    assert_int_equal(b->result.reached, WISHES);
    static imk_motion_step motion[4 * STEPS + 1];
    imk_motion_script script;
    CHECK_OK(imk_plan_script(&settings, b->result.step_count, b->step, motion, &script, &b->error));
    imk_procedure_settings procedure = imk_procedure_default(IMK_PROCEDURE_MULTIPOSITION);
    imk_procedure_findings findings;
    static imk_calibration_result result;
    double square[2] = {0.0, 0.0}, stated[2] = {0.0, 0.0};
    for (int i = 0; i < 3; i++) {
        model.accel.scale_factor.fixed.value[i] = 0.003 * (i - 0.7);
        model.gyro.scale_factor.fixed.value[i] = 0.002 * (1.2 - i);
    }
    for (uint64_t seed = 1; seed <= benches; seed++) {
        pose_log *log = pose_log_of(&model, &script, b->result.duration - 2.0, 100.0, seed);
        imk_calibration *c = &b->calibration;
        imk_calibration_default(c);
        c->latitude = 0.7853981633974483;
        c->observation = b->observation;
        c->turn = b->turn;
        c->observation_capacity = c->turn_capacity = (size_t)8 * STEPS;
        const size_t looking =
            imk_procedure_workspace_size(IMK_PROCEDURE_MULTIPOSITION, &log->record, &procedure);
        void *workspace = malloc(looking);
        CHECK_OK(imk_procedure_observe(IMK_PROCEDURE_MULTIPOSITION, c, &log->record, &procedure,
                                       false, &findings, workspace, looking, &b->error));
        free(workspace);
        const size_t solving = imk_calibration_workspace_size(c);
        workspace = malloc(solving);
        CHECK_OK(imk_calibration_solve(c, &result, workspace, solving, &b->error));
        free(workspace);
        for (size_t p = 0; p < result.parameter_count; p++)
            if (result.parameter[p].term == IMK_MODEL_SCALE_FACTOR) {
                const int sensor = result.parameter[p].sensor;
                const double error =
                    result.value[p] - imk_model_parameter_get(&model, result.parameter[p]);
                square[sensor] += error * error / (3.0 * (double)benches);
                stated[sensor] += result.sigma[p] / (3.0 * (double)benches);
            }
        pose_log_free(log);
    }
    for (int sensor = 0; sensor < 2; sensor++) {
        const imk_sigma_requirement *w = &requirement[sensor == IMK_GYRO ? 3 : 0];
        double promised = 0.0;
        for (int i = 0; i < 3; i++)
            promised += w[i].expected / 3.0;
        print_message("sensor %d: promised %.3g, stated %.3g, error %.3g; %zu steps of %.3g s\n",
                      sensor, promised, stated[sensor], sqrt(square[sensor]), b->result.step_count,
                      b->result.hold);
        CHECK_BELOW(stated[sensor], 1.15 * promised);
        CHECK_BELOW(0.7 * promised, stated[sensor]);
        CHECK_BELOW(sqrt(square[sensor]), 1.45 * promised);
        CHECK_BELOW(promised / 1.45, sqrt(square[sensor]));
    }
    free(b);
}

/* Five faces are there, the sixth is missing: it is what is advised, and what it improves. */
static void missing_pose_is_advised(void **state)
{
    (void)state;
    const imk_model model = noisy();
    session *b = new_session(&model);
    imk_calibration *c = &b->calibration;
    for (int i = 0; i < 3; i++)
        for (int term = IMK_MODEL_BIAS; term <= IMK_MODEL_SCALE_FACTOR; term++)
            CHECK_OK(imk_calibration_free(c, IMK_ACCEL, term, i, 0));
    for (int face = 0; face < 5; face++) {
        imk_observation o = {.knowledge = IMK_INPUT_GRAVITY,
                             .record = -1,
                             .fixture = -1,
                             .temperature = (double)NAN};
        for (int sensor = 0; sensor < 2; sensor++)
            for (int i = 0; i < IMK_AXES_MAX; i++) {
                o.sigma[sensor][i] = 1e-3;
                o.reading[sensor][i] = sensor == IMK_ACCEL && i < 3 ? 0.0 : (double)NAN;
            }
        o.force[face / 2] = face % 2 == 0 ? c->gravity : -c->gravity;
        assert_true(imk_calibration_observe(c, &o) >= 0);
    }
    const size_t size = imk_next_pose_workspace_size(c);
    void *workspace = malloc(size);
    imk_pose_advice advice[3];
    CHECK_OK(imk_next_pose(c, 0.0, 3, advice, workspace, size, &b->error));
    CHECK_BELOW(advice[0].up[2], -0.9);
    CHECK_CLOSE(advice[0].roll, 0.0, 0.5);
    CHECK_CLOSE(advice[0].pitch, 0.0, 0.5);
    assert_true(advice[0].improved >= 0);
    assert_int_equal(c->parameter[advice[0].improved].axis, 2);
    CHECK_CLOSE(advice[0].ratio, 0.0, 0.0); /* not determined before */
    /* A determined problem gains less from each. */
    assert_true(advice[0].gain > advice[1].gain && advice[1].gain >= advice[2].gain - 1e-9);
    assert_true(advice[2].ratio > 0.3 && advice[2].ratio < 1.0);
    free(workspace);
    free(b);
}

static void mistakes_are_refused(void **state)
{
    (void)state;
    imk_model model = noisy();
    session *b = new_session(&model);
    imk_plan_settings settings = settings_of(IMK_PROCEDURE_SIXPOSITION);
    imk_sigma_requirement requirement = {
        .parameter = parameter(IMK_GYRO, IMK_MODEL_SCALE_FACTOR, 0, 0), .sigma = 1e-4};
    settings.requirement = &requirement;
    settings.requirement_count = 1;
    CHECK_STATUS(make(b, &settings), IMK_ERROR_KEY_MISSING);
    assert_string_equal(b->error.field, "gyro.scale_factor.fixed.x");
    requirement.sigma = -1.0;
    requirement.parameter = parameter(IMK_ACCEL, IMK_MODEL_SCALE_FACTOR, 0, 0);
    CHECK_STATUS(make(b, &settings), IMK_ERROR_RANGE);
    settings.requirement_count = 0;
    settings.hold_minimum = (double)NAN;
    CHECK_STATUS(make(b, &settings), IMK_ERROR_RANGE);
    assert_string_equal(b->error.field, "hold_minimum");
    settings = settings_of(IMK_PROCEDURE_SIXPOSITION);
    settings.cookie = 0;
    CHECK_STATUS(make(b, &settings), IMK_ERROR_UNINITIALISED);
    settings = settings_of(IMK_PROCEDURE_SIXPOSITION);
    b->calibration.observation_capacity = 3;
    CHECK_STATUS(make(b, &settings), IMK_ERROR_WORKSPACE);
    b->calibration.observation_capacity = STEPS;
    b->calibration.model.accel.noise.white.value[1] = 0.0;
    b->calibration.model.accel.noise.bias_instability.value[1] = 0.0;
    CHECK_STATUS(make(b, &settings), IMK_ERROR_KEY_MISSING);
    assert_string_equal(b->error.field, "accel.noise");
    free(b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(readings_count_at_the_ends),
        cmocka_unit_test(six_faces_by_closed_form),
        cmocka_unit_test(time_follows_from_the_requirement),
        cmocka_unit_test(floors_are_told),
        cmocka_unit_test(all_procedures_are_planned),
        cmocka_unit_test(mounting_is_counted),
        cmocka_unit_test(whole_turns_of_ferraris),
        cmocka_unit_test(temperatures_are_soaked),
        cmocka_unit_test(programme_keeps_its_promise),
        cmocka_unit_test(missing_pose_is_advised),
        cmocka_unit_test(mistakes_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
