/**
 * Friction models and observers for C and C++.
 *
 * Quantities are SI: N m, rad and s on a rotary axis, N, m and s on a linear one. Friction opposes
 * motion: it is positive at positive velocity.
 *
 * Every call but those that only tell something answers with a FrictionCode; zero is success. What
 * is made by `..._create` or `..._from_yaml` is freed by `..._free`. Nothing else allocates, and
 * no call panics or throws: steps may be called from a thread in real time. Two threads must not
 * use one model or observer at once; two models have nothing in common.
 */

#ifndef FRICTION_H
#define FRICTION_H

/* Written from the sources of friction_c; do not change it by hand. */

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/**
 * Each velocity is held until the next step: what the thesis has, and what others fit with.
 */
#define FRICTION_SCHEME_HELD 0

/**
 * From one step to the next the velocity is the mean of both: nearer to the continuous model.
 */
#define FRICTION_SCHEME_MEAN 1

/**
 * What came of a call. `FRICTION_CODE_OK` is zero; all others mean that nothing was changed and
 * that results are zero.
 */
typedef enum FrictionCode {
  /**
   * It is done.
   */
  FRICTION_CODE_OK = 0,
  /**
   * A pointer that must lead somewhere is null.
   */
  FRICTION_CODE_NULL_POINTER = 1,
  /**
   * A text is not UTF-8.
   */
  FRICTION_CODE_NOT_TEXT = 2,
  /**
   * There is no friction model of that name.
   */
  FRICTION_CODE_UNKNOWN_MODEL = 3,
  /**
   * A parameter is unknown, missing, given twice or outside its range.
   */
  FRICTION_CODE_BAD_PARAMETER = 4,
  /**
   * A period lies outside (0, 0.01] s, or two periods differ that must be the same.
   */
  FRICTION_CODE_BAD_PERIOD = 5,
  /**
   * A parameter file cannot be read, or says nothing of the node.
   */
  FRICTION_CODE_BAD_FILE = 6,
  /**
   * A number is not finite.
   */
  FRICTION_CODE_NOT_FINITE = 7,
  /**
   * An index or a choice is beyond the last.
   */
  FRICTION_CODE_OUT_OF_RANGE = 8,
  /**
   * A fault of this library; please report it. Reset or free what was called.
   */
  FRICTION_CODE_PANIC = 9,
} FrictionCode;

/**
 * Whether the surfaces hold or slide.
 */
typedef enum FrictionRegime {
  /**
   * The bristles deflect with the motion.
   */
  FRICTION_REGIME_STICK = 0,
  /**
   * Gross sliding.
   */
  FRICTION_REGIME_SLIP = 1,
} FrictionRegime;

/**
 * A friction model with its state. One thread at a time may use it.
 */
typedef struct FrictionModel FrictionModel;

/**
 * An observer: which velocity is believed, which technique, which model. One thread at a time may
 * use it.
 */
typedef struct FrictionObserver FrictionObserver;

/**
 * One parameter of a model. The texts stay as long as the program runs.
 */
typedef struct FrictionParameter {
  /**
   * Name, as values and files have it.
   */
  const char *name;
  /**
   * What it is, in a sentence.
   */
  const char *meaning;
  /**
   * Unit on a rotary axis, for instance `N m s/rad`; empty for a pure number.
   */
  const char *rotary_unit;
  /**
   * Unit on a linear axis, for instance `N s/m`; empty for a pure number.
   */
  const char *linear_unit;
  /**
   * Which values it may have, in words.
   */
  const char *range;
  /**
   * Whether it may be left out.
   */
  bool optional;
  /**
   * Whether it is a list: values of the same name make it, in their order.
   */
  bool list;
} FrictionParameter;

/**
 * The value of one parameter. Values of the same name make a list, in their order; `forward.f_c`
 * and `backward.f_c` are the `f_c` of one direction alone.
 */
typedef struct FrictionValue {
  /**
   * Name of the parameter.
   */
  const char *name;
  /**
   * Its value, in the parameter's unit.
   */
  double value;
} FrictionValue;

/**
 * The inner quantities that every model can be asked for.
 */
typedef struct FrictionState {
  /**
   * Bristle deflection z [rad or m]; zero for static models.
   */
  double deflection;
  /**
   * Level at which the contact slides now, gamma [N m or N].
   */
  double gamma;
  /**
   * Stick or slip.
   */
  enum FrictionRegime regime;
} FrictionState;

