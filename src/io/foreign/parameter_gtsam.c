/* SPDX-License-Identifier: Apache-2.0 */
/* GTSAM: PreintegrationCombinedParams, as a module of Python, or as a header of C++ for a name that
 * ends so. GTSAM itself reads no file.
 *
 * ImuFactor.cpp and CombinedImuFactor.cpp of borglab/gtsam divide the covariances of the readings
 * by dt and multiply those of the biases by it: N^2 and K^2 of each axis. integrationCovariance is
 * of the integration, and has the value of GTSAM's example. biasAccOmegaInt is treated in
 * integrateMeasurement() like more white noise of the readings, and is 1 unless it is set: it is 0
 * here. The setter of it has had two names. */
#include "parameter_internal.h"

#include <math.h>
#include <string.h>

static const char *const setters[IMKI_DENSITIES] = {
    "setGyroscopeCovariance", "setBiasOmegaCovariance", "setAccelerometerCovariance",
    "setBiasAccCovariance"};
static const char *const comments[IMKI_DENSITIES] = {"N^2 [(rad/s)^2/Hz]", "K^2 [(rad/s^2)^2/Hz]",
                                                     "N^2 [(m/s^2)^2/Hz]", "K^2 [(m/s^3)^2/Hz]"};
/* Of the roots. */
static const imki_unit units[IMKI_DENSITIES] = {{"rad/s/sqrt(Hz) (root)", 1},
                                                {"rad/s^2/sqrt(Hz) (root)", 1},
                                                {"m/s^2/sqrt(Hz) (root)", 1},
                                                {"m/s^3/sqrt(Hz) (root)", 1}};

static const double *density(const imk_triad *triad, int i)
{
    return i % 2 == 0 ? triad->noise.white.value : triad->noise.random_walk.value;
}

/* ---- reading --------------------------------------------------------------------------------- */

static imki_place place_of(const imki_parameters *p, int i, const char *at)
{
    imki_place place = {setters[i], 1, 1};
    for (const char *c = p->text; c < at; c++) {
        place.column = *c == '\n' ? 1 : place.column + 1;
        place.line += *c == '\n';
    }
    return place;
}

/* Three numbers behind the last opening bracket: np.diag([a, b, c]), Vector3(a, b, c). */
static bool read_three(const char *at, double values[3])
{
    const char *end = at + strcspn(at, "\n");
    const char *begin = at;
    for (const char *c = at; c < end && *c != ']' && *c != ')'; c++)
        if (*c == '[' || *c == '(')
            begin = c + 1;
    for (int i = 0; i < 3; i++) {
        const char *stop = begin + strcspn(begin, i < 2 ? ",\n" : "])\n");
        if (stop >= end || !imki_number(begin, stop, &values[i]))
            return false;
        begin = stop + 1;
    }
    return true;
}

static void read_covariance(imki_parameters *p, int i)
{
    const char *at = strstr(p->text, setters[i]);
    double raw[3] = {0};
    imk_noise *noise = &p->triad[i / 2]->noise;
    if (!at) {
        imki_note(p, true, "%s is not in the file: the model has none", setters[i]);
        return;
    }
    const imki_place place = place_of(p, i, at);
    at += strlen(setters[i]);
    if (!read_three(at, raw)) {
        imki_parameter_refuse_at(p, place, IMK_ERROR_SYNTAX, "",
                                 "np.diag([1, 2, 3]) or gtsam::Vector3(1, 2, 3).asDiagonal(), "
                                 "numbers only");
        return;
    }
    if (strstr(at, setters[i]))
        imki_parameter_refuse_at(p, place, IMK_ERROR_KEY_DUPLICATE, "", "one call of it");
    imki_square_roots(p, place, 3, raw);
    imki_accept(p, place, i / 2, i % 2 == 0 ? IMKI_WHITE : IMKI_RANDOM_WALK, raw, units[i],
                i % 2 == 0 ? noise->white.value : noise->random_walk.value);
}

