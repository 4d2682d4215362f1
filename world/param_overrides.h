#pragma once

#include <functional>
#include <utility>
#include <vector>

namespace sahel {

/// Values given on the command line, kept until it is known what they change: `--preset` names the start, these go on
/// top.
template <class Struct> class ParamOverrides {
  public:
    [[nodiscard]] bool empty() const { return changes_.empty(); }
    void apply(Struct& values) const {
        for (const auto& change : changes_) change(values);
    }
    template <class T> void add(T Struct::*member, T value) {
        changes_.push_back([member, value = std::move(value)](Struct& values) { values.*member = value; });
    }

  private:
    std::vector<std::function<void(Struct&)>> changes_;
};

} // namespace sahel
