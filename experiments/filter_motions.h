/* SPDX-License-Identifier: Apache-2.0 */
/* Three motions on which filters are tuned: a hand that walks, a car, a quadrotor that vibrates. */
#ifndef IMUKIT_EXPERIMENTS_FILTER_MOTIONS_H
#define IMUKIT_EXPERIMENTS_FILTER_MOTIONS_H

#include <string.h>

enum { FILTER_MOTIONS = 3 };

static const struct filter_motion {
    const char *name, *text;
} filter_motions[FILTER_MOTIONS] = {
    /* Steps at 1.9 Hz (vertical 2 m/s^2, forward 1.2 m/s^2, sideways at half the rate); the hand
     * sways and turns about all axes. */
    {"walking hand", "imukit_motion: 1\n"
                     "name: walking hand\n"
                     "steps:\n"
                     "  - hold 2 s\n"
                     "  - accelerate to 1.4 m/s at 1 m/s^2\n"
                     "  - repeat:\n"
                     "      times: 3\n"
                     "      steps:\n"
                     "        - hold 5 s\n"
                     "        - turn right 90 deg at 60 deg/s\n"
                     "        - swing y 20 deg at 0.9 Hz for 4 s\n"
                     "        - turn left 150 deg at 90 deg/s\n"
                     "        - swing x 15 deg at 1.2 Hz for 3 s\n"
                     "vibration:\n"
                     "  - sine z 2 m/s^2 at 1.9 Hz\n"
                     "  - sine x 1.2 m/s^2 at 1.9 Hz phase 90 deg\n"
                     "  - sine y 0.8 m/s^2 at 0.95 Hz\n"
                     "  - sine pitch 5 deg at 1.9 Hz\n"
                     "  - sine roll 3 deg at 0.95 Hz phase 30 deg\n"
                     "  - sine yaw 4 deg at 0.95 Hz phase 75 deg\n"},
    {"car", "imukit_motion: 1\n"
            "name: car\n"
            "steps:\n"
            "  - hold 3 s\n"
            "  - accelerate to 10 m/s at 2 m/s^2\n"
            "  - hold 5 s\n"
            "  - turn right 90 deg at 20 deg/s\n"
            "  - accelerate to 20 m/s at 1.5 m/s^2\n"
            "  - climb 4 deg at 1 deg/s\n"
            "  - turn left 60 deg at 12 deg/s\n"
            "  - level at 1 deg/s\n"
            "  - brake to 6 m/s at 3 m/s^2\n"
            "  - turn right 200 deg at 30 deg/s\n"
            "  - accelerate to 14 m/s at 2 m/s^2\n"
            "  - hold 4 s\n"
            "  - stop at 3 m/s^2\n"
            "  - hold 3 s\n"
            "vibration:\n"
            "  - random z 0.0002 g^2/Hz from 4 Hz to 40 Hz\n"
            "  - sine pitch 0.3 deg at 1.4 Hz\n"
            "  - sine roll 0.4 deg at 1.1 Hz\n"},
    {"quadrotor", "imukit_motion: 1\n"
                  "name: quadrotor\n"
                  "start: {height: 100 m, speed: 3 m/s}\n"
                  "smoothing: 0.6 s\n"
                  "steps:\n"
                  "  - hold 2 s\n"
                  "  - repeat:\n"
                  "      times: 2\n"
                  "      steps:\n"
                  "        - accelerate to 9 m/s at 4 m/s^2\n"
                  "        - turn left 180 deg at 60 deg/s banked\n"
                  "        - climb to 25 deg at 40 deg/s\n"
                  "        - hold 3 s\n"
                  "        - level at 40 deg/s\n"
                  "        - turn right 120 deg at 50 deg/s banked\n"
                  "        - swing x 12 deg at 1 Hz for 3 s\n"
                  "        - swing y 10 deg at 1.5 Hz for 2 s\n"
                  "        - brake to 3 m/s at 4 m/s^2\n"
                  "        - hold 2 s\n"
                  "vibration:\n"
                  "  - sine z 6 m/s^2 at 83 Hz\n"
                  "  - sine x 3 m/s^2 at 83 Hz phase 90 deg\n"
                  "  - sine y 3 m/s^2 at 166 Hz\n"
                  "  - sine roll 0.03 deg at 83 Hz\n"
                  "  - sine pitch 0.03 deg at 83 Hz phase 90 deg\n"
                  "  - random: {axis: z, density: [20 Hz 0.0005 g^2/Hz, 200 Hz 0.0005 g^2/Hz], "
                  "lines: 16}\n"}};

#endif
