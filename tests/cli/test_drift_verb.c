/* SPDX-License-Identifier: Apache-2.0 */
/* imukit drift: its figures against independent ones, its answers applied and asked again, its
 * campaigns in parts, its messages. */
#include "run_command.h"

#include <math.h>

static const double mile = 1852;

/* Biases at the limits of the table of classes, and nothing else. */
static const char limits[] = "imukit: 1\nname: limits\n"
                             "gyro: {bias: {repeatability: 0.01 deg/h}, " NO_OTHER_GYRO_TERM "}\n"
                             "accel: {bias: {repeatability: 50 ug}, " NO_OTHER_ACCEL_TERM "}\n";

static json_t *document;

/* The result of a line that prints JSON. */
static json_t *result_of(const char *line)
{
    json_error_t problem;
    if (run(line) != 0)
        fail_msg("%s: %s", line, err);
    document = json_loads(out, 0, &problem);
    if (!document)
        fail_msg("%s: %s", problem.text, out);
    return json_object_get(document, "result");
}

static json_t *case_of(json_t *result, size_t index)
{
    return json_array_get(json_object_get(result, "models"), index);
}

static double value_of(json_t *quantity)
{
    return json_number_value(json_object_get(quantity, "value"));
}

static double figure(json_t *one, size_t row, const char *name)
{
    json_t *time = json_array_get(json_object_get(one, "times"), row);
    return value_of(json_object_get(json_object_get(time, "figures"), name));
}

/* ---- figures ---------------------------------------------------------------------------------
 */

/* Independent arithmetic on a sphere (models.md's table: CEP and DRMS of biases alone); the
 * ellipsoid differs by 1.5 % at most, the printed digits by 1 %. */
static void test_table_of_classes(void **state)
{
    (void)state;
    static const double cep[] = {1.04, 0.895 * 1852, 6.90 * 1852},
                        drms[] = {1.25, 1.08 * 1852, 10.2 * 1852};
    put("limits.yaml", limits);
    json_t *one = case_of(result_of("$I drift limits.yaml --times 1min,1h,24h --json"), 0);
    assert_string_equal(err, "");
    for (size_t row = 0; row < 3; row++) {
        if (check_skips(row, 3))
            continue;
        CHECK_RELATIVE(figure(one, row, "cep"), cep[row], 0.03);
        CHECK_RELATIVE(figure(one, row, "drms"), drms[row], 0.03);
    }
    json_decref(document);
    sweep();
}

/* The claims of the presets: CEP by the computation of tests/model/test_position_claims.c, as
 * docs/choose-a-sensor.md prints them. */
static void test_presets(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double minute, hour;
    } known[] = {{"strategic", 0.071, 0.056}, {"navigation", 0.86, 0.71}, {"tactical", 17, 80}};
    json_t *result = result_of("$I drift strategic navigation tactical --times 1min,1h --json");
    for (size_t m = 0; m < 3; m++) {
        json_t *one = case_of(result, m);
        assert_string_equal(json_string_value(json_object_get(one, "model")), known[m].name);
        CHECK_RELATIVE(figure(one, 0, "cep"), known[m].minute, 0.04);
        CHECK_RELATIVE(figure(one, 1, "cep"), known[m].hour * mile, 0.04);
    }
    json_decref(document);
}

/* Bias instability alone costs the same at every rate, and less with a shorter correlation time:
 * 24.43 km after 1 h is that of 0.1 deg/h and 30 ug by the stages of tests/model/horizontal_error.h
 * on the ellipsoid, as of 2 % for the difference to its sphere. With the times of the stages tied
 * to the sample interval it would be 21 and 25 % more at 1 Hz than at 100 Hz. */
