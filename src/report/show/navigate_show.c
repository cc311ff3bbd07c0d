/* SPDX-License-Identifier: Apache-2.0 */
/* The result of a navigation: the attitude at the start, the track, its end. */
#include "navigate_aids_show_internal.h"

#include <math.h>
#include <stdio.h>

static const double degree = 0.017453292519943295;
/* Beyond this sigma a heading is as good as any other [rad]. */
static const double unknown_heading = 1.0;
static const char *const method_names[] = {"means", "inertial", "fine"};

static bool is_aligned(const imk_navigate_log *n)
{
    return n->settings.align > 0;
}

/* A column of the track in its last row. */
static double at_end(const imk_navigate_log *n, size_t column)
{
    return n->track[column][n->track_rows - 1];
}

static double distance(const imk_navigate_log *n)
{
    return hypot(at_end(n, IMK_TRACK_NORTH), at_end(n, IMK_TRACK_NORTH + 1));
}

/* ---- data ---- */

static void show_three(const char *key, const double value[3], const char *unit, imk_result *result)
{
    imk_result_object(result, key);
    imk_result_numbers(result, "value", 3, value);
    imk_result_text(result, "unit", unit);
    imk_result_end(result);
}

static void show_inputs(const imk_navigate_log *n, const char *name, imk_result *result)
{
    imk_result_object(result, "inputs");
    imk_result_text(result, "log", name);
    imk_result_text(result, "model", n->settings.model ? n->settings.model_name : NULL);
    imk_result_count(result, "rows", (long long)n->record.rows);
    imk_result_count(result, "bridged", (long long)n->record.bridged);
    imk_result_quantity(result, "interval", n->record.dt, "s");
    imk_result_quantity(result, "latitude", n->settings.place.latitude, "rad");
    imk_result_quantity(result, "longitude", n->settings.place.longitude, "rad");
    imk_result_quantity(result, "height", n->settings.place.height, "m");
    imk_result_flag(result, "smoothed", n->settings.smooth);
    imk_result_text(result, "vertical", n->settings.hold_height ? "slaved" : "free");
    imk_result_end(result);
}

static void show_start(const imk_navigate_log *n, imk_result *result)
{
    static const char *const angles[3] = {"roll", "pitch", "yaw"};
    imk_result_object(result, "start");
    for (int i = 0; i < 3; i++)
        imk_result_quantity(result, angles[i], n->attitude[i], "rad");
    show_three("attitude_sigma", n->attitude_sigma, "rad", result);
    if (!is_aligned(n)) {
        show_three("velocity", n->settings.velocity, "m/s", result);
        imk_result_flag(result, "velocity_given", n->settings.velocity_given);
    }
    if (is_aligned(n)) {
        imk_result_text(result, "method", method_names[n->method]);
        imk_result_flag(result, "north_found", !n->coarse);
        imk_result_quantity(result, "duration", n->record.dt * (double)n->first, "s");
        imk_result_quantity(result, "disturbance", n->alignment.disturbance, "m/s");
        imk_result_number(result, "gravity_ratio", n->alignment.gravity_ratio);
        imk_result_number(result, "earth_rate_ratio", n->alignment.earth_rate_ratio);
    }
    imk_result_end(result);
}

static void show_end_three(const imk_navigate_log *n, const char *key, int column, const char *unit,
                           imk_result *result)
{
    const double value[3] = {at_end(n, column), at_end(n, column + 1), at_end(n, column + 2)};
    show_three(key, value, unit, result);
}

static void show_last(const imk_navigate_log *n, imk_result *result)
{
    imk_result_object(result, "end");
    imk_result_quantity(result, "time", at_end(n, IMK_TRACK_TIME), "s");
    imk_result_quantity(result, "latitude", at_end(n, IMK_TRACK_LATITUDE), "rad");
    imk_result_quantity(result, "longitude", at_end(n, IMK_TRACK_LONGITUDE), "rad");
    imk_result_quantity(result, "height", at_end(n, IMK_TRACK_HEIGHT), "m");
    show_end_three(n, "from_start", IMK_TRACK_NORTH, "m", result);
    show_end_three(n, "velocity", IMK_TRACK_VELOCITY, "m/s", result);
    show_end_three(n, "attitude", IMK_TRACK_ROLL, "rad", result);
    if (n->settings.model) {
        show_end_three(n, "position_sigma", IMK_TRACK_SIGMA, "m", result);
        show_end_three(n, "velocity_sigma", IMK_TRACK_SIGMA + 3, "m/s", result);
        show_end_three(n, "attitude_sigma", IMK_TRACK_SIGMA + 6, "rad", result);
    }
    imk_result_end(result);
}

