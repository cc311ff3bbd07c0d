% SPDX-License-Identifier: Apache-2.0
% The file of "imukit convert --to matlab" makes the noise of the model, when it is used as MATLAB
% documents imuSensor. There is no such class in Octave, so simulate() below computes its noise
% (docs/other-formats.md, IMUSENSOR). tools/check_octave.sh runs it:
%
%     octave-cli test_imusensor.m BUILD

% B is rate/2 for "double-sided", MATLAB's default, and rate for "single-sided".
function y = simulate (sensor, filter_, type, rate, n)
  bandwidth = rate / (1 + strcmp (type, 'double-sided'));
  white = randn (n, 3) .* sqrt (bandwidth) .* sensor.NoiseDensity';
  walk = cumsum (randn (n, 3) .* sensor.RandomWalk' / sqrt (bandwidth));
  flicker = filter (filter_.Numerator, filter_.Denominator, randn (n, 3) .* sensor.BiasInstability');
  y = white + walk + flicker;
end

% What loadparams() takes: numbers, and "Inf".
function check_loadable (part)
  for name = {'Gyroscope', 'Accelerometer', 'Magnetometer'}
    sensor = part.(name{1});
    for field = fieldnames(sensor)'
      value = sensor.(field{1});
      assert (isnumeric (value) || strcmpi (value, 'inf'), '%s.%s', name{1}, field{1});
      assert (any (numel (value) == [1 3 9]) || strcmpi (value, 'inf'));
    end
  end
end

% Deviations within the interval, which is missed by chance once in 1e9 times, widened by the error
% of the filter: for 300 points less than once in a million seeds.
function compare (y, rate, variance, error_)
  r = imukit_allan (y, rate, 'columns', 'gyro', 'confidence', 0.999999999);
  for k = 1:3
    p = r.result.channels(k).points;
    for i = 1:numel (p.tau)
      due = sqrt (variance (p.tau(i)));
      assert (p.lower(i) <= due * (1 + error_) && p.upper(i) >= due * (1 - error_), ...
        'channel %d at %g s: %g, expected %g', k, p.tau(i), p.deviation(i), due);
    end
  end
end

function test_imusensor (build)
  addpath (fullfile (build, 'octave'));
  folder = tempname ();
  mkdir (folder);
  here = cd (folder);
  unwind_protect
    rate = 50;
    n = 2^17;
    N = 1e-4; K = 2e-5; B = 3e-4;
    file = fopen ('model.yaml', 'w');
    fprintf (file, ['imukit: 1\nname: unit\ngyro:\n  noise: {density: two-sided, ', ...
      'angle_random_walk: %.17g rad/sqrt(s), bias_instability: %.17g rad/s, ', ...
      'rate_random_walk: %.17g rad/s/sqrt(s)}\naccel:\n  range: 16 g\nmag:\n  range: 4900 uT\n'], ...
      N, B, K);
    fclose (file);
    randn ('seed', 4);
    for type = {'double-sided', 'single-sided'}
      density = {'', ' --density two-sided'}{1 + strcmp(type{1}, 'single-sided')};
      status = system ([fullfile(build, 'imukit'), ' convert model.yaml imu.json --to matlab', ...
        ' --rate 50Hz', density, ' 2>/dev/null']);
      assert (status == 0);
      file = jsondecode (fileread ('imu.json'));
      part = file.unit;
      check_loadable (part);
      assert (part.BiasInstabilityFilter.SampleRate == rate);
      gyro = part.Gyroscope;
      none = zeros (3, 1);
      only_white = setfield (setfield (gyro, 'RandomWalk', none), 'BiasInstability', none);
      only_walk = setfield (setfield (gyro, 'NoiseDensity', none), 'BiasInstability', none);
      only_flicker = setfield (setfield (gyro, 'NoiseDensity', none), 'RandomWalk', none);
      make = @(sensor) simulate (sensor, part.BiasInstabilityFilter, type{1}, rate, n);
      compare (make (only_white), rate, @(tau) N^2 / tau, 0);
      % sampled: K^2 tau/3 and what steps at samples add
      compare (make (only_walk), rate, @(tau) K^2 * (tau / 3 + 1 / (6 * tau * rate^2)), 0);
      compare (make (only_flicker), rate, @(tau) 2 * log (2) / pi * B^2, 0.035);
    end
  unwind_protect_cleanup
    cd (here);
    confirm_recursive_rmdir (false, 'local');
    rmdir (folder, 's');
  end_unwind_protect
end

given = argv ();
test_imusensor (make_absolute_filename (given{end}));
disp ('imuSensor makes the noise of the model');
