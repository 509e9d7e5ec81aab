// What the controller does once a cycle, without ROS.
#pragma once

#include <friction.h>

#include <atomic>
#include <memory>
#include <string>

namespace friction_compensation_controller {

struct FreeObserver {
  void operator()(FrictionObserver *observer) const noexcept { friction_observer_free(observer); }
};
using Observer = std::unique_ptr<FrictionObserver, FreeObserver>;

/// The observer that the text of a parameter file describes for `/friction_observer`, called once
/// every `period` [s]. Empty where that fails; `why` then says so in a sentence. Allocates.
Observer observer_from(const std::string &yaml, double period, std::string &why);

/// What may be set while the controller runs, from any thread.
struct Settings {
  /// How much of the estimate is added: 0 none, 1 all of it.
  std::atomic<double> share{1.0};
  /// Most that is ever added, both ways [the command's unit]. Nothing is added until it is set.
  std::atomic<double> limit{0.0};
  /// What one newton metre is in the command: 1 for an effort, volts per N m for a voltage.
  std::atomic<double> command_per_torque{1.0};
  /// How long the compensation takes to come in after a start or a lost measurement [s].
  std::atomic<double> ramp{0.5};
};

/// One cycle's inputs.
struct Inputs {
  /// The command to which friction is added [the command's unit].
  double reference;
  /// Measured velocity [rad/s].
  double velocity;
  /// Measured position [rad].
  double position;
  /// Velocity that is asked for [rad/s]; not a number where nobody says.
  double reference_velocity;
};

/// One cycle's results.
struct Outputs {
  /// What to command.
  double command;
  /// What was added to the reference [the command's unit].
  double added;
  /// Whether the estimate is one: inputs were numbers and the observer answered.
  bool estimated;
  FrictionEstimate estimate;
};

/// Adds a friction estimate to a command. `step` and `start` belong to the thread in real time:
/// they neither allocate nor wait. `offer` belongs to another one.
class Compensation {
 public:
  /// `period` is the time between two steps [s]; `command_is_voltage` says that observers which
  /// need the applied voltage may take the last command for it.
  Compensation(Observer observer, double period, bool command_is_voltage);
  ~Compensation();
  Compensation(const Compensation &) = delete;
  Compensation &operator=(const Compensation &) = delete;

  Settings settings;

  /// Back to rest; the compensation comes in along its ramp.
  void start() noexcept;

  /// One cycle. A reference that is no number commands zero; a measurement that is none takes the
  /// compensation away at once, and it comes back along its ramp.
  Outputs step(const Inputs &inputs) noexcept;

  /// Hands over another observer of the same period, which the next steps go over to in 0.1 s.
  /// False where the one before has not been taken yet: try again. What was replaced is freed here,
  /// or at the end.
  bool offer(Observer &next);

  /// Name of the model that estimates now, from any thread.
  const char *model() const noexcept { return model_.load(std::memory_order_relaxed); }

  /// Whether an observer can be used here; `why` says what it lacks.
  static bool usable(const FrictionObserver *observer, bool command_is_voltage,
                     bool has_reference_velocity, std::string &why);

 private:
  void take_offered() noexcept;

  Observer observer_;
  double period_;
  bool command_is_voltage_;
  /// From 0 to 1 along the ramp.
  double engaged_ = 0.0;
  double last_command_ = 0.0;
  std::atomic<const char *> model_;
  /// Owned by whoever holds it: handed over by exchange.
  std::atomic<FrictionObserver *> offered_{nullptr};
  std::atomic<FrictionObserver *> used_up_{nullptr};
};

}  // namespace friction_compensation_controller
