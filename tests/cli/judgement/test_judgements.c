/* SPDX-License-Identifier: Apache-2.0 */
/* The sentence that each verb begins with: one log or model that deserves a good one, and one that
 * does not. The verdicts of identify and calibrate have tests of their own
 * (test_identify_words.c, test_calibrate_verdict.c). */
#include "cli/run_command.h"

/* The first line that a command prints, on standard output or, where a log goes there, on standard
 * error; warnings before it are passed over. */
static const char *first_line(const char *line)
{
    static char text[1000];
    run(line);
    const char *begin = out[0] ? out : err;
    while (strncmp(begin, "imukit ", 7) == 0 && strchr(begin, '\n'))
        begin = strchr(begin, '\n') + 1;
    snprintf(text, sizeof text, "%.*s", (int)strcspn(begin, "\n"), begin);
    return text;
}

static void check_begins(const char *line, const char *sentence)
{
    const char *first = first_line(line);
    if (strncmp(first, sentence, strlen(sentence)) != 0 || first[strlen(first) - 1] != '.')
        fail_msg("%s\n  begins:   %s\n  expected: %s", line, first, sentence);
}

/* The sentence of the JSON. */
static void check_json(const char *line, const char *sentence)
{
    run(line);
    json_t *document = json_loads(out, JSON_REJECT_DUPLICATES, NULL);
    json_t *usability = json_object_get(json_object_get(document, "result"), "usability");
    const char *found = json_string_value(json_object_get(usability, "sentence"));
    if (!found || strncmp(found, sentence, strlen(sentence)) != 0)
        fail_msg("%s\n  says:     %s\n  expected: %s", line, found ? found : out, sentence);
    json_decref(document);
}

static void make_rest(void)
{
    assert_int_equal(run("$I simulate AHRS --rate 100Hz --duration 1min -o rest.csv"), 0);
}

/* A log at rest, one without units, one that moves, a beginning of three rows. */
static void test_logs(void **state)
{
    (void)state;
    make_rest();
    check_begins("$I info rest.csv",
                 "Usable for identify: the sensor is at rest, for 60 s at 100 Hz.");
    check_begins("sed '1s/ \\[[^]]*\\]//g' rest.csv >bare.csv; $I info bare.csv",
                 "Not usable as it is: units or times are missing");
    check_begins("sed 500,600d rest.csv >gap.csv; $I info gap.csv",
                 "Usable with care for identify: 1 gap with 101 missing rows;");
    check_begins("$I allan rest.csv", "Usable up to tau = 1.28 s: each deviation is known to ");
    check_begins("head -4 rest.csv >short.csv; $I allan short.csv",
                 "Not usable: no deviation is known to a factor of two, as the record has only 3 ");
    check_begins("$I spectrum rest.csv", "Usable from ");
    check_begins("awk -F, -v OFS=, 'NR > 1 {a += ($2 - a)/8; $2 = a} 1' rest.csv >slow.csv; "
                 "$I spectrum slow.csv",
                 "Usable with care from ");
    check_contains(out, "gyro_x: the four noise terms do not explain the spectrum", "filtered");
    check_begins("$I identify rest.csv", "Usable for the white noise: no test found a fault");
    check_begins(
        "awk -F, -v OFS=, 'NR > 1 {if (NR % 4) $2 = k; else k = $2} 1' rest.csv >held.csv; "
        "$I identify held.csv",
        "Usable with care: ");
    sweep();
}

/* The same sentence everywhere: the text, the JSON and the page of a result. */
static void test_one_sentence(void **state)
{
    (void)state;
    char sentence[1000], tag[1100];
    make_rest();
    snprintf(sentence, sizeof sentence, "%s", first_line("$I allan rest.csv"));
    check_json("$I allan rest.csv --json", sentence);
    assert_int_equal(run("$I identify rest.csv --report page.html"), 0);
    snprintf(tag, sizeof tag, "\">%.*s</p>", (int)strcspn(out, "\n"), out);
    read_text("page.html", out);
    check_contains(out, tag, "page");
    const char *picture = strstr(out, "<svg"), *table = strstr(out, "<table");
    assert_true(picture && table && picture < table);
    sweep();
}

