/* SPDX-License-Identifier: Apache-2.0 */
/* imukit physics: what its logs, files, tables and messages have to do with one another. Figures of
 * the default designs are left to the tests of the instruments; here stand the numbers of designs
 * that are written in full, definitions of units, and agreements between two ways. */
#include "run_command.h"

#include "imukit/instrument.h"
#include "imukit/log.h"
#include "imukit/model_file.h"

#include <math.h>

static const double degree = 3.14159265358979323846 / 180;

static imk_log load(const char *path)
{
    imk_log log;
    CHECK_OK(imk_log_load(path, NULL, NULL, &log, NULL));
    return log;
}

static double mean(const imk_log *log, size_t column)
{
    double sum = 0;
    for (size_t k = 0; k < log->rows; k++)
        sum += log->data[column][k];
    return sum / (double)log->rows;
}

static json_t *json_of(const char *text)
{
    json_error_t problem;
    json_t *document = json_loads(text, 0, &problem);
    if (!document)
        fail_msg("%s: %s", problem.text, text);
    return document;
}

/* ---- the list and the designs ---------------------------------------------------------------- */

/* All instruments of the library are in the list, by name and with their source. */
static void test_list(void **state)
{
    (void)state;
    assert_true(imk_instrument_count() > 0);
    assert_int_equal(run("$I physics"), 0);
    assert_string_equal(err, "");
    for (size_t i = 0; i < imk_instrument_count(); i++) {
        check_contains(out, imk_instrument_get(i)->name, "physics");
        check_contains(out, imk_instrument_get(i)->title, "physics");
        check_contains(out, imk_instrument_get(i)->source, "physics");
    }
    assert_int_equal(run("$I physics >a.txt && $I physics --list | cmp - a.txt"), 0);
    assert_int_equal(run("$I physics --list --json"), 0);
    json_t *document = json_of(out);
    json_t *list = json_object_get(json_object_get(document, "result"), "instruments");
    assert_int_equal(json_array_size(list), imk_instrument_count());
    json_decref(document);
    sweep();
}

/* The shown design is a design file that says the same; each instrument can be shown, described,
 * run, reduced and reported from it. */
static void test_every_instrument(void **state)
{
    (void)state;
    for (size_t i = 0; i < imk_instrument_count(); i++) {
        char line[512];
        const char *name = imk_instrument_get(i)->name;
        snprintf(line, sizeof line,
                 "$I physics %s --show >a.yaml && $I physics a.yaml --show | cmp - a.yaml && "
                 "$I physics %s --show -o b.yaml && cmp a.yaml b.yaml",
                 name, name);
        if (run(line) != 0)
            fail_msg("%s: %s", name, err);
        snprintf(line, sizeof line,
                 "$I physics %s --duration 20ms >a.csv && $I physics a.yaml --duration 20ms -o "
                 "b.csv && cmp a.csv b.csv",
                 name);
        if (run(line) != 0 || strstr(err, "error"))
            fail_msg("%s: %s", name, err);
        snprintf(line, sizeof line, "$I physics %s", name);
        assert_int_equal(run(line), 0);
        check_contains(out, imk_instrument_get(i)->fields[0].path, line);
        snprintf(line, sizeof line, "$I physics %s --reduce -o m.yaml", name);
        if (run(line) != 0)
            fail_msg("%s: %s", name, err);
        imk_model *model = malloc(sizeof *model);
        assert_non_null(model);
        CHECK_OK(imk_model_read("m.yaml", model, NULL, NULL));
        const imk_triad *triad = imk_instrument_get(i)->sensor == 0 ? &model->gyro : &model->accel;
        assert_int_equal(triad->axis_count, 3);
        free(model);
    }
    sweep();
}

/* ---- runs ------------------------------------------------------------------------------------ */

/* Row k ends at (k + 1)/rate; a noiseless ring laser that turns at 10 deg/s reads it within the
 * scale of its counts: a quarter of some arc seconds at 100 Hz, 10 s of them. */
static void test_log(void **state)
{
    (void)state;
    assert_int_equal(run("$I physics ring_laser --rate '10 deg/s' --duration 10s --no-noise -o "
                         "a.csv && $I physics ring_laser --rate '36000 deg/h' -d 10s --no-noise "
                         ">b.csv && cmp a.csv b.csv"),
                     0);
    assert_string_equal(err, "");
    imk_log log = load("a.csv");
    assert_int_equal(log.rows, 1000);
    assert_string_equal(log.column[0].name, "time");
    assert_string_equal(log.column[1].name, "gyro_x");
    assert_string_equal(log.column[1].unit.text, "deg/s");
    CHECK_CLOSE(log.data[0][0], 0.01, 0.0);
    CHECK_CLOSE(log.data[0][999], 10.0, 0.0);
    CHECK_CLOSE(mean(&log, 1), 10 * degree, 3.0 / 3600 * degree / 10);
    imk_log_free(&log);
    assert_int_equal(run("$I physics pendulous_servo --acceleration '1 g' --duration 1s -o a.csv"),
                     0);
    log = load("a.csv");
    assert_string_equal(log.column[1].name, "accel_x");
    assert_string_equal(log.column[1].unit.text, "m/s^2");
    CHECK_RELATIVE(mean(&log, 1), 9.80665, 0.02);
    imk_log_free(&log);
    sweep();
}

