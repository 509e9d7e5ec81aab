// The newest value of one thread for another, without waiting.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace friction_compensation_controller {

/// `count` numbers that belong together. One thread writes and never waits; others read what was
/// written together.
template <std::size_t count>
class Snapshot {
 public:
  /// Puts new numbers in place. For one thread, which may be one in real time.
  void write(const std::array<double, count> &numbers) noexcept {
    const std::uint32_t before = sequence_.load(std::memory_order_relaxed);
    // Odd while it is written: who sees one of the new numbers sees that too.
    sequence_.store(before + 1, std::memory_order_relaxed);
    for (std::size_t i = 0; i < count; ++i) numbers_[i].store(numbers[i], std::memory_order_release);
    sequence_.store(before + 2, std::memory_order_release);
  }

  /// The newest numbers; false where none could be had undisturbed in some attempts.
  bool read(std::array<double, count> &numbers) const noexcept {
    for (int attempt = 0; attempt < 100; ++attempt) {
      const std::uint32_t before = sequence_.load(std::memory_order_acquire);
      for (std::size_t i = 0; i < count; ++i) numbers[i] = numbers_[i].load(std::memory_order_acquire);
      if (before % 2 == 0 && sequence_.load(std::memory_order_relaxed) == before) return true;
    }
    return false;
  }

 private:
  std::array<std::atomic<double>, count> numbers_{};
  std::atomic<std::uint32_t> sequence_{0};
};

}  // namespace friction_compensation_controller
