function result = imukit_identify (varargin)
% imukit_identify  Noise model of a sensor at rest, with confidence intervals and a verdict.
%
%   R = imukit_identify (FILE, NAME, VALUE, ...)
%   R = imukit_identify (X, RATE, 'columns', NAMES, NAME, VALUE, ...)
%   R = imukit_identify ({FILE, FILE, ...}, 'runs', true, ...)
%   R = imukit_identify ({X, X, ...}, RATE, 'columns', NAMES, 'runs', true, ...)
%
% FILE, X, RATE and NAMES are as of imukit_allan; RATE and NAMES hold for all matrices.
%
% R is what jsondecode makes of "imukit identify --json" (docs/json.md):
%   R.result.channels(k).terms.angle_random_walk   present, value, sigma, lower, upper, unit
%   R.result.usability.sentence                    what the log is good for
%   R.result.verdict(k)                            level, code and message
% R.model is the model as the text of a model file, which imukit_drift and imukit_simulate take, as
% they take R itself.
%
% Options are those of the command, with _ for -. Numbers are in SI units; a text states its unit:
%   'confidence'    of intervals and bounds, 0.95
%   'significance'  chance that an absent term is reported, 0.01
%   'keep'          what is not taken out: 'outliers', 'stuck', 'saturated', 'warm-up',
%                   'temperature', 'all'
%   'name'          name of the model
%   'into'          a model of which only the noise is replaced
%   'output'        also write the model to this file
%   'rate', 'axes', 'gyro_unit', 'after', 'before' ...   how to read the log
%   'plot', 'report'   a file to draw into, .svg; a page, .html
%
% Example:
%   s = imukit_simulate ('AHRS', 'rate', 100, 'duration', 600);
%   r = imukit_identify (s.data, [], 'columns', s.columns);
%   r.result.channels(1).terms.angle_random_walk.value
%
% See also imukit_allan, imukit_drift, imukit_simulate.

% SPDX-License-Identifier: Apache-2.0
  result = imukit_call ('identify', varargin);
end
