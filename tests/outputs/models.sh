#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Models, motions, designs and tables of commands.txt, made in the working directory by inputs.sh,
# and the logs of what moves.
set -eu

cp "$SOURCE/tests/firmware/linear.yaml" linear.yaml
cp "$SOURCE/examples/instruments/open_fibre_optic.yaml" design.yaml
cp "$SOURCE/examples/instruments/still_ring_laser.yaml" "$SOURCE/examples/instruments/pull_in.yaml" .
sed 's/gyroscope_noise_density/gyroscope_noise_densty/' from_kalibr.yaml >misspelt_kalibr.yaml
sed 's/\(gyroscope_noise_density:\).*/\1 30/' from_kalibr.yaml >impossible_kalibr.yaml

# model NAME: a model file of the lines that follow
model() {
    { echo 'imukit: 1'; cat; } >"$1.yaml"
}

# ---- noise that identify tells apart ---------------------------------------------------------------
model shaken <<'END'
name: beside a fan
gyro:
  noise:
    angle_random_walk: 0.3 deg/sqrt(h)
    sinusoid: [{amplitude: 100 deg/h, frequency: 2.37 Hz}, {amplitude: 60 deg/h, frequency: 4.74 Hz}]
END
model ringing <<'END'
gyro:
  noise: {angle_random_walk: 0.3 deg/sqrt(h), resonance: [{sigma: 0.05 deg/s, frequency: 4 Hz, q: 8}]}
END
model filtered <<'END'
gyro: {noise: {angle_random_walk: 0.3 deg/sqrt(h)}, bandwidth: 2 Hz, damping: 0.7}
accel: {noise: {velocity_random_walk: 0.05 m/s/sqrt(h)}, bandwidth: 3 Hz}
END
model slow <<'END'
gyro:
  noise: {angle_random_walk: 0.01 deg/sqrt(h), bias_instability: 8 deg/h, rate_random_walk: 60 deg/h/sqrt(h), quantization: 1 arcsec}
END
model flicker <<'END'
gyro: {noise: {angle_random_walk: 0.01 deg/sqrt(h), bias_instability: 8 deg/h}}
accel: {noise: {velocity_random_walk: 0.005 m/s/sqrt(h), bias_instability: 500 ug}}
END
model markov <<'END'
gyro:
  noise: {angle_random_walk: 0.1 deg/sqrt(h), gauss_markov: [{sigma: 30 deg/h, correlation_time: 10 s}]}
END

# ---- units with all that a model can say -----------------------------------------------------------
model rich <<'END'
name: all terms
description: one of each
gyro:
  bias: {fixed: 12 -8 5 ± 0.5 deg/h, repeatability: 0.4 deg/h, temperature: {reference_temperature: 25 degC, valid_range: -20 60 degC, coefficients: [2 deg/h/K, 0.05 deg/h/K^2]}, temperature_rate: 0.5 deg/h/(K/min), warm_up: {amplitude: 20 deg/h, time: 30 s}, hysteresis: 4 deg/h}
  scale_factor: {fixed: 500 -300 200 ± 20 ppm, repeatability: 50 ppm, temperature: {reference_temperature: 25 degC, valid_range: -20 60 degC, coefficients: [10 ppm/K]}}
  misalignment: 0.2 mrad
  nonlinearity: {k2: 3 ppm/(deg/s), k3: 1 ppm/(deg/s)^2, asymmetry: 100 ppm}
  g_sensitivity: [2 0 0 deg/h/g, 0 2 0 deg/h/g, 0 0 2 deg/h/g]
  noise: {angle_random_walk: 0.05 deg/sqrt(h), bias_instability: 0.3 deg/h, rate_random_walk: 0.1 deg/h/sqrt(h), rate_ramp: 0.1 deg/h/h, gauss_markov: [{sigma: 0.2 deg/h, correlation_time: 300 s}], sinusoid: [{amplitude: 1 deg/h, frequency: 1 Hz}]}
  dead_band: 0.1 deg/h
  range: 500 deg/s
  resolution: 0.01 deg/h
accel:
  bias: {fixed: 3 -2 1 ± 0.05 mg, repeatability: 0.1 mg}
  scale_factor: {fixed: 300 ppm}
  cross_axis: 0.01 %
  nonlinearity: {k2: 10 ug/g^2}
  cross_products: [5 0 0 ppm/g, 0 5 0 ppm/g, 0 0 5 ppm/g]
  lever_arm: [12 0 0 mm, 0 9 0 mm, 0 0 -4 mm]
  noise: {density: one-sided, velocity_random_walk: 60 ug/sqrt(Hz), allan_floor: 20 ug, quantization: 1e-5 m/s}
  bandwidth: 40 Hz
  range: 10 g
