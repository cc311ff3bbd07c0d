/* SPDX-License-Identifier: Apache-2.0 */
/* The catalogue: figures of real devices with the source of each. Only facts are taken from the
 * sources. Where a source contradicts itself, the note says which figure is taken and why, or that
 * it is left out; sensors of which no figure can be taken are left out of the model altogether, so
 * that none is simulated without errors.
 *
 * Densities per root hertz are taken as N itself (two-sided), as the sources of this file use them:
 * should one be a data sheet's one-sided density, N is smaller by sqrt(2). The MPU-6000 is as in
 * device_table_parts.c. */
#include "device_table_internal.h"

/* Biases [ug], [deg/h]; scale factors (diagonal) with cross couplings [ppm]; g-sensitivity
 * [deg/h/g]; rows. */
static const double consumer_accel_bias[3] = {9000, -13000, 8000};
static const double consumer_gyro_bias[3] = {-180, 260, -160};
static const double consumer_accel_matrix[9] = {50000, -15000, 10000, -7500, -60000,
                                                12500, -12500, 5000,  20000};
static const double consumer_gyro_matrix[9] = {40000, -14000, 12500, 0,     -30000,
                                               -7500, 0,      0,     -17500};
static const double consumer_gyro_g_matrix[9] = {90, -110, -60, -50, 190, -160, 30, 110, -130};
static const double tactical_accel_bias[3] = {900, -1300, 800};
static const double tactical_gyro_bias[3] = {-9, 13, -8};
static const double tactical_accel_matrix[9] = {500, -300, 200, -150, -600, 250, -250, 100, 450};
static const double tactical_gyro_matrix[9] = {400, -300, 250, 0, -300, -150, 0, 0, -350};
static const double tactical_gyro_g_matrix[9] = {.9, -1.1, -.6, -.5, 1.9, -1.6, .3, 1.1, -1.3};
static const double aviation_accel_bias[3] = {30, -45, 26};
static const double aviation_gyro_bias[3] = {-0.0009, 0.0013, -0.0008};
static const double aviation_accel_matrix[9] = {100, -120, 80, -60, -120, 100, -100, -40, 90};
static const double aviation_gyro_matrix[9] = {8, -120, 100, 0, -6, -60, 0, 0, -7};