/* One sample has no scatter: "-" and null; and a warning cannot be assessed by it. */
static void test_one_sample(void **state)
{
    (void)state;
    static const char *const names[] = {"ring_laser", "mems_accelerometer"};
    char line[200];
    for (int i = 0; i < 2; i++) {
        snprintf(line, sizeof line, "$I physics %s -d 0.2s --output-rate 5Hz -o a.csv", names[i]);
        assert_int_equal(run(line), 0);
        assert_string_equal(err, "");
        check_contains(out, "   -  ", line);
        assert_null(strstr(out, "nan"));
        snprintf(line, sizeof line, "$I physics %s -d 0.2s --output-rate 5Hz --json", names[i]);
        assert_int_equal(run(line), 0);
        check_contains(out, "\"standard_deviation\": {\"value\": null, ", line);
    }
    sweep();
}

/* A sine starts at 0 and has whole cycles: its mean is 0, its root mean square a/sqrt(2), less
 * sinc(f/rate) for the mean over a sample. */
static void test_sine(void **state)
{
    (void)state;
    assert_int_equal(run("$I physics ring_laser --rate '20 deg/s' --sine 2Hz --duration 2s "
                         "--output-rate 200Hz --no-noise -o a.csv"),
                     0);
    imk_log log = load("a.csv");
    double square = 0;
    assert_int_equal(log.rows, 400);
    for (size_t k = 0; k < log.rows; k++)
        square += log.data[1][k] * log.data[1][k] / 400;
    const double x = 3.14159265358979323846 * 2 / 200, sinc = sin(x) / x;
    CHECK_CLOSE(mean(&log, 1), 0.0, degree / 3600);             /* a count, 1.1 arcsec, in 2 s */
    CHECK_RELATIVE(sqrt(2 * square), 20 * degree * sinc, 1e-4); /* counts */
    assert_true(log.data[1][10] > 0 && log.data[1][90] < 0);
    imk_log_free(&log);
    sweep();
}

static void test_same_bytes(void **state)
{
    (void)state;
    assert_int_equal(run("$I physics ring_laser -d 1s -o a.csv; $I physics ring_laser -d 1s --seed "
                         "1 --run 0 | cmp - a.csv"),
                     0);
    assert_int_equal(run("$I physics ring_laser -d 1s --seed 2 | cmp -s - a.csv"), 1);
    assert_int_equal(run("$I physics ring_laser -d 1s --run 1 | cmp -s - a.csv"), 1);
    assert_int_equal(run("IMUKIT_ISA=scalar $I physics ring_laser -d 1s | cmp - a.csv"), 0);
    sweep();
}

static void test_temperature_and_signals(void **state)
{
    (void)state;
    assert_int_equal(run("$I physics ring_laser --temperature 30degC --temperature-rate "
                         "6degC/min -d 100ms -o a.csv --signals s.csv"),
                     0);
    imk_log log = load("a.csv"), inside = load("s.csv");
    const int at = imk_log_find(&log, IMK_QUANTITY_TEMPERATURE, -1);
    assert_true(at > 0);
    CHECK_CLOSE(log.data[at][0], 303.15 + 0.1 * 0.005, 1e-9); /* the middle of the sample */
    assert_int_equal(inside.rows, 10);
    assert_int_equal(inside.column_count, 1 + imk_instrument_find("ring_laser")->signal_count);
    assert_string_equal(inside.column[1].name, imk_instrument_find("ring_laser")->signals[0].name);
    imk_log_free(&log);
    imk_log_free(&inside);
    /* at the same rate the signals cost no other run, at another they do not change the log */
    assert_int_equal(run("$I physics ring_laser --temperature 30degC --temperature-rate "
                         "6degC/min -d 100ms -o b.csv --signals s.csv --signal-rate 10kHz && cmp "
                         "a.csv b.csv"),
                     0);
    inside = load("s.csv");
    assert_int_equal(inside.rows, 1000);
    imk_log_free(&inside);
    sweep();
}

/* One that tells its temperature itself has one column of it. */
static void test_told_temperature(void **state)
{
    (void)state;
    assert_int_equal(run("$I physics vibrating_beam --temperature-rate 60degC/min -d 1s -o a.csv "
                         "&& head -n 1 a.csv && rm a.csv"),
                     0);
    check_contains(
        out, "\ntime [s],accel_x [m/s^2],frequency_1 [Hz],frequency_2 [Hz],temperature [degC]\n",
        "header");
    sweep();
}

