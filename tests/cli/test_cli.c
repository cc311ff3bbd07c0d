/* SPDX-License-Identifier: Apache-2.0 */
/* The command as a user meets it: exact output, exit codes and messages, good input and bad. The
 * binary under test is IMUKIT_COMMAND, given by the build, or `imukit` beside this program. Every
 * command runs in an empty directory of its own, so that what it leaves behind can be seen. */
#define _DEFAULT_SOURCE
#include "check.h"
#include "imukit/report.h"

#include <dirent.h>
#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { TEXT_SIZE = 1 << 20 };
static char command[4096];
static char directory[] = "/tmp/imukit-cli-XXXXXX";
static char out[TEXT_SIZE], err[TEXT_SIZE];

static void locate_command(void)
{
#ifdef IMUKIT_COMMAND
    snprintf(command, sizeof command, "%s", IMUKIT_COMMAND);
#else
    char here[3000];
    ssize_t length = readlink("/proc/self/exe", here, sizeof here - 1);
    here[length > 0 ? length : 0] = '\0';
    char *slash = strrchr(here, '/');
    if (slash)
        *slash = '\0';
    snprintf(command, sizeof command, "%s/imukit", here);
#endif
}

static int set_up(void **state)
{
    (void)state;
    locate_command();
    if (access(command, X_OK) != 0) {
        print_error("%s is not there: build the target imukit-command\n", command);
        return -1;
    }
    unsetenv("NO_COLOR");
    return mkdtemp(directory) && chdir(directory) == 0 ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    return chdir("/") == 0 ? rmdir(directory) : -1;
}

static void read_text(const char *path, char *text)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    text[fread(text, 1, TEXT_SIZE - 1, file)] = '\0';
    fclose(file);
}

/* Run a shell line in which $I is the command; standard output and error go to out and err. */
static int run(const char *line)
{
    char whole[8192];
    setenv("I", command, 1);
    snprintf(whole, sizeof whole, "{ %s ; } >/tmp/imukit-cli-out.%d 2>/tmp/imukit-cli-err.%d", line,
             (int)getpid(), (int)getpid());
    int status = system(whole);
    snprintf(whole, sizeof whole, "/tmp/imukit-cli-out.%d", (int)getpid());
    read_text(whole, out);
    unlink(whole);
    snprintf(whole, sizeof whole, "/tmp/imukit-cli-err.%d", (int)getpid());
    read_text(whole, err);
    unlink(whole);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static void put(const char *path, const char *text)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    assert_int_equal(fclose(file), 0);
}

/* Files in the working directory; they are removed. */
static size_t sweep(void)
{
    DIR *listing = opendir(".");
    size_t count = 0;
    assert_non_null(listing);
    for (struct dirent *entry = readdir(listing); entry; entry = readdir(listing)) {
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
            continue;
        count++;
        remove(entry->d_name);
    }
    closedir(listing);
    return count;
}

static void check_contains(const char *text, const char *part, const char *line)
{
    if (!strstr(text, part)) {
        print_error("%s\n  printed: %s\n  expected in it: %s\n", line, text, part);
        fail();
    }
}

/* A line that must end with this code and say exactly this on standard error. */
static void check_message(const char *line, int code, const char *message)
{
    int actual = run(line);
    if (actual != code || strcmp(err, message) != 0) {
        print_error("%s\n  code %d, expected %d\n  says:     %s\n  expected: %s\n", line, actual,
                    code, err, message);
        fail();
    }
}

#define TRY_MAIN "Try: imukit --help\n"
#define TRY(verb) "Try: imukit " verb " --help\n"

/* ---- the command line ------------------------------------------------------------------------ */

static void test_newcomer(void **state)
{
    (void)state;
    assert_int_equal(run("$I"), 0);
    check_contains(out, "First result", "imukit");
    check_contains(out, "imukit identify static.csv -o model.yaml --report report.html", "imukit");
    char *first = strdup(out);
    assert_int_equal(run("$I --help"), 0);
    assert_string_equal(out, first);
    assert_int_equal(run("$I help"), 0);
    assert_string_equal(out, first);
    free(first);
    assert_int_equal(run("$I --version"), 0);
    assert_string_equal(out, "imukit " IMK_VERSION "\n");
    assert_string_equal(err, "");
}

static const char *const verbs[] = {"simulate", "allan", "identify", "devices", "grade", "convert"};

