/* SPDX-License-Identifier: Apache-2.0 */
/* From the states of the linear theory to the nine errors that are stated. */
#include "drift_covariance_internal.h"

#include "imukit/navigate.h"

#include <string.h>

/* Rows and columns of the result from those of x: position, velocity, attitude. */
static const int place[3] = {6, 3, 0};

/* On the sphere both radii are its own. */
void imki_drift_level(imki_drift_earth earth, imk_attitude_errors stated, imki_drift_node *node)
{
    node->level = (imk_matrix3){{{0.0}}};
    if (stated == IMK_ATTITUDE_EARTH)
        return;
    node->level = imk_level_turn(node->state.place);
    if (earth.radius > 0.0) {
        const double east = node->level.m[0][1];
        node->level.m[0][1] = 1.0 / earth.radius;
        node->level.m[1][0] = -1.0 / earth.radius;
        node->level.m[2][1] *= 1.0 / (earth.radius * east);
    }
}

/* North-east-down components; displayed attitude: phi = psi - level dr. What a slaved vertical
 * makes zero is so to the bit. */
void imki_drift_result_axes(const imki_drift_node *node, imki_matrix9 *t)
{
    memset(t, 0, sizeof *t);
    for (int block = 0; block < 3; block++)
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 9; j++)
                for (int k = 0; k < 3; k++)
                    t->m[3 * block + i][j] +=
                        node->axes.m[k][i] * node->full.m[place[block] + k][j];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 9; j++)
            for (int k = 0; k < 2; k++)
                t->m[6 + i][j] -= node->level.m[i][k] * t->m[k][j];
    if (!node->slaved)
        return;
    for (int j = 0; j < 9; j++) {
        t->m[2][j] = 0.0;
        t->m[5][j] = j >= place[0] ? -node->climb[j - place[0]] : 0.0;
    }
}
