// The plugin's own code against `declared/`, which is not ROS: see the README there.
#include "friction_compensation_controller/controller.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <new>

#define CHECK(condition)                                                     \
  do {                                                                       \
    if (!(condition)) {                                                      \
      std::fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition);   \
      std::exit(1);                                                          \
    }                                                                        \
  } while (0)

using controller_interface::CallbackReturn;
using controller_interface::return_type;
using friction_compensation_controller::FrictionCompensationController;
using rclcpp::Parameter;

namespace {

thread_local long allocations = 0;

/// A controller of one joint, with what a manager would lend it.
struct Joint {
  FrictionCompensationController controller;
  double command = 7.0, velocity = 1.0, position = 0.0;
  std::int64_t now = 1'000'000'000;

  explicit Joint(const char *file) {
    CHECK(controller.on_init() == CallbackReturn::SUCCESS);
    set("joint", std::string("wheel"));
    set("parameters_file", std::string(file));
    set("limit", 1.0);
    controller.get_node()->clock = rclcpp::Time(now);
    controller.lend(&command, &velocity, &position);
  }
  void set(const std::string &name, const Parameter::Value &value) {
    controller.get_node()->parameters.insert_or_assign(name, Parameter(name, value));
  }
  void update() {
    now += 1'000'000;
    controller.get_node()->clock = rclcpp::Time(now);
    CHECK(controller.update(rclcpp::Time(now), {}) == return_type::OK);
  }
};

void chained(const char *file) {
  Joint joint(file);
  auto &controller = joint.controller;
  CHECK(controller.on_configure({}) == CallbackReturn::SUCCESS);
  CHECK(controller.command_interface_configuration().names.at(0) == "wheel/effort");
  CHECK(controller.state_interface_configuration().names.at(0) == "wheel/velocity");
  const auto references = controller.references();
  const auto states = controller.states();
  CHECK(references.size() == 1 && references[0].get_name() == "compensation/wheel/effort");
  CHECK(references[0].get_prefix_name() == "compensation");
  CHECK(states[0].get_name() == "compensation/wheel/friction");
  CHECK(controller.on_activate({}) == CallbackReturn::SUCCESS);
  // Nobody has written a reference yet.
  joint.update();
  CHECK(joint.command == 0.0);
  *references[0].place() = 0.5;
  allocations = 0;
  for (int k = 0; k < 600; ++k) joint.update();
  CHECK(allocations == 0);
  const double friction = *states[0].place();
  CHECK(friction > 0.05 && std::fabs(joint.command - 0.5 - friction) < 1e-12);

  auto &node = *controller.get_node();
  node.timer->callback();
  const auto &message = node.publisher->published.at(0);
  CHECK(message.torque == friction && message.header.frame_id == "wheel");
  CHECK(!message.model.empty() && message.regime == message.SLIP);

  const auto &callback = node.handle->callback;
  CHECK(callback({Parameter("share", 0.5)}).successful);
  joint.update();
  CHECK(std::fabs(joint.command - 0.5 - 0.5 * friction) < 1e-3);
  for (const Parameter &wrong :
       {Parameter("share", 2.0), Parameter("limit", 0.0), Parameter("ramp", std::nan("")),
        Parameter("command_per_torque", 0.0), Parameter("parameters_file", std::string("/none"))}) {
    // All of them, or none.
    const auto result = callback({Parameter("share", 0.0), wrong});
    CHECK(!result.successful && !result.reason.empty());
  }
  joint.update();
  CHECK(std::fabs(joint.command - 0.5 - 0.5 * friction) < 1e-3);
  CHECK(callback({Parameter("parameters_file", std::string(file))}).successful);
  node.timer->callback();
  for (int k = 0; k < 200; ++k) joint.update();

  joint.velocity = std::nan("");
  joint.update();
  CHECK(joint.command == 0.5);
  CHECK(controller.on_deactivate({}) == CallbackReturn::SUCCESS && joint.command == 0.0);
  CHECK(controller.on_cleanup({}) == CallbackReturn::SUCCESS);
  CHECK(controller.on_configure({}) == CallbackReturn::SUCCESS);
}

void by_itself(const char *file) {
  Joint joint(file);
  joint.controller.chained = false;
  CHECK(joint.controller.on_configure({}) == CallbackReturn::SUCCESS);
  joint.controller.references();
  CHECK(joint.controller.on_activate({}) == CallbackReturn::SUCCESS);
  joint.update();
  CHECK(joint.command == 0.0);
  std_msgs::msg::Float64 command;
  command.data = 0.4;
  joint.controller.get_node()->subscription->callback(command);
  for (int k = 0; k < 400; ++k) joint.update();
  CHECK(joint.command > 0.4);
  // The message has become old.
  for (int k = 0; k < 200; ++k) joint.update();
  CHECK(joint.command == 0.0);
  // The clock is set back: a message from what is now the future is no fresher.
  joint.controller.get_node()->subscription->callback(command);
  joint.now -= 1'200'000'000;
  joint.update();
  CHECK(joint.command == 0.0);
}

void what_is_lacking_is_refused(const char *file) {
  const std::pair<const char *, Parameter::Value> wrong[] = {
      {"joint", std::string()},   {"limit", 0.0},
      {"limit", std::nan("")},    {"parameters_file", std::string()},
      {"ramp", -1.0},             {"command_per_torque", 0.0},
  };
  for (const auto &[name, value] : wrong) {
    Joint joint(file);
    joint.set(name, value);
    CHECK(joint.controller.on_configure({}) == CallbackReturn::FAILURE);
  }
  Joint slow(file);
  slow.controller.update_rate = 50;
  CHECK(slow.controller.on_configure({}) == CallbackReturn::FAILURE);
}

}  // namespace

void *operator new(std::size_t size) {
  ++allocations;
  if (void *memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void *memory) noexcept { std::free(memory); }
void operator delete(void *memory, std::size_t) noexcept { std::free(memory); }

int main(int, char **arguments) {
  chained(arguments[1]);
  by_itself(arguments[1]);
  what_is_lacking_is_refused(arguments[1]);
  std::puts("passed");
}
