/* SPDX-License-Identifier: Apache-2.0 */
/* The jobs on an instrument from first principles: runs, views, error models, experiments. */
#include "extension_design.h"

#include "imukit/show.h"

#include <string.h>

static const setting run_rows[] = {
#define ROW(name, field, kind, words)                                                              \
    {                                                                                              \
        name, kind, offsetof(imk_physics_log_settings, field), words                               \
    }
    ROW("duration", duration, SETTING_QUANTITY, "s"),
    ROW("output_rate", physics.rate, SETTING_QUANTITY, "Hz"),
    ROW("level", physics.level, SETTING_CHOICE, "full|slow"),
    ROW("step", physics.step, SETTING_QUANTITY, "s"),
    ROW("noise", physics.noise, SETTING_FLAG, NULL),
    ROW("seed", physics.seed, SETTING_COUNT, NULL),
    ROW("sine", input.frequency, SETTING_QUANTITY, "Hz"),
    ROW("temperature", input.exposure.temperature, SETTING_QUANTITY, "K"),
    ROW("temperature_rate", input.temperature_rate, SETTING_QUANTITY, "K/s"),
    ROW("signal_rate", signal_rate, SETTING_QUANTITY, "Hz"),
    ROW("quick", quick, SETTING_FLAG, NULL),
    ROW("view_duration", view_duration, SETTING_QUANTITY, "s"),
    ROW("view_rate", view_rate, SETTING_QUANTITY, "Hz"),
    ROW("view_input", view_input, SETTING_FLAG, NULL),
#undef ROW
};

/* A number or text along x, a text with three numbers, or a sequence of three. */
static bool vector_read(PyObject *object, const char *name, const char *unit, double vector[3])
{
    double sigma[3];
    size_t count = 0;
    imk_error error;
    if (PyUnicode_Check(object)) {
        Py_ssize_t size;
        const char *text = PyUnicode_AsUTF8AndSize(object, &size);
        const imk_status status =
            text ? imk_quantity_parse(text, text + size, imk_unit_of(unit).dimension, 3, vector,
                                      sigma, &count, NULL, &error)
                 : IMK_OK;
        if (status != IMK_OK)
            raise_error(&error, name);
        else if (text && count == 2)
            PyErr_Format(PyExc_ValueError, "%s='%s': expected one number, or three", name, text);
        return !PyErr_Occurred();
    }
    if (!PySequence_Check(object))
        return quantity_read(object, name, unit, vector);
    if (PySequence_Size(object) != 3) {
        PyErr_Format(PyExc_ValueError, "%s: expected one number, or three", name);
        return false;
    }
    for (Py_ssize_t k = 0; k < 3; k++) {
        PyObject *item = PySequence_GetItem(object, k);
        const bool good = item && quantity_read(item, name, unit, &vector[k]);
        Py_XDECREF(item);
        if (!good)
            return false;
    }
    return true;
}

/* A job on a design, and what is shown of it. */
typedef struct call {
    design *design;
    imk_physics_log_settings settings;
    imk_model *model; /* by closed forms, one axis */
    const char *source;
} call;

static bool call_begin(PyObject *object, PyObject *dictionary, PyObject *rate,
                       PyObject *acceleration, unsigned int run, const char *source, call *c)
{
    design *d = design_of(object);
    *c = (call){.design = d, .settings = imk_physics_log_default(), .source = source};
    imk_physics_log_settings *s = &c->settings;
    imk_exposure *e = &s->input.exposure;
    if (!d || !SETTINGS_READ(dictionary, run_rows, s) ||
        !vector_read(rate, "rate", "rad/s", e->angular_rate) ||
        !vector_read(acceleration, "acceleration", "m/s^2", e->specific_force))
        return false;
    e->temperature_rate = s->input.temperature_rate;
    s->physics.run = run;
    s->instrument = d->file.instrument;
    s->design = d->file.design;
    c->model = PyMem_Calloc(1, sizeof *c->model);
    if (!c->model) {
        PyErr_NoMemory();
        return false;
    }
    imk_instrument_reduce(s->instrument, s->design, c->model);
    d->busy++;
    return true;
}

static void call_end(call *c)
{
    if (c->model)
        c->design->busy--;
    PyMem_Free(c->model);
}

/* @param findings  of a job; NULL: none */
static PyObject *refuse(const call *c, const imk_findings *findings, imk_error *error)
{
    imk_design_error_in_units(c->settings.instrument, c->settings.design, error);
    return raise_failure(findings, error, c->source, "the model");
}

static imk_result *show(const call *c, const imk_physics_log *run, const imk_physics_sweep *sweep,
                        bool reduced)
{
    const imk_physics_shown shown = {.settings = &c->settings,
                                     .source = c->source,
                                     .name = c->design->file.name,
                                     .description = c->design->file.description,
                                     .model = c->model,
                                     .reduced = reduced,
                                     .run = run,
                                     .sweep = sweep};
    imk_result *result = begin_result("physics");
    if (!result)
        return NULL;
    imk_show_physics(&shown, result);
    if (sweep)
        imk_show_physics_sweep(&shown, result);
    return result;
}

