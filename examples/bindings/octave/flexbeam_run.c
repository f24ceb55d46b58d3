/* flexbeam_run.c - a function of Octave and MATLAB: [table, names] = flexbeam_run(file, until) runs a scene from its start,
   a row of table for each of its rows: time and outputs. From the top:
   mkoctfile --mex -Iexamples/bindings examples/bindings/octave/flexbeam_run.c -Lbuild/bindings -lflexbeam_scene
   octave --eval '[table, names] = flexbeam_run("examples/scenes/rotor.txt", 2.5); plot(table(:, 1), table(:, 4))' */
#include "flexbeam_scene.h"
#include "mex.h"
#include <stdio.h>

static fbs *scene;

/* A message of MATLAB ends the function. */
static void well(int status)
{
  if (status != FBS_OK) {
    char text[768];
    snprintf(text, sizeof text, "%s", fbs_error(scene));
    fbs_free(scene);
    mexErrMsgIdAndTxt("flexbeam:scene", "%s", text);
  }
}

void mexFunction(int n_out, mxArray *out[], int n_in, const mxArray *in[])
{
  char *const file = n_in == 2 ? mxArrayToString(in[0]) : NULL;
  const double until = file ? mxGetScalar(in[1]) : 0;
  double *row;
  scene = file ? fbs_new() : NULL;
  if (!scene) {
    mexErrMsgIdAndTxt("flexbeam:scene", "flexbeam_run(FILE, SECONDS), or there is no memory");
  }
  well(fbs_open(scene, file, NULL, 0, NULL, NULL));
  const int n = fbs_count(scene, FBS_OUTPUTS), rows = (int)(until / fbs_interval(scene) + 1.5);
  row = (double *)mxMalloc((size_t)(1 + n) * sizeof *row);
  out[0] = mxCreateDoubleMatrix((mwSize)rows, (mwSize)(1 + n), mxREAL);
  for (int k = 0; k < rows; k++) {
    int made;
    row[0] = fbs_time(scene);
    well(k > 0 ? fbs_run(scene, 1, row, &made) : fbs_get(scene, FBS_OUTPUTS, n, NULL, row + 1));
    for (int i = 0; i <= n; i++) {
      mxGetPr(out[0])[k + i * rows] = row[i];
    }
  }
  if (n_out > 1) {
    out[1] = mxCreateCellMatrix(1, (mwSize)n);
    for (int i = 0; i < n; i++) {
      mxSetCell(out[1], (mwIndex)i, mxCreateString(fbs_name(scene, FBS_OUTPUTS, i)));
    }
  }
  fbs_free(scene);
}
