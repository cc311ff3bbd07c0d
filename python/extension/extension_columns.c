/* SPDX-License-Identifier: Apache-2.0 */
/* Columns of numbers of any object with the buffer protocol, and of sequences of numbers. */
#include "extension.h"

#include <string.h>

/* A format with one item in native or stated byte order. */
typedef struct item_format {
    char kind; /* as in the module struct; 0: none that is a number */
    bool swapped;
} item_format;

static item_format format_of(const Py_buffer *view)
{
    const char *text = view->format ? view->format : "B";
    item_format f = {0};
    const char order = strchr("<>=@!", *text) ? *text++ : '@';
    const uint16_t one = 1;
    const bool little = *(const unsigned char *)&one == 1;
    f.swapped = (little && (order == '>' || order == '!')) || (!little && order == '<');
    if (!text[0] || text[1])
        return f;
    f.kind = text[0];
    return f;
}

#define NUMBER(type)                                                                               \
    {                                                                                              \
        type number;                                                                               \
        memcpy(&number, bytes, sizeof number);                                                     \
        *value = (double)number;                                                                   \
        return true;                                                                               \
    }

static bool signed_number(const unsigned char *bytes, size_t size, double *value)
{
    switch (size) {
    case 1:
        NUMBER(int8_t)
    case 2:
        NUMBER(int16_t)
    case 4:
        NUMBER(int32_t)
    case 8:
        NUMBER(int64_t)
    default:
        return false;
    }
}

static bool unsigned_number(const unsigned char *bytes, size_t size, double *value)
{
    switch (size) {
    case 1:
        NUMBER(uint8_t)
    case 2:
        NUMBER(uint16_t)
    case 4:
        NUMBER(uint32_t)
    case 8:
        NUMBER(uint64_t)
    default:
        return false;
    }
}

/* @return false for what is no number */
static bool number_at(const unsigned char *from, item_format f, size_t size, double *value)
{
    unsigned char bytes[8];
    if (size > sizeof bytes)
        return false;
    for (size_t k = 0; k < size; k++)
        bytes[k] = from[f.swapped ? size - 1 - k : k];
    if (f.kind == 'd' && size == sizeof(double))
        NUMBER(double)
    if (f.kind == 'f' && size == sizeof(float))
        NUMBER(float)
    if (f.kind && strchr("bhilqn", f.kind))
        return signed_number(bytes, size, value);
    if (f.kind && strchr("BHILQN?", f.kind))
        return unsigned_number(bytes, size, value);
    return false;
}

static bool is_double(const Py_buffer *view, Py_ssize_t stride)
{
    const item_format f = format_of(view);
    return f.kind == 'd' && !f.swapped && view->itemsize == (Py_ssize_t)sizeof(double) &&
           stride % (Py_ssize_t)sizeof(double) == 0 && (uintptr_t)view->buf % _Alignof(double) == 0;
}

/* The next column, of a vector or of a column of a matrix. */
static bool add_column(columns *c, const Py_buffer *view, const char *first, Py_ssize_t stride)
{
    const size_t k = c->count;
    if (is_double(view, stride)) {
        c->data[k] = (double *)(uintptr_t)first;
        c->stride[k] = stride / (Py_ssize_t)sizeof(double);
    } else {
        double none;
        const unsigned char zeros[8] = {0};
        const item_format f = format_of(view);
        if (!number_at(zeros, f, (size_t)view->itemsize, &none)) {
            PyErr_Format(PyExc_TypeError,
                         "items of the format \"%s\" are no numbers that imukit reads: convert "
                         "them to float64",
                         view->format ? view->format : "B");
            return false;
        }
        c->copy[k] = PyMem_Malloc((c->rows > 0 ? c->rows : 1) * sizeof(double));
        if (!c->copy[k]) {
            PyErr_NoMemory();
            return false;
        }
        for (size_t row = 0; row < c->rows; row++)
            (void)number_at((const unsigned char *)first + (Py_ssize_t)row * stride, f,
                            (size_t)view->itemsize, &c->copy[k][row]);
        c->data[k] = c->copy[k];
        c->stride[k] = 1;
    }
    c->count++;
    return true;
}

static bool check_rows(columns *c, Py_ssize_t rows)
{
    if (c->count > 0 && (size_t)rows != c->rows) {
        PyErr_Format(PyExc_ValueError, "column %zu has %zd rows and column 0 has %zu", c->count,
                     rows, c->rows);
        return false;
    }
    c->rows = (size_t)rows;
    return true;
}

static bool refuse_count(Py_ssize_t count)
{
    PyErr_Format(PyExc_ValueError,
                 "%zd columns: expected 1 to %d. Rows of a matrix are samples: is it to be "
                 "transposed?",
                 count, IMK_LOG_COLUMNS_MAX);
    return false;
}