/* Help, man page and completion of every verb; examples first, no colours into a file. */
static void test_help_of_every_verb(void **state)
{
    (void)state;
    char line[200], expected[100];
    for (size_t i = 0; i < sizeof verbs / sizeof verbs[0]; i++) {
        snprintf(line, sizeof line, "$I %s --help", verbs[i]);
        assert_int_equal(run(line), 0);
        snprintf(expected, sizeof expected, "imukit %s: ", verbs[i]);
        assert_int_equal(strncmp(out, expected, strlen(expected)), 0);
        snprintf(expected, sizeof expected, "\n\nExamples\n  imukit %s", verbs[i]);
        assert_ptr_equal(strstr(out, "\n\n"), strstr(out, expected));
        assert_null(strchr(out, '\033'));
        char *help = strdup(out);
        snprintf(line, sizeof line, "$I help %s", verbs[i]);
        assert_int_equal(run(line), 0);
        assert_string_equal(out, help);
        free(help);
        snprintf(line, sizeof line, "$I help --man %s", verbs[i]);
        assert_int_equal(run(line), 0);
        check_contains(out, ".TH IMUKIT\\-", line);
        snprintf(line, sizeof line,
                 "$I help --completion bash | bash -n && $I help --completion "
                 "bash | grep -c '^        %s) choices='",
                 verbs[i]);
        assert_int_equal(run(line), 0);
        assert_string_equal(out, "1\n");
    }
}

static void test_wrong_usage(void **state)
{
    (void)state;
    check_message(
        "$I simluate", 2,
        "imukit: error: there is no verb \"simluate\"; did you mean \"simulate\"?\n" TRY_MAIN);
    check_message("$I xyzzy", 2,
                  "imukit: error: there is no verb \"xyzzy\"; the verbs are listed by imukit "
                  "--help\n" TRY_MAIN);
    check_message("$I simulate tactical --durration 1h", 2,
                  "imukit simulate: error: there is no option --durration; did you mean "
                  "--duration?\n" TRY("simulate"));
    check_message("$I simulate tactical -Z", 2,
                  "imukit simulate: error: there is no option -Z\n" TRY("simulate"));
    check_message("$I simulate", 2,
                  "imukit simulate: error: an operand is missing: imukit simulate "
                  "MODEL\n" TRY("simulate"));
    check_message("$I grade a b", 2,
                  "imukit grade: error: \"b\" is one word too many: imukit grade "
                  "MODEL\n" TRY("grade"));
    check_message("$I convert a.csv", 2,
                  "imukit convert: error: an operand is missing: imukit convert IN "
                  "OUT\n" TRY("convert"));
    check_message("$I simulate tactical --rate", 2,
                  "imukit simulate: error: --rate needs a value: --rate RATE\n" TRY("simulate"));
    check_message("$I simulate tactical --duration 1h", 2,
                  "imukit simulate: error: the sample rate is missing: add --rate "
                  "100Hz\n" TRY("simulate"));
    check_message("$I simulate tactical --rate 100Hz", 2,
                  "imukit simulate: error: the length is missing: add --duration "
                  "1h\n" TRY("simulate"));
    check_message("$I simulate tactical --no-earth=1", 2,
                  "imukit simulate: error: --no-earth takes no value\n" TRY("simulate"));
    check_message("$I allan a.csv --edf some", 2,
                  "imukit allan: error: --edf some: expected one of "
                  "exact|greenhall-riley\n" TRY("allan"));
    check_message("$I allan a.csv --confidence 95", 2,
                  "imukit allan: error: --confidence 95: expected a fraction between 0 and 1, such "
                  "as 0.95 or 95%\n" TRY("allan"));
    check_message("$I simulate tactical --seed -1", 2,
                  "imukit simulate: error: --seed -1: expected a whole number, such as --seed "
                  "1\n" TRY("simulate"));
    check_message("$I simulate tactical --seed 18446744073709551616", 2,
                  "imukit simulate: error: --seed 18446744073709551616: the number is too large; "
                  "at most 18446744073709551615\n" TRY("simulate"));
    check_message("$I convert model.yaml log.csv", 2,
                  "imukit convert: error: model.yaml is a model and log.csv a log: a log and a "
                  "model cannot become each other; use identify or simulate\n" TRY("convert"));
    assert_int_equal(sweep(), 0);
}

/* Quantities carry units, and the unit decides. */
static void test_units_of_quantities(void **state)
{
    (void)state;
    check_message("$I simulate tactical --rate 100 --duration 1s", 2,
                  "imukit simulate: error: --rate 100: the unit is missing; write --rate "
                  "100Hz\n" TRY("simulate"));
    assert_int_equal(run("$I simulate tactical --rate 100deg --duration 1s"), 2);
    check_contains(err, "is an angle; expected a frequency such as Hz", "--rate 100deg");
    assert_int_equal(run("$I simulate tactical --rate 0Hz --duration 1s"), 2);
    check_contains(err, "--rate must be positive", "--rate 0Hz");
    assert_int_equal(run("$I simulate tactical --rate 100Hz --duration 1ms"), 2);
    check_contains(err, "rows: expected 1 to 1e15", "0.1 rows");
    assert_int_equal(run("$I simulate tactical --rate 100Hz --duration 1s --gyro-unit g"), 2);
    check_contains(err, "--gyro-unit g: expected an angular rate", "--gyro-unit g");
    assert_int_equal(sweep(), 0);
}

/* ---- simulate -------------------------------------------------------------------------------- */

