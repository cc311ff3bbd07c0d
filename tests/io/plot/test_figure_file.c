/* SPDX-License-Identifier: Apache-2.0 */
/* Figures as files: what the script of gnuplot says, that programs draw, and what happens without
 * them. */
#define _POSIX_C_SOURCE 200809L
#include "check.h"
#include "io/plot/drawing_program_internal.h"

#include "imukit/figure_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { POINTS = 8 };
static double tau[POINTS], deviation[POINTS], lower[POINTS], upper[POINTS], line[POINTS];
static imk_curve curves[3];
static imk_panel panel;
static imk_figure figure;
static char directory[] = "/tmp/imukit-test-XXXXXX";

/* sigma = 1/sqrt(tau) with 10 % bars, and a steep line that leaves the frame. */
static int set_up(void **state)
{
    (void)state;
    for (int i = 0; i < POINTS; i++) {
        tau[i] = pow(2, i);
        deviation[i] = 1 / sqrt(tau[i]);
        lower[i] = 0.9 * deviation[i];
        upper[i] = 1.1 * deviation[i];
        line[i] = 1e-9 / tau[i];
    }
    curves[0] = (imk_curve){"gyro_x's", IMK_CURVE_POINTS, 0, POINTS, tau, deviation, lower, upper};
    curves[1] = (imk_curve){"fit", IMK_CURVE_DASHES, 1, POINTS, tau, line, NULL, NULL};
    curves[2] = (imk_curve){"", IMK_CURVE_BAND, 2, POINTS, tau, deviation, lower, upper};
    panel = (imk_panel){"a_b `id` $x",
                        "tau [s]",
                        "deviation [deg/h]",
                        true,
                        true,
                        3,
                        curves,
                        0,
                        NULL,
                        IMK_KEY_UPPER,
                        NULL,
                        false,
                        0,
                        0};
    figure = (imk_figure){"title", 1, 1, &panel};
    return mkdtemp(directory) ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    return rmdir(directory);
}

static char *path_in_directory(const char *name)
{
    static char path[300];
    snprintf(path, sizeof path, "%s/%s", directory, name);
    return path;
}

static char *read_text(const char *path)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    char *text = calloc(1, 1 << 20);
    assert_non_null(text);
    assert_true(fread(text, 1, (1 << 20) - 1, file) > 0);
    fclose(file);
    return text;
}

static bool exists(const char *path)
{
    return access(path, F_OK) == 0;
}

/* Texts are quoted: gnuplot would run what stands in back quotes inside double quotes. */
static void test_script_quotes_texts(void **state)
{
    (void)state;
    imki_drawing drawing = {IMKI_TERMINAL_TEXT, "it's.png", "d.dat", 79, 24, false};
    size_t size = 0;
    char *script = imki_figure_script(&figure, &drawing, &size);
    assert_non_null(script);
    assert_int_equal(strlen(script), size);
    assert_non_null(strstr(script, "set output 'it''s.png'\n"));
    assert_non_null(strstr(script, "set title 'a_b `id` $x' noenhanced\n"));
    assert_non_null(strstr(script, "title 'gyro_x''s' noenhanced"));
    assert_null(strchr(script, '"'));
    free(script);
}

/* What is no UTF-8 becomes the replacement character in a text, and stays in the name of a file. */
static void test_script_is_utf8(void **state)
{
    (void)state;
    imki_drawing drawing = {IMKI_TERMINAL_TEXT, "a\xF6.png", "d\xFF.dat", 79, 24, false};
    imk_panel odd = panel;
    odd.title = "l\xF6g";
    const imk_figure one = {"", 1, 1, &odd};
    size_t size = 0;
    char *script = imki_figure_script(&one, &drawing, &size);
    assert_non_null(script);
    assert_non_null(strstr(script, "set title 'l\xEF\xBF\xBDg' noenhanced\n"));
    assert_non_null(strstr(script, "set output 'a\xF6.png'\n"));
    assert_non_null(strstr(script, "'d\xFF.dat' index 0"));
    free(script);
}

/* The axes span the points and their bars (0.0795 to 1.1), not the line at 1e-9. Air of 7 % of the
 * decades on either side: from 0.0795/1.2 to 1.1*1.2. */
static void test_axes_span_points_only(void **state)
{
    (void)state;
    imki_drawing drawing = {IMKI_TERMINAL_TEXT, "x.png", "d.dat", 79, 24, false};
    size_t size = 0;
    char *script = imki_figure_script(&figure, &drawing, &size);
    double low = 0, high = 0;
    const char *range = strstr(script, "set yrange [");
    assert_non_null(range);
    assert_int_equal(sscanf(range, "set yrange [%lf:%lf]", &low, &high), 2);
    double span = pow(1.1 / lower[POINTS - 1], 0.07);
    CHECK_RELATIVE(low, lower[POINTS - 1] / span, 1e-12);
    CHECK_RELATIVE(high, 1.1 * span, 1e-12);
    free(script);
}

static void test_draws_every_kind(void **state)
{
    (void)state;
    static const struct {
        const char *name, *begins;
    } kinds[] = {{"a.svg", "<svg "}, {"a.png", "\x89PNG\r\n\x1a\n"}, {"a.pdf", "%PDF-"}};
    imk_error error;
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        if (!imk_plot_available(kinds[i].name)) {
            print_message("skipped: rsvg-convert is not installed\n");
            skip();
        }
        const char *path = path_in_directory(kinds[i].name);
        CHECK_OK(imk_figure_write(&figure, path, &error));
        char *drawn = read_text(path);
        assert_memory_equal(drawn, kinds[i].begins, strlen(kinds[i].begins));
        free(drawn);
        unlink(path);
    }
}

