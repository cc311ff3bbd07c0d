/* SPDX-License-Identifier: Apache-2.0 */
/* gnss-ins-sim: the dictionary `accuracy` of its IMU class (imu_model.py of Aceinna/gnss-ins-sim),
 * as JSON or YAML.
 *
 * gyro_b [deg/h], gyro_arw [deg/sqrt(h)], gyro_b_stability [deg/h], gyro_b_corr [s]; accel_b
 * [m/s^2], accel_vrw [m/s/sqrt(h)], accel_b_stability [m/s^2], accel_b_corr [s]. A stability with
 * its correlation time is a Gauss-Markov process, as documented; what the program then simulates is
 * smaller, see docs/other-formats.md. Without a time, or with an infinite one, the program draws
 * the drift anew for each sample (pathgen.py), which is white noise. */
#include "parameter_internal.h"

#include <math.h>
#include <string.h>

static const struct key {
    const char *name;
    imki_quantity quantity;
    bool required;
    imki_unit unit;
} keys[2][4] = {
    {{"gyro_b", IMKI_BIAS, true, {"deg/h", 4.84813681109536e-06}},           /* pi/180/3600 */
     {"gyro_arw", IMKI_WHITE, true, {"deg/sqrt(h)", 2.908882086657216e-04}}, /* pi/180/60 */
     {"gyro_b_stability", IMKI_DRIFT, true, {"deg/h", 4.84813681109536e-06}},
     {"gyro_b_corr", IMKI_TIME, false, {"s", 1}}},
    {{"accel_b", IMKI_BIAS, true, {"m/s^2", 1}},
     {"accel_vrw", IMKI_WHITE, true, {"m/s/sqrt(h)", 1.0 / 60}},
     {"accel_b_stability", IMKI_DRIFT, true, {"m/s^2", 1}},
     {"accel_b_corr", IMKI_TIME, false, {"s", 1}}}};

static void read_triad(imki_parameters *p, int kind)
{
    imk_triad *triad = p->triad[kind];
    double si[4][3] = {{0}};
    imki_place place = {"", 0, 0};
    for (int i = 0; i < 4; i++) {
        const struct key *key = &keys[kind][i];
        const int node = imki_node_value(p, 0, key->name);
        if (node == IMKI_NONE && key->required)
            imki_refuse_node(p, 0, IMK_ERROR_KEY_MISSING, key->name,
                             "a file with the keys gyro_b, gyro_arw, gyro_b_stability, accel_b, "
                             "accel_vrw, accel_b_stability");
        imki_node_accept(p, 0, key->name, kind, key->quantity, key->unit, si[i]);
        if (node != IMKI_NONE)
            place = imki_node_place(p, node);
        else
            si[i][0] = si[i][1] = si[i][2] = INFINITY;
    }
    memcpy(triad->bias.fixed.value, si[0], sizeof si[0]);
    memcpy(triad->noise.white.value, si[1], sizeof si[1]);
    place.field = keys[kind][3].name;
    imki_white_where_infinite(p, place, triad, p->settings->rate, "gnss-ins-sim", si[2], si[3]);
    imki_add_gauss_markov(triad, si[2], si[3]);
    if (triad->noise.gauss_markov_count > 0)
        imki_note(p, false,
                  "%s is taken as sigma of a Gauss-Markov process, as documented; gnss-ins-sim "
                  "itself simulates sigma*sqrt(corr/(2 rate)), starting at 0",
                  keys[kind][2].name);
}

void imki_gnss_ins_sim_read(imki_parameters *p)
{
    const char *known[8];
    if (!imki_parameters_document(p))
        return;
    for (int i = 0; i < 8; i++)
        known[i] = keys[i / 4][i % 4].name;
    for (int kind = 0; kind < 2; kind++)
        read_triad(p, kind);
    for (int key = p->document->node[0].first; key != IMKI_NONE; key = imki_key_after(p, key)) {
        const char *name = p->document->node[key].text;
        if (strncmp(name, "mag_", 4) == 0)
            imki_note(p, true, "%.60s: a model has no magnetometer", name);
        else if (!imki_is_one_of(name, 8, known))
            imki_foreign_key(p, key, 8, known);
    }
}

static void write_line(imki_parameters *p, const struct key *key, const double si[3], bool is_last)
{
    double values[3];
    for (int i = 0; i < 3; i++)
        values[i] = si[i] / key->unit.scale;
    imki_text_add(&p->out, p->is_json ? "  \"%s\": " : "%s: ", key->name);
    imki_text_vector(&p->out, values);
    if (p->is_json)
        imki_text_add(&p->out, "%s\n", is_last ? "" : ",");
    else
        imki_text_add(&p->out, "  # [%s]\n", key->unit.name);
}

void imki_gnss_ins_sim_write(imki_parameters *p)
{
    imki_text_add(&p->out, p->is_json ? "{\n"
                                      : "# gnss-ins-sim: the dictionary accuracy of its class IMU; "
                                        "make numpy arrays of the lists\n");
    for (int kind = 0; kind < 2; kind++) {
        const imk_triad *triad = p->origin[kind];
        imk_triad none = {.present = false};
        if (!triad->present)
            triad = &none;
        double sigma[3], time[3];
        imki_first_gauss_markov(triad, sigma, time);
        for (int i = 0; i < 3; i++)
            /* Where there is no process any finite time will do; 100 s is the program's own. */
            time[i] = sigma[i] == 0 ? 100 : time[i];
        write_line(p, &keys[kind][0], triad->bias.fixed.value, false);
        write_line(p, &keys[kind][1], triad->noise.white.value, false);
        write_line(p, &keys[kind][2], sigma, false);
        write_line(p, &keys[kind][3], time, kind == IMK_ACCEL);
    }
    if (p->is_json)
        imki_text_add(&p->out, "}\n");
}
