function result = imukit_calibrate (varargin)
% imukit_calibrate  Bias, scale factor and misalignment from logs of bench tests.
%
%   R = imukit_calibrate (FILE, 'procedure', PROCEDURE, NAME, VALUE, ...)
%   R = imukit_calibrate (X, RATE, 'columns', NAMES, 'procedure', PROCEDURE, ...)
%   R = imukit_calibrate ({FILE, FILE, ...}, 'procedure', {PROCEDURE, PROCEDURE, ...}, ...)
%   R = imukit_calibrate ({X, X, ...}, RATE, 'columns', NAMES, 'procedure', ...)
%
% FILE, X, RATE and NAMES are as of imukit_allan; RATE and NAMES hold for all matrices. PROCEDURE is 'multiposition' for a unit turned by
% hand from rest to rest, 'sixposition', 'ferraris', 'turns', 'rate-table', 'tumble', 'centrifuge',
% 'spin', 'thermal', 'magnetometer' or 'repeatability' (docs/calibrate.md).
%
% R is what jsondecode makes of "imukit calibrate --json" (docs/json.md):
%   R.result.parameters(k)          name, value, sigma, lower, upper, unit
%   R.result.usability              grade, sentence: what the result can be used for
% R.model is the model as the text of a model file; it is not there where the result is not usable.
%
% Options are those of the command, with _ for -. Numbers are in SI units; a text states its unit:
%   'position'     '48.1 deg, 11.6 deg, 520 m', for gravity and the Earth's rotation
%   'gravity'      [m/s^2]
%   'estimate', 'with', 'without'   terms
%   'model', 'into'    what is known before, as a file, a text or a result
%   'motion', 'section', 'placement', 'frame' ...   about the test
%   'output'           also write the model to this file
%   'plot', 'report'   a file to draw into, .svg; a page, .html
%
% Example:
%   r = imukit_calibrate ('poses.csv', 'procedure', 'multiposition', 'gravity', 9.80743);
%   r.result.parameters(1)
%
% See also imukit_identify, imukit_simulate.

% SPDX-License-Identifier: Apache-2.0
  result = imukit_call ('calibrate', varargin);
end