static bool take_matrix(columns *c, const Py_buffer *view)
{
    if (view->shape[1] < 1 || view->shape[1] > IMK_LOG_COLUMNS_MAX)
        return refuse_count(view->shape[1]);
    if (!check_rows(c, view->shape[0]))
        return false;
    for (Py_ssize_t k = 0; k < view->shape[1]; k++)
        if (!add_column(c, view, (const char *)view->buf + k * view->strides[1], view->strides[0]))
            return false;
    return true;
}

/* A vector of Python numbers. */
static bool take_numbers(columns *c, PyObject *object)
{
    const Py_ssize_t rows = PySequence_Size(object);
    if (rows < 0 || !check_rows(c, rows))
        return false;
    double *copy = PyMem_Malloc((rows > 0 ? (size_t)rows : 1) * sizeof(double));
    if (!copy) {
        PyErr_NoMemory();
        return false;
    }
    c->data[c->count] = c->copy[c->count] = copy;
    c->stride[c->count++] = 1;
    for (Py_ssize_t row = 0; row < rows; row++) {
        PyObject *item = PySequence_GetItem(object, row);
        copy[row] = item ? PyFloat_AsDouble(item) : 0;
        Py_XDECREF(item);
        if (PyErr_Occurred())
            return false;
    }
    return true;
}

static bool take_vector(columns *c, PyObject *object)
{
    if (!PyObject_CheckBuffer(object) && PySequence_Check(object) && !PyUnicode_Check(object))
        return take_numbers(c, object);
    Py_buffer *view = &c->view[c->views];
    if (PyObject_GetBuffer(object, view, PyBUF_FULL_RO) != 0)
        return false;
    c->views++;
    if (view->ndim != 1 || view->suboffsets) {
        PyErr_Format(PyExc_ValueError,
                     "column %zu has %d dimensions: expected one; axes in a matrix stand in a "
                     "dictionary: {\"gyro [rad/s]\": w, \"accel [m/s^2]\": f}",
                     c->count, view->ndim);
        return false;
    }
    return check_rows(c, view->shape[0]) &&
           add_column(c, view, (const char *)view->buf, view->strides[0]);
}

static bool take_sequence(PyObject *data, columns *c, bool (*take)(columns *, PyObject *))
{
    const Py_ssize_t count = PySequence_Size(data);
    if (count < 0)
        return false;
    if (count < 1 || count > IMK_LOG_COLUMNS_MAX)
        return refuse_count(count);
    for (Py_ssize_t k = 0; k < count; k++) {
        PyObject *item = PySequence_GetItem(data, k);
        const bool taken = item && take(c, item);
        Py_XDECREF(item);
        if (!taken)
            return false;
    }
    return true;
}

bool columns_take(PyObject *data, columns *c)
{
    memset(c, 0, sizeof *c);
    if (!PyObject_CheckBuffer(data))
        return take_sequence(data, c, take_vector);
    if (PyObject_GetBuffer(data, &c->view[0], PyBUF_FULL_RO) != 0)
        return false;
    c->views = 1;
    const Py_buffer *view = &c->view[0];
    if (view->suboffsets || view->ndim < 1 || view->ndim > 2) {
        PyErr_Format(PyExc_ValueError, "an array of %d dimensions: expected one or two",
                     view->ndim);
        return false;
    }
    if (view->ndim == 2)
        return take_matrix(c, view);
    return check_rows(c, view->shape[0]) &&
           add_column(c, view, (const char *)view->buf, view->strides[0]);
}

static bool take_writable(columns *c, PyObject *object)
{
    Py_buffer *view = &c->view[c->views];
    if (PyObject_GetBuffer(object, view, PyBUF_FULL) != 0)
        return false;
    c->views++;
    if (view->ndim != 1 || !is_double(view, view->strides[0]) ||
        (view->shape[0] > 1 && view->strides[0] != (Py_ssize_t)sizeof(double))) {
        PyErr_Format(PyExc_TypeError,
                     "array %zu to be written: expected a contiguous vector of float64", c->count);
        return false;
    }
    return check_rows(c, view->shape[0]) &&
           add_column(c, view, (const char *)view->buf, (Py_ssize_t)sizeof(double));
}

bool columns_take_writable(PyObject *data, columns *c)
{
    memset(c, 0, sizeof *c);
    return take_sequence(data, c, take_writable);
}

void columns_release(columns *c)
{
    for (size_t k = 0; k < c->views; k++)
        PyBuffer_Release(&c->view[k]);
    for (size_t k = 0; k < IMK_LOG_COLUMNS_MAX; k++)
        PyMem_Free(c->copy[k]);
    memset(c, 0, sizeof *c);
}
