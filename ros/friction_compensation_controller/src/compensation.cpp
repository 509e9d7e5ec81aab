#include "friction_compensation_controller/compensation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace friction_compensation_controller {

Observer observer_from(const std::string &yaml, double period, std::string &why) {
  char message[1024] = "";
  FrictionObserver *made = nullptr;
  const FrictionCode code =
      friction_observer_from_yaml(yaml.c_str(), nullptr, period, message, sizeof message, &made);
  if (code != FRICTION_CODE_OK) why = message;
  return Observer(made);
}

Compensation::Compensation(Observer observer, double period, bool command_is_voltage)
    : observer_(std::move(observer)),
      period_(period),
      command_is_voltage_(command_is_voltage),
      model_(friction_observer_model(observer_.get())) {}

Compensation::~Compensation() {
  friction_observer_free(offered_.load());
  friction_observer_free(used_up_.load());
}

void Compensation::start() noexcept {
  friction_observer_reset(observer_.get());
  engaged_ = 0.0;
  last_command_ = 0.0;
}

bool Compensation::usable(const FrictionObserver *observer, bool command_is_voltage,
                          bool has_reference_velocity, std::string &why) {
  if (friction_observer_needs_voltage(observer) && !command_is_voltage) {
    why =
        "the technique or velocity source of the parameter file needs the applied voltage, but the "
        "command is no voltage; choose technique feedback, feedforward or both, or set "
        "command_is_voltage";
    return false;
  }
  if (friction_observer_needs_reference(observer) && !has_reference_velocity) {
    why =
        "the technique of the parameter file needs the velocity that is asked for; set "
        "velocity_reference and write the reference interface, or choose technique feedback";
    return false;
  }
  return true;
}

bool Compensation::offer(Observer &next) {
  friction_observer_free(used_up_.exchange(nullptr));
  FrictionObserver *nobody = nullptr;
  if (!offered_.compare_exchange_strong(nobody, next.get())) return false;
  next.release();
  return true;
}

void Compensation::take_offered() noexcept {
  // Where the last one was not fetched yet, the next has to wait: nothing is freed here.
  if (used_up_.load() != nullptr) return;
  FrictionObserver *next = offered_.exchange(nullptr);
  if (next == nullptr) return;
  friction_observer_change(observer_.get(), next);
  model_.store(friction_observer_model(observer_.get()), std::memory_order_relaxed);
  used_up_.store(next);
}

Outputs Compensation::step(const Inputs &inputs) noexcept {
  take_offered();
  Outputs outputs{};
  outputs.estimate.residual = std::numeric_limits<double>::quiet_NaN();
  const bool commanded = std::isfinite(inputs.reference);
  const double asked = std::isfinite(inputs.reference_velocity) ? inputs.reference_velocity : 0.0;
  FrictionSeen seen{};
  seen.velocity = inputs.velocity;
  seen.position = inputs.position;
  seen.reference_velocity = asked;
  seen.error = inputs.velocity - asked;
  seen.voltage = command_is_voltage_ ? last_command_ : 0.0;
  seen.torque = std::numeric_limits<double>::quiet_NaN();
  outputs.estimated =
      friction_observer_step(observer_.get(), &seen, &outputs.estimate) == FRICTION_CODE_OK;
  if (!outputs.estimated || !commanded) {
    engaged_ = 0.0;
  } else {
    const double ramp = settings.ramp.load(std::memory_order_relaxed);
    const double rise = ramp > period_ ? period_ / ramp : 1.0;
    engaged_ = std::min(1.0, engaged_ + rise);
    const double wanted = engaged_ * settings.share.load(std::memory_order_relaxed) *
                          settings.command_per_torque.load(std::memory_order_relaxed) *
                          outputs.estimate.torque;
    // Not a number, or less than nothing, means that nothing is added.
    const double limit = settings.limit.load(std::memory_order_relaxed);
    if (std::isfinite(wanted) && limit > 0.0) outputs.added = std::clamp(wanted, -limit, limit);
  }
  outputs.command = commanded ? inputs.reference + outputs.added : 0.0;
  last_command_ = outputs.command;
  return outputs;
}

}  // namespace friction_compensation_controller
