/* SPDX-License-Identifier: Apache-2.0 */
/* Programmes of bench tests. */
#include "extension_scene.h"

#include <stdlib.h>

static const setting plan_rows[] = {
    {"rate", SETTING_QUANTITY, offsetof(imk_plan_settings, rate), "Hz"},
    {"soak", SETTING_QUANTITY, offsetof(imk_plan_settings, soak), "s"},
};

/* Settings of a plan from those of the calibration, the dictionary and the text of requirements;
 * false with an exception. @param requirement  room for IMK_CORRELATED_MAX */
static bool plan_take(const imk_calibrate_log *session, PyObject *dictionary, const char *want,
                      imk_sigma_requirement *requirement, imk_plan_settings *s)
{
    imk_error error;
    if (imk_calibrate_plan_settings(session, s, &error) != IMK_OK ||
        imk_calibrate_requirements(session->calibration, session->settings.temperature_order, want,
                                   IMK_CORRELATED_MAX, requirement, &s->requirement_count,
                                   &error) != IMK_OK) {
        raise_error(&error, NULL);
        return false;
    }
    s->requirement = requirement;
    return SETTINGS_READ(dictionary, plan_rows, s);
}

/* 1 sigma of each parameter by its name. */
static PyObject *sigmas_of(const imk_plan_result *r)
{
    PyObject *sigmas = PyDict_New();
    for (size_t k = 0; sigmas && k < r->parameter_count; k++) {
        char name[IMK_MODEL_PARAMETER_NAME] = "";
        (void)imk_model_parameter_name(r->parameter[k], name);
        PyObject *sigma = PyFloat_FromDouble(r->sigma[k]);
        if (!sigma || PyDict_SetItemString(sigmas, name, sigma) != 0)
            Py_CLEAR(sigmas);
        Py_XDECREF(sigma);
    }
    return sigmas;
}

/* Its file; None where there can be none. */
static PyObject *programme(const imk_calibrate_plan *plan, const imk_geodetic *place)
{
    char *text = NULL;
    size_t size = 0;
    if (plan->unscripted.status != IMK_OK)
        Py_RETURN_NONE;
    if (imk_calibrate_plan_text(plan, place, &text, &size) != IMK_OK)
        return PyErr_NoMemory();
    PyObject *made = PyUnicode_DecodeUTF8(text, (Py_ssize_t)size, "replace");
    free(text);
    return made;
}

static PyObject *show(const imk_calibrate_plan *plan, const imk_geodetic *place, const char *name)
{
    const imk_findings none = {.count = 0};
    imk_result *result = begin_result("calibrate");
    if (!result)
        return NULL;
    imk_show_calibrate_plan(plan, name, result);
    PyObject *made = extended(result_with(result, &none, name, name), sigmas_of(&plan->result));
    made = extended(made, made ? programme(plan, place) : NULL);
    return extended(made,
                    made ? PyBool_FromLong(plan->result.reached == plan->settings.requirement_count)
                         : NULL);
}

static PyObject *make(imk_calibrate_log *session, PyObject *dictionary, const char *want,
                      const char *name)
{
    imk_sigma_requirement requirement[IMK_CORRELATED_MAX];
    imk_plan_settings s;
    imk_calibrate_plan *plan = NULL;
    imk_error error;
    work w;
    if (!plan_take(session, dictionary, want, requirement, &s) || !work_begin(&w, 1, Py_None))
        return NULL;
    const imk_status status =
        imk_calibrate_plan_run(session->calibration, &s, &w.job, &plan, &error);
    if (work_end(&w) && status != IMK_OK)
        raise_error(&error, error.status == IMK_ERROR_KEY_MISSING ? name : NULL);
    PyObject *made =
        PyErr_Occurred()
            ? NULL
            : show(plan, session->settings.place_known ? &session->settings.place : NULL, name);
    imk_calibrate_plan_free(plan);
    return made;
}

/* plan_calibration(model, name, procedure, settings of the calibration, place, settings of the
 * plan, want) -> (result, findings, sigmas, programme, met) */
static PyObject *plan_calibration(PyObject *module, PyObject *args)
{
    PyObject *object, *kind, *dictionary, *place, *more, *made = NULL;
    const char *name, *want;
    imk_calibrate_log_settings s;
    imk_calibrate_log *session = NULL;
    imk_error error;
    (void)module;
    if (!PyArg_ParseTuple(args, "OsOO!OO!z", &object, &name, &kind, &PyDict_Type, &dictionary,
                          &place, &PyDict_Type, &more, &want))
        return NULL;
    const model_object *m = model_of(object);
    if (!m || !calibrate_settings_read(dictionary, place, &s))
        return NULL;
    const imk_procedure procedure =
        s.repeatability ? IMK_PROCEDURE_MULTIPOSITION : procedure_of(kind);
    if (procedure == IMK_PROCEDURES)
        return NULL;
    if (imk_calibrate_log_create(1, &procedure, &s, NULL, &session, &error) == IMK_OK) {
        session->calibration->model = m->model;
        made = make(session, more, want, name);
    } else {
        raise_error(&error, NULL);
    }
    imk_calibrate_log_free(session);
    return made;
}

PyMethodDef plan_functions[] = {
    {"plan_calibration", plan_calibration, METH_VARARGS,
     "plan_calibration(model, name, procedure, settings, place, plan, want): a programme."},
    {NULL, NULL, 0, NULL}};
