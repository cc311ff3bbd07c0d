/* SPDX-License-Identifier: Apache-2.0 */
/* The messages of findings: one table, by code.
 *
 * Braces hold the index of a number of the finding and how to write it: {0} a count, {1g} as %g,
 * {2.1f} as %.1f, {0s} an s unless the count is one, {0a} the name of an Allan statistic, {0t} the
 * text of a status, {0k} gyro or accel, {0p} gyros, accelerometers or magnetometer, {0q} rate or
 * specific force, {0u} a quantity of the unit that is the name. {name} is the name, {other} what
 * stands behind a tab in it; {record} and {model} are what these are called. The text between {2?}
 * and {?} is shown if number 2 is not 0, the text behind {2!} if it is 0. */
#include "finding_fill_internal.h"

#include <string.h>

#define HOW_TO_GO_ON "use --gaps longest (the longest clean stretch) or --gaps bridge (interpolate)"
#define CURVE_FIT "{name}: chi-square {0.1f} for {1} degrees of freedom (probability {2.2g})"
#define LEFT_OUT "deviations at tau below {3.3g} s are left out: the terms do not explain them."
#define CURVE_MISFIT                                                                               \
    "Either the terms do not explain the curve, or the options do not describe it: add --plain "   \
    "if its clusters do not overlap, and check --rate and --duration. Do not trust the intervals."
#define PLAN_LENGTH "--plan: a record of {0g} s at {1g} Hz does not have 256 to 1e12 samples; "

#define NEARER                                                                                     \
    "bring the design nearer to the default one, which imukit physics {other} --show prints, or "  \
    "the input nearer to 0"

#define SAMPLES_FIRST ": {0} of {1} samples (first: row {2})"

/* Formats that define their columns refuse --columns, and a log without names has none to map. */
#define BY_NAME "--map (in a log without names with --columns)"
#define NO_TIMES                                                                                   \
    "leave the time column out with " BY_NAME " and state the sampling rate, such as --rate 100Hz"

#define LONGEST_STRETCH                                                                            \
    "{0} bad row{0s}, {1} missing sample{1s}: using the longest clean stretch, rows {2} to {3} "   \
    "of "                                                                                          \
    "{4}"
#define NAME_IT                                                                                    \
    "{0?}write the unit into the header, such as mag_x [uT]{0!}if that is what it is, name it so " \
    "with --columns, with a name for each column and - for one to skip{?}{1?} (a sign in a name "  \
    "does not turn the readings round){?}"
#define SKIP_IT "to do without this column, leave it out with " BY_NAME
#define UNORDERED "{0} row{0s} whose time does not increase: left out"
#define DOUBLED                                                                                    \
    "{0} of {1} rows are the row before them once more, with its time and values: left out"

