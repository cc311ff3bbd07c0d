/* SPDX-License-Identifier: Apache-2.0 */
/* Animations: that the walker is where the path is, at the time it should be; that nothing but
 * whole numbers and escaped text is inside; that readers can ask for stillness. */
#define _POSIX_C_SOURCE 200809L
#include "check.h"

#include "report/page_internal.h"

#include "imukit/figure_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { POINTS = 5 };

/* Along a straight line, at rest for half of the time: 0, 0, 0, 1/2, 1 of the way. */
static const double x[POINTS] = {0, 0, 0, 5, 10}, y[POINTS] = {-2, -2, -2, 0, 2};

static imk_animation line(void)
{
    return (imk_animation){.title = "a < b",
                           .x_label = "x [m]",
                           .y_label = "y [m]",
                           .count = POINTS,
                           .x = x,
                           .y = y,
                           .duration = 8,
                           .clock = "a round: 4 s"};
}

static char *drawn(const imk_animation *animation)
{
    char *svg = NULL;
    size_t size = 0;
    imk_error error;
    CHECK_OK(imk_animation_svg(animation, &svg, &size, &error));
    assert_int_equal(strlen(svg), size);
    return svg;
}

/* Number i of a list that an attribute holds. */
static double element(const char *svg, const char *attribute, int i)
{
    const char *at = strstr(svg, attribute);
    assert_non_null(at);
    at += strlen(attribute);
    for (; i > 0; i--) {
        at = strchr(at, ';');
        assert_non_null(at);
        at++;
    }
    return strtod(at, NULL);
}

/* The lists have 401 moments: 200 is the middle of the round, where the walker sets out, 300 half
 * of the way; places are in millionths. */
static void test_walker_keeps_time(void **state)
{
    (void)state;
    const imk_animation animation = line();
    char *svg = drawn(&animation);
    CHECK_CLOSE(element(svg, "keyTimes=\"", 300), 0.75, 1e-6);
    CHECK_CLOSE(element(svg, "keyPoints=\"", 0), 0.0, 0.0);
    CHECK_CLOSE(element(svg, "keyPoints=\"", 200), 0.0, 1e-6);
    CHECK_CLOSE(element(svg, "keyPoints=\"", 300), 0.5,
                1e-4); /* the path is in tenths of a pixel */
    CHECK_CLOSE(element(svg, "keyPoints=\"", 400), 1.0, 0.0);
    assert_non_null(strstr(svg, "dur=\"8000ms\""));
    /* points that fall on one another are drawn once */
    const char *track = strstr(svg, "id=\"track\"");
    assert_non_null(track);
    int steps = 0;
    for (const char *c = strstr(track, " d=\"") + 4; *c != '"'; c++)
        steps += *c == 'l';
    assert_int_equal(steps, 2);
    free(svg);
}

/* A path that jumps: the places of its three different points, and when they are taken. */
static void test_hops(void **state)
{
    (void)state;
    imk_animation animation = line();
    animation.points = true;
    char *svg = drawn(&animation);
    const double first = element(svg,
                                 "attributeName=\"cx\" calcMode=\"discrete\" dur=\"8000ms\" "
                                 "begin=\"13330ms\" repeatCount=\"indefinite\" values=\"",
                                 0);
    const double last = element(svg, "begin=\"0ms\" repeatCount=\"indefinite\" values=\"", 2);
    assert_true(last > first);
    CHECK_CLOSE(element(svg, "keyTimes=\"", 0), 0.0, 0.0);
    CHECK_CLOSE(element(svg, "keyTimes=\"", 1), 0.6, 1e-6);
    CHECK_CLOSE(element(svg, "keyTimes=\"", 2), 0.8, 1e-6);
    assert_null(strstr(svg, "animateMotion"));
    free(svg);
}

static void test_text_and_stillness(void **state)
{
    (void)state;
    const imk_animation animation = line();
    char *svg = drawn(&animation);
    assert_non_null(strstr(svg, ">a &lt; b</text>"));
    assert_non_null(strstr(svg, "aria-label=\"a &lt; b\""));
    assert_non_null(strstr(svg, "@media (prefers-reduced-motion:reduce){.moving{display:none}}"));
    assert_non_null(strstr(svg, ">a round: 4 s</text>"));
    assert_null(strstr(svg, "<script"));
    assert_null(strstr(svg, "nan"));
    free(svg);
}

/* A long path is thinned: its file stays small. */
static void test_long_path(void **state)
{
    (void)state;
    enum { LONG = 100000 };
    double *long_x = malloc(LONG * sizeof *long_x), *long_y = malloc(LONG * sizeof *long_y);
    assert_true(long_x && long_y);
    for (int i = 0; i < LONG; i++) {
        long_x[i] = cos(0.01 * i);
        long_y[i] = sin(0.0131 * i);
    }
    imk_animation animation = line();
    animation.count = LONG;
    animation.x = long_x;
    animation.y = long_y;
    for (int points = 0; points <= 1; points++) {
        animation.points = points;
        char *svg = drawn(&animation);
        assert_in_range(strlen(svg), 20000, 150000);
        free(svg);
    }
    free(long_x);
    free(long_y);
}

