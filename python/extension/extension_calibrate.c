/* SPDX-License-Identifier: Apache-2.0 */
/* Calibration from records of bench tests. */
#include "extension_scene.h"

#include "imukit/utf8.h"

#include <stdlib.h>
#include <string.h>

static const setting calibrate_rows[] = {
#define ROW(field, kind, words)                                                                    \
    {                                                                                              \
#field, kind, offsetof(imk_calibrate_log_settings, field), words                           \
    }
    ROW(gravity, SETTING_QUANTITY, "m/s^2"),
    ROW(no_earth, SETTING_FLAG, NULL),
    ROW(frame, SETTING_CHOICE, "upper-triangular|lower-triangular|symmetric|reference"),
    ROW(estimate, SETTING_TEXT, NULL),
    ROW(with, SETTING_INT, NULL),
    ROW(without, SETTING_INT, NULL),
    ROW(repeatability, SETTING_FLAG, NULL),
    ROW(closed_form, SETTING_FLAG, NULL),
    ROW(least_squares, SETTING_FLAG, NULL),
    ROW(section, SETTING_TEXT, NULL),
    ROW(pose_means, SETTING_FLAG, NULL),
    ROW(placement, SETTING_QUANTITY, "rad"),
    ROW(g_sensitivity_sigma, SETTING_QUANTITY, "deg/h/g"),
    ROW(mounting, SETTING_QUANTITY, "rad"),
    ROW(turn_angle, SETTING_QUANTITY, "rad"),
    ROW(initial_rest, SETTING_QUANTITY, "s"),
    ROW(window, SETTING_QUANTITY, "s"),
    ROW(minimum, SETTING_QUANTITY, "s"),
    ROW(trim, SETTING_QUANTITY, "s"),
    ROW(settle, SETTING_QUANTITY, "s"),
    ROW(reference_temperature, SETTING_QUANTITY, "K"),
    ROW(temperature_order, SETTING_INT, NULL),
    ROW(motion_offset, SETTING_QUANTITY, "s"),
    ROW(find_offset, SETTING_FLAG, NULL),
    ROW(table_axis, SETTING_CHOICE, "x|y|z"),
    ROW(field, SETTING_QUANTITY, "T"),
    ROW(field_sigma, SETTING_QUANTITY, "T"),
    ROW(dip, SETTING_QUANTITY, "rad"),
#undef ROW
};

typedef struct session {
    imk_calibrate_log_settings settings;
    size_t count, begun;
    record *record[IMK_TEST_RECORDS_MAX]; /* NULL in a comparison of models */
    imk_procedure procedure[IMK_TEST_RECORDS_MAX];
    imk_model *model[IMK_TEST_RECORDS_MAX]; /* of runs that are compared */
    imk_model *known;                       /* a copy; NULL: nothing was known before */
    imk_document *document;                 /* of the model that the result goes into; borrowed */
    const char *name;                       /* of the model; NULL: as it is */
    motion_use motion;
    imk_calibrate_log *found;
    PyObject *findings;
    bool loading; /* while records are loaded */
} session;

/* ---- settings ---------------------------------------------------------------------------------
 */

static bool counts_take(PyObject *object, const char *name, const char *unit,
                        imk_calibrate_counts *counts)
{
    double sigma[IMK_AXES_MAX];
    size_t count = 0;
    imk_error error;
    if (PyUnicode_Check(object)) {
        Py_ssize_t size;
        const char *text = utf8_of(object, &size);
        if (!text)
            return false;
        if (imk_quantity_parse(text, text + size, imk_unit_of(unit).dimension, IMK_AXES_MAX,
                               counts->value, sigma, &count, NULL, &error) != IMK_OK) {
            raise_error(&error, name);
            return false;
        }
        counts->count = (int)count;
        return true;
    }
    if (!PyTuple_Check(object)) {
        counts->count = 1;
        return quantity_read(object, name, unit, &counts->value[0]);
    }
    const Py_ssize_t axes = PyTuple_Size(object);
    if (axes < 1 || axes > IMK_AXES_MAX) {
        PyErr_Format(PyExc_ValueError, "%s: %zd numbers; expected one, or one for each axis", name,
                     axes);
        return false;
    }
    counts->count = (int)axes;
    bool good = true;
    for (Py_ssize_t k = 0; good && k < axes; k++)
        good = quantity_read(PyTuple_GetItem(object, k), name, unit, &counts->value[k]);
    return good;
}

