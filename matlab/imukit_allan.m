function result = imukit_allan (varargin)
% imukit_allan  Allan deviations of a log with confidence intervals.
%
%   R = imukit_allan (FILE, NAME, VALUE, ...)
%   R = imukit_allan (X, RATE, 'columns', NAMES, NAME, VALUE, ...)
%   R = imukit_allan ({FILE, FILE, ...}, NAME, VALUE, ...)
%   R = imukit_allan ({X, X, ...}, RATE, 'columns', NAMES, NAME, VALUE, ...)
%
% FILE is a log as the command "imukit allan" reads it. X is a real matrix of class double with a
% row for each sample and a column for each channel, RATE the sampling rate [Hz], or [] where a
% column is the time. NAMES say what the columns are: 'gyro_x', 'accel_z', 'time', 'temperature',
% or 'gyro' and 'accel' for three each. Units are SI, or in brackets: 'gyro [deg/s]'. '-' skips a
% column. NaN stands for a missing sample. RATE and NAMES hold for all matrices, of which there are
% up to 8, as of files.
%
% R is what jsondecode makes of "imukit allan --json" (docs/json.md), but for the points, which are
% columns: R.result.channels(k) has name, statistic and points with the columns tau, deviation,
% lower, upper, edf, count, noise and used, and the units of the first four in units. Of several
% logs it is R.result.logs(l).channels(k). Warnings in R.findings are given as warnings, too, with
% the identifier imukit:CODE.
%
% Options are those of the command, with _ for -. Numbers are in SI units; a text states its unit:
%   'statistic'   'oadev' (default), 'adev', 'mdev', 'hdev' ..., or a cell array of them
%   'tau'         averaging times [s], or 'octave' (default), 'decade', 'many', 'all'
%   'confidence'  of the intervals, 0.95
%   'gaps'        'keep' (default), 'bridge', 'longest', 'refuse'
%   'rate', 'axes', 'gyro_unit', 'after', 'before' ...   how to read the log
%   'plot', 'report'   a file to draw into, .svg; a page, .html
%
% Example:
%   x = 1e-3 * randn (36000, 3);
%   r = imukit_allan (x, 100, 'columns', 'gyro');
%   p = r.result.channels(1).points;
%   loglog (p.tau, p.deviation)
%
% See also imukit_identify.

% SPDX-License-Identifier: Apache-2.0
  result = imukit_call ('allan', varargin);
end