static void test_plans(void **state)
{
    (void)state;
    check_begins("$I calibrate --plan tactical -p multiposition --gravity 9.8m/s^2",
                 "Usable: 20 steps of ");
    check_begins("$I calibrate --plan tactical -p multiposition --gravity 9.8m/s^2 --want "
                 "'accel.bias 0.001 ug'",
                 "Not usable for what is wanted: ");
    check_begins("$I identify --plan AHRS --rate 100Hz --want 'angle_random_walk 5%'",
                 "Usable: a record of ");
    check_begins("$I identify --plan AHRS --rate 100Hz --duration 1min --want "
                 "'gyro.bias_instability 5%'",
                 "Not usable for what is wanted: \"gyro.bias_instability 5%\"");
    sweep();
}

static void test_figures(void **state)
{
    (void)state;
    put("t.csv", "reference [deg/s],reading [deg/s]\n-50,-50.11\n0,0.02\n50,50.09\n0,0.05\n"
                 "-50,-50.12\n0,0.03\n50,50.10\n");
    check_begins("$I evaluate t.csv", "Usable: the scale factor is known to 304 ppm; ");
    check_begins("$I evaluate t.csv --limit 'linearity 0.5 %'",
                 "Usable: the limit is met with the whole interval.");
    check_begins(
        "$I evaluate t.csv --limit 'linearity 0.06 %'",
        "Usable with care: linearity, least-squares line of reading is not surely within ");
    check_begins(
        "$I evaluate t.csv --limit 'linearity 0.05 %'",
        "Not usable: linearity, least-squares line of reading is beyond its limit, 0.05 %");
    check_begins("head -3 t.csv >two.csv; $I evaluate two.csv",
                 "Usable with care: no reading was repeated");
    sweep();
}

static void test_models(void **state)
{
    (void)state;
    put("noise.yaml", "imukit: 1\ngyro: {noise: {angle_random_walk: 0.1 deg/sqrt(h)}}\n");
    assert_int_equal(run("$I simulate tactical --rate 10Hz --duration 5s -o raw.csv"), 0);
    check_begins("$I compensate raw.csv tactical -o clean.csv", "Usable: 5 terms are taken out");
    check_begins("$I compensate raw.csv noise.yaml -o clean.csv", "Not usable: ");
    check_begins("$I compensate tactical --emit-c code", "Usable: the rate is exact to ");
    check_begins("$I compensate noise.yaml --emit-c code", "Not usable: the model has no determin");
    check_begins("$I grade tactical", "Usable as tactical class: the gyro bias decides; CEP ");
    check_begins("$I grade ADIS16488", "Not usable as any class: ");
    check_begins("$I grade HG1700",
                 "Usable with care as at best tactical class: it does not state ");
    check_begins("$I devices tactical", "# Usable: it states every term");
    check_begins("$I devices HG1700", "# Usable with care: it does not state ");
    check_begins("$I devices ADIS16505-2", "# Not usable as a model: ");
    check_json("$I convert noise.yaml noise.json --json", "Usable: noise.json holds all of ");
    assert_int_equal(run("$I devices tactical >whole.yaml"), 0);
    check_json("$I convert whole.yaml k.yaml --to kalibr --rate 100Hz --json",
               "Usable with care: gyro.bias.repeatability is not held");
    check_json("$I simulate tactical --rate 10Hz --duration 5s -o raw.csv --json",
               "Usable: 1 log of 50 samples");
    assert_int_equal(run("rm -r code"), 0);
    sweep();
}

