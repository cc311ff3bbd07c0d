/* SPDX-License-Identifier: Apache-2.0 */
/* Allan deviations: of a record with intervals, and the plain statistic of one array. */
#include "extension.h"

#include "imukit/show.h"

#include <string.h>

static const setting allan_rows[] = {
#define ROW(field, kind, words)                                                                    \
    {                                                                                              \
#field, kind, offsetof(imk_allan_log_settings, field), words                               \
    }
    ROW(gaps, SETTING_CHOICE, "refuse|bridge|longest|keep"),
    ROW(phase, SETTING_FLAG, NULL),
    ROW(confidence, SETTING_NUMBER, NULL),
    ROW(greenhall_riley, SETTING_FLAG, NULL),
    ROW(bias, SETTING_CHOICE, "removed|published|left"),
    ROW(grid, SETTING_CHOICE, "octave|decade|all|many"),
#undef ROW
};

/* The statistic of a name; IMK_ALLAN_STATISTICS with an exception for another word. */
static imk_allan_statistic statistic_of(PyObject *object)
{
    const char *text = PyUnicode_AsUTF8AndSize(object, NULL);
    for (size_t k = 0; text && k < IMK_ALLAN_STATISTICS; k++)
        if (strcmp(text, imk_allan_name((imk_allan_statistic)k)) == 0)
            return (imk_allan_statistic)k;
    if (text)
        PyErr_Format(PyExc_ValueError,
                     "statistic='%s': expected oadev, adev, mdev, tdev, ohdev, hdev, totdev, mtot, "
                     "htot, theo1, pdev or haar",
                     text);
    return IMK_ALLAN_STATISTICS;
}

static bool read_statistics(PyObject *names, imk_allan_log_settings *s)
{
    s->statistic_count = 0;
    for (Py_ssize_t k = 0; k < PyTuple_Size(names); k++) {
        const imk_allan_statistic statistic = statistic_of(PyTuple_GetItem(names, k));
        if (statistic == IMK_ALLAN_STATISTICS)
            return false;
        for (size_t i = 0; i < s->statistic_count; i++)
            if (s->statistic[i] == statistic) {
                PyErr_Format(PyExc_ValueError, "statistic: %s is named twice",
                             imk_allan_name(statistic));
                return false;
            }
        s->statistic[s->statistic_count++] = statistic;
    }
    if (s->statistic_count == 0)
        PyErr_SetString(PyExc_ValueError, "statistic: none is named");
    return s->statistic_count > 0;
}

/* allan(record, statistics, times, settings, threads, progress) -> (result, findings) */
static PyObject *allan(PyObject *module, PyObject *args)
{
    PyObject *object, *names, *list, *dictionary, *progress, *made = NULL;
    int threads;
    imk_allan_log_settings s = imk_allan_log_default();
    columns times = {0};
    work w;
    (void)module;
    if (!PyArg_ParseTuple(args, "OO!OO!iO", &object, &PyTuple_Type, &names, &list, &PyDict_Type,
                          &dictionary, &threads, &progress) ||
        !SETTINGS_READ(dictionary, allan_rows, &s) || !read_statistics(names, &s))
        return NULL;
    if (list != Py_None && !columns_take(list, &times)) {
        columns_release(&times);
        return NULL;
    }
    s.times = times.data[0];
    s.time_count = times.rows;
    record *r = record_begin(object);
    if (r && work_begin(&w, threads, progress)) {
        imk_allan_log *log = NULL;
        imk_error error;
        const imk_status status = imk_allan_log_run(&r->source, &s, &w.job, &log, &error);
        if (work_end(&w) && status != IMK_OK)
            raise_failure(log ? &log->findings : NULL, &error, r->name, "the model");
        imk_result *shown = PyErr_Occurred() ? NULL : begin_result("allan");
        if (shown) {
            imk_show_allan_log(log, r->name, shown);
            made = result_with(shown, &log->findings, r->name, "the model");
        }
        imk_allan_log_free(log);
    }
    if (r)
        record_end(r);
    columns_release(&times);
    return made;
}

PyMethodDef allan_functions[] = {
    {"allan", allan, METH_VARARGS,
     "allan(record, statistics, times, settings, threads, progress): deviations with intervals."},
    {NULL, NULL, 0, NULL}};
