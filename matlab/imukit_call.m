function result = imukit_call (verb, values)
% SPDX-License-Identifier: Apache-2.0
% RESULT = imukit_call (VERB, VALUES)
%
% Run a verb of imukit with the arguments of imukit_VERB, a cell array. For these functions only.
  if exist ('imukit_gateway', 'file') ~= 3
    error ('imukit:gateway', ['imukit_gateway is not compiled, or not beside imukit_call.m. ' ...
      'For Octave run "make octave" and addpath build/octave; for MATLAB see docs/matlab.md.']);
  end
  if ~isempty (values) && exist ('convertStringsToChars') %#ok<EXIST>
    [values{:}] = convertStringsToChars (values{:});
  end
  result = imukit_gateway (verb, values{:});
end
