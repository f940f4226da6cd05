// Errors without exceptions: Result<T>, Failure, Limits, PAC_ASSERT.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <utility>
#include <variant>

namespace pac {

// What kind of thing went wrong with *data* (a caller's bug is a PAC_ASSERT, never an Error).
enum class Error : uint8_t {
  truncated,       // the input ends before the syntax does
  corrupt,         // the input breaks a rule of its format
  unsupported,     // legal, but a feature this project does not have
  limit_exceeded,  // legal, but larger than the caller's Limits allow
  out_of_space,    // the output buffer (or memory) is too small
  bad_argument,    // an option or argument is outside its documented range
  io,              // the operating system could not read or write a file
};

// The name of the kind, for messages: "truncated", "corrupt", ...
constexpr const char* error_name(Error error) {
  constexpr const char* kNames[] = {"truncated",    "corrupt",      "unsupported", "limit exceeded",
                                    "out of space", "bad argument", "i/o error"};
  return kNames[static_cast<size_t>(error)];
}

// Why an operation failed. `text` has static storage duration; `byte_offset` is where in the input, from its first
// byte.
struct Failure {
  Error error = Error::corrupt;
  uint64_t byte_offset = 0;
  const char* text = "";
};

// Upper bounds on what a file's header may make us allocate. Checked once, before the allocation.
struct Limits {
  uint64_t max_pixels = uint64_t{1} << 28;     // per image: width * height
  uint64_t max_triangles = uint64_t{1} << 26;  // per mesh or scene, after polygons are cut
  uint64_t max_bytes = uint64_t{1} << 31;      // per file, or per decoded object
};

[[noreturn]] inline void assertion_failed(const char* condition, const char* file, int line) {
  std::fprintf(stderr, "%s:%d: assertion failed: %s\n", file, line, condition);
  std::abort();
}

// Always on: a caller's bug stops the program at the place where it shows.
#define PAC_ASSERT(condition) \
  ((condition) ? static_cast<void>(0) : ::pac::assertion_failed(#condition, __FILE__, __LINE__))

// A value or the Failure that prevented it. Reading the absent one is a caller's bug (PAC_ASSERT).
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
  Result(Failure failure) : state_(std::in_place_index<1>, failure) {}

  bool ok() const { return state_.index() == 0; }
  explicit operator bool() const { return ok(); }

  T& value() & { return *checked_value(); }
  const T& value() const& { return *const_cast<Result*>(this)->checked_value(); }
  T&& value() && { return std::move(*checked_value()); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return checked_value(); }
  const T* operator->() const { return &value(); }

  const Failure& failure() const {
    const Failure* failure = std::get_if<1>(&state_);
    PAC_ASSERT(failure != nullptr);
    return *failure;
  }

 private:
  T* checked_value() {
    T* value = std::get_if<0>(&state_);
    PAC_ASSERT(value != nullptr);
    return value;
  }
  std::variant<T, Failure> state_;
};

// Success without a value, or the Failure.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Failure failure) : failure_(failure), ok_(false) {}

  bool ok() const { return ok_; }
  explicit operator bool() const { return ok(); }
  void value() const { PAC_ASSERT(ok_); }
  const Failure& failure() const {
    PAC_ASSERT(!ok_);
    return failure_;
  }

 private:
  Failure failure_;
  bool ok_ = true;
};

#define PAC_CONCAT_INNER(a, b) a##b
#define PAC_CONCAT(a, b) PAC_CONCAT_INNER(a, b)

// PAC_TRY(auto image, decode(bytes)); binds the value, or returns the Failure from the enclosing function.
#define PAC_TRY(declaration, expression)                                                     \
  auto PAC_CONCAT(pac_try_, __LINE__) = (expression);                                        \
  if (!PAC_CONCAT(pac_try_, __LINE__).ok()) return PAC_CONCAT(pac_try_, __LINE__).failure(); \
  declaration = std::move(PAC_CONCAT(pac_try_, __LINE__)).value()

// The same for Result<void>, or where the value is not wanted.
#define PAC_CHECK(expression)                                                       \
  do {                                                                              \
    if (auto pac_check = (expression); !pac_check.ok()) return pac_check.failure(); \
  } while (false)

}  // namespace pac