static void test_levels_and_warnings(void **state)
{
    (void)state;
    put("d.yaml", "imukit: 1\ninstrument: ring_laser\nname: lab\nreadout: {range: 100 deg/s}\n");
    check_message("$I physics d.yaml --rate '150 deg/s' -d 100ms -o a.csv >t.txt", 0,
                  "imukit physics: warning: the input of 150 deg/s is beyond the range of 100 "
                  "deg/s\n");
    assert_int_equal(run("$I physics d.yaml --rate '150 deg/s' -d 100ms --level slow --json"), 0);
    json_t *document = json_of(out);
    json_t *warning = json_array_get(json_object_get(document, "findings"), 0);
    assert_string_equal(json_string_value(json_object_get(warning, "code")), "range");
    assert_string_equal(
        json_string_value(json_object_get(json_object_get(document, "inputs"), "level")), "slow");
    json_t *output =
        json_array_get(json_object_get(json_object_get(document, "result"), "outputs"), 0);
    const double end =
        json_number_value(json_object_get(json_object_get(output, "at_the_end"), "value"));
    CHECK_CLOSE(end, 100 * degree, 1e-3 * degree);
    json_decref(document);
    assert_int_equal(run("$I physics d.yaml -d 100ms -o a.csv"), 0);
    check_contains(out, "lab: 10 samples at 100 Hz, 0.1 s, full dynamics, internal step", "run");
    sweep();
}

/* Twenty microseconds of pulses do not show a rate. */
static void test_scatter(void **state)
{
    (void)state;
    assert_int_equal(run("$I physics fibre_optic --rate '10 deg/s' --output-rate 50MHz -d 20us -o "
                         "a.csv"),
                     0);
    check_contains(err, "too much to show that the output", err);
    check_contains(out, "Usable with care: samples scatter by ", "sentence");
    assert_null(strstr(out, "the output follows"));
    sweep();
}

/* The numbers are those of test_suspended_touch_down.c: the limit, and v and t by energy within 1
 * %.
 */
static void test_touch_down(void **state)
{
    (void)state;
    check_message("$I physics suspended_rotor --acceleration '24.9 g' -d 100ms -o a.csv >t.txt", 0,
                  "");
    assert_int_equal(
        run("$I physics suspended_rotor --acceleration '26 g' -d 100ms -o a.csv >t.txt"), 0);
    double time = 0, speed = 0;
    const char *at = strstr(err, "warning: the ball touched its stop at -x after ");
    assert_non_null(at);
    assert_int_equal(sscanf(at, "warning: the ball touched its stop at -x after %lf s, at %lf m/s",
                            &time, &speed),
                     2);
    CHECK_RELATIVE(time, 5.878e-4, 0.01);
    CHECK_RELATIVE(speed, 0.03025, 0.01);
    check_contains(err, "under 254.97 m/s^2 (26 g): the suspension carries 245.17 m/s^2 (25 g) ",
                   "forces");
    assert_int_equal(run("$I physics suspended_rotor --acceleration '26 g' -d 100ms --level slow "
                         "--json"),
                     0);
    json_t *document = json_of(out);
    json_t *warning = json_array_get(json_object_get(document, "findings"), 0);
    assert_string_equal(json_string_value(json_object_get(warning, "code")), "touched");
    json_decref(document);
    sweep();
}

/* ---- the error model ------------------------------------------------------------------------- */

static void test_reduce(void **state)
{
    (void)state;
    put("d.yaml", "imukit: 1\ninstrument: ring_laser\nname: lab\nnull_shift: {fixed: 0.5 deg/h, "
                  "repeatability: 0.25 deg/h}\nreadout: {range: 100 deg/s}\n");
    assert_int_equal(run("$I physics d.yaml --reduce -o m.yaml --single-axis"), 0);
    check_contains(out, "Error model by closed forms, one axis\n", "--reduce");
    check_contains(out, "bias.fixed", "--reduce");
    imk_model *model = malloc(sizeof *model);
    assert_non_null(model);
    CHECK_OK(imk_model_read("m.yaml", model, NULL, NULL));
    assert_string_equal(model->name, "lab");
    assert_int_equal(model->gyro.axis_count, 1);
    assert_false(model->accel.present);
    CHECK_RELATIVE(model->gyro.bias.fixed.value[0], 0.5 / 3600 * degree, 1e-12);
    CHECK_RELATIVE(model->gyro.bias.repeatability.value[0], 0.25 / 3600 * degree, 1e-12);
    CHECK_RELATIVE(model->gyro.range.value[0], 100 * degree, 1e-12);
    free(model);
    /* it is a model like any other */
    assert_int_equal(run("$I physics d.yaml --reduce -o m.yaml >t.txt && $I grade m.yaml >t.txt && "
                         "$I simulate m.yaml --rate 100Hz --duration 1s -o l.csv"),
                     0);
    imk_log log = load("l.csv");
    assert_int_equal(log.column_count, 4);
    imk_log_free(&log);
    assert_int_equal(run("$I physics d.yaml --reduce --json"), 0);
    json_t *document = json_of(out);
    json_t *bias = json_object_get(json_object_get(json_object_get(document, "result"), "reduced"),
                                   "bias.fixed");
    CHECK_RELATIVE(json_number_value(json_object_get(bias, "value")), 0.5 / 3600 * degree, 1e-12);
    assert_string_equal(json_string_value(json_object_get(bias, "unit")), "rad/s");
    json_decref(document);
    assert_int_equal(run("$I physics d.yaml --reduce -o - --single-axis"), 0);
    assert_int_equal(strncmp(out, "imukit: 1\nname: lab\ngyro:\n", 26), 0);
    sweep();
}

