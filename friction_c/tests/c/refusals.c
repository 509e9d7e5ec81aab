/* What is wrong is refused with its code, and changes nothing. */
#include <friction.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CHECK(condition)                                                \
  do {                                                                  \
    if (!(condition)) {                                                 \
      fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition);   \
      exit(1);                                                          \
    }                                                                   \
  } while (0)

static const FrictionValue coulomb[] = {{"f_c", 0.09}};

static void creation(void) {
  char message[200];
  FrictionModel *model = (FrictionModel *)message;
  const struct {
    const char *name;
    const FrictionValue *values;
    size_t count;
    double period;
    int32_t scheme;
    FrictionCode expected;
  } wrong[] = {
      {NULL, coulomb, 1, 1e-3, 0, FRICTION_CODE_NULL_POINTER},
      {"coulomb", NULL, 1, 1e-3, 0, FRICTION_CODE_NULL_POINTER},
      {"coulomb", &(FrictionValue){NULL, 1.0}, 1, 1e-3, 0, FRICTION_CODE_NULL_POINTER},
      {"\xff", coulomb, 1, 1e-3, 0, FRICTION_CODE_NOT_TEXT},
      {"colomb", coulomb, 1, 1e-3, 0, FRICTION_CODE_UNKNOWN_MODEL},
      {"coulomb", coulomb, 0, 1e-3, 0, FRICTION_CODE_BAD_PARAMETER},
      {"coulomb", &(FrictionValue){"f_c", -1.0}, 1, 1e-3, 0, FRICTION_CODE_BAD_PARAMETER},
      {"coulomb", &(FrictionValue){"f_c", NAN}, 1, 1e-3, 0, FRICTION_CODE_NOT_FINITE},
      {"coulomb", coulomb, 1, 0.0, 0, FRICTION_CODE_BAD_PERIOD},
      {"coulomb", coulomb, 1, 0.1, 0, FRICTION_CODE_BAD_PERIOD},
      {"coulomb", coulomb, 1, INFINITY, 0, FRICTION_CODE_NOT_FINITE},
      {"coulomb", coulomb, 1, 1e-3, 2, FRICTION_CODE_OUT_OF_RANGE},
  };
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; ++i) {
    model = (FrictionModel *)message;
    memset(message, 'x', sizeof message);
    FrictionCode code =
        friction_model_create(wrong[i].name, wrong[i].values, wrong[i].count, wrong[i].period,
                              wrong[i].scheme, message, sizeof message, &model);
    CHECK(code == wrong[i].expected && model == NULL);
    CHECK(memchr(message, 0, sizeof message) != NULL && strlen(message) > 10);
  }
  CHECK(friction_model_create("coulomb", coulomb, 1, 1e-3, 0, NULL, 0, NULL) ==
        FRICTION_CODE_NULL_POINTER);
  /* One byte of room is one zero byte. */
  CHECK(friction_model_create("", coulomb, 1, 1e-3, 0, message, 1, &model) ==
        FRICTION_CODE_UNKNOWN_MODEL);
  CHECK(message[0] == 0);
  FrictionObserver *observer = NULL;
  CHECK(friction_observer_from_yaml(NULL, NULL, 0, message, sizeof message, &observer) ==
        FRICTION_CODE_NULL_POINTER);
  CHECK(friction_observer_from_yaml("a: [", NULL, 0, message, sizeof message, &observer) ==
        FRICTION_CODE_BAD_FILE);
  CHECK(friction_observer_from_yaml("", "axis", 0, message, sizeof message, &observer) ==
        FRICTION_CODE_BAD_FILE);
  CHECK(observer == NULL);
  friction_model_free(NULL);
  friction_observer_free(NULL);
}