static void test_bias_instability_at_any_rate(void **state)
{
    (void)state;
#define UNIT(time)                                                                                 \
    "imukit: 1\ngyro: {noise: {bias_instability: 0.1 deg/h" time "}}\n"                            \
    "accel: {noise: {bias_instability: 30 ug" time "}}\n"
    put("b.yaml", UNIT(""));
    put("short.yaml", UNIT(", bias_instability_correlation_time: 2000 s"));
    static const char *const rates[] = {"100Hz", "1Hz", "8000Hz"};
    double first[3] = {0, 0, 0};
    for (int i = 0; i < 3; i++) {
        char line[100];
        snprintf(line, sizeof line, "$I drift b.yaml --times 1min,1h,24h --rate %s --json",
                 rates[i]);
        json_t *one = case_of(result_of(line), 0);
        for (size_t row = 0; row < 3; row++) {
            const double cep = figure(one, row, "cep");
            first[row] = i == 0 ? cep : first[row];
            CHECK_RELATIVE(cep, first[row], 1e-3);
        }
        json_decref(document);
    }
    CHECK_RELATIVE(first[1], 24430, 0.02);
    json_t *one = case_of(result_of("$I drift short.yaml --times 1h --json"), 0);
    CHECK_BELOW(figure(one, 0, "cep"), 0.8 * first[1]);
    json_decref(document);
    sweep();
}

/* Shares add up to the whole, the largest first; without known values the mean is 0. */
static void test_budget(void **state)
{
    (void)state;
    json_t *one =
        case_of(result_of("$I drift navigation -d 2h --without misalignment,k2 --json"), 0);
    json_t *budget = json_object_get(one, "budget"), *line;
    double sum = 0, before = 1;
    size_t index;
    assert_true(json_array_size(budget) > 5);
    json_array_foreach(budget, index, line)
    {
        const double share = json_number_value(json_object_get(line, "share"));
        CHECK_BELOW(share, before);
        CHECK_CLOSE(value_of(json_object_get(line, "mean_north")), 0.0, 0.0);
        before = share;
        sum += share;
    }
    CHECK_CLOSE(sum, 1.0, 1e-12);
    assert_string_equal(json_string_value(json_object_get(json_array_get(budget, 0), "source")),
                        "gyro.bias.repeatability");
    json_decref(document);
}

/* Values that are known shift, and are gone after calibration but for their sigma: 1 deg/h +- 0.01
 * leaves a hundredth, to 2 % (the ratio of a mean and a CEP is that of a line). */
static void test_compensated(void **state)
{
    (void)state;
    put("fixed.yaml", "imukit: 1\nname: fixed\n"
                      "gyro: {bias: {fixed: 0 1 0 ± 0 0.01 0 deg/h}}\naccel: {}\n");
    json_t *result = result_of("$I drift fixed.yaml --times 1h --compensated --json");
    json_t *before = case_of(result, 0), *after = case_of(result, 1);
    assert_true(json_is_false(json_object_get(before, "compensated")));
    assert_true(json_is_true(json_object_get(after, "compensated")));
    CHECK_RELATIVE(figure(before, 0, "cep"), figure(before, 0, "drms"), 1e-9);
    CHECK_RELATIVE(figure(after, 0, "drms"), 0.01 * figure(before, 0, "drms"), 1e-9);
    CHECK_RELATIVE(figure(after, 0, "cep"), 0.674490 * figure(after, 0, "drms"), 0.02);
    json_decref(document);
    assert_int_equal(run("$I drift fixed.yaml --times 1h --compensated"), 0);
    check_contains(out, "CEP before", "columns");
    check_contains(out, "known value", "the shift");
    sweep();
}

/* Beyond the Earth's size nothing is printed as a position. */
static void test_no_position(void **state)
{
    (void)state;
    check_message("$I drift tactical -d 24h", 0,
                  "imukit drift: warning: tactical: at 8 h the error exceeds a tenth of the "
                  "Earth's radius: this is no longer a position\n");
    check_contains(out, "no position", "24 h");
    check_contains(out, "Contributions after 4 h", "the last that is one");
    assert_null(strstr(out, "1 d          "));
}

/* ---- the inverse question --------------------------------------------------------------------
 */

/* A model of one term: what it must become, put into the model, meets the goal; three digits are
 * printed. */