/* show_design(design, source): the design and what follows from it. */
static PyObject *show_design(PyObject *module, PyObject *args)
{
    call c = {0};
    PyObject *object;
    const char *source;
    static const imk_findings nothing = {.count = 0};
    PyObject *empty = PyDict_New(), *zero = PyLong_FromLong(0), *made = NULL;
    (void)module;
    if (PyArg_ParseTuple(args, "Os", &object, &source) && empty && zero) {
        if (call_begin(object, empty, zero, zero, 0, source, &c)) {
            imk_result *shown = show(&c, NULL, NULL, false);
            made = shown ? result_with(shown, &nothing, source, "the model") : NULL;
        }
        call_end(&c);
    }
    Py_XDECREF(empty);
    Py_XDECREF(zero);
    return made;
}

static PyObject *describe_columns(const imk_array_sink *sink)
{
    PyObject *list = PyList_New(0);
    char si[40];
    for (size_t k = 0; list && k < sink->columns; k++) {
        const imk_log_column *c = &sink->column[k];
        if (imk_dimension_si(c->unit.dimension, si, sizeof si) == 0)
            si[0] = '\0';
        if (!append(list, Py_BuildValue("(sss)", c->name, c->unit.text, si)))
            Py_CLEAR(list);
    }
    return list;
}

static bool begin_arrays(PyObject *list, columns *c, imk_array_sink *sink)
{
    if (list == Py_None || PyList_Size(list) == 0)
        return true;
    if (!columns_take_writable(list, c))
        return false;
    *sink = (imk_array_sink){.column_count = c->count, .capacity = c->rows, .data = c->data};
    return true;
}

/* run_design(design, settings, rate, acceleration, run, source, outputs, signals, progress) ->
 * (result, findings, columns of outputs, columns of signals) */
static PyObject *run_design(PyObject *module, PyObject *args)
{
    PyObject *object, *dictionary, *rate, *force, *outputs, *signals, *progress, *made = NULL;
    unsigned int number;
    const char *source;
    call c;
    columns out = {0}, in = {0};
    imk_array_sink out_sink = {0}, in_sink = {0};
    work w;
    (void)module;
    if (!PyArg_ParseTuple(args, "OO!OOIsOOO", &object, &PyDict_Type, &dictionary, &rate, &force,
                          &number, &source, &outputs, &signals, &progress))
        return NULL;
    if (call_begin(object, dictionary, rate, force, number, source, &c) &&
        begin_arrays(outputs, &out, &out_sink) && begin_arrays(signals, &in, &in_sink) &&
        work_begin(&w, 1, progress)) {
        const imk_record_sink to_out = imk_array_sink_of(&out_sink),
                              to_in = imk_array_sink_of(&in_sink);
        imk_physics_log *log = NULL;
        imk_error error;
        const imk_status status =
            imk_physics_log_run(&c.settings, out.count > 0 ? &to_out : NULL,
                                in.count > 0 ? &to_in : NULL, &w.job, &log, &error);
        if (work_end(&w) && status != IMK_OK)
            refuse(&c, log ? &log->findings : NULL, &error);
        imk_result *shown = PyErr_Occurred() ? NULL : show(&c, log, NULL, false);
        PyObject *both = shown ? result_with(shown, &log->findings, source, "the model") : NULL;
        if (both)
            made = Py_BuildValue("(NNN)", both, describe_columns(&out_sink),
                                 describe_columns(&in_sink));
        imk_physics_log_free(log);
    }
    columns_release(&in);
    columns_release(&out);
    call_end(&c);
    return made;
}

static PyObject *model_of_one(const design *d, const imk_model *model, bool single)
{
    imk_model *copy = PyMem_Malloc(sizeof *copy);
    if (!copy)
        return PyErr_NoMemory();
    *copy = *model;
    if (d->file.name[0]) {
        strncpy(copy->name, d->file.name, sizeof copy->name - 1);
        copy->name[sizeof copy->name - 1] = '\0';
    }
    if (!single)
        imk_model_three_axes(copy);
    PyObject *made = make_model(copy, NULL);
    PyMem_Free(copy);
    return made;
}

/* reduce_design(design, single_axis) -> model */
static PyObject *reduce_design(PyObject *module, PyObject *args)
{
    PyObject *object;
    int single;
    (void)module;
    if (!PyArg_ParseTuple(args, "Op", &object, &single))
        return NULL;
    const design *d = design_of(object);
    if (!d)
        return NULL;
    imk_model *model = PyMem_Calloc(1, sizeof *model);
    if (!model)
        return PyErr_NoMemory();
    imk_instrument_reduce(d->file.instrument, d->file.design, model);
    PyObject *made = model_of_one(d, model, single);
    PyMem_Free(model);
    return made;
}

/* sweep_design(design, settings, source, run, single_axis, threads, progress) -> ((result,
 * findings), model) */
