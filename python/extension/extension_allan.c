/* SPDX-License-Identifier: Apache-2.0 */
/* Allan deviations: of a record with intervals, and the plain statistic of one array. */
#include "extension.h"

#include "imukit/show.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const setting allan_rows[] = {
#define ROW(field, kind, words)                                                                    \
    {                                                                                              \
#field, kind, offsetof(imk_allan_log_settings, field), words                               \
    }
    ROW(gaps, SETTING_CHOICE, "refuse|bridge|longest|keep"),
    ROW(phase, SETTING_FLAG, NULL),
    ROW(confidence, SETTING_NUMBER, NULL),
    ROW(greenhall_riley, SETTING_FLAG, NULL),
    ROW(bias, SETTING_CHOICE, "removed|published|left"),
    ROW(grid, SETTING_CHOICE, "octave|decade|all|many"),
#undef ROW
};

/* The statistic of a name; IMK_ALLAN_STATISTICS with an exception for another word. */
static imk_allan_statistic statistic_of(PyObject *object)
{
    const char *text = utf8_of(object, NULL);
    for (size_t k = 0; text && k < IMK_ALLAN_STATISTICS; k++)
        if (strcmp(text, imk_allan_name((imk_allan_statistic)k)) == 0)
            return (imk_allan_statistic)k;
    if (text)
        PyErr_Format(PyExc_ValueError,
                     "statistic='%s': expected oadev, adev, mdev, tdev, ohdev, hdev, totdev, mtot, "
                     "htot, theo1, pdev or haar",
                     text);
    return IMK_ALLAN_STATISTICS;
}

static bool read_statistics(PyObject *names, imk_allan_log_settings *s)
{
    s->statistic_count = 0;
    for (Py_ssize_t k = 0; k < PyTuple_Size(names); k++) {
        const imk_allan_statistic statistic = statistic_of(PyTuple_GetItem(names, k));
        if (statistic == IMK_ALLAN_STATISTICS)
            return false;
        for (size_t i = 0; i < s->statistic_count; i++)
            if (s->statistic[i] == statistic) {
                PyErr_Format(PyExc_ValueError, "statistic: %s is named twice",
                             imk_allan_name(statistic));
                return false;
            }
        s->statistic[s->statistic_count++] = statistic;
    }
    if (s->statistic_count == 0)
        PyErr_SetString(PyExc_ValueError, "statistic: none is named");
    return s->statistic_count > 0;
}

/* allan(record, statistics, times, settings, threads, progress) -> (result, findings) */
static PyObject *allan(PyObject *module, PyObject *args)
{
    PyObject *object, *names, *list, *dictionary, *progress, *made = NULL;
    int threads;
    imk_allan_log_settings s = imk_allan_log_default();
    columns times = {0};
    work w;
    (void)module;
    if (!PyArg_ParseTuple(args, "OO!OO!iO", &object, &PyTuple_Type, &names, &list, &PyDict_Type,
                          &dictionary, &threads, &progress) ||
        !SETTINGS_READ(dictionary, allan_rows, &s) || !read_statistics(names, &s))
        return NULL;
    if (list != Py_None && !columns_take(list, &times)) {
        columns_release(&times);
        return NULL;
    }
    s.times = times.data[0];
    s.time_count = times.rows;
    record *r = record_begin(object);
    if (r && work_begin(&w, threads, progress)) {
        imk_allan_log *log = NULL;
        imk_error error;
        const imk_status status = imk_allan_log_run(&r->source, &s, &w.job, &log, &error);
        if (work_end(&w) && status != IMK_OK)
            raise_failure(log ? &log->findings : NULL, &error, r->name, "the model");
        imk_result *shown = PyErr_Occurred() ? NULL : begin_result("allan");
        if (shown) {
            imk_show_allan_log(log, r->name, shown);
            made = result_with(shown, &log->findings, r->name, "the model");
        }
        imk_allan_log_free(log);
    }
    if (r)
        record_end(r);
    columns_release(&times);
    return made;
}

