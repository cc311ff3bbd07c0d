/* SPDX-License-Identifier: Apache-2.0 */
/* The track as a file, the summary as text and as JSON. */
#include "navigate_parts.h"

#include "shell/json_output.h"

#include <math.h>
#include <string.h>

static const double degree = 0.017453292519943295;

static const struct {
    const char *name, *unit;
    int decimals;
} columns[TRACK_COLUMNS] = {{"time", "s", 3},
                            {"latitude", "deg", 9},
                            {"longitude", "deg", 9},
                            {"height", "m", 4},
                            {"north", "m", 4},
                            {"east", "m", 4},
                            {"down", "m", 4},
                            {"velocity_north", "m/s", 6},
                            {"velocity_east", "m/s", 6},
                            {"velocity_down", "m/s", 6},
                            {"roll", "deg", 6},
                            {"pitch", "deg", 6},
                            {"yaw", "deg", 6},
                            {"acceleration_north", "m/s^2", 6},
                            {"acceleration_east", "m/s^2", 6},
                            {"acceleration_down", "m/s^2", 6},
                            {"sigma_north", "m", 4},
                            {"sigma_east", "m", 4},
                            {"sigma_down", "m", 4},
                            {"sigma_velocity_north", "m/s", 6},
                            {"sigma_velocity_east", "m/s", 6},
                            {"sigma_velocity_down", "m/s", 6},
                            {"sigma_attitude_north", "deg", 6},
                            {"sigma_attitude_east", "deg", 6},
                            {"sigma_attitude_down", "deg", 6}};

static bool is_written(const navigation *n, size_t column)
{
    if (column >= TRACK_SIGMA)
        return n->has_model;
    return column < TRACK_ACCELERATION || n->options->gravity_free;
}

int navigate_write_track(const navigation *n, const char *path)
{
    size_t count = 0;
    imk_log_column column[TRACK_COLUMNS];
    int decimals[TRACK_COLUMNS];
    const double *data[TRACK_COLUMNS];
    imk_log_writer *writer;
    imk_error error;
    memset(column, 0, sizeof column);
    for (size_t k = 0; k < TRACK_COLUMNS; k++) {
        if (!is_written(n, k))
            continue;
        snprintf(column[count].name, sizeof column[count].name, "%s", columns[k].name);
        column[count].unit = imk_unit_of(columns[k].unit);
        column[count].axis = -1;
        decimals[count] = columns[k].decimals;
        data[count++] = n->track[k];
    }
    if (imk_log_create(path, count, column, IMK_LOG_FIXED, decimals, n->track_rows, &writer,
                       &error) != IMK_OK)
        return command_error(&error, NULL);
    imk_log_write(writer, n->track_rows, data, NULL);
    if (imk_log_commit(writer, &error) != IMK_OK)
        return command_error(&error, NULL);
    return -1;
}

/* Value and, with a model, its 1 sigma. */
static void set_pair(const navigation *n, text_table *table, size_t column, double value,
                     double sigma)
{
    char text[60];
    format_value(value, n->has_model ? sigma : 0.0, 4, text, sizeof text);
    if (n->has_model && sigma >= 100.0 && sigma < 1e7) /* 490, not 4.9e+02 */
        text_table_set(table, column, "%s ± %.0f", text, sigma);
    else if (n->has_model)
        text_table_set(table, column, "%s ± %.2g", text, sigma);
    else
        text_table_set(table, column, "%s", text);
}

text_table navigate_table(const navigation *n)
{
    static const char *const axes[3] = {"north", "east", "down"};
    const size_t last = n->track_rows - 1;
    text_table table = text_table_make(3);
    text_table_row(&table);
    text_table_set(&table, 0, "at the end");
    text_table_set(&table, 1, "from the start [m]");
    text_table_set(&table, 2, "velocity [m/s]");
    table.right = 1U << 1 | 1U << 2;
    for (int i = 0; i < (n->options->vertical == 0 ? 2 : 3); i++) {
        text_table_row(&table);
        text_table_set(&table, 0, "%s", axes[i]);
        set_pair(n, &table, 1, n->track[TRACK_NORTH + i][last], n->track[TRACK_SIGMA + i][last]);
        set_pair(n, &table, 2, n->track[TRACK_VELOCITY + i][last],
                 n->track[TRACK_SIGMA + 3 + i][last]);
    }
    return table;
}

