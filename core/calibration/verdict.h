#pragma once
// The one word in which every calibration of the house ends.

#include <array>
#include <optional>
#include <string_view>

namespace seamwright {

// good: may be used as it is. usable: may be used, the reason says what is weaker than it should be.
// poor: a solution that must not be used (data contradict the model, or sigma beyond what the method
// promises). undetermined: the data cannot determine the answer; no parameter may be presented as found.
enum class Verdict { good, usable, poor, undetermined };

constexpr std::string_view name_of(Verdict verdict) {
    constexpr std::array<std::string_view, 4> words = {"good", "usable", "poor", "undetermined"};
    return words.at(static_cast<std::size_t>(verdict));
}
// nullopt: none of the four words.
constexpr std::optional<Verdict> verdict_from(std::string_view name) {
    for (const Verdict v : {Verdict::good, Verdict::usable, Verdict::poor, Verdict::undetermined})
        if (name == name_of(v)) return v;
    return std::nullopt;
}
// May be measured and pushed with.
constexpr bool serves(Verdict verdict) {
    return verdict == Verdict::good || verdict == Verdict::usable;
}

}  // namespace seamwright