static void test_requirement(void **state)
{
    (void)state;
    char model[300], value[40];
    static const char form[] = "imukit: 1\nname: one\ngyro: {bias: {repeatability: %s}}\n"
                               "accel: {}\n";
    snprintf(model, sizeof model, form, "0.1 deg/h");
    put("one.yaml", model);
    assert_int_equal(run("$I drift one.yaml --want 'CEP 1 nmi @ 1h'"), 0);
    check_contains(out, "Not met", "verdict");
    const char *line = strstr(out, "must become"), *begin = line ? strstr(line, "0.1 deg/h") : NULL;
    assert_non_null(begin);
    begin += strlen("0.1 deg/h");
    begin += strspn(begin, " ");
    snprintf(value, sizeof value, "%.*s", (int)(strstr(begin, "deg/h") + 5 - begin), begin);
    snprintf(model, sizeof model, form, value);
    put("one.yaml", model);
    json_t *result = result_of("$I drift one.yaml --want 'CEP 1 nmi @ 1h' --json");
    CHECK_RELATIVE(figure(case_of(result, 0),
                          json_array_size(json_object_get(case_of(result, 0), "times")) - 1, "cep"),
                   mile, 0.006);
    json_decref(document);
    sweep();
}

/* Devices that would do are those whose own CEP is small enough. */
static void test_devices(void **state)
{
    (void)state;
    json_t *want =
        json_object_get(result_of("$I drift tactical --want 'CEP 1 nmi @ 1h' --json"), "want");
    json_t *devices = json_object_get(want, "devices"), *device;
    size_t index, met = 0, bounds = 0;
    double navigation = 0;
    json_array_foreach(devices, index, device)
    {
        const double cep = value_of(json_object_get(device, "figure"));
        const bool meets = json_is_true(json_object_get(device, "meets"));
        /* A lower bound meets nothing. */
        const bool least = json_is_true(json_object_get(device, "lower_bound"));
        assert_true(meets == (cep <= mile && !least));
        assert_true(least == (json_array_size(json_object_get(device, "unstated")) > 0));
        met += meets;
        bounds += cep <= mile && least;
        if (strcmp(json_string_value(json_object_get(device, "name")), "navigation") == 0)
            navigation = cep;
    }
    assert_true(met >= 2 && met < json_array_size(devices) / 2);
    assert_true(bounds >= 1);
    json_decref(document);
    json_t *one = case_of(result_of("$I drift navigation --times 1h --json"), 0);
    CHECK_RELATIVE(figure(one, 0, "cep"), navigation, 1e-9);
    json_decref(document);
    check_message("$I drift navigation --want 'R95 10 km @ 1h'", 0, "");
    check_contains(out, "Wanted: R95 10.0 km after 1 h. Met:", "verdict");
    /* 1e18 times smaller is beyond what the search tells */
    assert_int_equal(run("$I drift control --want 'CEP 1e-9 m @ 8h' 2>/dev/null"), 0);
    check_contains(out, "too small to tell", "a requirement of a nanometre");
    assert_null(strstr(out, "inf times"));
}

/* ---- runs ------------------------------------------------------------------------------------
 */

/* Parts of a campaign put together are the campaign, byte for byte, with any number of threads; and
 * the statistics of the file are those that were printed. */
static void test_campaign(void **state)
{
    (void)state;
    char table[4000];
    assert_int_equal(run("$I drift navigation --times 10s,1min -r 10Hz -n 30 --threads 1 -o a.h5"),
                     0);
    assert_string_equal(err, "");
    const char *begin = strstr(out, "runs  CEP"), *end = strstr(out, "\n\nruns / cov");
    assert_non_null(begin);
    assert_non_null(end);
    snprintf(table, sizeof table, "%.*s", (int)(end - begin), begin);
    assert_int_equal(run("for i in 1 2 3; do $I drift navigation --times 10s,1min -r 10Hz -n 30 "
                         "--shard $i/3 -o p$i.h5 || exit 1; done; $I merge p?.h5 -o b.h5 && "
                         "cmp a.h5 b.h5"),
                     0);
    assert_int_equal(run("$I drift a.h5"), 0);
    check_contains(out, table, "statistics of the file");
    assert_int_equal(run("$I drift p2.h5"), 0);
    check_contains(out, "10 of 30 runs, from run 10 on", "a part");
    sweep();
}