static void show_data(const imk_navigate_log *n, const char *name, imk_result *result)
{
    const imk_navigation_filter_counts *c = &n->counts;
    show_inputs(n, name, result);
    imk_result_object(result, "result");
    imki_judge_navigation(n, result);
    show_start(n, result);
    show_last(n, result);
    imk_result_quantity(result, "horizontal_distance", distance(n), "m");
    imk_result_quantity(result, "largest_distance", n->largest, "m");
    imk_result_flag(result, "at_rest", n->at_rest);
    show_three("gyro_bias", n->end.gyro_bias.v, "rad/s", result);
    show_three("accel_bias", n->end.accel_bias.v, "m/s^2", result);
    imk_result_object(result, "updates");
    imk_result_count(result, "accepted", (long long)c->accepted);
    imk_result_count(result, "refused", (long long)c->refused);
    imk_result_number(result, "chi_square_per_degree",
                      c->degrees > 0 ? c->chi_square / (double)c->degrees : (double)NAN);
    imk_result_end(result);
    imki_show_aids_data(n, result);
    imk_result_end(result);
}

/* ---- messages ---- */

/* Three angles to 0.1 mdeg, none of them -0. */
static const char *angles_text(const double angle[3], char text[120])
{
    double shown[3];
    for (int i = 0; i < 3; i++)
        shown[i] = floor(angle[i] / degree * 1e4 + 0.5) / 1e4 + 0.0;
    snprintf(text, 120, "roll %.4f, pitch %.4f, yaw %.4f deg", shown[0], shown[1], shown[2]);
    return text;
}

static void show_attitude(const imk_navigate_log *n, imk_result *result)
{
    const double tilt = hypot(n->attitude_sigma[0], n->attitude_sigma[1]) / degree,
                 heading = n->attitude_sigma[2] / degree;
    char text[120], north[60] = "";
    if (!is_aligned(n)) {
        const double *v = n->settings.velocity;
        imk_result_line(
            result, "Attitude given: %s\nVelocity %s: north %.4g, east %.4g, down %.4g m/s",
            angles_text(n->attitude, text),
            n->settings.velocity_given ? "given" : "assumed (--velocity)", v[0], v[1], v[2]);
        return;
    }
    if (!(n->attitude_sigma[2] < unknown_heading))
        snprintf(north, sizeof north, ", north not found");
    else if (heading > 0.0)
        snprintf(north, sizeof north, ", heading %.2g deg", heading);
    imk_result_line(
        result,
        "Aligned over %g s (%s%s): %s%s\n"
        "  1 sigma: tilt %.2g deg%s%s\n"
        "  force %.6f of normal gravity, rotation %.4f of the Earth's, sway %.2g m/s",
        n->record.dt * (double)n->first, method_names[n->method],
        !n->settings.method_given && n->method == IMK_ALIGNMENT_MEANS
            ? n->settings.model ? ", because the gyro biases hide the Earth's rotation"
                                : ", because the gyros read more than the Earth's rotation"
            : "",
        angles_text(n->attitude, text), n->settings.heading_given ? " (yaw given)" : "", tilt,
        north, n->settings.model ? "" : " (from the scatter alone; --model includes the biases)",
        n->alignment.gravity_ratio, n->alignment.earth_rate_ratio, n->alignment.disturbance);
}

static void show_drift(const imk_navigate_log *n, int level, imk_result *result)
{
    char text[400], elapsed[60], predicted[120] = "";
    imk_readable_duration(n->record.dt * (double)(n->record.rows - n->first), elapsed,
                          sizeof elapsed);
    if (n->settings.model)
        snprintf(predicted, sizeof predicted, "; the model predicts %.4g m rms",
                 sqrt(n->end.covariance[0][0] + n->end.covariance[1][1]));
    snprintf(text, sizeof text, "%s: after %s %.4g m from the start, at most %.4g m%s.%s",
             n->at_rest ? "Horizontal error" : "Horizontally", elapsed, distance(n), n->largest,
             predicted,
             n->at_rest ? " The unit stood still all the time, so the distance from the "
                          "start is the error."
                        : "");
    imk_result_finding(result, level, text);
}

/* ---- the end ---- */

