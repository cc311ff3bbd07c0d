#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The inputs of commands.txt, made in the working directory: small, so that a run takes milliseconds.
# IMUKIT is the command, SOURCE the checkout.
set -eu

cat >unit.yaml <<'END'
imukit: 1
name: bench unit
gyro:
  bias: {fixed: 0.5 -0.8 0.3 deg/s}
  scale_factor: {fixed: 8000 -5000 3000 ppm}
  misalignment: 2 -3 4 1 -2 3 mrad
  noise: {angle_random_walk: 0.3 deg/sqrt(h), bias_instability: 1 deg/h}
accel:
  bias: {fixed: 20 -35 50 mg}
  scale_factor: {fixed: -3000 6000 9000 ppm}
  misalignment: 3 -2 0 4 0 0 mrad
  noise: {velocity_random_walk: 0.05 m/s/sqrt(h), bias_instability: 10 ug}
END
cat >gyro.yaml <<'END'
imukit: 1
gyro:
  noise: {angle_random_walk: 0.3 deg/sqrt(h), bias_instability: 1 deg/h}
END
cat >quiet.yaml <<'END'
imukit: 1
gyro:
  noise: {angle_random_walk: 0.3 deg/sqrt(h)}
accel:
  noise: {velocity_random_walk: 0.05 m/s/sqrt(h)}
END
cp "$SOURCE/tests/firmware/nonlinear.yaml" nonlinear.yaml

# Six faces with full turns in three of them: for every procedure that needs no reference.
cat >turns.yaml <<'END'
imukit_motion: 1
start: {latitude: 48.1 deg, longitude: 11.6 deg, height: 520 m}
steps:
  - hold 6 s
  - rotate z 360 deg at 90 deg/s
  - hold 5 s
  - pose 0 90 0 deg in 3 s
  - hold 6 s
  - rotate x 360 deg at 90 deg/s
  - hold 5 s
  - pose 0 -90 0 deg in 4 s
  - hold 6 s
  - pose 90 0 0 deg in 3 s
  - hold 6 s
  - rotate y 360 deg at 90 deg/s
  - hold 5 s
  - pose -90 0 0 deg in 4 s
  - hold 6 s
  - pose 180 0 0 deg in 4 s
  - hold 6 s
  - pose 30 40 50 deg in 3 s
  - hold 6 s
  - pose -60 20 150 deg in 4 s
  - hold 6 s
  - pose 120 -30 -70 deg in 4 s
  - hold 6 s
  - pose -130 -50 20 deg in 4 s
  - hold 6 s
then: hold
END
cat >table.yaml <<'END'
imukit_motion: 1
start: {latitude: 48.1 deg, longitude: 11.6 deg, height: 520 m}
steps:
  - hold 5 s
  - repeat: {times: 1, steps: [rotate z at 20 deg/s for 4 s, rotate z at -20 deg/s for 4 s, rotate z at 80 deg/s for 4 s, rotate z at -80 deg/s for 4 s]}
  - pose 0 90 0 deg in 4 s
  - repeat: {times: 1, steps: [rotate x at 20 deg/s for 4 s, rotate x at -20 deg/s for 4 s, rotate x at 80 deg/s for 4 s, rotate x at -80 deg/s for 4 s]}
  - pose 90 0 0 deg in 4 s
  - repeat: {times: 1, steps: [rotate y at 20 deg/s for 4 s, rotate y at -20 deg/s for 4 s, rotate y at 80 deg/s for 4 s, rotate y at -80 deg/s for 4 s]}
  - hold 4 s
END
awk 'BEGIN { print "time [s],temperature [degC]"; for (t = 0; t <= 400; t += 10) print t "," 10 + t / 10 }' >heat.csv

$IMUKIT simulate AHRS --rate 20Hz --duration 60s --seed 1 -o rest.csv
$IMUKIT simulate AHRS --rate 20Hz --duration 60s --seed 2 -o rest2.csv
$IMUKIT simulate unit.yaml --motion turns.yaml --rate 50Hz --duration 140s --seed 3 -o turns.csv
$IMUKIT simulate unit.yaml --motion table.yaml --rate 50Hz --seed 3 -o table.csv
$IMUKIT simulate unit.yaml --temperature heat.csv --rate 10Hz --duration 400s --seed 3 -o thermal.csv
for k in 0 1 2; do
    $IMUKIT simulate AHRS --rate 20Hz --duration 20s --run $k -o run$k.csv
done
$IMUKIT convert rest.csv gyro.csv --select time,gyro_x
$IMUKIT convert rest2.csv gyro2.csv --select time,gyro_x
$IMUKIT identify gyro2.csv --threads 1 -o one.yaml >/dev/null 2>&1
$IMUKIT simulate gyro.yaml --rate 100Hz --duration 22000s -o three.npy
# Long enough that it is not held in memory.
$IMUKIT convert three.npy long.npy --select gyro_x
rm three.npy*
for ending in csv.gz csv.zst npy; do
    $IMUKIT convert rest.csv rest.$ending
done

awk 'BEGIN {
    print "reference [deg/s],reading [deg/s]"
    for (k = 0; k < 60; k++) {
        up = k % 20 < 10; place = up ? k % 20 : 20 - k % 20; x = 2 * place - 10
        printf "%g,%.6f\n", x, 0.1 + 1.001 * x + 0.0003 * x * x + (up ? 0.01 : -0.01) * (1 - x * x / 100) + 0.005 * (k / 20 % 3 - 1)
    }
}' >levels.csv

for i in 1 2; do
    $IMUKIT drift unit.yaml --duration 10s --monte-carlo 8 --seed 3 --threads 1 --shard $i/2 -o shard$i.h5
done >/dev/null
for name in kalibr.yaml gazebo.sdf matlab.json px4.params ardupilot.param vins.yaml openvins.yaml navego.m gnss_ins_sim.json \
    lio_sam.yaml fast_lio.yaml dlio.yaml glim.json orb_slam3.yaml gtsam.txt airsim.json fusion.txt; do
    cp "$SOURCE/fuzz/corpus/parameters/$name" "from_$name"
done
awk 'BEGIN { print "tau [s],gyro_x [deg/h]"; for (t = 0.1; t < 500; t *= 2) print t "," sqrt(18 * 18 / t + 1) }' >curve.csv
awk 'BEGIN { print "time [s],latitude [deg],longitude [deg],height [m],roll [deg],pitch [deg],yaw [deg]"; for (t = 0; t <= 4; t++) print t ",48,11,500," t "," 2 * t "," 3 * t }' >poses.csv

for ending in bag mcap db3; do
    $IMUKIT convert rest.csv "rest.$ending"
done
for name in lz4.bag bz2.bag two; do
    cp -R "$SOURCE/tests/fixtures/bags/$name" "$name"
done