/* Names, comments and the way numbers are written make no other campaign; another setting does. */
static void test_parameters(void **state)
{
    (void)state;
    put("a.yaml", limits);
    put("b.yaml", "# the same\nimukit: 1\nname: other\ndescription: other\n"
                  "gyro:\n  bias:\n    repeatability: 0.010 deg/h\n"
                  "  evidence: {source: a guess}\naccel: {bias: {repeatability: 0.05 mg}}\n");
    assert_int_equal(run("$I drift a.yaml --times 10s -r 10Hz -n 4 -o a.h5 && "
                         "$I drift b.yaml --times 10s -r 10Hz -n 4 -o b.h5 && cmp a.h5 b.h5"),
                     0);
    assert_int_equal(run("$I drift a.yaml --times 10s -r 10Hz -n 4 --yaw 1deg -o c.h5"), 0);
    assert_int_equal(run("cmp -s a.h5 c.h5"), 1);
    assert_int_equal(run("$I merge a.h5 c.h5 -o d.h5; true"), 0);
    check_contains(err, "c.h5", "a file of another campaign is named");
    sweep();
}

/* 500 runs of biases alone: at 10 min everything is linear. The standard deviations are 5 % of a
 * CEP at most (that of a line, sqrt(n)/(2 n f(r) r)), 3.2 % of a root mean square at most,
 * 1/sqrt(2 n); five of them are a false alarm of 6e-7 each. */
static void test_monte_carlo(void **state)
{
    (void)state;
    put("limits.yaml", limits);
    json_t *result = result_of("$I drift limits.yaml --times 10min -r 2Hz -n 500 --json");
    json_t *runs =
        json_array_get(json_object_get(json_object_get(result, "monte_carlo"), "times"), 0);
    json_t *found = json_object_get(runs, "figures"), *one = case_of(result, 0);
    assert_int_equal(json_integer_value(json_object_get(runs, "runs")), 500);
    CHECK_RELATIVE(value_of(json_object_get(found, "cep")), figure(one, 0, "cep"), 0.26);
    CHECK_RELATIVE(value_of(json_object_get(found, "velocity")), figure(one, 0, "velocity"), 0.16);
    CHECK_RELATIVE(value_of(json_object_get(found, "heading")), figure(one, 0, "heading"), 0.16);
    json_decref(document);
    /* Of a few runs the 95 % intervals alone say nothing against the linear theory. */
    for (int seed = 1; seed <= 10; seed++) {
        if (check_skips((size_t)seed, 5))
            continue;
        char line[160];
        snprintf(line, sizeof line,
                 "$I drift limits.yaml --duration 10s -r 2Hz -n 8 --seed %d >/dev/null", seed);
        assert_int_equal(run(line), 0);
        assert_string_equal(err, "");
    }
    sweep();
}

/* ---- files -----------------------------------------------------------------------------------
 */

static void test_files(void **state)
{
    (void)state;
    assert_int_equal(run("$I drift navigation tactical -d 1h -o a.csv --report a.html"), 0);
    assert_int_equal(run("head -2 a.csv"), 0);
    check_contains(out, "model,source,time [s],cep [m],r95 [m],drms [m]", "header");
    check_contains(out, "\"navigation\",total,10,", "first row");
    assert_int_equal(run("grep -c 'gyro.bias.repeatability,3600,' a.csv"), 0);
    assert_string_equal(out, "2\n");
    assert_int_equal(run("grep -q 'Comparison' a.html"), 0);
    assert_int_equal(run("$I drift navigation --compensated --plot a.svg && grep -q svg a.svg"), 0);
    if (imk_plot_available("term")) {
        assert_int_equal(run("$I drift navigation -d 1h --plot term"), 0);
        check_contains(out, "Horizontal error", "term");
    }
    sweep();
}

