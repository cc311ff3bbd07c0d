/* SPDX-License-Identifier: Apache-2.0 */
/* Growth of the errors of models. */
#include "extension_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What is asked beside the models. */
typedef struct asked {
    imk_drift_models_settings settings;
    imk_drift_when when;
    uint64_t runs, seed;
    const char *want, *filter_name;
    int retuned;
} asked;

#define DRIFT(field, kind, words)                                                                  \
    {                                                                                              \
#field, kind, offsetof(asked, settings.drift.field), words                                 \
    }
static const setting rows[] = {
    DRIFT(rate, SETTING_QUANTITY, "Hz"),
    DRIFT(roll, SETTING_QUANTITY, "rad"),
    DRIFT(pitch, SETTING_QUANTITY, "rad"),
    DRIFT(yaw, SETTING_QUANTITY, "rad"),
    DRIFT(vertical, SETTING_CHOICE, "slaved|free"),
    {"aligned", SETTING_CHOICE, offsetof(asked, settings.drift.alignment), "given|self"},
    {"align_time", SETTING_QUANTITY, offsetof(asked, settings.drift.alignment_time), "s"},
    DRIFT(attitude_errors, SETTING_CHOICE, "local|earth"),
    DRIFT(gravity_deflection, SETTING_QUANTITY, "m/s^2"),
    DRIFT(gravity_distance, SETTING_QUANTITY, "m"),
    {"compensated", SETTING_FLAG, offsetof(asked, settings.calibrated), NULL},
    {"gains", SETTING_CHOICE, offsetof(asked, retuned), "held|retuned"},
    DRIFT(latitude, SETTING_QUANTITY, "rad"),
    DRIFT(height, SETTING_QUANTITY, "m"),
    {"duration", SETTING_QUANTITY, offsetof(asked, when.duration), "s"},
    {"runs", SETTING_COUNT, offsetof(asked, runs), NULL},
    {"seed", SETTING_COUNT, offsetof(asked, seed), NULL},
    {"want", SETTING_TEXT, offsetof(asked, want), NULL},
    {"filter_name", SETTING_TEXT, offsetof(asked, filter_name), NULL},
};
#undef DRIFT

/* One analysis: everything it holds. */
typedef struct analysis {
    asked a;
    model_list list;
    motion_use motion;
    imk_aid aid[IMK_AIDS_MAX];
    imk_model *filter; /* NULL: none */
    columns times, outage;
    imk_drift_times chosen;
    imk_drift_models *r;
    const double *errors; /* of the runs; NULL: none */
    PyObject *findings;
} analysis;

/* ---- what is asked ---- */

static bool take_list(PyObject *object, columns *c)
{
    return object == Py_None || columns_take(object, c);
}

static bool take_motion(analysis *d, PyObject *object)
{
    imk_drift_settings *s = &d->a.settings.drift;
    imk_error error;
    if (object == Py_None)
        return true;
    if (!motion_take(object, &d->motion))
        return false;
    s->motion = imk_motion_file_motion(d->motion.file)->trajectory;
    d->a.when.motion = imk_motion_file_duration(d->motion.file);
    if (s->motion)
        return true;
    (void)imk_error_set(&error, IMK_ERROR_UNSUPPORTED, "",
                        "recorded rates and forces do not contain the true position of the unit",
                        "a motion script, or a table of positions and attitudes");
    raise_error(&error, d->motion.name);
    return false;
}

static bool take_filter(analysis *d, PyObject *object)
{
    if (object == Py_None)
        return true;
    const model_object *model = model_of(object);
    if (!model)
        return false;
    d->filter = PyMem_Malloc(sizeof *d->filter);
    if (!d->filter) {
        PyErr_NoMemory();
        return false;
    }
    *d->filter = model->model;
    d->a.settings.drift.filter_model = d->filter;
    return true;
}

/* A requirement, and when to look. */
static bool take_times(analysis *d)
{
    imk_drift_wanted *want = &d->a.settings.want;
    imk_drift_when *when = &d->a.when;
    imk_error error;
    bool after = false;
    if (d->a.want && imk_drift_wanted_parse(d->a.want, want, &after, &error) != IMK_OK) {
        raise_error(&error, "want");
        return false;
    }
    want->retuned = d->a.retuned == 1;
    const double outage = imk_drift_outage(&d->a.settings.drift);
    if (after && isnan(outage)) {
        PyErr_SetString(PyExc_ValueError, "\"after\" in want counts from the end of the aids, and "
                                          "no aid ends; add \"until 600 s\" to one");
        return false;
    }
    if (after)
        want->time += outage;
    when->time = d->times.count ? d->times.data[0] : NULL;
    when->time_count = d->times.rows;
    when->outage = d->outage.count ? d->outage.data[0] : NULL;
    when->outage_count = d->outage.rows;
    when->curves = true;
    if (imk_drift_times_ask(when, &d->a.settings.drift, want, NULL, &d->chosen, &error) == IMK_OK)
        return true;
    raise_error(&error, NULL);
    return false;
}

