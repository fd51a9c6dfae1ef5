#pragma once
// --invalid: which heights in a profile file stand for "no return".

#include <string>
#include <vector>

#include "app/cli/command.h"
#include "core/profile/profile.h"

namespace seamwright::cli {

// Without the option codes are recognised (core/profile/no_return.h) and reported: `warnings` of the answer's
// JSON and a line of its text. With it exactly the given heights are erased, in the file's own unit, and
// nothing is reported.
class NoReturnOption {
  public:
    void add_to(CLI::App* command);
    void apply(Profile& profile, const std::string& file);
    void warn(Answer& answer) const;

  private:
    std::vector<double> values_;
    std::vector<std::string> warnings_;
};

}  // namespace seamwright::cli