static void test_motion(void **state)
{
    (void)state;
    put("car.yaml", "imukit_motion: 1\nname: a drive\n"
                    "start: {latitude: 48 deg, longitude: 11 deg, height: 500 m, heading: 90 deg}\n"
                    "steps:\n  - hold 10 s\n  - accelerate to 15 m/s at 2 m/s^2\n  - hold 20 s\n"
                    "  - stop at 3 m/s^2\n");
    assert_int_equal(run("$I drift navigation --motion car.yaml --aligned self --align-time 60s"),
                     0);
    check_contains(out, "on car.yaml; attitude found by the unit itself", "title");
    assert_int_equal(run("$I drift tactical -m car.yaml -r 20Hz -n 9 --times 10s,20s -o a.h5 && "
                         "$I drift a.h5 --json"),
                     0);
    check_contains(out, "a drive", "the script is in the results");
    check_message("$I drift tactical --motion car.yaml -d 1h", 2,
                  "imukit drift: error: 3600 s: the motion ends after 43.5 s (or let it end with "
                  "`then: hold`)\n" TRY("drift"));
    sweep();
}

/* ---- messages --------------------------------------------------------------------------------
 */

static void test_messages(void **state)
{
    (void)state;
    static const struct {
        const char *line, *message;
    } wrong[] = {
        {"$I drift tactical --want 'CEP 1 nmi'",
         "--want \"CEP 1 nmi\": the time is missing; write --want \"CEP 1 nmi @ 1h\""},
        {"$I drift tactical --want 'CPE 1 nmi @ 1h'",
         "--want \"CPE 1 nmi @ 1h\": \"CPE\" is not a figure (did you mean CEP?); expected CEP, "
         "R95, DRMS, height, velocity, tilt or heading; write --want \"CEP 1 nmi @ 1h\""},
        {"$I drift tactical --want 'CEP 1e-30 nmi @ 1h'",
         "--want \"CEP 1e-30 nmi @ 1h\": expected a figure from 1e-9 to 1e9 m; write --want \"CEP "
         "1 nmi @ 1h\""},
        {"$I drift tactical --times 1min,foo",
         "--times \"1min,foo\": \"foo\" is not a positive time with a unit; write --times \"1min, "
         "10min, 1h\""},
        {"$I drift tactical --latitude 91deg", "--latitude 91deg: expected -90deg to 90deg"},
        {"$I drift tactical --height 200km", "--height 200km: expected -10000m to 100000m"},
        {"$I drift tactical --rate 1GHz", "--rate 1e+09 Hz: expected 0.001 Hz to 1 MHz"},
        {"$I drift tactical --duration 30000h",
         "--duration 1.08e+08 s: expected at most three years (1e8 s)"},
        {"$I drift tactical --aligned self --align-time 0s",
         "--align-time 0 s: expected 1 s to 1e7 s"},
        {"$I drift tactical --align-time 10s",
         "--align-time is for --aligned self; add that option"},
        {"$I drift tactical navigation -n 10", "--monte-carlo takes one model at a time"},
        {"$I drift tactical -n 10 --shard 4/3 -o a.h5",
         "--shard 4/3: expected I/N, such as 3/10: the third of ten parts"},
        {"$I drift tactical -n 10 --shard 1/18446744073709551616 -o a.h5",
         "--shard 1/18446744073709551616: expected at most 4294967295 parts"},
        {"$I drift tactical -n 10 --shard 1/3",
         "--shard makes a part for imukit merge: add -o PART.h5"},
        {"$I drift tactical -o a.h5", "-o a.h5: figures against time are written as .csv; .h5 is "
                                      "for runs: add --monte-carlo 1000"},
        {"$I drift tactical --initial-attitude '1 2 deg'",
         "--initial-attitude \"1 2 deg\": expected one or three numbers (north, east, down) that "
         "are not negative, with a unit such as deg"},
        {"$I drift tactical --initial-attitude '1e20 deg'",
         "--initial-attitude \"1e20 deg\": expected at most 5.73e+10 deg"},
        {"$I drift tactical --yaw 1e20deg", "--yaw 1e20deg: expected -36000deg to 36000deg"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        if (check_skips(i, 3))
            continue;
        char message[600];
        snprintf(message, sizeof message, "imukit drift: error: %s\n" TRY("drift"),
                 wrong[i].message);
        check_message(wrong[i].line, 2, message);
    }
    check_message("$I drift tactical --latitude 89.9deg --aligned self", 1,
                  "imukit drift: error: alignment: two settings exclude each other; expected a "
                  "given attitude: a unit within 1 deg of a pole finds no north\n");
    assert_int_equal(sweep(), 0);
}

/* What the linear theory leaves out is said. */
static void test_omitted(void **state)
{
    (void)state;
    put("band.yaml", "imukit: 1\nname: band\ngyro: {dead_band: 0.1 deg/h}\naccel: {}\n");
    check_message("$I drift band.yaml --only dead_band -d 1min", 0,
                  "imukit drift: warning: band.yaml: the linear theory leaves out gyro.dead_band; "
                  "--monte-carlo includes everything that needs no temperature\n");
    sweep();
}

/* ---- what is not stated ---------------------------------------------------------------------- */

static json_t *term_of(json_t *list, const char *sensor, const char *key)
{
    json_t *term;
    size_t i;
    json_array_foreach(list, i, term)
    {
        if (strcmp(json_string_value(json_object_get(term, "sensor")), sensor) == 0 &&
            strcmp(json_string_value(json_object_get(term, "key")), key) == 0)
            return term;
    }
    return NULL;
}

/* Share of one of two constants of the same column is that of their squares: 0.8 deg/h, which the
 * tactical preset has, beside 0.3 deg/h that is stated (models of the same class, no other term).
 */
static void test_unstated(void **state)
{
    (void)state;
    put("a.yaml", "imukit: 1\ngyro: {bias: {fixed: 0 0 0 ± 0.3 deg/h}, " NO_OTHER_GYRO_TERM "}\n"
                  "accel: {bias: {repeatability: 0.8 mg}, " NO_OTHER_ACCEL_TERM "}\n");
    json_t *one = case_of(result_of("$I drift a.yaml -d 1h --json"), 0);
    json_t *list = json_object_get(one, "unstated");
    assert_true(json_is_true(json_object_get(one, "lower_bound")));
    assert_int_equal(json_array_size(list), 1);
    json_t *bias = term_of(list, "gyro", "bias.repeatability");
    assert_non_null(bias);
    assert_string_equal(json_string_value(json_object_get(bias, "class")), "tactical");
    json_t *typical = json_object_get(bias, "typical"); /* 0.8 deg/h */
    CHECK_RELATIVE(value_of(typical), 0.8 / 3600 * 3.14159265358979323846 / 180, 1e-12);
    assert_string_equal(json_string_value(json_object_get(typical, "unit")), "rad/s");
    check_contains(err,
                   "a.yaml: the figures are lower bounds, because the model does not state gyro "
                   "run-to-run bias;",
                   err);
    json_decref(document);
    assert_int_equal(run("$I drift a.yaml -d 1h --want 'CEP 1e6 m @ 1h' 2>/dev/null"), 0);
    check_contains(out, "Met at best: the figure is ", out);
    /* The tactical preset's bias of 0.8 deg/h stated: nothing is missing, and the figures are those
     * of the assumption. */
    json_t *assumed = case_of(result_of("$I drift a.yaml -d 1h --assume-class tactical --json"), 0);
    assert_string_equal(err, "");
    assert_true(json_is_false(json_object_get(assumed, "lower_bound")));
    assert_int_equal(json_array_size(json_object_get(assumed, "assumed")), 1);
    const double cep = figure(assumed, 4, "cep");
    json_decref(document);
    put("b.yaml", "imukit: 1\ngyro: {bias: {repeatability: 0.8 deg/h}, " NO_OTHER_GYRO_TERM "}\n"
                  "accel: {bias: {repeatability: 0.8 mg}, " NO_OTHER_ACCEL_TERM "}\n");
    json_t *stated = case_of(result_of("$I drift b.yaml -d 1h --json"), 0);
    CHECK_RELATIVE(figure(stated, 4, "cep"), cep, 1e-9);
    json_decref(document);
    sweep();
}

/* A scale factor is missed where the motion turns, and not at rest: 150 ppm of 90 deg are 49
 * arcsec, beside 0.8 deg/h times 20 s, 16 arcsec; at rest 150 ppm of the Earth's rate are 0.002
 * deg/h. */
static void test_unstated_on_a_motion(void **state)
{
    (void)state;
    put("turn.yaml", "imukit_motion: 1\nname: a turn\n"
                     "start: {latitude: 48 deg, longitude: 11 deg, height: 500 m, heading: 0 deg}\n"
                     "steps:\n  - hold 5 s\n  - accelerate to 5 m/s at 1 m/s^2\n"
                     "  - turn left 90 deg at 15 deg/s\n  - hold 4 s\n");
    put("a.yaml", "imukit: 1\ngyro: {bias: {repeatability: 0.8 deg/h}, misalignment: 0 mrad}\n"
                  "accel: {bias: {repeatability: 0.8 mg}, misalignment: 0 mrad}\n");
    json_t *one = case_of(result_of("$I drift a.yaml -m turn.yaml -r 20Hz --json"), 0);
    assert_non_null(
        term_of(json_object_get(one, "unstated"), "gyro", "scale_factor.repeatability"));
    json_decref(document);
    one = case_of(result_of("$I drift a.yaml -d 20s -r 20Hz --json"), 0);
    assert_null(term_of(json_object_get(one, "unstated"), "gyro", "scale_factor.repeatability"));
    json_decref(document);
    sweep();
}

/* One log at rest shows nothing of what differs between logs. */
static void test_unstated_of_a_static_log(void **state)
{
    (void)state;
    assert_int_equal(run("$I simulate tactical -r 10Hz -d 10min -o a.csv && "
                         "$I identify a.csv -o a.yaml >/dev/null"),
                     0);
    json_t *one = case_of(result_of("$I drift a.yaml -d 1h --json"), 0);
    assert_non_null(term_of(json_object_get(one, "unstated"), "gyro", "bias.repeatability"));
    assert_non_null(term_of(json_object_get(one, "unstated"), "accel", "bias.repeatability"));
    json_decref(document);
    assert_int_equal(run("$I grade a.yaml"), 0);
    check_contains(out, "a: at best ", out);
    sweep();
}

/* ---- aids ------------------------------------------------------------------------------------ */

/* Times count from the end of the aids; data names the aids; what is asked without aids, or without
 * their end, is refused with what to add. */
static void test_aids(void **state)
{
    (void)state;
    json_t *result = result_of(
        "$I drift tactical --rate 20Hz --aid \"gnss position 1 m, velocity 0.05 m/s at 1 Hz until "
        "40 s\" --aid \"odometer 0.1 m/s\" --outage 10s,30s --initial-attitude \"0.1 deg\" "
        "--monte-carlo 16 --json");
    json_t *inputs = json_object_get(document, "inputs");
    assert_int_equal(json_array_size(json_object_get(inputs, "aids")), 3);
    CHECK_CLOSE(value_of(json_object_get(inputs, "outage")), 40.0, 0.0);
    json_t *times = json_object_get(case_of(result, 0), "times");
    assert_int_equal(json_array_size(times), 3);
    const double row[3] = {40.0, 50.0, 70.0};
    for (size_t k = 0; k < 3; k++)
        CHECK_CLOSE(value_of(json_object_get(json_array_get(times, k), "time")), row[k], 1e-12);
    assert_true(figure(case_of(result, 0), 2, "cep") > 2 * figure(case_of(result, 0), 0, "cep"));
    assert_non_null(json_object_get(json_array_get(times, 2), "believed"));
    json_t *runs = json_object_get(json_object_get(result, "monte_carlo"), "times");
    json_t *nees = json_object_get(json_array_get(runs, 0), "nees");
    assert_int_equal(json_integer_value(json_object_get(nees, "degrees_of_freedom")), 9);
    assert_true(json_number_value(json_object_get(nees, "mean")) > 3.0 &&
                json_number_value(json_object_get(nees, "mean")) < 20.0);
    json_decref(document);
    static const struct {
        const char *line, *message;
    } wrong[] = {
        {"$I drift tactical --outage 60s", "add --aid"},
        {"$I drift tactical --aid \"position 1 m\" --outage 60s", "no --aid ends"},
        {"$I drift tactical --aid \"position 1 m\" --want \"CEP 5 m after 60 s\"", "no --aid ends"},
        {"$I drift tactical --aid \"positon 1 m\"", "did you mean position?"},
        {"$I drift tactical --aid \"position 1 m at 1 Hz until 60 s\" --outage 60s --times 1s",
         "leave --times out"},
        {"$I drift tactical --aid \"position 1 m at 200 Hz\" --duration 10s",
         "once a sample, and --rate is 100 Hz"},
        {"$I drift tactical --gains retuned", "--want"},
        {"$I drift tactical --filter-model navigation", "add --aid"},
    };
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
        assert_true(run(wrong[k].line) != 0);
        if (!strstr(err, wrong[k].message))
            fail_msg("%s: %s", wrong[k].line, err);
    }
    sweep();
}