/* Terms of temperature are left out where no temperature is given, and said to be. */
static void test_left_out(void **state)
{
    (void)state;
    put("warm.yaml",
        "imukit: 1\naccel:\n  bias:\n    temperature: {reference_temperature: 20 degC, "
        "valid_range: 0 40 degC, coefficients: [1 1 1 mg/K]}\n");
    check_json("$I simulate warm.yaml --rate 10Hz --duration 5s -o raw.csv --temperature 25degC "
               "--json",
               "Usable: 1 log");
    check_json("$I simulate warm.yaml --rate 10Hz --duration 5s -o raw.csv --json",
               "Usable with care: the model's temperature terms are left out");
    sweep();
}

static void test_positions(void **state)
{
    (void)state;
    check_begins("$I drift tactical --times '1min, 1h'",
                 "Usable for 1 min: the CEP stays within 1 nmi; ");
    check_begins("$I drift control --times '1h, 2h'",
                 "Not usable for a position: there is none after 1 h already");
    check_begins("$I drift tactical --want 'CEP 1 km @ 1min'",
                 "Usable for CEP 1.00 km after 1 min: the figure is ");
    check_begins("$I drift tactical --want 'CEP 1 nmi @ 1h'",
                 "Not usable for CEP 1.00 nmi after 1 h: the figure is 80.2 nmi; gyro bias ");
    check_begins("$I drift HG1700 --times 1min",
                 "Usable with care for 1 min: the figures are lower ");
    check_begins("$I drift navigation control --times 1h",
                 "Usable within 1 nmi (CEP): navigation for 1 h; control not even for 1 h.");
    sweep();
}

static void test_tracks(void **state)
{
    (void)state;
    assert_int_equal(run("$I simulate navigation --rate 20Hz --duration 4min --latitude 45deg "
                         "-o parked.csv"),
                     0);
    const char *line = "$I navigate parked.csv --position '45 deg, 0 deg, 0 m' --align 2min ";
    char whole[400];
    snprintf(whole, sizeof whole, "%s--model navigation", line);
    check_begins(whole, "Usable after 2 min: the horizontal error is ");
    check_begins(line, "Usable with care after 2 min: ");
    /* Pushed a little after its alignment: an error of 3.6 and of 6.4 times the sigma. */
    static const char *const pushed[][2] = {
        {"0.0015", "Usable with care after 2 min: the horizontal error is 10.1 m, 3.6 times the "},
        {"0.0026", "Not usable after 2 min: the horizontal error is 17.8 m, 6.4 times the "}};
    for (size_t k = 0; k < 2; k++) {
        snprintf(whole, sizeof whole,
                 "awk -F, -v OFS=, '/^[0-9]/ && $1 > 121 {$5 += %s} 1' parked.csv >pushed.csv; "
                 "$I navigate pushed.csv --position '45 deg, 0 deg, 0 m' --align 2min --model "
                 "navigation",
                 pushed[k][0]);
        check_begins(whole, pushed[k][1]);
    }
    /* Readings that do not fit, by sigmas that are a thousandth of the true ones. */
    assert_int_equal(run("$I simulate tactical --rate 20Hz --duration 4min --latitude 45deg "
                         "-o aided.csv --aid 'position 1 m' --aid-output gnss.csv"),
                     0);
    line = "$I navigate aided.csv --position '45 deg, 0 deg, 0 m' --align 2min --model tactical "
           "--aid gnss.csv ";
    snprintf(whole, sizeof whole, "%s--aid-sigma 'position 1 m'", line);
    check_begins(whole, "Usable after 2 min: by the model the horizontal position is known to ");
    snprintf(whole, sizeof whole, "%s--aid-sigma 'position 0.001 m'", line);
    check_begins(whole, "Not usable after 2 min: most readings of aids do not fit, ");
    sweep();
}

