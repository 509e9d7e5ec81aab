// What the plugin uses of ros2_control and rclcpp, typed after their headers; see README.md here.
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

// Where the messages that rosidl generates can be had, the plugin is compiled against those.
#ifdef GENERATED_MESSAGES
#include <builtin_interfaces/msg/time.hpp>
#include <friction_msgs/msg/friction_estimate.hpp>
#include <rcl_interfaces/msg/parameter_descriptor.hpp>
#include <rcl_interfaces/msg/set_parameters_result.hpp>
#include <std_msgs/msg/float64.hpp>
#else
namespace std_msgs::msg {
struct Float64 {
  double data = 0.0;
};
}  // namespace std_msgs::msg
#endif

namespace rclcpp {

class Time {
 public:
  explicit Time(std::int64_t nanoseconds = 0) : nanoseconds_(nanoseconds) {}
  std::int64_t nanoseconds() const { return nanoseconds_; }
  double seconds() const { return 1e-9 * static_cast<double>(nanoseconds_); }
#ifdef GENERATED_MESSAGES
  operator builtin_interfaces::msg::Time() const {
    builtin_interfaces::msg::Time time;
    time.sec = static_cast<std::int32_t>(nanoseconds_ / 1000000000);
    time.nanosec = static_cast<std::uint32_t>(nanoseconds_ % 1000000000);
    return time;
  }
#endif

 private:
  std::int64_t nanoseconds_;
};

class Duration {};

enum class ParameterType : std::uint8_t { PARAMETER_BOOL = 1, PARAMETER_DOUBLE = 3, PARAMETER_STRING = 4 };

class Parameter {
 public:
  using Value = std::variant<bool, double, std::string>;
  Parameter(std::string name, Value value) : name_(std::move(name)), value_(std::move(value)) {}
  const std::string &get_name() const { return name_; }
  ParameterType get_type() const {
    if (std::holds_alternative<bool>(value_)) return ParameterType::PARAMETER_BOOL;
    return std::holds_alternative<double>(value_) ? ParameterType::PARAMETER_DOUBLE
                                                  : ParameterType::PARAMETER_STRING;
  }
  bool as_bool() const { return std::get<bool>(value_); }
  double as_double() const { return std::get<double>(value_); }
  const std::string &as_string() const { return std::get<std::string>(value_); }

 private:
  std::string name_;
  Value value_;
};

struct Logger {};
struct QoS {};
struct SystemDefaultsQoS : QoS {};

template <typename Message>
struct Subscription {
  using SharedPtr = std::shared_ptr<Subscription>;
  std::function<void(const Message &)> callback;
};

template <typename Message>
struct Publisher {
  using SharedPtr = std::shared_ptr<Publisher>;
  std::vector<Message> published;
  void publish(const Message &message) { published.push_back(message); }
};

struct TimerBase {
  using SharedPtr = std::shared_ptr<TimerBase>;
  std::function<void()> callback;
};

}  // namespace rclcpp

#ifndef GENERATED_MESSAGES
namespace rcl_interfaces::msg {
struct ParameterDescriptor {
  std::string description;
  bool read_only = false;
};
struct SetParametersResult {
  bool successful = false;
  std::string reason;
};
}  // namespace rcl_interfaces::msg
#endif

namespace rclcpp::node_interfaces {
struct OnSetParametersCallbackHandle {
  using SharedPtr = std::shared_ptr<OnSetParametersCallbackHandle>;
  std::function<rcl_interfaces::msg::SetParametersResult(const std::vector<Parameter> &)> callback;
};
}  // namespace rclcpp::node_interfaces

#define RCLCPP_ERROR(logger, ...) (void(logger), std::fprintf(stderr, __VA_ARGS__), std::fputs("\n", stderr))
#define RCLCPP_INFO(logger, ...) RCLCPP_ERROR(logger, __VA_ARGS__)

#ifndef GENERATED_MESSAGES
namespace friction_msgs::msg {
struct FrictionEstimate {
  static constexpr std::uint8_t STICK = 0, SLIP = 1;
  struct {
    rclcpp::Time stamp;
    std::string frame_id;
  } header;
  std::string model;
  double torque = 0.0, deflection = 0.0, gamma = 0.0, velocity = 0.0, residual = 0.0;
  std::uint8_t regime = 0;
};
}  // namespace friction_msgs::msg
#endif