/* A derived quantity of the JSON by its name. */
static json_t *derived_of(json_t *document, const char *name)
{
    json_t *list = json_object_get(json_object_get(document, "result"), "derived"), *entry;
    size_t i;
    json_array_foreach(list, i, entry) if (strcmp(json_string_value(json_object_get(entry, "name")),
                                                  name) == 0) return entry;
    fail_msg("%s is not in the list", name);
    return NULL;
}

/* What follows from the parts is with the design, with the error model and on the page, and in SI
 * in the JSON; of what the design does not have, the reason. */
static void test_derived(void **state)
{
    (void)state;
    put("d.yaml", "imukit: 1\ninstrument: fibre_optic\nloop: {mode: open, range: 10 deg/s}\n"
                  "coil: {length: 500 m, diameter: 100 mm}\nsource: {wavelength: 1000 nm}\n");
    static const char *const tasks[] = {"", "--reduce"};
    for (int i = 0; i < 2; i++) {
        char line[100];
        snprintf(line, sizeof line, "$I physics d.yaml %s", tasks[i]);
        assert_int_equal(run(line), 0);
        check_contains(out, "\nDerived quantities\n", tasks[i]);
        check_contains(out, "K = 2 pi L D/(lambda c)", tasks[i]);
        check_contains(out, "No effective loop gain: an open loop has no feedback (loop.mode).\n",
                       tasks[i]);
        snprintf(line, sizeof line, "$I physics d.yaml %s --json", tasks[i]);
        assert_int_equal(run(line), 0);
        json_t *document = json_of(out), *phase = derived_of(document, "Sagnac phase per rate");
        /* 2 pi 500 0.1/(1e-6 c) rad per rad/s */
        CHECK_RELATIVE(json_number_value(json_object_get(phase, "value")),
                       100 * 3.14159265358979 / 299.792458, 1e-12);
        assert_string_equal(json_string_value(json_object_get(phase, "symbol")), "K");
        assert_string_equal(json_string_value(json_object_get(phase, "unit")), "rad/(rad/s)");
        assert_string_equal(json_string_value(json_object_get(phase, "source")), "[VALI1976]");
        assert_true(json_is_null(json_object_get(phase, "absent")));
        json_t *gain = derived_of(document, "effective loop gain");
        assert_true(json_is_null(json_object_get(gain, "value")));
        assert_string_equal(json_string_value(json_object_get(gain, "absent")),
                            "an open loop has no feedback (loop.mode)");
        json_decref(document);
    }
    assert_int_equal(run("$I physics d.yaml --report p.html && grep -c 'K = 2 pi L D' p.html"), 0);
    sweep();
}

/* Closed forms and experiments side by side; both as figures of the JSON. */
static void test_sweep(void **state)
{
    (void)state;
    assert_int_equal(run("$I physics pendulous_servo --sweep --no-noise --level slow --json "
                         "--threads 1 -o m.yaml"),
                     0);
    json_t *document = json_of(out);
    json_t *figures = json_object_get(
        json_object_get(json_object_get(document, "result"), "experiment"), "figures");
    json_t *bias = json_object_get(figures, "bias.fixed");
    const double computed =
        json_number_value(json_object_get(json_object_get(bias, "closed_form"), "value"));
    const double found =
        json_number_value(json_object_get(json_object_get(bias, "experiment"), "value"));
    CHECK_CLOSE(found, computed, 0.01 * 9.80665); /* the design's bias is some mg */
    assert_string_equal(json_string_value(json_object_get(bias, "verdict")), "agrees");
    assert_true(json_number_value(json_object_get(json_object_get(bias, "seconds"), "value")) > 0);
    assert_true(json_object_get(bias, "seconds_needed") && json_object_get(bias, "sigma"));
    json_t *band = json_object_get(figures, "noise.bias_instability"); /* there is no noise */
    assert_string_equal(json_string_value(json_object_get(band, "verdict")), "not measured");
    assert_true(json_is_null(json_object_get(band, "seconds_needed")));
    json_decref(document);
    imk_model *model = malloc(sizeof *model);
    assert_non_null(model);
    CHECK_OK(imk_model_read("m.yaml", model, NULL, NULL));
    CHECK_CLOSE(model->accel.bias.fixed.value[0], found, 1e-12);
    free(model);
    assert_int_equal(run("$I physics pendulous_servo --sweep --reduce --no-noise --level slow"), 0);
    check_contains(out, "Error model by closed forms, one axis\n", "--sweep");
    check_contains(out, "\nClosed forms against experiments\nparameter", "--sweep");
    /* half a second of each experiment tells nothing about a navigation gyro's bias */
    assert_int_equal(run("$I physics ring_laser --sweep --level slow --duration 0.5s"), 0);
    check_contains(out, "cannot tell: needs", "--duration");
    check_contains(out, "Zero in the closed forms, not told by the experiment: bias.fixed",
                   "zeros");
    assert_string_equal(err, ""); /* no progress where there is no terminal */
    sweep();
}

