// The plugin: one joint, chained or by itself.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "controller_interface/chainable_controller_interface.hpp"
#include "friction_compensation_controller/compensation.hpp"
#include "friction_compensation_controller/snapshot.hpp"
#include "friction_msgs/msg/friction_estimate.hpp"
#include "rclcpp/rclcpp.hpp"
#include "std_msgs/msg/float64.hpp"

namespace friction_compensation_controller {

/// Takes a command for a joint, adds the friction estimate, and claims the joint's effort or
/// voltage. Another controller writes `NAME/JOINT/effort` (the interface that is claimed); where
/// none does, the topic `~/reference` is heard.
class FrictionCompensationController : public controller_interface::ChainableControllerInterface {
 public:
  controller_interface::CallbackReturn on_init() override;
  controller_interface::CallbackReturn on_configure(const rclcpp_lifecycle::State &) override;
  controller_interface::CallbackReturn on_activate(const rclcpp_lifecycle::State &) override;
  controller_interface::CallbackReturn on_deactivate(const rclcpp_lifecycle::State &) override;
  controller_interface::CallbackReturn on_cleanup(const rclcpp_lifecycle::State &) override;

  controller_interface::InterfaceConfiguration command_interface_configuration() const override;
  controller_interface::InterfaceConfiguration state_interface_configuration() const override;

  controller_interface::return_type update_and_write_commands(
      const rclcpp::Time &time, const rclcpp::Duration &period) override;

 protected:
  std::vector<hardware_interface::CommandInterface> on_export_reference_interfaces() override;
  std::vector<hardware_interface::StateInterface> on_export_state_interfaces() override;
  bool on_set_chained_mode(bool chained) override;
  controller_interface::return_type update_reference_from_subscribers(
      const rclcpp::Time &time, const rclcpp::Duration &period) override;

 private:
  rcl_interfaces::msg::SetParametersResult on_parameters(
      const std::vector<rclcpp::Parameter> &parameters);
  /// The observer of a parameter file, if it can be used here.
  Observer observer_of(const std::string &file, std::string &why) const;
  /// Publishes the newest estimate; hands over an observer that waits for it.
  void on_timer();
  void forget_references() noexcept;

  std::string joint_;
  std::string command_interface_;
  bool command_is_voltage_ = false;
  bool velocity_reference_ = false;
  double period_ = 0.0;
  double reference_timeout_ = 0.5;

  std::unique_ptr<Compensation> compensation_;
  /// Made for new parameters, and not yet taken.
  Observer waiting_;

  std::atomic<double> heard_reference_{0.0};
  /// When it was heard, in the clock of the node [ns].
  std::atomic<std::int64_t> heard_at_{0};

  /// Torque, deflection, gamma, regime, velocity, time [s].
  Snapshot<6> newest_;
  double published_at_ = 0.0;
  std::atomic<bool> active_{false};

  rclcpp::Subscription<std_msgs::msg::Float64>::SharedPtr reference_subscription_;
  rclcpp::Publisher<friction_msgs::msg::FrictionEstimate>::SharedPtr publisher_;
  rclcpp::TimerBase::SharedPtr timer_;
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr parameters_handle_;
};

}  // namespace friction_compensation_controller