/* Value and, with a model, its 1 sigma. */
static void add_pair(const imk_navigate_log *n, int column, int sigma_column, imk_table *table)
{
    const double sigma = at_end(n, sigma_column);
    char text[60];
    imk_readable_value(at_end(n, column), n->settings.model ? sigma : 0.0, 4, text, sizeof text);
    if (n->settings.model && sigma >= 100.0 && sigma < 1e7) /* 490, not 4.9e+02 */
        imk_table_add(table, "%s ± %.0f", text, sigma);
    else if (n->settings.model)
        imk_table_add(table, "%s ± %.2g", text, sigma);
    else
        imk_table_add(table, "%s", text);
}

static void show_end_table(const imk_navigate_log *n, imk_result *result)
{
    static const char *const axes[3] = {"north", "east", "down"};
    imk_table *table = imk_result_table(result, 1U << 1 | 1U << 2);
    imk_table_row(table, "at the end\tfrom the start [m]\tvelocity [m/s]");
    for (int i = 0; i < (n->settings.hold_height ? 2 : 3); i++) {
        imk_table_row(table, "%s", axes[i]);
        add_pair(n, IMK_TRACK_NORTH + i, IMK_TRACK_SIGMA + i, table);
        add_pair(n, IMK_TRACK_VELOCITY + i, IMK_TRACK_SIGMA + 3 + i, table);
    }
}

static void show_end_attitude(const imk_navigate_log *n, imk_result *result)
{
    const double angle[3] = {at_end(n, IMK_TRACK_ROLL), at_end(n, IMK_TRACK_PITCH),
                             at_end(n, IMK_TRACK_YAW)};
    const double heading = at_end(n, IMK_TRACK_SIGMA + 8);
    char text[120], sigma[60] = "", north[60] = "";
    if (n->settings.model)
        snprintf(sigma, sizeof sigma, "; 1 sigma: tilt %.2g deg",
                 hypot(at_end(n, IMK_TRACK_SIGMA + 6), at_end(n, IMK_TRACK_SIGMA + 7)) / degree);
    if (n->settings.model && heading < unknown_heading)
        snprintf(north, sizeof north, ", heading %.2g deg", heading / degree);
    imk_result_line(result, "\nAttitude: %s%s%s", angles_text(angle, text), sigma, north);
}

/* ---- figure ---- */

enum { POINTS_MAX = 4000, NORTH_COLOR = 0, EAST_COLOR = 1, SIGMA_COLOR = 7 };

static const struct line {
    int panel;
    const char *label;
    imk_curve_style style;
    int color, x, y;
    double factor;
} lines[] = {
    {0, "", IMK_CURVE_LINE, NORTH_COLOR, IMK_TRACK_NORTH + 1, IMK_TRACK_NORTH, 1},
    {1, "1 sigma predicted", IMK_CURVE_DASHES, SIGMA_COLOR, IMK_TRACK_TIME, IMK_TRACK_SIGMA, 1},
    {1, "", IMK_CURVE_DASHES, SIGMA_COLOR, IMK_TRACK_TIME, IMK_TRACK_SIGMA, -1},
    {1, "north", IMK_CURVE_LINE, NORTH_COLOR, IMK_TRACK_TIME, IMK_TRACK_NORTH, 1},
    {2, "1 sigma predicted", IMK_CURVE_DASHES, SIGMA_COLOR, IMK_TRACK_TIME, IMK_TRACK_SIGMA + 1, 1},
    {2, "", IMK_CURVE_DASHES, SIGMA_COLOR, IMK_TRACK_TIME, IMK_TRACK_SIGMA + 1, -1},
    {2, "east", IMK_CURVE_LINE, EAST_COLOR, IMK_TRACK_TIME, IMK_TRACK_NORTH + 1, 1},
    {3, "north", IMK_CURVE_LINE, NORTH_COLOR, IMK_TRACK_TIME, IMK_TRACK_VELOCITY, 1},
    {3, "east", IMK_CURVE_LINE, EAST_COLOR, IMK_TRACK_TIME, IMK_TRACK_VELOCITY + 1, 1},
};

/* A line of the track, thinned: the last point is its last row. Lines of sigma are drawn about the
 * start if the unit stood still, otherwise about the track. */
static void add_line(const imk_navigate_log *n, const struct line *l, imk_figure_builder *figure)
{
    const size_t every = n->track_rows / POINTS_MAX + 1;
    const size_t points = (n->track_rows + every - 1) / every;
    const bool about_track = l->y >= IMK_TRACK_SIGMA && !n->at_rest;
    imki_begin_curve(figure, l->label, l->style, l->color);
    for (size_t k = 0; k < points; k++) {
        const size_t row = k + 1 == points ? n->track_rows - 1 : k * every;
        const double middle =
            about_track ? n->track[IMK_TRACK_NORTH + l->y - IMK_TRACK_SIGMA][row] : 0.0;
        imk_figure_point(figure, n->track[l->x][row], middle + l->factor * n->track[l->y][row]);
    }
}

