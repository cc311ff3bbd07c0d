#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The inputs of commands.txt, made in the working directory: those of tests/faults, those of the
# examples of --help (help_VERB/), and what is wrong or rare in a log. IMUKIT is the command, SOURCE
# the checkout, DATA the folder of real logs or nothing; `imukit` is found in the PATH too.
set -eu

sh "$SOURCE/tests/faults/inputs.sh"
for verb in allan calibrate convert evaluate merge navigate; do
    mkdir "help_$verb"
    (cd "help_$verb" && bash "$SOURCE/tools/help_inputs.sh" "$verb") >/dev/null 2>&1
done
sh "$SOURCE/tests/outputs/models.sh"

# edit FROM TO PROGRAM: a log changed by awk, cell by cell; row 1 is the header.
edit() {
    awk -F, -v OFS=, "$3" "$1" >"$2"
}

# ---- logs at rest: sound ones ----------------------------------------------------------------------
$IMUKIT simulate AHRS --rate 20Hz --duration 10min --seed 5 -o static.csv
$IMUKIT simulate AHRS --rate 20Hz --duration 10min --seed 6 -o other_unit.csv
$IMUKIT simulate gyro.yaml --rate 20Hz --duration 10min --no-earth --seed 4 -o gyros.csv
$IMUKIT convert gyros.csv two_axes.csv --select time,gyro_x,gyro_y
$IMUKIT simulate AHRS --rate 20Hz --duration 1min --increments -o increments.csv
$IMUKIT convert static.csv in_g.csv --to-accel-unit g --to-gyro-unit deg/h
seq 2000 | awk '{ printf "%.6f\n", 0.001 * sin($1 * $1) + 1e-6 * $1 }' >phase.txt

for model in shaken ringing filtered slow flicker markov; do
    $IMUKIT simulate $model.yaml --rate 20Hz --duration 10min --no-earth --seed 2 -o $model.csv
done

# ---- logs written in another way -------------------------------------------------------------------
sed 1d rest.csv >no_header.csv
sed 's/,/;/g' rest.csv >semicolons.csv
sed 's/,/\t/g' rest.csv >tabs.txt
sed 's/,/ /g; s/ \[/[/g' rest.csv >blanks.txt
sed '1s/ \[[^]]*\]//g' rest.csv >no_units.csv
{ printf '\357\273\277# with a mark, comments and CRLF\r\n'; sed 's/$/\r/' rest.csv; } >crlf.csv
cut -d, -f2- rest.csv >no_time.csv
edit rest.csv epoch.csv 'NR == 1 { sub(/time \[s\]/, "timestamp [ms]") } NR > 1 { $1 = sprintf("%.0f", 1700000000000 + 50 * (NR - 2)) } 1'
edit rest.csv others.csv 'NR == 1 { print "time [s],pressure [Pa],field [count],note" } NR > 1 {
    printf "%s,%.3f,%d,%s\n", $1, 101325 + 50 * $2, 1000 * $3, NR % 400 < 200 ? "door shut" : "door open" }'
edit rest.csv counts.csv 'NR == 1 { print "time [s],gyro_x [count],gyro_y [count],gyro_z [count]" }
    NR > 1 { printf "%s,%d,%d,%d\n", $1, 131 * $2, 131 * $3, 131 * $4 }'
edit rest.csv with_words.csv 'NR == 1 { print $0, "label" } NR > 1 { print $0, NR < 600 ? "cold" : "warm" }'

# ---- logs at rest: times that are not even ---------------------------------------------------------
sed '301d; 901d' static.csv >few_missing.csv
sed '2001,2600d; 4001,4100d; 9000d' static.csv >gaps.csv
sed '5001d' gyro.csv | edit /dev/stdin repeated_times.csv 'NR % 300 == 7 { $1 = last } { last = $1 } 1'
edit gyro.csv backwards.csv 'NR > 700 && NR < 720 { $1 -= 10 } 1'
edit gyro.csv leap.csv 'NR > 700 { $1 += 1e6 } 1'
edit gyro.csv still_clock.csv 'NR > 1 { $1 = 5 } 1'
for share in 0.001 0.1 0.6; do
    edit gyro.csv "jitter_$share.csv" "NR > 1 { \$1 = sprintf(\"%.6f\", \$1 + 0.05 * $share * sin(NR * NR)) } 1"
done

# ---- logs at rest: samples that cannot be, or do not fit -------------------------------------------
edit static.csv not_finite.csv 'NR == 101 { $2 = "nan" } NR == 205 { $3 = "inf" } NR == 309 { $4 = "" } NR == 400 { $5 = "1e308" } 1'
edit gyros.csv outliers.csv 'NR % 1000 == 500 { $2 += 3; $3 -= 40 } 1'
edit gyros.csv stuck.csv 'NR > 3000 && NR < 3200 { $2 = value } { value = $2 } 1'
edit gyros.csv at_limit.csv 'NR > 1 && NR % 97 < 6 { $2 = 0.25 } NR > 1 && $2 > 0.25 { $2 = 0.25 } 1'
edit gyros.csv clipped.csv 'NR > 1 { if ($2 > 0.04) $2 = 0.04; if ($2 < -0.04) $2 = -0.04 } 1'
edit gyros.csv frozen.csv 'NR > 2500 { exit } NR > 1 && (NR - 2) % 8 { $2 = x; $3 = y; $4 = z } { x = $2; y = $3; z = $4 } 1'
edit gyros.csv coarse.csv 'NR > 1 { $2 = 0.1 * int($2 / 0.1 + 1000.5) - 100 } 1'
edit gyros.csv steps.csv 'NR > 6000 { $2 += 0.3 } NR > 9000 { $3 -= 0.4 } 1'
edit gyros.csv warm_up.csv 'NR > 1 { $2 += 0.2 * exp(-$1 / 60); $3 -= 0.1 * exp(-$1 / 60) } 1'
edit gyros.csv follows_heat.csv 'NR == 1 { print $0, "temperature [degC]" }
    NR > 1 { t = 25 + 10 * sin($1 / 40) + 0.01 * $1; $2 += 0.01 * (t - 25); $3 += 1e-3 * (t - 25) ^ 2; print $0, sprintf("%.3f", t) }'