static int count_of(const char *text, const char *part)
{
    int count = 0;
    for (const char *at = strstr(text, part); at; at = strstr(at + 1, part))
        count++;
    return count;
}

/* A distance of ticks that no sum with the values can show (1 + 1e-17 is 1), and lengths that are
 * not finite or not normal numbers: 4 to 11 ticks for each axis, at numbers. */
static void test_every_range_has_few_ticks(void **state)
{
    (void)state;
    const double next = nextafter(1.0, 2.0), much = 1.7e308, little = 5e-324;
    const double ranges[][2] = {
        {1.0, next},   {-1.0, -next},    {1e300, 1e300 * next}, {-much, much},     {much, much},
        {0.0, little}, {1e-300, 2e-300}, {1.0, 1.0 + 1e-12},    {5.0, 5.0 + 2e-9}, {-1e-3, 1e-3}};
    for (size_t i = 0; i < sizeof ranges / sizeof ranges[0]; i++) {
        double values[POINTS];
        for (int k = 0; k < POINTS; k++)
            values[k] = ranges[i][k % 2];
        for (int turned = 0; turned <= 1; turned++) {
            imk_animation animation = line();
            animation.x = turned ? values : x;
            animation.y = turned ? y : values;
            char *svg = drawn(&animation);
            assert_in_range(count_of(svg, "class=\"grid\""), 8, 22);
            assert_null(strstr(svg, "nan"));
            assert_null(strstr(svg, "inf"));
            free(svg);
        }
    }
}

/* 1 to 1.00000001 with a twentieth of air: ticks 2e-9 apart have ten digits each. */
static void test_ticks_of_a_narrow_range_differ(void **state)
{
    (void)state;
    const double narrow[POINTS] = {1.0, 1.0, 1.0, 1.0 + 5e-9, 1.0 + 1e-8};
    imk_animation animation = line();
    animation.x = narrow;
    char *svg = drawn(&animation);
    assert_non_null(strstr(svg, ">1.000000002</text>"));
    assert_non_null(strstr(svg, ">1.000000008</text>"));
    free(svg);
}

static void test_refusals(void **state)
{
    (void)state;
    const double still[POINTS] = {1, 1, 1, 1, 1}, broken[POINTS] = {0, 1, (double)NAN, 1, 0};
    char *svg = NULL;
    size_t size;
    imk_error error;
    imk_animation animation = line();
    animation.count = 1;
    CHECK_STATUS(imk_animation_svg(&animation, &svg, &size, &error), IMK_ERROR_EMPTY);
    animation = line();
    animation.x = animation.y = still;
    CHECK_STATUS(imk_animation_svg(&animation, &svg, &size, &error), IMK_ERROR_EMPTY);
    animation.x = broken;
    CHECK_STATUS(imk_animation_svg(&animation, &svg, &size, &error), IMK_ERROR_NOT_FINITE);
    animation = line();
    animation.duration = (double)NAN;
    CHECK_STATUS(imk_animation_svg(&animation, &svg, &size, &error), IMK_ERROR_RANGE);
    assert_string_equal(error.field, "duration");
    animation = line();
    CHECK_STATUS(imk_animation_write(&animation, "/tmp/a.png", &error), IMK_ERROR_FORMAT);
    CHECK_STATUS(imk_animation_write(&animation, "/nonexistent/a.svg", &error), IMK_ERROR_OPEN);
    assert_null(svg);
}

/* In a page every drawing has identifiers of its own. */
static void test_page(void **state)
{
    (void)state;
    const imk_animation animation = line();
    imk_error error;
    char *text;
    size_t size;
    imki_page *page = imki_page_create("t", "s", true);
    imki_page_animation(page, &animation, "first > one");
    imki_page_animation(page, &animation, "second");
    imki_page_animation(NULL, &animation, "no page");
    CHECK_OK(imki_page_take(page, &text, &size, &error));
    const char *first = strstr(text, "<defs><path id=\""),
               *second = strstr(first + 1, "<defs><path");
    assert_memory_equal(first + 25, "-track\"", 7);
    assert_memory_not_equal(first, second, 25);
    assert_memory_equal(strstr(second, "href=\"#") + 7, second + 16, 15);
    assert_non_null(strstr(text, "<figcaption>first &gt; one</figcaption>"));
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_walker_keeps_time),
        cmocka_unit_test(test_hops),
        cmocka_unit_test(test_text_and_stillness),
        cmocka_unit_test(test_long_path),
        cmocka_unit_test(test_every_range_has_few_ticks),
        cmocka_unit_test(test_ticks_of_a_narrow_range_differ),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_page),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
