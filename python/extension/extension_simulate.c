/* SPDX-License-Identifier: Apache-2.0 */
/* Motions, temperatures, and simulations whose rows are written into arrays of Python. */
#include "extension.h"

#include "imukit/motion_file.h"
#include "imukit/simulate_log.h"

#include <math.h>

/* ---- motion and temperature: capsules of their files ----------------------------------------- */

static const char motion_name[] = "imukit.motion", temperature_name[] = "imukit.temperature";

static void free_motion(PyObject *capsule)
{
    imk_motion_file_free(PyCapsule_GetPointer(capsule, motion_name));
}

const imk_motion_file *motion_of(PyObject *object)
{
    return PyCapsule_GetPointer(object, motion_name);
}

static void free_temperature(PyObject *capsule)
{
    imk_temperature_file_free(PyCapsule_GetPointer(capsule, temperature_name));
}

static PyObject *make_motion(imk_status status, imk_motion_file *file, const imk_error *error,
                             const char *source)
{
    if (status != IMK_OK)
        return raise_error(error, source);
    PyObject *capsule = PyCapsule_New(file, motion_name, free_motion);
    if (!capsule)
        imk_motion_file_free(file);
    return capsule;
}

static PyObject *make_temperature(imk_status status, imk_temperature_file *file,
                                  const imk_error *error, const char *source)
{
    if (status != IMK_OK)
        return raise_error(error, source);
    PyObject *capsule = PyCapsule_New(file, temperature_name, free_temperature);
    if (!capsule)
        imk_temperature_file_free(file);
    return capsule;
}

/* A place (latitude, height), or None. @return false with an exception */
static bool read_place(PyObject *object, imk_geodetic *place, const imk_geodetic **stated)
{
    *stated = object == Py_None ? NULL : place;
    *place = (imk_geodetic){0};
    return object == Py_None ||
           PyArg_ParseTuple(object, "dd", &place->latitude, &place->height) != 0;
}

/* open_motion(path, rate, place, seed) */
static PyObject *open_motion(PyObject *module, PyObject *args)
{
    PyObject *path, *where, *made = NULL;
    unsigned long long seed;
    imk_geodetic place;
    const imk_geodetic *stated;
    imk_log_settings settings = imk_log_default();
    imk_motion_file *file = NULL;
    imk_error error;
    (void)module;
    if (!PyArg_ParseTuple(args, "O&dOK", PyUnicode_FSConverter, &path, &settings.rate, &where,
                          &seed))
        return NULL;
    if (read_place(where, &place, &stated)) {
        const char *name = PyBytes_AsString(path);
        PyThreadState *state = PyEval_SaveThread();
        const imk_status status = imk_motion_read(name, &settings, stated, seed, &file, &error);
        PyEval_RestoreThread(state);
        made = make_motion(status, file, &error, name);
    }
    Py_DECREF(path);
    return made;
}

/* parse_motion(text, place, seed) */
static PyObject *parse_motion(PyObject *module, PyObject *args)
{
    const char *text;
    Py_ssize_t size;
    PyObject *where;
    unsigned long long seed;
    imk_geodetic place;
    const imk_geodetic *stated;
    imk_motion_file *file = NULL;
    imk_error error;
    (void)module;
    if (!PyArg_ParseTuple(args, "s#OK", &text, &size, &where, &seed) ||
        !read_place(where, &place, &stated))
        return NULL;
    const imk_status status = imk_motion_parse(text, (size_t)size, stated, seed, &file, &error);
    return make_motion(status, file, &error, "the motion");
}

/* motion_of_record(record, place) */
static PyObject *motion_of_record(PyObject *module, PyObject *args)
{
    PyObject *object, *where;
    imk_geodetic place;
    const imk_geodetic *stated;
    imk_motion_file *file = NULL;
    imk_error error;
    (void)module;
    if (!PyArg_ParseTuple(args, "OO", &object, &where) || !read_place(where, &place, &stated))
        return NULL;
    record *r = record_begin(object);
    if (!r)
        return NULL;
    const imk_status status = imk_motion_of_record(&r->source, stated, &file, &error);
    record_end(r);
    return make_motion(status, file, &error, "the motion");
}

