/* SPDX-License-Identifier: Apache-2.0 */
/* Sensors that are stepped. A step of one sensor takes well under a microsecond, so it keeps the
 * interpreter's lock; many sensors let it go. */
#include "extension.h"

#include "imukit/sensor.h"
#include "imukit/simulate_log.h"

#include <stdlib.h>
#include <string.h>

static PyObject *sensor_type;

enum { ALONE = 64 }; /* sensors from which on the lock is let go */

typedef struct sensor {
    PyObject_HEAD imk_sensor *sensor;
    void *memory;
    size_t count, channels;
    bool temperature, busy;
} sensor;

static void sensor_free(PyObject *self)
{
    PyTypeObject *type = Py_TYPE(self);
    free(((sensor *)self)->memory);
    ((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
    Py_DECREF(type);
}

static const setting sensor_rows[] = {
#define ROW(field, kind, words)                                                                    \
    {                                                                                              \
#field, kind, offsetof(imk_sensor_settings, field), words                                  \
    }
    ROW(rate, SETTING_QUANTITY, "Hz"),
    ROW(seed, SETTING_COUNT, NULL),
    ROW(count, SETTING_SIZE, NULL),
    ROW(temperature, SETTING_FLAG, NULL),
#undef ROW
};

/* sensor(model, run, settings) */
static PyObject *make_sensor(PyObject *module, PyObject *args)
{
    PyObject *object, *dictionary;
    unsigned int run;
    imk_sensor_settings settings = imk_sensor_default();
    imk_error error = {.status = IMK_ERROR_MEMORY};
    (void)module;
    if (!PyArg_ParseTuple(args, "OIO!", &object, &run, &PyDict_Type, &dictionary))
        return NULL;
    model_object *model = model_of(object);
    if (!model || !SETTINGS_READ(dictionary, sensor_rows, &settings))
        return NULL;
    settings.run = run;
    sensor *s = (sensor *)PyType_GenericAlloc((PyTypeObject *)sensor_type, 0);
    if (!s)
        return NULL;
    const size_t size = imk_sensor_size(&model->model, &settings);
    s->memory = malloc(size > 0 ? size : 1);
    imk_status status = IMK_ERROR_MEMORY;
    if (s->memory)
        status = imk_sensor_start(&model->model, &settings, &s->sensor, s->memory, size, &error);
    if (status != IMK_OK) {
        Py_DECREF((PyObject *)s);
        return raise_error(&error, NULL);
    }
    s->count = settings.count;
    s->channels = imk_sensor_channels(s->sensor);
    s->temperature = settings.temperature;
    return (PyObject *)s;
}

/* What is true of a step: a view of the caller's numbers, or three of them copied. */
typedef struct truth {
    Py_buffer view;
    bool borrowed, each; /* each: count numbers for each component */
    double value[3];
} truth;

static bool refuse_truth(const char *name, const sensor *s, size_t components)
{
    PyErr_Format(PyExc_ValueError, "%s: expected %zu numbers for all sensors%s", name, components,
                 s->count > 1 ? ", or that many rows with a number for each sensor" : "");
    return false;
}

static bool take_numbers(PyObject *object, const char *name, const sensor *s, size_t components,
                         truth *t)
{
    if (components == 1 && PyNumber_Check(object) && !PyObject_CheckBuffer(object)) {
        t->value[0] = PyFloat_AsDouble(object);
        return !PyErr_Occurred();
    }
    if (!PySequence_Check(object))
        return refuse_truth(name, s, components);
    if ((size_t)PySequence_Size(object) != components)
        return refuse_truth(name, s, components);
    for (size_t k = 0; k < components; k++) {
        PyObject *item = PySequence_GetItem(object, (Py_ssize_t)k);
        t->value[k] = item ? PyFloat_AsDouble(item) : 0;
        Py_XDECREF(item);
        if (PyErr_Occurred())
            return false;
    }
    return true;
}

/* Three components of a vector, or one of the temperature, of all sensors or of each. */
static bool take_truth(PyObject *object, const char *name, const sensor *s, size_t components,
                       truth *t)
{
    if (!PyObject_CheckBuffer(object))
        return take_numbers(object, name, s, components, t);
    if (PyObject_GetBuffer(object, &t->view, PyBUF_FORMAT | PyBUF_C_CONTIGUOUS) != 0)
        return false;
    t->borrowed = true;
    const char *format = t->view.format;
    const size_t numbers = (size_t)t->view.len / sizeof(double);
    if (!format || strcmp(format, "d") != 0)
        return refuse_truth(name, s, components);
    if (numbers == components && t->view.ndim <= 1) {
        memcpy(t->value, t->view.buf, components * sizeof(double));
        return true;
    }
    t->each = true;
    const bool shaped = components == 1
                            ? t->view.ndim == 1 && numbers == s->count
                            : t->view.ndim == 2 && (size_t)t->view.shape[0] == components &&
                                  (size_t)t->view.shape[1] == s->count;
    return shaped || refuse_truth(name, s, components);
}

enum { RATE, FORCE, ACCELERATION, TEMPERATURE, TEMPERATURE_RATE, TRUTHS };
static const char *const truth_names[TRUTHS] = {
    "angular_rate", "specific_force", "angular_acceleration", "temperature", "temperature_rate"};

static bool take_truths(PyObject *const *args, const sensor *s, truth *t)
{
    for (int k = 0; k < TRUTHS; k++)
        if (args[k] != Py_None &&
            !take_truth(args[k], truth_names[k], s, k < TEMPERATURE ? 3 : 1, &t[k]))
            return false;
    if (s->temperature != (args[TEMPERATURE] != Py_None)) {
        PyErr_SetString(PyExc_ValueError,
                        s->temperature ? "temperature: the sensor was made with temperature=True, "
                                         "so each step needs one [K]"
                                       : "temperature: the sensor was made without; make it with "
                                         "temperature=True");
        return false;
    }
    return true;
}

/* The readings are an array of channels x count float64 of the caller. */
static bool take_readings(PyObject *object, const sensor *s, Py_buffer *view)
{
    if (PyObject_GetBuffer(object, view, PyBUF_FORMAT | PyBUF_C_CONTIGUOUS | PyBUF_WRITABLE) != 0)
        return false;
    if (view->format && strcmp(view->format, "d") == 0 &&
        (size_t)view->len == s->channels * s->count * sizeof(double))
        return true;
    PyErr_Format(PyExc_ValueError,
                 "out: expected a contiguous array of float64, %zu channels x %zu sensors",
                 s->channels, s->count);
    PyBuffer_Release(view);
    return false;
}

static imk_status step_all(sensor *s, const truth *t, double *readings)
{
    imk_sensor_truth all;
    memcpy(all.angular_rate, t[RATE].value, sizeof all.angular_rate);
    memcpy(all.specific_force, t[FORCE].value, sizeof all.specific_force);
    memcpy(all.angular_acceleration, t[ACCELERATION].value, sizeof all.angular_acceleration);
    all.temperature = t[TEMPERATURE].value[0];
    all.temperature_rate = t[TEMPERATURE_RATE].value[0];
    return imk_sensor_step(s->sensor, &all, readings);
}

/* Numbers of each sensor; one that holds for all is repeated in `room`. */
static const double *of_each(const truth *t, size_t component, size_t count, double **room)
{
    if (t->each)
        return (const double *)t->view.buf + component * count;
    double *repeated = *room;
    for (size_t i = 0; i < count; i++)
        repeated[i] = t->value[component];
    *room += count;
    return repeated;
}

static imk_status step_each(sensor *s, const truth *t, double *room, double *readings)
{
    imk_stimulus each = {.temperature = NULL};
    for (size_t k = 0; k < 3; k++) {
        each.angular_rate[k] = of_each(&t[RATE], k, s->count, &room);
        each.specific_force[k] = of_each(&t[FORCE], k, s->count, &room);
        each.angular_acceleration[k] = of_each(&t[ACCELERATION], k, s->count, &room);
    }
    if (s->temperature) {
        each.temperature = of_each(&t[TEMPERATURE], 0, s->count, &room);
        each.temperature_rate = of_each(&t[TEMPERATURE_RATE], 0, s->count, &room);
    }
    return imk_sensor_step_each(s->sensor, &each, readings);
}

static bool advance(sensor *s, const truth *t, double *readings)
{
    bool each = false;
    for (int k = 0; k < TRUTHS; k++)
        each = each || t[k].each;
    double *room = each ? malloc(11 * s->count * sizeof *room) : NULL;
    if (each && !room) {
        PyErr_NoMemory();
        return false;
    }
    PyThreadState *state = s->count >= ALONE ? PyEval_SaveThread() : NULL;
    const imk_status status = each ? step_each(s, t, room, readings) : step_all(s, t, readings);
    if (state)
        PyEval_RestoreThread(state);
    free(room);
    (void)status; /* IMK_ERROR_NOT_FINITE: the readings say it, as NaN */
    return true;
}

/* step(angular_rate, specific_force, angular_acceleration, temperature, temperature_rate, out) */
static PyObject *step(PyObject *self, PyObject *const *args, Py_ssize_t count)
{
    sensor *s = (sensor *)self;
    truth t[TRUTHS];
    Py_buffer out;
    if (count != TRUTHS + 1) {
        PyErr_SetString(PyExc_TypeError, "step() takes 6 arguments");
        return NULL;
    }
    if (s->busy) {
        PyErr_SetString(PyExc_RuntimeError, "another thread steps this sensor");
        return NULL;
    }
    for (int k = 0; k < TRUTHS; k++)
        t[k] = (truth){.borrowed = false};
    bool good = take_truths(args, s, t) && take_readings(args[TRUTHS], s, &out);
    if (good) {
        s->busy = true;
        good = advance(s, t, out.buf);
        s->busy = false;
        PyBuffer_Release(&out);
    }
    for (int k = 0; k < TRUTHS; k++)
        if (t[k].borrowed)
            PyBuffer_Release(&t[k].view);
    return good ? Py_NewRef(args[TRUTHS]) : NULL;
}

static PyObject *dropped(PyObject *self, PyObject *args)
{
    sensor *s = (sensor *)self;
    Py_ssize_t number;
    unsigned long long row;
    if (!PyArg_ParseTuple(args, "nK", &number, &row))
        return NULL;
    if (number < 0 || (size_t)number >= s->count) {
        PyErr_Format(PyExc_IndexError, "sensor %zd of %zu", number, s->count);
        return NULL;
    }
    return PyBool_FromLong(imk_sensor_dropped(s->sensor, (size_t)number, row));
}

static PyObject *numbers_of(const imk_triad *triad)
{
    int axis[IMK_AXES_MAX];
    const size_t count = triad->present ? (size_t)triad->axis_count : 0;
    PyObject *numbers = PyTuple_New((Py_ssize_t)count);
    imk_triad_axes(triad, axis);
    for (size_t k = 0; numbers && k < count; k++)
        if (PyTuple_SetItem(numbers, (Py_ssize_t)k, PyLong_FromLong(axis[k])) != 0)
            Py_CLEAR(numbers);
    return numbers;
}

/* axes(model): by which numbers the columns of its sensors are named. */
static PyObject *axes(PyObject *module, PyObject *object)
{
    (void)module;
    const model_object *model = model_of(object);
    PyObject *gyro = model ? numbers_of(&model->model.gyro) : NULL;
    PyObject *accel = gyro ? numbers_of(&model->model.accel) : NULL;
    if (accel)
        return Py_BuildValue("(NN)", gyro, accel);
    Py_XDECREF(gyro);
    return NULL;
}

PyMethodDef sensor_functions[] = {
    {"sensor", make_sensor, METH_VARARGS, "sensor(model, run, settings): sensors to step."},
    {"axes", axes, METH_O, "axes(model): the numbers of its gyros' and accelerometers' axes."},
    {NULL, NULL, 0, NULL}};

static PyMethodDef methods[] = {
    {"step", (PyCFunction)(void (*)(void))step, METH_FASTCALL,
     "step(angular_rate, specific_force, angular_acceleration, temperature, temperature_rate, "
     "out)"},
    {"dropped", dropped, METH_VARARGS, "dropped(number, row): is the row lost?"},
    {NULL, NULL, 0, NULL}};

static PyType_Slot slots[] = {
    {Py_tp_dealloc, (void *)sensor_free}, {Py_tp_methods, methods}, {0, NULL}};
static PyType_Spec spec = {.name = "imukit._core.Sensor",
                           .basicsize = sizeof(sensor),
                           .flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION,
                           .slots = slots};

bool add_sensor(PyObject *module)
{
    sensor_type = PyType_FromSpec(&spec);
    return sensor_type && PyModule_AddObjectRef(module, "Sensor", sensor_type) == 0;
}