/* Perfect sensors stand for those that there are not. */
static bool complete(analysis *d)
{
    static const char *const names[] = {"gyros", "accelerometers"};
    bool good = true;
    for (size_t m = 0; m < d->list.count && good; m++) {
        const int added = imk_model_complete(d->list.model[m]);
        (void)imk_model_complete(d->list.whole[m]);
        if (added >= 0)
            good = add_finding(d->findings, IMK_FINDING_NOTE, "completed",
                               "%s has no %s: perfect ones are taken, so that all errors are those "
                               "of its %s",
                               d->list.name[m], names[added != IMK_GYRO], names[added == IMK_GYRO]);
    }
    return good;
}

/* ---- doing it ---- */

static imk_status analyse(analysis *d, const imk_job *job, imk_error *error)
{
    const model_list *l = &d->list;
    const bool selected = l->terms.only || l->terms.without;
    imk_drift_models_settings *s = &d->a.settings;
    s->assume = l->terms.assume;
    s->assumed_class = l->terms.grade;
    s->filter_models = selected ? (const imk_model *const *)l->whole : NULL;
    imk_status status = imk_drift_models_run(l->count, (const imk_model *const *)l->model, l->name,
                                             &d->chosen, s, job, &d->r, error);
    if (status == IMK_OK && d->a.runs > 0)
        status = imk_drift_models_simulate(d->r, d->a.seed, d->a.runs, job, &d->errors, error);
    return status;
}

/* A message about the model names it; one about the settings does not. */
static void refuse(const analysis *d, const imk_error *error)
{
    const bool of_model = strncmp(error->field, "gyro", 4) == 0 ||
                          strncmp(error->field, "accel", 5) == 0 ||
                          strncmp(error->field, "timing", 6) == 0;
    raise_error(error, of_model && d->r && d->r->case_count > 0
                           ? d->r->cases[d->r->case_count - 1].name
                           : NULL);
}

/* ---- what is given back ---- */

/* The last model as data, for the values of its terms. */
static imk_result *model_data(const analysis *d)
{
    char *text = NULL;
    size_t size;
    imk_result *model = imk_result_create(NULL);
    if (model &&
        imk_model_print_json(d->list.model[d->list.count - 1], NULL, &text, &size, NULL) == IMK_OK)
        (void)imk_result_json(model, "model", text);
    free(text);
    return model;
}

static PyObject *show(analysis *d)
{
    const imk_drift_models *r = d->r;
    imk_result *result = begin_result("drift"), *model = r->answer ? model_data(d) : NULL;
    if (!result) {
        imk_result_free(model);
        return NULL;
    }
    const imk_drift_shown shown = {d->motion.file ? d->motion.name : NULL,
                                   d->a.seed,
                                   imk_drift_verdict(r, result),
                                   model,
                                   d->list.terms.assume ? d->list.assumed : NULL,
                                   d->a.filter_name};
    const bool told = add_verdict(d->findings, &shown.verdict);
    imk_show_drift(r, &shown, result);
    page_models(&d->list, result);
    imk_result_free(model);
    if (told)
        return make_result(result);
    imk_result_free(result);
    return NULL;
}

static PyObject *moments_of(const imk_drift_moments *moments, size_t count)
{
    return numbers_of(moments->mean, count * (sizeof *moments / sizeof(double)));
}

static bool append(PyObject *list, PyObject *item)
{
    const bool good = item && PyList_Append(list, item) == 0;
    Py_XDECREF(item);
    return good;
}

/* (model, compensated, source, moments against time) of the total, what the filter believes, and
 * each source. */
static bool list_moments(const imk_drift_case *one, PyObject *list)
{
    const imk_drift_analysis *a = one->analysis;
    const int compensated = one->settings.compensated;
    bool good = append(list, Py_BuildValue("(sisN)", one->name, compensated, "",
                                           moments_of(a->total, a->time_count)));
    if (good && a->believed)
        good = append(list, Py_BuildValue("(sisN)", one->name, compensated, "believed",
                                          moments_of(a->believed, a->time_count)));
    for (size_t k = 0; k < a->source_count && good; k++)
        good = append(
            list, Py_BuildValue("(sisN)", one->name, compensated, a->source[k].name,
                                moments_of(&a->contribution[k * a->time_count], a->time_count)));
    return good;
}