/* A vector, its statistic, and where the results go. */
typedef struct plain_job {
    imk_allan_statistic statistic;
    bool phase;
    double scale;
    columns data, factors, results;
    size_t n, *factor, *count; /* rates; averaging factors and squares */
    double *sums;              /* NULL: the phase as it is */
    void *workspace;
    size_t workspace_size, bad; /* the sample that is not finite */
} plain_job;

static bool plain_take(plain_job *p, PyObject *data, PyObject *factors, PyObject *results)
{
    if (!columns_take(data, &p->data) || !columns_take(factors, &p->factors) ||
        !columns_take_writable(results, &p->results))
        return false;
    if (p->data.count != 1 || p->factors.count != 1 || p->results.count != 2 ||
        p->factors.rows != p->results.rows) {
        PyErr_SetString(PyExc_ValueError, p->data.count != 1
                                              ? "data: expected one vector"
                                              : "factors, deviations, counts: expected vectors of "
                                                "equal length");
        return false;
    }
    const size_t rows = p->data.rows;
    p->n = p->phase ? (rows > 0 ? rows - 1 : 0) : rows;
    p->factor = PyMem_Malloc((2 * p->factors.rows + 1) * sizeof *p->factor);
    p->count = p->factor ? p->factor + p->factors.rows : NULL;
    if (!p->phase || p->data.stride[0] != 1)
        p->sums = PyMem_Malloc((rows + 1) * sizeof *p->sums);
    if (!p->factor || (!p->sums && (!p->phase || p->data.stride[0] != 1)))
        PyErr_NoMemory();
    for (size_t k = 0; k < p->factors.rows && p->factor; k++) {
        const double m = p->factors.data[0][(ptrdiff_t)k * p->factors.stride[0]];
        p->factor[k] = m >= 1 && m <= (double)p->n ? (size_t)m : 0;
    }
    return !PyErr_Occurred();
}

/* The first value that is not finite; `count`: all are. */
static size_t find_not_finite(const double *values, size_t count)
{
    enum { LANES = 16 };
    double lane[LANES] = {0};
    size_t k = 0;
    for (; k + LANES <= count; k += LANES)
        for (size_t l = 0; l < LANES; l++)
            lane[l] += 0 * values[k + l]; /* 0, or NaN from then on */
    for (size_t l = 0; l < LANES; l++)
        k = isnan(lane[l]) ? 0 : k;
    while (k < count && isfinite(values[k]))
        k++;
    return k;
}

/* Factors between two looks for Ctrl-C, of about 50 ms: the total deviations and Theo1 take some
 * 100 ns a sample and factor, the others 2 ns. Short lists of these share a walk through the data.
 */
static size_t factors_at_once(const plain_job *p, size_t threads)
{
    const bool slow = p->statistic == IMK_ALLAN_MODIFIED_TOTAL ||
                      p->statistic == IMK_ALLAN_HADAMARD_TOTAL || p->statistic == IMK_ALLAN_THEO1;
    const size_t share = (slow ? 500000 : 25000000) / (p->n + 1), least = slow ? threads : 64;
    return share > least ? share : least;
}

/* A workspace large enough for some factors. */
static bool workspace_take(plain_job *p, size_t count, const size_t *factor, size_t threads)
{
    const size_t size = imk_allan_workspace_size(p->statistic, p->n, count, factor, threads);
    if (size > p->workspace_size) {
        free(p->workspace);
        p->workspace = malloc(size); /* without the lock */
        p->workspace_size = p->workspace ? size : 0;
    }
    return p->workspace_size >= size;
}