/* The same bytes whatever the threads and the way out; another seed or run makes others. */
static void test_simulate_is_reproducible(void **state)
{
    (void)state;
    assert_int_equal(run("$I simulate AHRS --rate 100Hz --duration 700s --seed 7 -o a.csv"), 0);
    assert_string_equal(err, "");
    assert_string_equal(out, "");
    assert_int_equal(run("head -1 a.csv; wc -l <a.csv"), 0);
    assert_string_equal(out, "time [s],gyro_x [deg/s],gyro_y [deg/s],gyro_z [deg/s],"
                             "accel_x [m/s^2],accel_y [m/s^2],accel_z [m/s^2]\n70001\n");
    assert_int_equal(run("$I simulate AHRS --rate 100Hz --duration 700s --seed 7 --threads 1 | "
                         "cmp - a.csv"),
                     0);
    assert_int_equal(run("$I simulate AHRS --rate 0.1kHz --duration 700s --seed=7 --threads 3 -o - "
                         "| cmp - a.csv"),
                     0);
    assert_int_equal(run("$I simulate AHRS --rate 100Hz --duration 700s --seed 8 | cmp -s - a.csv"),
                     1);
    assert_int_equal(run("$I simulate AHRS --rate 100Hz --duration 700s --seed 7 --run 1 | cmp -s "
                         "- a.csv"),
                     1);
    sweep();
}

static void test_simulate_units_and_decimals(void **state)
{
    (void)state;
    assert_int_equal(run("$I simulate AHRS --rate 4Hz --duration 0.5s --decimals 2 --gyro-unit "
                         "deg/h --accel-unit mg"),
                     0);
    assert_int_equal(strncmp(out, "time [s],gyro_x [deg/h],", 24), 0);
    check_contains(out, ",accel_z [mg]\n0.00,", "two decimals");
    check_contains(out, "\n0.25,", "time by the rate");
    /* Without Earth rate and gravity, and with a model without errors, every sample is zero. */
    put("perfect.yaml", "imukit: 1\nname: perfect\ngyro: {}\naccel: {}\n");
    assert_int_equal(run("$I simulate perfect.yaml --rate 2Hz --duration 1s --no-earth"), 0);
    check_contains(out, "]\n0,0,0,0,0,0,0\n0.5,0,0,0,0,0,0\n", "perfect unit");
    /* At rest and level at the equator: gravity by Somigliana's formula, 9.7803253359 m/s^2. */
    assert_int_equal(run("$I simulate perfect.yaml --rate 1Hz --duration 1s --latitude 0deg "
                         "--decimals 8"),
                     0);
    check_contains(out, ",-9.78032534\n", "gravity");
    /* A single axis keeps its name, and a sensor with a sensitivity makes counts. */
    put("z.yaml", "imukit: 1\ngyro:\n  direction: [0 0 1]\n  sensitivity: 4778 count/(rad/s)\n"
                  "  zero_offset: 32768 count\n");
    assert_int_equal(run("$I simulate z.yaml --rate 1Hz --duration 1s --no-earth"), 0);
    assert_string_equal(out, "time [s],gyro_z [count]\n0,32768\n");
    sweep();
}

/* ---- allan ----------------------------------------------------------------------------------- */

/* The 1000-point set of NIST SP 1065 and its published OADEV at 1, 10, 100. */
static void write_nist(const char *path, bool phase)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    uint64_t n = 1234567890;
    double sum = 0;
    if (phase)
        fputs("0\n", file);
    for (int i = 0; i < 1000; i++, n = 16807 * n % 2147483647) {
        sum += (double)n / 2147483647;
        fprintf(file, "%.17g\n", phase ? sum : (double)n / 2147483647);
    }
    fclose(file);
}

static void check_nist_line(const char *line, double tau, double expected)
{
    double read_tau, deviation, lower, upper;
    assert_non_null(line = strchr(line, ','));
    assert_int_equal(sscanf(line, ",%lf,%lf,%lf,%lf,", &read_tau, &deviation, &lower, &upper), 4);
    CHECK_CLOSE(read_tau, tau, 0);
    CHECK_CLOSE(deviation, expected, 1e-10); /* as printed: ten decimals */
    assert_true(lower < deviation && deviation < upper);
}

static void check_nist_table(void)
{
    const char *header = "channel,tau [s],deviation,lower,upper,unit,edf,count\n";
    assert_int_equal(strncmp(out, header, strlen(header)), 0);
    const char *line = strchr(out, '\n') + 1;
    check_nist_line(line, 1, .2922318781);
    line = strchr(line, '\n') + 1;
    check_nist_line(line, 10, .0915995342);
    line = strchr(line, '\n') + 1;
    check_nist_line(line, 100, .0324134303);
}

