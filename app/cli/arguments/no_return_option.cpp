#include "app/cli/arguments/no_return_option.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/profile/no_return.h"

namespace seamwright::cli {

void NoReturnOption::add_to(CLI::App* command) {
    command
        ->add_option("--invalid", values_,
                     "Heights that stand for \"no return\", e.g. -9999 (default: recognised, with a warning)")
        ->delimiter(',')
        ->type_name("Z");
}

void NoReturnOption::apply(Profile& profile, const std::string& file) {
    if (!values_.empty()) {
        erase_no_returns(profile, values_);
        return;
    }
    const auto codes = find_no_return_codes(profile);
    if (codes.empty()) return;
    std::vector<double> values;
    for (const NoReturnCode& c : codes) values.push_back(c.value);
    erase_no_returns(profile, values);
    std::string warning = file + ": " + no_return_sentence(codes).english();
    // The profiles of a pass say the same one after another: once is enough.
    if (warnings_.empty()) warnings_.push_back(std::move(warning));
}

void NoReturnOption::warn(Answer& answer) const {
    if (warnings_.empty()) return;
    answer.json["warnings"] = warnings_;
    for (const std::string& w : warnings_) answer.text += "warning: " + w + "; --invalid says which are\n";
}

}  // namespace seamwright::cli