/* --only asks what a term does in the filter of the whole model, so that what the filter believes
 * is that of the whole model; the figure is less than that of all terms. */
static void test_only_with_aids(void **state)
{
    (void)state;
#define AIDED                                                                                      \
    "$I drift tactical --rate 20Hz --aid \"position 1 m, velocity 0.05 m/s at 1 Hz until 40 s\" "  \
    "--outage 10s --initial-attitude \"0.1 deg\" --json"
    static const char *const line[] = {AIDED, AIDED " --only gyro.misalignment",
                                       AIDED " --only gyro.misalignment --filter-model tactical",
                                       AIDED " --without gyro.noise"};
    double cep[4], believed[4];
    for (size_t k = 0; k < 4; k++) {
        json_t *one = case_of(result_of(line[k]), 0);
        json_t *last = json_array_get(json_object_get(one, "times"), 1);
        cep[k] = figure(one, 1, "cep");
        believed[k] = value_of(json_object_get(json_object_get(last, "believed"), "cep"));
        json_decref(document);
    }
    assert_true(believed[0] > 0.0 && cep[1] < cep[0] && cep[3] < cep[0]);
    for (size_t k = 1; k < 4; k++)
        CHECK_RELATIVE(believed[k], believed[0], 1e-12);
    CHECK_RELATIVE(cep[1], cep[2], 1e-12);
    sweep();
}