static bool data_sheet_take(PyObject *numbers, imk_calibrate_log_settings *s)
{
    const struct {
        const char *name, *unit;
        imk_calibrate_counts *counts;
    } given[] = {{"gyro_sensitivity", "count/(rad/s)", &s->sensitivity[0]},
                 {"accel_sensitivity", "count/(m/s^2)", &s->sensitivity[1]},
                 {"gyro_zero", "count", &s->zero_offset[0]},
                 {"accel_zero", "count", &s->zero_offset[1]},
                 {"gyro_range", "rad/s", &s->range[0]},
                 {"accel_range", "m/s^2", &s->range[1]}};
    bool good = true;
    for (size_t k = 0; good && k < sizeof given / sizeof *given; k++) {
        PyObject *object = PyDict_GetItemString(numbers, given[k].name);
        if (object && object != Py_None)
            good = counts_take(object, given[k].name, given[k].unit, given[k].counts);
    }
    return good;
}

bool calibrate_settings_read(PyObject *dictionary, PyObject *place, imk_calibrate_log_settings *s)
{
    *s = imk_calibrate_log_default();
    s->activity = true;
    s->place_known = place != Py_None;
    return SETTINGS_READ(dictionary, calibrate_rows, s) &&
           (!s->place_known || PyArg_ParseTuple(place, "ddd", &s->place.latitude,
                                                &s->place.longitude, &s->place.height));
}

imk_procedure procedure_of(PyObject *object)
{
    const char *name = utf8_of(object, NULL);
    char all[200] = "";
    for (int p = 0; name && p < IMK_PROCEDURES; p++) {
        if (strcmp(name, imk_procedure_name((imk_procedure)p)) == 0)
            return (imk_procedure)p;
        strcat(strcat(all, imk_procedure_name((imk_procedure)p)), ", ");
    }
    if (name)
        PyErr_Format(PyExc_ValueError, "procedure='%s': expected one of %srepeatability", name,
                     all);
    return IMK_PROCEDURES;
}

/* Records, or models that are compared, each with its procedure. */
static bool runs_take(session *b, PyObject *runs, PyObject *procedures)
{
    const Py_ssize_t count = PyTuple_Size(runs);
    if (count < 1 || count > IMK_TEST_RECORDS_MAX) {
        PyErr_Format(PyExc_ValueError, "%zd records: expected 1 to %d", count,
                     (int)IMK_TEST_RECORDS_MAX);
        return false;
    }
    for (b->count = 0; b->count < (size_t)count; b->count++) {
        PyObject *run = PyTuple_GetItem(runs, (Py_ssize_t)b->count);
        if (PyTuple_Size(procedures) == count) {
            b->procedure[b->count] =
                procedure_of(PyTuple_GetItem(procedures, (Py_ssize_t)b->count));
            if (b->procedure[b->count] == IMK_PROCEDURES)
                return false;
        }
        if (!is_model(run)) {
            b->record[b->count] = record_begin(run);
            if (!b->record[b->count])
                return false;
            b->begun++;
        }
    }
    return true;
}

static bool copy_model(PyObject *object, imk_model **copy)
{
    const model_object *m = model_of(object);
    if (!m)
        return false;
    *copy = PyMem_Malloc(sizeof **copy);
    if (!*copy) {
        PyErr_NoMemory();
        return false;
    }
    **copy = m->model;
    return true;
}

static bool models_copy(session *b, PyObject *runs, PyObject *model, PyObject *into)
{
    bool good = true;
    for (size_t k = 0; good && b->begun == 0 && k < b->count; k++)
        good = copy_model(PyTuple_GetItem(runs, (Py_ssize_t)k), &b->model[k]);
    if (good && into != Py_None) {
        good = copy_model(into, &b->known);
        b->document = good ? model_of(into)->document : NULL;
    } else if (good && model != Py_None) {
        good = copy_model(model, &b->known);
    }
    return good;
}

static void session_free(session *b)
{
    for (size_t k = 0; b && k < IMK_TEST_RECORDS_MAX; k++) {
        if (b->record[k])
            record_end(b->record[k]);
        PyMem_Free(b->model[k]);
    }
    if (b) {
        imk_calibrate_log_free(b->found);
        PyMem_Free(b->known);
        Py_XDECREF(b->findings);
    }
    PyMem_Free(b);
}