static void test_allan_published_values(void **state)
{
    (void)state;
    write_nist("rate.txt", false);
    const char *whole = "--columns gyro_x --gyro-unit rad/s --rate 1Hz";
    setenv("A", whole, 1);
    assert_int_equal(run("$I allan rate.txt $A --tau 1s,10s,100s -o -"), 0);
    check_nist_table();
    assert_int_equal(run("$I allan rate.txt $A --tau 1s,100s --statistic adev -o - | tail -1"), 0);
    check_nist_line(out, 100, .0389780433);
    /* Intervals of Stable32 at 68.3 %: .28515 to .29987 at 1 s to 2e-3. */
    assert_int_equal(
        run("$I allan rate.txt $A --tau 1s --edf greenhall-riley --confidence 68.3% -o "
            "- | tail -1"),
        0);
    double lower, upper;
    assert_int_equal(sscanf(out, "gyro_x,1,%*f,%lf,%lf", &lower, &upper), 2);
    CHECK_RELATIVE(lower, .28515, 2e-3);
    CHECK_RELATIVE(upper, .29987, 2e-3);
    sweep();
}

/* Columns that are no sensor's: rates, and phase (their integral). */
static void test_allan_of_any_column(void **state)
{
    (void)state;
    write_nist("rate.txt", false);
    write_nist("phase.txt", true);
    assert_int_equal(run("$I allan rate.txt --columns x --rate 1Hz --tau 1s,10s,100s -o -"), 0);
    check_nist_table();
    assert_int_equal(run("$I allan phase.txt --columns x --rate 1Hz --tau 1s,10s,100s --type phase "
                         "-o -"),
                     0);
    check_nist_table();
    assert_int_equal(run("$I allan rate.txt --columns x --rate 1Hz | head -1"), 0);
    assert_string_equal(out, "tau [s]  x [1]\n");
    sweep();
}

static void test_allan_taus(void **state)
{
    (void)state;
    write_nist("x.txt", false);
    assert_int_equal(run("$I allan x.txt --columns gyro_x --gyro-unit rad/s --rate 1Hz"), 0);
    check_contains(out, "tau [s]  gyro_x [deg/s]", "table");
    check_contains(out, "\n256 ", "octaves");
    assert_int_equal(
        run("$I allan x.txt --columns gyro_x --gyro-unit rad/s --rate 1Hz --tau all -o - | wc -l"),
        0);
    assert_string_equal(out, "501\n");
    check_message("$I allan x.txt --columns gyro_x --gyro-unit rad/s --rate 1Hz --tau 1,2", 2,
                  "imukit allan: error: --tau 1,2: \"1\" is no averaging time; expected octave, "
                  "decade, all or a list such as 1s,10s,100s\n" TRY("allan"));
    check_message("$I allan x.txt --columns gyro_x --gyro-unit rad/s --rate 1Hz --tau 1s,501s", 2,
                  "imukit allan: error: --tau 1s,501s: \"501s\" is outside what this record "
                  "allows, 1 s to 500 s\n" TRY("allan"));
    check_message("$I allan x.txt --columns gyro_x --gyro-unit rad/s --rate 1Hz --tau 10s,1s", 2,
                  "imukit allan: error: --tau 10s,1s: the times must ascend\n" TRY("allan"));
    check_message("$I allan x.txt --columns gyro_x --gyro-unit rad/s --rate 1Hz --plot a.pdf", 2,
                  "imukit allan: error: --plot a.pdf: expected a name ending in .svg or .png, or "
                  "the word term\n" TRY("allan"));
    sweep();
}

/* ---- identify -------------------------------------------------------------------------------- */

/* Simulate, identify, and find the truth inside the intervals: 18 intervals of 99.99 % each all
 * cover with probability 0.998; this seed is fixed, so the test itself does not vary. */
static void test_identify_recovers_the_model(void **state)
{
    (void)state;
    assert_int_equal(run("$I simulate AHRS --rate 20Hz --duration 30min --seed 3 -o s.csv"), 0);
    assert_int_equal(run("$I identify s.csv --truth AHRS --confidence 0.9999 --twin -o m.yaml "
                         "--report r.html"),
                     0);
    check_contains(out, "\n18 of 18 intervals cover the truth; 99.99 % are expected to.\n", out);
    check_contains(out, "Report: r.html\nModel: m.yaml\nNext: imukit grade m.yaml\n", out);
    assert_int_equal(run("$I grade m.yaml"), 0);
    assert_int_equal(run("$I simulate m.yaml --rate 20Hz --duration 1min -o twin.csv"), 0);
    read_text("r.html", out);
    check_contains(out, "<h2>Verdict</h2>", "page");
    check_contains(out, "imukit identify s.csv --truth AHRS --confidence 0.9999", "page");
    check_contains(out, "angle_random_walk: ", "page");
    if (imk_plot_available())
        check_contains(out, "<svg", "page");
    sweep();
}

