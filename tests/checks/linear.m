% linear.m - what Octave's control package says of the models of tests/checks/linear.sh: octave-cli linear.m FOLDER
% Prints lines of a model, what it is of, and numbers: poles, gains at frequencies; margins of the satellite's loop.
pkg load control
folder = argv(){1};
for k = 1:6
  model = {'spinning', 'system', 'satellite', 'shaft', 'exact', 'bent'}{k};
  m = load([folder '/' model '.mat']);
  plant = ss(m.A, m.B, m.C, m.D, 'stname', m.states, 'inname', m.inputs, 'outname', m.outputs);
  for p = pole(plant).'
    printf('%s pole %.17g %.17g\n', model, real(p), imag(p));
  end
  for w = [0.3 2 7 40]
    for h = freqresp(plant, w)(:).'
      printf('%s gain %g %.17g %.17g\n', model, w, real(h), imag(h));
    end
  end
end
% The satellite's loop: 100 Hz, a command acts half a sample later, -40 (2 turn + 5 rate). `margin` finds roots of polynomials,
% which the integrators of a free body make too inaccurate for the phase: that is where its own response has modulus 1.
m = load([folder '/satellite.mat']);
sensed = 2 * m.C(strcmp(m.outputs, 'turn'), :) + 5 * m.C(strcmp(m.outputs, 'rate'), :);
[F, G] = ssdata(c2d(ss(m.A, m.B, sensed, 0), 0.005, 'zoh'));
n = rows(F);
loop = ss([F * F, F * G; zeros(1, n + 1)], [G; 1], -40 * [sensed, 0], 0, 0.01);
printf('margins gain %.17g\n', margin(loop));
w = fzero(@(w) abs(freqresp(loop, w)) - 1, [0.5 1], optimset('TolX', 1e-15));
printf('margins phase %.17g\n', abs(angle(-freqresp(loop, w))));