static imk_status compute_factors(plain_job *p, const imk_job *job, const double *sums)
{
    const size_t all = p->factors.rows;
    const size_t threads = job->executor->threads > 0 ? job->executor->threads : 1;
    const size_t portion = factors_at_once(p, threads);
    imk_status status = IMK_OK;
    for (size_t done = 0; done < all && status == IMK_OK; done += portion) {
        const size_t count = all - done < portion ? all - done : portion;
        const size_t *factor = p->factor + done;
        if (done > 0 && !job->progress(job->progress_context, "allan", "points", done, all))
            return IMK_ERROR_CANCELLED;
        if (!workspace_take(p, count, factor, threads))
            return IMK_ERROR_MEMORY;
        status =
            imk_allan_compute(p->statistic, p->n, sums, count, factor, p->results.data[0] + done,
                              p->count + done, job->executor, p->workspace, p->workspace_size);
    }
    return status;
}

static imk_status plain_run(plain_job *p, const imk_job *job)
{
    const double *data = p->data.data[0];
    const ptrdiff_t stride = p->data.stride[0];
    for (size_t k = 0; k < p->data.rows && stride != 1; k++)
        p->sums[k] = data[(ptrdiff_t)k * stride];
    data = stride != 1 ? p->sums : data;
    /* What is not finite is so in the last sum, if that does not overwrite the samples. */
    const bool before = p->phase || data == p->sums;
    p->bad = before ? find_not_finite(data, p->data.rows) : p->data.rows;
    if (p->bad == p->data.rows && !p->phase)
        imk_allan_sums(p->n, data, p->sums, job->executor);
    if (!before && !isfinite(p->sums[p->n]))
        p->bad = find_not_finite(data, p->data.rows);
    if (p->bad < p->data.rows)
        return IMK_ERROR_NOT_FINITE;
    if (!p->count)
        return IMK_ERROR_MEMORY;
    double *deviations = p->results.data[0], *counts = p->results.data[1];
    const imk_status status = compute_factors(p, job, p->sums ? p->sums : data);
    for (size_t k = 0; k < p->factors.rows && status == IMK_OK; k++) {
        deviations[k] = p->scale * sqrt(deviations[k]);
        counts[k] = (double)p->count[k];
    }
    return status;
}

static void plain_release(plain_job *p)
{
    columns_release(&p->data);
    columns_release(&p->factors);
    columns_release(&p->results);
    PyMem_Free(p->factor);
    PyMem_Free(p->sums);
    free(p->workspace);
}

/* deviation(data, statistic, phase, scale, factors, (deviations, counts), threads) */
static PyObject *deviation(PyObject *module, PyObject *args)
{
    PyObject *data, *name, *factors, *results;
    plain_job p = {0};
    int phase, threads;
    work w;
    (void)module;
    if (!PyArg_ParseTuple(args, "OOpdOOi", &data, &name, &phase, &p.scale, &factors, &results,
                          &threads))
        return NULL;
    p.phase = phase;
    p.statistic = statistic_of(name);
    imk_status status = IMK_OK;
    if (p.statistic != IMK_ALLAN_STATISTICS && plain_take(&p, data, factors, results) &&
        work_begin(&w, threads, Py_None)) {
        status = plain_run(&p, &w.job);
        if (work_end(&w) && status != IMK_OK) {
            imk_error error;
            imk_error_set(&error, status, "data", NULL, NULL);
            if (status == IMK_ERROR_NOT_FINITE)
                error.index = (int)(p.bad < INT32_MAX ? p.bad : INT32_MAX);
            raise_error(&error, NULL);
        }
    }
    plain_release(&p);
    return PyErr_Occurred() ? NULL : Py_NewRef(Py_None);
}

PyMethodDef allan_functions[] = {
    {"deviation", deviation, METH_VARARGS,
     "deviation(data, statistic, phase, scale, factors, (deviations, counts), threads): the "
     "statistic at averaging factors, and how many squares it averages."},
    {"allan", allan, METH_VARARGS,
     "allan(record, statistics, times, settings, threads, progress): deviations with intervals."},
    {NULL, NULL, 0, NULL}};