static void test_identify_json(void **state)
{
    (void)state;
    assert_int_equal(run("$I simulate AHRS --rate 20Hz --duration 5min --no-earth -o s.csv"), 0);
    assert_int_equal(run("$I identify s.csv --json"), 0);
    json_error_t error;
    json_t *document = json_loads(out, JSON_REJECT_DUPLICATES, &error);
    assert_non_null(document);
    const char *version, *verb, *code, *name, *unit;
    double value;
    assert_int_equal(json_unpack(document,
                                 "{s:s, s:s, s:{s:i}, s:{s:[{s:s, s:{s:{s:F, s:s}}}]}, "
                                 "s:[{s:s}]}",
                                 "imukit", &version, "command", &verb, "inputs", "rows", &(int){0},
                                 "result", "channels", "name", &name, "terms", "angle_random_walk",
                                 "value", &value, "unit", &unit, "warnings", "code", &code),
                     0);
    assert_string_equal(version, IMK_VERSION);
    assert_string_equal(verb, "identify");
    assert_string_equal(name, "gyro_x");
    assert_string_equal(unit, "rad/sqrt(s)");
    /* 0.3 deg/sqrt(h), 6000 samples: 1 sigma is 0.9 %. */
    CHECK_RELATIVE(value, 8.7266462599716e-5, 0.06);
    assert_string_equal(code, "gravity");
    json_decref(document);
    /* Without gravity the verdict is bad: --strict says so by the exit code, --json or not. */
    check_contains(err, "|accel| is ", "gravity");
    assert_int_equal(run("$I identify s.csv --json --strict"), 1);
    assert_int_equal(run("$I identify s.csv --strict"), 1);
    sweep();
}

static void test_identify_names_the_likely_unit(void **state)
{
    (void)state;
    assert_int_equal(run("$I simulate AHRS --rate 20Hz --duration 1min --accel-unit g | sed "
                         "'1s/[[]g[]]/[m\\/s^2]/g' >s.csv; head -1 s.csv"),
                     0);
    check_contains(out, "accel_z [m/s^2]", "header");
    assert_int_equal(run("$I identify s.csv"), 0);
    check_contains(err,
                   "m/s^2 at rest: the numbers look like g; write g into the header, or add "
                   "--accel-unit g where it has none.",
                   err);
    sweep();
}

/* Only what is identified is replaced, and the changes are shown. */
static void test_identify_into(void **state)
{
    (void)state;
    put("old.yaml",
        "imukit: 1\n# measured on the table\nname: unit 7\ngyro:\n  bias: {fixed: 1 2 3 "
        "deg/h}\n  noise: {angle_random_walk: 9 deg/sqrt(h)}\n");
    assert_int_equal(run("$I simulate AHRS --rate 20Hz --duration 2min | cut -d, -f1-4 >s.csv"), 0);
    assert_int_equal(run("$I identify s.csv --into old.yaml -o new.yaml"), 0);
    check_contains(err, "Changes to old.yaml:\n-   noise: {angle_random_walk: 9 deg/sqrt(h)}\n+ ",
                   err);
    read_text("new.yaml", out);
    check_contains(out, "bias: {fixed: 1 2 3 deg/h}", "kept");
    check_contains(out, "# measured on the table", "kept");
    check_contains(out, "name: unit 7", "kept");
    assert_null(strstr(out, "{angle_random_walk: 9 deg/sqrt(h)}"));
    sweep();
}

/* ---- what is wrong with a log ---------------------------------------------------------------- */

/* 1000 rows at 100 Hz of one gyro. */
static void write_good(void)
{
    FILE *file = fopen("good.csv", "wb");
    assert_non_null(file);
    uint64_t n = 1;
    fputs("time [s],gyro_x [deg/s]\n", file);
    for (int i = 0; i < 1000; i++, n = 16807 * n % 2147483647)
        fprintf(file, "%.2f,%.6f\n", i / 100.0, (double)n / 2147483647);
    fclose(file);
}

#define REMEDY "use --gaps longest (the longest clean stretch) or --gaps bridge (interpolate)\n"

