/* SPDX-License-Identifier: Apache-2.0 */
/* What the verdict says of a sweep of temperature. */
#include "calibrate_message_internal.h"

#include "jobs/job_internal.h"

/* Temperatures in which no sensor works are in another unit: kelvins and degrees Celsius, where the
 * one is read as the other, are. Degrees Fahrenheit are not told. */
static void add_temperature_unit(imk_verdict *v, const imk_calibrate_record *log)
{
    const double zero = 273.15;
    const imk_thermal_findings *f = log->thermal;
    const int column = imk_log_find(&log->log, IMK_QUANTITY_TEMPERATURE, -1);
    const char *unit = column < 0 ? "" : log->log.column[column].unit.text, *likely = NULL;
    if (imki_is_of_sensors(f->minimum) && imki_is_of_sensors(f->maximum))
        return;
    if (imki_is_of_sensors(f->minimum - zero) && imki_is_of_sensors(f->maximum - zero))
        likely = "K";
    else if (imki_is_of_sensors(f->minimum + zero) && imki_is_of_sensors(f->maximum + zero))
        likely = "degC";
    imki_calibrate_add(
        v, imki_calibrate_say(
               IMK_FINDING_WARNING, "temperature_unit",
               "%.150s: the temperature goes from %.4g to %.4g degC, and no inertial sensor works "
               "below -100 or above 200 degC: %s%s%s",
               log->path, f->minimum - zero, f->maximum - zero,
               likely    ? "the column looks like "
               : unit[0] ? "check the unit in the header"
                         : "check --temperature-unit",
               likely ? likely : "",
               !likely   ? ""
               : unit[0] ? "; correct the unit in the header"
                         : "; correct --temperature-unit"));
}

void imki_thermal_verdict(const imk_calibrate_record *log, imk_verdict *v)
{
    const imk_thermal_findings *f = log->thermal;
    if (f)
        add_temperature_unit(v, log);
    for (int sensor = 0; f && sensor < 2; sensor++)
        for (int i = 0; i < f->axis_count[sensor]; i++) {
            const imk_thermal_axis *a = &f->axis[sensor][i];
            if (a->single_valued || !(a->gap_largest > 0))
                continue;
            const imk_unit unit =
                imk_unit_readable(imk_unit_of(imki_sensor_units[sensor]).dimension, a->gap_largest);
            imki_calibrate_add(
                v, imki_calibrate_say(
                       IMK_FINDING_WARNING, "hysteresis",
                       "%s: the readings of %s %c while warming and while cooling differ by up to "
                       "%.3g %s: no polynomial of the temperature can describe this difference; "
                       "the error after compensation is %.3g %s rms",
                       log->path, imki_sensor_titles[sensor], imk_axis_letter(i),
                       a->gap_largest / unit.scale, unit.text, a->rms_compensated / unit.scale,
                       unit.text));
        }
    if (f && !f->both_directions)
        imki_calibrate_add(
            v, imki_calibrate_say(
                   IMK_FINDING_NOTE, "one_direction",
                   "%s: the temperature changed in one direction only, which cannot show "
                   "hysteresis: sweep up and down",
                   log->path));
    if (f && f->accel_shared)
        imki_calibrate_add(
            v, imki_calibrate_say(
                   IMK_FINDING_NOTE, "one_pose",
                   "%s: one pose cannot separate the temperature effects on accelerometer bias and "
                   "scale factor: the coefficients hold for this pose only; sweep the temperature "
                   "in several poses to separate them",
                   log->path));
}
