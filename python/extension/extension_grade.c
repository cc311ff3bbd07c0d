/* SPDX-License-Identifier: Apache-2.0 */
/* The classes of models. */
#include "extension_scene.h"

#include <string.h>

static const setting rows[] = {
    {"map", SETTING_CHOICE, 0, "gyro|accel|cost|sensor-cost|all"}, /* as imk_grade_map */
};

static PyObject *show(const model_list *list, imk_graded *const *graded, imk_grade_map map)
{
    const imk_graded_several several = {list->count, (const imk_graded *const *)graded, list->name,
                                        list->terms.assume ? list->assumed : NULL};
    const imk_findings none = {.count = 0};
    imk_result *result = begin_result("grade");
    if (!result)
        return NULL;
    imk_show_grade(&several, map, result);
    page_models(list, result);
    return result_with(result, &none, NULL, "the model");
}

/* @param m  set to the model that failed */
static imk_status grade_all(const model_list *list, const imk_job *job, imk_graded **graded,
                            size_t *m, imk_error *error)
{
    imk_status status = IMK_OK;
    for (*m = 0; *m < list->count && status == IMK_OK; *m += status == IMK_OK)
        status = imk_grade_run(list->model[*m], job, &graded[*m], error);
    return status;
}

/* grade(models, terms, settings, threads, progress) -> (result, findings) */
static PyObject *grade(PyObject *module, PyObject *args)
{
    PyObject *pairs, *tuple, *dictionary, *progress, *made = NULL;
    int threads, map = IMK_GRADE_MAPS;
    model_terms terms;
    model_list list = {.count = 0};
    imk_graded *graded[IMK_DRIFT_MODELS_MAX] = {NULL};
    imk_error error;
    size_t m;
    work w;
    (void)module;
    if (!PyArg_ParseTuple(args, "O!O!O!iO", &PyTuple_Type, &pairs, &PyTuple_Type, &tuple,
                          &PyDict_Type, &dictionary, &threads, &progress) ||
        !SETTINGS_READ(dictionary, rows, &map) || !terms_take(tuple, &terms))
        return NULL;
    if (models_take(pairs, &terms, &list) && work_begin(&w, threads, progress)) {
        const imk_status status = grade_all(&list, &w.job, graded, &m, &error);
        if (work_end(&w) && status != IMK_OK)
            raise_failure(graded[m] ? &graded[m]->findings : NULL, &error, list.name[m],
                          list.name[m]);
        if (!PyErr_Occurred())
            made = show(&list, graded, (imk_grade_map)map);
    }
    for (m = 0; m < IMK_DRIFT_MODELS_MAX; m++)
        imk_graded_free(graded[m]);
    models_free(&list);
    return made;
}

PyMethodDef grade_functions[] = {
    {"grade", grade, METH_VARARGS,
     "grade(models, terms, settings, threads, progress): classes of models."},
    {NULL, NULL, 0, NULL}};
