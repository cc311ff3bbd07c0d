function result = imukit_drift (varargin)
% imukit_drift  Position error of a navigator after a time, and the terms that cause it.
%
%   R = imukit_drift (MODEL, NAME, VALUE, ...)
%   R = imukit_drift ({MODEL, MODEL, ...}, NAME, VALUE, ...)
%
% MODEL is the name of a model file, a name of "imukit devices", the text of a model file, or a
% result of imukit_identify or imukit_calibrate.
%
% R is what jsondecode makes of "imukit drift --json" (docs/json.md): R.result.models(k) has the
% figures at each time, and the budget of the terms.
%
% Options are those of the command, with _ for -. Numbers are in SI units; a text states its unit:
%   'duration'    [s]; or 'times', some of them: [60 600 3600]
%   'want'        a requirement, 'CEP 1 nmi @ 1h': how small each term must be
%   'aligned'     'given' (default) or 'self'
%   'initial_attitude', 'initial_velocity', 'initial_position'   texts: '0.05 deg'
%   'latitude', 'height', 'roll', 'pitch', 'yaw'   of a unit at rest [rad], [m]
%   'motion'      a file
%   'compensated', 'assume_class', 'only', 'without'
%   'aid'         a text or a cell array of them: 'gnss position 1 m at 1 Hz until 600 s'
%   'monte_carlo', 'seed'   whole numbers
%   'plot', 'report'   a file to draw into, .svg; a page, .html
%
% Example:
%   r = imukit_drift ('tactical', 'times', [60 600 3600]);
%
% See also imukit_identify.

% SPDX-License-Identifier: Apache-2.0
  result = imukit_call ('drift', varargin);
end