void imki_gtsam_read(imki_parameters *p)
{
    bool any = false;
    for (int i = 0; i < IMKI_DENSITIES; i++)
        any = any || strstr(p->text, setters[i]);
    if (!any)
        imki_parameter_refuse(p, IMK_ERROR_KEY_MISSING, setters[0], "",
                              "a text that calls setGyroscopeCovariance or "
                              "setAccelerometerCovariance");
    for (int i = 0; i < IMKI_DENSITIES && p->status == IMK_OK; i++)
        read_covariance(p, i);
}

/* ---- writing --------------------------------------------------------------------------------- */

static void write_covariances(imki_parameters *p, const char *indent, const char *call,
                              const char *open, const char *close, const char *comment)
{
    for (int i = 0; i < IMKI_DENSITIES; i++) {
        double squares[3];
        if (!p->origin[i / 2]->present) {
            imki_note(p, true, "%s is not called, because the model has no %s: add it", setters[i],
                      i < 2 ? "gyros" : "accelerometers");
            continue;
        }
        for (int axis = 0; axis < 3; axis++)
            squares[axis] = density(p->origin[i / 2], i)[axis] * density(p->origin[i / 2], i)[axis];
        if (!(squares[0] > 0 && squares[1] > 0 && squares[2] > 0))
            imki_note(p, true, "%s has a 0, with which GTSAM's covariance may be singular",
                      setters[i]);
        imki_text_add(&p->out, "%s%s%s%s", indent, call, setters[i], open);
        imki_text_numbers(&p->out, squares, 3, ", ");
        imki_text_add(&p->out, "%s  %s %s\n", close, comment, comments[i]);
    }
}

static const char explanation[] =
    "%s GTSAM: continuous-time, two-sided covariances of each axis; gravity [m/s^2] points down, z "
    "up.\n"
    "%s integrationCovariance is GTSAM's example, not of the sensor. biasAccOmegaInt is 0, "
    "because\n"
    "%s it acts like more white noise of the readings.\n";

static void write_python(imki_parameters *p)
{
    imki_text_add(&p->out, explanation, "#", "#", "#");
    imki_text_remarks(p, "# ");
    imki_text_add(&p->out,
                  "import gtsam\nimport numpy as np\n\n\n"
                  "def imu_parameters(gravity=9.81):\n"
                  "    params = gtsam.PreintegrationCombinedParams.MakeSharedU(gravity)\n");
    write_covariances(p, "    ", "params.", "(np.diag([", "]))", "#");
    imki_text_add(&p->out, "    params.setIntegrationCovariance(1e-8 * np.eye(3))\n"
                           "    set_initial = getattr(params, \"setBiasAccOmegaInit\", None) or "
                           "params.setBiasAccOmegaInt\n"
                           "    set_initial(np.zeros((6, 6)))\n"
                           "    return params\n");
}

static void write_cpp(imki_parameters *p)
{
    imki_text_add(&p->out, explanation, "//", "//", "//");
    imki_text_remarks(p, "// ");
    imki_text_add(&p->out, "#pragma once\n\n#include <gtsam/navigation/CombinedImuFactor.h>\n\n"
                           "inline auto imuParameters(double gravity = 9.81)\n{\n"
                           "    auto params = gtsam::PreintegrationCombinedParams::MakeSharedU("
                           "gravity);\n");
    write_covariances(p, "    ", "params->", "(gtsam::Vector3(", ").asDiagonal());", "//");
    imki_text_add(&p->out, "    params->setIntegrationCovariance(1e-8 * gtsam::I_3x3);\n"
                           "    params->biasAccOmegaInt.setZero();\n"
                           "    return params;\n}\n");
}

void imki_gtsam_write(imki_parameters *p)
{
    if (p->is_cpp)
        write_cpp(p);
    else
        write_python(p);
}