/* A filter made for a much better sensor believes itself better than it is, and this is said; of a
 * filter that knows all errors nothing is said. */
static void test_inconsistent(void **state)
{
    (void)state;
#define RUNS                                                                                       \
    " --rate 20Hz --aid \"position 1 m, velocity 0.05 m/s at 1 Hz until 40 s\" --outage 10s "      \
    "--initial-attitude \"0.1 deg\" --monte-carlo 32"
    assert_int_equal(run("$I drift tactical" RUNS " --filter-model navigation"), 0);
    check_contains(err, "the filter believes itself better than it is (NEES ", err);
    assert_int_equal(run("$I drift tactical" RUNS " --only bias.repeatability,"
                         "gyro.angle_random_walk,accel.velocity_random_walk"),
                     0);
    assert_null(strstr(err, "believes itself"));
    assert_null(strstr(out, "starts without error"));
    assert_int_equal(run("$I drift tactical --rate 20Hz --aid \"position 1 m\" --times 5s"), 0);
    check_contains(out, "starts without error; --initial-attitude", out);
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_table_of_classes),
        cmocka_unit_test(test_presets),
        cmocka_unit_test(test_bias_instability_at_any_rate),
        cmocka_unit_test(test_budget),
        cmocka_unit_test(test_compensated),
        cmocka_unit_test(test_no_position),
        cmocka_unit_test(test_requirement),
        cmocka_unit_test(test_devices),
        cmocka_unit_test(test_campaign),
        cmocka_unit_test(test_parameters),
        cmocka_unit_test(test_monte_carlo),
        cmocka_unit_test(test_files),
        cmocka_unit_test(test_motion),
        cmocka_unit_test(test_aids),
        cmocka_unit_test(test_inconsistent),
        cmocka_unit_test(test_only_with_aids),
        cmocka_unit_test(test_messages),
        cmocka_unit_test(test_omitted),
        cmocka_unit_test(test_unstated),
        cmocka_unit_test(test_unstated_on_a_motion),
        cmocka_unit_test(test_unstated_of_a_static_log),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