/* describe_motion(motion) -> (kind, duration, name, note, text or None) */
static PyObject *describe_motion(PyObject *module, PyObject *capsule)
{
    static const char *const kinds[] = {
        [IMK_MOTION_SCRIPT] = "script",
        [IMK_MOTION_POSES] = "poses",
        [IMK_MOTION_RECORDED] = "recorded",
    };
    const imk_motion_file *file = PyCapsule_GetPointer(capsule, motion_name);
    (void)module;
    if (!file)
        return NULL;
    const imk_recorded_motion *recorded = imk_motion_file_motion(file)->recorded;
    return Py_BuildValue("(sdsNzd)", kinds[imk_motion_file_kind(file)],
                         imk_motion_file_duration(file), imk_motion_file_name(file),
                         told_text(imk_motion_file_note(file)), imk_motion_file_text(file),
                         recorded ? recorded->rate : 0.0);
}

/* open_temperature(path or quantity) */
static PyObject *open_temperature(PyObject *module, PyObject *args)
{
    PyObject *path;
    imk_temperature_file *file = NULL;
    imk_error error;
    (void)module;
    if (!PyArg_ParseTuple(args, "O&", PyUnicode_FSConverter, &path))
        return NULL;
    const char *name = PyBytes_AsString(path);
    const imk_status status = imk_temperature_read(name, &file, &error);
    PyObject *made = make_temperature(status, file, &error, name);
    Py_DECREF(path);
    return made;
}

/* temperature_of_record(record) */
static PyObject *temperature_of_record(PyObject *module, PyObject *object)
{
    imk_temperature_file *file = NULL;
    imk_error error;
    (void)module;
    record *r = record_begin(object);
    if (!r)
        return NULL;
    const imk_status status = imk_temperature_of_record(&r->source, &file, &error);
    record_end(r);
    return make_temperature(status, file, &error, "the temperature");
}

/* ---- simulations ----------------------------------------------------------------------------- */

static const setting simulate_rows[] = {
#define ROW(field, kind, words)                                                                    \
    {                                                                                              \
#field, kind, offsetof(imk_simulate_log_settings, simulation.field), words                 \
    }
    ROW(rate, SETTING_QUANTITY, "Hz"),
    ROW(seed, SETTING_COUNT, NULL),
    ROW(earth, SETTING_FLAG, NULL),
    ROW(latitude, SETTING_QUANTITY, "rad"),
    ROW(height, SETTING_QUANTITY, "m"),
    ROW(roll, SETTING_QUANTITY, "rad"),
    ROW(pitch, SETTING_QUANTITY, "rad"),
    ROW(yaw, SETTING_QUANTITY, "rad"),
    ROW(substeps, SETTING_SIZE, NULL),
#undef ROW
    {"increments", SETTING_FLAG, offsetof(imk_simulate_log_settings, increments), NULL},
    {"field_north", SETTING_QUANTITY, offsetof(imk_simulate_log_settings, simulation.field[0]),
     "T"},
    {"field_east", SETTING_QUANTITY, offsetof(imk_simulate_log_settings, simulation.field[1]), "T"},
    {"field_down", SETTING_QUANTITY, offsetof(imk_simulate_log_settings, simulation.field[2]), "T"},
};

static PyObject *simulation_type;

typedef struct simulation {
    PyObject_HEAD imk_model model;
    imk_simulate_log_settings settings;
    imk_simulated_rows *rows;
    PyObject *motion, *temperature; /* capsules that the settings point into; NULL: none */
    imk_findings findings;
    bool busy;
} simulation;

