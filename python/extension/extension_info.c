/* SPDX-License-Identifier: Apache-2.0 */
/* What is in a log. */
#include "extension.h"

#include "imukit/io.h"
#include "imukit/show.h"

enum { STREAMS_MAX = 256 };

static PyObject *show(const imk_info_log *info, const imk_info_file *file, const char *name)
{
    const imk_findings none = {.count = 0};
    imk_result *shown = begin_result("info");
    if (!shown)
        return NULL;
    imk_show_info_log(info, file, name, NULL, shown);
    return result_with(shown, info ? &info->findings : &none, name, "the model");
}

static PyObject *look(record *r, const imk_info_file *file, bool full, PyObject *progress)
{
    imk_info_log_settings s = imk_info_log_default();
    PyObject *made = NULL;
    work w;
    s.full = full;
    if (file->chosen && !file->chosen->estimated)
        s.rows = file->chosen->samples;
    if (!work_begin(&w, 1, progress))
        return NULL;
    imk_info_log *info = NULL;
    imk_error error;
    const imk_status status = imk_info_log_run(&r->source, &s, &w.job, &info, &error);
    if (work_end(&w) && status != IMK_OK && !(info && info->rows_read > 0))
        raise_failure(info ? &info->findings : NULL, &error, r->name, "the model");
    made = PyErr_Occurred() ? NULL : show(info, file, r->name);
    imk_info_log_free(info);
    return made;
}

/* Add what is missing as a finding. */
static PyObject *with_lack(PyObject *made, const imk_error *lacking, const char *path)
{
    char text[1200];
    PyObject *findings = made ? PyTuple_GetItem(made, 1) : NULL;
    if (!findings || lacking->status == IMK_OK)
        return made;
    imk_error_text(lacking, path, text, sizeof text);
    PyObject *item = Py_BuildValue("(isss)", (int)IMK_FINDING_WARNING,
                                   imk_status_name(lacking->status), text, lacking->field);
    if (!item || PyList_Append(findings, item) != 0)
        Py_CLEAR(made);
    Py_XDECREF(item);
    return made;
}

/* None of the sensors is chosen: they are listed. What was asked for and is not there remains an
 * error. */
static PyObject *list(const char *path, const imk_log_settings *settings, const imk_error *why,
                      imk_log_stream *stream)
{
    imk_info_file file = {.stream = stream};
    const imk_log_format *format;
    const bool asked = settings->topic || settings->instance > 0;
    if (asked ||
        imk_log_streams(path, settings, STREAMS_MAX, stream, &file.stream_count, &format, NULL) !=
            IMK_OK ||
        file.stream_count == 0)
        return raise_error(why, path);
    file.format = format->title;
    file.stream_count = file.stream_count < STREAMS_MAX ? file.stream_count : STREAMS_MAX;
    return with_lack(show(NULL, &file, path), why, path);
}

static PyObject *of_reader(imk_log_reader *reader, const imk_log_settings *settings,
                           imk_log_stream *stream, const char *path, bool full, PyObject *progress)
{
    imk_info_file file = {.stream = stream};
    file.format = imk_log_format_read(reader)->title;
    file.stream_count = imk_log_stream_list(reader, STREAMS_MAX, stream);
    file.stream_count = file.stream_count < STREAMS_MAX ? file.stream_count : STREAMS_MAX;
    file.chosen = imk_log_stream_get(reader);
    imk_log_stream part;
    if (file.chosen && (settings->after > 0 || settings->before > 0)) { /* of fewer rows */
        part = *file.chosen;
        part.samples = 0;
        file.chosen = &part;
    }
    PyObject *r = record_of_reader(reader, path);
    PyObject *made = r ? look((record *)r, &file, full, progress) : NULL;
    Py_XDECREF(r);
    return made;
}

/* info(path, settings, full, progress) -> (result, findings) */
static PyObject *info(PyObject *module, PyObject *args)
{
    PyObject *path, *dictionary, *progress, *made = NULL;
    int full;
    imk_log_settings settings = imk_log_default();
    imk_log_reader *reader = NULL;
    imk_error error, lacking;
    (void)module;
    if (!PyArg_ParseTuple(args, "O&O!pO", PyUnicode_FSConverter, &path, &PyDict_Type, &dictionary,
                          &full, &progress))
        return NULL;
    const char *name = PyBytes_AsString(path);
    imk_log_stream *stream = PyMem_Malloc(STREAMS_MAX * sizeof *stream);
    if (!stream) {
        PyErr_NoMemory();
    } else if (log_settings_read(dictionary, &settings)) {
        settings.any_columns = true;
        PyThreadState *state = PyEval_SaveThread();
        const imk_status status =
            imk_log_open_first_look(name, &settings, &reader, &lacking, &error);
        PyEval_RestoreThread(state);
        if (status == IMK_OK)
            made = with_lack(of_reader(reader, &settings, stream, name, full, progress), &lacking,
                             name);
        else if (status == IMK_ERROR_NAME_UNKNOWN)
            made = list(name, &settings, &error, stream);
        else
            raise_error(&error, name);
    }
    PyMem_Free(stream);
    Py_DECREF(path);
    return made;
}

/* info_record(record, full, progress) -> (result, findings) */
static PyObject *info_record(PyObject *module, PyObject *args)
{
    PyObject *object, *progress, *made = NULL;
    int full;
    (void)module;
    if (!PyArg_ParseTuple(args, "OpO", &object, &full, &progress))
        return NULL;
    record *r = record_begin(object);
    if (r) {
        made = look(r, &(imk_info_file){.format = "columns in memory"}, full, progress);
        record_end(r);
    }
    return made;
}

PyMethodDef info_functions[] = {
    {"info", info, METH_VARARGS, "info(path, settings, full, progress): what is in a log."},
    {"info_record", info_record, METH_VARARGS,
     "info_record(record, full, progress): what is in columns."},
    {NULL, NULL, 0, NULL}};