/**
 * One cycle's readings and intentions, on the load's side. Set what an observer does not need to
 * zero: one that follows the measured velocity needs the velocity alone.
 */
typedef struct FrictionSeen {
  /**
   * Measured velocity [rad/s].
   */
  double velocity;
  /**
   * Measured position [rad].
   */
  double position;
  /**
   * Velocity that the reference asks for [rad/s].
   */
  double reference_velocity;
  /**
   * Controlled output minus its reference [rad/s or rad].
   */
  double error;
  /**
   * Voltage applied during the cycle before [V].
   */
  double voltage;
  /**
   * Friction torque as a sensor measured it [N m]; not a number (NAN) where there is none.
   */
  double torque;
} FrictionSeen;

/**
 * One cycle's estimate.
 */
typedef struct FrictionEstimate {
  /**
   * Friction torque [N m]; positive opposes positive velocity. Add it to the effort to
   * compensate.
   */
  double torque;
  /**
   * Bristle deflection z [rad]; zero for static models and without a model.
   */
  double deflection;
  /**
   * Level at which the contact slides now, gamma [N m]; zero without a model.
   */
  double gamma;
  /**
   * Velocity that the estimate was made with [rad/s].
   */
  double velocity;
  /**
   * Measured minus estimated torque [N m]; not a number without a sensor.
   */
  double residual;
  /**
   * Stick or slip.
   */
  enum FrictionRegime regime;
} FrictionEstimate;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * Version of the library, for instance "0.1.0".
 */
const char *friction_version(void);

/**
 * What a code means, in a sentence; null for a number that is no code.
 */
const char *friction_code_meaning(int32_t code);

/**
 * How many models there are.
 */
size_t friction_model_count(void);

/**
 * The name of a model, as files have it; null beyond the last.
 */
const char *friction_model_name(size_t index);

/**
 * The name of a model, as people read it; null beyond the last.
 */
const char *friction_model_title(size_t index);

/**
 * How many parameters a model has; zero for a model that is not there.
 *
 * # Safety
 * `model` is null or a text.
 */
size_t friction_parameter_count(const char *model);

/**
 * One parameter of a model.
 *
 * # Safety
 * `model` is null or a text, `into` is null or leads to a place for a parameter.
 */
enum FrictionCode friction_parameter_at(const char *model,
                                        size_t index,
                                        struct FrictionParameter *into);

/**
 * Makes a model at rest from its name and all its parameters.
 *
 * `period` is the time between two steps, above 0 and at most 0.01 s. `scheme` says how the
 * velocity between two steps is taken: FRICTION_SCHEME_HELD or FRICTION_SCHEME_MEAN. `message` gets the reason where
 * it fails, cut to `room` bytes, and may be null. `made` is null then. Free it with
 * friction_model_free.
 *
 * # Safety
 * Pointers are null or lead to what their types say; `values` to `count` of them, `message` to
 * `room` bytes.
 */
enum FrictionCode friction_model_create(const char *name,
                                        const struct FrictionValue *values,
                                        size_t count,
                                        double period,
                                        int32_t scheme,
                                        char *message,
                                        size_t room,
                                        struct FrictionModel **made);

/**
 * Ends a model; null is nothing. It must not be used afterwards.
 *
 * # Safety
 * `model` is null or came from friction_model_create, and was not freed before.
 */
void friction_model_free(struct FrictionModel *model);

/**
 * The friction now at `velocity` [rad/s or m/s]; the state then advances by one period. The
 * friction opposes motion: it is positive at positive velocity. `friction` [N m or N] is zero, and
 * the state as it was, where the velocity is refused. Allocates nothing.
 *
 * # Safety
 * `model` came from friction_model_create; `friction` is null or leads to a double.
 */
enum FrictionCode friction_model_step(struct FrictionModel *model,
                                      double velocity,
                                      double *friction);

/**
 * The inner quantities at `velocity` [rad/s or m/s]. Changes nothing, allocates nothing.
 *
 * # Safety
 * `model` came from friction_model_create; `state` is null or leads to a state.
 */
enum FrictionCode friction_model_state(const struct FrictionModel *model,
                                       double velocity,
                                       struct FrictionState *state);

/**
 * The friction after a long time at constant `velocity` [rad/s or m/s]. Changes nothing, allocates
 * nothing.
 *
 * # Safety
 * `model` came from friction_model_create; `friction` is null or leads to a double.
 */