static void simulation_free(PyObject *self)
{
    simulation *s = (simulation *)self;
    PyTypeObject *type = Py_TYPE(self);
    imk_simulated_rows_free(s->rows);
    Py_XDECREF(s->motion);
    Py_XDECREF(s->temperature);
    ((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
    Py_DECREF(type);
}

/* What the settings point to. @return false with an exception */
static bool take_scene(simulation *s, PyObject *motion, PyObject *temperature, double *length)
{
    *length = HUGE_VAL;
    if (motion != Py_None) {
        const imk_motion_file *file = PyCapsule_GetPointer(motion, motion_name);
        if (!file)
            return false;
        s->motion = Py_NewRef(motion);
        s->settings.simulation.motion = *imk_motion_file_motion(file);
        *length = imk_motion_file_duration(file);
    }
    if (temperature != Py_None) {
        const imk_temperature_file *file = PyCapsule_GetPointer(temperature, temperature_name);
        if (!file)
            return false;
        s->temperature = Py_NewRef(temperature);
        s->settings.simulation.temperature = imk_temperature_file_profile(file);
    }
    return true;
}

/* simulation(model, settings, run, duration, motion, temperature); duration NaN: the whole */
static PyObject *new_simulation(PyObject *module, PyObject *args)
{
    PyObject *object, *dictionary, *motion, *temperature;
    unsigned long run;
    double duration, length;
    imk_error error;
    (void)module;
    if (!PyArg_ParseTuple(args, "OO!kdOO", &object, &PyDict_Type, &dictionary, &run, &duration,
                          &motion, &temperature))
        return NULL;
    const model_object *model = model_of(object);
    simulation *s =
        model ? (simulation *)PyType_GenericAlloc((PyTypeObject *)simulation_type, 0) : NULL;
    if (!s)
        return NULL;
    s->model = model->model;
    s->settings = imk_simulate_log_default();
    s->settings.simulation.run = (uint32_t)run;
    bool good = SETTINGS_READ(dictionary, simulate_rows, &s->settings) &&
                take_scene(s, motion, temperature, &length);
    if (good) {
        imk_status status = imk_simulate_log_complete(&s->model, duration, length, &s->settings,
                                                      &s->findings, &error);
        if (status == IMK_OK)
            status = imk_simulated_rows_start(&s->model, &s->settings, NULL, &s->rows, &error);
        good = status == IMK_OK;
        if (!good)
            raise_error(&error, NULL);
    }
    if (!good)
        Py_CLEAR(s);
    return (PyObject *)s;
}

/* columns -> list of (name, unit, SI unit) */
static PyObject *list_columns(const imk_log_column *column, size_t count)
{
    PyObject *list = PyList_New(0);
    for (size_t k = 0; list && k < count; k++) {
        char si[40];
        if (imk_dimension_si(column[k].unit.dimension, si, sizeof si) == 0)
            si[0] = '\0';
        PyObject *item = Py_BuildValue("(sss)", column[k].name, column[k].unit.text, si);
        if (!item || PyList_Append(list, item) != 0)
            Py_CLEAR(list);
        Py_XDECREF(item);
    }
    return list;
}

static PyObject *simulation_columns(PyObject *self, PyObject *none)
{
    size_t count;
    (void)none;
    const imk_log_column *column = imk_simulated_rows_columns(((simulation *)self)->rows, &count);
    return list_columns(column, count);
}

/* Rows that are to come; None: without end. */
static PyObject *simulation_left(PyObject *self, PyObject *none)
{
    const uint64_t left = imk_simulated_rows_left(((simulation *)self)->rows);
    (void)none;
    return left < UINT64_MAX ? PyLong_FromUnsignedLongLong(left) : Py_NewRef(Py_None);
}

static PyObject *simulation_findings(PyObject *self, PyObject *name)
{
    const char *motion = utf8_of(name, NULL);
    return motion ? list_findings(&((simulation *)self)->findings, motion, "the model") : NULL;
}

static bool begin(simulation *s)
{
    if (s->busy)
        PyErr_SetString(PyExc_RuntimeError, "another thread takes rows from this simulation");
    const bool free = !s->busy;
    s->busy = true;
    return free;
}

/* next(arrays, threads, progress) -> rows made */
static PyObject *simulation_next(PyObject *self, PyObject *args)
{
    simulation *s = (simulation *)self;
    PyObject *list, *progress, *made = NULL;
    int threads;
    size_t rows = 0, count;
    columns c;
    work w;
    imk_error error;
    if (!PyArg_ParseTuple(args, "OiO", &list, &threads, &progress) || !begin(s))
        return NULL;
    if (columns_take_writable(list, &c)) {
        (void)imk_simulated_rows_columns(s->rows, &count);
        if (c.count != count) {
            PyErr_Format(PyExc_ValueError, "%zu arrays for %zu columns", c.count, count);
        } else if (work_begin(&w, threads, progress)) {
            const imk_status status = imk_simulated_rows_next(s->rows, c.rows, c.data, "simulating",
                                                              &w.job, &rows, &error);
            if (work_end(&w))
                made = status == IMK_OK ? PyLong_FromSize_t(rows) : raise_error(&error, NULL);
        }
    }
    columns_release(&c);
    s->busy = false;
    return made;
}

/* truth(arrays, threads, progress) -> columns that were written */
static PyObject *simulation_truth(PyObject *self, PyObject *args)
{
    simulation *s = (simulation *)self;
    PyObject *list, *progress, *made = NULL;
    int threads;
    columns c;
    work w;
    imk_error error;
    if (!PyArg_ParseTuple(args, "OiO", &list, &threads, &progress) || !begin(s))
        return NULL;
    if (columns_take_writable(list, &c) && work_begin(&w, threads, progress)) {
        imk_array_sink arrays = {.column_count = c.count, .capacity = c.rows, .data = c.data};
        const imk_record_sink sink = imk_array_sink_of(&arrays);
        const imk_status status =
            imk_simulate_truth_run(&s->model, &s->settings, &sink, &w.job, &error);
        if (work_end(&w))
            made = status == IMK_OK ? list_columns(arrays.column, arrays.columns)
                                    : raise_error(&error, NULL);
    }
    columns_release(&c);
    s->busy = false;
    return made;
}

PyMethodDef simulate_functions[] = {
    {"open_motion", open_motion, METH_VARARGS, "open_motion(path, rate, place, seed)."},
    {"parse_motion", parse_motion, METH_VARARGS, "parse_motion(text, place, seed)."},
    {"motion_of_record", motion_of_record, METH_VARARGS, "motion_of_record(record, place)."},
    {"describe_motion", describe_motion, METH_O, "describe_motion(motion): its kind and length."},
    {"open_temperature", open_temperature, METH_VARARGS, "open_temperature(path or quantity)."},
    {"temperature_of_record", temperature_of_record, METH_O, "temperature_of_record(record)."},
    {"simulation", new_simulation, METH_VARARGS,
     "simulation(model, settings, run, duration, motion, temperature): rows to be taken."},
    {NULL, NULL, 0, NULL}};

static PyMethodDef methods[] = {
    {"columns", simulation_columns, METH_NOARGS, "columns(): (name, unit, SI unit) of each."},
    {"left", simulation_left, METH_NOARGS, "left(): rows to come; None: without end."},
    {"findings", simulation_findings, METH_O, "findings(motion): what is left out."},
    {"next", simulation_next, METH_VARARGS, "next(arrays, threads, progress): rows made."},
    {"truth", simulation_truth, METH_VARARGS, "truth(arrays, threads, progress): its columns."},
    {NULL, NULL, 0, NULL}};

static PyType_Slot slots[] = {
    {Py_tp_dealloc, (void *)simulation_free}, {Py_tp_methods, methods}, {0, NULL}};
static PyType_Spec spec = {.name = "imukit._core.Simulation",
                           .basicsize = sizeof(simulation),
                           .flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION,
                           .slots = slots};

bool add_simulate(PyObject *module)
{
    simulation_type = PyType_FromSpec(&spec);
    return simulation_type && PyModule_AddObjectRef(module, "Simulation", simulation_type) == 0;
}
