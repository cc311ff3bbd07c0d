/* SPDX-License-Identifier: Apache-2.0 */
/* gnss-ins-sim: the dictionary `accuracy` of its IMU class (imu_model.py of Aceinna/gnss-ins-sim),
 * as JSON or YAML.
 *
 * gyro_b [deg/h], gyro_arw [deg/sqrt(h)], gyro_b_stability [deg/h], gyro_b_corr [s]; accel_b
 * [m/s^2], accel_vrw [m/s/sqrt(h)], accel_b_stability [m/s^2], accel_b_corr [s]. A stability with
 * its correlation time is a Gauss-Markov process, as documented; what the program then simulates is
 * smaller, see docs/other-formats.md. Without a time, or with an infinite one, the program draws
 * the drift anew for each sample (pathgen.py), which is white noise. */
#include "model/model_schema_internal.h"
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

static imk_status read_triad(imki_parameters *p, const imk_document *document, int kind,
                             imk_triad *triad)
{
    double si[4][3] = {{0}};
    imki_place place = {"", 0, 0};
    for (int i = 0; i < 4; i++) {
        const struct key *key = &keys[kind][i];
        int node = imki_document_value(document, 0, key->name);
        if (node == IMKI_NONE && key->required)
            return imki_document_error(document, 0, IMK_ERROR_KEY_MISSING, key->name,
                                       "the keys gyro_b, gyro_arw, gyro_b_stability, accel_b, "
                                       "accel_vrw, accel_b_stability",
                                       p->error);
        imk_status status =
            imki_node_accept(p, document, 0, key->name, kind, key->quantity, key->unit, si[i]);
        if (status != IMK_OK)
            return status;
        if (node != IMKI_NONE)
            place = imki_node_place(document, node);
        else
            si[i][0] = si[i][1] = si[i][2] = INFINITY;
    }
    imki_to_axes(si[0], &triad->bias.fixed);
    imki_to_axes(si[1], &triad->noise.white);
    place.field = keys[kind][3].name;
    imk_status status =
        imki_white_where_infinite(p, place, triad, p->settings->rate, "gnss-ins-sim", si[2], si[3]);
    if (status != IMK_OK)
        return status;
    imki_add_gauss_markov(triad, si[2], si[3]);
    if (triad->noise.gauss_markov_count > 0)
        imki_note(p, false,
                  "%s is taken as sigma of a Gauss-Markov process, as documented; gnss-ins-sim "
                  "itself simulates sigma*sqrt(corr/(2 rate)), starting at 0",
                  keys[kind][2].name);
    return IMK_OK;
}

imk_status imki_gnss_ins_sim_read(imki_parameters *p)
{
    imk_document *document = NULL;
    const char *known[8];
    imk_status status = imki_parameters_document(p, &document);
    if (status != IMK_OK)
        return status;
    for (int i = 0; i < 8; i++)
        known[i] = keys[i / 4][i % 4].name;
    status = read_triad(p, document, IMK_GYRO, &p->model->gyro);
    if (status == IMK_OK)
        status = read_triad(p, document, IMK_ACCEL, &p->model->accel);
    for (int key = document->node[0].first; key != IMKI_NONE && status == IMK_OK;) {
        const char *name = document->node[key].text;
        bool is_known = false;
        for (int i = 0; i < 8; i++)
            is_known = is_known || strcmp(name, known[i]) == 0;
        if (strncmp(name, "mag_", 4) == 0)
            imki_note(p, true, "%.60s: a model has no magnetometer", name);
        else if (!is_known)
            status = imki_foreign_key(p, document, key, 8, known);
        key = document->node[document->node[key].next].next;
    }
    imk_document_free(document);
    return status;
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

imk_status imki_gnss_ins_sim_write(imki_parameters *p)
{
    imki_text_add(&p->out, p->is_json ? "{\n"
                                      : "# gnss-ins-sim: the dictionary accuracy of its class IMU; "
                                        "make numpy arrays of the lists\n");
    for (int kind = 0; kind < 2; kind++) {
        const imk_triad *triad = imk_model_triad(p->source, kind);
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
    return IMK_OK;
}
