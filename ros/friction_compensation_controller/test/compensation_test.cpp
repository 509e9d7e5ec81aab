// The core of the controller against the library, without ROS.
#include "friction_compensation_controller/compensation.hpp"
#include "friction_compensation_controller/snapshot.hpp"

#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <thread>

using namespace friction_compensation_controller;

#define CHECK(condition)                                                     \
  do {                                                                       \
    if (!(condition)) {                                                      \
      std::fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition);   \
      std::exit(1);                                                          \
    }                                                                        \
  } while (0)

namespace {

// Every allocation of C++ in this thread is counted. Those of the library are counted by its own
// tests.
thread_local long allocations = 0;

std::string coulomb(double level) {
  return "friction_observer:\n  ros__parameters:\n    model: coulomb\n    coulomb: {f_c: " +
         std::to_string(level) + "}\n";
}

Observer observer(const std::string &yaml) {
  std::string why;
  Observer made = observer_from(yaml, 1e-3, why);
  if (!made) std::fprintf(stderr, "%s\n", why.c_str());
  CHECK(made);
  return made;
}

const double nothing = std::nan("");

/// Cycles of the ramp, and some.
Outputs settled(Compensation &compensation, const Inputs &inputs) {
  Outputs last{};
  for (int k = 0; k < 600; ++k) last = compensation.step(inputs);
  return last;
}

void friction_is_added_along_a_ramp() {
  Compensation compensation(observer(coulomb(0.1)), 1e-3, false);
  const Inputs inputs{0.5, 1.0, 0.0, nothing};
  compensation.start();
  // Nothing until there is a limit.
  CHECK(settled(compensation, inputs).command == 0.5);
  compensation.settings.limit = 1.0;
  compensation.start();
  double before = 0.0;
  for (int k = 1; k <= 500; ++k) {
    const Outputs outputs = compensation.step(inputs);
    CHECK(outputs.estimated && outputs.estimate.regime == FRICTION_REGIME_SLIP);
    CHECK(outputs.added > before && outputs.added <= 0.1 + 1e-12);
    CHECK(std::fabs(outputs.added - 0.1 * k / 500) < 1e-9);
    before = outputs.added;
  }
  CHECK(std::fabs(settled(compensation, inputs).command - 0.6) < 1e-12);
  CHECK(std::fabs(settled(compensation, {0.5, -1.0, 0.0, nothing}).command - 0.4) < 1e-12);
}

void never_more_than_the_limit() {
  Compensation compensation(observer(coulomb(5.0)), 1e-3, false);
  compensation.settings.limit = 0.3;
  compensation.settings.command_per_torque = 10.0;
  CHECK(settled(compensation, {1.0, 1.0, 0.0, nothing}).added == 0.3);
  CHECK(settled(compensation, {1.0, -1.0, 0.0, nothing}).added == -0.3);
  for (const double limit : {nothing, -1.0, 0.0}) {
    compensation.settings.limit = limit;
    CHECK(settled(compensation, {1.0, 1.0, 0.0, nothing}).added == 0.0);
  }
  compensation.settings.limit = 0.3;
  compensation.settings.share = nothing;
  CHECK(settled(compensation, {1.0, 1.0, 0.0, nothing}).added == 0.0);
}

void what_is_no_number_moves_nothing() {
  Compensation compensation(observer(coulomb(0.1)), 1e-3, false);
  compensation.settings.limit = 1.0;
  const Inputs good{0.5, 1.0, 0.0, nothing};
  for (const double wrong : {nothing, HUGE_VAL, -HUGE_VAL}) {
    CHECK(settled(compensation, good).added > 0.09);
    Outputs outputs = compensation.step({wrong, 1.0, 0.0, nothing});
    CHECK(outputs.command == 0.0 && outputs.added == 0.0);
    CHECK(settled(compensation, good).added > 0.09);
    outputs = compensation.step({0.5, wrong, 0.0, nothing});
    CHECK(outputs.command == 0.5 && !outputs.estimated);
    // It comes back along its ramp.
    CHECK(compensation.step(good).added < 0.001);
    CHECK(settled(compensation, good).added > 0.09);
    outputs = compensation.step({0.5, 1.0, wrong, nothing});
    CHECK(outputs.command == 0.5 && !outputs.estimated);
  }
}

void another_observer_is_taken_without_a_jump() {
  Compensation compensation(observer(coulomb(0.1)), 1e-3, false);
  compensation.settings.limit = 1.0;
  const Inputs inputs{0.0, 1.0, 0.0, nothing};
  double before = settled(compensation, inputs).added;
  Observer next = observer(coulomb(0.2));
  CHECK(compensation.offer(next) && !next);
  Observer early = observer(coulomb(0.3));
  CHECK(!compensation.offer(early) && early);
  for (int k = 0; k < 150; ++k) {
    const double added = compensation.step(inputs).added;
    CHECK(added >= before - 1e-12 && added - before < 0.0011);
    before = added;
  }
  CHECK(std::fabs(before - 0.2) < 1e-9);
  CHECK(compensation.offer(early));
}

/// One thread steps, another hands over one observer after the other.
void two_threads_hand_over() {
  Compensation compensation(observer(coulomb(0.1)), 1e-3, false);
  compensation.settings.limit = 1.0;
  std::atomic<bool> done{false};
  std::thread stepping([&] {
    const Inputs inputs{0.0, 1.0, 0.0, nothing};
    compensation.step(inputs);
    allocations = 0;
    while (!done.load()) {
      compensation.step(inputs);
      std::this_thread::yield();
    }
    CHECK(allocations == 0);
  });
  for (int k = 0; k < 50; ++k) {
    Observer next = observer(coulomb(0.1 + 0.001 * k));
    while (!compensation.offer(next)) std::this_thread::yield();
  }
  done = true;
  stepping.join();
}

/// What is read was written together, however fast it is written.
void snapshots_are_whole() {
  Snapshot<3> snapshot;
  std::atomic<bool> done{false};
  std::thread writing([&] {
    for (double k = 0.0; !done.load(); k += 1.0) {
      snapshot.write({k, 2.0 * k, 3.0 * k});
      if (static_cast<long>(k) % 10 == 0) std::this_thread::yield();
    }
  });
  double before = 0.0;
  for (int whole = 0; whole < 500;) {
    std::array<double, 3> read{};
    if (!snapshot.read(read)) continue;
    CHECK(read[1] == 2.0 * read[0] && read[2] == 3.0 * read[0] && read[0] >= before);
    before = read[0];
    ++whole;
  }
  done = true;
  writing.join();
}

void what_is_lacking_is_named() {
  std::string why;
  CHECK(!observer_from("friction_observer: {ros__parameters: {model: colomb}}", 1e-3, why));
  CHECK(why.find("model") != std::string::npos);
  CHECK(!observer_from(coulomb(0.1), 0.5, why));
  CHECK(why.find("0.01") != std::string::npos);
  const auto technique = [](const char *name) {
    return observer(coulomb(0.1) + "    technique: " + name + "\n");
  };
  CHECK(Compensation::usable(technique("feedback").get(), false, false, why));
  CHECK(!Compensation::usable(technique("disturbance_observer").get(), false, true, why));
  CHECK(why.find("voltage") != std::string::npos);
  CHECK(Compensation::usable(technique("disturbance_observer").get(), true, false, why));
  CHECK(!Compensation::usable(technique("feedforward").get(), true, false, why));
  CHECK(why.find("velocity_reference") != std::string::npos);
  CHECK(Compensation::usable(technique("feedforward").get(), false, true, why));
}

}  // namespace

void *operator new(std::size_t size) {
  ++allocations;
  if (void *memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void *memory) noexcept { std::free(memory); }
void operator delete(void *memory, std::size_t) noexcept { std::free(memory); }

int main() {
  friction_is_added_along_a_ramp();
  never_more_than_the_limit();
  what_is_no_number_moves_nothing();
  another_observer_is_taken_without_a_jump();
  two_threads_hand_over();
  snapshots_are_whole();
  what_is_lacking_is_named();
  std::puts("passed");
}
