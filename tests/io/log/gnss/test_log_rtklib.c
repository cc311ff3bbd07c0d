/* SPDX-License-Identifier: Apache-2.0 */
/* Solution files of RTKLIB: the layouts that it writes, their times, and damage. */
#include "check.h"

#include "imukit/log.h"

#include <string.h>

#define NAMES "Q  ns   sdn(m)   sde(m)   sdu(m)  sdne(m)  sdeu(m)  sdun(m) age(s)  ratio"

static imk_status open_text(const char *text, imk_log_reader **reader, imk_error *error)
{
    imk_log_settings settings = imk_log_default();
    settings.any_columns = true;
    return imk_log_open_memory(text, strlen(text), &settings, reader, error);
}

static size_t read_all(imk_log_reader *reader, double data[IMK_LOG_COLUMNS_MAX][8])
{
    double *columns[IMK_LOG_COLUMNS_MAX];
    size_t rows, all = 0;
    imk_error error;
    do {
        for (size_t c = 0; c < IMK_LOG_COLUMNS_MAX; c++)
            columns[c] = data[c] + all;
        CHECK_OK(imk_log_read(reader, 8 - all, columns, &rows, &error));
        all += rows;
    } while (rows > 0 && all < 8);
    return all;
}

static double value(const imk_log_reader *reader, double data[IMK_LOG_COLUMNS_MAX][8],
                    const char *name, size_t row)
{
    for (size_t c = 0; c < imk_log_column_count(reader); c++)
        if (strcmp(imk_log_column_get(reader, c)->name, name) == 0)
            return data[c][row];
    fail_msg("no column %s", name);
    return 0.0;
}

static const double degree = 0.017453292519943295;

/* The same two instants in all forms. 2024-05-18 is day 19861 of 1970: 54 years with 13 leap days,
 * and 138 days of 2024. It begins second 518400 of GPS week 2314, as headers of RTKLIB say. */
static void test_layouts(void **state)
{
    (void)state;
    static const struct {
        const char *text, *name;
        double due[2];
    } files[] = {
        {"% program   : RTKPOST ver.2.4.3 b34\r\n"
         "%  GPST                  latitude(deg) longitude(deg)  height(m)   " NAMES "\r\n"
         "2024/05/18 00:00:00.000   45.500000000    7.000000000   300.2500   1   8   0.0117   "
         "0.0063"
         "   0.0128   0.0056   0.0048   0.0097   0.00    2.6\r\n"
         "2024/05/18 00:00:30.500   45.600000000    7.000000000   301.2500   1   8   0.0117   "
         "0.0063"
         "   0.0128   0.0056   0.0048   0.0097   0.00    3.6\r\n",
         "latitude",
         {45.5 * 0.017453292519943295, 45.6 * 0.017453292519943295}},
        {"%  GPST       latitude(d'\")   longitude(d'\")  height(m)   Q\n"
         "2314 518400.000  -45 30 36.0    7 00 00.0   300.2500   1\n"
         "2314 518430.500  -0 30 00.0    7 00 00.0   300.2500   1\n",
         "latitude",
         {-45.51 * 0.017453292519943295, -0.5 * 0.017453292519943295}},
        {"%  UTC,x-ecef(m),y-ecef(m),z-ecef(m),Q,ns,sdx(m)\n"
         "2024/05/18,00:00:00.000,3655334.3694,1403901.2189,5018038.3221,2,8,1.1580\n"
         "2024/05/18,00:00:30.500,3655333.8112,1403901.0398,5018037.9883,1,8,0.0117\n",
         "ecef_y",
         {1403901.2189, 1403901.0398}},
        {"%  GPST   e-baseline(m)  n-baseline(m)  u-baseline(m)  Q  sde(m) sdn(m) sdu(m) vn(m/s) "
         "ve(m/s) vu(m/s) sdvn\n"
         "2314 518400.000 1 2 3 1 0.1 0.2 0.3 4 5 6 0.4\n"
         "2314 518430.500 1 2 4 1 0.1 0.2 0.3 4 5 7 0.4\n",
         "velocity_up",
         {6.0, 7.0}},
    };
    for (size_t k = 0; k < sizeof files / sizeof *files; k++) {
        static double data[IMK_LOG_COLUMNS_MAX][8];
        imk_log_reader *reader;
        imk_error error;
        CHECK_OK(open_text(files[k].text, &reader, &error));
        assert_string_equal(imk_log_format_read(reader)->name, "rtklib");
        assert_int_equal(read_all(reader, data), 2);
        CHECK_CLOSE(value(reader, data, files[k].name, 0), files[k].due[0], 1e-12);
        CHECK_CLOSE(value(reader, data, files[k].name, 1), files[k].due[1], 1e-12);
        CHECK_CLOSE(value(reader, data, "time", 1) - value(reader, data, "time", 0), 30.5, 1e-9);
        const imk_log_findings f = imk_log_findings_get(reader);
        assert_true(f.time_origin_nanoseconds == 19861LL * 86400 * 1000000000);
        assert_int_equal(f.damaged, 0);
        imk_log_close(reader);
    }
}

/* Lines that are no rows are left out and counted; a last one without an end is cut. Dates, weeks
 * and numbers that cannot be are such. */
static void test_damage(void **state)
{
    (void)state;
    static double data[IMK_LOG_COLUMNS_MAX][8];
    static const char text[] = "%  GPST latitude(deg) longitude(deg) height(m) Q\n"
                               "2314 518400 45 7 300 1\n"
                               "% a comment\n"
                               "2314 518401 45 7 300\n"
                               "2024/13/18 00:00:00 45 7 300 1\n"
                               "2024/05/18 00:61:00 45 7 300 1\n"
                               "99999 5 45 7 300 1\n"
                               "2314 518402 x 7 300 1\n"
                               "\n"
                               "2314 518403 45 7 301 1\n"
                               "2314 518404 45 7 3";
    imk_log_reader *reader;
    imk_error error;
    CHECK_OK(open_text(text, &reader, &error));
    assert_int_equal(read_all(reader, data), 2);
    CHECK_CLOSE(value(reader, data, "height", 1), 301.0, 0.0);
    CHECK_CLOSE(value(reader, data, "longitude", 1), 7.0 * degree, 1e-15);
    const imk_log_findings f = imk_log_findings_get(reader);
    assert_int_equal(f.damaged, 5);
    assert_true(f.cut_short);
    imk_log_close(reader);
    imk_log_settings settings = imk_log_default();
    settings.any_columns = true;
    settings.format = "rtklib";
    static const char headless[] = "2314 518400 45 7 300 1\n";
    CHECK_STATUS(imk_log_open_memory(headless, sizeof headless - 1, &settings, &reader, &error),
                 IMK_ERROR_FORMAT);
    CHECK_STATUS(open_text("%  GPST latitude(deg) longitude(deg)\n", &reader, &error),
                 IMK_ERROR_EMPTY);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_layouts),
                                       cmocka_unit_test(test_damage)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
