// A callable passed by reference: for bodies of loops that are called before the call returns. Two pointers,
// nothing is copied, nothing allocated; the loop is compiled once for all its bodies, and each body once.
#pragma once
#include <memory>
#include <type_traits>
#include <utility>

namespace truestep {

template <class Signature>
class FunctionRef;

/// Refers to `f`, which must outlive it: a parameter, never a member.
template <class R, class... Args>
class FunctionRef<R(Args...)> {
 public:
  template <class F>
  requires(!std::is_same_v<std::remove_cvref_t<F>, FunctionRef> && std::is_invocable_r_v<R, F&, Args...>)
      FunctionRef(F&& f)  // NOLINT: lambdas are passed as they are
      : object_(const_cast<void*>(static_cast<const void*>(std::addressof(f)))),
        call_([](void* object, Args... args) -> R {
          return (*static_cast<std::remove_reference_t<F>*>(object))(std::forward<Args>(args)...);
        }) {}

  R operator()(Args... args) const { return call_(object_, std::forward<Args>(args)...); }

 private:
  void* object_;
  R (*call_)(void*, Args...);
};

}  // namespace truestep
