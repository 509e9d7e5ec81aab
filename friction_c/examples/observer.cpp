// The observer of an identification's parameters.yaml, called once a cycle.
#include <friction.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>

using Observer = std::unique_ptr<FrictionObserver, decltype(&friction_observer_free)>;

static Observer observer_of(const std::string &file, double period) {
  std::ifstream from(file);
  if (!from) throw std::runtime_error(file + " cannot be read");
  const std::string yaml{std::istreambuf_iterator<char>(from), {}};
  char message[512];
  FrictionObserver *made = nullptr;
  const auto code = friction_observer_from_yaml(yaml.c_str(), nullptr, period, message,
                                                sizeof message, &made);
  if (code != FRICTION_CODE_OK) throw std::runtime_error(file + ": " + message);
  return {made, &friction_observer_free};
}

int main(int count, char **arguments) try {
  if (count != 2) throw std::runtime_error("expected one argument: a parameters.yaml");
  const Observer observer = observer_of(arguments[1], 1e-3);
  std::printf("%s\n", friction_observer_model(observer.get()));
  FrictionSeen seen{};
  seen.torque = NAN;  // no sensor
  for (int k = 0; k < 1000; ++k) {
    seen.velocity = k / 1024.0 - 0.5;
    FrictionEstimate estimate;
    if (friction_observer_step(observer.get(), &seen, &estimate) != FRICTION_CODE_OK) continue;
    std::printf("%a\n", estimate.torque);
  }
} catch (const std::exception &wrong) {
  std::fprintf(stderr, "%s\n", wrong.what());
  return 1;
}
