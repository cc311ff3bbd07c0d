/* SPDX-License-Identifier: Apache-2.0 */
/* AirSim: the IMU of settings.json.
 *
 * ImuSimpleParams.hpp of microsoft/AirSim: AngularRandomWalk [deg/sqrt(h)], VelocityRandomWalk
 * [mg/sqrt(Hz)], GyroBiasStability [deg/h], AccelBiasStability [ug], …Tau [s]; a key that is not
 * there has a default. ImuSimple.hpp draws white noise of AngularRandomWalk/sqrt(dt) per sample,
 * and lets the bias walk by (stability/sqrt(tau)) sqrt(dt): N, and K = stability/sqrt(tau). The
 * time is no correlation time: the walk grows without end. */
#include "parameter_internal.h"

#include <math.h>
#include <string.h>

enum { WHITE, STABILITY, TAU };

/* Unit and default of AirSim for each key of each sensor. */
static const struct key {
    const char *name;
    imki_unit unit;
    double missing;
} keys[2][3] = {{{"AngularRandomWalk", {"deg/sqrt(h)", 2.908882086657216e-04}, 0.3}, /* pi/180/60 */
                 {"GyroBiasStability", {"deg/h", 4.84813681109536e-06}, 4.6}, /* pi/180/3600 */
                 {"GyroBiasStabilityTau", {"s", 1}, 500}},
                {{"VelocityRandomWalk", {"mg/sqrt(Hz)", 9.80665e-3}, 0.24},
                 {"AccelBiasStability", {"ug", 9.80665e-6}, 36},
                 {"AccelBiasStabilityTau", {"s", 1}, 800}}};
static const char *const names[] = {
    "AngularRandomWalk",  "GyroBiasStability",     "GyroBiasStabilityTau", "VelocityRandomWalk",
    "AccelBiasStability", "AccelBiasStabilityTau", "SensorType",           "Enabled"};
enum { NAMES = sizeof names / sizeof names[0], OWN_NAMES = 6 };

static imki_place read_number(imki_parameters *p, int imu, const struct key *key, double raw[3])
{
    const int node = imki_node_value(p, imu, key->name);
    raw[0] = raw[1] = raw[2] = key->missing;
    if (node == IMKI_NONE)
        imki_note(p, false, "%s is not in the file: AirSim's default of %g %s is taken", key->name,
                  key->missing, key->unit.name);
    else
        imki_node_numbers(p, node, 3, raw);
    return node == IMKI_NONE ? (imki_place){key->name, 0, 0} : imki_node_place(p, node);
}

static void read_sensor(imki_parameters *p, int imu, int kind)
{
    imk_noise *noise = &p->triad[kind]->noise;
    double raw[3], tau[3], time[3] = {1, 1, 1};
    imki_place place = read_number(p, imu, &keys[kind][WHITE], raw);
    imki_accept(p, place, kind, IMKI_WHITE, raw, keys[kind][WHITE].unit, noise->white.value);
    place = read_number(p, imu, &keys[kind][TAU], tau);
    imki_accept(p, place, kind, IMKI_PLAIN, tau, keys[kind][TAU].unit, time);
    if (!(time[0] >= 1e-9 && time[0] <= 1e12))
        imki_parameter_refuse_at(p, place, IMK_ERROR_RANGE, "", "a time from 1e-9 s to 1e12 s");
    if (p->status != IMK_OK)
        return;
    place = read_number(p, imu, &keys[kind][STABILITY], raw);
    imki_unit unit = keys[kind][STABILITY].unit;
    unit.scale /= sqrt(time[0]);
    imki_accept(p, place, kind, IMKI_RANDOM_WALK, raw, unit, noise->random_walk.value);
}

void imki_airsim_read(imki_parameters *p)
{
    imki_choice choice = {.found = 0};
    if (!imki_parameters_document(p))
        return;
    for (int node = imki_mapping_with(p->document, 0, OWN_NAMES, names); node != IMKI_NONE;
         node = imki_mapping_with(p->document, node + 1, OWN_NAMES, names)) {
        const int key = p->document->node[node].key;
        imki_choice_add(p, &choice, key == IMKI_NONE ? "" : p->document->node[key].text, node);
    }
    if (choice.count == 0)
        imki_refuse_node(p, 0, IMK_ERROR_KEY_MISSING, names[0],
                         "a file with AngularRandomWalk or another key of an IMU");
    imki_choice_end(p, choice.found, choice.names, "NAME", "the file has several IMUs");
    for (int kind = 0; kind < 2 && p->status == IMK_OK; kind++)
        read_sensor(p, choice.chosen, kind);
    if (p->status == IMK_OK)
        imki_foreign_keys(p, choice.chosen, NAMES, names);
}

static void write_sensor(imki_parameters *p, int kind)
{
    const double given = p->settings->bias_instability_tau;
    const double tau = given > 0 ? given : keys[kind][TAU].missing;
    if (!p->origin[kind]->present) {
        imki_note(p, true, "the model has no %s: AirSim simulates its own default for them",
                  kind == IMK_GYRO ? "gyros" : "accelerometers");
        return;
    }
    const double white = imki_density(p, 2 * kind, keys[kind][WHITE].name);
    const double walk = imki_density(p, 2 * kind + 1, keys[kind][STABILITY].name);
    imki_text_add(&p->out, ",\n      \"%s\": %s", keys[kind][WHITE].name,
                  imki_shortest(white / keys[kind][WHITE].unit.scale).text);
    imki_text_add(&p->out, ",\n      \"%s\": %s", keys[kind][STABILITY].name,
                  imki_shortest(walk * sqrt(tau) / keys[kind][STABILITY].unit.scale).text);
    imki_text_add(&p->out, ",\n      \"%s\": %s", keys[kind][TAU].name, imki_shortest(tau).text);
}

/* A list of default sensors replaces AirSim's, so all four of a multirotor are in it
 * (AirSimSettings.hpp). */
void imki_airsim_write(imki_parameters *p)
{
    imki_text_add(&p->out, "{\n  \"SettingsVersion\": 1.2,\n  \"DefaultSensors\": {\n"
                           "    \"Barometer\": {\"SensorType\": 1, \"Enabled\": true},\n"
                           "    \"Gps\": {\"SensorType\": 3, \"Enabled\": true},\n"
                           "    \"Magnetometer\": {\"SensorType\": 4, \"Enabled\": true},\n"
                           "    \"Imu\": {\n      \"SensorType\": 2,\n      \"Enabled\": true");
    for (int kind = 0; kind < 2; kind++)
        write_sensor(p, kind);
    imki_text_add(&p->out, "\n    }\n  }\n}\n");
    imki_note(p, false,
              "the file has the other default sensors of a multirotor, because AirSim's list is "
              "replaced as a whole; in your own settings.json only the block Imu is new");
}
