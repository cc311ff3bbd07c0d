/* SPDX-License-Identifier: Apache-2.0 */
/* The module imukit._core. */
#include "extension.h"

static PyMethodDef *const functions[] = {
    allan_functions,    calibrate_functions, compensate_functions, design_functions,
    drift_functions,    evaluate_functions,  grade_functions,      identify_functions,
    info_functions,     model_functions,     navigate_functions,   parameter_functions,
    physics_functions,  plan_functions,      record_functions,     sensor_functions,
    simulate_functions, spectrum_functions,  tune_functions,       unit_functions,
};

/* Types, exceptions and constants. */
static bool (*const additions[])(PyObject *module) = {
    add_errors,   add_result, add_record, add_calibrate, add_design,
    add_identify, add_model,  add_sensor, add_simulate,
};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT,
    .m_name = "imukit._core",
    .m_doc = "Jobs of the library imukit, with the values that the package imukit gives them.",
    .m_size = -1,
};

PyMODINIT_FUNC PyInit__core(void)
{
    PyObject *module = PyModule_Create(&definition);
    bool good = module && PyModule_AddStringConstant(module, "version", imk_version()) == 0;
    for (size_t k = 0; good && k < sizeof additions / sizeof additions[0]; k++)
        good = additions[k](module);
    for (size_t k = 0; good && k < sizeof functions / sizeof functions[0]; k++)
        good = PyModule_AddFunctions(module, functions[k]) == 0;
    if (!good)
        Py_CLEAR(module);
    return module;
}
