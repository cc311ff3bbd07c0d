/* SPDX-License-Identifier: Apache-2.0 */
/* Units and the Earth: short functions of numbers. */
#include "extension.h"

#include "imukit/earth.h"
#include "imukit/memory_limit.h"
#include "imukit/units.h"

static bool arguments(const char *name, Py_ssize_t count, Py_ssize_t due)
{
    if (count == due)
        return true;
    PyErr_Format(PyExc_TypeError, "%s() takes %zd arguments, and %zd are given", name, due, count);
    return false;
}

static PyObject *convert_unit(PyObject *module, PyObject *const *args, Py_ssize_t count)
{
    imk_unit from, to;
    (void)module;
    if (!arguments("convert_unit", count, 3))
        return NULL;
    const double value = PyFloat_AsDouble(args[0]);
    if (PyErr_Occurred() || !unit_read(args[1], NULL, &from) || !unit_read(args[2], NULL, &to))
        return NULL;
    if (!imk_dimension_equal(from.dimension, to.dimension)) {
        imk_error error;
        (void)imk_error_set(&error, IMK_ERROR_DIMENSION, to.text, from.text,
                            imk_dimension_examples(to.dimension));
        return raise_error(&error, NULL);
    }
    return PyFloat_FromDouble((from.scale * value + from.offset - to.offset) / to.scale);
}

static PyObject *normal_gravity(PyObject *module, PyObject *const *args, Py_ssize_t count)
{
    (void)module;
    if (!arguments("normal_gravity", count, 2))
        return NULL;
    double latitude, height;
    if (!quantity_read(args[0], "latitude", "rad", &latitude) ||
        !quantity_read(args[1], "height", "m", &height))
        return NULL;
    return PyFloat_FromDouble(imk_normal_gravity(latitude, height));
}

static PyObject *quantity(PyObject *module, PyObject *const *args, Py_ssize_t count)
{
    double value;
    (void)module;
    if (!arguments("quantity", count, 3))
        return NULL;
    const char *name = utf8_of(args[0], NULL);
    const char *unit = name ? utf8_of(args[2], NULL) : NULL;
    return unit && quantity_read(args[1], name, unit, &value) ? PyFloat_FromDouble(value) : NULL;
}

/* memory_limit() -> memory that this process may take [bytes] */
static PyObject *memory_limit(PyObject *module, PyObject *none)
{
    (void)module;
    (void)none;
    return PyLong_FromSize_t(imk_memory_limit());
}

enum { NUMBERS_MAX = 16 };

/* quantities(name, text, unit) -> the numbers of a text with one unit, and their 1 sigma */
static PyObject *quantities(PyObject *module, PyObject *const *args, Py_ssize_t count)
{
    double value[NUMBERS_MAX], sigma[NUMBERS_MAX] = {0};
    size_t found = 0;
    Py_ssize_t size;
    imk_error error;
    (void)module;
    if (!arguments("quantities", count, 3))
        return NULL;
    const char *name = utf8_of(args[0], NULL);
    const char *unit = name ? utf8_of(args[2], NULL) : NULL;
    const char *text = unit ? utf8_of(args[1], &size) : NULL;
    if (!text)
        return NULL;
    if (imk_quantity_parse(text, text + size, imk_unit_of(unit).dimension, NUMBERS_MAX, value,
                           sigma, &found, NULL, &error) != IMK_OK)
        return raise_error(&error, name);
    PyObject *values = PyTuple_New((Py_ssize_t)found), *sigmas = PyTuple_New((Py_ssize_t)found);
    for (size_t k = 0; k < found && values && sigmas; k++) {
        PyTuple_SetItem(values, (Py_ssize_t)k, PyFloat_FromDouble(value[k]));
        PyTuple_SetItem(sigmas, (Py_ssize_t)k, PyFloat_FromDouble(sigma[k]));
    }
    return values && sigmas ? Py_BuildValue("(NN)", values, sigmas) : NULL;
}

PyMethodDef unit_functions[] = {
    {"quantities", (PyCFunction)(void (*)(void))quantities, METH_FASTCALL,
     "quantities(name, text, unit): numbers of a text with one unit, and their 1 sigma."},
    {"quantity", (PyCFunction)(void (*)(void))quantity, METH_FASTCALL,
     "quantity(name, value, unit): a number in SI units, or a text with a unit."},
    {"convert_unit", (PyCFunction)(void (*)(void))convert_unit, METH_FASTCALL,
     "convert_unit(value, from_unit, to_unit, /)\n--\n\n"
     "Convert a number from one unit to another.\n\n"
     "Units as in the model file: 'deg/h', 'deg/sqrt(h)', 'ug/sqrt(Hz)', 'degC'. Raises "
     "imukit.Error for a unit that is not known or of another dimension.\n\n"
     ">>> import imukit\n"
     ">>> round(imukit.convert_unit(1.0, 'deg/h', 'rad/s'), 12)\n"
     "4.848137e-06\n"},
    {"memory_limit", memory_limit, METH_NOARGS, "memory_limit(): of this process [bytes]."},
    {"normal_gravity", (PyCFunction)(void (*)(void))normal_gravity, METH_FASTCALL,
     "normal_gravity(latitude, height, /)\n--\n\n"
     "Normal gravity [m/s^2] at a geodetic latitude [rad] and a height [m] above the ellipsoid "
     "(WGS 84); both may be texts with a unit. Raises imukit.Error: a latitude beyond the "
     "poles.\n\n"
     ">>> import imukit\n"
     ">>> round(imukit.normal_gravity('45 deg', 0.0), 6)\n"
     "9.806198\n"},
    {NULL, NULL, 0, NULL}};
