% SPDX-License-Identifier: Apache-2.0
% The functions of matlab/ against the command: the same structs to the last digit, the same
% sentences, and no argument that ends Octave. tools/check_octave.sh runs it:
%
%     octave-cli test_gateway.m BUILD SHARED_DATA

function test_gateway (build, shared)
  addpath (fullfile (build, 'octave'));
  global command
  command = fullfile (build, 'imukit');
  warning ('off', 'all');
  folder = tempname ();
  mkdir (folder);
  here = cd (folder);
  unwind_protect
    test_values ();
    test_many_points ();
    test_sessions ();
    test_files (shared);
    test_arrays ();
    test_models ();
    test_simulate ();
    test_warnings ();
    test_help ();
    test_increments ();
  test_refusals ();
    test_nothing_left ();
  unwind_protect_cleanup
    cd (here);
    confirm_recursive_rmdir (false, 'local');
    rmdir (folder, 's');
  end_unwind_protect
end

% ---- comparing -----------------------------------------------------------------------------------

function text = run_command (words)
  global command
  [status, text] = system ([command, ' ', words, ' 2>/dev/null']);
  assert (status == 0, 'imukit %s: exit code %d', words, status);
end

% All numbers in a JSON text, in their order.
function numbers = numbers_of_text (text)
  bare = regexprep (text, '"(?:[^"\\]|\\.)*"', '""');
  numbers = cellfun (@str2double, regexp (bare, '-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?', 'match'))(:);
end

% All numbers in a struct, in their order.
function numbers = numbers_of (value)
  numbers = zeros (0, 1);
  if isstruct (value)
    for k = 1:numel (value)
      parts = cellfun (@numbers_of, struct2cell (value(k)), 'UniformOutput', false);
      numbers = [numbers; vertcat(parts{:}, zeros (0, 1))];
    end
  elseif iscell (value)
    for k = 1:numel (value)
      numbers = [numbers; numbers_of(value{k})];
    end
  elseif isnumeric (value)
    value = value.';
    numbers = value(! isnan (value))(:);
  end
end

% Names, classes, sizes and texts are those of jsondecode(), and numbers nearly: it does not round
% them correctly.
function compare (a, b, where)
  same = strcmp (class (a), class (b)) && isequal (size (a), size (b));
  if same && isstruct (a)
    same = isequal (fieldnames (a), fieldnames (b));
  elseif same && isnumeric (a)
    same = all ((isnan (a) & isnan (b) | abs (a - b) <= 1e-14 * abs (b))(:));
  elseif same && ! iscell (a)
    same = isequal (a, b);
  end
  if ! same
    error ('%s differs', where);
  end
  if isstruct (a)
    for name = fieldnames (a)'
      for k = 1:numel (a)
        compare (a(k).(name{1}), b(k).(name{1}), [where, '.', name{1}]);
      end
    end
  elseif iscell (a)
    for k = 1:numel (a)
      compare (a{k}, b{k}, where);
    end
  end
end

% The points of curves, which jsondecode() makes structs, as columns.
function value = with_columns (value)
  if ! isstruct (value)
    return
  end
  for k = 1:numel (value)
    for name = fieldnames (value)'
      member = value(k).(name{1});
      value(k).(name{1}) = with_columns (member);
      if strcmp (name{1}, 'points')
        value(k).points = columns_of (member);
      end
    end
  end
end

function columns = columns_of (points)
  units = columns = struct ();
  for name = fieldnames (points)'
    members = {points.(name{1})}';
    if isstruct (members{1})
      columns.(name{1}) = cellfun (@(q) q.value, members);
      units.(name{1}) = members{1}.unit;
    elseif isnumeric (members{1})
      columns.(name{1}) = cell2mat (members);
    else
      columns.(name{1}) = members;
    end
  end
  columns.units = units;
end

function same_as_command (result, words)
  text = run_command (words);
  expected = with_columns (jsondecode (text));
  for name = fieldnames (expected)'
    compare (result.(name{1}), expected.(name{1}), name{1});
  end
  numbers = zeros (0, 1);
  for name = fieldnames (expected)'
    numbers = [numbers; numbers_of(result.(name{1}))];
  end
  assert (numel (numbers) > 20);
  assert (isequal (sort (numbers), sort (numbers_of_text (text)))); % every bit
end

% ---- what is right -------------------------------------------------------------------------------

