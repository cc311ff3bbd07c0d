/* SPDX-License-Identifier: Apache-2.0 */
/* Navigation by a record. */
#include "extension_scene.h"

#include <float.h>
#include <string.h>

typedef struct asked {
    imk_navigate_log_settings s;
    int stops, align_method, vertical; /* -1: not stated */
    const char *aids_name;
} asked;

#define ROW(field, kind, words)                                                                    \
    {                                                                                              \
#field, kind, offsetof(asked, s.field), words                                              \
    }
static const setting rows[] = {
    ROW(gaps, SETTING_CHOICE, "refuse|bridge|longest|keep"),
    ROW(align, SETTING_QUANTITY, "s"),
    ROW(still_velocity, SETTING_QUANTITY, "m/s"),
    ROW(still_rotation, SETTING_QUANTITY, "rad/s"),
    ROW(standard_gravity, SETTING_QUANTITY, "m/s^2"),
    ROW(interval, SETTING_QUANTITY, "s"),
    ROW(smooth, SETTING_FLAG, NULL),
    ROW(heading_given, SETTING_FLAG, NULL),
    ROW(velocity_given, SETTING_FLAG, NULL),
    ROW(stop_period, SETTING_QUANTITY, "s"),
    ROW(aid_delay, SETTING_QUANTITY, "s"),
    ROW(aid_interval, SETTING_QUANTITY, "s"),
    ROW(aid_until, SETTING_QUANTITY, "s"),
    {"stop", SETTING_QUANTITY, offsetof(asked, s.stop_length), "s"},
    {"coning", SETTING_INT, offsetof(asked, s.samples), NULL},
    {"stops", SETTING_CHOICE, offsetof(asked, stops), "none|timetable|auto"}, /* imk_stop_policy */
    {"align_method", SETTING_CHOICE, offsetof(asked, align_method), "means|inertial|fine"},
    {"vertical", SETTING_CHOICE, offsetof(asked, vertical), "slaved|free"},
};
#undef ROW

/* Vectors of the settings, by their places in a tuple of tuples of three numbers. */
static bool take_vectors(PyObject *tuple, imk_navigate_log_settings *s)
{
    double place[3];
    double *const vector[] = {place,        s->attitude,        s->attitude_sigma,
                              s->velocity,  s->velocity_sigma,  s->position_sigma,
                              s->lever_arm, s->lever_arm_sigma, s->speed_lever_arm};
    const Py_ssize_t count = (Py_ssize_t)(sizeof vector / sizeof *vector);
    if (PyTuple_Size(tuple) != count) {
        PyErr_SetString(PyExc_TypeError, "expected nine vectors");
        return false;
    }
    for (Py_ssize_t k = 0; k < count; k++)
        if (!PyArg_ParseTuple(PyTuple_GetItem(tuple, k), "ddd", &vector[k][0], &vector[k][1],
                              &vector[k][2]))
            return false;
    s->place = (imk_geodetic){place[0], place[1], place[2]};
    return true;
}

/* One run: the settings and what they point to. */
typedef struct navigation {
    asked a;
    record *record, *aids;
    imk_model *model;
    const char *model_name;
    imk_navigate_log *n;
} navigation;

static bool take_model(navigation *v, PyObject *pair)
{
    PyObject *object;
    if (pair == Py_None)
        return true;
    if (!PyTuple_Check(pair) || !PyArg_ParseTuple(pair, "sO", &v->model_name, &object))
        return false;
    const model_object *model = model_of(object);
    if (!model)
        return false;
    v->model = PyMem_Malloc(sizeof *v->model);
    if (!v->model) {
        PyErr_NoMemory();
        return false;
    }
    *v->model = model->model;
    v->a.s.model = v->model;
    v->a.s.model_name = v->model_name;
    return true;
}

/* What is not stated depends on the rest. */
static void complete(navigation *v)
{
    imk_navigate_log_settings *s = &v->a.s;
    s->stops = (imk_stop_policy)v->a.stops;
    s->method_given = v->a.align_method >= 0;
    if (s->method_given)
        s->method = (imk_alignment_method)v->a.align_method;
    s->hold_height = v->a.vertical < 0 ? !v->aids : v->a.vertical == 0;
    if (v->aids) {
        s->aids = &v->aids->source;
        s->aids_name = v->aids->name;
    }
}

/* ---- what is given back ---- */

static PyObject *list_columns(double *const *column, size_t count, size_t rows_there)
{
    PyObject *list = PyList_New(0);
    for (size_t k = 0; list && k < count; k++) {
        PyObject *numbers = column[k] ? numbers_of(column[k], rows_there) : Py_NewRef(Py_None);
        if (!numbers || PyList_Append(list, numbers) != 0)
            Py_CLEAR(list);
        Py_XDECREF(numbers);
    }
    return list;
}

