/* A small servo's friction by LuGre, from rest through a reversal. */
#include <friction.h>

#include <math.h>
#include <stdio.h>

int main(void) {
  const FrictionValue servo[] = {
      {"f_s", 0.10},    /* N m: breaks away at */
      {"f_c", 0.09},    /* N m: slides at */
      {"v_s", 0.14},    /* rad/s: falls from one to the other around this speed */
      {"delta", 2.0},   /* shape of that fall */
      {"sigma0", 16.5}, /* N m/rad: stiffness of the bristles */
      {"sigma1", 0.25}, /* N m s/rad: their damping */
      {"f_v", 0.04},    /* N m s/rad: viscous */
  };
  char message[256];
  FrictionModel *friction = NULL;
  if (friction_model_create("lugre", servo, sizeof servo / sizeof *servo, 1e-3,
                            FRICTION_SCHEME_HELD, message, sizeof message, &friction) != FRICTION_CODE_OK) {
    fprintf(stderr, "%s\n", message);
    return 1;
  }
  for (int k = 0; k <= 1000; ++k) {
    double velocity = 0.5 * cos(6.2831853 * 1e-3 * k), torque;
    if (friction_model_step(friction, velocity, &torque) != FRICTION_CODE_OK) torque = 0.0;
    if (k % 100 == 0) printf("%.1f s  %6.3f rad/s  %7.4f N m\n", 1e-3 * k, velocity, torque);
  }
  friction_model_free(friction);
  return 0;
}