% A result as it is in memory, whatever its shape.
function test_values ()
  evaluation = imukit_allan ([1; 2; 1; 3; 2; 4], 1, 'columns', 'x', 'tau', [1 2]);
  points = evaluation.result.channels.points;
  assert (points.tau, [1; 2]);
  % sqrt(mean of squared differences/2): differences 1, -1, 2, -1, 2
  assert (points.deviation(1), sqrt (11 / 5 / 2), 1e-15);
  assert (size (points.noise), [2 1]);
  assert (points.units.tau, 's');
  assert (isempty (evaluation.findings) || isstruct (evaluation.findings));
end

% The time to read a result grows with its length, not with its square, which took minutes here.
function test_many_points ()
  tic;
  curve = imukit_allan (sin ((1:20000)'.^2), 100, 'columns', 'gyro_x', 'tau', 'all');
  assert (numel (curve.result.channels.points.upper), 10000);
  clear curve
  assert (toc < 20); % 0.4 s
end

% Records of several sessions: what files of the same numbers are.
function test_sessions ()
  columns = {'time', 'gyro [deg/s]', 'accel'};
  for k = 1:3
    run_command (sprintf ('simulate AHRS --rate 20Hz --duration 100s --seed %d -o run%d.csv', k, k));
    data{k} = csvread (sprintf ('run%d.csv', k), 1, 0);
    files{k} = sprintf ('run%d.csv', k);
  end
  from_arrays = imukit_identify (data, [], 'columns', columns, 'runs', true);
  from_files = imukit_identify (files, 'runs', true);
  assert (from_arrays.inputs.logs, {'array-1.npy'; 'array-2.npy'; 'array-3.npy'});
  assert (numbers_of (from_arrays.result.channels), numbers_of (from_files.result.channels));
  from_arrays = imukit_allan (data, [], 'columns', columns);
  same_as_command (imukit_allan (files), 'allan --json run1.csv run2.csv run3.csv');
  assert (from_arrays.inputs.logs, {'array-1.npy'; 'array-2.npy'; 'array-3.npy'});
  assert (strncmp (from_arrays.result.usability.sentence, 'array-', 6));
  for k = 1:3
    one = imukit_allan (files{k});
    assert (numbers_of (from_arrays.result.logs(k).channels), numbers_of (one.result.channels));
  end
  option = {'procedure', 'repeatability'};
  from_arrays = imukit_calibrate (data, [], 'columns', columns, option{:});
  from_files = imukit_calibrate (files, option{:});
  assert (numbers_of (from_arrays.result), numbers_of (from_files.result));
end

function test_files (shared)
  logs = [shared, '/static/adis16405_imu1_100hz.csv.gz'];
  same_as_command (imukit_allan (logs, 'rate', 100, 'before', '5min'), ...
    ['allan --rate 100Hz --before 5min --json ', logs]);
  same_as_command (imukit_identify (logs, 'rate', 100, 'before', 200, 'threads', 2), ...
    ['identify --rate 100Hz --before 200s --json ', logs]);
  poses = [shared, '/calibration/mpu9150_unit0_multiposition_100hz.csv.gz'];
  same_as_command (imukit_calibrate (poses, 'procedure', 'multiposition', 'gravity', 9.81), ...
    ['calibrate --procedure multiposition --gravity 9.81m/s^2 --json ', poses]);
  same_as_command (imukit_drift ({'tactical', 'navigation'}, 'times', [60 3600], ...
    'latitude', pi / 4, 'vertical', 'free'), ...
    'drift tactical navigation --times 60s,3600s --latitude 45deg --vertical free --json');
  same_as_command (imukit_drift ('AHRS', 'want', 'CEP 1 nmi @ 10min', 'monte_carlo', 20), ...
    'drift AHRS --want "CEP 1 nmi @ 10min" --monte-carlo 20 --json');
end

% A matrix is what a file of the same numbers is.
function test_arrays ()
  run_command ('simulate AHRS --rate 50Hz --duration 200s --seed 4 -o log.csv');
  data = csvread ('log.csv', 1, 0);
  columns = {'time', 'gyro [deg/s]', 'accel'};
  from_file = imukit_identify ('log.csv');
  from_array = imukit_identify (data, [], 'columns', columns);
  assert (isequaln (from_array.result, from_file.result));
  assert (from_array.inputs.log, 'array.npy');
  rates = imukit_identify (data(:, 2:7), 50, 'columns', columns(2:3));
  assert (numbers_of (rates.result.channels), numbers_of (from_file.result.channels), -1e-9);
  % what is not finite is missing
  data(1001:1003, 3) = NaN;
  gaps = imukit_allan (data, [], 'columns', columns);
  assert (gaps.result.channels(2).points.used(1) < 1);
  % a row of names, and columns that are skipped
  one = imukit_allan (data(:, 1:2), [], 'columns', 'time,gyro_x [deg/s]');
  assert (numel (one.result.channels), 1);
end

% Models from results, from texts, from files and from the catalogue.
function test_models ()
  run_command ('identify log.csv -o model.yaml');
  identified = imukit_identify ('log.csv');
  text = fileread ('model.yaml');
  assert (identified.model, text);
  by_name = imukit_drift ('model.yaml', 'times', '1min');
  for model = {identified, text, struct('model', text)}
    drift = imukit_drift (model{1}, 'times', '1min');
    assert (isequaln (drift.result, by_name.result) || strcmp (drift.inputs.models, 'model.yaml'));
    assert (numbers_of (drift.result), numbers_of (by_name.result));
  end
  several = imukit_drift ({identified, 'AHRS'}, 'times', '1min');
  assert (numel (several.inputs.models), 2);
  same = imukit_simulate (identified, 'rate', 10, 'duration', 10);
  other = imukit_simulate ('model.yaml', 'rate', 10, 'duration', 10);
  assert (isequal (same.data, other.data));
  again = imukit_identify ('log.csv', 'truth', identified, 'into', identified);
  assert (! isempty (again.model));
end

function test_simulate ()
  run_command (['simulate tactical --rate 20Hz --duration 30s --seed 18446744073709551615', ...
    ' --gyro-unit rad/s --yaw 90deg --only angle_random_walk,bias.fixed -o sim.csv']);
  made = imukit_simulate ('tactical', 'rate', 20, 'duration', 30, 'seed', intmax ('uint64'), ...
    'gyro_unit', 'rad/s', 'yaw', '90 deg', 'only', {'angle_random_walk', 'bias.fixed'});
  assert (isequal (made.data, csvread ('sim.csv', 1, 0)));
  assert (made.columns{2}, 'gyro_x [rad/s]');
  % in SI units whatever those of the log are
  in_degrees = imukit_simulate ('tactical', 'rate', 20, 'duration', 30, ...
    'seed', intmax ('uint64'), 'yaw', '90 deg', 'only', {'angle_random_walk', 'bias.fixed'});
  assert (in_degrees.columns, made.columns);
  assert (in_degrees.data, made.data, -1e-14);
  counts = imukit_simulate (["imukit: 1\ngyro: {sensitivity: 1000 count/(rad/s)}\n"], ...
    'rate', 10, 'duration', 1);
  assert (counts.columns{2}, 'gyro_x [count]');
end

% The last warning of the findings is the last that was given, and can be made an error.
function test_warnings ()
  rest = @() imukit_identify (sin ((1:4000)' / 50) + 0.1 * randn (4000, 1), 100, 'columns', 'gyro_x');
  warning ('on', 'all');
  result = rest ();
  [text, id] = lastwarn ();
  warning ('off', 'all');
  told = result.findings(strcmp ({result.findings.level}, 'warning'));
  assert (! isempty (told));
  assert (id, ['imukit:', told(end).code]);
  assert (any (strfind (text, told(end).message)));
  warning ('error', id);
  try
    rest ();
    id = 'nothing';
  catch e
    assert (e.identifier, id);
  end
  warning ('off', 'all');
  assert (! strcmp (id, 'nothing'));
end

function test_help ()
  for name = {'allan', 'identify', 'simulate', 'calibrate', 'drift'}
    text = get_help_text (['imukit_', name{1}]);
    assert (any (strfind (text, ['imukit_', name{1}])), '%s', name{1});
    assert (any (strfind (text, 'Example')), '%s', name{1});
  end
end

% ---- what is wrong -------------------------------------------------------------------------------

function refused (message, id, varargin)
  try
    imukit_call (varargin{1}, varargin(2:end));
  catch e
    % of data: any identifier but that of wrong arguments
    due = strcmp (e.identifier, id) || ...
      (strcmp (id, 'imukit:failed') && ~strcmp (e.identifier, 'imukit:usage') && ...
       ~isempty (regexp (e.identifier, '^imukit:[a-z_]+$', 'once')));
    assert (due && any (strfind (e.message, message)), '%s: %s', e.identifier, e.message);
    return
  end
  error ('nothing refused: %s', message);
end

function test_increments ()
  rest = {'AHRS', 'rate', 100, 'duration', 1, 'seed', 3};
  rates = imukit_simulate (rest{:});
  increments = imukit_simulate (rest{:}, 'increments', true);
  assert (increments.columns{2}, 'dtheta_x [rad]');
  assert (increments.data(:, 2:7), rates.data(:, 2:7) / 100, -1e-12);
end

function test_refusals ()
  x = randn (1000, 3);
  gyro = {'columns', 'gyro'};
  u = 'imukit:usage';
  f = 'imukit:failed';
  refused ('the readings are single', u, 'allan', single (x), 100, gyro{:});
  refused ('the readings are int16', u, 'allan', int16 (x), 100, gyro{:});
  refused ('the readings are logical', u, 'allan', true (9, 3), 100, gyro{:});
  refused ('the readings are complex', u, 'allan', x + 1i, 100, gyro{:});
  refused ('the readings are empty', u, 'allan', zeros (0, 3), 100, gyro{:});
  refused ('full(x) converts', u, 'allan', sparse (x), 100, gyro{:});
  refused ('the readings are sparse', u, 'allan', sparse (x), 100, gyro{:});
  refused ('an array of more dimensions', u, 'allan', randn (9, 3, 2), 100, gyro{:});
  refused ('has 2 columns, and ''columns'' names 3', u, 'allan', x(:, 1:2), 100, gyro{:});
  refused ('has 1000 columns', u, 'allan', x(:, 1)', 100, 'columns', 'gyro_x');
  refused ('does not say what its columns are', u, 'allan', x, 100);
  refused ('''columns'' is not a text', u, 'allan', x, 100, 'columns', 3);
  refused ('names no column', u, 'allan', x, 100, 'columns', '');
  refused ('the sampling rate is missing', u, 'allan', x);
  refused ('the sampling rate is missing', u, 'allan', x, 'columns', 'gyro');
  for rate = {0, -1, NaN, Inf, [1 2], 1i, {100}, true}
    refused ('the sampling rate is not a positive number', u, 'allan', x, rate{1}, gyro{:});
  end
  refused ('time', f, 'allan', x, [], gyro{:}); % neither a rate nor a time
  refused ('in the file twice', f, 'allan', x, 100, 'columns', 'gyro_x,gyro_x,gyro_y');
  refused ('finite values', 'imukit:too_few_values', 'identify', NaN (1000, 3), 100, gyro{:});
  refused ('a log is missing', u, 'allan');
  refused ('expected a log', u, 'allan', '');
  refused ('expected a log', u, 'allan', struct ('a', 1), 100, gyro{:});
  refused ('this is struct', u, 'allan', struct ('a', 1));
  refused ('has 9 matrices: imukit_allan takes up to 8', u, 'allan', repmat ({x}, 1, 9), 100, gyro{:});
  refused ('one word too many', u, 'allan', repmat ({'log.csv'}, 1, 9));
  refused ('element 2 of the cell array is no matrix', u, 'identify', {x, 'a'}, 100, gyro{:});
  refused ('element 2 of the cell array is a matrix', u, 'identify', {'log.csv', x}, 100, gyro{:});
  refused ('the readings are empty', u, 'identify', {x, []}, 100, gyro{:});
  refused ('expected a log', u, 'allan', ['ab'; 'cd']);
  refused ('expected a log', u, 'allan', @sin);
  refused ('names no file', u, 'identify', {});
  refused ('element 2 of the cell array', u, 'identify', {'log.csv', 3});
  refused ('standard input', u, 'allan', '-');
  refused ('cannot be opened', f, 'allan', 'missing.csv');
  refused ('expected a model', u, 'drift', 3);
  refused ('expected a model', u, 'drift', struct ('name', 'x'));
  refused ('a model is missing', u, 'simulate');
  refused ('did you mean', f, 'drift', 'tacticla');
  refused ('model.yaml:2', f, 'drift', sprintf ('imukit: 1\ngyr: {}\n'));
  % options
  refused ('there is no option ''rat''; did you mean ''rate''?', u, 'allan', 'log.csv', 'rat', 100);
  refused ('did you mean ''gyro_unit''?', u, 'allan', x, 100, gyro{:}, 'gyro_unti', 'deg/s');
  refused ('there is no option ''xyzzy''', u, 'allan', 'log.csv', 'xyzzy', 1);
  refused ('given twice', u, 'allan', x, 100, gyro{:}, 'rate', 50);
  refused ('--rate 100Hz does not agree with the time column', f, 'allan', ...
    [(1:1000)' / 50, x], 100, 'columns', 'time,gyro');
  refused ('--rate 100', f, 'allan', [(1:1000)' / 50, x], [], 'columns', 'time,gyro', 'rate', 100);
  refused ('''gyro_x'', ''gyro_y''', u, 'allan', x, 100, 'gyro');
  refused ('''columns'' has no value', u, 'identify', 'log.csv', 'columns');
  refused ('numbers of class double, or a text', u, 'allan', 'log.csv', 'tau', single (1));
  refused ('averaging time', u, 'allan', 'log.csv', 'tau', [1 NaN]);
  refused ('of the command only', u, 'allan', 'log.csv', 'strict', true);
  refused ('temporary folder', u, 'simulate', 'AHRS', 'rate', 1000, 'duration', 1e9);
  refused ('expected the name of an option', u, 'allan', 'log.csv', 3, 4);
  refused ('has no value', u, 'allan', 'log.csv', 'rate');
  refused ('expected one finite number', u, 'allan', 'log.csv', 'rate', NaN);
  refused ('expected one finite number', u, 'allan', 'log.csv', 'rate', [1 2]);
  refused ('expected one finite number', u, 'allan', 'log.csv', 'rate', []);
  refused ('expected real numbers', u, 'allan', 'log.csv', 'rate', 1i);
  refused ('--rate -1 Hz: expected', u, 'allan', 'log.csv', 'rate', -1);
  refused ('expected a number, or a text', u, 'allan', 'log.csv', 'rate', {});
  refused ('expected a text', u, 'allan', 'log.csv', 'statistic', 3);
  refused ('there is no "adv"', u, 'allan', 'log.csv', 'statistic', 'adv');
  refused ('expected one of', u, 'allan', 'log.csv', 'gaps', 'none');
  refused ('the times must ascend', u, 'allan', 'log.csv', 'tau', [2 1]);
  refused ('expected true or false', u, 'drift', 'AHRS', 'compensated', 'yes');
  refused ('whole number', u, 'simulate', 'AHRS', 'rate', 9, 'duration', 1, 'seed', 1.5);
  refused ('whole number', u, 'simulate', 'AHRS', 'rate', 9, 'duration', 1, 'seed', -1);
  refused ('of the command only', u, 'simulate', 'AHRS', 'output', 'x.csv');
  refused ('of the command only', u, 'allan', 'log.csv', 'json', true);
  refused ('of the command only', u, 'drift', 'AHRS', 'output', 'x.h5');
  refused ('name a file', u, 'identify', 'log.csv', 'output', '-');
  refused ('--confidence', u, 'identify', 'log.csv', 'confidence', 2);
  refused ('procedure', u, 'calibrate', 'log.csv');
  refused ('did you mean', u, 'calibrate', 'log.csv', 'procedure', 'multipositon');
  refused ('--rate', u, 'simulate', 'AHRS', 'duration', 10);
  refused ('the name of a verb', u, 'allen');
  assert_error_of (@() imukit_gateway (), 'missing');
  assert_error_of (@() imukit_gateway (3), 'the name of a verb');
  % and the next call is as good as the first
  imukit_allan (x, 100, gyro{:});
end

function assert_error_of (call, message)
  try
    call ();
  catch e
    assert (any (strfind (e.message, message)), '%s', e.message);
    return
  end
  error ('nothing refused: %s', message);
end

% No temporary folder stays, whatever became of the call.
function test_nothing_left ()
  mkdir ('tmp');
  before = getenv ('TMPDIR');
  setenv ('TMPDIR', fullfile (pwd (), 'tmp'));
  imukit_allan (randn (100, 1), 1, 'columns', 'gyro_x');
  imukit_simulate ('AHRS', 'rate', 1, 'duration', 9);
  refused ('has 1 column', 'imukit:usage', 'allan', ones (9, 1), 1, 'columns', 'gyro');
  refused ('in the file twice', 'imukit:failed', 'allan', ones (9, 2), 1, 'columns', 'gyro_x,gyro_x');
  assert (numel (dir ('tmp')), 2);
  setenv ('TMPDIR', fullfile (pwd (), 'nowhere'));
  refused ('set TMPDIR', 'imukit:usage', 'allan', ones (9, 1), 1, 'columns', 'gyro_x');
  setenv ('TMPDIR', before);
end

given = argv ();
test_gateway (make_absolute_filename (given{end - 1}), make_absolute_filename (given{end}));
disp ('the functions agree with the command');