/* How the file is made, and what every verb that analyses a log says about it. */
static const struct bad_log {
    const char *make, *file, *says;
} bad_logs[] = {
    {":", "missing.csv", "missing.csv: the file cannot be opened: No such file or directory\n"},
    {"mkdir dir.csv", "dir.csv", "dir.csv: the file cannot be opened: Is a directory\n"},
    {": >empty.csv", "empty.csv", "empty.csv: the file is empty\n"},
    {"head -1 good.csv >b.csv", "b.csv", "b.csv: there is no data: "},
    {"head -2 good.csv >b.csv", "b.csv",
     "b.csv: there is one row only; a static record of minutes to hours is due\n"},
    {"sed '1s/ .deg.*//' good.csv >b.csv", "b.csv", "add --gyro-unit deg/s"},
    {"cut -d, -f2 good.csv >b.csv", "b.csv",
     "add --rate 100Hz (samples per second)\nNext: imukit "},
    {"sed 1d good.csv >b.csv", "b.csv", "add --columns "},
    {"sed '1s/deg.s/g/' good.csv >b.csv", "b.csv", "expected an angular rate, such as deg/h"},
    {"sed '1s/deg.s/dge\\/s/' good.csv >b.csv", "b.csv", "dge"},
    {"sed '500s/,.*/,nan/' good.csv >b.csv", "b.csv",
     "b.csv: 1 row with a value that is not a finite number, first in row 499, column "
     "gyro_x; " REMEDY},
    {"sed '500s/,.*/,/' good.csv >b.csv", "b.csv",
     "b.csv: 1 row with a value that is not a finite number, first in row 499, column "
     "gyro_x; " REMEDY},
    {"sed '500{h;d};501G' good.csv >b.csv", "b.csv",
     "b.csv: time runs backwards in 1 row, first in row 500 (by 0.01 s); " REMEDY},
    {"sed '500p' good.csv >b.csv", "b.csv",
     "b.csv: time stands still in 1 row, first in row 500; " REMEDY},
    {"sed '101,300d' good.csv >b.csv", "b.csv",
     "b.csv: 200 samples are missing in 1 gap, first before row 100; " REMEDY},
    {"sed '2,$s/,.*/,5/' good.csv >b.csv", "b.csv",
     "b.csv: column gyro_x is constant in all 1000 rows: there is no noise to "},
    {"sed '500s/,.*/,abc/' good.csv >b.csv", "b.csv",
     "b.csv:500:6: gyro_x: \"abc\" cannot be read; expected "},
    {"sed '500s/,.*//' good.csv >b.csv", "b.csv", "b.csv:500: "},
    {"gzip -c good.csv | head -c 3000 >b.csv.gz", "b.csv.gz",
     "b.csv.gz: the gzip data is cut short"},
    {"head -c 9000 /dev/urandom >b.csv", "b.csv", "not a text log"},
    {"truncate -s 1000000000 b.csv", "b.csv", "not a text log"},
    {"head -c 9000000 /dev/zero | tr '\\0' 1 >b.csv", "b.csv", "b.csv:1: "},
};

static void test_bad_logs(void **state)
{
    (void)state;
    static const char *const analyses[] = {"identify", "allan"};
    char line[600], prefix[100];
    for (size_t i = 0; i < sizeof bad_logs / sizeof bad_logs[0]; i++) {
        for (size_t k = 0; k < 2; k++) {
            const struct bad_log *bad = &bad_logs[i];
            write_good();
            assert_int_equal(run(bad->make), 0);
            snprintf(line, sizeof line, "$I %s %s -o result", analyses[k], bad->file);
            int code = run(line);
            snprintf(prefix, sizeof prefix, "imukit %s: error: ", analyses[k]);
            check_contains(err, bad->says, bad->make);
            check_contains(err, prefix, bad->make);
            assert_int_equal(code, 1);
            assert_string_equal(out, "");
            assert_int_equal(access("result", F_OK), -1);
            sweep();
        }
    }
}

/* The command the message shows is the one to run. */
static void test_next_command(void **state)
{
    (void)state;
    write_good();
    assert_int_equal(run("cut -d, -f2 good.csv >'b 1.csv'"), 0);
    check_message(
        "$I allan 'b 1.csv' --tau=1s", 1,
        "imukit allan: error: b 1.csv:1: time: the sample rate is not known: no column of "
        "time; add --rate 100Hz (samples per second)\n"
        "Next: imukit allan 'b 1.csv' --tau=1s --rate 100Hz\n");
    assert_int_equal(run("$I allan 'b 1.csv' --tau=1s --rate 100Hz"), 0);
    sweep();
}

/* The promise of the messages: the option they name works. */
static void test_gap_policies(void **state)
{
    (void)state;
    static const struct {
        const char *make, *policy, *says;
        int rows;
    } cases[] = {
        {"cp good.csv b.csv", "refuse", "", 1000},
        {"sed 500d good.csv >b.csv", "refuse", "1 of 1000 samples are missing or bad: bridged",
         1000},
        {"sed '500s/,.*/,nan/' good.csv >b.csv", "bridge", "1 of 1000 samples", 1000},
        {"sed '500s/,.*/,nan/' good.csv >b.csv", "longest", "rows 500 to 1000 of 1000", 501},
        {"sed '101,300d' good.csv >b.csv", "bridge", "200 of 1000 samples", 1000},
        {"sed '101,300d' good.csv >b.csv", "longest", "rows 100 to 800 of 800", 701},
        {"sed '500{h;d};501G' good.csv >b.csv", "bridge", "1 of 1000 samples", 1000},
        {"sed '500{h;d};501G' good.csv >b.csv", "longest", "rows 501 to 1000 of 1000", 500},
        {"sed '500p' good.csv >b.csv", "bridge", "0 of 1000 samples", 1000},
        {"sed '101,900d' good.csv >b.csv", "bridge", "nothing to interpolate; use --gaps longest",
         0},
    };
    char line[300], rows[40];
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        write_good();
        assert_int_equal(run(cases[i].make), 0);
        snprintf(line, sizeof line, "$I allan b.csv --gaps %s --tau 0.1s --json", cases[i].policy);
        assert_int_equal(run(line), cases[i].rows ? 0 : 1);
        check_contains(err, cases[i].says, cases[i].make);
        snprintf(rows, sizeof rows, "\"rows\": %d,", cases[i].rows);
        check_contains(out, cases[i].rows ? rows : "", cases[i].make);
        check_contains(out, cases[i].rows ? "\"interval\": {\"value\": 0.01, " : "", cases[i].make);
        sweep();
    }
}