timing: {rate_error: 20 ppm, jitter: 100 us, skew: 50 us, drops: 1 %}
END
model lever_arms <<'END'
name: a calibrated unit
gyro: {bias: {fixed: 0.4 -0.2 0.1 deg/s}, misalignment: 2 mrad, noise: {angle_random_walk: 0.1 deg/sqrt(h)}, range: 300 deg/s}
accel: {bias: {fixed: 12 -5 8 mg}, lever_arm: [12 0 0 mm, 0 9 0 mm, 0 0 -4 mm], range: 10 g}
END
model skewed <<'END'
name: four gyros
gyro:
  direction: [1 1 1, 1 -1 -1, -1 1 -1, -1 -1 1]
  bias: {fixed: 1 2 3 4 deg/h}
  noise: {angle_random_walk: 0.1 deg/sqrt(h)}
END
model leftover <<'END'
name: what is left
residual_of: bench unit
gyro: {bias: {fixed: 0.01 deg/s}}
accel: {bias: {fixed: 1 mg}}
END
model warms <<'END'
gyro: {bias: {temperature: {reference_temperature: 25 degC, valid_range: 20 40 degC, coefficients: 10 deg/h/K}}}
END
model narrow <<'END'
gyro: {bias: {fixed: 0.1 deg/s}, range: 50 deg/s}
accel: {bias: {fixed: 1 mg}, lever_arm: [12 0 0 mm, 0 9 0 mm, 0 0 -4 mm], range: 10 g}
END
model optimist <<'END'
gyro: {bias: {repeatability: 0.01 deg/h}, noise: {angle_random_walk: 0.001 deg/sqrt(h), bias_instability: 0.003 deg/h}}
accel: {bias: {repeatability: 40 ug}, noise: {velocity_random_walk: 0.003 m/s/sqrt(h), bias_instability: 10 ug}}
END
model cycles <<'END'
gyro: {bias: {repeatability: 60 deg/h}, noise: {angle_random_walk: 0.3 deg/sqrt(h)}}
accel: {bias: {repeatability: 20 mg}, noise: {velocity_random_walk: 0.05 m/s/sqrt(h)}}
END
model chamber_unit <<'END'
gyro:
  bias: {temperature: {reference_temperature: 25 degC, valid_range: -20 60 degC, coefficients: [2 deg/h/K, 0.05 deg/h/K^2]}, hysteresis: 40 deg/h}
  noise: {angle_random_walk: 0.1 deg/sqrt(h), bias_instability: 3 deg/h}
accel:
  bias: {temperature: {reference_temperature: 25 degC, valid_range: -20 60 degC, coefficients: 0.1 mg/K}}
  noise: {velocity_random_walk: 0.05 m/s/sqrt(h), bias_instability: 20 ug}
END
model folded <<'END'
gyro: {nonlinearity: {k2: 20000 ppm/(deg/s)}, range: 300 deg/s}
accel: {}
END
model lost <<'END'
gyro: {bias: {repeatability: 100 deg/s}}
accel: {bias: {repeatability: 1000 g}}
END
echo 'gyro: {}' | model perfect_gyros
printf 'gyro: {}\naccel: {}\n' | model perfect
echo 'gyro: {noise: {angle_random_wlak: 0.3 deg/sqrt(h)}}' | model wrong_key
echo 'gyro: {noise: {angle_random_walk: 0.3}}' | model wrong_unit
echo 'accel: {noise: {velocity_random_walk: 60 ug/sqrt(Hz)}}' | model wrong_density
echo 'gyro: {noise: {bias_instability: 3 deg/h}' | model wrong_braces
printf 'instrument: ring_laser\nname: lab\nreadout: {range: 100 deg/s}\n' | model small_range
printf 'instrument: ring_laser\ndither: {frequency: 600 m}\n' | model wrong_design

# ---- motions, temperatures, places -----------------------------------------------------------------
# motion NAME: a motion script of the lines that follow
motion() {
    { echo 'imukit_motion: 1'; cat; } >"$1.yaml"
}
place='start: {latitude: 48.1 deg, longitude: 11.6 deg, height: 520 m, heading: 30 deg}'

