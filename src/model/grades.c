/* SPDX-License-Identifier: Apache-2.0 */
/* The five classes of inertial units, and the class of a model by its biases. The table as commonly
 * printed names no spinning wheels but the suspended one: "floated", "DTG" and "wheel" are our
 * addition, by the regions of technology_map.c. */
#include "imukit/model_unstated.h"

#include <math.h>
#include <string.h>

#define DEGREES_PER_HOUR (3.14159265358979323846 / 180 / 3600) /* [rad/s] */
#define MICRO_G (9.80665e-6)                                   /* [m/s^2] */
#define NAUTICAL_MILE 1852.0                                   /* [m] */
#define HOUR 3600.0                                            /* [s] */
#define NO_CLAIM ((double)NAN)

static const imk_grade_row grade_rows[] = {
    {"strategic", "1 nmi / 24 h", "ESG, floated, RLG, FOG", "servo", 0.005 * DEGREES_PER_HOUR,
     30 * MICRO_G, NAUTICAL_MILE, 24 * HOUR},
    {"navigation", "1 nmi / h", "floated, DTG, RLG, FOG", "servo, vibrating beam",
     0.01 * DEGREES_PER_HOUR, 50 * MICRO_G, NAUTICAL_MILE, HOUR},
    {"tactical", "> 10 nmi / h", "DTG, RLG, FOG", "servo, vibrating beam, MEMS",
     1 * DEGREES_PER_HOUR, 1000 * MICRO_G, (double)INFINITY, HOUR},
    {"AHRS", "n/a", "DTG, MEMS, RLG, FOG, Coriolis", "MEMS", 10 * DEGREES_PER_HOUR, 1000 * MICRO_G,
     NO_CLAIM, NO_CLAIM},
    {"control system", "n/a", "wheel, Coriolis", "MEMS", 1000 * DEGREES_PER_HOUR, 10000 * MICRO_G,
     NO_CLAIM, NO_CLAIM},
};

/* A figure on the limit of its class belongs to it, whatever the last bit of the conversion. */
static const double rounding = 1 + 1e-9;

const imk_grade_row *imk_grade_table(imk_grade grade)
{
    int index = (int)grade;
    return index >= 0 && index < (int)IMK_GRADE_NONE ? &grade_rows[index] : NULL;
}

/* The bias that stays after calibration, worst axis; NaN when none is stated. */
static double remaining_bias(const imk_triad *triad)
{
    double worst = 0;
    for (int i = 0; triad->present && i < triad->axis_count && i < IMK_AXES_MAX; i++) {
        double repeatability = triad->bias.repeatability.value[i];
        double instability = triad->noise.bias_instability.value[i];
        double uncertainty = triad->bias.fixed.sigma[i];
        double square =
            repeatability * repeatability + instability * instability + uncertainty * uncertainty;
        worst = square > worst ? square : worst;
    }
    return worst > 0 ? sqrt(worst) : (double)NAN;
}

static imk_grade grade_of(double bias, bool gyro)
{
    for (int grade = 0; grade < (int)IMK_GRADE_NONE; grade++) {
        const imk_grade_row *row = &grade_rows[grade];
        double limit = gyro ? row->gyro_bias_limit : row->accel_bias_limit;
        /* "< 0.005 deg/h" and "< 30 ug" exclude the limit itself; the others are listed values. */
        bool within =
            grade == IMK_GRADE_STRATEGIC ? bias * rounding < limit : bias <= limit * rounding;
        if (within)
            return (imk_grade)grade;
    }
    return IMK_GRADE_NONE;
}

/* What is not stated of the biases would matter, if it were typical of the class. Below every class
 * nothing makes it worse. */
static bool is_at_best(const imk_model *model, int sensor, double bias, imk_grade grade)
{
    const double material = 0.05;
    double square = 0;
    imk_unstated unstated;
    if (!imk_model_triad(model, sensor)->present || (!isnan(bias) && grade == IMK_GRADE_NONE))
        return false;
    imk_model_unstated(model, &unstated);
    for (size_t i = 0; i < unstated.count; i++) {
        const imk_unstated_term *term = &unstated.term[i];
        if (term->sensor == sensor && (strcmp(term->key, "bias.repeatability") == 0 ||
                                       strcmp(term->key, "noise.bias_instability") == 0))
            square += term->typical * term->typical;
    }
    return isnan(bias) || square > material * (square + bias * bias);
}

imk_grade_result imk_grade_model(const imk_model *model)
{
    imk_grade_result result;
    result.gyro_bias = remaining_bias(&model->gyro);
    result.accel_bias = remaining_bias(&model->accel);
    result.gyro = grade_of(result.gyro_bias, true);
    result.accel = grade_of(result.accel_bias, false);
    bool has_gyro = !isnan(result.gyro_bias), has_accel = !isnan(result.accel_bias);
    /* Of two equal classes the gyro decides: its bias makes the error that grows. */
    bool gyro_decides = has_gyro && (!has_accel || result.gyro >= result.accel);
    result.overall = gyro_decides ? result.gyro : result.accel;
    result.limiting = gyro_decides ? "gyro bias" : has_accel ? "accelerometer bias" : "";
    result.gyro_at_best = is_at_best(model, IMK_GYRO, result.gyro_bias, result.gyro);
    result.accel_at_best = is_at_best(model, IMK_ACCEL, result.accel_bias, result.accel);
    const bool is_below = (has_gyro || has_accel) && result.overall == IMK_GRADE_NONE;
    result.at_best = !is_below && (result.gyro_at_best || result.accel_at_best);
    return result;
}

imk_grade imk_grade_of_position(double hour, double day)
{
    if (!isfinite(hour))
        return IMK_GRADE_NONE;
    if (!(hour <= grade_rows[IMK_GRADE_NAVIGATION].position_limit * rounding))
        return IMK_GRADE_TACTICAL;
    return day <= grade_rows[IMK_GRADE_STRATEGIC].position_limit * rounding ? IMK_GRADE_STRATEGIC
                                                                            : IMK_GRADE_NAVIGATION;
}