static const struct message {
    const char *code, *text;
} messages[] = {
    /* records: even_record.c, unused_columns.c */
    {"no_rows", "there is a header but no data row"},
    {"no_channel", "there is no column to analyse; name one with --columns, such as gyro_x or "
                   "accel_z"},
    {"unused_columns", "not used in {record}, although like {other}: {name}; " NAME_IT},
    {"unused_axis",
     "{record}: an axis is missing, and {name}, which looks like {other}, is not used; " NAME_IT},
    {"unused_sensor", "{record}: no column is read as {other}; {name} may be that: " NAME_IT},
    {"gravity_free",
     "{record}: {name}: by its name gravity is taken out of it, so that it is not what an "
     "accelerometer measures: not used; if gravity is in it, name it so with --map, such as "
     "accel_x=NAME"},
    {"not_turned",
     "{record}: {name}: not turned; only the axes of the sensors are, and these columns "
     "still belong to the axes of the file"},
    {"unknown_channels", "no column is read as one of a gyro or an accelerometer: the columns are "
                         "analysed as they are, and belong to no model"},
    {"one_row", "there is only one row; record minutes to hours at rest"},
    {"no_interval", "the time column does not increase, so the sampling rate is unknown; leave the "
                    "column out with " BY_NAME " and state the rate, such as --rate 100Hz"},
    /* record_grid.c */
    {"no_grid", "the timestamps are not evenly spaced: steps scatter by {0.0f} % of their median, "
                "{1g} s; if only the timestamps scatter, " NO_TIMES "; otherwise resample the log"},
    {"time_constant", "the time is {0.10g} s in every row: " NO_TIMES},
    {"time_backwards", "time runs backwards, in {0} of {1} rows: turn the order of the rows round, "
                       "or sort them by time (sort -n)"},
    {"time_order", "the rows are not in the order of their times: time goes back in {0} of {1} "
                   "rows, by up to {2g} s, and its steps are even otherwise; sort the rows by time "
                   "as a number (sort -n), not as a text"},
    {"time_digits",
     "the time has too few digits: it stays the same for {0.0f} rows on average and "
     "then steps by {1g} s, as seconds since 1970 do in single precision; " NO_TIMES},
    {"time_stands", "the time stands still in {0} row{0s}, and its steps are even otherwise: leave "
                    "that part out with --after or --before"},
    {"jitter", "the timestamps scatter by {0.1f} % of the sample interval; the samples are treated "
               "as evenly spaced"},
    {"clock_leaps", "the timestamps do not fit the number of rows; the clock may have jumped or "
                    "stopped: use --gaps longest (the longest clean stretch)"},
    {"not_finite", "{0} row{0s} with a value that is not a finite number or beyond 1e60, first in "
                   "row {1}: counted as missing"},
    /* record_check.c */
    {"damaged",
     "{3?}{0} row{0s} cannot be read: left out, the first behind row {2} of {1} (line {3}{?}{4?}, "
     "column {4}{?}{3?}){?}{3!}{0} row{0s}, messages or blocks of the file cannot be read and are "
     "left out (none if it is the checksum of a whole file), the first behind row {2} of {1}{?}"},
    {"headers", "the header stands {0} more time{0s} between the rows, first behind row {1}, as "
                "where files were put together: left out; give such parts as logs of their own if "
                "they are not one record"},
    {"cut_short", "the file ends in the middle of a row, message or block, or its last line has no "
                  "end and may be cut; what is whole, {0} row{0s}, is used; if the file is a copy, "
                  "copy it again"},
    {"places:damaged", "{0} row{0s}, messages or blocks of the places read cannot be read and are "
                       "left out; --full reads the whole log"},
    {"places:cut_short", "the file ends in the middle of a row, message or block, or its last line "
                         "has no end and may be cut; if the file is a copy, copy it again"},
    {"received", "{0?}the stamps of the first messages are 0, and of {0} later one{0s} they are "
                 "not; for all of them {?}{0!}the stamps of the messages are all 0; {?}the times "
                 "at which they were recorded are used, which have the jitter of their way"},
    {"later", "{0} message{0s} of the sensor hold {name}, which its first messages do not: not "
              "read, because the first ones decide the columns; a log that begins with such "
              "messages has them"},
    {"decimated", "the log has {0.4g} increments per second, and its device makes {1.4g}: those "
                  "that are not recorded are missing, and rates and forces are too low by up to a "
                  "factor of {2.3g}; record every message"},
    {"uneven_increments", "each increment is divided by its own step of the time, and the steps "
                          "are not even: if the samples are, and only the times are coarse or "
                          "late, state --rate"},
    {"absent", "{0} of the {1} messages that the log says it has of this sensor are not in it, "
               "or in files that are missing; copy it again, with all of its files"},
    {"unclosed", "the database is in the mode of a write-ahead log, and does not say how many "
                 "messages it has: if it was copied before it was closed, the last ones are in the "
                 "file with -wal behind its name, which is not here"},
    {"unlisted",
     "the folder has {0} more file{0s}, which its metadata.yaml does not name: not read, the first "
     "is {name}; if they are of this log, write the list anew: ros2 bag reindex "
     "FOLDER"},
    {"unread", "{0} array{0s} of the file cannot be read: left out, the first is {name}, a "
               "{other}; if a sensor is in it, write it as a vector or matrix of numbers"},
    {"frames", "the messages of the topic name several frames, {name}; {0} of {1} have another "
               "header.frame_id than the first: if two sensors publish on the topic, the rows are "
               "of both; record each on a topic of its own, or take them apart by frame_id"},
    {"unordered", UNORDERED},
    {"stamps:unordered", UNORDERED},
    {"missing",
     "{0} of {1} samples are missing, in {2} gap{2s}, the longest of {3g} s; the gaps stay empty"},
    /* record_stamps.c, stamp_rates.c */
    {"stamps:coarse_stamps",
     "one stamp of the time column is that of {0.3g} rows on average: the rows "
     "are counted, and the rate of the long run is {1.7g} Hz; a loss of a few "
     "rows within one stamp cannot be seen, nor whether these are rows of several "
     "sensors"},
    {"stamps:bunched", "the rows come in bunches of {0.3g} on average, stamped when they arrived: "
                       "they are counted, and the rate of the long run is {1.7g} Hz; if a bunch "
                       "is not of one sensor, choose its columns with --columns"},
    {"stamps:late", "{0} row{0s} are stamped late, by up to {1.3g} s, and the delay is made up: "
                    "the rows are counted, and the rate of the long run is {2.7g} Hz; if the log "
                    "has the clock of the sensor, too, name that column time with --columns"},
    {"stamps:jumps", "the clock steps back {0} time{0s}, by up to {1.3g} s: the rows are counted "
                     "at {2.7g} Hz; rows that are missing there cannot be seen"},
    {"stamps:wrapped", "the clock begins anew {0} time{0s}, every {1.10g} s: taken as going on"},
    {"stamps:doubled", DOUBLED},
    {"doubled", DOUBLED},
    {"stamps:rounded",
     "the times are taken as rounded to {0g} s, so the rate is {1.7g} Hz; if rows are missing "
     "regularly instead, give the columns without the time, and the rate, such as --rate 100Hz"},
    {"stamps:two_rates",
     "the sample interval changes for longer times: parts of the log have another rate than "
     "{0.5g} Hz, or regularly lack rows; cut the log where the rate changes"},
    {"stamps:alternate", "long and short steps of the time alternate, and differ by {0.3g} s: rows "
                         "of two sensors or of two clocks in one log? Separate them"},
    {"stamps:held",
     "{name}: {0.3g} % of the rows repeat the row before on all axes, so the sensor has {1.5g} Hz "
     "and the log {2.5g} Hz: all terms are wrong at short averaging times; log at the rate of the "
     "sensor, or keep new samples only"},
    {"stamps:sparse",
     "{name}: {0.3g} % of the rows have no value on any axis, at even distances, so the sensor has "
     "{1.5g} Hz and the log {2.5g} Hz: white noise comes out too small by a factor of {3.3g}, and "
     "all terms are wrong at short averaging times; write the rows that have values to a log of "
     "their own"},
    {"packets",
     "{name}: {0.2g} % of the rows are the rows {1} before, written again on all axes, as a packet "
     "of {1} rows in place of the next one: white noise comes out wrong; find out where rows are "
     "written twice, and record again"},
    {"replayed",
     "{name}: {0.2g} % of the rows are written again: those from about {1.6g} s on are those from "
     "{2.6g} s on, with the same values on all axes; what is counted twice makes the intervals too "
     "narrow and slow terms wrong: find out where rows are written twice, or read the part before "
     "by --before {1.6g}s"},
    {"copy", "{name} has the values of {other} in every row: one of the two is a copy, so give the "
             "right columns with " BY_NAME},
    {"follows", "the changes of {name} are those of {other}, times {0.4g}: two sensors have noise "
                "of their own, so one of the two is computed from the other; leave it out"},
    {"correlated",
     "{name} and {other} share their noise, with a coherence of {0.2g} at most frequencies: axes "
     "have noise of their own, unless one is computed from others, they talk across, have a supply "
     "in common, or all feel what the sensor stands on; the white noise is then not that of the "
     "axis"},
    {"stamps:rate_differs", "--rate says {0.7g} Hz, but the time column {1.7g} Hz; --rate is used, "
                            "and every result follows from it: check which one is right"},
    /* record_spacing.c */
    {"mostly_missing", "{0} good row{0s} and {1} missing sample{1s} are too little to interpolate; "
                       "use --gaps longest"},
    {"refused_not_finite", "{0} row{0s} with a value that is not a finite number or beyond 1e60, "
                           "first in row {1}, column {name}; " HOW_TO_GO_ON},
    {"refused_backwards",
     "time runs backwards in {0} row{0s}, first in row {1} (by {2g} s); " HOW_TO_GO_ON},
    {"refused_standing", "time stands still in {0} row{0s}, first in row {1}; " HOW_TO_GO_ON},
    {"refused_missing",
     "{0} samples are missing in {1} gap{1s}, first before row {2}; " HOW_TO_GO_ON},
    {"longest_stretch", LONGEST_STRETCH},
    {"stamps:longest_stretch", LONGEST_STRETCH},
    {"stamps:short_stretch", LONGEST_STRETCH ", which are {5.2g} % of the log: look for what is "
                                             "wrong with the others"},
    {"no_good_rows", "no two consecutive rows are good"},
    /* allan_log.c */
    {"no_value", "column {name} has no finite value in {0} rows; leave it out with " BY_NAME ", or "
                 "check the log"},
    {"constant", "column {name} is constant in all {0} rows: there is no noise to analyse; leave "
                 "it out with " BY_NAME ", or check the log"},
    {"too_few_for_allan", "{0} rows are too few for an Allan deviation"},
    {"statistic_needs_all",
     "column {name} has missing samples, and only oadev of rates allows gaps; leave out "
     "--statistic and --type, or use --gaps bridge or --gaps longest"},
    {"statistic_failed", "column {name}: {0a}: {1t}"},
    {"averaging_time", "{0g} s is outside the averaging times of this record, {1g} s to {2g} s"},
    /* identify_log.c, identify_by_allan.c */
    {"constant_identify", "column {name} is constant in all {0} rows: there is no noise to "
                          "identify; leave it out with " BY_NAME ", or check the log"},
    {"too_few_values", "column {name} has {0} finite values in {1} rows: at least 256 are needed "
                       "to identify noise; leave it out with " BY_NAME ", or check the log"},
    {"too_few_changes",
     "column {name} stays the same in most of its {1} rows: not a quarter of them has a value that "
     "differs from the row before, as where an angle or a velocity is counted in steps that are "
     "large for a row, or a slower sensor is repeated; log at a lower rate or with finer steps"},
    {"too_few_to_identify",
     "{1} rows are too few to identify noise: at least 256 are needed; record minutes to hours"},
    {"moved",
     "the sensor was moved between {0.4g} s and {1.4g} s, so that {name} holds no noise that "
     "could be identified; {3?}the longest part at rest is read by --after {2g}s --before "
     "{3g}s{3!}no part of the log is without this: record it again at rest{?}"},
    {"no_model:outliers",
     "{name}: {0} of {1} samples are off the others by up to {2.5g} {other}, too many to be left "
     "out; if they are codes of lost samples, such as -32768, write nan in their place; " SKIP_IT},
    {"no_model:steps", "{name}: no noise terms describe it, and its level jumps {0} time{0s}, by "
                       "up to {1.3g} {other}; take a part without a jump by --after and "
                       "--before; " SKIP_IT},
    {"no_model:cycle",
     "{name}: no noise terms describe it, and its level goes up and down by {0.2g} {other} in a "
     "cycle of {1.3g} s: a motion, such as breathing or a rate table? Record at rest; " SKIP_IT},
    {"no_model:motion",
     "{name}: it has noise, but no noise terms, lines and resonances describe it: a motion that "
     "repeats, such as breathing or the ripple of a rate table? Record at rest, and look at imukit "
     "spectrum; " SKIP_IT},
    {"no_model:smooth",
     "{name}: there is no noise in the record: it is smooth or too regular for a real sensor; "
     "check "
     "that it is no angle, filtered value or simulation without noise; " SKIP_IT},
    {"column_failed", "column {name}: {0t}"},
    {"allan_needs_all",
     "column {name} has {0} samples missing or taken out, and --method allan needs all of them; "
     "use --method likelihood (the default), which allows gaps, or --gaps bridge"},
    {"allan_fit", "{name}: Allan deviations fitted from {0.3g} s to {1.3g} s, chi-square {2.1f} "
                  "for {3} degrees of freedom (probability {4.2g})."},
    /* identify_curve.c */
    {"long_table", "looks like the long table of imukit allan; a curve needs a column for each "
                   "channel, such as tau [s],gyro_x [deg/s]; or identify the log itself with "
                   "--method allan, which needs no table"},
    {"no_curve",
     "a table of Allan deviations needs a column tau [s] and columns such as gyro_x [deg/s]"},
    {"too_few_tau",
     "{0} values of tau are multiples of 1/{1g} s and at most half of {2g} s; a fit needs 4"},
    {"curve", CURVE_FIT "."},
    {"curve_from", CURVE_FIT "; " LEFT_OUT},
    {"curve_tolerance",
     "{name}: an error of {0g} % is allowed in each deviation, as of a curve read "
     "from a page: statistical errors alone do not explain its scatter; "
     "--tolerance states another error."},
    {"curve_failed",
     "column {name}: no sum of the five terms comes near this curve, with any error "
     "of its deviations up to 20 % ({0t}); check --rate and --duration, the units "
     "and the columns, and add --plain if its clusters do not overlap"},
    {"curve_misfit", CURVE_FIT ". " CURVE_MISFIT},
    {"curve_misfit_from", CURVE_FIT "; " LEFT_OUT " " CURVE_MISFIT},
    /* record_plan.c, plan_requirement.c */
    {"plan_length", PLAN_LENGTH "change --duration or --rate"},
    {"plan_no_length", PLAN_LENGTH "add a --duration that fits"},
    {"no_noise",
     "states no noise, so no record length can be computed; use a similar catalogue entry (imukit "
     "devices), or identify the noise from a first log at rest (imukit identify)"},
    {"requirement", "--want \"{name}\": expected a term and its 1 sigma in per cent of its value, "
                    "such as \"bias_instability 5%\", or \"rate_random_walk detected 95%\""},
    {"requirement_chance",
     "--want \"{name}\": expected a chance below 100% after \"detected\", such as 95%"},
    {"requirements", "--want: there are more than {0} requirements"},
    {"no_such_noise", "--want \"{name}\": the model has no such noise term"},
    /* spectrum_log.c */
    {"too_few_for_spectrum",
     "{0} rows are too few for a spectrum; at least 64 are needed, and some thousands are useful"},
    {"segments_missing", "column {name}: every segment has missing samples; use a coarser "
                         "--resolution, or --gaps longest"},
    {"resolution", "--resolution {0g} Hz: {name}; this record of {1g} s at {2g} Hz allows about "
                   "{3.2g} Hz to {4.2g} Hz"},
    {"gaps", "{name}: {0} of {1} segments have missing samples and were left out"},
    {"lines", "{name}: more than {0} lines; the strongest are listed"},
    {"fit", "{name}: the noise parameters could not be fitted: {0t}"},
    {"misfit", "{name}: the four noise terms do not explain the spectrum (misfit {0.1f}, worst at "
               "{1.3g} Hz: {2.2f} times the fit); there is an output filter, a resonance or "
               "correlated noise: use imukit identify, or fit only a part with --from and --to"},
    /* convert_log.c, convert_motion.c */
    {"no_such_column",
     "--select: the log has no column \"{name}\"{0?}; did you mean \"{other}\"?{?}"},
    {"convert:no_axis", "{record} has no column {name}, which --{other} needs"},
    {"convert:counts", "{name} is in counts, and --{other} needs {0?}forces{0!}rates{?}; imukit "
                       "compensate converts counts with a model that states a sensitivity"},
    {"moves", "the unit moves in the first {0g} s ({1.3g} deg/s, {2.3g} m/s^2 rms), so roll and "
              "pitch are wrong accordingly; shorten --still"},
    {"gravity", "the mean force at rest is {0.4g} m/s^2, but gravity is {1.4g} m/s^2"},
    {"acceleration", "{0} rows have no neighbour with finite rates: their angular acceleration is "
                     "taken as zero"},
    {"drift",
     "the attitude comes from the gyros alone; at rest they were off by {0.3g} deg/h, which causes "
     "errors of up to {1.3g} deg and {2.3g} m/s^2 in the {3.4g} s of this log"},
    {"convert:not_finite", "{0} rows have no finite rates: the attitude was held"},
    /* evaluate_log.c */
    {"two_units", "{name} is in {other} in another"},
    {"too_many_readings", "there are more than {0} columns of readings"},
    {"too_many_runs", "more than {0} runs"},
    {"texts", "column {name} holds texts, expected numbers"},
    {"no_unit", "{name} has no unit; write it into the header, such as {name} [deg/s] or {name} "
                "[count]"},
    {"direction", "row {0}: direction \"{name}\"; expected up, down or -"},
    {"no_reading", "row {0}: {name} is not a number, or beyond 1e60; leave the row out"},
    {"no_sigma", "row {0}: sigma must be above 0"},
    {"no_readings", "{record} needs the columns reference and reading"},
    {"no_steps", "the reference never stays constant for {0.3g} s, and the figures need steps; for "
                 "sines use imukit calibrate --procedure rate-table"},
    {"reference_delay",
     "the reference comes {0.4f} s {1?}later{1!}earlier{?} than the readings (1 sigma {2.2g} s): "
     "{3?}the steps are compared as they stand, and the figures contain the delay{3!}it was moved "
     "by this time; --keep-delay leaves it{?}"},
    {"no_reference", "{record} does not contain the reference motion of the unit; add --motion "
                     "PROGRAMME, or columns reference_rate_z [deg/s] … or table_rate [deg/s] with "
                     "--table-axis; for a unit at rest use --static {record}"},
    {"no_change",
     "no axis has a reference that changes from stretch to stretch: there is nothing to compare"},
    {"static", "column {name} of the log at rest: {0t}"},
    /* navigate_log.c, navigate_align.c, navigate_run.c */
    {"column_of_counts",
     "{name} is in counts; imukit compensate converts counts to rates and forces"},
    {"no_sensor_column", "has no column {name}: navigation needs three gyros and three "
                         "accelerometers"},
    {"no_gravity_unit",
     "--standard-gravity needs accelerometer columns in g, mg or ug, and there are none"},
    {"align_empty", "no sample falls into --align {0.6g}s: the rows are {1.6g} s apart; align for "
                    "longer, or correct --rate or the timestamps"},
    {"align_whole",
     "is {0.6g} s long, so nothing is left after --align {1.6g}s; shorten the alignment"},
    {"compensate_first", "{name} states fixed errors of the {0?}accelerometer{0!}gyro{?}s; this "
                         "log is assumed to be free of them already (imukit compensate)"},
    {"no_gravity",
     "at rest the accelerometers read {0.4g} times gravity: {1?}their unit is probably {other}, "
     "not {name}{1!}their unit, {name}, is wrong{?}, or gravity was removed, or the unit moves"},
    {"standard_gravity",
     "at rest the accelerometers read {0.6f} times gravity, so g may mean 9.780327 m/s^2 in this "
     "log; if it does, add --standard-gravity \"9.780327 m/s^2\""},
    {"earth_rate",
     "at rest the gyros read {0.3g} times the Earth's rotation; {1?}their unit may be {other}, not "
     "{name}; {2?}if this is a bias, imukit compensate takes it out{2!}north cannot be found from "
     "such readings; take out the bias (imukit compensate) or add --heading"},
    {"axes", "the angle between force and rotation fits latitude {0.1f} deg, not {1.1f} deg: "
             "{2?}the sign of the latitude, of all gyros or of all accelerometers is wrong{2!}the "
             "axes are not forward-right-down (state them with --axes), or a bias is large"},
    {"north_unknown", "the biases of the gyros {0?}in the model hide{0!}hide{?} the Earth's "
                      "rotation, so north cannot "
                      "be found: the heading at the start is a guess; add --heading"},
    {"start_acceleration",
     "with the attitude given, the log begins with an acceleration of {0.3g} m/s^2: {1?}the unit "
     "of the accelerometers is probably {other}, not {name}{1!}the attitude, --axes or the unit of "
     "the accelerometers is wrong, or the log begins in motion"},
    {"bias_beyond_model",
     "at rest the gyros read {0.3g} deg/h beside the Earth's rotation, more than the biases of "
     "{name} explain: a bias of that size is assumed; state it in the model"},
    {"start_turning",
     "the log begins turning at {0.3g} deg/s, which is no rest, and no velocity was given: "
     "navigation begins with velocity 0; add --velocity \"NORTH EAST DOWN m/s\""},
    {"start_changing",
     "the force changes by {0.3g} m/s^2 in the first seconds, which is no rest, and no velocity "
     "was "
     "given: navigation begins with velocity 0; add --velocity \"NORTH EAST DOWN m/s\""},
    {"start_shaking",
     "the log begins shaking by {0.3g} m/s^2 rms, which is no rest, and no velocity was given: "
     "navigation begins with velocity 0; add --velocity \"NORTH EAST DOWN m/s\""},
    {"attitude_tilt",
     "the force at the start is {0.3g} deg off the vertical of --attitude, which is known to "
     "{1.2g} deg (1 sigma): the attitude or --axes is wrong, or the unit accelerates"},
    {"hemisphere",
     "the gyros read {0.3g} deg/h about the vertical downwards, where the Earth's rotation is "
     "{1.3g} deg/h: the sign of the latitude of --position is wrong, or of the gyros"},
    {"heading_off",
     "the Earth's rotation as the gyros read it says that the yaw of --attitude is {0.3g} deg too "
     "large ({1.2g} deg, 1 sigma)"},
    {"rotation_off",
     "the gyros read {0.3g}, {1.3g}, {2.3g} deg/h about north, east, down in --attitude, where "
     "the Earth's rotation is {3.3g}, {4.3g}, {5.3g} deg/h: the attitude, --position, --velocity "
     "or "
     "--axes is wrong, or a bias is larger than the model's"},
    {"pole", "within 1 deg of a pole there is no north to align to: give --attitude"},
    {"align_short", "--align {0.6g}s is too short to find an attitude; align for minutes"},
    {"rest_short", "--align {0.6g}s is too short to learn the readings at rest; {1g} s are needed"},
    {"model_axes", "navigation needs three gyros and three accelerometers"},
    {"navigation_failed", "{0t}"},
    {"updates_refused",
     "{0} of {1} updates were refused because they do not fit the model, first at {2.1f} s: the "
     "unit moved then, or the errors in the model are too small"},
    {"steady_motion", "{0.4g} s look like rest but begin with a velocity that is not 0; they are "
                      "treated as smooth motion and not used"},
    {"updates_lost", "the last {0} updates were all refused: the estimate is lost{1?}, or the unit "
                     "has moved smoothly since"},
    {"no_stop", "no standstill was {0?}found{0!}scheduled before the end of the log{?}, so there "
                "was no update"},
    {"model_too_good", "the innovations are {0.1f} times as large as the model predicts (squared: "
                       "{1.1f}): the errors in the model are too small"},
    {"left_the_earth",
     "at {0.3f} s the estimate is no longer near the Earth: it moves at {1.2g} m/s, {2.2g} m above "
     "the ellipsoid: an earlier reading is absurd; check the units of the log's columns, --position"
     "{3?}, and of the aid its latitude and longitude, or north and east, which may be swapped, "
     "its signs and --aid-lever-arm{?}"},
    {"sigma_lost",
     "at {0.3f} s a variance of the estimate is no longer above 0: the readings contradict each "
     "other; check the units of the log's columns, --position, and of the aid its latitude and "
     "longitude, or north and east, which may be swapped, its signs, its sigmas and "
     "--aid-lever-arm"},
    /* aid_columns.c, aid_readings.c, navigate_aids.c */
    {"aid_unit",
     "column {name} has no unit: write it into the header, such as {name} [{other}], or "
     "into --aid-map"},
    {"aid_dimension", "the unit of column {name} does not fit; expected one such as {other}"},
    {"aid_partial", "there is a column of {name}, but none of {other}, which goes with it"},
    {"aid_twice", "two columns are {name}; leave one of them out with --aid-map"},
    {"aid_no_time", "there is no time column; readings need times on the clock of the log"},
    {"aid_no_column", "there is no column of the {name}, which --aid-sigma names"},
    {"aid_no_sigma",
     "the sigma of the {name} is not known: add columns of it, or state it, such as "
     "--aid-sigma \"position 1 m, velocity 0.05 m/s\""},
    {"aid_nothing",
     "no column has a known name of a position (latitude, longitude, height; ecef_x …; north, "
     "east, down), velocity (velocity_north …), heading, baro_height or speed; name them with "
     "--aid-map, such as \"time=t [s],latitude=Lat [deg],longitude=Lon [deg]\""},
    {"aid_empty", "no row has a reading that can be used"},
    {"aid_other_clock",
     "the readings are from {0.10g} to {1.10g} s, but the log from {2.10g} to {3.10g} s: both must "
     "be on one clock; --aid-delay TIME subtracts TIME from the times of the readings"},
    {"aid_unreadable", "{0t}"},
    {"aid_not_used", "{name} in {other} is not used, as its sigma is not known; add it to "
                     "--aid-sigma, if it shall be used"},
    {"aid_damaged", "{0} row{0s} of {name} cannot be read and are left out"},
    {"aid_disordered", "{name} in {other}: {0} of {1} readings are not later than the one before: "
                       "left out"},
    {"aid_order", "{0} of {1} readings of the {name} are not later than the one before: sort the "
                  "rows by time, and check that the time column is the right one"},
    {"aid_skipped", "{name} in {other}: {0} of {1} readings cannot be used: left out"},
    {"aid_unused",
     "{name} in {other}: none of {0} readings is used: they are from {1.6g} to {2.6g} s, and the "
     "log is navigated from {3.6g} to {4.6g} s{5?}; --aid-until leaves none{5!}; check the time "
     "column and its unit, --align and --aid-delay{?}"},
    {"aid_time_unit",
     "{name} in {other}: {0} of {1} readings are used: they are from {2.6g} to {3.6g} s, and the "
     "log is from {4.6g} to {5.6g} s, which differ by a factor of 1000 as ms and s do: check the "
     "units of both time columns, and write the true one into the header"},
    {"aid_start_off",
     "the first position in {other} is {0.4g} m from --position; the position at the start is "
     "taken "
     "to be so uncertain{1?}; with latitude and longitude exchanged it would be there: they are "
     "probably swapped, in the table or in --position{?}{2?}; with the other sign of the latitude "
     "it would be there: one of the two signs is probably wrong{?}{3?}; with the other sign of the "
     "longitude it would be there: one of the two signs is probably wrong{?}"},
    {"aid_refused", "{name} in {other}: {0} of {1} readings were refused because they do not fit "
                    "the prediction, first at {2.1f} s: they are wrong then, or the sigmas or the "
                    "errors in the model are too small"},
    {"aid_recovered",
     "{name} in {other}: after many refusals in a row the estimate was taken to be wrong, and its "
     "sigmas were enlarged so that a reading fitted, {0} time{0s}, first at {1.1f} s"},
    {"aid_doubt",
     "{name} in {other}: {0.2g} % were refused: the sigmas that are stated hold only if those "
     "readings were wrong and all others right; else look for an offset of time (--aid-delay), a "
     "wrong lever arm, sigmas that are too small, swapped axes or wrong signs{2?}; those refused "
     "look about {1.2g} s late, as with --aid-delay={4.2g}s, or with a lever arm that is wrong "
     "along the way{?}{3?}; those refused look about {1.2g} s early, as with --aid-delay={4.2g}s, "
     "or with a lever arm that is wrong along the way{?}"},
    {"aid_lost", "{name} in {other}: the last {0} readings were all refused: the estimate is lost, "
                 "or the readings are wrong"},
    {"aid_too_good", "{name} in {other}: the innovations are {0.1f} times as large as predicted "
                     "(squared: {1.1f}): its sigma, or the errors in the model, are too small"},
    {"aid_correlated",
     "{name} in {other}: an innovation has {0.0f} % of the one before in it: its errors are not "
     "independent from reading to reading, so that the estimate is worse than predicted; state "
     "how, as in --aid-sigma \"{name} SIGMA correlated SIGMA over TIME\", or use fewer readings "
     "(--aid-interval)"},
    /* calibrate: session_record.c */
    {"calibrate:time_order",
     "{record}: {0} rows whose time does not increase, or is not a number, are left out"},
    {"calibrate:not_finite",
     "{record}: in {0} of {1} rows a reading or the temperature is not finite, or beyond 1e60, "
     "first in row {2}; these rows, or the hold or step that they interrupt, are left out"},
    {"calibrate:fill_rows",
     "{record}: in {0} of {1} rows, first in row {2}, all {name} axes have {3?}the value 0"
     "{3!}the same values{?}, while the rows before and behind are far from there: a logger wrote "
     "them where it had no reading, and they change the scale factors by the share of the rows; "
     "mend the logger and repeat the test"},
    {"axis_gap", "{record} has {name}: calibration needs the axes x, y, z in this order; name the "
                 "columns with --columns"},
    {"turns_without_accel",
     "{name}: turns uses the gyros only; ferraris (six faces and these turns) or multiposition (20 "
     "attitudes) calibrates the accelerometers too, and says more of bias and g-sensitivity"},
    {"axis_renamed", "{name} is axis {other} in the tables and in the model, which states its "
                     "direction"},
    {"axes_named", "{record} has other {name} axes than the other logs: name them alike, in the "
                   "header or with --columns"},
    {"counts_mixed", "some {name} columns are in counts and some are not"},
    {"no_sensor",
     "{record} has no gyro and no accelerometer column; name them with --columns, such as "
     "time,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z"},
    {"no_section", "{record} has no text column \"{name}\" to divide it into sections{0?}; did you "
                   "mean \"{other}\"?{?}"},
    {"one_row_of_test", "{record} has one row of data; a test needs thousands, some seconds of "
                        "each pose or step"},
    {"longer_than_record", "--{name} {0.6g}s is longer than {record}, which has {1.4g} s"},
    {"sections", "{record} has {0} text columns; name the one that divides it into sections, such "
                 "as --section {name}"},
    /* calibrate: pose_means.c, calibrate_observe.c */
    {"means_motion",
     "{record}: --motion says at which time which force acts, and a table of pose "
     "means has no times: add columns reference_force_x [g] and so on, the force of "
     "each row"},
    {"means_of_log",
     "{record} looks like a log, not like a table of pose means: of its {0} rows most have nearly "
     "the same attitude as the row before. Leave --pose-means out; if each row is the mean of a "
     "pose, add a column samples, the number of samples in it"},
    {"means_both",
     "{record} has {name} and {other}: one says how well the mean is known; leave the "
     "other one out"},
    {"means_incomplete",
     "{record} says how well some means are known, but not that of {name}: add {name}_std or "
     "{name}_std_of_mean, or leave such columns out on all axes of the sensor"},
    {"means_no_samples",
     "{record}: {name} is the standard deviation of the samples; add a column samples with their "
     "number. If it is that of the mean, name it {name}_of_mean"},
    {"means_std", "{record}: row {0}: {name} is {2?}{1g}{2!}not a number{?}; expected a standard "
                  "deviation above 0 in each row"},
    {"means_samples", "{record}: row {0}: {name} is {2?}{1g}{2!}not a number{?}; expected the "
                      "number of samples in the mean, 1 or more"},
    {"means_no_number", "{record}: row {0} has no number in {name}: complete this row, or delete "
                        "it"},
    {"means_increments", "{record}: {name} holds increments; --pose-means needs the mean rate or "
                         "force of each pose: gyro_x [deg/s], accel_x [g]"},
    {"calibrate:equal_rows",
     "{record}: the readings of rows {0} and {1} are equal on all axes{3?}, and of {2} more "
     "rows{?}: a row that was copied counts twice; delete it"},
    {"means_mixed",
     "{record} does not say how well the {name} means are known, and other logs observe the "
     "{name}s, "
     "too: add columns {other}_x_std and so on with samples, or calibrate without the other logs"},
    {"means_noise",
     "{record} does not say how well the {name} means are known, and {0} readings leave {1.1f} "
     "degrees of freedom to see it by their scatter; {2} are needed: add columns {other}_x_std and "
     "so on with samples, or more poses, also of attitudes that are there"},
    {"mag_counts", "the magnetometer columns of {record} have no unit, or are in counts: state it "
                   "in the header, such as mag_x [uT]"},
    {"no_magnetometer", "{record} has {0} of the columns mag_x, mag_y, mag_z, and --procedure "
                        "magnetometer needs all three; name them with --columns"},
    {"magnetometer_only", "{record} has a magnetometer, but no gyro and no accelerometer; "
                          "imukit calibrate --procedure magnetometer calibrates it"},
    /* magnetometer_findings.c, calibrate_magnetometer.c */
    {"mag_stuck", "{other}: {name} never changes its reading, so the magnetometer is not "
                  "calibrated: the axis is dead, or the column holds something else"},
    {"mag_saturated", "{other}: {name} stays at {0.4g} uT for 20 updates or more, while it changes "
                      "elsewhere, so the magnetometer is not calibrated: this is the end of its "
                      "range; keep away from magnets, or choose a larger range"},
    {"mag_held", "{name}: {0} of {1} magnetometer rows are new, the others repeat the row before: "
                 "the sensor is slower than the log, and repeated rows count once"},
    {"mag_not_used", "the magnetometer is not calibrated: only the procedures multiposition and "
                     "magnetometer do so"},
    {"mag_counts_left",
     "the magnetometer is in counts and is not calibrated: state the unit of its "
     "columns in the header, such as mag_x [uT]"},
    {"mag_no_use_of_field", "--field and --dip are for magnetometers, and none is calibrated here"},
    {"mag_not_named", "the magnetometer is left as it is, because --estimate names other terms"},
    {"mag_many", "the magnetometer is left out: {0} other parameters are estimated, and there is "
                 "room for {1} in all; leave some out with --estimate or --without"},
    {"mag_few", "{0} attitudes are too few to calibrate the magnetometer: use 20 or more"},
    {"mag_coverage",
     "the attitudes do not determine hard and soft iron of the magnetometer: the "
     "directions of the field are too much alike (spread {0.2g}, 0.33 at best); "
     "add attitudes with the field of the Earth along {name} of the unit. It points "
     "north, and steeply down in the north of the Earth, up in the south"},
    {"mag_weak", "hard or soft iron of the magnetometer is known to {0.2g} % of the field only (1 "
                 "sigma); the directions of the field have a spread of {1.2g}, 0.33 at best. Add "
                 "attitudes with the field of the Earth along {name} of the unit, and stay longer "
                 "in each. It points north, and steeply down in the north of the Earth, up in the "
                 "south"},
    {"mag_shape",
     "the magnetometer reads {0.2g} times as much in one direction as in another, which no "
     "soft iron does: its columns have different units, or one of them is not its own"},
    {"mag_axes", "the axes of the magnetometer are not those of the accelerometers, so it is not "
                 "calibrated. Either {name}, in a field that points {0.0f} deg {1?}down{1!}up{?}; "
                 "or {other}, in a field that points {0.0f} deg {1?}up{1!}down{?}. What decides is "
                 "where the field points: down in the north of the Earth, up in the south; give "
                 "--position or --dip. If the magnetometer is right, the axes of all other sensors "
                 "are wrong in the same way. Correct the columns (names: in the header or with "
                 "--columns; signs: in the values)"},
    {"mag_axes_known",
     "the axes of the magnetometer are not those of the accelerometers, so it is "
     "not calibrated: {name}, in a field that points {0.0f} deg "
     "{1?}down{1!}up{?}, as at this place, explains the log. If the magnetometer "
     "is right, the axes of all other sensors are wrong in the same way. Correct "
     "the columns (names: in the header or with --columns; signs: in the values)"},
    {"mag_inverted",
     "the field points {0.0f} deg {1?}down{1!}up{?} by the signs of magnetometer and "
     "accelerometers, and the other way at this place, so the magnetometer is not "
     "calibrated: either all three axes of the magnetometer are inverted, or all "
     "accelerometers (an accelerometer whose axis points up reads +9.8 m/s^2 at "
     "rest)"},
    {"mag_mounting", "the magnetometer is turned by {0.3g} deg against the nearest order of axes "
                     "({name}); the model describes it as it is. Check its axes"},
    {"mag_scale_unit",
     "the magnetometer reads a field of {0.4g} uT where --field says {1.4g} uT, so it is not "
     "calibrated: {2?}--field looks like{?}{2!}the columns look like{?} {name}; correct the unit"},
    {"mag_scale_useless",
     "the magnetometer reads a field of {0.4g} uT where --field says {1.4g} uT, so it is not "
     "calibrated: no sensor errs by so much. The unit of the columns or of --field is wrong, its "
     "range is another one, or a magnet or steel is near"},
    {"mag_scale",
     "the magnetometer reads a field of {0.4g} uT where --field says {1.4g} uT: the unit "
     "of the columns or of --field is wrong, or steel is near"},
    {"mag_field",
     "the field is {0.4g} uT by the magnetometer, but that of the Earth is 22 to 67 uT: "
     "the unit of the columns is wrong, or a magnet or steel is near"},
    {"mag_field_unit", "the field is {0.4g} uT by the magnetometer, but that of the Earth is 22 to "
                       "67 uT: the columns look like {name}; correct the header"},
    {"mag_dip",
     "the dip of the field is {0.4g} deg by the log and {1.4g} deg by --dip: steel is near, "
     "or one of the two is wrong"},
    {"mag_disturbed", "the field is not the same in all attitudes: it differs by {0.3g} uT rms "
                      "({2.2g} % of it), {1.3g} times what the noise explains. Steel, a motor or a "
                      "current is near, or turns with the unit only in part; turn the unit about "
                      "one point, a metre or more from the ground, from furniture and from walls. "
                      "The intervals hold only if the excess is random"},
    {"mag_outliers", "{0} of {1} {2?}readings{2!}rests{?} of the magnetometer do not fit the "
                     "others and are left out: "
                     "the field was another one there; turn the unit about one point, away from "
                     "steel"},
    {"mag_left_out", "{0} of {1} {2?}readings{2!}rests{?} of the magnetometer do not fit the "
                     "others and are left out"},
    /* calibrate_exposure.c */
    {"calibrate:no_unit",
     "{record}: {name} has no unit; write it into the header, such as {name} [{other}]"},
    {"wrong_unit", "{record}: {name} should be {other}"},
    {"no_table_rate", "{record} has no column table_rate [deg/s], which --table-axis needs"},
    {"no_table_axis",
     "{record} has a column table_rate; state the axis of the unit about which the "
     "table turns it, such as --table-axis z"},
    {"reference_twice",
     "{record} has reference columns and --motion gives another reference; leave "
     "one of them out"},
    {"programme_not_followed",
     "{record} does not follow the programme at any offset within {0.3g} s (the best correlation "
     "is {1.2f}); check that this programme was run"},
    {"programme_begins", "{record}: the programme begins at {0.4f} s of the log (1 sigma {1.2g} s, "
                         "correlation {2.4f})"},
    {"rival:motion_offset", "{record}: the programme fits nearly as well from {0.4f} s on; if that "
                            "is right, add --motion-offset {0.4f}s"},
    {"calibrate:motion_offset",
     "{record} fits the programme best if the programme begins {0.4f} s {1?}later{1!}earlier{?} "
     "than stated (1 sigma {2.2g} s); use --motion-offset {3.4f}s, or auto"},
    {"calibrate:reference_offset",
     "{record}: the {name} readings are {0.3g} s {1?}behind{1!}ahead of{?} the columns {other} (1 "
     "sigma {2.2g} s), and the ends of steps that are left out are shorter: the clocks of both "
     "differ; shift the columns by as much"},
    {"calibrate:reference_force",
     "{record}: at rest the reference_force columns are {0.4g} m/s^2, and gravity is 9.81: "
     "{1?}they look like {name}; correct the unit in the header{1!}check their unit{?}"},
    {"calibrate:reference_direction",
     "{record}: the accelerometers do not read the reference_force of the columns (cosine between "
     "them {0.2f}): {1?}the columns have the opposite sign, as gravity has and specific force, "
     "which is upwards at rest, has not; turn their signs round{1!}check signs and order of their "
     "axes{?}"},
    {"calibrate:not_aligned",
     "{record} fits the programme at no single offset: the clock of the log may run faster or "
     "slower "
     "than that of the programme (check --rate, or the times), or another programme was run"},
    {"calibrate:clock", "{record}: the second half of the log is {0.3g} s {2?}later{2!}earlier{?} "
                        "against the programme "
                        "than the first: the clock of the log runs {1.2g} % too "
                        "{2?}fast{2!}slow{?}, as if the sampling rate were "
                        "{3.5g} Hz and not {4.5g} Hz; check --rate, or the times"},
    /* calibrate_set_up.c */
    {"counts_of_axes",
     "--{name}-sensitivity, --{name}-range and --{name}-zero take one number, or one for each of "
     "{0} axes"},
    {"no_range", "--{name}-range: the full scale must be above 0"},
    {"no_sensitivity", "--{name}-sensitivity: a sensitivity of 0 makes no counts"},
    {"zero_of_nothing", "--{name}-zero needs --{name}-sensitivity"},
    {"not_in_counts", "--{name}-{0?}sensitivity{0!}zero{?} is for readings in counts, but those of "
                      "{record} have a unit"},
    {"axes_differ", "{record} has {0} {name} axes and the other logs have {1}"},
    {"counts_differ", "{record}: its {name} readings are in counts and those of other logs are "
                      "not, or the reverse"},
    {"axes_of_model", "{model} has {0} {name} axes, but the log has {1}"},
    {"model_of_residuals",
     "{model} describes the errors left after compensation with \"{name}\"; calibrate the log "
     "before it was compensated, with that model and --into"},
    {"calibrate:gravity",
     "the place is not known: gravity is taken as {0.5f} m/s^2 (45 deg, sea level). Local gravity "
     "may differ by up to 0.3 %, which goes into the scale factors; add --position \"48.1 deg, "
     "11.6 deg, 520 m\" or --gravity 9.80780m/s^2"},
    {"calibrate:gravity_of_place",
     "--gravity {0.5f} m/s^2 differs by {2.2g} % from gravity at --position, {1.5f} m/s^2; real "
     "gravity differs by 0.05 % at most. The difference goes into the scale factors of the "
     "accelerometers: correct one of the two"},
    {"range_below_gravity",
     "the full scale of {name} is stated as {0.4g} m/s^2 (--accel-range, or the model), which is "
     "below gravity: rests with more than that are left out as saturated; state that of the data "
     "sheet, such as --accel-range 16g"},
    /* calibrate_terms.c */
    {"no_term", "--estimate names no term"},
    {"no_change_of_temperature", "no log has a column temperature [degC] that changes, so no term "
                                 "of temperature can be estimated"},
    /* calibrate_closed_form.c, power_cycles.c, calibrate_model.c */
    {"stretches", "there are more than {0} holds and turns"},
    {"many_runs", "there are more than {0} runs"},
    {"few_runs", "{0} run: at least two are needed, better ten; give a log for each power cycle, "
                 "or one log with a column of texts that names the runs (--section NAME)"},
    {"models_of_units", "{other} and {record} do not have the same {name} axes, so they are not "
                        "runs of one unit"},
    {"models_of_counts", "the {name} readings are in counts in one of {other} and {record} and not "
                         "in the other"},
    {"models_of_frames", "{record} is in the frame \"{other}\", the first model in \"{name}\": "
                         "calibrate all runs with the same --frame"},
    {"model_without_sigma", "{record} states no uncertainty of bias or scale factor: give the "
                            "models that imukit calibrate wrote, one of each run"},
    {"one_model", "1 run: at least two are needed, better ten; give the model of each power cycle"},
    {"no_uncertainty",
     "there is no bias and no scale factor that all of these models state with an uncertainty"},
    {"attitude", "the forces of the runs differ by up to {0.3g} mrad: was the unit moved? A change "
                 "of attitude looks like a change of accelerometer bias; keep the attitude fixed, "
                 "or state how accurately the unit is put back with --placement 0.1deg"},
    {"temperature_left_out", "{name}: the other effects of temperature are left out: {0t}"},
    /* compensate_magnetometer.c, compensate_columns.c */
    {"magnetometer_left", "the magnetometer is copied as it is: it takes columns mag_x, mag_y and "
                          "mag_z with a unit, and "
                          "a model of three axes without a sensitivity"},
    {"no_counts", "{record}: {name}, but {model} describes readings in counts ({0k}.sensitivity)"},
    {"counts", "{record}: {name} is in counts, but {model} does not say what a count is: add "
               "{0k}.sensitivity to it"},
    {"increments_in_counts",
     "{record}: {name} holds increments in counts; expected counts of {0q}"},
    {"no_axis",
     "{record} has no column {name}: {model} describes {0} {1k} axes, and all of them are needed"},
    {"axes_do_not_match", "{record} has {0} {1k} columns, but {model} describes {2}; name the "
                          "log's columns with --columns, and write - for a column to skip"},
    {"temperature_of_no_sensor",
     "the temperature is {0.6g} K, which is {1.6g} degC, and no inertial sensor works below -100 "
     "or "
     "above 200 degC{2?}: write {0.6g}degC if that is meant{?}{3?}: write {1.6g}K if that is "
     "meant{?}"},
    {"simulate:temperature_unknown",
     "the model's temperature terms are left out: add --temperature 25degC or a profile"},
    {"simulate:no_attitude", "the magnetometer is left out: {record} states rates and forces, but "
                             "not the attitude in the field"},
    {"simulate:vibration", "the vibration needs {0} parts per sample, but {1} are the most; its "
                           "effect is wrong below --rate {2.0f}Hz"},
    {"compensate:no_sensor", "{record} has no gyro and no accel column: name them with --columns"},
    {"sensor_needed", "{record} has no {0k} columns, which {name} of {model} needs"},
    {"not_in_model", "{model} describes no {0p}: the columns are copied as they are"},
    {"no_sensor_in_model", "{model} describes none of the sensors in {record}"},
    {"no_room_for_flags", "there is no room for a column of flags beside {0} others"},
    /* compensate_log.c */
    {"no_temperature", "{model} depends on temperature ({name}), but {record} has no temperature "
                       "column; add --temperature 25degC"},
    {"temperature_counts", "{model} depends on temperature ({name}), but {record} has it in counts "
                           "only; add --temperature 25degC"},
    {"residual", "{model} describes the errors that remain after compensation with {name}; "
                 "compensate with that model first"},
    {"nothing", "{model} has no deterministic term{name}: there is nothing to take out"},
    {"no_limit", "{model}: {name} is missing, and the correction needs a limit; state {name} in "
                 "the model, or add --rate-limit 500deg/s or --force-limit 10g"},
    {"model_refused", "{model}: {0t}"},
    {"not_written", "{0t}"},
    {"compensate:axes_of_counts", "--axes changes signs, and counts have a zero offset; compensate "
                                  "first, then use imukit convert --axes"},
    {"compensate:saturated", "saturated, at or beyond the range of an axis" SAMPLES_FIRST},
    {"compensate:temperature", "temperature outside the valid range of the model's terms, so the "
                               "nearer end of the range was used" SAMPLES_FIRST},
    {"compensate:limit", "corrected values beyond the limits up to which the correction is "
                         "proven" SAMPLES_FIRST},
    {"compensate:not_finite", "readings that are not finite, or no temperature yet; values that "
                              "depend on these are nan" SAMPLES_FIRST},
    {"compensate:acceleration",
     "angular acceleration for the lever arms unknown, or from a saturated rate" SAMPLES_FIRST},
    {"temperature_held", "temperature missing, so the last one was used: {0} of {1} samples"},
    {"time_missing", "the time is not finite" SAMPLES_FIRST
                     "; it is taken as one sample interval after the sample before"},
    {"compensate:gaps",
     "gaps and steps back in time: {0} (first: row {1}); each begins a new stretch"},
    /* physics_log.c, physics_warnings.c */
    {"output_not_finite", "{name} is not finite at {0g} s; " NEARER},
    {"statistics_not_finite", "the scatter of {name} is beyond what a number can hold; " NEARER},
    {"range", "the input of {0u} is beyond the range of {2u}"},
    {"physics:saturated", "the output ends saturated, at {1u}; the input is {0u}"},
    {"dead_band", "the input of {0u} is within the dead band of {3u}: the output does not follow "
                  "it"},
    {"not_followed", "the output ends at {1u}, the input is {0u}"},
    {"scattered", "samples scatter by {4u}, too much to show that the output, {1u} at the end, "
                  "follows the input of {0u}"},
    {"physics:temperature",
     "{0.4g} degC is outside the temperature range of this design, {1.4g} to {2.4g} degC"},
    {"physics:touched",
     "the ball touched its stop at {name} after {0.5g} s{5?}, at {5.3g} m/s{?}, under {1.5g} m/s^2 "
     "({2.5g} g): the suspension carries {3.5g} m/s^2 ({4.5g} g) along each axis; since then the "
     "readings are those of a ball that drags on the stop or was slowed down by it"},
    /* grade_position.c */
    {"nothing_to_grade", "states no bias repeatability, no bias instability and no uncertainty of "
                         "the fixed bias: there is nothing to grade"},
    {"bridged", "{0} of {1} samples are missing or bad: bridged by straight lines"},
};

static const char *message_of(const imk_finding *finding)
{
    for (size_t k = 0; k < sizeof messages / sizeof messages[0]; k++)
        if (strcmp(messages[k].code, finding->code) == 0)
            return messages[k].text;
    return finding->code;
}

size_t imk_finding_text(const imk_finding *finding, char *text, size_t size)
{
    imki_finding_writing w = {text, size, 0, "the record", "the model"};
    return imki_finding_fill(&w, message_of(finding), finding);
}

size_t imk_finding_message(const imk_finding *finding, const char *record, const char *model,
                           char *text, size_t size)
{
    const char *message = message_of(finding);
    imki_finding_writing w = {text, size, 0, record ? record : "the record", model};
    if (record && finding->level == IMK_FINDING_FAILURE && !strstr(message, "{record}") &&
        !strstr(message, "{model}")) {
        imki_finding_put(&w, record, strlen(record));
        imki_finding_put(&w, ": ", 2);
    }
    return imki_finding_fill(&w, message, finding);
}

const char *imk_finding_code(const imk_finding *finding)
{
    const char *colon = strchr(finding->code, ':');
    return colon ? colon + 1 : finding->code;
}
