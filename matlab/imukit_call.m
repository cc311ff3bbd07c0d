function result = imukit_call (verb, arguments)
% SPDX-License-Identifier: Apache-2.0
% RESULT = imukit_call (VERB, ARGUMENTS)
%
% Run a verb of imukit with the arguments of imukit_VERB. For these functions only.
  if exist ('imukit_gateway', 'file') ~= 3
    error ('imukit:gateway', ['imukit_gateway is not compiled, or not beside imukit_call.m. ' ...
      'For Octave run "make octave" and addpath build/octave; for MATLAB see docs/matlab.md.']);
  end
  if exist ('convertStringsToChars') %#ok<EXIST>
    [arguments{:}] = convertStringsToChars (arguments{:});
  end
  result = imukit_gateway (verb, arguments{:});
end
