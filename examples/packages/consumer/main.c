/* A project that takes flexbeam from a package: a quarter turn about z takes x to y. The same file for every route. */
#define FB_WITH_BUILD 0
#define FB_WITH_SYSTEM 0
#define FB_WITH_EXACT 0
#define FLEXBEAM_IMPLEMENTATION
#include <flexbeam.h>
#include <stdio.h>

int main(void)
{
  const fb_real turn[3] = {0, 0, FB_R(1.57079632679489662)}, x[3] = {1, 0, 0};
  fb_real quat[4], R[9], y[3];
  fb_quat_from_rotvec(quat, turn);
  fb_quat_to_mat33(R, quat);
  fb_mat33_mul_vec3(y, R, x);
  printf("flexbeam %s: %.3f %.3f %.3f\n", fb_version_string(), (double)y[0] + 1e-9, (double)y[1], (double)y[2]);
  return y[1] > FB_R(0.999) ? 0 : 1;
}