/* A map: regions alone span the axes, and their names are texts like any other. */
static void test_regions(void **state)
{
    (void)state;
    const imk_region regions[] = {{"fibre's", 0, 1e-3, 1e2, 0.1, 1e3, false, false},
                                  {"ring laser", 1, 1e-4, 1, 1, 20, true, true}};
    static const double at[] = {0.01};
    const imk_curve mark = {
        .label = "mine", .style = IMK_CURVE_MARKS, .count = 1, .x = at, .y = at};
    const imk_panel map = {.title = "map",
                           .x_label = "bias",
                           .y_label = "scale",
                           .x_logarithmic = true,
                           .y_logarithmic = true,
                           .curve_count = 1,
                           .curves = &mark,
                           .region_count = 2,
                           .regions = regions,
                           .note = "the first \"note\"\nit's another"};
    const imk_figure drawn = {.title = "", .panel_count = 1, .columns = 1, .panels = &map};
    imki_drawing drawing = {IMKI_TERMINAL_TEXT, "a.png", "a.dat", 79, 24, false};
    size_t size = 0;
    char *script = imki_figure_script(&drawn, &drawing, &size);
    assert_non_null(script);
    /* Names are placed as in our own drawings, where none covers another or a mark. */
    assert_non_null(strstr(script, "set label 1 'fibre''s' at graph 0."));
    assert_non_null(strstr(script, "set label 2 'ring laser' at graph 0."));
    assert_non_null(strstr(script, " right noenhanced\n"));
    assert_non_null(strstr(
        script, "set xlabel 'bias'.\"\\n\".'the first \"note\"'.\"\\n\".'it''s another' noen"));
    assert_non_null(strstr(script, "set ylabel 'scale' noenhanced"));
    /* The mark at 0.01 is below both regions: the axis reaches down to it. */
    assert_non_null(strstr(script, "set yrange [0.004"));
    assert_non_null(strstr(script, "using 1:2 with points linecolor "));
    free(script);
}

static void test_refuses_what_cannot_be_drawn(void **state)
{
    (void)state;
    imk_error error;
    CHECK_STATUS(imk_figure_write(&figure, path_in_directory("a.gif"), &error), IMK_ERROR_FORMAT);
    assert_non_null(strstr(error.expected, ".svg"));
    double nothing[POINTS] = {0}; /* no logarithm */
    imk_curve curve = {"", IMK_CURVE_POINTS, 0, POINTS, tau, nothing, NULL, NULL};
    imk_panel empty = {"empty",       "",   "",    true, true, 1, &curve, 0, NULL,
                       IMK_KEY_UPPER, NULL, false, 0,    0};
    imk_figure bad = {"", 1, 1, &empty};
    CHECK_STATUS(imk_figure_write(&bad, path_in_directory("a.png"), &error), IMK_ERROR_EMPTY);
    assert_string_equal(error.field, "empty");
    assert_false(exists(path_in_directory("a.png")));
}

/* With nothing on PATH, SVG is drawn as ever; of the rest the message names the package. */
static void test_without_gnuplot(void **state)
{
    (void)state;
    static const char *const others[] = {"b.png", "b.pdf", "term"};
    imk_error error;
    char *saved = strdup(getenv("PATH"));
    setenv("PATH", directory, 1);
    assert_true(imk_plot_available("b.svg"));
    assert_false(imk_plot_available("b.png") || imk_plot_available("term"));
    CHECK_OK(imk_figure_write(&figure, path_in_directory("b.svg"), &error));
    unlink(path_in_directory("b.svg"));
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        const bool in_letters = strcmp(others[i], "term") == 0;
        const char *path = in_letters ? others[i] : path_in_directory(others[i]);
        CHECK_STATUS(imk_figure_write(&figure, path, &error), IMK_ERROR_UNSUPPORTED);
        assert_non_null(strstr(error.expected, in_letters ? "gnuplot-nox" : "librsvg2-bin"));
        assert_int_equal(strstr(error.expected, ".svg needs no other") != NULL, !in_letters);
        assert_false(exists(path));
    }
    setenv("PATH", saved, 1);
    free(saved);
}

/* Without a temporary folder no program draws, and nothing is freed that was not made. */
static void test_without_temporary_folder(void **state)
{
    (void)state;
    imk_error error;
    if (!imk_plot_available("a.png"))
        skip();
    const char *before = getenv("TMPDIR");
    char *saved = before ? strdup(before) : NULL;
    setenv("TMPDIR", "/nonexistent", 1);
    imk_status status = imk_figure_write(&figure, path_in_directory("a.png"), &error);
    if (saved)
        setenv("TMPDIR", saved, 1);
    else
        unsetenv("TMPDIR");
    free(saved);
    CHECK_STATUS(status, IMK_ERROR_OPEN);
    assert_string_equal(error.field, "temporary folder");
    assert_false(exists(path_in_directory("a.png")));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_script_quotes_texts),
        cmocka_unit_test(test_script_is_utf8),
        cmocka_unit_test(test_axes_span_points_only),
        cmocka_unit_test(test_draws_every_kind),
        cmocka_unit_test(test_regions),
        cmocka_unit_test(test_refuses_what_cannot_be_drawn),
        cmocka_unit_test(test_without_gnuplot),
        cmocka_unit_test(test_without_temporary_folder),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
