#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# What the examples of `imukit VERB --help` read, made where this is run, for tools/check_docs.py:
#
#     tools/help_inputs.sh VERB     (imukit: those of `imukit --help`)
set -eu
place="48.1 deg, 11.6 deg, 520 m"

# static NAME [OPTIONS…]: a log at rest
static() {
    local name=$1
    shift
    imukit simulate AHRS --rate 100Hz --duration 10min "$@" -o "$name"
}

# bench: poses.csv and, of a table that ran programme.yaml, table.csv
bench() {
    imukit calibrate --plan tactical --procedure multiposition --position "$place" -o poses.yaml
    imukit simulate tactical --motion poses.yaml --rate 100Hz --duration 2min -o poses.csv
    imukit calibrate --plan tactical --procedure rate-table --position "$place" -o programme.yaml
    imukit simulate tactical --motion programme.yaml --rate 100Hz --duration 5min -o table.csv
}

case $1 in
imukit) static LOG.csv ;;
identify)
    static static.csv
    static raw.npy && imukit convert raw.npy raw.csv --select gyro_x,gyro_y,gyro_z
    sed -i 1d raw.csv
    ;;
info) static static.csv ;;
calibrate) bench ;;
evaluate)
    bench
    mv table.csv steps.csv
    static rest.csv
    printf '%s\n' 'reference [deg/s],reading [deg/s]' -50,-50.11 0,0.02 50,50.09 0,0.05 -50,-50.12 \
        0,0.03 50,50.10 >table.csv
    ;;
simulate)
    imukit devices tactical >model.yaml
    printf 'imukit_motion: 1\nsteps: [hold 5 s, accelerate to 10 m/s at 2 m/s^2]\n' >car.yaml
    ;;
compensate)
    imukit devices tactical >unit.yaml
    imukit simulate unit.yaml --rate 100Hz --duration 10s -o raw.csv
    ;;
allan)
    static static.csv
    seq 1000 | awk '{ print 0.001 * sin($1 * $1) }' >phase.txt
    ;;
spectrum) static static.csv && cp static.csv bench.csv ;;
grade | drift) imukit devices tactical >model.yaml ;;
tune)
    imukit devices tactical >unit.yaml
    printf 'imukit_motion: 1\nsteps: [hold 2 s, accelerate to 1.4 m/s at 1 m/s^2, %s]\n' \
        'swing y 20 deg at 0.9 Hz for 12 s' >walk.yaml
    imukit simulate unit.yaml --only bias.fixed --motion walk.yaml --rate 200Hz -o drive.csv
    ;;
convert)
    imukit devices tactical >model.yaml
    static raw.csv --accel-unit g
    sed -i '1s/ \[[^]]*\]//g; 1s/time/time [s]/' raw.csv
    ;;
physics) imukit physics rate_gyro --show >mine.yaml ;;
navigate)
    imukit devices navigation >unit.yaml
    imukit simulate navigation --rate 100Hz --duration 10min --latitude 34.25deg --height 380m \
        -o parked.csv
    printf '%s\n' 'imukit_motion: 1' \
        'start: {latitude: 48.1 deg, longitude: 11.6 deg, height: 520 m}' \
        'steps: [hold 150 s, accelerate to 10 m/s at 2 m/s^2, stop at 2 m/s^2, hold 20 s]' \
        'vibration: [sine z 0.02 g at 28 Hz]' >drive.yaml
    imukit simulate tactical --motion drive.yaml --rate 100Hz -o drive.csv \
        --aid "position 1 m, velocity 0.05 m/s" --aid-output gnss.csv
    ;;
join)
    imukit physics fibre_optic --reduce -o gyro.yaml >/dev/null
    imukit physics pendulous_servo --reduce -o accel.yaml >/dev/null
    for axis in a b c; do
        imukit physics ring_laser --reduce --single-axis -o $axis.yaml >/dev/null
    done
    ;;
merge)
    for part in 1 2; do
        imukit drift tactical --duration 1min --rate 10Hz --monte-carlo 16 --shard $part/2 \
            -o shard-$part.h5
    done
    ;;
esac