motion lap <<END
name: a lap with a stop
$place
steps:
  - hold 20 s
  - repeat: {times: 2, steps: [accelerate to 10 m/s at 2 m/s^2, turn left 90 deg at 12 deg/s banked, climb to 3 deg at 1 deg/s, level at 1 deg/s, stop at 3 m/s^2, hold 10 s]}
vibration:
  - sine z 0.05 g at 8 Hz
  - random x 0.0001 g^2/Hz from 1 Hz to 9 Hz
END
motion cruise <<END
$place
steps: [hold 60 s, accelerate to 25 m/s at 5 m/s^2, hold 2 min, stop at 5 m/s^2, hold 20 s]
END
motion shaking <<END
$place
steps: [hold 2 s]
vibration: [sine z 0.5 g at 50 kHz]
END
motion spin <<'END'
earth: no
steps: [hold 5 s, rotate z at 20 deg/s for 5 s, rotate z at -20 deg/s for 5 s, rotate z at 90 deg/s for 5 s, rotate z at -90 deg/s for 5 s, hold 5 s]
END
motion fast_spin <<END
$place
steps: [hold 5 s, rotate z at 720 deg/s for 5 s, hold 4 s, rotate x at 720 deg/s for 5 s, hold 4 s, rotate y at 720 deg/s for 5 s, hold 5 s]
END
motion upright_spin <<END
$place
steps: [hold 5 s, rotate z at 720 deg/s for 5 s, hold 5 s, rotate z at -720 deg/s for 5 s, hold 5 s]
END
motion swing <<END
$place
steps: [swing x 20 deg at 0.7 Hz for 60 s]
END
motion plane <<END
$place
steps: [hold 10 s, repeat: {times: 12, steps: [rotate x 29 deg in 2 s, hold 4 s]}]
END
motion few <<END
$place
steps: [hold 10 s, pose 100 20 40 deg in 2 s, hold 4 s, pose 20 70 0 deg in 2 s, hold 4 s, pose -30 -40 50 deg in 2 s, hold 4 s]
END
motion few_more <<END
$place
steps: [hold 10 s, pose 100 20 40 deg in 2 s, hold 4 s, pose 20 70 0 deg in 2 s, hold 4 s, pose -30 -40 50 deg in 2 s, hold 4 s, pose 170 10 0 deg in 2 s, hold 4 s, pose -80 0 0 deg in 2 s, hold 4 s, pose 10 -60 0 deg in 2 s, hold 4 s]
END
printf 'imukit_motion: 1\nsteps: [hold 5 s, jump 3 m]\n' >wrong_motion.yaml
printf 'time [s],x [m],y [m],z [m],vel_north [m/s],roll [deg],pitch [deg],yaw [deg]\n' >flat_poses.csv
awk 'BEGIN { for (t = 0; t <= 4; t += 0.5) print t "," t * t "," t ",0,0," t "," 2 * t "," 3 * t }' >>flat_poses.csv
cat >chamber.yaml <<'END'
imukit_temperature: 1
time_constant: 1 min
steps: [start 25 degC, ramp to 60 degC at 4 degC/min, ramp to -20 degC at 4 degC/min, soak 1 min, ramp to 25 degC at 4 degC/min, step to 26 degC]
END

# ---- logs of what moves ----------------------------------------------------------------------------
$IMUKIT simulate unit.yaml --motion lap.yaml --rate 50Hz --seed 2 -o lap.csv --truth lap_truth.csv
$IMUKIT simulate lever_arms.yaml --motion lap.yaml --rate 50Hz --seed 2 -o raw_lap.csv
$IMUKIT simulate tactical --motion cruise.yaml --rate 20Hz --seed 3 -o cruise.csv
for name in swing plane few few_more fast_spin upright_spin; do
    $IMUKIT simulate unit.yaml --motion $name.yaml --rate 50Hz --seed 1 -o $name.csv