static void steps(void) {
  char message[200];
  FrictionModel *model = NULL;
  FrictionObserver *observer = NULL, *slower = NULL;
  double friction = 7.0, value;
  FrictionState state;
  CHECK(friction_model_create("coulomb", coulomb, 1, 1e-3, 0, message, sizeof message, &model) ==
        FRICTION_CODE_OK);
  CHECK(message[0] == 0);
  CHECK(friction_observer_create("coulomb", coulomb, 1, 1e-3, 0, NULL, 0, &observer) ==
        FRICTION_CODE_OK);
  CHECK(friction_observer_create("coulomb", coulomb, 1, 2e-3, 0, NULL, 0, &slower) ==
        FRICTION_CODE_OK);
  CHECK(friction_model_step(model, NAN, &friction) == FRICTION_CODE_NOT_FINITE && friction == 0.0);
  CHECK(friction_model_step(model, 1.0, NULL) == FRICTION_CODE_NULL_POINTER);
  friction = 7.0;
  CHECK(friction_model_step(NULL, 1.0, &friction) == FRICTION_CODE_NULL_POINTER && friction == 0.0);
  CHECK(friction_model_step(model, 1.0, &friction) == FRICTION_CODE_OK && friction == 0.09);
  CHECK(friction_model_state(model, INFINITY, &state) == FRICTION_CODE_NOT_FINITE);
  CHECK(friction_model_state(model, 1.0, NULL) == FRICTION_CODE_NULL_POINTER);
  CHECK(friction_model_parameter(model, "f_c", &value) == FRICTION_CODE_OK && value == 0.09);
  CHECK(friction_model_parameter(model, "g", &value) == FRICTION_CODE_BAD_PARAMETER && value == 0);
  CHECK(friction_model_reset(NULL) == FRICTION_CODE_NULL_POINTER);

  FrictionEstimate estimate;
  FrictionSeen seen = {.velocity = 1.0, .torque = 0.1};
  CHECK(friction_observer_step(observer, &seen, &estimate) == FRICTION_CODE_OK);
  CHECK(estimate.torque == 0.09 && fabs(estimate.residual - 0.01) < 1e-12);
  double *fields[] = {&seen.velocity, &seen.position, &seen.reference_velocity, &seen.error,
                      &seen.voltage};
  for (size_t i = 0; i < sizeof fields / sizeof *fields; ++i) {
    double before = *fields[i];
    *fields[i] = NAN;
    CHECK(friction_observer_step(observer, &seen, &estimate) == FRICTION_CODE_NOT_FINITE);
    CHECK(estimate.torque == 0.0 && isnan(estimate.residual));
    *fields[i] = before;
  }
  CHECK(friction_observer_step(observer, NULL, &estimate) == FRICTION_CODE_NULL_POINTER);
  CHECK(friction_observer_step(NULL, &seen, &estimate) == FRICTION_CODE_NULL_POINTER);
  CHECK(friction_observer_step(observer, &seen, NULL) == FRICTION_CODE_NULL_POINTER);
  CHECK(friction_observer_change(observer, slower) == FRICTION_CODE_BAD_PERIOD);
  CHECK(friction_observer_change(observer, NULL) == FRICTION_CODE_NULL_POINTER);
  CHECK(friction_observer_change(observer, observer) == FRICTION_CODE_OK);
  CHECK(friction_observer_period(NULL) == 0.0 && friction_observer_period(slower) == 2e-3);
  CHECK(friction_observer_model(NULL) == NULL);
  friction_model_free(model);
  friction_observer_free(observer);
  friction_observer_free(slower);
}

static void lists(void) {
  FrictionParameter parameter;
  CHECK(friction_model_count() >= 23);
  CHECK(friction_model_name(friction_model_count()) == NULL);
  CHECK(friction_model_title(friction_model_count()) == NULL);
  CHECK(friction_parameter_count(NULL) == 0 && friction_parameter_count("none") == 0);
  for (size_t i = 0; i < friction_model_count(); ++i) {
    const char *name = friction_model_name(i);
    size_t count = friction_parameter_count(name);
    CHECK(count > 0);
    for (size_t j = 0; j < count; ++j) {
      CHECK(friction_parameter_at(name, j, &parameter) == FRICTION_CODE_OK);
      CHECK(strlen(parameter.name) > 0 && strlen(parameter.meaning) > 0);
      CHECK(strlen(parameter.range) > 0 && parameter.rotary_unit && parameter.linear_unit);
    }
    CHECK(friction_parameter_at(name, count, &parameter) == FRICTION_CODE_OUT_OF_RANGE);
  }
  CHECK(friction_parameter_at("none", 0, &parameter) == FRICTION_CODE_UNKNOWN_MODEL);
  CHECK(friction_parameter_at("coulomb", 0, NULL) == FRICTION_CODE_NULL_POINTER);
  for (int32_t code = FRICTION_CODE_OK; code <= FRICTION_CODE_PANIC; ++code)
    CHECK(friction_code_meaning(code) != NULL);
  CHECK(friction_code_meaning(-1) == NULL && friction_code_meaning(99) == NULL);
  CHECK(strchr(friction_version(), '.') != NULL);
}

int main(void) {
  creation();
  steps();
  lists();
  return 0;
}
