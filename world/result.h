#pragma once

#include "world/check.h"

#include <string>
#include <utility>
#include <variant>

/// Failures that the outside world causes: a value or an Error with one clear line (what, where, what to do).
namespace sahel {

enum class ErrorKind {
    usage,       ///< the caller asked for something that cannot be meant (exit code 2)
    not_found,   ///< a file, world or tile is not there
    corrupt,     ///< data was read but is not what was written
    unsupported, ///< a newer format, a missing optional library
    io,          ///< the disk, a permission, a full device
    busy,        ///< somebody else holds it
    budget       ///< a limit given by the user would be exceeded
};

struct Error {
    ErrorKind kind = ErrorKind::io;
    std::string message; ///< one line: what failed, where, and what to do about it

    [[nodiscard]] int exit_code() const { return kind == ErrorKind::usage ? 2 : 1; }
};

template <class T> class [[nodiscard]] Result {
  public:
    Result(T value) : state_(std::move(value)) {}     // NOLINT(google-explicit-constructor)
    Result(Error error) : state_(std::move(error)) {} // NOLINT(google-explicit-constructor)

    [[nodiscard]] bool ok() const { return state_.index() == 0; }
    explicit operator bool() const { return ok(); }

    /// The value; it is our bug to ask for it without having looked at ok().
    [[nodiscard]] T& value() & {
        require_value();
        return std::get<0>(state_);
    }
    [[nodiscard]] const T& value() const& {
        require_value();
        return std::get<0>(state_);
    }
    /// By value, so that `for (auto x : f().value())` does not walk over what is gone.
    [[nodiscard]] T value() && {
        require_value();
        return std::get<0>(std::move(state_));
    }
    [[nodiscard]] const Error& error() const {
        SAHEL_CHECK(!ok());
        return std::get<1>(state_);
    }

    T& operator*() & { return value(); }
    const T& operator*() const& { return value(); }
    T operator*() && { return std::move(*this).value(); }
    T* operator->() { return &value(); }
    const T* operator->() const { return &value(); }

  private:
    void require_value() const {
        if (!ok()) check_failed(__FILE__, __LINE__, "Result has a value", std::get<1>(state_).message);
    }
    std::variant<T, Error> state_;
};

struct Nothing {};

/// Success without a value, or an Error.
class [[nodiscard]] Status : public Result<Nothing> {
  public:
    Status() : Result(Nothing{}) {}
    Status(Error error) : Result(std::move(error)) {} // NOLINT(google-explicit-constructor)
};

} // namespace sahel

#define SAHEL_CONCAT_INNER(a, b) a##b
#define SAHEL_CONCAT(a, b) SAHEL_CONCAT_INNER(a, b)

/// Return the error of a Status or Result to the caller, else go on.
#define SAHEL_TRY(expression)                                                                                          \
    do {                                                                                                               \
        auto&& sahel_status = (expression);                                                                            \
        if (!sahel_status.ok()) return sahel_status.error();                                                           \
    } while (false)

/// `SAHEL_ASSIGN(auto x, f())`: x is the value of f(), or the error is returned to the caller.
#define SAHEL_ASSIGN(declaration, expression)                                                                          \
    auto SAHEL_CONCAT(sahel_result_, __LINE__) = (expression);                                                         \
    if (!SAHEL_CONCAT(sahel_result_, __LINE__).ok()) return SAHEL_CONCAT(sahel_result_, __LINE__).error();             \
    declaration = std::move(SAHEL_CONCAT(sahel_result_, __LINE__)).value()
