/* SPDX-License-Identifier: Apache-2.0 */
/* Identification of the noise of a record. */
#include "extension.h"

#include "imukit/model_file.h"
#include "imukit/show.h"

#include <stdlib.h>
#include <string.h>

static const setting identify_rows[] = {
#define ROW(field, kind, words)                                                                    \
    {                                                                                              \
#field, kind, offsetof(imk_identify_log_settings, field), words                            \
    }
    ROW(gaps, SETTING_CHOICE, "refuse|bridge|longest|keep"),
    ROW(confidence, SETTING_NUMBER, NULL),
    ROW(significance, SETTING_NUMBER, NULL),
    ROW(take_out, SETTING_INT, NULL),
    ROW(from_allan, SETTING_FLAG, NULL),
    ROW(tolerance, SETTING_NUMBER, NULL),
    ROW(gauss_markov_max, SETTING_INT, NULL),
#undef ROW
};

/* The model of what was identified as the text of a file; None where it has no sensor. */
static PyObject *model_text(const imk_identify_log *log, const char *name)
{
    imk_model *model = PyMem_Malloc(sizeof *model);
    char *text = NULL;
    size_t size = 0;
    imk_error error;
    PyObject *made = NULL;
    if (!model)
        return PyErr_NoMemory();
    imk_identify_log_model(log, name, model);
    if (!model->gyro.present && !model->accel.present)
        made = Py_NewRef(Py_None);
    else if (imk_model_print(model, NULL, &text, &size, &error) == IMK_OK)
        made = PyUnicode_DecodeUTF8(text, (Py_ssize_t)size, "replace");
    else
        raise_error(&error, NULL);
    free(text);
    PyMem_Free(model);
    return made;
}

static PyObject *show(const imk_identify_log *log, const record *r, const char *name)
{
    imk_result *result = begin_result("identify");
    if (!result)
        return NULL;
    const imk_identify_shown shown = {
        .log = log, .name = r->name, .verdict = imk_identify_verdict(log, NULL, result)};
    imk_show_identify_log(&shown, result);
    PyObject *both = result_with(result, &log->findings, r->name, "the model");
    PyObject *text = both ? model_text(log, name) : NULL;
    PyObject *made =
        text ? PyTuple_Pack(3, PyTuple_GetItem(both, 0), PyTuple_GetItem(both, 1), text) : NULL;
    Py_XDECREF(text);
    Py_XDECREF(both);
    return made;
}

/* identify(record, name, settings, threads, progress) -> (result, findings, model) */
static PyObject *identify(PyObject *module, PyObject *args)
{
    PyObject *object, *dictionary, *progress, *made = NULL;
    const char *name;
    int threads;
    imk_identify_log_settings s = imk_identify_log_default();
    work w;
    (void)module;
    if (!PyArg_ParseTuple(args, "OsO!iO", &object, &name, &PyDict_Type, &dictionary, &threads,
                          &progress) ||
        !SETTINGS_READ(dictionary, identify_rows, &s))
        return NULL;
    record *r = record_begin(object);
    if (r && work_begin(&w, threads, progress)) {
        imk_identify_log *log = NULL;
        imk_error error;
        const imk_status status = imk_identify_log_run(&r->source, &s, &w.job, &log, &error);
        if (work_end(&w) && status != IMK_OK)
            raise_failure(log ? &log->findings : NULL, &error, r->name, "the model");
        made = PyErr_Occurred() ? NULL : show(log, r, name);
        imk_identify_log_free(log);
    }
    if (r)
        record_end(r);
    return made;
}

PyMethodDef identify_functions[] = {
    {"identify", identify, METH_VARARGS,
     "identify(record, name, settings, threads, progress): noise of a record at rest."},
    {NULL, NULL, 0, NULL}};

bool add_identify(PyObject *module)
{
    return PyModule_AddIntConstant(module, "SCREEN_OUTLIERS", IMK_SCREEN_OUTLIERS) == 0 &&
           PyModule_AddIntConstant(module, "SCREEN_STUCK", IMK_SCREEN_STUCK) == 0 &&
           PyModule_AddIntConstant(module, "SCREEN_SATURATED", IMK_SCREEN_SATURATED) == 0 &&
           PyModule_AddIntConstant(module, "SCREEN_WARM_UP", IMK_SCREEN_WARM_UP) == 0 &&
           PyModule_AddIntConstant(module, "SCREEN_TEMPERATURE", IMK_SCREEN_TEMPERATURE) == 0 &&
           PyModule_AddIntConstant(module, "SCREEN_ALL", IMK_SCREEN_ALL) == 0;
}