const imki_device_entry imki_device_table[] = {
    {.device =
         {"ADIS16405", "industrial MEMS",
          "rodralez/NaveGo: examples/synthetic-data/navego_example_synth.m",
          "Bias instability (0.007 deg/s, 0.2 mg) and turn-on figures (3 deg/s, 50 mg) of the data "
          "sheet; the floors are divided by 0.664. N is its angle random walk of 2 deg/sqrt(h), "
          "with which its density of 0.05 deg/s/sqrt(Hz) agrees when read as one-sided (6 %).",
          false},
     .method = "datasheet",
     .gyro = {.present = true,
              .white = 2,
              .instability = 25.2,
              .repeatability = 10800,
              .is_floor = true},
     .accel = {.present = true,
               .white = 0.2,
               .instability = 200,
               .repeatability = 50000,
               .is_floor = true}},
    {.device = {"ADIS16488", "industrial MEMS",
                "rodralez/NaveGo: examples/synthetic-data/navego_example_synth.m",
                "Turn-on 0.2 deg/s and 16 mg; the data sheet's floors are divided by 0.664.",
                false},
     .method = "datasheet",
     .gyro = {.present = true,
              .white = 0.3,
              .instability = 6.5,
              .repeatability = 720,
              .is_floor = true},
     .accel = {.present = true,
               .white = 0.029,
               .instability = 100,
               .repeatability = 16000,
               .is_floor = true}},
    {.device =
         {"ADIS16405 measured", "industrial MEMS", "SMAC-Group/imudata: data/adis_16405_imu1.rda",
          "A record of 2.78 h, means of the axes. Gyro: from the Allan deviation; B is the minimum "
          "/ 0.664 (27.2, 45.6, 43.9 deg/h, x still falling at 1111 s). Accelerometer: an "
          "oscillation at 0.564 Hz spoils the Allan deviation at 1 s (slope -0.35; read as white "
          "noise it gives 0.3635 m/s/sqrt(h)), so the white noise is that of a fit to the spectrum "
          "with the oscillation set apart. Steps of the output 0.05 deg/s and 3.33 mg.",
          false},
     .method = "measured",
     .gyro = {.present = true, .white = 2.452, .instability = 38.91, .resolution = 0.05},
     .accel = {.present = true, .white = 0.2469, .instability = 372, .resolution = 3.33}},
    {.device = {"ADIS16448 EuRoC", "industrial MEMS",
                "rpng/open_vins: config/euroc_mav/kalibr_imu_chain.yaml",
                "Settings of an estimator, 1.6968e-4 rad/s/sqrt(Hz) and 2e-3 m/s^2/sqrt(Hz), "
                "two-sided as it uses them. The random walk of the accelerometer bias (3e-3 "
                "m/s^3/sqrt(Hz)) was tuned for a filter and is left out.",
                false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.5833, .random_walk = 240},
     .accel = {.present = true, .white = 0.12}},
    {.device =
         {"ADIS16448 RotorS", "industrial MEMS",
          "ethz-asl/rotors_simulator: rotors_description/urdf/component_snippets.xacro",
          "Settings of a simulator, twice those of the EuRoC file for the same device; stated as "
          "two-sided. Turn-on 0.0087 rad/s and 0.196 m/s^2. Its bias forgets with time constants "
          "of 1000 s (gyro) and 300 s: not included, so K holds for shorter times only.",
          false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 1.167, .random_walk = 480, .repeatability = 1794.503814},
     .accel = {.present = true, .white = 0.24, .repeatability = 19986.43777}},
    {.device =
         {"ICM20602", "consumer MEMS", "i2Nav-WHU/awesome-gins-datasets: README.md",
          "B from an Allan deviation; the white noises are reference values tuned for a filter. "
          "That filter's Gauss-Markov biases (200 deg/h, 1000 mGal, 1 h) are not included.",
          false},
     .method = "measured",
     .gyro = {.present = true, .white = 0.2, .instability = 10},
     .accel = {.present = true, .white = 0.2}},
    {.device = {"ADIS16460", "industrial MEMS", "i2Nav-WHU/awesome-gins-datasets: README.md",
                "B from an Allan deviation; white noises tuned for a filter. Gauss-Markov biases "
                "of the filter (20 deg/h, 100 mGal) are not included.",
                false},
     .method = "measured",
     .gyro = {.present = true, .white = 0.2, .instability = 8},
     .accel = {.present = true, .white = 0.1}},
    {.device = {"ADIS16465", "industrial MEMS", "i2Nav-WHU/awesome-gins-datasets: README.md",
                "B from an Allan deviation; white noises tuned for a filter. Gauss-Markov biases "
                "of the filter (25 deg/h, 200 mGal) are not included.",
                false},
     .method = "measured",
     .gyro = {.present = true, .white = 0.1, .instability = 2},
     .accel = {.present = true, .white = 0.1}},
    {.device = {"HGuide i300", "industrial MEMS", "i2Nav-WHU/awesome-gins-datasets: README.md",
                "B from an Allan deviation; white noises tuned for a filter. Gauss-Markov biases "
                "of the filter (15 deg/h, 150 mGal) are not included.",
                false},
     .method = "measured",
     .gyro = {.present = true, .white = 0.2, .instability = 3},
     .accel = {.present = true, .white = 0.2}},
    {.device = {"Leador-A15", "navigation", "i2Nav-WHU/KF-GINS: dataset/kf-gins.yaml",
                "0.027 deg/h and 15 mGal are the standard deviations of a filter's slow biases "
                "(correlation time 4 h), not Allan figures: given here as repeatability.",
                false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.003, .repeatability = 0.027},
     .accel = {.present = true, .white = 0.03, .repeatability = 15.3}},
    {.device = {"AHRS380SA", "industrial MEMS",
                "Aceinna/gnss-ins-sim: gnss_ins_sim/sim/imu_model.py",
                "The low-accuracy setting of a simulator; floors (accelerometer 2e-4 m/s^2) "
                "divided by 0.664; there they are Gauss-Markov processes of 100 s.",
                false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.75, .instability = 10, .is_floor = true},
     .accel = {.present = true, .white = 0.05, .instability = 20.39, .is_floor = true}},
    {.device = {"IMU381", "industrial MEMS", "Aceinna/gnss-ins-sim: gnss_ins_sim/sim/imu_model.py",
                "The mid-accuracy setting of a simulator, partly from the IMU381; floors "
                "(accelerometer 5e-5 m/s^2) divided by 0.664.",
                false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.25, .instability = 3.5, .is_floor = true},
     .accel = {.present = true, .white = 0.03, .instability = 5.099, .is_floor = true}},
    {.device =
         {"HG9900-like", "navigation", "Aceinna/gnss-ins-sim: gnss_ins_sim/sim/imu_model.py",
          "The high-accuracy setting of a simulator, partly from the HG9900. Left out: the gyro "
          "instability of 0.1 deg/h, 28 times the maker's 0.0035, and a velocity random walk "
          "(2.5e-5 m/s/sqrt(h)) far below any instrument of the class. Floor divided by 0.664.",
          false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.002},
     .accel = {.present = true, .instability = 0.3671, .is_floor = true}},
    {.device = {"HG1700", "tactical RLG", "navtk: navtk/filtering/containers/ImuModel.cpp",
                "1 deg/h and 1 mg are bias repeatability; no instability is stated. 0.065 "
                "ft/s/sqrt(h) of velocity random walk.",
                false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.125, .repeatability = 1},
     .accel = {.present = true, .white = 0.01981, .repeatability = 1000}},
    {.device =
         {"HG9900", "navigation RLG", "navtk: navtk/filtering/containers/ImuModel.cpp",
          "The source says bias only: taken as repeatability. No velocity random walk is listed.",
          false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.002, .repeatability = 0.0035},
     .accel = {.present = true, .repeatability = 25}},
    {.device = {"Sagem Primus 200", "tactical", "navtk: navtk/filtering/containers/ImuModel.cpp",
                "The source says bias only: taken as repeatability. Its velocity random walk is "
                "left out: comment and code differ by a factor of ten.",
                false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.004, .repeatability = 0.05},
     .accel = {.present = true, .repeatability = 2000}},
    {.device = {"STIM300", "tactical MEMS", "navtk: navtk/filtering/containers/ImuModel.cpp",
                "Version for 10 g, specification ts1524r9; floors divided by 0.664.", false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.15, .instability = 0.5, .is_floor = true},
     .accel = {.present = true, .white = 0.06, .instability = 50, .range = 10, .is_floor = true}},
    {.device = {"STIM300 measured", "tactical MEMS", "rwth-irt/IMU-Simulator: config/stim300.yaml",
                "Means of the axes, B as given. The angle random walk found (0.73 deg/sqrt(h)) is "
                "five times the data sheet's and is left out.",
                false},
     .method = "measured",
     .gyro = {.present = true, .instability = 0.1877, .random_walk = 2.182, .range = 400},
     .accel = {.present = true, .white = 0.08684, .instability = 27.55, .range = 5}},
    {.device =
         {"MPU-6000", "consumer MEMS",
          "data sheet PS-MPU-6000A-00 rev. 3.4, sections 6.1 and 6.2, as several projects copy it; "
          "microsoft/AirSim: AirLib/include/sensors/imu/ImuSimpleParams.hpp",
          "Noise and offsets of the data sheet, as of the MPU-6050: 0.005 deg/s/sqrt(Hz) and 400 "
          "ug/sqrt(Hz), one-sided; 20 deg/s, 50 mg. Instabilities of a thesis quoted in the second "
          "source, without their correlation times (500 s, 800 s). Its 0.3 deg/sqrt(h) reads the "
          "density as two-sided; its 0.24 mg/sqrt(Hz) is not that of the data sheet.",
          false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.2121, .instability = 4.6, .repeatability = 72000},
     .accel = {.present = true, .white = 0.1664, .instability = 36, .repeatability = 50000}},
    {.device = {"OpenRTK330", "industrial MEMS", "Aceinna/docs_openrtk: 300ZA/imu-sensors.rst",
                "Upper limits of the maker, ranges lower limits; floors divided by 0.664.", false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.3, .instability = 6, .range = 400, .is_floor = true},
     .accel = {.present = true, .white = 0.05, .instability = 20, .range = 8, .is_floor = true}},
    {.device = {"MicroStrain MV5-AR", "industrial MEMS",
                "leggedrobotics/graph_msf: doc/imu_parameters.md",
                "0.0075 deg/s/sqrt(Hz) and 85 ug/sqrt(Hz), converted here: the page's own "
                "conversion of the latter is 2 % off. Densities taken as two-sided, as used there; "
                "N is smaller by sqrt(2) if the maker's are one-sided.",
                false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.45},
     .accel = {.present = true, .white = 0.05001}},
    {.device = {"Xsens MTi-G-700", "industrial MEMS",
                "rpng/kalibr_allan: matlab/SCRIPT_noise_conversion.m",
                "0.01 deg/s/sqrt(Hz) and 60 ug/sqrt(Hz). Densities taken as two-sided, as used "
                "there; N is smaller by sqrt(2) if the maker's are one-sided.",
                false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.6},
     .accel = {.present = true, .white = 0.0353}},
    {.device = {"CH Robotics UM7", "consumer MEMS",
                "nickcharron/kalibr_allan: matlab/SCRIPT_noise_conversion.m",
                "0.005 deg/s/sqrt(Hz) and 400 ug/sqrt(Hz); seen in an excerpt of the source. "
                "Densities taken as two-sided, as used there; N is smaller by sqrt(2) if the "
                "maker's are one-sided.",
                false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.3},
     .accel = {.present = true, .white = 0.2354}},
    {.device = {"Xsens MTi-100", "industrial MEMS",
                "rpng/open_vins: config/kaist/kalibr_imu_chain.yaml",
                "0.01 deg/s/sqrt(Hz), taken as two-sided, as used there. Left out: the "
                "accelerometer (its noise is ten times the maker's 60 ug/sqrt(Hz), and nothing "
                "else is stated), and a rate random walk that the file itself calls a guess.",
                false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.6},
     .accel = {.present = false}},
    {.device = {"RealSense T265", "consumer MEMS",
                "rpng/open_vins: config/rs_t265/kalibr_imu_chain.yaml",
                "BMI055, to general knowledge. Record of about 20 h; the file's safety factors of "
                "5 (white) and 10 (random walk) are taken out.",
                false},
     .method = "measured",
     .gyro = {.present = true, .white = 0.3724, .random_walk = 14.46},
     .accel = {.present = true, .white = 0.08785}},
    {.device = {"RealSense D455", "consumer MEMS",
                "rpng/open_vins: config/rs_d455/kalibr_imu_chain.yaml",
                "BMI055, to general knowledge. The values before the file's safety factors.",
                false},
     .method = "measured",
     .gyro = {.present = true, .white = 0.3531, .random_walk = 13.74},
     .accel = {.present = true, .white = 0.06229}},
    {.device = {"RealSense D435i", "consumer MEMS", "ori-drs/allan_variance_ros: README.md",
                "BMI055, to general knowledge. Record of 3 h, means of the axes (gyro N 0.472, "
                "0.592, 0.503 deg/sqrt(h), minima 1.77, 4.88, 3.15 deg/h); plain minima, divided "
                "by 0.664 here. The white noises agree with the page's own estimator settings.",
                false},
     .method = "measured",
     .gyro = {.present = true,
              .white = 0.5225,
              .instability = 3.267,
              .random_walk = 33.12,
              .is_floor = true},
     .accel = {.present = true,
               .white = 0.3785,
               .instability = 88.38,
               .random_walk = 714,
               .is_floor = true}},
    {.device = {"TUM-VI", "consumer MEMS", "rpng/open_vins: config/tum_vi/kalibr_imu_chain.yaml",
                "BMI160, to general knowledge. Figures of the data set's authors; the rate random "
                "walk is large, as filters are tuned.",
                false},
     .method = "measured",
     .gyro = {.present = true, .white = 0.55, .random_walk = 272.3},
     .accel = {.present = true, .white = 0.168}},
    {.device = {"DJI A3", "industrial MEMS", "gaowenliang/imu_utils: README.md",
                "Means of the axes; plain minima, divided by 0.664 here.", false},
     .method = "measured",
     .gyro = {.present = true, .white = 0.3559, .instability = 6.072, .is_floor = true},
     .accel = {.present = true, .white = 0.08391, .instability = 64.5, .is_floor = true}},
    {.device = {"Tundra T20", "consumer MEMS",
                "collabora/libsurvive: wiki, IMU-Variance-measurements",
                "Plain minima, divided by 0.664 here.", false},
     .method = "measured",
     .gyro = {.present = true,
              .white = 0.447,
              .instability = 6.854,
              .random_walk = 85.68,
              .is_floor = true},
     .accel = {.present = true, .white = 0.1291, .instability = 73.76, .is_floor = true}},
    {.device = {"HG1125CA01", "tactical MEMS",
                "TrevorBurgoyne/GPS-Denied-Nav: Simulation/imu_model.m",
                "Floor divided by 0.664. The 7 mg of in-run accelerometer bias look like a slip of "
                "the copyist and are left out.",
                false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.3, .instability = 7, .is_floor = true},
     .accel = {.present = true, .white = 0.05486, .repeatability = 1500}},
    {.device =
         {"Xsens MTi-630", "industrial MEMS",
          "JorgeDFR/3d_lidar_slam_benchmark_at_iilab: docs/content/dataset/sensors/imu/index.md",
          "0.007 deg/s/sqrt(Hz) and 60 ug/sqrt(Hz), taken as two-sided. The page prints 8 deg/s of "
          "gyro bias, which can only be deg/h; accelerometer 10 to 15 ug, the middle taken. Floors "
          "divided by 0.664.",
          false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.42, .instability = 8, .is_floor = true},
     .accel = {.present = true, .white = 0.0353, .instability = 12.5, .is_floor = true}},
    {.device = {"Xsens MTi-1", "industrial MEMS", "doi 10.2478/tar-2023-0022, table of the MTi-1",
                "0.007 deg/s/sqrt(Hz) and 120 ug/sqrt(Hz), taken as two-sided, 0.03 mg; floors "
                "divided by 0.664.",
                false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.42, .instability = 10, .range = 2000, .is_floor = true},
     .accel =
         {.present = true, .white = 0.07061, .instability = 30, .range = 16, .is_floor = true}},
    {.device =
         {"ADIS16475-2", "industrial MEMS",
          "leggedrobotics/grand_tour_box: box_calibration, allan_variances/adis/allan_variance.csv",
          "Record of 36 h; B is the minimum / 0.664. The accelerometer curves show quantisation "
          "(x, y) and drift (z), against 0.0576 m/s^2/sqrt(Hz) in the source's own settings: left "
          "out.",
          false},
     .method = "measured",
     .gyro = {.present = true, .white = 0.0758, .instability = 1.81},
     .accel = {.present = false}},
    {.device = {"Alphasense Core", "consumer MEMS",
                "leggedrobotics/grand_tour_box: box_calibration, "
                "allan_variances/alphasense/allan_variance.csv",
                "BMI085, to general knowledge. Record of 36 h; B is the minimum / 0.664. The gyro "
                "falls with slope -0.2 to -0.37 only at 1 s: an upper bound of its white noise.",
                false},
     .method = "measured",
     .gyro = {.present = true, .white = 0.5987, .instability = 3.97},
     .accel = {.present = true, .white = 0.05577, .instability = 37.53}},
    {.device =
         {"Leica AP20", "industrial MEMS",
          "leggedrobotics/grand_tour_box: box_calibration, allan_variances/ap20/allan_variance.csv",
          "Record of 36 h; B is the minimum / 0.664. Gyro x falls with slope -0.91 at 1 s, from "
          "vibration or quantisation: the mean white noise is an upper bound.",
          false},
     .method = "measured",
     .gyro = {.present = true, .white = 0.5783, .instability = 3.497},
     .accel = {.present = true, .white = 0.07333, .instability = 17.23}},
    {.device =
         {"NovAtel CPT7", "tactical MEMS",
          "leggedrobotics/grand_tour_box: box_calibration, allan_variances/cpt7/allan_variance.csv",
          "HG4930, to general knowledge. Record of 36 h; B is the minimum / 0.664, still falling "
          "at 999 s on x and z.",
          false},
     .method = "measured",
     .gyro = {.present = true, .white = 0.03893, .instability = 0.194},
     .accel = {.present = true, .white = 0.028, .instability = 19.4}},
    {.device =
         {"Livox Mid-360", "consumer MEMS",
          "leggedrobotics/grand_tour_box: box_calibration, "
          "allan_variances/livox/allan_variance.csv",
          "Record of 36 h; B is the minimum / 0.664. The source's accelerometer column is in g.",
          false},
     .method = "measured",
     .gyro = {.present = true, .white = 0.2537, .instability = 4.773},
     .accel = {.present = true, .white = 0.03926, .instability = 21.28}},
    {.device =
         {"LN-200", "tactical FOG", "SMAC-Group/avar: data/ln200_av.rda",
          "Published Allan variances of 6 h, taken as rad/s; B is the minimum / 0.664 at 1311 s, "
          "still falling: an upper bound. The accelerometer is limited by quantisation: left out.",
          false},
     .method = "measured",
     .gyro = {.present = true, .white = 0.03927, .instability = 0.1013},
     .accel = {.present = false}},
    {.device = {"iMAR", "tactical FOG", "SMAC-Group/avar: data/imar_av.rda",
                "Gyros only. Published Allan variances of 4 h, taken as rad/s; B is the minimum / "
                "0.664. Called MEMS there, but the figures are those of a fibre-optic unit, and it "
                "is listed as one.",
                false},
     .method = "measured",
     .gyro = {.present = true, .white = 0.1066, .instability = 0.3935},
     .accel = {.present = false}},
    {.device = {"NavChip", "industrial MEMS", "SMAC-Group/avar: data/navchip_av.rda",
                "Gyros only. Published Allan variances of 3.45 h, taken as rad/s; B is the minimum "
                "/ 0.664. Slope -0.1 at 1 s: no white noise to be read.",
                false},
     .method = "measured",
     .gyro = {.present = true, .instability = 17.62},
     .accel = {.present = false}},
    {.device = {"SBG IG-500N", "industrial MEMS", "milkytipo/Allan-variance: record of 2.44 h",
                "From an Allan deviation of a 5 Hz record; B is the minimum / 0.664. The record "
                "was thinned without a filter, which inflates the white noises: left out, and B is "
                "an upper bound.",
                false},
     .method = "measured",
     .gyro = {.present = true, .instability = 34.11},
     .accel = {.present = true, .instability = 398}},
    {.device = {"Hipnuc CH104", "industrial MEMS",
                "yandld/nav_matlab: example/allan_test/allan_plot_ch100/ch104.mat",
                "From an Allan deviation of 53.5 min at 100 Hz; B is the minimum / 0.664. Steps of "
                "the output 0.01 deg/s and 1 mg.",
                false},
     .method = "measured",
     .gyro = {.present = true, .white = 0.3183, .instability = 1.804, .resolution = 0.01},
     .accel = {.present = true, .white = 0.04939, .instability = 32.83, .resolution = 1}},
    {.device = {"hfi", "consumer MEMS", "dockermyself/allan_variance: data/allan_variance.csv",
                "An unnamed MEMS unit; white noises read at 1 s.", false},
     .method = "measured",
     .gyro = {.present = true, .white = 1.685},
     .accel = {.present = true, .white = 0.6639}},
    {.device = {"NovAtel SPAN", "tactical MEMS", "SiyuChen1/novatel_sensor_fusion: imu_paras.md",
                "The unit is not named; class of the HG4930. Floors divided by 0.664.", false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.06016, .instability = 0.4497, .is_floor = true},
     .accel = {.present = true, .white = 0.06, .instability = 74.95, .is_floor = true}},
    {.device = {"NovAtel SPAN measured", "tactical MEMS",
                "SiyuChen1/novatel_sensor_fusion: imu_paras.md",
                "The same unit by its Allan deviation, B as given.", false},
     .method = "measured",
     .gyro = {.present = true, .white = 0.1368, .instability = 0.144, .random_walk = 2.116},
     .accel = {.present = true, .white = 0.1056, .instability = 10.2}},
    {.device =
         {"VN-100", "industrial MEMS",
          "estimator settings citing the maker's support (repository not known); data sheet "
          "as four public projects copy it",
          "0.0035 deg/s/sqrt(Hz) and 0.14 mg/sqrt(Hz); the maker's support gives the same "
          "numbers as random walks there, so they are N. Floors are the limits in the copies, "
          "10 deg/h (two of them have 5 deg/h, too) and 0.04 mg, divided by 0.664. A random "
          "walk of the accelerometer bias (5e-5 m/s^3/sqrt(Hz)) is a filter's and left out.",
          false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.21, .instability = 10, .is_floor = true},
     .accel = {.present = true, .white = 0.08238, .instability = 40, .is_floor = true}},
    {.device = {"ASTRIX 200", "space FOG",
                "gyroscope script citing the maker (repository not known)",
                "Gyros only. Bias stability 0.0005 deg/h at 3 sigma, given here as repeatability "
                "of a third of it.",
                false},
     .method = "datasheet",
     .gyro = {.present = true, .white = 0.0001, .repeatability = 0.0001666666667}},
    {.device = {"Groves consumer", "grade example", "zbai/MATLAB-Groves: MATLAB/Inertial_Demo_3.m",
                "An example of the grade, no device: fixed biases, scale factors, cross couplings "
                "and g-sensitivity and white noise as there; its quantisation is left out.",
                false},
     .method = "example",
     .gyro = {.present = true,
              .white = 1,
              .bias = consumer_gyro_bias,
              .matrix = consumer_gyro_matrix,
              .g_matrix = consumer_gyro_g_matrix},
     .accel = {.present = true,
               .white = 0.5884,
               .bias = consumer_accel_bias,
               .matrix = consumer_accel_matrix}},
    {.device = {"Groves tactical", "grade example", "zbai/MATLAB-Groves: MATLAB/Inertial_Demo_4.m",
                "An example of the grade, no device: fixed biases, scale factors, cross couplings "
                "and g-sensitivity and white noise as there; its quantisation is left out.",
                false},
     .method = "example",
     .gyro = {.present = true,
              .white = 0.01,
              .bias = tactical_gyro_bias,
              .matrix = tactical_gyro_matrix,
              .g_matrix = tactical_gyro_g_matrix},
     .accel = {.present = true,
               .white = 0.05884,
               .bias = tactical_accel_bias,
               .matrix = tactical_accel_matrix}},
    {.device = {"Groves aviation", "grade example", "zbai/MATLAB-Groves: MATLAB/Inertial_Demo_2.m",
                "An example of the grade, no device: fixed biases, scale factors, cross couplings "
                "and white noise as there; its quantisation is left out.",
                false},
     .method = "example",
     .gyro = {.present = true,
              .white = 0.002,
              .bias = aviation_gyro_bias,
              .matrix = aviation_gyro_matrix},
     .accel = {.present = true,
               .white = 0.01177,
               .bias = aviation_accel_bias,
               .matrix = aviation_accel_matrix}},
};
const size_t imki_device_table_count = sizeof imki_device_table / sizeof imki_device_table[0];