/* (kind, columns of time and innovations, verdicts) */
static PyObject *describe_aid(const imk_navigate_aid *aid)
{
    double *const column[] = {aid->time, aid->innovation[0], aid->innovation[1],
                              aid->innovation[2]};
    PyObject *columns = list_columns(column, 4, aid->tested);
    PyObject *verdicts =
        PyBytes_FromStringAndSize((const char *)aid->verdict, (Py_ssize_t)aid->tested);
    PyObject *made = NULL;
    if (columns && verdicts)
        made = Py_BuildValue("(sOO)", imk_aid_kind_name(aid->aid.kind), columns, verdicts);
    Py_XDECREF(columns);
    Py_XDECREF(verdicts);
    return made;
}

static PyObject *arrays_of(const imk_navigate_log *n)
{
    const size_t columns = n->settings.model ? IMK_TRACK_COLUMNS : IMK_TRACK_SIGMA;
    PyObject *track = list_columns(n->track, columns, n->track_rows);
    PyObject *filtered =
        n->filtered[0] ? list_columns(n->filtered, columns, n->track_rows) : Py_NewRef(Py_None);
    PyObject *aids = PyList_New(0), *made = NULL;
    for (size_t k = 0; aids && k < n->aid_count; k++) {
        PyObject *aid = describe_aid(&n->aid[k]);
        if (!aid || PyList_Append(aids, aid) != 0)
            Py_CLEAR(aids);
        Py_XDECREF(aid);
    }
    if (track && filtered && aids)
        made = Py_BuildValue("(OOO)", track, filtered, aids);
    Py_XDECREF(track);
    Py_XDECREF(filtered);
    Py_XDECREF(aids);
    return made;
}

static PyObject *give(const navigation *v)
{
    imk_result *result = begin_result("navigate");
    if (!result)
        return NULL;
    imk_show_navigate_log(v->n, v->record->name, result);
    PyObject *both = result_with(result, &v->n->findings, v->record->name,
                                 v->model_name ? v->model_name : "the model");
    PyObject *arrays = both ? arrays_of(v->n) : NULL, *made = NULL;
    if (arrays)
        made = PyTuple_Pack(3, PyTuple_GetItem(both, 0), PyTuple_GetItem(both, 1), arrays);
    Py_XDECREF(arrays);
    Py_XDECREF(both);
    return made;
}

/* A failure names what it is about. */
static void refuse(const navigation *v, const imk_error *error)
{
    const imk_findings *findings = v->n ? &v->n->findings : NULL;
    const imk_finding *failure = findings ? imk_findings_failure(findings) : NULL;
    const bool of_aid = failure && strncmp(failure->code, "aid_", 4) == 0;
    raise_failure(findings, error,
                  of_aid && v->aids ? v->aids->name
                  : failure         ? v->record->name
                                    : NULL,
                  v->model_name ? v->model_name : "the model");
}

static PyObject *run(navigation *v, PyObject *progress)
{
    work w;
    imk_error error;
    if (!work_begin(&w, 1, progress))
        return NULL;
    const imk_status status =
        imk_navigate_log_run(&v->record->source, &v->a.s, &w.job, &v->n, &error);
    if (work_end(&w) && status != IMK_OK)
        refuse(v, &error);
    return PyErr_Occurred() ? NULL : give(v);
}

/* navigate(record, model, vectors, settings, aids, aid_sigmas, progress)
 * -> (result, findings, arrays) */
static PyObject *navigate(PyObject *module, PyObject *args)
{
    PyObject *object, *pair, *vectors, *dictionary, *aids, *sigmas, *progress, *made = NULL;
    navigation v = {.a = {.s = imk_navigate_log_default(), .align_method = -1, .vertical = -1}};
    (void)module;
    if (!PyArg_ParseTuple(args, "OOO!O!OO!O", &object, &pair, &PyTuple_Type, &vectors, &PyDict_Type,
                          &dictionary, &aids, &PyTuple_Type, &sigmas, &progress) ||
        !take_vectors(vectors, &v.a.s) || !SETTINGS_READ(dictionary, rows, &v.a) ||
        !aids_take(sigmas, v.a.s.aid, &v.a.s.aid_count) || !take_model(&v, pair)) {
        PyMem_Free(v.model);
        return NULL;
    }
    v.record = record_begin(object);
    v.aids = v.record && aids != Py_None ? record_begin(aids) : NULL;
    if (v.record && (v.aids || aids == Py_None)) {
        complete(&v);
        made = run(&v, progress);
    }
    imk_navigate_log_free(v.n);
    if (v.record)
        record_end(v.record);
    if (v.aids)
        record_end(v.aids);
    PyMem_Free(v.model);
    return made;
}

PyMethodDef navigate_functions[] = {{"navigate", navigate, METH_VARARGS,
                                     "navigate(record, model, vectors, settings, aids, aid_sigmas, "
                                     "progress): the track of a unit."},
                                    {NULL, NULL, 0, NULL}};
