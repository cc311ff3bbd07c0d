/* SPDX-License-Identifier: Apache-2.0 */
/* What the gyros of a unit that stands can tell: whether there is a north to find, the biases, and
 * how much the unit sways. */
#include "imukit/samples.h"
#include "imukit/standing_start.h"
#include "navigate_log_internal.h"

#include <math.h>

static const double degree = 0.017453292519943295, hour = 3600.0;

/* A heading known to less is not one that small angles describe: 11 deg. Gravity's turn in inertial
 * axes is lost then, and the tilt with it, while the mean force asks no gyro. */
static const double coarse_heading = 0.2;

/* The mean rate along the vertical found, downwards, and across it. */
static void parts_of_rate(const imk_navigate_log *n, double *down, double *across)
{
    const imk_vector3 rate = imki_navigate_mean(n, 0, 0, n->first);
    imk_matrix3 c_nb;
    imk_navigation_state_to_ned(&n->alignment.state, NULL, NULL, &c_nb);
    const imk_vector3 turned = imk_matrix3_apply(c_nb, rate);
    *down = turned.v[2];
    *across = hypot(turned.v[0], turned.v[1]);
}

/* The angle to which errors about the vertical are known now. */
static void set_heading_sigma(imk_navigate_log *n, double sigma)
{
    for (int i = 0; i < 3; i++)
        n->alignment.covariance[2][i] = n->alignment.covariance[i][2] = 0.0;
    n->alignment.covariance[2][2] = sigma * sigma;
}

void imki_navigate_find_north(imk_navigate_log *n)
{
    const double earth = IMK_EARTH_RATE * cos(n->settings.place.latitude);
    const double sigma = sqrt(fmax(0.0, n->alignment.covariance[2][2]));
    double down, across;
    parts_of_rate(n, &down, &across);
    if (n->settings.model) {
        n->coarse = !(sigma <= coarse_heading);
        if (n->coarse && n->method == IMK_ALIGNMENT_MEANS)
            set_heading_sigma(n, imk_heading_spread(across, earth, sigma * earth));
    } else {
        /* Nothing but the reading says how large the biases are. */
        n->coarse = hypot(down, across) > 1.5 * IMK_EARTH_RATE;
        if (n->method == IMK_ALIGNMENT_MEANS)
            imki_navigate_doubt_heading(n);
    }
    if (n->coarse && !n->settings.heading_given)
        imki_find(&n->findings, IMK_FINDING_WARNING, "north_unknown", NULL,
                  IMKI_NUMBERS(n->settings.model != NULL));
}

/* Without a model: what the reading has along the vertical and in its size across it that the Earth
 * has not, d1 and d2, are two of three components of the bias, and the third, across to the north,
 * is the heading's. If its sigma is any, with the density 1/sigma beforehand, it is Student's of
 * two degrees of freedom times sqrt((d1^2 + d2^2)/2), of which 68 % are within 1.32. */
void imki_navigate_doubt_heading(imk_navigate_log *n)
{
    const double limit = 1.8137993642342178; /* pi/sqrt(3): any heading */
    const double latitude = n->settings.place.latitude, within = 1.32;
    double down, across;
    if (n->settings.model)
        return;
    parts_of_rate(n, &down, &across);
    if (n->method != IMK_ALIGNMENT_MEANS) /* in axes that do not sway with the unit */
        across = n->alignment.earth_rate_ratio * IMK_EARTH_RATE * cos(latitude);
    const double d1 = down + IMK_EARTH_RATE * sin(latitude);
    const double d2 = across - IMK_EARTH_RATE * cos(latitude);
    const double bias = within * hypot(d1, d2) / sqrt(2.0) / (IMK_EARTH_RATE * cos(latitude));
    const double noise = sqrt(fmax(0.0, n->alignment.covariance[2][2]));
    const double sigma = hypot(noise, bias);
    set_heading_sigma(n, sigma < limit ? sigma : limit);
}

/* The difference of its angles at the ends, each as
 * far from the mean as the direction of the force is in seconds, over the time. */
double imki_navigate_sway(const imk_navigate_log *n, size_t rows)
{
    const size_t second = n->record.dt < 1.0 ? imk_samples_in(1.0, n->record.dt) : 1;
    const size_t seconds = rows / second;
    imk_vector3 all = {{0.0, 0.0, 0.0}};
    double squares = 0.0;
    for (int pass = 0; pass < 2; pass++)
        for (size_t k = 0; k < seconds; k++) {
            const imk_vector3 force = imki_navigate_mean(n, 1, k * second, second);
            if (pass == 0) {
                all = imk_vector3_add(all, imk_vector3_scale(force, 1.0 / (double)seconds));
                continue;
            }
            const imk_vector3 across = imk_vector3_cross(all, force);
            squares += imk_vector3_dot(across, across);
        }
    const double size = imk_vector3_dot(all, all), time = n->record.dt * (double)rows;
    return seconds > 0 && size > 0.0 ? sqrt(squares / (double)seconds) / size / time : 0.0;
}

bool imki_navigate_north(const imk_navigate_log *n)
{
    return !n->settings.heading_given &&
           !(n->coarse && n->settings.model && n->method == IMK_ALIGNMENT_MEANS);
}

void imki_navigate_start_biases(imk_navigate_log *n, imk_navigation_filter *filter)
{
    if (!imki_navigate_aligns(n) || !n->settings.model)
        return;
    const imk_standing_start stood = {
        .rate = imki_navigate_mean(n, 0, 0, n->first),
        .time = n->record.dt * (double)n->first,
        .rotation_sigma = hypot(n->settings.still_rotation, imki_navigate_sway(n, n->first)),
        .heading_found = imki_navigate_north(n)};
    imk_navigation_filter_estimate estimate;
    if (imk_navigation_filter_stood(filter, &stood))
        return;
    imk_navigation_filter_get(filter, &estimate);
    imki_find(&n->findings, IMK_FINDING_WARNING, "bias_beyond_model", n->settings.model_name,
              IMKI_NUMBERS(imk_vector3_norm(estimate.gyro_bias) / degree * hour));
}

/* Where the biases hide the Earth's rotation, the heading and they are one thing: what is known of
 * them is in the heading's sigma already. */
void imki_navigate_free_biases(const imk_navigate_log *n, imk_navigation_filter_settings *s)
{
    const double unknown = 100.0 * IMK_EARTH_RATE;
    if (!n->settings.model || imki_navigate_north(n) || n->settings.heading_given)
        return;
    for (int i = 0; i < 3 && s->gyro.part_count > 0; i++)
        s->gyro.part[0].sigma[i] = hypot(s->gyro.part[0].sigma[i], unknown);
}
