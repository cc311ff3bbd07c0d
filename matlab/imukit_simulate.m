function result = imukit_simulate (varargin)
% imukit_simulate  Readings of a sensor unit with all its errors.
%
%   R = imukit_simulate (MODEL, 'rate', RATE, 'duration', DURATION, NAME, VALUE, ...)
%
% MODEL is the name of a model file, a name of "imukit devices", the text of a model file, or a
% result of imukit_identify or imukit_calibrate.
%
% R.data has a row for each sample: time, gyros, accelerometers, magnetometer and temperature, as
% R.columns names them, in SI units ("gyro_x [rad/s]") or counts where the model has a sensitivity.
% They are the numbers of a log of "imukit simulate" with the same options. A row that is lost
% (timing: drops) is not there.
%
% Options are those of the command, with _ for -. Numbers are in SI units; a text states its unit:
%   'rate', 'duration'    [Hz], [s]
%   'seed', 'run'         whole numbers; 1 and 0
%   'motion', 'temperature'   files; a temperature may be '25degC'
%   'latitude', 'height', 'roll', 'pitch', 'yaw'   of a unit at rest [rad], [m]
%   'no_earth'            true: without Earth rate and gravity
%   'only', 'without'     terms of the model
%   'increments'          true: of angle and velocity
%   'truth'               a file for the true motion
%
% Example:
%   s = imukit_simulate ('tactical', 'rate', 100, 'duration', 60, 'latitude', '48 deg');
%   plot (s.data(:, 1), s.data(:, 2))
%
% See also imukit_identify.

% SPDX-License-Identifier: Apache-2.0
  result = imukit_call ('simulate', varargin);
end
