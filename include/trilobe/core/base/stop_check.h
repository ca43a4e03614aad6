#ifndef TRILOBE_CORE_BASE_STOP_CHECK_H_
#define TRILOBE_CORE_BASE_STOP_CHECK_H_

#include <concepts>
#include <cstddef>
#include <functional>
#include <utility>

namespace trilobe {

// A callback that long computations poll; true asks them to stop. An empty one always returns
// false.
class StopCheck {
 public:
  StopCheck() = default;
  StopCheck(std::nullptr_t) {}  // NOLINT(google-explicit-constructor)
  // Converts implicitly from any predicate.
  template <std::predicate F>
  requires(!std::same_as<F, StopCheck>)  // NOLINTNEXTLINE(google-explicit-constructor)
      StopCheck(F ask)
      : ask_(std::move(ask)) {}

  bool operator()() const { return ask_ && ask_(); }

 private:
  std::function<bool()> ask_;
};

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_STOP_CHECK_H_