enum FrictionCode friction_model_steady_state(const struct FrictionModel *model,
                                              double velocity,
                                              double *friction);

/**
 * The value of a parameter that is no list; of a model with two directions the forward one.
 *
 * # Safety
 * `model` came from friction_model_create; `name` is null or a text; `value` is null or leads to a
 * double.
 */
enum FrictionCode friction_model_parameter(const struct FrictionModel *model,
                                           const char *name,
                                           double *value);

/**
 * Back to rest. Allocates nothing.
 *
 * # Safety
 * `model` is null or came from friction_model_create.
 */
enum FrictionCode friction_model_reset(struct FrictionModel *model);

/**
 * Makes an observer at rest that follows the measured velocity with a model: its name and all its
 * parameters.
 *
 * `period` is the time between two calls, above 0 and at most 0.01 s. `scheme` says how the
 * velocity between two calls is taken: FRICTION_SCHEME_HELD or FRICTION_SCHEME_MEAN. `message` gets the reason where
 * it fails, cut to `room` bytes, and may be null. `made` is null then. Free it with
 * friction_observer_free.
 *
 * # Safety
 * Pointers are null or lead to what their types say; `values` to `count` of them, `message` to
 * `room` bytes.
 */
enum FrictionCode friction_observer_create(const char *name,
                                           const struct FrictionValue *values,
                                           size_t count,
                                           double period,
                                           int32_t scheme,
                                           char *message,
                                           size_t room,
                                           struct FrictionObserver **made);

/**
 * Makes the observer that a ROS 2 parameter file describes, for instance the `parameters.yaml` of
 * an identification: `yaml` is its text, `node` the node it is for, null for
 * "/friction_observer". `period` 0 means the period that the file says, 0.001 s if none. The rest
 * is as in friction_observer_create.
 *
 * # Safety
 * Pointers are null or lead to what their types say; `message` to `room` bytes.
 */
enum FrictionCode friction_observer_from_yaml(const char *yaml,
                                              const char *node,
                                              double period,
                                              char *message,
                                              size_t room,
                                              struct FrictionObserver **made);

/**
 * Ends an observer; null is nothing. It must not be used afterwards.
 *
 * # Safety
 * `observer` is null or came from one of the functions that make them, and was not freed before.
 */
void friction_observer_free(struct FrictionObserver *observer);

/**
 * The friction now. The estimate is zero, and the state as it was, where a number other than
 * `torque` is not finite. Allocates nothing.
 *
 * # Safety
 * `observer` came from one of the functions that make them; the others are null or lead to what
 * their types say, not to the same place.
 */
enum FrictionCode friction_observer_step(struct FrictionObserver *observer,
                                         const struct FrictionSeen *now,
                                         struct FrictionEstimate *estimate);

/**
 * Goes over to the model and the options of `to`, which stays as it is. What estimated before
 * fades out in 0.1 s: the torque does not jump. Both must have the same period. Allocates nothing:
 * make `to` in another thread. Over to itself is nothing.
 *
 * # Safety
 * Both are null or came from one of the functions that make them.
 */
enum FrictionCode friction_observer_change(struct FrictionObserver *observer,
                                           const struct FrictionObserver *to);

/**
 * Back to rest. Allocates nothing.
 *
 * # Safety
 * `observer` is null or came from one of the functions that make them.
 */
enum FrictionCode friction_observer_reset(struct FrictionObserver *observer);

/**
 * The time between two calls [s]; zero for null.
 *
 * # Safety
 * `observer` is null or came from one of the functions that make them.
 */
double friction_observer_period(const struct FrictionObserver *observer);

/**
 * Whether the observer needs the voltage that was applied: false, and FrictionSeen's voltage may
 * stay zero, for those that only follow a velocity.
 *
 * # Safety
 * `observer` is null or came from one of the functions that make them.
 */
bool friction_observer_needs_voltage(const struct FrictionObserver *observer);

/**
 * Whether the observer needs the velocity that the reference asks for, or the error.
 *
 * # Safety
 * `observer` is null or came from one of the functions that make them.
 */
bool friction_observer_needs_reference(const struct FrictionObserver *observer);

/**
 * The name of the model; null for null. The text stays as long as the program runs.
 *
 * # Safety
 * `observer` is null or came from one of the functions that make them.
 */
const char *friction_observer_model(const struct FrictionObserver *observer);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* FRICTION_H */
