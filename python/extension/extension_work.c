/* SPDX-License-Identifier: Apache-2.0 */
/* A job runs on its own threads without the interpreter's lock; it takes the lock now and then to
 * show its progress and to see Ctrl-C. */
#include "extension.h"

#include "imukit/memory_limit.h"

#include <time.h>

static double now(void)
{
    struct timespec t;
    timespec_get(&t, TIME_UTC);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* @return false where something was raised or the function wants an end */
static bool ask(work *w, const char *stage, const char *unit, uint64_t done, uint64_t total)
{
    bool go = PyErr_CheckSignals() == 0;
    if (go && w->progress) {
        PyObject *said = PyObject_CallFunction(w->progress, "ssKK", stage, unit,
                                               (unsigned long long)done, (unsigned long long)total);
        go = said == Py_None || (said && PyObject_IsTrue(said) == 1);
        Py_XDECREF(said);
    }
    if (PyErr_Occurred()) {
        PyErr_Fetch(&w->type, &w->value, &w->trace);
        go = false;
    }
    return go;
}

static bool show(void *context, const char *stage, const char *unit, uint64_t done, uint64_t total)
{
    work *w = context;
    const double time = now();
    if (w->type)
        return false;
    if (time > w->asked && time < w->asked + 0.05 && (total == 0 || done < total))
        return true;
    w->asked = time;
    const PyGILState_STATE lock = PyGILState_Ensure();
    const bool go = ask(w, stage, unit, done, total);
    PyGILState_Release(lock);
    return go;
}

bool work_begin(work *w, int threads, PyObject *progress)
{
    *w = (work){.progress = progress == Py_None ? NULL : progress};
    if (threads < 0 || threads > 65536) {
        PyErr_Format(PyExc_ValueError, "threads=%d: expected 1 to 65536, or 0 for all processors",
                     threads);
        return false;
    }
    if (w->progress && !PyCallable_Check(w->progress)) {
        PyErr_SetString(PyExc_TypeError,
                        "progress: expected a function of (stage, unit, done, total)");
        return false;
    }
    w->pool = threads == 1 ? NULL : imk_thread_pool_create((size_t)threads);
    w->executor = imk_thread_pool_executor(w->pool);
    w->job = (imk_job){.executor = &w->executor,
                       .progress = show,
                       .progress_context = w,
                       .memory = imk_memory_limit() / 2};
    w->state = PyEval_SaveThread();
    return true;
}

bool work_end(work *w)
{
    imk_thread_pool_destroy(w->pool);
    PyEval_RestoreThread(w->state);
    if (!w->type)
        return PyErr_CheckSignals() == 0;
    PyErr_Restore(w->type, w->value, w->trace);
    return false;
}
