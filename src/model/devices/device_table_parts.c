/* SPDX-License-Identifier: Apache-2.0 */
/* The catalogue, continued: parts by their data sheets. What was read of each, and what was left
 * out, is in docs/devices.md. A note says "typical" where what was read says so; repeatability is
 * the offset at zero that the data sheet states, scale factor its tolerance.
 *
 * Bosch, TDK, ST and Analog Devices state one-sided densities: their rms noise is the density times
 * the root of the bandwidth (BMI088, ICM-42688-P, MPU-6050, MPU-9250), or the random walk beside it
 * is the density divided by sqrt(2) (ISM330DHCX, ADIS16470). N is the density divided by sqrt(2),
 * with four digits. */
#include "device_table_internal.h"

const imki_device_entry imki_part_table[] = {
    {.device = {"BMI088", "consumer MEMS",
                "data sheet BST-BMI088-DS000-19 (rev. 1.9, 2024-01), tables 4 and 5",
                "Typical values. 0.014 deg/s/sqrt(Hz), one-sided: 0.1 deg/s rms at 47 Hz is stated "
                "with it; 160 ug/sqrt(Hz) on x and y, 190 on z, at 3 g. No bias instability is "
                "stated.",
                false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.594, .repeatability = 3600, .scale_factor = 10000},
     .accel = {.present = true, .white = 0.06657, .white_z = 0.07905, .repeatability = 20000}},
    {.device = {"BMI160", "consumer MEMS",
                "figures of the data sheet as four public projects copy "
                "them (data sheet not read)",
                "180 ug/sqrt(Hz). Two of the projects have 0.007 deg/s/sqrt(Hz), two 0.008: the "
                "larger is taken. Densities taken as one-sided, as in the BMI088 of the maker.",
                false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.3394},
     .accel = {.present = true, .white = 0.07489}},
    {.device =
         {"BMI270", "consumer MEMS", "docs.luxonis.com: BMI270, native silicon characteristics",
          "Typical values: 0.007 deg/s/sqrt(Hz) in performance mode and 160 ug/sqrt(Hz), taken "
          "as one-sided, as in the BMI088 of the maker.",
          false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.297},
     .accel = {.present = true, .white = 0.06657}},
    {.device = {"ICM-20948", "consumer MEMS",
                "data sheet DS-000189 rev. 1.3, pages 11 and 12, as two reports copy it",
                "0.015 deg/s/sqrt(Hz) and 230 ug/sqrt(Hz), taken as one-sided, as in "
                "the ICM-42688-P of the maker.",
                false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.6364, .repeatability = 18000, .scale_factor = 15000},
     .accel = {.present = true, .white = 0.09569, .repeatability = 50000}},
    {.device = {"ICM-42688-P", "consumer MEMS", "data sheet of the ICM-42688-P, tables 1 and 2",
                "Typical values. 0.0028 deg/s/sqrt(Hz) at 10 Hz, one-sided: 0.028 deg/s rms at 100 "
                "Hz is calculated from it; 65 ug/sqrt(Hz) on x and y, 70 on z. No bias instability "
                "is stated.",
                false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.1188, .repeatability = 1800, .scale_factor = 5000},
     .accel = {.present = true,
               .white = 0.02704,
               .white_z = 0.02912,
               .repeatability = 20000,
               .scale_factor = 5000}},
    {.device =
         {"MPU-6050", "consumer MEMS",
          "data sheet PS-MPU-6000A-00 rev. 3.4, sections 6.1 and 6.2, as several projects "
          "copy it",
          "Typical values. 0.005 deg/s/sqrt(Hz), one-sided: 0.05 deg/s rms at 100 Hz is stated "
          "with it; 400 ug/sqrt(Hz). Zero rate 20 deg/s; zero g 50 mg on x and y (z has more, "
          "and is not known here).",
          false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.2121, .repeatability = 72000},
     .accel = {.present = true, .white = 0.1664, .repeatability = 50000}},
    {.device = {"MPU-9250", "consumer MEMS",
                "figures of the data sheet as four public projects copy them (data sheet not read)",
                "0.01 deg/s/sqrt(Hz), one-sided: 0.1 deg/s rms is stated with it; "
                "300 ug/sqrt(Hz). Offsets at zero are left out: they were not read.",
                false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.4243},
     .accel = {.present = true, .white = 0.1248}},
    {.device = {"LSM6DSO", "consumer MEMS",
                "data sheet DS12140 rev. 3, table 2, as FlySight's sensornoise.cpp and its notes "
                "copy it",
                "High-performance mode: 3.8 mdps/sqrt(Hz); 70 ug/sqrt(Hz) at 2 "
                "g (75, 80 and 110 at 4, 8 and 16 g); taken as one-sided, as in the ISM330DHCX of "
                "the maker.",
                false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.1612, .repeatability = 3600, .scale_factor = 10000},
     .accel = {.present = true, .white = 0.02912, .repeatability = 20000, .scale_factor = 10000}},
    {.device = {"ISM330DHCX", "industrial MEMS",
                "data sheet DS13012 rev. 6, table 2, as notes of a laboratory course copy it",
                "Typical values. N is the angle random walk of 0.21 deg/sqrt(h), with which 5 "
                "mdps/sqrt(Hz) agrees when read as one-sided; 60 ug/sqrt(Hz). The floor of 3 deg/h "
                "is divided by 0.664. Offsets at zero 1 deg/s and 10 mg (limits 3 deg/s, 65 mg).",
                false},
     .method = "datasheet",
     .gyro = {.present = true,
              .white = 0.21,
              .instability = 3,
              .repeatability = 3600,
              .is_floor = true},
     .accel = {.present = true, .white = 0.02496, .repeatability = 10000}},
    {.device = {"ADIS16470", "industrial MEMS",
                "data sheet of the ADIS16470 rev. C, table 1, as three public projects copy it",
                "N is the angle random walk of 0.34 deg/sqrt(h), with which 0.008 deg/s/sqrt(Hz) "
                "agrees when read as one-sided; 100 ug/sqrt(Hz). Floors divided by 0.664.",
                false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.34, .instability = 8, .range = 2000, .is_floor = true},
     .accel =
         {.present = true, .white = 0.04161, .instability = 13, .range = 40, .is_floor = true}},
    {.device =
         {"ADIS16495", "tactical MEMS",
          "data sheet of the ADIS16495 as a collection of robot parts copies it",
          "Typical values; of which version (125, 450 or 2000 deg/s) the copy does not say. "
          "Floor divided by 0.664. The accelerometers are left out: their noise was not read.",
          false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.09, .instability = 0.8, .is_floor = true},
     .accel = {.present = false}},
    {.device = {"HG4930", "tactical MEMS",
                "figures of the HG4930CA51 as three public projects copy the maker's manual",
                "Floors divided by 0.664; 7 deg/h of gyro bias repeatability. That of the "
                "accelerometers is left out: the projects differ.",
                false},
     .method = "datasheet",
     .gyro = {.present = true,
              .white = 0.04,
              .instability = 0.25,
              .repeatability = 7,
              .range = 200,
              .is_floor = true},
     .accel = {.present = true, .white = 0.03, .instability = 25, .range = 20, .is_floor = true}},
    {.device = {"Xsens MTi-3", "industrial MEMS",
                "data sheet MT0605P rev. AE as a public simulator copies it",
                "0.007 deg/s/sqrt(Hz) and 120 ug/sqrt(Hz), as of the MTi-1, and taken as two-sided "
                "as there; N is smaller by sqrt(2) if the maker's are one-sided. Its instabilities "
                "(2 deg/h, 15 ug) contradict those of the MTi-1 and are left out.",
                false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.42},
     .accel = {.present = true, .white = 0.07061}},
    {.device = {"SBG Ellipse2", "industrial MEMS",
                "navi.ion.org/highwire/markup/10540: table of sensors, Ellipse2",
                "The maker's figures as a paper states them; bias stabilities of 7 deg/h and 14 ug "
                "taken as floors and divided by 0.664.",
                false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.15, .instability = 7, .is_floor = true},
     .accel = {.present = true, .white = 0.033, .instability = 14, .is_floor = true}},
};
const size_t imki_part_table_count = sizeof imki_part_table / sizeof imki_part_table[0];