void navigate_drift_sentence(const navigation *n, char *text, size_t size)
{
    const size_t last = n->track_rows - 1;
    const double way = hypot(n->track[TRACK_NORTH][last], n->track[TRACK_NORTH + 1][last]);
    char elapsed[60], predicted[120] = "";
    format_duration(n->dt * (double)(n->rows - n->first), elapsed, sizeof elapsed);
    if (n->has_model)
        snprintf(predicted, sizeof predicted, "; the model predicts %.4g m rms",
                 sqrt(n->end.covariance[0][0] + n->end.covariance[1][1]));
    snprintf(text, size, "%s: after %s %.4g m from the start, at most %.4g m%s.%s",
             navigate_at_rest(n) ? "Horizontal error" : "Horizontally", elapsed, way, n->largest,
             predicted,
             navigate_at_rest(n) ? " The unit stood still all the time, so the distance from the "
                                   "start is the error."
                                 : "");
}

/* Three angles to 0.1 mdeg, none of them -0. */
static void print_angles(const char *label, double roll, double pitch, double yaw)
{
    const double angle[3] = {roll, pitch, yaw};
    double shown[3];
    for (int i = 0; i < 3; i++)
        shown[i] = floor(angle[i] / degree * 1e4 + 0.5) / 1e4 + 0.0;
    printf("%sroll %.4f, pitch %.4f, yaw %.4f deg", label, shown[0], shown[1], shown[2]);
}

static const char *const method_names[] = {"means", "inertial", "fine"};

/* Beyond this sigma a heading is as good as any other [rad]. */
static const double unknown_heading = 1.0;

static void print_attitude(const navigation *n)
{
    const navigate_options *o = n->options;
    if (!n->aligned) {
        print_angles("Attitude given: ", n->euler[0], n->euler[1], n->euler[2]);
        putchar('\n');
        return;
    }
    const bool coarse = o->method < 0 && n->method == IMK_ALIGNMENT_MEANS;
    printf("Aligned over %g s (%s%s): ", n->dt * (double)n->first, method_names[n->method],
           coarse ? ", as the gyros read more than the Earth's rotation" : "");
    print_angles("", n->euler[0], n->euler[1], n->euler[2]);
    puts(o->heading ? " (yaw given)" : "");
    printf("  1 sigma: tilt %.2g deg", hypot(n->attitude_sigma[0], n->attitude_sigma[1]) / degree);
    if (!(n->attitude_sigma[2] < unknown_heading))
        printf(", north not found");
    else if (n->attitude_sigma[2] > 0.0)
        printf(", heading %.2g deg", n->attitude_sigma[2] / degree);
    puts(n->has_model ? "" : " (scatter alone; --model counts the biases in)");
    printf("  force %.6f of normal gravity, rotation %.4f of the Earth's, sway %.2g m/s\n",
           n->alignment.gravity_ratio, n->alignment.earth_rate_ratio, n->alignment.disturbance);
}

static void print_end_attitude(const navigation *n)
{
    const size_t last = n->track_rows - 1;
    double *const *t = n->track;
    print_angles("\nAttitude: ", t[TRACK_ROLL][last], t[TRACK_PITCH][last], t[TRACK_YAW][last]);
    if (n->has_model)
        printf("; 1 sigma: tilt %.2g deg",
               hypot(t[TRACK_SIGMA + 6][last], t[TRACK_SIGMA + 7][last]) / degree);
    if (n->has_model && t[TRACK_SIGMA + 8][last] < unknown_heading)
        printf(", heading %.2g deg", t[TRACK_SIGMA + 8][last] / degree);
    putchar('\n');
}

void navigate_print(const navigation *n)
{
    char sentence[400];
    print_attitude(n);
    if (n->options->vertical == 0)
        printf("Height held at %.3f m\n", n->place.height);
    putchar('\n');
    text_table table = navigate_table(n);
    text_table_print(&table, stdout);
    text_table_free(&table);
    print_end_attitude(n);
    navigate_drift_sentence(n, sentence, sizeof sentence);
    printf("%s\n", sentence);
    const imk_zero_velocity_counts *c = &n->counts;
    if (c->accepted + c->refused > 0)
        printf("Zero-velocity updates: %llu, refused %llu; innovations squared %.2f of what the "
               "model says\n",
               (unsigned long long)c->accepted, (unsigned long long)c->refused,
               c->degrees > 0 ? c->chi_square / (double)c->degrees : 0.0);
    if (!n->has_model)
        printf("Next: add --model MODEL for the error that the sensors' model predicts "
               "(imukit identify, imukit devices)\n");
}

