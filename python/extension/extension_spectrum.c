/* SPDX-License-Identifier: Apache-2.0 */
/* Spectra: densities, lines and the noise they show. */
#include "extension.h"

#include "imukit/channel_units.h"
#include "imukit/show.h"

static const setting spectrum_rows[] = {
#define ROW(field, kind, words)                                                                    \
    {                                                                                              \
#field, kind, offsetof(imk_spectrum_log_settings, field), words                            \
    }
    ROW(gaps, SETTING_CHOICE, "refuse|bridge|longest"),
    ROW(method, SETTING_CHOICE, "welch|multitaper"),
    ROW(window, SETTING_CHOICE, "hann|blackman-harris|kaiser"),
    ROW(resolution, SETTING_QUANTITY, "Hz"),
    ROW(trend, SETTING_FLAG, NULL),
    ROW(from, SETTING_QUANTITY, "Hz"),
    ROW(to, SETTING_QUANTITY, "Hz"),
    ROW(confidence, SETTING_NUMBER, NULL),
    ROW(false_alarm, SETTING_NUMBER, NULL),
    ROW(one_sided, SETTING_FLAG, NULL),
#undef ROW
};

enum { CURVE_NUMBERS = 5 };

/* (name, unit, frequency, density, lower, upper, degrees) of a channel; the numbers are bytes of
 * float64. */
static PyObject *curve_of(const imk_spectrum_log *s, size_t channel)
{
    const imk_log_column *column = imk_even_record_column(&s->record, channel);
    const imk_channel_spectrum *f = &s->channel[channel];
    const Py_ssize_t size = (Py_ssize_t)(f->fine_count * sizeof(double));
    PyObject *made[CURVE_NUMBERS] = {NULL};
    double *to[CURVE_NUMBERS];
    bool good = true;
    for (int k = 0; k < CURVE_NUMBERS; k++) {
        made[k] = PyBytes_FromStringAndSize(NULL, size);
        to[k] = made[k] ? (double *)(void *)PyBytes_AsString(made[k]) : NULL;
        good = good && to[k];
    }
    for (size_t i = 0; good && i < f->fine_count; i++) {
        const imk_spectrum_band b = imk_spectrum_log_band(s, channel, &f->fine[i]);
        const double number[CURVE_NUMBERS] = {b.frequency, b.density, b.lower, b.upper, b.degrees};
        for (int k = 0; k < CURVE_NUMBERS; k++)
            to[k][i] = number[k];
    }
    PyObject *curve =
        good ? Py_BuildValue("(ssOOOOO)", column->name, imk_channel_plain_unit(column).text,
                             made[0], made[1], made[2], made[3], made[4])
             : NULL;
    for (int k = 0; k < CURVE_NUMBERS; k++)
        Py_XDECREF(made[k]);
    return curve;
}

static PyObject *curves_of(const imk_spectrum_log *s)
{
    PyObject *list = PyList_New(0);
    for (size_t c = 0; list && s && c < s->record.count; c++) {
        PyObject *curve = curve_of(s, c);
        if (!curve || PyList_Append(list, curve) != 0)
            Py_CLEAR(list);
        Py_XDECREF(curve);
    }
    return list;
}

static PyObject *show(const imk_spectrum_log *s, const record *r)
{
    PyObject *curves = curves_of(s);
    imk_result *shown = curves ? begin_result("spectrum") : NULL;
    if (!shown) {
        Py_XDECREF(curves);
        return NULL;
    }
    imk_show_spectrum_log(s, r->name, shown);
    return extended(result_with(shown, &s->findings, r->name, "the model"), curves);
}

/* spectrum(record, settings, threads, progress) -> (result, findings, curves) */
static PyObject *spectrum(PyObject *module, PyObject *args)
{
    PyObject *object, *dictionary, *progress, *made = NULL;
    int threads;
    imk_spectrum_log_settings s = imk_spectrum_log_default();
    work w;
    (void)module;
    if (!PyArg_ParseTuple(args, "OO!iO", &object, &PyDict_Type, &dictionary, &threads, &progress) ||
        !SETTINGS_READ(dictionary, spectrum_rows, &s))
        return NULL;
    record *r = record_begin(object);
    if (r && work_begin(&w, threads, progress)) {
        imk_spectrum_log *log = NULL;
        imk_error error;
        const imk_status status = imk_spectrum_log_run(&r->source, &s, &w.job, &log, &error);
        if (work_end(&w) && status != IMK_OK)
            raise_failure(log ? &log->findings : NULL, &error, r->name, "the model");
        made = PyErr_Occurred() ? NULL : show(log, r);
        imk_spectrum_log_free(log);
    }
    if (r)
        record_end(r);
    return made;
}

PyMethodDef spectrum_functions[] = {
    {"spectrum", spectrum, METH_VARARGS,
     "spectrum(record, settings, threads, progress): densities, lines and noise."},
    {NULL, NULL, 0, NULL}};
