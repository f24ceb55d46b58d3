% first_curve.m - the tip of a rotor blade over time, by the shared library, in MATLAB, which wants a C compiler for loadlibrary. From the top:
% matlab -batch "run('examples/bindings/first_curve.m')"
loadlibrary('build/bindings/libflexbeam_scene', 'examples/bindings/flexbeam_scene.h');
call = @(name, varargin) calllib('libflexbeam_scene', ['fbs_' name], varargin{:});
rotor = call('new');
well = @(status) assert(status == 0, '%s', call('error', rotor));
well(call('open', rotor, 'examples/scenes/rotor.txt', [], 0, [], []));
tip = call('find', rotor, 2, 'tip_1'); % 2: FBS_OUTPUTS
z = libpointer('doublePtr', 0);
for k = 0:5
  well(call('step_to', rotor, 0.5 * k));
  well(call('get', rotor, 2, 1, libpointer('int32Ptr', tip), z));
  fprintf('%.1f s: %.12g m\n', 0.5 * k, z.Value);
end
call('free', rotor);
unloadlibrary('libflexbeam_scene');