static PyObject *sweep_design(PyObject *module, PyObject *args)
{
    PyObject *object, *dictionary, *progress, *made = NULL, *zero = PyLong_FromLong(0);
    unsigned int number;
    int single, threads;
    const char *source;
    call c = {0};
    work w;
    (void)module;
    if (PyArg_ParseTuple(args, "OO!sIpiO", &object, &PyDict_Type, &dictionary, &source, &number,
                         &single, &threads, &progress) &&
        zero && call_begin(object, dictionary, zero, zero, number, source, &c) &&
        work_begin(&w, threads, progress)) {
        imk_physics_sweep *found = NULL;
        imk_error error;
        const imk_status status = imk_physics_sweep_run(&c.settings, &w.job, &found, &error);
        if (work_end(&w) && status != IMK_OK)
            refuse(&c, NULL, &error);
        imk_result *shown = PyErr_Occurred() ? NULL : show(&c, NULL, found, true);
        PyObject *both = shown ? result_with(shown, &found->findings, source, "the model") : NULL;
        if (both)
            made =
                Py_BuildValue("(NN)", both, model_of_one(c.design, &found->result.model, single));
        imk_physics_sweep_free(found);
    }
    call_end(&c);
    Py_XDECREF(zero);
    return made;
}

/* (title, caption, label of x, label of y, names of the curves, numbers: x, then each curve) */
static PyObject *describe_view(const imk_physics_view *v)
{
    const imk_view *view = &v->view;
    const size_t vectors = 1 + (size_t)view->curve_count;
    PyObject *names = PyList_New(0);
    for (int k = 0; names && k < view->curve_count; k++)
        if (!append(names, PyUnicode_FromString(v->instrument->signals[view->y[k]].name)))
            Py_CLEAR(names);
    return Py_BuildValue("(ssssNy#)", view->title, view->caption, v->x_label, v->y_label, names,
                         (const char *)v->data, (Py_ssize_t)(vectors * v->points * sizeof(double)));
}

/* Run a view, add it to the figure and to the list. */
static bool add_view(const call *c, size_t index, bool always, imk_figure_builder *figure,
                     PyObject *list)
{
    imk_physics_view v = {0};
    imk_error error;
    work w;
    if (!work_begin(&w, 1, Py_None))
        return false;
    const imk_status status = imk_physics_view_run(&c->settings, index, &w.job, &v, &error);
    bool good = work_end(&w);
    if (good && status != IMK_OK)
        good = refuse(c, NULL, &error) != NULL;
    if (good && (always || !v.empty)) {
        imk_show_physics_panel(&v, figure);
        good = append(list, describe_view(&v));
    }
    imk_physics_view_free(&v);
    return good;
}

/* view_design(design, settings, rate, acceleration, run, source, which) -> ((result, findings),
 * list of views); which: title or number; None: all that show something */
static PyObject *view_design(PyObject *module, PyObject *args)
{
    PyObject *object, *dictionary, *rate, *force, *made = NULL;
    unsigned int number;
    const char *source, *which;
    static const imk_findings nothing = {.count = 0};
    call c;
    (void)module;
    if (!PyArg_ParseTuple(args, "OO!OOIsz", &object, &PyDict_Type, &dictionary, &rate, &force,
                          &number, &source, &which))
        return NULL;
    const design *d = design_of(object);
    if (!d)
        return NULL;
    const imk_instrument *i = d->file.instrument;
    const int one = which ? imk_physics_view_find(i, which) : -1;
    if (which && one < 0)
        return PyErr_Format(PyExc_ValueError,
                            "view '%s': expected 1 to %zu, or the beginning of the title of a view",
                            which, i->view_count);
    PyObject *list = PyList_New(0);
    imk_result *shown = NULL;
    if (call_begin(object, dictionary, rate, force, number, source, &c) && list)
        shown = show(&c, NULL, NULL, false);
    imk_figure_builder *figure =
        shown && i->view_count > 0 ? imk_result_figure(shown, i->title, 2, "") : NULL;
    for (size_t k = 0; figure && k < i->view_count && !PyErr_Occurred(); k++)
        if (one < 0 || (size_t)one == k)
            add_view(&c, k, one >= 0, figure, list);
    if (PyErr_Occurred())
        imk_result_free(shown);
    else
        made = Py_BuildValue("(NO)", result_with(shown, &nothing, source, "the model"), list);
    call_end(&c);
    Py_XDECREF(list);
    return made;
}

PyMethodDef physics_functions[] = {
    {"show_design", show_design, METH_VARARGS, "show_design(design, source): as a result."},
    {"run_design", run_design, METH_VARARGS,
     "run_design(design, settings, rate, acceleration, run, source, outputs, signals, progress)."},
    {"reduce_design", reduce_design, METH_VARARGS, "reduce_design(design, single_axis): a model."},
    {"sweep_design", sweep_design, METH_VARARGS,
     "sweep_design(design, settings, source, run, single_axis, threads, progress)."},
    {"view_design", view_design, METH_VARARGS,
     "view_design(design, settings, rate, acceleration, run, source, which)."},
    {NULL, NULL, 0, NULL}};
