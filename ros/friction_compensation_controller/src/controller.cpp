#include "friction_compensation_controller/controller.hpp"

#include <chrono>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <utility>

#include "pluginlib/class_list_macros.hpp"

namespace friction_compensation_controller {

using controller_interface::CallbackReturn;
using controller_interface::return_type;

namespace {

constexpr double NOTHING = std::numeric_limits<double>::quiet_NaN();

/// The state interfaces that are exported, in their order.
enum Exported { FRICTION, DEFLECTION, GAMMA, REGIME, ADDED, ESTIMATED, EXPORTED };
constexpr const char *EXPORTED_NAMES[EXPORTED] = {"friction", "deflection", "gamma",
                                                  "regime",   "added",      "estimated"};

template <typename Value>
void declare(rclcpp_lifecycle::LifecycleNode &node, const char *name, const Value &usual,
             const char *meaning, bool read_only) {
  if (node.has_parameter(name)) return;
  rcl_interfaces::msg::ParameterDescriptor descriptor;
  descriptor.description = meaning;
  descriptor.read_only = read_only;
  node.declare_parameter<Value>(name, usual, descriptor);
}

bool text_of(const std::string &file, std::string &text) {
  std::ifstream from(file);
  text.assign(std::istreambuf_iterator<char>(from), {});
  return from.good() || from.eof();
}

/// Why a number cannot be the value of a parameter; empty if it can.
std::string complaint(const std::string &name, double value) {
  const auto outside = [&](double low, double high, const char *expected) {
    const bool inside = value >= low && value <= high;
    return inside ? std::string() : name + " must be " + expected + ", but is " + std::to_string(value);
  };
  if (name == "share") return outside(0.0, 1.5, "from 0 to 1.5");
  if (name == "ramp") return outside(0.0, 60.0, "from 0 to 60 s");
  if (name == "reference_timeout") return outside(0.001, 60.0, "from 0.001 to 60 s");
  if (name == "limit") {
    return outside(1e-9, 1e9, "above 0, in the unit of the command: the most that is ever added");
  }
  if (name == "command_per_torque" && (!std::isfinite(value) || value == 0.0)) {
    return name + " must be a finite number other than 0, but is " + std::to_string(value);
  }
  return {};
}

}  // namespace

CallbackReturn FrictionCompensationController::on_init() {
  try {
    auto &node = *get_node();
    declare<std::string>(node, "joint", "", "Joint whose friction is compensated", true);
    declare<std::string>(node, "command_interface", "effort",
                         "Command interface of the joint that is claimed: effort, or one in volts",
                         true);
    declare<bool>(node, "command_is_voltage", false, "Whether the command is in volts", true);
    declare<bool>(node, "velocity_reference", false,
                  "Whether another controller writes the velocity that is asked for, too", true);
    declare<double>(node, "reference_timeout", 0.5,
                    "How long a message of ~/reference counts [s]", true);
    declare<std::string>(node, "parameters_file", "",
                         "The parameters.yaml of an identification: model, values and technique",
                         false);
    declare<double>(node, "share", 1.0, "How much of the estimate is added, from 0 to 1.5", false);
    declare<double>(node, "limit", 0.0, "Most that is ever added, in the command's unit", false);
    declare<double>(node, "command_per_torque", 1.0,
                    "What one N m is in the command: 1 for an effort, V/(N m) for a voltage", false);
    declare<double>(node, "ramp", 0.5, "How long the compensation takes to come in [s]", false);
  } catch (const std::exception &wrong) {
    RCLCPP_ERROR(get_node()->get_logger(), "%s", wrong.what());
    return CallbackReturn::ERROR;
  }
  return CallbackReturn::SUCCESS;
}

Observer FrictionCompensationController::observer_of(const std::string &file,
                                                     std::string &why) const {
  std::string text;
  if (!text_of(file, text)) {
    why = "parameters_file \"" + file + "\" cannot be read; expected the parameters.yaml of an "
          "identification, as `frictionlab identify` writes it";
    return {};
  }
  Observer made = observer_from(text, period_, why);
  if (!made) why = file + ": " + why;
  const bool usable =
      made && Compensation::usable(made.get(), command_is_voltage_, velocity_reference_, why);
  return usable ? std::move(made) : Observer{};
}

CallbackReturn FrictionCompensationController::on_configure(const rclcpp_lifecycle::State &) {
  const auto node = get_node();
  joint_ = node->get_parameter("joint").as_string();
  command_interface_ = node->get_parameter("command_interface").as_string();
  command_is_voltage_ = node->get_parameter("command_is_voltage").as_bool();
  velocity_reference_ = node->get_parameter("velocity_reference").as_bool();
  std::string why;
  if (joint_.empty()) why = "joint must name a joint of the robot, but is empty";
  const auto number = [&](const char *name) {
    const double value = node->get_parameter(name).as_double();
    if (why.empty()) why = complaint(name, value);
    return value;
  };
  reference_timeout_ = number("reference_timeout");
  const double share = number("share"), limit = number("limit"), ramp = number("ramp");
  const double command_per_torque = number("command_per_torque");
  const unsigned int rate = get_update_rate();
  if (why.empty() && rate < 100) {
    why = "the controller must run at 100 Hz or faster, but its update rate is " +
          std::to_string(rate) + " Hz; set update_rate of the controller manager";
  }
  Observer observer;
  if (why.empty()) {
    period_ = 1.0 / rate;
    observer = observer_of(node->get_parameter("parameters_file").as_string(), why);
  }
  if (!observer) {
    RCLCPP_ERROR(node->get_logger(), "%s", why.c_str());
    return CallbackReturn::FAILURE;
  }
  RCLCPP_INFO(node->get_logger(), "%s compensates %s by %s at %u Hz", node->get_name(),
              joint_.c_str(), friction_observer_model(observer.get()), rate);
  waiting_.reset();
  compensation_ = std::make_unique<Compensation>(std::move(observer), period_, command_is_voltage_);
  auto &settings = compensation_->settings;
  settings.share = share;
  settings.limit = limit;
  settings.ramp = ramp;
  settings.command_per_torque = command_per_torque;

  parameters_handle_ = node->add_on_set_parameters_callback(
      [this](const std::vector<rclcpp::Parameter> &given) { return on_parameters(given); });
  reference_subscription_ = node->create_subscription<std_msgs::msg::Float64>(
      "~/reference", rclcpp::SystemDefaultsQoS(), [this](const std_msgs::msg::Float64 &message) {
        heard_reference_.store(message.data, std::memory_order_relaxed);
        heard_at_.store(get_node()->now().nanoseconds(), std::memory_order_release);
      });
  publisher_ = node->create_publisher<friction_msgs::msg::FrictionEstimate>(
      "~/friction_estimate", rclcpp::SystemDefaultsQoS());
  timer_ = node->create_wall_timer(std::chrono::milliseconds(20), [this] { on_timer(); });
  return CallbackReturn::SUCCESS;
}

CallbackReturn FrictionCompensationController::on_cleanup(const rclcpp_lifecycle::State &) {
  timer_.reset();
  parameters_handle_.reset();
  reference_subscription_.reset();
  publisher_.reset();
  waiting_.reset();
  compensation_.reset();
  return CallbackReturn::SUCCESS;
}

rcl_interfaces::msg::SetParametersResult FrictionCompensationController::on_parameters(
    const std::vector<rclcpp::Parameter> &parameters) {
  rcl_interfaces::msg::SetParametersResult result;
  Observer next;
  // All of them, or none.
  for (const auto &parameter : parameters) {
    if (parameter.get_type() == rclcpp::ParameterType::PARAMETER_DOUBLE) {
      result.reason = complaint(parameter.get_name(), parameter.as_double());
    } else if (parameter.get_name() == "parameters_file") {
      next = observer_of(parameter.as_string(), result.reason);
      if (next) result.reason.clear();
    }
    if (!result.reason.empty()) {
      result.successful = false;
      return result;
    }
  }
  auto &settings = compensation_->settings;
  for (const auto &parameter : parameters) {
    const std::string &name = parameter.get_name();
    if (name == "share") settings.share = parameter.as_double();
    if (name == "limit") settings.limit = parameter.as_double();
    if (name == "ramp") settings.ramp = parameter.as_double();
    if (name == "command_per_torque") settings.command_per_torque = parameter.as_double();
  }
  if (next) waiting_ = std::move(next);
  result.successful = true;
  return result;
}

controller_interface::InterfaceConfiguration
FrictionCompensationController::command_interface_configuration() const {
  return {controller_interface::interface_configuration_type::INDIVIDUAL,
          {joint_ + "/" + command_interface_}};
}

controller_interface::InterfaceConfiguration
FrictionCompensationController::state_interface_configuration() const {
  return {controller_interface::interface_configuration_type::INDIVIDUAL,
          {joint_ + "/velocity", joint_ + "/position"}};
}

std::vector<hardware_interface::CommandInterface>
FrictionCompensationController::on_export_reference_interfaces() {
  reference_interfaces_.assign(velocity_reference_ ? 2 : 1, NOTHING);
  std::vector<hardware_interface::CommandInterface> exported;
  exported.reserve(reference_interfaces_.size());
  const std::string controller = get_node()->get_name();
  exported.emplace_back(controller, joint_ + "/" + command_interface_, &reference_interfaces_[0]);
  if (velocity_reference_) {
    exported.emplace_back(controller, joint_ + "/velocity", &reference_interfaces_[1]);
  }
  return exported;
}

std::vector<hardware_interface::StateInterface>
FrictionCompensationController::on_export_state_interfaces() {
  state_interfaces_values_.assign(EXPORTED, 0.0);
  std::vector<hardware_interface::StateInterface> exported;
  exported.reserve(EXPORTED);
  for (int i = 0; i < EXPORTED; ++i) {
    exported.emplace_back(get_node()->get_name(), joint_ + "/" + EXPORTED_NAMES[i],
                          &state_interfaces_values_[i]);
  }
  return exported;
}

bool FrictionCompensationController::on_set_chained_mode(bool) { return true; }

void FrictionCompensationController::forget_references() noexcept {
  for (double &reference : reference_interfaces_) reference = NOTHING;
}

CallbackReturn FrictionCompensationController::on_activate(const rclcpp_lifecycle::State &) {
  if (command_interfaces_.size() != 1 || state_interfaces_.size() != 2) {
    RCLCPP_ERROR(get_node()->get_logger(),
                 "expected %s/%s to command and %s/velocity and %s/position to read, but got %zu and "
                 "%zu interfaces",
                 joint_.c_str(), command_interface_.c_str(), joint_.c_str(), joint_.c_str(),
                 command_interfaces_.size(), state_interfaces_.size());
    return CallbackReturn::ERROR;
  }
  forget_references();
  heard_at_.store(0, std::memory_order_release);
  compensation_->start();
  active_ = true;
  return CallbackReturn::SUCCESS;
}

CallbackReturn FrictionCompensationController::on_deactivate(const rclcpp_lifecycle::State &) {
  active_ = false;
  const bool stopped = command_interfaces_.empty() || command_interfaces_[0].set_value(0.0);
  return stopped ? CallbackReturn::SUCCESS : CallbackReturn::ERROR;
}

return_type FrictionCompensationController::update_reference_from_subscribers(
    const rclcpp::Time &time, const rclcpp::Duration &) {
  const std::int64_t heard_at = heard_at_.load(std::memory_order_acquire);
  const double age = 1e-9 * static_cast<double>(time.nanoseconds() - heard_at);
  // A clock that was set back makes no message younger.
  const bool fresh = heard_at != 0 && std::fabs(age) <= reference_timeout_;
  reference_interfaces_[0] = fresh ? heard_reference_.load(std::memory_order_relaxed) : NOTHING;
  return return_type::OK;
}

return_type FrictionCompensationController::update_and_write_commands(const rclcpp::Time &time,
                                                                      const rclcpp::Duration &) {
  Inputs inputs{};
  inputs.reference = reference_interfaces_[0];
  inputs.reference_velocity = velocity_reference_ ? reference_interfaces_[1] : NOTHING;
  inputs.velocity = state_interfaces_[0].get_optional().value_or(NOTHING);
  inputs.position = state_interfaces_[1].get_optional().value_or(NOTHING);
  const Outputs outputs = compensation_->step(inputs);

  const FrictionEstimate &estimate = outputs.estimate;
  const double regime = estimate.regime == FRICTION_REGIME_SLIP ? 1.0 : 0.0;
  if (state_interfaces_values_.size() == EXPORTED) {
    state_interfaces_values_[FRICTION] = estimate.torque;
    state_interfaces_values_[DEFLECTION] = estimate.deflection;
    state_interfaces_values_[GAMMA] = estimate.gamma;
    state_interfaces_values_[REGIME] = regime;
    state_interfaces_values_[ADDED] = outputs.added;
    state_interfaces_values_[ESTIMATED] = outputs.estimated ? 1.0 : 0.0;
  }
  newest_.write({estimate.torque, estimate.deflection, estimate.gamma, regime, estimate.velocity,
                 time.seconds()});
  return command_interfaces_[0].set_value(outputs.command) ? return_type::OK : return_type::ERROR;
}

void FrictionCompensationController::on_timer() {
  if (waiting_) compensation_->offer(waiting_);
  std::array<double, 6> newest{};
  if (!active_ || !newest_.read(newest) || newest[5] == published_at_) return;
  published_at_ = newest[5];
  friction_msgs::msg::FrictionEstimate message;
  message.header.stamp = rclcpp::Time(static_cast<std::int64_t>(newest[5] * 1e9));
  message.header.frame_id = joint_;
  message.model = compensation_->model();
  message.torque = newest[0];
  message.deflection = newest[1];
  message.gamma = newest[2];
  message.regime = newest[3] > 0.5 ? message.SLIP : message.STICK;
  message.velocity = newest[4];
  message.residual = NOTHING;
  publisher_->publish(message);
}

}  // namespace friction_compensation_controller

PLUGINLIB_EXPORT_CLASS(friction_compensation_controller::FrictionCompensationController,
                       controller_interface::ChainableControllerInterface)
