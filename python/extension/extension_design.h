/* SPDX-License-Identifier: Apache-2.0 */
/* Designs of instruments as objects, for the jobs on them. */
#ifndef IMUKIT_EXTENSION_DESIGN_H
#define IMUKIT_EXTENSION_DESIGN_H

#include "extension.h"

#include "imukit/design_file.h"

/** A design. */
typedef struct design {
    PyObject_HEAD imk_design_file file;
    int busy; /* jobs that read it: it is not changed then */
} design;
/** The design of an argument; NULL with an exception. */
design *design_of(PyObject *object);

/** Append an item to a list, and let go of it. @return false with an exception; also for NULL */
static inline bool append(PyObject *list, PyObject *item)
{
    const bool good = item && PyList_Append(list, item) == 0;
    Py_XDECREF(item);
    return good;
}

#endif