/* ---- work -------------------------------------------------------------------------------------
 */

static imk_status work_on_records(session *b, imk_error *error)
{
    imk_status status = IMK_OK;
    b->loading = true;
    for (size_t k = 0; status == IMK_OK && k < b->count; k++)
        status =
            imk_calibrate_log_load(b->found, k, b->record[k]->name, &b->record[k]->source, error);
    b->loading = status != IMK_OK;
    return status == IMK_OK ? imk_calibrate_log_run(b->found, error) : status;
}

static imk_status session_work(session *b, const char *const *names, const imk_job *job,
                               imk_error *error)
{
    b->settings.model = b->known;
    if (b->motion.file)
        b->settings.motion = imk_motion_file_motion(b->motion.file);
    const imk_status status =
        imk_calibrate_log_create(b->count, b->procedure, &b->settings, job, &b->found, error);
    if (status != IMK_OK || b->begun > 0)
        return status == IMK_OK ? work_on_records(b, error) : status;
    return imk_calibrate_log_compare(b->found, (const imk_model *const *)b->model, names, error);
}

static void session_raise(const session *b, const imk_error *error)
{
    char text[1000];
    const imk_calibrate_log *found = b->found;
    const bool one = found && found->failed < found->count && b->begun > 0;
    const char *name = one ? b->record[found->failed]->name : NULL;
    const imk_findings *findings = !found              ? NULL
                                   : one && b->loading ? &found->record[found->failed].loaded
                                                       : &found->findings;
    if (error->status == IMK_ERROR_MEMORY || error->status == IMK_ERROR_CANCELLED || !found ||
        (findings && imk_findings_failure(findings)) ||
        imk_calibrate_failure(found, error, text, sizeof text) == 0)
        raise_failure(findings, error, name, "the model");
    else
        raise_message(error, text);
}

/* ---- what is shown ----------------------------------------------------------------------------
 */

static bool extend(PyObject *list, const imk_findings *findings, const char *name)
{
    PyObject *more = list_findings(findings, name, "the model");
    const Py_ssize_t end = PyList_Size(list);
    const bool good = more && PyList_SetSlice(list, end, end, more) == 0;
    Py_XDECREF(more);
    return good;
}

/* Warnings on the way here belong to the verdict. */
static imk_verdict assess(const session *b, imk_result *result)
{
    imk_message before[2 * IMK_FINDINGS_MAX + 1];
    size_t count = 0;
    const Py_ssize_t all = PyList_Size(b->findings);
    for (Py_ssize_t k = 0; k < all && count < 2 * IMK_FINDINGS_MAX; k++) {
        PyObject *finding = PyList_GetItem(b->findings, k);
        if (PyLong_AsLong(PyTuple_GetItem(finding, 0)) != IMK_FINDING_WARNING)
            continue;
        const char *code = utf8_of(PyTuple_GetItem(finding, 1), NULL);
        const char *said = utf8_of(PyTuple_GetItem(finding, 2), NULL);
        before[count++] = (imk_message){.level = IMK_FINDING_WARNING,
                                        .code = imk_result_key(result, "%s", code ? code : ""),
                                        .text = imk_result_key(result, "%s", said ? said : "")};
    }
    imk_verdict verdict = imk_calibrate_verdict(b->found, count, before, result);
    for (size_t k = count; k < verdict.count; k++)
        if (verdict.message[k].level >= IMK_FINDING_WARNING)
            (void)add_finding(b->findings, verdict.message[k].level, verdict.message[k].code, "%s",
                              verdict.message[k].text);
    return verdict;
}

static PyObject *model_text(session *b)
{
    char *text = NULL;
    size_t size = 0;
    imk_error error;
    if (b->name)
        imk_utf8_clean(b->name, b->found->model.name, sizeof b->found->model.name);
    if (imk_model_print(&b->found->model, b->document, &text, &size, &error) != IMK_OK)
        return raise_error(&error, NULL);
    PyObject *made = PyUnicode_DecodeUTF8(text, (Py_ssize_t)size, "replace");
    free(text);
    return made;
}

