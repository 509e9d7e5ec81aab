/* Reads models, their values and velocities from the standard input, steps them, and writes every
 * number to the last bit. */
#include <friction.h>

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static double number(uint64_t bits) {
  double value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

static uint64_t bits(double value) {
  uint64_t same;
  memcpy(&same, &value, sizeof same);
  return same;
}

static void expect(FrictionCode code, const char *message) {
  if (code != FRICTION_CODE_OK) {
    fprintf(stderr, "%s: %s\n", friction_code_meaning(code), message);
    exit(1);
  }
}

/* Steps one model and one observer over the velocities that follow, up to a line "end". */
static void run(const char *name, const FrictionValue *values, size_t count, int32_t scheme) {
  char message[256] = "", word[64];
  FrictionModel *model = NULL;
  FrictionObserver *observer = NULL;
  expect(friction_model_create(name, values, count, 1e-3, scheme, message, sizeof message, &model),
         message);
  expect(friction_observer_create(name, values, count, 1e-3, scheme, message, sizeof message,
                                  &observer),
         message);
  printf("%s\n", friction_observer_model(observer));
  while (scanf("%63s", word) == 1 && strcmp(word, "end") != 0) {
    double velocity = number(strtoull(word, NULL, 16)), friction;
    FrictionState state;
    FrictionSeen seen = {.velocity = velocity, .torque = NAN};
    FrictionEstimate estimate;
    expect(friction_model_step(model, velocity, &friction), name);
    expect(friction_model_state(model, velocity, &state), name);
    expect(friction_observer_step(observer, &seen, &estimate), name);
    printf("%016" PRIx64 " %016" PRIx64 " %016" PRIx64 " %d", bits(friction),
           bits(state.deflection), bits(state.gamma), state.regime == FRICTION_REGIME_SLIP);
    printf(" %016" PRIx64 " %016" PRIx64 " %016" PRIx64 " %d\n", bits(estimate.torque),
           bits(estimate.deflection), bits(estimate.gamma),
           estimate.regime == FRICTION_REGIME_SLIP);
  }
  friction_observer_free(observer);
  friction_model_free(model);
}

int main(void) {
  char kind[16], name[64], names[256][64];
  FrictionValue values[256];
  size_t count = 0;
  int scheme = 0;
  while (scanf("%15s", kind) == 1) {
    if (strcmp(kind, "model") == 0) {
      if (scanf("%63s %d", name, &scheme) != 2) return 1;
      count = 0;
    } else if (strcmp(kind, "value") == 0 && count < 256) {
      uint64_t given;
      if (scanf("%63s %" SCNx64, names[count], &given) != 2) return 1;
      values[count].name = names[count];
      values[count].value = number(given);
      ++count;
    } else if (strcmp(kind, "run") == 0) {
      run(name, values, count, scheme);
    } else {
      return 1;
    }
  }
  return 0;
}