done
$IMUKIT simulate unit.yaml --motion help_calibrate/poses.yaml --rate 50Hz --duration 120s -o poses_unit.csv
$IMUKIT simulate skewed.yaml --motion turns.yaml --rate 10Hz --duration 100s -o skewed.csv
$IMUKIT simulate linear.yaml --motion turns.yaml --rate 50Hz --duration 140s --temperature 25degC -o turns_counts.csv
$IMUKIT simulate nonlinear.yaml --motion turns.yaml --rate 20Hz --duration 120s --temperature heat.csv -o hot_turns.csv
$IMUKIT simulate chamber_unit.yaml --temperature chamber.yaml --rate 2Hz --duration 41min -o loop.csv
for k in 0 1 2 3; do
    $IMUKIT simulate cycles.yaml --rate 50Hz --duration 20s --run $k -o cycle$k.csv
    $IMUKIT simulate unit.yaml --motion turns.yaml --rate 25Hz --duration 120s --seed "$k" -o session.csv
    $IMUKIT calibrate session.csv -p sixposition --placement 0.01deg --gravity 9.8074m/s^2 -o session$k.yaml
done >/dev/null 2>&1
$IMUKIT simulate navigation --rate 20Hz --duration 150s -o parked.csv
$IMUKIT calibrate --plan quiet.yaml -p tumble --position "48.1 deg, 11.6 deg, 520 m" -o tumble.yaml >/dev/null
$IMUKIT simulate unit.yaml --motion tumble.yaml --rate 20Hz --duration 300s -o tumble.csv
$IMUKIT simulate unit.yaml --motion spin.yaml --rate 50Hz -o spin_unit.csv
$IMUKIT simulate perfect_gyros.yaml --motion spin.yaml --rate 50Hz -o spin_truth.csv
paste -d, spin_unit.csv spin_truth.csv | cut -d, -f1-4,11 |
    sed '1s/,[^,]*$/,table_rate [deg\/s]/' >table_rate.csv

# ---- the same, altered -----------------------------------------------------------------------------
# alter FROM TO PROGRAM: each row but the header through awk
alter() {
    awk -F, -v OFS=, "NR > 1 { $3 } 1" "$1.csv" >"$2.csv"
}
cut -d, -f2- turns.csv | sed 1d >no_time_turns.csv
alter turns turns_backwards 'if (NR > 3000 && NR < 3005) $1 -= 1; if (NR == 4000) $5 = "nan"'
alter turns turns_shaken 'for (i = 5; i < 8; i++) $i *= 1 + 0.004 * sin($1 / 9 + i)'
alter poses_unit poses_saturated 'for (i = 5; i < 8; i++) $i = $i > 9.8 ? 9.8 : $i < -9.8 ? -9.8 : $i'
alter help_calibrate/poses poses_clipped 'for (i = 5; i < 8; i++) $i = $i > 9.6 ? 9.6 : $i < -9.6 ? -9.6 : $i'
alter turns turns_wrong_unit 'for (i = 5; i < 8; i++) $i /= 9.80665'
alter turns turns_rad 'for (i = 2; i < 5; i++) $i *= 3.14159265358979 / 180'
alter turns turns_ms '$1 *= 1000'
alter turns turns_exchanged 't = $2; $2 = $3; $3 = t'
alter turns turns_mirrored '$3 = -$3'
alter turns turns_dead '$5 = 1.25'
alter turns turns_no_number '$5 = "nan"'
alter turns turns_whole 'for (i = 2; i < 5; i++) $i = int($i * 16.4); for (i = 5; i < 8; i++) $i = int($i * 1670)'
alter table table_late '$1 += 1.337'
alter hot_turns hot_turns_gap 'if (NR > 300 && NR < 310) $NF = "nan"'
alter run0 time_missing 'if (NR == 50) $1 = "nan"; if (NR > 200) $1 += 3'
alter lap no_rates 'if (NR > 900 && NR < 910 && NR != 905) $2 = $3 = $4 = "nan"'
awk -F, -v OFS=, '{ print $0, NR == 1 ? "temperature [degC]" : 25 + NR / 400 }' raw_lap.csv >lap_warm.csv
awk 'BEGIN {
    print "time [s],gyro_x [deg/s],gyro_y [deg/s],gyro_z [deg/s],accel_x [g],accel_y [g],accel_z [g]"
    rate = 15.041067 / 3600 / sqrt(2)
    for (k = 0; k < 700; k++)
        printf "%.1f,%.12f,0,%.12f,0,0,%.12f\n", k / 10, rate, -rate, -1.0026905 * 9.80619920 / 9.80665 }' >equator_g.csv