static PyObject *session_show(session *b, bool poses)
{
    bool good = true;
    for (size_t k = 0; good && b->begun > 0 && k < b->count; k++)
        good = extend(b->findings, &b->found->record[k].loaded, b->record[k]->name);
    PyObject *text = good && extend(b->findings, &b->found->findings, NULL) ? model_text(b) : NULL;
    imk_result *result = text ? begin_result("calibrate") : NULL;
    if (!result) {
        Py_XDECREF(text);
        return NULL;
    }
    const imk_verdict verdict = assess(b, result);
    const imk_finding_level level = imk_verdict_level(&verdict);
    imk_show_calibrate_log(b->found, &verdict, poses, result);
    PyObject *object = make_result(result);
    if (!object || PyErr_Occurred()) {
        Py_XDECREF(object);
        Py_DECREF(text);
        return NULL;
    }
    return Py_BuildValue("(NONi)", object, b->findings, text, (int)level);
}

/* calibrate(runs, names, procedures, settings, data_sheet, place, model, into, motion, name, poses,
 * progress) -> (result, findings, model, level) */
static PyObject *calibrate(PyObject *module, PyObject *args)
{
    PyObject *runs, *labels, *procedures, *dictionary, *sheet, *place, *model, *into, *motion,
        *progress, *made = NULL;
    const char *name, *names[IMK_TEST_RECORDS_MAX];
    int poses;
    work w;
    (void)module;
    if (!PyArg_ParseTuple(args, "O!O!O!O!O!OOOOzpO", &PyTuple_Type, &runs, &PyTuple_Type, &labels,
                          &PyTuple_Type, &procedures, &PyDict_Type, &dictionary, &PyDict_Type,
                          &sheet, &place, &model, &into, &motion, &name, &poses, &progress))
        return NULL;
    session *b = PyMem_Calloc(1, sizeof *b);
    if (!b)
        return PyErr_NoMemory();
    b->name = name;
    b->findings = PyList_New(0);
    bool good = b->findings && calibrate_settings_read(dictionary, place, &b->settings) &&
                data_sheet_take(sheet, &b->settings) && runs_take(b, runs, procedures) &&
                models_copy(b, runs, model, into);
    for (size_t k = 0; good && k < b->count; k++) {
        PyObject *label = PyTuple_GetItem(labels, (Py_ssize_t)k);
        names[k] = label ? utf8_of(label, NULL) : NULL;
        good = names[k] != NULL;
    }
    if (good && motion != Py_None)
        good = motion_take(motion, &b->motion);
    if (good && work_begin(&w, 1, progress)) {
        imk_error error;
        const imk_status status = session_work(b, names, &w.job, &error);
        if (work_end(&w) && status != IMK_OK)
            session_raise(b, &error);
        made = PyErr_Occurred() ? NULL : session_show(b, poses);
    }
    session_free(b);
    return made;
}

PyMethodDef calibrate_functions[] = {
    {"calibrate", calibrate, METH_VARARGS,
     "calibrate(runs, names, procedures, settings, data_sheet, place, model, into, motion, name, "
     "poses, progress): bias, scale factor and more."},
    {NULL, NULL, 0, NULL}};

static bool add_procedure(PyObject *dictionary, imk_procedure p)
{
    PyObject *means = PyBool_FromLong(imk_procedure_takes_means(p));
    const bool good = means && PyDict_SetItemString(dictionary, imk_procedure_name(p), means) == 0;
    Py_XDECREF(means);
    return good;
}

bool add_calibrate(PyObject *module)
{
    PyObject *procedures = PyDict_New();
    bool good = procedures != NULL;
    for (int p = 0; good && p < IMK_PROCEDURES; p++)
        good = add_procedure(procedures, (imk_procedure)p);
    good = good && PyModule_AddObjectRef(module, "procedures", procedures) == 0;
    Py_XDECREF(procedures);
    return good &&
           PyModule_AddIntConstant(module, "TERM_NONLINEARITY", IMK_CALIBRATE_NONLINEARITY) == 0 &&
           PyModule_AddIntConstant(module, "TERM_CROSS_PRODUCTS", IMK_CALIBRATE_CROSS_PRODUCTS) ==
               0 &&
           PyModule_AddIntConstant(module, "TERM_G_SENSITIVITY", IMK_CALIBRATE_G_SENSITIVITY) ==
               0 &&
           PyModule_AddIntConstant(module, "TERM_G2_SENSITIVITY", IMK_CALIBRATE_G2_SENSITIVITY) ==
               0 &&
           PyModule_AddIntConstant(module, "TERM_GYRO", IMK_CALIBRATE_GYRO_TURNS) == 0;
}