static void test_campaigns(void **state)
{
    (void)state;
    for (int part = 1; part <= 2; part++) {
        char line[200];
        snprintf(line, sizeof line,
                 "$I drift tactical --duration 5s --rate 10Hz --monte-carlo 4 --shard %d/2 -o "
                 "s%d.h5",
                 part, part);
        check_begins(line, "Usable with care, as part ");
    }
    check_begins("$I merge s1.h5 s2.h5 -o all.h5", "Usable: all 4 runs are there.");
    check_begins("$I merge s1.h5 -o some.h5 --partial",
                 "Usable with care: runs 2-3 of 4 are missing");
    check_begins("$I drift all.h5",
                 "Usable for 5 s: the CEP of the runs stays within 1 nmi to the ");
    assert_int_equal(run("$I merge s1.h5 -o none.h5"), 1);
    assert_string_equal(out, "");
    sweep();
}

static void test_instruments(void **state)
{
    (void)state;
    check_begins("$I physics fibre_optic", "Usable up to 80 deg/s: bias instability ");
    check_begins("$I physics fibre_optic --rate '10 deg/s' --duration 1s -o out.csv",
                 "Usable: the output follows the input of 10 deg/s");
    check_begins("$I physics fibre_optic --rate '10 deg/s' --duration 10ms -o out.csv",
                 "Usable with care: one sample shows neither scatter nor");
    check_begins(
        "$I physics fibre_optic --rate '100 deg/s' --duration 1s -o out.csv",
        "Not usable at this input: the input of 100 deg/s is beyond the range of 80 deg/s");
    assert_int_equal(run("$I physics fibre_optic --reduce -o gyro.yaml && $I physics "
                         "pendulous_servo --reduce -o accel.yaml"),
                     0);
    check_begins("$I join gyro.yaml accel.yaml -o unit.yaml",
                 "Usable with care: the sensors are from different models");
    check_begins("$I join --x gyro.yaml --y gyro.yaml --z gyro.yaml -o unit.yaml",
                 "Not usable for navigation: the unit has 3 gyros and 0 accelerometers.");
    sweep();
}

static void test_filters(void **state)
{
    (void)state;
    put("rest.yaml", "imukit_motion: 1\nsteps: [hold 30 s]\n");
    put("walk.yaml",
        "imukit_motion: 1\nsteps: [hold 2 s, accelerate to 1.4 m/s at 1 m/s^2, swing y "
        "20 deg at 0.9 Hz for 12 s]\n");
    check_begins("$I tune tactical rest.yaml --windows 8 --to-time 1s",
                 "Usable: with the noise \"fit\" the filter is consistent at all times");
    check_begins("$I tune tactical walk.yaml --windows 8",
                 "Usable with care: no constant noise describes these errors");
    sweep();
}

/* What was not measured is -, not a number. */
static void test_one_sample(void **state)
{
    (void)state;
    make_rest();
    check_begins("head -2 rest.csv >one.csv; $I info one.csv",
                 "Not usable as it is: there is only one row.");
    assert_null(strstr(out, "nan"));
    check_contains(out, "gyro_x   deg/s  header", "info");
    assert_int_equal(run("$I info one.csv --json"), 0);
    check_contains(out, "\"scatter\": {\"value\": null", "info");
    assert_int_equal(run("$I physics ring_laser -d 10ms -o out.csv --json"), 0);
    check_contains(out, "\"standard_deviation\": {\"value\": null", "physics");
    assert_int_equal(run("$I physics ring_laser -d 10ms -o out.csv"), 0);
    assert_null(strstr(out, "nan"));
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_logs),      cmocka_unit_test(test_one_sentence),
        cmocka_unit_test(test_plans),     cmocka_unit_test(test_figures),
        cmocka_unit_test(test_models),    cmocka_unit_test(test_left_out),
        cmocka_unit_test(test_positions), cmocka_unit_test(test_tracks),
        cmocka_unit_test(test_campaigns), cmocka_unit_test(test_instruments),
        cmocka_unit_test(test_filters),   cmocka_unit_test(test_one_sample)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