/* A straight line between good neighbours, value by value: rates of a ramp stay a ramp. */
static void test_bridging_is_linear(void **state)
{
    (void)state;
    assert_int_equal(run("awk 'BEGIN{print \"time [s],x\"; for (i = 0; i < 400; i++) "
                         "if (i % 10 < 7) print i / 8 \",\" i}' >ramp.csv"),
                     0);
    /* sigma(tau) of a ramp R t is R tau/sqrt 2: 8 per second here. */
    assert_int_equal(run("$I allan ramp.csv --gaps bridge --tau 1s -o - | tail -1"), 0);
    double deviation;
    assert_int_equal(sscanf(out, "x,1,%lf", &deviation), 1);
    CHECK_RELATIVE(deviation, 8 / sqrt(2), 1e-9);
    sweep();
}

/* ---- outputs that cannot be written ---------------------------------------------------------- */

static void test_unwritable_outputs(void **state)
{
    (void)state;
    static const char *const lines[] = {"simulate AHRS --rate 100Hz --duration 1s -o",
                                        "allan good.csv -o",
                                        "allan good.csv --report",
                                        "identify good.csv -o",
                                        "identify good.csv --report",
                                        "convert good.csv"};
    static const struct {
        const char *path, *says;
    } places[] = {{"/dev/full", "No space left on device"},
                  {"/nonexistent/x.csv", "No such file or directory"},
                  {"dir.csv", "Is a directory"}};
    char line[300];
    write_good();
    assert_int_equal(run("mkdir dir.csv"), 0);
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        for (size_t k = 0; k < sizeof places / sizeof places[0]; k++) {
            snprintf(line, sizeof line, "$I %s %s", lines[i], places[k].path);
            assert_int_equal(run(line), 1);
            check_contains(err, places[k].says, line);
        }
    }
    assert_int_equal(sweep(), 2); /* good.csv and dir.csv: nothing else was left */
    write_good();
    static const char *const to_standard_output[] = {"--help",
                                                     "devices",
                                                     "grade AHRS",
                                                     "grade AHRS --json",
                                                     "allan good.csv",
                                                     "allan good.csv --json",
                                                     "identify good.csv",
                                                     "simulate AHRS --rate 100Hz --duration 1s",
                                                     "convert good.csv -"};
    for (size_t i = 0; i < sizeof to_standard_output / sizeof to_standard_output[0]; i++) {
        snprintf(line, sizeof line, "$I %s >/dev/full", to_standard_output[i]);
        assert_int_equal(run(line), 1);
        check_contains(err, "No space left on device", line);
    }
    sweep();
}

/* ---- models, catalogue, conversion ----------------------------------------------------------- */

static void test_models(void **state)
{
    (void)state;
    assert_int_equal(run("$I grade navigation"), 0);
    check_contains(out, "navigation: navigation\n", "grade");
    check_contains(out, "\n->  navigation ", "grade");
    assert_int_equal(run("$I grade AHRS | head -2"), 0);
    check_contains(out, "Gyro: AHRS; remaining bias ", "grade");
    check_message("$I grade navigatoin", 1,
                  "imukit grade: error: model: \"navigatoin\" is not a known name; did you mean "
                  "\"navigation\"?\n");
    put("k.yaml", "imukit: 1\ngyro:\n  noise:\n    angle_random_wlk: 0.1 deg/sqrt(h)\n");
    check_message("$I grade k.yaml", 1,
                  "imukit grade: error: k.yaml:4:5: gyro.noise.angle_random_wlk: "
                  "\"angle_random_wlk\" is not a known key; did you mean "
                  "\"angle_random_walk\"?\n");
    put("u.yaml", "imukit: 1\ngyro:\n  noise:\n    angle_random_walk: 0.1 deg/h\n");
    assert_int_equal(run("$I simulate u.yaml --rate 1Hz --duration 1s -o s.csv"), 1);
    check_contains(err, "u.yaml:4:", "dimension");
    put("e.yaml", "imukit: 1\ngyro: {}\n");
    check_message("$I grade e.yaml", 1,
                  "imukit grade: error: e.yaml states no bias repeatability, no bias instability "
                  "and no uncertainty of the fixed bias: there is nothing to grade\n");
    assert_int_equal(access("s.csv", F_OK), -1);
    sweep();
}