/* Times, moments, the times of the table, and the errors of the runs. */
static PyObject *arrays_of(const analysis *d)
{
    const imk_drift_models *r = d->r;
    double row[IMK_DRIFT_ROWS_MAX];
    PyObject *moments = PyList_New(0), *made = NULL;
    bool good = moments != NULL;
    for (size_t c = 0; c < r->case_count && good; c++)
        good = list_moments(&r->cases[c], moments);
    for (size_t k = 0; k < r->times->row_count; k++)
        row[k] = r->times->time[r->times->row[k]];
    const size_t states = r->nees_degrees > 0 ? IMK_DRIFT_AIDED_STATES : IMK_DRIFT_STATES;
    const size_t values = d->errors ? (size_t)r->run_count * r->times->row_count * states : 0;
    if (good)
        made = Py_BuildValue("(NONN)", numbers_of(r->times->time, r->times->count), moments,
                             numbers_of(row, r->times->row_count), numbers_of(d->errors, values));
    Py_XDECREF(moments);
    return made;
}

static PyObject *give(analysis *d)
{
    PyObject *shown = show(d), *arrays = shown ? arrays_of(d) : NULL;
    if (arrays)
        return Py_BuildValue("(NON)", shown, d->findings, arrays);
    Py_XDECREF(shown);
    return NULL;
}

static PyObject *run(analysis *d, int threads, PyObject *progress)
{
    work w;
    imk_error error;
    if (!work_begin(&w, threads, progress))
        return NULL;
    const imk_status status = analyse(d, &w.job, &error);
    if (work_end(&w) && status != IMK_OK)
        refuse(d, &error);
    return PyErr_Occurred() ? NULL : give(d);
}

/* drift(models, terms, settings, initial, times, outage, motion, filter, aids, threads, progress)
 * -> (result, findings, arrays) */
static PyObject *drift(PyObject *module, PyObject *args)
{
    PyObject *pairs, *tuple, *dictionary, *times, *outage, *motion, *filter, *texts, *progress;
    PyObject *made = NULL;
    int threads;
    model_terms terms;
    analysis d = {.a = {.settings = imk_drift_models_default(), .seed = 1}};
    imk_drift_settings *s = &d.a.settings.drift;
    double *i = s->initial_sigma;
    (void)module;
    if (!PyArg_ParseTuple(args, "O!O!O!(ddddddddd)OOOOO!iO", &PyTuple_Type, &pairs, &PyTuple_Type,
                          &tuple, &PyDict_Type, &dictionary, i, i + 1, i + 2, i + 3, i + 4, i + 5,
                          i + 6, i + 7, i + 8, &times, &outage, &motion, &filter, &PyTuple_Type,
                          &texts, &threads, &progress) ||
        !terms_take(tuple, &terms))
        return NULL;
    d.findings = PyList_New(0);
    s->aid = d.aid;
    if (d.findings && SETTINGS_READ(dictionary, rows, &d.a) &&
        models_take(pairs, &terms, &d.list) && take_list(times, &d.times) &&
        take_list(outage, &d.outage) && take_motion(&d, motion) && take_filter(&d, filter) &&
        aids_take(texts, d.aid, &s->aid_count) && take_times(&d) && complete(&d))
        made = run(&d, threads, progress);
    imk_drift_models_free(d.r);
    imk_drift_times_free(&d.chosen);
    columns_release(&d.times);
    columns_release(&d.outage);
    models_free(&d.list);
    PyMem_Free(d.filter);
    Py_XDECREF(d.findings);
    return made;
}

/* drift_figures(moments) -> figures: [time] of both */
static PyObject *drift_figures(PyObject *module, PyObject *moments)
{
    char *bytes;
    Py_ssize_t size;
    (void)module;
    if (PyBytes_AsStringAndSize(moments, &bytes, &size) != 0)
        return NULL;
    const size_t count = (size_t)size / sizeof(imk_drift_moments);
    PyObject *made =
        PyBytes_FromStringAndSize(NULL, (Py_ssize_t)(count * sizeof(imk_drift_figures)));
    for (size_t t = 0; made && t < count; t++) {
        imk_drift_moments m;
        memcpy(&m, bytes + t * sizeof m, sizeof m);
        const imk_drift_figures figures = imk_drift_figures_of(&m);
        memcpy(PyBytes_AsString(made) + t * sizeof figures, &figures, sizeof figures);
    }
    return made;
}

PyMethodDef drift_functions[] = {
    {"drift_figures", drift_figures, METH_O, "drift_figures(moments): figures of moments."},
    {"drift", drift, METH_VARARGS,
     "drift(models, terms, settings, initial, times, outage, motion, filter, aids, threads, "
     "progress): growth of errors."},
    {NULL, NULL, 0, NULL}};