/* ---- pictures -------------------------------------------------------------------------------- */

/* An animation is drawn without gnuplot; it says how long a round is: of the view, or as asked. */
static void test_animation(void **state)
{
    (void)state;
    assert_int_equal(
        run("$I physics fibre_optic --animate a.svg && grep -q 'a round: 600 us' a.svg "
            "&& grep -q '<animate' a.svg"),
        0);
    assert_int_equal(
        run("$I physics tuned_gyro --view path --duration 20ms --animate b.svg && grep "
            "-q 'a round: 20 ms' b.svg && grep -q '<animateMotion' b.svg"),
        0);
    /* the view's own input, when none is asked for, is an input like any other */
    assert_int_equal(run("$I physics fibre_optic --rate '25 deg/s' --animate b.svg && cmp a.svg "
                         "b.svg"),
                     0);
    assert_int_equal(run("$I physics fibre_optic --rate '0 deg/s' --animate c.svg && cmp -s a.svg "
                         "c.svg"),
                     1);
    sweep();
}

/* The schematics of the pages are what the command draws. */
static void test_schematics(void **state)
{
    (void)state;
    for (size_t i = 0; i < imk_instrument_count(); i++) {
        const char *name = imk_instrument_get(i)->name;
        char line[1024];
        snprintf(line, sizeof line,
                 "$I physics %s --view -o a.svg && cmp a.svg " SOURCE_DIRECTORY
                 "/docs/images/schematic-%s.svg",
                 name, name);
        if (run(line) != 0)
            fail_msg("%s: %s%s: if it changed on purpose, tools/draw_images.sh schematic-%s", name,
                     out, err, name);
    }
    /* to standard output, by its name, and at the top of a report */
    assert_int_equal(run("$I physics ring_laser --view >b.svg && $I physics ring_laser --view "
                         "Schematic -o c.svg && cmp b.svg c.svg"),
                     0);
    assert_int_equal(run("$I physics ring_laser --report r.html && grep -q 'class=\"schematic\"' "
                         "r.html"),
                     0);
    /* another input, noise, length of a round and design make another drawing */
    static const char *const others[] = {"ring_laser --rate '20 deg/s'", "ring_laser --seed 2",
                                         "ring_laser --duration 1ms", "ring_laser --no-noise"};
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        char line[200];
        snprintf(line, sizeof line, "$I physics %s --view -o d.svg && cmp -s b.svg d.svg",
                 others[i]);
        if (run(line) != 1)
            fail_msg("%s: %s", others[i], err);
    }
    assert_int_equal(run("$I physics ring_laser --show | sed 's/shape: triangle/shape: square/' "
                         ">d.yaml && $I physics d.yaml --view -o d.svg && cmp -s b.svg d.svg"),
                     1);
    sweep();
}

/* Designs to look at, which the documentation draws. */
static void test_examples(void **state)
{
    (void)state;
    static const char *const names[] = {
        "binary_floated_gyro", "hemispherical", "open_fibre_optic",
        "periodic_ring_laser", "pull_in",       "sigma_delta_accelerometer",
        "slow_ring",           "split_ring",    "still_ring_laser"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        char line[1024];
        snprintf(line, sizeof line,
                 "$I physics " SOURCE_DIRECTORY "/examples/instruments/%s.yaml -d 100ms -o a.csv",
                 names[i]);
        if (run(line) != 0)
            fail_msg("%s: %s", names[i], err);
    }
    sweep();
}

static void test_pictures(void **state)
{
    (void)state;
    assert_int_equal(run("$I physics ring_laser --rate '1 deg/s' -d 100ms --plot a.svg && grep -q "
                         "'<svg' a.svg"),
                     0);
    assert_int_equal(run("$I physics ring_laser --rate '1 deg/s' --view 1 --plot b.svg && grep -q "
                         "'<svg' b.svg"),
                     0);
    assert_int_equal(run("$I physics ring_laser --rate '1 deg/s' -d 100ms --report r.html && grep "
                         "-q 'Inside the instrument' r.html && grep -q 'Reduced error model' "
                         "r.html && grep -q 'Outputs against time' r.html"),
                     0);
    /* what a design has not is left out: the bits of an open loop; a sine has its response */
    assert_int_equal(run("$I physics mems_accelerometer --report r.html && ! grep -q 'Bits of the "
                         "loop' r.html && grep -q 'Response to a step' r.html"),
                     0);
    assert_int_equal(run("$I physics pendulous_servo --acceleration '1 g' --sine 5Hz -d 1s --plot "
                         "a.svg && grep -q 'Output against input' a.svg"),
                     0);
    sweep();
}

/* ---- refusals -------------------------------------------------------------------------------- */

#define E "imukit physics: error: "