static void test_devices(void **state)
{
    (void)state;
    assert_int_equal(run("$I devices | head -2"), 0);
    check_contains(out, "gyro N [deg/sqrt(h)]", "devices");
    check_contains(out, "\nstrategic ", "devices");
    assert_int_equal(run("$I devices ADIS16488 >d.yaml && $I grade d.yaml"), 0);
    assert_string_equal(err, "");
    assert_int_equal(run("$I devices --json"), 0);
    json_t *document = json_loads(out, JSON_REJECT_DUPLICATES, NULL);
    assert_non_null(document);
    json_decref(document);
    check_message("$I devices ADIS1648", 1,
                  "imukit devices: error: there is no device \"ADIS1648\"; did you mean "
                  "\"ADIS16488\"?\n");
    sweep();
}

static void test_convert(void **state)
{
    (void)state;
    write_good();
    static const char *const formats[] = {"b.csv", "b.csv.gz", "b.csv.zst"};
    char line[300];
    assert_int_equal(run("$I convert good.csv a.csv"), 0);
    for (size_t i = 0; i < 3; i++) {
        snprintf(line, sizeof line, "$I convert good.csv %s && $I convert %s - | cmp - a.csv",
                 formats[i], formats[i]);
        assert_int_equal(run(line), 0);
    }
    assert_int_equal(run("$I convert good.csv b.npy && $I convert b.npy - --rate 100Hz | cmp - "
                         "a.csv"),
                     0);
    assert_int_equal(
        run("$I convert good.csv - --select gyro_x --to-gyro-unit deg/min --decimals 3 "
            "| head -2"),
        0);
    assert_string_equal(out, "gyro_x [deg/min]\n0.000\n");
    check_message("$I convert good.csv c.csv --select gyrox", 1,
                  "imukit convert: error: --select: the log has no column \"gyrox\"; did you mean "
                  "\"gyro_x\"?\n");
    /* Increments become rates: 0.1 deg in each 0.01 s is 10 deg/s. */
    put("i.csv", "time [s],dtheta_x [deg]\n0,0.1\n0.01,0.1\n0.02,0.1\n");
    assert_int_equal(run("$I convert i.csv - --decimals 3"), 0);
    check_contains(out, "time [s],gyro_x [deg/s]\n0.000,10.000\n", "increments");
    /* A model goes to JSON and back. */
    put("m.yaml", "imukit: 1\nname: m\ngyro:\n  noise:\n    angle_random_walk: 0.3 deg/sqrt(h)\n");
    assert_int_equal(
        run("$I convert m.yaml m.json && $I convert m.json n.yaml && cmp m.yaml n.yaml"), 0);
    read_text("m.json", out);
    json_t *document = json_loads(out, JSON_REJECT_DUPLICATES, NULL);
    assert_non_null(document);
    json_decref(document);
    sweep();
}

static void test_plots(void **state)
{
    (void)state;
    if (!imk_plot_available()) {
        print_message("skipped: gnuplot is not installed\n");
        skip();
    }
    write_good();
    assert_int_equal(run("$I allan good.csv --plot a.svg && grep -c '</svg>' a.svg"), 0);
    assert_int_equal(run("$I identify good.csv --plot b.png && head -c 4 b.png | tail -c 3 >&2"),
                     0);
    check_contains(err, "PNG", "png");
    assert_int_equal(run("$I allan good.csv --plot term"), 0);
    check_contains(out, "averaging time [s]", "terminal");
    assert_null(strchr(out, '\033'));
    /* Without gnuplot the script and the data are left, and the message names the package. */
    assert_int_equal(run("PATH=/nonexistent $I allan good.csv --plot c.svg"), 1);
    check_contains(err, "c.svg: gnuplot is not installed; apt install gnuplot-nox", "no gnuplot");
    assert_int_equal(run("test -s c.dat && test -s c.gp && ! test -e c.svg && gnuplot c.gp && grep "
                         "-q '</svg>' c.svg"),
                     0);
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_newcomer),
        cmocka_unit_test(test_help_of_every_verb),
        cmocka_unit_test(test_wrong_usage),
        cmocka_unit_test(test_units_of_quantities),
        cmocka_unit_test(test_simulate_is_reproducible),
        cmocka_unit_test(test_simulate_units_and_decimals),
        cmocka_unit_test(test_allan_published_values),
        cmocka_unit_test(test_allan_of_any_column),
        cmocka_unit_test(test_allan_taus),
        cmocka_unit_test(test_identify_recovers_the_model),
        cmocka_unit_test(test_identify_json),
        cmocka_unit_test(test_identify_names_the_likely_unit),
        cmocka_unit_test(test_identify_into),
        cmocka_unit_test(test_bad_logs),
        cmocka_unit_test(test_next_command),
        cmocka_unit_test(test_gap_policies),
        cmocka_unit_test(test_bridging_is_linear),
        cmocka_unit_test(test_unwritable_outputs),
        cmocka_unit_test(test_models),
        cmocka_unit_test(test_devices),
        cmocka_unit_test(test_convert),
        cmocka_unit_test(test_plots),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