awk 'BEGIN {
    print "time [s],reference_force_x [g],reference_force_y [g],reference_force_z [g],accel_x [g],accel_y [g],accel_z [g]"
    for (k = 0; k < 1800; k++) {
        step = int(k / 60); axis = int(step / 10); f[0] = f[1] = f[2] = 0; f[axis] = 2 * (step % 10) - 9
        printf "%.2f", k / 20
        for (i = 0; i < 3; i++) printf ",%g", f[i]
        for (i = 0; i < 3; i++) printf ",%.6f", 0.01 * (i + 1) + (1 + 1e-3 * i) * f[i] + 2e-5 * f[i] ^ 2 + 1e-4 * sin(k * k + i)
        print "" } }' >centrifuge.csv
awk 'BEGIN {
    print "time [s],gyro_x [deg/s]"
    for (k = 0; k < 20000; k++) {
        y = 0.001 * sin(k * k)
        for (i = 1; i <= 72; i++) y += 0.05 * sin(2 * 3.14159265358979 * 0.65 * i * k / 100 + i * i)
        printf "%.2f,%.6f\n", k / 100, y } }' >many_lines.csv
awk -F, -v OFS=, 'NR > 1 && NR % 2 { $2 *= 1.5 } 1' curve.csv >bent_curve.csv
head -c 3000 shard2.h5 >damaged.h5

# ---- tables that evaluate reads --------------------------------------------------------------------
awk -F, -v OFS=, 'NR == 1 { print $0, "direction", "run", "sigma [deg/s]"; next }
    { print $0, (NR - 2) % 20 < 10 ? "up" : "down", NR < 32 ? "a" : "b", 0.005 }' levels.csv >runs_table.csv
awk -F, -v OFS=, 'NR == 1 { print "reference [deg/s],reading [count]"; next } { print $1, int(32768 + 131 * $2) }' levels.csv >counts_table.csv
sed -n '1,11p' levels.csv >single_sweep.csv
sed 's/reading/reding/' levels.csv >wrong_table.csv
awk 'BEGIN { print "reference [g],reading_x [g],reading_y [mg]"; for (k = 0; k < 40; k++) {
    x = (k % 8 - 3.5) / 4; printf "%g,%.6f,%.4f\n", x, 1.002 * x + 1e-4 * (k % 3), 1001 * x + 0.2 * (k % 5) } }' >accel_table.csv

# ---- what only few results show --------------------------------------------------------------------
$IMUKIT drift quiet.yaml --motion turns.yaml --rate 10Hz --monte-carlo 4 --aid "gnss position 1 m at 1 Hz until 30 s" -o aided.h5 >/dev/null
cat >uncounted.yaml <<'END'
imukit: 1
accel: {noise: {density: two-sided, velocity_white: 1e-3 m/s/sqrt(Hz), velocity_random_walk: 1e-3 m/s/sqrt(s)}}
END
$IMUKIT simulate uncounted.yaml --rate 50Hz --duration 40s --no-earth --decimals 12 | cut -d, -f1,2 >uncounted.csv
$IMUKIT simulate uncounted.yaml --rate 25Hz --duration 30s --no-earth --decimals 12 --seed 4 | cut -d, -f1,2 >uncounted_slow.csv
sed '1s/.*/time [s],depth [m]/' uncounted.csv >depth.csv

# ---- what only few verbs read ----------------------------------------------------------------------
$IMUKIT simulate unit.yaml --motion lap.yaml --rate 50Hz --seed 2 --aid "position 1 1 2 m, velocity 0.05 m/s" --aid-output lap_aids.csv -o lap_again.csv
$IMUKIT convert rest.csv rest.mcap
awk 'BEGIN { print "pose,accel_x [m/s^2],accel_y [m/s^2],accel_z [m/s^2],gyro_x [deg/s],gyro_y [deg/s],gyro_z [deg/s],accel_x_std [m/s^2],accel_y_std [m/s^2],accel_z_std [m/s^2],samples"
    split("x_up x_down y_up y_down z_up z_down", name, " ")
    for (k = 0; k < 12; k++) {
        axis = int(k % 6 / 2); f[0] = 0.2; f[1] = -0.3; f[2] = 0.1; f[axis] += k % 2 ? -9.80743 : 9.80743
        printf "%s,%.5f,%.5f,%.5f,0.1,0.0,0.0,0.005,0.005,0.005,100\n", name[k % 6 + 1], f[0] + 1e-3 * sin(k * k), f[1] + 1e-3 * cos(k * k), f[2] + 1e-3 * sin(3 * k) } }' >faces.csv