/* Each line says exactly this and leaves nothing behind. */
static void test_refusals(void **state)
{
    (void)state;
    static const struct {
        const char *line;
        int code;
        const char *message;
    } cases[] = {
        {"ring_lasr", 1,
         E "instrument: \"ring_lasr\" is not a known name; did you mean \"ring_laser\"?\n"},
        {"fog", 1, E "instrument: \"fog\" is not a known name; did you mean \"fibre_optic\"?\n"},
        {"ring_laser --single-axis", 2,
         E "--single-axis is about the model that --reduce -o MODEL.yaml writes\n" TRY("physics")},
        {"ring_laser --animate a.svg", 2,
         E "--animate: no view of the ring laser gyro shows one signal against another\n" TRY(
             "physics")},
        {"fibre_optic --animate a.png", 2,
         E "--animate a.png: expected a name ending in .svg\n" TRY("physics")},
        {"fibre_optic --view 2 --animate a.svg", 2,
         E "--animate: the view \"The ramp and its resets\" is drawn against time; only a view of "
           "one signal against another can move\n" TRY("physics")},
        {"fibre_optic --view 1 --plot a.svg --duration 1us", 2,
         E "--duration: 1e-06 s at 1e+06 points per second are no picture\n" TRY("physics")},
        {"no.yaml", 1,
         E "no.yaml: the file cannot be opened: No such file or directory; check the path\n"},
        {"--reduce", 2,
         E "an operand is missing: imukit physics [INSTRUMENT|DESIGN.yaml]; imukit physics lists "
           "the instruments\n" TRY("physics")},
        {"--list ring_laser", 2, E "--list takes no instrument\n" TRY("physics")},
        {"ring_laser --show --reduce", 2,
         E "--show prints the design and nothing else\n" TRY("physics")},
        {"ring_laser -o a.csv", 2,
         E "-o: there is no run to write; add --duration TIME\n" TRY("physics")},
        {"ring_laser --rate '1 deg/s'", 2,
         E "--rate: the length is missing; add --duration TIME\n" TRY("physics")},
        {"ring_laser --rate 10 -d 1s -o a.csv", 2,
         E "--rate 10: the unit is missing; write --rate \"10 deg/s\"\n" TRY("physics")},
        {"free_gyro --rate '1e12 deg/s' -d 50ms -o a.csv", 2,
         E "--rate 1e12 deg/s: expected at most 1e6 rad/s, which is 5.7e7 deg/s\n" TRY("physics")},
        {"ring_laser --rate '1e308 deg/s' -d 50ms -o a.csv", 2,
         E "--rate 1e308 deg/s: expected at most 1e6 rad/s, which is 5.7e7 deg/s\n" TRY("physics")},
        {"mems_accelerometer --acceleration '0 1e9 0 g' -d 50ms -o a.csv", 2,
         E "--acceleration 0 1e9 0 g: expected at most 1e6 m/s^2, which is 102000 g\n" TRY(
             "physics")},
        {"ring_laser --temperature 1e308K -d 50ms -o a.csv", 2,
         E "--temperature: expected more than absolute zero, and at most 10000 K\n" TRY("physics")},
        {"ring_laser --temperature-rate 1e4K/s -d 1min -o a.csv", 2,
         E "--temperature-rate: expected at most 10000 K/s, and to end at no more than 10000 "
           "K\n" TRY("physics")},
        {"ring_laser --rate '1 2 deg/s' -d 1s -o a.csv", 2,
         E "--rate 1 2 deg/s: there are two numbers; expected one number about x, or three, and a "
           "unit such as deg/h, deg/s or rad/s\n" TRY("physics")},
        {"ring_laser --acceleration '1 deg/s' -d 1s -o a.csv", 2,
         E "--acceleration 1 deg/s: \"1 deg/s\" is an angular rate; expected one number about x, "
           "or three, and a unit such as mg, ug, g or m/s^2\n" TRY("physics")},
        {"ring_laser --sine 5Hz -d 1s", 2,
         E "--sine is the frequency of the rate or acceleration given: add --rate or "
           "--acceleration\n" TRY("physics")},
        {"ring_laser --rate '1 deg/s' --sine 50Hz -d 1s", 2,
         E "--sine 50 Hz: the input is held over a sample of 0.01 s, and a cycle needs at least "
           "four samples; add --output-rate 200Hz or more\n" TRY("physics")},
        {"ring_laser -d 0s -o a.csv", 2, E "--duration: expected a time above 0\n" TRY("physics")},
        {"ring_laser -d 1ms -o a.csv", 2,
         E "--duration 0.001 s: shorter than a sample of 0.01 s\n" TRY("physics")},
        {"ring_laser -d 1s --reduce", 2,
         E "--duration runs the instrument and --reduce does not: leave one out\n" TRY("physics")},
        {"ring_laser --view 1", 2,
         E "--view is drawn by --plot FILE or --animate FILE: add one\n" TRY("physics")},
        {"ring_laser -d 1s --report a.pdf", 2,
         E "--report a.pdf: a report is a page, FILE.html; a browser prints it as PDF: chromium "
           "--headless --no-pdf-header-footer --print-to-pdf=FILE.pdf FILE.html\n" TRY("physics")},
        {"--view ring_laser", 2,
         E
         "--view ring_laser: the instrument stands before: imukit physics ring_laser --view\n" TRY(
             "physics")},
        {"ring_laser --view -o a.csv", 2,
         E "-o a.csv: the schematic is an SVG; expected a name ending in .svg\n" TRY("physics")},
        {"ring_laser --view --plot a.svg", 2,
         E "--view without a VIEW writes the schematic and nothing else: leave --plot out, or name "
           "a view\n" TRY("physics")},
        {"ring_laser --view --report a.html", 2,
         E "--view without a VIEW writes the schematic and nothing else: leave --report out, or "
           "--view: the page has the schematic at its top\n" TRY("physics")},
        {"ring_laser --view --duration 1s", 2,
         E "--duration: 1 s last 6.2e+03 s in the drawing, which is 6.2e+03 times as slow; "
           "expected 0.000161 s to 0.58 s\n" TRY("physics")},
        {"--view", 2,
         E "an operand is missing: imukit physics INSTRUMENT --view; imukit physics lists the "
           "instruments\n" TRY("physics")},
        {"ring_laser -d 1s --plot a.gif", 2,
         E "--plot a.gif: expected a name ending in .svg, .png or .pdf, or the word term\n" TRY(
             "physics")},
        {"ring_laser -d 1s -o a.csv --signals a.csv", 2,
         E "--output and --signals both write a.csv: give another name\n" TRY("physics")},
        {"ring_laser -d 1s -o - --json", 2,
         E "--json and --output cannot both go to standard output: give a file name\n" TRY(
             "physics")},
        {"ring_laser -d 1s --temperature '-1 K'", 2,
         E "--temperature: expected more than absolute zero, and at most 10000 K\n" TRY("physics")},
        {"ring_laser -d 1s --level fast", 2,
         E "--level fast: expected one of full|slow\n" TRY("physics")},
        {"ring_laser -d 1s --output-rat 5Hz", 2,
         E "there is no option --output-rat; did you mean --output-rate?\n" TRY("physics")},
        {"ring_laser -d 1s -o no/a.csv", 1,
         E "no/a.csv: the folder no does not exist; create this folder, or choose another\n"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        if (check_skips(i, 3))
            continue;
        char line[400];
        snprintf(line, sizeof line, "$I physics %s", cases[i].line);
        check_message(line, cases[i].code, cases[i].message);
        assert_int_equal(*out, strstr(line, "--json") ? '{' : '\0'); /* the error as JSON */
        assert_int_equal(sweep(), 0);
    }
    /* a step that would give wrong results, with the instrument's reason */
    assert_int_equal(run("$I physics ring_laser -d 1s --step 1s -o a.csv"), 1);
    check_contains(err, E "--step: \"1 s\" is outside its valid range (limit ", "--step");
    check_message("$I physics ring_laser -d 0.1s --step 1e-30s -o a.csv", 1,
                  E "--step: \"1e-30 s\" is outside its valid range (limit 1e-14 s); expected at "
                    "most 1e12 internal steps to a sample\n");
    assert_int_equal(sweep(), 0);
}

/* A millionth of the step of the default inertia, 3.88e-5 s. */
static void test_fast_designs(void **state)
{
    (void)state;
    put("d.yaml", "imukit: 1\ninstrument: pendulous_servo\npendulum: {inertia: 3e-20 kg m^2}\n");
    check_message(
        "$I physics d.yaml -d 1s -o a.csv", 1,
        E "--duration: the run of 1 s needs 2.58e+10 internal steps of 3.88e-11 s; "
          "expected at most 1e+07 (at least 8 steps to a cycle of the captured "
          "pendulum): make the design or the input slower, or the run shorter, or add --level "
          "slow\n");
    check_message("$I physics d.yaml --view 1 --plot a.svg", 1,
                  E "d.yaml: the run of 0.02 s needs 5.15e+08 internal steps of 3.88e-11 s; "
                    "expected at most 3e+06 (at least 8 steps to a cycle of the captured "
                    "pendulum): make the design or the input slower, or the run shorter\n");
    check_message("$I physics pendulous_servo -d 1s --step 1ns -o a.csv", 1,
                  E "--duration: the run of 1 s needs 1e+09 internal steps of 1e-09 s; expected at "
                    "most 1e+07: take a longer step\n");
    assert_int_equal(run("$I physics d.yaml -d 1s --level slow -o a.csv >t.txt"), 0);
    sweep();
}

/* A temperature of 1e297 degC is a number; its scatter is none. */
static void test_figures_that_are_none(void **state)
{
    (void)state;
    put("d.yaml", "imukit: 1\ninstrument: vibrating_beam\nbeam: {frequency_temperature: -2e-299 "
                  "ppm/K}\n");
    check_message("$I physics d.yaml -d 1s >t.txt", 1,
                  E "the scatter of temperature is beyond what a number can hold; bring the design "
                    "nearer to the default one, which imukit physics vibrating_beam --show "
                    "prints, or the input nearer to 0\n");
    sweep();
}

static void test_bad_designs(void **state)
{
    (void)state;
    static const char *const texts[][2] = {
        {"imukit: 1\ninstrument: ring_laser\ndither: {frequenzy: 1 Hz}\n",
         E "d.yaml:3:10: dither.frequenzy: \"frequenzy\" is not a known key; did you mean "
           "\"frequency\"?\n"},
        {"imukit: 1\ninstrument: ring_laser\ndither: {frequency: 1 m}\n",
         E "d.yaml:3:21: dither.frequency: \"1 m\" is a length; expected a frequency like Hz or "
           "kHz\n"},
        {"imukit: 1\ninstrument: ring-lazer\n",
         E "d.yaml:2:13: instrument: \"ring-lazer\" is not a known name; did you mean "
           "\"ring_laser\"?\n"},
        {"imukit: 1\ngyro: {}\n", E "d.yaml:1:1: \"instrument\" is missing; write instrument: "
                                    "NAME, with a name that imukit physics lists\n"},
    };
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        if (check_skips(i, 3))
            continue;
        put("d.yaml", texts[i][0]);
        check_message("$I physics d.yaml --reduce -o m.yaml", 1, texts[i][1]);
        assert_int_equal(sweep(), 1); /* the design itself */
    }
    put("d.yaml", "imukit: 1\ninstrument: rate_gyro\nspring: {stiffness: 8e-302 N m/rad}\n"
                  "torque: {fixed: 0 N m}\n");
    check_message("$I physics d.yaml --reduce", 1,
                  E "d.yaml:3:21: spring.stiffness: \"8e-302 N*m/rad\" is in conflict; "
                    "nonlinearity.k2 of the error model is not finite with this value: bring it "
                    "nearer to that of the default design\n");
    put("d.yaml", "imukit: 1\ninstrument: ring_laser\ncavity: {perimeter: -1 m}\n");
    assert_int_equal(run("$I physics d.yaml -d 1s -o a.csv"), 1);
    check_contains(err,
                   E "d.yaml:3:21: cavity.perimeter: \"-1 m\" is outside its valid range; expected "
                     "at least",
                   "range");
    assert_int_equal(sweep(), 1);
}

