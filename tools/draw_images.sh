#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Draws the pictures of docs/physics, docs/how-far-off.md and docs/filter-noise.md with the command
# itself, into docs/images:
#
#     tools/draw_images.sh             all
#     tools/draw_images.sh ring_laser  those whose name contains it
#
# The same seed makes the same runs, and the same drawings.
set -eu
cd "$(dirname "$0")/.."
imukit=${IMUKIT:-${BUILD:-build}/imukit}
images=${IMAGES:-docs/images}
designs=examples/instruments
only=${1:-}

# draw NAME ARGUMENTS…: docs/images/physics-NAME.svg by --plot
draw() {
    local name=$1
    shift
    case $name in *"$only"*) ;; *) return 0 ;; esac
    "$imukit" physics "$@" --plot "$images/physics-$name.svg" >"$images/.draw.log" ||
        { cat "$images/.draw.log" >&2; exit 1; }
}

# move NAME ARGUMENTS…: the same by --animate
move() {
    local name=$1
    shift
    case $name in *"$only"*) ;; *) return 0 ;; esac
    "$imukit" physics "$@" --animate "$images/physics-$name.svg"
}

# schematic NAME: docs/images/schematic-NAME.svg by --view, which a test compares
schematic() {
    case schematic-$1 in *"$only"*) ;; *) return 0 ;; esac
    "$imukit" physics "$1" --view -o "$images/schematic-$1.svg"
}

trap 'rm -f "$images/.draw.log"' EXIT

for name in $("$imukit" physics --list | sed -n '2,/^$/s/ .*//p'); do
    schematic "$name"
done

draw free_gyro-the-gimbals-stay-behind free_gyro --view "the gimbals"
draw free_gyro-nutation free_gyro --view nutation

move free_gyro-path-in-motion free_gyro --view path

draw rate_gyro-gimbal-angle-after-the-rate-begins rate_gyro --view gimbal
draw rate_gyro-phase-portrait-of-the-gimbal rate_gyro --view phase
draw rate_gyro-sweep rate_gyro --sweep

draw rate_integrating_gyro-float-angle-after-the-rate-begins rate_integrating_gyro --view float
draw rate_integrating_gyro-torquer-and-float rate_integrating_gyro --view torquer
draw rate_integrating_gyro-limit-cycle "$designs/binary_floated_gyro.yaml" --view float \
    --rate "0 deg/s" --duration 20ms --output-rate 6.4kHz

draw tuned_gyro-rotor-after-the-rate-begins tuned_gyro --view rotor
draw tuned_gyro-what-the-flexures-see tuned_gyro --view what

move tuned_gyro-path-in-motion tuned_gyro --view path

draw suspended_rotor-the-axis-stays-the-case-turns suspended_rotor --view "the axis"
draw suspended_rotor-drift suspended_rotor --view drift
draw suspended_rotor-fall suspended_rotor --view "the ball"
draw suspended_rotor-run-down suspended_rotor --view "the fallen"

draw fibre_optic-light-on-the-fringe fibre_optic --view light
move fibre_optic-operating-point fibre_optic --view light
draw fibre_optic-the-ramp-and-its-resets fibre_optic --view "the ramp"
draw fibre_optic-the-loop-locks fibre_optic --view "the loop"
draw fibre_optic-what-the-detector-sees fibre_optic --view what
draw fibre_optic-sweep-open "$designs/open_fibre_optic.yaml" --sweep

draw ring_laser-dither-and-beat ring_laser --view dither
draw ring_laser-kicks ring_laser --view kicks
draw ring_laser-the-pull-of-lock-in ring_laser --view "the pull"
draw ring_laser-phase-without-the-dither ring_laser --view phase
draw ring_laser-staircase "$designs/still_ring_laser.yaml" --rate "160 deg/h" --view phase
draw ring_laser-dead-band "$designs/still_ring_laser.yaml" --rate "400 deg/h" --sine 0.02Hz \
    --duration 50s --output-rate 5Hz

draw tuning_fork-drive-motion tuning_fork --view drive
draw tuning_fork-sense-motion tuning_fork --view sense

move tuning_fork-path-in-motion tuning_fork --view path
draw tuning_fork-start-of-the-drive tuning_fork --view start
draw tuning_fork-force-of-the-amplitude-control tuning_fork --view force
draw tuning_fork-demodulated-rate-and-quadrature tuning_fork --view demodulated
draw tuning_fork-sweep tuning_fork --sweep

draw shell_gyro-motion-of-the-two-modes shell_gyro --view motion
draw shell_gyro-split "$designs/split_ring.yaml" --view motion --no-noise \
    --duration 2.5s --output-rate 1kHz
move shell_gyro-pattern-in-motion "$designs/slow_ring.yaml" --view motion --rate "30 deg/s" \
    --no-noise --duration 4s --output-rate 1kHz
draw shell_gyro-angle-of-the-pattern "$designs/hemispherical.yaml" --view angle
draw shell_gyro-forces-of-the-loops shell_gyro --view forces
draw shell_gyro-quadrature shell_gyro --view quadrature

draw mems_accelerometer-step mems_accelerometer --view response
draw mems_accelerometer-bits "$designs/sigma_delta_accelerometer.yaml" --view bits
draw mems_accelerometer-limit-cycle "$designs/sigma_delta_accelerometer.yaml" --view limit
draw mems_accelerometer-pull-in "$designs/pull_in.yaml" --view pull
draw mems_accelerometer-dead-zone "$designs/sigma_delta_accelerometer.yaml" --no-noise \
    --acceleration "300 mg" --sine 0.5Hz --duration 2s --output-rate 200Hz
draw mems_accelerometer-sweep mems_accelerometer --sweep

draw pendulous_servo-the-pendulum-is-pulled-back pendulous_servo --view "the pendulum"
draw pendulous_servo-the-torquer-takes-over pendulous_servo --view "the torquer"
draw pendulous_servo-sweep pendulous_servo --sweep

draw vibrating_beam-two-beams-drift-apart vibrating_beam --view two
draw vibrating_beam-the-force-on-the-beams vibrating_beam --view "the force"
move vibrating_beam-the-beat-of-the-beams vibrating_beam --view "the beat"
draw vibrating_beam-sweep vibrating_beam --sweep

case drift-navigation in
    *"$only"*) "$imukit" drift navigation --plot "$images/drift-navigation.svg" >"$images/.draw.log" ;;
esac

case drift-outage in
    *"$only"*)
        "$imukit" drift tactical --initial-attitude "0.1 0.1 0.5 deg" --outage 10s,60s,300s \
            --aid "gnss position 1 m, velocity 0.05 m/s at 1 Hz until 600 s" \
            --plot "$images/drift-outage.svg" >"$images/.draw.log"
        ;;
esac

case tune-tactical in
    *"$only"*) # on the motion of its page
        sed -n '/^cat > build.walk.yaml/,/^END/p' docs/filter-noise.md | sed '1d;$d' >"$images/.walk.yaml"
        "$imukit" tune tactical "$images/.walk.yaml" --plot "$images/tune-tactical.svg" \
            >"$images/.draw.log"
        rm "$images/.walk.yaml"
        ;;
esac

for map in gyro accel cost sensor-cost; do
    case grade-$map in
        *"$only"*)
            "$imukit" grade navigation HG1700 tactical --map "$map" \
                --plot "$images/grade-$map.svg" >"$images/.draw.log"
            ;;
    esac
done
