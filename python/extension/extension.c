/* SPDX-License-Identifier: Apache-2.0 */
/* The module imukit._core. */
#include "extension.h"

static PyMethodDef *const functions[] = {record_functions, allan_functions,   identify_functions,
                                         unit_functions,   model_functions,   drift_functions,
                                         grade_functions,  navigate_functions};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT,
    .m_name = "imukit._core",
    .m_doc = "Jobs of the library imukit, with the values that the package imukit gives them.",
    .m_size = -1,
};

PyMODINIT_FUNC PyInit__core(void)
{
    PyObject *module = PyModule_Create(&definition);
    bool good = module && add_errors(module) && add_result(module) && add_record(module) &&
                add_model(module) && add_identify(module) &&
                PyModule_AddStringConstant(module, "version", imk_version()) == 0;
    for (size_t k = 0; good && k < sizeof functions / sizeof functions[0]; k++)
        good = PyModule_AddFunctions(module, functions[k]) == 0;
    if (!good)
        Py_CLEAR(module);
    return module;
}