namespace rclcpp_lifecycle {

class State {};

namespace node_interfaces {
class LifecycleNodeInterface {
 public:
  enum class CallbackReturn : std::uint8_t { SUCCESS = 97, FAILURE = 98, ERROR = 99 };
  virtual CallbackReturn on_configure(const State &) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_cleanup(const State &) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_activate(const State &) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_deactivate(const State &) { return CallbackReturn::SUCCESS; }
  virtual ~LifecycleNodeInterface() = default;
};
}  // namespace node_interfaces

class LifecycleNode {
 public:
  bool has_parameter(const std::string &name) const { return parameters.count(name) != 0; }
  template <typename Value>
  void declare_parameter(const std::string &name, const Value &usual,
                         const rcl_interfaces::msg::ParameterDescriptor &) {
    parameters.emplace(name, rclcpp::Parameter(name, usual));
  }
  rclcpp::Parameter get_parameter(const std::string &name) const { return parameters.at(name); }
  const char *get_name() const { return "compensation"; }
  rclcpp::Logger get_logger() const { return {}; }
  rclcpp::Time now() const { return clock; }

  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr add_on_set_parameters_callback(
      std::function<rcl_interfaces::msg::SetParametersResult(const std::vector<rclcpp::Parameter> &)>
          callback) {
    handle = std::make_shared<rclcpp::node_interfaces::OnSetParametersCallbackHandle>();
    handle->callback = std::move(callback);
    return handle;
  }
  template <typename Message, typename Callback>
  std::shared_ptr<rclcpp::Subscription<Message>> create_subscription(const std::string &,
                                                                     const rclcpp::QoS &,
                                                                     Callback callback) {
    auto made = std::make_shared<rclcpp::Subscription<Message>>();
    made->callback = std::move(callback);
    if constexpr (std::is_same_v<Message, std_msgs::msg::Float64>) subscription = made;
    return made;
  }
  template <typename Message>
  std::shared_ptr<rclcpp::Publisher<Message>> create_publisher(const std::string &,
                                                               const rclcpp::QoS &) {
    auto made = std::make_shared<rclcpp::Publisher<Message>>();
    if constexpr (std::is_same_v<Message, friction_msgs::msg::FrictionEstimate>) publisher = made;
    return made;
  }
  rclcpp::TimerBase::SharedPtr create_wall_timer(std::chrono::milliseconds,
                                                 std::function<void()> callback) {
    timer = std::make_shared<rclcpp::TimerBase>();
    timer->callback = std::move(callback);
    return timer;
  }

  // For the test, which plays the executor.
  std::map<std::string, rclcpp::Parameter> parameters;
  rclcpp::Time clock{1};
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr handle;
  rclcpp::Subscription<std_msgs::msg::Float64>::SharedPtr subscription;
  rclcpp::Publisher<friction_msgs::msg::FrictionEstimate>::SharedPtr publisher;
  rclcpp::TimerBase::SharedPtr timer;
};

}  // namespace rclcpp_lifecycle

namespace hardware_interface {

class Handle {
 public:
  Handle(const std::string &prefix, const std::string &name, double *value)
      : prefix_(prefix), name_(name), value_(value) {}
  const std::string &get_prefix_name() const { return prefix_; }
  std::string get_name() const { return prefix_ + "/" + name_; }
  double *place() const { return value_; }

 private:
  std::string prefix_, name_;
  double *value_;
};
struct CommandInterface : Handle {
  using Handle::Handle;
};
struct StateInterface : Handle {
  using Handle::Handle;
};

struct LoanedCommandInterface {
  double *value;
  template <typename T>
  [[nodiscard]] bool set_value(const T &to, unsigned int = 10) {
    *value = to;
    return true;
  }
};
struct LoanedStateInterface {
  const double *value;
  template <typename T = double>
  [[nodiscard]] std::optional<T> get_optional(unsigned int = 10) const {
    return *value;
  }
};

}  // namespace hardware_interface

namespace controller_interface {

using CallbackReturn = rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface::CallbackReturn;
enum class return_type : std::uint8_t { OK = 0, ERROR = 1 };
enum class interface_configuration_type : std::uint8_t { ALL = 0, INDIVIDUAL = 1, NONE = 2 };
struct InterfaceConfiguration {
  interface_configuration_type type;
  std::vector<std::string> names = {};
};

class ChainableControllerInterface
    : public rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface {
 public:
  virtual InterfaceConfiguration command_interface_configuration() const = 0;
  virtual InterfaceConfiguration state_interface_configuration() const = 0;
  virtual CallbackReturn on_init() = 0;
  std::shared_ptr<rclcpp_lifecycle::LifecycleNode> get_node() { return node_; }
  std::shared_ptr<const rclcpp_lifecycle::LifecycleNode> get_node() const { return node_; }
  unsigned int get_update_rate() const { return update_rate; }
  return_type update(const rclcpp::Time &time, const rclcpp::Duration &period) {
    if (!chained && update_reference_from_subscribers(time, period) != return_type::OK)
      return return_type::ERROR;
    return update_and_write_commands(time, period);
  }
  std::vector<hardware_interface::CommandInterface> references() {
    return on_export_reference_interfaces();
  }
  std::vector<hardware_interface::StateInterface> states() { return on_export_state_interfaces(); }
  void lend(double *command, const double *velocity, const double *position) {
    command_interfaces_ = {{command}};
    state_interfaces_ = {{velocity}, {position}};
  }
  bool chained = true;
  unsigned int update_rate = 1000;

 protected:
  virtual std::vector<hardware_interface::StateInterface> on_export_state_interfaces() = 0;
  virtual std::vector<hardware_interface::CommandInterface> on_export_reference_interfaces() = 0;
  virtual bool on_set_chained_mode(bool chained_mode) = 0;
  virtual return_type update_reference_from_subscribers(const rclcpp::Time &time,
                                                        const rclcpp::Duration &period) = 0;
  virtual return_type update_and_write_commands(const rclcpp::Time &time,
                                                const rclcpp::Duration &period) = 0;
  std::vector<double> reference_interfaces_;
  std::vector<double> state_interfaces_values_;
  std::vector<hardware_interface::LoanedCommandInterface> command_interfaces_;
  std::vector<hardware_interface::LoanedStateInterface> state_interfaces_;

 private:
  std::shared_ptr<rclcpp_lifecycle::LifecycleNode> node_ =
      std::make_shared<rclcpp_lifecycle::LifecycleNode>();
};

}  // namespace controller_interface

#define PLUGINLIB_EXPORT_CLASS(derived, base) \
  static_assert(std::is_base_of_v<base, derived> && std::is_default_constructible_v<derived>);