/* A verb that wants a model says how to make one of a design. */
static void test_design_for_a_model(void **state)
{
    (void)state;
    put("d.yaml", "imukit: 1\ninstrument: ring_laser\n");
    check_message("$I grade d.yaml", 1,
                  "imukit grade: error: d.yaml is the design of an instrument, not a model; its "
                  "error model:\n  imukit physics d.yaml --reduce -o MODEL.yaml\n");
    check_message("$I grade ring_laser", 1,
                  "imukit grade: error: ring_laser is an instrument, not a model; the error model "
                  "of its default design:\n  imukit physics ring_laser --reduce -o MODEL.yaml\n");
    sweep();
}

/* The first samples, in which the loop catches the rotor, would make a flat line of the others:
 * they are told beside the figure. A run at rest has none of that kind. With more samples than
 * points, the band holds them. */
static void test_points_beyond_the_axis(void **state)
{
    (void)state;
    assert_int_equal(run("$I physics tuned_gyro --rate '10 deg/s' -d 10s --plot t.svg && grep -o "
                         "'[0-9]* of 1000 points are beyond\\|from 0.01 to 0.02 s"
                         "' t.svg"),
                     0);
    check_contains(out, "2 of 1000 points are beyond\nfrom 0.01 to 0.02 s\n", "figure");
    assert_int_equal(
        run("$I physics rate_gyro -d 10s --plot r.svg && ! grep 'beyond\\|0\\.18' r.svg"), 0);
    assert_int_equal(run("$I physics rate_gyro -d 100s --plot r.svg && grep -q '\"0\\.18' r.svg"),
                     0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_points_beyond_the_axis),
        cmocka_unit_test(test_list),
        cmocka_unit_test(test_every_instrument),
        cmocka_unit_test(test_log),
        cmocka_unit_test(test_one_sample),
        cmocka_unit_test(test_sine),
        cmocka_unit_test(test_same_bytes),
        cmocka_unit_test(test_temperature_and_signals),
        cmocka_unit_test(test_told_temperature),
        cmocka_unit_test(test_levels_and_warnings),
        cmocka_unit_test(test_touch_down),
        cmocka_unit_test(test_scatter),
        cmocka_unit_test(test_reduce),
        cmocka_unit_test(test_derived),
        cmocka_unit_test(test_sweep),
        cmocka_unit_test(test_animation),
        cmocka_unit_test(test_schematics),
        cmocka_unit_test(test_examples),
        cmocka_unit_test(test_pictures),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_fast_designs),
        cmocka_unit_test(test_figures_that_are_none),
        cmocka_unit_test(test_bad_designs),
        cmocka_unit_test(test_design_for_a_model),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