edit gyros.csv constant.csv 'NR > 1 { $3 = 0.125 } 1'
edit gyros.csv huge.csv 'NR > 1 { $2 = $2 * 1e9 } 1'
edit in_g.csv wrong_unit.csv 'NR == 1 { gsub(/accel_. \[g\]/, "&!"); gsub(/\[g\]!/, "[m/s^2]") } 1'
edit static.csv no_gravity.csv 'NR > 1 { $7 += 7 } 1'

# ---- files that are no logs ------------------------------------------------------------------------
: >empty.csv
head -1 rest.csv >header_only.csv
head -2 rest.csv >one_row.csv
head -c 3000 rest.csv >cut_short.csv
edit rest.csv words.csv 'NR == 20 { $3 = "abc" } 1'
edit rest.csv ragged.csv 'NR == 30 { print $0, "7"; next } 1'
edit rest.csv same_names.csv 'NR == 1 { sub(/gyro_y/, "gyro_x") } 1'
head -c 5000 rest.npy >cut_short.npy && cp rest.npy.columns cut_short.npy.columns
head -c 4000 rest.csv.gz >cut_short.csv.gz
cp rest.npy nameless.npy
printf 'time [s],gyro_x [deg/s]\n1,2\n' | iconv -t UTF-16 >utf16.csv

# ---- real logs, cut to what takes a second -----------------------------------------------------------
if [ -n "$DATA" ]; then
    mkdir real
    for unit in 1 2; do
        zcat "$DATA/static/adis16405_imu${unit}_100hz.csv.gz" | sed '20002,$d' >real/imu$unit.csv
    done
    zcat "$DATA/navigation/laser_gyro_parked_100hz_increments.csv.gz" | sed '12002,$d' >real/parked.csv
    cp "$DATA"/calibration/*.csv.gz "$DATA"/reference/hg4930_36h_adev.csv "$DATA"/navigation/groves_profile_1.csv.gz real
fi

# ---- a magnetometer beside gyros and accelerometers -------------------------------------------------
cat >compass.yaml <<'END'
imukit: 1
accel: {bias: {fixed: 20 -35 50 mg}, noise: {velocity_random_walk: 0.05 m/s/sqrt(h)}}
mag:
  bias: {fixed: 12 -8 30 uT}
  scale_factor: {fixed: 2 -3 1 %}
  cross_axis: 1 0.5 -2 0.3 0.1 0.7 %
  noise: {density: one-sided, white_noise: 40 nT/sqrt(Hz)}
END
$IMUKIT calibrate --plan unit.yaml -p multiposition --want "accel.scale_factor 100 ppm" -o compass_poses.yaml >compass_plan.txt
$IMUKIT simulate compass.yaml --motion compass_poses.yaml --rate 50Hz --duration 120s --seed 1 --field "20 1 43 uT" --decimals 6 -o compass.csv
$IMUKIT convert compass.csv compass_alone.csv --select time,mag_x,mag_y,mag_z
mag() { # NAME PROGRAM: of columns 5 to 7 of compass.csv
    edit compass.csv "mag_$1.csv" "NR > 1 { $2 } { print }"
}
mag exchanged 'm = $5; $5 = $6; $6 = m; $7 = -$7'
mag inverted '$5 = -$5; $6 = -$6; $7 = -$7'
mag mounted 'm = $5; $5 = $6 * 0.8 + $7 * 0.6; $6 = $7 * 0.8 - $6 * 0.6; $7 = m'
mag stuck '$6 = 3'
mag saturated '$7 = $7 > 50 ? 50 : $7'
mag held 'if (NR % 5 == 2) { a = $5; b = $6; c = $7 } $5 = a; $6 = b; $7 = c'
mag disturbed 'k = int($1 / 6); $5 += sin(7 * k * k); $6 += sin(3 * k * k); $7 += sin(k * k)'
mag steel '$5 += $1 > 30 && $1 < 48 ? 9 : 0'
mag steel_short '$5 += $1 > 30 && $1 < 42 ? 9 : 0'
mag flat '$7 = 0.1 * $7'
mag far '$5 *= 50; $6 *= 50; $7 *= 50'
edit compass.csv mag_tesla.csv 'NR == 1 { gsub(/uT/, "mT") } { print }'
edit compass.csv mag_counts.csv 'NR == 1 { gsub(/uT/, "count") } { print }'
edit compass_alone.csv mag_plane.csv 'NR > 1 { n = sqrt(($2 - 12)^2 + ($3 + 8)^2); $2 = 20 * ($2 - 12) / n; $3 = 20 * ($3 + 8) / n; $4 = 43 + 0.001 * $4 } { print }'
edit compass_alone.csv mag_few.csv 'NR < 12'
edit compass_alone.csv mag_two.csv '{ print $1, $2, $3 }'
