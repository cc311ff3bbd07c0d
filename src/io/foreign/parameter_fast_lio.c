/* SPDX-License-Identifier: Apache-2.0 */
/* FAST-LIO: acc_cov, gyr_cov, b_acc_cov, b_gyr_cov under mapping:.
 *
 * predict() of esekfom.hpp of hku-mars/FAST_LIO adds (F_w dt) Q (F_w dt)^T at each step of the
 * IMU, with these four on the diagonal of Q (IMU_Processing.hpp, use-ikfom.hpp). So gyr_cov dt^2 is
 * what the variance of the angle grows by, N^2 dt: gyr_cov = N^2/dt is the variance of a reading;
 * and b_gyr_cov dt^2 = K^2 dt: b_gyr_cov = K^2/dt. Both depend on the rate. */
#include "parameter_internal.h"

#include <math.h>
#include <string.h>

static const char *const keys[IMKI_DENSITIES] = {"gyr_cov", "b_gyr_cov", "acc_cov", "b_acc_cov"};
/* Of the roots. */
static const char *const unit_names[IMKI_DENSITIES] = {"rad/s (root of cov)", "rad/s^2 (root)",
                                                       "m/s^2 (root of cov)", "m/s^3 (root)"};

static bool rate_is_known(imki_parameters *p)
{
    if (p->settings->rate > 0)
        return true;
    imki_parameter_refuse(p, IMK_ERROR_KEY_MISSING, "gyr_cov",
                          "\"gyr_cov\" and the others are per sample, and the rate is not known",
                          "add --rate RATE (samples per second, as 200Hz)");
    return false;
}

/* The mapping called so: FAST-LIO reads "mapping/acc_cov". */
static int find_mapping(imki_parameters *p)
{
    int found = IMKI_NONE;
    for (int node = imki_mapping_with(p->document, 0, IMKI_DENSITIES, keys); node != IMKI_NONE;
         node = imki_mapping_with(p->document, node + 1, IMKI_DENSITIES, keys)) {
        const int key = p->document->node[node].key;
        if (key == IMKI_NONE || strcmp(p->document->node[key].text, "mapping") != 0)
            continue;
        if (found != IMKI_NONE)
            imki_refuse_node(p, node, IMK_ERROR_KEY_DUPLICATE, "",
                             "one place with these keys: the file has them in several");
        found = node;
    }
    if (found == IMKI_NONE)
        imki_refuse_node(p, 0, IMK_ERROR_KEY_MISSING, "gyr_cov",
                         "a file with gyr_cov and acc_cov under mapping:");
    return found;
}

static void read_variance(imki_parameters *p, int mapping, int i)
{
    const int node = imki_node_value(p, mapping, keys[i]);
    double raw[3] = {0};
    imk_noise *noise = &p->triad[i / 2]->noise;
    if (node == IMKI_NONE) {
        imki_note(p, true,
                  "%s is not in the file: FAST-LIO then takes its default, the model has none",
                  keys[i]);
        return;
    }
    imki_node_numbers(p, node, 1, raw);
    imki_square_roots(p, imki_node_place(p, node), 1, raw);
    raw[1] = raw[2] = raw[0];
    imki_accept(p, imki_node_place(p, node), i / 2, i % 2 == 0 ? IMKI_WHITE : IMKI_RANDOM_WALK, raw,
                (imki_unit){unit_names[i], 1 / sqrt(p->settings->rate)},
                i % 2 == 0 ? noise->white.value : noise->random_walk.value);
}

void imki_fast_lio_read(imki_parameters *p)
{
    if (!rate_is_known(p) || !imki_parameters_document(p))
        return;
    const int mapping = find_mapping(p);
    if (p->status != IMK_OK)
        return;
    for (int i = 0; i < IMKI_DENSITIES; i++)
        read_variance(p, mapping, i);
    imki_note(p, false, "acc_cov, gyr_cov, b_acc_cov, b_gyr_cov are taken per sample at %g Hz",
              p->settings->rate);
    imki_note_others(p, mapping, IMKI_DENSITIES, keys);
}

void imki_fast_lio_write(imki_parameters *p)
{
    static const char *const comments[IMKI_DENSITIES] = {
        "[(rad/s)^2] N^2 rate", "[(rad/s^2)^2] K^2 rate", "[(m/s^2)^2] N^2 rate",
        "[(m/s^3)^2] K^2 rate"};
    if (!rate_is_known(p))
        return;
    imki_text_add(
        &p->out,
        "# FAST-LIO: variances per sample at %s Hz; at another rate they are others "
        "(gyr_cov is\n# the variance of a reading, b_gyr_cov dt^2 that of the step of the "
        "bias).\n# ROS 1: load this file with rosparam after the configuration of the "
        "LiDAR. ROS 2: put\n# mapping: under /**: ros__parameters:.\n",
        imki_shortest(p->settings->rate).text);
    imki_text_remarks(p, "# ");
    imki_text_add(&p->out, "mapping:\n");
    imki_densities_write(p, &(imki_density_lines){.keys = keys,
                                                  .units = comments,
                                                  .indent = "  ",
                                                  .scale = 1 / sqrt(p->settings->rate),
                                                  .squared = true,
                                                  .both_needed = true});
}