static json_t *json_three(const double value[3], const char *unit)
{
    json_t *list = json_array();
    for (int i = 0; i < 3; i++)
        json_array_append_new(list, json_number(value[i]));
    return json_pack("{s:o, s:s}", "value", list, "unit", unit);
}

static json_t *alignment_json(const navigation *n)
{
    json_t *object =
        json_pack("{s:o, s:o, s:o, s:o}", "roll", json_quantity(n->euler[0], "rad"), "pitch",
                  json_quantity(n->euler[1], "rad"), "yaw", json_quantity(n->euler[2], "rad"),
                  "attitude_sigma", json_three(n->attitude_sigma, "rad"));
    if (!n->aligned)
        return object;
    const imk_alignment_result *a = &n->alignment;
    json_object_set_new(object, "method", json_string(method_names[n->method]));
    json_object_set_new(object, "duration", json_quantity(n->dt * (double)n->first, "s"));
    json_object_set_new(object, "disturbance", json_quantity(a->disturbance, "m/s"));
    json_object_set_new(object, "gravity_ratio", json_number(a->gravity_ratio));
    json_object_set_new(object, "earth_rate_ratio", json_number(a->earth_rate_ratio));
    return object;
}

static json_t *end_json(const navigation *n)
{
    const size_t last = n->track_rows - 1;
    double value[TRACK_COLUMNS];
    for (int k = 0; k < TRACK_COLUMNS; k++)
        value[k] = n->track[k][last];
    json_t *object = json_pack(
        "{s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "time", json_quantity(value[TRACK_TIME], "s"),
        "latitude", json_quantity(value[TRACK_LATITUDE], "rad"), "longitude",
        json_quantity(value[TRACK_LONGITUDE], "rad"), "height",
        json_quantity(value[TRACK_HEIGHT], "m"), "from_start", json_three(&value[TRACK_NORTH], "m"),
        "velocity", json_three(&value[TRACK_VELOCITY], "m/s"), "attitude",
        json_three(&value[TRACK_ROLL], "rad"));
    if (n->has_model) {
        json_object_set_new(object, "position_sigma", json_three(&value[TRACK_SIGMA], "m"));
        json_object_set_new(object, "velocity_sigma", json_three(&value[TRACK_SIGMA + 3], "m/s"));
        json_object_set_new(object, "attitude_sigma", json_three(&value[TRACK_SIGMA + 6], "rad"));
    }
    return object;
}

int navigate_json(const navigation *n, int code)
{
    const size_t last = n->track_rows - 1;
    const imk_zero_velocity_counts *c = &n->counts;
    json_t *updates =
        json_pack("{s:I, s:I, s:o}", "accepted", (json_int_t)c->accepted, "refused",
                  (json_int_t)c->refused, "chi_square_per_degree",
                  c->degrees > 0 ? json_number(c->chi_square / (double)c->degrees) : json_null());
    json_t *result = json_pack(
        "{s:o, s:o, s:o, s:o, s:b, s:o, s:o, s:o}", "start", alignment_json(n), "end", end_json(n),
        "horizontal_distance",
        json_quantity(hypot(n->track[TRACK_NORTH][last], n->track[TRACK_NORTH + 1][last]), "m"),
        "largest_distance", json_quantity(n->largest, "m"), "at_rest", navigate_at_rest(n),
        "gyro_bias", json_three(n->end.gyro_bias.v, "rad/s"), "accel_bias",
        json_three(n->end.accel_bias.v, "m/s^2"), "updates", updates);
    json_t *inputs = json_pack(
        "{s:o, s:o, s:I, s:I, s:o, s:o, s:o, s:o, s:s}", "log", json_text(n->path), "model",
        n->has_model ? json_text(n->options->model) : json_null(), "rows", (json_int_t)n->rows,
        "bridged", (json_int_t)n->channels.bridged, "interval", json_quantity(n->dt, "s"),
        "latitude", json_quantity(n->place.latitude, "rad"), "longitude",
        json_quantity(n->place.longitude, "rad"), "height", json_quantity(n->place.height, "m"),
        "vertical", n->options->vertical == 0 ? "slaved" : "free");
    return json_print("navigate", inputs, result, code);
}