static void show_track(const imk_navigate_log *n, const char *name, imk_result *result)
{
    static const char *const panels[][3] = {{"horizontal track", "east [m]", "north [m]"},
                                            {"north", "time [s]", "from the start [m]"},
                                            {"east", "time [s]", "from the start [m]"},
                                            {"velocity", "time [s]", "velocity [m/s]"}};
    imk_figure_builder *figure = imk_result_figure(
        result, name, 2,
        !n->settings.model ? "Horizontal track, and position and velocity against time."
        : n->aid_count > 0
            ? "Grey: 1 sigma of the error that the model predicts, about the track. Innovations "
              "are "
              "divided by their 1 sigma: if model and sigmas are right, one of 20 is beyond 2."
        : n->at_rest
            ? "Grey: 1 sigma of the error that the model predicts, about the start, where the unit "
              "stood."
            : "Grey: 1 sigma of the error that the model predicts, about the track.");
    for (size_t k = 0; k < sizeof lines / sizeof lines[0]; k++) {
        const char *const *panel = panels[lines[k].panel];
        if (k == 0 || lines[k].panel != lines[k - 1].panel)
            imk_figure_panel(figure, &(imk_panel){.title = panel[0],
                                                  .x_label = panel[1],
                                                  .y_label = panel[2],
                                                  .key = IMK_KEY_BELOW});
        if (lines[k].y < IMK_TRACK_SIGMA || n->settings.model)
            add_line(n, &lines[k], figure);
    }
    imki_show_aids_panels(n, figure);
}

/* ---- all ---- */

static void show_page(const imk_navigate_log *n, const char *name, imk_result *result)
{
    char length[60];
    const unsigned long long accepted = n->counts.accepted, refused = n->counts.refused;
    imk_readable_duration(n->record.dt * (double)n->record.rows, length, sizeof length);
    imk_result_title(result, "Navigation of a log", "%.120s: %zu samples, %g Hz, %s", name,
                     n->record.rows, 1.0 / n->record.dt, length);
    show_drift(n, imki_warned(&n->findings) ? 1 : 0, result);
    if (accepted + refused > 0)
        imk_result_line(result, "Zero-velocity updates: %llu, refused %llu.", accepted, refused);
    imki_show_warnings(&n->findings, result);
    imk_result_heading(result, "Track");
    show_track(n, name, result);
    imk_result_heading(result, "Attitude at the start");
    imk_result_line(
        result,
        "%s: roll %.4f, pitch %.4f, yaw %.4f deg; 1 sigma %.2g deg of tilt, %.2g deg of "
        "heading.",
        !is_aligned(n)              ? "Given"
        : n->settings.heading_given ? "Tilt found by the unit itself, at rest; heading given"
                                    : "Found by the unit itself, at rest",
        n->attitude[0] / degree, n->attitude[1] / degree, n->attitude[2] / degree,
        hypot(n->attitude_sigma[0], n->attitude_sigma[1]) / degree, n->attitude_sigma[2] / degree);
    if (n->aid_count > 0)
        imk_result_heading(result, "Aids");
    imki_show_aids_table(n, result);
    imk_result_heading(result, "At the end");
}

static void show_rest(const imk_navigate_log *n, imk_result *result)
{
    const imk_navigation_filter_counts *c = &n->counts;
    show_end_attitude(n, result);
    show_drift(n, 0, result);
    imki_show_aids_table(n, result);
    if (c->accepted + c->refused > 0)
        imk_result_line(result,
                        "Zero-velocity updates: %llu, refused %llu; innovations squared %.2f times "
                        "what the model predicts",
                        (unsigned long long)c->accepted, (unsigned long long)c->refused,
                        c->degrees > 0 ? c->chi_square / (double)c->degrees : 0.0);
}

void imk_show_navigate_log(const imk_navigate_log *n, const char *name, imk_result *result)
{
    show_data(n, name, result);
    imk_result_for(result, IMK_FOR_PAGE);
    show_page(n, name, result);
    imk_result_for(result, IMK_FOR_TERMINAL);
    show_attitude(n, result);
    if (n->settings.hold_height)
        imk_result_line(result, "Height held at %.3f m", n->settings.place.height);
    imk_result_gap(result);
    imk_result_for(result, IMK_FOR_BOTH);
    show_end_table(n, result);
    imk_result_for(result, IMK_FOR_TERMINAL);
    show_rest(n, result);
}
